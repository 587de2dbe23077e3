// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L
#include "io/point_cache.h"

#include "core/memory.h"
#include "io/file_name.h"
#include "io/mesh_file.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

// ---- writing -------------------------------------------------------------------------------------------

ruga_status ruga_point_cache_write(const char* path, const ruga_animation* animation,
                                   ruga_point_cache_content* content) {
    ruga_status status = RUGA_OK;
    double* scratch = NULL;
    float* position = NULL;
    ruga_writer writer;
    size_t count = 3 * (size_t)animation->mesh->vertex_count;
    RUGA_TRY_DONE(RUGA_NEW(scratch, count));
    RUGA_TRY_DONE(RUGA_NEW(position, count));
    RUGA_TRY_DONE(ruga_writer_open(path, &writer));
    status = ruga_writer_close(&writer, content(&writer, animation, scratch, position));
done:
    ruga_release(scratch);
    ruga_release(position);
    return status;
}

// ---- files ---------------------------------------------------------------------------------------------

ruga_status ruga_point_cache_bytes(ruga_point_cache* cache, long long begin, size_t count, char* bytes) {
    if (begin < 0 || begin > cache->size || (long long)count > cache->size - begin) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the file ends at byte %lld, inside its data", cache->path,
                         cache->size);
    }
    if (fseeko(cache->file, (off_t)begin, SEEK_SET) != 0 || fread(bytes, 1, count, cache->file) != count) {
        return ruga_fail(RUGA_IO, "%s: cannot be read at byte %lld", cache->path, begin);
    }
    return RUGA_OK;
}

ruga_status ruga_point_cache_size(ruga_point_cache* cache, uint32_t points, uint32_t samples) {
    const long long room = cache->size - cache->data;
    if (points < 1 || samples < 1 || points > INT_MAX / 12 || samples > INT_MAX / 12) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: says that it has %u samples of %u points", cache->path, samples,
                         points);
    }
    // Below 2^31 / 12 each: the product fits.
    if (room < 0 || 12LL * points * samples != room) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: %u samples of %u points need %lld bytes after the head, and the file has %lld",
                         cache->path, samples, points, 12LL * points * samples, room < 0 ? 0 : room);
    }
    cache->point_count = (int)points;
    cache->sample_count = (int)samples;
    RUGA_TRY(RUGA_NEW(cache->sample, 12 * (size_t)points));
    return RUGA_NEW_ZERO(cache->time, samples);
}

static ruga_status open_file(ruga_point_cache* cache, ruga_status (*open)(ruga_point_cache*)) {
    cache->file = fopen(cache->path, "rb");
    if (!cache->file || fseeko(cache->file, 0, SEEK_END) != 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s cannot be read: %s", cache->path, strerror(errno));
    }
    cache->size = (long long)ftello(cache->file);
    return open(cache);
}

static ruga_status read_file(ruga_point_cache* cache, int sample, double* position) {
    const size_t bytes = 12 * (size_t)cache->point_count;
    RUGA_TRY(ruga_point_cache_bytes(cache, cache->data + (long long)sample * (long long)bytes, bytes,
                                    cache->sample));
    for (size_t i = 0; i < 3 * (size_t)cache->point_count; i++) {
        position[i] = (double)ruga_bytes_f32(cache->sample + 4 * i, cache->big);
    }
    return RUGA_OK;
}

// ---- a sequence of OBJ files ---------------------------------------------------------------------------

enum { NAME_MAX_LENGTH = 4096, NUMBER_MAX_LENGTH = 4 }; // a place has two digits at most

static bool file_exists(const ruga_point_cache* cache, int number) {
    char name[NAME_MAX_LENGTH];
    ruga_file_name_number(cache->path, number, name, sizeof name);
    FILE* file = fopen(name, "rb");
    if (file) {
        (void)fclose(file);
    }
    return file != NULL;
}

