// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Loop's scheme (Loop 1987), each triangle into four. With n neighbours v_i of a vertex v:
//   inner vertex   (1 - n b) v + b sum v_i,  b = (5/8 - (3/8 + cos(2 pi / n) / 4)^2) / n
//   inner edge     3/8 of both ends + 1/8 of both opposite vertices
//   border vertex  3/4 v + 1/8 of both neighbours along the border; border edge: its middle
//   a vertex where more than one border meets stays
// The steps are multiplied into one sparse matrix of the refined by the given vertices (rows sum to one), so
// that positions of every frame follow by one product. UVs are cut linearly along their own edges, so that
// seams stay seams. Old vertices keep their numbers; edge e of a step becomes vertex V + e; face f becomes
// 4 f .. 4 f + 3, the middle one last.
#include "mesh/subdivide.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"
#include "mesh/connectivity.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static const double MAXIMUM_FACES = 100e6;

// Rows of weights on given vertices.
typedef struct weights {
    int rows;
    int capacity;
    int* start; // [rows + 1]
    struct {
        int vertex;
        double weight;
    } * entry;
} weights;

struct ruga_subdivision {
    ruga_mesh mesh;
    int coarse_count;
    weights weights;
};

static void clear_weights(weights* w) {
    ruga_release(w->start);
    ruga_release(w->entry);
    memset(w, 0, sizeof *w);
}

// Appends to the last open row, start[row + 1].
static ruga_status add_weight(weights* w, int row, int vertex, double weight) {
    RUGA_TRY(RUGA_RESERVE(w->entry, w->capacity, (size_t)w->start[row + 1] + 1));
    w->entry[w->start[row + 1]].vertex = vertex;
    w->entry[w->start[row + 1]++].weight = weight;
    return RUGA_OK;
}

static ruga_status identity_weights(int count, weights* w) {
    w->rows = count;
    RUGA_TRY(RUGA_NEW_ZERO(w->start, (size_t)count + 1));
    for (int v = 0; v < count; v++) {
        w->start[v + 1] = w->start[v];
        RUGA_TRY(add_weight(w, v, v, 1));
    }
    return RUGA_OK;
}

// ----------------------------------------------------------------------------------------- one step

// What a row of one step combines: at most the vertex and its neighbours.
typedef struct stencil {
    int count, capacity;
    int* vertex;
    double* weight; // of the same capacity
} stencil;

static void put(stencil* s, int vertex, double weight) {
    s->vertex[s->count] = vertex;
    s->weight[s->count++] = weight;
}

static bool is_border(const ruga_connectivity* c, int edge) {
    return c->edge_triangle[edge][0] < 0 || c->edge_triangle[edge][1] < 0;
}

static void vertex_stencil(const ruga_connectivity* c, int v, stencil* s) {
    int begin = c->neighbour_start[v], end = c->neighbour_start[v + 1], borders = 0;
    for (int k = begin; k < end; k++) {
        borders += is_border(c, c->neighbour_edge[k]);
    }
    s->count = 0;
    if (end == begin || (borders != 0 && borders != 2)) {
        put(s, v, 1);
        return;
    }
    int n = end - begin;
    double root = 3.0 / 8 + cos(2 * RUGA_PI / n) / 4;
    double b = borders == 0 ? (5.0 / 8 - root * root) / n : 1.0 / 8;
    put(s, v, borders == 0 ? 1 - n * b : 3.0 / 4);
    for (int k = begin; k < end; k++) {
        if (borders == 0 || is_border(c, c->neighbour_edge[k])) {
            put(s, c->neighbour[k], b);
        }
    }
}

static void edge_stencil(const ruga_connectivity* c, int e, stencil* s) {
    bool border = is_border(c, e);
    s->count = 0;
    for (int side = 0; side < 2; side++) {
        put(s, c->edge[e][side], border ? 1.0 / 2 : 3.0 / 8);
        if (!border) {
            put(s, c->edge_opposite[e][side], 1.0 / 8);
        }
    }
}

