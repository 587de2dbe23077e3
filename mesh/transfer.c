// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Texture coordinates of a new surface from an old one close to it, without mixing charts.
//
// The old face nearest to a new face's centroid predicts the uv of its three corners by its own affine map.
// The uv of the old surface at the new vertex is taken where it agrees with that prediction; otherwise the
// vertex lies beyond a seam, and the uv is taken at a point a little towards the centroid or, failing that,
// is the prediction. So each new face lies within one chart, continued past the seam where it overhangs, and
// vertices away from seams have one uv. Agreement: within half an edge, measured in uv.
//
// Attributes have no charts: a new vertex takes those of the nearest point of the old surface, linear in its
// face.
#include "mesh/transfer.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/cgal_shim.h"

#include <string.h>

static const double same_place = 1e-9;     // edges
static const double towards_centre = 0.05; // of the way to the centroid
static const double agreement = 0.5;       // edges
static const double furthest = 20;         // barycentric coordinates beyond which a map is not continued

typedef struct nearest {
    int* face;     // [count] of the old mesh
    double* point; // [count][3]
} nearest;

typedef struct transfer {
    const ruga_mesh* old;
    ruga_mesh* mesh;
    double edge;
    nearest vertex; // [V] from each new vertex
    nearest corner; // [3 F] from each new corner, moved towards the centroid
    nearest centre; // [F] from each new centroid
    int uv_capacity;
    int* first; // [V] first uv of a vertex, -1 = none
    int next_capacity;
    int* next; // [uv_count] next uv of the same vertex
} transfer;

static void nearest_clear(nearest* n) {
    ruga_release(n->face);
    ruga_release(n->point);
}

static ruga_status nearest_find(const ruga_cgal_locator* locator, int count, const double* from, nearest* n) {
    RUGA_TRY(RUGA_NEW(n->face, count));
    RUGA_TRY(RUGA_NEW(n->point, 3 * (size_t)count));
    return ruga_cgal_locator_nearest(locator, count, from, n->face, n->point);
}

// ---- source vertices

static void put_on_old_vertices(transfer* t) {
    for (int v = 0; v < t->mesh->vertex_count; v++) {
        const int* corner = t->old->triangle + 3 * (size_t)t->vertex.face[v];
        double* x = t->mesh->position + 3 * (size_t)v;
        t->mesh->source_vertex[v] = -1;
        for (int i = 0; i < 3; i++) {
            const double* p = t->old->position + 3 * (size_t)corner[i];
            if (ruga_distance(x, p) <= same_place * t->edge) {
                memcpy(x, p, 3 * sizeof *x);
                t->mesh->source_vertex[v] =
                    t->old->source_vertex ? t->old->source_vertex[corner[i]] : corner[i];
            }
        }
    }
}

// ---- attributes

// Barycentric weights of a point of a face.
static void weigh_corners(const ruga_mesh* mesh, int face, const double point[3], double weight[3]) {
    const int* corner = mesh->triangle + 3 * (size_t)face;
    const double* p[3];
    double n[3];
    for (int i = 0; i < 3; i++) {
        p[i] = mesh->position + 3 * (size_t)corner[i];
    }
    ruga_triangle_normal(p[0], p[1], p[2], n);
    for (int i = 0; i < 3; i++) {
        double part[3];
        ruga_triangle_normal(point, p[(i + 1) % 3], p[(i + 2) % 3], part);
        weight[i] = ruga_dot(part, n) / ruga_dot(n, n);
    }
}

static void transfer_attributes(transfer* t) {
    const ruga_mesh* old = t->old;
    size_t count = (size_t)old->attribute_count;
    for (size_t v = 0; v < (size_t)t->mesh->vertex_count; v++) {
        const int* corner = old->triangle + 3 * (size_t)t->vertex.face[v];
        double weight[3], *to = t->mesh->attribute + count * v;
        weigh_corners(old, t->vertex.face[v], t->vertex.point + 3 * v, weight);
        memset(to, 0, count * sizeof *to);
        for (int i = 0; i < 3; i++) {
            for (size_t a = 0; a < count; a++) {
                to[a] += weight[i] * old->attribute[count * (size_t)corner[i] + a];
            }
        }
    }
}

