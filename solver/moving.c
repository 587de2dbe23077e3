// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Rest angles move linearly within a frame, from what they are to what keyframes and plastic flow make of
// them at its end (hinges.h). Handles hold nodes where they are at the start, and move them from there.
#include "solver/moving.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "solver/start.h"

#include <math.h>
#include <string.h>

struct ruga_moving {
    const ruga_model* model;
    ruga_skin* skin;
    ruga_raster raster; // of a mesh without creases
    ruga_cut cut;
    ruga_dynamic* dynamic;
    int nodes;
    double begin, duration;           // s, of the frame, or of a part of it
    double *velocity, *start, *slope; // [nodes][3]
};

void ruga_moving_destroy(ruga_moving** moving) {
    ruga_moving* m = *moving;
    if (!m) {
        return;
    }
    ruga_dynamic_destroy(&m->dynamic);
    ruga_cut_clear(&m->cut);
    ruga_raster_clear(&m->raster);
    ruga_release(m->velocity);
    ruga_release(m->start);
    ruga_release(m->slope);
    ruga_release(m);
    *moving = NULL;
}

// ---- life ----------------------------------------------------------------------------------------------

static ruga_status create_dynamic(ruga_moving* m) {
    ruga_status status = RUGA_OK;
    const ruga_model* model = m->model;
    const ruga_creases* creases = model->creases;
    ruga_dynamic_def def = ruga_default_dynamic_def();
    double* stiffness = NULL;
    bool* held = NULL;
    def.elastic.raster = creases ? &creases->raster : &m->raster;
    def.elastic.cut = creases ? &creases->cut : &m->cut;
    def.elastic.skin = model->skin;
    def.elastic.style = model->skin.creases;
    def.damping = model->skin.damping;
    def.drag = model->skin.drag;
    memcpy(def.gravity, model->gravity, sizeof def.gravity);
    RUGA_TRY_DONE(RUGA_NEW_ZERO(stiffness, def.elastic.cut->segment_count));
    for (int h = 0; creases && h < creases->segment_count; h++) {
        stiffness[creases->segment[h]] = creases->stiffness[h];
    }
    RUGA_TRY_DONE(RUGA_NEW(held, 3 * (size_t)m->nodes));
    for (int i = 0; i < 3 * m->nodes; i++) {
        held[i] = model->skin_handle[i] >= 0;
    }
    def.elastic.stiffness = stiffness;
    def.held = held;
    RUGA_TRY_DONE(ruga_dynamic_create(&def, &m->dynamic));
done:
    ruga_release(stiffness);
    ruga_release(held);
    return status;
}

ruga_status ruga_moving_create(const ruga_model* model, ruga_skin* skin, ruga_moving** moving) {
    ruga_status status = RUGA_OK;
    const ruga_curves none = {0};
    const ruga_raster_def how = ruga_default_raster_def();
    ruga_moving* m = NULL;
    *moving = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(m, 1));
    m->model = model;
    m->skin = skin;
    m->nodes = model->mesh.vertex_count;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(m->velocity, 3 * (size_t)m->nodes));
    RUGA_TRY_DONE(RUGA_NEW(m->start, 3 * (size_t)m->nodes));
    RUGA_TRY_DONE(RUGA_NEW(m->slope, 3 * (size_t)m->nodes));
    if (!model->creases) {
        RUGA_TRY_DONE(ruga_raster_create(&model->mesh, &none, &how, &m->raster));
        RUGA_TRY_DONE(ruga_cut_create(&m->raster, &m->cut));
    }
    RUGA_TRY_DONE(create_dynamic(m));
    RUGA_TRY_DONE(ruga_moving_start(m, m->start));
done:
    if (status != RUGA_OK) {
        ruga_moving_destroy(&m);
    }
    *moving = m;
    return status;
}

// ---- start ---------------------------------------------------------------------------------------------