// place[] of a given vertex in the row being made, valid where >= the row's start.
static ruga_status add_row(const weights* old, const stencil* s, int row, int* place, weights* fine) {
    int begin = fine->start[row];
    fine->start[row + 1] = begin;
    for (int i = 0; i < s->count; i++) {
        int from = s->vertex[i];
        for (int k = old->start[from]; k < old->start[from + 1]; k++) {
            int vertex = old->entry[k].vertex;
            double weight = s->weight[i] * old->entry[k].weight;
            if (place[vertex] >= begin) {
                fine->entry[place[vertex]].weight += weight;
            } else {
                place[vertex] = fine->start[row + 1];
                RUGA_TRY(add_weight(fine, row, vertex, weight));
            }
        }
    }
    return RUGA_OK;
}

static int largest_valence(const ruga_connectivity* c) {
    int largest = 0;
    for (int v = 0; v < c->vertex_count; v++) {
        int n = c->neighbour_start[v + 1] - c->neighbour_start[v];
        largest = n > largest ? n : largest;
    }
    return largest;
}

// fine = (one step) * old
static ruga_status multiply_step(const ruga_connectivity* c, const weights* old, int coarse_count,
                                 weights* fine) {
    ruga_status status = RUGA_OK;
    stencil s = {.capacity = largest_valence(c) + 4};
    int* place = NULL;
    fine->rows = c->vertex_count + c->edge_count;
    RUGA_TRY_DONE(RUGA_NEW(s.vertex, s.capacity));
    RUGA_TRY_DONE(RUGA_NEW(s.weight, s.capacity));
    RUGA_TRY_DONE(RUGA_NEW(place, coarse_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(fine->start, (size_t)fine->rows + 1));
    for (int v = 0; v < coarse_count; v++) {
        place[v] = -1;
    }
    for (int row = 0; row < fine->rows; row++) {
        if (row < c->vertex_count) {
            vertex_stencil(c, row, &s);
        } else {
            edge_stencil(c, row - c->vertex_count, &s);
        }
        RUGA_TRY_DONE(add_row(old, &s, row, place, fine));
    }
done:
    ruga_release(s.vertex);
    ruga_release(s.weight);
    ruga_release(place);
    return status;
}

// ------------------------------------------------------------------------------- topology of a step

// triangle [F][3] with middles [F][3] of the edges from corner i to corner i + 1 -> [4 F][3]
static void split_triangles(int count, const int* triangle, const int* middle, int* fine) {
    for (size_t f = 0; f < (size_t)count; f++) {
        const int *t = triangle + 3 * f, *m = middle + 3 * f;
        const int four[12] = {t[0], m[0], m[2], m[0], t[1], m[1], m[2], m[1], t[2], m[0], m[1], m[2]};
        memcpy(fine + 12 * f, four, sizeof four);
    }
}

typedef struct uv_side {
    int low, high, corner; // corner 3 f + i: the side from corner i to i + 1
} uv_side;

static int compare_sides(const void* a, const void* b) {
    const uv_side *p = a, *q = b;
    if (p->low != q->low) {
        return p->low < q->low ? -1 : 1;
    }
    if (p->high != q->high) {
        return p->high < q->high ? -1 : 1;
    }
    return p->corner < q->corner ? -1 : p->corner > q->corner;
}

// middle[3 f + i] = number of the uv at the side's middle, counted from uv_count; -1 where an end has no uv.
// Sides with the same two uvs share it. *sides_used [new uv count] names one corner of each.
static int number_uv_middles(const ruga_mesh* mesh, uv_side* side, int* middle) {
    int count = 3 * mesh->triangle_count, uv_count = mesh->uv_count;
    for (int corner = 0; corner < count; corner++) {
        int a = mesh->uv_triangle[corner];
        int b = mesh->uv_triangle[corner % 3 == 2 ? corner - 2 : corner + 1];
        side[corner] = (uv_side){a < b ? a : b, a < b ? b : a, corner};
    }
    qsort(side, (size_t)count, sizeof *side, compare_sides);
    for (int i = 0; i < count; i++) {
        bool same = i > 0 && side[i].low == side[i - 1].low && side[i].high == side[i - 1].high;
        uv_count += side[i].low >= 0 && !same;
        middle[side[i].corner] = side[i].low >= 0 ? uv_count - 1 : -1;
    }
    return uv_count;
}

static ruga_status split_uvs(const ruga_mesh* mesh, ruga_mesh* fine) {
    ruga_status status = RUGA_OK;
    uv_side* side = NULL;
    int* middle = NULL;
    RUGA_TRY_DONE(RUGA_NEW(side, 3 * (size_t)mesh->triangle_count));
    RUGA_TRY_DONE(RUGA_NEW(middle, 3 * (size_t)mesh->triangle_count));
    fine->uv_count = number_uv_middles(mesh, side, middle);
    RUGA_TRY_DONE(RUGA_NEW(fine->uv, 2 * (size_t)fine->uv_count));
    RUGA_TRY_DONE(RUGA_NEW(fine->uv_triangle, 3 * (size_t)fine->triangle_count));
    memcpy(fine->uv, mesh->uv, 2 * (size_t)mesh->uv_count * sizeof *fine->uv);
    for (int i = 0; i < 3 * mesh->triangle_count; i++) {
        int new_uv = middle[side[i].corner];
        for (int k = 0; new_uv >= 0 && k < 2; k++) {
            fine->uv[2 * (size_t)new_uv + (size_t)k] = (mesh->uv[2 * (size_t)side[i].low + (size_t)k] +
                                                        mesh->uv[2 * (size_t)side[i].high + (size_t)k]) /
                                                       2;
        }
    }
    split_triangles(mesh->triangle_count, mesh->uv_triangle, middle, fine->uv_triangle);
done:
    ruga_release(side);
    ruga_release(middle);
    return status;
}

static ruga_status split_faces(const ruga_mesh* mesh, const ruga_connectivity* c, ruga_mesh* fine) {
    int* middle = NULL;
    RUGA_TRY(RUGA_NEW(fine->triangle, 3 * (size_t)fine->triangle_count));
    RUGA_TRY(RUGA_NEW(fine->polygon, fine->triangle_count));
    RUGA_TRY(RUGA_NEW(middle, 3 * (size_t)mesh->triangle_count));
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        middle[i] = mesh->vertex_count + (&c->triangle_edge[0][0])[i];
    }
    split_triangles(mesh->triangle_count, mesh->triangle, middle, fine->triangle);
    ruga_release(middle);
    for (int f = 0; f < fine->triangle_count; f++) {
        fine->polygon[f] = mesh->polygon ? mesh->polygon[f / 4] : f / 4;
    }
    return RUGA_OK;
}

