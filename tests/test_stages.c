// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Creases that come while a skin is simulated: what is cut later lies within what is cut now, and nothing of
// the material or its motion changes when it is.
#include "tests/check.h"

#include "core/memory.h"
#include "crease/nest.h"
#include "solver/stages.h"
#include "tests/random_creases.h"
#include "tests/small_scene.h"

#define DEGREE (RUGA_PI / 180)

// ---- cuts within cuts ----------------------------------------------------------------------------------

typedef struct cuts {
    ruga_raster raster[2];
    ruga_cut cut[2];
    ruga_nest nest;
} cuts;

static void make_cuts(const ruga_mesh* mesh, const ruga_curves* curves, int first, int second, cuts* c) {
    for (int k = 0; k < 2; k++) {
        ruga_raster_def def = ruga_default_raster_def();
        def.stage = k ? second : first;
        assert_ok(ruga_raster_create(mesh, curves, &def, &c->raster[k]));
        assert_ok(ruga_cut_create(&c->raster[k], &c->cut[k]));
    }
    assert_ok(ruga_nest_create(&c->cut[1], &c->cut[0], &c->nest));
}

static void clear_cuts(cuts* c) {
    for (int k = 0; k < 2; k++) {
        ruga_cut_clear(&c->cut[k]);
        ruga_raster_clear(&c->raster[k]);
    }
    ruga_nest_clear(&c->nest);
}

// With x of the coarser one anywhere, seams sewn or not: pieces have the map of the piece they are of, seams
// that are new are closed, and masses add up.
static void check_cuts(const cuts* c, ruga_random* random) {
    const ruga_cut *coarse = &c->cut[0], *fine = &c->cut[1];
    double *x = malloc(3 * (size_t)coarse->node_count * sizeof *x), *y, *mass[2], *triangle;
    assert_int_equal(c->raster[0].mesh.triangle_count, c->raster[1].mesh.triangle_count);
    assert_memory_equal(c->raster[0].mesh.position, c->raster[1].mesh.position,
                        3 * (size_t)c->raster[0].mesh.vertex_count * sizeof *x);
    y = malloc(3 * (size_t)fine->node_count * sizeof *y);
    for (int i = 0; i < 3 * coarse->node_count; i++) {
        x[i] = ruga_random_uniform(random);
    }
    for (int n = 0; n < fine->node_count; n++) {
        assert_int_equal(fine->source[n], coarse->source[c->nest.node[n]]);
        memcpy(y + 3 * (size_t)n, x + 3 * (size_t)c->nest.node[n], 3 * sizeof *y);
    }
    // Every finer piece has the nodes of one coarser piece of its triangle.
    for (int p = 0; p < fine->piece_count; p++) {
        int found = 0;
        for (int q = 0; q < coarse->piece_count; q++) {
            bool same = coarse->piece[q].triangle == fine->piece[p].triangle;
            for (int i = 0; i < 3 && same; i++) {
                same = coarse->piece[q].node[i] == c->nest.node[fine->piece[p].node[i]];
            }
            found += same;
        }
        assert_true(found >= 1);
    }
    for (int b = 0; b < fine->bound_count; b++) { // no gap that was not there
        const ruga_bound* bound = &fine->bound[b];
        for (int k = 1; k < bound->count; k++) {
            const int *one = fine->parent[bound->first], *other = fine->parent[bound->first + k];
            bool same = c->nest.node[one[0]] == c->nest.node[other[0]] &&
                        c->nest.node[one[1]] == c->nest.node[other[1]];
            assert_true(same || c->raster[0].node[bound->edge] > 0);
        }
    }
    triangle = malloc((size_t)c->raster[0].mesh.triangle_count * sizeof *triangle);
    for (int f = 0; f < c->raster[0].mesh.triangle_count; f++) {
        triangle[f] = ruga_mesh_triangle_area(&c->raster[0].mesh, f);
    }
    for (int k = 0; k < 2; k++) {
        mass[k] = malloc((size_t)c->cut[k].node_count * sizeof *mass[k]);
        ruga_cut_masses(&c->cut[k], triangle, 0, false, mass[k]);
    }
    for (int n = 0; n < fine->node_count; n++) {
        mass[0][c->nest.node[n]] -= mass[1][n];
    }
    for (int n = 0; n < coarse->node_count; n++) {
        assert_near(mass[0][n], 0, 1e-13);
    }
    free(x);
    free(y);
    free(triangle);
    free(mass[0]);
    free(mass[1]);
}

