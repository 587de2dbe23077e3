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

#include "core/vec3.h"

// A triangle collapsed to a needle or a point has no angle, and must only not give infinities: lengths count
// as at least this part of the triangle's size, and never below 1e-50 m.
static const double COLLAPSED_SQUARE = 1e-20;
static const double LEAST_SQUARE = 1e-100;

// |e|^2 and |n|^2 of the edge e and the normal n = e x d, kept above the floors.
static double safe_length_square(const double e[3], const double d[3]) {
    return fmax(ruga_dot(e, e), COLLAPSED_SQUARE * ruga_dot(d, d) + LEAST_SQUARE);
}

static double safe_normal_square(const double n[3], const double e[3], const double d[3]) {
    double size = ruga_dot(e, e) + ruga_dot(d, d);
    return fmax(ruga_dot(n, n), COLLAPSED_SQUARE * size * size + LEAST_SQUARE);
}

double ruga_angle_difference(double a, double b) {
    double difference = a - b;
    if (difference > RUGA_PI) {
        return difference - 2 * RUGA_PI;
    }
    return difference > -RUGA_PI ? difference : difference + 2 * RUGA_PI;
}

double ruga_hinge_angle(const double* const x[4], double gradient[4][3]) {
    double e[3], d2[3], d3[3], n2[3], n3[3];
    ruga_subtract(x[1], x[0], e);
    ruga_subtract(x[2], x[0], d2);
    ruga_subtract(x[3], x[0], d3);
    ruga_cross(e, d2, n2);
    ruga_cross(d3, e, n3);
    double length = ruga_norm(e);
    if (gradient) {
        double s2 = length / safe_normal_square(n2, e, d2), s3 = length / safe_normal_square(n3, e, d3);
        double t2 = ruga_dot(d2, e) / safe_length_square(e, d2);
        double t3 = ruga_dot(d3, e) / safe_length_square(e, d3);
        for (int c = 0; c < 3; c++) {
            double g2 = s2 * n2[c], g3 = s3 * n3[c];
            gradient[0][c] = -(1 - t2) * g2 - (1 - t3) * g3;
            gradient[1][c] = -t2 * g2 - t3 * g3;
            gradient[2][c] = g2;
            gradient[3][c] = g3;
        }
    }
    // (n3 x n2).e = |e|^2 d3.n2
    return atan2(length * ruga_dot(d3, n2), ruga_dot(n2, n3));
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
    double square = safe_length_square(e, d);
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
    double normal_length = sqrt(safe_normal_square(n, e, d));
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
