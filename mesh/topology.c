// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The mesh doctor's topology, for any triangle soup: edges by two counting sorts of the faces' corners (by
// the larger vertex, then by the smaller), everything else from runs of equal edges. O(V + F) throughout.
//
// Genus g of closed components from Euler's formula, summed over all C of them: V - E + F = 2 C - 2 g.
#include "core/memory.h"
#include "mesh/examination.h"

#include <string.h>

static const int nobody[2] = {-1, -1};

static int corner_vertex(const ruga_examination* x, int corner) {
    return x->mesh->triangle[corner];
}

static int next_corner(int corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static int low_vertex(const ruga_examination* x, int corner) {
    int a = corner_vertex(x, corner);
    int b = corner_vertex(x, next_corner(corner));
    return a < b ? a : b;
}

static int high_vertex(const ruga_examination* x, int corner) {
    int a = corner_vertex(x, corner);
    int b = corner_vertex(x, next_corner(corner));
    return a < b ? b : a;
}

// Stable counting sort of corners by a vertex of theirs; start [V + 1] is scratch.
static void sort_corners(const ruga_examination* x, int (*key)(const ruga_examination*, int), int count,
                         const int* from, int* to, int* start) {
    int vertices = x->mesh->vertex_count;
    memset(start, 0, ((size_t)vertices + 1) * sizeof *start);
    for (int i = 0; i < count; i++) {
        start[key(x, from[i]) + 1]++;
    }
    for (int v = 0; v < vertices; v++) {
        start[v + 1] += start[v];
    }
    for (int i = 0; i < count; i++) {
        to[start[key(x, from[i])]++] = from[i];
    }
}

static int list_corners(const ruga_examination* x, int* corner) {
    int count = 0;
    for (int c = 0; c < 3 * x->mesh->triangle_count; c++) {
        if (!x->collapsed[c / 3]) {
            corner[count++] = c;
        }
    }
    return count;
}

// edge_start and corner_edge from the sorted corners.
static void number_edges(ruga_examination* x, int count) {
    x->edge_count = 0;
    for (int c = 0; c < 3 * x->mesh->triangle_count; c++) {
        x->corner_edge[c] = -1;
    }
    for (int i = 0; i < count; i++) {
        int corner = x->edge_corner[i];
        int before = i > 0 ? x->edge_corner[i - 1] : -1;
        if (before < 0 || low_vertex(x, corner) != low_vertex(x, before) ||
            high_vertex(x, corner) != high_vertex(x, before)) {
            x->edge_start[x->edge_count++] = i;
        }
        x->corner_edge[corner] = x->edge_count - 1;
    }
    x->edge_start[x->edge_count] = count;
    x->report->edge_count = x->edge_count;
}

static ruga_status build_edges(ruga_examination* x) {
    size_t corners = 3 * (size_t)x->mesh->triangle_count;
    int* scratch = NULL;
    int* start = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(x->edge_start, corners + 1));
    RUGA_TRY_DONE(RUGA_NEW(x->edge_corner, corners));
    RUGA_TRY_DONE(RUGA_NEW(x->corner_edge, corners));
    RUGA_TRY_DONE(RUGA_NEW(scratch, corners));
    RUGA_TRY_DONE(RUGA_NEW(start, (size_t)x->mesh->vertex_count + 1));
    int count = list_corners(x, x->edge_corner);
    sort_corners(x, high_vertex, count, x->edge_corner, scratch, start);
    sort_corners(x, low_vertex, count, scratch, x->edge_corner, start);
    number_edges(x, count);
done:
    ruga_release(scratch);
    ruga_release(start);
    return status;
}

static int faces_of_edge(const ruga_examination* x, int edge) {
    return x->edge_start[edge + 1] - x->edge_start[edge];
}

static int edge_corner(const ruga_examination* x, int edge, int i) {
    return x->edge_corner[x->edge_start[edge] + i];
}

// Exactly two faces, that run opposite ways.
static bool edge_is_sound(const ruga_examination* x, int edge) {
    return faces_of_edge(x, edge) == 2 &&
           corner_vertex(x, edge_corner(x, edge, 0)) != corner_vertex(x, edge_corner(x, edge, 1));
}

// ---- edges

static ruga_status examine_edges(ruga_examination* x) {
    bool sound = x->edge_count > 0;
    for (int e = 0; e < x->edge_count; e++) {
        int corner = edge_corner(x, e, 0);
        const int vertex[2] = {low_vertex(x, corner), high_vertex(x, corner)};
        int faces = faces_of_edge(x, e);
        const int face[2] = {corner / 3, faces > 1 ? edge_corner(x, e, 1) / 3 : -1};
        sound = sound && edge_is_sound(x, e);
        if (faces == 1 && x->as == RUGA_CHECK_EMBEDDED) {
            RUGA_TRY(ruga_examination_add(x, RUGA_DEFECT_OPEN_EDGE, vertex, face));
        } else if (faces > 2) {
            RUGA_TRY(ruga_examination_add(x, RUGA_DEFECT_NON_MANIFOLD_EDGE, vertex, face));
        }
    }
    x->report->watertight = sound;
    return RUGA_OK;
}

