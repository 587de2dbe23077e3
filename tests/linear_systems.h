// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Sparse symmetric systems for the tests of direct solvers.
#ifndef RUGA_TESTS_LINEAR_SYSTEMS_H
#define RUGA_TESTS_LINEAR_SYSTEMS_H

#include "core/sparse.h"

typedef struct linear_system {
    ruga_sparse a;
    int nodes;
    int* node_start;
    bool* last;
} linear_system;

void system_clear(linear_system* s);

// The pattern of these pairs of nodes of `block` unknowns; nodes from `multipliers` on are marked last.
void system_create(linear_system* s, int nodes, int block, int multipliers, int pair_count,
                   const int (*pairs)[2]);

// side x side vertices, 3 x 3 blocks: springs n n^T + 0.2 I along grid edges with random n, plus 0.1 I.
void laplacian(linear_system* s, int side);

// L D L^T with L unit lower triangular, about `fill` random entries in each column, and the given D.
void congruence(linear_system* s, int n, int fill, const double* d, uint64_t seed);

// A growing list of pairs of nodes.
typedef struct pair_list {
    int (*pairs)[2];
    int count, capacity;
} pair_list;
void push(pair_list* list, int i, int j);

typedef struct kkt_def {
    int side;      // vertices along each side of the sheet
    int spacing;   // vertices between cluster centres
    double radius; // of a cluster, in vertices; its Gaussian has this width
    double shift;  // negative stiffness across the sheet, in units of the bending stiffness
    int repeated;  // clusters that are there twice
} kkt_def;

// The largest weight of a cluster: H is far smaller than K, as its unit is another.
static const double kkt_weight = 1e-2;

// Clusters without the repeated ones.
int kkt_clusters(const kkt_def* def);

// [K H^T; H 0] of a flat sheet of springs with bending, held on average by Gaussian clusters.
void kkt(linear_system* s, const kkt_def* def);

#endif
