// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Stress in the skin's middle surface.
#ifndef RUGA_APP_STRESS_H
#define RUGA_APP_STRESS_H

#include "mesh/mesh.h"

// The skin, uniform or [V].
typedef struct ruga_stress_skin {
    double young, poisson, growth[2];
    const double *vertex_young, *vertex_growth; // [V] and [V][2], or NULL
} ruga_stress_skin;

// Von Mises' equivalent stress at the vertices, stress [V], Pa: of the triangles around each, by their rest
// areas. The mesh is the rest shape, position [V][3]; work [V].
void ruga_stress_compute(const ruga_mesh* mesh, const ruga_stress_skin* skin, const double* position,
                         double* work, double* stress);

#endif
