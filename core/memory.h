// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// All of Ruga's heap memory. Sizes are kept, so that tests can prove that nothing leaks.
#ifndef RUGA_CORE_MEMORY_H
#define RUGA_CORE_MEMORY_H

#include "core/status.h"

// NULL when out of memory. Size 0 gives a valid pointer. 64-byte aligned.
void* ruga_allocate(size_t size);
void* ruga_allocate_zero(size_t size);
// Frees what ruga_allocate gave; NULL is fine.
void ruga_release(void* memory);
// Keeps the first min(old, new) bytes. On failure NULL is returned and `memory` stays valid.
void* ruga_reallocate(void* memory, size_t size);
// A copy of a string; NULL when out of memory.
char* ruga_copy_string(const char* text);

// *memory = ruga_allocate(size), or a status with a sentence. `memory` is a T**.
ruga_status ruga_allocate_checked(size_t count, size_t size, bool zero, void** memory);

// Allocates `count` elements into the pointer variable `pointer`: RUGA_TRY(RUGA_NEW(p, n)).
#define RUGA_NEW(pointer, count)                                                                             \
    ruga_allocate_checked((size_t)(count), sizeof *(pointer), false, (void**)&(pointer))
#define RUGA_NEW_ZERO(pointer, count)                                                                        \
    ruga_allocate_checked((size_t)(count), sizeof *(pointer), true, (void**)&(pointer))

// Makes room for at least `count` elements in a growing array with its `capacity` (int or size_t variable of
// type int): RUGA_TRY(RUGA_RESERVE(array, capacity, count)). Capacity at least doubles.
ruga_status ruga_reserve(void** memory, int* capacity, size_t count, size_t size);
#define RUGA_RESERVE(pointer, capacity, count)                                                               \
    ruga_reserve((void**)&(pointer), &(capacity), (size_t)(count), sizeof *(pointer))

#endif
