// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "ruga/ruga.h"
#include "tests/dense.h"
#include "tests/small_scene.h"

#include <lapacke.h>

static const double COMPRESSED = 2; // critical strains

// A start near wrinkles of the predicted wavelength: all methods then end in the same one of many minima.
static void ripple(const small_scene* s, double height, double* x) {
    double k = 2 * RUGA_PI / s->model->wavelength;
    for (int v = 0; v < s->mesh.vertex_count; v++) {
        x[3 * v + 2] += height * cos(k * s->mesh.position[3 * v]);
    }
}

static double largest_height(const small_scene* s, const double* x) {
    double largest = 0;
    for (int v = 0; v < s->mesh.vertex_count; v++) {
        largest = fmax(largest, fabs(x[3 * v + 2] - s->state->embedded[3 * v + 2]));
    }
    return largest;
}

// ---- energy --------------------------------------------------------------------------------------------

// A sheet with all that acts on a skin: foundation, gravity, pressure, a dead force and the proximal term.
static void scene_with_everything(small_scene* s) {
    scene_sheet(s, 3, 1.5, 5, COMPRESSED);
    s->def.gravity[1] = 3;
    s->def.gravity[2] = -9.81;
    s->handle[0].kind = RUGA_HANDLE_PRESS;
    s->handle[0].pressure = 2e3;
    s->handle[1].kind = RUGA_HANDLE_FORCE;
    s->handle[1].force[0] = 0.5;
    s->def.handle_count = 2;
    scene_build(s);
    s->state->skin->proximal = 0.3 * s->model->foundation_a;
    memcpy(s->state->anchor, s->state->x, (size_t)s->state->skin->n * sizeof(double));
    scene_disturb(s->state->skin->n, 1e-4, 5, s->state->anchor);
    scene_disturb(s->state->skin->n, 3e-4, 7, s->state->x);
}

static double energy_at(ruga_skin* skin, const double* x, double t, const double* d, double* gradient) {
    double* moved = scene_copy(skin->n, x);
    ruga_skin_terms terms;
    for (int i = 0; i < skin->n; i++) {
        moved[i] += t * d[i];
    }
    assert_ok(ruga_skin_energy(skin, moved, &terms, gradient));
    free(moved);
    return terms.total;
}

// error(t) = c t^2: a second error of a quarter, where round-off leaves room.
static void assert_second_order(double coarse, double fine, double scale) {
    if (!(fabs(coarse) > 1e-9 * scale && fabs(coarse / fine) > 3.5 && fabs(coarse / fine) < 4.5)) {
        print_error("errors %g and %g of %g\n", coarse, fine, scale);
        fail();
    }
}

static void gradient_is_the_centred_difference_of_the_energy_at_second_order(void** state) {
    (void)state;
    small_scene s;
    scene_with_everything(&s);
    ruga_skin* skin = s.state->skin;
    double *gradient = scene_array(skin->n), *d = scene_array(skin->n), error[2];
    scene_disturb(skin->n, 1, 11, d);
    energy_at(skin, s.state->x, 0, d, gradient);
    double slope = ruga_dot_product(skin->n, gradient, d);
    for (int k = 0; k < 2; k++) {
        double t = 4e-5 / (1 + k);
        double plus = energy_at(skin, s.state->x, t, d, NULL),
               minus = energy_at(skin, s.state->x, -t, d, NULL);
        error[k] = (plus - minus) / (2 * t) - slope;
    }
    assert_second_order(error[0], error[1], fabs(slope));
    assert_true(fabs(error[1]) < 0.05 * sqrt(ruga_dot_product(skin->n, gradient, gradient)));
    free(gradient);
    free(d);
    scene_free(&s);
}

