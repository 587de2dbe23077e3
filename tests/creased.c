// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// min E(x), W^T x = 0, with
//   E = sum over pieces f_p E_membrane + sum over bends f_b k_b/2 (theta - theta_b)^2          (k_b = D |e|^2
//   / (A1 + A2))
//     + sum over auxiliary chords k_c/2 theta^2 + sum over creases k l/2 (theta - theta0)^2 - sum m g.x,
// f the fractions of cut.h and A the areas of whole triangles; of an auxiliary chord those of the pieces
// beside it, as in a mesh that conforms. Newton's method on
//   [H W; W^T 0] [dx; lambda] = [-dE/dx; -W^T x],
// so that the rows are exact from the first step on. (Projecting after an unconstrained step would end
// elsewhere, and H alone is singular where a cut parts panels.) The exact Hessian is taken where the factor's
// inertia is that of a minimum on the null space of the rows, 3 rows negative pivots; otherwise the
// semi-definite one with a shift that grows until the inertia is right. Steps are capped at half an edge, and
// shortened by Armijo's rule. Of motion in a drag each step minimises E + sum m drag/2 |x - x_old|^2, drag in
// 1/s^2 the drag per mass over the time step.
#include "tests/creased.h"

#include "core/memory.h"
#include "core/sparse.h"
#include "core/vec3.h"
#include "crease/cloth.h"
#include "shell/membrane.h"
#include "solver/linear.h"

#include <math.h>
#include <string.h>

static const double SUFFICIENT = 1e-4;  // Armijo
static const double ROUND_OFF = 1e-4;   // a residual below this that no longer falls is left
static const double BLIND = 1e-10;      // of the energies' size
static const double FIRST_SHIFT = 1e-9; // of the largest diagonal entry
static const double CAP = 0.5;          // mean edges
static const double FORCE_FLOOR = 1e-8; // of E h times the mean edge
static const double EASING = 1.6;       // by which steps of motion grow

enum { MOST_STALE = 8, MOST_HALVINGS = 34, MOST_SHIFTS = 7, SETTLING = 10 };

struct ruga_creased {
    ruga_creased_def def;
    int nodes, rows, unknowns, hinge_count, bend_count;
    bool* fixed; // [nodes]
    ruga_sewing sewing;
    ruga_membrane_rest* membrane; // [pieces], times the fraction
    ruga_hinge* hinge;            // [hinges] the segments, then the bends
    double *stiffness, *rest;     // [hinges]
    double *near, *trial_near;    // [hinges] followed angles
    bool followed;
    double* mass;       // [nodes]
    double drag, *from; // 1/s^2; [3 nodes] where the step began
    double edge, force_scale;
    ruga_sparse pattern; // of the whole system
    ruga_factor* factor;
    double *right, *step, *trial, *gradient; // [unknowns]
};

ruga_creased_def ruga_default_creased_def(void) {
    return (ruga_creased_def){.skin = {.thickness = 0.002, .young = 20e6, .poisson = 0.3, .density = 900},
                              .tolerance = 1e-9,
                              .iterations = 200};
}

void ruga_creased_destroy(ruga_creased** creased) {
    ruga_creased* c = *creased;
    if (!c) {
        return;
    }
    ruga_release(c->fixed);
    ruga_sewing_clear(&c->sewing);
    ruga_release(c->membrane);
    ruga_release(c->hinge);
    ruga_release(c->stiffness);
    ruga_release(c->rest);
    ruga_release(c->near);
    ruga_release(c->trial_near);
    ruga_release(c->mass);
    ruga_release(c->from);
    ruga_sparse_clear(&c->pattern);
    ruga_factor_destroy(&c->factor);
    ruga_release(c->right);
    ruga_release(c->step);
    ruga_release(c->trial);
    ruga_release(c->gradient);
    ruga_release(c);
    *creased = NULL;
}

const double* ruga_creased_angles(const ruga_creased* creased) {
    return creased->near;
}

// ------------------------------------------------------------------------------- set-up

