// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The published solve made robust: Newton on the KKT system from a feasible start, with the exact Hessian
// where its inertia is that of a minimum and a diagonal shift where it is not, Armijo's rule on the energy,
// and a step of negative curvature at saddles. The linear system is solved directly, or on the null space of
// H by Belos MINRES, its preconditioner a factor of [K H^T; H 0] that is kept across iterations and frames
// while it serves: a constraint preconditioner (Gould, Hribar, Nocedal 2001), positive definite there, as its
// inertia is that of a minimum. With the factor of the matrix itself one iteration is enough.
//
// Leaps. Where stiff panels turn, a straight step stretches them by the square of its length: the energy falls over a
// tiny part of it only. But the next Newton step takes just that stretch out, while the tension that it causes keeps
// everything else where it is. So where a full step fails it is made all the same and corrected, and kept where the energy
// ends below what the line search found (a watchdog: Chamberlain, Powell, Lemarechal and Pedersen 1982).
#include "solver/belos_shim.h"
#include "solver/skin.h"

#include <math.h>
#include <string.h>

enum { MAX_ITERATIONS = 400, MINRES_MAX = 60, MAX_CORRECTIONS = 3, MAX_PAUSE = 16 };
enum { GRADIENT, PROJECTED, DIRECTION, SIDE, LEAP, LEAP_GRADIENT, CORRECTION }; // work vectors

// y = P K x with the stiffness last assembled, P the projection on H x = 0.
static ruga_status apply_reduced(const double* x, double* y, void* context) {
    ruga_skin* skin = context;
    ruga_skin_multiply(skin, x, y);
    return ruga_skin_project(skin, y, y);
}

static ruga_status apply_preconditioner(const double* x, double* y, void* context) {
    return ruga_skin_solve_rough(context, x, y);
}

// Newton direction by MINRES; *good = false where the factor no longer serves or the direction does not descend.
static ruga_status direction_minres(ruga_skin* skin, const double* x, const double* projected, double* d,
                                    bool* good) {
    double* side = ruga_skin_vector(skin, SIDE);
    *good = false;
    if (!skin->factor_right) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_skin_assemble(skin, x, 0));
    for (int i = 0; i < skin->n; i++) {
        side[i] = -projected[i];
        d[i] = 0;
    }
    ruga_minres_report report;
    RUGA_TRY(ruga_belos_minres(skin->n, apply_reduced, apply_preconditioner, skin, side, d, 1e-4, MINRES_MAX,
                               &report));
    *good = report.converged && ruga_dot_product(skin->n, projected, d) < 0;
    return RUGA_OK;
}

// d = - K^-1 of the factor at hand, capped.
static ruga_status solve(ruga_skin* skin, const double* projected, double* d) {
    RUGA_TRY(ruga_skin_solve(skin, projected, d));
    for (int i = 0; i < skin->n; i++) {
        d[i] = -d[i];
    }
    return ruga_skin_clean_direction(skin, d, NULL);
}

// Newton direction from a factor of the right inertia; *shifted tells whether the exact Hessian had the wrong one:
// there is none then where it should be convex.
static ruga_status direction_direct(ruga_skin* skin, const double* x, const double* projected, bool while_convex,
                                    double* d, bool* shifted) {
    RUGA_TRY(ruga_skin_factor(skin, x, 0, 0));
    *shifted = !skin->factor_right;
    if (*shifted && while_convex) {
        return RUGA_OK;
    }
    if (*shifted) {
        RUGA_TRY(ruga_skin_shift_until_right(skin));
    } else {
        skin->shift_memory *= 0.25;
    }
    return solve(skin, projected, d);
}

static ruga_status direction(ruga_skin* skin, const double* x, const double* projected, bool while_convex,
                             double* d, bool* shifted) {
    bool good = false;
    *shifted = false;
    if (skin->model->solver.linear == RUGA_LINEAR_MINRES) {
        RUGA_TRY(direction_minres(skin, x, projected, d, &good));
    }
    return good ? ruga_skin_clean_direction(skin, d, NULL)
                : direction_direct(skin, x, projected, while_convex, d, shifted);
}

