// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Clusters and lattice elements at the vertices are not in the file. Both follow from the rest mesh and the
// scene, by the same functions that the run called; the lattice made again is compared with the file's.
#include "app/coloring.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "io/scene.h"
#include "lattice/lattice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- places --------------------------------------------------------------------------------------------

// A pair of places that meet at an edge of the mesh.
typedef struct pair {
    int a, b;
} pair;

static int compare_pairs(const void* left, const void* right) {
    const pair *l = left, *r = right;
    return l->a != r->a ? (l->a > r->a) - (l->a < r->a) : (l->b > r->b) - (l->b < r->b);
}

static int take_color(const pair* pairs, int begin, int end, const int* color) {
    int used[RUGA_COLORMAP_PLACES] = {0}, best = 0;
    // Another start for each place, or the first colours would be all that is seen.
    int start = pairs[begin].a * 5 % RUGA_COLORMAP_PLACES;
    for (int i = begin; i < end; i++) {
        used[color[pairs[i].b] >= 0 ? color[pairs[i].b] : 0] += color[pairs[i].b] >= 0;
    }
    best = start;
    for (int k = 0; k < RUGA_COLORMAP_PLACES; k++) {
        int candidate = (start + k) % RUGA_COLORMAP_PLACES;
        best = used[candidate] < used[best] ? candidate : best;
    }
    return best;
}

// Places [V], numbered from 0, become colours of which neighbours have different ones while there are enough.
static ruga_status color_places(const ruga_mesh* mesh, int count, int* place) {
    ruga_status status = RUGA_OK;
    pair* pairs = NULL;
    int *color = NULL, used = 0;
    RUGA_TRY_DONE(RUGA_NEW(pairs, 6 * (size_t)mesh->triangle_count + 1));
    RUGA_TRY_DONE(RUGA_NEW(color, count));
    for (int c = 0; c < 3 * mesh->triangle_count; c++) {
        int a = place[mesh->triangle[c]], b = place[mesh->triangle[c % 3 == 2 ? c - 2 : c + 1]];
        if (a != b) {
            pairs[used++] = (pair){a, b};
            pairs[used++] = (pair){b, a};
        }
    }
    qsort(pairs, (size_t)used, sizeof *pairs, compare_pairs);
    for (int i = 0; i < count; i++) {
        color[i] = -1;
    }
    for (int begin = 0, end; begin < used; begin = end) {
        for (end = begin; end < used && pairs[end].a == pairs[begin].a; end++) {
        }
        color[pairs[begin].a] = take_color(pairs, begin, end, color);
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        place[v] = color[place[v]] >= 0 ? color[place[v]] : 0;
    }
done:
    ruga_release(pairs);
    ruga_release(color);
    return status;
}

static ruga_status read_settings(const ruga_coloring* c, ruga_scene* scene) {
    return ruga_scene_read_settings(ruga_result_reader_header(c->reader)->scene_text, c->path, scene);
}

static ruga_status refuse_interior(const ruga_coloring* c, const char* color) {
    return ruga_result_has_interior(c->reader)
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT, "--color %s: %s has no interior", color, c->path);
}

// Each vertex to the cluster that weighs it most.
static void take_clusters(const ruga_clusters* clusters, int* place) {
    for (int v = 0; v < clusters->vertex_count; v++) {
        double most = 0;
        place[v] = 0;
        for (int k = clusters->column_start[v]; k < clusters->column_start[v + 1]; k++) {
            if (clusters->column_weight[k] > most) {
                most = clusters->column_weight[k];
                place[v] = clusters->column_row[k];
            }
        }
    }
}

static ruga_status make_clusters(ruga_coloring* c, const ruga_connectivity* connectivity, int count) {
    const ruga_result_header* header = ruga_result_reader_header(c->reader);
    const ruga_mesh* mesh = header->mesh;
    ruga_clusters clusters = {0};
    double* scale = NULL;
    if (header->vertex_wavelength) {
        scale = c->work;
        for (int v = 0; v < mesh->vertex_count; v++) {
            scale[v] = header->vertex_wavelength[v] / header->wavelength;
        }
    }
    RUGA_TRY(ruga_clusters_create_local(mesh, connectivity, header->cluster_radius, header->cluster_sigma,
                                        scale, count, header->seed, &clusters));
    take_clusters(&clusters, c->place);
    ruga_status status = color_places(mesh, clusters.count, c->place);
    (void)snprintf(c->note, sizeof c->note, "%d clusters, \xcf\x83 = %.3g mm", clusters.count,
                   1e3 * header->cluster_sigma);
    ruga_clusters_clear(&clusters);
    return status;
}