static ruga_status set_membrane(ruga_creased* c) {
    const ruga_raster* r = c->def.raster;
    const ruga_cut* cut = c->def.cut;
    const ruga_skin_def* skin = &c->def.skin;
    const double growth[2] = {1, 1};
    for (int p = 0; p < cut->piece_count; p++) {
        const double* x[3];
        for (int i = 0; i < 3; i++) {
            x[i] = r->mesh.position + 3 * (size_t)cut->source[cut->piece[p].node[i]];
        }
        ruga_membrane_rest* rest = &c->membrane[p];
        double area = ruga_membrane_rest_create(x, skin->poisson, growth, skin->thickness, skin->young, rest);
        if (!(area > 0)) {
            return ruga_fail(RUGA_BAD_MESH, "face %d near (%.6g, %.6g, %.6g) has no area",
                             cut->piece[p].triangle, x[0][0], x[0][1], x[0][2]);
        }
        rest->stretch *= cut->piece[p].fraction;
        rest->shear *= cut->piece[p].fraction;
    }
    return RUGA_OK;
}

// The segments, then the bends as hinges of unit length.
static void set_hinges(ruga_creased* c) {
    const ruga_raster* r = c->def.raster;
    const ruga_cut* cut = c->def.cut;
    const ruga_skin_def* skin = &c->def.skin;
    double rigidity = skin->young * pow(skin->thickness, 3) / (12 * (1 - skin->poisson * skin->poisson));
    double *bend = c->stiffness + cut->segment_count, *chord = c->stiffness;
    ruga_hinges_make(r, cut, c->hinge);
    ruga_bends_make(r, cut, c->hinge + cut->segment_count);
    ruga_bend_stiffness(r, cut, bend, chord);
    for (int h = 0; h < c->hinge_count; h++) {
        c->stiffness[h] =
            c->hinge[h].curve >= 0 ? c->def.stiffness[h] : rigidity * c->stiffness[h] / c->hinge[h].length;
    }
    double* rest = c->trial; // the mesh may be curved at rest
    ruga_cut_rest(r, cut, rest);
    for (int h = 0; h < c->hinge_count; h++) {
        c->rest[h] = ruga_hinge_measure(&c->hinge[h], rest, NULL, NULL);
    }
}

static ruga_status set_mass(ruga_creased* c) {
    const ruga_raster* r = c->def.raster;
    double* triangle = NULL;
    RUGA_TRY(RUGA_NEW(triangle, r->mesh.triangle_count));
    for (int f = 0; f < r->mesh.triangle_count; f++) {
        triangle[f] = c->def.skin.density * c->def.skin.thickness * ruga_mesh_triangle_area(&r->mesh, f);
    }
    ruga_cut_masses(c->def.cut, triangle, 0, true, c->mass);
    ruga_release(triangle);
    return RUGA_OK;
}

// Blocks: the nodes, then one for each row.
static ruga_status set_pattern(ruga_creased* c) {
    const ruga_sewing* s = &c->sewing;
    int(*pair)[2] = NULL;
    int64_t count = 0;
    RUGA_TRY(RUGA_NEW(pair, 3 * (size_t)c->def.cut->piece_count + 15 * (size_t)c->hinge_count +
                                (size_t)s->start[s->row_count]));
    for (int p = 0; p < c->def.cut->piece_count; p++) {
        for (int i = 0; i < 3; i++) {
            const int* node = c->def.cut->piece[p].node;
            memcpy(pair[count++], (const int[2]){node[i], node[(i + 1) % 3]}, sizeof *pair);
        }
    }
    for (int h = 0; h < c->hinge_count; h++) {
        for (int i = 0; i < RUGA_HINGE_NODES; i++) {
            for (int j = 0; j < i; j++) {
                memcpy(pair[count++], (const int[2]){c->hinge[h].node[i], c->hinge[h].node[j]}, sizeof *pair);
            }
        }
    }
    for (int r = 0; r < s->row_count; r++) {
        for (int k = s->start[r]; k < s->start[r + 1]; k++) {
            memcpy(pair[count++], (const int[2]){c->nodes + r, s->node[k]}, sizeof *pair);
        }
    }
    ruga_status status =
        ruga_sparse_from_pairs(c->nodes + c->rows, 3, count, (const int(*)[2])pair, &c->pattern);
    ruga_release(pair);
    return status;
}

