// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "core/random.h"
#include "core/sparse.h"
#include "solver/belos_shim.h"
#include "solver/linear.h"

#include <stdlib.h>
#include <string.h>

enum { N = 400 };

// A chain of springs with ends held; `shift` makes it indefinite. Applied without a matrix.
typedef struct chain {
    double shift;
    double preconditioner_scale;
    int fail_at, calls; // the call that fails; 0 = none
} chain;

static ruga_status apply_chain(const double* x, double* y, void* context) {
    chain* c = context;
    if (++c->calls == c->fail_at) {
        return ruga_fail(RUGA_CANCELLED, "stopped by the test");
    }
    for (int i = 0; i < N; i++) {
        double left = i > 0 ? x[i - 1] : 0, right = i + 1 < N ? x[i + 1] : 0;
        y[i] = (2 + (i % 3) - c->shift) * x[i] - left - right;
    }
    return RUGA_OK;
}

static ruga_status apply_jacobi(const double* x, double* y, void* context) {
    const chain* c = context;
    for (int i = 0; i < N; i++) {
        y[i] = c->preconditioner_scale * x[i] / (2 + (i % 3));
    }
    return RUGA_OK;
}

static ruga_status apply_failing(const double* x, double* y, void* context) {
    (void)x;
    (void)y;
    (void)context;
    return ruga_fail(RUGA_IO, "no preconditioner today");
}

static void load_of(double b[N]) {
    ruga_random random = {3};
    for (int i = 0; i < N; i++) {
        b[i] = 2 * ruga_random_uniform(&random) - 1;
    }
}

static double residual_of(chain* c, const double b[N], const double x[N]) {
    double y[N], sum = 0;
    assert_ok(apply_chain(x, y, c));
    for (int i = 0; i < N; i++) {
        sum += (b[i] - y[i]) * (b[i] - y[i]);
    }
    return sqrt(sum);
}

// The chain as a matrix, solved directly.
static void solve_directly(const chain* c, const double b[N], double x[N]) {
    int pairs[N - 1][2];
    ruga_sparse a;
    ruga_factor* f = NULL;
    ruga_factor_info info;
    for (int i = 0; i + 1 < N; i++) {
        pairs[i][0] = i;
        pairs[i][1] = i + 1;
    }
    assert_ok(ruga_sparse_from_pairs(N, 1, N - 1, (const int(*)[2])pairs, &a));
    for (int j = 0; j < N; j++) {
        a.value[a.start[j]] = 2 + (j % 3) - c->shift;
        for (int p = a.start[j] + 1; p < a.start[j + 1]; p++) {
            a.value[p] = -1;
        }
    }
    assert_ok(ruga_factor_create(RUGA_FACTOR_LDL, &a, 0, NULL, NULL, &f));
    assert_ok(ruga_factor_numeric(f, a.value, &info));
    assert_ok(ruga_factor_solve(f, b, x));
    ruga_factor_destroy(&f);
    ruga_sparse_clear(&a);
}

static void solution_equals_the_direct_one(void** state) {
    (void)state;
    double b[N], x[N], direct[N];
    load_of(b);
    for (int k = 0; k < 4; k++) {
        chain c = {.shift = k % 2 ? 1.5 : 0, .preconditioner_scale = 1};
        ruga_minres_report report;
        memset(x, 0, sizeof x);
        assert_ok(
            ruga_belos_minres(N, apply_chain, k < 2 ? NULL : apply_jacobi, &c, b, x, 1e-11, 2000, &report));
        assert_true(report.converged);
        assert_true(report.iterations > 3 && report.iterations <= 2 * N);
        solve_directly(&c, b, direct);
        for (int i = 0; i < N; i++) {
            assert_near(x[i], direct[i], 1e-7);
        }
    }
}

static void scale_of_the_preconditioner_changes_nothing(void** state) {
    (void)state;
    double b[N], x[N];
    int iterations[3];
    load_of(b);
    for (int k = 0; k < 3; k++) {
        chain c = {.shift = 0.5, .preconditioner_scale = k == 0 ? 1 : k == 1 ? 1e6 : 1e-6};
        ruga_minres_report report;
        memset(x, 0, sizeof x);
        assert_ok(ruga_belos_minres(N, apply_chain, apply_jacobi, &c, b, x, 1e-8, 2000, &report));
        assert_true(report.converged);
        iterations[k] = report.iterations;
    }
    assert_int_equal(iterations[0], iterations[1]);
    assert_int_equal(iterations[0], iterations[2]);
}

