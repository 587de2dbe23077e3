// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// FOLD is JSON with parallel arrays vertices_*, edges_* and faces_*. A field that a frame with frame_inherit
// does not have is its parent's (frame_parent, 0 = the file's own frame). Edges may be missing where there
// are faces: then they are those of the faces, border where only one face has them.
#include "io/fold.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "crease/faces.h"
#include "io/polygons.h"
#include "io/text.h"
#include "io/writer.h"
#include "mesh/region.h"

#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double WELD = 1e-6; // of the pattern's size
enum { MOST_PARENTS = 64, MOST_ENTRIES = 50000000 };

typedef struct reader {
    const char* path;
    json_t* root;
    const json_t* chain[MOST_PARENTS]; // the frame, then what it inherits from
    int chain_count;
    double scale;
    ruga_crease_pattern* pattern;
} reader;

static ruga_status load(const char* path, json_t** root) {
    ruga_text text;
    json_error_t error;
    RUGA_TRY(ruga_text_load(path, &text));
    *root = json_loadb(text.at, (size_t)(text.end - text.at), 0, &error);
    ruga_text_close(&text);
    if (!*root) {
        return ruga_fail(RUGA_BAD_INPUT, "%s:%d: not JSON: %s", path, error.line, error.text);
    }
    if (!json_is_object(*root)) {
        json_decref(*root);
        *root = NULL;
        return ruga_fail(RUGA_BAD_INPUT, "%s: a FOLD file is a JSON object", path);
    }
    return RUGA_OK;
}

static ruga_status fail(const reader* r, const char* field, size_t index, const char* what) {
    return ruga_fail(RUGA_BAD_INPUT, "%s: %s[%zu] %s", r->path, field, index, what);
}

// ------------------------------------------------------------------------------- frames

static ruga_status find_chain(reader* r, int frame) {
    const json_t* frames = json_object_get(r->root, "file_frames");
    for (int k = frame; r->chain_count < MOST_PARENTS;) {
        const json_t* at = k == 0 ? r->root : json_array_get(frames, (size_t)k - 1);
        if (!json_is_object(at)) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: frame %d does not exist: there are %zu", r->path, k,
                             json_array_size(frames) + 1);
        }
        r->chain[r->chain_count++] = at;
        if (k == 0 || !json_is_true(json_object_get(at, "frame_inherit"))) {
            return RUGA_OK;
        }
        const json_t* parent = json_object_get(at, "frame_parent");
        k = json_is_integer(parent) && json_integer_value(parent) >= 0 && json_integer_value(parent) < INT_MAX
                ? (int)json_integer_value(parent)
                : 0;
    }
    return ruga_fail(RUGA_BAD_INPUT, "%s: frame %d inherits from itself", r->path, frame);
}

static const json_t* field(const reader* r, const char* name) {
    for (int i = 0; i < r->chain_count; i++) {
        const json_t* found = json_object_get(r->chain[i], name);
        if (found) {
            return found;
        }
    }
    return NULL;
}

// An array field with `count` entries (any number where negative), or NULL where it is missing.
static ruga_status array(const reader* r, const char* name, long count, const char* as,
                         const json_t** found) {
    *found = field(r, name);
    if (!*found || json_is_null(*found)) {
        *found = NULL;
        return RUGA_OK;
    }
    size_t size = json_array_size(*found);
    if (!json_is_array(*found) || size > MOST_ENTRIES) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: %s is not an array that can be read", r->path, name);
    }
    if (count >= 0 && size != (size_t)count) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: %s has %zu entries, but %s has %ld", r->path, name, size, as,
                         count);
    }
    return RUGA_OK;
}

static ruga_status read_unit(reader* r) {
    static const struct {
        const char* name;
        double metres;
    } units[] = {{"unit", 1},  {"in", 0.0254}, {"pt", 0.0254 / 72}, {"m", 1},
                 {"cm", 0.01}, {"mm", 0.001},  {"um", 1e-6},        {"nm", 1e-9}};
    const json_t* unit = field(r, "frame_unit");
    const char* name = json_string_value(unit);
    for (size_t i = 0; name && i < sizeof units / sizeof *units; i++) {
        if (strcmp(name, units[i].name) == 0) {
            r->scale *= units[i].metres;
            return RUGA_OK;
        }
    }
    return unit ? ruga_fail(RUGA_BAD_INPUT, "%s: frame_unit is not one of unit, in, pt, m, cm, mm, um, nm",
                            r->path)
                : RUGA_OK;
}

