// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// From curves to hinges, rows and parts of triangles.
//
// Shares. With f the part of a triangle of area A that is a piece's material, and m_i the weights of that
// material's middle, the integral of corner i's shape function over the piece is f A m_i. Over the pieces of
// a triangle these add up to A / 3: so areas, masses and weights of averages are shared out among the copies
// of a vertex without loss. The membrane counts with max(f, 0.01), so that nothing is left without stiffness.
#include "solver/creases.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "shell/bending.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double LEAST_FRACTION = 0.01;
static const double RIGID = 1e3; // E h times a mean edge
static const double ON_A_FRAME = 1e-9;

void ruga_creases_destroy(ruga_creases** creases) {
    ruga_creases* c = *creases;
    if (!c) {
        return;
    }
    for (int i = 0; i < c->law_count; i++) {
        ruga_release(c->law[i].keys);
        ruga_release(c->law[i].name);
    }
    ruga_raster_clear(&c->raster);
    ruga_cut_clear(&c->cut);
    ruga_sewing_clear(&c->sewing);
    ruga_connectivity_clear(&c->shown);
    void* const owned[] = {c->law,  c->segment, c->hinge,    c->stiffness, c->drawn, c->rest,     c->area,
                           c->share, c->fraction, c->mass, c->bend,      c->pair,  c->steepness};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    ruga_release(c);
    *creases = NULL;
}

// ---- checks --------------------------------------------------------------------------------------------

static ruga_status check_values(int index, const char* field, int count, const double* values,
                                bool negative) {
    for (int i = 0; i < count && values; i++) {
        if (!isfinite(values[i]) || (!negative && values[i] < 0)) {
            return ruga_fail(RUGA_BAD_INPUT, "creases.%d.%s is %g at point %d; it must be %s", index, field,
                             values[i], i, negative ? "finite" : "0 or above");
        }
    }
    return RUGA_OK;
}

static ruga_status check_def(int index, const ruga_crease_def* def) {
    int points = def->path == RUGA_CREASE_EDGES ? def->vertex_count : def->point_count;
    RUGA_TRY(check_values(index, "point_stiffness", points, def->point_stiffness, false));
    RUGA_TRY(check_values(index, "point_rest", points, def->point_rest, true));
    if (def->path == RUGA_CREASE_GROUP && (def->point_stiffness || def->point_rest)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "creases.%d: the border of a group takes one value, not one for each point", index);
    }
    if (!(def->stiffness >= 0) || !isfinite(def->stiffness)) {
        return ruga_fail(RUGA_BAD_INPUT, "creases.%d.stiffness is %g; it must be 0 or above", index,
                         def->stiffness);
    }
    if (!isfinite(def->start)) {
        return ruga_fail(RUGA_BAD_INPUT, "creases.%d.start is not finite", index);
    }
    if (isinf(def->rest)) {
        return ruga_fail(RUGA_BAD_INPUT, "creases.%d.rest is not finite", index);
    }
    if (!(def->yield >= 0) || !(def->rate > 0) || !(def->hardening >= 0) || isinf(def->hardening)) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "creases.%d has yield %g, rate %g, hardening %g; they must be at least 0, above 0, at least 0",
            index, def->yield, def->rate, def->hardening);
    }
    for (int k = 0; k < def->key_count; k++) {
        const ruga_crease_key* key = &def->keys[k];
        if (!isfinite(key->time) || !isfinite(key->angle) || !isfinite(key->scale) ||
            (k > 0 && !(key->time > key[-1].time))) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "creases.%d: key %d at %g s is not finite, or not later than the one before",
                             index, k, key->time);
        }
    }
    return RUGA_OK;
}

static ruga_status copy_law(const ruga_crease_def* def, ruga_crease_law* law) {
    *law = (ruga_crease_law){
        .yield = def->yield, .rate = def->rate, .hardening = def->hardening, .assignment = def->assignment};
    RUGA_TRY(RUGA_NEW(law->keys, def->key_count));
    for (int k = 0; k < def->key_count; k++) {
        law->keys[k] = def->keys[k];
    }
    law->key_count = def->key_count;
    law->name = ruga_copy_string(def->name ? def->name : "");
    return law->name ? RUGA_OK : ruga_fail(RUGA_NO_MEMORY, "out of memory: the name of a crease");
}

// ---- curves --------------------------------------------------------------------------------------------

