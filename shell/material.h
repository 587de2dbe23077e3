// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a shell is made of, triangle by triangle.
#ifndef RUGA_SHELL_MATERIAL_H
#define RUGA_SHELL_MATERIAL_H

#include "core/status.h"
#include "ruga/types.h"

// Material of each triangle: arrays [F], or NULL to use the skin's single value. The arrays over vertices of
// the skin's def are not looked at: ruga_mesh_triangle_averages makes triangles' values of them.
typedef struct ruga_shell_material {
    ruga_skin_def skin;
    const double* thickness; // [F] m, or NULL
    const double* young;     // [F] Pa, or NULL
    const double* growth;    // [F][2], or NULL
    const bool* held; // [F] or NULL: triangles whose corners are all held. The directors on their border are
                      // theirs, so that they clamp what is beside them. Hinges do not ask
} ruga_shell_material;

// RUGA_BAD_INPUT names the single value that is out of range.
ruga_status ruga_shell_material_check(const ruga_shell_material* material);

double ruga_shell_material_thickness(const ruga_shell_material* material, int f);     // m
double ruga_shell_material_young(const ruga_shell_material* material, int f);         // Pa
const double* ruga_shell_material_growth(const ruga_shell_material* material, int f); // [2]
double ruga_shell_material_bending(const ruga_shell_material* material, int f); // E h^3 / (12 (1 - nu^2)), J

#endif
