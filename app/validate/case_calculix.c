// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The dense volume against CalculiX: the same cell, the same material law, another discretisation and
// program. Our own law and the embedded shell stand beside it, unjudged.
#include "app/validate/calculix.h"
#include "app/validate/cases.h"
#include "app/validate/film_answer.h"
#include "app/validate/peer.h"
#include "core/progress.h"
#include "io/writer.h"

#include <math.h>
#include <stdio.h>

// `points` of the branch are computed.
typedef struct material {
    double ratio, poisson;
    int points;
} material;

static const material MATERIALS[] = {{1e2, 0.3, 8},  {1e3, 0.3, 8},  {1e4, 0.3, 8},
                                     {1e2, 0.48, 8}, {1e3, 0.48, 8}, {30, 0.3, 6}};
enum { MATERIALS_COUNT = sizeof MATERIALS / sizeof *MATERIALS, POINTS = 8 };

// In critical strains of our volume. CalculiX begins past the onset and goes back to it first.
static const double OURS[POINTS] = {1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 2, 2.5};
static const int ORDER[POINTS] = {4, 3, 2, 1, 0, 5, 6, 7};

typedef struct peers {
    int points;
    double wavelength[2], critical[2], onset[2], seconds[2]; // ours, theirs
    film_point point[2][POINTS];
} peers;

static ruga_status solve_both(calculix* c, const film_def* def, peers* p) {
    film_point theirs[POINTS] = {{0}};
    double begin = ruga_clock(), before = c->seconds;
    RUGA_TRY(film_onset(def, &p->wavelength[0], &p->critical[0]));
    for (int k = 0; k < p->points; k++) {
        p->point[0][k].strain = OURS[k] * p->critical[0];
    }
    RUGA_TRY(film_branch(def, 0.5 * p->wavelength[0], p->points, p->point[0]));
    p->seconds[0] = ruga_clock() - begin;
    RUGA_TRY(calculix_onset(c, def, &p->wavelength[1], &p->critical[1]));
    for (int k = 0; k < p->points; k++) {
        theirs[k].strain = OURS[ORDER[k]] * p->critical[0];
    }
    RUGA_TRY(calculix_branch(c, def, 0.5 * p->wavelength[0], p->points, theirs));
    for (int k = 0; k < p->points; k++) {
        p->point[1][ORDER[k]] = theirs[k];
    }
    p->seconds[1] = c->seconds - before;
    for (int i = 0; i < 2; i++) {
        p->onset[i] = film_fit(p->points, p->point[i], 1.1 * p->critical[0], 1.6 * p->critical[0]);
    }
    return RUGA_OK;
}

static void state_peers(ruga_validation* v, const char* point, const peers* p) {
    char name[128];
    int minima = 0;
    (void)snprintf(name, sizeof name, "%s: wavelength, m", point);
    ruga_validation_near(v, name, p->wavelength[0], p->wavelength[1], 0.03, "ccx, *BUCKLE");
    (void)snprintf(name, sizeof name, "%s: critical strain", point);
    ruga_validation_near(v, name, p->critical[0], p->critical[1], 0.03, "ccx, *BUCKLE");
    (void)snprintf(name, sizeof name, "%s: onset strain", point);
    ruga_validation_near(v, name, p->onset[0], p->onset[1], 0.03, "ccx, NLGEOM");
    for (int k = 0; k < p->points; k++) {
        minima += p->point[0][k].outcome == RUGA_OUTCOME_MINIMUM;
        if (k == 4 || k > 5) {
            (void)snprintf(name, sizeof name, "%s: amplitude at %g critical strains, m", point, OURS[k]);
            ruga_validation_near(v, name, p->point[0][k].amplitude, p->point[1][k].amplitude, 0.05,
                                 "ccx, NLGEOM");
        }
    }
    (void)snprintf(name, sizeof name, "%s: our states in a certified minimum", point);
    ruga_validation_near(v, name, minima, p->points, 0, "all of them");
    (void)snprintf(name, sizeof name, "%s: time, s", point);
    ruga_validation_record(v, name, p->seconds[0], p->seconds[1], "ccx");
}

