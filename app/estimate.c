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
// each. Matrices, their indices (12 bytes an entry, twice) and 30 work vectors come on top.
//
// In dynamic motion a frame is as many steps of length dt as are stable at the start. A step is a stage of
// the forces, 50 ns for each triangle of a cloth of springs and 100 ns for one of a shell, and about 5
// sqrt(kappa) products as dear of the damping's conjugate gradients, kappa = 1 + dt damping w^2 = 1 + 4 s^2
// damping / dt where dt = 2 s / w. Memory is what the state has taken.
#include "app/estimate.h"

#include "core/memory.h"
#include "ruga/ruga.h"
#include "solver/moving.h"
#include "solver/state.h"

#include <math.h>

static double skin_bytes(const ruga_model* model, double n) {
    // 3 x 3 blocks for vertices (lower half), edges, and the two far corners of each hinge.
    double entries = 6.0 * model->mesh.vertex_count + 18.0 * model->connectivity.edge_count;
    double rows = model->clusters.count > 0 ? 3.0 * model->clusters.start[model->clusters.count] : 0;
    return 24 * (entries + rows) + 8 * (320 * n + 30 * n);
}

static ruga_status estimate_motion(const ruga_model* model, ruga_estimate* e) {
    ruga_state* state = NULL;
    const double safety = ruga_default_dynamic_def().safety, damping = model->skin.damping;
    RUGA_TRY(ruga_state_create(model, &state));
    double limit = ruga_dynamic_limit(ruga_moving_dynamic(state->moving), state->x, 30);
    double steps = fmax(ceil(model->step / (safety * limit)), 1);
    double products = damping > 0 ? 5 * sqrt(1 + 4 * safety * safety * damping * steps / model->step)
                                  : (model->skin.drag > 0 ? 1 : 0);
    double stage = (model->skin.model == RUGA_SKIN_SPRINGS ? 50e-9 : 100e-9) * model->mesh.triangle_count;
    e->seconds_per_frame = steps * (1 + products) * stage;
    e->bytes = (double)ruga_byte_count();
    ruga_state_destroy(&state);
    return RUGA_OK;
}

ruga_status ruga_estimate_model(const ruga_model* model, ruga_estimate* estimate) {
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
    if (model->skin.motion == RUGA_SKIN_DYNAMIC) {
        RUGA_TRY(estimate_motion(model, &e));
    }
    *estimate = e;
    return RUGA_OK;
}
