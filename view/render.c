// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A pixel is the mean over samples of light that comes from the surface seen there:
//     tint (key k + sky s) + gloss,   key k = V_l max(n.l, 0) over a round light,   s = mean over the
//     half-sphere of V L,
// with V by rays, L brighter towards the zenith, and where V = 0 the little that such a surface sends back.
// Pixels whose samples see several surfaces get four times as many. The light's grain, not the tint, is then
// smoothed among pixels of the same surface and about the same normal (H. Dammertz et al., Edge-avoiding
// A-Trous wavelet transform for fast global illumination filtering, 2010). Each pixel has its own seeded
// random numbers, so that the picture does not depend on the number of threads.
#include "view/render.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/vec3.h"
#include "view/legend.h"
#include "view/light.h"
#include "view/normals.h"

#include <png.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SKY_RAYS = 6, ROWS = 4, PIXELS_MIN = 16, PIXELS_MAX = 16384, SMOOTHINGS = 3 };

typedef enum surface_kind { BACKDROP, FLOOR, OBJECT } surface_kind;

// What a ray from the eye meets.
typedef struct surface {
    surface_kind kind;
    double x[3], n[3]; // point, moved off the surface, and smooth normal on the side of the eye
    double distance;
    double tint[3];
} surface;

// The mean of a pixel's samples. Light and gloss are kept apart from the tint for the smoothing.
typedef struct pixel_light {
    float tint[3], light[3], gloss[3], n[3], distance, covered;
    bool mixed; // of several surfaces: `light` is then the mean of developed colours
    unsigned char kind;
} pixel_light;

typedef struct scene {
    const ruga_mesh* mesh;
    const ruga_render_def* def;
    const double* position;
    double* normal; // [F][3][3] at the corners of each face
    ruga_ray_scene* rays;
    ruga_camera camera;
    double zenith[3]; // where the sky is brightest
    double key[3];    // direction to the light
    double near;      // m, that rays start off a surface
    double key_color[3], sky_color[3], clay[3];
    double middle[3];   // on the floor, under the object
    pixel_light* pixel; // [height][width]
    pixel_light* spare;
    int step; // of the smoothing
    ruga_picture* picture;
} scene;

ruga_render_def ruga_default_render_def(void) {
    return (ruga_render_def){.width = 1280,
                             .height = 720,
                             .samples = 2,
                             .azimuth = -1.1,
                             .elevation = 0.6,
                             .up = {0, 0, 1},
                             .fit = 0.86,
                             .scale_bar = true};
}

// ---- setting up ----------------------------------------------------------------------------------------

static void set_camera(scene* s) {
    const ruga_render_def* def = s->def;
    ruga_view view = {.azimuth = def->azimuth,
                      .elevation = def->elevation,
                      .up = {def->up[0], def->up[1], def->up[2]},
                      .fit = def->fit,
                      .foot = ruga_legend_foot(def),
                      .turns = def->turns};
    ruga_camera_frame(def->extent ? RUGA_EXTENT_POINTS : s->mesh->vertex_count,
                      def->extent ? def->extent->point[0] : s->position, &view, def->width, def->height,
                      &s->camera);
    ruga_camera* c = &s->camera;
    c->ground -= 2e-3 * c->size;
    s->near = 3e-4 * c->size;
    for (int k = 0; k < 3; k++) {
        s->middle[k] = c->eye[k] + c->distance * c->forward[k];
    }
    ruga_add_scaled(c->ground - ruga_dot(s->middle, c->axis), c->axis, s->middle);
}

// From the left and low enough to graze the wrinkles; more from the front where the camera stands low, and
// from below where it looks from under the floor. Values are shown under white light.
static void set_lights(scene* s) {
    static const double warm[3] = {3.1, 2.9, 2.65}, cool[3] = {0.66, 0.70, 0.76},
                        neutral[3] = {2.9, 2.9, 2.9}, grey[3] = {0.9, 0.9, 0.9},
                        clay[3] = {0.46, 0.315, 0.235};
    const ruga_camera* c = &s->camera;
    bool values = s->def->scalar.value || s->def->place || s->def->lines.value;
    double right = ruga_norm(c->right), sign = ruga_dot(c->eye, c->axis) < c->ground ? -1 : 1;
    double from_behind = fmin(1.2 * sign * -ruga_dot(c->forward, c->axis) - 0.5, 0.2);
    for (int k = 0; k < 3; k++) {
        s->zenith[k] = sign * c->axis[k];
        s->key[k] = -0.85 * c->right[k] / right + 0.45 * s->zenith[k] + from_behind * c->forward[k];
    }
    (void)ruga_normalize(s->key);
    memcpy(s->key_color, values ? neutral : warm, sizeof warm);
    memcpy(s->sky_color, values ? grey : cool, sizeof cool);
    memcpy(s->clay, clay, sizeof clay);
}

