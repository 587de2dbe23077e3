// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Skins that vary in space. At a vertex with thickness h and Young's modulus E_x, eq. 3 gives the local
// wavelength lambda = 2 pi h (E*_x / (3 E*_q))^(1/3) and Allen's formula the local critical strain, as if the
// skin were the same all around. What needs one number for all of the skin takes the mean over its area:
// steps of solvers, the floor of f_ref, the unit of shifts. What must not miss a place takes the worst: edges
// per wavelength, substeps.
#include "core/memory.h"
#include "core/vec3.h"
#include "shell/shell.h"
#include "solver/model.h"

#include <math.h>
#include <string.h>

void ruga_variation_clear(ruga_variation* variation) {
    double* const owned[] = {
        variation->thickness,          variation->young,          variation->growth,
        variation->triangle_thickness, variation->triangle_young, variation->triangle_growth,
        variation->wavelength,         variation->scale,          variation->triangle_critical};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    *variation = (ruga_variation){0};
}

static ruga_status check_values(const double* values, const char* name, int components,
                                const ruga_mesh* mesh) {
    for (int i = 0; i < components * mesh->vertex_count; i++) {
        if (!(values[i] > 0) || !isfinite(values[i])) {
            const double* x = mesh->position + 3 * (size_t)(i / components);
            return ruga_fail(RUGA_BAD_INPUT,
                             "skin.%s is %g at vertex %d (%.6g, %.6g, %.6g) m; it must be above 0", name,
                             values[i], i / components, x[0], x[1], x[2]);
        }
    }
    return RUGA_OK;
}

static bool are_equal(const double* values, int components, int count) {
    for (int i = components; i < components * count; i++) {
        if (values[i] != values[i % components]) {
            return false;
        }
    }
    return true;
}

static void mean_over_area(const ruga_model* model, const double* values, int components, double* mean) {
    double total = 0;
    memset(mean, 0, (size_t)components * sizeof *mean);
    for (int v = 0; v < model->mesh.vertex_count; v++) {
        total += model->vertex_area[v];
        for (int c = 0; c < components; c++) {
            mean[c] += model->vertex_area[v] * values[components * v + c];
        }
    }
    for (int c = 0; c < components; c++) {
        mean[c] /= total;
    }
}

// One of the three: *vertex and *triangle stay NULL where it is the same everywhere; single [components] is
// set.
static ruga_status take(const ruga_model* model, const double* values, const char* name, int components,
                        double* single, double** vertex, double** triangle) {
    const ruga_mesh* mesh = &model->mesh;
    if (!values) {
        return RUGA_OK;
    }
    RUGA_TRY(check_values(values, name, components, mesh));
    if (are_equal(values, components, mesh->vertex_count)) {
        memcpy(single, values, (size_t)components * sizeof *single);
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_NEW(*vertex, (size_t)components * (size_t)mesh->vertex_count));
    RUGA_TRY(RUGA_NEW(*triangle, (size_t)components * (size_t)mesh->triangle_count));
    memcpy(*vertex, values, (size_t)components * (size_t)mesh->vertex_count * sizeof **vertex);
    ruga_mesh_triangle_averages(mesh, components, *vertex, *triangle);
    mean_over_area(model, *vertex, components, single);
    return RUGA_OK;
}

static ruga_status check_count(const ruga_skin_def* skin, const ruga_mesh* mesh) {
    bool any = skin->vertex_thickness || skin->vertex_young || skin->vertex_growth;
    return !any || skin->vertex_count == mesh->vertex_count
               ? RUGA_OK
               : ruga_fail(
                     RUGA_BAD_INPUT,
                     "skin.vertex_count is %d, but the mesh has %d vertices: give one value for each of them",
                     skin->vertex_count, mesh->vertex_count);
}

