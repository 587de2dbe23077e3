// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A shell at rest that nothing holds may drift and turn: its Hessian has up to six null vectors per connected
// part, which no certificate of a minimum survives. Where no load acts along them, just as many components of
// one triangle near the part's middle are held, which takes no force: those of its corners that are
// independent of what the handles hold already, as rows of
//
//   u(x) = a + b x (x - c) / s,   a, b the rigid motion, c and s the part's middle and size,
//
// in six dimensions, as it begins. A part that is loaded and held in part (a cloth hung by a point) is left
// as it is: there the load itself decides how it turns. One that is loaded and held nowhere has an
// equilibrium only where its loads balance.
#include "solver/anchor.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "lattice/union_find.h"
#include "solver/start.h"

#include <math.h>
#include <string.h>

static const double independent = 1e-6; // of a row's length that other rows do not span

typedef struct part {
    double min[3], max[3];
    double center[3], size;
    int rank;
    double basis[6][6]; // [rank] orthonormal
    int triangle;       // the one to hold
    double far;         // from the middle
    double push[6];     // what the loads do to the rigid motions
    double load;        // sum of the sizes of their forces
} part;

typedef struct anchor {
    ruga_model* model;
    int count; // of parts
    part* part;
    int* of;          // [V] the part of a node
    const double* x;  // [V][3] how the skin begins
    double* gradient; // [V][3] of the loads' energy
} anchor;

// Numbers the parts: what triangles and the sewing join.
static ruga_status find_parts(anchor* a) {
    const ruga_mesh* mesh = &a->model->mesh;
    int* root = a->of; // becomes the number of the part in place: the first node of a part is its root
    ruga_sets_reset(root, mesh->vertex_count);
    for (int k = 0; k < 3 * mesh->triangle_count; k++) {
        ruga_sets_unite(root, mesh->triangle[k], mesh->triangle[k - k % 3]);
    }
    const ruga_sewing* sewing = a->model->creases ? &a->model->creases->sewing : NULL;
    for (int r = 0; sewing && r < sewing->row_count; r++) {
        for (int k = sewing->start[r] + 1; k < sewing->start[r + 1]; k++) {
            ruga_sets_unite(root, sewing->node[k], sewing->node[sewing->start[r]]);
        }
    }
    for (int v = mesh->vertex_count - 1; v >= 0; v--) {
        root[v] = ruga_sets_find(root, v);
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        a->of[v] = root[v] == v ? a->count++ : a->of[root[v]];
    }
    return RUGA_NEW_ZERO(a->part, a->count);
}

static void find_sizes(anchor* a) {
    for (int k = 0; k < a->count; k++) {
        part* p = &a->part[k];
        *p = (part){
            .min = {INFINITY, INFINITY, INFINITY}, .max = {-INFINITY, -INFINITY, -INFINITY}, .far = INFINITY};
    }
    for (int i = 0; i < 3 * a->model->mesh.vertex_count; i++) {
        part* p = &a->part[a->of[i / 3]];
        p->min[i % 3] = fmin(p->min[i % 3], a->model->mesh.position[i]);
        p->max[i % 3] = fmax(p->max[i % 3], a->model->mesh.position[i]);
    }
    for (int k = 0; k < a->count; k++) {
        part* p = &a->part[k];
        for (int i = 0; i < 3; i++) {
            p->center[i] = 0.5 * (p->min[i] + p->max[i]);
        }
        p->size = ruga_distance(p->min, p->max);
    }
}

// The uncut triangle nearest to the middle; any where all are cut.
static void find_middles(anchor* a) {
    const ruga_model* model = a->model;
    for (int f = 0; f < model->mesh.triangle_count; f++) {
        const int* t = model->mesh.triangle + 3 * (size_t)f;
        part* p = &a->part[a->of[t[0]]];
        double off[3] = {-p->center[0], -p->center[1], -p->center[2]};
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(1.0 / 3, model->mesh.position + 3 * (size_t)t[i], off);
        }
        bool cut = model->creases && model->creases->cut.piece[f].fraction < 1;
        double far = ruga_norm(off) + (cut ? model->extent : 0);
        if (far < p->far) {
            p->far = far;
            p->triangle = f;
        }
    }
}

static void rigid_row(const anchor* a, int node, int axis, double row[6]) {
    const part* p = &a->part[a->of[node]];
    double r[3], turned[3];
    ruga_subtract(a->x + 3 * (size_t)node, p->center, r);
    for (int b = 0; b < 3; b++) {
        double about[3] = {b == 0, b == 1, b == 2};
        ruga_cross(about, r, turned);
        row[b] = axis == b;
        row[3 + b] = turned[axis] / fmax(p->size, 1e-300);
    }
}

