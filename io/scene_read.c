// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The tree of a scene against the table of keys: a walk over the table, not over the tree, so that every key
// has a value in the end and the order in the file does not matter.
#include "io/scene_read.h"

#include "io/units.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PATH_LENGTH = 160, MAX_NUMBERS = 9 };

// Choices are stored through int.
static_assert(sizeof(ruga_shape) == sizeof(int) && sizeof(ruga_hold) == sizeof(int) &&
                  sizeof(ruga_membrane) == sizeof(int) && sizeof(ruga_interior_motion) == sizeof(int),
              "an enum is stored as an int");

typedef struct reader {
    ruga_scene_parts* parts;
    ruga_model_def* def;
    const ruga_yaml_node* root;
} reader;

// One key of the scene at hand.
typedef struct place {
    const ruga_key* key;
    const char* shown; // its path with the numbers of list entries
    const ruga_yaml_node* node;
    char* target; // the struct that key->offset counts in
} place;

static ruga_status fail_kind(const place* p, const ruga_yaml_node* node, const char* needed) {
    char found[64];
    ruga_yaml_describe(node, found);
    return ruga_yaml_fail(node, p->shown, "%s is needed, not %s", needed, found);
}

static bool is_empty(const ruga_yaml_node* node) {
    return node->kind == RUGA_YAML_SCALAR && node->plain &&
           (node->text[0] == '\0' || strcmp(node->text, "~") == 0 || strcmp(node->text, "null") == 0);
}

// node: where the value is given; NULL for a default.
static ruga_status record(reader* r, const ruga_yaml_node* node, const char* key, const char* value,
                          const char* unit) {
    ruga_scene_value* entry;
    ruga_pool* pool = &r->parts->pool;
    RUGA_TRY(RUGA_POOL_TAKE(pool, entry, 1));
    char *key_copy, *value_copy, *origin = NULL;
    RUGA_TRY(ruga_pool_copy(pool, key, strlen(key), &key_copy));
    RUGA_TRY(ruga_pool_copy(pool, value, strlen(value), &value_copy));
    if (node) {
        RUGA_TRY(ruga_pool_copy(pool, node->origin, strlen(node->origin), &origin));
    }
    *entry = (ruga_scene_value){.key = key_copy,
                                .value = value_copy,
                                .unit = strcmp(unit, "1") == 0 ? "" : unit,
                                .given = node != NULL,
                                .origin = origin,
                                .line = node ? node->line : 0};
    if (r->parts->last_value) {
        r->parts->last_value->next = entry;
    } else {
        r->parts->first_value = entry;
    }
    r->parts->last_value = entry;
    return RUGA_OK;
}

static void add_number(ruga_string* value, double number, bool first) {
    ruga_string_add(value, first ? "" : ", ");
    ruga_string_add_number(value, number);
}

// One scalar as a quantity within the key's range. item >= 0: its place in a list, for the sentence.
static ruga_status read_number(const place* p, const ruga_yaml_node* node, const char* dimension, int item,
                               double* value) {
    char shown[PATH_LENGTH + 16];
    (void)snprintf(shown, sizeof shown, item < 0 ? "%s" : "%s.%d", p->shown, item);
    if (node->kind != RUGA_YAML_SCALAR) {
        return fail_kind(p, node, item < 0 ? "one number" : "a number");
    }
    const char* text = node->text;
    RUGA_TRY(ruga_yaml_fail_at(ruga_quantity_parse(text, dimension, value), node, shown));
    if (!ruga_range_has(&p->key->range, *value)) {
        ruga_string range = {0};
        ruga_range_text(&p->key->range, &range);
        ruga_status status = ruga_string_status(&range);
        if (status == RUGA_OK) {
            status = ruga_yaml_fail(node, shown, "%.60s is not %s", text, range.data);
        }
        ruga_string_clear(&range);
        return status;
    }
    return RUGA_OK;
}

