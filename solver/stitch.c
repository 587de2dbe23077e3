// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Patkar, Jin and Fedkiw 2015, section 4, after Weinstein, Teran and Fedkiw 2006. In a step
//   v += dt f / m;  v += M^-1 W S^-1 (-W^T v - W^T x / dt)   (equation 5, before)
//   x += dt v;      v += M^-1 W S^-1 (-W^T v)                (equation 3, after)
// The first alone keeps positions together, since W is constant; the second takes out the velocity with which
// a gap was closed. Impulses act in pairs at one place, so that both conserve momentum, and angular momentum
// where there is no gap: sum_ij (S^-1)_ij r_i x r_j = 0. Rows are the same for x, y and z: three solves with
// one factor.
//
// A row takes places of copies from those of others, two pairs at most, and neighbouring rows share a pair:
//   W^T = V J,  (J v)_k = v_a - v_b, the jump of pair k = (a, b).
// There are about as many pairs as rows, so that J meets half as many nodes as W does.
//
// Not for statics: projecting after an unconstrained Newton step ends in the point that is nearest in the
// metric of masses, which is not an equilibrium (equations 9 and 10 of the paper do that). There the rows
// belong in the system.
#include "solver/stitch.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "core/wide.h"

#include <stdlib.h>
#include <string.h>

static const double NOT_DEFINITE = 1e-13; // a pivot below this part of the diagonal

// Rows of a sparse matrix. Right sides have four numbers, of which the last is 0: one wide register.
typedef struct rows {
    int *start, *index; // [n + 1]
    double* value;
} rows;

struct ruga_stitch {
    const ruga_sewing* sewing;
    double* inverse_mass; // [nodes]
    ruga_seam_factor factor;
    rows lower; // L by row, without its diagonal
    int pair_count;
    int (*pair)[2];      // [pairs] nodes
    int (*term)[2];      // [rows] pairs of V; the second is the first, with weight 0, where there is one only
    double (*weight)[2]; // [rows]
    rows at_pair;        // V^T
    double (*jump)[4];   // [pairs]
    double (*gap)[4];    // [rows]
};

static void clear_rows(rows* r) {
    ruga_release(r->start);
    ruga_release(r->index);
    ruga_release(r->value);
}

void ruga_stitch_destroy(ruga_stitch** stitch) {
    if (!*stitch) {
        return;
    }
    ruga_release((*stitch)->inverse_mass);
    ruga_seam_factor_clear(&(*stitch)->factor);
    clear_rows(&(*stitch)->lower);
    ruga_release((*stitch)->pair);
    ruga_release((*stitch)->term);
    ruga_release((*stitch)->weight);
    clear_rows(&(*stitch)->at_pair);
    ruga_release((*stitch)->jump);
    ruga_release((*stitch)->gap);
    ruga_release(*stitch);
    *stitch = NULL;
}

// The transpose of columns [n + 1] starts, in the order of its rows.
static ruga_status transpose(int n, int columns, const int* start, const int* index, const double* value,
                             rows* r) {
    RUGA_TRY(RUGA_NEW_ZERO(r->start, (size_t)n + 2));
    RUGA_TRY(RUGA_NEW(r->index, start[columns]));
    RUGA_TRY(RUGA_NEW(r->value, start[columns]));
    int* end = r->start + 1; // where the next of a row goes; in the end its true place
    for (int p = 0; p < start[columns]; p++) {
        end[index[p] + 1]++;
    }
    for (int i = 0; i < n; i++) {
        end[i + 1] += end[i];
    }
    for (int j = 0; j < columns; j++) {
        for (int p = start[j]; p < start[j + 1]; p++) {
            int to = end[index[p]]++;
            r->index[to] = j;
            r->value[to] = value[p];
        }
    }
    return RUGA_OK;
}

static int compare_pairs(const void* a, const void* b) {
    const int *p = a, *q = b;
    return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0]) : (p[1] > q[1]) - (p[1] < q[1]);
}

