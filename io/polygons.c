// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/polygons.h"

#include "core/memory.h"
#include "io/triangulate.h"

#include <limits.h>
#include <string.h>

// ------------------------------------------------------------------------------------------- names

static void clear_names(ruga_names* names) {
    for (int i = 0; i < names->count; i++) {
        ruga_release(names->name[i]);
    }
    ruga_release(names->name);
    ruga_release(names->slot);
    *names = (ruga_names){0};
}

static int find_slot(const ruga_names* names, const char* name, size_t length) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < length; i++) {
        hash = (hash ^ (unsigned char)name[i]) * 0x100000001b3u;
    }
    int mask = names->slot_count - 1;
    int slot = (int)((hash ^ hash >> 32) & (uint64_t)mask);
    while (names->slot[slot] >= 0) {
        const char* known = names->name[names->slot[slot]];
        if (strlen(known) == length && memcmp(known, name, length) == 0) {
            break;
        }
        slot = (slot + 1) & mask;
    }
    return slot;
}

static ruga_status grow_slots(ruga_names* names) {
    int count = names->slot_count ? 2 * names->slot_count : 16;
    int* slot = NULL;
    RUGA_TRY(RUGA_NEW(slot, count));
    memset(slot, 0xff, (size_t)count * sizeof *slot); // all -1
    ruga_release(names->slot);
    names->slot = slot;
    names->slot_count = count;
    for (int i = 0; i < names->count; i++) {
        names->slot[find_slot(names, names->name[i], strlen(names->name[i]))] = i;
    }
    return RUGA_OK;
}

static ruga_status number_name(ruga_names* names, const char* name, size_t length, int* number) {
    if (2 * (names->count + 1) > names->slot_count) {
        RUGA_TRY(grow_slots(names));
    }
    int slot = find_slot(names, name, length);
    if (names->slot[slot] < 0) {
        RUGA_TRY(RUGA_RESERVE(names->name, names->capacity, names->count + 1));
        char* copy = NULL;
        RUGA_TRY(RUGA_NEW(copy, length + 1));
        memcpy(copy, name, length);
        copy[length] = '\0';
        names->slot[slot] = names->count;
        names->name[names->count++] = copy;
    }
    *number = names->slot[slot];
    return RUGA_OK;
}

// ---------------------------------------------------------------------------------------- gathering

void ruga_polygons_begin(ruga_polygons* polygons) {
    memset(polygons, 0, sizeof *polygons);
    for (int kind = 0; kind < RUGA_GROUP_KINDS; kind++) {
        polygons->group[kind] = -1;
    }
}

void ruga_polygons_clear(ruga_polygons* polygons) {
    ruga_release(polygons->position);
    ruga_release(polygons->uv);
    ruga_release(polygons->corner);
    ruga_release(polygons->polygon);
    for (int kind = 0; kind < RUGA_GROUP_KINDS; kind++) {
        clear_names(&polygons->names[kind]);
    }
    ruga_polygons_begin(polygons);
}

ruga_status ruga_polygons_add_vertex(ruga_polygons* polygons, const double position[3]) {
    RUGA_TRY(RUGA_RESERVE(polygons->position, polygons->vertex_capacity, (size_t)polygons->vertex_count + 1));
    memcpy(polygons->position[polygons->vertex_count++], position, 3 * sizeof *position);
    return RUGA_OK;
}

ruga_status ruga_polygons_add_uv(ruga_polygons* polygons, const double uv[2]) {
    RUGA_TRY(RUGA_RESERVE(polygons->uv, polygons->uv_capacity, (size_t)polygons->uv_count + 1));
    memcpy(polygons->uv[polygons->uv_count++], uv, 2 * sizeof *uv);
    return RUGA_OK;
}

ruga_status ruga_polygons_add(ruga_polygons* polygons, int line) {
    RUGA_TRY(
        RUGA_RESERVE(polygons->polygon, polygons->polygon_capacity, (size_t)polygons->polygon_count + 1));
    ruga_polygon* polygon = &polygons->polygon[polygons->polygon_count++];
    *polygon = (ruga_polygon){.first = polygons->corner_count, .line = line};
    memcpy(polygon->group, polygons->group, sizeof polygon->group);
    return RUGA_OK;
}

ruga_status ruga_polygons_add_corner(ruga_polygons* polygons, int vertex, int uv) {
    RUGA_TRY(RUGA_RESERVE(polygons->corner, polygons->corner_capacity, (size_t)polygons->corner_count + 1));
    polygons->corner[polygons->corner_count++] = (ruga_corner){vertex, uv};
    return RUGA_OK;
}

