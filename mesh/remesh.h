// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Isotropic, near-equilateral remeshing (CGAL), features kept, UVs and groups transferred.
#ifndef RUGA_MESH_REMESH_H
#define RUGA_MESH_REMESH_H

#include "mesh/mesh.h"

// `edge` in m > 0: the mean length of the new edges, or up to 12 % less where faces would cross otherwise.
// Boundaries and group borders are kept as lines, and so are sharp edges (dihedral above 50 degrees) as far
// as triangles of this size fit between them. Closed meshes stay closed. RUGA_BAD_INPUT for an edge that does
// not suit the mesh, RUGA_BAD_MESH for a mesh that is not manifold and where every try would make faces
// cross.
ruga_status ruga_mesh_remesh(const ruga_mesh* mesh, double edge, ruga_mesh* remeshed);

#endif
