// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// PC2 point cache, little-endian: "POINTCACHE2" with a zero, int32 version 1, int32 points, float start
// frame, float frames per sample, int32 samples; then float x, y, z of all points, sample after sample.
// Frames are counted in the frame rate of whoever reads it.
#include "core/memory.h"
#include "io/animation.h"
#include "io/point_cache.h"

#include <limits.h>

static ruga_status write_content(ruga_writer* writer, const ruga_animation* animation, double* scratch,
                                 float* position) {
    const int vertices = animation->mesh->vertex_count;
    const float start[2] = {(float)animation->first, 1};
    (void)fwrite("POINTCACHE2", 1, 12, writer->file);
    ruga_animation_put_u32(writer, 1, false);
    ruga_animation_put_u32(writer, (uint32_t)vertices, false);
    ruga_animation_put_floats(writer, start, 2, false);
    ruga_animation_put_u32(writer, (uint32_t)animation->count, false);
    for (int k = 0; k < animation->count; k++) {
        RUGA_TRY(ruga_animation_read(animation, animation->first + k, scratch, position, NULL));
        ruga_animation_put_floats(writer, position, 3 * (size_t)vertices, false);
    }
    return RUGA_OK;
}

ruga_status ruga_pc2_animation_write(const char* path, const ruga_animation* animation) {
    return ruga_point_cache_write(path, animation, write_content);
}

ruga_status ruga_pc2_open(ruga_point_cache* cache) {
    char head[32];
    RUGA_TRY(ruga_point_cache_bytes(cache, 0, sizeof head, head));
    if (memcmp(head, "POINTCACHE2", 12) != 0 || ruga_bytes_u32(head + 12, false) != 1) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: does not begin as a PC2 point cache of version 1 does",
                         cache->path);
    }
    float start = ruga_bytes_f32(head + 20, false), step = ruga_bytes_f32(head + 24, false);
    if (!(step > 0) || !isfinite(step) || !isfinite(start)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: its start frame is %g and its frames per sample %g",
                         cache->path, (double)start, (double)step);
    }
    cache->big = false;
    cache->data = sizeof head;
    RUGA_TRY(
        ruga_point_cache_size(cache, ruga_bytes_u32(head + 16, false), ruga_bytes_u32(head + 28, false)));
    for (int k = 0; k < cache->sample_count; k++) {
        cache->time[k] = (double)start + (double)step * k;
    }
    return RUGA_OK;
}
