// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/parallel.h"
#include "ruga/ruga.h"
#include "core/vec3.h"
#include "lattice/corotational.h"
#include "lattice/elasticity.h"
#include "tests/box_lattice.h"
#include "tests/deformations.h"
#include "tests/dense.h"

#include <stdlib.h>
#include <string.h>

static double* new_array(int count) {
    double* a = NULL;
    assert_ok(RUGA_NEW_ZERO(a, count));
    return a;
}

//---- the lattice ----

typedef struct body {
    ruga_lattice lattice;
    ruga_elasticity* elasticity;
    const ruga_sparse* pattern;
    int n; // unknowns
    double *q, *gradient, *hessian;
} body;

// In place, as the elasticity keeps the lattice's address.
static void make_body(int degree, int nx, int ny, int nz, body* b) {
    box_lattice(degree, nx, ny, nz, 0, &b->lattice);
    assert_ok(ruga_elasticity_create(&b->lattice, YOUNG, POISSON, NULL, &b->elasticity));
    b->pattern = ruga_elasticity_pattern(b->elasticity);
    b->n = 3 * b->lattice.node_count;
    b->q = new_array(b->n);
    b->gradient = new_array(b->n);
    b->hessian = new_array(b->pattern->start[b->n]);
}

static void free_body(body* b) {
    ruga_elasticity_destroy(&b->elasticity);
    ruga_lattice_clear(&b->lattice);
    ruga_release(b->q);
    ruga_release(b->gradient);
    ruga_release(b->hessian);
}

static double body_energy(body* b, const double* q) {
    double energy;
    assert_ok(ruga_elasticity_energy(b->elasticity, q, false, &energy, NULL, NULL, NULL));
    return energy;
}

static double body_volume(const body* b) {
    double volume = 0;
    for (int i = 0; i < b->lattice.element_count * 27; i++) {
        volume += b->lattice.volume[i];
    }
    return volume;
}

static void rest_has_no_energy_and_no_force(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        body b;
        make_body(degree, 3, 2, 2, &b);
        double energy, square;
        assert_ok(
            ruga_elasticity_energy(b.elasticity, b.lattice.rest, false, &energy, b.gradient, NULL, &square));
        assert_near(energy, 0, 1e-28);
        assert_near(sqrt(square), 0, 1e-13);
        assert_near(sqrt(dot(b.n, b.gradient, b.gradient)), 0, 1e-13);
        free_body(&b);
    }
}

static void affine_maps_have_the_energy_of_the_closed_form(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        body b;
        make_body(degree, 2, 3, 2, &b);
        for (int k = 0; k < GRADIENT_COUNT; k++) {
            box_deform(&b.lattice, GRADIENTS[k], 0, b.q);
            double wanted = body_volume(&b) * ruga_corotational(MU, LAMBDA, GRADIENTS[k], false, NULL, NULL);
            assert_near(body_energy(&b, b.q), wanted, 1e-12 * (wanted + 1e-12));
        }
        free_body(&b);
    }
}

static void rigid_motion_changes_nothing(void** state) {
    (void)state;
    ruga_random random = {5};
    for (int degree = 1; degree <= 2; degree++) {
        body b;
        make_body(degree, 2, 2, 1, &b);
        double r[9], *moved = new_array(b.n), *gradient = new_array(b.n), energy, moved_energy;
        const double shift[3] = {3, -20, 7};
        random_rotation(&random, r);
        for (int k = 0; k < GRADIENT_COUNT; k++) {
            box_deform(&b.lattice, GRADIENTS[k], 0.02, b.q);
            for (int a = 0; a < b.lattice.node_count; a++) {
                ruga_multiply3(r, &b.q[3 * a], &moved[3 * a]);
                ruga_add_scaled(1, shift, &moved[3 * a]);
            }
            assert_ok(ruga_elasticity_energy(b.elasticity, b.q, false, &energy, b.gradient, NULL, NULL));
            assert_ok(
                ruga_elasticity_energy(b.elasticity, moved, false, &moved_energy, gradient, NULL, NULL));
            assert_near(moved_energy, energy, 1e-10 * energy);
            double size = sqrt(dot(b.n, b.gradient, b.gradient));
            for (int a = 0; a < b.lattice.node_count; a++) {
                double turned[3];
                ruga_multiply3(r, &b.gradient[3 * a], turned);
                assert_near(ruga_distance(turned, &gradient[3 * a]), 0, 1e-10 * size);
            }
        }
        ruga_release(moved);
        ruga_release(gradient);
        free_body(&b);
    }
}

