// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The semi-implicit step of Bridson, Marino and Fedkiw (2003), elastic forces explicit and damping implicit,
// with the stabilisation of Patkar, Jin and Fedkiw (2015, section 4):
//   v += dt/2 f(x)/m                              f = elastic + load + m g
//   ((1 + drag dt) M + dt D(x)) v' = M v          D of elastic.h, conjugate gradients from v on
//   v' += M^-1 W S^-1 (-W^T v' - W^T x / dt)      pre-stabilisation
//   x += dt v'
//   v = v' + dt/2 f(x)/m
//   v += M^-1 W S^-1 (-W^T v)                     post-stabilisation
// Without damping that is the leapfrog scheme on the space W^T x = 0: of second order, symplectic, exact in
// free fall. (The paper's forward Euler is of first order at the same price.) Nothing but a kick stands then
// between a post-stabilisation and the pre-stabilisation of the next step, of which it is a part, as both
// project along the same impulses: only the last step of a frame has one. With damping the scheme is of first
// order. Every part conserves momentum, and, where there is no gap, angular momentum: damping too, when its
// iteration ends early, since M preconditions it and its steps are M^-1 times forces between nodes. A held
// node moves as the drive says: infinitely heavy.
//
// Stable while dt < 2 / w, w^2 the largest eigenvalue of P M^-1 K, P the post-stabilisation and K the
// stiffness at x by differences of forces: found by power iteration, kept up from frame to frame. A frame is
// thrown away and taken in twice as many steps where a node outruns the others by an edge in one step, where
// anything is not finite, or where w has become too high for the step.
#include "solver/dynamic.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/vec3.h"

#include <math.h>
#include <string.h>

static const double DAMPED = 1e-6;     // residual of the damping over the momentum, in the norm of M^-1
static const double DIFFERENCE = 1e-6; // edges
static const double EDGE_OF_STABILITY = 0.98;
static const double MOST_STEPS = 1e7; // of a frame: a day and more

enum { CHUNK = 1024, MOST_HALVINGS = 6, MOST_DAMPING = 200, FIRST_EFFORT = 80, EFFORT = 8 };

struct ruga_dynamic {
    ruga_dynamic_def def;
    ruga_elastic elastic;
    int axes;              // 1: the same components of all nodes are held; else 3
    ruga_sewing sewing[3]; // by axis
    ruga_stitch* stitch[3];
    int nodes;
    bool* held; // [nodes][3]
    double edge, total_mass;
    double *mass, *inverse_mass; // [nodes]; [nodes][3], 0 where held
    double* force;               // [nodes][3] at x, where `fresh`
    bool fresh;
    double limit;          // s, 0 = not known
    double* mode;          // [nodes][3] of the highest frequency
    double *a, *b, *c, *d; // [nodes][3] work
    double *old_x, *old_v, *old_memory;
    double* rest;    // [segments] what a drive sets
    double* partial; // [chunks]
};

ruga_dynamic_def ruga_default_dynamic_def(void) {
    return (ruga_dynamic_def){.elastic = {.skin = {.thickness = 0.002,
                                                   .young = 20e6,
                                                   .poisson = 0.3,
                                                   .density = 900,
                                                   .model = RUGA_SKIN_SHELL}},
                              .safety = 0.7};
}

void ruga_dynamic_destroy(ruga_dynamic** dynamic) {
    ruga_dynamic* d = *dynamic;
    if (!d) {
        return;
    }
    ruga_elastic_clear(&d->elastic);
    for (int axis = 0; axis < 3; axis++) {
        ruga_stitch_destroy(&d->stitch[axis]);
        ruga_sewing_clear(&d->sewing[axis]);
    }
    ruga_release(d->held);
    ruga_release(d->mass);
    ruga_release(d->inverse_mass);
    ruga_release(d->force);
    ruga_release(d->mode);
    ruga_release(d->a);
    ruga_release(d->b);
    ruga_release(d->c);
    ruga_release(d->d);
    ruga_release(d->old_x);
    ruga_release(d->old_v);
    ruga_release(d->old_memory);
    ruga_release(d->rest);
    ruga_release(d->partial);
    ruga_release(d);
    *dynamic = NULL;
}

