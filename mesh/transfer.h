// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a remeshed surface takes over from the old one.
#ifndef RUGA_MESH_TRANSFER_H
#define RUGA_MESH_TRANSFER_H

#include "mesh/mesh.h"

// Fills source_vertex (of vertices that are within 1e-9 `edge` of an old one, which they are put on exactly)
// and, where the old mesh has them, attributes (those of the nearest point), uv and uv_triangle of `mesh`,
// whose positions and triangles are set. `edge` (m) is the length of the new edges.
ruga_status ruga_mesh_transfer(const ruga_mesh* old, double edge, ruga_mesh* mesh);

// The nearest point of a mesh to each of [count][3] points: corner [count] vertices of its face, weight
// [count], sum 1.
ruga_status ruga_mesh_locate(const ruga_mesh* mesh, int count, const double* point, int (*corner)[3],
                             double (*weight)[3]);

#endif
