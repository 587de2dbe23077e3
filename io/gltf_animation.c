// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// glTF 2.0, binary. The first frame is the mesh, each further frame k a morph target of the differences to
// it, and the animation's weights are linear between the corners (time of frame k, weight of target k = 1,
// all others 0): between two frames positions are linear in time, and at a frame they are that frame.
//
// A vertex is what has one place in the mesh and one uv; v is counted from a picture's upper edge. Groups are
// primitives with a material of their name, on shared vertices. The format measures in metres and its y
// points up: the node scales and turns, and the numbers stay those of the result. A target where less than 3
// of 4 vertices move is stored as a sparse accessor (16 bytes a moved vertex in place of 12 a vertex).
//
// The head of the file holds the least and the largest number of each target, and its length: so frames are
// read twice, first to count, then to write.
#include "core/memory.h"
#include "io/animation.h"

#include <jansson.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { FLOAT_TYPE = 5126, INDEX_TYPE = 5125, VERTEX_DATA = 34962, INDEX_DATA = 34963 };
enum { POSITION, NORMAL, KINDS };
enum { TARGETS_MAX = 4096 }; // their weights are a number for each pair of frames

typedef struct spread { // of the differences of a target's positions or normals
    int moved;          // vertices
    float min[3], max[3];
} spread;

typedef struct job {
    const ruga_animation* animation;
    ruga_writer* writer;
    int count, capacity, next_capacity; // vertices of the file
    int *source, *uv;                   // [count] vertex and uv of the mesh, -1 = none
    int *head, *next;                   // [V], [count] lists of a vertex's copies
    int* corner;                        // [F][3] vertex of the file
    int *order, *start;                 // faces by group
    double* scratch;                    // [2][V][3]
    float *base[KINDS], *now[KINDS];    // [V][3]
    float* delta;                       // [count][3]
    spread (*target)[KINDS];            // [frames - 1]
    json_t *views, *accessors;
    uint64_t length; // bytes of the data so far
    bool no_memory;
} job;

// ---- vertices ------------------------------------------------------------------------------------------

static ruga_status find_vertex(job* j, int vertex, int uv, int* found) {
    for (int w = j->head[vertex]; w >= 0; w = j->next[w]) {
        if (j->uv[w] == uv) {
            *found = w;
            return RUGA_OK;
        }
    }
    const double* st = j->animation->mesh->uv;
    if (uv >= 0 && !(isfinite((float)st[2 * (size_t)uv]) && isfinite((float)st[2 * (size_t)uv + 1]))) {
        return ruga_fail(RUGA_BAD_INPUT, "texture coordinate %d is not a number that glTF can hold", uv);
    }
    *found = j->count;
    j->source[j->count] = vertex;
    j->uv[j->count] = uv;
    j->next[j->count] = j->head[vertex];
    j->head[vertex] = j->count++;
    return RUGA_OK;
}

static bool has_uvs(const job* j) {
    return j->animation->mesh->uv && j->animation->mesh->uv_triangle;
}

// As many vertices as there are corners at most.
static ruga_status split_vertices(job* j) {
    const ruga_mesh* mesh = j->animation->mesh;
    size_t corners = 3 * (size_t)mesh->triangle_count;
    RUGA_TRY(RUGA_NEW(j->source, corners));
    RUGA_TRY(RUGA_NEW(j->uv, corners));
    RUGA_TRY(RUGA_NEW(j->next, corners));
    RUGA_TRY(RUGA_NEW(j->corner, corners));
    RUGA_TRY(RUGA_NEW(j->head, mesh->vertex_count));
    memset(j->head, 0xff, (size_t)mesh->vertex_count * sizeof *j->head); // all -1
    for (size_t c = 0; c < corners; c++) {
        RUGA_TRY(find_vertex(j, mesh->triangle[c], has_uvs(j) ? mesh->uv_triangle[c] : -1, &j->corner[c]));
    }
    return RUGA_OK;
}

// ---- first reading -------------------------------------------------------------------------------------

static void take_differences(job* j, int kind) {
    for (int w = 0; w < j->count; w++) {
        size_t from = 3 * (size_t)j->source[w];
        for (size_t i = 0; i < 3; i++) {
            j->delta[3 * (size_t)w + i] = j->now[kind][from + i] - j->base[kind][from + i];
        }
    }
}

