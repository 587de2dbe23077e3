// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// L D L^T of the fully summed columns of one dense front, with 1x1 and 2x2 pivots that bound the entries of
// L by 1/u (threshold pivoting, Duff and Reid 1983): a pivot P is stable if
//     1x1: |a_jj| >= u max_i |a_ij|,     2x2: |P^-1| (g_j, g_r)^T <= 1/u,  g = largest entry outside P.
// Columns for which no such pivot exists are left to the parent front, where more of their rows are fully
// summed. At a root the search over all that is left finds one unless the remaining matrix is round-off
// (Bunch, Parlett 1971); what is round-off counts as a zero pivot.
//
// Work goes by blocks of 64 columns, made of blocks of 8 within which columns are updated one by one, so that
// nearly all of it is matrix products. Only the lower triangle counts; tiles on the diagonal also write
// above it, where nothing is read.
#include "solver/ldl_front.h"

#include "core/parallel.h"
#include "core/wide.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

enum { INNER = 8, STRIP = 32, OUTER = RUGA_FRONT_BLOCK };

static const double threshold = 0.01;
// A pivot below this share of the largest value that its diagonal ever had is what cancellation left.
static const double round_off = sizeof(real) == sizeof(double) ? 1e-14 : 1e-5;

static real* at(const ruga_front* f, int row, int column) {
    return f->a + (size_t)column * f->rows + row;
}

static void swap_reals(real* a, real* b) {
    real t = *a;
    *a = *b;
    *b = t;
}

// Exchanges the fully summed unknowns p < q, neither of them eliminated.
static void exchange(ruga_front* f, int p, int q) {
    if (p == q) {
        return;
    }
    RUGA_BLAS(swap)(p, at(f, p, 0), f->rows, at(f, q, 0), f->rows);
    RUGA_BLAS(swap)(q - p - 1, at(f, p + 1, p), 1, at(f, q, p + 1), f->rows);
    RUGA_BLAS(swap)(f->rows - q - 1, at(f, q + 1, p), 1, at(f, q + 1, q), 1);
    swap_reals(at(f, p, p), at(f, q, q));
    swap_reals(&f->peak[p], &f->peak[q]);
    int index = f->index[p];
    f->index[p] = f->index[q];
    f->index[q] = index;
}

// max |x_i| over [0, count). Sizes are in the order of their bits, as integers: of these the compiler makes
// vectors.
RUGA_WIDE static real largest_size(int count, const real* x) {
    bits largest = 0;
    for (int i = 0; i < count; i++) {
        real size = (real)fabs(x[i]);
        bits b;
        memcpy(&b, &size, sizeof b);
        largest = b > largest ? b : largest;
    }
    real size;
    memcpy(&size, &largest, sizeof size);
    return size;
}

// The largest |a_ij|, i != j and i != skip, over rows [begin, rows), where columns [begin, j] are up to date.
static double largest_off_diagonal(const ruga_front* f, int begin, int j, int skip) {
    double largest = 0;
    for (int i = begin; i < j; i++) {
        largest = i == skip ? largest : fmax(largest, fabs(*at(f, j, i)));
    }
    int cut = skip > j ? skip : j;
    largest = fmax(largest, largest_size(cut - j - 1, at(f, j + 1, j)));
    return fmax(largest, largest_size(f->rows - cut - 1, at(f, cut + 1, j)));
}

// The first row i >= begin, i != j, with this |a_ij|.
static int find_size(const ruga_front* f, int begin, int j, double size) {
    for (int i = begin; i < f->rows; i++) {
        if (i != j && fabs(i < j ? *at(f, j, i) : *at(f, i, j)) == size) {
            return i;
        }
    }
    return f->rows;
}

static bool pair_is_stable(const ruga_front* f, int begin, int j, int r) {
    double a = *at(f, j, j), c = *at(f, r, r), b = j < r ? *at(f, r, j) : *at(f, j, r);
    double determinant = a * c - b * b;
    if (fabs(b) <= round_off * sqrt(f->peak[j] * f->peak[r]) ||
        fabs(determinant) < 0.5 * fmax(fabs(a * c), b * b) || determinant == 0) {
        return false;
    }
    double gj = largest_off_diagonal(f, begin, j, r), gr = largest_off_diagonal(f, begin, r, j);
    double limit = fabs(determinant) / threshold;
    return fabs(c) * gj + fabs(b) * gr <= limit && fabs(b) * gj + fabs(a) * gr <= limit;
}

// Size of a stable pivot on column j among the columns [begin, end), all up to date: 0 where there is none.
static int find_pivot(const ruga_front* f, int begin, int end, int j, int* partner) {
    double d = fabs(*at(f, j, j)), largest = largest_off_diagonal(f, begin, j, -1);
    if (d > round_off * f->peak[j] && d >= threshold * largest) {
        return 1;
    }
    if (largest == 0) { // nothing but round-off: a zero pivot, wherever it stands
        return 1;
    }
    int r = find_size(f, begin, j, largest);
    if (r < end && pair_is_stable(f, begin, j, r)) {
        *partner = r;
        return 2;
    }
    return 0;
}

