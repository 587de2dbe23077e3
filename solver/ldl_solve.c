// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Solves with the multifrontal factor: L y = b front by front, children first, then L^T x = D^-1 y, parents
// first. Each pass reads the factor once, in strips of eight columns, and that reading is nearly all the time
// it takes. Tasks (ldl.h) run side by side: in the forward pass each adds what it hands up to the steps of
// the top fronts into a vector of its own, and these are added in the order of the tasks; the large panels at
// the top are shared out by rows (forward) or by columns (backward). Sums are in the same order for any
// number of threads.
//
// Where L is stored in single precision, half as many bytes are read, but all is computed in double: the inverse of
// the stored L D L^T is applied exactly, symmetric and with the inertia of D. ruga_ldl_solve refines the solution
// with residuals in double.
#include "solver/ldl.h"

#include "core/parallel.h"
#include "core/wide.h"

#include <cblas.h>
#include <math.h>

enum { STRIP = 8, ROW_CHUNK = 256, COLUMN_CHUNK = 16, LARGE = 1 << 17 };

// For panels of doubles and of floats, l [columns][stride]:
// subtract: y[i] -= sum_k l[k][i] p[k], 0 <= i < rows. project: p[k] -= sum_i l[k][i] y[i], the sum by lanes.
#define DEFINE_KERNELS(real, subtract, project)                                                              \
    RUGA_WIDE static void subtract(const real* l, size_t stride, int rows, int columns, const double* p,     \
                                   double* y) {                                                              \
        int k = 0;                                                                                           \
        for (; k + STRIP <= columns; k += STRIP, l += STRIP * stride) {                                      \
            const real *a = l, *b = a + stride, *c = b + stride, *d = c + stride, *e = d + stride;           \
            const real *f = e + stride, *g = f + stride, *h = g + stride;                                    \
            const double p0 = p[k], p1 = p[k + 1], p2 = p[k + 2], p3 = p[k + 3];                             \
            const double p4 = p[k + 4], p5 = p[k + 5], p6 = p[k + 6], p7 = p[k + 7];                         \
            _Pragma("omp simd") for (int i = 0; i < rows; i++) {                                             \
                y[i] -= ((a[i] * p0 + b[i] * p1) + (c[i] * p2 + d[i] * p3)) +                                \
                        ((e[i] * p4 + f[i] * p5) + (g[i] * p6 + h[i] * p7));                                 \
            }                                                                                                \
        }                                                                                                    \
        for (; k < columns; k++, l += stride) {                                                              \
            _Pragma("omp simd") for (int i = 0; i < rows; i++) {                                             \
                y[i] -= l[i] * p[k];                                                                         \
            }                                                                                                \
        }                                                                                                    \
    }                                                                                                        \
    RUGA_WIDE static void project(const real* l, size_t stride, int rows, int columns, const double* y,      \
                                  double* p) {                                                               \
        int k = 0;                                                                                           \
        for (; k + STRIP / 2 <= columns; k += STRIP / 2, l += STRIP / 2 * stride) {                          \
            const real *a = l, *b = a + stride, *c = b + stride, *d = c + stride;                            \
            double s0 = 0, s1 = 0, s2 = 0, s3 = 0;                                                           \
            _Pragma("omp simd reduction(+ : s0, s1, s2, s3)") for (int i = 0; i < rows; i++) {               \
                s0 += a[i] * y[i];                                                                           \
                s1 += b[i] * y[i];                                                                           \
                s2 += c[i] * y[i];                                                                           \
                s3 += d[i] * y[i];                                                                           \
            }                                                                                                \
            p[k] -= s0;                                                                                      \
            p[k + 1] -= s1;                                                                                  \
            p[k + 2] -= s2;                                                                                  \
            p[k + 3] -= s3;                                                                                  \
        }                                                                                                    \
        for (; k < columns; k++, l += stride) {                                                              \
            double s = 0;                                                                                    \
            _Pragma("omp simd reduction(+ : s)") for (int i = 0; i < rows; i++) {                            \
                s += l[i] * y[i];                                                                            \
            }                                                                                                \
            p[k] -= s;                                                                                       \
        }                                                                                                    \
    }

DEFINE_KERNELS(double, subtract_double, project_double)
DEFINE_KERNELS(float, subtract_float, project_float)

// One pass: the mode, and one panel in either precision.
typedef struct pass {
    ruga_ldl* ldl;
    bool absolute;
    double* x; // [n] by step
} pass;

typedef struct panel {
    const double* wide;  // one of them
    const float* single;
    size_t stride;
} panel;

static void subtract(const panel* l, int row, int column, int rows, int columns, const double* p, double* y) {
    size_t place = (size_t)column * l->stride + (size_t)row;
    if (l->single) {
        subtract_float(l->single + place, l->stride, rows, columns, p, y);
    } else {
        subtract_double(l->wide + place, l->stride, rows, columns, p, y);
    }
}