const double* ruga_dynamic_mass(const ruga_dynamic* dynamic) {
    return dynamic->mass;
}

ruga_elastic* ruga_dynamic_elastic(ruga_dynamic* dynamic) {
    return &dynamic->elastic;
}

// ------------------------------------------------------------------------------- set-up

static ruga_status set_mass(ruga_dynamic* d) {
    const ruga_raster* r = d->def.elastic.raster;
    const ruga_skin_def* skin = &d->def.elastic.skin;
    double* triangle = NULL;
    RUGA_TRY(RUGA_NEW(triangle, r->mesh.triangle_count));
    for (int f = 0; f < r->mesh.triangle_count; f++) {
        triangle[f] = skin->density * skin->thickness * ruga_mesh_triangle_area(&r->mesh, f);
    }
    ruga_cut_masses(d->def.elastic.cut, triangle, 0, false, d->mass);
    ruga_release(triangle);
    for (int n = 0; n < d->nodes; n++) {
        int v = d->def.elastic.cut->source[n];
        bool unused = r->edges.incident_start[v] == r->edges.incident_start[v + 1];
        for (int i = 3 * n; i < 3 * n + 3; i++) { // a vertex that no face uses stays where it is
            d->held[i] = unused || (d->def.held && d->def.held[i]);
            d->inverse_mass[i] = d->held[i] ? 0 : 1 / d->mass[n];
        }
        if (!unused && !(d->mass[n] > 0)) {
            return ruga_fail(RUGA_BAD_INPUT, "skin.density is %g kg/m^3: what moves needs mass",
                             skin->density);
        }
        d->total_mass += d->mass[n];
        d->axes = d->held[3 * n] == d->held[3 * n + 1] && d->held[3 * n] == d->held[3 * n + 2] ? d->axes : 3;
    }
    return RUGA_OK;
}

static ruga_status sew(ruga_dynamic* d) {
    ruga_status status = RUGA_OK;
    bool* held = NULL;
    double* inverse = NULL;
    RUGA_TRY_DONE(RUGA_NEW(held, d->nodes));
    RUGA_TRY_DONE(RUGA_NEW(inverse, d->nodes));
    for (int axis = 0; axis < d->axes; axis++) {
        for (int n = 0; n < d->nodes; n++) {
            held[n] = d->held[3 * n + axis];
            inverse[n] = d->inverse_mass[3 * n + axis];
        }
        RUGA_TRY_DONE(ruga_sewing_create(d->def.elastic.cut, held, &d->sewing[axis]));
        RUGA_TRY_DONE(ruga_stitch_create(&d->sewing[axis], inverse, &d->stitch[axis]));
    }
done:
    ruga_release(held);
    ruga_release(inverse);
    return status;
}

static ruga_status allocate(ruga_dynamic* d) {
    size_t n = (size_t)d->nodes;
    RUGA_TRY(RUGA_NEW(d->held, 3 * n));
    RUGA_TRY(RUGA_NEW(d->mass, n));
    RUGA_TRY(RUGA_NEW(d->inverse_mass, 3 * n));
    RUGA_TRY(RUGA_NEW(d->force, 3 * n));
    RUGA_TRY(RUGA_NEW(d->mode, 3 * n));
    RUGA_TRY(RUGA_NEW(d->a, 3 * n));
    RUGA_TRY(RUGA_NEW(d->b, 3 * n));
    RUGA_TRY(RUGA_NEW(d->c, 3 * n));
    RUGA_TRY(RUGA_NEW(d->d, 3 * n));
    RUGA_TRY(RUGA_NEW(d->old_x, 3 * n));
    RUGA_TRY(RUGA_NEW(d->old_v, 3 * n));
    RUGA_TRY(RUGA_NEW(d->old_memory, ruga_dynamic_memory_size(d)));
    RUGA_TRY(RUGA_NEW_ZERO(d->rest, d->def.elastic.cut->segment_count));
    return RUGA_NEW(d->partial, ruga_chunk_count(3 * d->nodes, CHUNK));
}

