// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A few rows: modified Gram-Schmidt with pivoting. Many: Householder QR with column pivoting of the transpose
// (LAPACK's dgeqp3, which takes given columns first), for each set of rows that shares columns. It is dense:
// its cost grows with the cube of the nodes that a set's rows share. SuiteSparseQR, called with a fixed order
// and the same tolerance, found rank 41 in 256 rows of rank 40; why is not known, so it is not used.
#include "constraints/independent.h"

#include "core/memory.h"

#include <cblas.h>
#include <lapacke.h>

#include <math.h>
#include <string.h>

static double square(int width, const double* row) {
    double sum = 0;
    for (int c = 0; c < width; c++) {
        sum += row[c] * row[c];
    }
    return sum;
}

int ruga_independent_pick(int count, int width, double* a, double tolerance, int* picked) {
    int rank = 0;
    while (rank < count && rank < width) {
        int longest = -1;
        double most = tolerance * tolerance;
        for (int i = 0; i < count; i++) {
            double s = square(width, a + (size_t)i * (size_t)width);
            if (s > most) {
                longest = i;
                most = s;
            }
        }
        if (longest < 0) {
            break;
        }
        picked[rank++] = longest;
        double* pivot = a + (size_t)longest * (size_t)width;
        for (int i = 0; i < count; i++) {
            double *row = a + (size_t)i * (size_t)width, part = 0;
            for (int c = 0; c < width; c++) {
                part += pivot[c] * row[c];
            }
            for (int c = 0; c < width && i != longest; c++) {
                row[c] -= part / most * pivot[c];
            }
        }
        memset(pivot, 0, (size_t)width * sizeof *pivot);
    }
    return rank;
}

static int find_root(int* parent, int i) {
    while (parent[i] != i) {
        i = parent[i] = parent[parent[i]];
    }
    return i;
}

typedef struct row_set {
    int count, width, fixed;
    const int *start, *column;
    const double* value;
    double tolerance;
    bool* kept;
    int* parent; // [width] union-find over columns that rows tie together
    int* number; // [width] of a column in the set at hand, -1 = not in it
    int* first;  // [width] first row of the set with this root, -1 = none
    int* next;   // [count] next row of the same set, -1 = none
    int* list;   // [count] rows of the set at hand
} row_set;

// Lists the rows of each set, in order, by the root of their columns.
static void split(row_set* s) {
    for (int c = 0; c < s->width; c++) {
        s->parent[c] = c;
        s->number[c] = s->first[c] = -1;
    }
    for (int i = 0; i < s->count; i++) {
        for (int k = s->start[i] + 1; k < s->start[i + 1]; k++) {
            s->parent[find_root(s->parent, s->column[k])] = find_root(s->parent, s->column[k - 1]);
        }
    }
    for (int i = s->count - 1; i >= 0; i--) {
        s->next[i] = -1;
        if (s->start[i] < s->start[i + 1]) {
            int root = find_root(s->parent, s->column[s->start[i]]);
            s->next[i] = s->first[root];
            s->first[root] = i;
        }
    }
}

// Decides on the set at hand: the `rows` rows in s->list.
static ruga_status decide(row_set* s, int rows) {
    ruga_status status = RUGA_OK;
    int width = 0, fixed = 0;
    double *a = NULL, *scale = NULL;
    lapack_int* order = NULL;
    for (int j = 0; j < rows; j++) {
        for (int k = s->start[s->list[j]]; k < s->start[s->list[j] + 1]; k++) {
            int* number = &s->number[s->column[k]];
            *number = *number < 0 ? width++ : *number;
        }
    }
    int most = rows < width ? rows : width;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(a, (size_t)rows * (size_t)width));
    RUGA_TRY_DONE(RUGA_NEW(scale, most));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(order, rows));
    for (int j = 0; j < rows; j++) {
        int i = s->list[j];
        order[j] = i < s->fixed; // not 0: LAPACK takes it first
        fixed += i < s->fixed;
        for (int k = s->start[i]; k < s->start[i + 1]; k++) {
            a[(size_t)j * (size_t)width + (size_t)s->number[s->column[k]]] += s->value[k];
        }
    }
    if (LAPACKE_dgeqp3(LAPACK_COL_MAJOR, width, rows, a, width, order, scale) != 0) {
        status = ruga_fail(RUGA_NO_MEMORY, "out of memory while choosing among %d rows of handles", rows);
        goto done;
    }
    // Pivoting makes the remainders |R_kk| fall; order[] counts from 1.
    for (int k = 0; k < most && (k < fixed || fabs(a[(size_t)k * ((size_t)width + 1)]) > s->tolerance); k++) {
        s->kept[s->list[order[k] - 1]] = true;
    }
done:
    ruga_release(a);
    ruga_release(scale);
    ruga_release(order);
    return status;
}

static ruga_status decide_all(row_set* s) {
    RUGA_TRY(RUGA_NEW(s->parent, s->width));
    RUGA_TRY(RUGA_NEW(s->number, s->width));
    RUGA_TRY(RUGA_NEW(s->first, s->width));
    RUGA_TRY(RUGA_NEW(s->next, s->count));
    RUGA_TRY(RUGA_NEW(s->list, s->count));
    split(s);
    for (int root = 0; root < s->width; root++) {
        int rows = 0;
        for (int i = s->first[root]; i >= 0; i = s->next[i]) {
            s->list[rows++] = i;
        }
        if (rows) {
            RUGA_TRY(decide(s, rows));
        }
    }
    return RUGA_OK;
}

ruga_status ruga_independent_rows(int count, int width, int fixed, const int* start, const int* column,
                                  const double* value, double tolerance, bool* kept) {
    row_set s = {.count = count,
                 .width = width,
                 .fixed = fixed,
                 .start = start,
                 .column = column,
                 .value = value,
                 .tolerance = tolerance,
                 .kept = kept};
    memset(kept, 0, (size_t)count * sizeof *kept);
    // The bits of a BLAS result depend on the number of its threads.
    int threads = openblas_get_num_threads();
    openblas_set_num_threads(1);
    ruga_status status = decide_all(&s);
    openblas_set_num_threads(threads);
    ruga_release(s.parent);
    ruga_release(s.number);
    ruga_release(s.first);
    ruga_release(s.next);
    ruga_release(s.list);
    return status;
}
