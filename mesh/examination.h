// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What the parts of the mesh doctor share: the mesh being examined, its edges however broken, the findings.
#ifndef RUGA_MESH_EXAMINATION_H
#define RUGA_MESH_EXAMINATION_H

#include "mesh/doctor.h"

typedef struct ruga_examination {
    const ruga_mesh* mesh;
    ruga_check_as as;
    ruga_check_report* report;
    int defect_capacity;
    bool* not_finite; // [F] a corner is not finite: nothing can be measured
    bool* collapsed;  // [F] two corners are the same vertex: the face has no part in the topology
    bool* flat;       // [F] no area (or one of the above)
    // Edges of all faces that are not collapsed. Corner 3 f + i stands for the edge from corner i of face f
    // to the next one.
    int edge_count;
    int* edge_start;  // [E + 1] into edge_corner
    int* edge_corner; // [edge_start[E]] corners of each edge, ascending
    int* corner_edge; // [3 F] -1 for collapsed faces
    int component_count;
    int* component; // [V] by shared vertices; -1 for unused vertices
    bool* closed;   // [C] every edge of the component is in two faces that run opposite ways
} ruga_examination;

// Counts a defect and, up to 100 of a kind, lists it. Vertices and faces: -1 = none.
ruga_status ruga_examination_add(ruga_examination* x, ruga_defect_kind kind, const int vertex[2],
                                 const int face[2]);

// mesh/topology.c: fills edges and components, and finds open and non-manifold edges and vertices, flipped
// and duplicate faces and unused vertices; watertight and genus.
ruga_status ruga_examine_topology(ruga_examination* x);

// mesh/geometry.c: vertices that are not finite, faces without area, slivers; fills not_finite, collapsed,
// flat.
ruga_status ruga_examine_faces(ruga_examination* x);
// Crossing faces and overlapping components, components inside out, polygons that are not flat. After
// topology.
ruga_status ruga_examine_shape(ruga_examination* x);

static inline const int* ruga_examined_face(const ruga_examination* x, int face) {
    return x->mesh->triangle + 3 * (size_t)face;
}
static inline const double* ruga_examined_point(const ruga_examination* x, int vertex) {
    return x->mesh->position + 3 * (size_t)vertex;
}

#endif
