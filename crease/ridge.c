// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Tensors at the vertices of the surface at rest:
//   bending  K = 1/A sum over edges around of (theta - theta0)/2 |e| e e^T
//            (Cohen-Steiner and Morvan 2003)
//   stress   S of St. Venant and Kirchhoff in plane stress, mean of the faces around by area
// are averaged over `smooth`. Across a ridge, along the unit vector u, the strength f has a maximum: f is the
// square of the larger eigenvalue of K, whose direction runs along the ridge and u across; or the compression
// -s of the lesser eigenvalue s of S, u its direction. At the vertices d = grad f . u; on an edge with d of
// both signs, f falling towards both ends, the ridge crosses at the zero of d (after Ohtake, Belyaev and
// Seidel 2004). u has no sign: at each edge that of its second end is chosen to agree with the first. In a
// triangle crossed twice the two places are joined; ends that look at one another over a few edges are, too.
// Weak and short lines are dropped, the rest is laid out evenly, smoothed, and thinned to what it needs.
#include "crease/ridge.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "crease/pattern.h"
#include "lattice/union_find.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double WEAK = 0.5;       // of the strength asked for: where a line may begin and end
static const double BROAD = 4;        // times `smooth`: what is flatter across is no ridge
static const double REACH = 4;        // edges between ends that are joined
static const double AHEAD = 0.7;      // cosine: the other end lies ahead
static const double STRAIN = 1e-10;   // of round-off
static const double TURN = 1e-8;      // rad at an edge, of round-off
static const double TOLERANCE = 0.05; // edges, of what is written
enum { LOOK_BACK = 4, LOOP_LEAST = 12, MOST_ROUNDS = 1000 };

typedef struct ridges {
    const ruga_mesh* mesh;
    const double* position;
    ruga_ridge_def def;
    ruga_connectivity edges;
    double edge;                      // m, mean
    double (*tensor)[6], (*other)[6]; // [V] xx, yy, zz, yz, xz, xy
    double *area, *normal;            // [V], [V][3]
    double *strength, *sign;          // [V]
    double (*across)[3];              // [V]
    double (*gradient)[3];            // [V]
    double least;                     // strength of a ridge at its strongest
    double* place;                    // [E] of the crossing, from edge[0]; 0 = none
    int (*link)[2];                   // [E] crossings joined to it, -1 = none
    int* set;                         // [E]
    bool* done;                       // [E]
    int point_count;
    double (*point)[3], (*work)[3]; // [E + 1]
} ridges;

ruga_ridge_def ruga_default_ridge_def(void) {
    return (ruga_ridge_def){.poisson = 0.3, .strength = 0.25};
}

static const double* rest_of(const ridges* r, int v) {
    return r->mesh->position + 3 * (size_t)v;
}

static void add_dyad(double weight, const double a[3], const double b[3], double t[6]) {
    t[0] += weight * a[0] * b[0];
    t[1] += weight * a[1] * b[1];
    t[2] += weight * a[2] * b[2];
    t[3] += weight * 0.5 * (a[1] * b[2] + a[2] * b[1]);
    t[4] += weight * 0.5 * (a[0] * b[2] + a[2] * b[0]);
    t[5] += weight * 0.5 * (a[0] * b[1] + a[1] * b[0]);
}

// ------------------------------------------------------------------------------- tensors

static double face_normal(const double* x, const int v[3], double n[3]) {
    ruga_triangle_normal(x + 3 * (size_t)v[0], x + 3 * (size_t)v[1], x + 3 * (size_t)v[2], n);
    return 0.5 * ruga_normalize(n);
}

// Fold angle of an inner edge, positive for a valley.
static double edge_angle(const ridges* r, const double* x, int e) {
    double n[2][3], t[3], c[3];
    const int* end = r->edges.edge[e];
    for (int k = 0; k < 2; k++) {
        (void)face_normal(x, r->mesh->triangle + 3 * (size_t)r->edges.edge_triangle[e][k], n[k]);
    }
    ruga_subtract(x + 3 * (size_t)end[1], x + 3 * (size_t)end[0], t);
    ruga_normalize(t);
    ruga_cross(n[1], n[0], c);
    return atan2(ruga_dot(c, t), ruga_dot(n[0], n[1]));
}

