// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga plot: what a result says over time, or columns of a table, as SVG or PNG.
#include "app/command.h"
#include "app/console.h"
#include "app/frames.h"
#include "app/panels.h"
#include "core/memory.h"
#include "io/csv.h"
#include "view/plot.h"

#include <math.h>
#include <string.h>

enum { SERIES_MAX = 7, PAGE_COLUMNS = 2 };

static const char axes[] = "none|x|y|xy";

static const ruga_option options[] = {
    {"--what", NULL, "LIST",
     "plots with commas between them. Of a result: energy, residual, iterations, seconds,\n"
     "wavelength, amplitude, angle, force [all that it has]. Of a CSV table: names of\n"
     "columns, with + between those of one plot [each; of many\n"
     "those that vary, twelve at most]",
     false},
    {"--x", NULL, "COLUMN", "of a CSV table: the column along the x axis [the first]", false},
    {"--log", NULL, axes, "of a CSV table: logarithmic axes [none]", false},
    {"--output", "-o", "FILE", "the file to write, .svg or .png", false},
    {0},
};

static ruga_status write_page(const ruga_arguments* arguments, int count, ruga_plot_def* defs,
                              const char* path) {
    RUGA_TRY(ruga_plot_write_page(count, defs, count > 1 ? PAGE_COLUMNS : 1, path));
    ruga_say(arguments, "%s\n", path);
    return RUGA_OK;
}

// ---- a result ------------------------------------------------------------------------------------------

static int take_series(const ruga_panels* panels, const ruga_panel* panel, ruga_plot_series* series) {
    for (int k = 0; k < panel->series_count; k++) {
        const ruga_panel_series* s = &panel->series[k];
        bool again = k >= RUGA_PLOT_COLORS; // in a colour that was there before
        series[k] = (ruga_plot_series){.name = s->name,
                                       .count = panels->frame_count,
                                       .x = panels->time,
                                       .y = s->y,
                                       .low = s->low,
                                       .high = s->high,
                                       .style = panels->frame_count <= 60 ? RUGA_PLOT_BOTH
                                                : again                   ? RUGA_PLOT_DASHED
                                                                          : RUGA_PLOT_LINE};
    }
    return panel->series_count;
}

static ruga_status plot_panels(const ruga_arguments* arguments, const ruga_panels* panels, const char* path) {
    static const int width = 720, height = 360;
    ruga_plot_def defs[RUGA_PANELS_MAX] = {0};
    ruga_plot_series series[RUGA_PANELS_MAX][RUGA_PANEL_SERIES];
    ruga_plot_reference reference[RUGA_PANELS_MAX];
    for (int p = 0; p < panels->count; p++) {
        const ruga_panel* panel = &panels->panel[p];
        reference[p] = (ruga_plot_reference){panel->reference, panel->reference_name};
        defs[p] = (ruga_plot_def){.width = width,
                                  .height = height,
                                  .x = {.name = "time, s"},
                                  .y = {.name = panel->axis, .logarithmic = panel->logarithmic},
                                  .series_count = take_series(panels, panel, series[p]),
                                  .series = series[p],
                                  .reference_count = panel->reference_name != NULL,
                                  .references = &reference[p]};
    }
    return write_page(arguments, panels->count, defs, path);
}

static ruga_status plot_result(const ruga_arguments* arguments, const char* path) {
    ruga_result_reader* reader = NULL;
    ruga_panels panels = {0};
    ruga_status status = RUGA_OK;
    RUGA_TRY(ruga_open_result(ruga_operand(arguments), &reader));
    RUGA_TRY_DONE(
        ruga_panels_read(ruga_operand(arguments), reader, ruga_value(arguments, "--what"), &panels));
    RUGA_TRY_DONE(plot_panels(arguments, &panels, path));
done:
    ruga_panels_clear(&panels);
    ruga_result_reader_close(&reader);
    return status;
}

// ---- a table -------------------------------------------------------------------------------------------

static ruga_status find_column(const ruga_csv* csv, const char* file, const char* name, size_t length,
                               int* column) {
    char names[1024] = "", word[48], sentence[256];
    *column = ruga_csv_find(csv, name, length);
    if (*column >= 0) {
        return RUGA_OK;
    }
    for (int c = 0; c < csv->column_count; c++) {
        size_t used = strlen(names);
        (void)snprintf(names + used, sizeof names - used, "%s%s", c > 0 ? "|" : "", csv->name[c]);
    }
    (void)snprintf(word, sizeof word, "%.*s", (int)(length < 40 ? length : 40), name);
    (void)snprintf(sentence, sizeof sentence, "%.120s has no column %s", file, word);
    ruga_suggest(names, word, sentence, sizeof sentence);
    return ruga_fail(RUGA_BAD_INPUT, "%s", sentence);
}

static bool has_numbers(const ruga_csv* csv, int column) {
    for (int i = 0; i < csv->row_count; i++) {
        if (csv->column[column][i] == csv->column[column][i]) {
            return true;
        }
    }
    return false;
}

typedef struct table {
    const char* file;
    ruga_csv csv;
    int x;
    bool log_x, log_y;
    int count;
    ruga_plot_def defs[RUGA_PANELS_MAX];
    ruga_plot_series series[RUGA_PANELS_MAX][SERIES_MAX];
} table;

// Points that go back and forth along x are not joined.
static bool ascends(const ruga_csv* csv, int column) {
    for (int i = 1; i < csv->row_count; i++) {
        if (csv->column[column][i] < csv->column[column][i - 1]) {
            return false;
        }
    }
    return true;
}

