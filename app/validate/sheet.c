// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/sheet.h"

#include "app/measure.h"
#include "app/validate/line.h"
#include "core/memory.h"
#include "core/progress.h"
#include "core/vec3.h"
#include "mesh/make.h"
#include "solver/state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

sheet_def sheet_default(void) {
    return (sheet_def){.ratio = 1e3,
                       .poisson = 0.3,
                       .thickness = 1e-3,
                       .length = 12,
                       .width = 3,
                       .edges = 10,
                       .seed = 1,
                       .clusters = true,
                       .foundation = true,
                       .depth = 4};
}

// With equal Poisson ratios.
double sheet_wavelength(const sheet_def* def) {
    return 2 * RUGA_PI * def->thickness * cbrt(def->ratio / 3);
}

static void fill_def(const sheet_def* def, ruga_model_def* model, double wavelength) {
    model->skin.thickness = def->thickness;
    model->interior.young = 1e5;
    model->skin.young = def->ratio * model->interior.young;
    model->skin.poisson = model->interior.poisson = def->poisson;
    model->skin.density = 0;
    model->lattice.fill = RUGA_FILL_BOX;
    model->lattice.cells = def->cells ? def->cells : (int)ceil(def->length / 2);
    model->coupling.kind = def->spectral   ? RUGA_COUPLING_SPECTRAL
                           : def->clusters ? RUGA_COUPLING_CLUSTERS
                                           : RUGA_COUPLING_NONE;
    model->coupling.rule = def->paper_rule ? RUGA_RULE_PAPER : RUGA_RULE_CALIBRATED;
    model->coupling.foundation = def->foundation;
    model->solver.seed = def->seed;
    model->solver.method = def->paper_method ? RUGA_METHOD_PAPER
                           : def->newton     ? RUGA_METHOD_NEWTON
                                             : RUGA_METHOD_QUASI_NEWTON;
    model->solver.linear = def->minres ? RUGA_LINEAR_MINRES : RUGA_LINEAR_DIRECT;
    model->lattice.depth = def->coupled ? def->depth * wavelength : 0;
}

// The middle third in both directions.
static bool in_middle(const ruga_mesh* mesh, int vertex, const double size[2]) {
    const double* X = mesh->position + 3 * (size_t)vertex;
    return fabs(X[0]) <= size[0] / 6 && fabs(X[1]) <= size[1] / 6;
}

