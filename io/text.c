// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Numbers of up to 15 digits with a power of ten up to 22 are one exact product or quotient of doubles
// (Clinger 1990); all others go to strtod. Both round correctly.
#define _POSIX_C_SOURCE 200809L
#include "io/text.h"

#include "core/memory.h"

#include <errno.h>
#include <limits.h>
#include <locale.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The whole stream in memory; its size is what is read, not what is promised.
static ruga_status read_stream(FILE* file, const char* path, char** data, size_t* size) {
    size_t capacity = 1 << 16;
    *size = 0;
    RUGA_TRY(RUGA_NEW(*data, capacity));
    for (;;) {
        *size += fread(*data + *size, 1, capacity - 1 - *size, file);
        if (ferror(file)) {
            return ruga_fail(RUGA_IO, "%s: cannot be read: %s", path, strerror(errno));
        }
        if (*size < capacity - 1) {
            (*data)[*size] = '\0';
            return RUGA_OK;
        }
        char* grown = capacity <= SIZE_MAX / 4 ? ruga_reallocate(*data, 2 * capacity) : NULL;
        if (!grown) {
            return ruga_fail(RUGA_NO_MEMORY, "%s: out of memory after %zu bytes", path, *size);
        }
        *data = grown;
        capacity *= 2;
    }
}

static ruga_status read_file(const char* path, char** data, size_t* size) {
    FILE* file = fopen(path, "rb");
    if (!file) {
        return ruga_fail(RUGA_IO, "%s: cannot be opened: %s", path, strerror(errno));
    }
    ruga_status status = read_stream(file, path, data, size);
    (void)fclose(file);
    return status;
}

ruga_status ruga_text_load(const char* path, ruga_text* text) {
    *text = (ruga_text){.path = path, .line = 1};
    ruga_status status = read_file(path, &text->data, &text->size);
    if (status != RUGA_OK) {
        ruga_release(text->data);
        *text = (ruga_text){.path = path};
        return status;
    }
    text->at = text->data;
    text->end = text->data + text->size;
    static const char mark[] = "\xef\xbb\xbf"; // UTF-8 byte order mark of some editors
    if (text->size >= 3 && memcmp(text->data, mark, 3) == 0) {
        text->at += 3;
    }
    return RUGA_OK;
}

ruga_status ruga_text_open(const char* path, ruga_text* text) {
    RUGA_TRY(ruga_text_load(path, text));
    // Where the locale cannot be had the C locale is most likely in use anyway.
    locale_t c = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    text->locale = c ? (void*)uselocale(c) : NULL;
    return RUGA_OK;
}

void ruga_text_close(ruga_text* text) {
    if (text->locale) {
        freelocale(uselocale((locale_t)text->locale));
    }
    ruga_release(text->data);
    *text = (ruga_text){0};
}

ruga_status ruga_text_fail(const ruga_text* text, const char* format, ...) {
    char sentence[2048];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    return ruga_fail(RUGA_BAD_INPUT, "%s:%d: %s", text->path, text->line, sentence);
}

