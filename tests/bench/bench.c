// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Cost of a frame of the static solve on the 50 cm pillow (h = 0.7 mm, E ratio 1e4, E_q = 50 kPa): from flat
// to 1 % compression in 5 frames, then measured frames of 0.2 % more and a 1 mm deeper bump, 20 ms each. The
// unit is one numeric factorisation of the frame's matrix, timed in the same run right after the frame.
// `quasi-newton`, and `damped` (the same with motion: damped), each go their own way, with each number of
// threads; the other methods start each frame from the states of quasi-newton. Those that use MINRES take
// minutes and run --slow-frames only. Where the published method stops short of the tolerance, the time at
// which another first passes its final residual is printed as `to mark`.
//     bench [--frames N] [--slow-frames N] [--methods A,B] [--threads N,M] [--per-frame] [--json FILE]
//           [--plot DIR] [--residuals FILE.csv] [--relaxation SECONDS] UNKNOWNS[:CLUSTERS] ...
// Large cases have fewer frames unless told, and what takes many minutes is left out unless it is named: the published
// method above 30,000 unknowns, Newton with factorisations.
// --plot draws residual against iteration of each method's worst frame; --residuals writes residual, energy
// and work spent at each iteration.
#include "core/memory.h"
#include "core/progress.h"
#include "core/vec3.h"
#include "ruga/ruga.h"
#include "solver/model.h"
#include "solver/state.h"
#include "tests/bench/pillow.h"
#include "view/plot.h"

#include <limits.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WARM = 5, MAX_FRAMES = 20, METHODS = 5, MAX_CASES = 16, TRACE = 100000, TIMINGS = 3 };
enum { LAG_MAX = 30000 }; // unknowns up to which the lag is measured
enum { QUASI_NEWTON, DAMPED, PAPER = METHODS - 1 };

typedef struct variant {
    const char* name;
    ruga_method method;
    ruga_linear_kind linear;
    ruga_skin_motion motion;
    bool slow;
    int most; // unknowns up to which it runs where no methods are named
} variant;

static const variant variants[METHODS] = {
    {"quasi-newton", RUGA_METHOD_QUASI_NEWTON, RUGA_LINEAR_DIRECT, RUGA_SKIN_STATIC, false, INT_MAX},
    {"damped", RUGA_METHOD_QUASI_NEWTON, RUGA_LINEAR_DIRECT, RUGA_SKIN_DAMPED, false, INT_MAX},
    {"newton", RUGA_METHOD_NEWTON, RUGA_LINEAR_DIRECT, RUGA_SKIN_STATIC, false, 0},
    {"newton-minres", RUGA_METHOD_NEWTON, RUGA_LINEAR_MINRES, RUGA_SKIN_STATIC, true, INT_MAX},
    {"paper", RUGA_METHOD_PAPER, RUGA_LINEAR_DIRECT, RUGA_SKIN_STATIC, true, 30000},
};

typedef struct options { // frames 0: by size
    int frames, slow_frames, threads[2], thread_count, case_count;
    int unknowns[MAX_CASES], clusters[MAX_CASES];
    const char *methods, *plot;
    double relaxation; // of damped motion
    bool per_frame;
    FILE *json, *residuals;
    bool first_row;
} options;

// One measured frame of one method.
typedef struct frame {
    ruga_report report;
    ruga_skin_work work;
    double units, unit, move; // time in units; seconds of a unit; largest change of x - Bq, in h
    double to_mark;           // seconds until the published method's residual was passed, 0 = it did not run
    double lag_max, lag_rms;  // distance to the minimum below a damped state, in h
    uint64_t bits;            // of the positions
} frame;

typedef struct run {
    const variant* variant;
    int threads, count;
    frame frames[MAX_FRAMES];
    double* start;            // restart vector of the next frame
    double *residuals, worst; // of the frame with most units so far
    int residual_count;
    size_t peak; // of the process while it solved
} run;

typedef struct bench {
    ruga_mesh mesh;
    ruga_model* model;
    ruga_state* state;
    ruga_skin_trace* trace;
    double *old_deviation, *relaxed, marks[MAX_FRAMES], setup;
    size_t bytes_before; // in use by the process before the model is made
} bench;