static void start_mode(ruga_dynamic* d) {
    ruga_random random = {1};
    for (int i = 0; i < 3 * d->nodes; i++) {
        d->mode[i] = d->held[i] ? 0 : ruga_random_uniform(&random) - 0.5;
    }
    d->limit = 0;
}

ruga_status ruga_dynamic_create(const ruga_dynamic_def* def, ruga_dynamic** dynamic) {
    ruga_status status = RUGA_OK;
    ruga_dynamic* d = NULL;
    RUGA_ASSERT(def->safety > 0 && def->safety < 1);
    *dynamic = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(d, 1));
    d->def = *def;
    d->nodes = def->elastic.cut->node_count;
    d->axes = 1;
    d->edge = ruga_mesh_mean_edge(&def->elastic.raster->mesh);
    RUGA_TRY_DONE(ruga_elastic_create(&def->elastic, &d->elastic));
    memcpy(d->def.gravity, def->gravity, sizeof d->def.gravity);
    RUGA_TRY_DONE(allocate(d));
    RUGA_TRY_DONE(set_mass(d));
    RUGA_TRY_DONE(sew(d));
    memcpy(d->rest, d->elastic.rest, (size_t)def->elastic.cut->segment_count * sizeof *d->rest);
    start_mode(d);
    d->def.held = NULL; // not kept
    d->def.elastic.stiffness = NULL;
    *dynamic = d;
done:
    if (status != RUGA_OK) {
        ruga_dynamic_destroy(&d);
    }
    return status;
}

// ------------------------------------------------------------------------------- memory

int ruga_dynamic_memory_size(const ruga_dynamic* d) {
    return 3 * d->nodes + d->def.elastic.cut->segment_count + 1;
}

void ruga_dynamic_save(const ruga_dynamic* d, double* memory) {
    size_t modes = 3 * (size_t)d->nodes, segments = (size_t)d->def.elastic.cut->segment_count;
    memcpy(memory, d->mode, modes * sizeof *memory);
    memcpy(memory + modes, d->elastic.angle, segments * sizeof *memory);
    memory[modes + segments] = d->limit;
}

void ruga_dynamic_load(ruga_dynamic* d, const double* memory) {
    size_t modes = 3 * (size_t)d->nodes, segments = (size_t)d->def.elastic.cut->segment_count;
    memcpy(d->mode, memory, modes * sizeof *memory);
    memcpy(d->elastic.angle, memory + modes, segments * sizeof *memory);
    d->limit = memory[modes + segments];
    d->fresh = false;
}

// ------------------------------------------------------------------------------- vectors

typedef struct vectors {
    const ruga_dynamic* d;
    const double *x, *y;
    double* out;
    double s;
} vectors;

// Sums over nodes by chunks, in their order.
static double sum_chunks(const ruga_dynamic* d, ruga_parallel_body* body, vectors* v) {
    double sum = 0;
    ruga_parallel_for(d->nodes, CHUNK, body, v);
    for (int k = 0; k < ruga_chunk_count(d->nodes, CHUNK); k++) {
        sum += d->partial[k];
    }
    return sum;
}

static void product_chunk(int begin, int end, int chunk, void* context) {
    const vectors* v = context;
    double sum = 0;
    for (int n = begin; n < end; n++) {
        double own = 0;
        for (int i = 3 * n; i < 3 * n + 3; i++) {
            own += v->d->held[i] ? 0 : v->x[i] * v->y[i];
        }
        sum += v->d->mass[n] * own;
    }
    v->d->partial[chunk] = sum;
}

// x^T M y over free nodes
static double mass_product(const ruga_dynamic* d, const double* x, const double* y) {
    return sum_chunks(d, product_chunk, &(vectors){.d = d, .x = x, .y = y});
}

