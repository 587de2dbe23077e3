// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The line of least squares through points.
#ifndef RUGA_APP_VALIDATE_LINE_H
#define RUGA_APP_VALIDATE_LINE_H

typedef struct fitted_line {
    double n, x, xx, y, xy; // sums
} fitted_line;

static inline void line_add(fitted_line* line, double x, double y) {
    line->n += 1;
    line->x += x;
    line->xx += x * x;
    line->y += y;
    line->xy += x * y;
}

// Where a line that rises is zero; 0 for others, and for fewer than two points.
static inline double line_zero(const fitted_line* s) {
    double slope = s->n > 1 ? (s->n * s->xy - s->x * s->y) / (s->n * s->xx - s->x * s->x) : 0;
    return slope > 0 ? (s->x - s->y / slope) / s->n : 0;
}

#endif
