// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Greyscale pictures as functions over texture coordinates.
#ifndef RUGA_IO_TEXTURE_H
#define RUGA_IO_TEXTURE_H

#include "core/status.h"

typedef struct ruga_texture {
    int width, height;
    double* value; // [height][width] from the top, 0 = black, 1 = white
} ruga_texture;

// A PNG in shades of grey, of up to 16 bits and any gamma: its numbers are taken as they stand.
// RUGA_BAD_INPUT where it is missing, damaged, or in colour.
ruga_status ruga_texture_read(const char* path, ruga_texture* texture);
void ruga_texture_clear(ruga_texture* texture);

// Bilinear between the middles of pixels; (0, 0) is the lower left corner, (1, 1) the upper right; held
// outside.
double ruga_texture_at(const ruga_texture* texture, const double uv[2]);

#endif