static void stiffness_is_the_centred_difference_of_the_gradient_at_second_order(void** state) {
    (void)state;
    small_scene s;
    scene_with_everything(&s);
    ruga_skin* skin = s.state->skin;
    int n = skin->n;
    double *plus = scene_array(n), *minus = scene_array(n), *d = scene_array(n), *image = scene_array(n),
           error[2];
    scene_disturb(n, 1, 11, d);
    assert_ok(ruga_skin_assemble(skin, s.state->x, 0));
    ruga_skin_multiply(skin, d, image);
    double scale = sqrt(ruga_dot_product(n, image, image));
    for (int k = 0; k < 2; k++) {
        double t = 2e-5 / (1 + k);
        energy_at(skin, s.state->x, t, d, plus);
        energy_at(skin, s.state->x, -t, d, minus);
        error[k] = 0;
        for (int i = 0; i < n; i++) {
            double e = (plus[i] - minus[i]) / (2 * t) - image[i];
            error[k] += e * e;
        }
        error[k] = sqrt(error[k]);
    }
    assert_second_order(error[0], error[1], scale);
    assert_true(error[1] < 0.05 * scale);
    free(plus);
    free(minus);
    free(d);
    free(image);
    scene_free(&s);
}

// ---- constraints ---------------------------------------------------------------------------------------

static void restore_meets_the_constraints_with_the_least_move(void** state) {
    (void)state;
    small_scene s;
    scene_sheet(&s, 3, 1.5, 5, COMPRESSED);
    scene_build(&s);
    ruga_skin* skin = s.state->skin;
    assert_true(skin->m > 0);
    scene_disturb(skin->n, 1e-3, 3, s.state->x);
    double *before = scene_copy(skin->n, s.state->x), *left = scene_array(skin->n);
    assert_true(ruga_skin_constraint_residual(skin, s.state->x) > 1e-6);
    assert_ok(ruga_skin_restore(skin, s.state->x));
    assert_near(ruga_skin_constraint_residual(skin, s.state->x), 0, 1e-12);
    for (int i = 0; i < skin->n; i++) {
        before[i] = s.state->x[i] - before[i];
    }
    // The least move is in the range of H^T: its projection is nothing.
    assert_ok(ruga_skin_project(skin, before, left));
    assert_near(ruga_largest_move(skin->n, left), 0, 1e-9 * ruga_largest_move(skin->n, before));
    free(before);
    free(left);
    scene_free(&s);
}

static void projection_is_idempotent_and_orthogonal(void** state) {
    (void)state;
    small_scene s;
    scene_sheet(&s, 3, 1.5, 5, COMPRESSED);
    s.handle[0].region =
        (ruga_region){.kind = RUGA_REGION_PLANE, .center = {-s.length / 3, 0, 0}, .normal = {-1, 0, 0}};
    s.handle[0].axes[1] = false;
    s.def.handle_count = 1;
    scene_build(&s);
    ruga_skin* skin = s.state->skin;
    int n = skin->n, rows = skin->m;
    double *g = scene_array(n), *once = scene_array(n), *twice = scene_array(n), *h = scene_array(rows);
    scene_disturb(n, 1, 3, g);
    assert_true(s.model->any_skin_held);
    assert_ok(ruga_skin_project(skin, g, once));
    assert_ok(ruga_skin_project(skin, once, twice));
    assert_near(scene_distance(n, once, twice), 0, 1e-9);
    ruga_clusters_apply(&s.model->clusters, once, h);
    assert_near(ruga_largest_move(rows, h), 0, 1e-9);
    double square = ruga_dot_product(n, once, once);
    assert_true(square > 1 && square < ruga_dot_product(n, g, g));
    for (int i = 0; i < n; i++) {
        g[i] -= once[i];
        assert_true(s.model->skin_handle[i] < 0 || once[i] == 0);
    }
    assert_near(ruga_dot_product(n, g, once), 0, 1e-9 * square);
    free(g);
    free(once);
    free(twice);
    free(h);
    scene_free(&s);
}

static void constraints_hold_after_every_solve(void** state) {
    (void)state;
    for (int method = RUGA_METHOD_NEWTON; method <= RUGA_METHOD_QUASI_NEWTON; method++) {
        small_scene s;
        scene_sheet(&s, 3, 1.5, 6, 0);
        s.def.keyframe_count = 4;
        for (int k = 0; k < 4; k++) {
            s.key[k].matrix[0] = 1 - 0.02 * k;
        }
        s.def.solver.method = (ruga_method)method;
        scene_build(&s);
        for (int k = 1; k < 4; k++) {
            ruga_report report;
            assert_ok(ruga_state_step(s.model, s.state, &report));
            assert_near(report.constraint_residual, 0, 1e-9);
            assert_near(ruga_skin_constraint_residual(s.state->skin, s.state->x), 0, 1e-9);
            assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
            assert_true(report.residual_shell <= s.def.solver.tolerance);
        }
        assert_true(largest_height(&s, s.state->x) > 0.3 * s.def.skin.thickness);
        scene_free(&s);
    }
}

