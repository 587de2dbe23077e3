// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Pictures are judged by checks that wrong ones fail: a blank one, one lit from the wrong side (as inverted
// normals make it), one whose scale bar is wrong.
#define _POSIX_C_SOURCE 200809L
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/random.h"
#include "core/vec3.h"
#include "mesh/make.h"
#include "ruga/ruga.h"
#include "view/legend.h"
#include "view/light.h"
#include "view/movie.h"
#include "view/page.h"
#include "view/render.h"

#include <string.h>

static ruga_mesh make(ruga_shape shape, double x, double y, double edge) {
    ruga_mesh mesh;
    double z = shape == RUGA_SHAPE_SHEET ? 0 : x;
    assert_ok(ruga_mesh_make(&(ruga_make_def){.shape = shape, .size = {x, y, z}, .edge = edge}, &mesh));
    return mesh;
}

static ruga_render_def small_def(int width, int height) {
    ruga_render_def def = ruga_default_render_def();
    def.width = width;
    def.height = height;
    def.scale_bar = false;
    return def;
}

static ruga_picture render(const ruga_mesh* mesh, const ruga_render_def* def) {
    ruga_picture picture;
    assert_ok(ruga_render(mesh, mesh->position, def, &picture));
    return picture;
}

static double brightness(const ruga_picture* p, int x, int y) {
    const unsigned char* c = p->pixel + 3 * ((size_t)y * (size_t)p->width + (size_t)x);
    return (c[0] + c[1] + c[2]) / 765.0;
}

// ---- geometry of the picture ---------------------------------------------------------------------------

static void silhouette_of_a_sphere_has_its_area(void** state) {
    (void)state;
    const double radius = 0.1;
    ruga_mesh mesh = make(RUGA_SHAPE_SPHERE, 2 * radius, 2 * radius, 0.004);
    ruga_render_def def = small_def(240, 200);
    ruga_picture picture = render(&mesh, &def);
    double covered = 0, center[3] = {0, 0, 0}, distance = ruga_distance(picture.camera.eye, center), seen[2];
    for (int i = 0; i < picture.width * picture.height; i++) {
        covered += picture.coverage[i] / 255.0;
    }
    ruga_camera_project(&picture.camera, center, seen);
    assert_near(seen[0], 120, 0.5);
    assert_near(seen[1], 100, 0.5);
    // The cone about the sphere has the half-angle asin(R / d).
    double across = radius / sqrt(distance * distance - radius * radius);
    double pixels = across * 0.5 * picture.height / ruga_norm(picture.camera.up);
    assert_near(covered, RUGA_PI * pixels * pixels, 0.005 * RUGA_PI * pixels * pixels);
    assert_near(pixels, def.fit * 100, 1); // it fills the part of the picture that was asked for
    ruga_picture_clear(&picture);
    ruga_mesh_clear(&mesh);
}

static void camera_sees_everything(void** state) {
    (void)state;
    ruga_mesh mesh = make(RUGA_SHAPE_BAR, 0.3, 0.1, 0.03);
    ruga_extent extent = {.any = false};
    ruga_extent_add(&extent, mesh.vertex_count, mesh.position);
    for (int i = 0; i < 24; i++) {
        ruga_view view = {
            .azimuth = 0.7 * i, .elevation = (i % 5 - 2) * RUGA_PI / 4, .fit = 0.9, .foot = 0.1 * (i % 3)};
        view.up[i % 3] = 2;
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        ruga_camera camera;
        ruga_camera_frame(i % 2 ? RUGA_EXTENT_POINTS : mesh.vertex_count,
                          i % 2 ? extent.point[0] : mesh.position, &view, 400, 300, &camera);
        for (int v = 0; v < mesh.vertex_count; v++) {
            double p[2];
            ruga_camera_project(&camera, mesh.position + 3 * (size_t)v, p);
            for (int k = 0; k < 2; k++) {
                low[k] = fmin(low[k], p[k]);
                high[k] = fmax(high[k], p[k]);
            }
        }
        double room = 300 * (1 - view.foot);
        assert_true(low[0] > 0.04 * 400 && high[0] < 0.96 * 400 && low[1] > 0.04 * room &&
                    high[1] < 0.96 * room);
        assert_near(fmax((high[0] - low[0]) / 400, (high[1] - low[1]) / room), 0.9, 0.02);
    }
    ruga_mesh_clear(&mesh);
}

