// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Miura-ori (Schenk and Guest 2013): with the slope theta of the panels,
//   H = a sin theta sin gamma,  L = a sqrt(1 - sin^2 theta sin^2 gamma),  q = sqrt(1 + cos^2 theta tan^2
//   gamma), S = b cos theta tan gamma / q,  V = b / q,
// vertex (i, j) lies at (i S, j L + [i odd] V, [j odd] H). Assignments and angles are measured there.
// Waterbombs: valleys along the diagonals of cells, mountains along their sides and upright middles; with
// rows half a cell apart all inner vertices have six lines and fold flat. Pleats: y = y_k + A sin(2 pi n x /
// X), steepest slope tan(angle) = 2 pi n A / X; arcs: circles about one centre. Both alternate between
// mountain and valley.
#include "crease/design.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

enum { MOST_CELLS = 1000, PIECES = 32, TURN_PIECES = 96 };

static const char* const names[RUGA_DESIGN_COUNT] = {"miura", "waterbomb", "pleats", "arcs"};

int ruga_design_from_name(const char* name) {
    for (int k = 0; k < RUGA_DESIGN_COUNT; k++) {
        if (strcmp(name, names[k]) == 0) {
            return k;
        }
    }
    return -1;
}

// ------------------------------------------------------------------------------- lines

typedef struct pen {
    ruga_crease_pattern* pattern;
    double fold;
} pen;

// Ends that coincide are welded by the arrangement.
static ruga_status draw(const pen* p, const double a[3], const double b[3], ruga_assignment assignment,
                        double angle) {
    int v = p->pattern->vertex_count;
    RUGA_TRY(ruga_crease_pattern_add_vertex(p->pattern, a));
    RUGA_TRY(ruga_crease_pattern_add_vertex(p->pattern, b));
    return ruga_crease_pattern_add_edge(p->pattern, v, v + 1, assignment, angle);
}

static ruga_status draw_crease(const pen* p, const double a[3], const double b[3], bool valley) {
    return draw(p, a, b, valley ? RUGA_ASSIGNMENT_VALLEY : RUGA_ASSIGNMENT_MOUNTAIN,
                p->fold > 0 ? (valley ? p->fold : -p->fold) : NAN);
}

static ruga_status draw_flat(const pen* p, double ax, double ay, double bx, double by, int kind) {
    const double a[3] = {ax, ay, 0}, b[3] = {bx, by, 0};
    return kind == RUGA_ASSIGNMENT_BORDER ? draw(p, a, b, RUGA_ASSIGNMENT_BORDER, NAN)
                                          : draw_crease(p, a, b, kind == RUGA_ASSIGNMENT_VALLEY);
}

