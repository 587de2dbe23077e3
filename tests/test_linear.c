// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"
#include "tests/linear_systems.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "ruga/ruga.h"
#include "core/random.h"
#include "solver/belos_shim.h"
#include "solver/linear.h"

#include <cblas.h>
#include <lapacke.h>
#include <umfpack.h>

#include <stdlib.h>
#include <string.h>

static ruga_factor* factor_of(const linear_system* s, ruga_factor_kind kind, ruga_factor_info* info) {
    ruga_factor* f = NULL;
    assert_ok(ruga_factor_create(kind, &s->a, s->nodes, s->node_start, s->last, &f));
    assert_ok(ruga_factor_numeric(f, s->a.value, info));
    return f;
}

static double norm(int n, const double* x) {
    return cblas_dnrm2(n, x, 1);
}

static double* random_vector(int n, uint64_t seed) {
    double* x = NULL;
    assert_ok(RUGA_NEW(x, n));
    ruga_random random = {seed};
    for (int i = 0; i < n; i++) {
        x[i] = 2 * ruga_random_uniform(&random) - 1;
    }
    return x;
}

// |b - A x| / |b| for the factor's solution of a random b that is zero for multipliers: constraints of order
// one would ask for displacements whose round-off is above |b|.
static double solve_residual(const linear_system* s, ruga_factor* f) {
    int n = s->a.rows;
    double *b = random_vector(n, 7), *x = random_vector(n, 8), *r = random_vector(n, 9);
    for (int i = 0; i < s->nodes; i++) {
        for (int u = s->node_start[i]; s->last[i] && u < s->node_start[i + 1]; u++) {
            b[u] = 0;
        }
    }
    assert_ok(ruga_factor_solve(f, b, x));
    ruga_sparse_multiply_symmetric(&s->a, x, r);
    cblas_daxpy(n, -1, b, 1, r, 1);
    double residual = norm(n, r) / norm(n, b);
    assert_ok(ruga_factor_solve(f, b, b)); // in place
    assert_memory_equal(b, x, (size_t)n * sizeof *b);
    ruga_release(b);
    ruga_release(x);
    ruga_release(r);
    return residual;
}

static void dense_of(const ruga_sparse* a, double* dense) {
    memset(dense, 0, (size_t)a->rows * (size_t)a->rows * sizeof *dense);
    for (int j = 0; j < a->columns; j++) {
        for (int p = a->start[j]; p < a->start[j + 1]; p++) {
            dense[(size_t)j * (size_t)a->rows + (size_t)a->index[p]] = a->value[p];
            dense[(size_t)a->index[p] * (size_t)a->rows + (size_t)j] = a->value[p];
        }
    }
}

// Numbers of positive and negative eigenvalues by LAPACK, and the gap |smallest| / |largest|.
static void dense_inertia(const ruga_sparse* a, int* positive, int* negative, double* gap) {
    int n = a->rows;
    double *dense = NULL, *w = NULL;
    assert_ok(RUGA_NEW(dense, (size_t)n * (size_t)n));
    assert_ok(RUGA_NEW(w, n));
    dense_of(a, dense);
    assert_int_equal(LAPACKE_dsyev(LAPACK_COL_MAJOR, 'N', 'L', n, dense, n, w), 0);
    *positive = *negative = 0;
    double smallest = INFINITY, largest = 0;
    for (int i = 0; i < n; i++) {
        *positive += w[i] > 0;
        *negative += w[i] < 0;
        smallest = fmin(smallest, fabs(w[i]));
        largest = fmax(largest, fabs(w[i]));
    }
    *gap = smallest / largest;
    ruga_release(dense);
    ruga_release(w);
}

static const kkt_def firm = {.side = 60, .spacing = 6, .radius = 6, .shift = 0.05};
static const kkt_def wavy = {.side = 60, .spacing = 6, .radius = 6, .shift = 3};

