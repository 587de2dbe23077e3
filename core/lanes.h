// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Elementary functions of some numbers side by side. Without branches, so that they use vector registers, and
// with the same bits on every processor.
#ifndef RUGA_CORE_LANES_H
#define RUGA_CORE_LANES_H

#include <stddef.h>

// How many elements a kernel takes at once: enough to hide what starting costs, few enough for the first
// cache.
enum { RUGA_LANES = 32 };

static inline int ruga_lanes_from(int first, int end) {
    return end - first < RUGA_LANES ? end - first : RUGA_LANES;
}

// Vectors of three at `corners` indices of each element, side by side.
static inline void ruga_lanes_load(int count, int corners, const int* index, const double* x,
                                   double (*to)[3][RUGA_LANES]) {
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < corners; k++) {
            const double* from = x + 3 * (size_t)index[i * corners + k];
            to[k][0][i] = from[0];
            to[k][1][i] = from[1];
            to[k][2][i] = from[2];
        }
    }
}

// And back, to [count][corners][3].
static inline void ruga_lanes_store(int count, int corners, double (*const from)[3][RUGA_LANES], double* to) {
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < corners; k++, to += 3) {
            to[0] = from[k][0][i];
            to[1] = from[k][1][i];
            to[2] = from[k][2][i];
        }
    }
}

// atan2(y, x) in [-pi, pi], with a relative error below 4e-16; 0 for y = x = 0, whatever their signs;
// infinity counts as DBL_MAX / 4. The arrays do not overlap.
void ruga_lanes_angle(int count, const double* y, const double* x, double* angle);

// value^power for normal values above 0 and results between 1e-300 and 1e300, with a relative error below
// 3e-16 (1 + |log result|). The arrays do not overlap.
void ruga_lanes_power(int count, const double* value, double power, double* result);

#endif
