// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The coupled step; see interior.h. With t the force gradient that the skin hands to the embedded surface,
//     r(q) = dE_q/dq + M-terms - weight + B^T t,   t = grad(shell + loads)(x*) = -(W d + H^T l),  d = x* - B q,
// Newton's matrix is K_q + M-terms + B^T (dt/dBq) B. One product with dt/dBq for u = B dq is
//     [K + W  H^T; H 0] [e; dl] = [-(K u); 0],   dx = u + e,   dt = K dx,
// so conjugate gradients, preconditioned by a factor of K_q + M-terms + B^T K B (skin following), find dq with a
// few such solves. Where the skin alone is held (hold: skin), dx = 0 there and t keeps its second form.
#include "solver/interior.h"

#include "core/memory.h"
#include "core/progress.h"

#include <math.h>
#include <string.h>

// STALE_CG: products of one direction beyond which a preconditioner is renewed.
enum { MAX_NEWTON = 60, MAX_CG = 80, STALE_CG = 12, MAX_BACKTRACKS = 20 };
enum { RESIDUAL, DIRECTION, CG_R, CG_Z, CG_P, CG_AP, SIDE, SOLUTION, TRIAL_Q, ELASTIC }; // interior vectors
enum { GRADIENT, PRESS, BU, MOVE, IMAGE, TRIAL_X };                                      // surface vectors

// A chord step serves where it takes the residual down to this part.
static const double CHORD = 0.25;

static double* interior_vector(ruga_interior* in, int i) {
    return in->memory + (size_t)i * (size_t)(in->n + in->m);
}

static double* surface_vector(ruga_interior* in, int i) {
    return in->surface + (size_t)i * (size_t)in->skin->n;
}

// ---- creation ------------------------------------------------------------------------------------------

static ruga_status create_kkt(ruga_interior* in) {
    const ruga_sparse* k = ruga_elasticity_pattern(in->elasticity);
    const ruga_rows* rows = &in->model->rows;
    int n = in->n, m = in->m;
    int entries = rows->count ? rows->start[rows->count] : 0;
    ruga_sparse* kkt = &in->kkt;
    ruga_status status = RUGA_OK;
    int* fill = NULL;
    kkt->rows = kkt->columns = n + m;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(fill, n + 1));
    RUGA_TRY_DONE(RUGA_NEW(kkt->start, n + m + 1));
    RUGA_TRY_DONE(RUGA_NEW(kkt->index, (size_t)k->start[n] + (size_t)entries + (size_t)m));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(kkt->value, (size_t)k->start[n] + (size_t)entries + (size_t)m));
    RUGA_TRY_DONE(RUGA_NEW(in->column_shift, n));
    for (int r = 0; r < m; r++) {
        for (int p = rows->start[r]; p < rows->start[r + 1]; p++) {
            fill[3 * rows->node[p] + rows->axis[r]]++;
        }
    }
    int out = 0;
    for (int j = 0; j < n; j++) {
        kkt->start[j] = out;
        in->column_shift[j] = out - k->start[j];
        memcpy(kkt->index + out, k->index + k->start[j], (size_t)(k->start[j + 1] - k->start[j]) * sizeof(int));
        out += k->start[j + 1] - k->start[j];
        int count = fill[j];
        fill[j] = out;
        out += count;
    }
    for (int r = 0; r < m; r++) {
        for (int p = rows->start[r]; p < rows->start[r + 1]; p++) {
            int at = fill[3 * rows->node[p] + rows->axis[r]]++;
            kkt->index[at] = n + r;
            kkt->value[at] = rows->weight[p];
        }
    }
    for (int r = 0; r < m; r++) {
        kkt->start[n + r] = out;
        kkt->index[out++] = n + r;
    }
    kkt->start[n + m] = out;
done:
    ruga_release(fill);
    return status;
}

