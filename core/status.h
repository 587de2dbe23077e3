// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// How failure travels: a function that can fail returns ruga_status and sets one full sentence.
#ifndef RUGA_CORE_STATUS_H
#define RUGA_CORE_STATUS_H

#include "ruga/base.h"

#ifdef __cplusplus
extern "C" {
#endif

// Sets this thread's error sentence (printf style) and returns `status`. Use: return ruga_fail(RUGA_IO, ...);
ruga_status ruga_fail(ruga_status status, const char* format, ...) __attribute__((format(printf, 2, 3)));

// Puts "prefix: " before this thread's error sentence and returns `status`.
ruga_status ruga_fail_prefix(ruga_status status, const char* format, ...)
    __attribute__((format(printf, 2, 3)));

// Passes a failure on. Only where nothing has to be freed; otherwise test the status and go to the one exit.
#define RUGA_TRY(call)                                                                                       \
    do {                                                                                                     \
        ruga_status status_of_call_ = (call);                                                                \
        if (status_of_call_ != RUGA_OK) {                                                                    \
            return status_of_call_;                                                                          \
        }                                                                                                    \
    } while (0)

// Passes a failure on to the function's one exit, which needs `ruga_status status` and a label `done`.
#define RUGA_TRY_DONE(call)                                                                                  \
    do {                                                                                                     \
        status = (call);                                                                                     \
        if (status != RUGA_OK) {                                                                             \
            goto done;                                                                                       \
        }                                                                                                    \
    } while (0)

void ruga_assert_failed(const char* condition, const char* file, int line);

// Misuse by the programmer: never by input.
#define RUGA_ASSERT(condition) ((condition) ? (void)0 : ruga_assert_failed(#condition, __FILE__, __LINE__))

#ifdef __cplusplus
}
#endif

#endif
