// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A file that is there whole or not at all: written under a temporary name beside its place, then renamed.
#ifndef RUGA_IO_WRITER_H
#define RUGA_IO_WRITER_H

#include "core/status.h"

#include <stdio.h>

typedef struct ruga_writer {
    FILE* file; // errors of single calls may be ignored: ruga_writer_close finds them
    const char* path;
    char* temporary;
    void* locale;
} ruga_writer;

// Until it is closed, this thread's numbers are those of the C locale. RUGA_IO where it cannot be made.
ruga_status ruga_writer_open(const char* path, ruga_writer* writer);
// With RUGA_OK, puts the file in its place; RUGA_IO, and no file left behind, where a byte could not be
// written. With another status, removes it and returns that status.
ruga_status ruga_writer_close(ruga_writer* writer, ruga_status status);

// The shortest of 15 or 17 digits that reads back as the same bits, after a blank.
void ruga_writer_double(ruga_writer* writer, double value);
// The lines of `text`, each after `prefix`; NULL writes nothing.
void ruga_writer_comment(ruga_writer* writer, const char* prefix, const char* text);

// A name that fills its line: what would end it becomes a blank.
void ruga_writer_name(ruga_writer* writer, const char* name);

#endif
