// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Solves with the multifrontal factor: L y = b front by front, children first, then L^T x = D^-1 y, parents
// first. Each pass reads the factor once, in strips of four columns, and that reading is nearly all the time
// it takes. Tasks (ldl.h) run side by side: in the forward pass each adds what it hands up to the steps of
// the top fronts into a vector of its own, and these are added in the order of the tasks. Of the fronts at the
// top those that are as far above the tasks run side by side, block after block of strips: their triangles
// first, then the rows below (forward) or the strips (backward) of all of them are shared out. What they hand
// up is added in their order. So sums are in the same order for any number of threads.
//
// Where L is stored in single precision, half as many bytes are read, but all is computed in double: the
// inverse of the stored L D L^T is applied exactly, symmetric and with the inertia of D. ruga_ldl_solve
// refines the solution with residuals in double.
#include "solver/ldl.h"

#include "core/parallel.h"
#include "core/random.h"
#include "core/wide.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

enum { TILE = RUGA_LDL_TILE };
enum { SHARES = 4, CHUNK = 4096 }; // of a block's strips, for several threads; steps of a copy
static const double small = 2e5;   // entries of a factor that one thread reads sooner than two share it

// Four numbers wherever a double may stand.
typedef double lane4 __attribute__((vector_size(32), aligned(8), may_alias));

// One strip of 4 columns, in doubles or floats, and `tiles` of its tiles below the diagonal: y are their
// rows, p the strip's. forward: y -= L p. backward: p -= L^T y, the sum by lanes, from the last tile up, so
// that each pass of a solve is one stream of memory.
#define DEFINE_KERNELS(real, column_of, forward, backward)                                                   \
    RUGA_WIDE_PART void column_of(const real* l, lane4* column) {                                            \
        for (int r = 0; r < TILE; r++) {                                                                     \
            (*column)[r] = (double)l[r];                                                                     \
        }                                                                                                    \
    }                                                                                                        \
    RUGA_WIDE static void forward(const real* restrict l, int tiles, const double* restrict p,               \
                                  double* restrict y) {                                                      \
        const lane4 p0 = {p[0], p[0], p[0], p[0]}, p1 = {p[1], p[1], p[1], p[1]};                            \
        const lane4 p2 = {p[2], p[2], p[2], p[2]}, p3 = {p[3], p[3], p[3], p[3]};                            \
        for (int t = 0; t < tiles; t++, l += TILE * TILE, y += TILE) {                                       \
            lane4 c0, c1, c2, c3, *row = (lane4*)y;                                                          \
            column_of(l, &c0);                                                                               \
            column_of(l + TILE, &c1);                                                                        \
            column_of(l + 2 * TILE, &c2);                                                                    \
            column_of(l + 3 * TILE, &c3);                                                                    \
            *row -= (c0 * p0 + c1 * p1) + (c2 * p2 + c3 * p3);                                               \
        }                                                                                                    \
    }                                                                                                        \
    RUGA_WIDE static void backward(const real* restrict l, int tiles, const double* restrict y,              \
                                   double* restrict p) {                                                     \
        lane4 s0 = {0}, s1 = {0}, s2 = {0}, s3 = {0};                                                        \
        for (int t = tiles - 1; t >= 0; t--) {                                                               \
            const real* tile = l + TILE * TILE * (ptrdiff_t)t;                                               \
            const lane4 row = *(const lane4*)(y + TILE * (ptrdiff_t)t);                                      \
            lane4 c0, c1, c2, c3;                                                                            \
            column_of(tile, &c0);                                                                            \
            column_of(tile + TILE, &c1);                                                                     \
            column_of(tile + 2 * TILE, &c2);                                                                 \
            column_of(tile + 3 * TILE, &c3);                                                                 \
            s0 += c0 * row;                                                                                  \
            s1 += c1 * row;                                                                                  \
            s2 += c2 * row;                                                                                  \
            s3 += c3 * row;                                                                                  \
        }                                                                                                    \
        p[0] -= (s0[0] + s0[1]) + (s0[2] + s0[3]);                                                           \
        p[1] -= (s1[0] + s1[1]) + (s1[2] + s1[3]);                                                           \
        p[2] -= (s2[0] + s2[1]) + (s2[2] + s2[3]);                                                           \
        p[3] -= (s3[0] + s3[1]) + (s3[2] + s3[3]);                                                           \
    }

