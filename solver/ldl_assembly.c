// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// One front of the multifrontal factorisation (ldl.h), in either precision (ldl_front.h): its fully summed
// columns are assembled on the stack from the matrix and the update matrices of its children, and factored;
// its update matrix is made tile by tile, of what its pivots leave and of the children's. Its columns of L
// are stored, in single precision where the factor is kept so; the update matrix and the columns without a
// stable pivot stay on the stack.
#include "solver/ldl_front.h"

#include "core/parallel.h"
#include "core/wide.h"

#include <math.h>
#include <string.h>

typedef struct assembly {
    ruga_ldl* ldl;
    task_memory* memory;
    int s, own, late, below; // pivots of its own, delayed ones of children, rows that stay
    ruga_front front;
    front_stack* stack;
    real* update;
    size_t stored; // where L of the front begins
} assembly;

static real* end_of_stack(const front_stack* stack) {
    return (real*)stack->memory + stack->capacity / sizeof(real);
}

static const real* delayed_of(const assembly* a, int c, const real** update, int* late, int* below) {
    const front_record* r = &a->ldl->front[c];
    *below = r->rows - r->full;
    *late = r->full - r->eliminated;
    size_t size = ruga_update_size(*below), delayed = (size_t)*late * (size_t)(*late + *below + 1);
    if (r->far && !r->upward) {
        *update = end_of_stack(a->stack) - r->update - size;
        return *update - delayed;
    }
    const void* memory = r->upward ? a->ldl->memory[r->task].upward : a->stack->memory;
    *update = (const real*)memory + r->update;
    return *update + size;
}

// Room for `count` reals; what the far stack has moves along with the end.
static ruga_status reserve_stack(front_stack* stack, size_t far, size_t count) {
    size_t before = stack->capacity / sizeof(real);
    RUGA_TRY(ruga_ldl_make_room(&stack->memory, &stack->capacity, count * sizeof(real), 1));
    if (stack->capacity / sizeof(real) > before) {
        memmove(end_of_stack(stack) - far, (real*)stack->memory + before - far, far * sizeof(real));
    }
    return RUGA_OK;
}

static ruga_status reserve_upward(task_memory* m, size_t count) {
    return ruga_ldl_make_room(&m->upward, &m->upward_capacity, (m->upward_used + count) * sizeof(real), 1);
}

static ruga_status reserve_front(assembly* a) {
    ruga_ldl* f = a->ldl;
    const ruga_ldl_symbolic* s = &f->symbolic;
    task_memory* m = a->memory;
    for (int c = f->child[a->s]; c >= 0; c = f->sibling[c]) {
        a->late += f->front[c].full - f->front[c].eliminated;
    }
    a->own = s->pivot[a->s + 1] - s->pivot[a->s];
    a->below = (int)(s->row_start[a->s + 1] - s->row_start[a->s]);
    size_t full = (size_t)(a->own + a->late), rows = full + (size_t)a->below, *used = m->stack_used;
    size_t update = ruga_update_size(a->below), size = ruga_front_size(s->top[a->s], full, (size_t)a->below);
    bool far = f->front[a->s].far, upward = f->front[a->s].upward;
    RUGA_TRY(ruga_ldl_make_room((void**)&m->index, &m->index_capacity, m->index_used + rows, sizeof(int)));
    RUGA_TRY(reserve_stack(a->stack, used[1], used[0] + used[1] + size - (upward ? update : 0)));
    a->front = (ruga_front){.rows = (int)rows, .full = (int)full, .a = (real*)a->stack->memory + used[0]};
    if (upward) {
        RUGA_TRY(reserve_upward(m, update));
        a->update = (real*)m->upward + m->upward_used;
    } else if (far) {
        a->update = end_of_stack(a->stack) - used[1] - update;
    } else {
        a->update = a->front.a;
        a->front.a += update;
    }
    a->front.index = m->index + m->index_used;
    a->front.pivot = a->front.a + full * rows;
    a->front.peak = a->front.pivot + 2 * full;
    a->front.work = a->front.peak + full;
    a->front.shared = s->top[a->s];
    a->front.must_finish = s->parent[a->s] < 0;
    for (size_t j = 0; j < full; j++) {
        memset(a->front.a + j * rows + j, 0, (rows - j) * sizeof(real));
    }
    memset(a->front.peak, 0, full * sizeof(real));
    return RUGA_OK;
}

