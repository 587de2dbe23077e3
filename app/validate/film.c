// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/film.h"

#include "app/validate/line.h"
#include "core/memory.h"
#include "core/progress.h"
#include "core/vec3.h"
#include "solver/volume.h"

#include <math.h>
#include <string.h>

enum { LAYERS_MAX = 400, SAMPLES = 128 };

film_def film_default(void) {
    return (film_def){.ratio = 100,
                      .poisson = 0.3,
                      .young = 1e5,
                      .thickness = 1e-3,
                      .depth = 2,
                      .degree = 2,
                      .cells = 12,
                      .skin = 2,
                      .below = 20};
}

film_def film_halved(const film_def* def) {
    film_def fine = *def;
    fine.cells *= 2;
    fine.skin *= 2;
    fine.below *= 2;
    return fine;
}

double film_wavelength(const film_def* def) {
    return 2 * RUGA_PI * def->thickness * cbrt(def->ratio / 3);
}

double film_strain(const film_def* def) {
    return 0.25 * pow(3 / def->ratio, 2. / 3);
}

//---- a cell ----

typedef struct cell {
    const film_def* def;
    double half, depth;
    ruga_volume volume;
    ruga_volume_solver* solver;
    double *u, *flat; // [N][3]
} cell;

static void clear(cell* c) {
    ruga_volume_solver_destroy(&c->solver);
    ruga_volume_clear(&c->volume);
    ruga_release(c->u);
    ruga_release(c->flat);
}

// Sides hold x, the bottom x and z; nothing moves along y.
static ruga_status create_solver(cell* c) {
    const ruga_volume* v = &c->volume;
    bool* held = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(held, 3 * v->node_count));
    for (int i = 0; i < v->node_count; i++) {
        int x = i % v->axis[0].count, z = i / v->axis[0].count;
        held[3 * i] = x == 0 || x == v->axis[0].count - 1 || z == 0;
        held[3 * i + 1] = true;
        held[3 * i + 2] = z == 0;
    }
    ruga_status status = ruga_volume_solver_create(v, held, 1, &c->solver);
    ruga_release(held);
    return status;
}

static ruga_status create(const film_def* def, double half, cell* c) {
    double grid[LAYERS_MAX + 1];
    RUGA_ASSERT(def->below + def->skin <= LAYERS_MAX);
    *c = (cell){.def = def, .half = half, .depth = def->depth * film_wavelength(def)};
    ruga_volume_grade(c->depth, def->thickness / def->skin, def->below, def->thickness, def->skin, grid);
    ruga_volume_def d = {.degree = def->degree,
                         .size = {half, def->thickness},
                         .cells = {def->cells, 0},
                         .layers = def->below + def->skin,
                         .depth = grid,
                         .interface = def->below,
                         .young = {def->young, def->ratio * def->young},
                         .poisson = {def->poisson, def->poisson},
                         .law = def->law};
    RUGA_TRY(ruga_volume_create(&d, &c->volume));
    RUGA_TRY(create_solver(c));
    RUGA_TRY(RUGA_NEW_ZERO(c->u, 3 * c->volume.node_count));
    return RUGA_NEW_ZERO(c->flat, 3 * c->volume.node_count);
}

// Stretch in depth at stretch s along x, nothing across, no stress in depth.
//   fixed corotational: 2 mu (t - 1) + lambda (s t - 1) s = 0
//   St. Venant-Kirchhoff: (2 mu + lambda) E_z + lambda E_x = 0
static double depth_stretch(const ruga_volume* v, int material, double s) {
    double mu = v->mu[material], lambda = v->lambda[material];
    if (v->law == RUGA_VOLUME_KIRCHHOFF) {
        return sqrt(1 - lambda / (2 * mu + lambda) * (s * s - 1));
    }
    return (2 * mu + lambda * s) / (2 * mu + lambda * s * s);
}

// The homogeneous state: linear in z on either side of the interface, where the splines have a kink.
static void flatten(const cell* c, double strain, double* u) {
    double bed = depth_stretch(&c->volume, 0, 1 - strain) - 1,
           film = depth_stretch(&c->volume, 1, 1 - strain) - 1;
    for (int i = 0; i < c->volume.node_count; i++) {
        double X[3];
        ruga_volume_node(&c->volume, i, X);
        u[3 * i] = -strain * X[0];
        u[3 * i + 1] = 0;
        u[3 * i + 2] = bed * (fmin(X[2], 0) + c->depth) + film * fmax(X[2], 0);
    }
}