DEFINE_KERNELS(double, column_of_doubles, forward_double, backward_double)
DEFINE_KERNELS(float, column_of_floats, forward_float, backward_float)

typedef struct pass {
    ruga_ldl* ldl;
    bool absolute;
    double* x;           // [n] by step
    const double *scale; // [n] by unknown, of right-hand side and solution; NULL = they are scaled
    const double* from;  // right-hand side and solution, by unknown
    double* to;
    const int* level; // fronts of the level at work
    int strip;        // first of their block at work
    int pieces;       // of their rows, the most
    int shares;       // of a block's strips: one reads best, more serve more threads; the sums are the same
} pass;

// L of one front, in double or single precision.
typedef struct panel {
    const double* wide; // one of them
    const float* single;
    int high, strips; // tiles of its rows and of its columns
    bool top;
} panel;

// Strip s and its tiles of rows [begin, end), which stand at `at`; y [4 high] are the front's rows.
static void forward_strip(const panel* l, int s, int begin, int end, size_t at, double* y) {
    double *p = y + (ptrdiff_t)TILE * s, *rows = y + (ptrdiff_t)TILE * begin;
    if (l->single) {
        forward_float(l->single + at, end - begin, p, rows);
    } else {
        forward_double(l->wide + at, end - begin, p, rows);
    }
}

static void backward_strip(const panel* l, int s, int begin, int end, size_t at, double* y) {
    double *p = y + (ptrdiff_t)TILE * s, *rows = y + (ptrdiff_t)TILE * begin;
    if (l->single) {
        backward_float(l->single + at, end - begin, rows, p);
    } else {
        backward_double(l->wide + at, end - begin, rows, p);
    }
}

// The six entries below the diagonal of the tile at `at`, by columns.
static void triangle_of(const panel* l, size_t at, double t[6]) {
    static const int place[6] = {1, 2, 3, TILE + 2, TILE + 3, 2 * TILE + 3};
    for (int k = 0; k < 6; k++) {
        t[k] = l->single ? (double)l->single[at + (size_t)place[k]] : l->wide[at + (size_t)place[k]];
    }
}

// The strips of the block become L^-1 of themselves, and its rows below lose what those hand on.
static void forward(const panel* l, const ruga_ldl_block* b, double* y) {
    for (int s = b->first; s < b->last; s++) {
        size_t at = ruga_ldl_diagonal(b, s);
        double t[6], *p = y + (ptrdiff_t)TILE * s;
        triangle_of(l, at, t);
        p[1] -= t[0] * p[0];
        p[2] -= t[1] * p[0] + t[3] * p[1];
        p[3] -= t[2] * p[0] + t[4] * p[1] + t[5] * p[2];
        forward_strip(l, s, s + 1, b->end, at + TILE * TILE, y);
    }
}

// The strips of the block become L^-T of themselves less what its rows below hand down.
static void backward(const panel* l, const ruga_ldl_block* b, double* y) {
    for (int s = b->last - 1; s >= b->first; s--) {
        size_t at = ruga_ldl_diagonal(b, s);
        double t[6], *p = y + (ptrdiff_t)TILE * s;
        backward_strip(l, s, s + 1, b->end, at + TILE * TILE, y);
        triangle_of(l, at, t);
        p[2] -= t[5] * p[3];
        p[1] -= t[3] * p[2] + t[4] * p[3];
        p[0] -= t[0] * p[1] + t[1] * p[2] + t[2] * p[3];
    }
}

static panel panel_of(const pass* p, const front_record* r) {
    const task_memory* m = &p->ldl->memory[r->task];
    panel l = {.high = ruga_ldl_tiles(r->rows),
               .strips = ruga_ldl_tiles(r->eliminated),
               .top = r->task == p->ldl->symbolic.task_count};
    if (p->ldl->single) {
        l.single = (const float*)m->factor + r->factor;
    } else {
        l.wide = (const double*)m->factor + r->factor;
    }
    return l;
}

