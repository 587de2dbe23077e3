// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Cool to warm after Moreland (2009), by its control colours in sRGB, blended in linear light.
#include "view/colormap.h"

#include <math.h>

static double decode(double s) {
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

void ruga_colormap(double t, double rgb[3]) {
    static const double stops[5][3] = {
        {0.230, 0.299, 0.754}, {0.552, 0.690, 0.996}, {0.866, 0.866, 0.866}, {0.957, 0.604, 0.482}, {0.706, 0.016, 0.150}};
    double s = 4 * fmin(fmax(t, 0), 1);
    int k = s >= 4 ? 3 : (int)s;
    for (int i = 0; i < 3; i++) {
        rgb[i] = (1 - (s - k)) * decode(stops[k][i]) + (s - k) * decode(stops[k + 1][i]);
    }
}

unsigned char ruga_srgb(double linear) {
    double v = fmin(fmax(linear, 0), 1);
    double s = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
    return (unsigned char)(255 * s + 0.5);
}
