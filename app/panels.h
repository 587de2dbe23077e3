// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a result has to say over time: series of numbers in panels, for plots and for the page.
#ifndef RUGA_APP_PANELS_H
#define RUGA_APP_PANELS_H

#include "io/result.h"

enum { RUGA_PANEL_SERIES = 12, RUGA_PANELS_MAX = 12 };

typedef struct ruga_panel_series {
    char name[40];
    double* y;          // [T]
    double *low, *high; // [T] or NULL: range about y
} ruga_panel_series;

typedef struct ruga_panel {
    const char* key;  // as in --what
    const char* axis; // name with unit
    bool logarithmic;
    int series_count;
    ruga_panel_series series[RUGA_PANEL_SERIES];
    double reference; // where reference_name is not NULL
    const char* reference_name;
} ruga_panel;

typedef struct ruga_panels {
    int frame_count;
    double* time; // [T] s
    int count;
    ruga_panel panel[RUGA_PANELS_MAX];
} ruga_panels;

// Keys and what they show, ended by a NULL.
typedef struct ruga_panel_kind {
    const char *key, *about;
} ruga_panel_kind;
extern const ruga_panel_kind ruga_panel_kinds[];

// `what`: keys with commas between them, or NULL: all that the result has. RUGA_BAD_INPUT for an unknown key,
// and for one of which the result has nothing.
ruga_status ruga_panels_read(const char* path, ruga_result_reader* reader, const char* what,
                             ruga_panels* panels);
void ruga_panels_clear(ruga_panels* panels);

#endif