static ruga_status draw_rectangle(const pen* p, double x, double y) {
    const double corner[4][2] = {{-x / 2, -y / 2}, {x / 2, -y / 2}, {x / 2, y / 2}, {-x / 2, y / 2}};
    for (int k = 0; k < 4; k++) {
        const double* next = corner[(k + 1) % 4];
        RUGA_TRY(draw_flat(p, corner[k][0], corner[k][1], next[0], next[1], RUGA_ASSIGNMENT_BORDER));
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- designs

void ruga_miura_vertex(double a, double b, double gamma, double theta, int i, int j, double x[3]) {
    double slope = cos(theta) * tan(gamma), q = sqrt(1 + slope * slope), rise = sin(theta) * sin(gamma);
    x[0] = i * b * slope / q;
    x[1] = j * a * sqrt(1 - rise * rise) + (i % 2 != 0 ? b / q : 0);
    x[2] = j % 2 != 0 ? a * rise : 0;
}

// The fold angle about the way from vertex v to w, with a panel's other corner on the left and on the right.
static double angle_between(const double v[3], const double w[3], const double left[3],
                            const double right[3]) {
    double t[3], l[3], r[3], nl[3], nr[3], c[3];
    ruga_subtract(w, v, t);
    ruga_subtract(left, v, l);
    ruga_subtract(right, v, r);
    ruga_cross(t, l, nl);
    ruga_cross(r, t, nr);
    ruga_normalize(t);
    ruga_cross(nr, nl, c);
    return atan2(ruga_dot(c, t), ruga_dot(nl, nr));
}

typedef struct miura {
    double a, b, gamma, theta; // of the folded form that says what is mountain and what is valley
    double middle[2];
    int cells[2];
    bool angles;
} miura;

// The line from (i, j) to the next vertex along x or along y.
static ruga_status draw_miura_line(const pen* p, const miura* m, int i, int j, bool along) {
    static const int step[2][3][2] = {{{0, 1}, {-1, 0}, {1, 0}},
                                      {{1, 0}, {0, 1}, {0, -1}}}; // end, left, right
    double flat[2][3], folded[4][3];
    for (int k = 0; k < 4; k++) {
        int ik = i + (k ? step[along][k - 1][0] : 0), jk = j + (k ? step[along][k - 1][1] : 0);
        ruga_miura_vertex(m->a, m->b, m->gamma, m->theta, ik, jk, folded[k]);
        if (k < 2) {
            ruga_miura_vertex(m->a, m->b, m->gamma, 0, ik, jk, flat[k]);
            flat[k][0] -= m->middle[0];
            flat[k][1] -= m->middle[1];
        }
    }
    if (along ? j == 0 || j == m->cells[1] : i == 0 || i == m->cells[0]) {
        return draw(p, flat[0], flat[1], RUGA_ASSIGNMENT_BORDER, NAN);
    }
    double angle = angle_between(folded[0], folded[1], folded[2], folded[3]);
    return draw(p, flat[0], flat[1], angle > 0 ? RUGA_ASSIGNMENT_VALLEY : RUGA_ASSIGNMENT_MOUNTAIN,
                m->angles ? angle : NAN);
}

static ruga_status draw_miura(const pen* p, const ruga_design_def* def) {
    miura m = {.gamma = def->angle > 0 ? def->angle : RUGA_PI / 3,
               .theta = def->fold > 0 ? def->fold : RUGA_PI / 4,
               .cells = {def->cells[0], def->cells[1]},
               .middle = {def->size[0] / 2, def->size[1] / 2},
               .angles = def->fold > 0};
    m.b = def->size[0] / (m.cells[0] * sin(m.gamma));
    m.a = (def->size[1] - m.b * cos(m.gamma)) / m.cells[1];
    if (!(m.gamma < RUGA_PI / 2) || !(m.a > 0)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "a Miura-ori of this size has an angle below 90 degrees, and more room along Y "
                         "or more cells along X");
    }
    for (int i = 0; i <= m.cells[0]; i++) {
        for (int j = 0; j <= m.cells[1]; j++) {
            if (i < m.cells[0]) {
                RUGA_TRY(draw_miura_line(p, &m, i, j, true));
            }
            if (j < m.cells[1]) {
                RUGA_TRY(draw_miura_line(p, &m, i, j, false));
            }
        }
    }
    return RUGA_OK;
}

static ruga_status draw_waterbombs(const pen* p, const ruga_design_def* def) {
    double w = def->size[0] / (2 * def->cells[0]), h = def->size[1] / (2 * def->cells[1]);
    double left = -def->size[0] / 2, low = -def->size[1] / 2;
    RUGA_TRY(draw_rectangle(p, def->size[0], def->size[1]));
    for (int i = 1; i < 2 * def->cells[0]; i++) {
        RUGA_TRY(draw_flat(p, left + i * w, low, left + i * w, -low, RUGA_ASSIGNMENT_MOUNTAIN));
    }
    for (int j = 1; j < def->cells[1]; j++) {
        RUGA_TRY(draw_flat(p, left, low + 2 * j * h, -left, low + 2 * j * h, RUGA_ASSIGNMENT_MOUNTAIN));
    }
    // Half diagonals, one in each half of a half cell.
    for (int j = 0; j < 2 * def->cells[1]; j++) {
        for (int i = 0; i < 2 * def->cells[0]; i++) {
            bool rises = (i + j + j / 2) % 2 == 0;
            double x = left + i * w, y = low + j * h;
            RUGA_TRY(draw_flat(p, x, rises ? y : y + h, x + w, rises ? y + h : y, RUGA_ASSIGNMENT_VALLEY));
        }
    }
    return RUGA_OK;
}

static ruga_status draw_pleats(const pen* p, const ruga_design_def* def) {
    double angle = def->angle > 0 ? def->angle : RUGA_PI / 6, wave = def->size[0] / def->cells[1];
    double height = tan(angle) * wave / (2 * RUGA_PI), gap = def->size[1] / (def->cells[0] + 1);
    int pieces = PIECES * def->cells[1];
    if (!(angle < RUGA_PI / 2) || height >= 0.9 * gap) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "the waves of the pleats, %.3g m high, do not fit between creases %.3g m apart",
                         height, gap);
    }
    RUGA_TRY(draw_rectangle(p, def->size[0], def->size[1]));
    for (int k = 1; k <= def->cells[0]; k++) {
        for (int i = 0; i < pieces; i++) {
            double end[2][2];
            for (int e = 0; e < 2; e++) {
                double part = (double)(i + e) / pieces;
                end[e][0] = (part - 0.5) * def->size[0];
                end[e][1] = k * gap - def->size[1] / 2 + height * sin(2 * RUGA_PI * def->cells[1] * part);
            }
            RUGA_TRY(draw_flat(p, end[0][0], end[0][1], end[1][0], end[1][1],
                               k % 2 ? RUGA_ASSIGNMENT_MOUNTAIN : RUGA_ASSIGNMENT_VALLEY));
        }
    }
    return RUGA_OK;
}

