// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Gaussian clusters, Remillard and Kry 2013, section 3.1. With d_i the shortest path along mesh edges from a
// cluster's centre to vertex i (eqs. 1 and 2):
//     alpha_i = w exp(-d_i^2 / (2 sigma^2)) where d_i < 2 sigma, 0 elsewhere, w such that sum_i alpha_i = 1.
// Centres are chosen greedily, always the vertex that is farthest from those chosen. An update walks only
// over vertices that come closer to a centre by it: a shortest path to such a vertex runs over such vertices
// alone. Where the wavelength varies, the path that chooses centres is measured in local wavelengths: an edge
// counts as |e| over the mean scale of its ends.
#include "constraints/clusters.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/vec3.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

// A binary heap: smallest key first, of equal keys the smaller vertex.
typedef struct heap_entry {
    double key;
    int vertex;
} heap_entry;

typedef struct heap {
    heap_entry* entry;
    int count, capacity;
} heap;

static bool comes_before(heap_entry a, heap_entry b) {
    return a.key < b.key || (a.key == b.key && a.vertex < b.vertex);
}

static void sift_down(heap* h, int i) {
    heap_entry moving = h->entry[i];
    for (int child = 2 * i + 1; child < h->count; child = 2 * i + 1) {
        child += child + 1 < h->count && comes_before(h->entry[child + 1], h->entry[child]);
        if (!comes_before(h->entry[child], moving)) {
            break;
        }
        h->entry[i] = h->entry[child];
        i = child;
    }
    h->entry[i] = moving;
}

static ruga_status push(heap* h, double key, int vertex) {
    RUGA_TRY(RUGA_RESERVE(h->entry, h->capacity, h->count + 1));
    heap_entry added = {key, vertex};
    int i = h->count++;
    for (; i > 0 && comes_before(added, h->entry[(i - 1) / 2]); i = (i - 1) / 2) {
        h->entry[i] = h->entry[(i - 1) / 2];
    }
    h->entry[i] = added;
    return RUGA_OK;
}

static heap_entry pop(heap* h) {
    heap_entry top = h->entry[0];
    h->entry[0] = h->entry[--h->count];
    if (h->count) {
        sift_down(h, 0);
    }
    return top;
}

// What creation works on.
typedef struct builder {
    const ruga_connectivity* connectivity;
    double* edge_length; // [E] rest
    double* distance;    // [V] to the nearest centre
    int* reached;        // vertices set by the last walk
    int reached_count, reached_capacity;
    heap front;    // of a walk, by distance
    heap farthest; // all vertices by minus a distance that may be out of date (too large)
} builder;

// Dijkstra's walk from `center` over vertices nearer than distance[] says and than `limit`. Lowers distance[]
// and lists each vertex reached in b->reached (once).
static ruga_status walk(builder* b, int center, double limit, double* distance) {
    const ruga_connectivity* c = b->connectivity;
    b->reached_count = 0;
    b->front.count = 0;
    distance[center] = 0;
    RUGA_TRY(push(&b->front, 0, center));
    while (b->front.count) {
        heap_entry nearest = pop(&b->front);
        int v = nearest.vertex;
        if (nearest.key > distance[v]) {
            continue; // a shorter path came in between
        }
        RUGA_TRY(RUGA_RESERVE(b->reached, b->reached_capacity, b->reached_count + 1));
        b->reached[b->reached_count++] = v;
        for (int k = c->neighbour_start[v]; k < c->neighbour_start[v + 1]; k++) {
            int next = c->neighbour[k];
            double d = nearest.key + b->edge_length[c->neighbour_edge[k]];
            if (d < limit && d < distance[next]) {
                distance[next] = d;
                RUGA_TRY(push(&b->front, d, next));
            }
        }
    }
    return RUGA_OK;
}

// The vertex farthest from all centres, of several the lowest. Distances only fall, so a top entry that is up
// to date is the largest.
static int farthest_vertex(builder* b) {
    heap* h = &b->farthest;
    while (-h->entry[0].key != b->distance[h->entry[0].vertex]) {
        h->entry[0].key = -b->distance[h->entry[0].vertex];
        sift_down(h, 0);
    }
    return h->entry[0].vertex;
}

static ruga_status add_center(builder* b, int vertex, ruga_clusters* clusters, int* capacity) {
    RUGA_TRY(RUGA_RESERVE(clusters->center, *capacity, clusters->count + 1));
    clusters->center[clusters->count++] = vertex;
    return walk(b, vertex, INFINITY, b->distance);
}

