// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Around an inner vertex with 2 n creases at the angles a_1 < a_2 < ... the panels turn over at each:
//   a_1 - a_2 + a_3 - ... = +-pi (Kawasaki), and mountains - valleys = +-2 (Maekawa).
// Vertices on the border, on cuts, and without creases are free. Lines that are not folded do not count, and
// where a crease has no assignment, neither does Maekawa's condition.
#include "crease/flat.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double SLACK = 1e-4; // rad; drawings are not exact

typedef struct spoke {
    int vertex;
    double angle;
} spoke;

typedef struct corner {
    bool free;
    int valleys, unassigned, creases;
} corner;

static int compare_spokes(const void* a, const void* b) {
    const spoke *p = a, *q = b;
    if (p->vertex != q->vertex) {
        return p->vertex < q->vertex ? -1 : 1;
    }
    return (p->angle > q->angle) - (p->angle < q->angle);
}

static int collect(const ruga_crease_pattern* p, corner* at, spoke* list) {
    int count = 0;
    for (int e = 0; e < p->edge_count; e++) {
        ruga_assignment a = p->edge[e].assignment;
        for (int end = 0; end < 2; end++) {
            int v = p->edge[e].vertex[end];
            const double *x = p->position[v], *y = p->position[p->edge[e].vertex[1 - end]];
            at[v].free = at[v].free || p->edge[e].rim || a == RUGA_ASSIGNMENT_CUT;
            if (a == RUGA_ASSIGNMENT_MOUNTAIN || a == RUGA_ASSIGNMENT_VALLEY ||
                a == RUGA_ASSIGNMENT_UNASSIGNED) {
                at[v].creases++;
                at[v].valleys += a == RUGA_ASSIGNMENT_VALLEY;
                at[v].unassigned += a == RUGA_ASSIGNMENT_UNASSIGNED;
                list[count++] = (spoke){v, atan2(y[1] - x[1], y[0] - x[0])};
            }
        }
    }
    if (count > 1) {
        qsort(list, (size_t)count, sizeof *list, compare_spokes);
    }
    return count;
}

// COUNT = none.
static ruga_flat_fault_kind judge(const corner* at, const spoke* spoke, double* excess) {
    *excess = 0;
    if (at->creases == 1) {
        return RUGA_FLAT_ENDS;
    }
    if (at->creases % 2 == 1) {
        return RUGA_FLAT_ODD;
    }
    double sum = 0;
    for (int i = 0; i < at->creases; i++) {
        sum += i % 2 ? spoke[i].angle : -spoke[i].angle;
    }
    *excess = fabs(fabs(sum) - RUGA_PI);
    if (*excess > SLACK) {
        return at->creases == 2 ? RUGA_FLAT_BENDS : RUGA_FLAT_KAWASAKI;
    }
    int balance = at->creases - 2 * at->valleys;
    *excess = balance;
    return abs(balance) == 2 || at->unassigned > 0 ? RUGA_FLAT_KIND_COUNT : RUGA_FLAT_MAEKAWA;
}

ruga_status ruga_crease_pattern_flat_faults(const ruga_crease_pattern* p, int* count,
                                            ruga_flat_fault** fault) {
    ruga_status status = RUGA_OK;
    corner* at = NULL;
    spoke* list = NULL;
    *count = 0;
    *fault = NULL;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(at, p->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(list, 2 * (size_t)p->edge_count));
    RUGA_TRY_DONE(RUGA_NEW(*fault, p->vertex_count));
    int spokes = collect(p, at, list);
    for (int i = 0; i < spokes; i += at[list[i].vertex].creases) {
        int v = list[i].vertex;
        double excess;
        ruga_flat_fault_kind kind = at[v].free ? RUGA_FLAT_KIND_COUNT : judge(&at[v], &list[i], &excess);
        if (kind != RUGA_FLAT_KIND_COUNT) {
            (*fault)[(*count)++] = (ruga_flat_fault){v, kind, excess};
        }
    }
done:
    ruga_release(at);
    ruga_release(list);
    return status;
}

void ruga_flat_fault_say(const ruga_crease_pattern* pattern, const ruga_flat_fault* fault, char text[200]) {
    static const char* const what[RUGA_FLAT_KIND_COUNT] = {
        "a crease ends within the sheet", "a crease bends", "an odd number of creases meet",
        "every second angle does not add up to half a turn, the difference being",
        "mountains and valleys do not differ by 2, the difference being"};
    const double* x = pattern->position[fault->vertex];
    int length = snprintf(text, 200, "vertex %d at (%.6g, %.6g) cannot fold flat: %s", fault->vertex, x[0],
                          x[1], what[fault->kind]);
    if (fault->kind == RUGA_FLAT_KAWASAKI) {
        (void)snprintf(text + length, 200 - (size_t)length, " %.3g degrees", fault->excess * 180 / RUGA_PI);
    } else if (fault->kind == RUGA_FLAT_MAEKAWA) {
        (void)snprintf(text + length, 200 - (size_t)length, " %.0f", fault->excess);
    }
}
