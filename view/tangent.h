// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Tangent frames of a mesh with texture coordinates, by the definition that renderers and game engines share.
#ifndef RUGA_VIEW_TANGENT_H
#define RUGA_VIEW_TANGENT_H

#include "mesh/mesh.h"

// normal [V][3] of unit length at `position` [V][3]; tangent [F][3 corners][3] of unit length and across the
// corner's normal, sign [F]: bitangent = sign (normal x tangent), -1 where the texture is mirrored.
ruga_status ruga_tangents_create(const ruga_mesh* mesh, const double* position, const double* normal,
                                 double** tangent, signed char** sign);

#endif