// `count` items of a list, or one scalar where count is 1.
static ruga_status read_row(const place* p, const ruga_yaml_node* node, int count, double* numbers,
                            ruga_string* value) {
    if (count == 1) {
        RUGA_TRY(read_number(p, node, p->key->dimension, -1, numbers));
        ruga_string_add_number(value, numbers[0]);
        return RUGA_OK;
    }
    char needed[64];
    (void)snprintf(needed, sizeof needed, "a list of %d numbers", count);
    if (node->kind != RUGA_YAML_LIST) {
        return fail_kind(p, node, needed);
    }
    if (node->count != count) {
        return ruga_yaml_fail(node, p->shown, "%s is needed, not of %d", needed, node->count);
    }
    ruga_string_add(value, "[");
    const ruga_yaml_node* item = node->first;
    for (int i = 0; i < count; i++, item = item->next) {
        RUGA_TRY(read_number(p, item, p->key->dimension, i, &numbers[i]));
        add_number(value, numbers[i], i == 0);
    }
    ruga_string_add(value, "]");
    return RUGA_OK;
}

static ruga_status read_numbers(const place* p, ruga_string* value) {
    double numbers[MAX_NUMBERS];
    RUGA_TRY(read_row(p, p->node, p->key->count, numbers, value));
    memcpy(p->target + p->key->offset, numbers, sizeof(double) * (size_t)p->key->count);
    return RUGA_OK;
}

static ruga_status read_stretch(const place* p, ruga_string* value) {
    double s[MAX_NUMBERS];
    RUGA_TRY(read_row(p, p->node, 3, s, value));
    const double matrix[9] = {s[0], 0, 0, 0, s[1], 0, 0, 0, s[2]};
    memcpy(p->target + p->key->offset, matrix, sizeof matrix);
    return RUGA_OK;
}

static ruga_status read_rows(const place* p, ruga_string* value) {
    double rows[MAX_NUMBERS];
    char needed[64];
    (void)snprintf(needed, sizeof needed, "a list of %d lists of 3 numbers", p->key->count);
    if (p->node->kind != RUGA_YAML_LIST || p->node->count != p->key->count) {
        return fail_kind(p, p->node, needed);
    }
    ruga_string_add(value, "[");
    const ruga_yaml_node* row = p->node->first;
    for (int i = 0; i < p->key->count; i++, row = row->next) {
        ruga_string_add(value, i == 0 ? "" : ", ");
        RUGA_TRY(read_row(p, row, 3, &rows[3 * i], value));
    }
    ruga_string_add(value, "]");
    memcpy(p->target + p->key->offset, rows, sizeof(double) * 3 * (size_t)p->key->count);
    return RUGA_OK;
}

// The third number of a skirt is its angle.
static ruga_status read_size(reader* r, const place* p, ruga_string* value) {
    double size[3] = {0};
    bool list = p->node->kind == RUGA_YAML_LIST;
    if (p->node->kind == RUGA_YAML_MAP || (list && (p->node->count < 1 || p->node->count > 3))) {
        return fail_kind(p, p->node, "a length or a list of one to three");
    }
    const ruga_yaml_node* item = list ? p->node->first : p->node;
    ruga_string_add(value, "[");
    for (int i = 0; item && i < 3; i++, item = list ? item->next : NULL) {
        bool angle = i == 2 && r->parts->source.make.shape == RUGA_SHAPE_SKIRT;
        RUGA_TRY(read_number(p, item, angle ? "rad" : "m", list ? i : -1, &size[i]));
        if (!(size[i] > 0)) {
            return ruga_yaml_fail(item, p->shown, "%.60s is not above 0", item->text);
        }
        add_number(value, size[i], i == 0);
    }
    ruga_string_add(value, "]");
    memcpy(p->target + p->key->offset, size, sizeof size);
    return RUGA_OK;
}

// A whole number that a double holds exactly.
static ruga_status read_whole(const place* p, const ruga_yaml_node* node, double* whole) {
    if (node->kind != RUGA_YAML_SCALAR) {
        return fail_kind(p, node, "a whole number");
    }
    RUGA_TRY(ruga_yaml_fail_at(ruga_number_parse(node->text, whole), node, p->shown));
    if (*whole != floor(*whole) || fabs(*whole) > 9007199254740992.0) {
        return ruga_yaml_fail(node, p->shown, "%.60s is not a whole number within 9e15", node->text);
    }
    const ruga_range* range = &p->key->range;
    if (range->low == range->high && *whole != range->low) {
        return ruga_yaml_fail(node, p->shown, "%.60s is not %.0f, which is all that this version knows",
                              node->text, range->low);
    }
    if (!ruga_range_has(range, *whole)) {
        return ruga_yaml_fail(node, p->shown, "%.60s is not between %.0f and %.0f", node->text, range->low,
                              range->high);
    }
    return RUGA_OK;
}

