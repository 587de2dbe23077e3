// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A curve that needs no vertex of its own leaves the mesh as it is mended for the others (crease/raster.c).
// Then the model that the result was made with is, at its last frame, a stage of the new one
// (solver/stages.h), to the number of each node: its restart vector is that of the stage. What frames show
// gains the embedded nodes of the added creases, which lie between two vertices that were there.
#include "app/added_creases.h"

#include "core/memory.h"
#include "crease/nest.h"
#include "io/result_layout.h"
#include "solver/stages.h"
#include "solver/state.h"

#include <stdio.h>
#include <string.h>

typedef struct adding {
    const char* path;
    const ruga_scene *before, *scene;
    const ruga_model* model;
    const ruga_result_header* header;
    ruga_result_reader* reader;
    ruga_result* result;
    ruga_model* old;
    ruga_raster raster; // of an old mesh without creases
    ruga_cut cut;
    ruga_nest nest;
    int (*from)[2]; // [V] the vertices of the old frames that a vertex lies between
    double* part;   // [V] of the way from the first
    int* segment;   // [S] of the old file, -1 = new
    double *position, *embedded, *shown, *shown_embedded, *lattice, *restart; // of a frame
    double *angle, *rest, *gap, *old_angle, *old_rest, *old_gap, *force;
} adding;

// ---- whether it is the same scene ----------------------------------------------------------------------

typedef struct keys {
    int count, capacity;
    const char* (*pair)[2];
    ruga_status status;
} keys;

static void take_key(const char* key, const char* value, const char* unit, bool given, void* context) {
    keys* k = context;
    (void)unit;
    (void)given;
    bool counts = strcmp(key, "time.frames") != 0 && strcmp(key, "creases") != 0;
    if (k->status == RUGA_OK && counts) {
        k->status = RUGA_RESERVE(k->pair, k->capacity, (size_t)k->count + 1);
        if (k->status == RUGA_OK) {
            k->pair[k->count][0] = key;
            k->pair[k->count++][1] = value;
        }
    }
}

// Whether all keys of one are in the other, in their order, and nothing more in that but keys of creases.
static bool adds_creases(const keys* one, const keys* other) {
    int i = 0;
    for (int j = 0; j < other->count; j++) {
        const char* const* pair = (const char* const*)other->pair[j];
        if (i < one->count && strcmp(one->pair[i][0], pair[0]) == 0 &&
            strcmp(one->pair[i][1], pair[1]) == 0) {
            i++;
        } else if (strncmp(pair[0], "creases.", 8) != 0) {
            return false;
        }
    }
    return i == one->count;
}

ruga_status ruga_added_creases_find(const ruga_result_header* header, const char* path,
                                    const ruga_scene* scene, ruga_scene* before, bool* found) {
    ruga_status status = RUGA_OK;
    char* directory = NULL;
    keys old = {0}, new = {0};
    const char* slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash - path) + (slash == path) : 0;
    *found = false;
    *before = (ruga_scene){0};
    RUGA_TRY_DONE(RUGA_NEW_ZERO(directory, folder + 1));
    memcpy(directory, path, folder);
    status = ruga_scene_read_text(header->scene_text, path, directory, 0, NULL, before);
    if (status != RUGA_OK) {
        status = status == RUGA_NO_MEMORY ? status : RUGA_OK; // its files may be gone
        goto done;
    }
    ruga_scene_each(before, take_key, &old);
    ruga_scene_each(scene, take_key, &new);
    RUGA_TRY_DONE(old.status);
    RUGA_TRY_DONE(new.status);
    *found = before->hash == header->scene_hash && before->mesh_hash == scene->mesh_hash &&
             before->def.crease_count < scene->def.crease_count && adds_creases(&old, &new);
done:
    ruga_release(directory);
    ruga_release(old.pair);
    ruga_release(new.pair);
    return status;
}

// ---- whether it can be -------------------------------------------------------------------------------

