// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Patkar, Jin and Fedkiw 2015, section 4. An embedded node at place t between the mesh vertices a and b, with
// copies that see it between the nodes (a_i, b_i), gives for i = 1 .. k - 1 the row
//   (1 - t) x_{a_0} + t x_{b_0} - (1 - t) x_{a_i} - t x_{b_i} = 0;
// where copies share an end, its weights cancel. Rows depend on others where a crease ends inside a triangle
// without having been led on to a vertex, and around some closed curves; a row without a free node is none. S
// is positive definite on the rows that are left. They are found by an up-looking LDL^T factorisation (Davis,
// Direct Methods for Sparse Linear Systems, 2006, section 4.9) of S for unit masses: eliminating what comes
// first leaves a dependent row a pivot of round-off. Its row and column are then skipped.
#include "crease/sewing.h"

#include "core/memory.h"

#include <string.h>

static const double DEPENDENT = 1e-12; // of the diagonal

void ruga_sewing_clear(ruga_sewing* sewing) {
    ruga_release(sewing->start);
    ruga_release(sewing->node);
    ruga_release(sewing->weight);
    ruga_release(sewing->bound);
    ruga_sparse_clear(&sewing->pattern);
    *sewing = (ruga_sewing){0};
}

// ------------------------------------------------------------------------------- rows

// Row of copy i of a bound; returns the number of entries that are left, at most 4.
static int make_row(const ruga_cut* cut, const ruga_bound* bound, int i, int node[4], double weight[4]) {
    int count = 0;
    for (int k = 0; k < 4; k++) {
        int n = cut->parent[bound->first + (k < 2 ? 0 : i)][k % 2];
        double w = k < 2 ? bound->weight[k % 2] : -bound->weight[k % 2];
        int same = -1;
        for (int j = 0; j < count; j++) {
            same = node[j] == n ? j : same;
        }
        if (same < 0) {
            node[count] = n;
            weight[count++] = w;
        } else { // a shared end: the same weight with the other sign
            count--;
            node[same] = node[count];
            weight[same] = weight[count];
        }
    }
    return count;
}

static bool all_fixed(const bool* fixed, int count, const int* node) {
    for (int k = 0; k < count; k++) {
        if (!fixed || !fixed[node[k]]) {
            return false;
        }
    }
    return true;
}

static ruga_status make_rows(const ruga_cut* cut, const bool* fixed, ruga_sewing* s) {
    size_t most = 0;
    for (int b = 0; b < cut->bound_count; b++) {
        most += (size_t)cut->bound[b].count - 1;
    }
    RUGA_TRY(RUGA_NEW(s->start, most + 1));
    RUGA_TRY(RUGA_NEW(s->bound, most));
    RUGA_TRY(RUGA_NEW(s->node, 4 * most));
    RUGA_TRY(RUGA_NEW(s->weight, 4 * most));
    s->start[0] = 0;
    for (int b = 0; b < cut->bound_count; b++) {
        for (int i = 1; i < cut->bound[b].count; i++) {
            int at = s->start[s->row_count];
            int count = make_row(cut, &cut->bound[b], i, s->node + at, s->weight + at);
            if (all_fixed(fixed, count, s->node + at)) {
                s->fixed_rows++;
                continue;
            }
            s->bound[s->row_count++] = b;
            s->start[s->row_count] = at + count;
        }
    }
    return RUGA_OK;
}

static void keep_rows(ruga_sewing* s, const bool* dependent) {
    int rows = 0, entries = 0;
    for (int r = 0; r < s->row_count; r++) {
        if (dependent[r]) {
            s->redundant_rows++;
            continue;
        }
        s->bound[rows++] = s->bound[r];
        int begin = s->start[r], end = s->start[r + 1]; // before start[] of a later row is written
        for (int k = begin; k < end; k++) {
            s->node[entries] = s->node[k];
            s->weight[entries++] = s->weight[k];
        }
        s->start[rows] = entries;
    }
    s->row_count = rows;
}

// ------------------------------------------------------------------------------- S

typedef struct node_rows {
    int* start; // [nodes + 1]
    int* row;
} node_rows;

// The rows at each free node, ascending.
static ruga_status list_rows(const ruga_sewing* s, const bool* fixed, node_rows* list) {
    RUGA_TRY(RUGA_NEW_ZERO(list->start, (size_t)s->node_count + 1));
    RUGA_TRY(RUGA_NEW(list->row, s->start[s->row_count]));
    for (int k = 0; k < s->start[s->row_count]; k++) {
        list->start[s->node[k]] += !(fixed && fixed[s->node[k]]);
    }
    for (int n = 0; n < s->node_count; n++) {
        list->start[n + 1] += list->start[n];
    }
    for (int r = s->row_count - 1; r >= 0; r--) {
        for (int k = s->start[r]; k < s->start[r + 1]; k++) {
            if (!(fixed && fixed[s->node[k]])) {
                list->row[--list->start[s->node[k]]] = r;
            }
        }
    }
    return RUGA_OK;
}