static void project(const panel* l, int row, int column, int rows, int columns, const double* y, double* p) {
    size_t place = (size_t)column * l->stride + (size_t)row;
    if (l->single) {
        project_float(l->single + place, l->stride, rows, columns, y, p);
    } else {
        project_double(l->wide + place, l->stride, rows, columns, y, p);
    }
}

static double entry(const panel* l, int row, int column) {
    size_t place = (size_t)column * l->stride + (size_t)row;
    return l->single ? (double)l->single[place] : l->wide[place];
}

// y[0, end) becomes L^-1 of itself for the columns [0, done) of L, done <= end.
static void forward_rows(const panel* l, int done, int end, double* y) {
    for (int c = 0; c < done; c += STRIP) {
        int stop = done - c < STRIP ? done : c + STRIP;
        for (int k = c; k < stop; k++) {
            for (int i = k + 1; i < stop; i++) {
                y[i] -= entry(l, i, k) * y[k];
            }
        }
        subtract(l, stop, c, end - stop, stop - c, y + c, y + stop);
    }
}

// y[0, done) becomes L^-T of itself less what the rows [done, end) hand down.
static void backward_rows(const panel* l, int done, int end, double* y) {
    for (int c = (done - 1) / STRIP * STRIP; c >= 0; c -= STRIP) {
        int stop = done - c < STRIP ? done : c + STRIP;
        project(l, stop, c, end - stop, stop - c, y + stop, y + c);
        for (int k = stop - 1; k >= c; k--) {
            for (int i = k + 1; i < stop; i++) {
                y[k] -= entry(l, i, k) * y[i];
            }
        }
    }
}

typedef struct shared_panel {
    panel l;
    int done, rows;
    double* y;
} shared_panel;

static void forward_chunk(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const shared_panel* s = context;
    subtract(&s->l, s->done + begin, 0, end - begin, s->done, s->y, s->y + s->done + begin);
}

static void backward_chunk(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const shared_panel* s = context;
    project(&s->l, s->done, begin, s->rows - s->done, end - begin, s->y + s->done, s->y + begin);
}

static panel panel_of(const pass* p, const front_record* r) {
    const task_memory* m = &p->ldl->memory[r->task];
    if (p->ldl->single) {
        return (panel){.single = (const float*)m->factor + r->factor, .stride = (size_t)r->rows};
    }
    return (panel){.wide = (const double*)m->factor + r->factor, .stride = (size_t)r->rows};
}

static bool is_shared(const pass* p, const front_record* r) {
    return r->task == p->ldl->symbolic.task_count &&
           (long)(r->rows - r->eliminated) * (long)r->eliminated >= LARGE;
}

