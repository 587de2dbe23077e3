// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "constraints/clusters.h"
#include "constraints/laplacian.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "ruga/ruga.h"
#include "core/random.h"
#include "core/vec3.h"
#include "mesh/make.h"

#include <stdlib.h>
#include <string.h>

typedef struct surface {
    ruga_mesh mesh;
    ruga_connectivity connectivity;
} surface;

static void make_surface(ruga_shape shape, double size, double edge, surface* s) {
    ruga_make_def def = {.shape = shape, .size = {size, size, 0}, .edge = edge};
    assert_ok(ruga_mesh_make(&def, &s->mesh));
    assert_ok(ruga_connectivity_create(&s->mesh, &s->connectivity));
}

// Two copies of a sphere, ten diameters apart, and one vertex without a face.
static void make_two_spheres(double size, double edge, surface* s) {
    surface one;
    make_surface(RUGA_SHAPE_SPHERE, size, edge, &one);
    int v = one.mesh.vertex_count, f = one.mesh.triangle_count;
    double* position = malloc(((size_t)v * 2 + 1) * 3 * sizeof *position);
    int* triangle = malloc((size_t)f * 2 * 3 * sizeof *triangle);
    for (int i = 0; i < 3 * v; i++) {
        position[i] = one.mesh.position[i];
        position[3 * v + i] = one.mesh.position[i] + (i % 3 == 0 ? 10 * size : 0);
    }
    for (int c = 0; c < 3; c++) {
        position[6 * v + c] = 5 * size;
    }
    for (int i = 0; i < 3 * f; i++) {
        triangle[i] = one.mesh.triangle[i];
        triangle[3 * f + i] = one.mesh.triangle[i] + v;
    }
    ruga_mesh_def def = {
        .vertex_count = 2 * v + 1, .positions = position, .triangle_count = 2 * f, .triangles = triangle};
    assert_ok(ruga_mesh_from_def(&def, &s->mesh));
    assert_ok(ruga_connectivity_create(&s->mesh, &s->connectivity));
    ruga_mesh_clear(&one.mesh);
    ruga_connectivity_clear(&one.connectivity);
    free(position);
    free(triangle);
}

static void clear_surface(surface* s) {
    ruga_mesh_clear(&s->mesh);
    ruga_connectivity_clear(&s->connectivity);
}

// Path lengths from a vertex by sweeping all edges until nothing changes.
static void path_lengths(const surface* s, int from, double* distance) {
    for (int v = 0; v < s->mesh.vertex_count; v++) {
        distance[v] = v == from ? 0 : INFINITY;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (int e = 0; e < s->connectivity.edge_count; e++) {
            int i = s->connectivity.edge[e][0], j = s->connectivity.edge[e][1];
            double d = ruga_distance(s->mesh.position + 3 * i, s->mesh.position + 3 * j);
            for (int side = 0; side < 2; side++) {
                int a = side ? j : i, b = side ? i : j;
                if (distance[a] + d < distance[b]) {
                    distance[b] = distance[a] + d;
                    changed = true;
                }
            }
        }
    }
}

static void every_vertex_is_within_radius_of_a_centre(void** state) {
    (void)state;
    surface s;
    ruga_clusters h;
    const double radius = 0.2;
    make_two_spheres(1, 0.1, &s);
    assert_ok(ruga_clusters_create(&s.mesh, &s.connectivity, radius, 0.2, 0, 1, &h));
    int n = s.mesh.vertex_count;
    double* nearest = malloc((size_t)n * sizeof *nearest);
    double* d = malloc((size_t)n * sizeof *d);
    bool has_center[2] = {false, false};
    for (int v = 0; v < n; v++) {
        nearest[v] = INFINITY;
    }
    for (int k = 0; k < h.count; k++) {
        path_lengths(&s, h.center[k], d);
        has_center[s.connectivity.component[h.center[k]]] = true;
        // Farthest point first: when chosen, after one for each component, no vertex was farther than the
        // centre; and none of the centres is within radius of another.
        double most = 0;
        for (int v = 0; v + 1 < n; v++) {
            most = nearest[v] > most ? nearest[v] : most;
        }
        assert_true(k < 2 || nearest[h.center[k]] >= most * (1 - 1e-12));
        assert_true(k == 0 || nearest[h.center[k]] > radius);
        for (int v = 0; v < n; v++) {
            nearest[v] = d[v] < nearest[v] ? d[v] : nearest[v];
        }
    }
    assert_true(has_center[0] && has_center[1]);
    for (int v = 0; v + 1 < n; v++) {
        assert_true(nearest[v] <= radius);
    }
    assert_true(nearest[n - 1] == INFINITY); // the vertex without a face belongs to nothing
    assert_int_equal(h.column_start[n], h.column_start[n - 1]);
    free(nearest);
    free(d);
    ruga_clusters_clear(&h);
    clear_surface(&s);
}

