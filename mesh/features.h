// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What remeshing must not smooth away: open boundaries, borders between groups and sharp edges.
#ifndef RUGA_MESH_FEATURES_H
#define RUGA_MESH_FEATURES_H

#include "mesh/connectivity.h"

typedef struct ruga_features {
    int edge_count;
    int (*edge)[2]; // vertices of the edges that are kept as lines
    bool* corner;   // [V] vertices that are kept as points: ends, forks and bends of these lines
    int patch_count;
    int* patch; // [F] faces that are connected without crossing a line; of one group
} ruga_features;

// Which lines, from few to many. Firm: boundaries and group borders. Bounding: also sharp edges (dihedral
// above 50 degrees) between two patches. Wide: also sharp lines that end within a patch. All: also those
// around patches that are narrower than half an edge.
typedef enum ruga_keep { RUGA_KEEP_FIRM, RUGA_KEEP_BOUNDING, RUGA_KEEP_WIDE, RUGA_KEEP_ALL } ruga_keep;

// `edge` is the length of the edges to come: sharp lines count where they are several times as long.
ruga_status ruga_features_find(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double edge,
                               ruga_keep keep, ruga_features* features);
// Frees the arrays (not the struct) and zeroes it.
void ruga_features_clear(ruga_features* features);

#endif