static void spd_systems_are_solved_to_round_off(void** state) {
    (void)state;
    double* d = NULL;
    assert_ok(RUGA_NEW(d, 400));
    for (int i = 0; i < 400; i++) {
        d[i] = 1 + i % 7;
    }
    for (int k = 0; k < 4; k++) {
        linear_system s;
        ruga_factor_info info;
        if (k < 2) {
            laplacian(&s, 40);
        } else {
            congruence(&s, 400, 1, d, 11);
        }
        ruga_factor* f = factor_of(&s, k % 2 ? RUGA_FACTOR_LDL : RUGA_FACTOR_CHOLESKY, &info);
        assert_true(info.success);
        assert_int_equal(info.positive, s.a.rows);
        assert_int_equal(info.negative + info.zero + info.perturbed, 0);
        assert_true(solve_residual(&s, f) <= 1e-12);
        assert_true(info.entries > s.a.start[s.a.columns] - 1 && info.flops > 0);
        assert_true(ruga_factor_bytes(f) > 8 * (size_t)info.entries);
        ruga_factor_destroy(&f);
        system_clear(&s);
    }
    ruga_release(d);
}

static void not_positive_definite_is_no_error_of_cholesky(void** state) {
    (void)state;
    linear_system s;
    ruga_factor_info info;
    laplacian(&s, 10);
    ruga_factor* f = factor_of(&s, RUGA_FACTOR_CHOLESKY, &info);
    assert_true(info.success);
    double value = s.a.value[s.a.start[150]];
    for (int k = 0; k < 2; k++) { // indefinite, then fine again with the same analysis
        s.a.value[s.a.start[150]] = k ? value : -1;
        assert_ok(ruga_factor_numeric(f, s.a.value, &info));
        assert_int_equal(info.success, k);
        assert_int_equal(info.negative > 0, !k);
    }
    assert_true(solve_residual(&s, f) <= 1e-12);
    ruga_factor_destroy(&f);
    system_clear(&s);
}

static void inertia_is_that_of_the_congruent_diagonal(void** state) {
    (void)state;
    enum { N = 300 };
    double d[N];
    for (int seed = 0; seed < 6; seed++) {
        ruga_random random = {(uint64_t)seed};
        int positive = 0;
        for (int i = 0; i < N; i++) {
            d[i] = (0.1 + ruga_random_uniform(&random)) * (ruga_random_uniform(&random) < 0.6 ? 1 : -1);
            positive += d[i] > 0;
        }
        linear_system s;
        ruga_factor_info info;
        congruence(&s, N, 1 + seed % 3, d, (uint64_t)seed + 100);
        ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
        assert_true(info.success);
        assert_int_equal(info.positive, positive);
        assert_int_equal(info.negative, N - positive);
        assert_true(solve_residual(&s, f) <= 1e-11);
        ruga_factor_destroy(&f);
        system_clear(&s);
    }
}

static void inertia_equals_that_of_dense_eigenvalues(void** state) {
    (void)state;
    for (int trial = 0; trial < 24; trial++) {
        int n = 2 + 12 * trial, positive, negative;
        ruga_random random = {(uint64_t)trial + 5};
        pair_list list = {0};
        for (int k = 0; k < (trial % 4 + 1) * n; k++) {
            push(&list, (int)(ruga_random_uniform(&random) * n), (int)(ruga_random_uniform(&random) * n));
        }
        linear_system s;
        system_create(&s, n, 1, n, list.count, (const int(*)[2])list.pairs);
        for (int j = 0; j < n; j++) { // most diagonal entries are zero: 2 x 2 pivots are needed
            for (int p = s.a.start[j]; p < s.a.start[j + 1]; p++) {
                double value = 2 * ruga_random_uniform(&random) - 1;
                s.a.value[p] = s.a.index[p] == j && j % 5 ? 0 : value;
            }
        }
        double gap;
        dense_inertia(&s.a, &positive, &negative, &gap);
        ruga_factor_info info;
        ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
        assert_int_equal(info.positive + info.negative + info.zero, n);
        if (gap > 1e-10) {
            assert_int_equal(info.positive, positive);
            assert_int_equal(info.negative, negative);
            assert_true(solve_residual(&s, f) <= 1e-11);
        } else {
            assert_true(info.positive <= positive && info.negative <= negative);
        }
        ruga_factor_destroy(&f);
        system_clear(&s);
        ruga_release(list.pairs);
    }
}