// What is left of a row without the part's basis; returns its length.
static double residue(const part* p, double row[6]) {
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < p->rank; k++) {
            double along = 0;
            for (int i = 0; i < 6; i++) {
                along += p->basis[k][i] * row[i];
            }
            for (int i = 0; i < 6; i++) {
                row[i] -= along * p->basis[k][i];
            }
        }
    }
    double square = 0;
    for (int i = 0; i < 6; i++) {
        square += row[i] * row[i];
    }
    return sqrt(square);
}

static void extend(part* p, const double row[6], double length) {
    for (int i = 0; i < 6; i++) {
        p->basis[p->rank][i] = row[i] / length;
    }
    p->rank++;
}

static void take_holds(anchor* a) {
    for (int i = 0; i < 3 * a->model->mesh.vertex_count; i++) {
        part* p = &a->part[a->of[i / 3]];
        double row[6], length;
        if (a->model->skin_handle[i] >= 0 && p->rank < 6) {
            rigid_row(a, i / 3, i % 3, row);
            length = residue(p, row);
            if (length > independent) {
                extend(p, row, length);
            }
        }
    }
}

static ruga_status take_loads(anchor* a) {
    const ruga_model* model = a->model;
    double energy;
    RUGA_TRY(ruga_loads_energy(model->loads, a->x, INFINITY, &energy, a->gradient, NULL, NULL, NULL));
    for (int v = 0; v < model->mesh.vertex_count; v++) {
        part* p = &a->part[a->of[v]];
        for (int axis = 0; axis < 3; axis++) {
            double row[6], force = model->skin.density * model->skin.thickness * model->vertex_area[v] *
                                       model->gravity[axis] -
                                   a->gradient[3 * (size_t)v + (size_t)axis];
            rigid_row(a, v, axis, row);
            for (int i = 0; i < 6; i++) {
                p->push[i] += force * row[i];
            }
            p->load += fabs(force);
        }
    }
    return RUGA_OK;
}

static bool balanced(const part* p) {
    double square = 0;
    for (int i = 0; i < 6; i++) {
        square += p->push[i] * p->push[i];
    }
    return sqrt(square) <= 1e-9 * p->load;
}

// Of each corner of the triangle in turn the components that are most independent of what is held.
static void hold(anchor* a, part* p) {
    ruga_model* model = a->model;
    for (int k = 0; k < 9 && p->rank < 6; k++) {
        int node = model->mesh.triangle[3 * (size_t)p->triangle + (size_t)(k / 3)], best = 0;
        double most = 0, chosen[6] = {0};
        for (int axis = 0; axis < 3; axis++) {
            double row[6], length;
            rigid_row(a, node, axis, row);
            length = residue(p, row);
            if (length > most) {
                most = length;
                best = axis;
                memcpy(chosen, row, sizeof chosen);
            }
        }
        if (most > independent) {
            extend(p, chosen, most);
            model->skin_handle[3 * (size_t)node + (size_t)best] = model->handle_count;
            model->any_skin_held = true;
        }
    }
}

static ruga_status anchor_parts(anchor* a) {
    bool damped = a->model->skin.motion == RUGA_SKIN_DAMPED;
    RUGA_TRY(find_parts(a));
    find_sizes(a);
    find_middles(a);
    take_holds(a);
    RUGA_TRY(take_loads(a));
    for (int k = 0; k < a->count; k++) {
        part* p = &a->part[k];
        bool loaded = p->load > 0;
        if (p->rank == 6 || !isfinite(p->far)) {
            continue;
        }
        if (!loaded || (p->rank == 0 && balanced(p))) {
            hold(a, p);
        } else if (p->rank == 0 && !damped) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "%s: nothing holds the skin near (%.4g, %.4g, %.4g), and what acts on it does "
                             "not balance: it "
                             "has no equilibrium; fix a region, or let it move with skin.motion: dynamic",
                             ruga_norm(a->model->gravity) > 0 ? "gravity" : "handles", p->center[0],
                             p->center[1], p->center[2]);
        }
    }
    return RUGA_OK;
}

ruga_status ruga_model_anchor(ruga_model* model) {
    ruga_status status = RUGA_OK;
    anchor a = {.model = model, .x = ruga_start_shape(model)};
    RUGA_TRY_DONE(RUGA_NEW(a.of, model->mesh.vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(a.gradient, 3 * (size_t)model->mesh.vertex_count));
    status = anchor_parts(&a);
done:
    ruga_release(a.of);
    ruga_release(a.part);
    ruga_release(a.gradient);
    return status;
}
