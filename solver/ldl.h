// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Multifrontal LDL^T: the analysis (ldl_symbolic.c), one dense front (ldl_front.c), and what drives them
// (ldl.c: numeric factorisation; ldl_solve.c: solves). linear.h is the interface for others.
#ifndef RUGA_SOLVER_LDL_H
#define RUGA_SOLVER_LDL_H

#include "solver/ldl_panel.h"
#include "solver/ldl_symbolic.h"
#include "solver/linear.h"

#include <stdatomic.h>
#include <stddef.h>

// Tiles of columns of a front, and the blocks in which pivots are taken.
enum { RUGA_FRONT_TILE = 96, RUGA_FRONT_BLOCK = 64 };

// Update matrices [rows]^2 keep their lower triangle in tiles of columns, each without the rows above its
// first: column j has its row i at ruga_update_column(rows, j) + i. Half the memory of a square.
static inline size_t ruga_update_size(int rows) {
    size_t n = (size_t)rows, tiles = n / RUGA_FRONT_TILE, rest = n % RUGA_FRONT_TILE;
    return RUGA_FRONT_TILE * (tiles * n - RUGA_FRONT_TILE * tiles * (tiles - (tiles > 0)) / 2) + rest * rest;
}
static inline ptrdiff_t ruga_update_column(int rows, int column) {
    ptrdiff_t n = rows, k = column / RUGA_FRONT_TILE, first = k * RUGA_FRONT_TILE;
    ptrdiff_t tile = RUGA_FRONT_TILE * (k * n - RUGA_FRONT_TILE * k * (k - 1) / 2);
    return tile + (column - first) * (n - first) - first;
}

// Work space of a front: a tile of L D, or one for each where tiles are shared out.
static inline size_t ruga_front_work(bool shared, size_t full, size_t below) {
    size_t one = RUGA_FRONT_TILE * full, tiles = (below + RUGA_FRONT_TILE - 1) / RUGA_FRONT_TILE;
    size_t blocks = (full / RUGA_FRONT_TILE + 1) * RUGA_FRONT_TILE * RUGA_FRONT_BLOCK;
    size_t most = shared && tiles * one > one ? tiles * one : one;
    return shared && blocks > most ? blocks : most;
}
// All that a front takes on the stack while it is made: its update matrix, itself, pivots, peaks and work.
static inline size_t ruga_front_size(bool shared, size_t full, size_t below) {
    return ruga_update_size((int)below) + full * (full + below + 3) + ruga_front_work(shared, full, below);
}

// Where fronts are made, one for each thread at work: two stacks, from its two ends, fronts of odd depth on
// the far one, so that what a front hands on is made in its place while its children's are on top of the
// other. Per front, in double or float as the work is done: update of `below` rows, then (on the far stack
// before it) delayed [late][late + below], peak [late]. Between the stacks the front that is made. Capacities
// are in bytes.
typedef struct front_stack {
    void* memory;
    size_t capacity;
    atomic_flag taken;
} front_stack;

// Storage of a task. Places in it are kept as offsets, since it moves when delayed pivots make it grow.
typedef struct task_memory {
    void* factor; // double or float, per front: ruga_ldl_stored_size; a part of ruga_ldl's, or apart
    bool apart;
    size_t factor_used, factor_capacity;
    int* index; // per front: steps of its rows, pivots first
    size_t index_used, index_capacity;
    void* upward; // what its fronts hand on to those at the top, as on a front_stack
    size_t upward_used, upward_capacity;
    size_t stack_used[2], stack_peak; // of the front_stack that it works on, near and far
    int positive, negative, zero;
    double entries, flops;
    ruga_status status;
} task_memory;

// Consecutive steps in the rows of a front: from `step` on, and from `top` on among the steps of the top
// fronts, -1 = those of other fronts.
typedef struct row_run {
    int step, count, top;
} row_run;

typedef struct front_record {
    size_t factor, index, update; // offsets in its task's memory; `update` from its end of the stack
    size_t run;                   // first of its runs, of which own_runs are those of its pivots
    int task, rows, full, eliminated, runs, own_runs;
    bool far, upward; // handed on by the far stack; by `upward`
} front_record;

static inline size_t* ruga_ldl_used(task_memory* m, const front_record* r) {
    return r->upward ? &m->upward_used : &m->stack_used[r->far];
}

typedef struct ruga_ldl {
    ruga_ldl_symbolic symbolic;
    ruga_sparse matrix;  // the caller's pattern, with our values: S A S
    bool* last;          // [n] unknowns of multiplier nodes
    double* scale;       // [n] S
    int* child;          // [count] first child of a supernode, -1 = none
    int* sibling;        // [count]
    front_record* front; // [count]
    row_run* run;        // of all fronts
    size_t run_capacity;
    task_memory* memory; // [task_count + 1], the last one for the top
    void* factor;        // of all tasks, one after another, so that it stands in large pages
    size_t factor_bytes;
    front_stack* stack;  // [stack_count]
    int stack_count, stack_capacity;
    bool single; // L is stored in single precision
    bool planned, in_single, ready;
    int widest;             // rows of the largest front, in whole tiles
    double *load, *answer;  // [n] scaled, by unknown; by step
    double *defect, *guess; // [n] scaled, by unknown
    int* top_place;         // [n] number of a step that a top front eliminates, -1 = none
    int* top_step;          // [top_count] its inverse
    int top_count;
    int *level_front, *level_start; // top fronts by height above the tasks: level k from level_start[k] on
    int level_count;
    double* handed_up; // [task_count][top_count] what a task adds to those steps, by its forward pass
    double* gather;    // [tasks, or the most fronts of a level][widest]
    int gather_capacity;
} ruga_ldl;

// `lower` stays the caller's and must outlive the factor. The values given later must be finite.
ruga_status ruga_ldl_create(const ruga_sparse* lower, int node_count, const int* node_start, const bool* last,
                            bool single, ruga_ldl** ldl);
void ruga_ldl_destroy(ruga_ldl** ldl);
// What stays of the stack that has the children of s when these are taken off.
size_t ruga_ldl_below_children(const ruga_ldl* ldl, int s);
// Room for `count` elements of `size` bytes; what grows, grows by 3 % at least.
ruga_status ruga_ldl_make_room(void** memory, size_t* capacity, size_t count, size_t size);
// The same for L of a task.
ruga_status ruga_ldl_make_factor_room(const ruga_ldl* ldl, task_memory* m, size_t count);
// `in_single`: the work is done in single precision, where L is stored so.
ruga_status ruga_ldl_numeric(ruga_ldl* ldl, const double* values, bool in_single, ruga_factor_info* info);
ruga_status ruga_ldl_prove_inertia(ruga_ldl* ldl, bool* proven);
ruga_status ruga_ldl_solve(ruga_ldl* ldl, const double* b, double* x);
ruga_status ruga_ldl_solve_absolute(ruga_ldl* ldl, const double* b, double* x);
ruga_status ruga_ldl_solve_rough(ruga_ldl* ldl, const double* b, double* x);
size_t ruga_ldl_bytes(const ruga_ldl* ldl);

#endif