// ---- sets that grow together

static int find_root(int* parent, int i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

// The smaller index becomes the root, whatever the order of the calls.
static void unite(int* parent, int i, int j) {
    i = find_root(parent, i);
    j = find_root(parent, j);
    if (i < j) {
        parent[j] = i;
    } else {
        parent[i] = j;
    }
}

static ruga_status new_sets(int count, int** parent) {
    RUGA_TRY(RUGA_NEW(*parent, count));
    for (int i = 0; i < count; i++) {
        (*parent)[i] = i;
    }
    return RUGA_OK;
}

// ---- vertices

// Corners at a vertex are one fan where edges join them: two fans touch at the vertex only.
static void join_fans(const ruga_examination* x, int* parent) {
    for (int e = 0; e < x->edge_count; e++) {
        int first = edge_corner(x, e, 0);
        for (int i = 1; i < faces_of_edge(x, e); i++) {
            int other = edge_corner(x, e, i);
            bool same_way = corner_vertex(x, first) == corner_vertex(x, other);
            unite(parent, first, same_way ? other : next_corner(other));
            unite(parent, next_corner(first), same_way ? next_corner(other) : other);
        }
    }
}

static ruga_status examine_vertices(ruga_examination* x) {
    int corners = 3 * x->mesh->triangle_count;
    int* parent = NULL;
    int* fans = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(new_sets(corners, &parent));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(fans, x->mesh->vertex_count));
    join_fans(x, parent);
    for (int c = 0; c < corners; c++) {
        if (!x->collapsed[c / 3] && parent[c] == c) {
            fans[corner_vertex(x, c)]++;
        }
    }
    for (int v = 0; v < x->mesh->vertex_count; v++) {
        const int vertex[2] = {v, -1};
        if (fans[v] > 1) {
            RUGA_TRY_DONE(ruga_examination_add(x, RUGA_DEFECT_NON_MANIFOLD_VERTEX, vertex, nobody));
        }
        if (x->component[v] < 0) {
            RUGA_TRY_DONE(ruga_examination_add(x, RUGA_DEFECT_UNUSED_VERTEX, vertex, nobody));
        }
    }
done:
    ruga_release(parent);
    ruga_release(fans);
    return status;
}

// ---- components

// Numbered in the order of their first vertices.
static void number_components(ruga_examination* x, int* parent) {
    for (int v = 0; v < x->mesh->vertex_count; v++) {
        x->component[v] = -1;
    }
    for (int c = 0; c < 3 * x->mesh->triangle_count; c++) {
        x->component[corner_vertex(x, c)] = -2; // used, not yet numbered
    }
    for (int v = 0; v < x->mesh->vertex_count; v++) {
        if (x->component[v] == -2) {
            int root = find_root(parent, v);
            x->component[v] = root == v ? x->component_count++ : x->component[root];
        }
    }
    x->report->component_count = x->component_count;
}

static ruga_status find_components(ruga_examination* x) {
    int* parent = NULL;
    RUGA_TRY(RUGA_NEW(x->component, x->mesh->vertex_count));
    RUGA_TRY(new_sets(x->mesh->vertex_count, &parent));
    for (int c = 0; c < 3 * x->mesh->triangle_count; c++) {
        unite(parent, corner_vertex(x, c), corner_vertex(x, next_corner(c)));
    }
    number_components(x, parent);
    ruga_release(parent);
    RUGA_TRY(RUGA_NEW(x->closed, x->component_count));
    for (int i = 0; i < x->component_count; i++) {
        x->closed[i] = true;
    }
    for (int e = 0; e < x->edge_count; e++) {
        if (!edge_is_sound(x, e)) {
            x->closed[x->component[corner_vertex(x, edge_corner(x, e, 0))]] = false;
        }
    }
    return RUGA_OK;
}

static void measure_genus(const ruga_examination* x) {
    ruga_check_report* report = x->report;
    if (!report->watertight || report->count[RUGA_DEFECT_NON_MANIFOLD_VERTEX] > 0) {
        return;
    }
    int vertices = x->mesh->vertex_count - report->count[RUGA_DEFECT_UNUSED_VERTEX];
    int faces = 0;
    for (int f = 0; f < x->mesh->triangle_count; f++) {
        faces += !x->collapsed[f];
    }
    report->genus = x->component_count - (vertices - x->edge_count + faces) / 2;
}

