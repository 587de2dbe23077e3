// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The planar arrangement of a crease pattern. Everything nearer than `weld` is one place; what is left is
// farther apart than that, so that the signs of plain orientations decide crossings. In rounds, until nothing
// changes:
//   vertices within `weld` become the first of them; lines without length go; of lines with the same ends one
//   is kept, a border or a cut before others; lines are split at vertices that lie on them and at crossings.
// Pairs are found by sweeping along x. The faces are those of crease/faces.c.
#include "crease/faces.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "lattice/union_find.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ROUNDS = 16 };

typedef struct place {
    double x;
    int index;
} place;

typedef struct cut {
    int edge, vertex;
    double at; // from vertex[0] on, in lengths of the edge
} cut;

typedef struct arranger {
    ruga_crease_pattern* pattern;
    double weld;
    int cut_count, cut_capacity;
    cut* cut;
    int welded, dropped, doubled, crossings, touching; // repairs
} arranger;

static int compare_places(const void* a, const void* b) {
    const place *p = a, *q = b;
    return p->x < q->x ? -1 : p->x > q->x ? 1 : p->index < q->index ? -1 : p->index > q->index;
}

static int compare_cuts(const void* a, const void* b) {
    const cut *p = a, *q = b;
    if (p->edge != q->edge) {
        return p->edge < q->edge ? -1 : 1;
    }
    return p->at < q->at ? -1 : p->at > q->at ? 1 : p->vertex < q->vertex ? -1 : p->vertex > q->vertex;
}

static double distance(const double a[3], const double b[3]) {
    return hypot(a[0] - b[0], a[1] - b[1]);
}

// ------------------------------------------------------------------------------- vertices

static ruga_status sorted_vertices(const ruga_crease_pattern* p, place** sorted) {
    RUGA_TRY(RUGA_NEW(*sorted, p->vertex_count));
    for (int v = 0; v < p->vertex_count; v++) {
        (*sorted)[v] = (place){p->position[v][0], v};
    }
    if (p->vertex_count > 1) {
        qsort(*sorted, (size_t)p->vertex_count, sizeof **sorted, compare_places);
    }
    return RUGA_OK;
}

static ruga_status weld_vertices(arranger* a) {
    ruga_crease_pattern* p = a->pattern;
    ruga_status status = RUGA_OK;
    place* sorted = NULL;
    int* parent = NULL;
    RUGA_TRY_DONE(sorted_vertices(p, &sorted));
    RUGA_TRY_DONE(RUGA_NEW(parent, p->vertex_count));
    ruga_sets_reset(parent, p->vertex_count);
    for (int i = 0; i < p->vertex_count; i++) {
        for (int j = i - 1; j >= 0 && sorted[i].x - sorted[j].x <= a->weld; j--) {
            const double *x = p->position[sorted[i].index], *y = p->position[sorted[j].index];
            if (fabs(x[1] - y[1]) <= a->weld && distance(x, y) <= a->weld) {
                ruga_sets_unite(parent, sorted[i].index, sorted[j].index);
            }
        }
    }
    for (int e = 0; e < p->edge_count; e++) {
        for (int end = 0; end < 2; end++) {
            int root = ruga_sets_find(parent, p->edge[e].vertex[end]);
            a->welded += root != p->edge[e].vertex[end];
            p->edge[e].vertex[end] = root;
        }
    }
done:
    ruga_release(sorted);
    ruga_release(parent);
    return status;
}

// Drops vertices that no line uses and numbers the others anew, in their old order.
static ruga_status drop_unused(ruga_crease_pattern* p) {
    int *number = NULL, count = 0;
    RUGA_TRY(RUGA_NEW(number, p->vertex_count));
    memset(number, -1, (size_t)p->vertex_count * sizeof *number);
    for (int e = 0; e < p->edge_count; e++) {
        number[p->edge[e].vertex[0]] = number[p->edge[e].vertex[1]] = 0;
    }
    for (int v = 0; v < p->vertex_count; v++) {
        if (number[v] == 0) {
            memmove(p->position[count], p->position[v], sizeof *p->position);
            number[v] = count++;
        }
    }
    p->vertex_count = count;
    for (int e = 0; e < p->edge_count; e++) {
        p->edge[e].vertex[0] = number[p->edge[e].vertex[0]];
        p->edge[e].vertex[1] = number[p->edge[e].vertex[1]];
    }
    ruga_release(number);
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- lines

typedef struct sorted_edge {
    int low, high, index, rank;
} sorted_edge;

// What is kept of lines on top of one another: borders, then cuts, then folds, then the rest.
static int rank_of(ruga_assignment assignment) {
    static const int rank[RUGA_ASSIGNMENT_COUNT] = {0, 2, 2, 4, 3, 1};
    return rank[assignment];
}

static int compare_edges(const void* a, const void* b) {
    const sorted_edge *p = a, *q = b;
    const int keys[4][2] = {{p->low, q->low}, {p->high, q->high}, {p->rank, q->rank}, {p->index, q->index}};
    for (int i = 0; i < 4; i++) {
        if (keys[i][0] != keys[i][1]) {
            return keys[i][0] < keys[i][1] ? -1 : 1;
        }
    }
    return 0;
}

static ruga_status drop_doubles(arranger* a) {
    ruga_crease_pattern* p = a->pattern;
    sorted_edge* sorted = NULL;
    bool* keep = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(sorted, p->edge_count));
    RUGA_TRY_DONE(RUGA_NEW(keep, p->edge_count));
    for (int e = 0; e < p->edge_count; e++) {
        int s = p->edge[e].vertex[0], t = p->edge[e].vertex[1];
        sorted[e] = (sorted_edge){s < t ? s : t, s < t ? t : s, e, rank_of(p->edge[e].assignment)};
    }
    if (p->edge_count > 1) {
        qsort(sorted, (size_t)p->edge_count, sizeof *sorted, compare_edges);
    }
    for (int i = 0; i < p->edge_count; i++) {
        bool same = i > 0 && sorted[i].low == sorted[i - 1].low && sorted[i].high == sorted[i - 1].high;
        bool empty = sorted[i].low == sorted[i].high;
        keep[sorted[i].index] = !same && !empty;
        a->doubled += same && !empty;
        a->dropped += empty;
    }
    int count = 0;
    for (int e = 0; e < p->edge_count; e++) {
        if (keep[e]) {
            p->edge[count++] = p->edge[e];
        }
    }
    p->edge_count = count;
done:
    ruga_release(sorted);
    ruga_release(keep);
    return status;
}

