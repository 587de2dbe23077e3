// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The triangle mesh: flat arrays, with what a user's file carried beside them.
#ifndef RUGA_MESH_MESH_H
#define RUGA_MESH_MESH_H

#include "core/status.h"
#include "ruga/types.h"

typedef struct ruga_mesh {
    int vertex_count;
    double* position; // [V][3]
    int triangle_count;
    int* triangle; // [F][3]
    int uv_count;
    double* uv;       // [U][2], NULL where there are none
    int* uv_triangle; // [F][3], -1 where a corner has no uv; NULL where there are none
    int group_count;
    char** group_name; // [G]
    int* face_group;   // [F] or -1; NULL where there are no groups
    int* polygon;      // [F] the polygon of the file that the triangle came from; NULL = itself
    int* source_vertex; // [V] vertex of the file, -1 = new; NULL = itself
    int attribute_count;
    char** attribute_name; // [A] numbers that a file has for each vertex; NULL where there are none
    double* attribute;     // [V][A] as in the file
} ruga_mesh;

// Frees the arrays (not the struct) and zeroes it.
void ruga_mesh_clear(ruga_mesh* mesh);
ruga_status ruga_mesh_copy(const ruga_mesh* source, ruga_mesh* copy);
// Deep copy of a caller's arrays. Indices out of range: RUGA_BAD_INPUT with the face.
ruga_status ruga_mesh_from_def(const ruga_mesh_def* def, ruga_mesh* mesh);
// A view: the pointers are the mesh's own.
ruga_mesh_def ruga_mesh_as_def(const ruga_mesh* mesh);

// Index of a group, -1 = there is none of this name (which may be NULL).
int ruga_mesh_find_group(const ruga_mesh* mesh, const char* name);
// Index of an attribute, -1 = there is none of this name.
int ruga_mesh_find_attribute(const ruga_mesh* mesh, const char* name);
// Takes over names and number of the attributes of `source`, with room for their values, which are not set.
ruga_status ruga_mesh_allocate_attributes(const ruga_mesh* source, ruga_mesh* mesh);

// Keeps the faces of one group (or of several) and the vertices that they use, in their old order; groups
// and source_vertex follow. RUGA_BAD_INPUT with the names that exist where one does not.
ruga_status ruga_mesh_extract_groups(const ruga_mesh* mesh, int count, const char* const* names,
                                     ruga_mesh* part);

// (b - a) x (c - a) of a triangle's corners at rest: twice its area, along its normal.
void ruga_mesh_triangle_normal(const ruga_mesh* mesh, int f, double n[3]);
double ruga_mesh_triangle_area(const ruga_mesh* mesh, int f);
void ruga_mesh_bounds(const ruga_mesh* mesh, double min[3], double max[3]);
double ruga_mesh_area(const ruga_mesh* mesh);
// Signed volume by the divergence theorem; meaningful for a closed mesh.
double ruga_mesh_volume(const ruga_mesh* mesh);
double ruga_mesh_mean_edge(const ruga_mesh* mesh);
// One third of the area of the triangles around each vertex, area [V].
void ruga_mesh_vertex_areas(const ruga_mesh* mesh, double* area);
// Mean of each triangle's three corners: vertex [V][components] to triangle [F][components]. Equal values
// keep their bits.
void ruga_mesh_triangle_averages(const ruga_mesh* mesh, int components, const double* vertex,
                                 double* triangle);
// Area-weighted unit normals at given positions [V][3]; normal [V][3].
void ruga_mesh_vertex_normals(const ruga_mesh* mesh, const double* position, double* normal);
// 64-bit FNV-1a hash of positions and triangles.
uint64_t ruga_mesh_hash(const ruga_mesh* mesh);

#endif
