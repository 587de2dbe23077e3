// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#ifndef RUGA_VIEW_COLORMAP_H
#define RUGA_VIEW_COLORMAP_H

typedef enum ruga_colormap_kind {
    RUGA_COLORMAP_DIVERGING,  // blue - near white - red, for values about a middle
    RUGA_COLORMAP_SEQUENTIAL, // dark violet - red - light yellow, for values from least to most
} ruga_colormap_kind;

// The colour of t in [0, 1] (held outside), linear sRGB in [0, 1].
void ruga_colormap(ruga_colormap_kind kind, double t, double rgb[3]);
// Colours that tell neighbours apart, all equally light.
enum { RUGA_COLORMAP_PLACES = 8 };
void ruga_colormap_place(int place, double rgb[3]);

// OKLab of a linear sRGB colour: lightness in [0, 1], green to red, blue to yellow.
void ruga_colormap_oklab(const double rgb[3], double lab[3]);
// sRGB encoding of a linear value in [0, 1] to 0..255.
unsigned char ruga_srgb(double linear);

#endif
