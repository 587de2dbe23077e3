// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A piece and the pieces that it is cut into are parts of one triangle, and move as its corners say: where
// the corners of the parts' copies begin at those of the whole's, each place of the material begins where it
// was, at the velocity that it had. Masses in equal thirds (ruga_cut_masses) add up to those of the whole, so
// that momentum, angular momentum and kinetic energy are what they were. Copies that finer pieces share are
// shared by the coarser ones around them, which have more material in common: so one piece of those that hold
// a node tells where it comes from.
#include "crease/nest.h"

#include "core/memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct pair {
    int piece[2]; // ascending
    int segment;
} pair;

void ruga_nest_clear(ruga_nest* nest) {
    ruga_release(nest->node);
    ruga_release(nest->segment);
    *nest = (ruga_nest){0};
}

// Whether the border from one place on to another lies along an edge of the triangle.
static bool along_edge(int from, int to) {
    int steps = (to - from + RUGA_BORDER_PLACES) % RUGA_BORDER_PLACES;
    return steps + from % 2 <= 2;
}

// Whether a polygon lies within another one: on the left of each of its chords.
static bool lies_within(const ruga_outline* part, const ruga_outline* whole) {
    for (int i = 0; i < whole->count; i++) {
        int from = whole->place[i], to = whole->place[(i + 1) % whole->count];
        int left = (from - to + RUGA_BORDER_PLACES) % RUGA_BORDER_PLACES; // places from `to` on, around
        for (int k = 0; k < part->count && !along_edge(from, to); k++) {
            if ((part->place[k] - to + RUGA_BORDER_PLACES) % RUGA_BORDER_PLACES > left) {
                return false;
            }
        }
    }
    return true;
}

// piece [pieces of the finer]: both lists are by triangle. False where one lies within none.
static bool find_pieces(const ruga_cut* fine, const ruga_cut* coarse, int* piece) {
    for (int p = 0, first = 0; p < fine->piece_count; p++) {
        while (coarse->piece[first].triangle < fine->piece[p].triangle) {
            first++;
        }
        for (piece[p] = first; !lies_within(&fine->piece[p].polygon, &coarse->piece[piece[p]].polygon);) {
            if (++piece[p] == coarse->piece_count ||
                coarse->piece[piece[p]].triangle != fine->piece[p].triangle) {
                return false;
            }
        }
    }
    return true;
}

static int compare_pairs(const void* a, const void* b) {
    const pair *p = a, *q = b;
    int by = (p->piece[0] > q->piece[0]) - (p->piece[0] < q->piece[0]);
    return by != 0 ? by : (p->piece[1] > q->piece[1]) - (p->piece[1] < q->piece[1]);
}

static pair pair_of(int a, int b, int segment) {
    return (pair){{a < b ? a : b, a < b ? b : a}, segment};
}

static void find_segments(const ruga_cut* fine, const ruga_cut* coarse, const int* piece, pair* list,
                          int* segment) {
    for (int s = 0; s < coarse->segment_count; s++) {
        list[s] = pair_of(coarse->segment[s].piece[0], coarse->segment[s].piece[1], s);
    }
    qsort(list, (size_t)coarse->segment_count, sizeof *list, compare_pairs);
    for (int s = 0; s < fine->segment_count; s++) {
        pair wanted = pair_of(piece[fine->segment[s].piece[0]], piece[fine->segment[s].piece[1]], -1);
        const pair* found =
            bsearch(&wanted, list, (size_t)coarse->segment_count, sizeof *list, compare_pairs);
        segment[s] = found ? found->segment : -1;
    }
}

ruga_status ruga_nest_create(const ruga_cut* fine, const ruga_cut* coarse, ruga_nest* nest) {
    ruga_status status = RUGA_OK;
    int* piece = NULL;
    pair* list = NULL;
    *nest = (ruga_nest){0};
    RUGA_TRY_DONE(RUGA_NEW(nest->node, fine->node_count));
    RUGA_TRY_DONE(RUGA_NEW(nest->segment, fine->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(piece, fine->piece_count));
    RUGA_TRY_DONE(RUGA_NEW(list, coarse->segment_count));
    if (!find_pieces(fine, coarse, piece)) {
        status =
            ruga_fail(RUGA_BAD_INPUT, "the later creases divide triangles otherwise than the earlier ones");
        goto done;
    }
    memcpy(nest->node, fine->source,
           (size_t)fine->node_count * sizeof *nest->node); // of vertices without a face
    for (int p = 0; p < fine->piece_count; p++) {
        for (int i = 0; i < 3; i++) {
            nest->node[fine->piece[p].node[i]] = coarse->piece[piece[p]].node[i];
        }
    }
    find_segments(fine, coarse, piece, list, nest->segment);
done:
    ruga_release(piece);
    ruga_release(list);
    if (status != RUGA_OK) {
        ruga_nest_clear(nest);
    }
    return status;
}
