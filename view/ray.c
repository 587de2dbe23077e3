// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Embree works in single precision: the mesh is moved to its centre and scaled to size one before, so that
// neither its place nor its size costs digits. With the triangle known, the point is found again in double
// precision:
//     o + t d = a + u (b - a) + v (c - a),   p = d x (c - a), q = (o - a) x (b - a), det = (b - a).p,
//     t = (c - a).q / det, u = (o - a).p / det, v = d.q / det
// (Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997). Embree's tree is built by
// one thread: its splits depend on the number of threads, and with them which of two triangles a ray through
// their edge meets.
#include "view/ray.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"

#include <embree3/rtcore.h>

#include <float.h>
#include <math.h>

enum { RAYS_PER_CHUNK = 1024 };

struct ruga_ray_scene {
    RTCDevice device;
    RTCScene scene;
    const float* xyz;      // [V][3] of the scene's own
    const unsigned* index; // [F][3]
    double center[3], scale;
};

// ---- scene ---------------------------------------------------------------------------------------------

static void set_frame(ruga_ray_scene* s, int vertex_count, const double* position) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < 3 * vertex_count; i++) {
        low[i % 3] = fmin(low[i % 3], position[i]);
        high[i % 3] = fmax(high[i % 3], position[i]);
    }
    for (int k = 0; k < 3 && vertex_count > 0; k++) {
        s->center[k] = 0.5 * (low[k] + high[k]);
    }
    double size = vertex_count > 0 ? ruga_distance(low, high) : 0;
    s->scale = size > 0 ? 1 / size : 1;
}

static ruga_status fill(ruga_ray_scene* s, int vertex_count, const double* position, int triangle_count,
                        const int* triangle) {
    RTCGeometry geometry = rtcNewGeometry(s->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float* xyz = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                         3 * sizeof(float), (size_t)vertex_count);
    unsigned* index = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(unsigned), (size_t)triangle_count);
    if (!xyz || !index) {
        rtcReleaseGeometry(geometry);
        return ruga_fail(RUGA_NO_MEMORY, "out of memory for rays against %d triangles", triangle_count);
    }
    for (int i = 0; i < 3 * vertex_count; i++) {
        xyz[i] = (float)(s->scale * (position[i] - s->center[i % 3]));
    }
    for (int i = 0; i < 3 * triangle_count; i++) {
        index[i] = (unsigned)triangle[i];
    }
    s->xyz = xyz;
    s->index = index;
    rtcCommitGeometry(geometry);
    (void)rtcAttachGeometry(s->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(s->scene);
    enum RTCError error = rtcGetDeviceError(s->device);
    return error == RTC_ERROR_NONE
               ? RUGA_OK
               : ruga_fail(error == RTC_ERROR_OUT_OF_MEMORY ? RUGA_NO_MEMORY : RUGA_LIBRARY,
                           "Embree could not take up %d triangles (error %d)", triangle_count, (int)error);
}

ruga_status ruga_ray_scene_create(int vertex_count, const double* position, int triangle_count,
                                  const int* triangle, ruga_ray_scene** scene) {
    ruga_status status = RUGA_OK;
    ruga_ray_scene* s = NULL;
    *scene = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(s, 1));
    set_frame(s, vertex_count, position);
    s->device = rtcNewDevice("threads=1");
    if (!s->device) {
        status = ruga_fail(RUGA_LIBRARY, "Embree could not start (error %d)", (int)rtcGetDeviceError(NULL));
    } else {
        s->scene = rtcNewScene(s->device);
        rtcSetSceneFlags(s->scene, RTC_SCENE_FLAG_ROBUST); // no ray slips through between two triangles
        status = fill(s, vertex_count, position, triangle_count, triangle);
    }
    if (status != RUGA_OK) {
        ruga_ray_scene_destroy(&s);
    }
    *scene = s;
    return status;
}

void ruga_ray_scene_destroy(ruga_ray_scene** scene) {
    ruga_ray_scene* s = *scene;
    if (!s) {
        return;
    }
    if (s->scene) {
        rtcReleaseScene(s->scene);
    }
    if (s->device) {
        rtcReleaseDevice(s->device);
    }
    ruga_release(s);
    *scene = NULL;
}