// ---- light ---------------------------------------------------------------------------------------------

static void sky_behind_a_wall_and_under_a_disc_is_the_closed_form(void** state) {
    (void)state;
    enum { SIDES = 256, RAYS = 20000 };
    const double up[3] = {0, 0, 1}, shift[2] = {0.3, 0.6};
    // A wall of height 1 that is as good as endlessly wide, seen from a point of the floor at distance d
    // hides (1 - d / sqrt(d^2 + 1)) / 2 of the sky: at its foot, half.
    const double wall[4][3] = {{0, -1e4, 0}, {0, 1e4, 0}, {0, 1e4, 1}, {0, -1e4, 1}};
    const int two[6] = {0, 1, 2, 0, 2, 3};
    ruga_ray_scene* scene;
    assert_ok(ruga_ray_scene_create(4, wall[0], 2, two, &scene));
    for (double d = 1e-3; d < 20; d *= 8) {
        double sky = ruga_light_sky(scene, (const double[3]){d, 0, 0}, up, 0, RAYS, shift);
        assert_near(sky, 1 - 0.5 * (1 - d / sqrt(d * d + 1)), 2e-3);
    }
    ruga_ray_scene_destroy(&scene);
    // A disc of radius r at height h above hides r^2 / (r^2 + h^2).
    double disc[SIDES + 1][3] = {{0, 0, 0.5}};
    int fan[3 * SIDES];
    for (int i = 0; i < SIDES; i++) {
        disc[i + 1][0] = cos(2 * RUGA_PI * i / SIDES);
        disc[i + 1][1] = sin(2 * RUGA_PI * i / SIDES);
        disc[i + 1][2] = 0.5;
        fan[3 * i] = 0;
        fan[3 * i + 1] = i + 1;
        fan[3 * i + 2] = (i + 1) % SIDES + 1;
    }
    assert_ok(ruga_ray_scene_create(SIDES + 1, disc[0], SIDES, fan, &scene));
    assert_near(ruga_light_sky(scene, (const double[3]){0, 0, 0}, up, 0, RAYS, shift), 1 - 1 / 1.25, 2e-3);
    assert_near(ruga_light_sky(scene, (const double[3]){0, 0, 1}, up, 0, RAYS, shift), 1, 0);
    ruga_ray_scene_destroy(&scene);
}

// Whether the object is there and brighter where it faces the light, at the upper left, than where it does
// not.
static bool looks_lit(const ruga_picture* p) {
    double sum[2] = {0, 0};
    int count[2] = {0, 0};
    for (int y = 0; y < p->height; y++) {
        for (int x = 0; x < p->width; x++) {
            double u = 2.0 * x / p->width - 1, v = 1 - 2.0 * y / p->height;
            if (p->coverage[(size_t)y * (size_t)p->width + (size_t)x] == 255 && fabs(v - u) > 0.5) {
                sum[v > u] += brightness(p, x, y);
                count[v > u]++;
            }
        }
    }
    return count[0] > 100 && count[1] > 100 && sum[1] / count[1] > 1.4 * sum[0] / count[0];
}

static void turn_half_around(ruga_picture* p) {
    for (int i = 0, j = p->width * p->height - 1; i < j; i++, j--) {
        for (int c = 0; c < 3; c++) {
            unsigned char swap = p->pixel[3 * i + c];
            p->pixel[3 * i + c] = p->pixel[3 * j + c];
            p->pixel[3 * j + c] = swap;
        }
    }
}

