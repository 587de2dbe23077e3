// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a shell is made of, triangle by triangle.
#ifndef RUGA_SHELL_MATERIAL_H
#define RUGA_SHELL_MATERIAL_H

#include "core/status.h"
#include "ruga/types.h"

// A hinge between two triangles of a cut mesh: start and end of the edge, the corner opposite it in triangle[0],
// which runs start -> end, and that in triangle[1]; fraction: of the edge's length, over which they are one material.
typedef struct ruga_shell_bend {
    int triangle[2];
    int vertex[4];
    double fraction;
} ruga_shell_bend;

// A mesh that was cut (crease/cut.h): triangles overlap, and count with the part that is material.
typedef struct ruga_shell_cut {
    const double* stiffness;     // [F] part of the area, for the membrane
    const double (*mass)[3];     // [F] parts of the triangle's mass that its corners get
    int bend_count;              // all hinges there are
    const ruga_shell_bend* bend; // [bend_count]
    int pair_count;              // further pairs of vertices that the pattern of the Hessian is to have
    const int (*pair)[2];
} ruga_shell_cut;

// Material of each triangle: arrays [F], or NULL to use the skin's single value. The arrays over vertices of
// the skin's def are not looked at: ruga_mesh_triangle_averages makes triangles' values of them.
typedef struct ruga_shell_material {
    ruga_skin_def skin;
    const double* thickness; // [F] m, or NULL
    const double* young;     // [F] Pa, or NULL
    const double* growth;    // [F][2], or NULL
    const bool* held; // [F] or NULL: triangles whose corners are all held. The directors on their border are
                      // theirs, so that they clamp what is beside them. Hinges do not ask
    const ruga_shell_cut* cut; // NULL = whole triangles, and a hinge at each interior edge
} ruga_shell_material;

// RUGA_BAD_INPUT names the single value that is out of range.
ruga_status ruga_shell_material_check(const ruga_shell_material* material);

double ruga_shell_material_thickness(const ruga_shell_material* material, int f);     // m
double ruga_shell_material_young(const ruga_shell_material* material, int f);         // Pa
const double* ruga_shell_material_growth(const ruga_shell_material* material, int f); // [2]
double ruga_shell_material_bending(const ruga_shell_material* material, int f); // E h^3 / (12 (1 - nu^2)), J

#endif
