// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/animation.h"

#include <float.h>
#include <math.h>
#include <string.h>

ruga_status ruga_animation_read(const ruga_animation* animation, int frame, double* scratch, float* position,
                                float* normal) {
    size_t count = 3 * (size_t)animation->mesh->vertex_count;
    double* directions = normal ? scratch + count : NULL;
    RUGA_TRY(animation->read(animation->context, frame, scratch, directions));
    for (size_t i = 0; i < count; i++) {
        if (!(fabs(scratch[i]) <= (double)FLT_MAX)) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "frame %d: coordinate %c of vertex %zu is %g, which this format cannot hold",
                             frame, "xyz"[i % 3], i / 3, scratch[i]);
        }
        position[i] = (float)scratch[i];
    }
    for (size_t i = 0; normal && i < count; i++) {
        normal[i] = (float)directions[i];
    }
    return RUGA_OK;
}

static void order_bytes(uint32_t value, bool big, unsigned char byte[4]) {
    for (int i = 0; i < 4; i++) {
        byte[big ? 3 - i : i] = (unsigned char)(value >> (8 * i) & 0xff);
    }
}

void ruga_animation_put_u32(ruga_writer* writer, uint32_t value, bool big) {
    unsigned char byte[4];
    order_bytes(value, big, byte);
    (void)fwrite(byte, 1, 4, writer->file);
}

void ruga_animation_put_floats(ruga_writer* writer, const float* value, size_t count, bool big) {
    enum { BLOCK = 1024 };
    unsigned char byte[4 * BLOCK];
    for (size_t begin = 0; begin < count; begin += BLOCK) {
        size_t part = count - begin < BLOCK ? count - begin : BLOCK;
        for (size_t i = 0; i < part; i++) {
            uint32_t bits;
            memcpy(&bits, &value[begin + i], sizeof bits);
            order_bytes(bits, big, byte + 4 * i);
        }
        (void)fwrite(byte, 4, part, writer->file);
    }
}

void ruga_animation_sort_faces(const ruga_mesh* mesh, int* order, int* start) {
    int groups = mesh->face_group ? mesh->group_count : 0;
    memset(start, 0, ((size_t)groups + 2) * sizeof *start);
    for (int pass = 0; pass < 2; pass++) {
        for (int f = 0; f < mesh->triangle_count; f++) {
            int g = mesh->face_group && mesh->face_group[f] >= 0 ? mesh->face_group[f] : groups;
            RUGA_ASSERT(g <= groups);
            if (pass == 0) {
                start[g + 1]++;
            } else {
                order[start[g]++] = f;
            }
        }
        for (int g = 0; pass == 0 && g <= groups; g++) {
            start[g + 1] += start[g];
        }
    }
    memmove(start + 1, start,
            ((size_t)groups + 1) * sizeof *start); // each start has moved to its group's end
    start[0] = 0;
}
