// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// L-BFGS on the null space of the constraints. Its initial inverse is a factor of the KKT matrix that is renewed about
// every 24 iterations from a Hessian with half of the compressive geometric stiffness taken out (the exact one is
// indefinite while wrinkles move); the last certified exact factor starts the next frame. A KKT solve returns steps
// with H d = 0, so every iterate stays feasible. facts: a wrinkled valley is curved on the scale of the thickness,
// so any quadratic model serves for about 0.2 h only; cheap steps with a fresh enough factor win over Newton's. What
// takes 480 of them, or twelve factors that serve for one each, is no wrinkle but a stiff panel that turns: where the
// Hessian is convex Newton's leaps go on.
#include "solver/skin.h"
#include "solver/vectors.h"

#include <math.h>

enum { PAIRS = 8, REFRESH = 24, SLOW = 480, MOST_IN_VAIN = 12, MAX_ITERATIONS = 3000 };
enum { GRADIENT, PROJECTED, OLD_PROJECTED, DIRECTION, WORK, STEPS, DIFFERENCES = STEPS + PAIRS };

typedef struct memory {
    int count, newest;           // pairs kept, slot of the newest
    double rho[PAIRS];           // 1 / s.y
    double cross[PAIRS][PAIRS];  // [i][k] = s_i . y_k of slots, where k is newer than i
    double step;                 // last taken, in directions: 0 = none, or the energy could not be lowered
} memory;

static int slot_of(const memory* m, int age) {
    return (m->newest - age + 2 * PAIRS) % PAIRS;
}

// The pairs by age, the newest first.
typedef struct pairs {
    const double *step[PAIRS], *difference[PAIRS];
} pairs;

static void list_pairs(ruga_skin* skin, const memory* m, pairs* list) {
    for (int age = 0; age < m->count; age++) {
        list->step[age] = ruga_skin_vector(skin, STEPS + slot_of(m, age));
        list->difference[age] = ruga_skin_vector(skin, DIFFERENCES + slot_of(m, age));
    }
}

// d = - (two-loop recursion) g. Its products with sums of pairs are made of those with the pairs themselves, so that
// each loop reads all pairs at once, twice.
static ruga_status lbfgs_direction(ruga_skin* skin, const memory* m, const double* g, double* d) {
    double a[PAIRS], factor[PAIRS], *q = ruga_skin_vector(skin, WORK);
    pairs list;
    list_pairs(skin, m, &list);
    ruga_dot_products(skin->n, m->count, list.step, g, a);
    for (int age = 0; age < m->count; age++) {
        int k = slot_of(m, age);
        for (int newer = 0; newer < age; newer++) {
            a[age] += factor[newer] * m->cross[k][slot_of(m, newer)];
        }
        a[age] *= m->rho[k];
        factor[age] = -a[age];
    }
    ruga_add_vectors(skin->n, m->count, list.difference, factor, 1, g, q);
    RUGA_TRY(ruga_skin_solve_rough(skin, q, d));
    ruga_dot_products(skin->n, m->count, list.difference, d, factor);
    for (int age = m->count - 1; age >= 0; age--) {
        int k = slot_of(m, age);
        for (int older = age + 1; older < m->count; older++) {
            factor[age] += factor[older] * m->cross[slot_of(m, older)][k];
        }
        factor[age] = a[age] - m->rho[k] * factor[age];
    }
    ruga_add_vectors(skin->n, m->count, list.step, factor, -1, d, d);
    return RUGA_OK;
}

