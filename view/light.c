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
#include <string.h>

// Two unit vectors across the unit vector n and each other.
static void frame(const double n[3], double s[3], double t[3]) {
    double helper[3] = {0, 0, 0};
    helper[fabs(n[0]) < 0.6 ? 0 : 1] = 1;
    ruga_cross(n, helper, s);
    (void)ruga_normalize(s);
    ruga_cross(n, s, t);
}

// phi grows by the same angle from each direction to the next, so that its sine and cosine are turned on.
void ruga_light_directions(const double n[3], int first, int count, const double shift[2],
                           double (*direction)[3]) {
    const double plastic = 1.32471795724474602596, step[2] = {1 / plastic, 1 / (plastic * plastic)};
    const double turn[2] = {cos(2 * RUGA_PI * step[1]), sin(2 * RUGA_PI * step[1])};
    double s[3], t[3], a = shift[0] + (first + 1) * step[0], b = shift[1] + (first + 1) * step[1];
    double along[2] = {cos(2 * RUGA_PI * b), sin(2 * RUGA_PI * b)};
    frame(n, s, t);
    a -= floor(a);
    for (int i = 0; i < count; i++) {
        double radius = sqrt(a), height = sqrt(1 - a);
        for (int k = 0; k < 3; k++) {
            direction[i][k] = radius * (along[0] * s[k] + along[1] * t[k]) + height * n[k];
        }
        double next = turn[0] * along[0] - turn[1] * along[1];
        along[1] = turn[1] * along[0] + turn[0] * along[1];
        along[0] = next;
        a += step[0];
        a -= a >= 1 ? 1 : 0;
    }
}

double ruga_light_sky(const ruga_ray_scene* scene, const double x[3], const double n[3], double near,
                      int rays, const double shift[2]) {
    enum { AT_ONCE = 64 };
    double direction[AT_ONCE][3];
    int seen = 0;
    for (int i = 0; i < rays; i++) {
        if (i % AT_ONCE == 0) {
            ruga_light_directions(n, i, rays - i < AT_ONCE ? rays - i : AT_ONCE, shift, direction);
        }
        ruga_ray ray = {.origin = {x[0], x[1], x[2]}, .near = near, .far = INFINITY};
        memcpy(ray.direction, direction[i % AT_ONCE], sizeof ray.direction);
        seen += !ruga_ray_blocked(scene, &ray);
    }
    return (double)seen / rays;
}
