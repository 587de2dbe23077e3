// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Sets of mesh edges become paths: a path starts where the number of marked edges at a vertex is not two and
// runs until the next such vertex; what is left consists of closed loops. Paths are found in the order of
// their first vertex, so that the same set gives the same curves.
#include "crease/curve.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

void ruga_curves_clear(ruga_curves* curves) {
    for (int c = 0; c < curves->count; c++) {
        ruga_release(curves->curve[c].point);
        ruga_release(curves->curve[c].vertex);
    }
    ruga_release(curves->curve);
    *curves = (ruga_curves){0};
}

int ruga_edge_between(const ruga_connectivity* edges, int a, int b) {
    for (int k = edges->neighbour_start[a]; k < edges->neighbour_start[a + 1]; k++) {
        if (edges->neighbour[k] == b) {
            return edges->neighbour_edge[k];
        }
    }
    return -1;
}

// A new curve with room for its points; vertices are -1. It belongs to `curves` from the start, so that a
// failure leaks nothing.
static ruga_status add(ruga_curves* curves, const ruga_curve* style, int count) {
    if (count < (style->closed ? 3 : 2)) {
        return ruga_fail(RUGA_BAD_INPUT, "crease curve %d has %d points: %s", curves->count, count,
                         style->closed ? "a closed one needs three" : "it needs two");
    }
    RUGA_TRY(RUGA_RESERVE(curves->curve, curves->capacity, (size_t)curves->count + 1));
    ruga_curve* curve = &curves->curve[curves->count];
    *curve = *style;
    curve->point_count = count;
    curve->point = NULL;
    curve->vertex = NULL;
    curves->count++;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(curve->point, count));
    RUGA_TRY_DONE(RUGA_NEW(curve->vertex, count));
    for (int i = 0; i < count; i++) {
        curve->vertex[i] = -1;
    }
done:
    if (status != RUGA_OK) {
        ruga_release(curve->point);
        ruga_release(curve->vertex);
        curves->count--;
    }
    return status;
}

ruga_status ruga_curves_add_polyline(ruga_curves* curves, const ruga_curve* style, int count,
                                     const double (*point)[3]) {
    bool long_enough = false;
    for (int i = 0; i < count; i++) {
        if (!isfinite(point[i][0]) || !isfinite(point[i][1]) || !isfinite(point[i][2])) {
            return ruga_fail(RUGA_BAD_INPUT, "point %d of crease curve %d is not finite", i, curves->count);
        }
        long_enough = long_enough || ruga_distance(point[0], point[i]) > 0;
    }
    if (!long_enough) {
        return ruga_fail(RUGA_BAD_INPUT, "crease curve %d has no length: its points are all (%g, %g, %g)",
                         curves->count, point[0][0], point[0][1], point[0][2]);
    }
    RUGA_TRY(add(curves, style, count));
    ruga_curve* curve = &curves->curve[curves->count - 1];
    memcpy(curve->point, point, (size_t)count * sizeof *point);
    return RUGA_OK;
}

static ruga_status add_path(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh, int count,
                            const int* vertex) {
    RUGA_TRY(add(curves, style, count));
    ruga_curve* curve = &curves->curve[curves->count - 1];
    for (int i = 0; i < count; i++) {
        curve->vertex[i] = vertex[i];
        memcpy(curve->point[i], mesh->position + 3 * (size_t)vertex[i], sizeof curve->point[i]);
    }
    return RUGA_OK;
}

ruga_status ruga_curves_add_path(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh,
                                 const ruga_connectivity* edges, int count, const int* vertex) {
    for (int i = 0; i < count; i++) {
        if (vertex[i] < 0 || vertex[i] >= mesh->vertex_count) {
            return ruga_fail(RUGA_BAD_INPUT, "crease curve %d names vertex %d, which does not exist",
                             curves->count, vertex[i]);
        }
    }
    for (int i = 0; i + !style->closed < count; i++) {
        int a = vertex[i], b = vertex[(i + 1) % count];
        if (ruga_edge_between(edges, a, b) < 0) {
            return ruga_fail(
                RUGA_BAD_INPUT,
                "crease curve %d: no edge joins vertices %d and %d: give the path vertex by vertex, or "
                "draw a polyline",
                curves->count, a, b);
        }
    }
    return add_path(curves, style, mesh, count, vertex);
}

// ------------------------------------------------------------------------------- sets of edges

typedef struct chains {
    const ruga_connectivity* edges;
    bool* open;  // [E] marked and not yet part of a path
    int* degree; // [V] marked edges
    int* path;   // [E + 1]
} chains;

// An open edge at v; -1 = none. *w is its other end.
static int next_edge(const chains* c, int v, int* w) {
    for (int k = c->edges->neighbour_start[v]; k < c->edges->neighbour_start[v + 1]; k++) {
        if (c->open[c->edges->neighbour_edge[k]]) {
            *w = c->edges->neighbour[k];
            return c->edges->neighbour_edge[k];
        }
    }
    return -1;
}

// Follows open edges from v until a vertex that does not have two marked ones, or back to the start.
static int follow(chains* c, int v) {
    int count = 0, start = v;
    c->path[count++] = v;
    for (int w = -1, e = next_edge(c, v, &w); e >= 0; e = next_edge(c, v, &w)) {
        c->open[e] = false;
        c->path[count++] = v = w;
        if (c->degree[v] != 2 || v == start) {
            break;
        }
    }
    return count;
}

