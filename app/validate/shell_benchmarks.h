// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Classical benchmarks of thin shells, each at a resolution, on a regular or an irregular mesh.
#ifndef RUGA_APP_VALIDATE_SHELL_BENCHMARKS_H
#define RUGA_APP_VALIDATE_SHELL_BENCHMARKS_H

#include "ruga/ruga.h"

typedef struct shell_run {
    int level; // elements per side
    bool irregular;
    ruga_bending bending;
    const char* picture; // where to draw what has one; NULL for nowhere
} shell_run;

enum { SHELL_VALUES = 6 };

typedef struct shell_benchmark {
    const char* name;
    const char* source;
    bool quick;   // takes seconds
    bool aligned; // only a regular mesh shows anything: recorded
    bool judged_on_both;
    const char* picture; // its caption; NULL without
    double tolerance;
    int value_count;
    const char* quantity[SHELL_VALUES];
    double reference[SHELL_VALUES];
    // *bad counts frames that did not end in a minimum.
    ruga_status (*run)(const shell_run* run, double value[SHELL_VALUES], int* bad);
} shell_benchmark;

extern const shell_benchmark shell_benchmarks[];
extern const int shell_benchmark_count;

#endif
