// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Measured quantities of a frame, as docs/measure.md defines them.
#ifndef RUGA_APP_MEASURE_H
#define RUGA_APP_MEASURE_H

#include "constraints/clusters.h"
#include "mesh/connectivity.h"
#include "mesh/mesh.h"

typedef struct ruga_measure ruga_measure;

// `wavelength`: eq. 3, m; it sizes the clusters whose averages are the low-pass part. 0: none is taken out.
ruga_status ruga_measure_create(const ruga_mesh* mesh, double wavelength, int64_t seed,
                                ruga_measure** measure);
// The same with clusters of the local wavelengths [V], whose mean is `wavelength`; local NULL: as above.
ruga_status ruga_measure_create_local(const ruga_mesh* mesh, double wavelength, const double* local,
                                      int64_t seed, ruga_measure** measure);
void ruga_measure_destroy(ruga_measure** measure);

typedef struct ruga_measured {
    double wavelength;     // 2 pi sqrt(int w^2 / int |grad w|^2), m; 0 where w vanishes
    double wavelength_fft; // flat sheets only, otherwise 0, m
    double amplitude;      // sqrt(2) rms of w, m
    double volume;         // of the deformed mesh, m^3; NaN of an open one
} ruga_measured;

// position and embedded [V][3].
ruga_status ruga_measure_frame(ruga_measure* measure, const double* position, const double* embedded,
                               ruga_measured* measured);

// As above; `position` [V][3].
double ruga_measure_volume(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                           const double* position);

// w [V] of the last frame measured: normal displacement less its low-pass part, m.
const double* ruga_measure_displacement(const ruga_measure* measure);

#endif
