// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What has to be known of ccx 2.20 to get the right answer from it:
// - A *BUCKLE step after a preload takes forces, not displacements: with a displaced side its factors hardly
// depend
//   on the preload and are wrong. So the side's nodes are tied to one, which is pushed; the strain follows
//   from the force by the closed form of the flat state.
// - A preload of 0.6 or more of the critical one makes it miss the first mode. 0.3 leaves the linear
// extrapolation
//   within 0.01 % of the bifurcation.
// - Its increments step over the bifurcation and stay on the flat branch, even with an imperfection of 1e-3
// h. A push
//   on the crest that is let go afterwards brings it to the wrinkled branch of the perfect cell.
// - A linear elastic material is St. Venant-Kirchhoff with NLGEOM.
#include "app/validate/calculix.h"

#include "app/validate/peer.h"
#include "core/memory.h"
#include "core/progress.h"
#include "core/vec3.h"
#include "io/writer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LAYERS_MAX = 400, PLACE = RUGA_VALIDATION_PATH + 32 };
static const double TIME_LIMIT = 900, PRELOAD = 0.3;

// Nodes lie on a grid of half cells, of which the middles of cells are left out.
typedef struct grid {
    const film_def* def;
    double half, depth;
    int columns, rows; // 2 cells + 1
    int middle;        // row of the film's middle surface
    double z[2 * LAYERS_MAX + 1];
} grid;

static grid make_grid(const film_def* def, double half) {
    grid g = {.def = def, .half = half, .depth = def->depth * film_wavelength(def)};
    double corner[LAYERS_MAX + 1];
    RUGA_ASSERT(def->below + def->skin <= LAYERS_MAX && def->skin % 2 == 0);
    ruga_volume_grade(g.depth, def->thickness / def->skin, def->below, def->thickness, def->skin, corner);
    g.columns = 2 * def->cells + 1;
    g.rows = 2 * (def->below + def->skin) + 1;
    g.middle = 2 * def->below + def->skin;
    for (int k = 0; k < g.rows; k++) {
        g.z[k] = k % 2 ? 0.5 * (corner[k / 2] + corner[k / 2 + 1]) : corner[k / 2];
    }
    return g;
}

static int node_of(const grid* g, int column, int row) {
    return 1 + column + g->columns * row;
}

// ---- input ---------------------------------------------------------------------------------------------

static void write_elements(FILE* file, const grid* g, const char* name, int from, int to) {
    (void)fprintf(file, "*ELEMENT, TYPE=CPE8, ELSET=%s\n", name);
    for (int layer = from; layer < to; layer++) {
        for (int cell = 0; cell < g->def->cells; cell++) {
            static const int place[8][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0}, {2, 1}, {1, 2}, {0, 1}};
            (void)fprintf(file, "%d", 1 + cell + g->def->cells * layer);
            for (int a = 0; a < 8; a++) {
                (void)fprintf(file, ",%d", node_of(g, 2 * cell + place[a][0], 2 * layer + place[a][1]));
            }
            (void)fputc('\n', file);
        }
    }
}

// A set of nodes of one row (row >= 0) or one column.
static void write_set(FILE* file, const grid* g, const char* name, int row, int column) {
    (void)fprintf(file, "*NSET, NSET=%s\n", name);
    for (int i = 0; i < (row >= 0 ? g->columns : g->rows); i++) {
        (void)fprintf(file, "%d,\n", row >= 0 ? node_of(g, i, row) : node_of(g, column, i));
    }
}

static void write_material(FILE* file, const char* name, double young, double poisson) {
    (void)fprintf(file,
                  "*MATERIAL, NAME=%s\n*ELASTIC\n%.12g,%.12g\n*SOLID SECTION, ELSET=%s, MATERIAL=%s\n1.\n",
                  name, young, poisson, name, name);
}

