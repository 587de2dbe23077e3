// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The virtual node algorithm (Molino, Bao and Fedkiw 2004) can hold one embedded node for each mesh edge and
// cannot hold a crossing within a triangle. Patkar, Jin and Fedkiw (2015, section 9) leave it to the mesh to
// be fine enough; merging two hits of an edge kinks both curves, and kinked curves lock. So the mesh is
// changed where the curves need it, in this order, one kind in a round:
//   1  ends and corners of curves become vertices of the mesh;
//   2  so do crossings: two chords of a triangle cross when their ends take turns around its border. That is
//      decided on the order of the ends alone, in which all hits of an edge within SAME_HIT are one, and hits
//      that different curves share are crossings too;
//   3  vertices nearer to a curve than `reach` are moved onto it: the cut then goes through them, which gives
//      the crease freedom, and no embedded node comes so near to a vertex that S is ill-conditioned (its
//      condition grows as the inverse square of that distance). One that cannot be moved and is nearer than
//      TOO_NEAR is gone through where it is;
//   4  edges with more than one hit are split between two of them.
// A place becomes a vertex by moving the nearest one there if the triangles around it allow it, else by
// splitting the edge it is close to, else by splitting the face. All else of curves stays straight between
// vertices, so that after 1 and 2 only neighbours in angle share an edge, which 4 takes apart.
#include "crease/mend.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SAME_HIT = 1e-7; // of an edge
static const double TOO_NEAR =
    1e-3; // edges: a curve this near to a vertex that stays where it is goes through it
static const double NEAR_EDGE =
    0.3; // of a face's edges: a place this near to an edge splits it, not the face

// A vertex that becomes a station of a path: of an edit, or an old one (edit < 0).
typedef struct ruga_insertion {
    int path, stretch, last;
    int edit, vertex;
    double order; // m along the curve, so that insertions into one stretch are made in one order
} insertion;

void ruga_mend_clear(ruga_mend* mend) {
    ruga_release(mend->hit);
    ruga_release(mend->link);
    ruga_release(mend->busy);
    ruga_release(mend->edit);
    ruga_release(mend->insertion);
    *mend = (ruga_mend){0};
}

static ruga_hit* hit_of(const ruga_mend* m, const ruga_hit_name* name) {
    return &m->paths->path[name->path].hits.hit[name->hit];
}

// ------------------------------------------------------------------------------- edits

static bool face_is_free(const ruga_mend* m, int f) {
    return f < 0 || !m->busy[f];
}

static void occupy(ruga_mend* m, int f) {
    if (f >= 0) {
        m->busy[f] = true;
    }
}

static bool fan_is_free(const ruga_mend* m, int v) {
    const ruga_connectivity* c = &m->sheet->edges;
    bool is_free = true;
    for (int k = c->incident_start[v]; k < c->incident_start[v + 1]; k++) {
        is_free = is_free && face_is_free(m, c->incident[k]);
    }
    return is_free;
}

static void occupy_fan(ruga_mend* m, int v) {
    const ruga_connectivity* c = &m->sheet->edges;
    for (int k = c->incident_start[v]; k < c->incident_start[v + 1]; k++) {
        occupy(m, c->incident[k]);
    }
}

// What a place turned into: an old vertex as it is, an edit, or nothing in this round.
typedef struct planted {
    int vertex, edit;
} planted;

static ruga_status add_edit(ruga_mend* m, ruga_edit edit, planted* result) {
    RUGA_TRY(RUGA_RESERVE(m->edit, m->edit_capacity, (size_t)m->edit_count + 1));
    result->edit = m->edit_count;
    m->edit[m->edit_count++] = edit;
    return RUGA_OK;
}

