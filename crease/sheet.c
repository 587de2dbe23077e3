// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Changes come in sets that do not touch one another's faces, so that each set costs one pass over the mesh
// and one new connectivity.
//   move   v -> x:       uv and attributes at x from the face that x lay in
//   edge   (a, b) at m:  (a, b, c) -> (a, m, c), (m, b, c) on both sides
//   face   (a, b, c), m: (a, b, m), (b, c, m), (c, a, m)
// The first of the new faces keeps the number of the old one.
#include "crease/sheet.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

static const double ON_LINE = 1e-7;    // edges: how far from a straight firm line a point on it may be
static const double SHRINK = 0.5;      // a triangle's height over its longest edge may fall to this part ...
static const double SLENDER = 0.3;     // ... or to this value
static const double THINNEST = 0.01;   // height over longest edge of what a split edge may leave
static const double TURN_COSINE = 0.2; // between a triangle's normal before and after

const double* ruga_sheet_position(const ruga_sheet* sheet, int v) {
    return sheet->mesh.position + 3 * (size_t)v;
}

static void corners_of(const ruga_sheet* sheet, int f, const double* x[3]) {
    for (int i = 0; i < 3; i++) {
        x[i] = ruga_sheet_position(sheet, sheet->mesh.triangle[3 * (size_t)f + (size_t)i]);
    }
}

void ruga_sheet_clear(ruga_sheet* sheet) {
    ruga_mesh_clear(&sheet->mesh);
    ruga_connectivity_clear(&sheet->edges);
    ruga_release(sheet->pinned);
    ruga_release(sheet->firm);
    ruga_release(sheet->seam);
    *sheet = (ruga_sheet){0};
}

// ------------------------------------------------------------------------------- geometry

void ruga_sheet_face_normal(const ruga_sheet* sheet, int f, double n[3]) {
    const double* x[3];
    corners_of(sheet, f, x);
    ruga_triangle_normal(x[0], x[1], x[2], n);
    ruga_normalize(n);
}

void ruga_sheet_vertex_normal(const ruga_sheet* sheet, int v, double n[3]) {
    memset(n, 0, 3 * sizeof *n);
    for (int k = sheet->edges.incident_start[v]; k < sheet->edges.incident_start[v + 1]; k++) {
        const double* x[3];
        double own[3];
        corners_of(sheet, sheet->edges.incident[k], x);
        ruga_triangle_normal(x[0], x[1], x[2], own);
        ruga_add_scaled(1, own, n);
    }
    ruga_normalize(n);
}

double ruga_sheet_face_edge(const ruga_sheet* sheet, int f) {
    const double* x[3];
    corners_of(sheet, f, x);
    return (ruga_distance(x[0], x[1]) + ruga_distance(x[1], x[2]) + ruga_distance(x[2], x[0])) / 3;
}

void ruga_sheet_weights(const ruga_sheet* sheet, int f, const double x[3], double weight[3]) {
    const double* corner[3];
    double n[3];
    corners_of(sheet, f, corner);
    ruga_triangle_normal(corner[0], corner[1], corner[2], n);
    double square = ruga_dot(n, n);
    for (int i = 0; i < 2; i++) {
        double part[3];
        ruga_triangle_normal(x, corner[(i + 1) % 3], corner[(i + 2) % 3], part);
        weight[i] = ruga_dot(part, n) / square;
    }
    weight[2] = 1 - weight[0] - weight[1];
}

void ruga_sheet_point(const ruga_sheet* sheet, int f, const double weight[3], double x[3]) {
    const double* corner[3];
    corners_of(sheet, f, corner);
    memset(x, 0, 3 * sizeof *x);
    for (int i = 0; i < 3; i++) {
        ruga_add_scaled(weight[i], corner[i], x);
    }
}

// What is outside by a little (or by more, at a boundary) is brought to the face.
static void clip(double weight[3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        weight[i] = weight[i] > 0 ? weight[i] : 0;
        sum += weight[i];
    }
    for (int i = 0; i < 3; i++) {
        weight[i] = sum > 0 ? weight[i] / sum : 1.0 / 3;
    }
}

