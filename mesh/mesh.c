// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Copies, parts and integrals of a triangle mesh. With n = (b - a) x (c - a) of a triangle (a, b, c):
// area = sum |n| / 2, volume = sum a . n / 6 (divergence theorem, a measured from the box's centre so that a
// mesh far from the origin keeps its digits), vertex normal ~ sum n over the triangles around it.
#include "mesh/mesh.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <string.h>

static void release_names(char** names, int count) {
    for (int i = 0; names && i < count; i++) {
        ruga_release(names[i]);
    }
    ruga_release(names);
}

void ruga_mesh_clear(ruga_mesh* mesh) {
    ruga_release(mesh->position);
    ruga_release(mesh->triangle);
    ruga_release(mesh->uv);
    ruga_release(mesh->uv_triangle);
    release_names(mesh->group_name, mesh->group_count);
    ruga_release(mesh->face_group);
    ruga_release(mesh->polygon);
    ruga_release(mesh->source_vertex);
    release_names(mesh->attribute_name, mesh->attribute_count);
    ruga_release(mesh->attribute);
    memset(mesh, 0, sizeof *mesh);
}

// *copy = count * size bytes of `source`; NULL stays NULL.
static ruga_status copy_array(const void* source, size_t count, size_t size, void** copy) {
    *copy = NULL;
    if (!source) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_allocate_checked(count, size, false, copy));
    memcpy(*copy, source, count * size);
    return RUGA_OK;
}

#define COPY(target, source, count)                                                                          \
    RUGA_TRY_DONE(copy_array(source, (size_t)(count), sizeof *(target), (void**)&(target)))

static ruga_status copy_names(const char* const* source, int count, char*** names) {
    RUGA_TRY(RUGA_NEW_ZERO(*names, count));
    for (int i = 0; i < count; i++) {
        (*names)[i] = ruga_copy_string(source[i] ? source[i] : "");
        if (!(*names)[i]) {
            return ruga_fail(RUGA_NO_MEMORY, "out of memory for %d group names", count);
        }
    }
    return RUGA_OK;
}

int ruga_mesh_find_group(const ruga_mesh* mesh, const char* name) {
    for (int g = 0; g < mesh->group_count; g++) {
        if (name && strcmp(mesh->group_name[g], name) == 0) {
            return g;
        }
    }
    return -1;
}

int ruga_mesh_find_attribute(const ruga_mesh* mesh, const char* name) {
    for (int a = 0; a < mesh->attribute_count; a++) {
        if (strcmp(mesh->attribute_name[a], name) == 0) {
            return a;
        }
    }
    return -1;
}

ruga_status ruga_mesh_allocate_attributes(const ruga_mesh* source, ruga_mesh* mesh) {
    if (source->attribute_count == 0) {
        return RUGA_OK;
    }
    mesh->attribute_count = source->attribute_count;
    RUGA_TRY(copy_names((const char* const*)source->attribute_name, source->attribute_count,
                        &mesh->attribute_name));
    return RUGA_NEW(mesh->attribute, (size_t)mesh->attribute_count * (size_t)mesh->vertex_count);
}

ruga_status ruga_mesh_copy(const ruga_mesh* source, ruga_mesh* copy) {
    memset(copy, 0, sizeof *copy);
    ruga_status status = RUGA_OK;
    copy->vertex_count = source->vertex_count;
    copy->triangle_count = source->triangle_count;
    copy->uv_count = source->uv_count;
    size_t corners = 3 * (size_t)source->triangle_count;
    COPY(copy->position, source->position, 3 * (size_t)source->vertex_count);
    COPY(copy->triangle, source->triangle, corners);
    COPY(copy->uv, source->uv, 2 * (size_t)source->uv_count);
    COPY(copy->uv_triangle, source->uv_triangle, corners);
    COPY(copy->face_group, source->face_group, source->triangle_count);
    COPY(copy->polygon, source->polygon, source->triangle_count);
    COPY(copy->source_vertex, source->source_vertex, source->vertex_count);
    if (source->group_name) {
        copy->group_count = source->group_count;
        RUGA_TRY_DONE(
            copy_names((const char* const*)source->group_name, source->group_count, &copy->group_name));
    }
    RUGA_TRY_DONE(ruga_mesh_allocate_attributes(source, copy));
    if (source->attribute_count > 0) {
        memcpy(copy->attribute, source->attribute,
               (size_t)source->attribute_count * (size_t)source->vertex_count * sizeof *copy->attribute);
    }
done:
    if (status != RUGA_OK) {
        ruga_mesh_clear(copy);
    }
    return status;
}

