// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/cases.h"
#include "app/validate/shell_benchmarks.h"

#include <math.h>
#include <stdio.h>

enum { LEVELS = 3, FINEST = 40 };

// One benchmark on one mesh: states its lines.
static ruga_status measure(ruga_validation* v, const shell_benchmark* b, const shell_run* run, FILE* table) {
    double value[SHELL_VALUES] = {0};
    int bad = 0;
    RUGA_TRY(b->run(run, value, &bad));
    const char* mesh = run->irregular ? "irregular" : "regular";
    for (int i = 0; i < b->value_count; i++) {
        char name[160];
        (void)snprintf(name, sizeof name, "%s, %s %d: %s", b->name, mesh, run->level, b->quantity[i]);
        (void)fprintf(table, "%s,%s,%s,%d,%.9g,%.9g,%d\n", b->name, b->quantity[i], mesh, run->level, value[i],
                      b->reference[i], bad);
        ruga_validation_record(v, name, value[i], b->reference[i], b->source);
    }
    if (bad) {
        ruga_validation_note(v, "%s, %s %d: %d frames did not end in a minimum.", b->name, mesh, run->level, bad);
    }
    return RUGA_OK;
}

static ruga_status run(ruga_validation* v) {
    char path[RUGA_VALIDATION_PATH];
    ruga_validation_file(v, "convergence.csv", "All values at all resolutions", path);
    FILE* table = fopen(path, "w");
    if (!table) {
        return ruga_fail(RUGA_IO, "%s could not be opened for writing", path);
    }
    (void)fprintf(table, "benchmark,quantity,mesh,level,ours,reference,frames not in a minimum\n");
    ruga_status status = RUGA_OK;
    for (int k = 0; k < shell_benchmark_count && status == RUGA_OK; k++) {
        for (int i = 0; i < 2 * LEVELS && status == RUGA_OK; i++) {
            shell_run run = {.level = FINEST >> (LEVELS - 1 - i / 2), .irregular = i % 2};
            status = measure(v, &shell_benchmarks[k], &run, table);
        }
    }
    (void)fclose(table);
    return status;
}

const ruga_validation_case ruga_validate_shell = {
    .name = "shell",
    .title = "The shell alone against classical benchmarks",
    .about = "Strips and shells of textbooks, on regular and on irregular meshes.",
    .run = run,
};
