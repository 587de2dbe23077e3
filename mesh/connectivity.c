// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Edges by two stable counting sorts of the 3 F half-edges (by the larger vertex, then by the smaller):
// O(V + F), lexicographic, and the same on every machine. Components by union-find with the smaller root
// kept, so that they are numbered by their first vertex.
#include "mesh/connectivity.h"

#include "core/memory.h"

#include <limits.h>
#include <string.h>

void ruga_connectivity_clear(ruga_connectivity* connectivity) {
    ruga_release(connectivity->edge);
    ruga_release(connectivity->edge_triangle);
    ruga_release(connectivity->edge_opposite);
    ruga_release(connectivity->triangle_edge);
    ruga_release(connectivity->neighbour_start);
    ruga_release(connectivity->neighbour);
    ruga_release(connectivity->neighbour_edge);
    ruga_release(connectivity->incident_start);
    ruga_release(connectivity->incident);
    ruga_release(connectivity->component);
    memset(connectivity, 0, sizeof *connectivity);
}

// Half-edge 3 f + i runs from corner i to corner i + 1.
static int half_from(const ruga_mesh* mesh, int half) {
    return mesh->triangle[half];
}

static int half_to(const ruga_mesh* mesh, int half) {
    return mesh->triangle[half % 3 == 2 ? half - 2 : half + 1];
}

static int half_key(const ruga_mesh* mesh, int half, bool larger) {
    int a = half_from(mesh, half), b = half_to(mesh, half);
    return (a < b) == larger ? b : a;
}

// Stable: sorted[] = the half-edges of order[] by their larger or smaller vertex. start [V + 1] is scratch.
static void sort_halves(const ruga_mesh* mesh, bool larger, const int* order, int* sorted, int* start) {
    int count = 3 * mesh->triangle_count;
    memset(start, 0, ((size_t)mesh->vertex_count + 1) * sizeof *start);
    for (int i = 0; i < count; i++) {
        start[half_key(mesh, i, larger) + 1]++;
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        start[v + 1] += start[v];
    }
    for (int i = 0; i < count; i++) {
        int half = order ? order[i] : i;
        sorted[start[half_key(mesh, half, larger)]++] = half;
    }
}

static ruga_status check_faces(const ruga_mesh* mesh) {
    if (mesh->triangle_count > INT_MAX / 3) {
        return ruga_fail(RUGA_BAD_MESH, "the mesh has %d faces: at most %d can be used", mesh->triangle_count,
                         INT_MAX / 3);
    }
    for (int f = 0; f < mesh->triangle_count; f++) {
        const int* t = mesh->triangle + 3 * (size_t)f;
        for (int i = 0; i < 3; i++) {
            if (t[i] < 0 || t[i] >= mesh->vertex_count) {
                return ruga_fail(RUGA_BAD_MESH, "face %d names vertex %d, which does not exist", f, t[i]);
            }
        }
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
            return ruga_fail(RUGA_BAD_MESH, "face %d uses a vertex twice (%d, %d, %d): delete it", f, t[0],
                             t[1], t[2]);
        }
    }
    return RUGA_OK;
}

static bool same_edge(const ruga_mesh* mesh, int a, int b) {
    return half_key(mesh, a, false) == half_key(mesh, b, false) &&
           half_key(mesh, a, true) == half_key(mesh, b, true);
}

static ruga_status fail_at(const ruga_mesh* mesh, int half, const char* what) {
    int a = half_key(mesh, half, false), b = half_key(mesh, half, true);
    const double *x = mesh->position + 3 * (size_t)a, *y = mesh->position + 3 * (size_t)b;
    return ruga_fail(RUGA_BAD_MESH, "the edge between vertices %d and %d near (%.6g, %.6g, %.6g) %s", a, b,
                     (x[0] + y[0]) / 2, (x[1] + y[1]) / 2, (x[2] + y[2]) / 2, what);
}

// Number of edges in sorted half-edges, or a failure where one is not manifold.
static ruga_status count_edges(const ruga_mesh* mesh, const int* sorted, int* edge_count) {
    int count = 3 * mesh->triangle_count;
    *edge_count = 0;
    for (int i = 0, next; i < count; i = next) {
        next = i + 1;
        while (next < count && same_edge(mesh, sorted[i], sorted[next])) {
            next++;
        }
        if (next - i > 2) {
            return fail_at(mesh, sorted[i], "belongs to more than two faces");
        }
        if (next - i == 2 && half_from(mesh, sorted[i]) == half_from(mesh, sorted[i + 1])) {
            return fail_at(mesh, sorted[i], "is run the same way by both its faces: flip one of them");
        }
        ++*edge_count;
    }
    return RUGA_OK;
}

static void fill_edges(const ruga_mesh* mesh, const int* sorted, ruga_connectivity* c) {
    int count = 3 * mesh->triangle_count;
    int e = -1;
    for (int i = 0; i < count; i++) {
        int half = sorted[i], face = half / 3;
        if (i == 0 || !same_edge(mesh, sorted[i - 1], half)) {
            e++;
            c->edge[e][0] = half_key(mesh, half, false);
            c->edge[e][1] = half_key(mesh, half, true);
            for (int side = 0; side < 2; side++) {
                c->edge_triangle[e][side] = c->edge_opposite[e][side] = -1;
            }
        }
        int side = half_from(mesh, half) == c->edge[e][0] ? 0 : 1;
        c->edge_triangle[e][side] = face;
        c->edge_opposite[e][side] = mesh->triangle[3 * face + (half % 3 + 2) % 3];
        c->triangle_edge[face][half % 3] = e;
    }
}