static void assemble_matrix(assembly* a) {
    const ruga_ldl_symbolic* s = &a->ldl->symbolic;
    size_t rows = (size_t)a->front.rows;
    for (int k = s->entry_start[a->s]; k < s->entry_start[a->s + 1]; k++) {
        int i = s->entry_row[k], j = s->entry_column[k];
        a->front.a[(size_t)j * rows + (size_t)(i < a->own ? i : i + a->late)] +=
            (real)a->ldl->matrix.value[s->entry[k]];
    }
    for (int j = 0; j < a->own; j++) {
        a->front.peak[j] = (real)fabs(a->front.a[(size_t)j * rows + (size_t)j]);
        a->front.index[j] = s->pivot[a->s] + j;
    }
    for (int i = 0; i < a->below; i++) {
        a->front.index[a->own + a->late + i] = s->row[s->row_start[a->s] + (size_t)i];
    }
}

// The first of the ascending places that is not below x.
static int find_place(const int* place, int count, int x) {
    int begin = 0;
    while (begin < count) {
        int middle = begin + (count - begin) / 2;
        begin = place[middle] < x ? middle + 1 : begin;
        count = place[middle] < x ? count : middle;
    }
    return begin;
}

// to[place[i]] += from[i], i in [begin, end): one run of consecutive places after another.
RUGA_WIDE static void add_runs(const int* place, const int* run_end, int begin, int end,
                               const real* restrict from, real* restrict to) {
    for (int i = begin; i < end;) {
        real* run = to + (place[i] - i);
        for (int stop = run_end[i]; i < stop; i++) {
            run[i] += from[i];
        }
    }
}

// Adds the columns of child c's update matrix that are pivots of ours.
static void add_pivot_columns(assembly* a, int c) {
    const ruga_ldl_symbolic* s = &a->ldl->symbolic;
    const int *place = s->place + s->row_start[c], *run_end = s->run_end + s->row_start[c];
    const real* update;
    int late, below;
    (void)delayed_of(a, c, &update, &late, &below);
    int split = find_place(place, below, a->own);
    for (int j = 0; j < split; j++) {
        const real* from = update + ruga_update_column(below, j);
        real* to = a->front.a + (size_t)place[j] * (size_t)a->front.rows;
        a->front.peak[place[j]] += (real)fabs(from[j]);
        add_runs(place, run_end, j, split, from, to);
        add_runs(place, run_end, split, below, from, to + a->late);
    }
}

// Adds those that fall into the columns [begin, end) of our own update matrix.
static void add_update_columns(const assembly* a, int c, int begin, int end) {
    const ruga_ldl_symbolic* s = &a->ldl->symbolic;
    const int *place = s->place + s->row_start[c], *run_end = s->run_end + s->row_start[c];
    const real* update;
    int late, below;
    (void)delayed_of(a, c, &update, &late, &below);
    int first = find_place(place, below, a->own + begin);
    for (int j = first; j < below && place[j] < a->own + end; j++) {
        real* to = a->update + ruga_update_column(a->below, place[j] - a->own) - a->own;
        add_runs(place, run_end, j, below, update + ruga_update_column(below, j), to);
    }
}

// Places child c's delayed columns at [column, column + late) of our front.
static void add_delayed(assembly* a, int c, int column, const int* place, int late, int below,
                        const real* delayed) {
    const front_record* r = &a->ldl->front[c];
    const int* index = a->ldl->memory[r->task].index + r->index + r->eliminated;
    size_t rows = (size_t)a->front.rows, height = (size_t)(late + below);
    for (int q = 0; q < late; q++) {
        const real* from = delayed + (size_t)q * height;
        real* to = a->front.a + (size_t)(column + q) * rows;
        for (int i = q; i < late; i++) {
            to[column + i] = from[i];
        }
        for (int i = 0; i < below; i++) {
            if (place[i] < a->own) {
                a->front.a[(size_t)place[i] * rows + (size_t)(column + q)] = from[late + i];
            } else {
                to[place[i] + a->late] = from[late + i];
            }
        }
        a->front.peak[column + q] = delayed[(size_t)late * height + (size_t)q];
        a->front.index[column + q] = index[q];
    }
}

