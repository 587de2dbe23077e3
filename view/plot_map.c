// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A map of a value over a grid: cells, a colour bar, and contours by marching squares. A square of four grid
// points with values above and below a level is crossed by one line, or by two where opposite corners are on
// the same side; which corners these separate is decided by the mean of the four.
#include "view/plot.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "view/axis.h"
#include "view/colormap.h"

#include <math.h>
#include <stdio.h>

enum { BAR_STEPS = 128 };
static const double SAMPLE = 26, BAR_WIDTH = 16;

typedef struct page {
    const ruga_map_def* def;
    ruga_canvas canvas;
    ruga_axis x, y, color;
    double *x_edge, *y_edge; // [columns + 1], [rows + 1]
} page;

typedef struct point {
    double x, y;
} point;

// ---- axes ----------------------------------------------------------------------------------------------

// Cells meet midway between their centres, as the axis is drawn; the outer ones are as wide as their
// neighbours.
static ruga_status find_edges(ruga_axis* axis, const char* name, int count, const double* center,
                              double* edge) {
    for (int i = 0; i < count; i++) {
        if (!ruga_axis_shows(axis, center[i]) || (i > 0 && center[i] <= center[i - 1])) {
            return ruga_fail(RUGA_BAD_INPUT, "map: the %ss must ascend%s, but number %d is %g", name,
                             axis->logarithmic ? " and be positive" : "", i + 1, center[i]);
        }
    }
    bool l = axis->logarithmic;
    for (int i = 1; i < count; i++) {
        edge[i] = l ? sqrt(center[i - 1] * center[i]) : 0.5 * (center[i - 1] + center[i]);
    }
    edge[0] = l ? center[0] * center[0] / edge[1] : 2 * center[0] - edge[1];
    edge[count] =
        l ? center[count - 1] * center[count - 1] / edge[count - 1] : 2 * center[count - 1] - edge[count - 1];
    axis->min = edge[0];
    axis->max = edge[count];
    return RUGA_OK;
}

static ruga_status fit_axes(page* p) {
    const ruga_map_def* d = p->def;
    p->x = ruga_axis_empty(d->x.logarithmic);
    p->y = ruga_axis_empty(d->y.logarithmic);
    RUGA_TRY(find_edges(&p->x, "column", d->columns, d->column, p->x_edge));
    RUGA_TRY(find_edges(&p->y, "row", d->rows, d->row, p->y_edge));
    p->color = ruga_axis_empty(false);
    for (int i = 0; i < d->rows * d->columns; i++) {
        ruga_axis_include(&p->color, d->value[i]);
    }
    if (p->color.min > p->color.max) {
        return ruga_fail(RUGA_BAD_INPUT, "map: none of its %d values is finite", d->rows * d->columns);
    }
    if (d->min != 0 || d->max != 0) {
        p->color.min = d->min;
        p->color.max = d->max;
    } else {
        ruga_axis_widen(&p->color, 0);
    }
    return p->color.max > p->color.min
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT, "map: the colours cannot run from %g to %g", d->min, d->max);
}

// ---- cells ---------------------------------------------------------------------------------------------

static void set_value_color(page* p, double value) {
    double rgb[3];
    ruga_colormap(RUGA_COLORMAP_DIVERGING, (value - p->color.min) / (p->color.max - p->color.min), rgb);
    ruga_canvas_color(
        &p->canvas, (unsigned)ruga_srgb(rgb[0]) << 16 | (unsigned)ruga_srgb(rgb[1]) << 8 | ruga_srgb(rgb[2]),
        1);
}

// Slanted strokes, each a point of the hatching's own lattice, so that neighbouring cells join.
static void hatch(page* p, double x0, double y0, double x1, double y1) {
    const double gap = 9;
    cairo_t* cairo = p->canvas.cairo;
    cairo_save(cairo);
    cairo_rectangle(cairo, x0, y0, x1 - x0, y1 - y0);
    cairo_clip(cairo);
    ruga_canvas_color(&p->canvas, 0x000000, 0.55);
    cairo_set_line_width(cairo, 0.8);
    for (double s = gap * floor((x0 + y0) / gap); s < x1 + y1; s += gap) {
        ruga_canvas_line(&p->canvas, s - y1, y1, s - y0, y0);
    }
    cairo_restore(cairo);
}

