// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Lines that end in the open are set aside; the rest is walked around, at each vertex to the next line
// clockwise, so that loops around a face run counter-clockwise, and only the outside of a connected set of
// lines runs the other way. From the outermost set inwards, each loop is paper or not: what lies beyond the
// outside is not; lines that are no border have the same on both sides, and crossing a border changes it,
// counted by the fewest borders on the way from outside:
//   d(outside) = 0, d(across a border) = d + 1, paper where d is odd.
// So a border around a place within the sheet makes a hole, and one that crosses the sheet does not. A set
// within a face (an island) begins with what that face is; as faces cannot have holes, it divides none. The
// border along the outside may be drawn as anything, and is a border afterwards.
#include "crease/faces.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "lattice/union_find.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct loop {
    int first;   // half-edge
    double area; // negative: the outside of its set
    int root;    // of its set of lines
} loop;

// Half-edge 2 e runs from vertex[0] to vertex[1], 2 e + 1 back.
typedef struct walker {
    ruga_crease_pattern* pattern;
    bool* aside; // [E] ends in the open
    int* degree; // [V]
    int* set;    // [V] connected lines
    int* next;   // [2 E]
    int* left;   // [2 E] loop on the left, -1 = none
    int loop_count, loop_capacity;
    loop* loop;
    int* same;  // [loops] sets of loops that no border parts
    int* depth; // [loops] of a set's root: borders on the way from outside, -1 = not known yet
} walker;

static int half_from(const ruga_crease_pattern* p, int half) {
    return p->edge[half / 2].vertex[half % 2];
}

static bool is_border(const walker* w, int edge) {
    return w->pattern->edge[edge].assignment == RUGA_ASSIGNMENT_BORDER;
}

static ruga_status set_dangling_aside(walker* w) {
    ruga_crease_pattern* p = w->pattern;
    int count = 0, open = 0, end = 0;
    for (int e = 0; e < p->edge_count; e++) {
        w->degree[p->edge[e].vertex[0]]++;
        w->degree[p->edge[e].vertex[1]]++;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (int k = 0; k < 2 * p->edge_count; k++) { // there and back: chains are listed either way
            int e = k < p->edge_count ? k : 2 * p->edge_count - 1 - k;
            const int* v = p->edge[e].vertex;
            if (!w->aside[e] && (w->degree[v[0]] == 1 || w->degree[v[1]] == 1)) {
                open += is_border(w, e);
                end = is_border(w, e) && open == 1 ? v[w->degree[v[0]] != 1] : end;
                w->aside[e] = changed = true;
                w->degree[v[0]]--;
                w->degree[v[1]]--;
                count++;
            }
        }
    }
    if (open > 0) {
        RUGA_TRY(ruga_crease_pattern_note(
            p, "%d border lines enclose nothing, as the outline is open at (%.6g, %.6g): close it there",
            open, p->position[end][0], p->position[end][1]));
    }
    return count == open
               ? RUGA_OK
               : ruga_crease_pattern_note(
                     p, "%d lines end within a face: they are creases, but divide no face", count - open);
}

typedef struct spoke {
    int vertex, half;
    double angle;
} spoke;

static int compare_spokes(const void* a, const void* b) {
    const spoke *p = a, *q = b;
    if (p->vertex != q->vertex) {
        return p->vertex < q->vertex ? -1 : 1;
    }
    return p->angle < q->angle ? -1 : p->angle > q->angle ? 1 : p->half < q->half ? -1 : p->half > q->half;
}

// next[half]: behind half's end, the line clockwise from the way back.
static ruga_status link_halves(walker* w) {
    ruga_crease_pattern* p = w->pattern;
    spoke* list = NULL;
    int count = 0;
    RUGA_TRY(RUGA_NEW(list, 2 * (size_t)p->edge_count));
    for (int half = 0; half < 2 * p->edge_count; half++) {
        if (!w->aside[half / 2]) {
            const double *a = p->position[half_from(p, half)], *b = p->position[half_from(p, half ^ 1)];
            list[count++] = (spoke){half_from(p, half), half, atan2(b[1] - a[1], b[0] - a[0])};
        }
    }
    if (count > 1) {
        qsort(list, (size_t)count, sizeof *list, compare_spokes);
    }
    for (int i = 0, end; i < count; i = end) {
        for (end = i; end < count && list[end].vertex == list[i].vertex;) {
            end++;
        }
        for (int k = i; k < end; k++) {
            w->next[list[k].half ^ 1] = list[k == i ? end - 1 : k - 1].half;
        }
    }
    ruga_release(list);
    return RUGA_OK;
}

