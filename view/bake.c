// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A texel shows the base point p = sum w_i p_i, with the frame that a renderer has there: n = sum w_i n_i, t
// = sum w_i t_i, b = sign (n x t), not made unit (view/tangent.c). The fine point x is that of the same
// weights, or the nearest hit of the rays p + s n, both ways. Displacement c solves [t b n] c = x - p, so
// that p + c_1 t + c_2 b + c_3 n is x exactly; a normal m likewise, made unit. Beyond a chart's border all of
// it continues linearly.
#include "view/bake.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/vec3.h"
#include "view/ray.h"
#include "view/tangent.h"

#include <math.h>
#include <string.h>

enum { ROWS = 4 }; // of a chunk

typedef struct job {
    const ruga_bake_def* def;
    double *base_normal, *fine_normal; // [V][3], [fine V][3]
    double* tangent;
    signed char* sign;
    ruga_ray_scene* scene; // of the fine surface; NULL where no ray is cast
    double lift;           // m: rays for occlusion begin so far above the surface
    float* pixel;
    bool* filled;
    ruga_bake_report* part; // of each chunk
} job;

static void mix(const double* value, const int* vertex, const double weight[3], double sum[3]) {
    sum[0] = sum[1] = sum[2] = 0;
    for (int i = 0; i < 3; i++) {
        ruga_add_scaled(weight[i], value + 3 * (size_t)vertex[i], sum);
    }
}

// What a texel shows.
typedef struct place {
    double point[3], frame[3][3]; // of the base; t, b, n
    int triangle;                 // of the fine surface
    double weight[3];             // there
    double detail[3], normal[3];  // of the fine surface
} place;

static bool meet_fine_surface(const job* j, place* at) {
    double up[3];
    memcpy(up, at->frame[2], sizeof up);
    if (!(ruga_normalize(up) > 0)) {
        return false;
    }
    ruga_ray_hit best = {.triangle = -1, .distance = INFINITY};
    for (int side = 0; side < 2; side++) {
        ruga_ray ray = {.near = 0, .far = j->def->distance};
        for (int i = 0; i < 3; i++) {
            ray.origin[i] = at->point[i];
            ray.direction[i] = side == 0 ? up[i] : -up[i];
        }
        ruga_ray_hit hit = ruga_ray_closest(j->scene, &ray);
        best = hit.triangle >= 0 && hit.distance < best.distance ? hit : best;
    }
    at->triangle = best.triangle;
    memcpy(at->weight, best.weight, sizeof at->weight);
    return best.triangle >= 0;
}

static bool find_place(const job* j, int row, int column, place* at) {
    const ruga_atlas* atlas = j->def->atlas;
    int triangle = atlas->triangle[(size_t)row * (size_t)atlas->width + (size_t)column];
    const int* vertex = atlas->mesh->triangle + 3 * (size_t)triangle;
    double weight[3];
    static const int own[3] = {0, 1, 2};
    ruga_atlas_weights(atlas, row, column, weight);
    mix(j->def->base, vertex, weight, at->point);
    mix(j->base_normal, vertex, weight, at->frame[2]);
    mix(j->tangent + 9 * (size_t)triangle, own, weight, at->frame[0]);
    ruga_cross(at->frame[2], at->frame[0], at->frame[1]);
    for (int i = 0; i < 3; i++) {
        at->frame[1][i] *= j->sign[triangle];
    }
    if (j->def->fine == atlas->mesh) {
        at->triangle = triangle;
        memcpy(at->weight, weight, sizeof weight);
    } else if (!meet_fine_surface(j, at)) {
        return false;
    }
    const int* fine = j->def->fine->triangle + 3 * (size_t)at->triangle;
    mix(j->def->detail, fine, at->weight, at->detail);
    mix(j->fine_normal, fine, at->weight, at->normal);
    return ruga_normalize(at->normal) > 0;
}

// c with [t b n] c = v, by Cramer's rule.
static void solve_frame(const place* at, const double v[3], double c[3]) {
    double across[3][3];
    for (int i = 0; i < 3; i++) {
        ruga_cross(at->frame[(i + 1) % 3], at->frame[(i + 2) % 3], across[i]);
    }
    double determinant = ruga_dot(at->frame[0], across[0]);
    for (int i = 0; i < 3; i++) {
        c[i] = determinant != 0 ? ruga_dot(v, across[i]) / determinant : 0;
    }
}

// ---- ambient occlusion ---------------------------------------------------------------------------------