// Solution of the KKT system for a load on K alone: the rows of H must stay at zero.
static void check_constraints(const linear_system* s, ruga_factor* f, int vertices) {
    int n = s->a.rows;
    double *b = random_vector(n, 3), *x = random_vector(n, 4), *y = random_vector(n, 5);
    memset(b + 3 * vertices, 0, (size_t)(n - 3 * vertices) * sizeof *b);
    assert_ok(ruga_factor_solve(f, b, x));
    ruga_sparse_multiply_symmetric(&s->a, x, y);
    double size = kkt_weight * norm(3 * vertices, x);
    assert_true(norm(n - 3 * vertices, y + 3 * vertices) <= 1e-12 * size);
    ruga_release(b);
    ruga_release(x);
    ruga_release(y);
}

static void kkt_has_one_negative_pivot_for_each_constraint(void** state) {
    (void)state;
    linear_system s;
    ruga_factor_info info;
    kkt(&s, &firm);
    int vertices = firm.side * firm.side, rows = 3 * kkt_clusters(&firm);
    ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
    assert_true(info.success);
    assert_int_equal(info.positive, 3 * vertices);
    assert_int_equal(info.negative, rows);
    assert_true(solve_residual(&s, f) <= 1e-11);
    check_constraints(&s, f, vertices);
    ruga_factor_destroy(&f);
    system_clear(&s);
}

static void indefinite_kkt_has_more_negative_pivots(void** state) {
    (void)state;
    linear_system s;
    ruga_factor_info info;
    kkt(&s, &wavy);
    int vertices = wavy.side * wavy.side, rows = 3 * kkt_clusters(&wavy);
    ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
    assert_true(info.success);
    assert_int_equal(info.positive + info.negative, s.a.rows);
    assert_true(info.negative > rows);
    assert_true(solve_residual(&s, f) <= 1e-11);
    check_constraints(&s, f, vertices);
    ruga_factor_destroy(&f);
    system_clear(&s);
}

static void kkt_inertia_equals_that_of_dense_eigenvalues(void** state) {
    (void)state;
    const double shifts[] = {0.05, 0.5, 1, 2, 5, 20};
    for (int k = 0; k < 6; k++) {
        kkt_def def = {.side = 14, .spacing = 5, .radius = 4, .shift = shifts[k]};
        linear_system s;
        ruga_factor_info info;
        int positive, negative;
        double gap;
        kkt(&s, &def);
        ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
        double* entries = random_vector(s.a.start[s.a.columns], 1);
        memcpy(entries, s.a.value, (size_t)s.a.start[s.a.columns] * sizeof *entries);
        for (int j = 0; j < 3 * 14 * 14; j++) { // H weighted up: a congruence, which LAPACK resolves better
            for (int p = s.a.start[j]; p < s.a.start[j + 1]; p++) {
                s.a.value[p] *= s.a.index[p] >= 3 * 14 * 14 ? 1e6 : 1;
            }
        }
        dense_inertia(&s.a, &positive, &negative, &gap);
        memcpy(s.a.value, entries, (size_t)s.a.start[s.a.columns] * sizeof *entries);
        assert_true(gap > 1e-12);
        assert_int_equal(info.positive, positive);
        assert_int_equal(info.negative, negative);
        assert_int_equal(info.zero, 0);
        ruga_release(entries);
        ruga_factor_destroy(&f);
        system_clear(&s);
    }
}

static void redundant_constraints_are_zero_pivots(void** state) {
    (void)state;
    kkt_def def = {.side = 30, .spacing = 6, .radius = 6, .shift = 0.05, .repeated = 3};
    linear_system s;
    ruga_factor_info info;
    kkt(&s, &def);
    int vertices = def.side * def.side;
    ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
    assert_false(info.success);
    assert_int_equal(info.zero, 9);
    assert_int_equal(info.perturbed, 9);
    assert_int_equal(info.positive, 3 * vertices);
    assert_int_equal(info.negative, 3 * kkt_clusters(&def));
    check_constraints(&s, f, vertices); // a consistent right side is still solved
    ruga_factor_destroy(&f);
    system_clear(&s);
}

