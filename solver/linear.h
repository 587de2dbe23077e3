// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Direct solution of sparse symmetric systems, with the inertia of the matrix: Cholesky (CHOLMOD, supernodal)
// for positive definite ones, and a multifrontal LDL^T for indefinite ones such as [K H^T; H 0]. The pattern
// is analysed once; numeric factors are made many times. BLAS runs on one thread: bits do not depend on
// threads.
#ifndef RUGA_SOLVER_LINEAR_H
#define RUGA_SOLVER_LINEAR_H

#include "core/sparse.h"

// LDL_SINGLE: L is stored in single precision, and solves are refined.
typedef enum ruga_factor_kind {
    RUGA_FACTOR_CHOLESKY,
    RUGA_FACTOR_LDL,
    RUGA_FACTOR_LDL_SINGLE
} ruga_factor_kind;

typedef struct ruga_factor ruga_factor;

typedef struct ruga_factor_info {
    bool success;                 // Cholesky: positive definite. LDL: no pivot had to be perturbed
    int positive, negative, zero; // inertia; for a failed Cholesky negative = 1 at least (unknown)
    int perturbed;  // LDL: = zero; pivots that are round-off (redundant rows): their unknowns are 0 in
                    // solutions
    double entries; // stored in the factor
    double flops;
} ruga_factor_info;

// Analyses the pattern of `lower` (values unused). The unknowns are grouped into `node_count` nodes,
// node i = unknowns [node_start[i], node_start[i + 1]), which are ordered together; NULL: each by itself.
// `last` [node_count] or NULL: nodes marked true are multipliers (no diagonal of their own): eliminated after
// at least half of their neighbours, and scaled by themselves.
ruga_status ruga_factor_create(ruga_factor_kind kind, const ruga_sparse* lower, int node_count,
                               const int* node_start, const bool* last, ruga_factor** factor);
void ruga_factor_destroy(ruga_factor** factor);

// Numeric factorisation of the matrix with `values` in the analysed pattern. A matrix that is not positive
// definite is not an error: see info. Values that are not finite are. Nothing is allocated from the second
// call on, unless more pivots must be delayed to parent fronts than ever before. Uses ruga_threads() threads.
ruga_status ruga_factor_numeric(ruga_factor* factor, const double* values, ruga_factor_info* info);

// LDL_SINGLE only: made in single precision throughout, in half of the time. The inertia is that of a matrix
// which is that near.
ruga_status ruga_factor_numeric_single(ruga_factor* factor, const double* values, ruga_factor_info* info);

// Whether the inertia of the factor is that of the matrix and not just of one nearby. Made in double: true, as far as
// double goes. Made in single: see ruga_ldl_prove_inertia; it costs two to four rough solves.
ruga_status ruga_factor_prove_inertia(ruga_factor* factor, bool* proven);

// x = A^-1 b; b and x [n], may be the same. Only after a numeric factorisation with success (LDL: always;
// where pivots are zero, b must be consistent). Refined where the residual is above 1e-12 |b| and round-off
// in x does not explain it (LDL), or until round-off does (LDL_SINGLE). One call at a time on the same
// factor: the work space is part of it.
ruga_status ruga_factor_solve(ruga_factor* factor, const double* b, double* x);

// LDL: x near A^-1 b, without refinement: with LDL_SINGLE to single precision, and as fast as the memory
// gives L. A symmetric operator with the inertia of the factor: an initial inverse or preconditioner.
// Cholesky: the same as ruga_factor_solve.
ruga_status ruga_factor_solve_rough(ruga_factor* factor, const double* b, double* x);

// LDL: x = (L |D| L^T)^-1 b, positive definite: the preconditioner for MINRES (Gill et al. 1992).
ruga_status ruga_factor_solve_absolute(ruga_factor* factor, const double* b, double* x);

// Bytes held by the factor.
size_t ruga_factor_bytes(const ruga_factor* factor);

#endif
