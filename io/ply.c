// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// PLY, text and binary of both byte orders. Used are the elements vertex (x y z, and s t, u v or
// texture_u texture_v) and face (vertex_indices or vertex_index, texcoord: u v of each corner, group). Any
// other single number of a vertex but its normal is an attribute of the mesh by its name; all other elements
// and properties are read over. Corners at the same vertex with equal texcoords share one uv. Groups, for
// which PLY has no word, are face property "group", a number into comments "ruga_group NAME".
#include "core/memory.h"
#include "io/bytes.h"
#include "io/mesh_file.h"
#include "io/polygons.h"
#include "io/text.h"
#include "io/writer.h"

#include <limits.h>
#include <math.h>
#include <string.h>

typedef enum scalar { INT8, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64, SCALARS } scalar;
static const int scalar_size[SCALARS] = {1, 1, 2, 2, 4, 4, 4, 8};
static const char* const scalar_name[SCALARS][2] = {
    {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
    {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};

typedef enum role { OTHER, X, Y, Z, S, T, CORNERS, TEXCOORD, GROUP, ATTRIBUTE } role;
typedef enum element_kind { SKIPPED, VERTEX, FACE } element_kind;
enum { MAXIMUM_ELEMENTS = 64, MAXIMUM_PROPERTIES = 256 };

typedef struct property {
    role role;
    bool list;
    scalar count_type, type;
    int attribute; // its number, where it is one
} property;

typedef struct element {
    element_kind kind;
    long long count;
    int first, property_count;
} element;

typedef struct reader {
    ruga_text text;
    ruga_polygons polygons;
    bool binary, big;
    int element_count, property_count;
    element element[MAXIMUM_ELEMENTS];
    property property[MAXIMUM_PROPERTIES];
    bool vertex_has_uv;
    int group_count, group_capacity;
    int* group; // number in polygons.names[0] of each group of the file
    int attribute_count, name_capacity, attribute_capacity;
    char** attribute_name;
    double* attribute; // [rows][attribute_count]
    int attribute_row; // vertices read
    // The row being read
    double value[GROUP + 1];
    int corner_count, corner_capacity, texcoord_count, texcoord_capacity;
    double* corner;
    double* texcoord;
    // uvs of a vertex: uv_head[vertex], then uv_next[uv]; -1 ends
    int* uv_head;
    int uv_next_capacity;
    int* uv_next;
} reader;

// -------------------------------------------------------------------------------------------- header

static ruga_status fail_word(ruga_text* text, const char* wanted) {
    char quoted[44];
    ruga_text_quote(text, quoted);
    return ruga_text_fail(text, "%s expected, found %s", wanted, quoted);
}

static bool same_word(const char* word, size_t length, const char* wanted) {
    return length == strlen(wanted) && memcmp(word, wanted, length) == 0;
}

static ruga_status read_format(reader* r) {
    if (ruga_text_take(&r->text, "ascii")) {
        r->binary = false;
    } else if (ruga_text_take(&r->text, "binary_little_endian")) {
        r->binary = true;
    } else if (ruga_text_take(&r->text, "binary_big_endian")) {
        r->binary = r->big = true;
    } else {
        return fail_word(&r->text, "ascii, binary_little_endian or binary_big_endian");
    }
    return RUGA_OK;
}

static ruga_status read_element(reader* r) {
    if (r->element_count == MAXIMUM_ELEMENTS) {
        return ruga_text_fail(&r->text, "more than %d elements", MAXIMUM_ELEMENTS);
    }
    element* e = &r->element[r->element_count];
    *e = (element){.first = r->property_count};
    if (ruga_text_take(&r->text, "tristrips")) {
        return ruga_text_fail(&r->text, "triangle strips cannot be read: save the mesh with faces");
    }
    size_t length;
    const char* name = ruga_text_word(&r->text, &length);
    e->kind = same_word(name, length, "vertex") ? VERTEX : same_word(name, length, "face") ? FACE : SKIPPED;
    for (int i = 0; i < r->element_count; i++) {
        if (e->kind != SKIPPED && r->element[i].kind == e->kind) {
            return ruga_text_fail(&r->text, "the element %.*s stands there twice", (int)length, name);
        }
    }
    if (!ruga_text_integer(&r->text, 0, &e->count)) {
        return fail_word(&r->text, "an element's count");
    }
    if (e->count < 0 || e->count > INT_MAX) {
        return ruga_text_fail(&r->text, "%lld is not a possible count", e->count);
    }
    r->element_count++;
    return RUGA_OK;
}

static ruga_status read_type(reader* r, scalar* type) {
    for (int t = 0; t < SCALARS; t++) {
        if (ruga_text_take(&r->text, scalar_name[t][0]) || ruga_text_take(&r->text, scalar_name[t][1])) {
            *type = (scalar)t;
            return RUGA_OK;
        }
    }
    return fail_word(&r->text, "a type (char, uchar, short, ushort, int, uint, float, double)");
}

static role find_role(element_kind kind, bool list, const char* name, size_t length) {
    static const struct {
        element_kind kind;
        bool list;
        const char* name;
        role role;
    } roles[] = {{VERTEX, false, "x", X},
                 {VERTEX, false, "y", Y},
                 {VERTEX, false, "z", Z},
                 {VERTEX, false, "s", S},
                 {VERTEX, false, "t", T},
                 {VERTEX, false, "u", S},
                 {VERTEX, false, "v", T},
                 {VERTEX, false, "texture_u", S},
                 {VERTEX, false, "texture_v", T},
                 {FACE, true, "vertex_indices", CORNERS},
                 {FACE, true, "vertex_index", CORNERS},
                 {FACE, true, "texcoord", TEXCOORD},
                 {FACE, false, "group", GROUP}};
    for (size_t i = 0; i < sizeof roles / sizeof *roles; i++) {
        if (roles[i].kind == kind && roles[i].list == list && same_word(name, length, roles[i].name)) {
            return roles[i].role;
        }
    }
    return OTHER;
}

static bool is_normal(const char* name, size_t length) {
    return length == 2 && name[0] == 'n' && name[1] >= 'x' && name[1] <= 'z';
}

static ruga_status name_attribute(reader* r, property* p, const char* name, size_t length) {
    RUGA_TRY(RUGA_RESERVE(r->attribute_name, r->name_capacity, r->attribute_count + 1));
    char* copy = NULL;
    RUGA_TRY(RUGA_NEW(copy, length + 1));
    memcpy(copy, name, length);
    copy[length] = '\0';
    p->role = ATTRIBUTE;
    p->attribute = r->attribute_count;
    r->attribute_name[r->attribute_count++] = copy;
    return RUGA_OK;
}

static ruga_status read_property(reader* r) {
    if (r->element_count == 0 || r->property_count == MAXIMUM_PROPERTIES) {
        return ruga_text_fail(&r->text, "a property before any element, or more than %d properties",
                              MAXIMUM_PROPERTIES);
    }
    element* e = &r->element[r->element_count - 1];
    property* p = &r->property[r->property_count];
    *p = (property){.list = ruga_text_take(&r->text, "list")};
    if (p->list) {
        RUGA_TRY(read_type(r, &p->count_type));
    }
    RUGA_TRY(read_type(r, &p->type));
    size_t length;
    const char* name = ruga_text_word(&r->text, &length);
    if (length == 0) {
        return fail_word(&r->text, "a property's name");
    }
    p->role = find_role(e->kind, p->list, name, length);
    if (e->kind == VERTEX && p->role == OTHER && !p->list && !is_normal(name, length)) {
        RUGA_TRY(name_attribute(r, p, name, length));
    }
    r->property_count++;
    e->property_count++;
    return RUGA_OK;
}

// Comments name groups in the order of their numbers.
static ruga_status read_comment(reader* r) {
    if (!ruga_text_take(&r->text, "ruga_group")) {
        return RUGA_OK;
    }
    size_t length;
    const char* name = ruga_text_rest(&r->text, &length);
    RUGA_TRY(ruga_polygons_set_group(&r->polygons, 0, name, length));
    RUGA_TRY(RUGA_RESERVE(r->group, r->group_capacity, r->group_count + 1));
    r->group[r->group_count++] = r->polygons.group[0];
    return RUGA_OK;
}

static ruga_status read_header_line(reader* r, bool* last) {
    ruga_text* text = &r->text;
    if (ruga_text_take(text, "end_header")) {
        *last = true;
        return RUGA_OK;
    }
    if (ruga_text_take(text, "format")) {
        return read_format(r);
    }
    if (ruga_text_take(text, "element")) {
        return read_element(r);
    }
    if (ruga_text_take(text, "property")) {
        return read_property(r);
    }
    if (ruga_text_take(text, "comment")) {
        return read_comment(r);
    }
    return ruga_text_take(text, "obj_info") || ruga_text_line_ends(text)
               ? RUGA_OK
               : fail_word(text, "format, element, property, comment or end_header");
}

static int count_role(const reader* r, const element* e, role wanted) {
    int count = 0;
    for (int i = e->first; i < e->first + e->property_count; i++) {
        count += r->property[i].role == wanted;
    }
    return count;
}

// What a header promises must fit into the bytes that are there: no count makes us allocate more.
static ruga_status check_element(const reader* r, const element* e) {
    static const char* const names[] = {"", "vertex", "face"};
    long long bytes = 0;
    for (int i = e->first; i < e->first + e->property_count; i++) {
        const property* p = &r->property[i];
        bytes += !r->binary ? 2 : scalar_size[p->list ? p->count_type : p->type];
    }
    bytes -= r->binary ? 0 : 1;
    long long left = (long long)(r->text.end - r->text.at) + 1;
    if (e->property_count > 0 && e->count > left / bytes) {
        return ruga_text_fail(&r->text, "%lld elements %s are promised, but only %lld bytes follow", e->count,
                              names[e->kind], left - 1);
    }
    if (e->kind == VERTEX &&
        (count_role(r, e, X) != 1 || count_role(r, e, Y) != 1 || count_role(r, e, Z) != 1)) {
        return ruga_text_fail(&r->text, "the element vertex needs the properties x, y and z, each once");
    }
    if (e->kind == FACE && count_role(r, e, CORNERS) != 1) {
        return ruga_text_fail(&r->text, "the element face needs one list vertex_indices");
    }
    return RUGA_OK;
}

static ruga_status read_header(reader* r) {
    if (!ruga_text_take(&r->text, "ply")) {
        return fail_word(&r->text, "ply");
    }
    for (bool last = false; !last;) {
        if (!ruga_text_next_line(&r->text)) {
            return ruga_text_fail(&r->text, "the file ends inside the header");
        }
        RUGA_TRY(read_header_line(r, &last));
    }
    (void)ruga_text_next_line(&r->text);
    r->polygons.group[0] = -1;
    for (int i = 0; i < r->element_count; i++) {
        const element* e = &r->element[i];
        RUGA_TRY(check_element(r, e));
        r->vertex_has_uv |= e->kind == VERTEX && count_role(r, e, S) == 1 && count_role(r, e, T) == 1;
    }
    return RUGA_OK;
}

// ---------------------------------------------------------------------------------------------- data

static ruga_status fail_data(const reader* r, const char* what) {
    return r->binary ? ruga_text_fail_at(&r->text, (size_t)(r->text.at - r->text.data), "%s", what)
                     : ruga_text_fail(&r->text, "%s", what);
}

static double decode(const char* at, scalar type, bool big) {
    uint64_t bits = ruga_bytes_unsigned(at, scalar_size[type], big);
    switch (type) {
    case INT8:
        return (double)((int64_t)(bits ^ 0x80u) - 0x80);
    case INT16:
        return (double)((int64_t)(bits ^ 0x8000u) - 0x8000);
    case INT32:
        return (double)((int64_t)(bits ^ 0x80000000u) - (int64_t)0x80000000u);
    case FLOAT32:
        return (double)ruga_bytes_f32(at, big);
    case FLOAT64:
        return ruga_bytes_f64(at, big);
    default:
        return (double)bits;
    }
}

static ruga_status read_scalar(reader* r, scalar type, double* value) {
    if (!r->binary) {
        return ruga_text_double(&r->text, value) ? RUGA_OK : fail_word(&r->text, "a number");
    }
    if (r->text.end - r->text.at < scalar_size[type]) {
        return fail_data(r, "the file ends inside its data");
    }
    *value = decode(r->text.at, type, r->big);
    r->text.at += scalar_size[type];
    return RUGA_OK;
}

static ruga_status read_list(reader* r, const property* p) {
    double count, value;
    RUGA_TRY(read_scalar(r, p->count_type, &count));
    if (!(count >= 0 && count <= INT_MAX / 4) || count != floor(count)) {
        return fail_data(r, "a list's length is not possible");
    }
    if (p->role == CORNERS && (count < 3 || count > RUGA_POLYGON_CORNERS)) {
        return fail_data(r, count < 3 ? "a face has fewer than 3 corners"
                                      : "a face has more than 20000 corners");
    }
    for (int i = 0; i < (int)count; i++) {
        RUGA_TRY(read_scalar(r, p->type, &value));
        if (p->role == CORNERS) {
            RUGA_TRY(RUGA_RESERVE(r->corner, r->corner_capacity, r->corner_count + 1));
            r->corner[r->corner_count++] = value;
        } else if (p->role == TEXCOORD) {
            RUGA_TRY(RUGA_RESERVE(r->texcoord, r->texcoord_capacity, r->texcoord_count + 1));
            r->texcoord[r->texcoord_count++] = value;
        }
    }
    return RUGA_OK;
}

static ruga_status store_vertex(reader* r) {
    const double position[3] = {r->value[X], r->value[Y], r->value[Z]}, uv[2] = {r->value[S], r->value[T]};
    RUGA_TRY(ruga_polygons_add_vertex(&r->polygons, position));
    r->attribute_row += r->attribute_count > 0;
    return r->vertex_has_uv ? ruga_polygons_add_uv(&r->polygons, uv) : RUGA_OK;
}

// The uv of a vertex with these values: an earlier one where there is one.
static ruga_status find_uv(reader* r, int vertex, const double uv[2], int* found) {
    ruga_polygons* polygons = &r->polygons;
    for (int i = r->uv_head[vertex]; i >= 0; i = r->uv_next[i]) {
        if (polygons->uv[i][0] == uv[0] && polygons->uv[i][1] == uv[1]) {
            *found = i;
            return RUGA_OK;
        }
    }
    *found = polygons->uv_count;
    RUGA_TRY(RUGA_RESERVE(r->uv_next, r->uv_next_capacity, (size_t)polygons->uv_count + 1));
    RUGA_TRY(ruga_polygons_add_uv(polygons, uv));
    r->uv_next[*found] = r->uv_head[vertex];
    r->uv_head[vertex] = *found;
    return RUGA_OK;
}

static ruga_status store_face(reader* r, long long vertex_count) {
    double group = r->value[GROUP];
    r->polygons.group[0] = group >= 0 && group < r->group_count ? r->group[(int)group] : -1;
    RUGA_TRY(ruga_polygons_add(&r->polygons, r->binary ? 0 : r->text.line));
    bool own_uv = r->uv_head && r->texcoord_count == 2 * r->corner_count;
    for (int i = 0; i < r->corner_count; i++) {
        double number = r->corner[i];
        if (!(number >= 0 && number < (double)vertex_count) || number != floor(number)) {
            return fail_data(r, "a face names a vertex that does not exist");
        }
        int vertex = (int)number, uv = r->vertex_has_uv ? vertex : -1;
        if (own_uv) {
            RUGA_TRY(find_uv(r, vertex, r->texcoord + 2 * (size_t)i, &uv));
        }
        RUGA_TRY(ruga_polygons_add_corner(&r->polygons, vertex, uv));
    }
    return RUGA_OK;
}

static double* attribute_value(const reader* r, const property* p) {
    return r->attribute + (size_t)r->attribute_row * (size_t)r->attribute_count + (size_t)p->attribute;
}

static ruga_status read_row(reader* r, const element* e, long long vertex_count) {
    r->corner_count = r->texcoord_count = 0;
    r->value[GROUP] = -1;
    if (!r->binary && !ruga_text_skip_lines(&r->text)) {
        return ruga_text_fail(&r->text, "the file ends inside its data");
    }
    if (e->kind == VERTEX) {
        RUGA_TRY(RUGA_RESERVE(r->attribute, r->attribute_capacity,
                              ((size_t)r->attribute_row + 1) * (size_t)r->attribute_count));
    }
    for (int i = e->first; i < e->first + e->property_count; i++) {
        const property* p = &r->property[i];
        double* value = p->role == ATTRIBUTE ? attribute_value(r, p) : &r->value[p->role];
        RUGA_TRY(p->list ? read_list(r, p) : read_scalar(r, p->type, value));
    }
    if (e->kind == VERTEX) {
        RUGA_TRY(store_vertex(r));
    } else if (e->kind == FACE) {
        RUGA_TRY(store_face(r, vertex_count));
    }
    if (!r->binary) {
        (void)ruga_text_next_line(&r->text);
    }
    return RUGA_OK;
}

static ruga_status prepare_corner_uvs(reader* r, long long vertex_count) {
    for (int i = 0; i < r->element_count; i++) {
        // Uvs of vertices are numbered like these: where both stand there, those of the vertices are used.
        if (!r->vertex_has_uv && r->element[i].kind == FACE && count_role(r, &r->element[i], TEXCOORD) == 1) {
            RUGA_TRY(RUGA_NEW(r->uv_head, vertex_count));
            memset(r->uv_head, 0xff, (size_t)vertex_count * sizeof *r->uv_head); // all -1
        }
    }
    return RUGA_OK;
}

static ruga_status read_content(reader* r) {
    RUGA_TRY(read_header(r));
    long long vertex_count = 0;
    for (int i = 0; i < r->element_count; i++) {
        vertex_count = r->element[i].kind == VERTEX ? r->element[i].count : vertex_count;
    }
    RUGA_TRY(prepare_corner_uvs(r, vertex_count));
    for (int i = 0; i < r->element_count; i++) {
        const element* e = &r->element[i];
        for (long long row = 0; e->property_count > 0 && row < e->count; row++) {
            RUGA_TRY(read_row(r, e, vertex_count));
        }
    }
    return RUGA_OK;
}

// The mesh has the file's vertices in the file's order.
static void give_attributes(reader* r, ruga_mesh* mesh) {
    RUGA_ASSERT(r->attribute_row == mesh->vertex_count);
    mesh->attribute_count = r->attribute_count;
    mesh->attribute_name = r->attribute_name;
    mesh->attribute = r->attribute;
    r->attribute_count = 0;
    r->attribute_name = NULL;
    r->attribute = NULL;
}

ruga_status ruga_ply_read(const char* path, ruga_mesh* mesh) {
    *mesh = (ruga_mesh){0};
    reader* r = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(r, 1));
    ruga_polygons_begin(&r->polygons);
    ruga_status status = ruga_text_open(path, &r->text);
    if (status == RUGA_OK) {
        status = read_content(r);
        if (status == RUGA_OK) {
            status = ruga_polygons_finish(&r->polygons, path, mesh);
        }
        if (status == RUGA_OK && r->attribute_count > 0) {
            give_attributes(r, mesh);
        }
        ruga_text_close(&r->text);
    }
    ruga_polygons_clear(&r->polygons);
    for (int a = 0; a < r->attribute_count; a++) {
        ruga_release(r->attribute_name[a]);
    }
    ruga_release(r->attribute_name);
    ruga_release(r->attribute);
    ruga_release(r->group);
    ruga_release(r->corner);
    ruga_release(r->texcoord);
    ruga_release(r->uv_head);
    ruga_release(r->uv_next);
    ruga_release(r);
    return status;
}

// ------------------------------------------------------------------------------------------- writing

static void put(ruga_writer* writer, uint64_t bits, int size) {
    char byte[8];
    for (int i = 0; i < size; i++) {
        byte[i] = (char)(bits >> (8 * i) & 0xff);
    }
    (void)fwrite(byte, 1, (size_t)size, writer->file);
}

static void put_doubles(ruga_writer* writer, const double* value, int count) {
    for (int i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &value[i], sizeof bits);
        put(writer, bits, 8);
    }
}