static void body_difference_errors(body* b, const double* d, double h, double error[2]) {
    double *q = new_array(b->n), *plus = new_array(b->n), *minus = new_array(b->n), ep, em;
    for (int i = 0; i < b->n; i++) {
        q[i] = b->q[i] + h * d[i];
    }
    assert_ok(ruga_elasticity_energy(b->elasticity, q, false, &ep, plus, NULL, NULL));
    for (int i = 0; i < b->n; i++) {
        q[i] = b->q[i] - h * d[i];
    }
    assert_ok(ruga_elasticity_energy(b->elasticity, q, false, &em, minus, NULL, NULL));
    assert_ok(ruga_elasticity_energy(b->elasticity, b->q, false, NULL, b->gradient, b->hessian, NULL));
    error[0] = fabs((ep - em) / (2 * h) - dot(b->n, b->gradient, d));
    ruga_sparse k = *b->pattern;
    k.value = b->hessian;
    ruga_sparse_multiply_symmetric(&k, d, q);
    error[1] = 0;
    for (int i = 0; i < b->n; i++) {
        double e = (plus[i] - minus[i]) / (2 * h) - q[i];
        error[1] += e * e;
    }
    error[1] = sqrt(error[1]);
    ruga_release(q);
    ruga_release(plus);
    ruga_release(minus);
}

static void force_and_stiffness_are_centred_differences_at_second_order(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        body b;
        make_body(degree, 2, 1, 2, &b);
        double* d = new_array(b.n);
        ruga_random random = {6};
        for (int i = 0; i < b.n; i++) {
            d[i] = signed_random(&random);
        }
        for (int k = 0; k < GRADIENT_COUNT; k++) {
            double coarse[2], fine[2];
            box_deform(&b.lattice, GRADIENTS[k], 0.01, b.q);
            body_difference_errors(&b, d, 2e-3, coarse);
            body_difference_errors(&b, d, 1e-3, fine);
            for (int i = 0; i < 2; i++) {
                assert_true(coarse[i] < 1e-2);
                assert_near(coarse[i] / fine[i], 4, 0.2);
            }
        }
        ruga_release(d);
        free_body(&b);
    }
}

static void projected_stiffness_is_semi_definite(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        body b;
        make_body(degree, 1, 1, 1, &b);
        double *dense = new_array(b.n * b.n), low, high;
        for (int k = 0; k < GRADIENT_COUNT; k++) {
            box_deform(&b.lattice, GRADIENTS[k], 0.2, b.q);
            assert_ok(ruga_elasticity_energy(b.elasticity, b.q, true, NULL, NULL, b.hessian, NULL));
            dense_from_lower(b.pattern, b.hessian, dense);
            dense_eigenvalue_range(b.n, dense, &low, &high);
            assert_true(low >= -1e-12 * high);
        }
        ruga_release(dense);
        free_body(&b);
    }
}

