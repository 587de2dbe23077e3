// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Gaps and momenta of scenes with creases over many steps:
//     bench_gaps [--steps N] [--seconds S] [--only 'as it is' | 'in motion' | thrown] SCENE...
// Each scene is run up to three ways:
//   as it is     from its beginning to its end in N solves for a static scene, explicit steps of one in motion
//   in motion    a static scene as a free shell in dynamic motion, without its interior
//   thrown       in motion with nothing that holds or loads it, turning: momentum and angular momentum stay
// In motion the creases of a static scene fold to and fro, where their rest angles are animated.
// Printed are the largest gap in mean edges, found after each frame, and by how much the momenta have
// changed, over themselves. A way ends after N steps (10,000) or S seconds of processor time (no limit). Exit
// status 1 where anything of that is not below 1e-12.
#include "core/memory.h"
#include "core/vec3.h"
#include "io/scene.h"
#include "ruga/ruga.h"
#include "solver/moving.h"
#include "solver/state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FOLDS = 4, STEPS_A_FRAME = 50 };

static const double ROUND_OFF = 1e-12;

typedef enum how { AS_IS, MOTION, THROWN, HOWS } how;
static const char* const names[HOWS] = {"as it is", "in motion", "thrown"};

typedef struct trial {
    ruga_scene scene;
    ruga_model_def def;
    ruga_crease_def* crease;
    ruga_crease_key* key;     // to and fro: [creases][turns]
    ruga_keyframe_def* frame; // likewise
    ruga_model* model;
    ruga_state* state;
} trial;

