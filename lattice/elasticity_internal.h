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

// A 3 x 3 block K_ij of the vertex matrices, as a link sees it: i in its higher element, j in its lower.
typedef struct ruga_embedded_block {
    int link, row, column; // row, column: i, j
    int first;             // position in K of the first entry of K_ij, of K_ji where i < j
} ruga_embedded_block;

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

    int embedding_entries; // of the vertex matrices
    ruga_embedded_block*
        embedded_block; // [embedded_count] by link and column; both ways round within an element
    int* embedded_link; // [embedded_link_count + 1] where the blocks of a link begin
    int embedded_count, embedded_link_count;
};

// plane[a][b] += sum over rows r < count of left[r][a] * right[r][b]; with `upper`, only the 4 x 4 tiles on
// and above the diagonal.
void ruga_plane_accumulate(int count, int width, const double* left, const double* right, bool upper,
                           double* plane);

// mirrored = the transpose of plane; mirrored == plane: fills the rest of one made with `upper`.
void ruga_plane_mirror(int width, const double* plane, double* mirrored);

// Nodes per chunk of a scatter that goes by columns of the system matrix.
int ruga_scatter_chunk(const ruga_elasticity* elasticity);

// Lists the blocks of vertex matrices of this pattern.
ruga_status ruga_embedding_create(ruga_elasticity* elasticity, const ruga_sparse* vertex_pattern);

#endif
