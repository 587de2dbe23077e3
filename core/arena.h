// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Scratch memory that is never freed piece by piece. An arena is passed BY VALUE: a function takes what it
// needs from its own copy, and on return the caller's arena stands where it stood.
#ifndef RUGA_CORE_ARENA_H
#define RUGA_CORE_ARENA_H

#include "core/status.h"

typedef struct ruga_arena {
    char* begin;
    char* end;
} ruga_arena;

// Bytes that taking `count` elements of `size` uses at most: to size an arena in create.
#define RUGA_ARENA_BYTES(count, size) (((size_t)(count) * (size) + 63) / 64 * 64)

// Takes count * size bytes, 64-byte aligned; misuse when the arena is too small.
static inline void* ruga_arena_take(ruga_arena* arena, size_t count, size_t size) {
    char* taken = arena->begin;
    size_t bytes = RUGA_ARENA_BYTES(count, size);
    RUGA_ASSERT(bytes <= (size_t)(arena->end - arena->begin));
    arena->begin += bytes;
    return taken;
}
#define RUGA_TAKE(arena, count, type) ((type*)ruga_arena_take(&(arena), (size_t)(count), sizeof(type)))

#endif
