// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The deformation gradient of a triangle has the columns w_u, w_v: w_a = sum_i N_i,a x_i. Both energies are
//   A { c/2 [e_u^2 + e_v^2 + 2 nu e_u e_v] + k/2 (w_u.w_v)^2 },  c = E h / (1 - nu^2),  k = E h / (2 (1 +
//   nu)),
// with e_a = |w_a| - 1 for Baraff & Witkin (1998; their stretch and shear conditions, normalised by area, and
// a Poisson term), and e_a = (|w_a|^2 - 1) / 2 for St Venant-Kirchhoff: its shear strain is w_u.w_v / 2.
//
// The gradient with respect to w_a is sum_b S_ab w_b, S the second Piola stress, where
//   S_aa = c (e_a + nu e_b) / m_a,  S_uv = k w_u.w_v,  m_a = |w_a| (Baraff-Witkin) or 1 (StVK).
// With f_a = w_a / m_a = de_a/dw_a, the Hessian is
//   S_ab I + c Q_ab f_a f_b^T + k g_a g_b^T,  g_u = w_v, g_v = w_u,  Q = [[1 - z S_uu/c, nu], [nu, 1 - z
//   S_vv/c]],
// z = 1 for Baraff-Witkin (the second derivative of |w| is (I - f f^T) / |w|) and 0 for StVK. Each of the
// three terms is positive semi-definite if the 2 x 2 matrices S and Q are. Clamping scales the negative
// eigenvalues of S by (1 - clamp), then those of the Q that follows from it: what is left at clamp = 1 is
// positive semi-definite, and a fibre under compression keeps its exact stiffness c along itself.
//
// |w| has no derivative at 0. Below LENGTH_FLOOR the length is (|w|^2 / floor + floor) / 2, which continues
// it with the same value and slope: the energy then has derivatives everywhere.
#include "shell/membrane.h"

#include "core/vec3.h"
#include "core/wide.h"

// Fibres are never this short in a sensible state; larger values would change results, smaller ones make a
// collapsed triangle needlessly stiff sideways.
static const double LENGTH_FLOOR = 1e-3;
// A triangle whose height is this small a part of its longest edge has no area that means anything.
static const double FLAT = 1e-10;
// |n.x| above which the first direction is taken from z in place of x.
static const double ALONG = 0.99;

const int ruga_triangle_block_corner[RUGA_TRIANGLE_BLOCKS][2] = {{0, 0}, {1, 1}, {2, 2},
                                                                 {1, 0}, {2, 0}, {2, 1}};

// In-plane axes: u the x axis (z where x is nearly normal) projected to the plane, v = n x u. Returns the
// area.
static double plane_axes(const double* const x[3], double u[3], double v[3]) {
    double n[3];
    ruga_triangle_normal(x[0], x[1], x[2], n);
    double area = 0.5 * ruga_normalize(n);
    int axis = fabs(n[0]) > ALONG ? 2 : 0;
    for (int c = 0; c < 3; c++) {
        u[c] = (c == axis) - n[axis] * n[c];
    }
    ruga_normalize(u);
    ruga_cross(n, u, v);
    return area;
}

double ruga_membrane_grown_length(const double* const x[3], const double edge[3], const double growth[2]) {
    double u[3], v[3];
    (void)plane_axes(x, u, v);
    return hypot(growth[0] * ruga_dot(edge, u), growth[1] * ruga_dot(edge, v));
}

double ruga_membrane_rest_create(const double* const x[3], double poisson, const double growth[2],
                                 double thickness, double young, ruga_membrane_rest* rest) {
    double u[3], v[3], e1[3], e2[3];
    double area = plane_axes(x, u, v);
    double longest =
        fmax(ruga_distance(x[0], x[1]), fmax(ruga_distance(x[1], x[2]), ruga_distance(x[2], x[0])));
    if (!(2 * area > FLAT * longest * longest) || !isfinite(area)) {
        return 0;
    }
    ruga_subtract(x[1], x[0], e1);
    ruga_subtract(x[2], x[0], e2);
    double u1 = growth[0] * ruga_dot(e1, u), v1 = growth[1] * ruga_dot(e1, v);
    double u2 = growth[0] * ruga_dot(e2, u), v2 = growth[1] * ruga_dot(e2, v);
    double determinant = u1 * v2 - u2 * v1;
    area *= growth[0] * growth[1];
    double nu = poisson;
    *rest = (ruga_membrane_rest){
        .slope = {{v2 / determinant, -u2 / determinant}, {-v1 / determinant, u1 / determinant}},
        .stretch = area * young * thickness / (1 - nu * nu),
        .shear = area * young * thickness / (2 * (1 + nu)),
    };
    return area;
}

