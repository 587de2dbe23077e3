// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What Ruga takes from CGAL: exact predicates, box intersection, nearest points, isotropic remeshing and
// plane triangulations.
#ifndef RUGA_MESH_CGAL_SHIM_H
#define RUGA_MESH_CGAL_SHIM_H

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

// Exact sign of det[b - a, c - a, d - a]: 1 where d is on the side that the normal of (a, b, c) points to.
int ruga_cgal_orientation(const double a[3], const double b[3], const double c[3], const double d[3]);

// Calls pair(a, b, context) for all a, b whose boxes box[i] = {min x, y, z, max x, y, z} meet, in no
// particular order. The callback's status other than RUGA_OK ends the call and is handed back.
typedef ruga_status ruga_cgal_pair_function(int a, int b, void* context);
ruga_status ruga_cgal_box_pairs(int count, const double (*box)[6], ruga_cgal_pair_function* pair,
                                void* context);

// The nearest triangle of a fixed set.
typedef struct ruga_cgal_locator ruga_cgal_locator;
ruga_status ruga_cgal_locator_create(const double* position, int triangle_count, const int* triangle,
                                     ruga_cgal_locator** locator);
void ruga_cgal_locator_destroy(ruga_cgal_locator** locator);
// For each of the points [count][3], its nearest triangle, face [count], and the point of it, nearest
// [count][3].
ruga_status ruga_cgal_locator_nearest(const ruga_cgal_locator* locator, int count, const double* point,
                                      int* face, double* nearest);

// A triangle mesh being remeshed; vertices without faces are left out. Patches are kept apart: a face belongs
// to one, edges between two patches, features and open boundaries are split and collapsed along themselves
// only, fixed vertices stay.
typedef struct ruga_cgal_surface ruga_cgal_surface;
typedef struct ruga_cgal_surface_def {
    int vertex_count;
    const double* position; // [V][3]
    const bool* fixed;      // [V]
    int triangle_count;
    const int* triangle; // [F][3]
    const int* patch;    // [F] 0-based
    int feature_count;
    const int (*feature)[2]; // [feature_count] vertices of an edge
} ruga_cgal_surface_def;
ruga_status ruga_cgal_surface_create(const ruga_cgal_surface_def* def, ruga_cgal_surface** surface);
void ruga_cgal_surface_destroy(ruga_cgal_surface** surface);
ruga_status ruga_cgal_surface_remesh(ruga_cgal_surface* surface, double edge, int iterations,
                                     int relaxations);
// Mean length of the edges, and the root mean square of log(length / edge).
void ruga_cgal_surface_edges(const ruga_cgal_surface* surface, double edge, double* mean, double* spread);
int ruga_cgal_surface_vertex_count(const ruga_cgal_surface* surface);
int ruga_cgal_surface_triangle_count(const ruga_cgal_surface* surface);
// position [V][3], triangle [F][3], patch [F]
ruga_status ruga_cgal_surface_get(const ruga_cgal_surface* surface, double* position, int* triangle,
                                  int* patch);

// The constrained Delaunay triangulation of points in the plane, over their convex hull. Segments must not
// cross.
typedef struct ruga_cgal_plane {
    int triangle_count;
    int (*triangle)[3]; // [2 V] points, counter-clockwise
    int (*beside)[3];   // [2 V] triangle across the side opposite to a corner, -1 = none
    bool (*firm)[3];    // [2 V] that side is a segment
} ruga_cgal_plane;
// The caller gives the arrays. Points that coincide with an earlier one are in no triangle.
ruga_status ruga_cgal_triangulate(int point_count, const double (*point)[2], int segment_count,
                                  const int (*segment)[2], ruga_cgal_plane* plane);

#ifdef __cplusplus
}
#endif
#endif
