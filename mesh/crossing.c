// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Triangles that cross, after Guigue and Devillers, "Fast and robust triangle-triangle overlap test using
// orientation predicates" (2003), with exact predicates and open intervals.
//
// Let s_i be the sides of A's corners on B's plane. Where A has corners strictly on both sides of B's plane,
// and B of A's, both meet the planes' common line in an interval. Corner p alone on its side, the others q
// and r, counter-clockwise seen from p's side: the interval runs between the lines pq and pr, and one
// orientation compares an end of A's with an end of B's. With < in place of <= the intervals must share a
// length, so that what neighbours share (a corner or an edge) counts as little as any other touching.
#include "mesh/crossing.h"

#include "core/memory.h"
#include "mesh/cgal_shim.h"

#include <stdlib.h>
#include <string.h>

// Exact, and 0 at once where a corner occurs twice: neighbours are most of all pairs, and a zero is what the
// exact predicate takes longest to find.
static int orientation(const double* a, const double* b, const double* c, const double* d) {
    bool repeated = a == b || a == c || a == d || b == c || b == d || c == d;
    return repeated ? 0 : ruga_cgal_orientation(a, b, c, d);
}

// Sides of A's corners on B's plane; returns whether both strict sides occur.
static bool straddles(const double* const a[3], const double* const b[3], int side[3]) {
    bool above = false;
    bool below = false;
    for (int i = 0; i < 3; i++) {
        side[i] = orientation(b[0], b[1], b[2], a[i]);
        above = above || side[i] > 0;
        below = below || side[i] < 0;
    }
    return above && below;
}

// Turns A's corners (orientation kept) so that the first is alone on its strict side; returns that side.
static int turn_to_lone_corner(const double* const a[3], const int side[3], const double* turned[3]) {
    int sum = side[0] + side[1] + side[2];
    // Signs (+,+,-), (+,-,-) or (+,0,-): the lone sign is the one against the sum, or either where it is 0.
    int lone = sum > 0 ? -1 : 1;
    int first = side[0] == lone ? 0 : side[1] == lone ? 1 : 2;
    for (int i = 0; i < 3; i++) {
        turned[i] = a[(first + i) % 3];
    }
    return lone;
}

static void swap_last_two(const double* corner[3]) {
    const double* other = corner[1];
    corner[1] = corner[2];
    corner[2] = other;
}

// Orientation of three points in the plane without axis `drop`, exactly: a tetrahedron with an apex above.
static int orientation_in_plane(const double* a, const double* b, const double* c, int drop) {
    const double* from[3] = {a, b, c};
    double flat[3][3];
    for (int i = 0; i < 3; i++) {
        flat[i][0] = from[i][(drop + 1) % 3];
        flat[i][1] = from[i][(drop + 2) % 3];
        flat[i][2] = 0;
    }
    const double apex[3] = {0, 0, 1};
    return ruga_cgal_orientation(flat[0], flat[1], flat[2], apex);
}

// Whether one of A's edges has all of B on its outer side or on it; `turn` is A's orientation.
static bool edge_separates(const double* const a[3], const double* const b[3], int turn, int drop) {
    for (int i = 0; i < 3; i++) {
        bool outside = true;
        for (int k = 0; k < 3 && outside; k++) {
            outside = orientation_in_plane(a[i], a[(i + 1) % 3], b[k], drop) * turn <= 0;
        }
        if (outside) {
            return true;
        }
    }
    return false;
}

// Coplanar triangles: their interiors meet unless an edge separates them.
static bool coplanar_overlap(const double* const a[3], const double* const b[3]) {
    for (int drop = 0; drop < 3; drop++) {
        int turn_a = orientation_in_plane(a[0], a[1], a[2], drop);
        int turn_b = orientation_in_plane(b[0], b[1], b[2], drop);
        if (turn_a != 0 && turn_b != 0) {
            return !edge_separates(a, b, turn_a, drop) && !edge_separates(b, a, turn_b, drop);
        }
    }
    return false; // a triangle without area
}

