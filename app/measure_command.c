// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga measure: wavelength, amplitude and how good a frame's equilibrium is.
#include "app/measurement.h"

#include "app/command.h"
#include "app/console.h"
#include "app/frames.h"
#include "app/meter.h"

static const ruga_option options[] = {
    {"--frame", "-f", "K", "the frame, counted from 0 [the last]", false},
    {"--json", "-j", NULL, "print one JSON object in SI units", false},
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
    ruga_say(arguments, "%-22s%.6g m^3\n", "volume", m->values.volume);
    ruga_say(arguments, "%-22s%s\n", "outcome", ruga_outcome_name(r->outcome));
    ruga_say(arguments, "%-22s%.2g (skin), %.2g (coupled), %.2g (constraints)\n", "residuals",
             r->residual_shell, r->residual_coupled, r->constraint_residual);
    const struct {
        const char* name;
        double value;
    } energies[] = {
        {"energy, membrane", r->energy_membrane},     {"energy, bending", r->energy_bending},
        {"energy, foundation", r->energy_foundation}, {"energy, interior", r->energy_interior},
        {"energy, kinetic", r->energy_kinetic},       {"energy, external", r->energy_external},
    };
    for (size_t i = 0; i < sizeof energies / sizeof energies[0]; i++) {
        ruga_say(arguments, "%-22s%.4g J\n", energies[i].name, energies[i].value);
    }
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    ruga_result_reader* reader;
    ruga_frame_range range;
    ruga_measurement m;
    RUGA_TRY(ruga_open_result(ruga_operand(arguments), &reader));
    RUGA_TRY_DONE(ruga_choose_frames(arguments, ruga_result_frame_count(reader), false, &range));
    RUGA_TRY_DONE(ruga_measurement_take(reader, range.first, &m));
    if (ruga_given(arguments, "--json")) {
        status = ruga_print_json(ruga_measurement_json(&m));
    } else {
        say_measurement(arguments, &m);
    }
done:
    ruga_result_reader_close(&reader);
    return status;
}

const ruga_command ruga_measure_command = {
    .name = "measure",
    .operand = "RESULT",
    .usage = "[--frame K] [--json]",
    .summary = "measure wavelength, amplitude, volume and energies of a frame",
    .about =
        "Wavelength and amplitude are those of the skin's distance from the interior's smooth surface, along "
        "its\n"
        "normal; on a flat sheet the wavelength is also found by FFT along strips. What has no meaning (no\n"
        "interior, no wrinkle, not a flat sheet) is shown as - and is null in JSON.",
    .example = "    ruga measure pillow.h5 --frame 10 --json",
    .options = options,
    .run = run,
};