static ruga_status move_vertex(ruga_mend* m, int v, int face, const double weight[3], const double x[3],
                               planted* result) {
    if (!fan_is_free(m, v)) {
        m->waiting = true;
        return RUGA_OK;
    }
    occupy_fan(m, v);
    m->moved++;
    ruga_edit edit = {.kind = RUGA_EDIT_MOVE, .element = v, .face = face};
    memcpy(edit.position, x, sizeof edit.position);
    memcpy(edit.weight, weight, sizeof edit.weight);
    return add_edit(m, edit, result);
}

// x NULL: at `place` of the edge; otherwise near to it, within face f with these weights.
static ruga_status split_edge(ruga_mend* m, int e, double place, int f, const double* weight, const double* x,
                              planted* result) {
    const ruga_connectivity* c = &m->sheet->edges;
    *result = (planted){-1, -1};
    if (!face_is_free(m, c->edge_triangle[e][0]) || !face_is_free(m, c->edge_triangle[e][1])) {
        m->waiting = true;
        return RUGA_OK;
    }
    occupy(m, c->edge_triangle[e][0]);
    occupy(m, c->edge_triangle[e][1]);
    m->split_edges++;
    ruga_edit edit = {.kind = RUGA_EDIT_EDGE, .element = e, .place = place, .face = -1};
    ruga_hit at = {.vertex = -1, .edge = e, .place = place};
    ruga_hit_position(m->sheet, &at, edit.position);
    if (x) {
        memcpy(edit.position, x, sizeof edit.position);
        memcpy(edit.weight, weight, sizeof edit.weight);
        edit.face = f;
    }
    return add_edit(m, edit, result);
}

static ruga_status split_face(ruga_mend* m, int f, const double weight[3], const double x[3],
                              planted* result) {
    if (!face_is_free(m, f)) {
        m->waiting = true;
        return RUGA_OK;
    }
    occupy(m, f);
    m->split_faces++;
    ruga_edit edit = {.kind = RUGA_EDIT_FACE, .element = f, .face = f};
    memcpy(edit.position, x, sizeof edit.position);
    memcpy(edit.weight, weight, sizeof edit.weight);
    return add_edit(m, edit, result);
}

static const double* corner_position(const ruga_mend* m, int f, int i) {
    return ruga_sheet_position(m->sheet, m->sheet->mesh.triangle[3 * (size_t)f + (size_t)i]);
}

// Place on the edge opposite corner i that is nearest to x, from edge[0] on, in [0, 1]; and its distance.
static double foot_on_edge(const ruga_mend* m, int e, const double x[3], double* distance) {
    const int* v = m->sheet->edges.edge[e];
    const double *a = ruga_sheet_position(m->sheet, v[0]), *b = ruga_sheet_position(m->sheet, v[1]);
    double d[3], o[3];
    ruga_subtract(b, a, d);
    ruga_subtract(x, a, o);
    double place = ruga_dot(o, d) / ruga_dot(d, d);
    place = place < 0 ? 0 : place > 1 ? 1 : place;
    ruga_add_scaled(-place, d, o);
    *distance = ruga_norm(o);
    return place;
}

// What is very near to an edge that it cannot split where it is goes onto the edge, rather than leave a
// sliver. `firm` edges (boundary, border of a group) are split on themselves only.
static void slide_to_edge(const ruga_mend* m, int f, double size, bool firm, double x[3]) {
    int nearest = -1;
    double least = m->def->merge * size, nearest_place = 0;
    for (int i = 0; i < 3; i++) {
        int e = m->sheet->edges.triangle_edge[f][i];
        double distance, place = foot_on_edge(m, e, x, &distance);
        bool on_it = distance <= SAME_HIT * size;
        if ((on_it || (m->sheet->firm[e] == firm && (firm || !ruga_sheet_can_split(m->sheet, e, x)))) &&
            distance <= least) {
            least = distance;
            nearest = e;
            nearest_place = place;
        }
    }
    if (nearest >= 0) {
        ruga_hit at = {.vertex = -1, .edge = nearest, .place = nearest_place};
        ruga_hit_position(m->sheet, &at, x);
    }
}

