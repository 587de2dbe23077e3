// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "view/canvas.h"

#include "core/memory.h"

#include <cairo-svg.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { PIXELS_PER_UNIT = 2 };
static const double FONT_SIZE = 13;

static bool ends_in(const char* path, const char* ending) {
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcmp(path + length - tail, ending) == 0;
}

static cairo_status_t collect(void* context, const unsigned char* bytes, unsigned count) {
    ruga_canvas* canvas = context;
    if (RUGA_RESERVE(canvas->data, canvas->capacity, (size_t)canvas->size + count) != RUGA_OK) {
        return CAIRO_STATUS_NO_MEMORY;
    }
    memcpy(canvas->data + canvas->size, bytes, count);
    canvas->size += (int)count;
    return CAIRO_STATUS_SUCCESS;
}

static void set_font(cairo_t* cairo) {
    // Hinting would make the metrics depend on the size in pixels, and so SVG and PNG differ.
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cairo, options);
    cairo_font_options_destroy(options);
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, FONT_SIZE);
}

ruga_status ruga_canvas_open(const char* path, double width, double height, ruga_canvas* canvas) {
    *canvas = (ruga_canvas){.path = path, .vector = ends_in(path, ".svg"), .width = width, .height = height};
    if (!canvas->vector && !ends_in(path, ".png")) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: plots are written as .svg or .png; end the name in one of them",
                         path);
    }
    cairo_surface_t* surface =
        canvas->vector ? cairo_svg_surface_create_for_stream(collect, canvas, width, height)
                       : cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(PIXELS_PER_UNIT * width),
                                                    (int)(PIXELS_PER_UNIT * height));
    canvas->cairo = cairo_create(surface);
    cairo_surface_destroy(surface);
    if (!canvas->vector) {
        cairo_scale(canvas->cairo, PIXELS_PER_UNIT, PIXELS_PER_UNIT);
    }
    set_font(canvas->cairo);
    ruga_canvas_color(canvas, 0xffffff, 1);
    cairo_paint(canvas->cairo);
    return RUGA_OK;
}

// cairo numbers its surfaces from the start of the process: <g id="surface12">. Nothing refers to this name,
// so that without the digits the same drawing gives the same bytes.
static void drop_surface_numbers(ruga_canvas* canvas) {
    static const char name[] = "id=\"surface";
    int kept = 0;
    for (int i = 0; i < canvas->size;) {
        bool here =
            canvas->size - i > (int)sizeof name && memcmp(canvas->data + i, name, sizeof name - 1) == 0;
        int length = here ? (int)sizeof name - 1 : 1;
        memmove(canvas->data + kept, canvas->data + i, (size_t)length);
        kept += length;
        i += length;
        while (here && i < canvas->size && canvas->data[i] >= '0' && canvas->data[i] <= '9') {
            i++;
        }
    }
    canvas->size = kept;
}

static ruga_status write_file(const ruga_canvas* canvas) {
    char temporary[4096];
    if (snprintf(temporary, sizeof temporary, "%s.part", canvas->path) >= (int)sizeof temporary) {
        return ruga_fail(RUGA_BAD_INPUT, "the path of the plot is too long");
    }
    FILE* file = fopen(temporary, "wb");
    bool good = file && fwrite(canvas->data, 1, (size_t)canvas->size, file) == (size_t)canvas->size;
    good = (file && fclose(file) == 0) && good && rename(temporary, canvas->path) == 0;
    if (!good) {
        int reason = errno;
        (void)remove(temporary);
        return ruga_fail(RUGA_IO, "%s could not be written: %s", canvas->path, strerror(reason));
    }
    return RUGA_OK;
}

ruga_status ruga_canvas_close(ruga_canvas* canvas, ruga_status status) {
    if (canvas->cairo) {
        cairo_surface_t* surface = cairo_surface_reference(cairo_get_target(canvas->cairo));
        cairo_status_t drawn = cairo_status(canvas->cairo);
        cairo_destroy(canvas->cairo);
        if (drawn == CAIRO_STATUS_SUCCESS && status == RUGA_OK && !canvas->vector) {
            drawn = cairo_surface_write_to_png_stream(surface, collect, canvas);
        }
        cairo_surface_finish(surface);
        drawn = drawn == CAIRO_STATUS_SUCCESS ? cairo_surface_status(surface) : drawn;
        cairo_surface_destroy(surface);
        if (status == RUGA_OK && drawn != CAIRO_STATUS_SUCCESS) {
            status = ruga_fail(drawn == CAIRO_STATUS_NO_MEMORY ? RUGA_NO_MEMORY : RUGA_BAD_INPUT,
                               "%s could not be drawn: %s", canvas->path, cairo_status_to_string(drawn));
        }
    }
    if (status == RUGA_OK) {
        if (canvas->vector) {
            drop_surface_numbers(canvas);
        }
        status = write_file(canvas);
    }
    ruga_release(canvas->data);
    *canvas = (ruga_canvas){0};
    return status;
}

