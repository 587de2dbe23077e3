// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A cut sheet as cloth of springs.
#ifndef RUGA_CREASE_CLOTH_H
#define RUGA_CREASE_CLOTH_H

#include "crease/hinge.h"
#include "ruga/types.h"
#include "shell/springs.h"

// A spring that bends: its rest length at the rest angle theta0 is sqrt(constant + factor cos(theta0)).
typedef struct ruga_fold_length {
    int segment; // of the cut whose rest angle counts; -1 = it stays as it is
    double constant, factor;
} ruga_fold_length;

typedef struct ruga_cloth {
    ruga_springs springs;
    int fold_count, fold_capacity;
    ruga_fold_length* fold; // that the label of a spring counts from
} ruga_cloth;

// One hinge for each of the cut's bends, of length 1: what joins it to a ruga_hinge of a segment.
void ruga_bends_make(const ruga_raster* raster, const ruga_cut* cut, ruga_hinge* hinge);
// Stiffness over the bending rigidity D of the material's bends [bends] and auxiliary chords [segments], for
// 1/2 k (theta - theta0)^2: that of shell/bending.c by the part of the length that is there. 0 for creases.
void ruga_bend_stiffness(const ruga_raster* raster, const ruga_cut* cut, double* bend, double* chord);

// Linear springs along the sides of all pieces, bending and axial-bending springs across what joins them.
ruga_status ruga_cloth_add_sheet(ruga_cloth* cloth, const ruga_raster* raster, const ruga_cut* cut,
                                 const ruga_skin_def* skin);
// Springs of the creases, stiffness [segments] N; style not RUGA_CREASE_ANGLE.
ruga_status ruga_cloth_add_creases(ruga_cloth* cloth, const ruga_raster* raster, const ruga_cut* cut,
                                   ruga_crease_style style, const double* stiffness);
// After the last was added.
ruga_status ruga_cloth_finish(ruga_cloth* cloth, const ruga_cut* cut);
void ruga_cloth_clear(ruga_cloth* cloth);
// Rest lengths for the rest angles rest [segments], rad.
void ruga_cloth_set_rest(ruga_cloth* cloth, const double* rest);

#endif
