// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The mesh doctor's geometry: faces that cannot be measured, thin faces, polygons that are not flat, faces
// that cross, components inside out.
//
// Around a point, w = (1 / 4 pi) sum of the solid angles of a closed component's faces (van Oosterom and
// Strackee 1983) is the number of times that the component encloses it. A component with negative volume is a
// cavity where the others enclose it at least once, and inside out where they do not.
#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/crossing.h"
#include "mesh/examination.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A face is flat when its height is below this part of its longest edge (rounding of the area is 1e-16), a
// sliver when its smallest angle is below 1 degree, a polygon is not flat when a corner stands off its mean
// plane by more than 1 % of the square root of its area.
static const double flat_height = 1e-12;
static const double sliver_angle = RUGA_PI / 180;
static const double polygon_offset = 0.01;

static const int nobody[2] = {-1, -1};

static void face_points(const ruga_examination* x, int face, const double* point[3]) {
    for (int i = 0; i < 3; i++) {
        point[i] = ruga_examined_point(x, ruga_examined_face(x, face)[i]);
    }
}

static bool point_is_finite(const double* p) {
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

// ---- faces

// Longest edge, smallest corner angle and twice the area.
static void measure_face(const double* const p[3], double* longest, double* smallest_angle, double* area2) {
    double n[3];
    ruga_triangle_normal(p[0], p[1], p[2], n);
    *area2 = ruga_norm(n);
    *longest = 0;
    *smallest_angle = RUGA_PI;
    for (int i = 0; i < 3; i++) {
        double u[3], v[3];
        ruga_subtract(p[(i + 1) % 3], p[i], u);
        ruga_subtract(p[(i + 2) % 3], p[i], v);
        *longest = fmax(*longest, ruga_norm(u));
        *smallest_angle = fmin(*smallest_angle, atan2(*area2, ruga_dot(u, v)));
    }
}

static ruga_status examine_face(ruga_examination* x, int f) {
    const int* v = ruga_examined_face(x, f);
    const int face[2] = {f, -1};
    const double* p[3];
    face_points(x, f, p);
    x->not_finite[f] = !point_is_finite(p[0]) || !point_is_finite(p[1]) || !point_is_finite(p[2]);
    x->collapsed[f] = v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
    x->flat[f] = x->not_finite[f] || x->collapsed[f];
    if (x->collapsed[f]) {
        return ruga_examination_add(x, RUGA_DEFECT_DEGENERATE_FACE, nobody, face);
    }
    if (x->not_finite[f]) {
        return RUGA_OK;
    }
    double longest, angle, area2;
    measure_face(p, &longest, &angle, &area2);
    x->report->angle_min = fmin(x->report->angle_min, angle);
    if (area2 <= flat_height * longest * longest) {
        x->flat[f] = true;
        return ruga_examination_add(x, RUGA_DEFECT_DEGENERATE_FACE, nobody, face);
    }
    return angle < sliver_angle ? ruga_examination_add(x, RUGA_DEFECT_SLIVER, nobody, face) : RUGA_OK;
}

ruga_status ruga_examine_faces(ruga_examination* x) {
    for (int v = 0; v < x->mesh->vertex_count; v++) {
        if (!point_is_finite(ruga_examined_point(x, v))) {
            RUGA_TRY(ruga_examination_add(x, RUGA_DEFECT_NAN, (const int[2]){v, -1}, nobody));
        }
    }
    x->report->angle_min = x->mesh->triangle_count > 0 ? RUGA_PI : 0;
    for (int f = 0; f < x->mesh->triangle_count; f++) {
        RUGA_TRY(examine_face(x, f));
    }
    return RUGA_OK;
}

// ---- crossing

static bool share_a_corner(const ruga_examination* x, int a, int b) {
    const int* s = ruga_examined_face(x, a);
    const int* t = ruga_examined_face(x, b);
    for (int i = 0; i < 3; i++) {
        if (s[i] == t[0] || s[i] == t[1] || s[i] == t[2]) {
            return true;
        }
    }
    return false;
}

// Adds the pairs that have a common corner, or those that have none.
static ruga_status add_crossings(ruga_examination* x, const ruga_crossings* found, bool neighbours) {
    for (int i = 0; i < found->count; i++) {
        const int* face = found->pair[i];
        if (share_a_corner(x, face[0], face[1]) != neighbours) {
            continue;
        }
        bool same = x->component[ruga_examined_face(x, face[0])[0]] ==
                    x->component[ruga_examined_face(x, face[1])[0]];
        RUGA_TRY(ruga_examination_add(x, same ? RUGA_DEFECT_SELF_INTERSECTION : RUGA_DEFECT_OVERLAP, nobody,
                                      face));
    }
    return RUGA_OK;
}

// Where faces with a common corner cross, an edge of one goes through the other, and the face behind that
// edge crosses too: what is counted is pairs without a common corner, as others count, and neighbours only
// where there are no such pairs (open ends, faces folded flat onto one another).
static ruga_status examine_crossings(ruga_examination* x) {
    ruga_crossings found;
    ruga_status status = ruga_mesh_crossings(x->mesh, x->flat, &found);
    if (status == RUGA_OK) {
        status = add_crossings(x, &found, false);
    }
    if (status == RUGA_OK && x->report->count[RUGA_DEFECT_SELF_INTERSECTION] == 0) {
        status = add_crossings(x, &found, true);
    }
    ruga_crossings_clear(&found);
    return status;
}

// ---- components inside out

typedef struct solids {
    int* start;         // [C + 1] into face
    int* face;          // faces by component
    double* volume;     // [C] of closed components, 0 for others
    double (*bound)[6]; // [C] min, max
} solids;

static void gather_faces(const ruga_examination* x, solids* s) {
    for (int f = 0; f < x->mesh->triangle_count; f++) {
        s->start[x->component[ruga_examined_face(x, f)[0]] + 1]++;
    }
    for (int c = 0; c < x->component_count; c++) {
        s->start[c + 1] += s->start[c];
    }
    for (int f = 0; f < x->mesh->triangle_count; f++) {
        s->face[s->start[x->component[ruga_examined_face(x, f)[0]]]++] = f;
    }
    for (int c = x->component_count; c > 0; c--) {
        s->start[c] = s->start[c - 1];
    }
    s->start[0] = 0;
}

static void measure_solid(const ruga_examination* x, solids* s, int c) {
    const double* origin = ruga_examined_point(x, ruga_examined_face(x, s->face[s->start[c]])[0]);
    memcpy(s->bound[c], origin, 3 * sizeof(double));
    memcpy(s->bound[c] + 3, origin, 3 * sizeof(double));
    for (int i = s->start[c]; i < s->start[c + 1]; i++) {
        const double* p[3];
        double n[3], from_origin[3];
        if (x->not_finite[s->face[i]]) {
            x->closed[c] = false;
            s->volume[c] = 0;
            return;
        }
        face_points(x, s->face[i], p);
        ruga_triangle_normal(p[0], p[1], p[2], n);
        ruga_subtract(p[0], origin, from_origin);
        s->volume[c] += ruga_dot(from_origin, n) / 6;
        for (int k = 0; k < 9; k++) {
            double* b = s->bound[c];
            b[k % 3] = fmin(b[k % 3], p[k / 3][k % 3]);
            b[3 + k % 3] = fmax(b[3 + k % 3], p[k / 3][k % 3]);
        }
    }
}

// tan(angle / 2) = det[a b c] / (|a||b||c| + (a.b)|c| + (b.c)|a| + (c.a)|b|), a, b, c from the eye
static double solid_angle(const double* const p[3], const double eye[3]) {
    double a[3], b[3], c[3], bc[3];
    ruga_subtract(p[0], eye, a);
    ruga_subtract(p[1], eye, b);
    ruga_subtract(p[2], eye, c);
    ruga_cross(b, c, bc);
    double la = ruga_norm(a);
    double lb = ruga_norm(b);
    double lc = ruga_norm(c);
    double below = la * lb * lc + ruga_dot(a, b) * lc + ruga_dot(b, c) * la + ruga_dot(c, a) * lb;
    return 2 * atan2(ruga_dot(a, bc), below);
}

// How often the other closed components enclose a point of component c.
static int enclosures(const ruga_examination* x, const solids* s, int c) {
    const double* eye = ruga_examined_point(x, ruga_examined_face(x, s->face[s->start[c]])[0]);
    double sum = 0;
    for (int d = 0; d < x->component_count; d++) {
        const double* b = s->bound[d];
        bool inside = x->closed[d] && d != c;
        for (int k = 0; k < 3; k++) {
            inside = inside && eye[k] > b[k] && eye[k] < b[3 + k];
        }
        for (int i = s->start[d]; inside && i < s->start[d + 1]; i++) {
            const double* p[3];
            face_points(x, s->face[i], p);
            sum += solid_angle(p, eye);
        }
    }
    return (int)lround(sum / (4 * RUGA_PI));
}

static ruga_status examine_solids(ruga_examination* x) {
    solids s = {0};
    size_t components = (size_t)x->component_count;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(s.start, components + 1));
    RUGA_TRY_DONE(RUGA_NEW(s.face, x->mesh->triangle_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(s.volume, components));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(s.bound, components));
    gather_faces(x, &s);
    for (int c = 0; c < x->component_count; c++) {
        measure_solid(x, &s, c);
    }
    for (int c = 0; c < x->component_count; c++) {
        if (x->closed[c] && s.volume[c] < 0 && enclosures(x, &s, c) < 1) {
            const int face[2] = {s.face[s.start[c]], -1};
            RUGA_TRY_DONE(ruga_examination_add(x, RUGA_DEFECT_INSIDE_OUT, nobody, face));
        }
    }
done:
    ruga_release(s.start);
    ruga_release(s.face);
    ruga_release(s.volume);
    ruga_release(s.bound);
    return status;
}

