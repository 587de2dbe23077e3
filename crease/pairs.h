// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What the paper's springs between nodes and their virtual copies join (crease/cloth.h has the springs).
#ifndef RUGA_CREASE_PAIRS_H
#define RUGA_CREASE_PAIRS_H

#include "crease/cut.h"

// Two copies of a mesh vertex that a crease keeps apart.
typedef struct ruga_pair {
    int node[2];
    int curve;
} ruga_pair;

// All pairs of folded creases, each once, by curve and node. *pair [*count] is the caller's to release.
ruga_status ruga_pairs_create(const ruga_cut* cut, int* count, ruga_pair** pair);
// Index of the pair of two nodes at a curve, -1 = they are none.
int ruga_pairs_find(int count, const ruga_pair* pair, int a, int b, int curve);

#endif