// ---- the scene -----------------------------------------------------------------------------------------

static void fill(ruga_model_def* def, const ruga_mesh* mesh, ruga_keyframe_def keys[3], const options* o) {
    bench_pillow_def(mesh, def);
    bench_pillow_motion(def, WARM, o->frames, keys);
    def->skin.relaxation = o->relaxation;
}

// ---- memory of the process -----------------------------------------------------------------------------

// A line "NAME: value kB" of /proc/self/status, in bytes; 0 where there is none.
static size_t process_bytes(const char* name) {
    char line[256];
    size_t kilobytes = 0, length = strlen(name);
    FILE* file = fopen("/proc/self/status", "r");
    while (file && fgets(line, sizeof line, file)) {
        if (strncmp(line, name, length) == 0) {
            kilobytes = strtoul(line + length, NULL, 10);
        }
    }
    if (file) {
        (void)fclose(file);
    }
    return 1024 * kilobytes;
}

// What is free goes back first: a method does not answer for what another one had.
static void reset_peak(void) {
    (void)malloc_trim(0);
    FILE* file = fopen("/proc/self/clear_refs", "w");
    if (file) {
        (void)fputs("5", file);
        (void)fclose(file);
    }
}

// ---- one frame -----------------------------------------------------------------------------------------

// Seconds of one numeric factorisation in double of the matrix at x, its assembly not counted, by a factor of its own,
// so that the skin's memory is its own.
static ruga_status time_unit(ruga_state* state, double* unit) {
    ruga_status status = RUGA_OK;
    ruga_skin* skin = state->skin;
    ruga_factor* factor = NULL;
    ruga_factor_info info;
    double seconds[TIMINGS];
    int timings = TIMINGS;
    RUGA_TRY_DONE(ruga_skin_create_factor(skin, &factor));
    RUGA_TRY_DONE(ruga_skin_assemble(skin, state->x, 0));
    RUGA_TRY_DONE(ruga_factor_numeric(factor, skin->kkt.value, &info)); // allocates
    for (int k = 0; k < timings; k++) {
        double begin = ruga_clock();
        RUGA_TRY_DONE(ruga_factor_numeric(factor, skin->kkt.value, &info));
        seconds[k] = ruga_clock() - begin;
        timings = seconds[0] > 1 ? 1 : TIMINGS;
    }
    *unit = bench_median(timings, seconds);
done:
    ruga_factor_destroy(&factor);
    return status;
}

static double largest_difference(int n, const double* a, const double* b, double* rms) {
    double most = 0, sum = 0;
    for (int i = 0; i < n; i += 3) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            square += (a[i + k] - b[i + k]) * (a[i + k] - b[i + k]);
        }
        most = fmax(most, square);
        sum += square;
    }
    *rms = sqrt(sum / (n / 3));
    return sqrt(most);
}

static void deviation(const ruga_state* state, double* d) {
    for (int i = 0; i < state->skin->n; i++) {
        d[i] = state->x[i] - state->embedded[i];
    }
}

// How far a damped state is from the minimum that it would go to.
static ruga_status measure_lag(bench* b, frame* f) {
    ruga_skin* skin = b->state->skin;
    ruga_skin_result result;
    double proximal = skin->proximal, h = b->model->skin.thickness;
    memcpy(b->relaxed, b->state->x, (size_t)skin->n * sizeof *b->relaxed);
    skin->proximal = 0;
    skin->factor_right = false;
    RUGA_TRY(ruga_skin_minimize(skin, b->relaxed, b->model->solver.tolerance, true, &result));
    skin->proximal = proximal;
    f->lag_max = largest_difference(skin->n, b->relaxed, b->state->x, &f->lag_rms) / h;
    f->lag_rms /= h;
    return RUGA_OK;
}

static void write_residuals(const bench* b, const run* r, int index, double begin, FILE* file) {
    for (int k = 0; k < b->state->skin->trace_count; k++) {
        const ruga_skin_trace* t = &b->trace[k];
        (void)fprintf(file, "%d,%s,%d,%d,%d,%.6g,%.6e,%.12e,%d,%d\n", 3 * b->mesh.vertex_count,
                      r->variant->name, r->threads, index, k, t->clock - begin, t->residual, t->energy,
                      t->factorizations, t->energies);
    }
}

