// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A Kirchhoff-Love bending energy with directors at the middles of edges (Morley 1968 for plates; Grinspun,
// Gingold, Reisman and Zorin 2006, "Computing discrete shape operators on general meshes", eq. 4, for
// shells). At edge i the director leans by a_i from the triangle's normal, about the edge; the change of the
// second fundamental form since rest is constant on the triangle,
//     b = sum_i a_i (l_i / A) m_i m_i^T = sum_i 2 a_i g_i g_i^T / |g_i|,
// l_i the edge's length, m_i its normal in the plane, g_i the gradient of the shape function of the corner
// opposite it, all at rest. The energy is that of a plate, E = A D/2 [(1 - nu) b:b + nu (tr b)^2] = a.K a / 2
// with
//     K_ij = 4 A D [(1 - nu) (g_i.g_j)^2 + nu |g_i|^2 |g_j|^2] / (|g_i| |g_j|).
// The two triangles at an edge share the director, so that their a add up to the change t of the hinge's
// angle:
//     a = w t + f in the one, a = w' t - f in the other, w + w' = 1.
// w is the other triangle's part of K_ii + K'_ii, which keeps f small, whatever the two weigh; f is what the
// mesh's shape makes of it. Averaged normals (f = 0, w = 1/2) are wrong by tens of percent on irregular
// meshes, however fine. Here f is where the energy is least: M f = -c(t), M constant, positive definite and,
// as a mass matrix is, well conditioned, so that conjugate gradients scaled by its diagonal find it to
// round-off in some tens of steps. (The same as the lowest-order method of Hellan, Herrmann and Johnson:
// hinges are what its matrix becomes when it is lumped, at nu = -1/3 on equilateral triangles.) At the rim a
// is free by itself.
//
// A constant b is too soft for short waves and so for a point load (its own neighbourhood gives way by some
// 0.1 P edge^2 / D more than a plate): of a plane wave of wavenumber k, along angle theta, on equilateral
// triangles of edge l it has the energy of a plate times 1 - c (k l)^2 + O((k l)^4),
//     c = [(3 + nu)^3 - (1 - nu)^3 cos 6 theta] / [192 (1 - nu^2)],
// 12 % less for 8 edges per wavelength at nu = 0.3. What is missing is how b varies within a triangle, and
// that shows in its jumps from one to the next. So each hinge adds
//     E_h = beta s/2 [(1 - nu) [b]:[b] + nu (tr [b])^2],    s = 2/3 of the harmonic mean of A D,
// [b] the jump between its two triangles, laid flat about their edge; it vanishes where b is constant. Of the
// plane wave, with the rotations again where the energy is least, this makes c vanish, but for the part with
// cos 6 theta, at
//     beta = sqrt((3 + nu)^3 / (128 (1 - nu^2))).
// (Were the rotations held, 1/4 would do, the variance of a linear b within a triangle; they give way, so
// that it takes more. script/director_symbol.py computes c and beta from the element.) Without the term the
// energy is sum a.K a / 2 over triangles, with it a.Q a / 2, where Q has blocks between neighbours as well.
//
// At the minimum over f, with moment m_e = dE/dt_e, dE/dx = sum m_e grad t_e. The Hessian is that over x and
// f together with f eliminated; ruga_shell hands out its three parts.
#include "shell/directors.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

static const double TOLERANCE_SQUARE = 1e-30; // of the residual in conjugate gradients
enum { MAX_ITERATIONS = 2000 };

// ---- one triangle --------------------------------------------------------------------------------------

// Gradients of the shape functions, edge i's the one of the corner opposite it.
static void edge_gradients(const ruga_membrane_rest* rest, double g[3][2]) {
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 2; a++) {
            const double slope[3] = {-rest->slope[0][a] - rest->slope[1][a], rest->slope[0][a],
                                     rest->slope[1][a]};
            g[i][a] = slope[(i + 2) % 3];
        }
    }
}

