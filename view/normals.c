// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "view/normals.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

// The faces around each vertex: those of vertex v at face[start[v]] .. face[start[v + 1]].
typedef struct fans {
    int *start, *face;
    int* part; // of each such face: those that hang together around the vertex without a crease between them
} fans;

static ruga_status build_fans(const ruga_mesh* mesh, fans* fans) {
    const int* t = mesh->triangle;
    size_t corners = 3 * (size_t)mesh->triangle_count;
    RUGA_TRY(RUGA_NEW_ZERO(fans->start, mesh->vertex_count + 2));
    RUGA_TRY(RUGA_NEW(fans->face, corners));
    RUGA_TRY(RUGA_NEW_ZERO(fans->part, corners));
    for (size_t c = 0; c < corners; c++) {
        fans->start[t[c] + 2]++;
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        fans->start[v + 2] += fans->start[v + 1];
    }
    for (size_t c = 0; c < corners; c++) {
        fans->face[fans->start[t[c] + 1]++] = (int)(c / 3);
    }
    return RUGA_OK;
}

// Whether two faces share an edge at vertex v that is no crease.
static bool hang_together(const ruga_mesh* mesh, const int* line, int a, int b, int v) {
    for (int i = 0; i < 9; i++) {
        int ka = i / 3, kb = i % 3;
        const int *ta = mesh->triangle + 3 * (size_t)a, *tb = mesh->triangle + 3 * (size_t)b;
        bool same = ta[ka] == tb[(kb + 1) % 3] && ta[(ka + 1) % 3] == tb[kb];
        if (same && (ta[ka] == v || tb[kb] == v) && line[3 * (size_t)a + (size_t)ka] < 0 &&
            line[3 * (size_t)b + (size_t)kb] < 0) {
            return true;
        }
    }
    return false;
}

// The parts of the fans, each named after the least place in it.
static void part_fans(const ruga_mesh* mesh, const int* line, fans* fans) {
    for (int v = 0; v < mesh->vertex_count && line; v++) {
        int begin = fans->start[v], end = fans->start[v + 1];
        for (int k = begin; k < end; k++) {
            fans->part[k] = k;
        }
        for (bool changed = true; changed;) {
            changed = false;
            for (int i = begin; i < end; i++) {
                for (int j = begin; j < end; j++) {
                    if (fans->part[j] < fans->part[i] &&
                        hang_together(mesh, line, fans->face[i], fans->face[j], v)) {
                        fans->part[i] = fans->part[j];
                        changed = true;
                    }
                }
            }
        }
    }
}

// Mean of the faces in the fan's part that are within 50 degrees of the one at place `own`, so that sharp
// rims stay sharp and all else is smooth.
static void corner_normal(const fans* fans, const double* flat, int v, int own, double n[3]) {
    const double* mine = flat + 3 * (size_t)fans->face[own];
    for (int k = fans->start[v]; k < fans->start[v + 1]; k++) {
        const double* other = flat + 3 * (size_t)fans->face[k];
        if (fans->part[k] == fans->part[own] &&
            ruga_dot(mine, other) >= cos(50 * RUGA_PI / 180) * ruga_norm(mine) * ruga_norm(other)) {
            ruga_add_scaled(1, other, n);
        }
    }
    (void)ruga_normalize(n);
}

ruga_status ruga_corner_normals(const ruga_mesh* mesh, const double* position, const int* line,
                                double* normal) {
    ruga_status status = RUGA_OK;
    fans fans = {NULL, NULL, NULL};
    const int* t = mesh->triangle;
    double* flat = NULL;
    RUGA_TRY_DONE(build_fans(mesh, &fans));
    RUGA_TRY_DONE(RUGA_NEW(flat, 3 * (size_t)mesh->triangle_count));
    memset(normal, 0, 9 * (size_t)mesh->triangle_count * sizeof *normal);
    for (int f = 0; f < mesh->triangle_count; f++) {
        const int* corner = t + 3 * (size_t)f;
        ruga_triangle_normal(position + 3 * (size_t)corner[0], position + 3 * (size_t)corner[1],
                             position + 3 * (size_t)corner[2], flat + 3 * (size_t)f);
    }
    part_fans(mesh, line, &fans);
    for (int v = 0; v < mesh->vertex_count; v++) {
        for (int k = fans.start[v]; k < fans.start[v + 1]; k++) {
            const int* corner = t + 3 * (size_t)fans.face[k];
            int i = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
            corner_normal(&fans, flat, v, k, normal + 9 * (size_t)fans.face[k] + 3 * (size_t)i);
        }
    }
done:
    ruga_release(fans.start);
    ruga_release(fans.face);
    ruga_release(fans.part);
    ruga_release(flat);
    return status;
}