static void write_model(FILE* file, const grid* g) {
    const film_def* def = g->def;
    (void)fputs("*NODE\n", file);
    for (int k = 0; k < g->rows; k++) {
        for (int i = 0; i < g->columns; i++) {
            if (i % 2 == 0 || k % 2 == 0) {
                (void)fprintf(file, "%d,%.12g,%.12g,0\n", node_of(g, i, k), g->half * i / (g->columns - 1),
                              g->z[k]);
            }
        }
    }
    write_elements(file, g, "BED", 0, def->below);
    write_elements(file, g, "FILM", def->below, def->below + def->skin);
    write_set(file, g, "LEFT", -1, 0);
    write_set(file, g, "RIGHT", -1, g->columns - 1);
    write_set(file, g, "BOTTOM", 0, 0);
    write_set(file, g, "MIDDLE", g->middle, 0);
    write_material(file, "BED", def->young, def->poisson);
    write_material(file, "FILM", def->ratio * def->young, def->poisson);
    (void)fputs("*BOUNDARY\nLEFT,1,1\nBOTTOM,2,2\n", file);
}

// ---- a run ---------------------------------------------------------------------------------------------

static ruga_status open_input(const calculix* c, const char* job, char* path, ruga_writer* writer) {
    (void)snprintf(path, PLACE, "%s/%.15s.inp", c->directory, job);
    return ruga_writer_open(path, writer);
}

static ruga_status run(calculix* c, const char* job, FILE** answer) {
    char name[16], log[32], path[PLACE];
    (void)snprintf(name, sizeof name, "%s", job);
    (void)snprintf(log, sizeof log, "%s.log", name);
    char program[] = "ccx", option[] = "-i";
    char* argument[] = {program, option, name, NULL};
    double begin = ruga_clock();
    RUGA_TRY(peer_run(c->path, argument, c->directory, log, TIME_LIMIT));
    c->seconds += ruga_clock() - begin;
    (void)snprintf(path, sizeof path, "%s/%s.dat", c->directory, name);
    *answer = fopen(path, "r");
    return *answer ? RUGA_OK : ruga_fail(RUGA_LIBRARY, "%s: ccx did not write it; see %s there", path, log);
}

// ---- buckling ------------------------------------------------------------------------------------------

// Force on a side at strain e in the flat state, N for the width 1 m that CalculiX gives its plane elements:
// E* s (1 - s^2) / 2 of each layer, s = 1 - e, as no stress acts in depth.
static double flat_force(const grid* g, double strain) {
    const film_def* def = g->def;
    double s = 1 - strain, modulus = def->young / (1 - def->poisson * def->poisson);
    return 0.5 * s * (1 - s * s) * modulus * (g->depth + def->ratio * def->thickness);
}

