// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// One time step, and how it is split. Jumping far past onset freezes wrong modes (a short wave that the
// constraints happen to allow), so the step is divided until no part of the surface gains more than a quarter
// of the critical strain at a time below twice the critical strain, or half a percent beyond.
#include "core/memory.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/vec3.h"
#include "lattice/motion.h"
#include "lattice/svd3.h"
#include "solver/stages.h"
#include "solver/start.h"
#include "solver/state.h"

#include <math.h>
#include <string.h>

enum { MAX_SUBSTEPS = 1000 };

// ---- how far a step goes -------------------------------------------------------------------------------

typedef struct strain_job {
    const ruga_mesh* mesh;
    const double* position;
    double* strain;
} strain_job;

// Largest compressive in-plane strain of each triangle: 1 - the smaller singular value of its deformation.
static void triangle_strains(int begin, int end, int chunk, void* context) {
    (void)chunk;
    strain_job* job = context;
    for (int f = begin; f < end; f++) {
        const int* t = job->mesh->triangle + 3 * (size_t)f;
        const double *a = job->mesh->position + 3 * (size_t)t[0], *p = job->position + 3 * (size_t)t[0];
        double u[3], v[3], du[3], dv[3];
        ruga_subtract(job->mesh->position + 3 * (size_t)t[1], a, u);
        ruga_subtract(job->mesh->position + 3 * (size_t)t[2], a, v);
        ruga_subtract(job->position + 3 * (size_t)t[1], p, du);
        ruga_subtract(job->position + 3 * (size_t)t[2], p, dv);
        // Metric of the deformation in a frame of the rest triangle: C = D^-T (metric of du, dv) D^-1.
        double length = ruga_norm(u), along = ruga_dot(u, v) / length;
        double height = sqrt(fmax(ruga_dot(v, v) - along * along, 0));
        double e0[3], e1[3];
        for (int i = 0; i < 3; i++) {
            e0[i] = du[i] / length;
            e1[i] = (dv[i] - along * e0[i]) / height;
        }
        double c00 = ruga_dot(e0, e0), c11 = ruga_dot(e1, e1), c01 = ruga_dot(e0, e1);
        double mean = 0.5 * (c00 + c11), spread = hypot(0.5 * (c00 - c11), c01);
        job->strain[f] = 1 - sqrt(fmax(mean - spread, 0));
    }
}

// Parts that a triangle's gain of compressive strain should be made in.
static double triangle_parts(double before, double after, double critical) {
    double gain = after - before;
    if (gain <= 0 || after < 0.5 * critical) {
        return 1;
    }
    return gain / (before < 2 * critical ? fmin(0.25 * critical, 5e-3) : 5e-3);
}

// Parts that a change of the embedded surface from `from` to `to` should be made in: enough for all of it but
// an area too small to hold a wrinkle, such as the rim of a handle.
static int count_substeps(ruga_state* state, const double* from, const double* to) {
    const ruga_model* model = state->model;
    const ruga_mesh* mesh = &model->mesh;
    double* before = ruga_skin_vector(state->skin, 0); // longer than the number of triangles
    double area_of_parts[MAX_SUBSTEPS + 1] = {0}, total = 0;
    strain_job job = {mesh, from, state->strain};
    const double* local = model->variation.triangle_critical;
    if ((!model->solves_skin && !state->volume) || !model->has_interior) {
        return 1;
    }
    ruga_parallel_for(mesh->triangle_count, 4096, triangle_strains, &job);
    memcpy(before, state->strain, (size_t)mesh->triangle_count * sizeof *before);
    job.position = to;
    ruga_parallel_for(mesh->triangle_count, 4096, triangle_strains, &job);
    for (int f = 0; f < mesh->triangle_count; f++) {
        double critical = local ? local[f] : model->critical_strain;
        double parts = triangle_parts(before[f], state->strain[f], critical);
        double area =
            ruga_mesh_triangle_area(mesh, f) * (model->creases ? model->creases->cut.piece[f].fraction : 1);
        area_of_parts[(int)fmin(ceil(fmax(parts, 1) - 1e-9), MAX_SUBSTEPS)] += area;
        total += area;
    }
    double allowed = fmin(0.01 * total, 0.25 * model->wavelength_min * model->wavelength_min);
    int parts = MAX_SUBSTEPS;
    for (double beyond = area_of_parts[parts]; parts > 1 && beyond <= allowed;
         beyond += area_of_parts[parts]) {
        parts--;
    }
    return parts;
}

// ---- steps ---------------------------------------------------------------------------------------------

static void worse_outcome(ruga_report* report, ruga_outcome outcome) {
    report->outcome = outcome > report->outcome ? outcome : report->outcome;
}

