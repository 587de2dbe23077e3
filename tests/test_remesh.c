// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Remeshing: the wanted edge and near-equilateral faces on made shapes, features kept, uvs and groups carried
// over, refusals.
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/cgal_shim.h"
#include "mesh/doctor.h"
#include "mesh/remesh.h"

#include <stdlib.h>
#include <string.h>

// ---- shapes, simple and bad on purpose: long thin quads cut along one diagonal

static ruga_mesh new_grid(int m, int n) {
    ruga_mesh mesh = {.vertex_count = (m + 1) * (n + 1), .triangle_count = 2 * m * n};
    assert_ok(RUGA_NEW(mesh.position, 3 * mesh.vertex_count));
    assert_ok(RUGA_NEW(mesh.triangle, 3 * mesh.triangle_count));
    int* t = mesh.triangle;
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < m; i++) {
            int a = j * (m + 1) + i;
            int b = a + m + 1;
            const int two[6] = {a, a + 1, b + 1, a, b + 1, b};
            memcpy(t, two, sizeof two);
            t += 6;
        }
    }
    return mesh;
}

// x from 0 to 2, y from 0 to 1
static ruga_mesh sheet(int m, int n) {
    ruga_mesh mesh = new_grid(m, n);
    for (int v = 0; v < mesh.vertex_count; v++) {
        mesh.position[3 * v] = 2.0 * (v % (m + 1)) / m;
        mesh.position[3 * v + 1] = 1.0 * (v / (m + 1)) / n;
        mesh.position[3 * v + 2] = 0;
    }
    return mesh;
}

// A torus, radii 1 and 0.4, closed: the grid's last row and column are its first.
static ruga_mesh torus(int m, int n) {
    ruga_mesh mesh = new_grid(m, n);
    for (int c = 0; c < 3 * mesh.triangle_count; c++) {
        int i = mesh.triangle[c] % (m + 1) % m;
        int j = mesh.triangle[c] / (m + 1) % n;
        mesh.triangle[c] = j * m + i;
    }
    mesh.vertex_count = m * n;
    for (int v = 0; v < mesh.vertex_count; v++) {
        double around = 2 * RUGA_PI * (v % m) / m;
        double across = 2 * RUGA_PI * (v / m) / n;
        mesh.position[3 * v] = (1 + 0.4 * cos(across)) * cos(around);
        mesh.position[3 * v + 1] = (1 + 0.4 * cos(across)) * sin(around);
        mesh.position[3 * v + 2] = 0.4 * sin(across);
    }
    return mesh;
}

// [0, 2] x [0, 1] x [0, height], 12 faces
static ruga_mesh box(double height) {
    static const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    ruga_mesh mesh = {.vertex_count = 8, .triangle_count = 12};
    assert_ok(RUGA_NEW(mesh.position, 24));
    assert_ok(RUGA_NEW(mesh.triangle, 36));
    for (int v = 0; v < 8; v++) {
        mesh.position[3 * v] = 2 * (v & 1);
        mesh.position[3 * v + 1] = v >> 1 & 1;
        mesh.position[3 * v + 2] = height * (v >> 2);
    }
    for (int t = 0; t < 12; t++) {
        const int corner[3] = {quads[t / 2][0], quads[t / 2][1 + t % 2], quads[t / 2][2 + t % 2]};
        memcpy(mesh.triangle + 3 * t, corner, sizeof corner);
    }
    return mesh;
}

static void name_groups(ruga_mesh* mesh, double border_x) {
    mesh->group_count = 2;
    assert_ok(RUGA_NEW(mesh->group_name, 2));
    mesh->group_name[0] = ruga_copy_string("left");
    mesh->group_name[1] = ruga_copy_string("right");
    assert_ok(RUGA_NEW(mesh->face_group, mesh->triangle_count));
    for (int f = 0; f < mesh->triangle_count; f++) {
        double x = 0;
        for (int i = 0; i < 3; i++) {
            x += mesh->position[3 * mesh->triangle[3 * f + i]] / 3;
        }
        mesh->face_group[f] = x > border_x;
    }
}

// ---- measures

static double fraction_of_edges_within(const ruga_mesh* mesh, double low, double high) {
    int within = 0;
    for (int c = 0; c < 3 * mesh->triangle_count; c++) {
        int next = c % 3 == 2 ? c - 2 : c + 1;
        double length =
            ruga_distance(mesh->position + 3 * mesh->triangle[c], mesh->position + 3 * mesh->triangle[next]);
        within += length >= low && length <= high;
    }
    return (double)within / (3 * mesh->triangle_count);
}

