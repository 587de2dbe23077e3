// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "crease/pattern.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char letters[RUGA_ASSIGNMENT_COUNT + 1] = "BMVFUC";

ruga_assignment ruga_assignment_from_letter(char letter) {
    const char* found = letter ? strchr(letters, letter) : NULL;
    return found ? (ruga_assignment)(found - letters) : RUGA_ASSIGNMENT_COUNT;
}

char ruga_assignment_letter(ruga_assignment assignment) {
    return letters[assignment];
}

void ruga_crease_pattern_clear(ruga_crease_pattern* pattern) {
    ruga_release(pattern->position);
    ruga_release(pattern->edge);
    ruga_release(pattern->face_start);
    ruga_release(pattern->corner);
    for (int i = 0; i < pattern->note_count; i++) {
        ruga_release(pattern->note[i]);
    }
    ruga_release(pattern->note);
    *pattern = (ruga_crease_pattern){0};
}

ruga_status ruga_crease_pattern_add_vertex(ruga_crease_pattern* p, const double position[3]) {
    RUGA_TRY(RUGA_RESERVE(p->position, p->vertex_capacity, (size_t)p->vertex_count + 1));
    memcpy(p->position[p->vertex_count++], position, sizeof *p->position);
    return RUGA_OK;
}

ruga_status ruga_crease_pattern_add_edge(ruga_crease_pattern* p, int a, int b, ruga_assignment assignment,
                                         double angle) {
    RUGA_TRY(RUGA_RESERVE(p->edge, p->edge_capacity, (size_t)p->edge_count + 1));
    p->edge[p->edge_count++] = (ruga_crease_pattern_edge){{a, b}, assignment, angle, false};
    return RUGA_OK;
}

ruga_status ruga_crease_pattern_add_face(ruga_crease_pattern* p) {
    RUGA_TRY(RUGA_RESERVE(p->face_start, p->face_capacity, (size_t)p->face_count + 2));
    p->face_start[p->face_count++] = p->corner_count;
    p->face_start[p->face_count] = p->corner_count;
    return RUGA_OK;
}

ruga_status ruga_crease_pattern_add_corner(ruga_crease_pattern* p, int vertex) {
    RUGA_TRY(RUGA_RESERVE(p->corner, p->corner_capacity, (size_t)p->corner_count + 1));
    p->corner[p->corner_count++] = vertex;
    p->face_start[p->face_count] = p->corner_count;
    return RUGA_OK;
}

ruga_status ruga_crease_pattern_note(ruga_crease_pattern* p, const char* format, ...) {
    char sentence[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    RUGA_TRY(RUGA_RESERVE(p->note, p->note_capacity, (size_t)p->note_count + 1));
    p->note[p->note_count] = ruga_copy_string(sentence);
    if (!p->note[p->note_count]) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory for the notes on a crease pattern");
    }
    p->note_count++;
    return RUGA_OK;
}

double ruga_crease_pattern_rest(const ruga_crease_pattern_edge* edge) {
    if (!isnan(edge->angle)) {
        return edge->angle;
    }
    return edge->assignment == RUGA_ASSIGNMENT_VALLEY     ? RUGA_PI
           : edge->assignment == RUGA_ASSIGNMENT_MOUNTAIN ? -RUGA_PI
                                                          : 0;
}

// ------------------------------------------------------------------------------- curves

static const double same_angle = 1e-9; // rad: measured angles of one crease have their round-off

typedef struct chainer {
    const ruga_crease_pattern* pattern;
    bool flat;
    int* degree;      // [V] edges, without flat ones where these are no creases
    bool* facet;      // [V] flat edges that are no creases end there
    int (*around)[2]; // [V] its first two edges
    bool* done;       // [E]
    int* path;        // [E + 1] vertices
} chainer;

static bool is_crease(const chainer* c, int e) {
    ruga_assignment a = c->pattern->edge[e].assignment;
    return a != RUGA_ASSIGNMENT_BORDER && (a != RUGA_ASSIGNMENT_FLAT || c->flat);
}

// The edge behind e at its end v, where the crease goes on as the same one; -1 otherwise.
static int next_edge(const chainer* c, int e, int v) {
    if (c->degree[v] != 2) {
        return -1;
    }
    int next = c->around[v][0] == e ? c->around[v][1] : c->around[v][0];
    const ruga_crease_pattern_edge *a = &c->pattern->edge[e], *b = &c->pattern->edge[next];
    bool same = a->assignment == b->assignment &&
                fabs(ruga_crease_pattern_rest(a) - ruga_crease_pattern_rest(b)) <= same_angle;
    return same && !c->done[next] ? next : -1;
}

static int other_end(const ruga_crease_pattern_edge* edge, int v) {
    return edge->vertex[0] == v ? edge->vertex[1] : edge->vertex[0];
}

// The vertices of the crease that begins with edge e at its vertex v.
static int follow(chainer* c, int e, int v) {
    int count = 0;
    c->path[count++] = v;
    while (e >= 0) {
        c->done[e] = true;
        v = other_end(&c->pattern->edge[e], v);
        c->path[count++] = v;
        e = next_edge(c, e, v);
    }
    return count;
}

