// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Enough of XML to read drawings: tags with their attributes, one after the other. Entities in attributes
// stay as they are; text between tags is what lies between two tags.
#ifndef RUGA_IO_XML_H
#define RUGA_IO_XML_H

#include "core/status.h"

// A part of the text.
typedef struct ruga_slice {
    const char* at; // NULL = not there
    size_t length;
} ruga_slice;

typedef struct ruga_xml {
    const char* path;
    const char* at;
    const char* end;
    int line; // of `at`, from 1
    // The last tag:
    ruga_slice name; // without a prefix such as svg:
    ruga_slice attributes;
    bool closes;       // </name>, or <name/>
    bool opens;        // <name>, or <name/>
    const char* after; // behind the tag
} ruga_xml;

// `text` [size + 1] ends with '\0'.
void ruga_xml_begin(const char* path, const char* text, size_t size, ruga_xml* xml);
// Goes to the next tag; *found is false at the end. RUGA_BAD_INPUT with the line of a tag that does not end.
ruga_status ruga_xml_next(ruga_xml* xml, bool* found);
// An attribute of the last tag.
ruga_slice ruga_xml_attribute(const ruga_xml* xml, const char* name);
bool ruga_slice_is(ruga_slice slice, const char* text);

#endif
