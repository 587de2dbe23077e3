// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The cell of film.h computed by CalculiX (`ccx`, a peer to compare with): input files written by us,
// quadratic elements of full integration (CPE8) on the grid of the film_def.
#ifndef RUGA_APP_VALIDATE_CALCULIX_H
#define RUGA_APP_VALIDATE_CALCULIX_H

#include "app/validate/film.h"
#include "app/validate/validation.h"

typedef struct calculix {
    char path[RUGA_VALIDATION_PATH];      // of ccx
    char directory[RUGA_VALIDATION_PATH]; // for its files
    double seconds;                       // spent so far
} calculix;

// Critical strain of a cell by *BUCKLE at a preload of 0.3 of Allen's strain.
ruga_status calculix_critical(calculix* c, const film_def* def, double half, double* strain);

// The wavelength of least critical strain, and that strain: by a parabola through the three best of seven
// lengths.
ruga_status calculix_onset(calculix* c, const film_def* def, double* wavelength, double* strain);

// Amplitudes of the perfect cell at the strains of points [count], in any order, each from the one before.
// The first is reached with the film pushed up, which is then let go. Outcomes are left alone: CalculiX does
// not say.
ruga_status calculix_branch(calculix* c, const film_def* def, double half, int count, film_point* points);

#endif