static ruga_status read_integers(const place* p, ruga_string* value) {
    int whole[2] = {0};
    bool list = p->key->count > 1;
    if (list && (p->node->kind != RUGA_YAML_LIST || p->node->count != p->key->count)) {
        return fail_kind(p, p->node, "a list of two whole numbers");
    }
    const ruga_yaml_node* item = list ? p->node->first : p->node;
    ruga_string_add(value, list ? "[" : "");
    for (int i = 0; i < p->key->count; i++, item = item->next) {
        double number;
        RUGA_TRY(read_whole(p, item, &number));
        whole[i] = (int)number;
        ruga_string_add(value, "%s%d", i == 0 ? "" : ", ", whole[i]);
    }
    ruga_string_add(value, list ? "]" : "");
    if (p->key->offset >= 0) {
        memcpy(p->target + p->key->offset, whole, sizeof(int) * (size_t)p->key->count);
    }
    return RUGA_OK;
}

static ruga_status read_seed(const place* p, ruga_string* value) {
    double number;
    RUGA_TRY(read_whole(p, p->node, &number));
    int64_t seed = (int64_t)number;
    ruga_string_add(value, "%lld", (long long)seed);
    memcpy(p->target + p->key->offset, &seed, sizeof seed);
    return RUGA_OK;
}

static ruga_status read_flag(const place* p, ruga_string* value) {
    const ruga_yaml_node* node = p->node;
    bool scalar = node->kind == RUGA_YAML_SCALAR;
    bool yes = scalar && strcmp(node->text, "true") == 0;
    if (!yes && !(scalar && strcmp(node->text, "false") == 0)) {
        return fail_kind(p, node, "true or false");
    }
    ruga_string_add(value, yes ? "true" : "false");
    memcpy(p->target + p->key->offset, &yes, sizeof yes);
    return RUGA_OK;
}

static ruga_status fail_choice(const place* p, bool later) {
    const char* text = p->node->text;
    if (later) {
        return ruga_yaml_fail(p->node, p->shown, "'%s' is not available yet in this version of Ruga", text);
    }
    ruga_string list = {0};
    ruga_choices_list(p->key->choices, &list);
    ruga_status status = ruga_string_status(&list);
    char nearest[32];
    if (status == RUGA_OK && ruga_choice_nearest(p->key->choices, text, nearest)) {
        status = ruga_yaml_fail(p->node, p->shown, "'%.40s' is none of: %s; did you mean %s?", text,
                                list.data, nearest);
    } else if (status == RUGA_OK) {
        status = ruga_yaml_fail(p->node, p->shown, "'%.40s' is none of: %s", text, list.data);
    }
    ruga_string_clear(&list);
    return status;
}

static ruga_status read_choice(const place* p, ruga_string* value) {
    if (p->node->kind != RUGA_YAML_SCALAR) {
        return fail_kind(p, p->node, "a word");
    }
    char name[32];
    bool later = false;
    for (int i = 0; ruga_choice(p->key->choices, i, name, &later); i++) {
        if (strcmp(name, p->node->text) != 0) {
            continue;
        }
        if (later) {
            return fail_choice(p, true);
        }
        ruga_string_add(value, "%s", name);
        if (p->key->offset >= 0) {
            memcpy(p->target + p->key->offset, &i, sizeof i);
        }
        return RUGA_OK;
    }
    return fail_choice(p, false);
}

static ruga_status read_text(reader* r, const place* p, const ruga_yaml_node* node, char** copy) {
    if (node->kind != RUGA_YAML_SCALAR || node->text[0] == '\0') {
        return fail_kind(p, node, "a text");
    }
    return ruga_pool_copy(&r->parts->pool, node->text, strlen(node->text), copy);
}

