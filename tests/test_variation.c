// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Skins that vary in space: shell, foundation, clusters, substeps and the model that puts them together.
#include "tests/check.h"

#include "core/memory.h"
#include "tests/small_scene.h"

typedef struct fixture {
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    double *thickness, *young, *growth; // [F], [F], [F][2]
    double* local;                      // [V], in [1, 2], linear along x
    ruga_shell* shell;
    int n; // 3 V
} fixture;

static const ruga_skin_def plain_skin = {
    .thickness = 1, .young = 100, .poisson = 0.3, .density = 2, .growth = {1, 1}};

// A sheet of 2 x 1 in z = 0; values on triangles are means of what `random` says at vertices.
static void set_up(fixture* f, double edge) {
    ruga_make_def make = {.shape = RUGA_SHAPE_SHEET, .size = {2, 1, 0}, .edge = edge};
    *f = (fixture){.n = 0};
    assert_ok(ruga_mesh_make(&make, &f->mesh));
    assert_ok(ruga_connectivity_create(&f->mesh, &f->connectivity));
    int vertices = f->mesh.vertex_count, triangles = f->mesh.triangle_count;
    f->n = 3 * vertices;
    f->local = scene_array(vertices);
    f->thickness = scene_array(triangles);
    f->young = scene_array(triangles);
    f->growth = scene_array(2 * triangles);
    double* random = scene_array(2 * vertices);
    for (int v = 0; v < vertices; v++) {
        f->local[v] = 1.5 + 0.5 * f->mesh.position[3 * v];
        random[2 * v] = random[2 * v + 1] = 1;
    }
    scene_disturb(2 * vertices, 0.4, 3, random);
    ruga_mesh_triangle_averages(&f->mesh, 2, random, f->growth);
    ruga_mesh_triangle_averages(&f->mesh, 1, f->local, f->thickness);
    ruga_mesh_triangle_averages(&f->mesh, 1, random, f->young);
    free(random);
}

static void tear_down(fixture* f) {
    ruga_shell_destroy(&f->shell);
    ruga_connectivity_clear(&f->connectivity);
    ruga_mesh_clear(&f->mesh);
    free(f->thickness);
    free(f->young);
    free(f->growth);
    free(f->local);
}

static void make_shell(fixture* f, bool thickness, bool young, bool growth) {
    ruga_shell_material material = {.skin = plain_skin,
                                    .thickness = thickness ? f->thickness : NULL,
                                    .young = young ? f->young : NULL,
                                    .growth = growth ? f->growth : NULL};
    ruga_shell_destroy(&f->shell);
    assert_ok(ruga_shell_create(&f->mesh, &f->connectivity, &material, &f->shell));
}

static double shell_energy(const fixture* f, const double* x, double* gradient) {
    ruga_shell_energies e;
    assert_ok(ruga_shell_energy(f->shell, x, 0, &e, gradient, NULL));
    return e.membrane + e.bending;
}

static double norm(int n, const double* x) {
    return sqrt(ruga_dot_product(n, x, x));
}

// ---- shell ---------------------------------------------------------------------------------------------

static void equal_corners_average_to_the_same_bits(void** state) {
    (void)state;
    fixture f;
    set_up(&f, 0.3);
    ruga_random random = {5};
    for (int trial = 0; trial < 1000; trial++) {
        double value = exp(40 * (ruga_random_uniform(&random) - 0.5));
        for (int v = 0; v < f.mesh.vertex_count; v++) {
            f.local[v] = value;
        }
        ruga_mesh_triangle_averages(&f.mesh, 1, f.local, f.thickness);
        for (int t = 0; t < f.mesh.triangle_count; t++) {
            assert_true(f.thickness[t] == value);
        }
    }
    tear_down(&f);
}

