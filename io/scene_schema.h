// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Every key that a scene may have: where it stands, what it holds, its default, its range and its meaning.
// The one table behind reading, refusing, `explain` and docs/scene.md.
#ifndef RUGA_IO_SCENE_SCHEMA_H
#define RUGA_IO_SCENE_SCHEMA_H

#include "crease/ridge.h"
#include "io/pool.h"
#include "mesh/make.h"
#include "ruga/types.h"

typedef enum ruga_key_kind {
    RUGA_KEY_SECTION,  // a map of further keys
    RUGA_KEY_ENTRIES,  // a list of maps; their keys stand under path.N
    RUGA_KEY_NUMBERS,  // `count` quantities, a list where more than one: double [count]
    RUGA_KEY_ROWS,     // `count` rows of three quantities: double [count][3]
    RUGA_KEY_STRETCH,  // three numbers: the diagonal of double [3][3]
    RUGA_KEY_SIZE,     // one to three lengths of a made shape: double [3]
    RUGA_KEY_INTEGERS, // `count` whole numbers: int [count]
    RUGA_KEY_SEED,     // a whole number: int64_t
    RUGA_KEY_FLAG,     // true or false: bool
    RUGA_KEY_CHOICE,   // one of `choices`: an enum or int, its index
    RUGA_KEY_TEXT,     // char*
    RUGA_KEY_TEXTS,    // a list of texts: ruga_names
    RUGA_KEY_UNIT,     // the name of a unit of length: double, m
    RUGA_KEY_AXES,     // true, or a list of x, y, z: bool [3]
    RUGA_KEY_VERTICES, // a list of vertex numbers: ruga_region
    RUGA_KEY_EVERY,    // true and nothing else, where the key alone says it all
    RUGA_KEY_PAIR,     // one quantity or a list of two: ruga_scene_pair
    RUGA_KEY_POINTS,   // a list of rows of `count` quantities: ruga_scene_points
    RUGA_KEY_VALUES,   // one quantity, a list of them, or the word in `choices`: ruga_scene_points
    RUGA_KEY_LATER,    // belongs to a later version
} ruga_key_kind;

typedef struct ruga_range {
    double low, high;
    bool low_open, high_open; // whether the bound itself is excluded
} ruga_range;

typedef struct ruga_names {
    int count;
    char** text;
} ruga_names;

// The mesh section.
typedef struct ruga_scene_source {
    char* file;
    ruga_make_def make;
    double unit, scale;
    ruga_names groups;
    double remesh_edge; // m; 0 = none
    int frame;          // of a FOLD file
} ruga_scene_source;

// The first and second value of an entry of skin.vary; count 0 = it does not set this one.
typedef struct ruga_scene_pair {
    int count;
    double value[2];
} ruga_scene_pair;

enum { RUGA_VARY_THICKNESS, RUGA_VARY_YOUNG, RUGA_VARY_GROWTH_U, RUGA_VARY_GROWTH_V, RUGA_VARY_VALUES };

// An entry of skin.vary.
typedef struct ruga_scene_vary {
    ruga_region region;
    bool has_gradient;
    double from[3], to[3];
    char *attribute, *texture; // or NULL
    ruga_scene_pair value[RUGA_VARY_VALUES];
} ruga_scene_vary;

// The follow section.
typedef struct ruga_scene_follow {
    char* file; // NULL = none
    double rate, start, smoothness;
} ruga_scene_follow;

// Rows of points, or values; `word` where the word stands in their place, count 0 = not given.
typedef struct ruga_scene_points {
    int count;
    double* value;
    bool word;
} ruga_scene_points;

// An entry of creases: before its curve is known, which may be many.
typedef struct ruga_scene_crease {
    char *fold, *svg, *group, *result; // result: that ridges are found in
    int frame;
    int result_frame, from; // -1 = the last; 0 = bending, 1 = stress
    ruga_ridge_def ridge;
    ruga_scene_points polyline, uv;
    ruga_region path; // its vertices
    bool closed, cut;
    ruga_crease_freedom freedom;
    double start; // s
    ruga_scene_points stiffness, rest;
    double length, scale; // length 0 = not given
    int key_count;
    ruga_crease_key* keys;
    double yield, rate, hardening;
} ruga_scene_crease;

typedef struct ruga_key {
    const char* path; // "skin.thickness", "handles.N.region.box"
    ruga_key_kind kind;
    int count;
    int offset; // bytes in ruga_scene_source, _scene_vary, _scene_crease, _crease_key, _handle_def,
                // _keyframe_def or _model_def; -1 = none
    const char* dimension; // "" where it is no quantity
    // In YAML. NULL: none, the key chooses or must be given. In parentheses: what its absence means, in
    // words. A section with a default of {} is always there, with the defaults of its keys.
    const char* fallback;
    ruga_range range;
    const char* choices; // "static|damped|!dynamic"; ! = not available yet
    const char* meaning;
} ruga_key;

#define RUGA_KEY_REQUIRED "(must be given)"

extern const ruga_key ruga_keys[];
extern const int ruga_key_count;

// Whether `key` stands directly in the section `parent` ("" = the scene itself).
bool ruga_key_is_child(const ruga_key* key, const char* parent);
const char* ruga_key_name(const ruga_key* key);
// The key `name` of a section; NULL where there is none.
const ruga_key* ruga_key_find(const char* parent, const char* name);
// "thickness, young": the keys of a section.
void ruga_key_list(const char* section, ruga_string* text);
// Sentence for a key that does not exist: the nearest one, here or elsewhere.
void ruga_key_suggest(const char* parent, const char* name, ruga_string* text);

// Choice number `index` in `choices` into name [32]; false behind the last. *later: not available yet.
bool ruga_choice(const char* choices, int index, char name[32], bool* later);
// "static, damped"
void ruga_choices_list(const char* choices, ruga_string* text);
// The available choice that is nearest to a misspelt one; false where none is near.
bool ruga_choice_nearest(const char* choices, const char* name, char nearest[32]);

// "above 0 and at most 0.1"
void ruga_range_text(const ruga_range* range, ruga_string* text);
bool ruga_range_has(const ruga_range* range, double value);

// docs/scene.md, and the example in it for a key at the top level; NULL where there is none.
const char* ruga_key_example(const ruga_key* key);
ruga_status ruga_scene_reference(ruga_string* text);

#endif
