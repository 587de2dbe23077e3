// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Handles: which material a region selects, and exact linear rows that hold it. In the interior the material
// points of a region are its embedded surface vertices and the quadrature points (with material) inside it; holding them
// exactly is A q = A q_target, of which an independent set of rows is kept (rank-revealing sparse QR).
#ifndef RUGA_CONSTRAINTS_ATTACHMENTS_H
#define RUGA_CONSTRAINTS_ATTACHMENTS_H

#include "lattice/lattice.h"
#include "mesh/connectivity.h"

// Vertices of the rest mesh in the region, ascending, into selected [V] (caller's); count out. RUGA_BAD_INPUT
// where a group does not exist (with those that do), or a listed vertex is out of range.
ruga_status ruga_region_vertices(const ruga_region* region, const ruga_mesh* mesh, int* count, int* selected);
bool ruga_region_contains(const ruga_region* region, const double x[3]);

// One independent row of A acts on one component: sum_k weight[k] q[node[k]][axis] = target.
typedef struct ruga_rows {
    int count;
    int* axis;      // [count]
    int* handle;    // [count] index of the handle it belongs to
    int* start;     // [count + 1]
    int* node;      // lattice nodes
    double* weight;
    double* point;  // [count][3] rest position of the material point: target = handle's motion of it
} ruga_rows;

// Rows of all fix and move handles that hold the interior. Where handles overlap the first one wins.
// RUGA_BAD_INPUT where a handle selects no material.
ruga_status ruga_rows_create(const ruga_lattice* lattice, const ruga_mesh* mesh, int handle_count,
                             const ruga_handle_def* handles, ruga_rows* rows);
void ruga_rows_clear(ruga_rows* rows);

// Ramp factor in [0, 1] of a handle at a time, and where its motion takes a rest point at that time.
double ruga_handle_ramp(const ruga_handle_def* handle, double time);
void ruga_handle_target(const ruga_handle_def* handle, double time, const double rest[3], double target[3]);

// External forces on the skin at positions x [V][3] and time: follower pressure, total force (spread by rest
// area), line force (on boundary edges of the region). Adds to force [V][3]. force_square [optional]: adds.
typedef struct ruga_loads ruga_loads;
ruga_status ruga_loads_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity, int handle_count,
                              const ruga_handle_def* handles, ruga_loads** loads);
void ruga_loads_destroy(ruga_loads** loads);
// Potential energy in J (the pressure's is p times the volume swept by the region's triangles; exact for dead loads), gradient ADDED
// (minus force) where not NULL, and the pressure's Hessian (symmetric part) ADDED to values of `pattern` where not NULL.
ruga_status ruga_loads_energy(const ruga_loads* loads, const double* x, double time, double* energy,
                              double* gradient, const ruga_sparse* pattern, double* hessian,
                              double* force_square);

#endif