static ruga_status walk_loops(walker* w) {
    ruga_crease_pattern* p = w->pattern;
    ruga_sets_reset(w->set, p->vertex_count);
    memset(w->left, -1, 2 * (size_t)p->edge_count * sizeof *w->left);
    for (int e = 0; e < p->edge_count; e++) {
        if (!w->aside[e]) {
            ruga_sets_unite(w->set, p->edge[e].vertex[0], p->edge[e].vertex[1]);
        }
    }
    for (int first = 0; first < 2 * p->edge_count; first++) {
        if (w->aside[first / 2] || w->left[first] >= 0) {
            continue;
        }
        double area = 0;
        int half = first;
        do {
            const double *a = p->position[half_from(p, half)], *b = p->position[half_from(p, half ^ 1)];
            area += a[0] * b[1] - a[1] * b[0];
            w->left[half] = w->loop_count;
            half = w->next[half];
        } while (half != first);
        RUGA_TRY(RUGA_RESERVE(w->loop, w->loop_capacity, (size_t)w->loop_count + 1));
        w->loop[w->loop_count++] = (loop){first, area, ruga_sets_find(w->set, half_from(p, first))};
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- paper or not

static bool holds(const walker* w, const loop* l, const double x[3]) {
    const ruga_crease_pattern* p = w->pattern;
    bool within = false;
    int half = l->first;
    do {
        const double *a = p->position[half_from(p, half)], *b = p->position[half_from(p, half ^ 1)];
        if ((a[1] > x[1]) != (b[1] > x[1]) && x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) {
            within = !within;
        }
        half = w->next[half];
    } while (half != l->first);
    return within;
}

// Borders on the way to the outside of a set: those to the smallest loop of another set around it.
static int depth_outside(const walker* w, const loop* outside) {
    const double* x = w->pattern->position[half_from(w->pattern, outside->first)];
    double smallest = INFINITY;
    int depth = 0;
    for (int k = 0; k < w->loop_count; k++) {
        const loop* l = &w->loop[k];
        if (l->root != outside->root && l->area > 0 && l->area < smallest && holds(w, l, x)) {
            smallest = l->area;
            depth = w->depth[ruga_sets_find(w->same, k)];
        }
    }
    return depth;
}

// Spreads from the outside of a set over its loops.
static void spread(walker* w, const loop* outside, int depth) {
    const ruga_crease_pattern* p = w->pattern;
    bool paper = depth % 2 == 1;
    int own = w->left[outside->first];
    for (int half = 0; half < 2 * p->edge_count; half++) {
        bool parts = is_border(w, half / 2) || (!paper && (w->left[half] == own || w->left[half ^ 1] == own));
        if (w->left[half] >= 0 && w->loop[w->left[half]].root == outside->root && !parts) {
            ruga_sets_unite(w->same, w->left[half], w->left[half ^ 1]);
        }
    }
    w->depth[ruga_sets_find(w->same, own)] = depth;
    for (bool reached = true; reached; depth++) {
        reached = false;
        for (int half = 0; half < 2 * p->edge_count; half++) {
            if (w->left[half] >= 0 && w->loop[w->left[half]].root == outside->root) {
                int from = ruga_sets_find(w->same, w->left[half]),
                    to = ruga_sets_find(w->same, w->left[half ^ 1]);
                if (w->depth[from] == depth && w->depth[to] < 0) {
                    w->depth[to] = depth + 1;
                    reached = true;
                }
            }
        }
    }
}

static bool is_paper(const walker* w, int k) {
    return w->depth[ruga_sets_find(w->same, k)] % 2 == 1;
}

static int compare_loops(const void* a, const void* b) {
    const loop *p = a, *q = b;
    return p->area < q->area ? -1 : p->area > q->area ? 1 : p->first < q->first ? -1 : p->first > q->first;
}

// From the set with the largest outside inwards.
static ruga_status find_depths(walker* w) {
    loop* outside = NULL;
    int count = 0;
    RUGA_TRY(RUGA_NEW(w->same, w->loop_count));
    RUGA_TRY(RUGA_NEW(w->depth, w->loop_count));
    RUGA_TRY(RUGA_NEW(outside, w->loop_count));
    ruga_sets_reset(w->same, w->loop_count);
    for (int k = 0; k < w->loop_count; k++) {
        w->depth[k] = -1;
        if (w->loop[k].area <= 0) {
            outside[count++] = w->loop[k];
        }
    }
    if (count > 1) {
        qsort(outside, (size_t)count, sizeof *outside, compare_loops);
    }
    for (int k = 0; k < count; k++) {
        spread(w, &outside[k], depth_outside(w, &outside[k]));
    }
    ruga_release(outside);
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- what is written down

static ruga_status mark_border(walker* w) {
    ruga_crease_pattern* p = w->pattern;
    int unmarked = 0;
    for (int e = 0; e < p->edge_count; e++) {
        ruga_crease_pattern_edge* edge = &p->edge[e];
        edge->rim =
            !w->aside[e] && is_paper(w, w->left[2 * (size_t)e]) != is_paper(w, w->left[2 * (size_t)e + 1]);
        if (edge->rim) {
            unmarked += edge->assignment != RUGA_ASSIGNMENT_BORDER;
            edge->assignment = RUGA_ASSIGNMENT_BORDER;
            edge->angle = NAN;
        }
    }
    return unmarked == 0
               ? RUGA_OK
               : ruga_crease_pattern_note(p, "%d lines along the outline are its border now", unmarked);
}

static ruga_status add_face(walker* w, const loop* l) {
    RUGA_TRY(ruga_crease_pattern_add_face(w->pattern));
    int half = l->first;
    do {
        RUGA_TRY(ruga_crease_pattern_add_corner(w->pattern, half_from(w->pattern, half)));
        half = w->next[half];
    } while (half != l->first);
    return RUGA_OK;
}

// Faces are the loops of paper, but for those of islands.
static ruga_status add_faces(walker* w) {
    ruga_crease_pattern* p = w->pattern;
    int islands = 0, example = -1, holes = 0, hole = -1;
    bool* island = NULL; // [V] by the root of a set
    RUGA_TRY(RUGA_NEW_ZERO(island, p->vertex_count));
    for (int k = 0; k < w->loop_count; k++) {
        island[w->loop[k].root] = island[w->loop[k].root] || (w->loop[k].area <= 0 && is_paper(w, k));
    }
    ruga_status status = RUGA_OK;
    for (int k = 0; k < w->loop_count; k++) {
        const loop* l = &w->loop[k];
        if (l->area > 0 && is_paper(w, k) && !island[l->root]) {
            RUGA_TRY_DONE(add_face(w, l));
        }
        if (l->area > 0 && !is_paper(w, k)) {
            holes++;
            hole = hole < 0 ? half_from(p, l->first) : hole;
        }
    }
    for (int e = 0; e < p->edge_count; e++) {
        if (w->left[2 * (size_t)e] >= 0 && island[w->loop[w->left[2 * (size_t)e]].root] && !p->edge[e].rim) {
            islands++;
            example = p->edge[e].vertex[0];
        }
    }
    if (holes > 0) {
        RUGA_TRY_DONE(
            ruga_crease_pattern_note(p, "%d places within borders, the first at (%.6g, %.6g), are holes",
                                     holes, p->position[hole][0], p->position[hole][1]));
    }
    if (islands > 0) {
        RUGA_TRY_DONE(ruga_crease_pattern_note(
            p, "%d lines, near (%.6g, %.6g), are joined to no border: they are creases, but divide no face",
            islands, p->position[example][0], p->position[example][1]));
    }
    if (p->face_count == 0) {
        status = ruga_fail(RUGA_BAD_INPUT, "the crease pattern has no closed outline: draw its border");
    }
done:
    ruga_release(island);
    return status;
}

ruga_status ruga_crease_pattern_find_faces(ruga_crease_pattern* p) {
    ruga_status status = RUGA_OK;
    walker w = {.pattern = p};
    p->face_count = p->corner_count = 0;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(w.aside, p->edge_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(w.degree, p->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(w.set, p->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(w.next, 2 * (size_t)p->edge_count));
    RUGA_TRY_DONE(RUGA_NEW(w.left, 2 * (size_t)p->edge_count));
    RUGA_TRY_DONE(set_dangling_aside(&w));
    RUGA_TRY_DONE(link_halves(&w));
    RUGA_TRY_DONE(walk_loops(&w));
    RUGA_TRY_DONE(find_depths(&w));
    RUGA_TRY_DONE(mark_border(&w));
    RUGA_TRY_DONE(add_faces(&w));
done:
    ruga_release(w.aside);
    ruga_release(w.degree);
    ruga_release(w.set);
    ruga_release(w.next);
    ruga_release(w.left);
    ruga_release(w.loop);
    ruga_release(w.same);
    ruga_release(w.depth);
    return status;
}

// ------------------------------------------------------------------------------- faces at hand

typedef struct line {
    int low, high;
    int edge, face; // -1 = the side of a face, and a line
} line;

static int compare_lines(const void* a, const void* b) {
    const line *p = a, *q = b;
    if (p->low != q->low) {
        return p->low < q->low ? -1 : 1;
    }
    return p->high != q->high ? (p->high < q->high ? -1 : 1) : (q->edge > p->edge) - (q->edge < p->edge);
}

// Lines, and sides of faces, sorted by their vertices: a line stands before the sides along it.
static ruga_status sort_lines(const ruga_crease_pattern* p, line** sorted) {
    int count = 0;
    RUGA_TRY(RUGA_NEW(*sorted, (size_t)p->edge_count + (size_t)p->corner_count));
    for (int e = 0; e < p->edge_count; e++) {
        const int* v = p->edge[e].vertex;
        (*sorted)[count++] = (line){v[0] < v[1] ? v[0] : v[1], v[0] < v[1] ? v[1] : v[0], e, -1};
    }
    for (int f = 0; f < p->face_count; f++) {
        for (int k = p->face_start[f]; k < p->face_start[f + 1]; k++) {
            int a = p->corner[k], b = p->corner[k + 1 < p->face_start[f + 1] ? k + 1 : p->face_start[f]];
            (*sorted)[count++] = (line){a < b ? a : b, a < b ? b : a, -1, f};
        }
    }
    if (count > 1) {
        qsort(*sorted, (size_t)count, sizeof **sorted, compare_lines);
    }
    return RUGA_OK;
}

ruga_status ruga_crease_pattern_mark_rims(ruga_crease_pattern* p, bool* complete) {
    line* sorted = NULL;
    ruga_status status = RUGA_OK;
    int added = 0, open = -1, count = p->edge_count + p->corner_count;
    RUGA_TRY_DONE(sort_lines(p, &sorted));
    for (int i = 0, end; i < count; i = end) {
        for (end = i;
             end < count && sorted[end].low == sorted[i].low && sorted[end].high == sorted[i].high;) {
            end++;
        }
        int e = sorted[i].edge, sides = end - i - (e >= 0);
        if (e < 0) {
            e = p->edge_count;
            added++;
            RUGA_TRY_DONE(ruga_crease_pattern_add_edge(
                p, sorted[i].low, sorted[i].high, sides == 1 ? RUGA_ASSIGNMENT_BORDER : RUGA_ASSIGNMENT_FLAT,
                NAN));
        }
        p->edge[e].rim = sides == 1;
        bool may =
            p->edge[e].assignment == RUGA_ASSIGNMENT_BORDER || p->edge[e].assignment == RUGA_ASSIGNMENT_CUT;
        // One with no face beside it: the border of a hole, which a face cannot have.
        open = (sides == 1 && !may) || (sides == 0 && p->edge[e].assignment == RUGA_ASSIGNMENT_BORDER)
                   ? p->edge[e].vertex[0]
                   : open;
    }
    if (added > 0) {
        RUGA_TRY_DONE(ruga_crease_pattern_note(p, "%d sides of faces without a line got one", added));
    }
    *complete = open < 0;
    if (open >= 0) {
        RUGA_TRY_DONE(ruga_crease_pattern_note(
            p, "faces_vertices disagrees with the line at (%.6g, %.6g): faces were found anew from the lines",
            p->position[open][0], p->position[open][1]));
    }
done:
    ruga_release(sorted);
    return status;
}

// ------------------------------------------------------------------------------- panels

// Faces on both sides of what is no line, or a flat one, are of one set.
static void join_faces(const ruga_crease_pattern* p, const line* sorted, int* set) {
    int count = p->edge_count + p->corner_count;
    for (int i = 0, end; i < count; i = end) {
        bool folds = false;
        int first = -1;
        for (end = i; end < count && sorted[end].low == sorted[i].low && sorted[end].high == sorted[i].high;
             end++) {
            const line* l = &sorted[end];
            folds = folds || (l->edge >= 0 && p->edge[l->edge].assignment != RUGA_ASSIGNMENT_FLAT);
            if (l->face >= 0 && !folds && first >= 0) {
                ruga_sets_unite(set, first, l->face);
            }
            first = l->face >= 0 && first < 0 ? l->face : first;
        }
    }
}

ruga_status ruga_crease_pattern_panels(const ruga_crease_pattern* p, int* count, int* panel) {
    line* sorted = NULL;
    int* set = NULL;
    ruga_status status = RUGA_OK;
    *count = 0;
    RUGA_TRY_DONE(RUGA_NEW(set, p->face_count));
    for (int f = 0; f < p->face_count; f++) {
        set[f] = f;
    }
    RUGA_TRY_DONE(sort_lines(p, &sorted));
    join_faces(p, sorted, set);
    for (int f = 0; f < p->face_count; f++) { // a root is the first of its set
        int root = ruga_sets_find(set, f);
        panel[f] = root == f ? (*count)++ : panel[root];
    }
done:
    ruga_release(sorted);
    ruga_release(set);
    return status;
}
