// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Pasternak foundation. With A_i the lumped area of vertex i and w_e the cotangent weight of edge e = (i, j):
//     E = 1/2 sum_i a A_i |d_i|^2 + 1/2 sum_e b w_e |d_i - d_j|^2,
//     gradient_i = a A_i d_i + sum_j b w_ij (d_i - d_j).
// Where b varies, b w_e is the sum over the two triangles beside e of b (mean of the corners) times its
// cotangent / 2. A displacement A sin(k x) of a flat sheet along its normal has the energy (a + b k^2) A^2 /
// 4 per area.
#include "constraints/foundation.h"

#include "constraints/laplacian.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"

#include <string.h>

static ruga_status copy_topology(const ruga_connectivity* c, ruga_foundation* f) {
    RUGA_TRY(RUGA_NEW(f->edge, c->edge_count));
    RUGA_TRY(RUGA_NEW(f->neighbour_start, c->vertex_count + 1));
    RUGA_TRY(RUGA_NEW(f->neighbour, 2 * (size_t)c->edge_count));
    RUGA_TRY(RUGA_NEW(f->neighbour_edge, 2 * (size_t)c->edge_count));
    memcpy(f->edge, c->edge, (size_t)c->edge_count * sizeof *f->edge);
    memcpy(f->neighbour_start, c->neighbour_start,
           (size_t)(c->vertex_count + 1) * sizeof *f->neighbour_start);
    memcpy(f->neighbour, c->neighbour, 2 * (size_t)c->edge_count * sizeof *f->neighbour);
    memcpy(f->neighbour_edge, c->neighbour_edge, 2 * (size_t)c->edge_count * sizeof *f->neighbour_edge);
    return RUGA_OK;
}

static double spring_of(const ruga_foundation* f, int v) {
    return f->local_spring ? f->local_spring[v] : f->spring;
}

// edge_value = b w_e.
static ruga_status set_stiffness(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double b,
                                 const double* local_b, ruga_foundation* f) {
    if (!local_b) {
        RUGA_TRY(ruga_laplacian_weights(mesh, connectivity, f->edge_value));
        for (int e = 0; e < f->edge_count; e++) {
            f->edge_value[e] = b * f->edge_value[e];
        }
        return RUGA_OK;
    }
    double* triangle_b = NULL;
    RUGA_TRY(RUGA_NEW(triangle_b, mesh->triangle_count));
    ruga_mesh_triangle_averages(mesh, 1, local_b, triangle_b);
    ruga_status status = ruga_laplacian_weights_scaled(mesh, connectivity, triangle_b, f->edge_value);
    ruga_release(triangle_b);
    return status;
}

static ruga_status allocate(const ruga_connectivity* connectivity, ruga_foundation* f) {
    RUGA_TRY(copy_topology(connectivity, f));
    RUGA_TRY(RUGA_NEW(f->diagonal, f->vertex_count));
    RUGA_TRY(RUGA_NEW(f->edge_value, f->edge_count));
    return RUGA_NEW(f->vertex_scale, f->vertex_count);
}

// W from b w_e and areas.
static void set_matrix(ruga_foundation* f) {
    for (int v = 0; v < f->vertex_count; v++) {
        f->diagonal[v] = spring_of(f, v) * f->vertex_scale[v];
    }
    for (int e = 0; e < f->edge_count; e++) {
        double stiffness = f->edge_value[e];
        f->edge_value[e] = -stiffness;
        f->diagonal[f->edge[e][0]] += stiffness;
        f->diagonal[f->edge[e][1]] += stiffness;
    }
}

static ruga_status fill(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double b,
                        const double* local_b, ruga_foundation* f) {
    RUGA_TRY(allocate(connectivity, f));
    RUGA_TRY(set_stiffness(mesh, connectivity, b, local_b, f));
    ruga_mesh_vertex_areas(mesh, f->vertex_scale);
    set_matrix(f);
    return RUGA_OK;
}

ruga_status ruga_foundation_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double a,
                                   double b, ruga_foundation* foundation) {
    RUGA_ASSERT(a >= 0 && b >= 0);
    *foundation = (ruga_foundation){
        .vertex_count = mesh->vertex_count, .edge_count = connectivity->edge_count, .spring = a};
    ruga_status status = fill(mesh, connectivity, b, NULL, foundation);
    if (status != RUGA_OK) {
        ruga_foundation_clear(foundation);
    }
    return status;
}

ruga_status ruga_foundation_create_local(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                         const double* a, const double* b, ruga_foundation* foundation) {
    ruga_status status = RUGA_OK;
    *foundation =
        (ruga_foundation){.vertex_count = mesh->vertex_count, .edge_count = connectivity->edge_count};
    RUGA_TRY_DONE(RUGA_NEW(foundation->local_spring, mesh->vertex_count));
    memcpy(foundation->local_spring, a, (size_t)mesh->vertex_count * sizeof *a);
    RUGA_TRY_DONE(fill(mesh, connectivity, 0, b, foundation));
done:
    if (status != RUGA_OK) {
        ruga_foundation_clear(foundation);
    }
    return status;
}

