// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Scene file -> tree -> --set -> keys -> rules -> mesh. The hash is FNV-1a over key and value of everything
// that ruga_scene_each shows, in the order of the table of keys, each ended by a zero byte: what the scene
// says, not how it is written. time.frames is left out, so that a longer run may resume a shorter one.
#define _POSIX_C_SOURCE 200809L

#include "io/scene.h"

#include "core/memory.h"
#include "io/scene_read.h"

#include <errno.h>
#include <locale.h>
#include <stdio.h>
#include <string.h>

static uint64_t hash_bytes(uint64_t hash, const char* bytes, size_t length) {
    for (size_t i = 0; i < length; i++) {
        hash = (hash ^ (unsigned char)bytes[i]) * 0x100000001b3u;
    }
    return hash;
}

static uint64_t hash_values(const ruga_scene_parts* parts) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (const ruga_scene_value* v = parts->first_value; v; v = v->next) {
        // skin.vary, follow and creases themselves stand there only where they have no keys of their own.
        if (strcmp(v->key, "time.frames") != 0 && strcmp(v->key, "skin.vary") != 0 &&
            strcmp(v->key, "follow") != 0 && strcmp(v->key, "creases") != 0) {
            hash = hash_bytes(hash, v->key, strlen(v->key) + 1);
            hash = hash_bytes(hash, v->value, strlen(v->value) + 1);
        }
    }
    return hash;
}

// What attributes and textures hold is not in the keys: a skin that varies is hashed by its values.
static uint64_t hash_arrays(uint64_t hash, const ruga_skin_def* skin) {
    const double* const arrays[] = {skin->vertex_thickness, skin->vertex_young, skin->vertex_growth};
    for (int i = 0; i < 3; i++) {
        if (arrays[i]) {
            size_t size = (size_t)skin->vertex_count * (i == 2 ? 2 : 1) * sizeof(double);
            hash = hash_bytes(hash, (const char*)arrays[i], size);
        }
    }
    return hash;
}

// Nor is what patterns hold: creases are hashed by their points and angles.
static uint64_t hash_creases(uint64_t hash, const ruga_model_def* def) {
    for (int i = 0; i < def->crease_count; i++) {
        const ruga_crease_def* crease = &def->creases[i];
        size_t width = crease->path == RUGA_CREASE_UV ? 2 : 3;
        hash = hash_bytes(hash, (const char*)crease->points,
                          width * (size_t)crease->point_count * sizeof(double));
        hash = hash_bytes(hash, (const char*)&crease->rest, sizeof crease->rest);
        hash = hash_bytes(hash, (const char*)&crease->kind, sizeof crease->kind);
    }
    return hash;
}

static ruga_status keep_text(const ruga_yaml_node* root, ruga_scene_parts* parts, char** kept) {
    ruga_string text = {0};
    ruga_status status = ruga_yaml_write(root, &text);
    if (status == RUGA_OK) {
        status = ruga_pool_copy(&parts->pool, text.data ? text.data : "", (size_t)text.length, kept);
    }
    ruga_string_clear(&text);
    return status;
}

// Without a directory, no mesh.
static ruga_status build(ruga_yaml_node* root, ruga_pool* tree, const char* directory, int set_count,
                         const char* const* sets, ruga_scene* scene) {
    ruga_scene_parts* parts = scene->storage;
    for (int i = 0; i < set_count; i++) {
        RUGA_TRY(ruga_yaml_set(root, sets[i], tree));
    }
    scene->def = ruga_default_model_def();
    parts->source = (ruga_scene_source){.unit = 1, .scale = 1};
    RUGA_TRY(ruga_scene_read_keys(root, parts, &scene->def));
    RUGA_TRY(ruga_scene_check_keys(root, parts, &scene->def));
    RUGA_TRY(keep_text(root, parts, &scene->text));
    scene->hash = hash_values(parts);
    if (!directory) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_scene_load_mesh(root, directory, scene));
    RUGA_TRY(ruga_scene_vary_skin(root, directory, scene));
    RUGA_TRY(ruga_scene_load_creases(root, directory, scene));
    scene->hash = hash_creases(hash_arrays(scene->hash, &scene->def.skin), &scene->def);
    RUGA_TRY(ruga_scene_follow_surface(root, directory, scene));
    scene->mesh_hash = ruga_mesh_hash(&scene->mesh);
    scene->def.mesh = ruga_mesh_as_def(&scene->mesh);
    return RUGA_OK;
}

