// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What each of our two models says of a film on a bed: wavelength, onset and amplitudes.
#ifndef RUGA_APP_VALIDATE_FILM_ANSWER_H
#define RUGA_APP_VALIDATE_FILM_ANSWER_H

#include "app/validate/film.h"

enum { FILM_LEVELS = 2 };
static const double FILM_LEVEL[FILM_LEVELS] = {1.5, 2.5};

typedef struct film_answer {
    double wavelength;             // m
    double onset;                  // zero of the line fitted to amplitude^2 over 1.1 to 1.6 critical strains
    double amplitude[FILM_LEVELS]; // m, at FILM_LEVEL times that onset
    int minima, states;            // certified, of those computed
    double seconds;
} film_answer;

// The volume: wavelength and critical strain are those of the cell length of least load; *critical: that
// strain.
ruga_status film_answer_volume(const film_def* def, double* critical, film_answer* answer);

// The embedded shell on a prescribed interior, default coupling, `length` wavelengths by one, y of the skin
// held; its critical strains are Allen's, its wavelength that of the FFT at twice the critical strain.
ruga_status film_answer_shell(const film_def* def, double length, film_answer* answer);

#endif