// (1 - nu) p:q + nu tr p tr q of (p_xx, p_yy, p_xy).
static double product(double poisson, const double p[3], const double q[3]) {
    return p[0] * q[0] + p[1] * q[1] + poisson * (p[0] * q[1] + p[1] * q[0]) +
           2 * (1 - poisson) * p[2] * q[2];
}

// Edge k turns as the others make it turn: least energy, in which b is orthogonal to what a_k makes of it.
static void release_edge(int k, double poisson, double form[3][3]) {
    double square = product(poisson, form[k], form[k]), released[3];
    memcpy(released, form[k], sizeof released);
    for (int i = 0; i < 3; i++) {
        double part = i == k ? 1 : product(poisson, form[i], released) / square;
        ruga_add_scaled(-part, released, form[i]);
    }
    memset(form[k], 0, sizeof form[k]);
}

void ruga_director_form(const ruga_membrane_rest* rest, double poisson, const bool rim[3],
                        double form[3][3]) {
    double g[3][2];
    edge_gradients(rest, g);
    for (int i = 0; i < 3; i++) {
        double scale = 2 / hypot(g[i][0], g[i][1]);
        form[i][0] = scale * g[i][0] * g[i][0];
        form[i][1] = scale * g[i][1] * g[i][1];
        form[i][2] = scale * g[i][0] * g[i][1];
    }
    for (int i = 0; i < 3; i++) {
        if (rim[i]) {
            release_edge(i, poisson, form);
        }
    }
}

static void add_products(double scale, double poisson, double p[3][3], double q[3][3], double matrix[3][3]) {
    for (int i = 0; i < 9; i++) {
        matrix[i / 3][i % 3] += scale * product(poisson, p[i / 3], q[i % 3]);
    }
}

void ruga_director_stiffness(double scale, double poisson, double form[3][3], double stiffness[3][3]) {
    memset(stiffness, 0, 3 * sizeof *stiffness);
    add_products(scale, poisson, form, form, stiffness);
}

// form by the axes of edge i: its normal, times `side`, and that turned by a right angle.
static void turn_form(const ruga_membrane_rest* rest, int i, double side, double form[3][3],
                      double turned[3][3]) {
    double g[3][2];
    edge_gradients(rest, g);
    double scale = side / hypot(g[i][0], g[i][1]), c = scale * g[i][0], s = scale * g[i][1];
    for (int k = 0; k < 3; k++) {
        const double* b = form[k];
        turned[k][0] = c * c * b[0] + s * s * b[1] + 2 * c * s * b[2];
        turned[k][1] = s * s * b[0] + c * c * b[1] - 2 * c * s * b[2];
        turned[k][2] = c * s * (b[1] - b[0]) + (c * c - s * s) * b[2];
    }
}

// ---- the mesh ------------------------------------------------------------------------------------------

// beta of the head.
double ruga_director_jump(double poisson) {
    return sqrt(pow(3 + poisson, 3) / (128 * (1 - poisson * poisson)));
}

// Local number of hinge h in triangle f.
static int local_edge(const ruga_directors* d, int f, int h) {
    return d->triangle_hinge[f][0] == h ? 0 : d->triangle_hinge[f][1] == h ? 1 : 2;
}

// Triangle f (k = 0) or its neighbour across edge k - 1, and second derivatives by the a of f and of that
// one; -1 where there is none.
static int neighbour(const ruga_directors* d, int f, int k, double block[3][3]) {
    if (k == 0) {
        memcpy(block, d->stiffness[f], sizeof d->stiffness[f]);
        return f;
    }
    int h = d->triangle_hinge[f][k - 1];
    if (h < 0) {
        return -1;
    }
    bool first = d->hinge_triangle[h][0] == f;
    for (int i = 0; i < 9; i++) {
        int r = i / 3, c = i % 3;
        block[r][c] = first ? d->cross[h][r][c] : d->cross[h][c][r];
    }
    return d->hinge_triangle[h][first];
}

