// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Crease patterns from FOLD files (https://github.com/edemaine/fold, version 1.2) and SVG drawings, and
// folded frames to FOLD files.
#ifndef RUGA_IO_FOLD_H
#define RUGA_IO_FOLD_H

#include "crease/pattern.h"
#include "mesh/mesh.h"

// Frame 0 is the file's own, frame k its k-th of file_frames, with what it inherits. Lengths are brought to
// metres by frame_unit (none or "unit": as they are) and multiplied by `scale`. A flat pattern is arranged,
// see crease/pattern.h, with a tolerance of 1e-6 of its size; a folded form is taken as it is. RUGA_BAD_INPUT
// with the field and its number where the file is wrong, RUGA_IO where it cannot be read.
ruga_status ruga_fold_read(const char* path, int frame, double scale, ruga_crease_pattern* pattern);

// Lines by their stroke, as docs/creases.md lists them; y points up afterwards. Curves become polylines
// within `tolerance` of the drawing's size. One unit of the drawing is `scale` m. Then arranged, with 1e-4 of
// the size.
ruga_status ruga_svg_read(const char* path, double scale, double tolerance, ruga_crease_pattern* pattern);

// What lies within the outline, holes left out, as a few large triangles, which know nothing of the creases,
// to be remeshed. A folded form keeps its faces. RUGA_BAD_INPUT where there are none.
ruga_status ruga_crease_pattern_mesh(const ruga_crease_pattern* pattern, const char* path, ruga_mesh* mesh);

// What is written: triangles (or any faces), and edges with assignments.
typedef struct ruga_fold_frame {
    const double* position; // [V][3] m
    const double* angle;    // [E] rad, NAN = null; NULL = not written
    double time;            // s; goes into frame_title
} ruga_fold_frame;
// The first frame is the file's own (creasePattern where `flat`), all others are foldedForm and inherit from
// it. `unit`: the file's frame_unit, which the positions are in.
ruga_status ruga_fold_write(const char* path, const ruga_crease_pattern* pattern, const char* unit, bool flat,
                            int frame_count, const ruga_fold_frame* frame);

// A drawing of a flat pattern in the colours that ruga_svg_read knows, one unit of it `unit` m: each chain of
// lines is a path, so that a drawing program takes it as one.
ruga_status ruga_svg_write(const char* path, const ruga_crease_pattern* pattern, double unit);

#endif
