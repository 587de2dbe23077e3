// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The polygon is projected along the largest component of its normal sum p_i x p_{i+1} (Newell), which keeps
// orientation. A quad is cut along the shorter of those diagonals that leave two triangles of positive area.
// A larger polygon loses one ear at a time, an ear being a corner with positive area and no other corner in
// it: up to 64 corners the ear with the largest smallest angle, above it the next one found, going around, so
// that time stays near count times the number of reflex corners. Ties go to the first corner: deterministic.
#include "io/triangulate.h"

#include "core/memory.h"
#include "core/vec3.h"

enum { BEST_EAR_CORNERS = 64 };

typedef struct outline {
    int count;
    double (*point)[2]; // projected
    int* previous;      // of the corners left
    int* next;
    bool* reflex;
    int64_t tests_left; // of a corner in an ear, before any corner of positive area counts as an ear
} outline;

static double area2(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// False where the polygon has no normal.
static bool project(int count, const double position[][3], double (*point)[2]) {
    double normal[3] = {0, 0, 0};
    for (int i = 1; i + 1 < count; i++) {
        double n[3];
        ruga_triangle_normal(position[0], position[i], position[i + 1], n);
        ruga_add_scaled(1, n, normal);
    }
    int along = fabs(normal[0]) > fabs(normal[1]) ? 0 : 1;
    along = fabs(normal[2]) >= fabs(normal[along]) ? 2 : along;
    if (!(fabs(normal[along]) > 0) || !isfinite(normal[along])) {
        return false;
    }
    int u = (along + 1) % 3, v = (along + 2) % 3;
    double sign = normal[along] > 0 ? 1 : -1;
    for (int i = 0; i < count; i++) {
        point[i][0] = position[i][u];
        point[i][1] = sign * position[i][v];
    }
    return true;
}

static void set_triangle(int triangle[3], int a, int b, int c) {
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

static void cut_quad(const double position[][3], const double (*point)[2], int (*triangle)[3]) {
    bool inside02 = area2(point[0], point[1], point[2]) > 0 && area2(point[0], point[2], point[3]) > 0;
    bool inside13 = area2(point[0], point[1], point[3]) > 0 && area2(point[1], point[2], point[3]) > 0;
    bool shorter02 = !(ruga_distance(position[1], position[3]) < ruga_distance(position[0], position[2]));
    bool along02 = inside02 == inside13 ? shorter02 : inside02;
    set_triangle(triangle[0], 0, 1, along02 ? 2 : 3);
    set_triangle(triangle[1], along02 ? 0 : 1, 2, 3);
}

static void cut_fan(int count, int (*triangle)[3]) {
    for (int i = 0; i + 2 < count; i++) {
        set_triangle(triangle[i], 0, i + 1, i + 2);
    }
}

static double corner_area(const outline* o, int i) {
    return area2(o->point[o->previous[i]], o->point[i], o->point[o->next[i]]);
}

static bool same_point(const double a[2], const double b[2]) {
    return a[0] == b[0] && a[1] == b[1];
}

// Only a reflex corner can lie in an ear. One at the place of the ear's own corners (a bridge to a hole) does
// not count.
static bool is_ear(outline* o, int i) {
    const double *a = o->point[o->previous[i]], *b = o->point[i], *c = o->point[o->next[i]];
    if (!(area2(a, b, c) > 0)) {
        return false;
    }
    for (int j = o->next[o->next[i]]; j != o->previous[i] && o->tests_left > 0; j = o->next[j]) {
        o->tests_left--;
        const double* p = o->point[j];
        if (o->reflex[j] && !same_point(p, a) && !same_point(p, b) && !same_point(p, c) &&
            area2(a, b, p) >= 0 && area2(b, c, p) >= 0 && area2(c, a, p) >= 0) {
            return false;
        }
    }
    return true;
}

// Twice the area by the square of the longest side: grows with the smallest angle.
static double ear_quality(const outline* o, int i) {
    const double* p[3] = {o->point[o->previous[i]], o->point[i], o->point[o->next[i]]};
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        double x = p[(k + 1) % 3][0] - p[k][0], y = p[(k + 1) % 3][1] - p[k][1];
        longest = fmax(longest, x * x + y * y);
    }
    return area2(p[0], p[1], p[2]) / longest;
}

// The ear to cut among `left` corners from `start` on; where there is none, the corner of largest area.
static int choose_ear(outline* o, int start, int left, bool best) {
    int chosen = -1, largest = start;
    double quality = 0;
    for (int k = 0, i = start; k < left; k++, i = o->next[i]) {
        if (corner_area(o, i) > corner_area(o, largest)) {
            largest = i;
        }
        if (is_ear(o, i) && (chosen < 0 || ear_quality(o, i) > quality)) {
            chosen = i;
            quality = ear_quality(o, i);
            if (!best) {
                break;
            }
        }
    }
    return chosen >= 0 ? chosen : largest;
}

static void clip_ears(outline* o, int (*triangle)[3]) {
    for (int i = 0; i < o->count; i++) {
        o->previous[i] = (i + o->count - 1) % o->count;
        o->next[i] = (i + 1) % o->count;
    }
    for (int i = 0; i < o->count; i++) {
        o->reflex[i] = !(corner_area(o, i) > 0);
    }
    // A polygon that does not cross itself needs fewer; one that does must not take forever.
    o->tests_left = 64 * 64 * 64 + 2 * (int64_t)o->count * o->count;
    int start = 0;
    for (int left = o->count; left >= 3; left--) {
        int i = choose_ear(o, start, left, o->count <= BEST_EAR_CORNERS);
        int before = o->previous[i], after = o->next[i];
        set_triangle(triangle[o->count - left], before, i, after);
        o->next[before] = after;
        o->previous[after] = before;
        o->reflex[before] = !(corner_area(o, before) > 0);
        o->reflex[after] = !(corner_area(o, after) > 0);
        // Skipping one corner spreads the triangles instead of making a fan.
        start = o->next[after];
    }
}

ruga_status ruga_triangulate(int count, const double position[][3], int (*triangle)[3]) {
    RUGA_ASSERT(count >= 3);
    if (count == 3) {
        cut_fan(3, triangle);
        return RUGA_OK;
    }
    if (count == 4) {
        double point[4][2] = {{0}};
        (void)project(4, position, point);
        cut_quad(position, (const double(*)[2])point, triangle);
        return RUGA_OK;
    }
    ruga_status status = RUGA_OK;
    outline o = {.count = count};
    RUGA_TRY_DONE(RUGA_NEW(o.point, count));
    RUGA_TRY_DONE(RUGA_NEW(o.previous, count));
    RUGA_TRY_DONE(RUGA_NEW(o.next, count));
    RUGA_TRY_DONE(RUGA_NEW(o.reflex, count));
    if (project(count, position, o.point)) {
        clip_ears(&o, triangle);
    } else {
        cut_fan(count, triangle);
    }
done:
    ruga_release(o.point);
    ruga_release(o.previous);
    ruga_release(o.next);
    ruga_release(o.reflex);
    return status;
}
