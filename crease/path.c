// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// From drawn points to stations. A point beyond the boundary is one whose nearest place is on the boundary
// and that is off it sideways; its height above the surface is taken off, so that a curve drawn above a sheet
// is trimmed where it passes over the border. Of a piece with both ends beyond, samples tell where it is on
// the mesh.
//
// A corner is a turn of more than `corner`, or any turn between two pieces long enough to afford a vertex of
// the mesh between them: on such curves each straight piece stays exactly straight.
#include "crease/path.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/cgal_shim.h"

#include <math.h>
#include <string.h>

static const double SAME_PLACE = 1e-9;  // edges: a point this near to a vertex is the vertex
static const double OVERHANG = 1e-6;    // edges sideways off the boundary: beyond it
static const double LONG_PIECE = 2;     // edges: both pieces at a slight corner are longer
static const double REPEATED = 1e-7;    // edges: between points that are one
static const double SLIGHT_TURN = 1e-6; // rad
static const double SAMPLE = 1.0 / 3;   // edges between samples of a piece with both ends beyond

void ruga_paths_clear(ruga_paths* paths) {
    for (int p = 0; p < paths->count; p++) {
        ruga_release(paths->path[p].station);
        ruga_release(paths->path[p].hits.hit);
    }
    ruga_release(paths->path);
    *paths = (ruga_paths){0};
}

void ruga_hit_position(const ruga_sheet* sheet, const ruga_hit* hit, double x[3]) {
    if (hit->vertex >= 0) {
        memcpy(x, ruga_sheet_position(sheet, hit->vertex), 3 * sizeof *x);
        return;
    }
    const int* v = sheet->edges.edge[hit->edge];
    memset(x, 0, 3 * sizeof *x);
    ruga_add_scaled(1 - hit->place, ruga_sheet_position(sheet, v[0]), x);
    ruga_add_scaled(hit->place, ruga_sheet_position(sheet, v[1]), x);
}

static ruga_status add_path(ruga_paths* paths, int curve) {
    RUGA_TRY(RUGA_RESERVE(paths->path, paths->capacity, (size_t)paths->count + 1));
    paths->path[paths->count++] = (ruga_path){.curve = curve};
    return RUGA_OK;
}

