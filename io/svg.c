// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Crease patterns drawn as SVG, with the colours of Origami Simulator (Ghassaei, Demaine and Gershenfeld
// 2018) and tools like it. The hue of a stroke says what a line is, so that nearby shades do as well:
//   black             border          red     mountain        blue    valley
//   yellow, cyan, grey  flat          magenta unassigned      green   cut
// For mountains and valleys an opacity below 1 is the fold angle as a part of 180 degrees. Strokes come from
// attributes, style="" and classes of a <style> sheet, and are inherited. A drawing is read twice: first for
// its size, which the tolerance for curves is a part of, then for its lines.
#include "io/fold.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "io/svg_path.h"
#include "io/text.h"
#include "io/writer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_DEPTH = 200, MOST_POINTS = 1000000 };
static const double WELD = 1e-4; // of the drawing's size

typedef struct style {
    ruga_svg_transform transform;
    long stroke;      // 0xrrggbb, -1 = none, -2 = of a colour that is not known
    char unknown[32]; // its text
    double opacity, stroke_opacity;
    bool hidden;
} style;

typedef struct reader {
    const ruga_xml_tag* tag;      // the last one that opened
    ruga_crease_pattern* pattern; // NULL in the first pass
    double scale, tolerance;
    double low[2], high[2];
    style stack[MOST_DEPTH];
    int depth;
    char* sheet; // text of <style>
    int sheet_length, sheet_capacity;
    bool in_sheet;
    int without_stroke, white, unknown, foreign;
    char first_unknown[32], first_foreign[32];
    int first_vertex; // of the shape at hand, whose lines share their ends
    ruga_assignment assignment; // of the shape at hand
    double angle;
} reader;

// ------------------------------------------------------------------------------- colours

static bool read_hex(ruga_slice text, long* colour) {
    if (text.at[0] != '#' || (text.length != 4 && text.length != 7)) {
        return false;
    }
    char digits[8];
    memcpy(digits, text.at + 1, text.length - 1);
    digits[text.length - 1] = '\0';
    char* end;
    long value = strtol(digits, &end, 16);
    if (*end) {
        return false;
    }
    *colour =
        text.length == 7 ? value : (value >> 8) * 0x110000 + (value >> 4 & 15) * 0x1100 + (value & 15) * 0x11;
    return true;
}

static bool read_rgb(ruga_slice text, long* colour) {
    if (text.length < 5 || memcmp(text.at, "rgb", 3) != 0) {
        return false;
    }
    const char *p = memchr(text.at, '(', text.length), *end = text.at + text.length;
    *colour = 0;
    for (int i = 0; p && i < 3; i++) {
        double value;
        p += i == 0;
        if (!ruga_svg_number(&p, end, &value)) {
            return false;
        }
        bool percent = p < end && *p == '%';
        p += percent;
        value = percent ? value * 2.55 : value;
        *colour = *colour * 256 + (value < 0 ? 0 : value > 255 ? 255 : (long)(value + 0.5));
    }
    return p != NULL;
}

static long read_colour(ruga_slice text, long before) {
    static const struct {
        const char* name;
        long colour;
    } names[] = {{"none", -1},
                 {"transparent", -1},
                 {"black", 0x000000},
                 {"red", 0xff0000},
                 {"blue", 0x0000ff},
                 {"yellow", 0xffff00},
                 {"green", 0x008000},
                 {"lime", 0x00ff00},
                 {"magenta", 0xff00ff},
                 {"fuchsia", 0xff00ff},
                 {"cyan", 0x00ffff},
                 {"aqua", 0x00ffff},
                 {"gray", 0x808080},
                 {"grey", 0x808080},
                 {"silver", 0xc0c0c0},
                 {"lightgray", 0xd3d3d3},
                 {"lightgrey", 0xd3d3d3},
                 {"white", 0xffffff},
                 {"navy", 0x000080},
                 {"maroon", 0x800000},
                 {"purple", 0x800080},
                 {"teal", 0x008080},
                 {"olive", 0x808000},
                 {"crimson", 0xdc143c},
                 {"darkred", 0x8b0000},
                 {"firebrick", 0xb22222},
                 {"darkblue", 0x00008b},
                 {"mediumblue", 0x0000cd},
                 {"royalblue", 0x4169e1},
                 {"dodgerblue", 0x1e90ff},
                 {"darkgreen", 0x006400},
                 {"forestgreen", 0x228b22},
                 {"limegreen", 0x32cd32},
                 {"gold", 0xffd700},
                 {"orange", 0xffa500},
                 {"violet", 0xee82ee},
                 {"darkgray", 0xa9a9a9},
                 {"darkgrey", 0xa9a9a9},
                 {"dimgray", 0x696969},
                 {"dimgrey", 0x696969}};
    long colour;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (ruga_slice_is(text, names[i].name)) {
            return names[i].colour;
        }
    }
    if (text.length == 0 || ruga_slice_is(text, "inherit")) {
        return before;
    }
    return read_hex(text, &colour) || read_rgb(text, &colour) ? colour : -2;
}

