// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A flat sheet on a prescribed, box-filled interior, as in sheet.c, whose skin varies along its length x:
// thickness or modulus doubled by a step in the middle, or a thickness that grows linearly. The wavelength is
// measured in windows along x and held against eq. 3 of the place.
#include "app/validate/cases.h"

#include "app/measure.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"
#include "mesh/make.h"
#include "solver/state.h"
#include "view/render.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 5, BINS = 400, WINDOWS = 7 };

// lambda is the wavelength of the thinner or softer skin: 16 of them in its half are 8 of twice the length in
// the other.
static const double THICKNESS = 1e-3, RATIO = 1e3, INTERIOR = 1e5;
static const double LENGTH = 32, WIDTH = 6, QUICK_WIDTH = 3;  // lambda
static const double EDGES = 8;                                // per lambda
static const double strain[FRAMES] = {0.8, 1.2, 1.4, 1.6, 2}; // over the critical strain of the softer skin

// FOUNDATION_GRADIENT is THICKNESS_GRADIENT without clusters.
typedef enum variation { THICKNESS_STEP, THICKNESS_GRADIENT, MODULUS_STEP, FOUNDATION_GRADIENT } variation;

typedef struct sheet {
    ruga_mesh mesh;
    ruga_model* model;
    ruga_state* state;
    ruga_measure* measure;
    double *thickness, *young; // [V]
    int* order;                // [V] row by row across the width, along x in each
    double length;             // m
} sheet;

// 0 at one end, 1 at the other.
static double along(const sheet* s, int v) {
    return s->mesh.position[3 * (size_t)v] / s->length + 0.5;
}

static bool is_gradient(variation kind) {
    return kind == THICKNESS_GRADIENT || kind == FOUNDATION_GRADIENT;
}

static double skin_at(variation kind, double t) {
    return is_gradient(kind) ? 1 + t : t < 0.5 ? 1 : 2;
}

static void set_skin(variation kind, sheet* s, ruga_model_def* def) {
    for (int v = 0; v < s->mesh.vertex_count; v++) {
        double factor = skin_at(kind, along(s, v));
        s->thickness[v] = kind == MODULUS_STEP ? THICKNESS : factor * THICKNESS;
        s->young[v] = kind == MODULUS_STEP ? factor * RATIO * INTERIOR : RATIO * INTERIOR;
    }
    def->skin.vertex_count = s->mesh.vertex_count;
    def->skin.vertex_thickness = s->thickness;
    def->skin.vertex_young = s->young;
}

static ruga_status build(variation kind, double width, sheet* s) {
    ruga_keyframe_def keys[FRAMES + 1];
    ruga_model_def def = ruga_default_model_def();
    double lambda = 2 * RUGA_PI * THICKNESS * cbrt(RATIO / 3), critical = 0.25 * pow(3 / RATIO, 2.0 / 3);
    s->length = LENGTH * lambda;
    ruga_make_def make = {
        .shape = RUGA_SHAPE_SHEET, .size = {s->length, width * lambda, 0}, .edge = lambda / EDGES};
    RUGA_TRY(ruga_mesh_make(&make, &s->mesh));
    RUGA_TRY(RUGA_NEW(s->thickness, s->mesh.vertex_count));
    RUGA_TRY(RUGA_NEW(s->young, s->mesh.vertex_count));
    def.mesh = ruga_mesh_as_def(&s->mesh);
    def.skin.density = 0;
    def.interior.young = INTERIOR;
    def.interior.motion = RUGA_INTERIOR_PRESCRIBED;
    def.lattice.fill = RUGA_FILL_BOX;
    def.lattice.cells = (int)(LENGTH / 2);
    def.coupling.kind = kind == FOUNDATION_GRADIENT ? RUGA_COUPLING_NONE : RUGA_COUPLING_CLUSTERS;
    set_skin(kind, s, &def);
    for (int k = 0; k <= FRAMES; k++) {
        keys[k] = ruga_default_keyframe_def();
        keys[k].time = k * def.step;
        keys[k].matrix[0] = k ? 1 - strain[k - 1] * critical : 1;
    }
    def.keyframes = keys;
    def.keyframe_count = FRAMES + 1;
    def.frames = FRAMES;
    RUGA_TRY(ruga_model_create(&def, &s->model));
    RUGA_TRY(ruga_state_create(s->model, &s->state));
    return ruga_measure_create_local(&s->mesh, s->model->wavelength, s->model->variation.wavelength, 1,
                                     &s->measure);
}