static ruga_status create_factor(ruga_interior* in) {
    ruga_status status = RUGA_OK;
    int nodes = in->n / 3 + in->m, *start = NULL;
    bool* last = NULL;
    RUGA_TRY_DONE(RUGA_NEW(start, nodes + 1));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(last, nodes));
    for (int i = 0; i <= nodes; i++) {
        start[i] = i <= in->n / 3 ? 3 * i : in->n + i - in->n / 3;
        if (i >= in->n / 3 && i < nodes) {
            last[i] = true;
        }
    }
    RUGA_TRY_DONE(ruga_factor_create(in->m ? RUGA_FACTOR_LDL : RUGA_FACTOR_CHOLESKY, &in->kkt, nodes, start,
                                     in->m ? last : NULL, &in->factor));
done:
    ruga_release(start);
    ruga_release(last);
    return status;
}

static void multiply_pattern(const ruga_interior* in, double* values, const double* x, double* y) {
    ruga_sparse k = *ruga_elasticity_pattern(in->elasticity);
    k.value = values;
    ruga_sparse_multiply_symmetric(&k, x, y);
}

// Gravity on the interior alone (the skin's acts on the skin), then the mass with the skin's added through B.
static ruga_status create_mass(ruga_interior* in) {
    const ruga_model* model = in->model;
    double* g = interior_vector(in, TRIAL_Q);
    RUGA_TRY(ruga_elasticity_mass(in->elasticity, model->interior.density, NULL, in->mass));
    for (int i = 0; i < in->n; i++) {
        g[i] = model->gravity[i % 3];
    }
    multiply_pattern(in, in->mass, g, in->weight);
    return ruga_elasticity_mass(in->elasticity, model->interior.density, in->skin->mass, in->mass);
}

ruga_status ruga_interior_create(const ruga_model* model, ruga_skin* skin, ruga_interior** out) {
    ruga_status status = RUGA_OK;
    ruga_interior* in = NULL;
    *out = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(in, 1));
    in->model = model;
    in->skin = skin;
    in->n = 3 * model->lattice.node_count;
    in->m = model->rows.count;
    RUGA_TRY_DONE(ruga_elasticity_create(&model->lattice, model->interior.young, model->interior.poisson,
                                         ruga_shell_pattern(skin->shell), &in->elasticity));
    size_t entries = (size_t)ruga_elasticity_pattern(in->elasticity)->start[in->n];
    RUGA_TRY_DONE(RUGA_NEW(in->mass, entries));
    RUGA_TRY_DONE(RUGA_NEW(in->stiffness, entries));
    RUGA_TRY_DONE(RUGA_NEW(in->skin_stiffness, ruga_shell_pattern(skin->shell)->start[skin->n]));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(in->weight, in->n));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(in->target, in->m));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(in->start, in->n));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(in->previous, in->n));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(in->memory, (size_t)RUGA_INTERIOR_VECTORS * (size_t)(in->n + in->m)));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(in->surface, (size_t)RUGA_SURFACE_VECTORS * (size_t)skin->n));
    RUGA_TRY_DONE(create_mass(in));
    RUGA_TRY_DONE(create_kkt(in));
    RUGA_TRY_DONE(create_factor(in));
done:
    if (status != RUGA_OK) {
        ruga_interior_destroy(&in);
    }
    *out = in;
    return status;
}

void ruga_interior_destroy(ruga_interior** interior) {
    ruga_interior* in = *interior;
    if (!in) {
        return;
    }
    ruga_elasticity_destroy(&in->elasticity);
    ruga_sparse_clear(&in->kkt);
    ruga_factor_destroy(&in->factor);
    void* const owned[] = {in->mass,   in->weight, in->column_shift, in->stiffness, in->skin_stiffness,
                           in->target, in->start,  in->previous,     in->memory,    in->surface};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    ruga_release(in);
    *interior = NULL;
}

void ruga_interior_set_targets(ruga_interior* in, double time) {
    const ruga_rows* rows = &in->model->rows;
    for (int r = 0; r < in->m; r++) {
        double target[3];
        ruga_handle_target(&in->model->handles[rows->handle[r]], time, rows->point + 3 * (size_t)r, target);
        in->target[r] = target[rows->axis[r]];
    }
}

