// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/memory.h"
#include "core/random.h"
#include "core/vec3.h"
#include "tests/scarce_memory.h"
#include "view/bake.h"
#include "view/blend.h"
#include "view/tangent.h"

#include <string.h>

// ---- a cylinder in two charts ----------------------------------------------------------------------------

static const double RADIUS = 0.1, HEIGHT = 0.12, AMPLITUDE = 0.005;
enum { WAVES = 6 };

// Open at its ends, `around` by `along` quads. The half in front lies upright on the left, the other one
// smaller, turned by a quarter and, where `mirrored`, reflected on the right: seams at angles 0 and pi.
static void make_cylinder(int around, int along, bool mirrored, ruga_mesh* mesh) {
    *mesh = (ruga_mesh){.vertex_count = around * (along + 1), .triangle_count = 2 * around * along};
    mesh->uv_count = 2 * (around / 2 + 1) * (along + 1);
    assert_ok(RUGA_NEW(mesh->position, 3 * mesh->vertex_count));
    assert_ok(RUGA_NEW(mesh->triangle, 3 * mesh->triangle_count));
    assert_ok(RUGA_NEW(mesh->uv, 2 * mesh->uv_count));
    assert_ok(RUGA_NEW(mesh->uv_triangle, 3 * mesh->triangle_count));
    for (int i = 0; i < around; i++) {
        for (int k = 0; k <= along; k++) {
            double angle = 2 * RUGA_PI * i / around, *x = mesh->position + 3 * (i * (along + 1) + k);
            x[0] = RADIUS * cos(angle);
            x[1] = RADIUS * sin(angle);
            x[2] = HEIGHT * ((double)k / along - 0.5);
        }
    }
    for (int i = 0; i <= around / 2; i++) {
        for (int k = 0; k <= along; k++) {
            double s = 2.0 * i / around, t = (double)k / along;
            double *front = mesh->uv + 2 * (i * (along + 1) + k), *back = front + mesh->uv_count;
            front[0] = 0.03 + 0.5 * s;
            front[1] = 0.05 + 0.9 * t;
            back[0] = 0.95 - 0.35 * t;
            back[1] = mirrored ? 0.9 - 0.8 * s : 0.1 + 0.8 * s;
        }
    }
    int f = 0;
    for (int i = 0; i < around; i++) {
        int half = i / (around / 2), first = i % (around / 2);
        for (int k = 0; k < along; k++) {
            const int quad[4][2] = {{i, k}, {i + 1, k}, {i + 1, k + 1}, {i, k + 1}};
            static const int corner[6] = {0, 1, 2, 0, 2, 3};
            for (int c = 0; c < 6; c++, f++) {
                const int* q = quad[corner[c]];
                mesh->triangle[f] = q[0] % around * (along + 1) + q[1];
                mesh->uv_triangle[f] = half * mesh->uv_count / 2 + (first + q[0] - i) * (along + 1) + q[1];
            }
        }
    }
}

static double radius_at(double angle) {
    return RADIUS + AMPLITUDE * sin(WAVES * angle);
}

// Wrinkles along the normal, and half as much along the surface.
static double* make_wrinkles(const ruga_mesh* mesh, double along_surface) {
    double* x = NULL;
    assert_ok(RUGA_NEW(x, 3 * mesh->vertex_count));
    for (int v = 0; v < mesh->vertex_count; v++) {
        const double* p = mesh->position + 3 * v;
        double angle = atan2(p[1], p[0]),
               turned = angle + along_surface * AMPLITUDE / RADIUS * cos(WAVES * angle);
        x[3 * v] = radius_at(angle) * cos(turned);
        x[3 * v + 1] = radius_at(angle) * sin(turned);
        x[3 * v + 2] = p[2] + along_surface * AMPLITUDE * sin(2 * angle);
    }
    return x;
}

// ---- a renderer ------------------------------------------------------------------------------------------

typedef struct renderer {
    const ruga_mesh* mesh;
    double *normal, *tangent;
    signed char* sign;
    int size;
    const float* pixel;
} renderer;

