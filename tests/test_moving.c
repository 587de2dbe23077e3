// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Free skins in dynamic motion as a model's: handles, loads, creases with their laws, starts and restarts.
#include "tests/check.h"
#include "tests/scarce_memory.h"
#include "tests/small_scene.h"

#include "ruga/ruga.h"

typedef struct moving_scene {
    small_scene s;
    ruga_crease_def crease[2];
    double point[2][2][3];
} moving_scene;

// A sheet of 0.4 m x 0.3 m with a crease across it, or two that cross.
static void make_scene(int creases, moving_scene* m) {
    static const double lines[2][2][3] = {{{0.013, -1, 0}, {-0.021, 1, 0}}, {{-1, 0.02, 0}, {1, -0.011, 0}}};
    *m = (moving_scene){.s = {.length = 0}};
    scene_mesh(&m->s, RUGA_SHAPE_SHEET, 0.4, 0.3, 0, 0.04);
    memcpy(m->point, lines, sizeof lines);
    for (int k = 0; k < 2; k++) {
        m->crease[k] = ruga_default_crease_def();
        m->crease[k].point_count = 2;
        m->crease[k].points = m->point[k][0];
        m->crease[k].stiffness = 0.01;
    }
    m->s.def.has_interior = false;
    m->s.def.skin.motion = RUGA_SKIN_DYNAMIC;
    m->s.def.skin.thickness = 1e-3;
    m->s.def.skin.young = 1e5;
    m->s.def.skin.density = 300;
    m->s.def.step = 0.02;
    m->s.def.crease_count = creases;
    m->s.def.creases = m->crease;
}

static void hold_left(moving_scene* m) {
    m->s.handle[0].region =
        (ruga_region){.kind = RUGA_REGION_BOX, .min = {-1, -1, -1}, .max = {-0.199, 1, 1}};
    m->s.def.handle_count = 1;
}

static void build(moving_scene* m) {
    scene_build(&m->s);
}

static void step(moving_scene* m, int frames) {
    ruga_report report;
    for (int k = 0; k < frames; k++) {
        assert_ok(ruga_state_step(m->s.model, m->s.state, &report));
        assert_int_equal(report.outcome, RUGA_OUTCOME_MOTION);
        assert_true(report.substeps >= 1);
    }
    assert_true(ruga_state_gap(m->s.state) < 1e-12 * m->s.model->mean_edge);
}

static void refuse(moving_scene* m, const char* words) {
    ruga_model* model = NULL;
    assert_status(ruga_model_create(&m->s.def, &model), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), words));
}

static void what_does_not_go_together_is_refused(void** state) {
    (void)state;
    moving_scene m;
    make_scene(1, &m);
    m.s.def.has_interior = true;
    refuse(&m, "motion: dynamic needs interior: none");
    m.s.def.has_interior = false;
    m.s.def.skin.density = 0;
    refuse(&m, "skin.density");
    m.s.def.skin.density = 300;
    m.s.def.skin.growth[0] = 1.1;
    refuse(&m, "no growth");
    m.s.def.skin.growth[0] = 1;
    m.s.def.skin.damping = -1;
    refuse(&m, "skin.damping");
    m.s.def.skin.damping = 0;
    m.s.def.start.cone = 7;
    refuse(&m, "start.cone");
    m.s.def.start.cone = 0;
    m.s.def.skin.motion = RUGA_SKIN_STATIC;
    m.s.def.start.cone = 1;
    refuse(&m, "start: cone, velocity and spin need");
    m.s.def.start.cone = 0;
    m.s.def.start.fold = NAN;
    refuse(&m, "start.fold is nan");
    m.s.def.start.fold = 1;
    m.s.def.has_interior = true;
    refuse(&m, "start.fold: needs interior: none");
    m.s.def.has_interior = false;
    m.s.def.crease_count = 0;
    refuse(&m, "start.fold: there are no creases");
    m.s.def.crease_count = 1;
    m.s.def.start.fold = 0;
    m.s.def.skin.model = RUGA_SKIN_SPRINGS;
    refuse(&m, "springs needs");
    m.s.def.skin.model = RUGA_SKIN_SHELL;
    m.s.def.skin.creases = RUGA_CREASE_PAIRS;
    refuse(&m, "skin.creases");
    scene_free(&m.s);
}