static ruga_status make_factor(ruga_creased* c) {
    int blocks = c->nodes + c->rows, *start = NULL;
    bool* last = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(start, (size_t)blocks + 1));
    RUGA_TRY_DONE(RUGA_NEW(last, blocks));
    for (int b = 0; b <= blocks; b++) {
        start[b] = 3 * b;
    }
    for (int b = 0; b < blocks; b++) {
        last[b] = b >= c->nodes;
    }
    RUGA_TRY_DONE(ruga_factor_create(RUGA_FACTOR_LDL, &c->pattern, blocks, start, last, &c->factor));
done:
    ruga_release(start);
    ruga_release(last);
    return status;
}

static ruga_status allocate(ruga_creased* c) {
    const ruga_cut* cut = c->def.cut;
    c->nodes = cut->node_count;
    RUGA_TRY(RUGA_NEW_ZERO(c->fixed, c->nodes));
    if (c->def.fixed) {
        memcpy(c->fixed, c->def.fixed, (size_t)c->nodes * sizeof *c->fixed);
    }
    for (int n = 0; n < c->nodes; n++) { // a vertex that no face uses stays where it is
        c->fixed[n] = c->fixed[n] || c->def.raster->edges.incident_start[cut->source[n]] ==
                                         c->def.raster->edges.incident_start[cut->source[n] + 1];
    }
    RUGA_TRY(ruga_sewing_create(cut, c->fixed, &c->sewing));
    c->rows = c->sewing.row_count;
    c->unknowns = 3 * (c->nodes + c->rows);
    c->hinge_count = cut->segment_count + cut->bend_count;
    RUGA_TRY(RUGA_NEW(c->membrane, cut->piece_count));
    RUGA_TRY(RUGA_NEW(c->hinge, c->hinge_count));
    RUGA_TRY(RUGA_NEW(c->stiffness, c->hinge_count));
    RUGA_TRY(RUGA_NEW(c->rest, c->hinge_count));
    RUGA_TRY(RUGA_NEW_ZERO(c->near, c->hinge_count));
    RUGA_TRY(RUGA_NEW(c->trial_near, c->hinge_count));
    RUGA_TRY(RUGA_NEW(c->mass, c->nodes));
    RUGA_TRY(RUGA_NEW(c->from, 3 * (size_t)c->nodes));
    RUGA_TRY(RUGA_NEW(c->right, c->unknowns));
    RUGA_TRY(RUGA_NEW(c->step, c->unknowns));
    RUGA_TRY(RUGA_NEW(c->trial, c->unknowns));
    return RUGA_NEW(c->gradient, c->unknowns);
}

ruga_status ruga_creased_create(const ruga_creased_def* def, ruga_creased** creased) {
    ruga_status status = RUGA_OK;
    ruga_creased* c = NULL;
    *creased = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(c, 1));
    c->def = *def;
    c->edge = ruga_mesh_mean_edge(&def->raster->mesh);
    c->force_scale = FORCE_FLOOR * def->skin.young * def->skin.thickness * c->edge;
    RUGA_TRY_DONE(allocate(c));
    RUGA_TRY_DONE(set_membrane(c));
    set_hinges(c);
    RUGA_TRY_DONE(set_mass(c));
    RUGA_TRY_DONE(set_pattern(c));
    RUGA_TRY_DONE(make_factor(c));
    *creased = c;
done:
    if (status != RUGA_OK) {
        ruga_creased_destroy(&c);
    }
    return status;
}

// ------------------------------------------------------------------------------- energy

typedef struct energies {
    double membrane, bending, hinge, external, drag, force_square;
} energies;

static void add_block(ruga_creased* c, int i, int j, const double block[9]) {
    for (int k = 0; k < 3; k++) {
        for (int m = 0; m < 3; m++) {
            int row = 3 * i + k, column = 3 * j + m;
            if (row >= column) {
                c->pattern.value[ruga_sparse_find(&c->pattern, row, column)] += block[3 * k + m];
            } else if (i != j) {
                c->pattern.value[ruga_sparse_find(&c->pattern, column, row)] += block[3 * k + m];
            }
        }
    }
}

