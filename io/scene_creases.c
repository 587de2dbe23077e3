// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Entries of `creases` to the creases of a def: one for a curve that is drawn, one for each line of a
// pattern.
#include "core/memory.h"
#include "core/vec3.h"
#include "crease/flat.h"
#include "io/file_name.h"
#include "io/fold.h"
#include "io/result.h"
#include "io/scene_read.h"
#include "mesh/transfer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double FLAT = 1e-6;          // rad off half a turn
static const double SVG_TOLERANCE = 1e-3; // of a drawing's size, for curves

bool ruga_scene_is_pattern(const char* name) {
    return ruga_file_name_ends(name, ".fold") || ruga_file_name_ends(name, ".svg");
}

// A file that is not there is the scene's mistake, not the disk's.
ruga_status ruga_scene_read_pattern(const char* path, int frame, ruga_crease_pattern* pattern) {
    ruga_status status = ruga_file_name_ends(path, ".svg") ? ruga_svg_read(path, 1, SVG_TOLERANCE, pattern)
                                                           : ruga_fold_read(path, frame, 1, pattern);
    return status == RUGA_IO ? ruga_fail(RUGA_BAD_INPUT, "%s", ruga_last_error()) : status;
}

typedef struct loader {
    ruga_scene* scene;
    ruga_pool* pool;
    ruga_crease_def* def;
    int count, capacity;
} loader;

static ruga_status add_def(loader* l, const ruga_crease_def* def, const char* name) {
    RUGA_TRY(RUGA_RESERVE(l->def, l->capacity, l->count + 1));
    char* copy;
    RUGA_TRY(ruga_pool_copy(l->pool, name, strlen(name), &copy));
    l->def[l->count] = *def;
    l->def[l->count++].name = copy;
    return RUGA_OK;
}

// What all creases of an entry have in common.
static ruga_crease_def common(const ruga_scene_crease* crease, const ruga_skin_def* skin) {
    ruga_crease_def def = ruga_default_crease_def();
    double rigidity = skin->young * pow(skin->thickness, 3) / (12 * (1 - skin->poisson * skin->poisson));
    const ruga_scene_points *k = &crease->stiffness, *rest = &crease->rest;
    def.kind = crease->cut ? RUGA_CREASE_CUT : RUGA_CREASE_FOLD;
    def.freedom = crease->freedom;
    def.start = crease->start;
    def.assignment = crease->cut ? 'C' : 'U';
    def.stiffness = crease->length > 0 ? rigidity / crease->length : k->count > 0 ? k->value[0] : 0;
    def.point_stiffness = k->count > 1 ? k->value : NULL;
    def.rest = rest->count > 0 && !rest->word ? crease->scale * rest->value[0] : NAN;
    for (int i = 0; i < rest->count && rest->count > 1; i++) {
        rest->value[i] *= crease->scale;
    }
    def.point_rest = rest->count > 1 ? rest->value : NULL;
    def.key_count = crease->key_count;
    def.keys = crease->keys;
    def.yield = crease->yield;
    def.rate = crease->rate;
    def.hardening = crease->hardening;
    return def;
}

static ruga_status add_lines(loader* l, const ruga_scene_crease* crease, const char* file,
                             const ruga_crease_pattern* pattern, const ruga_curves* curves, double unit) {
    for (int c = 0; c < curves->count; c++) {
        const ruga_curve* curve = &curves->curve[c];
        const ruga_crease_pattern_edge* edge = &pattern->edge[curve->label];
        ruga_crease_def def = common(crease, &l->scene->def.skin);
        double* points;
        char name[320];
        RUGA_TRY(RUGA_POOL_TAKE(l->pool, points, 3 * (size_t)curve->point_count));
        for (int i = 0; i < 3 * curve->point_count; i++) {
            points[i] = unit * curve->point[i / 3][i % 3];
        }
        def.points = points;
        def.point_count = curve->point_count;
        def.closed = curve->closed;
        def.freedom = def.freedom == RUGA_FREEDOM_AUTO ? curve->freedom : def.freedom;
        def.kind = crease->cut ? RUGA_CREASE_CUT : curve->kind;
        def.assignment = ruga_assignment_letter(edge->assignment);
        def.rest = crease->rest.word ? crease->scale * ruga_crease_pattern_rest(edge) : def.rest;
        (void)snprintf(name, sizeof name, "%.250s edge %d", file, curve->label);
        RUGA_TRY(add_def(l, &def, name));
    }
    return RUGA_OK;
}