// One seeded random vertex in each component.
static ruga_status add_first_centers(builder* b, int64_t seed, ruga_clusters* clusters, int* capacity) {
    const ruga_connectivity* c = b->connectivity;
    ruga_status status = RUGA_OK;
    ruga_random random = {(uint64_t)seed};
    int *left = NULL, *size = NULL; // left: vertices of the component to pass before the chosen one
    RUGA_TRY_DONE(RUGA_NEW(left, c->component_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(size, c->component_count));
    for (int v = 0; v < c->vertex_count; v++) {
        if (c->component[v] >= 0) {
            size[c->component[v]]++;
        }
    }
    for (int k = 0; k < c->component_count; k++) {
        left[k] = (int)(ruga_random_uniform(&random) * size[k]);
    }
    for (int v = 0; v < c->vertex_count; v++) {
        int k = c->component[v];
        if (k >= 0 && left[k]-- == 0) {
            RUGA_TRY_DONE(add_center(b, v, clusters, capacity));
        }
    }
done:
    ruga_release(left);
    ruga_release(size);
    return status;
}

static ruga_status choose_centers(builder* b, double radius, int count, int64_t seed,
                                  ruga_clusters* clusters) {
    int capacity = 0;
    RUGA_TRY(add_first_centers(b, seed, clusters, &capacity));
    for (int v = 0; v < clusters->vertex_count; v++) {
        if (b->connectivity->component[v] >= 0) {
            RUGA_TRY(push(&b->farthest, -b->distance[v], v));
        }
    }
    while (count <= 0 || clusters->count < count) {
        int v = farthest_vertex(b);
        if (count <= 0 && b->distance[v] <= radius) {
            break;
        }
        if (b->distance[v] == 0) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "coupling.count = %d asks for more clusters than the mesh has distinct vertices "
                             "(%d): lower it",
                             count, clusters->count);
        }
        RUGA_TRY(add_center(b, v, clusters, &capacity));
    }
    return RUGA_OK;
}

static int compare_ints(const void* a, const void* b) {
    int x = *(const int*)a, y = *(const int*)b;
    return (x > y) - (x < y);
}

// Entries of all rows; `distance` is all INFINITY before and after.
static ruga_status fill_rows(builder* b, double sigma_mean, const double* scale, double* distance,
                             ruga_clusters* clusters) {
    int vertex_capacity = 0, weight_capacity = 0;
    RUGA_TRY(RUGA_NEW(clusters->start, clusters->count + 1));
    clusters->start[0] = 0;
    for (int i = 0; i < clusters->count; i++) {
        double sigma = scale ? sigma_mean * scale[clusters->center[i]] : sigma_mean;
        RUGA_TRY(walk(b, clusters->center[i], 2 * sigma, distance));
        int begin = clusters->start[i];
        if (b->reached_count > INT_MAX - begin) {
            return ruga_fail(RUGA_NO_MEMORY,
                             "the clusters have more than 2^31 entries: lower coupling.sigma");
        }
        int end = clusters->start[i + 1] = begin + b->reached_count;
        RUGA_TRY(RUGA_RESERVE(clusters->vertex, vertex_capacity, end));
        RUGA_TRY(RUGA_RESERVE(clusters->weight, weight_capacity, end));
        memcpy(clusters->vertex + begin, b->reached, (size_t)b->reached_count * sizeof *b->reached);
        qsort(clusters->vertex + begin, (size_t)b->reached_count, sizeof *clusters->vertex, compare_ints);
        double sum = 0;
        for (int k = begin; k < end; k++) {
            double d = distance[clusters->vertex[k]] / sigma;
            clusters->weight[k] = exp(-0.5 * d * d);
            sum += clusters->weight[k];
            distance[clusters->vertex[k]] = INFINITY;
        }
        for (int k = begin; k < end; k++) {
            clusters->weight[k] /= sum;
        }
    }
    return RUGA_OK;
}

static ruga_status check_input(const ruga_connectivity* c, double radius, double sigma, int count) {
    if (!(sigma > 0 && isfinite(sigma))) {
        return ruga_fail(RUGA_BAD_INPUT, "coupling.sigma = %g m must be positive", sigma);
    }
    if (count <= 0 && !(radius > 0)) {
        return ruga_fail(RUGA_BAD_INPUT, "coupling.radius = %g m must be positive where no count is given",
                         radius);
    }
    if (count > 0 && count < c->component_count) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "coupling.count = %d is too small: the mesh has %d separate pieces, and each needs a "
            "cluster",
            count, c->component_count);
    }
    if (count > c->vertex_count) {
        return ruga_fail(RUGA_BAD_INPUT, "coupling.count = %d is more than the mesh's %d vertices: lower it",
                         count, c->vertex_count);
    }
    return c->component_count > 0 ? RUGA_OK : ruga_fail(RUGA_BAD_INPUT, "the mesh has no faces");
}

// Rest lengths of the edges, in local units where scale is given.
static void measure_edges(const ruga_mesh* mesh, const ruga_connectivity* connectivity, const double* scale,
                          double* length) {
    for (int e = 0; e < connectivity->edge_count; e++) {
        const int* edge = connectivity->edge[e];
        length[e] = ruga_distance(mesh->position + 3 * (size_t)edge[0], mesh->position + 3 * (size_t)edge[1]);
        length[e] /= scale ? 0.5 * (scale[edge[0]] + scale[edge[1]]) : 1;
    }
}

ruga_status ruga_clusters_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double radius,
                                 double sigma, int count, int64_t seed, ruga_clusters* clusters) {
    return ruga_clusters_create_local(mesh, connectivity, radius, sigma, NULL, count, seed, clusters);
}