// Brings rolled copies together, held ones too.
static ruga_status close_gaps(const ruga_moving* m, double* x) {
    ruga_status status = RUGA_OK;
    ruga_stitch* stitch = NULL;
    double* inverse = NULL;
    RUGA_TRY_DONE(RUGA_NEW(inverse, m->nodes));
    for (int n = 0; n < m->nodes; n++) {
        double mass = ruga_dynamic_mass(m->dynamic)[n];
        inverse[n] = mass > 0 ? 1 / mass : 0;
    }
    RUGA_TRY_DONE(ruga_stitch_create(&m->model->creases->sewing, inverse, &stitch));
    RUGA_TRY_DONE(ruga_stitch_close(stitch, x));
done:
    ruga_stitch_destroy(&stitch);
    ruga_release(inverse);
    return status;
}

// Angles near those that are followed: half a turn has two signs.
static void take_angles(ruga_moving* m) {
    const ruga_creases* creases = m->model->creases;
    double* angle = ruga_dynamic_elastic(m->dynamic)->angle;
    for (int h = 0; creases && h < creases->hinge_count; h++) {
        angle[creases->segment[h]] = m->skin->hinges->near[h];
    }
}

ruga_status ruga_moving_start(ruga_moving* m, double* x) {
    const ruga_start_def* start = &m->model->start;
    memcpy(x, ruga_start_shape(m->model), 3 * (size_t)m->nodes * sizeof *x);
    if (m->model->creases) {
        RUGA_TRY(close_gaps(m, x));
    }
    for (int i = 0; i < 3 * m->nodes; i++) {
        double turn[3];
        ruga_cross(start->spin, x + 3 * (size_t)(i / 3), turn);
        m->velocity[i] = m->model->skin_handle[i] >= 0 ? 0 : start->velocity[i % 3] + turn[i % 3];
    }
    ruga_dynamic_start(m->dynamic, x, m->velocity);
    if (m->model->creases) {
        ruga_start_hinges(m->model, m->skin->hinges);
    }
    take_angles(m);
    return RUGA_OK;
}

void ruga_moving_carry(const ruga_moving* from, ruga_moving* m, double* x) {
    for (int n = 0; n < m->nodes; n++) {
        size_t at = 3 * (size_t)n, was = 3 * (size_t)m->model->parent_node[n];
        memcpy(m->velocity + at, from->velocity + was, 3 * sizeof *m->velocity);
        memcpy(m->start + at, from->start + was, 3 * sizeof *m->start);
    }
    ruga_dynamic_start(m->dynamic, x, m->velocity);
    take_angles(m);
}

// ---- what drives it ------------------------------------------------------------------------------------

static void move(void* context, double time, double* x) {
    const ruga_moving* m = context;
    const ruga_model* model = m->model;
    for (int n = 0; n < m->nodes && model->any_skin_held; n++) {
        double target[3];
        int last = -1;
        for (int axis = 0; axis < 3; axis++) {
            int h = model->skin_handle[3 * n + axis];
            if (h >= 0 && h != last) {
                ruga_handle_target(&model->handles[h], time, m->start + 3 * (size_t)n, target);
                last = h;
            }
            x[3 * n + axis] = h >= 0 ? target[axis] : x[3 * n + axis];
        }
    }
}

static void load(void* context, double time, const double* x, double* force, double* rest) {
    ruga_moving* m = context;
    const ruga_creases* creases = m->model->creases;
    double unused;
    memset(m->slope, 0, 3 * (size_t)m->nodes * sizeof *m->slope);
    (void)ruga_loads_energy(m->model->loads, x, time, &unused, m->slope, NULL, NULL, NULL);
    for (int i = 0; i < 3 * m->nodes; i++) {
        force[i] -= m->slope[i];
    }
    if (creases) {
        ruga_hinges_advance(m->skin->hinges, fmin((time - m->begin) / m->duration, 1));
        for (int h = 0; h < creases->segment_count; h++) {
            rest[creases->segment[h]] = m->skin->hinges->rest[h];
        }
    }
}

// ---- steps ---------------------------------------------------------------------------------------------

