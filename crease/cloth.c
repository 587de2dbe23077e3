// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The springs of Patkar, Jin and Fedkiw (2015), sections 3 and 6, with the stiffness of a sheet of modulus E,
// thickness h and bending rigidity D.
//
// Along a side of length l: k = E h sum A / l^2 over the pieces beside it, A the area of their material (van
// Gelder 1998). On equilateral triangles that is exact for Poisson's ratio 1/3, which springs cannot choose.
//
// Across an edge with the heights a and b of the corners beside it, and the stiffness k of its angle theta,
// the axial-bending spring joins the points in which, flat, the edge meets the line between the corners. Its
// length is 2 a b / (a + b) |sin(theta / 2)|, so that k ((a + b) / (a b))^2 gives the stiffness k cos^2(theta
// / 2); the bending spring between the corners, with k / max(a, b)^2, gives k sin^2(theta / 2) where a = b.
// Together the angle is as stiff everywhere. Flat, the first is linear in the places of its nodes.
//
// Creases. Springs between copies (figure 3 (d)): of length 2 d |sin(theta / 2)|, d the distance of the
// vertex from the crease, one k for a crease with sum k d^2 = sum k_h l. Springs across (figure 3 (e)): for
// each embedded node, bending springs along its edge and an axial-bending spring to the node, with the
// stiffness of the half segments beside it. Neither tells valley from mountain. Where a crease runs along
// mesh edges nothing is doubled: there both have the springs of an edge.
#include "crease/cloth.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "crease/pairs.h"

#include <math.h>
#include <string.h>

void ruga_cloth_clear(ruga_cloth* cloth) {
    ruga_springs_clear(&cloth->springs);
    ruga_release(cloth->fold);
    *cloth = (ruga_cloth){0};
}

// ------------------------------------------------------------------------------- the sheet's hinges

void ruga_bends_make(const ruga_raster* raster, const ruga_cut* cut, ruga_hinge* hinge) {
    for (int b = 0; b < cut->bend_count; b++) {
        const int* ends = raster->edges.edge[cut->bend[b].edge];
        ruga_hinge* h = &hinge[b];
        *h = (ruga_hinge){.length = 1, .curve = -1};
        for (int side = 0; side < 2; side++) {
            const int* node = cut->piece[cut->bend[b].piece[side]].node;
            memcpy(h->node + 3 * side, node, 3 * sizeof *node);
            for (int i = 0; i < 3; i++) {
                int end = cut->source[node[i]] == ends[0] ? 0 : cut->source[node[i]] == ends[1] ? 1 : -1;
                h->weight[end < 0 ? 2 + side : end][3 * side + i] = end < 0 ? 1 : 0.5;
            }
        }
    }
}

void ruga_bend_stiffness(const ruga_raster* raster, const ruga_cut* cut, double* bend, double* chord) {
    for (int b = 0; b < cut->bend_count; b++) {
        const int* ends = raster->edges.edge[cut->bend[b].edge];
        double length = ruga_distance(raster->mesh.position + 3 * (size_t)ends[0],
                                      raster->mesh.position + 3 * (size_t)ends[1]);
        double area = ruga_mesh_triangle_area(&raster->mesh, cut->piece[cut->bend[b].piece[0]].triangle) +
                      ruga_mesh_triangle_area(&raster->mesh, cut->piece[cut->bend[b].piece[1]].triangle);
        bend[b] = cut->bend[b].fraction * length * length / area;
    }
    for (int s = 0; s < cut->segment_count; s++) {
        const ruga_cut_piece *a = &cut->piece[cut->segment[s].piece[0]],
                             *b = &cut->piece[cut->segment[s].piece[1]];
        double area = a->fraction * ruga_mesh_triangle_area(&raster->mesh, a->triangle) +
                      b->fraction * ruga_mesh_triangle_area(&raster->mesh, b->triangle);
        double length = cut->segment[s].length;
        chord[s] = cut->segment[s].curve >= 0 ? 0 : length * length / area;
    }
}

// ------------------------------------------------------------------------------- springs across a hinge

static ruga_status add_folding(ruga_cloth* cloth, int count, const int* node, const double* weight,
                               double stiffness, ruga_fold_length fold) {
    RUGA_TRY(RUGA_RESERVE(cloth->fold, cloth->fold_capacity, cloth->fold_count + 1));
    cloth->fold[cloth->fold_count] = fold;
    return ruga_springs_add(&cloth->springs, count, node, weight, stiffness, 0, cloth->fold_count++);
}