static void zero_rows_are_zero_pivots(void** state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        linear_system s;
        ruga_factor_info info;
        laplacian(&s, 12);
        int n = s.a.rows, wanted = k == 2 ? n : 2;
        for (int j = 0; j < n; j++) {
            for (int p = s.a.start[j]; p < s.a.start[j + 1]; p++) {
                bool zero = k == 2 || j == 7 || j == 200 || s.a.index[p] == 7 || s.a.index[p] == 200;
                s.a.value[p] = zero ? 0 : s.a.value[p];
            }
        }
        ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
        assert_int_equal(info.zero, wanted);
        assert_int_equal(info.positive, n - wanted);
        double* x = random_vector(n, 2);
        assert_ok(ruga_factor_solve(f, x, x));
        assert_true(isfinite(norm(n, x)));
        assert_ok(ruga_factor_solve_absolute(f, x, x));
        assert_true(isfinite(norm(n, x)));
        ruga_release(x);
        ruga_factor_destroy(&f);
        system_clear(&s);
    }
}

// Both triangles, for UMFPACK.
static void full_of(const ruga_sparse* a, int** start, int** index, double** value) {
    int n = a->rows, entries = 2 * a->start[n] - n;
    assert_ok(RUGA_NEW_ZERO(*start, n + 2));
    assert_ok(RUGA_NEW(*index, entries));
    assert_ok(RUGA_NEW(*value, entries));
    int* fill = *start + 1;
    for (int j = 0; j < n; j++) {
        for (int p = a->start[j]; p < a->start[j + 1]; p++) {
            fill[j + 1]++;
            fill[a->index[p] + 1] += a->index[p] != j;
        }
    }
    for (int j = 0; j < n; j++) {
        fill[j + 1] += fill[j];
    }
    for (int j = 0; j < n; j++) { // column j: first the rows above, which are filled in ascending order
        for (int p = a->start[j]; p < a->start[j + 1]; p++) {
            int i = a->index[p];
            (*index)[fill[j]] = i;
            (*value)[fill[j]++] = a->value[p];
            if (i != j) {
                (*index)[fill[i]] = j;
                (*value)[fill[i]++] = a->value[p];
            }
        }
    }
}

static void kkt_solution_equals_that_of_umfpack(void** state) {
    (void)state;
    kkt_def def = {.side = 30, .spacing = 6, .radius = 6, .shift = 3};
    linear_system s;
    ruga_factor_info info;
    kkt(&s, &def);
    int n = s.a.rows, *start, *index;
    double *value, *b = random_vector(n, 1), *x = random_vector(n, 2), *y = random_vector(n, 3);
    void *symbolic, *numeric;
    full_of(&s.a, &start, &index, &value);
    assert_int_equal(umfpack_di_symbolic(n, n, start, index, value, &symbolic, NULL, NULL), UMFPACK_OK);
    assert_int_equal(umfpack_di_numeric(start, index, value, symbolic, &numeric, NULL, NULL), UMFPACK_OK);
    assert_int_equal(umfpack_di_solve(UMFPACK_A, start, index, value, y, b, numeric, NULL, NULL), UMFPACK_OK);
    umfpack_di_free_symbolic(&symbolic);
    umfpack_di_free_numeric(&numeric);
    ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
    assert_ok(ruga_factor_solve(f, b, x));
    int primal = 3 * def.side * def.side;
    for (int k = 0; k < 2; k++) { // displacements and multipliers have different units
        int from = k ? primal : 0, count = k ? n - primal : primal;
        double size = norm(count, y + from);
        cblas_daxpy(count, -1, y + from, 1, x + from, 1);
        assert_true(norm(count, x + from) <= 1e-8 * size);
    }
    ruga_factor_destroy(&f);
    ruga_release(start);
    ruga_release(index);
    ruga_release(value);
    ruga_release(b);
    ruga_release(x);
    ruga_release(y);
    system_clear(&s);
}

