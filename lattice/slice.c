// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Cuts the surface by all planes of one axis after another (Remillard and Kry 2013, section 5.1, figure 5
// left). Only comparisons of single coordinates decide: a point exactly on a plane counts as on its positive
// side (as if each plane were moved by an infinitesimal amount), an edge is cut by the planes between the
// classes of its ends, and each cut point is made once and shared. What comes out is a closed triangulated
// surface whatever the coordinates are, rounding and coincidences included. Pieces are triangulated again
// after each axis, because a triangle meets a plane in at most one segment also where rounding has bent it,
// which holds for no other polygon.
#include "lattice/slice.h"

#include "core/memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct pass {
    ruga_slices* slices; // its edges and triangles are those cut so far
    int axis;
    int* class_of; // [points before the pass]
    int old_edge_count;
    ruga_cut_edge* old_edge;
    int old_triangle_count;
    ruga_cut_triangle* old_triangle;
    int* first_part; // [old edges] its parts follow each other in its direction
} pass;

void ruga_slices_clear(ruga_slices* slices) {
    ruga_release(slices->point);
    ruga_release(slices->edge);
    ruga_release(slices->edge_triangle);
    ruga_release(slices->triangle);
    ruga_release(slices->crossing);
    *slices = (ruga_slices){0};
}

// Point of the edge on a plane of the axis; its other coordinates never leave those of the edge's ends.
static void cut_point(const double a[3], const double b[3], int axis, double plane, double cut[3]) {
    double t = (plane - a[axis]) / (b[axis] - a[axis]);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int i = 0; i < 3; i++) {
        double d = b[i] - a[i];
        double value = t < 0.5 ? a[i] + t * d : b[i] - (1 - t) * d;
        double low = fmin(a[i], b[i]), high = fmax(a[i], b[i]);
        cut[i] = value < low ? low : value > high ? high : value;
    }
    cut[axis] = plane;
}

// A plane's edge meets another plane: the surface crosses the line that they share. The cap lies on the left
// of the edge, which tells whether the material begins or ends there.
static void add_crossing(ruga_slices* slices, const ruga_cut_edge* edge, int axis, int plane, bool upwards,
                         int point) {
    int along = 3 - axis - edge->axis;
    bool first_axis = axis == (edge->axis + 1) % 3;
    int planes[3] = {0};
    planes[axis] = plane;
    planes[edge->axis] = edge->index[edge->axis];
    double u = slices->point[point][along];
    // The axes before this one have been cut: there the edge's sub-cell holds, not the rounded coordinate.
    slices->crossing[slices->crossing_count++] = (ruga_crossing){
        .u = u,
        .axis = along,
        .line = {planes[(along + 1) % 3], planes[(along + 2) % 3]},
        .slab = along < axis ? edge->index[along] : ruga_slice_class(u),
        .sign = upwards == first_axis ? 1 : -1,
        .point = point,
    };
}

static ruga_status cut_edge(pass* pass, int e) {
    ruga_slices* slices = pass->slices;
    const ruga_cut_edge* old = &pass->old_edge[e];
    int from = pass->class_of[old->point[0]], to = pass->class_of[old->point[1]];
    bool upwards = to > from;
    int step = upwards ? 1 : -1, cuts = upwards ? to - from : from - to;
    RUGA_TRY(RUGA_RESERVE(slices->point, slices->point_capacity, (size_t)slices->point_count + (size_t)cuts));
    RUGA_TRY(
        RUGA_RESERVE(slices->edge, slices->edge_capacity, (size_t)slices->edge_count + (size_t)cuts + 1));
    RUGA_TRY(RUGA_RESERVE(slices->crossing, slices->crossing_capacity,
                          (size_t)slices->crossing_count + (size_t)cuts));
    pass->first_part[e] = slices->edge_count;
    int start = old->point[0];
    for (int t = 0; t <= cuts; t++) {
        int end = old->point[1];
        if (t < cuts) {
            int plane = upwards ? from + 1 + t : from - t;
            end = slices->point_count++;
            cut_point(slices->point[old->point[0]], slices->point[old->point[1]], pass->axis,
                      ruga_slice_plane(plane), slices->point[end]);
            if (old->axis >= 0) {
                add_crossing(slices, old, pass->axis, plane, upwards, end);
            }
        }
        ruga_cut_edge* part = &slices->edge[slices->edge_count++];
        *part = *old;
        part->point[0] = start;
        part->point[1] = end;
        part->index[pass->axis] = from + t * step;
        start = end;
    }
    return RUGA_OK;
}

