// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "lattice/element_pattern.h"

#include "core/memory.h"

#include <limits.h>

// Links of elements from the blocks of the vertex matrices.
static ruga_status find_links(const ruga_lattice* lattice, const ruga_sparse* vertices, ruga_sparse* links) {
    ruga_status status = RUGA_OK;
    int(*pairs)[2] = NULL;
    int blocks = vertices ? vertices->start[vertices->columns] / 9 + vertices->columns : 0;
    int64_t count = 0;
    RUGA_TRY(RUGA_NEW(pairs, blocks));
    for (int j = 0; vertices && j < vertices->columns / 3; j++) {
        for (int k = vertices->start[3 * j]; k < vertices->start[3 * j + 1]; k += 3) {
            int e1 = lattice->vertex_element[vertices->index[k] / 3], e2 = lattice->vertex_element[j];
            if (e1 != e2) {
                pairs[count][0] = e1;
                pairs[count++][1] = e2;
            }
        }
    }
    status = ruga_sparse_from_pairs(lattice->element_count, 1, count, (const int(*)[2])pairs, links);
    ruga_release(pairs);
    return status;
}

// All pairs of nodes of linked elements.
static ruga_status find_matrix(const ruga_lattice* lattice, ruga_element_pattern* pattern) {
    int n = pattern->nodes_per_element;
    const ruga_sparse* links = &pattern->links;
    int(*pairs)[2] = NULL;
    int64_t count = 0;
    RUGA_TRY(RUGA_NEW(pairs, (int64_t)links->start[links->columns] * n * n));
    for (int low = 0; low < links->columns; low++) {
        for (int k = links->start[low]; k < links->start[low + 1]; k++) {
            const int* row = &pattern->element_node[links->index[k] * n];
            const int* column = &pattern->element_node[low * n];
            for (int a = 0; a < n; a++) {
                for (int b = 0; b < (row == column ? a : n); b++) {
                    pairs[count][0] = row[a];
                    pairs[count++][1] = column[b];
                }
            }
        }
    }
    ruga_status status =
        ruga_sparse_from_pairs(lattice->node_count, 3, count, (const int(*)[2])pairs, &pattern->matrix);
    ruga_release(pairs);
    return status;
}

static ruga_status find_blocks(ruga_element_pattern* pattern) {
    int n = pattern->nodes_per_element;
    const ruga_sparse* links = &pattern->links;
    RUGA_TRY(RUGA_NEW(pattern->block, (int64_t)links->start[links->columns] * n * n));
    for (int low = 0; low < links->columns; low++) {
        for (int k = links->start[low]; k < links->start[low + 1]; k++) {
            const int* row = &pattern->element_node[links->index[k] * n];
            const int* column = &pattern->element_node[low * n];
            int* block = &pattern->block[(int64_t)k * n * n];
            for (int a = 0; a < n; a++) {
                for (int b = 0; b < n; b++) {
                    int high_node = row[a] > column[b] ? row[a] : column[b];
                    int low_node = row[a] + column[b] - high_node;
                    block[a * n + b] = ruga_block_find(&pattern->matrix, high_node, low_node);
                }
            }
        }
    }
    return RUGA_OK;
}

ruga_status ruga_element_pattern_create(const ruga_lattice* lattice, const ruga_sparse* vertex_pattern,
                                        ruga_element_pattern* pattern) {
    RUGA_ASSERT(!vertex_pattern || vertex_pattern->columns == 3 * lattice->vertex_count);
    *pattern = (ruga_element_pattern){.nodes_per_element = lattice->nodes_per_element,
                                      .element_node = lattice->element_node};
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(find_links(lattice, vertex_pattern, &pattern->links));
    RUGA_TRY_DONE(find_matrix(lattice, pattern));
    RUGA_TRY_DONE(find_blocks(pattern));
done:
    if (status != RUGA_OK) {
        ruga_element_pattern_clear(pattern);
    }
    return status;
}

void ruga_element_pattern_clear(ruga_element_pattern* pattern) {
    ruga_sparse_clear(&pattern->matrix);
    ruga_sparse_clear(&pattern->links);
    ruga_release(pattern->block);
    *pattern = (ruga_element_pattern){0};
}
