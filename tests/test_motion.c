// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/vec3.h"
#include "lattice/motion.h"
#include "tests/box_lattice.h"

#include <string.h>

static const double CENTER[3] = {0.7, 0.4, -0.3};

static ruga_keyframe_def keyframe(double time) {
    return (ruga_keyframe_def){
        .time = time, .matrix = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .bump_direction = {0, 0, 1}};
}

// Position of rest point x of element 0's cell under node positions q.
static void position(const ruga_lattice* lattice, int element, const double* q, const double xi[3],
                     double x[3]) {
    double weight[RUGA_LATTICE_NODES_MAX];
    int npe = lattice->nodes_per_element;
    ruga_lattice_shape(lattice, xi, weight, NULL);
    x[0] = x[1] = x[2] = 0;
    for (int a = 0; a < npe; a++) {
        ruga_add_scaled(weight[a], &q[3 * lattice->element_node[element * npe + a]], x);
    }
}

static double* motion(const ruga_lattice* lattice, int count, const ruga_keyframe_def* keys, double time) {
    double* q = NULL;
    assert_ok(RUGA_NEW(q, lattice->node_count * 3));
    ruga_motion_at(lattice, CENTER, count, keys, time, q);
    return q;
}

static void affine_motion_is_exact_and_linear_between_keyframes(void** state) {
    (void)state;
    const double a[9] = {0.9, 0.1, 0, 0, 1.2, 0, -0.1, 0, 1}, t[3] = {0.5, -1, 2};
    ruga_keyframe_def keys[2] = {keyframe(1), keyframe(3)};
    memcpy(keys[1].matrix, a, sizeof a);
    memcpy(keys[1].translate, t, sizeof t);
    for (int degree = 1; degree <= 2; degree++) {
        ruga_lattice lattice;
        box_lattice(degree, 3, 2, 2, 0, &lattice);
        for (double s = 0; s <= 1; s += 0.25) {
            double* q = motion(&lattice, 2, keys, 1 + 2 * s);
            ruga_random random = {1};
            for (int e = 0; e < lattice.element_count; e++) {
                double xi[3], rest[3], now[3];
                for (int i = 0; i < 3; i++) {
                    xi[i] = ruga_random_uniform(&random);
                }
                position(&lattice, e, q, xi, now);
                for (int i = 0; i < 3; i++) {
                    rest[i] =
                        lattice.origin[i] + (lattice.element_cell[3 * e + i] + xi[i]) * lattice.cell_size[i];
                }
                for (int i = 0; i < 3; i++) {
                    double wanted = CENTER[i] + s * t[i];
                    for (int j = 0; j < 3; j++) {
                        wanted += ((1 - s) * (i == j) + s * a[3 * i + j]) * (rest[j] - CENTER[j]);
                    }
                    assert_near(now[i], wanted, 1e-13);
                }
            }
            ruga_release(q);
        }
        ruga_lattice_clear(&lattice);
    }
}

static void motion_is_held_before_and_after_the_keyframes(void** state) {
    (void)state;
    ruga_lattice lattice;
    box_lattice(2, 2, 1, 1, 0, &lattice);
    ruga_keyframe_def keys[3] = {keyframe(1), keyframe(2), keyframe(4)};
    keys[0].matrix[0] = 0.8;
    keys[2].translate[1] = 3;
    keys[2].has_bump = true;
    keys[2].bump_depth = 0.2;
    keys[2].bump_radius = 0.5;
    const double times[][2] = {{-5, 1}, {0.999, 1}, {4, 100}, {4.001, 4}};
    for (int k = 0; k < 4; k++) {
        double *a = motion(&lattice, 3, keys, times[k][0]), *b = motion(&lattice, 3, keys, times[k][1]);
        assert_memory_equal(a, b, (size_t)lattice.node_count * 3 * sizeof *a);
        ruga_release(a);
        ruga_release(b);
    }
    double* none = motion(&lattice, 0, NULL, 1);
    for (int i = 0; i < 3 * lattice.node_count; i++) {
        assert_near(none[i], lattice.rest[i], 1e-15);
    }
    ruga_release(none);
    ruga_lattice_clear(&lattice);
}

// A very wide bump is its own Taylor polynomial: depth (1 - r^2 / (2 R^2)) up to (r / R)^4.
static void quadratic_displacement_is_reproduced(void** state) {
    (void)state;
    ruga_lattice lattice;
    box_lattice(2, 4, 3, 3, 0, &lattice);
    ruga_keyframe_def key = keyframe(0);
    key.has_bump = true;
    key.bump_radius = 1e4;
    key.bump_depth = 1e8; // second derivative of one
    key.bump_direction[1] = 2;
    memcpy(key.bump_center, CENTER, sizeof CENTER);
    double* q = motion(&lattice, 1, &key, 0);
    for (int e = 0; e < lattice.element_count; e++) {
        const double xi[3] = {0.3, 0.9, 0.1};
        double now[3], rest[3];
        position(&lattice, e, q, xi, now);
        for (int i = 0; i < 3; i++) {
            rest[i] = lattice.origin[i] + (lattice.element_cell[3 * e + i] + xi[i]) * lattice.cell_size[i];
        }
        double r = ruga_distance(rest, CENTER), height = 1e8 - 0.5 * r * r;
        assert_near(now[0], rest[0], 1e-9);
        assert_near(now[1], rest[1] + height * 2 / sqrt(5), 1e-6);
        assert_near(now[2], rest[2] + height / sqrt(5), 1e-6);
    }
    ruga_release(q);
    ruga_lattice_clear(&lattice);
}

