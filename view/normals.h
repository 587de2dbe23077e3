// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Smooth normals that keep what is sharp.
#ifndef RUGA_VIEW_NORMALS_H
#define RUGA_VIEW_NORMALS_H

#include "mesh/mesh.h"

// Unit normals at the corners of the faces, normal [F][3][3], for positions [V][3]. Not smoothed across the
// edges, corner k to k + 1, that `line` [F][3] numbers from 0; NULL = none.
ruga_status ruga_corner_normals(const ruga_mesh* mesh, const double* position, const int* line,
                                double* normal);

#endif
