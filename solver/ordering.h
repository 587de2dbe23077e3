// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Fill-reducing orders for direct factorisation, found on the graph of nodes (groups of unknowns that are
// always connected alike, such as the three coordinates of a vertex), which is nine times smaller.
#ifndef RUGA_SOLVER_ORDERING_H
#define RUGA_SOLVER_ORDERING_H

#include "core/sparse.h"

typedef struct ruga_node_graph {
    int count;
    int* unknown;   // [count + 1] node i = unknowns [unknown[i], unknown[i + 1])
    int* start;     // [count + 1]
    int* neighbour; // [start[count]] both directions, without the node itself
} ruga_node_graph;

// Graph of the pattern `lower`; `node_start` NULL: each unknown is a node.
ruga_status ruga_node_graph_create(const ruga_sparse* lower, int node_count, const int* node_start,
                                   ruga_node_graph* graph);
// Frees the arrays and zeroes the struct.
void ruga_node_graph_clear(ruga_node_graph* graph);

// Number of unknowns of a node.
static inline int ruga_node_size(const ruga_node_graph* graph, int node) {
    return graph->unknown[node + 1] - graph->unknown[node];
}

// The better of nested dissection (METIS) and minimum degree (AMD), by entries of the factor:
// order[k] = node eliminated k-th. Nodes with `last` (NULL: none) come after those of their neighbours
// that make their pivots safe: see ordering.c.
ruga_status ruga_order_nodes(const ruga_node_graph* graph, const bool* last, int* order);

// Elimination tree and column counts for an order. parent[k]: step that is the parent of step k, -1 for a
// root. height[k]: unknowns in the column of step k on and below the diagonal block.
ruga_status ruga_elimination_tree(const ruga_node_graph* graph, const int* order, int* parent, int* height);

// Children before parents, each subtree contiguous: post[k] = k-th visited. A parent has a larger number
// than its children. `scratch` [3 * count].
void ruga_postorder(int count, const int* parent, int* post, int* scratch);

#endif
