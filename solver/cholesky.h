// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Supernodal Cholesky by CHOLMOD, with our order. linear.h is the interface for others.
#ifndef RUGA_SOLVER_CHOLESKY_H
#define RUGA_SOLVER_CHOLESKY_H

#include "solver/linear.h"

typedef struct ruga_cholesky ruga_cholesky;

// `lower` stays the caller's and must outlive the factor. The values given later must be finite.
ruga_status ruga_cholesky_create(const ruga_sparse* lower, int node_count, const int* node_start,
                                 const bool* last, ruga_cholesky** cholesky);
void ruga_cholesky_destroy(ruga_cholesky** cholesky);
ruga_status ruga_cholesky_numeric(ruga_cholesky* cholesky, const double* values, ruga_factor_info* info);
ruga_status ruga_cholesky_solve(ruga_cholesky* cholesky, const double* b, double* x);
size_t ruga_cholesky_bytes(const ruga_cholesky* cholesky);

#endif