static ruga_status make_pattern(ruga_sewing* s, const bool* fixed) {
    ruga_status status = RUGA_OK;
    node_rows list = {0};
    int(*pair)[2] = NULL;
    int64_t count = 0, out = 0;
    ruga_sparse_clear(&s->pattern);
    RUGA_TRY_DONE(list_rows(s, fixed, &list));
    for (int n = 0; n < s->node_count; n++) {
        int64_t here = list.start[n + 1] - list.start[n];
        count += here * (here - 1) / 2;
    }
    RUGA_TRY_DONE(RUGA_NEW(pair, count));
    for (int n = 0; n < s->node_count; n++) {
        for (int i = list.start[n]; i < list.start[n + 1]; i++) {
            for (int j = i + 1; j < list.start[n + 1]; j++, out++) {
                pair[out][0] = list.row[i];
                pair[out][1] = list.row[j];
            }
        }
    }
    RUGA_TRY_DONE(ruga_sparse_from_pairs(s->row_count, 1, out, (const int(*)[2])pair, &s->pattern));
done:
    ruga_release(list.start);
    ruga_release(list.row);
    ruga_release(pair);
    return status;
}

void ruga_sewing_matrix(const ruga_sewing* s, const double* inverse_mass, double* value) {
    for (int column = 0; column < s->row_count; column++) {
        for (int p = s->pattern.start[column]; p < s->pattern.start[column + 1]; p++) {
            int row = s->pattern.index[p];
            double sum = 0;
            for (int i = s->start[row]; i < s->start[row + 1]; i++) {
                for (int j = s->start[column]; j < s->start[column + 1]; j++) {
                    sum +=
                        s->node[i] == s->node[j] ? inverse_mass[s->node[i]] * s->weight[i] * s->weight[j] : 0;
                }
            }
            value[p] = sum;
        }
    }
}

static ruga_status drop_redundant(ruga_sewing* s, const bool* fixed) {
    ruga_status status = RUGA_OK;
    bool* dependent = NULL;
    double* unit = NULL;
    ruga_seam_factor factor = {0};
    RUGA_TRY_DONE(RUGA_NEW(dependent, s->row_count));
    RUGA_TRY_DONE(RUGA_NEW(unit, s->node_count));
    for (int n = 0; n < s->node_count; n++) {
        unit[n] = fixed && fixed[n] ? 0 : 1;
    }
    ruga_sewing_matrix(s, unit, s->pattern.value);
    RUGA_TRY_DONE(ruga_seam_factor_create(&s->pattern, DEPENDENT, dependent, &factor));
    keep_rows(s, dependent);
    if (s->redundant_rows > 0) {
        RUGA_TRY_DONE(make_pattern(s, fixed));
    }
done:
    ruga_seam_factor_clear(&factor);
    ruga_release(dependent);
    ruga_release(unit);
    return status;
}

ruga_status ruga_sewing_create(const ruga_cut* cut, const bool* fixed, ruga_sewing* sewing) {
    ruga_status status = RUGA_OK;
    *sewing = (ruga_sewing){.node_count = cut->node_count};
    RUGA_TRY_DONE(make_rows(cut, fixed, sewing));
    RUGA_TRY_DONE(make_pattern(sewing, fixed));
    RUGA_TRY_DONE(drop_redundant(sewing, fixed));
done:
    if (status != RUGA_OK) {
        ruga_sewing_clear(sewing);
    }
    return status;
}

void ruga_sewing_gaps(const ruga_sewing* s, const double* x, double* gap) {
    for (int r = 0; r < s->row_count; r++) {
        double* g = gap + 3 * (size_t)r;
        g[0] = g[1] = g[2] = 0;
        for (int k = s->start[r]; k < s->start[r + 1]; k++) {
            const double* at = x + 3 * (size_t)s->node[k];
            for (int i = 0; i < 3; i++) {
                g[i] += s->weight[k] * at[i];
            }
        }
    }
}

void ruga_sewing_spread(const ruga_sewing* s, const double* inverse_mass, double factor,
                        const double* impulse, double* y) {
    for (int r = 0; r < s->row_count; r++) {
        const double* g = impulse + 3 * (size_t)r;
        for (int k = s->start[r]; k < s->start[r + 1]; k++) {
            double w = factor * s->weight[k] * (inverse_mass ? inverse_mass[s->node[k]] : 1);
            double* at = y + 3 * (size_t)s->node[k];
            for (int i = 0; i < 3; i++) {
                at[i] += w * g[i];
            }
        }
    }
}

// ------------------------------------------------------------------------------- dependent rows

typedef struct ldl {
    int n;
    const ruga_sparse* a;
    int *row_start, *row_column, *row_value; // entries left of the diagonal, by row; place in a->value
    int *parent, *flag, *count, *start, *pattern, *index;
    double *y, *d, *value;
} ldl;

static void ldl_clear(ldl* f) {
    ruga_release(f->row_start);
    ruga_release(f->row_column);
    ruga_release(f->row_value);
    ruga_release(f->parent);
    ruga_release(f->flag);
    ruga_release(f->count);
    ruga_release(f->start);
    ruga_release(f->pattern);
    ruga_release(f->index);
    ruga_release(f->y);
    ruga_release(f->d);
    ruga_release(f->value);
}