static void stiffness_at_rest_lets_go_of_rigid_modes_alone(void** state) {
    (void)state;
    body b;
    make_body(2, 1, 1, 1, &b);
    double *dense = new_array(b.n * b.n), *mode = new_array(b.n), *force = new_array(b.n), low, high;
    assert_ok(ruga_elasticity_energy(b.elasticity, b.lattice.rest, false, NULL, NULL, b.hessian, NULL));
    dense_from_lower(b.pattern, b.hessian, dense);
    ruga_sparse k = *b.pattern;
    k.value = b.hessian;
    for (int m = 0; m < 6; m++) {
        for (int a = 0; a < b.lattice.node_count; a++) {
            const double axis[3] = {m % 3 == 0, m % 3 == 1, m % 3 == 2};
            double turn[3];
            ruga_cross(axis, &b.lattice.rest[3 * a], turn);
            memcpy(&mode[3 * a], m < 3 ? axis : turn, sizeof turn);
        }
        ruga_sparse_multiply_symmetric(&k, mode, force);
        assert_near(sqrt(dot(b.n, force, force)), 0, 1e-13);
        // Made stiff along the six modes, nothing is left at zero.
        for (int i = 0; i < b.n * b.n; i++) {
            dense[i] += mode[i / b.n] * mode[i % b.n];
        }
    }
    dense_eigenvalue_range(b.n, dense, &low, &high);
    assert_true(low > 1e-8 * YOUNG);
    ruga_release(dense);
    ruga_release(mode);
    ruga_release(force);
    free_body(&b);
}

static void small_strain_is_linear_elasticity(void** state) {
    (void)state;
    static const double strain[9] = {1, 0.3, -0.2, 0.3, -0.5, 0.4, -0.2, 0.4, 0.7};
    double trace = strain[0] + strain[4] + strain[8];
    body b;
    make_body(2, 2, 2, 2, &b);
    double linear = body_volume(&b) * (MU * dot(9, strain, strain) + LAMBDA / 2 * trace * trace);
    double last = 0;
    for (int k = 0; k < 3; k++) {
        double f[9], size = k == 0 ? 1e-3 : k == 1 ? 1e-4 : 1e-5;
        for (int i = 0; i < 9; i++) {
            f[i] = (i % 4 == 0) + size * strain[i];
        }
        box_deform(&b.lattice, f, 0, b.q);
        double error = fabs(body_energy(&b, b.q) / (size * size * linear) - 1);
        assert_true(error < 2 * size);
        assert_true(k == 0 || error < 0.12 * last);
        last = error;
    }
    free_body(&b);
}

// Newton's method with the projected Hessian and Armijo's rule; the final energy.
static double minimise(body* b, int* iterations) {
    double *dense = new_array(b->n * b->n), *step = new_array(b->n), *trial = new_array(b->n), energy = 0;
    for (*iterations = 0; *iterations < 200; ++*iterations) {
        assert_ok(ruga_elasticity_energy(b->elasticity, b->q, true, &energy, b->gradient, b->hessian, NULL));
        if (energy < 1e-20) {
            break;
        }
        dense_from_lower(b->pattern, b->hessian, dense);
        for (int i = 0; i < b->n; i++) {
            dense[i * b->n + i] += 1e-6 * YOUNG;
            step[i] = -b->gradient[i];
        }
        dense_solve(b->n, dense, step);
        double slope = dot(b->n, step, b->gradient), length = 1, lower;
        do {
            for (int i = 0; i < b->n; i++) {
                trial[i] = b->q[i] + length * step[i];
            }
            lower = body_energy(b, trial);
            length /= 2;
        } while (lower > energy + 1e-4 * 2 * length * slope && length > 1e-12);
        memcpy(b->q, trial, (size_t)b->n * sizeof *trial);
    }
    ruga_release(dense);
    ruga_release(step);
    ruga_release(trial);
    return energy;
}

static void a_body_recovers_from_inversion_collapse_and_disorder(void** state) {
    (void)state;
    static const double starts[][9] = {{-1, 0, 0, 0, -1, 0, 0, 0, -1},
                                       {0},
                                       {1, 0, 0, 0, 1, 0, 0, 0, 0},
                                       {1, 0, 0, 0, 1, 0, 0, 0, -1},
                                       {0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01}};
    for (int size = 1; size <= 2; size++) {
        for (int k = 0; k < 14; k++) {
            int start = k / 2, degree = 1 + k % 2;
            body b;
            make_body(degree, size, size, 1, &b);
            box_deform(&b.lattice, starts[start % 5], start < 5 ? 0 : 0.5, b.q);
            int iterations;
            double before = body_energy(&b, b.q), energy = minimise(&b, &iterations);
            print_message("%d cells, degree %d, start %d: energy %.3g -> %.3g in %d steps\n", size * size,
                          degree, start, before, energy, iterations);
            assert_true(energy < 1e-12);
            free_body(&b);
        }
    }
}