static bool varies(int count, const double* values) {
    for (int i = 1; i < count && values; i++) {
        if (values[i] != values[0]) {
            return true;
        }
    }
    return false;
}

static ruga_status add_curve(int index, const ruga_crease_def* def, int stage, const ruga_mesh* mesh,
                             const ruga_connectivity* edges, ruga_curves* curves) {
    int points = def->path == RUGA_CREASE_EDGES ? def->vertex_count : def->point_count;
    const ruga_curve style = {.kind = def->kind,
                              .freedom = def->freedom,
                              .varies =
                                  varies(points, def->point_rest) || varies(points, def->point_stiffness),
                              .closed = def->closed,
                              .label = index,
                              .stage = stage};
    switch (def->path) {
    case RUGA_CREASE_UV:
        return ruga_curves_add_uv(curves, &style, mesh, points, (const double(*)[2])def->points);
    case RUGA_CREASE_EDGES:
        return ruga_curves_add_path(curves, &style, mesh, edges, points, def->vertices);
    case RUGA_CREASE_GROUP:
        return ruga_curves_add_border(curves, &style, mesh, edges, def->group ? def->group : "");
    default:
        return ruga_curves_add_polyline(curves, &style, points, (const double(*)[3])def->points);
    }
}

static ruga_status add_curves(int count, const ruga_crease_def* defs, const int* stage, const ruga_mesh* mesh,
                              const ruga_connectivity* edges, ruga_creases* c, ruga_curves* curves) {
    for (int i = 0; i < count; i++) {
        RUGA_TRY(check_def(i, &defs[i]));
        c->law_count = i + 1;
        RUGA_TRY(copy_law(&defs[i], &c->law[i]));
        ruga_status status = add_curve(i, &defs[i], stage[i], mesh, edges, curves);
        if (status != RUGA_OK) {
            return status == RUGA_BAD_INPUT ? ruga_fail_prefix(status, "creases.%d", i) : status;
        }
    }
    return RUGA_OK;
}

static double frames_to(double start, double step) {
    double frames = start / step, whole = round(frames);
    return fabs(frames - whole) <= ON_A_FRAME * fmax(whole, 1) ? whole : frames;
}

int ruga_creases_stages(int count, const ruga_crease_def* defs, double step, int* stage, double* end) {
    int stages = 0;
    memset(stage, 0, (size_t)count * sizeof *stage);
    for (double last = 0;; stages++) {
        double next = INFINITY;
        for (int i = 0; i < count; i++) {
            double own = frames_to(defs[i].start, step);
            stage[i] += own > last;
            next = own > last ? fmin(next, own) : next;
        }
        if (isinf(next)) {
            return stages;
        }
        last = end[stages] = next;
    }
}

// ---- pieces --------------------------------------------------------------------------------------------

static ruga_status set_pieces(ruga_creases* c) {
    const ruga_cut* cut = &c->cut;
    RUGA_TRY(RUGA_NEW_ZERO(c->area, cut->node_count));
    RUGA_TRY(RUGA_NEW_ZERO(c->share, cut->node_count));
    RUGA_TRY(RUGA_NEW(c->fraction, cut->piece_count));
    RUGA_TRY(RUGA_NEW(c->mass, cut->piece_count));
    for (int p = 0; p < cut->piece_count; p++) {
        const ruga_cut_piece* piece = &cut->piece[p];
        double area = ruga_mesh_triangle_area(&c->raster.mesh, piece->triangle);
        c->fraction[p] = fmax(piece->fraction, LEAST_FRACTION);
        for (int i = 0; i < 3; i++) {
            c->mass[p][i] = piece->fraction * piece->middle[i];
            c->area[piece->node[i]] += area * c->mass[p][i];
        }
    }
    for (int v = 0; v < cut->vertex_count; v++) {
        double sum = 0;
        for (int k = cut->copy_start[v]; k < cut->copy_start[v + 1]; k++) {
            sum += c->area[cut->copy[k]];
        }
        for (int k = cut->copy_start[v]; k < cut->copy_start[v + 1]; k++) {
            c->share[cut->copy[k]] = sum > 0 ? c->area[cut->copy[k]] / sum : 0;
        }
    }
    return RUGA_OK;
}

