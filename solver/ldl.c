// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Multifrontal A = S^-1 L D L^T S^-1 (up to permutation) of symmetric indefinite matrices: S a diagonal
// scaling by powers of two, L unit lower triangular, D with blocks 1x1 and 2x2. The inertia of A is that of
// D (Sylvester). Fronts are assembled from the matrix and the update matrices of their children, factored
// (ldl_front.c), and hand on what is left: the update matrix and the columns without a stable pivot.
//
// Independent subtrees are tasks with memory of their own: an index list, panels of L, which only grow, and
// what they hand up. Stacks of update matrices belong to threads. Which task a front belongs to depends on
// the matrix alone, and so do all sums: the bits are the same for any number of threads.
#include "solver/ldl_front.h"

#include "core/memory.h"
#include "core/parallel.h"

#include <cblas.h>
#include <float.h>
#include <math.h>
#include <string.h>

void ruga_ldl_destroy(ruga_ldl** ldl) {
    ruga_ldl* f = *ldl;
    if (!f) {
        return;
    }
    for (int t = 0; f->memory && t <= f->symbolic.task_count; t++) {
        ruga_release(f->memory[t].apart ? f->memory[t].factor : NULL);
        ruga_release(f->memory[t].index);
        ruga_release(f->memory[t].upward);
    }
    for (int i = 0; i < f->stack_count; i++) {
        ruga_release(f->stack[i].memory);
    }
    ruga_release(f->stack);
    ruga_release(f->factor);
    ruga_release(f->memory);
    ruga_ldl_symbolic_clear(&f->symbolic);
    ruga_release(f->matrix.value);
    ruga_release(f->last);
    ruga_release(f->scale);
    ruga_release(f->child);
    ruga_release(f->sibling);
    ruga_release(f->front);
    ruga_release(f->run);
    ruga_release(f->load);
    ruga_release(f->answer);
    ruga_release(f->defect);
    ruga_release(f->guess);
    ruga_release(f->top_place);
    ruga_release(f->top_step);
    ruga_release(f->level_front);
    ruga_release(f->level_start);
    ruga_release(f->handed_up);
    ruga_release(f->gather);
    ruga_release(f);
    *ldl = NULL;
}

static void mark_last(ruga_ldl* f, int node_count, const int* node_start, const bool* last) {
    for (int i = 0; i < node_count; i++) {
        int begin = node_start ? node_start[i] : i, end = node_start ? node_start[i + 1] : i + 1;
        for (int u = begin; u < end; u++) {
            f->last[u] = last && last[i];
        }
    }
}

static void list_children(ruga_ldl* f) {
    const ruga_ldl_symbolic* s = &f->symbolic;
    for (int k = 0; k < s->count; k++) {
        f->child[k] = -1;
    }
    for (int k = s->count - 1; k >= 0; k--) {
        f->front[k].far = s->parent[k] >= 0 && !f->front[s->parent[k]].far;
        if (s->parent[k] >= 0) {
            f->sibling[k] = f->child[s->parent[k]];
            f->child[s->parent[k]] = k;
        }
    }
    for (int t = 0; t < s->task_count; t++) {
        for (int k = s->task[t]; k < s->task[t + 1]; k++) {
            f->front[k].task = t;
        }
    }
    for (int k = 0; k < s->count; k++) {
        if (s->top[k]) {
            f->front[k].task = s->task_count;
        }
        f->front[k].upward = !s->top[k] && s->parent[k] >= 0 && s->top[s->parent[k]];
    }
}

static ruga_status number_top_steps(ruga_ldl* f) {
    const ruga_ldl_symbolic* s = &f->symbolic;
    for (int k = 0; k < s->count; k++) {
        for (int i = s->pivot[k]; i < s->pivot[k + 1]; i++) {
            f->top_place[i] = s->top[k] ? f->top_count++ : -1;
        }
    }
    RUGA_TRY(RUGA_NEW(f->top_step, f->top_count));
    for (int i = 0; i < s->n; i++) {
        if (f->top_place[i] >= 0) {
            f->top_step[f->top_place[i]] = i;
        }
    }
    return RUGA_NEW(f->handed_up, (size_t)s->task_count * (size_t)f->top_count);
}

