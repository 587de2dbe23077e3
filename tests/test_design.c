// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "crease/design.h"
#include "crease/flat.h"
#include "io/fold.h"
#include "mesh/make.h"

#include <stdlib.h>
#include <string.h>

static int count_edges(const ruga_crease_pattern* p, ruga_assignment assignment) {
    int count = 0;
    for (int e = 0; e < p->edge_count; e++) {
        count += p->edge[e].assignment == assignment;
    }
    return count;
}

static void assert_meshed_area(const ruga_crease_pattern* p, double area) {
    ruga_mesh mesh;
    assert_ok(ruga_crease_pattern_mesh(p, "pattern", &mesh));
    assert_near(ruga_mesh_area(&mesh), area, 1e-12 * area);
    ruga_mesh_clear(&mesh);
}

static void assert_size(const ruga_crease_pattern* p, double x, double y) {
    double high[2] = {0, 0};
    for (int v = 0; v < p->vertex_count; v++) {
        high[0] = fmax(high[0], p->position[v][0]);
        high[1] = fmax(high[1], p->position[v][1]);
    }
    assert_near(high[0], x / 2, 1e-12);
    assert_near(high[1], y / 2, 1e-12);
}

static int count_faults(const ruga_crease_pattern* p, ruga_flat_fault_kind kind) {
    ruga_flat_fault* fault;
    int count, of_kind = 0;
    assert_ok(ruga_crease_pattern_flat_faults(p, &count, &fault));
    for (int i = 0; i < count; i++) {
        char text[200];
        ruga_flat_fault_say(p, &fault[i], text);
        assert_non_null(strstr(text, "cannot fold flat: "));
        of_kind += kind == RUGA_FLAT_KIND_COUNT || fault[i].kind == kind;
    }
    ruga_release(fault);
    return of_kind;
}

static void made_patterns_have_their_size_and_fold_flat(void** state) {
    (void)state;
    ruga_crease_pattern p;
    ruga_design_def def = {.design = RUGA_DESIGN_MIURA, .size = {0.4, 0.3}, .cells = {8, 9}};
    assert_ok(ruga_crease_pattern_design(&def, &p));
    assert_int_equal(p.face_count, 72);
    assert_size(&p, 0.4, 0.3);
    assert_int_equal(count_faults(&p, RUGA_FLAT_KIND_COUNT), 0);
    assert_int_equal(count_edges(&p, RUGA_ASSIGNMENT_BORDER), 34);
    ruga_crease_pattern_clear(&p);
    // Its fold angles at a slope close around a vertex: the four rotations are one, whatever the slope.
    def.fold = 0.6;
    assert_ok(ruga_crease_pattern_design(&def, &p));
    double straight = 0, zigzag = 0;
    for (int e = 0; e < p.edge_count; e++) {
        const double *x = p.position[p.edge[e].vertex[0]], *y = p.position[p.edge[e].vertex[1]];
        double* angle = fabs(x[0] - y[0]) < 1e-9 ? &straight : &zigzag;
        *angle = p.edge[e].rim ? *angle : fabs(p.edge[e].angle);
    }
    // zigzag: between panels that both stand at the slope; tan(straight / 2) = cos(gamma) tan(zigzag / 2)
    assert_near(zigzag, 2 * 0.6, 1e-12);
    assert_near(tan(straight / 2), cos(RUGA_PI / 3) * tan(zigzag / 2), 1e-12);
    ruga_crease_pattern_clear(&p);
    def = (ruga_design_def){.design = RUGA_DESIGN_WATERBOMB, .size = {0.4}, .cells = {3, 4}};
    assert_ok(ruga_crease_pattern_design(&def, &p));
    assert_size(&p, 0.4, 0.4);
    assert_int_equal(p.face_count, 2 * 3 * 8 + 2 * 3 * 4);
    assert_int_equal(count_faults(&p, RUGA_FLAT_KIND_COUNT), 0);
    ruga_crease_pattern_clear(&p);
    def = (ruga_design_def){.design = RUGA_DESIGN_PLEATS, .size = {0.4, 0.2}, .cells = {3, 2}, .fold = 1};
    assert_ok(ruga_crease_pattern_design(&def, &p));
    assert_int_equal(p.face_count, 4);
    ruga_curves curves = {0};
    assert_ok(ruga_crease_pattern_curves(&p, &(ruga_curve){0}, false, &curves));
    assert_int_equal(curves.count, 3);
    assert_near(ruga_crease_pattern_rest(&p.edge[curves.curve[1].label]), 1, 1e-15);
    ruga_curves_clear(&curves);
    ruga_crease_pattern_clear(&p);
    def = (ruga_design_def){.design = RUGA_DESIGN_ARCS, .size = {0.1}, .cells = {5, 1}};
    assert_ok(ruga_crease_pattern_design(&def, &p));
    double ring = 48 * sin(RUGA_PI / 48) * (0.04 - 0.01);
    assert_meshed_area(&p, ring);
    ruga_crease_pattern_clear(&p);
    def.size[2] = RUGA_PI / 2;
    assert_ok(ruga_crease_pattern_design(&def, &p));
    assert_int_equal(p.face_count, 6);
    assert_meshed_area(&p, ring / 4);
    ruga_crease_pattern_clear(&p);
    def = (ruga_design_def){.design = RUGA_DESIGN_PLEATS, .size = {0.4, 0.2}, .cells = {20, 1}};
    assert_status(ruga_crease_pattern_design(&def, &p), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "do not fit"));
    def = (ruga_design_def){.design = RUGA_DESIGN_MIURA, .size = {0.4, 0.01}, .cells = {2, 8}};
    assert_status(ruga_crease_pattern_design(&def, &p), RUGA_BAD_INPUT);
}

