// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "solver/vectors.h"

#include "core/parallel.h"
#include "core/wide.h"

#include <stddef.h>
#include <string.h>

// Entries of a piece, which stays in the first cache; chunks for threads, which are made of pieces.
enum { PIECE = 512, MOST_CHUNKS = 16, LEAST_CHUNK = 2048 };

typedef struct job {
    int n, count;
    const double* const* v;
    const double *w, *factor;
    double scale, *sum, (*part)[RUGA_MOST_VECTORS]; // part: by chunk
} job;

RUGA_WIDE static double dot_product(int n, const double* a, const double* b) {
    // Sixteen sums let the compiler use vector registers and hide their latency; their order is fixed.
    enum { SUMS = 16 };
    double s[SUMS] = {0};
    int i = 0;
    for (; i + SUMS <= n; i += SUMS) {
        for (int k = 0; k < SUMS; k++) {
            s[k] += a[i + k] * b[i + k];
        }
    }
    for (; i < n; i++) {
        s[0] += a[i] * b[i];
    }
    for (int half = SUMS / 2; half > 0; half /= 2) {
        for (int k = 0; k < half; k++) {
            s[k] += s[k + half];
        }
    }
    return s[0];
}

double ruga_dot_product(int n, const double* a, const double* b) {
    return dot_product(n, a, b);
}

static int chunk_size(int n) {
    int size = (n + MOST_CHUNKS - 1) / MOST_CHUNKS;
    size = size > LEAST_CHUNK ? size : LEAST_CHUNK;
    return (size + PIECE - 1) / PIECE * PIECE;
}

static void multiply(int begin, int end, int chunk, void* context) {
    const job* j = context;
    double* part = j->part[chunk];
    memset(part, 0, sizeof *j->part);
    for (int i = begin; i < end; i += PIECE) {
        int size = end - i < PIECE ? end - i : PIECE;
        for (int k = 0; k < j->count; k++) {
            part[k] += dot_product(size, j->v[k] + i, j->w + i);
        }
    }
}

void ruga_dot_products(int n, int count, const double* const* v, const double* w, double* product) {
    double part[MOST_CHUNKS][RUGA_MOST_VECTORS];
    job j = {.n = n, .count = count, .v = v, .w = w, .part = part};
    ruga_parallel_for(n, chunk_size(n), multiply, &j);
    memset(product, 0, (size_t)count * sizeof *product);
    for (int c = 0; c < ruga_chunk_count(n, chunk_size(n)); c++) {
        for (int k = 0; k < count; k++) {
            product[k] += part[c][k];
        }
    }
}

RUGA_WIDE static void add_scaled(int n, double a, const double* restrict x, double* restrict y) {
    for (int i = 0; i < n; i++) {
        y[i] += a * x[i];
    }
}

RUGA_WIDE static void scale_by(int n, double a, double* y) {
    for (int i = 0; i < n; i++) {
        y[i] *= a;
    }
}

static void add(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const job* j = context;
    for (int i = begin; i < end; i += PIECE) {
        int size = end - i < PIECE ? end - i : PIECE;
        if (j->sum != j->w) {
            memcpy(j->sum + i, j->w + i, (size_t)size * sizeof *j->sum);
        }
        for (int k = 0; k < j->count; k++) {
            add_scaled(size, j->factor[k], j->v[k] + i, j->sum + i);
        }
        if (j->scale != 1) {
            scale_by(size, j->scale, j->sum + i);
        }
    }
}

void ruga_add_vectors(int n, int count, const double* const* v, const double* factor, double scale,
                      const double* from, double* sum) {
    job j = {.n = n, .count = count, .v = v, .factor = factor, .scale = scale, .w = from, .sum = sum};
    ruga_parallel_for(n, chunk_size(n), add, &j);
}
