// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For tests: Miura-ori in closed form, and its creases on a mesh that knows nothing of them.
#ifndef RUGA_TESTS_MIURA_H
#define RUGA_TESTS_MIURA_H

#include "tests/crease_case.h"

#define DEGREE (RUGA_PI / 180)

// Mean of a piece's corners.
static inline void middle_of(const crease_case* c, const ruga_cut_piece* piece, double middle[3]) {
    double x[RUGA_BORDER_PLACES][3];
    ruga_raster_places(&c->raster, piece->triangle, x);
    memset(middle, 0, 3 * sizeof *middle);
    for (int k = 0; k < piece->polygon.count; k++) {
        ruga_add_scaled(1.0 / piece->polygon.count, x[piece->polygon.place[k]], middle);
    }
}

// Sides 1, angle 60 degrees, folded by theta (Schenk and Guest 2013).
static inline void miura_vertex(int i, int j, double theta, double x[3]) {
    double t = tan(60 * DEGREE), c = cos(theta), q = sqrt(1 + c * c * t * t);
    x[0] = i * c * t / q;
    x[1] = j * sqrt(1 - pow(sin(theta) * sin(60 * DEGREE), 2)) + (abs(i) % 2) / q;
    x[2] = abs(j) % 2 * sin(theta) * sin(60 * DEGREE);
}

// The panel that holds a flat point, and where it takes x.
static inline void miura_find_panel(const double middle[3], int panel[2]) {
    double side = sin(60 * DEGREE);
    panel[0] = (int)floor(middle[0] / side);
    double part = middle[0] / side - panel[0], zig = 0.5 * (abs(panel[0]) % 2 ? 1 - part : part);
    panel[1] = (int)floor(middle[1] - zig);
}

static inline void miura_fold_point(const int panel[2], double theta, const double x[3], double y[3]) {
    double flat[3][3], folded[3][3];
    for (int k = 0; k < 3; k++) {
        miura_vertex(panel[0] + (k == 1), panel[1] + (k == 2), 0, flat[k]);
        miura_vertex(panel[0] + (k == 1), panel[1] + (k == 2), theta, folded[k]);
    }
    double u = (x[0] - flat[0][0]) / (flat[1][0] - flat[0][0]);
    double v = x[1] - flat[0][1] - u * (flat[1][1] - flat[0][1]);
    for (int k = 0; k < 3; k++) {
        y[k] = folded[0][k] + u * (folded[1][k] - folded[0][k]) + v * (folded[2][k] - folded[0][k]);
    }
}

// The frame of a panel at theta: origin and three directions.
static inline void miura_panel_frame(const int panel[2], double theta, double frame[4][3]) {
    double a[3], b[3];
    miura_vertex(panel[0], panel[1], theta, frame[0]);
    miura_vertex(panel[0], panel[1] + 1, theta, a);
    miura_vertex(panel[0] + 1, panel[1], theta, b);
    ruga_subtract(a, frame[0], frame[1]);
    ruga_subtract(b, frame[0], b);
    ruga_cross(b, frame[1], frame[3]);
    ruga_normalize(frame[3]);
    ruga_normalize(frame[1]);
    ruga_cross(frame[1], frame[3], frame[2]);
}

// 5 x 5 panels, those at the border cut off by the rectangle, on n x 1.2 n squares that know nothing of them.
static inline void miura_make(int n, crease_case* c) {
    *c = (crease_case){0};
    double point[6][3], side = sin(60 * DEGREE), low[2] = {-0.6 * side, -0.47}, high[2] = {3.55 * side, 3.93};
    make_squares(n, n * 6 / 5, true, &c->mesh);
    for (int v = 0; v < c->mesh.vertex_count; v++) {
        c->mesh.position[3 * v] = low[0] + (high[0] - low[0]) * c->mesh.position[3 * v] / n;
        c->mesh.position[3 * v + 1] = low[1] + (high[1] - low[1]) * c->mesh.position[3 * v + 1] / (n * 6 / 5);
    }
    for (int i = 0; i < 4; i++) {
        add_line(&c->curves, RUGA_FREEDOM_SINGLE, i * side, -2, i * side, 6);
    }
    for (int j = 0; j < 4; j++) {
        for (int i = -1; i < 5; i++) {
            miura_vertex(i, j, 0, point[i + 1]);
        }
        const ruga_curve style = {.freedom = RUGA_FREEDOM_SINGLE};
        assert_ok(ruga_curves_add_polyline(&c->curves, &style, 6, (const double(*)[3])point));
    }
}

#endif
