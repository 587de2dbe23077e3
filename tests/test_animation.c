// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/memory.h"
#include "io/animation.h"
#include "io/mesh_file.h"
#include "io/point_cache.h"
#include "tests/scarce_memory.h"

#include <float.h>
#include <string.h>
#include <unistd.h>

enum { VERTICES = 5, FRAMES = 3 };

// A pyramid without its floor, in two groups; vertex 0 has two uvs, one corner of the last face none.
static double uv[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.25}, {0.5, 0.75}};
static int triangle[4][3] = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
static int uv_triangle[4][3] = {{0, 1, 4}, {1, 2, 4}, {2, 3, 5}, {3, 4, -1}};
static int face_group[4] = {1, 0, 1, -1};
static char* group_name[2] = {"a \"b\"", "a 'b'"};
static ruga_mesh mesh = {.vertex_count = VERTICES,
                         .triangle_count = 4,
                         .triangle = triangle[0],
                         .uv_count = 6,
                         .uv = uv[0],
                         .uv_triangle = uv_triangle[0],
                         .group_count = 2,
                         .group_name = group_name,
                         .face_group = face_group};

typedef struct film {
    int reads;
    double spoil; // takes the place of one coordinate in frame 8
} film;

static double coordinate(int frame, int i) {
    static const double corner[VERTICES][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.7}};
    return corner[i / 3][i % 3] + (i == 14 ? 0.1 * (frame - 7) : 0); // the tip rises
}

static ruga_status read_frame(void* context, int frame, double* position, double* normal) {
    film* f = context;
    f->reads++;
    for (int i = 0; i < 3 * VERTICES; i++) {
        position[i] = coordinate(frame, i);
    }
    if (frame == 8 && f->spoil != 0) {
        position[7] = f->spoil;
    }
    if (normal) {
        ruga_mesh_vertex_normals(&mesh, position, normal);
    }
    return RUGA_OK;
}

static ruga_animation animate(film* f) {
    return (ruga_animation){.name = "tip \xff", // no UTF-8
                            .comment = "a \"comment\"",
                            .mesh = &mesh,
                            .first = 7,
                            .count = FRAMES,
                            .unit = 1,
                            .up = 1,
                            .rate = 25,
                            .read = read_frame,
                            .context = f};
}

static const struct {
    const char* path;
    ruga_animation_write* write;
} formats[] = {{"animation.glb", ruga_gltf_animation_write},
               {"animation.usda", ruga_usda_animation_write},
               {"animation.pc2", ruga_pc2_animation_write},
               {"animation.mdd", ruga_mdd_animation_write}};
enum { FORMATS = sizeof formats / sizeof *formats };

static void our_readers_find_what_was_written(void** state) {
    (void)state;
    film f = {0};
    ruga_animation a = animate(&f);
    for (int k = 2; k < FORMATS; k++) {
        ruga_point_cache cache;
        double position[3 * VERTICES];
        assert_ok(formats[k].write(formats[k].path, &a));
        assert_ok(ruga_point_cache_open(formats[k].path, &cache));
        assert_int_equal(cache.point_count, VERTICES);
        assert_int_equal(cache.sample_count, FRAMES);
        assert_int_equal(cache.time_is_real, k == 3);
        for (int s = FRAMES - 1; s >= 0; s--) {
            assert_near(cache.time[s], k == 3 ? (7 + s) / 25.0 : 7 + s, 1e-7);
            assert_ok(ruga_point_cache_read(&cache, s, position));
            for (int i = 0; i < 3 * VERTICES; i++) {
                assert_true(position[i] == (double)(float)coordinate(7 + s, i));
            }
        }
        ruga_point_cache_close(&cache);
    }
    ruga_mesh read;
    assert_ok(ruga_gltf_animation_write(formats[0].path, &a));
    assert_ok(ruga_mesh_read(formats[0].path, &read));
    assert_int_equal(read.vertex_count, VERTICES); // uvs apart, places together again
    assert_int_equal(read.triangle_count, 4);
    assert_int_equal(read.group_count, 3);
    ruga_mesh_clear(&read);
}

// Nothing at the file's place, nor beside it.
static void assert_no_file(const char* path) {
    char part[64];
    (void)snprintf(part, sizeof part, "%s.part%ld", path, (long)getpid());
    assert_int_not_equal(access(path, F_OK), 0);
    assert_int_not_equal(access(part, F_OK), 0);
}

