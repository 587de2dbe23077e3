// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Newton on the energy over the free components. Held ones are eliminated, so a Cholesky factorisation of the
// exact Hessian succeeds exactly where the state is a strict minimum along all free directions: that is the
// certificate. Where it fails, s diag(K at rest) is added with the least s = 4^k s0 that makes it succeed;
// the direction descends then, and Armijo's rule on the energy decides its length. The flat compressed state
// is an equilibrium at any load: inverse iterations with the shifted factor give a direction v with v.Kv < 0,
// along which the energy falls.
#include "solver/volume.h"

#include "core/memory.h"
#include "core/progress.h"
#include "core/random.h"
#include "solver/linear.h"

#include <math.h>
#include <string.h>

enum {
    MAX_ITERATIONS = 200,
    MAX_ESCAPES = 8,
    MAX_BACKTRACKS = 30,
    INVERSE_ITERATIONS = 24,
    MAX_LENGTHS = 14
};

static const double SHIFT_START = 1e-8, SHIFT_MAX = 1e4;

struct ruga_volume_solver {
    const ruga_volume* volume;
    int64_t seed;
    int n;              // free components
    int* free;          // [n] index into u
    ruga_sparse matrix; // of the free components, with values
    int* source;        // like its entries: position in the volume's pattern
    double* hessian;    // [entries of the volume's pattern]
    double* diagonal;   // [n] of the Hessian at rest
    ruga_factor* factor;
    double *gradient, *trial_gradient, *trial; // [N][3]
    double *side, *direction, *image;          // [n]
    int factorizations;
};

//---- create ----

// The rows and columns of the free components; their order is kept, so rows still ascend.
static ruga_status restrict_pattern(ruga_volume_solver* s, const int* place) {
    const ruga_sparse* full = &s->volume->pattern;
    int count = 0;
    s->matrix = (ruga_sparse){.rows = s->n, .columns = s->n};
    RUGA_TRY(RUGA_NEW(s->matrix.start, s->n + 1));
    RUGA_TRY(RUGA_NEW(s->matrix.index, full->start[full->columns]));
    RUGA_TRY(RUGA_NEW(s->matrix.value, full->start[full->columns]));
    RUGA_TRY(RUGA_NEW(s->source, full->start[full->columns]));
    for (int j = 0; j < s->n; j++) {
        s->matrix.start[j] = count;
        for (int p = full->start[s->free[j]]; p < full->start[s->free[j] + 1]; p++) {
            if (place[full->index[p]] >= 0) {
                s->matrix.index[count] = place[full->index[p]];
                s->source[count++] = p;
            }
        }
    }
    s->matrix.start[s->n] = count;
    return RUGA_OK;
}

static ruga_status create_factor(ruga_volume_solver* s) {
    int* node_start = NULL;
    int nodes = 0;
    RUGA_TRY(RUGA_NEW(node_start, s->n + 1));
    for (int i = 0; i < s->n; i++) {
        if (i == 0 || s->free[i] / 3 != s->free[i - 1] / 3) {
            node_start[nodes++] = i;
        }
    }
    node_start[nodes] = s->n;
    ruga_status status =
        ruga_factor_create(RUGA_FACTOR_CHOLESKY, &s->matrix, nodes, node_start, NULL, &s->factor);
    ruga_release(node_start);
    return status;
}

static ruga_status allocate(ruga_volume_solver* s) {
    int components = 3 * s->volume->node_count;
    RUGA_TRY(RUGA_NEW(s->hessian, s->volume->pattern.start[s->volume->pattern.columns]));
    RUGA_TRY(RUGA_NEW(s->diagonal, s->n));
    RUGA_TRY(RUGA_NEW(s->gradient, components));
    RUGA_TRY(RUGA_NEW(s->trial_gradient, components));
    RUGA_TRY(RUGA_NEW_ZERO(s->trial, components));
    RUGA_TRY(RUGA_NEW(s->side, s->n));
    RUGA_TRY(RUGA_NEW(s->direction, s->n));
    return RUGA_NEW(s->image, s->n);
}

static ruga_status measure_diagonal(ruga_volume_solver* s) {
    double energy;
    RUGA_TRY(ruga_volume_energy(s->volume, s->trial, &energy, NULL, s->hessian, NULL)); // trial is zero: rest
    for (int i = 0; i < s->n; i++) {
        s->diagonal[i] = s->hessian[s->volume->pattern.start[s->free[i]]];
    }
    return RUGA_OK;
}