static void clear(sheet* s) {
    ruga_measure_destroy(&s->measure);
    ruga_state_destroy(&s->state);
    ruga_model_destroy(&s->model);
    ruga_mesh_clear(&s->mesh);
    ruga_release(s->thickness);
    ruga_release(s->young);
    ruga_release(s->order);
}

// ---- wavelength in a window ----------------------------------------------------------------------------

typedef struct row_entry {
    double x, y;
    int vertex;
} row_entry;

static int compare_rows(const void* a, const void* b) {
    const row_entry *p = a, *q = b;
    return p->y != q->y ? (p->y > q->y) - (p->y < q->y) : (p->x > q->x) - (p->x < q->x);
}

// The made sheet has its vertices in rows of equal y up to round-off.
static ruga_status order_rows(sheet* s) {
    row_entry* entry = NULL;
    int vertices = s->mesh.vertex_count;
    double grain = 1e-3 * s->model->mean_edge;
    RUGA_TRY(RUGA_NEW(s->order, vertices));
    RUGA_TRY(RUGA_NEW(entry, vertices));
    for (int v = 0; v < vertices; v++) {
        const double* x = s->mesh.position + 3 * (size_t)v;
        entry[v] = (row_entry){x[0], floor(x[1] / grain + 0.5), v};
    }
    qsort(entry, (size_t)vertices, sizeof *entry, compare_rows);
    for (int v = 0; v < vertices; v++) {
        s->order[v] = entry[v].vertex;
    }
    ruga_release(entry);
    return RUGA_OK;
}

typedef struct window {
    double begin, end; // m
    double mean;       // of w in it
} window;

static double window_mean(const sheet* s, const double* w, double begin, double end) {
    double sum = 0, count = 0;
    for (int v = 0; v < s->mesh.vertex_count; v++) {
        double x = s->mesh.position[3 * (size_t)v];
        if (x >= begin && x <= end) {
            sum += w[v];
            count += 1;
        }
    }
    return count > 0 ? sum / count : 0;
}

// Power at wave number k (1/m) of w under a Hann window, added over the rows; evenly spaced points, so that
// sums stand for integrals.
static double window_power(const sheet* s, const double* w, const window* win, double k) {
    double power = 0, re = 0, im = 0, last = -INFINITY, length = win->end - win->begin;
    for (int i = 0; i <= s->mesh.vertex_count; i++) {
        int v = i < s->mesh.vertex_count ? s->order[i] : 0;
        double x = i < s->mesh.vertex_count ? s->mesh.position[3 * (size_t)v] : -INFINITY;
        if (x < last) { // a new row
            power += re * re + im * im;
            re = im = 0;
        }
        last = x;
        if (x < win->begin || x > win->end) {
            continue;
        }
        double t = (x - win->begin) / length, angle = 2 * RUGA_PI * k * (x - win->begin);
        double value = (0.5 - 0.5 * cos(2 * RUGA_PI * t)) * (w[v] - win->mean);
        re += value * cos(angle);
        im += value * sin(angle);
    }
    return power;
}

typedef struct spectrum {
    const sheet* sheet;
    const double* w;
    window window;
    double power[BINS];
} spectrum;

// Bins at half the window's own spacing, from one wave in it up, to a quarter of the mesh's sampling.
static double bin_number(const window* win, int bin) {
    return (2 + bin) / (2 * (win->end - win->begin));
}

static void fill_bins(int begin, int end, int chunk, void* context) {
    (void)chunk;
    spectrum* p = context;
    double most = 0.25 / p->sheet->model->mean_edge;
    for (int b = begin; b < end; b++) {
        double k = bin_number(&p->window, b);
        p->power[b] = k <= most ? window_power(p->sheet, p->w, &p->window, k) : 0;
    }
}

// 1 / centroid of the wave numbers above 5 % of the peak power, as `ruga measure` does it.
static double wavelength_in(const sheet* s, double begin, double end) {
    spectrum p = {.sheet = s, .w = ruga_measure_displacement(s->measure), .window = {begin, end, 0}};
    double peak = 0, sum = 0, moment = 0;
    p.window.mean = window_mean(s, p.w, begin, end);
    ruga_parallel_for(BINS, 16, fill_bins, &p);
    for (int b = 0; b < BINS; b++) {
        peak = fmax(peak, p.power[b]);
    }
    for (int b = 0; b < BINS; b++) {
        if (p.power[b] > 0.05 * peak) {
            sum += p.power[b];
            moment += p.power[b] * bin_number(&p.window, b);
        }
    }
    return moment > 0 ? sum / moment : 0;
}

// ---- what is stated ------------------------------------------------------------------------------------

static double eq3(variation kind, double t) {
    double factor = skin_at(kind, t);
    return 2 * RUGA_PI * THICKNESS * cbrt(RATIO / 3) * (kind == MODULUS_STEP ? cbrt(factor) : factor);
}

