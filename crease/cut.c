// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The virtual node algorithm for a triangle mesh (Patkar, Jin and Fedkiw 2015, section 3; Molino, Bao and
// Fedkiw 2004), in five steps:
//   1  chords split each triangle into pieces, and the triangle is copied for each. Where a crease is to have
//      full freedom, auxiliary chords make every piece a triangle: the copies then have the freedom of a mesh
//      that conforms to the curve, and keep the shape of the old elements;
//   2  two copies that share a part of a mesh edge are glued at both ends of that edge;
//   3  all pieces that reach a mesh vertex share it. So a crease that goes through a vertex, or ends at one,
//      turns about it, which gives it freedom; the paper keeps cuts away from vertices. Only at a cut that
//      stays open are the pieces on its sides kept apart;
//   4  around an embedded node, the pieces that hold it see it between the copies of the edge's ends that
//      they are glued to: each different pair is a copy of the node. Copies that a crease (not an open cut)
//      keeps apart are to be one place, see sewing.h;
//   5  edges, creases and auxiliary chords are listed with the pieces beside them, for bending.
// Membrane and mass count with the part of the triangle's area that is the piece's material, bending with the
// part of the edge's length: then a cut changes neither.
#include "crease/cut.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

enum { MOST_AROUND = 2 * RUGA_MOST_PIECES }; // pieces around an embedded node

typedef struct cutter {
    const ruga_raster* raster;
    ruga_cut* cut;
    ruga_split* split; // [F]
    int* piece_start;  // [F + 1]
    ruga_copies copies;
    bool* open; // [V] whether a cut that stays open reaches a vertex
    int bend_capacity, segment_capacity, bound_capacity, copy_capacity, copy_count;
} cutter;

void ruga_cut_clear(ruga_cut* cut) {
    ruga_release(cut->source);
    ruga_release(cut->copy_start);
    ruga_release(cut->copy);
    ruga_release(cut->piece);
    ruga_release(cut->bend);
    ruga_release(cut->segment);
    ruga_release(cut->bound);
    ruga_release(cut->parent);
    ruga_release(cut->material_piece);
    ruga_mesh_clear(&cut->material);
    *cut = (ruga_cut){0};
}

void ruga_raster_nodes(const ruga_raster* r, int triangle, double node[3]) {
    for (int i = 0; i < 3; i++) {
        int e = r->edges.triangle_edge[triangle][i];
        bool forward = r->edges.edge[e][0] == r->mesh.triangle[3 * (size_t)triangle + (size_t)i];
        node[i] = r->node[e] > 0 && !forward ? 1 - r->node[e] : r->node[e];
    }
}

void ruga_raster_places(const ruga_raster* r, int triangle, double position[RUGA_BORDER_PLACES][3]) {
    double node[3], weight[3];
    ruga_raster_nodes(r, triangle, node);
    for (int place = 0; place < RUGA_BORDER_PLACES; place++) {
        ruga_place_weights(node, place, weight);
        memset(position[place], 0, sizeof position[place]);
        for (int i = 0; i < 3; i++) {
            int v = r->mesh.triangle[3 * (size_t)triangle + (size_t)i];
            ruga_add_scaled(weight[i], r->mesh.position + 3 * (size_t)v, position[place]);
        }
    }
}

int ruga_cut_vertex(const ruga_cut* cut, const ruga_cut_piece* piece, int place) {
    return place % 2 ? cut->real_count + piece->bound[place / 2] : piece->node[place / 2];
}

int ruga_cut_point(const ruga_cut* cut, const ruga_cut_piece* piece, int place, int node[2],
                   double weight[2]) {
    int i = place / 2, j = (i + 1) % 3;
    node[0] = piece->node[i];
    weight[0] = 1;
    if (place % 2 == 0) {
        return 1;
    }
    // weight[0] of a bound belongs to the lower vertex of its edge.
    const ruga_bound* bound = &cut->bound[piece->bound[i]];
    bool forward = cut->source[piece->node[i]] < cut->source[piece->node[j]];
    node[1] = piece->node[j];
    weight[0] = bound->weight[!forward];
    weight[1] = bound->weight[forward];
    return 2;
}

