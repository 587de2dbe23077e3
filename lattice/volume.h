// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The dense volumetric reference: interior and skin as one elastic body on a tensor product of B-splines,
// uniform along x and y, freely spaced in depth z. The skin is the cells above an interface at which the
// strain may jump.
//
// Unknowns are displacements u [N][3] of the control points. Node (i, j, k) of the three axes is
// i + count_x (j + count_y k).
#ifndef RUGA_LATTICE_VOLUME_H
#define RUGA_LATTICE_VOLUME_H

#include "core/sparse.h"
#include "lattice/spline.h"

typedef enum ruga_volume_law {
    RUGA_VOLUME_COROTATIONAL, // as the lattice: corotational.h
    RUGA_VOLUME_KIRCHHOFF,    // as other programs: kirchhoff.h
} ruga_volume_law;

typedef struct ruga_volume_def {
    int degree;                  // 1 or 2
    double size[2];              // m; the body is [0, size[0]] x [0, size[1]] x [depth[0], depth[layers]]
    int cells[2];                // along x and y; cells[1] = 0: plane strain (nothing depends on y; hold u_y)
    int layers;                  // cells in depth
    const double* depth;         // [layers + 1] m, ascending
    int interface;               // the skin is above depth[interface]; 0 < interface < layers
    double young[2], poisson[2]; // of the interior and of the skin
    ruga_volume_law law;
} ruga_volume_def;

typedef struct ruga_volume {
    ruga_spline axis[3];
    int interface;
    ruga_volume_law law;
    double mu[2], lambda[2]; // Pa
    int node_count, element_count, nodes_per_element;
    ruga_sparse pattern; // of the Hessian: lower triangle in 3 x 3 blocks, no values
    int* element_node;   // [E][n]
    int* block;          // [E][n (n + 1) / 2] first entry, in the pattern, of the block of a pair of nodes
} ruga_volume;

ruga_status ruga_volume_create(const ruga_volume_def* def, ruga_volume* volume);
void ruga_volume_clear(ruga_volume* volume);

// Elastic energy in J at u [N][3]. gradient [N][3] and hessian (values of the pattern) are SET where not
// NULL. force_square: sum over elements of squared nodal forces, N^2; may be NULL.
ruga_status ruga_volume_energy(const ruga_volume* volume, const double* u, double* energy, double* gradient,
                               double* hessian, double* force_square);

// Rest position of a node's control point, m. An affine displacement has u = A position + b there.
void ruga_volume_node(const ruga_volume* volume, int node, double position[3]);

// Displacement of the material point X, m.
void ruga_volume_displacement(const ruga_volume* volume, const double* u, const double X[3], double d[3]);

// The grid in depth: `below` cells of the interior from -depth to 0, the uppermost `first` high and each
// below it higher by one common factor, and `skin` equal cells from 0 to thickness. depth [below + skin + 1].
// first * below <= depth.
void ruga_volume_grade(double depth, double first, int below, double thickness, int skin, double* grid);

#endif
