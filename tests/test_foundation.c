// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "constraints/foundation.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "ruga/ruga.h"
#include "core/random.h"
#include "core/vec3.h"
#include "mesh/make.h"

#include <stdlib.h>
#include <string.h>

typedef struct fixture {
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    ruga_foundation foundation;
    int n; // unknowns
    double *d, *gradient;
} fixture;

static const double A = 3, B = 0.02;

static void set_up(const ruga_make_def* def, double a, double b, fixture* f) {
    assert_ok(ruga_mesh_make(def, &f->mesh));
    assert_ok(ruga_connectivity_create(&f->mesh, &f->connectivity));
    assert_ok(ruga_foundation_create(&f->mesh, &f->connectivity, a, b, &f->foundation));
    f->n = 3 * f->mesh.vertex_count;
    f->d = malloc((size_t)f->n * sizeof *f->d);
    f->gradient = calloc((size_t)f->n, sizeof *f->gradient);
    ruga_random random = {9};
    for (int i = 0; i < f->n; i++) {
        f->d[i] = ruga_random_uniform(&random) - 0.5;
    }
}

static void tear_down(fixture* f) {
    ruga_mesh_clear(&f->mesh);
    ruga_connectivity_clear(&f->connectivity);
    ruga_foundation_clear(&f->foundation);
    free(f->d);
    free(f->gradient);
}

static ruga_make_def sphere_def(double edge) {
    return (ruga_make_def){.shape = RUGA_SHAPE_SPHERE, .size = {1, 0, 0}, .edge = edge};
}

static void energy_is_half_of_d_W_d(void** state) {
    (void)state;
    fixture f;
    ruga_make_def def = sphere_def(0.1);
    set_up(&def, A, B, &f);
    double energy = ruga_foundation_energy(&f.foundation, f.d, f.gradient, NULL), product = 0;
    for (int i = 0; i < f.n; i++) {
        product += f.d[i] * f.gradient[i];
    }
    assert_true(energy > 0);
    assert_near(energy, product / 2, 1e-13 * energy);
    tear_down(&f);
}

// The energy is quadratic: a centred difference is exact but for round-off, at any step.
static void gradient_is_the_difference_of_energies(void** state) {
    (void)state;
    fixture f;
    ruga_make_def def = sphere_def(0.3);
    set_up(&def, A, B, &f);
    (void)ruga_foundation_energy(&f.foundation, f.d, f.gradient, NULL);
    const double steps[] = {1e-1, 1e-2, 1e-3};
    for (int s = 0; s < 3; s++) {
        for (int i = 0; i < f.n; i += 7) {
            double old = f.d[i];
            f.d[i] = old + steps[s];
            double up = ruga_foundation_energy(&f.foundation, f.d, NULL, NULL);
            f.d[i] = old - steps[s];
            double down = ruga_foundation_energy(&f.foundation, f.d, NULL, NULL);
            f.d[i] = old;
            assert_near((up - down) / (2 * steps[s]), f.gradient[i], 1e-11 + 1e-14 / steps[s]);
        }
    }
    tear_down(&f);
}

static void hessian_times_d_is_the_gradient(void** state) {
    (void)state;
    fixture f;
    ruga_make_def def = sphere_def(0.2);
    set_up(&def, A, B, &f);
    ruga_sparse w;
    int* slot = NULL;
    assert_ok(ruga_sparse_from_pairs(f.mesh.vertex_count, 3, f.connectivity.edge_count,
                                     (const int(*)[2])f.connectivity.edge, &w));
    assert_ok(ruga_foundation_map(&f.foundation, &w, &slot));
    ruga_foundation_add_hessian(&f.foundation, slot, w.value);
    double* wd = malloc((size_t)f.n * sizeof *wd);
    ruga_sparse_multiply_symmetric(&w, f.d, wd);
    (void)ruga_foundation_energy(&f.foundation, f.d, f.gradient, NULL);
    for (int i = 0; i < f.n; i++) {
        assert_near(wd[i], f.gradient[i], 1e-14);
    }
    // Added, not set:
    ruga_foundation_add_hessian(&f.foundation, slot, w.value);
    ruga_sparse_multiply_symmetric(&w, f.d, wd);
    assert_near(wd[0], 2 * f.gradient[0], 1e-14);
    free(wd);
    ruga_release(slot);
    ruga_sparse_clear(&w);
    tear_down(&f);
}