// Makes a vertex of the place x in face f, by the rule at the file's head.
static ruga_status plant(ruga_mend* m, int f, const double where[3], planted* result) {
    const int* corner = m->sheet->mesh.triangle + 3 * (size_t)f;
    double size = ruga_sheet_face_edge(m->sheet, f), distance[3], weight[3];
    double x[3] = {where[0], where[1], where[2]};
    *result = (planted){-1, -1};
    slide_to_edge(m, f, size, true, x);
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 3; i++) {
        distance[i] = ruga_distance(x, corner_position(m, f, i));
    }
    for (int i = 0; i < 2; i++) {
        for (int j = i + 1; j < 3; j++) {
            if (distance[order[j]] < distance[order[i]]) {
                int swap = order[i];
                order[i] = order[j];
                order[j] = swap;
            }
        }
    }
    if (distance[order[0]] <= m->def->merge * size) {
        int v = corner[order[0]];
        // Exactly there if it may, so that straight curves stay straight.
        if (distance[order[0]] == 0 || !ruga_sheet_can_move(m->sheet, v, x)) {
            result->vertex = v;
            return RUGA_OK;
        }
    }
    int face = ruga_sheet_locate(m->sheet, f, x, weight);
    for (int i = 0; i < 3; i++) {
        if (ruga_sheet_can_move(m->sheet, corner[order[i]], x)) {
            return move_vertex(m, corner[order[i]], face, weight, x, result);
        }
    }
    slide_to_edge(m, f, size, false, x);
    face = ruga_sheet_locate(m->sheet, f, x, weight);
    int nearest = -1;
    double least = NEAR_EDGE * size, nearest_place = 0;
    for (int i = 0; i < 3; i++) {
        int e = m->sheet->edges.triangle_edge[f][i];
        double off, place = foot_on_edge(m, e, x, &off);
        // A place on the edge itself turns no triangle over, however near to an end it is.
        bool may = off <= SAME_HIT * size || (!m->sheet->firm[e] && ruga_sheet_can_split(m->sheet, e, x));
        if (may && off < least && place > 0 && place < 1) {
            least = off;
            nearest = e;
            nearest_place = place;
        }
    }
    if (nearest < 0) {
        return split_face(m, f, weight, x, result);
    }
    bool on_edge = least <= SAME_HIT * size;
    return split_edge(m, nearest, nearest_place, face, weight, on_edge ? NULL : x, result);
}

