// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Arrays are compressed by zlib and written in base64 (RFC 4648), each in a script element of its own that
// browsers do not run. The difference of a frame to the one before, with low and high bytes apart, is what
// compresses well.
#define _POSIX_C_SOURCE 200809L
#include "view/page.h"

#include "core/memory.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

void ruga_page_pack(int count, const double* position, const double low[3], double step, uint16_t* place,
                    unsigned char* bytes) {
    for (int i = 0; i < count; i++) {
        double at = step > 0 ? (position[i] - low[i % 3]) / step : 0;
        uint16_t now = (uint16_t)(fmin(fmax(at, 0), 65535) + 0.5);
        uint16_t difference = (uint16_t)(now - place[i]);
        bytes[i] = (unsigned char)(difference & 255);
        bytes[(size_t)count + (size_t)i] = (unsigned char)(difference >> 8);
        place[i] = now;
    }
}

// ---- writing -------------------------------------------------------------------------------------------

static void write_base64(FILE* file, const unsigned char* data, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        unsigned bits = (unsigned)data[i] << 16 | (left > 1 ? (unsigned)data[i + 1] << 8 : 0) |
                        (left > 2 ? data[i + 2] : 0);
        (void)fputc(digits[bits >> 18], file);
        (void)fputc(digits[bits >> 12 & 63], file);
        (void)fputc(left > 1 ? digits[bits >> 6 & 63] : '=', file);
        (void)fputc(left > 2 ? digits[bits & 63] : '=', file);
    }
}

static ruga_status write_array(FILE* file, const ruga_page_array* array) {
    uLongf size = compressBound(array->size);
    unsigned char* packed = NULL;
    RUGA_TRY(RUGA_NEW(packed, size));
    int result = compress2(packed, &size, array->data, array->size, Z_DEFAULT_COMPRESSION);
    if (result == Z_OK) {
        (void)fprintf(file, "<script type=\"application/octet-stream\" id=\"%s\">", array->id);
        write_base64(file, packed, size);
        (void)fputs("</script>\n", file);
    }
    ruga_release(packed);
    return result == Z_OK ? RUGA_OK : ruga_fail(RUGA_NO_MEMORY, "out of memory: the page's %s", array->id);
}

// Where the data go into the shell.
static const char* find_place(const char* mark) {
    size_t length = strlen(mark);
    for (size_t i = 0; i + length <= ruga_page_shell_size; i++) {
        if (memcmp(ruga_page_shell + i, mark, length) == 0) {
            return (const char*)ruga_page_shell + i;
        }
    }
    return NULL;
}

static ruga_status write_all(FILE* file, const char* json, int count, const ruga_page_array* arrays) {
    static const char mark[] = "<!--DATA-->";
    const char *shell = (const char*)ruga_page_shell, *place = find_place(mark);
    RUGA_ASSERT(place && !strstr(json, "</"));
    const char* rest = place + strlen(mark);
    (void)fwrite(shell, 1, (size_t)(place - shell), file);
    (void)fprintf(file, "<script type=\"application/json\" id=\"meta\">%s</script>\n", json);
    for (int i = 0; i < count; i++) {
        RUGA_TRY(write_array(file, &arrays[i]));
    }
    (void)fwrite(rest, 1, ruga_page_shell_size - (size_t)(rest - shell), file);
    return RUGA_OK;
}

ruga_status ruga_page_write(const char* path, const char* json, int count, const ruga_page_array* arrays) {
    char temporary[4096];
    if (ruga_page_shell_size == 0) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "this ruga was built without npm, and so without the page that view writes: "
                         "install node and npm and build again");
    }
    if (snprintf(temporary, sizeof temporary, "%s.part", path) >= (int)sizeof temporary) {
        return ruga_fail(RUGA_BAD_INPUT, "the path of the page is too long");
    }
    FILE* file = fopen(temporary, "wb");
    ruga_status status = file ? write_all(file, json, count, arrays) : RUGA_OK;
    bool good = file && !ferror(file);
    good = file && fclose(file) == 0 && good;
    if (status == RUGA_OK && !(good && rename(temporary, path) == 0)) {
        status = ruga_fail(RUGA_IO, "%s could not be written: %s", path, strerror(errno));
    }
    if (status != RUGA_OK) {
        (void)remove(temporary);
    }
    return status;
}