static void add_chunk(int begin, int end, int chunk, void* context) {
    const vectors* v = context;
    (void)chunk;
    for (int i = 3 * begin; i < 3 * end; i++) {
        v->out[i] += v->s * v->x[i];
    }
}

// out += s x
static void add(const ruga_dynamic* d, double s, const double* x, double* out) {
    ruga_parallel_for(d->nodes, CHUNK, add_chunk, &(vectors){.d = d, .x = x, .out = out, .s = s});
}

static void scale_add_chunk(int begin, int end, int chunk, void* context) {
    const vectors* v = context;
    (void)chunk;
    for (int i = 3 * begin; i < 3 * end; i++) {
        v->out[i] = v->x[i] + v->s * v->out[i];
    }
}

static void kick_chunk(int begin, int end, int chunk, void* context) {
    const vectors* v = context;
    (void)chunk;
    for (int i = 3 * begin; i < 3 * end; i++) {
        v->out[i] += v->s * v->d->inverse_mass[i] * v->x[i];
    }
}

// v += dt f / m
static void kick(const ruga_dynamic* d, double dt, const double* force, double* v) {
    ruga_parallel_for(d->nodes, CHUNK, kick_chunk, &(vectors){.d = d, .x = force, .out = v, .s = dt});
}

// ------------------------------------------------------------------------------- sewing

// Pre-stabilisation for x and dt; without x post-stabilisation. Components are sewn alike where the same
// nodes are held along each, and each by itself otherwise. Uses d->d.
static void stabilise(ruga_dynamic* d, const double* x, double dt, double* v) {
    for (int axis = 0; axis < d->axes; axis++) {
        double* out = d->axes == 1 ? v : d->d;
        if (d->axes == 3) {
            memcpy(out, v, 3 * (size_t)d->nodes * sizeof *v);
        }
        if (x) {
            (void)ruga_stitch_before(d->stitch[axis], x, dt, out);
        } else {
            (void)ruga_stitch_after(d->stitch[axis], out);
        }
        for (int n = 0; n < d->nodes && d->axes == 3; n++) {
            v[3 * n + axis] = out[3 * n + axis];
        }
    }
}

// ------------------------------------------------------------------------------- damping

// out = M^-1 A v on free nodes, A = (1 + drag dt) M + dt D; 0 on held ones.
static void apply_damping(ruga_dynamic* d, double dt, const double* x, const double* v, double* out) {
    memset(out, 0, 3 * (size_t)d->nodes * sizeof *out);
    if (d->def.damping > 0) {
        ruga_elastic_damp(&d->elastic, dt * d->def.damping, x, v, out);
    }
    double own = 1 + d->def.drag * dt;
    for (int i = 0; i < 3 * d->nodes; i++) {
        out[i] = d->held[i] ? 0 : own * v[i] + d->inverse_mass[i] * out[i];
    }
}

// Conjugate gradients for A v' = M v from v' = v, preconditioned by M: r and p are M^-1 times residual and
// direction. Returns the number of products.
static int damp(ruga_dynamic* d, double dt, const double* x, double* v) {
    double *r = d->a, *p = d->b, *q = d->c, *start = d->d;
    size_t size = 3 * (size_t)d->nodes * sizeof *v;
    if (d->def.damping == 0 && d->def.drag == 0) {
        return 0;
    }
    memcpy(start, v, size);
    apply_damping(d, dt, x, v, q);
    for (int i = 0; i < 3 * d->nodes; i++) {
        r[i] = d->held[i] ? 0 : start[i] - q[i];
    }
    memcpy(p, r, size);
    double rr = mass_product(d, r, r), enough = DAMPED * DAMPED * mass_product(d, start, start);
    int products = 1;
    for (; rr > enough && products < MOST_DAMPING; products++) {
        apply_damping(d, dt, x, p, q);
        double part = rr / mass_product(d, p, q);
        add(d, part, p, v);
        add(d, -part, q, r);
        double next = mass_product(d, r, r);
        ruga_parallel_for(d->nodes, CHUNK, scale_add_chunk,
                          &(vectors){.d = d, .x = r, .out = p, .s = next / rr});
        rr = next;
    }
    return products;
}

