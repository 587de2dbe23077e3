// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga export: frames of a result as files that other programs read. OBJ and PLY hold one frame each; glTF,
// USD and point caches all of them; XDMF points into the result itself.
#include "app/command.h"
#include "app/console.h"
#include "app/export_fold.h"
#include "app/frames.h"
#include "core/memory.h"
#include "io/animation.h"
#include "io/mesh_file.h"
#include "io/units.h"
#include "io/xdmf.h"
#include "mesh/subdivide.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SUBDIVISIONS_MAX = 6 };
static const double RATE_OF_ONE_FRAME = 24; // per second, where there is no time between frames

static const char formats[] = "obj|ply|gltf|pc2|mdd|usda|xdmf|fold";

static const ruga_option options[] = {
    {"--format", NULL, formats,
     "obj, ply, gltf, pc2, mdd, usda, xdmf or fold [by the file's ending; .glb is gltf]", false},
    {"--frames", NULL, "A:B",
     "frames, both ends included [obj, ply: all for a name with %04d, otherwise\n"
     "the last; the others: all]",
     false},
    {"--frame", "-f", "K", "one frame, counted from 0", false},
    {"--subdivide", NULL, "N", "steps of Loop subdivision, 0 to 6 [0]", false},
    {"--unit", "-u", "UNIT", "unit of the coordinates written, such as mm [that of the input mesh]", false},
    {"--up", NULL, "y|z",
     "the axis that points up, y or z; nothing is turned, but files that can say it do [z]", false},
    {"--fps", NULL, "R", "frames per second at which the frames are shown [that of their times]", false},
    {"--name", NULL, "NAME", "name of the object [that of RESULT]", false},
    {"--output", "-o", "FILE", "the file to write; for several frames of obj or ply a name with %04d in it",
     false},
    {0},
};

typedef enum format { OBJ, PLY, GLTF, PC2, MDD, USDA, XDMF, FOLD } format;

typedef struct job {
    const ruga_arguments* arguments;
    ruga_result_reader* reader;
    const char* pattern;
    int format;
    ruga_frame_range range;
    double* time; // s, of the frames in the range
    ruga_subdivision* subdivision;
    ruga_mesh mesh; // what is written: a view, with its own positions
    double *coarse, *normal;
    char name[256], comment[256];
    ruga_animation animation;
} job;

// ---- options -------------------------------------------------------------------------------------------

static ruga_status choose_format(const ruga_arguments* arguments, const char* path, int* chosen) {
    static const struct {
        const char* ending;
        format format;
    } endings[] = {{".obj", OBJ},   {".ply", PLY},   {".glb", GLTF}, {".pc2", PC2},  {".mdd", MDD},
                   {".usda", USDA}, {".xdmf", XDMF}, {".xmf", XDMF}, {".fold", FOLD}};
    const char* dot = strrchr(path, '.');
    *chosen = -1;
    for (size_t i = 0; dot && i < sizeof endings / sizeof *endings; i++) {
        if (strcmp(dot, endings[i].ending) == 0) {
            *chosen = (int)endings[i].format;
        }
    }
    RUGA_TRY(ruga_option_choice(arguments, "--format", formats, chosen));
    if (*chosen < 0) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: say which format is wanted, such as --format obj or --format gltf", path);
    }
    if (*chosen == GLTF && dot && strcmp(dot, ".gltf") == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the binary form is written, whose names end in .glb", path);
    }
    return RUGA_OK;
}

static bool is_sequence(const job* j) {
    return j->format == OBJ || j->format == PLY;
}

static ruga_status choose_frames(job* j) {
    int count = ruga_result_frame_count(j->reader);
    bool all = !is_sequence(j) || ruga_has_pattern(j->pattern);
    RUGA_TRY(ruga_choose_frames(j->arguments, count, all, &j->range));
    if (is_sequence(j)) {
        return ruga_check_pattern(j->pattern, &j->range);
    }
    return ruga_has_pattern(j->pattern)
               ? ruga_fail(RUGA_BAD_INPUT,
                           "%s: one file of this format holds all frames: leave the place for a "
                           "number out of its name",
                           j->pattern)
               : RUGA_OK;
}

