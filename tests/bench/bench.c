// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Seconds per frame of the static solve on the 50 cm pillow (h = 0.7 mm, E ratio 1e4, E_q = 50 kPa, 50 lattice
// elements): from flat to 1 % compression in 5 frames, then measured frames of 0.2 % more and a 1 mm deeper bump,
// 20 ms each. Every method starts each measured frame from the same state, that of the default method; those that
// use MINRES take minutes and run the first measured frame only. Where the published method stops short of the
// tolerance, the times at which both first pass its final residual are compared. Prints a table; with a file name as
// second argument also JSON. RUGA_BENCH_SKIP in the environment names methods to leave out, with
// commas between them.
#include "core/memory.h"
#include "core/progress.h"
#include "mesh/make.h"
#include "solver/model.h"
#include "solver/state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WARM = 5, MAX_FRAMES = 20, METHODS = 4 };

typedef struct variant {
    const char* name;
    ruga_method method;
    ruga_linear_kind linear;
} variant;

static const variant variants[METHODS] = {
    {"quasi-newton", RUGA_METHOD_QUASI_NEWTON, RUGA_LINEAR_DIRECT},
    {"newton", RUGA_METHOD_NEWTON, RUGA_LINEAR_DIRECT},
    {"newton-minres", RUGA_METHOD_NEWTON, RUGA_LINEAR_MINRES},
    {"paper", RUGA_METHOD_PAPER, RUGA_LINEAR_DIRECT},
};

static bool is_skipped(const char* name) {
    const char* list = getenv("RUGA_BENCH_SKIP");
    size_t length = strlen(name);
    for (; list && *list; list += *list == ',') {
        if (strncmp(list, name, length) == 0 && (list[length] == ',' || !list[length])) {
            return true;
        }
        list += strcspn(list, ",");
    }
    return false;
}

typedef struct figures {
    double seconds[MAX_FRAMES], assembly, factor, solve, energy, iterations, linear, factorizations;
    double residual, worst_residual, pass[MAX_FRAMES];
    int minima, frames;
} figures;

static int compare(const void* a, const void* b) {
    double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

static double median(const double* values, int count) {
    double sorted[MAX_FRAMES];
    memcpy(sorted, values, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, compare);
    return count ? 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]) : 0;
}

static ruga_status make_pillow(int unknowns, ruga_mesh* mesh) {
    double low = 1e-3, high = 0.2;
    for (int k = 0; k < 24; k++) {
        double edge = sqrt(low * high);
        ruga_make_def make = {.shape = RUGA_SHAPE_PILLOW, .size = {0.5, 0.5, 0.16}, .edge = edge};
        ruga_mesh_clear(mesh);
        RUGA_TRY(ruga_mesh_make(&make, mesh));
        if (3 * mesh->vertex_count > unknowns) {
            low = edge;
        } else {
            high = edge;
        }
        if (abs(3 * mesh->vertex_count - unknowns) < unknowns / 50) {
            break;
        }
    }
    return RUGA_OK;
}

static void fill(ruga_model_def* def, const ruga_mesh* mesh, ruga_keyframe_def keys[3], int frames) {
    def->mesh = ruga_mesh_as_def(mesh);
    def->skin.thickness = 0.7e-3;
    def->skin.young = 500e6;
    def->interior.young = 50e3;
    def->interior.motion = RUGA_INTERIOR_PRESCRIBED;
    def->lattice.cells = 5;
    def->solver.allow_coarse = true;
    for (int k = 0; k < 3; k++) {
        keys[k] = ruga_default_keyframe_def();
        keys[k].has_bump = true;
        keys[k].bump_center[2] = 0.08;
        keys[k].bump_radius = 0.06;
    }
    keys[1].time = WARM * def->step;
    keys[1].matrix[0] = 0.99;
    keys[2].time = (WARM + frames) * def->step;
    keys[2].matrix[0] = 0.99 - 0.002 * frames;
    keys[2].bump_depth = 1e-3 * frames;
    def->keyframes = keys;
    def->keyframe_count = 3;
    def->frames = WARM + frames;
}

static ruga_status run_frame(ruga_model* model, ruga_state* state, const variant* v, const double* start,
                             double watched, int frame, figures* f) {
    ruga_report report;
    model->solver.method = v->method;
    model->solver.linear = v->linear;
    RUGA_TRY(ruga_state_load(state, start));
    state->skin->watched_residual = watched;
    state->skin->watched_clock = 0;
    double begin = ruga_clock();
    RUGA_TRY(ruga_state_step(model, state, &report));
    f->seconds[frame] = report.seconds_total;
    f->pass[frame] = state->skin->watched_clock > 0 ? state->skin->watched_clock - begin : report.seconds_total;
    f->assembly += report.seconds_assembly;
    f->factor += report.seconds_factor;
    f->solve += report.seconds_solve;
    f->energy += state->skin->work.seconds_energy;
    f->iterations += report.newton_iterations;
    f->linear += report.linear_iterations;
    f->factorizations += report.factorizations;
    f->residual = report.residual_shell;
    f->worst_residual = fmax(f->worst_residual, report.residual_shell);
    f->minima += report.outcome == RUGA_OUTCOME_MINIMUM;
    f->frames = frame + 1;
    return RUGA_OK;
}