// ---- rays ----------------------------------------------------------------------------------------------

// Embree wants numbers below 1.8e18. Seen from so far the scene is no dot.
static bool is_far(const ruga_ray_scene* s, const ruga_ray* ray) {
    return !(s->scale * ruga_distance(ray->origin, s->center) < 1e15);
}

static struct RTCRay convert(const ruga_ray_scene* s, const ruga_ray* ray) {
    float o[3], d[3];
    for (int k = 0; k < 3; k++) {
        o[k] = (float)(s->scale * (ray->origin[k] - s->center[k]));
        d[k] = (float)ray->direction[k];
    }
    double far = s->scale * ray->far;
    return (struct RTCRay){.org_x = o[0],
                           .org_y = o[1],
                           .org_z = o[2],
                           .tnear = (float)(s->scale * ray->near),
                           .dir_x = d[0],
                           .dir_y = d[1],
                           .dir_z = d[2],
                           .tfar = far < (double)FLT_MAX ? (float)far : FLT_MAX,
                           .mask = ~0u};
}

// t, u, v of the file's head, for the corners as Embree has them.
static void refine(const ruga_ray_scene* s, const ruga_ray* ray, ruga_ray_hit* hit) {
    double corner[3][3], e1[3], e2[3], o[3], d[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) {
            corner[i][k] =
                (double)s->xyz[3 * (size_t)s->index[3 * (size_t)hit->triangle + (size_t)i] + (size_t)k];
        }
        o[k] = s->scale * (ray->origin[k] - s->center[k]) - corner[0][k];
        d[k] = s->scale * ray->direction[k];
    }
    ruga_subtract(corner[1], corner[0], e1);
    ruga_subtract(corner[2], corner[0], e2);
    ruga_cross(d, e2, p);
    ruga_cross(o, e1, q);
    double det = ruga_dot(e1, p), u = ruga_dot(o, p) / det, v = ruga_dot(d, q) / det;
    double t = ruga_dot(e2, q) / det;
    if (isfinite(t) && isfinite(u) && isfinite(v)) { // not edge-on
        u = fmin(fmax(u, 0), 1);
        v = fmin(fmax(v, 0), 1 - u);
        *hit = (ruga_ray_hit){hit->triangle, t, {1 - u - v, u, v}};
    }
}

ruga_ray_hit ruga_ray_closest(const ruga_ray_scene* scene, const ruga_ray* ray) {
    const ruga_ray_hit nothing = {.triangle = -1, .distance = INFINITY};
    if (is_far(scene, ray)) {
        return nothing;
    }
    struct RTCRayHit found = {
        .ray = convert(scene, ray),
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}}};
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene->scene, &context, &found);
    if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        return nothing;
    }
    double u = (double)found.hit.u, v = (double)found.hit.v;
    ruga_ray_hit hit = {(int)found.hit.primID, (double)found.ray.tfar / scene->scale, {1 - u - v, u, v}};
    refine(scene, ray, &hit);
    return hit;
}

bool ruga_ray_blocked(const ruga_ray_scene* scene, const ruga_ray* ray) {
    if (is_far(scene, ray)) {
        return false;
    }
    struct RTCRay r = convert(scene, ray);
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene->scene, &context, &r);
    return r.tfar < 0; // Embree sets it to -infinity
}

typedef struct ray_list {
    const ruga_ray_scene* scene;
    const ruga_ray* ray;
    ruga_ray_hit* hit;
} ray_list;

static void trace_chunk(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const ray_list* list = context;
    for (int i = begin; i < end; i++) {
        list->hit[i] = ruga_ray_closest(list->scene, list->ray + i);
    }
}

void ruga_ray_closest_many(const ruga_ray_scene* scene, int count, const ruga_ray* ray, ruga_ray_hit* hit) {
    ruga_parallel_for(count, RAYS_PER_CHUNK, trace_chunk, &(ray_list){scene, ray, hit});
}