static void add_membrane(ruga_creased* c, const double* x, double clamp, bool second, energies* e) {
    const ruga_cut* cut = c->def.cut;
    for (int p = 0; p < cut->piece_count; p++) {
        const int* node = cut->piece[p].node;
        const double* at[3] = {x + 3 * (size_t)node[0], x + 3 * (size_t)node[1], x + 3 * (size_t)node[2]};
        double gradient[3][3], block[RUGA_TRIANGLE_BLOCKS][9];
        e->membrane +=
            ruga_membrane_energy(c->def.skin.membrane, c->def.skin.poisson, &c->membrane[p], at, gradient);
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(1, gradient[i], c->gradient + 3 * (size_t)node[i]);
            e->force_square += ruga_dot(gradient[i], gradient[i]);
        }
        if (second) {
            ruga_membrane_hessian(c->def.skin.membrane, c->def.skin.poisson, &c->membrane[p], at, clamp,
                                  block);
            for (int b = 0; b < RUGA_TRIANGLE_BLOCKS; b++) {
                add_block(c, node[ruga_triangle_block_corner[b][0]], node[ruga_triangle_block_corner[b][1]],
                          block[b]);
            }
        }
    }
}

// Elements beside a hinge may share nodes.
static void add_hinge_hessian(ruga_creased* c, const ruga_hinge* hinge,
                              const double hessian[RUGA_HINGE_UNKNOWNS][RUGA_HINGE_UNKNOWNS]) {
    for (int b = 0; b < RUGA_HINGE_UNKNOWNS; b++) {
        int column = 3 * hinge->node[b / 3] + b % 3;
        for (int a = 0; a < RUGA_HINGE_UNKNOWNS; a++) {
            int row = 3 * hinge->node[a / 3] + a % 3;
            if (row >= column) {
                c->pattern.value[ruga_sparse_find(&c->pattern, row, column)] += hessian[a][b];
            }
        }
    }
}

static void add_hinges(ruga_creased* c, const double* x, double clamp, bool second, energies* e) {
    for (int h = 0; h < c->hinge_count; h++) {
        double gradient[RUGA_HINGE_NODES][3], hessian[RUGA_HINGE_UNKNOWNS][RUGA_HINGE_UNKNOWNS];
        const ruga_hinge* hinge = &c->hinge[h];
        double energy = ruga_hinge_energy(hinge, c->stiffness[h], c->rest[h], x, &c->near[h], clamp, gradient,
                                          second ? hessian : NULL);
        if (second) {
            add_hinge_hessian(c, hinge, (const double(*)[RUGA_HINGE_UNKNOWNS])hessian);
        }
        c->trial_near[h] = ruga_hinge_measure(hinge, x, &c->near[h], NULL);
        *(h < c->def.cut->segment_count && hinge->curve >= 0 ? &e->hinge : &e->bending) += energy;
        for (int a = 0; a < RUGA_HINGE_NODES; a++) {
            ruga_add_scaled(1, gradient[a], c->gradient + 3 * (size_t)hinge->node[a]);
            e->force_square += ruga_dot(gradient[a], gradient[a]);
        }
    }
}

static void add_drag(ruga_creased* c, const double* x, bool second, energies* e) {
    for (int i = 0; i < 3 * c->nodes; i++) {
        double k = c->drag * c->mass[i / 3], d = x[i] - c->from[i];
        e->drag += 0.5 * k * d * d;
        c->gradient[i] += k * d;
        if (second) {
            c->pattern.value[c->pattern.start[i]] += k;
        }
    }
}

static double total(const energies* e) {
    return e->membrane + e->bending + e->hinge + e->external + e->drag;
}

