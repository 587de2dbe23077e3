// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For tests of readers: files in a folder of the test's own. Include it first, and run the group with
// make_folder and remove_folder.
#ifndef RUGA_TESTS_FILES_H
#define RUGA_TESTS_FILES_H

#include "io/mesh_file.h"
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "ruga_files_XXXXXX";

static inline int make_folder(void** state) {
    (void)state;
    return mkdtemp(folder) ? 0 : 1;
}

static inline int remove_folder(void** state) {
    return rmdir(folder) | check_no_leak(state); // every test removes its files
}

// The path of a file in the test's folder; one at a time.
static inline const char* in_folder(const char* name) {
    static char path[256];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static inline const char* write_bytes(const char* name, const void* data, size_t size) {
    const char* path = in_folder(name);
    FILE* file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    return path;
}

static inline ruga_status read_bytes(const char* name, const void* data, size_t size, ruga_mesh* mesh) {
    const char* path = write_bytes(name, data, size);
    ruga_status status = ruga_mesh_read(path, mesh);
    assert_int_equal(unlink(path), 0);
    return status;
}

static inline ruga_status read_text(const char* name, const char* text, ruga_mesh* mesh) {
    return read_bytes(name, text, strlen(text), mesh);
}

static inline void put32(char* at, uint32_t value) {
    for (int i = 0; i < 4; i++) {
        at[i] = (char)(value >> 8 * i & 0xff);
    }
}

static inline void put_float(char* at, float value) {
    uint32_t bits;
    memcpy(&bits, &value, 4);
    put32(at, bits);
}

// A tetrahedron as binary STL, its title being "solid ...": 84 + 4 * 50 bytes
static inline void read_until_success(const char* path) {
    for (int k = 0;; k++) {
        ruga_mesh mesh;
        let_allocations_fail_after(k);
        ruga_status status = ruga_mesh_read(path, &mesh);
        if (status == RUGA_OK) {
            allocations_left = 1000;
            status = ruga_mesh_write(path, &mesh, NULL, NULL) == RUGA_NO_MEMORY ? RUGA_NO_MEMORY : RUGA_OK;
            ruga_mesh_clear(&mesh);
        }
        ruga_set_allocator(NULL, NULL, NULL);
        assert_int_equal(ruga_byte_count(), 0);
        if (status == RUGA_OK) {
            assert_true(k > 0);
            return;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
        assert_true(k < 1000);
    }
}

#endif
