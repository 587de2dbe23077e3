// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Plots of series, and maps of a value over a grid, as SVG or PNG: the file's ending decides. Zero a def and
// set what you have. Texts are UTF-8, arrays of the caller; names of axes carry their units.
#ifndef RUGA_VIEW_PLOT_H
#define RUGA_VIEW_PLOT_H

#include "core/status.h"

enum { RUGA_PLOT_COLORS = 7 }; // series beyond take them again

typedef struct ruga_plot_axis {
    const char* name;
    bool logarithmic; // values that are not positive are then left out
    double min, max;  // both 0: what the data need
} ruga_plot_axis;

typedef enum ruga_plot_style {
    RUGA_PLOT_BOTH, // a line through markers
    RUGA_PLOT_MARKERS,
    RUGA_PLOT_LINE,
    RUGA_PLOT_DASHED,
} ruga_plot_style;

typedef struct ruga_plot_series {
    const char* name; // in the legend; NULL = not there
    int count;
    const double *x, *y;      // [count]; a point that is not finite interrupts the line
    const double *low, *high; // [count] or NULL: the range of y at each point
    bool bars;                // the range as error bars, otherwise as a shaded band
    ruga_plot_style style;
    int color; // 0 = by its place among the series; otherwise that of place color - 1, so that series may
               // share one
} ruga_plot_series;

typedef struct ruga_plot_reference {
    double y;
    const char* name; // in the legend, or NULL
} ruga_plot_reference;

typedef struct ruga_plot_def {
    const char* title;    // or NULL
    double width, height; // in 1/96 inch; 0 = 720 x 450
    ruga_plot_axis x, y;
    int series_count;
    const ruga_plot_series* series;
    int reference_count; // horizontal lines
    const ruga_plot_reference* references;
} ruga_plot_def;

// RUGA_BAD_INPUT where a series has no point that the axes can show.
ruga_status ruga_plot_write(const ruga_plot_def* def, const char* path);
// Several on one page, side by side in rows of `columns`, each of its own size.
ruga_status ruga_plot_write_page(int count, const ruga_plot_def* defs, int columns, const char* path);

// Lines of equal value. Between the points of the grid the value runs linearly along the axes as they are
// drawn.
typedef struct ruga_map_contours {
    const char* name;    // in the legend, or NULL
    const double* value; // [rows][columns]; NAN = unknown
    bool logarithmic;    // the value's logarithm runs linearly, all must be positive
    bool dashed;
    int level_count;
    const double* level;
    const char* unit; // NULL: no labels; otherwise what stands behind the level's number
} ruga_map_contours;

typedef struct ruga_map_def {
    const char* title;
    double width, height;       // 0 = 720 x 540
    ruga_plot_axis x, y;        // min and max are not used: the map ends with its cells
    int columns, rows;          // at least 2 each
    const double *column, *row; // centres of the cells, ascending
    const double* value;        // [rows][columns] the colour; NAN = none
    const char* value_name;
    double min, max;         // of the colours; both 0 = the data's
    const bool* marked;      // [rows][columns] hatched cells, or NULL
    const char* marked_name; // what the hatching means
    int contours_count;
    const ruga_map_contours* contours;
} ruga_map_def;

// RUGA_BAD_INPUT where no value is finite, or the centres do not ascend.
ruga_status ruga_map_write(const ruga_map_def* def, const char* path);

#endif
