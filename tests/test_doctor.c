// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Each kind of defect on the smallest mesh that has it, and no defect on sound meshes.
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "core/random.h"
#include "core/vec3.h"
#include "mesh/crossing.h"
#include "mesh/doctor.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 64 };

// A mesh in place: no heap, so that a test may break what it likes.
typedef struct small_mesh {
    double position[MOST][3];
    int triangle[MOST][3];
    int polygon[MOST];
    ruga_mesh mesh;
} small_mesh;

static const ruga_mesh* view(small_mesh* m) {
    m->mesh.position = m->position[0];
    m->mesh.triangle = m->triangle[0];
    return &m->mesh;
}

// A unit cube with its lowest corner at `at`, scaled; inward = its faces run the other way.
static void add_cube(small_mesh* m, const double at[3], double size, bool inward) {
    static const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    int first = m->mesh.vertex_count;
    for (int i = 0; i < 8; i++) {
        double* p = m->position[m->mesh.vertex_count++];
        for (int k = 0; k < 3; k++) {
            p[k] = at[k] + size * ((i >> k) & 1);
        }
    }
    for (int t = 0; t < 12; t++) {
        const int* q = quads[t / 2];
        const int corner[3] = {q[0], q[1 + t % 2], q[2 + t % 2]};
        int* triangle = m->triangle[m->mesh.triangle_count];
        m->polygon[m->mesh.triangle_count++] = first * 10 + t / 2;
        for (int i = 0; i < 3; i++) {
            triangle[inward ? 2 - i : i] = first + corner[i];
        }
    }
}

static small_mesh cube(void) {
    small_mesh m = {0};
    add_cube(&m, (const double[3]){0, 0, 0}, 1, false);
    return m;
}

static ruga_check_report check_as(small_mesh* m, ruga_check_as as) {
    ruga_check_report report;
    assert_ok(ruga_mesh_check(view(m), as, &report));
    int errors = 0;
    int warnings = 0;
    for (int i = 0; i < report.defect_count; i++) {
        errors += report.defect[i].severity == RUGA_SEVERITY_ERROR;
        warnings += report.defect[i].severity == RUGA_SEVERITY_WARNING;
    }
    assert_int_equal(errors, report.error_count); // small meshes: everything is listed
    assert_int_equal(warnings, report.warning_count);
    return report;
}

// `count` defects of a kind and, of others, none but those of `also`.
static void assert_found(small_mesh* m, ruga_defect_kind kind, int count, ruga_defect_kind also) {
    ruga_check_report report = check_as(m, RUGA_CHECK_EMBEDDED);
    for (int k = 0; k < RUGA_DEFECT_KINDS; k++) {
        if (k == (int)kind) {
            assert_int_equal(report.count[k], count);
        } else if (k != (int)also && report.count[k] != 0) {
            print_error("%d of %s\n", report.count[k], ruga_defect_name((ruga_defect_kind)k));
            fail();
        }
    }
    ruga_check_report_clear(&report);
}
#define assert_only(m, kind, count) assert_found(m, kind, count, kind)

static void sound_cube_has_no_defect(void** state) {
    (void)state;
    small_mesh m = cube();
    m.mesh.polygon = m.polygon;
    assert_only(&m, RUGA_DEFECT_NO_FACES, 0);
    ruga_check_report report = check_as(&m, RUGA_CHECK_EMBEDDED);
    assert_true(report.watertight);
    assert_int_equal(report.genus, 0);
    assert_int_equal(report.edge_count, 18);
    assert_int_equal(report.component_count, 1);
    assert_near(report.area, 6, 1e-14);
    assert_near(report.volume, 1, 1e-14);
    assert_near(report.edge_min, 1, 0);
    assert_near(report.edge_max, sqrt(2), 1e-15);
    assert_near(report.angle_min, RUGA_PI / 4, 1e-15);
    assert_near(report.max[2], 1, 0);
    assert_ok(ruga_check_status(&report, "cube"));
    ruga_check_report_clear(&report);
}

static void mesh_without_faces_is_an_error(void** state) {
    (void)state;
    small_mesh m = {0};
    assert_only(&m, RUGA_DEFECT_NO_FACES, 1);
    ruga_check_report report = check_as(&m, RUGA_CHECK_SHELL);
    assert_false(report.watertight);
    assert_int_equal(report.genus, -1);
    assert_status(ruga_check_status(&report, "empty.obj"), RUGA_BAD_MESH);
    assert_string_equal(ruga_last_error(), "empty.obj: no faces: give a mesh with triangles");
    ruga_check_report_clear(&report);
}

