// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Small pictures of a run while it goes on.
#ifndef RUGA_APP_PREVIEW_H
#define RUGA_APP_PREVIEW_H

#include "io/scene.h"
#include "view/render.h"

typedef struct ruga_preview {
    char* pattern; // NULL = no previews
    ruga_render_def def;
    ruga_extent extent;
} ruga_preview;

// Makes the folder where it is not there; NULL = no previews. RUGA_BAD_INPUT or RUGA_IO where it cannot be.
ruga_status ruga_preview_start(const char* folder, const ruga_scene* scene, ruga_preview* preview);
// frame_0007.png: all frames from the same place, which moves back where the skin leaves the picture.
ruga_status ruga_preview_frame(ruga_preview* preview, const ruga_mesh* mesh, int frame,
                               const double* position);
void ruga_preview_clear(ruga_preview* preview);

#endif
