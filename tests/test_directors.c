// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The Kirchhoff-Love bending element: shell/directors.c within shell/shell.c.
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "core/random.h"
#include "core/vec3.h"
#include "ruga/ruga.h"
#include "shell/shell.h"
#include "tests/dense.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 1600 }; // vertices of any mesh here

typedef struct fixture {
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    ruga_shell* shell;
    double (*coupling)[3];
    int n, entries; // 3 V; values of the pattern
} fixture;

static const ruga_skin_def plain_skin = {.thickness = 1,
                                         .young = 100,
                                         .poisson = 0.3,
                                         .density = 2,
                                         .growth = {1, 1},
                                         .bending = RUGA_BENDING_KIRCHHOFF_LOVE};

static double noise(ruga_random* random) {
    return 2 * ruga_random_uniform(random) - 1;
}

// Quads of side 1 in z = 0 with diagonals at random, vertices moved within the plane by up to `jitter` (the
// rim along itself) and out of it by up to `bump`.
static void make_grid(int nx, int ny, double jitter, double bump, ruga_mesh* mesh) {
    double* position = calloc(3 * MOST, sizeof *position);
    int *triangle = calloc(6 * MOST, sizeof *triangle), v = 0, f = 0;
    ruga_random random = {7};
    for (int j = 0; j <= ny; j++) {
        for (int i = 0; i <= nx; i++, v++) {
            bool in_x = i > 0 && i<nx, in_y = j> 0 && j < ny;
            position[3 * v] = i + (in_x ? jitter * noise(&random) : 0);
            position[3 * v + 1] = j + (in_y ? jitter * noise(&random) : 0);
            position[3 * v + 2] = bump * noise(&random);
        }
    }
    for (int j = 0; j < ny; j++) {
        for (int i = 0; i < nx; i++, f += 6) {
            int a = j * (nx + 1) + i, b = a + 1, c = b + nx + 1, d = a + nx + 1;
            const int one[6] = {a, b, c, a, c, d}, other[6] = {a, b, d, b, c, d};
            memcpy(triangle + f, noise(&random) > 0 ? one : other, sizeof one);
        }
    }
    const ruga_mesh_def def = {
        .vertex_count = v, .positions = position, .triangle_count = f / 3, .triangles = triangle};
    assert_ok(ruga_mesh_from_def(&def, mesh));
    free(position);
    free(triangle);
}

static void make_shell(fixture* fix, const ruga_skin_def* skin, const bool* held) {
    const ruga_shell_material material = {.skin = *skin, .held = held};
    fix->n = 3 * fix->mesh.vertex_count;
    assert_ok(ruga_connectivity_create(&fix->mesh, &fix->connectivity));
    assert_ok(ruga_shell_create(&fix->mesh, &fix->connectivity, &material, &fix->shell));
    fix->entries = ruga_shell_pattern(fix->shell)->start[fix->n];
    const ruga_directors* d = ruga_shell_directors(fix->shell);
    assert_non_null(d);
    assert_ok(RUGA_NEW_ZERO(fix->coupling, d->start[fix->mesh.vertex_count]));
}

static void make(fixture* fix, int nx, int ny, double jitter, double bump, const ruga_skin_def* skin) {
    *fix = (fixture){.n = 0};
    make_grid(nx, ny, jitter, bump, &fix->mesh);
    make_shell(fix, skin, NULL);
}

static void clear(fixture* fix) {
    ruga_release(fix->coupling);
    ruga_shell_destroy(&fix->shell);
    ruga_connectivity_clear(&fix->connectivity);
    ruga_mesh_clear(&fix->mesh);
}

static double* array(int n) {
    double* a = calloc((size_t)n, sizeof *a);
    assert_non_null(a);
    return a;
}

static double norm(int n, const double* a) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += a[i] * a[i];
    }
    return sqrt(sum);
}

static double* deformed(const fixture* fix, double sx, double sy, double amount, uint64_t seed) {
    double* x = array(fix->n);
    ruga_random random = {seed};
    for (int i = 0; i < fix->n; i++) {
        x[i] = (i % 3 == 0 ? sx : i % 3 == 1 ? sy : 1) * fix->mesh.position[i] + amount * noise(&random);
    }
    return x;
}

static double total(const fixture* fix, const double* x, double* gradient) {
    ruga_shell_energies e;
    assert_ok(ruga_shell_energy(fix->shell, x, 0, &e, gradient, NULL));
    return e.membrane + e.bending;
}

