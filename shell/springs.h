// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Cloth of springs: each pulls two weighted means of nodes together, or apart.
#ifndef RUGA_SHELL_SPRINGS_H
#define RUGA_SHELL_SPRINGS_H

#include "core/status.h"

enum { RUGA_SPRING_WIDTHS = 3, RUGA_SPRING_MOST = 6 };
extern const int ruga_spring_width[RUGA_SPRING_WIDTHS]; // nodes of a spring: 2, 4, 6

typedef struct ruga_spring {
    int count, node[RUGA_SPRING_MOST];
    double weight[RUGA_SPRING_MOST]; // sum 0
    double stiffness, length;        // N/m, m at rest
    double scale;                    // of length and d to those that were given
    int label;                       // the caller's, -1 = none
} ruga_spring;

// Springs between as many nodes. Those of two nodes have the weights 1 and -1.
typedef struct ruga_spring_list {
    int first, count;  // number of the first among all springs
    int* node;         // [count][width]
    double* weight;    // [count][width]
    double* stiffness; // [count]
    double* length;    // [count]
    double* scale;     // [count]
    int* label;        // [count]
} ruga_spring_list;

typedef struct ruga_springs {
    int node_count, count, capacity;
    ruga_spring* spring; // until ruga_springs_finish
    ruga_spring_list list[RUGA_SPRING_WIDTHS];
    int* start;        // [nodes + 1]
    int* at;           // [start[nodes]] the springs of each node, ascending
    double* share;     // [start[nodes]] its weight in each
    double (*unit)[3]; // [count] direction of d at the last x
    double* pull;      // [count] N along it; work, as the rest
    double* partial;   // [chunks]
} ruga_springs;

// For d = sum of weight [count] times the places of node [count]; nodes that occur twice count together.
ruga_status ruga_springs_add(ruga_springs* springs, int count, const int* node, const double* weight,
                             double stiffness, double length, int label);
// No more are added. Those without a label between the same two nodes with the same rest length become one.
ruga_status ruga_springs_finish(ruga_springs* springs);
void ruga_springs_clear(ruga_springs* springs);

// Energy at x [nodes][3], J; force [nodes][3] is ADDED. The same bits for any number of threads.
double ruga_springs_force(ruga_springs* springs, const double* x, double* force);
// For the x of the last force: `time` (s) times the stiffness along the springs times v [nodes][3] is ADDED
// to out [nodes][3]; minus that is the damping force.
void ruga_springs_damp(ruga_springs* springs, double time, const double* v, double* out);

#endif
