// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Discrete hinges (Grinspun et al. 2003): E = k/2 (theta - theta0)^2, k = D |e|^2 / (A1 + A2) at rest.
//
// Let a triangle run along the edge e from x0 to x1, L = |e|, with the opposite corner x2, unit normal n,
// unit vector m = n x e / L in the plane towards x2, height h, and foot of x2 at x0 + t e. Raising x2 by d
// along n turns the triangle by d / h, and no net force or torque comes from an angle, so the triangle's part
// of the gradient of theta is
//   g2 = n / h,  g1 = -t g2,  g0 = -(1 - t) g2.
// Moving x2 changes h along m and n along -m / h; moving x1 with x0, x2 held changes h by -t along m, and
// turns n by t/h m - e/L^2 along n; and t changes as (x2 - x0).e / L^2 does. With
//   M = (m n^T + n m^T) / h^2,  R = e n^T / (L^2 h),  P = (h/L)^2 M / 2
// the derivatives, which hold nothing of the other triangle, are
//   dg2/dx2 = -M                 dg2/dx1 = t M - R                      dg2/dx0 = (1 - t) M + R
//   dg1/dx1 = t (R + R^T) - t^2 M - P                                   dg0/dx0 = -(1 - t) (R + R^T) - (1 -
//   t)^2 M - P dg0/dx1 = (1 - t) R - t R^T - t (1 - t) M + P.
// P is the symmetric half of n m^T / L^2. The other half is +-1/2 of the cross product with e / L^3, of
// opposite sign in the edge's two triangles, and so cancels. (Tamstorf & Grinspun 2013 reach an equal
// result.)
#include "shell/bending.h"

#include "core/wide.h"

// A triangle collapsed to a needle or a point has no angle, and must only not give infinities: lengths count
// as at least this part of the triangle's size, and never below 1e-50 m.
static const double COLLAPSED_SQUARE = 1e-20;
static const double LEAST_SQUARE = 1e-100;

static inline double larger(double a, double b) {
    return a > b ? a : b;
}

// |e|^2 of an edge and |n|^2 of the normal e x d, kept above the floors; size: sum of the edges' squares.
static inline double safe_length_square(double square, double size) {
    return larger(square, COLLAPSED_SQUARE * size + LEAST_SQUARE);
}

static inline double safe_normal_square(double square, double size) {
    return larger(square, COLLAPSED_SQUARE * size * size + LEAST_SQUARE);
}

// Of the triangle with the edges e and d from one corner.
static inline double size_of(const double e[3], const double d[3]) {
    return 2 * (ruga_dot(e, e) + ruga_dot(d, d) - ruga_dot(e, d));
}

RUGA_WIDE void ruga_hinge_lanes_measure(int count, ruga_hinge_lanes* h) {
    double sine[RUGA_LANES], cosine[RUGA_LANES];
    for (int i = 0; i < count; i++) {
        double e[3], d2[3], d3[3], n2[3], n3[3];
        for (int c = 0; c < 3; c++) {
            e[c] = h->x[1][c][i] - h->x[0][c][i];
            d2[c] = h->x[2][c][i] - h->x[0][c][i];
            d3[c] = h->x[3][c][i] - h->x[0][c][i];
        }
        ruga_cross(e, d2, n2);
        ruga_cross(d3, e, n3);
        double square = ruga_dot(e, e), length = sqrt(square), size2 = size_of(e, d2), size3 = size_of(e, d3);
        double s2 = length / safe_normal_square(ruga_dot(n2, n2), size2);
        double s3 = length / safe_normal_square(ruga_dot(n3, n3), size3);
        double t2 = ruga_dot(d2, e) / safe_length_square(square, size2);
        double t3 = ruga_dot(d3, e) / safe_length_square(square, size3);
        for (int c = 0; c < 3; c++) {
            double g2 = s2 * n2[c], g3 = s3 * n3[c];
            h->gradient[0][c][i] = -(1 - t2) * g2 - (1 - t3) * g3;
            h->gradient[1][c][i] = -t2 * g2 - t3 * g3;
            h->gradient[2][c][i] = g2;
            h->gradient[3][c][i] = g3;
        }
        // (n3 x n2).e = |e|^2 d3.n2
        sine[i] = length * ruga_dot(d3, n2);
        cosine[i] = ruga_dot(n2, n3);
    }
    ruga_lanes_angle(count, sine, cosine, h->angle);
}

double ruga_hinge_angle(const double* const x[4], double gradient[4][3]) {
    ruga_hinge_lanes one;
    for (int i = 0; i < 4; i++) {
        for (int c = 0; c < 3; c++) {
            one.x[i][c][0] = x[i][c];
        }
    }
    ruga_hinge_lanes_measure(1, &one);
    if (gradient) {
        ruga_lanes_store(1, 4, one.gradient, gradient[0]);
    }
    return one.angle[0];
}

