// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// q_a = A (X_a - c) + c + t + (bump's coefficient at node a)
// bump(X) = depth direction exp(-|X - center|^2 / (2 radius^2)), X in the rest shape
//
// Nodes' rest positions reproduce affine maps, so the first part is exact. For degree 2 a field's value at a
// node's rest position is not its coefficient; the local quasi-interpolant (Sablonniere 2003; Lyche and
// Schumaker 1975)
//   coefficient_i = -1/8 f(X_i - h) + 10/8 f(X_i) - 1/8 f(X_i + h),   applied along each axis,
// is third-order accurate, exact for fields quadratic in each axis, and needs no system to be solved. For
// degree 1 values at nodes are coefficients.
#include "lattice/motion.h"

#include "core/vec3.h"
#include "lattice/svd3.h"

// A keyframe's content at some time.
typedef struct pose {
    double matrix[9], translate[3];
    double center[3], radius;
    double bump[3]; // depth times unit direction, m; zero = no bump
} pose;

static double mix(double a, double b, double s) {
    return (1 - s) * a + s * b;
}

// Depth of a keyframe, 0 without a bump, and the unit direction; zero where none is given.
static double bump_depth(const ruga_keyframe_def* keyframe, double direction[3]) {
    for (int i = 0; i < 3; i++) {
        direction[i] = keyframe->bump_direction[i];
    }
    ruga_normalize(direction);
    return keyframe->has_bump && keyframe->bump_radius > 0 ? keyframe->bump_depth : 0;
}

// A keyframe without a bump has the other's bump at depth 0, so that a bump grows in place.
static void mix_bump(const ruga_keyframe_def* a, const ruga_keyframe_def* b, double s, pose* at) {
    double da[3], db[3];
    double depth = mix(bump_depth(a, da), bump_depth(b, db), s);
    double sc = a->has_bump && b->has_bump ? s : a->has_bump ? 0 : 1;
    for (int i = 0; i < 3; i++) {
        at->center[i] = mix(a->bump_center[i], b->bump_center[i], sc);
        at->bump[i] = mix(da[i], db[i], sc);
    }
    at->radius = mix(a->bump_radius, b->bump_radius, sc);
    ruga_normalize(at->bump);
    for (int i = 0; i < 3; i++) {
        at->bump[i] *= at->radius > 0 ? depth : 0;
    }
}

static pose pose_at(int count, const ruga_keyframe_def* keyframes, double time) {
    int next = 0;
    while (next < count && keyframes[next].time <= time) {
        next++;
    }
    const ruga_keyframe_def* a = &keyframes[next > 0 ? next - 1 : 0];
    const ruga_keyframe_def* b = &keyframes[next < count ? next : count - 1];
    double s = a == b ? 0 : (time - a->time) / (b->time - a->time);
    pose at;
    for (int i = 0; i < 9; i++) {
        at.matrix[i] = mix(a->matrix[i], b->matrix[i], s);
    }
    for (int i = 0; i < 3; i++) {
        at.translate[i] = mix(a->translate[i], b->translate[i], s);
    }
    mix_bump(a, b, s, &at);
    return at;
}

static double bell(const pose* at, const double x[3]) {
    double r = ruga_distance(x, at->center) / at->radius;
    return exp(-0.5 * r * r);
}

static double bell_coefficient(const ruga_lattice* lattice, const pose* at, const double x[3]) {
    static const double factor[3] = {-1. / 8, 10. / 8, -1. / 8};
    if (lattice->degree == 1) {
        return bell(at, x);
    }
    double sum = 0;
    for (int k = 0; k < 27; k++) {
        int step[3] = {k % 3, k / 3 % 3, k / 9};
        double y[3];
        for (int i = 0; i < 3; i++) {
            y[i] = x[i] + (step[i] - 1) * lattice->cell_size[i];
        }
        sum += factor[step[0]] * factor[step[1]] * factor[step[2]] * bell(at, y);
    }
    return sum;
}

void ruga_motion_at(const ruga_lattice* lattice, const double center[3], int keyframe_count,
                    const ruga_keyframe_def* keyframes, double time, double* q) {
    static const ruga_keyframe_def rest = {.matrix = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    pose at = keyframe_count > 0 ? pose_at(keyframe_count, keyframes, time) : pose_at(1, &rest, 0);
    bool bumped = ruga_dot(at.bump, at.bump) > 0;
    for (int a = 0; a < lattice->node_count; a++) {
        const double* x = &lattice->rest[3 * a];
        double d[3];
        ruga_subtract(x, center, d);
        ruga_multiply3(at.matrix, d, d);
        double height = bumped ? bell_coefficient(lattice, &at, x) : 0;
        for (int i = 0; i < 3; i++) {
            q[3 * a + i] = d[i] + center[i] + at.translate[i] + height * at.bump[i];
        }
    }
}

double ruga_motion_largest_compression(int keyframe_count, const ruga_keyframe_def* keyframes) {
    double compression = 0;
    for (int k = 0; k < keyframe_count; k++) {
        double u[9], s[3], v[9];
        ruga_svd3(keyframes[k].matrix, u, s, v);
        compression = fmax(compression, 1 - fabs(s[2]));
    }
    return compression;
}