// The box around a line.
typedef struct reach {
    double low[2], high[2];
    int index;
} reach;

static reach reach_of(const ruga_crease_pattern* p, int edge, double slack) {
    const double *s = p->position[p->edge[edge].vertex[0]], *t = p->position[p->edge[edge].vertex[1]];
    return (reach){{fmin(s[0], t[0]) - slack, fmin(s[1], t[1]) - slack},
                   {fmax(s[0], t[0]) + slack, fmax(s[1], t[1]) + slack},
                   edge};
}

static int compare_reaches(const void* a, const void* b) {
    const reach *p = a, *q = b;
    return p->low[0] < q->low[0]   ? -1
           : p->low[0] > q->low[0] ? 1
                                   : (p->index > q->index) - (p->index < q->index);
}

static ruga_status add_cut(arranger* a, int edge, int vertex, double at) {
    RUGA_TRY(RUGA_RESERVE(a->cut, a->cut_capacity, (size_t)a->cut_count + 1));
    a->cut[a->cut_count++] = (cut){edge, vertex, at};
    return RUGA_OK;
}

// Place of x along an edge, and its distance from it where that place is within.
static double along_edge(const ruga_crease_pattern* p, int e, const double x[3], double* off) {
    const double *s = p->position[p->edge[e].vertex[0]], *t = p->position[p->edge[e].vertex[1]];
    double dx = t[0] - s[0], dy = t[1] - s[1], square = dx * dx + dy * dy;
    *off = fabs(dx * (x[1] - s[1]) - dy * (x[0] - s[0])) / sqrt(square);
    return (dx * (x[0] - s[0]) + dy * (x[1] - s[1])) / square;
}

static ruga_status cut_at_vertices(arranger* a) {
    ruga_crease_pattern* p = a->pattern;
    place* sorted = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(sorted_vertices(p, &sorted));
    for (int e = 0; e < p->edge_count; e++) {
        const int* end = p->edge[e].vertex;
        const reach r = reach_of(p, e, a->weld);
        int first = 0;
        for (int end_of = p->vertex_count; first < end_of;) {
            int middle = first + (end_of - first) / 2;
            if (sorted[middle].x < r.low[0]) {
                first = middle + 1;
            } else {
                end_of = middle;
            }
        }
        for (int i = first; i < p->vertex_count && sorted[i].x <= r.high[0]; i++) {
            int v = sorted[i].index;
            double y = p->position[v][1], off = INFINITY;
            bool beside = v == end[0] || v == end[1] || y < r.low[1] || y > r.high[1];
            double at = beside ? 0 : along_edge(p, e, p->position[v], &off);
            if (at > 0 && at < 1 && off <= a->weld) {
                RUGA_TRY_DONE(add_cut(a, e, v, at));
                a->touching++;
            }
        }
    }
done:
    ruga_release(sorted);
    return status;
}

