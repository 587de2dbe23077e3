// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L
#include "tests/files.h"

#include "core/vec3.h"

// 4 positions (0,0,0) (1,0,0) (0,1,0) (1,1,0), 4 uvs (the same x y), indices 0 1 2 3 as uint16: 88 bytes
static size_t gltf_bytes(char data[88]) {
    for (int v = 0; v < 4; v++) {
        float x = (float)(v % 2), y = (float)(v / 2);
        put_float(data + 12 * v, x);
        put_float(data + 12 * v + 4, y);
        put_float(data + 12 * v + 8, 0);
        put_float(data + 48 + 8 * v, x);
        put_float(data + 48 + 8 * v + 4, y);
        data[80 + 2 * v] = (char)v;
        data[80 + 2 * v + 1] = 0;
    }
    return 88;
}

static void encode_base64(const char* data, size_t size, char* text) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; k++) {
            bits = bits << 8 | (i + k < size ? (unsigned char)data[i + k] : 0);
        }
        for (size_t k = 0; k < 4; k++) {
            *text++ = i + k > size ? '=' : digits[bits >> (18 - 6 * k) & 63];
        }
    }
    *text = '\0';
}

static const char gltf_body[] =
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32},"
    "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":8}],"
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
    "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
    "{\"bufferView\":2,\"componentType\":5123,\"count\":4,\"type\":\"SCALAR\"}],"
    "\"meshes\":[{\"name\":\"strip\",\"primitives\":[{\"mode\":5,\"attributes\":{\"POSITION\":0,\"TEXCOORD_"
    "0\":1},"
    "\"indices\":2},{\"mode\":1,\"attributes\":{\"POSITION\":0}}]},"
    "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":6}]}],";
static const char gltf_nodes[] =
    "\"scene\":0,\"scenes\":[{\"nodes\":[0,3]}],\"nodes\":[{\"children\":[1,2],\"translation\":[10,0,0],"
    "\"scale\":[2,2,2]},{\"mesh\":0,\"rotation\":[0,0,0.70710678118654757,0.70710678118654757]},"
    "{\"mesh\":0,\"matrix\":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,5,0,1]},{\"mesh\":1}]";

static void assert_gltf_scene(const ruga_mesh* mesh) {
    // Instance one: x' = 10 + 2 (-y, x); two, mirrored: x' = 10 + 2 (-x, y + 5). The fan is flat: 0 1 2, 0
    // 2 3.
    assert_int_equal(mesh->vertex_count, 12);
    assert_int_equal(mesh->triangle_count, 6);
    assert_int_equal(mesh->group_count, 3);
    assert_string_equal(mesh->group_name[0], "strip.0");
    assert_string_equal(mesh->group_name[2], "mesh1");
    const double one[3] = {10, 2, 0}, two[3] = {8, 10, 0};
    assert_near(ruga_distance(mesh->position + 3, one), 0, 1e-12);
    assert_near(ruga_distance(mesh->position + 15, two), 0, 1e-12);
    for (int f = 0; f < 4; f++) {
        double n[3];
        ruga_mesh_triangle_normal(mesh, f, n);
        assert_near(n[2], 4, 1e-12);
    }
    assert_int_equal(mesh->uv_triangle[0], 0);
    assert_int_equal(mesh->uv_triangle[15], -1);
    assert_near(mesh->uv[2 * mesh->uv_triangle[1]], 1, 0);
}

static void gltf_scene_from_uri_file_and_glb(void** state) {
    (void)state;
    char data[88], base64[128], text[4096], glb[4096], other[300];
    size_t size = gltf_bytes(data);
    encode_base64(data, size, base64);
    ruga_mesh mesh;
    (void)snprintf(text, sizeof text,
                   "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":88,\"uri\":"
                   "\"data:application/octet-stream;base64,%s\"}],%s%s}",
                   base64, gltf_body, gltf_nodes);
    assert_ok(read_text("a.gltf", text, &mesh));
    assert_gltf_scene(&mesh);
    ruga_mesh_clear(&mesh);

    (void)snprintf(other, sizeof other, "%s", write_bytes("the buffer.bin", data, size));
    (void)snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":88,\"uri\":\"the%%20buffer.bin\"}],"
        "%s%s}",
        gltf_body, gltf_nodes);
    assert_ok(read_text("a.gltf", text, &mesh));
    assert_int_equal(unlink(other), 0);
    assert_gltf_scene(&mesh);
    ruga_mesh_clear(&mesh);

    int length = snprintf(text, sizeof text,
                          "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":88}],%s%s}",
                          gltf_body, gltf_nodes);
    memcpy(glb, "glTF", 4);
    put32(glb + 4, 2);
    put32(glb + 8, (uint32_t)(28 + length + 88));
    put32(glb + 12, (uint32_t)length);
    memcpy(glb + 16, "JSON", 4);
    memcpy(glb + 20, text, (size_t)length);
    put32(glb + 20 + length, 88);
    memcpy(glb + 24 + length, "BIN\0", 4);
    memcpy(glb + 28 + length, data, 88);
    assert_ok(read_bytes("a.glb", glb, (size_t)length + 28 + 88, &mesh));
    assert_gltf_scene(&mesh);
    ruga_mesh_clear(&mesh);
    assert_status(read_bytes("a.glb", glb, (size_t)length + 28 + 80, &mesh), RUGA_BAD_INPUT);
    assert_status(read_bytes("a.glb", glb, 15, &mesh), RUGA_BAD_INPUT);
}

