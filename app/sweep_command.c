// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga sweep: a grid of scenes and the table of what comes out.
#define _POSIX_C_SOURCE 200809L
#include "app/sweep.h"

#include "app/console.h"
#include "app/interrupt.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const ruga_option options[] = {
    {"--set", NULL, "KEY=[A,B,..]",
     "the values of a key of the scene, such as skin.young=\"[10 MPa, 40 MPa]\"; may be given\n"
     "several times: all combinations are run. KEY=VALUE replaces a value in all of them.\n"
     "Where a value is itself a list (mesh.make.size), write a list of lists",
     true},
    {"--output", "-o", "DIR", "where results and tables go; made where it is missing", false},
    {"--jobs", NULL, "N", "how many to run at a time, each on one thread [all cores]", false},
    {"--json", "-j", NULL, "print the table as one JSON object", false},
    {0},
};

enum { JOBS_MAX = 1024, PATH_LENGTH = 4096 };

typedef struct count_of {
    int minimum, not_minimum, failed, waiting;
} count_of;

static ruga_status make_folders(const char* directory) {
    char points[PATH_LENGTH];
    if (snprintf(points, sizeof points, "%s/points", directory) >= PATH_LENGTH - 64) {
        return ruga_fail(RUGA_BAD_INPUT, "the path of the folder is too long");
    }
    RUGA_TRY(ruga_make_folder(directory));
    return ruga_make_folder(points);
}

static void say_plan(const ruga_arguments* arguments, const ruga_sweep* sweep, int complete, int jobs) {
    if (ruga_given(arguments, "--quiet") || ruga_given(arguments, "--json")) {
        return;
    }
    (void)printf("%s: %d points:", sweep->scene, sweep->point_count);
    for (int i = 0, n = 0; i < sweep->axis_count; i++) {
        if (sweep->axes[i].count > 1) {
            (void)printf("%s %s (%d)", n++ ? " x" : "", sweep->axes[i].key, sweep->axes[i].count);
        }
    }
    (void)printf("\n%d are complete already; running the others, %d at a time, into %s/points\n", complete,
                 jobs, sweep->directory);
    (void)fflush(stdout);
}

static count_of count_points(const ruga_sweep* sweep) {
    count_of count = {0};
    for (int k = 0; k < sweep->point_count; k++) {
        const ruga_sweep_point* p = &sweep->points[k];
        if (p->state != RUGA_SWEEP_DONE) {
            count.waiting++;
        } else if (p->exit_status == RUGA_EXIT_DONE) {
            count.minimum++;
        } else if (p->exit_status == RUGA_EXIT_NOT_CONVERGED) {
            count.not_minimum++;
        } else {
            count.failed++;
        }
    }
    return count;
}

static ruga_status write_tables(ruga_sweep* sweep, char csv[PATH_LENGTH], char hdf5[PATH_LENGTH]) {
    for (int k = 0; k < sweep->point_count; k++) {
        if (sweep->points[k].state == RUGA_SWEEP_WAITS) {
            RUGA_TRY(ruga_sweep_measure(&sweep->points[k]));
        }
    }
    (void)snprintf(csv, PATH_LENGTH, "%s/sweep.csv", sweep->directory);
    (void)snprintf(hdf5, PATH_LENGTH, "%s/sweep.h5", sweep->directory);
    RUGA_TRY(ruga_sweep_write_csv(sweep, csv));
    return ruga_sweep_write_hdf5(sweep, hdf5);
}

static ruga_status tell(const ruga_arguments* arguments, const ruga_sweep* sweep, const char* csv,
                        const char* hdf5) {
    count_of count = count_points(sweep);
    if (ruga_given(arguments, "--json")) {
        json_t* rows = json_array();
        for (int k = 0; k < sweep->point_count; k++) {
            (void)json_array_append(rows, sweep->points[k].row);
        }
        return ruga_print_json(json_pack("{s:s, s:s, s:i, s:i, s:i, s:i, s:o}", "csv", csv, "hdf5", hdf5,
                                         "minimum", count.minimum, "not_minimum", count.not_minimum, "failed",
                                         count.failed, "not_run", count.waiting, "points", rows));
    }
    ruga_say(arguments,
             "%d points: %d in minima, %d with a frame that is none, %d failed, %d not run to the end\n",
             sweep->point_count, count.minimum, count.not_minimum, count.failed, count.waiting);
    ruga_say(arguments, "table: %s and %s\n", csv, hdf5);
    return RUGA_OK;
}

static ruga_status run_sweep(const ruga_arguments* arguments, ruga_sweep* sweep, int jobs, int* exit_status) {
    char csv[PATH_LENGTH], hdf5[PATH_LENGTH];
    int complete;
    RUGA_TRY(make_folders(sweep->directory));
    RUGA_TRY(ruga_sweep_find_complete(sweep, &complete));
    say_plan(arguments, sweep, complete, jobs);
    ruga_interrupt_catch();
    ruga_meter meter = ruga_meter_start(ruga_given(arguments, "--quiet"), sweep->point_count - complete);
    meter.frame = 1;
    ruga_status status = ruga_sweep_run(sweep, jobs, &meter);
    ruga_meter_erase(&meter);
    if (status != RUGA_OK && status != RUGA_CANCELLED) {
        return status;
    }
    RUGA_TRY(write_tables(sweep, csv, hdf5));
    RUGA_TRY(tell(arguments, sweep, csv, hdf5));
    count_of count = count_points(sweep);
    *exit_status = count.not_minimum + count.failed > 0 ? RUGA_EXIT_NOT_CONVERGED : RUGA_EXIT_DONE;
    if (status == RUGA_CANCELLED) {
        (void)fprintf(stderr, "ruga: stopped; the same command goes on after the last whole frames\n");
        *exit_status = RUGA_EXIT_INTERRUPTED;
    }
    return RUGA_OK;
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    const char* directory;
    int count, jobs = (int)sysconf(_SC_NPROCESSORS_ONLN);
    ruga_sweep sweep;
    RUGA_TRY(ruga_required(arguments, "--output", &directory));
    RUGA_TRY(ruga_integer(arguments, "--jobs", 1, JOBS_MAX, &jobs));
    RUGA_TRY(ruga_check_input(ruga_operand(arguments)));
    const char* const* sets = ruga_values(arguments, "--set", &count);
    RUGA_TRY(ruga_sweep_read(ruga_operand(arguments), directory, count, sets, &sweep));
    ruga_status status = run_sweep(arguments, &sweep, jobs > 0 ? jobs : 1, exit_status);
    ruga_sweep_clear(&sweep);
    return status;
}

const ruga_command ruga_sweep_command = {
    .name = "sweep",
    .operand = "SCENE",
    .usage = "--set KEY=[A,B,..] [--set ..] -o DIR [--jobs N] [--json]",
    .summary = "run a grid of scenes and make one table of their wrinkles",
    .about =
        "Each point of the grid is run on one thread of its own and goes to DIR/points. DIR/sweep.csv and\n"
        "DIR/sweep.h5 have a row for each point: the values set, in SI and as given, all that ruga measure "
        "says\n"
        "of the last frame, the time its frames took, the exit status of its run, and the sentence where it\n"
        "failed. Points that are complete are not run again, those that were stopped go on. Ctrl-C stops at\n"
        "whole frames. Exit status 1 where a point failed or has a frame that is no minimum; bad input in "
        "any\n"
        "point is found before the first one is run.",
    .example = "    ruga sweep sheet.yaml --set skin.young=\"[10 MPa, 40 MPa]\" --set skin.thickness=\"[1 "
               "mm, 2 mm]\" -o map",
    .options = options,
    .run = run,
};