// ---- energy and residual -------------------------------------------------------------------------------

// Terms of q alone. gradient [n] SET where not NULL; *force_square: of the elements and the weight.
static ruga_status energy_of_q(ruga_interior* in, const double* q, ruga_interior_result* result, double* total,
                               double* gradient, double* force_square) {
    double *d = interior_vector(in, SIDE), *md = interior_vector(in, SOLUTION);
    RUGA_TRY(ruga_elasticity_energy(in->elasticity, q, false, &result->elastic, gradient, NULL, force_square));
    result->weight = -ruga_dot_product(in->n, in->weight, q);
    result->kinetic = 0;
    if (in->mass_factor > 0) {
        for (int i = 0; i < in->n; i++) {
            d[i] = in->mass_factor * (q[i] - in->start[i]) + in->damping_factor * (q[i] - in->previous[i]);
        }
        multiply_pattern(in, in->mass, d, md);
        for (int i = 0; i < in->n; i++) {
            // Half of (a y.My + b z.Mz), with y, z the two differences, up to a constant of the step.
            double mean = 0.5 * (q[i] - (in->mass_factor * in->start[i] + in->damping_factor * in->previous[i]) /
                                            (in->mass_factor + in->damping_factor));
            result->kinetic += mean * md[i];
        }
    }
    *total = result->elastic + result->weight + result->kinetic;
    for (int i = 0; i < in->n && gradient; i++) {
        gradient[i] += (in->mass_factor > 0 ? md[i] : 0) - in->weight[i];
    }
    if (force_square) {
        *force_square += ruga_dot_product(in->n, in->weight, in->weight);
    }
    return RUGA_OK;
}

static bool skin_only(const ruga_interior* in, int i) {
    int h = in->model->skin_handle[i];
    return h >= 0 && in->model->handles[h].hold == RUGA_HOLD_SKIN;
}

// y = W v
static void multiply_foundation(const ruga_interior* in, const double* v, double* y) {
    double unused;
    memset(y, 0, (size_t)in->skin->n * sizeof *y);
    if (in->model->foundation.vertex_count) {
        ruga_foundation_energy(&in->model->foundation, v, y, &unused);
    }
}

// t from the skin's full gradient at its minimum x; see the head of this file.
static ruga_status surface_force(ruga_interior* in, const double* x, const double* embedded,
                                 const double* gradient, double* t) {
    ruga_skin* skin = in->skin;
    double *d = surface_vector(in, BU), *held = surface_vector(in, IMAGE);
    for (int i = 0; i < skin->n; i++) {
        d[i] = x[i] - embedded[i];
    }
    multiply_foundation(in, d, t);
    for (int i = 0; i < skin->n; i++) {
        double foundation = t[i];
        t[i] = gradient[i] - foundation;
        d[i] = foundation;
    }
    if (!in->model->any_skin_held || !in->model->solves_skin) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_skin_project(skin, gradient, held)); // for the multiplier
    memset(held, 0, (size_t)skin->n * sizeof *held);
    ruga_clusters_apply_transpose(&in->model->clusters, skin->multiplier, held);
    for (int i = 0; i < skin->n; i++) {
        t[i] = skin_only(in, i) ? -(d[i] + held[i]) : t[i];
    }
    return RUGA_OK;
}

