// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#ifndef RUGA_IO_TRIANGULATE_H
#define RUGA_IO_TRIANGULATE_H

#include "core/status.h"

// Cuts a polygon of count >= 3 corners into count - 2 triangles of corner numbers, running the same way.
// Always succeeds but for lack of memory; where no cut without overlap is found (the polygon crosses itself
// or has no area) the triangles still cover its outline.
ruga_status ruga_triangulate(int count, const double position[][3], int (*triangle)[3]);

#endif
