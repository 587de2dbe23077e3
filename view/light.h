// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Light that falls on a point: of the sky, as far as the mesh does not hide it.
#ifndef RUGA_VIEW_LIGHT_H
#define RUGA_VIEW_LIGHT_H

#include "view/ray.h"

// Numbers first, first + 1, .. of a sequence that fills the half-sphere about the unit normal n evenly, as
// densely as the cosine: direction [count][3]. shift [2] in [0, 1) makes sequences that do not agree with one
// another.
void ruga_light_directions(const double n[3], int first, int count, const double shift[2],
                           double (*direction)[3]);

// The part of the sky's light, as an evenly bright half-sphere about the unit normal n would send it to x,
// that the mesh lets through: 1 in the open (ambient occlusion is one less it). Rays start `near` metres from
// x.
double ruga_light_sky(const ruga_ray_scene* scene, const double x[3], const double n[3], double near,
                      int rays, const double shift[2]);

#endif
