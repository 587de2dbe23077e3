// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A few maps that many frames are blended from, with weights that are not negative.
#ifndef RUGA_VIEW_BLEND_H
#define RUGA_VIEW_BLEND_H

#include "core/status.h"

typedef struct ruga_blend {
    int frames, maps;
    double* mixture; // [frames][maps]: map k = sum over frames f of mixture[f][k] frame f
    double*
        weight;    // [frames][maps] >= 0, the largest of each map 1: frame f = about sum_k weight[f][k] map k
    double* error; // [frames] distance of a frame to its blend over the largest frame's norm
} ruga_blend;

// From the inner products of the frames, product [frames][frames]. 1 <= maps <= frames.
ruga_status ruga_blend_create(int frames, const double* product, int maps, ruga_blend* blend);
void ruga_blend_clear(ruga_blend* blend);

#endif
