// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Pairs of triangles that cross, decided exactly, on any triangle soup.
#ifndef RUGA_MESH_CROSSING_H
#define RUGA_MESH_CROSSING_H

#include "mesh/mesh.h"

typedef struct ruga_crossings {
    int count;
    int capacity;
    int (*pair)[2]; // faces, pair[i][0] < pair[i][1], ascending
} ruga_crossings;

// Two triangles cross where their intersection has a length and neither lies on one side of the other's
// plane, or where they are coplanar and share an area. Touching, along an edge or at a point, is no crossing,
// and neither is what neighbours share.
// corner[i] = the triangle's corners.
bool ruga_triangles_cross(const double* const a[3], const double* const b[3]);

// All pairs among the faces whose skip[face] is false (NULL = all faces). Positions of faces that are not
// skipped must be finite.
ruga_status ruga_mesh_crossings(const ruga_mesh* mesh, const bool* skip, ruga_crossings* crossings);
// Frees the array (not the struct) and zeroes it.
void ruga_crossings_clear(ruga_crossings* crossings);

#endif
