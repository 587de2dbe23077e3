// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Leaving a saddle. Where few modes are unstable, as where a wrinkle is about to snap, the factor of the exact matrix shows
// a direction at no further factorisation: conjugate gradients on its inverse, which is indefinite too, meet a p with
// p.M K^-1 M p < 0, and then v = K^-1 M p has v.K v < 0 (M vertex areas; all in the null space of the constraints).
// The flat compressed state has many, and is an equilibrium whose gradient vanishes: there a few inverse iterations with
// K + s M, s just large enough, give a mixture of the most negative modes, not a single one, so that wrinkles start
// everywhere at once. The energy falls along v from any such state.
#include "solver/skin.h"

#include "core/random.h"

#include <math.h>
#include <string.h>

enum { INVERSE_ITERATIONS = 4, MAX_INVERSE_ITERATIONS = 24, MAX_DOUBLINGS = 8, FEW_MODES = 4, MAX_STEPS = 16 };
enum { RESIDUAL = 20, CONJUGATE, VECTOR, IMAGE }; // work vectors

static void random_direction(const ruga_skin* skin, int64_t salt, double* v) {
    ruga_random random = {.state = (uint64_t)skin->model->solver.seed * 0x9e3779b97f4a7c15u + (uint64_t)salt};
    for (int i = 0; i < skin->n; i++) {
        v[i] = ruga_random_uniform(&random) - 0.5;
    }
}

// Largest vertex displacement 1; false where there is none.
static bool normalize(const ruga_skin* skin, double* v) {
    double largest = ruga_largest_move(skin->n, v);
    if (!(largest > 0) || !isfinite(largest)) {
        return false;
    }
    for (int i = 0; i < skin->n; i++) {
        v[i] /= largest;
    }
    return true;
}

// y = M v, v.M v
static double weigh(const ruga_skin* skin, const double* v, double* y) {
    for (int i = 0; i < skin->n; i++) {
        y[i] = skin->model->vertex_area[i / 3] * v[i];
    }
    return ruga_dot_product(skin->n, v, y);
}

// One step of conjugate gradients; *negative where v = K^-1 M p shows that p.M v < 0.
static ruga_status conjugate_step(ruga_skin* skin, double* r, double* p, double* v, double* image, double* square,
                                  bool* negative) {
    (void)weigh(skin, p, image);
    RUGA_TRY(ruga_skin_solve_rough(skin, image, v));
    double curvature = ruga_dot_product(skin->n, image, v), before = *square;
    *negative = curvature < 0;
    for (int i = 0; i < skin->n && !*negative; i++) {
        r[i] -= before / curvature * v[i];
    }
    *square = weigh(skin, r, image);
    for (int i = 0; i < skin->n && !*negative; i++) {
        p[i] = r[i] + *square / before * p[i];
    }
    return RUGA_OK;
}

ruga_status ruga_negative_curvature_of_factor(ruga_skin* skin, double least, const double** along) {
    double *r = ruga_skin_vector(skin, RESIDUAL), *p = ruga_skin_vector(skin, CONJUGATE);
    double *v = ruga_skin_vector(skin, VECTOR), *image = ruga_skin_vector(skin, IMAGE);
    *along = NULL;
    if (skin->info.zero > 0 || skin->info.negative > skin->m + FEW_MODES) {
        return RUGA_OK;
    }
    random_direction(skin, skin->work.iterations, v);
    RUGA_TRY(ruga_skin_project(skin, v, r));
    memcpy(p, r, (size_t)skin->n * sizeof *p);
    double square = weigh(skin, r, image);
    bool negative = false;
    for (int k = 0; k < MAX_STEPS && !negative && square > 0; k++) {
        RUGA_TRY(conjugate_step(skin, r, p, v, image, &square, &negative));
    }
    if (!negative || !normalize(skin, v)) {
        return RUGA_OK;
    }
    double mass = weigh(skin, v, image);
    ruga_skin_multiply(skin, v, image);
    *along = ruga_dot_product(skin->n, v, image) < -least * mass ? v : NULL;
    return RUGA_OK;
}

// v of largest vertex displacement 1 with v.Kv < 0; *found tells.
static ruga_status find_direction(ruga_skin* skin, double* v, double* image, bool* found) {
    *found = false;
    for (int k = 0; k < MAX_INVERSE_ITERATIONS && !*found; k++) {
        (void)weigh(skin, v, image);
        RUGA_TRY(ruga_skin_solve(skin, image, v));
        if (!normalize(skin, v)) {
            return RUGA_OK;
        }
        if (k + 1 >= INVERSE_ITERATIONS) {
            ruga_skin_multiply(skin, v, image);
            *found = ruga_dot_product(skin->n, v, image) < 0;
        }
    }
    return RUGA_OK;
}

// v by shifted factors.
static ruga_status find_by_shifts(ruga_skin* skin, double* v, double* image, bool* found) {
    RUGA_TRY(ruga_skin_shift_until_right(skin));
    random_direction(skin, skin->work.iterations, v);
    RUGA_TRY(find_direction(skin, v, image, found));
    if (!*found) {
        // A mode whose curvature is tiny stands out only under a shift as small.
        RUGA_TRY(ruga_skin_refactor(skin, 0.01 * skin->shift_memory));
        if (skin->factor_right) {
            RUGA_TRY(find_direction(skin, v, image, found));
        }
    }
    return RUGA_OK;
}

ruga_status ruga_negative_curvature_step(ruga_skin* skin, const double* along, double* x, ruga_skin_terms* terms,
                                         double* gradient, bool* moved) {
    double *v = ruga_skin_vector(skin, VECTOR), *image = ruga_skin_vector(skin, IMAGE);
    *moved = false;
    bool found = along != NULL;
    if (found && along != v) {
        memcpy(v, along, (size_t)skin->n * sizeof *v);
    }
    if (!found) {
        RUGA_TRY(find_by_shifts(skin, v, image, &found));
    }
    if (!found) {
        return RUGA_OK;
    }
    double sign = ruga_dot_product(skin->n, gradient, v) > 0 ? -1 : 1;
    double length = 0.3 * skin->model->skin.thickness;
    for (int k = 0; k < MAX_DOUBLINGS; k++, length *= 2) {
        ruga_skin_terms trial;
        for (int i = 0; i < skin->n; i++) {
            skin->trial[i] = x[i] + sign * length * v[i];
        }
        RUGA_TRY(ruga_skin_energy(skin, skin->trial, &trial, skin->trial_gradient));
        if (!(trial.total < terms->total)) {
            // A first trial that is too long for this mode is shortened instead.
            if (*moved || k > 0 || length < 1e-4 * skin->model->skin.thickness) {
                break;
            }
            length *= 0.05;
            k = -1;
            continue;
        }
        *moved = true;
        *terms = trial;
        memcpy(image, skin->trial, (size_t)skin->n * sizeof *image);
        memcpy(gradient, skin->trial_gradient, (size_t)skin->n * sizeof *gradient);
    }
    if (*moved) {
        memcpy(x, image, (size_t)skin->n * sizeof *x);
        ruga_skin_follow(skin, x);
    }
    return RUGA_OK;
}
