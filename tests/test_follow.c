// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "solver/follow.h"
#include "tests/scarce_memory.h"
#include "tests/small_scene.h"

#include <math.h>

// A surface that moves by a map of its rest shape, sample by sample.
typedef struct mover {
    const ruga_mesh* mesh;
    void (*map)(const double X[3], double s, double x[3]); // s = sample
    int asked;
    ruga_status trouble;
} mover;

static ruga_status read_sample(int sample, double* positions, void* context) {
    mover* m = context;
    m->asked++;
    for (size_t v = 0; v < (size_t)m->mesh->vertex_count; v++) {
        m->map(m->mesh->position + 3 * v, sample, positions + 3 * v);
    }
    return m->trouble;
}

static void turn_and_stretch(const double X[3], double s, double x[3]) {
    const double a = 1.2 * s, stretch[3] = {1 - 0.06 * s, 1 + 0.03 * s, 1 - 0.02 * s};
    const double y[3] = {stretch[0] * X[0] + 0.05 * s * X[1], stretch[1] * X[1], stretch[2] * X[2]};
    x[0] = cos(a) * y[0] - sin(a) * y[2] + 0.4 * s;
    x[1] = y[1] - 0.1 * s;
    x[2] = sin(a) * y[0] + cos(a) * y[2];
}

// Bent about the y axis, radius 1 / s.
static void bend(const double X[3], double s, double x[3]) {
    const double k = s == 0 ? 1e-9 : s, r = 1 / k - X[2];
    x[0] = r * sin(k * X[0]);
    x[1] = X[1];
    x[2] = 1 / k - r * cos(k * X[0]);
}

static const double times[3] = {0, 0.5, 2};

static void start(small_scene* s, ruga_shape shape, int degree, mover* m) {
    *s = (small_scene){.length = 0};
    scene_mesh(s, shape, 0.3, 0.12, shape == RUGA_SHAPE_SHEET ? 0 : 0.08, 0.012);
    s->def.interior.motion = RUGA_INTERIOR_PRESCRIBED;
    s->def.lattice.degree = degree;
    s->def.lattice.fill = shape == RUGA_SHAPE_SHEET ? RUGA_FILL_BOX : RUGA_FILL_MESH;
    s->def.coupling.kind = RUGA_COUPLING_NONE;
    s->def.coupling.foundation = false;
    m->mesh = &s->mesh;
    s->def.follow.sample_count = 3;
    s->def.follow.times = times;
    s->def.follow.read = read_sample;
    s->def.follow.context = m;
}

static double largest_distance(const small_scene* s, const double* q, const mover* m, double sample) {
    double largest = 0, *x = scene_array(3 * s->mesh.vertex_count);
    ruga_lattice_embed(&s->model->lattice, q, x);
    for (size_t v = 0; v < (size_t)s->mesh.vertex_count; v++) {
        double wanted[3];
        m->map(s->mesh.position + 3 * v, sample, wanted);
        largest = fmax(largest, ruga_distance(x + 3 * v, wanted));
    }
    free(x);
    return largest;
}

static void affine_motion_is_followed_exactly(void** state) {
    (void)state;
    static const ruga_shape shapes[] = {RUGA_SHAPE_SLAB, RUGA_SHAPE_SHEET, RUGA_SHAPE_PILLOW};
    for (int k = 0; k < 6; k++) {
        small_scene s;
        mover m = {.map = turn_and_stretch};
        start(&s, shapes[k / 2], 1 + k % 2, &m);
        assert_ok(ruga_model_create(&s.def, &s.model));
        const ruga_follow* follow = &s.model->follow;
        assert_int_equal(follow->count, 3);
        for (int sample = 0; sample < 3; sample++) {
            const double* q = follow->q + 3 * (size_t)sample * (size_t)follow->node_count;
            assert_true(largest_distance(&s, q, &m, sample) < 1e-8 * 0.3);
        }
        assert_true(follow->error < 1e-9);
        assert_true(follow->compression > 0.1 && follow->compression < 0.2);
        scene_free(&s);
    }
}

// Between samples nodes move on straight lines, and outside they rest.
static void samples_are_joined_linearly_and_held(void** state) {
    (void)state;
    small_scene s;
    mover m = {.map = turn_and_stretch};
    start(&s, RUGA_SHAPE_SLAB, 2, &m);
    assert_ok(ruga_model_create(&s.def, &s.model));
    const ruga_follow* follow = &s.model->follow;
    int n = 3 * follow->node_count;
    double *q = scene_array(n), *mean = scene_array(n);
    for (int i = 0; i < n; i++) {
        mean[i] = 0.5 * (follow->q[i + n] + follow->q[i + 2 * n]);
    }
    ruga_follow_at(follow, 1.25, q);
    assert_true(scene_distance(n, q, mean) < 1e-14);
    ruga_follow_at(follow, -1, q);
    assert_true(scene_distance(n, q, follow->q) == 0);
    ruga_follow_at(follow, 7, q);
    assert_true(scene_distance(n, q, follow->q + 2 * (size_t)n) == 0);
    free(q);
    free(mean);
    scene_free(&s);
}