static void a_shell_of_equal_values_has_the_bits_of_a_uniform_one(void** state) {
    (void)state;
    fixture f;
    set_up(&f, 0.3);
    double *x = scene_copy(f.n, f.mesh.position), *g[2], *h[2], energy[2];
    scene_disturb(f.n, 0.05, 7, x);
    for (int t = 0; t < f.mesh.triangle_count; t++) {
        f.thickness[t] = plain_skin.thickness;
        f.young[t] = plain_skin.young;
        f.growth[2 * t] = f.growth[2 * t + 1] = 1;
    }
    int entries = 0;
    for (int k = 0; k < 2; k++) {
        make_shell(&f, k, k, k);
        entries = ruga_shell_pattern(f.shell)->start[f.n];
        g[k] = scene_array(f.n);
        h[k] = scene_array(entries);
        energy[k] = shell_energy(&f, x, NULL);
        assert_ok(ruga_shell_energy(f.shell, x, 0, NULL, g[k], h[k]));
    }
    assert_memory_equal(&energy[0], &energy[1], sizeof energy[0]);
    assert_memory_equal(g[0], g[1], (size_t)f.n * sizeof **g);
    assert_memory_equal(h[0], h[1], (size_t)entries * sizeof **h);
    for (int k = 0; k < 2; k++) {
        free(g[k]);
        free(h[k]);
    }
    free(x);
    tear_down(&f);
}

// Error of the centred difference along d, of the gradient and (as the largest entry) of the Hessian.
static void difference_errors(const fixture* f, const double* x, const double* d, double s, const double* g,
                              const double* hd, double* slope_error, double* change_error) {
    double *a = scene_copy(f->n, x), *b = scene_copy(f->n, x), *ga = scene_array(f->n),
           *gb = scene_array(f->n);
    for (int i = 0; i < f->n; i++) {
        a[i] -= s * d[i];
        b[i] += s * d[i];
    }
    *slope_error = (shell_energy(f, b, gb) - shell_energy(f, a, ga)) / (2 * s) - ruga_dot_product(f->n, g, d);
    for (int i = 0; i < f->n; i++) {
        gb[i] = (gb[i] - ga[i]) / (2 * s) - hd[i];
    }
    *change_error = norm(f->n, gb);
    free(a);
    free(b);
    free(ga);
    free(gb);
}

static void derivatives_of_a_varying_shell_agree_to_second_order(void** state) {
    (void)state;
    fixture f;
    set_up(&f, 0.4);
    make_shell(&f, true, true, true);
    double *x = scene_copy(f.n, f.mesh.position), *d = scene_array(f.n), *g = scene_array(f.n),
           *hd = scene_array(f.n);
    double* h = scene_array(ruga_shell_pattern(f.shell)->start[f.n]);
    scene_disturb(f.n, 0.08, 7, x);
    scene_disturb(f.n, 1, 8, d);
    assert_ok(ruga_shell_energy(f.shell, x, 0, NULL, g, h));
    ruga_sparse matrix = *ruga_shell_pattern(f.shell);
    matrix.value = h;
    ruga_sparse_multiply_symmetric(&matrix, d, hd);
    double slope[2], change[2];
    for (int k = 0; k < 2; k++) {
        difference_errors(&f, x, d, 2e-4 / (k + 1), g, hd, &slope[k], &change[k]);
    }
    assert_near(slope[0] / slope[1], 4, 0.1);
    assert_near(change[0] / change[1], 4, 0.1);
    assert_true(change[1] < 1e-4 * norm(f.n, hd));
    free(x);
    free(d);
    free(g);
    free(hd);
    free(h);
    tear_down(&f);
}

// Thickness linear along x: uniaxial strain e of a plate held across costs E h e^2 / (2 (1 - nu^2)) per area.
static void a_stretched_plate_of_linear_thickness_has_the_energy_of_its_mean(void** state) {
    (void)state;
    fixture f;
    set_up(&f, 0.2);
    make_shell(&f, true, false, false);
    double *x = scene_copy(f.n, f.mesh.position), *mass = scene_array(f.mesh.vertex_count), sum = 0;
    for (int i = 0; i < f.n; i += 3) {
        x[i] *= 1.02;
    }
    assert_near(shell_energy(&f, x, NULL), 2 * 1.5 * 100 * 0.02 * 0.02 / (2 * (1 - 0.09)), 1e-12);
    ruga_shell_vertex_mass(f.shell, mass);
    for (int v = 0; v < f.mesh.vertex_count; v++) {
        sum += mass[v];
    }
    assert_near(sum, 2 * 2 * 1.5, 1e-12);
    // A turn by a right angle about y and a shift change nothing.
    double before = shell_energy(&f, x, NULL);
    for (int i = 0; i < f.n; i += 3) {
        double z = -x[i];
        x[i] = x[i + 2] + 3;
        x[i + 2] = z;
    }
    assert_near(shell_energy(&f, x, NULL), before, 1e-12 * before);
    free(x);
    free(mass);
    tear_down(&f);
}