static void draw_cells(page* p) {
    const ruga_map_def* d = p->def;
    // Two cells meet in a line of pixels that antialiasing would let shine through.
    cairo_set_antialias(p->canvas.cairo, CAIRO_ANTIALIAS_NONE);
    for (int row = 0; row < d->rows; row++) {
        for (int column = 0; column < d->columns; column++) {
            double value = d->value[row * d->columns + column];
            double x0 = ruga_axis_place(&p->x, p->x_edge[column]),
                   x1 = ruga_axis_place(&p->x, p->x_edge[column + 1]);
            double y1 = ruga_axis_place(&p->y, p->y_edge[row]),
                   y0 = ruga_axis_place(&p->y, p->y_edge[row + 1]);
            if (isfinite(value)) {
                set_value_color(p, value);
                cairo_rectangle(p->canvas.cairo, x0, y0, x1 - x0, y1 - y0);
                cairo_fill(p->canvas.cairo);
            }
        }
    }
    cairo_set_antialias(p->canvas.cairo, CAIRO_ANTIALIAS_DEFAULT);
    for (int i = 0; d->marked && i < d->rows * d->columns; i++) {
        if (d->marked[i]) {
            int row = i / d->columns, column = i % d->columns;
            hatch(p, ruga_axis_place(&p->x, p->x_edge[column]), ruga_axis_place(&p->y, p->y_edge[row + 1]),
                  ruga_axis_place(&p->x, p->x_edge[column + 1]), ruga_axis_place(&p->y, p->y_edge[row]));
        }
    }
}

static void draw_color_bar(page* p) {
    ruga_tick ticks[RUGA_AXIS_TICKS];
    double x = p->x.to + 24, widest = 0;
    p->color.from = p->y.from;
    p->color.to = p->y.to;
    cairo_set_antialias(p->canvas.cairo, CAIRO_ANTIALIAS_NONE);
    for (int i = 0; i < BAR_STEPS; i++) {
        double low = ruga_axis_value(&p->color, (double)i / BAR_STEPS);
        double high = ruga_axis_value(&p->color, (i + 1.0) / BAR_STEPS);
        set_value_color(p, 0.5 * (low + high));
        double y1 = ruga_axis_place(&p->color, low), y0 = ruga_axis_place(&p->color, high);
        cairo_rectangle(p->canvas.cairo, x, y0, BAR_WIDTH, y1 - y0);
        cairo_fill(p->canvas.cairo);
    }
    cairo_set_antialias(p->canvas.cairo, CAIRO_ANTIALIAS_DEFAULT);
    ruga_canvas_color(&p->canvas, 0x000000, 1);
    cairo_set_line_width(p->canvas.cairo, 1);
    cairo_rectangle(p->canvas.cairo, x, p->y.to, BAR_WIDTH, p->y.from - p->y.to);
    cairo_stroke(p->canvas.cairo);
    int count = ruga_axis_ticks(&p->color, 6, ticks);
    for (int i = 0; i < count; i++) {
        double y = ruga_axis_place(&p->color, ticks[i].value);
        ruga_canvas_line(&p->canvas, x + BAR_WIDTH - 4, y, x + BAR_WIDTH, y);
        ruga_canvas_text(&p->canvas, x + BAR_WIDTH + 6, y, 0, 0.5, 0, ticks[i].label);
        widest = fmax(widest, ruga_canvas_text_width(&p->canvas, ticks[i].label));
    }
    ruga_canvas_text(&p->canvas, x + BAR_WIDTH + 14 + widest, 0.5 * (p->y.from + p->y.to), 0.5, 1,
                     0.5 * RUGA_PI, p->def->value_name ? p->def->value_name : "");
}

