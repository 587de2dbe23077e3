// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For tests of motion: a sheet with creases, and all kinds of elasticity that it may have.
#ifndef RUGA_TESTS_MOTION_H
#define RUGA_TESTS_MOTION_H

#include "solver/dynamic.h"
#include "tests/crease_case.h"

typedef struct motion {
    crease_case c;
    ruga_dynamic_def def;
    ruga_dynamic* dynamic;
    double *x, *v, *stiffness, *old;
    bool* held;
    int nodes;
} motion;

typedef enum creases { PLAIN, LINE, CROSS } creases;

static const double EDGE = 0.05; // m

// n x n squares with creases off the nodes; c->mesh may be there already.
static inline void cut_sheet(motion* m, int n, creases which, bool full) {
    const ruga_raster_def def = ruga_default_raster_def();
    ruga_crease_freedom freedom = full ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_SINGLE;
    *m = (motion){.def = ruga_default_dynamic_def()};
    make_squares(n, n, true, &m->c.mesh);
    for (int i = 0; i < 3 * m->c.mesh.vertex_count; i++) {
        m->c.mesh.position[i] *= EDGE;
    }
    if (which != PLAIN) {
        add_line(&m->c.curves, freedom, -EDGE, 0.42 * n * EDGE, (n + 1) * EDGE, 0.58 * n * EDGE);
    }
    if (which == CROSS) {
        add_line(&m->c.curves, freedom, 0.41 * n * EDGE, -EDGE, 0.6 * n * EDGE, (n + 1) * EDGE);
    }
    assert_ok(ruga_raster_create(&m->c.mesh, &m->c.curves, &def, &m->c.raster));
    assert_ok(ruga_cut_create(&m->c.raster, &m->c.cut));
    m->nodes = m->c.cut.node_count;
    m->x = calloc((size_t)m->nodes * 3, sizeof *m->x);
    m->v = calloc((size_t)m->nodes * 3, sizeof *m->v);
    m->old = calloc((size_t)m->nodes * 3, sizeof *m->old);
    m->held = calloc((size_t)m->nodes * 3, sizeof *m->held);
    m->stiffness = calloc((size_t)m->c.cut.segment_count + 1, sizeof *m->stiffness);
    ruga_cut_rest(&m->c.raster, &m->c.cut, m->x);
    m->def.elastic.raster = &m->c.raster;
    m->def.elastic.cut = &m->c.cut;
    m->def.elastic.stiffness = m->stiffness;
    m->def.elastic.skin.thickness = 1e-3;
    m->def.elastic.skin.young = 1e5;
    m->def.elastic.skin.density = 500;
    m->def.held = m->held;
}

static inline void hold(motion* m, int n, bool held) {
    m->held[3 * n] = m->held[3 * n + 1] = m->held[3 * n + 2] = held;
}

static inline void clear_motion(motion* m) {
    ruga_dynamic_destroy(&m->dynamic);
    clear_case(&m->c);
    free(m->x);
    free(m->v);
    free(m->old);
    free(m->held);
    free(m->stiffness);
}

static inline void set_stiffness(motion* m, double k) {
    for (int s = 0; s < m->c.cut.segment_count; s++) {
        m->stiffness[s] = k;
    }
}

// All kinds: shell, springs, and each style of creases, one after the other.
enum { KINDS = 6 };

static inline void choose_kind(motion* m, int kind) {
    m->def.elastic.skin.model = kind < 3 ? RUGA_SKIN_SHELL : RUGA_SKIN_SPRINGS;
    m->def.elastic.style = (ruga_crease_style)(kind % 3);
    set_stiffness(m, 0.01);
}

#endif
