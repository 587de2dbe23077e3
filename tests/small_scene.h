// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For tests of the solver: small scenes that own what their def points to. A sheet is sized in wavelengths.
#ifndef RUGA_TESTS_SMALL_SCENE_H
#define RUGA_TESTS_SMALL_SCENE_H

#include "core/random.h"
#include "core/vec3.h"
#include "lattice/motion.h"
#include "mesh/make.h"
#include "solver/state.h"

#include <stdlib.h>
#include <string.h>

typedef struct small_scene {
    ruga_mesh mesh;
    ruga_keyframe_def key[4];
    ruga_handle_def handle[3];
    ruga_model_def def;
    ruga_model* model;
    ruga_state* state;
    double length; // m, of a sheet
    bool flat;     // start flat in the second pose: x = B q, not at rest
} small_scene;

static inline void scene_mesh(small_scene* s, ruga_shape shape, double x, double y, double z, double edge) {
    ruga_make_def make = {.shape = shape, .size = {x, y, z}, .edge = edge};
    assert_ok(ruga_mesh_make(&make, &s->mesh));
    s->def = ruga_default_model_def();
    s->def.mesh = ruga_mesh_as_def(&s->mesh);
    s->def.keyframes = s->key;
    s->def.handles = s->handle;
    s->length = x;
    for (int k = 0; k < 4; k++) {
        s->key[k] = ruga_default_keyframe_def();
        s->key[k].time = k * s->def.step;
    }
    for (int k = 0; k < 3; k++) {
        s->handle[k] = ruga_default_handle_def();
    }
}

// A skin of 1 mm that is 100 times stiffer than its box-filled interior. With a strain, in critical ones, the
// state starts compressed by it along x, and flat, x = Bq.
static inline void scene_sheet(small_scene* s, double length, double width, double edges, double strain) {
    const double h = 1e-3, lambda = 2 * RUGA_PI * h * cbrt(100.0 / 3), critical = 0.25 * pow(0.03, 2.0 / 3);
    *s = (small_scene){.length = 0};
    scene_mesh(s, RUGA_SHAPE_SHEET, length * lambda, width * lambda, 0, lambda / edges);
    s->def.skin.thickness = h;
    s->def.interior.young = 1e5;
    s->def.skin.young = 1e7;
    s->def.interior.motion = RUGA_INTERIOR_PRESCRIBED;
    s->def.lattice.fill = RUGA_FILL_BOX;
    s->def.lattice.cells = 3;
    s->key[1].matrix[0] = 1 - strain * critical;
    s->def.keyframe_count = 2;
    s->flat = strain > 0;
}

static inline void scene_build(small_scene* s) {
    assert_ok(ruga_model_create(&s->def, &s->model));
    assert_ok(ruga_state_create(s->model, &s->state));
    if (s->flat) {
        ruga_state* state = s->state;
        ruga_motion_at(&s->model->lattice, s->model->center, 1, s->key + 1, s->key[1].time, state->q);
        ruga_lattice_embed(&s->model->lattice, state->q, state->embedded);
        memcpy(state->x, state->embedded, (size_t)state->skin->n * sizeof *state->x);
    }
}

static inline void scene_free_state(small_scene* s) {
    ruga_state_destroy(&s->state);
    ruga_model_destroy(&s->model);
}

static inline void scene_free(small_scene* s) {
    scene_free_state(s);
    ruga_mesh_clear(&s->mesh);
}

static inline double* scene_array(int n) {
    double* a = calloc((size_t)n, sizeof *a);
    assert_non_null(a);
    return a;
}

static inline double* scene_copy(int n, const double* source) {
    double* a = scene_array(n);
    memcpy(a, source, (size_t)n * sizeof *a);
    return a;
}

// Adds uniform numbers in [-size, size].
static inline void scene_disturb(int n, double size, uint64_t seed, double* a) {
    ruga_random random = {.state = seed};
    for (int i = 0; i < n; i++) {
        a[i] += size * (2 * ruga_random_uniform(&random) - 1);
    }
}

static inline double scene_distance(int n, const double* a, const double* b) {
    double largest = 0;
    for (int i = 0; i < n; i++) {
        largest = fmax(largest, fabs(a[i] - b[i]));
    }
    return largest;
}

// ---- allocations that fail ----------------------------------------------------------------------------

static inline void* scene_allocate_while_allowed(size_t size, void* context) {
    int* allowed = context;
    return (*allowed)-- > 0 ? aligned_alloc(64, (size + 63) / 64 * 64) : NULL;
}

static inline void scene_release_block(void* memory, size_t size, void* context) {
    (void)size;
    (void)context;
    free(memory);
}

#endif
