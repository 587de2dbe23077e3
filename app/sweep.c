// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// From words such as skin.young=[10 MPa, 40 MPa] to the points of a grid.
#include "app/sweep.h"

#include "core/memory.h"
#include "io/scene.h"
#include "io/scene_schema.h"
#include "io/yaml.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS_MAX = 10000, KEY_LENGTH = 160 };

// ---- values --------------------------------------------------------------------------------------------

// The schema's key for a path of --set: list indices are N there. NULL where there is none.
static const ruga_key* find_key(const char* path) {
    char generic[KEY_LENGTH] = "";
    for (const char* part = path; *part;) {
        size_t length = strcspn(part, "."), used = strlen(generic);
        bool number = length > 0 && strspn(part, "0123456789") == length;
        (void)snprintf(generic + used, sizeof generic - used, "%s%.*s", used ? "." : "",
                       number ? 1 : (int)length, number ? "N" : part);
        part += length + (part[length] == '.');
    }
    for (int i = 0; i < ruga_key_count; i++) {
        if (strcmp(ruga_keys[i].path, generic) == 0) {
            return &ruga_keys[i];
        }
    }
    return NULL;
}

// How many lists are inside one another in one value of the key.
static int own_depth(const ruga_key* key) {
    if (!key) {
        return 0;
    }
    switch (key->kind) {
    case RUGA_KEY_ROWS:
        return 2;
    case RUGA_KEY_NUMBERS:
    case RUGA_KEY_INTEGERS:
        return key->count > 1;
    case RUGA_KEY_ENTRIES:
    case RUGA_KEY_STRETCH:
    case RUGA_KEY_SIZE:
    case RUGA_KEY_TEXTS:
    case RUGA_KEY_AXES:
    case RUGA_KEY_VERTICES:
        return 1;
    default:
        return 0;
    }
}

static int depth_of(const ruga_yaml_node* node) {
    return node->kind != RUGA_YAML_LIST ? 0 : 1 + (node->first ? depth_of(node->first) : 0);
}

// In one line, as people write values.
static void write_flow(const ruga_yaml_node* node, ruga_string* text) {
    bool map = node->kind == RUGA_YAML_MAP;
    if (node->kind == RUGA_YAML_SCALAR && node->plain) {
        ruga_string_add(text, "%s", node->text);
        return;
    }
    if (node->kind == RUGA_YAML_SCALAR) {
        ruga_string_add(text, "\"");
        for (const char* c = node->text; *c; c++) {
            ruga_string_add(text, *c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
        }
        ruga_string_add(text, "\"");
        return;
    }
    ruga_string_add(text, "%s", map ? "{" : "[");
    for (const ruga_yaml_node* child = node->first; child; child = child->next) {
        ruga_string_add(text, "%s%s%s", child == node->first ? "" : ", ", map ? child->key : "",
                        map ? ": " : "");
        write_flow(child, text);
    }
    ruga_string_add(text, "%s", map ? "}" : "]");
}

static ruga_status keep_value(ruga_sweep* sweep, ruga_sweep_axis* axis, const ruga_yaml_node* node) {
    ruga_string text = {0};
    write_flow(node, &text);
    ruga_status status = ruga_string_status(&text);
    if (status == RUGA_OK) {
        status = ruga_pool_copy(&sweep->pool, text.data, (size_t)text.length, &axis->text[axis->count++]);
    }
    ruga_string_clear(&text);
    return status;
}

static ruga_status read_axis(ruga_sweep* sweep, const char* assignment, ruga_sweep_axis* axis, bool* swept) {
    const char* equals = strchr(assignment, '=');
    ruga_yaml_node* node;
    char name[KEY_LENGTH];
    if (!equals || equals == assignment || !equals[1]) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "--set %.80s: write key=[a, b] or key=value, such as skin.young=\"[10 MPa, 40 "
                         "MPa]\"",
                         assignment);
    }
    RUGA_TRY(ruga_pool_copy(&sweep->pool, assignment, (size_t)(equals - assignment), &axis->key));
    (void)snprintf(name, sizeof name, "--set %.150s", axis->key);
    RUGA_TRY(ruga_yaml_read(equals + 1, strlen(equals + 1), name, false, &sweep->pool, &node));
    *swept = depth_of(node) > own_depth(find_key(axis->key));
    if (*swept && node->count == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "--set %s: the list has no entries", axis->key);
    }
    RUGA_TRY(RUGA_POOL_TAKE(&sweep->pool, axis->text, *swept ? node->count : 1));
    if (!*swept) {
        return keep_value(sweep, axis, node);
    }
    for (const ruga_yaml_node* item = node->first; item; item = item->next) {
        RUGA_TRY(keep_value(sweep, axis, item));
    }
    return RUGA_OK;
}

