// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#ifndef RUGA_LATTICE_ASSEMBLE_H
#define RUGA_LATTICE_ASSEMBLE_H

#include "lattice/lattice.h"
#include "lattice/pieces.h"

// Elements, nodes and material volumes of a lattice from the pieces of material in its sub-cells.
// piece_element [pieces after the call]: caller frees. Pieces may be added (sub-cells wholly inside).
ruga_status ruga_lattice_assemble(const ruga_caps* caps, ruga_pieces* pieces, ruga_lattice* lattice,
                                  int** piece_element);

// One full element in every cell: fill box.
ruga_status ruga_lattice_fill(ruga_lattice* lattice);

// The embedding B. element_of [V] names each vertex's element, -1 = the nearest; u [V][3] in cells.
ruga_status ruga_lattice_bind(ruga_lattice* lattice, int vertex_count, const double (*u)[3],
                              const int* element_of);

#endif