// FNV-1a of the bytes.
static uint64_t hash(size_t count, const double* values) {
    const unsigned char* byte = (const unsigned char*)values;
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count * sizeof *values; i++) {
        h = (h ^ byte[i]) * 0x100000001b3u;
    }
    return h;
}

static void keep_worst(const bench* b, run* r, const frame* f, int count) {
    double units = f->report.seconds_total / f->unit;
    if (r->residuals && units > r->worst) {
        r->worst = units;
        r->residual_count = count;
        for (int k = 0; k < count; k++) {
            r->residuals[k] = b->trace[k].residual;
        }
    }
}

static ruga_status run_frame(bench* b, run* r, const double* start, int index, options* o) {
    ruga_state* state = b->state;
    ruga_skin* skin = state->skin;
    frame* f = &r->frames[index];
    double unused, begin;
    b->model->solver.method = r->variant->method;
    b->model->solver.linear = r->variant->linear;
    b->model->skin.motion = r->variant->motion;
    ruga_set_threads(r->threads);
    RUGA_TRY(ruga_state_load(state, start));
    deviation(state, b->old_deviation);
    skin->trace_count = 0;
    reset_peak();
    begin = ruga_clock();
    RUGA_TRY(ruga_state_step(b->model, state, &f->report));
    size_t peak = process_bytes("VmHWM:");
    r->peak = peak > r->peak ? peak : r->peak;
    f->work = skin->work;
    int traced = skin->trace_count;
    f->to_mark = b->marks[index] > 0 ? f->report.seconds_total : 0;
    for (int k = traced - 1; k >= 0; k--) {
        f->to_mark = b->trace[k].residual <= b->marks[index] ? b->trace[k].clock - begin : f->to_mark;
    }
    if (o->residuals) {
        write_residuals(b, r, index, begin, o->residuals);
    }
    if (r->start) {
        ruga_state_save(state, r->start);
    }
    deviation(state, b->relaxed);
    f->move = largest_difference(skin->n, b->relaxed, b->old_deviation, &unused) / b->model->skin.thickness;
    f->bits = hash((size_t)skin->n, state->x);
    RUGA_TRY(time_unit(state, &f->unit));
    keep_worst(b, r, f, traced);
    if (r->variant->motion == RUGA_SKIN_DAMPED && r->start && skin->n <= LAG_MAX) {
        RUGA_TRY(measure_lag(b, f));
    }
    r->count = index + 1;
    return RUGA_OK;
}

// ---- tables --------------------------------------------------------------------------------------------

static int convex_factors(const ruga_skin_work* w) {
    return w->factorizations - w->certificates;
}

// The column `offset` of all frames.
static double column(const run* r, double (*value)(const frame*), bool worst) {
    double values[MAX_FRAMES], most = 0;
    for (int k = 0; k < r->count; k++) {
        values[k] = value(&r->frames[k]);
        most = fmax(most, values[k]);
    }
    return worst ? most : bench_median(r->count, values);
}

static double seconds_of(const frame* f) {
    return f->report.seconds_total;
}
static double units_of(const frame* f) {
    return f->report.seconds_total / f->unit;
}
static double iterations_of(const frame* f) {
    return f->report.newton_iterations;
}
static double factors_of(const frame* f) {
    return f->report.factorizations;
}
static double energies_of(const frame* f) {
    return f->work.energies;
}
static double failures_of(const frame* f) {
    return f->work.failures;
}
static double linear_of(const frame* f) {
    return f->report.linear_iterations;
}
static double move_of(const frame* f) {
    return f->move;
}
static double residual_of(const frame* f) {
    return f->report.residual_shell;
}
static double lag_max_of(const frame* f) {
    return f->lag_max;
}
static double lag_rms_of(const frame* f) {
    return f->lag_rms;
}
// A solve with its gradient costs about a twentieth of a factorisation: a measure that no other load
// disturbs.
static double counted_of(const frame* f) {
    return f->report.factorizations + f->report.newton_iterations / 18.0;
}

static int minima(const run* r) {
    int count = 0;
    for (int k = 0; k < r->count; k++) {
        count += r->frames[k].report.outcome == RUGA_OUTCOME_MINIMUM;
    }
    return count;
}

