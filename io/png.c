// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// 16 bits a number, linear (gAMA 1); what the numbers mean stands in tEXt chunks.
#include "core/memory.h"
#include "io/image.h"
#include "io/writer.h"

#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>

// libpng's own way out of a failure; its sentence is kept.
typedef struct trouble {
    char sentence[128];
    jmp_buf back;
} trouble;

static void fail(png_structp png, png_const_charp message) {
    trouble* t = png_get_error_ptr(png);
    (void)snprintf(t->sentence, sizeof t->sentence, "%s", message);
    longjmp(t->back, 1);
}

static void keep_quiet(png_structp png, png_const_charp message) {
    (void)png;
    (void)message;
}

static void write_texts(png_structp png, png_infop info, const ruga_image* image) {
    char scale[32], offset[32];
    (void)snprintf(scale, sizeof scale, "%.17g", image->scale);
    (void)snprintf(offset, sizeof offset, "%.17g", image->offset);
    const char* const texts[][2] = {{"Comment", image->comment},
                                    {"valueScale", scale},
                                    {"valueOffset", offset},
                                    {"valueUnit", image->unit}};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        png_text text = {
            .compression = PNG_TEXT_COMPRESSION_NONE, .key = (char*)texts[k][0], .text = (char*)texts[k][1]};
        png_set_text(png, info, &text, 1);
    }
}

// Big end first, as the file has it. Everything that libpng may jump out of.
static void write_rows(png_structp png, png_infop info, const ruga_image* image, FILE* file,
                       unsigned char* row) {
    size_t numbers = 3 * (size_t)image->width;
    png_init_io(png, file);
    png_set_IHDR(png, info, (png_uint_32)image->width, (png_uint_32)image->height, 16, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_gAMA(png, info, 1);
    write_texts(png, info, image);
    png_write_info(png, info);
    for (int y = 0; y < image->height; y++) {
        const float* pixel = image->pixel + numbers * (size_t)y;
        for (size_t i = 0; i < numbers; i++) {
            long value = lrintf(65535 * fminf(1, fmaxf(0, pixel[i])));
            row[2 * i] = (unsigned char)(value >> 8);
            row[2 * i + 1] = (unsigned char)(value & 255);
        }
        png_write_row(png, row);
    }
    png_write_end(png, info);
}

static ruga_status write_file(const ruga_image* image, const char* path, FILE* file, unsigned char* row) {
    trouble t = {.sentence = "out of memory"};
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &t, fail, keep_quiet);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    ruga_status status = RUGA_OK;
    if (!info || setjmp(t.back)) {
        status = ruga_fail(RUGA_IO, "%s: cannot be written: %s", path, t.sentence);
    } else {
        write_rows(png, info, image, file, row);
    }
    png_destroy_write_struct(&png, &info);
    return status;
}

ruga_status ruga_png_write(const char* path, const ruga_image* image) {
    unsigned char* row = NULL;
    ruga_writer writer;
    RUGA_TRY(RUGA_NEW(row, 6 * (size_t)image->width));
    ruga_status status = ruga_writer_open(path, &writer);
    if (status == RUGA_OK) {
        status = ruga_writer_close(&writer, write_file(image, path, writer.file, row));
    }
    ruga_release(row);
    return status;
}
