// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What the hinges of creases do in the skin's static problem: their energy, the angles that are followed, and
// rest angles, which move with keyframes and with plastic flow.
#ifndef RUGA_SOLVER_HINGES_H
#define RUGA_SOLVER_HINGES_H

#include "solver/creases.h"

typedef struct ruga_hinges {
    const ruga_creases* creases;
    const ruga_sparse* pattern; // of the Hessian
    int count;                  // hinges of the creases, auxiliary chords last
    int segments;               // of folds
    double* near; // [count] rad, the angle at the state last accepted, followed through 180 degrees
    double* rest; // [count] rad, as in force
    double* from; // [segments] rad, rest angles at the beginning of a step
    double* goal; // [segments] rad, and at its end
    double* set;  // [segments] rad, plastic part of the rest angle
    double* flow; // [segments] rad, all plastic turning so far, either way
    int (*slot)[RUGA_HINGE_NODES *
                RUGA_HINGE_NODES]; // [count] of the first entry of a block, -1 = above the diagonal
    double* energy; // [count] work: of each hinge, its gradient, and Hessians of some at a time
    double (*gradient)[RUGA_HINGE_NODES][3];
    double (*hessian)[RUGA_HINGE_UNKNOWNS][RUGA_HINGE_UNKNOWNS];
} ruga_hinges;

ruga_status ruga_hinges_create(const ruga_creases* creases, const ruga_sparse* pattern, ruga_hinges** hinges);
void ruga_hinges_destroy(ruga_hinges** hinges);

// Energy in J of folds and of auxiliary chords at x [nodes][3]. The gradient is ADDED where not NULL;
// force_square likewise, with the squared nodal forces of single hinges.
void ruga_hinges_evaluate(ruga_hinges* hinges, const double* x, double* fold, double* chord,
                          double* gradient, double* force_square);
// ADDS the Hessian to the values of the pattern; clamp as in crease/hinge.h.
void ruga_hinges_add_hessian(ruga_hinges* hinges, const double* x, double clamp, double* value);
// Follows the angles to x.
void ruga_hinges_follow(ruga_hinges* hinges, const double* x);

// A step from the state as it stands to `time`: plastic flow over dt, then the rest angles' goals. Returns
// the number of parts that it should be made in, so that no rest angle moves more than 10 degrees in one.
int ruga_hinges_begin(ruga_hinges* hinges, double time, double dt);
// Puts the rest angles at this part, in [0, 1], of the step.
void ruga_hinges_advance(ruga_hinges* hinges, double part);

// State for a restart: near, rest, set, flow.
int ruga_hinges_restart_size(const ruga_creases* creases);
void ruga_hinges_save(const ruga_hinges* hinges, double* restart);
void ruga_hinges_load(ruga_hinges* hinges, const double* restart);

#endif
