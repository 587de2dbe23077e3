// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// psi(F) = mu |F - R|^2 + lambda/2 (J - 1)^2,   J = det F   (Stomakhin et al. 2012, eq. 1)
// P(F)   = 2 mu (F - R) + lambda (J - 1) cof F
//
// with R = U V^T from the signed SVD F = U diag(s) V^T, det U = det V = 1. Irving et al. 2006 use the rotated
// linear stress, which is not the gradient of any energy; this is its consistent form with the same behaviour
// at small strain and under inversion. mu |F - R|^2 is the minimum of mu |F - Q|^2 over all rotations Q,
// hence continuous; where R jumps (s1 + s2 = 0, below) the energy has a concave kink, and the P of either
// side is a direction along which it falls. In s the only stationary point is s = 1: an inverted point always
// finds back.
//
// dP/dF in the basis D_ij = u_i v_j^T (Smith, de Goes and Kim 2019, section 4), for k the third of i, j, k:
//   stretch, on the D_ii:    H_ii = 2 mu + lambda (J/s_i)^2,  H_ij = lambda (s_i s_j s_k^2 + (J - 1) s_k)
//   twist (D_ij - D_ji)/v2:  t = 2 mu + lambda (J - 1) s_k - 4 mu / (s_i + s_j)
//   flip  (D_ij + D_ji)/v2:  f = 2 mu - lambda (J - 1) s_k
// where J/s_i stands for the product of the other two. Only the twist has a pole, where the point is inverted
// along s2 so far that s2 = s1 or collapsed in two directions: s_i + s_j -> 0, t -> -infinity, the kink
// above. There s_i + s_j is taken as at least TWIST_MIN: the Hessian stays bounded (by 4 mu / TWIST_MIN),
// exact everywhere else, and with projection the bound is never seen, as t < 0 is set to 0 anyway.
#include "lattice/corotational.h"

#include "core/vec3.h"
#include "lattice/svd3.h"

#include <string.h>

static const double TWIST_MIN = 1e-6;

// What of the Hessian is not zero in the basis D.
typedef struct spectrum {
    double stretch[9];
    double same[3];  // [k] (t + f) / 2: D_ij with itself
    double cross[3]; // [k] (f - t) / 2: D_ij with D_ji
} spectrum;

static void clamp_stretch(double h[9]) {
    double value[3], vector[9];
    ruga_eigen3(h, value, vector);
    if (fmin(value[0], fmin(value[1], value[2])) >= 0) {
        return;
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            h[3 * i + j] = 0;
            for (int m = 0; m < 3; m++) {
                h[3 * i + j] += fmax(value[m], 0) * (vector[3 * i + m] * vector[3 * j + m]);
            }
        }
    }
}

static spectrum spectrum_at(double mu, double lambda, const double s[3], bool project) {
    spectrum a;
    double volume = s[0] * s[1] * s[2] - 1;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double twist = 2 * mu + lambda * volume * s[k] - 4 * mu / fmax(s[i] + s[j], TWIST_MIN);
        double flip = 2 * mu - lambda * volume * s[k];
        twist = project ? fmax(twist, 0) : twist;
        flip = project ? fmax(flip, 0) : flip;
        a.same[k] = 0.5 * (flip + twist);
        a.cross[k] = 0.5 * (flip - twist);
        a.stretch[4 * k] = 2 * mu + lambda * (s[i] * s[j]) * (s[i] * s[j]);
        a.stretch[3 * i + j] = a.stretch[3 * j + i] = lambda * s[k] * (s[k] * s[i] * s[j] + volume);
    }
    if (project) {
        clamp_stretch(a.stretch);
    }
    return a;
}

// hessian = sum over n of D_n (sum over m of C_nm D_m)^T, C the spectrum.
static void assemble(const spectrum* a, const double u[9], const double v[9], double hessian[81]) {
    double basis[9][9]; // [3 i + j] = u_i v_j^T
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            for (int n = 0; n < 9; n++) {
                basis[3 * i + j][n] = u[n / 3 * 3 + i] * v[n % 3 * 3 + j];
            }
        }
    }
    memset(hessian, 0, 81 * sizeof *hessian);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double image[9];
            for (int n = 0; n < 9; n++) {
                image[n] = i == j ? a->stretch[3 * i] * basis[0][n] + a->stretch[3 * i + 1] * basis[4][n] +
                                        a->stretch[3 * i + 2] * basis[8][n]
                                  : a->same[3 - i - j] * basis[3 * i + j][n] +
                                        a->cross[3 - i - j] * basis[3 * j + i][n];
            }
            for (int m = 0; m < 9; m++) {
                for (int n = 0; n < 9; n++) {
                    hessian[9 * m + n] += basis[3 * i + j][m] * image[n];
                }
            }
        }
    }
}

static void stress_at(double mu, double lambda, const double f[9], const double u[9], const double v[9],
                      double volume, double stress[9]) {
    for (int i = 0; i < 3; i++) {
        int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; j++) {
            int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            double rotation = u[3 * i] * v[3 * j] + u[3 * i + 1] * v[3 * j + 1] + u[3 * i + 2] * v[3 * j + 2];
            double cofactor = f[3 * i1 + j1] * f[3 * i2 + j2] - f[3 * i1 + j2] * f[3 * i2 + j1];
            stress[3 * i + j] = 2 * mu * (f[3 * i + j] - rotation) + lambda * volume * cofactor;
        }
    }
}

double ruga_corotational(double mu, double lambda, const double f[9], bool project, double* stress,
                         double* hessian) {
    double u[9], s[3], v[9];
    ruga_svd3(f, u, s, v);
    double volume = s[0] * s[1] * s[2] - 1;
    if (stress) {
        stress_at(mu, lambda, f, u, v, volume, stress);
    }
    if (hessian) {
        spectrum a = spectrum_at(mu, lambda, s, project);
        assemble(&a, u, v, hessian);
    }
    double stretch = 0;
    for (int i = 0; i < 3; i++) {
        stretch += (s[i] - 1) * (s[i] - 1);
    }
    return mu * stretch + 0.5 * lambda * volume * volume;
}
