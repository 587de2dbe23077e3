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
#include "solver/creases.h"
#include "solver/dense.h"
#include "solver/follow.h"
#include "ruga/ruga.h"

enum { RUGA_MODEL_COOKIE = 0x52756761 };

// A skin that varies: what belongs to single places. NULL where it is the same everywhere.
typedef struct ruga_variation {
    double *thickness, *young, *growth;                            // [V] m, [V] Pa, [V][2]
    double *triangle_thickness, *triangle_young, *triangle_growth; // their means over corners
    double* wavelength;        // [V] local eq. 3, m; NULL without an interior
    double* scale;             // [V] wavelength over the mean one
    double* triangle_critical; // [F] local critical strain; NULL without an interior
} ruga_variation;

// What a model is until some of its creases come (stages.h).
typedef struct ruga_stage {
    ruga_model* model;  // the same sheet without them
    double end;         // frames
    int *node, *hinge;  // [nodes and hinges of the whole] in this one; a hinge that is not there is -1
} ruga_stage;

struct ruga_model {
    int stage_count; // before all creases are there
    ruga_stage* stage;
    int *parent_node, *parent_hinge; // of one that follows another: likewise, in that one

    ruga_mesh mesh;         // what moves: with creases the nodes, and a triangle for each piece
    ruga_creases* creases;  // NULL = none
    const ruga_mesh* sheet; // what regions, lattice and clusters see: the mesh, before it was cut
    ruga_connectivity connectivity; // of the sheet
    double center[3]; // of the mesh's bounding box
    double mean_edge;
    double extent;    // diagonal of the bounding box, m

    ruga_skin_def skin; // of one that varies: means over the area; its own arrays are NULL
    ruga_variation variation;
    bool has_interior;
    ruga_interior_def interior;
    ruga_lattice_def lattice_def;
    ruga_coupling_def coupling; // count, radius and sigma as used
    ruga_solver_def solver;     // method as used, never default
    double step;
    int frames;
    double gravity[3];
    ruga_start_def start;
    double* started; // [V][3] m, a free skin's shape at time 0; NULL = the mesh's (start.h)
    int keyframe_count;
    ruga_keyframe_def* keyframes;
    ruga_follow follow; // count 0 where the interior follows no surface
    int handle_count;
    ruga_handle_def* handles; // with copies of names and vertex lists
    ruga_loads* loads;

    // m and 1, 0 without an interior; where the skin varies the mean over the area, and the smallest.
    double wavelength, critical_strain;
    double wavelength_min, wavelength_max, critical_strain_max;
    double edges;                      // per wavelength, at the worst place; 0 without an interior
    double edges_wavelength;           // m, at that place
    double foundation_a, foundation_b; // N/m^3 and N/m, at the mean wavelength; 0 without a foundation

    ruga_lattice lattice;
    ruga_rows rows;             // exact holds of the interior
    ruga_clusters clusters;     // count 0 where there are none; with creases the rows of the sewing come last
    int seam;                   // the first of these; clusters.count where there are none
    ruga_foundation foundation; // vertex_count 0 where there is none
    double* vertex_area;        // [V] m^2, rest
    int* skin_handle;           // [V][3] the handle that holds this component of the skin; -1 = free
    bool any_skin_held;
    bool solves_skin; // false: x = B q, or the dense volume's
    ruga_dense dense; // skin.model: volume; no nodes otherwise
};

// Checks and copies the arrays of a skin that varies, and puts means in the place of the skin's single
// values. An array of equal values is a single value. Then wavelengths, critical strains and edges per
// wavelength, local and all.
ruga_status ruga_variation_create(const ruga_skin_def* skin, ruga_model* model);
ruga_status ruga_variation_wavelengths(ruga_model* model);
// With creases: the arrays go through the cutting as attributes of the mesh, and come out at the nodes.
ruga_status ruga_variation_carry(const ruga_skin_def* skin, ruga_mesh* mesh);
ruga_status ruga_variation_create_cut(const ruga_skin_def* skin, ruga_model* model);
// Values of what moves, [nodes][components] or NULL, at the vertices that are shown: *shown is the caller's.
ruga_status ruga_variation_show(const ruga_model* model, const double* values, int components, double** shown);
void ruga_variation_clear(ruga_variation* variation);

// The least reference force, N: 1e-8 E h times the mean edge, and never so small that the tolerance would be
// below the round-off of the gradient.
double ruga_model_force_floor(const ruga_model* model);

// The mesh that is shown: with creases the material, embedded nodes included.
const ruga_mesh* ruga_model_shown(const ruga_model* model);

bool ruga_model_is_prescribed(const ruga_model* model);

#endif
