// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/crease_case.h"
#include "tests/random_creases.h"
#include "tests/scarce_memory.h"

static const ruga_curve PLAIN = {.freedom = RUGA_FREEDOM_AUTO};

// Twice the smallest area of a triangle.
static double least_area(const ruga_mesh* mesh) {
    double least = INFINITY;
    for (int f = 0; f < mesh->triangle_count; f++) {
        double n[3];
        ruga_mesh_triangle_normal(mesh, f, n);
        least = fmin(least, n[2] < 0 ? -ruga_norm(n) : ruga_norm(n));
    }
    return least;
}

// What must hold for every raster and cut: at most one node on an edge, chords on both sides of it, fractions
// that add up, a material that is the old surface.
static void assert_consistent(const crease_case* c) {
    const ruga_raster* r = &c->raster;
    int* chords = calloc((size_t)(2 * r->edges.edge_count), sizeof *chords);
    double* fraction = calloc((size_t)r->mesh.triangle_count, sizeof *fraction);
    for (int k = 0; k < r->chord_count; k++) {
        for (int end = 0; end < 2; end++) {
            int place = r->chord[k].end[end], f = r->chord[k].triangle;
            int e = r->edges.triangle_edge[f][place / 2];
            if (place % 2) {
                assert_true(r->node[e] > 0 && r->node[e] < 1);
                chords[2 * e + (r->edges.edge_triangle[e][1] == f)]++;
            }
        }
    }
    int nodes = 0, copies = 0;
    for (int e = 0; e < r->edges.edge_count; e++) {
        for (int side = 0; side < 2 && r->node[e] > 0; side++) {
            assert_true(r->edges.edge_triangle[e][side] < 0 || chords[2 * e + side] > 0);
        }
        nodes += r->node[e] > 0;
    }
    for (int p = 0; p < c->cut.piece_count; p++) {
        assert_true(c->cut.piece[p].fraction > 0);
        fraction[c->cut.piece[p].triangle] += c->cut.piece[p].fraction;
    }
    for (int f = 0; f < r->mesh.triangle_count; f++) {
        assert_near(fraction[f], 1, 1e-12);
    }
    assert_int_equal(c->cut.bound_count, nodes);
    for (int b = 0; b < c->cut.bound_count; b++) {
        assert_true(c->cut.bound[b].count >= 1);
        copies += c->cut.bound[b].count;
    }
    assert_int_equal(all_rows(c), copies - nodes);
    assert_int_equal(c->cut.real_count, r->mesh.vertex_count);
    double area = ruga_mesh_area(&r->mesh);
    assert_near(ruga_mesh_area(&c->cut.material), area, 1e-12 * area);
    ruga_connectivity material;
    assert_ok(ruga_connectivity_create(&c->cut.material, &material));
    // Chords are edges of the material: V - E + F is that of the mesh.
    assert_int_equal(c->cut.material.vertex_count - material.edge_count + c->cut.material.triangle_count,
                     r->mesh.vertex_count - r->edges.edge_count + r->mesh.triangle_count);
    ruga_connectivity_clear(&material);
    free(chords);
    free(fraction);
}

// ------------------------------------------------------------------------------- curves

static void points_above_the_mesh_are_projected_and_overhang_is_trimmed(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    const double point[3][3] = {{-3, 2.3, 0.5}, {3.4, 2.3, -0.2}, {12, 2.3, 0.1}};
    make_squares(6, 5, true, &c.mesh);
    assert_ok(ruga_curves_add_polyline(&c.curves, &PLAIN, 3, point));
    run_case(&c, &def);
    assert_near(c.raster.facts[0].length, 6, 1e-13);
    assert_false(c.raster.facts[0].bent);
    assert_consistent(&c);
    clear_case(&c);
}

