// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// libyaml's events to nodes. Depth, size and number of nodes are limited, so that no file can exhaust stack
// or memory, not even by aliases of aliases.
#include "io/yaml.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <yaml.h>

enum { MAX_NODES = 4000000, MAX_KEYS = 1000 };

typedef struct anchor {
    const char* name;
    ruga_yaml_node* node;
    bool complete; // false while its own content is read: an alias there would never end
    struct anchor* next;
} anchor;

typedef struct loader {
    yaml_parser_t parser;
    const char* text;
    size_t length;
    const char* name;
    bool lines;
    ruga_pool* pool;
    anchor* anchors;
    int node_count;
} loader;

ruga_status ruga_yaml_fail(const ruga_yaml_node* node, const char* key, const char* format, ...) {
    char sentence[1024];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    (void)ruga_fail(RUGA_BAD_INPUT, "%s", sentence);
    return ruga_yaml_fail_at(RUGA_BAD_INPUT, node, key);
}

ruga_status ruga_yaml_fail_at(ruga_status status, const ruga_yaml_node* node, const char* key) {
    if (status == RUGA_OK || status == RUGA_NO_MEMORY) {
        return status;
    }
    if (key && *key) {
        (void)ruga_fail_prefix(status, "%s", key);
    }
    return node->line > 0 ? ruga_fail_prefix(status, "%s:%d", node->origin, node->line)
                          : ruga_fail_prefix(status, "%.200s", node->origin);
}

static ruga_status fail_line(const loader* l, size_t line, const char* sentence) {
    return l->lines ? ruga_fail(RUGA_BAD_INPUT, "%s:%zu: %s", l->name, line + 1, sentence)
                    : ruga_fail(RUGA_BAD_INPUT, "%.200s: %s", l->name, sentence);
}

static size_t line_of_byte(const loader* l, size_t offset) {
    size_t line = 0;
    for (size_t i = 0; i < offset && i < l->length; i++) {
        line += l->text[i] == '\n';
    }
    return line;
}

static bool line_begins_with_tab(const loader* l, size_t line) {
    const char *c = l->text, *end = l->text + l->length;
    for (; line > 0 && c < end; c++) {
        line -= *c == '\n';
    }
    for (; c < end && (*c == ' ' || *c == '\t'); c++) {
        if (*c == '\t') {
            return true;
        }
    }
    return false;
}

// What libyaml found wrong.
static ruga_status fail_parser(const loader* l) {
    const yaml_parser_t* p = &l->parser;
    const char* problem = p->problem ? p->problem : "unknown problem";
    char sentence[256];
    if (p->error == YAML_MEMORY_ERROR) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: YAML of %zu bytes", l->length);
    }
    if (p->error == YAML_READER_ERROR) {
        (void)snprintf(sentence, sizeof sentence, "not valid UTF-8 text: %s (byte %zu)", problem,
                       p->problem_offset + 1);
        return fail_line(l, line_of_byte(l, p->problem_offset), sentence);
    }
    size_t line = p->problem_mark.line;
    bool tab = line_begins_with_tab(l, line);
    (void)snprintf(sentence, sizeof sentence, "not valid YAML: %s%s%s%s", p->context ? p->context : "",
                   p->context ? ", " : "", problem, tab ? "; indent with spaces, not with tabs" : "");
    return fail_line(l, line, sentence);
}

static ruga_status next_event(loader* l, yaml_event_t* event) {
    if (!yaml_parser_parse(&l->parser, event)) {
        memset(event, 0, sizeof *event);
        return fail_parser(l);
    }
    return RUGA_OK;
}

static ruga_status make_node(loader* l, ruga_yaml_kind kind, size_t line, int depth, ruga_yaml_node** node) {
    char sentence[128];
    if (depth > RUGA_YAML_DEPTH) {
        (void)snprintf(sentence, sizeof sentence, "lists and maps are nested more than %d deep",
                       RUGA_YAML_DEPTH);
        return fail_line(l, line, sentence);
    }
    if (++l->node_count > MAX_NODES) {
        (void)snprintf(sentence, sizeof sentence, "more than %d values", MAX_NODES);
        return fail_line(l, line, sentence);
    }
    RUGA_TRY(RUGA_POOL_TAKE(l->pool, *node, 1));
    (*node)->kind = kind;
    (*node)->origin = l->name;
    (*node)->line = l->lines ? (int)line + 1 : 0;
    return RUGA_OK;
}

static void append(ruga_yaml_node* parent, ruga_yaml_node* child) {
    if (parent->last) {
        parent->last->next = child;
    } else {
        parent->first = child;
    }
    parent->last = child;
    parent->count++;
}

static ruga_status remember_anchor(loader* l, const yaml_char_t* name, ruga_yaml_node* node, anchor** made) {
    *made = NULL;
    if (!name) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_POOL_TAKE(l->pool, *made, 1));
    char* copy;
    RUGA_TRY(ruga_pool_copy(l->pool, (const char*)name, strlen((const char*)name), &copy));
    **made = (anchor){.name = copy, .node = node, .next = l->anchors};
    l->anchors = *made;
    return RUGA_OK;
}

