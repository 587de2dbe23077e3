// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Decompositions of 3 x 3 matrices, double[9] row by row, to about 1e-15 relative and the same bits every
// time.
#ifndef RUGA_LATTICE_SVD3_H
#define RUGA_LATTICE_SVD3_H

// f = u diag(s) v^T with det u = det v = +1 and s[0] >= s[1] >= |s[2]|: the smallest singular value carries
// the sign of det f (Irving, Teran and Fedkiw 2004). Any f: repeated, zero and negative values included.
// Values that agree to round-off keep the order of v's columns, so that noise does not choose between equal
// directions.
void ruga_svd3(const double f[9], double u[9], double s[3], double v[9]);

// a = vector diag(value) vector^T for a symmetric a; columns of `vector` are eigenvectors, in no special
// order.
void ruga_eigen3(const double a[9], double value[3], double vector[9]);

#endif