static void rows_are_truncated_gaussians_that_sum_to_one(void** state) {
    (void)state;
    surface s;
    ruga_clusters h;
    const double sigma = 0.15;
    make_surface(RUGA_SHAPE_SHEET, 1, 0.05, &s);
    assert_ok(ruga_clusters_create(&s.mesh, &s.connectivity, 0.2, sigma, 0, 7, &h));
    double* d = malloc((size_t)s.mesh.vertex_count * sizeof *d);
    for (int k = 0; k < h.count; k++) {
        path_lengths(&s, h.center[k], d);
        double sum = 0, center_weight = 0;
        int members = 0;
        for (int i = h.start[k]; i < h.start[k + 1]; i++) {
            assert_true(i == h.start[k] || h.vertex[i] > h.vertex[i - 1]);
            sum += h.weight[i];
            center_weight = h.vertex[i] == h.center[k] ? h.weight[i] : center_weight;
        }
        for (int v = 0; v < s.mesh.vertex_count; v++) {
            members += d[v] < 2 * sigma;
        }
        assert_near(sum, 1, 1e-14);
        assert_int_equal(members, h.start[k + 1] - h.start[k]);
        for (int i = h.start[k]; i < h.start[k + 1]; i++) {
            double x = d[h.vertex[i]] / sigma;
            assert_near(h.weight[i] / center_weight, exp(-x * x / 2), 1e-12);
        }
    }
    free(d);
    ruga_clusters_clear(&h);
    clear_surface(&s);
}

static void a_count_is_met_exactly_and_its_centres_are_distinct(void** state) {
    (void)state;
    surface s;
    ruga_clusters h;
    make_two_spheres(1, 0.2, &s);
    for (int count = 2; count < 40; count += 9) {
        assert_ok(ruga_clusters_create(&s.mesh, &s.connectivity, 0, 1e-9, count, 3, &h));
        assert_int_equal(h.count, count);
        assert_int_equal(h.start[count], count); // so narrow a Gaussian leaves the centre alone
        for (int k = 0; k < count; k++) {
            assert_near(h.weight[k], 1, 0);
            for (int j = 0; j < k; j++) {
                assert_int_not_equal(h.center[j], h.center[k]);
            }
        }
        ruga_clusters_clear(&h);
    }
    assert_status(ruga_clusters_create(&s.mesh, &s.connectivity, 0, 0.1, 1, 3, &h), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "2 separate pieces"));
    assert_status(ruga_clusters_create(&s.mesh, &s.connectivity, 0, 0.1, s.mesh.vertex_count, 3, &h),
                  RUGA_BAD_INPUT);
    assert_status(ruga_clusters_create(&s.mesh, &s.connectivity, 0.1, 0, 0, 3, &h), RUGA_BAD_INPUT);
    assert_status(ruga_clusters_create(&s.mesh, &s.connectivity, 0, 0.1, 0, 3, &h), RUGA_BAD_INPUT);
    clear_surface(&s);
}

static void fill_random(int count, uint64_t seed, double* x) {
    ruga_random random = {seed};
    for (int i = 0; i < count; i++) {
        x[i] = ruga_random_uniform(&random) - 0.5;
    }
}

