// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What the methods of the static solve share: the residual, the certificate, the cap of a step.
#include "core/progress.h"
#include "solver/skin.h"

#include <math.h>

enum { SETTLING = 22, MOVE = 23, MAX_SETTLING = 2 }; // work vectors; Newton steps

double ruga_skin_residual(ruga_skin* skin, const double* projected, const ruga_skin_terms* terms) {
    double residual = sqrt(ruga_dot_product(skin->n, projected, projected)) / terms->force_reference;
    if (skin->trace_count < skin->trace_size) {
        skin->trace[skin->trace_count++] = (ruga_skin_trace){ruga_clock(), residual, terms->total,
                                                             skin->work.factorizations, skin->work.energies};
    }
    return residual;
}

// The energy's curvature is known only nearby: half an edge is as far as a quadratic model may be trusted.
ruga_status ruga_skin_clean_direction(const ruga_skin* skin, double* d, double* move) {
    double largest = ruga_largest_move(skin->n, d), cap = 0.5 * skin->model->mean_edge;
    if (move) {
        *move = largest;
    }
    if (!isfinite(largest)) {
        return ruga_fail(RUGA_LIBRARY, "the skin's linear system gave a result that is not finite");
    }
    for (int i = 0; i < skin->n && largest > cap; i++) {
        d[i] *= cap / largest;
    }
    return RUGA_OK;
}

// A mode without stiffness, as of a crease that turns freely, has the curvature that round-off leaves, of either sign: down
// to -1e-12 of the stiffest vertex's, what is convex is as much of a minimum as double can tell.
static double round_off_of_curvature(const ruga_skin* skin) {
    double most = 0;
    const ruga_sparse* pattern = ruga_shell_pattern(skin->shell);
    for (int j = 0; j < skin->n; j++) {
        double area = skin->model->vertex_area[j / 3];
        most = area > 0 ? fmax(most, skin->stiffness[pattern->start[j]] / area) : most;
    }
    return 1e-12 * most;
}

// Closing gaps of round-off strains a skin of 10 TPa enough to be far from equilibrium again. The certificate's factor
// brings it back without opening them; what moved is no longer where that was made, and a restart makes it anew.
static ruga_status settle(ruga_skin* skin, double* x, double target, ruga_skin_result* result) {
    double *gradient = ruga_skin_vector(skin, SETTLING), *move = ruga_skin_vector(skin, MOVE);
    for (int k = 0; k <= MAX_SETTLING; k++) {
        RUGA_TRY(ruga_skin_energy(skin, x, &result->terms, gradient));
        RUGA_TRY(ruga_skin_project(skin, gradient, gradient));
        result->residual = ruga_skin_residual(skin, gradient, &result->terms);
        if (result->residual <= target || k == MAX_SETTLING) {
            break;
        }
        RUGA_TRY(ruga_skin_solve(skin, gradient, move));
        for (int i = 0; i < skin->n; i++) {
            x[i] -= move[i];
        }
        skin->factor_exact = false;
        ruga_skin_follow(skin, x);
    }
    return RUGA_OK;
}

ruga_status ruga_skin_certify(ruga_skin* skin, double* x, bool certify, double tolerance, double* target,
                              double* gradient, ruga_skin_result* result, bool* done) {
    *done = true;
    // Each iteration lets gaps grow by the round-off of the positions, and there may be thousands. The factor that
    // is kept is that of what is left.
    RUGA_TRY(ruga_skin_restore(skin, x));
    if (!certify) {
        result->outcome = RUGA_OUTCOME_MINIMUM;
        return RUGA_OK;
    }
    RUGA_TRY(ruga_skin_factor(skin, x, 0, 0));
    skin->work.certificates++;
    const double* along = NULL; // a direction of negative curvature
    double round_off = round_off_of_curvature(skin);
    if (!skin->factor_right) {
        RUGA_TRY(ruga_negative_curvature_of_factor(skin, round_off, &along));
    }
    if (!skin->factor_right && !along) {
        RUGA_TRY(ruga_skin_refactor(skin, round_off));
    }
    if (skin->factor_right) {
        result->outcome = RUGA_OUTCOME_MINIMUM;
        RUGA_TRY(skin->m > 0 ? settle(skin, x, *target, result) : RUGA_OK);
        skin->factor_right = skin->factor_exact; // that of a shifted matrix, or of another state, is not kept
        return RUGA_OK;
    }
    bool moved;
    RUGA_TRY(ruga_skin_energy(skin, x, &result->terms, gradient));
    RUGA_TRY(ruga_negative_curvature_step(skin, along, x, &result->terms, gradient, &moved));
    if (along && !moved) {
        RUGA_TRY(ruga_negative_curvature_step(skin, NULL, x, &result->terms, gradient, &moved));
    }
    if (!moved && *target <= 2e-3 * tolerance) {
        result->outcome = RUGA_OUTCOME_SADDLE;
        return RUGA_OK;
    }
    *target *= moved ? 1 : 0.1;
    *done = false;
    return RUGA_OK;
}

ruga_status ruga_skin_minimize(ruga_skin* skin, double* x, double tolerance, bool certify,
                               ruga_skin_result* result) {
    *result = (ruga_skin_result){.outcome = RUGA_OUTCOME_NOT_CONVERGED};
    skin->single_serves = skin->single_proves = true;
    switch (skin->model->solver.method) {
    case RUGA_METHOD_PAPER:
        return ruga_paper_minimize(skin, x, tolerance, result);
    case RUGA_METHOD_NEWTON:
        RUGA_TRY(ruga_skin_restore(skin, x));
        ruga_skin_follow(skin, x);
        RUGA_TRY(ruga_newton_minimize(skin, x, tolerance, certify, false, result));
        break;
    case RUGA_METHOD_DEFAULT:
    case RUGA_METHOD_QUASI_NEWTON:
        RUGA_TRY(ruga_skin_restore(skin, x));
        ruga_skin_follow(skin, x);
        RUGA_TRY(ruga_quasi_newton_minimize(skin, x, tolerance, certify, result));
        break;
    }
    return result->outcome == RUGA_OUTCOME_MINIMUM ? RUGA_OK : ruga_skin_restore(skin, x);
}