ruga_status ruga_variation_create(const ruga_skin_def* skin, ruga_model* model) {
    ruga_variation* v = &model->variation;
    ruga_skin_def* single = &model->skin;
    RUGA_TRY(check_count(skin, &model->mesh));
    RUGA_TRY(take(model, skin->vertex_thickness, "vertex_thickness", 1, &single->thickness, &v->thickness,
                  &v->triangle_thickness));
    RUGA_TRY(
        take(model, skin->vertex_young, "vertex_young", 1, &single->young, &v->young, &v->triangle_young));
    RUGA_TRY(take(model, skin->vertex_growth, "vertex_growth", 2, single->growth, &v->growth,
                  &v->triangle_growth));
    single->vertex_thickness = single->vertex_young = single->vertex_growth = NULL;
    single->vertex_count = 0;
    return RUGA_OK;
}

// ---- on a mesh that is cut -----------------------------------------------------------------------------

enum { COLUMNS = 4 }; // thickness, Young's modulus, growth along and across

// The array that a column is in, and how far apart its values are there.
static const double* column_of(const ruga_skin_def* skin, int column, int* stride) {
    *stride = column < 2 ? 1 : 2;
    return column == 0   ? skin->vertex_thickness
           : column == 1 ? skin->vertex_young
           : column == 2 ? skin->vertex_growth
           : skin->vertex_growth ? skin->vertex_growth + 1
                                 : NULL;
}

ruga_status ruga_variation_carry(const ruga_skin_def* skin, ruga_mesh* mesh) {
    int count = 0, stride;
    RUGA_TRY(check_count(skin, mesh));
    RUGA_ASSERT(mesh->attribute_count == 0);
    for (int c = 0; c < COLUMNS; c++) {
        count += column_of(skin, c, &stride) != NULL;
    }
    if (count == 0) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_NEW_ZERO(mesh->attribute_name, count));
    mesh->attribute_count = count;
    RUGA_TRY(RUGA_NEW(mesh->attribute, (size_t)count * (size_t)mesh->vertex_count));
    for (int c = 0, out = 0; c < COLUMNS; c++) {
        const double* values = column_of(skin, c, &stride);
        if (!values) {
            continue;
        }
        mesh->attribute_name[out] = ruga_copy_string("skin");
        if (!mesh->attribute_name[out]) {
            return ruga_fail(RUGA_NO_MEMORY, "out of memory: the skin's values");
        }
        for (int v = 0; v < mesh->vertex_count; v++) {
            mesh->attribute[count * v + out] = values[stride * v];
        }
        out++;
    }
    return RUGA_OK;
}

ruga_status ruga_variation_create_cut(const ruga_skin_def* skin, ruga_model* model) {
    ruga_status status = RUGA_OK;
    const ruga_cut* cut = &model->creases->cut;
    const ruga_mesh* sheet = model->sheet;
    int nodes = cut->node_count, stride;
    double* values[3] = {NULL, NULL, NULL};
    ruga_skin_def own = *skin;
    for (int c = 0, in = 0; c < COLUMNS; c++) {
        if (!column_of(skin, c, &stride)) {
            continue;
        }
        double** array = &values[c < 2 ? c : 2];
        if (!*array) {
            RUGA_TRY_DONE(RUGA_NEW(*array, (size_t)stride * (size_t)nodes));
        }
        for (int n = 0; n < nodes; n++) {
            (*array)[stride * n + (c == 3)] = sheet->attribute[sheet->attribute_count * cut->source[n] + in];
        }
        in++;
    }
    own.vertex_count = nodes;
    own.vertex_thickness = values[0];
    own.vertex_young = values[1];
    own.vertex_growth = values[2];
    RUGA_TRY_DONE(ruga_variation_create(&own, model));
done:
    for (int i = 0; i < 3; i++) {
        ruga_release(values[i]);
    }
    return status;
}

