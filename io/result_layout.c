// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/result_layout.h"

#define COUNT_NAME(name) "/stats/" #name,
static const char* const set_names[RUGA_RESULT_SETS] = {
    "/frames/time",
    "/shell/position",
    "/shell/embedded",
    "/lattice/position",
    RUGA_RESULT_COUNTS(COUNT_NAME) RUGA_RESULT_REALS(COUNT_NAME) "/stats/outcome",
    "/restart/vector",
    "/restart/frame",
    "/creases/angle",
    "/creases/rest_angle",
    "/creases/gap",
    "/creases/segment_gap",
    "/stats/handle_force",
};

const char* ruga_result_set_name(int set) {
    return set_names[set];
}

hid_t ruga_result_set_type(int set) {
    int column = set - RUGA_RESULT_STATS;
    if (column == RUGA_RESULT_COLUMN_outcome) {
        return H5T_STD_I8LE;
    }
    if (column >= 0 && column < RUGA_RESULT_COLUMN_residual_shell) {
        return H5T_STD_I32LE;
    }
    return set == RUGA_RESULT_RESTART_FRAME ? H5T_STD_I64LE : H5T_IEEE_F64LE;
}

bool ruga_result_put_report(const hid_t* sets, hsize_t row, const ruga_report* report) {
    const hid_t* column = sets + RUGA_RESULT_STATS;
    int outcome = (int)report->outcome;
#define PUT_COUNT(name)                                                                                      \
    if (!ruga_hdf5_put_row(column[RUGA_RESULT_COLUMN_##name], H5T_NATIVE_INT, row, &report->name)) {         \
        return false;                                                                                        \
    }
#define PUT_REAL(name)                                                                                       \
    if (!ruga_hdf5_put_row(column[RUGA_RESULT_COLUMN_##name], H5T_NATIVE_DOUBLE, row, &report->name)) {      \
        return false;                                                                                        \
    }
    RUGA_RESULT_COUNTS(PUT_COUNT)
    RUGA_RESULT_REALS(PUT_REAL)
    return ruga_hdf5_put_row(column[RUGA_RESULT_COLUMN_outcome], H5T_NATIVE_INT, row, &outcome);
}

bool ruga_result_get_report(const hid_t* sets, hsize_t row, ruga_report* report) {
    const hid_t* column = sets + RUGA_RESULT_STATS;
    int outcome = 0;
#define GET_COUNT(name)                                                                                      \
    if (!ruga_hdf5_get_row(column[RUGA_RESULT_COLUMN_##name], H5T_NATIVE_INT, row, &report->name)) {         \
        return false;                                                                                        \
    }
#define GET_REAL(name)                                                                                       \
    if (column[RUGA_RESULT_COLUMN_##name] >= 0 &&                                                            \
        !ruga_hdf5_get_row(column[RUGA_RESULT_COLUMN_##name], H5T_NATIVE_DOUBLE, row, &report->name)) {      \
        return false;                                                                                        \
    }
    RUGA_RESULT_COUNTS(GET_COUNT)
    RUGA_RESULT_REALS(GET_REAL)
    if (!ruga_hdf5_get_row(column[RUGA_RESULT_COLUMN_outcome], H5T_NATIVE_INT, row, &outcome)) {
        return false;
    }
    // A value that a later version may know is not taken for success.
    report->outcome = outcome >= RUGA_OUTCOME_MINIMUM && outcome <= RUGA_OUTCOME_MOTION
                          ? (ruga_outcome)outcome
                          : RUGA_OUTCOME_NOT_CONVERGED;
    return true;
}