static void print_frames(const run* r) {
    printf("%s, %d threads\n%5s %8s %7s %7s %5s %5s %5s %5s %5s %5s %5s %9s %7s %6s\n", r->variant->name,
           r->threads, "frame", "seconds", "units", "counted", "iter", "evals", "fact", "conv", "cert",
           "fail", "parts", "residual", "move/h", "lag/h");
    for (int k = 0; k < r->count; k++) {
        const frame* f = &r->frames[k];
        printf("%5d %8.3f %7.1f %7.1f %5d %5d %5d %5d %5d %5d %5d %9.1e %7.2f %6.2f\n", k, seconds_of(f),
               units_of(f), counted_of(f), f->report.newton_iterations, f->work.energies,
               f->report.factorizations, convex_factors(&f->work), f->work.certificates, f->work.failures,
               f->report.substeps, f->report.residual_shell, f->move, f->lag_max);
    }
}

// Peak above the start over the factor, model and all.
static double memory_ratio(const bench* b, const run* r) {
    double factor = 8 * b->state->skin->info.entries;
    return r->peak > b->bytes_before ? (double)(r->peak - b->bytes_before) / factor : 0;
}

static void print_row(const bench* b, const run* r) {
    double evaluations = 0, assembly = 0, factor = 0, solve = 0, energy = 0;
    for (int k = 0; k < r->count; k++) {
        const frame* f = &r->frames[k];
        evaluations += f->work.energies / (double)r->count;
        assembly += f->report.seconds_assembly / r->count / f->unit;
        factor += f->report.seconds_factor / r->count / f->unit;
        solve += f->report.seconds_solve / r->count / f->unit;
        energy += f->work.seconds_energy / r->count / f->unit;
    }
    printf("%-13s %d %8.3f %8.3f %8.3f | %6.1f %6.1f | %6.1f %6.1f | %5.2f %5.1f %5.2f %5.2f | %5.0f %5.0f "
           "%5.0f %4.1f "
           "%4.0f %7.0f | %8.1e %2d/%-2d %5.1f %5.2f %5.2f | %5.2f\n",
           r->variant->name, r->threads, column(r, seconds_of, false), column(r, seconds_of, true),
           r->frames[0].to_mark, column(r, units_of, false), column(r, units_of, true),
           column(r, counted_of, false), column(r, counted_of, true), assembly, factor, solve, energy,
           column(r, iterations_of, false), column(r, iterations_of, true), evaluations,
           column(r, factors_of, false), column(r, factors_of, true), column(r, linear_of, false),
           column(r, residual_of, true), minima(r), r->count, column(r, move_of, true),
           column(r, lag_max_of, true), column(r, lag_rms_of, true), memory_ratio(b, r));
}

static void write_json(const bench* b, const run* r, bool same_bits, options* o) {
    (void)fprintf(
        o->json,
        "%s\n{\"unknowns\": %d, \"clusters\": %d, \"elements\": %d, \"method\": \"%s\", \"relaxation\": %g, "
        "\"threads\": %d, \"setup\": %.4g, \"median\": %.4g, \"worst\": %.4g, \"to_mark\": %.4g, \"units_median\": %.4g, "
        "\"units_worst\": %.4g, \"unit_seconds\": %.4g, \"minima\": %d, \"same_bits\": %s, "
        "\"memory_over_factor\": %.4g, "
        "\"frames\": [",
        o->first_row ? "[" : ",", 3 * b->mesh.vertex_count, b->model->clusters.count,
        b->model->lattice.element_count, r->variant->name,
        r->variant->motion == RUGA_SKIN_DAMPED ? o->relaxation : 0, r->threads, b->setup, column(r, seconds_of, false),
        column(r, seconds_of, true), r->frames[0].to_mark, column(r, units_of, false),
        column(r, units_of, true), r->frames[0].unit, minima(r), same_bits ? "true" : "false", memory_ratio(b, r));
    o->first_row = false;
    for (int k = 0; k < r->count; k++) {
        const frame* f = &r->frames[k];
        (void)fprintf(
            o->json,
            "%s\n  {\"seconds\": %.4g, \"units\": %.4g, \"counted\": %.4g, \"iterations\": %d, "
            "\"linear\": %d, \"energies\": %d, \"factorizations\": %d, \"certificates\": %d, \"failed\": "
            "%.0f, "
            "\"substeps\": %d, \"residual\": %.4g, \"outcome\": %d, \"move\": %.4g, \"lag_max\": %.4g, "
            "\"lag_rms\": %.4g}",
            k ? "," : "", seconds_of(f), units_of(f), counted_of(f), f->report.newton_iterations,
            f->report.linear_iterations, (int)energies_of(f), f->report.factorizations, f->work.certificates,
            failures_of(f), f->report.substeps, f->report.residual_shell, (int)f->report.outcome, f->move,
            f->lag_max, f->lag_rms);
    }
    (void)fprintf(o->json, "]}");
}