static void later_cuts_lie_within_earlier_ones(void** state) {
    (void)state;
    int cut = 0, refined = 0;
    for (uint64_t seed = 1; seed <= 400; seed++) {
        ruga_random random = {seed};
        double size[2];
        crease_case c = {0};
        cuts k = {0};
        random_mesh(&random, size, &c.mesh);
        random_curves(&random, size, &c.curves);
        random_curves(&random, size, &c.curves);
        for (int i = 0; i < c.curves.count; i++) {
            c.curves.curve[i].stage = 1 + (int)(3 * ruga_random_uniform(&random));
            c.curves.curve[i].kind = ruga_random_uniform(&random) < 0.2 ? RUGA_CREASE_CUT : RUGA_CREASE_FOLD;
        }
        ruga_raster_def def = ruga_default_raster_def();
        if (ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster) == RUGA_OK) {
            int first = (int)(3 * ruga_random_uniform(&random));
            int second = first + 1 + (int)((3 - first) * ruga_random_uniform(&random));
            make_cuts(&c.mesh, &c.curves, first, second, &k);
            check_cuts(&k, &random);
            if (first == 0) {
                assert_int_equal(k.cut[0].node_count, k.raster[0].mesh.vertex_count);
                assert_int_equal(k.cut[0].segment_count, 0);
            }
            cut++;
            refined += k.cut[1].node_count > k.cut[0].node_count;
            clear_cuts(&k);
        }
        clear_case(&c);
    }
    print_message("%d patterns of 400, %d with new nodes\n", cut, refined);
    assert_true(cut > 300 && refined > 150);
}

// A straight line across, whatever its distance from vertices, needs none; one that ends within the sheet,
// and one with auxiliary chords near vertices, are worth another mesh.
static void a_later_line_across_leaves_the_mesh_as_it_is(void** state) {
    (void)state;
    int kept[3] = {0, 0, 0};
    for (uint64_t seed = 1; seed <= 60; seed++) {
        for (int how = 0; how < 3; how++) {
            ruga_random random = {seed};
            double size[2];
            crease_case c = {0};
            random_mesh(&random, size, &c.mesh);
            ruga_raster_def def = ruga_default_raster_def();
            add_line(&c.curves, RUGA_FREEDOM_AUTO, 0.3 * size[0], -1, 0.4 * size[0], 0.6 * size[1]);
            assert_ok(ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster));
            ruga_mesh alone = c.raster.mesh;
            c.raster.mesh = (ruga_mesh){0};
            ruga_raster_clear(&c.raster);
            double x = size[0] * uniform(&random, 0.55, 0.9);
            add_line(&c.curves, how == 2 ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_SINGLE, x, -1, x + 0.1,
                     how == 1 ? 0.45 * size[1] : size[1] + 1);
            c.curves.curve[1].stage = 1;
            assert_ok(ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster));
            kept[how] += c.raster.mesh.vertex_count == alone.vertex_count &&
                         memcmp(c.raster.mesh.position, alone.position,
                                3 * (size_t)alone.vertex_count * sizeof *alone.position) == 0;
            ruga_mesh_clear(&alone);
            clear_case(&c);
        }
    }
    print_message("%d, %d and %d of 60 meshes as they were\n", kept[0], kept[1], kept[2]);
    assert_true(kept[0] > 55 && kept[1] < 10 && kept[2] < 45);
}

static void the_last_stage_is_the_whole(void** state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 60; seed++) {
        ruga_random random = {seed};
        double size[2];
        crease_case c = {0};
        random_mesh(&random, size, &c.mesh);
        random_curves(&random, size, &c.curves);
        ruga_raster_def def = ruga_default_raster_def();
        if (ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster) == RUGA_OK) {
            assert_ok(ruga_cut_create(&c.raster, &c.cut));
            for (int i = 0; i < c.curves.count; i++) {
                c.curves.curve[i].stage = i; // later ones give way to earlier ones in any case
            }
            cuts k = {0};
            make_cuts(&c.mesh, &c.curves, c.curves.count, c.curves.count, &k);
            for (int n = 0; n < k.cut[0].node_count; n++) {
                assert_int_equal(k.nest.node[n], n);
            }
            for (int s = 0; s < k.cut[1].segment_count; s++) {
                assert_true(k.nest.segment[s] >= 0);
            }
            clear_cuts(&k);
        }
        clear_case(&c);
    }
}

// ---- scenes --------------------------------------------------------------------------------------------

typedef struct scene {
    small_scene s;
    ruga_crease_def crease[3];
    double point[3][6];
} scene;

