// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The centre of texel (row, column) of a picture w wide and h high is u = (column + 1/2) / w, v = 1 - (row +
// 1/2) / h.
#include "view/atlas.h"

#include "core/memory.h"

#include <math.h>
#include <string.h>

static const double REACH = 2;        // texels beyond a triangle that it continues to
static const double INSIDE = 1e-6;    // a weight above it is inside, for overlaps
static const double TOLERANCE = 1e-6; // of uvs beyond 0 to 1
static const double CONTINUED =
    1.5; // weights further out than -1.5 to 2.5 are those of slivers: not continued

typedef struct corners {
    double x[3], y[3]; // texels, from the upper left corner
    double area;       // twice, signed
} corners;

static corners corners_of(const ruga_atlas* atlas, int triangle) {
    corners c;
    for (int i = 0; i < 3; i++) {
        const double* uv =
            atlas->mesh->uv + 2 * (size_t)atlas->mesh->uv_triangle[3 * (size_t)triangle + (size_t)i];
        c.x[i] = uv[0] * atlas->width;
        c.y[i] = (1 - uv[1]) * atlas->height;
    }
    c.area = (c.x[1] - c.x[0]) * (c.y[2] - c.y[0]) - (c.x[2] - c.x[0]) * (c.y[1] - c.y[0]);
    return c;
}

static void weigh(const corners* c, double x, double y, double weight[3]) {
    for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        weight[i] = ((c->x[a] - x) * (c->y[b] - y) - (c->x[b] - x) * (c->y[a] - y)) / c->area;
    }
}

static double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

// Distance of a point outside to the triangle, and the weights of the point of it that is nearest.
static double nearest_of(const corners* c, double x, double y, double weight[3]) {
    double least = INFINITY;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double ex = c->x[j] - c->x[i], ey = c->y[j] - c->y[i];
        double t = clamp(((x - c->x[i]) * ex + (y - c->y[i]) * ey) / fmax(ex * ex + ey * ey, 1e-300), 0, 1);
        double distance = hypot(c->x[i] + t * ex - x, c->y[i] + t * ey - y);
        if (distance < least) {
            least = distance;
            weight[i] = 1 - t;
            weight[j] = t;
            weight[(i + 2) % 3] = 0;
        }
    }
    return least;
}

static bool is_within(const double weight[3], double low) {
    return weight[0] >= low && weight[1] >= low && weight[2] >= low;
}

void ruga_atlas_weights(const ruga_atlas* atlas, int row, int column, double weight[3]) {
    corners c = corners_of(atlas, atlas->triangle[(size_t)row * (size_t)atlas->width + (size_t)column]);
    weigh(&c, column + 0.5, row + 0.5, weight);
    if (!is_within(weight, -CONTINUED)) {
        (void)nearest_of(&c, column + 0.5, row + 0.5, weight);
    }
}

// ---- checks --------------------------------------------------------------------------------------------

static bool is_in_square(double coordinate) {
    return coordinate >= -TOLERANCE && coordinate <= 1 + TOLERANCE; // not a NaN
}

static ruga_status check_uvs(const char* what, const ruga_mesh* mesh) {
    if (!mesh->uv || !mesh->uv_triangle || mesh->uv_count == 0) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s has no texture coordinates: unwrap it, or bake onto a mesh that is unwrapped "
                         "by --target",
                         what);
    }
    for (size_t c = 0; c < 3 * (size_t)mesh->triangle_count; c++) {
        int u = mesh->uv_triangle[c];
        if (u < 0) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: a corner of triangle %zu has no texture coordinates", what,
                             c / 3);
        }
        const double* uv = mesh->uv + 2 * (size_t)u;
        if (!is_in_square(uv[0]) || !is_in_square(uv[1])) {
            return ruga_fail(
                RUGA_BAD_INPUT,
                "%s: texture coordinate %d of triangle %zu is (%.4g, %.4g), outside 0 to 1: pack all charts "
                "into one square, or bake onto another mesh by --target",
                what, u, c / 3, uv[0], uv[1]);
        }
    }
    return RUGA_OK;
}

// ---- painting ------------------------------------------------------------------------------------------

typedef struct painter {
    const char* what;
    ruga_atlas* atlas;
    float* distance; // [height][width] texels to the triangle there; 0 = inside
    bool* deep;      // [height][width] inside by more than round-off
    int overlaps, overlap[2], row, column;
} painter;

static void paint_texel(painter* p, int triangle, const corners* c, int row, int column) {
    double weight[3];
    size_t at = (size_t)row * (size_t)p->atlas->width + (size_t)column;
    weigh(c, column + 0.5, row + 0.5, weight);
    bool inside = is_within(weight, 0), deep = is_within(weight, INSIDE);
    if (deep && p->deep[at] && p->overlaps++ == 0) {
        p->overlap[0] = p->atlas->triangle[at];
        p->overlap[1] = triangle;
        p->row = row;
        p->column = column;
    }
    float distance = inside ? 0 : (float)nearest_of(c, column + 0.5, row + 0.5, weight);
    if (distance <= (float)REACH && (distance < p->distance[at] || (deep && !p->deep[at]))) {
        p->distance[at] = distance;
        p->deep[at] = deep;
        p->atlas->triangle[at] = triangle;
    }
}

