// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The shape that a free skin has at time 0.
#ifndef RUGA_SOLVER_START_H
#define RUGA_SOLVER_START_H

#include "solver/hinges.h"
#include "solver/model.h"

// Folds and rolls the mesh of `model` as its start says: model->started is SET, NULL where it stays as it is.
// RUGA_BAD_INPUT where panels would have to bend.
ruga_status ruga_start_create(ruga_model* model);
// [V][3] m
const double* ruga_start_shape(const ruga_model* model);
// Hinges that are followed from there, through half a turn, and rest as they stand.
void ruga_start_hinges(const ruga_model* model, ruga_hinges* hinges);

#endif