static void missing_face_gives_open_edges_but_not_in_a_shell(void** state) {
    (void)state;
    small_mesh m = cube();
    m.mesh.triangle_count--;
    assert_only(&m, RUGA_DEFECT_OPEN_EDGE, 3);
    ruga_check_report report = check_as(&m, RUGA_CHECK_SHELL);
    assert_int_equal(report.error_count + report.warning_count, 0);
    assert_false(report.watertight);
    ruga_check_report_clear(&report);
}

static void sentence_names_first_error_place_and_the_others(void** state) {
    (void)state;
    small_mesh m = cube();
    m.mesh.triangle_count--;
    m.position[m.mesh.vertex_count++][0] = NAN;
    m.triangle[m.mesh.triangle_count][0] = m.triangle[m.mesh.triangle_count][1] = 1;
    m.triangle[m.mesh.triangle_count++][2] = 2;
    ruga_check_report report = check_as(&m, RUGA_CHECK_EMBEDDED);
    assert_status(ruga_check_status(&report, "a.obj"), RUGA_BAD_MESH);
    assert_string_equal(ruga_last_error(),
                        "a.obj: 1 vertex that is not finite, vertex 8 at (0, 0, 0) m: export the mesh again; "
                        "also 3 open edges, 1 face without area");
    ruga_check_report_clear(&report);
    m = cube();
    m.mesh.triangle_count--;
    report = check_as(&m, RUGA_CHECK_EMBEDDED);
    assert_status(ruga_check_status(&report, "b.obj"), RUGA_BAD_MESH);
    assert_string_equal(ruga_last_error(), "b.obj: 3 open edges, the first between vertices 1 and 5 at "
                                           "(1, 0, 0.5) m: close the hole");
    ruga_check_report_clear(&report);
}

static void nan_is_found_and_harms_nothing_else(void** state) {
    (void)state;
    small_mesh m = cube();
    m.position[3][1] = NAN;
    assert_only(&m, RUGA_DEFECT_NAN, 1);
    m.position[3][1] = INFINITY;
    ruga_check_report report = check_as(&m, RUGA_CHECK_EMBEDDED);
    assert_int_equal(report.defect[0].vertex[0], 3);
    assert_true(isfinite(report.defect[0].position[1]) && isfinite(report.area) && isfinite(report.volume));
    assert_true(report.watertight);
    ruga_check_report_clear(&report);
}

static void third_face_at_an_edge_is_non_manifold(void** state) {
    (void)state;
    small_mesh m = cube();
    double* p = m.position[m.mesh.vertex_count++];
    p[0] = 0.5, p[1] = -1, p[2] = -1;
    int* t = m.triangle[m.mesh.triangle_count++];
    t[0] = 0, t[1] = 1, t[2] = 8; // a fin on the edge 0 1
    assert_found(&m, RUGA_DEFECT_NON_MANIFOLD_EDGE, 1, RUGA_DEFECT_OPEN_EDGE);
}

static void cubes_that_share_a_corner_are_non_manifold_there(void** state) {
    (void)state;
    small_mesh m = cube();
    add_cube(&m, (const double[3]){1, 1, 1}, 1, false);
    for (int i = 0; i < 3 * m.mesh.triangle_count; i++) {
        int* v = &m.triangle[0][0] + i;
        *v = *v == 8 ? 7 : *v;
    }
    assert_found(&m, RUGA_DEFECT_NON_MANIFOLD_VERTEX, 1, RUGA_DEFECT_UNUSED_VERTEX);
}

static void flipped_faces_are_named_once_each(void** state) {
    (void)state;
    for (int flips = 1; flips <= 3; flips++) {
        small_mesh m = cube();
        for (int f = 0; f < flips; f++) {
            int corner = m.triangle[4 * f + 1][0];
            m.triangle[4 * f + 1][0] = m.triangle[4 * f + 1][1];
            m.triangle[4 * f + 1][1] = corner;
        }
        assert_only(&m, RUGA_DEFECT_FLIPPED_FACE, flips);
        ruga_check_report report = check_as(&m, RUGA_CHECK_SHELL);
        assert_int_equal(report.error_count, flips);
        assert_false(report.watertight);
        for (int f = 0; f < flips; f++) {
            assert_int_equal(report.defect[f].face[0], 4 * f + 1);
        }
        ruga_check_report_clear(&report);
    }
}

