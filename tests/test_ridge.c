// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "crease/pattern.h"
#include "crease/ridge.h"
#include "mesh/make.h"
#include "tests/scarce_memory.h"

#include <stdlib.h>
#include <string.h>

static const double EDGE = 0.02;

// A sheet of 1 x 0.8 m and room for its deformed positions.
static double* make_sheet(ruga_mesh* mesh) {
    const ruga_make_def def = {.shape = RUGA_SHAPE_SHEET, .size = {1, 0.8}, .edge = EDGE};
    assert_ok(ruga_mesh_make(&def, mesh));
    double* x = malloc((size_t)mesh->vertex_count * 3 * sizeof *x);
    memcpy(x, mesh->position, (size_t)mesh->vertex_count * 3 * sizeof *x);
    return x;
}

// Every point of a curve at most an edge from the line through `foot` along `along`.
static void assert_on_line(const ruga_curve* curve, const double foot[2], double angle, double length) {
    double way = ruga_distance(curve->point[0], curve->point[curve->point_count - 1]);
    for (int i = 0; i < curve->point_count; i++) {
        double dx = curve->point[i][0] - foot[0], dy = curve->point[i][1] - foot[1];
        assert_true(fabs(-sin(angle) * dx + cos(angle) * dy) < EDGE);
    }
    assert_near(way, length, 2 * EDGE);
}

static void a_bent_sheet_has_its_ridges_where_it_bends(void** state) {
    (void)state;
    ruga_mesh mesh;
    double* x = make_sheet(&mesh);
    // Turned over by 1 rad about a slanting line, and back by 1.2 rad about a parallel one 0.3 m on: an
    // isometry.
    static const double slant = 0.4, width = 0.03;
    for (int v = 0; v < mesh.vertex_count; v++) {
        const double* p = mesh.position + 3 * (size_t)v;
        double s = -sin(slant) * p[0] + cos(slant) * p[1], t = cos(slant) * p[0] + sin(slant) * p[1];
        double y = 0, z = 0;
        static const int steps = 400;
        for (int k = 0; k < steps; k++) { // midpoint rule along s
            double at = s * (k + 0.5) / steps;
            double turn = 0.5 * tanh((at + 0.15) / width) - 0.6 * tanh((at - 0.15) / width);
            y += cos(turn) * s / steps;
            z += sin(turn) * s / steps;
        }
        x[3 * v] = cos(slant) * t - sin(slant) * y;
        x[3 * v + 1] = sin(slant) * t + cos(slant) * y;
        x[3 * v + 2] = z;
    }
    ruga_curves curves = {0};
    const ruga_ridge_def def = ruga_default_ridge_def();
    assert_ok(ruga_ridges_find(&mesh, x, &def, &curves));
    assert_int_equal(curves.count, 2);
    for (int k = 0; k < 2; k++) {
        const ruga_curve* c = &curves.curve[k];
        bool valley = c->label == RUGA_ASSIGNMENT_VALLEY;
        double off = valley ? -0.15 : 0.15; // upwards is where the normals point
        const double foot[2] = {-sin(slant) * off, cos(slant) * off};
        // On the sheet: from side to side, x = -0.5 .. 0.5, but for what the corners cut off.
        double low = -0.5, high = 0.5;
        double top = (0.4 - foot[1]) / tan(slant) + foot[0], bottom = (-0.4 - foot[1]) / tan(slant) + foot[0];
        assert_on_line(c, foot, slant, (fmin(high, top) - fmax(low, bottom)) / cos(slant));
    }
    assert_true(curves.curve[0].label != curves.curve[1].label);
    ruga_curves_clear(&curves);
    // Only the stronger one is more than 0.9 of the strongest; none is longer than the sheet.
    ruga_ridge_def strict = def;
    strict.strength = 0.9;
    assert_ok(ruga_ridges_find(&mesh, x, &strict, &curves));
    assert_int_equal(curves.count, 1);
    assert_int_equal(curves.curve[0].label, RUGA_ASSIGNMENT_MOUNTAIN);
    ruga_curves_clear(&curves);
    strict = def;
    strict.min_length = 1.5;
    assert_ok(ruga_ridges_find(&mesh, x, &strict, &curves));
    assert_int_equal(curves.count, 0);
    ruga_mesh_clear(&mesh);
    free(x);
}

