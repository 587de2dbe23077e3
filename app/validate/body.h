// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A scene in memory, with all that its def points to.
#ifndef RUGA_APP_VALIDATE_BODY_H
#define RUGA_APP_VALIDATE_BODY_H

#include "app/measure.h"
#include "mesh/make.h"
#include "solver/state.h"
#include "view/render.h"

enum { RUGA_BODY_HANDLES = 8, RUGA_BODY_KEYS = 64 };

typedef struct ruga_body {
    ruga_mesh mesh;
    ruga_model_def def; // its mesh, handles and keyframes are those here
    ruga_handle_def handle[RUGA_BODY_HANDLES];
    ruga_keyframe_def key[RUGA_BODY_KEYS];
    ruga_model* model;
    ruga_state* state;
    ruga_measure* measure;
    ruga_measured measured; // of the last measurement
} ruga_body;

// The default def on a shape; the mesh may be changed before ruga_body_build.
ruga_status ruga_body_make(const ruga_make_def* make, ruga_body* body);
ruga_status ruga_body_build(ruga_body* body);
void ruga_body_clear(ruga_body* body);

// One step; *worst keeps the worst outcome.
ruga_status ruga_body_step(ruga_body* body, ruga_report* report, ruga_outcome* worst);
// Measures the state; its displacement w [V].
ruga_status ruga_body_measure(ruga_body* body, const double** w);

// A handle that moves a region; its ramp ends at `end` s.
ruga_handle_def ruga_moving_handle(ruga_region region, double end);
ruga_region ruga_plane_region(double x, double y, double z, double nx, double ny, double nz);

// A picture of the skin: coloured by its displacement w within +-scale m, or clay where scale is 0.
ruga_status ruga_body_picture(ruga_body* body, double azimuth, double elevation, double scale, const char* path);

#endif
