// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "app/validate/film.h"
#include "core/memory.h"
#include "core/random.h"
#include "core/vec3.h"
#include "lattice/kirchhoff.h"
#include "lattice/volume.h"
#include "mesh/make.h"
#include "ruga/ruga.h"
#include "solver/state.h"
#include "tests/deformations.h"

#include <stdlib.h>
#include <string.h>

//---- splines ----

static const double GRID[] = {-3, -1, 0, 0.5, 0.75};
enum { CELLS = 4 };

static void functions_add_up_and_reproduce_straight_lines(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        for (int kink = 0; kink < CELLS; kink++) {
            ruga_spline s;
            assert_ok(ruga_spline_create(degree, CELLS, GRID, kink, &s));
            for (double x = -3; x <= 0.75; x += 0.0625) {
                double value[3], slope[3], sum = 0, line = 0, rise = 0;
                int cell = ruga_spline_cell(&s, x);
                assert_true(GRID[cell] <= x && x <= GRID[cell + 1]);
                ruga_spline_basis(&s, cell, x, value, slope);
                for (int i = 0; i <= degree; i++) {
                    double place = ruga_spline_greville(&s, s.first[cell] + i);
                    assert_true(value[i] >= 0);
                    sum += value[i];
                    line += value[i] * place;
                    rise += slope[i] * place;
                }
                assert_near(sum, 1, 1e-14);
                assert_near(line, x, 1e-14);
                assert_near(rise, 1, 1e-13);
            }
            ruga_spline_clear(&s);
        }
    }
}

static void a_kink_lets_the_slope_jump_there_and_nowhere_else(void** state) {
    (void)state;
    ruga_spline s;
    assert_ok(ruga_spline_create(2, CELLS, GRID, 2, &s));
    assert_int_equal(s.count, CELLS + 3);
    for (int border = 1; border < CELLS; border++) {
        double jump = 0, value[3], left[3], right[3], all[16] = {0};
        ruga_spline_basis(&s, border - 1, GRID[border], value, left);
        ruga_spline_basis(&s, border, GRID[border], value, right);
        for (int i = 0; i < 3; i++) {
            all[s.first[border - 1] + i] += left[i];
            all[s.first[border] + i] -= right[i];
        }
        for (int i = 0; i < s.count; i++) {
            jump = fmax(jump, fabs(all[i]));
        }
        assert_true(border == 2 ? jump > 1 : jump < 1e-13);
    }
    ruga_spline_clear(&s);
}

static void a_grid_that_does_not_ascend_is_refused(void** state) {
    (void)state;
    ruga_spline s;
    assert_status(ruga_spline_create(2, 2, (const double[]){0, 1, 1}, 0, &s), RUGA_BAD_INPUT);
}

//---- St. Venant-Kirchhoff ----

static void kirchhoff_is_isotropic_and_has_its_closed_form(void** state) {
    (void)state;
    ruga_random random = {5};
    for (double s = 0.5; s < 2; s += 0.25) {
        double f[9] = {s, 0, 0, 0, 1, 0, 0, 0, 1}, r[9], rf[9], rfr[9], p[9], e = 0.5 * (s * s - 1);
        assert_near(ruga_kirchhoff(MU, LAMBDA, f, p, NULL), (MU + LAMBDA / 2) * e * e, 1e-14);
        assert_near(p[0], s * (2 * MU + LAMBDA) * e, 1e-14);
        random_rotation(&random, r);
        multiply(r, f, rf);
        multiply(rf, r, rfr);
        assert_near(ruga_kirchhoff(MU, LAMBDA, rfr, NULL, NULL), (MU + LAMBDA / 2) * e * e, 1e-13);
    }
}

