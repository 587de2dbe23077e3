// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Orders by METIS (nested dissection; METIS_NodeND) and AMD (Amestoy, Davis, Duff 1996) on the node graph.
//
// Multipliers of a saddle point matrix [K H^T; H 0] have no diagonal of their own: theirs is made by the
// elimination of their neighbours, as -H_e K_ee^-1 H_e^T over the neighbours e eliminated so far. A node
// marked `last` is therefore moved, if need be, to just behind half of its neighbours. Waiting for all of
// them would be a little safer and costs more fill, since a cluster that merely touches a separator would
// then join it; what half of the neighbours leave unsafe is caught by pivoting in the fronts.
#include "solver/ordering.h"

#include "core/memory.h"

#include <amd.h>
#include <metis.h>

#include <string.h>

void ruga_node_graph_clear(ruga_node_graph* graph) {
    ruga_release(graph->unknown);
    ruga_release(graph->start);
    ruga_release(graph->neighbour);
    *graph = (ruga_node_graph){0};
}

// Calls for each connected pair of nodes j < i once: counts both directions in start[], or with `fill`
// enters both in neighbour[].
static void visit_pairs(const ruga_sparse* lower, const int* node_of, ruga_node_graph* graph, int* seen,
                        int* fill) {
    for (int j = 0; j < graph->count; j++) {
        seen[j] = -1;
    }
    for (int j = 0; j < graph->count; j++) {
        for (int p = lower->start[graph->unknown[j]]; p < lower->start[graph->unknown[j + 1]]; p++) {
            int i = node_of[lower->index[p]];
            if (i == j || seen[i] == j) {
                continue;
            }
            seen[i] = j;
            if (fill) {
                graph->neighbour[fill[j]++] = i;
                graph->neighbour[fill[i]++] = j;
            } else {
                graph->start[j + 1]++;
                graph->start[i + 1]++;
            }
        }
    }
}