static void a_round_ridge_is_one_closed_curve(void** state) {
    (void)state;
    ruga_mesh mesh;
    double* x = make_sheet(&mesh);
    static const double radius = 0.25, width = 0.04;
    for (int v = 0; v < mesh.vertex_count; v++) {
        double r = hypot(x[3 * v], x[3 * v + 1]);
        x[3 * v + 2] =
            0.2 * width * log(cosh((r - radius) / width)); // slope tanh: steepest change at the radius
    }
    ruga_curves curves = {0};
    const ruga_ridge_def def = ruga_default_ridge_def();
    assert_ok(ruga_ridges_find(&mesh, x, &def, &curves));
    assert_int_equal(curves.count, 1);
    assert_true(curves.curve[0].closed);
    assert_int_equal(curves.curve[0].label, RUGA_ASSIGNMENT_VALLEY);
    assert_true(curves.curve[0].point_count < 60); // thinned
    for (int i = 0; i < curves.curve[0].point_count; i++) {
        assert_near(hypot(curves.curve[0].point[i][0], curves.curve[0].point[i][1]), radius, EDGE);
    }
    ruga_curves_clear(&curves);
    ruga_mesh_clear(&mesh);
    free(x);
}

static void compressed_places_are_ridges_of_stress(void** state) {
    (void)state;
    ruga_mesh mesh;
    double* x = make_sheet(&mesh);
    // Pressed together by 2 % along a line, in the plane, and stretched along another, which is no ridge.
    static const double slant = -0.3, width = 0.05;
    for (int v = 0; v < mesh.vertex_count; v++) {
        const double* p = mesh.position + 3 * (size_t)v;
        double s = -sin(slant) * p[0] + cos(slant) * p[1];
        double u = -0.02 * width * tanh((s - 0.1) / width) + 0.02 * width * tanh((s + 0.15) / width);
        x[3 * v] += -sin(slant) * u;
        x[3 * v + 1] += cos(slant) * u;
    }
    ruga_curves curves = {0};
    ruga_ridge_def def = ruga_default_ridge_def();
    def.stress = true;
    assert_ok(ruga_ridges_find(&mesh, x, &def, &curves));
    assert_int_equal(curves.count, 1);
    const double foot[2] = {-sin(slant) * 0.1, cos(slant) * 0.1};
    double low = (0.4 - foot[1]) / tan(slant) + foot[0];
    assert_int_equal(curves.curve[0].label, RUGA_ASSIGNMENT_UNASSIGNED);
    assert_on_line(&curves.curve[0], foot, slant, (0.5 - fmax(low, -0.5)) / cos(slant));
    ruga_curves_clear(&curves);
    // At rest there is nothing; nor after a rigid motion, but for round-off far below any strength.
    assert_ok(ruga_ridges_find(&mesh, mesh.position, &def, &curves));
    assert_int_equal(curves.count, 0);
    for (int k = 0;; k++) {
        let_allocations_fail_after(k);
        ruga_status status = ruga_ridges_find(&mesh, x, &def, &curves);
        ruga_set_allocator(NULL, NULL, NULL);
        ruga_curves_clear(&curves);
        if (status == RUGA_OK) {
            break;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
    }
    ruga_mesh_clear(&mesh);
    free(x);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bent_sheet_has_its_ridges_where_it_bends),
        cmocka_unit_test(a_round_ridge_is_one_closed_curve),
        cmocka_unit_test(compressed_places_are_ridges_of_stress),
    };
    return cmocka_run_group_tests_name("ridge", tests, NULL, check_no_leak);
}
