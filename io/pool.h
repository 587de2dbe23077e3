// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Memory of many small pieces that is given back all at once, and text put together piece by piece.
#ifndef RUGA_IO_POOL_H
#define RUGA_IO_POOL_H

#include "core/status.h"

// Zero it to begin. Pieces stay where they are until ruga_pool_clear.
typedef struct ruga_pool {
    struct ruga_pool_chunk* chunk;
} ruga_pool;

// *piece = `count` zeroed elements of `size` bytes; `piece` is a T**.
ruga_status ruga_pool_take(ruga_pool* pool, size_t count, size_t size, void** piece);
#define RUGA_POOL_TAKE(pool, pointer, count)                                                                 \
    ruga_pool_take(pool, (size_t)(count), sizeof *(pointer), (void**)&(pointer))
// *copy = the first `length` bytes of text, ended by a zero.
ruga_status ruga_pool_copy(ruga_pool* pool, const char* text, size_t length, char** copy);
void ruga_pool_clear(ruga_pool* pool);

// Zero it to begin; `data` is NULL until something is added. Once an addition fails, so do all further ones.
typedef struct ruga_string {
    char* data;
    int length, capacity;
    bool failed;
} ruga_string;

void ruga_string_add(ruga_string* text, const char* format, ...) __attribute__((format(printf, 2, 3)));
void ruga_string_add_bytes(ruga_string* text, const char* bytes, size_t length);
// The shortest decimal that reads back as the same number.
void ruga_string_add_number(ruga_string* text, double value);
// RUGA_NO_MEMORY where an addition failed.
ruga_status ruga_string_status(const ruga_string* text);
void ruga_string_clear(ruga_string* text);

#endif
