// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/vec3.h"
#include "lattice/corotational.h"
#include "lattice/svd3.h"
#include "tests/deformations.h"
#include "tests/dense.h"

#include <string.h>

//---- svd3 ----

static void check_svd(const double f[9]) {
    double u[9], s[3], v[9], largest = 0;
    ruga_svd3(f, u, s, v);
    for (int i = 0; i < 9; i++) {
        largest = fmax(largest, fabs(f[i]));
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double fij = 0, uu = 0, vv = 0;
            for (int k = 0; k < 3; k++) {
                fij += u[3 * i + k] * s[k] * v[3 * j + k];
                uu += u[3 * k + i] * u[3 * k + j];
                vv += v[3 * k + i] * v[3 * k + j];
            }
            assert_near(fij, f[3 * i + j], 1e-14 * largest);
            assert_near(uu, i == j, 1e-14);
            assert_near(vv, i == j, 1e-14);
        }
    }
    double c[3];
    ruga_cross(u, u + 3, c);
    assert_near(ruga_dot(c, u + 6), 1, 1e-14);
    ruga_cross(v, v + 3, c);
    assert_near(ruga_dot(c, v + 6), 1, 1e-14);
    assert_true(s[0] >= s[1] * (1 - 1e-14) && s[1] >= fabs(s[2]) * (1 - 1e-14) && s[1] >= 0);
}

static void svd_restores_random_and_degenerate_matrices(void** state) {
    (void)state;
    static const double values[][3] = {
        {1, 1, 1},      {1, 1, -1},          {2, 1, 1},        {2, 2, -1},        {1, 1, 0},
        {1, 0, 0},      {0, 0, 0},           {1, 1e-9, -1e-9}, {3, 1e-20, 0},     {1, 1e-8, 1e-16},
        {1e200, 1, -1}, {1e-200, 1e-220, 0}, {-1, -1, -1},     {1, 1 + 1e-13, 1}, {1, 1 - 1e-15, -1}};
    ruga_random random = {1};
    for (int trial = 0; trial < 2000; trial++) {
        double a[9], b[9], f[9];
        random_matrix(&random, f);
        check_svd(f);
        random_rotation(&random, a);
        random_rotation(&random, b);
        const double* s = values[trial % (int)(sizeof values / sizeof *values)];
        for (int i = 0; i < 9; i++) {
            a[i] *= s[i % 3];
        }
        multiply(a, b, f);
        check_svd(f);
        double diagonal[9] = {s[0], 0, 0, 0, s[1], 0, 0, 0, s[2]};
        check_svd(diagonal);
    }
}

static void svd_keeps_small_singular_values_accurate(void** state) {
    (void)state;
    // Columns of very different lengths: singular values 1, 1e-10, 1e-20 to full relative accuracy.
    double f[9] = {0.6, -0.8e-10, 0, 0.8, 0.6e-10, 0, 0, 0, 1e-20}, u[9], s[3], v[9];
    ruga_svd3(f, u, s, v);
    assert_near(s[0], 1, 1e-15);
    assert_near(s[1] / 1e-10, 1, 1e-14);
    assert_near(s[2] / 1e-20, 1, 1e-14);
}

static void eigen3_restores_symmetric_matrices(void** state) {
    (void)state;
    ruga_random random = {2};
    for (int trial = 0; trial < 1000; trial++) {
        double b[9], a[9], value[3], vector[9];
        random_matrix(&random, b);
        for (int i = 0; i < 9; i++) {
            a[i] = b[i] + b[i % 3 * 3 + i / 3];
        }
        if (trial % 3 == 0) {
            a[1] = a[3] = a[2] = a[6] = 0;
        }
        ruga_eigen3(a, value, vector);
        for (int i = 0; i < 9; i++) {
            double sum = 0, unit = 0;
            for (int k = 0; k < 3; k++) {
                sum += vector[i / 3 * 3 + k] * value[k] * vector[i % 3 * 3 + k];
                unit += vector[3 * k + i / 3] * vector[3 * k + i % 3];
            }
            assert_near(sum, a[i], 1e-14);
            assert_near(unit, i / 3 == i % 3, 1e-14);
        }
    }
}

//---- one point ----

static void energies_match_closed_forms(void** state) {
    (void)state;
    for (double s = -0.5; s < 2; s += 0.25) {
        double uniaxial[9] = {1, 0, 0, 0, s, 0, 0, 0, 1};
        double wanted = (MU + LAMBDA / 2) * (s - 1) * (s - 1);
        assert_near(ruga_corotational(MU, LAMBDA, uniaxial, false, NULL, NULL), wanted, 1e-14);
        double shear[9] = {1, s, 0, 0, 1, 0, 0, 0, 1};
        wanted = MU * (s * s + 4 - 2 * sqrt(s * s + 4)); // s1 - 1/s1 = shear, hence s1 + 1/s1 = sqrt(s^2 + 4)
        assert_near(ruga_corotational(MU, LAMBDA, shear, false, NULL, NULL), wanted, 1e-14);
        double t = s + 1, dilatation[9] = {t, 0, 0, 0, t, 0, 0, 0, t};
        wanted = 3 * MU * s * s + LAMBDA / 2 * (t * t * t - 1) * (t * t * t - 1);
        assert_near(ruga_corotational(MU, LAMBDA, dilatation, false, NULL, NULL), wanted,
                    1e-13 * (1 + wanted));
    }
}