// Whether the frames are those of the first number of threads, bit by bit.
static bool has_same_bits(const run* r, const run* first) {
    bool same = true;
    for (int k = 0; k < r->count; k++) {
        same = same && r->frames[k].bits == first->frames[k].bits;
    }
    return same;
}

static void report(bench* b, const run* runs, int count, options* o) {
    printf("\n%d unknowns, %d clusters, %d elements; setup %.2f s; factor %.1f MB\n", 3 * b->mesh.vertex_count,
           b->model->clusters.count, b->model->lattice.element_count, b->setup,
           8e-6 * b->state->skin->info.entries);
    printf("%-13s %s %8s %8s %8s | %6s %6s | %6s %6s | %s | %5s %5s %5s %4s %4s %7s | %8s %5s %5s %5s %5s | %5s\n",
           "method", "t", "median s", "worst s", "to mark", "units", "worst", "counts", "worst",
           "asmb  fact  solve  E+g ", "iter", "worst", "evals", "fact", "most", "linear", "residual", "minim",
           "move", "lag", "rms", "peak");
    for (int v = 0; v < count; v++) {
        if (runs[v].count) {
            print_row(b, &runs[v]);
            if (!has_same_bits(&runs[v], &runs[v % METHODS])) {
                printf("    its frames depend on the number of threads\n");
            }
        }
    }
    for (int v = 0; v < count; v++) {
        if (runs[v].count && o->per_frame) {
            print_frames(&runs[v]);
        }
        if (runs[v].count && o->json) {
            write_json(b, &runs[v], has_same_bits(&runs[v], &runs[v % METHODS]), o);
        }
    }
    (void)fflush(stdout);
}

// Residual against iteration of the worst frames, one thread.
static ruga_status plot(const bench* b, const run* runs, const options* o) {
    ruga_status status = RUGA_OK;
    ruga_plot_series series[METHODS] = {{.name = NULL}};
    char path[1024], title[128];
    double* iteration = NULL;
    int count = 0, clusters = b->model->clusters.count, unknowns = 3 * b->mesh.vertex_count;
    RUGA_TRY(RUGA_NEW(iteration, TRACE));
    for (int k = 0; k < TRACE; k++) {
        iteration[k] = k;
    }
    for (int v = 0; v < METHODS; v++) {
        const run* r = &runs[v];
        if (r->residual_count) {
            series[count++] = (ruga_plot_series){.name = r->variant->name,
                                                 .count = r->residual_count,
                                                 .x = iteration,
                                                 .y = r->residuals,
                                                 .style = RUGA_PLOT_LINE,
                                                 .color = v + 1};
        }
    }
    (void)snprintf(path, sizeof path, "%s/residuals-%d-%d.svg", o->plot, unknowns, clusters);
    (void)snprintf(title, sizeof title, "Worst frames, %d unknowns, %d clusters", unknowns, clusters);
    ruga_plot_def def = {.title = title,
                         .x = {.name = "iteration"},
                         .y = {.name = "residual / f_ref", .logarithmic = true},
                         .series_count = count,
                         .series = series};
    RUGA_TRY_DONE(ruga_plot_write(&def, path));
done:
    ruga_release(iteration);
    return status;
}

// ---- one case ------------------------------------------------------------------------------------------

