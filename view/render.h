// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A picture of a surface: ray traced, with key light, sky and ambient occlusion on a studio's floor; coloured
// by values or places, with lines along edges. Take ruga_default_render_def() and set what you want.
#ifndef RUGA_VIEW_RENDER_H
#define RUGA_VIEW_RENDER_H

#include "mesh/mesh.h"
#include "view/camera.h"
#include "view/colormap.h"

// A value at each of some things, by the colours of a map.
typedef struct ruga_scale {
    const double* value; // NULL = none
    double min, max;
    ruga_colormap_kind map;
    const char* name; // in the legend, with the unit: "displacement, mm"; NULL = no legend
    double unit;      // what one of the unit is in those of the value: 1e-3 for millimetres; 0 = 1
} ruga_scale;

typedef struct ruga_render_def {
    int width, height;         // pixels, 16 to 16384
    int samples;               // per pixel and axis, >= 1; outlines get twice as many
    double azimuth, elevation; // rad: direction from the scene to the camera
    double up[3];
    double fit;                // the object fills this part of the picture
    bool turns;                // leave room for every azimuth
    const ruga_extent* extent; // what the camera sees whole; NULL = what is drawn
    bool wireframe;
    bool scale_bar;
    ruga_scale scalar; // [V]
    const int* place;  // [V] neighbours of another number get another colour; NULL = none
    const char* note;  // a line of text in the legend's place, or NULL
    // [F][3] number of the crease along the edge from corner k to k + 1, or -1; NULL = none. The surface is
    // not smoothed across creases.
    const int* line;
    bool draw_lines;
    ruga_scale lines; // [number of creases] their colours; without values they are dark
} ruga_render_def;

ruga_render_def ruga_default_render_def(void);

// A picture to be released by ruga_picture_clear.
typedef struct ruga_picture {
    int width, height;
    unsigned char* pixel;    // [height][width][3] sRGB
    unsigned char* coverage; // [height][width] the part of the pixel that shows the object, 0..255
    ruga_camera camera;
} ruga_picture;

// Draws positions [V][3]. RUGA_BAD_INPUT where they are not finite or the size is out of range.
ruga_status ruga_render(const ruga_mesh* mesh, const double* position, const ruga_render_def* def,
                        ruga_picture* picture);
void ruga_picture_clear(ruga_picture* picture);
// An 8-bit PNG file, there whole or not at all.
ruga_status ruga_picture_write(const ruga_picture* picture, const char* path);
// Both.
ruga_status ruga_render_png(const ruga_mesh* mesh, const double* position, const ruga_render_def* def,
                            const char* path);

#endif
