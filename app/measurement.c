// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/measurement.h"

#include "app/console.h"
#include "app/meter.h"
#include "core/memory.h"

ruga_status ruga_measurement_take(ruga_result_reader* reader, int frame, ruga_measurement* m) {
    ruga_status status = RUGA_OK;
    *m = (ruga_measurement){.frame = frame};
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
        RUGA_TRY_DONE(ruga_measure_create_local(mesh, header->wavelength, header->vertex_wavelength, header->seed,
                                                &measure));
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

// A length that is 0 where it has no meaning.
static json_t* length_json(double length) {
    return length > 0 ? ruga_json_number(length) : json_null();
}

json_t* ruga_measurement_json(const ruga_measurement* m) {
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