static ruga_status read_one_text(reader* r, const place* p, ruga_string* value) {
    char* copy;
    RUGA_TRY(read_text(r, p, p->node, &copy));
    memcpy(p->target + p->key->offset, &copy, sizeof copy);
    ruga_string_add(value, "%s", copy);
    return RUGA_OK;
}

static ruga_status read_texts(reader* r, const place* p, ruga_string* value) {
    if (p->node->kind != RUGA_YAML_LIST || p->node->count == 0) {
        return fail_kind(p, p->node, "a list of names, such as [seat],");
    }
    ruga_names list = {.count = p->node->count};
    RUGA_TRY(RUGA_POOL_TAKE(&r->parts->pool, list.text, list.count));
    ruga_string_add(value, "[");
    const ruga_yaml_node* item = p->node->first;
    for (int i = 0; i < list.count; i++, item = item->next) {
        RUGA_TRY(read_text(r, p, item, &list.text[i]));
        ruga_string_add(value, "%s%s", i == 0 ? "" : ", ", list.text[i]);
    }
    ruga_string_add(value, "]");
    memcpy(p->target + p->key->offset, &list, sizeof list);
    return RUGA_OK;
}

static ruga_status read_unit(const place* p, ruga_string* value) {
    if (p->node->kind != RUGA_YAML_SCALAR) {
        return fail_kind(p, p->node, "a unit of length");
    }
    double factor;
    RUGA_TRY(ruga_yaml_fail_at(ruga_unit_factor(p->node->text, "m", &factor), p->node, p->shown));
    ruga_string_add_number(value, factor);
    memcpy(p->target + p->key->offset, &factor, sizeof factor);
    return RUGA_OK;
}

static ruga_status read_axes(const place* p, ruga_string* value) {
    const ruga_yaml_node* node = p->node;
    bool axes[3] = {false};
    if (node->kind == RUGA_YAML_SCALAR && strcmp(node->text, "true") == 0) {
        axes[0] = axes[1] = axes[2] = true;
    } else if (node->kind != RUGA_YAML_LIST || node->count == 0) {
        return fail_kind(p, node, "true or a list of some of x, y, z");
    } else {
        for (const ruga_yaml_node* item = node->first; item; item = item->next) {
            bool letter = item->kind == RUGA_YAML_SCALAR && item->text[0] >= 'x' && item->text[0] <= 'z' &&
                          item->text[1] == '\0';
            if (!letter || axes[item->text[0] - 'x']) {
                return letter ? ruga_yaml_fail(item, p->shown, "%s stands there twice", item->text)
                              : fail_kind(p, item, "x, y or z");
            }
            axes[item->text[0] - 'x'] = true;
        }
    }
    memcpy(p->target + p->key->offset, axes, sizeof axes);
    const char* separator = "[";
    for (int axis = 0; axis < 3; axis++) {
        if (axes[axis]) {
            ruga_string_add(value, "%s%c", separator, "xyz"[axis]);
            separator = ", ";
        }
    }
    ruga_string_add(value, "]");
    return RUGA_OK;
}

static ruga_status read_vertices(reader* r, const place* p, ruga_string* value) {
    if (p->node->kind != RUGA_YAML_LIST || p->node->count == 0) {
        return fail_kind(p, p->node, "a list of vertex numbers");
    }
    int* vertices;
    RUGA_TRY(RUGA_POOL_TAKE(&r->parts->pool, vertices, p->node->count));
    const ruga_yaml_node* item = p->node->first;
    for (int i = 0; i < p->node->count; i++, item = item->next) {
        double number;
        RUGA_TRY(read_whole(p, item, &number));
        if (number < 0 || number > 2147483647.0) {
            return ruga_yaml_fail(item, p->shown, "%.60s is not a vertex number; they count from 0",
                                  item->text);
        }
        vertices[i] = (int)number;
        ruga_string_add(value, "%s%d", i == 0 ? "[" : ", ", vertices[i]);
    }
    ruga_string_add(value, "]");
    ruga_region* region = (ruga_region*)(void*)(p->target + p->key->offset);
    region->vertices = vertices;
    region->vertex_count = p->node->count;
    return RUGA_OK;
}

