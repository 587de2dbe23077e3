// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga bake: wrinkles as textures. The base is the embedded surface B q in the uvs of the mesh, or a mesh of
// the user's that it carries along; the fine surface is the skin. Of many frames a few maps with weights can
// be made, from pictures of the same kind that are smaller.
#include "app/command.h"
#include "app/console.h"
#include "app/frames.h"
#include "core/memory.h"
#include "core/vec3.h"
#include "io/file_name.h"
#include "io/image.h"
#include "io/units.h"
#include "io/writer.h"
#include "mesh/transfer.h"
#include "view/bake.h"
#include "view/blend.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE_MAX_TEXELS = 16384, MAPS_MAX = 64, BLEND_SIZE = 256 };
static const double LEAST_SLOPE_NORMAL = 0.05; // a normal further over has no slope to blend

static const char map_names[] = "displacement|normal|tension|ao";

static const ruga_option options[] = {
    {"--map", NULL, map_names,
     "displacement: vectors in the base's tangent space; normal: in tangent space;\n"
     "tension: largest and smallest principal stretch and area ratio, each less 1;\n"
     "ao: the part of the sky that is seen [displacement]",
     false},
    {"--size", NULL, "N", "width and height in texels [2048]", false},
    {"--frame", "-f", "K", "one frame, counted from 0 [the last]", false},
    {"--frames", NULL, "A:B", "a map for each of these frames, both ends included [with --maps: all]", false},
    {"--maps", NULL, "K", "not a map for each frame, but K maps and weights that blend them to each frame",
     false},
    {"--target", NULL, "MESH",
     "a mesh with uvs to bake onto, at rest, in the input mesh's unit: carried along\n"
     "by the interior, met by rays along its normals [the input mesh]",
     false},
    {"--distance", NULL, "LENGTH", "how far rays look on both sides of the target [a tenth of its size]",
     false},
    {"--sky", NULL, "LENGTH", "ao: what is farther away hides nothing [no limit]", false},
    {"--samples", NULL, "N", "ao: rays of each texel [64]", false},
    {"--margin", NULL, "N", "texels by which charts grow beyond their borders [16]", false},
    {"--range", NULL, "R",
     "PNG: 0 to 1 stands for -R to R, a length for displacement, a number for\n"
     "tension [the largest that occurs]",
     false},
    {"--half", NULL, NULL, "EXR: numbers of 16 bits in place of 32", false},
    {"--unit", "-u", "UNIT", "unit of displacements in an EXR, such as mm [that of the input mesh]", false},
    {"--output", "-o", "FILE", "the .exr or .png to write; for several a name with %d in it", false},
    {0},
};

typedef struct job {
    const ruga_arguments* arguments;
    ruga_result_reader* reader;
    const char* pattern;
    ruga_frame_range range;
    ruga_bake_def def;
    ruga_atlas atlas, small; // the latter for blending
    int size, maps;
    double unit, largest; // m; of what is written to PNG, 0 = by itself
    double *position, *embedded, *value;
    // The target, carried by the faces that are nearest at rest.
    ruga_mesh target;
    int (*corner)[3];
    double (*weight)[3], (*local)[3], *base;
    float* pixel;   // [size][size][3]
    float** map;    // [maps] of them
    float** sample; // [frames] [BLEND_SIZE][BLEND_SIZE][3]
    double* product;
    ruga_blend blend;
} job;

static bool has_range(const job* j) {
    return j->def.map == RUGA_BAKE_DISPLACEMENT || j->def.map == RUGA_BAKE_TENSION;
}

// ---- options -------------------------------------------------------------------------------------------

static ruga_status choose_frames(job* j) {
    RUGA_TRY(ruga_integer(j->arguments, "--maps", 1, MAPS_MAX, &j->maps));
    RUGA_TRY(ruga_choose_frames(j->arguments, ruga_result_frame_count(j->reader), j->maps > 0, &j->range));
    int frames = j->range.last - j->range.first + 1;
    if (j->maps > frames) {
        return ruga_fail(RUGA_BAD_INPUT, "--maps: %d maps of %d frames: choose fewer maps or more frames",
                         j->maps, frames);
    }
    ruga_frame_range files = j->maps > 0 ? (ruga_frame_range){0, j->maps - 1} : j->range;
    RUGA_TRY(ruga_check_pattern(j->pattern, &files));
    if (j->maps == 1 && !ruga_has_pattern(j->pattern)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: with --maps the name needs a place for the map's number, such as map_%%d.exr",
                         j->pattern);
    }
    return RUGA_OK;
}