// Every index[3 f + i] in [low, limit)?
static ruga_status check_indices(const int* index, int triangle_count, int low, int limit, const char* what) {
    for (int f = 0; index && f < triangle_count; f++) {
        for (int i = 0; i < 3; i++) {
            int v = index[3 * (size_t)f + (size_t)i];
            if (v < low || v >= limit) {
                return ruga_fail(RUGA_BAD_INPUT,
                                 "face %d names %s %d, but there are only %d (counted from 0)", f, what, v,
                                 limit);
            }
        }
    }
    return RUGA_OK;
}

static ruga_status check_def(const ruga_mesh_def* def) {
    if (def->vertex_count < 0 || def->triangle_count < 0 || def->uv_count < 0 || def->group_count < 0) {
        return ruga_fail(RUGA_BAD_INPUT, "a count of the mesh is negative");
    }
    if ((def->vertex_count > 0 && !def->positions) || (def->triangle_count > 0 && !def->triangles)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "the mesh has a count without its array: set positions and triangles");
    }
    if ((def->uv != NULL) != (def->uv_triangles != NULL) || (def->uv_count > 0 && !def->uv)) {
        return ruga_fail(RUGA_BAD_INPUT, "a mesh with uv needs both uv and uv_triangles");
    }
    if ((def->group_count > 0 && !def->group_names) || (def->group_count > 0 && !def->face_group)) {
        return ruga_fail(RUGA_BAD_INPUT, "a mesh with groups needs both group_names and face_group");
    }
    RUGA_TRY(check_indices(def->triangles, def->triangle_count, 0, def->vertex_count, "vertex"));
    RUGA_TRY(check_indices(def->uv_triangles, def->triangle_count, -1, def->uv_count, "uv"));
    for (int f = 0; def->face_group && f < def->triangle_count; f++) {
        if (def->face_group[f] < -1 || def->face_group[f] >= def->group_count) {
            return ruga_fail(RUGA_BAD_INPUT, "face %d names group %d, but there are only %d (counted from 0)",
                             f, def->face_group[f], def->group_count);
        }
    }
    return RUGA_OK;
}

ruga_status ruga_mesh_from_def(const ruga_mesh_def* def, ruga_mesh* mesh) {
    memset(mesh, 0, sizeof *mesh);
    RUGA_TRY(check_def(def));
    ruga_status status = RUGA_OK;
    mesh->vertex_count = def->vertex_count;
    mesh->triangle_count = def->triangle_count;
    mesh->uv_count = def->uv ? def->uv_count : 0;
    size_t corners = 3 * (size_t)def->triangle_count;
    static const double no_position[1];
    static const int no_triangle[1];
    COPY(mesh->position, def->positions ? def->positions : no_position, 3 * (size_t)def->vertex_count);
    COPY(mesh->triangle, def->triangles ? def->triangles : no_triangle, corners);
    COPY(mesh->uv, def->uv, 2 * (size_t)def->uv_count);
    COPY(mesh->uv_triangle, def->uv_triangles, corners);
    if (def->group_count > 0) {
        COPY(mesh->face_group, def->face_group, def->triangle_count);
        mesh->group_count = def->group_count;
        RUGA_TRY_DONE(copy_names(def->group_names, def->group_count, &mesh->group_name));
    }
done:
    if (status != RUGA_OK) {
        ruga_mesh_clear(mesh);
    }
    return status;
}

ruga_mesh_def ruga_mesh_as_def(const ruga_mesh* mesh) {
    return (ruga_mesh_def){
        .vertex_count = mesh->vertex_count,
        .positions = mesh->position,
        .triangle_count = mesh->triangle_count,
        .triangles = mesh->triangle,
        .uv_count = mesh->uv_count,
        .uv = mesh->uv,
        .uv_triangles = mesh->uv_triangle,
        .group_count = mesh->group_count,
        .group_names = (const char* const*)mesh->group_name,
        .face_group = mesh->face_group,
    };
}

