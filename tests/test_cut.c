// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/crease_case.h"

// As in the paper: the mesh is left as it is.
static ruga_raster_def plain_raster(void) {
    ruga_raster_def def = ruga_default_raster_def();
    def.snap = false;
    return def;
}

// Smallest eigenvalue of S for unit masses, and the ratio of the largest to it.
static double least_eigenvalue(const crease_case* c, double* condition) {
    int n = c->sewing.row_count;
    double *one = malloc((size_t)c->cut.node_count * sizeof *one),
           *full = malloc((size_t)(n * n) * sizeof *full);
    double *value = malloc((size_t)(n * n) * sizeof *value), least, most;
    for (int k = 0; k < c->cut.node_count; k++) {
        one[k] = 1;
    }
    ruga_sewing_matrix(&c->sewing, one, value);
    dense_from_lower(&c->sewing.pattern, value, full);
    dense_eigenvalue_range(n, full, &least, &most);
    *condition = most / least;
    free(one);
    free(full);
    free(value);
    return least;
}

static void assert_definite(const crease_case* c, double worst) {
    double condition;
    assert_true(least_eigenvalue(c, &condition) > 0);
    assert_true(condition < worst);
}

// ------------------------------------------------------------------------------- counts

static void a_diagonal_cut_brings_the_known_numbers(void** state) {
    (void)state;
    const ruga_raster_def def = plain_raster();
    for (int n = 10; n <= 40; n *= 2) {
        for (int rising = 0; rising < 2; rising++) {
            crease_case c = {0};
            make_squares(n, n, rising, &c.mesh);
            add_line(&c.curves, RUGA_FREEDOM_AUTO, -1, -1 + 0.37, n + 1, n + 1.37);
            run_case(&c, &def);
            int crossed = rising ? 2 * n - 1 : 4 * n - 2;
            assert_int_equal(new_triangles(&c), crossed);
            assert_int_equal(new_nodes(&c), crossed + 2);
            assert_int_equal(c.sewing.row_count, crossed + 1);
            assert_int_equal(c.sewing.redundant_rows, 0);
            clear_case(&c);
        }
    }
}

static void a_cut_through_vertices_turns_about_each_of_them(void** state) {
    (void)state;
    const ruga_raster_def def = plain_raster();
    for (int n = 4; n <= 16; n *= 2) {
        for (int rising = 0; rising < 2; rising++) {
            crease_case c = {0};
            make_squares(n, n, rising, &c.mesh);
            add_line(&c.curves, RUGA_FREEDOM_AUTO, 0, 0, n, n);
            run_case(&c, &def);
            // Across the mesh's diagonals: chords from vertex to edge. Along them: the crease is mesh edges.
            assert_int_equal(new_triangles(&c), rising ? 0 : 2 * n);
            assert_int_equal(new_nodes(&c), rising ? 0 : 2 * n);
            assert_int_equal(c.sewing.row_count, rising ? 0 : n);
            assert_int_equal(freedom_of(&c), rising ? 0 : n);
            if (!rising) {
                assert_definite(&c, 1 + 1e-12);
            }
            clear_case(&c);
        }
    }
}

// nx x ny squares with one cut across in each of `cuts` columns, between the grid's lines: a pleated skirt,
// unrolled. A radial cut of the sector of an annulus meets the same edges.
static void count_pleats(int nx, int ny, int cuts, crease_case* c) {
    const ruga_raster_def def = ruga_default_raster_def();
    make_squares(nx, ny, true, &c->mesh);
    for (int k = 0; k < cuts; k++) {
        double x = (int)((k + 0.5) * nx / cuts) + 0.45;
        add_line(&c->curves, RUGA_FREEDOM_AUTO, x, -1, x, ny + 1);
    }
    run_case(c, &def);
    assert_int_equal(c->raster.moved + c->raster.split_edges + c->raster.split_faces, 0);
    assert_int_equal(new_triangles(c), 2 * ny * cuts);
    assert_int_equal(new_nodes(c), cuts * (2 * ny + 2));
    assert_int_equal(c->sewing.row_count, cuts * (2 * ny + 1));
}

