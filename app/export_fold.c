// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/export_fold.h"

#include "app/console.h"
#include "app/frames.h"
#include "core/memory.h"
#include "crease/curve.h"
#include "io/fold.h"

#include <math.h>

typedef struct folded {
    ruga_result_reader* reader;
    const ruga_mesh* mesh;
    const ruga_result_creases* creases; // NULL = none
    ruga_frame_range range;
    ruga_connectivity edges;
    ruga_crease_pattern pattern;
    int frame_count;
    ruga_fold_frame* frame;
    double *position, *angle; // [frames][V][3], [frames][E]
    double* measured;         // [S]
} folded;

static ruga_status add_edges(folded* f) {
    for (int e = 0; e < f->edges.edge_count; e++) {
        const int *end = f->edges.edge[e], *side = f->edges.edge_triangle[e];
        ruga_assignment assignment =
            side[0] < 0 || side[1] < 0 ? RUGA_ASSIGNMENT_BORDER : RUGA_ASSIGNMENT_FLAT;
        RUGA_TRY(ruga_crease_pattern_add_edge(&f->pattern, end[0], end[1], assignment, NAN));
    }
    for (int s = 0; f->creases && s < f->creases->segment_count; s++) {
        const int* end = f->creases->segment + 2 * (size_t)s;
        int e = ruga_edge_between(&f->edges, end[0], end[1]);
        if (e >= 0) {
            f->pattern.edge[e].assignment = ruga_assignment_from_letter(f->creases->assignment[s]);
        }
    }
    return RUGA_OK;
}

static ruga_status make_pattern(folded* f) {
    RUGA_TRY(ruga_connectivity_create(f->mesh, &f->edges));
    for (int v = 0; v < f->mesh->vertex_count; v++) {
        RUGA_TRY(ruga_crease_pattern_add_vertex(&f->pattern, f->mesh->position + 3 * (size_t)v));
    }
    RUGA_TRY(add_edges(f));
    for (int t = 0; t < f->mesh->triangle_count; t++) {
        RUGA_TRY(ruga_crease_pattern_add_face(&f->pattern));
        for (int i = 0; i < 3; i++) {
            RUGA_TRY(
                ruga_crease_pattern_add_corner(&f->pattern, f->mesh->triangle[3 * (size_t)t + (size_t)i]));
        }
    }
    return RUGA_OK;
}

static ruga_status read_frame(folded* f, int k) {
    size_t edges = (size_t)f->pattern.edge_count;
    double *x = f->position + (size_t)k * 3 * (size_t)f->mesh->vertex_count,
           *angle = f->angle + (size_t)k * edges;
    f->frame[k] = (ruga_fold_frame){.position = x, .angle = f->creases ? angle : NULL};
    RUGA_TRY(ruga_result_read_frame(f->reader, f->range.first + k, &f->frame[k].time, x, NULL, NULL));
    for (size_t e = 0; e < edges; e++) {
        angle[e] = NAN;
    }
    if (!f->creases) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_result_read_creases(f->reader, f->range.first + k, f->measured, NULL, NULL));
    for (int s = 0; s < f->creases->segment_count; s++) {
        const int* end = f->creases->segment + 2 * (size_t)s;
        int e = ruga_edge_between(&f->edges, end[0], end[1]);
        if (e >= 0) {
            angle[e] = f->measured[s];
        }
    }
    return RUGA_OK;
}

static ruga_status read_frames(folded* f) {
    f->frame_count = f->range.last - f->range.first + 1;
    size_t frames = (size_t)f->frame_count;
    RUGA_TRY(RUGA_NEW(f->frame, frames));
    RUGA_TRY(RUGA_NEW(f->position, frames * 3 * (size_t)f->mesh->vertex_count));
    RUGA_TRY(RUGA_NEW(f->angle, frames * (size_t)f->pattern.edge_count));
    RUGA_TRY(RUGA_NEW(f->measured, f->creases ? f->creases->segment_count : 0));
    for (int k = 0; k < f->frame_count; k++) {
        RUGA_TRY(read_frame(f, k));
    }
    return RUGA_OK;
}

ruga_status ruga_export_fold(const ruga_arguments* arguments, const char* path) {
    static const char* const others[] = {"--subdivide", "--unit"};
    ruga_status status = RUGA_OK;
    folded f = {.reader = NULL};
    for (int i = 0; i < 2; i++) {
        if (ruga_given(arguments, others[i])) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: a FOLD file holds the mesh as it is, in metres", others[i]);
        }
    }
    RUGA_TRY(ruga_check_output(path));
    RUGA_TRY(ruga_open_result(ruga_operand(arguments), &f.reader));
    f.mesh = ruga_result_mesh(f.reader);
    f.creases = ruga_result_reader_header(f.reader)->creases;
    RUGA_TRY_DONE(ruga_choose_frames(arguments, ruga_result_frame_count(f.reader), true, &f.range));
    RUGA_TRY_DONE(make_pattern(&f));
    RUGA_TRY_DONE(read_frames(&f));
    RUGA_TRY_DONE(ruga_fold_write(path, &f.pattern, "m", false, f.frame_count, f.frame));
    ruga_say(arguments, "%s\n", path);
done:
    ruga_connectivity_clear(&f.edges);
    ruga_crease_pattern_clear(&f.pattern);
    ruga_release(f.frame);
    ruga_release(f.position);
    ruga_release(f.angle);
    ruga_release(f.measured);
    ruga_result_reader_close(&f.reader);
    return status;
}