static void take_skin_result(ruga_state* state, const ruga_skin_result* result, ruga_report* report) {
    report->outcome = result->outcome;
    report->residual_shell = result->residual;
    report->energy_membrane = result->terms.membrane;
    report->energy_bending = result->terms.bending;
    report->energy_hinge = result->terms.hinge;
    report->energy_foundation = result->terms.foundation;
    report->energy_external = result->terms.external;
    report->constraint_residual = ruga_skin_constraint_residual(state->skin, state->x);
}

static void set_handle_targets(ruga_state* state) {
    const ruga_model* model = state->model;
    for (int v = 0; v < model->mesh.vertex_count && model->any_skin_held; v++) {
        for (int axis = 0; axis < 3; axis++) {
            int i = 3 * v + axis, h = model->skin_handle[i];
            if (h < 0) {
                continue;
            }
            double target[3];
            ruga_handle_target(&model->handles[h], state->skin->time, ruga_start_shape(model) + 3 * (size_t)v,
                               target);
            bool follows = model->has_interior && model->handles[h].hold != RUGA_HOLD_SKIN;
            bool anchored = h == model->handle_count; // where it is: stages choose other nodes for it
            state->skin->target[i] = follows ? state->embedded[i] : anchored ? state->x[i] : target[axis];
        }
    }
}

// The skin is carried along by the interior's move, which keeps H x = H B q exactly; the published method
// starts from where the skin was.
static void carry_skin(ruga_state* state, const double* next_embedded) {
    int n = state->skin->n;
    for (int i = 0; i < n && state->model->solver.method != RUGA_METHOD_PAPER; i++) {
        state->x[i] += next_embedded[i] - state->embedded[i];
    }
    memcpy(state->embedded, next_embedded, (size_t)n * sizeof *next_embedded);
    memcpy(state->anchor, state->x, (size_t)n * sizeof *state->x);
}

static void set_damping(ruga_state* state, double dt) {
    const ruga_model* model = state->model;
    bool damped = model->skin.motion == RUGA_SKIN_DAMPED && model->solves_skin;
    state->skin->proximal = damped ? ruga_skin_shift_unit(model) * model->skin.relaxation / dt : 0;
}

// The lattice's map is a stretch along the axes: that of its first and last node.
static ruga_status solve_volume(ruga_state* state, ruga_report* report) {
    const ruga_model* model = state->model;
    const double *X = model->lattice.rest, *Y = &X[3 * (model->lattice.node_count - 1)];
    const double *a = state->q, *b = &a[3 * (model->lattice.node_count - 1)];
    double stretch[3], shift[3];
    ruga_volume_report result;
    for (int i = 0; i < 3; i++) {
        stretch[i] = (b[i] - a[i]) / (Y[i] - X[i]);
        shift[i] = a[i] - stretch[i] * X[i];
    }
    RUGA_TRY(ruga_dense_solve(&model->dense, state->volume, stretch, shift, model->solver.tolerance,
                              state->deviation, state->displacement, &result));
    ruga_dense_surface(&model->dense, &model->mesh, state->displacement, state->x);
    state->skin->work.iterations += result.iterations;
    state->skin->work.factorizations += result.factorizations;
    report->outcome = result.outcome;
    report->residual_shell = result.residual;
    report->energy_interior = result.energy;
    return RUGA_OK;
}

static ruga_status solve_skin_alone(ruga_state* state, ruga_report* report) {
    if (state->volume) {
        return solve_volume(state, report);
    }
    ruga_skin_result result = {.outcome = RUGA_OUTCOME_MINIMUM};
    set_handle_targets(state);
    if (state->model->solves_skin) {
        RUGA_TRY(ruga_skin_minimize(state->skin, state->x, state->model->solver.tolerance, true, &result));
    } else {
        memcpy(state->x, state->embedded, (size_t)state->skin->n * sizeof *state->x);
        RUGA_TRY(ruga_skin_energy(state->skin, state->x, &result.terms, NULL));
    }
    take_skin_result(state, &result, report);
    return RUGA_OK;
}

// After a solve: the work it took; a factor that did not end in a minimum is not kept.
static void finish_report(ruga_state* state, double begin, ruga_report* out) {
    const ruga_skin_work* work = &state->skin->work;
    if (out->outcome != RUGA_OUTCOME_MINIMUM) {
        state->skin->factor_right = state->skin->factor_exact = false;
    }
    out->newton_iterations += work->iterations;
    out->linear_iterations += work->linear_iterations;
    out->factorizations += work->factorizations;
    out->seconds_assembly = work->seconds_assembly;
    out->seconds_factor = work->seconds_factor;
    out->seconds_solve = work->seconds_solve;
    out->seconds_total = ruga_clock() - begin;
    out->seconds_other =
        out->seconds_total - out->seconds_assembly - out->seconds_factor - out->seconds_solve;
}

