// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The part of the sky that is seen is the integral of V(d) n.d / pi over the half-sphere, V = 1 where the ray
// is free. With directions as dense as the cosine it is the mean of V: points (r, phi) = (sqrt(a), 2 pi b) of
// the unit disc, raised to the half-sphere, where (a, b) is the additive recurrence of the plastic number,
// the root of x^3 = x + 1 (M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
#include "view/light.h"

#include "core/vec3.h"

#include <math.h>

void ruga_light_direction(const double n[3], int place, const double shift[2], double direction[3]) {
    const double plastic = 1.32471795724474602596;
    double a = shift[0] + (place + 1) / plastic, b = shift[1] + (place + 1) / (plastic * plastic);
    double s[3], t[3], helper[3] = {0, 0, 0};
    a -= floor(a);
    b -= floor(b);
    helper[fabs(n[0]) < 0.6 ? 0 : 1] = 1;
    ruga_cross(n, helper, s);
    (void)ruga_normalize(s);
    ruga_cross(n, s, t);
    double radius = sqrt(a), across = radius * cos(2 * RUGA_PI * b), along = radius * sin(2 * RUGA_PI * b);
    for (int k = 0; k < 3; k++) {
        direction[k] = across * s[k] + along * t[k] + sqrt(1 - a) * n[k];
    }
}

double ruga_light_sky(const ruga_ray_scene* scene, const double x[3], const double n[3], double near,
                      int rays, const double shift[2]) {
    int seen = 0;
    for (int i = 0; i < rays; i++) {
        ruga_ray ray = {.origin = {x[0], x[1], x[2]}, .near = near, .far = INFINITY};
        ruga_light_direction(n, i, shift, ray.direction);
        seen += !ruga_ray_blocked(scene, &ray);
    }
    return (double)seen / rays;
}
