// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For tests: small dense matrices, [n][n] row by row.
#ifndef RUGA_TESTS_DENSE_H
#define RUGA_TESTS_DENSE_H

#include "core/sparse.h"

#include <math.h>
#include <string.h>

// The full symmetric matrix of a lower triangle with the given values.
static inline void dense_from_lower(const ruga_sparse* lower, const double* value, double* full) {
    int n = lower->columns;
    memset(full, 0, (size_t)n * (size_t)n * sizeof *full);
    for (int j = 0; j < n; j++) {
        for (int p = lower->start[j]; p < lower->start[j + 1]; p++) {
            full[lower->index[p] * n + j] = full[j * n + lower->index[p]] = value[p];
        }
    }
}

// One rotation of Jacobi's method on rows and columns p and q.
static inline void dense_rotate(int n, double* a, int p, int q) {
    double ratio = (a[q * n + q] - a[p * n + p]) / (2 * a[p * n + q]);
    double t = copysign(1, ratio) / (fabs(ratio) + hypot(1, ratio)), c = 1 / sqrt(1 + t * t), s = t * c;
    for (int i = 0; i < n; i++) {
        double x = a[i * n + p], y = a[i * n + q];
        a[i * n + p] = c * x - s * y;
        a[i * n + q] = s * x + c * y;
    }
    for (int i = 0; i < n; i++) {
        double x = a[p * n + i], y = a[q * n + i];
        a[p * n + i] = c * x - s * y;
        a[q * n + i] = s * x + c * y;
    }
}

// Smallest and largest eigenvalue of a symmetric matrix, which is destroyed.
static inline void dense_eigenvalue_range(int n, double* a, double* smallest, double* largest) {
    for (int sweep = 0; sweep < 30; sweep++) {
        double off = 0, all = 0;
        for (int p = 0; p < n; p++) {
            for (int q = 0; q < n; q++) {
                off += p == q ? 0 : a[p * n + q] * a[p * n + q];
                all += a[p * n + q] * a[p * n + q];
            }
        }
        if (off <= 1e-30 * all) {
            break;
        }
        for (int p = 0; p < n; p++) {
            for (int q = p + 1; q < n; q++) {
                if (fabs(a[p * n + q]) > 1e-18 * sqrt(all)) {
                    dense_rotate(n, a, p, q);
                }
            }
        }
    }
    *smallest = *largest = a[0];
    for (int i = 1; i < n; i++) {
        *smallest = fmin(*smallest, a[i * n + i]);
        *largest = fmax(*largest, a[i * n + i]);
    }
}

// Solves a x = b for a symmetric positive definite a (destroyed); b becomes x.
static inline void dense_solve(int n, double* a, double* b) {
    for (int j = 0; j < n; j++) {
        for (int k = 0; k < j; k++) {
            for (int i = j; i < n; i++) {
                a[i * n + j] -= a[i * n + k] * a[j * n + k];
            }
        }
        double pivot = sqrt(a[j * n + j]);
        for (int i = j; i < n; i++) {
            a[i * n + j] /= pivot;
        }
    }
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++) {
            b[i] -= a[i * n + k] * b[k];
        }
        b[i] /= a[i * n + i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) {
            b[i] -= a[k * n + i] * b[k];
        }
        b[i] /= a[i * n + i];
    }
}

#endif
