// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "view/plot.h"

#include "core/vec3.h"
#include "view/axis.h"

#include <math.h>

enum { SHAPES = 4 };
static const double MARKER = 3.6, SAMPLE = 26, LEGEND_ROW = 20;

typedef struct page {
    const ruga_plot_def* def;
    ruga_canvas* canvas;
    ruga_axis x, y;
} page;

// Okabe and Ito's colours, which people with any colour vision can tell apart.
static unsigned series_color(const ruga_plot_def* def, int k) {
    static const unsigned palette[RUGA_PLOT_COLORS] = {0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7,
                                                       0xe69f00, 0x56b4e9, 0x000000};
    int place = def->series[k].color > 0 ? def->series[k].color - 1 : k;
    return palette[place % RUGA_PLOT_COLORS];
}

static bool shows(const page* p, const ruga_plot_series* s, int i) {
    return ruga_axis_shows(&p->x, s->x[i]) && ruga_axis_shows(&p->y, s->y[i]);
}

// ---- axes ----------------------------------------------------------------------------------------------

static ruga_status include_series(page* p, int k) {
    const ruga_plot_series* s = &p->def->series[k];
    int shown = 0;
    for (int i = 0; i < s->count; i++) {
        if (shows(p, s, i)) {
            shown++;
            ruga_axis_include(&p->x, s->x[i]);
            ruga_axis_include(&p->y, s->y[i]);
            ruga_axis_include(&p->y, s->low ? s->low[i] : NAN);
            ruga_axis_include(&p->y, s->high ? s->high[i] : NAN);
        }
    }
    if (shown == 0) {
        return ruga_fail(
            RUGA_BAD_INPUT, "plot: series %d%s%s has no point to draw: none of its %d is finite%s", k + 1,
            s->name ? ", " : "", s->name ? s->name : "", s->count,
            p->x.logarithmic || p->y.logarithmic ? " and positive where the axis is logarithmic" : "");
    }
    return RUGA_OK;
}

static ruga_status set_limits(ruga_axis* axis, const ruga_plot_axis* wanted, double part) {
    if (wanted->min == 0 && wanted->max == 0) {
        ruga_axis_widen(axis, part);
        return RUGA_OK;
    }
    axis->min = wanted->min;
    axis->max = wanted->max;
    bool good = ruga_axis_shows(axis, axis->min) && ruga_axis_shows(axis, axis->max) && axis->max > axis->min;
    return good ? RUGA_OK
                : ruga_fail(RUGA_BAD_INPUT, "plot: an axis cannot run from %g to %g", wanted->min,
                            wanted->max);
}

static ruga_status fit_axes(page* p) {
    if (p->def->series_count < 1) {
        return ruga_fail(RUGA_BAD_INPUT, "plot: there is no series to draw");
    }
    p->x = ruga_axis_empty(p->def->x.logarithmic);
    p->y = ruga_axis_empty(p->def->y.logarithmic);
    for (int k = 0; k < p->def->series_count; k++) {
        RUGA_TRY(include_series(p, k));
    }
    for (int k = 0; k < p->def->reference_count; k++) {
        ruga_axis_include(&p->y, p->def->references[k].y);
    }
    RUGA_TRY(set_limits(&p->x, &p->def->x, 0.03));
    return set_limits(&p->y, &p->def->y, 0.05);
}

// ---- series --------------------------------------------------------------------------------------------

static void trace_marker(ruga_canvas* canvas, int shape, double x, double y) {
    cairo_t* cairo = canvas->cairo;
    cairo_new_sub_path(cairo);
    if (shape == 0) {
        cairo_arc(cairo, x, y, MARKER, 0, 2 * RUGA_PI);
        return;
    }
    // A square, a triangle that stands, and a square on its corner, of about equal area.
    int corners = shape == 2 ? 3 : 4;
    double radius = (shape == 2 ? 1.45 : 1.3) * MARKER, turn = shape == 1 ? 0.25 * RUGA_PI : 0.5 * RUGA_PI;
    for (int i = 0; i < corners; i++) {
        double angle = turn + 2 * RUGA_PI * i / corners;
        cairo_line_to(cairo, x + radius * cos(angle), y - radius * sin(angle));
    }
    cairo_close_path(cairo);
}

static void draw_markers(page* p, int k) {
    const ruga_plot_series* s = &p->def->series[k];
    for (int i = 0; i < s->count; i++) {
        if (shows(p, s, i)) {
            trace_marker(p->canvas, k % SHAPES, ruga_axis_place(&p->x, s->x[i]),
                         ruga_axis_place(&p->y, s->y[i]));
        }
    }
    ruga_canvas_color(p->canvas, series_color(p->def, k), 1);
    cairo_fill(p->canvas->cairo);
}

static void set_dash(cairo_t* cairo, bool dashed) {
    static const double pattern[2] = {6, 4};
    cairo_set_dash(cairo, pattern, dashed ? 2 : 0, 0);
}

