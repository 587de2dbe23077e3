// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Fixed corotational energy density at one point, with its exact derivatives.
#ifndef RUGA_LATTICE_COROTATIONAL_H
#define RUGA_LATTICE_COROTATIONAL_H

#include <stdbool.h>

// Energy density psi (J/m^3) at the deformation gradient f [3][3], with mu and lambda in Pa.
// stress [3][3]: P = d psi / dF. hessian [9][9]: dP_ij / dF_kl at (3 i + j, 3 k + l), exact, or with negative
// eigenvalues set to zero where `project`. stress and hessian may be NULL.
double ruga_corotational(double mu, double lambda, const double f[9], bool project, double* stress,
                         double* hessian);

#endif
