// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/panels.h"

#include "app/command.h"
#include "app/measure.h"
#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

const ruga_panel_kind ruga_panel_kinds[] = {
    {"energy", "membrane, bending, foundation, interior, kinetic, external, hinges and their sum"},
    {"residual", "of the skin, the coupled system and the constraints"},
    {"iterations", "Newton steps, linear iterations, factorisations and substeps"},
    {"seconds", "where the time of a frame went"},
    {"wavelength", "of the wrinkles, with the one predicted"},
    {"amplitude", "of the wrinkles"},
    {"angle", "fold angles of the creases, with their range along each"},
    {"force", "that holds each handle"},
    {NULL, NULL},
};

typedef struct job {
    const char* path;
    ruga_result_reader* reader;
    ruga_panels* panels;
    ruga_panel* panel;
    double* wrinkle[3]; // [T] of measure_frames
} job;

static ruga_status add_series(job* j, const char* name, double** y) {
    ruga_panel_series* s = &j->panel->series[j->panel->series_count];
    RUGA_ASSERT(j->panel->series_count < RUGA_PANEL_SERIES);
    RUGA_TRY(RUGA_NEW_ZERO(s->y, j->panels->frame_count));
    (void)snprintf(s->name, sizeof s->name, "%s", name);
    j->panel->series_count++;
    *y = s->y;
    return RUGA_OK;
}

// ---- numbers of the report -----------------------------------------------------------------------------

typedef struct field {
    const char* name;
    size_t place;
    bool whole;
} field;
#define FIELD(label, member)                                                                                 \
    { label, offsetof(ruga_report, member), false }
#define COUNT(label, member)                                                                                 \
    { label, offsetof(ruga_report, member), true }

static const field energies[] = {FIELD("membrane", energy_membrane),     FIELD("bending", energy_bending),
                                 FIELD("foundation", energy_foundation), FIELD("interior", energy_interior),
                                 FIELD("kinetic", energy_kinetic),       FIELD("external", energy_external),
                                 FIELD("hinges", energy_hinge),          {NULL, 0, false}};
static const field residuals[] = {FIELD("skin", residual_shell),
                                  FIELD("coupled", residual_coupled),
                                  FIELD("constraints", constraint_residual),
                                  {NULL, 0, false}};
static const field counts[] = {COUNT("Newton steps", newton_iterations),
                               COUNT("linear iterations", linear_iterations),
                               COUNT("factorisations", factorizations),
                               COUNT("substeps", substeps),
                               {NULL, 0, false}};
static const field times[] = {FIELD("interior", seconds_interior),
                              FIELD("assembly", seconds_assembly),
                              FIELD("factor", seconds_factor),
                              FIELD("solve", seconds_solve),
                              FIELD("other", seconds_other),
                              FIELD("total", seconds_total),
                              {NULL, 0, false}};

static double field_value(const field* f, const ruga_report* report) {
    const char* at = (const char*)report + f->place;
    int whole;
    double value;
    if (f->whole) {
        memcpy(&whole, at, sizeof whole);
        return whole;
    }
    memcpy(&value, at, sizeof value);
    return value;
}

// Series that are zero throughout are left out, unless all are.
static ruga_status read_fields(job* j, const field* fields, bool sum) {
    double* y[RUGA_PANEL_SERIES] = {NULL};
    int count = 0;
    for (; fields[count].name; count++) {
        RUGA_TRY(add_series(j, fields[count].name, &y[count]));
    }
    if (sum) {
        RUGA_TRY(add_series(j, "sum", &y[count]));
    }
    for (int frame = 0; frame < j->panels->frame_count; frame++) {
        ruga_report report;
        RUGA_TRY(ruga_result_read_frame(j->reader, frame, NULL, NULL, NULL, &report));
        for (int k = 0; k < count; k++) {
            y[k][frame] = field_value(&fields[k], &report);
            if (sum) {
                y[count][frame] += y[k][frame];
            }
        }
    }
    int kept = 0;
    for (int k = 0; k < j->panel->series_count; k++) {
        ruga_panel_series* s = &j->panel->series[k];
        bool any = false;
        for (int frame = 0; frame < j->panels->frame_count; frame++) {
            any = any || s->y[frame] > 0 || (s->y[frame] < 0 && !j->panel->logarithmic);
        }
        if (any) {
            ruga_panel_series swap = j->panel->series[kept];
            j->panel->series[kept++] = *s;
            *s = swap;
        }
    }
    for (int k = kept > 0 ? kept : 1; k < j->panel->series_count; k++) {
        ruga_release(j->panel->series[k].y);
    }
    j->panel->series_count = kept > 0 ? kept : 1;
    return RUGA_OK;
}

