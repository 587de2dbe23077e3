// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// skin.vary to values at the vertices of the mesh that is simulated. An entry sets (1 - t) first + t second
// on the vertices of its region, with t = 0 where there is a region alone, t in [0, 1] along a gradient or in
// a texture, and t the number itself of an attribute.
#include "constraints/attachments.h"
#include "core/memory.h"
#include "core/vec3.h"
#include "io/scene_read.h"
#include "io/texture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct job {
    ruga_scene* scene;
    const char* directory;
    double*
        array[RUGA_VARY_VALUES]; // [V] first entry of thickness, young and the two of growth; NULL = uniform
    int* selected;               // [V] of the entry at hand
    double* weight;              // [V] its t
} job;

// An entry with its place in the file.
typedef struct entry {
    const ruga_yaml_node* node;
    const char* shown;
    ruga_scene_vary* vary;
} entry;

static int stride_of(int value) {
    return value >= RUGA_VARY_GROWTH_U ? 2 : 1;
}

// ---- t -------------------------------------------------------------------------------------------------

static void weigh_gradient(const job* j, const ruga_scene_vary* vary) {
    double line[3], offset[3];
    ruga_subtract(vary->to, vary->from, line);
    for (int v = 0; v < j->scene->mesh.vertex_count; v++) {
        ruga_subtract(j->scene->mesh.position + 3 * (size_t)v, vary->from, offset);
        j->weight[v] = fmin(fmax(ruga_dot(offset, line) / ruga_dot(line, line), 0), 1);
    }
}

static ruga_status weigh_attribute(const job* j, const entry* e) {
    const ruga_mesh* mesh = &j->scene->mesh;
    const ruga_yaml_node* node = ruga_yaml_find(e->node, "attribute");
    int a = ruga_mesh_find_attribute(mesh, e->vary->attribute);
    if (a < 0) {
        char list[400] = "none (only .ply files have them)";
        for (int i = 0; i < mesh->attribute_count; i++) {
            size_t used = i == 0 ? 0 : strlen(list);
            (void)snprintf(list + used, sizeof list - used, "%s%s", i == 0 ? "" : ", ",
                           mesh->attribute_name[i]);
        }
        return ruga_yaml_fail(node, e->shown, "the mesh has no attribute '%.60s'; it has %s",
                              e->vary->attribute, list);
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        j->weight[v] = mesh->attribute[(size_t)mesh->attribute_count * (size_t)v + (size_t)a];
    }
    return RUGA_OK;
}

// glTF counts v from the upper edge of a picture, all other formats from the lower one.
static bool counts_from_above(const ruga_scene* scene) {
    const ruga_scene_parts* parts = scene->storage;
    const char* dot = parts->source.file ? strrchr(parts->source.file, '.') : NULL;
    return dot && (dot[1] == 'g' || dot[1] == 'G');
}

// A vertex on a seam takes the mean over its corners.
static ruga_status sample_texture(const job* j, const entry* e, const ruga_texture* texture, int* corners) {
    bool above = counts_from_above(j->scene);
    const ruga_mesh* mesh = &j->scene->mesh;
    memset(corners, 0, (size_t)mesh->vertex_count * sizeof *corners);
    memset(j->weight, 0, (size_t)mesh->vertex_count * sizeof *j->weight);
    for (size_t c = 0; c < 3 * (size_t)mesh->triangle_count; c++) {
        int u = mesh->uv_triangle[c], v = mesh->triangle[c];
        if (u >= 0) {
            const double* at = mesh->uv + 2 * (size_t)u;
            j->weight[v] += ruga_texture_at(texture, (const double[]){at[0], above ? 1 - at[1] : at[1]});
            corners[v]++;
        }
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        const double* x = mesh->position + 3 * (size_t)v;
        if (corners[v] == 0) {
            return ruga_yaml_fail(ruga_yaml_find(e->node, "texture"), e->shown,
                                  "vertex %d at (%.4g, %.4g, %.4g) m has no texture coordinates", v, x[0],
                                  x[1], x[2]);
        }
        j->weight[v] /= corners[v];
    }
    return RUGA_OK;
}

static ruga_status weigh_texture(const job* j, const entry* e) {
    ruga_scene_parts* parts = j->scene->storage;
    const ruga_yaml_node* node = ruga_yaml_find(e->node, "texture");
    ruga_texture texture = {0};
    int* corners = NULL;
    char* path;
    ruga_status status = RUGA_OK;
    if (!j->scene->mesh.uv || !j->scene->mesh.uv_triangle) {
        return ruga_yaml_fail(node, e->shown, "%s has no texture coordinates", j->scene->mesh_name);
    }
    RUGA_TRY(ruga_scene_path(j->directory, e->vary->texture, &parts->pool, &path));
    RUGA_TRY(ruga_yaml_fail_at(ruga_texture_read(path, &texture), node, e->shown));
    RUGA_TRY_DONE(RUGA_NEW(corners, j->scene->mesh.vertex_count));
    RUGA_TRY_DONE(sample_texture(j, e, &texture, corners));
done:
    ruga_release(corners);
    ruga_texture_clear(&texture);
    return status;
}

// ---- values --------------------------------------------------------------------------------------------

