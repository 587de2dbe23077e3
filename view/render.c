// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// One picture: perspective camera framed on the object, a warm key light with soft shadow, a sky that is darkened by
// ambient occlusion, smooth normals, a ground plane that catches the shadow. Rays by Embree. Every pixel has its own seeded
// random numbers, so the picture does not depend on the number of threads.
#include "view/render.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/vec3.h"
#include "view/colormap.h"

#include <embree3/rtcore.h>
#include <png.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SKY_RAYS = 6 };

typedef struct picture {
    const ruga_mesh* mesh;
    const ruga_render_def* def;
    const double* position;
    double* normal; // [F][3][3] at the corners of each face
    RTCDevice device;
    RTCScene scene;
    double eye[3], right[3], up[3], forward[3]; // forward of unit length, right and up scaled by the half picture
    double light[3], ground; // height of the ground plane along the up axis
    double size;
    unsigned char* pixels;
} picture;

ruga_render_def ruga_default_render_def(void) {
    return (ruga_render_def){.width = 1280,
                             .height = 720,
                             .samples = 2,
                             .azimuth = -1.1,
                             .elevation = 0.6,
                             .up = {0, 0, 1},
                             .fit = 0.9};
}

// ---- setting up ----------------------------------------------------------------------------------------

static ruga_status build_scene(picture* p) {
    int vertices = p->mesh->vertex_count, triangles = p->mesh->triangle_count;
    p->device = rtcNewDevice(NULL);
    if (!p->device) {
        return ruga_fail(RUGA_LIBRARY, "Embree could not start (error %d)", (int)rtcGetDeviceError(NULL));
    }
    p->scene = rtcNewScene(p->device);
    rtcSetSceneFlags(p->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(p->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float* xyz = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                         3 * sizeof(float), (size_t)vertices);
    unsigned* index = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(unsigned), (size_t)triangles);
    if (!xyz || !index) {
        rtcReleaseGeometry(geometry);
        return ruga_fail(RUGA_NO_MEMORY, "out of memory for the picture of %d triangles", triangles);
    }
    for (int i = 0; i < 3 * vertices; i++) {
        xyz[i] = (float)p->position[i];
    }
    for (int i = 0; i < 3 * triangles; i++) {
        index[i] = (unsigned)p->mesh->triangle[i];
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(p->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(p->scene);
    return rtcGetDeviceError(p->device) == RTC_ERROR_NONE
               ? RUGA_OK
               : ruga_fail(RUGA_LIBRARY, "Embree could not build the scene of %d triangles", triangles);
}

// Moves the eye back until every vertex is inside the wanted part of the picture, and sideways until what is
// seen stands in the middle.
static void frame_object(picture* p, double center[3], double half_angle) {
    const ruga_render_def* def = p->def;
    double aspect = (double)def->width / def->height, t = tan(half_angle), distance = 0;
    for (int pass = 0; pass < 4; pass++) {
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        distance = 0;
        for (int v = 0; v < p->mesh->vertex_count; v++) {
            double d[3];
            ruga_subtract(p->position + 3 * (size_t)v, center, d);
            double z = ruga_dot(d, p->forward);
            distance = fmax(distance, fabs(ruga_dot(d, p->right)) / (t * def->fit * aspect) - z);
            distance = fmax(distance, fabs(ruga_dot(d, p->up)) / (t * def->fit) - z);
        }
        for (int v = 0; v < p->mesh->vertex_count; v++) {
            double d[3];
            ruga_subtract(p->position + 3 * (size_t)v, center, d);
            double z = distance + ruga_dot(d, p->forward);
            double seen[2] = {ruga_dot(d, p->right) / z, ruga_dot(d, p->up) / z};
            for (int i = 0; i < 2; i++) {
                low[i] = fmin(low[i], seen[i]);
                high[i] = fmax(high[i], seen[i]);
            }
        }
        ruga_add_scaled(0.5 * distance * (low[0] + high[0]), p->right, center);
        ruga_add_scaled(0.5 * distance * (low[1] + high[1]), p->up, center);
    }
    for (int i = 0; i < 3; i++) {
        p->eye[i] = center[i] - distance * p->forward[i];
        p->right[i] *= t * aspect;
        p->up[i] *= t;
    }
}

// Corner normals: the mean of the faces around the vertex that are within 50 degrees of the corner's own, so that sharp
// rims stay sharp and all else is smooth.
static ruga_status build_normals(picture* p) {
    ruga_status status = RUGA_OK;
    int vertices = p->mesh->vertex_count, triangles = p->mesh->triangle_count, *start = NULL, *face = NULL;
    const int* t = p->mesh->triangle;
    double* flat = NULL;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(start, vertices + 2));
    RUGA_TRY_DONE(RUGA_NEW(face, 3 * (size_t)triangles));
    RUGA_TRY_DONE(RUGA_NEW(flat, 3 * (size_t)triangles));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(p->normal, 9 * (size_t)triangles));
    for (int c = 0; c < 3 * triangles; c++) {
        start[t[c] + 2]++;
    }
    for (int v = 0; v < vertices; v++) {
        start[v + 2] += start[v + 1];
    }
    for (int c = 0; c < 3 * triangles; c++) {
        face[start[t[c] + 1]++] = c / 3;
    }
    for (int f = 0; f < triangles; f++) {
        ruga_triangle_normal(p->position + 3 * (size_t)t[3 * f], p->position + 3 * (size_t)t[3 * f + 1],
                             p->position + 3 * (size_t)t[3 * f + 2], flat + 3 * (size_t)f);
    }
    for (int c = 0; c < 3 * triangles; c++) {
        const double* own = flat + 3 * (size_t)(c / 3);
        double* n = p->normal + 3 * (size_t)c;
        for (int k = start[t[c]]; k < start[t[c] + 1]; k++) {
            const double* other = flat + 3 * (size_t)face[k];
            if (ruga_dot(own, other) >= cos(50 * RUGA_PI / 180) * ruga_norm(own) * ruga_norm(other)) {
                ruga_add_scaled(1, other, n);
            }
        }
        ruga_normalize(n);
    }
done:
    ruga_release(start);
    ruga_release(face);
    ruga_release(flat);
    return status;
}

