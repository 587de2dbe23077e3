// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A Bezier curve of degree n is within h^2 / 8 max |B''| of a polyline with steps h in its parameter, and
// |B''| is at most n (n - 1) times the largest second difference of its control points: that gives the number
// of steps. Arcs are elliptic arcs by their centre (SVG 1.1, F.6.5), in steps of angle from the same bound.
// Transforms come first, so that the tolerance is one of the drawing.
#include "io/svg_path.h"

#include "core/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_STEPS = 1000 };

typedef struct drawer {
    const ruga_svg_pen* pen;
    double at[2], start[2];
    double control[2]; // last control point, for S and T
    char last;         // last command, upper case
} drawer;

ruga_svg_transform ruga_svg_compose(const ruga_svg_transform* a, const ruga_svg_transform* b) {
    const double *p = a->m, *q = b->m;
    return (ruga_svg_transform){{q[0] * p[0] + q[2] * p[1], q[1] * p[0] + q[3] * p[1],
                                 q[0] * p[2] + q[2] * p[3], q[1] * p[2] + q[3] * p[3],
                                 q[0] * p[4] + q[2] * p[5] + q[4], q[1] * p[4] + q[3] * p[5] + q[5]}};
}

static void apply(const ruga_svg_transform* t, const double x[2], double y[2]) {
    double first = t->m[0] * x[0] + t->m[2] * x[1] + t->m[4];
    y[1] = t->m[1] * x[0] + t->m[3] * x[1] + t->m[5];
    y[0] = first;
}

// ------------------------------------------------------------------------------- numbers and transforms

static void skip_blanks(const char** at, const char* end) {
    while (*at < end && (**at == ' ' || **at == '\t' || **at == '\n' || **at == '\r' || **at == ',')) {
        ++*at;
    }
}

bool ruga_svg_number(const char** at, const char* end, double* value) {
    skip_blanks(at, end);
    if (*at >= end || !strchr("+-.0123456789", **at)) { // not nan, inf or hexadecimal numbers
        return false;
    }
    const char* digit = *at + (**at == '+' || **at == '-');
    if (end - digit > 1 && digit[0] == '0' && (digit[1] == 'x' || digit[1] == 'X')) {
        return false;
    }
    char* stop;
    *value = strtod(*at, &stop);
    if (stop == *at || stop > end || !isfinite(*value)) {
        return false;
    }
    *at = stop;
    return true;
}

static bool transform_of(const char* name, size_t length, int count, const double v[6],
                         ruga_svg_transform* t) {
    *t = (ruga_svg_transform){{1, 0, 0, 1, 0, 0}};
    ruga_slice own = {name, length};
    double degree = RUGA_PI / 180;
    if (ruga_slice_is(own, "matrix") && count == 6) {
        memcpy(t->m, v, sizeof t->m);
    } else if (ruga_slice_is(own, "translate") && (count == 1 || count == 2)) {
        t->m[4] = v[0];
        t->m[5] = count == 2 ? v[1] : 0;
    } else if (ruga_slice_is(own, "scale") && (count == 1 || count == 2)) {
        t->m[0] = v[0];
        t->m[3] = count == 2 ? v[1] : v[0];
    } else if (ruga_slice_is(own, "rotate") && (count == 1 || count == 3)) {
        double c = cos(v[0] * degree), s = sin(v[0] * degree), x = count == 3 ? v[1] : 0,
               y = count == 3 ? v[2] : 0;
        memcpy(t->m, (const double[6]){c, s, -s, c, x - c * x + s * y, y - s * x - c * y}, sizeof t->m);
    } else if (ruga_slice_is(own, "skewX") && count == 1) {
        t->m[2] = tan(v[0] * degree);
    } else if (ruga_slice_is(own, "skewY") && count == 1) {
        t->m[1] = tan(v[0] * degree);
    } else {
        return false;
    }
    return true;
}