// ------------------------------------------------------------------------------- vertices, edges, faces

static ruga_status read_vertices(reader* r) {
    const json_t* coords;
    RUGA_TRY(array(r, "vertices_coords", -1, "", &coords));
    if (!coords || json_array_size(coords) == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the frame has no vertices_coords", r->path);
    }
    for (size_t v = 0; v < json_array_size(coords); v++) {
        const json_t* at = json_array_get(coords, v);
        size_t size = json_array_size(at);
        double x[3] = {0, 0, 0};
        if (size != 2 && size != 3) {
            return fail(r, "vertices_coords", v, "does not have two or three coordinates");
        }
        for (size_t i = 0; i < size; i++) {
            const json_t* number = json_array_get(at, i);
            x[i] = r->scale * json_number_value(number);
            if (!json_is_number(number) || !isfinite(x[i])) {
                return fail(r, "vertices_coords", v, "is not made of finite numbers");
            }
        }
        RUGA_TRY(ruga_crease_pattern_add_vertex(r->pattern, x));
    }
    return RUGA_OK;
}

static ruga_status read_vertex(const reader* r, const json_t* number, const char* name, size_t index,
                               int* v) {
    if (!json_is_integer(number) || json_integer_value(number) < 0 ||
        json_integer_value(number) >= r->pattern->vertex_count) {
        return fail(r, name, index, "names a vertex that does not exist");
    }
    *v = (int)json_integer_value(number);
    return RUGA_OK;
}

static ruga_status read_edge(const reader* r, size_t e, const json_t* ends, const json_t* letter,
                             const json_t* angle) {
    int v[2] = {0, 0};
    if (json_array_size(ends) != 2) {
        return fail(r, "edges_vertices", e, "does not have two vertices");
    }
    RUGA_TRY(read_vertex(r, json_array_get(ends, 0), "edges_vertices", e, &v[0]));
    RUGA_TRY(read_vertex(r, json_array_get(ends, 1), "edges_vertices", e, &v[1]));
    ruga_assignment assignment = RUGA_ASSIGNMENT_UNASSIGNED;
    if (letter) {
        const char* text = json_string_value(letter);
        assignment = text && strlen(text) == 1 ? ruga_assignment_from_letter(text[0]) : RUGA_ASSIGNMENT_COUNT;
        // J, a join, is a line that is not there for folding.
        assignment = text && strcmp(text, "J") == 0 ? RUGA_ASSIGNMENT_FLAT : assignment;
        if (assignment == RUGA_ASSIGNMENT_COUNT) {
            return fail(r, "edges_assignment", e, "is not one of B, M, V, F, U, C, J");
        }
    }
    double turn = NAN;
    if (angle && !json_is_null(angle)) {
        turn = json_number_value(angle) * RUGA_PI / 180;
        if (!json_is_number(angle) || !(fabs(turn) <= 2 * RUGA_PI)) {
            return fail(r, "edges_foldAngle", e, "is not an angle in degrees");
        }
    }
    if ((assignment == RUGA_ASSIGNMENT_MOUNTAIN && turn > 0) ||
        (assignment == RUGA_ASSIGNMENT_VALLEY && turn < 0)) {
        RUGA_TRY(ruga_crease_pattern_note(
            r->pattern,
            "edges_foldAngle[%zu] is %g degrees, although edges_assignment calls the line a "
            "%s: the angle counts",
            e, turn * 180 / RUGA_PI, turn > 0 ? "mountain" : "valley"));
    }
    // An angle of a border or a cut says nothing.
    bool folds = assignment != RUGA_ASSIGNMENT_BORDER && assignment != RUGA_ASSIGNMENT_CUT;
    return ruga_crease_pattern_add_edge(r->pattern, v[0], v[1], assignment, folds ? turn : NAN);
}