// z = preconditioner r, with A z = 0; r loses A^T mu, what the handles bear, with mu from the same system. Near the solution that is
// nearly all of r, and its round-off would drown the rest (Gould, Hribar and Nocedal 2001, the residual update).
static ruga_status precondition(ruga_interior* in, double* r, double* z) {
    double *side = interior_vector(in, SIDE), *solution = interior_vector(in, SOLUTION);
    const ruga_rows* rows = &in->model->rows;
    memcpy(side, r, (size_t)in->n * sizeof *side);
    memset(side + in->n, 0, (size_t)in->m * sizeof *side);
    RUGA_TRY(ruga_factor_solve(in->factor, side, solution));
    for (int k = 0; k < in->m; k++) {
        for (int p = rows->start[k]; p < rows->start[k + 1]; p++) {
            r[3 * rows->node[p] + rows->axis[k]] -= rows->weight[p] * solution[in->n + k];
        }
    }
    memcpy(z, solution, (size_t)in->n * sizeof *z);
    return RUGA_OK;
}

// r(q) at the skin's minimum, free of the held rows' part, and its norm by the reference force.
static ruga_status residual(ruga_interior* in, const double* q, const double* x, const double* embedded,
                            ruga_interior_result* result, double* total, double* r) {
    ruga_skin* skin = in->skin;
    double *gradient = surface_vector(in, GRADIENT), *t = surface_vector(in, PRESS);
    double *side = interior_vector(in, SIDE), *z = interior_vector(in, CG_Z), force_square;
    RUGA_TRY(ruga_skin_energy(skin, x, &result->skin.terms, gradient));
    RUGA_TRY(surface_force(in, x, embedded, gradient, t));
    RUGA_TRY(energy_of_q(in, q, result, total, r, &force_square));
    *total += result->skin.terms.total;
    memset(side, 0, (size_t)(in->n + in->m) * sizeof *side);
    ruga_lattice_embed_transpose(&in->model->lattice, t, side);
    force_square += ruga_dot_product(in->n, side, side);
    for (int i = 0; i < in->n; i++) {
        r[i] += side[i];
    }
    RUGA_TRY(precondition(in, r, z));
    double floor = ruga_model_force_floor(in->model);
    result->residual = sqrt(ruga_dot_product(in->n, r, r)) / fmax(sqrt(force_square), floor);
    return RUGA_OK;
}

// ---- matrices ------------------------------------------------------------------------------------------

// Adds the inertia terms, and without any, a trace of stiffness that keeps free bodies from drifting (it acts on the
// step only and leaves the solution alone).
static void add_inertia(const ruga_interior* in, double* values) {
    const ruga_sparse* k = ruga_elasticity_pattern(in->elasticity);
    double s = in->mass_factor + in->damping_factor;
    for (int p = 0; p < k->start[in->n] && s > 0; p++) {
        values[p] += s * in->mass[p];
    }
    for (int j = 0; j < in->n && s == 0; j++) {
        values[k->start[j]] *= 1 + 1e-7;
    }
}

// Where the skin alone is held it does not follow: there the interior is tied to a fixed point by the foundation,
// and its neighbours' shell forces act as against a wall.
static void hold_skin_stiffness(ruga_interior* in, const ruga_sparse* k) {
    const ruga_foundation* foundation = &in->model->foundation;
    bool any = false;
    for (int i = 0; i < in->skin->n && !any; i++) {
        any = skin_only(in, i);
    }
    for (int j = 0; j < in->skin->n && any; j++) {
        for (int p = k->start[j]; p < k->start[j + 1]; p++) {
            if (skin_only(in, j) || skin_only(in, k->index[p])) {
                bool diagonal = p == k->start[j] && foundation->vertex_count > 0;
                k->value[p] = diagonal ? foundation->diagonal[j / 3] : 0;
            }
        }
    }
}