static void assemble_children(assembly* a) {
    const ruga_ldl* f = a->ldl;
    int column = a->own;
    for (int c = f->child[a->s]; c >= 0; c = f->sibling[c]) {
        const real* update;
        int late, below;
        const real* delayed = delayed_of(a, c, &update, &late, &below);
        const int* place = f->symbolic.place + f->symbolic.row_start[c];
        add_pivot_columns(a, c);
        add_delayed(a, c, column, place, late, below, delayed);
        column += late;
    }
}

// Our update matrix by tiles: what our pivots leave, and the children's.
static void update_tiles(int begin, int end, int chunk, void* context) {
    const assembly* a = context;
    const ruga_ldl* f = a->ldl;
    real* work = a->front.work + (size_t)chunk * RUGA_FRONT_TILE * (size_t)a->front.full;
    for (int t = begin; t < end; t += RUGA_FRONT_TILE) {
        int stop = end - t < RUGA_FRONT_TILE ? end : t + RUGA_FRONT_TILE;
        ruga_front_update(&a->front, t, stop, work, a->update);
        for (int c = f->child[a->s]; c >= 0; c = f->sibling[c]) {
            add_update_columns(a, c, t, stop);
        }
    }
}

// The fronts at the top are few and large: their tiles are shared out. Below, tasks run side by side.
static void make_update(assembly* a) {
    if (a->ldl->symbolic.top[a->s]) {
        ruga_parallel_for(a->below, RUGA_FRONT_TILE, update_tiles, a);
    } else {
        update_tiles(0, a->below, 0, a);
    }
}

// Tiles [begin, end) of the strip of columns [4 s, 4 s + 4) below the diagonal, of which there are `done`.
#define DEFINE_STORE(type, store)                                                                            \
    RUGA_WIDE static void store(const real* a, int rows, int done, int s, int begin, int end, type* to) {    \
        enum { TILE = RUGA_LDL_TILE };                                                                       \
        int first = TILE * s, columns = done - first < TILE ? done - first : TILE;                           \
        const real* from = a + (size_t)first * (size_t)rows;                                                 \
        for (int row = TILE * begin; row < TILE * end; row += TILE, to += TILE * TILE) {                     \
            if (row > first && columns == TILE && rows - row >= TILE) {                                      \
                for (int k = 0; k < TILE; k++) {                                                             \
                    for (int r = 0; r < TILE; r++) {                                                         \
                        to[TILE * k + r] = (type)from[(size_t)k * (size_t)rows + (size_t)(row + r)];         \
                    }                                                                                        \
                }                                                                                            \
                continue;                                                                                    \
            }                                                                                                \
            for (int k = 0; k < TILE; k++) {                                                                 \
                for (int r = 0; r < TILE; r++) {                                                             \
                    bool below = k < columns && row + r < rows && row + r > first + k;                       \
                    to[TILE * k + r] =                                                                       \
                        below ? (type)from[(size_t)k * (size_t)rows + (size_t)(row + r)] : 0;                \
                }                                                                                            \
            }                                                                                                \
        }                                                                                                    \
    }
DEFINE_STORE(double, store_double)
DEFINE_STORE(float, store_float)

static void store_run(const assembly* a, int s, int begin, int end, size_t at) {
    const ruga_front* f = &a->front;
    at += a->stored;
    if (a->ldl->single) {
        store_float(f->a, f->rows, f->eliminated, s, begin, end, (float*)a->memory->factor + at);
    } else {
        store_double(f->a, f->rows, f->eliminated, s, begin, end, (double*)a->memory->factor + at);
    }
}

static void store_strips(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const assembly* a = context;
    const bool top = a->ldl->symbolic.top[a->s];
    int high = ruga_ldl_tiles(a->front.rows), strips = ruga_ldl_tiles(a->front.eliminated);
    for (int s = begin; s < end; s++) {
        ruga_ldl_block b = ruga_ldl_block_at(high, strips, top, top ? s - s % RUGA_LDL_BLOCK : 0);
        store_run(a, s, s, b.end, ruga_ldl_diagonal(&b, s));
        for (int k = 0; k < ruga_ldl_pieces(&b); k++) {
            store_run(a, s, ruga_ldl_piece(&b, k), ruga_ldl_piece(&b, k + 1), ruga_ldl_head(&b, k, s));
        }
    }
}

static void store_pivots(const ruga_front* f, const ruga_ldl* ldl, void* factor, size_t at) {
    for (int k = 0; k < 2 * f->eliminated; k++) {
        if (ldl->single) {
            ((float*)factor)[at + (size_t)k] = (float)f->pivot[k];
        } else {
            ((double*)factor)[at + (size_t)k] = f->pivot[k];
        }
    }
}

