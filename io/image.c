// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/image.h"

#include <string.h>

static bool has_ending(const char* path, const char* ending) {
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcmp(path + length - tail, ending) == 0;
}

bool ruga_image_is_exr(const char* path) {
    return has_ending(path, ".exr");
}

ruga_status ruga_image_check(const char* path) {
    return has_ending(path, ".exr") || has_ending(path, ".png")
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT,
                           "%s: maps are written as .exr or .png; end the name in one of them", path);
}

ruga_status ruga_image_write(const char* path, const ruga_image* image) {
    RUGA_TRY(ruga_image_check(path));
    return has_ending(path, ".exr") ? ruga_exr_write(path, image) : ruga_png_write(path, image);
}
