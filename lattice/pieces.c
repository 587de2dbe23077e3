// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Connected components of the material in each sub-cell (Remillard and Kry 2013, section 5.1): surface
// patches, connected across edges inside the sub-cell, and the caps that close them, connected along shared
// edges and along edges of the sub-cell that lie in the material. A closed shell wholly within the sub-cell
// is a component of its own or, turned inward, a cavity of the component around it: a ray tells. Volume by
// the divergence theorem with the field (x - x_low, 0, 0): only the surface and the caps on the sub-cell's
// high x face contribute, V = sum (x - x_low) A_x + width * cap area, in numbers no larger than the sub-cell.
#include "lattice/pieces.h"

#include "core/memory.h"

#include <string.h>

#include "lattice/union_find.h"

typedef struct side {
    int face;    // crossed face, or -1
    int first;   // its first node in the graph
    int count;   // caps; for a face that is not crossed 1 = full, 0 = empty
    int winding; // of a face that is not crossed
} side;

// The graph of one sub-cell: its triangles, then the caps on its six sides.
typedef struct cell_graph {
    const ruga_caps* caps;
    ruga_pieces* pieces;
    ruga_piece_cell* cell;
    int* position; // [triangles] place of a triangle in its sub-cell
    side sides[6];
    int count, capacity;
    int* parent;
    int label_capacity;
    int* label; // roots before shells are placed, then pieces by root
} cell_graph;

void ruga_pieces_clear(ruga_pieces* pieces) {
    ruga_release(pieces->cell);
    ruga_release(pieces->cell_triangle);
    ruga_release(pieces->triangle_cell);
    ruga_release(pieces->piece);
    ruga_release(pieces->triangle_piece);
    ruga_release(pieces->region_piece);
    *pieces = (ruga_pieces){0};
}

ruga_status ruga_pieces_add(ruga_pieces* pieces, const int index[3], double volume, int* piece) {
    RUGA_TRY(RUGA_RESERVE(pieces->piece, pieces->piece_capacity, pieces->piece_count + 1));
    *piece = pieces->piece_count++;
    pieces->piece[*piece] = (ruga_piece){.index = {index[0], index[1], index[2]}, .volume = volume};
    return RUGA_OK;
}

static ruga_status collect_cells(const ruga_slices* slices, ruga_pieces* pieces) {
    ruga_vdb* map = NULL;
    ruga_status status;
    RUGA_TRY_DONE(RUGA_NEW(pieces->cell_triangle, slices->triangle_count));
    RUGA_TRY_DONE(RUGA_NEW(pieces->triangle_cell, slices->triangle_count));
    RUGA_TRY_DONE(ruga_vdb_create(&map));
    for (int t = 0; t < slices->triangle_count; t++) {
        const int* index = slices->triangle[t].index;
        int c = ruga_vdb_get(map, index);
        if (c < 0) {
            c = pieces->cell_count;
            RUGA_TRY_DONE(RUGA_RESERVE(pieces->cell, pieces->cell_capacity, c + 1));
            RUGA_TRY_DONE(ruga_vdb_set(map, index, c));
            pieces->cell[c] = (ruga_piece_cell){.index = {index[0], index[1], index[2]}};
            pieces->cell_count++;
        }
        pieces->triangle_cell[t] = c;
        pieces->cell[c].end++;
    }
    for (int c = 0, begin = 0; c < pieces->cell_count; c++) {
        int triangles = pieces->cell[c].end;
        pieces->cell[c].begin = pieces->cell[c].end = begin;
        begin += triangles;
    }
    for (int t = 0; t < slices->triangle_count; t++) {
        pieces->cell_triangle[pieces->cell[pieces->triangle_cell[t]].end++] = t;
    }
done:
    ruga_vdb_destroy(&map);
    return status;
}

static ruga_status add_nodes(cell_graph* graph) {
    const ruga_caps* caps = graph->caps;
    const ruga_piece_cell* cell = graph->cell;
    graph->count = cell->end - cell->begin;
    for (int i = 0; i < 6; i++) {
        side* side = &graph->sides[i];
        side->face = ruga_caps_face(caps, cell->index, i / 2, i % 2);
        side->first = graph->count;
        side->winding = 0;
        if (side->face >= 0) {
            side->count = caps->face[side->face].region_count;
        } else {
            int corner[3] = {cell->index[0], cell->index[1], cell->index[2]};
            corner[i / 2] += i % 2;
            side->winding = ruga_caps_corner(caps, corner);
            side->count = side->winding != 0;
        }
        graph->count += side->count;
    }
    RUGA_TRY(RUGA_RESERVE(graph->parent, graph->capacity, graph->count));
    RUGA_TRY(RUGA_RESERVE(graph->label, graph->label_capacity, graph->count));
    ruga_sets_reset(graph->parent, graph->count);
    return RUGA_OK;
}

