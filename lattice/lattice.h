// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The interior: a coarse lattice of hexahedral elements with uniform quadratic B-splines (degree 2, 27 nodes,
// C1) or trilinear functions (degree 1, 8 nodes, C0); superimposed elements with node duplication where a
// cell holds separate pieces of material (Remillard and Kry 2013, section 5.1).
#ifndef RUGA_LATTICE_LATTICE_H
#define RUGA_LATTICE_LATTICE_H

#include "mesh/connectivity.h"
#include "mesh/mesh.h"

enum { RUGA_LATTICE_POINTS = 27, RUGA_LATTICE_NODES_MAX = 27 };

typedef struct ruga_lattice {
    int degree;
    int nodes_per_element; // 27 or 8; local node i + n (j + n k), n = degree + 1
    double origin[3];      // corner of cell (0, 0, 0)
    double cell_size[3];
    int cells[3];
    int element_count;
    int* element_cell;  // [E][3]
    int* element_node;  // [E][nodes_per_element]
    double* volume;     // [E][27] material volume that each quadrature point stands for, >= 0; point g = a + 3 (b + 3 c)
    int superimposed;   // elements beyond the first in their cell
    int node_count;
    double* rest; // [N][3] rest positions of the nodes; an affine map applied to them maps the body by it
    // The surface in the lattice: B. Vertex v is the combination of its element's nodes.
    int vertex_count;
    int* vertex_element;  // [V]
    double* vertex_weight; // [V][nodes_per_element], sums to one
    int* gather_start;     // [N + 1] of each node, where the list of its vertices starts
    int* gather;           // [V nodes_per_element] places in vertex_weight, ascending for each node
} ruga_lattice;

// Builds the lattice of a watertight mesh (fill mesh) or of its box (fill box; the mesh may be open).
// RUGA_BAD_MESH where the mesh is not watertight (the caller shows the doctor's report before).
ruga_status ruga_lattice_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                const ruga_lattice_def* def, ruga_lattice* lattice);
void ruga_lattice_clear(ruga_lattice* lattice);

// Shape functions and their gradients (per metre, rest shape) at local coordinates xi in [0, 1]^3 of a cell.
// weight [npe]; gradient [npe][3] may be NULL.
void ruga_lattice_shape(const ruga_lattice* lattice, const double xi[3], double* weight, double* gradient);

// Rest position and local coordinates of quadrature point g of element e (3-point Gauss per axis).
void ruga_lattice_point(const ruga_lattice* lattice, int element, int g, double xi[3], double x[3]);

// Replaces the surface's vertices by copies of them: row i of B becomes the old row of source[i] [count].
ruga_status ruga_lattice_copy_vertices(ruga_lattice* lattice, int count, const int* source);

// x = B q: x [V][3], q [N][3].   f_q += B^T f_x.
void ruga_lattice_embed(const ruga_lattice* lattice, const double* q, double* x);
void ruga_lattice_embed_transpose(const ruga_lattice* lattice, const double* fx, double* fq);

#endif
