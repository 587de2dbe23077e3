// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Static equilibria of the dense volumetric reference (lattice/volume.h): minima of its elastic energy with
// some components of some nodes held, certified by the inertia.
#ifndef RUGA_SOLVER_VOLUME_H
#define RUGA_SOLVER_VOLUME_H

#include "lattice/volume.h"
#include "ruga/types.h"

typedef struct ruga_volume_solver ruga_volume_solver;

// held [N][3]: components that keep the value they have in u. The volume must outlive the solver.
ruga_status ruga_volume_solver_create(const ruga_volume* volume, const bool* held, int64_t seed,
                                      ruga_volume_solver** solver);
void ruga_volume_solver_destroy(ruga_volume_solver** solver);

typedef struct ruga_volume_report {
    ruga_outcome outcome;
    int iterations, factorizations, escapes; // escapes: steps of negative curvature
    double residual;                         // |gradient over free components| / f_ref, as in skin.h
    double energy;                           // J
} ruga_volume_report;

// Newton from u, which is SET to what it reached. A saddle is left along a direction of negative curvature.
ruga_status ruga_volume_solve(ruga_volume_solver* solver, double tolerance, double* u,
                              ruga_volume_report* report);

// Whether the Hessian over the free components is positive definite at u; residual as in the report, or NULL.
ruga_status ruga_volume_is_stable(ruga_volume_solver* solver, const double* u, bool* stable,
                                  double* residual);

#endif
