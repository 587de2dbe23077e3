// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A region of the plane with holes, as a few large triangles.
#ifndef RUGA_MESH_REGION_H
#define RUGA_MESH_REGION_H

#include "mesh/mesh.h"

// What lies within an odd number of the loops that the segments form; they may touch at vertices, but not
// cross. z = 0, normals +z. Vertices that no triangle uses are left out. RUGA_BAD_INPUT where nothing lies
// within.
ruga_status ruga_mesh_from_region(int point_count, const double (*point)[2], int segment_count,
                                  const int (*segment)[2], ruga_mesh* mesh);

#endif
