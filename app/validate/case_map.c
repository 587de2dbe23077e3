// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Figure 7 of Remillard and Kry (2013): wavelength over thickness and ratio of Young's moduli, on a slab of
// one length. Physics knows no scale, so that thickness counts through the number of waves that fit in the
// length.
#include "app/meter.h"
#include "app/validate/band.h"
#include "app/validate/cases.h"
#include "app/validate/sheet.h"
#include "core/memory.h"
#include "io/writer.h"
#include "mesh/make.h"

#include <math.h>
#include <stdio.h>

enum { RATIOS = 6, THICKNESSES = 6, POINTS = RATIOS * THICKNESSES };
static const double LENGTH = 0.4;   // m
static const double FEW_WAVES = 12; // fewer are not judged
static const double LEAST_WAVES =
    6; // fewer are not run: the sheet of 3 wavelengths' width would hardly be longer
static const double LEAST_EDGES = 8;
static const double TOLERANCE = 0.05;

typedef struct map_point {
    sheet_def def;
    bool wanted, judged;
    int vertices;
    double edges;      // per wavelength, of the mesh as made
    double wavelength; // eq. 3, m
    double critical;
    sheet_frame frame;
} map_point;

typedef struct map {
    map_point points[POINTS]; // [thickness][ratio]
    double ratio[RATIOS], thickness[THICKNESSES];
    int wanted;
} map;

// ---- points --------------------------------------------------------------------------------------------

static void set_points(map* m, bool quick) {
    // On the diagonal of about 20 wavelengths, which crosses the whole range of both.
    static const int quick_points[4][2] = {{0, 5}, {1, 4}, {3, 2}, {5, 0}};
    for (int i = 0; i < RATIOS; i++) {
        m->ratio[i] = pow(10, 1.5 + 0.5 * i);
    }
    for (int j = 0; j < THICKNESSES; j++) {
        m->thickness[j] = 2e-4 * pow(8, j / (THICKNESSES - 1.0));
    }
    for (int k = 0; k < POINTS; k++) {
        map_point* p = &m->points[k];
        p->def = sheet_default();
        p->def.ratio = m->ratio[k % RATIOS];
        p->def.thickness = m->thickness[k / RATIOS];
        p->wavelength = sheet_wavelength(&p->def);
        p->def.length = LENGTH / p->wavelength;
        p->def.edges = 8.5;
        p->wanted = !quick && p->def.length >= LEAST_WAVES;
        for (int q = 0; q < 4; q++) {
            p->wanted = p->wanted || (quick && k == quick_points[q][0] + RATIOS * quick_points[q][1]);
        }
        m->wanted += p->wanted;
    }
}

static ruga_status look_at_mesh(map_point* p) {
    ruga_mesh mesh = {0};
    ruga_make_def make = {.shape = RUGA_SHAPE_SHEET,
                          .size = {p->def.length * p->wavelength, p->def.width * p->wavelength, 0},
                          .edge = p->wavelength / p->def.edges};
    RUGA_TRY(ruga_mesh_make(&make, &mesh));
    p->vertices = mesh.vertex_count;
    p->edges = p->wavelength / ruga_mesh_mean_edge(&mesh);
    p->judged = p->def.length >= FEW_WAVES && p->edges >= LEAST_EDGES;
    ruga_mesh_clear(&mesh);
    return RUGA_OK;
}

static ruga_status run_points(map* m) {
    static const double strain[] = {2};
    for (int k = 0; k < POINTS; k++) {
        map_point* p = &m->points[k];
        double wavelength, thickness;
        p->def.strain = strain;
        p->def.count = 1;
        if (p->wanted) {
            RUGA_TRY(look_at_mesh(p));
            RUGA_TRY(sheet_run(&p->def, &p->frame, &wavelength, &p->critical, &thickness));
        }
    }
    return RUGA_OK;
}

static double ours_over_law(const map_point* p) {
    return p->wanted && p->frame.wavelength_fft > 0 ? p->frame.wavelength_fft / p->wavelength : NAN;
}

// ---- lines ---------------------------------------------------------------------------------------------

