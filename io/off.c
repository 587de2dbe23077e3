// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// OFF as Geomview writes it: [ST][C][N][4]OFF, three counts, a line for each vertex (position, then normal,
// colour and texture coordinates where the header says so), a line for each face (count, corners, colour).
#include "io/mesh_file.h"
#include "io/polygons.h"
#include "io/text.h"

#include <limits.h>
#include <string.h>

typedef struct off_header {
    bool has_uv, has_normal;
    long long vertices, faces;
} off_header;

static ruga_status fail_word(ruga_text* text, const char* wanted) {
    char quoted[44];
    ruga_text_quote(text, quoted);
    return ruga_text_fail(text, "%s expected, found %s", wanted, quoted);
}

// The word that ends in OFF; a file may also begin with its counts.
static ruga_status read_keyword(ruga_text* text, off_header* header) {
    if (!ruga_text_skip_lines(text)) {
        return ruga_text_fail(text, "the file is empty");
    }
    long long count;
    ruga_text copy = *text;
    if (ruga_text_integer(&copy, 0, &count)) {
        return RUGA_OK;
    }
    size_t length;
    const char* word = ruga_text_word(&copy, &length);
    const char* end = word + length;
    if (length < 3 || memcmp(end - 3, "OFF", 3) != 0) {
        return fail_word(text, "OFF");
    }
    end -= 3;
    header->has_uv = end - word >= 2 && memcmp(word, "ST", 2) == 0;
    word += header->has_uv ? 2 : 0;
    word += word < end && *word == 'C';
    header->has_normal = word < end && *word == 'N';
    word += header->has_normal;
    if (word != end) {
        return fail_word(text, "OFF with vertices of three coordinates (OFF, COFF, NOFF, STOFF)");
    }
    text->at = copy.at;
    text->line = copy.line;
    if (ruga_text_take(text, "BINARY")) {
        return ruga_text_fail(text, "binary OFF cannot be read: save it as text, or as PLY");
    }
    return RUGA_OK;
}

static ruga_status read_counts(ruga_text* text, off_header* header) {
    long long* count[2] = {&header->vertices, &header->faces};
    for (int k = 0; k < 2; k++) {
        if (!ruga_text_skip_lines(text) || !ruga_text_integer(text, 0, count[k])) {
            return fail_word(text, "the numbers of vertices, faces and edges");
        }
        if (*count[k] < 0 || *count[k] > INT_MAX / 4) {
            return ruga_text_fail(text, "%lld is not a possible count", *count[k]);
        }
    }
    // The number of edges is not used, and some files leave it out.
    (void)ruga_text_next_line(text);
    return RUGA_OK;
}

// Texture coordinates are the last two numbers of the line, behind a colour of any length.
static ruga_status read_vertex_uv(ruga_text* text, ruga_polygons* polygons) {
    double number, last[2] = {0, 0};
    int count = 0;
    while (!ruga_text_line_ends(text)) {
        if (!ruga_text_double(text, &number)) {
            return fail_word(text, "a number");
        }
        last[0] = last[1];
        last[1] = number;
        count++;
    }
    return count >= 2 ? ruga_polygons_add_uv(polygons, last) : fail_word(text, "a texture coordinate");
}

static ruga_status read_vertex(ruga_text* text, const off_header* header, ruga_polygons* polygons) {
    double position[3], normal;
    for (int k = 0; k < 3; k++) {
        if (!ruga_text_double(text, &position[k])) {
            return fail_word(text, "a vertex's coordinate");
        }
    }
    for (int k = 0; header->has_normal && k < 3; k++) {
        if (!ruga_text_double(text, &normal)) {
            return fail_word(text, "a normal's coordinate");
        }
    }
    RUGA_TRY(ruga_polygons_add_vertex(polygons, position));
    return header->has_uv ? read_vertex_uv(text, polygons) : RUGA_OK;
}

static ruga_status read_face(ruga_text* text, const off_header* header, ruga_polygons* polygons) {
    long long count, vertex;
    if (!ruga_text_integer(text, 0, &count)) {
        return fail_word(text, "a face's number of corners");
    }
    if (count < 3 || count > RUGA_POLYGON_CORNERS) {
        return ruga_text_fail(text, "a face has %lld corners: 3 to %d are possible", count,
                              RUGA_POLYGON_CORNERS);
    }
    RUGA_TRY(ruga_polygons_add(polygons, text->line));
    for (long long i = 0; i < count; i++) {
        if (!ruga_text_integer(text, 0, &vertex)) {
            return fail_word(text, "a face's corner");
        }
        if (vertex < 0 || vertex >= polygons->vertex_count) {
            return ruga_text_fail(text, "vertex %lld does not exist: there are %d, counted from 0", vertex,
                                  polygons->vertex_count);
        }
        RUGA_TRY(ruga_polygons_add_corner(polygons, (int)vertex, header->has_uv ? (int)vertex : -1));
    }
    return RUGA_OK;
}

static ruga_status read_content(ruga_text* text, ruga_polygons* polygons) {
    off_header header = {0};
    RUGA_TRY(read_keyword(text, &header));
    RUGA_TRY(read_counts(text, &header));
    for (long long v = 0; v < header.vertices; v++) {
        if (!ruga_text_skip_lines(text)) {
            return ruga_text_fail(text, "the file ends after %lld of %lld vertices", v, header.vertices);
        }
        RUGA_TRY(read_vertex(text, &header, polygons));
        (void)ruga_text_next_line(text);
    }
    for (long long f = 0; f < header.faces; f++) {
        if (!ruga_text_skip_lines(text)) {
            return ruga_text_fail(text, "the file ends after %lld of %lld faces", f, header.faces);
        }
        RUGA_TRY(read_face(text, &header, polygons));
        (void)ruga_text_next_line(text);
    }
    return RUGA_OK;
}

ruga_status ruga_off_read(const char* path, ruga_mesh* mesh) {
    *mesh = (ruga_mesh){0};
    ruga_text text;
    ruga_polygons polygons;
    RUGA_TRY(ruga_text_open(path, &text));
    text.comments = true;
    ruga_polygons_begin(&polygons);
    ruga_status status = read_content(&text, &polygons);
    if (status == RUGA_OK) {
        status = ruga_polygons_finish(&polygons, path, mesh);
    }
    ruga_polygons_clear(&polygons);
    ruga_text_close(&text);
    return status;
}
