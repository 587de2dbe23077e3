// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/file_name.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool ruga_file_name_ends(const char* name, const char* ending) {
    size_t length = strlen(name), tail = strlen(ending);
    return length > tail && strcmp(name + length - tail, ending) == 0;
}

const char* ruga_file_name_place(const char* name, size_t* length) {
    for (const char* at = strchr(name, '%'); at; at = strchr(at + 1, '%')) {
        size_t digits = strspn(at + 1, "0123456789");
        if (at[1 + digits] == 'd') {
            *length = digits + 2;
            return at;
        }
    }
    return NULL;
}

void ruga_file_name_number(const char* pattern, int number, char* name, size_t size) {
    size_t length = 0;
    const char* place = ruga_file_name_place(pattern, &length);
    if (!place) {
        (void)snprintf(name, size, "%s", pattern);
        return;
    }
    int width = (int)strtol(place + 1, NULL, 10);
    (void)snprintf(name, size, place[1] == '0' ? "%.*s%0*d%s" : "%.*s%*d%s", (int)(place - pattern), pattern,
                   width, number, place + length);
}
