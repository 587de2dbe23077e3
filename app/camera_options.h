// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The options that say where the camera stands.
#ifndef RUGA_APP_CAMERA_OPTIONS_H
#define RUGA_APP_CAMERA_OPTIONS_H

#include "app/command.h"
#include "view/render.h"

#define RUGA_CAMERA_OPTIONS                                                                                  \
    {"--camera", NULL, "PLACE",                                                                              \
     "corner, front, back, left, right, top, bottom, or azimuth,elevation such as\n"                         \
     "30deg,20deg [corner]",                                                                                 \
     false},                                                                                                 \
        {"--up", NULL, "x|y|z", "the axis that points up: x, y or z [against gravity, otherwise z]", false}, \
        {"--azimuth", NULL, "ANGLE", "where the camera stands, turned about the up axis [-63 deg]", false},  \
    {                                                                                                        \
        "--elevation", NULL, "ANGLE", "how far above the horizon the camera stands [34 deg]", false          \
    }

// Up is against a gravity along an axis; otherwise `up` stays as it is.
void ruga_camera_up(const double gravity[3], double up[3]);

// Sets what was given. `scene_text`, or NULL: its gravity says which way is up.
ruga_status ruga_camera_options(const ruga_arguments* arguments, const char* scene_text,
                                ruga_render_def* def);

#endif
