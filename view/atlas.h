// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Which texel of a picture shows which place of a mesh, by its texture coordinates.
#ifndef RUGA_VIEW_ATLAS_H
#define RUGA_VIEW_ATLAS_H

#include "mesh/mesh.h"

typedef struct ruga_atlas {
    int width, height;
    const ruga_mesh* mesh; // the caller's
    int* triangle;         // [height][width] from the top row down; -1 = none
    int covered;           // texels whose centre lies in a triangle
    int flat;              // triangles without an area in the picture
} ruga_atlas;

// A texel belongs to the triangle that its centre lies in; one whose centre lies in none, but within two
// texels of one, to the nearest, whose maps are continued linearly there: so a bilinear look-up anywhere on a
// chart, its border included, is one in a smooth picture. RUGA_BAD_INPUT with the place where uvs are
// missing, outside 0 to 1, or overlap. `what` names the mesh in sentences.
ruga_status ruga_atlas_create(const char* what, const ruga_mesh* mesh, int width, int height,
                              ruga_atlas* atlas);
void ruga_atlas_clear(ruga_atlas* atlas);

// Weights (sum 1) of the corners of the texel's triangle at its centre; beyond the triangle some are
// negative.
void ruga_atlas_weights(const ruga_atlas* atlas, int row, int column, double weight[3]);

// Dilation: texels that are not `filled` [height][width] take over pixel [height][width][channels] of the
// nearest filled neighbours, ring by ring, `margin` times.
ruga_status ruga_atlas_fill(const ruga_atlas* atlas, int margin, int channels, bool* filled, float* pixel);

#endif