static void put_energies(const ruga_moving* m, double time, const double* x, const ruga_elastic_energies* e,
                         ruga_report* report) {
    const double* mass = ruga_dynamic_mass(m->dynamic);
    memset(m->slope, 0, 3 * (size_t)m->nodes * sizeof *m->slope);
    (void)ruga_loads_energy(m->model->loads, x, time, &report->energy_external, NULL, NULL, NULL, NULL);
    report->energy_kinetic = 0;
    for (int n = 0; n < m->nodes; n++) {
        const double* v = m->velocity + 3 * (size_t)n;
        report->energy_external -= mass[n] * ruga_dot(m->model->gravity, x + 3 * (size_t)n);
        report->energy_kinetic += 0.5 * mass[n] * ruga_dot(v, v);
    }
    report->outcome = RUGA_OUTCOME_MOTION;
    report->energy_membrane = e->membrane;
    report->energy_bending = e->bending;
    report->energy_hinge = e->hinges;
    report->constraint_residual =
        m->model->creases ? ruga_cut_gap(&m->model->creases->cut, x) / m->model->mean_edge : 0;
}

void ruga_moving_measure(ruga_moving* m, double time, const double* x, ruga_report* report) {
    ruga_elastic_energies e;
    const ruga_creases* creases = m->model->creases;
    ruga_elastic* elastic = ruga_dynamic_elastic(m->dynamic);
    for (int h = 0; creases && h < creases->segment_count; h++) {
        elastic->rest[creases->segment[h]] = m->skin->hinges->rest[h];
    }
    ruga_elastic_set_rest(elastic, elastic->rest); // and with it the lengths of springs
    ruga_elastic_force(elastic, x, m->slope, &e);
    put_energies(m, time, x, &e, report);
}

ruga_status ruga_moving_step(ruga_moving* m, double time, double duration, double* x, ruga_report* report) {
    const ruga_creases* creases = m->model->creases;
    const ruga_dynamic_drive drive = {.move = move, .load = load, .context = m};
    ruga_dynamic_report done;
    m->begin = time;
    m->duration = duration;
    if (creases) {
        (void)ruga_hinges_begin(m->skin->hinges, time + duration, duration);
    }
    RUGA_TRY(ruga_dynamic_advance(m->dynamic, &drive, time, duration, x, m->velocity, &done));
    const double* angle = ruga_dynamic_elastic(m->dynamic)->angle;
    for (int h = 0; creases && h < creases->hinge_count; h++) {
        double* near = &m->skin->hinges->near[h];
        double from = creases->stiffness[h] > 0 ? angle[creases->segment[h]] : *near;
        *near = ruga_hinge_measure(&creases->hinge[h], x, &from, NULL);
    }
    report->substeps = done.substeps;
    report->linear_iterations = done.damping_products;
    put_energies(m, time + duration, x, &done.elastic, report);
    return RUGA_OK;
}

ruga_dynamic* ruga_moving_dynamic(ruga_moving* moving) {
    return moving->dynamic;
}

const double* ruga_moving_velocity(const ruga_moving* moving) {
    return moving->velocity;
}

// ---- restart -------------------------------------------------------------------------------------------

int ruga_moving_restart_size(const ruga_model* model) {
    int segments = model->creases ? model->creases->cut.segment_count : 0;
    return model->skin.motion == RUGA_SKIN_DYNAMIC ? 6 * model->mesh.vertex_count + segments + 1 : 0;
}

void ruga_moving_save(const ruga_moving* m, double* restart) {
    memcpy(restart, m->velocity, 3 * (size_t)m->nodes * sizeof *restart);
    ruga_dynamic_save(m->dynamic, restart + 3 * (size_t)m->nodes);
}

void ruga_moving_load(ruga_moving* m, const double* restart) {
    memcpy(m->velocity, restart, 3 * (size_t)m->nodes * sizeof *restart);
    ruga_dynamic_load(m->dynamic, restart + 3 * (size_t)m->nodes);
}