// Edges are sorted, so that for a vertex v the edges (u, v) with u < v come before those (v, w): neighbours
// are met in ascending order.
static ruga_status fill_neighbours(ruga_connectivity* c) {
    RUGA_TRY(RUGA_NEW_ZERO(c->neighbour_start, (size_t)c->vertex_count + 1));
    RUGA_TRY(RUGA_NEW(c->neighbour, 2 * (size_t)c->edge_count));
    RUGA_TRY(RUGA_NEW(c->neighbour_edge, 2 * (size_t)c->edge_count));
    int* start = c->neighbour_start;
    for (int e = 0; e < c->edge_count; e++) {
        start[c->edge[e][0]]++;
        start[c->edge[e][1]]++;
    }
    // start[v] = end of v's range, filled backwards to its beginning.
    for (int v = 0; v < c->vertex_count; v++) {
        start[v + 1] += start[v];
    }
    for (int e = c->edge_count - 1; e >= 0; e--) {
        for (int side = 0; side < 2; side++) {
            int place = --start[c->edge[e][side]];
            c->neighbour[place] = c->edge[e][1 - side];
            c->neighbour_edge[place] = e;
        }
    }
    return RUGA_OK;
}

static ruga_status fill_incident(const ruga_mesh* mesh, ruga_connectivity* c) {
    RUGA_TRY(RUGA_NEW_ZERO(c->incident_start, (size_t)c->vertex_count + 1));
    RUGA_TRY(RUGA_NEW(c->incident, 3 * (size_t)c->triangle_count));
    int* start = c->incident_start;
    for (int i = 0; i < 3 * c->triangle_count; i++) {
        start[mesh->triangle[i]]++;
    }
    for (int v = 0; v < c->vertex_count; v++) {
        start[v + 1] += start[v];
    }
    for (int i = 3 * c->triangle_count - 1; i >= 0; i--) {
        c->incident[--start[mesh->triangle[i]]] = i / 3;
    }
    return RUGA_OK;
}

static int find_root(int* parent, int v) {
    while (parent[v] != v) {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    return v;
}

static ruga_status fill_components(ruga_connectivity* c) {
    RUGA_TRY(RUGA_NEW(c->component, c->vertex_count));
    int* parent = NULL;
    RUGA_TRY(RUGA_NEW(parent, c->vertex_count));
    for (int v = 0; v < c->vertex_count; v++) {
        parent[v] = v;
    }
    for (int e = 0; e < c->edge_count; e++) {
        int a = find_root(parent, c->edge[e][0]), b = find_root(parent, c->edge[e][1]);
        parent[a > b ? a : b] = a < b ? a : b;
    }
    // A root is the smallest vertex of its component: it is numbered before the others are met.
    for (int v = 0; v < c->vertex_count; v++) {
        int root = find_root(parent, v);
        bool used = c->incident_start[v + 1] > c->incident_start[v];
        c->component[v] = !used ? -1 : root == v ? c->component_count++ : c->component[root];
    }
    ruga_release(parent);
    return RUGA_OK;
}

static ruga_status build(const ruga_mesh* mesh, const int* sorted, ruga_connectivity* c) {
    c->vertex_count = mesh->vertex_count;
    c->triangle_count = mesh->triangle_count;
    RUGA_TRY(count_edges(mesh, sorted, &c->edge_count));
    RUGA_TRY(RUGA_NEW(c->edge, c->edge_count));
    RUGA_TRY(RUGA_NEW(c->edge_triangle, c->edge_count));
    RUGA_TRY(RUGA_NEW(c->edge_opposite, c->edge_count));
    RUGA_TRY(RUGA_NEW(c->triangle_edge, c->triangle_count));
    fill_edges(mesh, sorted, c);
    RUGA_TRY(fill_neighbours(c));
    RUGA_TRY(fill_incident(mesh, c));
    return fill_components(c);
}

ruga_status ruga_connectivity_create(const ruga_mesh* mesh, ruga_connectivity* connectivity) {
    memset(connectivity, 0, sizeof *connectivity);
    RUGA_TRY(check_faces(mesh));
    ruga_status status = RUGA_OK;
    int *by_larger = NULL, *sorted = NULL, *start = NULL;
    RUGA_TRY_DONE(RUGA_NEW(by_larger, 3 * (size_t)mesh->triangle_count));
    RUGA_TRY_DONE(RUGA_NEW(sorted, 3 * (size_t)mesh->triangle_count));
    RUGA_TRY_DONE(RUGA_NEW(start, (size_t)mesh->vertex_count + 1));
    sort_halves(mesh, true, NULL, by_larger, start);
    sort_halves(mesh, false, by_larger, sorted, start);
    RUGA_TRY_DONE(build(mesh, sorted, connectivity));
done:
    ruga_release(by_larger);
    ruga_release(sorted);
    ruga_release(start);
    if (status != RUGA_OK) {
        ruga_connectivity_clear(connectivity);
    }
    return status;
}