ruga_status ruga_polygons_set_group(ruga_polygons* polygons, int kind, const char* name, size_t length) {
    polygons->group[kind] = -1;
    return length > 0 ? number_name(&polygons->names[kind], name, length, &polygons->group[kind]) : RUGA_OK;
}

// ---------------------------------------------------------------------------------------- the mesh

static int corner_count(const ruga_polygons* polygons, int p) {
    bool last = p + 1 == polygons->polygon_count;
    return (last ? polygons->corner_count : polygons->polygon[p + 1].first) - polygons->polygon[p].first;
}

// "path:line: " or "path: face N: " before the sentence
static ruga_status fail_polygon(const ruga_polygons* polygons, const char* path, int p, ruga_status status) {
    int line = polygons->polygon[p].line;
    return line > 0 ? ruga_fail_prefix(status, "%s:%d", path, line)
                    : ruga_fail_prefix(status, "%s: face %d (counted from 0)", path, p);
}

static ruga_status check_polygon(const ruga_polygons* polygons, int p) {
    int count = corner_count(polygons, p);
    if (count < 3 || count > RUGA_POLYGON_CORNERS) {
        return ruga_fail(RUGA_BAD_INPUT, "a face has %d corners: 3 to %d are possible", count,
                         RUGA_POLYGON_CORNERS);
    }
    for (int i = 0; i < count; i++) {
        const ruga_corner* corner = &polygons->corner[polygons->polygon[p].first + i];
        if (corner->vertex < 0 || corner->vertex >= polygons->vertex_count) {
            return ruga_fail(RUGA_BAD_INPUT, "a face names vertex %d (counted from 0), but there are only %d",
                             corner->vertex, polygons->vertex_count);
        }
        if (corner->uv < -1 || corner->uv >= polygons->uv_count) {
            return ruga_fail(RUGA_BAD_INPUT, "a face names uv %d (counted from 0), but there are only %d",
                             corner->uv, polygons->uv_count);
        }
    }
    return RUGA_OK;
}

typedef struct summary {
    int triangle_count;
    int largest; // polygon
    bool has_uv;
} summary;

static ruga_status summarise(const ruga_polygons* polygons, const char* path, summary* sum) {
    *sum = (summary){0};
    for (int p = 0; p < polygons->polygon_count; p++) {
        ruga_status status = check_polygon(polygons, p);
        if (status != RUGA_OK) {
            return fail_polygon(polygons, path, p, status);
        }
        int count = corner_count(polygons, p);
        if (sum->triangle_count > INT_MAX / 3 - count) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: more than %d triangles", path, INT_MAX / 3);
        }
        sum->triangle_count += count - 2;
        sum->largest = count > sum->largest ? count : sum->largest;
        for (int i = 0; i < count; i++) {
            sum->has_uv |= polygons->corner[polygons->polygon[p].first + i].uv >= 0;
        }
    }
    return RUGA_OK;
}

// Cuts polygon p and stores its triangles from number `next` on.
static ruga_status store_polygon(const ruga_polygons* polygons, int p, int next, double (*outline)[3],
                                 int (*cut)[3], ruga_mesh* mesh) {
    int count = corner_count(polygons, p);
    const ruga_corner* corner = polygons->corner + polygons->polygon[p].first;
    for (int i = 0; i < count; i++) {
        memcpy(outline[i], polygons->position[corner[i].vertex], sizeof outline[i]);
    }
    RUGA_TRY(ruga_triangulate(count, (const double(*)[3])outline, cut));
    for (int k = 0; k < count - 2; k++) {
        for (int i = 0; i < 3; i++) {
            size_t place = 3 * (size_t)(next + k) + (size_t)i;
            mesh->triangle[place] = corner[cut[k][i]].vertex;
            if (mesh->uv_triangle) {
                mesh->uv_triangle[place] = corner[cut[k][i]].uv;
            }
        }
        if (mesh->polygon) {
            mesh->polygon[next + k] = p;
        }
    }
    return RUGA_OK;
}

static ruga_status store_triangles(const ruga_polygons* polygons, int largest, ruga_mesh* mesh) {
    ruga_status status = RUGA_OK;
    double(*outline)[3] = NULL;
    int(*cut)[3] = NULL;
    RUGA_TRY_DONE(RUGA_NEW(outline, largest));
    RUGA_TRY_DONE(RUGA_NEW(cut, largest));
    for (int p = 0, next = 0; p < polygons->polygon_count; p++) {
        RUGA_TRY_DONE(store_polygon(polygons, p, next, outline, cut, mesh));
        next += corner_count(polygons, p) - 2;
    }
done:
    ruga_release(outline);
    ruga_release(cut);
    return status;
}

