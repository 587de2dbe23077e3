// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// glTF 2.0, .gltf (buffers in data URIs or files beside it) and .glb: the triangles of the scene's meshes
// under the transforms of their nodes (x_world = M_root ... M_node x, column-major matrices or translation,
// rotation, scale). Triangles, strips and fans; a mirroring transform flips them. Each primitive is a group,
// named after its mesh. Vertices within 1e-9 of the model's size become one, while uvs stay those of each
// primitive. Materials, skins, morph targets and animations are not read.
#include "io/bytes.h"
#include "io/gltf_buffer.h"
#include "io/mesh_file.h"
#include "io/polygons.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/weld.h"

#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

enum { MAXIMUM_DEPTH = 256 };
static const double WELD_DISTANCE = 1e-9; // of the diagonal
static const double MAXIMUM_CORNERS = 150e6;

typedef struct transform {
    double linear[9]; // row by row
    double offset[3];
} transform;

typedef struct reader {
    const char* path;
    ruga_gltf_buffers buffers;
    json_t* root; // borrowed from buffers
    ruga_polygons polygons;
} reader;

static ruga_status fail(const reader* r, const char* what) {
    return ruga_fail(RUGA_BAD_INPUT, "%s: %s", r->path, what);
}

// --------------------------------------------------------------------------------------- accessors

// Numbers of an accessor, in place.
typedef struct accessor {
    const char* data;
    long long count;
    size_t stride;
    int type, width; // component type, components
    bool normalized;
} accessor;

static int component_size(long long type) {
    switch (type) {
    case 5120: // byte
    case 5121: // unsigned byte
        return 1;
    case 5122: // short
    case 5123: // unsigned short
        return 2;
    case 5125: // unsigned int
    case 5126: // float
        return 4;
    default:
        return 0;
    }
}

static int component_count(const char* type) {
    static const char* const names[] = {"SCALAR", "VEC2", "VEC3"};
    for (int i = 0; type && i < 3; i++) {
        if (strcmp(type, names[i]) == 0) {
            return i + 1;
        }
    }
    return 0;
}

static ruga_status open_accessor(const reader* r, const json_t* index, int width, accessor* a) {
    const json_t* json = json_is_integer(index) ? json_array_get(json_object_get(r->root, "accessors"),
                                                                 (size_t)json_integer_value(index))
                                                : NULL;
    if (!json) {
        return fail(r, "a primitive names an accessor that does not exist");
    }
    if (json_object_get(json, "sparse")) {
        return fail(r, "sparse accessors cannot be read: export the mesh without them");
    }
    long long type = json_integer_value(json_object_get(json, "componentType"));
    a->count = json_integer_value(json_object_get(json, "count"));
    a->type = (int)type;
    a->width = component_count(json_string_value(json_object_get(json, "type")));
    a->normalized = json_is_true(json_object_get(json, "normalized"));
    int size = component_size(type);
    if (size == 0 || a->width != width || a->count < 1 || a->count > INT_MAX / 4) {
        return fail(r, "an accessor's type, componentType or count is not what its use needs");
    }
    const json_t* view = json_object_get(json, "bufferView");
    long long offset = json_integer_value(json_object_get(json, "byteOffset"));
    size_t element = (size_t)(size * width), length;
    RUGA_TRY(ruga_gltf_view(&r->buffers, view, &a->data, &length, &a->stride));
    a->stride = a->stride ? a->stride : element;
    // count <= 2^29 and stride <= 2^31: no overflow.
    if (offset < 0 || (uint64_t)offset > length || element > length - (size_t)offset ||
        (uint64_t)(a->count - 1) * a->stride > length - (size_t)offset - element) {
        return fail(r, "an accessor reaches beyond the end of its buffer view");
    }
    a->data += offset;
    return RUGA_OK;
}

static double accessor_value(const accessor* a, long long element, int component) {
    const char* at =
        a->data + (size_t)element * a->stride + (size_t)component * (size_t)component_size(a->type);
    if (a->type == 5126) {
        return (double)ruga_bytes_f32(at, false);
    }
    int size = component_size(a->type);
    bool is_signed = a->type == 5120 || a->type == 5122;
    int64_t half = (int64_t)1 << (8 * size - 1);
    int64_t value = (int64_t)ruga_bytes_unsigned(at, size, false);
    value = is_signed && value >= half ? value - 2 * half : value;
    if (!a->normalized) {
        return (double)value;
    }
    return is_signed ? fmax((double)value / (double)(half - 1), -1) : (double)value / (double)(2 * half - 1);
}

// -------------------------------------------------------------------------------------- primitives

