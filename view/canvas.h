// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A sheet to draw on with cairo, that becomes an SVG or a PNG file: the same drawing for both, and the same
// bytes each time.
#ifndef RUGA_VIEW_CANVAS_H
#define RUGA_VIEW_CANVAS_H

#include "core/status.h"

#include <cairo.h>

typedef struct ruga_canvas {
    cairo_t* cairo; // in units of 1/96 inch, y down; a PNG has two pixels per unit
    const char* path;
    bool vector;
    double width, height;
    unsigned char* data; // the file's bytes
    int size, capacity;
} ruga_canvas;

// White, with a sans font. RUGA_BAD_INPUT where the path ends in neither .svg nor .png.
ruga_status ruga_canvas_open(const char* path, double width, double height, ruga_canvas* canvas);
// With RUGA_OK puts the file in its place, whole or not at all; otherwise returns that status. Frees the
// canvas.
ruga_status ruga_canvas_close(ruga_canvas* canvas, ruga_status status);

// Draws over a picture of pixels [height][width][3], a unit a pixel; close puts the drawing into them.
ruga_status ruga_canvas_open_pixels(int width, int height, const unsigned char* pixel, ruga_canvas* canvas);
ruga_status ruga_canvas_close_pixels(ruga_canvas* canvas, unsigned char* pixel);

// 0xRRGGBB and opacity.
void ruga_canvas_color(ruga_canvas* canvas, unsigned color, double opacity);
// The point (x, y) is at `across` of the text's width and `up` of a capital's height, both in [0, 1]; turned
// counter-clockwise by `turn`, rad, about it.
void ruga_canvas_text(ruga_canvas* canvas, double x, double y, double across, double up, double turn,
                      const char* text);
double ruga_canvas_text_width(ruga_canvas* canvas, const char* text);
void ruga_canvas_line(ruga_canvas* canvas, double x0, double y0, double x1, double y1);

#endif