static void add_bending(ridges* r) {
    for (int e = 0; e < r->edges.edge_count; e++) {
        if (r->edges.edge_triangle[e][1] < 0 || r->edges.edge_triangle[e][0] < 0) {
            continue;
        }
        const int* end = r->edges.edge[e];
        double t[3], angle = edge_angle(r, r->position, e) - edge_angle(r, r->mesh->position, e);
        angle -= 2 * RUGA_PI * floor(angle / (2 * RUGA_PI) + 0.5);
        ruga_subtract(rest_of(r, end[1]), rest_of(r, end[0]), t);
        double length = ruga_normalize(t);
        for (int k = 0; k < 2; k++) {
            add_dyad(0.5 * angle * length, t, t, r->tensor[end[k]]);
        }
    }
}

// Second Piola-Kirchhoff stress over E / (1 - nu^2), times a third of the area, to the corners.
static void add_stress(ridges* r, int f) {
    const int* v = r->mesh->triangle + 3 * (size_t)f;
    double n[3], axis[2][3], a[2][3], b[2][3], dx[2][2], g[2][2], strain[2][2], nu = r->def.poisson;
    double area = face_normal(r->mesh->position, v, n);
    for (int k = 0; k < 2; k++) {
        ruga_subtract(rest_of(r, v[k + 1]), rest_of(r, v[0]), a[k]);
        ruga_subtract(r->position + 3 * (size_t)v[k + 1], r->position + 3 * (size_t)v[0], b[k]);
    }
    memcpy(axis[0], a[0], sizeof axis[0]);
    ruga_normalize(axis[0]);
    ruga_cross(n, axis[0], axis[1]);
    for (int i = 0; i < 2; i++) { // inverse of the edges at rest in these axes: a is (a00, 0), (a10, a11)
        for (int k = 0; k < 2; k++) {
            dx[i][k] = ruga_dot(axis[i], a[k]);
        }
    }
    double det = dx[0][0] * dx[1][1] - dx[0][1] * dx[1][0];
    if (!(area > 0) || !(fabs(det) > 0)) {
        return;
    }
    double inverse[2][2] = {{dx[1][1] / det, -dx[0][1] / det}, {-dx[1][0] / det, dx[0][0] / det}},
           column[2][3];
    for (int j = 0; j < 2; j++) {
        for (int i = 0; i < 3; i++) {
            column[j][i] = b[0][i] * inverse[0][j] + b[1][i] * inverse[1][j];
        }
    }
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            g[i][j] = ruga_dot(column[i], column[j]);
            strain[i][j] = 0.5 * (g[i][j] - (i == j));
        }
    }
    double trace = strain[0][0] + strain[1][1];
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            double stress = (1 - nu) * strain[i][j] + (i == j ? nu * trace : 0);
            for (int k = 0; k < 3; k++) {
                add_dyad(stress * area / 3, axis[i], axis[j], r->tensor[v[k]]);
            }
        }
    }
}

static void set_tensors(ridges* r) {
    for (int f = 0; f < r->mesh->triangle_count; f++) {
        double n[3];
        const int* v = r->mesh->triangle + 3 * (size_t)f;
        double area = face_normal(r->mesh->position, v, n);
        for (int k = 0; k < 3; k++) {
            r->area[v[k]] += area / 3;
            ruga_add_scaled(area, n, r->normal + 3 * (size_t)v[k]);
        }
        if (r->def.stress) {
            add_stress(r, f);
        }
    }
    if (!r->def.stress) {
        add_bending(r);
    }
    for (int v = 0; v < r->mesh->vertex_count; v++) {
        ruga_normalize(r->normal + 3 * (size_t)v);
        for (int i = 0; i < 6 && r->area[v] > 0; i++) {
            r->tensor[v][i] /= r->area[v];
        }
    }
}