// ---- wrinkles ------------------------------------------------------------------------------------------

// Wavelength, that by Fourier transform, and amplitude of every frame, mm; once for all panels.
static ruga_status measure_frames(job* j) {
    const ruga_result_header* header = ruga_result_reader_header(j->reader);
    const ruga_mesh* mesh = ruga_result_mesh(j->reader);
    double *position = NULL, *embedded = NULL;
    ruga_measure* measure = NULL;
    ruga_status status = RUGA_OK;
    if (j->wrinkle[0] || !ruga_result_has_interior(j->reader)) {
        return RUGA_OK;
    }
    for (int k = 0; k < 3; k++) {
        RUGA_TRY_DONE(RUGA_NEW(j->wrinkle[k], j->panels->frame_count));
    }
    RUGA_TRY_DONE(RUGA_NEW(position, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(embedded, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY_DONE(ruga_measure_create_local(mesh, header->wavelength, header->vertex_wavelength, header->seed,
                                            &measure));
    for (int frame = 0; frame < j->panels->frame_count; frame++) {
        ruga_measured m;
        RUGA_TRY_DONE(ruga_result_read_frame(j->reader, frame, NULL, position, embedded, NULL));
        RUGA_TRY_DONE(ruga_measure_frame(measure, position, embedded, &m));
        // Where there is no wrinkle to speak of, its length is that of the noise.
        bool seen = m.amplitude > 1e-6 * header->wavelength;
        j->wrinkle[0][frame] = seen && m.wavelength > 0 ? 1e3 * m.wavelength : NAN;
        j->wrinkle[1][frame] = seen && m.wavelength_fft > 0 ? 1e3 * m.wavelength_fft : NAN;
        j->wrinkle[2][frame] = 1e3 * m.amplitude;
    }
done:
    ruga_measure_destroy(&measure);
    ruga_release(position);
    ruga_release(embedded);
    return status;
}

static ruga_status add_wrinkle(job* j, int which, const char* name) {
    double* y;
    bool any = false;
    for (int frame = 0; frame < j->panels->frame_count; frame++) {
        any = any || isfinite(j->wrinkle[which][frame]);
    }
    if (any) {
        RUGA_TRY(add_series(j, name, &y));
        memcpy(y, j->wrinkle[which], (size_t)j->panels->frame_count * sizeof *y);
    }
    return RUGA_OK;
}

static ruga_status read_wrinkles(job* j, bool amplitude) {
    RUGA_TRY(measure_frames(j));
    if (!j->wrinkle[2]) {
        return RUGA_OK;
    }
    if (amplitude) {
        return add_wrinkle(j, 2, "amplitude");
    }
    j->panel->reference = 1e3 * ruga_result_reader_header(j->reader)->wavelength;
    j->panel->reference_name = "predicted";
    RUGA_TRY(add_wrinkle(j, 0, "wavelength"));
    return add_wrinkle(j, 1, "by Fourier transform");
}

// ---- creases and handles -------------------------------------------------------------------------------

// Mean by length and range over the segments of one group, deg.
static ruga_status add_group(job* j, const char* name, const int* group, int which, double* angle) {
    const ruga_result_creases* creases = ruga_result_reader_header(j->reader)->creases;
    int frames = j->panels->frame_count;
    double *mean, length = 0;
    for (int s = 0; s < creases->segment_count; s++) {
        length += group[s] == which ? creases->length[s] : 0;
    }
    if (!(length > 0)) { // a cut, or no valley at all
        return RUGA_OK;
    }
    RUGA_TRY(add_series(j, name, &mean));
    ruga_panel_series* out = &j->panel->series[j->panel->series_count - 1];
    RUGA_TRY(RUGA_NEW(out->low, frames));
    RUGA_TRY(RUGA_NEW(out->high, frames));
    for (int frame = 0; frame < frames; frame++) {
        RUGA_TRY(ruga_result_read_creases(j->reader, frame, angle, NULL, NULL));
        out->low[frame] = INFINITY;
        out->high[frame] = -INFINITY;
        for (int s = 0; s < creases->segment_count; s++) {
            if (group[s] == which) {
                double degrees = angle[s] * 180 / RUGA_PI;
                mean[frame] += creases->length[s] / length * degrees;
                out->low[frame] = fmin(out->low[frame], degrees);
                out->high[frame] = fmax(out->high[frame], degrees);
            }
        }
    }
    return RUGA_OK;
}

// A curve for each crease while they can be told apart, otherwise one for all valleys and one for all
// mountains, as the segments end up.
static ruga_status read_angles(job* j) {
    const ruga_result_creases* creases = ruga_result_reader_header(j->reader)->creases;
    const char* const kinds[2] = {"valleys", "mountains"};
    double* angle = NULL;
    int* group = NULL;
    ruga_status status = RUGA_OK;
    if (!creases) {
        return RUGA_OK;
    }
    bool each = creases->crease_count <= RUGA_PANEL_SERIES;
    RUGA_TRY_DONE(RUGA_NEW(group, creases->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(angle, creases->segment_count));
    RUGA_TRY_DONE(ruga_result_read_creases(j->reader, j->panels->frame_count - 1, angle, NULL, NULL));
    for (int s = 0; s < creases->segment_count; s++) {
        group[s] = each ? creases->crease[s] : angle[s] < 0;
    }
    for (int k = 0; k < (each ? creases->crease_count : 2); k++) {
        RUGA_TRY_DONE(add_group(j, each ? creases->name[k] : kinds[k], group, k, angle));
    }
done:
    ruga_release(group);
    ruga_release(angle);
    return status;
}

static ruga_status read_forces(job* j) {
    int handles = ruga_result_reader_header(j->reader)->handle_count;
    int shown = handles < RUGA_PANEL_SERIES ? handles : RUGA_PANEL_SERIES;
    double *y[RUGA_PANEL_SERIES], *force = NULL;
    ruga_status status = RUGA_NEW(force, 3 * (size_t)handles);
    for (int h = 0; h < shown && status == RUGA_OK; h++) {
        char name[32];
        (void)snprintf(name, sizeof name, "handle %d", h);
        status = add_series(j, name, &y[h]);
    }
    for (int frame = 0; frame < j->panels->frame_count && shown > 0 && status == RUGA_OK; frame++) {
        status = ruga_result_read_handle_force(j->reader, frame, force);
        for (int h = 0; h < shown && status == RUGA_OK; h++) {
            y[h][frame] = ruga_norm(force + 3 * (size_t)h);
        }
    }
    ruga_release(force);
    return status;
}

// ---- choosing ------------------------------------------------------------------------------------------

static ruga_status read_panel(job* j, int kind) {
    static const struct {
        const char* axis;
        bool logarithmic;
    } looks[] = {{"energy, J", false},       {"residual, relative", true}, {"in a frame", false},
                 {"time, s", false},         {"wavelength, mm", false},    {"amplitude, mm", false},
                 {"fold angle, deg", false}, {"force, N", false}};
    j->panel = &j->panels->panel[j->panels->count];
    *j->panel = (ruga_panel){
        .key = ruga_panel_kinds[kind].key, .axis = looks[kind].axis, .logarithmic = looks[kind].logarithmic};
    j->panels->count++;
    switch (kind) {
    case 0:
        return read_fields(j, energies, true);
    case 1:
        return read_fields(j, residuals, false);
    case 2:
        return read_fields(j, counts, false);
    case 3:
        return read_fields(j, times, false);
    case 4:
    case 5:
        return read_wrinkles(j, kind == 5);
    case 6:
        return read_angles(j);
    default:
        return read_forces(j);
    }
}

// Whether some series has a number to draw.
static bool has_data(const ruga_panel* panel, int frames) {
    for (int k = 0; k < panel->series_count; k++) {
        for (int i = 0; i < frames; i++) {
            double y = panel->series[k].y[i];
            if (isfinite(y) && (y > 0 || !panel->logarithmic)) {
                return true;
            }
        }
    }
    return false;
}

static ruga_status find_kind(const char* key, size_t length, int* kind) {
    char names[256] = "", sentence[384];
    for (int k = 0; ruga_panel_kinds[k].key; k++) {
        const char* name = ruga_panel_kinds[k].key;
        if (strlen(name) == length && strncmp(name, key, length) == 0) {
            *kind = k;
            return RUGA_OK;
        }
        size_t used = strlen(names);
        (void)snprintf(names + used, sizeof names - used, "%s%s", k > 0 ? "|" : "", name);
    }
    char word[48];
    (void)snprintf(word, sizeof word, "%.*s", (int)(length < 40 ? length : 40), key);
    (void)snprintf(sentence, sizeof sentence, "--what: there is no %s", word);
    ruga_suggest(names, word, sentence, sizeof sentence);
    return ruga_fail(RUGA_BAD_INPUT, "%s", sentence);
}

static ruga_status read_named(job* j, const char* what) {
    for (const char* key = what; *key;) {
        size_t length = strcspn(key, ",");
        int kind = 0;
        RUGA_TRY(find_kind(key, length, &kind));
        if (j->panels->count >= RUGA_PANELS_MAX) {
            return ruga_fail(RUGA_BAD_INPUT, "--what: at most %d plots on a page", RUGA_PANELS_MAX);
        }
        RUGA_TRY(read_panel(j, kind));
        if (!has_data(j->panel, j->panels->frame_count)) {
            return ruga_fail(RUGA_BAD_INPUT, "--what %s: %s has nothing of it", j->panel->key, j->path);
        }
        key += length + (key[length] == ',');
    }
    return RUGA_OK;
}

static void clear_panel(ruga_panel* panel) {
    for (int k = 0; k < panel->series_count; k++) {
        ruga_release(panel->series[k].y);
        ruga_release(panel->series[k].low);
        ruga_release(panel->series[k].high);
    }
    *panel = (ruga_panel){0};
}

static ruga_status read_all(job* j) {
    for (int kind = 0; ruga_panel_kinds[kind].key; kind++) {
        RUGA_TRY(read_panel(j, kind));
        if (!has_data(j->panel, j->panels->frame_count)) {
            clear_panel(j->panel);
            j->panels->count--;
        }
    }
    return RUGA_OK;
}

ruga_status ruga_panels_read(const char* path, ruga_result_reader* reader, const char* what,
                             ruga_panels* panels) {
    job j = {.path = path, .reader = reader, .panels = panels};
    *panels = (ruga_panels){.frame_count = ruga_result_frame_count(reader)};
    RUGA_TRY(RUGA_NEW(panels->time, panels->frame_count));
    for (int frame = 0; frame < panels->frame_count; frame++) {
        RUGA_TRY(ruga_result_read_frame(reader, frame, &panels->time[frame], NULL, NULL, NULL));
    }
    ruga_status status = what ? read_named(&j, what) : read_all(&j);
    for (int k = 0; k < 3; k++) {
        ruga_release(j.wrinkle[k]);
    }
    return status;
}

void ruga_panels_clear(ruga_panels* panels) {
    for (int p = 0; p < panels->count; p++) {
        clear_panel(&panels->panel[p]);
    }
    ruga_release(panels->time);
    *panels = (ruga_panels){0};
}
