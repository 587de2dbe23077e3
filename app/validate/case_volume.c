// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Figure 6 of the paper: the embedded shell against a volume whose skin is thin elements. Neither knows the
// other's formulas: the shell has membrane, bending, clusters and foundation, the volume has one elasticity.
#include "app/validate/band.h"
#include "app/validate/cases.h"
#include "app/validate/film_answer.h"

#include "io/writer.h"

#include <math.h>
#include <stdio.h>

typedef struct material {
    double ratio, poisson, thickness;
} material;

static const material MATERIALS[] = {
    {1e3, 0.3, 1e-3}, {1e2, 0.48, 1e-3}, {30, 0.3, 1e-3},  {1e2, 0.3, 1e-3},  {3e2, 0.3, 4e-3},
    {3e3, 0.3, 5e-4}, {1e4, 0.3, 1e-3},  {30, 0.48, 1e-3}, {1e3, 0.48, 2e-3}, {1e4, 0.48, 1e-3},
};
enum { MATERIALS_ALL = sizeof MATERIALS / sizeof *MATERIALS, MATERIALS_QUICK = 2 };

// ---- the case ------------------------------------------------------------------------------------------

static film_def film_of(const material* m) {
    film_def def = film_default();
    def.ratio = m->ratio;
    def.poisson = m->poisson;
    def.thickness = m->thickness;
    return def;
}

// Shell over volume, of each material.
typedef struct ratios {
    double wavelength, amplitude[FILM_LEVELS];
} ratios;

static ruga_status draw(ruga_validation* v, int count, const ratios* r, bool amplitude) {
    static const double poisson[] = {0.3, 0.48}, ends[] = {20, 2e4}, one[] = {1, 1};
    double tolerance = amplitude ? 0.1 : 0.08, low[] = {1 - tolerance, 1 - tolerance};
    double high[] = {1 + tolerance, 1 + tolerance}, x[4][MATERIALS_ALL], y[4][MATERIALS_ALL];
    char path[RUGA_VALIDATION_PATH], names[4][64];
    ruga_plot_series series[5] = {
        reference_band(amplitude ? "the volume, 10 %" : "the volume, 8 %", 2, ends, one, low, high)};
    int used = 1;
    for (int k = 0; k < (amplitude ? 4 : 2); k++) {
        int points = 0;
        for (int i = 0; i < count; i++) {
            if (MATERIALS[i].poisson == poisson[k % 2]) {
                x[k][points] = MATERIALS[i].ratio;
                y[k][points++] = amplitude ? r[i].amplitude[k / 2] : r[i].wavelength;
            }
        }
        (void)snprintf(names[k], sizeof names[k], amplitude ? "nu %g, at %g own onsets" : "nu %g",
                       poisson[k % 2], FILM_LEVEL[k / 2]);
        series[used] = (ruga_plot_series){.name = names[k],
                                          .count = points,
                                          .x = x[k],
                                          .y = y[k],
                                          .style = RUGA_PLOT_MARKERS,
                                          .color = k + 1};
        used += points > 0;
    }
    ruga_validation_file(v, amplitude ? "amplitude.svg" : "wavelength.svg",
                         amplitude ? "Amplitude of the embedded shell over the dense volume's"
                                   : "Wavelength of the embedded shell over the dense volume's",
                         path);
    return ruga_plot_write(
        &(ruga_plot_def){.x = {.name = "E_x / E_q", .logarithmic = true, .min = 20, .max = 2e4},
                         .y = {.name = amplitude ? "amplitude, shell / volume" : "wavelength, shell / volume",
                               .min = 0.8,
                               .max = 1.2},
                         .series_count = used,
                         .series = series},
        path);
}

static ruga_status compare(ruga_validation* v, const material* m, FILE* table, ratios* r) {
    film_def def = film_of(m);
    film_answer volume, shell;
    double critical;
    char name[128], point[64];
    RUGA_TRY(film_answer_volume(&def, &critical, &volume));
    RUGA_TRY(film_answer_shell(&def, ruga_validation_is_quick(v) ? 12 : 24, &shell));
    (void)snprintf(point, sizeof point, "E_x/E_q %g, nu %g, h %g mm", m->ratio, m->poisson,
                   1e3 * m->thickness);
    (void)snprintf(name, sizeof name, "%s: wavelength, m", point);
    ruga_validation_near(v, name, shell.wavelength, volume.wavelength, 0.08, "dense volume");
    r->wavelength = shell.wavelength / volume.wavelength;
    for (int i = 0; i < FILM_LEVELS; i++) {
        (void)snprintf(name, sizeof name, "%s: amplitude at %g own onsets, m", point, FILM_LEVEL[i]);
        ruga_validation_near(v, name, shell.amplitude[i], volume.amplitude[i], 0.10, "dense volume");
        r->amplitude[i] = shell.amplitude[i] / volume.amplitude[i];
    }
    (void)snprintf(name, sizeof name, "%s: onset strain", point);
    ruga_validation_record(v, name, shell.onset, volume.onset, "dense volume");
    (void)snprintf(name, sizeof name, "%s: states in a certified minimum", point);
    ruga_validation_near(v, name, volume.minima + shell.minima, volume.states + shell.states, 0,
                         "all, both models");
    (void)fprintf(table, "%g,%g,%g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", m->ratio, m->poisson,
                  m->thickness, film_wavelength(&def), film_strain(&def), volume.wavelength, shell.wavelength,
                  volume.onset, shell.onset, volume.amplitude[0], shell.amplitude[0], volume.amplitude[1],
                  shell.amplitude[1]);
    return RUGA_OK;
}