static void the_knife_pleated_skirt_has_the_papers_triangles(void** state) {
    (void)state;
    const int shapes[][3] = {{150, 39, 60}, {195, 30, 78}, {225, 26, 90}, {130, 45, 52}};
    for (int k = 0; k < 4; k++) {
        crease_case c = {0};
        count_pleats(shapes[k][0], shapes[k][1], shapes[k][2], &c);
        assert_int_equal(c.raster.mesh.triangle_count, 11700);
        assert_int_equal(c.cut.piece_count, 16380);
        if (k == 0) {
            assert_int_equal(c.raster.mesh.vertex_count, 6040);
            assert_int_equal(c.cut.node_count, 10840);
            assert_int_equal(c.sewing.row_count, 4740);
        }
        clear_case(&c);
    }
}

static void the_box_pleated_skirt_has_the_papers_triangles(void** state) {
    (void)state;
    crease_case c = {0};
    count_pleats(300, 36, 139, &c);
    assert_int_equal(c.raster.mesh.triangle_count, 21600);
    assert_int_equal(c.cut.piece_count, 31608);
    assert_int_equal(c.raster.mesh.vertex_count, 11137);
    assert_int_equal(c.cut.node_count, 21423);
    assert_int_equal(c.sewing.row_count, 10147);
    clear_case(&c);
}

// The same on the sector of an annulus itself, cuts along radii.
static void radial_cuts_of_a_skirt_have_the_same_numbers(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    make_squares(150, 39, true, &c.mesh);
    for (int v = 0; v < c.mesh.vertex_count; v++) {
        double* x = c.mesh.position + 3 * v;
        double r = 0.2 + 0.4 * x[1] / 39, angle = 5 * x[0] / 150;
        x[0] = r * cos(angle);
        x[1] = r * sin(angle);
    }
    for (int k = 0; k < 60; k++) {
        double angle = 5 * ((int)((k + 0.5) * 150 / 60) + 0.45) / 150;
        add_line(&c.curves, RUGA_FREEDOM_AUTO, 0.1 * cos(angle), 0.1 * sin(angle), 0.7 * cos(angle),
                 0.7 * sin(angle));
    }
    run_case(&c, &def);
    assert_int_equal(c.cut.piece_count, 16380);
    assert_int_equal(c.sewing.row_count, 4740);
    clear_case(&c);
}

// ------------------------------------------------------------------------------- freedom

static void a_plain_cut_has_one_freedom_and_auxiliary_chords_one_for_each_node(void** state) {
    (void)state;
    const ruga_raster_def def = plain_raster();
    for (int full = 0; full < 2; full++) {
        crease_case c = {0};
        make_squares(6, 6, false, &c.mesh);
        add_line(&c.curves, full ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_SINGLE, -1, -0.63, 7, 7.37);
        run_case(&c, &def);
        int crossed = 4 * 6 - 2;
        assert_int_equal(freedom_of(&c), full ? crossed + 1 : 1);
        assert_int_equal(new_triangles(&c), full ? 2 * crossed : crossed);
        assert_definite(&c, 1e7);
        clear_case(&c);
    }
}

static void an_end_inside_a_triangle_locks_unless_led_on_to_a_vertex(void** state) {
    (void)state;
    const double cut[3][4] = {{1.3, 3.6, 6.6, 3.7}, {-1, 3.6, 5.3, 3.7}, {1.3, 2.6, 6.6, 5.2}};
    for (int k = 0; k < 3; k++) {
        for (int extend = 0; extend < 2; extend++) {
            crease_case c = {0};
            ruga_raster_def def = plain_raster();
            def.extend = extend;
            make_squares(8, 8, true, &c.mesh);
            add_line(&c.curves, RUGA_FREEDOM_SINGLE, cut[k][0], cut[k][1], cut[k][2], cut[k][3]);
            run_case(&c, &def);
            assert_int_equal(freedom_of(&c), extend);
            // From inside to inside one row follows from the others; it is dropped.
            assert_int_equal(c.sewing.redundant_rows, !extend && k != 1);
            assert_definite(&c, 1e7);
            clear_case(&c);
        }
    }
}