static void object_is_lit_from_the_light_and_wrong_pictures_are_noticed(void** state) {
    (void)state;
    ruga_mesh mesh = make(RUGA_SHAPE_SPHERE, 0.2, 0.2, 0.01);
    ruga_render_def def = small_def(160, 120);
    ruga_picture picture = render(&mesh, &def);
    assert_true(looks_lit(&picture));
    // Which way round the triangles are does not matter: the side towards the camera is lit.
    for (int f = 0; f < mesh.triangle_count; f++) {
        int swap = mesh.triangle[3 * f];
        mesh.triangle[3 * f] = mesh.triangle[3 * f + 1];
        mesh.triangle[3 * f + 1] = swap;
    }
    ruga_picture inside_out = render(&mesh, &def);
    assert_true(looks_lit(&inside_out));
    turn_half_around(&picture); // what inverted normals look like
    assert_false(looks_lit(&picture));
    memset(picture.pixel, 200, 3 * 160 * 120);
    assert_false(looks_lit(&picture));
    memset(picture.coverage, 0, 160 * 120);
    assert_false(looks_lit(&picture));
    ruga_picture_clear(&picture);
    ruga_picture_clear(&inside_out);
    ruga_mesh_clear(&mesh);
}

static void floor_has_a_shadow_on_the_far_side_of_the_light(void** state) {
    (void)state;
    ruga_mesh mesh = make(RUGA_SHAPE_SPHERE, 0.2, 0.2, 0.01);
    ruga_render_def def = small_def(240, 120);
    ruga_picture picture = render(&mesh, &def);
    double darkest[2] = {1, 1};
    for (int y = 60; y < 120; y++) {
        for (int x = 0; x < 240; x++) {
            if (picture.coverage[y * 240 + x] == 0) {
                darkest[x >= 120] = fmin(darkest[x >= 120], brightness(&picture, x, y));
            }
        }
    }
    assert_true(darkest[1] < 0.8 * brightness(&picture, 20, 110));
    assert_true(darkest[1] < darkest[0]);
    ruga_picture_clear(&picture);
    ruga_mesh_clear(&mesh);
}

static void picture_does_not_depend_on_threads(void** state) {
    (void)state;
    ruga_mesh mesh = make(RUGA_SHAPE_PILLOW, 0.5, 0.5, 0.02);
    ruga_render_def def = small_def(161, 97);
    def.wireframe = true;
    def.scale_bar = true;
    ruga_picture picture[3];
    for (int t = 0; t < 3; t++) {
        ruga_set_threads(t + 1);
        picture[t] = render(&mesh, &def);
        assert_memory_equal(picture[t].pixel, picture[0].pixel, 3 * 161 * 97);
    }
    ruga_set_threads(0);
    for (int t = 0; t < 3; t++) {
        ruga_picture_clear(&picture[t]);
    }
    ruga_mesh_clear(&mesh);
}

// ---- what stands in the picture ------------------------------------------------------------------------

// Pixels of the longest dark horizontal line in the lower left.
static int bar_in(const ruga_picture* p) {
    int longest = 0;
    for (int y = p->height * 3 / 4; y < p->height; y++) {
        for (int x = 0, run = 0; x < p->width / 2; x++) {
            run = brightness(p, x, y) < 0.45 ? run + 1 : 0;
            longest = run > longest ? run : longest;
        }
    }
    return longest;
}

static int width_in(const ruga_picture* p) {
    int low = p->width, high = -1;
    for (int i = 0; i < p->width * p->height; i++) {
        if (p->coverage[i] > 127) {
            low = i % p->width < low ? i % p->width : low;
            high = i % p->width > high ? i % p->width : high;
        }
    }
    return high - low + 1;
}

// Whether the bar is as long as it says, by the object's known width.
static bool scale_is_right(const ruga_picture* p, double bar_metres, double object_metres) {
    double by_bar = bar_in(p) / bar_metres, by_object = width_in(p) / object_metres;
    return fabs(by_bar - by_object) < 0.02 * by_object;
}