static void state_lines(ruga_validation* v, const map* m) {
    int judged = 0, minima = 0, few_waves = 0, few_edges = 0;
    double worst = 0, sum = 0;
    for (int k = 0; k < POINTS; k++) {
        const map_point* p = &m->points[k];
        char name[96];
        minima += p->wanted && p->frame.report.outcome == RUGA_OUTCOME_MINIMUM;
        few_waves += p->def.length < FEW_WAVES;
        few_edges += p->wanted && p->edges < LEAST_EDGES;
        if (p->wanted && p->judged) {
            double part = ours_over_law(p) - 1;
            (void)snprintf(name, sizeof name,
                           "h %.3g mm, ratio 1e%.1f (%.0f waves): wavelength at 2 eps_c, m",
                           1e3 * p->def.thickness, log10(p->def.ratio), p->def.length);
            ruga_validation_near(v, name, p->frame.wavelength_fft, p->wavelength, TOLERANCE, "eq. 3");
            judged++;
            sum += part;
            worst = fabs(part) > fabs(worst) ? part : worst;
        }
    }
    ruga_validation_near(v, "points in a minimum", minima, m->wanted, 0, "all that were run");
    ruga_validation_record(v, "points judged", judged, NAN, "of 36 in the grid");
    ruga_validation_record(v, "mean of ours over eq. 3", 1 + sum / judged, 1, "eq. 3");
    ruga_validation_record(v, "ours over eq. 3 where it is farthest off", 1 + worst, 1, "eq. 3");
    if (ruga_validation_is_quick(v)) {
        return;
    }
    ruga_validation_note(
        v,
        "The slab is %.0f cm long. %d points of the thick, stiff corner are not judged because fewer "
        "than %.0f wavelengths fit; those with at least %.0f were run all the same and are in the "
        "table and, hatched, on the map. %d points have fewer than %.0f edges per wavelength.",
        100 * LENGTH, few_waves, FEW_WAVES, LEAST_WAVES, few_edges, LEAST_EDGES);
}

// ---- table and pictures --------------------------------------------------------------------------------

static ruga_status write_table(ruga_validation* v, const map* m) {
    char path[RUGA_VALIDATION_PATH];
    ruga_writer writer;
    ruga_validation_file(v, "table.csv", "Table of all points", path);
    RUGA_TRY(ruga_writer_open(path, &writer));
    (void)fputs("ratio,thickness_m,waves,vertices,edges_per_wavelength,critical_strain,wavelength_eq3_m,"
                "wavelength_fft_m,ours_over_eq3,amplitude_m,outcome,judged\n",
                writer.file);
    for (int k = 0; k < POINTS; k++) {
        const map_point* p = &m->points[k];
        if (p->wanted) {
            (void)fprintf(writer.file, "%.6g,%.6g,%.4g,%d,%.4g,%.6g,%.6g,%.6g,%.4f,%.6g,%s,%s\n",
                          p->def.ratio, p->def.thickness, p->def.length, p->vertices, p->edges, p->critical,
                          p->wavelength, p->frame.wavelength_fft, ours_over_law(p), p->frame.amplitude,
                          ruga_outcome_name(p->frame.report.outcome), p->judged ? "yes" : "no");
        }
    }
    return ruga_writer_close(&writer, RUGA_OK);
}

static ruga_status draw_ratios(ruga_validation* v, const map* m) {
    char path[RUGA_VALIDATION_PATH], names[THICKNESSES][48];
    double x[POINTS], y[POINTS];
    static const double ends[2] = {10, 30000}, one[2] = {1, 1}, low[2] = {1 - 0.05, 1 - 0.05},
                        high[2] = {1 + 0.05, 1 + 0.05};
    ruga_plot_series series[THICKNESSES + 1] = {reference_band("eq. 3, 5 %", 2, ends, one, low, high)};
    int count = 1;
    for (int j = 0; j < THICKNESSES; j++) {
        int judged = 0;
        for (int k = j * RATIOS; k < (j + 1) * RATIOS; k++) {
            x[k] = m->ratio[k % RATIOS];
            y[k] = m->points[k].judged ? ours_over_law(&m->points[k]) : NAN;
            judged += isfinite(y[k]) != 0;
        }
        (void)snprintf(names[j], sizeof names[j], "h = %.2g mm", 1e3 * m->thickness[j]);
        if (judged > 0) {
            series[count++] = (ruga_plot_series){.name = names[j],
                                                 .count = RATIOS,
                                                 .x = x + (ptrdiff_t)j * RATIOS,
                                                 .y = y + (ptrdiff_t)j * RATIOS,
                                                 .style = RUGA_PLOT_BOTH,
                                                 .color = j + 1};
        }
    }
    ruga_validation_file(v, "ratios.svg",
                         "Wavelength over eq. 3 at the points judged; the band is the tolerance", path);
    return ruga_plot_write(
        &(ruga_plot_def){.x = {.name = "Young's modulus of the skin over that of the interior",
                               .logarithmic = true,
                               .min = 20,
                               .max = 16000},
                         .y = {.name = "wavelength / eq. 3", .min = 0.9, .max = 1.1},
                         .series_count = count,
                         .series = series},
        path);
}

