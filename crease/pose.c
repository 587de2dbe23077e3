// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Pieces that bends and auxiliary chords join are one panel. Across a crease from p to q, t = (q - p)/|q -
// p|, a turn of the right side by phi about t changes theta = atan2((n_R x n_L).t, n_L.n_R) by -phi. So, from
// the first panel on, panel b beyond a crease of panel a moves by T_b = T_a Rot(p, t, -turn). Where panels
// close a ring the last crease decides whether they fit; what does not fit is seen as a gap.
//
// The cone: (rho, phi, h) goes to the generator at phi / s, s = angle / 2 pi the sine of the cone's half
// angle,
//   rho (s e_r - sqrt(1 - s^2) e_z) + h (sqrt(1 - s^2) e_r + s e_z),
// an isometry of the plane h = 0.
#include "crease/pose.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "lattice/union_find.h"

#include <string.h>

typedef struct motion {
    double turn[9], shift[3]; // x -> turn x + shift
} motion;

typedef struct panels {
    int* parent;    // [pieces] disjoint sets
    bool* placed;   // [pieces] by the set's root
    motion* motion; // [pieces] likewise
    int* first;     // [pieces + 1] segments of each panel, by its root
    int* segment;
    int* queue;
} panels;

static void clear(panels* p) {
    ruga_release(p->parent);
    ruga_release(p->placed);
    ruga_release(p->motion);
    ruga_release(p->first);
    ruga_release(p->segment);
    ruga_release(p->queue);
}

static ruga_status find_panels(const ruga_cut* cut, panels* p) {
    RUGA_TRY(RUGA_NEW(p->parent, cut->piece_count));
    RUGA_TRY(RUGA_NEW_ZERO(p->placed, cut->piece_count));
    RUGA_TRY(RUGA_NEW(p->motion, cut->piece_count));
    RUGA_TRY(RUGA_NEW_ZERO(p->first, (size_t)cut->piece_count + 2));
    RUGA_TRY(RUGA_NEW(p->segment, 2 * (size_t)cut->segment_count));
    RUGA_TRY(RUGA_NEW(p->queue, cut->piece_count));
    ruga_sets_reset(p->parent, cut->piece_count);
    for (int b = 0; b < cut->bend_count; b++) {
        ruga_sets_unite(p->parent, cut->bend[b].piece[0], cut->bend[b].piece[1]);
    }
    for (int s = 0; s < cut->segment_count; s++) {
        if (cut->segment[s].curve < 0) {
            ruga_sets_unite(p->parent, cut->segment[s].piece[0], cut->segment[s].piece[1]);
        }
    }
    int* end = p->first + 1;
    for (int pass = 0; pass < 2; pass++) { // count, then fill
        for (int s = 0; s < cut->segment_count; s++) {
            for (int side = 0; side < 2 && cut->segment[s].curve >= 0; side++) {
                int root = ruga_sets_find(p->parent, cut->segment[s].piece[side]);
                if (pass == 0) {
                    end[root + 1]++;
                } else {
                    p->segment[end[root]++] = s;
                }
            }
        }
        for (int k = 0; k < cut->piece_count && pass == 0; k++) {
            end[k + 1] += end[k];
        }
    }
    return RUGA_OK;
}

// The motion of the panel beyond a segment, from that on the side `from`.
static motion beyond(const ruga_cut* cut, const ruga_segment* segment, int from, double turn,
                     const motion* a) {
    const double *p = cut->material.position + 3 * (size_t)segment->end[0],
                 *q = cut->material.position + 3 * (size_t)segment->end[1];
    double t[3], own[9], phi = from == 0 ? -turn : turn, c = cos(phi), s = sin(phi);
    motion b = {.shift = {a->shift[0], a->shift[1], a->shift[2]}};
    ruga_subtract(q, p, t);
    ruga_normalize(t);
    const double cross[9] = {0, -t[2], t[1], t[2], 0, -t[0], -t[1], t[0], 0};
    for (int k = 0; k < 9; k++) {
        own[k] = (k % 4 == 0) * c + s * cross[k] + (1 - c) * t[k / 3] * t[k % 3];
    }
    double kept[3], moved[3]; // T_a (p + own (x - p))
    ruga_multiply3(own, p, kept);
    ruga_subtract(p, kept, kept);
    ruga_multiply3(a->turn, kept, moved);
    ruga_add_scaled(1, moved, b.shift);
    for (int k = 0; k < 9; k++) {
        for (int i = 0; i < 3; i++) {
            b.turn[k] += a->turn[3 * (k / 3) + i] * own[3 * i + k % 3];
        }
    }
    return b;
}