// Where the rest angles are those of a pattern folded flat.
static ruga_status warn_of_faults(loader* l, const ruga_scene_crease* crease, const char* file,
                                  const ruga_crease_pattern* pattern) {
    int count;
    ruga_flat_fault* fault;
    char text[200];
    bool flat = crease->rest.word && !pattern->folded;
    for (int e = 0; e < pattern->edge_count; e++) {
        double angle = ruga_crease_pattern_rest(&pattern->edge[e]);
        flat = flat && (angle == 0 || fabs(fabs(angle) - RUGA_PI) < FLAT);
    }
    if (!flat) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_crease_pattern_flat_faults(pattern, &count, &fault));
    ruga_status status = RUGA_OK;
    if (count > 0) {
        ruga_flat_fault_say(pattern, &fault[0], text);
        status = ruga_scene_warn(l->scene, "%s: the pattern cannot fold flat at %d of its vertices: %s", file,
                                 count, text);
    }
    ruga_release(fault);
    return status;
}

static ruga_status add_pattern(loader* l, const ruga_scene_crease* crease, const char* directory) {
    ruga_status status = RUGA_OK;
    ruga_crease_pattern pattern = {0};
    ruga_curves curves = {0};
    const char* file = crease->fold ? crease->fold : crease->svg;
    char* path;
    RUGA_TRY_DONE(ruga_scene_path(directory, file, l->pool, &path));
    RUGA_TRY_DONE(ruga_scene_read_pattern(path, crease->frame, &pattern));
    for (int i = 0; i < pattern.note_count; i++) {
        RUGA_TRY_DONE(ruga_scene_warn(l->scene, "%s: %s", file, pattern.note[i]));
    }
    RUGA_TRY_DONE(warn_of_faults(l, crease, file, &pattern));
    RUGA_TRY_DONE(ruga_crease_pattern_curves(&pattern, &(ruga_curve){0}, false, &curves));
    if (curves.count == 0) {
        status = ruga_fail(RUGA_BAD_INPUT, "%s has no creases", file);
        for (int i = 0; i < pattern.note_count; i++) { // where they went
            status = ruga_fail(status, "%s; %s", ruga_last_error(), pattern.note[i]);
        }
        goto done;
    }
    RUGA_TRY_DONE(add_lines(l, crease, file, &pattern, &curves, l->scene->mesh_unit));
done:
    ruga_curves_clear(&curves);
    ruga_crease_pattern_clear(&pattern);
    return status;
}