static ruga_status read_edges(const reader* r) {
    const json_t *ends, *letters, *angles;
    RUGA_TRY(array(r, "edges_vertices", -1, "", &ends));
    if (!ends) {
        return RUGA_OK;
    }
    long count = (long)json_array_size(ends);
    RUGA_TRY(array(r, "edges_assignment", count, "edges_vertices", &letters));
    RUGA_TRY(array(r, "edges_foldAngle", count, "edges_vertices", &angles));
    for (size_t e = 0; e < (size_t)count; e++) {
        RUGA_TRY(
            read_edge(r, e, json_array_get(ends, e), json_array_get(letters, e), json_array_get(angles, e)));
    }
    return RUGA_OK;
}

static ruga_status read_faces(const reader* r) {
    const json_t* faces;
    RUGA_TRY(array(r, "faces_vertices", -1, "", &faces));
    for (size_t f = 0; f < json_array_size(faces); f++) {
        const json_t* face = json_array_get(faces, f);
        if (json_array_size(face) < 3 || json_array_size(face) > RUGA_POLYGON_CORNERS) {
            return fail(r, "faces_vertices", f, "does not have three vertices");
        }
        RUGA_TRY(ruga_crease_pattern_add_face(r->pattern));
        for (size_t i = 0; i < json_array_size(face); i++) {
            int v = 0;
            RUGA_TRY(read_vertex(r, json_array_get(face, i), "faces_vertices", f, &v));
            RUGA_TRY(ruga_crease_pattern_add_corner(r->pattern, v));
        }
    }
    return RUGA_OK;
}

typedef struct face_edge {
    int low, high;
} face_edge;

static int compare_face_edges(const void* a, const void* b) {
    const face_edge *p = a, *q = b;
    return p->low != q->low ? (p->low < q->low ? -1 : 1) : (p->high > q->high) - (p->high < q->high);
}

// The edges of the faces, sorted by their vertices.
static ruga_status edges_from_faces(const reader* r) {
    ruga_crease_pattern* p = r->pattern;
    face_edge* list = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(list, p->corner_count));
    for (int f = 0; f < p->face_count; f++) {
        for (int k = p->face_start[f]; k < p->face_start[f + 1]; k++) {
            int a = p->corner[k], b = p->corner[k + 1 < p->face_start[f + 1] ? k + 1 : p->face_start[f]];
            list[k] = (face_edge){a < b ? a : b, a < b ? b : a};
        }
    }
    if (p->corner_count > 1) {
        qsort(list, (size_t)p->corner_count, sizeof *list, compare_face_edges);
    }
    for (int i = 0, end; i < p->corner_count; i = end) {
        for (end = i; end < p->corner_count && compare_face_edges(&list[i], &list[end]) == 0;) {
            end++;
        }
        RUGA_TRY_DONE(ruga_crease_pattern_add_edge(
            p, list[i].low, list[i].high, end - i > 1 ? RUGA_ASSIGNMENT_UNASSIGNED : RUGA_ASSIGNMENT_BORDER,
            NAN));
    }
done:
    ruga_release(list);
    return status;
}

// Faces of a flat pattern run counter-clockwise; files do not all keep to that.
static void turn_faces_up(ruga_crease_pattern* p) {
    for (int f = 0; f < p->face_count; f++) {
        int begin = p->face_start[f], end = p->face_start[f + 1];
        double area = 0;
        for (int k = begin; k < end; k++) {
            const double *a = p->position[p->corner[k]],
                         *b = p->position[p->corner[k + 1 < end ? k + 1 : begin]];
            area += a[0] * b[1] - a[1] * b[0];
        }
        for (int i = begin, j = end - 1; area < 0 && i < j; i++, j--) {
            int swap = p->corner[i];
            p->corner[i] = p->corner[j];
            p->corner[j] = swap;
        }
    }
}

static double size_of(const ruga_crease_pattern* p, int axes) {
    double square = 0;
    for (int i = 0; i < axes; i++) {
        double low = INFINITY, high = -INFINITY;
        for (int v = 0; v < p->vertex_count; v++) {
            low = fmin(low, p->position[v][i]);
            high = fmax(high, p->position[v][i]);
        }
        square += (high - low) * (high - low);
    }
    return sqrt(square);
}

