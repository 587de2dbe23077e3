// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The interior alone: the skin is so soft and light that it does not count, and follows (x = B q).
#include "app/validate/block_calculix.h"
#include "app/validate/body.h"
#include "app/validate/cases.h"
#include "app/validate/peer.h"
#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double YOUNG = 1e5;

static void interior_alone(ruga_body* b, double poisson, int cells, ruga_interior_motion motion) {
    b->def.skin.thickness = 1e-4;
    b->def.skin.young = 1e-6;
    b->def.skin.density = 0;
    b->def.interior.young = YOUNG;
    b->def.interior.poisson = poisson;
    b->def.interior.motion = motion;
    b->def.lattice.cells = cells;
    b->def.coupling.kind = RUGA_COUPLING_NONE;
    b->def.coupling.foundation = false;
    b->def.solver.allow_coarse = true;
    b->def.solver.tolerance = 1e-8;
}

// ---- a beam that does not align with the cells ---------------------------------------------------------

typedef enum beam_load { BEAM_STRETCH, BEAM_SHEAR, BEAM_BENDING, BEAM_LOADS } beam_load;

static const char* const BEAM_NAMES[] = {"stretch", "shear", "bending"};
static const double BEAM_LENGTH = 0.8, BEAM_SIDE = 0.1;

// Turned about (1, 2, 3) by `angle`: columns are where the beam's axes point.
static void turn(double angle, double r[9]) {
    double n = sqrt(14), k[3] = {1 / n, 2 / n, 3 / n}, c = cos(angle), s = sin(angle);
    double cross[9] = {0, -k[2], k[1], k[2], 0, -k[0], -k[1], k[0], 0};
    for (int i = 0; i < 9; i++) {
        r[i] = (i % 4 == 0 ? c : 0) + s * cross[i] + (1 - c) * k[i / 3] * k[i % 3];
    }
}

// The vertices X of the unturned beam with low <= X <= high; what it gives is released by the caller.
static ruga_status take_vertices(const double* position, int count, const double low[3], const double high[3],
                                 int** list, ruga_region* region) {
    int found = 0;
    RUGA_TRY(RUGA_NEW(*list, count));
    for (int v = 0; v < count; v++) {
        const double* x = position + 3 * v;
        bool in = true;
        for (int i = 0; i < 3; i++) {
            in = in && x[i] >= low[i] - 1e-9 && x[i] <= high[i] + 1e-9;
        }
        if (in) {
            (*list)[found++] = v;
        }
    }
    *region = (ruga_region){.kind = RUGA_REGION_VERTICES, .vertex_count = found, .vertices = *list};
    return RUGA_OK;
}

// A force of `amount` along an axis of the beam, spread over the vertices between two corners.
static ruga_status add_force(ruga_body* b, const double* position, const double r[9], const double low[3],
                             const double high[3], int axis, double amount, int** list) {
    ruga_handle_def* h = &b->handle[b->def.handle_count++];
    h->kind = RUGA_HANDLE_FORCE;
    for (int k = 0; k < 3; k++) {
        h->force[k] = amount * r[3 * k + axis];
    }
    return take_vertices(position, b->mesh.vertex_count, low, high, list, &h->region);
}

// Forces that balance: along the axis on both ends; along all four faces for uniform shear in x z; and for bending
// a couple on each end, of one half against the other, whose mean distance is half the side.
static ruga_status load_beam(ruga_body* b, const double* position, const double r[9], beam_load load, double stress,
                             int* list[4]) {
    const double l = BEAM_LENGTH / 2, s = BEAM_SIDE / 2, area = BEAM_SIDE * BEAM_SIDE;
    for (int i = 0; i < 2; i++) {
        double sign = i ? 1 : -1, cap_low[3] = {sign * l, -s, -s}, cap_high[3] = {sign * l, s, s};
        double face_low[3] = {-l, -s, sign * s}, face_high[3] = {l, s, sign * s};
        if (load == BEAM_BENDING) {
            double up_low[3] = {sign * l, -s, 1e-6}, low_high[3] = {sign * l, s, -1e-6};
            RUGA_TRY(add_force(b, position, r, up_low, cap_high, 0, sign * stress * area / 2, &list[2 * i]));
            RUGA_TRY(add_force(b, position, r, cap_low, low_high, 0, -sign * stress * area / 2, &list[2 * i + 1]));
            continue;
        }
        RUGA_TRY(add_force(b, position, r, cap_low, cap_high, load == BEAM_STRETCH ? 0 : 2, sign * stress * area,
                           &list[2 * i]));
        if (load == BEAM_SHEAR) {
            RUGA_TRY(add_force(b, position, r, face_low, face_high, 0, sign * stress * BEAM_SIDE * BEAM_LENGTH,
                               &list[2 * i + 1]));
        }
    }
    return RUGA_OK;
}