void ruga_directors_join(ruga_directors* d, int h, const ruga_membrane_rest* rest, double (*form)[3][3],
                         double scale, double poisson) {
    double turned[2][3][3], s = scale * ruga_director_jump(poisson);
    for (int side = 0; side < 2; side++) {
        int f = d->hinge_triangle[h][side];
        turn_form(&rest[f], local_edge(d, f, h), side ? -1 : 1, form[f], turned[side]);
        add_products(s, poisson, turned[side], turned[side], d->stiffness[f]);
    }
    add_products(-s, poisson, turned[0], turned[1], d->cross[h]);
}

static ruga_status matrix_pattern(ruga_directors* d) {
    int(*pair)[2] = NULL, count = 0;
    double block[3][3];
    RUGA_TRY(RUGA_NEW(pair, 4 * 9 * (size_t)d->triangle_count));
    for (int k = 0; k < 4 * 9 * d->triangle_count; k++) {
        int f = k / 36, g = neighbour(d, f, k / 9 % 4, block);
        int a = d->triangle_hinge[f][k % 9 / 3], b = g < 0 ? -1 : d->triangle_hinge[g][k % 3];
        if (a > b && b >= 0) {
            pair[count][0] = a;
            pair[count++][1] = b;
        }
    }
    ruga_status status = ruga_sparse_from_pairs(d->hinge_count, 1, count, (const int(*)[2])pair, &d->matrix);
    ruga_release(pair);
    return status;
}

static void set_matrix(ruga_directors* d) {
    double block[3][3];
    for (int k = 0; k < 4 * 9 * d->triangle_count; k++) {
        int f = k / 36, g = neighbour(d, f, k / 9 % 4, block), i = k % 9 / 3, j = k % 3;
        int a = d->triangle_hinge[f][i], b = g < 0 ? -1 : d->triangle_hinge[g][j];
        if (a >= b && b >= 0) {
            double sign = (d->hinge_triangle[a][0] == f) == (d->hinge_triangle[b][0] == g) ? 1 : -1;
            d->matrix.value[ruga_sparse_find(&d->matrix, a, b)] += sign * block[i][j];
        }
    }
    for (int h = 0; h < d->hinge_count; h++) {
        d->diagonal[h] = d->matrix.value[d->matrix.start[h]];
    }
}

// An edge's row reaches the edges of its two triangles and of their neighbours: number k of these eight, the
// neighbour k % 4 of the triangle f on side k / 4; -1 where there is none.
static int reach(const ruga_directors* d, int h, int k, int* f, double block[3][3]) {
    *f = d->hinge_triangle[h][k / 4];
    return neighbour(d, *f, k % 4, block);
}

// The vertices that an edge's row reaches, each once; returns how many.
static int edge_vertices(const ruga_directors* d, int h, int vertex[RUGA_DIRECTOR_VERTICES]) {
    int count = 0, f;
    double block[3][3];
    for (int k = 0; k < 8 * 12; k++) {
        int g = reach(d, h, k / 12, &f, block), other = g < 0 ? -1 : d->triangle_hinge[g][k / 4 % 3];
        int v = other < 0 ? -1 : d->hinge[other][k % 4], i = 0;
        while (v >= 0 && i < count && vertex[i] != v) {
            i++;
        }
        if (v >= 0 && i == count) {
            RUGA_ASSERT(count < RUGA_DIRECTOR_VERTICES);
            vertex[count++] = v;
        }
    }
    return count;
}

