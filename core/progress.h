// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#ifndef RUGA_CORE_PROGRESS_H
#define RUGA_CORE_PROGRESS_H

#include "core/status.h"

// Reports to the callback set by ruga_set_progress. RUGA_CANCELLED when it asks to stop.
ruga_status ruga_progress(const char* stage, double done);

// Seconds of a clock that never goes back.
double ruga_clock(void);

#endif
