// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A prescribed interior that follows a moving surface: the lattice is fitted to each sample of it.
#ifndef RUGA_SOLVER_FOLLOW_H
#define RUGA_SOLVER_FOLLOW_H

#include "lattice/lattice.h"
#include "mesh/mesh.h"

typedef struct ruga_follow {
    int count, node_count;
    double* time; // [count] s, ascending
    double* q;    // [count][N][3]
    double error; // m, root mean square over the area of what B q leaves of the surface, at the worst sample
    double compression; // largest along any direction of any triangle of B q
} ruga_follow;

// Reads the samples of `def` one after another; area [V] of the mesh's vertices. RUGA_BAD_INPUT where times
// do not ascend or a position is not a number.
ruga_status ruga_follow_create(const ruga_lattice* lattice, const ruga_mesh* mesh, const double* area,
                               const ruga_motion_def* def, ruga_follow* follow);
// Frees the arrays (not the struct) and zeroes it.
void ruga_follow_clear(ruga_follow* follow);
// Node positions q [N][3]: linear between samples, held outside.
void ruga_follow_at(const ruga_follow* follow, double time, double* q);

#endif