// Height of the top fronts above the tasks.
static ruga_status list_levels(ruga_ldl* f) {
    const ruga_ldl_symbolic* s = &f->symbolic;
    int* height;
    RUGA_TRY(RUGA_NEW_ZERO(height, s->count));
    ruga_status status = RUGA_OK;
    for (int k = 0; k < s->count; k++) {
        if (s->top[k]) {
            f->level_count = height[k] + 1 > f->level_count ? height[k] + 1 : f->level_count;
            if (s->parent[k] >= 0 && height[s->parent[k]] <= height[k]) {
                height[s->parent[k]] = height[k] + 1;
            }
        }
    }
    RUGA_TRY_DONE(RUGA_NEW(f->level_front, s->count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(f->level_start, f->level_count + 1));
    int listed = 0;
    for (int level = 0; level < f->level_count; level++) {
        for (int k = 0; k < s->count; k++) {
            if (s->top[k] && height[k] == level) {
                f->level_front[listed++] = k;
            }
        }
        f->level_start[level + 1] = listed;
    }
done:
    ruga_release(height);
    return status;
}

// Fronts that solves may have at work at the same time.
static int most_at_once(const ruga_ldl* f) {
    int most = f->symbolic.task_count;
    for (int k = 0; k < f->level_count; k++) {
        int count = f->level_start[k + 1] - f->level_start[k];
        most = count > most ? count : most;
    }
    return most;
}

ruga_status ruga_ldl_create(const ruga_sparse* lower, int node_count, const int* node_start, const bool* last,
                            bool single, ruga_ldl** ldl) {
    ruga_status status = RUGA_OK;
    int n = lower->columns;
    ruga_ldl* f = NULL;
    *ldl = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(f, 1));
    RUGA_TRY_DONE(ruga_ldl_analyse(lower, node_count, node_start, last, &f->symbolic));
    f->single = single;
    f->matrix = *lower;
    f->matrix.value = NULL;
    RUGA_TRY_DONE(RUGA_NEW(f->matrix.value, lower->start[n]));
    RUGA_TRY_DONE(RUGA_NEW(f->last, n));
    RUGA_TRY_DONE(RUGA_NEW(f->scale, n));
    RUGA_TRY_DONE(RUGA_NEW(f->child, f->symbolic.count));
    RUGA_TRY_DONE(RUGA_NEW(f->sibling, f->symbolic.count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(f->front, f->symbolic.count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(f->memory, f->symbolic.task_count + 1));
    RUGA_TRY_DONE(RUGA_NEW(f->load, n));
    RUGA_TRY_DONE(RUGA_NEW(f->answer, n));
    RUGA_TRY_DONE(RUGA_NEW(f->defect, n));
    RUGA_TRY_DONE(RUGA_NEW(f->guess, n));
    RUGA_TRY_DONE(RUGA_NEW(f->top_place, n));
    RUGA_TRY_DONE(number_top_steps(f));
    mark_last(f, node_start ? node_count : n, node_start, last);
    list_children(f);
    RUGA_TRY_DONE(list_levels(f));
    *ldl = f;
done:
    if (status != RUGA_OK) {
        ruga_ldl_destroy(&f);
    }
    return status;
}

static size_t entry_size(const ruga_ldl* f) {
    return f->single ? sizeof(float) : sizeof(double);
}

size_t ruga_ldl_bytes(const ruga_ldl* f) {
    size_t n = (size_t)f->symbolic.n, entries = (size_t)f->matrix.start[n];
    size_t bytes = ruga_ldl_symbolic_bytes(&f->symbolic);
    bytes += entries * sizeof(double) + n * (5 * sizeof(double) + sizeof(bool));
    bytes += (size_t)f->symbolic.count * (sizeof(front_record) + 3 * sizeof(int));
    size_t tasks = (size_t)f->symbolic.task_count, top = (size_t)f->top_count;
    bytes += ((size_t)f->gather_capacity + tasks * top) * sizeof(double) + (n + top) * sizeof(int);
    for (int t = 0; t <= f->symbolic.task_count; t++) {
        const task_memory* m = &f->memory[t];
        bytes += (m->apart ? m->factor_capacity * entry_size(f) : 0) + m->upward_capacity +
                 m->index_capacity * sizeof(int);
    }
    for (int i = 0; i < f->stack_count; i++) {
        bytes += f->stack[i].capacity;
    }
    return bytes + f->run_capacity * sizeof *f->run + f->factor_bytes;
}

// Columns are shared out for the scaling; each share has its own maxima of rows.
enum { SCALE_SHARES = 4 };

typedef struct scaling {
    ruga_ldl* f;
    const double* values;
    double* max[SCALE_SHARES]; // [n]
} scaling;

static void share_maxima(int begin, int end, int chunk, void* context) {
    const scaling* c = context;
    const ruga_sparse* a = &c->f->matrix;
    const double* scale = c->f->scale;
    double* max = c->max[chunk];
    memset(max, 0, (size_t)a->columns * sizeof *max);
    for (int j = begin; j < end; j++) {
        double column_max = 0;
        for (int p = a->start[j]; p < a->start[j + 1]; p++) {
            int i = a->index[p];
            double size = fabs(c->values[p]) * scale[i] * scale[j];
            max[i] = size > max[i] ? size : max[i];
            column_max = size > column_max ? size : column_max;
        }
        max[j] = column_max > max[j] ? column_max : max[j];
    }
}

static int share_size(const ruga_ldl* f) {
    return ruga_chunk_count(f->symbolic.n, SCALE_SHARES);
}

// max[0][i] = max_j |a_ij| scale_i scale_j
static void row_maxima(scaling* c) {
    int n = c->f->symbolic.n, shares = ruga_chunk_count(n, share_size(c->f));
    ruga_parallel_for(n, share_size(c->f), share_maxima, c);
    for (int k = 1; k < shares; k++) {
        for (int i = 0; i < n; i++) {
            c->max[0][i] = c->max[k][i] > c->max[0][i] ? c->max[k][i] : c->max[0][i];
        }
    }
}

static void scale_values(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const scaling* c = context;
    const ruga_sparse* a = &c->f->matrix;
    const double* scale = c->f->scale;
    for (int j = begin; j < end; j++) {
        for (int p = a->start[j]; p < a->start[j + 1]; p++) {
            a->value[p] = c->values[p] * scale[j] * scale[a->index[p]];
        }
    }
}

// The power of two next below x > 0: scaling by it rounds nothing.
static double power_below(double x) {
    int exponent;
    (void)frexp(x, &exponent);
    return ldexp(1, exponent - 1);
}

// Rows and columns to largest entries near 1: first those of K by themselves (Ruiz 2001), then those of the
// multipliers, so that H weighs about as much as K whatever its unit. A tenth of K rather than the same:
// then hardly any pivot of a soft K is refused for the size of its H (measured on sheets with clusters).
static void scale_matrix(ruga_ldl* f, const double* values) {
    int n = f->symbolic.n;
    scaling c = {f, values, {f->defect, f->guess, f->load, f->answer}};
    double *scale = f->scale, *max = c.max[0];
    for (int i = 0; i < n; i++) {
        scale[i] = f->last[i] ? 0 : 1;
    }
    for (int pass = 0; pass < 2; pass++) {
        row_maxima(&c);
        for (int i = 0; i < n; i++) {
            scale[i] = max[i] > 0 ? scale[i] / sqrt(max[i]) : scale[i];
        }
    }
    for (int i = 0; i < n; i++) {
        scale[i] = f->last[i] ? 1 : power_below(scale[i]);
    }
    row_maxima(&c);
    for (int i = 0; i < n; i++) {
        if (f->last[i] && max[i] > 0) {
            scale[i] = power_below(0.1 / max[i]);
        }
    }
    ruga_parallel_for(n, share_size(f), scale_values, &c);
}

ruga_status ruga_ldl_make_room(void** memory, size_t* capacity, size_t count, size_t size) {
    if (*memory && count <= *capacity) {
        return RUGA_OK;
    }
    size_t wanted = count > *capacity + *capacity / 32 ? count : *capacity + *capacity / 32;
    void* grown = ruga_reallocate(*memory, wanted * size);
    if (!grown) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: the factor needs %zu MB more",
                         (wanted * size) >> 20);
    }
    *memory = grown;
    *capacity = wanted;
    return RUGA_OK;
}

