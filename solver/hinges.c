// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Plastic flow of a hinge. Its moment is k l (theta - theta0), theta0 = what the keys say + set. With a = all
// plastic turning so far, the excess e = |theta - theta0| - (yield + hardening a) makes the rest angle
// follow,
//   d set / dt = rate e sign(theta - theta0) where e > 0,   da/dt = |d set / dt|
// (linear viscoplasticity after Perzyna 1966). While theta stands still, de/dt = - rate (1 + hardening) e, so
// that over dt
//   |change of set| = e (1 - exp(-rate (1 + hardening) dt)) / (1 + hardening).
// It is taken at the beginning of a step with the angles that the last one ended with.
#include "solver/hinges.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

static const double MOST_AT_ONCE = 10 * RUGA_PI / 180; // rad
enum { BLOCKS = RUGA_HINGE_NODES * RUGA_HINGE_NODES, MOST_PARTS = 1000 };
enum { CHUNK = 32, BATCH = 512 }; // hinges: of a task; whose Hessians are held at a time, 1.3 MB

void ruga_hinges_destroy(ruga_hinges** hinges) {
    ruga_hinges* h = *hinges;
    if (!h) {
        return;
    }
    void* const owned[] = {h->near, h->rest, h->from,   h->goal,     h->set,
                           h->flow, h->slot, h->energy, h->gradient, h->hessian};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    ruga_release(h);
    *hinges = NULL;
}

static ruga_status fill(const ruga_creases* creases, const ruga_sparse* pattern, ruga_hinges* h) {
    RUGA_TRY(RUGA_NEW(h->near, h->count));
    RUGA_TRY(RUGA_NEW(h->rest, h->count));
    RUGA_TRY(RUGA_NEW(h->from, h->segments));
    RUGA_TRY(RUGA_NEW(h->goal, h->segments));
    RUGA_TRY(RUGA_NEW_ZERO(h->set, h->segments));
    RUGA_TRY(RUGA_NEW_ZERO(h->flow, h->segments));
    RUGA_TRY(RUGA_NEW(h->slot, h->count));
    RUGA_TRY(RUGA_NEW(h->energy, h->count));
    RUGA_TRY(RUGA_NEW(h->gradient, h->count));
    RUGA_TRY(RUGA_NEW(h->hessian, h->count < BATCH ? h->count : BATCH));
    memcpy(h->near, creases->drawn, (size_t)h->count * sizeof *h->near);
    memcpy(h->rest, creases->drawn, (size_t)h->count * sizeof *h->rest); // frame 0 is at rest as it is drawn
    for (int k = 0; k < h->count; k++) {
        const int* node = creases->hinge[k].node;
        for (int b = 0; b < BLOCKS; b++) {
            int row = node[b / RUGA_HINGE_NODES], column = node[b % RUGA_HINGE_NODES];
            h->slot[k][b] = row < column ? -1 : ruga_sparse_find(pattern, 3 * row, 3 * column);
            RUGA_ASSERT(row < column || h->slot[k][b] >= 0);
        }
    }
    return RUGA_OK;
}

ruga_status ruga_hinges_create(const ruga_creases* creases, const ruga_sparse* pattern,
                               ruga_hinges** hinges) {
    ruga_hinges* h = NULL;
    *hinges = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(h, 1));
    h->creases = creases;
    h->count = creases->hinge_count;
    h->segments = creases->segment_count;
    h->pattern = pattern;
    ruga_status status = fill(creases, pattern, h);
    if (status != RUGA_OK) {
        ruga_hinges_destroy(&h);
    }
    *hinges = h;
    return status;
}

// ---- energy --------------------------------------------------------------------------------------------

// Hinges are worked out side by side, and added up in their order.
typedef struct hinge_job {
    ruga_hinges* h;
    const double* x;
    int first; // of the Hessians that are at hand
    double clamp;
} hinge_job;

static void work_out_gradients(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const hinge_job* job = context;
    ruga_hinges* h = job->h;
    for (int k = begin; k < end; k++) {
        h->energy[k] = ruga_hinge_energy(&h->creases->hinge[k], h->creases->stiffness[k], h->rest[k], job->x,
                                         &h->near[k], 0, h->gradient[k], NULL);
    }
}

void ruga_hinges_evaluate(ruga_hinges* h, const double* x, double* fold, double* chord, double* gradient,
                          double* force_square) {
    hinge_job job = {.h = h, .x = x};
    ruga_parallel_for(h->count, CHUNK, work_out_gradients, &job);
    *fold = *chord = 0;
    for (int k = 0; k < h->count; k++) {
        *(k < h->segments ? fold : chord) += h->energy[k];
        for (int a = 0; a < RUGA_HINGE_NODES; a++) {
            *force_square += ruga_dot(h->gradient[k][a], h->gradient[k][a]);
            if (gradient) {
                ruga_add_scaled(1, h->gradient[k][a], gradient + 3 * (size_t)h->creases->hinge[k].node[a]);
            }
        }
    }
}