static void set_camera(picture* p) {
    const ruga_render_def* def = p->def;
    double axis[3] = {def->up[0], def->up[1], def->up[2]}, east[3] = {1, 0, 0}, north[3], center[3];
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    ruga_normalize(axis);
    if (fabs(axis[0]) > 0.9) {
        east[0] = 0;
        east[2] = 1;
    }
    ruga_add_scaled(-ruga_dot(east, axis), axis, east);
    ruga_normalize(east);
    ruga_cross(axis, east, north);
    p->ground = INFINITY;
    for (int v = 0; v < p->mesh->vertex_count; v++) {
        const double* x = p->position + 3 * (size_t)v;
        for (int i = 0; i < 3; i++) {
            low[i] = fmin(low[i], x[i]);
            high[i] = fmax(high[i], x[i]);
        }
        p->ground = fmin(p->ground, ruga_dot(x, axis));
    }
    p->size = ruga_distance(low, high);
    p->ground -= 2e-3 * p->size;
    double ca = cos(def->azimuth), sa = sin(def->azimuth), ce = cos(def->elevation), se = sin(def->elevation);
    for (int i = 0; i < 3; i++) {
        center[i] = 0.5 * (low[i] + high[i]);
        p->forward[i] = -(ce * (ca * east[i] + sa * north[i]) + se * axis[i]);
    }
    ruga_cross(p->forward, axis, p->right);
    ruga_normalize(p->right);
    ruga_cross(p->right, p->forward, p->up);
    for (int i = 0; i < 3; i++) {
        // From the left and low enough to graze the wrinkles.
        p->light[i] = -0.9 * p->right[i] + 0.55 * axis[i] - 0.15 * p->forward[i];
    }
    ruga_normalize(p->light);
    frame_object(p, center, 0.3);
}

// ---- light ---------------------------------------------------------------------------------------------

static bool blocked(const picture* p, const double from[3], const double direction[3]) {
    struct RTCRay ray = {.org_x = (float)from[0],
                         .org_y = (float)from[1],
                         .org_z = (float)from[2],
                         .tnear = (float)(1e-4 * p->size),
                         .dir_x = (float)direction[0],
                         .dir_y = (float)direction[1],
                         .dir_z = (float)direction[2],
                         .tfar = FLT_MAX,
                         .mask = ~0u};
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(p->scene, &context, &ray);
    return ray.tfar < 0;
}

static void random_direction(ruga_random* random, double d[3]) {
    double z = 2 * ruga_random_uniform(random) - 1, a = 2 * RUGA_PI * ruga_random_uniform(random);
    double r = sqrt(fmax(1 - z * z, 0));
    d[0] = r * cos(a);
    d[1] = r * sin(a);
    d[2] = z;
}

