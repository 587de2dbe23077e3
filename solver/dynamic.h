// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Cloth and free shells with creases in motion.
#ifndef RUGA_SOLVER_DYNAMIC_H
#define RUGA_SOLVER_DYNAMIC_H

#include "solver/elastic.h"
#include "solver/stitch.h"

typedef struct ruga_dynamic_def {
    ruga_elastic_def elastic;
    const bool* held;  // [nodes][3] or NULL: moved by the drive, or not at all. Of a vertex hold all copies
    double gravity[3]; // m/s^2
    double damping;    // s: viscous stress is this times the stiffness times the rate of strain
    double drag;       // 1/s: force over momentum
    double safety;     // part of the longest stable step that is taken, below 1
} ruga_dynamic_def;

// What changes with time. Both may be NULL.
typedef struct ruga_dynamic_drive {
    // Places of held components at a time; x [nodes][3] holds the present ones. Others are not looked at.
    void (*move)(void* context, double time, double* x);
    // Adds to force [nodes][3], N, at x; may set rest angles rest [segments], rad, of creases.
    void (*load)(void* context, double time, const double* x, double* force, double* rest);
    void* context;
} ruga_dynamic_drive;

typedef struct ruga_dynamic_report {
    int substeps;         // of the last try
    int halvings;         // tries that were given up
    int damping_products; // stages of the implicit part, in all
    double limit;         // s, longest stable step at the end
    double gap;           // m, at the end
    double kinetic;       // J
    ruga_elastic_energies elastic;
} ruga_dynamic_report;

typedef struct ruga_dynamic ruga_dynamic;

ruga_dynamic_def ruga_default_dynamic_def(void);
// RUGA_BAD_INPUT where a free node has no mass, or what ruga_sewing_create and ruga_stitch_create say.
ruga_status ruga_dynamic_create(const ruga_dynamic_def* def, ruga_dynamic** dynamic);
void ruga_dynamic_destroy(ruga_dynamic** dynamic);

// Sets the state to x [nodes][3] with its angles as they are; gaps are closed first. Then x is free of gaps,
// and so is v.
void ruga_dynamic_start(ruga_dynamic* dynamic, double* x, double* v);
// One step of dt from `time`, as it is: no look at stability.
void ruga_dynamic_step(ruga_dynamic* dynamic, const ruga_dynamic_drive* drive, double time, double dt,
                       double* x, double* v, ruga_dynamic_report* report);
// From `time` on for `duration`, in as many equal steps as are stable. RUGA_BAD_INPUT where even very many
// are not.
ruga_status ruga_dynamic_advance(ruga_dynamic* dynamic, const ruga_dynamic_drive* drive, double time,
                                 double duration, double* x, double* v, ruga_dynamic_report* report);

// Longest stable step at x, s, on the space that the sewing leaves: an estimate from below of the highest
// frequency, within some per cent. `effort` multiplications.
double ruga_dynamic_limit(ruga_dynamic* dynamic, const double* x, int effort);
const double* ruga_dynamic_mass(const ruga_dynamic* dynamic); // [nodes] kg
ruga_elastic* ruga_dynamic_elastic(ruga_dynamic* dynamic);
// Everything besides x and v that the next frame depends on.
int ruga_dynamic_memory_size(const ruga_dynamic* dynamic);
void ruga_dynamic_save(const ruga_dynamic* dynamic, double* memory);
void ruga_dynamic_load(ruga_dynamic* dynamic, const double* memory);

#endif