// Largest distance of a's vertices from b's faces.
static double distance_from(const ruga_mesh* a, const ruga_mesh* b) {
    ruga_cgal_locator* locator = NULL;
    int* face = NULL;
    double* nearest = NULL;
    double largest = 0;
    assert_ok(ruga_cgal_locator_create(b->position, b->triangle_count, b->triangle, &locator));
    assert_ok(RUGA_NEW(face, a->vertex_count));
    assert_ok(RUGA_NEW(nearest, 3 * a->vertex_count));
    assert_ok(ruga_cgal_locator_nearest(locator, a->vertex_count, a->position, face, nearest));
    for (int v = 0; v < a->vertex_count; v++) {
        largest = fmax(largest, ruga_distance(a->position + 3 * v, nearest + 3 * v));
    }
    ruga_cgal_locator_destroy(&locator);
    ruga_release(face);
    ruga_release(nearest);
    return largest;
}

static void assert_well_remeshed(const ruga_mesh* mesh, const ruga_mesh* remeshed, double edge) {
    ruga_check_report before, after;
    assert_ok(ruga_mesh_check(mesh, RUGA_CHECK_SHELL, &before));
    assert_ok(ruga_mesh_check(remeshed, RUGA_CHECK_SHELL, &after));
    print_message(
        "edge %g: %d faces, mean %.4g, smallest angle %.3g degrees, in [0.6, 1.5]: %.4g, off %.3g edges\n",
        edge, after.triangle_count, after.edge_mean, after.angle_min * 180 / RUGA_PI,
        fraction_of_edges_within(remeshed, 0.6 * edge, 1.5 * edge), distance_from(mesh, remeshed) / edge);
    assert_int_equal(after.error_count + after.warning_count, 0);
    assert_int_equal(after.watertight, before.watertight);
    assert_int_equal(after.genus, before.genus);
    assert_true(fraction_of_edges_within(remeshed, 0.6 * edge, 1.5 * edge) >= 0.95);
    assert_near(after.edge_mean, edge, 0.21 * edge); // a regular grid may keep its own
    assert_true(after.angle_min > 15 * RUGA_PI / 180);
    assert_true(distance_from(mesh, remeshed) < 0.1 * edge);
    assert_near(after.area, before.area, 0.01 * before.area);
    if (before.watertight) {
        assert_near(after.volume, before.volume, 0.01 * before.volume);
    }
    ruga_check_report_clear(&before);
    ruga_check_report_clear(&after);
}

// ---- tests

static void torus_becomes_near_equilateral(void** state) {
    (void)state;
    ruga_mesh mesh = torus(160, 24);
    for (int coarse = 0; coarse < 2; coarse++) {
        double edge = coarse ? 0.12 : 0.06;
        ruga_mesh remeshed;
        assert_ok(ruga_mesh_remesh(&mesh, edge, &remeshed));
        assert_well_remeshed(&mesh, &remeshed, edge);
        ruga_mesh_clear(&remeshed);
    }
    ruga_mesh_clear(&mesh);
}

static void box_keeps_its_edges_and_corners(void** state) {
    (void)state;
    ruga_mesh mesh = box(0.5);
    ruga_mesh remeshed;
    assert_ok(ruga_mesh_remesh(&mesh, 0.08, &remeshed));
    assert_well_remeshed(&mesh, &remeshed, 0.08);
    assert_near(ruga_mesh_volume(&remeshed), 1, 1e-12);
    assert_near(ruga_mesh_area(&remeshed), 7, 1e-12);
    int found = 0;
    for (int v = 0; v < remeshed.vertex_count; v++) {
        int source = remeshed.source_vertex[v];
        if (source >= 0) {
            assert_memory_equal(remeshed.position + 3 * v, mesh.position + 3 * source, 3 * sizeof(double));
            found++;
        }
    }
    assert_int_equal(found, 8);
    ruga_mesh_clear(&remeshed);
    ruga_mesh_clear(&mesh);
}

static void slab_thinner_than_the_edge_keeps_its_volume(void** state) {
    (void)state;
    ruga_mesh mesh = box(0.03);
    ruga_mesh remeshed;
    assert_ok(ruga_mesh_remesh(&mesh, 0.08, &remeshed));
    assert_near(ruga_mesh_volume(&remeshed), 0.06, 1e-4);
    ruga_mesh_clear(&remeshed);
    ruga_mesh_clear(&mesh);
}

static void sheet_keeps_its_outline_exactly(void** state) {
    (void)state;
    ruga_mesh mesh = sheet(64, 7);
    ruga_mesh remeshed;
    assert_ok(ruga_mesh_remesh(&mesh, 0.06, &remeshed));
    assert_well_remeshed(&mesh, &remeshed, 0.06);
    assert_near(ruga_mesh_area(&remeshed), 2, 1e-12);
    for (int v = 0; v < remeshed.vertex_count; v++) {
        assert_near(remeshed.position[3 * v + 2], 0, 1e-15);
    }
    ruga_mesh_clear(&remeshed);
    ruga_mesh_clear(&mesh);
}