static void kirchhoff_derivatives_are_centred_differences_at_second_order(void** state) {
    (void)state;
    ruga_random random = {6};
    for (int k = 0; k < GRADIENT_COUNT; k++) {
        double d[9], p[9], hessian[81], error[2][2] = {{0}};
        random_matrix(&random, d);
        ruga_kirchhoff(MU, LAMBDA, GRADIENTS[k], p, hessian);
        for (int fine = 0; fine < 2; fine++) {
            double a[9], b[9], pa[9], pb[9], h = fine ? 1e-3 : 2e-3;
            for (int i = 0; i < 9; i++) {
                a[i] = GRADIENTS[k][i] + h * d[i];
                b[i] = GRADIENTS[k][i] - h * d[i];
            }
            double ea = ruga_kirchhoff(MU, LAMBDA, a, pa, NULL), eb = ruga_kirchhoff(MU, LAMBDA, b, pb, NULL);
            error[0][fine] = fabs((ea - eb) / (2 * h) - dot(9, p, d));
            for (int i = 0; i < 9; i++) {
                error[1][fine] += fabs((pa[i] - pb[i]) / (2 * h) - dot(9, &hessian[9 * i], d));
            }
        }
        for (int i = 0; i < 2; i++) {
            assert_true(error[i][0] < 1e-3);
            assert_near(error[i][0] / error[i][1], 4, 0.1);
        }
    }
}

//---- volume ----

static const double DEPTH[] = {-2, -0.7, 0, 0.15, 0.3};

static ruga_volume_def small_def(int degree, ruga_volume_law law) {
    return (ruga_volume_def){.degree = degree,
                             .size = {1.5, 0.8},
                             .cells = {3, 2},
                             .layers = 4,
                             .depth = DEPTH,
                             .interface = 2,
                             .young = {YOUNG, 20 * YOUNG},
                             .poisson = {POISSON, 0.4},
                             .law = law};
}

static void affine(const ruga_volume* v, const double a[9], const double b[3], double* u) {
    for (int i = 0; i < v->node_count; i++) {
        double X[3], y[3];
        ruga_volume_node(v, i, X);
        ruga_multiply3(a, X, y);
        for (int c = 0; c < 3; c++) {
            u[3 * i + c] = y[c] + b[c] - X[c];
        }
    }
}

static void rest_and_rigid_motion_have_no_energy_and_no_force(void** state) {
    (void)state;
    ruga_random random = {7};
    for (int trial = 0; trial < 4; trial++) {
        ruga_volume v;
        ruga_volume_def def = small_def(1 + trial % 2, (ruga_volume_law)(trial / 2));
        double r[9], energy, u[1000], gradient[1000];
        assert_ok(ruga_volume_create(&def, &v));
        random_rotation(&random, r);
        affine(&v, r, (const double[3]){100, 20, -3}, u);
        assert_ok(ruga_volume_energy(&v, u, &energy, gradient, NULL, NULL));
        assert_near(energy, 0, 1e-22 * YOUNG * 1e4);
        for (int i = 0; i < 3 * v.node_count; i++) {
            assert_near(gradient[i], 0, 1e-11 * YOUNG);
        }
        ruga_volume_clear(&v);
    }
}

static void energy_does_not_change_under_a_rotation_of_a_deformed_state(void** state) {
    (void)state;
    ruga_random random = {17};
    ruga_volume v;
    ruga_volume_def def = small_def(2, RUGA_VOLUME_COROTATIONAL);
    double r[9], before, after, u[1000], turned[1000];
    assert_ok(ruga_volume_create(&def, &v));
    random_rotation(&random, r);
    for (int i = 0; i < v.node_count; i++) {
        double X[3], x[3], y[3];
        ruga_volume_node(&v, i, X);
        for (int c = 0; c < 3; c++) {
            u[3 * i + c] = 0.05 * signed_random(&random);
            x[c] = X[c] + u[3 * i + c];
        }
        ruga_multiply3(r, x, y);
        ruga_subtract(y, X, &turned[3 * i]);
    }
    assert_ok(ruga_volume_energy(&v, u, &before, NULL, NULL, NULL));
    assert_ok(ruga_volume_energy(&v, turned, &after, NULL, NULL, NULL));
    assert_near(after, before, 1e-12 * before);
    ruga_volume_clear(&v);
}