static ruga_status bench_case(int unknowns, int frames, int paper_frames, FILE* json, bool* first) {
    ruga_status status = RUGA_OK;
    ruga_mesh mesh = {0};
    ruga_model* model = NULL;
    ruga_state* state = NULL;
    double *restart = NULL, *next = NULL, *watched = NULL, setup = ruga_clock();
    figures f[METHODS] = {{{0}, 0, 0, 0, 0, 0, 0, 0, 0, 0, {0}, 0, 0}};
    ruga_model_def def = ruga_default_model_def();
    ruga_keyframe_def keys[3];
    RUGA_TRY_DONE(make_pillow(unknowns, &mesh));
    fill(&def, &mesh, keys, frames);
    RUGA_TRY_DONE(ruga_model_create(&def, &model));
    RUGA_TRY_DONE(ruga_state_create(model, &state));
    setup = ruga_clock() - setup;
    RUGA_TRY_DONE(RUGA_NEW(restart, ruga_state_restart_size(model)));
    RUGA_TRY_DONE(RUGA_NEW(next, ruga_state_restart_size(model)));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(watched, MAX_FRAMES));
    for (int k = 0; k < WARM; k++) {
        RUGA_TRY_DONE(ruga_state_step(model, state, NULL));
    }
    ruga_state_save(state, restart);
    for (int k = 0; k < frames; k++) {
        // The published method first: its final residual is the mark for the others.
        for (int v = METHODS - 1; v >= 0; v--) {
            bool minutes = v >= METHODS - 2;
            if ((minutes && k >= paper_frames) || is_skipped(variants[v].name)) {
                continue;
            }
            RUGA_TRY_DONE(run_frame(model, state, &variants[v], restart, watched[k], k, &f[v]));
            if (v == METHODS - 1) {
                watched[k] = f[v].residual;
            }
        }
        ruga_state_save(state, next);
        memcpy(restart, next, (size_t)ruga_state_restart_size(model) * sizeof *restart);
    }
    printf("\n%d unknowns, %d clusters, %d elements, setup %.2f s\n", 3 * mesh.vertex_count, model->clusters.count,
           model->lattice.element_count, setup);
    printf("%-14s %9s %9s %9s | %8s %8s %8s %8s | %6s %8s %5s | %9s %7s\n", "method", "median s", "worst s",
           "to mark", "assembly", "factor", "solve", "energy", "iter", "linear", "fact", "residual", "minima");
    for (int v = 0; v < METHODS; v++) {
        int n = f[v].frames, marks = n < paper_frames ? n : paper_frames;
        double worst = 0;
        if (n == 0) {
            continue;
        }
        for (int k = 0; k < f[v].frames; k++) {
            worst = fmax(worst, f[v].seconds[k]);
        }
        printf("%-14s %9.3f %9.3f %9.3f | %8.3f %8.3f %8.3f %8.3f | %6.0f %8.0f %5.1f | %9.1e %3d/%-3d\n",
               variants[v].name, median(f[v].seconds, f[v].frames), worst, median(f[v].pass, marks), f[v].assembly / n,
               f[v].factor / n, f[v].solve / n, f[v].energy / n, f[v].iterations / n, f[v].linear / n,
               f[v].factorizations / n, f[v].worst_residual, f[v].minima, f[v].frames);
        if (json) {
            fprintf(json,
                    "%s\n{\"unknowns\": %d, \"clusters\": %d, \"method\": \"%s\", \"median\": %.4g, \"worst\": %.4g, "
                    "\"to_mark\": %.4g, \"assembly\": %.4g, \"factor\": %.4g, \"solve\": %.4g, \"energy\": %.4g, "
                    "\"iterations\": %.4g, \"linear\": %.4g, \"factorizations\": %.4g, \"residual\": %.4g, "
                    "\"minima\": %d, \"frames\": %d}",
                    *first ? "[" : ",", 3 * mesh.vertex_count, model->clusters.count, variants[v].name,
                    median(f[v].seconds, f[v].frames), worst, median(f[v].pass, marks), f[v].assembly / n,
                    f[v].factor / n, f[v].solve / n, f[v].energy / n, f[v].iterations / n, f[v].linear / n,
                    f[v].factorizations / n, f[v].worst_residual, f[v].minima, f[v].frames);
            *first = false;
        }
    }
    if (f[METHODS - 1].frames) {
        printf("quasi-newton passes the published method's final residual %.1f times sooner\n",
               median(f[METHODS - 1].seconds, f[METHODS - 1].frames) / median(f[0].pass, f[METHODS - 1].frames));
    }
    (void)fflush(stdout);
done:
    ruga_release(restart);
    ruga_release(next);
    ruga_release(watched);
    ruga_state_destroy(&state);
    ruga_model_destroy(&model);
    ruga_mesh_clear(&mesh);
    return status;
}

// bench [frames [json [unknowns ...]]]
int main(int argc, char** argv) {
    static const int usual[] = {3138, 12534, 28194};
    int frames = argc > 1 ? atoi(argv[1]) : 10, count = argc > 3 ? argc - 3 : 3;
    frames = frames < 1 ? 1 : frames > MAX_FRAMES ? MAX_FRAMES : frames;
    FILE* json = argc > 2 ? fopen(argv[2], "w") : NULL;
    bool first = true;
    for (int k = 0; k < count; k++) {
        int unknowns = argc > 3 ? atoi(argv[3 + k]) : usual[k];
        if (bench_case(unknowns, frames, 1, json, &first) != RUGA_OK) {
            (void)fprintf(stderr, "%s\n", ruga_last_error());
            return 1;
        }
    }
    if (json) {
        fprintf(json, "\n]\n");
        (void)fclose(json);
    }
    return 0;
}