static void load_rows(const row_run* run, int runs, const double* x, double* y) {
    for (int k = 0; k < runs; k++) {
        const double* from = x + run[k].step;
        for (int i = 0; i < run[k].count; i++) {
            *y++ = from[i];
        }
    }
}

static void store_rows(const row_run* run, int runs, const double* y, double* x) {
    for (int k = 0; k < runs; k++) {
        double* to = x + run[k].step;
        for (int i = 0; i < run[k].count; i++) {
            to[i] = *y++;
        }
    }
}

// What goes to steps of the top fronts is added to `up`, if there is one.
static void add_rows(const row_run* run, int runs, const double* y, double* up, double* x) {
    for (int k = 0; k < runs; k++) {
        double* to = up && run[k].top >= 0 ? up + run[k].top : x + run[k].step;
        for (int i = 0; i < run[k].count; i++) {
            to[i] += *y++;
        }
    }
}

// y [TILE high] are the front's pivots, and zero below them.
static void load_pivots(const pass* p, const front_record* r, const panel* l, double* y) {
    load_rows(p->ldl->run + r->run, r->own_runs, p->x, y);
    for (int i = r->eliminated; i < TILE * l->high; i++) {
        y[i] = 0;
    }
}

static void store_pivots(const pass* p, const front_record* r, const double* y) {
    store_rows(p->ldl->run + r->run, r->own_runs, y, p->x);
}

// y [TILE high] becomes L^-1 of the front's pivots, and below them what they hand up.
static void forward_front(const pass* p, int s, double* y) {
    const front_record* r = &p->ldl->front[s];
    panel l = panel_of(p, r);
    ruga_ldl_block b = ruga_ldl_block_at(l.high, l.strips, l.top, 0);
    load_pivots(p, r, &l, y);
    forward(&l, &b, y);
    store_pivots(p, r, y);
}

static void hand_up(const pass* p, int s, const double* y, double* up) {
    const front_record* r = &p->ldl->front[s];
    add_rows(p->ldl->run + r->run + r->own_runs, r->runs - r->own_runs, y + r->eliminated, up, p->x);
}

// M = D^-1 or, absolute, |D^-1| = (M^2 + |det M| I) / sqrt(tr M^2 + 2 |det M|) for blocks (Cayley-Hamilton).
static void apply_pair(double a, double b, double c, bool absolute, double* x, double* y) {
    if (absolute) {
        double det = fabs(a * c - b * b), trace = a * a + 2 * b * b + c * c;
        double root = sqrt(trace + 2 * det), off = b * (a + c);
        double first = a * a + b * b + det, second = b * b + c * c + det;
        a = first / root;
        b = off / root;
        c = second / root;
    }
    double sum = a * *x + b * *y;
    *y = b * *x + c * *y;
    *x = sum;
}

static double pivot_entry(const panel* l, int k) {
    size_t place = TILE * TILE * ruga_ldl_strips(l->high, l->strips) + (size_t)k;
    return l->single ? (double)l->single[place] : l->wide[place];
}

static void apply_pivots(const panel* l, int done, bool absolute, double* y) {
    for (int k = 0; k < done; k++) {
        double d = pivot_entry(l, 2 * k), e = pivot_entry(l, 2 * k + 1);
        if (e != 0) {
            apply_pair(d, e, pivot_entry(l, 2 * k + 2), absolute, &y[k], &y[k + 1]);
            k++;
        } else if (absolute) { // where D is zero, any positive number serves
            y[k] *= d == 0 ? 1 : fabs(d);
        } else {
            y[k] *= d;
        }
    }
}

// y [TILE high] are D^-1 of the front's pivots, and below them the solution.
static void load_front(const pass* p, const front_record* r, const panel* l, double* y) {
    load_rows(p->ldl->run + r->run, r->runs, p->x, y);
    for (int i = r->rows; i < TILE * l->high; i++) {
        y[i] = 0;
    }
    apply_pivots(l, r->eliminated, p->absolute, y);
}

