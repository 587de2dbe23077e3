// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L
#include "tests/files.h"

#include "core/memory.h"
#include "core/random.h"
#include "core/vec3.h"
#include "io/triangulate.h"
#include "mesh/connectivity.h"
#include "mesh/make.h"

#include <locale.h>
#include <signal.h>
#include <sys/resource.h>

static void assert_triangles(const ruga_mesh* mesh, int count, const int* wanted) {
    assert_int_equal(mesh->triangle_count, count);
    assert_memory_equal(mesh->triangle, wanted, 3 * (size_t)count * sizeof(int));
}

// --------------------------------------------------------------------------------------------- OBJ

static void obj_forms_of_faces_agree(void** state) {
    (void)state;
    static const char text[] = "# a comment\r\n"
                               "mtllib none.mtl\r\n"
                               "v 0 0 0\r\nv 1 0 0 1.0\r\nv 0 1 0\r\n\tv 0 0 1e0 # a tail\r\n"
                               "vt 0 0\r\nvt 1 0\r\nvt 0 1 0\r\nvn 0 0 1\r\n"
                               "g first part\r\nf 1 2 3\r\nf 1/1 2/2 3/3\r\nf 1//1 2//1 3//1\r\n"
                               "g\r\nf 1/1/1 2/2/1 \\\r\n 3/3/1\r\n"
                               "g second\r\nf -4/-3 -3/-2 -2/-1\r\ns off\r\nl 1 2\r\n";
    ruga_mesh mesh;
    assert_ok(read_text("a.obj", text, &mesh));
    const int same[] = {0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2};
    const int uv[] = {-1, -1, -1, 0, 1, 2, -1, -1, -1, 0, 1, 2, 0, 1, 2};
    const int group[] = {0, 0, 0, -1, 1};
    assert_triangles(&mesh, 5, same);
    assert_int_equal(mesh.vertex_count, 4);
    assert_memory_equal(mesh.uv_triangle, uv, sizeof uv);
    assert_memory_equal(mesh.face_group, group, sizeof group);
    assert_string_equal(mesh.group_name[0], "first part");
    assert_string_equal(mesh.group_name[1], "second");
    assert_null(mesh.polygon);
    ruga_mesh_clear(&mesh);
}