static void draw_line(page* p, int k) {
    const ruga_plot_series* s = &p->def->series[k];
    cairo_t* cairo = p->canvas->cairo;
    bool pen_down = false;
    for (int i = 0; i < s->count; i++) {
        if (!shows(p, s, i)) {
            pen_down = false;
            continue;
        }
        double x = ruga_axis_place(&p->x, s->x[i]), y = ruga_axis_place(&p->y, s->y[i]);
        (pen_down ? cairo_line_to : cairo_move_to)(cairo, x, y);
        pen_down = true;
    }
    ruga_canvas_color(p->canvas, series_color(p->def, k), 1);
    cairo_set_line_width(cairo, 1.5);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    set_dash(cairo, s->style == RUGA_PLOT_DASHED);
    cairo_stroke(cairo);
    set_dash(cairo, false);
}

static bool has_range(const page* p, const ruga_plot_series* s, int i) {
    return ruga_axis_shows(&p->x, s->x[i]) && ruga_axis_shows(&p->y, s->low[i]) &&
           ruga_axis_shows(&p->y, s->high[i]);
}

// Runs of points with a range, each a polygon along the upper and back along the lower end.
static void draw_band(page* p, int k) {
    const ruga_plot_series* s = &p->def->series[k];
    for (int first = 0, next; first < s->count; first = next + 1) {
        for (next = first; next < s->count && has_range(p, s, next); next++) {
            cairo_line_to(p->canvas->cairo, ruga_axis_place(&p->x, s->x[next]),
                          ruga_axis_place(&p->y, s->high[next]));
        }
        for (int i = next - 1; i >= first; i--) {
            cairo_line_to(p->canvas->cairo, ruga_axis_place(&p->x, s->x[i]),
                          ruga_axis_place(&p->y, s->low[i]));
        }
        cairo_close_path(p->canvas->cairo);
    }
    ruga_canvas_color(p->canvas, series_color(p->def, k), 0.16);
    cairo_fill(p->canvas->cairo);
}

static void draw_bars(page* p, int k) {
    const ruga_plot_series* s = &p->def->series[k];
    ruga_canvas_color(p->canvas, series_color(p->def, k), 1);
    cairo_set_line_width(p->canvas->cairo, 1);
    for (int i = 0; i < s->count; i++) {
        if (has_range(p, s, i)) {
            double x = ruga_axis_place(&p->x, s->x[i]);
            double low = ruga_axis_place(&p->y, s->low[i]), high = ruga_axis_place(&p->y, s->high[i]);
            ruga_canvas_line(p->canvas, x, low, x, high);
            ruga_canvas_line(p->canvas, x - 3, low, x + 3, low);
            ruga_canvas_line(p->canvas, x - 3, high, x + 3, high);
        }
    }
}

static void draw_reference(page* p, double x0, double x1, double y) {
    static const double pattern[2] = {2, 3};
    ruga_canvas_color(p->canvas, 0x444444, 1);
    cairo_set_line_width(p->canvas->cairo, 1.2);
    cairo_set_dash(p->canvas->cairo, pattern, 2, 0);
    ruga_canvas_line(p->canvas, x0, y, x1, y);
    set_dash(p->canvas->cairo, false);
}

// `margin`: a marker on the frame is seen whole.
static void clip_to_frame(page* p, double margin) {
    cairo_rectangle(p->canvas->cairo, p->x.from - margin, p->y.to - margin, p->x.to - p->x.from + 2 * margin,
                    p->y.from - p->y.to + 2 * margin);
    cairo_clip(p->canvas->cairo);
}

static void draw_data(page* p) {
    const ruga_plot_def* d = p->def;
    cairo_save(p->canvas->cairo);
    clip_to_frame(p, 0);
    for (int k = 0; k < d->series_count; k++) {
        if (d->series[k].low && d->series[k].high) {
            (d->series[k].bars ? draw_bars : draw_band)(p, k);
        }
    }
    for (int k = 0; k < d->reference_count; k++) {
        if (ruga_axis_shows(&p->y, d->references[k].y)) {
            draw_reference(p, p->x.from, p->x.to, ruga_axis_place(&p->y, d->references[k].y));
        }
    }
    for (int k = 0; k < d->series_count; k++) {
        if (d->series[k].style != RUGA_PLOT_MARKERS) {
            draw_line(p, k);
        }
    }
    cairo_restore(p->canvas->cairo);
    cairo_save(p->canvas->cairo);
    clip_to_frame(p, 1.5 * MARKER);
    for (int k = 0; k < d->series_count; k++) {
        if (d->series[k].style <= RUGA_PLOT_MARKERS) {
            draw_markers(p, k);
        }
    }
    cairo_restore(p->canvas->cairo);
}

// ---- legend --------------------------------------------------------------------------------------------

