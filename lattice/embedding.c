// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Shape functions of the lattice and the embedding B of the surface, x = B q (Remillard and Kry 2013, section
// 5). Per axis, t in [0, 1]: degree 2 (1 - t)^2/2, 1/2 + t - t^2, t^2/2, uniform quadratic B-splines over
// their three nodes; degree 1 1 - t, t. Products of three make the element's functions. They sum to one and,
// with the nodes' rest positions, reproduce affine maps. They are polynomials, also slightly outside [0, 1].
#include "core/memory.h"
#include "core/parallel.h"
#include "lattice/assemble.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 1024 };

static void shape_of_axis(int degree, double t, double value[3], double slope[3]) {
    if (degree == 2) {
        value[0] = (1 - t) * (1 - t) / 2;
        value[1] = 0.5 + t - t * t;
        value[2] = t * t / 2;
        slope[0] = t - 1;
        slope[1] = 1 - 2 * t;
        slope[2] = t;
    } else {
        value[0] = 1 - t;
        value[1] = t;
        slope[0] = -1;
        slope[1] = 1;
    }
}

void ruga_lattice_shape(const ruga_lattice* lattice, const double xi[3], double* weight, double* gradient) {
    double value[3][3], slope[3][3];
    for (int axis = 0; axis < 3; axis++) {
        shape_of_axis(lattice->degree, xi[axis], value[axis], slope[axis]);
    }
    const double* size = lattice->cell_size;
    int n = lattice->degree + 1, local = 0;
    for (int k = 0; k < n; k++) {
        for (int j = 0; j < n; j++) {
            for (int i = 0; i < n; i++, local++) {
                weight[local] = value[0][i] * value[1][j] * value[2][k];
                if (gradient) {
                    gradient[3 * local] = slope[0][i] * value[1][j] * value[2][k] / size[0];
                    gradient[3 * local + 1] = value[0][i] * slope[1][j] * value[2][k] / size[1];
                    gradient[3 * local + 2] = value[0][i] * value[1][j] * slope[2][k] / size[2];
                }
            }
        }
    }
}

void ruga_lattice_point(const ruga_lattice* lattice, int element, int g, double xi[3], double x[3]) {
    int at[3] = {g % 3, g / 3 % 3, g / 9};
    for (int axis = 0; axis < 3; axis++) {
        xi[axis] = 0.5 + (at[axis] - 1) * (sqrt(0.6) / 2);
        double u = lattice->element_cell[3 * (size_t)element + (size_t)axis] + xi[axis];
        x[axis] = lattice->origin[axis] + lattice->cell_size[axis] * u;
    }
}

// For a vertex without faces: the element whose cell is nearest.
static int nearest_element(const ruga_lattice* lattice, const double u[3]) {
    double least = INFINITY;
    int nearest = 0;
    for (int e = 0; e < lattice->element_count; e++) {
        double square = 0;
        for (int axis = 0; axis < 3; axis++) {
            double offset = (u[axis] - lattice->element_cell[3 * (size_t)e + (size_t)axis] - 0.5) *
                            lattice->cell_size[axis];
            double outside = fmax(0, fabs(offset) - lattice->cell_size[axis] / 2);
            square += outside * outside;
        }
        if (square < least) {
            least = square;
            nearest = e;
        }
    }
    return nearest;
}

// Transpose of B: for each node the places in vertex_weight, in the order of the vertices.
static ruga_status index_nodes(ruga_lattice* lattice) {
    int npe = lattice->nodes_per_element;
    RUGA_TRY(RUGA_NEW_ZERO(lattice->gather_start, (size_t)lattice->node_count + 2));
    RUGA_TRY(RUGA_NEW(lattice->gather, (size_t)lattice->vertex_count * (size_t)npe));
    for (int turn = 0; turn < 2; turn++) { // count two places ahead, then fill
        for (int v = 0; v < lattice->vertex_count; v++) {
            const int* node = lattice->element_node + (size_t)lattice->vertex_element[v] * (size_t)npe;
            for (int i = 0; i < npe; i++) {
                if (turn == 0) {
                    lattice->gather_start[node[i] + 2]++;
                } else {
                    lattice->gather[lattice->gather_start[node[i] + 1]++] = v * npe + i;
                }
            }
        }
        for (int n = 0; turn == 0 && n < lattice->node_count; n++) {
            lattice->gather_start[n + 2] += lattice->gather_start[n + 1];
        }
    }
    return RUGA_OK;
}