ruga_status ruga_foundation_create_pieces(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                          const double* area, const double* a, const double* triangle_b,
                                          ruga_foundation* foundation) {
    ruga_status status = RUGA_OK;
    size_t vertices = (size_t)mesh->vertex_count;
    *foundation =
        (ruga_foundation){.vertex_count = mesh->vertex_count, .edge_count = connectivity->edge_count};
    RUGA_TRY_DONE(RUGA_NEW(foundation->local_spring, vertices));
    memcpy(foundation->local_spring, a, vertices * sizeof *a);
    RUGA_TRY_DONE(allocate(connectivity, foundation));
    RUGA_TRY_DONE(ruga_laplacian_weights_scaled(mesh, connectivity, triangle_b, foundation->edge_value));
    memcpy(foundation->vertex_scale, area, vertices * sizeof *area);
    set_matrix(foundation);
done:
    if (status != RUGA_OK) {
        ruga_foundation_clear(foundation);
    }
    return status;
}

void ruga_foundation_clear(ruga_foundation* foundation) {
    ruga_release(foundation->local_spring);
    ruga_release(foundation->diagonal);
    ruga_release(foundation->edge_value);
    ruga_release(foundation->edge);
    ruga_release(foundation->vertex_scale);
    ruga_release(foundation->neighbour_start);
    ruga_release(foundation->neighbour);
    ruga_release(foundation->neighbour_edge);
    *foundation = (ruga_foundation){0};
}

// Partial sums live on the stack, since the foundation is shared by threads: the chunk grows with the mesh.
enum { CHUNKS_MAX = 64, CHUNK_MIN = 1024 };

typedef struct evaluation {
    const ruga_foundation* foundation;
    const double* d;
    double* gradient;
    double energy[CHUNKS_MAX], force_square[CHUNKS_MAX];
} evaluation;

static void evaluate(int begin, int end, int chunk, void* context) {
    evaluation* work = context;
    const ruga_foundation* f = work->foundation;
    double energy = 0, square = 0;
    for (int v = begin; v < end; v++) {
        const double* d = work->d + 3 * (size_t)v;
        double a = spring_of(f, v) * f->vertex_scale[v];
        double sum[3] = {a * d[0], a * d[1], a * d[2]};
        double links = 0, link_square = 0; // by themselves: a sum over all would wait for each
        energy += 0.5 * a * ruga_dot(d, d);
        square += ruga_dot(sum, sum);
        for (int k = f->neighbour_start[v]; k < f->neighbour_start[v + 1]; k++) {
            double stiffness = -f->edge_value[f->neighbour_edge[k]], difference[3];
            ruga_subtract(d, work->d + 3 * (size_t)f->neighbour[k], difference);
            ruga_add_scaled(stiffness, difference, sum);
            // An edge is met from both ends, each of which takes half of its energy and its own force.
            double s = stiffness * ruga_dot(difference, difference);
            links += s;
            link_square += stiffness * s;
        }
        energy += 0.25 * links;
        square += link_square;
        if (work->gradient) {
            ruga_add_scaled(1, sum, work->gradient + 3 * (size_t)v);
        }
    }
    work->energy[chunk] = energy;
    work->force_square[chunk] = square;
}

double ruga_foundation_energy(const ruga_foundation* foundation, const double* d, double* gradient,
                              double* force_square) {
    evaluation work = {.foundation = foundation, .d = d, .gradient = gradient};
    int size = ruga_chunk_count(foundation->vertex_count, CHUNKS_MAX);
    size = size < CHUNK_MIN ? CHUNK_MIN : size;
    ruga_parallel_for(foundation->vertex_count, size, evaluate, &work);
    double energy = 0, square = 0;
    for (int c = 0; c < ruga_chunk_count(foundation->vertex_count, size); c++) {
        energy += work.energy[c];
        square += work.force_square[c];
    }
    if (force_square) {
        *force_square = square;
    }
    return energy;
}

ruga_status ruga_foundation_map(const ruga_foundation* foundation, const ruga_sparse* pattern, int** slot) {
    RUGA_ASSERT(pattern->rows == 3 * foundation->vertex_count);
    RUGA_TRY(RUGA_NEW(*slot, 3 * ((size_t)foundation->vertex_count + (size_t)foundation->edge_count)));
    int* out = *slot;
    for (int i = 0; i < 3 * foundation->vertex_count; i++) {
        *out++ = pattern->start[i]; // the diagonal comes first
    }
    for (int e = 0; e < foundation->edge_count; e++) {
        int i = foundation->edge[e][0], j = foundation->edge[e][1];
        for (int c = 0; c < 3; c++) {
            *out = ruga_sparse_find(pattern, 3 * (i > j ? i : j) + c, 3 * (i > j ? j : i) + c);
            RUGA_ASSERT(*out >= 0);
            out++;
        }
    }
    return RUGA_OK;
}

void ruga_foundation_add_hessian(const ruga_foundation* foundation, const int* slot, double* hessian) {
    for (int v = 0; v < foundation->vertex_count; v++) {
        for (int c = 0; c < 3; c++) {
            hessian[*slot++] += foundation->diagonal[v];
        }
    }
    for (int e = 0; e < foundation->edge_count; e++) {
        for (int c = 0; c < 3; c++) {
            hessian[*slot++] += foundation->edge_value[e];
        }
    }
}
