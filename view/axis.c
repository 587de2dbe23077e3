// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Linear ticks stand at multiples of 1, 2 or 5 times a power of ten; logarithmic ones at the powers of ten,
// with 2 and 5 (then all digits) between them where fewer than three of the coarser kind are in range.
#include "view/axis.h"

#include "core/vec3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

ruga_axis ruga_axis_empty(bool logarithmic) {
    return (ruga_axis){.logarithmic = logarithmic, .min = INFINITY, .max = -INFINITY};
}

bool ruga_axis_shows(const ruga_axis* axis, double value) {
    return isfinite(value) && (!axis->logarithmic || value > 0);
}

void ruga_axis_include(ruga_axis* axis, double value) {
    if (ruga_axis_shows(axis, value)) {
        axis->min = fmin(axis->min, value);
        axis->max = fmax(axis->max, value);
    }
}

void ruga_axis_widen(ruga_axis* axis, double part) {
    if (axis->logarithmic) {
        double factor = axis->max > axis->min * (1 + 1e-9) ? pow(axis->max / axis->min, part) : 1.5;
        axis->min /= factor;
        axis->max *= factor;
        return;
    }
    double size = axis->max - axis->min, about = fmax(fabs(axis->max), fabs(axis->min));
    double margin = size > 1e-9 * about ? part * size : about > 0 ? 0.1 * about : 1;
    axis->min -= margin;
    axis->max += margin;
}

double ruga_axis_place(const ruga_axis* axis, double value) {
    double part = axis->logarithmic ? log(value / axis->min) / log(axis->max / axis->min)
                                    : (value - axis->min) / (axis->max - axis->min);
    return axis->from + part * (axis->to - axis->from);
}

double ruga_axis_value(const ruga_axis* axis, double part) {
    return axis->logarithmic ? axis->min * pow(axis->max / axis->min, part)
                             : axis->min + part * (axis->max - axis->min);
}

// ---- ticks ---------------------------------------------------------------------------------------------

// 10 to a power, with raised digits: 10⁻⁶.
static void write_power(int power, char label[RUGA_AXIS_LABEL]) {
    static const char* const raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    char digits[16];
    (void)snprintf(digits, sizeof digits, "%d", power);
    (void)snprintf(label, RUGA_AXIS_LABEL, "10");
    for (const char* c = digits; *c; c++) {
        (void)strncat(label, *c == '-' ? "⁻" : raised[*c - '0'], RUGA_AXIS_LABEL - strlen(label) - 1);
    }
}

static void add_tick(ruga_tick* ticks, int* count, double value) {
    if (*count < RUGA_AXIS_TICKS) {
        ticks[(*count)++] = (ruga_tick){.value = value};
    }
}

static int linear_ticks(const ruga_axis* axis, int wanted, ruga_tick* ticks) {
    double rough = (axis->max - axis->min) / wanted, power = pow(10, floor(log10(rough)));
    double step = power * (rough / power < 1.5 ? 1 : rough / power < 3.5 ? 2 : rough / power < 7.5 ? 5 : 10);
    int decimals = (int)fmax(0, ceil(-log10(step) - 1e-9)), count = 0;
    double largest = fmax(fabs(axis->min), fabs(axis->max));
    long first = (long)ceil(axis->min / step - 1e-9), last = (long)floor(axis->max / step + 1e-9);
    for (long k = first; k <= last && count < RUGA_AXIS_TICKS; k++) {
        add_tick(ticks, &count, (double)k * step);
        char* label = ticks[count - 1].label;
        if (k == 0) {
            (void)snprintf(label, RUGA_AXIS_LABEL, "0");
        } else if (largest >= 1e5 || largest < 1e-3) {
            (void)snprintf(label, RUGA_AXIS_LABEL, "%.6g", (double)k * step);
        } else {
            (void)snprintf(label, RUGA_AXIS_LABEL, "%.*f", decimals, (double)k * step);
        }
    }
    return count;
}

// Whether a multiple of a power of ten is labelled at this fineness: 1; 1, 2, 5; all.
static bool is_labelled(int digit, int fineness) {
    return digit == 1 || fineness == 2 || (fineness == 1 && (digit == 2 || digit == 5));
}