static renderer make_renderer(const ruga_mesh* mesh, int size, const float* pixel) {
    renderer r = {.mesh = mesh, .size = size, .pixel = pixel};
    assert_ok(RUGA_NEW(r.normal, 3 * mesh->vertex_count));
    ruga_mesh_vertex_normals(mesh, mesh->position, r.normal);
    assert_ok(ruga_tangents_create(mesh, mesh->position, r.normal, &r.tangent, &r.sign));
    return r;
}

static void free_renderer(renderer* r) {
    ruga_release(r->normal);
    ruga_release(r->tangent);
    ruga_release(r->sign);
}

static void look_up(const renderer* r, const double uv[2], double value[3]) {
    double x = uv[0] * r->size - 0.5, y = (1 - uv[1]) * r->size - 0.5;
    int column = (int)floor(x), row = (int)floor(y);
    value[0] = value[1] = value[2] = 0;
    for (int k = 0; k < 4; k++) {
        int c = column + k % 2, d = row + k / 2;
        double weight = fabs(1 - k % 2 - (x - column)) * fabs(1 - k / 2 - (y - row));
        for (int i = 0; i < 3; i++) {
            value[i] += weight * (double)r->pixel[3 * (d * r->size + c) + i];
        }
    }
}

// What the texture makes of a point of a triangle: the vector t c_1 + b c_2 + n c_3.
static void unpack(const renderer* r, int f, const double w[3], const double scale[3], double point[3],
                   double vector[3]) {
    double uv[2] = {0, 0}, n[3] = {0}, t[3] = {0}, b[3], c[3];
    point[0] = point[1] = point[2] = vector[0] = vector[1] = vector[2] = 0;
    for (int i = 0; i < 3; i++) {
        int v = r->mesh->triangle[3 * f + i];
        ruga_add_scaled(w[i], r->mesh->position + 3 * v, point);
        ruga_add_scaled(w[i], r->normal + 3 * v, n);
        ruga_add_scaled(w[i], r->tangent + 9 * f + 3 * i, t);
        uv[0] += w[i] * r->mesh->uv[2 * r->mesh->uv_triangle[3 * f + i]];
        uv[1] += w[i] * r->mesh->uv[2 * r->mesh->uv_triangle[3 * f + i] + 1];
    }
    ruga_cross(n, t, b);
    look_up(r, uv, c);
    ruga_add_scaled(scale[0] * c[0], t, vector);
    ruga_add_scaled(scale[1] * r->sign[f] * c[1], b, vector);
    ruga_add_scaled(scale[2] * c[2], n, vector);
}

// Points of a triangle: anywhere, then on its borders, seams included.
static void choose_weights(ruga_random* random, int k, double w[3]) {
    double a = ruga_random_uniform(random), b = ruga_random_uniform(random);
    w[0] = a + b > 1 ? 1 - a : a;
    w[1] = a + b > 1 ? 1 - b : b;
    w[2] = 1 - w[0] - w[1];
    if (k >= 3) {
        w[k % 3] = 0;
        w[(k + 1) % 3] = a;
        w[(k + 2) % 3] = 1 - a;
    }
}

// ---- displacement ----------------------------------------------------------------------------------------

// Largest distance, in amplitudes, of the displaced surface to where the fine one has the same point.
static double vector_error(const renderer* r, const double* fine, const double scale[3]) {
    double largest = 0;
    ruga_random random = {7};
    for (int f = 0; f < r->mesh->triangle_count; f++) {
        for (int k = 0; k < 6; k++) {
            double w[3], point[3], vector[3], wanted[3] = {0};
            choose_weights(&random, k, w);
            unpack(r, f, w, scale, point, vector);
            for (int i = 0; i < 3; i++) {
                ruga_add_scaled(w[i], fine + 3 * r->mesh->triangle[3 * f + i], wanted);
            }
            ruga_add_scaled(1, vector, point);
            largest = fmax(largest, ruga_distance(point, wanted) / AMPLITUDE);
        }
    }
    return largest;
}

