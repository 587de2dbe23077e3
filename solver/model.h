// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Everything of a simulation that never changes once built.
#ifndef RUGA_SOLVER_MODEL_H
#define RUGA_SOLVER_MODEL_H

#include "constraints/attachments.h"
#include "constraints/clusters.h"
#include "constraints/foundation.h"
#include "lattice/lattice.h"
#include "mesh/connectivity.h"
#include "mesh/mesh.h"
#include "solver/dense.h"
#include "ruga/ruga.h"

enum { RUGA_MODEL_COOKIE = 0x52756761 };

struct ruga_model {
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    double center[3]; // of the mesh's bounding box
    double mean_edge;
    double extent;    // diagonal of the bounding box, m

    ruga_skin_def skin;
    bool has_interior;
    ruga_interior_def interior;
    ruga_lattice_def lattice_def;
    ruga_coupling_def coupling; // count, radius and sigma as used
    ruga_solver_def solver;     // method as used, never default
    double step;
    int frames;
    double gravity[3];
    int keyframe_count;
    ruga_keyframe_def* keyframes;
    int handle_count;
    ruga_handle_def* handles; // with copies of names and vertex lists
    ruga_loads* loads;

    double wavelength, critical_strain; // 0 without an interior
    double foundation_a, foundation_b;  // N/m^3 and N/m; 0 without a foundation

    ruga_lattice lattice;
    ruga_rows rows;             // exact holds of the interior
    ruga_clusters clusters;     // count 0 where there are none
    ruga_foundation foundation; // vertex_count 0 where there is none
    double* vertex_area;        // [V] m^2, rest
    int* skin_handle;           // [V][3] the handle that holds this component of the skin; -1 = free
    bool any_skin_held;
    bool solves_skin; // false: x = B q, or the dense volume's
    ruga_dense dense; // skin.model: volume; no nodes otherwise
};

// The least reference force, N: 1e-8 E h times the mean edge, and never so small that the tolerance would be
// below the round-off of the gradient.
double ruga_model_force_floor(const ruga_model* model);

bool ruga_model_is_prescribed(const ruga_model* model);

#endif