// Least squares over the middle half of its surface: displacement in the beam's axes, component `along`, against
// 1, x, z, x^2; out: its four coefficients.
static void fit_middle(const ruga_body* b, const double* position, const double r[9], int along, double fit[4]) {
    double a[4][5] = {{0}};
    for (int v = 0; v < b->mesh.vertex_count; v++) {
        const double *X = position + 3 * v, *now = ruga_state_positions(b->state) + 3 * v;
        double u = 0, row[5] = {1, X[0], X[2], X[0] * X[0]};
        for (int k = 0; k < 3; k++) {
            u += r[3 * k + along] * (now[k] - b->mesh.position[3 * v + k]);
        }
        row[4] = u;
        for (int i = 0; i < 4 && fabs(X[0]) <= BEAM_LENGTH / 4; i++) {
            for (int j = 0; j < 5; j++) {
                a[i][j] += row[i] * row[j];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 4; k++) {
            double factor = a[k][i] / a[i][i];
            for (int j = 0; j < 5 && k != i; j++) {
                a[k][j] -= factor * a[i][j];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        fit[i] = a[i][4] / a[i][i];
    }
}

// The couple that the forces make about the beam's middle: a force is spread by the areas of its vertices, and those
// on a rim count faces beyond it.
static double couple_on_end(const ruga_body* b, const double* position) {
    double couple = 0;
    for (int h = 3; h < b->def.handle_count; h++) {
        const ruga_handle_def* handle = &b->handle[h];
        double area = 0, arm = 0;
        for (int k = 0; k < handle->region.vertex_count; k++) {
            int v = handle->region.vertices[k];
            area += b->model->vertex_area[v];
            arm += b->model->vertex_area[v] * position[3 * v + 2];
        }
        couple += 0.5 * ruga_norm(handle->force) * fabs(arm) / area;
    }
    return couple;
}

// Strain, shear or curvature in the middle half over that of the closed form.
static double beam_ratio(const ruga_body* b, const double* position, const double r[9], beam_load load, double stress,
                         double poisson) {
    double along[4], up[4];
    fit_middle(b, position, r, 0, along);
    fit_middle(b, position, r, 2, up);
    switch (load) {
    case BEAM_STRETCH:
        return along[1] / (stress / YOUNG);
    case BEAM_SHEAR:
        return (along[2] + up[1]) / (stress * 2 * (1 + poisson) / YOUNG);
    default: {
        double inertia = pow(BEAM_SIDE, 4) / 12;
        return -2 * up[3] / (couple_on_end(b, position) / (YOUNG * inertia));
    }
    }
}

static ruga_status run_beam(beam_load load, int cells, double angle, double* ratio) {
    ruga_status status = RUGA_OK;
    ruga_body b;
    const double stress = 1e-3 * YOUNG, poisson = 0.3;
    double r[9], *position = NULL;
    int *list[4] = {NULL}, pin[3] = {0, 0, 0};
    const ruga_make_def make = {
        .shape = RUGA_SHAPE_BAR, .size = {BEAM_LENGTH, BEAM_SIDE, BEAM_SIDE}, .edge = 0.00625};
    RUGA_TRY_DONE(ruga_body_make(&make, &b));
    interior_alone(&b, poisson, cells, RUGA_INTERIOR_QUASISTATIC);
    turn(angle, r);
    RUGA_TRY_DONE(RUGA_NEW(position, 3 * (size_t)b.mesh.vertex_count));
    memcpy(position, b.mesh.position, 3 * (size_t)b.mesh.vertex_count * sizeof *position);
    for (int v = 0; v < b.mesh.vertex_count; v++) {
        const double* x = position + 3 * v;
        for (int i = 0; i < 3; i++) {
            b.mesh.position[3 * v + i] = r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2];
        }
        for (int i = 0; i < 3; i++) { // the corners ---, +-- and -+- that hold it, statically determinate
            const double corner[3][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}};
            double far = x[0] * corner[i][0] + x[1] * corner[i][1] + x[2] * corner[i][2];
            const double* best = position + 3 * pin[i];
            pin[i] = far > best[0] * corner[i][0] + best[1] * corner[i][1] + best[2] * corner[i][2] ? v : pin[i];
        }
    }
    for (int i = 0; i < 3; i++) {
        b.handle[i].region = (ruga_region){.kind = RUGA_REGION_VERTICES, .vertex_count = 1, .vertices = &pin[i]};
        b.handle[i].axes[0] = i == 0;
        b.handle[i].axes[1] = i < 2;
    }
    b.def.handle_count = 3;
    RUGA_TRY_DONE(load_beam(&b, position, r, load, stress, list));
    RUGA_TRY_DONE(ruga_body_build(&b));
    RUGA_TRY_DONE(ruga_body_step(&b, NULL, NULL));
    *ratio = beam_ratio(&b, position, r, load, stress, poisson);
done:
    ruga_release(position);
    for (int i = 0; i < 4; i++) {
        ruga_release(list[i]);
    }
    ruga_body_clear(&b);
    return status;
}

static ruga_status run_beams(ruga_validation* v) {
    static const int cells[] = {12, 24};
    static const char* const sources[] = {"stress / E", "stress / G", "moment / (E I)"};
    static const char* const words[] = {"strain", "shear", "curvature"};
    for (int load = 0; load < BEAM_LOADS; load++) {
        for (int k = 0; k < 2; k++) {
            double ratio;
            char name[128];
            RUGA_TRY(run_beam((beam_load)load, cells[k], 0.45, &ratio));
            (void)snprintf(name, sizeof name, "beam at 26 deg to the cells, %s, %d cells: %s / closed form",
                           BEAM_NAMES[load], cells[k], words[load]);
            if (k) {
                ruga_validation_near(v, name, ratio, 1, 0.03, sources[load]);
            } else {
                ruga_validation_record(v, name, ratio, 1, sources[load]);
            }
        }
    }
    return RUGA_OK;
}

// ---- a cantilever block --------------------------------------------------------------------------------

// Sinking of the free end's middle, m, under a force across it; sides of 10 cm, 4 cells through the thickness.
static ruga_status run_cantilever(double length, double poisson, int through, double force, double* sag) {
    ruga_status status = RUGA_OK;
    ruga_body b;
    const double side = 0.1;
    const ruga_make_def make = {.shape = RUGA_SHAPE_BAR, .size = {length, side, side}, .edge = 0.02};
    RUGA_TRY_DONE(ruga_body_make(&make, &b));
    interior_alone(&b, poisson, (int)lround(through * length / side), RUGA_INTERIOR_QUASISTATIC);
    b.handle[0].region = ruga_plane_region(-length / 2, 0, 0, -1, 0, 0);
    b.handle[1].kind = RUGA_HANDLE_FORCE;
    b.handle[1].region = ruga_plane_region(length / 2, 0, 0, 1, 0, 0);
    b.handle[1].force[2] = -force;
    b.def.handle_count = 2;
    RUGA_TRY_DONE(ruga_body_build(&b));
    RUGA_TRY_DONE(ruga_body_step(&b, NULL, NULL));
    double sum = 0;
    int count = 0;
    for (int v = 0; v < b.mesh.vertex_count; v++) {
        if (b.mesh.position[3 * v] > length / 2 - 1e-9) {
            sum += b.mesh.position[3 * v + 2] - ruga_state_positions(b.state)[3 * v + 2];
            count++;
        }
    }
    *sag = sum / count;
done:
    ruga_body_clear(&b);
    return status;
}

static ruga_status run_cantilevers(ruga_validation* v) {
    const double side = 0.1, length = 1, poisson = 0.3, force = 1e-3;
    double area = side * side, inertia = area * area / 12, shear = YOUNG / (2 * (1 + poisson));
    double factor = 10 * (1 + poisson) / (12 + 11 * poisson); // Cowper 1966, rectangle
    double theory = force * (pow(length, 3) / (3 * YOUNG * inertia) + length / (factor * shear * area));
    for (int through = 2; through <= 4; through += 2) {
        double sag;
        char name[96];
        RUGA_TRY(run_cantilever(length, poisson, through, force, &sag));
        (void)snprintf(name, sizeof name, "cantilever 10 : 1, %d cells through: deflection, m", through);
        if (through == 4) {
            ruga_validation_near(v, name, sag, theory, 0.03, "Timoshenko beam, Cowper 1966");
        } else {
            ruga_validation_record(v, name, sag, theory, "Timoshenko beam, Cowper 1966");
        }
    }
    return RUGA_OK;
}

// A shorter block, of which beam theory knows less, against a solid model of another program.
static ruga_status run_block(ruga_validation* v) {
    block_def block = {.length = 0.4, .side = 0.1, .young = YOUNG, .poisson = 0.3, .force = 1e-3};
    char ccx[RUGA_VALIDATION_PATH], directory[RUGA_VALIDATION_PATH];
    double ours, theirs[2];
    if (!peer_find("ccx", ccx)) {
        ruga_validation_note(v, "The block against CalculiX was left out: there is no ccx (Debian: calculix-ccx).");
        return RUGA_OK;
    }
    RUGA_TRY(ruga_validation_work(v, directory));
    for (int k = 0; k < 2; k++) {
        block.elements[0] = k ? 32 : 16;
        block.elements[1] = k ? 8 : 4;
        RUGA_TRY(block_sag(ccx, directory, &block, &theirs[k]));
    }
    RUGA_TRY(run_cantilever(block.length, block.poisson, 4, block.force, &ours));
    ruga_validation_near(v, "block 4 : 1, 4 cells through: deflection, m", ours, theirs[1], 0.03,
                         "CalculiX, 2048 C3D20");
    ruga_validation_record(v, "the same, CalculiX' own step from 256 elements to 2048, m", theirs[0], theirs[1],
                           "CalculiX, 256 C3D20");
    return RUGA_OK;
}

// ---- a ball in free flight -----------------------------------------------------------------------------

typedef struct flight {
    double path_error;     // m, of the centre of mass from implicit Euler's parabola
    double momentum_error; // relative
    double spin_gain;      // largest growth of the angular momentum in a step, relative
    double energy_gain;    // the same of kinetic and elastic energy in the frame that falls
    double spin_loss, energy_loss; // relative, at the end
} flight;

// M v for the scalar pattern's matrix.
static void weigh(const ruga_state* state, const double* vector, double* out) {
    ruga_sparse mass = *ruga_elasticity_pattern(state->interior->elasticity);
    mass.value = state->interior->mass;
    ruga_sparse_multiply_symmetric(&mass, vector, out);
}

typedef struct moments {
    double mass, center[3], momentum[3], spin[3], kinetic;
} moments;

// About the centre of mass, and in the frame that moves with it.
static void take_moments(const ruga_state* state, double* work, moments* m) {
    int n = 3 * state->model->lattice.node_count;
    *m = (moments){0};
    for (int i = 0; i < n; i++) {
        work[n + i] = i % 3 == 0;
    }
    weigh(state, work + n, work);
    for (int i = 0; i < n; i += 3) { // row sums of the mass
        m->mass += work[i];
        for (int k = 0; k < 3; k++) {
            m->center[k] += work[i] * state->q[i + k];
        }
    }
    weigh(state, state->v, work);
    for (int i = 0; i < n; i++) {
        m->momentum[i % 3] += work[i];
        m->kinetic += 0.5 * work[i] * state->v[i];
    }
    for (int k = 0; k < 3; k++) {
        m->center[k] /= m->mass;
        m->kinetic -= 0.5 * m->momentum[k] * m->momentum[k] / m->mass;
    }
    for (int i = 0; i < n; i += 3) {
        double arm[3], turn[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = state->q[i + k] - m->center[k];
        }
        ruga_cross(arm, work + i, turn);
        for (int k = 0; k < 3; k++) {
            m->spin[k] += turn[k];
        }
    }
}

// Spin about z at 15 rad/s, a vibration that stretches it along x and squeezes it along y, and a throw.
static void throw_ball(ruga_state* state, const double velocity[3]) {
    for (int k = 0; k < state->model->lattice.node_count; k++) {
        const double* q = state->q + 3 * k;
        double* v = state->v + 3 * k;
        v[0] = velocity[0] - 15 * q[1] + 3 * q[0];
        v[1] = velocity[1] + 15 * q[0] - 3 * q[1];
        v[2] = velocity[2];
    }
}

static ruga_status fly(double step, double seconds, flight* f) {
    ruga_status status = RUGA_OK;
    ruga_body b;
    const ruga_make_def make = {.shape = RUGA_SHAPE_SPHERE, .size = {0.2, 0, 0}, .edge = 0.03};
    double velocity[3] = {1, 0.5, 4}, place[3], *work = NULL;
    double spin = 0, energy = 0, first_spin = 0, first_energy = 0;
    moments m;
    ruga_report report = {0};
    *f = (flight){0};
    RUGA_TRY_DONE(ruga_body_make(&make, &b));
    interior_alone(&b, 0.3, 3, RUGA_INTERIOR_DYNAMIC);
    b.def.interior.density = 1000;
    b.def.step = step;
    b.def.gravity[2] = -9.81;
    b.def.solver.tolerance = 1e-10;
    RUGA_TRY_DONE(ruga_body_build(&b));
    RUGA_TRY_DONE(RUGA_NEW(work, 6 * (size_t)b.model->lattice.node_count));
    throw_ball(b.state, velocity);
    take_moments(b.state, work, &m);
    memcpy(place, m.center, sizeof place);
    for (int k = 0; k <= lround(seconds / step); k++) {
        if (k) {
            RUGA_TRY_DONE(ruga_body_step(&b, &report, NULL));
            velocity[2] -= 9.81 * step;
            double before_spin = spin, before_energy = energy;
            take_moments(b.state, work, &m);
            for (int i = 0; i < 3; i++) {
                place[i] += step * velocity[i];
                f->path_error = fmax(f->path_error, fabs(m.center[i] - place[i]));
                f->momentum_error = fmax(f->momentum_error, fabs(m.momentum[i] / m.mass - velocity[i]) / 4);
            }
            f->spin_gain = fmax(f->spin_gain, (ruga_norm(m.spin) - before_spin) / first_spin);
            f->energy_gain = fmax(f->energy_gain, (m.kinetic + report.energy_interior - before_energy) / first_energy);
        }
        spin = ruga_norm(m.spin);
        energy = m.kinetic + report.energy_interior;
        if (k == 0) {
            first_spin = spin;
            first_energy = energy;
        }
    }
    f->spin_loss = 1 - spin / first_spin;
    f->energy_loss = 1 - energy / first_energy;
done:
    ruga_release(work);
    ruga_body_clear(&b);
    return status;
}

static ruga_status run_flights(ruga_validation* v) {
    flight f[3];
    char name[96];
    for (int k = 0; k < 3; k++) {
        double step = 0.5e-3 / (1 << k);
        RUGA_TRY(fly(step, 0.02, &f[k]));
        (void)snprintf(name, sizeof name, "ball, %g ms: centre of mass from its parabola, m", 1e3 * step);
        ruga_validation_below(v, name, f[k].path_error, 1e-10, "implicit Euler's parabola, round-off");
        (void)snprintf(name, sizeof name, "ball, %g ms: linear momentum, relative error", 1e3 * step);
        ruga_validation_below(v, name, f[k].momentum_error, 1e-9, "conserved but for gravity");
        (void)snprintf(name, sizeof name, "ball, %g ms: largest gain of angular momentum in a step", 1e3 * step);
        ruga_validation_below(v, name, f[k].spin_gain, 1e-9, "never grows");
        (void)snprintf(name, sizeof name, "ball, %g ms: largest gain of energy in a step", 1e3 * step);
        ruga_validation_below(v, name, f[k].energy_gain, 1e-9, "never grows");
        (void)snprintf(name, sizeof name, "ball, %g ms: angular momentum lost in 20 ms", 1e3 * step);
        ruga_validation_record(v, name, f[k].spin_loss, NAN, "");
        (void)snprintf(name, sizeof name, "ball, %g ms: energy lost in 20 ms", 1e3 * step);
        ruga_validation_record(v, name, f[k].energy_loss, NAN, "");
    }
    ruga_validation_near(v, "ball: loss of angular momentum at 0.125 ms over that at 0.25 ms", f[2].spin_loss / f[1].spin_loss,
                         0.5, 0.1, "first order in the step");
    ruga_validation_near(v, "ball: loss of energy at 0.125 ms over that at 0.25 ms", f[2].energy_loss / f[1].energy_loss, 0.5,
                         0.1, "first order in the step");
    return RUGA_OK;
}

static ruga_status run(ruga_validation* v) {
    RUGA_TRY(run_cantilevers(v));
    RUGA_TRY(run_block(v));
    RUGA_TRY(run_flights(v));
    return run_beams(v);
}

const ruga_validation_case ruga_validate_interior = {
    .name = "interior",
    .title = "The interior alone: beams, a cantilever, a ball in free flight",
    .about = "The lattice without a skin. A beam of 80 x 10 x 10 cm that is turned against the cells, so that every "
             "surface cuts them, is stretched, sheared and bent by balanced forces on its faces; the strain in its "
             "middle half is that of the closed form. (Loads and not held ends: to hold an oblique face exactly, the "
             "splines must hold about half a cell behind it.) A cantilever and a short block carry a force at their end. A ball is thrown, "
             "spinning and vibrating: implicit Euler keeps its linear momentum and loses the rest by an amount that "
             "is of first order in the step.",
    .quick = true,
    .run = run,
};
