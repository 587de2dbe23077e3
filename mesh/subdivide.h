// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Loop subdivision (Loop 1987), as the 2013 paper uses to smooth its pictures; open boundaries by the cubic
// B-spline rule. UVs and groups follow.
#ifndef RUGA_MESH_SUBDIVIDE_H
#define RUGA_MESH_SUBDIVIDE_H

#include "mesh/mesh.h"

// Topology and rules of `steps` steps, once; then positions many times.
typedef struct ruga_subdivision ruga_subdivision;
ruga_status ruga_subdivision_create(const ruga_mesh* mesh, int steps, ruga_subdivision** subdivision);
void ruga_subdivision_destroy(ruga_subdivision** subdivision);
// The refined mesh (its positions are those of the mesh given at create).
const ruga_mesh* ruga_subdivision_mesh(const ruga_subdivision* subdivision);
// fine [fine V][3] from coarse [V][3].
void ruga_subdivision_apply(const ruga_subdivision* subdivision, const double* coarse, double* fine);

#endif