static void pose_at(const ruga_state* state, double time, double* q) {
    const ruga_model* model = state->model;
    if (model->follow.count > 0) {
        ruga_follow_at(&model->follow, time, q);
        return;
    }
    ruga_motion_at(&model->lattice, model->center, model->keyframe_count, model->keyframes, time, q);
}

static ruga_status follow_pose(ruga_state* state, double* q, double done, ruga_report* report) {
    ruga_lattice_embed(&state->model->lattice, q, state->next_embedded);
    carry_skin(state, state->next_embedded);
    RUGA_TRY(ruga_progress("static solve", done));
    return solve_skin_alone(state, report);
}

// The published method takes a step as it comes.
static int parts_to_pose(ruga_state* state, const double* q) {
    ruga_lattice_embed(&state->model->lattice, q, state->next_embedded);
    return state->model->solver.method == RUGA_METHOD_PAPER
               ? 1
               : count_substeps(state, state->embedded, state->next_embedded);
}

// Parts that creases need: no rest angle moves too far in one.
static int begin_hinges(ruga_state* state) {
    double dt = state->dt;
    return state->skin->hinges ? ruga_hinges_begin(state->skin->hinges, state->time + dt, dt) : 1;
}

static void advance_hinges(ruga_state* state, int k, int parts) {
    if (state->skin->hinges) {
        ruga_hinges_advance(state->skin->hinges, (double)k / parts);
    }
}

static ruga_status step_prescribed(ruga_state* state, ruga_report* report) {
    double begin = state->time, dt = state->dt;
    pose_at(state, begin + dt, state->q);
    int parts = parts_to_pose(state, state->q), folds = begin_hinges(state);
    parts = report->substeps = parts > folds ? parts : folds;
    set_damping(state, dt / parts);
    for (int k = 1; k <= parts; k++) {
        advance_hinges(state, k, parts);
        state->skin->time = begin + dt * k / parts;
        pose_at(state, state->skin->time, state->q);
        RUGA_TRY(follow_pose(state, state->q, (k - 1.0) / parts, report));
    }
    return RUGA_OK;
}

// The rest shape turned as a pose turns it: the rotation nearest to sum (q - mean q) (X - mean X)^T, and its
// mean.
static void turn_rest(const ruga_lattice* lattice, const double* pose, double* turned) {
    double f[9] = {0}, u[9], s[3], v[9], center[2][3] = {{0}};
    int n = lattice->node_count;
    for (int i = 0; i < 3 * n; i++) {
        center[0][i % 3] += lattice->rest[i] / n;
        center[1][i % 3] += pose[i] / n;
    }
    for (int k = 0; k < n; k++) {
        for (int i = 0; i < 9; i++) {
            f[i] +=
                (pose[3 * k + i / 3] - center[1][i / 3]) * (lattice->rest[3 * k + i % 3] - center[0][i % 3]);
        }
    }
    ruga_svd3(f, u, s, v);
    for (int k = 0; k < n; k++) {
        for (int i = 0; i < 3; i++) {
            turned[3 * k + i] = center[1][i];
            for (int j = 0; j < 9; j++) {
                turned[3 * k + i] += u[3 * i + j / 3] * v[j % 3 * 3 + j / 3] *
                                     (lattice->rest[3 * k + j % 3] - center[0][j % 3]);
            }
        }
    }
}

static double largest_difference(size_t n, const double* a, const double* b) {
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most;
}

// Frame 0 of a prescribed motion is the skin's static answer to the first pose, reached from the rest shape
// in as many parts as a step would take: the rest shape is turned as the pose is, then deformed along
// straight lines. Where the first pose is rigid and nothing loads the skin, it is at rest as it stands.
static ruga_status settle(ruga_state* state) {
    const ruga_model* model = state->model;
    ruga_report* report = &state->start;
    size_t nodes = 3 * (size_t)model->lattice.node_count;
    double begin = ruga_clock(), *turned = state->old_q, *pose = state->v;
    pose_at(state, 0, pose);
    turn_rest(&model->lattice, pose, turned);
    bool rigid = largest_difference(nodes, turned, pose) <= 1e-12 * model->extent;
    memcpy(state->q, rigid ? pose : turned, nodes * sizeof *pose);
    ruga_lattice_embed(&model->lattice, state->q, state->embedded);
    memcpy(state->x, state->embedded, (size_t)state->skin->n * sizeof *state->x);
    memcpy(state->anchor, state->x, (size_t)state->skin->n * sizeof *state->x);
    set_handle_targets(state);
    if (state->volume) {
        RUGA_TRY(solve_skin_alone(state, report));
    } else {
        RUGA_TRY(ruga_state_measure(state, report));
    }
    if (!rigid || report->residual_shell > model->solver.tolerance) {
        int parts = report->substeps = parts_to_pose(state, pose);
        for (int k = 1; k <= parts; k++) {
            for (size_t i = 0; i < nodes; i++) {
                state->q[i] = k < parts ? turned[i] + (pose[i] - turned[i]) * k / parts : pose[i];
            }
            RUGA_TRY(follow_pose(state, state->q, (k - 1.0) / parts, report));
        }
        finish_report(state, begin, report);
    }
    memset(state->v, 0, nodes * sizeof *state->v);
    return RUGA_OK;
}