// Largest error of a bump of radius 1 sampled on an n^3-cell lattice of edges of about 4.
static double bump_error(int degree, int n) {
    ruga_lattice lattice;
    box_lattice(degree, n, n, n, 0, &lattice);
    for (int i = 0; i < 3; i++) { // a finer lattice of the same box
        lattice.cell_size[i] *= 4.0 / n;
        for (int a = 0; a < lattice.node_count; a++) {
            lattice.rest[3 * a + i] =
                lattice.origin[i] + (lattice.rest[3 * a + i] - lattice.origin[i]) * 4.0 / n;
        }
    }
    ruga_keyframe_def key = keyframe(0);
    key.has_bump = true;
    key.bump_radius = 1;
    key.bump_depth = 1;
    for (int i = 0; i < 3; i++) {
        key.bump_center[i] = lattice.origin[i] + 0.5 * n * lattice.cell_size[i];
    }
    double *q = motion(&lattice, 1, &key, 0), largest = 0;
    for (int e = 0; e < lattice.element_count; e++) {
        for (int k = 0; k < 27; k++) {
            double xi[3] = {k % 3 / 2.0, k / 3 % 3 / 2.0, k / 9 / 2.0}, now[3], rest[3];
            position(&lattice, e, q, xi, now);
            for (int i = 0; i < 3; i++) {
                rest[i] =
                    lattice.origin[i] + (lattice.element_cell[3 * e + i] + xi[i]) * lattice.cell_size[i];
            }
            double r = ruga_distance(rest, key.bump_center);
            largest = fmax(largest, fabs(now[2] - rest[2] - exp(-0.5 * r * r)));
        }
    }
    ruga_release(q);
    ruga_lattice_clear(&lattice);
    return largest;
}

static void bump_converges_with_the_lattice(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        double coarse = bump_error(degree, 10), fine = bump_error(degree, 20);
        print_message("degree %d: error %.3g with 10 cells, %.3g with 20\n", degree, coarse, fine);
        assert_true(coarse / fine > (degree == 1 ? 3.3 : 6)); // orders 2 and 3
    }
}

static void bump_grows_in_place_from_a_keyframe_without_one(void** state) {
    (void)state;
    ruga_lattice lattice;
    box_lattice(1, 3, 3, 1, 0, &lattice);
    ruga_keyframe_def keys[2] = {keyframe(0), keyframe(1)};
    keys[1].has_bump = true;
    keys[1].bump_radius = 0.6;
    keys[1].bump_depth = 0.4;
    keys[1].bump_direction[0] = 1;
    memcpy(keys[1].bump_center, CENTER, sizeof CENTER);
    double *half = motion(&lattice, 2, keys, 0.5), *full = motion(&lattice, 2, keys, 1);
    double moved = 0;
    for (int i = 0; i < 3 * lattice.node_count; i++) {
        assert_near(2 * (half[i] - lattice.rest[i]), full[i] - lattice.rest[i], 1e-14);
        moved = fmax(moved, fabs(full[i] - lattice.rest[i]));
    }
    assert_true(moved > 0.1);
    ruga_release(half);
    ruga_release(full);
    // Between two bumps centre, radius and depth are linear in time.
    keys[0] = keys[1];
    keys[0].time = 0;
    keys[0].bump_depth = 0.2;
    keys[0].bump_center[0] -= 1;
    keys[0].bump_radius = 1;
    ruga_keyframe_def between = keys[1];
    between.bump_depth = 0.3;
    between.bump_center[0] -= 0.5;
    between.bump_radius = 0.8;
    half = motion(&lattice, 2, keys, 0.5);
    full = motion(&lattice, 1, &between, 0);
    for (int i = 0; i < 3 * lattice.node_count; i++) {
        assert_near(half[i], full[i], 1e-14);
    }
    ruga_release(half);
    ruga_release(full);
    ruga_lattice_clear(&lattice);
}

static void largest_compression_is_that_of_the_smallest_singular_value(void** state) {
    (void)state;
    ruga_keyframe_def keys[3] = {keyframe(0), keyframe(1), keyframe(2)};
    assert_near(ruga_motion_largest_compression(0, NULL), 0, 0);
    assert_near(ruga_motion_largest_compression(3, keys), 0, 1e-15);
    keys[1].matrix[4] = 1.3;
    assert_near(ruga_motion_largest_compression(3, keys), 0, 1e-15);
    // A turn of 90 degrees and a stretch of 0.95
    const double turned[9] = {0, -1, 0, 0.95, 0, 0, 0, 0, 1.1};
    memcpy(keys[1].matrix, turned, sizeof turned);
    assert_near(ruga_motion_largest_compression(3, keys), 0.05, 1e-15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(affine_motion_is_exact_and_linear_between_keyframes),
        cmocka_unit_test(motion_is_held_before_and_after_the_keyframes),
        cmocka_unit_test(quadratic_displacement_is_reproduced),
        cmocka_unit_test(bump_converges_with_the_lattice),
        cmocka_unit_test(bump_grows_in_place_from_a_keyframe_without_one),
        cmocka_unit_test(largest_compression_is_that_of_the_smallest_singular_value),
    };
    return cmocka_run_group_tests_name("motion", tests, NULL, check_no_leak);
}
