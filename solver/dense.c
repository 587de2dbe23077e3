// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "solver/dense.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

enum { SKIN_LAYERS = 2, LAYERS_MAX = 400 };

// The factor by which cells grow downwards is at most this.
static const double GROWTH = 1.35;

// ---- checks --------------------------------------------------------------------------------------------

static ruga_status check_motion(const ruga_model_def* def) {
    if (!def->has_interior || def->interior.motion != RUGA_INTERIOR_PRESCRIBED) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.model: volume needs interior.motion: prescribed");
    }
    if (def->follow.sample_count > 0) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.model: volume follows keyframes only, not a moving surface");
    }
    for (int k = 0; k < def->keyframe_count; k++) {
        const ruga_keyframe_def* key = &def->keyframes[k];
        double off = 0, least = 1;
        for (int i = 0; i < 9; i++) {
            off = fmax(off, i % 4 ? fabs(key->matrix[i]) : 0);
            least = i % 4 ? least : fmin(least, key->matrix[i]);
        }
        if (off > 0 || !(least > 0) || key->has_bump) {
            return ruga_fail(
                RUGA_BAD_INPUT,
                "prescribed.%d: with skin.model: volume a keyframe is a stretch along x, y and z (and a "
                "translation), without shear, rotation or bump",
                k);
        }
    }
    return RUGA_OK;
}

ruga_status ruga_dense_check(const ruga_model_def* def) {
    if (def->skin.model != RUGA_SKIN_VOLUME) {
        return RUGA_OK;
    }
    RUGA_TRY(check_motion(def));
    if (def->lattice.fill != RUGA_FILL_BOX) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "skin.model: volume needs lattice.fill: box, the box under a flat sheet");
    }
    if (def->handle_count > 0 || ruga_norm(def->gravity) > 0) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.model: volume knows no handles and no gravity: remove them");
    }
    if (def->skin.motion != RUGA_SKIN_STATIC || def->skin.growth[0] != 1 || def->skin.growth[1] != 1) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "skin.model: volume knows skin.motion: static and skin.growth: [1, 1] only");
    }
    return RUGA_OK;
}

static ruga_status check_sheet(const ruga_mesh* mesh, const double min[3], const double max[3]) {
    double area = 0, box = (max[0] - min[0]) * (max[1] - min[1]),
           size = fmax(max[0] - min[0], max[1] - min[1]);
    bool up = max[2] - min[2] <= 1e-9 * size;
    for (int f = 0; f < mesh->triangle_count; f++) {
        double n[3];
        ruga_mesh_triangle_normal(mesh, f, n);
        area += 0.5 * n[2];
        up = up && n[2] > 0;
    }
    if (!up || fabs(area - box) > 1e-6 * box) {
        return ruga_fail(RUGA_BAD_MESH,
                         "skin.model: volume needs a flat sheet in a plane of z with normals along +z whose "
                         "outline is a rectangle along x and y; this mesh is none");
    }
    return RUGA_OK;
}

// ---- building ------------------------------------------------------------------------------------------

double ruga_dense_side(const ruga_mesh* mesh) {
    double min[3], max[3];
    ruga_mesh_bounds(mesh, min, max);
    return fmax(max[0] - min[0], max[1] - min[1]);
}

static ruga_status hold(ruga_dense* dense) {
    const ruga_spline* s = dense->volume.axis;
    RUGA_TRY(RUGA_NEW(dense->held, 3 * (size_t)dense->volume.node_count));
    for (int i = 0; i < dense->volume.node_count; i++) {
        int x = i % s[0].count, y = i / s[0].count % s[1].count, z = i / s[0].count / s[1].count;
        dense->held[3 * i] = x == 0 || x == s[0].count - 1 || z == 0;
        dense->held[3 * i + 1] = y == 0 || y == s[1].count - 1 || z == 0;
        dense->held[3 * i + 2] = z == 0;
    }
    return RUGA_OK;
}

ruga_status ruga_dense_create(const ruga_mesh* mesh, const ruga_dense_def* def, ruga_dense* dense) {
    double min[3], max[3], grid[LAYERS_MAX + 1], h = def->skin->thickness, first = h / SKIN_LAYERS;
    *dense = (ruga_dense){.middle = 0.5 * h};
    ruga_mesh_bounds(mesh, min, max);
    RUGA_TRY(check_sheet(mesh, min, max));
    double cell = ruga_dense_side(mesh) / def->cells;
    double layers = ceil(log(1 + (GROWTH - 1) * fmax(def->depth, first) / first) / log(GROWTH));
    if (layers > LAYERS_MAX - SKIN_LAYERS) {
        return ruga_fail(RUGA_BAD_INPUT, "lattice.depth: %g m below a skin of %g m take too many layers",
                         def->depth, h);
    }
    ruga_volume_grade(fmax(def->depth, first), first, (int)layers, h, SKIN_LAYERS, grid);
    ruga_volume_def d = {.degree = def->degree,
                         .size = {max[0] - min[0], max[1] - min[1]},
                         .layers = (int)layers + SKIN_LAYERS,
                         .depth = grid,
                         .interface = (int)layers,
                         .young = {def->interior->young, def->skin->young},
                         .poisson = {def->interior->poisson, def->skin->poisson}};
    for (int i = 0; i < 2; i++) {
        d.cells[i] = (int)fmax(1, round(d.size[i] / cell));
        dense->origin[i] = min[i];
    }
    dense->origin[2] = 0.5 * (min[2] + max[2]) - dense->middle;
    ruga_status status = ruga_volume_create(&d, &dense->volume);
    status = status == RUGA_OK ? hold(dense) : status;
    if (status != RUGA_OK) {
        ruga_dense_clear(dense);
    }
    return status;
}

void ruga_dense_clear(ruga_dense* dense) {
    ruga_volume_clear(&dense->volume);
    ruga_release(dense->held);
    *dense = (ruga_dense){0};
}

// ---- solving -------------------------------------------------------------------------------------------

ruga_status ruga_dense_solve(const ruga_dense* dense, ruga_volume_solver* solver, const double stretch[3],
                             const double shift[3], double tolerance, double* deviation, double* displacement,
                             ruga_volume_report* report) {
    for (int pass = 0; pass < 2; pass++) {
        for (int a = 0; a < dense->volume.node_count; a++) {
            double X[3];
            ruga_volume_node(&dense->volume, a, X);
            for (int i = 0; i < 3; i++) {
                double carried = (stretch[i] - 1) * (X[i] + dense->origin[i]) + shift[i];
                if (pass == 0) {
                    displacement[3 * a + i] = carried + deviation[3 * a + i];
                } else {
                    deviation[3 * a + i] = displacement[3 * a + i] - carried;
                }
            }
        }
        if (pass == 0) {
            RUGA_TRY(ruga_volume_solve(solver, tolerance, displacement, report));
        }
    }
    return RUGA_OK;
}

void ruga_dense_surface(const ruga_dense* dense, const ruga_mesh* mesh, const double* displacement,
                        double* x) {
    for (int v = 0; v < mesh->vertex_count; v++) {
        const double* p = &mesh->position[3 * (size_t)v];
        double X[3] = {p[0] - dense->origin[0], p[1] - dense->origin[1], dense->middle}, d[3];
        ruga_volume_displacement(&dense->volume, displacement, X, d);
        for (int i = 0; i < 3; i++) {
            x[3 * v + i] = p[i] + d[i];
        }
    }
}
