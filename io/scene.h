// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Scene files (YAML, of which JSON is a subset) to a model def. docs/scene.md lists every key.
#ifndef RUGA_IO_SCENE_H
#define RUGA_IO_SCENE_H

#include "mesh/make.h"
#include "mesh/mesh.h"
#include "ruga/types.h"

typedef struct ruga_scene {
    ruga_model_def def; // its pointers point into this struct's own storage
    ruga_mesh mesh;     // the simulated rest mesh: read or made, scaled to metres, groups taken, remeshed
    double mesh_unit;   // metres per unit of the file, after unit and scale: to export in the file's unit
    char* mesh_name;    // for messages: the file, or "made pillow"
    char* text;         // the scene's own text, after --set, as stored in the result
    uint64_t hash;      // of the normalised content (all values with defaults), not of comments or spacing
    uint64_t mesh_hash;
    int warning_count;
    char** warning;
    void* storage; // private
} ruga_scene;

// `sets`: "key.path=value" strings of --set, applied before validation; a list index is a number:
// handles.0.press. RUGA_BAD_INPUT: "scene.yaml:12: skin.thickness: -2 mm is not above 0; ..." with the
// nearest valid key for an unknown one, the dimension expected for a wrong unit. RUGA_BAD_MESH where the
// doctor finds errors for this use.
ruga_status ruga_scene_read(const char* path, int set_count, const char* const* sets, ruga_scene* scene);
ruga_status ruga_scene_read_text(const char* text, const char* name, const char* directory, int set_count,
                                 const char* const* sets, ruga_scene* scene);
// The same of the text that a result keeps, but without the mesh, whose file may be gone: def has none, and a
// skin that varies has no values at vertices.
ruga_status ruga_scene_read_settings(const char* text, const char* name, ruga_scene* scene);
void ruga_scene_clear(ruga_scene* scene);

// What ruga_model_create refused begins with a key of the scene, such as "handles.1: ...": the same sentence
// with file and line before it, where the key is given. Returns `status`.
ruga_status ruga_scene_place_error(const ruga_scene* scene, ruga_status status);

// Every key with its value (in SI) and whether it was given or is the default, in the scene's order.
typedef void ruga_scene_visit(const char* key, const char* value, const char* unit, bool given,
                              void* context);
void ruga_scene_each(const ruga_scene* scene, ruga_scene_visit* visit, void* context);

// A quantity such as "0.4 mm", "40 MPa" or "5" in SI. dimension: "m", "Pa", "s", "kg/m^3", "rad", "1", ...
// RUGA_BAD_INPUT with a sentence.
ruga_status ruga_quantity_parse(const char* text, const char* dimension, double* value);

#endif