// With creases and without; nothing holds it, and nothing but weight and drive acts.
static void a_thrown_sheet_falls_as_a_whole(void** state) {
    (void)state;
    for (int creases = 0; creases < 3; creases++) {
        moving_scene m;
        make_scene(creases, &m);
        m.s.def.skin.model = creases == 1 ? RUGA_SKIN_SPRINGS : RUGA_SKIN_SHELL;
        m.s.def.gravity[2] = -9.81;
        m.s.def.start.velocity[0] = 2;
        m.crease[0].rest = 1; // folds as it flies
        build(&m);
        double before[3] = {0, 0, 0}, after[3] = {0, 0, 0}, mass = 0;
        int nodes = m.s.model->mesh.vertex_count;
        double* own = malloc((size_t)nodes * sizeof *own);
        for (int n = 0; n < nodes; n++) {
            own[n] = m.s.model->creases ? m.s.model->creases->area[n] : m.s.model->vertex_area[n];
            mass += own[n];
            ruga_add_scaled(own[n], m.s.state->x + 3 * (size_t)n, before);
        }
        step(&m, 5);
        for (int n = 0; n < nodes; n++) {
            ruga_add_scaled(own[n], m.s.state->x + 3 * (size_t)n, after);
        }
        const double time = 0.1, wanted[3] = {2 * time, 0, -0.5 * 9.81 * time * time};
        for (int i = 0; i < 3; i++) { // masses of explicit steps have another middle within cut triangles
            assert_near((after[i] - before[i]) / mass, wanted[i], creases ? 2e-3 : 1e-12);
        }
        free(own);
        scene_free(&m.s);
    }
}

static void a_restart_changes_no_bit(void** state) {
    (void)state;
    for (int creases = 0; creases < 3; creases++) {
        double* first = NULL;
        for (int run = 0; run < 2; run++) {
            moving_scene m;
            make_scene(creases, &m);
            hold_left(&m);
            m.s.def.gravity[2] = -9.81;
            m.s.def.skin.damping = 1e-3;
            m.s.def.skin.drag = 0.5;
            m.crease[0].yield = 0.05;
            m.crease[0].rate = 20;
            m.crease[1].start = 0.07;
            m.crease[1].rest = 1.5;
            build(&m);
            step(&m, 4);
            if (run == 1) {
                double* restart = malloc((size_t)ruga_state_restart_size(m.s.model) * sizeof *restart);
                ruga_state_save(m.s.state, restart);
                ruga_state_destroy(&m.s.state);
                assert_ok(ruga_state_create(m.s.model, &m.s.state));
                assert_ok(ruga_state_load(m.s.state, restart));
                free(restart);
            }
            step(&m, 3);
            size_t size = 3 * (size_t)m.s.model->mesh.vertex_count * sizeof *first;
            if (run == 0) {
                first = malloc(size);
                memcpy(first, m.s.state->x, size);
            } else {
                assert_memory_equal(first, m.s.state->x, size);
            }
            scene_free(&m.s);
        }
        free(first);
    }
}

// Folded flat panels are at rest where rest angles are the same, at any angle; angles are told apart by sign.
// So they are with the springs of the 2015 paper.
static void a_folded_start_is_at_rest(void** state) {
    (void)state;
    const double rest[5] = {1.1, -RUGA_PI, RUGA_PI, 1.1, -2};
    for (int k = 0; k < 5; k++) {
        moving_scene m;
        make_scene(1, &m);
        m.s.def.skin.creases = k < 3 ? RUGA_CREASE_ANGLE : k == 3 ? RUGA_CREASE_PAIRS : RUGA_CREASE_ACROSS;
        m.crease[0].rest = rest[k];
        m.s.def.start.fold = 1;
        build(&m);
        ruga_report report;
        assert_ok(ruga_state_measure(m.s.state, &report));
        assert_near(report.energy_membrane + report.energy_bending + report.energy_hinge, 0, 1e-20);
        assert_near(ruga_state_crease_angles(m.s.state)[0], rest[k], 1e-12);
        double* before = malloc(3 * (size_t)m.s.model->mesh.vertex_count * sizeof *before);
        memcpy(before, m.s.state->x, 3 * (size_t)m.s.model->mesh.vertex_count * sizeof *before);
        step(&m, 2);
        for (int i = 0; i < 3 * m.s.model->mesh.vertex_count; i++) {
            assert_near(m.s.state->x[i], before[i], 1e-9);
        }
        assert_near(ruga_state_crease_angles(m.s.state)[0], rest[k], 1e-9);
        free(before);
        scene_free(&m.s);
    }
}