// By hue in steps of 60 degrees; greys by their brightness. COUNT = white, which is no line.
static ruga_assignment assignment_of(long colour) {
    double r = (double)(colour >> 16 & 255) / 255, g = (double)(colour >> 8 & 255) / 255,
           b = (double)(colour & 255) / 255;
    double most = fmax(r, fmax(g, b)), least = fmin(r, fmin(g, b));
    static const double grey = 0.25, black = 0.35, white = 0.95;
    if (most - least < grey * most || most < 0.15) {
        return most < black    ? RUGA_ASSIGNMENT_BORDER
               : least > white ? RUGA_ASSIGNMENT_COUNT
                               : RUGA_ASSIGNMENT_FLAT;
    }
    double span = most - least;
    double hue = most == r ? (g - b) / span : most == g ? 2 + (b - r) / span : 4 + (r - g) / span;
    static const ruga_assignment wheel[6] = {RUGA_ASSIGNMENT_MOUNTAIN, RUGA_ASSIGNMENT_FLAT,
                                             RUGA_ASSIGNMENT_CUT,      RUGA_ASSIGNMENT_FLAT,
                                             RUGA_ASSIGNMENT_VALLEY,   RUGA_ASSIGNMENT_UNASSIGNED};
    return wheel[((int)floor(hue + 0.5) + 6) % 6];
}

// ------------------------------------------------------------------------------- styles

static ruga_slice trim(const char* begin, const char* end) {
    while (begin < end && (*begin == ' ' || *begin == '\n' || *begin == '\t' || *begin == '\r')) {
        begin++;
    }
    while (end > begin && (end[-1] == ' ' || end[-1] == '\n' || end[-1] == '\t' || end[-1] == '\r')) {
        end--;
    }
    return (ruga_slice){begin, (size_t)(end - begin)};
}

static double read_opacity(ruga_slice text, double before) {
    const char* p = text.at;
    double value;
    if (!text.at || !ruga_svg_number(&p, text.at + text.length, &value)) {
        return before;
    }
    value = p < text.at + text.length && *p == '%' ? value / 100 : value;
    return value < 0 ? 0 : value > 1 ? 1 : value;
}

static void set_property(style* s, double outer_opacity, ruga_slice name, ruga_slice value) {
    if (ruga_slice_is(name, "stroke")) {
        s->stroke = read_colour(value, s->stroke);
        (void)snprintf(s->unknown, sizeof s->unknown, "%.*s", (int)(value.length < 31 ? value.length : 31),
                       value.at);
    } else if (ruga_slice_is(name, "opacity")) {
        s->opacity = outer_opacity * read_opacity(value, 1);
    } else if (ruga_slice_is(name, "stroke-opacity")) {
        s->stroke_opacity = read_opacity(value, s->stroke_opacity);
    } else if (ruga_slice_is(name, "display")) {
        s->hidden = s->hidden || ruga_slice_is(value, "none");
    } else if (ruga_slice_is(name, "visibility")) {
        s->hidden = s->hidden || ruga_slice_is(value, "hidden");
    }
}

// "name: value; name: value"
static void set_declarations(style* s, double outer_opacity, ruga_slice text) {
    const char *p = text.at, *end = p + text.length;
    while (p < end) {
        const char* stop = memchr(p, ';', (size_t)(end - p));
        stop = stop ? stop : end;
        const char* colon = memchr(p, ':', (size_t)(stop - p));
        if (colon) {
            set_property(s, outer_opacity, trim(p, colon), trim(colon + 1, stop));
        }
        p = stop + 1;
    }
}

