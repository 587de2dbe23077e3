// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/random.h"
#include "core/vec3.h"
#include "mesh/make.h"
#include "ruga/ruga.h"
#include "view/ray.h"

#include <stdlib.h>

static const ruga_ray DOWN = {{0.2, 0.3, 5}, {0, 0, -1}, 0, INFINITY};

// The square [0, 1] x [0, 1] in z = 0, in two triangles.
static ruga_ray_scene* square(double scale, const double shift[3]) {
    double position[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    static const int triangle[6] = {0, 1, 2, 0, 2, 3};
    for (int i = 0; i < 12; i++) {
        position[i / 3][i % 3] = scale * position[i / 3][i % 3] + shift[i % 3];
    }
    ruga_ray_scene* scene;
    assert_ok(ruga_ray_scene_create(4, position[0], 2, triangle, &scene));
    return scene;
}

static void hit_is_where_the_plane_is(void** state) {
    (void)state;
    ruga_ray_scene* scene = square(1, (const double[3]){0, 0, 0});
    ruga_ray_hit hit = ruga_ray_closest(scene, &DOWN);
    assert_int_equal(hit.triangle, 1); // y > x
    assert_near(hit.distance, 5, 1e-15);
    assert_near(hit.weight[0], 0.7, 1e-7);
    assert_near(hit.weight[1], 0.2, 1e-7);
    assert_near(hit.weight[2], 0.1, 1e-7);
    ruga_ray up = DOWN;
    up.direction[2] = 2; // from above, upwards: nothing
    assert_int_equal(ruga_ray_closest(scene, &up).triangle, -1);
    assert_false(ruga_ray_blocked(scene, &up));
    up.origin[2] = -5; // from below, in steps of 2
    assert_near(ruga_ray_closest(scene, &up).distance, 2.5, 1e-15);
    assert_true(ruga_ray_blocked(scene, &up));
    ruga_ray_scene_destroy(&scene);
    assert_null(scene);
}

static void only_hits_between_near_and_far_count(void** state) {
    (void)state;
    ruga_ray_scene* scene = square(1, (const double[3]){0, 0, 0});
    const struct {
        double near, far;
        bool met;
    } cases[] = {{0, 4.99, false}, {0, 5.01, true}, {5.01, INFINITY, false}, {4.99, 1e300, true}};
    for (int i = 0; i < 4; i++) {
        ruga_ray ray = DOWN;
        ray.near = cases[i].near;
        ray.far = cases[i].far;
        assert_int_equal(ruga_ray_closest(scene, &ray).triangle >= 0, cases[i].met);
        assert_int_equal(ruga_ray_blocked(scene, &ray), cases[i].met);
    }
    ruga_ray_scene_destroy(&scene);
}

// A millimetre far from the origin, and a size of many kilometres.
static void place_and_size_cost_no_digits(void** state) {
    (void)state;
    const double shift[3] = {1000, -2000, 500};
    for (double scale = 1e-3; scale < 1e5; scale *= 1e4) {
        ruga_ray_scene* scene = square(scale, shift);
        ruga_ray ray = DOWN;
        for (int k = 0; k < 3; k++) {
            ray.origin[k] = scale * DOWN.origin[k] + shift[k];
        }
        ruga_ray_hit hit = ruga_ray_closest(scene, &ray);
        assert_near(hit.distance, 5 * scale, 1e-12 * 5e3);
        assert_near(hit.weight[1], 0.2, 1e-6);
        ruga_ray_scene_destroy(&scene);
    }
}

// Embree stops the program at numbers that it does not want.
static void from_beyond_all_bounds_nothing_is_seen(void** state) {
    (void)state;
    ruga_ray_scene* scene = square(1e-3, (const double[3]){0, 0, 0});
    for (double height = 1e13; height < 1e40; height *= 1e3) {
        ruga_ray ray = {{2e-4, 3e-4, height}, {0, 0, -1}, 0, INFINITY};
        assert_int_equal(ruga_ray_closest(scene, &ray).triangle, -1);
        assert_false(ruga_ray_blocked(scene, &ray));
    }
    ruga_ray_scene_destroy(&scene);
    for (double scale = 1e-25; scale < 1e31; scale *= 1e5) {
        scene = square(scale, (const double[3]){0, 0, 0});
        ruga_ray ray = {{0.2 * scale, 0.3 * scale, 5 * scale}, {0, 0, -1}, scale, 1e3 * scale};
        assert_near(ruga_ray_closest(scene, &ray).distance / scale, 5, 1e-12);
        assert_true(ruga_ray_blocked(scene, &ray));
        ruga_ray_scene_destroy(&scene);
    }
}

static void rays_from_inside_a_closed_mesh_all_hit(void** state) {
    (void)state;
    enum { N = 20000 };
    ruga_mesh mesh;
    assert_ok(
        ruga_mesh_make(&(ruga_make_def){.shape = RUGA_SHAPE_SPHERE, .size = {2, 2, 2}, .edge = 0.1}, &mesh));
    ruga_ray_scene* scene;
    assert_ok(
        ruga_ray_scene_create(mesh.vertex_count, mesh.position, mesh.triangle_count, mesh.triangle, &scene));
    ruga_ray* ray = malloc(N * sizeof *ray);
    ruga_ray_hit* hit[2] = {malloc(N * sizeof *hit[0]), malloc(N * sizeof *hit[1])};
    ruga_random random = {.state = 7};
    for (int i = 0; i < N; i++) {
        ray[i] = (ruga_ray){.far = INFINITY};
        // Half of them straight at a vertex, where several triangles meet.
        const double* x = mesh.position + 3 * (size_t)(i / 2 % mesh.vertex_count);
        for (int k = 0; k < 3; k++) {
            ray[i].direction[k] = i % 2 ? x[k] : 2 * ruga_random_uniform(&random) - 1;
        }
        (void)ruga_normalize(ray[i].direction);
    }
    for (int threads = 1; threads <= 2; threads++) {
        ruga_set_threads(threads);
        ruga_ray_closest_many(scene, N, ray, hit[threads - 1]);
    }
    ruga_set_threads(0);
    for (int i = 0; i < N; i++) {
        assert_int_equal(hit[0][i].triangle, hit[1][i].triangle);
        assert_memory_equal(hit[0][i].weight, hit[1][i].weight, sizeof hit[0][i].weight);
        assert_in_range(hit[0][i].triangle, 0, mesh.triangle_count - 1);
        assert_near(hit[0][i].distance, 1, 3e-3); // the sphere's facets lie a little inside
        double x[3] = {0, 0, 0};
        for (int c = 0; c < 3; c++) {
            ruga_add_scaled(hit[0][i].weight[c],
                            mesh.position + 3 * (size_t)mesh.triangle[3 * hit[0][i].triangle + c], x);
        }
        ruga_add_scaled(-hit[0][i].distance, ray[i].direction, x);
        assert_near(ruga_norm(x), 0, 3e-7); // the corners' single precision
    }
    free(ray);
    free(hit[0]);
    free(hit[1]);
    ruga_ray_scene_destroy(&scene);
    ruga_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hit_is_where_the_plane_is),
        cmocka_unit_test(only_hits_between_near_and_far_count),
        cmocka_unit_test(place_and_size_cost_no_digits),
        cmocka_unit_test(from_beyond_all_bounds_nothing_is_seen),
        cmocka_unit_test(rays_from_inside_a_closed_mesh_all_hit),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