static void check_products(const ruga_clusters* h) {
    size_t n = (size_t)h->vertex_count * 3, c = (size_t)h->count * 3;
    double *x = malloc(n * sizeof *x), *hty = malloc(n * sizeof *x), *again = malloc(n * sizeof *x);
    double *y = malloc(c * sizeof *y), *hx = malloc(c * sizeof *y), *hx_again = malloc(c * sizeof *y);
    fill_random((int)n, 1, x);
    fill_random((int)c, 2, y);
    memset(hty, 0, n * sizeof *hty);
    memset(again, 0, n * sizeof *again);
    ruga_set_threads(1);
    ruga_clusters_apply(h, x, hx);
    ruga_clusters_apply_transpose(h, y, hty);
    ruga_set_threads(2);
    ruga_clusters_apply(h, x, hx_again);
    ruga_clusters_apply_transpose(h, y, again);
    ruga_set_threads(0);
    assert_memory_equal(hx, hx_again, c * sizeof *y);
    assert_memory_equal(hty, again, n * sizeof *x);
    double left = 0, right = 0, size = 0;
    for (size_t i = 0; i < c; i++) {
        left += y[i] * hx[i];
        size += fabs(y[i] * hx[i]);
    }
    for (size_t i = 0; i < n; i++) {
        right += x[i] * hty[i];
    }
    assert_near(left, right, 1e-13 * size);
    free(x);
    free(hty);
    free(again);
    free(y);
    free(hx);
    free(hx_again);
}

static void products_are_transposes_and_the_same_for_any_threads(void** state) {
    (void)state;
    surface s;
    ruga_clusters h;
    make_surface(RUGA_SHAPE_SPHERE, 1, 0.03, &s);
    assert_ok(ruga_clusters_create(&s.mesh, &s.connectivity, 0.1, 0.1, 0, 1, &h));
    check_products(&h);
    ruga_clusters_clear(&h);
    assert_ok(ruga_clusters_create_spectral(&s.mesh, &s.connectivity, 12, &h));
    check_products(&h);
    ruga_clusters_clear(&h);
    clear_surface(&s);
}

static void a_constant_is_its_own_average(void** state) {
    (void)state;
    surface s;
    ruga_clusters h;
    make_two_spheres(1, 0.15, &s);
    assert_ok(ruga_clusters_create(&s.mesh, &s.connectivity, 0.2, 0.2, 0, 1, &h));
    double* x = malloc((size_t)h.vertex_count * 3 * sizeof *x);
    double* y = malloc((size_t)h.count * 3 * sizeof *y);
    for (int i = 0; i < 3 * h.vertex_count; i++) {
        x[i] = 1 + i % 3;
    }
    ruga_clusters_apply(&h, x, y);
    for (int i = 0; i < 3 * h.count; i++) {
        assert_near(y[i], 1 + i % 3, 1e-14);
    }
    free(x);
    free(y);
    ruga_clusters_clear(&h);
    clear_surface(&s);
}

static void the_same_seed_gives_the_same_clusters(void** state) {
    (void)state;
    surface s;
    ruga_clusters a, b, other;
    make_surface(RUGA_SHAPE_SPHERE, 1, 0.1, &s);
    assert_ok(ruga_clusters_create(&s.mesh, &s.connectivity, 0.2, 0.2, 0, 5, &a));
    assert_ok(ruga_clusters_create(&s.mesh, &s.connectivity, 0.2, 0.2, 0, 5, &b));
    assert_ok(ruga_clusters_create(&s.mesh, &s.connectivity, 0.2, 0.2, 0, 6, &other));
    assert_int_equal(a.count, b.count);
    assert_memory_equal(a.center, b.center, (size_t)a.count * sizeof *a.center);
    assert_memory_equal(a.weight, b.weight, (size_t)a.start[a.count] * sizeof *a.weight);
    assert_int_not_equal(a.center[0], other.center[0]);
    ruga_clusters_clear(&a);
    ruga_clusters_clear(&b);
    ruga_clusters_clear(&other);
    clear_surface(&s);
}