static void with_snap_a_curve_ends_exactly_where_it_was_drawn(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    make_squares(8, 8, true, &c.mesh);
    add_line(&c.curves, RUGA_FREEDOM_SINGLE, 1.3, 3.45, 6.6, 3.52);
    run_case(&c, &def);
    assert_near(c.raster.facts[0].length, hypot(5.3, 0.07), 1e-14);
    assert_int_equal(freedom_of(&c) >= 1, 1);
    assert_false(c.raster.facts[0].bent);
    clear_case(&c);
}

static void lines_that_cross_on_edges_have_four_copies(void** state) {
    (void)state;
    // p lines across q lines that meet on horizontal mesh edges, in the middle.
    for (int p = 1; p <= 3; p++) {
        int q = p == 3 ? 3 : 2;
        crease_case c = {0};
        const ruga_raster_def def = plain_raster();
        make_squares(8, 9, true, &c.mesh);
        // Along x + y = const and x - y = const through middles of edges, where both lines meet.
        for (int k = 0; k < p; k++) {
            add_line(&c.curves, RUGA_FREEDOM_SINGLE, 2.5 + 2 * k - 20, 4 - 20, 2.5 + 2 * k + 20, 4 + 20);
        }
        for (int k = 0; k < q; k++) {
            add_line(&c.curves, RUGA_FREEDOM_SINGLE, 2.5 + 2 * k - 20, 4 + 20, 2.5 + 2 * k + 20, 4 - 20);
        }
        run_case(&c, &def);
        int most = 0, crossings = 0;
        for (int b = 0; b < c.cut.bound_count; b++) {
            most = c.cut.bound[b].count > most ? c.cut.bound[b].count : most;
            crossings += c.cut.bound[b].count == 4;
        }
        assert_int_equal(most, 4);
        // Not all lines meet within the sheet.
        assert_int_equal(freedom_of(&c), p + q + crossings);
        assert_definite(&c, 1e7);
        clear_case(&c);
    }
}

static void a_crossing_at_a_vertex_and_one_on_an_edge_have_the_known_rows(void** state) {
    (void)state;
    for (int at_vertex = 0; at_vertex < 2; at_vertex++) {
        crease_case c = {0};
        const ruga_raster_def def = plain_raster();
        make_squares(4, 4, true, &c.mesh);
        double y = at_vertex ? 2 : 2.5, x = 2;
        // Through (x, y), in slopes for which no edge is met twice.
        add_line(&c.curves, RUGA_FREEDOM_SINGLE, x - 4, y - 4 * 1.3, x + 4, y + 4 * 1.3);
        add_line(&c.curves, RUGA_FREEDOM_SINGLE, x - 4 * 0.29, y + 4, x + 4 * 0.29, y - 4);
        run_case(&c, &def);
        assert_int_equal(freedom_of(&c), at_vertex ? 4 : 3);
        assert_definite(&c, 1e7);
        clear_case(&c);
    }
}

static void a_crossing_within_a_triangle_is_refused_with_its_place_or_mended(void** state) {
    (void)state;
    for (int snap = 0; snap < 2; snap++) {
        crease_case c = {0};
        ruga_raster_def def = ruga_default_raster_def();
        def.snap = snap;
        make_squares(8, 8, true, &c.mesh);
        add_line(&c.curves, RUGA_FREEDOM_SINGLE, -1, 3.2, 9, 4.9);
        add_line(&c.curves, RUGA_FREEDOM_SINGLE, 3.2, -1, 4.7, 9);
        if (!snap) {
            assert_status(ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster), RUGA_BAD_INPUT);
            assert_non_null(strstr(ruga_last_error(), "curves 0 and 1 cross"));
        } else {
            run_case(&c, &def);
            assert_true(c.raster.facts[0].meets && c.raster.facts[1].meets);
            assert_false(c.raster.facts[0].bent || c.raster.facts[1].bent);
            assert_int_equal(freedom_of(&c) >= 4, 1);
            assert_definite(&c, 1e7);
        }
        clear_case(&c);
    }
}

