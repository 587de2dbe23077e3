// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The paper's springs between nodes and their virtual copies, kept beside the hinges of hinge.h for
// comparison.
#ifndef RUGA_CREASE_SPRINGS_H
#define RUGA_CREASE_SPRINGS_H

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

// 1/2 k (|x_a - x_b| - length)^2, k in N/m. Derivatives by node 0 are SET where not NULL (those by node 1
// have the other sign, mixed ones likewise). Where the nodes coincide the direction is undefined: the
// gradient is zero.
double ruga_pair_energy(const ruga_pair* pair, double stiffness, double length, const double* x,
                        double gradient[3], double hessian[9]);

#endif