static ruga_status choose_range(job* j) {
    RUGA_TRY(ruga_quantity(j->arguments, "--range", j->def.map == RUGA_BAKE_DISPLACEMENT ? "m" : "1",
                           &j->largest));
    bool given = ruga_given(j->arguments, "--range");
    if (given && (!has_range(j) || ruga_image_is_exr(j->pattern) || !(j->largest > 0))) {
        return ruga_fail(RUGA_BAD_INPUT, "--range: %s",
                         !has_range(j) ? "normals and ambient occlusion have a range of their own"
                         : ruga_image_is_exr(j->pattern) ? "an EXR holds the numbers themselves"
                                                         : "it must be above 0");
    }
    bool several = j->maps > 1 || (j->maps == 0 && j->range.last > j->range.first);
    return !given && several && has_range(j) && !ruga_image_is_exr(j->pattern)
               ? ruga_fail(RUGA_BAD_INPUT, "several PNGs need one range: give it by --range, or write .exr")
               : RUGA_OK;
}

static ruga_status choose_numbers(job* j) {
    int map = 0;
    j->size = 2048;
    j->def.samples = 64;
    j->def.margin = 16;
    j->def.sky = INFINITY;
    RUGA_TRY(ruga_option_choice(j->arguments, "--map", map_names, &map));
    j->def.map = (ruga_bake_map)map;
    RUGA_TRY(ruga_integer(j->arguments, "--size", 4, SIZE_MAX_TEXELS, &j->size));
    RUGA_TRY(ruga_integer(j->arguments, "--samples", 1, 1000000, &j->def.samples));
    RUGA_TRY(ruga_integer(j->arguments, "--margin", 0, SIZE_MAX_TEXELS, &j->def.margin));
    RUGA_TRY(ruga_quantity(j->arguments, "--sky", "m", &j->def.sky));
    RUGA_TRY(ruga_quantity(j->arguments, "--distance", "m", &j->def.distance));
    if (!(j->def.sky > 0) || (ruga_given(j->arguments, "--distance") && !(j->def.distance > 0))) {
        return ruga_fail(RUGA_BAD_INPUT, "--sky and --distance must be above 0");
    }
    if (ruga_given(j->arguments, "--half") && !ruga_image_is_exr(j->pattern)) {
        return ruga_fail(RUGA_BAD_INPUT, "--half: a PNG has 16 bits of its own kind");
    }
    const char* unit = ruga_value(j->arguments, "--unit");
    double of_mesh = ruga_result_reader_header(j->reader)->mesh_unit;
    j->unit = of_mesh > 0 ? of_mesh : 1;
    ruga_status status = unit ? ruga_unit_factor(unit, "m", &j->unit) : RUGA_OK;
    return status == RUGA_OK ? status : ruga_fail_prefix(status, "--unit");
}

// ---- the target ----------------------------------------------------------------------------------------

// An edge of a face, made unit, and its normal and their product: rows.
static void face_frame(const double* position, const int corner[3], double frame[3][3]) {
    const double *a = position + 3 * (size_t)corner[0], *b = position + 3 * (size_t)corner[1];
    ruga_subtract(b, a, frame[0]);
    ruga_normalize(frame[0]);
    ruga_triangle_normal(a, b, position + 3 * (size_t)corner[2], frame[1]);
    ruga_normalize(frame[1]);
    ruga_cross(frame[0], frame[1], frame[2]);
}

static ruga_status read_target(job* j, const char* path) {
    const ruga_mesh* mesh = ruga_result_mesh(j->reader);
    double of_mesh = ruga_result_reader_header(j->reader)->mesh_unit;
    double min[3], max[3], frame[3][3];
    RUGA_TRY(ruga_check_input(path));
    RUGA_TRY(ruga_read_surface(path, 0, NULL, &j->target));
    int count = j->target.vertex_count;
    for (size_t i = 0; i < 3 * (size_t)count; i++) {
        j->target.position[i] *= of_mesh > 0 ? of_mesh : 1;
        if (!isfinite(j->target.position[i])) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: vertex %zu has a coordinate that is not a number", path,
                             i / 3);
        }
    }
    RUGA_TRY(RUGA_NEW(j->corner, count));
    RUGA_TRY(RUGA_NEW(j->weight, count));
    RUGA_TRY(RUGA_NEW(j->local, count));
    RUGA_TRY(RUGA_NEW(j->base, 3 * (size_t)count));
    RUGA_TRY(ruga_mesh_locate(mesh, count, j->target.position, j->corner, j->weight));
    for (size_t v = 0; v < (size_t)count; v++) {
        double offset[3];
        memcpy(offset, j->target.position + 3 * v, sizeof offset);
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(-j->weight[v][i], mesh->position + 3 * (size_t)j->corner[v][i], offset);
        }
        face_frame(mesh->position, j->corner[v], frame);
        for (int i = 0; i < 3; i++) {
            j->local[v][i] = ruga_dot(frame[i], offset);
        }
    }
    ruga_mesh_bounds(&j->target, min, max);
    j->def.distance = j->def.distance > 0 ? j->def.distance : 0.1 * ruga_distance(min, max);
    return RUGA_OK;
}

