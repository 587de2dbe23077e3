// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Keeps a cut sewn in time steps: projections of velocities and positions with S = W^T M^-1 W factorised
// once.
#ifndef RUGA_SOLVER_STITCH_H
#define RUGA_SOLVER_STITCH_H

#include "crease/sewing.h"

typedef struct ruga_stitch ruga_stitch;

// inverse_mass [nodes], 1/kg, 0 = held; it is copied, the sewing must outlive the stitch. RUGA_BAD_INPUT
// where S is not positive definite: then the sewing was made for other held nodes.
ruga_status ruga_stitch_create(const ruga_sewing* sewing, const double* inverse_mass, ruga_stitch** stitch);
void ruga_stitch_destroy(ruga_stitch** stitch);

// Pre-stabilisation: the least impulses after which x + step v has no gaps; they stay in v. v [nodes][3],
// m/s.
ruga_status ruga_stitch_before(ruga_stitch* stitch, const double* x, double step, double* v);
// Post-stabilisation: the least impulses after which v opens no gaps.
ruga_status ruga_stitch_after(ruga_stitch* stitch, double* v);
// Moves x as little as possible, in the sum of m |dx|^2, so that it has no gaps: for a start, not for
// equilibria.
ruga_status ruga_stitch_close(ruga_stitch* stitch, double* x);

#endif
