// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Wavefront OBJ: v, vt and f (v, v/vt, v//vn, v/vt/vn, counted from 1 or, negative, from the last one so
// far), g, o, usemtl; the rest is skipped. Groups are those of g, else of o, else of usemtl: all that follows
// the word is one name.
#include "io/mesh_file.h"
#include "io/polygons.h"
#include "io/text.h"
#include "io/writer.h"

#include <limits.h>

static ruga_status fail_word(ruga_text* text, const char* wanted) {
    char quoted[44];
    ruga_text_quote(text, quoted);
    return ruga_text_fail(text, "%s expected, found %s", wanted, quoted);
}

static ruga_status read_vertex(ruga_text* text, ruga_polygons* polygons) {
    double position[3];
    for (int k = 0; k < 3; k++) {
        if (!ruga_text_double(text, &position[k])) {
            return fail_word(text, "a vertex's coordinate");
        }
    }
    return ruga_polygons_add_vertex(polygons, position);
}

static ruga_status read_uv(ruga_text* text, ruga_polygons* polygons) {
    double uv[2] = {0, 0};
    if (!ruga_text_double(text, &uv[0]) || (!ruga_text_line_ends(text) && !ruga_text_double(text, &uv[1]))) {
        return fail_word(text, "a texture coordinate");
    }
    return ruga_polygons_add_uv(polygons, uv);
}

// *index from 0. A positive one may name what only follows: that is checked at the end.
static ruga_status resolve_index(ruga_text* text, long long written, int count, const char* what,
                                 int* index) {
    if (written == 0 || written > INT_MAX || written < -(long long)count) {
        return ruga_text_fail(text,
                              "%s %lld does not exist: %d are known here, counted from 1 or back from -1",
                              what, written, count);
    }
    *index = (int)(written > 0 ? written - 1 : count + written);
    return RUGA_OK;
}

static ruga_status read_corner(ruga_text* text, ruga_polygons* polygons) {
    long long written;
    int vertex = -1, uv = -1;
    if (!ruga_text_integer(text, '/', &written)) {
        return fail_word(text, "a face's corner (v, v/vt, v//vn or v/vt/vn)");
    }
    RUGA_TRY(resolve_index(text, written, polygons->vertex_count, "vertex", &vertex));
    if (*text->at == '/') {
        text->at++;
        if (*text->at != '/') {
            if (!ruga_text_integer(text, '/', &written)) {
                return fail_word(text, "a texture coordinate's number");
            }
            RUGA_TRY(resolve_index(text, written, polygons->uv_count, "texture coordinate", &uv));
        }
        if (*text->at == '/') {
            text->at++;
            if (!ruga_text_integer(text, 0, &written)) {
                return fail_word(text, "a normal's number");
            }
        }
    }
    return ruga_polygons_add_corner(polygons, vertex, uv);
}

static ruga_status read_face(ruga_text* text, ruga_polygons* polygons) {
    RUGA_TRY(ruga_polygons_add(polygons, text->line));
    while (!ruga_text_line_ends(text)) {
        RUGA_TRY(read_corner(text, polygons));
    }
    int corners = polygons->corner_count - polygons->polygon[polygons->polygon_count - 1].first;
    if (corners < 3) {
        return ruga_text_fail(text, "a face needs at least 3 corners, found %d", corners);
    }
    return RUGA_OK;
}

static ruga_status read_group(ruga_text* text, ruga_polygons* polygons, int kind) {
    size_t length;
    const char* name = ruga_text_rest(text, &length);
    return ruga_polygons_set_group(polygons, kind, name, length);
}

static ruga_status read_statement(ruga_text* text, ruga_polygons* polygons) {
    if (ruga_text_take(text, "v")) {
        return read_vertex(text, polygons);
    }
    if (ruga_text_take(text, "f")) {
        return read_face(text, polygons);
    }
    if (ruga_text_take(text, "vt")) {
        return read_uv(text, polygons);
    }
    static const char* const words[RUGA_GROUP_KINDS] = {"g", "o", "usemtl"};
    for (int kind = 0; kind < RUGA_GROUP_KINDS; kind++) {
        if (ruga_text_take(text, words[kind])) {
            return read_group(text, polygons, kind);
        }
    }
    if (*text->at == '\0' && text->at < text->end) {
        return ruga_text_fail(text, "a zero byte: this is not an OBJ text file");
    }
    return RUGA_OK;
}

