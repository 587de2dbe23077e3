// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Shapes from rows of vertices. Between two rows a strip of triangles is laid by going along both at once and
// always over that side whose middle comes first: between rows shifted by half an edge this gives equilateral
// triangles, between rings of different counts the Delaunay strip. Row r of an equilateral grid is shifted
// for odd r and has half an edge at both ends, so that borders are straight.
//   sheet   edges along X: X / L; rows: Y / (L sqrt(3) / 2)
//   box     six such grids, welded; the last row of a closed shape is never shifted, so that borders agree
//   pillow  x = X/2 a (1 - c (1 - b^2)), y = Y/2 b (1 - c (1 - a^2)), z = +- Z/2 (1 - |a|^3)(1 - |b|^3),
//           c = 0.06: two sheets welded at a rim that is drawn in between the corners; a, b run by arc length
//   sphere  icosahedron of frequency n, point = sum sin(w_i t) v_i normalised, t the icosahedron's edge angle
//   skirt   rings, as many edges on each as fit
#include "mesh/make.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/weld.h"

#include <string.h>

static const double MAXIMUM_VERTICES = 50e6;
static const double ROW_HEIGHT = 0.86602540378443865; // of an equilateral triangle of side 1
static const double PILLOW_PINCH = 0.06;
enum { ARC_SAMPLES = 512 };

static const char* const shape_names[RUGA_SHAPE_COUNT] = {"sheet",  "slab",   "bar",
                                                          "pillow", "sphere", "skirt"};

int ruga_shape_from_name(const char* name) {
    for (int i = 0; i < RUGA_SHAPE_COUNT; i++) {
        if (strcmp(name, shape_names[i]) == 0) {
            return i;
        }
    }
    return -1;
}

const char* ruga_shape_name(ruga_shape shape) {
    return (unsigned)shape < RUGA_SHAPE_COUNT ? shape_names[shape] : "unknown shape";
}

// ---------------------------------------------------------------------------------- rows and strips

typedef struct builder {
    int vertex_count, vertex_capacity;
    double (*position)[3]; // first as (place along the row, row, 0), then mapped
    int triangle_count, triangle_capacity;
    int (*triangle)[3];
} builder;

typedef struct row {
    int first, count; // vertices
    double period;    // of a closed row; 0 = open
} row;

static ruga_status add_vertex(builder* b, double x, double y, double z) {
    RUGA_TRY(RUGA_RESERVE(b->position, b->vertex_capacity, (size_t)b->vertex_count + 1));
    double* p = b->position[b->vertex_count++];
    p[0] = x;
    p[1] = y;
    p[2] = z;
    return RUGA_OK;
}

static ruga_status add_triangle(builder* b, int v0, int v1, int v2) {
    RUGA_TRY(RUGA_RESERVE(b->triangle, b->triangle_capacity, (size_t)b->triangle_count + 1));
    int* t = b->triangle[b->triangle_count++];
    t[0] = v0;
    t[1] = v1;
    t[2] = v2;
    return RUGA_OK;
}

static int row_edges(const row* r) {
    return r->period > 0 ? r->count : r->count - 1;
}

static int row_vertex(const row* r, int i) {
    return r->first + (i == r->count ? 0 : i);
}

// Place of the middle of the edge from i to i + 1
static double row_middle(const builder* b, const row* r, int i) {
    double next = b->position[row_vertex(r, i + 1)][0] + (i + 1 == r->count ? r->period : 0);
    return (b->position[row_vertex(r, i)][0] + next) / 2;
}

static ruga_status add_strip(builder* b, const row* lower, const row* upper) {
    int lower_edges = row_edges(lower), upper_edges = row_edges(upper);
    for (int i = 0, j = 0; i < lower_edges || j < upper_edges;) {
        bool along_lower =
            j == upper_edges || (i < lower_edges && row_middle(b, lower, i) <= row_middle(b, upper, j));
        if (along_lower) {
            RUGA_TRY(add_triangle(b, row_vertex(lower, i), row_vertex(lower, i + 1), row_vertex(upper, j)));
            i++;
        } else {
            RUGA_TRY(add_triangle(b, row_vertex(lower, i), row_vertex(upper, j + 1), row_vertex(upper, j)));
            j++;
        }
    }
    return RUGA_OK;
}