// ---- what is seen --------------------------------------------------------------------------------------

// Pixels from p to the segment between the projections of two points.
static double line_distance(const scene* s, const double p[2], const double* a, const double* b) {
    double pa[2], pb[2];
    ruga_camera_project(&s->camera, a, pa);
    ruga_camera_project(&s->camera, b, pb);
    double d[2] = {pb[0] - pa[0], pb[1] - pa[1]}, e[2] = {p[0] - pa[0], p[1] - pa[1]};
    double length = d[0] * d[0] + d[1] * d[1];
    double t = length > 0 ? fmin(fmax((e[0] * d[0] + e[1] * d[1]) / length, 0), 1) : 0;
    return hypot(e[0] - t * d[0], e[1] - t * d[1]);
}

static void map_color(const ruga_scale* scale, double value, double color[3]) {
    double range = scale->max - scale->min;
    ruga_colormap(scale->map, range > 0 ? (value - scale->min) / range : 0.5, color);
}

// The line's colour where the point at x is on one: those that carry values are wider.
static void draw_lines(const scene* s, const ruga_ray_hit* hit, const double x[3], double color[3]) {
    const ruga_render_def* def = s->def;
    const int* t = s->mesh->triangle + 3 * (size_t)hit->triangle;
    double pixel[2], thin = fmax(0.45, 0.00055 * def->height), wide = fmax(1, 0.0032 * def->height);
    bool lines = def->line && def->draw_lines;
    if (!def->wireframe && !lines) {
        return;
    }
    ruga_camera_project(&s->camera, x, pixel);
    for (int k = 0; k < 3; k++) {
        int line = lines ? def->line[3 * (size_t)hit->triangle + (size_t)k] : -1;
        if (line < 0 && !def->wireframe) {
            continue;
        }
        double d =
            line_distance(s, pixel, s->position + 3 * (size_t)t[k], s->position + 3 * (size_t)t[(k + 1) % 3]);
        if (line >= 0 && d < wide) {
            static const double dark[3] = {0.02, 0.02, 0.03};
            memcpy(color, dark, sizeof dark);
            if (def->lines.value) {
                map_color(&def->lines, def->lines.value[line], color);
            }
            return;
        }
        if (def->wireframe && d < thin) {
            for (int i = 0; i < 3; i++) {
                color[i] *= 0.22;
            }
            return;
        }
    }
}

static void surface_tint(const scene* s, const ruga_ray_hit* hit, const double x[3], double color[3]) {
    const ruga_render_def* def = s->def;
    const int* t = s->mesh->triangle + 3 * (size_t)hit->triangle;
    const double* b = hit->weight;
    memcpy(color, s->clay, 3 * sizeof *color);
    if (def->scalar.value) {
        const double* value = def->scalar.value;
        map_color(&def->scalar, b[0] * value[t[0]] + b[1] * value[t[1]] + b[2] * value[t[2]], color);
    } else if (def->place) {
        ruga_colormap_place(def->place[t[b[0] >= b[1] ? (b[0] >= b[2] ? 0 : 2) : (b[1] >= b[2] ? 1 : 2)]],
                            color);
    } else if (def->lines.value) {
        static const double paper[3] = {0.62, 0.62, 0.62};
        memcpy(color, paper, sizeof paper);
    }
    draw_lines(s, hit, x, color);
}

static void see_object(const scene* s, const ruga_ray* ray, const ruga_ray_hit* hit, surface* seen) {
    const int* t = s->mesh->triangle + 3 * (size_t)hit->triangle;
    const double* corner[3];
    double flat[3], x[3] = {0, 0, 0}, *n = seen->n;
    *seen = (surface){.kind = OBJECT, .distance = hit->distance};
    for (int k = 0; k < 3; k++) {
        corner[k] = s->position + 3 * (size_t)t[k];
        ruga_add_scaled(hit->weight[k], s->normal + 9 * (size_t)hit->triangle + 3 * (size_t)k, n);
        ruga_add_scaled(hit->weight[k], corner[k], x);
    }
    ruga_triangle_normal(corner[0], corner[1], corner[2], flat);
    double sign = ruga_dot(flat, ray->direction) > 0 ? -1 : 1;
    (void)ruga_normalize(flat);
    (void)ruga_normalize(n);
    // Across a sharp rim the smooth normal may point into the surface: it is turned to the face's side.
    double side = sign * ruga_dot(n, flat), part = fmin(fabs(side) / 0.5, 1);
    for (int k = 0; k < 3; k++) {
        n[k] = sign * (part * n[k] * (side * sign < 0 ? -1 : 1) + (1 - part) * flat[k]);
        seen->x[k] = x[k] + sign * s->near * flat[k];
    }
    (void)ruga_normalize(n);
    surface_tint(s, hit, x, seen->tint);
}