static ruga_status insert(ruga_mend* m, int path, int stretch, int last, planted what, const double x[3]) {
    if (what.vertex < 0 && what.edit < 0) {
        return RUGA_OK;
    }
    const ruga_path* p = &m->paths->path[path];
    double d[3], e[3];
    ruga_subtract(p->station[last + 1].place.x, p->station[stretch].place.x, d);
    ruga_subtract(x, p->station[stretch].place.x, e);
    RUGA_TRY(RUGA_RESERVE(m->insertion, m->insertion_capacity, (size_t)m->insertion_count + 1));
    m->insertion[m->insertion_count++] =
        (insertion){path, stretch, last, what.edit, what.vertex, ruga_dot(d, e)};
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- lists of hits

static int compare_names(const void* a, const void* b) {
    const ruga_hit_name *p = a, *q = b;
    if (p->key != q->key) {
        return p->key < q->key ? -1 : 1;
    }
    if (p->path != q->path) {
        return p->path < q->path ? -1 : 1;
    }
    return p->hit < q->hit ? -1 : p->hit > q->hit;
}

static ruga_status list_hits(ruga_mend* m) {
    m->hit_count = m->link_count = 0;
    for (int p = 0; p < m->paths->count; p++) {
        const ruga_hits* hits = &m->paths->path[p].hits;
        for (int i = 0; i < hits->count; i++) {
            const ruga_hit* h = &hits->hit[i];
            if (h->edge >= 0) {
                RUGA_TRY(RUGA_RESERVE(m->hit, m->hit_capacity, (size_t)m->hit_count + 1));
                m->hit[m->hit_count++] = (ruga_hit_name){h->edge, p, i};
            }
            if (i > 0 && h->face >= 0) {
                RUGA_TRY(RUGA_RESERVE(m->link, m->link_capacity, (size_t)m->link_count + 1));
                m->link[m->link_count++] = (ruga_hit_name){h->face, p, i};
            }
        }
    }
    if (m->hit_count > 1) {
        qsort(m->hit, (size_t)m->hit_count, sizeof *m->hit, compare_names);
    }
    if (m->link_count > 1) {
        qsort(m->link, (size_t)m->link_count, sizeof *m->link, compare_names);
    }
    return RUGA_OK;
}

static int end_of_key(const ruga_hit_name* list, int count, int begin) {
    int end = begin;
    while (end < count && list[end].key == list[begin].key) {
        end++;
    }
    return end;
}

// Hits of an edge within SAME_HIT of one before get its place, to the bit.
static void weld_hits(ruga_mend* m) {
    for (int i = 0, end; i < m->hit_count; i = end) {
        end = end_of_key(m->hit, m->hit_count, i);
        for (int j = i + 1; j < end; j++) {
            for (int k = i; k < j; k++) {
                double place = hit_of(m, &m->hit[k])->place;
                if (fabs(hit_of(m, &m->hit[j])->place - place) <= SAME_HIT) {
                    hit_of(m, &m->hit[j])->place = place;
                    break;
                }
            }
        }
    }
}

// ------------------------------------------------------------------------------- 1: ends and corners

static ruga_status plant_wanted(ruga_mend* m) {
    for (int p = 0; p < m->paths->count; p++) {
        ruga_path* path = &m->paths->path[p];
        for (int i = 0; i < path->count - path->closed; i++) {
            ruga_station* s = &path->station[i];
            if (!s->wanted) {
                continue;
            }
            planted result;
            RUGA_TRY(plant(m, s->place.face, s->place.x, &result));
            // A vertex to come is known by its edit until the edits are made.
            s->place.vertex = result.vertex >= 0 ? result.vertex : result.edit >= 0 ? -2 - result.edit : -1;
            s->wanted = s->place.vertex == -1;
            m->waiting = true;
        }
    }
    return RUGA_OK;
}

static void settle_wanted(ruga_mend* m) {
    for (int p = 0; p < m->paths->count; p++) {
        ruga_path* path = &m->paths->path[p];
        for (int i = 0; i < path->count; i++) {
            ruga_place* place = &path->station[i].place;
            if (place->vertex <= -2) {
                place->vertex = m->edit[-2 - place->vertex].vertex;
            }
            if (place->vertex >= 0) {
                m->sheet->pinned[place->vertex] = true;
            }
        }
        if (path->closed && path->station[0].place.vertex >= 0) {
            path->station[path->count - 1] = path->station[0];
        }
    }
}

// ------------------------------------------------------------------------------- 2: crossings

// Place of a hit on the border of face f: corner i at i, edge i (from corner i to i + 1) between.
static double border_place(const ruga_mend* m, int f, const ruga_hit* h) {
    const int* corner = m->sheet->mesh.triangle + 3 * (size_t)f;
    const int* edge = m->sheet->edges.triangle_edge[f];
    for (int i = 0; i < 3; i++) {
        if (h->vertex == corner[i]) {
            return i;
        }
        if (h->vertex < 0 && h->edge == edge[i]) {
            bool forward = m->sheet->edges.edge[edge[i]][0] == corner[i];
            return i + (forward ? h->place : 1 - h->place);
        }
    }
    return -1;
}

static bool between(double a, double b, double x) {
    return a < b ? a < x && x < b : x > a || x < b;
}

static bool chords_cross(const double a[2], const double b[2]) {
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            if (a[i] == b[j]) {
                return false;
            }
        }
    }
    return between(a[0], a[1], b[0]) != between(a[0], a[1], b[1]);
}