// Quad i between two rows of equal counts, cut from lower left to upper right (rising) or the other way.
static ruga_status add_quad(builder* b, const row* lower, const row* upper, int i, bool rising) {
    int p = row_vertex(lower, i), q = row_vertex(lower, i + 1);
    int r = row_vertex(upper, i + 1), s = row_vertex(upper, i);
    RUGA_TRY(add_triangle(b, p, q, rising ? r : s));
    return rising ? add_triangle(b, p, r, s) : add_triangle(b, q, r, s);
}

// How the nu x nv cells of a grid are cut.
typedef struct grid {
    int nu, nv;
    ruga_pattern pattern;
    bool closed; // part of a closed surface: equal borders, and no triangle with all corners on the rim
} grid;

static bool is_shifted(const grid* g, int j) {
    return g->pattern == RUGA_PATTERN_EQUILATERAL && j % 2 == 1 && !(g->closed && j == g->nv);
}

static bool is_rising(const grid* g, int i, int j) {
    bool side = i == 0 || i == g->nu - 1, end = j == 0 || j == g->nv - 1;
    if (g->closed && side && end) {
        return (i == 0) == (j == 0); // through the corner
    }
    switch (g->pattern) {
    case RUGA_PATTERN_DIAGONAL:
        return true;
    case RUGA_PATTERN_ALTERNATING:
        return (i + j) % 2 == 0;
    default: // the odd last row of a closed equilateral grid
        return i >= g->nu / 2;
    }
}

// Places u in [-1, 1], exact at both ends and symmetric.
static ruga_status add_grid_row(builder* b, const grid* g, int j, row* r) {
    double v = (2.0 * j - g->nv) / g->nv;
    bool shifted = is_shifted(g, j);
    r->first = b->vertex_count;
    r->count = g->nu + 1 + shifted;
    r->period = 0;
    for (int i = 0; i < r->count; i++) {
        double u = i == 0 ? -1 : i == r->count - 1 ? 1 : (2.0 * i - shifted - g->nu) / g->nu;
        RUGA_TRY(add_vertex(b, u, v, 0));
    }
    return RUGA_OK;
}

