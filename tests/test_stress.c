// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "app/stress.h"
#include "core/vec3.h"
#include "mesh/make.h"

static const double YOUNG = 3e6, POISSON = 0.35;

typedef struct sheet {
    ruga_mesh mesh;
    double *x, *work, *stress;
} sheet;

static sheet make_sheet(void) {
    sheet s;
    assert_ok(ruga_mesh_make(&(ruga_make_def){.shape = RUGA_SHAPE_SHEET, .size = {0.2, 0.1, 0}, .edge = 0.02},
                             &s.mesh));
    s.x = test_calloc(3 * (size_t)s.mesh.vertex_count, sizeof *s.x);
    s.work = test_calloc((size_t)s.mesh.vertex_count, sizeof *s.work);
    s.stress = test_calloc((size_t)s.mesh.vertex_count, sizeof *s.stress);
    return s;
}

static void free_sheet(sheet* s) {
    ruga_mesh_clear(&s->mesh);
    test_free(s->x);
    test_free(s->work);
    test_free(s->stress);
}

// x = R diag(a, b) X + c, with R a turn out of the plane.
static void deform(sheet* s, double a, double b, double turn) {
    for (int v = 0; v < s->mesh.vertex_count; v++) {
        const double* rest = s->mesh.position + 3 * v;
        s->x[3 * v] = cos(turn) * a * rest[0] + 1;
        s->x[3 * v + 1] = b * rest[1] - 2;
        s->x[3 * v + 2] = sin(turn) * a * rest[0];
    }
}

static void assert_stress(sheet* s, const ruga_stress_skin* skin, double wanted) {
    ruga_stress_compute(&s->mesh, skin, s->x, s->work, s->stress);
    for (int v = 0; v < s->mesh.vertex_count; v++) {
        assert_near(s->stress[v], wanted, 1e-9 * YOUNG);
    }
}

// Principal Cauchy stresses a S_1 / b and b S_2 / a.
static double closed_form(double a, double b) {
    double ea = 0.5 * (a * a - 1), eb = 0.5 * (b * b - 1), k = YOUNG / (1 - POISSON * POISSON);
    double sa = k * (ea + POISSON * eb) * a / b, sb = k * (eb + POISSON * ea) * b / a;
    return sqrt(sa * sa - sa * sb + sb * sb);
}

static void stretched_and_turned_sheet_has_the_closed_form(void** state) {
    (void)state;
    sheet s = make_sheet();
    ruga_stress_skin skin = {.young = YOUNG, .poisson = POISSON, .growth = {1, 1}};
    deform(&s, 1, 1, 0.7);
    assert_stress(&s, &skin, 0);
    deform(&s, 1.02, 1, 0.7);
    assert_stress(&s, &skin, closed_form(1.02, 1));
    deform(&s, 0.9, 1.2, -2);
    assert_stress(&s, &skin, closed_form(0.9, 1.2));
    // In tension along one direction alone it is that stress: E e at small strain.
    double e = 1e-6;
    deform(&s, 1 + e, 1 - POISSON * e, 0);
    ruga_stress_compute(&s.mesh, &skin, s.x, s.work, s.stress);
    assert_near(s.stress[7], YOUNG * e, 1e-5 * YOUNG * e);
    free_sheet(&s);
}

static void growth_and_varying_stiffness_count(void** state) {
    (void)state;
    sheet s = make_sheet();
    ruga_stress_skin skin = {.young = YOUNG, .poisson = POISSON, .growth = {1.1, 0.95}};
    deform(&s, 1.1, 0.95, 0.3); // the grown skin is at rest in it
    assert_stress(&s, &skin, 0);
    double* young = test_calloc((size_t)s.mesh.vertex_count, sizeof *young);
    for (int v = 0; v < s.mesh.vertex_count; v++) {
        young[v] = 2 * YOUNG;
    }
    skin = (ruga_stress_skin){.young = 1, .poisson = POISSON, .growth = {1, 1}, .vertex_young = young};
    deform(&s, 1.05, 1, 0);
    assert_stress(&s, &skin, 2 * closed_form(1.05, 1));
    test_free(young);
    free_sheet(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stretched_and_turned_sheet_has_the_closed_form),
        cmocka_unit_test(growth_and_varying_stiffness_count),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
