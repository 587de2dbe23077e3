// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// All decisions are on the numbers of places, so that no triangle is too thin. Auxiliary chords are chosen
// for the widest of the smallest angles at their ends; they join places that are not on one edge, so that no
// piece is without area.
#include "crease/pieces.h"

#include "core/vec3.h"

#include <string.h>

void ruga_split_start(const double node[3], ruga_split* split) {
    *split = (ruga_split){.piece_count = 1};
    ruga_outline* whole = &split->piece[0];
    for (int i = 0; i < 3; i++) {
        whole->place[whole->count++] = 2 * i;
        if (node[i] > 0) {
            whole->place[whole->count++] = 2 * i + 1;
        }
    }
}

static int find_place(const ruga_outline* p, int place) {
    for (int i = 0; i < p->count; i++) {
        if (p->place[i] == place) {
            return i;
        }
    }
    return -1;
}

// Whether two places lie on one edge of the triangle.
static bool on_one_edge(int a, int b) {
    for (int i = 0; i < 6; i += 2) {
        bool has_a = a == i || a == i + 1 || a == (i + 2) % 6,
             has_b = b == i || b == i + 1 || b == (i + 2) % 6;
        if (has_a && has_b) {
            return true;
        }
    }
    return false;
}

// The polygon from position i on to position j.
static ruga_outline part_of(const ruga_outline* p, int i, int j) {
    ruga_outline part = {0};
    for (int k = i;; k = (k + 1) % p->count) {
        part.place[part.count++] = p->place[k];
        if (k == j) {
            return part;
        }
    }
}

bool ruga_split_add(ruga_split* split, int from, int to, int own) {
    if (split->piece_count == RUGA_MOST_PIECES || on_one_edge(from, to)) {
        return false;
    }
    for (int p = 0; p < split->piece_count; p++) {
        ruga_outline whole = split->piece[p];
        int i = find_place(&whole, from), j = find_place(&whole, to);
        if (i < 0 || j < 0 || (i + 1) % whole.count == j || (j + 1) % whole.count == i) {
            continue;
        }
        split->piece[p] = part_of(&whole, i, j);
        split->piece[split->piece_count++] = part_of(&whole, j, i);
        split->chord[split->chord_count][0] = from;
        split->chord[split->chord_count][1] = to;
        split->own[split->chord_count++] = own;
        return true;
    }
    return false;
}

static double angle_at(const double a[3], const double b[3], const double c[3]) {
    double u[3], v[3], n[3];
    ruga_subtract(b, a, u);
    ruga_subtract(c, a, v);
    ruga_cross(u, v, n);
    return atan2(ruga_norm(n), ruga_dot(u, v));
}

// Smallest angle that the chord between positions i and j makes with the border beside it.
static double chord_angle(const ruga_outline* p, int i, int j, const double x[RUGA_BORDER_PLACES][3]) {
    double least = RUGA_PI;
    for (int end = 0; end < 2; end++) {
        int at = end ? j : i, other = end ? i : j;
        for (int side = 1; side < p->count; side += p->count - 2) {
            int beside = (at + side) % p->count;
            least = fmin(least, angle_at(x[p->place[at]], x[p->place[other]], x[p->place[beside]]));
        }
    }
    return least;
}

// The best chord of a polygon with more than three corners.
static bool best_chord(const ruga_outline* p, const double x[RUGA_BORDER_PLACES][3], int chord[2]) {
    double widest = -1;
    for (int i = 0; i < p->count; i++) {
        for (int j = i + 2; j < p->count && j - i < p->count - 1; j++) {
            double angle = on_one_edge(p->place[i], p->place[j]) ? -1 : chord_angle(p, i, j, x);
            if (angle > widest) {
                widest = angle;
                chord[0] = p->place[i];
                chord[1] = p->place[j];
            }
        }
    }
    return widest >= 0;
}

void ruga_split_fill(ruga_split* split, const double position[RUGA_BORDER_PLACES][3]) {
    for (int p = 0; p < split->piece_count; p++) {
        int chord[2];
        while (split->piece[p].count > 3 && best_chord(&split->piece[p], position, chord) &&
               ruga_split_add(split, chord[0], chord[1], -1)) {
        }
    }
}

int ruga_split_left_of(const ruga_split* split, int from, int to) {
    for (int p = 0; p < split->piece_count; p++) {
        int i = find_place(&split->piece[p], from);
        if (i >= 0 && split->piece[p].place[(i + 1) % split->piece[p].count] == to) {
            return p;
        }
    }
    return -1;
}

bool ruga_split_reaches(const ruga_split* split, int p, int place) {
    return find_place(&split->piece[p], place) >= 0;
}

void ruga_place_weights(const double node[3], int place, double weight[3]) {
    memset(weight, 0, 3 * sizeof *weight);
    int i = place / 2;
    double t = place % 2 ? node[i] : 0;
    weight[i] = 1 - t;
    weight[(i + 1) % 3] += t;
}

// In the weights of corners 1 and 2 the triangle has the area 1/2: a fan from the first place.
double ruga_outline_fraction(const ruga_outline* polygon, const double node[3], double middle[3]) {
    double sum = 0, first[3], a[3], b[3], moment[3] = {0, 0, 0};
    ruga_place_weights(node, polygon->place[0], first);
    for (int i = 1; i + 1 < polygon->count; i++) {
        ruga_place_weights(node, polygon->place[i], a);
        ruga_place_weights(node, polygon->place[i + 1], b);
        double area = (a[1] - first[1]) * (b[2] - first[2]) - (a[2] - first[2]) * (b[1] - first[1]);
        sum += area;
        for (int k = 0; k < 3; k++) {
            moment[k] += area * (first[k] + a[k] + b[k]) / 3;
        }
    }
    for (int k = 0; k < 3; k++) {
        middle[k] = moment[k] / sum;
    }
    return sum;
}
