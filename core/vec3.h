// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Small vectors and matrices, as plain arrays of doubles: double[3], and double[9] row by row.
#ifndef RUGA_CORE_VEC3_H
#define RUGA_CORE_VEC3_H

#include <math.h>

#define RUGA_PI 3.14159265358979323846

static inline double ruga_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double ruga_norm(const double a[3]) {
    return sqrt(ruga_dot(a, a));
}

static inline void ruga_cross(const double a[3], const double b[3], double c[3]) {
    double x = a[1] * b[2] - a[2] * b[1];
    double y = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
    c[0] = x;
    c[1] = y;
}

static inline void ruga_subtract(const double a[3], const double b[3], double c[3]) {
    c[0] = a[0] - b[0];
    c[1] = a[1] - b[1];
    c[2] = a[2] - b[2];
}

// y += s x
static inline void ruga_add_scaled(double s, const double x[3], double y[3]) {
    y[0] += s * x[0];
    y[1] += s * x[1];
    y[2] += s * x[2];
}

static inline double ruga_distance(const double a[3], const double b[3]) {
    double d[3];
    ruga_subtract(a, b, d);
    return ruga_norm(d);
}

// Scales a to length one and returns its old length; zero stays zero.
static inline double ruga_normalize(double a[3]) {
    double n = ruga_norm(a);
    if (n > 0) {
        a[0] /= n;
        a[1] /= n;
        a[2] /= n;
    }
    return n;
}

// (b - a) x (c - a): twice the area, along the normal.
static inline void ruga_triangle_normal(const double a[3], const double b[3], const double c[3],
                                        double n[3]) {
    double u[3], v[3];
    ruga_subtract(b, a, u);
    ruga_subtract(c, a, v);
    ruga_cross(u, v, n);
}

// y = A x, A row by row
static inline void ruga_multiply3(const double a[9], const double x[3], double y[3]) {
    double r0 = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
    double r1 = a[3] * x[0] + a[4] * x[1] + a[5] * x[2];
    y[2] = a[6] * x[0] + a[7] * x[1] + a[8] * x[2];
    y[0] = r0;
    y[1] = r1;
}

#endif
