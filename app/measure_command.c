// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga measure: wavelength, amplitude and how good a frame's equilibrium is.
#include "app/measure.h"

#include "app/command.h"
#include "app/console.h"
#include "app/frames.h"
#include "app/meter.h"
#include "core/memory.h"

static const ruga_option options[] = {
    {"--frame", "-f", "K", "the frame, counted from 0 [the last]", false},
    {"--json", "-j", NULL, "print one JSON object in SI units", false},
    {0},
};

typedef struct measurement {
    int frame;
    double time, predicted;
    bool tied; // there is an interior, so that a wrinkle is a distance from it
    ruga_measured values;
    ruga_report report;
} measurement;

static ruga_status measure_frame(ruga_result_reader* reader, measurement* m) {
    ruga_status status = RUGA_OK;
    const ruga_result_header* header = ruga_result_reader_header(reader);
    const ruga_mesh* mesh = ruga_result_mesh(reader);
    double *position = NULL, *embedded = NULL;
    ruga_measure* measure = NULL;
    m->tied = ruga_result_has_interior(reader);
    m->predicted = header->wavelength;
    RUGA_TRY_DONE(RUGA_NEW(position, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(embedded, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY_DONE(
        ruga_result_read_frame(reader, m->frame, &m->time, position, m->tied ? embedded : NULL, &m->report));
    if (m->tied) {
        RUGA_TRY_DONE(ruga_measure_create_local(mesh, header->wavelength, header->vertex_wavelength,
                                                header->seed, &measure));
        RUGA_TRY_DONE(ruga_measure_frame(measure, position, embedded, &m->values));
    } else {
        ruga_mesh deformed = *mesh;
        deformed.position = position;
        m->values.volume = ruga_mesh_volume(&deformed);
    }
done:
    ruga_measure_destroy(&measure);
    ruga_release(position);
    ruga_release(embedded);
    return status;
}

// ---- output --------------------------------------------------------------------------------------------

// A length that is 0 where it has no meaning.
static json_t* length_json(double length) {
    return length > 0 ? ruga_json_number(length) : json_null();
}

static json_t* measurement_json(const measurement* m) {
    const ruga_report* r = &m->report;
    json_t* energy = json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o}", "membrane", ruga_json_number(r->energy_membrane), "bending",
        ruga_json_number(r->energy_bending), "foundation", ruga_json_number(r->energy_foundation), "interior",
        ruga_json_number(r->energy_interior), "kinetic", ruga_json_number(r->energy_kinetic), "external",
        ruga_json_number(r->energy_external));
    return json_pack("{s:i, s:o, s:o, s:o, s:o, s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:[]}", "frame", m->frame,
                     "time", ruga_json_number(m->time), "wavelength", length_json(m->values.wavelength),
                     "wavelength_fft", length_json(m->values.wavelength_fft), "wavelength_predicted",
                     length_json(m->predicted), "amplitude",
                     m->tied ? ruga_json_number(m->values.amplitude) : json_null(), "outcome",
                     ruga_outcome_name(r->outcome), "residual_shell", ruga_json_number(r->residual_shell),
                     "residual_coupled", ruga_json_number(r->residual_coupled), "constraint_residual",
                     ruga_json_number(r->constraint_residual), "volume", ruga_json_number(m->values.volume),
                     "energy", energy, "creases");
}

static void say_length(const ruga_arguments* arguments, const char* name, double metres) {
    if (metres > 0) {
        ruga_say(arguments, "%-22s%.4g mm\n", name, 1e3 * metres);
    } else {
        ruga_say(arguments, "%-22s-\n", name);
    }
}

static void say_measurement(const ruga_arguments* arguments, const measurement* m) {
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
    measurement m = {0};
    RUGA_TRY(ruga_open_result(ruga_operand(arguments), &reader));
    RUGA_TRY_DONE(ruga_choose_frames(arguments, ruga_result_frame_count(reader), false, &range));
    m.frame = range.first;
    RUGA_TRY_DONE(measure_frame(reader, &m));
    if (ruga_given(arguments, "--json")) {
        status = ruga_print_json(measurement_json(&m));
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