// Light that leaves a surface point of unit normal n and colour towards the eye: key light, and the part of the sky
// that it sees (directions distributed by the cosine).
static void shade(const picture* p, const double x[3], const double n[3], const double color[3],
                  ruga_random* random, double out[3]) {
    double d[3], key = 0, sky = 0;
    random_direction(random, d);
    for (int i = 0; i < 3; i++) {
        d[i] = p->light[i] + 0.08 * d[i];
    }
    ruga_normalize(d);
    double facing = ruga_dot(n, d);
    if (facing > 0 && !blocked(p, x, d)) {
        key = facing;
    }
    for (int k = 0; k < SKY_RAYS; k++) {
        random_direction(random, d);
        for (int i = 0; i < 3; i++) {
            d[i] += n[i];
        }
        if (ruga_normalize(d) > 0 && !blocked(p, x, d)) {
            sky += (0.65 + 0.35 * ruga_dot(d, p->def->up)) / SKY_RAYS;
        }
    }
    static const double warm[3] = {0.92, 0.86, 0.76}, cool[3] = {0.36, 0.40, 0.46};
    for (int i = 0; i < 3; i++) {
        out[i] = color[i] * (key * warm[i] + sky * cool[i]);
    }
}

static void surface_color(const picture* p, const int* t, const double b[3], double color[3]) {
    static const double clay[3] = {0.72, 0.62, 0.54};
    memcpy(color, clay, sizeof clay);
    if (p->def->scalar) {
        double value = b[0] * p->def->scalar[t[0]] + b[1] * p->def->scalar[t[1]] + b[2] * p->def->scalar[t[2]];
        double range = p->def->scalar_max - p->def->scalar_min;
        ruga_colormap(range > 0 ? (value - p->def->scalar_min) / range : 0.5, color);
    }
    if (p->def->wireframe && fmin(b[0], fmin(b[1], b[2])) < 0.03) {
        for (int i = 0; i < 3; i++) {
            color[i] *= 0.25;
        }
    }
}

static void background(const picture* p, const double d[3], ruga_random* random, double out[3]) {
    static const double paper[3] = {0.86, 0.88, 0.90};
    double along = ruga_dot(d, p->def->up), height = ruga_dot(p->eye, p->def->up) - p->ground;
    memcpy(out, paper, sizeof paper);
    if (along >= -1e-6) {
        return;
    }
    double x[3], distance = -height / along, ground[3];
    for (int i = 0; i < 3; i++) {
        x[i] = p->eye[i] + distance * d[i];
    }
    static const double floor_color[3] = {0.80, 0.80, 0.80};
    shade(p, x, p->def->up, floor_color, random, ground);
    // The floor fades into the background with distance.
    double fade = fmin(fmax(ruga_distance(x, p->eye) / (6 * p->size) - 0.3, 0), 1);
    for (int i = 0; i < 3; i++) {
        out[i] = (1 - fade) * ground[i] + fade * paper[i];
    }
}

static void trace(const picture* p, const double d[3], ruga_random* random, double out[3]) {
    struct RTCRayHit hit = {.ray = {.org_x = (float)p->eye[0],
                                    .org_y = (float)p->eye[1],
                                    .org_z = (float)p->eye[2],
                                    .dir_x = (float)d[0],
                                    .dir_y = (float)d[1],
                                    .dir_z = (float)d[2],
                                    .tfar = FLT_MAX,
                                    .mask = ~0u},
                            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}}};
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(p->scene, &context, &hit);
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        background(p, d, random, out);
        return;
    }
    const int* t = p->mesh->triangle + 3 * (size_t)hit.hit.primID;
    double b[3] = {1 - (double)hit.hit.u - (double)hit.hit.v, hit.hit.u, hit.hit.v}, n[3] = {0}, x[3] = {0}, color[3];
    for (int k = 0; k < 3; k++) {
        ruga_add_scaled(b[k], p->normal + 9 * (size_t)hit.hit.primID + 3 * (size_t)k, n);
        ruga_add_scaled(b[k], p->position + 3 * (size_t)t[k], x);
    }
    ruga_normalize(n);
    double flat[3] = {(double)hit.hit.Ng_x, (double)hit.hit.Ng_y, (double)hit.hit.Ng_z};
    ruga_normalize(flat);
    bool back = ruga_dot(flat, d) > 0;
    for (int i = 0; i < 3; i++) {
        flat[i] = back ? -flat[i] : flat[i];
        x[i] += 3e-4 * p->size * flat[i];
    }
    // Across a sharp rim the smooth normal may point into the surface: it is turned to the face's side.
    double side = ruga_dot(n, flat);
    for (int i = 0; i < 3; i++) {
        n[i] = side < 0 ? -n[i] : n[i];
    }
    side = fabs(side);
    for (int i = 0; i < 3 && side < 0.5; i++) {
        n[i] = side / 0.5 * n[i] + (1 - side / 0.5) * flat[i];
    }
    ruga_normalize(n);
    surface_color(p, t, b, color);
    shade(p, x, n, color, random, out);
}