static void growth_that_varies_moves_the_rest_state(void** state) {
    (void)state;
    fixture f;
    set_up(&f, 0.2);
    // Lengths along x grow by 1 + x / 4: x -> x + x^2 / 8 is at rest but for the means over triangles.
    double *x = scene_copy(f.n, f.mesh.position), *u = scene_array(2 * f.mesh.vertex_count);
    for (int v = 0; v < f.mesh.vertex_count; v++) {
        u[2 * v] = 1 + x[3 * v] / 4;
        u[2 * v + 1] = 1;
    }
    ruga_mesh_triangle_averages(&f.mesh, 2, u, f.growth);
    make_shell(&f, false, false, true);
    double flat = shell_energy(&f, x, NULL);
    for (int v = 0; v < f.mesh.vertex_count; v++) {
        x[3 * v] += x[3 * v] * x[3 * v] / 8;
    }
    assert_true(shell_energy(&f, x, NULL) < 0.01 * flat);
    free(x);
    free(u);
    tear_down(&f);
}

// ---- foundation ----------------------------------------------------------------------------------------

static void a_varying_foundation_is_a_symmetric_quadratic_form(void** state) {
    (void)state;
    fixture f;
    ruga_foundation w;
    set_up(&f, 0.15);
    double *a = scene_array(f.mesh.vertex_count), *b = scene_array(f.mesh.vertex_count);
    for (int v = 0; v < f.mesh.vertex_count; v++) {
        a[v] = 3 / f.local[v];
        b[v] = 0.02 * f.local[v];
    }
    assert_ok(ruga_foundation_create_local(&f.mesh, &f.connectivity, a, b, &w));
    ruga_sparse matrix;
    int* slot = NULL;
    assert_ok(ruga_sparse_from_pairs(f.mesh.vertex_count, 3, f.connectivity.edge_count,
                                     (const int(*)[2])f.connectivity.edge, &matrix));
    assert_ok(ruga_foundation_map(&w, &matrix, &slot));
    ruga_foundation_add_hessian(&w, slot, matrix.value);
    double *d = scene_array(f.n), *g = scene_array(f.n), *wd = scene_array(f.n);
    scene_disturb(f.n, 0.5, 9, d);
    double energy = ruga_foundation_energy(&w, d, g, NULL);
    ruga_sparse_multiply_symmetric(&matrix, d, wd);
    assert_true(scene_distance(f.n, g, wd) < 1e-14);
    assert_near(energy, ruga_dot_product(f.n, d, g) / 2, 1e-13 * energy);
    // Quadratic: a centred difference is exact but for round-off, at any step.
    for (int i = 0; i < f.n; i += 5) {
        double old = d[i];
        d[i] = old + 0.1;
        double up = ruga_foundation_energy(&w, d, NULL, NULL);
        d[i] = old - 0.1;
        double down = ruga_foundation_energy(&w, d, NULL, NULL);
        d[i] = old;
        assert_near((up - down) / 0.2, g[i], 1e-12);
    }
    free(a);
    free(b);
    free(d);
    free(g);
    free(wd);
    ruga_release(slot);
    ruga_sparse_clear(&matrix);
    ruga_foundation_clear(&w);
    tear_down(&f);
}

// b linear along x and d = (0, 0, x): 1/2 int b = 1/2 b(mean) area, exactly; with equal values that of one
// value.
static void a_varying_foundation_has_the_energy_of_its_integral(void** state) {
    (void)state;
    fixture f;
    ruga_foundation w, one;
    set_up(&f, 0.1);
    double *zero = scene_array(f.mesh.vertex_count), *d = scene_array(f.n);
    for (int v = 0; v < f.mesh.vertex_count; v++) {
        d[3 * v + 2] = f.mesh.position[3 * v];
    }
    assert_ok(ruga_foundation_create_local(&f.mesh, &f.connectivity, zero, f.local, &w));
    assert_near(ruga_foundation_energy(&w, d, NULL, NULL), 0.5 * 1.5 * 2, 1e-12);
    ruga_foundation_clear(&w);
    for (int v = 0; v < f.mesh.vertex_count; v++) {
        f.local[v] = 0.7;
    }
    assert_ok(ruga_foundation_create_local(&f.mesh, &f.connectivity, f.local, f.local, &w));
    assert_ok(ruga_foundation_create(&f.mesh, &f.connectivity, 0.7, 0.7, &one));
    scene_disturb(f.n, 0.5, 9, d);
    double energy = ruga_foundation_energy(&one, d, NULL, NULL);
    assert_near(ruga_foundation_energy(&w, d, NULL, NULL), energy, 1e-14 * energy);
    free(zero);
    free(d);
    ruga_foundation_clear(&one);
    ruga_foundation_clear(&w);
    tear_down(&f);
}

