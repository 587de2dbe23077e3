// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A grid of scenes: every combination of the values given by --set, each run as `ruga run` in a process of
// its own, and one table of all that `ruga measure` says of their last frames.
#ifndef RUGA_APP_SWEEP_H
#define RUGA_APP_SWEEP_H

#include "app/meter.h"
#include "io/pool.h"

#include <jansson.h>

// One key that --set names, with its values as YAML in one line each.
typedef struct ruga_sweep_axis {
    char* key;
    int count;
    char** text;    // [count]
    bool has_given; // the table has a column of the texts too, as numbers alone would lose their units
} ruga_sweep_axis;

typedef enum ruga_sweep_state {
    RUGA_SWEEP_WAITS,
    RUGA_SWEEP_RUNS,
    RUGA_SWEEP_DONE, // in this or an earlier sweep
} ruga_sweep_state;

typedef struct ruga_sweep_point {
    char** sets; // [axis_count] "key=value"
    uint64_t scene_hash, mesh_hash;
    int frames;       // after frame 0
    char* result;     // DIR/points/HASH.h5, by the scene's hash: it keeps its name when values are added
    const char* file; // the same from DIR on, as the table has it
    char* log;        // what its process said on stderr
    ruga_sweep_state state;
    int exit_status; // of `ruga run`; -1 = not known
    long process;
    double begin; // s
    json_t* row;  // of the table
} ruga_sweep_point;

typedef struct ruga_sweep {
    const char *scene, *directory;
    ruga_pool pool; // of all texts
    int axis_count, point_count;
    ruga_sweep_axis* axes;
    ruga_sweep_point* points; // the last axis varies fastest
} ruga_sweep;

// Reads the scene once for each point, so that bad input is found before anything is run. A list is swept;
// where the key itself takes a list (mesh.make.size), a list of lists is.
ruga_status ruga_sweep_read(const char* scene, const char* directory, int set_count, const char* const* sets,
                            ruga_sweep* sweep);
void ruga_sweep_clear(ruga_sweep* sweep);

// "skin.young=10 MPa, skin.thickness=2 mm": the values that vary.
void ruga_sweep_point_name(const ruga_sweep* sweep, const ruga_sweep_point* point, char* name, size_t size);
// Marks the points that are done already and fills their rows. *complete: how many.
ruga_status ruga_sweep_find_complete(ruga_sweep* sweep, int* complete);
// Runs what waits, `jobs` at a time. RUGA_CANCELLED after Ctrl-C, when all processes have ended at a whole
// frame.
ruga_status ruga_sweep_run(ruga_sweep* sweep, int jobs, ruga_meter* meter);
// Fills the row of a point from its result, or from its log where it failed.
ruga_status ruga_sweep_measure(ruga_sweep_point* point);

// DIR/sweep.csv and DIR/sweep.h5, a column for each key of the rows in the order of their first appearance; a
// cell that a row does not have is empty, or NAN.
ruga_status ruga_sweep_write_csv(const ruga_sweep* sweep, const char* path);
ruga_status ruga_sweep_write_hdf5(const ruga_sweep* sweep, const char* path);

#endif
