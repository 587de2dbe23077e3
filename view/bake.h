// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Textures that carry what a fine surface has beyond a base mesh.
#ifndef RUGA_VIEW_BAKE_H
#define RUGA_VIEW_BAKE_H

#include "view/atlas.h"

typedef enum ruga_bake_map {
    RUGA_BAKE_DISPLACEMENT, // m along tangent, bitangent and normal of the base: fine point - base point
    RUGA_BAKE_NORMAL,       // unit normal of the fine surface in the base's frame
    RUGA_BAKE_TENSION,      // value of the fine surface's vertices, see ruga_bake_tension
    RUGA_BAKE_AO, // part of the sky that the fine surface sees, weighted by the cosine; in all channels
} ruga_bake_map;

typedef struct ruga_bake_def {
    ruga_bake_map map;
    const ruga_atlas* atlas; // of the base mesh
    const double* base;      // [V][3] m
    const ruga_mesh* fine;   // the base mesh itself: points belong together; another: found by rays
    const double* detail;    // [fine V][3] m
    const double* value;     // [fine V][3] for tension, otherwise NULL
    double distance;         // m: how far along the base's normal the fine surface is looked for
    double sky;              // m: occluders farther away do not count; may be INFINITY
    int samples;             // rays of a texel for ambient occlusion
    int margin;              // texels of dilation
} ruga_bake_def;

typedef struct ruga_bake_report {
    int texels, missed; // that show the base mesh, and those of them that met nothing of the fine one
    double largest;     // of the components' sizes
    double squares,
        tangential; // of displacements: sum of squares, and that of the part across the base's normal, m^2
} ruga_bake_report;

// pixel [height][width][3]; texels farther than the margin from any chart are 0 (normals: straight up, AO:
// 1). RUGA_BAD_INPUT where rays meet nothing at all.
ruga_status ruga_bake(const ruga_bake_def* def, float* pixel, ruga_bake_report* report);

// At each vertex the mean over its triangles, by area, of (largest principal stretch - 1, smallest principal
// stretch - 1, area / area at rest - 1); value [V][3].
ruga_status ruga_bake_tension(const ruga_mesh* mesh, const double* rest, const double* position,
                              double* value);

#endif