static double side(const double a[3], const double b[3], const double c[3]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static ruga_status cut_pair(arranger* a, int e, int f) {
    ruga_crease_pattern* p = a->pattern;
    const int *s = p->edge[e].vertex, *t = p->edge[f].vertex;
    if (s[0] == t[0] || s[0] == t[1] || s[1] == t[0] || s[1] == t[1]) {
        return RUGA_OK;
    }
    const double *s0 = p->position[s[0]], *s1 = p->position[s[1]];
    const double *t0 = p->position[t[0]], *t1 = p->position[t[1]];
    double a0 = side(t0, t1, s0), a1 = side(t0, t1, s1), b0 = side(s0, s1, t0), b1 = side(s0, s1, t1);
    double slack[2] = {a->weld * distance(t0, t1), a->weld * distance(s0, s1)};
    bool touches = fmin(fabs(a0), fabs(a1)) <= slack[0] || fmin(fabs(b0), fabs(b1)) <= slack[1];
    if (touches || (a0 < 0) == (a1 < 0) || (b0 < 0) == (b1 < 0)) {
        return RUGA_OK; // an end that lies on the other line splits it as a vertex does
    }
    double at = a0 / (a0 - a1), x[3] = {s0[0] + at * (s1[0] - s0[0]), s0[1] + at * (s1[1] - s0[1]), 0};
    double other = b0 / (b0 - b1);
    int v = p->vertex_count;
    RUGA_TRY(ruga_crease_pattern_add_vertex(p, x));
    a->crossings++;
    RUGA_TRY(add_cut(a, e, v, at));
    return add_cut(a, f, v, other);
}

static ruga_status cut_at_crossings(arranger* a) {
    ruga_crease_pattern* p = a->pattern;
    reach* sorted = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(sorted, p->edge_count));
    for (int e = 0; e < p->edge_count; e++) {
        sorted[e] = reach_of(p, e, 0);
    }
    if (p->edge_count > 1) {
        qsort(sorted, (size_t)p->edge_count, sizeof *sorted, compare_reaches);
    }
    for (int i = 0; i < p->edge_count; i++) {
        for (int j = i + 1; j < p->edge_count && sorted[j].low[0] <= sorted[i].high[0]; j++) {
            if (sorted[j].low[1] <= sorted[i].high[1] && sorted[j].high[1] >= sorted[i].low[1]) {
                RUGA_TRY_DONE(cut_pair(a, sorted[i].index, sorted[j].index));
            }
        }
    }
done:
    ruga_release(sorted);
    return status;
}

// An edge with its cuts becomes a chain; the first part keeps its number.
static ruga_status make_cuts(arranger* a) {
    ruga_crease_pattern* p = a->pattern;
    if (a->cut_count > 1) {
        qsort(a->cut, (size_t)a->cut_count, sizeof *a->cut, compare_cuts);
    }
    for (int i = 0; i < a->cut_count;) {
        ruga_crease_pattern_edge whole = p->edge[a->cut[i].edge];
        int edge = a->cut[i].edge, from = whole.vertex[0];
        p->edge[edge].vertex[1] = a->cut[i].vertex;
        for (; i < a->cut_count && a->cut[i].edge == edge; i++) {
            if (from != whole.vertex[0]) {
                RUGA_TRY(
                    ruga_crease_pattern_add_edge(p, from, a->cut[i].vertex, whole.assignment, whole.angle));
            }
            from = a->cut[i].vertex;
        }
        RUGA_TRY(ruga_crease_pattern_add_edge(p, from, whole.vertex[1], whole.assignment, whole.angle));
    }
    return RUGA_OK;
}

static ruga_status arrange_lines(arranger* a) {
    for (int round = 0; round < MOST_ROUNDS; round++) {
        RUGA_TRY(weld_vertices(a));
        RUGA_TRY(drop_doubles(a));
        RUGA_TRY(drop_unused(a->pattern));
        a->cut_count = 0;
        RUGA_TRY(cut_at_vertices(a));
        if (a->cut_count == 0) {
            RUGA_TRY(cut_at_crossings(a));
        }
        if (a->cut_count == 0) {
            return RUGA_OK;
        }
        RUGA_TRY(make_cuts(a));
    }
    return ruga_fail(
        RUGA_BAD_INPUT,
        "the crease pattern does not settle: its lines are closer than %.3g m in too many places", a->weld);
}

static ruga_status note_repairs(arranger* a) {
    ruga_crease_pattern* p = a->pattern;
    const struct {
        int count;
        const char* what;
    } repair[] = {{a->welded, "ends of lines within the tolerance of another vertex were joined to it"},
                  {a->dropped, "lines without length were left out"},
                  {a->doubled, "lines on top of others were left out"},
                  {a->crossings, "crossings of lines became vertices"},
                  {a->touching, "vertices on lines split them"}};
    for (size_t i = 0; i < sizeof repair / sizeof *repair; i++) {
        if (repair[i].count > 0) {
            RUGA_TRY(ruga_crease_pattern_note(p, "%d %s", repair[i].count, repair[i].what));
        }
    }
    return RUGA_OK;
}

ruga_status ruga_crease_pattern_arrange(ruga_crease_pattern* pattern, double weld) {
    ruga_status status = RUGA_OK;
    arranger a = {.pattern = pattern, .weld = weld};
    int vertices = pattern->vertex_count;
    RUGA_TRY_DONE(arrange_lines(&a));
    RUGA_TRY_DONE(note_repairs(&a));
    bool changed =
        a.welded + a.dropped + a.doubled + a.crossings + a.touching > 0 || pattern->vertex_count != vertices;
    bool complete = false;
    if (!changed && pattern->face_count > 0) {
        RUGA_TRY_DONE(ruga_crease_pattern_mark_rims(pattern, &complete));
    }
    if (!complete) {
        RUGA_TRY_DONE(ruga_crease_pattern_find_faces(pattern));
    }
done:
    ruga_release(a.cut);
    return status;
}