// The Hessian times v: value and coupling are of the state wanted.
static void hessian_times(const fixture* fix, double* value, const double* v, double* y) {
    ruga_sparse k = *ruga_shell_pattern(fix->shell);
    k.value = value;
    ruga_sparse_multiply_symmetric(&k, v, y);
    ruga_shell_relax(fix->shell, (const double(*)[3])fix->coupling, v, y);
}

static void rest_state_has_no_energy_and_no_force(void** state) {
    (void)state;
    fixture fix;
    make(&fix, 6, 5, 0.2, 0.3, &plain_skin);
    double* g = array(fix.n);
    assert_near(total(&fix, fix.mesh.position, g), 0, 1e-26);
    assert_near(norm(fix.n, g), 0, 1e-12);
    free(g);
    clear(&fix);
}

static void rigid_motion_changes_nothing(void** state) {
    (void)state;
    fixture fix;
    make(&fix, 4, 3, 0.2, 0.2, &plain_skin);
    double *x = deformed(&fix, 1.1, 0.9, 0.2, 3), *moved = array(fix.n), *g = array(fix.n), *h = array(fix.n);
    const double c = cos(1.9), s = sin(1.9);
    for (int i = 0; i < fix.n; i += 3) {
        moved[i] = c * x[i] - s * x[i + 2] + 3;
        moved[i + 1] = x[i + 1] - 4;
        moved[i + 2] = s * x[i] + c * x[i + 2] + 5;
    }
    double before = total(&fix, x, g), after = total(&fix, moved, h);
    assert_near(after / before, 1, 1e-10);
    for (int i = 0; i < fix.n; i += 3) {
        const double turned[3] = {c * g[i] - s * g[i + 2], g[i + 1], s * g[i] + c * g[i + 2]};
        assert_near(ruga_distance(turned, h + i), 0, 1e-10 * norm(fix.n, g));
    }
    free(x);
    free(moved);
    free(g);
    free(h);
    clear(&fix);
}

// Errors of centred differences of the energy and of the gradient along d.
static void differences(const fixture* fix, const double* x, const double* d, double s, double slope,
                        const double* hd, double error[2]) {
    double *a = array(fix->n), *b = array(fix->n), *ga = array(fix->n), *gb = array(fix->n);
    for (int i = 0; i < fix->n; i++) {
        a[i] = x[i] - s * d[i];
        b[i] = x[i] + s * d[i];
    }
    double ea = total(fix, a, ga), eb = total(fix, b, gb);
    for (int i = 0; i < fix->n; i++) {
        ga[i] = (gb[i] - ga[i]) / (2 * s) - hd[i];
    }
    error[0] = fabs((eb - ea) / (2 * s) - slope);
    error[1] = norm(fix->n, ga);
    free(a);
    free(b);
    free(ga);
    free(gb);
}

static void check_derivatives(const fixture* fix, const double* x) {
    double *g = array(fix->n), *d = array(fix->n), *hd = array(fix->n), *value = array(fix->entries);
    double slope = 0, coarse[2], fine[2];
    ruga_random random = {11};
    assert_ok(ruga_shell_energy(fix->shell, x, 0, NULL, g, value));
    ruga_shell_coupling(fix->shell, fix->coupling);
    for (int i = 0; i < fix->n; i++) {
        d[i] = noise(&random);
        slope += g[i] * d[i];
    }
    hessian_times(fix, value, d, hd);
    differences(fix, x, d, 4e-4, slope, hd, coarse);
    differences(fix, x, d, 2e-4, slope, hd, fine);
    for (int i = 0; i < 2; i++) {
        assert_near(coarse[i] / fine[i], 4, 0.15);
    }
    assert_near(fine[0], 0, 1e-4 * norm(fix->n, g));
    assert_near(fine[1], 0, 1e-5 * norm(fix->n, hd));
    free(g);
    free(d);
    free(hd);
    free(value);
}

static void derivatives_agree_with_differences_to_second_order(void** state) {
    (void)state;
    for (int variant = 0; variant < 4; variant++) {
        ruga_skin_def skin = plain_skin;
        skin.poisson = variant & 1 ? 0.45 : -0.2;
        skin.thickness = variant & 2 ? 0.1 : 3;
        fixture fix;
        make(&fix, 4, 3, 0.15, 0.15, &skin);
        for (uint64_t k = 0; k < 2; k++) {
            double* x = deformed(&fix, k ? 0.7 : 1.05, k ? 1.2 : 0.97, k ? 0.15 : 0.05, 20 + k);
            check_derivatives(&fix, x);
            free(x);
        }
        clear(&fix);
    }
}

