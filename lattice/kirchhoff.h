// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// St. Venant-Kirchhoff energy density at one point, with its exact derivatives: what other programs mean by a
// linear elastic material at large displacements.
#ifndef RUGA_LATTICE_KIRCHHOFF_H
#define RUGA_LATTICE_KIRCHHOFF_H

// As ruga_corotational (corotational.h), without projection.
double ruga_kirchhoff(double mu, double lambda, const double f[9], double* stress, double* hessian);

#endif