// d = x - Bq does not change when x and Bq move together; and a constant d strains no edge.
static void a_translation_costs_only_springs(void** state) {
    (void)state;
    fixture f;
    ruga_make_def def = sphere_def(0.1);
    set_up(&def, A, B, &f);
    for (int i = 0; i < f.n; i++) {
        f.d[i] = 0;
    }
    double square = -1;
    assert_near(ruga_foundation_energy(&f.foundation, f.d, f.gradient, &square), 0, 0);
    assert_near(square, 0, 0);
    for (int i = 0; i < f.n; i++) {
        f.d[i] = i % 3 == 1 ? 0.2 : 0;
    }
    double energy = ruga_foundation_energy(&f.foundation, f.d, NULL, NULL);
    assert_near(energy, 0.5 * A * 0.04 * ruga_mesh_area(&f.mesh), 1e-14);
    tear_down(&f);
}

// Displacement along the normal of amplitude 1: density (a + b k^2) / 4, up to the mesh's second-order error.
static void a_sine_wave_has_the_energy_of_theory(void** state) {
    (void)state;
    const ruga_pattern patterns[] = {RUGA_PATTERN_EQUILATERAL, RUGA_PATTERN_DIAGONAL,
                                     RUGA_PATTERN_ALTERNATING};
    for (int p = 0; p < 3; p++) {
        fixture f;
        ruga_make_def def = {
            .shape = RUGA_SHAPE_SHEET, .size = {2, 1, 0}, .edge = 0.02, .pattern = patterns[p]};
        const double k = 2 * RUGA_PI / 0.5;
        set_up(&def, A, A / (k * k), &f);
        for (int v = 0; v < f.mesh.vertex_count; v++) {
            f.d[3 * v] = f.d[3 * v + 1] = 0;
            f.d[3 * v + 2] = sin(k * f.mesh.position[3 * v]);
        }
        double density = ruga_foundation_energy(&f.foundation, f.d, NULL, NULL) / ruga_mesh_area(&f.mesh);
        print_message("  pattern %d: %.4f of (a + b k^2) / 4 at 25 edges per wavelength\n", p,
                      density / (2 * A / 4));
        assert_near(density, 2 * A / 4, 0.01 * 2 * A / 4);
        tear_down(&f);
    }
}

static void obtuse_triangles_leave_it_positive(void** state) {
    (void)state;
    // A rhombus cut along its long diagonal: both angles opposite the cut are obtuse.
    const double position[] = {-1, 0, 0, 1, 0, 0, 0, 0.2, 0, 0, -0.2, 0};
    const int triangle[] = {0, 1, 2, 1, 0, 3};
    ruga_mesh_def def = {
        .vertex_count = 4, .positions = position, .triangle_count = 2, .triangles = triangle};
    ruga_mesh mesh;
    ruga_connectivity c;
    ruga_foundation f;
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    assert_ok(ruga_connectivity_create(&mesh, &c));
    assert_ok(ruga_foundation_create(&mesh, &c, 0, 1, &f));
    ruga_random random = {4};
    bool negative_weight = false;
    for (int e = 0; e < f.edge_count; e++) {
        negative_weight |= f.edge_value[e] > 0;
    }
    assert_true(negative_weight);
    for (int trial = 0; trial < 100; trial++) {
        double d[12];
        for (int i = 0; i < 12; i++) {
            d[i] = ruga_random_uniform(&random) - 0.5;
        }
        assert_true(ruga_foundation_energy(&f, d, NULL, NULL) >= 0);
    }
    ruga_foundation_clear(&f);
    ruga_connectivity_clear(&c);
    ruga_mesh_clear(&mesh);
}

