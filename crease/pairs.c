// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Patkar, Jin and Fedkiw 2015, section 6, figure 3 (d). With d the distance of a vertex from a straight
// crease folded by theta, its copies are 2 d |sin(theta / 2)| apart, so that springs of rest length 2 d
// sin(theta0 / 2) act on the crease with the stiffness (sum k d^2) cos^2(theta0 / 2).
#include "crease/pairs.h"

#include "core/memory.h"

#include <stdlib.h>

static ruga_pair pair_of(int a, int b, int curve) {
    return (ruga_pair){{a < b ? a : b, a < b ? b : a}, curve};
}

static int compare_pairs(const void* a, const void* b) {
    const ruga_pair *p = a, *q = b;
    if (p->curve != q->curve) {
        return p->curve < q->curve ? -1 : 1;
    }
    for (int i = 0; i < 2; i++) {
        if (p->node[i] != q->node[i]) {
            return p->node[i] < q->node[i] ? -1 : 1;
        }
    }
    return 0;
}

ruga_status ruga_pairs_create(const ruga_cut* cut, int* count, ruga_pair** pair) {
    *count = 0;
    *pair = NULL;
    ruga_pair* list = NULL;
    int found = 0;
    RUGA_TRY(RUGA_NEW(list, 3 * (size_t)cut->segment_count));
    for (int s = 0; s < cut->segment_count; s++) {
        const ruga_cut_piece* side[2] = {&cut->piece[cut->segment[s].piece[0]],
                                         &cut->piece[cut->segment[s].piece[1]]};
        // Chords have the same triangle on both sides; along mesh edges nothing is doubled.
        for (int i = 0; i < 3 && cut->segment[s].curve >= 0 && side[0]->triangle == side[1]->triangle; i++) {
            int a = side[0]->node[i], b = side[1]->node[i];
            if (a != b) {
                list[found++] = pair_of(a, b, cut->segment[s].curve);
            }
        }
    }
    if (found > 1) {
        qsort(list, (size_t)found, sizeof *list, compare_pairs);
    }
    for (int k = 0; k < found; k++) {
        if (k == 0 || compare_pairs(&list[k - 1], &list[k]) != 0) {
            list[(*count)++] = list[k];
        }
    }
    *pair = list;
    return RUGA_OK;
}

int ruga_pairs_find(int count, const ruga_pair* pair, int a, int b, int curve) {
    const ruga_pair key = pair_of(a, b, curve);
    const ruga_pair* at = bsearch(&key, pair, (size_t)count, sizeof *pair, compare_pairs);
    return at ? (int)(at - pair) : -1;
}