static ruga_status choose_unit(job* j) {
    const char* unit = ruga_value(j->arguments, "--unit");
    double of_mesh = ruga_result_reader_header(j->reader)->mesh_unit;
    j->animation.unit = of_mesh > 0 ? of_mesh : 1;
    if (!unit) {
        return RUGA_OK;
    }
    ruga_status status = ruga_unit_factor(unit, "m", &j->animation.unit);
    return status == RUGA_OK ? status : ruga_fail_prefix(status, "--unit");
}

static ruga_status choose_rate(job* j) {
    int last = j->range.last - j->range.first;
    RUGA_TRY(RUGA_NEW(j->time, last + 1));
    for (int k = 0; k <= last; k++) {
        RUGA_TRY(ruga_result_read_frame(j->reader, j->range.first + k, &j->time[k], NULL, NULL, NULL));
    }
    double span = j->time[last] - j->time[0];
    j->animation.rate = last > 0 && span > 0 ? last / span : RATE_OF_ONE_FRAME;
    RUGA_TRY(ruga_quantity(j->arguments, "--fps", "1/s", &j->animation.rate));
    return j->animation.rate > 0 && isfinite(j->animation.rate)
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT, "--fps: %g is not above 0", j->animation.rate);
}

static void choose_name(job* j) {
    const char* given = ruga_value(j->arguments, "--name");
    const char* path = ruga_operand(j->arguments);
    const char* slash = strrchr(path, '/');
    const char* base = slash ? slash + 1 : path;
    const char* dot = strrchr(base, '.');
    int length = dot && dot > base ? (int)(dot - base) : (int)strlen(base);
    (void)snprintf(j->name, sizeof j->name, "%.*s", given ? (int)strlen(given) : length,
                   given ? given : base);
}

// XDMF shows the result's own numbers: nothing can be done to them.
static ruga_status refuse_changes(const job* j) {
    static const char* const changes[] = {"--subdivide", "--unit", "--up", "--fps", "--name"};
    for (size_t i = 0; j->format == XDMF && i < sizeof changes / sizeof *changes; i++) {
        if (ruga_given(j->arguments, changes[i])) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "%s: an xdmf file points at the result's own numbers, which stay as they are",
                             changes[i]);
        }
    }
    return RUGA_OK;
}

// ---- frames --------------------------------------------------------------------------------------------

static ruga_status read_frame(void* context, int frame, double* position, double* normal) {
    job* j = context;
    RUGA_TRY(ruga_result_read_frame(j->reader, frame, NULL, j->coarse, NULL, NULL));
    size_t n = 3 * (size_t)j->mesh.vertex_count;
    if (j->subdivision) {
        ruga_subdivision_apply(j->subdivision, j->coarse, position);
    } else {
        memcpy(position, j->coarse, n * sizeof *position);
    }
    if (normal) {
        ruga_mesh_vertex_normals(&j->mesh, position, normal);
    }
    for (size_t i = 0; i < n; i++) {
        position[i] /= j->animation.unit;
    }
    return RUGA_OK;
}

static ruga_status prepare(job* j) {
    int steps = 0, up = 1;
    RUGA_TRY(choose_frames(j));
    RUGA_TRY(refuse_changes(j));
    RUGA_TRY(ruga_integer(j->arguments, "--subdivide", 0, SUBDIVISIONS_MAX, &steps));
    RUGA_TRY(ruga_option_choice(j->arguments, "--up", "y|z", &up));
    RUGA_TRY(choose_unit(j));
    RUGA_TRY(choose_rate(j));
    choose_name(j);
    const ruga_mesh* mesh = ruga_result_mesh(j->reader);
    if (steps > 0) {
        RUGA_TRY(ruga_subdivision_create(mesh, steps, &j->subdivision));
        j->mesh = *ruga_subdivision_mesh(j->subdivision);
    } else {
        j->mesh = *mesh;
    }
    ruga_animation* a = &j->animation;
    a->name = j->name;
    a->comment = j->comment;
    a->mesh = &j->mesh;
    a->first = j->range.first;
    a->count = j->range.last - j->range.first + 1;
    a->up = up == 0 ? 1 : 2;
    a->read = read_frame;
    a->context = j;
    (void)snprintf(j->comment, sizeof j->comment,
                   "Ruga, frames %d to %d, t = %.9g to %.9g s, unit %.9g m, %c up, %.9g frames per second",
                   j->range.first, j->range.last, j->time[0], j->time[a->count - 1], a->unit,
                   a->up == 1 ? 'y' : 'z', a->rate);
    size_t n = 3 * (size_t)j->mesh.vertex_count;
    j->mesh.position = NULL;
    RUGA_TRY(RUGA_NEW(j->mesh.position, n));
    RUGA_TRY(RUGA_NEW(j->normal, n));
    return RUGA_NEW(j->coarse, 3 * (size_t)mesh->vertex_count);
}

