// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A free skin in motion: what joins a model, with its handles, loads and creases, to dynamic.h.
#ifndef RUGA_SOLVER_MOVING_H
#define RUGA_SOLVER_MOVING_H

#include "solver/dynamic.h"
#include "solver/model.h"
#include "solver/skin.h"

typedef struct ruga_moving ruga_moving;

// The skin's hinges, where it has any, are followed and yield as it moves.
ruga_status ruga_moving_create(const ruga_model* model, ruga_skin* skin, ruga_moving** moving);
void ruga_moving_destroy(ruga_moving** moving);
// The shape and, with its velocity, the motion that the model starts with; x [nodes][3] is SET.
ruga_status ruga_moving_start(ruga_moving* moving, double* x);
// x and the motion of one of the stage before, cut (stages.h); x and the skin's hinges hold what they are then.
void ruga_moving_carry(const ruga_moving* from, ruga_moving* moving, double* x);
// A frame, or a part of one, from `time` on.
ruga_status ruga_moving_step(ruga_moving* moving, double time, double duration, double* x,
                             ruga_report* report);
// Energies as they stand at x and `time`.
void ruga_moving_measure(ruga_moving* moving, double time, const double* x, ruga_report* report);

ruga_dynamic* ruga_moving_dynamic(ruga_moving* moving);
const double* ruga_moving_velocity(const ruga_moving* moving); // [nodes][3] m/s

// Everything besides x and the hinges that the next frame depends on: velocities among them.
int ruga_moving_restart_size(const ruga_model* model);
void ruga_moving_save(const ruga_moving* moving, double* restart);
void ruga_moving_load(ruga_moving* moving, const double* restart);

#endif