static ruga_status read_obj(const ruga_point_cache* cache, int sample, ruga_mesh* mesh) {
    char name[NAME_MAX_LENGTH];
    ruga_file_name_number(cache->path, cache->first + sample, name, sizeof name);
    RUGA_TRY(ruga_mesh_read(name, mesh));
    if (sample > 0 && mesh->vertex_count != cache->point_count) {
        int found = mesh->vertex_count;
        ruga_mesh_clear(mesh);
        return ruga_fail(RUGA_BAD_INPUT, "%s: has %d vertices, and the first file of the sequence %d", name,
                         found, cache->point_count);
    }
    return RUGA_OK;
}

static ruga_status open_sequence(ruga_point_cache* cache) {
    ruga_mesh mesh = {0};
    cache->first = file_exists(cache, 0) ? 0 : 1;
    while (cache->sample_count < INT_MAX / 12 && file_exists(cache, cache->first + cache->sample_count)) {
        cache->sample_count++;
    }
    if (cache->sample_count == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: there is no file with number 0 or 1", cache->path);
    }
    RUGA_TRY(RUGA_NEW(cache->time, cache->sample_count));
    for (int k = 0; k < cache->sample_count; k++) {
        cache->time[k] = k;
    }
    RUGA_TRY(read_obj(cache, 0, &mesh));
    cache->point_count = mesh.vertex_count;
    ruga_mesh_clear(&mesh);
    return RUGA_OK;
}

static ruga_status read_sequence(ruga_point_cache* cache, int sample, double* position) {
    ruga_mesh mesh = {0};
    RUGA_TRY(read_obj(cache, sample, &mesh));
    memcpy(position, mesh.position, 3 * (size_t)cache->point_count * sizeof *position);
    ruga_mesh_clear(&mesh);
    return RUGA_OK;
}

// ---- public --------------------------------------------------------------------------------------------

static ruga_status open_kind(ruga_point_cache* cache) {
    size_t length;
    if (ruga_file_name_ends(cache->path, ".pc2")) {
        return open_file(cache, ruga_pc2_open);
    }
    cache->time_is_real = ruga_file_name_ends(cache->path, ".mdd");
    if (cache->time_is_real) {
        return open_file(cache, ruga_mdd_open);
    }
    if (ruga_file_name_ends(cache->path, ".obj") && ruga_file_name_place(cache->path, &length) &&
        length <= NUMBER_MAX_LENGTH && strlen(cache->path) < NAME_MAX_LENGTH - 128) {
        return open_sequence(cache);
    }
    return ruga_fail(
        RUGA_BAD_INPUT,
        "%s: a moving surface is read from .pc2, from .mdd, or from .obj files with %%04d in their name",
        cache->path);
}

ruga_status ruga_point_cache_open(const char* path, ruga_point_cache* cache) {
    *cache = (ruga_point_cache){.path = ruga_copy_string(path)};
    ruga_status status =
        cache->path ? open_kind(cache) : ruga_fail(RUGA_NO_MEMORY, "out of memory: a file's name");
    for (int k = 0; status == RUGA_OK && k < cache->sample_count; k++) {
        if (!isfinite(cache->time[k]) || (k > 0 && !(cache->time[k] > cache->time[k - 1]))) {
            status = ruga_fail(RUGA_BAD_INPUT,
                               "%s: the time of sample %d is %g, not later than that of the one before", path,
                               k, cache->time[k]);
        }
    }
    if (status != RUGA_OK) {
        ruga_point_cache_close(cache);
    }
    return status;
}

void ruga_point_cache_close(ruga_point_cache* cache) {
    if (cache->file) {
        (void)fclose(cache->file);
    }
    ruga_release(cache->path);
    ruga_release(cache->time);
    ruga_release(cache->sample);
    *cache = (ruga_point_cache){0};
}

ruga_status ruga_point_cache_read(ruga_point_cache* cache, int sample, double* position) {
    RUGA_ASSERT(sample >= 0 && sample < cache->sample_count);
    RUGA_TRY(cache->file ? read_file(cache, sample, position) : read_sequence(cache, sample, position));
    for (size_t i = 0; i < 3 * (size_t)cache->point_count; i++) {
        if (!isfinite(position[i])) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: coordinate %c of point %zu in sample %d is not a number",
                             cache->path, "xyz"[i % 3], i / 3, sample);
        }
    }
    return RUGA_OK;
}