static void scale_bar_is_as_long_as_it_says(void** state) {
    (void)state;
    static const char* const wanted[] = {"200 µm", "5 cm", "20 m"};
    const double widths[] = {1.3e-3, 0.3, 140};
    for (int i = 0; i < 3; i++) {
        ruga_mesh mesh = make(RUGA_SHAPE_SHEET, widths[i], widths[i] / 2, widths[i] / 10);
        ruga_render_def def = small_def(800, 600);
        ruga_legend legend;
        def.elevation = RUGA_PI / 2;
        def.azimuth = -RUGA_PI / 2;
        def.scale_bar = true;
        ruga_picture picture = render(&mesh, &def);
        ruga_legend_place(&def, &picture.camera, &legend);
        assert_string_equal(legend.bar_text, wanted[i]);
        assert_true(scale_is_right(&picture, legend.bar_metres, widths[i]));
        assert_false(scale_is_right(&picture, 1.1 * legend.bar_metres, widths[i]));
        assert_false(scale_is_right(&picture, legend.bar_metres, 2 * widths[i]));
        ruga_picture_clear(&picture);
        ruga_mesh_clear(&mesh);
    }
}

static void legend_shows_the_colours_of_its_numbers(void** state) {
    (void)state;
    ruga_mesh mesh = make(RUGA_SHAPE_SHEET, 0.3, 0.1, 0.02);
    ruga_render_def def = small_def(640, 400);
    double* value = test_calloc((size_t)mesh.vertex_count, sizeof *value);
    def.scalar = (ruga_scale){.value = value, .min = -2.5e-3, .max = 1e-3, .name = "w, mm", .unit = 1e-3};
    for (int kind = 0; kind < 2; kind++) {
        def.scalar.map = (ruga_colormap_kind)kind;
        ruga_legend legend;
        ruga_tick ticks[RUGA_AXIS_TICKS];
        ruga_picture picture = render(&mesh, &def);
        ruga_legend_place(&def, &picture.camera, &legend);
        int count = ruga_axis_ticks(&legend.axis, 6, ticks), shown = 0;
        for (int i = 0; i < count; i++) {
            double rgb[3], part = (1e-3 * atof(ticks[i].label) - def.scalar.min) / 3.5e-3;
            int x = (int)ruga_axis_place(&legend.axis, ticks[i].value), y = (int)(legend.top + 2);
            ruga_colormap(def.scalar.map, part, rgb);
            x = x < (int)legend.right ? x : (int)legend.right - 1;
            for (int c = 0; c < 3; c++) {
                assert_near(picture.pixel[3 * (y * 640 + x) + c], ruga_srgb(rgb[c]), 3);
            }
            shown += ticks[i].label[0] != '\0';
        }
        assert_true(shown >= 4);
        assert_near(legend.axis.min, -2.5, 1e-12);
        assert_near(legend.axis.max, 1, 1e-12);
        ruga_picture_clear(&picture);
    }
    test_free(value);
    ruga_mesh_clear(&mesh);
}

static void values_lines_and_places_are_seen(void** state) {
    (void)state;
    ruga_mesh mesh = make(RUGA_SHAPE_SHEET, 0.2, 0.2, 0.02);
    double* value = test_calloc((size_t)mesh.vertex_count, sizeof *value);
    int* place = test_calloc((size_t)mesh.vertex_count, sizeof *place);
    int* line = test_calloc(3 * (size_t)mesh.triangle_count, sizeof *line);
    for (int v = 0; v < mesh.vertex_count; v++) {
        value[v] = mesh.position[3 * v];
        place[v] = mesh.position[3 * v] > 0;
    }
    ruga_render_def def = small_def(120, 120);
    def.elevation = RUGA_PI / 2;
    def.azimuth = -RUGA_PI / 2;
    ruga_picture clay = render(&mesh, &def);
    def.scalar = (ruga_scale){.value = value, .min = -0.1, .max = 0.1};
    ruga_picture scalar = render(&mesh, &def);
    def.scalar.value = NULL;
    def.place = place;
    ruga_picture places = render(&mesh, &def);
    def.place = NULL;
    def.line = line; // every edge
    def.draw_lines = true;
    ruga_picture lines = render(&mesh, &def);
    const unsigned char *left = scalar.pixel + 3 * (60 * 120 + 20),
                        *right = scalar.pixel + 3 * (60 * 120 + 100);
    assert_true(left[2] > left[0] + 60 && right[0] > right[2] + 60); // blue to red along x
    left = places.pixel + 3 * (60 * 120 + 20);
    right = places.pixel + 3 * (60 * 120 + 100);
    assert_true(abs(left[0] - right[0]) + abs(left[1] - right[1]) + abs(left[2] - right[2]) > 60);
    double sum[2] = {0, 0};
    for (int i = 0; i < 120 * 120; i++) {
        sum[0] += brightness(&clay, i % 120, i / 120);
        sum[1] += brightness(&lines, i % 120, i / 120);
    }
    assert_true(sum[1] < 0.95 * sum[0]);
    ruga_picture_clear(&clay);
    ruga_picture_clear(&scalar);
    ruga_picture_clear(&places);
    ruga_picture_clear(&lines);
    test_free(value);
    test_free(place);
    test_free(line);
    ruga_mesh_clear(&mesh);
}

