// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What stretching a triangle does to its bending stiffness, by way of its thickness.
#ifndef RUGA_SHELL_THICKNESS_H
#define RUGA_SHELL_THICKNESS_H

#include "shell/membrane.h"

// p of thickness.c.
double ruga_thickness_power(double poisson);

// Sets the s of triangles side by side, and the slope z; rest_area [count] is that after growth.
void ruga_thickness_lanes_stiffness(int count, double power, const double* rest_area,
                                    const ruga_triangle_lanes* triangles, double (*thickness)[2]);

// Adds scale[i] / z times the gradient of s to the triangles' gradients.
void ruga_thickness_lanes_add(int count, const double* scale, ruga_triangle_lanes* triangles);

// Adds scale[i] / z times the Hessian of s to the triangles' blocks.
void ruga_thickness_lanes_add_hessian(int count, double power, const double* scale,
                                      ruga_triangle_lanes* triangles);

#endif