static void work_out_hessians(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const hinge_job* job = context;
    const ruga_hinges* h = job->h;
    for (int i = begin; i < end; i++) {
        int k = job->first + i;
        if (h->creases->stiffness[k] > 0) {
            (void)ruga_hinge_energy(&h->creases->hinge[k], h->creases->stiffness[k], h->rest[k], job->x,
                                    &h->near[k], job->clamp, NULL, h->hessian[i]);
        }
    }
}

static void add_blocks(const ruga_hinges* h, int k, double hessian[RUGA_HINGE_UNKNOWNS][RUGA_HINGE_UNKNOWNS],
                       double* value) {
    const int* node = h->creases->hinge[k].node;
    for (int b = 0; b < BLOCKS; b++) {
        int i = b / RUGA_HINGE_NODES, j = b % RUGA_HINGE_NODES, row = node[i], column = node[j];
        for (int c = 0; c < 3 && row >= column; c++) {
            // Column c of a block on the diagonal begins there: it lacks the first c entries.
            const int* start = h->pattern->start + 3 * (size_t)column;
            double* to = value + h->slot[k][b] + (start[c] - start[0]) - c;
            for (int r = row == column ? c : 0; r < 3; r++) {
                to[r] += hessian[3 * i + r][3 * j + c];
            }
        }
    }
}

void ruga_hinges_add_hessian(ruga_hinges* h, const double* x, double clamp, double* value) {
    hinge_job job = {.h = h, .x = x, .clamp = clamp};
    for (; job.first < h->count; job.first += BATCH) {
        int batch = h->count - job.first < BATCH ? h->count - job.first : BATCH;
        ruga_parallel_for(batch, CHUNK, work_out_hessians, &job);
        for (int i = 0; i < batch; i++) {
            if (h->creases->stiffness[job.first + i] > 0) {
                add_blocks(h, job.first + i, h->hessian[i], value);
            }
        }
    }
}

static void follow_angles(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const hinge_job* job = context;
    for (int k = begin; k < end; k++) {
        double* near = &job->h->near[k];
        *near = ruga_hinge_measure(&job->h->creases->hinge[k], job->x, near, NULL);
    }
}

void ruga_hinges_follow(ruga_hinges* h, const double* x) {
    hinge_job job = {.h = h, .x = x};
    ruga_parallel_for(h->count, CHUNK, follow_angles, &job);
}

// ---- rest angles ---------------------------------------------------------------------------------------

static void yield(ruga_hinges* h, int k, double dt) {
    const ruga_crease_law* law = &h->creases->law[ruga_crease_law_of(h->creases, k)];
    double off = h->near[k] - h->rest[k], excess = fabs(off) - (law->yield + law->hardening * h->flow[k]);
    if (!(excess > 0)) {
        return;
    }
    double move = -expm1(-law->rate * (1 + law->hardening) * dt) * excess / (1 + law->hardening);
    h->set[k] += copysign(move, off);
    h->flow[k] += move;
}

int ruga_hinges_begin(ruga_hinges* h, double time, double dt) {
    double most = 0;
    for (int k = 0; k < h->segments; k++) {
        yield(h, k, dt);
        h->from[k] = h->rest[k];
        h->goal[k] = ruga_crease_rest_at(h->creases, k, time) + h->set[k];
        most = fmax(most, fabs(h->goal[k] - h->from[k]));
    }
    return (int)fmin(fmax(ceil(most / MOST_AT_ONCE - 1e-9), 1), MOST_PARTS);
}

void ruga_hinges_advance(ruga_hinges* h, double part) {
    for (int k = 0; k < h->segments; k++) {
        h->rest[k] = part >= 1 ? h->goal[k] : h->from[k] + part * (h->goal[k] - h->from[k]);
    }
}

// ---- restart -------------------------------------------------------------------------------------------

int ruga_hinges_restart_size(const ruga_creases* creases) {
    return creases ? 2 * creases->hinge_count + 2 * creases->segment_count : 0;
}

void ruga_hinges_save(const ruga_hinges* h, double* restart) {
    memcpy(restart, h->near, (size_t)h->count * sizeof *restart);
    memcpy(restart += h->count, h->rest, (size_t)h->count * sizeof *restart);
    memcpy(restart += h->count, h->set, (size_t)h->segments * sizeof *restart);
    memcpy(restart + h->segments, h->flow, (size_t)h->segments * sizeof *restart);
}

void ruga_hinges_load(ruga_hinges* h, const double* restart) {
    memcpy(h->near, restart, (size_t)h->count * sizeof *restart);
    memcpy(h->rest, restart += h->count, (size_t)h->count * sizeof *restart);
    memcpy(h->set, restart += h->count, (size_t)h->segments * sizeof *restart);
    memcpy(h->flow, restart + h->segments, (size_t)h->segments * sizeof *restart);
}