// Where two chords cross, in weights of the face, which make it a plane problem.
static void crossing_point(const ruga_mend* m, int f, const ruga_hit* const h[4], double x[3]) {
    double w[4][3], p[4][3];
    for (int k = 0; k < 4; k++) {
        ruga_hit_position(m->sheet, h[k], p[k]);
        ruga_sheet_weights(m->sheet, f, p[k], w[k]);
    }
    double ax = w[1][0] - w[0][0], ay = w[1][1] - w[0][1], bx = w[3][0] - w[2][0], by = w[3][1] - w[2][1];
    double cx = w[2][0] - w[0][0], cy = w[2][1] - w[0][1];
    double determinant = ax * by - ay * bx,
           place = determinant != 0 ? (cx * by - cy * bx) / determinant : 0.5;
    place = place >= 0 && place <= 1 ? place : place > 1 ? 1 : 0;
    for (int k = 0; k < 3; k++) {
        x[k] = p[0][k] + place * (p[1][k] - p[0][k]);
    }
}

static ruga_status fail_crossing(const ruga_mend* m, int a, int b, int face, const double x[3]) {
    return ruga_fail(
        RUGA_BAD_INPUT,
        "crease curves %d and %d cross within face %d at (%.6g, %.6g, %.6g): let the mesh be mended "
        "(snap), or give it a vertex or an edge there",
        m->paths->path[a].curve, m->paths->path[b].curve, face, x[0], x[1], x[2]);
}

static ruga_status mend_crossing(ruga_mend* m, int f, const ruga_hit_name* a, const ruga_hit_name* b) {
    const ruga_hit* h[4] = {hit_of(m, a) - 1, hit_of(m, a), hit_of(m, b) - 1, hit_of(m, b)};
    double x[3];
    planted result;
    crossing_point(m, f, h, x);
    if (!m->def->snap) {
        return fail_crossing(m, a->path, b->path, f, x);
    }
    RUGA_TRY(plant(m, f, x, &result));
    m->waiting = true;
    RUGA_TRY(insert(m, a->path, h[0]->stretch, h[1]->stretch, result, x));
    return insert(m, b->path, h[2]->stretch, h[3]->stretch, result, x);
}

static ruga_status mend_crossings(ruga_mend* m) {
    for (int i = 0, end; i < m->link_count; i = end) {
        end = end_of_key(m->link, m->link_count, i);
        int f = m->link[i].key;
        for (int j = i; j < end; j++) {
            const ruga_hit* h = hit_of(m, &m->link[j]);
            double a[2] = {border_place(m, f, h - 1), border_place(m, f, h)};
            for (int k = j + 1; k < end && face_is_free(m, f); k++) {
                const ruga_hit* g = hit_of(m, &m->link[k]);
                double b[2] = {border_place(m, f, g - 1), border_place(m, f, g)};
                if (chords_cross(a, b)) {
                    RUGA_TRY(mend_crossing(m, f, &m->link[j], &m->link[k]));
                }
            }
        }
    }
    return RUGA_OK;
}

static bool same_hit(const ruga_hit* a, const ruga_hit* b) {
    return a->vertex == b->vertex && a->edge == b->edge && (a->vertex >= 0 || a->place == b->place);
}

static bool is_neighbour(const ruga_mend* m, const ruga_hit_name* a, const ruga_hit* of) {
    const ruga_hits* hits = &m->paths->path[a->path].hits;
    return (a->hit > 0 && same_hit(&hits->hit[a->hit - 1], of)) ||
           (a->hit + 1 < hits->count && same_hit(&hits->hit[a->hit + 1], of));
}

// Whether two curves that share a hit run on together through a neighbour of it: then they lie on one
// another.
static bool run_together(const ruga_mend* m, const ruga_hit_name* a, const ruga_hit_name* b) {
    const ruga_hits* hits = &m->paths->path[a->path].hits;
    return (a->hit > 0 && is_neighbour(m, b, &hits->hit[a->hit - 1])) ||
           (a->hit + 1 < hits->count && is_neighbour(m, b, &hits->hit[a->hit + 1]));
}