// The loop of one piece: edges with the points where they start.
typedef struct loop {
    int count;
    int edge[5];
    int start[5];
} loop;

// Fan of triangles around the loop's first point.
static void add_piece(ruga_slices* slices, const loop* loop, const int index[3]) {
    int side = loop->edge[0];
    for (int i = 1; i + 1 < loop->count; i++) {
        int next = i + 2 == loop->count ? loop->edge[i + 1] : slices->edge_count;
        if (next == slices->edge_count) {
            slices->edge[slices->edge_count++] = (ruga_cut_edge){
                .point = {loop->start[0], loop->start[i + 1]},
                .index = {index[0], index[1], index[2]},
                .axis = -1,
            };
        }
        slices->triangle[slices->triangle_count++] = (ruga_cut_triangle){
            .point = {loop->start[0], loop->start[i], loop->start[i + 1]},
            .edge = {side, loop->edge[i], next},
            .index = {index[0], index[1], index[2]},
        };
        side = next;
    }
}

// The part of a triangle in one slab: of each side at most one part, and where the boundary leaves the slab a
// chord along its plane. `chord` is that on the lower plane, made with the slab below, and becomes that on
// the upper plane.
static void cut_slab(pass* pass, const ruga_cut_triangle* old, int slab, int* chord) {
    ruga_slices* slices = pass->slices;
    loop loop = {0};
    int index[3] = {old->index[0], old->index[1], old->index[2]};
    index[pass->axis] = slab;
    int lower = *chord, upper = -1, upper_at = -1;
    for (int i = 0; i < 3; i++) {
        const ruga_cut_edge* side = &pass->old_edge[old->edge[i]];
        int from = pass->class_of[old->point[i]], to = pass->class_of[old->point[(i + 1) % 3]];
        if ((slab < from && slab < to) || (slab > from && slab > to)) {
            continue;
        }
        bool along = side->point[0] == old->point[i];
        int part = pass->first_part[old->edge[i]] + abs(slab - (along ? from : to));
        loop.edge[loop.count] = part;
        loop.start[loop.count++] = slices->edge[part].point[along ? 0 : 1];
        if (to != slab) {
            loop.edge[loop.count] = to > slab ? slices->edge_count : lower;
            loop.start[loop.count] = slices->edge[part].point[along ? 1 : 0];
            upper_at = to > slab ? loop.count : upper_at;
            loop.count++;
        }
    }
    if (upper_at >= 0) {
        upper = slices->edge_count++;
        ruga_cut_edge* edge = &slices->edge[upper];
        // Runs as in the triangle above the plane, against this one.
        *edge = (ruga_cut_edge){.point = {loop.start[(upper_at + 1) % loop.count], loop.start[upper_at]},
                                .index = {index[0], index[1], index[2]},
                                .axis = pass->axis};
        edge->index[pass->axis] = slab + 1;
    }
    *chord = upper;
    add_piece(slices, &loop, index);
}

static ruga_status cut_triangle(pass* pass, const ruga_cut_triangle* old) {
    ruga_slices* slices = pass->slices;
    int low = INT32_MAX, high = INT32_MIN;
    for (int i = 0; i < 3; i++) {
        int c = pass->class_of[old->point[i]];
        low = c < low ? c : low;
        high = c > high ? c : high;
    }
    // A piece has at most five corners: one chord and two diagonals, three triangles.
    size_t most = 3 * ((size_t)(high - low) + 1);
    RUGA_TRY(RUGA_RESERVE(slices->edge, slices->edge_capacity, (size_t)slices->edge_count + most));
    RUGA_TRY(
        RUGA_RESERVE(slices->triangle, slices->triangle_capacity, (size_t)slices->triangle_count + most));
    int chord = -1;
    for (int slab = low; slab <= high; slab++) {
        cut_slab(pass, old, slab, &chord);
    }
    return RUGA_OK;
}

