// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A state's life, what it shows, the stage of its model that it is at (stages.h), and its restart vector.
#include "solver/state.h"

#include "core/memory.h"
#include "core/progress.h"
#include "solver/stages.h"
#include "solver/start.h"

#include <math.h>
#include <string.h>

// ---- life ----------------------------------------------------------------------------------------------

static ruga_status create_vectors(ruga_state* state) {
    const ruga_model* model = state->model;
    size_t n = 3 * (size_t)model->mesh.vertex_count, nodes = 3 * (size_t)model->lattice.node_count;
    RUGA_TRY(RUGA_NEW_ZERO(state->deviation, 3 * (size_t)model->dense.volume.node_count));
    RUGA_TRY(RUGA_NEW_ZERO(state->displacement, 3 * (size_t)model->dense.volume.node_count));
    RUGA_TRY(RUGA_NEW_ZERO(state->x, n));
    RUGA_TRY(RUGA_NEW_ZERO(state->embedded, n));
    RUGA_TRY(RUGA_NEW_ZERO(state->next_embedded, n));
    RUGA_TRY(RUGA_NEW_ZERO(state->old_x, n));
    RUGA_TRY(RUGA_NEW_ZERO(state->anchor, n));
    const ruga_model* whole = state->whole;
    if (whole->creases) {
        RUGA_TRY(RUGA_NEW_ZERO(state->shown, 3 * (size_t)ruga_model_shown(whole)->vertex_count));
        RUGA_TRY(RUGA_NEW_ZERO(state->shown_embedded, 3 * (size_t)ruga_model_shown(whole)->vertex_count));
    }
    if (state->stage < whole->stage_count) {
        RUGA_TRY(RUGA_NEW_ZERO(state->spread, 3 * (size_t)whole->mesh.vertex_count));
        RUGA_TRY(RUGA_NEW_ZERO(state->angle, whole->creases->segment_count));
        RUGA_TRY(RUGA_NEW_ZERO(state->rest, whole->creases->segment_count));
    }
    RUGA_TRY(RUGA_NEW_ZERO(state->q, nodes));
    RUGA_TRY(RUGA_NEW_ZERO(state->v, nodes));
    RUGA_TRY(RUGA_NEW_ZERO(state->old_q, nodes));
    return RUGA_NEW_ZERO(state->strain, model->mesh.triangle_count);
}

// Places of this stage's nodes, at the nodes of the whole.
static const double* of_whole(const ruga_state* state, const double* x) {
    if (state->stage == state->whole->stage_count) {
        return x;
    }
    const int* node = state->whole->stage[state->stage].node;
    for (int n = 0; n < state->whole->mesh.vertex_count; n++) {
        memcpy(state->spread + 3 * (size_t)n, x + 3 * (size_t)node[n], 3 * sizeof *x);
    }
    return state->spread;
}

// A crease that is still to come has the angle of the sheet, and rests there.
static void show_angles(ruga_state* state) {
    const ruga_creases* creases = state->whole->creases;
    const ruga_hinges* hinges = state->skin->hinges;
    for (int h = 0; h < creases->segment_count; h++) {
        int own = state->whole->stage[state->stage].hinge[h];
        bool there = own >= 0 && own < hinges->segments &&
                     hinges->creases->hinge[own].curve == creases->hinge[h].curve;
        state->angle[h] = own >= 0 ? hinges->near[own] : ruga_creases_shown_angle(creases, h, state->shown);
        state->rest[h] = there ? hinges->rest[own] : state->angle[h];
    }
}

// What is shown follows what moves.
void ruga_state_show(ruga_state* state) {
    const ruga_creases* creases = state->whole->creases;
    if (creases) {
        ruga_cut_material(&creases->cut, of_whole(state, state->embedded), state->shown_embedded);
        ruga_cut_material(&creases->cut, of_whole(state, state->x), state->shown);
    }
    if (state->angle) {
        show_angles(state);
    }
}

static void set_start(ruga_state* state) {
    const ruga_model* model = state->model;
    size_t n = 3 * (size_t)model->mesh.vertex_count;
    memcpy(state->x, ruga_start_shape(model), n * sizeof *state->x);
    memcpy(state->embedded, ruga_start_shape(model), n * sizeof *state->x);
    if (!model->has_interior) {
        if (state->skin->hinges) {
            ruga_start_hinges(model, state->skin->hinges);
        }
        return;
    }
    memcpy(state->q, model->lattice.rest, 3 * (size_t)model->lattice.node_count * sizeof *state->q);
    ruga_lattice_embed(&model->lattice, state->q, state->embedded);
    memcpy(state->x, state->embedded, n * sizeof *state->x);
}

