// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Trees of YAML changed by --set, and written out again.
#include "io/yaml.h"

#include <stdio.h>
#include <string.h>

#include <yaml.h>

// Index of a list from digits only; -1 where it is none.
static int parse_index(const char* text) {
    long value = 0;
    for (const char* c = text; *c; c++) {
        if (*c < '0' || *c > '9' || value > 100000000) {
            return -1;
        }
        value = 10 * value + (*c - '0');
    }
    return *text ? (int)value : -1;
}

// Where `part` of the path stands in `parent`; a missing key is added, as a map.
static ruga_status descend(ruga_yaml_node* parent, const char* part, const ruga_yaml_node* place,
                           ruga_pool* pool, ruga_yaml_node** child) {
    if (parent->kind == RUGA_YAML_LIST) {
        int index = parse_index(part);
        *child = index >= 0 ? ruga_yaml_item(parent, index) : NULL;
        return *child ? RUGA_OK
                      : ruga_yaml_fail(place, NULL, "'%.40s' is no entry of this list of %d (counted from 0)",
                                       part, parent->count);
    }
    if (parent->kind == RUGA_YAML_SCALAR) {
        return ruga_yaml_fail(place, NULL, "'%.40s' cannot be set inside of '%.40s', which is no map", part,
                              parent->text);
    }
    *child = ruga_yaml_find(parent, part);
    if (*child) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_POOL_TAKE(pool, *child, 1));
    char* key;
    RUGA_TRY(ruga_pool_copy(pool, part, strlen(part), &key));
    **child = (ruga_yaml_node){.kind = RUGA_YAML_MAP, .key = key, .origin = place->origin};
    if (parent->last) {
        parent->last->next = *child;
    } else {
        parent->first = *child;
    }
    parent->last = *child;
    parent->count++;
    return RUGA_OK;
}

// "a.b=value" cut at its first =.
static ruga_status split_assignment(const char* assignment, const ruga_yaml_node* place, ruga_pool* pool,
                                    char** path, const char** value) {
    const char* equals = strchr(assignment, '=');
    *value = equals ? equals + 1 : "";
    if (**value == '\0' || equals == assignment) {
        return ruga_yaml_fail(place, NULL,
                              "write --set key.path=value, such as --set skin.thickness=\"2 mm\"");
    }
    return ruga_pool_copy(pool, assignment, (size_t)(equals - assignment), path);
}

ruga_status ruga_yaml_set(ruga_yaml_node* root, const char* assignment, ruga_pool* pool) {
    size_t size = strlen(assignment) + sizeof "--set ";
    char *origin, *path;
    const char* value = "";
    RUGA_TRY(RUGA_POOL_TAKE(pool, origin, size));
    (void)snprintf(origin, size, "--set %s", assignment);
    const ruga_yaml_node place = {.origin = origin};
    RUGA_TRY(split_assignment(assignment, &place, pool, &path, &value));
    ruga_yaml_node* fresh;
    RUGA_TRY(ruga_yaml_read(value, strlen(value), origin, false, pool, &fresh));

    ruga_yaml_node* node = root;
    int depth = 0;
    for (char* part = path; part; depth++) {
        char* dot = strchr(part, '.');
        if (dot) {
            *dot = '\0';
        }
        if (*part == '\0' || depth >= RUGA_YAML_DEPTH) {
            return ruga_yaml_fail(&place, NULL,
                                  *part ? "the key path is too long" : "a part of the key path is empty");
        }
        RUGA_TRY(descend(node, part, &place, pool, &node));
        part = dot ? dot + 1 : NULL;
    }
    // The new value takes the old one's place among its siblings.
    fresh->key = node->key;
    fresh->next = node->next;
    *node = *fresh;
    return RUGA_OK;
}

static int collect(void* context, unsigned char* bytes, size_t length) {
    ruga_string* text = context;
    ruga_string_add_bytes(text, (const char*)bytes, length);
    return !text->failed;
}

static bool emit_node(yaml_emitter_t* emitter, const ruga_yaml_node* node, int depth);

static bool emit_scalar(yaml_emitter_t* emitter, const char* text, bool plain) {
    yaml_event_t event;
    yaml_scalar_style_t style = plain ? YAML_PLAIN_SCALAR_STYLE : YAML_DOUBLE_QUOTED_SCALAR_STYLE;
    return yaml_scalar_event_initialize(&event, NULL, NULL, (const yaml_char_t*)text, (int)strlen(text), 1, 1,
                                        style) &&
           yaml_emitter_emit(emitter, &event);
}

static bool emit_children(yaml_emitter_t* emitter, const ruga_yaml_node* node, int depth) {
    for (const ruga_yaml_node* child = node->first; child; child = child->next) {
        if (node->kind == RUGA_YAML_MAP && !emit_scalar(emitter, child->key, true)) {
            return false;
        }
        if (!emit_node(emitter, child, depth + 1)) {
            return false;
        }
    }
    return true;
}

// Blocks outside, one line each from the second level on: as people write scenes.
static bool emit_node(yaml_emitter_t* emitter, const ruga_yaml_node* node, int depth) {
    yaml_event_t event;
    bool ok = false, block = depth == 0 || (depth == 1 && node->kind == RUGA_YAML_LIST && node->first &&
                                            node->first->kind == RUGA_YAML_MAP);
    switch (node->kind) {
    case RUGA_YAML_SCALAR:
        return emit_scalar(emitter, node->text, node->plain);
    case RUGA_YAML_LIST:
        ok = yaml_sequence_start_event_initialize(
            &event, NULL, NULL, 1, block ? YAML_BLOCK_SEQUENCE_STYLE : YAML_FLOW_SEQUENCE_STYLE);
        return ok && yaml_emitter_emit(emitter, &event) && emit_children(emitter, node, depth) &&
               yaml_sequence_end_event_initialize(&event) && yaml_emitter_emit(emitter, &event);
    case RUGA_YAML_MAP:
        ok = yaml_mapping_start_event_initialize(&event, NULL, NULL, 1,
                                                 block ? YAML_BLOCK_MAPPING_STYLE : YAML_FLOW_MAPPING_STYLE);
        return ok && yaml_emitter_emit(emitter, &event) && emit_children(emitter, node, depth) &&
               yaml_mapping_end_event_initialize(&event) && yaml_emitter_emit(emitter, &event);
    }
    return false;
}

ruga_status ruga_yaml_write(const ruga_yaml_node* root, ruga_string* text) {
    yaml_emitter_t emitter;
    if (!yaml_emitter_initialize(&emitter)) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: YAML emitter");
    }
    yaml_emitter_set_output(&emitter, collect, text);
    yaml_emitter_set_unicode(&emitter, 1);
    yaml_emitter_set_width(&emitter, -1); // lines as long as they are: folded ones are hard to read
    yaml_event_t event;
    bool ok = yaml_stream_start_event_initialize(&event, YAML_UTF8_ENCODING) &&
              yaml_emitter_emit(&emitter, &event) &&
              yaml_document_start_event_initialize(&event, NULL, NULL, NULL, 1) &&
              yaml_emitter_emit(&emitter, &event) && emit_node(&emitter, root, 0) &&
              yaml_document_end_event_initialize(&event, 1) && yaml_emitter_emit(&emitter, &event) &&
              yaml_stream_end_event_initialize(&event) && yaml_emitter_emit(&emitter, &event);
    yaml_emitter_delete(&emitter);
    return ok && !text->failed ? RUGA_OK : ruga_fail(RUGA_NO_MEMORY, "out of memory: the scene's text");
}