typedef enum kind { MOTION, SPRINGS, STATIC, DAMPED, PRESCRIBED, QUASISTATIC, DYNAMIC_INTERIOR, KINDS } kind;

// Lines off the vertices, over the border: the mesh of one of them stays as it is.
static const double line[3][6] = {
    {0.013, -1, 0, -0.021, 1, 0}, {-1, 0.02, 0, 1, -0.011, 0}, {0.05, -1, 0, 0.07, 1, 0}};

static void make_free(kind which, scene* s) {
    scene_mesh(&s->s, RUGA_SHAPE_SHEET, 0.4, 0.3, 0, 0.04);
    s->s.def.has_interior = false;
    s->s.def.skin.motion = which == STATIC   ? RUGA_SKIN_STATIC
                           : which == DAMPED ? RUGA_SKIN_DAMPED
                                             : RUGA_SKIN_DYNAMIC;
    s->s.def.skin.model = which == SPRINGS ? RUGA_SKIN_SPRINGS : RUGA_SKIN_SHELL;
    s->s.def.skin.thickness = 1e-3;
    s->s.def.skin.young = 1e6;
    s->s.def.skin.density = 300;
    s->s.def.skin.relaxation = 1;
    s->s.def.step = 0.02;
    s->s.def.gravity[2] = -9.81;
    if (which == STATIC || which == DAMPED) {
        s->s.handle[0].region =
            (ruga_region){.kind = RUGA_REGION_BOX, .min = {-1, -1, -1}, .max = {-0.199, 1, 1}};
        s->s.def.handle_count = 1;
        s->s.def.gravity[2] = -1;
    }
}

static void make_wrinkled(kind which, scene* s) {
    scene_sheet(&s->s, 2, 1, 8, 0);
    ruga_model_def* def = &s->s.def;
    if (which != PRESCRIBED) {
        def->keyframe_count = 0;
        def->interior.motion = which == QUASISTATIC ? RUGA_INTERIOR_QUASISTATIC : RUGA_INTERIOR_DYNAMIC;
        def->interior.density = 1000;
        double x = 0.5 * s->s.length;
        for (int k = 0; k < 2; k++) {
            s->s.handle[k].region = (ruga_region){.kind = RUGA_REGION_BOX,
                                                  .min = {k ? 0.98 * x : -1, -1, -1},
                                                  .max = {k ? 1 : -0.98 * x, 1, 1}};
        }
        s->s.handle[1].kind = RUGA_HANDLE_MOVE;
        s->s.handle[1].translate[0] = -0.03 * s->s.length;
        s->s.handle[1].ramped = true;
        s->s.handle[1].during[1] = 4 * def->step;
        def->handle_count = 2;
    } else {
        s->s.key[1].matrix[0] = 0.95;
        s->s.key[1].time = 4 * def->step;
    }
    def->skin.density = 1000;
}

// Creases that come at `start`, in frames; one that is not finite is left out.
static void make(kind which, int count, const double* start, scene* s) {
    *s = (scene){.s = {.length = 0}};
    if (which <= DAMPED) {
        make_free(which, s);
    } else {
        make_wrinkled(which, s);
    }
    for (int k = 0; k < count; k++) {
        s->crease[k] = ruga_default_crease_def();
        s->crease[k].point_count = 2;
        for (int i = 0; i < 6; i++) {
            s->point[k][i] = line[k][i] * (fabs(line[k][i]) < 1 ? s->s.length / 0.4 : 1);
        }
        s->crease[k].points = s->point[k];
        s->crease[k].stiffness = 0.01;
        s->crease[k].rest = 1;
        s->crease[k].start = start[k] * s->s.def.step;
    }
    s->s.def.crease_count = count;
    s->s.def.creases = s->crease;
}

static void step(scene* s, int frames) {
    for (int k = 0; k < frames; k++) {
        ruga_report report;
        assert_ok(ruga_state_step(s->s.model, s->s.state, &report));
        assert_true(report.outcome == RUGA_OUTCOME_MOTION || report.outcome == RUGA_OUTCOME_MINIMUM);
        assert_true(report.constraint_residual < 1e-9);
        assert_true(ruga_state_gap(s->s.state) < 1e-12 * s->s.model->mean_edge);
    }
}