// Points of the faces with their offsets, which turn with the faces.
static void carry_target(job* j) {
    for (size_t v = 0; v < (size_t)j->target.vertex_count; v++) {
        double frame[3][3], *x = j->base + 3 * v;
        face_frame(j->embedded, j->corner[v], frame);
        x[0] = x[1] = x[2] = 0;
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(j->weight[v][i], j->embedded + 3 * (size_t)j->corner[v][i], x);
            ruga_add_scaled(j->local[v][i], frame[i], x);
        }
    }
}

// ---- baking --------------------------------------------------------------------------------------------

static ruga_status prepare(job* j) {
    const ruga_mesh* mesh = ruga_result_mesh(j->reader);
    const char* target = ruga_value(j->arguments, "--target");
    size_t numbers = 3 * (size_t)mesh->vertex_count, texels = 3 * (size_t)j->size * (size_t)j->size;
    if (!ruga_result_has_interior(j->reader) &&
        (j->def.map == RUGA_BAKE_DISPLACEMENT || j->def.map == RUGA_BAKE_NORMAL)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: has no interior, so no surface without wrinkles to bake from",
                         ruga_operand(j->arguments));
    }
    RUGA_TRY(RUGA_NEW(j->position, numbers));
    RUGA_TRY(RUGA_NEW(j->embedded, numbers));
    RUGA_TRY(RUGA_NEW(j->value, numbers));
    j->def.fine = mesh;
    j->def.detail = j->position;
    j->def.value = j->def.map == RUGA_BAKE_TENSION ? j->value : NULL;
    j->def.base = j->embedded;
    if (target) {
        RUGA_TRY(read_target(j, target));
        j->def.base = j->base;
    }
    const ruga_mesh* base = target ? &j->target : mesh;
    const char* name = target ? target : "the mesh";
    RUGA_TRY(ruga_atlas_create(name, base, j->size, j->size, &j->atlas));
    if (j->atlas.flat > 0) {
        ruga_warn(j->arguments, "%d triangles of %s have no area in the texture: nothing shows them",
                  j->atlas.flat, name);
    }
    if (j->maps > 0) {
        int size = j->size < BLEND_SIZE ? j->size : BLEND_SIZE;
        RUGA_TRY(ruga_atlas_create(name, base, size, size, &j->small));
    }
    return RUGA_NEW(j->pixel, texels);
}

static ruga_status bake_frame(job* j, int frame, const ruga_atlas* atlas, float* pixel,
                              ruga_bake_report* report) {
    bool interior = ruga_result_has_interior(j->reader);
    const ruga_mesh* mesh = ruga_result_mesh(j->reader);
    size_t numbers = 3 * (size_t)mesh->vertex_count;
    RUGA_TRY(
        ruga_result_read_frame(j->reader, frame, NULL, j->position, interior ? j->embedded : NULL, NULL));
    if (!interior) {
        memcpy(j->embedded, j->position, numbers * sizeof *j->embedded);
    }
    if (j->base) {
        carry_target(j);
    }
    if (j->def.value) {
        RUGA_TRY(ruga_bake_tension(mesh, mesh->position, j->embedded, j->value));
    }
    j->def.atlas = atlas;
    return ruga_bake(&j->def, pixel, report);
}

// ---- writing -------------------------------------------------------------------------------------------

// A number x of the file stands for offset + scale x: displacement in m, tension, a normal's part or the part
// of the sky. In an EXR displacements are in the unit; in a PNG 0 to 1 spans what is between -largest and it.
static void choose_scale(const job* j, double largest, double* scale, double* offset) {
    bool spans = has_range(j) && !ruga_image_is_exr(j->pattern);
    largest = j->def.map == RUGA_BAKE_NORMAL ? 1 : largest;
    *scale = spans || j->def.map == RUGA_BAKE_NORMAL ? 2 * largest
             : j->def.map == RUGA_BAKE_DISPLACEMENT  ? j->unit
                                                     : 1;
    *offset = spans || j->def.map == RUGA_BAKE_NORMAL ? -largest : 0;
}

