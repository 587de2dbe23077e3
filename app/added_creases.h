// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Creases that are added to a simulation that was stopped, or has come to its end: they stand at the end of
// its scene's list, and start at its last frame or later.
#ifndef RUGA_APP_ADDED_CREASES_H
#define RUGA_APP_ADDED_CREASES_H

#include "io/result.h"
#include "io/scene.h"
#include "solver/model.h"

// *found: whether `scene`, read from `path`, is the one that a result was made from with creases added. That
// one is `before`, which is to be cleared in any case.
ruga_status ruga_added_creases_find(const ruga_result_header* header, const char* path,
                                    const ruga_scene* scene, ruga_scene* before, bool* found);
// The result at `path`, of `before`, becomes one of `scene`, whose model and header are given: its frames, on
// the mesh that is cut along the added creases as well. RUGA_BAD_INPUT where they come too early, or need
// another mesh.
ruga_status ruga_added_creases_write(const char* path, const ruga_scene* before, const ruga_scene* scene,
                                     const ruga_model* model, const ruga_result_header* header);

#endif
