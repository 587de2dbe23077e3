// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The faces of an arranged crease pattern, and which of its lines have paper on one side only.
#ifndef RUGA_CREASE_FACES_H
#define RUGA_CREASE_FACES_H

#include "crease/pattern.h"

// Finds the faces from the lines and SETs `rim` of every edge. Borders that run around a place within the
// sheet cut a hole out of it. What cannot be as it is drawn is noted. RUGA_BAD_INPUT where no face is left.
ruga_status ruga_crease_pattern_find_faces(ruga_crease_pattern* pattern);
// SETs `rim` from the faces at hand; lines that sides of faces lack are added, and noted. *complete is false,
// which is noted, where a line that is neither border nor cut has a face on one side only, so that one is
// missing, or a border has none.
ruga_status ruga_crease_pattern_mark_rims(ruga_crease_pattern* pattern, bool* complete);

// The panel of each face [faces], from 0 on: those that no line, or a flat one, divides are of one.
ruga_status ruga_crease_pattern_panels(const ruga_crease_pattern* pattern, int* count, int* panel);

#endif
