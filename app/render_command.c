// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga render: pictures of frames.
#include "app/command.h"
#include "app/console.h"
#include "app/frames.h"
#include "app/measure.h"
#include "core/memory.h"
#include "view/render.h"

#include <math.h>

enum { PIXELS_MAX = 16384, COLOR_CLAY = 0, COLOR_DISPLACEMENT = 1 }; // further ones: what a varying skin has
static const double DEGREE = 0.017453292519943295;
static const double ELEVATION_MAX = 1.5533; // 89 deg: straight from above, no side of the picture is up

static const char colors[] = "clay|displacement|thickness|young|wavelength", axes[] = "x|y|z";

static const ruga_option options[] = {
    {"--frame", "-f", "K", "the frame, counted from 0 [the last]", false},
    {"--frames", NULL, "A:B", "frames, both ends included", false},
    {"--width", NULL, "PIXELS", "width of the picture [1280]", false},
    {"--height", NULL, "PIXELS", "height of the picture [960]", false},
    {"--color", NULL, colors,
     "clay; displacement: how far the skin stands off the interior; thickness, young or\n"
     "wavelength of a skin that varies [clay]",
     false},
    {"--up", NULL, axes, "the axis that points up [z]", false},
    {"--azimuth", NULL, "ANGLE", "where the camera stands, turned about the up axis [-63 deg]", false},
    {"--elevation", NULL, "ANGLE", "how far above the horizon the camera stands [34 deg]", false},
    {"--output", "-o", "PNG", "the file to write; for several frames a name with %04d in it", false},
    {0},
};

typedef struct job {
    const ruga_arguments* arguments;
    ruga_result_reader* reader;
    const char* pattern;
    ruga_render_def def;
    ruga_measure* measure; // where coloured by displacement
    double *position, *embedded;
} job;

static ruga_status read_frame(job* j, int frame) {
    RUGA_TRY(
        ruga_result_read_frame(j->reader, frame, NULL, j->position, j->measure ? j->embedded : NULL, NULL));
    ruga_measured unused;
    return j->measure ? ruga_measure_frame(j->measure, j->position, j->embedded, &unused) : RUGA_OK;
}

// One scale, symmetric about zero, for all frames of a film.
static ruga_status choose_scale(job* j, const ruga_frame_range* range) {
    double largest = 0;
    for (int frame = range->first; frame <= range->last; frame++) {
        RUGA_TRY(read_frame(j, frame));
        const double* w = ruga_measure_displacement(j->measure);
        for (int v = 0; v < ruga_result_mesh(j->reader)->vertex_count; v++) {
            largest = fmax(largest, fabs(w[v]));
        }
    }
    j->def.scalar = ruga_measure_displacement(j->measure);
    j->def.scalar_max = largest > 0 ? largest : 1e-6;
    j->def.scalar_min = -j->def.scalar_max;
    ruga_say(j->arguments, "colours from %.3g mm to %.3g mm\n", 1e3 * j->def.scalar_min,
             1e3 * j->def.scalar_max);
    return RUGA_OK;
}

// Colours by a value of the skin at the vertices; `color` is its place among the choices.
static ruga_status choose_value(job* j, int color) {
    static const char* const names[] = {"thickness", "Young's modulus", "wavelength"};
    static const char* const units[] = {"m", "Pa", "m"};
    const ruga_result_header* header = ruga_result_reader_header(j->reader);
    const double* const values[] = {header->vertex_thickness, header->vertex_young,
                                    header->vertex_wavelength};
    int which = color - COLOR_DISPLACEMENT - 1;
    if (!values[which]) {
        return ruga_fail(RUGA_BAD_INPUT, "--color: the %s of the skin in %s does not vary", names[which],
                         ruga_operand(j->arguments));
    }
    j->def.scalar = values[which];
    j->def.scalar_min = INFINITY;
    j->def.scalar_max = -INFINITY;
    for (int v = 0; v < ruga_result_mesh(j->reader)->vertex_count; v++) {
        j->def.scalar_min = fmin(j->def.scalar_min, values[which][v]);
        j->def.scalar_max = fmax(j->def.scalar_max, values[which][v]);
    }
    ruga_say(j->arguments, "colours from %.4g %s to %.4g %s\n", j->def.scalar_min, units[which],
             j->def.scalar_max, units[which]);
    return RUGA_OK;
}