// sqrt(2) times the root of the mean square of w.
static double amplitude_in(const sheet* s, double begin, double end) {
    const double* w = ruga_measure_displacement(s->measure);
    double square = 0, area = 0;
    for (int v = 0; v < s->mesh.vertex_count; v++) {
        double x = s->mesh.position[3 * (size_t)v];
        if (x >= begin && x <= end) {
            square += s->model->vertex_area[v] * w[v] * w[v];
            area += s->model->vertex_area[v];
        }
    }
    return sqrt(2 * square / area);
}

// h sqrt(eps / eps_c - 1), eps_c ~ E^(-2/3).
static double amplitude_law(variation kind, int half, double times) {
    double factor = skin_at(kind, half);
    double excess = times * (kind == MODULUS_STEP ? cbrt(factor * factor) : 1) - 1;
    return excess > 0 ? THICKNESS * (kind == MODULUS_STEP ? 1 : factor) * sqrt(excess) : 0;
}

// Each half but for one of its wavelengths at the jump and at the outer end.
static void state_halves(ruga_validation* v, variation kind, const sheet* s, double times) {
    for (int half = 0; half < 2; half++) {
        char name[96], what[32];
        double lambda = eq3(kind, half), side = 0.5 * s->length, law = amplitude_law(kind, half, times);
        double begin = half ? lambda : -side + lambda, end = half ? side - lambda : -lambda;
        (void)snprintf(what, sizeof what, "%s %d %s", kind == THICKNESS_STEP ? "thickness" : "modulus",
                       half + 1, kind == THICKNESS_STEP ? "h" : "E");
        (void)snprintf(name, sizeof name, "%s, wavelength at %.1f eps_c, m", what, times);
        if (law > 0 && kind == THICKNESS_STEP) {
            ruga_validation_near(v, name, wavelength_in(s, begin, end), lambda, 0.08, "eq. 3 of the half");
        } else if (law > 0) {
            ruga_validation_record(v, name, wavelength_in(s, begin, end), lambda, "eq. 3 of the half");
        }
        (void)snprintf(name, sizeof name, "%s, amplitude at %.1f eps_c, m", what, times);
        ruga_validation_record(v, name, amplitude_in(s, begin, end), law, "Chen and Hutchinson 2004");
    }
}

// Windows of five local wavelengths, evenly spread.
static void state_windows(ruga_validation* v, variation kind, const sheet* s, double times, FILE* table) {
    for (int i = 0; i < WINDOWS; i++) {
        char name[96];
        double first = 3.5 * eq3(THICKNESS_GRADIENT, 0) / s->length;
        double last = 1 - 3.5 * eq3(THICKNESS_GRADIENT, 1) / s->length;
        double t = first + (last - first) * i / (WINDOWS - 1), lambda = eq3(THICKNESS_GRADIENT, t);
        double x = (t - 0.5) * s->length, found = wavelength_in(s, x - 2.5 * lambda, x + 2.5 * lambda);
        if (kind == FOUNDATION_GRADIENT) {
            (void)snprintf(name, sizeof name, "no clusters, thickness %.2f h: wavelength at %.1f eps_c, m",
                           1 + t, times);
            ruga_validation_record(v, name, found, lambda, "eq. 3 of the place");
            continue;
        }
        (void)snprintf(name, sizeof name, "gradient, thickness %.2f h: wavelength at %.1f eps_c, m", 1 + t,
                       times);
        ruga_validation_near(v, name, found, lambda, 0.12, "eq. 3 of the place");
        if (table) {
            (void)fprintf(table, "%.9g,%.9g,%.9g,%.9g,%.9g\n", times, x, THICKNESS * (1 + t), found, lambda);
        }
    }
}

static ruga_status draw(ruga_validation* v, const sheet* s, const char* suffix, const char* caption) {
    char path[RUGA_VALIDATION_PATH];
    const double* w = ruga_measure_displacement(s->measure);
    ruga_render_def def = ruga_default_render_def();
    double most = 0;
    for (int i = 0; i < s->mesh.vertex_count; i++) {
        most = fmax(most, fabs(w[i]));
    }
    def.width = 1000;
    def.height = 350;
    def.azimuth = -RUGA_PI / 2;
    def.elevation = 50 * RUGA_PI / 180;
    def.scalar = (ruga_scale){.value = w, .min = -most, .max = most, .name = "displacement, mm", .unit = 1e-3};
    ruga_validation_file(v, suffix, caption, path);
    return ruga_render_png(&s->mesh, ruga_state_positions(s->state), &def, path);
}