static ruga_status draw_map(ruga_validation* v, const map* m) {
    char path[RUGA_VALIDATION_PATH];
    double part[POINTS], ours[POINTS], law[POINTS], row[THICKNESSES];
    bool marked[POINTS];
    static const double level[] = {4, 8, 16, 32, 64};
    for (int j = 0; j < THICKNESSES; j++) {
        row[j] = 1e3 * m->thickness[j];
    }
    for (int k = 0; k < POINTS; k++) {
        const map_point* p = &m->points[k];
        part[k] = ours_over_law(p);
        law[k] = 1e3 * p->wavelength;
        ours[k] = law[k] * part[k];
        marked[k] = !p->judged;
    }
    const ruga_map_contours contours[] = {{.name = "wavelength, ours",
                                           .value = ours,
                                           .logarithmic = true,
                                           .level_count = 5,
                                           .level = level,
                                           .unit = "mm"},
                                          {.name = "eq. 3",
                                           .value = law,
                                           .logarithmic = true,
                                           .dashed = true,
                                           .level_count = 5,
                                           .level = level}};
    ruga_validation_file(
        v, "map.svg",
        "Wavelength over thickness and stiffness (figure 7): lines of equal wavelength, ours over "
        "those of eq. 3; the colour is ours over eq. 3, white where the sheet would be too short to run",
        path);
    return ruga_map_write(
        &(ruga_map_def){
            .x = {.name = "Young's modulus of the skin over that of the interior", .logarithmic = true},
            .y = {.name = "thickness, mm", .logarithmic = true},
            .columns = RATIOS,
            .rows = THICKNESSES,
            .column = m->ratio,
            .row = row,
            .value = part,
            .value_name = "wavelength / eq. 3",
            .min = 0.9,
            .max = 1.1,
            .marked = marked,
            .marked_name = "fewer than 12 waves: not judged",
            .contours_count = 2,
            .contours = contours},
        path);
}

static ruga_status run(ruga_validation* v) {
    ruga_status status = RUGA_OK;
    map* m = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(m, 1));
    set_points(m, ruga_validation_is_quick(v));
    RUGA_TRY_DONE(run_points(m));
    state_lines(v, m);
    RUGA_TRY_DONE(write_table(v, m));
    RUGA_TRY_DONE(draw_ratios(v, m));
    if (!ruga_validation_is_quick(v)) {
        RUGA_TRY_DONE(draw_map(v, m));
    }
done:
    ruga_release(m);
    return status;
}

const ruga_validation_case ruga_validate_map = {
    .name = "map",
    .title = "Wavelength over thickness and stiffness",
    .about =
        "Figure 7 of the paper: a slab of 40 cm, 3 wavelengths wide, on a prescribed, box-filled interior "
        "with the "
        "default coupling, compressed along its length to twice the critical strain. Thickness runs over a "
        "factor "
        "of 8, the ratio of Young's moduli from 10^1.5 to 10^4; the mesh is made anew for each point, with "
        "8.5 "
        "edges per wavelength. The wavelength by FFT is held against eq. 3 wherever at least 12 waves fit. "
        "`ruga sweep` makes such maps of any scene; `examples/wavelength_map.yaml` is one.",
    .quick = true,
    .run = run,
};
