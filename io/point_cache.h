// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Point caches: positions of a mesh's vertices over time. PC2, MDD, or a sequence of OBJ files; one sample is
// read at a time.
#ifndef RUGA_IO_POINT_CACHE_H
#define RUGA_IO_POINT_CACHE_H

#include "io/animation.h"
#include "io/bytes.h"

#include <math.h>
#include <stdio.h>

typedef struct ruga_point_cache {
    char* path;
    int point_count, sample_count;
    double* time;      // [samples] ascending: s for MDD, otherwise frames
    bool time_is_real; // s
    FILE* file;        // NULL for a sequence
    bool big;
    long long size, data; // of the file in bytes; where the first sample begins
    int first;            // number of a sequence's first file
    char* sample;         // [points][3] floats as in the file
} ruga_point_cache;

// By the ending: .pc2, .mdd, or a name with %d or %04d in it that ends in .obj (numbered from 0 or 1 without
// a gap).
ruga_status ruga_point_cache_open(const char* path, ruga_point_cache* cache);
void ruga_point_cache_close(ruga_point_cache* cache);
// position [points][3]; RUGA_BAD_INPUT with the place where a number is not finite.
ruga_status ruga_point_cache_read(ruga_point_cache* cache, int sample, double* position);

// ---- one file per format: io/pc2.c, io/mdd.c

ruga_status ruga_pc2_open(ruga_point_cache* cache);
ruga_status ruga_mdd_open(ruga_point_cache* cache);

// Of these: bytes of the file, and its sizes, which must be those that its length says.
ruga_status ruga_point_cache_bytes(ruga_point_cache* cache, long long begin, size_t count, char* bytes);
ruga_status ruga_point_cache_size(ruga_point_cache* cache, uint32_t points, uint32_t samples);
// Opens the file, gives room for a frame, closes.
typedef ruga_status ruga_point_cache_content(ruga_writer* writer, const ruga_animation* animation,
                                             double* scratch, float* position);
ruga_status ruga_point_cache_write(const char* path, const ruga_animation* animation,
                                   ruga_point_cache_content* content);

#endif