static ruga_status read_axes(ruga_sweep* sweep, int count, const char* const* sets) {
    bool any = false;
    long points = 1;
    RUGA_TRY(RUGA_POOL_TAKE(&sweep->pool, sweep->axes, count + 1));
    for (int i = 0; i < count; i++) {
        ruga_sweep_axis* axis = &sweep->axes[sweep->axis_count++];
        bool swept = false;
        RUGA_TRY(read_axis(sweep, sets[i], axis, &swept));
        for (int k = 0; k < i; k++) {
            if (strcmp(sweep->axes[k].key, axis->key) == 0) {
                return ruga_fail(RUGA_BAD_INPUT, "--set %s is given twice", axis->key);
            }
        }
        any = any || swept;
        points *= axis->count;
        if (points > POINTS_MAX) {
            return ruga_fail(RUGA_BAD_INPUT, "the lists make more than %d points", POINTS_MAX);
        }
    }
    if (!any) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "sweep: no --set gives a list: --set skin.young=\"[10 MPa, 40 MPa]\"");
    }
    sweep->point_count = (int)points;
    return RUGA_OK;
}

// ---- points --------------------------------------------------------------------------------------------

// Looks for the value of one key among all of a scene's.
typedef struct search {
    const char* key;
    const char* given;
    json_t* value;
    bool is_number;
} search;

static json_t* number_or_text(const char* text, bool* is_number) {
    char* end;
    double number = strtod(text, &end);
    *is_number = end != text && !*end;
    return *is_number ? json_real(number) : json_string(text);
}

static void visit_key(const char* key, const char* value, const char* unit, bool given, void* context) {
    search* s = context;
    (void)unit;
    (void)given;
    if (!s->value && strcmp(key, s->key) == 0) {
        s->value = number_or_text(value, &s->is_number);
    }
}

static void fill_row(ruga_sweep* sweep, ruga_sweep_point* point, int number, const ruga_scene* scene) {
    (void)json_object_set_new(point->row, "point", json_integer(number));
    for (int i = 0; i < sweep->axis_count; i++) {
        search s = {.key = sweep->axes[i].key, .given = point->sets[i] + strlen(sweep->axes[i].key) + 1};
        bool plain;
        ruga_scene_each(scene, visit_key, &s);
        if (!s.value) {
            s.value = number_or_text(s.given, &s.is_number);
        }
        json_decref(number_or_text(s.given, &plain));
        sweep->axes[i].has_given = sweep->axes[i].has_given || (s.is_number && !plain);
        (void)json_object_set_new(point->row, sweep->axes[i].key, s.value);
    }
}

// Once the scenes are read, it is known which keys have values with units.
static void add_given_columns(const ruga_sweep* sweep) {
    char name[KEY_LENGTH + 8];
    for (int p = 0; p < sweep->point_count; p++) {
        for (int i = 0; i < sweep->axis_count; i++) {
            const ruga_sweep_axis* axis = &sweep->axes[i];
            if (axis->has_given) {
                (void)snprintf(name, sizeof name, "%.150s_given", axis->key);
                (void)json_object_set_new(sweep->points[p].row, name,
                                          json_string(sweep->points[p].sets[i] + strlen(axis->key) + 1));
            }
        }
    }
}