// The factor of K_q + M-terms + B^T K B at q and x, both parts made positive semi-definite.
static ruga_status factor_preconditioner(ruga_interior* in, const double* q, const double* x) {
    const ruga_sparse* k = ruga_elasticity_pattern(in->elasticity);
    double energy;
    ruga_sparse skin_matrix = *ruga_shell_pattern(in->skin->shell);
    skin_matrix.value = in->skin_stiffness;
    RUGA_TRY(ruga_elasticity_energy(in->elasticity, q, true, &energy, NULL, in->stiffness, NULL));
    add_inertia(in, in->stiffness);
    RUGA_TRY(ruga_shell_energy(in->skin->shell, x, 1, NULL, NULL, in->skin_stiffness));
    hold_skin_stiffness(in, &skin_matrix);
    RUGA_TRY(ruga_elasticity_add_embedded(in->elasticity, &skin_matrix, in->stiffness));
    double shift = 0;
    ruga_factor_info info;
    for (int attempt = 0; attempt < 12; attempt++) {
        for (int j = 0; j < in->n; j++) {
            double* column = in->kkt.value + k->start[j] + in->column_shift[j];
            memcpy(column, in->stiffness + k->start[j], (size_t)(k->start[j + 1] - k->start[j]) * sizeof *column);
            column[0] *= 1 + shift;
        }
        RUGA_TRY(ruga_factor_numeric(in->factor, in->kkt.value, &info));
        if (in->m ? info.negative == in->m && info.zero == 0 : info.success) {
            in->factor_valid = true;
            return RUGA_OK;
        }
        shift = shift > 0 ? 10 * shift : 1e-8;
    }
    return ruga_fail(RUGA_LIBRARY, "the interior's matrix could not be factorised");
}

static ruga_status assemble(ruga_interior* in, const double* q) {
    double energy;
    RUGA_TRY(ruga_elasticity_energy(in->elasticity, q, false, &energy, NULL, in->stiffness, NULL));
    add_inertia(in, in->stiffness);
    return RUGA_OK;
}

// The skin's answer to dq: dx into move and dt into image, both [3 V].
static ruga_status skin_response(ruga_interior* in, const double* dq, double* move, double* image) {
    ruga_skin* skin = in->skin;
    double *u = surface_vector(in, BU), *right = skin->right;
    ruga_lattice_embed(&in->model->lattice, dq, u);
    for (int i = 0; i < skin->n; i++) {
        move[i] = skin_only(in, i) ? 0 : u[i];
    }
    if (in->model->solves_skin) {
        multiply_foundation(in, u, right);
        ruga_skin_apply(skin, move, image);
        for (int i = 0; i < skin->n; i++) {
            right[i] = in->model->skin_handle[i] >= 0 ? 0 : right[i] - image[i];
            u[i] -= move[i];
        }
        ruga_clusters_apply(&in->model->clusters, u, right + skin->n);
        ruga_skin_clear_void_rows(skin, right + skin->n);
        RUGA_TRY(ruga_skin_solve_system(skin, right, skin->left));
        for (int i = 0; i < skin->n; i++) {
            move[i] += skin->left[i];
        }
    }
    // dt = (K - W) dx; where the skin alone is held, -(W (dx - B dq) + H^T dl).
    multiply_foundation(in, move, right);
    ruga_skin_apply(skin, move, image);
    for (int i = 0; i < skin->n; i++) {
        image[i] -= right[i];
    }
    if (!in->model->any_skin_held || !in->model->solves_skin) {
        return RUGA_OK;
    }
    ruga_lattice_embed(&in->model->lattice, dq, u);
    for (int i = 0; i < skin->n; i++) {
        u[i] = move[i] - u[i];
    }
    multiply_foundation(in, u, right);
    ruga_clusters_apply_transpose(&in->model->clusters, skin->left + skin->n, right);
    for (int i = 0; i < skin->n; i++) {
        image[i] = skin_only(in, i) ? -right[i] : image[i];
    }
    return RUGA_OK;
}

static ruga_status apply_reduced(ruga_interior* in, const double* dq, double* y) {
    double *move = surface_vector(in, MOVE), *image = surface_vector(in, IMAGE);
    RUGA_TRY(skin_response(in, dq, move, image));
    multiply_pattern(in, in->stiffness, dq, y);
    ruga_lattice_embed_transpose(&in->model->lattice, image, y);
    return RUGA_OK;
}

