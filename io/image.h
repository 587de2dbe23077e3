// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Pictures of numbers: 16-bit PNG and OpenEXR. One file per format, same shape: io/png.c, io/exr.c.
#ifndef RUGA_IO_IMAGE_H
#define RUGA_IO_IMAGE_H

#include "core/status.h"

typedef struct ruga_image {
    int width, height;
    const float* pixel; // [height][width][3] red, green, blue, from the top row down
    const char* comment;
    // A number x of the file, in a PNG 0 to 1, stands for offset + scale x, in `unit`.
    double scale, offset;
    const char* unit;
    bool half; // OpenEXR: 16-bit numbers in place of 32
} ruga_image;

// Whether a file of this name can be written: .png or .exr.
ruga_status ruga_image_check(const char* path);
bool ruga_image_is_exr(const char* path);

// By the ending; whole or not at all. PNG: 0 to 1 become 0 to 65535, what is beyond is cut off. Scale, offset
// and unit stand in the file as valueScale, valueOffset and valueUnit.
ruga_status ruga_image_write(const char* path, const ruga_image* image);

ruga_status ruga_png_write(const char* path, const ruga_image* image);
ruga_status ruga_exr_write(const char* path, const ruga_image* image);

#endif