// Each round has the variance of a quarter of a squared edge; `smooth` is twice the deviation.
static int rounds_for(const ridges* r, double step) {
    double rounds = ceil(r->def.smooth * r->def.smooth / (step * step));
    return rounds < MOST_ROUNDS ? (int)rounds : MOST_ROUNDS;
}

static void smooth_tensors(ridges* r) {
    for (int round = rounds_for(r, r->edge); round > 0; round--) {
        for (int v = 0; v < r->mesh->vertex_count; v++) {
            int begin = r->edges.neighbour_start[v], end = r->edges.neighbour_start[v + 1];
            for (int i = 0; i < 6; i++) {
                double sum = 0;
                for (int k = begin; k < end; k++) {
                    sum += r->tensor[r->edges.neighbour[k]][i];
                }
                r->other[v][i] =
                    end > begin ? 0.5 * (r->tensor[v][i] + sum / (end - begin)) : r->tensor[v][i];
            }
        }
        double(*swap)[6] = r->tensor;
        r->tensor = r->other;
        r->other = swap;
    }
}

// ------------------------------------------------------------------------------- strength and direction

static void multiply(const double t[6], const double x[3], double y[3]) {
    y[0] = t[0] * x[0] + t[5] * x[1] + t[4] * x[2];
    y[1] = t[5] * x[0] + t[1] * x[1] + t[3] * x[2];
    y[2] = t[4] * x[0] + t[3] * x[1] + t[2] * x[2];
}

// The tensor within the tangent plane; the eigenvector of its larger absolute (bending) or least (stress)
// eigenvalue.
static void set_direction(ridges* r, int v) {
    const double* n = r->normal + 3 * (size_t)v;
    double b[2][3] = {{0}}, image[2][3];
    int thin = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
    thin = fabs(n[2]) < fabs(n[thin]) ? 2 : thin;
    b[1][thin] = 1;
    ruga_cross(n, b[1], b[0]);
    ruga_normalize(b[0]);
    ruga_cross(n, b[0], b[1]);
    multiply(r->tensor[v], b[0], image[0]);
    multiply(r->tensor[v], b[1], image[1]);
    double xx = ruga_dot(b[0], image[0]), xy = ruga_dot(b[1], image[0]), yy = ruga_dot(b[1], image[1]);
    double mean = 0.5 * (xx + yy), apart = hypot(0.5 * (xx - yy), xy);
    double value = r->def.stress || mean < 0 ? mean - apart : mean + apart;
    double turn = 0.5 * atan2(2 * xy, xx - yy) + (value < mean ? RUGA_PI / 2 : 0);
    double along[3] = {0, 0, 0};
    ruga_add_scaled(cos(turn), b[0], along);
    ruga_add_scaled(sin(turn), b[1], along);
    r->strength[v] = r->def.stress ? fmax(-value, 0) : value * value;
    r->sign[v] = value;
    if (r->def.stress) {
        memcpy(r->across[v], along, sizeof along);
    } else {
        ruga_cross(n, along, r->across[v]);
    }
}

static void set_gradients(ridges* r) {
    for (int f = 0; f < r->mesh->triangle_count; f++) {
        const int* v = r->mesh->triangle + 3 * (size_t)f;
        double n[3], g[3] = {0, 0, 0}, side[3], turned[3];
        double area = face_normal(r->mesh->position, v, n);
        for (int k = 0; k < 3; k++) { // grad of corner k's hat = n x (opposite side) / (2 A); times A / 3
            ruga_subtract(rest_of(r, v[(k + 2) % 3]), rest_of(r, v[(k + 1) % 3]), side);
            ruga_cross(n, side, turned);
            ruga_add_scaled(r->strength[v[k]] / 6, turned, g);
        }
        for (int k = 0; k < 3 && area > 0; k++) {
            ruga_add_scaled(1 / r->area[v[k]], g, r->gradient[v[k]]);
        }
    }
}