static double cpu_seconds(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void clear(trial* t) {
    ruga_state_destroy(&t->state);
    ruga_model_destroy(&t->model);
    ruga_scene_clear(&t->scene);
    ruga_release(t->crease);
    ruga_release(t->key);
    ruga_release(t->frame);
}

static ruga_status create(trial* t) {
    ruga_state_destroy(&t->state);
    ruga_model_destroy(&t->model);
    RUGA_TRY(ruga_model_create(&t->def, &t->model));
    return ruga_state_create(t->model, &t->state);
}

// First and last values of what is animated, in turn, `turns` times with `half` seconds between.
static ruga_status swing(trial* t, int turns, double half) {
    int count = t->def.crease_count;
    const ruga_crease_def* own = t->scene.def.creases;
    const ruga_keyframe_def* frame = t->scene.def.keyframes;
    int last = t->scene.def.keyframe_count - 1;
    ruga_release(t->key);
    ruga_release(t->frame);
    t->key = NULL;
    t->frame = NULL;
    RUGA_TRY(RUGA_NEW(t->key, (size_t)count * (size_t)turns));
    RUGA_TRY(RUGA_NEW(t->frame, turns));
    for (int c = 0; c < count; c++) {
        ruga_crease_key* key = t->key + (size_t)c * (size_t)turns;
        for (int k = 0; k < turns && own[c].key_count > 1; k++) {
            key[k] = own[c].keys[k % 2 ? own[c].key_count - 1 : 0];
            key[k].time = k * half;
        }
        t->crease[c].keys = own[c].key_count > 1 ? key : own[c].keys;
        t->crease[c].key_count = own[c].key_count > 1 ? turns : own[c].key_count;
    }
    for (int k = 0; k < turns && last > 0; k++) {
        t->frame[k] = frame[k % 2 ? last : 0];
        t->frame[k].time = k * half;
    }
    t->def.keyframes = last > 0 ? t->frame : frame;
    t->def.keyframe_count = last > 0 ? turns : last + 1;
    return RUGA_OK;
}

static ruga_status prepare(trial* t, how how, int steps) {
    const bool dynamic = t->scene.def.skin.motion == RUGA_SKIN_DYNAMIC;
    const double turning[3] = {0.3, -0.2, 1};
    RUGA_TRY(RUGA_NEW(t->crease, t->scene.def.crease_count));
    memcpy(t->crease, t->scene.def.creases, (size_t)t->scene.def.crease_count * sizeof *t->crease);
    t->def = t->scene.def;
    t->def.creases = t->crease;
    if (how == AS_IS) {
        t->def.step *= dynamic ? 1 : (double)t->def.frames / steps;
        return create(t);
    }
    t->def.skin.motion = RUGA_SKIN_DYNAMIC;
    t->def.has_interior = false;
    if (how == THROWN) {
        t->def.handle_count = 0;
        t->def.skin.drag = 0;
        memset(t->def.gravity, 0, sizeof t->def.gravity);
        t->def.start.velocity[0] = 0.5;
        memcpy(t->def.start.spin, turning, sizeof turning);
    }
    RUGA_TRY(create(t));
    if (!dynamic) {
        double dt = 0.7 * ruga_dynamic_limit(ruga_moving_dynamic(t->state->moving), t->state->x, 60);
        t->def.step = STEPS_A_FRAME * dt;
        RUGA_TRY(swing(t, FOLDS + 1, steps * dt / FOLDS));
        RUGA_TRY(create(t));
    }
    return RUGA_OK;
}

static void momenta(const ruga_state* state, double p[3], double l[3]) {
    const double *mass = ruga_dynamic_mass(ruga_moving_dynamic(state->moving)),
                 *v = ruga_moving_velocity(state->moving);
    memset(p, 0, 3 * sizeof *p);
    memset(l, 0, 3 * sizeof *l);
    for (int n = 0; n < state->model->mesh.vertex_count; n++) {
        double turn[3];
        ruga_cross(state->x + 3 * (size_t)n, v + 3 * (size_t)n, turn);
        ruga_add_scaled(mass[n], v + 3 * (size_t)n, p);
        ruga_add_scaled(mass[n], turn, l);
    }
}

static ruga_status run(trial* t, how how, int steps, double seconds, double* worst) {
    double gap = ruga_state_gap(t->state), begin = cpu_seconds();
    double p[3] = {0, 0, 0}, l[3], q[3], k[3];
    int done = 0, frames = 0;
    if (how == THROWN) {
        momenta(t->state, p, l);
    }
    while (done < steps && cpu_seconds() - begin < seconds) {
        ruga_report report;
        RUGA_TRY(ruga_state_step(t->model, t->state, &report));
        done += t->state->moving ? report.substeps : 1;
        frames++;
        gap = fmax(gap, ruga_state_gap(t->state));
    }
    printf(" %-9s %7d steps %6d frames %7.0f s  gap %8.2g edges", names[how], done, frames,
           cpu_seconds() - begin, gap / t->model->mean_edge);
    *worst = fmax(*worst, gap / t->model->mean_edge);
    if (how == THROWN) {
        momenta(t->state, q, k);
        double linear = ruga_distance(p, q) / ruga_norm(p), angular = ruga_distance(l, k) / ruga_norm(l);
        printf("  dP %.2g dL %.2g", linear, angular);
        *worst = fmax(*worst, fmax(linear, angular));
    }
    printf("\n");
    return RUGA_OK;
}

static ruga_status run_scene(const char* path, const char* only, int steps, double seconds, double* worst) {
    ruga_status status = RUGA_OK;
    printf("%s\n", path);
    for (int how = AS_IS; how < HOWS; how++) {
        if (only && strcmp(only, names[how]) != 0) {
            continue;
        }
        trial t = {.state = NULL};
        status = ruga_scene_read(path, 0, NULL, &t.scene);
        bool wanted = how != MOTION || t.scene.def.skin.motion != RUGA_SKIN_DYNAMIC;
        status = status == RUGA_OK && wanted ? prepare(&t, how, steps) : status;
        status = status == RUGA_OK && wanted ? run(&t, how, steps, seconds, worst) : status;
        clear(&t);
        if (status != RUGA_OK) {
            return status;
        }
        (void)fflush(stdout);
    }
    return RUGA_OK;
}

int main(int argc, char** argv) {
    int steps = 10000, failed = 0;
    double seconds = INFINITY, worst = 0;
    const char* only = NULL;
    for (int i = 1; i < argc; i++) {
        if (i + 1 < argc && strcmp(argv[i], "--steps") == 0) {
            steps = atoi(argv[++i]);
        } else if (i + 1 < argc && strcmp(argv[i], "--seconds") == 0) {
            seconds = strtod(argv[++i], NULL);
        } else if (i + 1 < argc && strcmp(argv[i], "--only") == 0) {
            only = argv[++i];
        } else if (run_scene(argv[i], only, steps, seconds, &worst) != RUGA_OK) {
            (void)fprintf(stderr, "%s: %s\n", argv[i], ruga_last_error());
            failed = 1;
        }
    }
    return failed || !(worst < ROUND_OFF);
}
