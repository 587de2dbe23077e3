// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The physics of a compressed sheet, in full: wavelength against eq. 3, onset against (1/4)(3
// E*_q/E*_x)^(2/3), amplitude against h sqrt(eps/eps_c - 1), prescribed and coupled, with each tie alone, and
// by the published method.
//     physics [-o DIRECTORY] [GROUP ...]      groups: prescribed foundation coupled clusters spectral paper
// Prints a table; writes DIRECTORY/frames.csv and DIRECTORY/lines.json. Exit status 1 where a line with a
// tolerance fails, 3 where a run or a file does. Lines without a tolerance are recorded only.
#include "app/validate/sheet.h"

#include "core/progress.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_STRAINS = 32 };

typedef struct suite {
    FILE *frames, *lines;
    int line_count, failures, run_count;
} suite;

// One run: what to simulate, and which figures are held against which tolerances.
typedef struct run {
    char name[96];
    sheet_def def;
    double strain[MAX_STRAINS];
    sheet_frame frame[MAX_STRAINS];
    double wavelength, critical, thickness;
} run;

// ---- output --------------------------------------------------------------------------------------------

// tolerance 0: recorded only.
static void add_line(suite* s, const run* r, const char* quantity, double value, double wanted,
                     double tolerance) {
    bool judged = tolerance > 0, good = fabs(value - wanted) <= tolerance * fmax(fabs(wanted), 1e-300);
    const char* verdict = !judged ? "recorded" : good ? "pass" : "FAIL";
    char range[48] = "";
    if (judged) {
        (void)snprintf(range, sizeof range, "%.3f +- %.0f %%", wanted, 100 * tolerance);
    }
    printf("  %-44s %-32s %10.4g  %-18s %s\n", r->name, quantity, value, range, verdict);
    (void)fflush(stdout);
    (void)fprintf(s->lines,
                  "%s\n  {\"case\": \"%s\", \"quantity\": \"%s\", \"value\": %.9g, \"wanted\": %.9g, "
                  "\"tolerance\": %g, \"verdict\": \"%s\"}",
                  s->line_count ? "," : "", r->name, quantity, value, wanted, tolerance, verdict);
    s->line_count++;
    s->failures += judged && !good;
}

static const char* outcome_name(const sheet_frame* f) {
    static const char* const names[] = {"minimum", "saddle", "not converged"};
    return f->stopped ? "stopped" : names[f->report.outcome];
}

static void write_frames(suite* s, const run* r) {
    for (int k = 0; k < r->def.count; k++) {
        const sheet_frame* f = &r->frame[k];
        const ruga_report* p = &f->report;
        if (f->strain > 0) {
            (void)fprintf(
                s->frames,
                "%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%s,%.3g,%.3g,%.3g,%d,%d,%d,%d,%.3f\n",
                r->name, f->strain, f->strain / r->critical, f->skin_strain, f->across_strain,
                f->wavelength / r->wavelength, f->wavelength_fft / r->wavelength, f->amplitude / r->thickness,
                f->middle_amplitude / r->thickness, sqrt(fmax(f->strain / r->critical - 1, 0)),
                outcome_name(f), p->residual_shell, p->residual_coupled, p->constraint_residual, p->substeps,
                p->newton_iterations, p->linear_iterations, p->factorizations, p->seconds_total);
        }
    }
    (void)fflush(s->frames);
}

// ---- runs ----------------------------------------------------------------------------------------------

static void start_run(run* r, const char* group, double ratio, double poisson, int seed) {
    *r = (run){.def = sheet_default()};
    r->def.ratio = ratio;
    r->def.poisson = poisson;
    r->def.seed = seed;
    r->def.strain = r->strain;
    (void)snprintf(r->name, sizeof r->name, "%s R 1e%.0f nu %.1f seed %d", group, log10(ratio), poisson,
                   seed);
}

static void add_strains(run* r, int count, const double* strain) {
    for (int k = 0; k < count; k++) {
        r->strain[r->def.count++] = strain[k];
    }
}