static ruga_status add_chains(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh,
                              chains* c) {
    for (int pass = 0; pass < 2; pass++) {
        for (int v = 0; v < c->edges->vertex_count; v++) {
            int w;
            while ((pass == 1 || (c->degree[v] != 2 && c->degree[v] > 0)) && next_edge(c, v, &w) >= 0) {
                int count = follow(c, v);
                ruga_curve own = *style;
                own.closed = c->path[0] == c->path[count - 1];
                RUGA_TRY(add_path(curves, &own, mesh, own.closed ? count - 1 : count, c->path));
            }
        }
    }
    return RUGA_OK;
}

ruga_status ruga_curves_add_edges(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh,
                                  const ruga_connectivity* edges, const bool* marked) {
    ruga_status status = RUGA_OK;
    chains c = {.edges = edges};
    RUGA_TRY_DONE(RUGA_NEW(c.open, edges->edge_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(c.degree, edges->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(c.path, (size_t)edges->edge_count + 1));
    for (int e = 0; e < edges->edge_count; e++) {
        c.open[e] = marked[e];
        c.degree[edges->edge[e][0]] += marked[e];
        c.degree[edges->edge[e][1]] += marked[e];
    }
    RUGA_TRY_DONE(add_chains(curves, style, mesh, &c));
done:
    ruga_release(c.open);
    ruga_release(c.degree);
    ruga_release(c.path);
    return status;
}

ruga_status ruga_curves_add_border(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh,
                                   const ruga_connectivity* edges, const char* group) {
    int g = mesh->face_group ? ruga_mesh_find_group(mesh, group) : -1;
    if (g < 0) {
        return ruga_fail(RUGA_BAD_INPUT, "a crease follows the group \"%s\", which the mesh does not have",
                         group);
    }
    bool* marked = NULL;
    int count = 0;
    RUGA_TRY(RUGA_NEW(marked, edges->edge_count));
    for (int e = 0; e < edges->edge_count; e++) {
        const int* f = edges->edge_triangle[e];
        marked[e] = f[0] >= 0 && f[1] >= 0 && (mesh->face_group[f[0]] == g) != (mesh->face_group[f[1]] == g);
        count += marked[e];
    }
    ruga_status status = count > 0
                             ? ruga_curves_add_edges(curves, style, mesh, edges, marked)
                             : ruga_fail(RUGA_BAD_INPUT,
                                         "a crease follows the border of the group \"%s\", but no other "
                                         "faces lie beside it",
                                         group);
    ruga_release(marked);
    return status;
}

// ------------------------------------------------------------------------------- texture coordinates

// Point of the surface whose uv lies in face f, if it does: the least weight decides, with a little slack.
static bool lift(const ruga_mesh* mesh, int f, const double uv[2], double x[3]) {
    const int* u = mesh->uv_triangle + 3 * (size_t)f;
    if (u[0] < 0 || u[1] < 0 || u[2] < 0) {
        return false;
    }
    const double *a = mesh->uv + 2 * (size_t)u[0], *b = mesh->uv + 2 * (size_t)u[1],
                 *c = mesh->uv + 2 * (size_t)u[2];
    double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    double v = ((uv[0] - a[0]) * (c[1] - a[1]) - (uv[1] - a[1]) * (c[0] - a[0])) / area;
    double w = ((b[0] - a[0]) * (uv[1] - a[1]) - (b[1] - a[1]) * (uv[0] - a[0])) / area;
    static const double slack = 1e-9;
    if (!(v >= -slack && w >= -slack && v + w <= 1 + slack)) {
        return false;
    }
    const int* corner = mesh->triangle + 3 * (size_t)f;
    memset(x, 0, 3 * sizeof *x);
    ruga_add_scaled(1 - v - w, mesh->position + 3 * (size_t)corner[0], x);
    ruga_add_scaled(v, mesh->position + 3 * (size_t)corner[1], x);
    ruga_add_scaled(w, mesh->position + 3 * (size_t)corner[2], x);
    return true;
}

ruga_status ruga_curves_add_uv(ruga_curves* curves, const ruga_curve* style, const ruga_mesh* mesh, int count,
                               const double (*uv)[2]) {
    if (!mesh->uv_triangle) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "a crease is drawn in texture coordinates, but the mesh has none: give a polyline in "
            "space");
    }
    double(*point)[3] = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(point, count));
    for (int i = 0; i < count; i++) {
        bool found = false;
        for (int f = 0; f < mesh->triangle_count && !found; f++) {
            found = lift(mesh, f, uv[i], point[i]);
        }
        if (!found) {
            status = ruga_fail(
                RUGA_BAD_INPUT,
                "point %d of crease curve %d, (%.6g, %.6g) in texture coordinates, lies in no face's "
                "image",
                i, curves->count, uv[i][0], uv[i][1]);
            goto done;
        }
    }
    RUGA_TRY_DONE(ruga_curves_add_polyline(curves, style, count, (const double(*)[3])point));
done:
    ruga_release(point);
    return status;
}