static bool moves(const job* j, int w) {
    const float* d = j->delta + 3 * (size_t)w;
    return d[0] != 0 || d[1] != 0 || d[2] != 0;
}

static void bound(float const* value, spread* s) {
    for (int i = 0; i < 3; i++) {
        s->min[i] = fminf(s->min[i], value[i]);
        s->max[i] = fmaxf(s->max[i], value[i]);
    }
}

static ruga_status read_frame(job* j, int k, float* const into[KINDS]) {
    const ruga_animation* a = j->animation;
    return ruga_animation_read(a, a->first + k, j->scratch, into[POSITION], into[NORMAL]);
}

static ruga_status measure_targets(job* j) {
    for (int k = 1; k < j->animation->count; k++) {
        RUGA_TRY(read_frame(j, k, j->now));
        for (int kind = 0; kind < KINDS; kind++) {
            spread* s = &j->target[k - 1][kind];
            take_differences(j, kind);
            *s = (spread){.min = {INFINITY, INFINITY, INFINITY}, .max = {-INFINITY, -INFINITY, -INFINITY}};
            for (int w = 0; w < j->count; w++) {
                s->moved += moves(j, w);
                bound(j->delta + 3 * (size_t)w, s);
            }
        }
    }
    return RUGA_OK;
}

// A vertex without area around it has no normal; the format wants one.
static ruga_status read_base(job* j) {
    RUGA_TRY(read_frame(j, 0, j->base));
    for (size_t v = 0; v < (size_t)j->animation->mesh->vertex_count; v++) {
        float* n = j->base[NORMAL] + 3 * v;
        n[2] = n[0] == 0 && n[1] == 0 && n[2] == 0 ? 1 : n[2];
    }
    return RUGA_OK;
}

// ---- head ----------------------------------------------------------------------------------------------

// Keeps an object that may not have been made for want of memory.
static json_t* keep(job* j, json_t* object) {
    j->no_memory = j->no_memory || !object;
    return object;
}

static void append(job* j, json_t* array, json_t* object) {
    j->no_memory = json_array_append_new(array, keep(j, object)) != 0 || j->no_memory;
}

static int add_view(job* j, uint64_t bytes, int use) {
    int number = (int)json_array_size(j->views);
    json_t* view = json_pack("{s:i, s:I, s:I}", "buffer", 0, "byteOffset", (json_int_t)j->length,
                             "byteLength", (json_int_t)bytes);
    if (use && view) {
        (void)json_object_set_new(view, "target", json_integer(use));
    }
    append(j, j->views, view);
    j->length += bytes;
    return number;
}

static json_t* triple(const float value[3]) {
    return json_pack("[f, f, f]", (double)value[0], (double)value[1], (double)value[2]);
}

static int add_accessor(job* j, json_t* accessor) {
    append(j, j->accessors, accessor);
    return (int)json_array_size(j->accessors) - 1;
}

static int add_vectors(job* j, const spread* s) {
    int view = add_view(j, 12 * (uint64_t)j->count, VERTEX_DATA);
    json_t* accessor = json_pack("{s:i, s:i, s:i, s:s}", "bufferView", view, "componentType", FLOAT_TYPE,
                                 "count", j->count, "type", "VEC3");
    if (s && accessor) {
        (void)json_object_set_new(accessor, "min", keep(j, triple(s->min)));
        (void)json_object_set_new(accessor, "max", keep(j, triple(s->max)));
    }
    return add_accessor(j, accessor);
}

static bool is_sparse(const job* j, const spread* s) {
    return 16 * (int64_t)s->moved < 12 * (int64_t)j->count;
}

static int add_target(job* j, const spread* s) {
    if (!is_sparse(j, s)) {
        return add_vectors(j, s);
    }
    json_t* accessor =
        json_pack("{s:i, s:i, s:s, s:o, s:o}", "componentType", FLOAT_TYPE, "count", j->count, "type", "VEC3",
                  "min", keep(j, triple(s->min)), "max", keep(j, triple(s->max)));
    if (s->moved > 0 && accessor) { // an accessor without data is all zero
        int index = add_view(j, 4 * (uint64_t)s->moved, 0), value = add_view(j, 12 * (uint64_t)s->moved, 0);
        json_t* sparse = json_pack("{s:i, s:{s:i, s:i}, s:{s:i}}", "count", s->moved, "indices", "bufferView",
                                   index, "componentType", INDEX_TYPE, "values", "bufferView", value);
        (void)json_object_set_new(accessor, "sparse", keep(j, sparse));
    }
    return add_accessor(j, accessor);
}

