// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga view: an animation as one page for a browser.
#include "app/camera_options.h"
#include "app/coloring.h"
#include "app/command.h"
#include "app/console.h"
#include "app/frames.h"
#include "app/meter.h"
#include "app/panels.h"
#include "core/memory.h"
#include "core/vec3.h"
#include "view/page.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { COLORS = 256 };

static const ruga_option options[] = {
    {"--frames", NULL, "A:B", "frames, both ends included [all]", false},
    RUGA_CAMERA_OPTIONS,
    {"--output", "-o", "PAGE.html", "the file to write", false},
    {0},
};

typedef struct job {
    const ruga_arguments* arguments;
    const char* path;
    ruga_result_reader* reader;
    ruga_frame_range range;
    int frames, vertices;
    bool tied; // there is an interior
    ruga_render_def def;
    ruga_measure* measure;
    ruga_panels panels;
    double *position, *embedded;
    float* displacement;                   // [T][V] m
    double low[3], high[3], step, largest; // of all frames; largest displacement, m
    uint16_t* place;                       // [V][3] of the frame before, and the embedded surface's
    uint16_t* embedded_place;
    unsigned char *wrinkled, *flat, *values; // the packed arrays
    uint32_t* triangles;
} job;

static ruga_status read_frame(job* j, int frame) {
    return ruga_result_read_frame(j->reader, frame, NULL, j->position, j->tied ? j->embedded : NULL, NULL);
}

static void widen(job* j, const double* position) {
    for (int i = 0; i < 3 * j->vertices; i++) {
        j->low[i % 3] = fmin(j->low[i % 3], position[i]);
        j->high[i % 3] = fmax(j->high[i % 3], position[i]);
    }
}

// One box and one scale of colours for all frames.
static ruga_status measure_all(job* j) {
    for (int k = 0; k < 3; k++) {
        j->low[k] = INFINITY;
        j->high[k] = -INFINITY;
    }
    for (int frame = j->range.first; frame <= j->range.last; frame++) {
        RUGA_TRY(read_frame(j, frame));
        widen(j, j->position);
        if (j->tied) {
            widen(j, j->embedded);
        }
        ruga_measured unused;
        RUGA_TRY(j->tied ? ruga_measure_frame(j->measure, j->position, j->embedded, &unused) : RUGA_OK);
        for (int v = 0; j->tied && v < j->vertices; v++) {
            double w = ruga_measure_displacement(j->measure)[v];
            j->displacement[(size_t)(frame - j->range.first) * (size_t)j->vertices + (size_t)v] = (float)w;
            j->largest = fmax(j->largest, fabs(w));
        }
    }
    for (int k = 0; k < 3; k++) {
        j->step = fmax(j->step, (j->high[k] - j->low[k]) / 65535);
    }
    j->largest = j->largest > 0 ? j->largest : 1e-6;
    return RUGA_OK;
}

static ruga_status pack_all(job* j) {
    size_t row = 6 * (size_t)j->vertices;
    for (int t = 0; t < j->frames; t++) {
        RUGA_TRY(read_frame(j, j->range.first + t));
        ruga_page_pack(3 * j->vertices, j->position, j->low, j->step, j->place,
                       j->wrinkled + row * (size_t)t);
        if (!j->tied) {
            continue;
        }
        ruga_page_pack(3 * j->vertices, j->embedded, j->low, j->step, j->embedded_place,
                       j->flat + row * (size_t)t);
        for (size_t i = (size_t)t * (size_t)j->vertices; i < (size_t)(t + 1) * (size_t)j->vertices; i++) {
            double part = 0.5 + 0.5 * (double)j->displacement[i] / j->largest;
            j->values[i] = (unsigned char)((COLORS - 1) * part + 0.5);
        }
    }
    return RUGA_OK;
}

// ---- the JSON object -----------------------------------------------------------------------------------

static json_t* colors_json(void) {
    json_t* list = json_array();
    for (int i = 0; i < COLORS; i++) {
        double rgb[3];
        ruga_colormap(RUGA_COLORMAP_DIVERGING, (double)i / (COLORS - 1), rgb);
        (void)json_array_append_new(list,
                                    json_integer((json_int_t)ruga_srgb(rgb[0]) << 16 |
                                                 (json_int_t)ruga_srgb(rgb[1]) << 8 | ruga_srgb(rgb[2])));
    }
    return list;
}

static json_t* numbers_json(const job* j, const double* values) {
    json_t* list = json_array();
    for (int t = 0; t < j->frames; t++) {
        (void)json_array_append_new(list, ruga_json_number(values[j->range.first + t]));
    }
    return list;
}

