// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Crease patterns that are made rather than read.
#ifndef RUGA_CREASE_DESIGN_H
#define RUGA_CREASE_DESIGN_H

#include "crease/pattern.h"

typedef enum ruga_design {
    RUGA_DESIGN_MIURA,     // cells[0] x cells[1] parallelograms with the angle `angle`; size X, Y
    RUGA_DESIGN_WATERBOMB, // cells[0] x cells[1] waterbombs, every other row half a cell on; size X, Y
    RUGA_DESIGN_PLEATS,    // cells[0] wavy creases of cells[1] waves, as steep as `angle`; size X, Y
    RUGA_DESIGN_ARCS,      // cells[0] concentric creases between inner and outer radius, over an angle: size
    RUGA_DESIGN_COUNT
} ruga_design;

typedef struct ruga_design_def {
    ruga_design design;
    double size[3]; // m, m (arcs: m, m, rad); 0 = missing: Y = X; outer radius = 2 inner radius; a full turn
    int cells[2];
    double angle; // rad; 0 = that of the design: miura 60 degrees, pleats 30 degrees
    double fold;  // rad; 0 = folded flat. miura: slope of the panels; otherwise the angle of every crease
} ruga_design_def;

// -1 where there is none.
int ruga_design_from_name(const char* name);

// An arranged flat pattern, centred at the origin; edges have their angles where `fold` is given.
// RUGA_BAD_INPUT where the numbers make no pattern.
ruga_status ruga_crease_pattern_design(const ruga_design_def* def, ruga_crease_pattern* pattern);

// The vertex (i, j) of a Miura-ori whose panels, of sides a along y and b along the zigzags with the angle
// gamma between them, stand at the slope theta, in m from vertex (0, 0).
void ruga_miura_vertex(double a, double b, double gamma, double theta, int i, int j, double x[3]);

#endif
