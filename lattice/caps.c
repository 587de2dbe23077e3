// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// "Closing the pieces along cell faces" (Remillard and Kry 2013, section 5.1, figure 5 middle), from lines to
// faces. Along a line the sorted crossings give the winding number w; material is where w != 0. On a face the
// cut edges and the intervals of its border that lie in the material bound the caps: what is connected
// through shared points is one cap. A loop wholly within a face bounds a hole of another cap, or a cap of its
// own: a ray from its farthest point tells. Areas by Green's theorem, A = -int (v - v_low) du, counted with
// w, so that the caps of both sides of a plane cancel exactly in the sum of all volumes.
#include "lattice/caps.h"

#include "core/memory.h"

#include <stdlib.h>
#include <string.h>

#include "lattice/union_find.h"

typedef struct segment {
    int begin, end; // crossings
    int winding;    // at its low end
} segment;

void ruga_caps_clear(ruga_caps* caps) {
    ruga_release(caps->line_start);
    ruga_release(caps->crossing);
    for (int axis = 0; axis < 3; axis++) {
        ruga_vdb_destroy(&caps->map[axis]);
    }
    ruga_release(caps->face);
    ruga_release(caps->face_edge);
    ruga_release(caps->edge_region);
    ruga_release(caps->region_area);
    *caps = (ruga_caps){0};
}

static int line_number(const ruga_caps* caps, int axis, int plane1, int plane2) {
    return caps->line_base[axis] + plane1 * caps->planes[(axis + 2) % 3] + plane2;
}

// At one place the material ends before it begins: two bodies that touch stay apart.
static int compare_crossings(const void* first, const void* second) {
    const ruga_crossing *a = first, *b = second;
    if (a->slab != b->slab) {
        return a->slab < b->slab ? -1 : 1;
    }
    if (a->u != b->u) {
        return a->u < b->u ? -1 : 1;
    }
    if (a->sign != b->sign) {
        return a->sign < b->sign ? -1 : 1;
    }
    return (a->point > b->point) - (a->point < b->point);
}

static ruga_status sort_crossings(ruga_caps* caps) {
    const ruga_slices* slices = caps->slices;
    int lines = 0;
    for (int axis = 0; axis < 3; axis++) {
        caps->line_base[axis] = lines;
        lines += caps->planes[(axis + 1) % 3] * caps->planes[(axis + 2) % 3];
    }
    RUGA_TRY(RUGA_NEW_ZERO(caps->line_start, lines + 2));
    RUGA_TRY(RUGA_NEW(caps->crossing, slices->crossing_count));
    // Counted two places ahead, so that filling leaves each start where it belongs.
    for (int c = 0; c < slices->crossing_count; c++) {
        const ruga_crossing* crossing = &slices->crossing[c];
        caps->line_start[line_number(caps, crossing->axis, crossing->line[0], crossing->line[1]) + 2]++;
    }
    for (int line = 0; line < lines; line++) {
        caps->line_start[line + 2] += caps->line_start[line + 1];
    }
    for (int c = 0; c < slices->crossing_count; c++) {
        const ruga_crossing* crossing = &slices->crossing[c];
        int line = line_number(caps, crossing->axis, crossing->line[0], crossing->line[1]);
        caps->crossing[caps->line_start[line + 1]++] = *crossing;
    }
    for (int line = 0; line < lines; line++) {
        int begin = caps->line_start[line], end = caps->line_start[line + 1], winding = 0;
        qsort(caps->crossing + begin, (size_t)(end - begin), sizeof *caps->crossing, compare_crossings);
        for (int c = begin; c < end; c++) {
            caps->crossing[c].below = winding;
            winding += caps->crossing[c].sign;
        }
        RUGA_ASSERT(winding == 0); // the surface is closed
    }
    return RUGA_OK;
}

// First crossing of a line, from `begin`, that lies in the slab or above.
static int first_in_slab(const ruga_caps* caps, int begin, int end, int slab) {
    while (begin < end) {
        int middle = begin + (end - begin) / 2;
        if (caps->crossing[middle].slab < slab) {
            begin = middle + 1;
        } else {
            end = middle;
        }
    }
    return begin;
}

static segment find_segment(const ruga_caps* caps, int axis, int plane1, int plane2, int slab) {
    int line = line_number(caps, axis, plane1, plane2);
    int end = caps->line_start[line + 1];
    segment found;
    found.begin = first_in_slab(caps, caps->line_start[line], end, slab);
    found.end = first_in_slab(caps, found.begin, end, slab + 1);
    found.winding = found.begin < end ? caps->crossing[found.begin].below : 0;
    return found;
}