static ruga_status set_bends(ruga_creases* c) {
    const ruga_cut* cut = &c->cut;
    RUGA_TRY(RUGA_NEW(c->bend, cut->bend_count));
    for (int b = 0; b < cut->bend_count; b++) {
        const ruga_bend* from = &cut->bend[b];
        const int* ends = c->raster.edges.edge[from->edge];
        c->bend[b] =
            (ruga_shell_bend){.triangle = {from->piece[0], from->piece[1]}, .fraction = from->fraction};
        for (int side = 0; side < 2; side++) {
            for (int i = 0; i < 3; i++) {
                int node = cut->piece[from->piece[side]].node[i], v = cut->source[node];
                c->bend[b].vertex[v == ends[0] ? 0 : v == ends[1] ? 1 : 2 + side] = node;
            }
        }
    }
    return RUGA_OK;
}

// ---- hinges --------------------------------------------------------------------------------------------

// The value at a place of a polyline's nearest point, linear between its points.
static double value_near(const ruga_curve* curve, const double* values, const double x[3]) {
    double best = INFINITY, value = values[0];
    for (int k = 0; k + !curve->closed < curve->point_count; k++) {
        int next = (k + 1) % curve->point_count;
        double d[3], e[3];
        ruga_subtract(curve->point[next], curve->point[k], d);
        ruga_subtract(x, curve->point[k], e);
        double square = ruga_dot(d, d), t = square > 0 ? fmin(fmax(ruga_dot(d, e) / square, 0), 1) : 0;
        ruga_add_scaled(-t, d, e);
        if (ruga_norm(e) < best) {
            best = ruga_norm(e);
            value = (1 - t) * values[k] + t * values[next];
        }
    }
    return value;
}

static void set_fold(ruga_creases* c, int h, const ruga_crease_def* defs, const ruga_curves* curves) {
    const ruga_segment* segment = &c->cut.segment[c->segment[h]];
    const ruga_curve* curve = &curves->curve[segment->curve];
    const ruga_crease_def* def = &defs[curve->label];
    const double *a = c->cut.material.position + 3 * (size_t)segment->end[0],
                 *b = c->cut.material.position + 3 * (size_t)segment->end[1];
    const double middle[3] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    c->stiffness[h] = def->point_stiffness ? value_near(curve, def->point_stiffness, middle) : def->stiffness;
    c->rest[h] = def->point_rest    ? value_near(curve, def->point_rest, middle)
                 : isnan(def->rest) ? c->drawn[h]
                                    : def->rest;
}

static ruga_status set_hinges(ruga_creases* c, const ruga_crease_def* defs, const ruga_curves* curves) {
    ruga_status status = RUGA_OK;
    const ruga_cut* cut = &c->cut;
    ruga_hinge* made = NULL;
    double* x = NULL;
    int count = c->hinge_count = cut->segment_count;
    RUGA_TRY(RUGA_NEW(c->segment, count));
    RUGA_TRY(RUGA_NEW(c->hinge, count));
    RUGA_TRY(RUGA_NEW_ZERO(c->stiffness, count));
    RUGA_TRY(RUGA_NEW(c->drawn, count));
    RUGA_TRY(RUGA_NEW_ZERO(c->steepness, count));
    RUGA_TRY(RUGA_NEW(c->rest, count));
    RUGA_TRY(RUGA_NEW(c->pair, (RUGA_HINGE_NODES * (RUGA_HINGE_NODES - 1) / 2) * (size_t)count));
    RUGA_TRY_DONE(RUGA_NEW(made, count));
    RUGA_TRY_DONE(RUGA_NEW(x, 3 * (size_t)cut->node_count));
    ruga_hinges_make(&c->raster, cut, made);
    ruga_cut_rest(&c->raster, cut, x);
    int out = 0;
    for (int fold = 1; fold >= 0; fold--) {
        for (int s = 0; s < count; s++) {
            if ((made[s].curve >= 0) == fold) {
                c->segment[out++] = s;
            }
        }
        c->segment_count = fold ? out : c->segment_count;
    }
    for (int h = 0; h < count; h++) {
        double slope[RUGA_HINGE_NODES][3];
        c->hinge[h] = made[c->segment[h]];
        c->drawn[h] = c->rest[h] = ruga_hinge_measure(&c->hinge[h], x, NULL, slope);
        if (h < c->segment_count) {
            set_fold(c, h, defs, curves);
        }
        for (int i = 0; i < RUGA_HINGE_NODES; i++) {
            c->steepness[h] += ruga_dot(slope[i], slope[i]);
        }
        for (int i = 1; i < RUGA_HINGE_NODES; i++) {
            for (int j = 0; j < i; j++, c->pair_count++) {
                c->pair[c->pair_count][0] = c->hinge[h].node[i];
                c->pair[c->pair_count][1] = c->hinge[h].node[j];
            }
        }
    }
done:
    ruga_release(made);
    ruga_release(x);
    return status;
}

