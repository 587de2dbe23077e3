// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// B-splines of one variable on an open knot vector: free spacing, ends that interpolate, and one interior
// knot that may be repeated so that the slope can jump there.
#ifndef RUGA_LATTICE_SPLINE_H
#define RUGA_LATTICE_SPLINE_H

#include "core/status.h"

enum { RUGA_SPLINE_ORDER_MAX = 3 };

typedef struct ruga_spline {
    int degree;   // 0 (one cell, the constant 1), 1 or 2
    int cells;    // between the knots that differ
    int count;    // functions
    double* grid; // [cells + 1] m, ascending
    double* knot; // [count + degree + 1] m
    int* first;   // [cells] the first of the degree + 1 functions that live on a cell
} ruga_spline;

// kink: grid[kink], 0 < kink < cells, becomes a knot of multiplicity `degree` (C0); 0 = none.
ruga_status ruga_spline_create(int degree, int cells, const double* grid, int kink, ruga_spline* spline);
void ruga_spline_clear(ruga_spline* spline);

// The degree + 1 functions of a cell at x, and their derivatives in 1/m.
void ruga_spline_basis(const ruga_spline* spline, int cell, double x, double value[RUGA_SPLINE_ORDER_MAX],
                       double slope[RUGA_SPLINE_ORDER_MAX]);

// Where the coefficient of function i sits: sum of greville(i) N_i(x) = x for degree >= 1.
double ruga_spline_greville(const ruga_spline* spline, int i);

// The cell that holds x; ends included, points outside go to the nearest.
int ruga_spline_cell(const ruga_spline* spline, double x);

#endif
