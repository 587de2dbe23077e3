// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Errors, memory and version: what every other part of Ruga builds on.
#ifndef RUGA_BASE_H
#define RUGA_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(RUGA_STATIC)
#define RUGA_API
#else
#define RUGA_API __attribute__((visibility("default")))
#endif

#define RUGA_VERSION "0.1.0"

// Code and sentence of everything that can fail. ruga_last_error() has the full sentence: what is wrong,
// where, and what to do about it.
#define RUGA_STATUS_LIST(X)                                                                                  \
    X(RUGA_OK, "no error")                                                                                   \
    X(RUGA_BAD_INPUT, "the input is not valid")                                                              \
    X(RUGA_BAD_MESH, "the mesh cannot be simulated")                                                         \
    X(RUGA_NO_MEMORY, "out of memory")                                                                       \
    X(RUGA_IO, "a file could not be read or written")                                                        \
    X(RUGA_LIBRARY, "a library failed")                                                                      \
    X(RUGA_CANCELLED, "stopped on request")

#define RUGA_STATUS_ENUM(code, sentence) code,
typedef enum ruga_status { RUGA_STATUS_LIST(RUGA_STATUS_ENUM) RUGA_STATUS_COUNT } ruga_status;
#undef RUGA_STATUS_ENUM

// The general sentence of a status code.
RUGA_API const char* ruga_status_text(ruga_status status);

// The full sentence of the last failure in this thread; empty where there was none. Valid until the next
// failing call of the same thread.
RUGA_API const char* ruga_last_error(void);

// Replaces malloc and free. `allocate` may return NULL. Call before anything else allocates.
typedef void* ruga_allocate_function(size_t size, void* context);
typedef void ruga_free_function(void* memory, size_t size, void* context);
RUGA_API void ruga_set_allocator(ruga_allocate_function* allocate, ruga_free_function* release,
                                 void* context);

// Bytes now allocated by Ruga itself (not by the libraries it calls). Zero once everything is destroyed.
RUGA_API size_t ruga_byte_count(void);

// Called on misuse (a broken precondition) in place of abort(). Return value is ignored.
typedef void ruga_assert_function(const char* condition, const char* file, int line);
RUGA_API void ruga_set_assert_handler(ruga_assert_function* handler);

// "0.1.0"
RUGA_API const char* ruga_version(void);

#ifdef __cplusplus
}
#endif
#endif