static ruga_status choose_clusters(ruga_coloring* c) {
    ruga_scene scene;
    ruga_connectivity connectivity = {0};
    RUGA_TRY(refuse_interior(c, "clusters"));
    RUGA_TRY(read_settings(c, &scene));
    ruga_status status = RUGA_OK;
    if (scene.def.coupling.kind != RUGA_COUPLING_CLUSTERS) {
        status =
            ruga_fail(RUGA_BAD_INPUT, "--color clusters: the coupling of %s is %s, which has no clusters",
                      c->path, scene.def.coupling.kind == RUGA_COUPLING_NONE ? "none" : "spectral");
        goto done;
    }
    RUGA_TRY_DONE(ruga_connectivity_create(ruga_result_mesh(c->reader), &connectivity));
    RUGA_TRY_DONE(make_clusters(c, &connectivity, scene.def.coupling.count));
done:
    ruga_connectivity_clear(&connectivity);
    ruga_scene_clear(&scene);
    return status;
}

static ruga_status compare_lattice(const ruga_coloring* c, const ruga_lattice* lattice) {
    int nodes, elements;
    double* rest = NULL;
    RUGA_TRY(ruga_result_read_lattice(c->reader, 0, &nodes, &elements, NULL));
    bool same = nodes == lattice->node_count && elements == lattice->element_count;
    if (same) {
        RUGA_TRY(RUGA_NEW(rest, 3 * (size_t)nodes));
        ruga_status status = ruga_result_read_lattice_rest(c->reader, NULL, NULL, rest);
        same = status == RUGA_OK && memcmp(rest, lattice->rest, 3 * (size_t)nodes * sizeof *rest) == 0;
        ruga_release(rest);
        RUGA_TRY(status);
    }
    return same ? RUGA_OK
                : ruga_fail(RUGA_BAD_INPUT,
                            "--color elements: the lattice made from the scene in %s is not the one in the "
                            "file; was it "
                            "written by another version of Ruga?",
                            c->path);
}

static ruga_status choose_elements(ruga_coloring* c) {
    ruga_scene scene;
    ruga_connectivity connectivity = {0};
    ruga_lattice lattice = {0};
    const ruga_mesh* mesh = ruga_result_mesh(c->reader);
    RUGA_TRY(refuse_interior(c, "elements"));
    RUGA_TRY(read_settings(c, &scene));
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(ruga_connectivity_create(mesh, &connectivity));
    RUGA_TRY_DONE(ruga_lattice_create(mesh, &connectivity, &scene.def.lattice, &lattice));
    RUGA_TRY_DONE(compare_lattice(c, &lattice));
    memcpy(c->place, lattice.vertex_element, (size_t)mesh->vertex_count * sizeof *c->place);
    RUGA_TRY_DONE(color_places(mesh, lattice.element_count, c->place));
    (void)snprintf(c->note, sizeof c->note, "%d elements of %.3g x %.3g x %.3g mm, %d of them superimposed",
                   lattice.element_count, 1e3 * lattice.cell_size[0], 1e3 * lattice.cell_size[1],
                   1e3 * lattice.cell_size[2], lattice.superimposed);
done:
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_scene_clear(&scene);
    return status;
}

// ---- creases -------------------------------------------------------------------------------------------

// Marks the edge of the mesh between two vertices in both of its triangles.
static void mark_edge(const ruga_connectivity* c, int a, int b, int segment, int* line) {
    for (int k = c->neighbour_start[a]; k < c->neighbour_start[a + 1]; k++) {
        int edge = c->neighbour_edge[k];
        for (int side = 0; side < 2 && c->neighbour[k] == b; side++) {
            int f = c->edge_triangle[edge][side];
            for (int i = 0; f >= 0 && i < 3; i++) {
                if (c->triangle_edge[f][i] == edge) {
                    line[3 * (size_t)f + (size_t)i] = segment;
                }
            }
        }
    }
}