int ruga_sheet_locate(const ruga_sheet* sheet, int face, const double x[3], double weight[3]) {
    static const double inside = -1e-12;
    int best = face;
    double best_least = -INFINITY;
    // A walk that goes across the side with the most negative weight; the limit ends it where the surface is
    // too curved for the walk to settle.
    for (int step = 0, f = face; step < 200; step++) {
        double w[3];
        ruga_sheet_weights(sheet, f, x, w);
        int least = w[0] <= w[1] && w[0] <= w[2] ? 0 : w[1] <= w[2] ? 1 : 2;
        if (w[least] > best_least) {
            best_least = w[least];
            best = f;
        }
        const int* beside = sheet->edges.edge_triangle[sheet->edges.triangle_edge[f][(least + 1) % 3]];
        int next = beside[0] == f ? beside[1] : beside[0];
        if (w[least] >= inside || next < 0) {
            break;
        }
        f = next;
    }
    ruga_sheet_weights(sheet, best, x, weight);
    clip(weight);
    return best;
}

bool ruga_sheet_on_boundary(const ruga_sheet* sheet, int v) {
    const ruga_connectivity* c = &sheet->edges;
    for (int k = c->neighbour_start[v]; k < c->neighbour_start[v + 1]; k++) {
        const int* f = c->edge_triangle[c->neighbour_edge[k]];
        if (f[0] < 0 || f[1] < 0) {
            return true;
        }
    }
    return false;
}

// Height over longest edge, twice the area over its square.
static double slenderness(const double* const x[3], double n[3]) {
    double longest =
        fmax(ruga_distance(x[0], x[1]), fmax(ruga_distance(x[1], x[2]), ruga_distance(x[2], x[0])));
    ruga_triangle_normal(x[0], x[1], x[2], n);
    double area = ruga_normalize(n);
    return longest > 0 ? area / (longest * longest) : 0;
}

static bool triangles_allow(const ruga_sheet* sheet, int v, const double x[3]) {
    for (int k = sheet->edges.incident_start[v]; k < sheet->edges.incident_start[v + 1]; k++) {
        int f = sheet->edges.incident[k];
        const double* corner[3];
        double before[3], after[3];
        corners_of(sheet, f, corner);
        double old = slenderness(corner, before);
        for (int i = 0; i < 3; i++) {
            corner[i] = sheet->mesh.triangle[3 * (size_t)f + (size_t)i] == v ? x : corner[i];
        }
        double new = slenderness(corner, after);
        if (ruga_dot(before, after) < TURN_COSINE || new < fmin(SHRINK * old, SLENDER)) {
            return false;
        }
    }
    return true;
}

// Distance of x from the line through a and b, and its place along it.
static double off_line(const double a[3], const double b[3], const double x[3], double* place) {
    double d[3], e[3], c[3];
    ruga_subtract(b, a, d);
    ruga_subtract(x, a, e);
    ruga_cross(d, e, c);
    *place = ruga_dot(d, e) / ruga_dot(d, d);
    return ruga_norm(c) / ruga_norm(d);
}

bool ruga_sheet_can_move(const ruga_sheet* sheet, int v, const double x[3]) {
    const ruga_connectivity* c = &sheet->edges;
    int ends[2] = {-1, -1}, count = 0;
    for (int k = c->neighbour_start[v]; k < c->neighbour_start[v + 1]; k++) {
        if (sheet->firm[c->neighbour_edge[k]]) {
            if (count < 2) {
                ends[count] = c->neighbour[k];
            }
            count++;
        }
    }
    if (sheet->pinned[v] || sheet->seam[v] || (count != 0 && count != 2)) {
        return false;
    }
    if (count == 2) {
        const double *a = ruga_sheet_position(sheet, ends[0]), *b = ruga_sheet_position(sheet, ends[1]);
        double own, place, slack = ON_LINE * sheet->edge;
        if (off_line(a, b, ruga_sheet_position(sheet, v), &own) > slack ||
            off_line(a, b, x, &place) > slack || place <= 0 || place >= 1) {
            return false;
        }
    }
    return triangles_allow(sheet, v, x);
}

