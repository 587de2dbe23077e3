// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Figure 4 of the paper: what linear lattice elements do to the wrinkles, and quadratic ones do not.
#include "app/validate/body.h"
#include "app/validate/cases.h"
#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <stdio.h>

enum { CELLS = 12 };
static const double LENGTH = 1, CELL = 1.0 / CELLS, RADIUS = 0.8, DEPTH = 0.15, RATIO = 1e3, STRAIN = 0.03;

// Height of the skin over the smooth motion that was asked for, of which the lattice makes what it can: m.
static void heights(const ruga_body* b, double* w) {
    for (int v = 0; v < b->mesh.vertex_count; v++) {
        const double* X = b->mesh.position + 3 * v;
        w[v] = ruga_state_positions(b->state)[3 * v + 2] -
               DEPTH * exp(-ruga_dot(X, X) / (2 * RADIUS * RADIUS));
    }
}

// Amplitude of the component with wave number k along x, under a Hann window over the middle three quarters, averaged
// with its phase across the width; wave: sqrt(2) rms about the smooth part under the same window.
static void component(const ruga_body* b, const double* w, double* amplitude, double* wave) {
    double re = 0, im = 0, sum = 0, square = 0, mean = 0, span = 0.75 * LENGTH, k = 2 * RUGA_PI / CELL;
    for (int pass = 0; pass < 2; pass++) {
        for (int v = 0; v < b->mesh.vertex_count; v++) {
            double x = b->mesh.position[3 * v], s = x / span;
            double window = fabs(s) < 0.5 ? b->model->vertex_area[v] * 0.5 * (1 + cos(2 * RUGA_PI * s)) : 0;
            if (pass == 0) {
                sum += window;
                mean += window * w[v];
                continue;
            }
            double d = w[v] - mean / sum;
            re += window * d * cos(k * x);
            im += window * d * sin(k * x);
            square += window * d * d;
        }
    }
    *amplitude = 2 * hypot(re, im) / sum;
    *wave = sqrt(2 * square / sum);
}

static ruga_status press(ruga_validation* v, double wavelength, int degree, const char* suffix, double* share,
                         ruga_outcome* worst) {
    ruga_status status = RUGA_OK;
    ruga_body b;
    double *w = NULL, amplitude, wave;
    char path[RUGA_VALIDATION_PATH], caption[160];
    const ruga_make_def make = {
        .shape = RUGA_SHAPE_SHEET, .size = {LENGTH, 3 * wavelength, 0}, .edge = wavelength / 10};
    *worst = RUGA_OUTCOME_MINIMUM;
    RUGA_TRY_DONE(ruga_body_make(&make, &b));
    b.def.skin.thickness = wavelength / (2 * RUGA_PI * cbrt(RATIO / 3));
    b.def.interior.young = 1e5;
    b.def.skin.young = RATIO * b.def.interior.young;
    b.def.skin.poisson = b.def.interior.poisson = 0.3;
    b.def.interior.motion = RUGA_INTERIOR_PRESCRIBED;
    b.def.lattice.fill = RUGA_FILL_BOX;
    b.def.lattice.cells = CELLS;
    b.def.lattice.degree = degree;
    b.key[1].matrix[0] = 1 - STRAIN;
    for (int k = 0; k < 2; k++) {
        b.key[k].has_bump = true;
        b.key[k].bump_radius = RADIUS;
        b.key[k].bump_depth = k ? DEPTH : 0;
        b.key[k].bump_direction[2] = 1;
    }
    b.def.keyframe_count = 2;
    RUGA_TRY_DONE(ruga_body_build(&b));
    RUGA_TRY_DONE(ruga_body_step(&b, NULL, worst));
    RUGA_TRY_DONE(RUGA_NEW(w, b.mesh.vertex_count));
    heights(&b, w);
    component(&b, w, &amplitude, &wave);
    *share = amplitude / wave;
    (void)snprintf(caption, sizeof caption, "%s elements of %.1f cm, wavelength %.1f cm",
                   degree == 1 ? "Linear" : "Quadratic", 100 * CELL, 100 * wavelength);
    ruga_validation_file(v, suffix, caption, path);
    RUGA_TRY_DONE(ruga_body_picture(&b, -1.3, 0.5, 0, path));
done:
    ruga_release(w);
    ruga_body_clear(&b);
    return status;
}

static ruga_status run(ruga_validation* v) {
    static const double part[] = {1.7, 0.3};
    static const char* const words[] = {"low", "high"};
    for (int k = 0; k < 2; k++) {
        for (int degree = 1; degree <= 2; degree++) {
            double share;
            char name[128], suffix[64];
            ruga_outcome worst;
            (void)snprintf(suffix, sizeof suffix, "%s-degree-%d.png", words[k], degree);
            RUGA_TRY(press(v, part[k] * CELL, degree, suffix, &share, &worst));
            (void)snprintf(name, sizeof name, "%s frequency (%.1f cells), degree %d: component at the cells / wrinkles",
                           words[k], part[k], degree);
            if (degree == 2) {
                ruga_validation_below(v, name, share, 0.02, "no artefact");
            } else {
                ruga_validation_record(v, name, share, NAN, "the paper's figure 4 shows the artefact");
            }
            (void)snprintf(name, sizeof name, "%s frequency, degree %d: outcome (0 = minimum)", words[k], degree);
            ruga_validation_record(v, name, worst, 0, "");
        }
    }
    return RUGA_OK;
}

const ruga_validation_case ruga_validate_elements = {
    .name = "elements",
    .title = "Figure 4: linear against quadratic lattice elements",
    .about = "A sheet of 1 m on 12 coarse cells is compressed by 3 % and bulged smoothly (a Gaussian bump, radius 0.8 m, "
             "15 cm high). What the skin stands off that smooth motion is analysed under a Hann window: the amplitude "
             "of its component at the spacing of the cells, over that of the whole pattern. The wrinkles themselves "
             "are 1.7 and 0.3 cells long, so that they have no part at the spacing of the cells.",
    .run = run,
};
