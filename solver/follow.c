// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Node positions of a sample with surface positions x_v, in two steps:
//   the rigid motion g nearest to the sample (Kabsch 1976): g(X) = R (X - X_c) + x_c;
//   what is left, u: sum_v (a_v / A) |(B u)_v - (x_v - g(X_v))|^2
//                    + (s / N) sum |u_a - 2 u_b + u_c|^2 + (1e-6 s / N) sum |u_a - u_b|^2 -> min,
// a_v the area of vertex v, A all of it, N the number of nodes, s the smoothness; a, b, c neighbours along an
// axis of the lattice. Second differences of affine maps are zero, so that these are followed but for the
// last sum, which only settles what the surface does not see, such as the depth of an open sheet. The matrix
// is the same for every sample and all components: one factor.
#include "solver/follow.h"

#include "core/memory.h"
#include "core/progress.h"
#include "core/vec3.h"
#include "lattice/svd3.h"
#include "solver/linear.h"

#include <limits.h>
#include <math.h>
#include <string.h>

static const double FIRST_DIFFERENCES = 1e-6; // of the smoothness

typedef struct job {
    const ruga_lattice* lattice;
    const ruga_mesh* mesh;
    const double* area; // [V]
    double total;       // area
    double smoothness;
    int *next[3], *previous[3]; // [N] neighbour along an axis, -1 = none
    ruga_sparse matrix;
    ruga_factor* factor;
    double *x, *left;        // [V][3] the sample, and what the rigid motion leaves of it
    double *load, *solution; // [N]
    double* force;           // [N][3]
} job;

// ---- the matrix ----------------------------------------------------------------------------------------

// Of several elements that hold a node the first one says who its neighbour is.
static void find_neighbours(job* j) {
    const ruga_lattice* l = j->lattice;
    const int side = l->degree + 1, step[3] = {1, side, side * side};
    for (int e = 0; e < l->element_count; e++) {
        const int* node = l->element_node + (size_t)e * (size_t)l->nodes_per_element;
        for (int i = 0; i < l->nodes_per_element; i++) {
            for (int axis = 0; axis < 3; axis++) {
                if (i / step[axis] % side + 1 == side) {
                    continue;
                }
                int a = node[i], b = node[i + step[axis]];
                if (j->next[axis][a] < 0 && j->previous[axis][b] < 0) {
                    j->next[axis][a] = b;
                    j->previous[axis][b] = a;
                }
            }
        }
    }
}