// ---- over a picture ------------------------------------------------------------------------------------

ruga_status ruga_canvas_open_pixels(int width, int height, const unsigned char* pixel, ruga_canvas* canvas) {
    *canvas = (ruga_canvas){.path = "the picture", .width = width, .height = height};
    cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    canvas->cairo = cairo_create(surface);
    cairo_surface_destroy(surface);
    if (cairo_status(canvas->cairo) != CAIRO_STATUS_SUCCESS) {
        cairo_destroy(canvas->cairo);
        return ruga_fail(RUGA_NO_MEMORY, "out of memory for a picture of %d x %d pixels", width, height);
    }
    cairo_surface_flush(surface);
    unsigned char* row = cairo_image_surface_get_data(surface);
    for (int y = 0; y < height; y++, row += cairo_image_surface_get_stride(surface)) {
        for (int x = 0; x < width; x++, pixel += 3) {
            uint32_t value = (uint32_t)pixel[0] << 16 | (uint32_t)pixel[1] << 8 | pixel[2];
            memcpy(row + 4 * (size_t)x, &value, sizeof value);
        }
    }
    cairo_surface_mark_dirty(surface);
    set_font(canvas->cairo);
    return RUGA_OK;
}

ruga_status ruga_canvas_close_pixels(ruga_canvas* canvas, unsigned char* pixel) {
    cairo_surface_t* surface = cairo_get_target(canvas->cairo);
    cairo_status_t drawn = cairo_status(canvas->cairo);
    cairo_surface_flush(surface);
    const unsigned char* row = cairo_image_surface_get_data(surface);
    for (int y = 0; y < (int)canvas->height; y++, row += cairo_image_surface_get_stride(surface)) {
        for (int x = 0; x < (int)canvas->width; x++, pixel += 3) {
            uint32_t value;
            memcpy(&value, row + 4 * (size_t)x, sizeof value);
            pixel[0] = (unsigned char)(value >> 16);
            pixel[1] = (unsigned char)(value >> 8);
            pixel[2] = (unsigned char)value;
        }
    }
    cairo_destroy(canvas->cairo);
    *canvas = (ruga_canvas){0};
    return drawn == CAIRO_STATUS_SUCCESS
               ? RUGA_OK
               : ruga_fail(RUGA_LIBRARY, "the legend could not be drawn: %s", cairo_status_to_string(drawn));
}

// ---- drawing -------------------------------------------------------------------------------------------

void ruga_canvas_color(ruga_canvas* canvas, unsigned color, double opacity) {
    cairo_set_source_rgba(canvas->cairo, (color >> 16 & 255) / 255.0, (color >> 8 & 255) / 255.0,
                          (color & 255) / 255.0, opacity);
}

double ruga_canvas_text_width(ruga_canvas* canvas, const char* text) {
    cairo_text_extents_t extents;
    cairo_text_extents(canvas->cairo, text, &extents);
    return extents.x_advance;
}

void ruga_canvas_text(ruga_canvas* canvas, double x, double y, double across, double up, double turn,
                      const char* text) {
    cairo_text_extents_t capital;
    double width = ruga_canvas_text_width(canvas, text);
    cairo_text_extents(canvas->cairo, "H", &capital);
    cairo_save(canvas->cairo);
    cairo_translate(canvas->cairo, x, y);
    cairo_rotate(canvas->cairo, -turn);
    cairo_move_to(canvas->cairo, -across * width, up * capital.height);
    cairo_show_text(canvas->cairo, text);
    cairo_restore(canvas->cairo);
}

void ruga_canvas_line(ruga_canvas* canvas, double x0, double y0, double x1, double y1) {
    cairo_move_to(canvas->cairo, x0, y0);
    cairo_line_to(canvas->cairo, x1, y1);
    cairo_stroke(canvas->cairo);
}