// Whether a list of selectors ".a, .b" names a class.
static bool names_class(ruga_slice selectors, ruga_slice name) {
    const char *p = selectors.at, *end = p + selectors.length;
    while (p < end) {
        const char* comma = memchr(p, ',', (size_t)(end - p));
        comma = comma ? comma : end;
        ruga_slice one = trim(p, comma);
        if (one.length == name.length + 1 && one.at[0] == '.' &&
            memcmp(one.at + 1, name.at, name.length) == 0) {
            return true;
        }
        p = comma + 1;
    }
    return false;
}

static void set_class(const reader* r, style* s, double outer_opacity, ruga_slice name) {
    const char *p = r->sheet, *end = p ? p + r->sheet_length : p;
    while (p && p < end) {
        const char* open = memchr(p, '{', (size_t)(end - p));
        const char* close = open ? memchr(open, '}', (size_t)(end - open)) : NULL;
        if (!close) {
            return;
        }
        if (names_class((ruga_slice){p, (size_t)(open - p)}, name)) {
            set_declarations(s, outer_opacity, (ruga_slice){open + 1, (size_t)(close - open - 1)});
        }
        p = close + 1;
    }
}

static ruga_status fail(const reader* r, const char* what) {
    return ruga_fail(RUGA_BAD_INPUT, "%s:%d: %s", r->tag->path, r->tag->line, what);
}

// The style of the tag at hand, from that around it.
static ruga_status read_style(const reader* r, const style* outer, style* s) {
    static const char* const names[] = {"stroke", "opacity", "stroke-opacity", "display", "visibility"};
    *s = *outer;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        ruga_slice value = ruga_xml_attribute(r->tag, names[i]);
        if (value.at) {
            set_property(s, outer->opacity, (ruga_slice){names[i], strlen(names[i])},
                         trim(value.at, value.at + value.length));
        }
    }
    ruga_slice classes = ruga_xml_attribute(r->tag, "class");
    for (const char *p = classes.at, *end = p ? p + classes.length : p; p && p < end;) {
        const char* stop = memchr(p, ' ', (size_t)(end - p));
        stop = stop ? stop : end;
        set_class(r, s, outer->opacity, (ruga_slice){p, (size_t)(stop - p)});
        p = stop + 1;
    }
    ruga_slice own = ruga_xml_attribute(r->tag, "style");
    if (own.at) {
        set_declarations(s, outer->opacity, own);
    }
    ruga_slice moved = ruga_xml_attribute(r->tag, "transform");
    if (moved.at) {
        ruga_svg_transform transform;
        if (!ruga_svg_parse_transform(moved, &transform)) {
            return fail(r, "the transform cannot be read");
        }
        s->transform = ruga_svg_compose(&transform, &outer->transform);
    }
    return RUGA_OK;
}

// ------------------------------------------------------------------------------- shapes

// The vertex of a shape at a place: its first or its last one, or a new one.
static ruga_status add_end(reader* r, const double place[2], int* vertex) {
    ruga_crease_pattern* p = r->pattern;
    // y points down in a drawing, up in a pattern: seen from the front, nothing is mirrored.
    const double x[3] = {r->scale * place[0], -r->scale * place[1], 0};
    const int old[2] = {p->vertex_count - 1, r->first_vertex};
    for (int k = 0; k < 2; k++) {
        *vertex = old[k];
        if (*vertex >= r->first_vertex && *vertex < p->vertex_count &&
            memcmp(p->position[*vertex], x, sizeof x) == 0) {
            return RUGA_OK;
        }
    }
    *vertex = p->vertex_count;
    return ruga_crease_pattern_add_vertex(p, x);
}

static ruga_status take_line(const double from[2], const double to[2], void* context) {
    reader* r = context;
    const double* const end[2] = {from, to};
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 2; i++) {
            if (!isfinite(end[k][i])) {
                return fail(r, "the numbers of this shape are too large to be drawn");
            }
            r->low[i] = fmin(r->low[i], end[k][i]);
            r->high[i] = fmax(r->high[i], end[k][i]);
        }
    }
    if (!r->pattern || (from[0] == to[0] && from[1] == to[1])) {
        return RUGA_OK;
    }
    int v[2];
    RUGA_TRY(add_end(r, from, &v[0]));
    RUGA_TRY(add_end(r, to, &v[1]));
    return ruga_crease_pattern_add_edge(r->pattern, v[0], v[1], r->assignment, r->angle);
}