static ruga_status check_times(const adding* a, int last) {
    double time = last * a->scene->def.step;
    for (int i = a->before->def.crease_count; i < a->scene->def.crease_count; i++) {
        const ruga_crease_def* crease = &a->scene->def.creases[i];
        if (crease->start < time * (1 - 1e-9)) {
            return ruga_fail(
                RUGA_BAD_INPUT,
                "%s comes at %.6g s, but %s has frames up to %.6g s without it: give it this or a "
                "later start, or make all frames anew with --force",
                crease->name, crease->start, a->path, time);
        }
    }
    return RUGA_OK;
}

static ruga_status fail_mesh(const adding* a) {
    return ruga_fail(
        RUGA_BAD_INPUT,
        "%s, or a crease behind it, needs vertices or edges that the mesh of %s has not, as where it ends "
        "within the sheet, bends, or meets another: make all frames anew with --force",
        a->scene->def.creases[a->before->def.crease_count].name, a->path);
}

static int count_hinges(const ruga_model* model) {
    return model->creases ? model->creases->hinge_count : 0;
}

// Both models at a frame, node for node.
static bool are_same(const ruga_model* one, const ruga_model* other) {
    const ruga_mesh *a = &one->mesh, *b = &other->mesh;
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           one->sheet->vertex_count == other->sheet->vertex_count &&
           count_hinges(one) == count_hinges(other) &&
           memcmp(a->position, b->position, 3 * (size_t)a->vertex_count * sizeof *a->position) == 0 &&
           memcmp(a->triangle, b->triangle, 3 * (size_t)a->triangle_count * sizeof *a->triangle) == 0;
}

// Whether the file is what this version makes of its scene.
static bool is_ours(const adding* a) {
    const ruga_result_header* header = ruga_result_reader_header(a->reader);
    int segments = header->creases ? header->creases->segment_count : 0;
    return header->mesh->vertex_count == ruga_model_vertex_count(a->old) &&
           segments == (a->old->creases ? a->old->creases->segment_count : 0) &&
           header->restart_doubles == ruga_state_restart_size(a->old) &&
           header->restart_doubles <= a->header->restart_doubles;
}

static ruga_status compare(adding* a, int last) {
    RUGA_TRY(check_times(a, last));
    RUGA_TRY(ruga_scene_place_error(a->before, ruga_model_create(&a->before->def, &a->old)));
    if (!is_ours(a)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s is of another version of Ruga: make all frames anew with --force", a->path);
    }
    if (!are_same(ruga_stage_model(a->old, ruga_stage_of_frame(a->old, last)),
                  ruga_stage_model(a->model, ruga_stage_of_frame(a->model, last)))) {
        return fail_mesh(a);
    }
    const ruga_cut* cut = &a->cut;
    if (a->old->creases) {
        cut = &a->old->creases->cut;
    } else {
        const ruga_curves none = {0};
        const ruga_raster_def how = ruga_default_raster_def();
        RUGA_TRY(ruga_raster_create(&a->old->mesh, &none, &how, &a->raster));
        RUGA_TRY(ruga_cut_create(&a->raster, &a->cut));
    }
    ruga_status status = ruga_nest_create(&a->model->creases->cut, cut, &a->nest);
    return status == RUGA_BAD_INPUT ? fail_mesh(a) : status;
}

// ---- where vertices and segments come from -----------------------------------------------------------

// The old bound that lies between the same nodes, -1 = none.
static int find_bound(const ruga_cut* old, int edge, const int node[2]) {
    for (int b = 0; b < old->bound_count; b++) {
        for (int k = 0; k < old->bound[b].count && old->bound[b].edge == edge; k++) {
            const int* parent = old->parent[old->bound[b].first + k];
            if (parent[0] == node[0] && parent[1] == node[1]) {
                return b;
            }
        }
    }
    return -1;
}