// ---- texture coordinates

// uv at x (projected to the plane of the face) of the affine map of an old face. False where it has none or
// its shape does not allow it.
static bool uv_at(const transfer* t, int face, const double x[3], double uv[2]) {
    const int* v = t->old->triangle + 3 * (size_t)face;
    const int* u = t->old->uv_triangle + 3 * (size_t)face;
    const double* p[3];
    double n[3];
    for (int i = 0; i < 3; i++) {
        if (u[i] < 0) {
            return false;
        }
        p[i] = t->old->position + 3 * (size_t)v[i];
    }
    ruga_triangle_normal(p[0], p[1], p[2], n);
    double square = ruga_dot(n, n);
    uv[0] = uv[1] = 0;
    for (int i = 0; i < 3; i++) {
        double part[3];
        ruga_triangle_normal(x, p[(i + 1) % 3], p[(i + 2) % 3], part);
        double weight = ruga_dot(part, n) / square;
        if (!(weight > -furthest && weight < furthest)) {
            return false;
        }
        uv[0] += weight * t->old->uv[2 * (size_t)u[i]];
        uv[1] += weight * t->old->uv[2 * (size_t)u[i] + 1];
    }
    return true;
}

static double uv_distance(const double a[2], const double b[2]) {
    return hypot(a[0] - b[0], a[1] - b[1]);
}

// Largest stretch of an old face's edges from metres to uv.
static double uv_scale(const transfer* t, int face) {
    const int* v = t->old->triangle + 3 * (size_t)face;
    const int* u = t->old->uv_triangle + 3 * (size_t)face;
    double scale = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double length =
            ruga_distance(t->old->position + 3 * (size_t)v[i], t->old->position + 3 * (size_t)v[j]);
        double image = uv_distance(t->old->uv + 2 * (size_t)u[i], t->old->uv + 2 * (size_t)u[j]);
        scale = length > 0 ? fmax(scale, image / length) : scale;
    }
    return scale;
}

// The uv of one corner, by the rule at the file's head.
static bool choose_uv(const transfer* t, int f, int i, double uv[2]) {
    int v = t->mesh->triangle[3 * (size_t)f + (size_t)i];
    size_t corner = 3 * (size_t)f + (size_t)i;
    double predicted[2];
    if (!uv_at(t, t->centre.face[f], t->mesh->position + 3 * (size_t)v, predicted)) {
        return uv_at(t, t->corner.face[corner], t->corner.point + 3 * corner, uv);
    }
    double limit = agreement * t->edge * uv_scale(t, t->centre.face[f]);
    if (uv_at(t, t->vertex.face[v], t->vertex.point + 3 * (size_t)v, uv) &&
        uv_distance(uv, predicted) <= limit) {
        return true;
    }
    if (uv_at(t, t->corner.face[corner], t->mesh->position + 3 * (size_t)v, uv) &&
        uv_distance(uv, predicted) <= limit) {
        return true;
    }
    memcpy(uv, predicted, 2 * sizeof *uv);
    return true;
}

// Index of a vertex's uv: an equal one of the same vertex, or a new one.
static ruga_status index_of_uv(transfer* t, int v, const double uv[2], int* index) {
    ruga_mesh* mesh = t->mesh;
    for (int u = t->first[v]; u >= 0; u = t->next[u]) {
        if (mesh->uv[2 * (size_t)u] == uv[0] && mesh->uv[2 * (size_t)u + 1] == uv[1]) {
            *index = u;
            return RUGA_OK;
        }
    }
    RUGA_TRY(RUGA_RESERVE(mesh->uv, t->uv_capacity, 2 * ((size_t)mesh->uv_count + 1)));
    RUGA_TRY(RUGA_RESERVE(t->next, t->next_capacity, (size_t)mesh->uv_count + 1));
    *index = mesh->uv_count++;
    memcpy(mesh->uv + 2 * (size_t)*index, uv, 2 * sizeof *uv);
    t->next[*index] = t->first[v];
    t->first[v] = *index;
    return RUGA_OK;
}

