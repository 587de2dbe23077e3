// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L
#include "app/preview.h"

#include "app/camera_options.h"
#include "app/console.h"
#include "app/frames.h"
#include "core/memory.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { WIDTH = 400, HEIGHT = 300 };

ruga_status ruga_preview_start(const char* folder, const ruga_scene* scene, ruga_preview* preview) {
    *preview = (ruga_preview){.def = ruga_default_render_def()};
    if (!folder) {
        return RUGA_OK;
    }
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
        return ruga_fail(RUGA_BAD_INPUT, "--preview: the folder %s cannot be made: %s", folder,
                         strerror(errno));
    }
    size_t size = strlen(folder) + 32;
    RUGA_TRY(RUGA_NEW(preview->pattern, size));
    (void)snprintf(preview->pattern, size, "%s/frame_%%04d.png", folder);
    ruga_status status = ruga_check_output(preview->pattern);
    if (status != RUGA_OK) {
        ruga_preview_clear(preview);
        return status;
    }
    preview->def.width = WIDTH;
    preview->def.height = HEIGHT;
    preview->def.fit = 0.75; // room for what comes
    ruga_camera_up(scene->def.gravity, preview->def.up);
    return RUGA_OK;
}

ruga_status ruga_preview_frame(ruga_preview* preview, const ruga_mesh* mesh, int frame,
                               const double* position) {
    char* path = NULL;
    if (!preview->pattern) {
        return RUGA_OK;
    }
    ruga_extent_add(&preview->extent, mesh->vertex_count, position);
    preview->def.extent = &preview->extent;
    RUGA_TRY(ruga_frame_path(preview->pattern, frame, &path));
    ruga_status status = ruga_render_png(mesh, position, &preview->def, path);
    ruga_release(path);
    return status;
}

void ruga_preview_clear(ruga_preview* preview) {
    ruga_release(preview->pattern);
    preview->pattern = NULL;
}