static ruga_status add_grid(builder* b, const grid* g) {
    row lower, upper;
    RUGA_TRY(add_grid_row(b, g, 0, &lower));
    for (int j = 0; j < g->nv; j++) {
        RUGA_TRY(add_grid_row(b, g, j + 1, &upper));
        if (is_shifted(g, j) || is_shifted(g, j + 1)) {
            RUGA_TRY(add_strip(b, &lower, &upper));
        } else {
            for (int i = 0; i < g->nu; i++) {
                RUGA_TRY(add_quad(b, &lower, &upper, i, is_rising(g, i, j)));
            }
        }
        lower = upper;
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------------------- counts

static ruga_status check_count(double vertices) {
    if (!(vertices <= MAXIMUM_VERTICES)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "the mesh would have about %.3g vertices, more than %.0f: make the edges longer",
                         vertices, MAXIMUM_VERTICES);
    }
    return RUGA_OK;
}

static int nearest_count(double count, int least) {
    double n = floor(count + 0.5);
    return n < least ? least : (int)n;
}

// Rows over a length: for a closed equilateral grid the nearest even number, so that both borders agree.
static int nearest_rows(const ruga_make_def* def, double length, bool even, int least) {
    if (def->pattern != RUGA_PATTERN_EQUILATERAL) {
        return nearest_count(length / def->edge, least);
    }
    double rows = length / (def->edge * ROW_HEIGHT);
    return even && rows >= 1.5 ? 2 * nearest_count(rows / 2, 1) : nearest_count(rows, least);
}

// The grid over lengths X and Y, by cells or by edge.
static ruga_status choose_grid(const ruga_make_def* def, const double length[2], bool closed, int least,
                               grid* g) {
    *g = (grid){.pattern = def->pattern, .closed = closed};
    if (def->cells[0] > 0) {
        RUGA_TRY(check_count((def->cells[0] + 1.0) * (def->cells[1] + 1.0)));
        if (def->cells[0] < least || def->cells[1] < least) {
            return ruga_fail(RUGA_BAD_INPUT, "a %s needs at least %d x %d cells", ruga_shape_name(def->shape),
                             least, least);
        }
        g->nu = def->cells[0];
        g->nv = def->cells[1];
        return RUGA_OK;
    }
    RUGA_TRY(check_count((length[0] / def->edge + 1) * (length[1] / (def->edge * ROW_HEIGHT) + 1)));
    g->nu = nearest_count(length[0] / def->edge, least);
    g->nv = nearest_rows(def, length[1], closed, least);
    return RUGA_OK;
}

// ------------------------------------------------------------------------------------------- shapes

static ruga_status make_sheet(const ruga_make_def* def, builder* b) {
    grid g;
    RUGA_TRY(choose_grid(def, def->size, false, 1, &g));
    RUGA_TRY(add_grid(b, &g));
    for (int v = 0; v < b->vertex_count; v++) {
        b->position[v][0] *= def->size[0] / 2;
        b->position[v][1] *= def->size[1] / 2;
    }
    return RUGA_OK;
}

// One face of the box: axes u, v of the grid, and the side (-1 or 1) along the third, whose direction is u x
// v or its opposite.
static ruga_status add_box_face(const ruga_make_def* def, builder* b, const grid* g, int u, int v, int side) {
    int w = 3 - u - v;
    bool right_handed = (u + 1) % 3 == v;
    bool flip = right_handed != (side > 0);
    int first_vertex = b->vertex_count, first_triangle = b->triangle_count;
    RUGA_TRY(add_grid(b, g));
    for (int i = first_vertex; i < b->vertex_count; i++) {
        double place[2] = {b->position[i][0], b->position[i][1]};
        b->position[i][u] = def->size[u] / 2 * place[0];
        b->position[i][v] = def->size[v] / 2 * place[1];
        b->position[i][w] = def->size[w] / 2 * side;
    }
    for (int f = first_triangle; flip && f < b->triangle_count; f++) {
        int second = b->triangle[f][1];
        b->triangle[f][1] = b->triangle[f][2];
        b->triangle[f][2] = second;
    }
    return RUGA_OK;
}

static ruga_status make_box(const ruga_make_def* def, builder* b) {
    grid top;
    RUGA_TRY(choose_grid(def, def->size, true, 1, &top));
    ruga_make_def side = *def;
    if (def->cells[0] > 0) {
        side.edge = def->size[0] / def->cells[0];
    }
    // Across the thickness; on the faces x = const the columns are the rows of the top.
    RUGA_TRY(check_count(2.0 * (top.nu + top.nv) * (def->size[2] / side.edge)));
    int nz = nearest_rows(&side, def->size[2], true, 1);
    grid front = {.nu = top.nu, .nv = nz, .pattern = def->pattern, .closed = true};
    grid end = {.nu = top.nv, .nv = nz, .pattern = def->pattern, .closed = true};
    RUGA_TRY(check_count(2.0 * top.nu * top.nv + 2.0 * (top.nu + top.nv) * nz));
    for (int s = -1; s <= 1; s += 2) {
        RUGA_TRY(add_box_face(def, b, &top, 0, 1, s));
        RUGA_TRY(add_box_face(def, b, &front, 0, 2, s));
        RUGA_TRY(add_box_face(def, b, &end, 1, 2, s));
    }
    return RUGA_OK;
}

// length[i] = arc length of the pillow's profile along one side from a = 0 to i / ARC_SAMPLES, taken where
// the other place is 1/2.
static void measure_profile(double side, double thickness, double length[ARC_SAMPLES + 1]) {
    double across = 1 - 0.125;
    double stretch = side / 2 * (1 - PILLOW_PINCH * 0.75);
    length[0] = 0;
    for (int i = 0; i < ARC_SAMPLES; i++) {
        double a = (i + 0.5) / ARC_SAMPLES;
        double rise = thickness / 2 * across * 3 * a * a;
        length[i + 1] = length[i] + sqrt(stretch * stretch + rise * rise) / ARC_SAMPLES;
    }
}

// The place a in [-1, 1] at the fraction s in [-1, 1] of the arc length; odd, and exact at -1, 0, 1.
static double arc_place(const double length[ARC_SAMPLES + 1], double s) {
    double wanted = fabs(s) * length[ARC_SAMPLES];
    if (fabs(s) == 1) {
        return s;
    }
    int low = 0, high = ARC_SAMPLES;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        *(length[middle] <= wanted ? &low : &high) = middle;
    }
    double a = (low + (wanted - length[low]) / (length[high] - length[low])) / ARC_SAMPLES;
    return s < 0 ? -a : a;
}

