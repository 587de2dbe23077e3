// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Flat panels turned about the creases between them (crease/pose.h), then laid as near to where they were as
// they go as a whole: with X the places of the material at rest, y those of the folded one, and means over
// the area, x = X_mean + R (y - y_mean) with the rotation R that makes the integral of |x - X|^2 least, which
// is U V^T of the integral of (X - X_mean) (y - y_mean)^T = U S V^T (Kabsch 1976). Of a triangle of area A
// with corners y_i, X_i the integral of X y^T is A/12 (sum_i X_i y_i^T + (sum_i X_i) (sum_i y_i)^T): exact,
// as panels stay flat, so that the mesh has no say. What is rolled into a cone about the origin stays where
// it is folded.
#include "solver/start.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "crease/pose.h"
#include "lattice/svd3.h"

#include <string.h>

static const double MISFIT = 1e-9; // edges
static const double ROLLED = 0.25; // edges: rolled copies of one place part a little

// Area, and means of rest and folded places over the material.
static double find_means(const ruga_mesh* rest, const double* y, double mean[2][3]) {
    double area = 0;
    memset(mean, 0, 2 * sizeof *mean);
    for (int f = 0; f < rest->triangle_count; f++) {
        const int* t = rest->triangle + 3 * (size_t)f;
        double part = ruga_mesh_triangle_area(rest, f);
        area += part;
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(part / 3, rest->position + 3 * (size_t)t[i], mean[0]);
            ruga_add_scaled(part / 3, y + 3 * (size_t)t[i], mean[1]);
        }
    }
    for (int i = 0; i < 6; i++) {
        mean[i / 3][i % 3] /= area;
    }
    return area;
}

static void nearest_rotation(const ruga_mesh* rest, const double* y, const double mean[2][3],
                             double rotation[9]) {
    double f[9] = {0}, u[9], s[3], v[9];
    for (int k = 0; k < rest->triangle_count; k++) {
        const int* t = rest->triangle + 3 * (size_t)k;
        double area = ruga_mesh_triangle_area(rest, k), d[2][4][3] = {{{0}}}; // of each corner, and their sum
        for (int i = 0; i < 3; i++) {
            ruga_subtract(rest->position + 3 * (size_t)t[i], mean[0], d[0][i]);
            ruga_subtract(y + 3 * (size_t)t[i], mean[1], d[1][i]);
            ruga_add_scaled(1, d[0][i], d[0][3]);
            ruga_add_scaled(1, d[1][i], d[1][3]);
        }
        for (int i = 0; i < 4; i++) {
            for (int e = 0; e < 9; e++) {
                f[e] += area / 12 * d[0][i][e / 3] * d[1][i][e % 3];
            }
        }
    }
    ruga_svd3(f, u, s, v);
    for (int e = 0; e < 9; e++) {
        rotation[e] = 0;
        for (int j = 0; j < 3; j++) {
            rotation[e] += u[e / 3 * 3 + j] * v[e % 3 * 3 + j];
        }
    }
}

static ruga_status lay(const ruga_model* model, double* x) {
    const ruga_mesh* rest = ruga_model_shown(model);
    double *y = NULL, mean[2][3], rotation[9], moved[3];
    RUGA_TRY(RUGA_NEW(y, 3 * (size_t)rest->vertex_count));
    ruga_cut_material(&model->creases->cut, x, y);
    if (find_means(rest, y, mean) > 0) {
        nearest_rotation(rest, y, (const double(*)[3])mean, rotation);
        for (int n = 0; n < model->mesh.vertex_count; n++) {
            ruga_subtract(x + 3 * (size_t)n, mean[1], moved);
            ruga_multiply3(rotation, moved, moved);
            memcpy(x + 3 * (size_t)n, mean[0], sizeof mean[0]);
            ruga_add_scaled(1, moved, x + 3 * (size_t)n);
        }
    }
    ruga_release(y);
    return RUGA_OK;
}

static double turn_of(const ruga_model* model, int h) {
    const ruga_creases* creases = model->creases;
    return h < creases->segment_count
               ? model->start.fold * (ruga_crease_rest_at(creases, h, 0) - creases->drawn[h])
               : 0;
}

static ruga_status fold(const ruga_model* model, double* x) {
    const ruga_creases* creases = model->creases;
    double* turn = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(turn, creases->cut.segment_count));
    for (int h = 0; h < creases->segment_count; h++) {
        turn[creases->segment[h]] = turn_of(model, h);
    }
    double cone = model->start.cone, misfit = (cone > 0 ? ROLLED : MISFIT) * model->mean_edge;
    ruga_status status = ruga_cut_fold(&creases->raster, &creases->cut, turn, cone, misfit, x);
    ruga_release(turn);
    return status == RUGA_BAD_INPUT ? ruga_fail_prefix(status, "start.fold") : status;
}

ruga_status ruga_start_create(ruga_model* model) {
    const ruga_start_def* start = &model->start;
    bool folded = model->creases && start->fold != 0;
    size_t n = 3 * (size_t)model->mesh.vertex_count;
    if (!folded && !(start->cone > 0)) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_NEW(model->started, n));
    memcpy(model->started, model->mesh.position, n * sizeof *model->started);
    if (folded) {
        RUGA_TRY(fold(model, model->started));
    } else {
        ruga_roll_cone(model->mesh.vertex_count, start->cone, model->started);
    }
    return start->cone > 0 ? RUGA_OK : lay(model, model->started);
}

const double* ruga_start_shape(const ruga_model* model) {
    return model->started ? model->started : model->mesh.position;
}

void ruga_start_hinges(const ruga_model* model, ruga_hinges* hinges) {
    for (int h = 0; h < hinges->count; h++) {
        hinges->near[h] = hinges->rest[h] = model->creases->drawn[h] + turn_of(model, h);
    }
}