static ruga_status split_groups(const ruga_mesh* mesh, ruga_mesh* fine) {
    RUGA_TRY(RUGA_NEW_ZERO(fine->group_name, mesh->group_count));
    fine->group_count = mesh->group_count;
    for (int g = 0; g < mesh->group_count; g++) {
        fine->group_name[g] = ruga_copy_string(mesh->group_name[g]);
        if (!fine->group_name[g]) {
            return ruga_fail(RUGA_NO_MEMORY, "out of memory for %d group names", mesh->group_count);
        }
    }
    RUGA_TRY(RUGA_NEW(fine->face_group, fine->triangle_count));
    for (int f = 0; f < fine->triangle_count; f++) {
        fine->face_group[f] = mesh->face_group[f / 4];
    }
    return RUGA_OK;
}

// Everything of the finer mesh but its positions.
static ruga_status split_mesh(const ruga_mesh* mesh, const ruga_connectivity* c, ruga_mesh* fine) {
    memset(fine, 0, sizeof *fine);
    fine->vertex_count = mesh->vertex_count + c->edge_count;
    fine->triangle_count = 4 * mesh->triangle_count;
    RUGA_TRY(RUGA_NEW_ZERO(fine->position, 3 * (size_t)fine->vertex_count));
    RUGA_TRY(RUGA_NEW(fine->source_vertex, fine->vertex_count));
    for (int v = 0; v < fine->vertex_count; v++) {
        bool old = v < mesh->vertex_count;
        fine->source_vertex[v] = !old ? -1 : mesh->source_vertex ? mesh->source_vertex[v] : v;
    }
    RUGA_TRY(split_faces(mesh, c, fine));
    if (mesh->uv && mesh->uv_triangle) {
        RUGA_TRY(split_uvs(mesh, fine));
    }
    return mesh->face_group && mesh->group_count > 0 ? split_groups(mesh, fine) : RUGA_OK;
}

