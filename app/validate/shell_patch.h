// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Meshes of four-sided pieces of surfaces for the benchmarks of the shell: rows of vertices across, from v =
// 0 to v = 1, every other row moved by half a cell, so that a piece whose cells fit is made of equilateral
// triangles.
#ifndef RUGA_APP_VALIDATE_SHELL_PATCH_H
#define RUGA_APP_VALIDATE_SHELL_PATCH_H

#include "mesh/mesh.h"

typedef struct shell_patch_def {
    int across, along; // cells
    bool irregular; // every vertex moved by up to 0.3 cells; rims along themselves; the points with 4 u and 2
                    // v whole stay
    bool closed;   // u = 1 is u = 0
    bool clamp[2]; // a row of 1e-2 cells beyond v = 0, v = 1, to hold with the row before: it has next to no
                   // area that could bend, so that the rim turns by nothing
    void (*map)(double u, double v, double x[3]);
} shell_patch_def;

typedef struct shell_patch {
    ruga_mesh mesh;
    int row_count;
    int* row; // [row_count + 1] first vertex
} shell_patch;

ruga_status shell_patch_create(const shell_patch_def* def, shell_patch* patch);
void shell_patch_clear(shell_patch* patch);

#endif