static ruga_status select_vertices(const job* j, const entry* e, int* count) {
    const ruga_yaml_node* region = ruga_yaml_find(e->node, "region");
    const ruga_mesh* mesh = &j->scene->mesh;
    char shown[64];
    (void)snprintf(shown, sizeof shown, "%.40s.region", e->shown);
    if (e->vary->region.kind == RUGA_REGION_VERTICES) {
        RUGA_TRY(ruga_scene_map_vertices(region, shown, mesh, &e->vary->region));
    }
    RUGA_TRY(ruga_yaml_fail_at(ruga_region_vertices(&e->vary->region, mesh, count, j->selected),
                               region ? region : e->node, shown));
    if (*count == 0) {
        double min[3], max[3];
        ruga_mesh_bounds(mesh, min, max);
        return ruga_yaml_fail(region, shown,
                              "the region selects nothing; the mesh reaches from (%.4g, %.4g, %.4g) to "
                              "(%.4g, %.4g, %.4g) m",
                              min[0], min[1], min[2], max[0], max[1], max[2]);
    }
    return RUGA_OK;
}

static ruga_status set_value(const job* j, const entry* e, int value, int count) {
    static const char* const names[RUGA_VARY_VALUES] = {"thickness", "young", "growth_u", "growth_v"};
    static const char* const units[RUGA_VARY_VALUES] = {" m", " Pa", "", ""};
    const ruga_scene_pair* pair = &e->vary->value[value];
    for (int k = 0; k < count; k++) {
        int v = j->selected[k];
        double t = pair->count == 2 ? j->weight[v] : 0;
        double set = (1 - t) * pair->value[0] + (pair->count == 2 ? t * pair->value[1] : 0);
        if (!(set > 0) || !isfinite(set)) {
            const double* x = j->scene->mesh.position + 3 * (size_t)v;
            return ruga_yaml_fail(ruga_yaml_find(e->node, names[value]), e->shown,
                                  "%s would be %g%s at vertex %d (%.4g, %.4g, %.4g) m; it must be above 0",
                                  names[value], set, units[value], v, x[0], x[1], x[2]);
        }
        j->array[value][(size_t)stride_of(value) * (size_t)v] = set;
    }
    return RUGA_OK;
}

static ruga_status apply(const job* j, const entry* e) {
    int count;
    RUGA_TRY(select_vertices(j, e, &count));
    if (e->vary->has_gradient) {
        weigh_gradient(j, e->vary);
    } else if (e->vary->attribute) {
        RUGA_TRY(weigh_attribute(j, e));
    } else if (e->vary->texture) {
        RUGA_TRY(weigh_texture(j, e));
    }
    for (int i = 0; i < RUGA_VARY_VALUES; i++) {
        if (e->vary->value[i].count > 0) {
            RUGA_TRY(set_value(j, e, i, count));
        }
    }
    return RUGA_OK;
}

// An array for each quantity that some entry sets, filled with the skin's own value; growth has both
// components.
static ruga_status take_arrays(job* j) {
    ruga_scene_parts* parts = j->scene->storage;
    ruga_skin_def* skin = &j->scene->def.skin;
    int vertices = j->scene->mesh.vertex_count;
    const double uniform[RUGA_VARY_VALUES] = {skin->thickness, skin->young, skin->growth[0], skin->growth[1]};
    bool wanted[RUGA_VARY_VALUES] = {false};
    double* array[3] = {NULL};
    for (int k = 0; k < parts->vary_count * RUGA_VARY_VALUES; k++) {
        int i = k % RUGA_VARY_VALUES;
        wanted[i] = wanted[i] || parts->vary[k / RUGA_VARY_VALUES].value[i].count > 0;
    }
    wanted[RUGA_VARY_GROWTH_U] = wanted[RUGA_VARY_GROWTH_U] || wanted[RUGA_VARY_GROWTH_V];
    for (int i = 0; i < 3; i++) {
        if (wanted[i]) {
            RUGA_TRY(RUGA_POOL_TAKE(&parts->pool, array[i], (size_t)stride_of(i) * (size_t)vertices));
            j->array[i] = array[i];
        }
    }
    j->array[RUGA_VARY_GROWTH_V] = array[RUGA_VARY_GROWTH_U] ? array[RUGA_VARY_GROWTH_U] + 1 : NULL;
    for (int i = 0; i < RUGA_VARY_VALUES; i++) {
        for (int v = 0; v < vertices && j->array[i]; v++) {
            j->array[i][(size_t)stride_of(i) * (size_t)v] = uniform[i];
        }
    }
    skin->vertex_count = vertices;
    skin->vertex_thickness = array[RUGA_VARY_THICKNESS];
    skin->vertex_young = array[RUGA_VARY_YOUNG];
    skin->vertex_growth = array[RUGA_VARY_GROWTH_U];
    return RUGA_OK;
}

ruga_status ruga_scene_vary_skin(const ruga_yaml_node* root, const char* directory, ruga_scene* scene) {
    ruga_scene_parts* parts = scene->storage;
    job j = {.scene = scene, .directory = directory};
    ruga_status status = RUGA_OK;
    if (parts->vary_count == 0) {
        return RUGA_OK;
    }
    RUGA_TRY_DONE(take_arrays(&j));
    RUGA_TRY_DONE(RUGA_NEW(j.selected, scene->mesh.vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(j.weight, scene->mesh.vertex_count));
    const ruga_yaml_node* node = ruga_yaml_find(ruga_yaml_find(root, "skin"), "vary")->first;
    for (int i = 0; i < parts->vary_count; i++, node = node->next) {
        char shown[40];
        (void)snprintf(shown, sizeof shown, "skin.vary.%d", i);
        const entry e = {node, shown, &parts->vary[i]};
        RUGA_TRY_DONE(apply(&j, &e));
    }
done:
    ruga_release(j.selected);
    ruga_release(j.weight);
    return status;
}
