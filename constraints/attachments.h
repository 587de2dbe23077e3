// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Handles: which material a region selects, exact linear rows that hold it, and loads. In the interior the
// material points of a region are its embedded surface vertices and the quadrature points (with material)
// inside it; holding them exactly is A q = A q_target, of which an independent set of rows is kept.
#ifndef RUGA_CONSTRAINTS_ATTACHMENTS_H
#define RUGA_CONSTRAINTS_ATTACHMENTS_H

#include "core/sparse.h"
#include "lattice/lattice.h"
#include "mesh/connectivity.h"

// Vertices of the rest mesh in the region, ascending, into selected [V] (caller's); count out, which may be
// 0. Bounds have a slack of 1e-9 of the mesh's size, so that what was drawn at a bound is in. RUGA_BAD_INPUT
// where a group does not exist (with those that do), or a listed vertex is out of range.
ruga_status ruga_region_vertices(const ruga_region* region, const ruga_mesh* mesh, int* count, int* selected);
// Whether a rest position is in the region (to a slack in m). A group or a list of vertices contains no
// positions, only vertices.
bool ruga_region_contains_within(const ruga_region* region, const double x[3], double slack);
double ruga_region_slack(const ruga_mesh* mesh);
// Index of the region's group.
ruga_status ruga_region_group(const ruga_region* region, const ruga_mesh* mesh, int* group);
// Fails with the sentence for a handle whose region selects no `what`.
ruga_status ruga_region_empty(const ruga_region* region, const ruga_mesh* mesh, int handle, const char* what);

// One independent row of A acts on one component: sum_k weight[k] q[node[k]][axis] = target. A row is a
// material point's, or a single node (weight 1) whose motion the held material determines; the weights sum to
// one.
typedef struct ruga_rows {
    int count;
    int* axis;   // [count] ascending
    int* handle; // [count] index of the handle it belongs to
    int* start;  // [count + 1]
    int* node;   // lattice nodes
    double* weight;
    double* point; // [count][3] rest position of the point or node: target = handle's motion of it
} ruga_rows;

// Rows of all fix and move handles that hold the interior. Where handles overlap the first one wins.
// RUGA_BAD_INPUT where a handle selects no material.
ruga_status ruga_rows_create(const ruga_lattice* lattice, const ruga_mesh* mesh, int handle_count,
                             const ruga_handle_def* handles, ruga_rows* rows);
void ruga_rows_clear(ruga_rows* rows);
// The two handles of different motions that come nearest to one another, and how many cells lie between nodes
// that they hold, along the axis where most do; INFINITY where no two differ.
double ruga_rows_nearest(const ruga_rows* rows, const ruga_lattice* lattice, const ruga_handle_def* handles,
                         int pair[2]);

// Ramp factor in [0, 1] of a handle at a time, and where its motion takes a rest point at that time. The
// motion is affine in the rest point; handles that are not moves leave it where it is.
double ruga_handle_ramp(const ruga_handle_def* handle, double time);
void ruga_handle_target(const ruga_handle_def* handle, double time, const double rest[3], double target[3]);

// External forces on the skin at positions x [V][3] and time: follower pressure on the triangles whose three
// vertices are in the region (on a group's faces), total force (spread by rest area), line force (on boundary
// edges with both ends in the region). RUGA_BAD_INPUT where a handle selects nothing to act on.
typedef struct ruga_loads ruga_loads;
ruga_status ruga_loads_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity, int handle_count,
                              const ruga_handle_def* handles, ruga_loads** loads);
// The same where the mesh is what a cut one shows (crease/cut.h): corner i of triangle f is at sum over k of weight[k]
// x[node[k]], place [F][3]. One that is a node itself has it twice, with weights 1 and 0.
typedef struct ruga_load_place {
    int node[2];
    double weight[2];
} ruga_load_place;
ruga_status ruga_loads_create_placed(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                     const ruga_load_place (*place)[3], int handle_count,
                                     const ruga_handle_def* handles, ruga_loads** loads);
void ruga_loads_destroy(ruga_loads** loads);
// Potential energy in J is SET (the pressure's is p times the volume swept by the region's triangles from
// rest; dead loads' is -f.(x - rest)); its gradient (minus force) is ADDED where not NULL, and the pressure's
// exact Hessian ADDED to values of `pattern` (3 x 3 blocks over vertices) where not NULL. force_square
// (where not NULL): the sum over triangles and loaded vertices of squared nodal forces is ADDED.
ruga_status ruga_loads_energy(const ruga_loads* loads, const double* x, double time, double* energy,
                              double* gradient, const ruga_sparse* pattern, double* hessian,
                              double* force_square);

#endif