// What moves: mass, momentum, angular momentum, kinetic energy.
static void momenta(const ruga_state* state, double sum[8]) {
    const double* v = ruga_moving_velocity(state->moving);
    const double* mass = ruga_dynamic_mass(ruga_moving_dynamic(state->moving));
    memset(sum, 0, 8 * sizeof *sum);
    for (int n = 0; n < state->model->mesh.vertex_count; n++) {
        const double *u = v + 3 * (size_t)n, *x = state->x + 3 * (size_t)n;
        double turn[3];
        ruga_cross(x, u, turn);
        sum[0] += mass[n];
        ruga_add_scaled(mass[n], u, sum + 1);
        ruga_add_scaled(mass[n], turn, sum + 4);
        sum[7] += 0.5 * mass[n] * ruga_dot(u, u);
    }
}

static const double never[3] = {1e9, 1e9, 1e9};

// ---- before a crease comes -----------------------------------------------------------------------------

// The scene without a crease, on the sheet as it is mended for them: free skins to the bit, others as near as
// the tolerance asks.
static void before_it_comes_there_is_no_crease(void** state) {
    (void)state;
    for (kind which = MOTION; which < KINDS; which++) {
        scene with, without;
        make(which, 3, never, &with);
        with.s.def.solver.tolerance = which < QUASISTATIC ? 1e-9 : 1e-8;
        with.s.handle[1].translate[2] = 0.01 * with.s.length; // lifted: pressed, it has several equilibria
        with.s.handle[1].translate[0] = 0;
        scene_build(&with.s);
        const ruga_mesh* sheet = with.s.model->stage[0].model->sheet;
        assert_int_equal(with.s.model->stage_count, 1);
        make(which, 0, NULL, &without);
        without.s.def.mesh = ruga_mesh_as_def(sheet);
        // The unit of damping hangs on the mean edge of the mesh that was given.
        without.s.def.skin.relaxation *= pow(ruga_mesh_mean_edge(sheet) / with.s.model->mean_edge, 4);
        memcpy(without.s.handle[1].translate, with.s.handle[1].translate, sizeof with.s.handle[1].translate);
        without.s.def.solver.tolerance = with.s.def.solver.tolerance;
        scene_build(&without.s);
        step(&with, 3);
        step(&without, 3);
        double off = 0, moved = 0;
        for (int i = 0; i < 3 * sheet->vertex_count; i++) {
            double x = ruga_state_positions(with.s.state)[i];
            off = fmax(off, fabs(x - ruga_state_positions(without.s.state)[i]));
            moved = fmax(moved, fabs(x - sheet->position[i]));
        }
        print_message("kind %d: off by %.2g of %.2g m\n", which, off, moved);
        assert_true(off <= moved * (which <= SPRINGS ? 0 : 1e-6));
        assert_true(moved > 1e-5);
        scene_free(&with.s);
        scene_free(&without.s);
    }
}

// ---- when it comes -------------------------------------------------------------------------------------

static void nothing_jumps_when_it_comes(void** state) {
    (void)state;
    const double start[3] = {2, 0, 2};
    for (kind which = MOTION; which < KINDS; which++) {
        scene s;
        make(which, 3, start, &s);
        if (which <= SPRINGS) {
            s.s.def.start.velocity[0] = 1;
            s.s.def.start.spin[1] = 9;
        }
        scene_build(&s.s);
        step(&s, 2);
        ruga_state* now = s.s.state;
        size_t size = 3 * (size_t)ruga_model_vertex_count(s.s.model) * sizeof(double);
        int segments = s.s.model->creases->segment_count;
        double *x = malloc(size), *angle = scene_copy(segments, ruga_state_crease_angles(now));
        double *rest = scene_copy(segments, ruga_state_crease_rests(now)), before[8], after[8];
        const double *shown = ruga_state_positions(now), *embedded = ruga_state_embedded(now);
        memcpy(x, shown, size);
        if (now->moving) {
            momenta(now, before);
        }
        assert_int_equal(now->stage, 0);
        assert_ok(ruga_state_enter_next_stage(now));
        assert_int_equal(now->stage, 1);
        assert_true(ruga_state_positions(now) == shown && ruga_state_embedded(now) == embedded);
        for (size_t i = 0; i < size / sizeof *x; i++) {
            assert_near(ruga_state_positions(now)[i], x[i], 1e-15);
        }
        for (int h = 0; h < segments; h++) {
            assert_near(ruga_state_crease_angles(now)[h], angle[h], 1e-9);
            assert_near(ruga_state_crease_rests(now)[h], rest[h], 1e-9);
        }
        assert_true(ruga_state_gap(now) < 1e-13 * s.s.model->mean_edge);
        assert_true(ruga_skin_constraint_residual(now->skin, now->x) < 1e-12);
        if (now->moving) {
            momenta(now, after);
            for (int i = 0; i < 8; i++) {
                double scale = i == 0 ? before[0] : i < 4 ? before[0] * 10 : i < 7 ? before[0] : before[7];
                assert_near(after[i], before[i], 1e-13 * scale);
            }
        }
        step(&s, 1);
        free(x);
        free(angle);
        free(rest);
        scene_free(&s.s);
    }
}