static void results_do_not_depend_on_threads(void** state) {
    (void)state;
    body b;
    make_body(2, 5, 5, 4, &b);
    int entries = b.pattern->start[b.n];
    double *gradient = new_array(b.n), *hessian = new_array(entries), energy[2], square[2];
    box_deform(&b.lattice, GRADIENTS[0], 0.3, b.q);
    ruga_set_threads(1);
    assert_ok(ruga_elasticity_energy(b.elasticity, b.q, true, &energy[0], gradient, hessian, &square[0]));
    for (int threads = 2; threads <= 5; threads++) {
        ruga_set_threads(threads);
        assert_ok(
            ruga_elasticity_energy(b.elasticity, b.q, true, &energy[1], b.gradient, b.hessian, &square[1]));
        assert_memory_equal(&energy[0], &energy[1], sizeof *energy);
        assert_memory_equal(&square[0], &square[1], sizeof *square);
        assert_memory_equal(gradient, b.gradient, (size_t)b.n * sizeof *gradient);
        assert_memory_equal(hessian, b.hessian, (size_t)entries * sizeof *hessian);
    }
    ruga_set_threads(0);
    ruga_release(gradient);
    ruga_release(hessian);
    free_body(&b);
}

//---- mass and slivers ----

static void mass_is_density_times_volume_and_exact_for_linear_velocities(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        body b;
        make_body(degree, 3, 2, 2, &b);
        double density = 70, *v = new_array(b.n), *p = new_array(b.n);
        assert_ok(ruga_elasticity_mass(b.elasticity, density, NULL, b.hessian));
        ruga_sparse m = *b.pattern;
        m.value = b.hessian;
        double size[3], volume = 1;
        for (int i = 0; i < 3; i++) {
            size[i] = b.lattice.cells[i] * b.lattice.cell_size[i];
            volume *= size[i];
        }
        for (int axis = 0; axis < 3; axis++) {
            for (int i = 0; i < b.n; i++) {
                v[i] = i % 3 == axis;
            }
            ruga_sparse_multiply_symmetric(&m, v, p);
            assert_near(dot(b.n, v, p) / (density * volume), 1, 1e-12);
            // Velocity x_axis along the next axis: kinetic energy from the second moment of the box.
            double x0 = b.lattice.origin[axis], x1 = x0 + size[axis];
            for (int i = 0; i < b.n; i++) {
                v[i] = i % 3 == (axis + 1) % 3 ? b.lattice.rest[i / 3 * 3 + axis] : 0;
            }
            ruga_sparse_multiply_symmetric(&m, v, p);
            double moment = density * volume / size[axis] * (x1 * x1 * x1 - x0 * x0 * x0) / 3;
            assert_near(dot(b.n, v, p) / moment, 1, 1e-12);
        }
        ruga_release(v);
        ruga_release(p);
        free_body(&b);
    }
}

