// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Counting sort of items by their target.
#include "shell/gather.h"

#include "core/memory.h"

#include <string.h>

ruga_status ruga_gather_create(int target_count, int item_count, const int* target, ruga_gather* result) {
    RUGA_TRY(RUGA_NEW_ZERO(result->start, target_count + 1));
    int used = 0;
    for (int k = 0; k < item_count; k++) {
        if (target[k] >= 0) {
            result->start[target[k] + 1]++;
            used++;
        }
    }
    RUGA_TRY(RUGA_NEW(result->item, used));
    for (int t = 0; t < target_count; t++) {
        result->start[t + 1] += result->start[t];
    }
    // Filling moves each start to its end; shifting by one target afterwards puts them back.
    for (int k = 0; k < item_count; k++) {
        if (target[k] >= 0) {
            result->item[result->start[target[k]]++] = k;
        }
    }
    memmove(result->start + 1, result->start, (size_t)target_count * sizeof *result->start);
    result->start[0] = 0;
    return RUGA_OK;
}

void ruga_gather_clear(ruga_gather* g) {
    ruga_release(g->start);
    ruga_release(g->item);
}
