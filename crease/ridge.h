// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Crease curves from a simulation: the ridges of bending energy or of compressive stress of a deformed
// surface, after "derived from internal stresses" of Patkar, Jin and Fedkiw (2015), section 8.
#ifndef RUGA_CREASE_RIDGE_H
#define RUGA_CREASE_RIDGE_H

#include "crease/curve.h"

typedef struct ruga_ridge_def {
    bool stress;       // the compressive principal membrane stress; otherwise the bending energy
    double poisson;    // of the stress
    double smooth;     // m, width over which fields and lines are smoothed; 0 = three mean edges
    double strength;   // of a ridge at its strongest place, as a part of what 99 % of the vertices are below
    double min_length; // m; shorter ones are left out; 0 = ten mean edges
} ruga_ridge_def;

ruga_ridge_def ruga_default_ridge_def(void);

// Appends the ridges as polylines on the surface at rest, the longest first. A curve's label is
// RUGA_ASSIGNMENT_VALLEY or _MOUNTAIN by the way the surface bends there, _UNASSIGNED for stress. position
// [V][3].
ruga_status ruga_ridges_find(const ruga_mesh* mesh, const double* position, const ruga_ridge_def* def,
                             ruga_curves* curves);

#endif