static ruga_status make_pattern(job* j) {
    const ruga_lattice* l = j->lattice;
    const int n = l->nodes_per_element;
    int(*pairs)[2] = NULL;
    int64_t count = 0, room = (int64_t)l->element_count * n * (n - 1) / 2 + 6 * (int64_t)l->node_count;
    RUGA_TRY(RUGA_NEW(pairs, room));
    for (int e = 0; e < l->element_count; e++) {
        const int* node = l->element_node + (size_t)e * (size_t)n;
        for (int a = 1; a < n; a++) {
            for (int b = 0; b < a; b++, count++) {
                pairs[count][0] = node[a];
                pairs[count][1] = node[b];
            }
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        for (int b = 0; b < l->node_count; b++) {
            int a = j->previous[axis][b], c = j->next[axis][b];
            if (c >= 0) {
                pairs[count][0] = b;
                pairs[count++][1] = c;
            }
            if (a >= 0 && c >= 0) {
                pairs[count][0] = a;
                pairs[count++][1] = c;
            }
        }
    }
    ruga_status status = ruga_sparse_from_pairs(l->node_count, 1, count, (const int(*)[2])pairs, &j->matrix);
    ruga_release(pairs);
    return status;
}

// The outer product of weights at nodes.
static void add_product(job* j, double factor, int count, const int* node, const double* weight) {
    for (int a = 0; a < count; a++) {
        for (int b = 0; b < count; b++) {
            if (node[a] >= node[b]) {
                j->matrix.value[ruga_sparse_find(&j->matrix, node[a], node[b])] +=
                    factor * weight[a] * weight[b];
            }
        }
    }
}

static void add_smoothness(job* j) {
    static const double second[3] = {1, -2, 1}, first[2] = {-1, 1};
    const double factor = j->smoothness / j->lattice->node_count;
    for (int axis = 0; axis < 3; axis++) {
        for (int b = 0; b < j->lattice->node_count; b++) {
            const int node[3] = {j->previous[axis][b], b, j->next[axis][b]};
            if (node[2] >= 0) {
                add_product(j, FIRST_DIFFERENCES * factor, 2, node + 1, first);
            }
            if (node[0] >= 0 && node[2] >= 0) {
                add_product(j, factor, 3, node, second);
            }
        }
    }
}

// sum of a_v / A times the outer product of the weights of v, vertices of one element together.
static ruga_status add_data(job* j) {
    const ruga_lattice* l = j->lattice;
    const size_t n = (size_t)l->nodes_per_element;
    int *start = NULL, *vertex = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(start, (size_t)l->element_count + 2));
    RUGA_TRY_DONE(RUGA_NEW(vertex, l->vertex_count));
    for (int v = 0; v < l->vertex_count; v++) {
        start[l->vertex_element[v] + 2]++;
    }
    for (int e = 0; e < l->element_count; e++) {
        start[e + 2] += start[e + 1];
    }
    for (int v = 0; v < l->vertex_count; v++) {
        vertex[start[l->vertex_element[v] + 1]++] = v;
    }
    for (int e = 0; e < l->element_count; e++) {
        double product[RUGA_LATTICE_NODES_MAX][RUGA_LATTICE_NODES_MAX] = {{0}};
        const int* node = l->element_node + (size_t)e * n;
        for (int i = start[e]; i < start[e + 1]; i++) {
            const double* weight = l->vertex_weight + (size_t)vertex[i] * n;
            for (size_t a = 0; a < n; a++) {
                for (size_t b = 0; b < n; b++) {
                    product[a][b] += j->area[vertex[i]] / j->total * weight[a] * weight[b];
                }
            }
        }
        for (size_t a = 0; start[e] < start[e + 1] && a < n; a++) {
            for (size_t b = 0; b < n; b++) {
                if (node[a] >= node[b]) {
                    j->matrix.value[ruga_sparse_find(&j->matrix, node[a], node[b])] += product[a][b];
                }
            }
        }
    }
done:
    ruga_release(start);
    ruga_release(vertex);
    return status;
}

static ruga_status make_factor(job* j) {
    ruga_factor_info info;
    find_neighbours(j);
    RUGA_TRY(make_pattern(j));
    RUGA_TRY(add_data(j));
    add_smoothness(j);
    RUGA_TRY(ruga_factor_create(RUGA_FACTOR_CHOLESKY, &j->matrix, j->matrix.rows, NULL, NULL, &j->factor));
    RUGA_TRY(ruga_factor_numeric(j->factor, j->matrix.value, &info));
    return info.success
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT,
                           "follow: the surface does not determine the lattice: give more follow.smoothness "
                           "(now %g)",
                           j->smoothness);
}

// ---- a sample ------------------------------------------------------------------------------------------

static void mean_position(const job* j, const double* x, double mean[3]) {
    mean[0] = mean[1] = mean[2] = 0;
    for (size_t v = 0; v < (size_t)j->mesh->vertex_count; v++) {
        ruga_add_scaled(j->area[v] / j->total, x + 3 * v, mean);
    }
}

// rotation = V U^T of sum a (X - X_c) (x - x_c)^T = U S V^T
static void fit_rotation(const job* j, const double rest_mean[3], const double mean[3], double rotation[9]) {
    double product[9] = {0}, u[9], s[3], v[9];
    for (size_t k = 0; k < (size_t)j->mesh->vertex_count; k++) {
        double from[3], to[3];
        ruga_subtract(j->mesh->position + 3 * k, rest_mean, from);
        ruga_subtract(j->x + 3 * k, mean, to);
        for (int i = 0; i < 9; i++) {
            product[i] += j->area[k] / j->total * from[i / 3] * to[i % 3];
        }
    }
    ruga_svd3(product, u, s, v);
    for (int i = 0; i < 9; i++) {
        const double *row = v + 3 * (size_t)(i / 3), *column = u + 3 * (size_t)(i % 3);
        rotation[i] = row[0] * column[0] + row[1] * column[1] + row[2] * column[2];
    }
}