ruga_status ruga_ldl_make_factor_room(const ruga_ldl* f, task_memory* m, size_t count) {
    if (count <= m->factor_capacity) {
        return RUGA_OK;
    }
    void* grown = m->apart ? m->factor : NULL;
    RUGA_TRY(ruga_ldl_make_room(&grown, &m->factor_capacity, count, entry_size(f)));
    if (!m->apart) {
        memcpy(grown, m->factor, m->factor_used * entry_size(f));
    }
    m->factor = grown;
    m->apart = true;
    return RUGA_OK;
}

// Room for L of all tasks, one after another, each with as much as it asks for.
static ruga_status reserve_factors(ruga_ldl* f) {
    size_t total = 0, pad = RUGA_LDL_TILE * RUGA_LDL_TILE;
    for (int t = 0; t <= f->symbolic.task_count; t++) {
        task_memory* m = &f->memory[t];
        m->factor_capacity = (m->factor_capacity + pad - 1) / pad * pad;
        total += m->factor_capacity * entry_size(f);
    }
    RUGA_TRY(ruga_ldl_make_room(&f->factor, &f->factor_bytes, total, 1));
    char* next = f->factor;
    for (int t = 0; t <= f->symbolic.task_count; t++) {
        f->memory[t].factor = next;
        next += f->memory[t].factor_capacity * entry_size(f);
    }
    return RUGA_OK;
}