// Creases of the result, where it has some.
static ruga_status read_segments(ruga_coloring* c) {
    const ruga_mesh* mesh = ruga_result_mesh(c->reader);
    const ruga_result_creases* creases = ruga_result_reader_header(c->reader)->creases;
    ruga_connectivity connectivity = {0};
    size_t corners = 3 * (size_t)mesh->triangle_count;
    if (!creases) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_NEW(c->line_angle, creases->segment_count));
    RUGA_TRY(RUGA_NEW(c->line, corners));
    for (size_t i = 0; i < corners; i++) {
        c->line[i] = -1;
    }
    RUGA_TRY(ruga_connectivity_create(mesh, &connectivity));
    for (int s = 0; s < creases->segment_count; s++) {
        mark_edge(&connectivity, creases->segment[2 * s], creases->segment[2 * s + 1], s, c->line);
    }
    ruga_connectivity_clear(&connectivity);
    return RUGA_OK;
}

static ruga_status choose_creases(ruga_coloring* c) {
    c->scale = (ruga_scale){.name = "fold angle, deg (valley > 0)", .unit = RUGA_PI / 180};
    return c->line ? RUGA_OK : ruga_fail(RUGA_BAD_INPUT, "--color creases: %s has no creases", c->path);
}

// ---- life ----------------------------------------------------------------------------------------------

static ruga_status choose_displacement(ruga_coloring* c) {
    const ruga_result_header* header = ruga_result_reader_header(c->reader);
    if (!ruga_result_has_interior(c->reader)) {
        return ruga_fail(RUGA_BAD_INPUT, "--color displacement: %s has no interior to measure from", c->path);
    }
    c->scale = (ruga_scale){.name = "displacement, mm", .unit = 1e-3};
    return ruga_measure_create_local(header->mesh, header->wavelength, header->vertex_wavelength,
                                     header->seed, &c->measure);
}

static ruga_status choose_stress(ruga_coloring* c) {
    const ruga_result_header* header = ruga_result_reader_header(c->reader);
    ruga_scene scene;
    RUGA_TRY(read_settings(c, &scene));
    const ruga_skin_def* skin = &scene.def.skin;
    c->skin = (ruga_stress_skin){.young = skin->young,
                                 .poisson = skin->poisson,
                                 .growth = {skin->growth[0], skin->growth[1]},
                                 .vertex_young = header->vertex_young,
                                 .vertex_growth = header->vertex_growth};
    bool shell = skin->model == RUGA_SKIN_SHELL;
    ruga_scene_clear(&scene);
    c->scale = (ruga_scale){.map = RUGA_COLORMAP_SEQUENTIAL};
    return shell ? RUGA_OK : ruga_fail(RUGA_BAD_INPUT, "--color stress: the skin of %s is no shell", c->path);
}

// A value of the skin that the file has at the vertices.
static ruga_status choose_skin_value(ruga_coloring* c) {
    static const char* const names[] = {"thickness", "young", "wavelength"};
    const ruga_result_header* header = ruga_result_reader_header(c->reader);
    const ruga_scale scales[] = {
        {.value = header->vertex_thickness, .name = "thickness, mm", .unit = 1e-3},
        {.value = header->vertex_young, .name = "Young's modulus, MPa", .unit = 1e6},
        {.value = header->vertex_wavelength, .name = "wavelength, mm", .unit = 1e-3}};
    int which = (int)c->kind - RUGA_COLORING_THICKNESS;
    c->scale = scales[which];
    c->scale.map = RUGA_COLORMAP_SEQUENTIAL;
    return c->scale.value ? RUGA_OK
                          : ruga_fail(RUGA_BAD_INPUT, "--color %s: the %s of the skin in %s does not vary",
                                      names[which], which == 1 ? "Young's modulus" : names[which], c->path);
}

ruga_status ruga_coloring_create(const char* path, ruga_result_reader* reader, ruga_coloring_kind kind,
                                 ruga_coloring* coloring) {
    ruga_coloring* c = coloring;
    int vertices = ruga_result_mesh(reader)->vertex_count;
    *c = (ruga_coloring){.kind = kind, .path = path, .reader = reader};
    RUGA_TRY(RUGA_NEW(c->value, vertices));
    RUGA_TRY(RUGA_NEW(c->work, vertices));
    RUGA_TRY(RUGA_NEW(c->place, vertices));
    RUGA_TRY(RUGA_NEW(c->position, 3 * (size_t)vertices));
    RUGA_TRY(RUGA_NEW(c->embedded, 3 * (size_t)vertices));
    RUGA_TRY(read_segments(c));
    switch (kind) {
    case RUGA_COLORING_CLAY:
        return RUGA_OK;
    case RUGA_COLORING_DISPLACEMENT:
        return choose_displacement(c);
    case RUGA_COLORING_STRESS:
        return choose_stress(c);
    case RUGA_COLORING_CLUSTERS:
        return choose_clusters(c);
    case RUGA_COLORING_ELEMENTS:
        return choose_elements(c);
    case RUGA_COLORING_CREASES:
        return choose_creases(c);
    default:
        return choose_skin_value(c);
    }
}

