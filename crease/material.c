// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The mesh that is shown and exported: mesh vertices and embedded nodes, each piece in triangles. Everything
// that the mesh carried is carried along: texture coordinates of an embedded node are linear on its edge, in
// each chart that meets there; so are attributes. Vertices on both sides of an open cut have the same source.
#include "crease/cut.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <string.h>

typedef struct maker {
    const ruga_raster* raster;
    ruga_cut* cut;
    int (*edge_uv)[2]; // [E] uv at the embedded node, on the side of each triangle
} maker;

// Triangles of a piece's polygon, as places. Returns their number.
static int triangulate(const ruga_raster* r, const ruga_cut_piece* piece, ruga_split* split) {
    double position[RUGA_BORDER_PLACES][3];
    *split = (ruga_split){.piece_count = 1, .piece = {piece->polygon}};
    if (piece->polygon.count > 3) {
        ruga_raster_places(r, piece->triangle, position);
        ruga_split_fill(split, (const double(*)[3])position);
    }
    return split->piece_count;
}

static int count_triangles(const ruga_raster* r, const ruga_cut* cut) {
    int count = 0;
    for (int p = 0; p < cut->piece_count; p++) {
        ruga_split split;
        count += triangulate(r, &cut->piece[p], &split);
    }
    return count;
}

static ruga_status allocate(const maker* m) {
    const ruga_mesh* from = &m->raster->mesh;
    ruga_mesh* to = &m->cut->material;
    to->vertex_count = m->cut->real_count + m->cut->bound_count;
    to->triangle_count = count_triangles(m->raster, m->cut);
    RUGA_TRY(RUGA_NEW(to->position, 3 * (size_t)to->vertex_count));
    RUGA_TRY(RUGA_NEW(to->source_vertex, to->vertex_count));
    RUGA_TRY(RUGA_NEW(to->triangle, 3 * (size_t)to->triangle_count));
    RUGA_TRY(RUGA_NEW(to->polygon, to->triangle_count));
    RUGA_TRY(RUGA_NEW(m->cut->material_piece, to->triangle_count));
    RUGA_TRY(ruga_mesh_allocate_attributes(from, to));
    if (from->face_group) {
        RUGA_TRY(RUGA_NEW(to->face_group, to->triangle_count));
        RUGA_TRY(RUGA_NEW_ZERO(to->group_name, from->group_count));
        to->group_count = from->group_count;
        for (int g = 0; g < from->group_count; g++) {
            to->group_name[g] = ruga_copy_string(from->group_name[g]);
            if (!to->group_name[g]) {
                return ruga_fail(RUGA_NO_MEMORY, "out of memory for %d group names", from->group_count);
            }
        }
    }
    return RUGA_OK;
}

static void fill_vertices(const maker* m) {
    const ruga_mesh* from = &m->raster->mesh;
    const ruga_cut* cut = m->cut;
    ruga_mesh* to = &m->cut->material;
    size_t attributes = (size_t)from->attribute_count;
    for (size_t v = 0; v < (size_t)to->vertex_count; v++) {
        const ruga_bound* b = v < (size_t)cut->real_count ? NULL : &cut->bound[v - (size_t)cut->real_count];
        const int* ends = b ? m->raster->edges.edge[b->edge] : &cut->source[v];
        const double weight[2] = {b ? b->weight[0] : 1, b ? b->weight[1] : 0};
        to->source_vertex[v] = b ? -1 : from->source_vertex ? from->source_vertex[ends[0]] : ends[0];
        memset(to->position + 3 * v, 0, 3 * sizeof *to->position);
        for (int end = 0; end < (b ? 2 : 1); end++) {
            ruga_add_scaled(weight[end], from->position + 3 * (size_t)ends[end], to->position + 3 * v);
        }
        for (size_t a = 0; a < attributes; a++) {
            to->attribute[attributes * v + a] = 0;
            for (int end = 0; end < (b ? 2 : 1); end++) {
                to->attribute[attributes * v + a] +=
                    weight[end] * from->attribute[attributes * (size_t)ends[end] + a];
            }
        }
    }
}