static void state_other(ruga_validation* v, const char* point, const char* model, const film_answer* a,
                        const peers* p) {
    char name[128];
    (void)snprintf(name, sizeof name, "%s, %s: wavelength, m", point, model);
    ruga_validation_record(v, name, a->wavelength, p->wavelength[1], "ccx, *BUCKLE");
    (void)snprintf(name, sizeof name, "%s, %s: onset strain", point, model);
    ruga_validation_record(v, name, a->onset, p->onset[1], "ccx, NLGEOM");
    for (int i = 0; i < FILM_LEVELS; i++) {
        (void)snprintf(name, sizeof name, "%s, %s: amplitude at %g own onsets, m", point, model,
                       FILM_LEVEL[i]);
        int k = i ? 7 : 4;
        ruga_validation_record(v, name, a->amplitude[i], k < p->points ? p->point[1][k].amplitude : NAN,
                               "ccx at that multiple of the critical strain");
    }
    (void)snprintf(name, sizeof name, "%s, %s: time, s", point, model);
    ruga_validation_record(v, name, a->seconds, p->seconds[1], "ccx");
}

static void write_curves(FILE* table, const film_def* def, const peers* p) {
    for (int k = 0; k < p->points; k++) {
        (void)fprintf(table, "%g,%g,%.9g,%.9g,%.9g\n", def->ratio, def->poisson, p->point[0][k].strain,
                      p->point[0][k].amplitude, p->point[1][k].amplitude);
    }
}

static ruga_status compare(ruga_validation* v, calculix* c, const material* m, FILE* table) {
    film_def def = film_default();
    char point[64];
    double critical;
    peers p = {.points = m->points};
    film_answer volume, shell;
    def.ratio = m->ratio;
    def.poisson = m->poisson;
    (void)snprintf(point, sizeof point, "E_x/E_q %g, nu %g", m->ratio, m->poisson);
    RUGA_TRY(film_answer_volume(&def, &critical, &volume));
    RUGA_TRY(film_answer_shell(&def, 24, &shell));
    def.law = RUGA_VOLUME_KIRCHHOFF;
    RUGA_TRY(solve_both(c, &def, &p));
    state_peers(v, point, &p);
    state_other(v, point, "volume with Ruga's own law", &volume, &p);
    state_other(v, point, "embedded shell", &shell, &p);
    write_curves(table, &def, &p);
    return RUGA_OK;
}

static ruga_status run(ruga_validation* v) {
    calculix c = {.seconds = 0};
    char path[RUGA_VALIDATION_PATH];
    ruga_writer writer;
    if (!peer_find("ccx", c.path)) {
        ruga_validation_skip(v, "CalculiX is not here: no `ccx` in PATH (Debian package calculix-ccx).");
        return RUGA_OK;
    }
    RUGA_TRY(ruga_validation_work(v, c.directory));
    ruga_validation_file(v, "curves.csv", "Amplitudes along the branch: ours and theirs.", path);
    RUGA_TRY(ruga_writer_open(path, &writer));
    (void)fputs("ratio,poisson,strain,amplitude_volume,amplitude_calculix\n", writer.file);
    ruga_status status = RUGA_OK;
    for (int i = 0; i < MATERIALS_COUNT && status == RUGA_OK; i++) {
        status = compare(v, &c, &MATERIALS[i], writer.file);
    }
    RUGA_TRY(ruga_writer_close(&writer, status));
    ruga_validation_note(
        v, "Judged is our volume with the material law that CalculiX has, St. Venant-Kirchhoff. Ruga's "
           "own law, fixed corotational, differs from it by terms of the order of the strain itself: "
           "that is the difference between our two volumes, and it vanishes with the critical strain.");
    ruga_validation_note(
        v, "At E_x/E_q = 30 the branch ends at 1.6 critical strains. Beyond 10 %% of compression a St. "
           "Venant-Kirchhoff bed is about to fail in itself: CalculiX gives up (too many cutbacks) before "
           "2.5 critical strains, and our volume leaves the branch by 2. Ruga's own law goes on.");
    return RUGA_OK;
}

const ruga_validation_case ruga_validate_calculix = {
    .name = "calculix",
    .title = "The dense volume against CalculiX",
    .about =
        "Plane strain, a cell of half a wave between planes of symmetry, two wavelengths deep. CalculiX: "
        "CPE8 on "
        "the same grid, *BUCKLE with forces at a preload of 0.3 over seven lengths of the cell, then NLGEOM "
        "on the "
        "perfect cell, brought to the wrinkled branch by a push that is let go. Tolerances were set before: "
        "3 % on "
        "wavelength and critical strain, 5 % on amplitude. The input files are in validation/work/calculix.",
    .run = run,
};
