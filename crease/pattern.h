// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A crease pattern: lines with their assignments, and the faces between them.
#ifndef RUGA_CREASE_PATTERN_H
#define RUGA_CREASE_PATTERN_H

#include "crease/curve.h"

typedef enum ruga_assignment {
    RUGA_ASSIGNMENT_BORDER,     // B
    RUGA_ASSIGNMENT_MOUNTAIN,   // M
    RUGA_ASSIGNMENT_VALLEY,     // V
    RUGA_ASSIGNMENT_FLAT,       // F: a line that is not folded
    RUGA_ASSIGNMENT_UNASSIGNED, // U: a crease, either way
    RUGA_ASSIGNMENT_CUT,        // C
    RUGA_ASSIGNMENT_COUNT
} ruga_assignment;

typedef struct ruga_crease_pattern_edge {
    int vertex[2];
    ruga_assignment assignment;
    double angle; // rad, positive for a valley; NAN = not given
    bool rim;     // of a flat pattern that was arranged: there is paper on one side only
} ruga_crease_pattern_edge;

typedef struct ruga_crease_pattern {
    int vertex_count, vertex_capacity;
    double (*position)[3]; // m; z = 0 unless `folded`
    int edge_count, edge_capacity;
    ruga_crease_pattern_edge* edge;
    int face_count, face_capacity;
    int corner_count, corner_capacity;
    int* face_start; // [faces + 1], NULL where there are no faces
    int* corner;     // vertices of the faces, counter-clockwise
    bool folded;     // a folded form in space
    int note_count, note_capacity;
    char** note; // what was repaired, a sentence each
} ruga_crease_pattern;

void ruga_crease_pattern_clear(ruga_crease_pattern* pattern);
ruga_status ruga_crease_pattern_add_vertex(ruga_crease_pattern* pattern, const double position[3]);
ruga_status ruga_crease_pattern_add_edge(ruga_crease_pattern* pattern, int a, int b,
                                         ruga_assignment assignment, double angle);
// Begins a face, whose corners follow; `ruga_crease_pattern_add_corner` appends to the last one.
ruga_status ruga_crease_pattern_add_face(ruga_crease_pattern* pattern);
ruga_status ruga_crease_pattern_add_corner(ruga_crease_pattern* pattern, int vertex);
ruga_status ruga_crease_pattern_note(ruga_crease_pattern* pattern, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
// 'B', 'M', 'V', 'F', 'U', 'C'; COUNT for any other letter.
ruga_assignment ruga_assignment_from_letter(char letter);
char ruga_assignment_letter(ruga_assignment assignment);

// The angle that an edge is to have: its own, otherwise +-180 degrees for V and M, 0 for others.
double ruga_crease_pattern_rest(const ruga_crease_pattern_edge* edge);

// Makes a planar arrangement of a flat pattern: vertices within `weld` (m) become one, lines are split where
// they cross and where vertices lie on them, lines on top of one another become one; faces are found anew if
// anything changed, or if there are none or one is missing. Borders around a place within the sheet make a
// hole. Every repair is noted. RUGA_BAD_INPUT where no face is left.
ruga_status ruga_crease_pattern_arrange(ruga_crease_pattern* pattern, double weld);

// The creases as curves: edges of one assignment and angle are chained where nothing else meets them. The
// label of a curve is the first of its edges. Flat lines only where `flat`. `style` gives the freedom.
ruga_status ruga_crease_pattern_curves(const ruga_crease_pattern* pattern, const ruga_curve* style, bool flat,
                                       ruga_curves* curves);
// The other way: curves whose labels are assignments, and the boundary of a mesh as the border. Nothing is
// arranged.
ruga_status ruga_crease_pattern_add_curves(ruga_crease_pattern* pattern, const ruga_curves* curves);
ruga_status ruga_crease_pattern_add_boundary(ruga_crease_pattern* pattern, const ruga_mesh* mesh);

#endif
