// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The cotangent Laplacian L of the rest shape: x^T L x = sum over edges of w_e (x_i - x_j)^2 is twice the
// Dirichlet energy of the piecewise linear function x, with w_e = (cot alpha + cot beta) / 2 of the angles
// opposite the edge. A w_e may be negative (obtuse angles); L is positive semi-definite all the same.
#ifndef RUGA_CONSTRAINTS_LAPLACIAN_H
#define RUGA_CONSTRAINTS_LAPLACIAN_H

#include "mesh/connectivity.h"

// weight [E] is SET. RUGA_BAD_MESH with the face where a triangle has no area.
ruga_status ruga_laplacian_weights(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                   double* weight);
// The same of int b |grad x|^2, b >= 0 constant on each triangle: each cotangent times its triangle's b.
// Semi-definite like each triangle's own part, which a b for each edge would not be at obtuse angles.
// triangle_b [F]; NULL = 1.
ruga_status ruga_laplacian_weights_scaled(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                          const double* triangle_b, double* weight);

#endif