static void derivatives_hold_beside_held_triangles(void** state) {
    (void)state;
    fixture fix = {.n = 0};
    bool held[24] = {false};
    make_grid(4, 3, 0.15, 0.1, &fix.mesh);
    for (int f = 0; f < 8; f++) {
        held[f] = true;
    }
    make_shell(&fix, &plain_skin, held);
    double* x = deformed(&fix, 1.05, 0.97, 0, 4);
    ruga_random random = {5};
    for (int i = 30; i < fix.n; i++) { // the first two rows stay
        x[i] += 0.1 * noise(&random);
    }
    check_derivatives(&fix, x);
    free(x);
    clear(&fix);
}

// Eigenvalue of the Hessian that is least, as a part of the largest.
static double least_eigenvalue(const fixture* fix, const double* x, double clamp) {
    double *value = array(fix->entries), *unit = array(fix->n), *dense = array(fix->n * fix->n), least, most;
    assert_ok(ruga_shell_energy(fix->shell, x, clamp, NULL, NULL, value));
    ruga_shell_coupling(fix->shell, fix->coupling);
    for (int i = 0; i < fix->n; i++) {
        unit[i] = 1;
        hessian_times(fix, value, unit, dense + (size_t)i * (size_t)fix->n);
        unit[i] = 0;
    }
    dense_eigenvalue_range(fix->n, dense, &least, &most);
    free(value);
    free(unit);
    free(dense);
    return least / most;
}

static void clamped_hessian_is_positive_semidefinite(void** state) {
    (void)state;
    fixture fix;
    int indefinite = 0;
    make(&fix, 3, 2, 0.15, 0.1, &plain_skin);
    for (uint64_t k = 0; k < 3; k++) {
        double* x = deformed(&fix, (const double[]){0.9, 0.3, 1.3}[k], 1, 0.3, 40 + k);
        assert_true(least_eigenvalue(&fix, x, 1) > -1e-10);
        indefinite += least_eigenvalue(&fix, x, 0) < -1e-4;
        free(x);
    }
    assert_true(indefinite > 0); // or the states above would prove nothing
    clear(&fix);
}

// Energy of a sheet of n x n irregular cells on z = (h_xx x^2 + 2 h_xy x y + h_yy y^2) / 2, over that of a
// plate.
static double plate_ratio(int n, const double h[3]) {
    fixture fix;
    make(&fix, n, n, 0.3, 0, &plain_skin);
    const double tiny = 1e-5, nu = 0.3, d = 100 / (12 * (1 - nu * nu));
    double* x = array(fix.n);
    for (int i = 0; i < fix.n; i += 3) {
        const double* X = fix.mesh.position + i;
        x[i] = X[0];
        x[i + 1] = X[1];
        x[i + 2] = tiny / 2 * (h[0] * X[0] * X[0] + 2 * h[1] * X[0] * X[1] + h[2] * X[1] * X[1]);
    }
    ruga_shell_energies e;
    assert_ok(ruga_shell_energy(fix.shell, x, 0, &e, NULL, NULL));
    double trace = h[0] + h[2], square = h[0] * h[0] + 2 * h[1] * h[1] + h[2] * h[2];
    free(x);
    clear(&fix);
    return e.bending / (0.5 * d * tiny * tiny * ((1 - nu) * square + nu * trace * trace) * n * n);
}

// The rim carries no moment, so that a row of triangles there bends less than the rest: an error of first
// order, which extrapolation from n and 2 n cells takes out. What is left is that irregular triangles bend as
// a plate does.
static void every_curvature_has_the_energy_of_a_plate_on_an_irregular_mesh(void** state) {
    (void)state;
    const double curvature[][3] = {{1, 0, 0}, {0, 0, 1}, {0.5, 0.5, 0.5}, {1, 0, 1}, {1, 0, -1}, {0, 1, 0}};
    for (int k = 0; k < 6; k++) {
        double coarse = plate_ratio(16, curvature[k]), fine = plate_ratio(32, curvature[k]);
        print_message("curvature %d: %.4f, %.4f of a plate's energy\n", k, coarse, fine);
        assert_near(fine, 1, 0.06);
        assert_near(2 * fine - coarse, 1, 0.01);
    }
}