static ruga_status read_pair(const place* p, ruga_string* value) {
    ruga_scene_pair pair = {.count = 1};
    if (p->node->kind == RUGA_YAML_LIST) {
        pair.count = 2;
        RUGA_TRY(read_row(p, p->node, 2, pair.value, value));
    } else {
        RUGA_TRY(read_row(p, p->node, 1, pair.value, value));
    }
    memcpy(p->target + p->key->offset, &pair, sizeof pair);
    return RUGA_OK;
}

static ruga_status read_points(reader* r, const place* p, ruga_string* value) {
    ruga_scene_points points = {0};
    size_t width = (size_t)p->key->count;
    if (p->node->kind != RUGA_YAML_LIST || p->node->count < 2) {
        return fail_kind(p, p->node, "a list of two or more points");
    }
    RUGA_TRY(RUGA_POOL_TAKE(&r->parts->pool, points.value, width * (size_t)p->node->count));
    ruga_string_add(value, "[");
    for (const ruga_yaml_node* row = p->node->first; row; row = row->next, points.count++) {
        ruga_string_add(value, points.count == 0 ? "" : ", ");
        RUGA_TRY(read_row(p, row, p->key->count, points.value + width * (size_t)points.count, value));
    }
    ruga_string_add(value, "]");
    memcpy(p->target + p->key->offset, &points, sizeof points);
    return RUGA_OK;
}

static ruga_status read_values(reader* r, const place* p, ruga_string* value) {
    const ruga_yaml_node* node = p->node;
    ruga_scene_points points = {.count = node->kind == RUGA_YAML_LIST ? node->count : 1};
    points.word =
        node->kind == RUGA_YAML_SCALAR && p->key->choices && strcmp(node->text, p->key->choices) == 0;
    if (points.count == 0) {
        return fail_kind(p, node, "a value or a list of them");
    }
    RUGA_TRY(RUGA_POOL_TAKE(&r->parts->pool, points.value, points.count));
    if (points.word) {
        ruga_string_add(value, "%s", p->key->choices);
    } else {
        bool one = node->kind == RUGA_YAML_LIST && node->count == 1;
        RUGA_TRY(read_row(p, one ? node->first : node, points.count, points.value, value));
    }
    memcpy(p->target + p->key->offset, &points, sizeof points);
    return RUGA_OK;
}

static ruga_status read_every(const place* p, ruga_string* value) {
    if (p->node->kind != RUGA_YAML_SCALAR || strcmp(p->node->text, "true") != 0) {
        return fail_kind(p, p->node, "true");
    }
    ruga_string_add(value, "true");
    return RUGA_OK;
}

static ruga_status read_value(reader* r, const place* p, ruga_string* value) {
    switch (p->key->kind) {
    case RUGA_KEY_NUMBERS:
        return read_numbers(p, value);
    case RUGA_KEY_STRETCH:
        return read_stretch(p, value);
    case RUGA_KEY_ROWS:
        return read_rows(p, value);
    case RUGA_KEY_SIZE:
        return read_size(r, p, value);
    case RUGA_KEY_INTEGERS:
        return read_integers(p, value);
    case RUGA_KEY_SEED:
        return read_seed(p, value);
    case RUGA_KEY_FLAG:
        return read_flag(p, value);
    case RUGA_KEY_CHOICE:
        return read_choice(p, value);
    case RUGA_KEY_TEXT:
        return read_one_text(r, p, value);
    case RUGA_KEY_TEXTS:
        return read_texts(r, p, value);
    case RUGA_KEY_UNIT:
        return read_unit(p, value);
    case RUGA_KEY_AXES:
        return read_axes(p, value);
    case RUGA_KEY_VERTICES:
        return read_vertices(r, p, value);
    case RUGA_KEY_EVERY:
        return read_every(p, value);
    case RUGA_KEY_PAIR:
        return read_pair(p, value);
    case RUGA_KEY_POINTS:
        return read_points(r, p, value);
    case RUGA_KEY_VALUES:
        return read_values(r, p, value);
    case RUGA_KEY_SECTION:
    case RUGA_KEY_ENTRIES:
    case RUGA_KEY_LATER:
        break;
    }
    return ruga_yaml_fail(p->node, p->shown, "not available yet in this version of Ruga");
}

