// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The two kinds of factor behind linear.h: CHOLMOD (cholesky.c) and our LDL^T (ldl.c).
#include "solver/cholesky.h"
#include "solver/ldl.h"

#include "core/memory.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

struct ruga_factor {
    ruga_factor_kind kind;
    ruga_sparse pattern; // a copy, without values
    ruga_cholesky* cholesky;
    ruga_ldl* ldl;
};

// OpenBLAS's own threads would change the bits with their number, and are not faster on fronts.
static void use_one_blas_thread(void) {
    if (openblas_get_num_threads() != 1) {
        openblas_set_num_threads(1);
    }
}

static ruga_status copy_pattern(const ruga_sparse* lower, ruga_sparse* copy) {
    int n = lower->columns;
    *copy = (ruga_sparse){.rows = n, .columns = n};
    RUGA_TRY(RUGA_NEW(copy->start, n + 1));
    RUGA_TRY(RUGA_NEW(copy->index, lower->start[n]));
    memcpy(copy->start, lower->start, (size_t)(n + 1) * sizeof(int));
    memcpy(copy->index, lower->index, (size_t)lower->start[n] * sizeof(int));
    return RUGA_OK;
}

static ruga_status check_finite(const ruga_sparse* pattern, const double* values) {
    for (int j = 0; j < pattern->columns; j++) {
        for (int p = pattern->start[j]; p < pattern->start[j + 1]; p++) {
            if (!isfinite(values[p])) {
                return ruga_fail(
                    RUGA_BAD_INPUT,
                    "entry (%d, %d) of the system matrix is %g: the state it was made at is not valid",
                    pattern->index[p], j, values[p]);
            }
        }
    }
    return RUGA_OK;
}

ruga_status ruga_factor_create(ruga_factor_kind kind, const ruga_sparse* lower, int node_count,
                               const int* node_start, const bool* last, ruga_factor** factor) {
    ruga_status status = RUGA_OK;
    ruga_factor* f = NULL;
    *factor = NULL;
    RUGA_ASSERT(lower->rows == lower->columns);
    use_one_blas_thread();
    RUGA_TRY(RUGA_NEW_ZERO(f, 1));
    f->kind = kind;
    RUGA_TRY_DONE(copy_pattern(lower, &f->pattern));
    if (lower->columns > 0 && kind == RUGA_FACTOR_CHOLESKY) {
        RUGA_TRY_DONE(ruga_cholesky_create(&f->pattern, node_count, node_start, last, &f->cholesky));
    } else if (lower->columns > 0) {
        RUGA_TRY_DONE(ruga_ldl_create(&f->pattern, node_count, node_start, last,
                                      kind == RUGA_FACTOR_LDL_SINGLE, &f->ldl));
    }
    *factor = f;
done:
    if (status != RUGA_OK) {
        ruga_factor_destroy(&f);
    }
    return status;
}

void ruga_factor_destroy(ruga_factor** factor) {
    if (*factor) {
        ruga_cholesky_destroy(&(*factor)->cholesky);
        ruga_ldl_destroy(&(*factor)->ldl);
        ruga_sparse_clear(&(*factor)->pattern);
        ruga_release(*factor);
        *factor = NULL;
    }
}

static ruga_status numeric(ruga_factor* factor, const double* values, bool in_single,
                           ruga_factor_info* info) {
    if (factor->pattern.columns == 0) {
        *info = (ruga_factor_info){.success = true};
        return RUGA_OK;
    }
    RUGA_TRY(check_finite(&factor->pattern, values));
    return factor->kind == RUGA_FACTOR_CHOLESKY ? ruga_cholesky_numeric(factor->cholesky, values, info)
                                                : ruga_ldl_numeric(factor->ldl, values, in_single, info);
}

ruga_status ruga_factor_numeric(ruga_factor* factor, const double* values, ruga_factor_info* info) {
    return numeric(factor, values, false, info);
}

ruga_status ruga_factor_numeric_single(ruga_factor* factor, const double* values, ruga_factor_info* info) {
    RUGA_ASSERT(factor->kind == RUGA_FACTOR_LDL_SINGLE);
    return numeric(factor, values, true, info);
}

ruga_status ruga_factor_prove_inertia(ruga_factor* factor, bool* proven) {
    *proven = true;
    return factor->ldl ? ruga_ldl_prove_inertia(factor->ldl, proven) : RUGA_OK;
}

ruga_status ruga_factor_solve(ruga_factor* factor, const double* b, double* x) {
    if (factor->pattern.columns == 0) {
        return RUGA_OK;
    }
    return factor->kind == RUGA_FACTOR_CHOLESKY ? ruga_cholesky_solve(factor->cholesky, b, x)
                                                : ruga_ldl_solve(factor->ldl, b, x);
}

ruga_status ruga_factor_solve_rough(ruga_factor* factor, const double* b, double* x) {
    if (factor->kind == RUGA_FACTOR_CHOLESKY || factor->pattern.columns == 0) {
        return ruga_factor_solve(factor, b, x);
    }
    return ruga_ldl_solve_rough(factor->ldl, b, x);
}

ruga_status ruga_factor_solve_absolute(ruga_factor* factor, const double* b, double* x) {
    RUGA_ASSERT(factor->kind != RUGA_FACTOR_CHOLESKY);
    return factor->pattern.columns == 0 ? RUGA_OK : ruga_ldl_solve_absolute(factor->ldl, b, x);
}

size_t ruga_factor_bytes(const ruga_factor* factor) {
    int n = factor->pattern.columns;
    size_t bytes = sizeof *factor + ((size_t)n + 1 + (size_t)factor->pattern.start[n]) * sizeof(int);
    bytes += factor->cholesky ? ruga_cholesky_bytes(factor->cholesky) : 0;
    return bytes + (factor->ldl ? ruga_ldl_bytes(factor->ldl) : 0);
}
