// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The two kinds of factor behind linear.h: CHOLMOD (cholesky.c) and our LDL^T (ldl.c).
#include "solver/cholesky.h"
#include "solver/ldl.h"

#include "core/memory.h"

#include <cblas.h>
#include <string.h>

struct ruga_factor {
    ruga_factor_kind kind;
    int n;
    ruga_cholesky* cholesky;
    ruga_ldl* ldl;
};

// OpenBLAS's own threads would change the bits with their number, and are not faster on fronts.
static void use_one_blas_thread(void) {
    if (openblas_get_num_threads() != 1) {
        openblas_set_num_threads(1);
    }
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
    f->n = lower->columns;
    if (f->n > 0 && kind == RUGA_FACTOR_CHOLESKY) {
        RUGA_TRY_DONE(ruga_cholesky_create(lower, node_count, node_start, last, &f->cholesky));
    } else if (f->n > 0) {
        RUGA_TRY_DONE(ruga_ldl_create(lower, node_count, node_start, last, &f->ldl));
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
        ruga_release(*factor);
        *factor = NULL;
    }
}

ruga_status ruga_factor_numeric(ruga_factor* factor, const double* values, ruga_factor_info* info) {
    if (factor->n == 0) {
        *info = (ruga_factor_info){.success = true};
        return RUGA_OK;
    }
    return factor->kind == RUGA_FACTOR_CHOLESKY ? ruga_cholesky_numeric(factor->cholesky, values, info)
                                                : ruga_ldl_numeric(factor->ldl, values, info);
}

ruga_status ruga_factor_solve(ruga_factor* factor, const double* b, double* x) {
    if (factor->n == 0) {
        return RUGA_OK;
    }
    return factor->kind == RUGA_FACTOR_CHOLESKY ? ruga_cholesky_solve(factor->cholesky, b, x)
                                                : ruga_ldl_solve(factor->ldl, b, x);
}

ruga_status ruga_factor_solve_absolute(ruga_factor* factor, const double* b, double* x) {
    RUGA_ASSERT(factor->kind == RUGA_FACTOR_LDL);
    return factor->n == 0 ? RUGA_OK : ruga_ldl_solve_absolute(factor->ldl, b, x);
}

size_t ruga_factor_bytes(const ruga_factor* factor) {
    size_t bytes = sizeof *factor;
    bytes += factor->cholesky ? ruga_cholesky_bytes(factor->cholesky) : 0;
    return bytes + (factor->ldl ? ruga_ldl_bytes(factor->ldl) : 0);
}