static void note_peaks(ruga_front* f, int begin, int end) {
    for (int j = begin; j < end; j++) {
        real size = (real)fabs(*at(f, j, j));
        f->peak[j] = size > f->peak[j] ? size : f->peak[j];
    }
}

// a -= l w^T, a [rows][columns].
RUGA_WIDE static void subtract_outer(int rows, int columns, const real* restrict l, const real* w, real* a,
                                     size_t stride) {
    for (int j = 0; j < columns; j++) {
        real* restrict column = a + (size_t)j * stride;
        for (int i = j; i < rows; i++) {
            column[i] -= l[i] * w[j];
        }
    }
}

// Column k becomes a column of L, and columns (k, end) are updated.
static void eliminate_one(ruga_front* f, int end) {
    int k = f->eliminated, below = f->rows - k - 1, columns = end - k - 1;
    real d = *at(f, k, k);
    f->pivot[2 * k] = d;
    f->pivot[2 * k + 1] = 0;
    real* l = at(f, k + 1, k);
    f->eliminated++;
    f->positive += d > 0;
    f->negative += d < 0;
    for (int i = 0; i < columns; i++) {
        f->work[i] = l[i];
    }
    RUGA_BLAS(scal)(below, 1 / d, l, 1);
    if (columns > 0) {
        subtract_outer(below, columns, l, f->work, at(f, k + 1, k + 1), (size_t)f->rows);
    }
    note_peaks(f, k + 1, end);
}

static void eliminate_zero(ruga_front* f) {
    int k = f->eliminated++;
    f->pivot[2 * k] = f->pivot[2 * k + 1] = 0;
    f->zero++;
    for (int i = k + 1; i < f->rows; i++) {
        *at(f, i, k) = 0;
    }
}

static void eliminate_pair(ruga_front* f, int end) {
    int k = f->eliminated, below = f->rows - k - 2, columns = end - k - 2;
    real a = *at(f, k, k), b = *at(f, k + 1, k), c = *at(f, k + 1, k + 1);
    double determinant = (double)a * c - (double)b * b;
    f->pivot[2 * k] = a;
    f->pivot[2 * k + 1] = b;
    f->pivot[2 * k + 2] = c;
    f->pivot[2 * k + 3] = 0;
    real *l = at(f, k + 2, k), *m = at(f, k + 2, k + 1);
    *at(f, k + 1, k) = 0; // the unit lower triangle has no entry inside D
    for (int i = 0; i < columns; i++) {
        f->work[i] = l[i];
        f->work[columns + i] = m[i];
    }
    for (int i = 0; i < below; i++) {
        double x = l[i], y = m[i];
        l[i] = (real)((c * x - b * y) / determinant);
        m[i] = (real)((a * y - b * x) / determinant);
    }
    if (columns > 0) {
        RUGA_BLAS(gemm)
        (CblasColMajor, CblasNoTrans, CblasTrans, below, columns, 2, -1, l, f->rows, f->work, columns, 1,
         at(f, k + 2, k + 2), f->rows);
    }
    f->eliminated += 2;
    f->positive += determinant < 0 ? 1 : a > 0 ? 2 : 0;
    f->negative += determinant < 0 ? 1 : a > 0 ? 0 : 2;
    note_peaks(f, k + 2, end);
}

// Pivots among the columns [eliminated, end), all up to date, until none of them is stable.
static void eliminate_columns(ruga_front* f, int end) {
    for (int j = f->eliminated; j < end;) {
        int partner = -1, size = find_pivot(f, f->eliminated, end, j, &partner);
        if (size == 0) {
            j++;
            continue;
        }
        int k = f->eliminated;
        exchange(f, k, j);
        if (size == 2) {
            exchange(f, k + 1, partner == k ? j : partner);
            eliminate_pair(f, end);
        } else if (fabs(*at(f, k, k)) > round_off * f->peak[k]) {
            eliminate_one(f, end);
        } else {
            eliminate_zero(f);
        }
        j = f->eliminated;
    }
}

// w = (L D)^T of rows [begin, end) and pivots [first, last): column p of w is w[p * (end - begin)].
RUGA_WIDE static void multiply_pivots(const ruga_front* f, int begin, int end, int first, int last,
                                      real* restrict w) {
    int count = end - begin;
    for (int p = first; p < last; p++) {
        real d = f->pivot[2 * p], e = f->pivot[2 * p + 1];
        const real* l = at(f, begin, p);
        if (e == 0) {
            for (int i = 0; i < count; i++) {
                w[i] = d * l[i];
            }
            w += count;
            continue;
        }
        const real* m = at(f, begin, p + 1);
        real c = f->pivot[2 * p + 2];
        for (int i = 0; i < count; i++) {
            w[i] = d * l[i] + e * m[i];
            w[count + i] = e * l[i] + c * m[i];
        }
        w += 2 * (size_t)count;
        p++;
    }
}

