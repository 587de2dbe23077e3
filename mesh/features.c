// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Lines to keep when remeshing to the edge length L. A boundary, and a border between groups, is always one.
// A sharp edge is one where it matters at the scale of L:
// - the connected sharp edges together are at least 4 L long, so that the folds of an ear do not become a
//   thicket of lines that no triangle of size L fits into;
// - on both sides lies a patch at least L / 2 wide (width = 2 area / perimeter): a narrower one, such as the
//   welt of a pillow, would only be filled with slivers, so its sharp borders are given up;
// - where it bounds no patch, its connected set has on average 3 L for each corner.
// A vertex on a line is a corner where a line ends, where lines meet, and where the line, seen from L / 2
// away on both sides, turns by more than 45 degrees.
#include "mesh/features.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <float.h>
#include <string.h>

static const double sharp_cosine = 0.64278760968653936; // cos 50 degrees, between the normals
static const double bend_cosine = 0.70710678118654757;  // cos 45 degrees
static const double shortest_line = 4;                  // edges
static const double dangling_span = 3;                  // edges, for each corner
static const double narrowest_patch = 0.5;              // edges

// firm: boundary or group border
enum line { LINE_NONE, LINE_SHARP, LINE_FIRM };

typedef struct finder {
    const ruga_mesh* mesh;
    const ruga_connectivity* edges;
    double edge;
    ruga_keep keep;
    ruga_features* features;
    unsigned char* line; // [E]
    double* length;      // [E]
    double* border;      // [patches] total length of lines around a patch
    double* area;        // [patches]
    int* queue;          // [F]
    int* set;            // [V] connected sharp edges
    double* set_length;  // [V]
    double* straight;    // [V]
} finder;

static const double* point(const finder* x, int v) {
    return x->mesh->position + 3 * (size_t)v;
}

static void classify_edges(finder* x) {
    const ruga_mesh* mesh = x->mesh;
    for (int e = 0; e < x->edges->edge_count; e++) {
        const int* v = x->edges->edge[e];
        const int* f = x->edges->edge_triangle[e];
        x->length[e] = ruga_distance(point(x, v[0]), point(x, v[1]));
        x->line[e] = LINE_NONE;
        if (f[0] < 0 || f[1] < 0 || (mesh->face_group && mesh->face_group[f[0]] != mesh->face_group[f[1]])) {
            x->line[e] = LINE_FIRM;
            continue;
        }
        double m[3], n[3];
        ruga_mesh_triangle_normal(x->mesh, f[0], m);
        ruga_mesh_triangle_normal(x->mesh, f[1], n);
        if (ruga_normalize(m) > 0 && ruga_normalize(n) > 0 && x->keep > RUGA_KEEP_FIRM &&
            ruga_dot(m, n) < sharp_cosine) {
            x->line[e] = LINE_SHARP;
        }
    }
}

