// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Linear algebra by itself: factor and solves of the pillow's KKT matrix [K H^T; H 0] (bench.c), 1 %
// compressed into waves of its own wavelength, beside CHOLMOD of K + W without clusters. One line per size
// and kind: size, fill, work and rate, medians of seconds, all ratios to the Cholesky factorisation of the
// same run; `singl`, a factorisation in single precision, to the one in double.
#include "core/memory.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/random.h"
#include "core/vec3.h"
#include "ruga/ruga.h"
#include "solver/model.h"
#include "solver/state.h"
#include "tests/bench/pillow.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MAX_REPEATS = 25, SOLVES = 5 };

static void fill(ruga_model_def* def, const ruga_mesh* mesh, ruga_keyframe_def* key) {
    bench_pillow_def(mesh, def);
    *key = ruga_default_keyframe_def();
    def->keyframes = key;
    def->keyframe_count = 1;
    def->frames = 1;
}

typedef struct matrix {
    const ruga_sparse* lower;
    int nodes;
    int* node_start;
    bool* last;
    int multipliers; // unknowns, at the end
} matrix;

typedef struct figures {
    double analyse, factor[2], single, solve[2], rough[2], residual, rough_residual, bytes;
    ruga_factor_info info;
} figures;

// One right-hand side, the forces of random displacements: none on the multipliers.
typedef ruga_status solver(ruga_factor* factor, const double* b, double* x);
static ruga_status solve_once(ruga_factor* f, solver* solve, const matrix* a, double* b, double* x,
                              double* residual) {
    ruga_random random = {7};
    int n = a->lower->columns;
    double sum = 0, size = 0;
    for (int i = 0; i < n; i++) {
        x[i] = 2 * ruga_random_uniform(&random) - 1;
    }
    ruga_sparse_multiply_symmetric(a->lower, x, b);
    for (int i = n - a->multipliers; i < n; i++) {
        b[i] = 0;
    }
    RUGA_TRY(solve(f, b, x));
    ruga_sparse_multiply_symmetric(a->lower, x, x + n);
    for (int i = 0; i < n; i++) {
        sum += (b[i] - x[n + i]) * (b[i] - x[n + i]);
        size += b[i] * b[i];
    }
    *residual = sqrt(sum / size);
    return RUGA_OK;
}

// One thread: seconds of the processor, which other processes disturb less; two: seconds on the clock.
static double seconds(int threads) {
    return threads > 1 ? ruga_clock() : (double)clock() / CLOCKS_PER_SEC;
}

static ruga_status measure(ruga_factor_kind kind, const matrix* a, int repeats, figures* f) {
    ruga_status status = RUGA_OK;
    ruga_factor* factor = NULL;
    int n = a->lower->columns;
    double *b = NULL, *x = NULL, factors[MAX_REPEATS], singles[MAX_REPEATS], solves[MAX_REPEATS * SOLVES],
           roughs[MAX_REPEATS * SOLVES];
    RUGA_TRY_DONE(RUGA_NEW_ZERO(b, n));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(x, 2 * (size_t)n));
    double begin = ruga_clock();
    RUGA_TRY_DONE(ruga_factor_create(kind, a->lower, a->nodes, a->node_start, a->last, &factor));
    f->analyse = ruga_clock() - begin;
    RUGA_TRY_DONE(ruga_factor_numeric(factor, a->lower->value, &f->info)); // allocates
    for (int threads = 1; threads <= 2; threads++) {
        ruga_set_threads(threads);
        RUGA_TRY_DONE(solve_once(factor, ruga_factor_solve_rough, a, b, x, &f->rough_residual));
        RUGA_TRY_DONE(solve_once(factor, ruga_factor_solve, a, b, x, &f->residual));
        for (int k = 0; k < repeats; k++) {
            begin = seconds(threads);
            if (kind == RUGA_FACTOR_LDL_SINGLE) {
                RUGA_TRY_DONE(ruga_factor_numeric_single(factor, a->lower->value, &f->info));
            }
            singles[k] = seconds(threads) - begin;
            begin = seconds(threads);
            RUGA_TRY_DONE(ruga_factor_numeric(factor, a->lower->value, &f->info));
            factors[k] = seconds(threads) - begin;
            for (int s = 0; s < SOLVES; s++) {
                begin = seconds(threads);
                RUGA_TRY_DONE(ruga_factor_solve(factor, b, x));
                solves[k * SOLVES + s] = seconds(threads) - begin;
            }
            for (int s = 0; s < SOLVES; s++) {
                begin = seconds(threads);
                RUGA_TRY_DONE(ruga_factor_solve_rough(factor, b, x));
                roughs[k * SOLVES + s] = seconds(threads) - begin;
            }
        }
        f->factor[threads - 1] = bench_median(repeats, factors);
        f->single = threads == 1 ? bench_median(repeats, singles) : f->single;
        f->solve[threads - 1] = bench_median(repeats * SOLVES, solves);
        f->rough[threads - 1] = bench_median(repeats * SOLVES, roughs);
    }
    f->bytes = (double)ruga_factor_bytes(factor);
done:
    ruga_set_threads(0);
    ruga_factor_destroy(&factor);
    ruga_release(b);
    ruga_release(x);
    return status;
}

