// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Sets are numbered by their first corner, so that numbers depend on the cut only. A vertex that nothing uses
// keeps its number and one copy.
#include "crease/copies.h"

#include "core/memory.h"
#include "lattice/union_find.h"

#include <string.h>

void ruga_copies_clear(ruga_copies* copies) {
    ruga_release(copies->vertex);
    ruga_release(copies->material);
    ruga_release(copies->parent);
    ruga_release(copies->node);
    ruga_release(copies->source);
    ruga_release(copies->copy_start);
    ruga_release(copies->copy);
    *copies = (ruga_copies){0};
}

ruga_status ruga_copies_create(int vertex_count, int slot_count, ruga_copies* copies) {
    ruga_status status = RUGA_OK;
    *copies = (ruga_copies){.vertex_count = vertex_count, .slot_count = slot_count};
    RUGA_TRY_DONE(RUGA_NEW(copies->vertex, slot_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(copies->material, slot_count));
    RUGA_TRY_DONE(RUGA_NEW(copies->parent, slot_count));
    ruga_sets_reset(copies->parent, slot_count);
done:
    if (status != RUGA_OK) {
        ruga_copies_clear(copies);
    }
    return status;
}

void ruga_copies_glue(ruga_copies* copies, int a, int b) {
    RUGA_ASSERT(copies->vertex[a] == copies->vertex[b]);
    ruga_sets_unite(copies->parent, a, b);
}

// Gives numbers to the sets of one kind, in the order of their roots. number [slots] is that of the root.
static void number_sets(ruga_copies* c, const bool* real, bool want_real, bool* taken, int* number) {
    for (int s = 0; s < c->slot_count; s++) {
        if (c->parent[s] != s || real[s] != want_real) {
            continue;
        }
        int v = c->vertex[s];
        if (want_real && !taken[v]) {
            taken[v] = true;
            number[s] = v;
        } else {
            number[s] = c->node_count++;
        }
    }
}

static ruga_status list_copies(ruga_copies* c) {
    RUGA_TRY(RUGA_NEW_ZERO(c->copy_start, (size_t)c->vertex_count + 1));
    RUGA_TRY(RUGA_NEW(c->copy, c->node_count));
    for (int n = 0; n < c->node_count; n++) {
        c->copy_start[c->source[n]]++;
    }
    for (int v = 0; v < c->vertex_count; v++) {
        c->copy_start[v + 1] += c->copy_start[v];
    }
    for (int n = c->node_count - 1; n >= 0; n--) {
        c->copy[--c->copy_start[c->source[n]]] = n;
    }
    return RUGA_OK;
}

ruga_status ruga_copies_number(ruga_copies* c) {
    ruga_status status = RUGA_OK;
    bool *real = NULL, *taken = NULL;
    int* number = NULL;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(real, c->slot_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(taken, c->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(number, c->slot_count));
    RUGA_TRY_DONE(RUGA_NEW(c->node, c->slot_count));
    for (int s = 0; s < c->slot_count; s++) {
        int root = ruga_sets_find(c->parent, s);
        real[root] = real[root] || c->material[s];
    }
    c->node_count = c->vertex_count;
    number_sets(c, real, true, taken, number);
    c->real_count = c->node_count;
    number_sets(c, real, false, taken, number);
    RUGA_TRY_DONE(RUGA_NEW(c->source, c->node_count));
    for (int v = 0; v < c->vertex_count; v++) {
        c->source[v] = v;
    }
    for (int s = 0; s < c->slot_count; s++) {
        c->node[s] = number[ruga_sets_find(c->parent, s)];
        c->source[c->node[s]] = c->vertex[s];
    }
    RUGA_TRY_DONE(list_copies(c));
done:
    ruga_release(real);
    ruga_release(taken);
    ruga_release(number);
    return status;
}
