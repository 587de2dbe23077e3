// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Shapes centred at the origin, in metres: outer size exact, edge nearest fitting.
#ifndef RUGA_MESH_MAKE_H
#define RUGA_MESH_MAKE_H

#include "mesh/mesh.h"

typedef enum ruga_shape {
    RUGA_SHAPE_SHEET,  // size X, Y, in z = 0 with normals +z
    RUGA_SHAPE_SLAB,   // X, Y, Z closed box
    RUGA_SHAPE_BAR,    // X, Y, Z closed box
    RUGA_SHAPE_PILLOW, // X, Y, Z closed; missing Y = X, Z = 0.3 X
    RUGA_SHAPE_SPHERE, // X = diameter
    RUGA_SHAPE_SKIRT,  // inner radius, outer radius, angle (rad): annulus sector in z = 0, normals +z
    RUGA_SHAPE_COUNT
} ruga_shape;

typedef enum ruga_pattern {
    RUGA_PATTERN_EQUILATERAL,
    RUGA_PATTERN_DIAGONAL,
    RUGA_PATTERN_ALTERNATING
} ruga_pattern;

typedef struct ruga_make_def {
    ruga_shape shape;
    double size[3]; // 0 = missing
    double edge;    // m; 0 = by cells
    int cells[2];   // quads along X and Y (or around and across); 0 = by edge
    ruga_pattern pattern;
} ruga_make_def;

// Names: "sheet", "slab", ...; -1 where there is none.
int ruga_shape_from_name(const char* name);
const char* ruga_shape_name(ruga_shape shape);

ruga_status ruga_mesh_make(const ruga_make_def* def, ruga_mesh* mesh);

#endif