static const double ONSET_STRAINS[] = {0.8, 1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6};
enum { ONSET_COUNT = sizeof ONSET_STRAINS / sizeof ONSET_STRAINS[0] };

static ruga_status do_run(suite* s, run* r) {
    double begin = ruga_clock();
    RUGA_TRY(sheet_run(&r->def, r->frame, &r->wavelength, &r->critical, &r->thickness));
    write_frames(s, r);
    s->run_count++;
    add_line(s, r, "seconds", ruga_clock() - begin, 0, 0);
    return RUGA_OK;
}

// The frame at a strain (in critical ones) that was reached; NULL otherwise.
static const sheet_frame* frame_at(const run* r, double strain) {
    for (int k = 0; k < r->def.count; k++) {
        if (fabs(r->strain[k] - strain) < 1e-9 && r->frame[k].strain > 0) {
            return &r->frame[k];
        }
    }
    return NULL;
}

static void add_minima(suite* s, const run* r, double tolerance) {
    int reached = 0, minima = 0;
    for (int k = 0; k < r->def.count; k++) {
        reached += r->frame[k].strain > 0;
        minima += r->frame[k].strain > 0 && r->frame[k].report.outcome == RUGA_OUTCOME_MINIMUM;
    }
    add_line(s, r, "minima / frames", reached > 0 ? (double)minima / reached : 0, 1, tolerance);
}

static void add_wavelength(suite* s, const run* r, double strain, const char* quantity, double tolerance) {
    const sheet_frame* f = frame_at(r, strain);
    add_line(s, r, quantity, f ? f->wavelength_fft / r->wavelength : 0, 1, tolerance);
}

static void add_amplitude(suite* s, const run* r, double strain, double tolerance) {
    const sheet_frame* f = frame_at(r, strain);
    char quantity[48];
    (void)snprintf(quantity, sizeof quantity, "amplitude / law, %.1f eps_c", strain);
    add_line(s, r, quantity, f ? f->amplitude / (r->thickness * sqrt(strain - 1)) : 0, 1, tolerance);
}

static ruga_status run_prescribed(suite* s) {
    for (int ratio = 2; ratio <= 4; ratio++) {
        for (int k = 0; k < 4; k++) {
            run r;
            start_run(&r, "prescribed", pow(10, ratio), k / 2 ? 0 : 0.3, 1 + k % 2);
            double tenth = 0.1 / (0.25 * pow(3 / r.def.ratio, 2.0 / 3));
            add_strains(&r, ONSET_COUNT, ONSET_STRAINS);
            add_strains(&r, 4, (const double[]){2, 2.5, 3, tenth});
            RUGA_TRY(do_run(s, &r));
            add_minima(s, &r, 1e-9);
            add_wavelength(s, &r, 2, "wavelength_fft / eq. 3, 2 eps_c", 0.05);
            add_wavelength(s, &r, tenth, "wavelength_fft / eq. 3, 10 %", 0.08);
            add_line(s, &r, "onset / eps_c", sheet_onset(r.def.count, r.frame, r.critical, false, 0), 1,
                     0.08);
            for (double strain = 1.5; strain < 3.1; strain += 0.5) {
                add_amplitude(s, &r, strain, 0.06);
            }
        }
    }
    return RUGA_OK;
}