// Energies at x; c->gradient [3 nodes] is set, and with `second` the system's matrix without a shift.
static double evaluate(ruga_creased* c, const double* x, double clamp, bool second, energies* e) {
    const ruga_sewing* s = &c->sewing;
    *e = (energies){0};
    memset(c->gradient, 0, (size_t)c->unknowns * sizeof *c->gradient);
    if (second) {
        memset(c->pattern.value, 0, (size_t)c->pattern.start[c->unknowns] * sizeof *c->pattern.value);
    }
    add_membrane(c, x, clamp, second, e);
    add_hinges(c, x, clamp, second, e);
    for (int n = 0; n < c->nodes; n++) {
        e->external -= c->mass[n] * ruga_dot(c->def.gravity, x + 3 * (size_t)n);
        ruga_add_scaled(-c->mass[n], c->def.gravity, c->gradient + 3 * (size_t)n);
        e->force_square += c->mass[n] * c->mass[n] * ruga_dot(c->def.gravity, c->def.gravity);
    }
    if (c->drag > 0) {
        add_drag(c, x, second, e);
    }
    for (int r = 0; second && r < s->row_count; r++) {
        for (int k = s->start[r]; k < s->start[r + 1]; k++) {
            const double w = s->weight[k], block[9] = {w, 0, 0, 0, w, 0, 0, 0, w};
            add_block(c, c->nodes + r, s->node[k], block);
        }
    }
    return total(e);
}

// Held nodes keep their place: a diagonal of their own, and nothing else in row and column.
static double hold_and_shift(ruga_creased* c, double shift) {
    ruga_sparse* a = &c->pattern;
    double largest = 0;
    for (int j = 0; j < 3 * c->nodes; j++) {
        largest = fmax(largest, fabs(a->value[a->start[j]]));
    }
    for (int j = 0; j < c->unknowns; j++) {
        bool held = j < 3 * c->nodes && c->fixed[j / 3];
        for (int p = a->start[j]; p < a->start[j + 1]; p++) {
            int i = a->index[p];
            bool either = held || (i < 3 * c->nodes && c->fixed[i / 3]);
            a->value[p] = either ? (i == j ? largest : 0) : a->value[p];
        }
        if (j < 3 * c->nodes && !held) {
            a->value[a->start[j]] += shift * largest;
        }
    }
    return largest;
}

// ------------------------------------------------------------------------------- Newton

static ruga_status factorise(ruga_creased* c, const double* x, double clamp, double shift, energies* e,
                             ruga_creased_report* report, bool* right_inertia) {
    ruga_factor_info info;
    (void)evaluate(c, x, clamp, true, e);
    (void)hold_and_shift(c, shift);
    RUGA_TRY(ruga_factor_numeric(c->factor, c->pattern.value, &info));
    report->factorizations++;
    *right_inertia = info.zero == 0 && info.negative == 3 * c->rows;
    return RUGA_OK;
}

// A factor with the inertia of a minimum: the exact one, or one with a shift. *exact tells.
static ruga_status find_factor(ruga_creased* c, const double* x, energies* e, ruga_creased_report* report,
                               bool* exact) {
    bool good = false;
    RUGA_TRY(factorise(c, x, 0, 0, e, report, &good));
    *exact = good;
    double shift = FIRST_SHIFT;
    for (int k = 0; !good && k < MOST_SHIFTS; k++, shift *= 100) {
        RUGA_TRY(factorise(c, x, 1, shift, e, report, &good));
    }
    return good ? RUGA_OK
                : ruga_fail(RUGA_LIBRARY,
                            "the tangent of the creased shell has no factor with the right inertia");
}

// The step and the multipliers from the factor at hand; returns the relative residual of the Lagrangian.
static ruga_status solve_step(ruga_creased* c, const double* x, const energies* e, double* residual) {
    for (int i = 0; i < 3 * c->nodes; i++) {
        c->right[i] = c->fixed[i / 3] ? 0 : -c->gradient[i];
    }
    ruga_sewing_gaps(&c->sewing, x, c->right + 3 * (size_t)c->nodes);
    for (int i = 3 * c->nodes; i < c->unknowns; i++) {
        c->right[i] = -c->right[i];
    }
    RUGA_TRY(ruga_factor_solve(c->factor, c->right, c->step));
    // -(dE/dx + W lambda) on free nodes
    double square = 0;
    ruga_sewing_spread(&c->sewing, NULL, -1, c->step + 3 * (size_t)c->nodes, c->right);
    for (int i = 0; i < 3 * c->nodes; i++) {
        square += c->fixed[i / 3] ? 0 : c->right[i] * c->right[i];
    }
    *residual = sqrt(square) / fmax(sqrt(e->force_square), c->force_scale);
    return RUGA_OK;
}