// Attributes that are lengths, 0 where missing: names [count], value [count].
static ruga_status read_lengths(const reader* r, int count, const char* const* names, double* value) {
    for (int i = 0; i < count; i++) {
        ruga_slice text = ruga_xml_attribute(r->tag, names[i]);
        const char *p = text.at, *end = p ? p + text.length : p;
        value[i] = 0;
        bool good = !p || ruga_svg_number(&p, end, &value[i]);
        ruga_slice unit = p ? trim(p, end) : text;
        if (!good || (unit.length > 0 && !ruga_slice_is(unit, "px"))) {
            return ruga_fail(RUGA_BAD_INPUT, "%s:%d: %s=\"%.40s\" is not a number without a unit or in px",
                             r->tag->path, r->tag->line, names[i], text.at);
        }
    }
    return RUGA_OK;
}

static ruga_status draw_listed_points(const reader* r, const ruga_svg_pen* pen, bool closed) {
    ruga_slice text = ruga_xml_attribute(r->tag, "points");
    double(*point)[2] = NULL;
    int count = 0, capacity = 0;
    ruga_status status = RUGA_OK;
    const char* p = text.at;
    double x[2];
    while (text.at && count < MOST_POINTS && ruga_svg_number(&p, text.at + text.length, &x[0]) &&
           ruga_svg_number(&p, text.at + text.length, &x[1])) {
        RUGA_TRY_DONE(RUGA_RESERVE(point, capacity, (size_t)count + 1));
        memcpy(point[count++], x, sizeof x);
    }
    if (text.at && trim(p, text.at + text.length).length > 0) {
        status = fail(r, "the list of points cannot be read");
        goto done;
    }
    RUGA_TRY_DONE(ruga_svg_draw_points(pen, count, (const double(*)[2])point, closed));
done:
    ruga_release(point);
    return status;
}

static ruga_status draw_path(const reader* r, const ruga_svg_pen* pen) {
    ruga_slice data = ruga_xml_attribute(r->tag, "d");
    const char* bad = NULL;
    if (!data.at) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_svg_draw_path(pen, data, &bad));
    if (bad) {
        int length = (int)(data.at + data.length - bad);
        return ruga_fail(RUGA_BAD_INPUT, "%s:%d: path data cannot be read from \"%.*s\" on", r->tag->path,
                         r->tag->line, length < 20 ? length : 20, bad);
    }
    return RUGA_OK;
}

// Of the radii of its corners one that is missing is like the other.
static ruga_status draw_rectangle(const reader* r, const ruga_svg_pen* pen) {
    static const char* const names[] = {"x", "y", "width", "height", "rx", "ry"};
    double v[6];
    RUGA_TRY(read_lengths(r, 6, names, v));
    for (int i = 4; i < 6; i++) {
        v[i] = ruga_xml_attribute(r->tag, names[i]).at ? v[i] : v[9 - i];
    }
    return ruga_svg_draw_rectangle(pen, v, v + 2, v + 4);
}

static ruga_status draw_shape(reader* r, const ruga_svg_pen* pen) {
    ruga_slice name = r->tag->name;
    if (ruga_slice_is(name, "path")) {
        return draw_path(r, pen);
    }
    if (ruga_slice_is(name, "polyline") || ruga_slice_is(name, "polygon")) {
        return draw_listed_points(r, pen, ruga_slice_is(name, "polygon"));
    }
    double v[4];
    if (ruga_slice_is(name, "line")) {
        static const char* const ends[] = {"x1", "y1", "x2", "y2"};
        RUGA_TRY(read_lengths(r, 4, ends, v));
        const double p[2][2] = {{v[0], v[1]}, {v[2], v[3]}};
        return ruga_svg_draw_points(pen, 2, p, false);
    }
    if (ruga_slice_is(name, "rect")) {
        return draw_rectangle(r, pen);
    }
    static const char* const round[2][4] = {{"cx", "cy", "rx", "ry"}, {"cx", "cy", "r", "r"}};
    RUGA_TRY(read_lengths(r, 4, round[ruga_slice_is(name, "circle")], v));
    return ruga_svg_draw_ellipse(pen, v, v + 2);
}

static bool is_one_of(ruga_slice name, const char* const* list) {
    for (; *list; list++) {
        if (ruga_slice_is(name, *list)) {
            return true;
        }
    }
    return false;
}

