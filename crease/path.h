// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A crease curve on the mesh: stations that it goes through, and what it meets between them. A curve that
// leaves the mesh and comes back is several paths.
#ifndef RUGA_CREASE_PATH_H
#define RUGA_CREASE_PATH_H

#include "crease/curve.h"
#include "crease/trace.h"

typedef struct ruga_station {
    ruga_place place;
    bool wanted; // is to become a vertex of the mesh
} ruga_station;

typedef struct ruga_path {
    int curve;
    bool closed; // the last station is the first one again
    int count, capacity;
    ruga_station* station;
    ruga_hits hits; // of the last tracing
} ruga_path;

typedef struct ruga_paths {
    int count, capacity;
    ruga_path* path;
} ruga_paths;

void ruga_paths_clear(ruga_paths* paths);

// Brings the curves from one stage to another to the sheet, behind the paths that are there: points are projected to the nearest place of the surface, what hangs over
// the boundary is marked as beyond it. Where `snap`, ends, corners and the vertices of mesh paths are wanted.
// Vertices that curves name are pinned. RUGA_BAD_INPUT names a curve that lies beside the mesh.
ruga_status ruga_paths_add(ruga_sheet* sheet, const ruga_curves* curves, const int stages[2], bool snap,
                           double corner, ruga_paths* paths);
// Finds all hits and removes those that are no crossings: an edge met twice in a row (a corner that pokes
// into a triangle), an edge met beside its own vertex. A piece that leaves the mesh splits its path.
// RUGA_BAD_INPUT names the curve and the place where no way leads over the surface.
ruga_status ruga_paths_trace(const ruga_sheet* sheet, ruga_paths* paths);
// Inserts a vertex of the mesh as a station behind station `stretch`, in the order along that straight piece
// (or chain of pieces up to `last`).
ruga_status ruga_path_insert(const ruga_sheet* sheet, ruga_path* path, int stretch, int last, int vertex);
// After the sheet has changed: positions of vertices, faces of other places; repeated stations are dropped.
void ruga_paths_renew(const ruga_sheet* sheet, ruga_paths* paths);

// Position of a hit, m.
void ruga_hit_position(const ruga_sheet* sheet, const ruga_hit* hit, double x[3]);

#endif