// Takes as much of the step as lowers the energy enough; false where nothing does.
static bool search(ruga_creased* c, double* x, const energies* now) {
    double slope = 0, longest = 0, energy = total(now);
    double magnitude = now->membrane + now->bending + now->hinge + fabs(now->external) + now->drag;
    energies e;
    for (int n = 0; n < c->nodes; n++) {
        slope += c->fixed[n] ? 0 : ruga_dot(c->gradient + 3 * (size_t)n, c->step + 3 * (size_t)n);
        longest = fmax(longest, ruga_norm(c->step + 3 * (size_t)n));
    }
    double start = longest > CAP * c->edge ? CAP * c->edge / longest : 1;
    // Where the step promises less than energies can tell apart, the Newton step is taken as it is.
    bool blind = fabs(slope) <= BLIND * magnitude;
    double part = start;
    for (int k = 0; k < MOST_HALVINGS; k++, part *= 0.5) {
        for (int i = 0; i < 3 * c->nodes; i++) {
            c->trial[i] = x[i] + part * c->step[i];
        }
        if (evaluate(c, c->trial, 0, false, &e) <= energy + SUFFICIENT * part * fmin(slope, 0) || blind) {
            memcpy(x, c->trial, 3 * (size_t)c->nodes * sizeof *x);
            memcpy(c->near, c->trial_near, (size_t)c->hinge_count * sizeof *c->near);
            return true;
        }
    }
    return false;
}

static void report_energies(const energies* e, ruga_creased_report* report) {
    report->membrane = e->membrane;
    report->bending = e->bending;
    report->hinge = e->hinge;
    report->external = e->external;
}

ruga_status ruga_creased_solve(ruga_creased* c, const double* rest, double* x, ruga_creased_report* report) {
    energies e;
    bool exact = false;
    *report = (ruga_creased_report){.outcome = RUGA_OUTCOME_NOT_CONVERGED};
    for (int s = 0; s < c->def.cut->segment_count; s++) {
        c->rest[s] = c->hinge[s].curve >= 0 ? rest[s] : c->rest[s];
    }
    for (int h = 0; h < c->hinge_count && !c->followed; h++) {
        c->near[h] = ruga_hinge_measure(&c->hinge[h], x, NULL, NULL);
    }
    c->followed = true;
    int stale = 0; // iterations since the residual last fell by a half
    double best = INFINITY;
    for (;; report->iterations++) {
        RUGA_TRY(find_factor(c, x, &e, report, &exact));
        RUGA_TRY(solve_step(c, x, &e, &report->residual));
        report->gap = ruga_cut_gap(c->def.cut, x);
        report_energies(&e, report);
        if (report->residual <= c->def.tolerance && report->gap <= c->def.tolerance * c->edge) {
            report->outcome = exact ? RUGA_OUTCOME_MINIMUM : RUGA_OUTCOME_SADDLE;
            return RUGA_OK;
        }
        bool fell = report->residual < 0.5 * best;
        best = fell ? report->residual : best;
        stale = fell ? 0 : stale + 1;
        bool round_off = stale > MOST_STALE && report->residual < ROUND_OFF;
        if (round_off || report->iterations == c->def.iterations || !search(c, x, &e)) {
            return RUGA_OK;
        }
    }
}

ruga_status ruga_creased_settle(ruga_creased* c, const double* rest, double* x, ruga_creased_report* report) {
    int iterations = 0, factorizations = 0;
    ruga_status status = RUGA_OK;
    c->drag =
        ruga_norm(c->def.gravity) / (CAP * c->edge); // what falls freely falls by that much in the first step
    for (int step = 0; step <= SETTLING && status == RUGA_OK; step++) {
        memcpy(c->from, x, 3 * (size_t)c->nodes * sizeof *x);
        status = ruga_creased_solve(c, rest, x, report);
        iterations += report->iterations;
        factorizations += report->factorizations;
        c->drag = step + 1 < SETTLING ? c->drag / EASING : 0;
    }
    c->drag = 0;
    report->iterations = iterations;
    report->factorizations = factorizations;
    return status;
}