static ruga_status store_factor(assembly* a) {
    const ruga_ldl* ldl = a->ldl;
    task_memory* m = a->memory;
    const ruga_front* f = &a->front;
    size_t size = ruga_ldl_stored_size(f->rows, f->eliminated);
    a->stored = m->factor_used;
    RUGA_TRY(ruga_ldl_make_factor_room(ldl, m, a->stored + size));
    ruga_parallel_for(ruga_ldl_tiles(f->eliminated), RUGA_LDL_BLOCK, store_strips, a);
    m->factor_used = a->stored + size;
    store_pivots(f, ldl, m->factor, m->factor_used - 2 * (size_t)f->eliminated);
    return RUGA_OK;
}

// The delayed columns and their peaks go beside the update matrix: down into the front that they stand in, or
// up behind it, one by one.
static ruga_status keep_delayed(assembly* a, const front_record* record) {
    const ruga_front* f = &a->front;
    size_t done = (size_t)f->eliminated, late = (size_t)f->full - done, rows = (size_t)f->rows,
           height = rows - done;
    size_t update = ruga_update_size(a->below);
    bool far = record->far && !record->upward;
    if (record->upward) {
        RUGA_TRY(reserve_upward(a->memory, update + late * (height + 1)));
        a->update = (real*)a->memory->upward + a->memory->upward_used;
    }
    real* delayed = far ? a->update - late * (height + 1) : a->update + update;
    real* peak = delayed + late * height;
    if (far) {
        memmove(peak, f->peak + done, late * sizeof(real));
    }
    for (size_t k = 0; k < late; k++) {
        size_t q = far ? late - 1 - k : k;
        memmove(delayed + q * height, f->a + (done + q) * rows + done, height * sizeof(real));
    }
    if (!far) {
        memmove(peak, f->peak + done, late * sizeof(real));
    }
    return RUGA_OK;
}

// Keeps L, and hands on the update matrix and the delayed columns; the children's are gone.
static ruga_status store_front(assembly* a) {
    ruga_ldl* ldl = a->ldl;
    task_memory* m = a->memory;
    const ruga_front* f = &a->front;
    size_t rows = (size_t)f->rows, late = (size_t)(f->full - f->eliminated);
    RUGA_TRY(store_factor(a));
    front_record* record = &ldl->front[a->s];
    RUGA_TRY(keep_delayed(a, record));
    size_t* handed = ruga_ldl_used(m, record);
    m->stack_used[!record->far] = ruga_ldl_below_children(ldl, a->s);
    record->factor = a->stored;
    record->index = m->index_used;
    record->update = *handed;
    record->rows = f->rows;
    record->full = f->full;
    record->eliminated = f->eliminated;
    m->index_used += rows;
    *handed += ruga_update_size(a->below) + late * (late + (size_t)a->below + 1);
    return RUGA_OK;
}

// D becomes D^-1; the inverse of a zero pivot is zero, so that its unknown is zero in every solution.
static void invert_pivots(ruga_front* f) {
    for (int k = 0; k < f->eliminated; k++) {
        real* d = f->pivot + 2 * (size_t)k;
        if (d[1] == 0) {
            d[0] = d[0] == 0 ? 0 : 1 / d[0];
            continue;
        }
        const double a = d[0], b = d[1], c = d[2], determinant = a * c - b * b;
        d[0] = (real)(c / determinant);
        d[1] = (real)(-b / determinant);
        d[2] = (real)(a / determinant);
        k++;
    }
}

ruga_status ruga_ldl_factor_front(ruga_ldl* f, int s, front_stack* stack) {
    assembly a = {.ldl = f, .memory = &f->memory[f->front[s].task], .s = s, .stack = stack};
    task_memory* m = a.memory;
    RUGA_TRY(reserve_front(&a));
    assemble_matrix(&a);
    assemble_children(&a);
    ruga_front_factor(&a.front);
    make_update(&a);
    double w = a.front.eliminated, r = a.front.rows - w;
    m->entries += w * (w + 1) / 2 + w * r;
    m->flops += w * r * r + w * w * r + w * w * w / 3;
    m->positive += a.front.positive;
    m->negative += a.front.negative;
    m->zero += a.front.zero;
    invert_pivots(&a.front);
    return store_front(&a);
}