// ---- contours ------------------------------------------------------------------------------------------

typedef struct square {
    double value[4]; // about the level: less is below
    point corner[4]; // in turn
} square;

static point cross_edge(const square* s, int k) {
    int next = (k + 1) % 4;
    double t = s->value[k] / (s->value[k] - s->value[next]);
    return (point){s->corner[k].x + t * (s->corner[next].x - s->corner[k].x),
                   s->corner[k].y + t * (s->corner[next].y - s->corner[k].y)};
}

// The lines through a square, by the ends that they join: their number, at most 2.
static int cross_square(const square* s, point ends[4]) {
    int crossed[4], count = 0;
    for (int k = 0; k < 4; k++) {
        if ((s->value[k] >= 0) != (s->value[(k + 1) % 4] >= 0)) {
            crossed[count++] = k;
        }
    }
    // Four crossed edges: a line cuts off corner 1 (edges 0 and 1) where the mean is on the side of corner 0.
    double mean = s->value[0] + s->value[1] + s->value[2] + s->value[3];
    int shift = count == 4 && (mean >= 0) != (s->value[0] >= 0) ? 3 : 0;
    for (int i = 0; i < count; i++) {
        ends[i] = cross_edge(s, crossed[(i + shift) % count]);
    }
    return count / 2;
}

static double contour_value(const ruga_map_contours* c, double value) {
    return c->logarithmic ? (value > 0 ? log(value) : NAN) : value;
}

static bool find_square(const page* p, const ruga_map_contours* c, double level, int row, int column,
                        square* s) {
    const ruga_map_def* d = p->def;
    for (int k = 0; k < 4; k++) {
        int i = column + (k == 1 || k == 2), j = row + (k >= 2);
        s->value[k] = contour_value(c, c->value[j * d->columns + i]) - contour_value(c, level);
        s->corner[k] = (point){ruga_axis_place(&p->x, d->column[i]), ruga_axis_place(&p->y, d->row[j])};
        if (!isfinite(s->value[k])) {
            return false;
        }
    }
    return true;
}

static void set_contour_style(page* p, bool dashed) {
    static const double pattern[2] = {5, 4};
    ruga_canvas_color(&p->canvas, dashed ? 0x555555 : 0x000000, 1);
    cairo_set_line_width(p->canvas.cairo, dashed ? 1.1 : 1.5);
    cairo_set_dash(p->canvas.cairo, pattern, dashed ? 2 : 0, 0);
}