typedef struct operators {
    const linear_system* s;
    ruga_factor* f;
} operators;

static ruga_status apply_matrix(const double* x, double* y, void* context) {
    ruga_sparse_multiply_symmetric(&((operators*)context)->s->a, x, y);
    return RUGA_OK;
}

static ruga_status apply_absolute(const double* x, double* y, void* context) {
    return ruga_factor_solve_absolute(((operators*)context)->f, x, y);
}

static void absolute_factor_is_spd_and_perfect_for_minres(void** state) {
    (void)state;
    kkt_def defs[2] = {{.side = 24, .spacing = 6, .radius = 5, .shift = 0.05},
                       {.side = 24, .spacing = 6, .radius = 5, .shift = 3}};
    for (int k = 0; k < 2; k++) {
        linear_system s;
        ruga_factor_info info;
        kkt(&s, &defs[k]);
        int n = s.a.rows;
        ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
        double *x = random_vector(n, 1), *y = random_vector(n, 2), *px = random_vector(n, 3);
        double* py = random_vector(n, 4);
        assert_ok(ruga_factor_solve_absolute(f, x, px));
        assert_ok(ruga_factor_solve_absolute(f, y, py));
        double xpx = cblas_ddot(n, x, 1, px, 1), ypy = cblas_ddot(n, y, 1, py, 1);
        assert_true(xpx > 0 && ypy > 0);
        assert_near(cblas_ddot(n, x, 1, py, 1), cblas_ddot(n, y, 1, px, 1), 1e-9 * sqrt(xpx * ypy));
        operators context = {&s, f};
        ruga_minres_report report;
        memset(px, 0, (size_t)n * sizeof *px);
        memset(x + 3 * 24 * 24, 0, (size_t)(n - 3 * 24 * 24) * sizeof *x);
        assert_ok(ruga_belos_minres(n, apply_matrix, apply_absolute, &context, x, px, 1e-7, 50, &report));
        assert_true(report.converged && report.iterations <= 3);
        ruga_release(x);
        ruga_release(y);
        ruga_release(px);
        ruga_release(py);
        ruga_factor_destroy(&f);
        system_clear(&s);
    }
}

// One front of n dense columns with an indefinite diagonal.
static void dense_system(linear_system* s, int n) {
    pair_list list = {0};
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < j; i++) {
            push(&list, i, j);
        }
    }
    system_create(s, n, 1, n, list.count, (const int(*)[2])list.pairs);
    ruga_random random = {17};
    for (int p = 0; p < s->a.start[n]; p++) {
        s->a.value[p] = 2 * ruga_random_uniform(&random) - 1;
    }
    ruga_release(list.pairs);
}

typedef ruga_status numeric(ruga_factor* factor, const double* values, ruga_factor_info* info);

static void bits_do_not_depend_on_threads_or_repetition(void** state) {
    (void)state;
    for (int trial = 0; trial < 6; trial++) { // with small and large fronts, in each precision
        numeric* const factorise = trial < 4 ? ruga_factor_numeric : ruga_factor_numeric_single;
        const ruga_factor_kind kind = trial < 2 ? RUGA_FACTOR_LDL : RUGA_FACTOR_LDL_SINGLE;
        linear_system s;
        ruga_factor_info info;
        if (trial % 2) {
            dense_system(&s, 500);
        } else {
            kkt(&s, &wavy);
        }
        int n = s.a.rows;
        double *b = random_vector(n, 1), *first = random_vector(2 * n, 2), *x = random_vector(2 * n, 3);
        for (int k = 0; k < 4; k++) {
            ruga_set_threads(1 + k % 2);
            ruga_factor* f = factor_of(&s, kind, &info);
            assert_ok(factorise(f, s.a.value, &info));
            assert_ok(ruga_factor_solve(f, b, k ? x : first));
            assert_ok(ruga_factor_solve_rough(f, b, (k ? x : first) + n));
            for (int again = 0; k && again < 2; again++) {
                assert_memory_equal(x, first, 2 * (size_t)n * sizeof *x);
                assert_ok(factorise(f, s.a.value, &info));
                assert_ok(ruga_factor_solve(f, b, x));
                assert_ok(ruga_factor_solve_rough(f, b, x + n));
            }
            ruga_factor_destroy(&f);
        }
        ruga_release(b);
        ruga_release(first);
        ruga_release(x);
        system_clear(&s);
    }
    ruga_set_threads(0);
}

