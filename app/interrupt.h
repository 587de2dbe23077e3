// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Ctrl-C. Until ruga_interrupt_catch it ends the program with 130; after it the first one asks to stop at the
// next occasion, and a second one kills.
#ifndef RUGA_APP_INTERRUPT_H
#define RUGA_APP_INTERRUPT_H

#include <stdbool.h>

void ruga_interrupt_install(void);
void ruga_interrupt_catch(void);
bool ruga_interrupted(void);

#endif
