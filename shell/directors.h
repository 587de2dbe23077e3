// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Directors at the middles of edges: the bending energy of a Kirchhoff-Love shell, least over one rotation
// for each interior edge.
#ifndef RUGA_SHELL_DIRECTORS_H
#define RUGA_SHELL_DIRECTORS_H

#include "core/sparse.h"
#include "shell/membrane.h"

// An edge's matrix row reaches the corners of its two triangles, of their neighbours and of those'
// neighbours.
enum { RUGA_DIRECTOR_VERTICES = 16 };

typedef struct ruga_directors {
    int triangle_count, hinge_count, vertex_count;
    double (*stiffness)[3][3];      // [F] Q of directors.c by the triangle's edges, J; 0 at edges of the rim
    double (*cross)[3][3];          // [H] Q between the edges of the hinge's two triangles, J
    const int (*triangle_hinge)[3]; // [F] of the shell
    const int (*hinge)[4];          // [H] of the shell
    int (*hinge_triangle)[2];       // [H] triangles on the side of vertex 2 and of vertex 3 of the hinge
    double (*weight)[2];            // [H] parts of a hinge's angle that its triangles take where f = 0
    ruga_sparse matrix;             // [H][H] second derivatives by the rotations: constant, positive definite
    // Second derivatives by rotation and position, blocks of 3: those of vertex v are at start[v] .. start[v
    // + 1].
    int* start;                          // [V + 1]
    int* edge;                           // [blocks] ascending for each vertex
    int (*slot)[RUGA_DIRECTOR_VERTICES]; // [H] blocks of an edge, -1 where there are fewer
    int (*slot_vertex)[RUGA_DIRECTOR_VERTICES];
    double *rotation, *residual, *image, *direction, *diagonal; // [H] work of ruga_directors_settle
    double (*lean)[3];                                          // [F] a, likewise
} ruga_directors;

// The second fundamental form (b_xx, b_yy, b_xy) that each director's lean gives a triangle, 1/m; edge i runs
// from corner i to corner i + 1. Edges on the rim (rim[i]) turn freely.
void ruga_director_form(const ruga_membrane_rest* rest, double poisson, const bool rim[3], double form[3][3]);

// K from that; scale is area times D.
void ruga_director_stiffness(double scale, double poisson, double form[3][3], double stiffness[3][3]);

// beta of directors.c.
double ruga_director_jump(double poisson);

// triangle_hinge and hinge must outlive the result; stiffness [F] and hinge_triangle [H] are allocated, to be
// set before ruga_directors_join for any hinges, and ruga_directors_link.
ruga_status ruga_directors_create(int vertex_count, int triangle_count, const int (*triangle_hinge)[3],
                                  int hinge_count, const int (*hinge)[4], ruga_directors* directors);
// Adds the energy of the jump of b at hinge h; rest and form [F], scale is area times D.
void ruga_directors_join(ruga_directors* directors, int h, const ruga_membrane_rest* rest,
                         double (*form)[3][3], double scale, double poisson);
ruga_status ruga_directors_link(ruga_directors* directors);
void ruga_directors_clear(ruga_directors* directors);

// angle [H]: change of the hinges' angles since rest. Finds the rotations and sets the moments [H], J:
// derivatives of the energy by the angles. The energy is half the sum of moment times angle.
void ruga_directors_settle(ruga_directors* directors, const double* angle, double* moment);

// Solves matrix x = right; x and right [H] may be the same.
void ruga_directors_solve(ruga_directors* directors, const double* right, double* x);

// value [blocks][3] from the gradients of the hinges' angles.
void ruga_directors_coupling(const ruga_directors* directors, double (*const gradient)[4][3],
                             double (*value)[3]);

#endif
