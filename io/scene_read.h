// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The steps from a tree of YAML to a scene. Each step leaves a sentence with file, line and key.
#ifndef RUGA_IO_SCENE_READ_H
#define RUGA_IO_SCENE_READ_H

#include "crease/pattern.h"
#include "io/scene.h"
#include "io/scene_schema.h"
#include "io/yaml.h"

typedef struct ruga_scene_value {
    const char *key, *value, *unit;
    bool given;
    const char* origin; // where it is given, as in a node of YAML
    int line;
    struct ruga_scene_value* next;
} ruga_scene_value;

// What ruga_scene.storage points to.
typedef struct ruga_scene_parts {
    ruga_pool pool; // strings and arrays of the def
    ruga_scene_source source;
    int vary_count;
    ruga_scene_vary* vary;
    ruga_scene_follow follow;
    int file_vertices;              // of the mesh as it was read
    ruga_mesh before_remesh;        // where the scene follows a surface: empty without remeshing
    struct ruga_follower* follower; // io/scene_follow.c
    int crease_count;
    ruga_scene_crease* crease;
    ruga_scene_value *first_value, *last_value;
    int warning_capacity;
} ruga_scene_parts;

// Every key by itself: kind, dimension, range, default. Fills def (without its mesh), source, vary and
// values.
ruga_status ruga_scene_read_keys(const ruga_yaml_node* root, ruga_scene_parts* parts, ruga_model_def* def);

// What keys demand of one another; sets the kinds of handles and regions.
ruga_status ruga_scene_check_keys(const ruga_yaml_node* root, ruga_scene_parts* parts, ruga_model_def* def);

// Reads or makes the mesh, scales, takes groups, remeshes, asks the doctor; then regions against that mesh.
ruga_status ruga_scene_load_mesh(const ruga_yaml_node* root, const char* directory, ruga_scene* scene);

// The arrays of a skin that varies, on the mesh as it is simulated.
ruga_status ruga_scene_vary_skin(const ruga_yaml_node* root, const char* directory, ruga_scene* scene);

// The moving surface that the interior follows, checked against the mesh; its content goes into the scene's
// hash.
ruga_status ruga_scene_follow_surface(const ruga_yaml_node* root, const char* directory, ruga_scene* scene);
void ruga_scene_follow_clear(ruga_scene_parts* parts);
// The creases of the def, on the mesh as it is simulated: all those of a pattern, with their assigned angles.
ruga_status ruga_scene_load_creases(const ruga_yaml_node* root, const char* directory, ruga_scene* scene);
// Whether a file is a crease pattern, by its name; and the pattern, as it is in the file.
bool ruga_scene_is_pattern(const char* name);
ruga_status ruga_scene_read_pattern(const char* path, int frame, ruga_crease_pattern* pattern);

// Vertices that a region lists by their number in the file become those of the mesh.
ruga_status ruga_scene_map_vertices(const ruga_yaml_node* node, const char* shown, const ruga_mesh* mesh,
                                    ruga_region* region);
// A file that the scene names, from the scene's folder.
ruga_status ruga_scene_path(const char* directory, const char* name, ruga_pool* pool, char** path);

// Adds to scene->warning.
ruga_status ruga_scene_warn(ruga_scene* scene, const char* format, ...) __attribute__((format(printf, 2, 3)));

#endif
