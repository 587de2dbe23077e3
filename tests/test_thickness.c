// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/memory.h"
#include "core/random.h"
#include "core/vec3.h"
#include "mesh/make.h"
#include "shell/shell.h"
#include "shell/thickness.h"

#include <string.h>

static const double CORNER[9] = {0.1, 0.2, -0.3, 1.2, 0.1, 0.4, 0.3, 1.1, 0.2};

static double stiffness(double power, const double* x, double gradient[3][3]) {
    ruga_triangle_lanes one = {.gradient = {{{0}}}};
    double area = 0.5, thickness[1][2];
    ruga_triangle_lanes_set(&one, (const double* const[3]){x, x + 3, x + 6});
    ruga_thickness_lanes_stiffness(1, power, &area, &one, thickness);
    ruga_thickness_lanes_add(1, &thickness[0][1], &one);
    ruga_lanes_store(1, 3, one.gradient, gradient[0]);
    return thickness[0][0];
}

// The full 9 x 9 Hessian from its lower blocks.
static void hessian(double power, const double* x, double matrix[9][9]) {
    double block[1][RUGA_TRIANGLE_BLOCKS][9], area = 0.5, thickness[1][2];
    ruga_triangle_lanes one = {.block = {{{0}}}};
    ruga_triangle_lanes_set(&one, (const double* const[3]){x, x + 3, x + 6});
    ruga_thickness_lanes_stiffness(1, power, &area, &one, thickness);
    ruga_thickness_lanes_add_hessian(1, power, &thickness[0][1], &one);
    ruga_triangle_lanes_blocks(1, &one, block);
    for (int b = 0; b < RUGA_TRIANGLE_BLOCKS; b++) {
        int row = 3 * ruga_triangle_block_corner[b][0], column = 3 * ruga_triangle_block_corner[b][1];
        for (int k = 0; k < 9; k++) {
            matrix[row + k / 3][column + k % 3] = matrix[column + k % 3][row + k / 3] = block[0][b][k];
        }
    }
}

// Largest errors of centred differences of s and of its gradient along direction d.
static void difference_errors(double power, const double* d, double step, double error[2]) {
    double left[9], right[9], at[3][3], gl[3][3], gr[3][3], matrix[9][9], slope = 0;
    for (int i = 0; i < 9; i++) {
        left[i] = CORNER[i] - step * d[i];
        right[i] = CORNER[i] + step * d[i];
    }
    (void)stiffness(power, CORNER, at);
    hessian(power, CORNER, matrix);
    error[0] = (stiffness(power, right, gr) - stiffness(power, left, gl)) / (2 * step);
    error[1] = 0;
    for (int i = 0; i < 9; i++) {
        double curvature = (gr[i / 3][i % 3] - gl[i / 3][i % 3]) / (2 * step);
        slope += at[i / 3][i % 3] * d[i];
        for (int j = 0; j < 9; j++) {
            curvature -= matrix[i][j] * d[j];
        }
        error[1] = fmax(error[1], fabs(curvature));
    }
    error[0] = fabs(error[0] - slope);
}

static void derivatives_agree_with_differences_to_second_order(void** state) {
    (void)state;
    ruga_random random = {3};
    for (int k = 0; k < 12; k++) {
        double d[9], coarse[2], fine[2],
            power = ruga_thickness_power(k % 3 == 0   ? -0.5
                                         : k % 3 == 1 ? 0.3
                                                      : 0.48);
        for (int i = 0; i < 9; i++) {
            d[i] = 2 * ruga_random_uniform(&random) - 1;
        }
        difference_errors(power, d, 1e-3, coarse);
        difference_errors(power, d, 5e-4, fine);
        for (int i = 0; i < 2; i++) {
            assert_near(coarse[i] / fine[i], 4, 0.1);
            assert_true(fine[i] < 1e-4);
        }
    }
}