// The free edges slip over the shear-lag length sqrt(h E_x / a): 1.8 and 8.2 wavelengths. In a sheet of five
// of these lengths or more the middle is in the plane strain that the theory is of; without a Poisson's ratio
// the width does not matter. In a narrow sheet the sides slip right to the middle, and what loads the skin is
// the strain along plus nu times the strain across: that sum is recorded as well.
static ruga_status run_foundation(suite* s) {
    static const double slow_strains[] = {0.9, 1.15, 1.3, 1.4, 1.5, 1.65};
    static const double lengths[] = {24, 24, 64, 64}, widths[] = {9, 3, 40, 2};
    for (int k = 0; k < 4; k++) {
        run r;
        start_run(&r, "foundation alone", k / 2 ? 1e4 : 1e2, k % 2 ? 0 : 0.3, 1);
        r.def.clusters = false;
        r.def.length = lengths[k];
        r.def.width = widths[k];
        if (k == 2) {
            add_strains(&r, 6, slow_strains);
        } else {
            add_strains(&r, ONSET_COUNT, ONSET_STRAINS);
            add_strains(&r, 2, (const double[]){1.7, 1.8});
        }
        RUGA_TRY(do_run(s, &r));
        add_minima(s, &r, 1e-9);
        add_line(s, &r, "onset / eps_c, own strain along",
                 sheet_onset(r.def.count, r.frame, r.critical, true, 0), 1, 0.05);
        add_line(s, &r, "onset / eps_c, own plane strain",
                 sheet_onset(r.def.count, r.frame, r.critical, true, r.def.poisson), 1, 0);
        add_wavelength(s, &r, r.strain[r.def.count - 1], "wavelength_fft / eq. 3, last strain", 0.05);
    }
    return RUGA_OK;
}

static ruga_status run_coupled(suite* s) {
    for (int k = 0; k < 4; k++) {
        run r;
        start_run(&r, "coupled", k / 2 ? 1e3 : 1e2, k % 2 ? 0 : 0.3, 1);
        r.def.coupled = true;
        add_strains(&r, 5, (const double[]){0.4, 0.8, 1.2, 1.6, 2});
        RUGA_TRY(do_run(s, &r));
        add_minima(s, &r, 1e-9);
        add_wavelength(s, &r, 2, "wavelength_fft / eq. 3, 2 eps_c", 0.08);
        add_line(s, &r, "amplitude / law, 2 eps_c", r.frame[4].amplitude / r.thickness, 1, 0);
    }
    return RUGA_OK;
}

static void record(suite* s, const run* r) {
    add_minima(s, r, 0);
    add_wavelength(s, r, 2, "wavelength_fft / eq. 3, 2 eps_c", 0);
    add_line(s, r, "onset / eps_c", sheet_onset(r->def.count, r->frame, r->critical, false, 0), 1, 0);
    add_amplitude(s, r, 2, 0);
}

// Without the foundation the clusters (or eigenvectors) alone set the wavelength.
static ruga_status run_without_foundation(suite* s, bool spectral) {
    for (int ratio = 2; ratio <= 4; ratio++) {
        for (int paper = 0; paper <= !spectral; paper++) {
            run r;
            const char* group = spectral ? "spectral alone"
                                : paper  ? "clusters alone, paper"
                                         : "clusters alone";
            start_run(&r, group, pow(10, ratio), 0.3, 1);
            r.def.foundation = false;
            r.def.spectral = spectral;
            r.def.paper_rule = paper;
            r.def.frame_limit = 120;
            add_strains(&r, ONSET_COUNT, ONSET_STRAINS);
            add_strains(&r, 1, (const double[]){2});
            RUGA_TRY(do_run(s, &r));
            record(s, &r);
        }
    }
    return RUGA_OK;
}

static ruga_status run_clusters(suite* s) {
    return run_without_foundation(s, false);
}

static ruga_status run_spectral(suite* s) {
    return run_without_foundation(s, true);
}

