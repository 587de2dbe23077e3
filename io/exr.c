// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// OpenEXR by its C library: scan lines, ZIP, channels R, G, B of 16 or 32 bits.
#define _POSIX_C_SOURCE 200809L
#include "io/image.h"
#include "io/writer.h"

#include <openexr.h>
#include <stdio.h>
#include <sys/types.h>

// What the library has to say of a failure is in the status that it returns.
static void keep_quiet(exr_const_context_t file, exr_result_t code, const char* message) {
    (void)file;
    (void)code;
    (void)message;
}

static int64_t write_bytes(exr_const_context_t file, void* writer, const void* bytes, uint64_t count,
                           uint64_t offset, exr_stream_error_func_ptr_t fail) {
    (void)file;
    (void)fail;
    FILE* out = ((ruga_writer*)writer)->file;
    bool written = fseeko(out, (off_t)offset, SEEK_SET) == 0 && fwrite(bytes, 1, count, out) == count;
    return written ? (int64_t)count : -1;
}

static const char channels[3][2] = {"B", "G", "R"}; // sorted, as in the file

static exr_result_t describe(exr_context_t file, const ruga_image* image, int* lines) {
    int part = 0;
    exr_pixel_type_t type = image->half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    exr_result_t result = exr_add_part(file, "map", EXR_STORAGE_SCANLINE, &part);
    result = result ? result
                    : exr_initialize_required_attr_simple(file, part, image->width, image->height,
                                                          EXR_COMPRESSION_ZIP);
    for (int c = 0; !result && c < 3; c++) {
        result = exr_add_channel(file, part, channels[c], type, EXR_PERCEPTUALLY_LINEAR, 1, 1);
    }
    result = result ? result : exr_attr_set_string(file, part, "comments", image->comment);
    result = result ? result : exr_attr_set_double(file, part, "valueScale", image->scale);
    result = result ? result : exr_attr_set_double(file, part, "valueOffset", image->offset);
    result = result ? result : exr_attr_set_string(file, part, "valueUnit", image->unit);
    result = result ? result : exr_write_header(file);
    return result ? result : exr_get_scanlines_per_chunk(file, part, lines);
}

static void point_to_pixels(const ruga_image* image, int y, exr_encode_pipeline_t* encoder) {
    for (int c = 0; c < 3; c++) {
        exr_coding_channel_info_t* channel = &encoder->channels[c];
        channel->encode_from_ptr =
            (const uint8_t*)(image->pixel + 3 * (size_t)y * (size_t)image->width + (2 - c));
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = sizeof(float);
        channel->user_pixel_stride = 3 * (int)sizeof(float);
        channel->user_line_stride = 3 * (int)sizeof(float) * image->width;
    }
}

static exr_result_t write_lines(exr_context_t file, const ruga_image* image, int lines) {
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_result_t result = EXR_ERR_SUCCESS;
    for (int y = 0; !result && y < image->height; y += lines) {
        exr_chunk_info_t chunk = {0};
        result = exr_write_scanline_chunk_info(file, 0, y, &chunk);
        if (!result) {
            result = y == 0 ? exr_encoding_initialize(file, 0, &chunk, &encoder)
                            : exr_encoding_update(file, 0, &chunk, &encoder);
        }
        if (!result) {
            point_to_pixels(image, y, &encoder);
            result = y == 0 ? exr_encoding_choose_default_routines(file, 0, &encoder) : EXR_ERR_SUCCESS;
        }
        result = result ? result : exr_encoding_run(file, 0, &encoder);
    }
    (void)exr_encoding_destroy(file, &encoder);
    return result;
}

ruga_status ruga_exr_write(const char* path, const ruga_image* image) {
    ruga_writer writer;
    int lines = 1;
    exr_context_t file = NULL;
    RUGA_TRY(ruga_writer_open(path, &writer));
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = keep_quiet;
    setup.user_data = &writer;
    setup.write_fn = write_bytes;
    exr_result_t result = exr_start_write(&file, path, EXR_WRITE_FILE_DIRECTLY, &setup);
    result = result ? result : describe(file, image, &lines);
    result = result ? result : write_lines(file, image, lines);
    exr_result_t finished = file ? exr_finish(&file) : result;
    result = result ? result : finished;
    return ruga_writer_close(&writer, result ? ruga_fail(RUGA_IO, "%s: cannot be written: %s", path,
                                                         exr_get_default_error_message(result))
                                             : RUGA_OK);
}