// Directions that are distributed as the cosine about n: points of a disc (Hammersley, shifted for each
// texel), raised to the sphere. Those below the facet would meet the facet itself and do not count.
static double see_sky(const job* j, const place* at, uint64_t seed) {
    const int* vertex = j->def->fine->triangle + 3 * (size_t)at->triangle;
    const double* n = at->normal;
    double t[3], b[3], facet[3], axis[3] = {fabs(n[0]) <= 0.6, fabs(n[0]) > 0.6, 0};
    ruga_random random = {seed};
    double shift[2] = {ruga_random_uniform(&random), ruga_random_uniform(&random)};
    int open = 0, counted = 0;
    ruga_cross(n, axis, t);
    ruga_normalize(t);
    ruga_cross(n, t, b);
    ruga_triangle_normal(j->def->detail + 3 * (size_t)vertex[0], j->def->detail + 3 * (size_t)vertex[1],
                         j->def->detail + 3 * (size_t)vertex[2], facet);
    for (int k = 0; k < j->def->samples; k++) {
        double radical = 0, half = 0.5;
        for (int bits = k; bits > 0; bits >>= 1) {
            radical += half * (bits & 1);
            half /= 2;
        }
        double across = fmod((k + 0.5) / j->def->samples + shift[0], 1),
               turn = 2 * RUGA_PI * fmod(radical + shift[1], 1);
        ruga_ray ray = {.near = 0, .far = j->def->sky};
        for (int i = 0; i < 3; i++) {
            ray.origin[i] = at->detail[i] + j->lift * n[i];
            ray.direction[i] =
                sqrt(across) * (cos(turn) * t[i] + sin(turn) * b[i]) + sqrt(fmax(0, 1 - across)) * n[i];
        }
        if (ruga_dot(ray.direction, facet) > 0) {
            counted++;
            open += !ruga_ray_blocked(j->scene, &ray);
        }
    }
    return counted > 0 ? (double)open / counted : 1;
}

// ---- texels --------------------------------------------------------------------------------------------

static void take_displacement(const place* at, double c[3], ruga_bake_report* report) {
    double d[3], up[3];
    ruga_subtract(at->detail, at->point, d);
    solve_frame(at, d, c);
    memcpy(up, at->frame[2], sizeof up);
    ruga_normalize(up);
    double square = ruga_dot(d, d), along = ruga_dot(d, up);
    report->squares += square;
    report->tangential += fmax(0, square - along * along);
}

static void bake_texel(const job* j, int row, int column, ruga_bake_report* report) {
    size_t texel = (size_t)row * (size_t)j->def->atlas->width + (size_t)column;
    place at;
    double c[3] = {0, 0, 0};
    report->texels++;
    if (!find_place(j, row, column, &at)) {
        report->missed++;
        return;
    }
    switch (j->def->map) {
    case RUGA_BAKE_DISPLACEMENT:
        take_displacement(&at, c, report);
        break;
    case RUGA_BAKE_NORMAL:
        solve_frame(&at, at.normal, c);
        ruga_normalize(c);
        break;
    case RUGA_BAKE_TENSION:
        mix(j->def->value, j->def->fine->triangle + 3 * (size_t)at.triangle, at.weight, c);
        break;
    case RUGA_BAKE_AO:
        c[0] = c[1] = c[2] = see_sky(j, &at, texel);
        break;
    }
    for (size_t i = 0; i < 3; i++) {
        report->largest = fmax(report->largest, fabs(c[i]));
        j->pixel[3 * texel + i] = (float)c[i];
    }
    j->filled[texel] = true;
}

static void bake_rows(int begin, int end, int chunk, void* context) {
    job* j = context;
    const ruga_atlas* atlas = j->def->atlas;
    for (int row = begin; row < end; row++) {
        for (int column = 0; column < atlas->width; column++) {
            if (atlas->triangle[(size_t)row * (size_t)atlas->width + (size_t)column] >= 0) {
                bake_texel(j, row, column, &j->part[chunk]);
            }
        }
    }
}

static void clear_pixels(const job* j) {
    const ruga_atlas* atlas = j->def->atlas;
    const float empty[3] = {j->def->map == RUGA_BAKE_AO, j->def->map == RUGA_BAKE_AO,
                            j->def->map == RUGA_BAKE_AO || j->def->map == RUGA_BAKE_NORMAL};
    for (size_t i = 0; i < 3 * (size_t)atlas->width * (size_t)atlas->height; i++) {
        j->pixel[i] = empty[i % 3];
    }
}

