// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A signed dihedral spring in place of the unsigned springs of Patkar, Jin and Fedkiw (2015, section 6). A
// spring between a node and its virtual copy has the length 2 d |sin(theta / 2)|: it cannot tell valley from
// mountain, does not know which way to go from flat, and its stiffness falls as cos^2(theta0 / 2), to nothing
// when folded over. The angle knows its sign and is as stiff everywhere.
//
// The segment runs from p to q, each the mean of the two elements' own points there (the same, once sewn).
// Both elements stay flat, so that any other point of them gives their planes: of each, the corner of its
// piece that is farthest from the segment. With
//   theta = atan2((n_R x n_L).t, n_L.n_R)
// of shell/bending.h for (p, q, left, right) = W x the derivatives are those of theta times the weights:
//   dE/dx_a = k l (theta - theta0) sum_i W_ia dtheta/dp_i
//   d2E/dx_a dx_b = k l sum_ij W_ia W_jb [dtheta/dp_i (dtheta/dp_j)^T + (1 - clamp) (theta - theta0)
//   d2theta/dp_i dp_j].
#include "crease/hinge.h"

#include "core/vec3.h"
#include "shell/bending.h"

#include <math.h>
#include <string.h>

// ------------------------------------------------------------------------------- from the cut

static void add_point(const ruga_cut* cut, const ruga_cut_piece* piece, int place, int first, double factor,
                      double weight[RUGA_HINGE_NODES]) {
    int node[2];
    double part[2];
    int count = ruga_cut_point(cut, piece, place, node, part);
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < 3; i++) {
            weight[first + i] += piece->node[i] == node[k] ? factor * part[k] : 0;
        }
    }
}

// The corner of a piece's polygon that is farthest from the line between two places.
static int farthest_place(const ruga_raster* raster, const ruga_cut_piece* piece, const int end[2]) {
    double x[RUGA_BORDER_PLACES][3], farthest = -1;
    int best = 0;
    ruga_raster_places(raster, piece->triangle, x);
    for (int k = 0; k < piece->polygon.count; k++) {
        double n[3];
        ruga_triangle_normal(x[end[0]], x[end[1]], x[piece->polygon.place[k]], n);
        if (ruga_norm(n) > farthest) {
            farthest = ruga_norm(n);
            best = piece->polygon.place[k];
        }
    }
    return best;
}

void ruga_hinges_make(const ruga_raster* raster, const ruga_cut* cut, ruga_hinge* hinge) {
    for (int s = 0; s < cut->segment_count; s++) {
        const ruga_segment* segment = &cut->segment[s];
        ruga_hinge* h = &hinge[s];
        *h = (ruga_hinge){.length = segment->length, .curve = segment->curve};
        for (int side = 0; side < 2; side++) {
            const ruga_cut_piece* piece = &cut->piece[segment->piece[side]];
            const int* end = segment->place[side];
            memcpy(h->node + 3 * side, piece->node, sizeof piece->node);
            add_point(cut, piece, end[0], 3 * side, 0.5, h->weight[0]);
            add_point(cut, piece, end[1], 3 * side, 0.5, h->weight[1]);
            add_point(cut, piece, farthest_place(raster, piece, end), 3 * side, 1, h->weight[2 + side]);
        }
    }
}

// ------------------------------------------------------------------------------- angle

static void points_at(const ruga_hinge* hinge, const double* x, double point[4][3]) {
    for (int k = 0; k < 4; k++) {
        memset(point[k], 0, sizeof point[k]);
        for (int a = 0; a < RUGA_HINGE_NODES; a++) {
            ruga_add_scaled(hinge->weight[k][a], x + 3 * (size_t)hinge->node[a], point[k]);
        }
    }
}

static double angle_of(const double point[4][3], const double* near, double gradient[4][3]) {
    const double* const at[4] = {point[0], point[1], point[2], point[3]};
    double angle = ruga_hinge_angle(at, gradient);
    return near ? *near + remainder(angle - *near, 2 * RUGA_PI) : angle;
}

