// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "core/parallel.h"

#include "core/status.h"

#include <omp.h>

static int thread_count;

void ruga_set_threads(int count) {
    thread_count = count < 0 ? 0 : count;
}

int ruga_threads(void) {
    return thread_count ? thread_count : omp_get_num_procs();
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