// The baseline, as published, from rest to one strain, run to its own limits (two minutes and more).
static ruga_status run_paper_once(suite* s, double ratio, double poisson, int seed, double strain) {
    run r;
    start_run(&r, "paper", ratio, poisson, seed);
    size_t length = strlen(r.name);
    (void)snprintf(r.name + length, sizeof r.name - length, " %.1f eps_c", strain);
    r.def.foundation = false;
    r.def.paper_rule = r.def.paper_method = true;
    add_strains(&r, 1, &strain);
    RUGA_TRY(do_run(s, &r));
    const sheet_frame* f = &r.frame[0];
    char quantity[64];
    (void)snprintf(quantity, sizeof quantity, "residual (%s)", outcome_name(f));
    add_line(s, &r, quantity, f->report.residual_shell, 0, 0);
    add_line(s, &r, "constraint residual", f->report.constraint_residual, 0, 0);
    add_line(s, &r, "Newton steps", f->report.newton_iterations, 0, 0);
    add_line(s, &r, "MINRES iterations", f->report.linear_iterations, 0, 0);
    add_line(s, &r, "strain along / eps_c", f->skin_strain / r.critical, 0, 0);
    add_line(s, &r, "wavelength_fft / eq. 3", f->wavelength_fft / r.wavelength, 0, 0);
    add_line(s, &r, "amplitude / h", f->amplitude / r.thickness, 0, 0);
    return RUGA_OK;
}

static ruga_status run_paper(suite* s) {
    for (int ratio = 2; ratio <= 4; ratio++) {
        for (int k = 0; k < 4; k++) {
            RUGA_TRY(run_paper_once(s, pow(10, ratio), k / 2 ? 0 : 0.3, 1 + k % 2, 2));
        }
        RUGA_TRY(run_paper_once(s, pow(10, ratio), 0.3, 1, 0.4));
        RUGA_TRY(run_paper_once(s, pow(10, ratio), 0.3, 1, 1.2));
    }
    return RUGA_OK;
}

// ---- program -------------------------------------------------------------------------------------------

typedef struct group {
    const char* name;
    ruga_status (*function)(suite* s);
} group;

static const group GROUPS[] = {{"prescribed", run_prescribed}, {"foundation", run_foundation},
                               {"coupled", run_coupled},       {"clusters", run_clusters},
                               {"spectral", run_spectral},     {"paper", run_paper}};
enum { GROUP_COUNT = sizeof GROUPS / sizeof GROUPS[0] };

static FILE* open_output(const char* directory, const char* name) {
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE* file = fopen(path, "w");
    if (!file) {
        (void)fprintf(stderr, "physics: cannot write %s\n", path);
    }
    return file;
}

static bool run_groups(suite* s, int count, char* const* wanted) {
    for (int g = 0; g < GROUP_COUNT; g++) {
        bool chosen = count == 0;
        for (int k = 0; k < count; k++) {
            chosen = chosen || strcmp(wanted[k], GROUPS[g].name) == 0;
        }
        if (chosen && GROUPS[g].function(s) != RUGA_OK) {
            (void)fprintf(stderr, "physics: %s: %s\n", GROUPS[g].name, ruga_last_error());
            return false;
        }
    }
    return true;
}

int main(int argc, char** argv) {
    const char* directory = ".";
    suite s = {.line_count = 0};
    argc--;
    argv++;
    if (argc >= 2 && strcmp(argv[0], "-o") == 0) {
        directory = argv[1];
        argc -= 2;
        argv += 2;
    }
    s.frames = open_output(directory, "frames.csv");
    s.lines = open_output(directory, "lines.json");
    if (!s.frames || !s.lines) {
        return 3;
    }
    (void)fputs(
        "case,strain,strain_critical,skin_strain,across_strain,wavelength_ratio,wavelength_fft_ratio,"
        "amplitude_h,middle_amplitude_h,law_h,outcome,residual_shell,residual_coupled,constraint_residual,"
        "substeps,newton,linear,factorizations,seconds\n",
        s.frames);
    (void)fputs("[", s.lines);
    bool done = run_groups(&s, argc, argv);
    (void)fputs("\n]\n", s.lines);
    done = fclose(s.frames) == 0 && done;
    done = fclose(s.lines) == 0 && done;
    if (done && s.run_count == 0) {
        (void)fprintf(
            stderr,
            "physics: no such group; there are prescribed foundation coupled clusters spectral paper\n");
        return 2;
    }
    printf("%d runs, %d lines, %d failed\n", s.run_count, s.line_count, s.failures);
    return !done ? 3 : s.failures > 0;
}
