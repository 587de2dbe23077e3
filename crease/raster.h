// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Crease curves as chords of triangles: at most one embedded node on each mesh edge, no two chords that cross
// within a triangle, vertices of the mesh where curves cross, turn and end.
#ifndef RUGA_CREASE_RASTER_H
#define RUGA_CREASE_RASTER_H

#include "crease/curve.h"

typedef struct ruga_raster_def {
    bool snap; // mend the mesh until the curves fit: move vertices, split edges. Otherwise what does not fit
               // is refused, and ends inside a triangle are cut off as in the paper
    bool extend; // without snap: an end inside the mesh is led on to the opposite vertex; otherwise it locks
    double corner; // rad: a sharper turn of a curve gets a vertex
    double reach;  // edges: a vertex this near to a curve is moved onto it
    double merge;  // edges: what is nearer than this is taken for one place
    int rounds;    // of mending before giving up
    int stage;     // of the curves that are there. The mesh is mended for all, so that it is one for all stages
} ruga_raster_def;

ruga_raster_def ruga_default_raster_def(void);

// A straight cut through a triangle. Places on its border are numbered around it: 2 i = corner i, 2 i + 1 =
// the embedded node on the edge from corner i to corner i + 1.
typedef struct ruga_chord {
    int triangle;
    int end[2]; // in the direction of the curve
    int curve;  // -1 = auxiliary: one that comes later, in a triangle that has full freedom now
    double along[2]; // m, arc length of the curve at both ends
} ruga_chord;

typedef struct ruga_curve_facts {
    double length; // m, of what was brought to the mesh
    double placed; // m, of it that is a crease: not on the boundary
    double left;   // m, of it that lies on other curves, or on itself, and is left to these
    int hits;      // vertices and embedded nodes
    bool bent;     // off straight by more than a 1e-6th of an edge
    bool meets;    // touches or crosses another curve, or itself
    bool full;     // freedom as decided
} ruga_curve_facts;

typedef struct ruga_raster {
    ruga_mesh mesh; // that the chords belong to; the old one's vertices keep their numbers
    ruga_connectivity edges;
    double* node; // [E] place of the embedded node from edge[0] to edge[1], in (0, 1); 0 = none
    int chord_count;
    ruga_chord* chord;         // by triangle
    int* chord_start;          // [F + 1]
    int* crease;               // [E] the curve that runs along this mesh edge, -1 = none
    double (*crease_along)[2]; // [E] m, arc length at edge[0] and edge[1]
    int curve_count;
    ruga_curve* curve; // [curve_count] as given, without points
    ruga_curve_facts* facts;
    int moved, split_edges, split_faces, rounds; // what was done to the mesh
} ruga_raster;

// RUGA_BAD_INPUT names curve and place where a curve lies beside the mesh or cannot be brought to it.
ruga_status ruga_raster_create(const ruga_mesh* mesh, const ruga_curves* curves, const ruga_raster_def* def,
                               ruga_raster* raster);
void ruga_raster_clear(ruga_raster* raster);

#endif
