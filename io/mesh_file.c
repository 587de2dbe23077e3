// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/mesh_file.h"

#include <string.h>

typedef ruga_status read_function(const char* path, ruga_mesh* mesh);
typedef ruga_status write_function(const char* path, const ruga_mesh* mesh, const double* normals,
                                   const char* comment);

static const struct {
    const char* ending;
    read_function* read;
    write_function* write; // NULL = only read
} formats[] = {
    {".obj", ruga_obj_read, ruga_obj_write}, {".ply", ruga_ply_read, ruga_ply_write},
    {".stl", ruga_stl_read, NULL},           {".off", ruga_off_read, NULL},
    {".gltf", ruga_gltf_read, NULL},         {".glb", ruga_gltf_read, NULL},
};
enum { FORMAT_COUNT = sizeof formats / sizeof *formats };

static bool has_ending(const char* path, const char* ending) {
    size_t length = strlen(path), tail = strlen(ending);
    if (length <= tail) {
        return false;
    }
    for (size_t i = 0; i < tail; i++) {
        char c = path[length - tail + i];
        char lower = (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
        if (lower != ending[i]) {
            return false;
        }
    }
    return true;
}

ruga_status ruga_mesh_read(const char* path, ruga_mesh* mesh) {
    *mesh = (ruga_mesh){0};
    for (int i = 0; i < FORMAT_COUNT; i++) {
        if (has_ending(path, formats[i].ending)) {
            return formats[i].read(path, mesh);
        }
    }
    return ruga_fail(RUGA_BAD_INPUT, "%s: surfaces are read from .obj, .ply, .stl, .off, .gltf and .glb",
                     path);
}

ruga_status ruga_mesh_write(const char* path, const ruga_mesh* mesh, const double* normals,
                            const char* comment) {
    for (int i = 0; i < FORMAT_COUNT; i++) {
        if (formats[i].write && has_ending(path, formats[i].ending)) {
            return formats[i].write(path, mesh, normals, comment);
        }
    }
    return ruga_fail(RUGA_BAD_INPUT, "%s: surfaces are written as .obj and .ply", path);
}
