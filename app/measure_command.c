// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga measure: wavelength, amplitude and how good a frame's equilibrium is.
#include "app/measurement.h"

#include "app/command.h"
#include "app/console.h"
#include "app/curve_table.h"
#include "app/frames.h"
#include "app/meter.h"

#include <math.h>

static const ruga_option options[] = {
    {"--frame", "-f", "K", "the frame, counted from 0 [the last]", false},
    {"--json", "-j", NULL, "print one JSON object in SI units", false},
    {"--curve", NULL, "CSV", "write a row for each frame instead: size, forces of the handles, energies",
     false},
    {0},
};

static void say_length(const ruga_arguments* arguments, const char* name, double metres) {
    if (metres > 0) {
        ruga_say(arguments, "%-22s%.4g mm\n", name, 1e3 * metres);
    } else {
        ruga_say(arguments, "%-22s-\n", name);
    }
}

static void say_measurement(const ruga_arguments* arguments, const ruga_measurement* m) {
    const ruga_report* r = &m->report;
    ruga_say(arguments, "%-22s%d, t = %.6g s\n", "frame", m->frame, m->time);
    say_length(arguments, "wavelength", m->values.wavelength);
    if (m->values.wavelength_fft > 0) {
        say_length(arguments, "wavelength by FFT", m->values.wavelength_fft);
    }
    say_length(arguments, "wavelength predicted", m->predicted);
    say_length(arguments, "amplitude", m->values.amplitude);
    if (isfinite(m->values.volume)) {
        ruga_say(arguments, "%-22s%.6g m^3\n", "volume", m->values.volume);
    } else {
        ruga_say(arguments, "%-22s-\n", "volume");
    }
    ruga_say(arguments, "%-22s%s\n", "outcome", ruga_outcome_name(r->outcome));
    ruga_say(arguments, "%-22s%.2g (skin), %.2g (coupled), %.2g (constraints)\n", "residuals",
             r->residual_shell, r->residual_coupled, r->constraint_residual);
    const struct {
        const char* name;
        double value;
    } energies[] = {
        {"energy, membrane", r->energy_membrane}, {"energy, bending", r->energy_bending},
        {"energy, hinges", r->energy_hinge},      {"energy, foundation", r->energy_foundation},
        {"energy, interior", r->energy_interior}, {"energy, kinetic", r->energy_kinetic},
        {"energy, external", r->energy_external},
    };
    for (size_t i = 0; i < sizeof energies / sizeof energies[0]; i++) {
        ruga_say(arguments, "%-22s%.4g J\n", energies[i].name, energies[i].value);
    }
}

static void say_creases(const ruga_arguments* arguments, const ruga_measurement* m) {
    static const double degree = 57.29577951308232;
    if (m->crossings > 0) {
        ruga_say(arguments, "%-22s%d pairs of triangles pass through each other\n", "layers", m->crossings);
    }
    if (m->crease_count > 0) {
        ruga_say(arguments, "%-22s%.2g m\n", "gap", m->gap);
        ruga_say(arguments, "\n%-28s%11s%11s%11s%11s%12s\n", "crease", "length", "mean", "min", "max",
                 "energy");
    }
    for (int c = 0; c < m->crease_count; c++) {
        const ruga_measured_crease* k = &m->crease[c];
        ruga_say(arguments, "%c %-26s%8.4g mm%7.2f deg%7.2f deg%7.2f deg%10.3g J\n", k->assignment, k->name,
                 1e3 * k->length, degree * k->angle_mean, degree * k->angle_min, degree * k->angle_max,
                 k->hinge_energy);
    }
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    ruga_result_reader* reader;
    ruga_frame_range range;
    ruga_measurement m = {0};
    RUGA_TRY(ruga_open_result(ruga_operand(arguments), &reader));
    if (ruga_given(arguments, "--curve")) {
        status = ruga_curve_table_write(arguments, reader, ruga_value(arguments, "--curve"));
        goto done;
    }
    RUGA_TRY_DONE(ruga_choose_frames(arguments, ruga_result_frame_count(reader), false, &range));
    RUGA_TRY_DONE(ruga_measurement_take(reader, range.first, &m));
    if (ruga_given(arguments, "--json")) {
        status = ruga_print_json(ruga_measurement_json(&m));
    } else {
        say_measurement(arguments, &m);
        say_creases(arguments, &m);
    }
done:
    ruga_measurement_clear(&m);
    ruga_result_reader_close(&reader);
    return status;
}

const ruga_command ruga_measure_command = {
    .name = "measure",
    .operand = "RESULT",
    .usage = "[--frame K] [--json] | --curve CSV",
    .summary = "measure wavelength, amplitude, volume and energies of a frame",
    .about =
        "Wavelength and amplitude are those of the skin's distance from the interior's smooth surface, along "
        "its\n"
        "normal; on a flat sheet the wavelength is also found by FFT along strips. What has no meaning (no\n"
        "interior, no wrinkle, not a flat sheet) is shown as - and is null in JSON. Of creases: length, "
        "angles and\n"
        "hinge energy, and pairs of triangles of layers that pass through each other.",
    .example = "    ruga measure pillow.h5 --frame 10 --json",
    .options = options,
    .run = run,
};
