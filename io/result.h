// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The result file (HDF5): layout in docs/result.md and the contract of datasets. Readable at any moment, also
// after the writer was killed, with every whole frame in it.
#ifndef RUGA_IO_RESULT_H
#define RUGA_IO_RESULT_H

#include "lattice/lattice.h"
#include "mesh/mesh.h"
#include "ruga/types.h"

typedef struct ruga_result ruga_result;

// What stands in the file from the start.
typedef struct ruga_result_header {
    const ruga_mesh* mesh;
    const ruga_lattice* lattice; // NULL with interior: none
    const char* scene_text;
    uint64_t scene_hash, mesh_hash;
    int64_t seed;
    double mesh_unit;
    double wavelength, critical_strain, cluster_sigma, cluster_radius; // for measure; 0 where unknown
    int restart_doubles; // length of the restart vector
} ruga_result_header;

// One frame. Pointers to arrays of the caller; lattice_position NULL with interior: none (and embedded).
typedef struct ruga_result_frame {
    double time;
    const double* position;         // [V][3]
    const double* embedded;         // [V][3]
    const double* lattice_position; // [N][3]
    ruga_report report;
    const double* restart; // [restart_doubles]
} ruga_result_frame;

// A new file, made under a temporary name and renamed once it is readable. RUGA_BAD_INPUT where the path
// exists and `force` is false.
ruga_status ruga_result_create(const char* path, const ruga_result_header* header, bool force,
                               ruga_result** result);

// Continues a file: its whole frames are copied to a fresh file that then takes its place. frames_done = whole
// frames found (>= 1), restart = the last one's vector. RUGA_BAD_INPUT where scene or mesh hash differ.
ruga_status ruga_result_resume(const char* path, const ruga_result_header* header, double* restart,
                               int* frames_done, ruga_result** result);

// Appends a frame and makes it visible to readers.
ruga_status ruga_result_append(ruga_result* result, const ruga_result_frame* frame);
ruga_status ruga_result_close(ruga_result** result);

// Reading.
typedef struct ruga_result_reader ruga_result_reader;
ruga_status ruga_result_open(const char* path, ruga_result_reader** reader);
void ruga_result_reader_close(ruga_result_reader** reader);
int ruga_result_frame_count(const ruga_result_reader* reader);
const ruga_mesh* ruga_result_mesh(const ruga_result_reader* reader);
bool ruga_result_has_interior(const ruga_result_reader* reader);
const ruga_result_header* ruga_result_reader_header(const ruga_result_reader* reader);
// Each may be NULL; position and embedded [V][3] of the caller.
ruga_status ruga_result_read_frame(ruga_result_reader* reader, int frame, double* time, double* position,
                                   double* embedded, ruga_report* report);
// Lattice of the file: counts, and node positions of a frame [N][3]; elements and rest may be NULL.
ruga_status ruga_result_read_lattice(ruga_result_reader* reader, int frame, int* node_count,
                                     int* element_count, double* position);

#endif