static ruga_status choose_values(ruga_sweep* sweep, ruga_sweep_point* point, int number) {
    RUGA_TRY(RUGA_POOL_TAKE(&sweep->pool, point->sets, sweep->axis_count));
    for (int i = sweep->axis_count - 1, rest = number; i >= 0; rest /= sweep->axes[i].count, i--) {
        const ruga_sweep_axis* axis = &sweep->axes[i];
        const char* text = axis->text[rest % axis->count];
        size_t size = strlen(axis->key) + strlen(text) + 2;
        RUGA_TRY(RUGA_POOL_TAKE(&sweep->pool, point->sets[i], size));
        (void)snprintf(point->sets[i], size, "%s=%s", axis->key, text);
    }
    return RUGA_OK;
}

static ruga_status name_files(ruga_sweep* sweep, ruga_sweep_point* point) {
    size_t size = strlen(sweep->directory) + 64;
    RUGA_TRY(RUGA_POOL_TAKE(&sweep->pool, point->result, size));
    RUGA_TRY(RUGA_POOL_TAKE(&sweep->pool, point->log, size));
    (void)snprintf(point->result, size, "%s/points/%016llx.h5", sweep->directory,
                   (unsigned long long)point->scene_hash);
    (void)snprintf(point->log, size, "%s/points/%016llx.log", sweep->directory,
                   (unsigned long long)point->scene_hash);
    point->file = point->result + strlen(sweep->directory) + 1;
    return RUGA_OK;
}

static ruga_status read_point(ruga_sweep* sweep, int number) {
    ruga_sweep_point* point = &sweep->points[number];
    ruga_scene scene;
    point->exit_status = -1;
    point->row = json_object();
    RUGA_TRY(choose_values(sweep, point, number));
    RUGA_TRY(ruga_scene_read(sweep->scene, sweep->axis_count, (const char* const*)point->sets, &scene));
    point->scene_hash = scene.hash;
    point->mesh_hash = scene.mesh_hash;
    point->frames = scene.def.frames;
    fill_row(sweep, point, number, &scene);
    ruga_scene_clear(&scene);
    for (int k = 0; k < number; k++) {
        if (sweep->points[k].scene_hash == point->scene_hash) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "sweep: points %d and %d are the same scene: a value stands twice in a list", k,
                             number);
        }
    }
    return name_files(sweep, point);
}

ruga_status ruga_sweep_read(const char* scene, const char* directory, int set_count, const char* const* sets,
                            ruga_sweep* sweep) {
    ruga_status status = RUGA_OK;
    *sweep = (ruga_sweep){.scene = scene, .directory = directory};
    RUGA_TRY_DONE(read_axes(sweep, set_count, sets));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(sweep->points, sweep->point_count));
    for (int k = 0; k < sweep->point_count; k++) {
        RUGA_TRY_DONE(read_point(sweep, k));
    }
    add_given_columns(sweep);
done:
    if (status != RUGA_OK) {
        ruga_sweep_clear(sweep);
    }
    return status;
}

void ruga_sweep_clear(ruga_sweep* sweep) {
    for (int k = 0; k < sweep->point_count && sweep->points; k++) {
        json_decref(sweep->points[k].row);
    }
    ruga_release(sweep->points);
    ruga_pool_clear(&sweep->pool);
    *sweep = (ruga_sweep){0};
}

void ruga_sweep_point_name(const ruga_sweep* sweep, const ruga_sweep_point* point, char* name, size_t size) {
    size_t used = 0;
    name[0] = '\0';
    for (int i = 0; i < sweep->axis_count && used + 1 < size; i++) {
        if (sweep->axes[i].count > 1) {
            (void)snprintf(name + used, size - used, "%s%s", used ? ", " : "", point->sets[i]);
            used = strlen(name);
        }
    }
}