static void vertex_masses_are_added_through_the_embedding(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        ruga_lattice lattice;
        enum { VERTICES = 60 };
        box_lattice(degree, 2, 1, 1, VERTICES, &lattice);
        ruga_elasticity* e;
        assert_ok(ruga_elasticity_create(&lattice, YOUNG, POISSON, NULL, &e));
        const ruga_sparse* pattern = ruga_elasticity_pattern(e);
        int n = pattern->columns, npe = lattice.nodes_per_element;
        double *mass = new_array(pattern->start[n]), *dense = new_array(n * n), vertex_mass[VERTICES];
        for (int v = 0; v < VERTICES; v++) {
            vertex_mass[v] = 1 + 0.1 * v;
        }
        assert_ok(ruga_elasticity_mass(e, 0, vertex_mass, mass));
        dense_from_lower(pattern, mass, dense);
        for (int v = 0; v < VERTICES; v++) {
            const int* node = &lattice.element_node[lattice.vertex_element[v] * npe];
            const double* weight = &lattice.vertex_weight[v * npe];
            for (int a = 0; a < npe; a++) {
                for (int b = 0; b < npe; b++) {
                    for (int i = 0; i < 3; i++) {
                        dense[(3 * node[a] + i) * n + 3 * node[b] + i] -=
                            vertex_mass[v] * weight[a] * weight[b];
                    }
                }
            }
        }
        for (int i = 0; i < n * n; i++) {
            assert_near(dense[i], 0, 1e-12);
        }
        ruga_release(mass);
        ruga_release(dense);
        ruga_elasticity_destroy(&e);
        ruga_lattice_clear(&lattice);
    }
}

// A full cell beside one of which a fraction is filled: the range of eigenvalues of M / dt^2 + K.
static void sliver_range(double fraction, double* low, double* high) {
    body b = {0};
    box_lattice(2, 2, 1, 1, 0, &b.lattice);
    for (int g = 0; g < 27; g++) {
        b.lattice.volume[27 + g] *= fraction;
    }
    assert_ok(ruga_elasticity_create(&b.lattice, YOUNG, POISSON, NULL, &b.elasticity));
    const ruga_sparse* pattern = ruga_elasticity_pattern(b.elasticity);
    int n = pattern->columns;
    double *k = new_array(pattern->start[n]), *m = new_array(pattern->start[n]), *dense = new_array(n * n);
    assert_ok(ruga_elasticity_energy(b.elasticity, b.lattice.rest, false, NULL, NULL, k, NULL));
    assert_ok(ruga_elasticity_mass(b.elasticity, 1, NULL, m));
    for (int i = 0; i < pattern->start[n]; i++) {
        k[i] += YOUNG * m[i];
    }
    dense_from_lower(pattern, k, dense);
    dense_eigenvalue_range(n, dense, low, high);
    ruga_release(k);
    ruga_release(m);
    ruga_release(dense);
    ruga_elasticity_destroy(&b.elasticity);
    ruga_lattice_clear(&b.lattice);
}

static void slivers_leave_the_condition_number_bounded(void** state) {
    (void)state;
    double full = 0, low, high;
    for (double fraction = 1; fraction > 0.5e-9; fraction *= 1e-3) {
        sliver_range(fraction, &low, &high);
        full = fraction == 1 ? high / low : full;
        print_message("sliver %.0e: eigenvalues %.3g .. %.3g, condition %.3g\n", fraction, low, high,
                      high / low);
        assert_true(high / low < 1e3 * full);
    }
}

//---- embedded matrices ----

typedef struct embedded {
    ruga_lattice lattice;
    ruga_sparse vertices;
    ruga_elasticity* elasticity;
} embedded;

enum { EMBEDDED_VERTICES = 90 };

// Vertices coupled with the next few, in whatever elements they are.
static void make_embedded(int degree, embedded* m) {
    box_lattice(degree, 3, 2, 1, EMBEDDED_VERTICES, &m->lattice);
    int pairs[EMBEDDED_VERTICES * 2][2];
    for (int v = 0; v < EMBEDDED_VERTICES; v++) {
        pairs[2 * v][0] = pairs[2 * v + 1][0] = v;
        pairs[2 * v][1] = (v + 1) % EMBEDDED_VERTICES;
        pairs[2 * v + 1][1] = (v + 7) % EMBEDDED_VERTICES;
    }
    assert_ok(ruga_sparse_from_pairs(EMBEDDED_VERTICES, 3, 2 * EMBEDDED_VERTICES, (const int(*)[2])pairs,
                                     &m->vertices));
    ruga_random random = {8};
    for (int i = 0; i < m->vertices.start[m->vertices.columns]; i++) {
        m->vertices.value[i] = signed_random(&random);
    }
    assert_ok(ruga_elasticity_create(&m->lattice, YOUNG, POISSON, &m->vertices, &m->elasticity));
}