static ruga_status map_vertices(adding* a) {
    const ruga_cut *cut = &a->model->creases->cut, *old = a->old->creases ? &a->old->creases->cut : &a->cut;
    int vertices = cut->real_count + cut->bound_count;
    RUGA_TRY(RUGA_NEW(a->from, vertices));
    RUGA_TRY(RUGA_NEW_ZERO(a->part, vertices));
    for (int n = 0; n < cut->real_count; n++) {
        a->from[n][0] = a->from[n][1] = a->nest.node[n];
    }
    for (int b = 0; b < cut->bound_count; b++) {
        const ruga_bound* bound = &cut->bound[b];
        const int* parent = cut->parent[bound->first];
        const int node[2] = {a->nest.node[parent[0]], a->nest.node[parent[1]]};
        int *from = a->from[cut->real_count + b], was = find_bound(old, bound->edge, node);
        from[0] = was >= 0 ? old->real_count + was : node[0];
        from[1] = was >= 0 ? from[0] : node[1];
        a->part[cut->real_count + b] = was >= 0 ? 0 : bound->weight[1];
        if (was < 0 && (node[0] >= old->real_count || node[1] >= old->real_count)) {
            return fail_mesh(a);
        }
    }
    return RUGA_OK;
}

static ruga_status map_segments(adding* a) {
    const ruga_creases *creases = a->model->creases, *old = a->old->creases;
    ruga_status status = RUGA_OK;
    int* row = NULL;
    RUGA_TRY_DONE(RUGA_NEW(a->segment, creases->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(row, old ? old->cut.segment_count : 0));
    for (int h = 0; old && h < old->hinge_count; h++) {
        row[old->segment[h]] = h < old->segment_count ? h : -1;
    }
    for (int h = 0; h < creases->segment_count; h++) {
        int s = a->nest.segment[creases->segment[h]];
        a->segment[h] = s < 0 ? -1 : row[s];
    }
done:
    ruga_release(row);
    return status;
}

// ---- frames --------------------------------------------------------------------------------------------

static void map_places(const adding* a, const double* old, double* shown) {
    for (int v = 0; v < a->header->mesh->vertex_count; v++) {
        const double *from = old + 3 * (size_t)a->from[v][0], *to = old + 3 * (size_t)a->from[v][1];
        for (int i = 0; i < 3; i++) {
            shown[3 * v + i] = a->part[v] > 0 ? (1 - a->part[v]) * from[i] + a->part[v] * to[i] : from[i];
        }
    }
}

static ruga_status map_creases(adding* a, int frame, double* gap) {
    *gap = 0;
    if (ruga_result_reader_header(a->reader)->creases) {
        RUGA_TRY(ruga_result_read_creases(a->reader, frame, a->old_angle, a->old_rest, gap));
        RUGA_TRY(ruga_result_read_segment_gaps(a->reader, frame, a->old_gap));
    }
    for (int h = 0; h < a->model->creases->segment_count; h++) {
        int was = a->segment[h];
        a->angle[h] = was >= 0 ? a->old_angle[was] : ruga_creases_shown_angle(a->model->creases, h, a->shown);
        a->rest[h] = was >= 0 ? a->old_rest[was] : a->angle[h];
        a->gap[h] = was >= 0 ? a->old_gap[was] : 0;
    }
    return RUGA_OK;
}

static ruga_status copy_frame(adding* a, int frame) {
    const ruga_result_header* header = a->header;
    ruga_result_frame copy = {.position = a->shown,
                              .embedded = header->lattice ? a->shown_embedded : NULL,
                              .lattice_position = header->lattice ? a->lattice : NULL,
                              .crease_angle = a->angle,
                              .crease_rest = a->rest,
                              .segment_gap = a->gap,
                              .handle_force = a->force,
                              .restart = a->restart};
    bool found = false;
    RUGA_TRY(ruga_result_read_frame(a->reader, frame, &copy.time, a->position,
                                    header->lattice ? a->embedded : NULL, &copy.report));
    map_places(a, a->position, a->shown);
    if (header->lattice) {
        RUGA_TRY(ruga_result_read_lattice(a->reader, frame, NULL, NULL, a->lattice));
        map_places(a, a->embedded, a->shown_embedded);
    }
    RUGA_TRY(map_creases(a, frame, &copy.gap));
    RUGA_TRY(ruga_result_read_handle_force(a->reader, frame, a->force));
    int last = ruga_result_frame_count(a->reader) - 1;
    if (frame >= last - 1) {
        RUGA_TRY(ruga_result_read_restart(a->reader, frame, a->restart, &found));
    }
    if (frame == last && !found) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: the restart data of its last frame are missing: start anew with --force",
                         a->path);
    }
    return ruga_result_append(a->result, &copy);
}