ruga_status ruga_state_make(const ruga_model* whole, int stage, ruga_state** out) {
    ruga_status status = RUGA_OK;
    ruga_state* state = NULL;
    const ruga_model* model = ruga_stage_model(whole, stage);
    RUGA_TRY(RUGA_NEW_ZERO(state, 1));
    state->whole = whole;
    state->stage = stage;
    state->model = model;
    RUGA_TRY_DONE(create_vectors(state));
    RUGA_TRY_DONE(ruga_progress("analysing the skin", 0));
    RUGA_TRY_DONE(ruga_skin_create(model, &state->skin));
    state->skin->embedded = state->embedded;
    state->skin->anchor = state->anchor;
    if (model->has_interior && !ruga_model_is_prescribed(model)) {
        RUGA_TRY_DONE(ruga_progress("analysing the interior", 0));
        RUGA_TRY_DONE(ruga_interior_create(model, state->skin, &state->interior));
    }
    if (model->dense.volume.node_count > 0) {
        RUGA_TRY_DONE(ruga_progress("analysing the volume", 0));
        RUGA_TRY_DONE(ruga_volume_solver_create(&model->dense.volume, model->dense.held, model->solver.seed,
                                                &state->volume));
    }
    set_start(state);
    if (model->skin.motion == RUGA_SKIN_DYNAMIC) {
        RUGA_TRY_DONE(ruga_moving_create(model, state->skin, &state->moving));
        RUGA_TRY_DONE(ruga_moving_start(state->moving, state->x));
    }
done:
    if (status != RUGA_OK) {
        ruga_state_destroy(&state);
    }
    *out = state;
    return status;
}

void ruga_state_destroy(ruga_state** state_pointer) {
    ruga_state* state = *state_pointer;
    if (!state) {
        return;
    }
    ruga_interior_destroy(&state->interior);
    ruga_moving_destroy(&state->moving);
    ruga_skin_destroy(&state->skin);
    ruga_volume_solver_destroy(&state->volume);
    void* const owned[] = {state->x,
                           state->embedded,
                           state->q,
                           state->v,
                           state->old_q,
                           state->old_x,
                           state->next_embedded,
                           state->anchor,
                           state->strain,
                           state->deviation,
                           state->displacement,
                           state->shown,
                           state->shown_embedded,
                           state->spread,
                           state->angle,
                           state->rest};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    ruga_release(state);
    *state_pointer = NULL;
}

int ruga_state_frame(const ruga_state* state) {
    return state->frame;
}

double ruga_state_time(const ruga_state* state) {
    return state->time;
}

const double* ruga_state_positions(const ruga_state* state) {
    return state->shown ? state->shown : state->x;
}

const double* ruga_state_embedded(const ruga_state* state) {
    return state->shown ? state->shown_embedded : state->embedded;
}

const double* ruga_state_crease_angles(const ruga_state* state) {
    return state->angle ? state->angle : state->skin->hinges ? state->skin->hinges->near : NULL;
}

const double* ruga_state_crease_rests(const ruga_state* state) {
    return state->rest ? state->rest : state->skin->hinges ? state->skin->hinges->rest : NULL;
}

double ruga_state_gap(const ruga_state* state) {
    const ruga_creases* creases = state->whole->creases;
    return creases ? ruga_cut_gap(&creases->cut, of_whole(state, state->x)) : 0;
}

void ruga_state_segment_gaps(const ruga_state* state, double* gap) {
    const ruga_creases* creases = state->whole->creases;
    const double* x = of_whole(state, state->x);
    for (int h = 0; creases && h < creases->segment_count; h++) {
        const int* end = creases->cut.segment[creases->segment[h]].end;
        gap[h] = fmax(ruga_cut_gap_at(&creases->cut, end[0], x), ruga_cut_gap_at(&creases->cut, end[1], x));
    }
}

ruga_status ruga_state_handle_forces(ruga_state* state, double* force) {
    for (int i = 0; i < 3 * state->model->handle_count && state->moving; i++) {
        force[i] = NAN; // seams and damping push, too, in impulses that no one sums
    }
    return state->moving ? RUGA_OK : ruga_skin_handle_forces(state->skin, state->x, force);
}

const double* ruga_state_lattice(const ruga_state* state) {
    return state->model->has_interior ? state->q : NULL;
}

// ---- stages --------------------------------------------------------------------------------------------

// The state becomes another one, which is destroyed; what it shows stays in its place.
static void become(ruga_state* state, ruga_state* other) {
    ruga_state old = *state;
    *state = *other;
    state->shown = old.shown;
    state->shown_embedded = old.shown_embedded;
    old.shown = other->shown;
    old.shown_embedded = other->shown_embedded;
    *other = old;
    ruga_state_destroy(&other);
    ruga_state_show(state);
}

