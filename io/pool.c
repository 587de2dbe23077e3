// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/pool.h"

#include "core/memory.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK_SIZE = 1 << 15, ALIGNMENT = 16 };

// Followed by its bytes.
struct ruga_pool_chunk {
    _Alignas(ALIGNMENT) struct ruga_pool_chunk* next;
    size_t used, size;
};

ruga_status ruga_pool_take(ruga_pool* pool, size_t count, size_t size, void** piece) {
    *piece = NULL;
    if (count > (SIZE_MAX / 2) / size) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: %zu elements of %zu bytes", count, size);
    }
    size_t bytes = (count * size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    struct ruga_pool_chunk* chunk = pool->chunk;
    if (!chunk || bytes > chunk->size - chunk->used) {
        size_t room = bytes > CHUNK_SIZE ? bytes : CHUNK_SIZE;
        chunk = ruga_allocate(sizeof *chunk + room);
        if (!chunk) {
            return ruga_fail(RUGA_NO_MEMORY, "out of memory: %zu bytes", room);
        }
        *chunk = (struct ruga_pool_chunk){.next = pool->chunk, .size = room};
        pool->chunk = chunk;
    }
    *piece = (char*)(chunk + 1) + chunk->used;
    chunk->used += bytes;
    memset(*piece, 0, bytes);
    return RUGA_OK;
}

ruga_status ruga_pool_copy(ruga_pool* pool, const char* text, size_t length, char** copy) {
    RUGA_TRY(RUGA_POOL_TAKE(pool, *copy, length + 1));
    memcpy(*copy, text, length);
    return RUGA_OK;
}

void ruga_pool_clear(ruga_pool* pool) {
    while (pool->chunk) {
        struct ruga_pool_chunk* next = pool->chunk->next;
        ruga_release(pool->chunk);
        pool->chunk = next;
    }
}

void ruga_string_add_bytes(ruga_string* text, const char* bytes, size_t length) {
    size_t needed = (size_t)text->length + length + 1;
    if (text->failed || needed > INT_MAX || RUGA_RESERVE(text->data, text->capacity, needed) != RUGA_OK) {
        text->failed = true;
        return;
    }
    memcpy(text->data + text->length, bytes, length);
    text->length += (int)length;
    text->data[text->length] = '\0';
}

void ruga_string_add(ruga_string* text, const char* format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    size_t needed = (size_t)text->length + (size_t)(length < 0 ? 0 : length) + 1;
    if (text->failed || length < 0 || needed > INT_MAX ||
        RUGA_RESERVE(text->data, text->capacity, needed) != RUGA_OK) {
        text->failed = true;
    } else {
        (void)vsnprintf(text->data + text->length, (size_t)length + 1, format, again);
        text->length += length;
    }
    va_end(again);
    va_end(arguments);
}

void ruga_string_add_number(ruga_string* text, double value) {
    char digits[40];
    for (int precision = 15; precision <= 17; precision++) {
        (void)snprintf(digits, sizeof digits, "%.*g", precision, value);
        if (strtod(digits, NULL) == value) {
            break;
        }
    }
    ruga_string_add(text, "%s", digits);
}

ruga_status ruga_string_status(const ruga_string* text) {
    return text->failed ? ruga_fail(RUGA_NO_MEMORY, "out of memory: a text of %d bytes", text->length)
                        : RUGA_OK;
}

void ruga_string_clear(ruga_string* text) {
    ruga_release(text->data);
    *text = (ruga_string){0};
}