ruga_status ruga_clusters_create_local(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                       double radius, double sigma, const double* scale, int count,
                                       int64_t seed, ruga_clusters* clusters) {
    ruga_status status = RUGA_OK;
    builder b = {.connectivity = connectivity};
    double* row_distance = NULL;
    *clusters = (ruga_clusters){.vertex_count = mesh->vertex_count};
    RUGA_TRY(check_input(connectivity, radius, sigma, count));
    RUGA_TRY_DONE(RUGA_NEW(b.edge_length, connectivity->edge_count));
    RUGA_TRY_DONE(RUGA_NEW(b.distance, mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(row_distance, mesh->vertex_count));
    measure_edges(mesh, connectivity, scale, b.edge_length);
    for (int v = 0; v < mesh->vertex_count; v++) {
        b.distance[v] = row_distance[v] = INFINITY;
    }
    RUGA_TRY_DONE(choose_centers(&b, radius, count, seed, clusters));
    measure_edges(mesh, connectivity, NULL, b.edge_length);
    RUGA_TRY_DONE(fill_rows(&b, sigma, scale, row_distance, clusters));
    RUGA_TRY_DONE(ruga_clusters_transpose(clusters));
done:
    ruga_release(b.edge_length);
    ruga_release(b.distance);
    ruga_release(b.reached);
    ruga_release(b.front.entry);
    ruga_release(b.farthest.entry);
    ruga_release(row_distance);
    if (status != RUGA_OK) {
        ruga_clusters_clear(clusters);
    }
    return status;
}

void ruga_clusters_clear(ruga_clusters* clusters) {
    ruga_release(clusters->center);
    ruga_release(clusters->start);
    ruga_release(clusters->vertex);
    ruga_release(clusters->weight);
    ruga_release(clusters->column_start);
    ruga_release(clusters->column_row);
    ruga_release(clusters->column_weight);
    *clusters = (ruga_clusters){0};
}

ruga_status ruga_clusters_transpose(ruga_clusters* clusters) {
    int entries = clusters->start[clusters->count];
    RUGA_TRY(RUGA_NEW_ZERO(clusters->column_start, clusters->vertex_count + 1));
    RUGA_TRY(RUGA_NEW(clusters->column_row, entries));
    RUGA_TRY(RUGA_NEW(clusters->column_weight, entries));
    int* start = clusters->column_start; // at first start[v + 1] is where column v ends
    for (int k = 0; k < entries; k++) {
        start[clusters->vertex[k] + 1]++;
    }
    for (int v = 0; v < clusters->vertex_count; v++) {
        start[v + 1] += start[v];
    }
    for (int i = clusters->count - 1; i >= 0; i--) {
        for (int k = clusters->start[i]; k < clusters->start[i + 1]; k++) {
            int place = --start[clusters->vertex[k] + 1];
            clusters->column_row[place] = i;
            clusters->column_weight[place] = clusters->weight[k];
        }
    }
    // Filled from the back, start[v + 1] is now where column v begins.
    memmove(start, start + 1, (size_t)clusters->vertex_count * sizeof *start);
    start[clusters->vertex_count] = entries;
    return RUGA_OK;
}

typedef struct product {
    const ruga_clusters* clusters;
    const double* in;
    double* out;
} product;

static void apply_rows(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const product* p = context;
    const ruga_clusters* c = p->clusters;
    for (int i = begin; i < end; i++) {
        double sum[3] = {0, 0, 0};
        for (int k = c->start[i]; k < c->start[i + 1]; k++) {
            ruga_add_scaled(c->weight[k], p->in + 3 * (size_t)c->vertex[k], sum);
        }
        memcpy(p->out + 3 * (size_t)i, sum, sizeof sum);
    }
}

void ruga_clusters_apply(const ruga_clusters* clusters, const double* x, double* y) {
    product p = {clusters, x, y};
    ruga_parallel_for(clusters->count, 32, apply_rows, &p);
}

static void apply_columns(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const product* p = context;
    const ruga_clusters* c = p->clusters;
    for (int v = begin; v < end; v++) {
        for (int k = c->column_start[v]; k < c->column_start[v + 1]; k++) {
            ruga_add_scaled(c->column_weight[k], p->in + 3 * (size_t)c->column_row[k],
                            p->out + 3 * (size_t)v);
        }
    }
}

void ruga_clusters_apply_transpose(const ruga_clusters* clusters, const double* y, double* x) {
    product p = {clusters, y, x};
    ruga_parallel_for(clusters->vertex_count, 1024, apply_columns, &p);
}

void ruga_clusters_rule(ruga_coupling_rule rule, double wavelength, double* radius, double* sigma) {
    // Eq. 6 and "r = 2 sigma", centres until all vertices are within r/2. That letter spaces centres closer
    // than Nyquist's lambda/2 (0.39 lambda) and forces wrinkles of 0.70 lambda; 1.5 times as wide and as far
    // apart gives lambda.
    double scale = rule == RUGA_RULE_PAPER ? 1 : 1.5;
    *sigma = scale * wavelength / RUGA_PI;
    *radius = *sigma;
}