static void obtuse_triangles_leave_a_varying_foundation_positive(void** state) {
    (void)state;
    const double position[] = {-1, 0, 0, 1, 0, 0, 0, 0.2, 0, 0, -0.2, 0};
    const int triangle[] = {0, 1, 2, 1, 0, 3};
    const double zero[4] = {0}, b[4] = {1, 1, 0.01, 20};
    ruga_mesh_def def = {
        .vertex_count = 4, .positions = position, .triangle_count = 2, .triangles = triangle};
    ruga_mesh mesh;
    ruga_connectivity c;
    ruga_foundation w;
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    assert_ok(ruga_connectivity_create(&mesh, &c));
    assert_ok(ruga_foundation_create_local(&mesh, &c, zero, b, &w));
    ruga_random random = {4};
    for (int trial = 0; trial < 100; trial++) {
        double d[12];
        for (int i = 0; i < 12; i++) {
            d[i] = ruga_random_uniform(&random) - 0.5;
        }
        assert_true(ruga_foundation_energy(&w, d, NULL, NULL) >= 0);
    }
    ruga_foundation_clear(&w);
    ruga_connectivity_clear(&c);
    ruga_mesh_clear(&mesh);
}

// ---- clusters ------------------------------------------------------------------------------------------

// Path lengths from a vertex by sweeping all edges until nothing changes; scale NULL: in metres.
static void path_lengths(const fixture* f, const double* scale, int from, double* distance) {
    for (int v = 0; v < f->mesh.vertex_count; v++) {
        distance[v] = v == from ? 0 : INFINITY;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (int e = 0; e < 2 * f->connectivity.edge_count; e++) {
            int i = f->connectivity.edge[e / 2][e % 2], j = f->connectivity.edge[e / 2][1 - e % 2];
            double d = ruga_distance(f->mesh.position + 3 * i, f->mesh.position + 3 * j);
            d /= scale ? 0.5 * (scale[i] + scale[j]) : 1;
            if (distance[i] + d < distance[j]) {
                distance[j] = distance[i] + d;
                changed = true;
            }
        }
    }
}

static void clusters_are_as_dense_and_wide_as_the_local_wavelength(void** state) {
    (void)state;
    fixture f;
    ruga_clusters h;
    const double radius = 0.1, sigma = 0.09;
    set_up(&f, 0.03);
    assert_ok(ruga_clusters_create_local(&f.mesh, &f.connectivity, radius, sigma, f.local, 0, 1, &h));
    int vertices = f.mesh.vertex_count, count[2] = {0, 0};
    double *nearest = scene_array(vertices), *d = scene_array(vertices);
    for (int v = 0; v < vertices; v++) {
        nearest[v] = INFINITY;
    }
    for (int k = 0; k < h.count; k++) {
        int center = h.center[k];
        double sum = 0, reach = 2 * sigma * f.local[center], middle = 0;
        path_lengths(&f, f.local, center, d);
        for (int v = 0; v < vertices; v++) {
            nearest[v] = fmin(nearest[v], d[v]);
        }
        path_lengths(&f, NULL, center, d);
        for (int i = h.start[k]; i < h.start[k + 1]; i++) {
            sum += h.weight[i];
            middle = h.vertex[i] == center ? h.weight[i] : middle;
            assert_true(d[h.vertex[i]] < reach);
        }
        for (int i = h.start[k]; i < h.start[k + 1]; i++) {
            double t = d[h.vertex[i]] / (sigma * f.local[center]);
            assert_near(h.weight[i], middle * exp(-0.5 * t * t), 1e-12);
        }
        assert_near(sum, 1, 1e-12);
        double x = f.mesh.position[3 * center];
        count[0] += x < -0.5;
        count[1] += x > 0.5;
    }
    for (int v = 0; v < vertices; v++) {
        assert_true(nearest[v] <= radius);
    }
    // Mean scales of 1.125 and 1.875 in the outer quarters: (1.875 / 1.125)^2 = 2.8 times as many.
    print_message("centres in the outer quarters: %d and %d\n", count[0], count[1]);
    assert_true(count[0] > 1.8 * count[1]);
    free(nearest);
    free(d);
    ruga_clusters_clear(&h);
    tear_down(&f);
}

