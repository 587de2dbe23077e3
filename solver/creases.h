// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The creases of a model: its mesh cut along their curves (crease/cut.h), and the hinges on them. Three
// meshes come of one: the `sheet`, mended until the curves fit it, which regions, lattice and clusters see;
// the nodes, real and virtual, with a triangle for each piece, which is what moves; and the material, which
// is shown.
#ifndef RUGA_SOLVER_CREASES_H
#define RUGA_SOLVER_CREASES_H

#include "constraints/attachments.h"
#include "constraints/clusters.h"
#include "crease/hinge.h"
#include "crease/sewing.h"
#include "shell/material.h"

// Where a crease of the def comes from, and how its rest angle changes.
typedef struct ruga_crease_law {
    int key_count;
    ruga_crease_key* keys;
    double yield, rate, hardening;
    char assignment;
    char* name;
} ruga_crease_law;

typedef struct ruga_creases {
    ruga_raster raster; // its mesh is the sheet; curve[c].label is the number of the def
    ruga_cut cut;
    ruga_sewing sewing;      // the rows, with nothing held
    ruga_connectivity shown; // of the material
    int law_count;
    ruga_crease_law* law; // [defs]
    int segment_count;    // straight pieces of folds
    int hinge_count;      // those, then auxiliary chords
    int* segment;         // [hinges] index in cut.segment
    ruga_hinge* hinge;    // [hinges]
    double* stiffness;    // [hinges] N
    double* drawn;        // [hinges] rad, the angle that the mesh has
    double* rest;         // [hinges] rad, before keys and plasticity
    double* steepness;    // [hinges] 1/m^2, |grad theta|^2 as drawn
    double answer;        // N/m, of all folds' forces to displacements: the root of the sum of their squares
    double* area;         // [nodes] m^2 of material
    double* share;        // [nodes] part of the vertex's area that this copy has
    double* fraction;     // [pieces] of the membrane
    double (*mass)[3];    // [pieces]
    ruga_shell_bend* bend;
    int (*pair)[2]; // nodes that a hinge joins
    int pair_count;
} ruga_creases;

// When creases come: stage [defs] of each, 0 = from the beginning, and end [defs], in frames of `step` s, of
// stages but the last: their number is returned. What is a round-off from a frame is at it.
int ruga_creases_stages(int count, const ruga_crease_def* defs, double step, int* stage, double* end);
// With the creases up to stage `now`, on a mesh that is mended for all. `mesh` must have passed the doctor.
// RUGA_BAD_INPUT names the crease ("creases.2: ...").
ruga_status ruga_creases_create(int count, const ruga_crease_def* defs, const int* stage, int now,
                                const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                ruga_creases** creases);
void ruga_creases_destroy(ruga_creases** creases);
// Stiffness of auxiliary chords, from the material of the pieces.
void ruga_creases_set_bending(ruga_creases* creases, const ruga_shell_material* material);
// The mesh of nodes and pieces.
ruga_status ruga_creases_nodes(const ruga_creases* creases, ruga_mesh* nodes);
// Edges and neighbours of that mesh, which may have more than two triangles at an edge; nothing else is set.
ruga_status ruga_creases_edges(const ruga_mesh* nodes, ruga_connectivity* edges);
// Where the corners of the material's triangles are, [F of the material][3], for loads.
ruga_status ruga_creases_places(const ruga_creases* creases, ruga_load_place (**place)[3]);
// How a shell on the nodes is cut.
ruga_shell_cut ruga_creases_shell(const ruga_creases* creases);
// Rows over vertices of the sheet become rows over nodes, each copy with its share, and the sewing's rows
// follow.
ruga_status ruga_creases_tie(const ruga_creases* creases, ruga_clusters* clusters);
// What stretching of rest angles a crease's keys give at a time: angle + scale times rest.
double ruga_crease_rest_at(const ruga_creases* creases, int hinge, double time);
// The angle, in (-pi, pi], of the material that is shown, [vertices][3], at the segment of a hinge.
double ruga_creases_shown_angle(const ruga_creases* creases, int hinge, const double* shown);
// Number of the def that a hinge belongs to.
int ruga_crease_law_of(const ruga_creases* creases, int hinge);

#endif
