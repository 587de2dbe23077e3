// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// XML as events, by libexpat. External entities are not fetched; internal ones are put in, and refused where
// they make more than a hundred times the file. Files that are not well-formed are refused with the line.
#ifndef RUGA_IO_XML_H
#define RUGA_IO_XML_H

#include "core/status.h"

// A part of a text.
typedef struct ruga_slice {
    const char* at; // NULL = not there
    size_t length;
} ruga_slice;

// An element that opens.
typedef struct ruga_xml_tag {
    const char* path;
    int line;                     // from 1
    ruga_slice name;              // without a prefix such as svg:
    const char* const* attribute; // name, value, name, value, ..., NULL
} ruga_xml_tag;

typedef struct ruga_xml_events {
    ruga_status (*open)(const ruga_xml_tag* tag, void* context);
    ruga_status (*close)(void* context);
    ruga_status (*text)(ruga_slice text, void* context); // in parts
    void* context;
} ruga_xml_events;

// A status of an event other than RUGA_OK ends the reading and is handed back. RUGA_BAD_INPUT with the line
// of what is no XML.
ruga_status ruga_xml_read(const char* path, const char* text, size_t size, const ruga_xml_events* events);
// An attribute's value, ended by '\0'.
ruga_slice ruga_xml_attribute(const ruga_xml_tag* tag, const char* name);
bool ruga_slice_is(ruga_slice slice, const char* text);

#endif