// ---- polygons

static int compare_ints(const void* first, const void* second) {
    const int* a = first;
    const int* b = second;
    return a[0] != b[0] ? (a[0] > b[0]) - (a[0] < b[0]) : (a[1] > b[1]) - (a[1] < b[1]);
}

// Faces [count] of one polygon: its corners against the plane through their centre, normal to its vector
// area.
static bool polygon_is_flat(const ruga_examination* x, int count, const int (*member)[2]) {
    double normal[3] = {0};
    double centre[3] = {0};
    for (int i = 0; i < count; i++) {
        const double* p[3];
        double n[3];
        face_points(x, member[i][1], p);
        ruga_triangle_normal(p[0], p[1], p[2], n);
        ruga_add_scaled(1, n, normal);
        for (int k = 0; k < 3; k++) {
            ruga_add_scaled(1.0 / (3.0 * count), p[k], centre);
        }
    }
    double size = sqrt(0.5 * ruga_normalize(normal));
    for (int i = 0; i < 3 * count; i++) {
        const double* p[3];
        double d[3];
        face_points(x, member[i / 3][1], p);
        ruga_subtract(p[i % 3], centre, d);
        if (fabs(ruga_dot(d, normal)) > polygon_offset * size) {
            return false; // NaN compares false: a polygon that is not finite is another defect
        }
    }
    return true;
}