static ruga_status step_shell(ruga_state* state, ruga_report* report) {
    double begin = state->time, dt = state->dt;
    int parts = report->substeps = begin_hinges(state);
    for (int k = 1; k <= parts; k++) {
        state->skin->time = k == parts ? begin + dt : begin + dt * k / parts;
        advance_hinges(state, k, parts);
        memcpy(state->anchor, state->x, (size_t)state->skin->n * sizeof *state->x);
        set_damping(state, dt / parts);
        if (parts > 1) {
            RUGA_TRY(ruga_progress("static solve", (k - 1.0) / parts));
        }
        RUGA_TRY(solve_skin_alone(state, report));
    }
    return RUGA_OK;
}

static void take_interior_result(ruga_state* state, const ruga_interior_result* result, ruga_report* report) {
    take_skin_result(state, &result->skin, report);
    if (!result->converged) {
        worse_outcome(report, RUGA_OUTCOME_NOT_CONVERGED);
    }
    report->residual_coupled = result->residual;
    report->newton_iterations += result->iterations;
    report->linear_iterations += result->linear_iterations;
    report->factorizations += result->factorizations;
    report->energy_interior = result->elastic;
    report->energy_external += result->weight;
}

// Sets up a part of a step, of length dt, ending at `time`, and puts its linearised answer into old_q.
static ruga_status predict_part(ruga_state* state, double time, double dt, ruga_report* report) {
    const ruga_model* model = state->model;
    ruga_interior* in = state->interior;
    bool dynamic = model->interior.motion == RUGA_INTERIOR_DYNAMIC;
    memcpy(in->previous, state->q, (size_t)in->n * sizeof *state->q);
    for (int i = 0; i < in->n; i++) {
        in->start[i] = state->q[i] + (dynamic ? dt * state->v[i] : 0);
    }
    in->mass_factor = dynamic ? 1 / (dt * dt) : 0;
    in->damping_factor = dynamic ? model->interior.damping / dt : 0;
    state->skin->time = time;
    ruga_interior_set_targets(in, time);
    report->factorizations++;
    return ruga_interior_predict(in, state->q, state->x, state->old_q);
}

// One part of a step of the coupled system from its prediction.
static ruga_status step_part(ruga_state* state, double dt, ruga_report* report) {
    const ruga_model* model = state->model;
    ruga_interior* in = state->interior;
    int n = in->n;
    bool dynamic = model->interior.motion == RUGA_INTERIOR_DYNAMIC;
    ruga_interior_result result;
    set_damping(state, dt);
    set_handle_targets(state);
    memcpy(state->q, state->old_q, (size_t)n * sizeof *state->q);
    ruga_lattice_embed(&model->lattice, state->q, state->next_embedded);
    carry_skin(state, state->next_embedded);
    if (model->solver.method == RUGA_METHOD_PAPER) {
        RUGA_TRY(ruga_interior_paper_step(in, model->solver.tolerance, state->q, state->x, state->embedded,
                                          &result));
    } else {
        RUGA_TRY(ruga_interior_minimize(in, model->solver.tolerance, state->q, state->x, state->embedded,
                                        &result));
    }
    for (int i = 0; i < n; i++) {
        state->v[i] = dynamic ? (state->q[i] - in->previous[i]) / dt : 0;
    }
    take_interior_result(state, &result, report);
    return RUGA_OK;
}

