// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What iterations with a kept factor can save: MINRES of Belos against a factorisation and a solve, and an
// inertia by Lanczos against that of a factorisation. The matrices are those of frames of bench.c, at the
// state in which the last frame leaves the skin, carried along (start), and at the frame's minimum (end); the
// factor is that of the last frame's minimum, and the right-hand side the gradient at the start.
// Preconditioners:
//     absolute    L |D| L^T of the kept factor, on [K H^T; H 0]
//     constraint  the kept factor in single precision on the null space of H (ruga_skin_solve_rough)
//     clamped     the same from a factor at the same place, half of its compressive stiffness taken out
//     bfbt        diag(K_c, S) with K_c clamped to be convex (CHOLMOD) and S^-1 = (H H^T)^-1 H K_c H^T
//                 (H H^T)^-1 (Elman, Howle, Shadid, Shuttleworth, Tuminaro 2006), on [K H^T; H 0]
// Lanczos: the process behind MINRES from a random vector, with the clamped factor of the same state, which
// is the best that a frame can have kept; a negative pivot of its tridiagonal matrix proves negative
// curvature, none proves nothing. On states between start and end as well. Times are processor time, one
// thread.
// Above 30,000 unknowns only the two that converge, at the end.
//     bench_iterative [FRAMES [UNKNOWNS[:CLUSTERS] ...]]
#include "core/memory.h"
#include "core/parallel.h"
#include "core/random.h"
#include "ruga/ruga.h"
#include "solver/belos_shim.h"
#include "solver/model.h"
#include "solver/state.h"
#include "tests/bench/pillow.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    WARM = 5,
    MAX_FRAMES = 20,
    KINDS = 4,
    MINRES_MAX = 400,
    LANCZOS_MAX = 100,
    PLACES = 6,
    PLACE_MAX = PLACES * MAX_FRAMES
};
enum { START, END, LARGE = 30000 };

static const char* const names[KINDS] = {"absolute", "constraint", "clamped", "bfbt"};
static const double tolerance = 1e-4;

typedef struct solves {
    int count, converged;
    double iterations[MAX_FRAMES], seconds[MAX_FRAMES]; // over a factorisation and a solve
} solves;

typedef struct bench {
    ruga_mesh mesh;
    ruga_model* model;
    ruga_state* state;
    ruga_skin* skin;
    ruga_factor* convex; // CHOLMOD of K_c
    ruga_sparse clamped; // K_c
    double *last, *start, *end, *place, *gradient, *side, *answer, *work, *lanczos, *embedded;
    solves solved[2][KINDS];
    double factor[MAX_FRAMES], solve[MAX_FRAMES], rough[MAX_FRAMES];
    double detected[PLACE_MAX]; // Lanczos steps until negative curvature was seen
    int wrong, missed, right, false_alarms;
} bench;

