// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "ruga/types.h"
#include "solver/model.h"

#include <math.h>

ruga_handle_def ruga_default_handle_def(void) {
    return (ruga_handle_def){
        .region = {.kind = RUGA_REGION_ALL},
        .kind = RUGA_HANDLE_FIX,
        .axes = {true, true, true},
        .hold = RUGA_HOLD_BOTH,
    };
}

ruga_keyframe_def ruga_default_keyframe_def(void) {
    return (ruga_keyframe_def){.matrix = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .bump_direction = {0, 0, -1}};
}

ruga_crease_def ruga_default_crease_def(void) {
    return (ruga_crease_def){.yield = INFINITY, .rate = INFINITY};
}

// The couch of the 2013 paper, section 4.1: leather of 2 mm and 40 MPa on foam of 0.5 MPa.
ruga_model_def ruga_default_model_def(void) {
    return (ruga_model_def){
        .skin = {.thickness = 2e-3,
                 .young = 40e6,
                 .poisson = 0.3,
                 .density = 900,
                 .membrane = RUGA_MEMBRANE_BARAFF_WITKIN,
                 .growth = {1, 1},
                 .motion = RUGA_SKIN_STATIC,
                 .relaxation = 20e-3},
        .has_interior = true,
        .interior = {.young = 0.5e6,
                     .poisson = 0.3,
                     .density = 60,
                     .damping = 0,
                     .motion = RUGA_INTERIOR_DYNAMIC},
        .lattice = {.cells = 6, .degree = 2, .fill = RUGA_FILL_MESH, .depth = 0},
        .coupling = {.kind = RUGA_COUPLING_CLUSTERS, .rule = RUGA_RULE_CALIBRATED, .foundation = true},
        .follow = {.smoothness = 1e-4},
        .step = 20e-3,
        .frames = 50,
        .solver = {.method = RUGA_METHOD_DEFAULT,
                   .linear = RUGA_LINEAR_DIRECT,
                   .tolerance = 1e-5,
                   .seed = 1,
                   .allow_coarse = false},
        .cookie = RUGA_MODEL_COOKIE,
    };
}
