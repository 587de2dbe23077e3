// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Independent subsets of rows: kept are rows whose part orthogonal to the kept ones before them is at least
// `tolerance` long; all others lie within that of the span of the kept.
#ifndef RUGA_CONSTRAINTS_INDEPENDENT_H
#define RUGA_CONSTRAINTS_INDEPENDENT_H

#include "core/status.h"

// Dense, longest remainder first: a [count][width] is destroyed, picked [min(count, width)] receives rows in
// the order of picking, their number is returned.
int ruga_independent_dense(int count, int width, double* a, double tolerance, int* picked);

// Sparse rows in the given order: row i holds entries start[i] to start[i + 1] of column and value. kept
// [count] is SET.
ruga_status ruga_independent_sparse(int count, int width, const int64_t* start, const int64_t* column,
                                    const double* value, double tolerance, bool* kept);

#endif