static void join_triangles(cell_graph* graph) {
    const ruga_slices* slices = graph->caps->slices;
    const ruga_piece_cell* cell = graph->cell;
    for (int i = cell->begin; i < cell->end; i++) {
        const ruga_cut_triangle* triangle = &slices->triangle[graph->pieces->cell_triangle[i]];
        for (int k = 0; k < 3; k++) {
            int e = triangle->edge[k];
            const ruga_cut_edge* edge = &slices->edge[e];
            int other;
            if (edge->axis < 0) {
                const int* both = slices->edge_triangle[e];
                other = graph->position[both[0] == graph->pieces->cell_triangle[i] ? both[1] : both[0]];
            } else {
                bool high = edge->index[edge->axis] != cell->index[edge->axis];
                const side* side = &graph->sides[2 * edge->axis + high];
                other =
                    side->first + graph->caps->edge_region[e] - graph->caps->face[side->face].region_first;
            }
            ruga_sets_unite(graph->parent, i - cell->begin, other);
        }
    }
}

// Node of the cap that holds a border segment of a side as a whole, or -1.
static int whole_segment(const cell_graph* graph, const side* side, int segment) {
    if (side->face < 0) {
        return side->count ? side->first : -1;
    }
    const ruga_cap_face* face = &graph->caps->face[side->face];
    int region = face->segment_region[segment];
    return region < 0 ? -1 : side->first + region - face->region_first;
}

// Caps that meet along a whole edge of the sub-cell. (Where the surface crosses that edge, the piece of the
// surface there joins them already.)
static void join_caps(cell_graph* graph) {
    for (int axis = 0; axis < 3; axis++) {
        int next = (axis + 1) % 3, last = (axis + 2) % 3;
        for (int corner = 0; corner < 4; corner++) {
            int high_next = corner % 2, high_last = corner / 2;
            // The edge runs along the second coordinate of the `next` side and the first of the `last` side.
            int a = whole_segment(graph, &graph->sides[2 * next + high_next], high_last ? 1 : 3);
            int b = whole_segment(graph, &graph->sides[2 * last + high_last], high_next ? 2 : 0);
            if (a >= 0 && b >= 0) {
                ruga_sets_unite(graph->parent, a, b);
            }
        }
    }
}

// Winding number about (y, z) of the triangle's projection along x, by the same half-open ray rule as on
// faces; edges are evaluated in one direction whichever triangle asks. *x is the plane's height there.
static int pierce(const ruga_slices* slices, const ruga_cut_triangle* triangle, double y, double z,
                  double* x) {
    int winding = 0;
    for (int k = 0; k < 3; k++) {
        int from = triangle->point[k], to = triangle->point[(k + 1) % 3];
        const double* p = slices->point[from < to ? from : to];
        const double* q = slices->point[from < to ? to : from];
        if ((p[2] <= z) == (q[2] <= z)) {
            continue;
        }
        if (p[1] + (z - p[2]) / (q[2] - p[2]) * (q[1] - p[1]) > y) {
            winding += slices->point[from][2] <= z ? 1 : -1;
        }
    }
    const double *a = slices->point[triangle->point[0]], *b = slices->point[triangle->point[1]],
                 *c = slices->point[triangle->point[2]];
    double abx = b[0] - a[0], aby = b[1] - a[1], abz = b[2] - a[2];
    double acx = c[0] - a[0], acy = c[1] - a[1], acz = c[2] - a[2];
    double nx = aby * acz - abz * acy, ny = abz * acx - abx * acz, nz = abx * acy - aby * acx;
    double low = fmin(a[0], fmin(b[0], c[0])), high = fmax(a[0], fmax(b[0], c[0]));
    double at = nx != 0 ? a[0] - (ny * (y - a[1]) + nz * (z - a[2])) / nx : low;
    *x = at < low ? low : at > high ? high : at;
    return winding;
}

// The node around a closed shell, seen from its farthest point along x, or -1 in the open.
static int node_around(const cell_graph* graph, int root, const double far[3]) {
    const ruga_slices* slices = graph->caps->slices;
    const ruga_piece_cell* cell = graph->cell;
    const side* high = &graph->sides[1];
    int winding = high->winding, node = high->count ? high->first : -1;
    if (high->face >= 0) {
        const ruga_cap_face* face = &graph->caps->face[high->face];
        int region = ruga_caps_region_at(graph->caps, face, (double[2]){far[1], far[2]}, &winding);
        node = region < 0 ? -1 : high->first + region - face->region_first;
    }
    double nearest = INFINITY;
    for (int i = cell->begin; i < cell->end; i++) {
        if (graph->label[i - cell->begin] == root) {
            continue;
        }
        double x;
        int turns = pierce(slices, &slices->triangle[graph->pieces->cell_triangle[i]], far[1], far[2], &x);
        if (turns != 0 && x > far[0]) {
            winding += turns; // a normal along the ray: the material ends there
            if (x < nearest) {
                nearest = x;
                node = i - cell->begin;
            }
        }
    }
    return winding != 0 ? node : -1;
}