bool ruga_svg_parse_transform(ruga_slice text, ruga_svg_transform* transform) {
    const char *p = text.at, *end = p + text.length;
    *transform = (ruga_svg_transform){{1, 0, 0, 1, 0, 0}};
    for (skip_blanks(&p, end); p < end; skip_blanks(&p, end)) {
        const char *name = p, *open = memchr(p, '(', (size_t)(end - p));
        const char* close = open ? memchr(open, ')', (size_t)(end - open)) : NULL;
        if (!close) {
            return false;
        }
        size_t length = (size_t)(open - name);
        while (length > 0 && name[length - 1] == ' ') {
            length--;
        }
        double value[6];
        int count = 0;
        const char* q = open + 1;
        while (count < 6 && ruga_svg_number(&q, close, &value[count])) {
            count++;
        }
        ruga_svg_transform own;
        if (!transform_of(name, length, count, value, &own)) {
            return false;
        }
        // The transform nearest to the shape is the last one.
        *transform = ruga_svg_compose(&own, transform);
        p = close + 1;
    }
    return true;
}

// ------------------------------------------------------------------------------- curves

static ruga_status line_to(drawer* d, const double to[2]) {
    double a[2], b[2];
    apply(&d->pen->transform, d->at, a);
    apply(&d->pen->transform, to, b);
    memcpy(d->at, to, sizeof d->at);
    return d->pen->line(a, b, d->pen->context);
}

static int steps_for(const ruga_svg_pen* pen, double second_derivative) {
    if (pen->tolerance <= 0) {
        return 1;
    }
    double steps = ceil(sqrt(second_derivative / (8 * pen->tolerance)));
    return !(steps > 1) ? 1 : steps > MOST_STEPS ? MOST_STEPS : (int)steps;
}

// p [degree + 1][2], from d->at on
static ruga_status bezier_to(drawer* d, int degree, const double p[4][2]) {
    double q[4][2], second = 0, from[2];
    for (int i = 0; i <= degree; i++) {
        apply(&d->pen->transform, p[i], q[i]);
    }
    for (int i = 0; i + 2 <= degree; i++) {
        second = fmax(
            second, hypot(q[i][0] - 2 * q[i + 1][0] + q[i + 2][0], q[i][1] - 2 * q[i + 1][1] + q[i + 2][1]));
    }
    int steps = steps_for(d->pen, degree * (degree - 1) * second);
    memcpy(from, q[0], sizeof from);
    for (int k = 1; k <= steps; k++) {
        double t = (double)k / steps, b[4][2];
        memcpy(b, q, sizeof b);
        for (int level = degree; level > 0; level--) {
            for (int i = 0; i < level; i++) {
                b[i][0] += t * (b[i + 1][0] - b[i][0]);
                b[i][1] += t * (b[i + 1][1] - b[i][1]);
            }
        }
        if (k == steps) {
            memcpy(b[0], q[degree], sizeof b[0]);
        }
        RUGA_TRY(d->pen->line(from, b[0], d->pen->context));
        memcpy(from, b[0], sizeof from);
    }
    memcpy(d->at, p[degree], sizeof d->at);
    return RUGA_OK;
}

static double turn_between(double ux, double uy, double vx, double vy) {
    return atan2(ux * vy - uy * vx, ux * vx + uy * vy);
}

static double largest_stretch(const ruga_svg_transform* t) {
    return hypot(hypot(t->m[0], t->m[1]), hypot(t->m[2], t->m[3]));
}

