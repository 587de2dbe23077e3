// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "ruga/ruga.h"
#include "core/random.h"
#include "core/vec3.h"
#include "mesh/make.h"
#include "shell/bending.h"
#include "shell/shell.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 4000, VECTORS = 512 }; // vertices of any mesh here; vectors alive at once

typedef struct fixture {
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    ruga_shell* shell;
    int size; // 3 vertex_count
} fixture;

static const ruga_skin_def plain_skin = {
    .thickness = 1, .young = 100, .poisson = 0.3, .density = 2, .growth = {1, 1}};

static double noise(ruga_random* random) {
    return 2 * ruga_random_uniform(random) - 1;
}

// Quads of side 1 with alternating diagonals, in z = 0; `bump` > 0 moves every vertex by up to that much.
static void make_grid(int nx, int ny, double bump, ruga_mesh* mesh) {
    double position[3 * MOST];
    int triangle[6 * MOST];
    ruga_random random = {7};
    int v = 0, f = 0;
    for (int j = 0; j <= ny; j++) {
        for (int i = 0; i <= nx; i++, v++) {
            position[3 * v] = i + bump * noise(&random);
            position[3 * v + 1] = j + bump * noise(&random);
            position[3 * v + 2] = bump * noise(&random);
        }
    }
    for (int j = 0; j < ny; j++) {
        for (int i = 0; i < nx; i++) {
            int a = j * (nx + 1) + i, b = a + 1, c = b + nx + 1, d = a + nx + 1;
            const int even[6] = {a, b, c, a, c, d}, odd[6] = {a, b, d, b, c, d};
            memcpy(triangle + f, (i + j) % 2 ? odd : even, sizeof even);
            f += 6;
        }
    }
    const ruga_mesh_def def = {
        .vertex_count = v, .positions = position, .triangle_count = f / 3, .triangles = triangle};
    assert_ok(ruga_mesh_from_def(&def, mesh));
}

static void make_shell(fixture* fix, const ruga_skin_def* skin) {
    const ruga_shell_material material = {.skin = *skin};
    fix->size = 3 * fix->mesh.vertex_count;
    assert_ok(ruga_connectivity_create(&fix->mesh, &fix->connectivity));
    assert_ok(ruga_shell_create(&fix->mesh, &fix->connectivity, &material, &fix->shell));
}

static void make_grid_shell(fixture* fix, int nx, int ny, double bump, const ruga_skin_def* skin) {
    make_grid(nx, ny, bump, &fix->mesh);
    make_shell(fix, skin);
}

// Vectors of zeros, all released by clear().
static double* vectors[VECTORS];
static int vector_count;

static double* new_vector(int size) {
    assert_true(vector_count < VECTORS);
    assert_ok(RUGA_NEW_ZERO(vectors[vector_count], size));
    return vectors[vector_count++];
}

static void clear(fixture* fix) {
    while (vector_count > 0) {
        ruga_release(vectors[--vector_count]);
    }
    ruga_shell_destroy(&fix->shell);
    ruga_connectivity_clear(&fix->connectivity);
    ruga_mesh_clear(&fix->mesh);
}

static double total_energy(const fixture* fix, const double* x) {
    ruga_shell_energies energies;
    assert_ok(ruga_shell_energy(fix->shell, x, 0, &energies, NULL, NULL));
    return energies.membrane + energies.bending;
}

static double vector_norm(int size, const double* x) {
    double sum = 0;
    for (int i = 0; i < size; i++) {
        sum += x[i] * x[i];
    }
    return sqrt(sum);
}

// The rest shape scaled along x and y, each coordinate moved by up to `amount`, in a seeded way.
static double* deformed(const fixture* fix, double sx, double sy, double amount, uint64_t seed) {
    double* x = new_vector(fix->size);
    ruga_random random = {seed};
    for (int i = 0; i < fix->size; i++) {
        x[i] = (i % 3 == 0 ? sx : i % 3 == 1 ? sy : 1) * fix->mesh.position[i] + amount * noise(&random);
    }
    return x;
}

static void rest_state_has_no_energy_and_no_force(void** state) {
    (void)state;
    for (int kind = RUGA_MEMBRANE_BARAFF_WITKIN; kind <= RUGA_MEMBRANE_STVK; kind++) {
        for (int curved = 0; curved < 2; curved++) {
            ruga_skin_def skin = plain_skin;
            skin.membrane = (ruga_membrane)kind;
            fixture fix;
            make_grid_shell(&fix, 6, 5, curved * 0.3, &skin);
            double* gradient = new_vector(fix.size);
            ruga_shell_energies energies;
            assert_ok(ruga_shell_energy(fix.shell, fix.mesh.position, 0, &energies, gradient, NULL));
            assert_near(energies.membrane, 0, 1e-26);
            assert_near(energies.bending, 0, 0);
            assert_near(vector_norm(fix.size, gradient), 0, 1e-12);
            assert_near(energies.force_square, 0, 1e-24);
            clear(&fix);
        }
    }
}

