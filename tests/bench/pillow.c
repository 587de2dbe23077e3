// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/bench/pillow.h"

#include "mesh/make.h"

#include <math.h>
#include <stdlib.h>

ruga_status bench_pillow_mesh(int unknowns, ruga_mesh* mesh) {
    double low = 1e-3, high = 0.2;
    for (int k = 0; k < 24; k++) {
        double edge = sqrt(low * high);
        ruga_make_def make = {.shape = RUGA_SHAPE_PILLOW, .size = {0.5, 0.5, 0.16}, .edge = edge};
        ruga_mesh_clear(mesh);
        RUGA_TRY(ruga_mesh_make(&make, mesh));
        if (3 * mesh->vertex_count > unknowns) {
            low = edge;
        } else {
            high = edge;
        }
        if (abs(3 * mesh->vertex_count - unknowns) < unknowns / 50) {
            break;
        }
    }
    return RUGA_OK;
}

void bench_pillow_def(const ruga_mesh* mesh, ruga_model_def* def) {
    def->mesh = ruga_mesh_as_def(mesh);
    def->skin.thickness = 0.7e-3;
    def->skin.young = 500e6;
    def->interior.young = 50e3;
    def->interior.motion = RUGA_INTERIOR_PRESCRIBED;
    def->lattice.cells = 5;
    def->solver.allow_coarse = true;
}

void bench_pillow_motion(ruga_model_def* def, int warm, int frames, ruga_keyframe_def keys[3]) {
    for (int k = 0; k < 3; k++) {
        keys[k] = ruga_default_keyframe_def();
        keys[k].has_bump = true;
        keys[k].bump_center[2] = 0.08;
        keys[k].bump_radius = 0.06;
    }
    keys[1].time = warm * def->step;
    keys[1].matrix[0] = 0.99;
    keys[2].time = (warm + frames) * def->step;
    keys[2].matrix[0] = 0.99 - 0.002 * frames;
    keys[2].bump_depth = 1e-3 * frames;
    def->keyframes = keys;
    def->keyframe_count = 3;
    def->frames = warm + frames;
}

static int compare(const void* a, const void* b) {
    double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

double bench_median(int count, double* values) {
    qsort(values, (size_t)count, sizeof *values, compare);
    return count ? 0.5 * (values[(count - 1) / 2] + values[count / 2]) : 0;
}