static ruga_status copy_node(loader* l, const ruga_yaml_node* source, size_t line, int depth,
                             ruga_yaml_node** copy) {
    RUGA_TRY(make_node(l, source->kind, line, depth, copy));
    (*copy)->plain = source->plain;
    (*copy)->text = source->text;
    for (const ruga_yaml_node* child = source->first; child; child = child->next) {
        ruga_yaml_node* child_copy;
        RUGA_TRY(copy_node(l, child, line, depth + 1, &child_copy));
        child_copy->key = child->key;
        append(*copy, child_copy);
    }
    return RUGA_OK;
}

static ruga_status read_alias(loader* l, const yaml_event_t* event, int depth, ruga_yaml_node** node) {
    const char* name = (const char*)event->data.alias.anchor;
    size_t line = event->start_mark.line;
    for (const anchor* a = l->anchors; a; a = a->next) {
        if (strcmp(a->name, name) == 0) {
            return a->complete ? copy_node(l, a->node, line, depth, node)
                               : fail_line(l, line, "an alias refers to what it is part of");
        }
    }
    char sentence[128];
    (void)snprintf(sentence, sizeof sentence, "the alias *%.40s has no anchor &%.40s before it", name, name);
    return fail_line(l, line, sentence);
}

static ruga_status read_scalar(loader* l, const yaml_event_t* event, int depth, ruga_yaml_node** node) {
    const char* value = (const char*)event->data.scalar.value;
    size_t length = event->data.scalar.length;
    if (strlen(value) != length) {
        return fail_line(l, event->start_mark.line, "a text contains a zero byte");
    }
    RUGA_TRY(make_node(l, RUGA_YAML_SCALAR, event->start_mark.line, depth, node));
    char* text;
    RUGA_TRY(ruga_pool_copy(l->pool, value, length, &text));
    (*node)->text = text;
    (*node)->plain = event->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
    anchor* made;
    RUGA_TRY(remember_anchor(l, event->data.scalar.anchor, *node, &made));
    if (made) {
        made->complete = true;
    }
    return RUGA_OK;
}

static ruga_status read_node(loader* l, const yaml_event_t* event, int depth, ruga_yaml_node** node);

static ruga_status read_list(loader* l, const yaml_event_t* start, int depth, ruga_yaml_node** node) {
    RUGA_TRY(make_node(l, RUGA_YAML_LIST, start->start_mark.line, depth, node));
    anchor* made;
    RUGA_TRY(remember_anchor(l, start->data.sequence_start.anchor, *node, &made));
    for (;;) {
        yaml_event_t event;
        RUGA_TRY(next_event(l, &event));
        bool end = event.type == YAML_SEQUENCE_END_EVENT;
        ruga_yaml_node* item = NULL;
        ruga_status status = end ? RUGA_OK : read_node(l, &event, depth + 1, &item);
        yaml_event_delete(&event);
        if (status != RUGA_OK) {
            return status;
        }
        if (end) {
            break;
        }
        append(*node, item);
    }
    if (made) {
        made->complete = true;
    }
    return RUGA_OK;
}

static ruga_status check_key(loader* l, const yaml_event_t* event, const ruga_yaml_node* map) {
    size_t line = event->start_mark.line;
    if (event->type != YAML_SCALAR_EVENT) {
        return fail_line(l, line, "a key must be a word, not a list, map or alias");
    }
    const char* key = (const char*)event->data.scalar.value;
    char sentence[160];
    if (strlen(key) != event->data.scalar.length) {
        return fail_line(l, line, "a key contains a zero byte");
    }
    if (map->count >= MAX_KEYS) {
        (void)snprintf(sentence, sizeof sentence, "a map has more than %d keys", MAX_KEYS);
        return fail_line(l, line, sentence);
    }
    const ruga_yaml_node* twin = ruga_yaml_find(map, key);
    if (!twin) {
        return RUGA_OK;
    }
    if (l->lines) {
        (void)snprintf(sentence, sizeof sentence,
                       "%.60s: the key stands here a second time, first on line %d", key, twin->line);
    } else {
        (void)snprintf(sentence, sizeof sentence, "%.60s: the key stands here twice", key);
    }
    return fail_line(l, line, sentence);
}

// The key of a map's entry, in `key`, or its end.
static ruga_status read_key(loader* l, const ruga_yaml_node* map, bool* end, char** key, size_t* line) {
    yaml_event_t event;
    RUGA_TRY(next_event(l, &event));
    *end = event.type == YAML_MAPPING_END_EVENT;
    *line = event.start_mark.line;
    ruga_status status = *end ? RUGA_OK : check_key(l, &event, map);
    if (status == RUGA_OK && !*end) {
        status = ruga_pool_copy(l->pool, (const char*)event.data.scalar.value, event.data.scalar.length, key);
    }
    yaml_event_delete(&event);
    return status;
}