// Rotation by `angle` about a skew axis, by Rodrigues' formula.
static void rotate(double angle, const double* x, double* y) {
    const double axis[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
    double across[3];
    ruga_cross(axis, x, across);
    double along = ruga_dot(axis, x) * (1 - cos(angle));
    for (int c = 0; c < 3; c++) {
        y[c] = cos(angle) * x[c] + sin(angle) * across[c] + along * axis[c];
    }
}

static void rigid_motion_changes_nothing(void** state) {
    (void)state;
    for (int kind = RUGA_MEMBRANE_BARAFF_WITKIN; kind <= RUGA_MEMBRANE_STVK; kind++) {
        ruga_skin_def skin = plain_skin;
        skin.membrane = (ruga_membrane)kind;
        fixture fix;
        make_grid_shell(&fix, 4, 3, 0.2, &skin);
        double* x = deformed(&fix, 1.1, 0.9, 0.2, 3);
        double *moved = new_vector(fix.size), *g = new_vector(fix.size), *moved_g = new_vector(fix.size);
        const double shift[3] = {3, -4, 5};
        for (int v = 0; v < fix.size; v += 3) {
            rotate(1.9, x + v, moved + v);
            ruga_add_scaled(1, shift, moved + v);
        }
        ruga_shell_energies before, after;
        assert_ok(ruga_shell_energy(fix.shell, x, 0, &before, g, NULL));
        assert_ok(ruga_shell_energy(fix.shell, moved, 0, &after, moved_g, NULL));
        assert_near(after.membrane / before.membrane, 1, 1e-10);
        assert_near(after.bending / before.bending, 1, 1e-10);
        assert_near(after.force_square / before.force_square, 1, 1e-10);
        for (int v = 0; v < fix.size; v += 3) {
            double rotated_g[3];
            rotate(1.9, g + v, rotated_g);
            assert_near(ruga_distance(rotated_g, moved_g + v), 0, 1e-10 * vector_norm(fix.size, g));
        }
        clear(&fix);
    }
}

// H d from the lower triangle.
static void hessian_times(const fixture* fix, double* hessian, const double* d, double* result) {
    ruga_sparse matrix = *ruga_shell_pattern(fix->shell);
    matrix.value = hessian;
    ruga_sparse_multiply_symmetric(&matrix, d, result);
}

// Centred differences of energy and gradient along d with step s.
static double differences(const fixture* fix, const double* x, const double* d, double s, double* gradient) {
    double *a = new_vector(fix->size), *b = new_vector(fix->size), *ga = new_vector(fix->size);
    for (int i = 0; i < fix->size; i++) {
        a[i] = x[i] - s * d[i];
        b[i] = x[i] + s * d[i];
    }
    double slope = (total_energy(fix, b) - total_energy(fix, a)) / (2 * s);
    assert_ok(ruga_shell_energy(fix->shell, a, 0, NULL, ga, NULL));
    assert_ok(ruga_shell_energy(fix->shell, b, 0, NULL, gradient, NULL));
    for (int i = 0; i < fix->size; i++) {
        gradient[i] = (gradient[i] - ga[i]) / (2 * s);
    }
    return slope;
}

// Halving the step must divide the errors by four, and extrapolation must give the derivatives.
static void check_derivatives(const fixture* fix, const double* x) {
    int n = fix->size;
    int entries = ruga_shell_pattern(fix->shell)->start[n];
    double *g = new_vector(n), *d = new_vector(n), *hd = new_vector(n), *hessian = new_vector(entries);
    double *coarse = new_vector(n), *fine = new_vector(n), *both = new_vector(n);
    ruga_random random = {11};
    double slope = 0;
    assert_ok(ruga_shell_energy(fix->shell, x, 0, NULL, g, hessian));
    for (int i = 0; i < n; i++) {
        d[i] = noise(&random);
        slope += g[i] * d[i];
    }
    hessian_times(fix, hessian, d, hd);
    const double s = 4e-4;
    double slope_coarse = differences(fix, x, d, s, coarse);
    double slope_fine = differences(fix, x, d, s / 2, fine);
    assert_near((slope_coarse - slope) / (slope_fine - slope), 4, 0.1);
    assert_near((4 * slope_fine - slope_coarse) / 3, slope, 1e-8 * vector_norm(n, g));
    for (int i = 0; i < n; i++) {
        both[i] = (4 * fine[i] - coarse[i]) / 3 - hd[i];
        coarse[i] -= hd[i];
        fine[i] -= hd[i];
    }
    assert_near(vector_norm(n, coarse) / vector_norm(n, fine), 4, 0.1);
    assert_near(vector_norm(n, both), 0, 1e-8 * vector_norm(n, hd));
}

static void derivatives_agree_with_differences_to_second_order(void** state) {
    (void)state;
    for (int variant = 0; variant < 8; variant++) {
        ruga_skin_def skin = plain_skin;
        skin.membrane = variant & 1 ? RUGA_MEMBRANE_STVK : RUGA_MEMBRANE_BARAFF_WITKIN;
        skin.poisson = variant & 2 ? 0.3 : 0;
        if (variant & 4) {
            skin.growth[0] = 1.3;
            skin.growth[1] = 0.8;
        }
        fixture fix;
        make_grid_shell(&fix, 4, 3, 0.15, &skin);
        const double stretch[3][3] = {{1.05, 0.97, 0.05}, {0.6, 1.2, 0.15}, {1.6, 1.4, 0.3}};
        for (int k = 0; k < 3; k++) {
            double* x = deformed(&fix, stretch[k][0], stretch[k][1], stretch[k][2], 20 + (uint64_t)k);
            check_derivatives(&fix, x);
        }
        clear(&fix);
    }
}

static void derivatives_hold_for_fibres_of_no_length(void** state) {
    (void)state;
    ruga_skin_def skin = plain_skin;
    skin.thickness = 1e-6; // no bending to speak of, whose angles would change much within the step
    skin.young = 1e8;
    fixture fix;
    make_grid_shell(&fix, 4, 3, 0.15, &skin);
    double *x = deformed(&fix, 1e-4, 1e-4, 1e-5, 8), *d = deformed(&fix, 0, 0, 1, 9);
    double *g = new_vector(fix.size), *hd = new_vector(fix.size), *change = new_vector(fix.size);
    double* hessian = new_vector(ruga_shell_pattern(fix.shell)->start[fix.size]);
    for (int i = 2; i < fix.size; i += 3) {
        x[i] *= 1e-4;
        d[i] -= fix.mesh.position[i];
    }
    assert_ok(ruga_shell_energy(fix.shell, x, 0, NULL, g, hessian));
    hessian_times(&fix, hessian, d, hd);
    double slope = differences(&fix, x, d, 2e-6, change);
    for (int i = 0; i < fix.size; i++) {
        slope -= g[i] * d[i];
        change[i] -= hd[i];
    }
    assert_near(slope, 0, 1e-6 * vector_norm(fix.size, g));
    assert_near(vector_norm(fix.size, change), 0, 1e-7 * vector_norm(fix.size, hd));
    clear(&fix);
}

// Two unequal triangles on the edge from (0, 0, 0) to (1, 0, 0), the left one turned up by `angle`.
static void make_hinge(double angle, ruga_mesh* mesh) {
    const double position[12] = {0, 0, 0, 1, 0, 0, 0.3, 0.8 * cos(angle), 0.8 * sin(angle), 0.9, -0.6, 0};
    const int triangle[6] = {0, 1, 2, 1, 0, 3};
    const ruga_mesh_def def = {
        .vertex_count = 4, .positions = position, .triangle_count = 2, .triangles = triangle};
    assert_ok(ruga_mesh_from_def(&def, mesh));
}

static void hinge_derivatives_hold_at_every_angle(void** state) {
    (void)state;
    const double degrees[] = {-170, -135, -91, -45, -1, 1, 60, 89.5, 120, 150, 175};
    ruga_skin_def skin = plain_skin;
    skin.thickness = 10; // bending is most of the energy
    fixture fix;
    make_hinge(0.2, &fix.mesh);
    make_shell(&fix, &skin);
    for (size_t k = 0; k < sizeof degrees / sizeof degrees[0]; k++) {
        ruga_mesh turned;
        double angle = degrees[k] * RUGA_PI / 180;
        make_hinge(angle, &turned);
        const double* x[4];
        for (int i = 0; i < 4; i++) {
            x[i] = turned.position + 3 * i;
        }
        assert_near(ruga_hinge_angle(x, NULL), angle, 1e-14);
        if (angle - 0.2 > -RUGA_PI * 0.98) {
            check_derivatives(&fix, turned.position);
        }
        ruga_mesh_clear(&turned);
    }
    clear(&fix);
}

static void angles_differ_by_the_short_way_round(void** state) {
    (void)state;
    assert_near(ruga_angle_difference(3, -3), 6 - 2 * RUGA_PI, 1e-15);
    assert_near(ruga_angle_difference(-3, 3), 2 * RUGA_PI - 6, 1e-15);
    assert_near(ruga_angle_difference(0.5, 0.2), 0.3, 1e-15);
    assert_near(ruga_angle_difference(0, RUGA_PI), RUGA_PI, 0);
    // A hinge of rest angle 170 degrees at -170 degrees is bent by 20 degrees.
    fixture fix;
    make_hinge(170 * RUGA_PI / 180, &fix.mesh);
    make_shell(&fix, &plain_skin);
    ruga_mesh near_side, far_side;
    make_hinge(150 * RUGA_PI / 180, &near_side);
    make_hinge(-170 * RUGA_PI / 180, &far_side);
    assert_near(total_energy(&fix, far_side.position) / total_energy(&fix, near_side.position), 1, 1e-10);
    ruga_mesh_clear(&near_side);
    ruga_mesh_clear(&far_side);
    clear(&fix);
}

// Eigenvalues of a dense symmetric matrix, row by row, by Jacobi's rotations; they end on its diagonal.
static void jacobi(int n, double* a) {
    for (int sweep = 0; sweep < 30; sweep++) {
        double off = 0, all = 0;
        for (int p = 0; p < n; p++) {
            for (int q = p + 1; q < n; q++) {
                double apq = a[p * n + q];
                off += apq * apq;
                if (apq == 0) {
                    continue;
                }
                double angle = 0.5 * atan2(2 * apq, a[q * n + q] - a[p * n + p]);
                double c = cos(angle), s = sin(angle);
                for (int k = 0; k < n; k++) {
                    double x = a[k * n + p], y = a[k * n + q];
                    a[k * n + p] = c * x - s * y;
                    a[k * n + q] = s * x + c * y;
                }
                for (int k = 0; k < n; k++) {
                    double x = a[p * n + k], y = a[q * n + k];
                    a[p * n + k] = c * x - s * y;
                    a[q * n + k] = s * x + c * y;
                }
            }
            all += a[p * n + p] * a[p * n + p];
        }
        if (off <= 1e-28 * all) {
            return;
        }
    }
    fail_msg("Jacobi's method did not converge");
}

// Smallest eigenvalue of the Hessian at x as a part of the largest.
static double least_eigenvalue(const fixture* fix, const double* x, double clamp) {
    int n = fix->size;
    const ruga_sparse* pattern = ruga_shell_pattern(fix->shell);
    double *value = new_vector(pattern->start[n]), *dense = new_vector(n * n);
    assert_ok(ruga_shell_energy(fix->shell, x, clamp, NULL, NULL, value));
    for (int j = 0; j < n; j++) {
        for (int k = pattern->start[j]; k < pattern->start[j + 1]; k++) {
            dense[pattern->index[k] * n + j] = dense[j * n + pattern->index[k]] = value[k];
        }
    }
    jacobi(n, dense);
    double least = dense[0], most = dense[0];
    for (int j = 0; j < n; j++) {
        least = fmin(least, dense[j * n + j]);
        most = fmax(most, dense[j * n + j]);
    }
    return least / most;
}

static void clamped_hessian_is_positive_semidefinite(void** state) {
    (void)state;
    // Factors of x and y, noise, shear. The last: large tension and shear, where the exact Hessian of
    // Baraff-Witkin is indefinite along the fibres too.
    const double stretch[][4] = {{0.9, 0.95, 0.05}, {0.3, 1.1, 0.2},    {1.2, 0.8, 0.4},      {3, 2.6, 0.3},
                                 {0.01, 0.5, 0},    {1e-5, 1e-5, 1e-5}, {2.5, 1.1, 0.05, 2.1}};
    int indefinite = 0;
    for (int variant = 0; variant < 4; variant++) {
        ruga_skin_def skin = plain_skin;
        skin.membrane = variant & 1 ? RUGA_MEMBRANE_STVK : RUGA_MEMBRANE_BARAFF_WITKIN;
        skin.poisson = variant & 2 ? 0.45 : -0.5;
        fixture fix;
        make_grid_shell(&fix, 3, 2, 0.1, &skin);
        for (size_t k = 0; k < sizeof stretch / sizeof stretch[0]; k++) {
            double* x = deformed(&fix, stretch[k][0], stretch[k][1], stretch[k][2], 40 + k);
            for (int i = 0; i < fix.size; i += 3) {
                x[i] += stretch[k][3] * x[i + 1];
            }
            assert_true(least_eigenvalue(&fix, x, 1) > -1e-12);
            indefinite += least_eigenvalue(&fix, x, 0) < -1e-4;
        }
        clear(&fix);
    }
    assert_true(indefinite >= 12); // or the states above would prove nothing
}

static void clamp_changes_nothing_under_tension(void** state) {
    (void)state;
    fixture fix;
    make_grid_shell(&fix, 3, 2, 0, &plain_skin);
    double* x = deformed(&fix, 1.2, 1.1, 0, 1);
    int entries = ruga_shell_pattern(fix.shell)->start[fix.size];
    double *exact = new_vector(entries), *clamped = new_vector(entries);
    assert_ok(ruga_shell_energy(fix.shell, x, 0, NULL, NULL, exact));
    assert_ok(ruga_shell_energy(fix.shell, x, 1, NULL, NULL, clamped));
    assert_memory_equal(exact, clamped, (size_t)entries * sizeof *exact);
    clear(&fix);
}

static void stretched_sheet_has_the_moduli_of_its_material(void** state) {
    (void)state;
    const double young = 100, h = 1, nu = 0.3, strain = 0.02, area = 6 * 5;
    for (int kind = RUGA_MEMBRANE_BARAFF_WITKIN; kind <= RUGA_MEMBRANE_STVK; kind++) {
        ruga_skin_def skin = plain_skin;
        skin.membrane = (ruga_membrane)kind;
        fixture fix;
        make_grid_shell(&fix, 6, 5, 0, &skin);
        // Strains e and -nu e in the model's own measure: stretches 1 + e, or sqrt(1 + 2 e).
        bool stvk = kind == RUGA_MEMBRANE_STVK;
        double along = stvk ? sqrt(1 + 2 * strain) : 1 + strain;
        double across = stvk ? sqrt(1 - 2 * nu * strain) : 1 - nu * strain;
        double *x = deformed(&fix, along, across, 0, 1), *held = deformed(&fix, along, 1, 0, 1);
        double* gradient = new_vector(fix.size);
        ruga_shell_energies energies;
        assert_ok(ruga_shell_energy(fix.shell, x, 0, &energies, gradient, NULL));
        assert_near(energies.membrane, young * h / 2 * strain * strain * area, 1e-12);
        double pull = 0;
        for (int i = 0; i < fix.size; i += 3) {
            assert_near(gradient[i + 1], 0, 1e-12); // the sides are free
            pull += x[i] > 3 * along ? gradient[i] : 0;
        }
        assert_near(pull, young * h * strain * 5 * (stvk ? along : 1), 1e-11);
        assert_near(total_energy(&fix, held), young * h / (2 * (1 - nu * nu)) * strain * strain * area,
                    1e-12);
        clear(&fix);
    }
}

// Energy per area, over E h strain^2 / 2, of a uniaxial stress state turned by `angle` to the mesh.
static double turned_modulus(const fixture* fix, double strain, double nu, double angle) {
    double* x = new_vector(fix->size);
    double c = cos(angle), s = sin(angle);
    for (int i = 0; i < fix->size; i += 3) {
        const double* rest = fix->mesh.position + i;
        double along = (1 + strain) * (c * rest[0] + s * rest[1]);
        double across = (1 - nu * strain) * (c * rest[1] - s * rest[0]);
        x[i] = c * along - s * across;
        x[i + 1] = s * along + c * across;
    }
    double energy = total_energy(fix, x);
    return energy / (0.5 * 100 * strain * strain * 30);
}

static void small_strain_membrane_is_isotropic_in_both_models(void** state) {
    (void)state;
    ruga_skin_def skin = plain_skin;
    fixture bw, stvk;
    make_grid_shell(&bw, 6, 5, 0, &skin);
    skin.membrane = RUGA_MEMBRANE_STVK;
    make_grid_shell(&stvk, 6, 5, 0, &skin);
    for (double angle = 0; angle < 3.2; angle += 0.4) {
        assert_near(turned_modulus(&bw, 1e-6, 0.3, angle), 1, 1e-5);
        assert_near(turned_modulus(&stvk, 1e-6, 0.3, angle), 1, 1e-5);
        // The models differ by a part of the energy that is proportional to the strain.
        double coarse = turned_modulus(&bw, 2e-3, 0.3, angle) - turned_modulus(&stvk, 2e-3, 0.3, angle);
        double fine = turned_modulus(&bw, 1e-3, 0.3, angle) - turned_modulus(&stvk, 1e-3, 0.3, angle);
        assert_near(coarse, 0, 2 * 2e-3);
        assert_near(coarse / fine, 2, 0.02);
    }
    clear(&bw);
    clear(&stvk);
}

// One third of the area of its two triangles belongs to each hinge.
static double hinge_area(const fixture* fix) {
    double sum = 0;
    for (int e = 0; e < fix->connectivity.edge_count; e++) {
        const int* side = fix->connectivity.edge_triangle[e];
        for (int i = 0; i < 2 && side[0] >= 0 && side[1] >= 0; i++) {
            sum += ruga_mesh_triangle_area(&fix->mesh, side[i]) / 3;
        }
    }
    return sum;
}

static void rolled_sheet_has_the_bending_energy_of_a_cylinder(void** state) {
    (void)state;
    const ruga_make_def def = {.shape = RUGA_SHAPE_SHEET, .size = {3, 3}, .edge = 0.1};
    fixture fix;
    assert_ok(ruga_mesh_make(&def, &fix.mesh));
    make_shell(&fix, &plain_skin);
    const double d = 100 / (12 * (1 - 0.09)), radius = 16 * 0.1 / (2 * RUGA_PI);
    double wanted = 0.5 * d / (radius * radius) * hinge_area(&fix);
    double* x = new_vector(fix.size);
    for (int k = 0; k < 12; k++) {
        double c = cos(k * RUGA_PI / 12), s = sin(k * RUGA_PI / 12);
        for (int i = 0; i < fix.size; i += 3) {
            const double* rest = fix.mesh.position + i;
            double arc = (c * rest[0] + s * rest[1]) / radius;
            x[i] = radius * sin(arc);
            x[i + 1] = c * rest[1] - s * rest[0];
            x[i + 2] = radius * (1 - cos(arc));
        }
        ruga_shell_energies energies;
        assert_ok(ruga_shell_energy(fix.shell, x, 0, &energies, NULL, NULL));
        assert_near(energies.bending / wanted, 1, 0.05);
    }
    clear(&fix);
}

static void growth_moves_the_rest_state(void** state) {
    (void)state;
    ruga_skin_def skin = plain_skin;
    skin.growth[0] = 1.25;
    skin.growth[1] = 0.8;
    for (int kind = RUGA_MEMBRANE_BARAFF_WITKIN; kind <= RUGA_MEMBRANE_STVK; kind++) {
        skin.membrane = (ruga_membrane)kind;
        fixture fix, grown;
        make_grid_shell(&fix, 4, 3, 0, &skin);
        double *x = deformed(&fix, 1.25, 0.8, 0, 1), *gradient = new_vector(fix.size);
        ruga_shell_energies energies;
        assert_ok(ruga_shell_energy(fix.shell, x, 0, &energies, gradient, NULL));
        assert_near(energies.membrane, 0, 1e-26);
        assert_near(vector_norm(fix.size, gradient), 0, 1e-12);
        // It is the same shell as one whose rest shape has the grown size.
        make_grid(4, 3, 0, &grown.mesh);
        memcpy(grown.mesh.position, x, (size_t)fix.size * sizeof *x);
        ruga_skin_def still = skin;
        still.growth[0] = still.growth[1] = 1;
        make_shell(&grown, &still);
        double* bent = deformed(&fix, 1.1, 1, 0.2, 9);
        ruga_shell_energies other;
        assert_ok(ruga_shell_energy(fix.shell, bent, 0, &energies, NULL, NULL));
        assert_ok(ruga_shell_energy(grown.shell, bent, 0, &other, NULL, NULL));
        assert_near(energies.membrane / other.membrane, 1, 1e-12);
        assert_near(energies.bending / other.bending, 1, 1e-12);
        clear(&fix);
        clear(&grown);
    }
}

static void mass_is_density_times_thickness_times_area(void** state) {
    (void)state;
    fixture fix;
    make_grid_shell(&fix, 4, 3, 0, &plain_skin);
    double* mass = new_vector(fix.size / 3);
    double sum = 0;
    ruga_shell_vertex_mass(fix.shell, mass);
    for (int v = 0; v < fix.size / 3; v++) {
        sum += mass[v];
    }
    assert_near(sum, 2 * 1 * 12, 1e-12);
    clear(&fix);
}

static void thickness_and_young_may_vary_from_face_to_face(void** state) {
    (void)state;
    fixture fix;
    make_hinge(0, &fix.mesh);
    make_shell(&fix, &plain_skin);
    ruga_mesh bent;
    make_hinge(0.4, &bent);
    double plain = total_energy(&fix, bent.position);
    // Areas 0.4 and 0.3; stiffnesses 1 and 8 times: mean softness (0.4 + 0.3 / 8) / 0.7.
    const double thickness[2] = {1, 2}, young[2] = {100, 100}, triple[2] = {300, 300};
    ruga_shell_material material = {.skin = plain_skin, .thickness = thickness, .young = young};
    material.skin.thickness = material.skin.young = 0; // not used
    ruga_shell_destroy(&fix.shell);
    assert_ok(ruga_shell_create(&fix.mesh, &fix.connectivity, &material, &fix.shell));
    double thick = total_energy(&fix, bent.position);
    assert_near(thick / plain, 0.7 / (0.4 + 0.3 / 8), 1e-12);
    material.young = triple;
    ruga_shell_destroy(&fix.shell);
    assert_ok(ruga_shell_create(&fix.mesh, &fix.connectivity, &material, &fix.shell));
    assert_near(total_energy(&fix, bent.position) / thick, 3, 1e-12);
    ruga_mesh_clear(&bent);
    clear(&fix);
}

static void force_square_sums_over_elements(void** state) {
    (void)state;
    fixture fix;
    make_hinge(0, &fix.mesh);
    make_shell(&fix, &plain_skin);
    double gradient[12];
    ruga_shell_energies energies;
    ruga_mesh bent;
    make_hinge(1.2, &bent); // the triangles keep their shapes: only the hinge has forces
    assert_ok(ruga_shell_energy(fix.shell, bent.position, 0, &energies, gradient, NULL));
    assert_near(sqrt(energies.force_square) / vector_norm(12, gradient), 1, 1e-12);
    // One triangle stretched about the other, which is at rest.
    memcpy(bent.position, fix.mesh.position, 12 * sizeof(double));
    bent.position[7] += 0.1;
    assert_ok(ruga_shell_energy(fix.shell, bent.position, 0, &energies, gradient, NULL));
    assert_near(sqrt(energies.force_square) / vector_norm(12, gradient), 1, 1e-12);
    ruga_mesh_clear(&bent);
    clear(&fix);
}

static void collapsed_states_give_finite_numbers(void** state) {
    (void)state;
    const double scale[][3] = {{0, 0, 0}, {0, 1, 1}, {1, 0, 0}, {1e-9, 1, 0}, {1e-200, 1e-200, 1e-200}};
    for (int kind = RUGA_MEMBRANE_BARAFF_WITKIN; kind <= RUGA_MEMBRANE_STVK; kind++) {
        ruga_skin_def skin = plain_skin;
        skin.membrane = (ruga_membrane)kind;
        fixture fix;
        make_grid_shell(&fix, 3, 2, 0.1, &skin);
        int entries = ruga_shell_pattern(fix.shell)->start[fix.size];
        double *x = new_vector(fix.size), *gradient = new_vector(fix.size), *hessian = new_vector(entries);
        for (size_t k = 0; k <= sizeof scale / sizeof scale[0]; k++) {
            for (int i = 0; i < fix.size; i++) {
                x[i] = k == 5 ? fix.mesh.position[i % 6] : scale[k][i % 3] * fix.mesh.position[i];
            }
            ruga_shell_energies energies;
            assert_ok(ruga_shell_energy(fix.shell, x, 0.5, &energies, gradient, hessian));
            assert_true(isfinite(energies.membrane + energies.bending + energies.force_square));
            assert_true(isfinite(vector_norm(fix.size, gradient)) && isfinite(vector_norm(entries, hessian)));
        }
        clear(&fix);
    }
}

static void same_bits_for_any_threads_and_any_history(void** state) {
    (void)state;
    fixture fix;
    make_grid_shell(&fix, 40, 30, 0.2, &plain_skin);
    int n = fix.size, entries = ruga_shell_pattern(fix.shell)->start[n];
    double *x = deformed(&fix, 0.9, 1.1, 0.1, 5), *other = deformed(&fix, 2, 0.5, 0.3, 6);
    double *g1 = new_vector(n), *g2 = new_vector(n), *h1 = new_vector(entries), *h2 = new_vector(entries);
    ruga_shell_energies e1, e2;
    size_t bytes = ruga_byte_count();
    ruga_set_threads(1);
    assert_ok(ruga_shell_energy(fix.shell, x, 0.25, &e1, g1, h1));
    assert_int_equal(ruga_byte_count(), bytes);
    for (int threads = 1; threads <= 3; threads++) {
        ruga_set_threads(threads);
        assert_ok(ruga_shell_energy(fix.shell, other, 0.5, &e2, g2, h2));
        assert_ok(ruga_shell_energy(fix.shell, x, 0.25, &e2, g2, h2));
        assert_memory_equal(&e1, &e2, sizeof e1);
        assert_memory_equal(g1, g2, (size_t)n * sizeof *g1);
        assert_memory_equal(h1, h2, (size_t)entries * sizeof *h1);
    }
    ruga_set_threads(0);
    clear(&fix);
}

static void refuse(const fixture* fix, const ruga_shell_material* material, ruga_status wanted,
                   const char* sentence) {
    ruga_shell* shell = NULL;
    assert_status(ruga_shell_create(&fix->mesh, &fix->connectivity, material, &shell), wanted);
    assert_null(shell);
    if (!strstr(ruga_last_error(), sentence)) {
        fail_msg("\"%s\" does not say \"%s\"", ruga_last_error(), sentence);
    }
}

// As above, for one field of the skin.
static void refuse_field(const fixture* fix, size_t field, double value, const char* name) {
    ruga_shell_material material = {.skin = plain_skin};
    memcpy((char*)&material.skin + field, &value, sizeof value);
    refuse(fix, &material, RUGA_BAD_INPUT, name);
}

static void bad_input_is_refused_with_a_sentence(void** state) {
    (void)state;
    const double bad[] = {0, -1, NAN, INFINITY}, poisson[] = {-1, 0.5, NAN, -INFINITY};
    fixture fix = {.shell = NULL};
    make_hinge(0, &fix.mesh);
    assert_ok(ruga_connectivity_create(&fix.mesh, &fix.connectivity));
    for (int k = 0; k < 4; k++) {
        refuse_field(&fix, offsetof(ruga_skin_def, thickness), bad[k], "skin.thickness");
        refuse_field(&fix, offsetof(ruga_skin_def, young), bad[k], "skin.young");
        refuse_field(&fix, offsetof(ruga_skin_def, growth), bad[k], "skin.growth[0]");
        refuse_field(&fix, offsetof(ruga_skin_def, growth) + sizeof(double), bad[k], "skin.growth[1]");
        refuse_field(&fix, offsetof(ruga_skin_def, poisson), poisson[k], "skin.poisson");
        const double values[2] = {1, bad[k]};
        const ruga_shell_material thickness = {.skin = plain_skin, .thickness = values};
        const ruga_shell_material young = {.skin = plain_skin, .young = values};
        refuse(&fix, &thickness, RUGA_BAD_INPUT, "face 1 (counted from 0) at (0.633333, -0.2, 0) m");
        refuse(&fix, &young, RUGA_BAD_INPUT, "face 1 ");
    }
    refuse_field(&fix, offsetof(ruga_skin_def, density), -1, "skin.density");
    const ruga_shell_material good = {.skin = plain_skin};
    fix.mesh.position[10] = 0; // corner 3 on the line of the edge
    refuse(&fix, &good, RUGA_BAD_MESH, "face 1 (counted from 0)");
    fix.mesh.position[10] = NAN;
    refuse(&fix, &good, RUGA_BAD_MESH, "face 1 (counted from 0)");
    clear(&fix);
}

static void failed_allocations_neither_crash_nor_leak(void** state) {
    (void)state;
    const ruga_shell_material material = {.skin = plain_skin};
    let_allocations_fail_after(1000);
    fixture fix;
    make_grid(3, 2, 0.1, &fix.mesh);
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
    assert_true(tries > 20);
    clear(&fix);
    ruga_set_allocator(NULL, NULL, NULL);
}

static void wrinkles_have_the_published_lengths(void** state) {
    (void)state;
    const double value[][4] = {// thickness, E_x, E_q, wavelength
                               {2e-3, 40e6, 0.5e6, 0.0375},
                               {2e-4, 100, 1, 0.00404},
                               {7e-4, 1e4, 1, 0.0657},
                               {1e-3, 100, 1, 0.0202}};
    for (int k = 0; k < 4; k++) {
        ruga_skin_def skin = plain_skin;
        const ruga_interior_def interior = {.young = value[k][2], .poisson = 0.3};
        skin.thickness = value[k][0];
        skin.young = value[k][1];
        assert_near(ruga_wrinkle_wavelength(&skin, &interior) / value[k][3], 1, 2e-3);
    }
}

static void wrinkles_grow_from_the_critical_strain(void** state) {
    (void)state;
    ruga_skin_def skin = plain_skin;
    const ruga_interior_def interior = {.young = 1, .poisson = 0.3};
    double critical = ruga_wrinkle_critical_strain(&skin, &interior);
    assert_near(critical, 0.02414, 5e-6); // ratio 100
    assert_near(ruga_wrinkle_amplitude(&skin, &interior, 0.9 * critical), 0, 0);
    assert_near(ruga_wrinkle_amplitude(&skin, &interior, 2 * critical), skin.thickness, 1e-12);
    // The same law by the wavelength: (lambda / pi) sqrt(strain - critical).
    double law = ruga_wrinkle_wavelength(&skin, &interior) / RUGA_PI * sqrt(0.05 - critical);
    assert_near(ruga_wrinkle_amplitude(&skin, &interior, 0.05) / law, 1, 1e-12);
    // Only E* = E / (1 - nu^2) matters.
    skin.poisson = 0;
    skin.young /= 1 - 0.09;
    assert_near(ruga_wrinkle_critical_strain(&skin, &interior) / critical, 1, 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rest_state_has_no_energy_and_no_force),
        cmocka_unit_test(rigid_motion_changes_nothing),
        cmocka_unit_test(derivatives_agree_with_differences_to_second_order),
        cmocka_unit_test(derivatives_hold_for_fibres_of_no_length),
        cmocka_unit_test(hinge_derivatives_hold_at_every_angle),
        cmocka_unit_test(angles_differ_by_the_short_way_round),
        cmocka_unit_test(clamped_hessian_is_positive_semidefinite),
        cmocka_unit_test(clamp_changes_nothing_under_tension),
        cmocka_unit_test(stretched_sheet_has_the_moduli_of_its_material),
        cmocka_unit_test(small_strain_membrane_is_isotropic_in_both_models),
        cmocka_unit_test(rolled_sheet_has_the_bending_energy_of_a_cylinder),
        cmocka_unit_test(growth_moves_the_rest_state),
        cmocka_unit_test(mass_is_density_times_thickness_times_area),
        cmocka_unit_test(thickness_and_young_may_vary_from_face_to_face),
        cmocka_unit_test(force_square_sums_over_elements),
        cmocka_unit_test(collapsed_states_give_finite_numbers),
        cmocka_unit_test(same_bits_for_any_threads_and_any_history),
        cmocka_unit_test(bad_input_is_refused_with_a_sentence),
        cmocka_unit_test(failed_allocations_neither_crash_nor_leak),
        cmocka_unit_test(wrinkles_have_the_published_lengths),
        cmocka_unit_test(wrinkles_grow_from_the_critical_strain),
    };
    return cmocka_run_group_tests_name("shell", tests, NULL, check_no_leak);
}