// How a mesh's uvs are written: number[v] = the one uv of vertex v, or NULL where a vertex has several or
// none.
static ruga_status find_vertex_uvs(const ruga_mesh* mesh, int** number) {
    *number = NULL;
    if (!mesh->uv || !mesh->uv_triangle) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_NEW(*number, mesh->vertex_count));
    memset(*number, 0xff, (size_t)mesh->vertex_count * sizeof **number); // all -1
    bool clear = true;
    for (size_t i = 0; clear && i < 3 * (size_t)mesh->triangle_count; i++) {
        int *known = *number + mesh->triangle[i], uv = mesh->uv_triangle[i];
        clear = uv >= 0 && (*known < 0 || *known == uv);
        *known = uv;
    }
    for (int v = 0; clear && v < mesh->vertex_count; v++) {
        clear = (*number)[v] >= 0;
    }
    if (!clear) {
        ruga_release(*number);
        *number = NULL;
    }
    return RUGA_OK;
}

static void write_header(ruga_writer* writer, const ruga_mesh* mesh, bool normals, bool vertex_uv,
                         bool face_uv, const char* comment) {
    FILE* file = writer->file;
    (void)fprintf(file, "ply\nformat binary_little_endian 1.0\n");
    ruga_writer_comment(writer, "comment ", comment);
    for (int g = 0; g < mesh->group_count; g++) {
        (void)fputs("comment ruga_group ", file);
        ruga_writer_name(writer, mesh->group_name[g]);
        (void)fputc('\n', file);
    }
    (void)fprintf(file, "element vertex %d\nproperty double x\nproperty double y\nproperty double z\n",
                  mesh->vertex_count);
    (void)fputs(normals ? "property double nx\nproperty double ny\nproperty double nz\n" : "", file);
    (void)fputs(vertex_uv ? "property double s\nproperty double t\n" : "", file);
    for (int a = 0; a < mesh->attribute_count; a++) {
        (void)fputs("property double ", file);
        ruga_writer_name(writer, mesh->attribute_name[a]);
        (void)fputc('\n', file);
    }
    (void)fprintf(file, "element face %d\nproperty list uchar int vertex_indices\n", mesh->triangle_count);
    (void)fputs(face_uv ? "property list uchar double texcoord\n" : "", file);
    (void)fputs(mesh->face_group ? "property int group\n" : "", file);
    (void)fputs("end_header\n", file);
}

