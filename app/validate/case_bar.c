// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Figure 3 of the paper: a bar of 80 cm is bent. Where do its wrinkles go?
#include "app/validate/body.h"
#include "app/validate/cases.h"
#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double LENGTH = 0.8, SIDE = 0.2;

typedef struct tie {
    const char* name;
    const char* suffix;
    ruga_coupling_kind kind;
    bool foundation;
} tie;

typedef struct ranked {
    double strain, area, energy;
} ranked;

static int by_strain(const void* a, const void* b) {
    double x = ((const ranked*)a)->strain, y = ((const ranked*)b)->strain;
    return (x < y) - (x > y);
}

// Share of the wrinkles' energy that lies outside of the third of the area whose embedded surface is compressed most.
// Of int w^2, or with `gradients` of int |grad w|^2.
static ruga_status share_outside(ruga_body* b, const double* w, bool gradients, double* share) {
    int count = b->mesh.triangle_count;
    const double* now = ruga_state_embedded(b->state);
    ranked* face = NULL;
    double total = 0, area = 0, inside = 0, covered = 0;
    RUGA_TRY(RUGA_NEW(face, count));
    for (int f = 0; f < count; f++) {
        const int* t = b->mesh.triangle + 3 * f;
        const double *X = b->mesh.position, *corner[3] = {X + 3 * t[0], X + 3 * t[1], X + 3 * t[2]};
        double u[3], v[3], along = 0, length = 0;
        face[f].area = ruga_mesh_triangle_area(&b->mesh, f);
        for (int e = 0; e < 3; e++) { // strain along the bar, of the edges that have a part along it
            int i = t[e], j = t[(e + 1) % 3];
            ruga_subtract(X + 3 * j, X + 3 * i, u);
            ruga_subtract(now + 3 * j, now + 3 * i, v);
            along += u[0] * u[0] / ruga_norm(u) * (1 - ruga_norm(v) / ruga_norm(u));
            length += u[0] * u[0] / ruga_norm(u);
        }
        face[f].strain = length > 0 ? along / length : 0;
        double mean = (w[t[0]] * w[t[0]] + w[t[1]] * w[t[1]] + w[t[2]] * w[t[2]]) / 3, slope = 0;
        double du = w[t[1]] - w[t[0]], dv = w[t[2]] - w[t[0]];
        ruga_subtract(corner[1], corner[0], u);
        ruga_subtract(corner[2], corner[0], v);
        double uu = ruga_dot(u, u), vv = ruga_dot(v, v), uv = ruga_dot(u, v);
        slope = (du * du * vv - 2 * du * dv * uv + dv * dv * uu) / (uu * vv - uv * uv);
        face[f].energy = face[f].area * (gradients ? slope : mean);
        total += face[f].energy;
        area += face[f].area;
    }
    qsort(face, (size_t)count, sizeof *face, by_strain);
    for (int f = 0; f < count && covered < area / 3; f++) {
        inside += face[f].energy;
        covered += face[f].area;
    }
    ruga_release(face);
    *share = 1 - inside / total;
    return RUGA_OK;
}

