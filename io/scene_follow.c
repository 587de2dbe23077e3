// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The moving surface that a scene's interior follows. A cache has the vertices of the mesh's file; the mesh
// that is simulated may be a part of it (groups) or remeshed: x_v(t) = X_v + sum_i w_i (c_i(t) - C_i), c_i
// the cache's points (in metres) at the corners of the face of the file that is nearest to v, w_i the weights
// of the nearest point, C_i the rest shape there. Without remeshing, one corner of weight 1.
#include "core/memory.h"
#include "core/vec3.h"
#include "io/point_cache.h"
#include "io/scene_read.h"
#include "mesh/transfer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct ruga_follower {
    ruga_point_cache cache;
    double factor; // m per unit of the cache
    int vertex_count;
    int (*corner)[3];    // [V] points of the cache
    double (*weight)[3]; // [V]
    double (*offset)[3]; // [V] m, X - sum w C
    double* time;        // [samples] s
    double* point;       // [points][3] as in the cache
} ruga_follower;

void ruga_scene_follow_clear(ruga_scene_parts* parts) {
    ruga_follower* f = parts->follower;
    ruga_mesh_clear(&parts->before_remesh);
    if (f) {
        ruga_point_cache_close(&f->cache);
        ruga_release(f->corner);
        ruga_release(f->weight);
        ruga_release(f->offset);
        ruga_release(f->time);
        ruga_release(f->point);
        ruga_release(f);
        parts->follower = NULL;
    }
}

static ruga_status read_sample(int sample, double* positions, void* context) {
    ruga_follower* f = context;
    RUGA_TRY(ruga_point_cache_read(&f->cache, sample, f->point));
    for (size_t v = 0; v < (size_t)f->vertex_count; v++) {
        double* x = positions + 3 * v;
        memcpy(x, f->offset[v], 3 * sizeof *x);
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(f->factor * f->weight[v][i], f->point + 3 * (size_t)f->corner[v][i], x);
        }
    }
    return RUGA_OK;
}

// ---- where the mesh's vertices are in the cache ----------------------------------------------------------

static ruga_status map_vertices(const ruga_scene* scene, ruga_follower* f) {
    const ruga_scene_parts* parts = scene->storage;
    bool remeshed = parts->before_remesh.vertex_count > 0;
    const ruga_mesh *mesh = &scene->mesh, *source = remeshed ? &parts->before_remesh : mesh;
    f->vertex_count = mesh->vertex_count;
    RUGA_TRY(RUGA_NEW_ZERO(f->corner, mesh->vertex_count));
    RUGA_TRY(RUGA_NEW_ZERO(f->weight, mesh->vertex_count));
    RUGA_TRY(RUGA_NEW_ZERO(f->offset, mesh->vertex_count));
    if (remeshed) {
        RUGA_TRY(ruga_mesh_locate(source, mesh->vertex_count, mesh->position, f->corner, f->weight));
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        memcpy(f->offset[v], mesh->position + 3 * (size_t)v, sizeof f->offset[v]);
        if (!remeshed) {
            f->corner[v][0] = v;
            f->weight[v][0] = 1;
        }
        for (int i = 0; i < 3; i++) {
            int corner = f->corner[v][i];
            ruga_add_scaled(-f->weight[v][i], source->position + 3 * (size_t)corner, f->offset[v]);
            f->corner[v][i] = source->source_vertex ? source->source_vertex[corner] : corner;
        }
    }
    return RUGA_OK;
}

// ---- checks ----------------------------------------------------------------------------------------------

static ruga_status check_cache(const ruga_yaml_node* node, const ruga_scene* scene,
                               const ruga_point_cache* cache) {
    const ruga_scene_parts* parts = scene->storage;
    const ruga_yaml_node* rate = ruga_yaml_find(node, "rate");
    if (cache->point_count != parts->file_vertices) {
        return ruga_yaml_fail(
            ruga_yaml_find(node, "file"), "follow.file",
            "%s has %d points, and %s %d vertices: a cache belongs to the mesh that it was made of",
            parts->follow.file, cache->point_count, scene->mesh_name, parts->file_vertices);
    }
    return cache->time_is_real && rate
               ? ruga_yaml_fail(rate, "follow.rate", "%s has times of its own; leave the rate out",
                                parts->follow.file)
               : RUGA_OK;
}

