// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Which vertices of the rest mesh a region selects.
#include "constraints/attachments.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <stdio.h>
#include <string.h>

bool ruga_region_contains_within(const ruga_region* region, const double x[3], double slack) {
    switch (region->kind) {
    case RUGA_REGION_ALL:
        return true;
    case RUGA_REGION_BOX:
        for (int c = 0; c < 3; c++) {
            if (!(x[c] >= region->min[c] - slack && x[c] <= region->max[c] + slack)) {
                return false;
            }
        }
        return true;
    case RUGA_REGION_SPHERE:
        return ruga_distance(x, region->center) <= region->radius + slack;
    case RUGA_REGION_PLANE: {
        double offset[3];
        ruga_subtract(x, region->center, offset);
        return ruga_dot(offset, region->normal) >= -slack * ruga_norm(region->normal);
    }
    case RUGA_REGION_GROUP:
    case RUGA_REGION_VERTICES:
        return false; // made of vertices, not of space
    }
    return false;
}

double ruga_region_slack(const ruga_mesh* mesh) {
    double min[3], max[3];
    ruga_mesh_bounds(mesh, min, max);
    return 1e-9 * ruga_distance(min, max);
}

ruga_status ruga_region_group(const ruga_region* region, const ruga_mesh* mesh, int* group) {
    *group = ruga_mesh_find_group(mesh, region->group);
    if (*group >= 0) {
        return RUGA_OK;
    }
    const char* name = region->group ? region->group : "";
    if (mesh->group_count == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "there is no group \"%s\": the mesh has no groups", name);
    }
    char names[1024] = ""; // cut where the mesh has very many
    for (int g = 0; g < mesh->group_count; g++) {
        size_t length = strlen(names);
        (void)snprintf(names + length, sizeof names - length, g == 0 ? "\"%s\"" : ", \"%s\"",
                       mesh->group_name[g]);
    }
    return ruga_fail(RUGA_BAD_INPUT, "there is no group \"%s\"; the mesh has %s", name, names);
}

static ruga_status check_region(const ruga_region* region) {
    if (region->kind == RUGA_REGION_PLANE && !(ruga_norm(region->normal) > 0)) {
        return ruga_fail(RUGA_BAD_INPUT, "the normal of the region's plane is zero");
    }
    if (region->kind == RUGA_REGION_SPHERE && !(region->radius >= 0)) {
        return ruga_fail(RUGA_BAD_INPUT, "the radius %g m of the region's sphere is negative",
                         region->radius);
    }
    for (int c = 0; region->kind == RUGA_REGION_BOX && c < 3; c++) {
        if (!(region->min[c] <= region->max[c])) {
            return ruga_fail(RUGA_BAD_INPUT, "the region's box has min %g above max %g along %c: swap them",
                             region->min[c], region->max[c], "xyz"[c]);
        }
    }
    return RUGA_OK;
}

static ruga_status mark_group(const ruga_region* region, const ruga_mesh* mesh, int* mark) {
    int group;
    RUGA_TRY(ruga_region_group(region, mesh, &group));
    for (int t = 0; t < mesh->triangle_count; t++) {
        if (mesh->face_group && mesh->face_group[t] == group) {
            for (int i = 0; i < 3; i++) {
                mark[mesh->triangle[3 * (size_t)t + (size_t)i]] = 1;
            }
        }
    }
    return RUGA_OK;
}

static ruga_status mark_vertices(const ruga_region* region, const ruga_mesh* mesh, int* mark) {
    for (int k = 0; k < region->vertex_count; k++) {
        int v = region->vertices[k];
        if (v < 0 || v >= mesh->vertex_count) {
            return ruga_fail(RUGA_BAD_INPUT, "the region lists vertex %d, but the mesh has vertices 0 to %d",
                             v, mesh->vertex_count - 1);
        }
        mark[v] = 1;
    }
    return RUGA_OK;
}

ruga_status ruga_region_vertices(const ruga_region* region, const ruga_mesh* mesh, int* count,
                                 int* selected) {
    *count = 0;
    RUGA_TRY(check_region(region));
    // selected[] first holds a mark for each vertex; its list is then written over the marks already read.
    memset(selected, 0, (size_t)mesh->vertex_count * sizeof *selected);
    if (region->kind == RUGA_REGION_GROUP) {
        RUGA_TRY(mark_group(region, mesh, selected));
    } else if (region->kind == RUGA_REGION_VERTICES) {
        RUGA_TRY(mark_vertices(region, mesh, selected));
    } else {
        double slack = ruga_region_slack(mesh);
        for (int v = 0; v < mesh->vertex_count; v++) {
            selected[v] = ruga_region_contains_within(region, mesh->position + 3 * (size_t)v, slack);
        }
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        if (selected[v]) {
            selected[(*count)++] = v;
        }
    }
    return RUGA_OK;
}

ruga_status ruga_region_empty(const ruga_region* region, const ruga_mesh* mesh, int handle,
                              const char* what) {
    static const char* const names[] = {"all", "box", "sphere", "plane", "group", "vertices"};
    double min[3], max[3];
    ruga_mesh_bounds(mesh, min, max);
    return ruga_fail(RUGA_BAD_INPUT,
                     "handles.%d: the region (%s) selects no %s; the rest mesh lies between (%g, %g, %g) and "
                     "(%g, %g, %g) m",
                     handle, names[region->kind], what, min[0], min[1], min[2], max[0], max[1], max[2]);
}
