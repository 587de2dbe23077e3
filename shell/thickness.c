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
//     ds = -p s/r dr,  d2s = -p s/r d2r + p (p + 1) s/r^2 dr dr^T.
#include "shell/thickness.h"

#include "core/vec3.h"

// A triangle crushed below a tenth of its area keeps the stiffness it had there, so that collapsed ones give
// finite numbers.
static const double CRUSHED_SQUARE = 1e-2;

double ruga_thickness_power(double poisson) {
    return poisson / (1 - poisson);
}

// r, c and the opposite edges.
static double area_ratio_square(double rest_area, const double* const x[3], double c[3], double d[3][3]) {
    for (int i = 0; i < 3; i++) {
        ruga_subtract(x[(i + 2) % 3], x[(i + 1) % 3], d[i]);
    }
    ruga_triangle_normal(x[0], x[1], x[2], c);
    return ruga_dot(c, c) / (4 * rest_area * rest_area);
}

double ruga_thickness_stiffness(double power, double rest_area, const double* const x[3],
                                double gradient[3][3]) {
    double c[3], d[3][3], r = area_ratio_square(rest_area, x, c, d);
    bool crushed = !(r > CRUSHED_SQUARE);
    double s = pow(crushed ? CRUSHED_SQUARE : r, -power);
    double slope = crushed ? 0 : -power * s / r / (2 * rest_area * rest_area);
    for (int i = 0; i < 3; i++) {
        ruga_cross(c, d[i], gradient[i]);
        for (int k = 0; k < 3; k++) {
            gradient[i][k] *= slope;
        }
    }
    return s;
}

void ruga_thickness_add_hessian(double power, double rest_area, const double* const x[3], double scale,
                                double block[RUGA_TRIANGLE_BLOCKS][9]) {
    double c[3], d[3][3], g[3][3], r = area_ratio_square(rest_area, x, c, d);
    if (!(r > CRUSHED_SQUARE)) {
        return;
    }
    double unit = 1 / (2 * rest_area * rest_area); // dr = unit c x d
    double s = scale * pow(r, -power), first = -power * s / r * unit;
    double second = power * (power + 1) * s / (r * r) * unit * unit;
    const double skew[9] = {0, -c[2], c[1], c[2], 0, -c[0], -c[1], c[0], 0}; // v -> c x v
    for (int i = 0; i < 3; i++) {
        ruga_cross(c, d[i], g[i]);
    }
    for (int b = 0; b < RUGA_TRIANGLE_BLOCKS; b++) {
        int i = ruga_triangle_block_corner[b][0], j = ruga_triangle_block_corner[b][1];
        double dot = ruga_dot(d[i], d[j]), e = i == j ? 0 : j == (i + 2) % 3 ? 1 : -1;
        for (int k = 0; k < 9; k++) {
            int row = k / 3, column = k % 3;
            block[b][k] += first * ((row == column) * dot - d[j][row] * d[i][column] + e * skew[k]) +
                           second * g[i][row] * g[j][column];
        }
    }
}