static void stretch_in_the_plane_thins_and_turning_does_nothing(void** state) {
    (void)state;
    double g[3][3], flat[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, turned[9];
    assert_near(stiffness(ruga_thickness_power(0.3), flat, g), 1, 1e-15);
    // 1 % along one axis: h' = h (1 - 0.01 nu / (1 - nu)), to first order
    flat[3] = 1.01;
    assert_near(stiffness(ruga_thickness_power(0.3), flat, g), 1 - 2 * 0.01 * 0.3 / 0.7, 2e-4);
    // nearly constant volume: h' = h / 1.01
    assert_near(stiffness(ruga_thickness_power(0.5 - 1e-9), flat, g), 1 / (1.01 * 1.01), 1e-8);
    assert_near(stiffness(ruga_thickness_power(0), flat, g), 1, 0);
    double before = stiffness(ruga_thickness_power(0.3), CORNER, g);
    for (int i = 0; i < 9; i += 3) {
        turned[i] = CORNER[i + 1] + 4;
        turned[i + 1] = CORNER[i + 2] - 5;
        turned[i + 2] = CORNER[i];
    }
    assert_near(stiffness(ruga_thickness_power(0.3), turned, g), before, 1e-13);
    for (int c = 0; c < 3; c++) {
        assert_near(g[0][c] + g[1][c] + g[2][c], 0, 1e-14);
    }
}

static void crushed_triangles_keep_a_finite_stiffness(void** state) {
    (void)state;
    double g[3][3], matrix[9][9], line[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    assert_near(stiffness(1, line, g), 100, 1e-12);
    hessian(1, line, matrix);
    for (int i = 0; i < 9; i++) {
        assert_true(g[i / 3][i % 3] == 0);
        for (int j = 0; j < 9; j++) {
            assert_true(matrix[i][j] == 0);
        }
    }
}

// A rolled sheet shrunk as a whole keeps its angles, and its bending energy grows by the square of the
// thickness.
static void bending_follows_the_thickness_of_a_strained_skin(void** state) {
    (void)state;
    const ruga_make_def def = {.shape = RUGA_SHAPE_SHEET, .size = {2, 2}, .edge = 0.1};
    const double poisson[] = {0, 0.3, 0.499999, -0.5}, shrink[] = {0.9, 1.2};
    for (int k = 0; k < 8; k++) {
        ruga_mesh mesh;
        ruga_connectivity connectivity;
        ruga_shell* shell;
        double *x, energy[2], s = shrink[k % 2], nu = poisson[k / 2];
        ruga_shell_material material = {
            .skin = {.thickness = 1, .young = 100, .poisson = nu, .density = 2, .growth = {1, 1}}};
        assert_ok(ruga_mesh_make(&def, &mesh));
        assert_ok(ruga_connectivity_create(&mesh, &connectivity));
        assert_ok(ruga_shell_create(&mesh, &connectivity, &material, &shell));
        assert_ok(RUGA_NEW(x, 3 * (size_t)mesh.vertex_count));
        for (int i = 0; i < 3 * mesh.vertex_count; i += 3) {
            x[i] = sin(mesh.position[i]);
            x[i + 1] = mesh.position[i + 1];
            x[i + 2] = 1 - cos(mesh.position[i]);
        }
        for (int side = 0; side < 2; side++) {
            ruga_shell_energies energies;
            assert_ok(ruga_shell_energy(shell, x, 0, &energies, NULL, NULL));
            energy[side] = energies.bending;
            for (int i = 0; i < 3 * mesh.vertex_count; i++) {
                x[i] *= s;
            }
        }
        double thicker = pow(s * s, -nu / (1 - nu));
        assert_near(energy[1] / energy[0] / (thicker * thicker), 1, 1e-10);
        ruga_release(x);
        ruga_shell_destroy(&shell);
        ruga_connectivity_clear(&connectivity);
        ruga_mesh_clear(&mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_agree_with_differences_to_second_order),
        cmocka_unit_test(stretch_in_the_plane_thins_and_turning_does_nothing),
        cmocka_unit_test(crushed_triangles_keep_a_finite_stiffness),
        cmocka_unit_test(bending_follows_the_thickness_of_a_strained_skin),
    };
    return cmocka_run_group_tests_name("thickness", tests, NULL, check_no_leak);
}
