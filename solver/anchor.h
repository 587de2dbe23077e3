// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What keeps a skin without an interior from drifting.
#ifndef RUGA_SOLVER_ANCHOR_H
#define RUGA_SOLVER_ANCHOR_H

#include "solver/model.h"

// Adds to model->skin_handle, as a handle after the last one, components of the static skin that the handles
// leave free to move rigidly. RUGA_BAD_INPUT where nothing holds a part and the loads on it do not balance.
ruga_status ruga_model_anchor(ruga_model* model);

#endif