// Newton's direction by conjugate gradients, truncated at a direction of negative curvature (Steihaug 1983).
static ruga_status newton_direction(ruga_interior* in, const double* r, double forcing, double* dq, int* iterations) {
    double *cr = interior_vector(in, CG_R), *z = interior_vector(in, CG_Z), *p = interior_vector(in, CG_P);
    double* ap = interior_vector(in, CG_AP);
    int n = in->n;
    memset(dq, 0, (size_t)n * sizeof *dq);
    for (int i = 0; i < n; i++) {
        cr[i] = -r[i];
    }
    RUGA_TRY(precondition(in, cr, z));
    memcpy(p, z, (size_t)n * sizeof *p);
    double rz = ruga_dot_product(n, cr, z), first = rz;
    for (int k = 0; k < MAX_CG && rz > forcing * forcing * first; k++) {
        RUGA_TRY(apply_reduced(in, p, ap));
        ++*iterations;
        double curvature = ruga_dot_product(n, p, ap);
        if (!(curvature > 0)) {
            if (k == 0) {
                memcpy(dq, p, (size_t)n * sizeof *dq);
            }
            break;
        }
        double a = rz / curvature;
        for (int i = 0; i < n; i++) {
            dq[i] += a * p[i];
            cr[i] -= a * ap[i];
        }
        RUGA_TRY(precondition(in, cr, z));
        double next = ruga_dot_product(n, cr, z), b = next / rz;
        rz = next;
        for (int i = 0; i < n; i++) {
            p[i] = z[i] + b * p[i];
        }
    }
    return RUGA_OK;
}

// ---- the step ------------------------------------------------------------------------------------------

ruga_status ruga_interior_predict(ruga_interior* in, const double* q, const double* x, double* next_q) {
    double *r = interior_vector(in, RESIDUAL), *side = interior_vector(in, SIDE), *dq = interior_vector(in, SOLUTION);
    double total, force_square;
    ruga_interior_result scratch;
    double *gradient = surface_vector(in, GRADIENT), *t = surface_vector(in, PRESS);
    RUGA_TRY(factor_preconditioner(in, q, x));
    RUGA_TRY(ruga_skin_energy(in->skin, x, &scratch.skin.terms, gradient));
    RUGA_TRY(surface_force(in, x, in->skin->embedded, gradient, t));
    RUGA_TRY(energy_of_q(in, q, &scratch, &total, r, &force_square));
    ruga_lattice_embed_transpose(&in->model->lattice, t, r);
    const ruga_rows* rows = &in->model->rows;
    for (int i = 0; i < in->n; i++) {
        side[i] = -r[i];
    }
    for (int k = 0; k < in->m; k++) {
        side[in->n + k] = in->target[k];
        for (int p = rows->start[k]; p < rows->start[k + 1]; p++) {
            side[in->n + k] -= rows->weight[p] * q[3 * rows->node[p] + rows->axis[k]];
        }
    }
    RUGA_TRY(ruga_factor_solve(in->factor, side, dq));
    for (int i = 0; i < in->n; i++) {
        next_q[i] = q[i] + dq[i];
    }
    return RUGA_OK;
}

static ruga_status total_energy(ruga_interior* in, const double* q, const double* x, double* embedded,
                                double* total) {
    ruga_interior_result scratch;
    ruga_skin_terms terms;
    ruga_lattice_embed(&in->model->lattice, q, embedded);
    RUGA_TRY(energy_of_q(in, q, &scratch, total, NULL, NULL));
    RUGA_TRY(ruga_skin_energy(in->skin, x, &terms, NULL));
    *total += terms.total;
    return RUGA_OK;
}

