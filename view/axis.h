// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// An axis of a plot: from values to places, and round numbers for its ticks.
#ifndef RUGA_VIEW_AXIS_H
#define RUGA_VIEW_AXIS_H

#include "view/canvas.h"

enum { RUGA_AXIS_TICKS = 64, RUGA_AXIS_LABEL = 32 };

typedef struct ruga_axis {
    bool logarithmic;
    double min, max; // values at `from` and `to`
    double from, to; // places on the canvas
} ruga_axis;

typedef struct ruga_tick {
    double value;
    char label[RUGA_AXIS_LABEL]; // "" = a minor tick
} ruga_tick;

// An axis without values yet: min > max.
ruga_axis ruga_axis_empty(bool logarithmic);
// Whether the axis can show the value: finite, and positive where it is logarithmic.
bool ruga_axis_shows(const ruga_axis* axis, double value);
// Widens the axis to hold the value, where it can be shown.
void ruga_axis_include(ruga_axis* axis, double value);
// A margin of this part of the length at both ends; makes room about a single value.
void ruga_axis_widen(ruga_axis* axis, double part);
double ruga_axis_place(const ruga_axis* axis, double value);
// The value at `part` of the way from min to max.
double ruga_axis_value(const ruga_axis* axis, double part);
// About `wanted` labelled ticks, ascending, and minor ones; their number.
int ruga_axis_ticks(const ruga_axis* axis, int wanted, ruga_tick ticks[RUGA_AXIS_TICKS]);

// The frame of a plot with ticks inwards, labels outside and the names of the axes.
void ruga_axis_draw_frame(ruga_canvas* canvas, const ruga_axis* x, const ruga_axis* y, bool grid,
                          const char* x_name, const char* y_name);

#endif
