// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Rays against a triangle mesh, by Embree. The same bits for any number of threads.
#ifndef RUGA_VIEW_RAY_H
#define RUGA_VIEW_RAY_H

#include "core/status.h"

typedef struct ruga_ray_scene ruga_ray_scene;

typedef struct ruga_ray {
    double origin[3], direction[3]; // m; of any length: distances are in units of the direction
    double near, far;               // hits nearer or farther than these do not count; far may be INFINITY
} ruga_ray;

typedef struct ruga_ray_hit {
    int triangle;     // -1: nothing is met
    double distance;  // origin + distance direction is the point; INFINITY where nothing is met
    double weight[3]; // of the triangle's corners at the point, each >= 0, sum 1
} ruga_ray_hit;

// position [V][3] finite, triangle [F][3]; both are copied (in single precision, about the mesh's centre).
ruga_status ruga_ray_scene_create(int vertex_count, const double* position, int triangle_count,
                                  const int* triangle, ruga_ray_scene** scene);
void ruga_ray_scene_destroy(ruga_ray_scene** scene);

// May be called from many threads at once. Both sides of a triangle count.
ruga_ray_hit ruga_ray_closest(const ruga_ray_scene* scene, const ruga_ray* ray);
bool ruga_ray_blocked(const ruga_ray_scene* scene, const ruga_ray* ray);
// hit [count] of ray [count], on all cores.
void ruga_ray_closest_many(const ruga_ray_scene* scene, int count, const ruga_ray* ray, ruga_ray_hit* hit);

#endif
