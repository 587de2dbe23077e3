// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// MINRES of Trilinos Belos on our own vectors (no Tpetra, no MPI_Init).
#ifndef RUGA_SOLVER_BELOS_SHIM_H
#define RUGA_SOLVER_BELOS_SHIM_H

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

// y = A x, [n].
typedef ruga_status ruga_operator(const double* x, double* y, void* context);

typedef struct ruga_minres_report {
    int iterations;
    double residual; // |b - A x| / |b - A x0|, 2-norm
    bool converged;
} ruga_minres_report;

// Solves A x = b from the x given. `preconditioner` (symmetric positive definite) may be NULL. An unmet
// tolerance is not an error: see report.
ruga_status ruga_belos_minres(int n, ruga_operator* matrix, ruga_operator* preconditioner, void* context,
                              const double* b, double* x, double tolerance, int max_iterations,
                              ruga_minres_report* report);

#ifdef __cplusplus
}
#endif
#endif