// Edges in ascending order, so that each vertex's are ascending.
static ruga_status set_slots(ruga_directors* d) {
    RUGA_TRY(RUGA_NEW_ZERO(d->start, d->vertex_count + 2));
    for (int h = 0; h < d->hinge_count; h++) {
        int count = edge_vertices(d, h, d->slot_vertex[h]);
        for (int i = 0; i < count; i++) {
            d->start[d->slot_vertex[h][i] + 2]++;
        }
        for (int i = 0; i < RUGA_DIRECTOR_VERTICES; i++) {
            d->slot[h][i] = i < count ? 0 : -1;
        }
    }
    for (int v = 0; v < d->vertex_count; v++) {
        d->start[v + 2] += d->start[v + 1];
    }
    RUGA_TRY(RUGA_NEW(d->edge, d->start[d->vertex_count + 1]));
    for (int h = 0; h < d->hinge_count; h++) {
        for (int i = 0; i < RUGA_DIRECTOR_VERTICES && d->slot[h][i] >= 0; i++) {
            int at = d->start[d->slot_vertex[h][i] + 1]++;
            d->slot[h][i] = at;
            d->edge[at] = h;
        }
    }
    return RUGA_OK;
}

ruga_status ruga_directors_create(int vertex_count, int triangle_count, const int (*triangle_hinge)[3],
                                  int hinge_count, const int (*hinge)[4], ruga_directors* d) {
    *d = (ruga_directors){.vertex_count = vertex_count,
                          .triangle_count = triangle_count,
                          .hinge_count = hinge_count,
                          .triangle_hinge = triangle_hinge,
                          .hinge = hinge};
    RUGA_TRY(RUGA_NEW_ZERO(d->stiffness, triangle_count));
    RUGA_TRY(RUGA_NEW_ZERO(d->cross, hinge_count));
    RUGA_TRY(RUGA_NEW(d->lean, triangle_count));
    RUGA_TRY(RUGA_NEW(d->hinge_triangle, hinge_count));
    RUGA_TRY(RUGA_NEW(d->weight, hinge_count));
    RUGA_TRY(RUGA_NEW(d->slot, hinge_count));
    RUGA_TRY(RUGA_NEW(d->slot_vertex, hinge_count));
    RUGA_TRY(RUGA_NEW(d->rotation, hinge_count));
    RUGA_TRY(RUGA_NEW(d->residual, hinge_count));
    RUGA_TRY(RUGA_NEW(d->image, hinge_count));
    RUGA_TRY(RUGA_NEW(d->direction, hinge_count));
    return RUGA_NEW(d->diagonal, hinge_count);
}

ruga_status ruga_directors_link(ruga_directors* d) {
    for (int h = 0; h < d->hinge_count; h++) {
        double own[2];
        for (int side = 0; side < 2; side++) {
            int f = d->hinge_triangle[h][side], i = local_edge(d, f, h);
            own[side] = d->stiffness[f][i][i];
        }
        d->weight[h][0] = own[1] / (own[0] + own[1]);
        d->weight[h][1] = own[0] / (own[0] + own[1]);
    }
    RUGA_TRY(matrix_pattern(d));
    set_matrix(d);
    return set_slots(d);
}

void ruga_directors_clear(ruga_directors* d) {
    void* const owned[] = {
        d->weight,      d->stiffness, d->cross,    d->hinge_triangle, d->start,     d->edge,     d->slot,
        d->slot_vertex, d->rotation,  d->residual, d->image,          d->direction, d->diagonal, d->lean};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    ruga_sparse_clear(&d->matrix);
    *d = (ruga_directors){.vertex_count = 0};
}

// ---- rotations and moments -----------------------------------------------------------------------------

// a of all triangles' edges.
static void set_leans(const ruga_directors* d, const double* angle) {
    for (int f = 0; f < d->triangle_count; f++) {
        for (int i = 0; i < 3; i++) {
            int h = d->triangle_hinge[f][i];
            bool first = h >= 0 && d->hinge_triangle[h][0] == f;
            d->lean[f][i] =
                h < 0 ? 0 : d->weight[h][!first] * angle[h] + (first ? d->rotation[h] : -d->rotation[h]);
        }
    }
}