// The whole step is predicted first, with the skin following: what that would do to the surface tells how
// many parts the step needs.
static ruga_status step_coupled(ruga_state* state, ruga_report* report) {
    double begin = state->time, dt = state->dt;
    int parts = 1, folds = begin_hinges(state);
    RUGA_TRY(predict_part(state, begin + dt, dt, report));
    if (state->model->solver.method != RUGA_METHOD_PAPER) {
        ruga_lattice_embed(&state->model->lattice, state->old_q, state->next_embedded);
        parts = count_substeps(state, state->embedded, state->next_embedded);
    }
    parts = report->substeps = parts > folds ? parts : folds;
    for (int k = 1; k <= parts; k++) {
        advance_hinges(state, k, parts);
        if (parts > 1) {
            RUGA_TRY(predict_part(state, begin + dt * k / parts, dt / parts, report));
        }
        RUGA_TRY(step_part(state, dt / parts, report));
    }
    return RUGA_OK;
}

static double kinetic_energy(ruga_state* state) {
    ruga_interior* in = state->interior;
    if (!in || state->model->interior.motion != RUGA_INTERIOR_DYNAMIC) {
        return 0;
    }
    ruga_sparse mass = *ruga_elasticity_pattern(in->elasticity);
    mass.value = in->mass;
    ruga_sparse_multiply_symmetric(&mass, state->v, state->old_q);
    return 0.5 * ruga_dot_product(in->n, state->v, state->old_q);
}

static ruga_status step_part_of_frame(ruga_state* state, ruga_report* report) {
    const ruga_model* model = state->model;
    double begin = ruga_clock();
    *report = (ruga_report){0};
    state->skin->work = (ruga_skin_work){0};
    if (state->moving) {
        RUGA_TRY(ruga_moving_step(state->moving, state->time, state->dt, state->x, report));
    } else if (!model->has_interior) {
        RUGA_TRY(step_shell(state, report));
    } else if (ruga_model_is_prescribed(model)) {
        RUGA_TRY(step_prescribed(state, report));
    } else {
        RUGA_TRY(step_coupled(state, report));
    }
    finish_report(state, begin, report);
    return RUGA_OK;
}

static void add_work(const ruga_report* before, ruga_report* report) {
    worse_outcome(report, before->outcome);
    report->substeps += before->substeps;
    report->newton_iterations += before->newton_iterations;
    report->linear_iterations += before->linear_iterations;
    report->factorizations += before->factorizations;
    report->seconds_total += before->seconds_total;
    report->seconds_assembly += before->seconds_assembly;
    report->seconds_factor += before->seconds_factor;
    report->seconds_solve += before->seconds_solve;
    report->seconds_other += before->seconds_other;
}

// A frame, in parts where creases come within it.
ruga_status ruga_state_step(const ruga_model* whole, ruga_state* state, ruga_report* report) {
    RUGA_ASSERT(state->whole == whole);
    ruga_report part, unused, *out = report ? report : &unused;
    *out = (ruga_report){0};
    for (double at = state->frame, end = 0; at < state->frame + 1; at = end) {
        while (state->stage < whole->stage_count && whole->stage[state->stage].end <= at) {
            RUGA_TRY(ruga_state_enter_next_stage(state));
        }
        end = state->frame + 1;
        if (state->stage < whole->stage_count) {
            end = fmin(end, whole->stage[state->stage].end);
        }
        state->dt = (end - at) * whole->step;
        RUGA_TRY(step_part_of_frame(state, &part));
        add_work(out, &part);
        *out = part;
        state->time = state->skin->time = end * whole->step;
    }
    state->frame++;
    ruga_state_show(state);
    out->energy_kinetic = state->moving ? out->energy_kinetic : kinetic_energy(state);
    return RUGA_OK;
}

ruga_status ruga_state_measure(ruga_state* state, ruga_report* report) {
    ruga_skin_result result = {.outcome = state->start.outcome};
    double *gradient = ruga_skin_vector(state->skin, 0), *projected = ruga_skin_vector(state->skin, 1);
    *report = state->start;
    if (state->moving) {
        ruga_moving_measure(state->moving, state->time, state->x, report);
        return RUGA_OK;
    }
    if (state->volume) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_skin_energy(state->skin, state->x, &result.terms, gradient));
    RUGA_TRY(ruga_skin_project(state->skin, gradient, projected));
    result.residual =
        state->model->solves_skin ? ruga_skin_residual(state->skin, projected, &result.terms) : 0;
    take_skin_result(state, &result, report);
    return RUGA_OK;
}

ruga_status ruga_state_create(const ruga_model* model, ruga_state** out) {
    *out = NULL;
    RUGA_TRY(ruga_state_make(model, 0, out));
    ruga_status status = ruga_model_is_prescribed(model) ? settle(*out) : RUGA_OK;
    if (status == RUGA_OK) {
        ruga_state_show(*out);
    }
    if (status != RUGA_OK) {
        ruga_state_destroy(out);
    }
    return status;
}