// c -= l w^T, or c = -l w^T, on and below the diagonal of c [rows][columns]: there in strips, so that little
// is computed above it. w [pivots][columns].
static void subtract_product(int rows, int columns, int pivots, const real* l, int stride, const real* w,
                             real keep, real* c, int c_stride) {
    for (int j = 0; j < columns; j += STRIP) {
        int width = columns - j < STRIP ? columns - j : STRIP;
        RUGA_BLAS(gemm)
        (CblasColMajor, CblasNoTrans, CblasTrans, columns - j, width, pivots, -1, l + j, stride, w + j,
         columns, keep, c + (ptrdiff_t)j * c_stride + j, c_stride);
    }
    if (rows > columns) {
        RUGA_BLAS(gemm)
        (CblasColMajor, CblasNoTrans, CblasTrans, rows - columns, columns, pivots, -1, l + columns, stride, w,
         columns, keep, c + columns, c_stride);
    }
}

// Pivots [first, eliminated) for the columns [begin, begin + count) by tiles.
typedef struct columns_job {
    ruga_front* front;
    int begin, end, first;
    bool shared; // a piece of `work` for each tile
} columns_job;

static void update_tile(int tile, int stop, int chunk, void* context) {
    const columns_job* job = context;
    ruga_front* f = job->front;
    int t = job->begin + tile, end = job->begin + stop, pivots = f->eliminated - job->first;
    real* work = f->work + (job->shared ? (size_t)chunk * RUGA_FRONT_TILE * OUTER : 0);
    multiply_pivots(f, t, end, job->first, f->eliminated, work);
    subtract_product(f->rows - t, end - t, pivots, at(f, t, job->first), f->rows, work, 1, at(f, t, t),
                     f->rows);
    note_peaks(f, t, end);
}

// Applies the pivots [first, eliminated), at most OUTER where shared, to the columns [begin, end).
static void update_columns(ruga_front* f, int begin, int end, int first, bool shared) {
    columns_job job = {f, begin, end, first, shared};
    if (f->eliminated == first || begin >= end) {
        return;
    }
    if (shared) {
        ruga_parallel_for(end - begin, RUGA_FRONT_TILE, update_tile, &job);
        return;
    }
    for (int t = 0; t < end - begin; t += RUGA_FRONT_TILE) {
        update_tile(t, end - begin - t < RUGA_FRONT_TILE ? end - begin : t + RUGA_FRONT_TILE, 0, &job);
    }
}

// Moves the columns [eliminated, failed) to the end of [eliminated, end). Returns their new beginning.
static int put_aside(ruga_front* f, int failed, int end) {
    int count = failed - f->eliminated, moved = end - failed < count ? end - failed : count;
    for (int k = 0; k < moved; k++) {
        exchange(f, f->eliminated + k, end - 1 - k);
    }
    return end - count;
}

// Pivots among [eliminated, end), those columns up to date; the rest of the front is not touched.
static void eliminate_block(ruga_front* f, int end) {
    int stop = end; // columns [stop, end) found no pivot so far
    while (f->eliminated < stop) {
        int first = f->eliminated, inner = stop - first < INNER ? stop : first + INNER;
        eliminate_columns(f, inner);
        update_columns(f, inner, end, first, false);
        stop = put_aside(f, inner, stop);
    }
}

void ruga_front_factor(ruga_front* f) {
    f->eliminated = f->positive = f->negative = f->zero = 0;
    int stop = f->full;
    while (f->eliminated < stop) {
        int first = f->eliminated, outer = stop - first < OUTER ? stop : first + OUTER;
        eliminate_block(f, outer);
        update_columns(f, outer, f->full, first, f->shared && f->full - outer >= 2 * RUGA_FRONT_TILE);
        stop = put_aside(f, outer, stop);
    }
    eliminate_columns(f, f->full); // those put aside, now with all others as partners
    while (f->must_finish && f->eliminated < f->full) {
        eliminate_zero(f);
    }
}

void ruga_front_update(const ruga_front* f, int begin, int end, real* work, real* update) {
    int rows = f->rows - f->full, stride = rows - begin;
    real* tile = update + ruga_update_column(rows, begin) + begin;
    if (f->eliminated == 0) {
        memset(tile, 0, (size_t)(end - begin) * (size_t)stride * sizeof *tile);
        return;
    }
    multiply_pivots(f, f->full + begin, f->full + end, 0, f->eliminated, work);
    subtract_product(stride, end - begin, f->eliminated, at(f, f->full + begin, 0), f->rows, work, 0, tile,
                     stride);
}