// The names that exist, for an error: as many as fit.
static void list_names(const ruga_mesh* mesh, char* text, size_t size) {
    size_t length = 0;
    text[0] = '\0';
    for (int g = 0; g < mesh->group_count; g++) {
        const char* name = mesh->group_name[g];
        size_t need = strlen(name) + 2;
        if (length + need + 4 > size) {
            memcpy(text + length, " ...", 5);
            return;
        }
        if (g > 0) {
            memcpy(text + length, ", ", 2);
            length += 2;
        }
        memcpy(text + length, name, strlen(name) + 1);
        length += strlen(name);
    }
}

// number[g] = place of group g among those wanted, or -1; *kept = how many.
static ruga_status select_groups(const ruga_mesh* mesh, int count, const char* const* names, int* number,
                                 int* kept) {
    char list[1024];
    for (int g = 0; g < mesh->group_count; g++) {
        number[g] = -1;
    }
    for (int i = 0; i < count; i++) {
        bool found = false;
        for (int g = 0; g < mesh->group_count; g++) {
            if (strcmp(mesh->group_name[g], names[i]) == 0) {
                number[g] = 0;
                found = true;
            }
        }
        if (!found) {
            list_names(mesh, list, sizeof list);
            return mesh->group_count == 0
                       ? ruga_fail(RUGA_BAD_INPUT, "the mesh has no group '%s': it has no groups at all",
                                   names[i])
                       : ruga_fail(RUGA_BAD_INPUT, "the mesh has no group '%s': it has %s", names[i], list);
        }
    }
    *kept = 0;
    for (int g = 0; g < mesh->group_count; g++) {
        if (number[g] == 0) {
            number[g] = (*kept)++;
        }
    }
    return RUGA_OK;
}

// Numbers the places that triangles of kept faces name, in their old order; -1 for the others. Their count.
static int number_used(const ruga_mesh* mesh, const int* group_number, const int* corner, int place_count,
                       int* place_number) {
    for (int v = 0; v < place_count; v++) {
        place_number[v] = -1;
    }
    for (int f = 0; f < mesh->triangle_count; f++) {
        int group = mesh->face_group[f];
        for (int i = 0; group >= 0 && group_number[group] >= 0 && i < 3; i++) {
            int v = corner[3 * (size_t)f + (size_t)i];
            if (v >= 0) {
                place_number[v] = 0;
            }
        }
    }
    int used = 0;
    for (int v = 0; v < place_count; v++) {
        if (place_number[v] == 0) {
            place_number[v] = used++;
        }
    }
    return used;
}

static ruga_status extract_vertices(const ruga_mesh* mesh, const int* number, ruga_mesh* part) {
    RUGA_TRY(RUGA_NEW(part->position, 3 * (size_t)part->vertex_count));
    RUGA_TRY(RUGA_NEW(part->source_vertex, part->vertex_count));
    RUGA_TRY(ruga_mesh_allocate_attributes(mesh, part));
    size_t attributes = (size_t)mesh->attribute_count;
    for (int v = 0; v < mesh->vertex_count; v++) {
        if (number[v] >= 0) {
            memcpy(part->position + 3 * (size_t)number[v], mesh->position + 3 * (size_t)v,
                   3 * sizeof(double));
            part->source_vertex[number[v]] = mesh->source_vertex ? mesh->source_vertex[v] : v;
            if (attributes > 0) {
                memcpy(part->attribute + attributes * (size_t)number[v],
                       mesh->attribute + attributes * (size_t)v, attributes * sizeof *part->attribute);
            }
        }
    }
    return RUGA_OK;
}

static ruga_status extract_uvs(const ruga_mesh* mesh, const int* number, ruga_mesh* part) {
    RUGA_TRY(RUGA_NEW(part->uv, 2 * (size_t)part->uv_count));
    for (int v = 0; v < mesh->uv_count; v++) {
        if (number[v] >= 0) {
            memcpy(part->uv + 2 * (size_t)number[v], mesh->uv + 2 * (size_t)v, 2 * sizeof(double));
        }
    }
    return RUGA_NEW(part->uv_triangle, 3 * (size_t)part->triangle_count);
}

