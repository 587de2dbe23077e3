// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/body.h"

ruga_status ruga_body_make(const ruga_make_def* make, ruga_body* body) {
    *body = (ruga_body){.def = ruga_default_model_def()};
    for (int k = 0; k < RUGA_BODY_HANDLES; k++) {
        body->handle[k] = ruga_default_handle_def();
    }
    for (int k = 0; k < RUGA_BODY_KEYS; k++) {
        body->key[k] = ruga_default_keyframe_def();
        body->key[k].time = k * body->def.step;
    }
    return ruga_mesh_make(make, &body->mesh);
}

ruga_status ruga_body_build(ruga_body* body) {
    body->def.mesh = ruga_mesh_as_def(&body->mesh);
    body->def.handles = body->handle;
    body->def.keyframes = body->key;
    RUGA_TRY(ruga_model_create(&body->def, &body->model));
    RUGA_TRY(ruga_state_create(body->model, &body->state));
    return ruga_measure_create(&body->mesh, ruga_model_wavelength(body->model), 1, &body->measure);
}

void ruga_body_clear(ruga_body* body) {
    ruga_measure_destroy(&body->measure);
    ruga_state_destroy(&body->state);
    ruga_model_destroy(&body->model);
    ruga_mesh_clear(&body->mesh);
}

ruga_status ruga_body_step(ruga_body* body, ruga_report* report, ruga_outcome* worst) {
    ruga_report unused, *out = report ? report : &unused;
    RUGA_TRY(ruga_state_step(body->model, body->state, out));
    if (worst && out->outcome > *worst) {
        *worst = out->outcome;
    }
    return RUGA_OK;
}

ruga_status ruga_body_measure(ruga_body* body, const double** w) {
    RUGA_TRY(ruga_measure_frame(body->measure, ruga_state_positions(body->state), ruga_state_embedded(body->state),
                                &body->measured));
    if (w) {
        *w = ruga_measure_displacement(body->measure);
    }
    return RUGA_OK;
}

ruga_handle_def ruga_moving_handle(ruga_region region, double end) {
    ruga_handle_def handle = ruga_default_handle_def();
    handle.kind = RUGA_HANDLE_MOVE;
    handle.region = region;
    handle.ramped = true;
    handle.during[1] = end;
    return handle;
}

ruga_region ruga_plane_region(double x, double y, double z, double nx, double ny, double nz) {
    return (ruga_region){.kind = RUGA_REGION_PLANE, .center = {x, y, z}, .normal = {nx, ny, nz}};
}

ruga_status ruga_body_picture(ruga_body* body, double azimuth, double elevation, double scale, const char* path) {
    ruga_render_def def = ruga_default_render_def();
    def.width = 720;
    def.height = 504;
    def.samples = 4;
    def.azimuth = azimuth;
    def.elevation = elevation;
    if (scale > 0) {
        RUGA_TRY(ruga_body_measure(body, &def.scalar.value));
        def.scalar.min = -scale;
        def.scalar.max = scale;
        def.scalar.name = "displacement, mm";
        def.scalar.unit = 1e-3;
    }
    return ruga_render_png(&body->mesh, ruga_state_positions(body->state), &def, path);
}