static void a_closed_curve_can_fold(void** state) {
    (void)state;
    for (int full = 0; full < 2; full++) {
        crease_case c = {0};
        const ruga_raster_def def = ruga_default_raster_def();
        double point[40][3];
        for (int k = 0; k < 40; k++) {
            point[k][0] = 5.1 + 3.2 * cos(2 * RUGA_PI * k / 40);
            point[k][1] = 4.9 + 2.3 * sin(2 * RUGA_PI * k / 40);
            point[k][2] = 0;
        }
        make_squares(10, 10, true, &c.mesh);
        const ruga_curve style = {.closed = true, .freedom = full ? RUGA_FREEDOM_AUTO : RUGA_FREEDOM_SINGLE};
        assert_ok(ruga_curves_add_polyline(&c.curves, &style, 40, (const double(*)[3])point));
        run_case(&c, &def);
        assert_int_equal(c.raster.facts[0].full, full);
        assert_int_equal(freedom_of(&c) >= (full ? c.cut.bound_count : 1), 1);
        assert_definite(&c, 1e7);
        clear_case(&c);
    }
}

// ------------------------------------------------------------------------------- open cuts

static void an_open_cut_separates_and_a_slit_opens(void** state) {
    (void)state;
    const double across[2][3] = {{-1, 2.3, 0}, {9, 3.4, 0}}, slit[2][3] = {{2.2, 2.4, 0}, {5.8, 3.3, 0}};
    for (int k = 0; k < 2; k++) {
        crease_case c = {0};
        const ruga_raster_def def = ruga_default_raster_def();
        const ruga_curve style = {.kind = RUGA_CREASE_CUT};
        ruga_connectivity material;
        make_squares(8, 6, true, &c.mesh);
        assert_ok(ruga_curves_add_polyline(&c.curves, &style, 2, k ? slit : across));
        run_case(&c, &def);
        assert_int_equal(all_rows(&c), 0);
        assert_int_equal(c.cut.segment_count, 0);
        assert_ok(ruga_connectivity_create(&c.cut.material, &material));
        assert_int_equal(material.component_count, k ? 1 : 2);
        // The slit adds a boundary, so that the sheet becomes a ring; cut across it is two discs.
        assert_int_equal(c.cut.material.vertex_count - material.edge_count + c.cut.material.triangle_count,
                         k ? 0 : 2);
        assert_near(ruga_mesh_area(&c.cut.material), 48, 1e-12);
        ruga_connectivity_clear(&material);
        clear_case(&c);
    }
}

static void a_crease_across_an_open_cut_ends_on_both_its_sides(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    const ruga_curve open = {.kind = RUGA_CREASE_CUT};
    ruga_connectivity material;
    make_squares(8, 6, true, &c.mesh);
    assert_ok(ruga_curves_add_polyline(&c.curves, &open, 2, (const double[2][3]){{-1, 2.6, 0}, {9, 2.7, 0}}));
    add_line(&c.curves, RUGA_FREEDOM_FULL, 3.4, -1, 4.6, 7);
    run_case(&c, &def);
    assert_ok(ruga_connectivity_create(&c.cut.material, &material));
    assert_int_equal(material.component_count, 2);
    assert_int_equal(c.cut.real_count > c.raster.mesh.vertex_count, 1); // the vertex at the crossing, twice
    assert_int_equal(c.sewing.redundant_rows, 0);
    assert_definite(&c, 1e7);
    ruga_connectivity_clear(&material);
    clear_case(&c);
}

static void open_mesh_edges_part_their_vertices(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    const ruga_curve open = {.kind = RUGA_CREASE_CUT};
    ruga_connectivity edges;
    int path[9];
    make_squares(8, 6, true, &c.mesh);
    for (int i = 0; i < 9; i++) {
        path[i] = 9 * 3 + i;
    }
    assert_ok(ruga_connectivity_create(&c.mesh, &edges));
    assert_ok(ruga_curves_add_path(&c.curves, &open, &c.mesh, &edges, 9, path));
    run_case(&c, &def);
    assert_int_equal(c.cut.real_count, 63 + 9);
    assert_int_equal(c.cut.node_count, 63 + 9);
    ruga_connectivity_clear(&edges);
    clear_case(&c);
}

