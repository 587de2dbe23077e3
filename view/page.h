// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// One HTML file that shows an animation in any browser, without a network: a shell made by view/web at build
// time, a JSON object, and packed arrays.
#ifndef RUGA_VIEW_PAGE_H
#define RUGA_VIEW_PAGE_H

#include "core/status.h"

// The shell, with its script inside; size 0 where this was built without npm.
extern const size_t ruga_page_shell_size;
extern const unsigned char ruga_page_shell[];

typedef struct ruga_page_array {
    const char* id; // as view/web/main.js asks for it
    size_t size;
    const unsigned char* data;
} ruga_page_array;

// Positions [count] as 16-bit places low[i % 3] + step place, in `place`, which holds those of the frame
// before: to bytes [2 count], the differences' low bytes and then their high ones.
void ruga_page_pack(int count, const double* position, const double low[3], double step, uint16_t* place,
                    unsigned char* bytes);

// `json`: the object that main.js reads, without "</". The file is there whole or not at all. RUGA_BAD_INPUT
// where there is no shell.
ruga_status ruga_page_write(const char* path, const char* json, int count, const ruga_page_array* arrays);

#endif
