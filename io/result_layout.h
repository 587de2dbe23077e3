// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What the writer and the reader of result files share: names in the file, and the columns of /stats.
#ifndef RUGA_IO_RESULT_LAYOUT_H
#define RUGA_IO_RESULT_LAYOUT_H

#include "io/hdf5_util.h"
#include "io/result.h"

enum { RUGA_RESULT_FORMAT = 1 }; // attribute `format`; a reader refuses a later one

// Name of the dataset under /stats = name of the field of ruga_report.
#define RUGA_RESULT_COUNTS(X) X(newton_iterations) X(linear_iterations) X(factorizations) X(substeps)
#define RUGA_RESULT_REALS(X)                                                                                 \
    X(residual_shell)                                                                                        \
    X(residual_coupled)                                                                                      \
    X(constraint_residual) X(energy_membrane) X(energy_bending) X(energy_foundation) X(energy_interior)      \
        X(energy_kinetic) X(energy_external) X(energy_hinge) X(seconds_total) X(seconds_interior) X(seconds_assembly)        \
            X(seconds_factor) X(seconds_solve) X(seconds_other)

typedef enum ruga_result_column {
#define RUGA_RESULT_COLUMN(name) RUGA_RESULT_COLUMN_##name,
    RUGA_RESULT_COUNTS(RUGA_RESULT_COLUMN) RUGA_RESULT_REALS(RUGA_RESULT_COLUMN)
#undef RUGA_RESULT_COLUMN
        RUGA_RESULT_COLUMN_outcome,
    RUGA_RESULT_COLUMNS
} ruga_result_column;

// Everything with a row for each frame, and the restart data. Without an interior, EMBEDDED, LATTICE absent.
enum {
    RUGA_RESULT_TIME,
    RUGA_RESULT_POSITION,
    RUGA_RESULT_EMBEDDED,
    RUGA_RESULT_LATTICE,
    RUGA_RESULT_STATS, // first of RUGA_RESULT_COLUMNS
    RUGA_RESULT_RESTART = RUGA_RESULT_STATS + RUGA_RESULT_COLUMNS,
    RUGA_RESULT_RESTART_FRAME,
    RUGA_RESULT_ANGLE, // with creases only
    RUGA_RESULT_REST_ANGLE,
    RUGA_RESULT_GAP,
    RUGA_RESULT_SEGMENT_GAP,
    RUGA_RESULT_HANDLE_FORCE, // with handles only
    RUGA_RESULT_SETS
};

// Path in the file of one of the sets.
const char* ruga_result_set_name(int set);
// Type in the file of one of the sets.
hid_t ruga_result_set_type(int set);
static inline bool ruga_result_set_is_interior(int set) {
    return set == RUGA_RESULT_EMBEDDED || set == RUGA_RESULT_LATTICE;
}

static inline bool ruga_result_set_is_crease(int set) {
    return set >= RUGA_RESULT_ANGLE && set <= RUGA_RESULT_SEGMENT_GAP;
}

bool ruga_result_put_report(const hid_t* sets, hsize_t row, const ruga_report* report);
bool ruga_result_get_report(const hid_t* sets, hsize_t row, ruga_report* report);

// The restart vector of a frame; *found is false where the file no longer has it.
ruga_status ruga_result_read_restart(ruga_result_reader* reader, int frame, double* restart, bool* found);

#endif