// From the point before a line search (LEAP) along d to the end of the full step, and from there by Newton steps while
// the Hessian is a minimum's. *better, with x, terms and gradient, where the energy ends below terms.
static ruga_status leap(ruga_skin* skin, const double* d, double* x, ruga_skin_terms* terms, double* gradient,
                        bool* better) {
    double *y = ruga_skin_vector(skin, LEAP), *g = ruga_skin_vector(skin, LEAP_GRADIENT);
    double* correction = ruga_skin_vector(skin, CORRECTION);
    *better = false;
    for (int k = 0; k <= MAX_CORRECTIONS; k++) {
        ruga_skin_terms there;
        for (int i = 0; i < skin->n; i++) {
            y[i] += k ? correction[i] : d[i];
        }
        RUGA_TRY(ruga_skin_energy(skin, y, &there, g));
        if (there.total < terms->total) {
            memcpy(x, y, (size_t)skin->n * sizeof *x);
            memcpy(gradient, g, (size_t)skin->n * sizeof *g);
            *terms = there;
            *better = true;
            ruga_skin_follow(skin, x);
            return RUGA_OK;
        }
        if (k == MAX_CORRECTIONS || !isfinite(there.total)) {
            return RUGA_OK;
        }
        RUGA_TRY(ruga_skin_factor(skin, y, 0, 0));
        if (!skin->factor_right) {
            return RUGA_OK;
        }
        RUGA_TRY(ruga_skin_project(skin, g, correction));
        RUGA_TRY(solve(skin, correction, correction));
    }
    return RUGA_OK;
}

ruga_status ruga_newton_minimize(ruga_skin* skin, double* x, double tolerance, bool certify, bool while_convex,
                                 ruga_skin_result* result) {
    double *gradient = ruga_skin_vector(skin, GRADIENT), *projected = ruga_skin_vector(skin, PROJECTED);
    double *d = ruga_skin_vector(skin, DIRECTION), step;
    double target = tolerance;
    int pause = 0, waited = 0; // iterations between leaps, more after each that was in vain
    result->outcome = RUGA_OUTCOME_NOT_CONVERGED;
    RUGA_TRY(ruga_skin_energy(skin, x, &result->terms, gradient));
    for (int k = 0; k < MAX_ITERATIONS; k++, skin->work.iterations++) {
        bool stuck = false, shifted;
        RUGA_TRY(ruga_skin_project(skin, gradient, projected));
        result->residual = ruga_skin_residual(skin, projected, &result->terms);
        if (result->residual <= target) {
            RUGA_TRY(ruga_skin_certify(skin, x, certify, tolerance, &target, gradient, result, &stuck));
            if (stuck) {
                return RUGA_OK;
            }
            continue;
        }
        RUGA_TRY(direction(skin, x, projected, while_convex, d, &shifted));
        if (shifted && while_convex) {
            return RUGA_OK;
        }
        if (shifted && ruga_largest_move(skin->n, d) < 0.1 * skin->model->skin.thickness) {
            RUGA_TRY(ruga_negative_curvature_step(skin, NULL, x, &result->terms, gradient, &stuck));
            if (stuck) {
                continue; // it moved
            }
        }
        memcpy(ruga_skin_vector(skin, LEAP), x, (size_t)skin->n * sizeof *x);
        RUGA_TRY(ruga_armijo_search(skin, d, x, &result->terms, gradient, &step));
        waited++;
        if (step < 0.5 && !shifted && waited > pause && skin->model->solver.linear != RUGA_LINEAR_MINRES) {
            bool better;
            RUGA_TRY(leap(skin, d, x, &result->terms, gradient, &better));
            pause = better ? 0 : fmin(2 * pause + 1, MAX_PAUSE);
            waited = 0;
            step = better ? 1 : step;
        }
        if (step == 0) {
            return RUGA_OK;
        }
    }
    return RUGA_OK;
}