static ruga_status run_sheet(ruga_validation* v, variation kind, const char* name, FILE* table) {
    ruga_status status = RUGA_OK;
    sheet s = {.length = 0};
    ruga_report report;
    ruga_measured measured;
    char line[96], suffix[96], caption[160];
    int minima = 0;
    RUGA_TRY_DONE(build(kind, ruga_validation_is_quick(v) ? QUICK_WIDTH : WIDTH, &s));
    RUGA_TRY_DONE(order_rows(&s));
    for (int k = 0; k < FRAMES; k++) {
        RUGA_TRY_DONE(ruga_state_step(s.model, s.state, &report));
        minima += report.outcome == RUGA_OUTCOME_MINIMUM;
        RUGA_TRY_DONE(ruga_measure_frame(s.measure, ruga_state_positions(s.state),
                                         ruga_state_embedded(s.state), &measured));
        if (k == 0 && kind != MODULUS_STEP) {
            (void)snprintf(line, sizeof line, "%s: amplitude over thickness h at %.1f eps_c", name,
                           strain[0]);
            ruga_validation_below(v, line, measured.amplitude / THICKNESS, 0.02, "no wrinkles below onset");
        } else if (k == FRAMES - 1 || (k == 1 && kind != FOUNDATION_GRADIENT)) {
            if (is_gradient(kind)) {
                state_windows(v, kind, &s, strain[k], table);
            } else {
                state_halves(v, kind, &s, strain[k]);
            }
        }
    }
    (void)snprintf(line, sizeof line, "%s: frames in a minimum", name);
    ruga_validation_near(v, line, minima, FRAMES, 0, "all of them");
    (void)snprintf(suffix, sizeof suffix, "%s.png", name);
    (void)snprintf(caption, sizeof caption,
                   "%s: the sheet at %.1f critical strains, coloured by the height of its wrinkles", name,
                   strain[FRAMES - 1]);
    RUGA_TRY_DONE(draw(v, &s, suffix, caption));
done:
    clear(&s);
    return status;
}

static ruga_status run(ruga_validation* v) {
    char path[RUGA_VALIDATION_PATH];
    RUGA_TRY(run_sheet(v, THICKNESS_STEP, "step", NULL));
    ruga_validation_note(
        v,
        "Amplitudes are for the record. Just above onset they hang on where exactly that is (4 %% later "
        "makes them 12 %% lower at 1.2 eps_c) and on the seed: with seed 2 the thick half is 23 %% low "
        "there. Uniform sheets of 8 x 3 and 8 x 6 wavelengths are 7 to 13 %% low at 1.2 eps_c and 3 to 6 %% "
        "at 2 eps_c as well, one of 16 x 6 is 2 %% low and right: most of it is the short half, and not the "
        "step.");
    if (ruga_validation_is_quick(v)) {
        return RUGA_OK;
    }
    ruga_validation_file(v, "gradient.csv", "gradient: wavelength along the sheet, ours and eq. 3", path);
    FILE* table = fopen(path, "w");
    if (table) {
        (void)fputs("strain_over_critical,x_m,thickness_m,wavelength_m,eq3_m\n", table);
    }
    ruga_status status = run_sheet(v, THICKNESS_GRADIENT, "gradient", table);
    if (table) {
        (void)fclose(table);
    }
    RUGA_TRY(status);
    RUGA_TRY(run_sheet(v, MODULUS_STEP, "modulus", NULL));
    RUGA_TRY(run_sheet(v, FOUNDATION_GRADIENT, "no-clusters", NULL));
    ruga_validation_note(
        v,
        "Clusters alone would set the wavelength by their spacing. Without them the foundation must do it, "
        "and at 2 eps_c it does. Its tangential springs are soft, so that the skin slides at both ends, more "
        "at "
        "the thick one, which pushes harder: wrinkles come late, and the ends stay flat. With a step and no "
        "clusters the thick half hardly wrinkles at 2 eps_c at all.");
    return RUGA_OK;
}

const ruga_validation_case ruga_validate_vary = {
    .name = "vary",
    .title = "Skins that vary in space",
    .about =
        "Flat sheets of 32 x 6 wavelengths of a skin of thickness h, on a prescribed, box-filled interior, "
        "compressed "
        "along their length by the same strain everywhere. The thickness doubles by a step in the middle, or "
        "grows linearly to twice its value; or the modulus doubles by a step, for the record. The critical "
        "strain "
        "eps_c, that of the softer skin, does not depend on the thickness. Wavelengths are centroids of "
        "spectra under a Hann window: over each half but for one "
        "of its wavelengths at either end, or over five local wavelengths.",
    .quick = true,
    .run = run,
};
