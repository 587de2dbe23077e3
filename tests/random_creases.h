// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For tests: seeded random meshes with random curves on them.
#ifndef RUGA_TESTS_RANDOM_CREASES_H
#define RUGA_TESTS_RANDOM_CREASES_H

#include "tests/crease_case.h"

static inline double uniform(ruga_random* random, double a, double b) {
    return a + (b - a) * ruga_random_uniform(random);
}

// A sheet of uneven triangles, flat or bumpy.
static inline void random_mesh(ruga_random* random, double size[2], ruga_mesh* mesh) {
    int nx = 3 + (int)uniform(random, 0, 8), ny = 3 + (int)uniform(random, 0, 8);
    double jitter = uniform(random, 0, 0.3), bump = uniform(random, 0, 1) < 0.3 ? uniform(random, 0, 0.3) : 0;
    make_squares(nx, ny, uniform(random, 0, 1) < 0.5, mesh);
    for (int v = 0; v < mesh->vertex_count; v++) {
        double* x = mesh->position + 3 * v;
        bool inner = x[0] > 0.5 && x[0] < nx - 0.5 && x[1] > 0.5 && x[1] < ny - 0.5;
        for (int i = 0; i < 2; i++) {
            x[i] += inner ? jitter * uniform(random, -1, 1) : 0;
        }
        x[2] = bump * sin(x[0]) * cos(0.7 * x[1]);
    }
    size[0] = nx;
    size[1] = ny;
}

// Straight and broken lines, arcs and rings, some of them over the border.
static inline void random_curves(ruga_random* random, const double size[2], ruga_curves* curves) {
    int count = 1 + (int)uniform(random, 0, 4);
    for (int c = 0; c < count; c++) {
        double point[12][3] = {{0}};
        bool closed = uniform(random, 0, 1) < 0.2, smooth = closed || uniform(random, 0, 1) < 0.3;
        int points = smooth ? 12 : 2 + (int)uniform(random, 0, 4);
        double at[2] = {uniform(random, 0.2, 0.8), uniform(random, 0.2, 0.8)};
        double r = uniform(random, 0.1, 0.45), turn = uniform(random, 0, 6);
        for (int k = 0; k < points; k++) {
            for (int i = 0; i < 2; i++) {
                double angle = turn + 2 * RUGA_PI * k / points * (closed ? 1 : 0.4);
                double place =
                    smooth ? at[i] + r * (i ? sin(angle) : cos(angle)) : uniform(random, -0.1, 1.1);
                point[k][i] = size[i] * (k == 0 && !smooth ? at[i] : place);
            }
        }
        const ruga_curve style = {
            .closed = closed, .label = c, .freedom = (ruga_crease_freedom)(uniform(random, 0, 3))};
        assert_ok(ruga_curves_add_polyline(curves, &style, points, (const double(*)[3])point));
    }
}

#endif