static void bound(const double* x, double box[6]) {
    for (int i = 0; i < 3; i++) {
        box[i] = fmin(box[i], x[i]);
        box[3 + i] = fmax(box[3 + i], x[i]);
    }
}

static ruga_status warn_of_surface(ruga_scene* scene, const double* position) {
    const ruga_scene_parts* parts = scene->storage;
    const ruga_follower* f = parts->follower;
    double rest[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY}, first[6];
    memcpy(first, rest, sizeof first);
    for (size_t v = 0; v < (size_t)f->vertex_count; v++) {
        bound(scene->mesh.position + 3 * v, rest);
        bound(position + 3 * v, first);
    }
    double ratio = ruga_distance(first, first + 3) / ruga_distance(rest, rest + 3);
    if (!(ratio > 0.2 && ratio < 5)) {
        RUGA_TRY(ruga_scene_warn(
            scene, "%s: its first sample is %.3g times as large as the mesh; is its unit the mesh's?",
            parts->follow.file, ratio));
    }
    double end = scene->def.step * scene->def.frames, last = f->time[f->cache.sample_count - 1];
    return end > last + 1e-9 * fabs(end)
               ? ruga_scene_warn(
                     scene, "%s: its last sample is at %.6g s and the scene lasts until %.6g s: it is held",
                     parts->follow.file, last, end)
               : RUGA_OK;
}

static void add_to_hash(ruga_scene* scene, const double* value, size_t count) {
    const unsigned char* byte = (const unsigned char*)value;
    for (size_t i = 0; i < count * sizeof *value; i++) {
        scene->hash = (scene->hash ^ byte[i]) * 0x100000001b3u;
    }
}

// Reads all samples once, so that what is wrong with one is found before any work; the first one last.
static ruga_status hash_samples(ruga_scene* scene, double* position) {
    const ruga_scene_parts* parts = scene->storage;
    ruga_follower* f = parts->follower;
    for (int k = f->cache.sample_count - 1; k >= 0; k--) {
        RUGA_TRY(read_sample(k, position, f));
        add_to_hash(scene, position, 3 * (size_t)f->vertex_count);
    }
    add_to_hash(scene, f->time, (size_t)f->cache.sample_count);
    return RUGA_OK;
}

static ruga_status set_times(const ruga_scene_follow* follow, ruga_follower* f) {
    RUGA_TRY(RUGA_NEW(f->time, f->cache.sample_count));
    for (int k = 0; k < f->cache.sample_count; k++) {
        double since = f->cache.time[k] - f->cache.time[0];
        f->time[k] = follow->start + (f->cache.time_is_real ? since : since / follow->rate);
    }
    return RUGA_OK;
}

ruga_status ruga_scene_follow_surface(const ruga_yaml_node* root, const char* directory, ruga_scene* scene) {
    ruga_scene_parts* parts = scene->storage;
    const ruga_yaml_node *node = ruga_yaml_find(root, "follow"), *file = ruga_yaml_find(node, "file");
    char* path;
    double* position = NULL;
    if (!parts->follow.file) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_scene_path(directory, parts->follow.file, &parts->pool, &path));
    RUGA_TRY(RUGA_NEW_ZERO(parts->follower, 1));
    ruga_follower* f = parts->follower;
    f->factor = parts->source.unit * parts->source.scale;
    RUGA_TRY(ruga_yaml_fail_at(ruga_point_cache_open(path, &f->cache), file, "follow.file"));
    RUGA_TRY(check_cache(node, scene, &f->cache));
    RUGA_TRY(set_times(&parts->follow, f));
    RUGA_TRY(map_vertices(scene, f));
    RUGA_TRY(RUGA_NEW(f->point, 3 * (size_t)f->cache.point_count));
    RUGA_TRY(RUGA_NEW(position, 3 * (size_t)f->vertex_count));
    ruga_status status = ruga_yaml_fail_at(hash_samples(scene, position), file, "follow.file");
    status = status == RUGA_OK ? warn_of_surface(scene, position) : status;
    ruga_release(position);
    scene->def.follow = (ruga_motion_def){.sample_count = f->cache.sample_count,
                                          .times = f->time,
                                          .read = read_sample,
                                          .context = f,
                                          .smoothness = parts->follow.smoothness};
    return status;
}