static void the_calibrated_rule_is_one_and_a_half_times_the_paper(void** state) {
    (void)state;
    double radius, sigma;
    ruga_clusters_rule(RUGA_RULE_PAPER, 0.1, &radius, &sigma);
    assert_near(sigma, 0.1 / RUGA_PI, 1e-16);
    assert_near(radius, sigma, 0);
    ruga_clusters_rule(RUGA_RULE_CALIBRATED, 0.1, &radius, &sigma);
    assert_near(sigma, 0.15 / RUGA_PI, 1e-16);
    assert_near(radius, sigma, 0);
}

// Eigenvalues by Rayleigh's quotient of phi = M^-1 h, after showing that L phi = lambda M phi and that the
// phi are M-orthogonal.
static void check_eigenpairs(const surface* s, const ruga_clusters* h, double* lambda) {
    int n = s->mesh.vertex_count;
    double* area = malloc((size_t)n * sizeof *area);
    double* weight = malloc((size_t)s->connectivity.edge_count * sizeof *weight);
    double* phi = calloc((size_t)n * (size_t)h->count, sizeof *phi);
    double* lphi = malloc((size_t)n * sizeof *lphi);
    ruga_mesh_vertex_areas(&s->mesh, area);
    assert_ok(ruga_laplacian_weights(&s->mesh, &s->connectivity, weight));
    double worst = 0, mixed = 0;
    for (int k = 0; k < h->count; k++) {
        double* p = phi + (size_t)n * (size_t)k;
        double length = 0, stiffness = 0, residual = 0, square = 0;
        for (int i = h->start[k]; i < h->start[k + 1]; i++) {
            square += h->weight[i] * h->weight[i];
            p[h->vertex[i]] = h->weight[i] / area[h->vertex[i]];
        }
        assert_near(square, 1, 1e-13);
        for (int v = 0; v < n; v++) {
            length += area[v] * p[v] * p[v];
        }
        memset(lphi, 0, (size_t)n * sizeof *lphi);
        for (int e = 0; e < s->connectivity.edge_count; e++) {
            int i = s->connectivity.edge[e][0], j = s->connectivity.edge[e][1];
            double f = weight[e] * (p[i] - p[j]);
            lphi[i] += f;
            lphi[j] -= f;
            stiffness += f * (p[i] - p[j]);
        }
        lambda[k] = stiffness / length;
        for (int v = 0; v < n; v++) {
            p[v] /= sqrt(length);
            double r =
                area[v] > 0 ? (lphi[v] / sqrt(length) - lambda[k] * area[v] * p[v]) / sqrt(area[v]) : 0;
            residual += r * r;
        }
        worst = sqrt(residual) > worst ? sqrt(residual) : worst;
        for (int j = 0; j < k; j++) {
            double dot = 0;
            for (int v = 0; v < n; v++) {
                dot += area[v] * p[v] * phi[(size_t)n * (size_t)j + (size_t)v];
            }
            mixed = fabs(dot) > mixed ? fabs(dot) : mixed;
        }
    }
    print_message("  worst residual %.1e of lambda %.3g, orthogonality %.1e\n", worst, lambda[h->count - 1],
                  mixed);
    assert_true(worst < 1e-9 * (1 + lambda[h->count - 1]));
    assert_true(mixed < 1e-10);
    free(area);
    free(weight);
    free(phi);
    free(lphi);
}

static void a_sphere_has_the_eigenvalues_of_spherical_harmonics(void** state) {
    (void)state;
    surface s;
    ruga_clusters h;
    double lambda[25];
    make_surface(RUGA_SHAPE_SPHERE, 1, 0.04, &s);
    assert_ok(ruga_clusters_create_spectral(&s.mesh, &s.connectivity, 25, &h));
    check_eigenpairs(&s, &h, lambda);
    double worst = 0;
    for (int l = 0, k = 0; l < 5; l++) {
        for (int m = 0; m < 2 * l + 1; m++, k++) {
            double wanted = l * (l + 1) / 0.25;
            worst = l && fabs(lambda[k] / wanted - 1) > worst ? fabs(lambda[k] / wanted - 1) : worst;
            assert_near(lambda[k], wanted, 0.03 * wanted + 1e-9);
        }
    }
    print_message("  worst of l(l+1)/R^2, l = 1 .. 4: %.2f %%\n", 100 * worst);
    ruga_clusters_clear(&h);
    clear_surface(&s);
}