static void a_vector_map_brings_back_the_surface_seams_included(void** state) {
    (void)state;
    static const double all[3] = {1, 1, 1}, normal[3] = {0, 0, 1};
    enum { SIZE = 512 };
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        ruga_mesh mesh;
        ruga_atlas atlas;
        float* pixel;
        ruga_bake_report report;
        make_cylinder(96, 24, mirrored, &mesh);
        double* fine = make_wrinkles(&mesh, 0.5);
        assert_ok(ruga_atlas_create("it", &mesh, SIZE, SIZE, &atlas));
        assert_ok(RUGA_NEW(pixel, 3 * SIZE * SIZE));
        ruga_bake_def def = {
            .atlas = &atlas, .base = mesh.position, .fine = &mesh, .detail = fine, .margin = 4};
        assert_ok(ruga_bake(&def, pixel, &report));
        assert_int_equal(report.missed, 0);
        renderer r = make_renderer(&mesh, SIZE, pixel);
        double error = vector_error(&r, fine, all), plain = vector_error(&r, fine, normal);
        print_message("vector map: %.2f %% of the amplitude; its normal component alone: %.0f %%\n",
                      100 * error, 100 * plain);
        assert_true(error < 0.02);
        // Half an amplitude around, and as much along the axis: up to 0.5 sqrt 2 is lost.
        assert_true(plain > 0.6 && plain < 0.75);
        assert_near(sqrt(report.tangential / report.squares), sqrt(0.5 * 0.25 * 2 / (0.5 + 0.5 * 0.25 * 2)),
                    0.05);
        free_renderer(&r);
        ruga_release(pixel);
        ruga_release(fine);
        ruga_atlas_clear(&atlas);
        ruga_mesh_clear(&mesh);
    }
}

static void rays_from_a_coarse_mesh_bring_back_the_surface(void** state) {
    (void)state;
    static const double all[3] = {1, 1, 1};
    enum { SIZE = 1024 };
    ruga_mesh low, mesh;
    ruga_atlas atlas;
    float* pixel;
    ruga_bake_report report;
    make_cylinder(24, 4, true, &low);
    make_cylinder(384, 48, false, &mesh);
    double* fine = make_wrinkles(&mesh, 0);
    assert_ok(ruga_atlas_create("it", &low, SIZE, SIZE, &atlas));
    assert_ok(RUGA_NEW(pixel, 3 * SIZE * SIZE));
    ruga_bake_def def = {
        .atlas = &atlas, .base = low.position, .fine = &mesh, .detail = fine, .margin = 4, .distance = 0.02};
    assert_ok(ruga_bake(&def, pixel, &report));
    assert_true(report.missed < 0.03 * report.texels); // beyond the open ends
    renderer r = make_renderer(&low, SIZE, pixel);
    double largest = 0;
    ruga_random random = {7};
    for (int f = 0; f < low.triangle_count; f++) {
        for (int k = 0; k < 60; k++) {
            double w[3], x[3], vector[3];
            choose_weights(&random, k % 6, w);
            unpack(&r, f, w, all, x, vector);
            ruga_add_scaled(1, vector, x);
            double angle = atan2(x[1], x[0]),
                   slope = WAVES * AMPLITUDE * cos(WAVES * angle) / radius_at(angle);
            double distance = fabs(hypot(x[0], x[1]) - radius_at(angle)) / sqrt(1 + slope * slope);
            largest = fmax(largest, distance / AMPLITUDE);
        }
    }
    print_message("ray map: %.2f %% of the amplitude\n", 100 * largest);
    assert_true(largest < 0.02);
    assert_true(report.tangential < 1e-8 * report.squares); // rays go along the normal
    def.distance = 1e-5;
    for (int i = 0; i < 3 * low.vertex_count; i++) {
        low.position[i] *= 3;
    }
    assert_int_equal(ruga_bake(&def, pixel, &report), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "place and unit"));
    free_renderer(&r);
    ruga_release(pixel);
    ruga_release(fine);
    ruga_atlas_clear(&atlas);
    ruga_mesh_clear(&low);
    ruga_mesh_clear(&mesh);
}

