// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Where the camera stands, so that what is drawn fills the picture.
#ifndef RUGA_VIEW_CAMERA_H
#define RUGA_VIEW_CAMERA_H

#include <stdbool.h>

enum { RUGA_EXTENT_POINTS = 128 };

// What a camera has to see of any number of frames: the points that reach farthest in many directions, which
// is true to about a hundredth of the size.
typedef struct ruga_extent {
    bool any;
    double point[RUGA_EXTENT_POINTS][3];
} ruga_extent;

// Widens it by positions [count][3].
void ruga_extent_add(ruga_extent* extent, int count, const double* position);

typedef struct ruga_view {
    double azimuth, elevation; // rad: direction from the scene to the camera, elevation in [-pi/2, pi/2]
    double up[3];              // the axis that azimuth turns about; need not be of unit length
    double fit;                // what is seen fills this part of the picture
    double foot;               // this part of the picture's height stays free at the bottom
    bool turns;                // leaves room for every azimuth
} ruga_view;

// The point e + z (forward + u right + v up) is seen at u, v in [-1, 1], v upwards.
typedef struct ruga_camera {
    int width, height; // pixels
    double eye[3], forward[3], right[3], up[3];
    double axis[3];  // upwards, of unit length
    double distance; // from the eye to the middle of what is seen, along forward
    double ground;   // height of its lowest point along the axis
    double size;     // of what is seen: the diagonal of its box
} ruga_camera;

// Frames points [count][3], count > 0.
void ruga_camera_frame(int count, const double* point, const ruga_view* view, int width, int height,
                       ruga_camera* camera);
// Where a point in front of the eye is seen, in pixels from the upper left corner.
void ruga_camera_project(const ruga_camera* camera, const double x[3], double pixel[2]);
// Pixels for a metre across the view, at the middle of what is seen.
double ruga_camera_scale(const ruga_camera* camera);

#endif
