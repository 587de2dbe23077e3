// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Azimuth 0 looks from +x, 90 degrees from +y, where z is up; with another axis up, from the axes that follow
// it.
#include "app/camera_options.h"

#include "core/vec3.h"
#include "io/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double DEGREE = RUGA_PI / 180;

void ruga_camera_up(const double gravity[3], double up[3]) {
    for (int axis = 0; axis < 3; axis++) {
        if (fabs(gravity[axis]) > 0.9 * ruga_norm(gravity)) {
            for (int k = 0; k < 3; k++) {
                up[k] = k != axis ? 0 : gravity[k] < 0 ? 1 : -1;
            }
        }
    }
}

static ruga_status read_pair(const char* text, ruga_render_def* def) {
    char first[64];
    const char* comma = strchr(text, ',');
    size_t length = comma ? (size_t)(comma - text) : 0;
    if (!comma || length >= sizeof first) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "--camera: %s is neither corner, front, back, left, right, top or bottom, nor "
                         "azimuth,elevation such as 30deg,20deg",
                         text);
    }
    (void)snprintf(first, sizeof first, "%.*s", (int)length, text);
    ruga_status status = ruga_quantity_parse(first, "rad", &def->azimuth);
    status = status == RUGA_OK ? ruga_quantity_parse(comma + 1, "rad", &def->elevation) : status;
    return status == RUGA_OK ? status : ruga_fail_prefix(status, "--camera");
}

static ruga_status read_camera(const char* text, ruga_render_def* def) {
    // Front is where y is least, or z greatest where y is up: azimuths from the axis that east is
    // (view/camera.c).
    static const struct {
        const char* name;
        double azimuth, elevation; // degrees
    } places[] = {{"corner", -63, 34}, {"front", -90, 12}, {"back", 90, 12},    {"left", 180, 12},
                  {"right", 0, 12},    {"top", -90, 90},   {"bottom", -90, -90}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        if (strcmp(text, places[i].name) == 0) {
            def->azimuth = places[i].azimuth * DEGREE;
            def->elevation = places[i].elevation * DEGREE;
            return RUGA_OK;
        }
    }
    return read_pair(text, def);
}

ruga_status ruga_camera_options(const ruga_arguments* arguments, const char* scene_text,
                                ruga_render_def* def) {
    ruga_scene scene;
    if (scene_text && ruga_scene_read_settings(scene_text, "scene", &scene) == RUGA_OK) {
        ruga_camera_up(scene.def.gravity, def->up);
        ruga_scene_clear(&scene);
    }
    int up = -1;
    RUGA_TRY(ruga_option_choice(arguments, "--up", "x|y|z", &up));
    for (int k = 0; k < 3 && up >= 0; k++) {
        def->up[k] = k == up;
    }
    const char* camera = ruga_value(arguments, "--camera");
    if (camera) {
        RUGA_TRY(read_camera(camera, def));
    }
    RUGA_TRY(ruga_quantity(arguments, "--azimuth", "rad", &def->azimuth));
    RUGA_TRY(ruga_quantity(arguments, "--elevation", "rad", &def->elevation));
    if (!(fabs(def->elevation) <= 90.001 * DEGREE)) {
        return ruga_fail(RUGA_BAD_INPUT, "the camera's elevation, %g deg, is not between -90 and 90 deg",
                         def->elevation / DEGREE);
    }
    return RUGA_OK;
}
