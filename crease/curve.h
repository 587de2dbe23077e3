// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Crease curves as they are drawn: polylines in space, paths along mesh edges, borders of groups, polylines
// in texture coordinates. raster.h brings them to the mesh.
#ifndef RUGA_CREASE_CURVE_H
#define RUGA_CREASE_CURVE_H

#include "mesh/connectivity.h"
#include "mesh/mesh.h"

typedef struct ruga_curve {
    ruga_crease_kind kind;
    ruga_crease_freedom freedom;
    bool varies; // its angle is to vary along its length
    bool closed; // the last point is joined to the first
    int label;   // the caller's own number; it is carried along
    int stage;   // when it comes: a raster of an earlier stage is drawn for it, too, but has it not yet
    int point_count;
    double (*point)[3]; // [point_count] m
    int* vertex;        // [point_count] mesh vertex that the point is, -1 = none
} ruga_curve;

typedef struct ruga_curves {
    int count, capacity;
    ruga_curve* curve;
} ruga_curves;

void ruga_curves_clear(ruga_curves* curves);

// The functions below append; `style` gives kind, freedom, varies, closed, label and stage, its points are not
// looked at.

// A polyline in space. RUGA_BAD_INPUT where it has fewer than two points (closed: three), or one that is not
// finite.
ruga_status ruga_curves_add_polyline(ruga_curves* curves, const ruga_curve* style, int count,
                                     const double (*point)[3]);
// A path along mesh edges. RUGA_BAD_INPUT with the pair of vertices that no edge joins.
ruga_status ruga_curves_add_path(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh,
                                 const ruga_connectivity* edges, int count, const int* vertex);
// The border of a group of faces, boundary edges of the mesh left out, as paths that end where more than two
// of its edges meet, and as closed ones. RUGA_BAD_INPUT where the group does not exist or has no border.
ruga_status ruga_curves_add_border(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh,
                                   const ruga_connectivity* edges, const char* group);
// Any set of mesh edges (marked [E]), chained in the same way.
ruga_status ruga_curves_add_edges(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh,
                                  const ruga_connectivity* edges, const bool* marked);
// A polyline in texture coordinates. RUGA_BAD_INPUT where the mesh has none, or with the point that lies in
// no face's image.
ruga_status ruga_curves_add_uv(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh, int count,
                               const double (*uv)[2]);

// The edge that joins two vertices, -1 = none.
int ruga_edge_between(const ruga_connectivity* edges, int a, int b);

#endif