static void numbers_that_a_float_cannot_hold_are_refused(void** state) {
    (void)state;
    const double bad[] = {NAN, INFINITY, -2.0 * (double)FLT_MAX};
    for (int k = 0; k < FORMATS; k++) {
        for (int i = 0; i < 3; i++) {
            film f = {.spoil = bad[i]};
            ruga_animation a = animate(&f);
            (void)remove(formats[k].path);
            assert_int_equal(formats[k].write(formats[k].path, &a), RUGA_BAD_INPUT);
            assert_non_null(strstr(ruga_last_error(), "frame 8: coordinate y of vertex 2"));
            assert_no_file(formats[k].path);
        }
    }
}

static void too_many_morph_targets_are_refused(void** state) {
    (void)state;
    film f = {0};
    ruga_animation a = animate(&f);
    a.count = 5000;
    assert_int_equal(ruga_gltf_animation_write("animation.glb", &a), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "--frames"));
    assert_int_equal(f.reads, 0);
}

static void each_allocation_may_fail(void** state) {
    (void)state;
    for (int k = 0; k < FORMATS; k++) {
        int n = 0;
        (void)remove(formats[k].path);
        for (ruga_status status = RUGA_NO_MEMORY; status != RUGA_OK; n++) {
            film f = {0};
            ruga_animation a = animate(&f);
            let_allocations_fail_after(n);
            status = formats[k].write(formats[k].path, &a);
            ruga_set_allocator(NULL, NULL, NULL);
            assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
            assert_int_equal(ruga_byte_count(), 0);
            if (status != RUGA_OK) {
                assert_no_file(formats[k].path);
            }
        }
        assert_true(n > 2);
    }
}

static void a_cache_may_lack_memory_too(void** state) {
    (void)state;
    ruga_point_cache cache;
    film f = {0};
    ruga_animation a = animate(&f);
    assert_ok(ruga_pc2_animation_write("animation.pc2", &a));
    int n = 0;
    for (ruga_status status = RUGA_NO_MEMORY; status != RUGA_OK; n++) {
        let_allocations_fail_after(n);
        status = ruga_point_cache_open("animation.pc2", &cache);
        ruga_set_allocator(NULL, NULL, NULL);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        assert_true(status == RUGA_OK || ruga_byte_count() == 0);
    }
    assert_true(n > 2);
    ruga_point_cache_close(&cache);
}

static void damaged_caches_are_refused(void** state) {
    (void)state;
    ruga_point_cache cache;
    unsigned char bytes[32 + 12 * VERTICES * FRAMES];
    film f = {0};
    ruga_animation a = animate(&f);
    assert_ok(ruga_pc2_animation_write("animation.pc2", &a));
    FILE* file = fopen("animation.pc2", "rb");
    assert_int_equal(fread(bytes, 1, sizeof bytes, file), sizeof bytes);
    (void)fclose(file);
    // Every single byte of the head, each set to all ones: refused, or read without harm.
    for (int k = 0; k < 32; k++) {
        unsigned char kept = bytes[k];
        bytes[k] = 0xff;
        file = fopen("damaged.pc2", "wb");
        assert_int_equal(fwrite(bytes, 1, sizeof bytes, file), sizeof bytes);
        (void)fclose(file);
        bytes[k] = kept;
        ruga_status status = ruga_point_cache_open("damaged.pc2", &cache);
        assert_true(status == RUGA_OK || status == RUGA_BAD_INPUT);
        assert_true(status == RUGA_BAD_INPUT || (k >= 20 && k < 28)); // start and step may be anything
        if (status == RUGA_OK) {
            ruga_point_cache_close(&cache);
        }
    }
    file = fopen("damaged.pc2", "wb");
    assert_int_equal(fwrite(bytes, 1, 20, file), 20);
    (void)fclose(file);
    assert_int_equal(ruga_point_cache_open("damaged.pc2", &cache), RUGA_BAD_INPUT);
    assert_int_equal(ruga_point_cache_open("no such file.mdd", &cache), RUGA_BAD_INPUT);
    assert_int_equal(ruga_byte_count(), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(our_readers_find_what_was_written),
        cmocka_unit_test(numbers_that_a_float_cannot_hold_are_refused),
        cmocka_unit_test(too_many_morph_targets_are_refused),
        cmocka_unit_test(each_allocation_may_fail),
        cmocka_unit_test(a_cache_may_lack_memory_too),
        cmocka_unit_test(damaged_caches_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
