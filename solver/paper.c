// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The static solve as published (Remillard and Kry 2013, section 6.1), kept as the baseline: Newton-Raphson on
//     F(x, l) = [F_x(x) + gamma H^T l; gamma H (B q - x)] = 0,   gamma = h E,   eqs. 9 and 10,
// from the last frame's x, each system solved by MINRES without a preconditioner, and Armijo's rule on |F| with the
// published parabola. What the paper leaves open is fixed by the issue: relative tolerance 1e-3 and at most 4,000
// MINRES iterations, at most 50 Newton steps. Nothing here avoids saddles; the outcome tells.
#include "core/progress.h"
#include "solver/belos_shim.h"
#include "solver/skin.h"

#include <math.h>
#include <string.h>

enum { NEWTON_MAX = 50, MINRES_MAX = 4000, SEARCH_MAX = 30 };
enum { GRADIENT, PROJECTED, RESIDUAL, SOLUTION, TRIAL }; // work vectors

typedef struct system {
    ruga_skin* skin;
    double gamma;
} system_;

// out += s gamma H^T l on the first n, with held components out of play.
static void add_constraint_force(const system_* sys, const double* l, double* out) {
    ruga_skin* skin = sys->skin;
    double* scaled = skin->multiplier;
    for (int r = 0; r < skin->m; r++) {
        scaled[r] = sys->gamma * l[r];
    }
    ruga_skin_clear_void_rows(skin, scaled);
    ruga_clusters_apply_transpose(&skin->model->clusters, scaled, out);
}

static void zero_held(const ruga_skin* skin, double* v) {
    for (int i = 0; i < skin->n && skin->model->any_skin_held; i++) {
        v[i] = skin->model->skin_handle[i] >= 0 ? 0 : v[i];
    }
}

// The matrix of eq. 10: [K gamma H^T; gamma H 0].
static ruga_status apply_matrix(const double* x, double* y, void* context) {
    const system_* sys = context;
    ruga_skin* skin = sys->skin;
    ruga_skin_multiply(skin, x, y);
    add_constraint_force(sys, x + skin->n, y);
    zero_held(skin, y);
    ruga_clusters_apply(&skin->model->clusters, x, y + skin->n);
    for (int r = 0; r < skin->m; r++) {
        y[skin->n + r] *= sys->gamma;
    }
    ruga_skin_clear_void_rows(skin, y + skin->n);
    return RUGA_OK;
}

// F at x with multipliers l, as [-(gradient) + ...] in the sign of eq. 10's right side; gradient is work.
static ruga_status evaluate(const system_* sys, const double* x, const double* l, ruga_skin_terms* terms,
                            double* gradient, double* f) {
    ruga_skin* skin = sys->skin;
    int n = skin->n;
    RUGA_TRY(ruga_skin_energy(skin, x, terms, gradient));
    memcpy(f, gradient, (size_t)n * sizeof *f);
    if (l) {
        add_constraint_force(sys, l, f);
    }
    zero_held(skin, f);
    for (int i = 0; i < n; i++) {
        f[i] = -f[i];
        skin->displacement[i] = skin->embedded[i] - x[i];
    }
    ruga_clusters_apply(&skin->model->clusters, skin->displacement, f + n);
    for (int r = 0; r < skin->m; r++) {
        f[n + r] *= sys->gamma;
    }
    ruga_skin_clear_void_rows(skin, f + n);
    return RUGA_OK;
}

// Armijo on |F| along d (with the multipliers of the last solve): b = 1, 0.5, then the parabola of |F|^2 through
// b = 0 and the last two trials, clamped to [0.1, 0.5] of the last.
static ruga_status search(const system_* sys, const double* d, const double* l, double* x, ruga_skin_terms* terms,
                          double* gradient, double* step) {
    ruga_skin* skin = sys->skin;
    double *f = ruga_skin_vector(skin, RESIDUAL), *trial = ruga_skin_vector(skin, TRIAL);
    int size = skin->n + skin->m;
    RUGA_TRY(evaluate(sys, x, l, terms, gradient, f));
    double start = ruga_dot_product(size, f, f), b = 1, last_b = 0, last = 0;
    *step = 0;
    for (int k = 0; k < SEARCH_MAX; k++) {
        for (int i = 0; i < skin->n; i++) {
            trial[i] = x[i] + b * d[i];
        }
        RUGA_TRY(evaluate(sys, trial, l, terms, gradient, f));
        double value = ruga_dot_product(size, f, f);
        if (sqrt(value) < (1 - 1e-4 * b) * sqrt(start)) {
            memcpy(x, trial, (size_t)skin->n * sizeof *x);
            *step = b;
            return RUGA_OK;
        }
        double next = 0.5 * b;
        if (k > 0) {
            // phi(b) = start + c1 b + c2 b^2 through both trials
            double c2 = ((value - start) / b - (last - start) / last_b) / (b - last_b);
            double c1 = (value - start) / b - c2 * b;
            double guess = c2 > 0 ? -c1 / (2 * c2) : 0.5 * b;
            next = fmin(fmax(guess, 0.1 * b), 0.5 * b);
        }
        last_b = b;
        last = value;
        b = next;
    }
    return RUGA_OK;
}

ruga_status ruga_paper_minimize(ruga_skin* skin, double* x, double tolerance, ruga_skin_result* result) {
    system_ sys = {skin, skin->model->skin.thickness * skin->model->skin.young};
    double *gradient = ruga_skin_vector(skin, GRADIENT), *f = ruga_skin_vector(skin, RESIDUAL);
    double *projected = ruga_skin_vector(skin, PROJECTED), *solution = ruga_skin_vector(skin, SOLUTION), step = 1;
    for (int i = 0; i < skin->n && skin->model->any_skin_held; i++) {
        x[i] = skin->model->skin_handle[i] >= 0 ? skin->target[i] : x[i];
    }
    for (int k = 0;; k++) {
        RUGA_TRY(evaluate(&sys, x, NULL, &result->terms, gradient, f));
        RUGA_TRY(ruga_skin_project(skin, gradient, projected));
        result->residual = ruga_skin_residual(skin, projected, &result->terms);
        bool feasible = ruga_skin_constraint_residual(skin, x) <= 1e-9;
        if ((result->residual <= tolerance && feasible) || k == NEWTON_MAX || step == 0) {
            break;
        }
        RUGA_TRY(ruga_progress("static solve", (double)k / NEWTON_MAX));
        RUGA_TRY(ruga_skin_assemble(skin, x, 0));
        memset(solution, 0, (size_t)(skin->n + skin->m) * sizeof *solution);
        ruga_minres_report report;
        RUGA_TRY(ruga_belos_minres(skin->n + skin->m, apply_matrix, NULL, &sys, f, solution, 1e-3, MINRES_MAX,
                                   &report));
        skin->work.linear_iterations += report.iterations;
        skin->work.iterations++;
        RUGA_TRY(search(&sys, solution, solution + skin->n, x, &result->terms, gradient, &step));
    }
    bool converged = result->residual <= tolerance && ruga_skin_constraint_residual(skin, x) <= 1e-9;
    // Told honestly, at the cost of one factorisation that the paper does not make.
    RUGA_TRY(ruga_skin_factor(skin, x, 0, 0));
    result->outcome = !converged           ? RUGA_OUTCOME_NOT_CONVERGED
                      : skin->factor_right ? RUGA_OUTCOME_MINIMUM
                                           : RUGA_OUTCOME_SADDLE;
    return RUGA_OK;
}
