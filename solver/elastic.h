// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Elastic forces of a cut sheet and what damps them, as explicit steps need them: no Hessian.
#ifndef RUGA_SOLVER_ELASTIC_H
#define RUGA_SOLVER_ELASTIC_H

#include "crease/cloth.h"
#include "crease/hinge.h"
#include "shell/gather.h"
#include "shell/membrane.h"

typedef struct ruga_elastic_def {
    const ruga_raster* raster; // these two must outlive the result
    const ruga_cut* cut;
    ruga_skin_def skin; // model (shell or springs), thickness, young, poisson, density, membrane
    ruga_crease_style style;
    const double* stiffness; // [segments] N, of the creases
} ruga_elastic_def;

typedef struct ruga_elastic_energies {
    double membrane, bending; // J; all springs count as membrane
    double hinges; // creases of RUGA_CREASE_ANGLE
} ruga_elastic_energies;

typedef struct ruga_elastic {
    ruga_elastic_def def;
    int node_count;
    ruga_cloth cloth; // springs, where there are any
    int triangle_count;
    int (*triangle)[3];
    ruga_membrane_rest* membrane; // [triangles], times the fraction
    int bend_count;
    int (*bend)[4]; // as in ruga_hinge_angle
    double *bend_stiffness, *bend_rest;
    int hinge_count; // creases by angle and, with the shell, auxiliary chords
    ruga_hinge* hinge;
    int* segment;                   // [hinges] of the cut
    double* stiffness;              // [hinges] J
    double* rest;                   // [segments] rad; of creases the caller's, set by ruga_elastic_set_rest
    double* angle;                  // [segments] as followed through 180 degrees; of others than hinges 0
    ruga_gather at_triangle;        // node <- 3 triangle + corner
    ruga_gather at_bend;            // node <- 4 bend + corner
    ruga_gather at_hinge;           // node <- 6 hinge + corner
    double (*triangle_force)[3][3]; // the rest is work
    double (*bend_gradient)[4][3], *bend_moment;
    double (*hinge_gradient)[RUGA_HINGE_NODES][3], *hinge_moment;
    double (*partial)[2];
} ruga_elastic;

ruga_status ruga_elastic_create(const ruga_elastic_def* def, ruga_elastic* elastic);
void ruga_elastic_clear(ruga_elastic* elastic);
// rest [segments], rad; entries of auxiliary chords are not looked at.
void ruga_elastic_set_rest(ruga_elastic* elastic, const double* rest);
// Takes the angles of x as they are, in (-pi, pi]; afterwards they are followed from one force to the next.
void ruga_elastic_start(ruga_elastic* elastic, const double* x);
// force [nodes][3] is SET. The same bits for any number of threads.
void ruga_elastic_force(ruga_elastic* elastic, const double* x, double* force,
                        ruga_elastic_energies* energies);
// `time` (s) times the stiffness against strain rates at x, that of the last force, times v, is ADDED to out
// [nodes][3]: symmetric, positive semi-definite, without force or torque in sum, and 0 for rigid motion.
void ruga_elastic_damp(ruga_elastic* elastic, double time, const double* x, const double* v, double* out);

#endif
