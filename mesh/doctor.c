// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The mesh doctor's report: severity of each kind of defect, the list, the figures of the mesh, the sentence.
// The findings themselves are made in mesh/topology.c and mesh/geometry.c.
#include "mesh/doctor.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/examination.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LISTED = 100 }; // of each kind

const char* ruga_defect_name(ruga_defect_kind kind) {
#define NAME(code, name, sentence) name,
    static const char* const names[] = {RUGA_DEFECT_LIST(NAME)};
#undef NAME
    return names[kind];
}

const char* ruga_defect_sentence(ruga_defect_kind kind) {
#define SENTENCE(code, name, sentence) sentence,
    static const char* const sentences[] = {RUGA_DEFECT_LIST(SENTENCE)};
#undef SENTENCE
    return sentences[kind];
}

static ruga_severity severity_of(ruga_defect_kind kind, ruga_check_as as) {
    switch (kind) {
    case RUGA_DEFECT_INSIDE_OUT: // a shell has no inside: its normals may point where they like
        return as == RUGA_CHECK_SHELL ? RUGA_SEVERITY_WARNING : RUGA_SEVERITY_ERROR;
    case RUGA_DEFECT_SLIVER:
    case RUGA_DEFECT_UNUSED_VERTEX:
    case RUGA_DEFECT_NON_PLANAR_POLYGON:
    case RUGA_DEFECT_OVERLAP:
        return RUGA_SEVERITY_WARNING;
    default:
        return RUGA_SEVERITY_ERROR;
    }
}

// Midpoint of the vertices named, or else centre of the first face. A coordinate that is not finite is
// given as 0, so that a place can always be printed.
static void place_of(const ruga_mesh* mesh, const int vertex[2], const int face[2], double place[3]) {
    int at[3] = {vertex[0], vertex[1], -1};
    if (vertex[0] < 0 && face[0] >= 0) {
        memcpy(at, mesh->triangle + 3 * (size_t)face[0], sizeof at);
    }
    int count = 0;
    memset(place, 0, 3 * sizeof *place);
    for (int i = 0; i < 3; i++) {
        if (at[i] >= 0) {
            ruga_add_scaled(1, mesh->position + 3 * (size_t)at[i], place);
            count++;
        }
    }
    for (int k = 0; k < 3; k++) {
        double mean = count > 0 ? place[k] / count : 0;
        place[k] = isfinite(mean) ? mean : 0;
    }
}

ruga_status ruga_examination_add(ruga_examination* x, ruga_defect_kind kind, const int vertex[2],
                                 const int face[2]) {
    ruga_check_report* report = x->report;
    ruga_severity severity = severity_of(kind, x->as);
    report->count[kind]++;
    report->error_count += severity == RUGA_SEVERITY_ERROR;
    report->warning_count += severity == RUGA_SEVERITY_WARNING;
    if (report->count[kind] > LISTED) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_RESERVE(report->defect, x->defect_capacity, (size_t)report->defect_count + 1));
    ruga_defect* defect = &report->defect[report->defect_count++];
    *defect = (ruga_defect){kind, severity, {vertex[0], vertex[1]}, {face[0], face[1]}, {0}};
    place_of(x->mesh, vertex, face, defect->position);
    return RUGA_OK;
}

// Errors before warnings and kind by kind; within a kind in the order of finding. Insertion keeps it stable.
static void sort_defects(ruga_check_report* report) {
    for (int i = 1; i < report->defect_count; i++) {
        ruga_defect moved = report->defect[i];
        int j = i;
        for (; j > 0; j--) {
            const ruga_defect* before = &report->defect[j - 1];
            bool in_order = before->severity != moved.severity ? before->severity > moved.severity
                                                               : before->kind <= moved.kind;
            if (in_order) {
                break;
            }
            report->defect[j] = *before;
        }
        report->defect[j] = moved;
    }
}

static void measure_bounds(const ruga_examination* x) {
    ruga_check_report* report = x->report;
    bool any = false;
    for (int v = 0; v < x->mesh->vertex_count; v++) {
        const double* p = ruga_examined_point(x, v);
        if (x->component[v] < 0 || !isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) {
            continue;
        }
        for (int k = 0; k < 3; k++) {
            report->min[k] = any ? fmin(report->min[k], p[k]) : p[k];
            report->max[k] = any ? fmax(report->max[k], p[k]) : p[k];
        }
        any = true;
    }
}

