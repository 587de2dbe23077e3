// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The little of HDF5 that result files need: rows of datasets, attributes, and its errors as sentences.
#ifndef RUGA_IO_HDF5_UTIL_H
#define RUGA_IO_HDF5_UTIL_H

#include "core/status.h"

#include <hdf5.h>

// Between begin and end, HDF5 prints nothing, and the innermost message of its first failure is kept: later
// calls, such as those that clean up, do not wipe it out. The caller's error handler is put back at the end.
typedef struct ruga_hdf5 {
    const char* path;
    char reason[200];
    H5E_auto2_t old_handler;
    void* old_context;
} ruga_hdf5;

void ruga_hdf5_begin(ruga_hdf5* hdf5, const char* path);
void ruga_hdf5_end(ruga_hdf5* hdf5);
// RUGA_OK, or the status with "path: trouble: HDF5's reason".
ruga_status ruga_hdf5_check(ruga_hdf5* hdf5, bool ok, ruga_status status, const char* trouble);

// The calls below are false (or negative) where HDF5 failed.

// A dataset and the groups above it. chunk_rows = 0: of fixed size, its space taken at once; otherwise of
// size[0] rows that may grow without limit. `fill` is one element of the type, or NULL for zero.
hid_t ruga_hdf5_make(hid_t file, const char* name, hid_t type, int rank, const hsize_t* size,
                     hsize_t chunk_rows, const void* fill);
// A dataset of fixed size, written whole; `memory_type` is that of `data`.
bool ruga_hdf5_put_array(hid_t file, const char* name, hid_t type, hid_t memory_type, int rank,
                         const hsize_t* size, const void* data);
// One row (all but the first dimension); writing the row after the last lets the dataset grow.
bool ruga_hdf5_put_row(hid_t set, hid_t memory_type, hsize_t row, const void* data);
bool ruga_hdf5_get_row(hid_t set, hid_t memory_type, hsize_t row, void* data);
// size[rank]; false also where the rank is another.
bool ruga_hdf5_shape(hid_t set, int rank, hsize_t* size);

// Strings of any length, in UTF-8.
bool ruga_hdf5_put_texts(hid_t file, const char* name, int count, char* const* texts);
bool ruga_hdf5_put_text(hid_t object, const char* name, const char* text);
bool ruga_hdf5_put_double(hid_t object, const char* name, double value);
bool ruga_hdf5_put_integer(hid_t object, const char* name, int64_t value);
// The text of an attribute in HDF5's memory: H5free_memory.
bool ruga_hdf5_get_text(hid_t object, const char* name, char** text);
bool ruga_hdf5_get_double(hid_t object, const char* name, double* value);
bool ruga_hdf5_get_integer(hid_t object, const char* name, int64_t* value);
// A type for strings of any length; H5Tclose.
hid_t ruga_hdf5_text_type(void);

#endif