// Equilateral triangles of side 1; vertices moved by up to `jitter` within the plane.
static void make_lattice(int nx, int ny, double jitter, ruga_mesh* mesh) {
    double* position = array(3 * MOST);
    int *triangle = calloc(6 * MOST, sizeof *triangle), faces = 0;
    ruga_random random = {3};
    for (int v = 0; v < (nx + 1) * (ny + 1); v++) {
        int i = v % (nx + 1), j = v / (nx + 1);
        position[3 * v] = i - 0.5 * (j % 2) + jitter * noise(&random);
        position[3 * v + 1] = sqrt(0.75) * j + jitter * noise(&random);
    }
    for (int k = 0; k < nx * ny; k++) {
        int a = k / nx * (nx + 1) + k % nx, b = a + 1, c = b + nx + 1, d = a + nx + 1;
        const int even[6] = {a, b, c, a, c, d}, odd[6] = {a, b, d, b, c, d};
        memcpy(triangle + 3 * faces, k / nx % 2 ? odd : even, sizeof even);
        faces += 2;
    }
    const ruga_mesh_def def = {.vertex_count = (nx + 1) * (ny + 1),
                               .positions = position,
                               .triangle_count = faces,
                               .triangles = triangle};
    assert_ok(ruga_mesh_from_def(&def, mesh));
    free(position);
    free(triangle);
}

// Energy of a bump w = exp(-r^2 / (2 s^2)) on a flat sheet over a plate's, D/2 int (laplacian w)^2 = pi D /
// s^2. Its waves have (k s)^2 = 3 in the mean.
static double bump_ratio(double s, double poisson, double jitter) {
    ruga_skin_def skin = plain_skin;
    skin.poisson = poisson;
    fixture fix = {.n = 0};
    make_lattice(30, 34, jitter, &fix.mesh);
    make_shell(&fix, &skin, NULL);
    const double tiny = 1e-5, d = 100 / (12 * (1 - poisson * poisson));
    double* x = array(fix.n);
    for (int i = 0; i < fix.n; i += 3) {
        const double* X = fix.mesh.position + i;
        double px = X[0] - 14.6, py = X[1] - 14.9;
        x[i] = X[0];
        x[i + 1] = X[1];
        x[i + 2] = tiny * exp(-(px * px + py * py) / (2 * s * s));
    }
    ruga_shell_energies e;
    assert_ok(ruga_shell_energy(fix.shell, x, 0, &e, NULL, NULL));
    free(x);
    clear(&fix);
    return e.bending * s * s / (RUGA_PI * d * tiny * tiny);
}

// The error is of fourth order in the edge. Without the energy of jumps it is of second order: c (k s)^2 /
// s^2 with c of directors.c, 10 to 20 % for bumps of 2 edges.
static void short_waves_have_the_energy_of_a_plate(void** state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        const double nu = (const double[]){0, 0.3, 0.45}[k];
        double wide = bump_ratio(4, nu, 0) - 1, narrow = bump_ratio(2, nu, 0) - 1;
        print_message("poisson %.2f: %+.5f, %+.5f; irregular %+.5f, %+.5f\n", nu, wide, narrow,
                      bump_ratio(4, nu, 0.2) - 1, bump_ratio(2, nu, 0.2) - 1);
        assert_near(narrow, 0, 0.02);
        assert_near(narrow / wide, 16, 3);
        assert_near(bump_ratio(2, nu, 0.2), 1, 0.03);
    }
}

static double cylinder_ratio(int n) {
    ruga_skin_def skin = plain_skin;
    skin.poisson = 0;
    fixture fix;
    make(&fix, n, n, 0.3, 0, &skin);
    const double radius = n / 2.0;
    double* x = array(fix.n);
    for (int i = 0; i < fix.n; i += 3) {
        double arc = (0.6 * fix.mesh.position[i] + 0.8 * fix.mesh.position[i + 1]) / radius;
        double across = 0.6 * fix.mesh.position[i + 1] - 0.8 * fix.mesh.position[i];
        x[i] = radius * sin(arc);
        x[i + 1] = across;
        x[i + 2] = radius * cos(arc);
    }
    ruga_shell_energies e;
    assert_ok(ruga_shell_energy(fix.shell, x, 0, &e, NULL, NULL));
    free(x);
    clear(&fix);
    return e.bending / (0.5 * 100 / 12 / (radius * radius) * n * n);
}

static void rolled_sheet_has_the_bending_energy_of_a_cylinder(void** state) {
    (void)state;
    double coarse = cylinder_ratio(16), fine = cylinder_ratio(32);
    print_message("cylinder: %.4f, %.4f of its energy\n", coarse, fine);
    assert_near(2 * fine - coarse, 1, 0.01);
}

