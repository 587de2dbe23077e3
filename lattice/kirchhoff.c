// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
//   E = (F^T F - 1) / 2,   S = 2 mu E + lambda tr(E) 1,   psi = mu E:E + lambda/2 tr(E)^2,   P = F S
//   dP_ij / dF_kl = [i=k] S_lj + mu (F_il F_kj + [j=l] (F F^T)_ik) + lambda F_ij F_kl
#include "lattice/kirchhoff.h"

#include <stddef.h>

static void fill_hessian(double mu, double lambda, const double f[9], const double s[9], double* hessian) {
    for (int m = 0; m < 9; m++) {
        int i = m / 3, j = m % 3;
        for (int n = 0; n < 9; n++) {
            int k = n / 3, l = n % 3;
            double h = mu * f[3 * i + l] * f[3 * k + j] + lambda * f[m] * f[n];
            if (i == k) {
                h += s[3 * l + j];
            }
            if (j == l) {
                h += mu * (f[3 * i] * f[3 * k] + f[3 * i + 1] * f[3 * k + 1] + f[3 * i + 2] * f[3 * k + 2]);
            }
            hessian[9 * m + n] = h;
        }
    }
}

double ruga_kirchhoff(double mu, double lambda, const double f[9], double* stress, double* hessian) {
    double e[9], s[9], square = 0;
    for (int m = 0; m < 9; m++) {
        int i = m / 3, j = m % 3;
        e[m] = 0.5 * (f[i] * f[j] + f[3 + i] * f[3 + j] + f[6 + i] * f[6 + j] - (i == j));
        square += e[m] * e[m];
    }
    double trace = e[0] + e[4] + e[8];
    for (int m = 0; m < 9; m++) {
        s[m] = 2 * mu * e[m] + (m % 4 == 0 ? lambda * trace : 0);
    }
    for (int m = 0; stress && m < 9; m++) {
        int i = m / 3, j = m % 3;
        stress[m] = f[3 * i] * s[j] + f[3 * i + 1] * s[3 + j] + f[3 * i + 2] * s[6 + j];
    }
    if (hessian) {
        fill_hessian(mu, lambda, f, s, hessian);
    }
    return mu * square + 0.5 * lambda * trace * trace;
}