static ruga_status build_adjacency(const ruga_sparse* lower, ruga_node_graph* graph) {
    ruga_status status = RUGA_OK;
    int count = graph->count;
    int *node_of = NULL, *seen = NULL, *fill = NULL;
    RUGA_TRY_DONE(RUGA_NEW(node_of, lower->columns));
    RUGA_TRY_DONE(RUGA_NEW(seen, count));
    RUGA_TRY_DONE(RUGA_NEW(fill, count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(graph->start, count + 1));
    for (int i = 0; i < count; i++) {
        for (int u = graph->unknown[i]; u < graph->unknown[i + 1]; u++) {
            node_of[u] = i;
        }
    }
    visit_pairs(lower, node_of, graph, seen, NULL);
    for (int i = 0; i < count; i++) {
        graph->start[i + 1] += graph->start[i];
        fill[i] = graph->start[i];
    }
    RUGA_TRY_DONE(RUGA_NEW(graph->neighbour, graph->start[count]));
    visit_pairs(lower, node_of, graph, seen, fill);
done:
    ruga_release(node_of);
    ruga_release(seen);
    ruga_release(fill);
    return status;
}

ruga_status ruga_node_graph_create(const ruga_sparse* lower, int node_count, const int* node_start,
                                   ruga_node_graph* graph) {
    ruga_status status = RUGA_OK;
    *graph = (ruga_node_graph){.count = node_start ? node_count : lower->columns};
    RUGA_TRY_DONE(RUGA_NEW(graph->unknown, graph->count + 1));
    for (int i = 0; i <= graph->count; i++) {
        graph->unknown[i] = node_start ? node_start[i] : i;
    }
    RUGA_ASSERT(graph->unknown[0] == 0 && graph->unknown[graph->count] == lower->columns);
    RUGA_TRY_DONE(build_adjacency(lower, graph));
done:
    if (status != RUGA_OK) {
        ruga_node_graph_clear(graph);
    }
    return status;
}

ruga_status ruga_elimination_tree(const ruga_node_graph* graph, const int* order, int* parent, int* height) {
    ruga_status status = RUGA_OK;
    int count = graph->count;
    int *step = NULL, *ancestor = NULL;
    RUGA_TRY_DONE(RUGA_NEW(step, count));
    RUGA_TRY_DONE(RUGA_NEW(ancestor, count));
    for (int k = 0; k < count; k++) {
        step[order[k]] = k;
    }
    for (int k = 0; k < count; k++) { // Liu's algorithm with path compression
        parent[k] = ancestor[k] = -1;
        for (int p = graph->start[order[k]]; p < graph->start[order[k] + 1]; p++) {
            int i = step[graph->neighbour[p]];
            while (i < k && i != -1) {
                int next = ancestor[i];
                ancestor[i] = k;
                if (next == -1) {
                    parent[i] = k;
                }
                i = next;
            }
        }
    }
    // Row k of the factor is the subtree of paths from its neighbours up to k.
    int* mark = ancestor;
    for (int k = 0; k < count; k++) {
        height[k] = ruga_node_size(graph, order[k]);
        mark[k] = k;
        for (int p = graph->start[order[k]]; p < graph->start[order[k] + 1]; p++) {
            for (int i = step[graph->neighbour[p]]; i < k && mark[i] != k; i = parent[i]) {
                height[i] += height[k];
                mark[i] = k;
            }
        }
    }
done:
    ruga_release(step);
    ruga_release(ancestor);
    return status;
}

void ruga_postorder(int count, const int* parent, int* post, int* scratch) {
    int *first = scratch, *next = scratch + count, *stack = scratch + 2 * (size_t)count;
    for (int k = 0; k < count; k++) {
        first[k] = -1;
    }
    for (int k = count - 1; k >= 0; k--) {
        if (parent[k] >= 0) {
            next[k] = first[parent[k]];
            first[parent[k]] = k;
        }
    }
    int out = 0;
    for (int root = 0; root < count; root++) {
        int depth = 0;
        if (parent[root] < 0) {
            stack[depth++] = root;
        }
        while (depth) {
            int k = stack[depth - 1];
            if (first[k] < 0) {
                post[out++] = k;
                depth--;
            } else {
                stack[depth++] = first[k];
                first[k] = next[first[k]];
            }
        }
    }
}

// Entries of the factor with this order.
static ruga_status measure_fill(const ruga_node_graph* graph, const int* order, double* entries) {
    ruga_status status = RUGA_OK;
    int *parent = NULL, *height = NULL;
    *entries = 0;
    RUGA_TRY_DONE(RUGA_NEW(parent, graph->count));
    RUGA_TRY_DONE(RUGA_NEW(height, graph->count));
    RUGA_TRY_DONE(ruga_elimination_tree(graph, order, parent, height));
    for (int k = 0; k < graph->count; k++) {
        double size = ruga_node_size(graph, order[k]);
        *entries += size * height[k] - size * (size - 1) / 2;
    }
done:
    ruga_release(parent);
    ruga_release(height);
    return status;
}

// The k-th smallest of values[0..count), by quickselect; reorders them.
static int select_kth(int* values, int count, int k) {
    int low = 0, high = count - 1;
    while (low < high) {
        int pivot = values[low + (high - low) / 2], i = low, j = high;
        while (i <= j) {
            while (values[i] < pivot) {
                i++;
            }
            while (values[j] > pivot) {
                j--;
            }
            if (i <= j) {
                int swap = values[i];
                values[i++] = values[j];
                values[j--] = swap;
            }
        }
        if (k <= j) {
            high = j;
        } else if (k >= i) {
            low = i;
        } else {
            break;
        }
    }
    return values[k];
}

// The step behind which a marked node must wait: that of its median unmarked neighbour, or its own.
static int safe_step(const ruga_node_graph* graph, const bool* last, const int* step, int node, int* found) {
    int count = 0;
    for (int p = graph->start[node]; p < graph->start[node + 1]; p++) {
        if (!last[graph->neighbour[p]]) {
            found[count++] = step[graph->neighbour[p]];
        }
    }
    int wait = count ? select_kth(found, count, count / 2) : -1;
    return wait > step[node] ? wait : step[node];
}

static ruga_status postpone_marked(const ruga_node_graph* graph, const bool* last, int* order) {
    ruga_status status = RUGA_OK;
    int count = graph->count;
    int *step = NULL, *first = NULL, *next = NULL, *found = NULL, *old = NULL;
    RUGA_TRY_DONE(RUGA_NEW(step, count));
    RUGA_TRY_DONE(RUGA_NEW(first, count));
    RUGA_TRY_DONE(RUGA_NEW(next, count));
    RUGA_TRY_DONE(RUGA_NEW(found, count));
    RUGA_TRY_DONE(RUGA_NEW(old, count));
    for (int k = 0; k < count; k++) {
        old[k] = order[k];
        step[order[k]] = k;
        first[k] = -1;
    }
    for (int k = count - 1; k >= 0; k--) { // lists of nodes that follow a step, in their old order
        if (last[old[k]]) {
            int wait = safe_step(graph, last, step, old[k], found);
            next[k] = first[wait];
            first[wait] = k;
        }
    }
    int out = 0;
    for (int k = 0; k < count; k++) {
        if (!last[old[k]]) {
            order[out++] = old[k];
        }
        for (int i = first[k]; i >= 0; i = next[i]) {
            order[out++] = old[i];
        }
    }
done:
    ruga_release(step);
    ruga_release(first);
    ruga_release(next);
    ruga_release(found);
    ruga_release(old);
    return status;
}

static ruga_status order_by_amd(const ruga_node_graph* graph, int* order) {
    int result = amd_order(graph->count, graph->start, graph->neighbour, order, NULL, NULL);
    if (result == AMD_OUT_OF_MEMORY) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory in AMD while ordering %d nodes", graph->count);
    }
    if (result < AMD_OK) {
        return ruga_fail(RUGA_LIBRARY, "AMD failed with code %d while ordering %d nodes", result,
                         graph->count);
    }
    return RUGA_OK;
}