// ------------------------------------------------------------------------------- 1: pieces

static bool stays_open(const cutter* c, int own) {
    int curve = own >= 0 ? c->raster->chord[own].curve : -1;
    return curve >= 0 && c->raster->curve[curve].kind == RUGA_CREASE_CUT;
}

static ruga_status split_triangle(cutter* c, int f) {
    const ruga_raster* r = c->raster;
    ruga_split* split = &c->split[f];
    double node[3], position[RUGA_BORDER_PLACES][3];
    bool full = false;
    ruga_raster_nodes(r, f, node);
    ruga_split_start(node, split);
    for (int k = r->chord_start[f]; k < r->chord_start[f + 1]; k++) {
        const ruga_chord* chord = &r->chord[k];
        if (!ruga_split_add(split, chord->end[0], chord->end[1], k)) {
            const double* x = r->mesh.position + 3 * (size_t)r->mesh.triangle[3 * (size_t)f];
            return ruga_fail(RUGA_BAD_INPUT,
                             "crease curve %d crosses another one within face %d near (%.6g, %.6g, %.6g)",
                             chord->curve, f, x[0], x[1], x[2]);
        }
        full = full || chord->curve < 0 || r->facts[chord->curve].full;
    }
    if (full) {
        ruga_raster_places(r, f, position);
        ruga_split_fill(split, (const double(*)[3])position);
    }
    return RUGA_OK;
}

