// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// One dense front, in either precision: ldl_front.c and ldl_assembly.c are compiled for `real` = double, and
// by ldl_single.c for `real` = float.
#ifndef RUGA_SOLVER_LDL_FRONT_H
#define RUGA_SOLVER_LDL_FRONT_H

#include "solver/ldl.h"

#include <stdint.h>

#ifdef RUGA_LDL_SINGLE
typedef float real;
typedef int32_t bits;
#define RUGA_BLAS(name)       cblas_s##name
#define ruga_front_factor     ruga_front_factor_single
#define ruga_front_update     ruga_front_update_single
#define ruga_ldl_factor_front ruga_ldl_factor_front_single
#else
typedef double real;
typedef int64_t bits;
#define RUGA_BLAS(name) cblas_d##name
#endif

// Columns [0, full) are fully summed, of which the first `eliminated` become pivots.
typedef struct ruga_front {
    int rows, full;
    real* a;          // [full][rows] columns; the lower triangle counts
    int* index;       // [rows] step of each row, permuted along with them
    real* pivot;      // [full][2] D: (d, 0), or (d11, d21), (d22, 0)
    real* peak;       // [full] the largest size that the diagonal entry ever had: the measure of round-off
    real* work;       // [ruga_front_work(shared, full, rows - full)]
    bool shared;      // at the top: tiles are shared out to threads
    bool must_finish; // a root: no parent takes pivots that are not stable
    int eliminated, positive, negative, zero;
} ruga_front;

// Eliminates as many of the fully summed columns as stable pivots are found for.
void ruga_front_factor(ruga_front* front);

// update = -L2 D L2^T on the tile of columns [begin, end), with `work` as in the front.
void ruga_front_update(const ruga_front* front, int begin, int end, real* work, real* update);

// Assembles supernode s, eliminates, hands on what is left and stores L.
ruga_status ruga_ldl_factor_front(ruga_ldl* ldl, int s, front_stack* stack);
#ifndef RUGA_LDL_SINGLE
ruga_status ruga_ldl_factor_front_single(ruga_ldl* ldl, int s, front_stack* stack);
#endif

#endif