// Crossing and turning creases that come one after another, within frames: a sheet thrown in free space.
static void momenta_stay_through_many_creases(void** state) {
    (void)state;
    const double start[3] = {0.5, 2.25, 2.75};
    for (int full = 0; full < 2; full++) {
        scene s;
        make(MOTION, 3, start, &s);
        s.s.def.gravity[2] = 0;
        s.s.def.start.velocity[0] = 1;
        s.s.def.start.spin[1] = 5;
        for (int k = 0; k < 3; k++) {
            s.crease[k].freedom = full ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_AUTO;
        }
        scene_build(&s.s);
        double before[8], after[8];
        momenta(s.s.state, before);
        step(&s, 6);
        momenta(s.s.state, after);
        assert_int_equal(s.s.state->stage, 3);
        for (int i = 0; i < 7; i++) {
            double scale = i == 0 ? before[0] : i < 4 ? before[0] : before[0] * 0.1;
            assert_near(after[i], before[i], 1e-12 * scale);
        }
        double least = INFINITY;
        for (int h = 0; h < s.s.model->creases->segment_count; h++) {
            least = fmin(least, ruga_state_crease_angles(s.s.state)[h]);
        }
        assert_true(ruga_state_crease_angles(s.s.state)[0] > 0.1 && least > 0);
        scene_free(&s.s);
    }
}

// What has come goes where it would have gone if it had been there from the first frame: on a line so far
// from vertices that neither moves any.
static void it_folds_as_one_that_was_always_there(void** state) {
    (void)state;
    const double start[2][1] = {{2.5}, {0}};
    double angle[2];
    for (int k = 0; k < 2; k++) {
        scene s;
        make(STATIC, 1, start[k], &s);
        s.crease[0].stiffness = 1;
        s.point[0][0] = s.point[0][3] = 0.01;
        s.s.def.solver.tolerance = 1e-8;
        scene_build(&s.s);
        step(&s, 2);
        angle[k] = ruga_state_crease_angles(s.s.state)[0];
        assert_true(k == 1 || fabs(angle[k]) < 0.2);
        assert_true(k == 1 || ruga_state_crease_rests(s.s.state)[0] == angle[k]);
        step(&s, 2);
        angle[k] = ruga_state_crease_angles(s.s.state)[0];
        scene_free(&s.s);
    }
    print_message("angles %.8f and %.8f\n", angle[0], angle[1]);
    assert_near(angle[0], angle[1], 1e-5);
    assert_true(angle[0] > 0.8);
}

static void an_open_cut_may_come_and_take_a_fold_with_it(void** state) {
    (void)state;
    const double start[2] = {1, 3};
    scene s;
    make(MOTION, 2, start, &s);
    s.s.handle[0].region = (ruga_region){.kind = RUGA_REGION_BOX, .min = {-1, -1, -1}, .max = {-0.199, 1, 1}};
    s.s.def.handle_count = 1;
    s.crease[1].points = s.point[0]; // along the fold
    s.crease[1].kind = RUGA_CREASE_CUT;
    scene_build(&s.s);
    assert_int_equal(s.s.model->stage_count, 2);
    assert_int_equal(s.s.model->creases->segment_count, 0);
    step(&s, 3);
    assert_true(s.s.state->model->creases->segment_count > 0);
    const ruga_mesh* shown = ruga_model_shown(s.s.model);
    int right = 0;
    for (int v = 0; v < shown->vertex_count; v++) {
        right = shown->position[3 * v] > shown->position[3 * right] ? v : right;
    }
    double before = ruga_state_positions(s.s.state)[3 * right + 2];
    step(&s, 6);
    double fell = before - ruga_state_positions(s.s.state)[3 * right + 2];
    print_message("the part that was cut off fell %.3f m in 0.12 s\n", fell);
    assert_true(fell > 0.5 * 9.81 * 0.12 * 0.12);
    scene_free(&s.s);
}

// ---- restart -------------------------------------------------------------------------------------------

