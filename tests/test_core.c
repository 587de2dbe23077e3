// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/lanes.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/sparse.h"
#include "ruga/ruga.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void error_sentence_is_kept_and_prefixed(void** state) {
    (void)state;
    assert_int_equal(ruga_fail(RUGA_IO, "no file %s", "a.obj"), RUGA_IO);
    assert_int_equal(ruga_fail_prefix(RUGA_IO, "scene.yaml:%d", 3), RUGA_IO);
    assert_string_equal(ruga_last_error(), "scene.yaml:3: no file a.obj");
}

static void byte_count_returns_to_zero(void** state) {
    (void)state;
    double* a = NULL;
    assert_ok(RUGA_NEW_ZERO(a, 1000));
    assert_int_equal(ruga_byte_count(), 8000);
    a = ruga_reallocate(a, 80000);
    assert_non_null(a);
    assert_true(a[999] == 0);
    ruga_release(a);
    assert_int_equal(ruga_byte_count(), 0);
}

static void* allocate_nothing(size_t size, void* context) {
    (void)size;
    (void)context;
    return NULL;
}

static void failed_allocation_is_a_status(void** state) {
    (void)state;
    ruga_set_allocator(allocate_nothing, NULL, NULL);
    double* a = NULL;
    assert_status(RUGA_NEW(a, 10), RUGA_NO_MEMORY);
    ruga_set_allocator(NULL, NULL, NULL);
    assert_status(RUGA_NEW(a, SIZE_MAX), RUGA_NO_MEMORY);
}

static void square_indices(int begin, int end, int chunk, void* context) {
    (void)chunk;
    int* squares = context;
    for (int i = begin; i < end; i++) {
        squares[i] = i * i;
    }
}

// Each index calls for a range of its own, from inside a chunk.
static void square_rows(int begin, int end, int chunk, void* context) {
    (void)chunk;
    for (int i = begin; i < end; i++) {
        ruga_parallel_for(10, 3, square_indices, (int*)context + 10 * (size_t)i);
    }
}

static void parallel_for_inside_a_chunk_covers_its_range_once(void** state) {
    (void)state;
    int squares[1000];
    ruga_set_threads(3);
    for (int again = 0; again < 200; again++) {
        memset(squares, 0, sizeof squares);
        ruga_parallel_for(100, 1, square_rows, squares);
        for (int i = 0; i < 1000; i++) {
            assert_int_equal(squares[i], (i % 10) * (i % 10));
        }
    }
    ruga_set_threads(0);
}

static void parallel_for_covers_the_range_once(void** state) {
    (void)state;
    int squares[1000];
    for (int threads = 1; threads <= 4; threads++) {
        memset(squares, 0, sizeof squares);
        ruga_set_threads(threads);
        ruga_parallel_for(1000, 7, square_indices, squares);
        for (int i = 0; i < 1000; i++) {
            assert_int_equal(squares[i], i * i);
        }
    }
    ruga_set_threads(0);
}

static void pattern_from_pairs_is_sorted_without_repeats(void** state) {
    (void)state;
    const int pairs[][2] = {{0, 2}, {2, 0}, {1, 1}, {3, 1}, {2, 3}};
    ruga_sparse a;
    assert_ok(ruga_sparse_from_pairs(4, 2, 5, pairs, &a));
    assert_int_equal(a.rows, 8);
    for (int j = 0; j < 8; j++) {
        assert_int_equal(a.index[a.start[j]], j);
        for (int k = a.start[j] + 1; k < a.start[j + 1]; k++) {
            assert_true(a.index[k] > a.index[k - 1]);
        }
    }
    assert_true(ruga_sparse_find(&a, 5, 1) >= 0);
    assert_true(ruga_sparse_find(&a, 3, 1) < 0);
    assert_int_equal(a.start[8], 4 * 3 + 3 * 4);
    ruga_sparse_clear(&a);
}

static void symmetric_product_equals_dense(void** state) {
    (void)state;
    const int pairs[][2] = {{0, 1}, {1, 2}};
    ruga_sparse a;
    assert_ok(ruga_sparse_from_pairs(3, 1, 2, pairs, &a));
    const double values[] = {4, -1, 5, -2, 6}; // (0,0) (1,0) (1,1) (2,1) (2,2)
    memcpy(a.value, values, sizeof values);
    const double x[3] = {1, 2, 3};
    double y[3];
    ruga_sparse_multiply_symmetric(&a, x, y);
    assert_near(y[0], 2, 0);
    assert_near(y[1], 3, 0);
    assert_near(y[2], 14, 0);
    ruga_sparse_clear(&a);
}