static ruga_status order_by_metis(const ruga_node_graph* graph, int* order) {
    ruga_status status = RUGA_OK;
    idx_t options[METIS_NOPTIONS], count = graph->count;
    int *weight = NULL, *step = NULL;
    RUGA_TRY_DONE(RUGA_NEW(weight, count));
    RUGA_TRY_DONE(RUGA_NEW(step, count));
    for (int i = 0; i < count; i++) {
        weight[i] = ruga_node_size(graph, i);
    }
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_SEED] = 1; // the same order in every run
    int result = METIS_NodeND(&count, graph->start, graph->neighbour, weight, options, order, step);
    if (result == METIS_ERROR_MEMORY) {
        status = ruga_fail(RUGA_NO_MEMORY, "out of memory in METIS while ordering %d nodes", graph->count);
    } else if (result != METIS_OK) {
        status = ruga_fail(RUGA_LIBRARY, "METIS failed with code %d while ordering %d nodes", result,
                           graph->count);
    }
done:
    ruga_release(weight);
    ruga_release(step);
    return status;
}

ruga_status ruga_order_nodes(const ruga_node_graph* graph, const bool* last, int* order) {
    enum { SMALL = 64 }; // below, dissection has nothing to gain
    ruga_status status = RUGA_OK;
    int* other = NULL;
    double entries, other_entries;
    RUGA_TRY_DONE(order_by_amd(graph, order));
    if (last) {
        RUGA_TRY_DONE(postpone_marked(graph, last, order));
    }
    if (graph->count < SMALL || graph->start[graph->count] == 0) {
        goto done;
    }
    RUGA_TRY_DONE(RUGA_NEW(other, graph->count));
    RUGA_TRY_DONE(order_by_metis(graph, other));
    if (last) {
        RUGA_TRY_DONE(postpone_marked(graph, last, other));
    }
    RUGA_TRY_DONE(measure_fill(graph, order, &entries));
    RUGA_TRY_DONE(measure_fill(graph, other, &other_entries));
    if (other_entries < entries) {
        memcpy(order, other, (size_t)graph->count * sizeof *order);
    }
done:
    ruga_release(other);
    return status;
}