static void uniaxial_stress_matches_closed_form(void** state) {
    (void)state;
    double f[9] = {1.5, 0, 0, 0, 1, 0, 0, 0, 1}, p[9];
    ruga_corotational(MU, LAMBDA, f, false, p, NULL);
    assert_near(p[0], 2 * MU * 0.5 + LAMBDA * 0.5, 1e-14);
    assert_near(p[4], LAMBDA * 0.5 * 1.5, 1e-14);
    assert_near(p[1], 0, 1e-14);
}

// Errors of the centred differences of energy and stress along `d` with step h.
static void difference_errors(const double f[9], const double d[9], double h, double error[2]) {
    double a[9], b[9], pa[9], pb[9], p[9], hessian[81];
    for (int i = 0; i < 9; i++) {
        a[i] = f[i] + h * d[i];
        b[i] = f[i] - h * d[i];
    }
    double ea = ruga_corotational(MU, LAMBDA, a, false, pa, NULL);
    double eb = ruga_corotational(MU, LAMBDA, b, false, pb, NULL);
    ruga_corotational(MU, LAMBDA, f, false, p, hessian);
    error[0] = fabs((ea - eb) / (2 * h) - dot(9, p, d));
    error[1] = 0;
    for (int i = 0; i < 9; i++) {
        double e = (pa[i] - pb[i]) / (2 * h) - dot(9, &hessian[9 * i], d);
        error[1] += e * e;
    }
    error[1] = sqrt(error[1]);
}

static void stress_and_its_derivative_are_centred_differences_at_second_order(void** state) {
    (void)state;
    ruga_random random = {3};
    for (int k = 0; k < GRADIENT_COUNT; k++) {
        double d[9], coarse[2], fine[2];
        random_matrix(&random, d);
        difference_errors(GRADIENTS[k], d, 2e-3, coarse);
        difference_errors(GRADIENTS[k], d, 1e-3, fine);
        for (int i = 0; i < 2; i++) {
            assert_true(coarse[i] < 1e-3);
            assert_near(coarse[i] / fine[i], 4, 0.1);
        }
    }
}

static void hessian_is_symmetric_and_its_projection_semi_definite(void** state) {
    (void)state;
    ruga_random random = {4};
    for (int trial = 0; trial < 500; trial++) {
        double f[9], exact[81], projected[81], low, high;
        random_matrix(&random, f);
        for (int i = 0; i < 9; i++) {
            f[i] = trial < GRADIENT_COUNT ? GRADIENTS[trial][i] : 2 * f[i];
        }
        ruga_corotational(MU, LAMBDA, f, false, NULL, exact);
        ruga_corotational(MU, LAMBDA, f, true, NULL, projected);
        for (int i = 0; i < 81; i++) {
            int transposed = i % 9 * 9 + i / 9;
            assert_near(exact[i], exact[transposed], 1e-13 * (1 + fabs(exact[i])));
        }
        double copy[81];
        memcpy(copy, exact, sizeof copy);
        dense_eigenvalue_range(9, copy, &low, &high);
        if (low >= 0) { // nothing to project
            for (int i = 0; i < 81; i++) {
                assert_near(projected[i], exact[i], 1e-13 * high);
            }
        }
        dense_eigenvalue_range(9, projected, &low, &high);
        assert_true(low >= -1e-13 * high);
    }
}

static void hessian_stays_bounded_at_the_kink(void** state) {
    (void)state;
    static const double collapsed[][9] = {{0}, {1, 0, 0, 0, 0, 0, 0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, -1}};
    for (int k = 0; k < 3; k++) {
        double p[9], hessian[81];
        double energy = ruga_corotational(MU, LAMBDA, collapsed[k], false, p, hessian);
        assert_true(isfinite(energy) && energy > 0);
        assert_true(dot(9, p, p) > 0.1); // nothing rests where it should not
        for (int i = 0; i < 81; i++) {
            assert_true(fabs(hessian[i]) <= 4e6 * MU + 10 * LAMBDA);
        }
    }
}

static void not_a_number_stays_visible(void** state) {
    (void)state;
    double f[9] = {1, 0, 0, 0, NAN, 0, 0, 0, 1}, all[9];
    for (int i = 0; i < 9; i++) {
        all[i] = NAN;
    }
    assert_true(isnan(ruga_corotational(MU, LAMBDA, f, true, NULL, NULL)));
    assert_true(isnan(ruga_corotational(MU, LAMBDA, all, true, NULL, NULL)));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(svd_restores_random_and_degenerate_matrices),
        cmocka_unit_test(svd_keeps_small_singular_values_accurate),
        cmocka_unit_test(eigen3_restores_symmetric_matrices),
        cmocka_unit_test(energies_match_closed_forms),
        cmocka_unit_test(uniaxial_stress_matches_closed_form),
        cmocka_unit_test(stress_and_its_derivative_are_centred_differences_at_second_order),
        cmocka_unit_test(hessian_is_symmetric_and_its_projection_semi_definite),
        cmocka_unit_test(hessian_stays_bounded_at_the_kink),
        cmocka_unit_test(not_a_number_stays_visible),
    };
    return cmocka_run_group_tests_name("corotational", tests, NULL, check_no_leak);
}