static bool is_flat(const ruga_crease_pattern* p) {
    double size = size_of(p, 2);
    for (int v = 0; v < p->vertex_count; v++) {
        if (fabs(p->position[v][2] - p->position[0][2]) > WELD * size) {
            return false;
        }
    }
    return true;
}

static bool says_folded(const reader* r) {
    const json_t* classes = field(r, "frame_classes");
    for (size_t i = 0; i < json_array_size(classes); i++) {
        const char* name = json_string_value(json_array_get(classes, i));
        if (name && strcmp(name, "foldedForm") == 0) {
            return true;
        }
    }
    return false;
}

static ruga_status read_frame(reader* r, int frame) {
    ruga_crease_pattern* p = r->pattern;
    RUGA_TRY(find_chain(r, frame));
    RUGA_TRY(read_unit(r));
    RUGA_TRY(read_vertices(r));
    RUGA_TRY(read_edges(r));
    RUGA_TRY(read_faces(r));
    if (p->edge_count == 0) {
        RUGA_TRY(edges_from_faces(r));
    }
    if (p->edge_count == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the frame has neither edges_vertices nor faces_vertices",
                         r->path);
    }
    p->folded = says_folded(r) || !is_flat(p);
    if (p->folded) {
        return RUGA_OK;
    }
    turn_faces_up(p);
    if (p->face_count == 0) {
        RUGA_TRY(ruga_crease_pattern_note(p, "faces_vertices is missing: faces were found from the lines"));
    }
    ruga_status status = ruga_crease_pattern_arrange(p, WELD * size_of(p, 2));
    return status == RUGA_OK ? status : ruga_fail_prefix(status, "%s", r->path);
}

ruga_status ruga_fold_read(const char* path, int frame, double scale, ruga_crease_pattern* pattern) {
    *pattern = (ruga_crease_pattern){0};
    reader r = {.path = path, .scale = scale, .pattern = pattern};
    RUGA_TRY(load(path, &r.root));
    ruga_status status = read_frame(&r, frame);
    json_decref(r.root);
    if (status != RUGA_OK) {
        ruga_crease_pattern_clear(pattern);
    }
    return status;
}

// ------------------------------------------------------------------------------- mesh

static bool is_straight_on(const double a[3], const double b[3], const double c[3]) {
    double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {c[0] - b[0], c[1] - b[1]};
    double cross = u[0] * v[1] - u[1] * v[0], dot = u[0] * v[0] + u[1] * v[1];
    static const double slack = 1e-9;
    return dot > 0 && fabs(cross) <= slack * dot;
}

typedef struct outline {
    const ruga_crease_pattern* pattern;
    int* degree;      // [V] rims that meet there
    int (*around)[2]; // [V] the first two of them
    bool* done;       // [E]
    int segment_count;
    int (*segment)[2]; // [E]
} outline;

static int far_end(const outline* o, int e, int v) {
    const int* end = o->pattern->edge[e].vertex;
    return end[0] == v ? end[1] : end[0];
}

// A vertex that a crease has on a straight side is left out.
static bool is_left_out(const outline* o, int v) {
    double(*x)[3] = o->pattern->position;
    return o->degree[v] == 2 &&
           is_straight_on(x[far_end(o, o->around[v][0], v)], x[v], x[far_end(o, o->around[v][1], v)]);
}

// The straight side that begins with rim e at its vertex v.
static void add_side(outline* o, int e, int v) {
    int from = v;
    for (;;) {
        o->done[e] = true;
        v = far_end(o, e, v);
        if (!is_left_out(o, v)) {
            break;
        }
        e = o->around[v][0] == e ? o->around[v][1] : o->around[v][0];
    }
    memcpy(o->segment[o->segment_count++], (const int[2]){from, v}, sizeof *o->segment);
}