// The formulas of the file's head at one state; c and k times A.
typedef struct point {
    double w[2][3];
    double f[2][3];
    double z[2];      // 1 where -S_aa f_a f_a^T belongs to the Hessian
    double stress[3]; // S_uu, S_uv, S_vv times A, J
    double energy;
} point;

RUGA_WIDE_PART void set_fibre(bool baraff_witkin, point* p, int a, double* strain, double* measure) {
    double square = ruga_dot(p->w[a], p->w[a]), length = sqrt(square);
    bool regular = length >= LENGTH_FLOOR;
    double floored = regular ? length : LENGTH_FLOOR;
    double stretch = regular ? length : 0.5 * (square / LENGTH_FLOOR + LENGTH_FLOOR);
    *measure = baraff_witkin ? floored : 1;
    *strain = baraff_witkin ? stretch - 1 : 0.5 * (square - 1);
    p->z[a] = baraff_witkin && regular ? 1 : 0;
    double scale = 1 / *measure;
    for (int c = 0; c < 3; c++) {
        p->f[a][c] = scale * p->w[a][c];
    }
}

// e1, e2: from corner 0 to the others.
RUGA_WIDE_PART void evaluate_edges(ruga_membrane kind, double poisson, const ruga_membrane_rest* rest,
                                   const double e1[3], const double e2[3], point* p) {
    bool baraff_witkin = kind == RUGA_MEMBRANE_BARAFF_WITKIN;
    for (int a = 0; a < 2; a++) {
        for (int c = 0; c < 3; c++) {
            p->w[a][c] = rest->slope[0][a] * e1[c] + rest->slope[1][a] * e2[c];
        }
    }
    double eu, ev, mu, mv;
    set_fibre(baraff_witkin, p, 0, &eu, &mu);
    set_fibre(baraff_witkin, p, 1, &ev, &mv);
    double slant = ruga_dot(p->w[0], p->w[1]);
    p->stress[0] = rest->stretch * (eu + poisson * ev) / mu;
    p->stress[1] = rest->shear * slant;
    p->stress[2] = rest->stretch * (ev + poisson * eu) / mv;
    p->energy =
        0.5 * (rest->stretch * (eu * eu + ev * ev + 2 * poisson * eu * ev) + rest->shear * slant * slant);
}

static void evaluate(ruga_membrane kind, double poisson, const ruga_membrane_rest* rest,
                     const double* const x[3], point* p) {
    double e1[3], e2[3];
    ruga_subtract(x[1], x[0], e1);
    ruga_subtract(x[2], x[0], e2);
    evaluate_edges(kind, poisson, rest, e1, e2, p);
}

typedef struct rest_lanes {
    double slope[2][2][RUGA_LANES], stretch[RUGA_LANES], shear[RUGA_LANES];
} rest_lanes;

static void load_rest(int count, const ruga_membrane_rest* rest, rest_lanes* lanes) {
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 4; k++) {
            lanes->slope[k / 2][k % 2][i] = rest[i].slope[k / 2][k % 2];
        }
        lanes->stretch[i] = rest[i].stretch;
        lanes->shear[i] = rest[i].shear;
    }
}

// Rest data and state of lane i.
RUGA_WIDE_PART void evaluate_lane(ruga_membrane kind, double poisson, const rest_lanes* r,
                                  const ruga_triangle_lanes* t, int i, ruga_membrane_rest* rest, point* p) {
    double e1[3], e2[3];
    for (int k = 0; k < 4; k++) {
        rest->slope[k / 2][k % 2] = r->slope[k / 2][k % 2][i];
    }
    rest->stretch = r->stretch[i];
    rest->shear = r->shear[i];
    for (int c = 0; c < 3; c++) {
        e1[c] = t->x[1][c][i] - t->x[0][c][i];
        e2[c] = t->x[2][c][i] - t->x[0][c][i];
    }
    evaluate_edges(kind, poisson, rest, e1, e2, p);
}

RUGA_WIDE_PART void set_energies(ruga_membrane kind, double poisson, int count, const rest_lanes* restrict r,
                                 ruga_triangle_lanes* restrict t, double* restrict energy) {
    for (int i = 0; i < count; i++) {
        ruga_membrane_rest rest;
        point p;
        evaluate_lane(kind, poisson, r, t, i, &rest, &p);
        for (int c = 0; c < 3; c++) {
            double pu = p.stress[0] * p.w[0][c] + p.stress[1] * p.w[1][c];
            double pv = p.stress[1] * p.w[0][c] + p.stress[2] * p.w[1][c];
            double g1 = rest.slope[0][0] * pu + rest.slope[0][1] * pv;
            double g2 = rest.slope[1][0] * pu + rest.slope[1][1] * pv;
            t->gradient[0][c][i] = -(g1 + g2);
            t->gradient[1][c][i] = g1;
            t->gradient[2][c][i] = g2;
        }
        energy[i] = p.energy;
    }
}