// Goes back from e to the edge at which its crease begins; a closed one begins at e.
static int find_start(const chainer* c, int e, int* v) {
    int at = e, from = c->pattern->edge[e].vertex[0];
    for (int next = next_edge(c, at, from); next >= 0 && next != e; next = next_edge(c, at, from)) {
        at = next;
        from = other_end(&c->pattern->edge[at], from);
    }
    *v = from;
    return at;
}

static ruga_status add_chain(const chainer* c, const ruga_curve* style, int first, int count,
                             ruga_curves* curves) {
    double(*point)[3] = NULL;
    RUGA_TRY(RUGA_NEW(point, count));
    for (int i = 0; i < count; i++) {
        memcpy(point[i], c->pattern->position[c->path[i]], sizeof point[i]);
    }
    ruga_curve own = *style;
    own.label = first;
    // Flat lines that end at a crease say that its panels may bend there.
    for (int i = 1; i + 1 < count && own.freedom == RUGA_FREEDOM_AUTO; i++) {
        own.freedom = c->facet[c->path[i]] ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_AUTO;
    }
    own.kind = c->pattern->edge[first].assignment == RUGA_ASSIGNMENT_CUT ? RUGA_CREASE_CUT : RUGA_CREASE_FOLD;
    own.closed = count > 3 && c->path[0] == c->path[count - 1];
    ruga_status status =
        ruga_curves_add_polyline(curves, &own, own.closed ? count - 1 : count, (const double(*)[3])point);
    ruga_release(point);
    return status;
}

ruga_status ruga_crease_pattern_curves(const ruga_crease_pattern* pattern, const ruga_curve* style, bool flat,
                                       ruga_curves* curves) {
    ruga_status status = RUGA_OK;
    chainer c = {.pattern = pattern, .flat = flat};
    RUGA_TRY_DONE(RUGA_NEW_ZERO(c.degree, pattern->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(c.facet, pattern->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(c.around, pattern->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(c.done, pattern->edge_count));
    RUGA_TRY_DONE(RUGA_NEW(c.path, (size_t)pattern->edge_count + 1));
    for (int e = 0; e < pattern->edge_count; e++) {
        bool counts = flat || pattern->edge[e].assignment != RUGA_ASSIGNMENT_FLAT;
        for (int end = 0; end < 2; end++) {
            int v = pattern->edge[e].vertex[end];
            c.facet[v] = c.facet[v] || !counts;
            if (!counts) {
                continue;
            }
            if (c.degree[v] < 2) {
                c.around[v][c.degree[v]] = e;
            }
            c.degree[v]++;
        }
    }
    for (int e = 0; e < pattern->edge_count; e++) {
        if (is_crease(&c, e) && !c.done[e]) {
            int v, first = find_start(&c, e, &v);
            int count = follow(&c, first, v);
            RUGA_TRY_DONE(add_chain(&c, style, first, count, curves));
        }
    }
done:
    ruga_release(c.degree);
    ruga_release(c.facet);
    ruga_release(c.around);
    ruga_release(c.done);
    ruga_release(c.path);
    return status;
}

ruga_status ruga_crease_pattern_add_curves(ruga_crease_pattern* pattern, const ruga_curves* curves) {
    for (int k = 0; k < curves->count; k++) {
        const ruga_curve* c = &curves->curve[k];
        int first = pattern->vertex_count;
        for (int i = 0; i < c->point_count; i++) {
            RUGA_TRY(ruga_crease_pattern_add_vertex(pattern, c->point[i]));
        }
        for (int i = c->closed ? 0 : 1; i < c->point_count; i++) {
            int before = first + (i > 0 ? i - 1 : c->point_count - 1);
            RUGA_TRY(
                ruga_crease_pattern_add_edge(pattern, before, first + i, (ruga_assignment)c->label, NAN));
        }
    }
    return RUGA_OK;
}

ruga_status ruga_crease_pattern_add_boundary(ruga_crease_pattern* pattern, const ruga_mesh* mesh) {
    ruga_status status = RUGA_OK;
    ruga_connectivity edges = {0};
    int* number = NULL;
    RUGA_TRY_DONE(ruga_connectivity_create(mesh, &edges));
    RUGA_TRY_DONE(RUGA_NEW(number, mesh->vertex_count));
    memset(number, -1, (size_t)mesh->vertex_count * sizeof *number);
    for (int e = 0; e < edges.edge_count; e++) {
        const int* end = edges.edge[e];
        if (edges.edge_triangle[e][0] >= 0 && edges.edge_triangle[e][1] >= 0) {
            continue;
        }
        for (int k = 0; k < 2; k++) {
            if (number[end[k]] < 0) {
                number[end[k]] = pattern->vertex_count;
                RUGA_TRY_DONE(ruga_crease_pattern_add_vertex(pattern, mesh->position + 3 * (size_t)end[k]));
            }
        }
        RUGA_TRY_DONE(ruga_crease_pattern_add_edge(pattern, number[end[0]], number[end[1]],
                                                   RUGA_ASSIGNMENT_BORDER, NAN));
    }
done:
    ruga_connectivity_clear(&edges);
    ruga_release(number);
    return status;
}