static void uniaxial_strain_has_the_closed_form_energy(void** state) {
    (void)state;
    const double s = 0.9, area = 1.5 * 0.8;
    for (int degree = 1; degree <= 2; degree++) {
        ruga_volume v;
        ruga_volume_def def = small_def(degree, RUGA_VOLUME_COROTATIONAL);
        double energy, u[1000], wanted = 0;
        assert_ok(ruga_volume_create(&def, &v));
        affine(&v, (const double[9]){s, 0, 0, 0, 1, 0, 0, 0, 1}, (const double[3]){0}, u);
        assert_ok(ruga_volume_energy(&v, u, &energy, NULL, NULL, NULL));
        for (int m = 0; m < 2; m++) {
            wanted += (m ? 0.3 : 2.) * area * (v.mu[m] + v.lambda[m] / 2) * (s - 1) * (s - 1);
        }
        assert_near(energy, wanted, 1e-13 * wanted);
        ruga_volume_clear(&v);
    }
}

// Errors of centred differences along a random direction: of the energy, and of the gradient (sum of
// squares).
static void difference_errors(const ruga_volume* v, const double* u, const double* d, double h,
                              double error[2]) {
    int n = 3 * v->node_count;
    double a[1000], b[1000], ga[1000], gb[1000], g[1000], product[1000], ea, eb, e;
    ruga_sparse hessian = v->pattern;
    assert_ok(RUGA_NEW(hessian.value, hessian.start[n]));
    for (int i = 0; i < n; i++) {
        a[i] = u[i] + h * d[i];
        b[i] = u[i] - h * d[i];
    }
    assert_ok(ruga_volume_energy(v, a, &ea, ga, NULL, NULL));
    assert_ok(ruga_volume_energy(v, b, &eb, gb, NULL, NULL));
    assert_ok(ruga_volume_energy(v, u, &e, g, hessian.value, NULL));
    ruga_sparse_multiply_symmetric(&hessian, d, product);
    error[0] = fabs((ea - eb) / (2 * h) - dot(n, g, d));
    error[1] = 0;
    for (int i = 0; i < n; i++) {
        double difference = (ga[i] - gb[i]) / (2 * h) - product[i];
        error[1] += difference * difference;
    }
    error[1] = sqrt(error[1]);
    ruga_release(hessian.value);
}

static void gradient_and_hessian_are_centred_differences_at_second_order(void** state) {
    (void)state;
    ruga_random random = {8};
    for (int trial = 0; trial < 6; trial++) {
        ruga_volume v;
        ruga_volume_def def = small_def(1 + trial % 2, (ruga_volume_law)(trial / 2 % 2));
        def.cells[1] = trial < 4 ? 2 : 0;
        double u[1000], d[1000], coarse[2], fine[2];
        assert_ok(ruga_volume_create(&def, &v));
        assert_true(3 * v.node_count <= 1000);
        for (int i = 0; i < 3 * v.node_count; i++) {
            u[i] = 0.05 * signed_random(&random);
            d[i] = 0.3 * signed_random(&random);
        }
        difference_errors(&v, u, d, 2e-3, coarse);
        difference_errors(&v, u, d, 1e-3, fine);
        for (int i = 0; i < 2; i++) {
            assert_near(coarse[i] / fine[i], 4, 0.2);
        }
        ruga_volume_clear(&v);
    }
}

// ---- solver ----

static bool on_border(const ruga_volume* v, int node) {
    int x = node % v->axis[0].count, y = node / v->axis[0].count % v->axis[1].count,
        z = node / v->axis[0].count / v->axis[1].count;
    return x == 0 || x == v->axis[0].count - 1 || y == 0 || y == v->axis[1].count - 1 || z == 0 ||
           z == v->axis[2].count - 1;
}