static ruga_status read_leaf(reader* r, const place* p, bool given) {
    ruga_string value = {0};
    ruga_string_add(&value, "%s", "");
    ruga_status status = read_value(r, p, &value);
    if (status == RUGA_OK) {
        status = ruga_string_status(&value);
    }
    if (status == RUGA_OK) {
        bool angle = p->key->kind == RUGA_KEY_SIZE && r->parts->source.make.shape == RUGA_SHAPE_SKIRT;
        status =
            record(r, given ? p->node : NULL, p->shown, value.data, angle ? "m, m, rad" : p->key->dimension);
    }
    ruga_string_clear(&value);
    return status;
}

// The default of an absent key in its section; NULL where there is none to set or show.
static const char* fallback_of(const reader* r, const ruga_key* key, const ruga_yaml_node* section) {
    const char* path = key->path;
    if (strcmp(path, "interior.motion") == 0 &&
        (ruga_yaml_find(r->root, "prescribed") || ruga_yaml_find(r->root, "follow"))) {
        return "prescribed";
    }
    if (strcmp(path, "mesh.make.edge") == 0 && ruga_yaml_find(section, "cells")) {
        return NULL;
    }
    if (strcmp(path, "mesh.make.cells") == 0 && !ruga_yaml_find(section, "cells")) {
        return NULL;
    }
    if (strcmp(path, "mesh.unit") == 0 && ruga_yaml_find(section, "make")) {
        return NULL;
    }
    if (strcmp(path, "prescribed.N.stretch") == 0 && ruga_yaml_find(section, "matrix")) {
        return NULL;
    }
    if (strcmp(path, "handles.N.hold") == 0 && !ruga_yaml_find(section, "fix") &&
        !ruga_yaml_find(section, "move")) {
        return NULL;
    }
    if (strcmp(path, "creases.N.hinge.stiffness") == 0 && ruga_yaml_find(section, "length")) {
        return NULL;
    }
    if (strcmp(path, "creases.N.curve.frame") == 0 && !ruga_yaml_find(section, "fold")) {
        return NULL;
    }
    if (strcmp(path, "handles.N.during") == 0 && ruga_yaml_find(section, "fix")) {
        return NULL;
    }
    return key->fallback;
}

static ruga_status read_section(reader* r, const char* section, const char* shown, const ruga_yaml_node* node,
                                const ruga_yaml_node* above, void* target);

static ruga_status fail_missing(const place* p, const ruga_yaml_node* above) {
    ruga_string keys = {0};
    ruga_string_add(&keys, "%s", "");
    if (p->key->kind == RUGA_KEY_SECTION) {
        ruga_string_add(&keys, " (");
        ruga_key_list(p->key->path, &keys);
        ruga_string_add(&keys, ")");
    }
    ruga_status status = ruga_string_status(&keys);
    if (status == RUGA_OK) {
        status = ruga_yaml_fail(above, p->shown, "the key is missing and has no default%s", keys.data);
    }
    ruga_string_clear(&keys);
    return status;
}

// A key that is not there: its default.
static ruga_status read_absent(reader* r, const place* p, const ruga_yaml_node* section,
                               const ruga_yaml_node* above) {
    const char* fallback = fallback_of(r, p->key, section);
    if (!fallback || p->key->kind == RUGA_KEY_LATER) {
        return RUGA_OK;
    }
    if (strcmp(fallback, RUGA_KEY_REQUIRED) == 0) {
        return fail_missing(p, above);
    }
    if (fallback[0] == '(') {
        char words[64];
        (void)snprintf(words, sizeof words, "%.*s", (int)strcspn(fallback + 1, ")"), fallback + 1);
        return record(r, NULL, p->shown, words, "");
    }
    if (p->key->kind == RUGA_KEY_SECTION) {
        return read_section(r, p->key->path, p->shown, NULL, above, p->target);
    }
    ruga_yaml_node* node;
    RUGA_TRY(ruga_yaml_read(fallback, strlen(fallback), "default", false, &r->parts->pool, &node));
    place filled = *p;
    filled.node = node;
    return read_leaf(r, &filled, false);
}

