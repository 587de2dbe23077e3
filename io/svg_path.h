// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// SVG path data as polylines.
#ifndef RUGA_IO_SVG_PATH_H
#define RUGA_IO_SVG_PATH_H

#include "io/xml.h"

// x' = m[0] x + m[2] y + m[4], y' = m[1] x + m[3] y + m[5]
typedef struct ruga_svg_transform {
    double m[6];
} ruga_svg_transform;

// Receives a straight piece in the drawing's frame.
typedef ruga_status ruga_svg_line_function(const double from[2], const double to[2], void* context);

typedef struct ruga_svg_pen {
    ruga_svg_transform transform;
    double tolerance; // in the drawing's frame; 0 = curves by their control polygons
    ruga_svg_line_function* line;
    void* context;
} ruga_svg_pen;

// a then b: x -> b(a(x))
ruga_svg_transform ruga_svg_compose(const ruga_svg_transform* a, const ruga_svg_transform* b);
// matrix, translate, scale, rotate, skewX, skewY; false where the text is something else.
bool ruga_svg_parse_transform(ruga_slice text, ruga_svg_transform* transform);
// The next number, behind blanks and commas; false where there is none.
bool ruga_svg_number(const char** at, const char* end, double* value);

// Commands M L H V C S Q T A Z, absolute and relative. *bad is where the data cannot be read, NULL = all was.
// As SVG has it, what stands before is drawn.
ruga_status ruga_svg_draw_path(const ruga_svg_pen* pen, ruga_slice data, const char** bad);
// Straight pieces through points [count][2], and back to the first where closed.
ruga_status ruga_svg_draw_points(const ruga_svg_pen* pen, int count, const double (*point)[2], bool closed);
// Its corners are quarters of ellipses with these radii, at most half of a side.
ruga_status ruga_svg_draw_rectangle(const ruga_svg_pen* pen, const double corner[2], const double size[2],
                                    const double radius[2]);
ruga_status ruga_svg_draw_ellipse(const ruga_svg_pen* pen, const double center[2], const double radius[2]);

#endif