// Cuts the creases of the next stage.
ruga_status ruga_state_enter_next_stage(ruga_state* state) {
    ruga_state* next;
    RUGA_TRY(ruga_state_make(state->whole, state->stage + 1, &next));
    ruga_stage_carry(state, next);
    become(state, next);
    return RUGA_OK;
}

static ruga_status go_to_stage(ruga_state* state, int stage) {
    if (stage < state->stage) {
        ruga_state* first;
        RUGA_TRY(ruga_state_make(state->whole, 0, &first));
        become(state, first);
    }
    while (state->stage < stage) {
        RUGA_TRY(ruga_state_enter_next_stage(state));
    }
    return RUGA_OK;
}

// ---- restart -------------------------------------------------------------------------------------------

enum { RESTART_SCALARS = 5 }; // frame, time, shift memory, proximal factor, whether a kept factor exists

static int own_restart_size(const ruga_model* model) {
    return RESTART_SCALARS + 3 * model->mesh.vertex_count + 6 * model->lattice.node_count +
           3 * model->dense.volume.node_count + ruga_hinges_restart_size(model->creases) +
           ruga_moving_restart_size(model);
}

int ruga_state_restart_size(const ruga_model* whole) {
    int size = own_restart_size(whole);
    for (int k = 0; k < whole->stage_count; k++) {
        int own = own_restart_size(whole->stage[k].model);
        size = own > size ? own : size;
    }
    return size;
}

void ruga_state_save(const ruga_state* state, double* restart) {
    size_t n = 3 * (size_t)state->model->mesh.vertex_count,
           nodes = 3 * (size_t)state->model->lattice.node_count;
    *restart++ = state->frame;
    *restart++ = state->time;
    *restart++ = state->skin->shift_memory;
    *restart++ = state->skin->proximal;
    bool kept = state->skin->factor_exact && state->skin->factor_right;
    *restart++ = kept ? 1 + state->skin->in_single : 0;
    memcpy(restart, state->x, n * sizeof *restart);
    memcpy(restart + n, state->q, nodes * sizeof *restart);
    memcpy(restart + n + nodes, state->v, nodes * sizeof *restart);
    memcpy(restart + n + 2 * nodes, state->deviation,
           3 * (size_t)state->model->dense.volume.node_count * sizeof *restart);
    if (state->skin->hinges) {
        ruga_hinges_save(state->skin->hinges,
                         restart + n + 2 * nodes + 3 * (size_t)state->model->dense.volume.node_count);
    }
    if (state->moving) { // last of all
        int size = own_restart_size(state->model) - RESTART_SCALARS;
        ruga_moving_save(state->moving, restart + size - ruga_moving_restart_size(state->model));
    }
}

ruga_status ruga_state_load(ruga_state* state, const double* restart) {
    RUGA_TRY(go_to_stage(state, ruga_stage_of_frame(state->whole, (int)restart[0])));
    const ruga_model* model = state->model;
    size_t n = 3 * (size_t)model->mesh.vertex_count, nodes = 3 * (size_t)model->lattice.node_count;
    state->frame = (int)restart[0];
    state->time = restart[1];
    state->skin->shift_memory = restart[2];
    state->skin->proximal = restart[3];
    bool kept = restart[4] > 0;
    state->skin->single_proves = restart[4] > 1; // as then
    restart += RESTART_SCALARS;
    memcpy(state->x, restart, n * sizeof *restart);
    memcpy(state->q, restart + n, nodes * sizeof *restart);
    memcpy(state->v, restart + n + nodes, nodes * sizeof *restart);
    memcpy(state->deviation, restart + n + 2 * nodes,
           3 * (size_t)model->dense.volume.node_count * sizeof *restart);
    if (state->skin->hinges) {
        ruga_hinges_load(state->skin->hinges,
                         restart + n + 2 * nodes + 3 * (size_t)model->dense.volume.node_count);
    }
    if (state->moving) {
        int size = own_restart_size(model) - RESTART_SCALARS;
        ruga_moving_load(state->moving, restart + size - ruga_moving_restart_size(model));
    }
    if (model->has_interior) {
        ruga_lattice_embed(&model->lattice, state->q, state->embedded);
    }
    state->skin->time = state->time;
    ruga_state_show(state);
    // The factor that the next frame starts from is made again from the state it was made at.
    return kept && model->solves_skin ? ruga_skin_factor(state->skin, state->x, 0, 0) : RUGA_OK;
}