static void move_rigidly(const double rotation[9], const double from[3], const double to[3], const double* x,
                         double* moved) {
    double d[3];
    ruga_subtract(x, from, d);
    ruga_multiply3(rotation, d, moved);
    ruga_add_scaled(1, to, moved);
}

static ruga_status fit_sample(job* j, double* q) {
    const ruga_lattice* l = j->lattice;
    double rest_mean[3], mean[3], rotation[9];
    mean_position(j, j->mesh->position, rest_mean);
    mean_position(j, j->x, mean);
    fit_rotation(j, rest_mean, mean, rotation);
    for (size_t v = 0; v < (size_t)l->vertex_count; v++) {
        double moved[3];
        move_rigidly(rotation, rest_mean, mean, j->mesh->position + 3 * v, moved);
        for (size_t i = 0; i < 3; i++) {
            j->left[3 * v + i] = j->area[v] / j->total * (j->x[3 * v + i] - moved[i]);
        }
    }
    memset(j->force, 0, 3 * (size_t)l->node_count * sizeof *j->force);
    ruga_lattice_embed_transpose(l, j->left, j->force);
    for (size_t a = 0; a < (size_t)l->node_count; a++) {
        move_rigidly(rotation, rest_mean, mean, l->rest + 3 * a, q + 3 * a);
    }
    for (size_t i = 0; i < 3; i++) {
        for (size_t a = 0; a < (size_t)l->node_count; a++) {
            j->load[a] = j->force[3 * a + i];
        }
        RUGA_TRY(ruga_factor_solve(j->factor, j->load, j->solution));
        for (size_t a = 0; a < (size_t)l->node_count; a++) {
            q[3 * a + i] += j->solution[a];
        }
    }
    return RUGA_OK;
}

// 1 - the smallest stretch of a triangle, from the metrics of its two edges: the least eigenvalue of G^-1 g.
static double triangle_compression(const int* t, const double* rest, const double* x) {
    double edge[2][2][3], m[2][3];
    for (int k = 0; k < 2; k++) {
        ruga_subtract(rest + 3 * (size_t)t[k + 1], rest + 3 * (size_t)t[0], edge[0][k]);
        ruga_subtract(x + 3 * (size_t)t[k + 1], x + 3 * (size_t)t[0], edge[1][k]);
    }
    for (int k = 0; k < 2; k++) {
        m[k][0] = ruga_dot(edge[k][0], edge[k][0]);
        m[k][1] = ruga_dot(edge[k][0], edge[k][1]);
        m[k][2] = ruga_dot(edge[k][1], edge[k][1]);
    }
    double det = m[0][0] * m[0][2] - m[0][1] * m[0][1];
    double half = (m[0][2] * m[1][0] - 2 * m[0][1] * m[1][1] + m[0][0] * m[1][2]) / (2 * det);
    double product = (m[1][0] * m[1][2] - m[1][1] * m[1][1]) / det;
    double least = half - sqrt(fmax(half * half - product, 0));
    return det > 0 ? 1 - sqrt(fmax(least, 0)) : 0;
}

static void judge_sample(const job* j, const double* q, ruga_follow* follow) {
    double sum = 0;
    ruga_lattice_embed(j->lattice, q, j->left);
    for (size_t v = 0; v < (size_t)j->mesh->vertex_count; v++) {
        double distance = ruga_distance(j->left + 3 * v, j->x + 3 * v);
        sum += j->area[v] / j->total * distance * distance;
    }
    follow->error = fmax(follow->error, sqrt(sum));
    for (size_t f = 0; f < (size_t)j->mesh->triangle_count; f++) {
        double compression = triangle_compression(j->mesh->triangle + 3 * f, j->mesh->position, j->left);
        follow->compression = fmax(follow->compression, compression);
    }
}

static ruga_status read_sample(job* j, const ruga_motion_def* def, int sample) {
    RUGA_TRY(ruga_progress("fitting the lattice to the moving surface", (double)sample / def->sample_count));
    RUGA_TRY(def->read(sample, j->x, def->context));
    for (size_t i = 0; i < 3 * (size_t)j->mesh->vertex_count; i++) {
        if (!isfinite(j->x[i])) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "follow: vertex %zu of sample %d has a coordinate that is not a number", i / 3,
                             sample);
        }
    }
    return RUGA_OK;
}

