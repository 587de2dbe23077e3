// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Analysis for the multifrontal factorisation: what eliminates which unknowns in which order, for all values.
#ifndef RUGA_SOLVER_LDL_SYMBOLIC_H
#define RUGA_SOLVER_LDL_SYMBOLIC_H

#include "core/sparse.h"

#include <stdbool.h>
#include <stddef.h>

// Unknowns are numbered by their step of elimination. Supernode s eliminates steps [pivot[s], pivot[s + 1]),
// parents after children, each subtree contiguous. Its front holds these pivots and the rows below:
// row[row_start[s] .. row_start[s + 1]), ascending steps.
typedef struct ruga_ldl_symbolic {
    int n;
    int count;         // supernodes
    int* order;        // [n] unknown eliminated at a step
    int* pivot;        // [count + 1]
    int* parent;       // [count] -1 = root
    size_t* row_start; // [count + 1]
    int* row;          // steps
    int* place;        // like row: where in the parent's front
    int* run_end;      // like row: the end, from row_start, of the run of consecutive places it is in
    // Matrix entries of a front: value index and place in the front (row >= column, column a pivot).
    int* entry_start; // [count + 1]
    int* entry;       // [entries of the matrix]
    int* entry_row;
    int* entry_column;
    // Work shared out: task t < task_count has the supernodes [task[t], task[t + 1]) not marked `top`;
    // those marked are ancestors of several tasks and come after all of them, in ascending order.
    int task_count;
    int* task;    // [task_count + 1]
    int* by_work; // [task_count] tasks, those with most work first
    bool* top; // [count]
    double entries, flops;
} ruga_ldl_symbolic;

ruga_status ruga_ldl_analyse(const ruga_sparse* lower, int node_count, const int* node_start,
                             const bool* last, ruga_ldl_symbolic* symbolic);
void ruga_ldl_symbolic_clear(ruga_ldl_symbolic* symbolic);
size_t ruga_ldl_symbolic_bytes(const ruga_ldl_symbolic* symbolic);

#endif
