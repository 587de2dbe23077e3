// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Static equilibria of a free shell with creases by the plainest means: membrane and hinges of all copies, the sewing as
// exact rows, Newton's method. Written apart from the skin's solve, against which tests hold it.
#ifndef RUGA_TESTS_CREASED_H
#define RUGA_TESTS_CREASED_H

#include "crease/hinge.h"
#include "crease/sewing.h"
#include "ruga/types.h"

typedef struct ruga_creased_def {
    const ruga_raster* raster; // these two must outlive the shell
    const ruga_cut* cut;
    ruga_skin_def skin;      // thickness, young, poisson, density, membrane
    const double* stiffness; // [segments] N, of the creases; entries of auxiliary chords are not looked at
    const bool* fixed;       // [nodes] held where they are, or NULL. Of a clamped line hold all copies
    double gravity[3];       // m/s^2
    double tolerance;        // residual over the forces of all elements
    int iterations;          // at most
} ruga_creased_def;

typedef struct ruga_creased_report {
    ruga_outcome outcome;
    int iterations, factorizations;
    double residual;                           // relative
    double gap;                                // m
    double membrane, bending, hinge, external; // J; bending with that of auxiliary chords
} ruga_creased_report;

typedef struct ruga_creased ruga_creased;

ruga_creased_def ruga_default_creased_def(void);
ruga_status ruga_creased_create(const ruga_creased_def* def, ruga_creased** creased);
void ruga_creased_destroy(ruga_creased** creased);

// From x [nodes][3], which is changed, to an equilibrium with the creases' rest angles rest [segments], rad.
// Angles are followed from those of the last solve (the first: from x) through 180 degrees. Not converged is
// data.
ruga_status ruga_creased_solve(ruga_creased* creased, const double* rest, double* x,
                               ruga_creased_report* report);
// The same along the path of a body that a drag holds back so much that it has no momentum: implicit steps,
// longer and longer. Of many equilibria meshes that differ find the same one so, while a static solve leaps.
ruga_status ruga_creased_settle(ruga_creased* creased, const double* rest, double* x,
                                ruga_creased_report* report);
// Angle of each segment as it was followed, rad; borrowed.
const double* ruga_creased_angles(const ruga_creased* creased);

#endif
