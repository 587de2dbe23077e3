// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A picture of a surface: ray traced with Embree, key light, sky light with ambient occlusion, smooth normals.
#ifndef RUGA_VIEW_RENDER_H
#define RUGA_VIEW_RENDER_H

#include "mesh/mesh.h"

typedef struct ruga_render_def {
    int width, height; // pixels
    int samples;       // per pixel and axis for antialiasing, >= 1
    double azimuth, elevation; // rad: direction from the scene to the camera; up axis z
    double up[3];              // default (0, 0, 1)
    double fit;                // the object fills this part of the picture, default 0.9
    bool wireframe;
    const double* scalar;     // [V] coloured by a perceptually uniform map between min and max; NULL = clay
    double scalar_min, scalar_max;
} ruga_render_def;

ruga_render_def ruga_default_render_def(void);

// Renders positions [V][3] of the mesh to 8-bit RGB pixels [height][width][3] of the caller.
ruga_status ruga_render(const ruga_mesh* mesh, const double* position, const ruga_render_def* def,
                        unsigned char* pixels);
// Same, to a PNG file (through a temporary file).
ruga_status ruga_render_png(const ruga_mesh* mesh, const double* position, const ruga_render_def* def,
                            const char* path);

#endif
