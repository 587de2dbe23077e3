// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The mesh cut along its creases. What is simulated are copies of whole triangles, one for each piece, on
// real and virtual nodes; what is shown is the material: mesh vertices and embedded nodes, never virtual
// ones.
#ifndef RUGA_CREASE_CUT_H
#define RUGA_CREASE_CUT_H

#include "crease/copies.h"
#include "crease/pieces.h"
#include "crease/raster.h"

// One copy of a triangle, for one piece of it.
typedef struct ruga_cut_piece {
    int triangle; // of the raster's mesh
    int node[3];
    int bound[3];     // of the embedded node at place 2 i + 1, -1 = none
    double fraction;  // of the triangle's area that is this piece's material: for membrane and mass
    double middle[3]; // weights of that material's middle
    ruga_outline polygon;
} ruga_cut_piece;

// Part of a mesh edge across which two pieces are one material: for bending.
typedef struct ruga_bend {
    int edge;
    int piece[2];    // on the sides of edge_triangle[edge]
    double fraction; // of the edge's length
} ruga_bend;

// Straight piece of a crease, or an auxiliary chord, with a piece on each side.
typedef struct ruga_segment {
    int curve;    // -1 = auxiliary: the material bends here as anywhere
    int piece[2]; // on the left and on the right of the way from end 0 to end 1, seen from the normals' side
    int place[2][2]; // [side][end] places on the triangle of that piece
    int end[2];      // material vertices
    double along[2]; // m, arc length of the curve
    double length;   // m, at rest
} ruga_segment;

// Where an embedded node is in the cut mesh: k places of the edge's copies that are to be one.
typedef struct ruga_bound {
    int edge;
    double weight[2]; // of edge[0] and edge[1]
    int first, count; // copies
} ruga_bound;

typedef struct ruga_cut {
    int node_count, real_count; // as in ruga_copies
    int vertex_count;           // of the raster's mesh
    int* source;                // [nodes] mesh vertex
    int* copy_start;            // [V + 1] copies of a mesh vertex: what is clamped there is all of these
    int* copy;
    int piece_count;
    ruga_cut_piece* piece; // by triangle
    int bend_count;
    ruga_bend* bend;
    int segment_count;
    ruga_segment* segment;
    int bound_count;
    ruga_bound* bound;  // material vertex real_count + i is bound i
    int (*parent)[2];   // [copies] nodes at edge[0] and edge[1]
    ruga_mesh material; // real nodes, then bounds; texture coordinates, groups and the rest are carried along
    int* material_piece; // [F of the material]
} ruga_cut;

// RUGA_BAD_INPUT where chords of a triangle cross, which a raster of ruga_raster_create does not have.
ruga_status ruga_cut_create(const ruga_raster* raster, ruga_cut* cut);
void ruga_cut_clear(ruga_cut* cut);
// The nodes and weights of a piece's place; an inner place of an edge has two.
int ruga_cut_point(const ruga_cut* cut, const ruga_cut_piece* piece, int place, int node[2],
                   double weight[2]);
// The material's vertex there.
int ruga_cut_vertex(const ruga_cut* cut, const ruga_cut_piece* piece, int place);
// Places of embedded nodes on the edges of a raster's triangle, from corner i to i + 1; 0 = none.
void ruga_raster_nodes(const ruga_raster* raster, int triangle, double node[3]);
// Rest positions of all places of a triangle.
void ruga_raster_places(const ruga_raster* raster, int triangle, double position[RUGA_BORDER_PLACES][3]);
// Rest positions of the nodes [nodes][3]: those of the vertices they copy.
void ruga_cut_rest(const ruga_raster* raster, const ruga_cut* cut, double* x);
// Positions of the material's vertices from those of the nodes; an embedded node is the mean of its copies.
void ruga_cut_material(const ruga_cut* cut, const double* x, double* material);
// mass [nodes], kg, from those of the raster's triangles: each piece's part goes to its nodes. Where
// `centred`, so that its centre of mass stays where it is: for weight in statics. Otherwise in equal thirds:
// then stiffness over mass is that of a whole triangle, and a cut does not shorten the steps of explicit
// dynamics. Fractions count at least `least` (0 = as they are).
void ruga_cut_masses(const ruga_cut* cut, const double* triangle_mass, double least, bool centred,
                     double* mass);
// Largest distance, m, between copies of one embedded node.
double ruga_cut_gap(const ruga_cut* cut, const double* x);
// That between the copies of one vertex of the material.
double ruga_cut_gap_at(const ruga_cut* cut, int vertex, const double* x);

// The material mesh of a cut; called by ruga_cut_create.
ruga_status ruga_cut_make_material(const ruga_raster* raster, ruga_cut* cut);

#endif
