// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/physics/sheet.h"

#include "app/measure.h"
#include "core/memory.h"
#include "mesh/make.h"
#include "solver/state.h"

#include <math.h>
#include <stdio.h>

sheet_def sheet_default(void) {
    return (sheet_def){.ratio = 1e3,
                       .poisson = 0.3,
                       .length = 12,
                       .width = 3,
                       .edges = 10,
                       .seed = 1,
                       .clusters = true,
                       .foundation = true,
                       .depth = 4};
}

static void fill_def(const sheet_def* def, ruga_model_def* model, double h, double* wavelength) {
    model->skin.thickness = h;
    model->interior.young = 1e5;
    model->skin.young = def->ratio * model->interior.young;
    model->skin.poisson = model->interior.poisson = def->poisson;
    model->skin.density = 0;
    model->lattice.fill = RUGA_FILL_BOX;
    model->lattice.cells = def->cells ? def->cells : (int)ceil(def->length / 2);
    model->coupling.kind = def->clusters ? RUGA_COUPLING_CLUSTERS : RUGA_COUPLING_NONE;
    model->coupling.rule = def->paper_rule ? RUGA_RULE_PAPER : RUGA_RULE_CALIBRATED;
    model->coupling.foundation = def->foundation;
    model->solver.seed = def->seed;
    model->solver.method = def->paper_method ? RUGA_METHOD_PAPER
                           : def->newton     ? RUGA_METHOD_NEWTON
                                             : RUGA_METHOD_QUASI_NEWTON;
    model->solver.linear = def->minres ? RUGA_LINEAR_MINRES : RUGA_LINEAR_DIRECT;
    // eq. 3 with equal Poisson ratios
    *wavelength = 2 * 3.14159265358979323846 * h * cbrt(def->ratio / 3);
    model->lattice.depth = def->coupled ? def->depth * *wavelength : 0;
}

static double skin_strain(const ruga_mesh* mesh, const double* position, const double* embedded, double length) {
    // Low-pass by a straight line through the middle third: slope of x over X.
    double sx = 0, sxx = 0, sy = 0, sxy = 0, n = 0;
    (void)embedded;
    for (int v = 0; v < mesh->vertex_count; v++) {
        double X = mesh->position[3 * (size_t)v];
        if (fabs(X) > length / 6) {
            continue;
        }
        double x = position[3 * (size_t)v];
        n += 1;
        sx += X;
        sxx += X * X;
        sy += x;
        sxy += X * x;
    }
    return 1 - (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

static ruga_status run_frames(const sheet_def* def, const ruga_mesh* mesh, const ruga_model* model, double length,
                              sheet_frame* frames) {
    ruga_status status = RUGA_OK;
    ruga_state* state = NULL;
    ruga_measure* measure = NULL;
    double critical = ruga_model_critical_strain(model);
    RUGA_TRY_DONE(ruga_state_create(model, &state));
    RUGA_TRY_DONE(ruga_measure_create(mesh, ruga_model_wavelength(model), 1, &measure));
    for (int k = 0; k < def->count; k++) {
        sheet_frame* f = &frames[k];
        ruga_measured m;
        RUGA_TRY_DONE(ruga_state_step(model, state, &f->report));
        RUGA_TRY_DONE(ruga_measure_frame(measure, ruga_state_positions(state), ruga_state_embedded(state), &m));
        f->strain = def->strain[k] * critical;
        f->skin_strain = skin_strain(mesh, ruga_state_positions(state), ruga_state_embedded(state), length);
        f->wavelength = m.wavelength;
        f->wavelength_fft = m.wavelength_fft;
        f->amplitude = m.amplitude;
        if (def->verbose) {
            double lambda = ruga_model_wavelength(model), h = frames[k].strain / critical;
            printf("strain %.3f ec  skin %.3f ec  fft %.3f  wl %.3f  amp/h %.3f (law %.3f)  out %d r %.1e rc %.1e sub %d "
                   "it %d lin %d fac %d  %.2f s\n",
                   h, f->skin_strain / critical, m.wavelength_fft / lambda, m.wavelength / lambda, m.amplitude / 1e-3,
                   h > 1 ? sqrt(h - 1) : 0, (int)f->report.outcome, f->report.residual_shell,
                   f->report.residual_coupled, f->report.substeps, f->report.newton_iterations,
                   f->report.linear_iterations, f->report.factorizations, f->report.seconds_total);
            (void)fflush(stdout);
        }
    }
done:
    ruga_measure_destroy(&measure);
    ruga_state_destroy(&state);
    return status;
}

ruga_status sheet_run(const sheet_def* def, sheet_frame* frames, double* wavelength, double* critical,
                      double* thickness) {
    enum { MAX_KEYS = 256 };
    ruga_status status = RUGA_OK;
    ruga_mesh mesh = {0};
    ruga_model* model = NULL;
    ruga_keyframe_def keys[MAX_KEYS];
    ruga_model_def d = ruga_default_model_def();
    *thickness = 1e-3;
    fill_def(def, &d, *thickness, wavelength);
    double e = 0.25 * pow(3 / def->ratio, 2.0 / 3), length = def->length * *wavelength;
    ruga_make_def make = {.shape = RUGA_SHAPE_SHEET,
                          .size = {length, def->width * *wavelength, 0},
                          .edge = *wavelength / def->edges};
    RUGA_TRY_DONE(ruga_mesh_make(&make, &mesh));
    d.mesh = ruga_mesh_as_def(&mesh);
    d.frames = def->count;
    ruga_handle_def handles[2] = {ruga_default_handle_def(), ruga_default_handle_def()};
    if (def->coupled) {
        // Both ends move inwards; only their x is held, one end's y as well through the symmetric pull of both.
        d.interior.motion = RUGA_INTERIOR_QUASISTATIC;
        for (int i = 0; i < 2; i++) {
            double side = i ? 1 : -1;
            handles[i].kind = RUGA_HANDLE_MOVE;
            handles[i].region = (ruga_region){.kind = RUGA_REGION_PLANE,
                                              .center = {side * length / 2, 0, 0},
                                              .normal = {side, 0, 0}};
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
    }
    RUGA_TRY_DONE(ruga_model_create(&d, &model));
    *critical = ruga_model_critical_strain(model);
    if (def->verbose) {
        printf("V %d  clusters %d  lattice %d elements  lambda %g  ec %g\n", mesh.vertex_count, model->clusters.count,
               model->lattice.element_count, *wavelength, *critical);
    }
    RUGA_TRY_DONE(run_frames(def, &mesh, model, length, frames));
done:
    ruga_model_destroy(&model);
    ruga_mesh_clear(&mesh);
    return status;
}
