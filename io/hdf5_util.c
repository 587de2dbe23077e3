// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "io/hdf5_util.h"

#include <stdio.h>
#include <string.h>

enum { MAX_RANK = 4 };

// Of a failed system call, HDF5 tells the file, the descriptor, addresses and more: people want the error.
static herr_t keep_innermost(unsigned number, const H5E_error2_t* error, void* context) {
    ruga_hdf5* hdf5 = context;
    static const char mark[] = "error message = '";
    if (number > 0 || !error->desc) {
        return 0;
    }
    const char* start = strstr(error->desc, mark);
    const char* text = start ? start + sizeof mark - 1 : error->desc;
    int length = start ? (int)strcspn(text, "'") : (int)strlen(text);
    (void)snprintf(hdf5->reason, sizeof hdf5->reason, "%.*s", length, text);
    return 0;
}

static herr_t keep_reason(hid_t stack, void* context) {
    ruga_hdf5* hdf5 = context;
    if (hdf5->reason[0] == '\0') {
        (void)H5Ewalk2(stack, H5E_WALK_UPWARD, keep_innermost, hdf5);
    }
    return 0;
}

void ruga_hdf5_begin(ruga_hdf5* hdf5, const char* path) {
    *hdf5 = (ruga_hdf5){.path = path};
    // Cleaning up at exit, HDF5 1.10 crashes where a file could not be written (disk full).
    (void)H5dont_atexit();
    (void)H5open();
    (void)H5Eget_auto2(H5E_DEFAULT, &hdf5->old_handler, &hdf5->old_context);
    (void)H5Eset_auto2(H5E_DEFAULT, keep_reason, hdf5);
}

void ruga_hdf5_end(ruga_hdf5* hdf5) {
    (void)H5Eset_auto2(H5E_DEFAULT, hdf5->old_handler, hdf5->old_context);
}

ruga_status ruga_hdf5_check(ruga_hdf5* hdf5, bool ok, ruga_status status, const char* trouble) {
    if (ok) {
        return RUGA_OK;
    }
    status = ruga_fail(status, "%s: %s%s%s", hdf5->path, trouble, hdf5->reason[0] ? ": " : "", hdf5->reason);
    hdf5->reason[0] = '\0';
    return status;
}

// Intermediate groups are made; without time stamps, so that two runs give the same file.
static hid_t link_properties(void) {
    hid_t links = H5Pcreate(H5P_LINK_CREATE);
    if (links >= 0) {
        (void)H5Pset_create_intermediate_group(links, 1);
    }
    return links;
}

static bool set_layout(hid_t properties, hid_t type, int rank, const hsize_t* size, hsize_t chunk_rows,
                       const void* fill) {
    hsize_t chunk[MAX_RANK] = {chunk_rows};
    for (int i = 1; i < rank; i++) {
        chunk[i] = size[i];
    }
    bool ok = H5Pset_obj_track_times(properties, 0) >= 0;
    if (chunk_rows > 0) {
        ok = ok && H5Pset_chunk(properties, rank, chunk) >= 0;
    } else {
        ok = ok && H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY) >= 0;
    }
    return ok && (!fill || H5Pset_fill_value(properties, type, fill) >= 0);
}

hid_t ruga_hdf5_make(hid_t file, const char* name, hid_t type, int rank, const hsize_t* size,
                     hsize_t chunk_rows, const void* fill) {
    RUGA_ASSERT(rank >= 1 && rank <= MAX_RANK);
    hsize_t limit[MAX_RANK] = {chunk_rows > 0 ? H5S_UNLIMITED : size[0]};
    for (int i = 1; i < rank; i++) {
        limit[i] = size[i];
    }
    hid_t set = -1;
    hid_t links = link_properties();
    hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    hid_t space = H5Screate_simple(rank, size, limit);
    if (links >= 0 && space >= 0 && properties >= 0 &&
        set_layout(properties, type, rank, size, chunk_rows, fill)) {
        set = H5Dcreate2(file, name, type, space, links, properties, H5P_DEFAULT);
    }
    (void)H5Sclose(space);
    (void)H5Pclose(properties);
    (void)H5Pclose(links);
    return set;
}