static void see(const scene* s, const ruga_ray* ray, surface* seen) {
    const ruga_camera* c = &s->camera;
    ruga_ray_hit hit = ruga_ray_closest(s->rays, ray);
    if (hit.triangle >= 0) {
        see_object(s, ray, &hit, seen);
        return;
    }
    double down = -ruga_dot(ray->direction, c->axis), height = ruga_dot(ray->origin, c->axis) - c->ground;
    *seen = (surface){.kind = BACKDROP, .distance = INFINITY};
    if (down > 1e-6 && height > 0) {
        seen->kind = FLOOR;
        seen->distance = height / down;
        for (int k = 0; k < 3; k++) {
            seen->x[k] = ray->origin[k] + seen->distance * ray->direction[k];
            seen->n[k] = c->axis[k];
            seen->tint[k] = 0.62;
        }
    }
}

// ---- light ---------------------------------------------------------------------------------------------

// Light of the sky from direction d: brighter above, and below the horizon what the floor sends back.
static double sky_light(const scene* s, const double d[3]) {
    double height = ruga_dot(d, s->zenith);
    return height > 0 ? 0.62 + 0.5 * height : 0.62 + 0.32 * fmax(height, -1);
}

static double key_light(const scene* s, const surface* seen, ruga_random* random) {
    double radius = 0.13 * sqrt(ruga_random_uniform(random)),
           turn = 2 * RUGA_PI * ruga_random_uniform(random);
    const ruga_camera* c = &s->camera;
    ruga_ray ray = {.near = s->near, .far = INFINITY};
    double u[3], v[3];
    ruga_cross(s->key, c->axis, u);
    (void)ruga_normalize(u);
    ruga_cross(s->key, u, v);
    for (int k = 0; k < 3; k++) {
        ray.origin[k] = seen->x[k];
        ray.direction[k] = s->key[k] + radius * (cos(turn) * u[k] + sin(turn) * v[k]);
    }
    (void)ruga_normalize(ray.direction);
    double facing = ruga_dot(seen->n, ray.direction);
    return facing > 0 && !ruga_ray_blocked(s->rays, &ray) ? facing : 0;
}

// `first`: how many of the pixel's sky rays came before.
static double sky(const scene* s, const surface* seen, int first, const double shift[2]) {
    const double sent_back = 0.2; // of the light that falls on another part of the surface
    double sum = 0, direction[SKY_RAYS][3];
    ruga_ray ray = {.origin = {seen->x[0], seen->x[1], seen->x[2]}, .near = s->near, .far = INFINITY};
    ruga_light_directions(seen->n, first, SKY_RAYS, shift, direction);
    for (int j = 0; j < SKY_RAYS; j++) {
        memcpy(ray.direction, direction[j], sizeof direction[j]);
        double light = sky_light(s, ray.direction);
        sum += ruga_ray_blocked(s->rays, &ray) ? (seen->kind == OBJECT ? sent_back * light : 0) : light;
    }
    return sum / SKY_RAYS;
}

// A dull sheen of the key light, and a little of the sky at grazing angles.
static double sheen(const scene* s, const surface* seen, const double toward[3], double key,
                    double sky_part) {
    double half[3];
    for (int k = 0; k < 3; k++) {
        half[k] = s->key[k] - toward[k];
    }
    (void)ruga_normalize(half);
    double facing = fmax(-ruga_dot(seen->n, toward), 0), rim = 1 - facing;
    return 0.10 * key * pow(fmax(ruga_dot(seen->n, half), 0), 18) + 0.16 * sky_part * rim * rim * rim * rim;
}

// What the backdrop shows: the floor in full light, darker towards the top and the corners of the picture.
static void studio(const double color[3], double u, double v, double shown[3]) {
    double dim = 1 - 0.13 * (u * u + v * v) - 0.05 * (v + 1);
    for (int k = 0; k < 3; k++) {
        shown[k] = color[k] * dim;
    }
}

