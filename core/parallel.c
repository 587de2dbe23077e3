// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A pool of helper threads that takes chunks from one counter. The caller works too, and at the end waits
// only for helpers that are inside a chunk: one that the system has not woken up yet is not missed, so that
// on a busy machine a call costs about what it costs alone. (At the barriers of OpenMP every thread must
// arrive, which there takes a slice of the scheduler: measured at 20 to 50 times a triangular solve.)
#define _POSIX_C_SOURCE 200809L
#include "core/parallel.h"

#include "core/status.h"
#include "ruga/ruga.h"

#include <omp.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { MOST_HELPERS = 255, SPINS = 200 };

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

typedef struct job {
    ruga_parallel_body* body;
    void* context;
    int count, chunk_size, chunks;
} job;

// `call`: number of the call, which idle helpers watch. All but the two atomics is guarded by `lock`.
static struct pool {
    pthread_mutex_t user, lock; // user: held by the one caller at a time
    pthread_cond_t wake, left;
    int helpers, wanted; // threads that exist; how many may still join the open call
    int sleeping, inside;
    bool open;
    job job;
    atomic_uint call;
    atomic_int next;
} pool = {.user = PTHREAD_MUTEX_INITIALIZER,
          .lock = PTHREAD_MUTEX_INITIALIZER,
          .wake = PTHREAD_COND_INITIALIZER,
          .left = PTHREAD_COND_INITIALIZER};

static void run_chunk(const job* j, int c) {
    int begin = c * j->chunk_size;
    j->body(begin, j->count - begin < j->chunk_size ? j->count : begin + j->chunk_size, c, j->context);
}

static void take_chunks(const job* j) {
    for (int c = atomic_fetch_add(&pool.next, 1); c < j->chunks; c = atomic_fetch_add(&pool.next, 1)) {
        run_chunk(j, c);
    }
}

// Returns with the lock held, after a call newer than `seen`. Calls follow one another closely in a solve, so
// a helper looks about for some 100 us, leaving the core to whoever wants it, before it sleeps.
static unsigned await_call(unsigned seen) {
    for (int spin = 0; spin < SPINS && atomic_load(&pool.call) == seen; spin++) {
        (void)sched_yield();
    }
    pthread_mutex_lock(&pool.lock);
    pool.sleeping++;
    while (atomic_load(&pool.call) == seen) {
        pthread_cond_wait(&pool.wake, &pool.lock);
    }
    pool.sleeping--;
    return atomic_load(&pool.call);
}

static void* help(void* unused) {
    (void)unused;
    for (unsigned seen = 0;;) {
        seen = await_call(seen);
        if (pool.open && pool.wanted > 0) {
            pool.wanted--;
            pool.inside++;
            job j = pool.job;
            pthread_mutex_unlock(&pool.lock);
            take_chunks(&j);
            pthread_mutex_lock(&pool.lock);
            if (--pool.inside == 0) {
                pthread_cond_signal(&pool.left);
            }
        }
        pthread_mutex_unlock(&pool.lock);
    }
    return NULL;
}

// With fewer helpers than wanted, where the system gives no more, the work is done all the same.
static void start_helpers(int wanted) {
    pthread_attr_t attributes;
    if (wanted <= pool.helpers || pthread_attr_init(&attributes) != 0) {
        return;
    }
    (void)pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    pthread_t thread;
    while (pool.helpers < wanted && pthread_create(&thread, &attributes, help, NULL) == 0) {
        pool.helpers++;
    }
    (void)pthread_attr_destroy(&attributes);
}

static void open_call(const job* j, int helpers) {
    pthread_mutex_lock(&pool.lock);
    start_helpers(helpers < MOST_HELPERS ? helpers : MOST_HELPERS);
    pool.job = *j;
    pool.wanted = helpers;
    pool.open = true;
    atomic_store(&pool.next, 0);
    atomic_fetch_add(&pool.call, 1);
    if (pool.sleeping > 0) {
        pthread_cond_broadcast(&pool.wake);
    }
    pthread_mutex_unlock(&pool.lock);
}

static void close_call(void) {
    pthread_mutex_lock(&pool.lock);
    pool.open = false;
    for (int spin = 0; spin < SPINS && pool.inside > 0; spin++) {
        pthread_mutex_unlock(&pool.lock);
        (void)sched_yield();
        pthread_mutex_lock(&pool.lock);
    }
    while (pool.inside > 0) {
        pthread_cond_wait(&pool.left, &pool.lock);
    }
    pthread_mutex_unlock(&pool.lock);
}

void ruga_parallel_for(int count, int chunk_size, ruga_parallel_body* body, void* context) {
    RUGA_ASSERT(count >= 0 && chunk_size > 0);
    job j = {body, context, count, chunk_size, ruga_chunk_count(count, chunk_size)};
    int threads = ruga_threads() < j.chunks ? ruga_threads() : j.chunks;
    // The pool is taken where another thread uses it, or where this is a call from inside a chunk.
    if (threads <= 1 || pthread_mutex_trylock(&pool.user) != 0) {
        for (int c = 0; c < j.chunks; c++) {
            run_chunk(&j, c);
        }
        return;
    }
    open_call(&j, threads - 1);
    take_chunks(&j);
    close_call();
    pthread_mutex_unlock(&pool.user);
}