// Makes a vertex on edge e and leads two paths through it.
static ruga_status join_on_edge(ruga_mend* m, const ruga_hit_name* a, const ruga_hit_name* b) {
    const ruga_hit *h = hit_of(m, a), *g = hit_of(m, b);
    ruga_hit middle = *h;
    middle.place = (h->place + g->place) / 2;
    double x[3];
    planted result;
    ruga_hit_position(m->sheet, &middle, x);
    int f = m->sheet->edges.edge_triangle[h->edge][0];
    f = f >= 0 ? f : m->sheet->edges.edge_triangle[h->edge][1];
    RUGA_TRY(plant(m, f, x, &result));
    m->waiting = true;
    RUGA_TRY(insert(m, a->path, h->stretch, h->stretch, result, x));
    return insert(m, b->path, g->stretch, g->stretch, result, x);
}

// Curves that meet on an edge. Without snap that is a crossing with up to four copies, and is let be.
static ruga_status mend_shared_hits(ruga_mend* m) {
    for (int i = 0, end; i < m->hit_count && m->def->snap; i = end) {
        end = end_of_key(m->hit, m->hit_count, i);
        bool done = false;
        for (int j = i; j < end && !done; j++) {
            for (int k = j + 1; k < end && !done; k++) {
                done = same_hit(hit_of(m, &m->hit[j]), hit_of(m, &m->hit[k])) &&
                       !run_together(m, &m->hit[j], &m->hit[k]);
                if (done) {
                    RUGA_TRY(join_on_edge(m, &m->hit[j], &m->hit[k]));
                }
            }
        }
    }
    return RUGA_OK;
}