static void backward_front(const pass* p, int s, double* y) {
    const front_record* r = &p->ldl->front[s];
    panel l = panel_of(p, r);
    ruga_ldl_block b = ruga_ldl_block_at(l.high, l.strips, l.top, 0);
    if (r->eliminated > 0) {
        load_front(p, r, &l, y);
        backward(&l, &b, y);
        store_pivots(p, r, y);
    }
}

static void forward_tasks(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    ruga_ldl* f = p->ldl;
    const ruga_ldl_symbolic* s = &f->symbolic;
    for (int i = begin; i < end; i++) {
        int t = s->by_work[i];
        double* up = f->handed_up + (size_t)t * (size_t)f->top_count;
        memset(up, 0, (size_t)f->top_count * sizeof *up);
        for (int k = s->task[t]; k < s->task[t + 1]; k++) {
            if (!s->top[k]) {
                double* y = f->gather + (size_t)t * (size_t)f->widest;
                forward_front(p, k, y);
                hand_up(p, k, y, up);
            }
        }
    }
}

static void backward_tasks(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    ruga_ldl* f = p->ldl;
    const ruga_ldl_symbolic* s = &f->symbolic;
    for (int i = begin; i < end; i++) {
        int t = s->by_work[i];
        for (int k = s->task[t + 1] - 1; k >= s->task[t]; k--) {
            if (!s->top[k]) {
                backward_front(p, k, f->gather + (size_t)t * (size_t)f->widest);
            }
        }
    }
}

// Front i of the level at work, with its rows y and its block at work. False where it has fewer blocks.
typedef struct share {
    const front_record* record;
    panel l;
    ruga_ldl_block block;
    double* y;
} share;
static bool take_share(const pass* p, int i, share* a) {
    a->record = &p->ldl->front[p->level[i]];
    a->l = panel_of(p, a->record);
    a->y = p->ldl->gather + (size_t)i * (size_t)p->ldl->widest;
    a->block = ruga_ldl_block_at(a->l.high, a->l.strips, true, p->strip);
    return p->strip < a->l.strips;
}

// The triangles of the block of fronts [begin, end).
static void forward_triangles(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    for (int i = begin; i < end; i++) {
        share a;
        bool any = take_share(p, i, &a);
        if (p->strip == 0) {
            load_pivots(p, a.record, &a.l, a.y);
        }
        if (any) {
            forward(&a.l, &a.block, a.y);
        }
        if (any && a.block.last == a.l.strips) {
            store_pivots(p, a.record, a.y);
        }
    }
}

static void forward_piece(const share* a, int piece) {
    int first = ruga_ldl_piece(&a->block, piece), end = ruga_ldl_piece(&a->block, piece + 1);
    for (int s = a->block.first; s < a->block.last; s++) {
        forward_strip(&a->l, s, first, end, ruga_ldl_head(&a->block, piece, s), a->y);
    }
}

// The rows below the block: pieces [begin, end), numbered by p->pieces to a front.
static void forward_pieces(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    for (int k = begin; k < end; k++) {
        share a;
        if (take_share(p, k / p->pieces, &a) && k % p->pieces < ruga_ldl_pieces(&a.block)) {
            forward_piece(&a, k % p->pieces);
        }
    }
}

// What the rows below the block hand down to a share of its strips.
static void backward_strips(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const int shares = p->shares, size = RUGA_LDL_BLOCK / shares;
    for (int k = begin; k < end; k++) {
        share a;
        if (!take_share(p, k / shares, &a)) {
            continue;
        }
        const ruga_ldl_block* b = &a.block;
        int first = b->first + size * (k % shares), last = first + size < b->last ? first + size : b->last;
        for (int piece = ruga_ldl_pieces(b) - 1; piece >= 0; piece--) {
            int row = ruga_ldl_piece(b, piece), end_row = ruga_ldl_piece(b, piece + 1);
            for (int s = last - 1; s >= first; s--) {
                backward_strip(&a.l, s, row, end_row, ruga_ldl_head(b, piece, s), a.y);
            }
        }
    }
}

static void backward_triangles(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    for (int i = begin; i < end; i++) {
        share a;
        if (take_share(p, i, &a)) {
            backward(&a.l, &a.block, a.y);
        }
        if (p->strip == 0) {
            store_pivots(p, a.record, a.y);
        }
    }
}

