// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#ifndef RUGA_MESH_WELD_H
#define RUGA_MESH_WELD_H

#include "mesh/mesh.h"

// Makes vertices within `tolerance` (m, Euclidean; 0 = equal positions) of an earlier kept vertex one with
// it. Kept vertices stay in their old order; faces, uvs and groups stay. source_vertex, where present,
// follows. Not-a-number is equal to nothing. O(V) for evenly spread vertices.
ruga_status ruga_mesh_weld(ruga_mesh* mesh, double tolerance);

#endif
