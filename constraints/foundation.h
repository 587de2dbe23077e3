// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The interior's response to what the lattice cannot represent: energy 1/2 d^T (a M + b L) d of d = x - Bq,
// M lumped areas, L cotangent Laplacian, of the rest shape; a = E*_q k/4, b = E*_q/(4k), k = 2 pi/lambda: the
// half-space's E*_q k/2 and its slope at the critical wave number.
#ifndef RUGA_CONSTRAINTS_FOUNDATION_H
#define RUGA_CONSTRAINTS_FOUNDATION_H

#include "core/sparse.h"
#include "mesh/connectivity.h"
#include "mesh/mesh.h"

typedef struct ruga_foundation {
    int vertex_count;
    int edge_count;
    double* diagonal;  // [V] of a M + b L, N/m
    double* edge_value; // [E] off-diagonal entry for each edge of the connectivity
    int (*edge)[2];    // [E]
    double* vertex_scale; // [V] lumped area, m^2
} ruga_foundation;

ruga_status ruga_foundation_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double a,
                                   double b, ruga_foundation* foundation);
void ruga_foundation_clear(ruga_foundation* foundation);

// Energy in J at d [V][3]; ADDS W d to gradient [V][3] where not NULL. force_square as in shell.h, SET.
double ruga_foundation_energy(const ruga_foundation* foundation, const double* d, double* gradient,
                              double* force_square);

// Adds W to the values of a Hessian whose pattern (3 x 3 blocks over vertices) holds the mesh's edges; `slot`
// comes from ruga_foundation_map.
ruga_status ruga_foundation_map(const ruga_foundation* foundation, const ruga_sparse* pattern, int** slot);
void ruga_foundation_add_hessian(const ruga_foundation* foundation, const int* slot, double* hessian);

#endif