static void moebius_strip_cannot_be_oriented(void** state) {
    (void)state;
    enum { STEPS = 9 };
    small_mesh m = {0};
    for (int i = 0; i < STEPS; i++) {
        double turn = 2 * RUGA_PI * i / STEPS;
        for (int side = -1; side <= 1; side += 2) {
            double r = 2 + 0.5 * side * cos(turn / 2);
            double* p = m.position[m.mesh.vertex_count++];
            p[0] = r * cos(turn), p[1] = r * sin(turn), p[2] = 0.5 * side * sin(turn / 2);
        }
    }
    for (int i = 0; i < STEPS; i++) {
        int twist = i == STEPS - 1;
        const int a = 2 * i, b = 2 * i + 1;
        const int c = (2 * i + 2 + twist) % (2 * STEPS), d = twist ? 0 : 2 * i + 3;
        memcpy(m.triangle[m.mesh.triangle_count++], (const int[3]){a, c, b}, 3 * sizeof(int));
        memcpy(m.triangle[m.mesh.triangle_count++], (const int[3]){b, c, d}, 3 * sizeof(int));
    }
    ruga_check_report report = check_as(&m, RUGA_CHECK_SHELL);
    assert_true(report.count[RUGA_DEFECT_FLIPPED_FACE] >= 1);
    ruga_check_report_clear(&report);
}

static void closed_mesh_of_negative_volume_is_inside_out(void** state) {
    (void)state;
    small_mesh m = {0};
    add_cube(&m, (const double[3]){0, 0, 0}, 1, true);
    assert_only(&m, RUGA_DEFECT_INSIDE_OUT, 1);
    ruga_check_report report = check_as(&m, RUGA_CHECK_SHELL);
    assert_int_equal(report.error_count, 0);
    ruga_check_report_clear(&report);
}

static void cavity_is_fine_and_solid_within_it_too(void** state) {
    (void)state;
    small_mesh m = cube();
    add_cube(&m, (const double[3]){0.1, 0.1, 0.1}, 0.8, true);
    assert_only(&m, RUGA_DEFECT_INSIDE_OUT, 0);
    add_cube(&m, (const double[3]){0.2, 0.2, 0.2}, 0.5, false);
    assert_only(&m, RUGA_DEFECT_INSIDE_OUT, 0);
    add_cube(&m, (const double[3]){2, 2, 2}, 0.5, true); // outside everything
    assert_only(&m, RUGA_DEFECT_INSIDE_OUT, 1);
}

static void inverted_shell_within_a_cavity_is_inside_out(void** state) {
    (void)state;
    small_mesh m = cube();
    add_cube(&m, (const double[3]){0.1, 0.1, 0.1}, 0.8, true);
    add_cube(&m, (const double[3]){0.2, 0.2, 0.2}, 0.5, true);
    assert_only(&m, RUGA_DEFECT_INSIDE_OUT, 1);
}

static void duplicate_and_degenerate_faces_are_found(void** state) {
    (void)state;
    small_mesh m = cube();
    memcpy(m.triangle[m.mesh.triangle_count++],
           (const int[3]){m.triangle[5][1], m.triangle[5][2], m.triangle[5][0]}, 3 * sizeof(int));
    assert_found(&m, RUGA_DEFECT_DUPLICATE_FACE, 1, RUGA_DEFECT_NON_MANIFOLD_EDGE);
    m = cube();
    memcpy(m.triangle[m.mesh.triangle_count++], (const int[3]){0, 0, 1}, 3 * sizeof(int));
    assert_only(&m, RUGA_DEFECT_DEGENERATE_FACE, 1);
    m = cube();
    memcpy(m.position[4], (const double[3]){0, 0, 0}, sizeof m.position[4]); // onto vertex 0
    ruga_check_report report = check_as(&m, RUGA_CHECK_EMBEDDED);
    assert_int_equal(report.count[RUGA_DEFECT_DEGENERATE_FACE], 2);
    ruga_check_report_clear(&report);
}