static void free_embedded(embedded* m) {
    ruga_elasticity_destroy(&m->elasticity);
    ruga_sparse_clear(&m->vertices);
    ruga_lattice_clear(&m->lattice);
}

// B as a dense matrix [3 V][3 N]
static double* dense_embedding(const ruga_lattice* lattice) {
    int n = 3 * lattice->node_count, npe = lattice->nodes_per_element;
    double* b = new_array(3 * lattice->vertex_count * n);
    for (int v = 0; v < lattice->vertex_count; v++) {
        for (int a = 0; a < npe; a++) {
            int node = lattice->element_node[lattice->vertex_element[v] * npe + a];
            for (int i = 0; i < 3; i++) {
                b[(3 * v + i) * n + 3 * node + i] = lattice->vertex_weight[v * npe + a];
            }
        }
    }
    return b;
}

static void embedded_matrix_equals_dense_product(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        embedded m;
        make_embedded(degree, &m);
        const ruga_sparse* pattern = ruga_elasticity_pattern(m.elasticity);
        int n = pattern->columns, rows = m.vertices.columns;
        double *k = new_array(rows * rows), *b = dense_embedding(&m.lattice), *kb = new_array(rows * n);
        double *sum = new_array(pattern->start[n]), *dense = new_array(n * n);
        dense_from_lower(&m.vertices, m.vertices.value, k);
        for (int i = 0; i < rows; i++) {
            for (int j = 0; j < rows; j++) {
                for (int c = 0; c < n && k[i * rows + j] != 0; c++) {
                    kb[i * n + c] += k[i * rows + j] * b[j * n + c];
                }
            }
        }
        for (int i = 0; i < pattern->start[n]; i++) {
            sum[i] = 0.5; // it is added to what is there
        }
        assert_ok(ruga_elasticity_add_embedded(m.elasticity, &m.vertices, sum));
        for (int i = 0; i < pattern->start[n]; i++) {
            sum[i] -= 0.5;
        }
        dense_from_lower(pattern, sum, dense);
        for (int r = 0; r < n; r++) {
            for (int c = 0; c < n; c++) {
                double wanted = 0;
                for (int i = 0; i < rows; i++) {
                    wanted += b[i * n + r] * kb[i * n + c];
                }
                assert_near(dense[r * n + c], wanted, 1e-13);
            }
        }
        ruga_release(k);
        ruga_release(b);
        ruga_release(kb);
        ruga_release(sum);
        ruga_release(dense);
        free_embedded(&m);
    }
}

static void embedded_matrix_does_not_depend_on_threads(void** state) {
    (void)state;
    embedded m;
    make_embedded(2, &m);
    const ruga_sparse* pattern = ruga_elasticity_pattern(m.elasticity);
    int entries = pattern->start[pattern->columns];
    double* sum[2] = {new_array(entries), new_array(entries)};
    for (int threads = 1; threads <= 3; threads += 2) {
        ruga_set_threads(threads);
        assert_ok(ruga_elasticity_add_embedded(m.elasticity, &m.vertices, sum[threads / 2]));
    }
    ruga_set_threads(0);
    assert_memory_equal(sum[0], sum[1], (size_t)entries * sizeof **sum);
    ruga_release(sum[0]);
    ruga_release(sum[1]);
    free_embedded(&m);
}

static void a_vertex_matrix_outside_the_pattern_is_refused(void** state) {
    (void)state;
    ruga_lattice lattice;
    box_lattice(1, 4, 1, 1, 2, &lattice);
    lattice.vertex_element[0] = 0;
    lattice.vertex_element[1] = 3;
    const int pairs[][2] = {{0, 1}};
    ruga_sparse vertices;
    assert_ok(ruga_sparse_from_pairs(2, 3, 1, pairs, &vertices));
    ruga_elasticity* e;
    assert_ok(ruga_elasticity_create(&lattice, YOUNG, POISSON, NULL, &e));
    const ruga_sparse* pattern = ruga_elasticity_pattern(e);
    double* hessian = new_array(pattern->start[pattern->columns]);
    assert_status(ruga_elasticity_add_embedded(e, &vertices, hessian), RUGA_BAD_INPUT);
    ruga_release(hessian);
    ruga_elasticity_destroy(&e);
    ruga_sparse_clear(&vertices);
    ruga_lattice_clear(&lattice);
}