static json_t* panels_json(const job* j) {
    json_t* list = json_array();
    for (int p = 0; p < j->panels.count; p++) {
        const ruga_panel* panel = &j->panels.panel[p];
        json_t* series = json_array();
        for (int k = 0; k < panel->series_count; k++) {
            (void)json_array_append_new(series, json_pack("{s:s, s:o}", "name", panel->series[k].name, "y",
                                                          numbers_json(j, panel->series[k].y)));
        }
        (void)json_array_append_new(list, json_pack("{s:s, s:b, s:o}", "axis", panel->axis, "log",
                                                    (int)panel->logarithmic, "series", series));
    }
    return list;
}

static ruga_status outcomes_json(job* j, json_t** list) {
    *list = json_array();
    for (int frame = j->range.first; frame <= j->range.last; frame++) {
        ruga_report report;
        RUGA_TRY(ruga_result_read_frame(j->reader, frame, NULL, NULL, NULL, &report));
        (void)json_array_append_new(*list, json_string(ruga_outcome_name(report.outcome)));
    }
    return RUGA_OK;
}

static void add_fact(json_t* facts, const char* name, const char* format, double value) {
    char text[64];
    (void)snprintf(text, sizeof text, format, value);
    (void)json_array_append_new(facts, json_pack("[s, s]", name, text));
}

static json_t* facts_json(const job* j) {
    const ruga_result_header* header = ruga_result_reader_header(j->reader);
    json_t* facts = json_array();
    int elements;
    add_fact(facts, "vertices", "%.0f", j->vertices);
    add_fact(facts, "triangles", "%.0f", header->mesh->triangle_count);
    if (j->tied && ruga_result_read_lattice(j->reader, 0, NULL, &elements, NULL) == RUGA_OK) {
        add_fact(facts, "lattice elements", "%.0f", elements);
        add_fact(facts, "predicted wavelength", "%.4g mm", 1e3 * header->wavelength);
        add_fact(facts, "critical strain", "%.3g %%", 1e2 * header->critical_strain);
        add_fact(facts, "largest displacement", "%.3g mm", 1e3 * j->largest);
    }
    return facts;
}

static const char* file_name(const char* path) {
    const char* slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

// What is not UTF-8 is left out rather than making the whole page fail.
static json_t* text_json(const char* text) {
    json_t* json = json_string(text);
    return json ? json : json_string("");
}

// The direction to the camera, by a camera that is framed on the box.
static void find_view(const job* j, double toward[3]) {
    const double corner[2][3] = {{j->low[0], j->low[1], j->low[2]}, {j->high[0], j->high[1], j->high[2]}};
    ruga_view view = {.azimuth = j->def.azimuth,
                      .elevation = fmin(fmax(j->def.elevation, -1.55), 1.55),
                      .up = {j->def.up[0], j->def.up[1], j->def.up[2]},
                      .fit = 1};
    ruga_camera camera;
    ruga_camera_frame(2, corner[0], &view, 100, 100, &camera);
    for (int k = 0; k < 3; k++) {
        toward[k] = -camera.forward[k];
    }
}

static ruga_status make_json(job* j, char** text) {
    double middle[3], toward[3];
    json_t* outcome = NULL;
    RUGA_TRY(outcomes_json(j, &outcome));
    find_view(j, toward);
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * (j->low[k] + j->high[k]);
    }
    const char* scene = ruga_result_reader_header(j->reader)->scene_text;
    json_t* object = json_pack(
        "{s:o, s:i, s:i, s:b, s:o, s:f, s:o, s:f, s:o, s:o, s:f, s:o, s:o, s:o, s:o, s:o}", "name",
        text_json(file_name(ruga_operand(j->arguments))), "vertices", j->vertices, "frames", j->frames,
        "embedded", (int)j->tied, "low", ruga_json_vector(j->low), "step", j->step, "middle",
        ruga_json_vector(middle), "radius", fmax(0.5 * ruga_distance(j->low, j->high), 1e-9), "up",
        ruga_json_vector(j->def.up), "toward", ruga_json_vector(toward), "displacement", 1e3 * j->largest,
        "colors", colors_json(), "time", numbers_json(j, j->panels.time), "outcome", outcome, "panels",
        panels_json(j), "facts", facts_json(j));
    (void)json_object_set_new(object, "scene", text_json(scene));
    *text = object ? json_dumps(object, JSON_COMPACT | JSON_ESCAPE_SLASH) : NULL;
    json_decref(object);
    return *text ? RUGA_OK : ruga_fail(RUGA_NO_MEMORY, "out of memory while making the page");
}

// ---- the command ---------------------------------------------------------------------------------------

