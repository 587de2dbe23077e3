// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "core/sparse.h"

#include "core/memory.h"

#include <limits.h>
#include <string.h>

void ruga_sparse_clear(ruga_sparse* matrix) {
    ruga_release(matrix->start);
    ruga_release(matrix->index);
    ruga_release(matrix->value);
    *matrix = (ruga_sparse){0};
}

void ruga_sparse_multiply_symmetric(const ruga_sparse* lower, const double* x, double* y) {
    memset(y, 0, (size_t)lower->rows * sizeof *y);
    for (int j = 0; j < lower->columns; j++) {
        int p = lower->start[j];
        double sum = lower->value[p] * x[j];
        double xj = x[j];
        for (p++; p < lower->start[j + 1]; p++) {
            int i = lower->index[p];
            sum += lower->value[p] * x[i];
            y[i] += lower->value[p] * xj;
        }
        y[j] += sum;
    }
}

int ruga_sparse_find(const ruga_sparse* lower, int row, int column) {
    int low = lower->start[column], high = lower->start[column + 1] - 1;
    while (low <= high) {
        int middle = low + (high - low) / 2;
        if (lower->index[middle] == row) {
            return middle;
        }
        if (lower->index[middle] < row) {
            low = middle + 1;
        } else {
            high = middle - 1;
        }
    }
    return -1;
}

// Rows of each node-column, ascending and without repeats, by two passes of a counting sort: distributing
// by row and then by column leaves rows in order within each column.
static ruga_status sort_pairs(int nodes, int64_t pair_count, const int (*pairs)[2], int* start, int* row) {
    ruga_status status = RUGA_OK;
    int *by_row_start = NULL, *by_row_column = NULL, *fill = NULL;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(by_row_start, nodes + 1));
    RUGA_TRY_DONE(RUGA_NEW(by_row_column, pair_count + nodes));
    RUGA_TRY_DONE(RUGA_NEW(fill, nodes));
    for (int64_t k = 0; k < pair_count; k++) {
        int high = pairs[k][0] > pairs[k][1] ? pairs[k][0] : pairs[k][1];
        by_row_start[high + 1] += pairs[k][0] != pairs[k][1];
    }
    for (int i = 0; i < nodes; i++) {
        by_row_start[i + 1] += by_row_start[i] + 1;
    }
    for (int i = 0; i < nodes; i++) {
        fill[i] = by_row_start[i];
        by_row_column[fill[i]++] = i;
    }
    for (int64_t k = 0; k < pair_count; k++) {
        int low = pairs[k][0] < pairs[k][1] ? pairs[k][0] : pairs[k][1];
        int high = pairs[k][0] + pairs[k][1] - low;
        if (low != high) {
            by_row_column[fill[high]++] = low;
        }
    }
    memset(start, 0, (size_t)(nodes + 1) * sizeof *start);
    for (int k = 0; k < by_row_start[nodes]; k++) {
        start[by_row_column[k] + 1]++;
    }
    for (int j = 0; j < nodes; j++) {
        start[j + 1] += start[j];
        fill[j] = start[j];
    }
    for (int i = 0; i < nodes; i++) {
        for (int k = by_row_start[i]; k < by_row_start[i + 1]; k++) {
            row[fill[by_row_column[k]]++] = i;
        }
    }
    // Repeats now stand side by side.
    int out = 0;
    for (int j = 0, begin = 0; j < nodes; j++) {
        int end = start[j + 1];
        start[j] = out;
        for (int k = begin; k < end; k++) {
            if (k == begin || row[k] != row[k - 1]) {
                row[out++] = row[k];
            }
        }
        begin = end;
    }
    start[nodes] = out;
done:
    ruga_release(by_row_start);
    ruga_release(by_row_column);
    ruga_release(fill);
    return status;
}

static ruga_status expand_blocks(int nodes, int block, const int* start, const int* row, ruga_sparse* lower) {
    int64_t entries = 0;
    for (int j = 0; j < nodes; j++) {
        int64_t off = start[j + 1] - start[j] - 1;
        entries += off * block * block + block * (block + 1) / 2;
    }
    if (entries > INT_MAX) {
        return ruga_fail(RUGA_NO_MEMORY, "the system matrix has %lld entries, more than 2^31: use a coarser mesh",
                         (long long)entries);
    }
    lower->rows = lower->columns = nodes * block;
    RUGA_TRY(RUGA_NEW(lower->start, nodes * block + 1));
    RUGA_TRY(RUGA_NEW(lower->index, entries));
    RUGA_TRY(RUGA_NEW_ZERO(lower->value, entries));
    int out = 0;
    for (int j = 0; j < nodes; j++) {
        for (int b = 0; b < block; b++) {
            lower->start[j * block + b] = out;
            for (int c = b; c < block; c++) {
                lower->index[out++] = j * block + c;
            }
            for (int k = start[j] + 1; k < start[j + 1]; k++) {
                for (int c = 0; c < block; c++) {
                    lower->index[out++] = row[k] * block + c;
                }
            }
        }
    }
    lower->start[nodes * block] = out;
    return RUGA_OK;
}

ruga_status ruga_sparse_from_pairs(int nodes, int block, int64_t pair_count, const int (*pairs)[2],
                                   ruga_sparse* lower) {
    ruga_status status = RUGA_OK;
    int *start = NULL, *row = NULL;
    *lower = (ruga_sparse){0};
    if (pair_count + nodes > INT_MAX) {
        return ruga_fail(RUGA_NO_MEMORY, "the mesh is too large for 32-bit indices: use a coarser mesh");
    }
    RUGA_TRY_DONE(RUGA_NEW(start, nodes + 1));
    RUGA_TRY_DONE(RUGA_NEW(row, pair_count + nodes));
    RUGA_TRY_DONE(sort_pairs(nodes, pair_count, pairs, start, row));
    RUGA_TRY_DONE(expand_blocks(nodes, block, start, row, lower));
done:
    ruga_release(start);
    ruga_release(row);
    if (status != RUGA_OK) {
        ruga_sparse_clear(lower);
    }
    return status;
}