size_t ruga_ldl_below_children(const ruga_ldl* f, int s) {
    const front_record* r = &f->front[s];
    size_t base = f->memory[r->task].stack_used[!r->far];
    for (int c = f->child[s]; c >= 0; c = f->sibling[c]) {
        base = f->front[c].task == r->task && f->front[c].update < base ? f->front[c].update : base;
    }
    return base;
}

static ruga_status factor_front(ruga_ldl* f, int s, front_stack* stack) {
    return f->in_single ? ruga_ldl_factor_front_single(f, s, stack) : ruga_ldl_factor_front(f, s, stack);
}

// There are as many as threads at work. Which one it is changes no result.
static front_stack* take_stack(ruga_ldl* f) {
    int i = 0;
    while (atomic_flag_test_and_set(&f->stack[i].taken)) {
        i = (i + 1) % f->stack_count;
    }
    return &f->stack[i];
}

static void factor_tasks(int begin, int end, int chunk, void* context) {
    (void)chunk;
    ruga_ldl* f = context;
    const ruga_ldl_symbolic* s = &f->symbolic;
    for (int i = begin; i < end; i++) {
        int t = s->by_work[i];
        task_memory* m = &f->memory[t];
        front_stack* stack = take_stack(f);
        for (int k = s->task[t]; k < s->task[t + 1] && m->status == RUGA_OK; k++) {
            if (!s->top[k]) {
                m->status = factor_front(f, k, stack);
            }
        }
        atomic_flag_clear(&stack->taken);
    }
}

static ruga_status factor_top(ruga_ldl* f) {
    const ruga_ldl_symbolic* s = &f->symbolic;
    for (int k = 0; k < s->count; k++) {
        if (s->top[k]) {
            RUGA_TRY(factor_front(f, k, f->stack));
        }
    }
    return RUGA_OK;
}

// What each task needs where no pivot is delayed: then nothing is allocated after the first factorisation,
// and in the first one nothing is moved.
static ruga_status plan_tasks(ruga_ldl* f) {
    const ruga_ldl_symbolic* s = &f->symbolic;
    for (int k = 0; k < s->count; k++) {
        task_memory* m = &f->memory[f->front[k].task];
        size_t own = (size_t)(s->pivot[k + 1] - s->pivot[k]), *used = m->stack_used;
        size_t below = s->row_start[k + 1] - s->row_start[k], update = ruga_update_size((int)below);
        size_t peak = used[0] + used[1] + ruga_front_size(s->top[k], own, below);
        front_record* r = &f->front[k];
        size_t* handed = ruga_ldl_used(m, r);
        used[!r->far] = ruga_ldl_below_children(f, k);
        r->update = *handed;
        *handed += update;
        m->factor_used += ruga_ldl_stored_size((int)(own + below), (int)own);
        m->index_used += own + below;
        peak -= r->upward ? update : 0;
        m->stack_peak = peak > m->stack_peak ? peak : m->stack_peak;
    }
    for (int t = 0; t <= s->task_count; t++) {
        task_memory* m = &f->memory[t];
        m->factor_capacity = m->factor_used + m->factor_used / 32; // a few pivots may be delayed
        RUGA_TRY(ruga_ldl_make_room((void**)&m->index, &m->index_capacity, m->index_used, sizeof(int)));
        RUGA_TRY(ruga_ldl_make_room(&m->upward, &m->upward_capacity, m->upward_used * sizeof(double), 1));
    }
    return reserve_factors(f);
}

