// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/xml.h"

#include <expat.h>
#include <string.h>

enum { CHUNK = 1 << 20 };
typedef struct reader {
    XML_Parser parser;
    const char* path;
    const ruga_xml_events* events;
    ruga_status status;
} reader;

bool ruga_slice_is(ruga_slice slice, const char* text) {
    return slice.at && strlen(text) == slice.length && memcmp(slice.at, text, slice.length) == 0;
}

ruga_slice ruga_xml_attribute(const ruga_xml_tag* tag, const char* name) {
    for (const char* const* a = tag->attribute; *a; a += 2) {
        if (strcmp(a[0], name) == 0) {
            return (ruga_slice){a[1], strlen(a[1])};
        }
    }
    return (ruga_slice){NULL, 0};
}

static int line_of(const reader* r) {
    return (int)XML_GetCurrentLineNumber(r->parser);
}

static void take(reader* r, ruga_status status) {
    if (r->status == RUGA_OK && status != RUGA_OK) {
        r->status = status;
        (void)XML_StopParser(r->parser, XML_FALSE);
    }
}

static void XMLCALL open_element(void* context, const XML_Char* name, const XML_Char** attribute) {
    reader* r = context;
    const char* colon = strrchr(name, ':');
    name = colon ? colon + 1 : name;
    const ruga_xml_tag tag = {r->path, line_of(r), {name, strlen(name)}, (const char* const*)attribute};
    take(r, r->status == RUGA_OK ? r->events->open(&tag, r->events->context) : RUGA_OK);
}

static void XMLCALL close_element(void* context, const XML_Char* name) {
    reader* r = context;
    (void)name;
    take(r, r->status == RUGA_OK ? r->events->close(r->events->context) : RUGA_OK);
}

static void XMLCALL take_text(void* context, const XML_Char* text, int length) {
    reader* r = context;
    const ruga_slice slice = {text, (size_t)length};
    take(r, r->status == RUGA_OK ? r->events->text(slice, r->events->context) : RUGA_OK);
}

static ruga_status parse(reader* r, const char* text, size_t size) {
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, open_element, close_element);
    XML_SetCharacterDataHandler(r->parser, take_text);
    for (size_t at = 0; at <= size; at += CHUNK) {
        size_t length = size - at < CHUNK ? size - at : CHUNK;
        if (XML_Parse(r->parser, text + at, (int)length, at + CHUNK > size) != XML_STATUS_OK) {
            enum XML_Error error = XML_GetErrorCode(r->parser);
            return r->status != RUGA_OK           ? r->status
                   : error == XML_ERROR_NO_MEMORY ? ruga_fail(RUGA_NO_MEMORY, "%s: out of memory", r->path)
                                                  : ruga_fail(RUGA_BAD_INPUT, "%s:%d: not XML: %s", r->path,
                                                              line_of(r), XML_ErrorString(error));
        }
    }
    return RUGA_OK;
}

ruga_status ruga_xml_read(const char* path, const char* text, size_t size, const ruga_xml_events* events) {
    reader r = {.parser = XML_ParserCreate(NULL), .path = path, .events = events, .status = RUGA_OK};
    if (!r.parser) {
        return ruga_fail(RUGA_NO_MEMORY, "%s: out of memory", path);
    }
    ruga_status status = parse(&r, text, size);
    XML_ParserFree(r.parser);
    return status;
}
