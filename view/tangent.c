// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The standard of Mikkelsen (2008, Simulation of wrinkled surfaces revisited; "MikkTSpace"), from its
// definition:
//   a triangle's tangent is the direction in which u grows, dp/du;
//   a corner's is the sum, over the triangles at its vertex that share its uv and its orientation in the
//   texture, of their tangents projected across the vertex' normal and made unit, each weighted by the
//   triangle's angle at the vertex between its edges projected likewise; made unit at the end; the bitangent
//   is sign (n x t), sign = +1 where the triangle has the same orientation in the texture.
// A renderer interpolates n and t over the triangle and does not make them unit again.
#include "view/tangent.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

typedef struct job {
    const ruga_mesh* mesh;
    const double *position, *normal;
    double* along; // [F][3] unit, of each triangle; zero where the texture has no area
    double* part;  // [F][3][3] projected, of angle's length
    signed char* sign;
    int *start, *corner; // corners around each vertex
    double* tangent;
} job;

static void project(const double n[3], const double v[3], double across[3]) {
    memcpy(across, v, 3 * sizeof *across);
    ruga_add_scaled(-ruga_dot(n, v), n, across);
    ruga_normalize(across);
}

// dp/du is along t2.v d1 - t1.v d2, reversed where the texture is mirrored.
static void find_direction(job* j, size_t f) {
    const int *v = j->mesh->triangle + 3 * f, *u = j->mesh->uv_triangle + 3 * f;
    const double* uv[3];
    double d[2][3], area;
    for (int i = 0; i < 3; i++) {
        uv[i] = j->mesh->uv + 2 * (size_t)u[i];
    }
    for (int i = 0; i < 2; i++) {
        ruga_subtract(j->position + 3 * (size_t)v[i + 1], j->position + 3 * (size_t)v[0], d[i]);
    }
    area = (uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) - (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0]);
    double* along = j->along + 3 * f;
    j->sign[f] = area < 0 ? -1 : 1;
    along[0] = along[1] = along[2] = 0;
    if (area != 0) {
        ruga_add_scaled(j->sign[f] * (uv[2][1] - uv[0][1]), d[0], along);
        ruga_add_scaled(-j->sign[f] * (uv[1][1] - uv[0][1]), d[1], along);
        ruga_normalize(along);
    }
}

static void find_part(job* j, size_t f, size_t i) {
    const int* v = j->mesh->triangle + 3 * f;
    const double* n = j->normal + 3 * (size_t)v[i];
    double edge[2][3], *part = j->part + 9 * f + 3 * i;
    for (size_t k = 0; k < 2; k++) {
        ruga_subtract(j->position + 3 * (size_t)v[(i + 1 + k) % 3], j->position + 3 * (size_t)v[i], edge[k]);
        project(n, edge[k], edge[k]);
    }
    project(n, j->along + 3 * f, part);
    double angle = acos(fmax(-1, fmin(1, ruga_dot(edge[0], edge[1]))));
    for (int k = 0; k < 3; k++) {
        part[k] *= angle;
    }
}

static void list_corners(job* j) {
    const ruga_mesh* mesh = j->mesh;
    for (int c = 0; c < 3 * mesh->triangle_count; c++) {
        j->start[mesh->triangle[c] + 2]++;
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        j->start[v + 2] += j->start[v + 1];
    }
    for (int c = 0; c < 3 * mesh->triangle_count; c++) {
        j->corner[j->start[mesh->triangle[c] + 1]++] = c;
    }
}

// Any direction across n, where the texture gives none.
static void choose_direction(const double n[3], double t[3]) {
    const double axis[3] = {fabs(n[0]) <= 0.6, fabs(n[0]) > 0.6, 0};
    project(n, axis, t);
}

static void add_parts(job* j, int c) {
    const int v = j->mesh->triangle[c], u = j->mesh->uv_triangle[c];
    double* t = j->tangent + 3 * (size_t)c;
    t[0] = t[1] = t[2] = 0;
    for (int k = j->start[v]; k < j->start[v + 1]; k++) {
        int other = j->corner[k];
        if (j->mesh->uv_triangle[other] == u && j->sign[other / 3] == j->sign[c / 3]) {
            ruga_add_scaled(1, j->part + 3 * (size_t)other, t);
        }
    }
    if (!(ruga_normalize(t) > 0)) {
        choose_direction(j->normal + 3 * (size_t)v, t);
    }
}

static ruga_status prepare(job* j) {
    size_t faces = (size_t)j->mesh->triangle_count;
    RUGA_TRY(RUGA_NEW(j->along, 3 * faces));
    RUGA_TRY(RUGA_NEW(j->part, 9 * faces));
    RUGA_TRY(RUGA_NEW(j->sign, faces));
    RUGA_TRY(RUGA_NEW(j->tangent, 9 * faces));
    RUGA_TRY(RUGA_NEW_ZERO(j->start, (size_t)j->mesh->vertex_count + 2));
    return RUGA_NEW(j->corner, 3 * faces);
}

ruga_status ruga_tangents_create(const ruga_mesh* mesh, const double* position, const double* normal,
                                 double** tangent, signed char** sign) {
    job j = {.mesh = mesh, .position = position, .normal = normal};
    ruga_status status = prepare(&j);
    if (status == RUGA_OK) {
        list_corners(&j);
        for (size_t f = 0; f < (size_t)mesh->triangle_count; f++) {
            find_direction(&j, f);
            for (size_t i = 0; i < 3; i++) {
                find_part(&j, f, i);
            }
        }
        for (int c = 0; c < 3 * mesh->triangle_count; c++) {
            add_parts(&j, c);
        }
    } else {
        ruga_release(j.tangent);
        ruga_release(j.sign);
        j.tangent = NULL;
        j.sign = NULL;
    }
    *tangent = j.tangent;
    *sign = j.sign;
    ruga_release(j.along);
    ruga_release(j.part);
    ruga_release(j.start);
    ruga_release(j.corner);
    return status;
}