static int add_scalars(job* j, uint64_t count, double last) {
    int view = add_view(j, 4 * count, 0);
    json_t* accessor = json_pack("{s:i, s:i, s:I, s:s}", "bufferView", view, "componentType", FLOAT_TYPE,
                                 "count", (json_int_t)count, "type", "SCALAR");
    if (last >= 0 && accessor) {
        (void)json_object_set_new(accessor, "min", json_pack("[f]", 0.0));
        (void)json_object_set_new(accessor, "max", json_pack("[f]", last));
    }
    return add_accessor(j, accessor);
}

static float time_of(const job* j, int k) {
    return (float)(k / j->animation->rate);
}

static int group_total(const job* j) {
    const ruga_mesh* mesh = j->animation->mesh;
    return mesh->face_group ? mesh->group_count : 0;
}

static json_t* describe_material(const job* j, int group) {
    const ruga_animation* a = j->animation;
    const char* name = group < group_total(j) ? a->mesh->group_name[group] : a->name;
    json_t* words = json_string(name); // NULL where it is not UTF-8
    return json_pack("{s:o, s:b, s:{s:f, s:f}}", "name", words ? words : json_string("material"),
                     "doubleSided", 1, "pbrMetallicRoughness", "metallicFactor", 0.0, "roughnessFactor", 0.6);
}

// A primitive for each group that has faces, with its material.
static void add_primitives(job* j, json_t* primitives, json_t* materials, json_t* attributes,
                           json_t* targets) {
    for (int g = 0; g <= group_total(j); g++) {
        int faces = j->start[g + 1] - j->start[g];
        if (faces == 0) {
            continue;
        }
        int view = add_view(j, 12 * (uint64_t)faces, INDEX_DATA);
        int indices = add_accessor(j, json_pack("{s:i, s:i, s:i, s:s}", "bufferView", view, "componentType",
                                                INDEX_TYPE, "count", 3 * faces, "type", "SCALAR"));
        json_t* primitive = json_pack("{s:O, s:i, s:i}", "attributes", attributes, "indices", indices,
                                      "material", (int)json_array_size(materials));
        if (primitive && json_array_size(targets) > 0) {
            (void)json_object_set(primitive, "targets", targets);
        }
        append(j, materials, describe_material(j, g));
        append(j, primitives, primitive);
    }
}

static json_t* describe_node(const job* j) {
    const ruga_animation* a = j->animation;
    json_t* words = json_string(a->name);
    json_t* node = json_pack("{s:i, s:o}", "mesh", 0, "name", words ? words : json_string("skin"));
    if (node && a->unit != 1) {
        (void)json_object_set_new(node, "scale", json_pack("[f, f, f]", a->unit, a->unit, a->unit));
    }
    if (node && a->up == 2) { // z becomes y: a quarter turn back about x
        (void)json_object_set_new(node, "rotation",
                                  json_pack("[f, f, f, f]", -sqrt(0.5), 0.0, 0.0, sqrt(0.5)));
    }
    return node;
}

static void describe_animation(job* j, json_t* root) {
    int frames = j->animation->count;
    if (frames < 2) {
        return;
    }
    int input = add_scalars(j, (uint64_t)frames, (double)time_of(j, frames - 1));
    int output = add_scalars(j, (uint64_t)frames * (uint64_t)(frames - 1), -1);
    json_t* animation = json_pack("{s:s, s:[{s:i, s:{s:i, s:s}}], s:[{s:i, s:i, s:s}]}", "name", "frames",
                                  "channels", "sampler", 0, "target", "node", 0, "path", "weights",
                                  "samplers", "input", input, "output", output, "interpolation", "LINEAR");
    (void)json_object_set_new(root, "animations", keep(j, json_pack("[o]", keep(j, animation))));
}