static void patch_test_an_affine_border_makes_an_affine_body(void** state) {
    (void)state;
    static const double a[9] = {1.05, 0.1, -0.02, 0.03, 0.95, 0.04, 0.01, -0.06, 1.02};
    for (int trial = 0; trial < 4; trial++) {
        ruga_volume v;
        ruga_volume_def def = small_def(1 + trial % 2, (ruga_volume_law)(trial / 2));
        ruga_volume_solver* solver;
        ruga_volume_report report;
        bool held[1000];
        double wanted[1000], u[1000] = {0};
        def.young[1] = def.young[0]; // one material
        def.poisson[1] = def.poisson[0];
        assert_ok(ruga_volume_create(&def, &v));
        affine(&v, a, (const double[3]){0.1, 0, 0}, wanted);
        for (int i = 0; i < 3 * v.node_count; i++) {
            held[i] = on_border(&v, i / 3);
            u[i] = held[i] ? wanted[i] : 0;
        }
        assert_ok(ruga_volume_solver_create(&v, held, 1, &solver));
        assert_ok(ruga_volume_solve(solver, 1e-12, u, &report));
        assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
        for (int i = 0; i < 3 * v.node_count; i++) {
            assert_near(u[i], wanted[i], 1e-11);
        }
        double X[3] = {0.4, 0.3, 0.1}, y[3], moved[3];
        ruga_volume_displacement(&v, u, X, moved);
        ruga_multiply3(a, X, y);
        assert_near(X[0] + moved[0], y[0] + 0.1, 1e-11);
        ruga_volume_solver_destroy(&solver);
        ruga_volume_clear(&v);
    }
}

static film_def coarse_film(void) {
    film_def def = film_default();
    def.cells = 6;
    def.below = 8;
    return def;
}

static void halving_the_cells_quarters_the_error_of_linear_ones(void** state) {
    (void)state;
    film_def reference = film_default(), def = coarse_film();
    double half = 0.5 * film_wavelength(&def), wanted, error[3];
    assert_ok(film_critical(&reference, half, &wanted));
    def.degree = 1;
    for (int i = 0; i < 3; i++, def = film_halved(&def)) {
        double strain;
        assert_ok(film_critical(&def, half, &strain));
        error[i] = strain / wanted - 1;
        assert_true(error[i] > 0);
    }
    assert_near(log2(error[1] / error[2]), 2, 0.15);
    assert_near(wanted, film_strain(&reference), 0.15 * wanted);
}

static void the_flat_state_is_left_past_the_critical_strain_only(void** state) {
    (void)state;
    film_def def = coarse_film();
    double half = 0.5 * film_wavelength(&def), critical;
    assert_ok(film_critical(&def, half, &critical));
    film_point points[3] = {
        {.strain = 0.5 * critical}, {.strain = 0.98 * critical}, {.strain = 1.5 * critical}};
    assert_ok(film_branch(&def, half, 3, points));
    for (int k = 0; k < 3; k++) {
        assert_int_equal(points[k].outcome, RUGA_OUTCOME_MINIMUM);
    }
    // Flat as computed in closed form: it needs no iteration and has no amplitude.
    assert_int_equal(points[0].iterations, 0);
    assert_int_equal(points[1].iterations, 0);
    assert_near(points[1].amplitude, 0, 1e-12 * def.thickness);
    assert_near(points[2].amplitude, def.thickness * sqrt(0.5), 0.1 * def.thickness);
}

static void threads_do_not_change_a_bit(void** state) {
    (void)state;
    film_def def = coarse_film();
    double half = 0.5 * film_wavelength(&def);
    film_point one = {.strain = 1.5 * film_strain(&def)}, two = one;
    ruga_set_threads(1);
    assert_ok(film_branch(&def, half, 1, &one));
    ruga_set_threads(2);
    assert_ok(film_branch(&def, half, 1, &two));
    ruga_set_threads(0);
    assert_true(one.amplitude > 0 && memcmp(&one.amplitude, &two.amplitude, sizeof one.amplitude) == 0);
}

