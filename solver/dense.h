// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// `skin: {model: volume}`: the skin of a scene as elements of the dense volume, on a box of interior.
//
// The film lies h/2 above and below the sheet, the bed under it. The four sides keep the prescribed stretch
// along their normal and are free along themselves; the bottom keeps all of it; the top is free.
#ifndef RUGA_SOLVER_DENSE_H
#define RUGA_SOLVER_DENSE_H

#include "mesh/mesh.h"
#include "solver/volume.h"

typedef struct ruga_dense_def {
    const ruga_skin_def* skin;
    const ruga_interior_def* interior;
    int cells;    // along the longest side of the sheet
    int degree;   // 1 or 2
    double depth; // m
} ruga_dense_def;

typedef struct ruga_dense {
    ruga_volume volume; // no nodes where there is none
    bool* held;         // [N][3]
    double origin[3];   // m, of the volume's coordinates in the mesh's frame
    double middle;      // m, height of the film's middle surface there: h/2
} ruga_dense;

// Whether a def whose skin is a volume is one that can be: RUGA_BAD_INPUT with the reason.
ruga_status ruga_dense_check(const ruga_model_def* def);

// RUGA_BAD_MESH where the mesh is no flat rectangle in a plane of z with normals along +z.
ruga_status ruga_dense_create(const ruga_mesh* mesh, const ruga_dense_def* def, ruga_dense* dense);
void ruga_dense_clear(ruga_dense* dense);

// The equilibrium at the prescribed map X -> stretch X + shift (m) of the mesh's frame, from `deviation`
// [N][3] of the displacement from that map; sets it and displacement [N][3].
ruga_status ruga_dense_solve(const ruga_dense* dense, ruga_volume_solver* solver, const double stretch[3],
                             const double shift[3], double tolerance, double* deviation, double* displacement,
                             ruga_volume_report* report);

// Where the film's middle surface has gone: x [V][3] of the mesh's vertices.
void ruga_dense_surface(const ruga_dense* dense, const ruga_mesh* mesh, const double* displacement,
                        double* x);

// The longer side of the sheet's bounding rectangle, m.
double ruga_dense_side(const ruga_mesh* mesh);

#endif