static void a_curve_over_a_hole_is_two_pieces(void** state) {
    (void)state;
    // A sheet without its middle: faces with a corner there are left out.
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    make_squares(8, 8, true, &c.mesh);
    int kept = 0;
    for (int f = 0; f < c.mesh.triangle_count; f++) {
        const int* t = c.mesh.triangle + 3 * f;
        if (t[0] != 4 + 9 * 4 && t[1] != 4 + 9 * 4 && t[2] != 4 + 9 * 4) {
            memmove(c.mesh.triangle + 3 * kept++, t, 3 * sizeof *t);
        }
    }
    c.mesh.triangle_count = kept;
    add_line(&c.curves, RUGA_FREEDOM_AUTO, 1.3, 4.2, 6.7, 4.2);
    run_case(&c, &def);
    assert_near(c.raster.facts[0].length, 5.4 - 1.8, 1e-12); // less the hole at this height
    assert_consistent(&c);
    clear_case(&c);
}

static void a_curve_beside_the_mesh_is_refused(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    make_squares(4, 4, true, &c.mesh);
    add_line(&c.curves, RUGA_FREEDOM_AUTO, 1, 7, 3, 9);
    assert_status(ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "lies beside the mesh"));
    const double bad[2][3] = {{0, 0, 0}, {NAN, 1, 0}};
    assert_status(ruga_curves_add_polyline(&c.curves, &PLAIN, 2, bad), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "point 1"));
    assert_status(ruga_curves_add_polyline(&c.curves, &PLAIN, 1, bad), RUGA_BAD_INPUT);
    clear_case(&c);
}

static void a_path_of_mesh_edges_is_a_crease_without_a_cut(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    ruga_connectivity edges;
    const int path[4] = {5 * 2, 5 * 2 + 1, 5 * 3 + 2, 5 * 3 + 3}, gap[2] = {0, 24};
    make_squares(4, 4, true, &c.mesh);
    assert_ok(ruga_connectivity_create(&c.mesh, &edges));
    assert_ok(ruga_curves_add_path(&c.curves, &PLAIN, &c.mesh, &edges, 4, path));
    assert_status(ruga_curves_add_path(&c.curves, &PLAIN, &c.mesh, &edges, 2, gap), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "no edge joins vertices 0 and 24"));
    run_case(&c, &def);
    assert_int_equal(new_triangles(&c), 0);
    assert_int_equal(c.cut.segment_count, 3);
    assert_int_equal(c.cut.bend_count + 3, 4 * 3 * 2 + 4 * 4); // inner edges
    assert_consistent(&c);
    ruga_connectivity_clear(&edges);
    clear_case(&c);
}

static void borders_of_groups_become_closed_curves(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    ruga_connectivity edges;
    make_squares(5, 5, true, &c.mesh);
    assert_ok(RUGA_NEW_ZERO(c.mesh.face_group, c.mesh.triangle_count));
    assert_ok(RUGA_NEW(c.mesh.group_name, 2));
    c.mesh.group_name[0] = ruga_copy_string("rim");
    c.mesh.group_name[1] = ruga_copy_string("seat");
    c.mesh.group_count = 2;
    for (int f = 0; f < c.mesh.triangle_count; f++) {
        int i = f / 2 % 5, j = f / 2 / 5;
        c.mesh.face_group[f] = i > 0 && i < 4 && j > 0 && j < 4;
    }
    assert_ok(ruga_connectivity_create(&c.mesh, &edges));
    assert_ok(ruga_curves_add_border(&c.curves, &PLAIN, &c.mesh, &edges, "seat"));
    assert_status(ruga_curves_add_border(&c.curves, &PLAIN, &c.mesh, &edges, "back"), RUGA_BAD_INPUT);
    assert_int_equal(c.curves.count, 1);
    assert_true(c.curves.curve[0].closed);
    assert_int_equal(c.curves.curve[0].point_count, 12);
    run_case(&c, &def);
    assert_int_equal(c.cut.segment_count, 12);
    assert_near(c.raster.facts[0].length, 12, 1e-13);
    // A line across it: the border keeps its vertices, the crossings become vertices.
    ruga_raster_clear(&c.raster);
    ruga_cut_clear(&c.cut);
    ruga_sewing_clear(&c.sewing);
    add_line(&c.curves, RUGA_FREEDOM_AUTO, -1, 2.4, 6, 2.6);
    run_case(&c, &def);
    assert_true(c.raster.facts[0].meets && c.raster.facts[1].meets);
    assert_near(c.raster.facts[0].length, 12, 1e-9);
    assert_consistent(&c);
    ruga_connectivity_clear(&edges);
    clear_case(&c);
}

