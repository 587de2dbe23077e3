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

RUGA_WIDE_PART double larger(double a, double b) {
    return a > b ? a : b;
}

// |e|^2 of an edge and |n|^2 of the normal e x d, kept above the floors; size: sum of the edges' squares.
RUGA_WIDE_PART double safe_length_square(double square, double size) {
    return larger(square, COLLAPSED_SQUARE * size + LEAST_SQUARE);
}

RUGA_WIDE_PART double safe_normal_square(double square, double size) {
    return larger(square, COLLAPSED_SQUARE * size * size + LEAST_SQUARE);
}

// Of the triangle with the edges e and d from one corner.
RUGA_WIDE_PART double size_of(const double e[3], const double d[3]) {
    return 2 * (ruga_dot(e, e) + ruga_dot(d, d) - ruga_dot(e, d));
}

RUGA_WIDE static void measure(int count, ruga_hinge_lanes* restrict h, double* restrict sine,
                              double* restrict cosine) {
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
}

void ruga_hinge_lanes_measure(int count, ruga_hinge_lanes* hinges) {
    double sine[RUGA_LANES] = {0}, cosine[RUGA_LANES] = {0};
    measure(count, hinges, sine, cosine);
    ruga_lanes_angle(count, sine, cosine, hinges->angle);
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

RUGA_WIDE static void add_moments(int count, double (*const restrict moment)[RUGA_LANES],
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

void ruga_hinge_lanes_add(int count, double (*const moment)[RUGA_LANES], ruga_triangle_lanes* triangles) {
    add_moments(count, moment, triangles);
}

// Every block above is a n^T + n b^T with the triangle's n. Adds the a and b of the blocks (1, 1), (2, 1) and
// (2, 2), times the moment, for the edge e from corner `edge` to the next; last: the edge that ends where e
// begins.
RUGA_WIDE_PART void add_edge(int edge, const double e[3], const double last[3], const double n[3],
                             double normal_square, double size, double moment, double a[3][3],
                             double b[3][3]) {
    double m[3], square = safe_length_square(ruga_dot(e, e), size), length = sqrt(square);
    double t = -ruga_dot(last, e) / square, s = 1 - t;
    ruga_cross(n, e, m);
    double along = moment * length / normal_square;         // of m / h^2
    double slide = moment / (length * sqrt(normal_square)); // of R = e n^T / (L^2 h)
    double p = 0.5 * normal_square / (square * square);     // P = p M
    // Factors of M, R and R^T: of the edge's beginning, its end, and the corner across, each with itself; and
    // of each with the one before, row first.
    const double own[3][3] = {{-s * s - p, -s, -s}, {-t * t - p, t, t}, {-1, 0, 0}};
    const double before[3][3] = {{s, 0, 1}, {p - t * s, -t, s}, {t, -1, 0}};
    const double* factor[3] = {own[(4 - edge) % 3], before[(5 - edge) % 3], own[(5 - edge) % 3]};
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++) {
            a[k][c] += factor[k][0] * along * m[c] + factor[k][1] * slide * e[c];
            b[k][c] += factor[k][0] * along * m[c] + factor[k][2] * slide * e[c];
        }
    }
}

RUGA_WIDE_PART void add_block(const double a[3], const double b[3], const double n[3],
                              double (*block)[RUGA_LANES], int lane) {
    for (int k = 0; k < 9; k++) {
        block[k][lane] += a[k / 3] * n[k % 3] + n[k / 3] * b[k % 3];
    }
}

RUGA_WIDE static void add_hessians(int count, double (*const restrict moment)[RUGA_LANES],
                                   ruga_triangle_lanes* restrict t) {
    for (int i = 0; i < count; i++) {
        double e[3][3], n[3], a[3][3] = {{0}}, b[3][3] = {{0}};
        for (int k = 0; k < 9; k++) {
            e[k / 3][k % 3] = t->x[(k / 3 + 1) % 3][k % 3][i] - t->x[k / 3][k % 3][i];
        }
        ruga_cross(e[0], e[1], n);
        double size = ruga_dot(e[0], e[0]) + ruga_dot(e[1], e[1]) + ruga_dot(e[2], e[2]);
        double normal_square = safe_normal_square(ruga_dot(n, n), size), scale = 1 / sqrt(normal_square);
        for (int c = 0; c < 3; c++) {
            n[c] *= scale;
        }
        add_edge(0, e[0], e[2], n, normal_square, size, moment[0][i], a, b);
        add_edge(1, e[1], e[0], n, normal_square, size, moment[1][i], a, b);
        add_edge(2, e[2], e[1], n, normal_square, size, moment[2][i], a, b);
        add_block(a[0], b[0], n, t->block[0], i);
        add_block(a[1], b[1], n, t->block[1], i);
        add_block(a[2], b[2], n, t->block[2], i);
    }
}

void ruga_hinge_lanes_add_hessian(int count, double (*const moment)[RUGA_LANES],
                                  ruga_triangle_lanes* triangles) {
    add_hessians(count, moment, triangles);
}

void ruga_hinge_hessian(const double* const x[3], const double moment[3],
                        double block[RUGA_TRIANGLE_BLOCKS][9]) {
    ruga_triangle_lanes one;
    double own[3][RUGA_LANES];
    ruga_triangle_lanes_set(&one, x);
    for (int k = 0; k < 27; k++) {
        one.block[k / 9][k % 9][0] = 0;
        own[k / 9][0] = moment[k / 9];
    }
    ruga_hinge_lanes_add_hessian(1, own, &one);
    ruga_triangle_lanes_blocks(1, &one, (double(*)[RUGA_TRIANGLE_BLOCKS][9])block);
}
