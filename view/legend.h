// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a picture says besides: the colours' scale with its numbers, and a bar of known length.
#ifndef RUGA_VIEW_LEGEND_H
#define RUGA_VIEW_LEGEND_H

#include "view/axis.h"
#include "view/render.h"

// Where things stand, in pixels from the upper left corner.
typedef struct ruga_legend {
    double font;                       // height of the letters
    double foot;                       // the part of the picture's height that is taken, at the bottom
    const ruga_scale* scale;           // NULL = none
    double left, right, top, bottom;   // of the colours
    ruga_axis axis;                    // from values, in the legend's unit, to places along x
    double bar_left, bar_right, bar_y; // of the scale bar; no width = none
    double bar_metres;
    char bar_text[32];
} ruga_legend;

// The part of the height that the legend needs; 0 where there is nothing to say.
double ruga_legend_foot(const ruga_render_def* def);
void ruga_legend_place(const ruga_render_def* def, const ruga_camera* camera, ruga_legend* legend);
// Draws it into the picture.
ruga_status ruga_legend_draw(const ruga_render_def* def, ruga_picture* picture);

#endif
