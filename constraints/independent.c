// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Dense: modified Gram-Schmidt with pivoting. Sparse: multifrontal Householder QR (SuiteSparseQR) of the
// transpose in the order given; it declares a column dead when what is left of it is below the tolerance, and
// a dead column opens no new row of R.
#include "constraints/independent.h"

#include "core/memory.h"

#include <SuiteSparseQR_C.h>
#include <cblas.h>

#include <math.h>
#include <string.h>

static double square(int width, const double* row) {
    double sum = 0;
    for (int c = 0; c < width; c++) {
        sum += row[c] * row[c];
    }
    return sum;
}

int ruga_independent_dense(int count, int width, double* a, double tolerance, int* picked) {
    int rank = 0;
    while (rank < count && rank < width) {
        int longest = -1;
        double most = tolerance * tolerance;
        for (int i = 0; i < count; i++) {
            double s = square(width, a + (size_t)i * (size_t)width);
            if (s > most) {
                longest = i;
                most = s;
            }
        }
        if (longest < 0) {
            break;
        }
        picked[rank++] = longest;
        // Each remainder loses its part along the picked one, which thereby itself becomes zero.
        const double* pivot = a + (size_t)longest * (size_t)width;
        for (int i = 0; i < count; i++) {
            double* row = a + (size_t)i * (size_t)width;
            if (i != longest) {
                double part = 0;
                for (int c = 0; c < width; c++) {
                    part += pivot[c] * row[c];
                }
                part /= most;
                for (int c = 0; c < width; c++) {
                    row[c] -= part * pivot[c];
                }
            }
        }
        memset(a + (size_t)longest * (size_t)width, 0, (size_t)width * sizeof *a);
    }
    return rank;
}

// Column j of R is live where it reaches a row that no column before it reached.
static void read_live(const cholmod_sparse* r, const SuiteSparse_long* order, bool* kept) {
    const SuiteSparse_long *start = r->p, *row = r->i;
    SuiteSparse_long reached = -1;
    for (size_t j = 0; j < r->ncol; j++) {
        SuiteSparse_long deepest = -1;
        for (SuiteSparse_long k = start[j]; k < start[j + 1]; k++) {
            deepest = row[k] > deepest ? row[k] : deepest;
        }
        kept[order ? (size_t)order[j] : j] = deepest > reached;
        reached = deepest > reached ? deepest : reached;
    }
}

ruga_status ruga_independent_sparse(int count, int width, const int64_t* start, const int64_t* column,
                                    const double* value, double tolerance, bool* kept) {
    _Static_assert(sizeof(SuiteSparse_long) == sizeof(int64_t), "SuiteSparse's long index is 64 bits");
    cholmod_common common;
    cholmod_sparse* r = NULL;
    SuiteSparse_long* order = NULL;
    cholmod_sparse transpose = {.nrow = (size_t)width,
                                .ncol = (size_t)count,
                                .nzmax = (size_t)start[count],
                                .p = (void*)(uintptr_t)start,
                                .i = (void*)(uintptr_t)column,
                                .x = (void*)(uintptr_t)value,
                                .itype = CHOLMOD_LONG,
                                .xtype = CHOLMOD_REAL,
                                .dtype = CHOLMOD_DOUBLE,
                                .sorted = 0,
                                .packed = 1};
    // The bits of a BLAS result depend on the number of its threads.
    int threads = openblas_get_num_threads();
    openblas_set_num_threads(1);
    cholmod_l_start(&common);
    common.print = 0;
    SuiteSparse_long rank = SuiteSparseQR_C(SPQR_ORDERING_FIXED, tolerance, width, 0, &transpose, NULL, NULL,
                                            NULL, NULL, &r, &order, NULL, NULL, NULL, &common);
    ruga_status status = RUGA_OK;
    if (rank < 0 || !r) {
        status =
            common.status == CHOLMOD_OUT_OF_MEMORY
                ? ruga_fail(RUGA_NO_MEMORY, "out of memory while choosing among %d rows of handles", count)
                : ruga_fail(RUGA_LIBRARY, "SuiteSparseQR failed on %d rows of handles (status %d)", count,
                            common.status);
    } else {
        read_live(r, order, kept);
    }
    cholmod_l_free_sparse(&r, &common);
    cholmod_l_free((size_t)count, sizeof *order, order, &common);
    cholmod_l_finish(&common);
    openblas_set_num_threads(threads);
    return status;
}
