// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#ifdef __linux__
#define _GNU_SOURCE // madvise
#endif
#include "core/memory.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <limits.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

// Before each block: its size, in one cache line, so that blocks stay 64-byte aligned.
enum { HEADER = 64 };

// What is passed over again and again, as a factor is, waits for the tables of small pages more than for memory. So
// blocks of some large pages ask for them, but for their end: no page is filled for a part of it.
static void* allocate_default(size_t size, void* context) {
    enum { LARGE_PAGE = 1 << 21 };
    (void)context;
    size_t whole = (size + HEADER - 1) / HEADER * HEADER;
    void* block = aligned_alloc(size < 2 * (size_t)LARGE_PAGE ? HEADER : LARGE_PAGE, whole);
#ifdef MADV_HUGEPAGE
    if (block && size >= 2 * (size_t)LARGE_PAGE) {
        (void)madvise(block, size / LARGE_PAGE * LARGE_PAGE, MADV_HUGEPAGE); // it may be refused
    }
#endif
    return block;
}

static void free_default(void* memory, size_t size, void* context) {
    (void)size;
    (void)context;
    free(memory);
}

static ruga_allocate_function* allocate_function = allocate_default;
static ruga_free_function* free_function = free_default;
static void* allocator_context;
static atomic_size_t live_bytes;

void ruga_set_allocator(ruga_allocate_function* allocate, ruga_free_function* release, void* context) {
    allocate_function = allocate ? allocate : allocate_default;
    free_function = release ? release : free_default;
    allocator_context = context;
}

size_t ruga_byte_count(void) {
    return atomic_load(&live_bytes);
}

void* ruga_allocate(size_t size) {
    if (size > SIZE_MAX - 2 * (size_t)HEADER) {
        return NULL;
    }
    size_t* block = allocate_function(size + HEADER, allocator_context);
    if (!block) {
        return NULL;
    }
    block[0] = size;
    atomic_fetch_add(&live_bytes, size);
    return (char*)block + HEADER;
}

void* ruga_allocate_zero(size_t size) {
    void* memory = ruga_allocate(size);
    if (memory) {
        memset(memory, 0, size);
    }
    return memory;
}

static size_t* block_of(void* memory) {
    return (size_t*)(void*)((char*)memory - HEADER);
}

void ruga_release(void* memory) {
    if (!memory) {
        return;
    }
    size_t* block = block_of(memory);
    size_t size = block[0];
    atomic_fetch_sub(&live_bytes, size);
    free_function(block, size + HEADER, allocator_context);
}

void* ruga_reallocate(void* memory, size_t size) {
    void* fresh = ruga_allocate(size);
    if (fresh && memory) {
        size_t old = block_of(memory)[0];
        memcpy(fresh, memory, old < size ? old : size);
        ruga_release(memory);
    }
    return fresh;
}

char* ruga_copy_string(const char* text) {
    size_t size = strlen(text) + 1;
    char* copy = ruga_allocate(size);
    if (copy) {
        memcpy(copy, text, size);
    }
    return copy;
}

ruga_status ruga_allocate_checked(size_t count, size_t size, bool zero, void** memory) {
    *memory = NULL;
    if (count <= SIZE_MAX / size) {
        *memory = zero ? ruga_allocate_zero(count * size) : ruga_allocate(count * size);
    }
    return *memory ? RUGA_OK
                   : ruga_fail(RUGA_NO_MEMORY, "out of memory: %zu elements of %zu bytes", count, size);
}

ruga_status ruga_reserve(void** memory, int* capacity, size_t count, size_t size) {
    if (count <= (size_t)*capacity) {
        return RUGA_OK;
    }
    size_t wanted = count > 2 * (size_t)*capacity ? count : 2 * (size_t)*capacity;
    wanted = wanted < 16 ? 16 : wanted;
    void* grown = wanted <= INT_MAX ? ruga_reallocate(*memory, wanted * size) : NULL;
    if (!grown) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: %zu elements of %zu bytes", wanted, size);
    }
    *memory = grown;
    *capacity = (int)wanted;
    return RUGA_OK;
}
