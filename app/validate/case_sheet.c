// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/band.h"
#include "app/validate/cases.h"
#include "app/validate/sheet.h"

#include <math.h>

enum { STRAINS = 10, RATIOS = 3, LAW_POINTS = 101 };
static const double strains[STRAINS] = {0.8, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 2, 2.5, 3};
static const double ratios[RATIOS] = {1e3, 1e2, 1e4};

typedef struct sheet_result {
    sheet_frame frame[STRAINS];
    double wavelength, critical, thickness;
} sheet_result;

static void state_lines(ruga_validation* v, double ratio, const sheet_result* r) {
    const sheet_frame* frame = r->frame;
    char name[96];
    int minima = 0;
    for (int k = 0; k < STRAINS; k++) {
        minima += frame[k].report.outcome == RUGA_OUTCOME_MINIMUM;
    }
    (void)snprintf(name, sizeof name, "ratio 1e%.0f: frames in a minimum", log10(ratio));
    ruga_validation_near(v, name, minima, STRAINS, 0, "all of them");
    (void)snprintf(name, sizeof name, "ratio 1e%.0f: wavelength by FFT at 2 eps_c, m", log10(ratio));
    ruga_validation_near(v, name, frame[7].wavelength_fft, r->wavelength, 0.05, "eq. 3");
    (void)snprintf(name, sizeof name, "ratio 1e%.0f: onset strain", log10(ratio));
    ruga_validation_near(v, name, r->critical * sheet_onset(STRAINS, frame, r->critical, false, 0),
                         r->critical, 0.08, "Allen 1969");
    for (int k = 5; k < STRAINS; k++) {
        if (k == 6) {
            continue;
        }
        (void)snprintf(name, sizeof name, "ratio 1e%.0f: amplitude at %.1f eps_c, m", log10(ratio),
                       strains[k]);
        ruga_validation_near(v, name, frame[k].amplitude, r->thickness * sqrt(strains[k] - 1), 0.06,
                             "Chen and Hutchinson 2004");
    }
}

static ruga_plot_series series_of(int ratio, const double* y, ruga_plot_style style, char name[48]) {
    (void)snprintf(name, 48, "ratio %g", ratios[ratio]);
    return (ruga_plot_series){
        .name = name, .count = STRAINS, .x = strains, .y = y, .style = style, .color = ratio + 1};
}

static ruga_status draw_amplitude(ruga_validation* v, int count, const sheet_result* results) {
    char path[RUGA_VALIDATION_PATH], names[RATIOS][48];
    double x[LAW_POINTS], law[LAW_POINTS], low[LAW_POINTS], high[LAW_POINTS], ours[RATIOS][STRAINS];
    for (int i = 0; i < LAW_POINTS; i++) {
        double t = (i - 1.0) / (LAW_POINTS - 2); // dense where the law is steep
        x[i] = i == 0 ? 0.75 : 1 + 2.05 * t * t;
        law[i] = sqrt(fmax(x[i] - 1, 0));
        low[i] = 0.94 * law[i];
        high[i] = 1.06 * law[i];
    }
    ruga_plot_series series[RATIOS + 1] = {reference_band("law, 6 %", LAW_POINTS, x, law, low, high)};
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < STRAINS; k++) {
            ours[i][k] = results[i].frame[k].amplitude / results[i].thickness;
        }
        series[i + 1] = series_of(i, ours[i], RUGA_PLOT_MARKERS, names[i]);
    }
    ruga_validation_file(
        v, "amplitude.svg",
        "Amplitude over strain against the law h sqrt(eps / eps_c - 1); judged from 1.5 eps_c on", path);
    return ruga_plot_write(&(ruga_plot_def){.x = {.name = "strain / critical strain"},
                                            .y = {.name = "amplitude / thickness"},
                                            .series_count = count + 1,
                                            .series = series},
                           path);
}

static ruga_status draw_wavelength(ruga_validation* v, int count, const sheet_result* results) {
    char path[RUGA_VALIDATION_PATH], names[RATIOS][48];
    double ours[RATIOS][STRAINS];
    static const double ends[2] = {0.9, 3.1}, one[2] = {1, 1}, low[2] = {0.95, 0.95}, high[2] = {1.05, 1.05};
    ruga_plot_series series[RATIOS + 1] = {reference_band("eq. 3, 5 %", 2, ends, one, low, high)};
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < STRAINS; k++) {
            ours[i][k] = strains[k] > 1 ? results[i].frame[k].wavelength_fft / results[i].wavelength : NAN;
        }
        series[i + 1] = series_of(i, ours[i], RUGA_PLOT_BOTH, names[i]);
    }
    ruga_validation_file(v, "wavelength.svg", "Wavelength by FFT over strain; judged at 2 eps_c", path);
    return ruga_plot_write(&(ruga_plot_def){.x = {.name = "strain / critical strain", .min = 1, .max = 3.05},
                                            .y = {.name = "wavelength / eq. 3", .min = 0.9, .max = 1.1},
                                            .series_count = count + 1,
                                            .series = series},
                           path);
}

static ruga_status run(ruga_validation* v) {
    int count = ruga_validation_is_quick(v) ? 1 : RATIOS;
    sheet_result results[RATIOS];
    for (int i = 0; i < count; i++) {
        sheet_def def = sheet_default();
        sheet_result* r = &results[i];
        def.ratio = ratios[i];
        def.strain = strains;
        def.count = STRAINS;
        RUGA_TRY(sheet_run(&def, r->frame, &r->wavelength, &r->critical, &r->thickness));
        state_lines(v, def.ratio, r);
    }
    RUGA_TRY(draw_amplitude(v, count, results));
    return draw_wavelength(v, count, results);
}

const ruga_validation_case ruga_validate_sheet = {
    .name = "sheet",
    .title = "A compressed sheet against the theory of wrinkling",
    .about = "A flat sheet of 12 x 3 wavelengths on a prescribed, box-filled interior is compressed along "
             "its length. "
             "Wavelength, onset and amplitude follow from the energy of a stiff film on a soft half-space.",
    .quick = true,
    .run = run,
};
