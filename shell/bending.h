// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The angle of a hinge, and its derivatives.
#ifndef RUGA_SHELL_BENDING_H
#define RUGA_SHELL_BENDING_H

#include "core/vec3.h"
#include "shell/membrane.h"

// Hinges side by side.
typedef struct ruga_hinge_lanes {
    double x[4][3][RUGA_LANES]; // as in ruga_hinge_angle
    double angle[RUGA_LANES];
    double gradient[4][3][RUGA_LANES];
} ruga_hinge_lanes;

// Sets angle and gradient of the first `count`.
void ruga_hinge_lanes_measure(int count, ruga_hinge_lanes* hinges);

// Adds to the triangles' gradients the parts that they have in those of their edges' angles, times moment[i]
// for the edge from corner i to corner i + 1.
void ruga_hinge_lanes_add(int count, double (*const moment)[RUGA_LANES], ruga_triangle_lanes* triangles);

// Adds to the triangles' blocks the parts that they have in the Hessians of their edges' angles, times the
// moments.
void ruga_hinge_lanes_add_hessian(int count, double (*const moment)[RUGA_LANES],
                                  ruga_triangle_lanes* triangles);

// Angle in (-pi, pi] between the two triangles of an interior edge, 0 when flat, positive where both turn
// towards the side that their normals point to. x: start and end of the edge, the corner opposite it in the
// triangle that runs start -> end, the corner opposite it in the other. `gradient` for these may be NULL.
double ruga_hinge_angle(const double* const x[4], double gradient[4][3]);

// a - b, brought to (-pi, pi].
static inline double ruga_angle_difference(double a, double b) {
    double difference = a - b, turn = difference > RUGA_PI    ? -2 * RUGA_PI
                                      : difference > -RUGA_PI ? 0
                                                              : 2 * RUGA_PI;
    return difference + turn;
}

// Sets the lower blocks of the same sum for one triangle.
void ruga_hinge_hessian(const double* const x[3], const double moment[3],
                        double block[RUGA_TRIANGLE_BLOCKS][9]);

#endif
