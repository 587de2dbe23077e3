// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What elasticity.c (energy) and elasticity_matrix.c (mass, embedded matrices) share.
//
// A dense matrix of an element or link is a stack of planes, one for each pair of components: [width][width]
// over local nodes, `width` the nodes of an element rounded up to a multiple of 4 and padded with zeros.
#ifndef RUGA_LATTICE_ELASTICITY_INTERNAL_H
#define RUGA_LATTICE_ELASTICITY_INTERNAL_H

#include "lattice/elasticity.h"
#include "lattice/element_pattern.h"

enum { RUGA_WIDTH_MAX = 28, RUGA_PLANE_MAX = RUGA_WIDTH_MAX * RUGA_WIDTH_MAX };

struct ruga_elasticity {
    const ruga_lattice* lattice;
    double mu, lambda; // Pa
    int width;
    // The same for all elements, as all cells are equal boxes; rows of `width`.
    double weight[RUGA_LATTICE_POINTS * RUGA_WIDTH_MAX];       // [27][width] shape functions
    double gradient[RUGA_LATTICE_POINTS * 3 * RUGA_WIDTH_MAX]; // [27][3][width] 1/m
    double* stiffness;                                         // [E][27] m^3, volumes with the floor
    int* vertex_start;                                         // [E + 1]
    int* vertex;                                               // [V] surface vertices by element, ascending
    ruga_element_pattern pattern;
};

// plane[a][b] += sum over rows r < count of left[r][a] * right[r][b]; with `upper`, only the 4 x 4 tiles on
// and above the diagonal.
void ruga_plane_accumulate(int count, int width, const double* left, const double* right, bool upper,
                           double* plane);

// Fills the rest of a plane made with `upper`.
void ruga_plane_mirror(int width, double* plane);

// Nodes per chunk of a scatter that goes by columns of the system matrix.
int ruga_scatter_chunk(const ruga_elasticity* elasticity);

#endif
