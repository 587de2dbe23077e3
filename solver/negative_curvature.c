// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Leaving a saddle. The flat compressed state is an equilibrium whose gradient vanishes: no descent method leaves
// it, and only the inertia tells. A few inverse iterations with K + s M (M vertex areas, s just large enough) give a
// direction v with v.Kv < 0 in the null space of the constraints: a mixture of the most negative modes, not a
// single one, so that wrinkles start everywhere at once. The energy falls along v from any such state.
#include "solver/skin.h"

#include "core/random.h"

#include <math.h>
#include <string.h>

enum { INVERSE_ITERATIONS = 4, MAX_INVERSE_ITERATIONS = 24, MAX_DOUBLINGS = 8, VECTOR = 22, IMAGE = 23 };

static void random_direction(const ruga_skin* skin, int64_t salt, double* v) {
    ruga_random random = {.state = (uint64_t)skin->model->solver.seed * 0x9e3779b97f4a7c15u + (uint64_t)salt};
    for (int i = 0; i < skin->n; i++) {
        v[i] = ruga_random_uniform(&random) - 0.5;
    }
}

// v of largest vertex displacement 1 with v.Kv < 0; *found tells.
static ruga_status find_direction(ruga_skin* skin, double* v, double* image, bool* found) {
    *found = false;
    for (int k = 0; k < MAX_INVERSE_ITERATIONS && !*found; k++) {
        for (int i = 0; i < skin->n; i++) {
            v[i] *= skin->model->vertex_area[i / 3];
        }
        RUGA_TRY(ruga_skin_solve(skin, v, v));
        double largest = ruga_largest_move(skin->n, v);
        if (!(largest > 0) || !isfinite(largest)) {
            return RUGA_OK;
        }
        for (int i = 0; i < skin->n; i++) {
            v[i] /= largest;
        }
        if (k + 1 >= INVERSE_ITERATIONS) {
            ruga_skin_multiply(skin, v, image);
            *found = ruga_dot_product(skin->n, v, image) < 0;
        }
    }
    return RUGA_OK;
}

ruga_status ruga_negative_curvature_step(ruga_skin* skin, double* x, ruga_skin_terms* terms, double* gradient,
                                         bool* moved) {
    double *v = ruga_skin_vector(skin, VECTOR), *image = ruga_skin_vector(skin, IMAGE);
    *moved = false;
    bool found;
    RUGA_TRY(ruga_skin_shift_until_right(skin));
    random_direction(skin, skin->work.iterations, v);
    RUGA_TRY(find_direction(skin, v, image, &found));
    if (!found) {
        // A mode whose curvature is tiny stands out only under a shift as small.
        RUGA_TRY(ruga_skin_refactor(skin, 0.01 * skin->shift_memory));
        if (skin->factor_right) {
            RUGA_TRY(find_direction(skin, v, image, &found));
        }
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
