// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// STL, binary (80 bytes, a 32-bit count, 50 bytes a facet: normal and three corners as 32-bit floats, little
// endian, 2 bytes) or text. A file is binary where its length is just what its count says or its first 84
// bytes have a zero, whatever it begins with; else text where it begins with "solid". Corners at the same
// position become one vertex. Several named solids become groups.
#include "io/bytes.h"
#include "io/mesh_file.h"
#include "io/polygons.h"
#include "io/text.h"
#include "mesh/weld.h"

#include <limits.h>
#include <string.h>

enum { HEADER_BYTES = 84, FACET_BYTES = 50 };

static ruga_status add_facet(ruga_polygons* polygons, double corner[3][3], int line) {
    RUGA_TRY(ruga_polygons_add(polygons, line));
    for (int i = 0; i < 3; i++) {
        RUGA_TRY(ruga_polygons_add_corner(polygons, polygons->vertex_count, -1));
        RUGA_TRY(ruga_polygons_add_vertex(polygons, corner[i]));
    }
    return RUGA_OK;
}

static ruga_status read_binary(const ruga_text* text, ruga_polygons* polygons) {
    uint32_t count = ruga_bytes_u32(text->data + 80, false);
    size_t whole = (text->size - HEADER_BYTES) / FACET_BYTES;
    if (count > whole) {
        return ruga_text_fail_at(text, text->size, "the file ends after %zu of %u facets", whole, count);
    }
    if (count > INT_MAX / 3) {
        return ruga_text_fail_at(text, 80, "%u facets are too many: at most %d", count, INT_MAX / 3);
    }
    for (uint32_t f = 0; f < count; f++) {
        const char* facet = text->data + HEADER_BYTES + FACET_BYTES * (size_t)f + 12;
        double corner[3][3];
        for (int k = 0; k < 9; k++) {
            corner[k / 3][k % 3] = (double)ruga_bytes_f32(facet + 4 * k, false);
        }
        RUGA_TRY(add_facet(polygons, corner, 0));
    }
    return RUGA_OK;
}

static ruga_status take(ruga_text* text, const char* wanted) {
    if (!ruga_text_skip_lines(text)) {
        return ruga_text_fail(text, "the file ends where '%s' is expected", wanted);
    }
    if (!ruga_text_take(text, wanted)) {
        char quoted[44];
        ruga_text_quote(text, quoted);
        return ruga_text_fail(text, "'%s' expected, found %s", wanted, quoted);
    }
    return RUGA_OK;
}

// facet normal x y z, outer loop, three times vertex x y z, endloop, endfacet; "facet" is taken already.
static ruga_status read_facet(ruga_text* text, ruga_polygons* polygons) {
    double corner[3][3];
    int line = text->line;
    (void)ruga_text_next_line(text); // the normal follows from the corners
    RUGA_TRY(take(text, "outer"));
    RUGA_TRY(take(text, "loop"));
    for (int k = 0; k < 9; k++) {
        if (k % 3 == 0) {
            RUGA_TRY(take(text, "vertex"));
        }
        if (!ruga_text_double(text, &corner[k / 3][k % 3])) {
            char quoted[44];
            ruga_text_quote(text, quoted);
            return ruga_text_fail(text, "a vertex's coordinate expected, found %s", quoted);
        }
    }
    RUGA_TRY(take(text, "endloop"));
    RUGA_TRY(take(text, "endfacet"));
    return add_facet(polygons, corner, line);
}

static ruga_status read_solid(ruga_text* text, ruga_polygons* polygons) {
    size_t length;
    const char* name = ruga_text_rest(text, &length);
    RUGA_TRY(ruga_polygons_set_group(polygons, 0, name, length));
    for (;;) {
        if (!ruga_text_skip_lines(text)) {
            return ruga_text_fail(text, "the file ends where 'facet' or 'endsolid' is expected");
        }
        if (ruga_text_take(text, "endsolid")) {
            (void)ruga_text_next_line(text);
            return RUGA_OK;
        }
        RUGA_TRY(take(text, "facet"));
        RUGA_TRY(read_facet(text, polygons));
    }
}

static ruga_status read_content(ruga_text* text, ruga_polygons* polygons) {
    bool long_enough = text->size >= HEADER_BYTES;
    uint64_t promised =
        long_enough ? HEADER_BYTES + FACET_BYTES * (uint64_t)ruga_bytes_u32(text->data + 80, false) : 0;
    bool solid = text->size >= 5 && ruga_text_skip_lines(text) && ruga_text_take(text, "solid");
    if (long_enough && (promised == text->size || !solid || memchr(text->data, '\0', HEADER_BYTES))) {
        return read_binary(text, polygons);
    }
    if (!solid) {
        return ruga_text_fail_at(text, 0,
                                 "neither a text STL, which begins with 'solid', nor a binary one, which "
                                 "has at least %d bytes",
                                 HEADER_BYTES);
    }
    RUGA_TRY(read_solid(text, polygons));
    while (ruga_text_skip_lines(text)) {
        RUGA_TRY(take(text, "solid"));
        RUGA_TRY(read_solid(text, polygons));
    }
    return RUGA_OK;
}

ruga_status ruga_stl_read(const char* path, ruga_mesh* mesh) {
    *mesh = (ruga_mesh){0};
    ruga_text text;
    ruga_polygons polygons;
    RUGA_TRY(ruga_text_open(path, &text));
    ruga_polygons_begin(&polygons);
    ruga_status status = read_content(&text, &polygons);
    if (status == RUGA_OK && polygons.names[0].count < 2) {
        for (int p = 0; p < polygons.polygon_count; p++) {
            polygons.polygon[p].group[0] = -1; // the file's own title
        }
    }
    if (status == RUGA_OK) {
        status = ruga_polygons_finish(&polygons, path, mesh);
    }
    if (status == RUGA_OK) {
        status = ruga_mesh_weld(mesh, 0);
    }
    if (status != RUGA_OK) {
        ruga_mesh_clear(mesh);
    }
    ruga_polygons_clear(&polygons);
    ruga_text_close(&text);
    return status;
}