static void growth_moves_the_rest_state(void** state) {
    (void)state;
    ruga_skin_def skin = plain_skin;
    skin.growth[0] = 1.25;
    skin.growth[1] = 0.8;
    fixture fix, grown = {.n = 0};
    make(&fix, 4, 3, 0.2, 0, &skin);
    double* x = deformed(&fix, 1.25, 0.8, 0, 1);
    assert_near(total(&fix, x, NULL), 0, 1e-26);
    make_grid(4, 3, 0.2, 0, &grown.mesh);
    memcpy(grown.mesh.position, x, (size_t)fix.n * sizeof *x);
    make_shell(&grown, &plain_skin, NULL);
    double* bent = deformed(&fix, 1.1, 1, 0.2, 9);
    assert_near(total(&fix, bent, NULL) / total(&grown, bent, NULL), 1, 1e-12);
    free(x);
    free(bent);
    clear(&fix);
    clear(&grown);
}

static void collapsed_states_give_finite_numbers(void** state) {
    (void)state;
    fixture fix;
    make(&fix, 3, 2, 0.2, 0.1, &plain_skin);
    double *g = array(fix.n), *value = array(fix.entries);
    for (int k = 0; k < 3; k++) {
        double* x = deformed(&fix, k == 0 ? 0 : 1e-9, k == 1 ? 1 : 0, 0, 1);
        assert_ok(ruga_shell_energy(fix.shell, x, 0.5, NULL, g, value));
        assert_true(isfinite(norm(fix.n, g)) && isfinite(norm(fix.entries, value)));
        free(x);
    }
    free(g);
    free(value);
    clear(&fix);
}

static void same_bits_for_any_threads_and_any_history(void** state) {
    (void)state;
    fixture fix;
    make(&fix, 36, 30, 0.2, 0.2, &plain_skin);
    double *x = deformed(&fix, 0.9, 1.1, 0.1, 5), *other = deformed(&fix, 2, 0.5, 0.3, 6);
    double *g[2] = {array(fix.n), array(fix.n)}, *h[2] = {array(fix.entries), array(fix.entries)};
    ruga_shell_energies e[2];
    ruga_set_threads(1);
    assert_ok(ruga_shell_energy(fix.shell, x, 0.25, &e[0], g[0], h[0]));
    for (int threads = 1; threads <= 3; threads++) {
        ruga_set_threads(threads);
        assert_ok(ruga_shell_energy(fix.shell, other, 0.5, &e[1], g[1], h[1]));
        assert_ok(ruga_shell_energy(fix.shell, x, 0.25, &e[1], g[1], h[1]));
        assert_memory_equal(&e[0], &e[1], sizeof e[0]);
        assert_memory_equal(g[0], g[1], (size_t)fix.n * sizeof *g[0]);
        assert_memory_equal(h[0], h[1], (size_t)fix.entries * sizeof *h[0]);
    }
    ruga_set_threads(0);
    for (int i = 0; i < 2; i++) {
        free(g[i]);
        free(h[i]);
    }
    free(x);
    free(other);
    clear(&fix);
}

static void failed_allocations_neither_crash_nor_leak(void** state) {
    (void)state;
    const ruga_shell_material material = {.skin = plain_skin};
    let_allocations_fail_after(1000);
    fixture fix = {.n = 0};
    make_grid(3, 2, 0.1, 0.1, &fix.mesh);
    assert_ok(ruga_connectivity_create(&fix.mesh, &fix.connectivity));
    size_t before = ruga_byte_count();
    ruga_status status = RUGA_NO_MEMORY;
    int tries = 0;
    for (; status == RUGA_NO_MEMORY && tries < 1000; tries++) {
        allocations_left = tries;
        status = ruga_shell_create(&fix.mesh, &fix.connectivity, &material, &fix.shell);
        assert_true(status == RUGA_OK || ruga_byte_count() == before);
    }
    assert_int_equal(status, RUGA_OK);
    assert_true(tries > 30);
    clear(&fix);
    ruga_set_allocator(NULL, NULL, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rest_state_has_no_energy_and_no_force),
        cmocka_unit_test(rigid_motion_changes_nothing),
        cmocka_unit_test(derivatives_agree_with_differences_to_second_order),
        cmocka_unit_test(derivatives_hold_beside_held_triangles),
        cmocka_unit_test(clamped_hessian_is_positive_semidefinite),
        cmocka_unit_test(every_curvature_has_the_energy_of_a_plate_on_an_irregular_mesh),
        cmocka_unit_test(short_waves_have_the_energy_of_a_plate),
        cmocka_unit_test(rolled_sheet_has_the_bending_energy_of_a_cylinder),
        cmocka_unit_test(growth_moves_the_rest_state),
        cmocka_unit_test(collapsed_states_give_finite_numbers),
        cmocka_unit_test(same_bits_for_any_threads_and_any_history),
        cmocka_unit_test(failed_allocations_neither_crash_nor_leak),
    };
    return cmocka_run_group_tests_name("directors", tests, NULL, check_no_leak);
}
