// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Numbers in a file's bytes, whatever the machine's own byte order and alignment.
#ifndef RUGA_IO_BYTES_H
#define RUGA_IO_BYTES_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t ruga_bytes_unsigned(const char* at, int size, bool big) {
    const unsigned char* byte = (const unsigned char*)at;
    uint64_t value = 0;
    for (int i = 0; i < size; i++) {
        value = value << 8 | byte[big ? i : size - 1 - i];
    }
    return value;
}

static inline uint32_t ruga_bytes_u32(const char* at, bool big) {
    return (uint32_t)ruga_bytes_unsigned(at, 4, big);
}

static inline float ruga_bytes_f32(const char* at, bool big) {
    uint32_t bits = ruga_bytes_u32(at, big);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline double ruga_bytes_f64(const char* at, bool big) {
    uint64_t bits = ruga_bytes_unsigned(at, 8, big);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