// a: rx, ry, rotation in degrees, large, sweep, x, y
static ruga_status arc_to(drawer* d, const double a[7]) {
    double rx = fabs(a[0]), ry = fabs(a[1]), c = cos(a[2] * RUGA_PI / 180), s = sin(a[2] * RUGA_PI / 180);
    const double* to = a + 5;
    double hx = (d->at[0] - to[0]) / 2, hy = (d->at[1] - to[1]) / 2;
    double x = c * hx + s * hy, y = -s * hx + c * hy;
    if (rx == 0 || ry == 0 || (x == 0 && y == 0)) {
        return line_to(d, to);
    }
    double excess = x * x / (rx * rx) + y * y / (ry * ry);
    rx *= excess > 1 ? sqrt(excess) : 1; // too small a radius is made to fit
    ry *= excess > 1 ? sqrt(excess) : 1;
    double square = rx * rx * y * y + ry * ry * x * x;
    double factor =
        sqrt(fmax(0, (rx * rx * ry * ry - square) / square)) * ((a[3] != 0) == (a[4] != 0) ? -1 : 1);
    double ox = factor * rx * y / ry, oy = -factor * ry * x / rx;
    double cx = c * ox - s * oy + (d->at[0] + to[0]) / 2, cy = s * ox + c * oy + (d->at[1] + to[1]) / 2;
    double first = atan2((y - oy) / ry, (x - ox) / rx);
    double turn = turn_between((x - ox) / rx, (y - oy) / ry, (-x - ox) / rx, (-y - oy) / ry);
    turn += a[4] != 0 && turn < 0 ? 2 * RUGA_PI : a[4] == 0 && turn > 0 ? -2 * RUGA_PI : 0;
    int steps = steps_for(d->pen, turn * turn * fmax(rx, ry) * largest_stretch(&d->pen->transform));
    steps = steps < 2 ? 2 : steps;
    for (int k = 1; k < steps; k++) {
        double angle = first + turn * k / steps, u = rx * cos(angle), v = ry * sin(angle);
        const double next[2] = {cx + c * u - s * v, cy + s * u + c * v};
        RUGA_TRY(line_to(d, next));
    }
    return line_to(d, to);
}

ruga_status ruga_svg_draw_points(const ruga_svg_pen* pen, int count, const double (*point)[2], bool closed) {
    drawer d = {.pen = pen};
    for (int i = 0; i < count; i++) {
        if (i == 0) {
            memcpy(d.at, point[0], sizeof d.at);
        } else {
            RUGA_TRY(line_to(&d, point[i]));
        }
    }
    return closed && count > 2 ? line_to(&d, point[0]) : RUGA_OK;
}