static double legend_width(page* p) {
    double widest = 0;
    for (int k = 0; k < p->def->series_count; k++) {
        const char* name = p->def->series[k].name;
        widest = fmax(widest, name ? ruga_canvas_text_width(p->canvas, name) : 0);
    }
    for (int k = 0; k < p->def->reference_count; k++) {
        const char* name = p->def->references[k].name;
        widest = fmax(widest, name ? ruga_canvas_text_width(p->canvas, name) : 0);
    }
    return widest > 0 ? widest + SAMPLE + 30 : 0;
}

static void draw_series_sample(page* p, int k, double x, double y) {
    const ruga_plot_series* s = &p->def->series[k];
    cairo_t* cairo = p->canvas->cairo;
    if (s->low && s->high && !s->bars) {
        ruga_canvas_color(p->canvas, series_color(p->def, k), 0.16);
        cairo_rectangle(cairo, x, y - 6, SAMPLE, 12);
        cairo_fill(cairo);
    }
    ruga_canvas_color(p->canvas, series_color(p->def, k), 1);
    if (s->style != RUGA_PLOT_MARKERS) {
        cairo_set_line_width(cairo, 1.5);
        set_dash(cairo, s->style == RUGA_PLOT_DASHED);
        ruga_canvas_line(p->canvas, x, y, x + SAMPLE, y);
        set_dash(cairo, false);
    }
    if (s->style <= RUGA_PLOT_MARKERS) {
        trace_marker(p->canvas, k % SHAPES, x + 0.5 * SAMPLE, y);
        cairo_fill(cairo);
    }
}

// Outside of the frame, where it hides nothing.
static void draw_legend(page* p) {
    double x = p->x.to + 14, y = p->y.to + 10;
    for (int k = 0; k < p->def->series_count; k++) {
        if (p->def->series[k].name) {
            draw_series_sample(p, k, x, y);
            ruga_canvas_color(p->canvas, 0x000000, 1);
            ruga_canvas_text(p->canvas, x + SAMPLE + 6, y, 0, 0.5, 0, p->def->series[k].name);
            y += LEGEND_ROW;
        }
    }
    for (int k = 0; k < p->def->reference_count; k++) {
        if (p->def->references[k].name) {
            draw_reference(p, x, x + SAMPLE, y);
            ruga_canvas_color(p->canvas, 0x000000, 1);
            ruga_canvas_text(p->canvas, x + SAMPLE + 6, y, 0, 0.5, 0, p->def->references[k].name);
            y += LEGEND_ROW;
        }
    }
}

static double width_of(const ruga_plot_def* def) {
    return def->width > 0 ? def->width : 720;
}

static double height_of(const ruga_plot_def* def) {
    return def->height > 0 ? def->height : 450;
}

// Within the canvas, from the place that cairo was moved to.
static void draw_plot(page* p) {
    const ruga_plot_def* def = p->def;
    p->x.from = 78;
    p->x.to = width_of(def) - fmax(legend_width(p), 22);
    p->y.from = height_of(def) - 54;
    p->y.to = def->title ? 38 : 18;
    ruga_axis_draw_frame(p->canvas, &p->x, &p->y, true, def->x.name, def->y.name);
    draw_data(p);
    draw_legend(p);
    if (def->title) {
        ruga_canvas_color(p->canvas, 0x000000, 1);
        ruga_canvas_text(p->canvas, 0.5 * (p->x.from + p->x.to), 20, 0.5, 0.5, 0, def->title);
    }
}

ruga_status ruga_plot_write_page(int count, const ruga_plot_def* defs, int columns, const char* path) {
    double width = 0, height = 0, row = 0, across = 0;
    ruga_canvas canvas;
    for (int k = 0; k < count; k++) {
        page p = {.def = &defs[k]};
        RUGA_TRY(fit_axes(&p)); // before anything is written
        across = k % columns == 0 ? width_of(&defs[k]) : across + width_of(&defs[k]);
        row = k % columns == 0 ? height_of(&defs[k]) : fmax(row, height_of(&defs[k]));
        width = fmax(width, across);
        height += k % columns == columns - 1 || k == count - 1 ? row : 0;
    }
    RUGA_TRY(ruga_canvas_open(path, width, height, &canvas));
    ruga_status status = RUGA_OK;
    double x = 0, y = 0;
    for (int k = 0; k < count && status == RUGA_OK; k++) {
        page p = {.def = &defs[k], .canvas = &canvas};
        status = fit_axes(&p);
        cairo_save(canvas.cairo);
        cairo_translate(canvas.cairo, x, y);
        draw_plot(&p);
        cairo_restore(canvas.cairo);
        bool last = k % columns == columns - 1;
        row = k % columns == 0 ? height_of(&defs[k]) : fmax(row, height_of(&defs[k]));
        x = last ? 0 : x + width_of(&defs[k]);
        y += last ? row : 0;
    }
    return ruga_canvas_close(&canvas, status);
}

ruga_status ruga_plot_write(const ruga_plot_def* def, const char* path) {
    return ruga_plot_write_page(1, def, 1, path);
}
