// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "core/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ERROR_LENGTH = 4096 };

static _Thread_local char last_error[ERROR_LENGTH];
static ruga_assert_function* assert_handler;

const char* ruga_version(void) {
    return RUGA_VERSION;
}

const char* ruga_status_text(ruga_status status) {
#define SENTENCE(code, sentence) sentence,
    static const char* const sentences[] = {RUGA_STATUS_LIST(SENTENCE)};
#undef SENTENCE
    return (unsigned)status < RUGA_STATUS_COUNT ? sentences[status] : "unknown status";
}

const char* ruga_last_error(void) {
    return last_error;
}

ruga_status ruga_fail(ruga_status status, const char* format, ...) {
    // Formatted aside first: an argument may be the old sentence itself.
    char text[ERROR_LENGTH];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    memcpy(last_error, text, sizeof text);
    return status;
}

ruga_status ruga_fail_prefix(ruga_status status, const char* format, ...) {
    char prefix[ERROR_LENGTH];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(prefix, sizeof prefix, format, arguments);
    va_end(arguments);
    return ruga_fail(status, "%s: %s", prefix, last_error);
}

void ruga_set_assert_handler(ruga_assert_function* handler) {
    assert_handler = handler;
}

void ruga_assert_failed(const char* condition, const char* file, int line) {
    if (assert_handler) {
        assert_handler(condition, file, line);
        return;
    }
    (void)fprintf(stderr, "%s:%d: misuse of Ruga: %s does not hold\n", file, line, condition);
    abort();
}