static void report_is_the_true_residual(void** state) {
    (void)state;
    double b[N], x[N];
    load_of(b);
    for (int iterations = 0; iterations < 30; iterations += 7) {
        chain c = {.shift = 0.5};
        ruga_minres_report report;
        for (int i = 0; i < N; i++) {
            x[i] = 0.1;
        }
        double start = residual_of(&c, b, x);
        assert_ok(ruga_belos_minres(N, apply_chain, NULL, &c, b, x, 1e-12, iterations, &report));
        assert_false(report.converged); // an unmet tolerance is no error
        assert_int_equal(report.iterations, iterations);
        assert_near(report.residual, residual_of(&c, b, x) / start, 1e-14);
    }
}

static void exact_start_returns_at_once(void** state) {
    (void)state;
    double b[N], x[N], kept[N];
    chain c = {.shift = 0.5};
    ruga_minres_report report;
    for (int i = 0; i < N; i++) {
        x[i] = kept[i] = i % 5;
    }
    assert_ok(apply_chain(x, b, &c));
    assert_ok(ruga_belos_minres(N, apply_chain, NULL, &c, b, x, 1e-8, 100, &report));
    assert_true(report.converged);
    assert_int_equal(report.iterations, 0);
    assert_memory_equal(x, kept, sizeof x);
    memset(b, 0, sizeof b);
    memset(x, 0, sizeof x);
    assert_ok(ruga_belos_minres(N, apply_chain, NULL, &c, b, x, 1e-8, 100, &report));
    assert_true(report.converged && report.iterations == 0);
}

static void invariant_subspace_is_survived(void** state) {
    (void)state;
    double b[N] = {0}, x[N] = {0}, e[N];
    chain c = {.shift = 0};
    ruga_minres_report report;
    load_of(e);
    for (int i = 0; i < N; i++) { // b of two entries far apart, tolerance that round-off cannot meet
        b[i] = i == 0 || i == N - 1 ? 1 : 0;
    }
    assert_ok(ruga_belos_minres(N, apply_chain, NULL, &c, b, x, 0, 3 * N, &report));
    assert_false(report.converged);
    assert_true(report.residual < 1e-12);
    assert_true(isfinite(residual_of(&c, b, x)));
}

static void status_of_a_callback_is_handed_back(void** state) {
    (void)state;
    double b[N], x[N] = {0};
    ruga_minres_report report;
    load_of(b);
    for (int call = 1; call < 8; call++) {
        chain c = {.fail_at = call};
        assert_status(ruga_belos_minres(N, apply_chain, NULL, &c, b, x, 1e-8, 100, &report), RUGA_CANCELLED);
        assert_string_equal(ruga_last_error(), "stopped by the test");
    }
    chain c = {0};
    assert_status(ruga_belos_minres(N, apply_chain, apply_failing, &c, b, x, 1e-8, 100, &report), RUGA_IO);
}

static void bad_numbers_are_refused(void** state) {
    (void)state;
    double b[N], x[N] = {0};
    ruga_minres_report report;
    load_of(b);
    chain c = {.shift = 0, .preconditioner_scale = -1};
    assert_status(ruga_belos_minres(N, apply_chain, apply_jacobi, &c, b, x, 1e-8, 100, &report),
                  RUGA_LIBRARY);
    b[3] = NAN;
    assert_status(ruga_belos_minres(N, apply_chain, NULL, &c, b, x, 1e-8, 100, &report), RUGA_BAD_INPUT);
}

static void kth_failed_allocation_is_reported(void** state) {
    (void)state;
    double b[N], x[N];
    ruga_status status = RUGA_NO_MEMORY;
    load_of(b);
    ruga_set_allocator(allocate_some, free_some, NULL);
    for (int k = 0; status != RUGA_OK; k++) {
        chain c = {.shift = 0.5, .preconditioner_scale = 1};
        ruga_minres_report report;
        memset(x, 0, sizeof x);
        allocations_left = k;
        status = ruga_belos_minres(N, apply_chain, apply_jacobi, &c, b, x, 1e-8, 8, &report);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        assert_int_equal(ruga_byte_count(), 0);
    }
    ruga_set_allocator(NULL, NULL, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solution_equals_the_direct_one),
        cmocka_unit_test(scale_of_the_preconditioner_changes_nothing),
        cmocka_unit_test(report_is_the_true_residual),
        cmocka_unit_test(exact_start_returns_at_once),
        cmocka_unit_test(invariant_subspace_is_survived),
        cmocka_unit_test(status_of_a_callback_is_handed_back),
        cmocka_unit_test(bad_numbers_are_refused),
        cmocka_unit_test(kth_failed_allocation_is_reported),
    };
    return cmocka_run_group_tests_name("belos", tests, NULL, check_no_leak);
}