static void uvs_groups_and_attributes_are_carried_along(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    make_squares(6, 6, true, &c.mesh);
    ruga_mesh* m = &c.mesh;
    // uv and attribute are linear in the position, so that they must be so everywhere afterwards.
    m->uv_count = m->vertex_count;
    m->attribute_count = 1;
    assert_ok(RUGA_NEW(m->uv, 2 * m->uv_count));
    assert_ok(RUGA_NEW(m->uv_triangle, 3 * m->triangle_count));
    assert_ok(RUGA_NEW(m->attribute, m->vertex_count));
    assert_ok(RUGA_NEW(m->attribute_name, 1));
    m->attribute_name[0] = ruga_copy_string("thickness");
    memcpy(m->uv_triangle, m->triangle, (size_t)(3 * m->triangle_count) * sizeof(int));
    for (int v = 0; v < m->vertex_count; v++) {
        m->uv[2 * v] = 0.1 * m->position[3 * v];
        m->uv[2 * v + 1] = 1 - 0.1 * m->position[3 * v + 1];
        m->attribute[v] = m->position[3 * v] + 2 * m->position[3 * v + 1];
    }
    const double uv[2][2] = {{0.02, 0.51}, {0.58, 0.83}};
    assert_ok(ruga_curves_add_uv(&c.curves, &PLAIN, m, 2, uv));
    assert_near(c.curves.curve[0].point[1][1], 1.7, 1e-13);
    add_line(&c.curves, RUGA_FREEDOM_AUTO, 0.7, -1, 4.9, 8);
    run_case(&c, &def);
    const ruga_mesh* out = &c.cut.material;
    assert_int_equal(out->attribute_count, 1);
    for (int f = 0; f < out->triangle_count; f++) {
        for (int i = 0; i < 3; i++) {
            const double* x = out->position + 3 * out->triangle[3 * f + i];
            const double* u = out->uv + 2 * out->uv_triangle[3 * f + i];
            assert_near(u[0], 0.1 * x[0], 1e-14);
            assert_near(u[1], 1 - 0.1 * x[1], 1e-14);
        }
    }
    for (int v = 0; v < out->vertex_count; v++) {
        assert_near(out->attribute[v], out->position[3 * v] + 2 * out->position[3 * v + 1], 1e-13);
        assert_true(out->source_vertex[v] == (v < m->vertex_count ? v : -1));
    }
    assert_status(ruga_curves_add_uv(&c.curves, &PLAIN, m, 2, (const double[2][2]){{0.1, 0.8}, {2, 2}}),
                  RUGA_BAD_INPUT);
    clear_case(&c);
}

static void a_curve_without_length_is_refused(void** state) {
    (void)state;
    ruga_curves curves = {0};
    const double point[3][3] = {{1, 2, 0}, {1, 2, 0}, {1, 2, 0}};
    assert_int_equal(ruga_curves_add_polyline(&curves, &PLAIN, 3, point), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "crease curve 0 has no length: its points are all (1, 2, 0)"));
    ruga_curves_clear(&curves);
}

// ------------------------------------------------------------------------------- mending

static void corners_of_a_polyline_become_vertices(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    const double point[5][3] = {{-1, 1.2, 0}, {2.3, 2.7, 0}, {3.4, 1.3, 0}, {5.2, 4.4, 0}, {9, 4.1, 0}};
    make_squares(8, 6, true, &c.mesh);
    assert_ok(ruga_curves_add_polyline(&c.curves, &PLAIN, 5, point));
    run_case(&c, &def);
    for (int k = 1; k < 4; k++) {
        double nearest = INFINITY;
        for (int v = 0; v < c.raster.mesh.vertex_count; v++) {
            nearest = fmin(nearest, ruga_distance(point[k], c.raster.mesh.position + 3 * v));
        }
        assert_near(nearest, 0, 1e-15);
    }
    assert_consistent(&c);
    clear_case(&c);
}

