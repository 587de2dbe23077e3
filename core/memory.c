// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#define _GNU_SOURCE
#include <sys/mman.h>
#endif
#include "core/memory.h"

#include <limits.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

// Before each block: its size, in one cache line, so that blocks stay 64-byte aligned.
enum { HEADER = 64 };

// What is passed over again and again, as a factor is, waits for the tables of small pages more than for memory. So
// blocks of some large pages ask for them, but for their end: no page is filled for a part of it. They are mapped one by
// one, so that they go back to the system when they are freed.
enum { LARGE_PAGE = 1 << 21, LARGE_BLOCK = 2 * LARGE_PAGE };

#ifdef MADV_HUGEPAGE
static size_t in_large_pages(size_t size) {
    return (size + LARGE_PAGE - 1) / LARGE_PAGE * LARGE_PAGE;
}

static void* map_block(size_t size) {
    size_t whole = in_large_pages(size);
    char* map = mmap(NULL, whole + LARGE_PAGE, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (map == MAP_FAILED) {
        return NULL;
    }
    size_t before = in_large_pages((uintptr_t)map) - (uintptr_t)map;
    if (before > 0) {
        (void)munmap(map, before);
    }
    (void)munmap(map + before + whole, LARGE_PAGE - before);
    (void)madvise(map + before, size / LARGE_PAGE * LARGE_PAGE, MADV_HUGEPAGE); // it may be refused
    return map + before;
}
#endif

static void* allocate_default(size_t size, void* context) {
    (void)context;
#ifdef MADV_HUGEPAGE
    if (size >= LARGE_BLOCK) {
        return map_block(size);
    }
#endif
    return aligned_alloc(HEADER, (size + HEADER - 1) / HEADER * HEADER);
}

static void free_default(void* memory, size_t size, void* context) {
    (void)size;
    (void)context;
#ifdef MADV_HUGEPAGE
    if (size >= LARGE_BLOCK) {
        (void)munmap(memory, in_large_pages(size));
        return;
    }
#endif
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
