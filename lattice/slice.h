// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The surface cut by the planes of the sub-cells: a triangulated surface of which every triangle lies in one
// sub-cell, and what it leaves on the planes and on the lines where two planes meet.
// Coordinates u are in cells from the lattice's corner. Each cell has 3 sub-cells per axis, as wide as the
// Gauss weights 5/18, 8/18, 5/18: sub-cell s of an axis lies between the planes s and s + 1.
#ifndef RUGA_LATTICE_SLICE_H
#define RUGA_LATTICE_SLICE_H

#include "mesh/connectivity.h"

#include <math.h>

typedef struct ruga_cut_edge {
    int point[2]; // on a plane: cap on the left, seen from the axis' positive end
    int index[3]; // sub-cell along each axis; along `axis` the plane
    int axis;     // normal of the plane that the edge was cut on, -1 = none
} ruga_cut_edge;

typedef struct ruga_cut_triangle {
    int point[3];
    int edge[3];  // edge[i] joins corners i and i + 1
    int index[3]; // sub-cell
} ruga_cut_triangle;

// The surface crosses a line where two planes meet.
typedef struct ruga_crossing {
    double u;    // along the line
    int axis;    // direction of the line
    int line[2]; // planes of the axes axis + 1, axis + 2 (cyclic)
    int slab;    // sub-cell along the line
    int sign;    // +1: into the material as u grows
    int point;
    int below; // winding number before it; filled in by the caps
} ruga_crossing;

typedef struct ruga_slices {
    int point_count, point_capacity;
    double (*point)[3]; // the mesh's vertices first
    int edge_count, edge_capacity;
    ruga_cut_edge* edge;
    int (*edge_triangle)[2]; // [0]: the triangle that runs along the edge, [1]: the one against it; on a
                             // plane [0] is the one on the plane's positive side
    int triangle_count, triangle_capacity;
    ruga_cut_triangle* triangle;
    int crossing_count, crossing_capacity;
    ruga_crossing* crossing;
} ruga_slices;

// Position of plane k.
static inline double ruga_slice_plane(int k) {
    static const double offset[3] = {0, 5.0 / 18, 13.0 / 18};
    return k / 3 + offset[k % 3];
}

// Sub-cell of coordinate u >= 0; what lies exactly on a plane belongs to the positive side.
static inline int ruga_slice_class(double u) {
    int first = 3 * (int)floor(u);
    return first + (u >= ruga_slice_plane(first + 1)) + (u >= ruga_slice_plane(first + 2));
}

// Cuts a closed mesh; u [V][3] are its vertices in lattice coordinates, all > 0.
ruga_status ruga_slices_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                               const double (*u)[3], ruga_slices* slices);
void ruga_slices_clear(ruga_slices* slices);

#endif