static void a_face_without_area_is_refused_by_name(void** state) {
    (void)state;
    const double position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0};
    const int triangle[] = {0, 1, 2, 1, 0, 3};
    ruga_mesh_def def = {
        .vertex_count = 4, .positions = position, .triangle_count = 2, .triangles = triangle};
    ruga_mesh mesh;
    ruga_connectivity c;
    ruga_foundation f;
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    assert_ok(ruga_connectivity_create(&mesh, &c));
    assert_status(ruga_foundation_create(&mesh, &c, A, B, &f), RUGA_BAD_MESH);
    assert_non_null(strstr(ruga_last_error(), "face 1 "));
    ruga_connectivity_clear(&c);
    ruga_mesh_clear(&mesh);
}

static void bits_do_not_depend_on_threads(void** state) {
    (void)state;
    fixture f;
    ruga_make_def def = sphere_def(0.02);
    set_up(&def, A, B, &f);
    double square[2], energy[2];
    double* second = calloc((size_t)f.n, sizeof *second);
    ruga_set_threads(1);
    energy[0] = ruga_foundation_energy(&f.foundation, f.d, f.gradient, &square[0]);
    ruga_set_threads(2);
    energy[1] = ruga_foundation_energy(&f.foundation, f.d, second, &square[1]);
    ruga_set_threads(0);
    assert_memory_equal(&energy[0], &energy[1], sizeof energy[0]);
    assert_memory_equal(&square[0], &square[1], sizeof square[0]);
    assert_memory_equal(f.gradient, second, (size_t)f.n * sizeof *second);
    free(second);
    tear_down(&f);
}

// A single displaced vertex: its own spring, and each edge's force at both of its ends.
static void force_square_is_the_sum_over_elements(void** state) {
    (void)state;
    fixture f;
    ruga_make_def def = sphere_def(0.3);
    set_up(&def, A, B, &f);
    memset(f.d, 0, (size_t)f.n * sizeof *f.d);
    f.d[0] = 0.5;
    double square, wanted = A * f.foundation.vertex_scale[0] * 0.5;
    wanted *= wanted;
    for (int e = 0; e < f.foundation.edge_count; e++) {
        if (f.foundation.edge[e][0] == 0 || f.foundation.edge[e][1] == 0) {
            wanted += 2 * 0.25 * f.foundation.edge_value[e] * f.foundation.edge_value[e];
        }
    }
    (void)ruga_foundation_energy(&f.foundation, f.d, NULL, &square);
    assert_near(square, wanted, 1e-14 * wanted);
    tear_down(&f);
}

static void any_allocation_may_fail(void** state) {
    (void)state;
    ruga_make_def def = sphere_def(0.3);
    ruga_status status = RUGA_NO_MEMORY;
    for (int k = 0; status != RUGA_OK; k++) {
        ruga_mesh mesh;
        ruga_connectivity c;
        ruga_foundation f;
        assert_ok(ruga_mesh_make(&def, &mesh));
        assert_ok(ruga_connectivity_create(&mesh, &c));
        let_allocations_fail_after(k);
        status = ruga_foundation_create(&mesh, &c, A, B, &f);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        ruga_foundation_clear(&f);
        ruga_set_allocator(NULL, NULL, NULL);
        ruga_connectivity_clear(&c);
        ruga_mesh_clear(&mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(energy_is_half_of_d_W_d),
        cmocka_unit_test(gradient_is_the_difference_of_energies),
        cmocka_unit_test(hessian_times_d_is_the_gradient),
        cmocka_unit_test(a_translation_costs_only_springs),
        cmocka_unit_test(a_sine_wave_has_the_energy_of_theory),
        cmocka_unit_test(obtuse_triangles_leave_it_positive),
        cmocka_unit_test(a_face_without_area_is_refused_by_name),
        cmocka_unit_test(bits_do_not_depend_on_threads),
        cmocka_unit_test(force_square_is_the_sum_over_elements),
        cmocka_unit_test(any_allocation_may_fail),
    };
    return cmocka_run_group_tests_name("foundation", tests, NULL, check_no_leak);
}
