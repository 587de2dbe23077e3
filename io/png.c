// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "core/memory.h"
#include "io/image.h"
#include "io/writer.h"

#include <math.h>
#include <png.h>

// Linear, as numbers are: libpng says so in the file.
ruga_status ruga_png_write(const char* path, const ruga_image* image) {
    ruga_status status = RUGA_OK;
    png_uint_16* row = NULL;
    ruga_writer writer;
    size_t count = 3 * (size_t)image->width * (size_t)image->height;
    RUGA_TRY(RUGA_NEW(row, count));
    for (size_t i = 0; i < count; i++) {
        row[i] = (png_uint_16)lrintf(65535 * fminf(1, fmaxf(0, image->pixel[i])));
    }
    status = ruga_writer_open(path, &writer);
    if (status == RUGA_OK) {
        png_image png = {.version = PNG_IMAGE_VERSION,
                         .width = (png_uint_32)image->width,
                         .height = (png_uint_32)image->height,
                         .format = PNG_FORMAT_FLAG_LINEAR | PNG_FORMAT_FLAG_COLOR};
        bool written = png_image_write_to_stdio(&png, writer.file, 0, row, 0, NULL) != 0;
        status = ruga_writer_close(
            &writer, written ? RUGA_OK : ruga_fail(RUGA_IO, "%s: cannot be written: %s", path, png.message));
    }
    ruga_release(row);
    return status;
}