static void obj_groups_are_those_of_g_else_o_else_usemtl(void** state) {
    (void)state;
    static const char head[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const char* const tails[] = {"o obj\nusemtl mat\ng grp\nf 1 2 3\n", "o obj\nusemtl mat\nf 1 2 3\n",
                                 "usemtl mat\nf 1 2 3\n"};
    const char* const wanted[] = {"grp", "obj", "mat"};
    for (int i = 0; i < 3; i++) {
        char text[200];
        ruga_mesh mesh;
        (void)snprintf(text, sizeof text, "%s%s", head, tails[i]);
        assert_ok(read_text("a.obj", text, &mesh));
        assert_int_equal(mesh.group_count, 1);
        assert_string_equal(mesh.group_name[0], wanted[i]);
        ruga_mesh_clear(&mesh);
    }
}

static void nan_and_awkward_numbers_are_read_exactly(void** state) {
    (void)state;
    static const char text[] = "v nan inf -1e400\nv 0.1 1234567890.123456789 -4.9406564584124654e-324\n"
                               "v .5 5. +1E-2\nv 123456789012345 1e22 1e23\nf 1 2 3\n";
    ruga_mesh mesh;
    assert_ok(read_text("a.obj", text, &mesh));
    const double wanted[] = {
        0.1, 1234567890.123456789, -4.9406564584124654e-324, .5, 5., 1e-2, 123456789012345, 1e22, 1e23};
    assert_true(isnan(mesh.position[0]) && isinf(mesh.position[1]) && isinf(mesh.position[2]));
    assert_memory_equal(mesh.position + 3, wanted, sizeof wanted);
    ruga_mesh_clear(&mesh);
}

// ---------------------------------------------------------------------------------------- polygons

static double signed_area(const double (*p)[3], const int* t) {
    double n[3];
    ruga_triangle_normal(p[t[0]], p[t[1]], p[t[2]], n);
    return n[2] / 2;
}

static void polygons_are_cut_without_overlap(void** state) {
    (void)state;
    // A comb: convex corners and reflex ones in turn, no fan fits.
    double comb[14][3] = {{0, 0, 0}, {6, 0, 0}, {6, 3, 0}, {5, 1, 0}, {4, 3, 0},
                          {3, 1, 0}, {2, 3, 0}, {1, 1, 0}, {0, 3, 0}};
    int cut[14][3];
    assert_ok(ruga_triangulate(9, (const double(*)[3])comb, cut));
    double area = 0;
    for (int i = 0; i < 7; i++) {
        double part = signed_area((const double(*)[3])comb, cut[i]);
        assert_true(part > 0);
        area += part;
    }
    assert_near(area, 12, 1e-14); // 6 x 1 and three teeth, 2 x 2 / 2 each, less nothing: 6 + 2 * 3 * 2 / 2
    // A quad with a reflex corner has one diagonal only; a plain one is cut along the shorter.
    const double arrow[4][3] = {{0, 0, 0}, {3, 0, 0}, {1, 1, 0}, {0, 3, 0}};
    assert_ok(ruga_triangulate(4, arrow, cut));
    assert_true(signed_area(arrow, cut[0]) > 0 && signed_area(arrow, cut[1]) > 0);
    const double kite[4][3] = {{-2, 0, 0}, {0, -1, 0}, {2, 0, 0}, {0, 1, 0}};
    assert_ok(ruga_triangulate(4, kite, cut));
    const int wanted[6] = {0, 1, 3, 1, 2, 3};
    assert_memory_equal(cut, wanted, sizeof wanted);
}

static void large_and_crossing_polygons_end(void** state) {
    (void)state;
    enum { N = 3000 };
    double(*point)[3] = malloc(N * sizeof *point);
    int(*cut)[3] = malloc(N * sizeof *cut);
    assert_true(point && cut);
    for (int i = 0; i < N; i++) { // a gear
        double angle = 2 * RUGA_PI * i / N, radius = i % 2 ? 1 : 0.8;
        point[i][0] = radius * cos(angle);
        point[i][1] = radius * sin(angle);
        point[i][2] = 0;
    }
    assert_ok(ruga_triangulate(N, (const double(*)[3])point, cut));
    double area = 0;
    for (int i = 0; i < N - 2; i++) {
        double part = signed_area((const double(*)[3])point, cut[i]);
        assert_true(part > 0);
        area += part;
    }
    assert_near(area, N / 2.0 * 0.8 * sin(2 * RUGA_PI / N), 1e-9);
    ruga_random random = {1};
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < 3; k++) {
            point[i][k] = ruga_random_uniform(&random);
        }
    }
    assert_ok(ruga_triangulate(N, (const double(*)[3])point, cut));
    memset(point, 0, N * sizeof *point);
    assert_ok(ruga_triangulate(N, (const double(*)[3])point, cut));
    point[7][1] = NAN;
    assert_ok(ruga_triangulate(N, (const double(*)[3])point, cut));
    free(point);
    free(cut);
}

static void polygons_are_remembered(void** state) {
    (void)state;
    ruga_mesh mesh;
    assert_ok(read_text("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 2 3 4\nf 2 5 3\n", &mesh));
    const int polygon[] = {0, 0, 1};
    assert_int_equal(mesh.triangle_count, 3);
    assert_memory_equal(mesh.polygon, polygon, sizeof polygon);
    ruga_mesh_clear(&mesh);
}

// ------------------------------------------------------------------------------- PLY, STL and OFF

static void ply_text_with_other_elements_and_uvs(void** state) {
    (void)state;
    static const char text[] =
        "ply\nformat ascii 1.0\ncomment hello\nobj_info 3\nelement camera 1\nproperty float f\n"
        "element vertex 4\nproperty uchar red\nproperty float x\nproperty double y\n"
        "property int z\nproperty float s\nproperty float t\n"
        "element face 2\nproperty list uchar float extra\n"
        "property list ushort uint vertex_index\nelement edge 1\nproperty int a\nend_header\n"
        "7.5\n255 0 0 0 0 0\n9 1 0 0 1 0\n9 1 1 0 1 1\n9 0 1 0 0 1\n"
        "2 0.5 0.5 4 0 1 2 3\n0 3 0 2 1\n5\n";
    ruga_mesh mesh;
    assert_ok(read_text("a.ply", text, &mesh));
    assert_int_equal(mesh.vertex_count, 4);
    assert_int_equal(mesh.triangle_count, 3);
    assert_int_equal(mesh.uv_count, 4);
    assert_memory_equal(mesh.uv_triangle, mesh.triangle, 9 * sizeof(int));
    assert_true(mesh.uv[2 * 2 + 1] == 1 && mesh.position[3 * 2 + 1] == 1);
    ruga_mesh_clear(&mesh);
}