static void paint_triangle(painter* p, int triangle) {
    corners c = corners_of(p->atlas, triangle);
    if (fabs(c.area) < 1e-12) {
        p->atlas->flat++;
        return;
    }
    double left = fmin(fmin(c.x[0], c.x[1]), c.x[2]), right = fmax(fmax(c.x[0], c.x[1]), c.x[2]);
    double top = fmin(fmin(c.y[0], c.y[1]), c.y[2]), bottom = fmax(fmax(c.y[0], c.y[1]), c.y[2]);
    int first = (int)fmax(0, floor(left - REACH)), last = (int)fmin(p->atlas->width - 1, ceil(right + REACH));
    int end = (int)fmin(p->atlas->height - 1, ceil(bottom + REACH));
    for (int row = (int)fmax(0, floor(top - REACH)); row <= end; row++) {
        for (int column = first; column <= last; column++) {
            paint_texel(p, triangle, &c, row, column);
        }
    }
}

static ruga_status paint(painter* p) {
    ruga_atlas* atlas = p->atlas;
    size_t texels = (size_t)atlas->width * (size_t)atlas->height;
    RUGA_TRY(RUGA_NEW(atlas->triangle, texels));
    RUGA_TRY(RUGA_NEW(p->distance, texels));
    RUGA_TRY(RUGA_NEW_ZERO(p->deep, texels));
    for (size_t i = 0; i < texels; i++) {
        atlas->triangle[i] = -1;
        p->distance[i] = INFINITY;
    }
    for (int f = 0; f < atlas->mesh->triangle_count; f++) {
        paint_triangle(p, f);
    }
    for (size_t i = 0; i < texels; i++) {
        atlas->covered += p->distance[i] == 0;
    }
    if (p->overlaps > 0) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "%s: the texture coordinates of triangles %d and %d overlap at (%.4g, %.4g), and so do others at "
            "%d texels in all: give each triangle a place of its own, or bake onto another mesh by "
            "--target",
            p->what, p->overlap[0], p->overlap[1], (p->column + 0.5) / atlas->width,
            1 - (p->row + 0.5) / atlas->height, p->overlaps);
    }
    return atlas->covered > 0
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT, "%s: its texture coordinates cover no texel", p->what);
}

ruga_status ruga_atlas_create(const char* what, const ruga_mesh* mesh, int width, int height,
                              ruga_atlas* atlas) {
    *atlas = (ruga_atlas){.width = width, .height = height, .mesh = mesh};
    RUGA_TRY(check_uvs(what, mesh));
    painter p = {.what = what, .atlas = atlas};
    ruga_status status = paint(&p);
    ruga_release(p.distance);
    ruga_release(p.deep);
    if (status != RUGA_OK) {
        ruga_atlas_clear(atlas);
    }
    return status;
}

void ruga_atlas_clear(ruga_atlas* atlas) {
    ruga_release(atlas->triangle);
    *atlas = (ruga_atlas){0};
}

// ---- dilation ------------------------------------------------------------------------------------------

// The mean over the filled ones of the four neighbours beside it or, where there are none, of the four at its
// corners; false where there are none either.
static bool mean_of_neighbours(const ruga_atlas* atlas, int row, int column, int channels, const bool* filled,
                               float* pixel) {
    static const int step[8][2] = {{0, 1}, {0, -1}, {1, 0}, {-1, 0}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
    float* to = &pixel[((size_t)row * (size_t)atlas->width + (size_t)column) * (size_t)channels];
    int count = 0;
    for (int k = 0; k < 8 && !(k == 4 && count > 0); k++) {
        int r = row + step[k][0], c = column + step[k][1];
        size_t from = (size_t)r * (size_t)atlas->width + (size_t)c;
        if (r < 0 || c < 0 || r >= atlas->height || c >= atlas->width || !filled[from]) {
            continue;
        }
        for (int i = 0; i < channels; i++) {
            float value = pixel[from * (size_t)channels + (size_t)i];
            to[i] = count == 0 ? value : to[i] + value;
        }
        count++;
    }
    for (int i = 0; count > 1 && i < channels; i++) {
        to[i] /= (float)count;
    }
    return count > 0;
}

ruga_status ruga_atlas_fill(const ruga_atlas* atlas, int margin, int channels, bool* filled, float* pixel) {
    int* ring = NULL; // texels filled in this round: they count from the next one on
    size_t texels = (size_t)atlas->width * (size_t)atlas->height;
    RUGA_TRY(RUGA_NEW(ring, texels));
    for (int round = 0, count = 1; round < margin && count > 0; round++) {
        count = 0;
        for (int row = 0; row < atlas->height; row++) {
            for (int column = 0; column < atlas->width; column++) {
                size_t at = (size_t)row * (size_t)atlas->width + (size_t)column;
                if (!filled[at] && mean_of_neighbours(atlas, row, column, channels, filled, pixel)) {
                    ring[count++] = (int)at;
                }
            }
        }
        for (int i = 0; i < count; i++) {
            filled[ring[i]] = true;
        }
    }
    ruga_release(ring);
    return RUGA_OK;
}
