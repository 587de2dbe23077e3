// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A skin that is compressed in its plane gets thicker: at small strain its thickness becomes
//     h (1 - nu / (1 - nu) (e_u + e_v)),
// as no stress acts across it (plane stress). A bent layer at the height z from the middle surface now is at
// z h'/h, and so are its strain and its lever: the bending energy of the same curvature grows as (h'/h)^2.
// With the ratio J of a triangle's area to that at rest, which is 1 + e_u + e_v at small strain, Ruga takes
//     s = (h'/h)^2 = J^-2p,  p = nu / (1 - nu),
// which is exact at nu = 1/2, where volume is kept, and right to first order at any nu. So it is a term of
// the order of the strain: 2 to 10 % of the bending stiffness where a skin wrinkles at 5 %, nothing where it
// wrinkles at 0.1 %.
//
// With c = (x1 - x0) x (x2 - x0), d_i the edge opposite corner i, from corner i + 1 to corner i + 2, and
// r = J^2 = |c|^2 / (4 A^2), moving corner j by v changes c by d_j x v, so that
//     d|c|^2/dx_i = 2 c x d_i,
//     d2|c|^2/dx_i dx_j v = 2 [(d_j x v) x d_i + c x v e_ij] = 2 [(d_i.d_j) v - d_j (d_i.v) + e_ij c x v],
// e_ij = 1 for j = i + 2, -1 for j = i + 1 and 0 for j = i, and s = r^-p has
//     ds/dx_i = z c x d_i,  z = -2 p s / |c|^2,
//     d2s = z/2 d2|c|^2 - 2 (p + 1) z / |c|^2 (c x d_i) (c x d_j)^T.
#include "shell/thickness.h"

#include "core/vec3.h"
#include "core/wide.h"

// A triangle crushed below a tenth of its area keeps the stiffness it had there, so that collapsed ones give
// finite numbers.
static const double CRUSHED_SQUARE = 1e-2;

double ruga_thickness_power(double poisson) {
    return poisson / (1 - poisson);
}

// From corner 0 to the others.
RUGA_WIDE_PART void edges(const ruga_triangle_lanes* t, int i, double u[3], double v[3]) {
    for (int c = 0; c < 3; c++) {
        u[c] = t->x[1][c][i] - t->x[0][c][i];
        v[c] = t->x[2][c][i] - t->x[0][c][i];
    }
}

// |c|^2, and r above the floor.
RUGA_WIDE static void measure(int count, const double* restrict rest_area,
                              const ruga_triangle_lanes* restrict t, double* restrict square,
                              double* restrict ratio) {
    for (int i = 0; i < count; i++) {
        double u[3], v[3], c[3];
        edges(t, i, u, v);
        ruga_cross(u, v, c);
        square[i] = ruga_dot(c, c);
        double r = square[i] / (4 * rest_area[i] * rest_area[i]);
        ratio[i] = r > CRUSHED_SQUARE ? r : CRUSHED_SQUARE;
    }
}

void ruga_thickness_lanes_stiffness(int count, double power, const double* rest_area,
                                    const ruga_triangle_lanes* t, double (*thickness)[2]) {
    double square[RUGA_LANES] = {0}, ratio[RUGA_LANES] = {0}, stiffness[RUGA_LANES] = {0};
    measure(count, rest_area, t, square, ratio);
    ruga_lanes_power(count, ratio, -power, stiffness);
    for (int i = 0; i < count; i++) {
        thickness[i][0] = stiffness[i];
        thickness[i][1] = ratio[i] > CRUSHED_SQUARE ? -2 * power * stiffness[i] / square[i] : 0;
    }
}

RUGA_WIDE static void add_gradients(int count, const double* restrict scale,
                                    ruga_triangle_lanes* restrict t) {
    for (int i = 0; i < count; i++) {
        double u[3], v[3], c[3], along_u[3], along_v[3];
        edges(t, i, u, v);
        ruga_cross(u, v, c);
        ruga_cross(c, u, along_u);
        ruga_cross(c, v, along_v);
        for (int k = 0; k < 3; k++) {
            t->gradient[0][k][i] += scale[i] * (along_v[k] - along_u[k]);
            t->gradient[1][k][i] -= scale[i] * along_v[k];
            t->gradient[2][k][i] += scale[i] * along_u[k];
        }
    }
}

void ruga_thickness_lanes_add(int count, const double* scale, ruga_triangle_lanes* triangles) {
    add_gradients(count, scale, triangles);
}

RUGA_WIDE_PART void add_block(const double d[3], const double other_d[3], const double skew[9],
                              const double g[3], const double other_g[3], double first, double second,
                              double (*block)[RUGA_LANES], int lane) {
    double dot = ruga_dot(d, other_d);
    for (int k = 0; k < 9; k++) {
        int row = k / 3, column = k % 3;
        double part = (row == column ? dot : skew[k]) - other_d[row] * d[column];
        block[k][lane] += first * part + second * g[row] * other_g[column];
    }
}

RUGA_WIDE static void add_hessians(int count, double power, const double* restrict scale,
                                   ruga_triangle_lanes* restrict t) {
    for (int i = 0; i < count; i++) {
        double u[3], v[3], c[3], g[2][3], d[2][3], square;
        edges(t, i, u, v);
        ruga_cross(u, v, c);
        square = ruga_dot(c, c);
        for (int k = 0; k < 3; k++) {
            d[0][k] = -v[k];
            d[1][k] = u[k];
        }
        ruga_cross(c, d[0], g[0]);
        ruga_cross(c, d[1], g[1]);
        double second = -2 * (power + 1) * scale[i] / (square > 0 ? square : 1);
        const double none[9] = {0}, skew[9] = {0, -c[2], c[1], c[2], 0, -c[0], -c[1], c[0], 0}; // v -> c x v
        add_block(d[0], d[0], none, g[0], g[0], scale[i], second, t->block[0], i);
        add_block(d[1], d[0], skew, g[1], g[0], scale[i], second, t->block[1], i);
        add_block(d[1], d[1], none, g[1], g[1], scale[i], second, t->block[2], i);
    }
}

void ruga_thickness_lanes_add_hessian(int count, double power, const double* scale,
                                      ruga_triangle_lanes* triangles) {
    add_hessians(count, power, scale, triangles);
}