static void ply_binary_of_both_byte_orders(void** state) {
    (void)state;
    static const char head[] = "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty float x\n"
                               "property short y\nproperty char z\nelement face 1\n"
                               "property list uint short vertex_indices\nend_header\n";
    // x = 1.5 (0x3fc00000), y = -2, z = -3 for each vertex
    static const unsigned char big_vertex[] = {0x3f, 0xc0, 0, 0, 0xff, 0xfe, 0xfd};
    static const unsigned char little_vertex[] = {0, 0, 0xc0, 0x3f, 0xfe, 0xff, 0xfd};
    static const unsigned char big_face[] = {0, 0, 0, 3, 0, 0, 0, 2, 0, 1};
    static const unsigned char little_face[] = {3, 0, 0, 0, 0, 0, 2, 0, 1, 0};
    for (int big = 0; big < 2; big++) {
        char file[512];
        int size = snprintf(file, sizeof file, head, big ? "big" : "little");
        for (int v = 0; v < 3; v++) {
            memcpy(file + size, big ? big_vertex : little_vertex, 7);
            size += 7;
        }
        memcpy(file + size, big ? big_face : little_face, 10);
        ruga_mesh mesh;
        assert_ok(read_bytes("a.ply", file, (size_t)size + 10, &mesh));
        const int triangle[] = {0, 2, 1};
        assert_triangles(&mesh, 1, triangle);
        for (int v = 0; v < 3; v++) {
            assert_true(mesh.position[3 * v] == 1.5 && mesh.position[3 * v + 1] == -2);
            assert_true(mesh.position[3 * v + 2] == -3);
        }
        ruga_mesh_clear(&mesh);
    }
}