// ---- picture -------------------------------------------------------------------------------------------

static void render_rows(int begin, int end, int chunk, void* context) {
    (void)chunk;
    picture* p = context;
    int w = p->def->width, h = p->def->height, s = p->def->samples;
    for (int row = begin; row < end; row++) {
        for (int column = 0; column < w; column++) {
            ruga_random random = {.state = (uint64_t)row * 0x10001u + (uint64_t)column};
            double sum[3] = {0, 0, 0};
            for (int k = 0; k < s * s; k++) {
                double u = 2 * (column + (k % s + ruga_random_uniform(&random)) / s) / w - 1;
                double v = 1 - 2 * (row + (k / s + ruga_random_uniform(&random)) / s) / h;
                double d[3], light[3];
                for (int i = 0; i < 3; i++) {
                    d[i] = p->forward[i] + u * p->right[i] + v * p->up[i];
                }
                ruga_normalize(d);
                trace(p, d, &random, light);
                ruga_add_scaled(1.0 / (s * s), light, sum);
            }
            for (int i = 0; i < 3; i++) {
                p->pixels[3 * ((size_t)row * (size_t)w + (size_t)column) + (size_t)i] = ruga_srgb(sum[i]);
            }
        }
    }
}

ruga_status ruga_render(const ruga_mesh* mesh, const double* position, const ruga_render_def* def,
                        unsigned char* pixels) {
    ruga_status status = RUGA_OK;
    picture p = {.mesh = mesh, .def = def, .position = position, .pixels = pixels};
    if (def->width < 1 || def->height < 1 || def->width > 16384 || def->height > 16384 || def->samples < 1) {
        return ruga_fail(RUGA_BAD_INPUT, "a picture of %d x %d pixels cannot be made: use 1 to 16384", def->width,
                         def->height);
    }
    for (int i = 0; i < 3 * mesh->vertex_count; i++) {
        if (!isfinite(position[i])) {
            return ruga_fail(RUGA_BAD_INPUT, "vertex %d has a position that is not finite", i / 3);
        }
    }
    RUGA_TRY_DONE(build_normals(&p));
    RUGA_TRY_DONE(build_scene(&p));
    set_camera(&p);
    ruga_parallel_for(def->height, 8, render_rows, &p);
done:
    if (p.scene) {
        rtcReleaseScene(p.scene);
    }
    if (p.device) {
        rtcReleaseDevice(p.device);
    }
    ruga_release(p.normal);
    return status;
}

ruga_status ruga_render_png(const ruga_mesh* mesh, const double* position, const ruga_render_def* def,
                            const char* path) {
    ruga_status status = RUGA_OK;
    unsigned char* pixels = NULL;
    char temporary[4096];
    if (snprintf(temporary, sizeof temporary, "%s.part", path) >= (int)sizeof temporary) {
        return ruga_fail(RUGA_BAD_INPUT, "the path of the picture is too long");
    }
    RUGA_TRY_DONE(RUGA_NEW(pixels, 3 * (size_t)def->width * (size_t)def->height));
    RUGA_TRY_DONE(ruga_render(mesh, position, def, pixels));
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = (png_uint_32)def->width,
                       .height = (png_uint_32)def->height,
                       .format = PNG_FORMAT_RGB};
    if (!png_image_write_to_file(&image, temporary, 0, pixels, 0, NULL)) {
        status = ruga_fail(RUGA_IO, "%s could not be written: %s", path, image.message);
        (void)remove(temporary);
    } else if (rename(temporary, path) != 0) {
        (void)remove(temporary);
        status = ruga_fail(RUGA_IO, "%s could not be written", path);
    }
done:
    ruga_release(pixels);
    return status;
}