// The upper half; *rise = largest z before it is scaled to Z / 2 exactly.
static double map_pillow(const ruga_make_def* def, const double* profile_x, const double* profile_y,
                         builder* b) {
    double rise = 0;
    for (int v = 0; v < b->vertex_count; v++) {
        double* p = b->position[v];
        double a = arc_place(profile_x, p[0]), c = arc_place(profile_y, p[1]);
        p[0] = def->size[0] / 2 * a * (1 - PILLOW_PINCH * (1 - c * c));
        p[1] = def->size[1] / 2 * c * (1 - PILLOW_PINCH * (1 - a * a));
        p[2] = (1 - fabs(a * a * a)) * (1 - fabs(c * c * c));
        rise = fmax(rise, p[2]);
    }
    return rise;
}

// Adds the lower half: the rim (z = 0) is shared, the rest is mirrored.
static ruga_status mirror_pillow(builder* b) {
    ruga_status status = RUGA_OK;
    int upper_vertices = b->vertex_count, upper_triangles = b->triangle_count;
    int* mirror = NULL;
    RUGA_TRY_DONE(RUGA_NEW(mirror, upper_vertices));
    for (int v = 0; v < upper_vertices; v++) {
        const double p[3] = {b->position[v][0], b->position[v][1], b->position[v][2]};
        mirror[v] = p[2] == 0 ? v : b->vertex_count;
        if (p[2] != 0) {
            RUGA_TRY_DONE(add_vertex(b, p[0], p[1], -p[2]));
        }
    }
    for (int f = 0; f < upper_triangles; f++) {
        const int t[3] = {b->triangle[f][0], b->triangle[f][1], b->triangle[f][2]};
        RUGA_TRY_DONE(add_triangle(b, mirror[t[0]], mirror[t[2]], mirror[t[1]]));
    }
done:
    ruga_release(mirror);
    return status;
}

static ruga_status make_pillow(const ruga_make_def* def, builder* b) {
    double profile[2][ARC_SAMPLES + 1];
    for (int k = 0; k < 2; k++) {
        measure_profile(def->size[k], def->size[2], profile[k]);
    }
    const double length[2] = {2 * profile[0][ARC_SAMPLES], 2 * profile[1][ARC_SAMPLES]};
    grid g;
    RUGA_TRY(choose_grid(def, length, true, 2, &g));
    RUGA_TRY(check_count(2.0 * g.nu * g.nv));
    RUGA_TRY(add_grid(b, &g));
    double rise = map_pillow(def, profile[0], profile[1], b);
    for (int v = 0; v < b->vertex_count; v++) {
        b->position[v][2] = def->size[2] / 2 * (b->position[v][2] / rise);
    }
    return mirror_pillow(b);
}

// Twelve vertices, two of them on the x axis so that the diameter along X is exact at every frequency.
static void icosahedron(double vertex[12][3]) {
    const double x = 1 / sqrt(5.0), r = 2 / sqrt(5.0);
    const double pole[2][3] = {{1, 0, 0}, {-1, 0, 0}};
    memcpy(vertex[0], pole[0], sizeof pole[0]);
    memcpy(vertex[11], pole[1], sizeof pole[1]);
    for (int i = 0; i < 5; i++) {
        double angle = 2 * RUGA_PI * i / 5, turned = 2 * RUGA_PI * (i + 0.5) / 5;
        const double near[3] = {x, r * cos(angle), r * sin(angle)};
        const double far[3] = {-x, r * cos(turned), r * sin(turned)};
        memcpy(vertex[1 + i], near, sizeof near);
        memcpy(vertex[6 + i], far, sizeof far);
    }
}