static bool is_listed(const char* list, const variant* v, int unknowns) {
    const char* name = v->name;
    size_t length = strlen(name);
    for (; list && *list; list += *list == ',') {
        if (strncmp(list, name, length) == 0 && (list[length] == ',' || !list[length])) {
            return true;
        }
        list += strcspn(list, ",");
    }
    return !list && unknowns <= v->most;
}

static ruga_status create(bench* b, int unknowns, int clusters, const options* o) {
    ruga_model_def def = ruga_default_model_def();
    ruga_keyframe_def keys[3];
    RUGA_TRY(bench_pillow_mesh(unknowns, &b->mesh));
    fill(&def, &b->mesh, keys, o);
    def.coupling.count = clusters;
    reset_peak();
    b->bytes_before = process_bytes("VmRSS:");
    b->setup = ruga_clock();
    RUGA_TRY(ruga_model_create(&def, &b->model));
    RUGA_TRY(ruga_state_create(b->model, &b->state));
    b->setup = ruga_clock() - b->setup;
    RUGA_TRY(RUGA_NEW(b->old_deviation, 3 * b->mesh.vertex_count));
    RUGA_TRY(RUGA_NEW(b->relaxed, 3 * b->mesh.vertex_count));
    RUGA_TRY(RUGA_NEW(b->trace, TRACE));
    memset(b->trace, 0, TRACE * sizeof *b->trace);
    b->state->skin->trace = b->trace;
    b->state->skin->trace_size = TRACE;
    return RUGA_OK;
}

static void destroy(bench* b) {
    ruga_release(b->old_deviation);
    ruga_release(b->relaxed);
    ruga_release(b->trace);
    ruga_state_destroy(&b->state);
    ruga_model_destroy(&b->model);
    ruga_mesh_clear(&b->mesh);
}

// The frames up to the first measured one, static or damped.
static ruga_status warm(bench* b, ruga_skin_motion motion, const double* rest, double* start) {
    b->model->solver.method = RUGA_METHOD_QUASI_NEWTON;
    b->model->skin.motion = motion;
    ruga_set_threads(0);
    RUGA_TRY(ruga_state_load(b->state, rest));
    for (int k = 0; k < WARM; k++) {
        RUGA_TRY(ruga_state_step(b->model, b->state, NULL));
    }
    ruga_state_save(b->state, start);
    return RUGA_OK;
}

static void choose_frames(int unknowns, int clusters, options* o) {
    o->frames = unknowns < 20000 ? 20 : unknowns < 50000 ? 10 : unknowns < 150000 ? 4 : 2;
    o->frames = clusters > 1000 && o->frames > 4 ? 4 : o->frames;
}

static ruga_status bench_case(int unknowns, int clusters, options* o) {
    ruga_status status = RUGA_OK;
    bench b = {.model = NULL};
    run runs[2 * METHODS] = {{.count = 0}};
    double *rest = NULL, *start[2] = {NULL, NULL}, *next[2] = {NULL, NULL};
    int count = METHODS * o->thread_count;
    RUGA_TRY_DONE(create(&b, unknowns, clusters, o));
    RUGA_TRY_DONE(RUGA_NEW(rest, ruga_state_restart_size(b.model)));
    ruga_state_save(b.state, rest);
    for (int motion = 0; motion < 2; motion++) {
        RUGA_TRY_DONE(RUGA_NEW(start[motion], ruga_state_restart_size(b.model)));
        RUGA_TRY_DONE(RUGA_NEW(next[motion], ruga_state_restart_size(b.model)));
        if (motion == 0 || is_listed(o->methods, &variants[DAMPED], unknowns)) {
            RUGA_TRY_DONE(warm(&b, motion ? RUGA_SKIN_DAMPED : RUGA_SKIN_STATIC, rest, start[motion]));
        }
    }
    for (int v = 0; v < count; v++) {
        int kind = v % METHODS;
        runs[v].variant = &variants[kind];
        runs[v].threads = o->threads[v / METHODS];
        runs[v].start = kind <= DAMPED && v < METHODS ? next[kind] : NULL;
        if (o->plot && v < METHODS) {
            RUGA_TRY_DONE(RUGA_NEW(runs[v].residuals, TRACE));
        }
    }
    for (int k = 0; k < o->frames; k++) {
        // The published method first: its final residual is the mark for the others.
        for (int v = count - 1; v >= 0; v--) {
            const variant* kind = runs[v].variant;
            bool unseen = (kind->slow && k >= o->slow_frames) || (v >= METHODS && kind > &variants[DAMPED]);
            if (unseen || !is_listed(o->methods, kind, unknowns)) {
                continue;
            }
            RUGA_TRY_DONE(run_frame(&b, &runs[v], start[kind->motion == RUGA_SKIN_DAMPED], k, o));
            b.marks[k] = kind == &variants[PAPER] ? runs[v].frames[k].report.residual_shell : b.marks[k];
        }
        for (int motion = 0; motion < 2; motion++) {
            memcpy(start[motion], next[motion], (size_t)ruga_state_restart_size(b.model) * sizeof *rest);
        }
    }
    report(&b, runs, count, o);
    if (o->plot) {
        RUGA_TRY_DONE(plot(&b, runs, o));
    }
done:
    ruga_release(rest);
    for (int v = 0; v < count; v++) {
        ruga_release(runs[v].residuals);
    }
    for (int motion = 0; motion < 2; motion++) {
        ruga_release(start[motion]);
        ruga_release(next[motion]);
    }
    destroy(&b);
    return status;
}

