// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Creases that come while a skin is simulated. Until then its model is another one: of the same sheet, mended
// for all creases, but cut along those only that are there. A model that is made has all of its creases; the
// models before it are its stages. Frames, whenever they are, show the material of the whole.
#ifndef RUGA_SOLVER_STAGES_H
#define RUGA_SOLVER_STAGES_H

#include "solver/model.h"
#include "solver/state.h"

// For ruga_model_create: finds where nodes and hinges of a model are in the one before it, and where it
// starts.
ruga_status ruga_stage_follow(ruga_model* model, const ruga_model* before);
// Lets go of what was not held before: it has moved.
void ruga_stage_release_holds(ruga_model* model, const ruga_model* before);
// Where the nodes and hinges of the whole are in each of its stages.
ruga_status ruga_stages_join(ruga_model* whole);

// The model of a stage, the whole being the last.
const ruga_model* ruga_stage_model(const ruga_model* whole, int stage);
// The stage that a frame is at: creases that come at it are not cut before the next step.
int ruga_stage_of_frame(const ruga_model* whole, int frame);

// to = what `from`, a state of the stage before, is when the creases of this stage are cut.
void ruga_stage_carry(const ruga_state* from, ruga_state* to);

#endif