static ruga_status read_map(loader* l, const yaml_event_t* start, int depth, ruga_yaml_node** node) {
    RUGA_TRY(make_node(l, RUGA_YAML_MAP, start->start_mark.line, depth, node));
    anchor* made;
    RUGA_TRY(remember_anchor(l, start->data.mapping_start.anchor, *node, &made));
    for (;;) {
        bool end;
        char* key = NULL;
        size_t line;
        RUGA_TRY(read_key(l, *node, &end, &key, &line));
        if (end) {
            break;
        }
        yaml_event_t event;
        RUGA_TRY(next_event(l, &event));
        ruga_yaml_node* value = NULL;
        ruga_status status = read_node(l, &event, depth + 1, &value);
        yaml_event_delete(&event);
        if (status != RUGA_OK) {
            return status;
        }
        value->key = key;
        value->line = l->lines ? (int)line + 1 : 0; // a block map begins only below its key
        append(*node, value);
    }
    if (made) {
        made->complete = true;
    }
    return RUGA_OK;
}

// The node that begins with `event`; its further events are taken from the parser.
static ruga_status read_node(loader* l, const yaml_event_t* event, int depth, ruga_yaml_node** node) {
    const yaml_char_t* tag = event->type == YAML_SCALAR_EVENT           ? event->data.scalar.tag
                             : event->type == YAML_SEQUENCE_START_EVENT ? event->data.sequence_start.tag
                             : event->type == YAML_MAPPING_START_EVENT  ? event->data.mapping_start.tag
                                                                        : NULL;
    if (tag) {
        return fail_line(l, event->start_mark.line, "tags (!...) have no meaning in a scene: leave them out");
    }
    switch (event->type) {
    case YAML_ALIAS_EVENT:
        return read_alias(l, event, depth, node);
    case YAML_SCALAR_EVENT:
        return read_scalar(l, event, depth, node);
    case YAML_SEQUENCE_START_EVENT:
        return read_list(l, event, depth, node);
    case YAML_MAPPING_START_EVENT:
        return read_map(l, event, depth, node);
    default:
        return fail_line(l, event->start_mark.line, "not valid YAML: a value is missing");
    }
}

// Events up to the end of the stream: one document.
static ruga_status read_stream(loader* l, ruga_yaml_node** root) {
    for (;;) {
        yaml_event_t event;
        RUGA_TRY(next_event(l, &event));
        yaml_event_type_t type = event.type;
        ruga_status status = RUGA_OK;
        if (type == YAML_DOCUMENT_START_EVENT && *root) {
            status = fail_line(l, event.start_mark.line, "a second document begins; one scene, one document");
        } else if (type != YAML_STREAM_START_EVENT && type != YAML_STREAM_END_EVENT &&
                   type != YAML_DOCUMENT_START_EVENT && type != YAML_DOCUMENT_END_EVENT) {
            status = read_node(l, &event, 1, root);
        }
        yaml_event_delete(&event);
        if (status != RUGA_OK || type == YAML_STREAM_END_EVENT) {
            return status;
        }
    }
}

ruga_status ruga_yaml_read(const char* text, size_t length, const char* name, bool lines, ruga_pool* pool,
                           ruga_yaml_node** root) {
    *root = NULL;
    loader l = {.text = text, .length = length, .lines = lines, .pool = pool};
    char* name_copy;
    RUGA_TRY(ruga_pool_copy(pool, name, strlen(name), &name_copy));
    l.name = name_copy;
    if (length > RUGA_YAML_MAX_BYTES) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: %zu bytes are too many for a scene (at most %d)", name, length,
                         RUGA_YAML_MAX_BYTES);
    }
    if (!yaml_parser_initialize(&l.parser)) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: YAML parser");
    }
    yaml_parser_set_input_string(&l.parser, (const unsigned char*)text, length);
    ruga_status status = read_stream(&l, root);
    yaml_parser_delete(&l.parser);
    if (status == RUGA_OK && !*root) {
        status = fail_line(&l, 0, "there is nothing in it");
    }
    return status;
}

ruga_yaml_node* ruga_yaml_find(const ruga_yaml_node* map, const char* key) {
    if (map && map->kind == RUGA_YAML_MAP) {
        for (ruga_yaml_node* child = map->first; child; child = child->next) {
            if (strcmp(child->key, key) == 0) {
                return child;
            }
        }
    }
    return NULL;
}

ruga_yaml_node* ruga_yaml_item(const ruga_yaml_node* list, int index) {
    ruga_yaml_node* child = list->first;
    for (; child && index > 0; index--) {
        child = child->next;
    }
    return child;
}

void ruga_yaml_describe(const ruga_yaml_node* node, char text[64]) {
    if (node->kind == RUGA_YAML_SCALAR) {
        (void)snprintf(text, 64, "the text '%.40s'", node->text);
    } else {
        (void)snprintf(text, 64, node->kind == RUGA_YAML_LIST ? "a list of %d" : "a map", node->count);
    }
}
