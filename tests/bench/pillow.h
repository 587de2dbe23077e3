// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What the benchmarks share: the 50 cm pillow of the 2013 paper's table 1, and medians.
#ifndef RUGA_TESTS_BENCH_PILLOW_H
#define RUGA_TESTS_BENCH_PILLOW_H

#include "mesh/mesh.h"
#include "ruga/ruga.h"

// A pillow of about so many unknowns, three a vertex; mesh is cleared first.
ruga_status bench_pillow_mesh(int unknowns, ruga_mesh* mesh);
// Its skin, interior and lattice: h = 0.7 mm, E ratio 1e4, E_q = 50 kPa, prescribed, 5 cells.
void bench_pillow_def(const ruga_mesh* mesh, ruga_model_def* def);
// From flat to 1 % compression in `warm` steps, then 0.2 % more and a 1 mm deeper bump in each of `frames`; the
// def points to keys.
void bench_pillow_motion(ruga_model_def* def, int warm, int frames, ruga_keyframe_def keys[3]);
// Sorts the values.
double bench_median(int count, double* values);

#endif