// The first serves the top, too, whose fronts are made when the tasks are done.
static ruga_status reserve_stacks(ruga_ldl* f) {
    int tasks = f->symbolic.task_count, count = ruga_threads() < tasks ? ruga_threads() : tasks;
    size_t most = 1;
    for (int t = 0; t < tasks; t++) {
        most = f->memory[t].stack_peak > most ? f->memory[t].stack_peak : most;
    }
    size_t top = f->memory[tasks].stack_peak, first = top > most ? top : most;
    RUGA_TRY(RUGA_RESERVE(f->stack, f->stack_capacity, count > 1 ? count : 1));
    for (; f->stack_count < count || f->stack_count < 1; f->stack_count++) {
        front_stack* stack = &f->stack[f->stack_count];
        *stack = (front_stack){.taken = ATOMIC_FLAG_INIT};
        RUGA_TRY(ruga_ldl_make_room(&stack->memory, &stack->capacity,
                                    (f->stack_count ? most : first) * sizeof(double), 1));
    }
    return RUGA_OK;
}

static void start_tasks(ruga_ldl* f) {
    for (int t = 0; t <= f->symbolic.task_count; t++) {
        task_memory* m = &f->memory[t];
        m->factor_used = m->index_used = m->stack_used[0] = m->stack_used[1] = m->upward_used = 0;
        m->positive = m->negative = m->zero = 0;
        m->entries = m->flops = 0;
        m->status = RUGA_OK;
    }
}

// The rows [begin, end) of a front; where `to` is NULL they are only counted.
static int list_runs(const ruga_ldl* f, const int* index, int begin, int end, row_run* to) {
    int count = 0;
    for (int i = begin; i < end; i++) {
        int step = index[i], top = f->top_place[step];
        if (i > begin && step == index[i - 1] + 1 && (top >= 0) == (f->top_place[step - 1] >= 0)) {
            if (to) {
                to[count - 1].count++;
            }
            continue;
        }
        if (to) {
            to[count] = (row_run){step, 1, top};
        }
        count++;
    }
    return count;
}

static ruga_status set_runs(ruga_ldl* f) {
    size_t used = 0;
    for (int fill = 0; fill < 2; fill++) {
        used = 0;
        for (int k = 0; k < f->symbolic.count; k++) {
            front_record* r = &f->front[k];
            const int* index = f->memory[r->task].index + r->index;
            row_run* to = fill ? f->run + used : NULL;
            r->run = used;
            r->own_runs = list_runs(f, index, 0, r->eliminated, to);
            r->runs = r->own_runs + list_runs(f, index, r->eliminated, r->rows, to ? to + r->own_runs : NULL);
            used += (size_t)r->runs;
        }
        RUGA_TRY(ruga_ldl_make_room((void**)&f->run, &f->run_capacity, used, sizeof *f->run));
    }
    return RUGA_OK;
}

static ruga_status finish(ruga_ldl* f, ruga_factor_info* info) {
    *info = (ruga_factor_info){0};
    for (int t = 0; t <= f->symbolic.task_count; t++) {
        const task_memory* m = &f->memory[t];
        info->positive += m->positive;
        info->negative += m->negative;
        info->zero += m->zero;
        info->entries += m->entries;
        info->flops += m->flops;
    }
    info->perturbed = info->zero;
    info->success = info->zero == 0;
    for (int k = 0; k < f->symbolic.count; k++) {
        int rows = RUGA_LDL_TILE * ruga_ldl_tiles(f->front[k].rows);
        f->widest = rows > f->widest ? rows : f->widest;
    }
    RUGA_TRY(RUGA_RESERVE(f->gather, f->gather_capacity, most_at_once(f) * f->widest));
    RUGA_TRY(set_runs(f));
    f->ready = true;
    return RUGA_OK;
}

ruga_status ruga_ldl_numeric(ruga_ldl* f, const double* values, bool in_single, ruga_factor_info* info) {
    RUGA_ASSERT(f->single || !in_single);
    f->ready = false;
    f->in_single = in_single;
    scale_matrix(f, values);
    if (!f->planned) {
        start_tasks(f);
        RUGA_TRY(plan_tasks(f));
        f->planned = true;
    }
    RUGA_TRY(reserve_stacks(f));
    start_tasks(f);
    ruga_parallel_for(f->symbolic.task_count, 1, factor_tasks, f);
    for (int t = 0; t < f->symbolic.task_count; t++) {
        if (f->memory[t].status != RUGA_OK) { // its sentence may belong to another thread
            return ruga_fail(f->memory[t].status, "out of memory in the factorisation of %d unknowns",
                             f->symbolic.n);
        }
    }
    RUGA_TRY(factor_top(f));
    return finish(f, info);
}