static ruga_status read_statements(ruga_text* text, ruga_polygons* polygons) {
    while (ruga_text_skip_lines(text)) {
        RUGA_TRY(read_statement(text, polygons));
        (void)ruga_text_next_line(text);
    }
    return RUGA_OK;
}

ruga_status ruga_obj_read(const char* path, ruga_mesh* mesh) {
    *mesh = (ruga_mesh){0};
    ruga_text text;
    ruga_polygons polygons;
    RUGA_TRY(ruga_text_open(path, &text));
    text.comments = text.continued = true;
    ruga_polygons_begin(&polygons);
    ruga_status status = read_statements(&text, &polygons);
    if (status == RUGA_OK) {
        status = ruga_polygons_finish(&polygons, path, mesh);
    }
    ruga_polygons_clear(&polygons);
    ruga_text_close(&text);
    return status;
}

// ------------------------------------------------------------------------------------------ writing

static void write_points(ruga_writer* writer, const char* word, const double* value, int count, int width) {
    for (size_t v = 0; v < (size_t)count; v++) {
        (void)fputs(word, writer->file);
        for (size_t k = 0; k < (size_t)width; k++) {
            ruga_writer_double(writer, value[(size_t)width * v + k]);
        }
        (void)fputc('\n', writer->file);
    }
}

static void write_group(ruga_writer* writer, const ruga_mesh* mesh, int group) {
    (void)fputs(group >= 0 ? "g " : "g", writer->file);
    ruga_writer_name(writer, group >= 0 ? mesh->group_name[group] : "");
    (void)fputc('\n', writer->file);
}

static void write_face(ruga_writer* writer, const ruga_mesh* mesh, size_t f, bool normals) {
    const int* t = mesh->triangle + 3 * f;
    const int* uv = mesh->uv && mesh->uv_triangle ? mesh->uv_triangle + 3 * f : NULL;
    // All corners of a face have the same form.
    bool has_uv = uv && uv[0] >= 0 && uv[1] >= 0 && uv[2] >= 0;
    (void)fputc('f', writer->file);
    for (int i = 0; i < 3; i++) {
        (void)fprintf(writer->file, " %d", t[i] + 1);
        if (has_uv) {
            (void)fprintf(writer->file, "/%d", uv[i] + 1);
        }
        if (normals) {
            (void)fprintf(writer->file, has_uv ? "/%d" : "//%d", t[i] + 1);
        }
    }
    (void)fputc('\n', writer->file);
}

static void write_faces(ruga_writer* writer, const ruga_mesh* mesh, bool normals) {
    int group = -1;
    for (int f = 0; f < mesh->triangle_count; f++) {
        if (mesh->face_group && mesh->face_group[f] != group) {
            group = mesh->face_group[f];
            write_group(writer, mesh, group);
        }
        write_face(writer, mesh, (size_t)f, normals);
    }
}

ruga_status ruga_obj_write(const char* path, const ruga_mesh* mesh, const double* normals,
                           const char* comment) {
    ruga_writer writer;
    RUGA_TRY(ruga_writer_open(path, &writer));
    ruga_writer_comment(&writer, "# ", comment);
    write_points(&writer, "v", mesh->position, mesh->vertex_count, 3);
    if (mesh->uv && mesh->uv_triangle) {
        write_points(&writer, "vt", mesh->uv, mesh->uv_count, 2);
    }
    if (normals) {
        write_points(&writer, "vn", normals, mesh->vertex_count, 3);
    }
    write_faces(&writer, mesh, normals != NULL);
    return ruga_writer_close(&writer, RUGA_OK);
}
