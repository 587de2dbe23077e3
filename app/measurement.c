// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/measurement.h"

#include "app/console.h"
#include "app/meter.h"
#include "core/memory.h"
#include "mesh/crossing.h"

#include <math.h>
#include <string.h>

void ruga_measurement_clear(ruga_measurement* m) {
    ruga_release(m->crease);
    *m = (ruga_measurement){0};
}

static ruga_status take_creases(ruga_result_reader* reader, ruga_measurement* m) {
    const ruga_result_creases* creases = ruga_result_reader_header(reader)->creases;
    ruga_status status = RUGA_OK;
    double *angle = NULL, *rest = NULL, *gap = NULL;
    RUGA_TRY_DONE(RUGA_NEW(angle, creases->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(rest, creases->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(gap, creases->segment_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(m->crease, creases->crease_count));
    RUGA_TRY_DONE(ruga_result_read_creases(reader, m->frame, angle, rest, &m->gap));
    RUGA_TRY_DONE(ruga_result_read_segment_gaps(reader, m->frame, gap));
    m->crease_count = creases->crease_count;
    for (int c = 0; c < creases->crease_count; c++) {
        m->crease[c] = (ruga_measured_crease){
            .name = creases->name[c], .assignment = 'U', .angle_min = INFINITY, .angle_max = -INFINITY};
    }
    for (int s = 0; s < creases->segment_count; s++) {
        ruga_measured_crease* c = &m->crease[creases->crease[s]];
        double off = angle[s] - rest[s];
        c->assignment = creases->assignment[s];
        c->length += creases->length[s];
        c->angle_mean += creases->length[s] * angle[s];
        c->angle_min = fmin(c->angle_min, angle[s]);
        c->angle_max = fmax(c->angle_max, angle[s]);
        c->hinge_energy += 0.5 * creases->stiffness[s] * creases->length[s] * off * off;
        c->gap = fmax(c->gap, gap[s]);
    }
    int kept = 0; // a cut has no segments
    for (int c = 0; c < creases->crease_count; c++) {
        if (m->crease[c].length > 0) {
            m->crease[kept] = m->crease[c];
            m->crease[kept++].angle_mean /= m->crease[c].length;
        }
    }
    m->crease_count = kept;
done:
    ruga_release(angle);
    ruga_release(rest);
    ruga_release(gap);
    return status;
}

// A folding sheet may pass through itself, as nothing keeps its layers apart.
static ruga_status count_crossings(const ruga_mesh* mesh, const double* position, ruga_measurement* m) {
    ruga_mesh deformed = *mesh;
    ruga_crossings crossings = {0};
    double* copy = NULL;
    RUGA_TRY(RUGA_NEW(copy, 3 * (size_t)mesh->vertex_count));
    memcpy(copy, position, 3 * (size_t)mesh->vertex_count * sizeof *copy);
    deformed.position = copy;
    ruga_status status = ruga_mesh_crossings(&deformed, NULL, &crossings);
    m->crossings = crossings.count;
    ruga_crossings_clear(&crossings);
    ruga_release(copy);
    return status;
}

ruga_status ruga_measurement_take(ruga_result_reader* reader, int frame, ruga_measurement* m) {
    ruga_status status = RUGA_OK;
    *m = (ruga_measurement){.frame = frame, .crossings = -1};
    const ruga_result_header* header = ruga_result_reader_header(reader);
    const ruga_mesh* mesh = ruga_result_mesh(reader);
    double *position = NULL, *embedded = NULL;
    ruga_measure* measure = NULL;
    ruga_connectivity connectivity = {0};
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
        RUGA_TRY_DONE(ruga_connectivity_create(mesh, &connectivity));
        m->values.volume = ruga_measure_volume(mesh, &connectivity, position);
    }
    if (header->creases) {
        RUGA_TRY_DONE(take_creases(reader, m));
        RUGA_TRY_DONE(count_crossings(mesh, position, m));
    }
done:
    if (status != RUGA_OK) {
        ruga_measurement_clear(m);
    }
    ruga_measure_destroy(&measure);
    ruga_connectivity_clear(&connectivity);
    ruga_release(position);
    ruga_release(embedded);
    return status;
}

// A length that is 0 where it has no meaning.
static json_t* length_json(double length) {
    return length > 0 ? ruga_json_number(length) : json_null();
}

static json_t* creases_json(const ruga_measurement* m) {
    json_t* list = json_array();
    for (int c = 0; c < m->crease_count; c++) {
        const ruga_measured_crease* k = &m->crease[c];
        const char letter[2] = {k->assignment, '\0'};
        (void)json_array_append_new(
            list, json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "name", k->name, "assignment", letter,
                            "length", ruga_json_number(k->length), "angle_mean",
                            ruga_json_number(k->angle_mean), "angle_min", ruga_json_number(k->angle_min),
                            "angle_max", ruga_json_number(k->angle_max), "hinge_energy",
                            ruga_json_number(k->hinge_energy), "gap", ruga_json_number(k->gap)));
    }
    return list;
}

json_t* ruga_measurement_json(const ruga_measurement* m) {
    const ruga_report* r = &m->report;
    json_t* energy = json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "membrane", ruga_json_number(r->energy_membrane), "bending",
        ruga_json_number(r->energy_bending), "hinge", ruga_json_number(r->energy_hinge), "foundation",
        ruga_json_number(r->energy_foundation), "interior", ruga_json_number(r->energy_interior), "kinetic",
        ruga_json_number(r->energy_kinetic), "external", ruga_json_number(r->energy_external));
    return json_pack(
        "{s:i, s:o, s:o, s:o, s:o, s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "frame", m->frame, "time",
        ruga_json_number(m->time), "wavelength", length_json(m->values.wavelength), "wavelength_fft",
        length_json(m->values.wavelength_fft), "wavelength_predicted", length_json(m->predicted), "amplitude",
        m->tied ? ruga_json_number(m->values.amplitude) : json_null(), "outcome",
        ruga_outcome_name(r->outcome), "residual_shell", ruga_json_number(r->residual_shell),
        "residual_coupled", ruga_json_number(r->residual_coupled), "constraint_residual",
        ruga_json_number(r->constraint_residual), "volume", ruga_json_number(m->values.volume), "energy",
        energy, "crossings", m->crossings >= 0 ? json_integer(m->crossings) : json_null(), "creases",
        creases_json(m));
}
