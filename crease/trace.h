// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A straight piece of a curve across the mesh: the edges and vertices that it meets on its way.
#ifndef RUGA_CREASE_TRACE_H
#define RUGA_CREASE_TRACE_H

#include "crease/curve.h"
#include "crease/sheet.h"

// A point of a curve: a vertex, a point of a face, or a point beyond the boundary.
typedef struct ruga_place {
    int vertex; // -1 = none
    int face;   // of a point that is no vertex; beyond the boundary: the nearest face
    bool beyond;
    double x[3]; // m
} ruga_place;

// Where a curve meets the mesh: a vertex, or an edge at `place` of the way from its first to its second
// vertex.
typedef struct ruga_hit {
    int vertex;   // -1 = on an edge
    int edge;     // -1 = at a vertex
    double place; // in (0, 1)
    int face;    // that the curve comes through from the hit before; -1 = along a mesh edge, or no hit before
    int stretch; // index of the straight piece, set by the caller
    double side[2]; // m, signed distances of the edge's vertices from the line
} ruga_hit;

typedef struct ruga_hits {
    int count, capacity;
    ruga_hit* hit;
} ruga_hits;

typedef enum ruga_arrival {
    RUGA_ARRIVED,
    RUGA_LEFT, // the last hit is on the boundary, short of the end
    RUGA_LOST  // the line does not lead over the surface from one to the other
} ruga_arrival;

// Appends the hits behind `from`, up to and with `to` where that is a vertex. `to->face` is renewed where the
// line ends beside it. Fails only for lack of memory; hits of a piece that is LOST mean nothing.
ruga_status ruga_trace(const ruga_sheet* sheet, const ruga_place* from, ruga_place* to, int stretch,
                       ruga_hits* hits, ruga_arrival* arrival);

// The unit vector whose product with x - from.x is a point's signed distance from the line: the line's
// direction times the mean normal at both ends. False where there is none.
bool ruga_trace_plane(const ruga_sheet* sheet, const ruga_place* from, const ruga_place* to, double plane[3]);

#endif
