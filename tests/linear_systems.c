// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/linear_systems.h"

#include "core/memory.h"
#include "core/random.h"
#include "tests/check.h"

#include <stdlib.h>

static const double stretching = 1e6, bending = 1e3;

void system_clear(linear_system* s) {
    ruga_sparse_clear(&s->a);
    ruga_release(s->node_start);
    ruga_release(s->last);
}

void system_create(linear_system* s, int nodes, int block, int multipliers, int pair_count,
                   const int (*pairs)[2]) {
    *s = (linear_system){.nodes = nodes};
    assert_ok(ruga_sparse_from_pairs(nodes, block, pair_count, pairs, &s->a));
    assert_ok(RUGA_NEW(s->node_start, nodes + 1));
    assert_ok(RUGA_NEW(s->last, nodes + 1));
    for (int i = 0; i <= nodes; i++) {
        s->node_start[i] = i * block;
        s->last[i] = i >= multipliers;
    }
}

static void add(linear_system* s, int i, int j, double value) {
    int p = ruga_sparse_find(&s->a, i > j ? i : j, i > j ? j : i);
    assert_true(p >= 0);
    s->a.value[p] += value;
}

void laplacian(linear_system* s, int side) {
    int(*pairs)[2] = NULL, count = 0;
    assert_ok(RUGA_NEW(pairs, 2 * side * side));
    for (int y = 0; y < side; y++) {
        for (int x = 0; x < side; x++) {
            int v = y * side + x;
            if (x + 1 < side) {
                pairs[count][0] = v;
                pairs[count++][1] = v + 1;
            }
            if (y + 1 < side) {
                pairs[count][0] = v;
                pairs[count++][1] = v + side;
            }
        }
    }
    system_create(s, side * side, 3, side * side, count, (const int(*)[2])pairs);
    ruga_random random = {1};
    for (int k = 0; k < count; k++) {
        double n[3];
        for (int c = 0; c < 3; c++) {
            n[c] = 2 * ruga_random_uniform(&random) - 1;
        }
        for (int c = 0; c < 3; c++) {
            for (int d = 0; d < 3; d++) {
                double value = n[c] * n[d] + (c == d ? 0.2 : 0);
                int i = 3 * pairs[k][0], j = 3 * pairs[k][1];
                add(s, i + c, j + d, -value);
                if (d <= c) {
                    add(s, i + c, i + d, value);
                    add(s, j + c, j + d, value);
                }
            }
        }
    }
    for (int i = 0; i < s->a.rows; i++) {
        add(s, i, i, 0.1);
    }
    ruga_release(pairs);
}

void congruence(linear_system* s, int n, int fill, const double* d, uint64_t seed) {
    double *l = NULL, *dense = NULL;
    int(*pairs)[2] = NULL, count = 0;
    assert_ok(RUGA_NEW_ZERO(l, (size_t)n * (size_t)n));
    assert_ok(RUGA_NEW_ZERO(dense, (size_t)n * (size_t)n));
    assert_ok(RUGA_NEW(pairs, n * n));
    ruga_random random = {seed};
    for (int j = 0; j < n; j++) {
        l[j * n + j] = 1;
        for (int k = 0; k < fill && j + 1 < n; k++) {
            int i = j + 1 + (int)(ruga_random_uniform(&random) * (n - j - 1));
            l[j * n + i] = 2 * ruga_random_uniform(&random) - 1;
        }
    }
    for (int k = 0; k < n; k++) {
        for (int j = k; j < n; j++) {
            for (int i = j; l[k * n + j] != 0 && i < n; i++) {
                dense[j * n + i] += l[k * n + i] * d[k] * l[k * n + j];
            }
        }
    }
    for (int j = 0; j < n; j++) {
        for (int i = j + 1; i < n; i++) {
            if (dense[j * n + i] != 0) {
                pairs[count][0] = i;
                pairs[count++][1] = j;
            }
        }
    }
    system_create(s, n, 1, n, count, (const int(*)[2])pairs);
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            if (dense[j * n + i] != 0) {
                add(s, i, j, dense[j * n + i]);
            }
        }
    }
    ruga_release(l);
    ruga_release(dense);
    ruga_release(pairs);
}

int kkt_clusters(const kkt_def* def) {
    int along = (def->side + def->spacing - 1) / def->spacing;
    return along * along;
}

