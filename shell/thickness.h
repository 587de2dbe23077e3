// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What stretching a triangle does to its bending stiffness, by way of its thickness.
#ifndef RUGA_SHELL_THICKNESS_H
#define RUGA_SHELL_THICKNESS_H

#include "shell/membrane.h"

// p of thickness.c.
double ruga_thickness_power(double poisson);

// Returns s, and sets its gradient for the three corners. rest_area is that after growth.
double ruga_thickness_stiffness(double power, double rest_area, const double* const x[3],
                                double gradient[3][3]);

// Adds `scale` times the Hessian of s to the lower blocks of a triangle's 9 x 9 matrix.
void ruga_thickness_add_hessian(double power, double rest_area, const double* const x[3], double scale,
                                double block[RUGA_TRIANGLE_BLOCKS][9]);

#endif