// Held with the interior: exactly where that is; held alone: exactly at the handle.
static void held_vertices_stay_exactly(void** state) {
    (void)state;
    small_scene s;
    scene_sheet(&s, 3, 1.5, 6, 0);
    s.key[1].matrix[0] = 0.95;
    s.def.keyframe_count = 2;
    s.handle[0].region =
        (ruga_region){.kind = RUGA_REGION_PLANE, .center = {-0.45 * s.length, 0, 0}, .normal = {-1, 0, 0}};
    s.handle[1] = s.handle[0];
    s.handle[1].region.center[0] *= -1;
    s.handle[1].region.normal[0] = 1;
    s.handle[1].kind = RUGA_HANDLE_MOVE;
    s.handle[1].hold = RUGA_HOLD_SKIN;
    s.handle[1].translate[0] = -0.025 * s.length;
    s.handle[1].translate[2] = 0.5e-3;
    s.handle[1].ramped = true;
    s.handle[1].during[1] = s.def.step;
    s.def.handle_count = 2;
    scene_build(&s);
    ruga_report report;
    assert_ok(ruga_state_step(s.model, s.state, &report));
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    int count[2] = {0, 0};
    for (int i = 0; i < s.state->skin->n; i++) {
        int h = s.model->skin_handle[i];
        double moved = h == 1 ? s.mesh.position[i] + s.handle[1].translate[i % 3] : s.state->embedded[i];
        if (h >= 0) {
            count[h]++;
            assert_true(s.state->x[i] == moved);
        }
    }
    assert_true(count[0] > 10 && count[1] > 10);
    assert_near(report.constraint_residual, 0, 2e-2); // rows whose vertices are all held cannot be met
    scene_free(&s);
}

// ---- minima --------------------------------------------------------------------------------------------

static void every_method_reaches_the_same_certified_minimum(void** state) {
    (void)state;
    const struct {
        ruga_method method;
        ruga_linear_kind linear;
    } variant[] = {{RUGA_METHOD_QUASI_NEWTON, RUGA_LINEAR_DIRECT},
                   {RUGA_METHOD_NEWTON, RUGA_LINEAR_DIRECT},
                   {RUGA_METHOD_NEWTON, RUGA_LINEAR_MINRES}};
    double energy[3];
    for (int k = 0; k < 3; k++) {
        small_scene s;
        ruga_skin_result result;
        scene_sheet(&s, 3, 1.5, 6, COMPRESSED);
        s.def.solver.method = variant[k].method;
        s.def.solver.linear = variant[k].linear;
        scene_build(&s);
        ripple(&s, 0.5e-3, s.state->x);
        assert_ok(ruga_skin_minimize(s.state->skin, s.state->x, 1e-6, true, &result));
        assert_int_equal(result.outcome, RUGA_OUTCOME_MINIMUM);
        assert_true(result.residual <= 1e-6);
        assert_true(s.state->skin->factor_right && s.state->skin->factor_exact);
        assert_true(largest_height(&s, s.state->x) > 0.5e-3);
        energy[k] = result.terms.total;
        scene_free(&s);
    }
    assert_near(energy[1], energy[0], 1e-6 * energy[0]);
    assert_near(energy[2], energy[0], 1e-6 * energy[0]);
}