// Corners 3 k + i of triangle k: places in the list of a primitive's vertices. Every other triangle of a
// strip runs the other way.
static long long corner_place(long long mode, long long k, int i) {
    switch (mode) {
    case 5: // strip
        return k + (k % 2 == 1 && i > 0 ? 3 - i : i);
    case 6: // fan
        return i == 0 ? 0 : k + i;
    default:
        return 3 * k + i;
    }
}

static ruga_status primitive_index(const reader* r, const accessor* indices, long long place, long long count,
                                   int* vertex) {
    long long index = indices ? (long long)accessor_value(indices, place, 0) : place;
    if (index < 0 || index >= count) {
        return fail(r, "an index of a primitive names a vertex that does not exist");
    }
    *vertex = (int)index;
    return RUGA_OK;
}

static ruga_status add_triangles(reader* r, long long mode, const accessor* indices, long long vertex_count,
                                 int first, bool has_uv, bool flip) {
    long long listed = indices ? indices->count : vertex_count;
    long long triangles = mode == 4 ? listed / 3 : listed - 2;
    if (3.0 * (double)triangles + r->polygons.corner_count > MAXIMUM_CORNERS) {
        return fail(r, "more than 50 million triangles");
    }
    for (long long k = 0; k < triangles; k++) {
        int v[3];
        for (int i = 0; i < 3; i++) {
            RUGA_TRY(primitive_index(r, indices, corner_place(mode, k, i), vertex_count, &v[i]));
        }
        if (mode == 5 && (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])) {
            continue; // a stitch between strips
        }
        RUGA_TRY(ruga_polygons_add(&r->polygons, 0));
        for (int i = 0; i < 3; i++) {
            int vertex = first + v[flip && i > 0 ? 3 - i : i];
            RUGA_TRY(ruga_polygons_add_corner(&r->polygons, vertex, has_uv ? vertex : -1));
        }
    }
    return RUGA_OK;
}

static ruga_status add_vertices(reader* r, const accessor* position, const accessor* uv, const transform* t) {
    if ((double)position->count + r->polygons.vertex_count > MAXIMUM_CORNERS) {
        return fail(r, "more than 150 million vertices");
    }
    for (long long v = 0; v < position->count; v++) {
        double local[3], world[3];
        // Vertices without uv take their places among the uvs too, so that both are numbered alike.
        double st[2] = {0, 0};
        for (int k = 0; k < 3; k++) {
            local[k] = accessor_value(position, v, k);
        }
        for (int k = 0; uv && k < 2; k++) {
            st[k] = accessor_value(uv, v, k);
        }
        ruga_multiply3(t->linear, local, world);
        ruga_add_scaled(1, t->offset, world);
        RUGA_TRY(ruga_polygons_add_vertex(&r->polygons, world));
        RUGA_TRY(ruga_polygons_add_uv(&r->polygons, st));
    }
    return RUGA_OK;
}

static double determinant(const double m[9]) {
    double n[3];
    ruga_cross(m, m + 3, n);
    return ruga_dot(n, m + 6);
}

static bool is_compressed(const json_t* primitive, const json_t* attributes, const reader* r) {
    const json_t* extension =
        json_object_get(json_object_get(primitive, "extensions"), "KHR_draco_mesh_compression");
    const json_t* accessor_json =
        json_array_get(json_object_get(r->root, "accessors"),
                       (size_t)json_integer_value(json_object_get(attributes, "POSITION")));
    return extension && !json_object_get(accessor_json, "bufferView");
}

static ruga_status add_primitive(reader* r, const json_t* primitive, const transform* t) {
    const json_t* attributes = json_object_get(primitive, "attributes");
    const json_t* mode_json = json_object_get(primitive, "mode");
    long long mode = mode_json ? json_integer_value(mode_json) : 4;
    if (mode < 4 || mode > 6) {
        return RUGA_OK; // points and lines
    }
    if (is_compressed(primitive, attributes, r)) {
        return fail(
            r, "the mesh is compressed by the extension KHR_draco_mesh_compression, which cannot be read: "
               "export it without compression");
    }
    accessor position, uv, indices;
    RUGA_TRY(open_accessor(r, json_object_get(attributes, "POSITION"), 3, &position));
    const json_t* uv_json = json_object_get(attributes, "TEXCOORD_0");
    if (uv_json) {
        RUGA_TRY(open_accessor(r, uv_json, 2, &uv));
        if (uv.count != position.count) {
            return fail(r, "TEXCOORD_0 and POSITION of a primitive differ in count");
        }
    }
    const json_t* indices_json = json_object_get(primitive, "indices");
    if (indices_json) {
        RUGA_TRY(open_accessor(r, indices_json, 1, &indices));
        if (indices.type == 5126) {
            return fail(r, "indices of a primitive are not whole numbers");
        }
    }
    int first = r->polygons.vertex_count;
    RUGA_TRY(add_vertices(r, &position, uv_json ? &uv : NULL, t));
    return add_triangles(r, mode, indices_json ? &indices : NULL, position.count, first, uv_json != NULL,
                         determinant(t->linear) < 0);
}