void push(pair_list* list, int i, int j) {
    assert_ok(RUGA_RESERVE(list->pairs, list->capacity, list->count + 1));
    list->pairs[list->count][0] = i;
    list->pairs[list->count++][1] = j;
}

// The visitor sees (cluster, vertex, weight) of every entry of H.
typedef void visit_weight(int cluster, int vertex, double h, void* context);
static void visit_clusters(const kkt_def* def, visit_weight* visit, void* context) {
    int along = (def->side + def->spacing - 1) / def->spacing, count = kkt_clusters(def);
    for (int k = 0; k < count + def->repeated; k++) {
        int c = k < count ? k : k - count;
        double cx = (c % along + 0.5) * def->spacing - 0.5, cy = ((c / along) + 0.5) * def->spacing - 0.5;
        for (int v = 0; v < def->side * def->side; v++) {
            double dx = v % def->side - cx, dy = (v / def->side) - cy, r2 = dx * dx + dy * dy;
            if (r2 <= def->radius * def->radius) {
                visit(k, v, kkt_weight * exp(-r2 / (2 * def->radius * def->radius)), context);
            }
        }
    }
}

typedef struct kkt_builder {
    linear_system* s;
    pair_list list;
    int vertices;
} kkt_builder;

static void push_weight(int cluster, int vertex, double h, void* context) {
    (void)h;
    kkt_builder* b = context;
    push(&b->list, b->vertices + cluster, vertex);
}

static void add_weight(int cluster, int vertex, double h, void* context) {
    kkt_builder* b = context;
    for (int c = 0; c < 3; c++) {
        add(b->s, 3 * (b->vertices + cluster) + c, 3 * vertex + c, h);
    }
}

static void add_spring(linear_system* s, int i, int j, double nx, double ny) {
    double n[2] = {nx, ny};
    for (int c = 0; c < 2; c++) {
        for (int d = 0; d < 2; d++) {
            add(s, 3 * i + c, 3 * j + d, -stretching * n[c] * n[d]);
            if (d <= c) {
                add(s, 3 * i + c, 3 * i + d, stretching * n[c] * n[d]);
                add(s, 3 * j + c, 3 * j + d, stretching * n[c] * n[d]);
            }
        }
    }
}

// The square of the Laplacian at vertex v, across the sheet.
static void add_bending(linear_system* s, int v, int side) {
    const int stencil[5] = {v, v - 1, v + 1, v - side, v + side};
    const double l[5] = {-4, 1, 1, 1, 1};
    for (int a = 0; a < 5; a++) {
        for (int b = 0; b < 5; b++) {
            if (stencil[b] <= stencil[a]) {
                add(s, 3 * stencil[a] + 2, 3 * stencil[b] + 2, bending * l[a] * l[b]);
            }
        }
    }
}

void kkt(linear_system* s, const kkt_def* def) {
    int side = def->side, vertices = side * side;
    const double r = sqrt(0.5);
    const int along[4][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
    kkt_builder b = {.s = s, .vertices = vertices};
    visit_clusters(def, push_weight, &b);
    for (int v = 0; v < vertices; v++) {
        for (int dy = 0; dy <= 2; dy++) {
            for (int dx = -2; dx <= 2; dx++) {
                int x = v % side + dx, y = (v / side) + dy;
                if (x >= 0 && x < side && y < side && abs(dx) + dy <= 2) {
                    push(&b.list, v, y * side + x);
                }
            }
        }
    }
    system_create(s, vertices + kkt_clusters(def) + def->repeated, 3, vertices, b.list.count,
                  (const int(*)[2])b.list.pairs);
    visit_clusters(def, add_weight, &b);
    for (int v = 0; v < vertices; v++) {
        int x = v % side, y = v / side;
        for (int k = 0; k < 4; k++) {
            int u = x + along[k][0], w = y + along[k][1];
            if (u >= 0 && u < side && w < side) {
                add_spring(s, v, w * side + u, along[k][0] * (k < 2 ? 1 : r), along[k][1] * (k < 2 ? 1 : r));
            }
        }
        if (x > 0 && x < side - 1 && y > 0 && y < side - 1) {
            add_bending(s, v, side);
        }
        add(s, 3 * v, 3 * v, 1);
        add(s, 3 * v + 1, 3 * v + 1, 1);
        bool rim = x == 0 || x == side - 1 || y == 0 || y == side - 1;
        add(s, 3 * v + 2, 3 * v + 2, (rim ? 1 : -def->shift) * bending);
    }
    ruga_release(b.list.pairs);
}