// k = l / (A1 / D1 + A2 / D2) for each length, A the material on both sides: as in a mesh that conforms. A
// fold is no stiffer than 1,000 times E h times an edge: no panel that is strained by less than 1 % can turn
// that by 1e-5 rad, and beyond it the panels' own forces drown in the hinge's round-off.
void ruga_creases_set_bending(ruga_creases* c, const ruga_shell_material* material) {
    const double edge = ruga_mesh_mean_edge(&c->raster.mesh);
    for (int h = 0; h < c->hinge_count; h++) {
        const ruga_segment* segment = &c->cut.segment[c->segment[h]];
        double softness = 0, most = 0;
        for (int side = 0; side < 2; side++) {
            int p = segment->piece[side];
            const ruga_cut_piece* piece = &c->cut.piece[p];
            softness += piece->fraction * ruga_mesh_triangle_area(&c->raster.mesh, piece->triangle) /
                        ruga_shell_material_bending(material, p);
            most = fmax(most, RIGID * edge * ruga_shell_material_young(material, p) *
                                  ruga_shell_material_thickness(material, p));
        }
        c->stiffness[h] = h < c->segment_count ? fmin(c->stiffness[h], most) : segment->length / softness;
        c->answer = hypot(c->answer, c->stiffness[h] * segment->length * c->steepness[h]);
    }
}

// ---- the whole -----------------------------------------------------------------------------------------

ruga_status ruga_creases_create(int count, const ruga_crease_def* defs, const int* stage, int now,
                                const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                ruga_creases** creases) {
    ruga_status status = RUGA_OK;
    ruga_raster_def how = ruga_default_raster_def();
    ruga_curves curves = {0};
    ruga_creases* c = NULL;
    *creases = NULL;
    how.stage = now;
    RUGA_TRY(RUGA_NEW_ZERO(c, 1));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(c->law, count));
    RUGA_TRY_DONE(add_curves(count, defs, stage, mesh, connectivity, c, &curves));
    status = ruga_raster_create(mesh, &curves, &how, &c->raster);
    if (status == RUGA_BAD_INPUT) {
        status = ruga_fail_prefix(status, "creases");
    }
    RUGA_TRY_DONE(status);
    RUGA_TRY_DONE(ruga_cut_create(&c->raster, &c->cut));
    RUGA_TRY_DONE(ruga_sewing_create(&c->cut, NULL, &c->sewing));
    RUGA_TRY_DONE(ruga_connectivity_create(&c->cut.material, &c->shown));
    RUGA_TRY_DONE(set_pieces(c));
    RUGA_TRY_DONE(set_bends(c));
    RUGA_TRY_DONE(set_hinges(c, defs, &curves));
done:
    ruga_curves_clear(&curves);
    if (status != RUGA_OK) {
        ruga_creases_destroy(&c);
    }
    *creases = c;
    return status;
}

ruga_status ruga_creases_nodes(const ruga_creases* c, ruga_mesh* nodes) {
    ruga_status status = RUGA_OK;
    *nodes = (ruga_mesh){0};
    RUGA_TRY_DONE(RUGA_NEW(nodes->position, 3 * (size_t)c->cut.node_count));
    RUGA_TRY_DONE(RUGA_NEW(nodes->triangle, 3 * (size_t)c->cut.piece_count));
    nodes->vertex_count = c->cut.node_count;
    nodes->triangle_count = c->cut.piece_count;
    ruga_cut_rest(&c->raster, &c->cut, nodes->position);
    for (int p = 0; p < c->cut.piece_count; p++) {
        memcpy(nodes->triangle + 3 * (size_t)p, c->cut.piece[p].node, sizeof c->cut.piece[p].node);
    }
done:
    if (status != RUGA_OK) {
        ruga_mesh_clear(nodes);
    }
    return status;
}