// Fills the part's faces. A face's polygon stays that of the file: without polygons, the face itself.
static ruga_status extract_faces(const ruga_mesh* mesh, const int* group_number, const int* vertex_number,
                                 const int* uv_number, ruga_mesh* part) {
    RUGA_TRY(RUGA_NEW(part->triangle, 3 * (size_t)part->triangle_count));
    RUGA_TRY(RUGA_NEW(part->face_group, part->triangle_count));
    RUGA_TRY(RUGA_NEW(part->polygon, part->triangle_count));
    int kept = 0;
    for (int f = 0; f < mesh->triangle_count; f++) {
        int group = mesh->face_group[f];
        if (group < 0 || group_number[group] < 0) {
            continue;
        }
        for (int i = 0; i < 3; i++) {
            size_t old = 3 * (size_t)f + (size_t)i, corner = 3 * (size_t)kept + (size_t)i;
            part->triangle[corner] = vertex_number[mesh->triangle[old]];
            if (part->uv_triangle) {
                part->uv_triangle[corner] =
                    mesh->uv_triangle[old] < 0 ? -1 : uv_number[mesh->uv_triangle[old]];
            }
        }
        part->face_group[kept] = group_number[group];
        part->polygon[kept++] = mesh->polygon ? mesh->polygon[f] : f;
    }
    return RUGA_OK;
}

static ruga_status extract_names(const ruga_mesh* mesh, const int* group_number, int kept, ruga_mesh* part) {
    RUGA_TRY(RUGA_NEW_ZERO(part->group_name, kept));
    part->group_count = kept;
    for (int g = 0; g < mesh->group_count; g++) {
        if (group_number[g] >= 0) {
            part->group_name[group_number[g]] = ruga_copy_string(mesh->group_name[g]);
            if (!part->group_name[group_number[g]]) {
                return ruga_fail(RUGA_NO_MEMORY, "out of memory for %d group names", kept);
            }
        }
    }
    return RUGA_OK;
}

static int count_faces(const ruga_mesh* mesh, const int* group_number) {
    int count = 0;
    for (int f = 0; f < mesh->triangle_count; f++) {
        count += mesh->face_group[f] >= 0 && group_number[mesh->face_group[f]] >= 0;
    }
    return count;
}

ruga_status ruga_mesh_extract_groups(const ruga_mesh* mesh, int count, const char* const* names,
                                     ruga_mesh* part) {
    memset(part, 0, sizeof *part);
    ruga_status status = RUGA_OK;
    int *group_number = NULL, *vertex_number = NULL, *uv_number = NULL;
    int kept = 0;
    RUGA_TRY_DONE(RUGA_NEW(group_number, mesh->group_count));
    RUGA_TRY_DONE(select_groups(mesh, count, names, group_number, &kept));
    if (kept == 0) {
        status = ruga_fail(RUGA_BAD_INPUT, "no group was named: give at least one");
        goto done;
    }
    RUGA_TRY_DONE(RUGA_NEW(vertex_number, mesh->vertex_count));
    part->vertex_count = number_used(mesh, group_number, mesh->triangle, mesh->vertex_count, vertex_number);
    part->triangle_count = count_faces(mesh, group_number);
    RUGA_TRY_DONE(extract_vertices(mesh, vertex_number, part));
    if (mesh->uv && mesh->uv_triangle) {
        RUGA_TRY_DONE(RUGA_NEW(uv_number, mesh->uv_count));
        part->uv_count = number_used(mesh, group_number, mesh->uv_triangle, mesh->uv_count, uv_number);
        RUGA_TRY_DONE(extract_uvs(mesh, uv_number, part));
    }
    RUGA_TRY_DONE(extract_faces(mesh, group_number, vertex_number, uv_number, part));
    RUGA_TRY_DONE(extract_names(mesh, group_number, kept, part));
done:
    ruga_release(group_number);
    ruga_release(vertex_number);
    ruga_release(uv_number);
    if (status != RUGA_OK) {
        ruga_mesh_clear(part);
    }
    return status;
}

void ruga_mesh_bounds(const ruga_mesh* mesh, double min[3], double max[3]) {
    for (int k = 0; k < 3; k++) {
        min[k] = max[k] = 0;
    }
    bool first = true;
    for (int v = 0; v < mesh->vertex_count; v++) {
        const double* x = mesh->position + 3 * (size_t)v;
        if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2])) {
            continue; // the doctor's business
        }
        for (int k = 0; k < 3; k++) {
            min[k] = first || x[k] < min[k] ? x[k] : min[k];
            max[k] = first || x[k] > max[k] ? x[k] : max[k];
        }
        first = false;
    }
}

static void face_corners(const ruga_mesh* mesh, const double* position, int f, const double* corner[3]) {
    for (int i = 0; i < 3; i++) {
        corner[i] = position + 3 * (size_t)mesh->triangle[3 * (size_t)f + (size_t)i];
    }
}

