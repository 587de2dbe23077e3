// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The Delaunay triangulation that holds the segments covers the convex hull; from outside in, every segment
// that is crossed turns outside to inside or back.
#include "mesh/region.h"

#include "core/memory.h"
#include "mesh/cgal_shim.h"

#include <string.h>

typedef struct region {
    ruga_cgal_plane plane;
    int* side;   // [T] 1 = inside, 0 = outside, -1 = not reached yet
    int* queue;  // [T]
    int* number; // [points] of the mesh, -1 = in no triangle
    int* triangle;
    double* position;
} region;

static void find_sides(region* r) {
    const ruga_cgal_plane* p = &r->plane;
    int head = 0, tail = 0;
    memset(r->side, -1, (size_t)p->triangle_count * sizeof *r->side);
    for (int f = 0; f < p->triangle_count; f++) {
        for (int i = 0; i < 3; i++) {
            if (p->beside[f][i] < 0 && r->side[f] < 0) {
                r->side[f] = p->firm[f][i];
                r->queue[tail++] = f;
            }
        }
    }
    while (head < tail) {
        int f = r->queue[head++];
        for (int i = 0; i < 3; i++) {
            int next = p->beside[f][i];
            if (next >= 0 && r->side[next] < 0) {
                r->side[next] = r->side[f] ^ (int)p->firm[f][i];
                r->queue[tail++] = next;
            }
        }
    }
}

static ruga_status collect(region* r, int point_count, const double (*point)[2], ruga_mesh* mesh) {
    const ruga_cgal_plane* p = &r->plane;
    ruga_mesh_def def = {.positions = r->position, .triangles = r->triangle};
    memset(r->number, -1, (size_t)point_count * sizeof *r->number);
    for (int f = 0; f < p->triangle_count; f++) {
        for (int i = 0; i < 3 && r->side[f] == 1; i++) {
            int v = p->triangle[f][i];
            if (r->number[v] < 0) {
                double* x = r->position + 3 * (size_t)def.vertex_count;
                r->number[v] = def.vertex_count++;
                x[0] = point[v][0];
                x[1] = point[v][1];
                x[2] = 0;
            }
            r->triangle[3 * (size_t)def.triangle_count + (size_t)i] = r->number[v];
        }
        def.triangle_count += r->side[f] == 1;
    }
    return def.triangle_count > 0 ? ruga_mesh_from_def(&def, mesh)
                                  : ruga_fail(RUGA_BAD_INPUT, "the lines of the outline enclose nothing");
}

ruga_status ruga_mesh_from_region(int point_count, const double (*point)[2], int segment_count,
                                  const int (*segment)[2], ruga_mesh* mesh) {
    ruga_status status = RUGA_OK;
    region r = {.side = NULL};
    size_t most = 2 * (size_t)point_count;
    RUGA_TRY_DONE(RUGA_NEW(r.plane.triangle, most));
    RUGA_TRY_DONE(RUGA_NEW(r.plane.beside, most));
    RUGA_TRY_DONE(RUGA_NEW(r.plane.firm, most));
    RUGA_TRY_DONE(RUGA_NEW(r.side, most));
    RUGA_TRY_DONE(RUGA_NEW(r.queue, most));
    RUGA_TRY_DONE(RUGA_NEW(r.number, point_count));
    RUGA_TRY_DONE(RUGA_NEW(r.triangle, 3 * most));
    RUGA_TRY_DONE(RUGA_NEW(r.position, 3 * (size_t)point_count));
    RUGA_TRY_DONE(ruga_cgal_triangulate(point_count, point, segment_count, segment, &r.plane));
    find_sides(&r);
    RUGA_TRY_DONE(collect(&r, point_count, point, mesh));
done:
    ruga_release(r.plane.triangle);
    ruga_release(r.plane.beside);
    ruga_release(r.plane.firm);
    ruga_release(r.side);
    ruga_release(r.queue);
    ruga_release(r.number);
    ruga_release(r.triangle);
    ruga_release(r.position);
    return status;
}