static void a_restart_at_any_frame_changes_no_bit(void** state) {
    (void)state;
    enum { FRAMES = 5 };
    const double start[3] = {2, 3.4, 2};
    for (kind which = MOTION; which < KINDS; which++) {
        scene s;
        double* restart[FRAMES + 1];
        make(which, 3, start, &s);
        s.s.def.skin.damping = which == MOTION ? 1e-3 : 0;
        s.crease[0].yield = 0.05;
        s.crease[1].yield = 0.01;
        scene_build(&s.s);
        for (int frame = 0; frame <= FRAMES; frame++) {
            restart[frame] = scene_array(ruga_state_restart_size(s.s.model));
            ruga_state_save(s.s.state, restart[frame]);
            step(&s, frame < FRAMES);
        }
        size_t size = (size_t)ruga_state_restart_size(s.s.model) * sizeof(double);
        double* again = scene_array(ruga_state_restart_size(s.s.model));
        size_t bytes = 3 * (size_t)ruga_model_vertex_count(s.s.model) * sizeof(double);
        double* shown = malloc(bytes);
        memcpy(shown, ruga_state_positions(s.s.state), bytes);
        for (int frame = FRAMES - 1; frame >= 0; frame--) { // back, too: from a later stage to an earlier one
            assert_ok(ruga_state_load(s.s.state, restart[frame]));
            assert_int_equal(ruga_state_frame(s.s.state), frame);
            step(&s, FRAMES - frame);
            memset(again, 0, size);
            ruga_state_save(s.s.state, again);
            assert_memory_equal(again, restart[FRAMES], size);
            assert_memory_equal(ruga_state_positions(s.s.state), shown, bytes);
        }
        for (int frame = 0; frame <= FRAMES; frame++) {
            free(restart[frame]);
        }
        free(again);
        free(shown);
        scene_free(&s.s);
    }
}

static void times_at_a_frame_are_at_it(void** state) {
    (void)state;
    ruga_crease_def crease[5];
    int stage[5];
    double end[5];
    const double start[5] = {0.3, 0, 0.1 + 0.2, 0.25, -1};
    for (int k = 0; k < 5; k++) {
        crease[k] = ruga_default_crease_def();
        crease[k].start = start[k];
    }
    assert_int_equal(ruga_creases_stages(5, crease, 0.1, stage, end), 2);
    const int wanted[5] = {2, 0, 2, 1, 0};
    assert_memory_equal(stage, wanted, sizeof stage);
    assert_near(end[0], 2.5, 1e-12);
    assert_true(end[1] == 3);
}

static void each_allocation_may_fail(void** state) {
    (void)state;
    const double start[3] = {1, 0, 1};
    scene s;
    int allowed = 0;
    make(MOTION, 3, start, &s);
    ruga_mesh_clear(&s.s.mesh);
    ruga_make_def coarse = {.shape = RUGA_SHAPE_SHEET, .size = {0.4, 0.3, 0}, .edge = 0.15};
    assert_ok(ruga_mesh_make(&coarse, &s.s.mesh));
    s.s.def.mesh = ruga_mesh_as_def(&s.s.mesh);
    for (int k = 0;; k++) {
        allowed = k;
        ruga_set_allocator(scene_allocate_while_allowed, scene_release_block, &allowed);
        ruga_status status = ruga_model_create(&s.s.def, &s.s.model);
        status = status == RUGA_OK ? ruga_state_create(s.s.model, &s.s.state) : status;
        status = status == RUGA_OK ? ruga_state_enter_next_stage(s.s.state) : status;
        scene_free_state(&s.s);
        ruga_set_allocator(NULL, NULL, NULL);
        if (status == RUGA_OK) {
            print_message("%d allocations\n", k);
            break;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
    }
    ruga_mesh_clear(&s.s.mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(later_cuts_lie_within_earlier_ones),
        cmocka_unit_test(a_later_line_across_leaves_the_mesh_as_it_is),
        cmocka_unit_test(the_last_stage_is_the_whole),
        cmocka_unit_test(before_it_comes_there_is_no_crease),
        cmocka_unit_test(nothing_jumps_when_it_comes),
        cmocka_unit_test(momenta_stay_through_many_creases),
        cmocka_unit_test(it_folds_as_one_that_was_always_there),
        cmocka_unit_test(an_open_cut_may_come_and_take_a_fold_with_it),
        cmocka_unit_test(a_restart_at_any_frame_changes_no_bit),
        cmocka_unit_test(times_at_a_frame_are_at_it),
        cmocka_unit_test(each_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
