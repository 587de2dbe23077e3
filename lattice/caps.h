// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The material's cross-section on the faces of the sub-cells: winding numbers along the lines where planes
// meet, and on every face that the surface crosses the connected regions of material ("caps") with their
// areas.
#ifndef RUGA_LATTICE_CAPS_H
#define RUGA_LATTICE_CAPS_H

#include "lattice/slice.h"
#include "lattice/vdb_shim.h"

// A face that the surface crosses. Its coordinates are those of the axes axis + 1 and axis + 2 (cyclic), its
// border segments 0: second coordinate low, 1: first high, 2: second high, 3: first low.
typedef struct ruga_cap_face {
    int axis;
    int index[3];     // along `axis` the plane, else the sub-cell
    int begin, end;   // its edges in ruga_caps.face_edge
    int region_first; // its regions are region_first .. region_first + region_count - 1
    int region_count;
    int segment_region[4]; // region along a border segment that lies in it as a whole, -1 = none
} ruga_cap_face;

typedef struct ruga_caps {
    const ruga_slices* slices;
    int planes[3];
    int line_base[3];
    int* line_start;         // CSR of crossings by line
    ruga_crossing* crossing; // sorted by line and along it
    ruga_vdb* map[3];        // by axis: index of a face -> its number
    int face_count, face_capacity;
    ruga_cap_face* face;
    int* face_edge;
    int* edge_region; // [slices->edge_count], for edges on a plane
    int region_count;
    int region_capacity;
    double* region_area; // weighted with the winding number
} ruga_caps;

// Where a ray ends that starts on a face and runs along its first coordinate.
typedef struct ruga_cap_hit {
    int winding; // at the ray's start; 0 = outside the material
    int edge;    // the nearest edge, or -1: none before the face's border
    int point;   // then the end of the border's interval, or -1: the whole border segment 1
} ruga_cap_hit;

ruga_status ruga_caps_create(const ruga_slices* slices, const int sub_cells[3], ruga_caps* caps);
void ruga_caps_clear(ruga_caps* caps);

// Winding number at the corner where three planes meet.
int ruga_caps_corner(const ruga_caps* caps, const int planes[3]);

// Number of the face that bounds sub-cell `index` along `axis` on its side 0 (low) or 1; -1: not crossed.
int ruga_caps_face(const ruga_caps* caps, const int index[3], int axis, int side);

// Follows the ray from `at`. Edges of the face's list with label[i] == skip are not seen; label may be NULL.
ruga_cap_hit ruga_caps_locate(const ruga_caps* caps, const ruga_cap_face* face, const double at[2],
                              const int* label, int skip);

// The region that holds a point of a crossed face, -1 = outside the material.
int ruga_caps_region_at(const ruga_caps* caps, const ruga_cap_face* face, const double at[2], int* winding);

#endif