static void copies_of_a_vertex_are_listed_and_masses_add_up(void** state) {
    (void)state;
    crease_case c = {0};
    const ruga_raster_def def = ruga_default_raster_def();
    make_squares(8, 6, true, &c.mesh);
    add_line(&c.curves, RUGA_FREEDOM_FULL, -1, 2.6, 9, 2.7);
    run_case(&c, &def);
    double *mass = malloc((size_t)c.cut.node_count * sizeof *mass), sum = 0;
    double* triangle = malloc((size_t)c.raster.mesh.triangle_count * sizeof *triangle);
    for (int f = 0; f < c.raster.mesh.triangle_count; f++) {
        triangle[f] = 0.5;
    }
    ruga_cut_masses(&c.cut, triangle, 0, true, mass);
    for (int n = 0; n < c.cut.node_count; n++) {
        bool listed = false;
        for (int k = c.cut.copy_start[c.cut.source[n]]; k < c.cut.copy_start[c.cut.source[n] + 1]; k++) {
            listed = listed || c.cut.copy[k] == n;
        }
        assert_true(listed && mass[n] > 0);
        sum += mass[n];
    }
    assert_near(sum, 48, 1e-12);
    double centre[2] = {0, 0};
    for (int n = 0; n < c.cut.node_count; n++) {
        for (int i = 0; i < 2; i++) {
            centre[i] += mass[n] * c.raster.mesh.position[3 * c.cut.source[n] + i] / sum;
        }
    }
    assert_near(centre[0], 4, 1e-12);
    assert_near(centre[1], 3, 1e-12);
    double least = INFINITY;
    ruga_cut_masses(&c.cut, triangle, 0.02, false, mass);
    for (int n = 0; n < c.cut.node_count; n++) {
        least = fmin(least, mass[n]);
    }
    assert_true(least >= 0.02 * 0.5 / 3 * (1 - 1e-12));
    // All copies of a vertex held: rows between them are none.
    bool* fixed = malloc((size_t)c.cut.node_count * sizeof *fixed);
    for (int n = 0; n < c.cut.node_count; n++) {
        fixed[n] = c.raster.mesh.position[3 * c.cut.source[n]] < 0.5;
    }
    int before = c.sewing.row_count;
    ruga_sewing_clear(&c.sewing);
    assert_ok(ruga_sewing_create(&c.cut, fixed, &c.sewing));
    assert_int_equal(c.sewing.fixed_rows, 1);
    assert_int_equal(c.sewing.row_count, before - 1);
    free(mass);
    free(triangle);
    free(fixed);
    clear_case(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_diagonal_cut_brings_the_known_numbers),
        cmocka_unit_test(a_cut_through_vertices_turns_about_each_of_them),
        cmocka_unit_test(the_knife_pleated_skirt_has_the_papers_triangles),
        cmocka_unit_test(the_box_pleated_skirt_has_the_papers_triangles),
        cmocka_unit_test(radial_cuts_of_a_skirt_have_the_same_numbers),
        cmocka_unit_test(a_plain_cut_has_one_freedom_and_auxiliary_chords_one_for_each_node),
        cmocka_unit_test(an_end_inside_a_triangle_locks_unless_led_on_to_a_vertex),
        cmocka_unit_test(with_snap_a_curve_ends_exactly_where_it_was_drawn),
        cmocka_unit_test(lines_that_cross_on_edges_have_four_copies),
        cmocka_unit_test(a_crossing_at_a_vertex_and_one_on_an_edge_have_the_known_rows),
        cmocka_unit_test(a_crossing_within_a_triangle_is_refused_with_its_place_or_mended),
        cmocka_unit_test(a_closed_curve_can_fold),
        cmocka_unit_test(an_open_cut_separates_and_a_slit_opens),
        cmocka_unit_test(a_crease_across_an_open_cut_ends_on_both_its_sides),
        cmocka_unit_test(open_mesh_edges_part_their_vertices),
        cmocka_unit_test(copies_of_a_vertex_are_listed_and_masses_add_up),
    };
    return cmocka_run_group_tests_name("cut", tests, NULL, check_no_leak);
}