// ---- public --------------------------------------------------------------------------------------------

static ruga_status prepare(job* j) {
    size_t nodes = (size_t)j->lattice->node_count, vertices = (size_t)j->mesh->vertex_count;
    for (int axis = 0; axis < 3; axis++) {
        RUGA_TRY(RUGA_NEW(j->next[axis], nodes));
        RUGA_TRY(RUGA_NEW(j->previous[axis], nodes));
        memset(j->next[axis], 0xff, nodes * sizeof *j->next[axis]); // all -1
        memset(j->previous[axis], 0xff, nodes * sizeof *j->previous[axis]);
    }
    RUGA_TRY(RUGA_NEW(j->x, 3 * vertices));
    RUGA_TRY(RUGA_NEW(j->left, 3 * vertices));
    RUGA_TRY(RUGA_NEW(j->load, nodes));
    RUGA_TRY(RUGA_NEW(j->solution, nodes));
    RUGA_TRY(RUGA_NEW(j->force, 3 * nodes));
    for (size_t v = 0; v < vertices; v++) {
        j->total += j->area[v];
    }
    return make_factor(j);
}

static ruga_status fit(job* j, const ruga_motion_def* def, ruga_follow* follow) {
    follow->node_count = j->lattice->node_count;
    follow->count = def->sample_count;
    RUGA_TRY(prepare(j));
    RUGA_TRY(RUGA_NEW(follow->time, follow->count));
    RUGA_TRY(RUGA_NEW(follow->q, 3 * (size_t)follow->count * (size_t)follow->node_count));
    for (int k = 0; k < follow->count; k++) {
        double* q = follow->q + 3 * (size_t)k * (size_t)follow->node_count;
        follow->time[k] = def->times[k];
        if (!isfinite(def->times[k]) || (k > 0 && !(def->times[k] > def->times[k - 1]))) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "follow: the time of sample %d, %g s, is not later than that before it", k,
                             def->times[k]);
        }
        RUGA_TRY(read_sample(j, def, k));
        RUGA_TRY(fit_sample(j, q));
        judge_sample(j, q, follow);
    }
    return RUGA_OK;
}

ruga_status ruga_follow_create(const ruga_lattice* lattice, const ruga_mesh* mesh, const double* area,
                               const ruga_motion_def* def, ruga_follow* follow) {
    job j = {.lattice = lattice, .mesh = mesh, .area = area, .smoothness = def->smoothness};
    *follow = (ruga_follow){0};
    RUGA_ASSERT(def->sample_count > 0 && lattice->vertex_count == mesh->vertex_count);
    if (!(def->smoothness > 0) || !isfinite(def->smoothness)) {
        return ruga_fail(RUGA_BAD_INPUT, "follow.smoothness is %g; it must be above 0", def->smoothness);
    }
    ruga_status status = fit(&j, def, follow);
    for (int axis = 0; axis < 3; axis++) {
        ruga_release(j.next[axis]);
        ruga_release(j.previous[axis]);
    }
    ruga_release(j.x);
    ruga_release(j.left);
    ruga_release(j.load);
    ruga_release(j.solution);
    ruga_release(j.force);
    ruga_factor_destroy(&j.factor);
    ruga_sparse_clear(&j.matrix);
    if (status != RUGA_OK) {
        ruga_follow_clear(follow);
    }
    return status;
}

void ruga_follow_clear(ruga_follow* follow) {
    ruga_release(follow->time);
    ruga_release(follow->q);
    *follow = (ruga_follow){0};
}

void ruga_follow_at(const ruga_follow* follow, double time, double* q) {
    size_t numbers = 3 * (size_t)follow->node_count;
    int next = 0;
    while (next < follow->count && follow->time[next] <= time) {
        next++;
    }
    size_t a = (size_t)(next > 0 ? next - 1 : 0),
           b = (size_t)(next < follow->count ? next : follow->count - 1);
    double s = a == b ? 0 : (time - follow->time[a]) / (follow->time[b] - follow->time[a]);
    for (size_t i = 0; i < numbers; i++) {
        q[i] = (1 - s) * follow->q[a * numbers + i] + s * follow->q[b * numbers + i];
    }
}
