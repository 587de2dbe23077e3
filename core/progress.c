// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 199309L
#include "core/progress.h"

#include "ruga/ruga.h"

#include <time.h>

static ruga_progress_function* progress_function;
static void* progress_context;

void ruga_set_progress(ruga_progress_function* progress, void* context) {
    progress_function = progress;
    progress_context = context;
}

ruga_status ruga_progress(const char* stage, double done) {
    if (progress_function && !progress_function(stage, done, progress_context)) {
        return ruga_fail(RUGA_CANCELLED, "stopped on request during: %s", stage);
    }
    return RUGA_OK;
}

double ruga_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
