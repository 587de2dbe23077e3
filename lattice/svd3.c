// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// One-sided Jacobi (Hestenes 1958): plane rotations from the right make the columns of G = F V orthogonal;
// their lengths are the singular values. Unlike the eigenvalues of F^T F this keeps small singular values
// accurate. Only rotations are applied, hence det V = +1; U is completed by a cross product, hence det U =
// +1, and the last singular value u3.g3 gets its sign by itself.
#include "lattice/svd3.h"

#include "core/vec3.h"

#include <float.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { SWEEPS_MAX = 40 }; // 4 to 6 are needed; the bound only guards against NaN

// Two lengths, or an angle from orthogonal, that differ by less are taken as equal: a few rounding errors.
static const double CLOSE = 8 * DBL_EPSILON;

// The smaller rotation (c, s) that makes the symmetric matrix [app apq; apq aqq] diagonal.
static void symmetric_rotation(double app, double apq, double aqq, double* c, double* s) {
    double ratio = (aqq - app) / (2 * apq);
    double t = copysign(1, ratio) / (fabs(ratio) + sqrt(1 + ratio * ratio)); // 0 where ratio^2 overflows
    *c = 1 / sqrt(1 + t * t);
    *s = *c * t;
}

// Columns p and q of m become c p - s q and s p + c q.
static void rotate_columns(double m[9], int p, int q, double c, double s) {
    for (int i = 0; i < 9; i += 3) {
        double a = m[i + p], b = m[i + q];
        m[i + p] = c * a - s * b;
        m[i + q] = s * a + c * b;
    }
}

static double column_dot(const double m[9], int p, int q) {
    return m[p] * m[q] + m[3 + p] * m[3 + q] + m[6 + p] * m[6 + q];
}

static void make_columns_orthogonal(double g[9], double v[9]) {
    for (int sweep = 0; sweep < SWEEPS_MAX; sweep++) {
        bool rotated = false;
        for (int pair = 0; pair < 3; pair++) {
            int p = pair == 2 ? 1 : 0, q = pair == 0 ? 1 : 2;
            double gpp = column_dot(g, p, p), gqq = column_dot(g, q, q), gpq = column_dot(g, p, q);
            if (fabs(gpq) > CLOSE * sqrt(gpp) * sqrt(gqq)) {
                double c, s;
                symmetric_rotation(gpp, gpq, gqq, &c, &s);
                rotate_columns(g, p, q, c, s);
                rotate_columns(v, p, q, c, s);
                rotated = true;
            }
        }
        if (!rotated) {
            return;
        }
    }
}

// Longest column first, by quarter turns, which keep det v = +1.
static void sort_columns(double g[9], double v[9]) {
    for (int pass = 0; pass < 3; pass++) {
        int p = pass == 1 ? 1 : 0;
        if (column_dot(g, p, p) < (1 - 2 * CLOSE) * column_dot(g, p + 1, p + 1)) {
            rotate_columns(g, p, p + 1, 0, 1);
            rotate_columns(v, p, p + 1, 0, 1);
        }
    }
}

// A unit vector across the unit vector n: n crossed with the axis that it is farthest from.
static void any_across(const double n[3], double across[3]) {
    int axis = 0;
    for (int i = 1; i < 3; i++) {
        axis = fabs(n[i]) < fabs(n[axis]) ? i : axis;
    }
    double unit[3] = {0, 0, 0};
    unit[axis] = 1;
    ruga_cross(n, unit, across);
    ruga_normalize(across);
}

void ruga_svd3(const double f[9], double u[9], double s[3], double v[9]) {
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double g[9], largest = 0;
    for (int i = 0; i < 9; i++) {
        largest = fmax(largest, fabs(f[i]));
    }
    memcpy(v, identity, sizeof identity);
    memcpy(u, identity, sizeof identity);
    if (!(largest > 0)) {
        s[0] = s[1] = s[2] = f[0] + f[4] + f[8]; // zero, or NaN where f is
        return;
    }
    // Squares must neither overflow nor underflow; scaling by a power of two is exact.
    int exponent;
    frexp(largest, &exponent);
    exponent = abs(exponent) > 100 ? exponent : 0;
    for (int i = 0; i < 9; i++) {
        g[i] = exponent == 0 ? f[i] : ldexp(f[i], -exponent);
    }
    make_columns_orthogonal(g, v);
    sort_columns(g, v);

    double u0[3] = {g[0], g[3], g[6]}, u1[3] = {g[1], g[4], g[7]}, g2[3] = {g[2], g[5], g[8]}, u2[3];
    double s0 = ruga_normalize(u0);
    ruga_add_scaled(-ruga_dot(u0, u1), u0, u1);
    double s1 = ruga_norm(u1);
    if (s1 < 0x1p-500) {
        s1 = 0;
        any_across(u0, u1);
    } else { // also where it is NaN, which must stay visible
        ruga_normalize(u1);
    }
    ruga_cross(u0, u1, u2);
    s[0] = s0;
    s[1] = s1;
    s[2] = ruga_dot(u2, g2);
    for (int i = 0; i < 3; i++) {
        s[i] = exponent == 0 ? s[i] : ldexp(s[i], exponent);
        u[3 * i] = u0[i];
        u[3 * i + 1] = u1[i];
        u[3 * i + 2] = u2[i];
    }
}

// Cyclic two-sided Jacobi.
void ruga_eigen3(const double a[9], double value[3], double vector[9]) {
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double m[9], size = 0;
    memcpy(m, a, sizeof m);
    memcpy(vector, identity, sizeof identity);
    for (int i = 0; i < 9; i++) {
        size = fmax(size, fabs(a[i]));
    }
    for (int sweep = 0; sweep < SWEEPS_MAX; sweep++) {
        if (fabs(m[1]) + fabs(m[2]) + fabs(m[5]) <= 0.1 * DBL_EPSILON * size) {
            break;
        }
        for (int pair = 0; pair < 3; pair++) {
            int p = pair == 2 ? 1 : 0, q = pair == 0 ? 1 : 2, r = 3 - p - q;
            double apq = m[3 * p + q];
            if (fabs(apq) == 0) {
                continue;
            }
            double c, s;
            symmetric_rotation(m[4 * p], apq, m[4 * q], &c, &s);
            double t = s / c, apr = m[3 * p + r], aqr = m[3 * q + r];
            m[4 * p] -= t * apq;
            m[4 * q] += t * apq;
            m[3 * p + q] = m[3 * q + p] = 0;
            m[3 * p + r] = m[3 * r + p] = c * apr - s * aqr;
            m[3 * q + r] = m[3 * r + q] = s * apr + c * aqr;
            rotate_columns(vector, p, q, c, s);
        }
    }
    for (int i = 0; i < 3; i++) {
        value[i] = m[4 * i];
    }
}
