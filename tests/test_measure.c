// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "app/measure.h"
#include "core/vec3.h"
#include "mesh/make.h"

#include <stdlib.h>
#include <string.h>

static const double WAVELENGTH = 0.02; // m

typedef struct sheet {
    ruga_mesh mesh;
    ruga_measure* measure;
    double *flat, *bent; // [V][3]
} sheet;

static void make_sheet(sheet* s) {
    ruga_make_def make = {
        .shape = RUGA_SHAPE_SHEET, .size = {12 * WAVELENGTH, 3 * WAVELENGTH, 0}, .edge = WAVELENGTH / 12};
    *s = (sheet){.flat = NULL};
    assert_ok(ruga_mesh_make(&make, &s->mesh));
    assert_ok(ruga_measure_create(&s->mesh, WAVELENGTH, 1, &s->measure));
    size_t bytes = 3 * (size_t)s->mesh.vertex_count * sizeof(double);
    s->flat = malloc(bytes);
    s->bent = malloc(bytes);
    assert_true(s->flat && s->bent);
    memcpy(s->flat, s->mesh.position, bytes);
    memcpy(s->bent, s->mesh.position, bytes);
}

static void free_sheet(sheet* s) {
    ruga_measure_destroy(&s->measure);
    ruga_mesh_clear(&s->mesh);
    free(s->flat);
    free(s->bent);
}

// z += height cos(2 pi (x cos a + y sin a) / length)
static void add_wave(sheet* s, double height, double length, double angle, double* position) {
    for (int v = 0; v < s->mesh.vertex_count; v++) {
        const double* x = s->mesh.position + 3 * v;
        position[3 * v + 2] +=
            height * cos(2 * RUGA_PI * (x[0] * cos(angle) + x[1] * sin(angle)) / length + 0.3);
    }
}

static ruga_measured measure(sheet* s) {
    ruga_measured m;
    assert_ok(ruga_measure_frame(s->measure, s->bent, s->flat, &m));
    return m;
}

static void a_sine_has_its_wavelength_and_amplitude(void** state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        double length = WAVELENGTH * (0.8 + 0.15 * k), height = 1e-3;
        sheet s;
        make_sheet(&s);
        add_wave(&s, height, length, 0, s.bent);
        ruga_measured m = measure(&s);
        print_message("wavelength %.4f, by spectrum %.4f, amplitude %.4f\n", m.wavelength / length,
                      m.wavelength_fft / length, m.amplitude / height);
        assert_near(m.wavelength, length, 0.02 * length);
        assert_near(m.wavelength_fft, length, 0.02 * length);
        assert_near(m.amplitude, height, 0.02 * height);
        free_sheet(&s);
    }
}

static void a_broad_bulge_is_filtered_out(void** state) {
    (void)state;
    sheet s;
    make_sheet(&s);
    add_wave(&s, 1e-3, 12 * WAVELENGTH, 0, s.bent);
    double bulge = measure(&s).amplitude;
    print_message("%.2f %% of the bulge is left\n", 100 * bulge / 1e-3);
    assert_true(bulge < 0.05 * 1e-3);
    add_wave(&s, 1e-3, WAVELENGTH, 0, s.bent);
    ruga_measured m = measure(&s);
    assert_near(m.wavelength, WAVELENGTH, 0.03 * WAVELENGTH);
    assert_near(m.wavelength_fft, WAVELENGTH, 0.02 * WAVELENGTH);
    assert_near(m.amplitude, 1e-3, 0.03 * 1e-3);
    free_sheet(&s);
}

// What the embedded surface does is not a wrinkle, and displacements along it are not either.
static void only_normal_displacements_from_the_embedded_surface_count(void** state) {
    (void)state;
    sheet s;
    make_sheet(&s);
    add_wave(&s, 5e-3, 6 * WAVELENGTH, 0, s.flat);
    memcpy(s.bent, s.flat, 3 * (size_t)s.mesh.vertex_count * sizeof(double));
    ruga_measured m = measure(&s);
    assert_near(m.amplitude, 0, 1e-15);
    assert_near(m.wavelength, 0, 0);
    memcpy(s.flat, s.mesh.position, 3 * (size_t)s.mesh.vertex_count * sizeof(double));
    memcpy(s.bent, s.flat, 3 * (size_t)s.mesh.vertex_count * sizeof(double));
    for (int v = 0; v < s.mesh.vertex_count; v++) {
        s.bent[3 * v] += 1e-3 * sin(2 * RUGA_PI * s.mesh.position[3 * v] / WAVELENGTH);
    }
    assert_near(measure(&s).amplitude, 0, 1e-15);
    free_sheet(&s);
}

static void volume_is_that_of_the_deformed_mesh(void** state) {
    (void)state;
    ruga_mesh mesh = {0};
    ruga_measure* m;
    ruga_measured measured;
    ruga_make_def make = {.shape = RUGA_SHAPE_BAR, .size = {0.3, 0.2, 0.1}, .edge = 0.05};
    assert_ok(ruga_mesh_make(&make, &mesh));
    assert_ok(ruga_measure_create(&mesh, 0, 1, &m));
    double* x = malloc(3 * (size_t)mesh.vertex_count * sizeof *x);
    assert_non_null(x);
    for (int i = 0; i < 3 * mesh.vertex_count; i++) {
        x[i] = mesh.position[i] * (i % 3 == 0 ? 2 : 1);
    }
    assert_ok(ruga_measure_frame(m, x, mesh.position, &measured));
    assert_near(measured.volume, 0.012, 1e-12);
    assert_near(measured.wavelength_fft, 0, 0); // a body has no strips
    free(x);
    ruga_measure_destroy(&m);
    ruga_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sine_has_its_wavelength_and_amplitude),
        cmocka_unit_test(a_broad_bulge_is_filtered_out),
        cmocka_unit_test(only_normal_displacements_from_the_embedded_surface_count),
        cmocka_unit_test(volume_is_that_of_the_deformed_mesh),
    };
    return cmocka_run_group_tests_name("measure", tests, NULL, check_no_leak);
}
