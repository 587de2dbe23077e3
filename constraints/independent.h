// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Independent subsets of rows: the part of a kept row that is orthogonal to those kept before it is longer
// than `tolerance`; of a dropped row the part that is orthogonal to all kept ones is not.
#ifndef RUGA_CONSTRAINTS_INDEPENDENT_H
#define RUGA_CONSTRAINTS_INDEPENDENT_H

#include "core/status.h"

// Longest remainder first: a [count][width] is destroyed, picked [min(count, width)] receives rows in the
// order of picking, their number is returned.
int ruga_independent_pick(int count, int width, double* a, double tolerance, int* picked);

// The same for many sparse rows: row i holds entries start[i] to start[i + 1] of column and value. The first
// `fixed` rows, independent by themselves, come before all others. kept [count] is SET.
ruga_status ruga_independent_rows(int count, int width, int fixed, const int* start, const int* column,
                                  const double* value, double tolerance, bool* kept);

#endif
