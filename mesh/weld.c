// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Welding by a hash of cubic cells of side 4 tolerance: the box of half-width `tolerance` about a vertex
// touches at most 8 cells. With tolerance 0 the cell is the position itself.
#include "mesh/weld.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <limits.h>
#include <string.h>

typedef struct cell_table {
    double tolerance;
    const double* position; // [V][3]
    uint32_t mask;
    int* head; // [mask + 1] last kept vertex put in the bucket, or -1
    int* next; // [V] the one before it in the same bucket
} cell_table;

static double cell_of(const cell_table* table, double x) {
    // + 0.0 makes one of the two zeros.
    return (table->tolerance > 0 ? floor(x / (4 * table->tolerance)) : x) + 0.0;
}

static uint32_t bucket_of(const cell_table* table, const double cell[3]) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        uint64_t bits;
        memcpy(&bits, &cell[k], sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return (uint32_t)hash & table->mask;
}

static bool is_close(const cell_table* table, const double* a, const double* b) {
    if (table->tolerance > 0) {
        return ruga_distance(a, b) <= table->tolerance;
    }
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

// The earliest kept vertex close to v in one bucket, or `best` where that is earlier.
static int search_bucket(const cell_table* table, uint32_t bucket, int v, int best) {
    for (int w = table->head[bucket]; w >= 0; w = table->next[w]) {
        if (w < best && is_close(table, table->position + 3 * (size_t)v, table->position + 3 * (size_t)w)) {
            best = w;
        }
    }
    return best;
}

static int find_close(const cell_table* table, int v) {
    const double* x = table->position + 3 * (size_t)v;
    int best = INT_MAX;
    for (int corner = 0; corner < 8; corner++) {
        double cell[3];
        bool repeated = false;
        for (int k = 0; k < 3; k++) {
            double low = cell_of(table, x[k] - table->tolerance);
            cell[k] = (corner >> k & 1) ? cell_of(table, x[k] + table->tolerance) : low;
            repeated |= (corner >> k & 1) && cell[k] == low;
        }
        if (!repeated) {
            best = search_bucket(table, bucket_of(table, cell), v, best);
        }
    }
    return best;
}

static void insert(cell_table* table, int v) {
    const double* x = table->position + 3 * (size_t)v;
    const double cell[3] = {cell_of(table, x[0]), cell_of(table, x[1]), cell_of(table, x[2])};
    uint32_t bucket = bucket_of(table, cell);
    table->next[v] = table->head[bucket];
    table->head[bucket] = v;
}

// number[v] = new number of v's vertex; returns how many are kept.
static int number_vertices(cell_table* table, int count, int* number) {
    int kept = 0;
    for (int v = 0; v < count; v++) {
        const double* x = table->position + 3 * (size_t)v;
        // What is not finite stays outside the table, where it could only make one bucket long.
        bool finite = isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
        int earlier = finite ? find_close(table, v) : INT_MAX;
        if (earlier == INT_MAX) {
            if (finite) {
                insert(table, v);
            }
            number[v] = kept++;
        } else {
            number[v] = number[earlier];
        }
    }
    return kept;
}

// A kept vertex is the first of its number, so that it moves down in place.
static void compact(ruga_mesh* mesh, const int* number, int kept) {
    int next = 0;
    for (int v = 0; v < mesh->vertex_count; v++) {
        if (number[v] == next) {
            memmove(mesh->position + 3 * (size_t)next, mesh->position + 3 * (size_t)v, 3 * sizeof(double));
            if (mesh->source_vertex) {
                mesh->source_vertex[next] = mesh->source_vertex[v];
            }
            next++;
        }
    }
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        mesh->triangle[i] = number[mesh->triangle[i]];
    }
    mesh->vertex_count = kept;
}

ruga_status ruga_mesh_weld(ruga_mesh* mesh, double tolerance) {
    RUGA_ASSERT(tolerance >= 0);
    ruga_status status = RUGA_OK;
    cell_table table = {.tolerance = tolerance, .position = mesh->position, .mask = 1};
    int* number = NULL;
    while (table.mask < (uint32_t)mesh->vertex_count) {
        table.mask = 2 * table.mask + 1;
    }
    RUGA_TRY_DONE(RUGA_NEW(table.head, (size_t)table.mask + 1));
    RUGA_TRY_DONE(RUGA_NEW(table.next, mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(number, mesh->vertex_count));
    memset(table.head, 0xff, ((size_t)table.mask + 1) * sizeof *table.head); // all -1
    int kept = number_vertices(&table, mesh->vertex_count, number);
    compact(mesh, number, kept);
done:
    ruga_release(table.head);
    ruga_release(table.next);
    ruga_release(number);
    return status;
}
