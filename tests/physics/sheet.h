// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A sheet on a box-filled lattice, compressed along its length: the case whose wavelength, onset and amplitude
// theory gives. Shared by the tests and the physics runs.
#ifndef RUGA_TESTS_SHEET_H
#define RUGA_TESTS_SHEET_H

#include "ruga/ruga.h"

typedef struct sheet_def {
    double ratio;    // E_x / E_q
    double poisson;  // of both
    double length, width, edges; // in wavelengths, and edges per wavelength
    int64_t seed;
    bool clusters, foundation, paper_rule, paper_method, newton, minres;
    bool coupled;       // quasistatic interior, ends held; otherwise prescribed
    double depth;       // in wavelengths, coupled only
    int cells;          // along the length; 0 = one per two wavelengths
    int count;          // strains
    const double* strain; // ascending, in critical strains
    bool verbose;
} sheet_def;

typedef struct sheet_frame {
    double strain;       // applied
    double skin_strain;  // measured in the middle third of the skin, along its length (chord shortening removed by B)
    double wavelength, wavelength_fft, amplitude;
    ruga_report report;
} sheet_frame;

sheet_def sheet_default(void);
// frames [count]; theory: wavelength, critical strain and thickness out. Aborts the test with a message on failure.
ruga_status sheet_run(const sheet_def* def, sheet_frame* frames, double* wavelength, double* critical,
                      double* thickness);

#endif
