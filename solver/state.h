// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Everything of a simulation that changes, and what a later session needs to go on from it.
#ifndef RUGA_SOLVER_STATE_H
#define RUGA_SOLVER_STATE_H

#include "solver/interior.h"
#include "solver/moving.h"
#include "solver/skin.h"

struct ruga_state {
    const ruga_model* whole; // what it was created for
    int stage;               // of it (stages.h)
    const ruga_model* model; // of that stage: sizes below are of this one
    int frame;
    double time;
    double dt;        // s, of the part of a frame that is stepped
    double* x;        // [V][3] skin: with creases its nodes
    double* spread;   // [V of the whole][3] where creases come later: the same, at the nodes of the whole
    double *angle, *rest; // [segments of the whole] rad, likewise; NULL where none come later
    double* shown;    // [vertices shown][3] with creases; NULL = x
    double* shown_embedded;
    double* embedded; // [V][3] B q
    double* q;        // [N][3] lattice nodes
    double* v;        // [N][3] their velocities
    ruga_skin* skin;
    ruga_interior* interior;                        // NULL where prescribed or absent
    ruga_volume_solver* volume; // of the dense volume; NULL for a shell
    ruga_moving* moving;        // of a free skin in dynamic motion, NULL otherwise
    double* deviation;          // [N of the volume][3] m: displacement less that of the prescribed stretch
    double* displacement;       // [N of the volume][3] work
    double *old_q, *old_x, *next_embedded, *anchor; // work
    double* strain;                                 // [F] work: compressive strain of the embedded surface
    ruga_report start;                              // of frame 0
};

// A state of a stage of its model, as the skin starts, and what is shown of it once it has changed.
ruga_status ruga_state_make(const ruga_model* whole, int stage, ruga_state** state);
void ruga_state_show(ruga_state* state);
// Cuts the creases that come next.
ruga_status ruga_state_enter_next_stage(ruga_state* state);

// Restart vector: all that the next frame depends on besides the model.
int ruga_state_restart_size(const ruga_model* model);
void ruga_state_save(const ruga_state* state, double* restart);
ruga_status ruga_state_load(ruga_state* state, const double* restart);

// Angles [segments] rad as they are followed, and rest angles as in force, of the creases' segments; NULL without.
const double* ruga_state_crease_angles(const ruga_state* state);
const double* ruga_state_crease_rests(const ruga_state* state);
// Largest distance, m, between copies of one place.
double ruga_state_gap(const ruga_state* state);
// That at both ends of each of the creases' segments: gap [segments] is SET.
void ruga_state_segment_gaps(const ruga_state* state, double* gap);
// The forces of handles on the skin, [handles][3] N.
ruga_status ruga_state_handle_forces(ruga_state* state, double* force);

// Lattice node positions [N][3]; NULL without an interior.
const double* ruga_state_lattice(const ruga_state* state);

// Energies and residuals of the state as it stands; the outcome and the work are those of frame 0.
ruga_status ruga_state_measure(ruga_state* state, ruga_report* report);

#endif
