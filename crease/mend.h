// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// One round of making mesh and curves fit one another.
#ifndef RUGA_CREASE_MEND_H
#define RUGA_CREASE_MEND_H

#include "crease/path.h"
#include "crease/raster.h"

// A hit of a path, or the link from the hit before to it.
typedef struct ruga_hit_name {
    int key; // edge or face, by which they are sorted
    int path;
    int hit;
} ruga_hit_name;

typedef struct ruga_mend {
    ruga_sheet* sheet;
    ruga_paths* paths;
    const ruga_raster_def* def;
    int hit_count, hit_capacity;
    ruga_hit_name* hit; // on edges, by edge
    int link_count, link_capacity;
    ruga_hit_name* link; // through faces, by face
    int moved, split_edges, split_faces;
    bool* busy; // [F] touched in this round
    int edit_count, edit_capacity;
    ruga_edit* edit;
    struct ruga_insertion* insertion;
    int insertion_count, insertion_capacity;
    bool waiting; // something had to be left for the next round
} ruga_mend;

void ruga_mend_clear(ruga_mend* mend);
// Traces the paths and makes one set of changes. *fits where there was nothing to do. Without snap, what does
// not fit is RUGA_BAD_INPUT with curves and place.
ruga_status ruga_mend_round(ruga_mend* mend, bool* fits);
// The refusal after too many rounds: where the last one still had something to do.
ruga_status ruga_mend_give_up(const ruga_mend* mend);
// Without snap: looks once more at the hits as they are.
ruga_status ruga_mend_check(ruga_mend* mend);

#endif
