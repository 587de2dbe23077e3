// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Cost of a step of cloth with creases, in CPU time of one core: the two pleated skirts of Patkar, Jin and
// Fedkiw (2015), section 8, as plane sectors with radial creases. Stages are the elastic forces and each
// product of the implicit damping. Then the step and the cost of a second of a sheet with one straight
// crease, `offset` of an edge away from a row of nodes, and of a mesh that conforms to it.
//     bench_cloth [STEPS]
#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/make.h"
#include "ruga/ruga.h"
#include "solver/dynamic.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double cpu_seconds(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

typedef struct cloth {
    ruga_mesh mesh;
    ruga_curves curves;
    ruga_raster raster;
    ruga_cut cut;
    ruga_dynamic* dynamic;
    bool* held;
    double *x, *v;
} cloth;

static void clear(cloth* c) {
    ruga_dynamic_destroy(&c->dynamic);
    ruga_mesh_clear(&c->mesh);
    ruga_curves_clear(&c->curves);
    ruga_raster_clear(&c->raster);
    ruga_cut_clear(&c->cut);
    ruga_release(c->held);
    ruga_release(c->x);
    ruga_release(c->v);
}

static ruga_status add_line(cloth* c, ruga_crease_freedom freedom, double x0, double y0, double x1,
                            double y1) {
    const double point[2][3] = {{x0, y0, 0}, {x1, y1, 0}};
    const ruga_curve style = {.freedom = freedom};
    return ruga_curves_add_polyline(&c->curves, &style, 2, point);
}

// The mesh with its curves in motion: the edge at x = 0 or the inner rim held.
static ruga_status start(cloth* c, const ruga_raster_def* def, ruga_skin_model model, double damping,
                         double* stitching) {
    ruga_dynamic_def dynamic = ruga_default_dynamic_def();
    RUGA_TRY(ruga_raster_create(&c->mesh, &c->curves, def, &c->raster));
    RUGA_TRY(ruga_cut_create(&c->raster, &c->cut));
    size_t nodes = (size_t)c->cut.node_count;
    RUGA_TRY(RUGA_NEW(c->x, 3 * nodes));
    RUGA_TRY(RUGA_NEW_ZERO(c->v, 3 * nodes));
    RUGA_TRY(RUGA_NEW(c->held, 3 * nodes));
    ruga_cut_rest(&c->raster, &c->cut, c->x);
    for (size_t n = 0; n < nodes; n++) {
        c->held[3 * n] = c->held[3 * n + 1] = c->held[3 * n + 2] =
            hypot(c->x[3 * n], c->x[3 * n + 1]) < 0.2001;
        c->v[3 * n + 2] = 0.1 * sin(20 * c->x[3 * n]) * cos(17 * c->x[3 * n + 1]);
    }
    dynamic.elastic.raster = &c->raster;
    dynamic.elastic.cut = &c->cut;
    dynamic.elastic.skin.model = model;
    dynamic.elastic.skin.thickness = 5e-4;
    dynamic.elastic.skin.young = 1e6;
    dynamic.elastic.skin.density = 400;
    dynamic.held = c->held;
    dynamic.damping = damping;
    dynamic.gravity[2] = -9.81;
    double before = cpu_seconds();
    RUGA_TRY(ruga_dynamic_create(&dynamic, &c->dynamic));
    *stitching = cpu_seconds() - before;
    ruga_dynamic_start(c->dynamic, c->x, c->v);
    return RUGA_OK;
}

