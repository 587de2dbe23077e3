// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a run will cost, before it: from the sizes of a model alone, and in dynamic motion from its longest
// stable step.
#ifndef RUGA_APP_ESTIMATE_H
#define RUGA_APP_ESTIMATE_H

#include "solver/model.h"

typedef struct ruga_estimate {
    int64_t skin_unknowns, interior_unknowns,
        constraints; // 3 V, 3 N, 3 clusters and held rows of the interior
    double bytes;
    double seconds_per_frame; // one thread of a 2020s machine; within a factor of about three
} ruga_estimate;

// Fails where no state can be made of the model.
ruga_status ruga_estimate_model(const ruga_model* model, ruga_estimate* estimate);

#endif