// ------------------------------------------------------------------------------- step

static void set_force(ruga_dynamic* d, const ruga_dynamic_drive* drive, double time, const double* x,
                      ruga_elastic_energies* energies) {
    if (drive && drive->load) { // rest angles first
        memset(d->a, 0, 3 * (size_t)d->nodes * sizeof *d->a);
        drive->load(drive->context, time, x, d->a, d->rest);
        ruga_elastic_set_rest(&d->elastic, d->rest);
    }
    ruga_elastic_force(&d->elastic, x, d->force, energies);
    if (drive && drive->load) {
        add(d, 1, d->a, d->force);
    }
    for (int n = 0; n < d->nodes; n++) {
        ruga_add_scaled(d->mass[n], d->def.gravity, d->force + 3 * (size_t)n);
    }
    d->fresh = true;
}

// Velocities with which held nodes come to their places at `time`.
static void move_held(ruga_dynamic* d, const ruga_dynamic_drive* drive, double time, double dt,
                      const double* x, double* v) {
    bool moved = drive && drive->move;
    if (moved) {
        memcpy(d->a, x, 3 * (size_t)d->nodes * sizeof *x);
        drive->move(drive->context, time, d->a);
    }
    for (int i = 0; i < 3 * d->nodes; i++) {
        v[i] = d->held[i] ? (moved ? (d->a[i] - x[i]) / dt : 0) : v[i];
    }
}

void ruga_dynamic_start(ruga_dynamic* d, double* x, double* v) {
    stabilise(d, NULL, 0, x); // in the metric of masses
    stabilise(d, NULL, 0, v);
    ruga_elastic_start(&d->elastic, x);
    start_mode(d);
    d->fresh = false;
}

// Whether a node outruns the whole by an edge in dt, or something is not finite.
static bool is_wild(const ruga_dynamic* d, double dt, const double* v) {
    double mean[3] = {0, 0, 0}, most = d->edge / dt, fastest = 0;
    for (int n = 0; n < d->nodes; n++) {
        ruga_add_scaled(d->mass[n], v + 3 * (size_t)n, mean);
    }
    for (int i = 0; i < 3; i++) {
        mean[i] /= d->total_mass;
    }
    for (int n = 0; n < d->nodes; n++) {
        double own[3];
        ruga_subtract(v + 3 * (size_t)n, mean, own);
        double square = ruga_dot(own, own);
        fastest = square > fastest ? square : fastest;
    }
    return !(fastest < most * most) || !isfinite(mean[0] + mean[1] + mean[2]);
}

// Returns whether the step was wild. Where another one `follows`, what is not needed till then may be left.
static bool step(ruga_dynamic* d, const ruga_dynamic_drive* drive, double time, double dt, bool follows,
                 double* x, double* v, ruga_dynamic_report* report) {
    if (!d->fresh) {
        set_force(d, drive, time, x, &report->elastic);
    }
    kick(d, 0.5 * dt, d->force, v);
    move_held(d, drive, time + dt, dt, x, v);
    report->damping_products += damp(d, dt, x, v);
    stabilise(d, x, dt, v);
    bool wild = is_wild(d, dt, v);
    add(d, dt, v, x);
    set_force(d, drive, time + dt, x, &report->elastic);
    kick(d, 0.5 * dt, d->force, v);
    if (!follows || d->def.damping > 0) {
        stabilise(d, NULL, 0, v);
    }
    return wild;
}

void ruga_dynamic_step(ruga_dynamic* d, const ruga_dynamic_drive* drive, double time, double dt, double* x,
                       double* v, ruga_dynamic_report* report) {
    (void)step(d, drive, time, dt, false, x, v, report);
}

// ------------------------------------------------------------------------------- stability

