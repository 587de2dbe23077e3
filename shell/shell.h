// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The thin shell: membrane (Baraff-Witkin, area-normalised, with Poisson coupling; or St Venant-Kirchhoff)
// and bending, by discrete hinges (Grinspun et al. 2003) or by a Kirchhoff-Love second fundamental form with
// directors at the middles of edges (directors.c), with exact derivatives.
#ifndef RUGA_SHELL_SHELL_H
#define RUGA_SHELL_SHELL_H

#include "core/sparse.h"
#include "mesh/connectivity.h"
#include "mesh/mesh.h"
#include "shell/directors.h"
#include "shell/material.h"

typedef struct ruga_shell ruga_shell;

// RUGA_BAD_INPUT or RUGA_BAD_MESH names the field, or the face and where it is. Nothing of the arguments is
// kept. connectivity is not looked at where material->cut is given, and bending is by hinges then.
ruga_status ruga_shell_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                              const ruga_shell_material* material, ruga_shell** shell);
void ruga_shell_destroy(ruga_shell** shell);

// Pattern of the Hessian: lower triangle, 3 x 3 blocks over the vertices, for triangles and hinges. With
// directors it is that of the Hessian while they keep their places, see ruga_shell_directors.
const ruga_sparse* ruga_shell_pattern(const ruga_shell* shell);

typedef struct ruga_shell_energies {
    double membrane, bending; // J
    double force_square;      // sum over triangles and hinges of squared nodal forces, N^2
} ruga_shell_energies;

// Energy at x [V][3]; gradient [V][3] (= minus force) and hessian (values of the pattern) are SET where not
// NULL; energies may be NULL. clamp in [0, 1]: 0 = the exact Hessian; otherwise the geometric stiffness of
// compressive principal membrane stress is multiplied by (1 - clamp), and a hinge's Hessian is
// clamp * Gauss-Newton + (1 - clamp) * exact, and so is the bending's with directors. With clamp = 1 the
// Hessian is positive semi-definite. Finite also where triangles have collapsed. The same bits for any number
// of threads. Allocates nothing: it works in scratch of the shell, so that one shell serves one thread at a
// time.
ruga_status ruga_shell_energy(const ruga_shell* shell, const double* x, double clamp,
                              ruga_shell_energies* energies, double* gradient, double* hessian);

// NULL with hinges. Otherwise the energy is the least over a rotation of each interior edge, and its Hessian
// is K - C^T M^-1 C: K the hessian of ruga_shell_energy, M the directors' matrix, and C the blocks of
// ruga_directors_coupling, which ruga_shell_coupling sets at the x of the last ruga_shell_energy.
const ruga_directors* ruga_shell_directors(const ruga_shell* shell);
void ruga_shell_coupling(const ruga_shell* shell, double (*coupling)[3]);
// y -= C^T M^-1 C v, vectors [V][3]: with K v in y, the Hessian times v.
void ruga_shell_relax(const ruga_shell* shell, const double (*coupling)[3], const double* v, double* y);

// Lumped mass of each vertex, kg, [V]: a third of its triangles', after growth.
void ruga_shell_vertex_mass(const ruga_shell* shell, double* mass);

// Paper eq. 3 in m, and (1/4) (3 E*_q / E*_x)^(2/3), E* = E / (1 - nu^2).
double ruga_wrinkle_wavelength(const ruga_skin_def* skin, const ruga_interior_def* interior);
double ruga_wrinkle_critical_strain(const ruga_skin_def* skin, const ruga_interior_def* interior);
// h sqrt(strain / critical - 1) in m, 0 below critical.
double ruga_wrinkle_amplitude(const ruga_skin_def* skin, const ruga_interior_def* interior, double strain);

#endif