static int find_root(int* parent, int i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

// Whether a line edge counts when lines are put together to sets: all of them, or (once there are patches)
// those with the same patch on both sides, which bound nothing.
static bool counts(const finder* x, int e, bool dangling) {
    const int* f = x->edges->edge_triangle[e];
    return x->line[e] != LINE_NONE &&
           (!dangling || (f[0] >= 0 && f[1] >= 0 && x->features->patch[f[0]] == x->features->patch[f[1]]));
}

// Connected sets of lines, and the length of each at its root.
static void gather_sets(finder* x, bool dangling) {
    for (int v = 0; v < x->mesh->vertex_count; v++) {
        x->set[v] = v;
        x->set_length[v] = 0;
    }
    for (int e = 0; e < x->edges->edge_count; e++) {
        if (counts(x, e, dangling)) {
            int a = find_root(x->set, x->edges->edge[e][0]);
            int b = find_root(x->set, x->edges->edge[e][1]);
            x->set[a > b ? a : b] = a > b ? b : a;
        }
    }
    for (int e = 0; e < x->edges->edge_count; e++) {
        if (counts(x, e, dangling)) {
            x->set_length[find_root(x->set, x->edges->edge[e][0])] += x->length[e];
        }
    }
}

// Sharp edges whose connected set is too short are given up. All kinds of line connect, so that a sharp line
// may end on a boundary. Dangling sets must be longer the more corners they have.
static void drop_short_lines(finder* x, bool dangling) {
    gather_sets(x, dangling);
    for (int v = 0; dangling && v < x->mesh->vertex_count; v++) {
        if (x->features->corner[v]) {
            x->set_length[find_root(x->set, v)] -= dangling_span * x->edge;
        }
    }
    double least = dangling ? 0 : shortest_line * x->edge;
    for (int e = 0; e < x->edges->edge_count; e++) {
        if (x->line[e] == LINE_SHARP && counts(x, e, dangling) &&
            (x->set_length[find_root(x->set, x->edges->edge[e][0])] < least ||
             (dangling && x->keep < RUGA_KEEP_WIDE))) {
            x->line[e] = LINE_NONE;
        }
    }
}

static void flood_patch(finder* x, int first, int number) {
    int* patch = x->features->patch;
    int reached = 1;
    x->queue[0] = first;
    patch[first] = number;
    for (int done = 0; done < reached; done++) {
        for (int i = 0; i < 3; i++) {
            int e = x->edges->triangle_edge[x->queue[done]][i];
            const int* f = x->edges->edge_triangle[e];
            int other = f[0] == x->queue[done] ? f[1] : f[0];
            if (x->line[e] == LINE_NONE && patch[other] < 0) {
                patch[other] = number;
                x->queue[reached++] = other;
            }
        }
    }
}

static void number_patches(finder* x) {
    ruga_features* features = x->features;
    features->patch_count = 0;
    memset(features->patch, -1, (size_t)x->mesh->triangle_count * sizeof *features->patch);
    for (int f = 0; f < x->mesh->triangle_count; f++) {
        if (features->patch[f] < 0) {
            flood_patch(x, f, features->patch_count++);
        }
    }
}

static void measure_patches(finder* x) {
    memset(x->area, 0, (size_t)x->features->patch_count * sizeof *x->area);
    memset(x->border, 0, (size_t)x->features->patch_count * sizeof *x->border);
    for (int f = 0; f < x->mesh->triangle_count; f++) {
        x->area[x->features->patch[f]] += ruga_mesh_triangle_area(x->mesh, f);
    }
    for (int e = 0; e < x->edges->edge_count; e++) {
        for (int i = 0; i < 2 && x->line[e] != LINE_NONE; i++) {
            int f = x->edges->edge_triangle[e][i];
            if (f >= 0) {
                x->border[x->features->patch[f]] += x->length[e];
            }
        }
    }
}

// Gives up the sharp borders of patches that are too narrow; true where there were any. Patches grow by it,
// so it is repeated, at most as often as there are patches.
static bool drop_narrow_patches(finder* x) {
    bool dropped = false;
    number_patches(x);
    measure_patches(x);
    for (int e = 0; e < x->edges->edge_count; e++) {
        for (int i = 0; i < 2 && x->line[e] == LINE_SHARP; i++) {
            int p = x->features->patch[x->edges->edge_triangle[e][i]];
            if (2 * x->area[p] < narrowest_patch * x->edge * x->border[p]) {
                x->line[e] = LINE_NONE;
                dropped = true;
            }
        }
    }
    return dropped;
}

// ---- corners

// The next vertex along the line from v, not back over edge *along; -1 at an end or a fork.
static int step_along(const finder* x, int v, int* along) {
    int found = -1;
    int edge = -1;
    int lines = 0;
    for (int k = x->edges->neighbour_start[v]; k < x->edges->neighbour_start[v + 1]; k++) {
        int e = x->edges->neighbour_edge[k];
        if (x->line[e] != LINE_NONE) {
            lines++;
            if (e != *along) {
                found = x->edges->neighbour[k];
                edge = e;
            }
        }
    }
    *along = edge;
    return lines == 2 ? found : -1;
}

// Unit vector from v to the line's vertex about L / 2 away, starting over edge `along` to `next`.
static void look_along(const finder* x, int v, int next, int along, double direction[3]) {
    double way = x->length[along];
    int at = next;
    for (int steps = 0; way < 0.5 * x->edge && steps < 1000; steps++) {
        int further = step_along(x, at, &along);
        if (further < 0 || further == v) {
            break;
        }
        at = further;
        way += x->length[along];
    }
    ruga_subtract(point(x, at), point(x, v), direction);
    (void)ruga_normalize(direction);
}

// How far the line turns at v: the cosine, 1 = straight; -2 where v is an end or a fork, 2 where no line is.
static double straightness(const finder* x, int v) {
    double direction[2][3];
    int lines = 0;
    for (int k = x->edges->neighbour_start[v]; k < x->edges->neighbour_start[v + 1]; k++) {
        int e = x->edges->neighbour_edge[k];
        if (x->line[e] != LINE_NONE) {
            if (lines < 2) {
                look_along(x, v, x->edges->neighbour[k], e, direction[lines]);
            }
            lines++;
        }
    }
    return lines == 0 ? 2 : lines == 2 ? -ruga_dot(direction[0], direction[1]) : -2;
}

// A bend spread over several vertices has one corner: the sharpest of those within L / 2 along the line, the
// lowest index where two are alike.
static bool sharpest_nearby(const finder* x, const double* straight, int v) {
    for (int k = x->edges->neighbour_start[v]; k < x->edges->neighbour_start[v + 1]; k++) {
        int along = x->edges->neighbour_edge[k];
        int at = x->edges->neighbour[k];
        double way = x->line[along] == LINE_NONE ? DBL_MAX : x->length[along];
        while (way < 0.5 * x->edge && at >= 0 && at != v) {
            if (straight[at] < straight[v] || (straight[at] == straight[v] && at < v)) {
                return false;
            }
            at = step_along(x, at, &along);
            way += along >= 0 ? x->length[along] : 0;
        }
    }
    return true;
}

static void find_corners(finder* x) {
    double* straight = x->straight;
    for (int v = 0; v < x->mesh->vertex_count; v++) {
        straight[v] = straightness(x, v);
    }
    for (int v = 0; v < x->mesh->vertex_count; v++) {
        x->features->corner[v] =
            straight[v] == -2 || (straight[v] < bend_cosine && sharpest_nearby(x, straight, v));
    }
}

static ruga_status list_edges(finder* x) {
    int count = 0;
    for (int e = 0; e < x->edges->edge_count; e++) {
        count += x->line[e] != LINE_NONE;
    }
    RUGA_TRY(RUGA_NEW(x->features->edge, count));
    for (int e = 0; e < x->edges->edge_count; e++) {
        if (x->line[e] != LINE_NONE) {
            memcpy(x->features->edge[x->features->edge_count++], x->edges->edge[e], 2 * sizeof(int));
        }
    }
    return RUGA_OK;
}

static ruga_status find(finder* x) {
    int vertices = x->mesh->vertex_count;
    int faces = x->mesh->triangle_count;
    RUGA_TRY(RUGA_NEW(x->line, x->edges->edge_count));
    RUGA_TRY(RUGA_NEW(x->length, x->edges->edge_count));
    RUGA_TRY(RUGA_NEW(x->border, faces));
    RUGA_TRY(RUGA_NEW(x->area, faces));
    RUGA_TRY(RUGA_NEW(x->queue, faces));
    RUGA_TRY(RUGA_NEW(x->set, vertices));
    RUGA_TRY(RUGA_NEW(x->set_length, vertices));
    RUGA_TRY(RUGA_NEW(x->straight, vertices));
    RUGA_TRY(RUGA_NEW_ZERO(x->features->corner, vertices));
    RUGA_TRY(RUGA_NEW(x->features->patch, faces));
    classify_edges(x);
    drop_short_lines(x, false);
    while (x->keep < RUGA_KEEP_ALL && drop_narrow_patches(x)) {
    }
    number_patches(x);
    find_corners(x);
    drop_short_lines(x, true);
    drop_short_lines(x, false);
    number_patches(x);
    find_corners(x);
    return list_edges(x);
}

ruga_status ruga_features_find(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double edge,
                               ruga_keep keep, ruga_features* features) {
    *features = (ruga_features){0};
    finder x = {.mesh = mesh, .edges = connectivity, .edge = edge, .keep = keep, .features = features};
    ruga_status status = find(&x);
    ruga_release(x.line);
    ruga_release(x.length);
    ruga_release(x.border);
    ruga_release(x.area);
    ruga_release(x.queue);
    ruga_release(x.set);
    ruga_release(x.set_length);
    ruga_release(x.straight);
    if (status != RUGA_OK) {
        ruga_features_clear(features);
    }
    return status;
}

void ruga_features_clear(ruga_features* features) {
    ruga_release(features->edge);
    ruga_release(features->corner);
    ruga_release(features->patch);
    *features = (ruga_features){0};
}