static void a_flat_sheet_beyond_critical_is_never_called_a_minimum(void** state) {
    (void)state;
    for (int method = RUGA_METHOD_NEWTON; method <= RUGA_METHOD_PAPER; method++) {
        for (int clusters = 0; clusters < 2; clusters++) {
            small_scene s;
            ruga_skin_result result;
            // Without clusters the free ends slip, and half of the strain reaches the middle.
            scene_sheet(&s, 4, 1.5, 6, clusters ? COMPRESSED : 2 * COMPRESSED);
            s.def.coupling.kind = clusters ? RUGA_COUPLING_CLUSTERS : RUGA_COUPLING_NONE;
            s.def.solver.method = (ruga_method)method;
            scene_build(&s);
            assert_ok(ruga_skin_minimize(s.state->skin, s.state->x, 1e-5, true, &result));
            print_message("method %d, clusters %d: outcome %d, height %.2f h\n", method, clusters,
                          (int)result.outcome, largest_height(&s, s.state->x) / s.def.skin.thickness);
            bool flat = largest_height(&s, s.state->x) < 0.1e-3;
            assert_false(flat && result.outcome == RUGA_OUTCOME_MINIMUM);
            if (method != RUGA_METHOD_PAPER) {
                assert_int_equal(result.outcome, RUGA_OUTCOME_MINIMUM);
            }
            scene_free(&s);
        }
    }
}

// Eigenvalues [n - m], ascending, of the stiffness last assembled on the null space of H: with H^T = Q R,
// that of the last n - m columns of Q.
static double* projected_eigenvalues(const small_scene* s, int* count) {
    const ruga_skin* skin = s->state->skin;
    const ruga_clusters* c = &s->model->clusters;
    int n = skin->n, m = skin->m, free_count = n - m;
    size_t square = (size_t)n * (size_t)n;
    double *k = malloc(square * sizeof *k), *q = calloc(square, sizeof *q), *kz = malloc(square * sizeof *kz);
    double *zkz = malloc(square * sizeof *zkz), *tau = scene_array(n), *value = scene_array(free_count);
    assert_true(k && q && kz && zkz);
    for (int i = 0; i < n; i++) {
        double* unit = skin->trial;
        memset(unit, 0, (size_t)n * sizeof *unit);
        unit[i] = 1;
        ruga_skin_apply(skin, unit, k + (size_t)i * (size_t)n);
    }
    for (int r = 0; r < c->count; r++) {
        for (int p = c->start[r]; p < c->start[r + 1]; p++) {
            for (int axis = 0; axis < 3; axis++) {
                q[(size_t)(3 * r + axis) * (size_t)n + (size_t)(3 * c->vertex[p] + axis)] = c->weight[p];
            }
        }
    }
    assert_int_equal(LAPACKE_dgeqrf(LAPACK_COL_MAJOR, n, m, q, n, tau), 0);
    assert_int_equal(LAPACKE_dorgqr(LAPACK_COL_MAJOR, n, n, m, q, n, tau), 0);
    for (int j = 0; j < free_count; j++) {
        const double* z = q + (size_t)(m + j) * (size_t)n;
        for (int i = 0; i < n; i++) {
            kz[i] = ruga_dot_product(n, k + (size_t)i * (size_t)n, z);
        }
        for (int i = 0; i <= j; i++) {
            zkz[(size_t)j * (size_t)free_count + (size_t)i] =
                ruga_dot_product(n, q + (size_t)(m + i) * (size_t)n, kz);
        }
    }
    assert_int_equal(LAPACKE_dsyev(LAPACK_COL_MAJOR, 'N', 'U', free_count, zkz, free_count, value), 0);
    free(k);
    free(q);
    free(kz);
    free(zkz);
    free(tau);
    *count = free_count;
    return value;
}

static void count_negative_eigenvalues(ruga_bending bending) {
    small_scene s;
    int count, negative = 0;
    scene_sheet(&s, 2, 1, 6, COMPRESSED);
    s.def.skin.bending = bending;
    scene_build(&s);
    ruga_skin* skin = s.state->skin;
    assert_ok(ruga_skin_factor(skin, s.state->x, 0, 0));
    double* flat = projected_eigenvalues(&s, &count);
    while (negative < count && flat[negative] < 0) {
        negative++;
    }
    assert_true(negative > 0);
    assert_int_equal(skin->info.negative - skin->m, negative);
    assert_false(skin->factor_right);
    free(flat);

    ruga_skin_result result;
    assert_ok(ruga_skin_minimize(skin, s.state->x, 1e-7, true, &result));
    assert_int_equal(result.outcome, RUGA_OUTCOME_MINIMUM);
    assert_ok(ruga_skin_assemble(skin, s.state->x, 0));
    double* wrinkled = projected_eigenvalues(&s, &count);
    assert_true(wrinkled[0] > 0);
    print_message("flat: %d negative of %d; at the minimum the smallest is %.3g of the largest\n", negative,
                  count, wrinkled[0] / wrinkled[count - 1]);
    free(wrinkled);
    scene_free(&s);
}

