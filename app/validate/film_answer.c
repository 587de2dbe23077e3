// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/film_answer.h"

#include "app/validate/sheet.h"
#include "core/progress.h"

#include <math.h>

ruga_status film_answer_volume(const film_def* def, double* critical, film_answer* a) {
    enum { NEAR = 6, FAR = 7 };
    static const double near[NEAR] = {1.1, 1.2, 1.3, 1.4, 1.5, 1.6},
                        far[FAR] = {1.1, 1.3, 1.5, 1.75, 2, 2.25, 2.5};
    film_point points[NEAR], beyond[FAR];
    *a = (film_answer){.states = NEAR + FAR, .seconds = -ruga_clock()};
    RUGA_TRY(film_onset(def, &a->wavelength, critical));
    for (int k = 0; k < NEAR; k++) {
        points[k].strain = near[k] * *critical;
    }
    RUGA_TRY(film_branch(def, 0.5 * a->wavelength, NEAR, points));
    a->onset = film_fit(NEAR, points, 1.1 * *critical, 1.6 * *critical);
    for (int k = 0; k < FAR; k++) {
        beyond[k].strain = far[k] * a->onset;
    }
    RUGA_TRY(film_branch(def, 0.5 * a->wavelength, FAR, beyond));
    a->amplitude[0] = beyond[2].amplitude;
    a->amplitude[1] = beyond[FAR - 1].amplitude;
    for (int k = 0; k < FAR; k++) {
        a->minima += beyond[k].outcome == RUGA_OUTCOME_MINIMUM;
        a->minima += k < NEAR && points[k].outcome == RUGA_OUTCOME_MINIMUM;
    }
    a->seconds += ruga_clock();
    return RUGA_OK;
}

// Amplitude at a strain between frames: the square is nearly linear in the strain.
static double interpolate(int count, const sheet_frame* frame, double strain) {
    int k = 1;
    while (k < count - 1 && frame[k].strain < strain) {
        k++;
    }
    double a = frame[k - 1].amplitude * frame[k - 1].amplitude, b = frame[k].amplitude * frame[k].amplitude;
    double t = (strain - frame[k - 1].strain) / (frame[k].strain - frame[k - 1].strain);
    return sqrt(fmax(0, a + t * (b - a)));
}

ruga_status film_answer_shell(const film_def* def, double length, film_answer* a) {
    enum { COUNT = 12, TWICE = 7 };
    static const double strain[COUNT] = {1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.8, 2, 2.2, 2.4, 2.6, 2.8};
    sheet_def sheet = sheet_default();
    sheet_frame frame[COUNT];
    double wavelength, critical, h;
    sheet.ratio = def->ratio;
    sheet.poisson = def->poisson;
    sheet.thickness = def->thickness;
    sheet.length = length;
    sheet.width = 1;
    sheet.plane_strain = true;
    sheet.strain = strain;
    sheet.count = COUNT;
    *a = (film_answer){.states = COUNT, .seconds = -ruga_clock()};
    RUGA_TRY(sheet_run(&sheet, frame, &wavelength, &critical, &h));
    a->onset = critical * sheet_onset(COUNT, frame, critical, false, 0);
    a->wavelength = frame[TWICE].wavelength_fft;
    for (int k = 0; k < COUNT; k++) {
        a->minima += frame[k].report.outcome == RUGA_OUTCOME_MINIMUM;
    }
    for (int i = 0; i < FILM_LEVELS; i++) {
        a->amplitude[i] = interpolate(COUNT, frame, FILM_LEVEL[i] * a->onset);
    }
    a->seconds += ruga_clock();
    return RUGA_OK;
}
