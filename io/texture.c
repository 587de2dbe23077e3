// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/texture.h"

#include "core/memory.h"

#include <errno.h>
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

enum { PIXELS_MAX = 32768 }; // along each side

typedef struct reader {
    const char* path;
    FILE* file;
    png_structp png;
    png_infop info;
    char reason[120];
} reader;

static void on_error(png_structp png, png_const_charp message) {
    reader* r = png_get_error_ptr(png);
    (void)snprintf(r->reason, sizeof r->reason, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) {
    (void)png;
    (void)message;
}

// libpng's errors jump here; nothing of this function is used after a jump.
static bool decode(reader* r) {
    if (setjmp(png_jmpbuf(r->png))) {
        return false;
    }
    png_init_io(r->png, r->file);
    png_set_user_limits(r->png, PIXELS_MAX, PIXELS_MAX);
    png_read_png(r->png, r->info, PNG_TRANSFORM_EXPAND | PNG_TRANSFORM_STRIP_ALPHA, NULL);
    return true;
}

static ruga_status take_pixels(const reader* r, ruga_texture* texture) {
    if (png_get_color_type(r->png, r->info) != PNG_COLOR_TYPE_GRAY) {
        return ruga_fail(RUGA_BAD_INPUT, "%s is in colour: save it as a greyscale PNG", r->path);
    }
    int bytes = png_get_bit_depth(r->png, r->info) / 8;
    size_t width = png_get_image_width(r->png, r->info), height = png_get_image_height(r->png, r->info);
    png_bytepp rows = png_get_rows(r->png, r->info);
    texture->width = (int)width;
    texture->height = (int)height;
    RUGA_TRY(RUGA_NEW(texture->value, width * height));
    for (size_t y = 0; y < height; y++) {
        for (size_t x = 0; x < width; x++) {
            const png_byte* p = rows[y] + x * (size_t)bytes;
            texture->value[width * y + x] = bytes == 2 ? (256 * p[0] + p[1]) / 65535.0 : p[0] / 255.0;
        }
    }
    return RUGA_OK;
}

static ruga_status read_file(reader* r, ruga_texture* texture) {
    r->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, r, on_error, on_warning);
    r->info = r->png ? png_create_info_struct(r->png) : NULL;
    if (!r->info) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: %s", r->path);
    }
    if (!decode(r)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s is not a PNG that can be read: %s", r->path, r->reason);
    }
    return take_pixels(r, texture);
}

ruga_status ruga_texture_read(const char* path, ruga_texture* texture) {
    reader r = {.path = path, .file = fopen(path, "rb")};
    *texture = (ruga_texture){0};
    if (!r.file) {
        return ruga_fail(RUGA_BAD_INPUT, "%s cannot be read: %s", path, strerror(errno));
    }
    ruga_status status = read_file(&r, texture);
    png_destroy_read_struct(&r.png, &r.info, NULL);
    (void)fclose(r.file);
    return status;
}

void ruga_texture_clear(ruga_texture* texture) {
    ruga_release(texture->value);
    *texture = (ruga_texture){0};
}

// The pixel below a coordinate in pixels, and how far beyond its middle.
static int split(double x, int count, double* part) {
    x = fmin(fmax(x - 0.5, 0), count - 1);
    int first = (int)fmin(floor(x), count > 1 ? count - 2 : 0);
    *part = x - first;
    return first;
}

double ruga_texture_at(const ruga_texture* texture, const double uv[2]) {
    double s, t;
    int width = texture->width, height = texture->height;
    int x = split(uv[0] * width, width, &s), y = split((1 - uv[1]) * height, height, &t);
    size_t right = width > 1, below = height > 1 ? (size_t)width : 0;
    const double* p = texture->value + (size_t)width * (size_t)y + (size_t)x;
    return (1 - t) * ((1 - s) * p[0] + s * p[right]) + t * ((1 - s) * p[below] + s * p[below + right]);
}