int ruga_caps_corner(const ruga_caps* caps, const int planes[3]) {
    return find_segment(caps, 2, planes[0], planes[1], planes[2]).winding;
}

int ruga_caps_face(const ruga_caps* caps, const int index[3], int axis, int side) {
    int at[3] = {index[0], index[1], index[2]};
    at[axis] += side;
    return ruga_vdb_get(caps->map[axis], at);
}

// Border segment 0 .. 3 of a face.
static segment border_segment(const ruga_caps* caps, const ruga_cap_face* face, int which) {
    int axis = face->axis, u = (axis + 1) % 3, v = (axis + 2) % 3, plane = face->index[axis];
    if (which % 2 == 0) { // along u: planes of the axes v, axis
        return find_segment(caps, u, face->index[v] + which / 2, plane, face->index[u]);
    }
    return find_segment(caps, v, plane, face->index[u] + (which == 1), face->index[v]);
}

static ruga_status collect_faces(ruga_caps* caps) {
    const ruga_slices* slices = caps->slices;
    int* face_of = NULL;
    ruga_status status;
    int count = 0;
    RUGA_TRY_DONE(RUGA_NEW(face_of, slices->edge_count));
    for (int e = 0; e < slices->edge_count; e++) {
        const ruga_cut_edge* edge = &slices->edge[e];
        face_of[e] = -1;
        if (edge->axis < 0) {
            continue;
        }
        int f = ruga_vdb_get(caps->map[edge->axis], edge->index);
        if (f < 0) {
            f = caps->face_count;
            RUGA_TRY_DONE(RUGA_RESERVE(caps->face, caps->face_capacity, f + 1));
            RUGA_TRY_DONE(ruga_vdb_set(caps->map[edge->axis], edge->index, f));
            caps->face[f] = (ruga_cap_face){.axis = edge->axis};
            memcpy(caps->face[f].index, edge->index, sizeof edge->index);
            caps->face_count++;
        }
        face_of[e] = f;
        caps->face[f].end++;
        count++;
    }
    RUGA_TRY_DONE(RUGA_NEW(caps->face_edge, count));
    for (int f = 0, begin = 0; f < caps->face_count; f++) {
        int edges = caps->face[f].end;
        caps->face[f].begin = caps->face[f].end = begin;
        begin += edges;
    }
    for (int e = 0; e < slices->edge_count; e++) {
        if (face_of[e] >= 0) {
            caps->face_edge[caps->face[face_of[e]].end++] = e;
        }
    }
done:
    ruga_release(face_of);
    return status;
}

// Ray crossings use the half-open rule "v <= v0 is below" for edges and border alike, so that closed curves
// are crossed consistently also through their points.
ruga_cap_hit ruga_caps_locate(const ruga_caps* caps, const ruga_cap_face* face, const double at[2],
                              const int* label, int skip) {
    int u = (face->axis + 1) % 3, v = (face->axis + 2) % 3;
    segment border = border_segment(caps, face, 1);
    ruga_cap_hit hit = {.winding = border.winding, .edge = -1, .point = -1};
    for (int c = border.begin; c < border.end; c++) {
        const ruga_crossing* crossing = &caps->crossing[c];
        if (crossing->u <= at[1]) {
            hit.winding += crossing->sign;
            hit.point = crossing->point;
        } else if (hit.point < 0) {
            hit.point = crossing->point;
        }
    }
    double nearest = INFINITY;
    for (int i = face->begin; i < face->end; i++) {
        const ruga_cut_edge* edge = &caps->slices->edge[caps->face_edge[i]];
        const double* p = caps->slices->point[edge->point[0]];
        const double* q = caps->slices->point[edge->point[1]];
        if ((label && label[i - face->begin] == skip) || (p[v] <= at[1]) == (q[v] <= at[1])) {
            continue;
        }
        double where = p[u] + (at[1] - p[v]) / (q[v] - p[v]) * (q[u] - p[u]);
        if (where > at[0]) {
            // The cap is on the left: on the low side of an edge that runs upwards.
            hit.winding += p[v] <= at[1] ? 1 : -1;
            if (where < nearest) {
                nearest = where;
                hit.edge = caps->face_edge[i];
            }
        }
    }
    return hit;
}

int ruga_caps_region_at(const ruga_caps* caps, const ruga_cap_face* face, const double at[2], int* winding) {
    ruga_cap_hit hit = ruga_caps_locate(caps, face, at, NULL, 0);
    *winding = hit.winding;
    if (hit.winding == 0) {
        return -1;
    }
    if (hit.edge >= 0) {
        return caps->edge_region[hit.edge];
    }
    for (int i = face->begin; hit.point >= 0 && i < face->end; i++) {
        const ruga_cut_edge* edge = &caps->slices->edge[caps->face_edge[i]];
        if (edge->point[0] == hit.point || edge->point[1] == hit.point) {
            return caps->edge_region[caps->face_edge[i]];
        }
    }
    return face->segment_region[1];
}