ruga_status ruga_volume_solver_create(const ruga_volume* volume, const bool* held, int64_t seed,
                                      ruga_volume_solver** solver) {
    ruga_status status = RUGA_OK;
    ruga_volume_solver* s = NULL;
    int* place = NULL;
    *solver = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(s, 1));
    s->volume = volume;
    s->seed = seed;
    RUGA_TRY_DONE(RUGA_NEW(place, 3 * volume->node_count));
    RUGA_TRY_DONE(RUGA_NEW(s->free, 3 * volume->node_count));
    for (int i = 0; i < 3 * volume->node_count; i++) {
        place[i] = held[i] ? -1 : s->n;
        if (!held[i]) {
            s->free[s->n++] = i;
        }
    }
    RUGA_TRY_DONE(restrict_pattern(s, place));
    RUGA_TRY_DONE(create_factor(s));
    RUGA_TRY_DONE(allocate(s));
    RUGA_TRY_DONE(measure_diagonal(s));
    *solver = s;
done:
    ruga_release(place);
    if (status != RUGA_OK) {
        ruga_volume_solver_destroy(&s);
    }
    return status;
}

void ruga_volume_solver_destroy(ruga_volume_solver** solver) {
    ruga_volume_solver* s = *solver;
    if (s) {
        ruga_factor_destroy(&s->factor);
        ruga_sparse_clear(&s->matrix);
        ruga_release(s->free);
        ruga_release(s->source);
        ruga_release(s->hessian);
        ruga_release(s->diagonal);
        ruga_release(s->gradient);
        ruga_release(s->trial_gradient);
        ruga_release(s->trial);
        ruga_release(s->side);
        ruga_release(s->direction);
        ruga_release(s->image);
        ruga_release(s);
    }
    *solver = NULL;
}

//---- factor ----

static double dot(int n, const double* a, const double* b) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

static void take_matrix(ruga_volume_solver* s) {
    for (int p = 0; p < s->matrix.start[s->n]; p++) {
        s->matrix.value[p] = s->hessian[s->source[p]];
    }
}

static ruga_status factor_shifted(ruga_volume_solver* s, double shift, bool* definite) {
    ruga_factor_info info;
    for (int i = 0; i < s->n; i++) {
        s->matrix.value[s->matrix.start[i]] =
            s->hessian[s->source[s->matrix.start[i]]] + shift * s->diagonal[i];
    }
    RUGA_TRY(ruga_factor_numeric(s->factor, s->matrix.value, &info));
    s->factorizations++;
    *definite = info.success;
    return RUGA_OK;
}

// Factorises with no shift or the least that serves.
static ruga_status factor(ruga_volume_solver* s, double* shift) {
    bool definite;
    take_matrix(s);
    *shift = 0;
    RUGA_TRY(factor_shifted(s, 0, &definite));
    while (!definite && *shift < SHIFT_MAX) {
        *shift = fmax(SHIFT_START, 4 * *shift);
        RUGA_TRY(factor_shifted(s, *shift, &definite));
    }
    return definite ? RUGA_OK
                    : ruga_fail(RUGA_LIBRARY, "volume: no shift of its stiffness makes it positive definite");
}

// Energy, gradient (over all components) and its relative size over the free ones; the Hessian where wanted.
static ruga_status evaluate(ruga_volume_solver* s, const double* u, bool hessian, double* gradient,
                            double* energy, double* residual) {
    double square, sum = 0;
    RUGA_TRY(ruga_volume_energy(s->volume, u, energy, gradient, hessian ? s->hessian : NULL, &square));
    for (int i = 0; i < s->n; i++) {
        sum += gradient[s->free[i]] * gradient[s->free[i]];
    }
    *residual = square > 0 ? sqrt(sum / square) : 0;
    return RUGA_OK;
}

static void add(const ruga_volume_solver* s, const double* u, double length, double* sum) {
    memcpy(sum, u, (size_t)s->volume->node_count * 3 * sizeof *sum);
    for (int i = 0; i < s->n; i++) {
        sum[s->free[i]] += length * s->direction[i];
    }
}

//---- steps ----

// direction of largest component 1 with d.Kd < 0, by inverse iterations (K + s D)^-1 D on a random start.
static ruga_status find_negative(ruga_volume_solver* s, double shift, int salt, bool* found) {
    ruga_random random = {.state = (uint64_t)s->seed * 0x9e3779b97f4a7c15u + (uint64_t)salt};
    *found = false;
    for (int i = 0; i < s->n; i++) {
        s->matrix.value[s->matrix.start[i]] -= shift * s->diagonal[i];
        s->direction[i] = ruga_random_uniform(&random) - 0.5;
    }
    for (int k = 0; k < INVERSE_ITERATIONS && !*found; k++) {
        double largest = 0;
        for (int i = 0; i < s->n; i++) {
            s->side[i] = s->diagonal[i] * s->direction[i];
        }
        RUGA_TRY(ruga_factor_solve(s->factor, s->side, s->direction));
        for (int i = 0; i < s->n; i++) {
            largest = fmax(largest, fabs(s->direction[i]));
        }
        for (int i = 0; i < s->n && largest > 0; i++) {
            s->direction[i] /= largest;
        }
        ruga_sparse_multiply_symmetric(&s->matrix, s->direction, s->image);
        *found = k >= 3 && dot(s->n, s->direction, s->image) < 0;
    }
    return RUGA_OK;
}

