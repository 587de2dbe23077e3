// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The mesh while creases are being drawn on it: vertices may be moved within the surface, edges and faces may
// be split, and what the mesh carries (texture coordinates, groups, attributes, source vertices) follows.
// Vertices keep their numbers, new ones come behind them; edges are numbered anew by every change.
#ifndef RUGA_CREASE_SHEET_H
#define RUGA_CREASE_SHEET_H

#include "mesh/connectivity.h"
#include "mesh/mesh.h"

typedef struct ruga_sheet {
    ruga_mesh mesh;
    ruga_connectivity edges;
    double edge;  // m, mean edge length of the mesh that was given
    bool* pinned; // [V] on a crease: never moved
    bool* firm;   // [E] boundary, border between groups, or seam of texture coordinates
    bool* seam;   // [V] with several texture coordinates
} ruga_sheet;

typedef enum ruga_edit_kind { RUGA_EDIT_MOVE, RUGA_EDIT_EDGE, RUGA_EDIT_FACE } ruga_edit_kind;

// One change. The faces it touches (those around a moved vertex, beside a split edge, the split face) must
// not be touched by another change of the same call.
typedef struct ruga_edit {
    ruga_edit_kind kind;
    int element;        // vertex, edge or face
    double position[3]; // m, where the moved or new vertex is to be
    double place;       // edge: from edge[0] to edge[1], in (0, 1)
    int face;           // the face that `position` lies in; -1 (edge only) = on the edge itself
    double weight[3];   // its weights there
    int vertex;         // out: the moved or new vertex
} ruga_edit;

ruga_status ruga_sheet_create(const ruga_mesh* mesh, ruga_sheet* sheet);
void ruga_sheet_clear(ruga_sheet* sheet);
// All or nothing but for lack of memory. The moved and new vertices are pinned where `pin`.
ruga_status ruga_sheet_apply(ruga_sheet* sheet, int count, ruga_edit* edit, bool pin);

const double* ruga_sheet_position(const ruga_sheet* sheet, int v);
// Unit normal of a face; of a vertex, weighted by area.
void ruga_sheet_face_normal(const ruga_sheet* sheet, int f, double n[3]);
void ruga_sheet_vertex_normal(const ruga_sheet* sheet, int v, double n[3]);
// Weights of x, brought to the plane of face f; they sum to 1.
void ruga_sheet_weights(const ruga_sheet* sheet, int f, const double x[3], double weight[3]);
// The point of face f with these weights.
void ruga_sheet_point(const ruga_sheet* sheet, int f, const double weight[3], double x[3]);
// The face that x (near the surface) lies in, found by walking from `face`; its weights there, not negative.
int ruga_sheet_locate(const ruga_sheet* sheet, int face, const double x[3], double weight[3]);
bool ruga_sheet_on_boundary(const ruga_sheet* sheet, int v);
// Whether v, which is not pinned, may be moved to x: along a straight line of firm edges where it is on one,
// and so that no triangle around it gets much worse.
bool ruga_sheet_can_move(const ruga_sheet* sheet, int v, const double x[3]);
// Whether edge e may be split by a vertex at x, a little off it: not where a triangle would turn over.
bool ruga_sheet_can_split(const ruga_sheet* sheet, int e, const double x[3]);
// Mean length of a face's edges.
double ruga_sheet_face_edge(const ruga_sheet* sheet, int f);

#endif