void ruga_mesh_triangle_normal(const ruga_mesh* mesh, int f, double n[3]) {
    const double* x[3];
    face_corners(mesh, mesh->position, f, x);
    ruga_triangle_normal(x[0], x[1], x[2], n);
}

double ruga_mesh_triangle_area(const ruga_mesh* mesh, int f) {
    double n[3];
    ruga_mesh_triangle_normal(mesh, f, n);
    return 0.5 * ruga_norm(n);
}

double ruga_mesh_area(const ruga_mesh* mesh) {
    double sum = 0;
    for (int f = 0; f < mesh->triangle_count; f++) {
        sum += ruga_mesh_triangle_area(mesh, f);
    }
    return sum;
}

double ruga_mesh_volume(const ruga_mesh* mesh) {
    double min[3], max[3], center[3];
    ruga_mesh_bounds(mesh, min, max);
    for (int k = 0; k < 3; k++) {
        center[k] = (min[k] + max[k]) / 2;
    }
    double sum = 0;
    for (int f = 0; f < mesh->triangle_count; f++) {
        const double* x[3];
        double n[3], a[3];
        face_corners(mesh, mesh->position, f, x);
        ruga_triangle_normal(x[0], x[1], x[2], n);
        ruga_subtract(x[0], center, a);
        sum += ruga_dot(a, n);
    }
    return sum / 6;
}

// The mean over the faces' sides: an inner edge counts twice, a border edge once.
double ruga_mesh_mean_edge(const ruga_mesh* mesh) {
    double sum = 0;
    for (int f = 0; f < mesh->triangle_count; f++) {
        const double* x[3];
        face_corners(mesh, mesh->position, f, x);
        sum += ruga_distance(x[0], x[1]) + ruga_distance(x[1], x[2]) + ruga_distance(x[2], x[0]);
    }
    return mesh->triangle_count > 0 ? sum / (3.0 * mesh->triangle_count) : 0;
}

void ruga_mesh_vertex_areas(const ruga_mesh* mesh, double* area) {
    memset(area, 0, (size_t)mesh->vertex_count * sizeof *area);
    for (int f = 0; f < mesh->triangle_count; f++) {
        double third = ruga_mesh_triangle_area(mesh, f) / 3;
        for (int i = 0; i < 3; i++) {
            area[mesh->triangle[3 * (size_t)f + (size_t)i]] += third;
        }
    }
}

// From the first corner on, since (x + x + x) / 3 may differ from x in the last bit.
void ruga_mesh_triangle_averages(const ruga_mesh* mesh, int components, const double* vertex,
                                 double* triangle) {
    size_t n = (size_t)components;
    for (size_t f = 0; f < (size_t)mesh->triangle_count; f++) {
        const int* corner = mesh->triangle + 3 * f;
        for (size_t c = 0; c < n; c++) {
            double first = vertex[n * (size_t)corner[0] + c];
            double further =
                (vertex[n * (size_t)corner[1] + c] - first) + (vertex[n * (size_t)corner[2] + c] - first);
            triangle[n * f + c] = first + further / 3;
        }
    }
}

void ruga_mesh_vertex_normals(const ruga_mesh* mesh, const double* position, double* normal) {
    memset(normal, 0, 3 * (size_t)mesh->vertex_count * sizeof *normal);
    for (int f = 0; f < mesh->triangle_count; f++) {
        const double* x[3];
        double n[3];
        face_corners(mesh, position, f, x);
        ruga_triangle_normal(x[0], x[1], x[2], n);
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(1, n, normal + 3 * (size_t)mesh->triangle[3 * (size_t)f + (size_t)i]);
        }
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        (void)ruga_normalize(normal + 3 * (size_t)v);
    }
}

static uint64_t hash_bytes(uint64_t hash, const void* data, size_t size) {
    const unsigned char* byte = data;
    for (size_t i = 0; i < size; i++) {
        hash = (hash ^ byte[i]) * 0x100000001b3u;
    }
    return hash;
}

uint64_t ruga_mesh_hash(const ruga_mesh* mesh) {
    uint64_t hash =
        hash_bytes(0xcbf29ce484222325u, mesh->position, 3 * (size_t)mesh->vertex_count * sizeof(double));
    return hash_bytes(hash, mesh->triangle, 3 * (size_t)mesh->triangle_count * sizeof(int));
}