// Armijo on the total energy along (dq, dx); q, x and embedded move. *moved = false where nothing was gained.
static ruga_status search(ruga_interior* in, const double* dq, double slope, double start, double* q, double* x,
                          double* embedded, bool* moved) {
    double *trial_q = interior_vector(in, TRIAL_Q), *trial_x = surface_vector(in, TRIAL_X);
    double* dx = surface_vector(in, MOVE);
    RUGA_TRY(skin_response(in, dq, dx, surface_vector(in, IMAGE)));
    double largest = ruga_largest_move(in->skin->n, dx), cap = 2 * in->model->mean_edge;
    double b = largest > cap ? cap / largest : 1, total;
    *moved = false;
    for (int k = 0; k < MAX_BACKTRACKS && !*moved; k++, b *= 0.5) {
        for (int i = 0; i < in->n; i++) {
            trial_q[i] = q[i] + b * dq[i];
        }
        for (int i = 0; i < in->skin->n; i++) {
            trial_x[i] = x[i] + b * dx[i];
        }
        RUGA_TRY(total_energy(in, trial_q, trial_x, embedded, &total));
        *moved = total <= start + 1e-4 * b * slope || (k == 0 && fabs(total - start) < 1e-11 * fabs(start));
    }
    if (*moved) {
        memcpy(q, trial_q, (size_t)in->n * sizeof *q);
        memcpy(x, trial_x, (size_t)in->skin->n * sizeof *x);
    }
    ruga_lattice_embed(&in->model->lattice, q, embedded);
    return RUGA_OK;
}

// Held components of the skin follow the handle, or the interior that the same handle holds.
static void set_skin_targets(ruga_interior* in, const double* embedded) {
    for (int i = 0; i < in->skin->n && in->model->any_skin_held; i++) {
        if (in->model->skin_handle[i] >= 0 && !skin_only(in, i)) {
            in->skin->target[i] = embedded[i];
        }
    }
}

static ruga_status solve_skin(ruga_interior* in, double tolerance, double* x, const double* embedded,
                              ruga_interior_result* result) {
    set_skin_targets(in, embedded);
    if (in->model->solves_skin) {
        return ruga_skin_minimize(in->skin, x, tolerance, true, &result->skin);
    }
    memcpy(x, embedded, (size_t)in->skin->n * sizeof *x);
    result->skin.outcome = RUGA_OUTCOME_MINIMUM;
    result->skin.residual = 0;
    return RUGA_OK;
}

// Steps by the predictor's factor alone, which cost a residual each and need no matrix, while they serve.
static ruga_status take_chord_steps(ruga_interior* in, double tolerance, double* q, double* x, double* embedded,
                                    ruga_interior_result* result) {
    double *r = interior_vector(in, RESIDUAL), *before_q = interior_vector(in, TRIAL_Q), before = INFINITY, total;
    memcpy(before_q, q, (size_t)in->n * sizeof *q);
    for (;; result->iterations++) {
        RUGA_TRY(solve_skin(in, tolerance, x, embedded, result));
        RUGA_TRY(residual(in, q, x, embedded, result, &total, r));
        if (!(result->residual <= CHORD * before)) {
            memcpy(q, before_q, (size_t)in->n * sizeof *q);
            ruga_lattice_embed(&in->model->lattice, q, embedded);
            return RUGA_OK;
        }
        result->converged = result->residual <= tolerance;
        if (result->converged) {
            return RUGA_OK;
        }
        before = result->residual;
        memcpy(before_q, q, (size_t)in->n * sizeof *q);
        for (int i = 0; i < in->n; i++) {
            q[i] -= interior_vector(in, CG_Z)[i];
        }
        ruga_lattice_embed(&in->model->lattice, q, embedded);
    }
}