static ruga_status find_outline(outline* o) {
    const ruga_crease_pattern* p = o->pattern;
    RUGA_TRY(RUGA_NEW_ZERO(o->degree, p->vertex_count));
    RUGA_TRY(RUGA_NEW(o->around, p->vertex_count));
    RUGA_TRY(RUGA_NEW_ZERO(o->done, p->edge_count));
    RUGA_TRY(RUGA_NEW(o->segment, p->edge_count));
    for (int e = 0; e < p->edge_count; e++) {
        for (int end = 0; end < 2 && p->edge[e].rim; end++) {
            int v = p->edge[e].vertex[end];
            if (o->degree[v] < 2) {
                o->around[v][o->degree[v]] = e;
            }
            o->degree[v]++;
        }
    }
    for (int e = 0; e < p->edge_count; e++) {
        for (int end = 0; end < 2; end++) {
            int v = p->edge[e].vertex[end];
            if (p->edge[e].rim && !o->done[e] && !is_left_out(o, v)) {
                add_side(o, e, v);
            }
        }
    }
    return RUGA_OK;
}

static ruga_status mesh_region(const ruga_crease_pattern* p, const char* path, ruga_mesh* mesh) {
    outline o = {.pattern = p};
    double(*point)[2] = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(find_outline(&o));
    RUGA_TRY_DONE(RUGA_NEW(point, p->vertex_count));
    // Only the ends of sides are corners.
    memset(o.degree, -1, (size_t)p->vertex_count * sizeof *o.degree);
    int count = 0;
    for (int s = 0; s < o.segment_count; s++) {
        for (int end = 0; end < 2; end++) {
            int v = o.segment[s][end];
            if (o.degree[v] < 0) {
                memcpy(point[count], p->position[v], sizeof *point);
                o.degree[v] = count++;
            }
            o.segment[s][end] = o.degree[v];
        }
    }
    status = ruga_mesh_from_region(count, (const double(*)[2])point, o.segment_count,
                                   (const int(*)[2])o.segment, mesh);
    status = status == RUGA_OK ? status : ruga_fail_prefix(status, "%s", path);
done:
    ruga_release(point);
    ruga_release(o.degree);
    ruga_release(o.around);
    ruga_release(o.done);
    ruga_release(o.segment);
    return status;
}

// panel [faces]: remeshing keeps the borders of groups, and so the folds.
static ruga_status add_faces(const ruga_crease_pattern* p, const int* panel, ruga_polygons* polygons) {
    for (int v = 0; v < p->vertex_count; v++) {
        RUGA_TRY(ruga_polygons_add_vertex(polygons, p->position[v]));
    }
    for (int f = 0; f < p->face_count; f++) {
        char name[32];
        int length = snprintf(name, sizeof name, "panel %d", panel[f]);
        RUGA_TRY(ruga_polygons_set_group(polygons, 0, name, (size_t)length));
        RUGA_TRY(ruga_polygons_add(polygons, 0));
        for (int k = p->face_start[f]; k < p->face_start[f + 1]; k++) {
            RUGA_TRY(ruga_polygons_add_corner(polygons, p->corner[k], -1));
        }
    }
    return RUGA_OK;
}

static ruga_status mesh_faces(const ruga_crease_pattern* p, const char* path, ruga_mesh* mesh) {
    ruga_polygons polygons;
    ruga_status status = RUGA_OK;
    int *panel = NULL, count;
    ruga_polygons_begin(&polygons);
    RUGA_TRY_DONE(RUGA_NEW(panel, p->face_count));
    RUGA_TRY_DONE(ruga_crease_pattern_panels(p, &count, panel));
    RUGA_TRY_DONE(add_faces(p, panel, &polygons));
    RUGA_TRY_DONE(ruga_polygons_finish(&polygons, path, mesh));
done:
    ruga_polygons_clear(&polygons);
    ruga_release(panel);
    return status;
}

ruga_status ruga_crease_pattern_mesh(const ruga_crease_pattern* pattern, const char* path, ruga_mesh* mesh) {
    if (pattern->face_count == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: the %s", path,
                         pattern->folded ? "folded form has no faces_vertices, and faces are found in flat patterns alone"
                                         : "crease pattern has no faces");
    }
    return pattern->folded ? mesh_faces(pattern, path, mesh) : mesh_region(pattern, path, mesh);
}

// ------------------------------------------------------------------------------- writing