bool ruga_sheet_can_split(const ruga_sheet* sheet, int e, const double x[3]) {
    for (int k = 0; k < 4; k++) { // each end of the edge, on each side, gives way to x
        int f = sheet->edges.edge_triangle[e][k / 2], end = sheet->edges.edge[e][k % 2];
        if (f < 0) {
            continue;
        }
        const double* corner[3];
        double before[3], after[3];
        corners_of(sheet, f, corner);
        (void)slenderness(corner, before);
        for (int i = 0; i < 3; i++) {
            corner[i] = sheet->mesh.triangle[3 * (size_t)f + (size_t)i] == end ? x : corner[i];
        }
        if (slenderness(corner, after) < THINNEST || ruga_dot(before, after) < TURN_COSINE) {
            return false;
        }
    }
    return true;
}

// ------------------------------------------------------------------------------- firm edges

static int uv_of(const ruga_mesh* mesh, int f, int v) {
    const int* t = mesh->triangle + 3 * (size_t)f;
    return mesh->uv_triangle[3 * (size_t)f + (size_t)(t[0] == v ? 0 : t[1] == v ? 1 : 2)];
}

static bool is_seam(const ruga_mesh* mesh, const int edge[2], const int face[2]) {
    return uv_of(mesh, face[0], edge[0]) != uv_of(mesh, face[1], edge[0]) ||
           uv_of(mesh, face[0], edge[1]) != uv_of(mesh, face[1], edge[1]);
}

static ruga_status find_firm(ruga_sheet* sheet) {
    const ruga_mesh* mesh = &sheet->mesh;
    const ruga_connectivity* c = &sheet->edges;
    int* uv = NULL;
    ruga_release(sheet->firm);
    sheet->firm = NULL;
    ruga_release(sheet->seam);
    sheet->seam = NULL;
    RUGA_TRY(RUGA_NEW(sheet->firm, c->edge_count));
    RUGA_TRY(RUGA_NEW_ZERO(sheet->seam, mesh->vertex_count));
    RUGA_TRY(RUGA_NEW(uv, mesh->vertex_count));
    memset(uv, -1, (size_t)mesh->vertex_count * sizeof *uv);
    for (size_t i = 0; mesh->uv_triangle && i < 3 * (size_t)mesh->triangle_count; i++) {
        int v = mesh->triangle[i];
        sheet->seam[v] =
            sheet->seam[v] || mesh->uv_triangle[i] < 0 || (uv[v] >= 0 && uv[v] != mesh->uv_triangle[i]);
        uv[v] = mesh->uv_triangle[i];
    }
    ruga_release(uv);
    for (int e = 0; e < c->edge_count; e++) {
        const int* f = c->edge_triangle[e];
        sheet->firm[e] = f[0] < 0 || f[1] < 0 ||
                         (mesh->face_group && mesh->face_group[f[0]] != mesh->face_group[f[1]]) ||
                         (mesh->uv_triangle && is_seam(mesh, c->edge[e], f));
    }
    return RUGA_OK;
}

static ruga_status renew(ruga_sheet* sheet) {
    ruga_connectivity_clear(&sheet->edges);
    RUGA_TRY(ruga_connectivity_create(&sheet->mesh, &sheet->edges));
    return find_firm(sheet);
}

// Every vertex and face says where it came from, so that new ones can say that they are new.
static ruga_status number_sources(ruga_mesh* mesh) {
    if (!mesh->source_vertex) {
        RUGA_TRY(RUGA_NEW(mesh->source_vertex, mesh->vertex_count));
        for (int v = 0; v < mesh->vertex_count; v++) {
            mesh->source_vertex[v] = v;
        }
    }
    if (!mesh->polygon) {
        RUGA_TRY(RUGA_NEW(mesh->polygon, mesh->triangle_count));
        for (int f = 0; f < mesh->triangle_count; f++) {
            mesh->polygon[f] = f;
        }
    }
    return RUGA_OK;
}

ruga_status ruga_sheet_create(const ruga_mesh* mesh, ruga_sheet* sheet) {
    ruga_status status = RUGA_OK;
    *sheet = (ruga_sheet){0};
    RUGA_TRY_DONE(ruga_mesh_copy(mesh, &sheet->mesh));
    RUGA_TRY_DONE(number_sources(&sheet->mesh));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(sheet->pinned, mesh->vertex_count));
    RUGA_TRY_DONE(renew(sheet));
    sheet->edge = ruga_mesh_mean_edge(mesh);
done:
    if (status != RUGA_OK) {
        ruga_sheet_clear(sheet);
    }
    return status;
}

// ------------------------------------------------------------------------------- changes

