// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Membrane energy of one triangle with its derivatives.
#ifndef RUGA_SHELL_MEMBRANE_H
#define RUGA_SHELL_MEMBRANE_H

#include "core/lanes.h"
#include "core/status.h"
#include "ruga/types.h"

// The lower blocks of a triangle's 9 x 9 matrix, row corner and column corner of each.
enum { RUGA_TRIANGLE_BLOCKS = 6 };
extern const int ruga_triangle_block_corner[RUGA_TRIANGLE_BLOCKS][2];

typedef struct ruga_membrane_rest {
    double slope[2][2]; // of the shape functions of corners 1 and 2 along u and v, 1/m; corner 0: minus their
                        // sum
    double stretch;     // A E h / (1 - nu^2), J
    double shear;       // A E h / (2 (1 + nu)), J
} ruga_membrane_rest;

// Rest data of the triangle with corners `x`. Returns its area A after growth, 0 where it has none (`rest` is
// then not set).
double ruga_membrane_rest_create(const double* const x[3], double poisson, const double growth[2],
                                 double thickness, double young, ruga_membrane_rest* rest);

// Length of the rest vector `edge`, in the plane of the triangle with corners `x`, after growth.
double ruga_membrane_grown_length(const double* const x[3], const double edge[3], const double growth[2]);

// Returns the energy, J, and sets its gradient for the three corners.
double ruga_membrane_energy(ruga_membrane kind, double poisson, const ruga_membrane_rest* rest,
                            const double* const x[3], double gradient[3][3]);

// Triangles side by side.
typedef struct ruga_triangle_lanes {
    double x[3][3][RUGA_LANES];
    double gradient[3][3][RUGA_LANES];
    double block[3][9][RUGA_LANES]; // of the Hessian, row by row: corners (1, 1), (2, 1) and (2, 2)
} ruga_triangle_lanes;

void ruga_triangle_lanes_set(ruga_triangle_lanes* one, const double* const x[3]);

// The same for `count` of them, rest [count]; energy [count] is set.
void ruga_membrane_lanes_energy(ruga_membrane kind, double poisson, int count, const ruga_membrane_rest* rest,
                                ruga_triangle_lanes* triangles, double* energy);

// Sets the blocks; clamp as in ruga_shell_energy.
void ruga_membrane_lanes_hessian(ruga_membrane kind, double poisson, int count,
                                 const ruga_membrane_rest* rest, double clamp,
                                 ruga_triangle_lanes* triangles);

// The lower blocks, those of corner 0 from the others: no energy changes where all corners move alike.
void ruga_triangle_lanes_blocks(int count, const ruga_triangle_lanes* triangles,
                                double (*block)[RUGA_TRIANGLE_BLOCKS][9]);

// Sets the lower blocks of one triangle.
void ruga_membrane_hessian(ruga_membrane kind, double poisson, const ruga_membrane_rest* rest,
                           const double* const x[3], double clamp, double block[RUGA_TRIANGLE_BLOCKS][9]);

// The material's stiffness against the rates of strain when the corners move with v, as forces: with a time
// in front it is what damps. Rigid motion gives none.
void ruga_membrane_damp(ruga_membrane kind, double poisson, const ruga_membrane_rest* rest,
                        const double* const x[3], const double* const v[3], double force[3][3]);

#endif