// What has to be made for sewing (rows, S and its factor), and both projections of one step.
static ruga_status time_sewing(const cloth* c, int steps, double* setup, double* projections) {
    ruga_status status = RUGA_OK;
    ruga_sewing sewing = {0};
    ruga_stitch* stitch = NULL;
    double *inverse = NULL, *v = NULL, before = cpu_seconds();
    bool* held = NULL;
    size_t nodes = (size_t)c->cut.node_count;
    RUGA_TRY_DONE(RUGA_NEW(inverse, nodes));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(v, 3 * nodes));
    RUGA_TRY_DONE(RUGA_NEW(held, nodes));
    for (size_t n = 0; n < nodes; n++) {
        held[n] = c->held[3 * n];
        inverse[n] = held[n] ? 0 : 1 / ruga_dynamic_mass(c->dynamic)[n];
    }
    RUGA_TRY_DONE(ruga_sewing_create(&c->cut, held, &sewing));
    RUGA_TRY_DONE(ruga_stitch_create(&sewing, inverse, &stitch));
    *setup = cpu_seconds() - before;
    before = cpu_seconds();
    for (int k = 0; k < steps; k++) {
        RUGA_TRY_DONE(ruga_stitch_before(stitch, c->x, 1e-4, v));
        RUGA_TRY_DONE(ruga_stitch_after(stitch, v));
    }
    *projections = (cpu_seconds() - before) / steps;
done:
    ruga_stitch_destroy(&stitch);
    ruga_sewing_clear(&sewing);
    ruga_release(inverse);
    ruga_release(v);
    ruga_release(held);
    return status;
}

static ruga_status bench_skirt(int columns, int rows, int creases, ruga_skin_model model, double damping,
                               int steps) {
    ruga_status status = RUGA_OK;
    cloth c = {.dynamic = NULL};
    const ruga_raster_def def = ruga_default_raster_def();
    const ruga_make_def skirt = {.shape = RUGA_SHAPE_SKIRT,
                                 .size = {0.2, 0.6, 1.5 * RUGA_PI},
                                 .cells = {columns, rows},
                                 .pattern = RUGA_PATTERN_DIAGONAL};
    ruga_dynamic_report report = {0};
    double create = 0, setup = 0, projections = 0;
    RUGA_TRY_DONE(ruga_mesh_make(&skirt, &c.mesh));
    for (int k = 0; k < creases; k++) {
        // Within a column of quads, never on a line of nodes.
        double u = ((int)((k + 0.5) * columns / creases) + 0.5) / columns * 1.5 * RUGA_PI;
        RUGA_TRY_DONE(
            add_line(&c, RUGA_FREEDOM_SINGLE, 0.15 * cos(u), 0.15 * sin(u), 0.65 * cos(u), 0.65 * sin(u)));
    }
    RUGA_TRY_DONE(start(&c, &def, model, damping, &create));
    double dt = 0.7 * ruga_dynamic_limit(c.dynamic, c.x, 60);
    ruga_dynamic_step(c.dynamic, NULL, 0, dt, c.x, c.v, &report);
    report = (ruga_dynamic_report){0};
    double before = cpu_seconds();
    for (int k = 0; k < steps; k++) {
        ruga_dynamic_step(c.dynamic, NULL, k * dt, dt, c.x, c.v, &report);
    }
    double seconds = (cpu_seconds() - before) / steps;
    RUGA_TRY_DONE(time_sewing(&c, steps, &setup, &projections));
    double stages = 1 + (double)report.damping_products / steps;
    int springs = ruga_dynamic_elastic(c.dynamic)->cloth.springs.count;
    printf("%6d -> %6d %-8s %6g %6.1f | %8.3f %8.3f %5.1f %% | %8d %6.2f | %6.1f %6.1f | %8.2g\n",
           c.mesh.triangle_count, c.cut.piece_count, model == RUGA_SKIN_SPRINGS ? "springs" : "shell",
           damping, stages, 1e3 * seconds, 1e3 * projections, 100 * projections / seconds, springs,
           springs > 0 ? 1e9 * (seconds - projections) / springs / stages : 0.0, 1e3 * setup, 1e3 * create,
           ruga_cut_gap(&c.cut, c.x));
done:
    clear(&c);
    return status;
}