// Derivatives of the energy by the triangle's a.
static void triangle_moments(const ruga_directors* d, int f, double moment[3]) {
    memset(moment, 0, 3 * sizeof *moment);
    for (int k = 0; k < 4; k++) {
        double block[3][3];
        int g = neighbour(d, f, k, block);
        for (int i = 0; i < 3 && g >= 0; i++) {
            moment[i] += ruga_dot(block[i], d->lean[g]);
        }
    }
}

static double dot(int n, const double* a, const double* b) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Conjugate gradients from zero, so that nothing depends on what was computed before.
void ruga_directors_solve(ruga_directors* d, const double* right, double* x) {
    int n = d->hinge_count;
    double *r = d->residual, *p = d->direction, *image = d->image, rz = 0;
    for (int i = 0; i < n; i++) {
        r[i] = right[i];
        p[i] = r[i] / d->diagonal[i];
        rz += r[i] * p[i];
        x[i] = 0;
    }
    double start = rz;
    for (int k = 0; k < MAX_ITERATIONS && rz > TOLERANCE_SQUARE * start; k++) {
        ruga_sparse_multiply_symmetric(&d->matrix, p, image);
        double step = rz / dot(n, p, image), next = 0;
        for (int i = 0; i < n; i++) {
            x[i] += step * p[i];
            r[i] -= step * image[i];
            next += r[i] * r[i] / d->diagonal[i];
        }
        double keep = next / rz;
        for (int i = 0; i < n; i++) {
            p[i] = r[i] / d->diagonal[i] + keep * p[i];
        }
        rz = next;
    }
}

// moment [hinges] = of the triangles beside each: the second's less the first's, or, `weighed`, their mean.
static void sum_moments(ruga_directors* d, const double* angle, bool weighed, double* moment) {
    double of[3];
    memset(moment, 0, (size_t)d->hinge_count * sizeof *moment);
    set_leans(d, angle);
    for (int f = 0; f < d->triangle_count; f++) {
        triangle_moments(d, f, of);
        for (int i = 0; i < 3; i++) {
            int h = d->triangle_hinge[f][i];
            if (h >= 0) {
                int side = d->hinge_triangle[h][0] != f;
                moment[h] += (weighed ? d->weight[h][side] : 2 * side - 1) * of[i];
            }
        }
    }
}

void ruga_directors_settle(ruga_directors* d, const double* angle, double* moment) {
    memset(d->rotation, 0, (size_t)d->hinge_count * sizeof *d->rotation);
    sum_moments(d, angle, false, moment);
    ruga_directors_solve(d, moment, d->rotation);
    sum_moments(d, angle, true, moment);
}

// Adds the part of edge `h`'s row that comes from triangle g; row: second derivatives by f_e and g's a.
static void add_coupling(const ruga_directors* d, int h, int g, const double row[3],
                         double (*const gradient)[4][3], double (*value)[3]) {
    for (int k = 0; k < 12; k++) {
        int other = d->triangle_hinge[g][k / 4], i = 0;
        if (other < 0) {
            continue;
        }
        double part = row[k / 4] * d->weight[other][d->hinge_triangle[other][0] != g];
        while (d->slot_vertex[h][i] != d->hinge[other][k % 4]) {
            i++;
        }
        ruga_add_scaled(part, gradient[other][k % 4], value[d->slot[h][i]]);
    }
}

// d2E/df_e dx = sum over the edge's triangles and their neighbours of +-Q_ej w_j grad t_j.
void ruga_directors_coupling(const ruga_directors* d, double (*const gradient)[4][3], double (*value)[3]) {
    memset(value, 0, (size_t)d->start[d->vertex_count] * sizeof *value);
    for (int h = 0; h < d->hinge_count; h++) {
        for (int k = 0; k < 8; k++) {
            double block[3][3], sign = k < 4 ? 1 : -1;
            int f, g = reach(d, h, k, &f, block);
            if (g < 0) {
                continue;
            }
            const double* of = block[local_edge(d, f, h)];
            const double row[3] = {sign * of[0], sign * of[1], sign * of[2]};
            add_coupling(d, h, g, row, gradient, value);
        }
    }
}
