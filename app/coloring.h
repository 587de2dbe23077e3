// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What --color can show of a result: read from the file, or made again from the scene that it keeps.
#ifndef RUGA_APP_COLORING_H
#define RUGA_APP_COLORING_H

#include "app/frames.h"
#include "app/measure.h"
#include "app/stress.h"
#include "view/render.h"

#define RUGA_COLORING_NAMES "clay|displacement|stress|clusters|elements|creases|thickness|young|wavelength"

typedef enum ruga_coloring_kind {
    RUGA_COLORING_CLAY,
    RUGA_COLORING_DISPLACEMENT,
    RUGA_COLORING_STRESS,
    RUGA_COLORING_CLUSTERS,
    RUGA_COLORING_ELEMENTS,
    RUGA_COLORING_CREASES,
    RUGA_COLORING_THICKNESS, // the last three: of a skin that varies
    RUGA_COLORING_YOUNG,
    RUGA_COLORING_WAVELENGTH,
} ruga_coloring_kind;

typedef struct ruga_coloring {
    ruga_coloring_kind kind;
    const char* path; // of the result
    ruga_result_reader* reader;
    ruga_measure* measure;
    ruga_stress_skin skin;
    double *value, *work; // [V]
    int* place;           // [V]
    int* line;            // [F][3] segments of the creases along the edges, or NULL
    double* line_angle;   // [S] rad, of a frame
    double* position;     // [V][3] work of ruga_coloring_scan
    double* embedded;
    ruga_scale scale; // of values at vertices or lines
    char note[96];
} ruga_coloring;

// RUGA_BAD_INPUT with the option and the reason where the result has nothing to show. To be cleared in any
// case.
ruga_status ruga_coloring_create(const char* path, ruga_result_reader* reader, ruga_coloring_kind kind,
                                 ruga_coloring* coloring);
void ruga_coloring_clear(ruga_coloring* coloring);
// Whether ruga_coloring_set wants the embedded surface.
bool ruga_coloring_needs_embedded(const ruga_coloring* coloring);
// Takes the colours' scale from these frames, one for all. `extent` becomes what a camera must see of them.
ruga_status ruga_coloring_scan(ruga_coloring* coloring, const ruga_frame_range* range, ruga_extent* extent);
// Colours a picture of a frame with these positions; def keeps pointers into the coloring.
ruga_status ruga_coloring_set(ruga_coloring* coloring, int frame, const double* position,
                              const double* embedded, ruga_render_def* def);

#endif