static void gltf_that_cannot_be_read_says_why(void** state) {
    (void)state;
    static const struct {
        const char* json;
        const char* word;
    } bad[] = {
        {"{", "JSON"},
        {"[]", "object"},
        {"{}", "version"},
        {"{\"asset\":{\"version\":\"1.0\"}}", "1.0"},
        {"{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}",
         "KHR_draco_mesh_compression"},
        {"{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"EXT_meshopt_compression\"]}",
         "EXT_meshopt_compression"},
        {"{\"asset\":{\"version\":\"2.0\"}}", "no vertices"},
        {"{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[0]}]}",
         "itself"},
        {"{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[7]}],\"nodes\":[{}]}", "node"},
        {"{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":3}]}", "mesh"},
        {"{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":-1}}]}]"
         "}",
         "accessor"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"no.bin\",\"byteLength\":5}]}", "no.bin"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"data:;base64,AAAA\",\"byteLength\":50000}]"
         "}",
         "50000"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"data:;base64,A!AA\",\"byteLength\":3}]}",
         "base64"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"data:;base64,AAAA\",\"byteLength\":3}],"
         "\"bufferViews\":[{\"buffer\":0,\"byteLength\":3}],\"accessors\":[{\"bufferView\":0,"
         "\"componentType\":5126,"
         "\"count\":500000000,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":"
         "0}}]}]}",
         "beyond"},
        {"{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"sparse\":{},\"componentType\":5126,\"count\":3,"
         "\"type\":"
         "\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
         "sparse"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ruga_mesh mesh;
        ruga_status status = read_text("bad.gltf", bad[i].json, &mesh);
        if (!strstr(ruga_last_error(), bad[i].word) || !strstr(ruga_last_error(), "bad.gltf")) {
            print_error("%s: %s\n", bad[i].json, ruga_last_error());
            fail();
        }
        assert_true(status == RUGA_BAD_INPUT || (i == 11 && status == RUGA_IO));
    }
}

static void every_failed_allocation_is_a_status(void** state) {
    (void)state;
    char data[88], base64[128], gltf[4096];
    encode_base64(data, gltf_bytes(data), base64);
    (void)snprintf(gltf, sizeof gltf,
                   "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":88,\"uri\":\"data:;base64,%"
                   "s\"}],%s%s}",
                   base64, gltf_body, gltf_nodes);
    read_until_success(write_bytes("m.gltf", gltf, strlen(gltf)));
    assert_int_equal(unlink(in_folder("m.gltf")), 0);
}

static void real_gltf_with_draco_is_refused_by_name(void** state) {
    (void)state;
    const char* data = getenv("RUGA_DATA");
    char path[1024];
    (void)snprintf(path, sizeof path, "%s/surface/market_pillow.gltf",
                   data ? data : RUGA_SOURCE_DIR "/../shared/data");
    if (access(path, R_OK) != 0) {
        print_message("skipped: no real surfaces (set RUGA_DATA)\n");
        skip();
    }
    ruga_mesh mesh;
    assert_status(ruga_mesh_read(path, &mesh), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "KHR_draco_mesh_compression"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gltf_scene_from_uri_file_and_glb),
        cmocka_unit_test(gltf_that_cannot_be_read_says_why),
        cmocka_unit_test(every_failed_allocation_is_a_status),
        cmocka_unit_test(real_gltf_with_draco_is_refused_by_name),
    };
    return cmocka_run_group_tests_name("gltf", tests, make_folder, remove_folder);
}