// --------------------------------------------------------------------------------------------- public

static ruga_status refine_once(ruga_subdivision* s) {
    ruga_status status = RUGA_OK;
    ruga_connectivity c = {0};
    ruga_mesh fine = {0};
    weights product = {0};
    RUGA_TRY_DONE(ruga_connectivity_create(&s->mesh, &c));
    RUGA_TRY_DONE(multiply_step(&c, &s->weights, s->coarse_count, &product));
    RUGA_TRY_DONE(split_mesh(&s->mesh, &c, &fine));
    ruga_mesh_clear(&s->mesh);
    clear_weights(&s->weights);
    s->mesh = fine;
    s->weights = product;
    fine = (ruga_mesh){0};
    product = (weights){0};
done:
    ruga_connectivity_clear(&c);
    ruga_mesh_clear(&fine);
    clear_weights(&product);
    return status;
}

static ruga_status create(const ruga_mesh* mesh, int steps, ruga_subdivision* s) {
    s->coarse_count = mesh->vertex_count;
    RUGA_TRY(ruga_mesh_copy(mesh, &s->mesh));
    RUGA_TRY(identity_weights(mesh->vertex_count, &s->weights));
    for (int step = 0; step < steps; step++) {
        RUGA_TRY(refine_once(s));
    }
    ruga_subdivision_apply(s, mesh->position, s->mesh.position);
    return RUGA_OK;
}

ruga_status ruga_subdivision_create(const ruga_mesh* mesh, int steps, ruga_subdivision** subdivision) {
    *subdivision = NULL;
    if (steps < 0 || steps > 15 || ldexp(mesh->triangle_count, 2 * steps) > MAXIMUM_FACES) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "%d steps of subdivision of %d faces: at least 0 steps and at most %.0f faces are possible",
            steps, mesh->triangle_count, MAXIMUM_FACES);
    }
    ruga_subdivision* s = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(s, 1));
    ruga_status status = create(mesh, steps, s);
    if (status != RUGA_OK) {
        ruga_subdivision_destroy(&s);
    }
    *subdivision = s;
    return status;
}

void ruga_subdivision_destroy(ruga_subdivision** subdivision) {
    if (*subdivision) {
        ruga_mesh_clear(&(*subdivision)->mesh);
        clear_weights(&(*subdivision)->weights);
        ruga_release(*subdivision);
        *subdivision = NULL;
    }
}

const ruga_mesh* ruga_subdivision_mesh(const ruga_subdivision* subdivision) {
    return &subdivision->mesh;
}

typedef struct product {
    const weights* weights;
    const double* coarse;
    double* fine;
} product;

static void multiply_rows(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const product* p = context;
    for (int row = begin; row < end; row++) {
        double sum[3] = {0, 0, 0};
        for (int k = p->weights->start[row]; k < p->weights->start[row + 1]; k++) {
            ruga_add_scaled(p->weights->entry[k].weight, p->coarse + 3 * (size_t)p->weights->entry[k].vertex,
                            sum);
        }
        memcpy(p->fine + 3 * (size_t)row, sum, sizeof sum);
    }
}

void ruga_subdivision_apply(const ruga_subdivision* subdivision, const double* coarse, double* fine) {
    product p = {&subdivision->weights, coarse, fine};
    ruga_parallel_for(subdivision->weights.rows, 4096, multiply_rows, &p);
}
