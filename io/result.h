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

// The creases' segments: straight pieces between two vertices of the mesh.
typedef struct ruga_result_creases {
    int segment_count;     // S, above 0
    const int* segment;    // [S][2] vertices
    const int* crease;     // [S] the crease it belongs to
    const double* length;  // [S] m, at rest
    const double* stiffness; // [S] N
    const char* assignment;  // [S] 'M', 'V', 'F', 'U' as in FOLD
    int crease_count;
    char* const* name; // [crease_count] where each comes from
} ruga_result_creases;

// What stands in the file from the start.
typedef struct ruga_result_header {
    const ruga_mesh* mesh;
    const ruga_lattice* lattice; // NULL with interior: none
    const char* scene_text;
    const char* libraries; // names and versions of the libraries in use besides HDF5, or NULL
    uint64_t scene_hash, mesh_hash;
    int64_t seed;
    double mesh_unit;
    double wavelength, critical_strain, cluster_sigma, cluster_radius; // for measure; 0 where unknown
    int restart_doubles;                                               // length of the restart vector
    // Where the skin varies, otherwise NULL: [V] m, [V] Pa, [V][2], and [V] m, local eq. 3
    const double *vertex_thickness, *vertex_young, *vertex_growth, *vertex_wavelength;
    const ruga_result_creases* creases; // NULL = none
    int handle_count;
} ruga_result_header;

// One frame. Pointers to arrays of the caller; lattice_position NULL with interior: none (and embedded).
typedef struct ruga_result_frame {
    double time;
    const double* position;         // [V][3]
    const double* embedded;         // [V][3]
    const double* lattice_position; // [N][3]
    ruga_report report;
    const double* restart; // [restart_doubles]
    const double *crease_angle, *crease_rest; // [S] rad; only with creases
    double gap;                               // m, largest between what is sewn together
    const double* segment_gap;                // [S] m, at the ends of each segment; only with creases
    const double* handle_force;               // [handles][3] N, only with handles
} ruga_result_frame;

// A new file. It is written under the temporary name `path.part-PID`, and takes the place of what stood at
// `path` with its first frame; so a file at `path` always has a whole frame. RUGA_BAD_INPUT where the path
// exists and `force` is false.
ruga_status ruga_result_create(const char* path, const ruga_result_header* header, bool force,
                               ruga_result** result);

// Continues a file: its whole frames are copied to a fresh file that then takes its place. frames_done =
// whole frames found, restart [restart_doubles] = the last one's vector. Where there is no file: RUGA_OK with
// frames_done = 0 and *result = NULL. RUGA_BAD_INPUT where scene, mesh or restart data do not fit.
ruga_status ruga_result_resume(const char* path, const ruga_result_header* header, double* restart,
                               int* frames_done, ruga_result** result);

// Appends a frame and makes it visible to readers. After a failure the frames before it stay readable, and
// every further append fails.
ruga_status ruga_result_append(ruga_result* result, const ruga_result_frame* frame);
// Frees *result in any case. A file without a frame is removed.
ruga_status ruga_result_close(ruga_result** result);

// Reading, also while the file is written: the frames that were whole when it was opened. RUGA_IO where the
// file cannot be read, RUGA_BAD_INPUT where it is no result file or is damaged.
typedef struct ruga_result_reader ruga_result_reader;
ruga_status ruga_result_open(const char* path, ruga_result_reader** reader);
void ruga_result_reader_close(ruga_result_reader** reader);
int ruga_result_frame_count(const ruga_result_reader* reader);
const ruga_mesh* ruga_result_mesh(const ruga_result_reader* reader);
bool ruga_result_has_interior(const ruga_result_reader* reader);
// As written, but with lattice and libraries NULL. Valid until the reader is closed.
const ruga_result_header* ruga_result_reader_header(const ruga_result_reader* reader);
// Each may be NULL; position and embedded [V][3] of the caller.
ruga_status ruga_result_read_frame(ruga_result_reader* reader, int frame, double* time, double* position,
                                   double* embedded, ruga_report* report);
// Creases of a frame: angles and rest angles [S] rad, gap in m; each may be NULL. RUGA_BAD_INPUT without creases.
ruga_status ruga_result_read_creases(ruga_result_reader* reader, int frame, double* angle, double* rest, double* gap);
// gap [S] m; of a file that lacks them, the frame's largest for each.
ruga_status ruga_result_read_segment_gaps(ruga_result_reader* reader, int frame, double* gap);
// Forces of the handles on the skin, [handles][3] N; zero where the file (of an older version) has none.
ruga_status ruga_result_read_handle_force(ruga_result_reader* reader, int frame, double* force);
// Lattice of the file: counts, and node positions of a frame [N][3]; each may be NULL. Without an interior
// the counts are 0.
ruga_status ruga_result_read_lattice(ruga_result_reader* reader, int frame, int* node_count,
                                     int* element_count, double* position);
// Its nodes at rest [N][3] and its elements [E][nodes_per_element], 27 or 8; each may be NULL.
ruga_status ruga_result_read_lattice_rest(ruga_result_reader* reader, int* nodes_per_element, int* elements,
                                          double* rest);

#endif