// Volumes are taken about the middle of the bounds, which keeps them exact far from the origin.
static void measure_faces(const ruga_examination* x) {
    ruga_check_report* report = x->report;
    double middle[3];
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * (report->min[k] + report->max[k]);
    }
    for (int f = 0; f < x->mesh->triangle_count; f++) {
        if (x->not_finite[f]) {
            continue;
        }
        const int* v = ruga_examined_face(x, f);
        const double* a = ruga_examined_point(x, v[0]);
        double n[3], from_middle[3];
        ruga_triangle_normal(a, ruga_examined_point(x, v[1]), ruga_examined_point(x, v[2]), n);
        ruga_subtract(a, middle, from_middle);
        report->area += 0.5 * ruga_norm(n);
        report->volume += ruga_dot(from_middle, n) / 6;
    }
}

static void measure_edges(const ruga_examination* x) {
    ruga_check_report* report = x->report;
    double sum = 0;
    int count = 0;
    for (int e = 0; e < x->edge_count; e++) {
        int corner = x->edge_corner[x->edge_start[e]];
        if (x->not_finite[corner / 3]) {
            continue;
        }
        const int* v = ruga_examined_face(x, corner / 3);
        double length =
            ruga_distance(ruga_examined_point(x, v[corner % 3]), ruga_examined_point(x, v[(corner + 1) % 3]));
        report->edge_min = count == 0 ? length : fmin(report->edge_min, length);
        report->edge_max = fmax(report->edge_max, length);
        sum += length;
        count++;
    }
    report->edge_mean = count > 0 ? sum / count : 0;
}

static ruga_status examine(ruga_examination* x) {
    const ruga_mesh* mesh = x->mesh;
    RUGA_TRY(RUGA_NEW_ZERO(x->not_finite, mesh->triangle_count));
    RUGA_TRY(RUGA_NEW_ZERO(x->collapsed, mesh->triangle_count));
    RUGA_TRY(RUGA_NEW_ZERO(x->flat, mesh->triangle_count));
    if (mesh->triangle_count == 0) {
        const int none[2] = {-1, -1};
        RUGA_TRY(ruga_examination_add(x, RUGA_DEFECT_NO_FACES, none, none));
    }
    RUGA_TRY(ruga_examine_faces(x));
    RUGA_TRY(ruga_examine_topology(x));
    RUGA_TRY(ruga_examine_shape(x));
    measure_bounds(x);
    measure_faces(x);
    measure_edges(x);
    sort_defects(x->report);
    return RUGA_OK;
}

ruga_status ruga_mesh_check(const ruga_mesh* mesh, ruga_check_as as, ruga_check_report* report) {
    *report = (ruga_check_report){
        .vertex_count = mesh->vertex_count, .triangle_count = mesh->triangle_count, .genus = -1};
    ruga_examination x = {.mesh = mesh, .as = as, .report = report};
    ruga_status status = examine(&x);
    ruga_release(x.not_finite);
    ruga_release(x.collapsed);
    ruga_release(x.flat);
    ruga_release(x.edge_start);
    ruga_release(x.edge_corner);
    ruga_release(x.corner_edge);
    ruga_release(x.component);
    ruga_release(x.closed);
    if (status != RUGA_OK) {
        ruga_check_report_clear(report);
    }
    return status;
}

void ruga_check_report_clear(ruga_check_report* report) {
    ruga_release(report->defect);
    *report = (ruga_check_report){0};
}