static ruga_status transfer_uv(transfer* t) {
    ruga_mesh* mesh = t->mesh;
    RUGA_TRY(RUGA_NEW(mesh->uv_triangle, 3 * (size_t)mesh->triangle_count));
    RUGA_TRY(RUGA_NEW(t->first, mesh->vertex_count));
    for (int v = 0; v < mesh->vertex_count; v++) {
        t->first[v] = -1;
    }
    for (int c = 0; c < 3 * mesh->triangle_count; c++) {
        double uv[2];
        mesh->uv_triangle[c] = -1;
        if (choose_uv(t, c / 3, c % 3, uv)) {
            RUGA_TRY(index_of_uv(t, mesh->triangle[c], uv, &mesh->uv_triangle[c]));
        }
    }
    return RUGA_OK;
}

// Centroids [F][3] and corners moved towards them [3 F][3].
static void place_queries(const ruga_mesh* mesh, double* centre, double* corner) {
    for (int f = 0; f < mesh->triangle_count; f++) {
        double* c = centre + 3 * (size_t)f;
        memset(c, 0, 3 * sizeof *c);
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(1.0 / 3, mesh->position + 3 * (size_t)mesh->triangle[3 * f + i], c);
        }
        for (int i = 0; i < 3; i++) {
            double* q = corner + 9 * (size_t)f + 3 * (size_t)i;
            memset(q, 0, 3 * sizeof *q);
            ruga_add_scaled(1 - towards_centre, mesh->position + 3 * (size_t)mesh->triangle[3 * f + i], q);
            ruga_add_scaled(towards_centre, c, q);
        }
    }
}

static ruga_status find_queries(transfer* t, const ruga_cgal_locator* locator) {
    double* centre = NULL;
    double* corner = NULL;
    size_t faces = (size_t)t->mesh->triangle_count;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(centre, 3 * faces));
    RUGA_TRY_DONE(RUGA_NEW(corner, 9 * faces));
    place_queries(t->mesh, centre, corner);
    RUGA_TRY_DONE(nearest_find(locator, t->mesh->triangle_count, centre, &t->centre));
    RUGA_TRY_DONE(nearest_find(locator, 3 * t->mesh->triangle_count, corner, &t->corner));
done:
    ruga_release(centre);
    ruga_release(corner);
    return status;
}

ruga_status ruga_mesh_transfer(const ruga_mesh* old, double edge, ruga_mesh* mesh) {
    transfer t = {.old = old, .mesh = mesh, .edge = edge};
    ruga_cgal_locator* locator = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(ruga_cgal_locator_create(old->position, old->triangle_count, old->triangle, &locator));
    RUGA_TRY_DONE(nearest_find(locator, mesh->vertex_count, mesh->position, &t.vertex));
    RUGA_TRY_DONE(RUGA_NEW(mesh->source_vertex, mesh->vertex_count));
    put_on_old_vertices(&t);
    RUGA_TRY_DONE(ruga_mesh_allocate_attributes(old, mesh));
    if (old->attribute_count > 0) {
        transfer_attributes(&t);
    }
    if (old->uv && old->uv_triangle) {
        RUGA_TRY_DONE(find_queries(&t, locator));
        RUGA_TRY_DONE(transfer_uv(&t));
    }
done:
    ruga_cgal_locator_destroy(&locator);
    nearest_clear(&t.vertex);
    nearest_clear(&t.corner);
    nearest_clear(&t.centre);
    ruga_release(t.first);
    ruga_release(t.next);
    return status;
}

ruga_status ruga_mesh_locate(const ruga_mesh* mesh, int count, const double* point, int (*corner)[3],
                             double (*weight)[3]) {
    nearest found = {0};
    ruga_cgal_locator* locator = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(ruga_cgal_locator_create(mesh->position, mesh->triangle_count, mesh->triangle, &locator));
    RUGA_TRY_DONE(nearest_find(locator, count, point, &found));
    for (size_t k = 0; k < (size_t)count; k++) {
        memcpy(corner[k], mesh->triangle + 3 * (size_t)found.face[k], sizeof corner[k]);
        weigh_corners(mesh, found.face[k], found.point + 3 * k, weight[k]);
    }
done:
    ruga_cgal_locator_destroy(&locator);
    nearest_clear(&found);
    return status;
}