// Rows have the weights (w, -w) or (v, w, -v, -w): copies of one vertex stand half a row apart.
static ruga_status list_pairs(ruga_stitch* s) {
    const ruga_sewing* sewing = s->sewing;
    ruga_status status = RUGA_OK;
    int(*own)[2] = NULL; // [rows][2]
    int* start = NULL;
    RUGA_TRY_DONE(RUGA_NEW(own, 2 * (size_t)sewing->row_count));
    RUGA_TRY_DONE(RUGA_NEW(start, (size_t)sewing->row_count + 1));
    for (int r = 0; r <= sewing->row_count; r++) {
        start[r] = 2 * r;
    }
    for (int r = 0; r < sewing->row_count; r++) {
        int half = (sewing->start[r + 1] - sewing->start[r]) / 2;
        for (int i = 0; i < 2; i++) {
            int at = sewing->start[r] + (i < half ? i : 0), a = sewing->node[at], b = sewing->node[at + half];
            own[2 * r + i][0] = a < b ? a : b;
            own[2 * r + i][1] = a < b ? b : a;
            s->weight[r][i] = i >= half ? 0 : a < b ? sewing->weight[at] : -sewing->weight[at];
        }
    }
    memcpy(s->pair, own, 2 * (size_t)sewing->row_count * sizeof *own);
    qsort(s->pair, 2 * (size_t)sewing->row_count, sizeof *s->pair, compare_pairs);
    for (int k = 0; k < 2 * sewing->row_count; k++) {
        if (s->pair_count == 0 || compare_pairs(s->pair[s->pair_count - 1], s->pair[k]) != 0) {
            memmove(s->pair[s->pair_count++], s->pair[k], sizeof *s->pair);
        }
    }
    for (int k = 0; k < 2 * sewing->row_count; k++) {
        const int* at = bsearch(own[k], s->pair, (size_t)s->pair_count, sizeof *s->pair, compare_pairs);
        s->term[k / 2][k % 2] = (int)((at - s->pair[0]) / 2);
    }
    status = transpose(s->pair_count, sewing->row_count, start, s->term[0], s->weight[0], &s->at_pair);
done:
    ruga_release(own);
    ruga_release(start);
    return status;
}

static ruga_status factorise(ruga_stitch* s) {
    const ruga_sparse* pattern = &s->sewing->pattern;
    ruga_sparse matrix = *pattern;
    bool* dependent = NULL;
    ruga_status status = RUGA_OK;
    matrix.value = NULL;
    RUGA_TRY_DONE(RUGA_NEW(matrix.value, pattern->start[pattern->columns]));
    RUGA_TRY_DONE(RUGA_NEW(dependent, s->sewing->row_count));
    ruga_sewing_matrix(s->sewing, s->inverse_mass, matrix.value);
    RUGA_TRY_DONE(ruga_seam_factor_create(&matrix, NOT_DEFINITE, dependent, &s->factor));
    for (int r = 0; r < s->sewing->row_count; r++) {
        if (dependent[r]) {
            status =
                ruga_fail(RUGA_BAD_INPUT,
                          "the seams of the creases hold one another twice: row %d of %d depends on others",
                          r, s->sewing->row_count);
            goto done;
        }
    }
done:
    ruga_release(matrix.value);
    ruga_release(dependent);
    return status;
}

