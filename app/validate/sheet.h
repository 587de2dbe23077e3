// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A sheet on a box-filled lattice, compressed along its length: the case whose wavelength, onset and
// amplitude theory gives. Shared by the tests and the physics runs.
#ifndef RUGA_APP_VALIDATE_SHEET_H
#define RUGA_APP_VALIDATE_SHEET_H

#include "ruga/ruga.h"

typedef struct sheet_def {
    double ratio;                // E_x / E_q
    double poisson;              // of both
    double thickness;            // m
    double length, width, edges; // in wavelengths, and edges per wavelength
    int64_t seed;
    bool clusters, spectral, foundation, paper_rule, paper_method, newton, minres;
    bool coupled;         // quasistatic interior, ends held; otherwise prescribed
    double depth;         // in wavelengths, coupled only
    bool plane_strain;    // prescribed only: the skin's y is held, as in an endlessly wide sheet
    int cells;            // along the length; 0 = one per two wavelengths
    int count;            // strains
    const double* strain; // ascending, in critical strains
    double frame_limit;   // s of wall clock for a frame; 0 = none
    bool verbose;
} sheet_def;

typedef struct sheet_frame {
    double strain;        // applied
    double skin_strain;   // chord strain of the skin along its length, in the middle third of both directions
    double across_strain; // the same across its width
    double wavelength, wavelength_fft, amplitude;
    double middle_amplitude; // sqrt(2) rms of w over the same middle
    bool stopped;            // at frame_limit; the rest is of the state reached, and frames after it are zero
    ruga_report report;
} sheet_frame;

sheet_def sheet_default(void);
// Eq. 3 for the sheet, m.
double sheet_wavelength(const sheet_def* def);
// frames [count], zero where not reached; theory out: wavelength in m, critical strain, and the thickness in
// m.
ruga_status sheet_run(const sheet_def* def, sheet_frame* frames, double* wavelength, double* critical,
                      double* thickness);

// Zero of the line fitted to amplitude^2 over frames whose strain is in [1.1, 1.6] critical ones, as a
// multiple of the critical strain; 0 where fewer than two frames are. `own`: middle amplitude against the
// skin's own strain in the middle, of which `poisson` times the strain across counts as well (the load of a
// skin whose sides slip: the theory is of plane strain).
double sheet_onset(int count, const sheet_frame* frames, double critical, bool own, double poisson);

#endif