static ruga_status ldl_allocate(ldl* f) {
    size_t n = (size_t)f->n, entries = (size_t)f->a->start[f->n];
    RUGA_TRY(RUGA_NEW_ZERO(f->row_start, n + 1));
    RUGA_TRY(RUGA_NEW(f->row_column, entries));
    RUGA_TRY(RUGA_NEW(f->row_value, entries));
    RUGA_TRY(RUGA_NEW(f->parent, n));
    RUGA_TRY(RUGA_NEW(f->flag, n));
    RUGA_TRY(RUGA_NEW_ZERO(f->count, n));
    RUGA_TRY(RUGA_NEW(f->start, n + 1));
    RUGA_TRY(RUGA_NEW(f->pattern, n));
    RUGA_TRY(RUGA_NEW_ZERO(f->y, n));
    return RUGA_NEW(f->d, n);
}

static void ldl_list_rows(ldl* f) {
    const ruga_sparse* a = f->a;
    for (int j = 0; j < f->n; j++) {
        for (int p = a->start[j] + 1; p < a->start[j + 1]; p++) {
            f->row_start[a->index[p]]++;
        }
    }
    for (int i = 0; i < f->n; i++) {
        f->row_start[i + 1] += f->row_start[i];
    }
    for (int j = f->n - 1; j >= 0; j--) {
        for (int p = a->start[j + 1] - 1; p > a->start[j]; p--) {
            int at = --f->row_start[a->index[p]];
            f->row_column[at] = j;
            f->row_value[at] = p;
        }
    }
}

// Elimination tree and the number of entries in each column of L.
static ruga_status ldl_analyse(ldl* f) {
    for (int k = 0; k < f->n; k++) {
        f->parent[k] = -1;
        f->flag[k] = k;
        for (int p = f->row_start[k]; p < f->row_start[k + 1]; p++) {
            for (int i = f->row_column[p]; f->flag[i] != k; i = f->parent[i]) {
                f->parent[i] = f->parent[i] < 0 ? k : f->parent[i];
                f->count[i]++;
                f->flag[i] = k;
            }
        }
    }
    int64_t entries = 0;
    for (int k = 0; k < f->n; k++) {
        f->start[k] = (int)entries;
        entries += f->count[k];
        if (entries > INT32_MAX) {
            return ruga_fail(RUGA_NO_MEMORY, "the seams of %d rows are too entangled: use fewer creases",
                             f->n);
        }
    }
    f->start[f->n] = (int)entries;
    RUGA_TRY(RUGA_NEW(f->index, entries));
    return RUGA_NEW(f->value, entries);
}

// Columns that row k of L has entries in, in the order of elimination; returns where they begin in pattern[].
static int ldl_reach(ldl* f, int k) {
    int top = f->n;
    f->flag[k] = k;
    for (int p = f->row_start[k]; p < f->row_start[k + 1]; p++) {
        int length = 0, i = f->row_column[p];
        f->y[i] += f->a->value[f->row_value[p]];
        for (; f->flag[i] != k; i = f->parent[i]) {
            f->pattern[length++] = i;
            f->flag[i] = k;
        }
        while (length > 0) {
            f->pattern[--top] = f->pattern[--length];
        }
    }
    return top;
}

ruga_status ruga_seam_factor_create(const ruga_sparse* lower, double tolerance, bool* dependent,
                                    ruga_seam_factor* factor) {
    ruga_status status = RUGA_OK;
    ldl f = {.n = lower->columns, .a = lower};
    *factor = (ruga_seam_factor){0};
    RUGA_TRY_DONE(ldl_allocate(&f));
    ldl_list_rows(&f);
    RUGA_TRY_DONE(ldl_analyse(&f));
    memset(f.count, 0, (size_t)f.n * sizeof *f.count);
    for (int k = 0; k < f.n; k++) {
        f.flag[k] = -1;
    }
    for (int k = 0; k < f.n; k++) {
        double diagonal = lower->value[lower->start[k]];
        f.d[k] = diagonal;
        for (int top = ldl_reach(&f, k); top < f.n; top++) {
            int i = f.pattern[top], end = f.start[i] + f.count[i];
            double yi = dependent[i] ? 0 : f.y[i], l = dependent[i] ? 0 : yi / f.d[i];
            f.y[i] = 0;
            for (int p = f.start[i]; p < end; p++) {
                f.y[f.index[p]] -= f.value[p] * yi;
            }
            f.d[k] -= l * yi;
            f.index[end] = k;
            f.value[end] = l;
            f.count[i]++;
        }
        dependent[k] = !(f.d[k] > tolerance * diagonal);
    }
    *factor = (ruga_seam_factor){f.n, f.start, f.index, f.value, f.d};
    f.start = f.index = NULL;
    f.value = f.d = NULL;
done:
    ldl_clear(&f);
    return status;
}

void ruga_seam_factor_clear(ruga_seam_factor* factor) {
    ruga_release(factor->start);
    ruga_release(factor->index);
    ruga_release(factor->value);
    ruga_release(factor->pivot);
    *factor = (ruga_seam_factor){0};
}