// Quadratic splines on cells of h leave c h^3 of a smooth motion: half of h, an eighth.
static void bending_is_followed_to_the_third_order_of_the_cell(void** state) {
    (void)state;
    double error[2];
    for (int k = 0; k < 2; k++) {
        small_scene s;
        mover m = {.map = bend};
        start(&s, RUGA_SHAPE_SLAB, 2, &m);
        s.def.lattice.cells = 4 << k;
        s.def.follow.smoothness = 1e-8;
        assert_ok(ruga_model_create(&s.def, &s.model));
        const ruga_follow* follow = &s.model->follow;
        error[k] = largest_distance(&s, follow->q + 6 * (size_t)follow->node_count, &m, 2);
        scene_free(&s);
    }
    assert_true(error[0] < 1e-4 * 0.3);
    assert_true(error[0] / error[1] > 5.5);
}

static void default_smoothness_costs_little(void** state) {
    (void)state;
    small_scene s;
    mover m = {.map = bend};
    start(&s, RUGA_SHAPE_SLAB, 2, &m);
    assert_ok(ruga_model_create(&s.def, &s.model));
    assert_true(s.model->follow.error < 1e-3 * 0.3);
    scene_free(&s);
}

static void the_state_takes_the_fitted_poses(void** state) {
    (void)state;
    small_scene s;
    mover m = {.map = turn_and_stretch};
    start(&s, RUGA_SHAPE_SLAB, 2, &m);
    s.def.step = 0.5;
    assert_ok(ruga_model_create(&s.def, &s.model));
    assert_ok(ruga_state_create(s.model, &s.state));
    assert_true(largest_distance(&s, s.state->q, &m, 0) < 1e-8);
    assert_ok(ruga_state_step(s.model, s.state, NULL));
    assert_true(largest_distance(&s, s.state->q, &m, 1) < 1e-8);
    scene_free(&s);
}

static void shrink_to_nothing(const double X[3], double s, double x[3]) {
    for (int i = 0; i < 3; i++) {
        x[i] = s > 1 ? NAN : X[i];
    }
}

static void bad_motions_are_refused(void** state) {
    (void)state;
    static const double back[3] = {0, 1, 1};
    small_scene s;
    mover m = {.map = shrink_to_nothing};
    start(&s, RUGA_SHAPE_SLAB, 2, &m);
    assert_int_equal(ruga_model_create(&s.def, &s.model), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "sample 2"));
    m.map = bend;
    s.def.follow.times = back;
    assert_int_equal(ruga_model_create(&s.def, &s.model), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "time of sample 2"));
    s.def.follow.times = times;
    s.def.follow.smoothness = 0;
    assert_int_equal(ruga_model_create(&s.def, &s.model), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "smoothness"));
    s.def.follow.smoothness = 1e-4;
    m.trouble = RUGA_CANCELLED;
    assert_int_equal(ruga_model_create(&s.def, &s.model), RUGA_CANCELLED);
    m.trouble = RUGA_OK;
    s.def.keyframe_count = 1;
    assert_int_equal(ruga_model_create(&s.def, &s.model), RUGA_BAD_INPUT);
    ruga_mesh_clear(&s.mesh);
}

static void each_allocation_may_fail(void** state) {
    (void)state;
    small_scene s;
    mover m = {.map = bend};
    start(&s, RUGA_SHAPE_SLAB, 1, &m);
    assert_ok(ruga_model_create(&s.def, &s.model));
    const ruga_model* model = s.model;
    ruga_follow follow;
    int k = 0;
    for (ruga_status status = RUGA_NO_MEMORY; status != RUGA_OK; k++) {
        size_t before = ruga_byte_count();
        let_allocations_fail_after(k);
        status =
            ruga_follow_create(&model->lattice, &model->mesh, model->vertex_area, &s.def.follow, &follow);
        ruga_set_allocator(NULL, NULL, NULL);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        assert_true(status == RUGA_OK || ruga_byte_count() == before);
    }
    assert_true(k > 15);
    ruga_follow_clear(&follow);
    scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(affine_motion_is_followed_exactly),
        cmocka_unit_test(samples_are_joined_linearly_and_held),
        cmocka_unit_test(bending_is_followed_to_the_third_order_of_the_cell),
        cmocka_unit_test(default_smoothness_costs_little),
        cmocka_unit_test(the_state_takes_the_fitted_poses),
        cmocka_unit_test(bad_motions_are_refused),
        cmocka_unit_test(each_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
