// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/xml.h"

#include <string.h>

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool ruga_slice_is(ruga_slice slice, const char* text) {
    return slice.at && strlen(text) == slice.length && memcmp(slice.at, text, slice.length) == 0;
}

void ruga_xml_begin(const char* path, const char* text, size_t size, ruga_xml* xml) {
    *xml = (ruga_xml){.path = path, .at = text, .end = text + size, .line = 1, .after = text};
}

static void go_to(ruga_xml* xml, const char* to) {
    for (; xml->at < to; xml->at++) {
        xml->line += *xml->at == '\n';
    }
}

static ruga_status fail(const ruga_xml* xml, const char* what) {
    return ruga_fail(RUGA_BAD_INPUT, "%s:%d: %s", xml->path, xml->line, what);
}

// The text `wanted` at or behind `from`.
static const char* find(const ruga_xml* xml, const char* from, const char* wanted) {
    size_t length = strlen(wanted);
    for (const char* p = from; (size_t)(xml->end - p) >= length; p++) {
        if (memcmp(p, wanted, length) == 0) {
            return p;
        }
    }
    return NULL;
}

static bool begins(const ruga_xml* xml, const char* text) {
    size_t length = strlen(text);
    return (size_t)(xml->end - xml->at) >= length && memcmp(xml->at, text, length) == 0;
}

// Goes behind a comment, a declaration, CDATA or a document type with its inner part; *skipped = there was
// one.
static ruga_status skip_special(ruga_xml* xml, bool* skipped) {
    static const char* const ends[][2] = {{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}};
    for (int i = 0; i < 3; i++) {
        if (begins(xml, ends[i][0])) {
            const char* end = find(xml, xml->at, ends[i][1]);
            *skipped = true;
            if (!end) {
                return fail(xml, "a comment or declaration does not end");
            }
            go_to(xml, end + strlen(ends[i][1]));
            return RUGA_OK;
        }
    }
    *skipped = begins(xml, "<!");
    int depth = 0;
    for (const char* p = xml->at; *skipped && p < xml->end; p++) {
        depth += (*p == '[') - (*p == ']');
        if (*p == '>' && depth == 0) {
            go_to(xml, p + 1);
            return RUGA_OK;
        }
    }
    return *skipped ? fail(xml, "the document type does not end") : RUGA_OK;
}

// The '>' of the tag at `from`, outside quotes.
static const char* tag_end(const ruga_xml* xml, const char* from) {
    char quote = 0;
    for (const char* p = from; p < xml->end; p++) {
        if (quote) {
            quote = *p == quote ? 0 : quote;
        } else if (*p == '"' || *p == '\'') {
            quote = *p;
        } else if (*p == '>') {
            return p;
        }
    }
    return NULL;
}

static void read_tag(ruga_xml* xml, const char* end) {
    const char* p = xml->at + 1;
    xml->closes = *p == '/';
    xml->opens = !xml->closes;
    p += xml->closes;
    const char* name = p;
    while (p < end && !is_blank(*p) && *p != '/') {
        name = *p == ':' ? p + 1 : name;
        p++;
    }
    xml->name = (ruga_slice){name, (size_t)(p - name)};
    xml->closes = xml->closes || end[-1] == '/';
    xml->attributes = (ruga_slice){p, (size_t)(end - p)};
}

ruga_status ruga_xml_next(ruga_xml* xml, bool* found) {
    *found = false;
    go_to(xml, xml->after);
    for (bool skipped = true; skipped;) {
        const char* open = memchr(xml->at, '<', (size_t)(xml->end - xml->at));
        if (!open) {
            go_to(xml, xml->end);
            return RUGA_OK;
        }
        go_to(xml, open);
        RUGA_TRY(skip_special(xml, &skipped));
    }
    const char* end = tag_end(xml, xml->at);
    if (!end || end == xml->at + 1) {
        return fail(xml, "a tag does not end");
    }
    read_tag(xml, end);
    xml->after = end + 1;
    *found = true;
    return RUGA_OK;
}

ruga_slice ruga_xml_attribute(const ruga_xml* xml, const char* name) {
    const char *p = xml->attributes.at, *end = p + xml->attributes.length;
    while (p < end) {
        while (p < end && (is_blank(*p) || *p == '/')) {
            p++;
        }
        const char* key = p;
        while (p < end && !is_blank(*p) && *p != '=') {
            p++;
        }
        ruga_slice own = {key, (size_t)(p - key)};
        while (p < end && (is_blank(*p) || *p == '=')) {
            p++;
        }
        if (p >= end || (*p != '"' && *p != '\'')) {
            continue; // an attribute without a value
        }
        char quote = *p++;
        const char* close = memchr(p, quote, (size_t)(end - p));
        close = close ? close : end;
        if (ruga_slice_is(own, name)) {
            return (ruga_slice){p, (size_t)(close - p)};
        }
        p = close + 1;
    }
    return (ruga_slice){NULL, 0};
}
