// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The JSON and the bytes of a glTF file, wherever they lie.
#ifndef RUGA_IO_GLTF_BUFFER_H
#define RUGA_IO_GLTF_BUFFER_H

#include "core/status.h"
#include "io/text.h"

#include <jansson.h>

typedef struct ruga_gltf_bytes {
    const char* data;
    size_t size;
    char* decoded;  // owned: of a data URI
    ruga_text file; // owned: of a file beside it
} ruga_gltf_bytes;

typedef struct ruga_gltf_buffers {
    ruga_text file;
    json_t* root;
    const char* path;
    int count;
    ruga_gltf_bytes* buffer;
} ruga_gltf_buffers;

ruga_status ruga_gltf_open(const char* path, ruga_gltf_buffers* buffers);
void ruga_gltf_close(ruga_gltf_buffers* buffers);
// The bytes of the buffer view with this number; *stride = 0 where it gives none, else 4 to 252.
ruga_status ruga_gltf_view(const ruga_gltf_buffers* buffers, const json_t* number, const char** data,
                           size_t* length, size_t* stride);

#endif