// Cells halved in both directions, twice for degree 1. The finest quadratic grid is the reference.
static ruga_status show_convergence(ruga_validation* v) {
    film_def quadratic = film_default(), linear = quadratic;
    double wavelength[2], onset[2], error[3], length;
    linear.degree = 1;
    film_def fine = film_halved(&quadratic);
    RUGA_TRY(film_onset(&quadratic, &wavelength[0], &onset[0]));
    RUGA_TRY(film_onset(&fine, &wavelength[1], &onset[1]));
    ruga_validation_near(v, "dense volume, degree 2, E_x/E_q 100: wavelength, m", wavelength[0],
                         wavelength[1], 0.005, "the same with cells half as large");
    ruga_validation_near(v, "dense volume, degree 2, E_x/E_q 100: critical strain", onset[0], onset[1], 0.005,
                         "the same with cells half as large");
    for (int i = 0; i < 3; i++) {
        char name[96];
        double strain;
        RUGA_TRY(film_onset(&linear, &length, &strain));
        error[i] = strain / onset[1] - 1;
        (void)snprintf(name, sizeof name, "dense volume, degree 1, %d cells a half wave: critical strain",
                       linear.cells);
        ruga_validation_record(v, name, strain, onset[1], "degree 2, fine");
        linear = film_halved(&linear);
    }
    ruga_validation_near(v, "dense volume, degree 1: order of convergence of the critical strain",
                         log2(error[1] / error[2]), 2, 0.1, "linear elements");
    return RUGA_OK;
}

static ruga_status run(ruga_validation* v) {
    char path[RUGA_VALIDATION_PATH];
    ruga_writer writer;
    bool quick = ruga_validation_is_quick(v);
    int count = quick ? (int)MATERIALS_QUICK : (int)MATERIALS_ALL;
    ratios r[MATERIALS_ALL];
    ruga_validation_file(v, "points.csv", "All points: both models and theory.", path);
    RUGA_TRY(ruga_writer_open(path, &writer));
    (void)fputs(
        "ratio,poisson,thickness,wavelength_theory,critical_theory,wavelength_volume,wavelength_shell,onset_volume,onset_shell,amplitude15_volume,amplitude15_shell,amplitude25_volume,amplitude25_shell\n",
        writer.file);
    ruga_status status = RUGA_OK;
    for (int i = 0; i < count && status == RUGA_OK; i++) {
        status = compare(v, &MATERIALS[i], writer.file, &r[i]);
    }
    RUGA_TRY(ruga_writer_close(&writer, status));
    RUGA_TRY(draw(v, count, r, false));
    RUGA_TRY(draw(v, count, r, true));
    if (!quick) {
        RUGA_TRY(show_convergence(v));
    }
    ruga_validation_note(
        v, "Onsets are recorded, not judged: the volume's film is bonded to its bed, which resists sliding "
           "as well, while the foundation of the embedded shell is that of a bed that carries no shear at "
           "the interface. Theory then expects a bonded film 6 to 8 %% later at nu = 0.3 and none of it at "
           "nu = 0.5; what the volume adds at small E_x/E_q is the large compression of the bed itself.");
    if (!quick) {
        ruga_validation_note(
            v,
            "At E_x/E_q = 30 the film wrinkles at 5 to 6 %% of strain and the bed is compressed by up to 15 "
            "%%, so that terms of the order of the strain show: in the volume alone, changing the law from "
            "fixed corotational to St. Venant-Kirchhoff moves the wavelength there from 1.03 to 0.96 of eq. "
            "3. At multiples of its own onset a film's amplitude, (lambda/pi) sqrt(eps - eps_c), hangs on "
            "lambda^2 eps_c, and so on bending over membrane stiffness alone and not on the bed. A "
            "compressed film gets thicker, which raises that ratio; the shell's hinges follow it "
            "(docs/method.md). With a constant thickness they are 10 to 11 %% low here.");
    }
    return RUGA_OK;
}

const ruga_validation_case ruga_validate_volume = {
    .name = "volume",
    .title = "The embedded shell against a dense volume (figure 6)",
    .about =
        "Plane strain. Shell: 24 wavelengths (12 where quick), default coupling, prescribed interior, y of "
        "the skin held. Volume: quadratic B-splines, two cells through the skin, a cell of half a wave "
        "between planes of symmetry and two wavelengths deep, its wavelength that of the least load (found "
        "by the inertia of the exact Hessian). Both onsets are zeros of a line fitted to amplitude^2 over "
        "1.1 to 1.6 critical strains, Allen's for the shell and the volume's own for the volume; amplitudes "
        "are compared at multiples of each model's own onset.",
    .quick = true,
    .run = run,
};
