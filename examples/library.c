// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
// A leather strip on foam is built in memory and compressed by 6 % in ten steps.
//     cc library.c $(pkg-config --cflags --libs ruga) -o library
#include <ruga/ruga.h>
#include <stdio.h>

enum { NX = 61, NY = 17, V = NX * NY, F = 2 * (NX - 1) * (NY - 1) }; // vertices every 4 mm

int main(void) {
    static double position[3 * V];
    static int triangle[3 * F];
    for (int v = 0, n = 0; v < V; v++) {
        position[3 * v] = 0.004 * (v % NX);
        position[3 * v + 1] = 0.004 * (v / NX);
        for (int k = 0; k < 6 && v % NX < NX - 1 && v / NX < NY - 1; k++) {
            triangle[n++] = v + (const int[]){0, 1, NX + 1, 0, NX + 1, NX}[k];
        }
    }
    ruga_keyframe_def pose[2] = {ruga_default_keyframe_def(), ruga_default_keyframe_def()};
    pose[1].time = 0.2;
    pose[1].matrix[0] = 0.94;                      // the interior's stretch along x
    ruga_model_def def = ruga_default_model_def(); // 2 mm of leather on foam
    def.mesh =
        (ruga_mesh_def){.vertex_count = V, .positions = position, .triangle_count = F, .triangles = triangle};
    def.lattice.fill = RUGA_FILL_BOX;
    def.interior.motion = RUGA_INTERIOR_PRESCRIBED;
    def.keyframe_count = 2;
    def.keyframes = pose;
    ruga_model* model = NULL;
    ruga_state* state = NULL;
    bool good = ruga_model_create(&def, &model) == RUGA_OK && ruga_state_create(model, &state) == RUGA_OK;
    for (int step = 1; step <= 10 && good; step++) {
        good = ruga_state_step(model, state, NULL) == RUGA_OK;
        printf("step %d: z = %.3f mm\n", step, 1e3 * ruga_state_positions(state)[3 * (V / 2) + 2]);
    }
    (void)fputs(good ? "" : ruga_last_error(), stderr);
    ruga_state_destroy(&state);
    ruga_model_destroy(&model);
}