RUGA_WIDE void ruga_hinge_lanes_add(int count, double (*const restrict moment)[RUGA_LANES],
                                    ruga_triangle_lanes* restrict t) {
    for (int i = 0; i < count; i++) {
        double e[3][3], n[3], w[3] = {0, 0, 0};
        for (int c = 0; c < 3; c++) {
            e[0][c] = t->x[1][c][i] - t->x[0][c][i];
            e[1][c] = t->x[2][c][i] - t->x[1][c][i];
            e[2][c] = t->x[0][c][i] - t->x[2][c][i];
        }
        ruga_cross(e[0], e[1], n);
        double square[3] = {ruga_dot(e[0], e[0]), ruga_dot(e[1], e[1]), ruga_dot(e[2], e[2])};
        double size = square[0] + square[1] + square[2];
        double per_square = 1 / safe_normal_square(ruga_dot(n, n), size);
        for (int k = 0; k < 3; k++) {
            int next = (k + 1) % 3, across = (k + 2) % 3;
            double force = moment[k][i] * sqrt(square[k]) * per_square;
            double along = -ruga_dot(e[across], e[k]) / safe_length_square(square[k], size);
            w[k] -= (1 - along) * force;
            w[next] -= along * force;
            w[across] += force;
        }
        for (int k = 0; k < 3; k++) {
            for (int c = 0; c < 3; c++) {
                t->gradient[k][c][i] += w[k] * n[c];
            }
        }
    }
}

// Every block above is a n^T + n b^T with the triangle's n. Adds the a and b of the six blocks, times the
// moment, for the edge from corner i to corner i + 1.
static void add_edge(const double* const x[3], int i, const double n[3], double normal_length, double moment,
                     double a[RUGA_TRIANGLE_BLOCKS][3], double b[RUGA_TRIANGLE_BLOCKS][3]) {
    // Number of the lower block of two corners.
    static const int lower[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    const int corner[3] = {i, (i + 1) % 3, (i + 2) % 3};
    double e[3], d[3], m[3];
    ruga_subtract(x[corner[1]], x[corner[0]], e);
    ruga_subtract(x[corner[2]], x[corner[0]], d);
    double square = safe_length_square(ruga_dot(e, e), size_of(e, d));
    double length = sqrt(square);
    double t = ruga_dot(d, e) / square, s = 1 - t;
    ruga_cross(n, e, m);
    double per_square = square / (normal_length * normal_length); // 1 / h^2
    double slide = 1 / (length * normal_length);                  // R = slide e n^T
    for (int c = 0; c < 3; c++) {
        m[c] *= moment * per_square / length;
        e[c] *= moment * slide;
    }
    double p = 0.5 / (square * per_square); // P = p M
    // Row corner, column corner, factors of M, R and R^T.
    const struct {
        int row, column;
        double m, r, r_transposed;
    } term[RUGA_TRIANGLE_BLOCKS] = {
        {0, 0, -s * s - p, -s, -s}, {1, 1, -t * t - p, t, t}, {2, 2, -1, 0, 0},
        {0, 1, -t * s + p, s, -t},  {2, 0, s, 1, 0},          {2, 1, t, -1, 0},
    };
    for (int k = 0; k < RUGA_TRIANGLE_BLOCKS; k++) {
        int row = corner[term[k].row], column = corner[term[k].column];
        bool transposed = row < column;
        double r = transposed ? term[k].r_transposed : term[k].r;
        double r_transposed = transposed ? term[k].r : term[k].r_transposed;
        int target = lower[row][column];
        for (int c = 0; c < 3; c++) {
            a[target][c] += term[k].m * m[c] + r * e[c];
            b[target][c] += term[k].m * m[c] + r_transposed * e[c];
        }
    }
}

void ruga_hinge_add_hessian(const double* const x[3], const double moment[3],
                            double block[RUGA_TRIANGLE_BLOCKS][9]) {
    double e[3], d[3], n[3];
    ruga_subtract(x[1], x[0], e);
    ruga_subtract(x[2], x[0], d);
    ruga_cross(e, d, n);
    double normal_length = sqrt(safe_normal_square(ruga_dot(n, n), size_of(e, d)));
    for (int c = 0; c < 3; c++) {
        n[c] /= normal_length;
    }
    double a[RUGA_TRIANGLE_BLOCKS][3] = {{0}}, b[RUGA_TRIANGLE_BLOCKS][3] = {{0}};
    for (int i = 0; i < 3; i++) {
        if (moment[i] != 0) {
            add_edge(x, i, n, normal_length, moment[i], a, b);
        }
    }
    for (int k = 0; k < RUGA_TRIANGLE_BLOCKS; k++) {
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++) {
                block[k][3 * r + c] += a[k][r] * n[c] + n[r] * b[k][c];
            }
        }
    }
}