// Counter-clockwise seen from outside
static void icosahedron_faces(int face[20][3]) {
    for (int i = 0; i < 5; i++) {
        int next = (i + 1) % 5;
        const int four[4][3] = {{0, 1 + i, 1 + next},
                                {1 + i, 6 + i, 1 + next},
                                {1 + next, 6 + i, 6 + next},
                                {11, 6 + next, 6 + i}};
        memcpy(face[4 * i], four, sizeof four);
    }
}

// The point with weights w / n of a face's corners. Corners are summed in the order of their numbers, so that
// both faces at an edge give the same bits.
static ruga_status add_sphere_point(const ruga_make_def* def, builder* b, double corner[12][3],
                                    const int face[3], const int w[3], int n) {
    const double angle = atan(2.0); // between neighbours of the icosahedron
    double p[3] = {0, 0, 0};
    for (int v = 0; v < 12; v++) {
        for (int i = 0; i < 3; i++) {
            if (face[i] == v && w[i] > 0) {
                ruga_add_scaled(w[i] == n ? 1 : sin(angle * w[i] / n), corner[v], p);
            }
        }
    }
    if (w[0] != n && w[1] != n && w[2] != n) {
        (void)ruga_normalize(p);
    }
    double radius = def->size[0] / 2;
    return add_vertex(b, radius * p[0], radius * p[1], radius * p[2]);
}

static ruga_status add_sphere_face(const ruga_make_def* def, builder* b, double corner[12][3],
                                   const int face[3], int n) {
    int first = b->vertex_count;
    for (int j = 0; j <= n; j++) {
        for (int i = 0; i <= n - j; i++) {
            const int w[3] = {n - i - j, i, j};
            RUGA_TRY(add_sphere_point(def, b, corner, face, w, n));
        }
    }
    for (int j = 0, lower = first; j < n; j++) {
        int upper = lower + n - j + 1;
        for (int i = 0; i < n - j; i++) {
            RUGA_TRY(add_triangle(b, lower + i, lower + i + 1, upper + i));
            if (i + 1 < n - j) {
                RUGA_TRY(add_triangle(b, lower + i + 1, upper + i + 1, upper + i));
            }
        }
        lower = upper;
    }
    return RUGA_OK;
}

static ruga_status make_sphere(const ruga_make_def* def, builder* b) {
    double corner[12][3];
    int face[20][3];
    // `cells` counts the edges around. 20 n^2 equilateral triangles of side L cover the sphere:
    // L n = r sqrt(4 pi / (5 sqrt(3))).
    double edge = def->cells[0] > 0 ? RUGA_PI * def->size[0] / def->cells[0] : def->edge;
    double frequency = def->size[0] / 2 * sqrt(4 * RUGA_PI / (5 * sqrt(3.0))) / edge;
    RUGA_TRY(check_count(10 * frequency * frequency));
    icosahedron(corner);
    icosahedron_faces(face);
    for (int f = 0; f < 20; f++) {
        RUGA_TRY(add_sphere_face(def, b, corner, face[f], nearest_count(frequency, 1)));
    }
    return RUGA_OK;
}

// A ring k of the skirt, counted from the outside: vertices at fractions of the angle, in (fraction, radius).
static ruga_status add_ring(builder* b, int edges, bool shifted, bool closed, double radius, row* r) {
    r->first = b->vertex_count;
    r->period = closed ? 1 : 0;
    r->count = edges + (closed ? 0 : 1 + shifted);
    for (int i = 0; i < r->count; i++) {
        double u = (i + (shifted ? closed ? 0.5 : -0.5 : 0.0)) / edges;
        u = closed ? u : fmin(fmax(u, 0), 1);
        RUGA_TRY(add_vertex(b, u, radius, 0));
    }
    return RUGA_OK;
}

typedef struct skirt {
    double inner, outer, angle;
    bool closed;
    int rows;
    int edges; // around, on every ring; 0 = as many as fit on each
    double edge;
    ruga_pattern pattern;
} skirt;