static void dense_front_is_solved_with_the_inertia_of_its_eigenvalues(void** state) {
    (void)state;
    linear_system s;
    ruga_factor_info info;
    int positive, negative;
    double gap;
    dense_system(&s, 300);
    ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &info);
    dense_inertia(&s.a, &positive, &negative, &gap);
    assert_true(gap > 1e-8);
    assert_int_equal(info.positive, positive);
    assert_int_equal(info.negative, negative);
    assert_true(solve_residual(&s, f) <= 1e-11);
    ruga_factor_destroy(&f);
    system_clear(&s);
}

static void factors_in_single_precision_are_refined_to_round_off(void** state) {
    (void)state;
    const kkt_def* const defs[2] = {&firm, &wavy};
    for (int trial = 0; trial < 4; trial++) {
        const kkt_def* def = defs[trial % 2];
        linear_system s;
        ruga_factor_info info, in_double;
        kkt(&s, def);
        ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL, &in_double);
        size_t bytes = ruga_factor_bytes(f);
        ruga_factor_destroy(&f);
        f = factor_of(&s, RUGA_FACTOR_LDL_SINGLE, &info);
        if (trial >= 2) {
            assert_ok(ruga_factor_numeric_single(f, s.a.value, &info));
        }
        assert_true(info.success);
        assert_int_equal(info.positive, in_double.positive);
        assert_int_equal(info.negative, in_double.negative);
        assert_true(solve_residual(&s, f) <= 1e-11);
        check_constraints(&s, f, def->side * def->side);
        assert_true(ruga_factor_bytes(f) < bytes - 3 * (size_t)info.entries);
        ruga_factor_destroy(&f);
        system_clear(&s);
    }
}

// Springs that hardly anything holds in space: what is left to the last pivots is round-off in single precision.
static void what_single_precision_cannot_tell_is_said(void** state) {
    (void)state;
    linear_system s;
    ruga_factor_info info;
    laplacian(&s, 20);
    for (int j = 0; j < s.a.columns; j++) {
        s.a.value[s.a.start[j]] -= 0.1 - 1e-9;
    }
    ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL_SINGLE, &info);
    assert_true(info.success);
    assert_int_equal(info.positive, s.a.columns);
    assert_ok(ruga_factor_numeric_single(f, s.a.value, &info));
    assert_false(info.success);
    assert_int_equal(info.zero, 3);
    ruga_factor_destroy(&f);
    system_clear(&s);
}

// The same closer and closer to being singular, from both sides: single precision proves the inertia while it can, and
// never a wrong one.
static void an_inertia_is_proven_only_where_it_is_right(void** state) {
    (void)state;
    linear_system s;
    ruga_factor_info info, in_double;
    bool proven;
    int proofs = 0, wrong = 0;
    laplacian(&s, 20);
    ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL_SINGLE, &info);
    double* diagonal = random_vector(s.a.columns, 1);
    for (int j = 0; j < s.a.columns; j++) {
        diagonal[j] = s.a.value[s.a.start[j]];
    }
    for (int k = 0; k < 48; k++) {
        double least = (k % 2 ? -1 : 1) * pow(10, -1 - k / 4.0);
        for (int j = 0; j < s.a.columns; j++) {
            s.a.value[s.a.start[j]] = diagonal[j] - 0.1 + least;
        }
        assert_ok(ruga_factor_numeric(f, s.a.value, &in_double));
        assert_ok(ruga_factor_prove_inertia(f, &proven));
        assert_true(proven);
        assert_ok(ruga_factor_numeric_single(f, s.a.value, &info));
        assert_ok(ruga_factor_prove_inertia(f, &proven));
        assert_true(!proven || (info.negative == in_double.negative && info.zero == 0));
        assert_true(proven || fabs(least) < 1e-4);
        proofs += proven;
        wrong += info.negative != in_double.negative;
    }
    print_message("%d of 48 proven, %d wrong in single precision\n", proofs, wrong);
    assert_true(wrong > 0);
    ruga_release(diagonal);
    ruga_factor_destroy(&f);
    system_clear(&s);
}