bool ruga_triangles_cross(const double* const a[3], const double* const b[3]) {
    int side_a[3];
    int side_b[3];
    if (!straddles(a, b, side_a)) {
        return side_a[0] == 0 && side_a[1] == 0 && side_a[2] == 0 && coplanar_overlap(a, b);
    }
    if (!straddles(b, a, side_b)) {
        return false;
    }
    const double* p[3];
    const double* q[3];
    int lone_a = turn_to_lone_corner(a, side_a, p);
    int lone_b = turn_to_lone_corner(b, side_b, q);
    // Both lone corners are brought to the positive side of the other triangle by reversing that triangle.
    if (lone_a < 0) {
        swap_last_two(q);
    }
    if (lone_b < 0) {
        swap_last_two(p);
    }
    return orientation(p[0], p[1], q[0], q[1]) < 0 && orientation(p[0], p[2], q[2], q[0]) < 0;
}

typedef struct search {
    const ruga_mesh* mesh;
    const int* face; // [boxes] face of each box
    ruga_crossings* crossings;
} search;

static void corners_of(const ruga_mesh* mesh, int face, const double* corner[3]) {
    for (int i = 0; i < 3; i++) {
        corner[i] = mesh->position + 3 * (size_t)mesh->triangle[3 * (size_t)face + (size_t)i];
    }
}

static bool same_corners(const ruga_mesh* mesh, int a, int b) {
    const int* s = mesh->triangle + 3 * (size_t)a;
    const int* t = mesh->triangle + 3 * (size_t)b;
    for (int i = 0; i < 3; i++) {
        if (s[i] != t[0] && s[i] != t[1] && s[i] != t[2]) {
            return false;
        }
    }
    return true;
}

static ruga_status add_if_crossing(int first, int second, void* context) {
    search* s = context;
    int a = s->face[first];
    int b = s->face[second];
    const double* corner_a[3];
    const double* corner_b[3];
    corners_of(s->mesh, a, corner_a);
    corners_of(s->mesh, b, corner_b);
    // The same three corners are a duplicate face, which is another defect.
    if (same_corners(s->mesh, a, b) || !ruga_triangles_cross(corner_a, corner_b)) {
        return RUGA_OK;
    }
    ruga_crossings* found = s->crossings;
    RUGA_TRY(RUGA_RESERVE(found->pair, found->capacity, (size_t)found->count + 1));
    found->pair[found->count][0] = a < b ? a : b;
    found->pair[found->count][1] = a < b ? b : a;
    found->count++;
    return RUGA_OK;
}

static int compare_pairs(const void* first, const void* second) {
    const int* a = first;
    const int* b = second;
    return a[0] != b[0] ? (a[0] < b[0] ? -1 : 1) : (a[1] > b[1]) - (a[1] < b[1]);
}

static int fill_boxes(const ruga_mesh* mesh, const bool* skip, double (*box)[6], int* face) {
    int count = 0;
    for (int f = 0; f < mesh->triangle_count; f++) {
        if (skip && skip[f]) {
            continue;
        }
        const double* corner[3];
        corners_of(mesh, f, corner);
        double* b = box[count];
        memcpy(b, corner[0], 3 * sizeof *b);
        memcpy(b + 3, corner[0], 3 * sizeof *b);
        for (int i = 3; i < 9; i++) {
            double x = corner[i / 3][i % 3];
            b[i % 3] = x < b[i % 3] ? x : b[i % 3];
            b[3 + i % 3] = x > b[3 + i % 3] ? x : b[3 + i % 3];
        }
        face[count++] = f;
    }
    return count;
}

ruga_status ruga_mesh_crossings(const ruga_mesh* mesh, const bool* skip, ruga_crossings* crossings) {
    *crossings = (ruga_crossings){0};
    double(*box)[6] = NULL;
    int* face = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(box, mesh->triangle_count));
    RUGA_TRY_DONE(RUGA_NEW(face, mesh->triangle_count));
    int count = fill_boxes(mesh, skip, box, face);
    search s = {mesh, face, crossings};
    RUGA_TRY_DONE(ruga_cgal_box_pairs(count, (const double(*)[6])box, add_if_crossing, &s));
    if (crossings->count > 1) {
        qsort(crossings->pair, (size_t)crossings->count, sizeof *crossings->pair, compare_pairs);
    }
done:
    ruga_release(box);
    ruga_release(face);
    if (status != RUGA_OK) {
        ruga_crossings_clear(crossings);
    }
    return status;
}

void ruga_crossings_clear(ruga_crossings* crossings) {
    ruga_release(crossings->pair);
    *crossings = (ruga_crossings){0};
}