static void print(const char* name, const matrix* a, const figures* f, double unit) {
    double mega = 1e-6;
    printf("%-9s %7d %6.2f | %7.2f %7.2f %6.2f %6.2f | %6.3f | %7.4f %5.2f %5.2f %5.2f | %7.5f %5.1f %5.2f %8.1e | "
           "%7.5f %5.1f %5.2f %8.1e | %d %d %d\n",
           name, a->lower->columns, mega * a->lower->start[a->lower->columns], mega * f->info.entries,
           1e-9 * f->info.flops, 1e-9 * f->info.flops / f->factor[0], f->bytes / (8 * f->info.entries),
           f->analyse, f->factor[0], f->factor[0] / unit, f->factor[0] / f->factor[1],
           f->single / f->factor[0], f->solve[0],
           f->factor[0] / f->solve[0], f->solve[0] / f->solve[1], f->residual, f->rough[0],
           f->factor[0] / f->rough[0], f->rough[0] / f->rough[1], f->rough_residual, f->info.positive,
           f->info.negative, f->info.zero);
    (void)fflush(stdout);
}

// The skin's nodes: vertices and clusters by three; `clusters` false: vertices only.
static ruga_status list_nodes(const ruga_skin* skin, bool clusters, matrix* a) {
    int vertices = skin->n / 3;
    a->multipliers = clusters ? skin->m : 0;
    a->nodes = vertices + a->multipliers / 3;
    RUGA_TRY(RUGA_NEW(a->node_start, a->nodes + 1));
    RUGA_TRY(RUGA_NEW_ZERO(a->last, a->nodes));
    for (int i = 0; i <= a->nodes; i++) {
        a->node_start[i] = 3 * i;
    }
    for (int i = vertices; i < a->nodes; i++) {
        a->last[i] = true;
    }
    return RUGA_OK;
}

// x: waves of the height that use up the compression of their length.
static void make_waves(const ruga_skin* skin, double* x) {
    const double wavelength = 0.0657, amplitude = 5e-4;
    for (int v = 0; v < skin->n / 3; v++) {
        double* p = x + 3 * (size_t)v;
        p[2] += (p[2] > 0 ? amplitude : -amplitude) * sin(2 * RUGA_PI * p[0] / wavelength);
        p[0] *= 1 - pow(RUGA_PI * amplitude / wavelength, 2);
    }
}

static ruga_status bench_size(int unknowns, int repeats) {
    ruga_status status = RUGA_OK;
    ruga_mesh mesh = {0};
    ruga_model* model = NULL;
    ruga_state* state = NULL;
    matrix kkt = {0}, plain = {0};
    ruga_model_def def = ruga_default_model_def();
    ruga_keyframe_def key;
    figures cholesky = {0}, ldl = {0}, exact = {0}, unclustered = {0};
    RUGA_TRY_DONE(bench_pillow_mesh(unknowns, &mesh));
    fill(&def, &mesh, &key);
    RUGA_TRY_DONE(ruga_model_create(&def, &model));
    RUGA_TRY_DONE(ruga_state_create(model, &state));
    ruga_skin* skin = state->skin;
    make_waves(skin, state->x);
    RUGA_TRY_DONE(list_nodes(skin, true, &kkt));
    RUGA_TRY_DONE(list_nodes(skin, false, &plain));
    RUGA_TRY_DONE(ruga_skin_assemble(skin, state->x, 1));
    ruga_sparse k = *ruga_shell_pattern(skin->shell);
    k.value = skin->stiffness;
    for (int j = 0; j < skin->n; j++) {
        k.value[k.start[j]] += ruga_skin_shift_unit(model) * model->vertex_area[j / 3];
    }
    plain.lower = &k;
    kkt.lower = &skin->kkt;
    RUGA_TRY_DONE(measure(RUGA_FACTOR_CHOLESKY, &plain, repeats, &cholesky));
    print("cholmod", &plain, &cholesky, cholesky.factor[0]);
    RUGA_TRY_DONE(measure(RUGA_FACTOR_LDL_SINGLE, &plain, repeats, &unclustered));
    print("ldl K+W", &plain, &unclustered, cholesky.factor[0]);
    RUGA_TRY_DONE(ruga_skin_assemble(skin, state->x, 0.5));
    RUGA_TRY_DONE(measure(RUGA_FACTOR_LDL_SINGLE, &kkt, repeats, &ldl));
    print("ldl KKT", &kkt, &ldl, cholesky.factor[0]);
    RUGA_TRY_DONE(ruga_skin_assemble(skin, state->x, 0));
    RUGA_TRY_DONE(measure(RUGA_FACTOR_LDL_SINGLE, &kkt, repeats, &exact));
    print("ldl exact", &kkt, &exact, cholesky.factor[0]);
done:
    ruga_release(kkt.node_start);
    ruga_release(kkt.last);
    ruga_release(plain.node_start);
    ruga_release(plain.last);
    ruga_state_destroy(&state);
    ruga_model_destroy(&model);
    ruga_mesh_clear(&mesh);
    return status;
}

// bench_factor [repeats [unknowns ...]]
int main(int argc, char** argv) {
    static const int usual[] = {3138, 12534, 28194, 86000};
    int repeats = argc > 1 ? atoi(argv[1]) : 5, count = argc > 2 ? argc - 2 : 4;
    repeats = repeats < 1 ? 1 : repeats > MAX_REPEATS ? MAX_REPEATS : repeats;
    printf("%-9s %7s %6s | %7s %7s %6s %6s | %6s | %7s %5s %5s %5s | %7s %5s %5s %8s | %7s %5s %5s %8s | %s\n",
           "matrix", "n", "Mnz", "Mfill", "GF", "GF/s", "mem/f", "analys", "factor", "unit", "2 thr", "singl", "solve",
           "f/s", "2 thr", "residual", "rough", "f/s", "2 thr", "residual", "inertia");
    for (int k = 0; k < count; k++) {
        if (bench_size(argc > 2 ? atoi(argv[2 + k]) : usual[k], repeats) != RUGA_OK) {
            (void)fprintf(stderr, "%s\n", ruga_last_error());
            return 1;
        }
    }
    return 0;
}