static int compare_doubles(const void* a, const void* b) {
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

static ruga_status set_least(ridges* r) {
    double* sorted = NULL;
    int count = r->mesh->vertex_count;
    RUGA_TRY(RUGA_NEW(sorted, count));
    memcpy(sorted, r->strength, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, compare_doubles);
    double floor = r->def.stress ? STRAIN : (TURN / r->edge) * (TURN / r->edge);
    r->least = fmax(r->def.strength * sorted[(int)(0.99 * (count - 1))], floor);
    ruga_release(sorted);
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- crossings and lines

static double strength_at(const ridges* r, int e) {
    const int* end = r->edges.edge[e];
    return r->strength[end[0]] + r->place[e] * (r->strength[end[1]] - r->strength[end[0]]);
}

static void find_crossing(ridges* r, int e) {
    const int* end = r->edges.edge[e];
    double way[3], agree = ruga_dot(r->across[end[0]], r->across[end[1]]) < 0 ? -1 : 1;
    double d0 = ruga_dot(r->gradient[end[0]], r->across[end[0]]),
           d1 = agree * ruga_dot(r->gradient[end[1]], r->across[end[1]]);
    ruga_subtract(rest_of(r, end[1]), rest_of(r, end[0]), way);
    double slope = ruga_dot(way, r->across[end[0]]) + agree * ruga_dot(way, r->across[end[1]]);
    if ((d0 > 0) == (d1 > 0) || (d1 - d0) * slope >= 0) {
        return;
    }
    r->place[e] = fmin(fmax(d0 / (d0 - d1), 1e-9), 1 - 1e-9);
    // f'' <= -f / BROAD^2: a level top has no ridge.
    double strength = strength_at(r, e), broad = BROAD * r->def.smooth;
    bool sharp = fabs(2 * (d1 - d0) / slope) * broad * broad >= strength;
    r->place[e] = strength >= WEAK * r->least && sharp ? r->place[e] : 0;
}

static void link_crossings(ridges* r, int a, int b) {
    r->link[a][r->link[a][0] >= 0] = b;
    r->link[b][r->link[b][0] >= 0] = a;
    ruga_sets_unite(r->set, a, b);
}

static void crossing_point(const ridges* r, int e, double x[3]) {
    const int* end = r->edges.edge[e];
    for (int i = 0; i < 3; i++) {
        x[i] = rest_of(r, end[0])[i] + r->place[e] * (rest_of(r, end[1])[i] - rest_of(r, end[0])[i]);
    }
}

static bool is_end(const ridges* r, int e) {
    return r->place[e] > 0 && r->link[e][0] >= 0 && r->link[e][1] < 0;
}

// Unit vector in which a line ends.
static void end_direction(const ridges* r, int e, double d[3]) {
    int at = e, before = -1;
    double x[3], y[3];
    for (int k = 0; k < LOOK_BACK; k++) {
        int next = r->link[at][0] == before ? r->link[at][1] : r->link[at][0];
        if (next < 0) {
            break;
        }
        before = at;
        at = next;
    }
    crossing_point(r, e, x);
    crossing_point(r, at, y);
    ruga_subtract(x, y, d);
    ruga_normalize(d);
}

typedef struct bridge {
    int end[2];
    double length;
} bridge;

static int compare_bridges(const void* a, const void* b) {
    const bridge *p = a, *q = b;
    if (p->length != q->length) {
        return p->length < q->length ? -1 : 1;
    }
    return p->end[0] != q->end[0] ? (p->end[0] > q->end[0]) - (p->end[0] < q->end[0])
                                  : (p->end[1] > q->end[1]) - (p->end[1] < q->end[1]);
}

static bool look_at_each_other(const ridges* r, int a, int b, double* length) {
    double x[3], y[3], d[3], way[3];
    crossing_point(r, a, x);
    crossing_point(r, b, y);
    ruga_subtract(y, x, way);
    *length = ruga_normalize(way);
    if (*length > REACH * r->edge) {
        return false;
    }
    end_direction(r, a, d);
    bool ahead = ruga_dot(d, way) > AHEAD;
    end_direction(r, b, d);
    return (ahead && -ruga_dot(d, way) > AHEAD) || *length < 0.25 * r->edge;
}

static int count_set(const ridges* r, int e) {
    int at = e, before = -1, count = 1;
    for (int next = r->link[at][0]; next >= 0 && next != e && count < LOOP_LEAST; count++) {
        before = at;
        at = next;
        next = r->link[at][0] == before ? r->link[at][1] : r->link[at][0];
    }
    return count;
}

typedef struct line_end {
    double x;
    int edge;
} line_end;

static int compare_ends(const void* a, const void* b) {
    const line_end *p = a, *q = b;
    return p->x != q->x ? (p->x > q->x) - (p->x < q->x) : p->edge - q->edge;
}

static ruga_status join_ends(ridges* r) {
    ruga_status status = RUGA_OK;
    bridge* list = NULL;
    line_end* end = NULL;
    int ends = 0, count = 0, capacity = 0;
    RUGA_TRY_DONE(RUGA_NEW(end, r->edges.edge_count));
    for (int e = 0; e < r->edges.edge_count; e++) {
        if (is_end(r, e)) {
            double x[3];
            crossing_point(r, e, x);
            end[ends++] = (line_end){x[0], e};
        }
    }
    qsort(end, (size_t)ends, sizeof *end, compare_ends);
    for (int i = 0; i < ends; i++) {
        for (int j = i - 1; j >= 0 && end[i].x - end[j].x <= REACH * r->edge; j--) {
            int low = end[i].edge < end[j].edge ? end[i].edge : end[j].edge;
            int high = end[i].edge + end[j].edge - low;
            double length;
            if (look_at_each_other(r, low, high, &length)) {
                RUGA_TRY_DONE(RUGA_RESERVE(list, capacity, (size_t)count + 1));
                list[count++] = (bridge){{low, high}, length};
            }
        }
    }
    if (count > 1) {
        qsort(list, (size_t)count, sizeof *list, compare_bridges);
    }
    for (int k = 0; k < count; k++) {
        int a = list[k].end[0], b = list[k].end[1];
        bool same = ruga_sets_find(r->set, a) == ruga_sets_find(r->set, b);
        if (is_end(r, a) && is_end(r, b) && (!same || count_set(r, a) >= LOOP_LEAST)) {
            link_crossings(r, a, b);
        }
    }
done:
    ruga_release(end);
    ruga_release(list);
    return status;
}

static ruga_status find_lines(ridges* r) {
    memset(r->link, -1, (size_t)r->edges.edge_count * sizeof *r->link);
    ruga_sets_reset(r->set, r->edges.edge_count);
    for (int e = 0; e < r->edges.edge_count; e++) {
        find_crossing(r, e);
    }
    for (int f = 0; f < r->mesh->triangle_count; f++) {
        int crossed[3], count = 0;
        for (int k = 0; k < 3; k++) {
            int e = r->edges.triangle_edge[f][k];
            if (r->place[e] > 0) {
                crossed[count++] = e;
            }
        }
        if (count == 2) {
            link_crossings(r, crossed[0], crossed[1]);
        }
    }
    return join_ends(r);
}

// ------------------------------------------------------------------------------- polylines

static double length_of(const ridges* r) {
    double length = 0;
    for (int i = 1; i < r->point_count; i++) {
        length += ruga_distance(r->point[i - 1], r->point[i]);
    }
    return length;
}

// The line from crossing e on; *strongest and *turn, the sum of its signs, are SET.
static void walk(ridges* r, int e, double* strongest, double* turn, bool* closed) {
    int at = e, before = -1;
    r->point_count = 0;
    *strongest = *turn = 0;
    do {
        const int* end = r->edges.edge[at];
        r->done[at] = true;
        crossing_point(r, at, r->point[r->point_count++]);
        *strongest = fmax(*strongest, strength_at(r, at));
        *turn += r->sign[end[0]] + r->sign[end[1]];
        int next = r->link[at][0] == before ? r->link[at][1] : r->link[at][0];
        before = at;
        at = next;
    } while (at >= 0 && at != e);
    *closed = at == e && r->point_count > 2;
    if (*closed) {
        memcpy(r->point[r->point_count], r->point[0], sizeof *r->point);
        r->point_count++;
    }
}

// Points at equal distances, as many as there are at most; ends stay. Then averaged with their neighbours.
static void even_out(ridges* r, double length, bool closed) {
    int count = (int)fmax(fmin(ceil(length / r->edge), r->point_count - 1), closed ? 4 : 1), k = 1;
    double step = length / count, passed = 0;
    for (int i = 0; i <= count; i++) {
        double piece = ruga_distance(r->point[k - 1], r->point[k]);
        while (k + 1 < r->point_count && passed + piece < i * step) {
            passed += piece;
            k++;
            piece = ruga_distance(r->point[k - 1], r->point[k]);
        }
        double part = piece > 0 ? fmin((i * step - passed) / piece, 1) : 0;
        for (int c = 0; c < 3; c++) {
            r->work[i][c] = r->point[k - 1][c] + part * (r->point[k][c] - r->point[k - 1][c]);
        }
    }
    r->point_count = count + 1;
    memcpy(r->point, r->work, (size_t)r->point_count * sizeof *r->point);
    for (int round = rounds_for(r, step); round > 0; round--) {
        for (int i = closed ? 0 : 1; i < count; i++) {
            const double *a = r->point[i > 0 ? i - 1 : count - 1], *b = r->point[i + 1];
            for (int c = 0; c < 3; c++) {
                r->work[i][c] = 0.5 * r->point[i][c] + 0.25 * (a[c] + b[c]);
            }
        }
        memcpy(r->work[count], r->work[closed ? 0 : count], sizeof *r->work);
        memcpy(r->point, r->work, (size_t)r->point_count * sizeof *r->point);
    }
}

// Douglas and Peucker 1973: points kept of [first, last], the last one left out, to r->work.
static int thin(ridges* r, int first, int last, int out) {
    double way[3], off[3], c[3], most = TOLERANCE * r->edge;
    int worst = -1;
    ruga_subtract(r->point[last], r->point[first], way);
    double length = ruga_normalize(way);
    for (int i = first + 1; i < last; i++) {
        ruga_subtract(r->point[i], r->point[first], off);
        ruga_cross(way, off, c);
        double distance = length > 0 ? ruga_norm(c) : ruga_norm(off);
        worst = distance > most ? i : worst;
        most = fmax(most, distance);
    }
    if (worst < 0) {
        memcpy(r->work[out], r->point[first], sizeof *r->work);
        return out + 1;
    }
    out = thin(r, first, worst, out);
    return thin(r, worst, last, out);
}

static ruga_status add_curve(ridges* r, bool closed, double turn, ruga_curves* curves) {
    ruga_curve style = {.closed = closed, .label = RUGA_ASSIGNMENT_UNASSIGNED};
    if (!r->def.stress) {
        style.label = turn > 0 ? RUGA_ASSIGNMENT_VALLEY : RUGA_ASSIGNMENT_MOUNTAIN;
    }
    int count = thin(r, 0, r->point_count - 1, 0);
    if (!closed) {
        memcpy(r->work[count++], r->point[r->point_count - 1], sizeof *r->work);
    }
    return ruga_curves_add_polyline(curves, &style, count, (const double(*)[3])r->work);
}

static double curve_length(const ruga_curve* curve) {
    double length = 0;
    for (int i = curve->closed ? 0 : 1; i < curve->point_count; i++) {
        length += ruga_distance(curve->point[i > 0 ? i - 1 : curve->point_count - 1], curve->point[i]);
    }
    return length;
}

typedef struct ranked_curve {
    double length;
    int index;
    ruga_curve curve;
} ranked_curve;

static int compare_curves(const void* a, const void* b) {
    const ranked_curve *p = a, *q = b;
    return p->length != q->length ? (p->length < q->length) - (p->length > q->length) : p->index - q->index;
}

// Longest first; equal ones stay in their order.
static ruga_status sort_curves(ruga_curves* curves, int first) {
    ranked_curve* list = NULL;
    int count = curves->count - first;
    RUGA_TRY(RUGA_NEW(list, count));
    for (int i = 0; i < count; i++) {
        const ruga_curve* c = &curves->curve[first + i];
        list[i] = (ranked_curve){curve_length(c), i, *c};
    }
    qsort(list, (size_t)count, sizeof *list, compare_curves);
    for (int i = 0; i < count; i++) {
        curves->curve[first + i] = list[i].curve;
    }
    ruga_release(list);
    return RUGA_OK;
}

static ruga_status collect(ridges* r, ruga_curves* curves) {
    int first = curves->count;
    for (int pass = 0; pass < 2; pass++) { // lines from their ends, then closed ones
        for (int e = 0; e < r->edges.edge_count; e++) {
            if (r->place[e] > 0 && !r->done[e] && r->link[e][0] >= 0 && (pass == 1 || is_end(r, e))) {
                double strongest, turn, length;
                bool closed;
                walk(r, e, &strongest, &turn, &closed);
                length = length_of(r);
                if (strongest >= r->least && length >= r->def.min_length) {
                    even_out(r, length, closed);
                    RUGA_TRY(add_curve(r, closed, turn, curves));
                }
            }
        }
    }
    return sort_curves(curves, first);
}

// ------------------------------------------------------------------------------- all of it

static ruga_status allocate(ridges* r) {
    int vertices = r->mesh->vertex_count, edges;
    RUGA_TRY(ruga_connectivity_create(r->mesh, &r->edges));
    edges = r->edges.edge_count;
    RUGA_TRY(RUGA_NEW_ZERO(r->tensor, vertices));
    RUGA_TRY(RUGA_NEW_ZERO(r->other, vertices));
    RUGA_TRY(RUGA_NEW_ZERO(r->area, vertices));
    RUGA_TRY(RUGA_NEW_ZERO(r->normal, 3 * (size_t)vertices));
    RUGA_TRY(RUGA_NEW(r->strength, vertices));
    RUGA_TRY(RUGA_NEW(r->sign, vertices));
    RUGA_TRY(RUGA_NEW(r->across, vertices));
    RUGA_TRY(RUGA_NEW_ZERO(r->gradient, vertices));
    RUGA_TRY(RUGA_NEW_ZERO(r->place, edges));
    RUGA_TRY(RUGA_NEW(r->link, edges));
    RUGA_TRY(RUGA_NEW(r->set, edges));
    RUGA_TRY(RUGA_NEW_ZERO(r->done, edges));
    RUGA_TRY(RUGA_NEW(r->point, (size_t)edges + 5));
    return RUGA_NEW(r->work, (size_t)edges + 5);
}

ruga_status ruga_ridges_find(const ruga_mesh* mesh, const double* position, const ruga_ridge_def* def,
                             ruga_curves* curves) {
    ruga_status status = RUGA_OK;
    ridges r = {.mesh = mesh, .position = position, .def = *def, .edge = ruga_mesh_mean_edge(mesh)};
    if (r.def.smooth <= 0) {
        r.def.smooth = 3 * r.edge;
    }
    if (r.def.min_length <= 0) {
        r.def.min_length = 10 * r.edge;
    }
    RUGA_TRY_DONE(allocate(&r));
    set_tensors(&r);
    smooth_tensors(&r);
    for (int v = 0; v < mesh->vertex_count; v++) {
        set_direction(&r, v);
    }
    set_gradients(&r);
    RUGA_TRY_DONE(set_least(&r));
    RUGA_TRY_DONE(find_lines(&r));
    RUGA_TRY_DONE(collect(&r, curves));
done:
    ruga_connectivity_clear(&r.edges);
    ruga_release(r.tensor);
    ruga_release(r.other);
    ruga_release(r.area);
    ruga_release(r.normal);
    ruga_release(r.strength);
    ruga_release(r.sign);
    ruga_release(r.across);
    ruga_release(r.gradient);
    ruga_release(r.place);
    ruga_release(r.link);
    ruga_release(r.set);
    ruga_release(r.done);
    ruga_release(r.point);
    ruga_release(r.work);
    return status;
}
