// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The straight piece from A to B is the section of the surface by the plane through A and B that holds the
// mean normal n of both ends; on a flat mesh, the straight line. A vertex x has the side
//   s(x) = (x - A).m,  m = (B - A) x n / |...|,  s > 0: right of the line seen from the normals' side,
// one number for each vertex, whichever triangle asks. s counts as 0 at A, at B and within ZERO of an edge.
// All of the walk hangs on these signs: a line that enters a triangle between two vertices of unlike sides
// finds exactly one way out, an edge with unlike sides or a vertex with side 0. So neighbouring triangles
// always agree, and no rounding can lose the line inside the mesh.
#include "crease/trace.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

static const double ZERO = 1e-10;  // edges: a vertex this near to the line lies on it
static const double BEYOND = 1e-9; // of the piece's length: further is past its end
// On a curved surface a section may bulge past the end that it returns to, by no more than this.
static const double OVERSHOOT = 0.5;

typedef struct tracer {
    const ruga_sheet* sheet;
    const ruga_place* from;
    ruga_place* to;
    double direction[3];
    double plane[3];
    int stretch;
    ruga_hits* hits;
} tracer;

static void normal_at(const ruga_sheet* sheet, const ruga_place* p, double n[3]) {
    if (p->vertex >= 0) {
        ruga_sheet_vertex_normal(sheet, p->vertex, n);
    } else {
        ruga_sheet_face_normal(sheet, p->face, n);
    }
}

bool ruga_trace_plane(const ruga_sheet* sheet, const ruga_place* from, const ruga_place* to,
                      double plane[3]) {
    double a[3], b[3], d[3];
    normal_at(sheet, from, a);
    normal_at(sheet, to, b);
    ruga_add_scaled(1, b, a);
    ruga_subtract(to->x, from->x, d);
    double length = ruga_norm(d), size = ruga_normalize(a);
    ruga_cross(d, a, plane);
    // A mean of normals that oppose each other, or that the piece runs along, says nothing.
    static const double least = 1e-3;
    return ruga_normalize(plane) > least * length && size > least && length > 0;
}

static double side_of(const tracer* t, int v) {
    if (v == t->from->vertex || v == t->to->vertex) {
        return 0;
    }
    double d[3];
    ruga_subtract(ruga_sheet_position(t->sheet, v), t->from->x, d);
    double s = ruga_dot(d, t->plane);
    return fabs(s) <= ZERO * t->sheet->edge ? 0 : s;
}

static ruga_status add_vertex(tracer* t, int v, int face) {
    RUGA_TRY(RUGA_RESERVE(t->hits->hit, t->hits->capacity, (size_t)t->hits->count + 1));
    t->hits->hit[t->hits->count++] = (ruga_hit){.vertex = v, .edge = -1, .face = face, .stretch = t->stretch};
    return RUGA_OK;
}

static void point_on_edge(const tracer* t, int e, double place, double x[3]) {
    const int* v = t->sheet->edges.edge[e];
    memset(x, 0, 3 * sizeof *x);
    ruga_add_scaled(1 - place, ruga_sheet_position(t->sheet, v[0]), x);
    ruga_add_scaled(place, ruga_sheet_position(t->sheet, v[1]), x);
}

// The crossing of edge e, whose ends have unlike sides: always the same bits, whichever side asks.
static double place_on_edge(const tracer* t, int e, double side[2]) {
    side[0] = side_of(t, t->sheet->edges.edge[e][0]);
    side[1] = side_of(t, t->sheet->edges.edge[e][1]);
    return side[0] / (side[0] - side[1]);
}

static ruga_status add_edge(tracer* t, int e, int face) {
    RUGA_TRY(RUGA_RESERVE(t->hits->hit, t->hits->capacity, (size_t)t->hits->count + 1));
    ruga_hit* hit = &t->hits->hit[t->hits->count++];
    *hit = (ruga_hit){.vertex = -1, .edge = e, .face = face, .stretch = t->stretch};
    hit->place = place_on_edge(t, e, hit->side);
    return RUGA_OK;
}

static double along(const tracer* t, const double x[3]) {
    double d[3];
    ruga_subtract(x, t->from->x, d);
    return ruga_dot(d, t->direction) / ruga_dot(t->direction, t->direction);
}

static double cosine_from(const tracer* t, int v, const double x[3]) {
    double d[3];
    ruga_subtract(x, ruga_sheet_position(t->sheet, v), d);
    return ruga_dot(d, t->direction) / (ruga_norm(d) * ruga_norm(t->direction));
}

// What lies ahead of the line in or around the place where it is: an edge of `face`, or a vertex.
typedef struct step {
    int face; // that it goes through; -1 = along a mesh edge
    int edge;
    int vertex;
    double cosine;
} step;

static void offer(step* best, step offered) {
    if (offered.cosine > best->cosine) {
        *best = offered;
    }
}