// A loop for each kind, in which nothing asks for it.
RUGA_WIDE static void set_energies_of_kind(ruga_membrane kind, double poisson, int count,
                                           const rest_lanes* rest, ruga_triangle_lanes* t, double* energy) {
    if (kind == RUGA_MEMBRANE_BARAFF_WITKIN) {
        set_energies(RUGA_MEMBRANE_BARAFF_WITKIN, poisson, count, rest, t, energy);
    } else {
        set_energies(RUGA_MEMBRANE_STVK, poisson, count, rest, t, energy);
    }
}

void ruga_membrane_lanes_energy(ruga_membrane kind, double poisson, int count, const ruga_membrane_rest* rest,
                                ruga_triangle_lanes* triangles, double* energy) {
    rest_lanes lanes;
    load_rest(count, rest, &lanes);
    set_energies_of_kind(kind, poisson, count, &lanes, triangles, energy);
}

void ruga_triangle_lanes_set(ruga_triangle_lanes* one, const double* const x[3]) {
    for (int k = 0; k < 9; k++) {
        one->x[k / 3][k % 3][0] = x[k / 3][k % 3];
    }
}

double ruga_membrane_energy(ruga_membrane kind, double poisson, const ruga_membrane_rest* rest,
                            const double* const x[3], double gradient[3][3]) {
    ruga_triangle_lanes one;
    double energy;
    ruga_triangle_lanes_set(&one, x);
    ruga_membrane_lanes_energy(kind, poisson, 1, rest, &one, &energy);
    ruga_lanes_store(1, 3, one.gradient, gradient[0]);
    return energy;
}

// Multiplies the negative eigenvalues of [[a[0], a[1]], [a[1], a[2]]] by (1 - clamp). The projector on the
// eigenvector of the smaller eigenvalue l2 is (l1 I - a) / (l1 - l2).
RUGA_WIDE_PART void scale_negative(double clamp, double a[3]) {
    double mean = 0.5 * (a[0] + a[2]);
    double half = 0.5 * (a[0] - a[2]);
    double radius = sqrt(half * half + a[1] * a[1]);
    double l1 = mean + radius, l2 = mean - radius;
    double least = l2 < 0 ? l2 : 0, part = clamp * least / (l1 - l2);
    bool both = l1 <= 0 && l2 < 0;
    double keep = both ? 1 - clamp : 1, s = both || least == 0 ? 0 : part;
    a[0] = keep * a[0] - s * (l1 - a[0]);
    a[1] = keep * a[1] + s * a[1];
    a[2] = keep * a[2] - s * (l1 - a[2]);
}

RUGA_WIDE_PART void set_block(double (*left)[3], double (*right)[3], const double s[3], const double n[2],
                              const double other[2], double (*block)[RUGA_LANES], int lane) {
    double geometric =
        n[0] * (s[0] * other[0] + s[1] * other[1]) + n[1] * (s[1] * other[0] + s[2] * other[1]);
    for (int k = 0; k < 9; k++) {
        int r = k / 3, c = k % 3;
        double sum = left[0][r] * right[0][c] + left[1][r] * right[1][c] + left[2][r] * right[2][c];
        block[k][lane] = r == c ? sum + geometric : sum;
    }
}

RUGA_WIDE_PART void set_hessians(ruga_membrane kind, double poisson, int count,
                                 const rest_lanes* restrict lanes, double clamp,
                                 ruga_triangle_lanes* restrict t) {
    for (int lane = 0; lane < count; lane++) {
        ruga_membrane_rest rest;
        point p;
        evaluate_lane(kind, poisson, lanes, t, lane, &rest, &p);
        double* s = p.stress;
        scale_negative(clamp, s);
        double q[3] = {rest.stretch - p.z[0] * s[0], rest.stretch * poisson, rest.stretch - p.z[1] * s[2]};
        scale_negative(clamp, q);
        // Derivatives of e_u, e_v and w_u.w_v with respect to each corner; `left` holds q times the first two
        // and the shear stiffness times the last.
        double right[2][3][3], left[2][3][3], (*n)[2] = rest.slope;
        for (int i = 0; i < 2; i++) {
            for (int c = 0; c < 3; c++) {
                double eu = n[i][0] * p.f[0][c], ev = n[i][1] * p.f[1][c];
                right[i][0][c] = eu;
                right[i][1][c] = ev;
                right[i][2][c] = n[i][0] * p.w[1][c] + n[i][1] * p.w[0][c];
                left[i][0][c] = q[0] * eu + q[1] * ev;
                left[i][1][c] = q[1] * eu + q[2] * ev;
                left[i][2][c] = rest.shear * right[i][2][c];
            }
        }
        set_block(left[0], right[0], s, n[0], n[0], t->block[0], lane);
        set_block(left[1], right[0], s, n[1], n[0], t->block[1], lane);
        set_block(left[1], right[1], s, n[1], n[1], t->block[2], lane);
    }
}

