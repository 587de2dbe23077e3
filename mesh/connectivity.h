// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Edges and neighbours of a manifold triangle mesh, open or closed.
#ifndef RUGA_MESH_CONNECTIVITY_H
#define RUGA_MESH_CONNECTIVITY_H

#include "mesh/mesh.h"

typedef struct ruga_connectivity {
    int vertex_count;
    int triangle_count;
    int edge_count;
    int (*edge)[2];          // [E] vertices, edge[e][0] < edge[e][1], edges sorted lexicographically
    int (*edge_triangle)[2]; // [E] [0]: the triangle that runs edge[0] -> edge[1], [1]: the other; -1 = none
    int (*edge_opposite)[2]; // [E] the vertices of these triangles opposite the edge; -1 = none
    int (*triangle_edge)[3]; // [F] edge from corner i to corner i + 1
    int* neighbour_start;    // [V + 1]
    int* neighbour;          // [2 E] vertices that share an edge, ascending
    int* neighbour_edge;     // [2 E]
    int* incident_start;     // [V + 1]
    int* incident;           // [3 F] triangles around a vertex, ascending
    int component_count;
    int* component; // [V] connected component, by shared faces; -1 for unused vertices
} ruga_connectivity;

// RUGA_BAD_MESH with the place where an edge has more than two faces or two that run the same way.
ruga_status ruga_connectivity_create(const ruga_mesh* mesh, ruga_connectivity* connectivity);
// Frees the arrays (not the struct) and zeroes it.
void ruga_connectivity_clear(ruga_connectivity* connectivity);

#endif
