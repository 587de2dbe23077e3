// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga export: frames of a result as mesh files.
#include "app/command.h"
#include "app/console.h"
#include "app/export_fold.h"
#include "app/frames.h"
#include "core/memory.h"
#include "io/mesh_file.h"
#include "io/units.h"
#include "mesh/subdivide.h"

#include <stdio.h>
#include <string.h>

enum { SUBDIVISIONS_MAX = 6 };

static const ruga_option options[] = {
    {"--format", NULL, "NAME", "obj, ply or fold [by the file's ending]", false},
    {"--frames", NULL, "A:B", "frames, both ends included [all for a name with %04d, otherwise the last]",
     false},
    {"--frame", "-f", "K", "one frame, counted from 0", false},
    {"--subdivide", NULL, "N", "steps of Loop subdivision, 0 to 6 [0]", false},
    {"--unit", "-u", "UNIT", "unit of the coordinates written, such as mm [that of the input mesh]", false},
    {"--output", "-o", "FILE", "the file to write; for several frames a name with %04d in it", false},
    {0},
};

static const char formats[] = "obj|ply|gltf|pc2|mdd|usda|xdmf|fold";
enum { FORMAT_OBJ, FORMAT_PLY, FORMAT_COUNT_NOW, FORMAT_FOLD = 7 };

typedef struct job {
    const ruga_arguments* arguments;
    ruga_result_reader* reader;
    const char* pattern;
    int format;
    double unit; // m
    ruga_subdivision* subdivision;
    ruga_mesh mesh; // what is written: a view, with its own positions
    double *coarse, *normal;
} job;

static ruga_status choose_format(const ruga_arguments* arguments, const char* path, int* format) {
    const char* dot = strrchr(path, '.');
    *format = dot && strcmp(dot, ".ply") == 0    ? FORMAT_PLY
              : dot && strcmp(dot, ".obj") == 0  ? FORMAT_OBJ
              : dot && strcmp(dot, ".fold") == 0 ? FORMAT_FOLD
                                                 : -1;
    RUGA_TRY(ruga_option_choice(arguments, "--format", formats, format));
    if (*format < 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: say which format is wanted: --format obj or --format ply",
                         path);
    }
    if (*format >= FORMAT_COUNT_NOW && *format != FORMAT_FOLD) {
        return ruga_fail(RUGA_BAD_INPUT, "--format: %s is not available yet; obj, ply and fold are",
                         ruga_value(arguments, "--format"));
    }
    return RUGA_OK;
}

static ruga_status choose_unit(job* j) {
    const char* unit = ruga_value(j->arguments, "--unit");
    j->unit = ruga_result_reader_header(j->reader)->mesh_unit;
    if (!unit) {
        j->unit = j->unit > 0 ? j->unit : 1;
        return RUGA_OK;
    }
    ruga_status status = ruga_unit_factor(unit, "m", &j->unit);
    return status == RUGA_OK ? status : ruga_fail_prefix(status, "--unit");
}

static ruga_status prepare(job* j) {
    int steps = 0;
    RUGA_TRY(ruga_integer(j->arguments, "--subdivide", 0, SUBDIVISIONS_MAX, &steps));
    RUGA_TRY(choose_unit(j));
    const ruga_mesh* mesh = ruga_result_mesh(j->reader);
    if (steps > 0) {
        RUGA_TRY(ruga_subdivision_create(mesh, steps, &j->subdivision));
        j->mesh = *ruga_subdivision_mesh(j->subdivision);
    } else {
        j->mesh = *mesh;
    }
    size_t n = 3 * (size_t)j->mesh.vertex_count;
    j->mesh.position = NULL;
    RUGA_TRY(RUGA_NEW(j->mesh.position, n));
    RUGA_TRY(RUGA_NEW(j->normal, n));
    return RUGA_NEW(j->coarse, 3 * (size_t)mesh->vertex_count);
}

static ruga_status export_frame(job* j, int frame) {
    double time;
    RUGA_TRY(ruga_result_read_frame(j->reader, frame, &time, j->coarse, NULL, NULL));
    size_t n = 3 * (size_t)j->mesh.vertex_count;
    if (j->subdivision) {
        ruga_subdivision_apply(j->subdivision, j->coarse, j->mesh.position);
    } else {
        memcpy(j->mesh.position, j->coarse, n * sizeof *j->coarse);
    }
    ruga_mesh_vertex_normals(&j->mesh, j->mesh.position, j->normal);
    for (size_t i = 0; i < n; i++) {
        j->mesh.position[i] /= j->unit;
    }
    char comment[128], *path = NULL;
    (void)snprintf(comment, sizeof comment, "Ruga, frame %d, t = %.9g s, unit %.9g m", frame, time, j->unit);
    RUGA_TRY(ruga_frame_path(j->pattern, frame, &path));
    ruga_status status = j->format == FORMAT_PLY ? ruga_ply_write(path, &j->mesh, j->normal, comment)
                                                 : ruga_obj_write(path, &j->mesh, j->normal, comment);
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
    job j = {.arguments = arguments};
    RUGA_TRY(ruga_required(arguments, "--output", &j.pattern));
    RUGA_TRY(choose_format(arguments, j.pattern, &j.format));
    if (j.format == FORMAT_FOLD) {
        return ruga_export_fold(arguments, j.pattern);
    }
    RUGA_TRY_DONE(ruga_open_frames(arguments, j.pattern, &j.reader, &range));
    RUGA_TRY_DONE(prepare(&j));
    for (int frame = range.first; frame <= range.last; frame++) {
        RUGA_TRY_DONE(export_frame(&j, frame));
    }
done:
    ruga_release(j.mesh.position);
    ruga_release(j.normal);
    ruga_release(j.coarse);
    ruga_subdivision_destroy(&j.subdivision);
    ruga_result_reader_close(&j.reader);
    return status;
}

const ruga_command ruga_export_command = {
    .name = "export",
    .operand = "RESULT",
    .usage = "--format obj|ply|fold [--frames A:B] [--subdivide N] [--unit U] -o FILE_OR_PATTERN",
    .summary = "write frames of a result as mesh files",
    .about = "Writes the skin with its texture coordinates, groups and normals, in the input mesh's unit "
             "unless told\n"
             "otherwise. FOLD files hold all frames unless told, with the angles of the creases, in metres. "
             "Each file is\n"
             "written whole or not at all; its name is printed.",
    .example = "    ruga export pillow.h5 --format obj --frames 0:50 --subdivide 1 -o pillow_%04d.obj",
    .options = options,
    .run = run,
};