RUGA_WIDE static void set_hessians_of_kind(ruga_membrane kind, double poisson, int count,
                                           const rest_lanes* rest, double clamp, ruga_triangle_lanes* t) {
    if (kind == RUGA_MEMBRANE_BARAFF_WITKIN) {
        set_hessians(RUGA_MEMBRANE_BARAFF_WITKIN, poisson, count, rest, clamp, t);
    } else {
        set_hessians(RUGA_MEMBRANE_STVK, poisson, count, rest, clamp, t);
    }
}

void ruga_membrane_lanes_hessian(ruga_membrane kind, double poisson, int count,
                                 const ruga_membrane_rest* rest, double clamp,
                                 ruga_triangle_lanes* triangles) {
    rest_lanes lanes;
    load_rest(count, rest, &lanes);
    set_hessians_of_kind(kind, poisson, count, &lanes, clamp, triangles);
}

void ruga_triangle_lanes_blocks(int count, const ruga_triangle_lanes* t,
                                double (*block)[RUGA_TRIANGLE_BLOCKS][9]) {
    for (int i = 0; i < count; i++) {
        double(*b)[9] = block[i];
        for (int k = 0; k < 9; k++) {
            int transposed = 3 * (k % 3) + k / 3;
            double b11 = t->block[0][k][i], b21 = t->block[1][k][i], b12 = t->block[1][transposed][i];
            double b22 = t->block[2][k][i];
            b[0][k] = (b11 + b22) + (b21 + b12);
            b[1][k] = b11;
            b[2][k] = b22;
            b[3][k] = -(b11 + b12);
            b[4][k] = -(b21 + b22);
            b[5][k] = b21;
        }
    }
}

void ruga_membrane_hessian(ruga_membrane kind, double poisson, const ruga_membrane_rest* rest,
                           const double* const x[3], double clamp, double block[RUGA_TRIANGLE_BLOCKS][9]) {
    ruga_triangle_lanes one;
    ruga_triangle_lanes_set(&one, x);
    ruga_membrane_lanes_hessian(kind, poisson, 1, rest, clamp, &one);
    ruga_triangle_lanes_blocks(1, &one, (double(*)[RUGA_TRIANGLE_BLOCKS][9])block);
}

// e_a' = f_a.w_a', (w_u.w_v)' = w_u'.w_v + w_u.w_v', w' as w is of x.
void ruga_membrane_damp(ruga_membrane kind, double poisson, const ruga_membrane_rest* rest,
                        const double* const x[3], const double* const v[3], double force[3][3]) {
    point p;
    double e1[3], e2[3], w[2][3];
    evaluate(kind, poisson, rest, x, &p);
    ruga_subtract(v[1], v[0], e1);
    ruga_subtract(v[2], v[0], e2);
    for (int a = 0; a < 2; a++) {
        for (int c = 0; c < 3; c++) {
            w[a][c] = rest->slope[0][a] * e1[c] + rest->slope[1][a] * e2[c];
        }
    }
    double eu = ruga_dot(p.f[0], w[0]), ev = ruga_dot(p.f[1], w[1]);
    double su = rest->stretch * (eu + poisson * ev), sv = rest->stretch * (ev + poisson * eu);
    double shear = rest->shear * (ruga_dot(w[0], p.w[1]) + ruga_dot(p.w[0], w[1]));
    for (int c = 0; c < 3; c++) {
        double pu = su * p.f[0][c] + shear * p.w[1][c];
        double pv = sv * p.f[1][c] + shear * p.w[0][c];
        force[1][c] = rest->slope[0][0] * pu + rest->slope[0][1] * pv;
        force[2][c] = rest->slope[1][0] * pu + rest->slope[1][1] * pv;
        force[0][c] = -(force[1][c] + force[2][c]);
    }
}
