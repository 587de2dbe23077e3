// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The virtual node algorithm (Molino, Bao and Fedkiw 2004) for simplices of any dimension: a mesh element
// that is cut into pieces is copied once for each, and the corners of all copies are glued where material
// connects them. What is left are copies of mesh vertices: real ones, in which material lies at the vertex
// itself, and virtual ones.
#ifndef RUGA_CREASE_COPIES_H
#define RUGA_CREASE_COPIES_H

#include "core/status.h"

typedef struct ruga_copies {
    int vertex_count; // of the mesh
    int slot_count;   // corners of all element copies
    int* vertex;      // [slots] mesh vertex at a corner
    bool* material;   // [slots] whether the copy's piece reaches this corner
    int* parent;      // [slots] disjoint sets
    // By ruga_copies_number:
    int node_count; // [0, V): the first real copy of each vertex; [V, real): further real ones; then virtual
    int real_count;
    int* node;       // [slots]
    int* source;     // [nodes] mesh vertex
    int* copy_start; // [V + 1]
    int* copy;       // [nodes] the copies of each vertex, ascending
} ruga_copies;

// All corners apart, material nowhere; vertex [slots] is to be filled by the caller.
ruga_status ruga_copies_create(int vertex_count, int slot_count, ruga_copies* copies);
void ruga_copies_clear(ruga_copies* copies);
// Two corners at the same mesh vertex become one.
void ruga_copies_glue(ruga_copies* copies, int a, int b);
ruga_status ruga_copies_number(ruga_copies* copies);

#endif