static void vertices_that_cannot_fold_flat_are_named(void** state) {
    (void)state;
    ruga_crease_pattern p;
    static const ruga_design_def def = {.design = RUGA_DESIGN_WATERBOMB, .size = {4}, .cells = {2, 2}};
    assert_ok(ruga_crease_pattern_design(&def, &p));
    int balance[2] = {0, 0};
    for (int e = 0; e < p.edge_count; e++) { // one more mountain less
        const int* v = p.edge[e].vertex;
        if (!p.edge[e].rim && balance[0] == 0) {
            p.edge[e].assignment = p.edge[e].assignment == RUGA_ASSIGNMENT_MOUNTAIN
                                       ? RUGA_ASSIGNMENT_VALLEY
                                       : RUGA_ASSIGNMENT_MOUNTAIN;
            balance[0] = v[0];
            balance[1] = v[1];
        }
    }
    assert_in_range(count_faults(&p, RUGA_FLAT_MAEKAWA), 1, 2);
    assert_int_equal(count_faults(&p, RUGA_FLAT_KIND_COUNT), count_faults(&p, RUGA_FLAT_MAEKAWA));
    // A vertex that is moved: its own angles and those around its neighbours.
    int inner = -1;
    for (int v = 0; v < p.vertex_count; v++) {
        inner = fabs(p.position[v][0]) < 0.1 && fabs(p.position[v][1]) < 0.1 ? v : inner;
    }
    assert_true(inner >= 0);
    p.position[inner][0] += 0.1;
    assert_true(count_faults(&p, RUGA_FLAT_KAWASAKI) > 1);
    // Creases that are not folded do not count: three are left somewhere.
    for (int e = 0; e < p.edge_count; e++) {
        p.edge[e].assignment = p.edge[e].vertex[0] == inner ? RUGA_ASSIGNMENT_FLAT : p.edge[e].assignment;
    }
    assert_true(count_faults(&p, RUGA_FLAT_ODD) > 0);
    ruga_crease_pattern_clear(&p);
    // Curved creases bend, and arcs that end within the sheet end.
    static const ruga_design_def wave = {.design = RUGA_DESIGN_PLEATS, .size = {4}, .cells = {1, 1}};
    assert_ok(ruga_crease_pattern_design(&wave, &p));
    assert_int_equal(count_faults(&p, RUGA_FLAT_BENDS),
                     30); // but at its turning point, and the ends on the border
    for (int e = 0; e < p.edge_count; e++) {
        bool half = p.position[p.edge[e].vertex[0]][0] + p.position[p.edge[e].vertex[1]][0] > 0;
        p.edge[e].assignment = !p.edge[e].rim && half ? RUGA_ASSIGNMENT_FLAT : p.edge[e].assignment;
    }
    assert_int_equal(count_faults(&p, RUGA_FLAT_ENDS), 1);
    ruga_crease_pattern_clear(&p);
}

