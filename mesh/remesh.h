// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Isotropic, near-equilateral remeshing (CGAL), features kept, UVs and groups transferred.
#ifndef RUGA_MESH_REMESH_H
#define RUGA_MESH_REMESH_H

#include "mesh/mesh.h"

// `edge` in m > 0. Boundaries, sharp edges (dihedral above 50 degrees) and group borders are kept as features.
ruga_status ruga_mesh_remesh(const ruga_mesh* mesh, double edge, ruga_mesh* remeshed);

#endif
