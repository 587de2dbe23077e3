// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga creases: crease curves from a simulation, as a pattern to be edited and used again.
#include "app/command.h"
#include "app/console.h"
#include "app/frames.h"
#include "core/memory.h"
#include "core/vec3.h"
#include "crease/pattern.h"
#include "crease/ridge.h"
#include "io/file_name.h"
#include "io/fold.h"

#include <math.h>
#include <string.h>

static const char sources[] = "bending|stress";

static const ruga_option options[] = {
    {"--from", NULL, sources, "bending: ridges of bending energy; stress: of compressive stress [bending]",
     false},
    {"--frame", "-f", "K", "the frame, counted from 0 [the last]", false},
    {"--min-length", NULL, "LENGTH", "leave out shorter curves, m [ten edges]", false},
    {"--smooth", NULL, "LENGTH", "width over which fields and curves are smoothed, m [three edges]", false},
    {"--strength", NULL, "PART",
     "least energy density or stress of a curve at its strongest place, as a\n"
     "part of the largest [0.25]",
     false},
    {"--poisson", NULL, "NUMBER", "Poisson's ratio for stresses [0.3]", false},
    {"--output", "-o", "FILE",
     "the file to write, .fold, or for flat meshes .svg, in the unit of the mesh file", false},
    {0},
};

static ruga_status read_def(const ruga_arguments* arguments, ruga_ridge_def* def) {
    int from = 0;
    *def = ruga_default_ridge_def();
    RUGA_TRY(ruga_option_choice(arguments, "--from", sources, &from));
    def->stress = from == 1;
    RUGA_TRY(ruga_quantity(arguments, "--min-length", "m", &def->min_length));
    RUGA_TRY(ruga_quantity(arguments, "--smooth", "m", &def->smooth));
    RUGA_TRY(ruga_quantity(arguments, "--strength", "1", &def->strength));
    RUGA_TRY(ruga_quantity(arguments, "--poisson", "1", &def->poisson));
    const struct {
        const char* option;
        double value, low, high;
    } bounds[] = {{"--min-length", def->min_length, 0, INFINITY},
                  {"--smooth", def->smooth, 0, INFINITY},
                  {"--strength", def->strength, 1e-6, 1},
                  {"--poisson", def->poisson, -0.99, 0.5}};
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        if (!(bounds[i].value >= bounds[i].low) || !(bounds[i].value <= bounds[i].high)) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: %g is not between %g and %g", bounds[i].option,
                             bounds[i].value, bounds[i].low, bounds[i].high);
        }
    }
    return RUGA_OK;
}

// In z = 0: then the file is a crease pattern with its outline, otherwise curves in space.
static bool is_pattern(const ruga_mesh* mesh) {
    double low[3], high[3];
    ruga_mesh_bounds(mesh, low, high);
    return fmax(fabs(low[2]), fabs(high[2])) <= 1e-9 * ruga_distance(low, high);
}

static ruga_status check_output(const char* path, const ruga_mesh* mesh) {
    if (!ruga_file_name_ends(path, ".fold") && !ruga_file_name_ends(path, ".svg")) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: curves are written as .fold or .svg", path);
    }
    if (ruga_file_name_ends(path, ".svg") && !is_pattern(mesh)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: the surface is not flat at rest: its curves are written as .fold", path);
    }
    return ruga_check_output(path);
}

// In the unit of the mesh file, after unit and scale of its scene, so that a scene for the same file may name
// the curves.
static ruga_status write_curves(const char* path, const ruga_mesh* mesh, double unit,
                                const ruga_curves* curves, double time) {
    ruga_crease_pattern pattern = {.folded = !is_pattern(mesh)};
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(ruga_crease_pattern_add_curves(&pattern, curves));
    if (!pattern.folded) {
        RUGA_TRY_DONE(ruga_crease_pattern_add_boundary(&pattern, mesh));
    }
    if (ruga_file_name_ends(path, ".svg")) {
        RUGA_TRY_DONE(ruga_svg_write(path, &pattern, unit));
        goto done;
    }
    for (int i = 0; i < 3 * pattern.vertex_count; i++) {
        pattern.position[i / 3][i % 3] /= unit;
    }
    const ruga_fold_frame frame = {(const double*)pattern.position, NULL, time};
    RUGA_TRY_DONE(ruga_fold_write(path, &pattern, unit == 1 ? "m" : "unit", !pattern.folded, 1, &frame));
done:
    ruga_crease_pattern_clear(&pattern);
    return status;
}

static void say_curves(const ruga_arguments* arguments, const char* path, const ruga_curves* curves) {
    ruga_say(arguments, "%s: %d curves\n", path, curves->count);
    for (int k = 0; k < curves->count; k++) {
        const ruga_curve* c = &curves->curve[k];
        static const char* const kinds[RUGA_ASSIGNMENT_COUNT] = {"", "mountain",   "valley",
                                                                 "", "either way", ""};
        double length = 0;
        for (int i = c->closed ? 0 : 1; i < c->point_count; i++) {
            length += ruga_distance(c->point[i > 0 ? i - 1 : c->point_count - 1], c->point[i]);
        }
        ruga_say(arguments, "  %-11s%10.4g mm, %d points%s\n", kinds[c->label], 1e3 * length, c->point_count,
                 c->closed ? ", closed" : "");
    }
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    const char* path;
    ruga_ridge_def def;
    ruga_result_reader* reader = NULL;
    ruga_frame_range range;
    ruga_curves curves = {0};
    double *position = NULL, time = 0;
    RUGA_TRY(read_def(arguments, &def));
    RUGA_TRY(ruga_required(arguments, "--output", &path));
    RUGA_TRY(ruga_open_result(ruga_operand(arguments), &reader));
    const ruga_mesh* mesh = ruga_result_mesh(reader);
    double unit = ruga_result_reader_header(reader)->mesh_unit;
    RUGA_TRY_DONE(check_output(path, mesh));
    RUGA_TRY_DONE(ruga_choose_frames(arguments, ruga_result_frame_count(reader), false, &range));
    RUGA_TRY_DONE(RUGA_NEW(position, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY_DONE(ruga_result_read_frame(reader, range.first, &time, position, NULL, NULL));
    RUGA_TRY_DONE(ruga_ridges_find(mesh, position, &def, &curves));
    if (curves.count == 0) {
        status = ruga_fail(RUGA_BAD_INPUT,
                           "%s: frame %d has no ridge as long and as strong as asked for; nothing written",
                           ruga_operand(arguments), range.first);
        goto done;
    }
    RUGA_TRY_DONE(write_curves(path, mesh, unit > 0 ? unit : 1, &curves, time));
    say_curves(arguments, path, &curves);
done:
    ruga_release(position);
    ruga_curves_clear(&curves);
    ruga_result_reader_close(&reader);
    return status;
}

const ruga_command ruga_creases_command = {
    .name = "creases",
    .operand = "RESULT",
    .usage = "[--from bending|stress] [--frame K] [--min-length L] [--smooth L] -o FILE",
    .summary = "draw crease curves along the ridges of a frame's bending or stress",
    .about = "Writes curves on the surface at rest: mountains and valleys where it bends, either way for "
             "stress. The\n"
             "file may be edited and named in a scene as `curve: {fold: FILE}` or `{svg: FILE}`.",
    .example = "    ruga creases crumpled.h5 --from bending --min-length 5cm -o curves.fold",
    .options = options,
    .run = run,
};