// One minus the slope of a straight line fitted to x over X in the middle: chord strain, wrinkles smoothed
// out.
static double chord_strain(const ruga_mesh* mesh, const double* position, const double size[2], int axis) {
    double sx = 0, sxx = 0, sy = 0, sxy = 0, n = 0;
    for (int v = 0; v < mesh->vertex_count; v++) {
        double X = mesh->position[3 * v + axis], x = position[3 * v + axis];
        if (in_middle(mesh, v, size)) {
            n += 1;
            sx += X;
            sxx += X * X;
            sy += x;
            sxy += X * x;
        }
    }
    return 1 - (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

static double middle_amplitude(const ruga_model* model, const double* w, const double size[2]) {
    double square = 0, area = 0;
    for (int v = 0; v < model->mesh.vertex_count; v++) {
        if (in_middle(&model->mesh, v, size)) {
            square += model->vertex_area[v] * w[v] * w[v];
            area += model->vertex_area[v];
        }
    }
    return sqrt(2 * square / area);
}

static void print_frame(const sheet_frame* f, const ruga_model* model) {
    double lambda = ruga_model_wavelength(model), critical = ruga_model_critical_strain(model);
    double strain = f->strain / critical, h = model->skin.thickness;
    printf("strain %.3f ec  skin %.3f ec  across %.3f ec  fft %.3f  wl %.3f  amp/h %.3f  mid %.3f (law %.3f) "
           " out %d "
           "r %.1e rc %.1e sub %d it %d lin %d fac %d  %.2f s%s\n",
           strain, f->skin_strain / critical, f->across_strain / critical, f->wavelength_fft / lambda,
           f->wavelength / lambda, f->amplitude / h, f->middle_amplitude / h,
           strain > 1 ? sqrt(strain - 1) : 0, (int)f->report.outcome, f->report.residual_shell,
           f->report.residual_coupled, f->report.substeps, f->report.newton_iterations,
           f->report.linear_iterations, f->report.factorizations, f->report.seconds_total,
           f->stopped ? "  (stopped)" : "");
    (void)fflush(stdout);
}

static bool before_deadline(const char* stage, double done, void* context) {
    (void)stage;
    (void)done;
    const double* deadline = context;
    return *deadline <= 0 || ruga_clock() < *deadline;
}

// A frame that is stopped at the limit leaves the state where the solve had come to: that is measured.
static ruga_status step_within(const sheet_def* def, const ruga_model* model, ruga_state* state,
                               sheet_frame* f) {
    double begin = ruga_clock(), deadline = def->frame_limit > 0 ? begin + def->frame_limit : 0;
    ruga_set_progress(before_deadline, &deadline);
    ruga_status status = ruga_state_step(model, state, &f->report);
    ruga_set_progress(NULL, NULL);
    if (status != RUGA_CANCELLED) {
        return status;
    }
    ruga_skin_work work = state->skin->work;
    f->stopped = true;
    RUGA_TRY(ruga_state_measure(state, &f->report));
    f->report.outcome = RUGA_OUTCOME_NOT_CONVERGED;
    f->report.newton_iterations = work.iterations;
    f->report.linear_iterations = work.linear_iterations;
    f->report.factorizations = work.factorizations;
    f->report.seconds_total = ruga_clock() - begin;
    return RUGA_OK;
}

static ruga_status run_frames(const sheet_def* def, const ruga_mesh* mesh, const ruga_model* model,
                              const double size[2], sheet_frame* frames) {
    ruga_status status = RUGA_OK;
    ruga_state* state = NULL;
    ruga_measure* measure = NULL;
    double critical = ruga_model_critical_strain(model);
    RUGA_TRY_DONE(ruga_state_create(model, &state));
    RUGA_TRY_DONE(ruga_measure_create(mesh, ruga_model_wavelength(model), 1, &measure));
    for (int k = 0; k < def->count && (k == 0 || !frames[k - 1].stopped); k++) {
        sheet_frame* f = &frames[k];
        ruga_measured m;
        const double* x = ruga_state_positions(state);
        RUGA_TRY_DONE(step_within(def, model, state, f));
        RUGA_TRY_DONE(ruga_measure_frame(measure, x, ruga_state_embedded(state), &m));
        f->strain = def->strain[k] * critical;
        f->skin_strain = chord_strain(mesh, x, size, 0);
        f->across_strain = chord_strain(mesh, x, size, 1);
        f->wavelength = m.wavelength;
        f->wavelength_fft = m.wavelength_fft;
        f->amplitude = m.amplitude;
        f->middle_amplitude = middle_amplitude(model, ruga_measure_displacement(measure), size);
        if (def->verbose) {
            print_frame(f, model);
        }
    }
done:
    ruga_measure_destroy(&measure);
    ruga_state_destroy(&state);
    return status;
}

double sheet_onset(int count, const sheet_frame* frames, double critical, bool own, double poisson) {
    fitted_line line = {0};
    for (int k = 0; k < count; k++) {
        const sheet_frame* f = &frames[k];
        double x = (own ? f->skin_strain + poisson * f->across_strain : f->strain) / critical;
        double y = own ? f->middle_amplitude * f->middle_amplitude : f->amplitude * f->amplitude;
        if (f->strain > 0 && x > 1.1 - 1e-9 && x < 1.6 + 1e-9) {
            line_add(&line, x, y);
        }
    }
    return line_zero(&line);
}

ruga_status sheet_run(const sheet_def* def, sheet_frame* frames, double* wavelength, double* critical,
                      double* thickness) {
    enum { MAX_KEYS = 256 };
    ruga_status status = RUGA_OK;
    ruga_mesh mesh = {0};
    ruga_model* model = NULL;
    ruga_keyframe_def keys[MAX_KEYS];
    ruga_model_def d = ruga_default_model_def();
    *thickness = def->thickness;
    *wavelength = sheet_wavelength(def);
    memset(frames, 0, (size_t)def->count * sizeof *frames);
    fill_def(def, &d, *wavelength);
    double e = 0.25 * pow(3 / def->ratio, 2.0 / 3), length = def->length * *wavelength;
    ruga_make_def make = {.shape = RUGA_SHAPE_SHEET,
                          .size = {length, def->width * *wavelength, 0},
                          .edge = *wavelength / def->edges};
    RUGA_TRY_DONE(ruga_mesh_make(&make, &mesh));
    d.mesh = ruga_mesh_as_def(&mesh);
    d.frames = def->count;
    ruga_handle_def handles[2] = {ruga_default_handle_def(), ruga_default_handle_def()};
    if (def->coupled) {
        // Both ends move inwards; only their x is held, one end's y as well through the symmetric pull of
        // both.
        d.interior.motion = RUGA_INTERIOR_QUASISTATIC;
        for (int i = 0; i < 2; i++) {
            double side = i ? 1 : -1;
            handles[i].kind = RUGA_HANDLE_MOVE;
            handles[i].region = (ruga_region){
                .kind = RUGA_REGION_PLANE, .center = {side * length / 2, 0, 0}, .normal = {side, 0, 0}};
            handles[i].translate[0] = -side * 0.5 * length * def->strain[def->count - 1] * e;
            handles[i].ramped = true;
            handles[i].during[1] = d.step * def->count;
        }
        d.handles = handles;
        d.handle_count = 2;
    } else {
        d.interior.motion = RUGA_INTERIOR_PRESCRIBED;
        for (int k = 0; k <= def->count; k++) {
            keys[k] = ruga_default_keyframe_def();
            keys[k].time = k * d.step;
            keys[k].matrix[0] = k ? 1 - def->strain[k - 1] * e : 1;
        }
        d.keyframes = keys;
        d.keyframe_count = def->count + 1;
        if (def->plane_strain) {
            handles[0].axes[0] = handles[0].axes[2] = false;
            handles[0].hold = RUGA_HOLD_SKIN;
            d.handles = handles;
            d.handle_count = 1;
        }
    }
    RUGA_TRY_DONE(ruga_model_create(&d, &model));
    *critical = ruga_model_critical_strain(model);
    if (def->verbose) {
        printf("V %d  clusters %d  lattice %d elements  lambda %g  ec %g\n", mesh.vertex_count,
               model->clusters.count, model->lattice.element_count, *wavelength, *critical);
    }
    RUGA_TRY_DONE(run_frames(def, &mesh, model, make.size, frames));
done:
    ruga_model_destroy(&model);
    ruga_mesh_clear(&mesh);
    return status;
}
