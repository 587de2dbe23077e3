// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Elastic energy of the interior: fixed corotational, robust to inversion, on the lattice's 27-point
// quadrature.
//   psi(F) = mu |F - R|^2 + lambda/2 (det F - 1)^2, R the rotation nearest to F by the signed SVD
#ifndef RUGA_LATTICE_ELASTICITY_H
#define RUGA_LATTICE_ELASTICITY_H

#include "core/sparse.h"
#include "lattice/lattice.h"

typedef struct ruga_elasticity ruga_elasticity;

// Precomputes shape gradients, weights (with a stiffness floor for elements with a sliver of material) and
// the Hessian's pattern (lower triangle, 3 x 3 blocks over the lattice nodes) with its scatter map. The
// lattice must outlive it. vertex_pattern: that of the vertex matrices which ruga_elasticity_add_embedded
// will add (lower triangle 3 V x 3 V in 3 x 3 blocks, e.g. ruga_shell_pattern); only read here; NULL = none
// will be added.
ruga_status ruga_elasticity_create(const ruga_lattice* lattice, double young, double poisson,
                                   const ruga_sparse* vertex_pattern, ruga_elasticity** elasticity);
void ruga_elasticity_destroy(ruga_elasticity** elasticity);

const ruga_sparse* ruga_elasticity_pattern(const ruga_elasticity* elasticity);

// Elastic energy in J at q [N][3]. gradient [N][3] and hessian (values of the pattern) are SET (not added to)
// where not NULL. `project`: each quadrature point's Hessian made positive semi-definite; otherwise exact.
// force_square: sum over elements of squared nodal forces, for f_ref; may be NULL.
ruga_status ruga_elasticity_energy(const ruga_elasticity* elasticity, const double* q, bool project,
                                   double* energy, double* gradient, double* hessian, double* force_square);

// Consistent mass with the same pattern, scalar expanded to the three components; total = density * volume.
// Adds B^T diag(vertex_mass) B where vertex_mass [V] is not NULL. mass: values of the pattern, SET.
ruga_status ruga_elasticity_mass(const ruga_elasticity* elasticity, double density, const double* vertex_mass,
                                 double* mass);

// Adds B^T K B to hessian values of the pattern, for a symmetric vertex matrix K given as its lower triangle
// (3 V x 3 V in 3 x 3 blocks, as from shell/), which must have the pattern that was given as vertex_pattern;
// RUGA_BAD_INPUT otherwise.
ruga_status ruga_elasticity_add_embedded(const ruga_elasticity* elasticity, const ruga_sparse* vertex_matrix,
                                         double* hessian);

#endif