static void encode(const job* j, double scale, double offset, float* pixel) {
    size_t count = 3 * (size_t)j->size * (size_t)j->size;
    for (size_t i = 0; i < count; i++) {
        pixel[i] = (float)(scale > 0 ? ((double)pixel[i] - offset) / scale : 0.5);
    }
}

static double largest_of(const job* j, const float* pixel) {
    double largest = 0;
    for (size_t i = 0; i < 3 * (size_t)j->size * (size_t)j->size; i++) {
        largest = fmax(largest, fabs((double)pixel[i]));
    }
    return largest;
}

static ruga_status write_map(job* j, int number, float* pixel, char** path) {
    char comment[160];
    double scale, offset, largest = j->largest > 0 ? j->largest : largest_of(j, pixel);
    static const char* const meaning[] = {"displacement along tangent, bitangent and normal",
                                          "normal in tangent space",
                                          "principal stretches and area ratio less 1", "ambient occlusion"};
    (void)snprintf(comment, sizeof comment, "Ruga, %s, unit %.9g m", meaning[j->def.map], j->unit);
    choose_scale(j, largest, &scale, &offset);
    encode(j, scale, offset, pixel);
    ruga_image image = {.width = j->size,
                        .height = j->size,
                        .pixel = pixel,
                        .comment = comment,
                        .scale = scale,
                        .offset = offset,
                        .unit = j->def.map == RUGA_BAKE_DISPLACEMENT ? "m" : "1",
                        .half = ruga_given(j->arguments, "--half")};
    RUGA_TRY(ruga_frame_path(j->pattern, number, path));
    RUGA_TRY(ruga_image_write(*path, &image));
    if (has_range(j) && !ruga_image_is_exr(j->pattern)) {
        bool length = j->def.map == RUGA_BAKE_DISPLACEMENT;
        ruga_say(j->arguments, "%s: 0 to 1 stands for -%.6g to %.6g%s\n", *path,
                 length ? 1e3 * largest : largest, length ? 1e3 * largest : largest, length ? " mm" : "");
    } else {
        ruga_say(j->arguments, "%s\n", *path);
    }
    return RUGA_OK;
}

static void tell_report(const job* j, const ruga_bake_report* report) {
    if (report->missed > 0) {
        ruga_warn(j->arguments,
                  "%d of %d texels met nothing of the surface: they take over what is beside them",
                  report->missed, report->texels);
    }
    if (j->def.map == RUGA_BAKE_DISPLACEMENT && report->squares > 0) {
        ruga_say(
            j->arguments,
            "    up to %.4g mm; the part along the normal alone leaves %.3g %% of it (root mean square)\n",
            1e3 * report->largest, 100 * sqrt(report->tangential / report->squares));
    }
}

static ruga_status bake_frames(job* j) {
    for (int frame = j->range.first; frame <= j->range.last; frame++) {
        ruga_bake_report report = {0};
        char* path = NULL;
        RUGA_TRY(bake_frame(j, frame, &j->atlas, j->pixel, &report));
        ruga_status status = write_map(j, frame, j->pixel, &path);
        ruga_release(path);
        RUGA_TRY(status);
        tell_report(j, &report);
    }
    return RUGA_OK;
}

// ---- a few maps for many frames ------------------------------------------------------------------------

// What may be added up: displacement and tension as they are, a normal's slopes, what is hidden of the sky.
static void to_sum(const job* j, size_t texels, float* pixel) {
    for (float* p = pixel; p < pixel + 3 * texels; p += 3) {
        if (j->def.map == RUGA_BAKE_NORMAL) {
            float up = fmaxf(p[2], (float)LEAST_SLOPE_NORMAL);
            p[0] /= up;
            p[1] /= up;
            p[2] = 0;
        }
        for (int i = 0; j->def.map == RUGA_BAKE_AO && i < 3; i++) {
            p[i] = 1 - p[i];
        }
    }
}

static void from_sum(const job* j, size_t texels, float* pixel) {
    for (float* p = pixel; p < pixel + 3 * texels; p += 3) {
        if (j->def.map == RUGA_BAKE_NORMAL) {
            float length = sqrtf(p[0] * p[0] + p[1] * p[1] + 1);
            p[0] /= length;
            p[1] /= length;
            p[2] = 1 / length;
        }
        for (int i = 0; j->def.map == RUGA_BAKE_AO && i < 3; i++) {
            p[i] = 1 - p[i];
        }
    }
}