static ruga_status make_pieces(cutter* c) {
    const ruga_raster* r = c->raster;
    ruga_cut* cut = c->cut;
    RUGA_TRY(RUGA_NEW(c->split, r->mesh.triangle_count));
    RUGA_TRY(RUGA_NEW(c->piece_start, (size_t)r->mesh.triangle_count + 1));
    c->piece_start[0] = 0;
    for (int f = 0; f < r->mesh.triangle_count; f++) {
        RUGA_TRY(split_triangle(c, f));
        c->piece_start[f + 1] = c->piece_start[f] + c->split[f].piece_count;
    }
    cut->piece_count = c->piece_start[r->mesh.triangle_count];
    RUGA_TRY(RUGA_NEW(cut->piece, cut->piece_count));
    RUGA_TRY(ruga_copies_create(r->mesh.vertex_count, 3 * cut->piece_count, &c->copies));
    for (int f = 0; f < r->mesh.triangle_count; f++) {
        double node[3];
        ruga_raster_nodes(r, f, node);
        for (int k = 0; k < c->split[f].piece_count; k++) {
            int p = c->piece_start[f] + k;
            cut->piece[p] =
                (ruga_cut_piece){.triangle = f, .bound = {-1, -1, -1}, .polygon = c->split[f].piece[k]};
            double part = ruga_outline_fraction(&c->split[f].piece[k], node, cut->piece[p].middle);
            cut->piece[p].fraction = c->split[f].piece_count == 1 ? 1 : part;
            for (int i = 0; i < 3; i++) {
                c->copies.vertex[3 * p + i] = r->mesh.triangle[3 * (size_t)f + (size_t)i];
                c->copies.material[3 * p + i] = ruga_split_reaches(&c->split[f], k, 2 * i);
            }
        }
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- 2, 3: gluing

// The piece of triangle f to the left of the way between two of its places, -1 = none.
static int left_piece(const cutter* c, int f, int from, int to) {
    int k = ruga_split_left_of(&c->split[f], from, to);
    return k < 0 ? -1 : c->piece_start[f] + k;
}

// Corner of triangle f at a mesh vertex.
static int corner_at(const ruga_raster* r, int f, int v) {
    const int* t = r->mesh.triangle + 3 * (size_t)f;
    return t[0] == v ? 0 : t[1] == v ? 1 : 2;
}

// A part of an edge, from edge[0] on: all of it, or up to or from its embedded node.
typedef struct part {
    int piece[2];    // on both sides, -1 = none
    int place[2][2]; // [side][end]
    double from, to; // of the edge's length
} part;

static int parts_of_edge(const cutter* c, int e, part parts[2]) {
    const ruga_raster* r = c->raster;
    double node = r->node[e];
    int count = node > 0 ? 2 : 1;
    for (int k = 0; k < count; k++) {
        parts[k] = (part){.piece = {-1, -1}, .from = k ? node : 0, .to = count == 2 && k == 0 ? node : 1};
        for (int side = 0; side < 2; side++) {
            int f = r->edges.edge_triangle[e][side];
            if (f < 0) {
                continue;
            }
            // Side 0 runs edge[0] -> edge[1], side 1 the other way.
            int i = corner_at(r, f, r->edges.edge[e][side]), j = (2 * i + 2) % RUGA_BORDER_PLACES;
            int low = side == 0 ? 2 * i : j, high = side == 0 ? j : 2 * i, inner = 2 * i + 1;
            int* place = parts[k].place[side];
            place[0] = k == 1 ? inner : low;
            place[1] = count == 2 && k == 0 ? inner : high;
            parts[k].piece[side] = left_piece(c, f, place[side], place[1 - side]);
        }
    }
    return count;
}

static bool edge_stays_open(const ruga_raster* r, int e) {
    return r->crease[e] >= 0 && r->curve[r->crease[e]].kind == RUGA_CREASE_CUT;
}

static void glue_across_edge(cutter* c, int e) {
    part parts[2];
    int count = parts_of_edge(c, e, parts);
    for (int k = 0; k < count && !edge_stays_open(c->raster, e); k++) {
        const int* p = parts[k].piece;
        for (int end = 0; end < 2 && p[0] >= 0 && p[1] >= 0; end++) {
            int v = c->raster->edges.edge[e][end];
            ruga_copies_glue(&c->copies, 3 * p[0] + corner_at(c->raster, c->cut->piece[p[0]].triangle, v),
                             3 * p[1] + corner_at(c->raster, c->cut->piece[p[1]].triangle, v));
        }
    }
}

static ruga_status mark_open_vertices(cutter* c) {
    const ruga_raster* r = c->raster;
    RUGA_TRY(RUGA_NEW_ZERO(c->open, r->mesh.vertex_count));
    for (int e = 0; e < r->edges.edge_count; e++) {
        for (int end = 0; end < 2 && edge_stays_open(r, e); end++) {
            c->open[r->edges.edge[e][end]] = true;
        }
    }
    for (int k = 0; k < r->chord_count; k++) {
        for (int end = 0; end < 2 && stays_open(c, k); end++) {
            int place = r->chord[k].end[end];
            if (place % 2 == 0) {
                c->open[r->mesh.triangle[3 * (size_t)r->chord[k].triangle + (size_t)(place / 2)]] = true;
            }
        }
    }
    return RUGA_OK;
}

// Pieces on both sides of a chord from a corner, at a vertex that an open cut reaches.
static void glue_across_chords(cutter* c, int f) {
    const ruga_split* split = &c->split[f];
    for (int k = 0; k < split->chord_count; k++) {
        int left = left_piece(c, f, split->chord[k][0], split->chord[k][1]);
        int right = left_piece(c, f, split->chord[k][1], split->chord[k][0]);
        for (int end = 0; end < 2 && !stays_open(c, split->own[k]); end++) {
            int place = split->chord[k][end];
            if (place % 2 == 0) {
                ruga_copies_glue(&c->copies, 3 * left + place / 2, 3 * right + place / 2);
            }
        }
    }
}

static ruga_status glue(cutter* c) {
    const ruga_raster* r = c->raster;
    int* first = NULL;
    RUGA_TRY(mark_open_vertices(c));
    for (int e = 0; e < r->edges.edge_count; e++) {
        glue_across_edge(c, e);
    }
    for (int f = 0; f < r->mesh.triangle_count; f++) {
        glue_across_chords(c, f);
    }
    RUGA_TRY(RUGA_NEW(first, r->mesh.vertex_count));
    memset(first, -1, (size_t)r->mesh.vertex_count * sizeof *first);
    for (int s = 0; s < c->copies.slot_count; s++) {
        int v = c->copies.vertex[s];
        if (c->copies.material[s] && !c->open[v]) {
            if (first[v] >= 0) {
                ruga_copies_glue(&c->copies, first[v], s);
            } else {
                first[v] = s;
            }
        }
    }
    ruga_release(first);
    return ruga_copies_number(&c->copies);
}

static void take_numbers(cutter* c) {
    ruga_cut* cut = c->cut;
    cut->node_count = c->copies.node_count;
    cut->real_count = c->copies.real_count;
    cut->vertex_count = c->copies.vertex_count;
    cut->source = c->copies.source;
    cut->copy_start = c->copies.copy_start;
    cut->copy = c->copies.copy;
    c->copies.source = c->copies.copy_start = c->copies.copy = NULL;
    for (int p = 0; p < cut->piece_count; p++) {
        memcpy(cut->piece[p].node, c->copies.node + 3 * (size_t)p, sizeof cut->piece[p].node);
    }
}

// ------------------------------------------------------------------------------- 4: embedded nodes

// The pieces around an embedded node, and which of them are one material place.
typedef struct ring {
    int count;
    int piece[MOST_AROUND];
    int inner[MOST_AROUND]; // i of its place 2 i + 1 in that piece's triangle
    int root[MOST_AROUND];
} ring;

static void join(ring* r, int a, int b) {
    int from = r->root[a] > r->root[b] ? r->root[a] : r->root[b], to = r->root[a] + r->root[b] - from;
    for (int i = 0; i < r->count; i++) {
        r->root[i] = r->root[i] == from ? to : r->root[i];
    }
}

// Whether the chord of triangle f between two places stays open.
static bool chord_stays_open(const cutter* c, int f, int a, int b) {
    const ruga_split* s = &c->split[f];
    for (int k = 0; k < s->chord_count; k++) {
        if ((s->chord[k][0] == a && s->chord[k][1] == b) || (s->chord[k][0] == b && s->chord[k][1] == a)) {
            return stays_open(c, s->own[k]);
        }
    }
    return false;
}

// Appends the pieces of triangle f around its place 2 i + 1, from the side of corner i to that of corner i
// + 1.
static void walk_around(const cutter* c, int f, int i, ring* r) {
    int at = 2 * i + 1, from = 2 * i, last = (2 * i + 2) % RUGA_BORDER_PLACES;
    for (bool first = true; from != last && r->count < MOST_AROUND; first = false) {
        int p = left_piece(c, f, from, at);
        if (p < 0) {
            return;
        }
        int n = r->count++;
        r->piece[n] = p;
        r->inner[n] = i;
        r->root[n] = n;
        if (!first && !chord_stays_open(c, f, from, at)) {
            join(r, n - 1, n);
        }
        const ruga_outline* polygon = &c->cut->piece[p].polygon;
        for (int k = 0; k < polygon->count; k++) {
            if (polygon->place[k] == at) {
                from = polygon->place[(k + 1) % polygon->count];
                break;
            }
        }
    }
}

static ruga_status add_copy(cutter* c, ruga_bound* bound, const int parent[2]) {
    for (int k = bound->first; k < c->copy_count; k++) {
        if (c->cut->parent[k][0] == parent[0] && c->cut->parent[k][1] == parent[1]) {
            return RUGA_OK;
        }
    }
    RUGA_TRY(RUGA_RESERVE(c->cut->parent, c->copy_capacity, (size_t)c->copy_count + 1));
    memcpy(c->cut->parent[c->copy_count++], parent, sizeof c->cut->parent[0]);
    bound->count++;
    return RUGA_OK;
}

static ruga_status add_bounds(cutter* c, int e, const ring* r) {
    const int* ends = c->raster->edges.edge[e];
    double place = c->raster->node[e];
    for (int root = 0; root < r->count; root++) {
        if (r->root[root] != root) {
            continue;
        }
        ruga_bound bound = {.edge = e, .weight = {1 - place, place}, .first = c->copy_count};
        for (int k = root; k < r->count; k++) {
            if (r->root[k] != root) {
                continue;
            }
            ruga_cut_piece* piece = &c->cut->piece[r->piece[k]];
            int i = r->inner[k], a = corner_at(c->raster, piece->triangle, ends[0]);
            int b = corner_at(c->raster, piece->triangle, ends[1]);
            piece->bound[i] = c->cut->bound_count;
            RUGA_TRY(add_copy(c, &bound, (const int[2]){piece->node[a], piece->node[b]}));
        }
        RUGA_TRY(RUGA_RESERVE(c->cut->bound, c->bound_capacity, (size_t)c->cut->bound_count + 1));
        c->cut->bound[c->cut->bound_count++] = bound;
    }
    return RUGA_OK;
}

static ruga_status find_bounds(cutter* c) {
    const ruga_raster* r = c->raster;
    for (int e = 0; e < r->edges.edge_count; e++) {
        if (!(r->node[e] > 0)) {
            continue;
        }
        ring around = {0};
        int begin[2] = {0, 0}, end[2] = {0, 0};
        for (int side = 0; side < 2; side++) {
            int f = r->edges.edge_triangle[e][side];
            begin[side] = around.count;
            if (f >= 0) {
                walk_around(c, f, corner_at(r, f, r->edges.edge[e][side]), &around);
            }
            end[side] = around.count;
        }
        if (begin[0] < end[0] && begin[1] < end[1] && !edge_stays_open(r, e)) {
            join(&around, begin[0], end[1] - 1);
            join(&around, end[0] - 1, begin[1]);
        }
        RUGA_TRY(add_bounds(c, e, &around));
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- 5: bending

static ruga_status add_segment(cutter* c, ruga_segment segment) {
    ruga_cut* cut = c->cut;
    double x[2][3], position[RUGA_BORDER_PLACES][3];
    const ruga_cut_piece* left = &cut->piece[segment.piece[0]];
    ruga_raster_places(c->raster, left->triangle, position);
    for (int end = 0; end < 2; end++) {
        segment.end[end] = ruga_cut_vertex(cut, left, segment.place[0][end]);
        memcpy(x[end], position[segment.place[0][end]], sizeof x[end]);
    }
    segment.length = ruga_distance(x[0], x[1]);
    RUGA_TRY(RUGA_RESERVE(cut->segment, c->segment_capacity, (size_t)cut->segment_count + 1));
    cut->segment[cut->segment_count++] = segment;
    return RUGA_OK;
}

static ruga_status add_edge_part(cutter* c, int e, const part* p) {
    const ruga_raster* r = c->raster;
    ruga_cut* cut = c->cut;
    if (r->crease[e] < 0) {
        RUGA_TRY(RUGA_RESERVE(cut->bend, c->bend_capacity, (size_t)cut->bend_count + 1));
        cut->bend[cut->bend_count++] = (ruga_bend){e, {p->piece[0], p->piece[1]}, p->to - p->from};
        return RUGA_OK;
    }
    if (edge_stays_open(r, e)) {
        return RUGA_OK;
    }
    ruga_segment segment = {.curve = r->crease[e], .piece = {p->piece[0], p->piece[1]}};
    memcpy(segment.place, p->place, sizeof segment.place);
    const double* along = r->crease_along[e];
    segment.along[0] = along[0] + p->from * (along[1] - along[0]);
    segment.along[1] = along[0] + p->to * (along[1] - along[0]);
    return add_segment(c, segment);
}

static ruga_status add_chord_segments(cutter* c, int f) {
    const ruga_split* split = &c->split[f];
    for (int k = 0; k < split->chord_count; k++) {
        if (stays_open(c, split->own[k])) {
            continue;
        }
        int from = split->chord[k][0], to = split->chord[k][1];
        ruga_segment segment = {.curve = -1,
                                .piece = {left_piece(c, f, from, to), left_piece(c, f, to, from)},
                                .place = {{from, to}, {from, to}}};
        if (split->own[k] >= 0) {
            const ruga_chord* chord = &c->raster->chord[split->own[k]];
            segment.curve = chord->curve;
            memcpy(segment.along, chord->along, sizeof segment.along);
        }
        RUGA_TRY(add_segment(c, segment));
    }
    return RUGA_OK;
}

static ruga_status list_bending(cutter* c) {
    const ruga_raster* r = c->raster;
    for (int e = 0; e < r->edges.edge_count; e++) {
        part parts[2];
        int count = parts_of_edge(c, e, parts);
        for (int k = 0; k < count; k++) {
            if (parts[k].piece[0] >= 0 && parts[k].piece[1] >= 0) {
                RUGA_TRY(add_edge_part(c, e, &parts[k]));
            }
        }
    }
    for (int f = 0; f < r->mesh.triangle_count; f++) {
        RUGA_TRY(add_chord_segments(c, f));
    }
    return RUGA_OK;
}

ruga_status ruga_cut_create(const ruga_raster* raster, ruga_cut* cut) {
    ruga_status status = RUGA_OK;
    *cut = (ruga_cut){0};
    cutter c = {.raster = raster, .cut = cut};
    RUGA_TRY_DONE(make_pieces(&c));
    RUGA_TRY_DONE(glue(&c));
    take_numbers(&c);
    RUGA_TRY_DONE(find_bounds(&c));
    RUGA_TRY_DONE(list_bending(&c));
    RUGA_TRY_DONE(ruga_cut_make_material(raster, cut));
done:
    ruga_release(c.split);
    ruga_release(c.piece_start);
    ruga_release(c.open);
    ruga_copies_clear(&c.copies);
    if (status != RUGA_OK) {
        ruga_cut_clear(cut);
    }
    return status;
}

// ------------------------------------------------------------------------------- positions

void ruga_cut_rest(const ruga_raster* raster, const ruga_cut* cut, double* x) {
    for (int n = 0; n < cut->node_count; n++) {
        memcpy(x + 3 * (size_t)n, raster->mesh.position + 3 * (size_t)cut->source[n], 3 * sizeof *x);
    }
}

static void copy_position(const ruga_cut* cut, const ruga_bound* b, int k, const double* x, double at[3]) {
    const int* parent = cut->parent[b->first + k];
    memset(at, 0, 3 * sizeof *at);
    ruga_add_scaled(b->weight[0], x + 3 * (size_t)parent[0], at);
    ruga_add_scaled(b->weight[1], x + 3 * (size_t)parent[1], at);
}

void ruga_cut_material(const ruga_cut* cut, const double* x, double* material) {
    memcpy(material, x, 3 * (size_t)cut->real_count * sizeof *x);
    for (int i = 0; i < cut->bound_count; i++) {
        const ruga_bound* b = &cut->bound[i];
        double* to = material + 3 * (size_t)(cut->real_count + i);
        memset(to, 0, 3 * sizeof *to);
        for (int k = 0; k < b->count; k++) {
            double at[3];
            copy_position(cut, b, k, x, at);
            ruga_add_scaled(1.0 / b->count, at, to);
        }
    }
}

double ruga_cut_gap_at(const ruga_cut* cut, int vertex, const double* x) {
    if (vertex < cut->real_count) {
        return 0;
    }
    const ruga_bound* b = &cut->bound[vertex - cut->real_count];
    double gap = 0, first[3], at[3];
    copy_position(cut, b, 0, x, first);
    for (int k = 1; k < b->count; k++) {
        copy_position(cut, b, k, x, at);
        gap = fmax(gap, ruga_distance(first, at));
    }
    return gap;
}

double ruga_cut_gap(const ruga_cut* cut, const double* x) {
    double gap = 0;
    for (int i = 0; i < cut->bound_count; i++) {
        gap = fmax(gap, ruga_cut_gap_at(cut, cut->real_count + i, x));
    }
    return gap;
}

void ruga_cut_masses(const ruga_cut* cut, const double* triangle_mass, double least, bool centred,
                     double* mass) {
    memset(mass, 0, (size_t)cut->node_count * sizeof *mass);
    for (int p = 0; p < cut->piece_count; p++) {
        const ruga_cut_piece* piece = &cut->piece[p];
        double more = fmax(least - piece->fraction, 0) / 3;
        for (int i = 0; i < 3; i++) {
            double share = centred ? piece->middle[i] : 1.0 / 3;
            mass[piece->node[i]] += (piece->fraction * share + more) * triangle_mass[piece->triangle];
        }
    }
}