// Keeps the pair of the step just made where its curvature is positive. Differences of projected gradients are as good
// as those of gradients, since all steps are in the null space, and need no projection before a solve.
static void remember(ruga_skin* skin, memory* m, const double* old_projected, const double* projected) {
    const double minus_one = -1, *d = ruga_skin_vector(skin, DIRECTION);
    int k = (m->newest + 1) % PAIRS;
    double *s = ruga_skin_vector(skin, STEPS + k), *y = ruga_skin_vector(skin, DIFFERENCES + k), product[PAIRS];
    ruga_add_vectors(skin->n, 0, NULL, NULL, m->step, d, s);
    ruga_add_vectors(skin->n, 1, &old_projected, &minus_one, 1, projected, y);
    ruga_dot_products(skin->n, 2, (const double* const[]){y, old_projected}, s, product);
    if (!(product[0] > 1e-6 * m->step * fabs(product[1]))) {
        return;
    }
    m->rho[k] = 1 / product[0];
    m->newest = k;
    m->count = m->count < PAIRS ? m->count + 1 : PAIRS;
    pairs list;
    list_pairs(skin, m, &list);
    ruga_dot_products(skin->n, m->count - 1, list.step + 1, y, product);
    for (int age = 1; age < m->count; age++) {
        m->cross[slot_of(m, age)][k] = product[age - 1];
    }
}

// One direction and line search; *move is the direction's length.
static ruga_status iterate(ruga_skin* skin, memory* m, double* x, double* gradient, const double* projected,
                           ruga_skin_terms* terms, double* move) {
    double* d = ruga_skin_vector(skin, DIRECTION);
    RUGA_TRY(lbfgs_direction(skin, m, projected, d));
    RUGA_TRY(ruga_skin_clean_direction(skin, d, move));
    return ruga_armijo_search(skin, d, x, terms, gradient, &m->step);
}

ruga_status ruga_quasi_newton_minimize(ruga_skin* skin, double* x, double tolerance, bool certify,
                                       ruga_skin_result* result) {
    double *gradient = ruga_skin_vector(skin, GRADIENT), *projected = ruga_skin_vector(skin, PROJECTED);
    double* old_projected = ruga_skin_vector(skin, OLD_PROJECTED);
    memory m = {.newest = -1};
    double score = 0, move;
    int failures = 0, hand_over = SLOW, in_vain = 0; // renewals in a row that served one step only
    double target = tolerance;
    result->outcome = RUGA_OUTCOME_NOT_CONVERGED;
    RUGA_TRY(ruga_skin_energy(skin, x, &result->terms, gradient));
    if (!skin->factor_right) {
        RUGA_TRY(ruga_skin_factor_convex(skin, x));
    }
    for (int k = 0; k < MAX_ITERATIONS; k++, skin->work.iterations++) {
        double* last = old_projected;
        old_projected = projected;
        projected = last;
        RUGA_TRY(ruga_skin_project(skin, gradient, projected));
        result->residual = ruga_skin_residual(skin, projected, &result->terms);
        if (result->residual <= target) {
            bool done;
            RUGA_TRY(ruga_skin_certify(skin, x, certify, tolerance, &target, gradient, result, &done));
            if (done) {
                return RUGA_OK;
            }
            score = REFRESH;
        }
        if (score >= REFRESH && (k >= hand_over || in_vain >= MOST_IN_VAIN)) {
            RUGA_TRY(ruga_newton_minimize(skin, x, tolerance, certify, true, result));
            if (result->outcome != RUGA_OUTCOME_NOT_CONVERGED) {
                return RUGA_OK;
            }
            RUGA_TRY(ruga_skin_energy(skin, x, &result->terms, gradient));
            hand_over = k + SLOW;
            in_vain = 0;
        }
        if (score >= REFRESH) {
            RUGA_TRY(ruga_skin_factor_convex(skin, x));
            m = (memory){.newest = -1};
            score = 0;
            continue;
        }
        if (m.step > 0) {
            remember(skin, &m, old_projected, projected);
        }
        RUGA_TRY(iterate(skin, &m, x, gradient, projected, &result->terms, &move));
        // A first step that is far too long or hardly taken: the old factor is of no use here.
        bool useless = score == 0 && (move > 2 * skin->model->skin.thickness || m.step < 0.2) && failures == 0;
        in_vain = useless ? in_vain + 1 : 0;
        score = useless || m.step == 0 ? REFRESH : score + 1 + (m.step < 0.35);
        failures = m.step * move <= 0x1p-52 * skin->model->extent ? failures + 1 : 0;
        skin->single_serves = skin->single_serves && failures == 0;
        if (failures > 3) {
            return RUGA_OK;
        }
    }
    return RUGA_OK;
}