void ruga_coloring_clear(ruga_coloring* c) {
    ruga_measure_destroy(&c->measure);
    ruga_release(c->value);
    ruga_release(c->work);
    ruga_release(c->place);
    ruga_release(c->line);
    ruga_release(c->line_angle);
    ruga_release(c->position);
    ruga_release(c->embedded);
    *c = (ruga_coloring){0};
}

bool ruga_coloring_needs_embedded(const ruga_coloring* c) {
    return c->kind == RUGA_COLORING_DISPLACEMENT;
}

// ---- frames --------------------------------------------------------------------------------------------

// The frame's values; NULL where there are none. count = how many.
static ruga_status compute(ruga_coloring* c, int frame, const double* position, const double* embedded,
                           const double** values, int* count) {
    const ruga_mesh* mesh = ruga_result_mesh(c->reader);
    ruga_measured unused;
    *values = c->scale.value;
    *count = mesh->vertex_count;
    if (c->kind == RUGA_COLORING_DISPLACEMENT) {
        RUGA_TRY(ruga_measure_frame(c->measure, position, embedded, &unused));
        *values = ruga_measure_displacement(c->measure);
    } else if (c->kind == RUGA_COLORING_STRESS) {
        ruga_stress_compute(mesh, &c->skin, position, c->work, c->value);
        *values = c->value;
    } else if (c->kind == RUGA_COLORING_CREASES) {
        RUGA_TRY(ruga_result_read_creases(c->reader, frame, c->line_angle, NULL, NULL));
        *values = c->line_angle;
        *count = ruga_result_reader_header(c->reader)->creases->segment_count;
    }
    return RUGA_OK;
}

static void finish_scale(ruga_coloring* c, double low, double high) {
    ruga_scale* s = &c->scale;
    if (s->map == RUGA_COLORMAP_DIVERGING) {
        double least = c->kind == RUGA_COLORING_CREASES ? RUGA_PI / 180 : 1e-6;
        high = fmax(fmax(fabs(low), fabs(high)), least);
        low = -high;
    }
    s->min = c->kind == RUGA_COLORING_STRESS ? 0 : low;
    s->max = high;
    if (c->kind == RUGA_COLORING_STRESS) {
        double mega = high >= 0.5e6;
        s->name = mega ? "von Mises stress, MPa" : "von Mises stress, kPa";
        s->unit = mega ? 1e6 : 1e3;
    }
}

ruga_status ruga_coloring_scan(ruga_coloring* c, const ruga_frame_range* range, ruga_extent* extent) {
    double low = INFINITY, high = -INFINITY;
    int vertices = ruga_result_mesh(c->reader)->vertex_count, count;
    const double* values;
    *extent = (ruga_extent){.any = false};
    for (int frame = range->first; frame <= range->last; frame++) {
        RUGA_TRY(ruga_result_read_frame(c->reader, frame, NULL, c->position,
                                        ruga_coloring_needs_embedded(c) ? c->embedded : NULL, NULL));
        ruga_extent_add(extent, vertices, c->position);
        RUGA_TRY(compute(c, frame, c->position, c->embedded, &values, &count));
        for (int i = 0; values && i < count; i++) {
            low = fmin(low, values[i]);
            high = fmax(high, values[i]);
        }
    }
    if (low <= high) {
        finish_scale(c, low, high);
    }
    return RUGA_OK;
}

ruga_status ruga_coloring_set(ruga_coloring* c, int frame, const double* position, const double* embedded,
                              ruga_render_def* def) {
    const double* values;
    int count;
    RUGA_TRY(compute(c, frame, position, embedded, &values, &count));
    ruga_scale scale = c->scale;
    scale.value = values;
    def->line = c->line;
    def->draw_lines = c->kind == RUGA_COLORING_CREASES;
    if (def->draw_lines) {
        def->lines = scale;
    } else {
        def->scalar = scale;
    }
    def->place = c->note[0] ? c->place : NULL;
    def->note = c->note[0] ? c->note : NULL;
    return RUGA_OK;
}
