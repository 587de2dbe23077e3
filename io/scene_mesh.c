// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The mesh that a scene names, as it will be simulated: file or made shape -> groups -> metres -> doctor ->
// remesh -> doctor; and the regions of handles, which can only be judged on it.
#include "constraints/attachments.h"
#include "core/memory.h"
#include "io/fold.h"
#include "io/mesh_file.h"
#include "io/scene_read.h"
#include "mesh/doctor.h"
#include "mesh/remesh.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

ruga_status ruga_scene_warn(ruga_scene* scene, const char* format, ...) {
    ruga_scene_parts* parts = scene->storage;
    char sentence[1024];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    RUGA_TRY(RUGA_RESERVE(scene->warning, parts->warning_capacity, scene->warning_count + 1));
    RUGA_TRY(ruga_pool_copy(&parts->pool, sentence, strlen(sentence), &scene->warning[scene->warning_count]));
    scene->warning_count++;
    return RUGA_OK;
}

// What lies within a crease pattern's outline.
static ruga_status read_outline(const char* path, int frame, ruga_mesh* mesh) {
    ruga_crease_pattern pattern = {0};
    ruga_status status = ruga_scene_read_pattern(path, frame, &pattern);
    if (status == RUGA_OK) {
        status = ruga_crease_pattern_mesh(&pattern, path, mesh);
    }
    ruga_crease_pattern_clear(&pattern);
    return status;
}

// A file that is not there is the scene's mistake, not the disk's.
static ruga_status read_file(const char* path, int frame, ruga_mesh* mesh) {
    FILE* file = fopen(path, "rb");
    bool failed = !file || (fgetc(file) == EOF && ferror(file)); // a folder opens, but cannot be read
    int error = errno;
    if (file) {
        (void)fclose(file);
    }
    if (failed) {
        return ruga_fail(RUGA_BAD_INPUT, "%s cannot be read: %s", path, strerror(error));
    }
    return ruga_scene_is_pattern(path) ? read_outline(path, frame, mesh) : ruga_mesh_read(path, mesh);
}

ruga_status ruga_scene_path(const char* directory, const char* name, ruga_pool* pool, char** path) {
    bool relative = name[0] != '/' && directory && directory[0];
    size_t size = strlen(name) + (relative ? strlen(directory) : 0) + 2;
    RUGA_TRY(RUGA_POOL_TAKE(pool, *path, size));
    (void)snprintf(*path, size, "%s%s%s", relative ? directory : "", relative ? "/" : "", name);
    return RUGA_OK;
}

static ruga_status read_source(const ruga_yaml_node* node, const ruga_scene_source* source,
                               const char* directory, ruga_pool* pool, ruga_mesh* mesh) {
    if (!source->file) {
        return ruga_yaml_fail_at(ruga_mesh_make(&source->make, mesh), ruga_yaml_find(node, "make"),
                                 "mesh.make");
    }
    char* path;
    RUGA_TRY(ruga_scene_path(directory, source->file, pool, &path));
    return ruga_yaml_fail_at(read_file(path, source->frame, mesh), ruga_yaml_find(node, "file"), "mesh.file");
}

static ruga_status take_groups(const ruga_yaml_node* node, const ruga_names* groups, ruga_mesh* mesh) {
    if (groups->count == 0) {
        return RUGA_OK;
    }
    ruga_mesh part = {0};
    ruga_status status =
        ruga_mesh_extract_groups(mesh, groups->count, (const char* const*)groups->text, &part);
    if (status == RUGA_OK) {
        ruga_mesh_clear(mesh);
        *mesh = part;
    }
    return ruga_yaml_fail_at(status, ruga_yaml_find(node, "groups"), "mesh.groups");
}