static void a_normal_map_brings_back_the_normals(void** state) {
    (void)state;
    static const double all[3] = {1, 1, 1};
    enum { SIZE = 512 };
    ruga_mesh mesh;
    ruga_atlas atlas;
    float* pixel;
    ruga_bake_report report;
    make_cylinder(96, 24, true, &mesh);
    double *fine = make_wrinkles(&mesh, 0.5), *normal = NULL, largest = 0;
    assert_ok(RUGA_NEW(normal, 3 * mesh.vertex_count));
    ruga_mesh_vertex_normals(&mesh, fine, normal);
    assert_ok(ruga_atlas_create("it", &mesh, SIZE, SIZE, &atlas));
    assert_ok(RUGA_NEW(pixel, 3 * SIZE * SIZE));
    ruga_bake_def def = {.map = RUGA_BAKE_NORMAL,
                         .atlas = &atlas,
                         .base = mesh.position,
                         .fine = &mesh,
                         .detail = fine,
                         .margin = 4};
    assert_ok(ruga_bake(&def, pixel, &report));
    renderer r = make_renderer(&mesh, SIZE, pixel);
    ruga_random random = {7};
    for (int f = 0; f < mesh.triangle_count; f++) {
        for (int k = 0; k < 6; k++) {
            double w[3], point[3], n[3], wanted[3] = {0};
            choose_weights(&random, k, w);
            unpack(&r, f, w, all, point, n);
            for (int i = 0; i < 3; i++) {
                ruga_add_scaled(w[i], normal + 3 * mesh.triangle[3 * f + i], wanted);
            }
            ruga_normalize(n);
            ruga_normalize(wanted);
            largest = fmax(largest, ruga_distance(n, wanted));
        }
    }
    print_message("normal map: %.2f degrees\n", largest * 180 / RUGA_PI);
    assert_true(largest < 0.01);
    free_renderer(&r);
    ruga_release(normal);
    ruga_release(pixel);
    ruga_release(fine);
    ruga_atlas_clear(&atlas);
    ruga_mesh_clear(&mesh);
}

// ---- tangents --------------------------------------------------------------------------------------------

// On the cylinder u runs around in front, and along the axis behind, the other way.
static void tangents_run_along_u_and_know_mirrors(void** state) {
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        ruga_mesh mesh;
        make_cylinder(64, 8, mirrored, &mesh);
        renderer r = make_renderer(&mesh, 0, NULL);
        for (int f = 0; f < mesh.triangle_count; f++) {
            bool front = f < mesh.triangle_count / 2;
            assert_int_equal(r.sign[f], front ? 1 : mirrored ? -1 : 1);
            for (int i = 0; i < 3; i++) {
                const double *x = mesh.position + 3 * mesh.triangle[3 * f + i],
                             *t = r.tangent + 9 * f + 3 * i;
                const double wanted[3] = {front ? -x[1] / RADIUS : 0, front ? x[0] / RADIUS : 0,
                                          front ? 0 : -1};
                assert_near(ruga_norm(t), 1, 1e-14);
                assert_near(ruga_dot(t, r.normal + 3 * mesh.triangle[3 * f + i]), 0, 1e-14);
                assert_true(ruga_distance(t, wanted) < 0.06); // one-sided at seams: half an edge
            }
        }
        free_renderer(&r);
        ruga_mesh_clear(&mesh);
    }
}

// ---- atlas -----------------------------------------------------------------------------------------------