static void forward_front(const pass* p, int s, double* y, double* up) {
    ruga_ldl* f = p->ldl;
    const front_record* r = &f->front[s];
    const int *index = f->memory[r->task].index + r->index, *top = f->top_place;
    int done = r->eliminated;
    panel l = panel_of(p, r);
    for (int i = 0; i < done; i++) {
        y[i] = p->x[index[i]];
    }
    for (int i = done; i < r->rows; i++) {
        y[i] = 0;
    }
    if (is_shared(p, r)) {
        shared_panel shared = {l, done, r->rows, y};
        forward_rows(&l, done, done, y);
        ruga_parallel_for(r->rows - done, ROW_CHUNK, forward_chunk, &shared);
    } else {
        forward_rows(&l, done, r->rows, y);
    }
    for (int i = 0; i < done; i++) {
        p->x[index[i]] = y[i];
    }
    for (int i = done; i < r->rows; i++) {
        double* to = up && top[index[i]] >= 0 ? up + top[index[i]] : p->x + index[i];
        *to += y[i];
    }
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

// D^-1 stands behind the panel: its entry k.
static double pivot_entry(const panel* l, int done, int k) {
    size_t place = (size_t)done * l->stride + (size_t)k;
    return l->single ? (double)l->single[place] : l->wide[place];
}

static void apply_pivots(const panel* l, int done, bool absolute, double* y) {
    for (int k = 0; k < done; k++) {
        double d = pivot_entry(l, done, 2 * k), e = pivot_entry(l, done, 2 * k + 1);
        if (e != 0) {
            apply_pair(d, e, pivot_entry(l, done, 2 * k + 2), absolute, &y[k], &y[k + 1]);
            k++;
        } else if (absolute) { // where D is zero, any positive number serves
            y[k] *= d == 0 ? 1 : fabs(d);
        } else {
            y[k] *= d;
        }
    }
}

static void backward_front(const pass* p, int s, double* y) {
    ruga_ldl* f = p->ldl;
    const front_record* r = &f->front[s];
    const int* index = f->memory[r->task].index + r->index;
    int done = r->eliminated;
    panel l = panel_of(p, r);
    if (done == 0) {
        return;
    }
    for (int i = 0; i < r->rows; i++) {
        y[i] = p->x[index[i]];
    }
    apply_pivots(&l, done, p->absolute, y);
    if (is_shared(p, r)) {
        shared_panel shared = {l, done, r->rows, y};
        ruga_parallel_for(done, COLUMN_CHUNK, backward_chunk, &shared);
        backward_rows(&l, done, done, y);
    } else {
        backward_rows(&l, done, r->rows, y);
    }
    for (int i = 0; i < done; i++) {
        p->x[index[i]] = y[i];
    }
}

static void forward_tasks(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    ruga_ldl* f = p->ldl;
    const ruga_ldl_symbolic* s = &f->symbolic;
    for (int t = begin; t < end; t++) {
        double* up = f->handed_up + (size_t)t * (size_t)f->top_count;
        for (int i = 0; i < f->top_count; i++) {
            up[i] = 0;
        }
        for (int k = s->task[t]; k < s->task[t + 1]; k++) {
            if (!s->top[k]) {
                forward_front(p, k, f->gather + (size_t)t * (size_t)f->widest, up);
            }
        }
    }
}

static void backward_tasks(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    ruga_ldl* f = p->ldl;
    const ruga_ldl_symbolic* s = &f->symbolic;
    for (int t = begin; t < end; t++) {
        for (int k = s->task[t + 1] - 1; k >= s->task[t]; k--) {
            if (!s->top[k]) {
                backward_front(p, k, f->gather + (size_t)t * (size_t)f->widest);
            }
        }
    }
}

static void take_handed_up(const ruga_ldl* f, double* x) {
    for (int t = 0; t < f->symbolic.task_count; t++) {
        const double* up = f->handed_up + (size_t)t * (size_t)f->top_count;
        for (int i = 0; i < f->top_count; i++) {
            x[f->top_step[i]] += up[i];
        }
    }
}

// y = (L D L^T)^-1 b with scaled b and y, by unknown; may be the same.
static void solve_scaled(ruga_ldl* f, bool absolute, const double* b, double* y) {
    const ruga_ldl_symbolic* s = &f->symbolic;
    pass p = {f, absolute, f->answer};
    double* top = f->gather + (size_t)s->task_count * (size_t)f->widest;
    for (int k = 0; k < s->n; k++) {
        p.x[k] = b[s->order[k]];
    }
    ruga_parallel_for(s->task_count, 1, forward_tasks, &p);
    take_handed_up(f, p.x);
    for (int k = 0; k < s->count; k++) {
        if (s->top[k]) {
            forward_front(&p, k, top, NULL);
        }
    }
    for (int k = s->count - 1; k >= 0; k--) {
        if (s->top[k]) {
            backward_front(&p, k, top);
        }
    }
    ruga_parallel_for(s->task_count, 1, backward_tasks, &p);
    for (int k = 0; k < s->n; k++) {
        y[s->order[k]] = p.x[k];
    }
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
    solve_scaled(f, false, f->defect, f->defect);
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
    enum { REFINEMENTS = 2, SINGLE_REFINEMENTS = 20 };
    const double enough = 1e-12, round_off = 4e-15;
    RUGA_ASSERT(f->ready);
    int n = f->symbolic.n;
    double size = cblas_dnrm2(n, b, 1), backward;
    for (int i = 0; i < n; i++) {
        f->load[i] = b[i] * f->scale[i];
    }
    solve_scaled(f, false, f->load, f->guess);
    double residual = find_defect(f, &backward);
    int steps = f->single ? SINGLE_REFINEMENTS : REFINEMENTS;
    for (int step = 0; step < steps && residual > enough * size && backward > round_off; step++) {
        if (!refine(f, &residual, &backward)) {
            break;
        }
    }
    for (int i = 0; i < n; i++) {
        x[i] = f->guess[i] * f->scale[i];
    }
    return RUGA_OK;
}

// x = S (L D L^T)^-1 S b, or with |D|, as the factor stands.
static ruga_status solve_once(ruga_ldl* f, bool absolute, const double* b, double* x) {
    RUGA_ASSERT(f->ready);
    for (int i = 0; i < f->symbolic.n; i++) {
        f->load[i] = b[i] * f->scale[i];
    }
    solve_scaled(f, absolute, f->load, f->guess);
    for (int i = 0; i < f->symbolic.n; i++) {
        x[i] = f->guess[i] * f->scale[i];
    }
    return RUGA_OK;
}

ruga_status ruga_ldl_solve_absolute(ruga_ldl* f, const double* b, double* x) {
    return solve_once(f, true, b, x);
}

ruga_status ruga_ldl_solve_rough(ruga_ldl* f, const double* b, double* x) {
    return solve_once(f, false, b, x);
}
