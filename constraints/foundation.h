// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The interior's response to what the lattice cannot represent: energy 1/2 d^T W d, W = a M + b L, of
// d = x - Bq, M lumped areas, L cotangent Laplacian, of the rest shape; a = E*_q k/4, b = E*_q/(4k),
// k = 2 pi/lambda: the half-space's E*_q k/2 and its slope at the critical wave number. Where lambda varies,
// a is that of each vertex and b the mean of each triangle's corners: W stays symmetric and positive.
#ifndef RUGA_CONSTRAINTS_FOUNDATION_H
#define RUGA_CONSTRAINTS_FOUNDATION_H

#include "core/sparse.h"
#include "mesh/connectivity.h"
#include "mesh/mesh.h"

typedef struct ruga_foundation {
    int vertex_count;
    int edge_count;
    double* diagonal;     // [V] of a M + b L, N/m
    double* edge_value;   // [E] off-diagonal entry for each edge of the connectivity
    int (*edge)[2];       // [E]
    double* vertex_scale; // [V] lumped area, m^2
    // For the gradient, which each vertex gathers.
    double spring;        // a, N/m^3, where it is the same everywhere
    double* local_spring; // [V] a, or NULL
    int* neighbour_start; // [V + 1]
    int* neighbour;       // [2 E]
    int* neighbour_edge;  // [2 E]
} ruga_foundation;

// a in N/m^3 and b in N/m, not negative. RUGA_BAD_MESH with the face where a triangle has no area.
ruga_status ruga_foundation_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double a,
                                   double b, ruga_foundation* foundation);
// The same with a and b for each vertex, [V].
ruga_status ruga_foundation_create_local(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                         const double* a, const double* b, ruga_foundation* foundation);
// The same on pieces of a cut mesh (crease/cut.h), which overlap: area [V] m^2 and a [V] of the vertices, triangle_b [F]
// N/m with the part of each triangle that is material. Of the connectivity edges and neighbours alone are used.
ruga_status ruga_foundation_create_pieces(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                          const double* area, const double* a, const double* triangle_b,
                                          ruga_foundation* foundation);
void ruga_foundation_clear(ruga_foundation* foundation);

// Energy in J at d [V][3]; ADDS W d to gradient [V][3] where not NULL. force_square (where not NULL) is SET
// to the sum of squared nodal forces over vertices' springs (a M) and edges (b L, on both ends), N^2.
double ruga_foundation_energy(const ruga_foundation* foundation, const double* d, double* gradient,
                              double* force_square);

// Adds W to the values of a Hessian whose pattern (3 x 3 blocks over vertices) holds the mesh's edges; `slot`
// [3 V + 3 E] comes from ruga_foundation_map and is the caller's to release.
ruga_status ruga_foundation_map(const ruga_foundation* foundation, const ruga_sparse* pattern, int** slot);
void ruga_foundation_add_hessian(const ruga_foundation* foundation, const int* slot, double* hessian);

#endif
