// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Other programs that a case compares with, run as they are installed.
#ifndef RUGA_APP_VALIDATE_PEER_H
#define RUGA_APP_VALIDATE_PEER_H

#include "app/validate/validation.h"

// The executable `name` in PATH; false where there is none.
bool peer_find(const char* name, char path[RUGA_VALIDATION_PATH]);

// Runs it in `directory` on one thread, all that it prints into the file `log` there, and waits: at most
// `limit` seconds. A failed start, a signal, an exit status that is not 0 and the limit are RUGA_LIBRARY.
// argument [..] is ended by NULL and begins with the program's name.
ruga_status peer_run(const char* path, char* const* argument, const char* directory, const char* log,
                     double limit);

#endif