static void texels_show_the_place_of_their_centre(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_atlas atlas;
    make_cylinder(16, 4, false, &mesh);
    assert_ok(ruga_atlas_create("it", &mesh, 64, 48, &atlas));
    double area = 0;
    for (int row = 0; row < 48; row++) {
        for (int column = 0; column < 64; column++) {
            int f = atlas.triangle[row * 64 + column];
            double w[3], u = 0, v = 0;
            if (f < 0) {
                continue;
            }
            ruga_atlas_weights(&atlas, row, column, w);
            for (int i = 0; i < 3; i++) {
                u += w[i] * mesh.uv[2 * mesh.uv_triangle[3 * f + i]];
                v += w[i] * mesh.uv[2 * mesh.uv_triangle[3 * f + i] + 1];
            }
            assert_near(u, (column + 0.5) / 64, 1e-12);
            assert_near(v, 1 - (row + 0.5) / 48, 1e-12);
            area += w[0] >= 0 && w[1] >= 0 && w[2] >= 0;
        }
    }
    assert_near(area / (64 * 48), 0.5 * 0.9 + 0.35 * 0.8, 0.02);
    ruga_atlas_clear(&atlas);
    ruga_mesh_clear(&mesh);
}

static void bad_texture_coordinates_are_refused(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_atlas atlas;
    make_cylinder(16, 4, false, &mesh);
    double kept = mesh.uv[10];
    mesh.uv[10] = 1.2;
    assert_int_equal(ruga_atlas_create("it", &mesh, 64, 64, &atlas), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "outside 0 to 1"));
    mesh.uv[10] = NAN;
    assert_int_equal(ruga_atlas_create("it", &mesh, 64, 64, &atlas), RUGA_BAD_INPUT);
    mesh.uv[10] = kept;
    int corner = mesh.uv_triangle[7];
    mesh.uv_triangle[7] = -1;
    assert_int_equal(ruga_atlas_create("it", &mesh, 64, 64, &atlas), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "triangle 2 has no texture coordinates"));
    mesh.uv_triangle[7] = corner;
    for (int u = mesh.uv_count / 2; u < mesh.uv_count; u++) {
        mesh.uv[2 * u] -= 0.2;
    }
    assert_int_equal(ruga_atlas_create("it", &mesh, 64, 64, &atlas), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "overlap"));
    ruga_release(mesh.uv);
    mesh.uv = NULL;
    assert_int_equal(ruga_atlas_create("it", &mesh, 64, 64, &atlas), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "no texture coordinates"));
    ruga_mesh_clear(&mesh);
}

static void dilation_keeps_what_is_there_and_reaches_as_far_as_told(void** state) {
    (void)state;
    enum { N = 32 };
    ruga_atlas atlas = {.width = N, .height = N};
    float pixel[N * N] = {0};
    bool filled[N * N] = {false};
    pixel[10 * N + 10] = 3;
    filled[10 * N + 10] = true;
    assert_ok(ruga_atlas_fill(&atlas, 4, 1, filled, pixel));
    for (int i = 0; i < N * N; i++) {
        bool near = abs(i / N - 10) <= 4 && abs(i % N - 10) <= 4;
        assert_int_equal(filled[i], near);
        assert_true(pixel[i] == (near ? 3 : 0));
    }
}

// ---- tension and ambient occlusion -----------------------------------------------------------------------

static void tension_of_an_affine_map_is_its_stretches(void** state) {
    (void)state;
    ruga_mesh mesh;
    make_cylinder(16, 4, false, &mesh);
    double *x = NULL, *value = NULL;
    assert_ok(RUGA_NEW(x, 3 * mesh.vertex_count));
    assert_ok(RUGA_NEW(value, 3 * mesh.vertex_count));
    for (int v = 0; v < mesh.vertex_count; v++) { // wider around by 5 %, shorter by 20 %, and turned
        const double* p = mesh.position + 3 * v;
        x[3 * v] = 0.8 * p[2];
        x[3 * v + 1] = 1.05 * p[0];
        x[3 * v + 2] = 1.05 * p[1];
    }
    assert_ok(ruga_bake_tension(&mesh, mesh.position, x, value));
    for (int v = 0; v < mesh.vertex_count; v++) {
        assert_near(value[3 * v], 0.05, 1e-12);
        assert_near(value[3 * v + 1], -0.2, 1e-12);
        assert_near(value[3 * v + 2], 1.05 * 0.8 - 1, 1e-12);
    }
    ruga_release(x);
    ruga_release(value);
    ruga_mesh_clear(&mesh);
}

