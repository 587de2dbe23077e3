// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a static solve counts while it works.
#ifndef RUGA_SOLVER_WORK_H
#define RUGA_SOLVER_WORK_H

// Added up over a step.
typedef struct ruga_skin_work {
    int iterations, linear_iterations, factorizations, energies;
    int certificates, failures; // factorisations of a certificate; of any whose inertia was wrong
    double seconds_assembly, seconds_factor, seconds_solve, seconds_energy;
} ruga_skin_work;

// One residual, and what had been spent when it was taken.
typedef struct ruga_skin_trace {
    double clock, residual, energy;
    int factorizations, energies;
} ruga_skin_trace;

#endif
