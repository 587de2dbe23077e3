// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A cut sheet folded as rigid panels: a start for what moves.
#ifndef RUGA_CREASE_POSE_H
#define RUGA_CREASE_POSE_H

#include "crease/cut.h"

// Turns the panels between creases, which the sheet's first one leaves where it is, until each crease has
// changed its angle by turn [segments], rad; then, where cone (rad) is not 0, rolls them as ruga_roll_cone
// does: panels around a ring may meet by that alone. x [nodes][3] is SET. RUGA_BAD_INPUT where panels would
// have to bend or to part by more than `tolerance`, m.
ruga_status ruga_cut_fold(const ruga_raster* raster, const ruga_cut* cut, const double* turn, double cone,
                          double tolerance, double* x);
// Rolls a plane z = 0 about the origin into a cone with its tip there and its axis along -z: what was a
// sector of `angle` (rad) about the mean direction becomes a whole turn. Heights over the plane stay heights
// over the cone.
void ruga_roll_cone(int count, double angle, double* x);

#endif
