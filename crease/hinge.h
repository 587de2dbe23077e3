// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Hinges of creases: 1/2 k l (theta - theta0)^2 on each segment, l its rest length, k in N m/rad per m = N,
// theta its signed dihedral angle: 0 when flat, positive for a valley.
#ifndef RUGA_CREASE_HINGE_H
#define RUGA_CREASE_HINGE_H

#include "crease/cut.h"

enum { RUGA_HINGE_NODES = 6, RUGA_HINGE_UNKNOWNS = 3 * RUGA_HINGE_NODES };

// Both elements beside a segment: three nodes on the left, three on the right (which may share some). Its two
// ends, and a point on the left and one on the right, are weighted sums of them.
typedef struct ruga_hinge {
    int node[RUGA_HINGE_NODES];
    double weight[4][RUGA_HINGE_NODES]; // [end 0, end 1, left, right]
    double length;                      // m
    int curve;                          // -1 = auxiliary chord
} ruga_hinge;

// One hinge for each of the cut's segments, in their order; hinge [segments].
void ruga_hinges_make(const ruga_raster* raster, const ruga_cut* cut, ruga_hinge* hinge);

// Angle at x [nodes][3]: in (-pi, pi], or, where `near` is not NULL, the one of the same place within pi of
// *near, so that a crease may be followed through 180 degrees. Its gradient for the six nodes may be NULL.
double ruga_hinge_measure(const ruga_hinge* hinge, const double* x, const double* near,
                          double gradient[RUGA_HINGE_NODES][3]);

// Energy, J. gradient [6][3] and hessian [18][18] (row by row) are SET where not NULL. clamp in [0, 1]:
// 0 = the exact Hessian, 1 = Gauss-Newton, which is positive semi-definite.
double ruga_hinge_energy(const ruga_hinge* hinge, double stiffness, double rest, const double* x,
                         const double* near, double clamp, double gradient[RUGA_HINGE_NODES][3],
                         double hessian[RUGA_HINGE_UNKNOWNS][RUGA_HINGE_UNKNOWNS]);

#endif
