// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Whether a crease pattern can fold flat near each of its inner vertices.
#ifndef RUGA_CREASE_FLAT_H
#define RUGA_CREASE_FLAT_H

#include "crease/pattern.h"

typedef enum ruga_flat_fault_kind {
    RUGA_FLAT_ENDS,     // a single crease ends there
    RUGA_FLAT_BENDS,    // a single crease bends there, as curved ones do everywhere
    RUGA_FLAT_ODD,      // an odd number of creases meet
    RUGA_FLAT_KAWASAKI, // every second angle does not add up to half a turn
    RUGA_FLAT_MAEKAWA,  // mountains and valleys do not differ by two
    RUGA_FLAT_KIND_COUNT
} ruga_flat_fault_kind;

typedef struct ruga_flat_fault {
    int vertex;
    ruga_flat_fault_kind kind;
    double excess; // Kawasaki: rad; Maekawa: mountains less valleys; otherwise 0
} ruga_flat_fault;

// Of an arranged flat pattern, by vertex; *fault [*count] is the caller's to release. Both conditions are
// necessary, not sufficient: layers may still be in one another's way.
ruga_status ruga_crease_pattern_flat_faults(const ruga_crease_pattern* pattern, int* count,
                                            ruga_flat_fault** fault);
// A sentence on one of them.
void ruga_flat_fault_say(const ruga_crease_pattern* pattern, const ruga_flat_fault* fault, char text[200]);

#endif
