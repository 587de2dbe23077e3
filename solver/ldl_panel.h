// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// How L of one front is stored, so that each pass of a solve reads it in one stream: in tiles of 4 x 4, by
// columns, filled up with zeros, strips of 4 columns one after another, each from the tile on the diagonal
// down. Behind it D^-1 [eliminated][2]. The fronts at the top, which several threads share, stand in blocks of
// strips: the strips as far as the block's own rows, then the rows below in pieces, strip after strip.
#ifndef RUGA_SOLVER_LDL_PANEL_H
#define RUGA_SOLVER_LDL_PANEL_H

#include <stdbool.h>
#include <stddef.h>

enum { RUGA_LDL_TILE = 4, RUGA_LDL_BLOCK = 32, RUGA_LDL_PIECE = 64 }; // strips of a block, tiles of a piece

static inline int ruga_ldl_tiles(int count) {
    return (count + RUGA_LDL_TILE - 1) / RUGA_LDL_TILE;
}

// Tiles of the first `strips` strips, the first of which is `high` tiles high.
static inline size_t ruga_ldl_strips(int high, int strips) {
    size_t s = (size_t)strips;
    return s * (size_t)high - (s > 0 ? s * (s - 1) / 2 : 0);
}

static inline size_t ruga_ldl_stored_size(int rows, int eliminated) {
    size_t tiles = ruga_ldl_strips(ruga_ldl_tiles(rows), ruga_ldl_tiles(eliminated));
    return RUGA_LDL_TILE * RUGA_LDL_TILE * tiles + 2 * (size_t)eliminated;
}

// Strips [first, last), of a front `high` tiles high, that stand together as far as the rows of tile `end`.
typedef struct ruga_ldl_block {
    int high, first, last, end;
} ruga_ldl_block;

static inline ruga_ldl_block ruga_ldl_block_at(int high, int strips, bool blocks, int first) {
    ruga_ldl_block b = {high, first, strips, high};
    if (blocks) {
        b.last = first + RUGA_LDL_BLOCK < strips ? first + RUGA_LDL_BLOCK : strips;
        b.end = b.last;
    }
    return b;
}

// Pieces of the rows below the block, and the first tile of one of them: the end of the one before.
static inline int ruga_ldl_pieces(const ruga_ldl_block* b) {
    return (b->high - b->end + RUGA_LDL_PIECE - 1) / RUGA_LDL_PIECE;
}
static inline int ruga_ldl_piece(const ruga_ldl_block* b, int piece) {
    int row = b->end + RUGA_LDL_PIECE * piece;
    return row < b->high ? row : b->high;
}

// Where the tile of strip s on the diagonal, and that of strip s at the head of a piece, stand.
static inline size_t ruga_ldl_diagonal(const ruga_ldl_block* b, int s) {
    size_t before = ruga_ldl_strips(b->high, b->first);
    return RUGA_LDL_TILE * RUGA_LDL_TILE * (before + ruga_ldl_strips(b->end - b->first, s - b->first));
}
static inline size_t ruga_ldl_head(const ruga_ldl_block* b, int piece, int s) {
    size_t row = (size_t)ruga_ldl_piece(b, piece), next = (size_t)ruga_ldl_piece(b, piece + 1);
    size_t above = (size_t)(b->last - b->first) * (row - (size_t)b->end);
    size_t strips = (size_t)(s - b->first) * (next - row);
    return ruga_ldl_diagonal(b, b->last) + RUGA_LDL_TILE * RUGA_LDL_TILE * (above + strips);
}

#endif