// "mesh", with ".k" for one of several primitives and "#n" for another instance.
static ruga_status name_group(reader* r, const char* mesh_name, size_t index, size_t primitive,
                              bool several) {
    char name[256];
    int length = mesh_name && *mesh_name ? snprintf(name, 192, "%s", mesh_name)
                                         : snprintf(name, 192, "mesh%zu", index);
    length = length > 191 ? 191 : length;
    if (several) {
        length += snprintf(name + length, sizeof name - (size_t)length, ".%zu", primitive);
    }
    int known = r->polygons.names[0].count;
    RUGA_TRY(ruga_polygons_set_group(&r->polygons, 0, name, (size_t)length));
    for (int n = known + 1; r->polygons.names[0].count == known; n++) {
        // Numbered by the groups so far, so that thousands of instances need no search.
        int more = snprintf(name + length, sizeof name - (size_t)length, "#%d", n);
        RUGA_TRY(ruga_polygons_set_group(&r->polygons, 0, name, (size_t)(length + more)));
    }
    return RUGA_OK;
}

static ruga_status add_mesh(reader* r, const json_t* index, const transform* t) {
    size_t number = (size_t)json_integer_value(index);
    const json_t* mesh =
        json_is_integer(index) ? json_array_get(json_object_get(r->root, "meshes"), number) : NULL;
    if (!mesh) {
        return fail(r, "a node names a mesh that does not exist");
    }
    const json_t* primitives = json_object_get(mesh, "primitives");
    size_t count = json_array_size(primitives);
    for (size_t i = 0; i < count; i++) {
        RUGA_TRY(name_group(r, json_string_value(json_object_get(mesh, "name")), number, i, count > 1));
        RUGA_TRY(add_primitive(r, json_array_get(primitives, i), t));
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------------------- nodes

static ruga_status read_numbers(const reader* r, const json_t* array, size_t count, double* value) {
    if (!array) {
        return RUGA_OK; // the default stays
    }
    for (size_t i = 0; i < count; i++) {
        const json_t* number = json_array_get(array, i);
        if (json_array_size(array) != count || !json_is_number(number)) {
            return fail(
                r, "a node's matrix, translation, rotation or scale is not made of 16, 3, 4 or 3 numbers");
        }
        value[i] = json_number_value(number);
    }
    return RUGA_OK;
}

static void rotation_matrix(const double q[4], double m[9]) {
    double x = q[0], y = q[1], z = q[2], w = q[3];
    const double rows[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                            2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                            2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
    memcpy(m, rows, sizeof rows);
}

static ruga_status node_transform(const reader* r, const json_t* node, transform* t) {
    const json_t* matrix_json = json_object_get(node, "matrix");
    double matrix[16] = {0}, q[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
    *t = (transform){0};
    if (matrix_json) {
        RUGA_TRY(read_numbers(r, matrix_json, 16, matrix));
        for (int i = 0; i < 9; i++) {
            t->linear[i] = matrix[4 * (i % 3) + i / 3];
        }
        memcpy(t->offset, matrix + 12, sizeof t->offset);
        return RUGA_OK;
    }
    RUGA_TRY(read_numbers(r, json_object_get(node, "translation"), 3, t->offset));
    RUGA_TRY(read_numbers(r, json_object_get(node, "rotation"), 4, q));
    RUGA_TRY(read_numbers(r, json_object_get(node, "scale"), 3, scale));
    rotation_matrix(q, t->linear);
    for (int i = 0; i < 9; i++) {
        t->linear[i] *= scale[i % 3];
    }
    return RUGA_OK;
}

// a b: first b, then a
static transform compose(const transform* a, const transform* b) {
    transform ab = {.offset = {a->offset[0], a->offset[1], a->offset[2]}};
    for (int i = 0; i < 9; i++) {
        for (int k = 0; k < 3; k++) {
            ab.linear[i] += a->linear[i / 3 * 3 + k] * b->linear[3 * k + i % 3];
        }
    }
    double moved[3];
    ruga_multiply3(a->linear, b->offset, moved);
    ruga_add_scaled(1, moved, ab.offset);
    return ab;
}

// Each node hangs below one other at most, so that a node met twice (visited[]) is a fault, a cycle included.
static ruga_status add_node(reader* r, const json_t* index, const transform* parent, int depth,
                            bool* visited) {
    const json_t* nodes = json_object_get(r->root, "nodes");
    long long number = json_is_integer(index) ? json_integer_value(index) : -1;
    if (number < 0 || (uint64_t)number >= json_array_size(nodes)) {
        return fail(r, "a scene or node names a node that does not exist");
    }
    if (visited[number] || depth > MAXIMUM_DEPTH) {
        return fail(r, "a node hangs below two others or below itself, or deeper than 256 levels");
    }
    visited[number] = true;
    const json_t* node = json_array_get(nodes, (size_t)number);
    transform local;
    RUGA_TRY(node_transform(r, node, &local));
    transform world = compose(parent, &local);
    const json_t* mesh = json_object_get(node, "mesh");
    if (mesh) {
        RUGA_TRY(add_mesh(r, mesh, &world));
    }
    const json_t* children = json_object_get(node, "children");
    for (size_t i = 0; i < json_array_size(children); i++) {
        RUGA_TRY(add_node(r, json_array_get(children, i), &world, depth + 1, visited));
    }
    return RUGA_OK;
}

static const transform identity = {.linear = {1, 0, 0, 0, 1, 0, 0, 0, 1}};

// The scene's nodes; of a file without scenes every mesh once, as it is.
static ruga_status add_scene(reader* r, bool* visited) {
    const json_t* scenes = json_object_get(r->root, "scenes");
    const json_t* scene =
        json_array_get(scenes, (size_t)json_integer_value(json_object_get(r->root, "scene")));
    if (json_array_size(scenes) > 0 && !scene) {
        return fail(r, "the scene to show does not exist");
    }
    const json_t* roots = json_object_get(scene, "nodes");
    for (size_t i = 0; i < json_array_size(roots); i++) {
        RUGA_TRY(add_node(r, json_array_get(roots, i), &identity, 0, visited));
    }
    size_t meshes = scene ? 0 : json_array_size(json_object_get(r->root, "meshes"));
    for (size_t i = 0; i < meshes; i++) {
        json_t* index = json_integer((json_int_t)i);
        ruga_status status =
            index ? add_mesh(r, index, &identity) : ruga_fail(RUGA_NO_MEMORY, "out of memory");
        json_decref(index);
        RUGA_TRY(status);
    }
    return RUGA_OK;
}

// Extensions that change no geometry, or that are read.
static bool is_harmless(const char* extension) {
    static const char* const prefixes[] = {"KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_",
                                           "KHR_mesh_quantization"};
    for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
        if (strncmp(extension, prefixes[i], strlen(prefixes[i])) == 0) {
            return true;
        }
    }
    return false;
}

static ruga_status check_asset(const reader* r) {
    const char* version = json_string_value(json_object_get(json_object_get(r->root, "asset"), "version"));
    if (!version || version[0] != '2') {
        return ruga_fail(RUGA_BAD_INPUT, "%s: glTF version %.16s cannot be read, only 2.0", r->path,
                         version ? version : "(none)");
    }
    const json_t* required = json_object_get(r->root, "extensionsRequired");
    for (size_t i = 0; i < json_array_size(required); i++) {
        const char* name = json_string_value(json_array_get(required, i));
        if (!name || !is_harmless(name)) {
            return ruga_fail(
                RUGA_BAD_INPUT,
                "%s: the file needs the extension %.64s, which cannot be read: export it without", r->path,
                name ? name : "(not a name)");
        }
    }
    return RUGA_OK;
}

static ruga_status read_content(reader* r, ruga_mesh* mesh) {
    RUGA_TRY(ruga_gltf_open(r->path, &r->buffers));
    r->root = r->buffers.root;
    RUGA_TRY(check_asset(r));
    bool* visited = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(visited, json_array_size(json_object_get(r->root, "nodes"))));
    ruga_status status = add_scene(r, visited);
    ruga_release(visited);
    RUGA_TRY(status);
    RUGA_TRY(ruga_polygons_finish(&r->polygons, r->path, mesh));
    double min[3], max[3];
    ruga_mesh_bounds(mesh, min, max);
    return ruga_mesh_weld(mesh, WELD_DISTANCE * ruga_distance(min, max));
}

ruga_status ruga_gltf_read(const char* path, ruga_mesh* mesh) {
    *mesh = (ruga_mesh){0};
    reader r = {.path = path};
    ruga_polygons_begin(&r.polygons);
    ruga_status status = read_content(&r, mesh);
    if (status != RUGA_OK) {
        ruga_mesh_clear(mesh);
    }
    ruga_polygons_clear(&r.polygons);
    ruga_gltf_close(&r.buffers);
    return status;
}