static double processor(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

// ---- operators -----------------------------------------------------------------------------------------

static ruga_status apply_system(const double* x, double* y, void* context) {
    ruga_sparse_multiply_symmetric(&((bench*)context)->skin->kkt, x, y);
    return RUGA_OK;
}

static ruga_status apply_reduced(const double* x, double* y, void* context) {
    ruga_skin* skin = ((bench*)context)->skin;
    ruga_skin_multiply(skin, x, y);
    return ruga_skin_project(skin, y, y);
}

static ruga_status precondition_absolute(const double* x, double* y, void* context) {
    return ruga_factor_solve_absolute(((bench*)context)->skin->factor, x, y);
}

static ruga_status precondition_constraint(const double* x, double* y, void* context) {
    return ruga_skin_solve_rough(((bench*)context)->skin, x, y);
}

static ruga_status solve_gram(bench* b, double* y) {
    ruga_skin* skin = b->skin;
    for (int axis = 0; axis < 3; axis++) {
        for (int r = 0; r < skin->m / 3; r++) {
            b->work[r] = y[3 * r + axis];
        }
        RUGA_TRY(ruga_factor_solve(skin->gram[0], b->work, b->work));
        for (int r = 0; r < skin->m / 3; r++) {
            y[3 * r + axis] = b->work[r];
        }
    }
    return RUGA_OK;
}

static ruga_status precondition_bfbt(const double* x, double* y, void* context) {
    bench* b = context;
    ruga_skin* skin = b->skin;
    int n = skin->n, m = skin->m;
    memcpy(y + n, x + n, (size_t)m * sizeof *y);
    RUGA_TRY(solve_gram(b, y + n));
    memset(y, 0, (size_t)n * sizeof *y);
    ruga_clusters_apply_transpose(&b->model->clusters, y + n, y);
    ruga_sparse_multiply_symmetric(&b->clamped, y, b->work);
    ruga_clusters_apply(&b->model->clusters, b->work, y + n);
    RUGA_TRY(solve_gram(b, y + n));
    return ruga_factor_solve(b->convex, x, y);
}

// ---- MINRES --------------------------------------------------------------------------------------------

static ruga_status run_minres(bench* b, int kind, int where, double direct) {
    static ruga_operator* const preconditioners[KINDS] = {precondition_absolute, precondition_constraint,
                                                          precondition_constraint, precondition_bfbt};
    bool reduced = kind == 1 || kind == 2;
    int size = reduced ? b->skin->n : b->skin->size;
    solves* s = &b->solved[where][kind];
    ruga_minres_report report;
    memset(b->side, 0, (size_t)b->skin->size * sizeof *b->side);
    memcpy(b->side, b->gradient, (size_t)b->skin->n * sizeof *b->side);
    memset(b->answer, 0, (size_t)b->skin->size * sizeof *b->answer);
    double begin = processor();
    RUGA_TRY(ruga_belos_minres(size, reduced ? apply_reduced : apply_system, preconditioners[kind], b,
                               b->side, b->answer, tolerance, MINRES_MAX, &report));
    s->seconds[s->count] = (processor() - begin) / direct;
    s->iterations[s->count++] = report.iterations;
    s->converged += report.converged;
    return RUGA_OK;
}

static ruga_status run_all(bench* b, int where, int frame) {
    const double* x = where == START ? b->start : b->end;
    double direct = b->factor[frame] + b->solve[frame];
    for (int kind = 0; kind < KINDS; kind++) {
        bool reduced = kind == 1 || kind == 2;
        if ((kind == 3 && !b->convex) || (!reduced && b->skin->n > LARGE)) {
            continue;
        }
        if (kind == 0) {
            RUGA_TRY(ruga_skin_factor(b->skin, b->last, 0, 0));
        } else if (kind == 2) {
            RUGA_TRY(ruga_skin_factor(b->skin, b->last, 0.5, 0));
        } else if (kind == 3) {
            ruga_factor_info info;
            RUGA_TRY(ruga_skin_assemble(b->skin, b->last, 1));
            memcpy(b->clamped.value, b->skin->stiffness,
                   (size_t)b->clamped.start[b->skin->n] * sizeof *b->clamped.value);
            RUGA_TRY(ruga_factor_numeric(b->convex, b->clamped.value, &info));
            if (!info.success) {
                continue;
            }
        }
        RUGA_TRY(ruga_skin_assemble(b->skin, x, 0));
        RUGA_TRY(run_minres(b, kind, where, direct));
    }
    return RUGA_OK;
}

// ---- Lanczos -------------------------------------------------------------------------------------------

// Steps until a direction of negative curvature is found, the one that a negative pivot of the tridiagonal
// matrix belongs to (conjugate gradients without their right-hand side); 0 where none is.
static ruga_status run_lanczos(bench* b, uint64_t seed, int* steps) {
    ruga_skin* skin = b->skin;
    ruga_random random = {seed};
    int n = skin->n;
    double *old = b->lanczos, *v = old + n, *r = v + n, *z = r + n, *image = z + n, *direction = image + n;
    double beta = 0, pivot = 1;
    *steps = 0;
    for (int i = 0; i < n; i++) {
        r[i] = ruga_random_uniform(&random) - 0.5;
        v[i] = 0;
    }
    RUGA_TRY(ruga_skin_project(skin, r, r));
    for (int k = 1; k <= LANCZOS_MAX; k++) {
        RUGA_TRY(ruga_skin_solve_rough(skin, r, z));
        double next = sqrt(fmax(ruga_dot_product(n, r, z), 0)), alpha = 0;
        if (next == 0) {
            return RUGA_OK;
        }
        for (int i = 0; i < n; i++) {
            old[i] = v[i];
            v[i] = r[i] / next;
            z[i] /= next;
        }
        beta = k > 1 ? next : 0;
        ruga_skin_multiply(skin, z, image);
        RUGA_TRY(ruga_skin_project(skin, image, image));
        alpha = ruga_dot_product(n, z, image);
        for (int i = 0; i < n; i++) {
            direction[i] = z[i] - (k > 1 ? beta / pivot : 0) * direction[i];
        }
        pivot = alpha - beta * beta / pivot;
        if (pivot < 0) {
            // Where orthogonality is lost the matrix has eigenvalues of its own: the direction itself is
            // asked.
            ruga_skin_multiply(skin, direction, image);
            *steps = ruga_dot_product(n, direction, image) < 0 ? k : 0;
            return RUGA_OK;
        }
        for (int i = 0; i < n; i++) {
            r[i] = image[i] - alpha * v[i] - beta * old[i];
        }
    }
    return RUGA_OK;
}

static ruga_status try_lanczos(bench* b, int frame) {
    static const double places[PLACES] = {0, 0.5, 0.8, 0.9, 0.97, 1};
    for (int p = 0; p < PLACES; p++) {
        int steps;
        for (int i = 0; i < b->skin->n; i++) {
            b->place[i] = b->start[i] + places[p] * (b->end[i] - b->start[i]);
        }
        RUGA_TRY(ruga_skin_factor(b->skin, b->place, 0, 0));
        bool is_minimum = b->skin->factor_right;
        RUGA_TRY(ruga_skin_factor_convex(b->skin, b->place));
        RUGA_TRY(ruga_skin_assemble(b->skin, b->place, 0));
        RUGA_TRY(run_lanczos(b, (uint64_t)(1 + frame * PLACES + p), &steps));
        if (is_minimum) {
            b->right++;
            b->false_alarms += steps > 0;
        } else if (steps == 0) {
            b->wrong++;
            b->missed++;
        } else {
            b->detected[b->wrong++ - b->missed] = steps;
        }
    }
    return RUGA_OK;
}

// ---- one case ------------------------------------------------------------------------------------------

static ruga_status create(bench* b, int unknowns, int clusters) {
    ruga_model_def def = ruga_default_model_def();
    ruga_keyframe_def keys[3];
    RUGA_TRY(bench_pillow_mesh(unknowns, &b->mesh));
    bench_pillow_def(&b->mesh, &def);
    bench_pillow_motion(&def, WARM, MAX_FRAMES, keys);
    def.coupling.count = clusters;
    RUGA_TRY(ruga_model_create(&def, &b->model));
    RUGA_TRY(ruga_state_create(b->model, &b->state));
    b->skin = b->state->skin;
    size_t n = (size_t)b->skin->n, size = (size_t)b->skin->size;
    double** const vectors[] = {&b->last,     &b->start, &b->end,    &b->place, &b->gradient,
                                &b->embedded, &b->side,  &b->answer, &b->work};
    for (size_t k = 0; k < sizeof vectors / sizeof vectors[0]; k++) {
        RUGA_TRY(RUGA_NEW_ZERO(*vectors[k], size));
    }
    RUGA_TRY(RUGA_NEW_ZERO(b->lanczos, 6 * n));
    const ruga_sparse* pattern = ruga_shell_pattern(b->skin->shell);
    b->clamped = *pattern;
    b->clamped.value = NULL;
    RUGA_TRY(RUGA_NEW(b->clamped.value, pattern->start[n]));
    if (b->skin->m) {
        RUGA_TRY(ruga_factor_create(RUGA_FACTOR_CHOLESKY, pattern, 0, NULL, NULL, &b->convex));
    }
    return RUGA_OK;
}

static void destroy(bench* b) {
    double* const vectors[] = {b->last, b->start,  b->end,  b->place,   b->gradient,     b->embedded,
                               b->side, b->answer, b->work, b->lanczos, b->clamped.value};
    for (size_t k = 0; k < sizeof vectors / sizeof vectors[0]; k++) {
        ruga_release(vectors[k]);
    }
    ruga_factor_destroy(&b->convex);
    ruga_state_destroy(&b->state);
    ruga_model_destroy(&b->model);
    ruga_mesh_clear(&b->mesh);
}

static ruga_status measure_frame(bench* b, int frame) {
    ruga_skin* skin = b->skin;
    ruga_skin_terms terms;
    size_t bytes = (size_t)skin->n * sizeof(double);
    memcpy(b->last, b->state->x, bytes);
    memcpy(b->embedded, b->state->embedded, bytes);
    ruga_set_threads(0);
    RUGA_TRY(ruga_state_step(b->model, b->state, NULL));
    ruga_set_threads(1);
    memcpy(b->end, b->state->x, bytes);
    for (int i = 0; i < skin->n; i++) {
        b->start[i] = b->last[i] + b->state->embedded[i] - b->embedded[i];
    }
    RUGA_TRY(ruga_skin_energy(skin, b->start, &terms, b->gradient));
    RUGA_TRY(ruga_skin_project(skin, b->gradient, b->gradient));
    RUGA_TRY(ruga_skin_assemble(skin, b->end, 0));
    double begin = processor();
    RUGA_TRY(ruga_skin_refactor(skin, 0));
    b->factor[frame] = processor() - begin;
    begin = processor();
    RUGA_TRY(ruga_skin_solve(skin, b->gradient, b->answer));
    b->solve[frame] = processor() - begin;
    begin = processor();
    RUGA_TRY(ruga_skin_solve_rough(skin, b->gradient, b->answer));
    b->rough[frame] = processor() - begin;
    if (skin->n <= LARGE) {
        RUGA_TRY(run_all(b, START, frame));
        RUGA_TRY(try_lanczos(b, frame));
    }
    RUGA_TRY(run_all(b, END, frame));
    RUGA_TRY(ruga_skin_factor(skin, b->end, 0, 0));
    return RUGA_OK;
}

static void report(bench* b, int frames) {
    double worst = 0, found = b->wrong - b->missed;
    double factor = bench_median(frames, b->factor), rough = bench_median(frames, b->rough);
    printf("\n%d unknowns, %d clusters: factorisation %.4g s, solve %.4g s, rough solve %.4g s\n", b->skin->n,
           b->skin->m / 3, factor, bench_median(frames, b->solve), rough);
    printf("%-6s %-11s %9s %9s | %s\n", "matrix", "MINRES", "converged", "iterations",
           "time over a factorisation and a solve: median, worst");
    for (int where = START; where <= END; where++) {
        for (int kind = 0; kind < KINDS; kind++) {
            solves* s = &b->solved[where][kind];
            double middle = bench_median(s->count, s->seconds);
            if (s->count) {
                printf("%-6s %-11s %6d/%-2d %9.0f  | %.2f %.2f\n", where ? "end" : "start", names[kind],
                       s->converged, s->count, bench_median(s->count, s->iterations), middle,
                       s->seconds[s->count - 1]);
            }
        }
    }
    for (int k = 0; k < found; k++) {
        worst = fmax(worst, b->detected[k]);
    }
    if (b->right + b->wrong == 0) {
        return;
    }
    printf("Lanczos: %d minima, %d false alarms; %d saddles, %d missed in %d steps, seen after %.0f steps, "
           "at most %.0f; "
           "a step costs %.3f factorisations\n",
           b->right, b->false_alarms, b->wrong, b->missed, LANCZOS_MAX, bench_median((int)found, b->detected),
           worst, rough / factor);
    (void)fflush(stdout);
}

static ruga_status bench_case(int unknowns, int clusters, int frames) {
    ruga_status status = RUGA_OK;
    static bench b;
    memset(&b, 0, sizeof b);
    RUGA_TRY_DONE(create(&b, unknowns, clusters));
    ruga_set_threads(0);
    for (int k = 0; k < WARM; k++) {
        RUGA_TRY_DONE(ruga_state_step(b.model, b.state, NULL));
    }
    for (int k = 0; k < frames; k++) {
        RUGA_TRY_DONE(measure_frame(&b, k));
    }
    report(&b, frames);
done:
    destroy(&b);
    return status;
}

int main(int argc, char** argv) {
    static const char* const usual[] = {"3138", "12534"};
    int frames = argc > 1 ? atoi(argv[1]) : 4, count = argc > 2 ? argc - 2 : 2;
    frames = frames < 1 ? 1 : frames > MAX_FRAMES ? MAX_FRAMES : frames;
    for (int k = 0; k < count; k++) {
        int unknowns = 0, clusters = 0;
        (void)sscanf(argc > 2 ? argv[2 + k] : usual[k], "%d:%d", &unknowns, &clusters);
        if (bench_case(unknowns, clusters, frames) != RUGA_OK) {
            (void)fprintf(stderr, "%s\n", ruga_last_error());
            return 1;
        }
    }
    return 0;
}