static ruga_status multiply_samples(job* j, int frames) {
    size_t numbers = 3 * (size_t)j->small.width * (size_t)j->small.height;
    RUGA_TRY(RUGA_NEW_ZERO(j->product, (size_t)frames * (size_t)frames));
    for (int a = 0; a < frames; a++) {
        for (int b = 0; b <= a; b++) {
            double sum = 0;
            for (size_t i = 0; i < numbers; i++) {
                sum += j->small.triangle[i / 3] >= 0 ? (double)j->sample[a][i] * (double)j->sample[b][i] : 0;
            }
            j->product[(size_t)a * (size_t)frames + (size_t)b] =
                j->product[(size_t)b * (size_t)frames + (size_t)a] = sum;
        }
    }
    return RUGA_OK;
}

static ruga_status find_blend(job* j) {
    int frames = j->range.last - j->range.first + 1;
    size_t texels = (size_t)j->small.width * (size_t)j->small.height;
    RUGA_TRY(RUGA_NEW_ZERO(j->sample, frames));
    for (int f = 0; f < frames; f++) {
        ruga_bake_report report = {0};
        RUGA_TRY(RUGA_NEW(j->sample[f], 3 * texels));
        RUGA_TRY(bake_frame(j, j->range.first + f, &j->small, j->sample[f], &report));
        to_sum(j, texels, j->sample[f]);
    }
    RUGA_TRY(multiply_samples(j, frames));
    return ruga_blend_create(frames, j->product, j->maps, &j->blend);
}

static ruga_status add_frames(job* j) {
    size_t texels = (size_t)j->size * (size_t)j->size;
    RUGA_TRY(RUGA_NEW_ZERO(j->map, j->maps));
    for (int k = 0; k < j->maps; k++) {
        RUGA_TRY(RUGA_NEW_ZERO(j->map[k], 3 * texels));
    }
    for (int f = 0; f < j->blend.frames; f++) {
        ruga_bake_report report = {0};
        RUGA_TRY(bake_frame(j, j->range.first + f, &j->atlas, j->pixel, &report));
        to_sum(j, texels, j->pixel);
        for (int k = 0; k < j->maps; k++) {
            float factor = (float)j->blend.mixture[(size_t)f * (size_t)j->maps + (size_t)k];
            for (size_t i = 0; i < 3 * texels; i++) {
                j->map[k][i] += factor * j->pixel[i];
            }
        }
    }
    return RUGA_OK;
}

static json_t* describe_blend(job* j, json_t* names) {
    static const char* const kinds[] = {"displacement", "normal", "tension", "ao"};
    json_t *frames = json_array(), *times = json_array(), *weights = json_array(), *errors = json_array();
    for (int f = 0; f < j->blend.frames; f++) {
        double time = 0;
        (void)ruga_result_read_frame(j->reader, j->range.first + f, &time, NULL, NULL, NULL);
        json_t* row = json_array();
        for (int k = 0; k < j->maps; k++) {
            (void)json_array_append_new(
                row, ruga_json_number(j->blend.weight[(size_t)f * (size_t)j->maps + (size_t)k]));
        }
        (void)json_array_append_new(frames, json_integer(j->range.first + f));
        (void)json_array_append_new(times, ruga_json_number(time));
        (void)json_array_append_new(weights, row);
        (void)json_array_append_new(errors, ruga_json_number(j->blend.error[f]));
    }
    json_t* root = json_pack("{s:s, s:O, s:o, s:o, s:o, s:o, s:o}", "map", kinds[j->def.map], "maps", names,
                             "frames", frames, "times", times, "weights", weights, "errors", errors, "unit",
                             ruga_json_number(j->unit));
    if (root && j->largest > 0) {
        (void)json_object_set_new(root, "range", ruga_json_number(j->largest));
    }
    return root;
}

// "wrinkles_%d.exr" -> "wrinkles_weights.json"
static ruga_status name_weights(const job* j, char** path) {
    size_t size = strlen(j->pattern) + 32;
    size_t length = 0;
    const char *place = ruga_file_name_place(j->pattern, &length), *dot = strrchr(j->pattern, '.');
    RUGA_ASSERT(place && dot > place);
    const char* rest = place + length;
    RUGA_TRY(RUGA_NEW(*path, size));
    (void)snprintf(*path, size, "%.*sweights%.*s.json", (int)(place - j->pattern), j->pattern,
                   (int)(dot - rest), rest);
    return RUGA_OK;
}