static ruga_status choose_camera(job* j) {
    int up = 2;
    RUGA_TRY(ruga_option_choice(j->arguments, "--up", axes, &up));
    for (int i = 0; i < 3; i++) {
        j->def.up[i] = i == up;
    }
    RUGA_TRY(ruga_quantity(j->arguments, "--azimuth", "rad", &j->def.azimuth));
    RUGA_TRY(ruga_quantity(j->arguments, "--elevation", "rad", &j->def.elevation));
    if (!(fabs(j->def.elevation) < ELEVATION_MAX)) {
        return ruga_fail(RUGA_BAD_INPUT, "--elevation: %g deg is not between -89 and 89 deg",
                         j->def.elevation / DEGREE);
    }
    return RUGA_OK;
}

static ruga_status prepare(job* j, const ruga_frame_range* range) {
    int color = COLOR_CLAY;
    RUGA_TRY(choose_camera(j));
    RUGA_TRY(ruga_integer(j->arguments, "--width", 16, PIXELS_MAX, &j->def.width));
    RUGA_TRY(ruga_integer(j->arguments, "--height", 16, PIXELS_MAX, &j->def.height));
    RUGA_TRY(ruga_option_choice(j->arguments, "--color", colors, &color));
    const ruga_mesh* mesh = ruga_result_mesh(j->reader);
    const ruga_result_header* header = ruga_result_reader_header(j->reader);
    RUGA_TRY(RUGA_NEW(j->position, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY(RUGA_NEW(j->embedded, 3 * (size_t)mesh->vertex_count));
    if (color == COLOR_CLAY) {
        return RUGA_OK;
    }
    if (color > COLOR_DISPLACEMENT) {
        return choose_value(j, color);
    }
    if (!ruga_result_has_interior(j->reader)) {
        return ruga_fail(RUGA_BAD_INPUT, "--color displacement: %s has no interior to measure from",
                         ruga_operand(j->arguments));
    }
    RUGA_TRY(ruga_measure_create_local(mesh, header->wavelength, header->vertex_wavelength, header->seed,
                                       &j->measure));
    return choose_scale(j, range);
}

static ruga_status render_frame(job* j, int frame) {
    char* path = NULL;
    RUGA_TRY(read_frame(j, frame));
    RUGA_TRY(ruga_frame_path(j->pattern, frame, &path));
    ruga_status status = ruga_render_png(ruga_result_mesh(j->reader), j->position, &j->def, path);
    if (status == RUGA_OK) {
        ruga_say(j->arguments, "%s\n", path);
    }
    ruga_release(path);
    return status;
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    ruga_frame_range range;
    job j = {.arguments = arguments, .def = ruga_default_render_def()};
    RUGA_TRY(ruga_required(arguments, "--output", &j.pattern));
    RUGA_TRY_DONE(ruga_open_frames(arguments, j.pattern, &j.reader, &range));
    j.def.width = 1280;
    j.def.height = 960;
    RUGA_TRY_DONE(prepare(&j, &range));
    for (int frame = range.first; frame <= range.last; frame++) {
        RUGA_TRY_DONE(render_frame(&j, frame));
    }
done:
    ruga_measure_destroy(&j.measure);
    ruga_release(j.position);
    ruga_release(j.embedded);
    ruga_result_reader_close(&j.reader);
    return status;
}

const ruga_command ruga_render_command = {
    .name = "render",
    .operand = "RESULT",
    .usage =
        "[--frame K | --frames A:B] [--width W] [--height H] [--color NAME] [--up AXIS] -o PNG_OR_PATTERN",
    .summary = "draw frames of a result as PNG pictures",
    .about = "Draws the skin. For several frames the file's name holds a place for the number, such as "
             "f_%04d.png;\n"
             "a name with such a place and no frames given means all of them.",
    .example = "    ruga render pillow.h5 --frame 50 --color displacement -o pillow.png",
    .options = options,
    .run = run,
};