// A floor beside a long wall of height h: at the distance d it sees (1 + d / sqrt(d^2 + h^2)) / 2 of the sky.
static void ambient_occlusion_beside_a_wall_is_its_closed_form(void** state) {
    (void)state;
    enum { SIZE = 16 };
    double position[8][3] = {{0, -1, 0},  {2, -1, 0},   {2, 1, 0},    {0, 1, 0},
                             {0, 300, 0}, {0, -300, 0}, {0, -300, 1}, {0, 300, 1}};
    int triangle[12] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    double uv[8][2] = {{0, 0}, {1, 0}, {1, 0.5}, {0, 0.5}, {0, 0.6}, {1, 0.6}, {1, 1}, {0, 1}};
    ruga_mesh mesh = {.vertex_count = 8,
                      .position = position[0],
                      .triangle_count = 4,
                      .triangle = triangle,
                      .uv_count = 8,
                      .uv = uv[0],
                      .uv_triangle = triangle};
    ruga_atlas atlas;
    float pixel[3 * SIZE * SIZE];
    ruga_bake_report report;
    assert_ok(ruga_atlas_create("it", &mesh, SIZE, SIZE, &atlas));
    ruga_bake_def def = {.map = RUGA_BAKE_AO,
                         .atlas = &atlas,
                         .base = mesh.position,
                         .fine = &mesh,
                         .detail = mesh.position,
                         .sky = INFINITY,
                         .samples = 4096};
    assert_ok(ruga_bake(&def, pixel, &report));
    for (int column = 0; column < SIZE; column++) {
        double d = 2 * (column + 0.5) / SIZE;
        for (int row = SIZE / 2 + 1; row < SIZE; row++) {
            assert_near((double)pixel[3 * (row * SIZE + column)], 0.5 * (1 + d / hypot(d, 1)), 0.01);
        }
    }
    def.sky = 0.05; // nothing is so near
    assert_ok(ruga_bake(&def, pixel, &report));
    assert_true(pixel[3 * ((SIZE - 1) * SIZE + 4)] == 1);
    ruga_atlas_clear(&atlas);
}

// ---- few maps for many frames ----------------------------------------------------------------------------

enum { FRAMES = 9, NUMBERS = 40 };

static void multiply_frames(const double* frame, double product[FRAMES * FRAMES]) {
    for (int i = 0; i < FRAMES * FRAMES; i++) {
        product[i] = 0;
        for (int k = 0; k < NUMBERS; k++) {
            product[i] += frame[i / FRAMES * NUMBERS + k] * frame[i % FRAMES * NUMBERS + k];
        }
    }
}

// Distance of the frames to what maps and weights make of them.
static double blend_error(const ruga_blend* blend, const double* frame, int f) {
    double sum = 0;
    for (int k = 0; k < NUMBERS; k++) {
        double value = 0;
        for (int m = 0; m < blend->maps; m++) {
            double map = 0;
            for (int g = 0; g < FRAMES; g++) {
                map += blend->mixture[g * blend->maps + m] * frame[g * NUMBERS + k];
            }
            value += blend->weight[f * blend->maps + m] * map;
        }
        sum += (value - frame[f * NUMBERS + k]) * (value - frame[f * NUMBERS + k]);
    }
    return sqrt(sum);
}