static ruga_status draw_arcs(const pen* p, const ruga_design_def* def) {
    double inner = def->size[0], outer = def->size[1], turn = def->size[2];
    if (!(outer > inner) || !(turn <= 2 * RUGA_PI)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "arcs: the outer radius is above the inner one, the angle a full turn at most");
    }
    int pieces = (int)ceil(TURN_PIECES * turn / (2 * RUGA_PI));
    for (int k = 0; k <= def->cells[0] + 1; k++) {
        double radius = inner + (outer - inner) * k / (def->cells[0] + 1);
        ruga_assignment assignment = k == 0 || k == def->cells[0] + 1 ? RUGA_ASSIGNMENT_BORDER
                                     : k % 2                          ? RUGA_ASSIGNMENT_MOUNTAIN
                                                                      : RUGA_ASSIGNMENT_VALLEY;
        for (int i = 0; i < pieces; i++) {
            double from = turn * i / pieces, to = turn * (i + 1) / pieces;
            RUGA_TRY(draw_flat(p, radius * cos(from), radius * sin(from), radius * cos(to), radius * sin(to),
                               (int)assignment));
        }
    }
    for (int end = 0; end < 2 && turn < 2 * RUGA_PI; end++) {
        double c = cos(end * turn), s = sin(end * turn);
        RUGA_TRY(draw_flat(p, inner * c, inner * s, outer * c, outer * s, RUGA_ASSIGNMENT_BORDER));
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- all of them

static ruga_status check(ruga_design_def* def) {
    bool arcs = def->design == RUGA_DESIGN_ARCS;
    def->size[1] = def->size[1] > 0 ? def->size[1] : (arcs ? 2 : 1) * def->size[0];
    def->size[2] = def->size[2] > 0 ? def->size[2] : 2 * RUGA_PI;
    for (int i = 0; i < 2; i++) {
        if (def->cells[i] < 1 || def->cells[i] > MOST_CELLS) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: %d cells are not between 1 and %d", names[def->design],
                             def->cells[i], MOST_CELLS);
        }
    }
    double most = def->design == RUGA_DESIGN_MIURA ? RUGA_PI / 2 : RUGA_PI;
    return def->size[0] > 0 && def->fold >= 0 && def->fold <= most
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT, "%s: the size is above 0, and the fold at most %g degrees",
                           names[def->design], most * 180 / RUGA_PI);
}

ruga_status ruga_crease_pattern_design(const ruga_design_def* given, ruga_crease_pattern* pattern) {
    ruga_design_def def = *given;
    const pen p = {pattern, def.fold};
    ruga_status status = RUGA_OK;
    *pattern = (ruga_crease_pattern){0};
    RUGA_TRY(check(&def));
    switch (def.design) {
    case RUGA_DESIGN_MIURA:
        RUGA_TRY_DONE(draw_miura(&p, &def));
        break;
    case RUGA_DESIGN_WATERBOMB:
        RUGA_TRY_DONE(draw_waterbombs(&p, &def));
        break;
    case RUGA_DESIGN_PLEATS:
        RUGA_TRY_DONE(draw_pleats(&p, &def));
        break;
    default:
        RUGA_TRY_DONE(draw_arcs(&p, &def));
        break;
    }
    RUGA_TRY_DONE(ruga_crease_pattern_arrange(pattern, 1e-9 * (def.size[0] + def.size[1])));
    for (int i = 0; i < pattern->note_count; i++) {
        ruga_release(pattern->note[i]); // of lines that were drawn one by one
    }
    pattern->note_count = 0;
done:
    if (status != RUGA_OK) {
        ruga_crease_pattern_clear(pattern);
    }
    return status;
}