// Down along a direction of negative curvature, from a tenth of the skin's thickness on in doubled or halved
// lengths to the one of least energy.
static ruga_status escape(ruga_volume_solver* s, double shift, double* u, double energy, int salt,
                          bool* moved) {
    const ruga_spline* z = &s->volume->axis[2];
    double length = 0.1 * (z->grid[z->cells] - z->grid[s->volume->interface]), best = energy, slope = 0,
           kept = 0;
    bool found;
    *moved = false;
    RUGA_TRY(find_negative(s, shift, salt, &found));
    if (!found) {
        return RUGA_OK;
    }
    for (int i = 0; i < s->n; i++) {
        slope += s->direction[i] * s->gradient[s->free[i]];
    }
    length = slope > 0 ? -length : length;
    for (int k = 0; k < MAX_LENGTHS; k++) {
        double trial;
        add(s, u, length, s->trial);
        RUGA_TRY(ruga_volume_energy(s->volume, s->trial, &trial, NULL, NULL, NULL));
        bool falls = trial < best;
        if (kept != 0 && !falls) {
            break;
        }
        kept = falls ? length : kept;
        best = falls ? trial : best;
        length *= falls ? 2 : 0.3;
    }
    *moved = kept != 0;
    add(s, u, kept, s->trial);
    memcpy(u, s->trial, (size_t)s->volume->node_count * 3 * sizeof *u);
    return RUGA_OK;
}

// Armijo's rule along `direction`; near the minimum, where the change of energy is round-off, the slope
// decides.
static ruga_status search(ruga_volume_solver* s, double* u, double energy, bool* moved) {
    double slope = 0, b = 1;
    *moved = false;
    for (int i = 0; i < s->n; i++) {
        slope += s->direction[i] * s->gradient[s->free[i]];
    }
    for (int k = 0; k < MAX_BACKTRACKS && slope < 0 && !*moved; k++) {
        double trial, residual, end = 0;
        add(s, u, b, s->trial);
        RUGA_TRY(evaluate(s, s->trial, false, s->trial_gradient, &trial, &residual));
        for (int i = 0; i < s->n; i++) {
            end += s->direction[i] * s->trial_gradient[s->free[i]];
        }
        *moved = trial <= energy + 1e-4 * b * slope ||
                 (fabs(trial - energy) < 1e-11 * fabs(energy) && fabs(end) < 0.9 * fabs(slope));
        double curvature = trial - energy - b * slope;
        double guess = isfinite(curvature) && curvature > 0 ? -0.5 * slope * b * b / curvature : 0.1 * b;
        b = *moved ? b : fmin(fmax(guess, 0.1 * b), 0.5 * b);
    }
    if (*moved) {
        memcpy(u, s->trial, (size_t)s->volume->node_count * 3 * sizeof *u);
    }
    return RUGA_OK;
}

ruga_status ruga_volume_solve(ruga_volume_solver* s, double tolerance, double* u, ruga_volume_report* r) {
    int before = s->factorizations;
    *r = (ruga_volume_report){.outcome = RUGA_OUTCOME_NOT_CONVERGED};
    for (bool moved = true; moved && r->iterations < MAX_ITERATIONS; r->iterations++) {
        double shift;
        RUGA_TRY(ruga_progress("static solve", 0));
        RUGA_TRY(evaluate(s, u, true, s->gradient, &r->energy, &r->residual));
        RUGA_TRY(factor(s, &shift));
        r->factorizations = s->factorizations - before;
        bool small = r->residual <= tolerance;
        if (small && shift == 0) {
            r->outcome = RUGA_OUTCOME_MINIMUM;
            return RUGA_OK;
        }
        if (small) {
            moved = false;
            if (r->escapes++ < MAX_ESCAPES) {
                RUGA_TRY(escape(s, shift, u, r->energy, r->escapes, &moved));
            }
            r->outcome = moved ? RUGA_OUTCOME_NOT_CONVERGED : RUGA_OUTCOME_SADDLE;
            continue;
        }
        for (int i = 0; i < s->n; i++) {
            s->side[i] = -s->gradient[s->free[i]];
        }
        RUGA_TRY(ruga_factor_solve(s->factor, s->side, s->direction));
        RUGA_TRY(search(s, u, r->energy, &moved));
    }
    return RUGA_OK;
}

ruga_status ruga_volume_is_stable(ruga_volume_solver* s, const double* u, bool* stable, double* residual) {
    double energy, size;
    RUGA_TRY(evaluate(s, u, true, s->gradient, &energy, &size));
    take_matrix(s);
    RUGA_TRY(factor_shifted(s, 0, stable));
    if (residual) {
        *residual = size;
    }
    return RUGA_OK;
}
