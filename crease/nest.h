// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A cut within a coarser one: what was one when further curves were cut. Where both are of stages of one raster
// (raster.h), each piece of the finer one lies within a piece of the coarser one.
#ifndef RUGA_CREASE_NEST_H
#define RUGA_CREASE_NEST_H

#include "crease/cut.h"

typedef struct ruga_nest {
    int* node;    // [nodes of the finer] node of the coarser: at the cut it is where that one is
    int* segment; // [segments of the finer] segment of the coarser between the same two pieces, -1 = none
} ruga_nest;

// Both on one mesh. RUGA_BAD_INPUT where one is not within the other.
ruga_status ruga_nest_create(const ruga_cut* fine, const ruga_cut* coarse, ruga_nest* nest);
void ruga_nest_clear(ruga_nest* nest);

#endif