static int log_ticks(const ruga_axis* axis, int wanted, ruga_tick* ticks) {
    int count = 0, labels = 0, fineness = -1;
    int low = (int)floor(log10(axis->min) + 1e-9), high = (int)ceil(log10(axis->max) - 1e-9);
    int stride = 1 + (high - low) / (2 * wanted);
    while (labels < 3 && fineness < 2) {
        fineness++;
        count = labels = 0;
        for (int power = low; power <= high; power++) {
            for (int digit = 1; digit < 10 && (digit == 1 || stride == 1); digit++) {
                double value = digit * pow(10, power);
                if (value < axis->min * (1 - 1e-9) || value > axis->max * (1 + 1e-9)) {
                    continue;
                }
                add_tick(ticks, &count, value);
                char* label = ticks[count - 1].label;
                if (is_labelled(digit, fineness) && (power - low) % stride == 0) {
                    labels++;
                    if (digit == 1 && (power < -3 || power > 4)) {
                        write_power(power, label);
                    } else {
                        (void)snprintf(label, RUGA_AXIS_LABEL, "%.6g", value);
                    }
                }
            }
        }
    }
    // Not even three digits of one power: the range is short enough to read as a linear one.
    return labels >= 3 ? count : linear_ticks(axis, wanted, ticks);
}

int ruga_axis_ticks(const ruga_axis* axis, int wanted, ruga_tick ticks[RUGA_AXIS_TICKS]) {
    return axis->logarithmic ? log_ticks(axis, wanted, ticks) : linear_ticks(axis, wanted, ticks);
}

// ---- drawing -------------------------------------------------------------------------------------------

static void draw_grid_line(ruga_canvas* canvas, const ruga_axis* x, const ruga_axis* y, bool is_x,
                           double at) {
    ruga_canvas_color(canvas, 0x000000, 0.09);
    if (is_x) {
        ruga_canvas_line(canvas, at, y->from, at, y->to);
    } else {
        ruga_canvas_line(canvas, x->from, at, x->to, at);
    }
}

// The widest label's width.
static double draw_ticks(ruga_canvas* canvas, const ruga_axis* x, const ruga_axis* y, bool is_x, bool grid) {
    ruga_tick ticks[RUGA_AXIS_TICKS];
    const ruga_axis* axis = is_x ? x : y;
    double widest = 0;
    int count = ruga_axis_ticks(axis, is_x ? 7 : 6, ticks);
    for (int i = 0; i < count; i++) {
        bool major = ticks[i].label[0] != '\0';
        double at = ruga_axis_place(axis, ticks[i].value), size = major ? 5 : 3;
        if (grid && major) {
            draw_grid_line(canvas, x, y, is_x, at);
        }
        ruga_canvas_color(canvas, 0x000000, 1);
        if (is_x) {
            ruga_canvas_line(canvas, at, y->from, at, y->from - size);
            ruga_canvas_text(canvas, at, y->from + 7, 0.5, 1, 0, ticks[i].label);
        } else {
            ruga_canvas_line(canvas, x->from, at, x->from + size, at);
            ruga_canvas_text(canvas, x->from - 7, at, 1, 0.5, 0, ticks[i].label);
            widest = fmax(widest, ruga_canvas_text_width(canvas, ticks[i].label));
        }
    }
    return widest;
}

void ruga_axis_draw_frame(ruga_canvas* canvas, const ruga_axis* x, const ruga_axis* y, bool grid,
                          const char* x_name, const char* y_name) {
    cairo_set_line_width(canvas->cairo, 1);
    (void)draw_ticks(canvas, x, y, true, grid);
    double widest = draw_ticks(canvas, x, y, false, grid);
    ruga_canvas_color(canvas, 0x000000, 1);
    cairo_rectangle(canvas->cairo, x->from, y->to, x->to - x->from, y->from - y->to);
    cairo_stroke(canvas->cairo);
    ruga_canvas_text(canvas, 0.5 * (x->from + x->to), y->from + 28, 0.5, 1, 0, x_name ? x_name : "");
    ruga_canvas_text(canvas, x->from - 16 - widest, 0.5 * (y->from + y->to), 0.5, 0, 0.5 * RUGA_PI,
                     y_name ? y_name : "");
}