static ruga_status allocate(adding* a) {
    const ruga_result_header *header = a->header, *old = ruga_result_reader_header(a->reader);
    size_t vertices = (size_t)header->mesh->vertex_count, before = (size_t)old->mesh->vertex_count;
    size_t segments = (size_t)a->model->creases->segment_count;
    size_t was = old->creases ? (size_t)old->creases->segment_count : 0;
    RUGA_TRY(RUGA_NEW(a->position, 3 * before));
    RUGA_TRY(RUGA_NEW(a->embedded, 3 * before));
    RUGA_TRY(RUGA_NEW(a->shown, 3 * vertices));
    RUGA_TRY(RUGA_NEW(a->shown_embedded, 3 * vertices));
    RUGA_TRY(RUGA_NEW(a->lattice, header->lattice ? 3 * (size_t)header->lattice->node_count : 0));
    RUGA_TRY(RUGA_NEW_ZERO(a->restart, header->restart_doubles));
    RUGA_TRY(RUGA_NEW(a->angle, segments));
    RUGA_TRY(RUGA_NEW(a->rest, segments));
    RUGA_TRY(RUGA_NEW(a->gap, segments));
    RUGA_TRY(RUGA_NEW(a->old_angle, was));
    RUGA_TRY(RUGA_NEW(a->old_rest, was));
    RUGA_TRY(RUGA_NEW(a->old_gap, was));
    return RUGA_NEW_ZERO(a->force, 3 * (size_t)header->handle_count);
}

static void clear(adding* a) {
    void* const owned[] = {a->from,           a->part,     a->segment, a->position, a->embedded, a->shown,
                           a->shown_embedded, a->lattice,  a->restart, a->angle,    a->rest,     a->gap,
                           a->old_angle,      a->old_rest, a->old_gap, a->force};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    ruga_nest_clear(&a->nest);
    ruga_cut_clear(&a->cut);
    ruga_raster_clear(&a->raster);
    ruga_model_destroy(&a->old);
    ruga_result_reader_close(&a->reader);
}

static ruga_status write_file(adding* a, const char* name) {
    int nodes;
    RUGA_TRY(allocate(a));
    RUGA_TRY(ruga_result_read_lattice(a->reader, 0, &nodes, NULL, NULL));
    if (nodes != (a->header->lattice ? a->header->lattice->node_count : 0)) {
        return fail_mesh(a);
    }
    RUGA_TRY(ruga_result_create(name, a->header, true, &a->result));
    for (int frame = 0; frame < ruga_result_frame_count(a->reader); frame++) {
        RUGA_TRY(copy_frame(a, frame));
    }
    return RUGA_OK;
}

// Under a name of its own until it is whole.
ruga_status ruga_added_creases_write(const char* path, const ruga_scene* before, const ruga_scene* scene,
                                     const ruga_model* model, const ruga_result_header* header) {
    ruga_status status = RUGA_OK;
    adding a = {.path = path, .before = before, .scene = scene, .model = model, .header = header};
    char* name = NULL;
    RUGA_TRY_DONE(RUGA_NEW(name, strlen(path) + 8));
    (void)snprintf(name, strlen(path) + 8, "%s.added", path);
    RUGA_TRY_DONE(ruga_result_open(path, &a.reader));
    RUGA_TRY_DONE(compare(&a, ruga_result_frame_count(a.reader) - 1));
    RUGA_TRY_DONE(map_vertices(&a));
    RUGA_TRY_DONE(map_segments(&a));
    status = write_file(&a, name);
    if (a.result) {
        ruga_status closed = ruga_result_close(&a.result);
        status = status == RUGA_OK ? closed : status;
        if (status == RUGA_OK && rename(name, path) != 0) {
            status = ruga_fail(RUGA_IO, "%s cannot take the place of %s", name, path);
        }
        if (status != RUGA_OK) {
            (void)remove(name);
        }
    }
done:
    ruga_release(name);
    clear(&a);
    return status;
}