static ruga_status grow_array(void* array, size_t count, size_t size) {
    void** pointer = array;
    if (!*pointer) {
        return RUGA_OK;
    }
    void* grown = ruga_reallocate(*pointer, count * size);
    if (!grown) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory for %zu vertices or faces of creases", count);
    }
    *pointer = grown;
    return RUGA_OK;
}

// Room for `vertices` and `faces` more, and as many uvs as they can need.
static ruga_status make_room(ruga_sheet* sheet, int vertices, int faces) {
    ruga_mesh* m = &sheet->mesh;
    size_t v = (size_t)m->vertex_count + (size_t)vertices, f = (size_t)m->triangle_count + (size_t)faces;
    RUGA_TRY(grow_array(&m->position, 3 * v, sizeof *m->position));
    RUGA_TRY(grow_array(&m->source_vertex, v, sizeof *m->source_vertex));
    RUGA_TRY(grow_array(&m->attribute, v * (size_t)m->attribute_count, sizeof *m->attribute));
    RUGA_TRY(grow_array(&sheet->pinned, v, sizeof *sheet->pinned));
    RUGA_TRY(grow_array(&m->triangle, 3 * f, sizeof *m->triangle));
    RUGA_TRY(grow_array(&m->uv_triangle, 3 * f, sizeof *m->uv_triangle));
    RUGA_TRY(grow_array(&m->uv, 2 * ((size_t)m->uv_count + 2 * (size_t)vertices), sizeof *m->uv));
    RUGA_TRY(grow_array(&m->face_group, f, sizeof *m->face_group));
    return grow_array(&m->polygon, f, sizeof *m->polygon);
}

static int add_vertex(ruga_sheet* sheet, const double x[3], bool pin) {
    int v = sheet->mesh.vertex_count++;
    memcpy(sheet->mesh.position + 3 * (size_t)v, x, 3 * sizeof *x);
    sheet->mesh.source_vertex[v] = -1;
    sheet->pinned[v] = pin;
    return v;
}

// attribute of `to` = weights times those of up to three vertices
static void blend_attributes(ruga_mesh* m, int to, int count, const int* from, const double* weight) {
    for (int a = 0; a < m->attribute_count; a++) {
        double sum = 0;
        for (int i = 0; i < count; i++) {
            sum += weight[i] * m->attribute[(size_t)from[i] * (size_t)m->attribute_count + (size_t)a];
        }
        m->attribute[(size_t)to * (size_t)m->attribute_count + (size_t)a] = sum;
    }
}

// A new uv, or -1 where a weighted one has none.
static int blend_uv(ruga_mesh* m, int count, const int* from, const double* weight) {
    double uv[2] = {0, 0};
    for (int i = 0; i < count; i++) {
        if (from[i] < 0) {
            return -1;
        }
        uv[0] += weight[i] * m->uv[2 * (size_t)from[i]];
        uv[1] += weight[i] * m->uv[2 * (size_t)from[i] + 1];
    }
    memcpy(m->uv + 2 * (size_t)m->uv_count, uv, sizeof uv);
    return m->uv_count++;
}

// A copy of face f with one corner (and its uv) replaced, as a new face.
static void copy_face(ruga_mesh* m, int f, int corner, int vertex, int uv) {
    size_t g = (size_t)m->triangle_count++, from = (size_t)f;
    memcpy(m->triangle + 3 * g, m->triangle + 3 * from, 3 * sizeof *m->triangle);
    m->triangle[3 * g + (size_t)corner] = vertex;
    if (m->uv_triangle) {
        memcpy(m->uv_triangle + 3 * g, m->uv_triangle + 3 * from, 3 * sizeof *m->uv_triangle);
        m->uv_triangle[3 * g + (size_t)corner] = uv;
    }
    if (m->face_group) {
        m->face_group[g] = m->face_group[from];
    }
    m->polygon[g] = m->polygon[from];
}

static void replace_corner(ruga_mesh* m, int f, int corner, int vertex, int uv) {
    m->triangle[3 * (size_t)f + (size_t)corner] = vertex;
    if (m->uv_triangle) {
        m->uv_triangle[3 * (size_t)f + (size_t)corner] = uv;
    }
}