// A ridge that is bent by 20 degrees is smooth, or, where it is a crease, two flat sides.
static void surface_is_not_smoothed_across_a_crease(void** state) {
    (void)state;
    ruga_mesh mesh;
    assert_ok(ruga_mesh_make(
        &(ruga_make_def){
            .shape = RUGA_SHAPE_SHEET, .size = {0.2, 0.2}, .cells = {4, 4}, .pattern = RUGA_PATTERN_DIAGONAL},
        &mesh));
    int* line = test_calloc(3 * (size_t)mesh.triangle_count, sizeof *line);
    for (int v = 0; v < mesh.vertex_count; v++) {
        mesh.position[3 * v + 2] = -tan(10 * RUGA_PI / 180) * fabs(mesh.position[3 * v]);
    }
    for (int c = 0; c < 3 * mesh.triangle_count; c++) {
        int a = mesh.triangle[c], b = mesh.triangle[c % 3 == 2 ? c - 2 : c + 1];
        line[c] = fabs(mesh.position[3 * a]) < 1e-9 && fabs(mesh.position[3 * b]) < 1e-9 ? 0 : -1;
    }
    ruga_render_def def = small_def(160, 160);
    def.elevation = RUGA_PI / 2;
    def.azimuth = -RUGA_PI / 2;
    double step[2];
    for (int k = 0; k < 2; k++) {
        def.line = k == 1 ? line : NULL;
        ruga_picture picture = render(&mesh, &def);
        double mean[2] = {0, 0};
        for (int y = 60; y < 100; y++) {
            mean[0] += brightness(&picture, 76, y) / 40;
            mean[1] += brightness(&picture, 84, y) / 40;
        }
        step[k] = mean[0] - mean[1];
        ruga_picture_clear(&picture);
    }
    assert_true(step[1] > 0.06 && step[0] < 0.5 * step[1]);
    test_free(line);
    ruga_mesh_clear(&mesh);
}

// ---- colours -------------------------------------------------------------------------------------------

static void equal_steps_of_a_value_look_equally_large(void** state) {
    (void)state;
    enum { STEPS = 100 };
    for (int kind = 0; kind < 2; kind++) {
        double least = INFINITY, most = 0, lightness = -1;
        for (int i = 0; i < STEPS; i++) {
            double rgb[2][3], lab[2][3];
            for (int k = 0; k < 2; k++) {
                ruga_colormap((ruga_colormap_kind)kind, (double)(i + k) / STEPS, rgb[k]);
                ruga_colormap_oklab(rgb[k], lab[k]);
            }
            least = fmin(least, ruga_distance(lab[0], lab[1]));
            most = fmax(most, ruga_distance(lab[0], lab[1]));
            if (kind == RUGA_COLORMAP_SEQUENTIAL) {
                assert_true(lab[0][0] > lightness); // also in black and white
                lightness = lab[0][0];
            }
        }
        assert_near(most / least, 1, 0.03);
    }
}

// ---- page ----------------------------------------------------------------------------------------------

