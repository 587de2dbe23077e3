// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Memory that runs out: for tests that let the k-th allocation fail, k = 0, 1, 2 ... until there is success.
#ifndef RUGA_TESTS_SCARCE_MEMORY_H
#define RUGA_TESTS_SCARCE_MEMORY_H

#include "core/status.h"

#include <stdlib.h>

static int allocations_left;

static inline void* allocate_some(size_t size, void* context) {
    (void)context;
    return allocations_left-- > 0 ? aligned_alloc(64, (size + 63) / 64 * 64) : NULL;
}

static inline void free_some(void* memory, size_t size, void* context) {
    (void)size;
    (void)context;
    free(memory);
}

// From here on only so many allocations succeed; ruga_set_allocator(NULL, NULL, NULL) ends it.
static inline void let_allocations_fail_after(int count) {
    allocations_left = count;
    ruga_set_allocator(allocate_some, free_some, NULL);
}

#endif