static ruga_status start_plot(table* t, const char* name) {
    if (t->count >= RUGA_PANELS_MAX) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: at most %d plots on a page; --what chooses columns", t->file,
                         RUGA_PANELS_MAX);
    }
    t->defs[t->count] = (ruga_plot_def){.width = 720,
                                        .height = 360,
                                        .x = {.name = t->csv.name[t->x], .logarithmic = t->log_x},
                                        .y = {.name = name, .logarithmic = t->log_y},
                                        .series = t->series[t->count]};
    t->count++;
    return RUGA_OK;
}

static ruga_status add_column(table* t, int column, bool named) {
    ruga_plot_def* def = &t->defs[t->count - 1];
    if (def->series_count >= SERIES_MAX) {
        return ruga_fail(RUGA_BAD_INPUT, "--what: at most %d columns in one plot", SERIES_MAX);
    }
    t->series[t->count - 1][def->series_count++] =
        (ruga_plot_series){.name = named ? t->csv.name[column] : NULL,
                           .count = t->csv.row_count,
                           .x = t->csv.column[t->x],
                           .y = t->csv.column[column],
                           .style = ascends(&t->csv, t->x) ? RUGA_PLOT_BOTH : RUGA_PLOT_MARKERS};
    return RUGA_OK;
}

// "a,b+c": a plot of a, and one of b and c.
static ruga_status take_named(table* t, const char* what) {
    for (const char* plot = what; *plot;) {
        size_t whole = strcspn(plot, ",");
        bool several = memchr(plot, '+', whole) != NULL;
        RUGA_TRY(start_plot(t, NULL));
        for (const char* name = plot; name < plot + whole;) {
            size_t length = strcspn(name, "+,");
            int column;
            RUGA_TRY(find_column(&t->csv, t->file, name, length, &column));
            RUGA_TRY(add_column(t, column, several));
            t->defs[t->count - 1].y.name = several ? NULL : t->csv.name[column];
            name += length + (name[length] == '+');
        }
        plot += whole + (plot[whole] == ',');
    }
    return RUGA_OK;
}

static bool varies(const ruga_csv* csv, int column) {
    const double* value = csv->column[column];
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < csv->row_count; i++) {
        low = fmin(low, value[i]);
        high = fmax(high, value[i]);
    }
    return low < high;
}

// Of more columns than there is room for, the first of those that vary.
static ruga_status take_all(const ruga_arguments* arguments, table* t) {
    int count = 0, left = 0;
    for (int c = 0; c < t->csv.column_count; c++) {
        count += c != t->x && has_numbers(&t->csv, c);
    }
    for (int c = 0; c < t->csv.column_count; c++) {
        if (c == t->x || !has_numbers(&t->csv, c)) {
            continue;
        }
        if (count > RUGA_PANELS_MAX && (t->count == RUGA_PANELS_MAX || !varies(&t->csv, c))) {
            left++;
            continue;
        }
        RUGA_TRY(start_plot(t, t->csv.name[c]));
        RUGA_TRY(add_column(t, c, false));
    }
    if (left > 0) {
        ruga_warn(arguments, "%s: %d of its %d columns of numbers are left out; --what chooses others",
                  t->file, left, count);
    }
    return t->count > 0 ? RUGA_OK : ruga_fail(RUGA_BAD_INPUT, "%s has no column of numbers to plot", t->file);
}

static ruga_status plot_table(const ruga_arguments* arguments, const char* path) {
    const char *x = ruga_value(arguments, "--x"), *what = ruga_value(arguments, "--what");
    int logarithmic = 0;
    table t = {.file = ruga_operand(arguments)};
    ruga_status status = RUGA_OK;
    RUGA_TRY(ruga_option_choice(arguments, "--log", axes, &logarithmic));
    RUGA_TRY(ruga_check_input(t.file));
    RUGA_TRY(ruga_csv_read(t.file, &t.csv));
    t.log_x = logarithmic & 1;
    t.log_y = logarithmic & 2;
    if (x) {
        RUGA_TRY_DONE(find_column(&t.csv, t.file, x, strlen(x), &t.x));
    }
    RUGA_TRY_DONE(what ? take_named(&t, what) : take_all(arguments, &t));
    RUGA_TRY_DONE(write_page(arguments, t.count, t.defs, path));
done:
    ruga_csv_clear(&t.csv);
    return status;
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    const char *path, *operand = ruga_operand(arguments), *dot = strrchr(operand, '.');
    RUGA_TRY(ruga_required(arguments, "--output", &path));
    RUGA_TRY(ruga_check_output(path));
    return dot && strcmp(dot, ".csv") == 0 ? plot_table(arguments, path) : plot_result(arguments, path);
}

const ruga_command ruga_plot_command = {
    .name = "plot",
    .operand = "RESULT|CSV",
    .usage = "[--what LIST] -o FILE.svg|png",
    .summary = "plot what a result says over time, or columns of a table",
    .about = "Draws energies, residuals, iterations and times of the solver, wavelength and amplitude of the "
             "wrinkles,\n"
             "fold angles of creases and forces of handles over time, as far as the result has them; or "
             "columns of a\n"
             "CSV table, such as that of a sweep, over another.",
    .example = "    ruga plot pillow.h5 --what energy,wavelength -o pillow.svg",
    .options = options,
    .run = run,
};