static ruga_status cut_axis(ruga_slices* slices, int axis) {
    pass pass = {.slices = slices,
                 .axis = axis,
                 .old_edge_count = slices->edge_count,
                 .old_edge = slices->edge,
                 .old_triangle_count = slices->triangle_count,
                 .old_triangle = slices->triangle};
    slices->edge = NULL;
    slices->triangle = NULL;
    slices->edge_count = slices->edge_capacity = 0;
    slices->triangle_count = slices->triangle_capacity = 0;
    ruga_status status;
    int points = slices->point_count;
    RUGA_TRY_DONE(RUGA_NEW(pass.class_of, points));
    RUGA_TRY_DONE(RUGA_NEW(pass.first_part, pass.old_edge_count));
    for (int p = 0; p < points; p++) {
        pass.class_of[p] = ruga_slice_class(slices->point[p][axis]);
    }
    for (int e = 0; e < pass.old_edge_count; e++) {
        RUGA_TRY_DONE(cut_edge(&pass, e));
    }
    for (int t = 0; t < pass.old_triangle_count; t++) {
        RUGA_TRY_DONE(cut_triangle(&pass, &pass.old_triangle[t]));
    }
done:
    ruga_release(pass.class_of);
    ruga_release(pass.first_part);
    ruga_release(pass.old_edge);
    ruga_release(pass.old_triangle);
    return status;
}

static ruga_status start_from_mesh(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                   const double (*u)[3], ruga_slices* slices) {
    int points = mesh->vertex_count, edges = connectivity->edge_count, triangles = mesh->triangle_count;
    RUGA_TRY(RUGA_RESERVE(slices->point, slices->point_capacity, points));
    RUGA_TRY(RUGA_RESERVE(slices->edge, slices->edge_capacity, edges));
    RUGA_TRY(RUGA_RESERVE(slices->triangle, slices->triangle_capacity, triangles));
    memcpy(slices->point, u, (size_t)points * sizeof *u);
    slices->point_count = points;
    for (int e = 0; e < edges; e++) {
        const int* ends = connectivity->edge[e];
        slices->edge[e] = (ruga_cut_edge){.point = {ends[0], ends[1]}, .axis = -1};
    }
    slices->edge_count = edges;
    for (int t = 0; t < triangles; t++) {
        for (int i = 0; i < 3; i++) {
            slices->triangle[t].point[i] = mesh->triangle[3 * t + i];
            slices->triangle[t].edge[i] = connectivity->triangle_edge[t][i];
            slices->triangle[t].index[i] = 0;
        }
    }
    slices->triangle_count = triangles;
    return RUGA_OK;
}

ruga_status ruga_slices_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                               const double (*u)[3], ruga_slices* slices) {
    *slices = (ruga_slices){0};
    ruga_status status;
    RUGA_TRY_DONE(start_from_mesh(mesh, connectivity, u, slices));
    for (int axis = 0; axis < 3; axis++) {
        RUGA_TRY_DONE(cut_axis(slices, axis));
    }
    RUGA_TRY_DONE(RUGA_NEW(slices->edge_triangle, slices->edge_count));
    for (int t = 0; t < slices->triangle_count; t++) {
        const ruga_cut_triangle* triangle = &slices->triangle[t];
        for (int i = 0; i < 3; i++) {
            int e = triangle->edge[i];
            bool along = slices->edge[e].point[0] == triangle->point[i];
            slices->edge_triangle[e][along ? 0 : 1] = t;
        }
    }
done:
    if (status != RUGA_OK) {
        ruga_slices_clear(slices);
    }
    return status;
}
