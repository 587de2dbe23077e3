// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For each of some targets the items that add to it, ascending: sums in an order that no number of threads
// changes.
#ifndef RUGA_SHELL_GATHER_H
#define RUGA_SHELL_GATHER_H

#include "core/status.h"

typedef struct ruga_gather {
    int* start; // [targets + 1]
    int* item;
} ruga_gather;

// target[item] is -1 where an item adds to none.
ruga_status ruga_gather_create(int target_count, int item_count, const int* target, ruga_gather* gather);
void ruga_gather_clear(ruga_gather* gather);

#endif
