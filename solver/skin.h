// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The static problem of the skin on a given interior (Remillard and Kry 2013, section 6.1):
//     minimise  E(x) = shell + foundation + loads + weight (+ proximal term)   over x
//     subject to  H x = H B q   and   held components fixed.
// skin.c evaluates, factorises its KKT matrix [K H^T; H 0] and projects; ruga_skin_minimize calls a method.
// The rotations of directors (shell/directors.h) are only in the matrix, [K H^T C^T; H 0 0; C 0 M].
#ifndef RUGA_SOLVER_SKIN_H
#define RUGA_SOLVER_SKIN_H

#include "core/sparse.h"
#include "shell/shell.h"
#include "solver/hinges.h"
#include "solver/linear.h"
#include "solver/model.h"
#include "solver/vectors.h"
#include "solver/work.h"

typedef struct ruga_skin_terms {
    double total, membrane, bending, hinge, foundation, external; // J; bending with that of auxiliary chords
    double force_reference;                               // f_ref, N
} ruga_skin_terms;

typedef struct ruga_skin {
    const ruga_model* model;
    ruga_shell* shell;
    ruga_hinges* hinges; // of creases, NULL = none
    int n, m, size; // 3 V, 3 clusters, n + m + directors

    ruga_sparse kkt;        // lower triangle of the matrix, of `size`
    int* column_shift;      // [n] from a column of the shell's pattern to the same one of kkt
    int* foundation_slot;
    double* stiffness;      // K as last assembled, without shift, in the shell's pattern
    double (*coupling)[3];  // C of the same state, NULL without directors
    ruga_factor* factor;
    ruga_factor_info info;
    bool* row_void;         // [m] rows of H that are left out: what they average is held
    bool near_dependent;    // the other rows are dependent on one another, or nearly
    bool factor_right;      // the factor's inertia is that of a minimum
    bool factor_exact;      // made from the exact Hessian without a shift at the state last given, its inertia proven
    bool in_single;         // the factor was made in single precision
    bool single_serves;     // no clamped factor of this solve was beyond single precision
    bool single_proves;     // nor was the inertia of any other
    ruga_factor* gram[3];   // H H^T over the free components; [1] and [2] NULL where they equal [0]
    double shift_memory;    // last diagonal shift that gave the right inertia, N/m^3

    const double* embedded; // [n] B q, of the caller
    double* target;         // [n] positions of held components
    double time;
    double proximal;        // N/m^3, 0 = none
    const double* anchor;   // [n] of the proximal term

    double* displacement;   // [n] work: x - B q
    double *right, *left;   // [size] work: one system's sides; the directors' part of right stays 0
    double* multiplier;     // [m] of the last projection
    double* trial;          // [n] work of line searches
    double* trial_gradient; // [n]
    double* memory;         // L-BFGS pairs and more, [work_vectors][size]
    double* mass;           // [V] kg
    ruga_skin_work work;

    ruga_skin_trace* trace; // of each residual, for benchmarks: NULL or [trace_size]
    int trace_size, trace_count;
} ruga_skin;

ruga_status ruga_skin_create(const ruga_model* model, ruga_skin** skin);
void ruga_skin_destroy(ruga_skin** skin);
ruga_status ruga_skin_create_factor(const ruga_skin* skin, ruga_factor** factor); // another one, analysed

// Energy at x; the full gradient [n] where not NULL (held components are not zeroed).
ruga_status ruga_skin_energy(ruga_skin* skin, const double* x, ruga_skin_terms* terms, double* gradient);
void ruga_skin_follow(ruga_skin* skin, const double* x); // tells the hinges of creases that x is the state now
// force [handles][3] N, on the skin: the reactions that gradient and constraints leave at what each handle holds.
ruga_status ruga_skin_handle_forces(ruga_skin* skin, const double* x, double* force);

// Assembles K at x (clamp as in shell.h) into stiffness and kkt; the factor stays as it is.
ruga_status ruga_skin_assemble(ruga_skin* skin, const double* x, double clamp);
// Assembles, adds shift times vertex area to the diagonal, and factorises, in single precision where that proves inertia.
ruga_status ruga_skin_factor(ruga_skin* skin, const double* x, double clamp, double shift);
ruga_status ruga_skin_refactor(ruga_skin* skin, double shift); // the same K with another shift
// Tries clamp 0.5, then 1, in single precision while that serves, then in double, then shifts: the inertia is right.
ruga_status ruga_skin_factor_convex(ruga_skin* skin, const double* x);
double ruga_skin_shift_unit(const ruga_model* model); // N/m^3, small against a wrinkle's: the unit of shifts
// Raises the shift of the K last assembled (exact, of wrong inertia) until it is.
ruga_status ruga_skin_shift_until_right(ruga_skin* skin);