// Bending and axial-bending spring of a hinge whose angle has the stiffness k; rest [nodes][3]. Where
// `segment` is -1, for the angle it has at rest.
static ruga_status add_hinge_springs(ruga_cloth* cloth, const ruga_hinge* hinge, const double* rest, double k,
                                     int segment) {
    double point[4][3], along[2], height[2], e[3];
    for (int i = 0; i < 4; i++) {
        memset(point[i], 0, sizeof point[i]);
        for (int a = 0; a < RUGA_HINGE_NODES; a++) {
            ruga_add_scaled(hinge->weight[i][a], rest + 3 * (size_t)hinge->node[a], point[i]);
        }
    }
    ruga_subtract(point[1], point[0], e);
    double square = ruga_dot(e, e);
    for (int side = 0; side < 2; side++) {
        double d[3];
        ruga_subtract(point[2 + side], point[0], d);
        along[side] = ruga_dot(d, e) / square;
        ruga_add_scaled(-along[side], e, d);
        height[side] = ruga_norm(d);
    }
    double a = height[0], b = height[1], t = a / (a + b), s = (1 - t) * along[0] + t * along[1];
    double axial[RUGA_HINGE_NODES], bending[RUGA_HINGE_NODES], shift = along[0] - along[1];
    for (int i = 0; i < RUGA_HINGE_NODES; i++) {
        bending[i] = hinge->weight[2][i] - hinge->weight[3][i];
        axial[i] = (1 - t) * hinge->weight[2][i] + t * hinge->weight[3][i] - (1 - s) * hinge->weight[0][i] -
                   s * hinge->weight[1][i];
    }
    double arm = a * b / (a + b), most = fmax(a, b);
    const ruga_fold_length folds[2] = {{segment, 2 * arm * arm, -2 * arm * arm},
                                       {segment, shift * shift * square + a * a + b * b, 2 * a * b}};
    if (segment >= 0) {
        RUGA_TRY(add_folding(cloth, RUGA_HINGE_NODES, hinge->node, axial, k / (arm * arm), folds[0]));
        return add_folding(cloth, RUGA_HINGE_NODES, hinge->node, bending, k / (most * most), folds[1]);
    }
    double c = cos(ruga_hinge_measure(hinge, rest, NULL, NULL));
    double length[2];
    for (int i = 0; i < 2; i++) {
        length[i] = sqrt(fmax(folds[i].constant + folds[i].factor * c, 0));
    }
    RUGA_TRY(ruga_springs_add(&cloth->springs, RUGA_HINGE_NODES, hinge->node, axial, k / (arm * arm),
                              length[0], -1));
    return ruga_springs_add(&cloth->springs, RUGA_HINGE_NODES, hinge->node, bending, k / (most * most),
                            length[1], -1);
}

