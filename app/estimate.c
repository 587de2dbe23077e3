// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// With n unknowns of the skin and its multipliers (0.9 k to 300 k unknowns were measured):
//   entries of the factor of [K H^T; H 0]    320 n
//   time of a factorisation                  0.155 s (n / 12700)^1.2
//   a frame of the static skin               14 factorisations' worth, with its solves and substeps
// and with N unknowns of the interior
//   entries of its factor                    min(N^2 / 2, 60 N^(4/3))
//   a factorisation                          entries^2 / N multiply-adds at 2e9 per second
//   a coupled frame                          4 factorisations of the interior and 6 static skins
// A dense volume is factorised section by section: entries unknowns times those of its smallest section,
// unless nested dissection (60 N^(4/3)) is less; a frame takes about 12 factorisations and 0.4 ms a cell for
// each. A skin in dynamic motion takes a part of a step for every third of an edge that a wave of its stretch
// runs, and 1 us for each vertex in it. Matrices, their indices (12 bytes an entry, twice) and 30 work
// vectors come on top.
#include "app/estimate.h"

#include <math.h>

static double skin_bytes(const ruga_model* model, double n) {
    // 3 x 3 blocks for vertices (lower half), edges, and the two far corners of each hinge.
    double entries = 6.0 * model->mesh.vertex_count + 18.0 * model->connectivity.edge_count;
    double rows = model->clusters.count > 0 ? 3.0 * model->clusters.start[model->clusters.count] : 0;
    return 24 * (entries + rows) + 8 * (320 * n + 30 * n);
}

ruga_estimate ruga_estimate_model(const ruga_model* model) {
    ruga_estimate e = {
        .skin_unknowns = 3 * (int64_t)model->mesh.vertex_count,
        .interior_unknowns = model->has_interior ? 3 * (int64_t)model->lattice.node_count : 0,
        .constraints = 3 * (int64_t)model->clusters.count + model->rows.count,
    };
    double n = (double)e.skin_unknowns + 3.0 * model->clusters.count, interior = (double)e.interior_unknowns;
    if (model->solves_skin) {
        e.seconds_per_frame = 14 * 0.155 * pow(n / 12700, 1.2);
        e.bytes = skin_bytes(model, n);
    }
    if (model->skin.motion == RUGA_SKIN_DYNAMIC) {
        double speed = sqrt(model->skin.young / fmax(model->skin.density, 1e-300));
        e.seconds_per_frame =
            ceil(3 * model->step * speed / model->mean_edge) * 1e-6 * model->mesh.vertex_count;
        e.bytes = 1000.0 * model->mesh.vertex_count;
    }
    if (model->has_interior && !ruga_model_is_prescribed(model)) {
        double entries = fmin(0.5 * interior * interior, 60 * pow(interior, 4.0 / 3));
        e.seconds_per_frame = 6 * e.seconds_per_frame + 4 * entries * entries / interior / 2e9;
        e.bytes += 8 * entries + 24 * fmin(0.5 * interior * interior, 190 * interior);
    }
    if (model->dense.volume.node_count > 0) {
        double unknowns = 3.0 * model->dense.volume.node_count;
        double section = 3.0 * model->dense.volume.axis[2].count *
                         fmin(model->dense.volume.axis[0].count, model->dense.volume.axis[1].count);
        double entries = unknowns * fmin(section, 60 * cbrt(unknowns));
        e.interior_unknowns = 3 * (int64_t)model->dense.volume.node_count;
        e.seconds_per_frame =
            12 * (entries * entries / unknowns / 2e9 + 4e-4 * model->dense.volume.element_count);
        e.bytes = 8 * entries + 48.0 * model->dense.volume.pattern.start[model->dense.volume.pattern.columns];
    }
    e.bytes += (double)model->lattice.vertex_count * model->lattice.nodes_per_element * 16;
    return e;
}