static void inertia_counts_the_negative_eigenvalues_on_the_null_space(void** state) {
    (void)state;
    count_negative_eigenvalues(RUGA_BENDING_HINGE);
}

// Just above the critical strain few modes are unstable: the factor of the flat state shows a direction in which the
// energy falls. Where many are, and where none is below the bound asked for, it shows none.
static void a_factor_of_few_negative_modes_shows_a_direction(void** state) {
    (void)state;
    int shown = 0;
    for (int k = 0; k < 20; k++) {
        small_scene s;
        const double* along;
        scene_sheet(&s, 2, 1, 6, 0.8 + 0.03 * k);
        scene_build(&s);
        ruga_skin* skin = s.state->skin;
        assert_ok(ruga_skin_factor(skin, s.state->x, 0, 0));
        int modes = skin->info.negative - skin->m;
        if (modes > 0) {
            assert_ok(ruga_negative_curvature_of_factor(skin, 0, &along));
            assert_true((along != NULL) == (modes <= 4));
        }
        if (modes > 0 && along) {
            double *image = scene_array(skin->n), *before = scene_copy(skin->n, along), mass = 0;
            shown++;
            assert_near(ruga_largest_move(skin->n, along), 1, 1e-15);
            ruga_clusters_apply(&s.model->clusters, along, image);
            for (int r = 0; r < skin->m; r++) {
                assert_near(image[r], 0, 1e-13);
            }
            ruga_skin_multiply(skin, before, image);
            double curvature = ruga_dot_product(skin->n, before, image);
            for (int i = 0; i < skin->n; i++) {
                mass += s.model->vertex_area[i / 3] * before[i] * before[i];
            }
            assert_true(curvature < 0);
            assert_ok(ruga_negative_curvature_of_factor(skin, -0.99 * curvature / mass, &along));
            assert_non_null(along);
            assert_ok(ruga_negative_curvature_of_factor(skin, -1.01 * curvature / mass, &along));
            assert_null(along);
            free(image);
            free(before);
        }
        scene_free(&s);
    }
    print_message("%d flat states of few negative modes\n", shown);
    assert_true(shown > 0);
}

// The directors' rotations are in the factorised matrix and not among the unknowns.
static void inertia_is_that_without_the_rotations_of_directors(void** state) {
    (void)state;
    count_negative_eigenvalues(RUGA_BENDING_KIRCHHOFF_LOVE);
}

// Without and with clusters, by each method; what is solved for has no residual.
static void a_skin_of_directors_wrinkles_by_every_method(void** state) {
    (void)state;
    double energy[3];
    for (int k = 0; k < 3; k++) {
        small_scene s;
        ruga_skin_result result;
        scene_sheet(&s, 3, 1.5, 6, COMPRESSED);
        s.def.skin.bending = RUGA_BENDING_KIRCHHOFF_LOVE;
        s.def.solver.method = k == 0 ? RUGA_METHOD_QUASI_NEWTON : RUGA_METHOD_NEWTON;
        s.def.solver.linear = k == 2 ? RUGA_LINEAR_MINRES : RUGA_LINEAR_DIRECT;
        scene_build(&s);
        ripple(&s, 0.5e-3, s.state->x);
        assert_ok(ruga_skin_minimize(s.state->skin, s.state->x, 1e-6, true, &result));
        print_message("outcome %d residual %.3g\n", (int)result.outcome, result.residual);
        assert_int_equal(result.outcome, RUGA_OUTCOME_MINIMUM);
        assert_true(result.residual <= 1e-6);
        energy[k] = result.terms.total;
        print_message("energy %.8g J, %d factorisations, %d linear iterations\n", energy[k],
                      s.state->skin->work.factorizations, s.state->skin->work.linear_iterations);
        // K d = r without the rotations.
        ruga_skin* skin = s.state->skin;
        double *r = scene_array(skin->n), *d = scene_array(skin->n), *image = scene_array(skin->n);
        scene_disturb(skin->n, 1, 3, r);
        assert_ok(ruga_skin_factor(skin, s.state->x, 0, 0));
        assert_ok(ruga_skin_solve(skin, r, d));
        ruga_skin_multiply(skin, d, image);
        for (int i = 0; i < skin->n; i++) {
            image[i] -= r[i];
        }
        assert_ok(ruga_skin_project(skin, image, image));
        assert_near(sqrt(ruga_dot_product(skin->n, image, image) / ruga_dot_product(skin->n, r, r)), 0, 1e-8);
        free(r);
        free(d);
        free(image);
        scene_free(&s);
    }
    assert_near(energy[1], energy[0], 1e-6 * energy[0]);
    assert_near(energy[2], energy[0], 1e-6 * energy[0]);
}

