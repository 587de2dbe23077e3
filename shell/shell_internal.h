// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What creation (shell.c) and evaluation (energy.c) of a shell share.
#ifndef RUGA_SHELL_SHELL_INTERNAL_H
#define RUGA_SHELL_SHELL_INTERNAL_H

#include "shell/gather.h"
#include "shell/shell.h"

enum { RUGA_SHELL_CHUNK = 256 }; // elements or vertices in one piece of parallel work
enum { RUGA_SHELL_PATCH = 6 };   // vertices of a triangle and its neighbours

typedef struct ruga_hinge_rest {
    double stiffness; // k = D |e|^2 / (A1 + A2), J
    double angle;
} ruga_hinge_rest;

struct ruga_shell {
    ruga_membrane membrane;
    double poisson;
    double thickness_power; // of thickness.c; 0 with directors, whose stiffness is constant
    int vertex_count, triangle_count, hinge_count;
    int (*triangle)[3];
    ruga_membrane_rest* triangle_rest; // [F]
    int (*triangle_hinge)[3];          // [F] hinge at the edge from corner i to corner i + 1, or -1
    int (*next_hinge)[2]; // [H] the next one at the same edge of the triangle on that side, or -1; NULL =
                          // one at each edge
    int (*hinge)[4];      // [H] as in ruga_hinge_angle
    ruga_hinge_rest* hinge_rest; // [H]
    int (*hinge_side)[2];        // [H] triangles on either side
    double* rest_area;           // [F] after growth
    bool has_directors;
    ruga_directors directors;
    int (*patch)[RUGA_SHELL_PATCH]; // [F] with directors: corners, then the corner across edge i or -1
    double* vertex_mass;            // [V]
    ruga_sparse pattern;
    int* block_start;            // [V + 1] first 3 x 3 block of a vertex's columns
    ruga_gather vertex_triangle; // vertex <- 3 triangle + corner
    ruga_gather block_triangle;  // block <- 9 triangle + 3 row corner + column corner
    ruga_gather block_hinge;     // block <- 16 hinge + 4 row corner + column corner
    ruga_gather block_patch; // block <- 36 triangle + 6 row + column; in place of block_hinge with directors
    ruga_gather block_pair;  // block <- 36 hinge + 6 vertex of one patch + vertex of the other
    // Scratch of ruga_shell_energy, which writes here although the shell is const.
    double (*triangle_gradient)[3][3];                 // [F]
    double (*triangle_block)[RUGA_TRIANGLE_BLOCKS][9]; // [F]
    double (*hinge_gradient)[4][3];                    // [H] of the angle, with directors
    double (*hinge_product)[2][4][3];                  // [H] gradient of the angle, and q, without directors
    double* hinge_moment;                              // [H] k s (theta - theta0)
    double* hinge_angle;                               // [H] theta - theta0, with directors
    double* hinge_bend;                                // [H] k/4 (theta - theta0)^2
    double (*thickness)[2]; // [F] s and z of thickness.c, where thickness_power is not 0
    double (*patch_gradient)[3][RUGA_SHELL_PATCH][3]; // [F] with directors: of w t
    double (*partial)[2];                             // [chunks] energy, sum of squared forces
};

static inline void ruga_triangle_corners(const int triangle[3], const double* x, const double* corner[3]) {
    for (int i = 0; i < 3; i++) {
        corner[i] = x + 3 * (size_t)triangle[i];
    }
}

static inline void ruga_hinge_corners(const int hinge[4], const double* x, const double* corner[4]) {
    for (int i = 0; i < 4; i++) {
        corner[i] = x + 3 * (size_t)hinge[i];
    }
}

#endif