typedef struct sample_light {
    double tint[3], light[3], gloss[3];
} sample_light;

static void shade(const scene* s, const surface* seen, const ruga_ray* ray, double u, double v, int place,
                  const double shift[2], ruga_random* random, sample_light* out) {
    double open[3], floor_light[3], key_facing = fmax(ruga_dot(s->key, s->zenith), 0);
    *out = (sample_light){.tint = {0, 0, 0}};
    for (int k = 0; k < 3; k++) {
        floor_light[k] = 0.62 * (s->key_color[k] * key_facing + s->sky_color[k] * 0.95);
    }
    studio(floor_light, u, v, open);
    if (seen->kind == BACKDROP) {
        memcpy(out->gloss, open, sizeof open);
        return;
    }
    double key = key_light(s, seen, random), blue = sky(s, seen, place * SKY_RAYS, shift);
    memcpy(out->tint, seen->tint, sizeof seen->tint);
    for (int k = 0; k < 3; k++) {
        out->light[k] = s->key_color[k] * key + s->sky_color[k] * blue;
    }
    if (seen->kind == FLOOR) {
        // The floor goes over into the backdrop with the distance from the object.
        double fade = fmin(fmax((ruga_distance(seen->x, s->middle) / s->camera.size - 0.6) / 1.8, 0), 1);
        fade = fade * fade * (3 - 2 * fade);
        for (int k = 0; k < 3; k++) {
            double full = floor_light[k] / 0.62;
            out->tint[k] = open[k] / full * (1 - fade);
            out->gloss[k] = open[k] * fade;
        }
        return;
    }
    bool values = s->def->scalar.value || s->def->place || s->def->lines.value;
    double gloss = (values ? 0.4 : 1) * sheen(s, seen, ray->direction, key, blue);
    for (int k = 0; k < 3; k++) {
        out->gloss[k] = gloss * s->key_color[k];
    }
}

// ---- a pixel -------------------------------------------------------------------------------------------

// Bright values are held together, dark and middle ones nearly kept: L (1 + L / 9) / (1 + L) of the
// brightness L.
static void develop(double light[3]) {
    double bright = 0.2126 * light[0] + 0.7152 * light[1] + 0.0722 * light[2];
    for (int k = 0; k < 3; k++) {
        light[k] *= (1 + bright / 9) / (1 + bright);
    }
}

typedef struct pixel_sum {
    sample_light sum;
    double finished[3], n[3], distance;
    int count, kinds[3];
    bool bends; // the normals of the samples differ
} pixel_sum;

static void take_samples(const scene* s, int row, int column, int per_axis, ruga_random* random,
                         pixel_sum* p) {
    const ruga_camera* c = &s->camera;
    double shift[2] = {ruga_random_uniform(random), ruga_random_uniform(random)};
    for (int k = 0; k < per_axis * per_axis; k++) {
        double u = 2 * (column + (k % per_axis + ruga_random_uniform(random)) / per_axis) / c->width - 1;
        double v = 1 - 2 * (row + ((int)(k / per_axis) + ruga_random_uniform(random)) / per_axis) / c->height;
        ruga_ray ray = {.origin = {c->eye[0], c->eye[1], c->eye[2]}, .far = INFINITY};
        surface seen;
        sample_light light;
        double all[3];
        for (int i = 0; i < 3; i++) {
            ray.direction[i] = c->forward[i] + u * c->right[i] + v * c->up[i];
        }
        (void)ruga_normalize(ray.direction);
        see(s, &ray, &seen);
        shade(s, &seen, &ray, u, v, k, shift, random, &light);
        p->bends = p->bends || (p->count > 0 && ruga_dot(p->n, seen.n) < 0.7 * p->count);
        p->count++;
        p->kinds[seen.kind]++;
        p->distance += seen.kind == BACKDROP ? 0 : seen.distance;
        for (int i = 0; i < 3; i++) {
            p->n[i] += seen.n[i];
            p->sum.tint[i] += light.tint[i];
            p->sum.light[i] += light.light[i];
            p->sum.gloss[i] += light.gloss[i];
            all[i] = light.tint[i] * light.light[i] + light.gloss[i];
        }
        develop(all);
        ruga_add_scaled(1, all, p->finished);
    }
}

static bool is_mixed(const pixel_sum* p) {
    int most = p->kinds[0] > p->kinds[1] ? p->kinds[0] : p->kinds[1];
    return p->bends || (most < p->kinds[2] ? p->kinds[2] : most) < p->count;
}

