// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The rows that keep a cut together: W^T x = 0, one row for each copy of an embedded node but the first, the
// same for x, y and z. Factorised projections are the solver's.
#ifndef RUGA_CREASE_SEWING_H
#define RUGA_CREASE_SEWING_H

#include "core/sparse.h"
#include "crease/cut.h"

typedef struct ruga_sewing {
    int node_count;
    int row_count;
    int* start; // [rows + 1]
    int* node;  // of each entry
    double* weight;
    int* bound;          // [rows] bound of the cut that the row belongs to
    int fixed_rows;      // left out because all their nodes are fixed
    int redundant_rows;  // left out because the rows before them imply them
    ruga_sparse pattern; // of S = W^T M^-1 W, lower triangle
} ruga_sewing;

// fixed [nodes] or NULL: nodes that are held, of infinite mass. Rows are in the order of the cut's bounds.
ruga_status ruga_sewing_create(const ruga_cut* cut, const bool* fixed, ruga_sewing* sewing);
void ruga_sewing_clear(ruga_sewing* sewing);
// value [pattern's entries] = W^T M^-1 W for inverse masses [nodes], 1/kg, which are 0 for fixed nodes.
void ruga_sewing_matrix(const ruga_sewing* sewing, const double* inverse_mass, double* value);
// gap [rows][3] = W^T x
void ruga_sewing_gaps(const ruga_sewing* sewing, const double* x, double* gap);
// y [nodes][3] += factor M^-1 W impulse [rows][3]; inverse_mass NULL = 1 everywhere.
void ruga_sewing_spread(const ruga_sewing* sewing, const double* inverse_mass, double factor,
                        const double* impulse, double* y);

// L D L^T of a positive semi-definite matrix, its lower triangle given with values, in the order of its rows.
// Rows that depend on those before them, whose pivot is at most `tolerance` of the diagonal, are left out:
// dependent [n] is SET.
typedef struct ruga_seam_factor {
    int n;
    int *start, *index; // of L, by column
    double *value, *pivot;
} ruga_seam_factor;
ruga_status ruga_seam_factor_create(const ruga_sparse* lower, double tolerance, bool* dependent,
                                    ruga_seam_factor* factor);
void ruga_seam_factor_clear(ruga_seam_factor* factor);

#endif
