// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Disjoint sets over 0 .. n - 1. The root of a set is always its smallest member, so that labels made from
// roots do not depend on the order of the unions.
#ifndef RUGA_LATTICE_UNION_FIND_H
#define RUGA_LATTICE_UNION_FIND_H

static inline void ruga_sets_reset(int* parent, int count) {
    for (int i = 0; i < count; i++) {
        parent[i] = i;
    }
}

static inline int ruga_sets_find(int* parent, int i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static inline void ruga_sets_unite(int* parent, int a, int b) {
    a = ruga_sets_find(parent, a);
    b = ruga_sets_find(parent, b);
    if (a < b) {
        parent[b] = a;
    } else {
        parent[a] = b;
    }
}

#endif