// Attributes and targets, in the order of their data.
static void describe_vertices(job* j, json_t* attributes, json_t* targets, json_t* names) {
    spread s = {.min = {INFINITY, INFINITY, INFINITY}, .max = {-INFINITY, -INFINITY, -INFINITY}};
    for (int w = 0; w < j->count; w++) {
        bound(j->base[POSITION] + 3 * (size_t)j->source[w], &s);
    }
    (void)json_object_set_new(attributes, "POSITION", json_integer(add_vectors(j, &s)));
    (void)json_object_set_new(attributes, "NORMAL", json_integer(add_vectors(j, NULL)));
    if (has_uvs(j)) {
        int view = add_view(j, 8 * (uint64_t)j->count, VERTEX_DATA);
        int number = add_accessor(j, json_pack("{s:i, s:i, s:i, s:s}", "bufferView", view, "componentType",
                                               FLOAT_TYPE, "count", j->count, "type", "VEC2"));
        (void)json_object_set_new(attributes, "TEXCOORD_0", json_integer(number));
    }
    for (int k = 1; k < j->animation->count; k++) {
        int position = add_target(j, &j->target[k - 1][POSITION]),
            normal = add_target(j, &j->target[k - 1][NORMAL]);
        append(j, targets, json_pack("{s:i, s:i}", "POSITION", position, "NORMAL", normal));
        append(j, names, json_sprintf("frame %d", j->animation->first + k));
    }
}

static json_t* describe_file(job* j) {
    json_t *primitives = keep(j, json_array()), *materials = keep(j, json_array());
    json_t *attributes = keep(j, json_object()), *targets = keep(j, json_array()),
           *names = keep(j, json_array());
    const char* comment = j->animation->comment ? j->animation->comment : "";
    describe_vertices(j, attributes, targets, names);
    add_primitives(j, primitives, materials, attributes, targets);
    json_t* words = json_string(j->animation->name);
    json_t* root =
        json_pack("{s:{s:s, s:s, s:{s:s}}, s:i, s:[{s:[i]}], s:[o], s:[{s:o, s:o, s:{s:o}}], s:o, s:O, s:O}",
                  "asset", "version", "2.0", "generator", "Ruga", "extras", "comment", comment, "scene", 0,
                  "scenes", "nodes", 0, "nodes", describe_node(j), "meshes", "name",
                  words ? words : json_string("skin"), "primitives", primitives, "extras", "targetNames",
                  names, "materials", materials, "accessors", j->accessors, "bufferViews", j->views);
    keep(j, root);
    json_decref(attributes);
    json_decref(targets);
    if (root) {
        describe_animation(j, root);
        (void)json_object_set_new(root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)j->length));
    }
    return root;
}

// ---- data ----------------------------------------------------------------------------------------------

static void put_vectors(job* j, const float* value) {
    for (int w = 0; w < j->count; w++) {
        memcpy(j->delta + 3 * (size_t)w, value + 3 * (size_t)j->source[w], 3 * sizeof *value);
    }
    ruga_animation_put_floats(j->writer, j->delta, 3 * (size_t)j->count, false);
}

static void put_uvs(const job* j) {
    for (int w = 0; w < j->count; w++) {
        const double* uv = j->uv[w] >= 0 ? j->animation->mesh->uv + 2 * (size_t)j->uv[w] : NULL;
        const float st[2] = {uv ? (float)uv[0] : 0, uv ? (float)(1 - uv[1]) : 0};
        ruga_animation_put_floats(j->writer, st, 2, false);
    }
}

static void put_target(job* j, int k, int kind) {
    take_differences(j, kind);
    if (!is_sparse(j, &j->target[k - 1][kind])) {
        ruga_animation_put_floats(j->writer, j->delta, 3 * (size_t)j->count, false);
        return;
    }
    for (int w = 0; w < j->count; w++) {
        if (moves(j, w)) {
            ruga_animation_put_u32(j->writer, (uint32_t)w, false);
        }
    }
    for (int w = 0; w < j->count; w++) {
        if (moves(j, w)) {
            ruga_animation_put_floats(j->writer, j->delta + 3 * (size_t)w, 3, false);
        }
    }
}

static void put_indices(const job* j) {
    for (int i = 0; i < j->animation->mesh->triangle_count; i++) {
        for (size_t c = 0; c < 3; c++) {
            ruga_animation_put_u32(j->writer, (uint32_t)j->corner[3 * (size_t)j->order[i] + c], false);
        }
    }
}

static void put_animation(const job* j) {
    int frames = j->animation->count;
    for (int k = 0; frames > 1 && k < frames; k++) {
        const float time = time_of(j, k);
        ruga_animation_put_floats(j->writer, &time, 1, false);
    }
    for (int k = 0; k < frames; k++) {
        for (int target = 1; target < frames; target++) {
            const float weight = target == k;
            ruga_animation_put_floats(j->writer, &weight, 1, false);
        }
    }
}

