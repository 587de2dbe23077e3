// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Rasterisation of curves to a mesh (Patkar, Jin and Fedkiw 2015, section 3): mend.c makes rounds until the
// curves fit, here their hits become chords. An end inside the mesh is, with snap, a vertex. Without it the
// part within the last triangle is dropped and, where the last hit is on an inner edge, the curve is led on
// to the opposite vertex (figure 4): without that the two sides of the cut could not turn at all.
//
// Where curves of later stages can do with the mesh as it is mended for those before, it stays as it is: so
// it is without them. Where they need a vertex it is mended for all at once, which makes better triangles.
#include "crease/raster.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "crease/mend.h"

#include <limits.h>
#include <math.h>
#include <string.h>

static const double STRAIGHT = 1e-6; // edges: what is less off straight may be one hinge

ruga_raster_def ruga_default_raster_def(void) {
    return (ruga_raster_def){.snap = true,
                             .extend = true,
                             .corner = 20 * RUGA_PI / 180,
                             .reach = 0.1,
                             .merge = 0.02,
                             .rounds = 200,
                             .stage = INT_MAX};
}

void ruga_raster_clear(ruga_raster* raster) {
    ruga_mesh_clear(&raster->mesh);
    ruga_connectivity_clear(&raster->edges);
    ruga_release(raster->node);
    ruga_release(raster->chord);
    ruga_release(raster->chord_start);
    ruga_release(raster->crease);
    ruga_release(raster->crease_along);
    ruga_release(raster->curve);
    ruga_release(raster->facts);
    *raster = (ruga_raster){0};
}

// The last stage up to `stage` at which there are curves.
static int last_stage(const ruga_curves* curves, int stage) {
    int last = 0;
    for (int c = 0; c < curves->count; c++) {
        int own = curves->curve[c].stage;
        last = own > last && own <= stage ? own : last;
    }
    return last;
}

// ------------------------------------------------------------------------------- ends

// The vertex opposite the edge of a hit, on the side that the link through `face` does not come from.
static int vertex_beyond(const ruga_connectivity* c, const ruga_hit* h, int face) {
    int side = c->edge_triangle[h->edge][0] == face ? 1 : 0;
    return c->edge_triangle[h->edge][side] < 0 ? -1 : c->edge_opposite[h->edge][side];
}