ruga_status ruga_lattice_bind(ruga_lattice* lattice, int vertex_count, const double (*u)[3],
                              const int* element_of) {
    int npe = lattice->nodes_per_element;
    lattice->vertex_count = vertex_count;
    RUGA_TRY(RUGA_NEW(lattice->vertex_element, vertex_count));
    RUGA_TRY(RUGA_NEW(lattice->vertex_weight, (size_t)vertex_count * (size_t)npe));
    for (int v = 0; v < vertex_count; v++) {
        int e = element_of[v] >= 0 ? element_of[v] : nearest_element(lattice, u[v]);
        double xi[3];
        for (int axis = 0; axis < 3; axis++) {
            xi[axis] = u[v][axis] - lattice->element_cell[3 * (size_t)e + (size_t)axis];
        }
        lattice->vertex_element[v] = e;
        ruga_lattice_shape(lattice, xi, lattice->vertex_weight + (size_t)v * (size_t)npe, NULL);
    }
    return index_nodes(lattice);
}

ruga_status ruga_lattice_copy_vertices(ruga_lattice* lattice, int count, const int* source) {
    ruga_status status = RUGA_OK;
    size_t npe = (size_t)lattice->nodes_per_element;
    int* element = NULL;
    double* weight = NULL;
    RUGA_TRY_DONE(RUGA_NEW(element, count));
    RUGA_TRY_DONE(RUGA_NEW(weight, (size_t)count * npe));
    for (int i = 0; i < count; i++) {
        element[i] = lattice->vertex_element[source[i]];
        memcpy(weight + (size_t)i * npe, lattice->vertex_weight + (size_t)source[i] * npe, npe * sizeof *weight);
    }
    ruga_release(lattice->vertex_element);
    ruga_release(lattice->vertex_weight);
    ruga_release(lattice->gather_start);
    ruga_release(lattice->gather);
    lattice->vertex_count = count;
    lattice->vertex_element = element;
    lattice->vertex_weight = weight;
    lattice->gather_start = lattice->gather = NULL;
    return index_nodes(lattice);
done:
    ruga_release(element);
    ruga_release(weight);
    return status;
}

typedef struct embed_context {
    const ruga_lattice* lattice;
    const double* from;
    double* to;
} embed_context;

static void embed_vertices(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const embed_context* embed = context;
    const ruga_lattice* lattice = embed->lattice;
    size_t npe = (size_t)lattice->nodes_per_element;
    for (size_t v = (size_t)begin; v < (size_t)end; v++) {
        const int* node = lattice->element_node + (size_t)lattice->vertex_element[v] * npe;
        const double* weight = lattice->vertex_weight + v * npe;
        double sum[3] = {0, 0, 0};
        for (size_t i = 0; i < npe; i++) {
            const double* q = embed->from + 3 * (size_t)node[i];
            sum[0] += weight[i] * q[0];
            sum[1] += weight[i] * q[1];
            sum[2] += weight[i] * q[2];
        }
        double* x = embed->to + 3 * v;
        x[0] = sum[0];
        x[1] = sum[1];
        x[2] = sum[2];
    }
}

void ruga_lattice_embed(const ruga_lattice* lattice, const double* q, double* x) {
    embed_context context = {lattice, q, x};
    ruga_parallel_for(lattice->vertex_count, CHUNK, embed_vertices, &context);
}

static void gather_nodes(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const embed_context* embed = context;
    const ruga_lattice* lattice = embed->lattice;
    for (int n = begin; n < end; n++) {
        double sum[3] = {0, 0, 0};
        for (int k = lattice->gather_start[n]; k < lattice->gather_start[n + 1]; k++) {
            int place = lattice->gather[k];
            double weight = lattice->vertex_weight[place];
            const double* fx = embed->from + 3 * (size_t)(place / lattice->nodes_per_element);
            sum[0] += weight * fx[0];
            sum[1] += weight * fx[1];
            sum[2] += weight * fx[2];
        }
        for (int axis = 0; axis < 3; axis++) {
            embed->to[3 * (size_t)n + (size_t)axis] += sum[axis];
        }
    }
}

void ruga_lattice_embed_transpose(const ruga_lattice* lattice, const double* fx, double* fq) {
    embed_context context = {lattice, fx, fq};
    ruga_parallel_for(lattice->node_count, CHUNK / 16, gather_nodes, &context);
}