static void page_holds_positions_to_half_a_step(void** state) {
    (void)state;
    enum { N = 3 * 50, FRAMES = 4 };
    const double low[3] = {-1, 5, 0}, step = 2e-5;
    uint16_t place[N] = {0}, read[N] = {0};
    ruga_random random = {.state = 3};
    for (int t = 0; t < FRAMES; t++) {
        double position[N];
        unsigned char bytes[2 * N];
        for (int i = 0; i < N; i++) {
            position[i] = low[i % 3] + 65535 * step * (i < 3 ? (t % 2) : ruga_random_uniform(&random));
        }
        ruga_page_pack(N, position, low, step, place, bytes);
        for (int i = 0; i < N; i++) {
            read[i] = (uint16_t)(read[i] + bytes[i] + 256 * bytes[N + i]);
            assert_near(low[i % 3] + step * read[i], position[i], 0.5001 * step);
        }
    }
}

// ---- trouble -------------------------------------------------------------------------------------------

static void what_cannot_be_drawn_is_refused(void** state) {
    (void)state;
    ruga_mesh mesh = make(RUGA_SHAPE_SHEET, 0.2, 0.2, 0.05);
    ruga_render_def def = small_def(8, 100);
    ruga_picture picture;
    assert_status(ruga_render(&mesh, mesh.position, &def, &picture), RUGA_BAD_INPUT);
    def.width = 100;
    mesh.position[7] = NAN;
    assert_status(ruga_render(&mesh, mesh.position, &def, &picture), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "vertex 2"));
    mesh.position[7] = 0;
    picture = render(&mesh, &def);
    assert_status(ruga_picture_write(&picture, "no/such/folder/a.png"), RUGA_IO);
    ruga_picture_clear(&picture);
    ruga_mesh_clear(&mesh);
}

static void memory_that_runs_out_is_told(void** state) {
    (void)state;
    ruga_mesh mesh = make(RUGA_SHAPE_SHEET, 0.2, 0.2, 0.05);
    ruga_render_def def = small_def(32, 32);
    ruga_picture picture;
    ruga_status status = RUGA_NO_MEMORY;
    for (int count = 0; status != RUGA_OK; count++) {
        assert_in_range(count, 0, 100);
        let_allocations_fail_after(count);
        status = ruga_render(&mesh, mesh.position, &def, &picture);
        ruga_set_allocator(NULL, NULL, NULL);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
    }
    ruga_picture_clear(&picture);
    ruga_mesh_clear(&mesh);
}

static void film_without_ffmpeg_is_refused_with_a_sentence(void** state) {
    (void)state;
    ruga_movie* movie;
    char* path = strdup(getenv("PATH"));
    assert_int_equal(setenv("PATH", "/nowhere", 1), 0);
    ruga_status status = ruga_movie_open("film.mp4", 32, 32, 25, &movie);
    assert_int_equal(setenv("PATH", path, 1), 0);
    free(path);
    assert_int_equal(status, RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "ffmpeg"));
    assert_null(movie);
    assert_status(ruga_movie_open("film.avi", 32, 32, 25, &movie), RUGA_BAD_INPUT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(silhouette_of_a_sphere_has_its_area),
        cmocka_unit_test(camera_sees_everything),
        cmocka_unit_test(sky_behind_a_wall_and_under_a_disc_is_the_closed_form),
        cmocka_unit_test(object_is_lit_from_the_light_and_wrong_pictures_are_noticed),
        cmocka_unit_test(floor_has_a_shadow_on_the_far_side_of_the_light),
        cmocka_unit_test(picture_does_not_depend_on_threads),
        cmocka_unit_test(scale_bar_is_as_long_as_it_says),
        cmocka_unit_test(legend_shows_the_colours_of_its_numbers),
        cmocka_unit_test(values_lines_and_places_are_seen),
        cmocka_unit_test(surface_is_not_smoothed_across_a_crease),
        cmocka_unit_test(equal_steps_of_a_value_look_equally_large),
        cmocka_unit_test(page_holds_positions_to_half_a_step),
        cmocka_unit_test(what_cannot_be_drawn_is_refused),
        cmocka_unit_test(memory_that_runs_out_is_told),
        cmocka_unit_test(film_without_ffmpeg_is_refused_with_a_sentence),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