// number[g] = new number of a group that has faces, in old order, or -1; *used = how many.
static void number_groups(const ruga_polygons* polygons, int kind, int* number, int* used) {
    for (int g = 0; g < polygons->names[kind].count; g++) {
        number[g] = -1;
    }
    for (int p = 0; p < polygons->polygon_count; p++) {
        if (polygons->polygon[p].group[kind] >= 0) {
            number[polygons->polygon[p].group[kind]] = 0;
        }
    }
    *used = 0;
    for (int g = 0; g < polygons->names[kind].count; g++) {
        if (number[g] == 0) {
            number[g] = (*used)++;
        }
    }
}

static ruga_status store_group_names(const ruga_names* names, const int* number, int used, ruga_mesh* mesh) {
    RUGA_TRY(RUGA_NEW_ZERO(mesh->group_name, used));
    mesh->group_count = used;
    for (int g = 0; g < names->count; g++) {
        if (number[g] >= 0) {
            mesh->group_name[number[g]] = ruga_copy_string(names->name[g]);
            if (!mesh->group_name[number[g]]) {
                return ruga_fail(RUGA_NO_MEMORY, "out of memory for %d group names", used);
            }
        }
    }
    return RUGA_OK;
}

// *stored = whether groups of this kind have faces.
static ruga_status store_groups(const ruga_polygons* polygons, int kind, ruga_mesh* mesh, bool* stored) {
    ruga_status status = RUGA_OK;
    int* number = NULL;
    int used = 0;
    RUGA_TRY_DONE(RUGA_NEW(number, polygons->names[kind].count));
    number_groups(polygons, kind, number, &used);
    *stored = used > 0;
    if (used > 0) {
        RUGA_TRY_DONE(store_group_names(&polygons->names[kind], number, used, mesh));
        RUGA_TRY_DONE(RUGA_NEW(mesh->face_group, mesh->triangle_count));
        for (int p = 0, next = 0; p < polygons->polygon_count; p++) {
            int group = polygons->polygon[p].group[kind];
            for (int k = 0; k < corner_count(polygons, p) - 2; k++) {
                mesh->face_group[next++] = group < 0 ? -1 : number[group];
            }
        }
    }
done:
    ruga_release(number);
    return status;
}

static ruga_status fill_mesh(const ruga_polygons* polygons, const char* path, ruga_mesh* mesh) {
    summary sum;
    RUGA_TRY(summarise(polygons, path, &sum));
    mesh->vertex_count = polygons->vertex_count;
    mesh->triangle_count = sum.triangle_count;
    RUGA_TRY(RUGA_NEW(mesh->position, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY(RUGA_NEW(mesh->triangle, 3 * (size_t)mesh->triangle_count));
    if (mesh->vertex_count > 0) {
        memcpy(mesh->position, polygons->position, 3 * (size_t)mesh->vertex_count * sizeof(double));
    }
    if (sum.has_uv) {
        mesh->uv_count = polygons->uv_count;
        RUGA_TRY(RUGA_NEW(mesh->uv, 2 * (size_t)mesh->uv_count));
        RUGA_TRY(RUGA_NEW(mesh->uv_triangle, 3 * (size_t)mesh->triangle_count));
        memcpy(mesh->uv, polygons->uv, 2 * (size_t)mesh->uv_count * sizeof(double));
    }
    if (sum.largest > 3) {
        RUGA_TRY(RUGA_NEW(mesh->polygon, mesh->triangle_count));
    }
    RUGA_TRY(store_triangles(polygons, sum.largest, mesh));
    bool stored = false;
    for (int kind = 0; kind < RUGA_GROUP_KINDS && !stored; kind++) {
        RUGA_TRY(store_groups(polygons, kind, mesh, &stored));
    }
    return RUGA_OK;
}

ruga_status ruga_polygons_finish(const ruga_polygons* polygons, const char* path, ruga_mesh* mesh) {
    memset(mesh, 0, sizeof *mesh);
    if (polygons->vertex_count == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the file has no vertices: is it a surface mesh?", path);
    }
    ruga_status status = fill_mesh(polygons, path, mesh);
    if (status != RUGA_OK) {
        ruga_mesh_clear(mesh);
    }
    return status;
}