// A pattern of single entries lists each edge once, by its lower end.
static void take_edges(const ruga_sparse* lower, const ruga_mesh* nodes, ruga_connectivity* c) {
    int count = 0;
    for (int j = 0; j < lower->columns; j++) {
        for (int p = lower->start[j] + 1; p < lower->start[j + 1]; p++, count++) {
            c->edge[count][0] = j;
            c->edge[count][1] = lower->index[p];
            c->neighbour_start[j]++;
            c->neighbour_start[lower->index[p]]++;
        }
    }
    for (int j = 0; j < lower->columns; j++) {
        c->neighbour_start[j + 1] += c->neighbour_start[j];
    }
    for (int e = count - 1; e >= 0; e--) {
        for (int end = 0; end < 2; end++) {
            int at = --c->neighbour_start[c->edge[e][end]];
            c->neighbour[at] = c->edge[e][1 - end];
            c->neighbour_edge[at] = e;
        }
    }
    for (int k = 0; k < 3 * nodes->triangle_count; k++) {
        int a = nodes->triangle[k], b = nodes->triangle[k % 3 == 2 ? k - 2 : k + 1];
        int low = a < b ? a : b, high = a < b ? b : a;
        // Before the column's entries stand as many diagonals as columns up to it.
        c->triangle_edge[k / 3][k % 3] = ruga_sparse_find(lower, high, low) - (low + 1);
    }
}

