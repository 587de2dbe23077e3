// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Ruga: wrinkles of thin skins on soft interiors. Build a ruga_model from a def, make a ruga_state of it,
// step the state and read positions. The model never changes once built; one state per thread.
#ifndef RUGA_RUGA_H
#define RUGA_RUGA_H

#include "ruga/base.h"
#include "ruga/types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ruga_model ruga_model;
typedef struct ruga_state ruga_state;

// Builds everything that does not change: lattice, embedding, shell rest state, constraints. `def` must come
// from ruga_default_model_def. RUGA_BAD_INPUT names the field, RUGA_BAD_MESH the defect and its place.
RUGA_API ruga_status ruga_model_create(const ruga_model_def* def, ruga_model** model);
RUGA_API void ruga_model_destroy(ruga_model** model);

// The state at time 0: rest shape, or the first pose where the interior is prescribed. The model must outlive it.
RUGA_API ruga_status ruga_state_create(const ruga_model* model, ruga_state** state);
RUGA_API void ruga_state_destroy(ruga_state** state);

// Advances by one time step. `report` may be NULL.
RUGA_API ruga_status ruga_state_step(const ruga_model* model, ruga_state* state, ruga_report* report);

// Number of frames done (0 at the start) and the time in seconds.
RUGA_API int ruga_state_frame(const ruga_state* state);
RUGA_API double ruga_state_time(const ruga_state* state);

// Vertex count and positions [count][3] in metres of the skin, and of the embedded surface Bq without
// wrinkles. The pointers stay valid, and their content current, while the state lives.
RUGA_API int ruga_model_vertex_count(const ruga_model* model);
RUGA_API const double* ruga_state_positions(const ruga_state* state);
RUGA_API const double* ruga_state_embedded(const ruga_state* state);

// Wavelength in metres of paper eq. 3, and critical strain, of the model's skin on its interior; 0 without
// one. Where the skin varies: the mean of the local wavelengths over the area, and the smallest critical
// strain.
RUGA_API double ruga_model_wavelength(const ruga_model* model);
RUGA_API double ruga_model_critical_strain(const ruga_model* model);

// Threads used by this process, 0 = all cores. Results do not depend on it.
RUGA_API void ruga_set_threads(int count);

// Progress of create and step calls in this process; NULL to stop.
RUGA_API void ruga_set_progress(ruga_progress_function* progress, void* context);

#ifdef __cplusplus
}
#endif
#endif