static void groups_keep_their_border_and_area(void** state) {
    (void)state;
    ruga_mesh mesh = sheet(20, 10);
    name_groups(&mesh, 0.5);
    ruga_mesh remeshed;
    assert_ok(ruga_mesh_remesh(&mesh, 0.07, &remeshed));
    assert_int_equal(remeshed.group_count, 2);
    assert_string_equal(remeshed.group_name[1], "right");
    double area[2] = {0, 0};
    for (int f = 0; f < remeshed.triangle_count; f++) {
        area[remeshed.face_group[f]] += ruga_mesh_triangle_area(&remeshed, f);
    }
    assert_near(area[0], 0.5, 1e-12);
    assert_near(area[1], 1.5, 1e-12);
    ruga_mesh_clear(&remeshed);
    ruga_mesh_clear(&mesh);
}

static void affine_uv_is_carried_over_exactly_with_one_uv_for_each_vertex(void** state) {
    (void)state;
    ruga_mesh mesh = sheet(20, 10);
    mesh.uv_count = mesh.vertex_count;
    assert_ok(RUGA_NEW(mesh.uv, 2 * mesh.uv_count));
    assert_ok(RUGA_NEW(mesh.uv_triangle, 3 * mesh.triangle_count));
    memcpy(mesh.uv_triangle, mesh.triangle, 3 * (size_t)mesh.triangle_count * sizeof(int));
    for (int v = 0; v < mesh.uv_count; v++) {
        mesh.uv[2 * v] = 0.3 * mesh.position[3 * v] + 0.1;
        mesh.uv[2 * v + 1] = 0.2 * mesh.position[3 * v + 1] - 0.1 * mesh.position[3 * v];
    }
    ruga_mesh remeshed;
    assert_ok(ruga_mesh_remesh(&mesh, 0.07, &remeshed));
    assert_int_equal(remeshed.uv_count, remeshed.vertex_count);
    for (int c = 0; c < 3 * remeshed.triangle_count; c++) {
        const double* p = remeshed.position + 3 * remeshed.triangle[c];
        const double* uv = remeshed.uv + 2 * remeshed.uv_triangle[c];
        assert_near(uv[0], 0.3 * p[0] + 0.1, 1e-12);
        assert_near(uv[1], 0.2 * p[1] - 0.1 * p[0], 1e-12);
    }
    ruga_mesh_clear(&remeshed);
    ruga_mesh_clear(&mesh);
}