// A ring with `pleats` pleats, each a valley and a mountain within columns of quads, which folds flat and
// rolls.
static void make_pleats(int pleats, moving_scene* m, ruga_crease_def* crease, double (*point)[2][3]) {
    const int columns = 6 * pleats;
    const ruga_make_def ring = {.shape = RUGA_SHAPE_SKIRT,
                                .size = {0.2, 0.5, 2 * RUGA_PI},
                                .cells = {columns, 6},
                                .pattern = RUGA_PATTERN_DIAGONAL};
    make_scene(0, m);
    ruga_mesh_clear(&m->s.mesh);
    assert_ok(ruga_mesh_make(&ring, &m->s.mesh));
    m->s.def.mesh = ruga_mesh_as_def(&m->s.mesh);
    for (int k = 0; k < 2 * pleats; k++) {
        double phi = 2 * RUGA_PI * (6 * (k / 2) + (k % 2 ? 4.4 : 2.6)) / columns;
        for (int end = 0; end < 2; end++) {
            point[k][end][0] = (end ? 0.6 : 0.1) * cos(phi);
            point[k][end][1] = (end ? 0.6 : 0.1) * sin(phi);
            point[k][end][2] = 0;
        }
        crease[k] = ruga_default_crease_def();
        crease[k].point_count = 2;
        crease[k].points = point[k][0];
        crease[k].freedom = RUGA_FREEDOM_SINGLE;
        crease[k].rest = k % 2 ? -RUGA_PI : RUGA_PI;
        crease[k].stiffness = 1e-3;
    }
    m->s.def.crease_count = 2 * pleats;
    m->s.def.creases = crease;
    m->s.def.start.fold = 1;
}

// Of 6 columns 1.8 are folded back: 2.4 of 6 are left of the turn.
static void a_pleated_ring_closes_as_it_is_rolled(void** state) {
    (void)state;
    enum { PLEATS = 12 };
    const double angle = 2 * RUGA_PI * 0.4;
    ruga_crease_def crease[2 * PLEATS];
    double point[2 * PLEATS][2][3];
    for (int k = 0; k < 3; k++) {
        moving_scene m;
        make_pleats(PLEATS, &m, crease, point);
        m.s.def.start.cone = k == 0 ? angle : k == 1 ? 0 : 1.1 * angle;
        if (k > 0) { // flat, or rolled too little: the ring does not meet
            refuse(&m, "start.fold: the flat panels");
            scene_free(&m.s);
            continue;
        }
        build(&m);
        const double* x = ruga_state_positions(m.s.state);
        double widest = 0;
        for (int v = 0; v < m.s.model->sheet->vertex_count; v++) {
            const double *rest = m.s.model->sheet->position + 3 * (size_t)v, *at = x + 3 * (size_t)v;
            double along = hypot(rest[0], rest[1]);
            assert_near(hypot(at[0], at[1]), 0.4 * along, 1e-3); // closing gaps moves them a little
            widest = fmax(widest, fabs(remainder(atan2(at[1], at[0]), 2 * RUGA_PI)));
        }
        assert_true(widest > 0.95 * RUGA_PI);
        step(&m, 3);
        scene_free(&m.s);
    }
}

static void a_spinning_start_turns_as_a_whole(void** state) {
    (void)state;
    moving_scene m;
    make_scene(1, &m);
    m.s.def.start.spin[2] = 0.3;
    build(&m);
    step(&m, 5);
    for (int n = 0; n < m.s.model->mesh.vertex_count; n++) {
        const double *rest = m.s.model->mesh.position + 3 * (size_t)n, *x = m.s.state->x + 3 * (size_t)n;
        double c = cos(0.03), s = sin(0.03);
        assert_near(x[0], c * rest[0] - s * rest[1], 1e-4);
        assert_near(x[1], s * rest[0] + c * rest[1], 1e-4);
    }
    scene_free(&m.s);
    make_scene(1, &m);
    m.s.def.skin.motion = RUGA_SKIN_STATIC;
    m.s.def.start.spin[2] = 0.3;
    refuse(&m, "start: cone, velocity and spin need");
    scene_free(&m.s);
}

static void panels_that_would_bend_are_refused(void** state) {
    (void)state;
    moving_scene m;
    make_scene(2, &m);
    m.crease[0].rest = m.crease[1].rest = 1;
    m.s.def.start.fold = 1;
    refuse(&m, "start.fold: the flat panels");
    scene_free(&m.s);
}

