// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L
#include "io/writer.h"

#include "core/memory.h"

#include <errno.h>
#include <locale.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

ruga_status ruga_writer_open(const char* path, ruga_writer* writer) {
    *writer = (ruga_writer){.path = path};
    size_t size = strlen(path) + 32;
    RUGA_TRY(RUGA_NEW(writer->temporary, size));
    (void)snprintf(writer->temporary, size, "%s.part%ld", path, (long)getpid());
    writer->file = fopen(writer->temporary, "wb");
    if (!writer->file) {
        int reason = errno;
        ruga_release(writer->temporary);
        *writer = (ruga_writer){0};
        return ruga_fail(RUGA_IO, "%s: cannot be written: %s", path, strerror(reason));
    }
    locale_t c = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    writer->locale = c ? (void*)uselocale(c) : NULL;
    return RUGA_OK;
}

// The bytes are on the disk before the new name is: a power cut leaves the old file or the new one.
static ruga_status flush_file(ruga_writer* writer) {
    errno = 0;
    bool failed = fflush(writer->file) != 0 || ferror(writer->file) != 0;
    // What is not a plain file (a pipe) cannot be synchronised, which is no failure.
    failed = failed || (fsync(fileno(writer->file)) != 0 && errno != EINVAL && errno != ENOTSUP);
    int reason = errno;
    failed = fclose(writer->file) != 0 || failed;
    if (failed) {
        return ruga_fail(RUGA_IO, "%s: writing failed (is the disk full?): %s", writer->path,
                         strerror(reason ? reason : errno));
    }
    return RUGA_OK;
}

ruga_status ruga_writer_close(ruga_writer* writer, ruga_status status) {
    if (writer->locale) {
        freelocale(uselocale((locale_t)writer->locale));
    }
    if (status == RUGA_OK) {
        status = flush_file(writer);
    } else {
        (void)fclose(writer->file);
    }
    if (status == RUGA_OK && rename(writer->temporary, writer->path) != 0) {
        status = ruga_fail(RUGA_IO, "%s: cannot be replaced: %s", writer->path, strerror(errno));
    }
    if (status != RUGA_OK) {
        (void)remove(writer->temporary);
    }
    ruga_release(writer->temporary);
    *writer = (ruga_writer){0};
    return status;
}

void ruga_writer_double(ruga_writer* writer, double value) {
    char text[32];
    (void)snprintf(text, sizeof text, "%.15g", value);
    if (strtod(text, NULL) != value) {
        (void)snprintf(text, sizeof text, "%.17g", value);
    }
    (void)fputc(' ', writer->file);
    (void)fputs(text, writer->file);
}

void ruga_writer_comment(ruga_writer* writer, const char* prefix, const char* text) {
    while (text && *text) {
        size_t length = strcspn(text, "\r\n");
        (void)fprintf(writer->file, "%s%.*s\n", prefix, (int)length, text);
        text += length + strspn(text + length, "\r\n");
    }
}

void ruga_writer_name(ruga_writer* writer, const char* name) {
    for (; *name; name++) {
        (void)fputc(*name == '\n' || *name == '\r' ? ' ' : *name, writer->file);
    }
}