// Where the lines of a level come nearest to the map's middle: labels stand there, across the lines. False
// where there is no line.
static bool draw_level(page* p, const ruga_map_contours* c, double level, point* label) {
    double least = INFINITY, cx = 0.5 * (p->x.from + p->x.to), cy = 0.5 * (p->y.from + p->y.to);
    square s;
    point ends[4];
    set_contour_style(p, c->dashed);
    for (int row = 0; row + 1 < p->def->rows; row++) {
        for (int column = 0; column + 1 < p->def->columns; column++) {
            int lines = find_square(p, c, level, row, column, &s) ? cross_square(&s, ends) : 0;
            for (int i = 0; i < lines; i++) {
                point a = ends[2 * i], b = ends[2 * i + 1], m = {0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
                cairo_move_to(p->canvas.cairo, a.x, a.y);
                cairo_line_to(p->canvas.cairo, b.x, b.y);
                double distance = (m.x - cx) * (m.x - cx) + (m.y - cy) * (m.y - cy);
                if (distance < least) {
                    least = distance;
                    *label = m;
                }
            }
        }
    }
    cairo_stroke(p->canvas.cairo);
    cairo_set_dash(p->canvas.cairo, NULL, 0, 0);
    return isfinite(least);
}

static void draw_label(page* p, point at, const char* text) {
    double width = ruga_canvas_text_width(&p->canvas, text) + 8;
    ruga_canvas_color(&p->canvas, 0xffffff, 0.85);
    cairo_rectangle(p->canvas.cairo, at.x - 0.5 * width, at.y - 9, width, 18);
    cairo_fill(p->canvas.cairo);
    ruga_canvas_color(&p->canvas, 0x000000, 1);
    ruga_canvas_text(&p->canvas, at.x, at.y, 0.5, 0.5, 0, text);
}

static void draw_contours(page* p) {
    for (int k = 0; k < p->def->contours_count; k++) {
        const ruga_map_contours* c = &p->def->contours[k];
        for (int i = 0; i < c->level_count; i++) {
            char text[64];
            point at = {0};
            if (draw_level(p, c, c->level[i], &at) && c->unit) {
                (void)snprintf(text, sizeof text, "%.6g%s%s", c->level[i], c->unit[0] ? " " : "", c->unit);
                draw_label(p, at, text);
            }
        }
    }
}

// One row above the frame.
static void draw_legend(page* p) {
    double x = p->x.from, y = p->y.to - 15;
    for (int k = 0; k < p->def->contours_count; k++) {
        const ruga_map_contours* c = &p->def->contours[k];
        if (c->name) {
            set_contour_style(p, c->dashed);
            ruga_canvas_line(&p->canvas, x, y, x + SAMPLE, y);
            cairo_set_dash(p->canvas.cairo, NULL, 0, 0);
            ruga_canvas_color(&p->canvas, 0x000000, 1);
            ruga_canvas_text(&p->canvas, x + SAMPLE + 6, y, 0, 0.5, 0, c->name);
            x += SAMPLE + 24 + ruga_canvas_text_width(&p->canvas, c->name);
        }
    }
    if (p->def->marked && p->def->marked_name) {
        hatch(p, x, y - 7, x + SAMPLE, y + 7);
        ruga_canvas_color(&p->canvas, 0x000000, 1);
        ruga_canvas_text(&p->canvas, x + SAMPLE + 6, y, 0, 0.5, 0, p->def->marked_name);
    }
}

static ruga_status draw(page* p, const char* path) {
    const ruga_map_def* d = p->def;
    RUGA_TRY(
        ruga_canvas_open(path, d->width > 0 ? d->width : 720, d->height > 0 ? d->height : 540, &p->canvas));
    bool legend = d->contours_count > 0 || d->marked;
    p->x.from = 78;
    p->x.to = p->canvas.width - 118;
    p->y.from = p->canvas.height - 54;
    p->y.to = 18 + (d->title ? 22 : 0) + (legend ? 24 : 0);
    draw_cells(p);
    draw_contours(p);
    ruga_axis_draw_frame(&p->canvas, &p->x, &p->y, false, d->x.name, d->y.name);
    draw_color_bar(p);
    draw_legend(p);
    if (d->title) {
        ruga_canvas_color(&p->canvas, 0x000000, 1);
        ruga_canvas_text(&p->canvas, 0.5 * (p->x.from + p->x.to), 20, 0.5, 0.5, 0, d->title);
    }
    return ruga_canvas_close(&p->canvas, RUGA_OK);
}

ruga_status ruga_map_write(const ruga_map_def* def, const char* path) {
    ruga_status status = RUGA_OK;
    page p = {.def = def};
    if (def->columns < 2 || def->rows < 2) {
        return ruga_fail(RUGA_BAD_INPUT, "map: %d x %d cells are no map; at least 2 x 2 are needed",
                         def->columns, def->rows);
    }
    RUGA_TRY_DONE(RUGA_NEW(p.x_edge, def->columns + 1));
    RUGA_TRY_DONE(RUGA_NEW(p.y_edge, def->rows + 1));
    RUGA_TRY_DONE(fit_axes(&p));
    RUGA_TRY_DONE(draw(&p, path));
done:
    ruga_release(p.x_edge);
    ruga_release(p.y_edge);
    return status;
}
