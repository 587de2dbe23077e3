// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Cox and de Boor: N_i,0 = 1 on [t_i, t_i+1),
//   N_i,d(x) = (x - t_i) N_i,d-1 / (t_i+d - t_i) + (t_i+d+1 - x) N_i+1,d-1 / (t_i+d+1 - t_i+1)
//   N_i,d'   = d [N_i,d-1 / (t_i+d - t_i) - N_i+1,d-1 / (t_i+d+1 - t_i+1)]
#include "lattice/spline.h"

#include "core/memory.h"

#include <string.h>

static void fill_knots(const ruga_spline* s, int kink) {
    int n = 0;
    for (int i = 0; i <= s->cells; i++) {
        int multiplicity = i == 0 || i == s->cells ? s->degree + 1 : i == kink ? s->degree : 1;
        for (int m = 0; m < multiplicity; m++) {
            s->knot[n++] = s->grid[i];
        }
    }
    RUGA_ASSERT(n == s->count + s->degree + 1);
}

ruga_status ruga_spline_create(int degree, int cells, const double* grid, int kink, ruga_spline* spline) {
    RUGA_ASSERT(degree >= 0 && degree < RUGA_SPLINE_ORDER_MAX && cells >= 1);
    RUGA_ASSERT(degree > 0 || cells == 1);
    RUGA_ASSERT(kink >= 0 && kink < cells);
    ruga_status status = RUGA_OK;
    int extra = kink > 0 ? degree - 1 : 0;
    *spline = (ruga_spline){.degree = degree, .cells = cells, .count = cells + degree + extra};
    for (int i = 0; i < cells; i++) {
        if (!(grid[i] < grid[i + 1])) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "grid of a spline: point %d is at %g and the next at %g: they must ascend", i,
                             grid[i], grid[i + 1]);
        }
    }
    RUGA_TRY_DONE(RUGA_NEW(spline->grid, cells + 1));
    RUGA_TRY_DONE(RUGA_NEW(spline->knot, spline->count + degree + 1));
    RUGA_TRY_DONE(RUGA_NEW(spline->first, cells));
    memcpy(spline->grid, grid, (size_t)(cells + 1) * sizeof *grid);
    fill_knots(spline, kink);
    for (int i = 0; i < cells; i++) {
        spline->first[i] = i + (kink > 0 && i >= kink ? extra : 0);
    }
done:
    if (status != RUGA_OK) {
        ruga_spline_clear(spline);
    }
    return status;
}

void ruga_spline_clear(ruga_spline* spline) {
    ruga_release(spline->grid);
    ruga_release(spline->knot);
    ruga_release(spline->first);
    *spline = (ruga_spline){0};
}

void ruga_spline_basis(const ruga_spline* spline, int cell, double x, double value[RUGA_SPLINE_ORDER_MAX],
                       double slope[RUGA_SPLINE_ORDER_MAX]) {
    const double* t = spline->knot;
    int span = spline->first[cell] + spline->degree; // t[span] <= x < t[span + 1]
    value[0] = 1;
    slope[0] = 0;
    for (int d = 1; d <= spline->degree; d++) {
        double lower[RUGA_SPLINE_ORDER_MAX];
        memcpy(lower, value, (size_t)d * sizeof *lower); // N_i,d-1 for i = span - d + 1 .. span
        for (int r = 0; r <= d; r++) {
            int i = span - d + r;
            double left = r > 0 ? lower[r - 1] / (t[i + d] - t[i]) : 0;
            double right = r < d ? lower[r] / (t[i + d + 1] - t[i + 1]) : 0;
            value[r] = (x - t[i]) * left + (t[i + d + 1] - x) * right;
            slope[r] = d * (left - right);
        }
    }
}

double ruga_spline_greville(const ruga_spline* spline, int i) {
    if (spline->degree == 0) {
        return 0.5 * (spline->grid[0] + spline->grid[1]);
    }
    double sum = 0;
    for (int d = 1; d <= spline->degree; d++) {
        sum += spline->knot[i + d];
    }
    return sum / spline->degree;
}

int ruga_spline_cell(const ruga_spline* spline, double x) {
    int low = 0, high = spline->cells - 1;
    while (low < high) {
        int middle = (low + high + 1) / 2;
        if (spline->grid[middle] <= x) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    return low;
}