// A sheet swings from one side; its crease, stiff and folded at rest, comes after 0.1 s.
static void a_crease_may_come_later_without_a_jump(void** state) {
    (void)state;
    moving_scene m, never;
    make_scene(1, &m);
    make_scene(1, &never);
    moving_scene* both[2] = {&m, &never};
    for (int k = 0; k < 2; k++) {
        hold_left(both[k]);
        both[k]->s.def.gravity[2] = -1;
        both[k]->crease[0].freedom = RUGA_FREEDOM_FULL;
        both[k]->crease[0].rest = 2;
        both[k]->crease[0].start = k == 0 ? 0.1 : 1e9;
        build(both[k]);
        step(both[k], 5);
    }
    size_t size = 3 * (size_t)ruga_model_vertex_count(m.s.model) * sizeof(double);
    assert_memory_equal(ruga_state_positions(m.s.state), ruga_state_positions(never.s.state), size);
    double before = ruga_state_crease_angles(m.s.state)[0];
    step(&m, 10);
    step(&never, 10);
    double with = ruga_state_crease_angles(m.s.state)[0],
           without = ruga_state_crease_angles(never.s.state)[0];
    print_message("angle %.3f when it comes, then %.3f, and %.3f without\n", before, with, without);
    assert_true(fabs(before) < 0.2 && with > 1 && fabs(without) < 0.5);
    scene_free(&m.s);
    scene_free(&never.s);
}

// One edge is held, the other turned about the crease.
static void a_yielding_crease_keeps_its_fold(void** state) {
    (void)state;
    for (int style = RUGA_CREASE_ANGLE; style <= RUGA_CREASE_ACROSS; style++) {
        moving_scene m;
        make_scene(1, &m);
        hold_left(&m);
        m.s.def.skin.creases = (ruga_crease_style)style;
        m.s.def.skin.young = 1e7;
        m.s.def.skin.thickness = 2e-3;
        m.s.def.skin.drag = 20;
        m.s.handle[1].kind = RUGA_HANDLE_MOVE;
        m.s.handle[1].region =
            (ruga_region){.kind = RUGA_REGION_BOX, .min = {0.199, -1, -1}, .max = {1, 1, 1}};
        m.s.handle[1].rotate_angle = 1.2;
        m.s.handle[1].rotate_axis[1] = 1;
        m.s.handle[1].ramped = true;
        m.s.handle[1].during[1] = 0.2;
        m.s.def.handle_count = 2;
        m.crease[0].yield = 0.2;
        m.crease[0].rate = 100;
        build(&m);
        step(&m, 20);
        double angle = fabs(ruga_state_crease_angles(m.s.state)[0]),
               rest = fabs(ruga_state_crease_rests(m.s.state)[0]);
        print_message("style %d: angle %.3f, rest angle %.3f\n", style, angle, rest);
        assert_true(rest > 0.8 && angle - rest < 0.21); // less where it swung beyond
        scene_free(&m.s);
    }
}

static void every_failed_allocation_of_a_state_is_a_status(void** state) {
    (void)state;
    moving_scene m;
    make_scene(1, &m);
    m.crease[0].rest = 1;
    m.s.def.start.fold = 1;
    assert_ok(ruga_model_create(&m.s.def, &m.s.model));
    for (int i = 0;; i++) {
        let_allocations_fail_after(i);
        ruga_status status = ruga_state_create(m.s.model, &m.s.state);
        ruga_state_destroy(&m.s.state);
        ruga_set_allocator(NULL, NULL, NULL);
        if (status == RUGA_OK) {
            break;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
    }
    scene_free(&m.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_does_not_go_together_is_refused),
        cmocka_unit_test(a_thrown_sheet_falls_as_a_whole),
        cmocka_unit_test(a_restart_changes_no_bit),
        cmocka_unit_test(a_folded_start_is_at_rest),
        cmocka_unit_test(a_pleated_ring_closes_as_it_is_rolled),
        cmocka_unit_test(a_spinning_start_turns_as_a_whole),
        cmocka_unit_test(panels_that_would_bend_are_refused),
        cmocka_unit_test(a_crease_may_come_later_without_a_jump),
        cmocka_unit_test(a_yielding_crease_keeps_its_fold),
        cmocka_unit_test(every_failed_allocation_of_a_state_is_a_status),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