static ruga_status examine_polygons(ruga_examination* x) {
    int faces = x->mesh->triangle_count;
    if (!x->mesh->polygon || faces == 0) {
        return RUGA_OK;
    }
    int(*member)[2] = NULL; // polygon, face
    RUGA_TRY(RUGA_NEW(member, faces));
    for (int f = 0; f < faces; f++) {
        member[f][0] = x->mesh->polygon[f];
        member[f][1] = f;
    }
    qsort(member, (size_t)faces, sizeof *member, compare_ints);
    ruga_status status = RUGA_OK;
    for (int i = 0, end; i < faces && status == RUGA_OK; i = end) {
        for (end = i + 1; end < faces && member[end][0] == member[i][0]; end++) {
        }
        if (end - i > 1 && !polygon_is_flat(x, end - i, (const int(*)[2])(member + i))) {
            const int face[2] = {member[i][1], -1};
            status = ruga_examination_add(x, RUGA_DEFECT_NON_PLANAR_POLYGON, nobody, face);
        }
    }
    ruga_release(member);
    return status;
}

ruga_status ruga_examine_shape(ruga_examination* x) {
    if (x->mesh->triangle_count == 0) {
        return RUGA_OK;
    }
    RUGA_TRY(examine_solids(x));
    RUGA_TRY(examine_crossings(x));
    return examine_polygons(x);
}
