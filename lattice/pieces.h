// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The connected components of material in every sub-cell that the surface passes through, with their volumes.
#ifndef RUGA_LATTICE_PIECES_H
#define RUGA_LATTICE_PIECES_H

#include "lattice/caps.h"

typedef struct ruga_piece {
    int index[3];  // sub-cell
    double volume; // in cells, weighted with the winding number
} ruga_piece;

typedef struct ruga_piece_cell {
    int index[3];
    int begin, end;   // its triangles in ruga_pieces.cell_triangle
    int full_face[6]; // piece at a face (2 axis + side) that lies in the material as a whole, -1 = none
} ruga_piece_cell;

typedef struct ruga_pieces {
    int cell_count, cell_capacity;
    ruga_piece_cell* cell;
    int* cell_triangle;
    int* triangle_cell;
    int piece_count, piece_capacity;
    ruga_piece* piece;
    int* triangle_piece;
    int (*region_piece)[2]; // of each cap: on the plane's negative and on its positive side
} ruga_pieces;

ruga_status ruga_pieces_create(const ruga_caps* caps, ruga_pieces* pieces);
void ruga_pieces_clear(ruga_pieces* pieces);

// Adds one piece and returns its number in *piece.
ruga_status ruga_pieces_add(ruga_pieces* pieces, const int index[3], double volume, int* piece);

#endif