// ---- orientation

typedef struct flood {
    signed char*
        side;   // [F] -1 = not reached yet; faces of a patch with different sides run against one another
    int* queue; // [F] faces of the patch in the order reached
} flood;

// Reaches all faces that edges with two faces connect to `first`; returns their number.
static int flood_patch(const ruga_examination* x, flood* f, int first) {
    int reached = 1;
    f->queue[0] = first;
    f->side[first] = 0;
    for (int done = 0; done < reached; done++) {
        int face = f->queue[done];
        for (int c = 3 * face; c < 3 * face + 3; c++) {
            int e = x->corner_edge[c];
            if (e < 0 || faces_of_edge(x, e) != 2) {
                continue;
            }
            int other = (edge_corner(x, e, 0) == c ? edge_corner(x, e, 1) : edge_corner(x, e, 0)) / 3;
            if (f->side[other] < 0) {
                f->side[other] = (signed char)(edge_is_sound(x, e) ? f->side[face] : 1 - f->side[face]);
                f->queue[reached++] = other;
            }
        }
    }
    return reached;
}

// Side 1 shall be the faces to flip: the fewer ones.
static void make_minority_one(flood* f, int count) {
    int ones = 0;
    for (int i = 0; i < count; i++) {
        ones += f->side[f->queue[i]];
    }
    for (int i = 0; i < count && 2 * ones > count; i++) {
        f->side[f->queue[i]] = (signed char)(1 - f->side[f->queue[i]]);
    }
}

// A patch with one side only (a Moebius strip) keeps edges that no flip can mend: a face at each is reported.
static void mark_unmendable(const ruga_examination* x, flood* f) {
    for (int e = 0; e < x->edge_count; e++) {
        if (faces_of_edge(x, e) != 2) {
            continue;
        }
        int a = edge_corner(x, e, 0) / 3;
        int b = edge_corner(x, e, 1) / 3;
        if (edge_is_sound(x, e) != ((f->side[a] & 1) == (f->side[b] & 1))) {
            f->side[b] |= 2;
        }
    }
}

static ruga_status examine_orientation(ruga_examination* x) {
    flood f = {0};
    int faces = x->mesh->triangle_count;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(f.side, faces));
    RUGA_TRY_DONE(RUGA_NEW(f.queue, faces));
    memset(f.side, -1, (size_t)faces);
    for (int i = 0; i < faces; i++) {
        if (f.side[i] < 0) {
            make_minority_one(&f, flood_patch(x, &f, i));
        }
    }
    mark_unmendable(x, &f);
    for (int i = 0; i < faces; i++) {
        if (f.side[i] != 0) {
            RUGA_TRY_DONE(ruga_examination_add(x, RUGA_DEFECT_FLIPPED_FACE, nobody, (const int[2]){i, -1}));
        }
    }
done:
    ruga_release(f.side);
    ruga_release(f.queue);
    return status;
}

// ---- duplicates

static void sorted_corners(const ruga_examination* x, int face, int sorted[3]) {
    memcpy(sorted, ruga_examined_face(x, face), 3 * sizeof *sorted);
    for (int i = 0; i < 3; i++) {
        int j = i == 2 ? 0 : i; // (0 1) (1 2) (0 1)
        if (sorted[j] > sorted[j + 1]) {
            int moved = sorted[j];
            sorted[j] = sorted[j + 1];
            sorted[j + 1] = moved;
        }
    }
}

// Faces with the same vertices share their edges: it is enough to look at the first edge of each.
static ruga_status examine_duplicates(ruga_examination* x) {
    for (int f = 0; f < x->mesh->triangle_count; f++) {
        int e = x->corner_edge[3 * (size_t)f];
        if (e < 0) {
            continue;
        }
        int mine[3];
        sorted_corners(x, f, mine);
        for (int i = 0; i < faces_of_edge(x, e); i++) {
            int theirs[3];
            int other = edge_corner(x, e, i) / 3;
            sorted_corners(x, other, theirs);
            if (other < f && memcmp(mine, theirs, sizeof mine) == 0) {
                const int face[2] = {f, other};
                RUGA_TRY(ruga_examination_add(x, RUGA_DEFECT_DUPLICATE_FACE, nobody, face));
                break;
            }
        }
    }
    return RUGA_OK;
}

ruga_status ruga_examine_topology(ruga_examination* x) {
    RUGA_TRY(build_edges(x));
    RUGA_TRY(find_components(x));
    RUGA_TRY(examine_edges(x));
    RUGA_TRY(examine_vertices(x));
    RUGA_TRY(examine_orientation(x));
    RUGA_TRY(examine_duplicates(x));
    measure_genus(x);
    return RUGA_OK;
}
