// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Line search on the energy. All directions lie in the null space of the constraints, so the energy itself is the
// merit function: Armijo's rule E(x + b d) <= E(x) + 1e-4 b g.d, with b from the parabola through E(x), its
// slope and the last trial, kept within [0.1, 0.5] of the trial before (Kelley 1987, used by the 2013 paper on |F|^2).
#include "solver/skin.h"

#include <math.h>
#include <string.h>

enum { MAX_BACKTRACKS = 30, MAX_DOUBLINGS = 3 };

static ruga_status evaluate(ruga_skin* skin, const double* x, const double* d, double b, ruga_skin_terms* terms) {
    ruga_add_vectors(skin->n, 1, &d, &b, 1, x, skin->trial);
    return ruga_skin_energy(skin, skin->trial, terms, skin->trial_gradient);
}

static void accept(ruga_skin* skin, double* x, double* gradient) {
    memcpy(x, skin->trial, (size_t)skin->n * sizeof *x);
    memcpy(gradient, skin->trial_gradient, (size_t)skin->n * sizeof *gradient);
    ruga_skin_follow(skin, x);
}

// Near the minimum the energy's change drowns in round-off: there the slope decides. An energy that vanishes at the
// minimum, as of hinges at their rest angles, has the round-off of positions times forces and not of itself.
static bool decreases(double energy, double start, double slope, double b, double new_slope, double round_off) {
    if (energy <= start + 1e-4 * b * slope) {
        return true;
    }
    return fabs(energy - start) < fmax(1e-11 * fabs(start), round_off) && fabs(new_slope) < 0.9 * fabs(slope);
}

// The full step already bent down: go on doubling while the energy falls.
static ruga_status extend(ruga_skin* skin, const double* d, const double* x, double* b, ruga_skin_terms* terms) {
    for (int k = 0; k < MAX_DOUBLINGS; k++) {
        ruga_skin_terms further;
        RUGA_TRY(evaluate(skin, x, d, 2 * *b, &further));
        if (!(further.total < terms->total)) {
            break;
        }
        *b *= 2;
        *terms = further;
    }
    return evaluate(skin, x, d, *b, terms);
}

ruga_status ruga_armijo_search(ruga_skin* skin, const double* d, double* x, ruga_skin_terms* terms,
                               double* gradient, double* step) {
    double slope = ruga_dot_product(skin->n, gradient, d), start = terms->total, b = 1;
    double round_off = 0x1p-52 * skin->model->extent * terms->force_reference;
    *step = 0;
    if (!(slope < 0)) {
        return RUGA_OK;
    }
    for (int k = 0; k < MAX_BACKTRACKS; k++) {
        ruga_skin_terms trial;
        RUGA_TRY(evaluate(skin, x, d, b, &trial));
        double new_slope = ruga_dot_product(skin->n, skin->trial_gradient, d);
        if (isfinite(trial.total) && decreases(trial.total, start, slope, b, new_slope, round_off)) {
            if (b == 1 && new_slope < 0.9 * slope) {
                RUGA_TRY(extend(skin, d, x, &b, &trial));
            }
            accept(skin, x, gradient);
            *terms = trial;
            *step = b;
            return RUGA_OK;
        }
        double curvature = trial.total - start - b * slope;
        double guess = isfinite(curvature) && curvature > 0 ? -0.5 * slope * b * b / curvature : 0.1 * b;
        b = fmin(fmax(guess, 0.1 * b), 0.5 * b);
    }
    return RUGA_OK;
}
