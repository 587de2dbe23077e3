// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For tests of elasticity: a material, small matrices, and states of deformation.
#ifndef RUGA_TESTS_DEFORMATIONS_H
#define RUGA_TESTS_DEFORMATIONS_H

#include "core/random.h"
#include "lattice/svd3.h"

static const double YOUNG = 2.5, POISSON = 0.3;
static const double MU = 2.5 / (2 * 1.3), LAMBDA = 2.5 * 0.3 / (1.3 * 0.4);

static inline void multiply(const double a[9], const double b[9], double c[9]) {
    for (int i = 0; i < 9; i++) {
        c[i] = a[i / 3 * 3] * b[i % 3] + a[i / 3 * 3 + 1] * b[3 + i % 3] + a[i / 3 * 3 + 2] * b[6 + i % 3];
    }
}

static inline double signed_random(ruga_random* random) {
    return 2 * ruga_random_uniform(random) - 1;
}

static inline void random_matrix(ruga_random* random, double a[9]) {
    for (int i = 0; i < 9; i++) {
        a[i] = signed_random(random);
    }
}

static inline void random_rotation(ruga_random* random, double r[9]) {
    double a[9], s[3], v[9];
    random_matrix(random, a);
    ruga_svd3(a, r, s, v);
}

static inline double dot(int n, const double* a, const double* b) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Deformation gradients at which the energy is smooth.
static const double GRADIENTS[][9] = {
    {1.2, 0.3, -0.1, 0.1, 0.9, 0.2, -0.2, 0.15, 1.1}, // moderate
    {1, 0.001, 0, 0, 1.002, 0, 0, -0.001, 0.999},     // near rest
    {1, 0, 0, 0, 1, 0, 0, 0, 1},                      // rest: all singular values equal
    {0.3, 0.02, 0, 0, 0.4, 0.01, 0.03, 0, 0.35},      // compressed
    {1.1, 0.1, 0, 0, 0.9, 0.1, 0.05, 0, -0.4},        // inverted
    {1.1, 0, 0, 0, 1.1, 0, 0, 0, -0.5},               // inverted, two singular values equal
    {0, -1.3, 0, 1.3, 0, 0, 0, 0, 1.3},               // rotated and dilated
    {0.7, 0, 0, 0, 0.7, 0, 0, 0, 1.4},                // two equal
    {1.2, 0, 0, 0, 0.8, 0, 0, 0, 0},                  // flat: one singular value zero
};
enum { GRADIENT_COUNT = sizeof GRADIENTS / sizeof *GRADIENTS };

#endif