// A curve across a mesh edge that another runs along.
static ruga_status mend_crossed_creases(ruga_mend* m) {
    for (int p = 0; p < m->paths->count && m->def->snap; p++) {
        const ruga_hits* hits = &m->paths->path[p].hits;
        for (int i = 1; i < hits->count; i++) {
            int a = hits->hit[i - 1].vertex, b = hits->hit[i].vertex;
            int e = a >= 0 && b >= 0 ? ruga_edge_between(&m->sheet->edges, a, b) : -1;
            ruga_hit_name key = {e, -1, 0};
            const ruga_hit_name* found = NULL;
            for (int low = 0, high = m->hit_count; e >= 0 && low < high;) {
                int middle = (low + high) / 2;
                found = m->hit[middle].key == e ? &m->hit[middle] : found;
                if (compare_names(&m->hit[middle], &key) < 0) {
                    low = middle + 1;
                } else {
                    high = middle;
                }
            }
            if (found) {
                const ruga_hit* h = hit_of(m, found);
                double x[3];
                planted result;
                ruga_hit_position(m->sheet, h, x);
                const int* f = m->sheet->edges.edge_triangle[e];
                RUGA_TRY(plant(m, f[0] >= 0 ? f[0] : f[1], x, &result));
                m->waiting = true;
                RUGA_TRY(insert(m, p, hits->hit[i].stretch, hits->hit[i].stretch, result, x));
                RUGA_TRY(insert(m, found->path, h->stretch, h->stretch, result, x));
            }
        }
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- 3: near vertices

// Vertex `end` of the edge that a path hits.
static ruga_status mend_near_vertex(ruga_mend* m, int p, const ruga_hit* h, int end) {
    const ruga_path* path = &m->paths->path[p];
    const int* ends = m->sheet->edges.edge[h->edge];
    int v = ends[end];
    const double* x = ruga_sheet_position(m->sheet, v);
    double length = ruga_distance(x, ruga_sheet_position(m->sheet, ends[1 - end]));
    double off = fabs(h->side[end]);
    if (off == 0 || off >= m->def->reach * length) {
        return RUGA_OK;
    }
    const ruga_place *a = &path->station[h->stretch].place, *b = &path->station[h->stretch + 1].place;
    // Distances were measured from the end that the walk came from.
    bool reversed = a->beyond;
    double plane[3], foot[3] = {x[0], x[1], x[2]}, d[3], e[3], weight[3];
    if (!ruga_trace_plane(m->sheet, reversed ? b : a, reversed ? a : b, plane)) {
        return RUGA_OK;
    }
    ruga_add_scaled(-h->side[end], plane, foot);
    if (m->sheet->firm[h->edge]) { // along the border, to where the curve leaves it
        ruga_hit_position(m->sheet, h, foot);
    }
    ruga_subtract(b->x, a->x, d);
    ruga_subtract(foot, a->x, e);
    double along = ruga_dot(d, e) / ruga_dot(d, d);
    if (!(along >= -SAME_HIT && along <= 1 + SAME_HIT)) {
        return RUGA_OK;
    }
    planted result = {-1, -1};
    if (ruga_sheet_can_move(m->sheet, v, foot)) {
        int f = ruga_sheet_locate(m->sheet, m->sheet->edges.incident[m->sheet->edges.incident_start[v]], foot,
                                  weight);
        RUGA_TRY(move_vertex(m, v, f, weight, foot, &result));
    } else if (off < TOO_NEAR * length) {
        result.vertex = v;
        m->waiting = true;
    }
    return insert(m, p, h->stretch, h->stretch, result, foot);
}

static ruga_status mend_near_vertices(ruga_mend* m) {
    for (int p = 0; p < m->paths->count && m->def->snap && m->def->reach > 0; p++) {
        for (int i = 0; i < m->paths->path[p].hits.count; i++) {
            const ruga_hit* h = &m->paths->path[p].hits.hit[i];
            for (int end = 0; end < 2 && h->edge >= 0; end++) {
                RUGA_TRY(mend_near_vertex(m, p, h, end));
            }
        }
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- 4: edges with several hits

static ruga_status fail_conflict(const ruga_mend* m, const ruga_hit_name* a, const ruga_hit_name* b) {
    double x[3];
    ruga_hit_position(m->sheet, hit_of(m, a), x);
    const int* v = m->sheet->edges.edge[a->key];
    return ruga_fail(
        RUGA_BAD_INPUT,
        "crease curves %d and %d both cut the edge between vertices %d and %d near (%.6g, %.6g, %.6g): let "
        "the mesh be mended (snap), or refine it there",
        m->paths->path[a->path].curve, m->paths->path[b->path].curve, v[0], v[1], x[0], x[1], x[2]);
}

// The two neighbouring hits of [begin, end) with the widest gap between them; 0 where all are one.
static double widest_gap(const ruga_mend* m, int begin, int end, int pair[2]) {
    double widest = 0;
    for (int j = begin; j < end; j++) {
        double place = hit_of(m, &m->hit[j])->place, gap = INFINITY;
        int next = -1;
        for (int k = begin; k < end; k++) {
            double other = hit_of(m, &m->hit[k])->place - place;
            if (other > 0 && other < gap) {
                gap = other;
                next = k;
            }
        }
        if (next >= 0 && gap > widest) {
            widest = gap;
            pair[0] = j;
            pair[1] = next;
        }
    }
    return widest;
}

static ruga_status mend_conflicts(ruga_mend* m) {
    for (int i = 0, end; i < m->hit_count; i = end) {
        end = end_of_key(m->hit, m->hit_count, i);
        int pair[2] = {i, i};
        double gap = widest_gap(m, i, end, pair);
        if (gap == 0) {
            continue;
        }
        const ruga_hit_name *a = &m->hit[pair[0]], *b = &m->hit[pair[1]];
        if (!m->def->snap) {
            return fail_conflict(m, a, b);
        }
        m->waiting = true;
        if (gap < m->def->merge) {
            RUGA_TRY(join_on_edge(m, a, b));
        } else {
            planted result;
            RUGA_TRY(split_edge(m, a->key, (hit_of(m, a)->place + hit_of(m, b)->place) / 2, -1, NULL, NULL,
                                &result));
        }
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- the round

static int compare_insertions(const void* a, const void* b) {
    const insertion *p = a, *q = b;
    if (p->path != q->path) {
        return p->path < q->path ? -1 : 1;
    }
    // From the last stretch to the first, so that numbers of stretches to come stay right.
    if (p->stretch != q->stretch) {
        return p->stretch > q->stretch ? -1 : 1;
    }
    return p->order < q->order ? -1 : p->order > q->order;
}

static ruga_status make_changes(ruga_mend* m, bool pin) {
    RUGA_TRY(ruga_sheet_apply(m->sheet, m->edit_count, m->edit, pin));
    settle_wanted(m);
    if (m->insertion_count > 1) {
        qsort(m->insertion, (size_t)m->insertion_count, sizeof *m->insertion, compare_insertions);
    }
    for (int i = 0, first = 0; i < m->insertion_count; i++) { // first: of the path
        const insertion* in = &m->insertion[i];
        // Stations that this round put into the same stretch: the order along it finds the place.
        int added = 0;
        first = m->insertion[first].path == in->path ? first : i;
        for (int k = first; k < i; k++) {
            added += m->insertion[k].stretch >= in->stretch && m->insertion[k].stretch <= in->last;
        }
        int vertex = in->edit >= 0 ? m->edit[in->edit].vertex : in->vertex;
        m->sheet->pinned[vertex] = true;
        RUGA_TRY(
            ruga_path_insert(m->sheet, &m->paths->path[in->path], in->stretch, in->last + added, vertex));
    }
    ruga_paths_renew(m->sheet, m->paths);
    return RUGA_OK;
}

static bool changed(const ruga_mend* m) {
    return m->edit_count > 0 || m->insertion_count > 0 || m->waiting;
}

ruga_status ruga_mend_round(ruga_mend* m, bool* fits) {
    m->edit_count = m->insertion_count = 0;
    m->waiting = false;
    ruga_release(m->busy);
    m->busy = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(m->busy, m->sheet->mesh.triangle_count));
    bool pin = true;
    RUGA_TRY(plant_wanted(m));
    if (!changed(m)) {
        RUGA_TRY(ruga_paths_trace(m->sheet, m->paths));
        RUGA_TRY(list_hits(m));
        weld_hits(m);
        RUGA_TRY(mend_crossings(m));
        RUGA_TRY(mend_shared_hits(m));
        RUGA_TRY(mend_crossed_creases(m));
    }
    if (!changed(m)) {
        RUGA_TRY(mend_near_vertices(m));
    }
    if (!changed(m)) {
        RUGA_TRY(mend_conflicts(m));
        pin = m->insertion_count > 0;
    }
    *fits = !changed(m);
    return *fits ? RUGA_OK : make_changes(m, pin);
}

ruga_status ruga_mend_give_up(const ruga_mend* m) {
    const double* x = m->edit_count > 0        ? m->edit[0].position
                      : m->insertion_count > 0 ? m->paths->path[m->insertion[0].path].station[0].place.x
                                               : m->paths->path[0].station[0].place.x;
    int curve = m->insertion_count > 0 ? m->paths->path[m->insertion[0].path].curve : 0;
    return ruga_fail(
        RUGA_BAD_INPUT,
        "the mesh could not be made to fit its creases in %d rounds; what is left is near (%.6g, %.6g, "
        "%.6g), by crease curve %d: draw the curves farther apart there, or use a finer mesh",
        m->def->rounds, x[0], x[1], x[2], curve);
}

ruga_status ruga_mend_check(ruga_mend* m) {
    RUGA_ASSERT(!m->def->snap);
    RUGA_TRY(list_hits(m));
    weld_hits(m);
    RUGA_TRY(mend_crossings(m));
    return mend_conflicts(m);
}
