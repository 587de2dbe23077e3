// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// One triangle cut by chords. Its border has six places, numbered around: 2 i = corner i, 2 i + 1 = the
// embedded node on the edge from corner i to corner i + 1, where there is one.
#ifndef RUGA_CREASE_PIECES_H
#define RUGA_CREASE_PIECES_H

#include "core/status.h"

enum { RUGA_BORDER_PLACES = 6, RUGA_MOST_PIECES = 4, RUGA_MOST_CHORDS = 3 };

typedef struct ruga_outline {
    int count;
    int place[RUGA_BORDER_PLACES]; // counter-clockwise
} ruga_outline;

typedef struct ruga_split {
    int piece_count;
    ruga_outline piece[RUGA_MOST_PIECES];
    int chord_count;
    int chord[RUGA_MOST_CHORDS][2]; // places
    int own[RUGA_MOST_CHORDS];      // index of the chord that was given, -1 = auxiliary
} ruga_split;

// The triangle with embedded nodes at node[i] of the way from corner i to corner i + 1 (0 = none), whole.
void ruga_split_start(const double node[3], ruga_split* split);
// Cuts by a chord between two places. False, and nothing done, where it crosses an earlier one, lies along
// the border or is there already.
bool ruga_split_add(ruga_split* split, int from, int to, int own);
// Auxiliary chords until all pieces are triangles. position: [6][3] of all places.
void ruga_split_fill(ruga_split* split, const double position[RUGA_BORDER_PLACES][3]);
// The piece on the left of the way from one place to another, which is part of its border; -1 = none.
int ruga_split_left_of(const ruga_split* split, int from, int to);
// Whether piece `p` reaches a place.
bool ruga_split_reaches(const ruga_split* split, int p, int place);
// Weights [3] of a place in the triangle.
void ruga_place_weights(const double node[3], int place, double weight[3]);
// Part of the triangle's area that a polygon covers, and the weights of that part's middle in the triangle.
double ruga_outline_fraction(const ruga_outline* polygon, const double node[3], double middle[3]);

#endif