static void sliver_unused_vertex_and_bent_polygon_are_warnings(void** state) {
    (void)state;
    small_mesh m = cube();
    m.mesh.polygon = m.polygon;
    m.position[7][0] = 1.2;
    m.mesh.vertex_count++;
    ruga_check_report report = check_as(&m, RUGA_CHECK_EMBEDDED);
    assert_int_equal(report.count[RUGA_DEFECT_UNUSED_VERTEX], 1);
    assert_int_equal(report.count[RUGA_DEFECT_NON_PLANAR_POLYGON], 1);
    assert_int_equal(report.error_count, 0);
    assert_ok(ruga_check_status(&report, "cube"));
    ruga_check_report_clear(&report);
    m = cube();
    for (int v = 0; v < 8; v++) {
        m.position[v][2] *= 0.01;
    }
    assert_only(&m, RUGA_DEFECT_SLIVER, 8);
}

static void crossing_components_overlap_and_one_crossing_itself_is_an_error(void** state) {
    (void)state;
    small_mesh m = cube();
    add_cube(&m, (const double[3]){0.5, 0.4, 0.3}, 1, false);
    ruga_check_report report = check_as(&m, RUGA_CHECK_EMBEDDED);
    assert_true(report.count[RUGA_DEFECT_OVERLAP] > 0);
    assert_int_equal(report.error_count, 0);
    assert_int_equal(report.component_count, 2);
    assert_true(report.watertight);
    ruga_check_report_clear(&report);
    m = cube();
    memcpy(m.position[7], (const double[3]){0.5, 0.5, -1}, sizeof m.position[7]); // through the floor
    report = check_as(&m, RUGA_CHECK_EMBEDDED);
    assert_true(report.count[RUGA_DEFECT_SELF_INTERSECTION] > 0);
    assert_true(report.error_count > 0);
    ruga_check_report_clear(&report);
}

static void touching_cubes_do_not_overlap(void** state) {
    (void)state;
    small_mesh m = cube();
    add_cube(&m, (const double[3]){1, 1, 0}, 1, false); // along an edge
    add_cube(&m, (const double[3]){0.25, 0.25, 1}, 0.5, false);
    ruga_check_report report = check_as(&m, RUGA_CHECK_EMBEDDED);
    // The third cube stands on the first: coplanar faces that share an area do overlap, edges do not.
    for (int i = 0; i < report.defect_count; i++) {
        assert_int_equal(report.defect[i].kind, RUGA_DEFECT_OVERLAP);
        assert_true(report.defect[i].face[0] < 12 && report.defect[i].face[1] >= 24);
    }
    ruga_check_report_clear(&report);
}

// The same question by rounding: an edge of one goes through the inside of the other.
static bool edge_pierces(const double* p, const double* q, const double* const t[3]) {
    double n[3], to_p[3], to_q[3], hit[3];
    ruga_triangle_normal(t[0], t[1], t[2], n);
    ruga_subtract(p, t[0], to_p);
    ruga_subtract(q, t[0], to_q);
    double hp = ruga_dot(to_p, n);
    double hq = ruga_dot(to_q, n);
    if (hp * hq >= 0) {
        return false;
    }
    for (int i = 0; i < 3; i++) {
        if (p == t[i] || q == t[i]) {
            return false; // begins in the plane, whatever rounding says
        }
    }
    for (int k = 0; k < 3; k++) {
        hit[k] = p[k] + hp / (hp - hq) * (q[k] - p[k]);
    }
    for (int i = 0; i < 3; i++) {
        double part[3];
        ruga_triangle_normal(t[i], t[(i + 1) % 3], hit, part);
        if (ruga_dot(part, n) <= 0) {
            return false;
        }
    }
    return true;
}

static void crossing_agrees_with_edges_that_pierce(void** state) {
    (void)state;
    ruga_random random = {7};
    int crossing = 0;
    for (int trial = 0; trial < 20000; trial++) {
        double x[6][3];
        for (int i = 0; i < 18; i++) {
            x[i / 3][i % 3] = ruga_random_uniform(&random);
        }
        const double* a[3] = {x[0], x[1], x[2]};
        const double* b[3] = {x[3], x[4], x[5]};
        if (trial % 4 == 0) {
            b[trial % 3] = a[trial % 2]; // a common corner
        }
        bool pierced = false;
        for (int i = 0; i < 3; i++) {
            pierced =
                pierced || edge_pierces(a[i], a[(i + 1) % 3], b) || edge_pierces(b[i], b[(i + 1) % 3], a);
        }
        assert_int_equal(ruga_triangles_cross(a, b), pierced);
        assert_int_equal(ruga_triangles_cross(b, a), pierced);
        crossing += pierced;
    }
    assert_true(crossing > 1000 && crossing < 10000);
}