static void load_level(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    for (int i = begin; i < end; i++) {
        share a;
        (void)take_share(p, i, &a);
        load_front(p, a.record, &a.l, a.y);
    }
}

static void add_handed_up(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_ldl* f = p->ldl;
    for (int t = 0; t < f->symbolic.task_count; t++) {
        const double* up = f->handed_up + (size_t)t * (size_t)f->top_count;
        for (int i = begin; i < end; i++) {
            p->x[f->top_step[i]] += up[i];
        }
    }
}

// Shares out `count` items one by one, or where the factor is small none.
static void share_out(pass* p, int count, ruga_parallel_body* body) {
    ruga_parallel_for(count, p->ldl->symbolic.entries < small && count > 1 ? count : 1, body, p);
}

// The level at work becomes number k; returns its fronts, *blocks of the one with most.
static int enter_level(pass* p, int k, int* blocks) {
    const ruga_ldl* f = p->ldl;
    int count = f->level_start[k + 1] - f->level_start[k], strips = 0, high = 0;
    p->level = f->level_front + f->level_start[k];
    for (int i = 0; i < count; i++) {
        panel l = panel_of(p, &f->front[p->level[i]]);
        strips = l.strips > strips ? l.strips : strips;
        high = l.high > high ? l.high : high;
    }
    p->shares = ruga_threads() > 1 ? SHARES : 1;
    p->pieces = ruga_chunk_count(high, RUGA_LDL_PIECE);
    *blocks = ruga_chunk_count(strips, RUGA_LDL_BLOCK);
    return count;
}

static void forward_top(pass* p) {
    const ruga_ldl* f = p->ldl;
    ruga_parallel_for(f->top_count, CHUNK / 4, add_handed_up, p);
    for (int k = 0; k < f->level_count; k++) {
        int blocks, count = enter_level(p, k, &blocks);
        for (int block = 0; block < blocks || block == 0; block++) { // the first clears what is handed up
            p->strip = RUGA_LDL_BLOCK * block;
            share_out(p, count, forward_triangles);
            share_out(p, p->pieces * count, forward_pieces);
        }
        for (int i = 0; i < count; i++) {
            hand_up(p, p->level[i], f->gather + (size_t)i * (size_t)f->widest, NULL);
        }
    }
}

static void backward_top(pass* p) {
    for (int k = p->ldl->level_count - 1; k >= 0; k--) {
        int blocks, count = enter_level(p, k, &blocks);
        p->strip = 0;
        share_out(p, count, load_level);
        for (int block = blocks - 1; block >= 0; block--) {
            p->strip = RUGA_LDL_BLOCK * block;
            share_out(p, p->shares * count, backward_strips);
            share_out(p, count, backward_triangles);
        }
    }
}

static void load_steps(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const int* order = p->ldl->symbolic.order;
    for (int k = begin; k < end; k++) {
        int i = order[k];
        p->x[k] = p->scale ? p->from[i] * p->scale[i] : p->from[i];
    }
}

static void store_steps(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const int* order = p->ldl->symbolic.order;
    for (int k = begin; k < end; k++) {
        int i = order[k];
        p->to[i] = p->scale ? p->x[k] * p->scale[i] : p->x[k];
    }
}

// to = S (L D L^T)^-1 S from, by unknown, or with |D|; without a scale S = I. May be the same.
static void solve_steps(ruga_ldl* f, bool absolute, const double* scale, const double* from, double* to) {
    const ruga_ldl_symbolic* s = &f->symbolic;
    pass p = {.ldl = f, .absolute = absolute, .x = f->answer, .scale = scale, .from = from, .to = to};
    ruga_parallel_for(s->n, CHUNK, load_steps, &p);
    share_out(&p, s->task_count, forward_tasks);
    forward_top(&p);
    backward_top(&p);
    share_out(&p, s->task_count, backward_tasks);
    ruga_parallel_for(s->n, CHUNK, store_steps, &p);
}