static void rough_solve_is_symmetric_and_near_the_solution(void** state) {
    (void)state;
    linear_system s;
    ruga_factor_info info;
    kkt(&s, &firm);
    int n = s.a.rows, primal = 3 * firm.side * firm.side;
    ruga_factor* f = factor_of(&s, RUGA_FACTOR_LDL_SINGLE, &info);
    double *b = random_vector(n, 1), *c = random_vector(n, 2), *x = random_vector(n, 3), *y = random_vector(n, 4);
    memset(b + primal, 0, (size_t)(n - primal) * sizeof *b);
    memset(c + primal, 0, (size_t)(n - primal) * sizeof *c);
    assert_ok(ruga_factor_solve_rough(f, b, x));
    assert_ok(ruga_factor_solve_rough(f, c, y));
    double size = sqrt(cblas_ddot(n, b, 1, x, 1) * cblas_ddot(n, c, 1, y, 1)); // positive on the null space of H
    assert_near(cblas_ddot(n, c, 1, x, 1), cblas_ddot(n, b, 1, y, 1), 1e-9 * size);
    assert_ok(ruga_factor_solve(f, b, y));
    size = norm(primal, y);
    cblas_daxpy(primal, -1, x, 1, y, 1);
    assert_true(norm(primal, y) <= 1e-2 * size && norm(primal, y) > 0);
    ruga_factor_destroy(&f);
    ruga_release(b);
    ruga_release(c);
    ruga_release(x);
    ruga_release(y);
    system_clear(&s);
}

static void tiny_and_odd_patterns_are_solved(void** state) {
    (void)state;
    const int dense[][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}, apart[][2] = {{0, 1}, {2, 3}};
    const struct {
        int nodes, pair_count;
        const int (*pairs)[2];
    } cases[] = {{0, 0, NULL}, {1, 0, NULL}, {100, 0, NULL}, {4, 6, dense}, {4, 2, apart}};
    for (int k = 0; k < 10; k++) {
        linear_system s;
        ruga_factor_info info;
        system_create(&s, cases[k / 2].nodes, 1, cases[k / 2].nodes, cases[k / 2].pair_count,
                      cases[k / 2].pairs);
        for (int j = 0; j < s.nodes; j++) {
            for (int p = s.a.start[j]; p < s.a.start[j + 1]; p++) {
                s.a.value[p] = s.a.index[p] == j ? 4 + j : 1;
            }
        }
        ruga_factor* f = factor_of(&s, k % 2 ? RUGA_FACTOR_LDL : RUGA_FACTOR_CHOLESKY, &info);
        assert_true(info.success);
        assert_int_equal(info.positive, s.nodes);
        if (s.nodes > 0) {
            assert_true(solve_residual(&s, f) <= 1e-15);
        }
        ruga_factor_destroy(&f);
        system_clear(&s);
    }
}

static void values_that_are_not_finite_are_refused(void** state) {
    (void)state;
    linear_system s;
    ruga_factor_info info;
    laplacian(&s, 5);
    for (int kind = 0; kind < 2; kind++) {
        ruga_factor* f = factor_of(&s, kind ? RUGA_FACTOR_LDL : RUGA_FACTOR_CHOLESKY, &info);
        double old = s.a.value[40];
        s.a.value[40] = NAN;
        assert_status(ruga_factor_numeric(f, s.a.value, &info), RUGA_BAD_INPUT);
        s.a.value[40] = old;
        ruga_factor_destroy(&f);
    }
    system_clear(&s);
}

