// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A stiff film bonded to a soft bed in plane strain, computed with the dense volume on a cell of half a
// wavelength between planes of symmetry. What theory, the embedded shell and other programs are compared
// with.
//
// The cell is [0, half] x [-depth, thickness]. Both sides move to (1 - strain) x and are free of shear, the
// bottom keeps its height and slides along with x, the top is free.
#ifndef RUGA_APP_VALIDATE_FILM_H
#define RUGA_APP_VALIDATE_FILM_H

#include "lattice/volume.h"
#include "ruga/types.h"

typedef struct film_def {
    double ratio, poisson; // E_x / E_q, and Poisson's ratio of both
    double young;          // of the bed, Pa
    double thickness;      // m
    double depth;          // of the bed, in wavelengths of eq. 3
    int degree;
    int cells;       // along the half wave
    int skin, below; // through the film and through the bed, graded
    ruga_volume_law law;
} film_def;

film_def film_default(void);
// The same with cells half as large in both directions.
film_def film_halved(const film_def* def);

double film_wavelength(const film_def* def); // eq. 3, m
double film_strain(const film_def* def);     // critical, by Allen's formula

// Strain at which the flat state of a cell ceases to be a minimum: to 1e-7 of itself.
ruga_status film_critical(const film_def* def, double half, double* strain);
// The wavelength, m, of the least critical strain, and that strain.
ruga_status film_onset(const film_def* def, double* wavelength, double* strain);

typedef struct film_point {
    double strain;
    double amplitude; // sqrt(2) rms of the height of the film's middle surface, m
    ruga_outcome outcome;
    double seconds;
    int iterations;
} film_point;

// Equilibria at the ascending strains of points [count], each from the one before.
ruga_status film_branch(const film_def* def, double half, int count, film_point* points);

// Zero of the line fitted to amplitude^2 over points with from <= strain <= to; 0 for fewer than two.
double film_fit(int count, const film_point* points, double from, double to);

#endif