static double flat_strain(const grid* g, double force) {
    double low = 0, high = 1 - sqrt(1. / 3); // where the force is largest
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        *(flat_force(g, middle) < force ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

static void write_buckling(FILE* file, const grid* g, double preload, double load) {
    int pushed = node_of(g, g->columns - 1, g->rows - 1);
    write_model(file, g);
    (void)fputs("*EQUATION\n", file);
    for (int k = 0; k < g->rows - 1; k++) {
        (void)fprintf(file, "2\n%d,1,1.,%d,1,-1.\n", node_of(g, g->columns - 1, k), pushed);
    }
    (void)fprintf(file,
                  "*STEP, NLGEOM\n*STATIC\n1.,1.\n*CLOAD\n%d,1,%.12g\n*END STEP\n"
                  "*STEP, PERTURBATION\n*BUCKLE\n2\n*CLOAD\n%d,1,%.12g\n*NODE FILE\nU\n*END STEP\n",
                  pushed, -preload, pushed, -load);
}

// The first line "1  factor" after the heading.
static bool read_factor(FILE* file, double* factor) {
    char line[256];
    int mode;
    bool found = false;
    while (!found && fgets(line, sizeof line, file)) {
        char* end;
        mode = (int)strtol(line, &end, 10);
        *factor = mode == 1 ? strtod(end, &end) : 0;
        found = mode == 1 && strspn(end, " \r\n") == strlen(end) && *factor != 0;
    }
    return found;
}

ruga_status calculix_critical(calculix* c, const film_def* def, double half, double* strain) {
    grid g = make_grid(def, half);
    char path[PLACE];
    ruga_writer writer;
    FILE* answer;
    double factor, load = flat_force(&g, film_strain(def)),
                   preload = flat_force(&g, PRELOAD * film_strain(def));
    RUGA_TRY(open_input(c, "buckle", path, &writer));
    write_buckling(writer.file, &g, preload, load);
    RUGA_TRY(ruga_writer_close(&writer, RUGA_OK));
    RUGA_TRY(run(c, "buckle", &answer));
    bool found = read_factor(answer, &factor);
    (void)fclose(answer);
    if (!found || !(factor > 0)) {
        return ruga_fail(RUGA_LIBRARY, "%s: ccx found no buckling factor above 0", path);
    }
    *strain = flat_strain(&g, preload + factor * load);
    return RUGA_OK;
}

ruga_status calculix_onset(calculix* c, const film_def* def, double* wavelength, double* strain) {
    enum { COUNT = 7 };
    const double first = 0.84, spacing = 0.06; // of eq. 3
    double e[COUNT];
    int best = 1;
    for (int i = 0; i < COUNT; i++) {
        double length = first + spacing * i;
        RUGA_TRY(calculix_critical(c, def, 0.5 * length * film_wavelength(def), &e[i]));
    }
    for (int i = 1; i < COUNT - 1; i++) {
        best = e[i] < e[best] ? i : best;
    }
    double slope = 0.5 * (e[best + 1] - e[best - 1]), curvature = e[best + 1] - 2 * e[best] + e[best - 1];
    if (!(curvature > 0) || fabs(slope) > curvature) {
        return ruga_fail(RUGA_LIBRARY, "ccx's critical strain has no minimum between %g and %g times eq. 3",
                         first, first + spacing * (COUNT - 1));
    }
    *wavelength = (first + spacing * (best - slope / curvature)) * film_wavelength(def);
    *strain = e[best] - 0.5 * slope * slope / curvature;
    return RUGA_OK;
}

// ---- beyond --------------------------------------------------------------------------------------------

static void write_branch(FILE* file, const grid* g, int count, const film_point* points) {
    const film_def* def = g->def;
    // About what holds a crest half a thickness above the bed.
    double push = 0.5 * def->thickness * 0.25 * RUGA_PI * def->young / (1 - def->poisson * def->poisson);
    int crest = node_of(g, 0, g->middle);
    write_model(file, g);
    for (int k = -1; k < count; k++) {
        (void)fprintf(file, "*STEP, NLGEOM, INC=1000\n*STATIC\n%s,1.\n*BOUNDARY\nRIGHT,1,1,%.12g\n",
                      k < 0 ? "0.25" : "1.", -points[k < 0 ? 0 : k].strain * g->half);
        if (k <= 0) {
            (void)fprintf(file, "*CLOAD%s\n%d,2,%.12g\n", k < 0 ? "" : ", OP=NEW", crest, k < 0 ? push : 0.0);
        }
        (void)fputs("*NODE PRINT, NSET=MIDDLE, FREQUENCY=100000\nU\n*END STEP\n", file);
    }
}

// One table of the answer: the heights at the nodes of the middle row, which are equally spaced; sqrt(2) rms
// by the trapezoid rule.
static bool read_amplitude(FILE* file, int count, double* amplitude) {
    char line[256];
    double sum = 0, square = 0;
    int seen = 0;
    while (fgets(line, sizeof line, file) && !strstr(line, "for set MIDDLE")) {
    }
    while (seen < count && fgets(line, sizeof line, file)) {
        char* at = line;
        long node = strtol(at, &at, 10);
        (void)strtod(at, &at);
        double w = strtod(at, &at), share = seen == 0 || seen == count - 1 ? 0.5 : 1;
        if (node > 0) {
            sum += share * w;
            square += share * w * w;
            seen++;
        }
    }
    double mean = sum / (count - 1);
    *amplitude = sqrt(2 * fmax(0, square / (count - 1) - mean * mean));
    return seen == count;
}

ruga_status calculix_branch(calculix* c, const film_def* def, double half, int count, film_point* points) {
    grid g = make_grid(def, half);
    char path[PLACE];
    ruga_writer writer;
    FILE* answer;
    double pushed;
    RUGA_TRY(open_input(c, "branch", path, &writer));
    write_branch(writer.file, &g, count, points);
    RUGA_TRY(ruga_writer_close(&writer, RUGA_OK));
    RUGA_TRY(run(c, "branch", &answer));
    bool all = read_amplitude(answer, g.columns, &pushed);
    for (int k = 0; k < count && all; k++) {
        all = read_amplitude(answer, g.columns, &points[k].amplitude);
    }
    (void)fclose(answer);
    return all ? RUGA_OK
               : ruga_fail(RUGA_LIBRARY, "%s: ccx did not reach all strains; see branch.log there", path);
}