ruga_status ruga_interior_minimize(ruga_interior* in, double tolerance, double* q, double* x, double* embedded,
                                   ruga_interior_result* result) {
    double *r = interior_vector(in, RESIDUAL), *dq = interior_vector(in, DIRECTION), total;
    *result = (ruga_interior_result){0};
    // The predictor's factor, of where the step began, serves as well where a product costs next to nothing. With a
    // skin to solve for, each product is a solve with the skin's matrix, and a fresh factor saves some.
    int products = in->model->solves_skin ? MAX_CG : 0;
    if (!in->model->solves_skin) {
        RUGA_TRY(take_chord_steps(in, tolerance, q, x, embedded, result));
        if (result->converged) {
            return RUGA_OK;
        }
    }
    for (int k = 0; k < MAX_NEWTON; k++, result->iterations++) {
        if (products > STALE_CG || k % 6 == 5) {
            RUGA_TRY(factor_preconditioner(in, q, x));
            result->factorizations++;
        }
        RUGA_TRY(solve_skin(in, 0.5 * tolerance, x, embedded, result));
        RUGA_TRY(residual(in, q, x, embedded, result, &total, r));
        result->converged = result->residual <= tolerance;
        if (result->converged) {
            return RUGA_OK;
        }
        RUGA_TRY(ruga_progress("coupled step", (double)k / MAX_NEWTON));
        if (in->model->solves_skin && !in->skin->factor_exact) {
            RUGA_TRY(ruga_skin_factor_convex(in->skin, x));
        }
        if (!in->model->solves_skin) {
            RUGA_TRY(ruga_skin_assemble(in->skin, x, 0));
        }
        RUGA_TRY(assemble(in, q));
        double forcing = fmin(0.1, sqrt(result->residual));
        products = -result->linear_iterations;
        RUGA_TRY(newton_direction(in, r, fmax(forcing, 0.1 * tolerance / result->residual), dq,
                                  &result->linear_iterations));
        products += result->linear_iterations;
        bool moved;
        double slope = ruga_dot_product(in->n, r, dq);
        if (slope > 0) {
            return RUGA_OK;
        }
        RUGA_TRY(search(in, dq, slope, total, q, x, embedded, &moved));
        if (!moved) {
            return RUGA_OK;
        }
    }
    return RUGA_OK;
}

ruga_status ruga_interior_paper_step(ruga_interior* in, double tolerance, double* q, double* x, double* embedded,
                                     ruga_interior_result* result) {
    // F_x(x_k) and K_x(x_k) stay as they are while q moves: the skin's part of the gradient is linear in q.
    ruga_skin* skin = in->skin;
    double *r = interior_vector(in, RESIDUAL), *dq = interior_vector(in, DIRECTION), *z = interior_vector(in, CG_Z);
    double *t = surface_vector(in, PRESS), *gradient = surface_vector(in, GRADIENT), *u = surface_vector(in, BU);
    double* image = surface_vector(in, IMAGE);
    double total, force_square;
    *result = (ruga_interior_result){0};
    RUGA_TRY(ruga_skin_energy(skin, x, &result->skin.terms, gradient));
    RUGA_TRY(surface_force(in, x, embedded, gradient, t));
    RUGA_TRY(ruga_shell_energy(skin->shell, x, 0, NULL, NULL, skin->stiffness));
    if (skin->coupling) {
        ruga_shell_coupling(skin->shell, skin->coupling);
    }
    for (int it = 0; it < MAX_NEWTON; it++, result->iterations++) {
        RUGA_TRY(factor_preconditioner(in, q, x));
        result->factorizations++;
        RUGA_TRY(energy_of_q(in, q, result, &total, r, &force_square));
        for (int i = 0; i < in->n; i++) {
            z[i] = q[i] - in->previous[i];
        }
        ruga_lattice_embed(&in->model->lattice, z, u);
        ruga_skin_apply(skin, u, image);
        for (int i = 0; i < skin->n; i++) {
            image[i] += t[i];
        }
        ruga_lattice_embed_transpose(&in->model->lattice, image, r);
        RUGA_TRY(precondition(in, r, dq));
        double size = sqrt(fabs(ruga_dot_product(in->n, r, dq)));
        result->residual = size / fmax(sqrt(fabs(result->elastic)), 1e-12);
        for (int i = 0; i < in->n; i++) {
            q[i] -= dq[i];
        }
        if (result->residual <= tolerance) {
            result->converged = true;
            break;
        }
    }
    ruga_lattice_embed(&in->model->lattice, q, embedded);
    return solve_skin(in, tolerance, x, embedded, result);
}
