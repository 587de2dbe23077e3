// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// How the pictures of the cases draw what is compared with.
#ifndef RUGA_APP_VALIDATE_BAND_H
#define RUGA_APP_VALIDATE_BAND_H

#include "view/plot.h"

// A line with its tolerance.
static inline ruga_plot_series reference_band(const char* name, int count, const double* x, const double* y,
                                              const double* low, const double* high) {
    return (ruga_plot_series){.name = name,
                              .count = count,
                              .x = x,
                              .y = y,
                              .low = low,
                              .high = high,
                              .style = RUGA_PLOT_LINE,
                              .color = 7};
}

#endif