static double signed_size(ruga_random* random, double decades) {
    double size = pow(10, -decades * ruga_random_uniform(random));
    return ruga_random_uniform(random) < 0.5 ? -size : size;
}

static void angles_are_those_of_atan2(void** state) {
    (void)state;
    ruga_random random = {5};
    double y[RUGA_LANES], x[RUGA_LANES], angle[RUGA_LANES];
    for (int k = 0; k < 3000; k++) {
        for (int i = 0; i < RUGA_LANES; i++) {
            y[i] = signed_size(&random, k % 3);
            x[i] = signed_size(&random, k % 60);
        }
        ruga_lanes_angle(RUGA_LANES, y, x, angle);
        for (int i = 0; i < RUGA_LANES; i++) {
            double wanted = atan2(y[i], x[i]);
            assert_near(angle[i], wanted, 6e-16 * fabs(wanted)); // 1.1e-16 of it are atan2's
        }
    }
    const double edge_y[] = {0, 0, 1, -1, 0, 1, 1, -1, 1e-310, HUGE_VAL, 1};
    const double edge_x[] = {1, -1, 0, 0, 0, 1, -1, -1, 1e-300, HUGE_VAL, HUGE_VAL};
    enum { EDGES = sizeof edge_x / sizeof edge_x[0] };
    ruga_lanes_angle(EDGES, edge_y, edge_x, angle);
    for (int i = 0; i < EDGES; i++) {
        assert_near(angle[i], atan2(edge_y[i], edge_x[i]),
                    6e-16 * fabs(atan2(edge_y[i], edge_x[i])) + 1e-300);
    }
    ruga_lanes_angle(2, (const double[2]){NAN, 1}, (const double[2]){1, NAN}, angle);
    assert_true(isnan(angle[0]) && isnan(angle[1]));
}

static void powers_are_those_of_pow(void** state) {
    (void)state;
    ruga_random random = {6};
    double value[RUGA_LANES], result[RUGA_LANES];
    for (int k = 0; k < 3000; k++) {
        double power = 2 * ruga_random_uniform(&random) - 1;
        for (int i = 0; i < RUGA_LANES; i++) {
            value[i] = k % 2 ? 0.5 + ruga_random_uniform(&random) : fabs(signed_size(&random, k % 300));
        }
        ruga_lanes_power(RUGA_LANES, value, power, result);
        for (int i = 0; i < RUGA_LANES; i++) {
            double wanted = pow(value[i], power);
            assert_near(result[i], wanted, 4e-16 * (1 + fabs(log(wanted))) * wanted);
        }
    }
    ruga_lanes_power(2, (const double[2]){1, 7}, 0, result);
    assert_true(result[0] == 1 && result[1] == 1);
    ruga_lanes_power(1, (const double[1]){1}, 0.7, result);
    assert_true(result[0] == 1);
}

static void lanes_do_not_know_one_another(void** state) {
    (void)state;
    ruga_random random = {7};
    double y[RUGA_LANES], x[RUGA_LANES], angle[RUGA_LANES], power[RUGA_LANES], one;
    for (int i = 0; i < RUGA_LANES; i++) {
        y[i] = signed_size(&random, 3);
        x[i] = signed_size(&random, 3);
    }
    for (int count = 1; count <= RUGA_LANES; count++) {
        ruga_lanes_angle(count, y, x, angle);
        for (int i = 0; i < count; i++) {
            power[i] = fabs(y[i]);
        }
        double result[RUGA_LANES];
        ruga_lanes_power(count, power, -0.4, result);
        for (int i = 0; i < count; i++) {
            ruga_lanes_angle(1, y + i, x + i, &one);
            assert_true(angle[i] == one);
            ruga_lanes_power(1, power + i, -0.4, &one);
            assert_true(result[i] == one);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(error_sentence_is_kept_and_prefixed),
        cmocka_unit_test(byte_count_returns_to_zero),
        cmocka_unit_test(failed_allocation_is_a_status),
        cmocka_unit_test(parallel_for_covers_the_range_once),
        cmocka_unit_test(parallel_for_inside_a_chunk_covers_its_range_once),
        cmocka_unit_test(pattern_from_pairs_is_sorted_without_repeats),
        cmocka_unit_test(symmetric_product_equals_dense),
        cmocka_unit_test(angles_are_those_of_atan2),
        cmocka_unit_test(powers_are_those_of_pow),
        cmocka_unit_test(lanes_do_not_know_one_another),
    };
    return cmocka_run_group_tests_name("core", tests, NULL, check_no_leak);
}