// out = P M^-1 K u by a difference of forces; base is the elastic force at x.
static void apply_stiffness(ruga_dynamic* d, const double* x, const double* base, double step,
                            const double* u, double* place, double* out) {
    ruga_elastic_energies unused;
    memcpy(place, x, 3 * (size_t)d->nodes * sizeof *x);
    add(d, step, u, place);
    ruga_elastic_force(&d->elastic, place, out, &unused);
    for (int i = 0; i < 3 * d->nodes; i++) {
        out[i] = (base[i] - out[i]) * d->inverse_mass[i] / step;
    }
    stabilise(d, NULL, 0, out);
}

double ruga_dynamic_limit(ruga_dynamic* d, const double* x, int effort) {
    double *base = d->a, *image = d->b, *place = d->c, square = 0;
    ruga_elastic_energies unused;
    ruga_elastic_force(&d->elastic, x, base, &unused);
    stabilise(d, NULL, 0, d->mode);
    for (int k = 0; k < effort; k++) {
        double size = 0, norm = mass_product(d, d->mode, d->mode);
        for (int i = 0; i < 3 * d->nodes; i++) {
            size = fmax(size, fabs(d->mode[i]));
        }
        if (!(size > 0)) {
            break;
        }
        apply_stiffness(d, x, base, DIFFERENCE * d->edge / size, d->mode, place, image);
        square = fmax(mass_product(d, d->mode, image) / norm, 0);
        double scale = 1 / sqrt(fmax(mass_product(d, image, image), 1e-300));
        for (int i = 0; i < 3 * d->nodes; i++) {
            d->mode[i] = scale * image[i];
        }
    }
    ruga_elastic_force(&d->elastic, x, base, &unused); // angles, and what damping needs, of x itself
    return square > 0 ? 2 / sqrt(square) : INFINITY;
}

static bool try_steps(ruga_dynamic* d, const ruga_dynamic_drive* drive, double time, double duration,
                      int count, double* x, double* v, ruga_dynamic_report* report) {
    double dt = duration / count;
    d->fresh = false;
    for (int k = 0; k < count; k++) {
        if (step(d, drive, time + duration * k / count, dt, k + 1 < count, x, v, report)) {
            return false;
        }
    }
    d->limit = ruga_dynamic_limit(d, x, EFFORT);
    return dt < EDGE_OF_STABILITY * d->limit && !is_wild(d, dt, v);
}

ruga_status ruga_dynamic_advance(ruga_dynamic* d, const ruga_dynamic_drive* drive, double time,
                                 double duration, double* x, double* v, ruga_dynamic_report* report) {
    size_t size = 3 * (size_t)d->nodes * sizeof *x;
    *report = (ruga_dynamic_report){0};
    if (!(d->limit > 0)) {
        d->limit = ruga_dynamic_limit(d, x, FIRST_EFFORT);
    }
    double wanted = ceil(duration / (d->def.safety * d->limit));
    if (!(wanted <= MOST_STEPS)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "a time.step of %.3g s takes %.2g steps of motion, since none longer than %.2g s is "
                         "stable: use larger triangles, or a softer or denser skin",
                         duration, wanted, d->limit);
    }
    int count = wanted < 1 ? 1 : (int)wanted;
    memcpy(d->old_x, x, size);
    memcpy(d->old_v, v, size);
    ruga_dynamic_save(d, d->old_memory);
    while (!try_steps(d, drive, time, duration, count, x, v, report)) {
        if (++report->halvings > MOST_HALVINGS) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "the cloth cannot be stepped from %.6g s on: steps of %.3g s are still too long "
                             "for its forces; use a shorter time.step, a softer or thicker skin, or weaker "
                             "loads",
                             time, duration / count);
        }
        memcpy(x, d->old_x, size);
        memcpy(v, d->old_v, size);
        ruga_dynamic_load(d, d->old_memory);
        count *= 2;
    }
    report->substeps = count;
    report->limit = d->limit;
    report->gap = ruga_cut_gap(d->def.elastic.cut, x);
    report->kinetic = 0.5 * mass_product(d, v, v);
    return RUGA_OK;
}