// A vertex without faces would be a mass that nothing holds.
static ruga_status drop_unused_vertices(ruga_mesh* mesh, int* dropped) {
    int* fresh = NULL; // new number of each vertex
    int* source = NULL;
    ruga_status status = RUGA_OK;
    int count = 0;
    *dropped = 0;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(fresh, mesh->vertex_count));
    for (int k = 0; k < 3 * mesh->triangle_count; k++) {
        fresh[mesh->triangle[k]] = 1;
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        count += fresh[v];
    }
    *dropped = mesh->vertex_count - count;
    if (*dropped == 0 || count == 0) {
        *dropped = 0;
        goto done;
    }
    RUGA_TRY_DONE(RUGA_NEW(source, count));
    count = 0;
    size_t attributes = (size_t)mesh->attribute_count;
    for (int v = 0; v < mesh->vertex_count; v++) {
        if (fresh[v]) {
            memmove(mesh->position + 3 * (size_t)count, mesh->position + 3 * (size_t)v, 3 * sizeof(double));
            if (attributes > 0) {
                memmove(mesh->attribute + attributes * (size_t)count,
                        mesh->attribute + attributes * (size_t)v, attributes * sizeof(double));
            }
            source[count] = mesh->source_vertex ? mesh->source_vertex[v] : v;
            fresh[v] = count++;
        }
    }
    for (int k = 0; k < 3 * mesh->triangle_count; k++) {
        mesh->triangle[k] = fresh[mesh->triangle[k]];
    }
    mesh->vertex_count = count;
    ruga_release(mesh->source_vertex);
    mesh->source_vertex = source;
done:
    ruga_release(fresh);
    return status;
}

static ruga_status scale_mesh(const ruga_scene_source* source, ruga_scene* scene) {
    double factor = source->unit * source->scale;
    ruga_mesh* mesh = &scene->mesh;
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++) {
        mesh->position[i] *= factor;
    }
    scene->mesh_unit = source->file ? factor : 1;
    double min[3], max[3], longest = 0;
    if (mesh->vertex_count == 0) {
        return RUGA_OK;
    }
    ruga_mesh_bounds(mesh, min, max);
    for (int axis = 0; axis < 3; axis++) {
        longest = max[axis] - min[axis] > longest ? max[axis] - min[axis] : longest;
    }
    return longest > 100 || longest < 1e-3
               ? ruga_scene_warn(scene, "%s: the mesh is %.3g m long; is mesh.unit (now %g m) right?",
                                 scene->mesh_name, longest, source->unit)
               : RUGA_OK;
}

// The doctor's opinion: errors end it, warnings go to the scene where `tell`.
static ruga_status examine(ruga_scene* scene, bool tell) {
    const ruga_model_def* def = &scene->def;
    bool shell = !def->has_interior || def->lattice.fill == RUGA_FILL_BOX;
    ruga_check_report report = {0};
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(ruga_mesh_check(&scene->mesh, shell ? RUGA_CHECK_SHELL : RUGA_CHECK_EMBEDDED, &report));
    RUGA_TRY_DONE(ruga_check_status(&report, scene->mesh_name));
    bool told[RUGA_DEFECT_KINDS] = {false};
    for (int i = 0; tell && i < report.defect_count; i++) {
        const ruga_defect* defect = &report.defect[i];
        if (defect->severity == RUGA_SEVERITY_WARNING && !told[defect->kind]) {
            told[defect->kind] = true;
            RUGA_TRY_DONE(ruga_scene_warn(scene, "%s: %s (%d of these, the first near %.4g, %.4g, %.4g m)",
                                          scene->mesh_name, ruga_defect_sentence(defect->kind),
                                          report.count[defect->kind], defect->position[0],
                                          defect->position[1], defect->position[2]));
        }
    }
done:
    ruga_check_report_clear(&report);
    return status;
}

