// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// .glb: 12 bytes ("glTF", version 2, length), then chunks (length, type, bytes): JSON first, then BIN, which
// is buffer 0 where that has no uri. Buffers: a base64 data URI, or a file beside the .gltf
// (percent-encoded).
#include "io/gltf_buffer.h"

#include "core/memory.h"
#include "io/bytes.h"

#include <limits.h>
#include <string.h>

enum { HEADER_BYTES = 12, CHUNK_BYTES = 8 };
static const uint32_t CHUNK_JSON = 0x4e4f534a, CHUNK_BIN = 0x004e4942;

static int base64_digit(char c) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char* found = c ? strchr(digits, c) : NULL;
    return found ? (int)(found - digits) : -1;
}

static ruga_status decode_base64(const ruga_gltf_buffers* b, const char* text, ruga_gltf_bytes* bytes) {
    RUGA_TRY(RUGA_NEW(bytes->decoded, strlen(text) / 4 * 3 + 3));
    uint32_t bits = 0;
    int bit_count = 0;
    for (; *text && *text != '='; text++) {
        int digit = base64_digit(*text);
        if (digit < 0) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: a data URI is not base64", b->path);
        }
        bits = bits << 6 | (uint32_t)digit;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes->decoded[bytes->size++] = (char)(bits >> bit_count & 0xff);
        }
    }
    bytes->data = bytes->decoded;
    return RUGA_OK;
}

static int hex_digit(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

// path of `uri` beside the file, "%20" and the like resolved
static ruga_status join_path(const char* file, const char* uri, char** joined) {
    const char* slash = strrchr(file, '/');
    size_t folder = slash ? (size_t)(slash - file) + 1 : 0;
    RUGA_TRY(RUGA_NEW(*joined, folder + strlen(uri) + 1));
    memcpy(*joined, file, folder);
    char* to = *joined + folder;
    for (; *uri; uri++) {
        if (*uri == '%' && hex_digit(uri[1]) >= 0 && hex_digit(uri[2]) >= 0) {
            *to++ = (char)(16 * hex_digit(uri[1]) + hex_digit(uri[2]));
            uri += 2;
        } else {
            *to++ = *uri;
        }
    }
    *to = '\0';
    return RUGA_OK;
}

static ruga_status read_beside(const ruga_gltf_buffers* b, const char* uri, ruga_gltf_bytes* bytes) {
    if (strstr(uri, "://") || uri[0] == '/') {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the buffer '%.200s' is not a file beside it", b->path, uri);
    }
    char* path = NULL;
    RUGA_TRY(join_path(b->path, uri, &path));
    ruga_status status = ruga_text_load(path, &bytes->file);
    if (status != RUGA_OK) {
        status = ruga_fail_prefix(status, "%s", b->path);
    }
    bytes->data = bytes->file.data;
    bytes->size = bytes->file.size;
    bytes->file.path = NULL;
    ruga_release(path);
    return status;
}

static ruga_status load_buffer(const ruga_gltf_buffers* b, const json_t* json, const ruga_gltf_bytes* chunk,
                               ruga_gltf_bytes* bytes) {
    const char* uri = json_string_value(json_object_get(json, "uri"));
    if (!uri) {
        if (!chunk->data) {
            return RUGA_OK; // of a compressed mesh, perhaps: an error once it is used
        }
        bytes->data = chunk->data;
        bytes->size = chunk->size;
    } else if (strncmp(uri, "data:", 5) == 0) {
        const char* comma = strstr(uri, ";base64,");
        if (!comma) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: a data URI is not base64", b->path);
        }
        RUGA_TRY(decode_base64(b, comma + 8, bytes));
    } else {
        RUGA_TRY(read_beside(b, uri, bytes));
    }
    long long promised = json_integer_value(json_object_get(json, "byteLength"));
    if (promised < 0 || (uint64_t)promised > bytes->size) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: a buffer of %lld bytes has only %zu", b->path, promised,
                         bytes->size);
    }
    return RUGA_OK;
}

static ruga_status load_buffers(ruga_gltf_buffers* b, const ruga_gltf_bytes* chunk) {
    static const ruga_gltf_bytes none = {0};
    const json_t* list = json_object_get(b->root, "buffers");
    size_t count = json_array_size(list);
    RUGA_TRY(RUGA_NEW_ZERO(b->buffer, count));
    b->count = (int)count;
    for (size_t i = 0; i < count; i++) {
        RUGA_TRY(load_buffer(b, json_array_get(list, i), i == 0 ? chunk : &none, &b->buffer[i]));
    }
    return RUGA_OK;
}