// The structs of a list's entries, at their defaults, and the size of one.
static ruga_status take_entries(reader* r, const place* p, int count, char** first, size_t* size) {
    ruga_pool* pool = &r->parts->pool;
    const char* path = p->key->path;
    if (strcmp(path, "handles") == 0) {
        ruga_handle_def* handle;
        RUGA_TRY(RUGA_POOL_TAKE(pool, handle, count));
        for (int i = 0; i < count; i++) {
            handle[i] = ruga_default_handle_def();
        }
        r->def->handles = handle;
        r->def->handle_count = count;
        *first = (char*)handle;
        *size = sizeof *handle;
    } else if (strcmp(path, "prescribed") == 0) {
        ruga_keyframe_def* keyframe;
        RUGA_TRY(RUGA_POOL_TAKE(pool, keyframe, count));
        for (int i = 0; i < count; i++) {
            keyframe[i] = ruga_default_keyframe_def();
        }
        r->def->keyframes = keyframe;
        r->def->keyframe_count = count;
        *first = (char*)keyframe;
        *size = sizeof *keyframe;
    } else if (strcmp(path, "creases") == 0) {
        ruga_scene_crease* crease;
        RUGA_TRY(RUGA_POOL_TAKE(pool, crease, count));
        for (int i = 0; i < count; i++) {
            crease[i] = (ruga_scene_crease){.result_frame = -1, .yield = INFINITY, .rate = INFINITY};
        }
        r->parts->crease = crease;
        r->parts->crease_count = count;
        *first = (char*)crease;
        *size = sizeof *crease;
    } else if (strcmp(path, "creases.N.hinge.animate") == 0) {
        ruga_scene_crease* crease = (ruga_scene_crease*)(void*)p->target;
        RUGA_TRY(RUGA_POOL_TAKE(pool, crease->keys, count));
        memset(crease->keys, 0, sizeof *crease->keys * (size_t)count);
        crease->key_count = count;
        *first = (char*)crease->keys;
        *size = sizeof *crease->keys;
    } else {
        ruga_scene_vary* vary;
        RUGA_TRY(RUGA_POOL_TAKE(pool, vary, count));
        for (int i = 0; i < count; i++) {
            vary[i] = (ruga_scene_vary){.region = {.kind = RUGA_REGION_ALL}};
        }
        r->parts->vary = vary;
        r->parts->vary_count = count;
        *first = (char*)vary;
        *size = sizeof *vary;
    }
    return RUGA_OK;
}

static ruga_status read_entries(reader* r, const place* p) {
    const ruga_yaml_node* node = p->node;
    char* entry;
    size_t size;
    if (node->kind != RUGA_YAML_LIST) {
        return fail_kind(p, node, "a list of maps");
    }
    RUGA_TRY(take_entries(r, p, node->count, &entry, &size));
    const ruga_yaml_node* item = node->first;
    for (int i = 0; i < node->count; i++, item = item->next) {
        char section[PATH_LENGTH], shown[PATH_LENGTH];
        (void)snprintf(section, sizeof section, "%s.N", p->key->path);
        (void)snprintf(shown, sizeof shown, "%.100s.%d", p->shown, i);
        RUGA_TRY(read_section(r, section, shown, item, item, entry + size * (size_t)i));
    }
    return node->count > 0 ? RUGA_OK : record(r, node, p->shown, "none", "");
}

// The one word that may stand in place of a section's map; NULL where there is none.
static const char* word_of_section(const ruga_key* key) {
    bool region = strcmp(key->path, "handles.N.region") == 0 || strcmp(key->path, "skin.vary.N.region") == 0;
    return strcmp(key->path, "interior") == 0 ? "none" : region ? "all" : NULL;
}

static ruga_status read_subsection(reader* r, const place* p) {
    const char* word = word_of_section(p->key);
    if (p->node->kind == RUGA_YAML_SCALAR && word && strcmp(p->node->text, word) == 0) {
        char all[PATH_LENGTH]; // region: all is short for region: {all: true}
        (void)snprintf(all, sizeof all, "%.100s.all", p->shown);
        return strcmp(word, "all") == 0 ? record(r, p->node, all, "true", "")
                                        : record(r, p->node, p->shown, word, "");
    }
    if (p->node->kind != RUGA_YAML_MAP) {
        char needed[64];
        (void)snprintf(needed, sizeof needed,
                       word ? "a map {key: value, ...} or the word %s" : "a map {key: value, ...}", word);
        return fail_kind(p, p->node, needed);
    }
    return read_section(r, p->key->path, p->shown, p->node, p->node, p->target);
}