static void curves_can_be_written_edited_and_read_back(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_curves curves = {0}, again = {0};
    ruga_crease_pattern p = {0}, q;
    const ruga_make_def def = {.shape = RUGA_SHAPE_SHEET, .size = {1, 0.5}, .edge = 0.1};
    const double bent[4][3] = {{-0.5, 0.1}, {-0.1, 0.2}, {0.2, -0.1}, {0.3, 0.1}},
                 round[3][3] = {{-0.3, -0.2}, {-0.2, -0.2}, {-0.2, -0.1}};
    const ruga_curve valley = {.label = RUGA_ASSIGNMENT_VALLEY},
                     mountain = {.label = RUGA_ASSIGNMENT_MOUNTAIN, .closed = true};
    assert_ok(ruga_mesh_make(&def, &mesh));
    assert_ok(ruga_curves_add_polyline(&curves, &valley, 4, bent));
    assert_ok(ruga_curves_add_polyline(&curves, &mountain, 3, round));
    assert_ok(ruga_crease_pattern_add_curves(&p, &curves));
    assert_ok(ruga_crease_pattern_add_boundary(&p, &mesh));
    for (int drawing = 0; drawing < 2; drawing++) {
        const ruga_fold_frame frame = {(const double*)p.position, NULL, 0};
        assert_ok(drawing ? ruga_svg_write("test_design.svg", &p, 1e-3)
                          : ruga_fold_write("test_design.fold", &p, "m", true, 1, &frame));
        assert_ok(drawing ? ruga_svg_read("test_design.svg", 1e-3, 1e-3, &q)
                          : ruga_fold_read("test_design.fold", 0, 1, &q));
        assert_meshed_area(&q, 0.5);
        assert_ok(ruga_crease_pattern_curves(&q, &(ruga_curve){.label = 0}, false, &again));
        assert_int_equal(again.count, 2);
        for (int k = 0; k < 2; k++) {
            const ruga_curve *a = &again.curve[k], *b = &curves.curve[k];
            assert_int_equal(a->point_count, b->point_count);
            assert_int_equal(a->closed, b->closed);
            assert_int_equal(q.edge[a->label].assignment, b->label);
            for (int i = 0; i < b->point_count; i++) {
                double nearest = 1;
                for (int j = 0; j < a->point_count; j++) {
                    nearest = fmin(nearest, ruga_distance(a->point[j], b->point[i]));
                }
                assert_near(nearest, 0, 1e-12);
            }
        }
        ruga_curves_clear(&again);
        ruga_crease_pattern_clear(&q);
    }
    ruga_curves_clear(&curves);
    ruga_crease_pattern_clear(&p);
    ruga_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(made_patterns_have_their_size_and_fold_flat),
        cmocka_unit_test(curves_can_be_written_edited_and_read_back),
        cmocka_unit_test(vertices_that_cannot_fold_flat_are_named),
    };
    return cmocka_run_group_tests_name("design", tests, NULL, check_no_leak);
}
