// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A whole file in memory, read word by word and line by line, with numbers as in the C locale.
#ifndef RUGA_IO_TEXT_H
#define RUGA_IO_TEXT_H

#include "core/status.h"

typedef struct ruga_text {
    const char* path;
    char* data; // [size + 1], ended by '\0'
    size_t size;
    const char* at; // next character to read
    const char* end;
    int line;       // of `at`, from 1
    bool comments;  // '#' ends a line
    bool continued; // a line that ends in '\' goes on in the next
    void* locale;   // what ruga_text_close puts back
} ruga_text;

// Reads a file; RUGA_IO where that fails. Until it is closed, this thread's numbers are those of the C
// locale.
ruga_status ruga_text_open(const char* path, ruga_text* text);
// The same, but the locale stays as it is: for bytes.
ruga_status ruga_text_load(const char* path, ruga_text* text);
void ruga_text_close(ruga_text* text);

// RUGA_BAD_INPUT with "path:line: " before the sentence, or "path, byte N: " for binary content.
ruga_status ruga_text_fail(const ruga_text* text, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
ruga_status ruga_text_fail_at(const ruga_text* text, size_t byte, const char* format, ...)
    __attribute__((format(printf, 3, 4)));

// Skips blanks; true where nothing more stands in the line.
bool ruga_text_line_ends(ruga_text* text);
// Goes behind the end of the line; false at the end of the file.
bool ruga_text_next_line(ruga_text* text);
// Goes to the next word, over line ends; false at the end of the file.
bool ruga_text_skip_lines(ruga_text* text);
// The next word of the line (not ended by '\0'); length 0 at the line's end.
const char* ruga_text_word(ruga_text* text, size_t* length);
// Takes the next word where it is `wanted`.
bool ruga_text_take(ruga_text* text, const char* wanted);
// The rest of the line without blanks around it (comments are part of it); *length may be 0.
const char* ruga_text_rest(ruga_text* text, size_t* length);
// A number that ends at a blank, a line's end or `stop` (0 = none). False, and nothing taken, where there is
// none. Takes nan and inf.
bool ruga_text_double(ruga_text* text, double* value);
bool ruga_text_integer(ruga_text* text, char stop, long long* value);
// The next word for an error: at most 40 printable characters.
void ruga_text_quote(ruga_text* text, char quoted[44]);

#endif