ruga_status ruga_creases_edges(const ruga_mesh* nodes, ruga_connectivity* edges) {
    ruga_status status = RUGA_OK;
    int halves = 3 * nodes->triangle_count, (*pair)[2] = NULL;
    ruga_sparse lower = {0};
    *edges =
        (ruga_connectivity){.vertex_count = nodes->vertex_count, .triangle_count = nodes->triangle_count};
    RUGA_TRY_DONE(RUGA_NEW(pair, halves));
    for (int k = 0; k < halves; k++) {
        pair[k][0] = nodes->triangle[k];
        pair[k][1] = nodes->triangle[k % 3 == 2 ? k - 2 : k + 1];
    }
    RUGA_TRY_DONE(ruga_sparse_from_pairs(nodes->vertex_count, 1, halves, (const int(*)[2])pair, &lower));
    edges->edge_count = lower.start[lower.columns] - lower.columns;
    RUGA_TRY_DONE(RUGA_NEW(edges->edge, edges->edge_count));
    RUGA_TRY_DONE(RUGA_NEW(edges->triangle_edge, nodes->triangle_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(edges->neighbour_start, (size_t)nodes->vertex_count + 2));
    RUGA_TRY_DONE(RUGA_NEW(edges->neighbour, 2 * (size_t)edges->edge_count));
    RUGA_TRY_DONE(RUGA_NEW(edges->neighbour_edge, 2 * (size_t)edges->edge_count));
    take_edges(&lower, nodes, edges);
done:
    ruga_sparse_clear(&lower);
    ruga_release(pair);
    if (status != RUGA_OK) {
        ruga_connectivity_clear(edges);
    }
    return status;
}

ruga_status ruga_creases_places(const ruga_creases* c, ruga_load_place (**place)[3]) {
    const ruga_cut* cut = &c->cut;
    RUGA_TRY(RUGA_NEW(*place, cut->material.triangle_count));
    for (int k = 0; k < 3 * cut->material.triangle_count; k++) {
        const ruga_cut_piece* piece = &cut->piece[cut->material_piece[k / 3]];
        int v = cut->material.triangle[k];
        ruga_load_place* to = &(*place)[k / 3][k % 3];
        *to = (ruga_load_place){.node = {v, v}, .weight = {1, 0}};
        for (int i = 0; i < 3 && v >= cut->real_count; i++) {
            if (piece->bound[i] == v - cut->real_count) {
                (void)ruga_cut_point(cut, piece, 2 * i + 1, to->node, to->weight);
            }
        }
    }
    return RUGA_OK;
}

ruga_shell_cut ruga_creases_shell(const ruga_creases* c) {
    return (ruga_shell_cut){.stiffness = c->fraction,
                            .mass = (const double(*)[3])c->mass,
                            .bend_count = c->cut.bend_count,
                            .bend = c->bend,
                            .pair_count = c->pair_count,
                            .pair = (const int(*)[2])c->pair};
}

// ---- rows ----------------------------------------------------------------------------------------------

typedef struct entry {
    int node;
    double weight;
} entry;

static int compare_entries(const void* a, const void* b) {
    const entry *p = a, *q = b;
    return (p->node > q->node) - (p->node < q->node);
}

static int expand_row(const ruga_creases* c, const ruga_clusters* from, int row, entry* list) {
    int count = 0;
    for (int k = from->start[row]; k < from->start[row + 1]; k++) {
        int v = from->vertex[k];
        for (int n = c->cut.copy_start[v]; n < c->cut.copy_start[v + 1]; n++) {
            int node = c->cut.copy[n];
            list[count++] = (entry){node, from->weight[k] * c->share[node]};
        }
    }
    return count;
}

static void put_row(entry* list, int count, ruga_clusters* to, int row) {
    int at = to->start[row];
    qsort(list, (size_t)count, sizeof *list, compare_entries);
    for (int k = 0; k < count; k++) {
        to->vertex[at] = list[k].node;
        to->weight[at++] = list[k].weight;
    }
    to->start[row + 1] = at;
}

static ruga_status allocate_rows(const ruga_creases* c, const ruga_clusters* from, ruga_clusters* to) {
    const ruga_sewing* s = &c->sewing;
    size_t entries = (size_t)s->start[s->row_count];
    for (int k = 0; from->count > 0 && k < from->start[from->count]; k++) {
        entries += (size_t)(c->cut.copy_start[from->vertex[k] + 1] - c->cut.copy_start[from->vertex[k]]);
    }
    if (entries > INT32_MAX) {
        return ruga_fail(RUGA_NO_MEMORY, "the clusters have more than 2^31 entries: use a coarser mesh");
    }
    to->count = from->count + s->row_count;
    to->vertex_count = c->cut.node_count;
    RUGA_TRY(RUGA_NEW_ZERO(to->start, to->count + 1));
    RUGA_TRY(RUGA_NEW(to->vertex, entries));
    return RUGA_NEW(to->weight, entries);
}

ruga_status ruga_creases_tie(const ruga_creases* c, ruga_clusters* clusters) {
    ruga_status status = RUGA_OK;
    const ruga_sewing* s = &c->sewing;
    ruga_clusters made = {0};
    entry* list = NULL;
    RUGA_TRY_DONE(allocate_rows(c, clusters, &made));
    RUGA_TRY_DONE(RUGA_NEW(list, c->cut.node_count));
    for (int r = 0; r < clusters->count; r++) {
        put_row(list, expand_row(c, clusters, r, list), &made, r);
    }
    for (int r = 0; r < s->row_count; r++) {
        int count = 0;
        for (int k = s->start[r]; k < s->start[r + 1]; k++) {
            list[count++] = (entry){s->node[k], s->weight[k]};
        }
        put_row(list, count, &made, clusters->count + r);
    }
    RUGA_TRY_DONE(ruga_clusters_transpose(&made));
    ruga_clusters_clear(clusters);
    *clusters = made;
    made = (ruga_clusters){0};
done:
    ruga_clusters_clear(&made);
    ruga_release(list);
    return status;
}

// ---- rest angles ---------------------------------------------------------------------------------------

int ruga_crease_law_of(const ruga_creases* c, int hinge) {
    return c->raster.curve[c->hinge[hinge].curve].label;
}

double ruga_creases_shown_angle(const ruga_creases* c, int hinge, const double* shown) {
    const int* end = c->cut.segment[c->segment[hinge]].end;
    int e = ruga_edge_between(&c->shown, end[0], end[1]);
    const double* x[4];
    RUGA_ASSERT(e >= 0);
    for (int i = 0; i < 2; i++) {
        x[i] = shown + 3 * (size_t)c->shown.edge[e][i];
        x[2 + i] = shown + 3 * (size_t)c->shown.edge_opposite[e][i];
    }
    return ruga_hinge_angle(x, NULL);
}

double ruga_crease_rest_at(const ruga_creases* c, int hinge, double time) {
    const ruga_crease_law* law = &c->law[ruga_crease_law_of(c, hinge)];
    const ruga_crease_key* keys = law->keys;
    if (law->key_count == 0) {
        return c->rest[hinge];
    }
    int k = 0;
    while (k < law->key_count && keys[k].time <= time) {
        k++;
    }
    const ruga_crease_key *before = &keys[k > 0 ? k - 1 : 0], *after = &keys[k < law->key_count ? k : k - 1];
    double length = after->time - before->time;
    double t = length > 0 ? (time - before->time) / length : 0;
    double angle = before->angle + t * (after->angle - before->angle);
    return angle + (before->scale + t * (after->scale - before->scale)) * c->rest[hinge];
}