static ruga_status prepare(job* j) {
    const ruga_result_header* header = ruga_result_reader_header(j->reader);
    size_t vertices = (size_t)j->vertices, frames = (size_t)j->frames, corners;
    corners = 3 * (size_t)header->mesh->triangle_count;
    RUGA_TRY(ruga_camera_options(j->arguments, header->scene_text, &j->def));
    RUGA_TRY(RUGA_NEW(j->position, 3 * vertices));
    RUGA_TRY(RUGA_NEW(j->embedded, 3 * vertices));
    RUGA_TRY(RUGA_NEW_ZERO(j->place, 3 * vertices));
    RUGA_TRY(RUGA_NEW_ZERO(j->embedded_place, 3 * vertices));
    RUGA_TRY(RUGA_NEW(j->wrinkled, 6 * vertices * frames));
    RUGA_TRY(RUGA_NEW(j->flat, j->tied ? 6 * vertices * frames : 0));
    RUGA_TRY(RUGA_NEW(j->displacement, j->tied ? vertices * frames : 0));
    RUGA_TRY(RUGA_NEW(j->values, j->tied ? vertices * frames : 0));
    RUGA_TRY(RUGA_NEW(j->triangles, corners));
    for (size_t i = 0; i < corners; i++) {
        j->triangles[i] = (uint32_t)header->mesh->triangle[i];
    }
    if (j->tied) {
        RUGA_TRY(ruga_measure_create_local(header->mesh, header->wavelength, header->vertex_wavelength,
                                           header->seed, &j->measure));
    }
    return ruga_panels_read(ruga_operand(j->arguments), j->reader, NULL, &j->panels);
}

static ruga_status write_page(job* j) {
    char* json = NULL;
    size_t vertices = (size_t)j->vertices, frames = (size_t)j->frames;
    const ruga_page_array arrays[] = {
        {"triangles", 12 * (size_t)ruga_result_mesh(j->reader)->triangle_count,
         (const unsigned char*)j->triangles},
        {"wrinkled", 6 * vertices * frames, j->wrinkled},
        {"embedded", 6 * vertices * frames, j->flat},
        {"displacement", vertices * frames, j->values},
    };
    RUGA_TRY(make_json(j, &json));
    ruga_status status = ruga_page_write(j->path, json, j->tied ? 4 : 2, arrays);
    free(json);
    return status;
}

static void tell(const job* j) {
    struct stat info;
    if (stat(j->path, &info) == 0) {
        ruga_say(j->arguments, "%s: %d frames, %.1f MB\n", j->path, j->frames, 1e-6 * (double)info.st_size);
    }
}

static void clear(job* j) {
    ruga_measure_destroy(&j->measure);
    ruga_panels_clear(&j->panels);
    ruga_release(j->position);
    ruga_release(j->embedded);
    ruga_release(j->place);
    ruga_release(j->embedded_place);
    ruga_release(j->wrinkled);
    ruga_release(j->flat);
    ruga_release(j->displacement);
    ruga_release(j->values);
    ruga_release(j->triangles);
    ruga_result_reader_close(&j->reader);
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    job j = {.arguments = arguments, .def = ruga_default_render_def()};
    RUGA_TRY(ruga_required(arguments, "--output", &j.path));
    RUGA_TRY(ruga_check_output(j.path));
    if (ruga_page_shell_size == 0) {
        return ruga_page_write(j.path, "", 0, NULL); // says why
    }
    RUGA_TRY_DONE(ruga_open_result(ruga_operand(arguments), &j.reader));
    RUGA_TRY_DONE(ruga_choose_frames(arguments, ruga_result_frame_count(j.reader), true, &j.range));
    j.frames = j.range.last - j.range.first + 1;
    j.vertices = ruga_result_mesh(j.reader)->vertex_count;
    j.tied = ruga_result_has_interior(j.reader);
    RUGA_TRY_DONE(prepare(&j));
    RUGA_TRY_DONE(measure_all(&j));
    RUGA_TRY_DONE(pack_all(&j));
    RUGA_TRY_DONE(write_page(&j));
    tell(&j);
done:
    clear(&j);
    return status;
}

const ruga_command ruga_view_command = {
    .name = "view",
    .operand = "RESULT",
    .usage = "[--frames A:B] [--camera PLACE] [--up AXIS] -o PAGE.html",
    .summary = "write a page that shows the animation in a browser",
    .about = "One HTML file that needs no network: turn the skin, play and scrub, colour it by its "
             "displacement, and put\n"
             "it beside the interior's surface without wrinkles. The scene and the plots of the solver stand "
             "beside it.",
    .example = "    ruga view pillow.h5 -o pillow.html",
    .options = options,
    .run = run,
};
