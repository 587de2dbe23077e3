// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The interior with the skin on it: over a step of length dt,
//     minimise  E_q(q) + |q - q~|^2_M / (2 dt^2) + damping - weight + min_x E(x; B q)     subject to A q = a(t),
// which is implicit Euler (Remillard and Kry 2013, eqs. 11-12) where dynamic, and equilibrium without the second
// term. Eq. 14 lets the skin follow the interior (dx = B dq), which is far too stiff once it is wrinkled: here the
// skin's response is eliminated exactly, by one solve with its factorised KKT matrix for each product.
#ifndef RUGA_SOLVER_INTERIOR_H
#define RUGA_SOLVER_INTERIOR_H

#include "lattice/elasticity.h"
#include "solver/skin.h"

typedef struct ruga_interior {
    const ruga_model* model;
    ruga_skin* skin;
    ruga_elasticity* elasticity;
    int n; // 3 nodes
    int m; // rows of A
    double* mass;          // values of the pattern: interior and skin
    double* weight;        // [n] gravity on the interior, N
    ruga_sparse kkt;       // lower triangle of [K A^T; A 0], or of K
    int* column_shift;     // [n]
    double* stiffness;     // values of the pattern: exact, inertia included
    double* skin_stiffness; // values of the shell's pattern, clamped
    ruga_factor* factor;   // of the convex matrix, skin included: the preconditioner
    bool factor_valid;
    double* target;        // [m] a(t)
    double* start;         // [n] q~
    double* previous;      // [n] q at the start of the step
    double mass_factor;    // 1/dt^2 where dynamic, 0 otherwise, 1/s^2
    double damping_factor; // damping/dt, 1/s^2
    double* memory;        // [RUGA_INTERIOR_VECTORS][n + m]
    double* surface;       // [RUGA_SURFACE_VECTORS][3 V]
} ruga_interior;

enum { RUGA_INTERIOR_VECTORS = 10, RUGA_SURFACE_VECTORS = 6 };

ruga_status ruga_interior_create(const ruga_model* model, ruga_skin* skin, ruga_interior** interior);
void ruga_interior_destroy(ruga_interior** interior);

// Where the handles hold the interior at a time.
void ruga_interior_set_targets(ruga_interior* interior, double time);

typedef struct ruga_interior_result {
    bool converged;
    double residual; // |projected gradient| / reference force
    int iterations, linear_iterations, factorizations;
    ruga_skin_result skin;
    double elastic, kinetic, weight; // J; kinetic is the incremental potential's
} ruga_interior_result;

// q and x of one linearised step without new wrinkles (the skin follows the interior) that meets A q = a(t).
// A start for the step, and a forecast of its strain.
ruga_status ruga_interior_predict(ruga_interior* interior, const double* q, const double* x, double* next_q);

// Solves the coupled step from q (with A q = a) and x; embedded [3 V] = B q follows. skin->embedded must be it.
ruga_status ruga_interior_minimize(ruga_interior* interior, double tolerance, double* q, double* x,
                                   double* embedded, ruga_interior_result* result);

// The published step, eqs. 14-15: Newton on the interior with the skin's force and stiffness of the last frame
// carried along by B, then one static solve.
ruga_status ruga_interior_paper_step(ruga_interior* interior, double tolerance, double* q, double* x,
                                     double* embedded, ruga_interior_result* result);

#endif
