// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What every test program uses: cmocka, closeness, and the proof that nothing leaks.
#ifndef RUGA_TESTS_CHECK_H
#define RUGA_TESTS_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/status.h"

#include <math.h>
#include <stdio.h>

#define assert_status(call, wanted)                                                                          \
    do {                                                                                                     \
        ruga_status status_ = (call);                                                                        \
        if (status_ != (wanted)) {                                                                           \
            print_error("%s: %s (%s)\n", #call, ruga_status_text(status_), ruga_last_error());               \
        }                                                                                                    \
        assert_int_equal(status_, wanted);                                                                   \
    } while (0)
#define assert_ok(call) assert_status(call, RUGA_OK)

// |value - wanted| <= tolerance, both printed where it does not hold.
#define assert_near(value, wanted, tolerance)                                                                \
    do {                                                                                                     \
        double value_ = (value), wanted_ = (wanted), tolerance_ = (tolerance);                               \
        if (!(fabs(value_ - wanted_) <= tolerance_)) {                                                       \
            print_error("%s = %.17g, wanted %.17g within %g\n", #value, value_, wanted_, tolerance_);        \
            fail();                                                                                          \
        }                                                                                                    \
    } while (0)

// Teardown of every group: nothing that Ruga allocated is left.
static inline int check_no_leak(void** state) {
    (void)state;
    if (ruga_byte_count() != 0) {
        print_error("%zu bytes leaked\n", ruga_byte_count());
        return 1;
    }
    return 0;
}

#endif