// A frame of a result, its surface at rest and as it is.
static ruga_status find_ridges(const char* path, const ruga_scene_crease* crease, double poisson,
                               ruga_curves* curves) {
    ruga_result_reader* reader = NULL;
    double* position = NULL;
    ruga_ridge_def def = crease->ridge;
    ruga_status status = ruga_result_open(path, &reader);
    if (status == RUGA_IO) {
        status = ruga_fail(RUGA_BAD_INPUT, "%s", ruga_last_error());
    }
    RUGA_TRY_DONE(status);
    int frames = ruga_result_frame_count(reader),
        frame = crease->result_frame < 0 ? frames - 1 : crease->result_frame;
    if (frame < 0 || frame >= frames) {
        status = ruga_fail(RUGA_BAD_INPUT, "%s has no frame %d: there are %d", path, frame, frames);
        goto done;
    }
    const ruga_mesh* mesh = ruga_result_mesh(reader);
    def.stress = crease->from == 1;
    def.poisson = poisson;
    RUGA_TRY_DONE(RUGA_NEW(position, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY_DONE(ruga_result_read_frame(reader, frame, NULL, position, NULL, NULL));
    RUGA_TRY_DONE(ruga_ridges_find(mesh, position, &def, curves));
    if (curves->count == 0) {
        status = ruga_fail(RUGA_BAD_INPUT, "frame %d of %s has no ridge as long and as strong as asked for",
                           frame, path);
    }
done:
    ruga_release(position);
    ruga_result_reader_close(&reader);
    return status;
}

// Curves of another surface would be laid down somewhere all the same.
static ruga_status check_surface(const ruga_mesh* mesh, const ruga_curve* curve, const char* result) {
    const double near = 0.01; // of the mesh's diagonal: the same surface in other triangles is nearer
    double min[3], max[3];
    int(*corner)[3] = NULL;
    double(*weight)[3] = NULL;
    ruga_status status = RUGA_OK;
    ruga_mesh_bounds(mesh, min, max);
    RUGA_TRY_DONE(RUGA_NEW(corner, curve->point_count));
    RUGA_TRY_DONE(RUGA_NEW(weight, curve->point_count));
    RUGA_TRY_DONE(ruga_mesh_locate(mesh, curve->point_count, curve->point[0], corner, weight));
    for (int i = 0; i < curve->point_count; i++) {
        const double* x = curve->point[i];
        double off[3] = {-x[0], -x[1], -x[2]};
        for (int k = 0; k < 3; k++) {
            ruga_add_scaled(weight[i][k], mesh->position + 3 * (size_t)corner[i][k], off);
        }
        if (ruga_norm(off) > near * ruga_distance(min, max)) {
            status = ruga_fail(
                RUGA_BAD_INPUT,
                "%s has another surface at rest: its ridge at (%.4g, %.4g, %.4g) is %.3g m away from "
                "this mesh",
                result, x[0], x[1], x[2], ruga_norm(off));
            break;
        }
    }
done:
    ruga_release(corner);
    ruga_release(weight);
    return status;
}

static ruga_status add_ridges(loader* l, const ruga_scene_crease* crease, const char* directory) {
    ruga_status status = RUGA_OK;
    ruga_crease_pattern pattern = {0};
    ruga_curves curves = {0};
    char* path;
    RUGA_TRY_DONE(ruga_scene_path(directory, crease->result, l->pool, &path));
    RUGA_TRY_DONE(find_ridges(path, crease, l->scene->def.skin.poisson, &curves));
    for (int c = 0; c < curves.count; c++) {
        RUGA_TRY_DONE(check_surface(&l->scene->mesh, &curves.curve[c], crease->result));
    }
    RUGA_TRY_DONE(ruga_crease_pattern_add_curves(&pattern, &curves));
    for (int c = 0, edge = 0; c < curves.count; c++) { // a label is a line of the pattern from here on
        ruga_curve* curve = &curves.curve[c];
        curve->label = edge;
        edge += curve->closed ? curve->point_count : curve->point_count - 1;
    }
    RUGA_TRY_DONE(add_lines(l, crease, crease->result, &pattern, &curves, 1));
done:
    ruga_curves_clear(&curves);
    ruga_crease_pattern_clear(&pattern);
    return status;
}

static ruga_status add_drawn(loader* l, const ruga_yaml_node* curve, const char* shown,
                             ruga_scene_crease* crease, int index) {
    ruga_crease_def def = common(crease, &l->scene->def.skin);
    char name[48];
    def.closed = crease->closed;
    def.path = crease->polyline.count > 0      ? RUGA_CREASE_POLYLINE
               : crease->uv.count > 0          ? RUGA_CREASE_UV
               : crease->path.vertex_count > 0 ? RUGA_CREASE_EDGES
                                               : RUGA_CREASE_GROUP;
    const ruga_scene_points* points = def.path == RUGA_CREASE_UV ? &crease->uv : &crease->polyline;
    def.point_count = points->count;
    def.points = points->value;
    if (def.path == RUGA_CREASE_EDGES) {
        RUGA_TRY(ruga_scene_map_vertices(ruga_yaml_find(curve, "vertices"), shown, &l->scene->mesh,
                                         &crease->path));
        def.vertices = crease->path.vertices;
        def.vertex_count = crease->path.vertex_count;
    }
    def.group = crease->group;
    (void)snprintf(name, sizeof name, "creases.%d", index);
    return add_def(l, &def, name);
}

static ruga_status keep(loader* l) {
    ruga_crease_def* kept;
    RUGA_TRY(RUGA_POOL_TAKE(l->pool, kept, l->count));
    memcpy(kept, l->def, (size_t)l->count * sizeof *kept);
    l->scene->def.creases = kept;
    l->scene->def.crease_count = l->count;
    return RUGA_OK;
}

ruga_status ruga_scene_load_creases(const ruga_yaml_node* root, const char* directory, ruga_scene* scene) {
    ruga_status status = RUGA_OK;
    ruga_scene_parts* parts = scene->storage;
    loader l = {.scene = scene, .pool = &parts->pool};
    const ruga_yaml_node* list = ruga_yaml_find(root, "creases");
    const ruga_yaml_node* node = list ? list->first : NULL;
    for (int i = 0; i < parts->crease_count; i++, node = node->next) {
        ruga_scene_crease* crease = &parts->crease[i];
        const ruga_yaml_node* curve = ruga_yaml_find(node, "curve");
        char shown[48];
        (void)snprintf(shown, sizeof shown, "creases.%d.curve", i);
        RUGA_TRY_DONE(crease->fold || crease->svg
                          ? ruga_yaml_fail_at(add_pattern(&l, crease, directory), curve, shown)
                      : crease->result ? ruga_yaml_fail_at(add_ridges(&l, crease, directory), curve, shown)
                                       : add_drawn(&l, curve, shown, crease, i));
    }
    RUGA_TRY_DONE(l.count > 0 ? keep(&l) : RUGA_OK);
done:
    ruga_release(l.def);
    return status;
}
