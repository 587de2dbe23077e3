// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The bar is 1, 2 or 5 times a power of ten long, and as long as that allows within a fifth of the picture's
// width. It is true at the middle of what is seen, in the plane across the view.
#include "view/legend.h"

#include "core/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const unsigned INK = 0x22262b;

static const ruga_scale* scale_of(const ruga_render_def* def) {
    return def->scalar.value && def->scalar.name ? &def->scalar
           : def->lines.value && def->lines.name ? &def->lines
                                                 : NULL;
}

static double font_of(int height) {
    return fmax(9, 0.021 * height);
}

double ruga_legend_foot(const ruga_render_def* def) {
    double lines = scale_of(def) ? 5.2 : def->scale_bar || def->note ? 2.4 : 0;
    return fmin(lines * font_of(def->height) / def->height, 0.35);
}

// "20 cm", "500 µm"
static void write_length(double metres, char text[32]) {
    static const struct {
        double size;
        const char* name;
    } units[] = {{1e3, "km"}, {1, "m"}, {1e-2, "cm"}, {1e-3, "mm"}, {1e-6, "µm"}, {1e-9, "nm"}};
    int k = 0;
    while (k < 5 && metres < units[k].size * (1 - 1e-9)) {
        k++;
    }
    (void)snprintf(text, 32, "%.4g %s", metres / units[k].size, units[k].name);
}

static void place_bar(const ruga_render_def* def, const ruga_camera* camera, ruga_legend* legend) {
    double scale = ruga_camera_scale(camera), longest = 0.2 * def->width / scale;
    double power = pow(10, floor(log10(longest))), times = longest / power;
    legend->bar_metres = power * (times >= 5 ? 5 : times >= 2 ? 2 : 1);
    legend->bar_left = 1.6 * legend->font;
    legend->bar_right = legend->bar_left + legend->bar_metres * scale;
    legend->bar_y = def->height - 1.3 * legend->font;
    write_length(legend->bar_metres, legend->bar_text);
}

void ruga_legend_place(const ruga_render_def* def, const ruga_camera* camera, ruga_legend* legend) {
    *legend =
        (ruga_legend){.font = font_of(def->height), .foot = ruga_legend_foot(def), .scale = scale_of(def)};
    if (def->scale_bar) {
        place_bar(def, camera, legend);
    }
    if (legend->scale) {
        double unit = legend->scale->unit > 0 ? legend->scale->unit : 1;
        legend->left = 0.34 * def->width;
        legend->right = def->width - 0.1 * def->width;
        legend->top = def->height - 2.9 * legend->font;
        legend->bottom = legend->top + 0.8 * legend->font;
        legend->axis = (ruga_axis){.min = legend->scale->min / unit,
                                   .max = legend->scale->max / unit,
                                   .from = legend->left,
                                   .to = legend->right};
        if (!(legend->axis.max > legend->axis.min)) {
            ruga_axis_widen(&legend->axis, 0.05);
        }
    }
}

// ---- drawing -------------------------------------------------------------------------------------------

static void draw_bar(ruga_canvas* canvas, const ruga_legend* legend) {
    double tick = 0.3 * legend->font, y = legend->bar_y, thick = fmax(1.5, 0.12 * legend->font);
    ruga_canvas_color(canvas, INK, 1);
    // The ends are inside of the length.
    cairo_rectangle(canvas->cairo, legend->bar_left, y - 0.5 * thick, legend->bar_right - legend->bar_left,
                    thick);
    cairo_rectangle(canvas->cairo, legend->bar_left, y - tick, thick, 2 * tick);
    cairo_rectangle(canvas->cairo, legend->bar_right - thick, y - tick, thick, 2 * tick);
    cairo_fill(canvas->cairo);
    ruga_canvas_text(canvas, 0.5 * (legend->bar_left + legend->bar_right), y - 0.5 * legend->font, 0.5, 0, 0,
                     legend->bar_text);
}

static void draw_colors(ruga_canvas* canvas, const ruga_legend* legend) {
    ruga_tick ticks[RUGA_AXIS_TICKS];
    const ruga_scale* scale = legend->scale;
    double unit = scale->unit > 0 ? scale->unit : 1, range = scale->max - scale->min;
    cairo_set_antialias(canvas->cairo, CAIRO_ANTIALIAS_NONE);
    for (int x = (int)legend->left; x < legend->right; x++) {
        double rgb[3], part = (x + 0.5 - legend->left) / (legend->right - legend->left);
        double value = unit * ruga_axis_value(&legend->axis, part);
        ruga_colormap(scale->map, range > 0 ? (value - scale->min) / range : 0.5, rgb);
        ruga_canvas_color(
            canvas, (unsigned)ruga_srgb(rgb[0]) << 16 | (unsigned)ruga_srgb(rgb[1]) << 8 | ruga_srgb(rgb[2]),
            1);
        cairo_rectangle(canvas->cairo, x, legend->top, 1, legend->bottom - legend->top);
        cairo_fill(canvas->cairo);
    }
    cairo_set_antialias(canvas->cairo, CAIRO_ANTIALIAS_DEFAULT);
    ruga_canvas_color(canvas, INK, 1);
    cairo_set_line_width(canvas->cairo, fmax(1, 0.07 * legend->font));
    int count = ruga_axis_ticks(&legend->axis, 6, ticks);
    for (int i = 0; i < count; i++) {
        double x = ruga_axis_place(&legend->axis, ticks[i].value);
        if (ticks[i].label[0]) {
            ruga_canvas_line(canvas, x, legend->bottom, x, legend->bottom + 0.3 * legend->font);
            ruga_canvas_text(canvas, x, legend->bottom + 0.5 * legend->font, 0.5, 1, 0, ticks[i].label);
        }
    }
    ruga_canvas_text(canvas, 0.5 * (legend->left + legend->right), legend->top - 0.45 * legend->font, 0.5, 0,
                     0, scale->name);
}

static void draw_all(ruga_canvas* canvas, const ruga_render_def* def, const ruga_legend* legend) {
    cairo_set_font_size(canvas->cairo, legend->font);
    if (legend->bar_right > legend->bar_left) {
        draw_bar(canvas, legend);
    }
    if (legend->scale) {
        draw_colors(canvas, legend);
    } else if (def->note) {
        ruga_canvas_color(canvas, INK, 1);
        ruga_canvas_text(canvas, def->width - 1.6 * legend->font, legend->bar_y, 1, 0, 0, def->note);
    }
}

ruga_status ruga_legend_draw(const ruga_render_def* def, ruga_picture* picture) {
    ruga_legend legend;
    ruga_canvas canvas;
    ruga_legend_place(def, &picture->camera, &legend);
    RUGA_TRY(ruga_canvas_open_pixels(picture->width, picture->height, picture->pixel, &canvas));
    draw_all(&canvas, def, &legend);
    return ruga_canvas_close_pixels(&canvas, picture->pixel);
}