static ruga_status check_names(const char* section, const char* shown, const ruga_yaml_node* map) {
    for (const ruga_yaml_node* child = map->first; child; child = child->next) {
        if (ruga_key_find(section, child->key)) {
            continue;
        }
        char path[PATH_LENGTH];
        (void)snprintf(path, sizeof path, "%s%s%.60s", shown, *shown ? "." : "", child->key);
        ruga_string sentence = {0};
        ruga_key_suggest(section, child->key, &sentence);
        ruga_status status = ruga_string_status(&sentence);
        if (status == RUGA_OK) {
            status = ruga_yaml_fail(child, path, "%s", sentence.data);
        }
        ruga_string_clear(&sentence);
        return status;
    }
    return RUGA_OK;
}

static ruga_status read_key(reader* r, const ruga_key* key, const char* shown, const ruga_yaml_node* node,
                            const ruga_yaml_node* above, void* target) {
    char path[PATH_LENGTH];
    const char* name = ruga_key_name(key);
    (void)snprintf(path, sizeof path, "%s%s%s", shown, *shown ? "." : "", name);
    place p = {key, path, ruga_yaml_find(node, name), target};
    if (strcmp(key->path, "mesh") == 0) {
        p.target = (char*)&r->parts->source;
    } else if (strcmp(key->path, "follow") == 0) {
        p.target = (char*)&r->parts->follow;
    }
    if (!p.node) {
        return read_absent(r, &p, node, above);
    }
    if (is_empty(p.node)) {
        return ruga_yaml_fail(p.node, path, "there is no value: give one, or leave the key out");
    }
    if (key->kind == RUGA_KEY_ENTRIES) {
        return read_entries(r, &p);
    }
    return key->kind == RUGA_KEY_SECTION ? read_subsection(r, &p) : read_leaf(r, &p, true);
}

// The keys of a section; `node` is its map, or NULL where it is absent: all defaults. `above`: the node whose
// line stands for what is missing.
static ruga_status read_section(reader* r, const char* section, const char* shown, const ruga_yaml_node* node,
                                const ruga_yaml_node* above, void* target) {
    if (node && node->kind != RUGA_YAML_MAP) {
        char found[64];
        ruga_yaml_describe(node, found);
        return ruga_yaml_fail(node, shown, "a map {key: value, ...} is needed, not %s", found);
    }
    if (node) {
        RUGA_TRY(check_names(section, shown, node));
    }
    for (int i = 0; i < ruga_key_count; i++) {
        const ruga_key* key = &ruga_keys[i];
        if (!ruga_key_is_child(key, section)) {
            continue;
        }
        bool of_interior = strcmp(key->path, "lattice") == 0 || strcmp(key->path, "coupling") == 0 ||
                           strcmp(key->path, "prescribed") == 0 || strcmp(key->path, "follow") == 0;
        const ruga_yaml_node* given = node ? ruga_yaml_find(node, ruga_key_name(key)) : NULL;
        if (of_interior && !r->def->has_interior) {
            if (given) {
                return ruga_yaml_fail(given, key->path,
                                      "there is nothing for it to act on with interior: none");
            }
            continue;
        }
        RUGA_TRY(read_key(r, key, shown, node, above, target));
    }
    return RUGA_OK;
}

ruga_status ruga_scene_read_keys(const ruga_yaml_node* root, ruga_scene_parts* parts, ruga_model_def* def) {
    reader r = {parts, def, root};
    const ruga_yaml_node* interior = ruga_yaml_find(root, "interior");
    def->has_interior =
        !(interior && interior->kind == RUGA_YAML_SCALAR && strcmp(interior->text, "none") == 0);
    if (root->kind != RUGA_YAML_MAP) {
        return ruga_yaml_fail(root, NULL, "a scene is a map of keys such as mesh, skin and handles");
    }
    return read_section(&r, "", "", root, root, def);
}