// ---- the model -----------------------------------------------------------------------------------------

static void set_arrays(small_scene* s, double* thickness, double* young, double* growth) {
    s->def.skin.vertex_count = s->mesh.vertex_count;
    s->def.skin.vertex_thickness = thickness;
    s->def.skin.vertex_young = young;
    s->def.skin.vertex_growth = growth;
}

static void equal_values_give_the_bits_of_a_uniform_skin(void** state) {
    (void)state;
    small_scene s[2];
    double* arrays[3] = {NULL};
    for (int k = 0; k < 2; k++) {
        scene_sheet(&s[k], 3, 2, 6, 0);
        s[k].key[1].matrix[0] = 1 - 1.3 * 0.25 * pow(0.03, 2.0 / 3);
        int vertices = s[k].mesh.vertex_count;
        if (k == 1) {
            for (int i = 0; i < 3; i++) {
                arrays[i] = scene_array(2 * vertices);
            }
            for (int v = 0; v < vertices; v++) {
                arrays[0][v] = s[k].def.skin.thickness;
                arrays[1][v] = s[k].def.skin.young;
                arrays[2][2 * v] = arrays[2][2 * v + 1] = 1;
            }
            s[k].def.skin.thickness = s[k].def.skin.young = -1; // not used
            set_arrays(&s[k], arrays[0], arrays[1], arrays[2]);
        }
        scene_build(&s[k]);
        assert_ok(ruga_state_step(s[k].model, s[k].state, NULL));
    }
    assert_true(s[0].model->wavelength == s[1].model->wavelength && s[0].model->edges == s[1].model->edges);
    assert_memory_equal(s[0].state->x, s[1].state->x, (size_t)s[0].state->skin->n * sizeof(double));
    for (int k = 0; k < 2; k++) {
        scene_free(&s[k]);
    }
    for (int i = 0; i < 3; i++) {
        free(arrays[i]);
    }
}

static void a_model_knows_its_local_wavelengths(void** state) {
    (void)state;
    small_scene s;
    scene_sheet(&s, 4, 2, 8, 0);
    int vertices = s.mesh.vertex_count;
    double *thickness = scene_array(vertices), *young = scene_array(vertices);
    double lambda = 2 * RUGA_PI * 1e-3 * cbrt(100.0 / 3), critical = 0.25 * pow(0.03, 2.0 / 3);
    for (int v = 0; v < vertices; v++) {
        thickness[v] = s.mesh.position[3 * v] < 0 ? 1e-3 : 2e-3;
        young[v] = s.mesh.position[3 * v + 1] < 0 ? 1e7 : 8e7;
    }
    set_arrays(&s, thickness, young, NULL);
    scene_build(&s);
    const ruga_model* m = s.model;
    assert_near(m->wavelength_min, lambda, 1e-12 * lambda);
    assert_near(m->wavelength_max, 4 * lambda, 1e-12 * lambda);
    assert_near(m->critical_strain, critical / 4, 1e-12);
    assert_near(m->critical_strain_max, critical, 1e-12);
    assert_true(m->wavelength > m->wavelength_min && m->wavelength < m->wavelength_max);
    assert_true(m->edges < 8.5 && m->edges > 6);
    assert_near(m->edges_wavelength, lambda, 1e-12 * lambda);
    for (int v = 0; v < vertices; v++) {
        double wanted = lambda * thickness[v] / 1e-3 * cbrt(young[v] / 1e7);
        assert_near(m->variation.wavelength[v], wanted, 1e-12 * lambda);
    }
    free(thickness);
    free(young);
    scene_free(&s);
}