static void finish_pixel(const scene* s, int row, int column) {
    ruga_random random = {.state = ((uint64_t)row << 32) + (uint64_t)column};
    (void)ruga_random_next(&random);
    pixel_sum p = {.count = 0};
    take_samples(s, row, column, s->def->samples, &random, &p);
    if (is_mixed(&p)) {
        take_samples(s, row, column, 2 * s->def->samples, &random, &p);
    }
    pixel_light* out = s->pixel + (size_t)row * (size_t)s->camera.width + (size_t)column;
    *out = (pixel_light){.mixed = is_mixed(&p),
                         .kind = (unsigned char)(p.kinds[OBJECT] > 0  ? OBJECT
                                                 : p.kinds[FLOOR] > 0 ? FLOOR
                                                                      : BACKDROP),
                         .distance = (float)(p.distance / p.count),
                         .covered = (float)p.kinds[OBJECT] / (float)p.count};
    (void)ruga_normalize(p.n);
    for (int i = 0; i < 3; i++) {
        out->n[i] = (float)p.n[i];
        out->tint[i] = (float)(p.sum.tint[i] / p.count);
        out->gloss[i] = (float)(p.sum.gloss[i] / p.count);
        out->light[i] = (float)((out->mixed ? p.finished[i] : p.sum.light[i]) / p.count);
    }
}

static void trace_rows(int begin, int end, int chunk, void* context) {
    const scene* s = context;
    (void)chunk;
    for (int row = begin; row < end; row++) {
        for (int column = 0; column < s->camera.width; column++) {
            finish_pixel(s, row, column);
        }
    }
}

// ---- smoothing -----------------------------------------------------------------------------------------

// How much the light at pixel b tells about that at a.
static float likeness(const scene* s, const pixel_light* a, const pixel_light* b) {
    if (b->mixed || b->kind != a->kind) {
        return 0;
    }
    float cosine = a->n[0] * b->n[0] + a->n[1] * b->n[1] + a->n[2] * b->n[2];
    float apart = (a->distance - b->distance) / (0.02F * (float)s->camera.size);
    if (cosine <= 0.8F || (a->kind == OBJECT && fabsf(apart) > 1)) {
        return 0;
    }
    for (int i = 0; i < 6; i++) {
        cosine *= cosine; // to the power of 64
    }
    return cosine;
}

static void smooth_rows(int begin, int end, int chunk, void* context) {
    static const float weight[3] = {0.375F, 0.25F, 0.0625F}; // of a cubic B-spline
    const scene* s = context;
    (void)chunk;
    int w = s->camera.width, h = s->camera.height;
    for (int row = begin; row < end; row++) {
        for (int column = 0; column < w; column++) {
            const pixel_light* a = s->pixel + (size_t)row * (size_t)w + (size_t)column;
            pixel_light* out = s->spare + (size_t)row * (size_t)w + (size_t)column;
            float sum[3] = {0, 0, 0}, all = 0;
            *out = *a;
            for (int k = 0; k < 25 && !a->mixed && a->kind != BACKDROP; k++) {
                int i = k / 5 - 2, j = k % 5 - 2, y = row + s->step * i, x = column + s->step * j;
                if (y < 0 || y >= h || x < 0 || x >= w) {
                    continue;
                }
                const pixel_light* b = s->pixel + (size_t)y * (size_t)w + (size_t)x;
                float part = weight[i < 0 ? -i : i] * weight[j < 0 ? -j : j] * likeness(s, a, b);
                all += part;
                for (int c = 0; c < 3; c++) {
                    sum[c] += part * b->light[c];
                }
            }
            for (int c = 0; c < 3 && all > 0; c++) {
                out->light[c] = sum[c] / all;
            }
        }
    }
}

static void develop_rows(int begin, int end, int chunk, void* context) {
    const scene* s = context;
    (void)chunk;
    for (size_t p = (size_t)begin * (size_t)s->camera.width; p < (size_t)end * (size_t)s->camera.width; p++) {
        const pixel_light* a = s->pixel + p;
        double light[3];
        for (int c = 0; c < 3; c++) {
            light[c] = a->mixed ? (double)a->light[c] : (double)(a->tint[c] * a->light[c] + a->gloss[c]);
        }
        if (!a->mixed) {
            develop(light);
        }
        for (int c = 0; c < 3; c++) {
            s->picture->pixel[3 * p + (size_t)c] = ruga_srgb(light[c]);
        }
        s->picture->coverage[p] = (unsigned char)(255 * a->covered + 0.5F);
    }
}

