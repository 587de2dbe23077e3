// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A stage's nodes are copies of those of the stage before (crease/nest.h): x, v and what a free skin started
// from are theirs, so that material, velocities and momenta do not change when it is cut, the new seams are
// closed, and averages over clusters are what they were (copies of a vertex share its weight). Hinges that
// were there keep their angle, rest angle and plastic history. A new crease begins at rest at the angle that
// the sheet has there; from then on its rest angle moves to where it is to be, as it does from the drawn one
// in the first frame of any scene. What a state had factorised is made anew.
#include "solver/stages.h"

#include "core/memory.h"
#include "crease/nest.h"
#include "solver/start.h"

#include <string.h>

// ---- models --------------------------------------------------------------------------------------------

// hinge [hinges of the finer] from segments to hinges.
static ruga_status take_hinges(const ruga_creases* fine, const ruga_creases* coarse, const int* segment,
                               int** hinge) {
    int* of_segment = NULL;
    RUGA_TRY(RUGA_NEW(*hinge, fine->hinge_count));
    RUGA_TRY(RUGA_NEW(of_segment, coarse->cut.segment_count));
    for (int h = 0; h < coarse->hinge_count; h++) {
        of_segment[coarse->segment[h]] = h;
    }
    for (int h = 0; h < fine->hinge_count; h++) {
        int s = segment[fine->segment[h]];
        (*hinge)[h] = s < 0 ? -1 : of_segment[s];
    }
    ruga_release(of_segment);
    return RUGA_OK;
}

ruga_status ruga_stage_follow(ruga_model* model, const ruga_model* before) {
    ruga_nest nest;
    int nodes = model->mesh.vertex_count;
    RUGA_TRY(ruga_nest_create(&model->creases->cut, &before->creases->cut, &nest));
    model->parent_node = nest.node;
    nest.node = NULL;
    ruga_status status = take_hinges(model->creases, before->creases, nest.segment, &model->parent_hinge);
    ruga_nest_clear(&nest);
    RUGA_TRY(status);
    if (!before->started) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_NEW(model->started, 3 * (size_t)nodes));
    for (int n = 0; n < nodes; n++) {
        memcpy(model->started + 3 * (size_t)n, before->started + 3 * (size_t)model->parent_node[n],
               3 * sizeof *model->started);
    }
    return RUGA_OK;
}

void ruga_stage_release_holds(ruga_model* model, const ruga_model* before) {
    model->any_skin_held = false;
    for (int i = 0; i < 3 * model->mesh.vertex_count; i++) {
        int was = before->skin_handle[3 * model->parent_node[i / 3] + i % 3];
        // Handles are the user's here, but for those of solver/anchor.c, which each stage chooses anew.
        model->skin_handle[i] = model->skin_handle[i] >= 0 && was < model->handle_count ? was : -1;
        model->any_skin_held = model->any_skin_held || model->skin_handle[i] >= 0;
    }
}

ruga_status ruga_stages_join(ruga_model* whole) {
    int nodes = whole->mesh.vertex_count;
    const ruga_model* later = whole;
    const int *node = NULL, *hinge = NULL;
    for (int k = whole->stage_count - 1; k >= 0; k--) {
        ruga_stage* stage = &whole->stage[k];
        int hinges = whole->creases->hinge_count;
        RUGA_TRY(RUGA_NEW(stage->node, nodes));
        RUGA_TRY(RUGA_NEW(stage->hinge, hinges));
        for (int n = 0; n < nodes; n++) {
            stage->node[n] = later->parent_node[node ? node[n] : n];
        }
        for (int h = 0; h < hinges; h++) {
            int own = hinge ? hinge[h] : h;
            stage->hinge[h] = own < 0 ? -1 : later->parent_hinge[own];
        }
        later = stage->model;
        node = stage->node;
        hinge = stage->hinge;
    }
    return RUGA_OK;
}

const ruga_model* ruga_stage_model(const ruga_model* whole, int stage) {
    return stage < whole->stage_count ? whole->stage[stage].model : whole;
}

int ruga_stage_of_frame(const ruga_model* whole, int frame) {
    int stage = 0;
    while (stage < whole->stage_count && whole->stage[stage].end < frame) {
        stage++;
    }
    return stage;
}

// ---- states --------------------------------------------------------------------------------------------

static void carry_nodes(const ruga_model* model, const double* from, double* to) {
    for (int n = 0; n < model->mesh.vertex_count; n++) {
        memcpy(to + 3 * (size_t)n, from + 3 * (size_t)model->parent_node[n], 3 * sizeof *to);
    }
}

static void carry_hinges(const ruga_model* model, const ruga_hinges* from, const double* x, ruga_hinges* to) {
    for (int h = 0; h < to->count; h++) {
        int was = model->parent_hinge[h];
        bool fold = h < to->segments, same = was >= 0 && (was < from->segments) == fold;
        same = same && (!fold || from->creases->hinge[was].curve == to->creases->hinge[h].curve);
        to->near[h] = ruga_hinge_measure(&to->creases->hinge[h], x, was >= 0 ? &from->near[was] : NULL, NULL);
        if (same) {
            to->rest[h] = from->rest[was];
        } else if (fold) {
            to->rest[h] = to->near[h];
        } // what divides the material is at rest as it is drawn
        if (same && fold) {
            to->set[h] = from->set[was];
            to->flow[h] = from->flow[was];
        }
    }
}

void ruga_stage_carry(const ruga_state* from, ruga_state* to) {
    const ruga_model* model = to->model;
    size_t nodes = 3 * (size_t)model->lattice.node_count;
    to->frame = from->frame;
    to->time = to->skin->time = from->time;
    to->start = from->start;
    to->skin->shift_memory = from->skin->shift_memory;
    to->skin->proximal = from->skin->proximal;
    carry_nodes(model, from->x, to->x);
    carry_nodes(model, from->embedded, to->embedded);
    memcpy(to->q, from->q, nodes * sizeof *to->q);
    memcpy(to->v, from->v, nodes * sizeof *to->v);
    carry_hinges(model, from->skin->hinges, to->x, to->skin->hinges);
    if (to->moving) {
        ruga_moving_carry(from->moving, to->moving, to->x);
    }
}