// 1.2 of the softer half's critical strain is 4.8 of the stiffer one's: the step is split for that half.
static void a_step_is_split_by_the_local_critical_strain(void** state) {
    (void)state;
    int parts[2];
    for (int k = 0; k < 2; k++) {
        small_scene s;
        ruga_report report;
        scene_sheet(&s, 4, 2, 6, 0);
        double* young = scene_array(s.mesh.vertex_count);
        for (int v = 0; v < s.mesh.vertex_count; v++) {
            young[v] = k && s.mesh.position[3 * v] > 0 ? 8e7 : 1e7;
        }
        set_arrays(&s, NULL, young, NULL);
        s.key[1].matrix[0] = 1 - 1.2 * 0.25 * pow(0.03, 2.0 / 3);
        scene_build(&s);
        assert_ok(ruga_state_step(s.model, s.state, &report));
        parts[k] = report.substeps;
        free(young);
        scene_free(&s);
    }
    assert_true(parts[1] > 2 * parts[0]);
}

static void assert_refused(small_scene* s, const char* fragment) {
    assert_status(ruga_model_create(&s->def, &s->model), RUGA_BAD_INPUT);
    if (!strstr(ruga_last_error(), fragment)) {
        print_error("'%s' is not in: %s\n", fragment, ruga_last_error());
        fail();
    }
}

static void bad_arrays_are_refused_with_the_vertex(void** state) {
    (void)state;
    small_scene s;
    scene_sheet(&s, 2, 2, 6, 0);
    double* values = scene_array(2 * s.mesh.vertex_count);
    for (int v = 0; v < 2 * s.mesh.vertex_count; v++) {
        values[v] = 1e-3;
    }
    set_arrays(&s, values, NULL, NULL);
    s.def.skin.vertex_count--;
    assert_refused(&s, "skin.vertex_count is ");
    s.def.skin.vertex_count++;
    values[5] = -1e-3;
    assert_refused(&s, "skin.vertex_thickness is -0.001 at vertex 5 (");
    values[5] = NAN;
    assert_refused(&s, "skin.vertex_thickness is nan at vertex 5 (");
    set_arrays(&s, NULL, values, NULL);
    assert_refused(&s, "skin.vertex_young is nan at vertex 5 (");
    set_arrays(&s, NULL, NULL, values);
    values[5] = 0;
    assert_refused(&s, "skin.vertex_growth is 0 at vertex 2 (");
    free(values);
    ruga_mesh_clear(&s.mesh);
}

static void any_allocation_of_a_varying_model_may_fail(void** state) {
    (void)state;
    small_scene s;
    scene_sheet(&s, 1.5, 1, 4, 0);
    double* values = scene_array(2 * s.mesh.vertex_count);
    for (int v = 0; v < 2 * s.mesh.vertex_count; v++) {
        values[v] = 1e-3 * (1 + 1e-3 * v);
    }
    set_arrays(&s, values, NULL, values);
    ruga_status status = RUGA_NO_MEMORY;
    size_t before = ruga_byte_count();
    for (int k = 0; status != RUGA_OK; k++) {
        int allowed = k;
        ruga_set_allocator(scene_allocate_while_allowed, scene_release_block, &allowed);
        status = ruga_model_create(&s.def, &s.model);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        ruga_model_destroy(&s.model);
        assert_true(ruga_byte_count() == before);
        ruga_set_allocator(NULL, NULL, NULL);
    }
    free(values);
    ruga_mesh_clear(&s.mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_corners_average_to_the_same_bits),
        cmocka_unit_test(a_shell_of_equal_values_has_the_bits_of_a_uniform_one),
        cmocka_unit_test(derivatives_of_a_varying_shell_agree_to_second_order),
        cmocka_unit_test(a_stretched_plate_of_linear_thickness_has_the_energy_of_its_mean),
        cmocka_unit_test(growth_that_varies_moves_the_rest_state),
        cmocka_unit_test(a_varying_foundation_is_a_symmetric_quadratic_form),
        cmocka_unit_test(a_varying_foundation_has_the_energy_of_its_integral),
        cmocka_unit_test(obtuse_triangles_leave_a_varying_foundation_positive),
        cmocka_unit_test(clusters_are_as_dense_and_wide_as_the_local_wavelength),
        cmocka_unit_test(equal_values_give_the_bits_of_a_uniform_skin),
        cmocka_unit_test(a_model_knows_its_local_wavelengths),
        cmocka_unit_test(a_step_is_split_by_the_local_critical_strain),
        cmocka_unit_test(bad_arrays_are_refused_with_the_vertex),
        cmocka_unit_test(any_allocation_of_a_varying_model_may_fail),
    };
    return cmocka_run_group_tests_name("variation", tests, NULL, check_no_leak);
}
