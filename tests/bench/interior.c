// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Seconds per step of the interior alone: a block held at one end and falling under gravity, 20 ms a step,
// with 45 and with 5,000 quadratic elements; the skin follows (no wrinkles). A unit is one assembly of the
// exact stiffness and one numeric factorisation of it, timed in the same run. Arguments: steps, then "small"
// or "large" for one of them alone.
#include "core/memory.h"
#include "core/progress.h"
#include "mesh/make.h"
#include "solver/model.h"
#include "solver/state.h"
#include "tests/bench/pillow.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 200, UNITS = 5 };

static void fill(ruga_model_def* def, const ruga_mesh* mesh, int cells, ruga_handle_def* handle) {
    def->mesh = ruga_mesh_as_def(mesh);
    def->skin.thickness = 2e-3;
    def->skin.young = 1e5;
    def->interior.young = 50e3;
    def->interior.density = 60;
    def->interior.motion = RUGA_INTERIOR_DYNAMIC;
    def->lattice.cells = cells;
    def->coupling.kind = RUGA_COUPLING_NONE;
    def->coupling.foundation = false;
    def->solver.allow_coarse = true;
    def->gravity[2] = -9.81;
    *handle = ruga_default_handle_def();
    handle->region.kind = RUGA_REGION_BOX;
    for (int c = 0; c < 3; c++) {
        handle->region.min[c] = -1;
        handle->region.max[c] = c == 0 ? -0.2 : 1;
    }
    def->handle_count = 1;
    def->handles = handle;
}

// Median seconds of one assembly and one factorisation of the interior's matrix.
static ruga_status time_unit(ruga_state* state, double* assembly, double* factor) {
    ruga_interior* in = state->interior;
    double a[UNITS], f[UNITS], energy;
    for (int k = 0; k < UNITS; k++) {
        ruga_factor_info info;
        double begin = ruga_clock();
        RUGA_TRY(ruga_elasticity_energy(in->elasticity, state->q, false, &energy, NULL, in->stiffness, NULL));
        a[k] = ruga_clock() - begin;
        begin = ruga_clock();
        RUGA_TRY(ruga_factor_numeric(in->factor, in->kkt.value, &info));
        f[k] = ruga_clock() - begin;
    }
    *assembly = bench_median(UNITS, a);
    *factor = bench_median(UNITS, f);
    return RUGA_OK;
}

static ruga_status run(const double size[3], double edge, int cells, int steps) {
    ruga_status status = RUGA_OK;
    ruga_mesh mesh = {0};
    ruga_model* model = NULL;
    ruga_state* state = NULL;
    ruga_model_def def = ruga_default_model_def();
    ruga_handle_def handle;
    ruga_make_def make = {.shape = RUGA_SHAPE_BAR, .size = {size[0], size[1], size[2]}, .edge = edge};
    double seconds[MOST], assembly, factor;
    int newton = 0, factorizations = 0, linear = 0, minima = 0;
    RUGA_TRY_DONE(ruga_mesh_make(&make, &mesh));
    fill(&def, &mesh, cells, &handle);
    RUGA_TRY_DONE(ruga_model_create(&def, &model));
    RUGA_TRY_DONE(ruga_state_create(model, &state));
    for (int k = 0; k < steps; k++) {
        ruga_report report;
        RUGA_TRY_DONE(ruga_state_step(model, state, &report));
        seconds[k] = report.seconds_total;
        newton += report.newton_iterations;
        linear += report.linear_iterations;
        factorizations += report.factorizations;
        minima += report.outcome == RUGA_OUTCOME_MINIMUM;
    }
    RUGA_TRY_DONE(time_unit(state, &assembly, &factor));
    double middle = bench_median(steps, seconds), unit = assembly + factor;
    printf("%d elements, %d unknowns, %d vertices: median %.4f s a step, worst %.4f s; assembly %.4f s, "
           "factor %.4f s; "
           "per step %.1f Newton, %.1f products, %.1f factorisations; %.2f units a step, %.2f a Newton "
           "iteration; %d of %d "
           "minima\n",
           model->lattice.element_count, 3 * model->lattice.node_count, mesh.vertex_count, middle,
           seconds[steps - 1], assembly, factor, 1. * newton / steps, 1. * linear / steps,
           1. * factorizations / steps, middle / unit, middle / unit * steps / newton, minima, steps);
done:
    ruga_state_destroy(&state);
    ruga_model_destroy(&model);
    ruga_mesh_clear(&mesh);
    return status;
}

int main(int argc, char** argv) {
    int steps = argc > 1 ? atoi(argv[1]) : 20;
    steps = steps < 1 ? 1 : steps > MOST ? MOST : steps;
    const double small[3] = {0.5, 0.3, 0.3}, large[3] = {0.5, 0.4, 0.2};
    const char* only = argc > 2 ? argv[2] : "";
    ruga_status status = RUGA_OK;
    if (strcmp(only, "large") != 0) {
        status = run(small, 0.02, 5, 5 * steps > MOST ? MOST : 5 * steps);
    }
    if (status == RUGA_OK && strcmp(only, "small") != 0) {
        status = run(large, 0.01, 25, steps);
    }
    if (status != RUGA_OK) {
        (void)fprintf(stderr, "%s\n", ruga_last_error());
        return 1;
    }
    return 0;
}