bool ruga_hdf5_put_array(hid_t file, const char* name, hid_t type, hid_t memory_type, int rank,
                         const hsize_t* size, const void* data) {
    hid_t set = ruga_hdf5_make(file, name, type, rank, size, 0, NULL);
    bool ok = set >= 0;
    bool empty = false;
    for (int i = 0; i < rank; i++) {
        empty = empty || size[i] == 0;
    }
    ok = ok && (empty || H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
    return H5Dclose(set) >= 0 && ok;
}

bool ruga_hdf5_shape(hid_t set, int rank, hsize_t* size) {
    hid_t space = H5Dget_space(set);
    bool ok = space >= 0 && H5Sget_simple_extent_type(space) == H5S_SIMPLE &&
              H5Sget_simple_extent_ndims(space) == rank &&
              H5Sget_simple_extent_dims(space, size, NULL) == rank;
    (void)H5Sclose(space);
    return ok;
}

// Dataspaces of one row, in the file and in memory.
static bool select_row(hid_t set, hsize_t row, hid_t* in_file, hid_t* in_memory) {
    hsize_t size[MAX_RANK], start[MAX_RANK] = {row};
    *in_memory = -1;
    *in_file = H5Dget_space(set);
    int rank = *in_file >= 0 ? H5Sget_simple_extent_ndims(*in_file) : -1;
    if (rank < 1 || rank > MAX_RANK || H5Sget_simple_extent_dims(*in_file, size, NULL) < 0) {
        return false;
    }
    size[0] = 1;
    *in_memory = H5Screate_simple(rank, size, NULL);
    return *in_memory >= 0 && H5Sselect_hyperslab(*in_file, H5S_SELECT_SET, start, NULL, size, NULL) >= 0;
}

static bool grow(hid_t set, hsize_t rows) {
    hsize_t size[MAX_RANK];
    hid_t space = H5Dget_space(set);
    bool ok = space >= 0 && H5Sget_simple_extent_dims(space, size, NULL) >= 1;
    (void)H5Sclose(space);
    if (ok && size[0] < rows) {
        size[0] = rows;
        ok = H5Dset_extent(set, size) >= 0;
    }
    return ok;
}

bool ruga_hdf5_put_row(hid_t set, hid_t memory_type, hsize_t row, const void* data) {
    hid_t in_file, in_memory;
    if (!grow(set, row + 1)) {
        return false;
    }
    bool ok = select_row(set, row, &in_file, &in_memory) &&
              H5Dwrite(set, memory_type, in_memory, in_file, H5P_DEFAULT, data) >= 0;
    (void)H5Sclose(in_memory);
    (void)H5Sclose(in_file);
    return ok;
}

bool ruga_hdf5_get_row(hid_t set, hid_t memory_type, hsize_t row, void* data) {
    hid_t in_file, in_memory;
    bool ok = select_row(set, row, &in_file, &in_memory) &&
              H5Dread(set, memory_type, in_memory, in_file, H5P_DEFAULT, data) >= 0;
    (void)H5Sclose(in_memory);
    (void)H5Sclose(in_file);
    return ok;
}

hid_t ruga_hdf5_text_type(void) {
    hid_t type = H5Tcopy(H5T_C_S1);
    if (type >= 0 && (H5Tset_size(type, H5T_VARIABLE) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0)) {
        (void)H5Tclose(type);
        type = -1;
    }
    return type;
}

bool ruga_hdf5_put_texts(hid_t file, const char* name, int count, char* const* texts) {
    hid_t type = ruga_hdf5_text_type();
    bool ok = type >= 0 && ruga_hdf5_put_array(file, name, type, type, 1, &(hsize_t){(hsize_t)count}, texts);
    (void)H5Tclose(type);
    return ok;
}

static bool put_attribute(hid_t object, const char* name, hid_t type, hid_t memory_type, const void* value) {
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute =
        space >= 0 ? H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT) : H5I_INVALID_HID;
    bool ok = attribute >= 0 && H5Awrite(attribute, memory_type, value) >= 0;
    (void)H5Aclose(attribute);
    (void)H5Sclose(space);
    return ok;
}

static bool get_attribute(hid_t object, const char* name, hid_t memory_type, void* value) {
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    hid_t space = attribute >= 0 ? H5Aget_space(attribute) : H5I_INVALID_HID;
    bool ok =
        space >= 0 && H5Sget_simple_extent_npoints(space) == 1 && H5Aread(attribute, memory_type, value) >= 0;
    (void)H5Sclose(space);
    (void)H5Aclose(attribute);
    return ok;
}

bool ruga_hdf5_put_text(hid_t object, const char* name, const char* text) {
    hid_t type = ruga_hdf5_text_type();
    bool ok = type >= 0 && put_attribute(object, name, type, type, &text);
    (void)H5Tclose(type);
    return ok;
}

bool ruga_hdf5_put_double(hid_t object, const char* name, double value) {
    return put_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

bool ruga_hdf5_put_integer(hid_t object, const char* name, int64_t value) {
    return put_attribute(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

bool ruga_hdf5_get_text(hid_t object, const char* name, char** text) {
    *text = NULL;
    hid_t type = ruga_hdf5_text_type();
    bool ok = type >= 0 && get_attribute(object, name, type, text) && *text;
    (void)H5Tclose(type);
    return ok;
}

bool ruga_hdf5_get_double(hid_t object, const char* name, double* value) {
    return get_attribute(object, name, H5T_NATIVE_DOUBLE, value);
}

bool ruga_hdf5_get_integer(hid_t object, const char* name, int64_t* value) {
    return get_attribute(object, name, H5T_NATIVE_INT64, value);
}