ruga_status ruga_svg_draw_rectangle(const ruga_svg_pen* pen, const double corner[2], const double size[2],
                                    const double radius[2]) {
    static const int turn[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    double r[2];
    for (int i = 0; i < 2; i++) {
        r[i] = fmin(fmax(radius[i], 0), 0.5 * size[i]);
    }
    r[0] = r[1] > 0 ? r[0] : 0;
    r[1] = r[0] > 0 ? r[1] : 0;
    drawer d = {.pen = pen, .at = {corner[0], corner[1] + r[1]}};
    for (int k = 0; k < 4; k++) {
        double in[2], out[2]; // a corner is reached along X where k is odd, and left along Y
        for (int i = 0; i < 2; i++) {
            double place = corner[i] + turn[k][i] * size[i], inwards = turn[k][i] ? -r[i] : r[i];
            in[i] = place + (i == k % 2 ? 0 : inwards);
            out[i] = place + (i == k % 2 ? inwards : 0);
        }
        RUGA_TRY(k > 0 ? line_to(&d, in) : RUGA_OK);
        RUGA_TRY(r[0] > 0 ? arc_to(&d, (const double[7]){r[0], r[1], 0, 0, 1, out[0], out[1]}) : RUGA_OK);
    }
    return line_to(&d, (const double[2]){corner[0], corner[1] + r[1]});
}

ruga_status ruga_svg_draw_ellipse(const ruga_svg_pen* pen, const double center[2], const double radius[2]) {
    drawer d = {.pen = pen, .at = {center[0] + radius[0], center[1]}};
    RUGA_TRY(arc_to(&d, (const double[7]){radius[0], radius[1], 0, 0, 1, center[0] - radius[0], center[1]}));
    return arc_to(&d, (const double[7]){radius[0], radius[1], 0, 0, 1, center[0] + radius[0], center[1]});
}

// ------------------------------------------------------------------------------- commands

static int count_of(char command) {
    static const struct {
        char command;
        int count;
    } table[] = {{'M', 2}, {'L', 2}, {'H', 1}, {'V', 1}, {'C', 6},
                 {'S', 4}, {'Q', 4}, {'T', 2}, {'A', 7}, {'Z', 0}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        if (table[i].command == command) {
            return table[i].count;
        }
    }
    return -1;
}

// The numbers of one command; flags of an arc are single digits that need no blank behind them.
static bool read_numbers(const char** p, const char* end, char command, int count, double v[7]) {
    for (int i = 0; i < count; i++) {
        if (command == 'A' && (i == 3 || i == 4)) {
            skip_blanks(p, end);
            if (*p >= end || (**p != '0' && **p != '1')) {
                return false;
            }
            v[i] = *(*p)++ - '0';
        } else if (!ruga_svg_number(p, end, &v[i])) {
            return false;
        }
    }
    return true;
}

static ruga_status smooth_or_bezier(drawer* d, char command, const double v[7]) {
    bool cubic = command == 'C' || command == 'S', smooth = command == 'S' || command == 'T';
    bool follows = cubic ? d->last == 'C' || d->last == 'S' : d->last == 'Q' || d->last == 'T';
    double p[4][2];
    int degree = cubic ? 3 : 2, next = 1;
    memcpy(p[0], d->at, sizeof p[0]);
    if (smooth) {
        for (int i = 0; i < 2; i++) {
            p[1][i] = follows ? 2 * d->at[i] - d->control[i] : d->at[i];
        }
        next = 2;
    }
    for (int k = next; k <= degree; k++) {
        memcpy(p[k], v + 2 * (k - next), sizeof p[k]);
    }
    memcpy(d->control, p[degree - 1], sizeof d->control);
    return bezier_to(d, degree, (const double(*)[2])p);
}

static ruga_status obey(drawer* d, char command, const double v[7]) {
    const double to[2] = {command == 'V' ? d->at[0] : v[0], command == 'V'   ? v[0]
                                                            : command == 'H' ? d->at[1]
                                                                             : v[1]};
    switch (command) {
    case 'M':
        memcpy(d->at, v, sizeof d->at);
        memcpy(d->start, v, sizeof d->start);
        return RUGA_OK;
    case 'L':
    case 'H':
    case 'V':
        return line_to(d, to);
    case 'Z':
        return line_to(d, d->start);
    case 'A':
        return arc_to(d, v);
    default:
        return smooth_or_bezier(d, command, v);
    }
}

static void make_absolute(const drawer* d, char command, int count, double v[7]) {
    if (command == 'H' || command == 'V') {
        v[0] += d->at[command == 'V'];
        return;
    }
    for (int i = command == 'A' ? 5 : 0; i < count; i++) {
        v[i] += d->at[(command == 'A' ? i - 5 : i) % 2];
    }
}

ruga_status ruga_svg_draw_path(const ruga_svg_pen* pen, ruga_slice data, const char** bad) {
    drawer d = {.pen = pen};
    const char *p = data.at, *end = p + data.length;
    char command = 0;
    *bad = NULL;
    for (skip_blanks(&p, end); p < end; skip_blanks(&p, end)) {
        const char* here = p;
        bool letter = (*p >= 'a' && *p <= 'z') || (*p >= 'A' && *p <= 'Z');
        command = letter ? *p++ : command == 'M' ? 'L' : command == 'm' ? 'l' : command;
        bool relative = command >= 'a';
        char upper = (char)(relative ? command - 'a' + 'A' : command);
        int count = command ? count_of(upper) : -1;
        double v[7] = {0};
        if (count < 0 || (!letter && count == 0) || (d.last == 0 && upper != 'M') ||
            !read_numbers(&p, end, upper, count, v)) {
            *bad = here;
            return RUGA_OK;
        }
        if (relative) {
            make_absolute(&d, upper, count, v);
        }
        RUGA_TRY(obey(&d, upper, v));
        d.last = upper;
    }
    return RUGA_OK;
}