static void write_faces(ruga_writer* writer, const ruga_mesh* mesh, bool face_uv) {
    for (size_t f = 0; f < (size_t)mesh->triangle_count; f++) {
        put(writer, 3, 1);
        for (size_t i = 0; i < 3; i++) {
            put(writer, (uint64_t)mesh->triangle[3 * f + i], 4);
        }
        if (face_uv) {
            const int* uv = mesh->uv_triangle + 3 * f;
            bool all = uv[0] >= 0 && uv[1] >= 0 && uv[2] >= 0;
            put(writer, all ? 6 : 0, 1);
            for (int i = 0; all && i < 3; i++) {
                put_doubles(writer, mesh->uv + 2 * (size_t)uv[i], 2);
            }
        }
        if (mesh->face_group) {
            put(writer, (uint64_t)(int64_t)mesh->face_group[f], 4);
        }
    }
}

ruga_status ruga_ply_write(const char* path, const ruga_mesh* mesh, const double* normals,
                           const char* comment) {
    int* vertex_uv = NULL;
    RUGA_TRY(find_vertex_uvs(mesh, &vertex_uv));
    bool face_uv = !vertex_uv && mesh->uv && mesh->uv_triangle;
    ruga_writer writer;
    ruga_status status = ruga_writer_open(path, &writer);
    if (status == RUGA_OK) {
        write_header(&writer, mesh, normals != NULL, vertex_uv != NULL, face_uv, comment);
        for (size_t v = 0; v < (size_t)mesh->vertex_count; v++) {
            put_doubles(&writer, mesh->position + 3 * v, 3);
            if (normals) {
                put_doubles(&writer, normals + 3 * v, 3);
            }
            if (vertex_uv) {
                put_doubles(&writer, mesh->uv + 2 * (size_t)vertex_uv[v], 2);
            }
            if (mesh->attribute_count > 0) {
                put_doubles(&writer, mesh->attribute + (size_t)mesh->attribute_count * v,
                            mesh->attribute_count);
            }
        }
        write_faces(&writer, mesh, face_uv);
        status = ruga_writer_close(&writer, RUGA_OK);
    }
    ruga_release(vertex_uv);
    return status;
}