static ruga_status write_weights(job* j, json_t* names) {
    char* path = NULL;
    ruga_writer writer;
    json_t* root = describe_blend(j, names);
    char* text = root ? json_dumps(root, JSON_INDENT(1)) : NULL;
    ruga_status status =
        text ? name_weights(j, &path) : ruga_fail(RUGA_NO_MEMORY, "out of memory: the weights");
    status = status == RUGA_OK ? ruga_writer_open(path, &writer) : status;
    if (status == RUGA_OK) {
        (void)fputs(text, writer.file);
        (void)fputc('\n', writer.file);
        status = ruga_writer_close(&writer, RUGA_OK);
    }
    if (status == RUGA_OK) {
        double worst = 0;
        for (int f = 0; f < j->blend.frames; f++) {
            worst = fmax(worst, j->blend.error[f]);
        }
        ruga_say(j->arguments, "%s: every frame is a blend of %d maps to within %.3g %% of the largest\n",
                 path, j->maps, 100 * worst);
    }
    free(text);
    json_decref(root);
    ruga_release(path);
    return status;
}

static ruga_status bake_blend(job* j) {
    json_t* names = json_array();
    ruga_status status = find_blend(j);
    status = status == RUGA_OK ? add_frames(j) : status;
    for (int k = 0; status == RUGA_OK && k < j->maps; k++) {
        char* path = NULL;
        from_sum(j, (size_t)j->size * (size_t)j->size, j->map[k]);
        status = write_map(j, k, j->map[k], &path);
        if (status == RUGA_OK) {
            const char* slash = strrchr(path, '/');
            (void)json_array_append_new(names, json_string(slash ? slash + 1 : path));
        }
        ruga_release(path);
    }
    status = status == RUGA_OK ? write_weights(j, names) : status;
    json_decref(names);
    return status;
}

// ---- the command ---------------------------------------------------------------------------------------

static void clear(job* j) {
    int frames = j->range.last - j->range.first + 1;
    for (int k = 0; j->map && k < j->maps; k++) {
        ruga_release(j->map[k]);
    }
    for (int f = 0; j->sample && f < frames; f++) {
        ruga_release(j->sample[f]);
    }
    void* const owned[] = {j->map,    j->sample, j->product, j->position, j->embedded, j->value,
                           j->corner, j->weight, j->local,   j->base,     j->pixel};
    for (size_t i = 0; i < sizeof owned / sizeof *owned; i++) {
        ruga_release(owned[i]);
    }
    ruga_blend_clear(&j->blend);
    ruga_atlas_clear(&j->atlas);
    ruga_atlas_clear(&j->small);
    ruga_mesh_clear(&j->target);
    ruga_result_reader_close(&j->reader);
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    job j = {.arguments = arguments};
    RUGA_TRY(ruga_required(arguments, "--output", &j.pattern));
    RUGA_TRY(ruga_image_check(j.pattern));
    RUGA_TRY(ruga_check_output(j.pattern));
    RUGA_TRY(ruga_open_result(ruga_operand(arguments), &j.reader));
    RUGA_TRY_DONE(choose_numbers(&j));
    RUGA_TRY_DONE(choose_frames(&j));
    RUGA_TRY_DONE(choose_range(&j));
    RUGA_TRY_DONE(prepare(&j));
    status = j.maps > 0 ? bake_blend(&j) : bake_frames(&j);
done:
    clear(&j);
    return status;
}

const ruga_command ruga_bake_command = {
    .name = "bake",
    .operand = "RESULT",
    .usage = "[--map displacement|normal|tension|ao] [--size N] [--frame K | --frames A:B] [--target MESH] "
             "-o MAP.exr|png",
    .summary = "write the wrinkles as textures",
    .about = "Bakes what the skin has beyond the surface of its interior into the mesh's texture "
             "coordinates, or onto\n"
             "another mesh. Tangent space is MikkTSpace's; docs/bake.md says how a renderer undoes it. With "
             "--maps a few\n"
             "maps and a JSON file of weights stand for all frames.",
    .example = "    ruga bake pillow.h5 --map displacement --size 2048 -o wrinkles.exr\n"
               "    ruga bake pillow.h5 --map normal --maps 4 --target low.obj -o wrinkles_%d.png",
    .options = options,
    .run = run,
};