static ruga_status remesh(const ruga_yaml_node* node, double edge, ruga_scene* scene) {
    if (!(edge > 0)) {
        return RUGA_OK;
    }
    ruga_mesh fresh = {0};
    ruga_status status = ruga_mesh_remesh(&scene->mesh, edge, &fresh);
    ruga_scene_parts* parts = scene->storage;
    if (status == RUGA_OK) {
        if (parts->follow.file) {
            parts->before_remesh = scene->mesh;
        } else {
            ruga_mesh_clear(&scene->mesh);
        }
        scene->mesh = fresh;
    }
    return ruga_yaml_fail_at(status, ruga_yaml_find(node, "remesh"), "mesh.remesh");
}

static int compare_pairs(const void* a, const void* b) {
    const int *p = a, *q = b;
    return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0]) : (p[1] > q[1]) - (p[1] < q[1]);
}

// Numbers of the file's vertices to those of the mesh, by pairs [count][2] of (file, mesh) in order.
static ruga_status map_vertices(const ruga_yaml_node* node, const char* shown, int count,
                                const int (*pairs)[2], ruga_region* region) {
    int* vertices = (int*)region->vertices; // the scene's own array
    for (int i = 0; i < region->vertex_count; i++) {
        int low = 0, high = count;
        while (low < high) {
            int middle = low + (high - low) / 2;
            if (pairs[middle][0] < vertices[i]) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        if (low == count || pairs[low][0] != vertices[i]) {
            return ruga_yaml_fail(node, shown, "vertex %d is not in the mesh that is simulated", vertices[i]);
        }
        vertices[i] = pairs[low][1];
    }
    return RUGA_OK;
}

ruga_status ruga_scene_map_vertices(const ruga_yaml_node* node, const char* shown, const ruga_mesh* mesh,
                                    ruga_region* region) {
    int(*pairs)[2] = NULL;
    RUGA_TRY(RUGA_NEW(pairs, mesh->vertex_count));
    int count = 0;
    for (int v = 0; v < mesh->vertex_count; v++) {
        int source = mesh->source_vertex ? mesh->source_vertex[v] : v;
        if (source >= 0) {
            pairs[count][0] = source;
            pairs[count++][1] = v;
        }
    }
    qsort(pairs, (size_t)count, sizeof *pairs, compare_pairs);
    ruga_status status = map_vertices(node, shown, count, (const int(*)[2])pairs, region);
    ruga_release(pairs);
    return status;
}

// Whether a region without any of the surface may still hold material of the interior: it has a volume, and
// that meets the mesh's bounding box; a lattice that fills a box reaches further, how far only the lattice
// knows.
static bool region_may_hold_interior(const ruga_region* region, ruga_fill fill, const double min[3],
                                     const double max[3]) {
    if (region->kind == RUGA_REGION_GROUP || region->kind == RUGA_REGION_VERTICES) {
        return false;
    }
    if (fill == RUGA_FILL_BOX) {
        return true;
    }
    double distance2 = 0, support = 0;
    for (int axis = 0; axis < 3; axis++) {
        if (region->kind == RUGA_REGION_BOX &&
            (region->max[axis] < min[axis] || region->min[axis] > max[axis])) {
            return false;
        }
        double c = region->center[axis], n = region->normal[axis];
        double outside = c < min[axis] ? min[axis] - c : c > max[axis] ? c - max[axis] : 0;
        distance2 += outside * outside;
        support += n * ((n > 0 ? max[axis] : min[axis]) - c);
    }
    if (region->kind == RUGA_REGION_SPHERE) {
        return distance2 <= region->radius * region->radius;
    }
    return region->kind != RUGA_REGION_PLANE || support >= 0;
}

static ruga_status check_selection(const ruga_yaml_node* node, const char* shown, const ruga_scene* scene,
                                   const ruga_handle_def* handle, int* selected) {
    int count = 0;
    RUGA_TRY(ruga_yaml_fail_at(ruga_region_vertices(&handle->region, &scene->mesh, &count, selected), node,
                               shown));
    // fix and move act on the interior too, where a region may hold material without any of the surface.
    bool holds = handle->kind == RUGA_HANDLE_FIX || handle->kind == RUGA_HANDLE_MOVE;
    bool on_skin = !scene->def.has_interior || handle->hold == RUGA_HOLD_SKIN || !holds;
    double min[3], max[3];
    ruga_mesh_bounds(&scene->mesh, min, max);
    bool anything = count > 0 || (!on_skin && region_may_hold_interior(&handle->region,
                                                                       scene->def.lattice.fill, min, max));
    // Corners of creases become vertices only when the mesh is cut; the model refuses what holds nothing
    // then.
    const ruga_scene_parts* parts = scene->storage;
    anything = anything || (holds && parts->crease_count > 0 &&
                            region_may_hold_interior(&handle->region, RUGA_FILL_MESH, min, max));
    return anything
               ? RUGA_OK
               : ruga_yaml_fail(node, shown,
                                "the region selects nothing; the mesh reaches from (%.4g, %.4g, %.4g) to "
                                "(%.4g, %.4g, %.4g) m",
                                min[0], min[1], min[2], max[0], max[1], max[2]);
}

static ruga_status check_regions(const ruga_yaml_node* list, ruga_scene* scene) {
    int* selected = NULL;
    RUGA_TRY(RUGA_NEW(selected, scene->mesh.vertex_count));
    ruga_status status = RUGA_OK;
    const ruga_yaml_node* item = list ? list->first : NULL;
    for (int i = 0; status == RUGA_OK && i < scene->def.handle_count; i++, item = item->next) {
        char shown[48];
        (void)snprintf(shown, sizeof shown, "handles.%d.region", i);
        const ruga_yaml_node* node = ruga_yaml_find(item, "region");
        ruga_handle_def* handle = (ruga_handle_def*)&scene->def.handles[i]; // the scene's own array
        if (handle->region.kind == RUGA_REGION_VERTICES) {
            status = ruga_scene_map_vertices(node, shown, &scene->mesh, &handle->region);
        }
        if (status == RUGA_OK) {
            status = check_selection(node, shown, scene, handle, selected);
        }
    }
    ruga_release(selected);
    return status;
}

ruga_status ruga_scene_load_mesh(const ruga_yaml_node* root, const char* directory, ruga_scene* scene) {
    ruga_scene_parts* parts = scene->storage;
    const ruga_scene_source* source = &parts->source;
    const ruga_yaml_node* node = ruga_yaml_find(root, "mesh");
    const ruga_yaml_node* from = ruga_yaml_find(node, source->file ? "file" : "make");
    const char* key = source->file ? "mesh.file" : "mesh.make";

    char name[512];
    (void)snprintf(name, sizeof name, source->file ? "%s" : "made %s",
                   source->file ? source->file : ruga_shape_name(source->make.shape));
    RUGA_TRY(ruga_pool_copy(&parts->pool, name, strlen(name), &scene->mesh_name));
    RUGA_TRY(read_source(node, source, directory, &parts->pool, &scene->mesh));
    parts->file_vertices = scene->mesh.vertex_count;
    RUGA_TRY(take_groups(node, &source->groups, &scene->mesh));
    int dropped;
    RUGA_TRY(drop_unused_vertices(&scene->mesh, &dropped));
    if (dropped > 0) {
        RUGA_TRY(ruga_scene_warn(scene, "%s: %d vertices belong to no face and are left out",
                                 scene->mesh_name, dropped));
    }
    RUGA_TRY(scale_mesh(source, scene));
    RUGA_TRY(ruga_yaml_fail_at(examine(scene, source->remesh_edge == 0), from, key));
    if (source->remesh_edge > 0) {
        RUGA_TRY(remesh(node, source->remesh_edge, scene));
        RUGA_TRY(ruga_yaml_fail_at(examine(scene, true), ruga_yaml_find(node, "remesh"), "mesh.remesh"));
    }
    return check_regions(ruga_yaml_find(root, "handles"), scene);
}