// ---- command line --------------------------------------------------------------------------------------

static bool read_option(options* o, const char* name, const char* value) {
    if (strcmp(name, "--frames") == 0) {
        o->frames = atoi(value);
        o->frames = o->frames < 1 ? 1 : o->frames > MAX_FRAMES ? MAX_FRAMES : o->frames;
    } else if (strcmp(name, "--slow-frames") == 0) {
        o->slow_frames = atoi(value);
    } else if (strcmp(name, "--methods") == 0) {
        o->methods = value;
    } else if (strcmp(name, "--relaxation") == 0) {
        o->relaxation = atof(value);
    } else if (strcmp(name, "--plot") == 0) {
        o->plot = value;
    } else if (strcmp(name, "--threads") == 0) {
        o->thread_count = sscanf(value, "%d,%d", &o->threads[0], &o->threads[1]);
    } else if (strcmp(name, "--json") == 0) {
        o->json = fopen(value, "w");
        return o->json != NULL;
    } else if (strcmp(name, "--residuals") == 0) {
        o->residuals = fopen(value, "w");
        return o->residuals && fputs("unknowns,method,threads,frame,iteration,seconds,residual,energy,"
                                     "factorizations,energies\n",
                                     o->residuals) >= 0;
    } else {
        return false;
    }
    return o->thread_count > 0 && o->relaxation > 0;
}

static bool read_arguments(int argc, char** argv, options* o) {
    for (int k = 1; k < argc; k++) {
        if (strcmp(argv[k], "--per-frame") == 0) {
            o->per_frame = true;
        } else if (strncmp(argv[k], "--", 2) == 0) {
            if (k + 1 == argc || !read_option(o, argv[k], argv[k + 1])) {
                return false;
            }
            k++;
        } else if (o->case_count == MAX_CASES ||
                   sscanf(argv[k], "%d:%d", &o->unknowns[o->case_count], &o->clusters[o->case_count]) < 1) {
            return false;
        } else {
            o->case_count++;
        }
    }
    return true;
}

int main(int argc, char** argv) {
    options o = {
        .slow_frames = 1, .threads = {1, 2}, .thread_count = 2, .relaxation = 0.2, .first_row = true};
    if (!read_arguments(argc, argv, &o) || o.case_count == 0) {
        (void)fprintf(stderr, "bench: see the head of tests/bench/bench.c for the arguments\n");
        return 2;
    }
    bool by_size = o.frames == 0;
    for (int k = 0; k < o.case_count; k++) {
        int unknowns = o.unknowns[k], clusters = o.clusters[k];
        if (by_size) {
            choose_frames(unknowns, clusters, &o);
        }
        if (bench_case(unknowns, clusters, &o) != RUGA_OK) {
            (void)fprintf(stderr, "%s\n", ruga_last_error());
            return 1;
        }
    }
    if (o.json) {
        (void)fprintf(o.json, "\n]\n");
        (void)fclose(o.json);
    }
    if (o.residuals) {
        (void)fclose(o.residuals);
    }
    return 0;
}