// defect = S (b - A x) for x = S guess; returns |b - A x|. *backward: the defect relative to what round-off
// in S x and S b explains.
static double find_defect(ruga_ldl* f, double* backward) {
    int n = f->symbolic.n;
    double sum = 0;
    ruga_sparse_multiply_symmetric(&f->matrix, f->guess, f->defect);
    for (int i = 0; i < n; i++) {
        f->defect[i] = f->load[i] - f->defect[i];
        double r = f->defect[i] / f->scale[i];
        sum += r * r;
    }
    *backward = cblas_dnrm2(n, f->defect, 1) / (cblas_dnrm2(n, f->guess, 1) + cblas_dnrm2(n, f->load, 1));
    return sqrt(sum);
}

// One step of iterative refinement, taken back where it does not help. True where another may.
static bool refine(ruga_ldl* f, double* residual, double* backward) {
    int n = f->symbolic.n;
    solve_steps(f, false, NULL, f->defect, f->defect);
    cblas_daxpy(n, 1, f->defect, 1, f->guess, 1);
    double before = *residual;
    *residual = find_defect(f, backward);
    if (!(*residual < before)) {
        for (int k = 0; k < n; k++) {
            f->guess[f->symbolic.order[k]] -= f->answer[k];
        }
    }
    return *residual < 0.5 * before;
}

ruga_status ruga_ldl_solve(ruga_ldl* f, const double* b, double* x) {
    const double enough = f->single ? 0 : 1e-12, round_off = 4e-15;
    const int most = f->single ? 20 : 2;
    RUGA_ASSERT(f->ready);
    int n = f->symbolic.n;
    double size = cblas_dnrm2(n, b, 1), backward;
    for (int i = 0; i < n; i++) {
        f->load[i] = b[i] * f->scale[i];
    }
    solve_steps(f, false, NULL, f->load, f->guess);
    double residual = find_defect(f, &backward);
    for (int step = 0; step < most && residual > enough * size && backward > round_off; step++) {
        if (!refine(f, &residual, &backward)) {
            break;
        }
    }
    for (int i = 0; i < n; i++) {
        x[i] = f->guess[i] * f->scale[i];
    }
    return RUGA_OK;
}

ruga_status ruga_ldl_solve_absolute(ruga_ldl* f, const double* b, double* x) {
    RUGA_ASSERT(f->ready);
    solve_steps(f, true, f->scale, b, x);
    return RUGA_OK;
}

ruga_status ruga_ldl_solve_rough(ruga_ldl* f, const double* b, double* x) {
    RUGA_ASSERT(f->ready);
    solve_steps(f, false, f->scale, b, x);
    return RUGA_OK;
}

// The stored M = L D L^T is A + E, and M has the inertia of D. If the spectral radius of G = I - M^-1 A = M^-1 E, by
// which each refinement shrinks an error, is below one, then no M - t E = M (I - t G), 0 <= t <= 1, is singular: no
// eigenvalue passes through zero on the way to A, which has the same inertia. A random v of length one has a part of at
// least c / sqrt(n) along the left eigenvector of the largest eigenvalue, but for a probability of about c, and
// |G^k v| is at least that part times the k-th power of the radius (after Dixon 1983). So the radius is below one
// where |G^k v| < c / sqrt(n), here with c = 1e-3. A factor in single precision shrinks errors 1e3 to 1e4 times.
ruga_status ruga_ldl_prove_inertia(ruga_ldl* f, bool* proven) {
    enum { MOST = 4 };
    RUGA_ASSERT(f->ready);
    int n = f->symbolic.n;
    ruga_random random = {.state = 1};
    *proven = !f->in_single;
    if (*proven) {
        return RUGA_OK;
    }
    for (int i = 0; i < n; i++) {
        f->guess[i] = ruga_random_uniform(&random) - 0.5;
    }
    double before = cblas_dnrm2(n, f->guess, 1), left = before;
    for (int k = 0; k < MOST && !*proven && left <= before; k++) {
        ruga_sparse_multiply_symmetric(&f->matrix, f->guess, f->defect);
        solve_steps(f, false, NULL, f->defect, f->defect);
        cblas_daxpy(n, -1, f->defect, 1, f->guess, 1);
        left = cblas_dnrm2(n, f->guess, 1);
        *proven = left < 1e-3 / sqrt(n) * before;
    }
    return RUGA_OK;
}