static void parallel_lines_closer_than_an_edge_are_taken_apart(void** state) {
    (void)state;
    for (int k = 1; k <= 4; k++) {
        crease_case c = {0};
        const ruga_raster_def def = ruga_default_raster_def();
        make_squares(8, 6, true, &c.mesh);
        for (int j = 0; j < 3; j++) {
            add_line(&c.curves, RUGA_FREEDOM_SINGLE, -1, 2.2 + 0.1 * k * j, 9, 2.7 + 0.1 * k * j);
        }
        run_case(&c, &def);
        for (int j = 0; j < 3; j++) {
            assert_false(c.raster.facts[j].bent);
            assert_near(c.raster.facts[j].length, 8 * sqrt(1 + 0.05 * 0.05), 1e-12);
        }
        assert_true(least_area(&c.raster.mesh) > 0.01);
        assert_consistent(&c);
        clear_case(&c);
    }
}

static void vertices_near_a_line_are_moved_onto_it(void** state) {
    (void)state;
    crease_case c = {0};
    ruga_raster_def def = ruga_default_raster_def();
    make_squares(8, 6, true, &c.mesh);
    add_line(&c.curves, RUGA_FREEDOM_SINGLE, -1, 3.05, 9, 3.05);
    run_case(&c, &def);
    assert_int_equal(c.raster.moved, 9); // those at its ends along the boundary
    assert_int_equal(c.sewing.row_count, 0);
    assert_int_equal(c.cut.segment_count, 8);
    clear_case(&c);
    make_squares(8, 6, true, &c.mesh);
    add_line(&c.curves, RUGA_FREEDOM_SINGLE, -1, 3.05, 9, 3.05);
    def.reach = 0;
    run_case(&c, &def);
    assert_int_equal(c.raster.moved, 0);
    assert_int_equal(c.sewing.row_count, 2 * 8 + 1);
    clear_case(&c);
}

// ------------------------------------------------------------------------------- fuzz

// Their middles, which tell where they are on the mesh, are all at the one place that becomes a vertex.
static void many_lines_over_the_border_may_meet_at_one_place(void** state) {
    (void)state;
    const ruga_raster_def def = ruga_default_raster_def();
    crease_case c = {.curves = {0}};
    make_squares(8, 6, false, &c.mesh);
    for (int k = 0; k < 9; k++) {
        double a = RUGA_PI * k / 9, x = 4.3, y = 3.4;
        add_line(&c.curves, RUGA_FREEDOM_AUTO, x - 20 * cos(a), y - 20 * sin(a), x + 20 * cos(a),
                 y + 20 * sin(a));
    }
    run_case(&c, &def);
    assert_consistent(&c);
    for (int k = 0; k < 9; k++) {
        assert_true(c.raster.facts[k].meets && c.raster.facts[k].length > 6);
        assert_near(c.raster.facts[k].placed, c.raster.facts[k].length, 1e-12);
    }
    clear_case(&c);
}

// Cuts before folds, then the first; how much of the others is left is known.
static void where_curves_lie_on_one_another_one_counts(void** state) {
    (void)state;
    const ruga_raster_def def = ruga_default_raster_def();
    const double line[4][2][3] = {{{-1, 2.3, 0}, {5, 2.3, 0}},
                                  {{3, 2.3, 0}, {9, 2.3, 0}},
                                  {{4, 2.3, 0}, {6, 2.3, 0}},
                                  {{-1, 0, 0}, {9, 0, 0}}};
    const double placed[4] = {4, 2, 2, 0}, left[4] = {1, 3, 0, 0};
    crease_case c = {.curves = {0}};
    make_squares(8, 6, true, &c.mesh);
    for (int k = 0; k < 4; k++) {
        const ruga_curve style = {.kind = k == 2 ? RUGA_CREASE_CUT : RUGA_CREASE_FOLD, .label = k};
        assert_ok(ruga_curves_add_polyline(&c.curves, &style, 2, line[k]));
    }
    run_case(&c, &def);
    for (int k = 0; k < 4; k++) {
        assert_near(c.raster.facts[k].placed, placed[k], 1e-12);
        assert_near(c.raster.facts[k].left, left[k], 1e-12);
    }
    clear_case(&c);
}