static void no_tie_and_no_foundation_leave_the_skin_on_the_surface(void** state) {
    (void)state;
    small_scene s;
    scene_sheet(&s, 2, 1, 6, 0);
    s.key[1].matrix[0] = 0.9;
    s.key[1].translate[1] = 0.01;
    s.def.keyframe_count = 2;
    s.def.coupling.kind = RUGA_COUPLING_NONE;
    s.def.coupling.foundation = false;
    scene_build(&s);
    ruga_report report;
    assert_ok(ruga_state_step(s.model, s.state, &report));
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    assert_int_equal(report.factorizations, 0);
    assert_memory_equal(s.state->x, s.state->embedded, (size_t)s.state->skin->n * sizeof(double));
    assert_true(scene_distance(s.state->skin->n, s.state->x, s.mesh.position) > 0.009);
    scene_free(&s);
}

// Enough triangles for several chunks.
static void results_do_not_depend_on_threads(void** state) {
    (void)state;
    double* first = NULL;
    for (int threads = 1; threads <= 2; threads++) {
        small_scene s;
        scene_sheet(&s, 6, 3, 10, 0);
        for (int k = 0; k < 3; k++) {
            s.key[k].matrix[0] = 1 - 0.018 * k;
        }
        s.def.keyframe_count = 3;
        ruga_set_threads(threads);
        scene_build(&s);
        assert_true(s.mesh.triangle_count > 4096);
        for (int k = 0; k < 2; k++) {
            assert_ok(ruga_state_step(s.model, s.state, NULL));
        }
        assert_true(largest_height(&s, s.state->x) > 0.1e-3);
        int n = s.state->skin->n;
        if (first) {
            assert_memory_equal(first, s.state->x, (size_t)n * sizeof(double));
        } else {
            first = scene_copy(n, s.state->x);
        }
        scene_free(&s);
    }
    ruga_set_threads(0);
    free(first);
}

// ---- trouble -------------------------------------------------------------------------------------------

static ruga_status create_both(const ruga_model_def* def) {
    ruga_model* model = NULL;
    ruga_state* state = NULL;
    ruga_status status = ruga_model_create(def, &model);
    if (status == RUGA_OK) {
        status = ruga_state_create(model, &state);
    }
    assert_true((state != NULL) == (status == RUGA_OK));
    ruga_state_destroy(&state);
    ruga_model_destroy(&model);
    return status;
}

// Every third allocation from a start that changes with the scene: all of them take minutes in slow builds.
static void any_failed_allocation_is_a_status_and_leaks_nothing(void** state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        small_scene s;
        scene_sheet(&s, 1, 0.7, 4, 1);
        s.def.lattice.cells = 1;
        s.def.interior.motion = kind ? RUGA_INTERIOR_QUASISTATIC : RUGA_INTERIOR_PRESCRIBED;
        s.handle[0].region =
            (ruga_region){.kind = RUGA_REGION_PLANE, .center = {-s.length / 4, 0, 0}, .normal = {-1, 0, 0}};
        s.handle[1].kind = RUGA_HANDLE_PRESS;
        s.def.handle_count = kind ? 2 : 0;
        s.def.has_interior = kind < 2;
        size_t before = ruga_byte_count();
        ruga_status status = RUGA_NO_MEMORY;
        int k = kind;
        for (; status != RUGA_OK && k < 3000; k += k < 30 ? 1 : 3) {
            int allowed = k;
            ruga_set_allocator(scene_allocate_while_allowed, scene_release_block, &allowed);
            status = create_both(&s.def);
            ruga_set_allocator(NULL, NULL, NULL);
            assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
            assert_int_equal(ruga_byte_count(), before);
        }
        assert_int_equal(status, RUGA_OK);
        assert_true(k > 60);
        scene_free(&s);
    }
}