static void move_vertex(ruga_sheet* sheet, const ruga_edit* edit) {
    ruga_mesh* m = &sheet->mesh;
    int v = edit->element;
    const int* corner = m->triangle + 3 * (size_t)edit->face;
    double* blended = m->attribute;
    if (blended) {
        blend_attributes(m, v, 3, corner, edit->weight);
    }
    memcpy(m->position + 3 * (size_t)v, edit->position, 3 * sizeof *m->position);
    if (!m->uv_triangle) {
        return;
    }
    // Not on a seam: one uv, which all its faces share.
    int f = sheet->edges.incident[sheet->edges.incident_start[v]];
    const int* t = m->triangle + 3 * (size_t)f;
    int own = m->uv_triangle[3 * (size_t)f + (size_t)(t[0] == v ? 0 : t[1] == v ? 1 : 2)];
    int uv = blend_uv(m, 3, m->uv_triangle + 3 * (size_t)edit->face, edit->weight);
    if (uv >= 0) {
        memcpy(m->uv + 2 * (size_t)own, m->uv + 2 * (size_t)uv, 2 * sizeof *m->uv);
        m->uv_count--;
    }
}

static void split_edge(ruga_sheet* sheet, ruga_edit* edit, bool pin) {
    ruga_mesh* m = &sheet->mesh;
    const int* ends = sheet->edges.edge[edit->element];
    const double weight[2] = {1 - edit->place, edit->place};
    int v = edit->vertex = add_vertex(sheet, edit->position, pin);
    int shared[3] = {-1, -1, -1}; // uvs of the first side's ends, and the new one between them
    int inner = -1;               // uv of a vertex off the edge, where both sides are one chart
    if (edit->face >= 0) {
        blend_attributes(m, v, 3, m->triangle + 3 * (size_t)edit->face, edit->weight);
        inner = m->uv_triangle ? blend_uv(m, 3, m->uv_triangle + 3 * (size_t)edit->face, edit->weight) : -1;
    } else {
        blend_attributes(m, v, 2, ends, weight);
    }
    for (int side = 0; side < 2; side++) {
        int f = sheet->edges.edge_triangle[edit->element][side], uv = inner;
        if (f < 0) {
            continue;
        }
        const int* t = m->triangle + 3 * (size_t)f;
        int a = t[0] == ends[0]   ? 0
                : t[1] == ends[0] ? 1
                                  : 2,
            b = t[0] == ends[1]   ? 0
                : t[1] == ends[1] ? 1
                                  : 2;
        if (m->uv_triangle && edit->face < 0) {
            const int* u = m->uv_triangle + 3 * (size_t)f;
            const int from[2] = {u[a], u[b]};
            bool same = shared[2] >= 0 && shared[0] == from[0] && shared[1] == from[1];
            uv = same ? shared[2] : blend_uv(m, 2, from, weight);
            shared[0] = from[0];
            shared[1] = from[1];
            shared[2] = uv;
        }
        copy_face(m, f, a, v, uv);
        replace_corner(m, f, b, v, uv);
    }
}

static void split_face(ruga_sheet* sheet, ruga_edit* edit, bool pin) {
    ruga_mesh* m = &sheet->mesh;
    int f = edit->element, uv = -1;
    int v = edit->vertex = add_vertex(sheet, edit->position, pin);
    blend_attributes(m, v, 3, m->triangle + 3 * (size_t)f, edit->weight);
    if (m->uv_triangle) {
        uv = blend_uv(m, 3, m->uv_triangle + 3 * (size_t)f, edit->weight);
    }
    copy_face(m, f, 0, v, uv);
    copy_face(m, f, 1, v, uv);
    replace_corner(m, f, 2, v, uv);
}

ruga_status ruga_sheet_apply(ruga_sheet* sheet, int count, ruga_edit* edit, bool pin) {
    RUGA_TRY(make_room(sheet, count, 2 * count));
    for (int i = 0; i < count; i++) {
        switch (edit[i].kind) {
        case RUGA_EDIT_MOVE:
            move_vertex(sheet, &edit[i]);
            edit[i].vertex = edit[i].element;
            sheet->pinned[edit[i].element] = sheet->pinned[edit[i].element] || pin;
            break;
        case RUGA_EDIT_EDGE:
            split_edge(sheet, &edit[i], pin);
            break;
        case RUGA_EDIT_FACE:
            split_face(sheet, &edit[i], pin);
            break;
        }
    }
    return renew(sheet);
}
