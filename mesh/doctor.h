// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The mesh doctor: every defect with its kind and place.
#ifndef RUGA_MESH_DOCTOR_H
#define RUGA_MESH_DOCTOR_H

#include "mesh/mesh.h"

// Kind, its name in JSON, and what to do about it.
#define RUGA_DEFECT_LIST(X)                                                                                  \
    X(RUGA_DEFECT_NO_FACES, "no_faces", "the mesh has no faces")                                             \
    X(RUGA_DEFECT_NAN, "nan", "a vertex position is not finite")                                             \
    X(RUGA_DEFECT_OPEN_EDGE, "open_edge", "an edge belongs to one face only: close the hole")                \
    X(RUGA_DEFECT_NON_MANIFOLD_EDGE, "non_manifold_edge", "an edge belongs to more than two faces")          \
    X(RUGA_DEFECT_NON_MANIFOLD_VERTEX, "non_manifold_vertex", "faces touch at a vertex only: separate them") \
    X(RUGA_DEFECT_FLIPPED_FACE, "flipped_face", "neighbouring faces run the same way along their edge: flip one") \
    X(RUGA_DEFECT_INSIDE_OUT, "inside_out", "a closed component has negative volume: flip all its faces")    \
    X(RUGA_DEFECT_DUPLICATE_FACE, "duplicate_face", "two faces have the same vertices: delete one")          \
    X(RUGA_DEFECT_DEGENERATE_FACE, "degenerate_face", "a face has no area: delete or collapse it")           \
    X(RUGA_DEFECT_SELF_INTERSECTION, "self_intersection", "two faces of one component cross")                \
    X(RUGA_DEFECT_SLIVER, "sliver", "a face is very thin: remesh for a good simulation")                     \
    X(RUGA_DEFECT_UNUSED_VERTEX, "unused_vertex", "a vertex belongs to no face")                             \
    X(RUGA_DEFECT_NON_PLANAR_POLYGON, "non_planar_polygon", "a polygon is not flat; it was triangulated")    \
    X(RUGA_DEFECT_OVERLAP, "overlapping_components", "two components cross one another")

#define RUGA_DEFECT_ENUM(code, name, sentence) code,
typedef enum ruga_defect_kind { RUGA_DEFECT_LIST(RUGA_DEFECT_ENUM) RUGA_DEFECT_KINDS } ruga_defect_kind;
#undef RUGA_DEFECT_ENUM

typedef enum ruga_severity { RUGA_SEVERITY_WARNING, RUGA_SEVERITY_ERROR } ruga_severity;

typedef struct ruga_defect {
    ruga_defect_kind kind;
    ruga_severity severity;
    int vertex[2]; // an edge's vertices, or a vertex; -1 = none (0-based, of the mesh)
    int face[2];   // -1 = none
    double position[3];
} ruga_defect;

typedef enum ruga_check_as { RUGA_CHECK_EMBEDDED, RUGA_CHECK_SHELL } ruga_check_as;

typedef struct ruga_check_report {
    int vertex_count, triangle_count, edge_count, component_count;
    bool watertight;  // every edge in exactly two faces that run opposite ways
    int genus;        // sum over closed components; -1 where the mesh is not closed and manifold
    double area, volume, min[3], max[3];
    double edge_min, edge_mean, edge_max;
    double angle_min; // smallest corner angle, rad
    int count[RUGA_DEFECT_KINDS]; // of each kind, all of them
    int error_count, warning_count;
    int defect_count; // listed, at most 100 of each kind
    ruga_defect* defect;
} ruga_check_report;

// Always succeeds on a mesh with defects (they are data); fails only for lack of memory or a library.
ruga_status ruga_mesh_check(const ruga_mesh* mesh, ruga_check_as as, ruga_check_report* report);
void ruga_check_report_clear(ruga_check_report* report);
const char* ruga_defect_name(ruga_defect_kind kind);
const char* ruga_defect_sentence(ruga_defect_kind kind);

// RUGA_BAD_MESH with a sentence that names the first error, its place and the number of others; OK where the
// report has no error.
ruga_status ruga_check_status(const ruga_check_report* report, const char* mesh_name);

#endif
