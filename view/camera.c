// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "view/camera.h"

#include "core/vec3.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

static const double HALF_ANGLE =
    0.2; // rad, of the picture's height: a long lens, so that lengths can be compared

// Directions evenly over the sphere, on a spiral by the golden angle.
static void direction(int i, double d[3]) {
    double z = 1 - (2 * i + 1.0) / RUGA_EXTENT_POINTS, turn = i * RUGA_PI * (3 - sqrt(5));
    d[0] = sqrt(1 - z * z) * cos(turn);
    d[1] = sqrt(1 - z * z) * sin(turn);
    d[2] = z;
}

void ruga_extent_add(ruga_extent* extent, int count, const double* position) {
    for (int i = 0; i < RUGA_EXTENT_POINTS; i++) {
        double d[3], *best = extent->point[i];
        direction(i, d);
        double farthest = extent->any ? ruga_dot(best, d) : -INFINITY;
        for (int v = 0; v < count; v++) {
            const double* x = position + 3 * (size_t)v;
            double far = ruga_dot(x, d);
            if (far > farthest) {
                farthest = far;
                best[0] = x[0];
                best[1] = x[1];
                best[2] = x[2];
            }
        }
    }
    extent->any = extent->any || count > 0;
}

// ---- frame ---------------------------------------------------------------------------------------------

static void set_directions(const ruga_view* view, ruga_camera* c) {
    double east[3] = {1, 0, 0}, north[3];
    double ca = cos(view->azimuth), sa = sin(view->azimuth);
    double ce = cos(view->elevation), se = sin(view->elevation);
    for (int k = 0; k < 3; k++) {
        c->axis[k] = view->up[k];
    }
    (void)ruga_normalize(c->axis);
    if (fabs(c->axis[0]) > 0.9) {
        east[0] = 0;
        east[2] = 1;
    }
    ruga_add_scaled(-ruga_dot(east, c->axis), c->axis, east);
    (void)ruga_normalize(east);
    ruga_cross(c->axis, east, north);
    for (int k = 0; k < 3; k++) {
        c->forward[k] = -(ce * (ca * east[k] + sa * north[k]) + se * c->axis[k]);
        c->right[k] = -sa * east[k] + ca * north[k];
    }
    ruga_cross(c->right, c->forward, c->up);
}

// Height of the lowest point, box and its middle.
static void set_bounds(int count, const double* point, ruga_camera* c, double middle[3]) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    c->ground = INFINITY;
    for (int i = 0; i < count; i++) {
        const double* x = point + 3 * (size_t)i;
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], x[k]);
            high[k] = fmax(high[k], x[k]);
        }
        c->ground = fmin(c->ground, ruga_dot(x, c->axis));
    }
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * (low[k] + high[k]);
    }
    c->size = fmax(ruga_distance(low, high), 1e-12);
}

// Position of a point seen from `middle`, along right, up and forward. Where the view turns, the point's
// circle about the axis stands for it: `place` of 8.
static void look(const ruga_camera* c, const double x[3], const double middle[3], int place, int places,
                 double seen[3]) {
    double d[3], turned[3], side[3], angle = 2 * RUGA_PI * place / places;
    ruga_subtract(x, middle, d);
    double height = ruga_dot(d, c->axis);
    ruga_cross(c->axis, d, side);
    for (int k = 0; k < 3; k++) {
        turned[k] = height * c->axis[k] + cos(angle) * (d[k] - height * c->axis[k]) + sin(angle) * side[k];
    }
    seen[0] = ruga_dot(turned, c->right);
    seen[1] = ruga_dot(turned, c->up);
    seen[2] = ruga_dot(turned, c->forward);
}

// How the picture is filled: `half` widths at distance one, about a middle that is seen `raised` above the
// picture's.
typedef struct window {
    double half[2], raised;
} window;

// The least distance from the eye to `middle` at which all is in the window: of a point at right a, up b and
// forward c of the middle, |a| <= half[0] (d + c) and |b + raised d - raised (d + c)| <= half[1] (d + c).
static double step_back(int count, const double* point, const ruga_camera* c, const double middle[3],
                        int places, const window* w) {
    double distance = 1e-9 * c->size;
    for (int64_t i = 0; i < (int64_t)count * places; i++) {
        double s[3];
        look(c, point + 3 * (i / places), middle, (int)(i % places), places, s);
        double over = fmax(fabs(s[0]) / w->half[0], fabs(s[1] - w->raised * s[2]) / w->half[1]);
        distance = fmax(distance, over - s[2]);
    }
    return distance;
}

// Moves the middle of what is seen into that of the window.
static void center(int count, const double* point, const ruga_camera* c, double middle[3], double distance,
                   int places, const window* w) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int64_t i = 0; i < (int64_t)count * places; i++) {
        double s[3];
        look(c, point + 3 * (i / places), middle, (int)(i % places), places, s);
        s[1] -= w->raised * s[2];
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], s[k] / (distance + s[2]));
            high[k] = fmax(high[k], s[k] / (distance + s[2]));
        }
    }
    if (places == 1) {
        ruga_add_scaled(0.5 * distance * (low[0] + high[0]), c->right, middle);
    }
    ruga_add_scaled(0.5 * distance * (low[1] + high[1]), c->up, middle);
}

void ruga_camera_frame(int count, const double* point, const ruga_view* view, int width, int height,
                       ruga_camera* camera) {
    double middle[3], tangent = tan(HALF_ANGLE), aspect = (double)width / height;
    int places = view->turns ? 8 : 1;
    const window w = {.half = {tangent * aspect * view->fit, tangent * (1 - view->foot) * view->fit},
                      .raised = tangent * view->foot};
    ruga_camera* c = camera;
    *c = (ruga_camera){.width = width, .height = height};
    set_directions(view, c);
    set_bounds(count, point, c, middle);
    for (int pass = 0; pass < 6; pass++) {
        c->distance = step_back(count, point, c, middle, places, &w);
        center(count, point, c, middle, c->distance, places, &w);
    }
    c->distance = step_back(count, point, c, middle, places, &w);
    for (int k = 0; k < 3; k++) {
        c->eye[k] = middle[k] - c->distance * (c->forward[k] + w.raised * c->up[k]);
    }
    for (int k = 0; k < 3; k++) {
        c->right[k] *= tangent * aspect;
        c->up[k] *= tangent;
    }
}

void ruga_camera_project(const ruga_camera* camera, const double x[3], double pixel[2]) {
    double d[3];
    ruga_subtract(x, camera->eye, d);
    double z = ruga_dot(d, camera->forward);
    double u = ruga_dot(d, camera->right) / (z * ruga_dot(camera->right, camera->right));
    double v = ruga_dot(d, camera->up) / (z * ruga_dot(camera->up, camera->up));
    pixel[0] = 0.5 * (1 + u) * camera->width;
    pixel[1] = 0.5 * (1 - v) * camera->height;
}

double ruga_camera_scale(const ruga_camera* camera) {
    return 0.5 * camera->height / (camera->distance * ruga_norm(camera->up));
}
