// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#ifndef RUGA_VIEW_COLORMAP_H
#define RUGA_VIEW_COLORMAP_H

// A diverging map for t in [0, 1], blue - light grey - red, of nearly even lightness steps; linear RGB.
void ruga_colormap(double t, double rgb[3]);
// sRGB encoding of a linear value in [0, 1] to 0..255.
unsigned char ruga_srgb(double linear);

#endif
