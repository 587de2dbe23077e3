// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Where the element matrices of a lattice go in the system matrix: its pattern, and the scatter maps.
//
// Two elements are linked when a vertex matrix may couple surface vertices in them; every element is linked
// with itself. The system matrix has a 3 x 3 block for each pair of nodes of linked elements.
#ifndef RUGA_LATTICE_ELEMENT_PATTERN_H
#define RUGA_LATTICE_ELEMENT_PATTERN_H

#include "core/sparse.h"
#include "lattice/lattice.h"

typedef struct ruga_element_pattern {
    int nodes_per_element;   // n below
    const int* element_node; // [E][n], the lattice's
    ruga_sparse matrix;      // lower triangle, 3 x 3 blocks over the nodes
    ruga_sparse links;       // [E][E] lower triangle: the position of (high, low) numbers the link
    int* block; // [links][n][n] position of the first entry of the block of node a of `high`, b of `low`
} ruga_element_pattern;

// vertex_pattern: lower triangle, 3 V x 3 V in 3 x 3 blocks, of all vertex matrices to come; NULL for none.
ruga_status ruga_element_pattern_create(const ruga_lattice* lattice, const ruga_sparse* vertex_pattern,
                                        ruga_element_pattern* pattern);
void ruga_element_pattern_clear(ruga_element_pattern* pattern);

// Positions of a 3 x 3 block's columns relative to its first entry, for a block in the columns of `node`:
// entry (r, c) stands at first + offset[c] + r; in a diagonal block only where r >= c.
static inline void ruga_block_offsets(const ruga_sparse* matrix, int node, int offset[3]) {
    int length = matrix->start[3 * node + 1] - matrix->start[3 * node];
    offset[0] = 0;
    offset[1] = length - 1;
    offset[2] = 2 * length - 3;
}

// Position of the first entry of block (row, column), row >= column, both numbered by blocks; -1 for none.
static inline int ruga_block_find(const ruga_sparse* matrix, int row, int column) {
    return ruga_sparse_find(matrix, 3 * row, 3 * column);
}

// Number of the link of two elements; -1 where they are not linked.
static inline int ruga_link_find(const ruga_element_pattern* pattern, int e1, int e2) {
    return ruga_sparse_find(&pattern->links, e1 > e2 ? e1 : e2, e1 > e2 ? e2 : e1);
}

#endif
