// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Our own seeded random numbers (splitmix64), the same on every machine.
#ifndef RUGA_CORE_RANDOM_H
#define RUGA_CORE_RANDOM_H

#include <stdint.h>

typedef struct ruga_random {
    uint64_t state;
} ruga_random;

static inline uint64_t ruga_random_next(ruga_random* random) {
    uint64_t z = (random->state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

// Uniform in [0, 1)
static inline double ruga_random_uniform(ruga_random* random) {
    return (double)(ruga_random_next(random) >> 11) * 0x1p-53;
}

#endif