static size_t binary_stl(char file[512]) {
    static const float p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const int t[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    memset(file, ' ', 80);
    memcpy(file, "solid facet", 11);
    put32(file + 80, 4);
    for (int f = 0; f < 4; f++) {
        char* facet = file + 84 + 50 * f;
        memset(facet, 0, 50);
        for (int k = 0; k < 9; k++) {
            put_float(facet + 12 + 4 * k, p[t[f][k / 3]][k % 3]);
        }
    }
    return 84 + 4 * 50;
}

static void stl_binary_is_known_by_its_length_and_welded(void** state) {
    (void)state;
    char file[512];
    size_t size = binary_stl(file);
    for (int i = 0; i < 3; i++) { // as it is, with another title, with bytes behind it
        ruga_mesh mesh;
        memset(file + 300, 0, 100);
        memcpy(file, i == 1 ? "title" : "solid", 5);
        assert_ok(read_bytes("a.stl", file, i == 2 ? size + 10 : size, &mesh));
        const int wanted[] = {0, 1, 2, 0, 2, 3, 2, 1, 3, 1, 0, 3};
        assert_int_equal(mesh.vertex_count, 4);
        assert_triangles(&mesh, 4, wanted);
        ruga_mesh_clear(&mesh);
    }
}

static void stl_text_with_two_solids_has_groups(void** state) {
    (void)state;
    static const char text[] =
        "solid one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n"
        "  endloop\n endfacet\nendsolid one\n\nsolid two\nfacet normal 0 0 1 outer loop\nouter loop vertex 1 "
        "0 0 vertex "
        "1 1 0 vertex 0 1 0 endloop endfacet\nendsolid\n";
    ruga_mesh mesh;
    assert_ok(read_text("a.stl", text, &mesh));
    const int wanted[] = {0, 1, 2, 1, 3, 2};
    assert_int_equal(mesh.vertex_count, 4);
    assert_triangles(&mesh, 2, wanted);
    assert_int_equal(mesh.group_count, 2);
    assert_string_equal(mesh.group_name[1], "two");
    ruga_mesh_clear(&mesh);
}

static void off_headers_are_understood(void** state) {
    (void)state;
    const char* const texts[] = {
        "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 1.0 0.5 0.5\n",
        "OFF 4 1 0 # counts\n# comment\n\n0 0 0\n1 0 0 # first\n1 1 0\n0 1 0\n4 0 1 2 3\n",
        "4 1\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
        "COFF\n4 1 0\n0 0 0 9 9 9 255\n1 0 0 1 1 1\n1 1 0 255 0 0 255\n0 1 0 1 1 1\n4 0 1 2 3\n",
        "NOFF\r\n4 1 0\r\n0 0 0 0 0 1\r\n1 0 0 0 0 1\r\n1 1 0 0 0 1\r\n0 1 0 0 0 1\r\n4 0 1 2 3\r\n",
        "STCNOFF\n4 1 0\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 1 1 0\n1 1 0 0 0 1 1 1 1 1 1 1\n"
        "0 1 0 0 0 1 1 1 1 1 0 1\n4 0 1 2 3\n"};
    for (int i = 0; i < 6; i++) {
        ruga_mesh mesh;
        assert_ok(read_text("a.off", texts[i], &mesh));
        const int wanted[] = {0, 1, 2, 0, 2, 3};
        assert_int_equal(mesh.vertex_count, 4);
        assert_triangles(&mesh, 2, wanted);
        assert_true(mesh.position[6] == 1 && mesh.position[7] == 1);
        assert_int_equal(mesh.uv_count, i == 5 ? 4 : 0);
        assert_true(i != 5 || (mesh.uv[4] == 1 && mesh.uv[6] == 0 && mesh.uv[7] == 1));
        ruga_mesh_clear(&mesh);
    }
}

// --------------------------------------------------------------------------------------- malformed

#define PLY_HEAD                                                                                             \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define PLY_FACE     "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
#define PLY_VERTICES "0 0 0\n1 0 0\n0 1 0\n"

static void malformed_text_ends_in_a_sentence_with_its_line(void** state) {
    (void)state;
    static const struct {
        const char* name;
        const char* text;
        const char* word; // in the sentence
    } bad[] = {
        {"e.obj", "", "no vertices"},
        {"e.obj", "hello world\nthis is no mesh\n", "no vertices"},
        {"e.obj", "v 0 0\n", "e.obj:1"},
        {"e.obj", "v 0 0 abc\n", "'abc'"},
        {"e.obj", "v 0 0 1,5\n", "'1,5'"},
        {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2\n", "e.obj:5"},
        {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "e.obj:4"},
        {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "e.obj:4"},
        {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", "-4"},
        {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n", "e.obj:4"},
        {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n", "uv"},
        {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/ 2/ 3/\n", "e.obj:4"},
        {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n", "'x'"},
        {"e.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//a 2 3\n", "e.obj:4"},
        {"e.off", "", "empty"},
        {"e.off", "OFX\n3 1 0\n", "'OFX'"},
        {"e.off", "OFF BINARY\n", "binary"},
        {"e.off", "4OFF\n3 1 0\n", "three coordinates"},
        {"e.off", "OFF\n3 -1 0\n", "-1"},
        {"e.off", "OFF\n2000000000 1 0\n0 0 0\n", "2000000000"},
        {"e.off", "OFF\n400000000 1 0\n0 0 0\n", "ends after 1"},
        {"e.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "e.off:6"},
        {"e.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "e.off:6"},
        {"e.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "2 corners"},
        {"e.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2000000000 0 1\n", "2000000000"},
        {"e.stl", "", "byte 0"},
        {"e.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", "e.stl:4"},
        {"e.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "ends"},
        {"e.stl", "solid x\nfacet normal 0 0 1\nouter hoop\n", "'hoop'"},
        {"e.stl", "solid x\nendsolid\n", "no vertices"},
        {"e.ply", "", "ply"},
        {"e.ply", "ply\nformat ascii 1.0\n", "header"},
        {"e.ply", "ply\nformat utf8 1.0\n", "'utf8'"},
        {"e.ply", "ply\nnonsense\n", "e.ply:2"},
        {"e.ply", "ply\nproperty float x\n", "before any element"},
        {"e.ply", "ply\nelement vertex x\n", "e.ply:2"},
        {"e.ply", "ply\nelement vertex 99999999999\n", "99999999999"},
        {"e.ply", "ply\nelement vertex 3\nproperty quad x\n", "'quad'"},
        {"e.ply", "ply\nelement vertex 1\nelement vertex 1\n", "twice"},
        {"e.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "x, y and z"},
        {"e.ply",
         "ply\nformat ascii 1.0\nelement vertex 2000000000\nproperty float x\nproperty float y\n"
         "property float z\nend_header\n0 0 0\n",
         "2000000000"},
        {"e.ply",
         "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
         "property float z\nend_header\nxx",
         "promised"},
        {"e.ply", PLY_HEAD PLY_FACE PLY_VERTICES, "ends inside"},
        {"e.ply", PLY_HEAD PLY_FACE PLY_VERTICES "          \n", "ends inside"},
        {"e.ply", PLY_HEAD PLY_FACE PLY_VERTICES "3 0 1 3\n", "e.ply:13"},
        {"e.ply", PLY_HEAD PLY_FACE PLY_VERTICES "3 0 1\n", "e.ply:13"},
        {"e.ply", PLY_HEAD PLY_FACE PLY_VERTICES "3 0 1 1.5\n", "e.ply:13"},
        {"e.ply", PLY_HEAD PLY_FACE PLY_VERTICES "3 0 1 nan\n", "e.ply:13"},
        {"e.ply", PLY_HEAD PLY_FACE PLY_VERTICES "2 0 1\n", "fewer"},
        {"e.ply", PLY_HEAD PLY_FACE PLY_VERTICES "-1 0 1\n", "e.ply:13"},
        {"e.ply", PLY_HEAD PLY_FACE "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "e.ply:11"},
        {"e.ply", PLY_HEAD "element tristrips 1\n", "strips"},
        {"e.txt", "v 0 0 0\n", "read from"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ruga_mesh mesh;
        ruga_status status = read_text(bad[i].name, bad[i].text, &mesh);
        if (status != RUGA_BAD_INPUT || !strstr(ruga_last_error(), bad[i].word) ||
            !strstr(ruga_last_error(), bad[i].name)) {
            print_error("case %zu: %s: status %d: %s\n", i, bad[i].text, status, ruga_last_error());
            fail();
        }
        assert_null(mesh.position);
    }
    ruga_mesh mesh;
    assert_status(ruga_mesh_read("no_such_file.obj", &mesh), RUGA_IO);
    assert_status(ruga_mesh_read(in_folder("nowhere/a.ply"), &mesh), RUGA_IO);
}

static void random_bytes_never_crash_a_reader(void** state) {
    (void)state;
    static const char* const names[] = {"r.obj", "r.ply", "r.stl", "r.off", "r.gltf", "r.glb"};
    ruga_random random = {7};
    char data[3000], stl[512];
    size_t stl_size = binary_stl(stl);
    for (int i = 0; i < 240; i++) {
        for (size_t k = 0; k < sizeof data; k++) {
            data[k] = (char)ruga_random_next(&random);
        }
        // Half of them begin as files do.
        static const char ply[] =
            "ply\nformat binary_big_endian 1.0\nelement vertex 9\nproperty float x\nproperty "
            "float y\nproperty float z\nelement face 9\nproperty list int int vertex_indices\n"
            "end_header\n";
        if (i % 2 == 0) {
            if (i % 6 == 0) {
                memcpy(data, "glTF\2\0\0\0", 8);
            } else if (i % 6 == 2) {
                memcpy(data, stl, stl_size);
                data[82] = (char)ruga_random_next(&random);
            } else {
                memcpy(data, ply, sizeof ply - 1);
            }
        }
        for (int f = 0; f < 6; f++) {
            ruga_mesh mesh;
            ruga_status status = read_bytes(names[f], data, sizeof data - (size_t)(i % 7), &mesh);
            assert_true(status == RUGA_OK || status == RUGA_BAD_INPUT);
            if (status == RUGA_OK) {
                ruga_mesh_clear(&mesh);
            }
        }
    }
}

static void truncated_files_never_crash_a_reader(void** state) {
    (void)state;
    const ruga_make_def def = {.shape = RUGA_SHAPE_SPHERE, .size = {1}, .edge = 0.5};
    ruga_mesh mesh;
    assert_ok(ruga_mesh_make(&def, &mesh));
    const char* path = in_folder("whole.ply");
    assert_ok(ruga_mesh_write(path, &mesh, NULL, NULL));
    ruga_mesh_clear(&mesh);
    static char data[100000];
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(data, 1, sizeof data, file);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(unlink(path), 0);
    for (size_t n = 0; n < size; n += 1 + size / 150) {
        assert_status(read_bytes("part.ply", data, n, &mesh), RUGA_BAD_INPUT);
    }
}

// --------------------------------------------------------------------------------- writing and real

// A pillow with uvs of a seam, two groups, one face in none and one corner without uv.
static void make_rich_mesh(ruga_mesh* mesh, bool every_corner_has_uv) {
    const ruga_make_def def = {.shape = RUGA_SHAPE_PILLOW, .size = {0.5}, .edge = 0.1};
    assert_ok(ruga_mesh_make(&def, mesh));
    ruga_random random = {3};
    for (int i = 0; i < 3 * mesh->vertex_count; i++) {
        mesh->position[i] += 1e-3 * ruga_random_uniform(&random);
    }
    mesh->uv_count = 2 * mesh->vertex_count;
    assert_ok(RUGA_NEW(mesh->uv, 2 * mesh->uv_count));
    assert_ok(RUGA_NEW(mesh->uv_triangle, 3 * mesh->triangle_count));
    assert_ok(RUGA_NEW(mesh->face_group, mesh->triangle_count));
    assert_ok(RUGA_NEW_ZERO(mesh->group_name, 2));
    mesh->group_count = 2;
    mesh->group_name[0] = ruga_copy_string("top half");
    mesh->group_name[1] = ruga_copy_string("bottom");
    for (int i = 0; i < 2 * mesh->uv_count; i++) {
        mesh->uv[i] = ruga_random_uniform(&random);
    }
    for (int f = 0; f < mesh->triangle_count; f++) {
        bool second = f >= mesh->triangle_count / 2;
        mesh->face_group[f] = second;
        for (int i = 3 * f; i < 3 * f + 3; i++) {
            mesh->uv_triangle[i] = mesh->triangle[i] + (second ? mesh->vertex_count : 0);
        }
    }
    mesh->face_group[3] = -1;
    for (int i = 0; i < 3 && !every_corner_has_uv; i++) {
        mesh->uv_triangle[15 + i] = -1;
    }
}

static void assert_same_mesh(const ruga_mesh* a, const ruga_mesh* b) {
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->position, b->position, 3 * (size_t)a->vertex_count * sizeof(double));
    assert_memory_equal(a->triangle, b->triangle, 3 * (size_t)a->triangle_count * sizeof(int));
    for (int i = 0; i < 3 * a->triangle_count; i++) {
        int p = a->uv_triangle[i], q = b->uv_triangle[i];
        assert_int_equal(p < 0, q < 0);
        assert_true(p < 0 || memcmp(a->uv + 2 * p, b->uv + 2 * q, 2 * sizeof(double)) == 0);
    }
    for (int f = 0; f < a->triangle_count; f++) {
        int p = a->face_group[f], q = b->face_group[f];
        assert_int_equal(p < 0, q < 0);
        if (p >= 0) {
            assert_string_equal(a->group_name[p], b->group_name[q]);
        }
    }
}

static void obj_and_ply_come_back_as_they_were(void** state) {
    (void)state;
    static const char* const names[] = {"b.obj", "b.ply"};
    for (int i = 0; i < 8; i++) {
        ruga_mesh mesh, back;
        make_rich_mesh(&mesh, i & 2);
        double* normal = NULL;
        assert_ok(RUGA_NEW(normal, 3 * mesh.vertex_count));
        ruga_mesh_vertex_normals(&mesh, mesh.position, normal);
        const char* path = in_folder(names[i & 1]);
        assert_ok(ruga_mesh_write(path, &mesh, i & 4 ? normal : NULL, "two\nlines"));
        assert_ok(ruga_mesh_read(path, &back));
        assert_int_equal(unlink(path), 0);
        assert_same_mesh(&mesh, &back);
        // Seams stay: each uv is still shared by the same faces.
        assert_true(back.uv_count <= mesh.uv_count);
        ruga_release(normal);
        ruga_mesh_clear(&mesh);
        ruga_mesh_clear(&back);
    }
}

static void one_uv_per_vertex_stays_one(void** state) {
    (void)state;
    ruga_mesh mesh, back;
    make_rich_mesh(&mesh, true);
    memcpy(mesh.uv_triangle, mesh.triangle, 3 * (size_t)mesh.triangle_count * sizeof(int));
    const char* path = in_folder("b.ply");
    assert_ok(ruga_mesh_write(path, &mesh, NULL, NULL));
    assert_ok(ruga_mesh_read(path, &back));
    assert_int_equal(unlink(path), 0);
    assert_same_mesh(&mesh, &back);
    assert_int_equal(back.uv_count, mesh.vertex_count);
    ruga_mesh_clear(&mesh);
    ruga_mesh_clear(&back);
}

static void a_full_disk_is_an_error_and_leaves_nothing(void** state) {
    (void)state;
    const ruga_make_def def = {.shape = RUGA_SHAPE_SHEET, .size = {1, 1}, .edge = 0.02};
    ruga_mesh mesh;
    assert_ok(ruga_mesh_make(&def, &mesh));
    struct rlimit old, small = {10000, RLIM_INFINITY};
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    small.rlim_max = old.rlim_max;
    (void)signal(SIGXFSZ, SIG_IGN);
    static const char* const names[] = {"full.obj", "full.ply"};
    for (int i = 0; i < 2; i++) {
        const char* path = in_folder(names[i]);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
        ruga_status status = ruga_mesh_write(path, &mesh, NULL, NULL);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
        assert_int_equal(status, RUGA_IO);
        assert_int_not_equal(access(path, F_OK), 0);
    }
    (void)signal(SIGXFSZ, SIG_DFL);
    assert_status(ruga_mesh_write(in_folder("nowhere/a.obj"), &mesh, NULL, NULL), RUGA_IO);
    assert_status(ruga_mesh_write(in_folder("a.stl"), &mesh, NULL, NULL), RUGA_BAD_INPUT);
    ruga_mesh_clear(&mesh);
}

static void numbers_do_not_depend_on_the_locale(void** state) {
    (void)state;
    static const char* const locales[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "nb_NO.UTF-8"};
    const char* found = NULL;
    for (int i = 0; i < 4 && !found; i++) {
        found = setlocale(LC_NUMERIC, locales[i]);
    }
    if (!found) {
        print_message("skipped: no locale with a decimal comma is installed\n");
        skip();
    }
    ruga_mesh mesh;
    ruga_status status = read_text("a.obj", "v 0.12345678901234567 0.5 1.5e-30\n", &mesh);
    (void)setlocale(LC_NUMERIC, "C");
    assert_ok(status);
    assert_true(mesh.position[0] == 0.12345678901234567 && mesh.position[2] == 1.5e-30);
    ruga_mesh_clear(&mesh);
}

// ------------------------------------------------------------------------------ failing allocations

static void every_failed_allocation_is_a_status(void** state) {
    (void)state;
    static const char obj[] =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0 0\nvt 0 0\ng a\nf 1 2 3\ng b\nf 1/1 2/1 3/1 4/1 5/1\n";
    static const char off[] = "STOFF\n3 1 0\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
    char stl[512];
    size_t stl_size = binary_stl(stl);
    read_until_success(write_bytes("m.obj", obj, strlen(obj)));
    read_until_success(write_bytes("m.off", off, strlen(off)));
    read_until_success(write_bytes("m.stl", stl, stl_size));
    ruga_mesh mesh;
    make_rich_mesh(&mesh, false);
    assert_ok(ruga_mesh_write(in_folder("m.ply"), &mesh, NULL, NULL));
    ruga_mesh_clear(&mesh);
    read_until_success(in_folder("m.ply"));
    static const char* const names[] = {"m.obj", "m.off", "m.stl", "m.ply"};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(unlink(in_folder(names[i])), 0);
    }
}

// ---------------------------------------------------------------------------------------- real files

static void real_surfaces_have_their_counts(void** state) {
    (void)state;
    static const struct {
        const char* name;
        int vertices, polygons, groups; // groups -1: not told
        bool closed;
    } known[] = {{"makehuman_base.obj", 19158, 18486, -1, false},
                 {"makehuman_head_watertight.obj", 4579, 4598, 0, true},
                 {"market_pillow_watertight.obj", 20272, 40540, 0, true},
                 {"market_sofa_watertight.obj", 5434, 10832, 9, true},
                 {"sh3d_teddyBear_body_watertight.obj", 6818, 6816, 0, true},
                 {"spot_low_resolution.obj", 829, 1654, 0, true},
                 {"spot_control_mesh.obj", 188, 180, 0, true},
                 {"makehuman_skirt.obj", 720, 684, 0, false},
                 {"makehuman_sportsuit01.obj", 1797, 1718, -1, false},
                 {"sh3d_blanket.obj", 17689, 17424, 0, false},
                 {"ipc_mat40x40.obj", 3200, 6396, 0, true},
                 {"ipc_sheet2000.obj", 1769, 3360, 0, false}};
    const char* data = getenv("RUGA_DATA");
    int read = 0;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        char path[1024];
        (void)snprintf(path, sizeof path, "%s/surface/%s", data ? data : RUGA_SOURCE_DIR "/../shared/data",
                       known[i].name);
        if (access(path, R_OK) != 0) {
            continue;
        }
        ruga_mesh mesh;
        assert_ok(ruga_mesh_read(path, &mesh));
        read++;
        int polygons = mesh.polygon ? mesh.polygon[mesh.triangle_count - 1] + 1 : mesh.triangle_count;
        assert_int_equal(mesh.vertex_count, known[i].vertices);
        assert_int_equal(polygons, known[i].polygons);
        assert_true(known[i].groups < 0 || mesh.group_count == known[i].groups);
        ruga_connectivity c;
        if (known[i].closed) {
            assert_ok(ruga_connectivity_create(&mesh, &c));
            assert_int_equal(2 * c.edge_count, 3 * c.triangle_count);
            ruga_connectivity_clear(&c);
        }
        ruga_mesh_clear(&mesh);
    }
    if (read == 0) {
        print_message("skipped: no real surfaces (set RUGA_DATA)\n");
        skip();
    }
    print_message("%d real surfaces\n", read);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(obj_forms_of_faces_agree),
        cmocka_unit_test(obj_groups_are_those_of_g_else_o_else_usemtl),
        cmocka_unit_test(nan_and_awkward_numbers_are_read_exactly),
        cmocka_unit_test(polygons_are_cut_without_overlap),
        cmocka_unit_test(large_and_crossing_polygons_end),
        cmocka_unit_test(polygons_are_remembered),
        cmocka_unit_test(ply_text_with_other_elements_and_uvs),
        cmocka_unit_test(ply_binary_of_both_byte_orders),
        cmocka_unit_test(stl_binary_is_known_by_its_length_and_welded),
        cmocka_unit_test(stl_text_with_two_solids_has_groups),
        cmocka_unit_test(off_headers_are_understood),
        cmocka_unit_test(malformed_text_ends_in_a_sentence_with_its_line),
        cmocka_unit_test(random_bytes_never_crash_a_reader),
        cmocka_unit_test(truncated_files_never_crash_a_reader),
        cmocka_unit_test(obj_and_ply_come_back_as_they_were),
        cmocka_unit_test(one_uv_per_vertex_stays_one),
        cmocka_unit_test(a_full_disk_is_an_error_and_leaves_nothing),
        cmocka_unit_test(numbers_do_not_depend_on_the_locale),
        cmocka_unit_test(every_failed_allocation_is_a_status),
        cmocka_unit_test(real_surfaces_have_their_counts),
    };
    return cmocka_run_group_tests_name("mesh_file", tests, make_folder, remove_folder);
}
