// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A YAML document as a tree of nodes that know where they stand. One document, plain maps, lists and scalars;
// aliases are copied out; tags, several documents and repeated keys are refused.
#ifndef RUGA_IO_YAML_H
#define RUGA_IO_YAML_H

#include "io/pool.h"

typedef enum ruga_yaml_kind { RUGA_YAML_SCALAR, RUGA_YAML_LIST, RUGA_YAML_MAP } ruga_yaml_kind;

typedef struct ruga_yaml_node {
    ruga_yaml_kind kind;
    bool plain;         // a scalar without quotes
    const char* origin; // the file's name, or "--set key=value"
    int line;           // from 1; 0 = the origin has no lines
    const char* key;    // in a map
    const char* text;   // of a scalar
    int count;          // children of a list or map
    struct ruga_yaml_node *first, *last, *next;
} ruga_yaml_node;

enum { RUGA_YAML_DEPTH = 100, RUGA_YAML_MAX_BYTES = 64 << 20 };

// All nodes and strings live in `pool`. RUGA_BAD_INPUT: "name:12: not valid YAML: ...". `lines`: whether
// messages give lines.
ruga_status ruga_yaml_read(const char* text, size_t length, const char* name, bool lines, ruga_pool* pool,
                           ruga_yaml_node** root);

// NULL where the map has no such key, or the node is not a map.
ruga_yaml_node* ruga_yaml_find(const ruga_yaml_node* map, const char* key);
ruga_yaml_node* ruga_yaml_item(const ruga_yaml_node* list, int index);
// "a map", "a list of 3", "the text 'x'"
void ruga_yaml_describe(const ruga_yaml_node* node, char text[64]);

// "scene.yaml:12: key: sentence"; `key` may be NULL.
ruga_status ruga_yaml_fail(const ruga_yaml_node* node, const char* key, const char* format, ...)
    __attribute__((format(printf, 3, 4)));
// The same before the sentence that `status` left behind. Lack of memory stays as it is.
ruga_status ruga_yaml_fail_at(ruga_status status, const ruga_yaml_node* node, const char* key);

// --set: puts the value at a path, "skin.thickness=2 mm" or "handles.0.press=5 kPa"; missing maps are made.
ruga_status ruga_yaml_set(ruga_yaml_node* root, const char* assignment, ruga_pool* pool);

// The tree as YAML, without comments, anchors and aliases.
ruga_status ruga_yaml_write(const ruga_yaml_node* root, ruga_string* text);

#endif
