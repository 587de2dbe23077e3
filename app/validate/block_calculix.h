// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A cantilever block computed by CalculiX (`ccx`, a peer to compare with): linear, C3D20.
#ifndef RUGA_APP_VALIDATE_BLOCK_CALCULIX_H
#define RUGA_APP_VALIDATE_BLOCK_CALCULIX_H

#include "app/validate/validation.h"

typedef struct block_def {
    double length, side;   // m
    double young, poisson; // Pa
    double force;          // N, across the free end, spread evenly over it
    int elements[2];       // along, and through each side
} block_def;

// Mean sinking of the end's nodes, m. ccx: its path; directory: for its files.
ruga_status block_sag(const char* ccx, const char* directory, const block_def* def, double* sag);

#endif