// All panels that hang together with the one of `root`.
static void place_from(const ruga_cut* cut, panels* p, int root, const double* turn) {
    int head = 0, tail = 0;
    p->motion[root] = (motion){.turn = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    p->placed[root] = true;
    p->queue[tail++] = root;
    while (head < tail) {
        int a = p->queue[head++];
        for (int k = p->first[a]; k < p->first[a + 1]; k++) {
            const ruga_segment* segment = &cut->segment[p->segment[k]];
            int from = ruga_sets_find(p->parent, segment->piece[0]) == a ? 0 : 1;
            int b = ruga_sets_find(p->parent, segment->piece[!from]);
            if (!p->placed[b]) {
                p->motion[b] = beyond(cut, segment, from, turn[p->segment[k]], &p->motion[a]);
                p->placed[b] = true;
                p->queue[tail++] = b;
            }
        }
    }
}

// Each panel's own nodes, y [pieces][3][3], and x with one of them for each node.
static void place_nodes(const ruga_raster* raster, const ruga_cut* cut, panels* p, double* y, double* x) {
    ruga_cut_rest(raster, cut, x);
    for (int k = 0; k < cut->piece_count; k++) {
        const motion* m = &p->motion[ruga_sets_find(p->parent, k)];
        for (int i = 0; i < 3; i++) {
            int n = cut->piece[k].node[i];
            double* own = y + 9 * (size_t)k + 3 * (size_t)i;
            ruga_multiply3(m->turn, raster->mesh.position + 3 * (size_t)cut->source[n], own);
            ruga_add_scaled(1, m->shift, own);
            memcpy(x + 3 * (size_t)n, own, 3 * sizeof *x);
        }
    }
}

// Where panels share a node, and where copies should meet: how far they are apart.
static ruga_status check_fit(const ruga_cut* cut, const double* y, const double* x, double tolerance) {
    double worst = ruga_cut_gap(cut, x);
    for (int k = 0; k < 3 * cut->piece_count; k++) {
        const double* at = x + 3 * (size_t)cut->piece[k / 3].node[k % 3];
        worst = fmax(worst, ruga_distance(y + 3 * (size_t)k, at));
    }
    return worst <= tolerance ? RUGA_OK
                              : ruga_fail(RUGA_BAD_INPUT,
                                          "the flat panels between the creases do not fit together at these "
                                          "angles: gaps of %.3g m",
                                          worst);
}

static double mean_direction(int count, const double* x) {
    double mean[2] = {0, 0};
    for (int n = 0; n < count; n++) {
        mean[0] += x[3 * (size_t)n];
        mean[1] += x[3 * (size_t)n + 1];
    }
    return atan2(mean[1], mean[0]);
}

static void roll(int count, double angle, double middle, double* x) {
    double s = angle / (2 * RUGA_PI), c = sqrt(1 - s * s);
    for (int n = 0; n < count; n++) {
        double* at = x + 3 * (size_t)n;
        double rho = hypot(at[0], at[1]), h = at[2];
        double phi = (rho > 0 ? remainder(atan2(at[1], at[0]) - middle, 2 * RUGA_PI) : 0) / s;
        double out = s * rho + c * h;
        at[0] = out * cos(phi + middle);
        at[1] = out * sin(phi + middle);
        at[2] = -c * rho + s * h;
    }
}

void ruga_roll_cone(int count, double angle, double* x) {
    roll(count, angle, mean_direction(count, x), x);
}

ruga_status ruga_cut_fold(const ruga_raster* raster, const ruga_cut* cut, const double* turn, double cone,
                          double tolerance, double* x) {
    ruga_status status = RUGA_OK;
    panels p = {0};
    double* y = NULL;
    RUGA_TRY_DONE(find_panels(cut, &p));
    RUGA_TRY_DONE(RUGA_NEW(y, 9 * (size_t)cut->piece_count));
    for (int k = 0; k < cut->piece_count; k++) {
        if (!p.placed[ruga_sets_find(p.parent, k)]) {
            place_from(cut, &p, ruga_sets_find(p.parent, k), turn);
        }
    }
    place_nodes(raster, cut, &p, y, x);
    if (cone != 0) {
        double middle = mean_direction(cut->node_count, x);
        roll(cut->node_count, cone, middle, x);
        roll(3 * cut->piece_count, cone, middle, y);
    }
    status = check_fit(cut, y, x, tolerance);
done:
    clear(&p);
    ruga_release(y);
    return status;
}