static void impossible_materials_are_refused(void** state) {
    (void)state;
    ruga_lattice lattice;
    box_lattice(1, 1, 1, 1, 0, &lattice);
    ruga_elasticity* e;
    const double bad[][2] = {{0, 0.3}, {-1, 0.3}, {1, 0.5}, {1, -1}, {NAN, 0.3}, {1, NAN}};
    for (int k = 0; k < 6; k++) {
        assert_status(ruga_elasticity_create(&lattice, bad[k][0], bad[k][1], NULL, &e), RUGA_BAD_INPUT);
        assert_null(e);
    }
    ruga_lattice_clear(&lattice);
}

static ruga_status everything(const embedded* m, double* hessian) {
    ruga_elasticity* e = NULL;
    ruga_status status = ruga_elasticity_create(&m->lattice, YOUNG, POISSON, &m->vertices, &e);
    if (status == RUGA_OK) {
        status = ruga_elasticity_energy(e, m->lattice.rest, true, NULL, NULL, hessian, NULL);
    }
    if (status == RUGA_OK) {
        status = ruga_elasticity_mass(e, 1, NULL, hessian);
    }
    if (status == RUGA_OK) {
        status = ruga_elasticity_add_embedded(e, &m->vertices, hessian);
    }
    ruga_elasticity_destroy(&e);
    return status;
}

static void any_failed_allocation_is_a_status_and_leaks_nothing(void** state) {
    (void)state;
    embedded m;
    make_embedded(1, &m);
    const ruga_sparse* pattern = ruga_elasticity_pattern(m.elasticity);
    double* hessian = new_array(pattern->start[pattern->columns]);
    size_t before = ruga_byte_count();
    ruga_status status = RUGA_NO_MEMORY;
    int k = 0;
    for (; status != RUGA_OK && k < 200; k++) {
        let_allocations_fail_after(k);
        status = everything(&m, hessian);
        ruga_set_allocator(NULL, NULL, NULL);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        assert_int_equal(ruga_byte_count(), before);
    }
    assert_int_equal(status, RUGA_OK);
    assert_true(k > 20);
    ruga_release(hessian);
    free_embedded(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rest_has_no_energy_and_no_force),
        cmocka_unit_test(affine_maps_have_the_energy_of_the_closed_form),
        cmocka_unit_test(rigid_motion_changes_nothing),
        cmocka_unit_test(force_and_stiffness_are_centred_differences_at_second_order),
        cmocka_unit_test(projected_stiffness_is_semi_definite),
        cmocka_unit_test(stiffness_at_rest_lets_go_of_rigid_modes_alone),
        cmocka_unit_test(small_strain_is_linear_elasticity),
        cmocka_unit_test(a_body_recovers_from_inversion_collapse_and_disorder),
        cmocka_unit_test(results_do_not_depend_on_threads),
        cmocka_unit_test(mass_is_density_times_volume_and_exact_for_linear_velocities),
        cmocka_unit_test(vertex_masses_are_added_through_the_embedding),
        cmocka_unit_test(slivers_leave_the_condition_number_bounded),
        cmocka_unit_test(embedded_matrix_equals_dense_product),
        cmocka_unit_test(embedded_matrix_does_not_depend_on_threads),
        cmocka_unit_test(a_vertex_matrix_outside_the_pattern_is_refused),
        cmocka_unit_test(impossible_materials_are_refused),
        cmocka_unit_test(any_failed_allocation_is_a_status_and_leaks_nothing),
    };
    return cmocka_run_group_tests_name("elasticity", tests, NULL, check_no_leak);
}