static ruga_status add_station(ruga_path* path, const ruga_place* place, bool wanted) {
    RUGA_TRY(RUGA_RESERVE(path->station, path->capacity, (size_t)path->count + 1));
    path->station[path->count++] = (ruga_station){*place, wanted};
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- projection

typedef struct drawer {
    ruga_sheet* sheet;
    const ruga_curves* curves;
    bool snap;
    double corner; // rad
    ruga_cgal_locator* locator;
    ruga_place* place; // [points] of the curve at hand
    int capacity;
    ruga_paths* paths;
} drawer;

// Whether a place of face f with these weights lies on the boundary.
static bool on_boundary(const ruga_sheet* sheet, int f, const double weight[3]) {
    for (int i = 0; i < 3; i++) {
        const int* beside = sheet->edges.edge_triangle[sheet->edges.triangle_edge[f][(i + 1) % 3]];
        if (weight[i] < SAME_PLACE && (beside[0] < 0 || beside[1] < 0)) {
            return true;
        }
        if (weight[i] > 1 - SAME_PLACE &&
            ruga_sheet_on_boundary(sheet, sheet->mesh.triangle[3 * (size_t)f + (size_t)i])) {
            return true;
        }
    }
    return false;
}

// A place at a corner of its face is that vertex.
static void take_vertex(const ruga_sheet* sheet, ruga_place* place) {
    for (int i = 0; i < 3; i++) {
        int v = sheet->mesh.triangle[3 * (size_t)place->face + (size_t)i];
        if (ruga_distance(place->x, ruga_sheet_position(sheet, v)) <= SAME_PLACE * sheet->edge) {
            place->vertex = v;
            memcpy(place->x, ruga_sheet_position(sheet, v), sizeof place->x);
        }
    }
}

static ruga_status project(const drawer* d, const double x[3], ruga_place* place) {
    const ruga_sheet* sheet = d->sheet;
    double nearest[3], weight[3], off[3], n[3];
    *place = (ruga_place){.vertex = -1};
    RUGA_TRY(ruga_cgal_locator_nearest(d->locator, 1, x, &place->face, nearest));
    ruga_sheet_weights(sheet, place->face, nearest, weight);
    ruga_sheet_face_normal(sheet, place->face, n);
    ruga_subtract(x, nearest, off);
    ruga_add_scaled(-ruga_dot(off, n), n, off);
    place->beyond = on_boundary(sheet, place->face, weight) && ruga_norm(off) > OVERHANG * sheet->edge;
    memcpy(place->x, nearest, sizeof place->x);
    if (place->beyond) {
        ruga_add_scaled(1, off, place->x);
        return RUGA_OK;
    }
    take_vertex(sheet, place);
    return RUGA_OK;
}

static ruga_status project_curve(drawer* d, const ruga_curve* curve) {
    RUGA_TRY(RUGA_RESERVE(d->place, d->capacity, (size_t)curve->point_count + 1));
    for (int i = 0; i < curve->point_count; i++) {
        int v = curve->vertex[i];
        if (v >= 0) {
            d->place[i] = (ruga_place){.vertex = v,
                                       .face = d->sheet->edges.incident[d->sheet->edges.incident_start[v]]};
            memcpy(d->place[i].x, ruga_sheet_position(d->sheet, v), sizeof d->place[i].x);
            d->sheet->pinned[v] = true;
        } else {
            RUGA_TRY(project(d, curve->point[i], &d->place[i]));
        }
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- stations

static bool is_corner(const drawer* d, const ruga_curve* curve, int i) {
    int n = curve->point_count;
    if (!curve->closed && (i == 0 || i == n - 1)) {
        return true;
    }
    double a[3], b[3], c[3];
    ruga_subtract(d->place[i].x, d->place[(i + n - 1) % n].x, a);
    ruga_subtract(d->place[(i + 1) % n].x, d->place[i].x, b);
    ruga_cross(a, b, c);
    double turn = atan2(ruga_norm(c), ruga_dot(a, b));
    double least = LONG_PIECE * d->sheet->edge;
    return turn > d->corner || (turn > SLIGHT_TURN && ruga_norm(a) > least && ruga_norm(b) > least);
}

// Of a piece with both ends beyond: a path through the middle of each run of samples that are on the mesh.
static ruga_status add_passages(drawer* d, int curve, const ruga_place* a, const ruga_place* b) {
    double length = ruga_distance(a->x, b->x);
    double wanted = ceil(length / (SAMPLE * d->sheet->edge));
    int samples = wanted < 1e6 ? (int)wanted : 1000000, first = -1;
    for (int i = 1; i <= samples; i++) {
        ruga_place at;
        double x[3];
        for (int k = 0; k < 3; k++) {
            x[k] = a->x[k] + (b->x[k] - a->x[k]) * i / samples;
        }
        RUGA_TRY(project(d, x, &at));
        first = first < 0 && !at.beyond ? i : first;
        if (first >= 0 && (at.beyond || i == samples)) {
            for (int k = 0; k < 3; k++) {
                x[k] = a->x[k] + (b->x[k] - a->x[k]) * (first + i - 1) / 2 / samples;
            }
            RUGA_TRY(project(d, x, &at));
            RUGA_TRY(add_path(d->paths, curve));
            ruga_path* path = &d->paths->path[d->paths->count - 1];
            RUGA_TRY(add_station(path, a, false));
            RUGA_TRY(add_station(path, &at, false));
            RUGA_TRY(add_station(path, b, false));
            first = -1;
        }
    }
    return RUGA_OK;
}

static ruga_status draw(drawer* d, int index) {
    const ruga_curve* curve = &d->curves->curve[index];
    int n = curve->point_count, before = d->paths->count;
    RUGA_TRY(project_curve(d, curve));
    bool open = true; // whether the next place begins a path
    for (int k = 0; k < n + curve->closed; k++) {
        int i = k % n;
        const ruga_place* place = &d->place[i];
        const ruga_place* last = k > 0 ? &d->place[k - 1] : NULL;
        if (last && last->beyond && place->beyond) {
            RUGA_TRY(add_passages(d, index, last, place));
            continue;
        }
        if (open && place->beyond) {
            continue;
        }
        if (open) {
            RUGA_TRY(add_path(d->paths, index));
            if (last && last->beyond) {
                RUGA_TRY(add_station(&d->paths->path[d->paths->count - 1], last, false));
            }
        }
        // The end of a closed curve must be a vertex: a loop that no vertex interrupts cannot fold at all.
        bool wanted = place->vertex < 0 && !place->beyond &&
                      ((d->snap && is_corner(d, curve, i)) || (curve->closed && i == 0));
        RUGA_TRY(add_station(&d->paths->path[d->paths->count - 1], place, wanted));
        open = place->beyond;
    }
    ruga_path* path = before < d->paths->count ? &d->paths->path[before] : NULL;
    if (!path) {
        const double* x = curve->point[0];
        return ruga_fail(
            RUGA_BAD_INPUT,
            "crease curve %d, which begins at (%.6g, %.6g, %.6g), lies beside the mesh: check the unit "
            "and the place",
            index, x[0], x[1], x[2]);
    }
    path->closed = curve->closed && d->paths->count == before + 1 && !path->station[0].place.beyond;
    return RUGA_OK;
}

ruga_status ruga_paths_add(ruga_sheet* sheet, const ruga_curves* curves, const int stages[2], bool snap,
                           double corner, ruga_paths* paths) {
    ruga_status status = RUGA_OK;
    drawer d = {.sheet = sheet, .curves = curves, .snap = snap, .corner = corner, .paths = paths};
    RUGA_TRY_DONE(ruga_cgal_locator_create(sheet->mesh.position, sheet->mesh.triangle_count,
                                           sheet->mesh.triangle, &d.locator));
    for (int c = 0; c < curves->count; c++) {
        if (curves->curve[c].stage >= stages[0] && curves->curve[c].stage <= stages[1]) {
            RUGA_TRY_DONE(draw(&d, c));
        }
    }
done:
    ruga_cgal_locator_destroy(&d.locator);
    ruga_release(d.place);
    return status;
}

// ------------------------------------------------------------------------------- hits

static bool edge_has(const ruga_sheet* sheet, int e, int v) {
    return sheet->edges.edge[e][0] == v || sheet->edges.edge[e][1] == v;
}

// Appends a hit to those already reduced, or lets it cancel what it makes needless; *count may fall.
static void push(const ruga_sheet* sheet, ruga_hit* out, int* count, ruga_hit h) {
    while (*count > 0) {
        ruga_hit* top = &out[*count - 1];
        if (h.vertex < 0 && top->vertex < 0 && h.edge == top->edge) {
            --*count; // a poke into the triangle behind this edge
            return;
        }
        if (h.vertex >= 0 && top->vertex < 0 && edge_has(sheet, top->edge, h.vertex)) {
            h.face = top->face; // the vertex is in that face as well
            --*count;
            continue;
        }
        if (top->vertex >= 0 &&
            (h.vertex >= 0 ? h.vertex == top->vertex : edge_has(sheet, h.edge, top->vertex))) {
            return;
        }
        if (*count > 1 && h.vertex >= 0 && top->vertex < 0 && out[*count - 2].vertex == h.vertex) {
            --*count; // out and back through one triangle
            return;
        }
        break;
    }
    if (h.vertex >= 0 && *count > 0 && out[*count - 1].vertex >= 0) {
        h.face = -1; // two corners of a triangle: along its edge
    }
    out[(*count)++] = h;
}

static void reduce(const ruga_sheet* sheet, ruga_hits* hits) {
    int count = 0;
    for (int i = 0; i < hits->count; i++) {
        push(sheet, hits->hit, &count, hits->hit[i]);
    }
    hits->count = count;
}

// Turns the hits from `begin` on around: they were found from the other end. The face of a hit is that of the
// link to the hit before it.
static void reverse(ruga_hits* hits, int begin, int first_face) {
    for (int i = begin, j = hits->count - 1; i < j; i++, j--) {
        ruga_hit h = hits->hit[i];
        hits->hit[i] = hits->hit[j];
        hits->hit[j] = h;
    }
    for (int i = hits->count - 1; i > begin; i--) {
        hits->hit[i].face = hits->hit[i - 1].face;
    }
    if (begin < hits->count) {
        hits->hit[begin].face = first_face;
    }
}

// At an end of the first piece: there may be no other.
static ruga_status add_own_vertex(ruga_path* path, int station) {
    ruga_hits* hits = &path->hits;
    RUGA_TRY(RUGA_RESERVE(hits->hit, hits->capacity, (size_t)hits->count + 1));
    hits->hit[hits->count++] =
        (ruga_hit){.vertex = path->station[station].place.vertex, .edge = -1, .face = -1, .stretch = 0};
    return RUGA_OK;
}

static ruga_status fail_lost(const ruga_path* path, int i) {
    const double *a = path->station[i].place.x, *b = path->station[i + 1].place.x;
    return ruga_fail(
        RUGA_BAD_INPUT,
        "crease curve %d: no straight way leads over the surface from (%.6g, %.6g, %.6g) to (%.6g, "
        "%.6g, %.6g): put points between them",
        path->curve, a[0], a[1], a[2], b[0], b[1], b[2]);
}

// The piece that comes from beyond is found from its other end; the link from its last hit to what follows
// then runs through the face where the walk began.
static ruga_status trace_from_beyond(const ruga_sheet* sheet, ruga_path* path) {
    ruga_place from = path->station[1].place, to = path->station[0].place;
    ruga_arrival arrival;
    int begin = path->hits.count;
    RUGA_TRY(ruga_trace(sheet, &from, &to, 0, &path->hits, &arrival));
    if (arrival != RUGA_LEFT) {
        return fail_lost(path, 0);
    }
    int first = begin < path->hits.count ? path->hits.hit[begin].face : -1;
    reverse(&path->hits, begin, -1);
    if (from.vertex >= 0) {
        RUGA_TRY(add_own_vertex(path, 1));
        path->hits.hit[path->hits.count - 1].face = first;
    }
    return RUGA_OK;
}

// The rest of a path behind station i becomes a path of its own; both ends at the gap are beyond.
static ruga_status split_path(ruga_paths* paths, int p, int i) {
    RUGA_TRY(add_path(paths, paths->path[p].curve));
    ruga_path* path = &paths->path[p];
    ruga_path* rest = &paths->path[paths->count - 1];
    ruga_place a = path->station[i].place, b = path->station[i + 1].place;
    a.vertex = b.vertex = -1;
    a.beyond = b.beyond = true;
    RUGA_TRY(add_station(rest, &a, false));
    for (int k = i + 1; k < path->count; k++) {
        RUGA_TRY(add_station(rest, &path->station[k].place, path->station[k].wanted));
    }
    path->station[i + 1] = (ruga_station){b, false};
    path->count = i + 2;
    path->closed = false;
    return RUGA_OK;
}

static ruga_status trace_path(const ruga_sheet* sheet, ruga_paths* paths, int p) {
    ruga_path* path = &paths->path[p];
    path->hits.count = 0;
    int i = 0;
    if (path->station[0].place.beyond) {
        RUGA_TRY(trace_from_beyond(sheet, path));
        i = 1;
    } else if (path->station[0].place.vertex >= 0) {
        RUGA_TRY(add_own_vertex(path, 0));
    }
    for (; i + 1 < path->count; i++) {
        ruga_arrival arrival;
        int begin = path->hits.count;
        ruga_station *from = &path->station[i], *to = &path->station[i + 1];
        RUGA_TRY(ruga_trace(sheet, &from->place, &to->place, i, &path->hits, &arrival));
        if (arrival == RUGA_LEFT && !to->place.beyond) {
            RUGA_TRY(split_path(paths, p, i));
            path = &paths->path[p];
            path->hits.count = begin;
            i--;
        } else if (arrival == RUGA_LOST || (arrival == RUGA_ARRIVED && to->place.beyond)) {
            return fail_lost(path, i);
        }
    }
    reduce(sheet, &path->hits);
    return RUGA_OK;
}

ruga_status ruga_paths_trace(const ruga_sheet* sheet, ruga_paths* paths) {
    // A path that is split leaves its rest at the end of the list, where it is reached as well.
    for (int p = 0; p < paths->count; p++) {
        RUGA_TRY(trace_path(sheet, paths, p));
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- changes

ruga_status ruga_path_insert(const ruga_sheet* sheet, ruga_path* path, int stretch, int last, int vertex) {
    ruga_place place = {.vertex = vertex, .face = sheet->edges.incident[sheet->edges.incident_start[vertex]]};
    memcpy(place.x, ruga_sheet_position(sheet, vertex), sizeof place.x);
    const double *a = path->station[stretch].place.x, *b = path->station[last + 1].place.x;
    double d[3], e[3];
    ruga_subtract(b, a, d);
    ruga_subtract(place.x, a, e);
    double along = ruga_dot(e, d);
    int at = stretch + 1;
    for (; at <= last; at++) {
        ruga_subtract(path->station[at].place.x, a, e);
        if (ruga_dot(e, d) > along) {
            break;
        }
    }
    RUGA_TRY(add_station(path, &place, false));
    memmove(&path->station[at + 1], &path->station[at],
            (size_t)(path->count - 1 - at) * sizeof *path->station);
    path->station[at] = (ruga_station){place, false};
    return RUGA_OK;
}

// The same vertex again, or a point that nobody wants at the place of its neighbour.
static bool is_repeat(const ruga_sheet* sheet, const ruga_station* a, const ruga_station* b) {
    if (a->place.vertex >= 0 && b->place.vertex >= 0) {
        return a->place.vertex == b->place.vertex;
    }
    bool may = !a->wanted && !b->wanted && !a->place.beyond && !b->place.beyond;
    return may && ruga_distance(a->place.x, b->place.x) <= REPEATED * sheet->edge;
}

void ruga_paths_renew(const ruga_sheet* sheet, ruga_paths* paths) {
    for (int p = 0; p < paths->count; p++) {
        ruga_path* path = &paths->path[p];
        int count = 0;
        for (int i = 0; i < path->count; i++) {
            ruga_station s = path->station[i];
            double weight[3];
            if (s.place.vertex >= 0) {
                memcpy(s.place.x, ruga_sheet_position(sheet, s.place.vertex), sizeof s.place.x);
                s.place.face = sheet->edges.incident[sheet->edges.incident_start[s.place.vertex]];
            } else if (!s.place.beyond) {
                s.place.face = ruga_sheet_locate(sheet, s.place.face, s.place.x, weight);
                ruga_sheet_point(sheet, s.place.face, weight,
                                 s.place.x);  // on a curved surface its triangles moved
                take_vertex(sheet, &s.place); // one may have been made here, or moved here
            }
            if (count > 0 && is_repeat(sheet, &path->station[count - 1], &s)) {
                // Of the two, a vertex stays.
                path->station[count - 1] = s.place.vertex >= 0 ? s : path->station[count - 1];
            } else {
                path->station[count++] = s;
            }
        }
        path->count = count;
    }
}