// The graph of one face: nodes 0 .. 3 are its corners (counter-clockwise), then its points.
typedef struct face_graph {
    ruga_caps* caps;
    ruga_cap_face* face;
    int* slot; // [points] node of a point of this face
    int count;
    int* parent;
    bool* anchored; // touches the border
    double* area;
    int* label;  // [edges of the face]
    int* region; // by root
} face_graph;

static void add_edges(face_graph* graph) {
    const ruga_cap_face* face = graph->face;
    const ruga_slices* slices = graph->caps->slices;
    for (int i = face->begin; i < face->end; i++) {
        const ruga_cut_edge* edge = &slices->edge[graph->caps->face_edge[i]];
        graph->slot[edge->point[0]] = graph->slot[edge->point[1]] = -1;
    }
    graph->count = 4;
    for (int i = face->begin; i < face->end; i++) {
        const ruga_cut_edge* edge = &slices->edge[graph->caps->face_edge[i]];
        for (int k = 0; k < 2; k++) {
            int* slot = &graph->slot[edge->point[k]];
            *slot = *slot < 0 ? graph->count++ : *slot;
        }
    }
    ruga_sets_reset(graph->parent, graph->count);
    memset(graph->anchored, 0, (size_t)graph->count * sizeof *graph->anchored);
    memset(graph->area, 0, (size_t)graph->count * sizeof *graph->area);
    int u = (face->axis + 1) % 3, v = (face->axis + 2) % 3;
    double low = ruga_slice_plane(face->index[v]);
    for (int i = face->begin; i < face->end; i++) {
        const ruga_cut_edge* edge = &slices->edge[graph->caps->face_edge[i]];
        const double *p = slices->point[edge->point[0]], *q = slices->point[edge->point[1]];
        int node = graph->slot[edge->point[0]];
        ruga_sets_unite(graph->parent, node, graph->slot[edge->point[1]]);
        graph->area[node] -= ((p[v] - low) + (q[v] - low)) / 2 * (q[u] - p[u]);
    }
}

// Joins the ends of the border's intervals in the material. The segment with v high also bounds area.
static void add_border(face_graph* graph, int which, bool inside[4]) {
    static const int ends[4][2] = {{0, 1}, {1, 2}, {3, 2}, {0, 3}};
    const ruga_cap_face* face = graph->face;
    segment segment = border_segment(graph->caps, face, which);
    int along = (face->axis + (which % 2 == 0 ? 1 : 2)) % 3, v = (face->axis + 2) % 3;
    double height = ruga_slice_plane(face->index[v] + 1) - ruga_slice_plane(face->index[v]);
    double start = ruga_slice_plane(face->index[along]), stop = ruga_slice_plane(face->index[along] + 1);
    int node = ends[which][0], winding = segment.winding;
    inside[node] = winding != 0;
    for (int c = segment.begin; c <= segment.end; c++) {
        const ruga_crossing* crossing = c < segment.end ? &graph->caps->crossing[c] : NULL;
        int next = crossing ? graph->slot[crossing->point] : ends[which][1];
        RUGA_ASSERT(next >= 0);
        double to = crossing ? crossing->u : stop;
        if (winding != 0) {
            ruga_sets_unite(graph->parent, node, next);
            graph->area[node] += which == 2 ? winding * height * (to - start) : 0;
        }
        if (crossing) {
            graph->anchored[next] = true;
            winding += crossing->sign;
        }
        node = next;
        start = to;
    }
    inside[node] = winding != 0;
}

// Finds the cap around each loop that does not touch the border.
static void place_loops(face_graph* graph) {
    const ruga_cap_face* face = graph->face;
    const ruga_slices* slices = graph->caps->slices;
    int u = (face->axis + 1) % 3, v = (face->axis + 2) % 3, edges = face->end - face->begin;
    for (int i = 4; i < graph->count; i++) {
        if (graph->anchored[i]) {
            graph->anchored[ruga_sets_find(graph->parent, i)] = true;
        }
    }
    for (int i = 0; i < edges; i++) {
        const ruga_cut_edge* edge = &slices->edge[graph->caps->face_edge[face->begin + i]];
        graph->label[i] = ruga_sets_find(graph->parent, graph->slot[edge->point[0]]);
    }
    for (int i = 0; i < edges; i++) {
        int root = graph->label[i];
        if (root < 4 || graph->anchored[root]) {
            continue;
        }
        graph->anchored[root] = true; // once for each loop
        const double* far = NULL;
        for (int j = i; j < edges; j++) {
            const ruga_cut_edge* edge = &slices->edge[graph->caps->face_edge[face->begin + j]];
            const double* p = slices->point[edge->point[0]];
            far = graph->label[j] == root && (!far || p[u] > far[u]) ? p : far;
        }
        ruga_cap_hit hit =
            ruga_caps_locate(graph->caps, face, (double[2]){far[u], far[v]}, graph->label, root);
        if (hit.winding != 0) {
            int around = hit.edge >= 0    ? graph->slot[slices->edge[hit.edge].point[0]]
                         : hit.point >= 0 ? graph->slot[hit.point]
                                          : 1;
            ruga_sets_unite(graph->parent, root, around);
        }
    }
}