static void place_shells(cell_graph* graph) {
    const ruga_slices* slices = graph->caps->slices;
    const ruga_piece_cell* cell = graph->cell;
    int triangles = cell->end - cell->begin;
    for (int i = 0; i < graph->count; i++) {
        graph->label[i] = ruga_sets_find(graph->parent, i);
    }
    // Roots are smallest members: what touches a side is marked through its caps.
    for (int i = triangles; i < graph->count; i++) {
        graph->label[graph->label[i]] = -1;
    }
    for (int i = 0; i < triangles; i++) {
        int root = graph->label[i];
        if (root != i || root < 0) { // joined to a cap, or not the first of its shell
            continue;
        }
        const double* far = NULL;
        for (int j = i; j < triangles; j++) {
            const int* points = slices->triangle[graph->pieces->cell_triangle[cell->begin + j]].point;
            for (int k = 0; k < 3 && graph->label[j] == root; k++) {
                const double* p = slices->point[points[k]];
                far = !far || p[0] > far[0] ? p : far;
            }
        }
        int around = node_around(graph, root, far);
        if (around >= 0) {
            ruga_sets_unite(graph->parent, root, around);
        }
    }
}

// Volume under one triangle from the sub-cell's low x plane.
static double triangle_volume(const ruga_slices* slices, const ruga_cut_triangle* triangle, double x_low) {
    const double *a = slices->point[triangle->point[0]], *b = slices->point[triangle->point[1]],
                 *c = slices->point[triangle->point[2]];
    double area_x = ((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])) / 2;
    return ((a[0] - x_low) + (b[0] - x_low) + (c[0] - x_low)) / 3 * area_x;
}

static ruga_status number_pieces(cell_graph* graph) {
    const ruga_caps* caps = graph->caps;
    ruga_pieces* pieces = graph->pieces;
    ruga_piece_cell* cell = graph->cell;
    for (int i = 0; i < graph->count; i++) {
        int root = ruga_sets_find(graph->parent, i);
        if (root == i) {
            RUGA_TRY(ruga_pieces_add(pieces, cell->index, 0, &graph->label[i]));
        } else {
            graph->label[i] = graph->label[root];
        }
    }
    double low = ruga_slice_plane(cell->index[0]), width[3];
    for (int axis = 0; axis < 3; axis++) {
        width[axis] = ruga_slice_plane(cell->index[axis] + 1) - ruga_slice_plane(cell->index[axis]);
    }
    for (int i = cell->begin; i < cell->end; i++) {
        int t = pieces->cell_triangle[i];
        pieces->triangle_piece[t] = graph->label[i - cell->begin];
        pieces->piece[pieces->triangle_piece[t]].volume +=
            triangle_volume(caps->slices, &caps->slices->triangle[t], low);
    }
    for (int i = 0; i < 6; i++) {
        const side* side = &graph->sides[i];
        cell->full_face[i] = side->face < 0 && side->count ? graph->label[side->first] : -1;
        for (int r = 0; r < side->count; r++) {
            int piece = graph->label[side->first + r];
            double area = side->winding * width[1] * width[2];
            if (side->face >= 0) {
                int region = caps->face[side->face].region_first + r;
                pieces->region_piece[region][i % 2 == 0] = piece;
                area = caps->region_area[region];
            }
            pieces->piece[piece].volume += i == 1 ? width[0] * area : 0;
        }
    }
    return RUGA_OK;
}

ruga_status ruga_pieces_create(const ruga_caps* caps, ruga_pieces* pieces) {
    *pieces = (ruga_pieces){0};
    cell_graph graph = {.caps = caps, .pieces = pieces};
    const ruga_slices* slices = caps->slices;
    ruga_status status;
    RUGA_TRY_DONE(RUGA_NEW(pieces->triangle_piece, slices->triangle_count));
    RUGA_TRY_DONE(RUGA_NEW(pieces->region_piece, caps->region_count));
    RUGA_TRY_DONE(RUGA_NEW(graph.position, slices->triangle_count));
    RUGA_TRY_DONE(collect_cells(slices, pieces));
    for (int c = 0; c < pieces->cell_count; c++) {
        for (int i = pieces->cell[c].begin; i < pieces->cell[c].end; i++) {
            graph.position[pieces->cell_triangle[i]] = i - pieces->cell[c].begin;
        }
    }
    for (int c = 0; c < pieces->cell_count; c++) {
        graph.cell = &pieces->cell[c];
        RUGA_TRY_DONE(add_nodes(&graph));
        join_triangles(&graph);
        join_caps(&graph);
        place_shells(&graph);
        RUGA_TRY_DONE(number_pieces(&graph));
    }
done:
    ruga_release(graph.position);
    ruga_release(graph.parent);
    ruga_release(graph.label);
    if (status != RUGA_OK) {
        ruga_pieces_clear(pieces);
    }
    return status;
}
