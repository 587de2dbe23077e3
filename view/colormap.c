// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Colours in OKLab, where equal distances look equally different (B. Ottosson, A perceptual color space for
// image processing, 2020): lms = M2^-1 (L, a, b), each cubed, then rgb = M1^-1 lms. A straight line and a
// helix of constant chroma there are run through at constant speed, so that equal steps of the value look
// equally large:
//     sequential: L = 0.24 + 0.68 t, hue = 285 + 165 t degrees, chroma 0.12;
//     diverging:  from blue (L 0.44, hue 262, chroma 0.17) and red (L 0.44, hue 27, chroma 0.17) to L 0.96,
//     neutral.
#include "view/colormap.h"

#include "core/vec3.h"

#include <math.h>

static const double DEGREE = RUGA_PI / 180;

static void from_oklab(const double lab[3], double rgb[3]) {
    static const double lms_of_lab[9] = {1, 0.3963377774,  0.2158037573, 1, -0.1055613458, -0.0638541728,
                                         1, -0.0894841775, -1.2914855480};
    static const double rgb_of_lms[9] = {4.0767416621,  -3.3077115913, 0.2309699292,
                                         -1.2684380046, 2.6097574011,  -0.3413193965,
                                         -0.0041960863, -0.7034186147, 1.7076147010};
    double lms[3];
    ruga_multiply3(lms_of_lab, lab, lms);
    for (int i = 0; i < 3; i++) {
        lms[i] *= lms[i] * lms[i];
    }
    ruga_multiply3(rgb_of_lms, lms, rgb);
    for (int i = 0; i < 3; i++) {
        rgb[i] = fmin(fmax(rgb[i], 0), 1);
    }
}

void ruga_colormap_oklab(const double rgb[3], double lab[3]) {
    static const double lms_of_rgb[9] = {0.4122214708, 0.5363325363, 0.0514459929, 0.2119034982, 0.6806995451,
                                         0.1073969566, 0.0883024619, 0.2817188376, 0.6299787005};
    static const double lab_of_lms[9] = {0.2104542553, 0.7936177850,  -0.0040720468,
                                         1.9779984951, -2.4285922050, 0.4505937099,
                                         0.0259040371, 0.7827717662,  -0.8086757660};
    double lms[3];
    ruga_multiply3(lms_of_rgb, rgb, lms);
    for (int i = 0; i < 3; i++) {
        lms[i] = cbrt(lms[i]);
    }
    ruga_multiply3(lab_of_lms, lms, lab);
}

static void from_lch(double lightness, double chroma, double hue, double rgb[3]) {
    from_oklab((const double[3]){lightness, chroma * cos(hue), chroma * sin(hue)}, rgb);
}

void ruga_colormap(ruga_colormap_kind kind, double t, double rgb[3]) {
    t = fmin(fmax(t, 0), 1);
    if (kind == RUGA_COLORMAP_SEQUENTIAL) {
        from_lch(0.24 + 0.68 * t, 0.12, (285 + 165 * t) * DEGREE, rgb);
    } else {
        double away = fabs(2 * t - 1);
        from_lch(0.96 - 0.52 * away, 0.17 * away, (t < 0.5 ? 262 : 27) * DEGREE, rgb);
    }
}

void ruga_colormap_place(int place, double rgb[3]) {
    from_lch(0.76, 0.105, (15 + 360.0 / RUGA_COLORMAP_PLACES * (place % RUGA_COLORMAP_PLACES)) * DEGREE, rgb);
}

unsigned char ruga_srgb(double linear) {
    double v = fmin(fmax(linear, 0), 1);
    double s = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
    return (unsigned char)(255 * s + 0.5);
}