// Longest step, and seconds of one core for a second of motion at 0.7 of it.
static ruga_status bench_sheet(double offset, int kind, int steps, double* limit, double* cost) {
    enum { PLAIN, SINGLE, FULL, CONFORMING };
    ruga_status status = RUGA_OK;
    cloth c = {.dynamic = NULL}, fine = {.dynamic = NULL};
    cloth* used = kind == CONFORMING ? &fine : &c;
    ruga_raster_def def = ruga_default_raster_def();
    const ruga_make_def sheet = {
        .shape = RUGA_SHAPE_SHEET, .size = {1, 1, 0}, .cells = {40, 40}, .pattern = RUGA_PATTERN_DIAGONAL};
    ruga_dynamic_report report = {0};
    double unused, y = (0 + offset) / 40;
    def.reach = 1e-3;
    RUGA_TRY_DONE(ruga_mesh_make(&sheet, &c.mesh));
    if (kind != PLAIN) {
        RUGA_TRY_DONE(add_line(&c, kind == FULL ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_SINGLE, -1, y, 1, y));
    }
    RUGA_TRY_DONE(start(&c, &def, RUGA_SKIN_SPRINGS, 0, &unused));
    if (kind == CONFORMING) {
        RUGA_TRY_DONE(ruga_mesh_copy(&c.cut.material, &fine.mesh));
        RUGA_TRY_DONE(start(&fine, &def, RUGA_SKIN_SPRINGS, 0, &unused));
    }
    *limit = ruga_dynamic_limit(used->dynamic, used->x, 400);
    double dt = 0.7 * *limit, before = cpu_seconds();
    for (int k = 0; k < steps; k++) {
        ruga_dynamic_step(used->dynamic, NULL, k * dt, dt, used->x, used->v, &report);
    }
    *cost = (cpu_seconds() - before) / (steps * dt);
done:
    clear(&c);
    clear(&fine);
    return status;
}

static ruga_status bench_offsets(int steps) {
    static const double offset[3] = {0.5, 0.13, 0.05};
    double limit[4], cost[4];
    printf("\nlongest step and cost of a second over those of the sheet without a crease (40 x 40)\n"
           "%6s | %17s | %17s | %17s | %s\n",
           "offset", "crease, single", "crease, full", "conforming", "conforming over single");
    RUGA_TRY(bench_sheet(0, 0, steps, &limit[0], &cost[0]));
    for (int k = 0; k < 3; k++) {
        for (int kind = 1; kind < 4; kind++) {
            RUGA_TRY(bench_sheet(offset[k], kind, steps, &limit[kind], &cost[kind]));
        }
        printf("%6.2f |", offset[k]);
        for (int kind = 1; kind < 4; kind++) {
            printf(" %8.4f %8.2f |", limit[kind] / limit[0], cost[kind] / cost[0]);
        }
        printf(" step 1/%.1f, cost %.1f\n", limit[1] / limit[3], cost[3] / cost[1]);
    }
    return RUGA_OK;
}

static ruga_status run(int steps) {
    static const int skirt[2][3] = {{150, 39, 60}, {300, 36, 139}};
    printf("%16s %-8s %6s %6s | %8s %8s %7s | %8s %6s | %6s %6s | %8s\n", "triangles", "model", "damp s",
           "stages", "step ms", "stitches", "part", "springs", "ns", "sew ms", "all ms", "gap m");
    for (int k = 0; k < 2; k++) {
        RUGA_TRY(bench_skirt(skirt[k][0], skirt[k][1], skirt[k][2], RUGA_SKIN_SPRINGS, 0, steps));
        RUGA_TRY(bench_skirt(skirt[k][0], skirt[k][1], skirt[k][2], RUGA_SKIN_SPRINGS, 1e-4, steps));
        RUGA_TRY(bench_skirt(skirt[k][0], skirt[k][1], skirt[k][2], RUGA_SKIN_SHELL, 0, steps));
        RUGA_TRY(bench_skirt(skirt[k][0], skirt[k][1], skirt[k][2], RUGA_SKIN_SHELL, 1e-4, steps));
    }
    return bench_offsets(steps);
}

int main(int argc, char** argv) {
    int steps = argc > 1 ? atoi(argv[1]) : 200;
    ruga_set_threads(1);
    if (run(steps < 1 ? 1 : steps) != RUGA_OK) {
        (void)fprintf(stderr, "%s\n", ruga_last_error());
        return 1;
    }
    return 0;
}