static void a_material_that_is_none_is_refused(void** state) {
    (void)state;
    ruga_volume v;
    ruga_volume_def def = small_def(2, RUGA_VOLUME_COROTATIONAL);
    def.poisson[1] = 0.5;
    assert_status(ruga_volume_create(&def, &v), RUGA_BAD_INPUT);
    def = small_def(2, RUGA_VOLUME_COROTATIONAL);
    def.size[0] = 0;
    assert_status(ruga_volume_create(&def, &v), RUGA_BAD_INPUT);
}

// ---- as the skin of a scene ----------------------------------------------------------------------------

// A strip of two waves: 4 % compression of a film whose critical strain is 2.7 %.
typedef struct strip {
    ruga_mesh mesh;
    ruga_keyframe_def keys[2];
    ruga_model_def def;
} strip;

static void make_strip(strip* s) {
    *s = (strip){.def = ruga_default_model_def()};
    ruga_make_def make = {.shape = RUGA_SHAPE_SHEET, .size = {0.04, 0.002, 0}, .edge = 2e-3};
    assert_ok(ruga_mesh_make(&make, &s->mesh));
    s->def.mesh = ruga_mesh_as_def(&s->mesh);
    s->def.skin.model = RUGA_SKIN_VOLUME;
    s->def.skin.thickness = 1e-3;
    s->def.skin.young = 1e7;
    s->def.interior.young = 1e5;
    s->def.interior.motion = RUGA_INTERIOR_PRESCRIBED;
    s->def.lattice.fill = RUGA_FILL_BOX;
    s->def.lattice.cells = 16;
    s->def.lattice.depth = 0.02;
    s->def.frames = 3;
    s->keys[0] = s->keys[1] = ruga_default_keyframe_def();
    s->keys[1].time = 3 * s->def.step;
    s->keys[1].matrix[0] = 0.96;
    s->def.keyframes = s->keys;
    s->def.keyframe_count = 2;
}

static void run_strip(const ruga_model* model, ruga_state* state, int frames, ruga_report* report) {
    for (int k = 0; k < frames; k++) {
        assert_ok(ruga_state_step(model, state, report));
        assert_int_equal(report->outcome, RUGA_OUTCOME_MINIMUM);
    }
}

static double rms_height(const ruga_model* model, const double* x) {
    double mean = 0, square = 0;
    int n = model->mesh.vertex_count;
    for (int v = 0; v < n; v++) {
        mean += x[3 * v + 2] / n;
    }
    for (int v = 0; v < n; v++) {
        square += (x[3 * v + 2] - mean) * (x[3 * v + 2] - mean) / n;
    }
    return sqrt(square);
}

static void a_scenes_volume_wrinkles_past_the_critical_strain_and_resumes_to_the_bit(void** state) {
    (void)state;
    strip s;
    ruga_model* model;
    ruga_state *one, *two;
    ruga_report report;
    make_strip(&s);
    assert_ok(ruga_model_create(&s.def, &model));
    size_t n = 3 * (size_t)model->mesh.vertex_count;
    assert_ok(ruga_state_create(model, &one));
    assert_near(rms_height(model, ruga_state_positions(one)), 0, 1e-15);
    run_strip(model, one, 1, &report);
    assert_near(rms_height(model, ruga_state_positions(one)), 0, 1e-7);
    double *restart = NULL, x = ruga_state_positions(one)[0];
    assert_near(x, -0.5 * 0.04 * (1 - 0.04 / 3), 1e-12); // the side follows the keyframes
    assert_ok(RUGA_NEW(restart, ruga_state_restart_size(model)));
    ruga_state_save(one, restart);
    run_strip(model, one, 2, &report);
    assert_true(report.energy_interior > 0);
    assert_near(rms_height(model, ruga_state_positions(one)), 0.5e-3, 0.15e-3);
    ruga_set_threads(2);
    assert_ok(ruga_state_create(model, &two));
    assert_ok(ruga_state_load(two, restart));
    run_strip(model, two, 2, &report);
    ruga_set_threads(0);
    assert_memory_equal(ruga_state_positions(one), ruga_state_positions(two), n * sizeof(double));
    ruga_release(restart);
    ruga_state_destroy(&one);
    ruga_state_destroy(&two);
    ruga_model_destroy(&model);
    ruga_mesh_clear(&s.mesh);
}