static void copies_of_an_eigenvalue_are_not_missed(void** state) {
    (void)state;
    surface s;
    ruga_clusters h;
    double lambda[18];
    make_two_spheres(1, 0.1, &s);
    assert_ok(ruga_clusters_create_spectral(&s.mesh, &s.connectivity, 18, &h));
    check_eigenpairs(&s, &h, lambda);
    for (int k = 0; k < 18; k++) {
        int l = k < 2 ? 0 : k < 8 ? 1 : 2;
        assert_near(lambda[k], l * (l + 1) / 0.25, 0.1 * l * (l + 1) / 0.25 + 1e-9);
    }
    ruga_clusters_clear(&h);
    assert_status(ruga_clusters_create_spectral(&s.mesh, &s.connectivity, 1, &h), RUGA_BAD_INPUT);
    assert_status(ruga_clusters_create_spectral(&s.mesh, &s.connectivity, s.mesh.vertex_count, &h),
                  RUGA_BAD_INPUT);
    clear_surface(&s);
}

static void spectral_rows_are_the_same_bits_twice(void** state) {
    (void)state;
    surface s;
    ruga_clusters a, b;
    make_surface(RUGA_SHAPE_SHEET, 1, 0.07, &s);
    ruga_set_threads(1);
    assert_ok(ruga_clusters_create_spectral(&s.mesh, &s.connectivity, 20, &a));
    ruga_set_threads(2);
    assert_ok(ruga_clusters_create_spectral(&s.mesh, &s.connectivity, 20, &b));
    ruga_set_threads(0);
    assert_memory_equal(a.weight, b.weight, (size_t)a.start[20] * sizeof *a.weight);
    ruga_clusters_clear(&a);
    ruga_clusters_clear(&b);
    clear_surface(&s);
}

static void any_allocation_may_fail(void** state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        ruga_status status = RUGA_NO_MEMORY;
        for (int k = 0; status != RUGA_OK; k++) {
            surface s;
            ruga_clusters h;
            make_surface(RUGA_SHAPE_SPHERE, 1, 0.3, &s);
            size_t before = ruga_byte_count();
            let_allocations_fail_after(k);
            status = kind == 0 ? ruga_clusters_create(&s.mesh, &s.connectivity, 0.3, 0.3, 0, 1, &h)
                               : ruga_clusters_create_spectral(&s.mesh, &s.connectivity, 8, &h);
            assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
            assert_true(status == RUGA_OK || ruga_byte_count() == before);
            ruga_clusters_clear(&h);
            ruga_set_allocator(NULL, NULL, NULL);
            clear_surface(&s);
            assert_true(k < 1000);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_vertex_is_within_radius_of_a_centre),
        cmocka_unit_test(rows_are_truncated_gaussians_that_sum_to_one),
        cmocka_unit_test(a_count_is_met_exactly_and_its_centres_are_distinct),
        cmocka_unit_test(products_are_transposes_and_the_same_for_any_threads),
        cmocka_unit_test(a_constant_is_its_own_average),
        cmocka_unit_test(the_same_seed_gives_the_same_clusters),
        cmocka_unit_test(the_calibrated_rule_is_one_and_a_half_times_the_paper),
        cmocka_unit_test(a_sphere_has_the_eigenvalues_of_spherical_harmonics),
        cmocka_unit_test(copies_of_an_eigenvalue_are_not_missed),
        cmocka_unit_test(spectral_rows_are_the_same_bits_twice),
        cmocka_unit_test(any_allocation_may_fail),
    };
    return cmocka_run_group_tests_name("clusters", tests, NULL, check_no_leak);
}