// ---- writing -------------------------------------------------------------------------------------------

static ruga_status write_frame(job* j, int frame) {
    char* path = NULL;
    RUGA_TRY(read_frame(j, frame, j->mesh.position, j->normal));
    (void)snprintf(j->comment, sizeof j->comment,
                   "Ruga, %.64s, frame %d, t = %.9g s, unit %.9g m, %c up, %.9g frames per second", j->name,
                   frame, j->time[frame - j->range.first], j->animation.unit,
                   j->animation.up == 1 ? 'y' : 'z', j->animation.rate);
    RUGA_TRY(ruga_frame_path(j->pattern, frame, &path));
    ruga_status status = j->format == PLY ? ruga_ply_write(path, &j->mesh, j->normal, j->comment)
                                          : ruga_obj_write(path, &j->mesh, j->normal, j->comment);
    if (status == RUGA_OK) {
        ruga_say(j->arguments, "%s\n", path);
    }
    ruga_release(path);
    return status;
}

static ruga_status write_sequence(job* j) {
    for (int frame = j->range.first; frame <= j->range.last; frame++) {
        RUGA_TRY(write_frame(j, frame));
    }
    return RUGA_OK;
}

static ruga_status write_all(job* j) {
    static ruga_animation_write* const writers[] = {
        [GLTF] = ruga_gltf_animation_write,
        [PC2] = ruga_pc2_animation_write,
        [MDD] = ruga_mdd_animation_write,
        [USDA] = ruga_usda_animation_write,
    };
    RUGA_TRY(j->format == XDMF ? ruga_xdmf_write(j->pattern, ruga_operand(j->arguments), j->reader, j->time,
                                                 j->range.first, j->range.last)
                               : writers[j->format](j->pattern, &j->animation));
    ruga_say(j->arguments, "%s\n", j->pattern);
    return RUGA_OK;
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    job j = {.arguments = arguments};
    RUGA_TRY(ruga_required(arguments, "--output", &j.pattern));
    RUGA_TRY(choose_format(arguments, j.pattern, &j.format));
    if (j.format == FOLD) {
        return ruga_export_fold(arguments, j.pattern);
    }
    RUGA_TRY(ruga_check_output(j.pattern));
    RUGA_TRY(ruga_open_result(ruga_operand(arguments), &j.reader));
    RUGA_TRY_DONE(prepare(&j));
    status = is_sequence(&j) ? write_sequence(&j) : write_all(&j);
done:
    ruga_release(j.mesh.position);
    ruga_release(j.normal);
    ruga_release(j.coarse);
    ruga_release(j.time);
    ruga_subdivision_destroy(&j.subdivision);
    ruga_result_reader_close(&j.reader);
    return status;
}

const ruga_command ruga_export_command = {
    .name = "export",
    .operand = "RESULT",
    .usage = "--format obj|ply|gltf|pc2|mdd|usda|xdmf|fold [--frames A:B] [--subdivide N] [--unit U] -o "
             "FILE_OR_PATTERN",
    .summary = "write frames of a result for other programs",
    .about = "Writes the skin with its texture coordinates, groups and normals, in the input mesh's unit "
             "unless told\n"
             "otherwise: obj and ply a file for each frame; gltf (binary), usda and the point caches pc2 and "
             "mdd one\n"
             "file with all of them; xdmf a page that shows ParaView the result itself; fold the creases "
             "with their angles, in metres. Each file is written "
             "whole or\n"
             "not at all; its name is printed.",
    .example = "    ruga export pillow.h5 --format obj --frames 0:50 --subdivide 1 -o pillow_%04d.obj\n"
               "    ruga export pillow.h5 --format gltf --fps 25 -o pillow.glb",
    .options = options,
    .run = run,
};