// Sums of several vectors against one at a time, for lengths about a piece and a chunk; the same bits on two threads.
static void sums_of_vectors_are_those_of_each(void** state) {
    (void)state;
    enum { COUNT = 5, LONGEST = 70001 };
    static const int length[] = {1, 511, 512, 513, 2048, 2049, 4100, LONGEST};
    double *data = malloc((COUNT + 3) * sizeof *data * LONGEST), product[2][COUNT], factor[COUNT];
    double *w = data + (ptrdiff_t)COUNT * LONGEST, *sum[2] = {w + LONGEST, w + 2 * LONGEST};
    const double* v[COUNT];
    ruga_random random = {3};
    for (int i = 0; i < (COUNT + 1) * LONGEST; i++) {
        data[i] = 2 * ruga_random_uniform(&random) - 1;
    }
    for (int k = 0; k < COUNT; k++) {
        v[k] = data + (ptrdiff_t)k * LONGEST;
        factor[k] = ruga_random_uniform(&random);
    }
    for (size_t c = 0; c < sizeof length / sizeof length[0]; c++) {
        int n = length[c];
        for (int threads = 1; threads <= 2; threads++) {
            ruga_set_threads(threads);
            ruga_dot_products(n, COUNT, v, w, product[threads - 1]);
            ruga_add_vectors(n, COUNT, v, factor, -2, w, sum[threads - 1]);
        }
        ruga_set_threads(0);
        assert_memory_equal(product[0], product[1], sizeof product[0]);
        assert_memory_equal(sum[0], sum[1], (size_t)n * sizeof *w);
        for (int k = 0; k < COUNT; k++) {
            double one = 0;
            for (int i = 0; i < n; i++) {
                one += v[k][i] * w[i];
            }
            assert_near(product[0][k], one, 1e-13 * n);
        }
        for (int i = 0; i < n; i++) {
            double one = w[i];
            for (int k = 0; k < COUNT; k++) {
                one += factor[k] * v[k][i];
            }
            assert_near(sum[0][i], -2 * one, 1e-14);
        }
    }
    free(data);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_of_vectors_are_those_of_each),
        cmocka_unit_test(gradient_is_the_centred_difference_of_the_energy_at_second_order),
        cmocka_unit_test(stiffness_is_the_centred_difference_of_the_gradient_at_second_order),
        cmocka_unit_test(restore_meets_the_constraints_with_the_least_move),
        cmocka_unit_test(projection_is_idempotent_and_orthogonal),
        cmocka_unit_test(constraints_hold_after_every_solve),
        cmocka_unit_test(held_vertices_stay_exactly),
        cmocka_unit_test(every_method_reaches_the_same_certified_minimum),
        cmocka_unit_test(a_flat_sheet_beyond_critical_is_never_called_a_minimum),
        cmocka_unit_test(inertia_counts_the_negative_eigenvalues_on_the_null_space),
        cmocka_unit_test(a_factor_of_few_negative_modes_shows_a_direction),
        cmocka_unit_test(inertia_is_that_without_the_rotations_of_directors),
        cmocka_unit_test(a_skin_of_directors_wrinkles_by_every_method),
        cmocka_unit_test(no_tie_and_no_foundation_leave_the_skin_on_the_surface),
        cmocka_unit_test(results_do_not_depend_on_threads),
        cmocka_unit_test(any_failed_allocation_is_a_status_and_leaks_nothing),
    };
    return cmocka_run_group_tests_name("solver", tests, NULL, check_no_leak);
}