static void spread(const ruga_hinge* hinge, const double of[4][3], double factor,
                   double to[RUGA_HINGE_NODES][3]) {
    for (int a = 0; a < RUGA_HINGE_NODES; a++) {
        memset(to[a], 0, sizeof to[a]);
        for (int k = 0; k < 4; k++) {
            ruga_add_scaled(factor * hinge->weight[k][a], of[k], to[a]);
        }
    }
}

double ruga_hinge_measure(const ruga_hinge* hinge, const double* x, const double* near,
                          double gradient[RUGA_HINGE_NODES][3]) {
    double point[4][3], own[4][3];
    points_at(hinge, x, point);
    double angle = angle_of((const double(*)[3])point, near, own);
    if (gradient) {
        spread(hinge, (const double(*)[3])own, 1, gradient);
    }
    return angle;
}

// ------------------------------------------------------------------------------- energy

// block[i][j] of the four points += scale times the angle's Hessian.
static void add_angle_hessian(const double point[4][3], double scale, double block[4][4][9]) {
    // The triangle on the left runs along the segment, the one on the right against it.
    static const int corner[2][3] = {{0, 1, 2}, {1, 0, 3}};
    const double moment[3] = {scale, 0, 0};
    for (int side = 0; side < 2; side++) {
        const double* const x[3] = {point[corner[side][0]], point[corner[side][1]], point[corner[side][2]]};
        double lower[RUGA_TRIANGLE_BLOCKS][9];
        ruga_hinge_hessian(x, moment, lower);
        for (int b = 0; b < RUGA_TRIANGLE_BLOCKS; b++) {
            int i = corner[side][ruga_triangle_block_corner[b][0]];
            int j = corner[side][ruga_triangle_block_corner[b][1]];
            for (int r = 0; r < 3; r++) {
                for (int c = 0; c < 3; c++) {
                    block[i][j][3 * r + c] += lower[b][3 * r + c];
                    block[j][i][3 * c + r] += i == j ? 0 : lower[b][3 * r + c];
                }
            }
        }
    }
}

// hessian = W^T block W
static void spread_blocks(const ruga_hinge* hinge, double block[4][4][9],
                          double hessian[RUGA_HINGE_UNKNOWNS][RUGA_HINGE_UNKNOWNS]) {
    for (int a = 0; a < RUGA_HINGE_NODES; a++) {
        for (int b = 0; b < RUGA_HINGE_NODES; b++) {
            double sum[9] = {0};
            for (int i = 0; i < 4; i++) {
                for (int j = 0; j < 4; j++) {
                    double w = hinge->weight[i][a] * hinge->weight[j][b];
                    for (int k = 0; k < 9 && w != 0; k++) {
                        sum[k] += w * block[i][j][k];
                    }
                }
            }
            for (int k = 0; k < 9; k++) {
                hessian[3 * a + k / 3][3 * b + k % 3] = sum[k];
            }
        }
    }
}

double ruga_hinge_energy(const ruga_hinge* hinge, double stiffness, double rest, const double* x,
                         const double* near, double clamp, double gradient[RUGA_HINGE_NODES][3],
                         double hessian[RUGA_HINGE_UNKNOWNS][RUGA_HINGE_UNKNOWNS]) {
    double point[4][3], own[4][3], k = stiffness * hinge->length;
    points_at(hinge, x, point);
    double off = angle_of((const double(*)[3])point, near, own) - rest;
    if (gradient) {
        spread(hinge, (const double(*)[3])own, k * off, gradient);
    }
    if (hessian) {
        double block[4][4][9] = {{{0}}};
        for (int i = 0; i < 16; i++) {
            for (int e = 0; e < 9; e++) {
                block[i / 4][i % 4][e] = k * own[i / 4][e / 3] * own[i % 4][e % 3];
            }
        }
        add_angle_hessian((const double(*)[3])point, (1 - clamp) * k * off, block);
        spread_blocks(hinge, block, hessian);
    }
    return 0.5 * k * off * off;
}