static void kth_failed_allocation_is_reported(void** state) {
    (void)state;
    kkt_def def = {.side = 12, .spacing = 6, .radius = 5, .shift = 3};
    size_t before = ruga_byte_count();
    linear_system s;
    ruga_set_threads(1);
    let_allocations_fail_after(INT32_MAX);
    kkt(&s, &def);
    for (int kind = RUGA_FACTOR_CHOLESKY; kind <= RUGA_FACTOR_LDL_SINGLE; kind++) {
        ruga_status status = RUGA_NO_MEMORY;
        for (int k = 0; status != RUGA_OK; k++) {
            ruga_factor* f = NULL;
            ruga_factor_info info;
            allocations_left = k;
            status = ruga_factor_create((ruga_factor_kind)kind, &s.a, s.nodes, s.node_start, s.last, &f);
            if (status == RUGA_OK) {
                status = ruga_factor_numeric(f, s.a.value, &info);
            } else {
                assert_null(f);
            }
            assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
            ruga_factor_destroy(&f);
        }
    }
    system_clear(&s);
    ruga_set_allocator(NULL, NULL, NULL);
    ruga_set_threads(0);
    assert_int_equal(ruga_byte_count(), before);
}

static void nothing_is_allocated_after_the_first_factorisation(void** state) {
    (void)state;
    linear_system s;
    ruga_factor_info info;
    let_allocations_fail_after(INT32_MAX);
    kkt(&s, &wavy);
    double* x = random_vector(s.a.rows, 1);
    for (int kind = RUGA_FACTOR_LDL; kind <= RUGA_FACTOR_LDL_SINGLE; kind++) {
        allocations_left = INT32_MAX;
        ruga_factor* f = factor_of(&s, (ruga_factor_kind)kind, &info);
        allocations_left = 0;
        if (kind == RUGA_FACTOR_LDL_SINGLE) {
            assert_ok(ruga_factor_numeric_single(f, s.a.value, &info));
            assert_ok(ruga_factor_solve_rough(f, x, x));
        }
        assert_ok(ruga_factor_numeric(f, s.a.value, &info));
        assert_ok(ruga_factor_solve(f, x, x));
        assert_ok(ruga_factor_solve_absolute(f, x, x));
        ruga_factor_destroy(&f);
    }
    ruga_release(x);
    system_clear(&s);
    ruga_set_allocator(NULL, NULL, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spd_systems_are_solved_to_round_off),
        cmocka_unit_test(not_positive_definite_is_no_error_of_cholesky),
        cmocka_unit_test(inertia_is_that_of_the_congruent_diagonal),
        cmocka_unit_test(inertia_equals_that_of_dense_eigenvalues),
        cmocka_unit_test(kkt_has_one_negative_pivot_for_each_constraint),
        cmocka_unit_test(indefinite_kkt_has_more_negative_pivots),
        cmocka_unit_test(kkt_inertia_equals_that_of_dense_eigenvalues),
        cmocka_unit_test(redundant_constraints_are_zero_pivots),
        cmocka_unit_test(zero_rows_are_zero_pivots),
        cmocka_unit_test(kkt_solution_equals_that_of_umfpack),
        cmocka_unit_test(absolute_factor_is_spd_and_perfect_for_minres),
        cmocka_unit_test(bits_do_not_depend_on_threads_or_repetition),
        cmocka_unit_test(dense_front_is_solved_with_the_inertia_of_its_eigenvalues),
        cmocka_unit_test(factors_in_single_precision_are_refined_to_round_off),
        cmocka_unit_test(what_single_precision_cannot_tell_is_said),
        cmocka_unit_test(an_inertia_is_proven_only_where_it_is_right),
        cmocka_unit_test(rough_solve_is_symmetric_and_near_the_solution),
        cmocka_unit_test(tiny_and_odd_patterns_are_solved),
        cmocka_unit_test(values_that_are_not_finite_are_refused),
        cmocka_unit_test(kth_failed_allocation_is_reported),
        cmocka_unit_test(nothing_is_allocated_after_the_first_factorisation),
    };
    return cmocka_run_group_tests_name("linear", tests, NULL, check_no_leak);
}