static void random_curves_on_random_meshes_are_cut_or_refused(void** state) {
    (void)state;
    int refused = 0, rows = 0, most_copies = 0;
    for (int k = 0; k < 1000; k++) {
        ruga_random random = {1000 + (uint64_t)k};
        crease_case c = {0};
        double size[2];
        random_mesh(&random, size, &c.mesh);
        random_curves(&random, size, &c.curves);
        const ruga_raster_def def = ruga_default_raster_def();
        ruga_status status = ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster);
        if (status != RUGA_OK) {
            assert_int_equal(status, RUGA_BAD_INPUT);
            assert_non_null(strstr(ruga_last_error(), "("));
            print_message("%d: %s\n", k, ruga_last_error());
            refused++;
        } else {
            assert_ok(ruga_cut_create(&c.raster, &c.cut));
            assert_ok(ruga_sewing_create(&c.cut, NULL, &c.sewing));
            assert_consistent(&c);
            assert_true(least_area(&c.raster.mesh) > 0);
            assert_int_equal(c.sewing.redundant_rows, 0); // S is positive definite as it is
            rows += c.sewing.row_count;
            for (int b = 0; b < c.cut.bound_count; b++) {
                most_copies = c.cut.bound[b].count > most_copies ? c.cut.bound[b].count : most_copies;
            }
        }
        clear_case(&c);
    }
    print_message("%d of 1000 refused, %d rows, at most %d copies\n", refused, rows, most_copies);
    assert_true(refused <= 10);
}

static void every_failed_allocation_is_a_status(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    make_squares(5, 5, true, &c.mesh);
    add_line(&c.curves, RUGA_FREEDOM_AUTO, -1, 1.3, 6, 3.7);
    add_line(&c.curves, RUGA_FREEDOM_AUTO, 2.2, 0.3, 2.9, 6);
    for (int k = 0;; k++) {
        let_allocations_fail_after(k);
        ruga_status status = ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster);
        status = status == RUGA_OK ? ruga_cut_create(&c.raster, &c.cut) : status;
        status = status == RUGA_OK ? ruga_sewing_create(&c.cut, NULL, &c.sewing) : status;
        ruga_set_allocator(NULL, NULL, NULL);
        ruga_raster_clear(&c.raster);
        ruga_cut_clear(&c.cut);
        ruga_sewing_clear(&c.sewing);
        if (status == RUGA_OK) {
            break;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
    }
    clear_case(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_above_the_mesh_are_projected_and_overhang_is_trimmed),
        cmocka_unit_test(a_curve_over_a_hole_is_two_pieces),
        cmocka_unit_test(a_curve_beside_the_mesh_is_refused),
        cmocka_unit_test(a_path_of_mesh_edges_is_a_crease_without_a_cut),
        cmocka_unit_test(borders_of_groups_become_closed_curves),
        cmocka_unit_test(uvs_groups_and_attributes_are_carried_along),
        cmocka_unit_test(a_curve_without_length_is_refused),
        cmocka_unit_test(corners_of_a_polyline_become_vertices),
        cmocka_unit_test(parallel_lines_closer_than_an_edge_are_taken_apart),
        cmocka_unit_test(vertices_near_a_line_are_moved_onto_it),
        cmocka_unit_test(many_lines_over_the_border_may_meet_at_one_place),
        cmocka_unit_test(where_curves_lie_on_one_another_one_counts),
        cmocka_unit_test(random_curves_on_random_meshes_are_cut_or_refused),
        cmocka_unit_test(every_failed_allocation_is_a_status),
    };
    return cmocka_run_group_tests_name("raster", tests, NULL, check_no_leak);
}