static ruga_status bend(ruga_validation* v, const tie* t, double* share, double* slope_share, double* amplitude,
                        ruga_outcome* worst) {
    ruga_status status = RUGA_OK;
    ruga_body b;
    const double* w;
    char path[RUGA_VALIDATION_PATH], suffix[64], caption[160];
    const int frames = 4;
    const ruga_make_def make = {.shape = RUGA_SHAPE_BAR, .size = {LENGTH, SIDE, SIDE}, .edge = 0.011};
    *worst = RUGA_OUTCOME_MINIMUM;
    RUGA_TRY_DONE(ruga_body_make(&make, &b));
    b.def.skin.thickness = 2e-3; // ratio 1e3: a wavelength of 8.7 cm and a critical strain of 0.52 %
    b.def.skin.young = 1e8;
    b.def.interior.young = 1e5;
    b.def.skin.poisson = b.def.interior.poisson = 0.3;
    b.def.interior.motion = RUGA_INTERIOR_QUASISTATIC;
    b.def.lattice.cells = 8;
    b.def.coupling.kind = t->kind;
    b.def.coupling.foundation = t->foundation;
    for (int i = 0; i < 2; i++) {
        double side = i ? 1 : -1;
        b.handle[i] = ruga_moving_handle(ruga_plane_region(side * LENGTH / 2, 0, 0, side, 0, 0),
                                         frames * b.def.step);
        b.handle[i].rotate_axis[1] = 1;
        b.handle[i].rotate_angle = -side * 0.06; // the top is compressed to 1.5 %
        b.handle[i].rotate_center[0] = side * LENGTH / 2;
    }
    b.def.handle_count = 2;
    RUGA_TRY_DONE(ruga_body_build(&b));
    for (int k = 0; k < frames; k++) {
        RUGA_TRY_DONE(ruga_body_step(&b, NULL, worst));
    }
    RUGA_TRY_DONE(ruga_body_measure(&b, &w));
    RUGA_TRY_DONE(share_outside(&b, w, false, share));
    RUGA_TRY_DONE(share_outside(&b, w, true, slope_share));
    *amplitude = b.measured.amplitude / b.def.skin.thickness;
    (void)snprintf(suffix, sizeof suffix, "%s.png", t->suffix);
    (void)snprintf(caption, sizeof caption, "The bent bar, %s; colour: displacement of the skin within +- 2 mm",
                   t->name);
    ruga_validation_file(v, suffix, caption, path);
    RUGA_TRY_DONE(ruga_body_picture(&b, -1.1, 0.6, 2e-3, path));
done:
    ruga_body_clear(&b);
    return status;
}

static ruga_status run(ruga_validation* v) {
    static const tie ties[] = {
        {"clusters and foundation (default)", "default", RUGA_COUPLING_CLUSTERS, true},
        {"clusters alone", "clusters", RUGA_COUPLING_CLUSTERS, false},
        {"spectral alone", "spectral", RUGA_COUPLING_SPECTRAL, false},
        {"spectral and foundation", "spectral-foundation", RUGA_COUPLING_SPECTRAL, true},
    };
    for (size_t k = 0; k < sizeof ties / sizeof ties[0]; k++) {
        double share, slope_share, amplitude;
        char name[128];
        ruga_outcome worst;
        RUGA_TRY(bend(v, &ties[k], &share, &slope_share, &amplitude, &worst));
        (void)snprintf(name, sizeof name, "%s: share of w^2 outside the compressed third", ties[k].name);
        if (k == 0) {
            ruga_validation_below(v, name, share, 0.05, "localised, figure 3 right");
        } else {
            ruga_validation_record(v, name, share, NAN, k == 2 ? "ripples everywhere, figure 3 left" : "");
        }
        (void)snprintf(name, sizeof name, "%s: share of |grad w|^2 outside it", ties[k].name);
        ruga_validation_record(v, name, slope_share, NAN, "");
        (void)snprintf(name, sizeof name, "%s: amplitude / h", ties[k].name);
        ruga_validation_record(v, name, amplitude, NAN, "");
        (void)snprintf(name, sizeof name, "%s: worst outcome (0 = minimum)", ties[k].name);
        ruga_validation_record(v, name, worst, 0, "");
    }
    return RUGA_OK;
}

const ruga_validation_case ruga_validate_bar = {
    .name = "bar",
    .title = "Figure 3: a bent bar, local against spectral constraints",
    .about = "The ends of a bar of 80 x 20 x 20 cm are turned against each other, so that its top is compressed by "
             "1.5 %, three times the critical strain. Wrinkles belong on top. The share of them (the integral of w^2, w "
             "the skin's displacement less its low-pass part) that lies outside of the third of the surface that is "
             "compressed most is measured for each tie between skin and interior.",
    .run = run,
};
