// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A moving surface to files that hold all of its frames: glTF, USD, point caches. Frames are asked for one at
// a time, in order, as often as a format needs them, so that no file has to fit into memory.
#ifndef RUGA_IO_ANIMATION_H
#define RUGA_IO_ANIMATION_H

#include "io/writer.h"
#include "mesh/mesh.h"

typedef struct ruga_animation {
    const char* name;      // of the object: any text but the empty one
    const char* comment;   // may be NULL
    const ruga_mesh* mesh; // triangles, uvs and groups; its positions are not looked at
    int first, count;      // frame numbers first ... first + count - 1
    double unit;           // m per unit of the positions
    int up;                // the axis that points up: 1 = y, 2 = z
    double rate;           // frames per second; frame k is shown k / rate after frame 0
    // Positions [V][3] in units and unit normals [V][3] of a frame; `normal` may be NULL.
    ruga_status (*read)(void* context, int frame, double* position, double* normal);
    void* context;
} ruga_animation;

// One file per format, same function: io/gltf_animation.c, io/pc2.c, io/mdd.c, io/usda.c. Whole or not at
// all.
typedef ruga_status ruga_animation_write(const char* path, const ruga_animation* animation);
ruga_animation_write ruga_gltf_animation_write, ruga_pc2_animation_write, ruga_mdd_animation_write,
    ruga_usda_animation_write;

// Reads a frame and rounds it to floats [V][3] each; RUGA_BAD_INPUT with the place where a number is not
// finite or beyond a float's range. double* scratch [2][V][3]; normal and its half of scratch may be left out
// (NULL).
ruga_status ruga_animation_read(const ruga_animation* animation, int frame, double* scratch, float* position,
                                float* normal);

// Bytes of numbers, whatever the machine's order.
void ruga_animation_put_u32(ruga_writer* writer, uint32_t value, bool big);
void ruga_animation_put_floats(ruga_writer* writer, const float* value, size_t count, bool big);

// A primitive for each group (the last one for faces in none): order [F] = faces sorted by group, stable;
// start [G + 2] = where each group's faces begin.
void ruga_animation_sort_faces(const ruga_mesh* mesh, int* order, int* start);

#endif