static ruga_status read_shape(reader* r, const style* s) {
    if (s->hidden || s->stroke < 0) {
        r->without_stroke += s->stroke == -1;
        if (s->stroke == -2 && r->unknown++ == 0) {
            memcpy(r->first_unknown, s->unknown, sizeof r->first_unknown);
        }
        return RUGA_OK;
    }
    r->assignment = assignment_of(s->stroke);
    if (r->assignment == RUGA_ASSIGNMENT_COUNT) {
        r->white++;
        return RUGA_OK;
    }
    double part = s->opacity * s->stroke_opacity;
    bool folds = r->assignment == RUGA_ASSIGNMENT_MOUNTAIN || r->assignment == RUGA_ASSIGNMENT_VALLEY;
    r->first_vertex = r->pattern ? r->pattern->vertex_count : 0;
    r->angle = folds && part < 1 ? (r->assignment == RUGA_ASSIGNMENT_VALLEY ? part : -part) * RUGA_PI : NAN;
    const ruga_svg_pen pen = {s->transform, r->tolerance, take_line, r};
    return draw_shape(r, &pen);
}

static ruga_status open_tag(const ruga_xml_tag* tag, void* context) {
    static const char* const shapes[] = {"path", "polyline", "polygon", "line",
                                         "rect", "circle",   "ellipse", NULL};
    static const char* const foreign[] = {"use", "text", "image", "foreignObject", NULL};
    static const char* const unseen[] = {"defs", "symbol", "clipPath", "mask", "pattern", "marker", NULL};
    reader* r = context;
    style s;
    r->tag = tag;
    RUGA_TRY(read_style(r, &r->stack[r->depth], &s));
    s.hidden = s.hidden || is_one_of(tag->name, unseen);
    r->in_sheet = ruga_slice_is(tag->name, "style") && !r->pattern; // the second pass has it already
    if (is_one_of(tag->name, shapes)) {
        RUGA_TRY(read_shape(r, &s));
    }
    if (is_one_of(tag->name, foreign) && !s.hidden && r->foreign++ == 0) {
        (void)snprintf(r->first_foreign, sizeof r->first_foreign, "%.*s in line %d", (int)tag->name.length,
                       tag->name.at, tag->line);
    }
    if (r->depth + 1 == MOST_DEPTH) {
        return fail(r, "elements are nested too deeply");
    }
    r->stack[++r->depth] = s;
    return RUGA_OK;
}

static ruga_status close_tag(void* context) {
    reader* r = context;
    r->depth--;
    r->in_sheet = false;
    return RUGA_OK;
}

static ruga_status take_text(ruga_slice text, void* context) {
    reader* r = context;
    if (r->in_sheet) {
        RUGA_TRY(RUGA_RESERVE(r->sheet, r->sheet_capacity, (size_t)r->sheet_length + text.length));
        memcpy(r->sheet + r->sheet_length, text.at, text.length);
        r->sheet_length += (int)text.length;
    }
    return RUGA_OK;
}

static ruga_status read_drawing(reader* r, const ruga_text* text) {
    const ruga_xml_events events = {open_tag, close_tag, take_text, r};
    r->depth = r->without_stroke = r->white = r->unknown = r->foreign = 0;
    r->stack[0] = (style){.transform = {{1, 0, 0, 1, 0, 0}}, .stroke = -1, .opacity = 1, .stroke_opacity = 1};
    for (int i = 0; i < 2; i++) {
        r->low[i] = INFINITY;
        r->high[i] = -INFINITY;
    }
    return ruga_xml_read(text->path, text->data, text->size, &events);
}

static ruga_status read_pattern(reader* r, const ruga_text* text, double tolerance,
                                ruga_crease_pattern* pattern) {
    RUGA_TRY(read_drawing(r, text));
    double size = hypot(r->high[0] - r->low[0], r->high[1] - r->low[1]);
    if (!(size > 0) || !isfinite(size)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: the drawing has no stroked lines: a crease pattern is drawn in strokes",
                         text->path);
    }
    r->pattern = pattern;
    r->tolerance = tolerance * size;
    RUGA_TRY(read_drawing(r, text));
    if (r->without_stroke > 0) {
        RUGA_TRY(
            ruga_crease_pattern_note(pattern, "%d shapes without a stroke were left out", r->without_stroke));
    }
    if (r->unknown > 0) {
        RUGA_TRY(ruga_crease_pattern_note(pattern,
                                          "%d shapes were left out, as the colour of their stroke is not "
                                          "known; the first is '%s': write #rrggbb",
                                          r->unknown, r->first_unknown));
    }
    if (r->white > 0) {
        RUGA_TRY(ruga_crease_pattern_note(pattern, "%d white shapes were left out", r->white));
    }
    if (r->foreign > 0) {
        RUGA_TRY(ruga_crease_pattern_note(
            pattern, "%d elements that are not shapes were left out, the first a %s: draw them as paths", r->foreign,
            r->first_foreign));
    }
    ruga_status status = ruga_crease_pattern_arrange(pattern, WELD * size * r->scale);
    return status == RUGA_OK ? status : ruga_fail_prefix(status, "%s", text->path);
}

