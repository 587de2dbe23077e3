// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Sparse matrices with a fixed pattern. A symmetric matrix is stored as its lower triangle, column by
// column, diagonal first, rows ascending: column j holds index[start[j]] = j, then rows > j.
#ifndef RUGA_CORE_SPARSE_H
#define RUGA_CORE_SPARSE_H

#include "core/status.h"

typedef struct ruga_sparse {
    int rows;
    int columns;
    int* start;    // [columns + 1]
    int* index;    // [start[columns]] row of each entry, ascending in each column
    double* value; // [start[columns]] may be NULL for a bare pattern
} ruga_sparse;

// Frees the arrays (not the struct) and zeroes it.
void ruga_sparse_clear(ruga_sparse* matrix);

// y = A x for a symmetric matrix stored as its lower triangle.
void ruga_sparse_multiply_symmetric(const ruga_sparse* lower, const double* x, double* y);

// Lower-triangle pattern, with zero values, of a symmetric block matrix with b x b blocks: one for each of
// the `nodes` diagonals and for each pair (may repeat, in any order; a pair (i, i) is ignored).
ruga_status ruga_sparse_from_pairs(int nodes, int block, int64_t pair_count, const int (*pairs)[2],
                                   ruga_sparse* lower);

// Position in value[] of entry (row, column), row >= column; -1 where the pattern has none.
int ruga_sparse_find(const ruga_sparse* lower, int row, int column);

#endif