ruga_status ruga_variation_show(const ruga_model* model, const double* values, int components, double** shown) {
    const ruga_creases* creases = model->creases;
    int vertices = ruga_model_shown(model)->vertex_count, real = creases ? creases->cut.real_count : vertices;
    *shown = NULL;
    if (!values) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_NEW(*shown, (size_t)components * (size_t)vertices));
    memcpy(*shown, values, (size_t)components * (size_t)real * sizeof *values);
    for (int v = real; v < vertices; v++) {
        const ruga_bound* bound = &creases->cut.bound[v - real];
        const int* end = creases->raster.edges.edge[bound->edge];
        for (int c = 0; c < components; c++) {
            (*shown)[components * v + c] =
                bound->weight[0] * values[components * end[0] + c] + bound->weight[1] * values[components * end[1] + c];
        }
    }
    return RUGA_OK;
}

// ---- wavelengths ---------------------------------------------------------------------------------------

static ruga_skin_def skin_of(const ruga_model* model, const double* thickness, const double* young, int i) {
    ruga_skin_def skin = model->skin;
    skin.thickness = thickness ? thickness[i] : skin.thickness;
    skin.young = young ? young[i] : skin.young;
    return skin;
}

// The place with the fewest edges per wavelength, by the mean length of the edges at each vertex.
static void find_worst_edges(ruga_model* model) {
    const ruga_connectivity* c = &model->connectivity;
    model->edges = INFINITY;
    for (int v = 0; v < c->vertex_count; v++) { // of the sheet, which are the first nodes
        const double* x = model->mesh.position + 3 * (size_t)v;
        int begin = c->neighbour_start[v], end = c->neighbour_start[v + 1];
        double length = 0, lambda = model->variation.wavelength[v];
        for (int k = begin; k < end; k++) {
            length += ruga_distance(x, model->mesh.position + 3 * (size_t)c->neighbour[k]) / (end - begin);
        }
        if (length > 0 && lambda / length < model->edges) {
            model->edges = lambda / length;
            model->edges_wavelength = lambda;
        }
    }
}

static ruga_status set_local(ruga_model* model) {
    ruga_variation* local = &model->variation;
    int vertices = model->mesh.vertex_count, triangles = model->mesh.triangle_count;
    RUGA_TRY(RUGA_NEW(local->wavelength, vertices));
    RUGA_TRY(RUGA_NEW(local->scale, vertices));
    RUGA_TRY(RUGA_NEW(local->triangle_critical, triangles));
    model->wavelength_min = model->critical_strain = INFINITY;
    model->wavelength_max = model->critical_strain_max = 0;
    for (int v = 0; v < vertices; v++) {
        ruga_skin_def skin = skin_of(model, local->thickness, local->young, v);
        double critical = ruga_wrinkle_critical_strain(&skin, &model->interior);
        local->wavelength[v] = ruga_wrinkle_wavelength(&skin, &model->interior);
        model->wavelength_min = fmin(model->wavelength_min, local->wavelength[v]);
        model->wavelength_max = fmax(model->wavelength_max, local->wavelength[v]);
        model->critical_strain = fmin(model->critical_strain, critical);
        model->critical_strain_max = fmax(model->critical_strain_max, critical);
    }
    mean_over_area(model, local->wavelength, 1, &model->wavelength);
    for (int v = 0; v < vertices; v++) {
        local->scale[v] = local->wavelength[v] / model->wavelength;
    }
    for (int f = 0; f < triangles; f++) {
        ruga_skin_def skin = skin_of(model, local->triangle_thickness, local->triangle_young, f);
        local->triangle_critical[f] = ruga_wrinkle_critical_strain(&skin, &model->interior);
    }
    find_worst_edges(model);
    return RUGA_OK;
}

ruga_status ruga_variation_wavelengths(ruga_model* model) {
    if (model->variation.thickness || model->variation.young) {
        return set_local(model);
    }
    model->wavelength = ruga_wrinkle_wavelength(&model->skin, &model->interior);
    model->critical_strain = ruga_wrinkle_critical_strain(&model->skin, &model->interior);
    model->wavelength_min = model->wavelength_max = model->edges_wavelength = model->wavelength;
    model->critical_strain_max = model->critical_strain;
    model->edges = model->wavelength / model->mean_edge;
    return RUGA_OK;
}