// What a sentence about a mesh says of each kind: one, many, what to do.
static const struct wording {
    const char* one;
    const char* many;
    const char* advice;
} wordings[RUGA_DEFECT_KINDS] = {
    [RUGA_DEFECT_NO_FACES] = {"no faces", "no faces", "give a mesh with triangles"},
    [RUGA_DEFECT_NAN] = {"vertex that is not finite", "vertices that are not finite",
                         "export the mesh again"},
    [RUGA_DEFECT_OPEN_EDGE] = {"open edge", "open edges", "close the hole"},
    [RUGA_DEFECT_NON_MANIFOLD_EDGE] = {"non-manifold edge", "non-manifold edges",
                                       "leave two faces at each edge"},
    [RUGA_DEFECT_NON_MANIFOLD_VERTEX] = {"non-manifold vertex", "non-manifold vertices",
                                         "separate the parts that touch at a vertex only"},
    [RUGA_DEFECT_FLIPPED_FACE] = {"flipped face", "flipped faces", "make all faces run the same way"},
    [RUGA_DEFECT_INSIDE_OUT] = {"component inside out", "components inside out", "flip all its faces"},
    [RUGA_DEFECT_DUPLICATE_FACE] = {"duplicate face", "duplicate faces", "delete the second one"},
    [RUGA_DEFECT_DEGENERATE_FACE] = {"face without area", "faces without area", "delete or collapse it"},
    [RUGA_DEFECT_SELF_INTERSECTION] = {"self-intersection", "self-intersections",
                                       "move the faces that cross apart"},
    [RUGA_DEFECT_SLIVER] = {"sliver", "slivers", "remesh"},
    [RUGA_DEFECT_UNUSED_VERTEX] = {"unused vertex", "unused vertices", "delete it"},
    [RUGA_DEFECT_NON_PLANAR_POLYGON] = {"polygon that is not flat", "polygons that are not flat",
                                        "triangulate it"},
    [RUGA_DEFECT_OVERLAP] = {"crossing of two components", "crossings of two components",
                             "simulate them one by one"},
};

// "open edge, between vertices 5 and 9" or "open edges, the first between ...", and where.
static void describe_place(const ruga_defect* defect, bool many, char* text, size_t size) {
    char what[96] = "";
    if (defect->vertex[1] >= 0) {
        (void)snprintf(what, sizeof what, "between vertices %d and %d", defect->vertex[0], defect->vertex[1]);
    } else if (defect->vertex[0] >= 0) {
        (void)snprintf(what, sizeof what, "vertex %d", defect->vertex[0]);
    } else if (defect->face[1] >= 0) {
        (void)snprintf(what, sizeof what, "faces %d and %d", defect->face[0], defect->face[1]);
    } else if (defect->face[0] >= 0) {
        (void)snprintf(what, sizeof what, "face %d", defect->face[0]);
    }
    const double* p = defect->position;
    (void)snprintf(text, size, "%s%s%s at (%.6g, %.6g, %.6g) m", *what ? ", " : "", many ? "the first " : "",
                   what, p[0], p[1], p[2]);
}

// "; also 3 flipped faces, 14 self-intersections": errors of the other kinds.
static void describe_others(const ruga_check_report* report, ruga_defect_kind named, char* text,
                            size_t size) {
    size_t used = 0;
    *text = '\0';
    ruga_defect_kind last = named;
    for (int i = 0; i < report->defect_count; i++) {
        ruga_defect_kind kind = report->defect[i].kind;
        if (report->defect[i].severity != RUGA_SEVERITY_ERROR || kind == named || kind == last) {
            continue;
        }
        int count = report->count[kind];
        int added = snprintf(text + used, size - used, "%s %d %s", used == 0 ? "; also" : ",", count,
                             count == 1 ? wordings[kind].one : wordings[kind].many);
        used += added > 0 && (size_t)added < size - used ? (size_t)added : 0;
        last = kind;
    }
}

ruga_status ruga_check_status(const ruga_check_report* report, const char* mesh_name) {
    if (report->error_count == 0) {
        return RUGA_OK;
    }
    const ruga_defect* first = &report->defect[0];
    const struct wording* words = &wordings[first->kind];
    if (first->kind == RUGA_DEFECT_NO_FACES) {
        return ruga_fail(RUGA_BAD_MESH, "%s: %s: %s", mesh_name, words->one, words->advice);
    }
    int count = report->count[first->kind];
    char place[256];
    char others[1024];
    describe_place(first, count > 1, place, sizeof place);
    describe_others(report, first->kind, others, sizeof others);
    return ruga_fail(RUGA_BAD_MESH, "%s: %d %s%s: %s%s", mesh_name, count,
                     count == 1 ? words->one : words->many, place, words->advice, others);
}