// New uvs on cut edges: one for both sides where they agree at both ends.
static ruga_status fill_uvs(maker* m) {
    const ruga_raster* r = m->raster;
    const ruga_mesh* from = &r->mesh;
    ruga_mesh* to = &m->cut->material;
    int most = from->uv_count;
    for (int e = 0; e < r->edges.edge_count; e++) {
        most += r->node[e] > 0 ? 2 : 0;
    }
    RUGA_TRY(RUGA_NEW(m->edge_uv, r->edges.edge_count));
    RUGA_TRY(RUGA_NEW(to->uv, 2 * (size_t)most));
    RUGA_TRY(RUGA_NEW(to->uv_triangle, 3 * (size_t)to->triangle_count));
    memcpy(to->uv, from->uv, 2 * (size_t)from->uv_count * sizeof *to->uv);
    to->uv_count = from->uv_count;
    for (int e = 0; e < r->edges.edge_count; e++) {
        int old[2][2] = {{-1, -1}, {-1, -1}};
        m->edge_uv[e][0] = m->edge_uv[e][1] = -1;
        for (int side = 0; side < 2 && r->node[e] > 0; side++) {
            int f = r->edges.edge_triangle[e][side];
            for (int i = 0; i < 3 && f >= 0; i++) {
                int v = from->triangle[3 * (size_t)f + (size_t)i];
                for (int end = 0; end < 2; end++) {
                    old[side][end] = v == r->edges.edge[e][end] ? from->uv_triangle[3 * (size_t)f + (size_t)i]
                                                                : old[side][end];
                }
            }
            if (old[side][0] < 0 || old[side][1] < 0) {
                continue;
            }
            if (side == 1 && old[1][0] == old[0][0] && old[1][1] == old[0][1]) {
                m->edge_uv[e][1] = m->edge_uv[e][0];
                continue;
            }
            for (size_t k = 0; k < 2; k++) {
                to->uv[2 * (size_t)to->uv_count + k] =
                    (1 - r->node[e]) * from->uv[2 * (size_t)old[side][0] + k] +
                    r->node[e] * from->uv[2 * (size_t)old[side][1] + k];
            }
            m->edge_uv[e][side] = to->uv_count++;
        }
    }
    return RUGA_OK;
}

static int uv_at(const maker* m, int f, int place) {
    const ruga_raster* r = m->raster;
    if (place % 2 == 0) {
        return r->mesh.uv_triangle[3 * (size_t)f + (size_t)(place / 2)];
    }
    int e = r->edges.triangle_edge[f][place / 2];
    return m->edge_uv[e][r->edges.edge_triangle[e][0] == f ? 0 : 1];
}

static void fill_triangles(const maker* m) {
    const ruga_mesh* from = &m->raster->mesh;
    ruga_mesh* to = &m->cut->material;
    size_t out = 0;
    for (int p = 0; p < m->cut->piece_count; p++) {
        const ruga_cut_piece* piece = &m->cut->piece[p];
        ruga_split split;
        int count = triangulate(m->raster, piece, &split);
        for (int k = 0; k < count; k++, out++) {
            for (size_t i = 0; i < 3; i++) {
                int place = split.piece[k].place[i];
                to->triangle[3 * out + i] = ruga_cut_vertex(m->cut, piece, place);
                if (to->uv_triangle) {
                    to->uv_triangle[3 * out + i] = uv_at(m, piece->triangle, place);
                }
            }
            to->polygon[out] = from->polygon ? from->polygon[piece->triangle] : piece->triangle;
            m->cut->material_piece[out] = p;
            if (to->face_group) {
                to->face_group[out] = from->face_group[piece->triangle];
            }
        }
    }
}

ruga_status ruga_cut_make_material(const ruga_raster* raster, ruga_cut* cut) {
    maker m = {.raster = raster, .cut = cut};
    RUGA_TRY(allocate(&m));
    fill_vertices(&m);
    ruga_status status = raster->mesh.uv_triangle ? fill_uvs(&m) : RUGA_OK;
    if (status == RUGA_OK) {
        fill_triangles(&m);
    }
    ruga_release(m.edge_uv);
    return status;
}
