// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/cases.h"
#include "app/validate/sheet.h"

#include <math.h>

static ruga_status run(ruga_validation* v) {
    enum { COUNT = 10 };
    static const double strain[COUNT] = {0.8, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 2, 2.5, 3};
    int last = ruga_validation_is_quick(v) ? 1 : 3;
    for (int i = 0; i < last; i++) {
        sheet_def def = sheet_default();
        sheet_frame frame[COUNT];
        double wavelength, critical, h;
        char name[96];
        def.ratio = (const double[]){1e3, 1e2, 1e4}[i];
        def.strain = strain;
        def.count = COUNT;
        RUGA_TRY(sheet_run(&def, frame, &wavelength, &critical, &h));
        int minima = 0;
        for (int k = 0; k < COUNT; k++) {
            minima += frame[k].report.outcome == RUGA_OUTCOME_MINIMUM;
        }
        (void)snprintf(name, sizeof name, "ratio 1e%.0f: frames in a minimum", log10(def.ratio));
        ruga_validation_near(v, name, minima, COUNT, 0, "all of them");
        (void)snprintf(name, sizeof name, "ratio 1e%.0f: wavelength by FFT at 2 eps_c, m", log10(def.ratio));
        ruga_validation_near(v, name, frame[7].wavelength_fft, wavelength, 0.05, "eq. 3");
        (void)snprintf(name, sizeof name, "ratio 1e%.0f: onset strain", log10(def.ratio));
        ruga_validation_near(v, name, critical * sheet_onset(COUNT, frame, critical, false, 0), critical, 0.08,
                             "Allen 1969");
        for (int k = 5; k < COUNT; k++) {
            if (k == 6) {
                continue;
            }
            (void)snprintf(name, sizeof name, "ratio 1e%.0f: amplitude at %.1f eps_c, m", log10(def.ratio),
                           strain[k]);
            ruga_validation_near(v, name, frame[k].amplitude, h * sqrt(strain[k] - 1), 0.06,
                                 "Chen and Hutchinson 2004");
        }
    }
    return RUGA_OK;
}

const ruga_validation_case ruga_validate_sheet = {
    .name = "sheet",
    .title = "A compressed sheet against the theory of wrinkling",
    .about = "A flat sheet of 12 x 3 wavelengths on a prescribed, box-filled interior is compressed along its length. "
             "Wavelength, onset and amplitude follow from the energy of a stiff film on a soft half-space.",
    .quick = true,
    .run = run,
};