// Two seams: u = angle / 2 pi jumps from 1 to 0 within one chart, and the inner half is a chart of its own.
static void no_new_face_spans_a_seam(void** state) {
    (void)state;
    enum { AROUND = 120, ACROSS = 40 };
    ruga_mesh mesh = torus(AROUND, ACROSS);
    mesh.uv_count = 3 * mesh.triangle_count;
    assert_ok(RUGA_NEW(mesh.uv, 2 * mesh.uv_count));
    assert_ok(RUGA_NEW(mesh.uv_triangle, 3 * mesh.triangle_count));
    for (int f = 0; f < mesh.triangle_count; f++) {
        int quad = f / 2;
        static const int step[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
        for (int i = 0; i < 3; i++) {
            int j = quad / AROUND;
            mesh.uv_triangle[3 * f + i] = 3 * f + i;
            mesh.uv[2 * (3 * f + i)] = (double)(quad % AROUND + step[f % 2][i][0]) / AROUND;
            mesh.uv[2 * (3 * f + i) + 1] =
                (double)(j + step[f % 2][i][1]) / ACROSS + (2 * j >= ACROSS ? 5 : 0);
        }
    }
    double edge = 0.1;
    ruga_mesh remeshed;
    assert_ok(ruga_mesh_remesh(&mesh, edge, &remeshed));
    double widest[2] = {0, 0};
    for (int c = 0; c < 3 * remeshed.triangle_count; c++) {
        int next = c % 3 == 2 ? c - 2 : c + 1;
        for (int k = 0; k < 2; k++) {
            double span = remeshed.uv[2 * remeshed.uv_triangle[c] + k] -
                          remeshed.uv[2 * remeshed.uv_triangle[next] + k];
            widest[k] = fmax(widest[k], fabs(span));
        }
    }
    // 1.5 edges on the inner circle (radius 0.6) and across (radius 0.4)
    print_message("widest face in uv: %g %g, %d uvs for %d vertices\n", widest[0], widest[1],
                  remeshed.uv_count, remeshed.vertex_count);
    assert_true(widest[0] < 1.8 * edge / (2 * RUGA_PI * 0.6));
    assert_true(widest[1] < 1.8 * edge / (2 * RUGA_PI * 0.4));
    assert_true(remeshed.uv_count > remeshed.vertex_count);
    assert_true(remeshed.uv_count < 1.5 * remeshed.vertex_count);
    ruga_mesh_clear(&remeshed);
    ruga_mesh_clear(&mesh);
}

static void second_run_gives_the_same_bits(void** state) {
    (void)state;
    ruga_mesh mesh = torus(40, 20);
    ruga_mesh first, second;
    assert_ok(ruga_mesh_remesh(&mesh, 0.15, &first));
    assert_ok(ruga_mesh_remesh(&mesh, 0.15, &second));
    assert_int_equal(ruga_mesh_hash(&first), ruga_mesh_hash(&second));
    ruga_mesh_clear(&first);
    ruga_mesh_clear(&second);
    ruga_mesh_clear(&mesh);
}

static void unused_vertices_are_left_out(void** state) {
    (void)state;
    ruga_mesh mesh = box(1);
    mesh.position = ruga_reallocate(mesh.position, 27 * sizeof(double));
    memset(mesh.position + 24, 0, 3 * sizeof(double));
    mesh.vertex_count = 9;
    ruga_mesh remeshed;
    assert_ok(ruga_mesh_remesh(&mesh, 0.2, &remeshed));
    assert_well_remeshed(&mesh, &remeshed, 0.2);
    ruga_mesh_clear(&remeshed);
    ruga_mesh_clear(&mesh);
}

static void assert_refused(const ruga_mesh* mesh, double edge, ruga_status status, const char* words) {
    ruga_mesh remeshed;
    assert_status(ruga_mesh_remesh(mesh, edge, &remeshed), status);
    if (!strstr(ruga_last_error(), words)) {
        print_error("no \"%s\" in \"%s\"\n", words, ruga_last_error());
        fail();
    }
    assert_null(remeshed.position);
}

static void bad_edges_and_bad_meshes_are_refused(void** state) {
    (void)state;
    ruga_mesh mesh = box(1);
    assert_refused(&mesh, 0, RUGA_BAD_INPUT, "above zero");
    assert_refused(&mesh, -1, RUGA_BAD_INPUT, "above zero");
    assert_refused(&mesh, NAN, RUGA_BAD_INPUT, "above zero");
    assert_refused(&mesh, INFINITY, RUGA_BAD_INPUT, "above zero");
    assert_refused(&mesh, 4, RUGA_BAD_INPUT, "too long");
    assert_refused(&mesh, 1e-5, RUGA_BAD_INPUT, "longer edge");
    mesh.position[4] = NAN;
    assert_refused(&mesh, 0.1, RUGA_BAD_MESH, "not finite, vertex 1");
    ruga_mesh_clear(&mesh);
    mesh = box(1);
    int corner = mesh.triangle[9];
    mesh.triangle[9] = mesh.triangle[10];
    mesh.triangle[10] = corner;
    assert_refused(&mesh, 0.1, RUGA_BAD_MESH, "1 flipped face, face 3");
    ruga_mesh_clear(&mesh);
    const ruga_mesh empty = {0};
    assert_refused(&empty, 0.1, RUGA_BAD_MESH, "no faces");
}

static void survives_each_failed_allocation(void** state) {
    (void)state;
    ruga_mesh mesh = sheet(4, 2);
    name_groups(&mesh, 1);
    mesh.uv_count = 1;
    assert_ok(RUGA_NEW_ZERO(mesh.uv, 2));
    assert_ok(RUGA_NEW_ZERO(mesh.uv_triangle, 3 * mesh.triangle_count));
    size_t bytes = ruga_byte_count();
    int failed = 0;
    for (ruga_status status = RUGA_NO_MEMORY; status != RUGA_OK; failed++) {
        ruga_mesh remeshed;
        let_allocations_fail_after(failed);
        status = ruga_mesh_remesh(&mesh, 0.5, &remeshed);
        ruga_set_allocator(NULL, NULL, NULL);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        ruga_mesh_clear(&remeshed);
        assert_int_equal(ruga_byte_count(), bytes);
    }
    assert_true(failed > 40);
    ruga_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(torus_becomes_near_equilateral),
        cmocka_unit_test(box_keeps_its_edges_and_corners),
        cmocka_unit_test(slab_thinner_than_the_edge_keeps_its_volume),
        cmocka_unit_test(sheet_keeps_its_outline_exactly),
        cmocka_unit_test(groups_keep_their_border_and_area),
        cmocka_unit_test(affine_uv_is_carried_over_exactly_with_one_uv_for_each_vertex),
        cmocka_unit_test(no_new_face_spans_a_seam),
        cmocka_unit_test(second_run_gives_the_same_bits),
        cmocka_unit_test(unused_vertices_are_left_out),
        cmocka_unit_test(bad_edges_and_bad_meshes_are_refused),
        cmocka_unit_test(survives_each_failed_allocation),
    };
    return cmocka_run_group_tests_name("remesh", tests, NULL, check_no_leak);
}