//---- onset ----

static ruga_status bisect(cell* c, double* strain) {
    double low = 0, high = 2 * film_strain(c->def);
    while (high - low > 1e-7 * high) {
        bool stable;
        RUGA_TRY(ruga_progress("critical strain", 0));
        double middle = 0.5 * (low + high);
        flatten(c, middle, c->u);
        RUGA_TRY(ruga_volume_is_stable(c->solver, c->u, &stable, NULL));
        *(stable ? &low : &high) = middle;
    }
    *strain = 0.5 * (low + high);
    return RUGA_OK;
}

ruga_status film_critical(const film_def* def, double half, double* strain) {
    cell c;
    ruga_status status = create(def, half, &c);
    if (status == RUGA_OK) {
        status = bisect(&c, strain);
    }
    clear(&c);
    return status;
}

// Golden section between 0.7 and 1.3 times eq. 3.
ruga_status film_onset(const film_def* def, double* wavelength, double* strain) {
    const double golden = 0.61803398874989484820;
    double unit = film_wavelength(def), a = 0.7, b = 1.3, x = b - golden * (b - a), y = a + golden * (b - a),
           fx, fy;
    RUGA_TRY(film_critical(def, 0.5 * x * unit, &fx));
    RUGA_TRY(film_critical(def, 0.5 * y * unit, &fy));
    while (b - a > 2e-3) {
        if (fx < fy) {
            b = y;
            y = x;
            fy = fx;
            x = b - golden * (b - a);
            RUGA_TRY(film_critical(def, 0.5 * x * unit, &fx));
        } else {
            a = x;
            x = y;
            fx = fy;
            y = a + golden * (b - a);
            RUGA_TRY(film_critical(def, 0.5 * y * unit, &fy));
        }
    }
    *wavelength = 0.5 * (a + b) * unit;
    *strain = fmin(fx, fy);
    return RUGA_OK;
}

//---- beyond ----

static double measure(const cell* c) {
    double w[SAMPLES], mean = 0, square = 0;
    for (int i = 0; i < SAMPLES; i++) {
        double d[3], X[3] = {(i + 0.5) / SAMPLES * c->half, 0.5 * c->def->thickness, 0.5 * c->def->thickness};
        ruga_volume_displacement(&c->volume, c->u, X, d);
        w[i] = d[2];
        mean += d[2] / SAMPLES;
    }
    for (int i = 0; i < SAMPLES; i++) {
        square += (w[i] - mean) * (w[i] - mean);
    }
    return sqrt(2 * square / SAMPLES);
}

static ruga_status follow(cell* c, int count, film_point* points) {
    for (int k = 0; k < count; k++) {
        ruga_volume_report report;
        double begin = ruga_clock();
        for (int i = 0; i < 3 * c->volume.node_count; i++) {
            c->u[i] -= c->flat[i];
        }
        flatten(c, points[k].strain, c->flat);
        for (int i = 0; i < 3 * c->volume.node_count; i++) {
            c->u[i] += c->flat[i];
        }
        RUGA_TRY(ruga_volume_solve(c->solver, 1e-9, c->u, &report));
        points[k].outcome = report.outcome;
        points[k].iterations = report.iterations;
        points[k].amplitude = measure(c);
        points[k].seconds = ruga_clock() - begin;
    }
    return RUGA_OK;
}

ruga_status film_branch(const film_def* def, double half, int count, film_point* points) {
    cell c;
    ruga_status status = create(def, half, &c);
    if (status == RUGA_OK) {
        status = follow(&c, count, points);
    }
    clear(&c);
    return status;
}

double film_fit(int count, const film_point* points, double from, double to) {
    fitted_line line = {0};
    for (int k = 0; k < count; k++) {
        double x = points[k].strain, y = points[k].amplitude * points[k].amplitude;
        if (x >= from * (1 - 1e-9) && x <= to * (1 + 1e-9)) {
            line_add(&line, x, y);
        }
    }
    return line_zero(&line);
}