// ---- picture -------------------------------------------------------------------------------------------

static ruga_status check(const ruga_mesh* mesh, const double* position, const ruga_render_def* def) {
    RUGA_ASSERT(mesh->vertex_count > 0 && def->samples > 0);
    if (def->width < PIXELS_MIN || def->height < PIXELS_MIN || def->width > PIXELS_MAX ||
        def->height > PIXELS_MAX) {
        return ruga_fail(RUGA_BAD_INPUT, "a picture of %d x %d pixels cannot be made: use %d to %d",
                         def->width, def->height, PIXELS_MIN, PIXELS_MAX);
    }
    for (int i = 0; i < 3 * mesh->vertex_count; i++) {
        if (!isfinite(position[i])) {
            return ruga_fail(RUGA_BAD_INPUT, "vertex %d has a position that is not finite", i / 3);
        }
    }
    return RUGA_OK;
}

static ruga_status draw(scene* s) {
    size_t pixels = (size_t)s->def->width * (size_t)s->def->height;
    RUGA_TRY(RUGA_NEW(s->picture->pixel, 3 * pixels));
    RUGA_TRY(RUGA_NEW(s->picture->coverage, pixels));
    RUGA_TRY(RUGA_NEW(s->pixel, pixels));
    RUGA_TRY(RUGA_NEW(s->spare, pixels));
    RUGA_TRY(RUGA_NEW(s->normal, 9 * (size_t)s->mesh->triangle_count));
    RUGA_TRY(ruga_corner_normals(s->mesh, s->position, s->def->line, s->normal));
    RUGA_TRY(ruga_ray_scene_create(s->mesh->vertex_count, s->position, s->mesh->triangle_count,
                                   s->mesh->triangle, &s->rays));
    set_camera(s);
    set_lights(s);
    ruga_parallel_for(s->def->height, ROWS, trace_rows, s);
    for (int k = 0; k < SMOOTHINGS; k++) {
        s->step = 1 << k;
        ruga_parallel_for(s->def->height, ROWS, smooth_rows, s);
        pixel_light* swap = s->pixel;
        s->pixel = s->spare;
        s->spare = swap;
    }
    ruga_parallel_for(s->def->height, ROWS, develop_rows, s);
    s->picture->camera = s->camera;
    return ruga_legend_draw(s->def, s->picture);
}

ruga_status ruga_render(const ruga_mesh* mesh, const double* position, const ruga_render_def* def,
                        ruga_picture* picture) {
    *picture = (ruga_picture){.width = def->width, .height = def->height};
    RUGA_TRY(check(mesh, position, def));
    scene s = {.mesh = mesh, .def = def, .position = position, .picture = picture};
    ruga_status status = draw(&s);
    ruga_ray_scene_destroy(&s.rays);
    ruga_release(s.normal);
    ruga_release(s.pixel);
    ruga_release(s.spare);
    if (status != RUGA_OK) {
        ruga_picture_clear(picture);
    }
    return status;
}

void ruga_picture_clear(ruga_picture* picture) {
    ruga_release(picture->pixel);
    ruga_release(picture->coverage);
    *picture = (ruga_picture){0};
}

ruga_status ruga_picture_write(const ruga_picture* picture, const char* path) {
    char temporary[4096];
    if (snprintf(temporary, sizeof temporary, "%s.part", path) >= (int)sizeof temporary) {
        return ruga_fail(RUGA_BAD_INPUT, "the path of the picture is too long");
    }
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = (png_uint_32)picture->width,
                       .height = (png_uint_32)picture->height,
                       .format = PNG_FORMAT_RGB};
    ruga_status status = RUGA_OK;
    if (!png_image_write_to_file(&image, temporary, 0, picture->pixel, 0, NULL)) {
        status = ruga_fail(RUGA_IO, "%s could not be written: %s", path, image.message);
    } else if (rename(temporary, path) != 0) {
        status = ruga_fail(RUGA_IO, "%s could not be written", path);
    }
    if (status != RUGA_OK) {
        (void)remove(temporary);
    }
    return status;
}

ruga_status ruga_render_png(const ruga_mesh* mesh, const double* position, const ruga_render_def* def,
                            const char* path) {
    ruga_picture picture;
    RUGA_TRY(ruga_render(mesh, position, def, &picture));
    ruga_status status = ruga_picture_write(&picture, path);
    ruga_picture_clear(&picture);
    return status;
}