static void frames_of_few_maps_are_blended_exactly_and_others_as_told(void** state) {
    (void)state;
    ruga_random random = {3};
    double part[3 * NUMBERS], frame[FRAMES * NUMBERS], product[FRAMES * FRAMES];
    for (int i = 0; i < 3 * NUMBERS; i++) {
        part[i] = 2 * ruga_random_uniform(&random) - 1;
    }
    for (int f = 0; f < FRAMES; f++) { // the parts come one after another, and stay
        for (int k = 0; k < NUMBERS; k++) {
            frame[f * NUMBERS + k] = 0;
            for (int m = 0; m < 3; m++) {
                frame[f * NUMBERS + k] += fmax(0, fmin(1, f / 2.0 - m)) * part[m * NUMBERS + k];
            }
        }
    }
    multiply_frames(frame, product);
    double last = 2;
    for (int maps = 1; maps <= 4; maps++) {
        ruga_blend blend;
        double worst = 0, largest = 0, sum = 0;
        assert_ok(ruga_blend_create(FRAMES, product, maps, &blend));
        for (int f = 0; f < FRAMES; f++) {
            largest = fmax(largest, sqrt(product[f * FRAMES + f]));
        }
        for (int f = 0; f < FRAMES; f++) {
            double error = blend_error(&blend, frame, f) / largest;
            assert_near(error, blend.error[f], 1e-6);
            worst = fmax(worst, error);
            sum += error * error;
        }
        for (int m = 0; m < maps; m++) {
            double top = 0;
            for (int f = 0; f < FRAMES; f++) {
                assert_true(blend.weight[f * maps + m] >= 0);
                top = fmax(top, blend.weight[f * maps + m]);
            }
            assert_true(maps > 3 || top == 1);
        }
        assert_true(sum <= last + 1e-12);
        last = sum;
        assert_true(maps < 3 ? worst > 0.05 : worst < 1e-5);
        ruga_blend_clear(&blend);
    }
}

static void frames_without_anything_in_them_are_no_trouble(void** state) {
    (void)state;
    double product[FRAMES * FRAMES] = {0};
    ruga_blend blend;
    assert_ok(ruga_blend_create(FRAMES, product, 2, &blend));
    for (int i = 0; i < 2 * FRAMES; i++) {
        assert_true(isfinite(blend.weight[i]) && isfinite(blend.mixture[i]));
    }
    ruga_blend_clear(&blend);
}

static void each_allocation_may_fail(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_atlas atlas;
    float* pixel;
    ruga_bake_report report;
    make_cylinder(16, 4, false, &mesh);
    double* fine = make_wrinkles(&mesh, 0);
    assert_ok(RUGA_NEW(pixel, 3 * 64 * 64));
    int k = 0;
    for (ruga_status status = RUGA_NO_MEMORY; status != RUGA_OK; k++) {
        size_t before = ruga_byte_count();
        let_allocations_fail_after(k);
        status = ruga_atlas_create("it", &mesh, 64, 64, &atlas);
        ruga_bake_def def = {
            .atlas = &atlas, .base = mesh.position, .fine = &mesh, .detail = fine, .margin = 4};
        bool made = status == RUGA_OK;
        status = made ? ruga_bake(&def, pixel, &report) : status;
        ruga_set_allocator(NULL, NULL, NULL);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        if (made) {
            ruga_atlas_clear(&atlas);
        }
        assert_int_equal(ruga_byte_count(), before);
    }
    assert_true(k > 10);
    ruga_release(pixel);
    ruga_release(fine);
    ruga_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_vector_map_brings_back_the_surface_seams_included),
        cmocka_unit_test(rays_from_a_coarse_mesh_bring_back_the_surface),
        cmocka_unit_test(a_normal_map_brings_back_the_normals),
        cmocka_unit_test(tangents_run_along_u_and_know_mirrors),
        cmocka_unit_test(texels_show_the_place_of_their_centre),
        cmocka_unit_test(bad_texture_coordinates_are_refused),
        cmocka_unit_test(dilation_keeps_what_is_there_and_reaches_as_far_as_told),
        cmocka_unit_test(tension_of_an_affine_map_is_its_stretches),
        cmocka_unit_test(ambient_occlusion_beside_a_wall_is_its_closed_form),
        cmocka_unit_test(frames_of_few_maps_are_blended_exactly_and_others_as_told),
        cmocka_unit_test(frames_without_anything_in_them_are_no_trouble),
        cmocka_unit_test(each_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