ruga_status ruga_text_fail_at(const ruga_text* text, size_t byte, const char* format, ...) {
    char sentence[2048];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    return ruga_fail(RUGA_BAD_INPUT, "%s, byte %zu: %s", text->path, byte, sentence);
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static bool is_line_end(const ruga_text* text, const char* at) {
    return at == text->end || *at == '\n' || *at == '\r';
}

static bool is_word_end(const ruga_text* text, const char* at) {
    return is_line_end(text, at) || is_blank(*at);
}

// Over one line end, "\r\n" being one.
static void take_line_end(ruga_text* text) {
    text->at += text->at[0] == '\r' && text->at[1] == '\n' ? 2 : 1;
    text->line++;
}

// At a backslash that ends its line?
static bool at_continuation(const ruga_text* text) {
    const char* at = text->at;
    if (!text->continued || at == text->end || *at != '\\') {
        return false;
    }
    at++;
    while (at < text->end && is_blank(*at)) {
        at++;
    }
    return at < text->end && is_line_end(text, at);
}

bool ruga_text_line_ends(ruga_text* text) {
    for (;;) {
        while (text->at < text->end && is_blank(*text->at)) {
            text->at++;
        }
        if (!at_continuation(text)) {
            return is_line_end(text, text->at) || (text->comments && *text->at == '#');
        }
        while (!is_line_end(text, text->at)) {
            text->at++;
        }
        take_line_end(text);
    }
}

bool ruga_text_next_line(ruga_text* text) {
    while (!is_line_end(text, text->at)) {
        text->at++;
    }
    if (text->at == text->end) {
        return false;
    }
    take_line_end(text);
    return true;
}

bool ruga_text_skip_lines(ruga_text* text) {
    while (ruga_text_line_ends(text)) {
        if (!ruga_text_next_line(text)) {
            return false;
        }
    }
    return true;
}

const char* ruga_text_word(ruga_text* text, size_t* length) {
    *length = 0;
    if (ruga_text_line_ends(text)) {
        return text->at;
    }
    const char* word = text->at;
    while (!is_word_end(text, text->at) && !at_continuation(text)) {
        text->at++;
    }
    *length = (size_t)(text->at - word);
    return word;
}

bool ruga_text_take(ruga_text* text, const char* wanted) {
    ruga_text before = *text;
    size_t length;
    const char* word = ruga_text_word(text, &length);
    if (length == strlen(wanted) && memcmp(word, wanted, length) == 0) {
        return true;
    }
    text->at = before.at;
    text->line = before.line;
    return false;
}

const char* ruga_text_rest(ruga_text* text, size_t* length) {
    while (text->at < text->end && is_blank(*text->at)) {
        text->at++;
    }
    const char* rest = text->at;
    while (!is_line_end(text, text->at)) {
        text->at++;
    }
    const char* last = text->at;
    while (last > rest && is_blank(last[-1])) {
        last--;
    }
    *length = (size_t)(last - rest);
    return rest;
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

// A decimal number that is one exact operation; NULL where it is not, else the end of the number.
static const char* exact_double(const char* at, double* value) {
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    bool negative = *at == '-';
    at += *at == '-' || *at == '+';
    int64_t digits = 0;
    int count = 0, exponent = 0;
    bool point = false, any = false;
    for (; is_digit(*at) || (*at == '.' && !point); at++) {
        if (*at == '.') {
            point = true;
            continue;
        }
        any = true;
        digits = 10 * digits + (*at - '0');
        count += digits > 0;
        exponent -= point;
        if (count > 15) {
            return NULL;
        }
    }
    if (!any) {
        return NULL;
    }
    if (*at == 'e' || *at == 'E') {
        bool down = at[1] == '-';
        const char* digit = at + 1 + (at[1] == '-' || at[1] == '+');
        int written = 0;
        if (!is_digit(*digit)) {
            return NULL;
        }
        for (; is_digit(*digit); digit++) {
            written = written < 1000 ? 10 * written + (*digit - '0') : written;
        }
        exponent += down ? -written : written;
        at = digit;
    }
    if (exponent < -22 || exponent > 22) {
        return NULL;
    }
    double magnitude = exponent < 0 ? (double)digits / power[-exponent] : (double)digits * power[exponent];
    *value = negative ? -magnitude : magnitude;
    return at;
}

bool ruga_text_double(ruga_text* text, double* value) {
    if (ruga_text_line_ends(text)) {
        return false;
    }
    double number;
    const char* after = exact_double(text->at, &number);
    if (!after || !is_word_end(text, after)) {
        char* end;
        number = strtod(text->at, &end);
        if (end == text->at || end > text->end || (!is_word_end(text, end) && *end != '\\' && *end != '#')) {
            return false;
        }
        after = end;
    }
    *value = number;
    text->at = after;
    return true;
}

bool ruga_text_integer(ruga_text* text, char stop, long long* value) {
    if (ruga_text_line_ends(text)) {
        return false;
    }
    const char* at = text->at;
    bool negative = *at == '-';
    at += *at == '-' || *at == '+';
    const char* first = at;
    long long number = 0;
    for (; is_digit(*at); at++) {
        number = number < LLONG_MAX / 20 ? 10 * number + (*at - '0') : LLONG_MAX / 10;
    }
    bool ends =
        is_word_end(text, at) || (stop && *at == stop) || *at == '\\' || (text->comments && *at == '#');
    if (at == first || !ends) {
        return false;
    }
    *value = negative ? -number : number;
    text->at = at;
    return true;
}

void ruga_text_quote(ruga_text* text, char quoted[44]) {
    size_t length;
    ruga_text copy = *text;
    const char* word = ruga_text_word(&copy, &length);
    if (length == 0) {
        (void)snprintf(quoted, 44, "the line's end");
        return;
    }
    size_t shown = length > 36 ? 36 : length;
    quoted[0] = '\'';
    for (size_t i = 0; i < shown; i++) {
        unsigned char c = (unsigned char)word[i];
        quoted[i + 1] = (char)(c >= 32 && c < 127 ? c : '?');
    }
    (void)snprintf(quoted + shown + 1, 44 - shown - 1, "%s'", length > shown ? "..." : "");
}