// Numbers are written by ruga_writer_double, so that they read back as the same bits.
static void write_positions(ruga_writer* w, int count, const double* x, bool flat) {
    (void)fprintf(w->file, "\"vertices_coords\": [");
    for (int v = 0; v < count; v++) {
        (void)fprintf(w->file, v ? ",\n  [" : "\n  [");
        for (int i = 0; i < (flat ? 2 : 3); i++) {
            (void)fputs(i ? "," : "", w->file);
            ruga_writer_double(w, x[3 * (size_t)v + (size_t)i]);
        }
        (void)fputs("]", w->file);
    }
    (void)fputs("]", w->file);
}

static void write_angles(ruga_writer* w, int count, const double* angle) {
    (void)fputs(",\n\"edges_foldAngle\": [", w->file);
    for (int e = 0; e < count; e++) {
        (void)fputs(e ? "," : "", w->file);
        if (isnan(angle[e])) {
            (void)fputs(" null", w->file);
        } else {
            ruga_writer_double(w, angle[e] * 180 / RUGA_PI);
        }
    }
    (void)fputs("]", w->file);
}

static void write_topology(ruga_writer* w, const ruga_crease_pattern* p) {
    (void)fputs(",\n\"edges_vertices\": [", w->file);
    for (int e = 0; e < p->edge_count; e++) {
        (void)fprintf(w->file, "%s[%d, %d]", e ? ", " : "", p->edge[e].vertex[0], p->edge[e].vertex[1]);
    }
    (void)fputs("],\n\"edges_assignment\": [", w->file);
    for (int e = 0; e < p->edge_count; e++) {
        (void)fprintf(w->file, "%s\"%c\"", e ? ", " : "", ruga_assignment_letter(p->edge[e].assignment));
    }
    (void)fputs(p->face_count > 0 ? "],\n\"faces_vertices\": [" : "", w->file);
    for (int f = 0; f < p->face_count; f++) {
        (void)fputs(f ? ", [" : "[", w->file);
        for (int k = p->face_start[f]; k < p->face_start[f + 1]; k++) {
            (void)fprintf(w->file, "%s%d", k > p->face_start[f] ? ", " : "", p->corner[k]);
        }
        (void)fputs("]", w->file);
    }
    (void)fputs("]", w->file);
}

ruga_status ruga_fold_write(const char* path, const ruga_crease_pattern* pattern, const char* unit, bool flat,
                            int frame_count, const ruga_fold_frame* frame) {
    RUGA_ASSERT(frame_count > 0);
    ruga_writer w;
    RUGA_TRY(ruga_writer_open(path, &w));
    (void)fprintf(w.file,
                  "{\"file_spec\": 1.2,\n\"file_creator\": \"ruga %s\",\n\"file_classes\": [\"%s\"],\n"
                  "\"frame_classes\": [\"%s\"],\n\"frame_attributes\": [\"%s\"],\n\"frame_unit\": \"%s\",\n",
                  RUGA_VERSION, frame_count > 1 ? "animation" : "singleModel",
                  flat ? "creasePattern" : "foldedForm", flat ? "2D" : "3D", unit);
    for (int k = 0; k < frame_count; k++) {
        if (k > 0) {
            (void)fprintf(
                w.file,
                "%s\n {\"frame_parent\": 0, \"frame_inherit\": true, \"frame_classes\": [\"foldedForm\"], "
                "\"frame_attributes\": [\"3D\"],\n",
                k == 1 ? ",\n\"file_frames\": [" : ",");
        }
        (void)fputs("\"frame_title\": \"t =", w.file);
        ruga_writer_double(&w, frame[k].time);
        (void)fputs(" s\",\n", w.file);
        write_positions(&w, pattern->vertex_count, frame[k].position, flat && k == 0);
        if (frame[k].angle) {
            write_angles(&w, pattern->edge_count, frame[k].angle);
        }
        if (k == 0) {
            write_topology(&w, pattern);
        } else {
            (void)fputs("}", w.file);
        }
    }
    (void)fputs(frame_count > 1 ? "]}\n" : "}\n", w.file);
    return ruga_writer_close(&w, RUGA_OK);
}