ruga_status ruga_svg_read(const char* path, double scale, double tolerance, ruga_crease_pattern* pattern) {
    ruga_text text;
    reader* r = NULL;
    *pattern = (ruga_crease_pattern){0};
    RUGA_TRY(ruga_text_open(path, &text));
    ruga_status status = RUGA_NEW_ZERO(r, 1);
    if (status == RUGA_OK) {
        r->scale = scale;
        status = read_pattern(r, &text, tolerance, pattern);
    }
    ruga_release(r ? r->sheet : NULL);
    ruga_release(r);
    ruga_text_close(&text);
    if (status != RUGA_OK) {
        ruga_crease_pattern_clear(pattern);
    }
    return status;
}

// ------------------------------------------------------------------------------- writing

static void begin_path(ruga_writer* w, ruga_assignment assignment) {
    static const char* const colours[RUGA_ASSIGNMENT_COUNT] = {"#000000", "#ff0000", "#0000ff",
                                                               "#ffff00", "#ff00ff", "#00ff00"};
    (void)fprintf(w->file, "<path stroke=\"%s\" d=\"M", colours[assignment]);
}

static void write_point(ruga_writer* w, const double x[3], double unit) {
    ruga_writer_double(w, x[0] / unit);
    ruga_writer_double(w, -x[1] / unit);
}

static void write_head(ruga_writer* w, const ruga_crease_pattern* p, double unit) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int v = 0; v < p->vertex_count; v++) {
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], p->position[v][i] / unit);
            high[i] = fmax(high[i], p->position[v][i] / unit);
        }
    }
    double wide = high[0] - low[0], tall = high[1] - low[1], margin = 0.02 * fmax(wide, tall);
    const double box[4] = {low[0] - margin, -high[1] - margin, wide + 2 * margin, tall + 2 * margin};
    (void)fputs("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"", w->file);
    for (int i = 0; i < 4; i++) {
        ruga_writer_double(w, box[i]);
    }
    (void)fputs("\" fill=\"none\" stroke-width=\"", w->file);
    ruga_writer_double(w, 0.1 * margin);
    (void)fputs("\">\n", w->file);
}

ruga_status ruga_svg_write(const char* path, const ruga_crease_pattern* pattern, double unit) {
    ruga_curves curves = {0};
    ruga_writer w;
    ruga_status status = ruga_crease_pattern_curves(pattern, &(ruga_curve){.label = 0}, true, &curves);
    if (status == RUGA_OK) {
        status = ruga_writer_open(path, &w);
    }
    if (status != RUGA_OK) {
        ruga_curves_clear(&curves);
        return status;
    }
    write_head(&w, pattern, unit);
    for (int e = 0; e < pattern->edge_count; e++) {
        const ruga_crease_pattern_edge* edge = &pattern->edge[e];
        if (edge->assignment == RUGA_ASSIGNMENT_BORDER) {
            begin_path(&w, edge->assignment);
            write_point(&w, pattern->position[edge->vertex[0]], unit);
            write_point(&w, pattern->position[edge->vertex[1]], unit);
            (void)fputs("\"/>\n", w.file);
        }
    }
    for (int k = 0; k < curves.count; k++) {
        const ruga_curve* c = &curves.curve[k];
        begin_path(&w, pattern->edge[c->label].assignment);
        for (int i = 0; i < c->point_count; i++) {
            write_point(&w, c->point[i], unit);
        }
        (void)fputs(c->closed ? "z\"/>\n" : "\"/>\n", w.file);
    }
    (void)fputs("</svg>\n", w.file);
    ruga_curves_clear(&curves);
    return ruga_writer_close(&w, RUGA_OK);
}
