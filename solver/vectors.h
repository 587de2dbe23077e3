// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Products and sums of a few long vectors at once, each read a single time, on all cores: in chunks, whose sums
// are added in order, so that the bits are the same for any number of threads.
#ifndef RUGA_SOLVER_VECTORS_H
#define RUGA_SOLVER_VECTORS_H

enum { RUGA_MOST_VECTORS = 16 };

double ruga_dot_product(int n, const double* a, const double* b);

// product[k] = v[k] . w, k < count <= RUGA_MOST_VECTORS, all [n].
void ruga_dot_products(int n, int count, const double* const* v, const double* w, double* product);

// sum = scale * (from + the sum of factor[k] v[k], in this order); sum may be from.
void ruga_add_vectors(int n, int count, const double* const* v, const double* factor, double scale,
                      const double* from, double* sum);

#endif