static ruga_status add_skirt_ring(builder* b, const skirt* s, int k, row* r) {
    double radius = k == s->rows ? s->inner : s->outer + (s->inner - s->outer) * k / s->rows;
    int least = s->closed ? 3 : 1;
    int edges = s->edges > 0 ? s->edges : nearest_count(s->angle * radius / s->edge, least);
    return add_ring(b, edges, s->pattern == RUGA_PATTERN_EQUILATERAL && k % 2 == 1, s->closed, radius, r);
}

static ruga_status add_skirt_rings(builder* b, const skirt* s) {
    row outer, inner;
    RUGA_TRY(add_skirt_ring(b, s, 0, &outer));
    for (int k = 0; k < s->rows; k++) {
        RUGA_TRY(add_skirt_ring(b, s, k + 1, &inner));
        if (s->pattern == RUGA_PATTERN_EQUILATERAL) {
            RUGA_TRY(add_strip(b, &outer, &inner));
        } else {
            for (int i = 0; i < row_edges(&outer); i++) {
                RUGA_TRY(
                    add_quad(b, &outer, &inner, i, s->pattern == RUGA_PATTERN_DIAGONAL || (i + k) % 2 == 0));
            }
        }
        outer = inner;
    }
    return RUGA_OK;
}

static ruga_status make_skirt(const ruga_make_def* def, builder* b) {
    skirt s = {.inner = def->size[0], .outer = def->size[1], .angle = def->size[2], .edge = def->edge};
    s.pattern = def->pattern;
    s.closed = s.angle > 2 * RUGA_PI * (1 - 1e-9);
    double width = s.outer - s.inner;
    if (def->cells[0] > 0) {
        s.edges = def->cells[0];
        s.rows = def->cells[1];
        RUGA_TRY(check_count((s.edges + 1.0) * (s.rows + 1.0)));
    } else {
        double around = s.angle * (s.inner + s.outer) / 2 / s.edge;
        RUGA_TRY(check_count((around + 1) * (width / s.edge / ROW_HEIGHT + 1)));
        s.rows = nearest_rows(def, width, false, 1);
        // Quads need equal counts: those of the middle ring.
        s.edges = s.pattern == RUGA_PATTERN_EQUILATERAL ? 0 : nearest_count(around, s.closed ? 3 : 1);
    }
    if (s.closed && s.edges > 0 && s.edges < 3) {
        return ruga_fail(RUGA_BAD_INPUT, "a closed skirt needs at least 3 cells around");
    }
    RUGA_TRY(add_skirt_rings(b, &s));
    for (int v = 0; v < b->vertex_count; v++) {
        double angle = s.angle * b->position[v][0], radius = b->position[v][1];
        b->position[v][0] = radius * cos(angle);
        b->position[v][1] = radius * sin(angle);
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------------------- checks

static const char* const wanted_sizes[RUGA_SHAPE_COUNT] = {
    "X,Y", "X,Y,Z", "X,Y,Z", "X[,Y[,Z]]", "X (the diameter)", "inner radius, outer radius[, angle]"};

static ruga_status fail_size(const ruga_make_def* def) {
    return ruga_fail(RUGA_BAD_INPUT, "a %s needs the size %s, each finite and above 0; it got %g,%g,%g",
                     ruga_shape_name(def->shape), wanted_sizes[def->shape], def->size[0], def->size[1],
                     def->size[2]);
}

static ruga_status check_size(ruga_make_def* def) {
    static const int needed[RUGA_SHAPE_COUNT] = {2, 3, 3, 1, 1, 2};
    double* size = def->size;
    for (int k = 0; k < 3; k++) {
        bool missing = size[k] == 0 && k >= needed[def->shape];
        // A sheet has no third size, and a ball is as wide as it is high.
        bool surplus = (def->shape == RUGA_SHAPE_SHEET && k == 2 && size[k] > 0) ||
                       (def->shape == RUGA_SHAPE_SPHERE && size[k] > 0 && size[k] != size[0]);
        if (!isfinite(size[k]) || !(size[k] > 0 || missing) || surplus) {
            return fail_size(def);
        }
    }
    if (def->shape == RUGA_SHAPE_PILLOW) {
        size[1] = size[1] > 0 ? size[1] : size[0];
        size[2] = size[2] > 0 ? size[2] : 0.3 * size[0];
    }
    if (def->shape == RUGA_SHAPE_SKIRT) {
        size[2] = size[2] > 0 ? size[2] : 2 * RUGA_PI;
        if (size[1] <= size[0]) {
            return ruga_fail(RUGA_BAD_INPUT, "a skirt's outer radius %g must be above its inner radius %g",
                             size[1], size[0]);
        }
        if (size[2] > 2 * RUGA_PI * (1 + 1e-9)) {
            return ruga_fail(RUGA_BAD_INPUT, "a skirt's angle %g rad must not be above 2 pi", size[2]);
        }
    }
    return RUGA_OK;
}

// The longest edge that makes sense: the shorter side of what is flat, the longest of a box.
static double longest_edge(const ruga_make_def* def) {
    const double* size = def->size;
    switch (def->shape) {
    case RUGA_SHAPE_SHEET:
    case RUGA_SHAPE_PILLOW:
        return fmin(size[0], size[1]);
    case RUGA_SHAPE_SKIRT:
        return fmax(size[1] - size[0], size[2] * size[0]);
    case RUGA_SHAPE_SPHERE:
        return size[0];
    default:
        return fmax(size[0], fmax(size[1], size[2]));
    }
}

static ruga_status check_edge(const ruga_make_def* def) {
    bool by_cells = def->cells[0] != 0 || def->cells[1] != 0;
    if (by_cells && def->edge != 0) {
        return ruga_fail(RUGA_BAD_INPUT, "give either edge or cells, not both");
    }
    if (by_cells) {
        bool one = def->shape == RUGA_SHAPE_SPHERE && def->cells[1] == 0;
        if (def->cells[0] < 1 || (def->cells[1] < 1 && !one)) {
            return ruga_fail(RUGA_BAD_INPUT, "cells %d,%d: both must be at least 1", def->cells[0],
                             def->cells[1]);
        }
        return RUGA_OK;
    }
    if (!isfinite(def->edge) || def->edge <= 0) {
        return ruga_fail(RUGA_BAD_INPUT, "a %s needs an edge above 0 m, or cells; it got edge %g",
                         ruga_shape_name(def->shape), def->edge);
    }
    if (def->edge > longest_edge(def)) {
        return ruga_fail(RUGA_BAD_INPUT, "the edge %g m is longer than the %s itself (%g m): make it shorter",
                         def->edge, ruga_shape_name(def->shape), longest_edge(def));
    }
    return RUGA_OK;
}

static ruga_status make_shape(const ruga_make_def* def, builder* b) {
    switch (def->shape) {
    case RUGA_SHAPE_SHEET:
        return make_sheet(def, b);
    case RUGA_SHAPE_PILLOW:
        return make_pillow(def, b);
    case RUGA_SHAPE_SPHERE:
        return make_sphere(def, b);
    case RUGA_SHAPE_SKIRT:
        return make_skirt(def, b);
    default:
        return make_box(def, b);
    }
}

ruga_status ruga_mesh_make(const ruga_make_def* def, ruga_mesh* mesh) {
    memset(mesh, 0, sizeof *mesh);
    if ((unsigned)def->shape >= RUGA_SHAPE_COUNT || (unsigned)def->pattern > RUGA_PATTERN_ALTERNATING) {
        return ruga_fail(RUGA_BAD_INPUT, "shape %d with pattern %d does not exist", (int)def->shape,
                         (int)def->pattern);
    }
    ruga_make_def full = *def;
    RUGA_TRY(check_size(&full));
    RUGA_TRY(check_edge(&full));
    builder b = {0};
    ruga_status status = make_shape(&full, &b);
    *mesh = (ruga_mesh){.vertex_count = b.vertex_count,
                        .position = (double*)b.position,
                        .triangle_count = b.triangle_count,
                        .triangle = (int*)b.triangle};
    if (status == RUGA_OK && full.shape != RUGA_SHAPE_SHEET && full.shape != RUGA_SHAPE_PILLOW &&
        full.shape != RUGA_SHAPE_SKIRT) {
        status = ruga_mesh_weld(mesh, 0); // shared borders have equal bits
    }
    if (status != RUGA_OK) {
        ruga_mesh_clear(mesh);
    }
    return status;
}
