// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Work on all cores with the same bits for any number of threads: the split into chunks depends on the
// amount of work alone, never on the number of threads, and sums over chunks are made in chunk order.
#ifndef RUGA_CORE_PARALLEL_H
#define RUGA_CORE_PARALLEL_H

// Threads in use: what ruga_set_threads (ruga/ruga.h) said, or else RUGA_THREADS of the environment, or all
// cores. Never changes a result.
int ruga_threads(void);

// Calls body(begin, end, chunk, context) for consecutive ranges [begin, end) of at most `chunk_size` that
// cover [0, count), from several threads. The body must write only to places of its own range or chunk. A
// call from inside a chunk, or while another thread of the program is in one, does its work alone.
typedef void ruga_parallel_body(int begin, int end, int chunk, void* context);
void ruga_parallel_for(int count, int chunk_size, ruga_parallel_body* body, void* context);

// Number of chunks of the call above: the length of an array with one partial sum for each.
static inline int ruga_chunk_count(int count, int chunk_size) {
    return (count + chunk_size - 1) / chunk_size;
}

#endif
