// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Prescribed motion of the interior: keyframes to lattice node positions.
#ifndef RUGA_LATTICE_MOTION_H
#define RUGA_LATTICE_MOTION_H

#include "lattice/lattice.h"

// Node positions q [N][3] at `time`. Affine parts are exact; the bump goes through the local
// quasi-interpolant
// (-1/8, 10/8, -1/8 per axis for degree 2) that reproduces quadratic fields.
void ruga_motion_at(const ruga_lattice* lattice, const double center[3], int keyframe_count,
                    const ruga_keyframe_def* keyframes, double time, double* q);

// Largest compressive strain along any axis over all keyframes (1 - smallest singular value of the matrix).
double ruga_motion_largest_compression(int keyframe_count, const ruga_keyframe_def* keyframes);

#endif