static ruga_status extend_path(const ruga_sheet* sheet, ruga_path* path) {
    ruga_hits* hits = &path->hits;
    RUGA_TRY(RUGA_RESERVE(hits->hit, hits->capacity, (size_t)hits->count + 2));
    for (int end = 0; end < 2 && hits->count > 0; end++) {
        const ruga_station* station = &path->station[end == 0 ? 0 : path->count - 1];
        ruga_hit* h = end == 0 ? hits->hit : &hits->hit[hits->count - 1];
        if (station->place.vertex >= 0 || station->place.beyond || h->edge < 0) {
            continue;
        }
        int inner = end == 1 ? (hits->count > 1 ? h->face : -1) : hits->count > 1 ? hits->hit[1].face : -1;
        if (hits->count == 1) { // one hit only: both ends are beside it, the first one where it came from
            const int* f = sheet->edges.edge_triangle[h->edge];
            inner = end == 1 ? h->face : f[0] == h->face ? f[1] : f[0];
        }
        int v = vertex_beyond(&sheet->edges, h, inner);
        if (v < 0) {
            continue;
        }
        const int* f = sheet->edges.edge_triangle[h->edge];
        int face = f[0] == inner ? f[1] : f[0];
        ruga_hit tip = {.vertex = v, .edge = -1, .face = face, .stretch = h->stretch};
        if (end == 0) {
            memmove(hits->hit + 1, hits->hit, (size_t)hits->count * sizeof *hits->hit);
            hits->hit[0] = tip;
            hits->hit[0].face = -1;
            hits->hit[1].face = face;
        } else {
            hits->hit[hits->count] = tip;
        }
        hits->count++;
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- chords

// Place of a hit on the border of a triangle, as in ruga_chord; -1 = not there.
static int local_place(const ruga_raster* r, int f, const ruga_hit* h) {
    for (int i = 0; i < 3; i++) {
        if (h->vertex >= 0 ? h->vertex == r->mesh.triangle[3 * (size_t)f + (size_t)i]
                           : h->edge == r->edges.triangle_edge[f][i]) {
            return 2 * i + (h->vertex < 0);
        }
    }
    return -1;
}

typedef struct build {
    ruga_raster* raster;
    const ruga_sheet* sheet;
    int capacity;
    int* first_curve; // [V] path of the first link at a vertex, -1 = none
    int* links;       // [V] number of links
    int* node_links;  // [E] number of chords at an embedded node, on both sides
    int* node_curve;  // [E]
    int* head;        // [F] last chord of a triangle, -1 = none
    int* next;        // [chords] the one before it
    int next_capacity;
} build;

static void note_vertex(build* b, int v, int curve) {
    ruga_raster* r = b->raster;
    int first = b->first_curve[v];
    if (first >= 0 && (first != curve || b->links[v] >= 2)) {
        r->facts[first].meets = r->facts[curve].meets = true;
    }
    b->first_curve[v] = first < 0 ? curve : first;
    b->links[v]++;
}

static void note_node(build* b, int e, int curve) {
    ruga_raster* r = b->raster;
    int first = b->node_curve[e];
    if (first >= 0 && (first != curve || b->node_links[e] >= 2)) {
        r->facts[first].meets = r->facts[curve].meets = true;
    }
    b->node_curve[e] = first < 0 ? curve : first;
    b->node_links[e]++;
}

static void note_hit(build* b, const ruga_hit* h, int curve) {
    if (h->vertex >= 0) {
        note_vertex(b, h->vertex, curve);
    } else {
        note_node(b, h->edge, curve);
        b->raster->node[h->edge] = h->place;
    }
}

static bool is_new_chord(const build* b, int f, const int end[2]) {
    for (int k = b->head[f]; k >= 0; k = b->next[k]) {
        const int* other = b->raster->chord[k].end;
        if ((other[0] == end[0] && other[1] == end[1]) || (other[0] == end[1] && other[1] == end[0])) {
            return false;
        }
    }
    return true;
}

static ruga_status add_chord(build* b, ruga_chord chord) {
    ruga_raster* r = b->raster;
    RUGA_TRY(RUGA_RESERVE(r->chord, b->capacity, (size_t)r->chord_count + 1));
    RUGA_TRY(RUGA_RESERVE(b->next, b->next_capacity, (size_t)r->chord_count + 1));
    b->next[r->chord_count] = b->head[chord.triangle];
    b->head[chord.triangle] = r->chord_count;
    r->chord[r->chord_count++] = chord;
    return RUGA_OK;
}

// The link from the hit before h to h becomes a chord, or the crease of a mesh edge; a boundary edge is none,
// and what lies on an earlier curve is left to it.
static ruga_status add_link(build* b, const ruga_hit* h, int curve, const double along[2]) {
    ruga_raster* r = b->raster;
    ruga_curve_facts* facts = &r->facts[curve];
    const ruga_hit* g = h - 1;
    if (h->face >= 0) {
        int end[2] = {local_place(r, h->face, g), local_place(r, h->face, h)};
        RUGA_ASSERT(end[0] >= 0 && end[1] >= 0);
        if (!is_new_chord(b, h->face, end)) {
            facts->left += along[1] - along[0];
            return RUGA_OK;
        }
        RUGA_TRY(add_chord(b, (ruga_chord){h->face, {end[0], end[1]}, curve, {along[0], along[1]}}));
    } else {
        int e = ruga_edge_between(&r->edges, g->vertex, h->vertex);
        RUGA_ASSERT(e >= 0);
        if (r->crease[e] >= 0) {
            facts->left += along[1] - along[0];
        }
        if (r->edges.edge_triangle[e][0] < 0 || r->edges.edge_triangle[e][1] < 0 || r->crease[e] >= 0) {
            return RUGA_OK;
        }
        r->crease[e] = curve;
        int first = r->edges.edge[e][0] != g->vertex;
        r->crease_along[e][first] = along[0];
        r->crease_along[e][1 - first] = along[1];
    }
    facts->placed += along[1] - along[0];
    note_hit(b, g, curve);
    note_hit(b, h, curve);
    return RUGA_OK;
}

static ruga_status add_path(build* b, const ruga_path* path) {
    ruga_curve_facts* facts = &b->raster->facts[path->curve];
    const ruga_hits* hits = &path->hits;
    double before[3], at[3], next[3];
    for (int i = 0; i < hits->count; i++) {
        ruga_hit_position(b->sheet, &hits->hit[i], at);
        if (i > 0) {
            double along[2] = {facts->length, facts->length + ruga_distance(before, at)};
            facts->length = along[1];
            RUGA_TRY(add_link(b, &hits->hit[i], path->curve, along));
        }
        if (i > 0 && i + 1 < hits->count) {
            double u[3], v[3], c[3];
            ruga_hit_position(b->sheet, &hits->hit[i + 1], next);
            ruga_subtract(at, before, u);
            ruga_subtract(next, before, v);
            ruga_cross(u, v, c);
            facts->bent = facts->bent || ruga_norm(c) > STRAIGHT * b->sheet->edge * ruga_norm(v);
        }
        memcpy(before, at, sizeof before);
    }
    facts->hits += hits->count;
    return RUGA_OK;
}

// Sorted by triangle, the order within a triangle kept.
static ruga_status sort_chords(ruga_raster* r) {
    ruga_chord* sorted = NULL;
    int* start = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(r->chord_start, (size_t)r->mesh.triangle_count + 1));
    RUGA_TRY(RUGA_NEW(sorted, r->chord_count));
    start = r->chord_start;
    for (int k = 0; k < r->chord_count; k++) {
        start[r->chord[k].triangle]++;
    }
    for (int f = 0; f < r->mesh.triangle_count; f++) {
        start[f + 1] += start[f];
    }
    for (int k = r->chord_count - 1; k >= 0; k--) {
        sorted[--start[r->chord[k].triangle]] = r->chord[k];
    }
    ruga_release(r->chord);
    r->chord = sorted;
    return RUGA_OK;
}

static void decide_freedom(ruga_raster* r) {
    for (int c = 0; c < r->curve_count; c++) {
        const ruga_curve* curve = &r->curve[c];
        ruga_curve_facts* f = &r->facts[c];
        f->full =
            curve->freedom == RUGA_FREEDOM_FULL ||
            (curve->freedom == RUGA_FREEDOM_AUTO && (f->bent || f->meets || curve->closed || curve->varies));
    }
}

// Of the curves up to a stage.
static ruga_status build_chords(build* b, const ruga_paths* paths, const ruga_curves* curves, int stage) {
    ruga_raster* r = b->raster;
    int vertices = r->mesh.vertex_count, edges = r->edges.edge_count;
    r->curve_count = curves->count;
    RUGA_TRY(RUGA_NEW_ZERO(r->node, edges));
    RUGA_TRY(RUGA_NEW(r->crease, edges));
    RUGA_TRY(RUGA_NEW_ZERO(r->crease_along, edges));
    RUGA_TRY(RUGA_NEW(r->curve, curves->count));
    RUGA_TRY(RUGA_NEW_ZERO(r->facts, curves->count));
    RUGA_TRY(RUGA_NEW(b->first_curve, vertices));
    RUGA_TRY(RUGA_NEW_ZERO(b->links, vertices));
    RUGA_TRY(RUGA_NEW_ZERO(b->node_links, edges));
    RUGA_TRY(RUGA_NEW(b->node_curve, edges));
    RUGA_TRY(RUGA_NEW(b->head, r->mesh.triangle_count));
    memset(b->head, -1, (size_t)r->mesh.triangle_count * sizeof *b->head);
    memset(r->crease, -1, (size_t)edges * sizeof *r->crease);
    memset(b->node_curve, -1, (size_t)edges * sizeof *b->node_curve);
    memset(b->first_curve, -1, (size_t)vertices * sizeof *b->first_curve);
    for (int c = 0; c < curves->count; c++) {
        r->curve[c] = curves->curve[c];
        r->curve[c].point = NULL;
        r->curve[c].vertex = NULL;
    }
    for (int pass = 0; pass < 2; pass++) { // cuts first: where a fold lies on one, it is cut
        for (int s = 0; s <= last_stage(curves, stage); s++) { // and then what came first
            for (int p = 0; p < paths->count; p++) {
                const ruga_curve* curve = &r->curve[paths->path[p].curve];
                if ((curve->kind == RUGA_CREASE_CUT) == (pass == 0) && curve->stage == s) {
                    RUGA_TRY(add_path(b, &paths->path[p]));
                }
            }
        }
    }
    decide_freedom(r);
    return sort_chords(r);
}

static void clear_build(build* b) {
    ruga_release(b->first_curve);
    ruga_release(b->links);
    ruga_release(b->node_links);
    ruga_release(b->node_curve);
    ruga_release(b->head);
    ruga_release(b->next);
    *b = (build){0};
}

// ------------------------------------------------------------------------------- stages

// The chord of triangle f between the places of `chord`, -1 = none.
static int same_chord(const ruga_raster* r, int f, const ruga_chord* chord) {
    for (int k = r->chord_start[f]; k < r->chord_start[f + 1]; k++) {
        const int* end = r->chord[k].end;
        if ((end[0] == chord->end[0] && end[1] == chord->end[1]) ||
            (end[0] == chord->end[1] && end[1] == chord->end[0])) {
            return k;
        }
    }
    return -1;
}

static bool is_full(const ruga_raster* r, int f) {
    for (int k = r->chord_start[f]; k < r->chord_start[f + 1]; k++) {
        if (r->facts[r->chord[k].curve].full) {
            return true;
        }
    }
    return false;
}

// A stage of `whole`, which has all curves: freedom is that of the whole, and a triangle that auxiliary
// chords divide is divided as there from the first, so that what is cut later lies within a piece of what is
// cut now.
static ruga_status take_stage(const ruga_raster* whole, ruga_raster* r) {
    ruga_chord* chord = NULL;
    int *start = NULL, count = 0;
    memcpy(r->facts, whole->facts, (size_t)r->curve_count * sizeof *r->facts);
    RUGA_TRY(RUGA_NEW(chord, whole->chord_count + r->chord_count));
    ruga_status status = RUGA_NEW(start, (size_t)r->mesh.triangle_count + 1);
    if (status != RUGA_OK) {
        ruga_release(chord);
        return status;
    }
    for (int f = 0; f < r->mesh.triangle_count; f++) {
        const ruga_raster* from = is_full(r, f) ? whole : r;
        start[f] = count;
        for (int k = from->chord_start[f]; k < from->chord_start[f + 1]; k++) {
            ruga_chord* to = &chord[count++];
            int own = same_chord(r, f, &from->chord[k]);
            *to = own >= 0 ? r->chord[own] : from->chord[k];
            to->curve = own >= 0 ? to->curve : -1;
            for (int end = 0; end < 2; end++) {
                int e = r->edges.triangle_edge[f][to->end[end] / 2];
                r->node[e] = to->end[end] % 2 ? whole->node[e] : r->node[e];
            }
        }
    }
    start[r->mesh.triangle_count] = count;
    ruga_release(r->chord);
    ruga_release(r->chord_start);
    r->chord = chord;
    r->chord_count = count;
    r->chord_start = start;
    return RUGA_OK;
}

typedef struct fitted {
    ruga_sheet sheet;
    ruga_paths paths;
    ruga_mend mend;
    int rounds;
} fitted;

static void clear_fitted(fitted* f) {
    ruga_mend_clear(&f->mend);
    ruga_paths_clear(&f->paths);
    ruga_sheet_clear(&f->sheet);
    *f = (fitted){0};
}

static int count_splits(const fitted* f) {
    return f->mend.split_edges + f->mend.split_faces;
}

// Mends the sheet for the curves from one stage to another.
static ruga_status fit_stages(const ruga_curves* curves, const int stages[2], const ruga_raster_def* def,
                              fitted* f) {
    bool fits = false;
    RUGA_TRY(ruga_paths_add(&f->sheet, curves, stages, def->snap, def->corner, &f->paths));
    for (int k = 0; !fits && k < def->rounds; k++, f->rounds++) {
        RUGA_TRY(ruga_mend_round(&f->mend, &fits));
    }
    return fits ? RUGA_OK : ruga_mend_give_up(&f->mend);
}

static ruga_status start_fit(const ruga_mesh* mesh, const ruga_raster_def* def, fitted* f) {
    clear_fitted(f);
    f->mend = (ruga_mend){.sheet = &f->sheet, .paths = &f->paths, .def = def};
    return ruga_sheet_create(mesh, &f->sheet);
}

static ruga_status fit(const ruga_mesh* mesh, const ruga_curves* curves, const ruga_raster_def* def,
                       bool apart, fitted* f) {
    int last = last_stage(curves, INT_MAX);
    RUGA_TRY(start_fit(mesh, def, f));
    RUGA_TRY(fit_stages(curves, (const int[2]){0, apart ? 0 : last}, def, f));
    int splits = count_splits(f);
    for (int s = 1; s <= last && apart; s++) {
        memset(f->sheet.pinned, true, (size_t)f->sheet.mesh.vertex_count * sizeof *f->sheet.pinned);
        ruga_status status = fit_stages(curves, (const int[2]){s, s}, def, f);
        if (status == RUGA_BAD_INPUT || (status == RUGA_OK && count_splits(f) > splits)) {
            RUGA_TRY(start_fit(mesh, def, f));
            return fit_stages(curves, (const int[2]){0, last}, def, f);
        }
        RUGA_TRY(status);
    }
    return RUGA_OK;
}

// Whether a later curve has auxiliary chords near a vertex.
static bool makes_slivers(const ruga_raster* r, const ruga_raster_def* def) {
    for (int k = 0; k < r->chord_count; k++) {
        const ruga_chord* chord = &r->chord[k];
        for (int end = 0; end < 2 && r->curve[chord->curve].stage > 0 && r->facts[chord->curve].full; end++) {
            double node = r->node[r->edges.triangle_edge[chord->triangle][chord->end[end] / 2]];
            if (chord->end[end] % 2 && fmin(node, 1 - node) < def->reach) {
                return true;
            }
        }
    }
    return false;
}

// Mended stage for stage where `apart`; *thin is SET where it is better not to.
static ruga_status create(const ruga_mesh* mesh, const ruga_curves* curves, const ruga_raster_def* def,
                          bool apart, ruga_raster* raster, bool* thin) {
    ruga_status status = RUGA_OK;
    *raster = (ruga_raster){0};
    ruga_raster whole = {0};
    fitted f = {0};
    ruga_sheet drawn;
    build b = {.raster = raster};
    RUGA_TRY_DONE(fit(mesh, curves, def, apart, &f));
    for (int p = 0; p < f.paths.count && def->extend; p++) {
        RUGA_TRY_DONE(extend_path(&f.sheet, &f.paths.path[p]));
    }
    if (!def->snap && def->extend) {
        RUGA_TRY_DONE(ruga_mend_check(&f.mend));
    }
    raster->mesh = f.sheet.mesh;
    raster->edges = f.sheet.edges;
    f.sheet.mesh = (ruga_mesh){0};
    f.sheet.edges = (ruga_connectivity){0};
    drawn = (ruga_sheet){.mesh = raster->mesh, .edges = raster->edges, .edge = f.sheet.edge};
    b.sheet = &drawn;
    RUGA_TRY_DONE(build_chords(&b, &f.paths, curves, def->stage));
    *thin = makes_slivers(raster, def);
    if (last_stage(curves, INT_MAX) > def->stage) {
        clear_build(&b);
        whole = (ruga_raster){.mesh = raster->mesh, .edges = raster->edges}; // lent
        b = (build){.raster = &whole, .sheet = &drawn};
        RUGA_TRY_DONE(build_chords(&b, &f.paths, curves, INT_MAX));
        *thin = makes_slivers(&whole, def);
        RUGA_TRY_DONE(take_stage(&whole, raster));
    }
    raster->moved = f.mend.moved;
    raster->split_edges = f.mend.split_edges;
    raster->split_faces = f.mend.split_faces;
    raster->rounds = f.rounds;
done:
    clear_build(&b);
    whole.mesh = (ruga_mesh){0};
    whole.edges = (ruga_connectivity){0};
    ruga_raster_clear(&whole);
    clear_fitted(&f);
    if (status != RUGA_OK) {
        ruga_raster_clear(raster);
    }
    return status;
}

ruga_status ruga_raster_create(const ruga_mesh* mesh, const ruga_curves* curves, const ruga_raster_def* def,
                               ruga_raster* raster) {
    bool thin = false;
    RUGA_TRY(create(mesh, curves, def, true, raster, &thin));
    if (thin) {
        ruga_raster_clear(raster);
        RUGA_TRY(create(mesh, curves, def, false, raster, &thin));
    }
    return RUGA_OK;
}