static void a_scene_that_no_volume_can_follow_is_refused(void** state) {
    (void)state;
    ruga_handle_def handle = ruga_default_handle_def();
    for (int fault = 0; fault < 8; fault++) {
        strip s;
        ruga_model* model = NULL;
        make_strip(&s);
        switch (fault) {
        case 0:
            s.def.interior.motion = RUGA_INTERIOR_QUASISTATIC;
            break;
        case 1:
            s.def.lattice.fill = RUGA_FILL_MESH;
            break;
        case 2:
            s.keys[1].matrix[1] = 0.1;
            break;
        case 3:
            s.def.gravity[2] = -9.81;
            break;
        case 4:
            s.def.handles = &handle, s.def.handle_count = 1;
            break;
        case 5:
            s.def.skin.growth[0] = 1.1;
            break;
        case 6:
            s.mesh.position[2] += 1e-4;
            break;
        default:
            s.def.lattice.cells = 6;
            break; // too coarse
        }
        ruga_status status = ruga_model_create(&s.def, &model);
        assert_int_equal(status, fault == 6 ? RUGA_BAD_MESH : RUGA_BAD_INPUT);
        assert_null(model);
        assert_non_null(strstr(ruga_last_error(), fault == 7 ? "lattice.cells" : "skin.model: volume"));
        ruga_mesh_clear(&s.mesh);
    }
}

static void any_failed_allocation_is_a_status_and_leaks_nothing(void** state) {
    (void)state;
    film_def def = coarse_film();
    def.cells = def.below = 2;
    size_t before = ruga_byte_count();
    ruga_status status = RUGA_NO_MEMORY;
    ruga_set_threads(1);
    for (int k = 0; status != RUGA_OK && k < 1000; k++) {
        film_point point = {.strain = 1e-3};
        let_allocations_fail_after(k);
        status = film_branch(&def, 0.5 * film_wavelength(&def), 1, &point);
        ruga_set_allocator(NULL, NULL, NULL);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        assert_int_equal(ruga_byte_count(), before);
    }
    assert_int_equal(status, RUGA_OK);
    ruga_set_threads(0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(functions_add_up_and_reproduce_straight_lines),
        cmocka_unit_test(a_kink_lets_the_slope_jump_there_and_nowhere_else),
        cmocka_unit_test(a_grid_that_does_not_ascend_is_refused),
        cmocka_unit_test(kirchhoff_is_isotropic_and_has_its_closed_form),
        cmocka_unit_test(kirchhoff_derivatives_are_centred_differences_at_second_order),
        cmocka_unit_test(rest_and_rigid_motion_have_no_energy_and_no_force),
        cmocka_unit_test(energy_does_not_change_under_a_rotation_of_a_deformed_state),
        cmocka_unit_test(uniaxial_strain_has_the_closed_form_energy),
        cmocka_unit_test(gradient_and_hessian_are_centred_differences_at_second_order),
        cmocka_unit_test(patch_test_an_affine_border_makes_an_affine_body),
        cmocka_unit_test(halving_the_cells_quarters_the_error_of_linear_ones),
        cmocka_unit_test(the_flat_state_is_left_past_the_critical_strain_only),
        cmocka_unit_test(threads_do_not_change_a_bit),
        cmocka_unit_test(a_material_that_is_none_is_refused),
        cmocka_unit_test(a_scenes_volume_wrinkles_past_the_critical_strain_and_resumes_to_the_bit),
        cmocka_unit_test(a_scene_that_no_volume_can_follow_is_refused),
        cmocka_unit_test(any_failed_allocation_is_a_status_and_leaks_nothing),
    };
    return cmocka_run_group_tests_name("volume", tests, NULL, check_no_leak);
}