static ruga_status number_regions(face_graph* graph, const bool inside[4]) {
    ruga_caps* caps = graph->caps;
    ruga_cap_face* face = graph->face;
    face->region_first = caps->region_count;
    for (int i = 0; i < graph->count; i++) {
        graph->region[i] = -1;
    }
    for (int i = 0; i < graph->count; i++) {
        if (i < 4 && !inside[i]) {
            continue;
        }
        int root = ruga_sets_find(graph->parent, i);
        if (graph->region[root] < 0) {
            RUGA_TRY(RUGA_RESERVE(caps->region_area, caps->region_capacity, caps->region_count + 1));
            caps->region_area[caps->region_count] = 0;
            graph->region[root] = caps->region_count++;
        }
        caps->region_area[graph->region[root]] += graph->area[i];
    }
    face->region_count = caps->region_count - face->region_first;
    for (int i = face->begin; i < face->end; i++) {
        int e = caps->face_edge[i];
        int root = ruga_sets_find(graph->parent, graph->slot[caps->slices->edge[e].point[0]]);
        caps->edge_region[e] = graph->region[root];
    }
    for (int which = 0; which < 4; which++) {
        segment segment = border_segment(caps, face, which);
        bool whole = segment.begin == segment.end && segment.winding != 0;
        int corner = ruga_sets_find(graph->parent, which == 3 ? 0 : which == 2 ? 3 : which);
        face->segment_region[which] = whole ? graph->region[corner] : -1;
    }
    return RUGA_OK;
}

static ruga_status find_regions(ruga_caps* caps) {
    face_graph graph = {.caps = caps};
    int most = 0;
    for (int f = 0; f < caps->face_count; f++) {
        int edges = caps->face[f].end - caps->face[f].begin;
        most = edges > most ? edges : most;
    }
    ruga_status status;
    RUGA_TRY_DONE(RUGA_NEW(graph.slot, caps->slices->point_count));
    RUGA_TRY_DONE(RUGA_NEW(graph.parent, 2 * (size_t)most + 4));
    RUGA_TRY_DONE(RUGA_NEW(graph.anchored, 2 * (size_t)most + 4));
    RUGA_TRY_DONE(RUGA_NEW(graph.area, 2 * (size_t)most + 4));
    RUGA_TRY_DONE(RUGA_NEW(graph.region, 2 * (size_t)most + 4));
    RUGA_TRY_DONE(RUGA_NEW(graph.label, most));
    RUGA_TRY_DONE(RUGA_NEW(caps->edge_region, caps->slices->edge_count));
    for (int f = 0; f < caps->face_count; f++) {
        bool inside[4];
        graph.face = &caps->face[f];
        add_edges(&graph);
        for (int which = 0; which < 4; which++) {
            add_border(&graph, which, inside);
        }
        place_loops(&graph);
        RUGA_TRY_DONE(number_regions(&graph, inside));
    }
done:
    ruga_release(graph.slot);
    ruga_release(graph.parent);
    ruga_release(graph.anchored);
    ruga_release(graph.area);
    ruga_release(graph.region);
    ruga_release(graph.label);
    return status;
}

ruga_status ruga_caps_create(const ruga_slices* slices, const int sub_cells[3], ruga_caps* caps) {
    *caps = (ruga_caps){.slices = slices};
    ruga_status status;
    for (int axis = 0; axis < 3; axis++) {
        caps->planes[axis] = sub_cells[axis] + 1;
        RUGA_TRY_DONE(ruga_vdb_create(&caps->map[axis]));
    }
    RUGA_TRY_DONE(sort_crossings(caps));
    RUGA_TRY_DONE(collect_faces(caps));
    RUGA_TRY_DONE(find_regions(caps));
done:
    if (status != RUGA_OK) {
        ruga_caps_clear(caps);
    }
    return status;
}