ruga_status ruga_stitch_create(const ruga_sewing* sewing, const double* inverse_mass, ruga_stitch** stitch) {
    ruga_status status = RUGA_OK;
    ruga_stitch* s = NULL;
    *stitch = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(s, 1));
    s->sewing = sewing;
    RUGA_TRY_DONE(RUGA_NEW(s->inverse_mass, sewing->node_count));
    memcpy(s->inverse_mass, inverse_mass, (size_t)sewing->node_count * sizeof *inverse_mass);
    RUGA_TRY_DONE(RUGA_NEW(s->pair, 2 * (size_t)sewing->row_count));
    RUGA_TRY_DONE(RUGA_NEW(s->term, sewing->row_count));
    RUGA_TRY_DONE(RUGA_NEW(s->weight, sewing->row_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(s->jump, 2 * (size_t)sewing->row_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(s->gap, sewing->row_count));
    if (sewing->row_count > 0) {
        RUGA_TRY_DONE(list_pairs(s));
        RUGA_TRY_DONE(factorise(s));
        RUGA_TRY_DONE(transpose(s->factor.n, s->factor.n, s->factor.start, s->factor.index, s->factor.value,
                                &s->lower));
    }
    *stitch = s;
done:
    if (status != RUGA_OK) {
        ruga_stitch_destroy(&s);
    }
    return status;
}

// jump = J (y + rate x); without x, J y.
RUGA_WIDE static void measure(int pairs, const int (*pair)[2], const double* y, double rate, const double* x,
                              double (*restrict jump)[4]) {
    for (int k = 0; k < pairs; k++) {
        const double *a = y + 3 * (size_t)pair[k][0], *b = y + 3 * (size_t)pair[k][1];
        for (int i = 0; i < 3; i++) {
            jump[k][i] = a[i] - b[i];
        }
        if (x) {
            a = x + 3 * (size_t)pair[k][0];
            b = x + 3 * (size_t)pair[k][1];
            for (int i = 0; i < 3; i++) {
                jump[k][i] += rate * (a[i] - b[i]);
            }
        }
    }
}

// gap = S^-1 V jump, then jump = V^T gap.
RUGA_WIDE static void substitute(ruga_stitch* s) {
    const int rows = s->factor.n, pairs = s->pair_count;
    double(*restrict jump)[4] = s->jump, (*restrict gap)[4] = s->gap;
    for (int r = 0; r < rows; r++) {
        const double *a = jump[s->term[r][0]], *b = jump[s->term[r][1]];
        double x[4], v = s->weight[r][0], w = s->weight[r][1];
        for (int i = 0; i < 4; i++) {
            x[i] = v * a[i] + w * b[i];
        }
        for (int p = s->lower.start[r]; p < s->lower.start[r + 1]; p++) {
            const double l = s->lower.value[p], *from = gap[s->lower.index[p]];
            for (int i = 0; i < 4; i++) {
                x[i] -= l * from[i];
            }
        }
        for (int i = 0; i < 4; i++) {
            gap[r][i] = x[i];
        }
    }
    for (int r = rows - 1; r >= 0; r--) {
        double x[4], d = 1 / s->factor.pivot[r];
        for (int i = 0; i < 4; i++) {
            x[i] = d * gap[r][i];
        }
        for (int p = s->factor.start[r]; p < s->factor.start[r + 1]; p++) {
            const double l = s->factor.value[p], *from = gap[s->factor.index[p]];
            for (int i = 0; i < 4; i++) {
                x[i] -= l * from[i];
            }
        }
        for (int i = 0; i < 4; i++) {
            gap[r][i] = x[i];
        }
    }
    for (int k = 0; k < pairs; k++) {
        double x[4] = {0, 0, 0, 0};
        for (int p = s->at_pair.start[k]; p < s->at_pair.start[k + 1]; p++) {
            const double w = s->at_pair.value[p], *from = gap[s->at_pair.index[p]];
            for (int i = 0; i < 4; i++) {
                x[i] += w * from[i];
            }
        }
        for (int i = 0; i < 4; i++) {
            jump[k][i] = x[i];
        }
    }
}

// y -= M^-1 W S^-1 W^T (y + rate x)
static ruga_status project(ruga_stitch* s, double rate, const double* x, double* y) {
    measure(s->pair_count, (const int(*)[2])s->pair, y, rate, x, s->jump);
    substitute(s);
    for (int k = 0; k < s->pair_count; k++) {
        int a = s->pair[k][0], b = s->pair[k][1];
        ruga_add_scaled(-s->inverse_mass[a], s->jump[k], y + 3 * (size_t)a);
        ruga_add_scaled(s->inverse_mass[b], s->jump[k], y + 3 * (size_t)b);
    }
    return RUGA_OK;
}

ruga_status ruga_stitch_before(ruga_stitch* s, const double* x, double step, double* v) {
    return project(s, 1 / step, x, v);
}

ruga_status ruga_stitch_after(ruga_stitch* s, double* v) {
    return project(s, 0, NULL, v);
}

ruga_status ruga_stitch_close(ruga_stitch* s, double* x) {
    return project(s, 0, NULL, x);
}