static ruga_status add_bends(ruga_cloth* cloth, const ruga_raster* raster, const ruga_cut* cut,
                             double rigidity, const double* rest) {
    ruga_status status = RUGA_OK;
    ruga_hinge *bend = NULL, *segment = NULL;
    double *stiffness = NULL, *chord = NULL;
    RUGA_TRY_DONE(RUGA_NEW(bend, cut->bend_count));
    RUGA_TRY_DONE(RUGA_NEW(segment, cut->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(stiffness, cut->bend_count));
    RUGA_TRY_DONE(RUGA_NEW(chord, cut->segment_count));
    ruga_bends_make(raster, cut, bend);
    ruga_hinges_make(raster, cut, segment);
    ruga_bend_stiffness(raster, cut, stiffness, chord);
    for (int b = 0; b < cut->bend_count; b++) {
        RUGA_TRY_DONE(add_hinge_springs(cloth, &bend[b], rest, rigidity * stiffness[b], -1));
    }
    for (int s = 0; s < cut->segment_count; s++) {
        if (cut->segment[s].curve < 0) {
            RUGA_TRY_DONE(add_hinge_springs(cloth, &segment[s], rest, rigidity * chord[s], -1));
        }
    }
done:
    ruga_release(bend);
    ruga_release(segment);
    ruga_release(stiffness);
    ruga_release(chord);
    return status;
}

ruga_status ruga_cloth_add_sheet(ruga_cloth* cloth, const ruga_raster* raster, const ruga_cut* cut,
                                 const ruga_skin_def* skin) {
    ruga_status status = RUGA_OK;
    const double weight[2] = {1, -1};
    double *rest = NULL, h = skin->thickness;
    double rigidity = skin->young * h * h * h / (12 * (1 - skin->poisson * skin->poisson));
    RUGA_TRY_DONE(RUGA_NEW(rest, 3 * (size_t)cut->node_count));
    ruga_cut_rest(raster, cut, rest);
    for (int p = 0; p < cut->piece_count; p++) {
        const ruga_cut_piece* piece = &cut->piece[p];
        double area = piece->fraction * ruga_mesh_triangle_area(&raster->mesh, piece->triangle);
        for (int i = 0; i < 3; i++) {
            // Always from the lower node: equal for both pieces beside a side, to the last bit.
            int a = piece->node[i], b = piece->node[(i + 1) % 3], low = a < b ? a : b;
            const int node[2] = {low, a + b - low};
            double length = ruga_distance(rest + 3 * (size_t)node[0], rest + 3 * (size_t)node[1]);
            RUGA_TRY_DONE(ruga_springs_add(&cloth->springs, 2, node, weight,
                                           skin->young * h * area / (length * length), length, -1));
        }
    }
    RUGA_TRY_DONE(add_bends(cloth, raster, cut, rigidity, rest));
done:
    ruga_release(rest);
    return status;
}

// ------------------------------------------------------------------------------- springs of creases

static bool is_doubled(const ruga_cut* cut, int s) {
    return cut->piece[cut->segment[s].piece[0]].triangle == cut->piece[cut->segment[s].piece[1]].triangle;
}

static bool is_fold(const ruga_cut* cut, int s) {
    return cut->segment[s].curve >= 0;
}

static ruga_status add_along_edges(ruga_cloth* cloth, const ruga_raster* raster, const ruga_cut* cut,
                                   const double* stiffness, const double* rest) {
    ruga_status status = RUGA_OK;
    ruga_hinge* hinge = NULL;
    RUGA_TRY(RUGA_NEW(hinge, cut->segment_count));
    ruga_hinges_make(raster, cut, hinge);
    for (int s = 0; s < cut->segment_count; s++) {
        if (is_fold(cut, s) && !is_doubled(cut, s)) {
            RUGA_TRY_DONE(
                add_hinge_springs(cloth, &hinge[s], rest, stiffness[s] * cut->segment[s].length, s));
        }
    }
done:
    ruga_release(hinge);
    return status;
}

// Distance of x from the line through a segment.
static double distance_to(const ruga_raster* raster, const ruga_cut* cut, int s, const double x[3]) {
    double place[RUGA_BORDER_PLACES][3], e[3], d[3], across[3];
    const ruga_segment* segment = &cut->segment[s];
    ruga_raster_places(raster, cut->piece[segment->piece[0]].triangle, place);
    ruga_subtract(place[segment->place[0][1]], place[segment->place[0][0]], e);
    ruga_subtract(x, place[segment->place[0][0]], d);
    ruga_cross(e, d, across);
    return ruga_norm(across) / ruga_norm(e);
}

// Distance of each pair's vertex from its crease, and a segment beside it.
static void measure_pairs(const ruga_raster* raster, const ruga_cut* cut, int count, const ruga_pair* pair,
                          double* distance, int* segment) {
    for (int s = 0; s < cut->segment_count; s++) {
        for (int i = 0; i < 3 && is_fold(cut, s) && is_doubled(cut, s); i++) {
            int a = cut->piece[cut->segment[s].piece[0]].node[i],
                b = cut->piece[cut->segment[s].piece[1]].node[i];
            int at = ruga_pairs_find(count, pair, a, b, cut->segment[s].curve);
            if (at >= 0) {
                const double* x = raster->mesh.position + 3 * (size_t)cut->source[a];
                segment[at] = s;
                distance[at] = distance_to(raster, cut, s, x);
            }
        }
    }
}

// k [curves] = sum k_h l over sum d^2 of each crease; squares [curves] is work. Both are zero before.
static void pair_stiffness(const ruga_raster* raster, const ruga_cut* cut, const double* stiffness, int count,
                           const ruga_pair* pair, const double* distance, double* squares, double* k) {
    for (int p = 0; p < count; p++) {
        squares[pair[p].curve] += distance[p] * distance[p];
    }
    for (int s = 0; s < cut->segment_count; s++) {
        if (is_fold(cut, s) && is_doubled(cut, s)) {
            k[cut->segment[s].curve] += stiffness[s] * cut->segment[s].length;
        }
    }
    for (int c = 0; c < raster->curve_count; c++) {
        k[c] = squares[c] > 0 ? k[c] / squares[c] : 0;
    }
}

static ruga_status add_pairs(ruga_cloth* cloth, const ruga_raster* raster, const ruga_cut* cut,
                             const double* stiffness) {
    ruga_status status = RUGA_OK;
    ruga_pair* pair = NULL;
    double *distance = NULL, *squares = NULL, *k = NULL;
    int *segment = NULL, count = 0;
    const double weight[2] = {1, -1};
    RUGA_TRY_DONE(ruga_pairs_create(cut, &count, &pair));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(distance, count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(segment, count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(squares, raster->curve_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(k, raster->curve_count));
    measure_pairs(raster, cut, count, pair, distance, segment);
    pair_stiffness(raster, cut, stiffness, count, pair, distance, squares, k);
    for (int p = 0; p < count; p++) {
        double square = 2 * distance[p] * distance[p];
        RUGA_TRY_DONE(add_folding(cloth, 2, pair[p].node, weight, k[pair[p].curve],
                                  (ruga_fold_length){segment[p], square, -square}));
    }
done:
    ruga_release(pair);
    ruga_release(distance);
    ruga_release(segment);
    ruga_release(squares);
    ruga_release(k);
    return status;
}

// The segments' lengths at their embedded nodes, half at each end, times stiffness; and one of them.
static void share_segments(const ruga_cut* cut, const double* stiffness, double* share, int* segment) {
    for (int s = 0; s < cut->segment_count; s++) {
        int ends = (cut->segment[s].end[0] >= cut->real_count) + (cut->segment[s].end[1] >= cut->real_count);
        for (int i = 0; i < 2 && is_fold(cut, s) && is_doubled(cut, s); i++) {
            int bound = cut->segment[s].end[i] - cut->real_count;
            if (bound >= 0) {
                share[bound] += stiffness[s] * cut->segment[s].length / ends;
                segment[bound] = s;
            }
        }
    }
}

// The springs across at one embedded node, along the mesh edge from a to b. The axial one is at the copy
// whose virtual end is the farther one: that is where folding moves it most.
static ruga_status add_across(ruga_cloth* cloth, const ruga_raster* raster, const ruga_cut* cut, int b,
                              double k, int segment) {
    const ruga_bound* bound = &cut->bound[b];
    const int* edge = raster->edges.edge[bound->edge];
    const double *x = raster->mesh.position + 3 * (size_t)edge[0],
                 *y = raster->mesh.position + 3 * (size_t)edge[1];
    double p = distance_to(raster, cut, segment, x), q = distance_to(raster, cut, segment, y);
    double arm = p * q / (p + q), most = fmax(p, q), length = ruga_distance(x, y);
    int copy = bound->first;
    for (int i = 0; i < bound->count; i++) {
        copy = cut->parent[bound->first + i][p < q] != edge[p < q] ? bound->first + i : copy;
    }
    const int node[4] = {edge[0], edge[1], cut->parent[copy][0], cut->parent[copy][1]};
    const double axial[4] = {bound->weight[0], bound->weight[1], -bound->weight[0], -bound->weight[1]},
                 bending[2] = {1, -1};
    if (!(arm > 0)) {
        return RUGA_OK;
    }
    RUGA_TRY(add_folding(cloth, 4, node, axial, k / (arm * arm),
                         (ruga_fold_length){segment, 2 * arm * arm, -2 * arm * arm}));
    return add_folding(cloth, 2, node, bending, k / (most * most),
                       (ruga_fold_length){segment, length * length - 2 * p * q, 2 * p * q});
}

static ruga_status add_all_across(ruga_cloth* cloth, const ruga_raster* raster, const ruga_cut* cut,
                                  const double* stiffness) {
    ruga_status status = RUGA_OK;
    double* share = NULL;
    int* segment = NULL;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(share, cut->bound_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(segment, cut->bound_count));
    share_segments(cut, stiffness, share, segment);
    for (int b = 0; b < cut->bound_count; b++) {
        if (share[b] > 0) {
            RUGA_TRY_DONE(add_across(cloth, raster, cut, b, share[b], segment[b]));
        }
    }
done:
    ruga_release(share);
    ruga_release(segment);
    return status;
}

ruga_status ruga_cloth_add_creases(ruga_cloth* cloth, const ruga_raster* raster, const ruga_cut* cut,
                                   ruga_crease_style style, const double* stiffness) {
    ruga_status status = RUGA_OK;
    double* rest = NULL;
    RUGA_TRY_DONE(RUGA_NEW(rest, 3 * (size_t)cut->node_count));
    ruga_cut_rest(raster, cut, rest);
    RUGA_TRY_DONE(style == RUGA_CREASE_PAIRS ? add_pairs(cloth, raster, cut, stiffness)
                                             : add_all_across(cloth, raster, cut, stiffness));
    RUGA_TRY_DONE(add_along_edges(cloth, raster, cut, stiffness, rest));
done:
    ruga_release(rest);
    return status;
}

ruga_status ruga_cloth_finish(ruga_cloth* cloth, const ruga_cut* cut) {
    cloth->springs.node_count = cut->node_count;
    return ruga_springs_finish(&cloth->springs);
}

void ruga_cloth_set_rest(ruga_cloth* cloth, const double* rest) {
    for (int k = 0; k < RUGA_SPRING_WIDTHS; k++) {
        ruga_spring_list* list = &cloth->springs.list[k];
        for (int s = 0; s < list->count; s++) {
            const ruga_fold_length* f = list->label[s] >= 0 ? &cloth->fold[list->label[s]] : NULL;
            if (f) {
                list->length[s] =
                    list->scale[s] * sqrt(fmax(f->constant + f->factor * cos(rest[f->segment]), 0));
            }
        }
    }
}