static ruga_status read_text(const char* text, size_t length, const char* name, const char* directory,
                             int set_count, const char* const* sets, ruga_scene* scene) {
    ruga_pool tree = {0};
    ruga_yaml_node* root = NULL;
    ruga_scene_parts* parts = NULL;
    ruga_status status = RUGA_OK;
    *scene = (ruga_scene){0};
    // Numbers are written with a point, whatever the program's locale.
    locale_t decimal_point = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (decimal_point == (locale_t)0) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: a locale");
    }
    locale_t before = uselocale(decimal_point);
    RUGA_TRY_DONE(RUGA_NEW_ZERO(parts, 1));
    scene->storage = parts;
    RUGA_TRY_DONE(ruga_yaml_read(text, length, name, true, &tree, &root));
    RUGA_TRY_DONE(build(root, &tree, directory, set_count, sets, scene));
done:
    (void)uselocale(before);
    freelocale(decimal_point);
    ruga_pool_clear(&tree);
    if (status != RUGA_OK) {
        ruga_scene_clear(scene);
    }
    return status;
}

ruga_status ruga_scene_read_text(const char* text, const char* name, const char* directory, int set_count,
                                 const char* const* sets, ruga_scene* scene) {
    return read_text(text, strlen(text), name, directory, set_count, sets, scene);
}

ruga_status ruga_scene_read_settings(const char* text, const char* name, ruga_scene* scene) {
    return read_text(text, strlen(text), name, NULL, 0, NULL, scene);
}

// The whole file; one byte more than is allowed is enough to know that there is too much.
static ruga_status read_bytes(const char* path, char** bytes, size_t* length) {
    *bytes = NULL;
    *length = 0;
    FILE* file = fopen(path, "rb");
    if (!file) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the scene cannot be opened: %s", path, strerror(errno));
    }
    ruga_status status = RUGA_OK;
    int capacity = 0;
    for (size_t got = 1; got > 0 && *length <= RUGA_YAML_MAX_BYTES; *length += got) {
        RUGA_TRY_DONE(RUGA_RESERVE(*bytes, capacity, *length + (1 << 14)));
        got = fread(*bytes + *length, 1, (size_t)capacity - *length, file);
    }
    if (ferror(file)) {
        status = ruga_fail(RUGA_BAD_INPUT, "%s: the scene cannot be read: %s", path, strerror(errno));
    }
done:
    (void)fclose(file);
    return status;
}

ruga_status ruga_scene_read(const char* path, int set_count, const char* const* sets, ruga_scene* scene) {
    *scene = (ruga_scene){0};
    char *bytes = NULL, *directory = NULL;
    size_t length;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(read_bytes(path, &bytes, &length));
    const char* slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash - path) + (slash == path) : 0;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(directory, folder + 1));
    memcpy(directory, path, folder);
    status = read_text(bytes, length, path, directory, set_count, sets, scene);
done:
    ruga_release(bytes);
    ruga_release(directory);
    return status;
}

void ruga_scene_clear(ruga_scene* scene) {
    ruga_scene_parts* parts = scene->storage;
    if (parts) {
        ruga_scene_follow_clear(parts);
        ruga_pool_clear(&parts->pool);
    }
    ruga_release(parts);
    ruga_release(scene->warning);
    ruga_mesh_clear(&scene->mesh);
    *scene = (ruga_scene){0};
}

void ruga_scene_each(const ruga_scene* scene, ruga_scene_visit* visit, void* context) {
    const ruga_scene_parts* parts = scene->storage;
    for (const ruga_scene_value* v = parts ? parts->first_value : NULL; v; v = v->next) {
        visit(v->key, v->value, v->unit, v->given, context);
    }
}

ruga_status ruga_scene_place_error(const ruga_scene* scene, ruga_status status) {
    const ruga_scene_parts* parts = scene->storage;
    const char* sentence = ruga_last_error();
    size_t length = strspn(sentence, "abcdefghijklmnopqrstuvwxyz_.0123456789");
    if ((status != RUGA_BAD_INPUT && status != RUGA_BAD_MESH) || length == 0) {
        return status;
    }
    for (const ruga_scene_value* v = parts ? parts->first_value : NULL; v; v = v->next) {
        bool named =
            strncmp(v->key, sentence, length) == 0 && (v->key[length] == '\0' || v->key[length] == '.');
        if (named && v->given) {
            return v->line > 0 ? ruga_fail_prefix(status, "%s:%d", v->origin, v->line)
                               : ruga_fail_prefix(status, "%.200s", v->origin);
        }
    }
    return status;
}