// From vertex v: the vertex or the edge of the fan around it that lies most ahead.
static step step_from_vertex(const tracer* t, int v) {
    const ruga_connectivity* c = &t->sheet->edges;
    step best = {-1, -1, -1, 0};
    for (int k = c->incident_start[v]; k < c->incident_start[v + 1]; k++) {
        int f = c->incident[k];
        const int* corner = t->sheet->mesh.triangle + 3 * (size_t)f;
        int i = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
        int p = corner[(i + 1) % 3], q = corner[(i + 2) % 3];
        double sp = side_of(t, p), sq = side_of(t, q);
        if (sp == 0) {
            offer(&best, (step){-1, -1, p, cosine_from(t, v, ruga_sheet_position(t->sheet, p))});
        }
        if (sq == 0) {
            offer(&best, (step){-1, -1, q, cosine_from(t, v, ruga_sheet_position(t->sheet, q))});
        }
        if (sp > 0 && sq < 0) {
            double x[3], side[2];
            int e = c->triangle_edge[f][(i + 1) % 3];
            point_on_edge(t, e, place_on_edge(t, e, side), x);
            offer(&best, (step){f, e, -1, cosine_from(t, v, x)});
        }
    }
    return best;
}

// From a point within face f, or from its side `entered` (-1 = from within): ahead is where, going around
// counter-clockwise, sides turn from right to left.
static step step_through(const tracer* t, int f, int entered) {
    const int* corner = t->sheet->mesh.triangle + 3 * (size_t)f;
    const int* edge = t->sheet->edges.triangle_edge[f];
    double s[3];
    for (int i = 0; i < 3; i++) {
        s[i] = side_of(t, corner[i]);
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        if (s[i] > 0 && s[j] < 0 && edge[i] != entered) {
            return (step){f, edge[i], -1, 1};
        }
        if (s[j] == 0 && ((s[i] > 0 && s[k] < 0) || (s[i] == 0 && s[k] < 0) || (s[i] > 0 && s[k] == 0))) {
            // through the corner j, or along the edge i j (the third corner is on its left, k) or j k (i is
            // on its right, so that the line runs from k to j)
            return (step){f, -1, corner[j], 1};
        }
    }
    return (step){f, -1, -1, 0};
}

// Whether the walk is at its end (or lost), once it is in face f and would leave it at x.
static bool arrives(const tracer* t, int f, const double x[3], ruga_arrival* arrival) {
    ruga_place* to = t->to;
    double place = along(t, x);
    if (to->vertex >= 0 || to->beyond) {
        *arrival = RUGA_LOST;
        return place > 1 + OVERSHOOT;
    }
    if (f == to->face) {
        *arrival = RUGA_ARRIVED;
        return true;
    }
    if (place > 1 + BEYOND) { // past it, so that it lies on the border of this face
        *arrival = ruga_distance(x, to->x) < 2 * t->sheet->edge ? RUGA_ARRIVED : RUGA_LOST;
        to->face = f >= 0 ? f : to->face;
        return true;
    }
    return false;
}

static ruga_status walk(tracer* t, ruga_arrival* arrival) {
    const ruga_connectivity* c = &t->sheet->edges;
    int vertex = t->from->vertex, face = t->from->face, entered = -1;
    // A plane meets each edge once and each vertex once; more steps mean that the walk goes round.
    for (int64_t steps = 0; steps <= (int64_t)c->edge_count + c->vertex_count; steps++) {
        step next = vertex >= 0 ? step_from_vertex(t, vertex) : step_through(t, face, entered);
        if (next.edge < 0 && next.vertex < 0) {
            *arrival = vertex >= 0 && ruga_sheet_on_boundary(t->sheet, vertex) ? RUGA_LEFT : RUGA_LOST;
            return RUGA_OK;
        }
        double x[3], side[2];
        if (next.vertex >= 0) {
            memcpy(x, ruga_sheet_position(t->sheet, next.vertex), sizeof x);
        } else {
            point_on_edge(t, next.edge, place_on_edge(t, next.edge, side), x);
        }
        if (next.vertex < 0 || next.vertex != t->to->vertex) {
            if (arrives(t, next.face, x, arrival)) {
                return RUGA_OK;
            }
        }
        if (next.vertex >= 0) {
            RUGA_TRY(add_vertex(t, next.vertex, next.face));
            if (next.vertex == t->to->vertex) {
                *arrival = RUGA_ARRIVED;
                return RUGA_OK;
            }
            vertex = next.vertex;
            continue;
        }
        RUGA_TRY(add_edge(t, next.edge, next.face));
        const int* beside = c->edge_triangle[next.edge];
        vertex = -1;
        entered = next.edge;
        face = beside[0] == next.face ? beside[1] : beside[0];
        if (face < 0) {
            *arrival = RUGA_LEFT;
            return RUGA_OK;
        }
    }
    *arrival = RUGA_LOST;
    return RUGA_OK;
}

ruga_status ruga_trace(const ruga_sheet* sheet, const ruga_place* from, ruga_place* to, int stretch,
                       ruga_hits* hits, ruga_arrival* arrival) {
    tracer t = {.sheet = sheet, .from = from, .to = to, .stretch = stretch, .hits = hits};
    ruga_subtract(to->x, from->x, t.direction);
    *arrival = RUGA_ARRIVED;
    if (from->vertex >= 0 && from->vertex == to->vertex) {
        return RUGA_OK;
    }
    if (from->vertex < 0 && to->vertex < 0 && from->face == to->face && !to->beyond) {
        return RUGA_OK;
    }
    // Neighbours are joined by their edge, however the surface is bent there.
    int edge = from->vertex >= 0 && to->vertex >= 0
                   ? ruga_edge_between(&sheet->edges, from->vertex, to->vertex)
                   : -1;
    if (edge >= 0) {
        return add_vertex(&t, to->vertex, -1);
    }
    *arrival = RUGA_LOST;
    return ruga_trace_plane(sheet, from, to, t.plane) ? walk(&t, arrival) : RUGA_OK;
}
