// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "core/parallel.h"

#include "core/status.h"
#include "ruga/ruga.h"

#include <omp.h>
#include <stdlib.h>

static int thread_count;

void ruga_set_threads(int count) {
    thread_count = count < 0 ? 0 : count;
}

// Where nobody has said: the environment variable RUGA_THREADS, or all cores.
int ruga_threads(void) {
    if (thread_count == 0) {
        const char* wanted = getenv("RUGA_THREADS");
        int count = wanted ? atoi(wanted) : 0;
        thread_count = count > 0 ? count : omp_get_num_procs();
    }
    return thread_count;
}

void ruga_parallel_for(int count, int chunk_size, ruga_parallel_body* body, void* context) {
    RUGA_ASSERT(count >= 0 && chunk_size > 0);
    int chunks = ruga_chunk_count(count, chunk_size);
    int threads = ruga_threads() < chunks ? ruga_threads() : chunks;
    if (threads <= 1) {
        for (int c = 0; c < chunks; c++) {
            int end = count - c * chunk_size < chunk_size ? count : (c + 1) * chunk_size;
            body(c * chunk_size, end, c, context);
        }
        return;
    }
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
    for (int c = 0; c < chunks; c++) {
        int end = count - c * chunk_size < chunk_size ? count : (c + 1) * chunk_size;
        body(c * chunk_size, end, c, context);
    }
}
