// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// MDD point cache, big-endian: int32 samples, int32 points, float time of each sample in seconds; then float
// x, y, z of all points, sample after sample.
#include "core/memory.h"
#include "io/animation.h"
#include "io/point_cache.h"

static ruga_status write_content(ruga_writer* writer, const ruga_animation* animation, double* scratch,
                                 float* position) {
    const int vertices = animation->mesh->vertex_count;
    ruga_animation_put_u32(writer, (uint32_t)animation->count, true);
    ruga_animation_put_u32(writer, (uint32_t)vertices, true);
    for (int k = 0; k < animation->count; k++) {
        const float time = (float)((animation->first + k) / animation->rate);
        ruga_animation_put_floats(writer, &time, 1, true);
    }
    for (int k = 0; k < animation->count; k++) {
        RUGA_TRY(ruga_animation_read(animation, animation->first + k, scratch, position, NULL));
        ruga_animation_put_floats(writer, position, 3 * (size_t)vertices, true);
    }
    return RUGA_OK;
}

ruga_status ruga_mdd_animation_write(const char* path, const ruga_animation* animation) {
    return ruga_point_cache_write(path, animation, write_content);
}

ruga_status ruga_mdd_open(ruga_point_cache* cache) {
    char head[8], time[4];
    RUGA_TRY(ruga_point_cache_bytes(cache, 0, sizeof head, head));
    cache->big = true;
    uint32_t samples = ruga_bytes_u32(head, true);
    cache->data = 8 + 4 * (long long)samples;
    RUGA_TRY(ruga_point_cache_size(cache, ruga_bytes_u32(head + 4, true), samples));
    for (int k = 0; k < cache->sample_count; k++) {
        RUGA_TRY(ruga_point_cache_bytes(cache, (long long)sizeof head + 4 * (long long)k, sizeof time, time));
        cache->time[k] = (double)ruga_bytes_f32(time, true);
    }
    return RUGA_OK;
}
