// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/frames.h"

#include "app/console.h"
#include "core/memory.h"
#include "io/file_name.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBER_WIDTH_MAX = 20 };

ruga_status ruga_open_result(const char* path, ruga_result_reader** reader) {
    *reader = NULL;
    RUGA_TRY(ruga_check_input(path));
    RUGA_TRY(ruga_result_open(path, reader));
    if (ruga_result_frame_count(*reader) < 1) {
        ruga_result_reader_close(reader);
        return ruga_fail(RUGA_BAD_INPUT, "%s has no whole frame yet", path);
    }
    return RUGA_OK;
}

// "A:B" or "K"
static bool parse_range(const char* text, long* first, long* last) {
    char* end;
    errno = 0;
    *first = *last = strtol(text, &end, 10);
    bool good = end != text;
    if (good && *end == ':') {
        text = end + 1;
        *last = strtol(text, &end, 10);
        good = end != text;
    }
    return good && !*end && !errno;
}

ruga_status ruga_choose_frames(const ruga_arguments* arguments, int frame_count, bool all,
                               ruga_frame_range* range) {
    const char *one = ruga_value(arguments, "--frame"), *several = ruga_value(arguments, "--frames");
    *range = (ruga_frame_range){all ? 0 : frame_count - 1, frame_count - 1};
    if (one && several) {
        return ruga_fail(RUGA_BAD_INPUT, "--frame and --frames exclude each other");
    }
    if (one) {
        RUGA_TRY(ruga_integer(arguments, "--frame", 0, frame_count - 1, &range->first));
        range->last = range->first;
    }
    long first, last;
    if (!several) {
        return RUGA_OK;
    }
    if (!parse_range(several, &first, &last) || first > last) {
        return ruga_fail(RUGA_BAD_INPUT, "--frames: %s is not a range such as 0:%d (both ends included)",
                         several, frame_count - 1);
    }
    if (first < 0 || last >= frame_count) {
        return ruga_fail(RUGA_BAD_INPUT, "--frames: %s is outside of the result's frames 0:%d", several,
                         frame_count - 1);
    }
    *range = (ruga_frame_range){(int)first, (int)last};
    return RUGA_OK;
}

bool ruga_has_pattern(const char* path) {
    size_t length;
    return ruga_file_name_place(path, &length) != NULL;
}

ruga_status ruga_check_pattern(const char* path, const ruga_frame_range* range) {
    size_t length, other;
    const char* place = ruga_file_name_place(path, &length);
    if (!place && range->last > range->first) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: several frames need a place for their number in the name, such as %%04d", path);
    }
    if (place && ruga_file_name_place(place + length, &other)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the name has more than one place for the frame's number", path);
    }
    if (place && strtol(place + 1, NULL, 10) > NUMBER_WIDTH_MAX) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: at most %d digits for the frame's number", path,
                         NUMBER_WIDTH_MAX);
    }
    return RUGA_OK;
}

ruga_status ruga_frame_path(const char* pattern, int frame, char** path) {
    size_t size = strlen(pattern) + NUMBER_WIDTH_MAX + 16;
    RUGA_TRY(RUGA_NEW(*path, size));
    ruga_file_name_number(pattern, frame, *path, size);
    return RUGA_OK;
}