static ruga_status prepare(job* j) {
    const ruga_bake_def* def = j->def;
    const ruga_mesh *base = def->atlas->mesh, *fine = def->fine;
    size_t texels = (size_t)def->atlas->width * (size_t)def->atlas->height;
    RUGA_TRY(RUGA_NEW(j->base_normal, 3 * (size_t)base->vertex_count));
    RUGA_TRY(RUGA_NEW(j->fine_normal, 3 * (size_t)fine->vertex_count));
    ruga_mesh_vertex_normals(base, def->base, j->base_normal);
    ruga_mesh_vertex_normals(fine, def->detail, j->fine_normal);
    RUGA_TRY(ruga_tangents_create(base, def->base, j->base_normal, &j->tangent, &j->sign));
    if (fine != base || def->map == RUGA_BAKE_AO) {
        double edge = ruga_mesh_mean_edge(fine);
        j->lift = 1e-4 * edge;
        for (size_t i = 0; i < 3 * (size_t)fine->vertex_count; i++) {
            j->lift = fmax(j->lift,
                           1e-6 * fabs(def->detail[i] - def->detail[i % 3])); // rays are in single precision
        }
        RUGA_TRY(ruga_ray_scene_create(fine->vertex_count, def->detail, fine->triangle_count, fine->triangle,
                                       &j->scene));
    }
    RUGA_TRY(RUGA_NEW_ZERO(j->filled, texels));
    return RUGA_NEW_ZERO(j->part, ruga_chunk_count(def->atlas->height, ROWS));
}

static ruga_status bake(job* j, ruga_bake_report* report) {
    const ruga_atlas* atlas = j->def->atlas;
    RUGA_TRY(prepare(j));
    clear_pixels(j);
    ruga_parallel_for(atlas->height, ROWS, bake_rows, j);
    *report = (ruga_bake_report){0};
    for (int chunk = 0; chunk < ruga_chunk_count(atlas->height, ROWS); chunk++) {
        const ruga_bake_report* part = &j->part[chunk];
        report->texels += part->texels;
        report->missed += part->missed;
        report->largest = fmax(report->largest, part->largest);
        report->squares += part->squares;
        report->tangential += part->tangential;
    }
    if (report->missed == report->texels) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "no ray from the target meets the surface within %g m: does it have the mesh's place and unit?",
            j->def->distance);
    }
    return ruga_atlas_fill(atlas, j->def->margin, 3, j->filled, j->pixel);
}

ruga_status ruga_bake(const ruga_bake_def* def, float* pixel, ruga_bake_report* report) {
    job j = {.def = def, .pixel = pixel};
    ruga_status status = bake(&j, report);
    ruga_release(j.base_normal);
    ruga_release(j.fine_normal);
    ruga_release(j.tangent);
    ruga_release(j.sign);
    ruga_ray_scene_destroy(&j.scene);
    ruga_release(j.filled);
    ruga_release(j.part);
    return status;
}

// ---- tension -------------------------------------------------------------------------------------------

// Principal stretches squared: eigenvalues of G^-1 g, metrics of two edges at rest and now.
static double triangle_tension(const int* t, const double* rest, const double* position, double tension[3]) {
    double m[2][3];
    for (int k = 0; k < 2; k++) {
        const double* x = k == 0 ? rest : position;
        double a[3], b[3];
        ruga_subtract(x + 3 * (size_t)t[1], x + 3 * (size_t)t[0], a);
        ruga_subtract(x + 3 * (size_t)t[2], x + 3 * (size_t)t[0], b);
        m[k][0] = ruga_dot(a, a);
        m[k][1] = ruga_dot(a, b);
        m[k][2] = ruga_dot(b, b);
    }
    double before = m[0][0] * m[0][2] - m[0][1] * m[0][1], now = m[1][0] * m[1][2] - m[1][1] * m[1][1];
    double half = (m[0][2] * m[1][0] - 2 * m[0][1] * m[1][1] + m[0][0] * m[1][2]) / (2 * before);
    double root = sqrt(fmax(0, half * half - now / before));
    tension[0] = sqrt(half + root) - 1;
    tension[1] = sqrt(fmax(0, half - root)) - 1;
    tension[2] = sqrt(fmax(0, now / before)) - 1;
    return before > 0 ? sqrt(before) : 0;
}

ruga_status ruga_bake_tension(const ruga_mesh* mesh, const double* rest, const double* position,
                              double* value) {
    double* total = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(total, mesh->vertex_count));
    memset(value, 0, 3 * (size_t)mesh->vertex_count * sizeof *value);
    for (size_t f = 0; f < (size_t)mesh->triangle_count; f++) {
        const int* t = mesh->triangle + 3 * f;
        double tension[3], area = triangle_tension(t, rest, position, tension);
        for (int i = 0; area > 0 && i < 3; i++) {
            total[t[i]] += area;
            ruga_add_scaled(area, tension, value + 3 * (size_t)t[i]);
        }
    }
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++) {
        value[i] = total[i / 3] > 0 ? value[i] / total[i / 3] : 0;
    }
    ruga_release(total);
    return RUGA_OK;
}
