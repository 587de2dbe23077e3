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
// At the minimum over f, with moment m_e = dE/dt_e, dE/dx = sum m_e grad t_e. The Hessian is that over x and
// f together with f eliminated; ruga_shell hands out its three parts.
#include "shell/directors.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <string.h>

static const double TOLERANCE_SQUARE = 1e-30; // of the residual in conjugate gradients
enum { MAX_ITERATIONS = 2000 };

// ---- one triangle --------------------------------------------------------------------------------------

// Leaves edge k free: K becomes its Schur complement.
static void release_edge(int k, double stiffness[3][3]) {
    double pivot = stiffness[k][k], row[3];
    memcpy(row, stiffness[k], sizeof row);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            bool released = i == k || j == k;
            stiffness[i][j] = released ? 0 : stiffness[i][j] - row[i] * row[j] / pivot;
        }
    }
}

void ruga_director_stiffness(const ruga_membrane_rest* rest, double area, double bending, double poisson,
                             const bool rim[3], double stiffness[3][3]) {
    double g[3][2], length[3];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 2; a++) {
            const double slope[3] = {-rest->slope[0][a] - rest->slope[1][a], rest->slope[0][a],
                                     rest->slope[1][a]};
            g[i][a] = slope[(i + 2) % 3];
        }
        length[i] = hypot(g[i][0], g[i][1]);
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double product = g[i][0] * g[j][0] + g[i][1] * g[j][1], both = length[i] * length[j];
            stiffness[i][j] =
                4 * area * bending * ((1 - poisson) * product * product + poisson * both * both) / both;
        }
    }
    for (int i = 0; i < 3; i++) {
        if (rim[i]) {
            release_edge(i, stiffness);
        }
    }
}

// ---- the mesh ------------------------------------------------------------------------------------------

// Local number of hinge h in triangle f.
static int local_edge(const ruga_directors* d, int f, int h) {
    return d->triangle_hinge[f][0] == h ? 0 : d->triangle_hinge[f][1] == h ? 1 : 2;
}

static ruga_status set_matrix(ruga_directors* d) {
    int(*pair)[2] = NULL, count = 0;
    RUGA_TRY(RUGA_NEW(pair, 3 * (size_t)d->triangle_count));
    for (int f = 0; f < d->triangle_count; f++) {
        for (int i = 0; i < 3; i++) {
            int a = d->triangle_hinge[f][i], b = d->triangle_hinge[f][(i + 1) % 3];
            if (a >= 0 && b >= 0) {
                pair[count][0] = a;
                pair[count++][1] = b;
            }
        }
    }
    ruga_status status = ruga_sparse_from_pairs(d->hinge_count, 1, count, (const int(*)[2])pair, &d->matrix);
    ruga_release(pair);
    RUGA_TRY(status);
    for (int f = 0; f < d->triangle_count; f++) {
        for (int i = 0; i < 9; i++) {
            int a = d->triangle_hinge[f][i / 3], b = d->triangle_hinge[f][i % 3];
            if (a < b || b < 0) {
                continue;
            }
            double sign = (d->hinge_triangle[a][0] == f) == (d->hinge_triangle[b][0] == f) ? 1 : -1;
            d->matrix.value[ruga_sparse_find(&d->matrix, a, b)] += sign * d->stiffness[f][i / 3][i % 3];
        }
    }
    for (int h = 0; h < d->hinge_count; h++) {
        d->diagonal[h] = d->matrix.value[d->matrix.start[h]];
    }
    return RUGA_OK;
}

// The vertices that an edge's row reaches, each once; returns how many.
static int edge_vertices(const ruga_directors* d, int h, int vertex[RUGA_DIRECTOR_VERTICES]) {
    int count = 0;
    for (int k = 0; k < 2 * 3 * 4; k++) {
        int f = d->hinge_triangle[h][k / 12], other = d->triangle_hinge[f][k / 4 % 3];
        if (other < 0) {
            continue;
        }
        int v = d->hinge[other][k % 4], i = 0;
        while (i < count && vertex[i] != v) {
            i++;
        }
        if (i == count) {
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
    RUGA_TRY(RUGA_NEW(d->stiffness, triangle_count));
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
    RUGA_TRY(set_matrix(d));
    return set_slots(d);
}

void ruga_directors_clear(ruga_directors* d) {
    void* const owned[] = {d->weight,   d->stiffness, d->hinge_triangle, d->start,
                           d->edge,     d->slot,      d->slot_vertex,    d->rotation,
                           d->residual, d->image,     d->direction,      d->diagonal};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    ruga_sparse_clear(&d->matrix);
    *d = (ruga_directors){.vertex_count = 0};
}

// ---- rotations and moments -----------------------------------------------------------------------------

// a of the triangle's edges, and K a.
static void triangle_moments(const ruga_directors* d, int f, const double* angle, const double* rotation,
                             double moment[3]) {
    double a[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        int h = d->triangle_hinge[f][i];
        if (h >= 0) {
            bool first = d->hinge_triangle[h][0] == f;
            a[i] = d->weight[h][!first] * angle[h] + (first ? rotation[h] : -rotation[h]);
        }
    }
    for (int i = 0; i < 3; i++) {
        moment[i] =
            d->stiffness[f][i][0] * a[0] + d->stiffness[f][i][1] * a[1] + d->stiffness[f][i][2] * a[2];
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

void ruga_directors_settle(ruga_directors* d, const double* angle, double* moment) {
    double of[3];
    memset(d->rotation, 0, (size_t)d->hinge_count * sizeof *d->rotation);
    memset(moment, 0, (size_t)d->hinge_count * sizeof *moment);
    for (int f = 0; f < d->triangle_count; f++) {
        triangle_moments(d, f, angle, d->rotation, of);
        for (int i = 0; i < 3; i++) {
            int h = d->triangle_hinge[f][i];
            if (h >= 0) {
                moment[h] -= d->hinge_triangle[h][0] == f ? of[i] : -of[i];
            }
        }
    }
    ruga_directors_solve(d, moment, d->rotation);
    memset(moment, 0, (size_t)d->hinge_count * sizeof *moment);
    for (int f = 0; f < d->triangle_count; f++) {
        triangle_moments(d, f, angle, d->rotation, of);
        for (int i = 0; i < 3; i++) {
            int h = d->triangle_hinge[f][i];
            if (h >= 0) {
                moment[h] += d->weight[h][d->hinge_triangle[h][0] != f] * of[i];
            }
        }
    }
}

// d2E/df_e dx = sum over the edge's triangles of +-K_ej w_j grad t_j.
void ruga_directors_coupling(const ruga_directors* d, double (*const gradient)[4][3], double (*value)[3]) {
    memset(value, 0, (size_t)d->start[d->vertex_count] * sizeof *value);
    for (int h = 0; h < d->hinge_count; h++) {
        for (int k = 0; k < 2 * 3 * 4; k++) {
            int f = d->hinge_triangle[h][k / 12], j = k / 4 % 3, other = d->triangle_hinge[f][j], i = 0;
            if (other < 0) {
                continue;
            }
            double part =
                d->weight[other][d->hinge_triangle[other][0] != f] * d->stiffness[f][local_edge(d, f, h)][j];
            while (d->slot_vertex[h][i] != d->hinge[other][k % 4]) {
                i++;
            }
            ruga_add_scaled(k < 12 ? part : -part, gradient[other][k % 4], value[d->slot[h][i]]);
        }
    }
}