// d = the first n of [K H^T; H 0]^-1 [r; 0], with held components of r taken as 0: H d = 0.
ruga_status ruga_skin_solve(ruga_skin* skin, const double* r, double* d);
// Near that, as the factor in single precision stands, for projected r: symmetric, and H d = 0 to round-off.
ruga_status ruga_skin_solve_rough(ruga_skin* skin, const double* r, double* d);
// The full system: sides [size], right with 0 for the directors.
ruga_status ruga_skin_solve_system(ruga_skin* skin, const double* right, double* left);

// out = gradient without its held components and without its part in the range of H^T; sets multiplier (so
// that gradient + H^T multiplier is smallest). out may be gradient.
ruga_status ruga_skin_project(ruga_skin* skin, const double* gradient, double* out);
void ruga_skin_clear_void_rows(const ruga_skin* skin, double* y); // zeroes the entries of left-out rows in y [m]
// Moves x the least so that H x = H B q and held components are at their target.
ruga_status ruga_skin_restore(ruga_skin* skin, double* x);
double ruga_skin_constraint_residual(ruga_skin* skin, const double* x); // |H x - H B q| / |H B q|

// y = (K - C^T M^-1 C) v as last assembled. multiply: held components zeroed; v is zero there.
void ruga_skin_apply(const ruga_skin* skin, const double* v, double* y);
void ruga_skin_multiply(const ruga_skin* skin, const double* v, double* y);

typedef struct ruga_skin_result {
    ruga_outcome outcome;
    double residual; // |projected gradient| / f_ref
    ruga_skin_terms terms;
} ruga_skin_result;

// From x (restored first) to an equilibrium, by the model's method. `certify`: the outcome is checked by the
// inertia at zero shift; without it a small residual is reported as minimum.
ruga_status ruga_skin_minimize(ruga_skin* skin, double* x, double tolerance, bool certify,
                               ruga_skin_result* result);
ruga_status ruga_newton_minimize(ruga_skin* skin, double* x, double tolerance, bool certify,
                                 bool while_convex, ruga_skin_result* result); // until the Hessian is not
ruga_status ruga_quasi_newton_minimize(ruga_skin* skin, double* x, double tolerance, bool certify,
                                       ruga_skin_result* result);
ruga_status ruga_paper_minimize(ruga_skin* skin, double* x, double tolerance, ruga_skin_result* result);
// What they share. Residual of a projected gradient; a finite direction, of largest `move` if not NULL, capped to half an edge; the
// certificate of a converged state: *done with the outcome in result, or a step off the saddle.
double ruga_skin_residual(ruga_skin* skin, const double* projected, const ruga_skin_terms* terms);
ruga_status ruga_skin_clean_direction(const ruga_skin* skin, double* d, double* move);
// A saddle so shallow that no step leaves it is approached more closely first: *target, the residual that counts as
// converged, is lowered.
ruga_status ruga_skin_certify(ruga_skin* skin, double* x, bool certify, double tolerance, double* target,
                              double* gradient, ruga_skin_result* result, bool* done);

// Line search along d from x (energy and gradient there given): Armijo's rule on the energy with quadratic interpolation;
// a full step of negative curvature is doubled while the energy falls. On success x, terms and gradient are those of the
// new point and *step > 0; *step = 0 where no decrease was found.
ruga_status ruga_armijo_search(ruga_skin* skin, const double* d, double* x, ruga_skin_terms* terms,
                               double* gradient, double* step);

// A step along a direction of negative curvature of K at x, where the exact factor has the wrong inertia: `along`, or if NULL
// one that shifted factors show; *moved = false where none was found. x, terms and gradient follow.
ruga_status ruga_negative_curvature_step(ruga_skin* skin, const double* along, double* x, ruga_skin_terms* terms,
                                         double* gradient, bool* moved);
// *along: one that this factor itself shows, of curvature below -least in N/m^3; NULL where none is clear.
ruga_status ruga_negative_curvature_of_factor(ruga_skin* skin, double least, const double** along);
double ruga_largest_move(int n, const double* d); // of a vertex, in a vector [n]
enum { RUGA_SKIN_WORK_VECTORS = 24 };
// Work vector i of length `size`.
static inline double* ruga_skin_vector(ruga_skin* skin, int i) {
    return skin->memory + (size_t)i * (size_t)skin->size;
}

#endif