static void coplanar_triangles_cross_only_where_they_share_an_area(void** state) {
    (void)state;
    const double p[][3] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}, {0.2, 0.2, 1}, {-1, -1, 1}};
    const double* a[3] = {p[0], p[1], p[2]};
    const double* beyond[3] = {p[1], p[3], p[2]};
    const double* folded[3] = {p[1], p[4], p[2]};
    const double* corner[3] = {p[5], p[0], p[2]};
    assert_false(ruga_triangles_cross(a, beyond));
    assert_true(ruga_triangles_cross(a, folded));
    assert_false(ruga_triangles_cross(a, corner));
}

static void list_is_capped_and_counts_are_not(void** state) {
    (void)state;
    enum { FACES = 150 };
    static double position[3 * FACES][3];
    static int triangle[FACES][3];
    for (int f = 0; f < FACES; f++) {
        for (int i = 0; i < 3; i++) {
            triangle[f][i] = 3 * f + i;
            position[3 * f + i][0] = f + 0.5 * (i == 1);
            position[3 * f + i][1] = 0.5 * (i == 2);
        }
    }
    ruga_mesh mesh = {
        .vertex_count = 3 * FACES, .position = position[0], .triangle_count = FACES, .triangle = triangle[0]};
    ruga_check_report report;
    assert_ok(ruga_mesh_check(&mesh, RUGA_CHECK_EMBEDDED, &report));
    assert_int_equal(report.count[RUGA_DEFECT_OPEN_EDGE], 3 * FACES);
    assert_int_equal(report.error_count, 3 * FACES);
    assert_int_equal(report.defect_count, 100);
    assert_int_equal(report.component_count, FACES);
    ruga_check_report_clear(&report);
}

static void survives_each_failed_allocation(void** state) {
    (void)state;
    small_mesh m = cube();
    add_cube(&m, (const double[3]){0.5, 0.4, 0.3}, 1, false);
    m.mesh.polygon = m.polygon;
    int failed = 0;
    for (ruga_status status = RUGA_NO_MEMORY; status != RUGA_OK; failed++) {
        ruga_check_report report;
        let_allocations_fail_after(failed);
        status = ruga_mesh_check(view(&m), RUGA_CHECK_EMBEDDED, &report);
        ruga_set_allocator(NULL, NULL, NULL);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        ruga_check_report_clear(&report);
        assert_int_equal(ruga_byte_count(), 0);
    }
    assert_true(failed > 15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sound_cube_has_no_defect),
        cmocka_unit_test(mesh_without_faces_is_an_error),
        cmocka_unit_test(missing_face_gives_open_edges_but_not_in_a_shell),
        cmocka_unit_test(sentence_names_first_error_place_and_the_others),
        cmocka_unit_test(nan_is_found_and_harms_nothing_else),
        cmocka_unit_test(third_face_at_an_edge_is_non_manifold),
        cmocka_unit_test(cubes_that_share_a_corner_are_non_manifold_there),
        cmocka_unit_test(flipped_faces_are_named_once_each),
        cmocka_unit_test(moebius_strip_cannot_be_oriented),
        cmocka_unit_test(closed_mesh_of_negative_volume_is_inside_out),
        cmocka_unit_test(cavity_is_fine_and_solid_within_it_too),
        cmocka_unit_test(inverted_shell_within_a_cavity_is_inside_out),
        cmocka_unit_test(duplicate_and_degenerate_faces_are_found),
        cmocka_unit_test(sliver_unused_vertex_and_bent_polygon_are_warnings),
        cmocka_unit_test(crossing_components_overlap_and_one_crossing_itself_is_an_error),
        cmocka_unit_test(touching_cubes_do_not_overlap),
        cmocka_unit_test(crossing_agrees_with_edges_that_pierce),
        cmocka_unit_test(coplanar_triangles_cross_only_where_they_share_an_area),
        cmocka_unit_test(list_is_capped_and_counts_are_not),
        cmocka_unit_test(survives_each_failed_allocation),
    };
    return cmocka_run_group_tests_name("doctor", tests, NULL, check_no_leak);
}
