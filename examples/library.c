// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Ruga as a library: a leather strip on foam, built in memory and compressed by 6 % in ten steps.
//     cc library.c $(pkg-config --cflags --libs ruga) -o library
#include <ruga/ruga.h>

#include <stdio.h>

enum { NX = 60, NY = 16 }; // quads of 4 mm
static double positions[(NX + 1) * (NY + 1)][3];
static int triangles[2 * NX * NY][3];

int main(void) {
    for (int v = 0; v < (NX + 1) * (NY + 1); v++) {
        positions[v][0] = 0.004 * (v % (NX + 1));
        positions[v][1] = 0.004 * (v / (NX + 1));
    }
    for (int q = 0; q < NX * NY; q++) {
        int a = q / NX * (NX + 1) + q % NX, b = a + 1, c = a + NX + 1, d = c + 1;
        int two[2][3] = {{a, b, d}, {a, d, c}};
        for (int k = 0; k < 6; k++) {
            triangles[2 * q + k / 3][k % 3] = two[k / 3][k % 3];
        }
    }
    ruga_keyframe_def pose[2] = {ruga_default_keyframe_def(), ruga_default_keyframe_def()};
    pose[1].time = 0.2;
    pose[1].matrix[0] = 0.94; // the interior's stretch along x

    ruga_model_def def = ruga_default_model_def(); // 2 mm of leather on foam
    def.mesh = (ruga_mesh_def){.vertex_count = (NX + 1) * (NY + 1),
                               .positions = positions[0],
                               .triangle_count = 2 * NX * NY,
                               .triangles = triangles[0]};
    def.lattice.fill = RUGA_FILL_BOX;
    def.interior.motion = RUGA_INTERIOR_PRESCRIBED;
    def.keyframe_count = 2;
    def.keyframes = pose;

    ruga_model* model = NULL;
    ruga_state* state = NULL;
    ruga_status status = ruga_model_create(&def, &model);
    if (status == RUGA_OK) {
        status = ruga_state_create(model, &state);
    }
    for (int step = 0; step < 10 && status == RUGA_OK; step++) {
        status = ruga_state_step(model, state, NULL);
    }
    double height = 0;
    for (int v = 0; v < def.mesh.vertex_count && status == RUGA_OK; v++) {
        double z = ruga_state_positions(state)[3 * v + 2];
        height = z > height ? z : height;
    }
    printf(status == RUGA_OK ? "highest wrinkle: %.2f mm\n" : "failed\n", 1e3 * height);
    if (status != RUGA_OK) {
        fprintf(stderr, "%s\n", ruga_last_error());
    }
    ruga_state_destroy(&state);
    ruga_model_destroy(&model);
    return status == RUGA_OK ? 0 : 1;
}