static ruga_status put_data(job* j) {
    put_vectors(j, j->base[POSITION]);
    put_vectors(j, j->base[NORMAL]);
    if (has_uvs(j)) {
        put_uvs(j);
    }
    for (int k = 1; k < j->animation->count; k++) {
        RUGA_TRY(read_frame(j, k, j->now));
        put_target(j, k, POSITION);
        put_target(j, k, NORMAL);
    }
    put_indices(j);
    put_animation(j);
    return RUGA_OK;
}

static ruga_status write_file(job* j, const char* path, const char* head) {
    ruga_writer writer;
    size_t words = strlen(head), padded = (words + 3) / 4 * 4;
    uint64_t total = 12 + 8 + padded + 8 + j->length;
    if (total > UINT32_MAX) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "%s: %d frames take %.1f GB, and a glTF file holds 4.2: choose fewer by --frames, or another "
            "format (usda, pc2, mdd)",
            path, j->animation->count, 1e-9 * (double)total);
    }
    RUGA_TRY(ruga_writer_open(path, &writer));
    j->writer = &writer;
    (void)fwrite("glTF", 1, 4, writer.file);
    ruga_animation_put_u32(&writer, 2, false);
    ruga_animation_put_u32(&writer, (uint32_t)total, false);
    ruga_animation_put_u32(&writer, (uint32_t)padded, false);
    (void)fwrite("JSON", 1, 4, writer.file);
    (void)fwrite(head, 1, words, writer.file);
    (void)fwrite("   ", 1, padded - words, writer.file);
    ruga_animation_put_u32(&writer, (uint32_t)j->length, false);
    (void)fwrite("BIN", 1, 4, writer.file);
    ruga_status status = put_data(j);
    j->writer = NULL;
    return ruga_writer_close(&writer, status);
}

static ruga_status write_animation(job* j, const char* path) {
    json_t* root = describe_file(j);
    char* head = j->no_memory ? NULL : json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(17));
    ruga_status status =
        head ? write_file(j, path, head) : ruga_fail(RUGA_NO_MEMORY, "out of memory: the head of %s", path);
    free(head);
    json_decref(root);
    return status;
}

static ruga_status prepare(job* j) {
    const ruga_mesh* mesh = j->animation->mesh;
    size_t numbers = 3 * (size_t)mesh->vertex_count;
    j->views = keep(j, json_array());
    j->accessors = keep(j, json_array());
    RUGA_TRY(split_vertices(j));
    RUGA_TRY(RUGA_NEW(j->order, mesh->triangle_count));
    RUGA_TRY(RUGA_NEW(j->start, group_total(j) + 2));
    ruga_animation_sort_faces(mesh, j->order, j->start);
    RUGA_TRY(RUGA_NEW(j->scratch, 2 * numbers));
    for (int kind = 0; kind < KINDS; kind++) {
        RUGA_TRY(RUGA_NEW(j->base[kind], numbers));
        RUGA_TRY(RUGA_NEW(j->now[kind], numbers));
    }
    RUGA_TRY(RUGA_NEW(j->delta, 3 * (size_t)j->count));
    return RUGA_NEW(j->target, j->animation->count);
}

ruga_status ruga_gltf_animation_write(const char* path, const ruga_animation* animation) {
    ruga_status status = RUGA_OK;
    job j = {.animation = animation};
    if (animation->count > TARGETS_MAX) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: %d frames, and as morph targets at most %d are sane: choose fewer by "
                         "--frames, or another format (usda, pc2, mdd)",
                         path, animation->count, TARGETS_MAX);
    }
    RUGA_TRY_DONE(prepare(&j));
    RUGA_TRY_DONE(read_base(&j));
    RUGA_TRY_DONE(measure_targets(&j));
    status = write_animation(&j, path);
done:
    json_decref(j.views);
    json_decref(j.accessors);
    ruga_release(j.source);
    ruga_release(j.uv);
    ruga_release(j.next);
    ruga_release(j.head);
    ruga_release(j.corner);
    ruga_release(j.order);
    ruga_release(j.start);
    ruga_release(j.scratch);
    for (int kind = 0; kind < KINDS; kind++) {
        ruga_release(j.base[kind]);
        ruga_release(j.now[kind]);
    }
    ruga_release(j.delta);
    ruga_release(j.target);
    return status;
}