static ruga_status parse_json(ruga_gltf_buffers* b, const char* text, size_t size) {
    json_error_t error;
    b->root = json_loadb(text, size, 0, &error);
    if (!b->root) {
        return ruga_fail(RUGA_BAD_INPUT, "%s:%d: not valid JSON: %s", b->path, error.line, error.text);
    }
    if (!json_is_object(b->root)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the JSON is not an object, as glTF is", b->path);
    }
    return RUGA_OK;
}

// Finds the JSON and BIN chunks.
static ruga_status split_chunks(const ruga_gltf_buffers* b, ruga_gltf_bytes* json, ruga_gltf_bytes* binary) {
    const ruga_text* file = &b->file;
    if (file->size < HEADER_BYTES || ruga_bytes_u32(file->data + 4, false) != 2) {
        return ruga_text_fail_at(file, 4, "not glTF version 2");
    }
    for (size_t at = HEADER_BYTES; at + CHUNK_BYTES <= file->size;) {
        size_t length = ruga_bytes_u32(file->data + at, false);
        uint32_t type = ruga_bytes_u32(file->data + at + 4, false);
        at += CHUNK_BYTES;
        if (length > file->size - at) {
            return ruga_text_fail_at(file, at, "a chunk of %zu bytes has only %zu", length, file->size - at);
        }
        ruga_gltf_bytes chunk = {.data = file->data + at, .size = length};
        if (type == CHUNK_JSON && !json->data) {
            *json = chunk;
        } else if (type == CHUNK_BIN && !binary->data) {
            *binary = chunk;
        }
        at += length;
    }
    return json->data ? RUGA_OK : ruga_text_fail_at(file, HEADER_BYTES, "the JSON chunk is missing");
}

ruga_status ruga_gltf_open(const char* path, ruga_gltf_buffers* buffers) {
    *buffers = (ruga_gltf_buffers){.path = path};
    ruga_gltf_bytes json = {0}, binary = {0};
    RUGA_TRY(ruga_text_load(path, &buffers->file));
    if (buffers->file.size >= 4 && memcmp(buffers->file.data, "glTF", 4) == 0) {
        RUGA_TRY(split_chunks(buffers, &json, &binary));
    } else {
        json.data = buffers->file.at;
        json.size = (size_t)(buffers->file.end - buffers->file.at);
    }
    RUGA_TRY(parse_json(buffers, json.data, json.size));
    return load_buffers(buffers, &binary);
}

void ruga_gltf_close(ruga_gltf_buffers* buffers) {
    for (int i = 0; i < buffers->count; i++) {
        ruga_release(buffers->buffer[i].decoded);
        ruga_text_close(&buffers->buffer[i].file);
    }
    ruga_release(buffers->buffer);
    json_decref(buffers->root);
    ruga_text_close(&buffers->file);
    *buffers = (ruga_gltf_buffers){0};
}

ruga_status ruga_gltf_view(const ruga_gltf_buffers* buffers, const json_t* number, const char** data,
                           size_t* length, size_t* stride) {
    const json_t* views = json_object_get(buffers->root, "bufferViews");
    const json_t* view =
        json_is_integer(number) ? json_array_get(views, (size_t)json_integer_value(number)) : NULL;
    if (!view) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: an accessor has no buffer view that exists", buffers->path);
    }
    long long index = json_integer_value(json_object_get(view, "buffer"));
    long long offset = json_integer_value(json_object_get(view, "byteOffset"));
    long long size = json_integer_value(json_object_get(view, "byteLength"));
    long long step = json_integer_value(json_object_get(view, "byteStride"));
    if (index < 0 || index >= buffers->count || !buffers->buffer[index].data) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: a buffer view names a buffer that does not exist",
                         buffers->path);
    }
    size_t whole = buffers->buffer[index].size;
    bool outside =
        offset < 0 || size < 0 || (uint64_t)offset > whole || (uint64_t)size > whole - (size_t)offset;
    if (outside || (step != 0 && (step < 4 || step > 252))) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: a buffer view reaches beyond the end of its buffer, or its stride is "
                         "not 4 to 252",
                         buffers->path);
    }
    *data = buffers->buffer[index].data + offset;
    *length = (size_t)size;
    *stride = (size_t)step;
    return RUGA_OK;
}
