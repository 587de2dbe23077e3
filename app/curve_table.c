// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/curve_table.h"

#include "app/console.h"
#include "app/meter.h"
#include "core/memory.h"
#include "io/writer.h"

#include <math.h>

typedef struct table {
    ruga_result_reader* reader;
    int handles;
    double *position, *force;
} table;

static void write_head(ruga_writer* w, int handles) {
    (void)fputs("frame,time,size_x,size_y,size_z", w->file);
    for (int h = 0; h < handles; h++) {
        (void)fprintf(w->file, ",force_%d_x,force_%d_y,force_%d_z", h, h, h);
    }
    (void)fputs(",energy_membrane,energy_bending,energy_hinge,energy_external,outcome\n", w->file);
}

static void write_number(ruga_writer* w, double value) {
    (void)(isfinite(value) ? fprintf(w->file, ",%.9g", value) : fputs(",", w->file));
}

static ruga_status write_row(ruga_writer* w, table* t, int frame) {
    double time;
    ruga_report report;
    RUGA_TRY(ruga_result_read_frame(t->reader, frame, &time, t->position, NULL, &report));
    RUGA_TRY(ruga_result_read_handle_force(t->reader, frame, t->force));
    (void)fprintf(w->file, "%d", frame);
    write_number(w, time);
    for (int i = 0; i < 3; i++) {
        double low = INFINITY, high = -INFINITY;
        for (int v = 0; v < ruga_result_mesh(t->reader)->vertex_count; v++) {
            low = fmin(low, t->position[3 * (size_t)v + (size_t)i]);
            high = fmax(high, t->position[3 * (size_t)v + (size_t)i]);
        }
        write_number(w, high - low);
    }
    for (int i = 0; i < 3 * t->handles; i++) {
        write_number(w, t->force[i]);
    }
    write_number(w, report.energy_membrane);
    write_number(w, report.energy_bending);
    write_number(w, report.energy_hinge);
    write_number(w, report.energy_external);
    (void)fprintf(w->file, ",%s\n", ruga_outcome_name(report.outcome));
    return RUGA_OK;
}

ruga_status ruga_curve_table_write(const ruga_arguments* arguments, ruga_result_reader* reader,
                                   const char* path) {
    ruga_status status = RUGA_OK;
    ruga_writer w;
    table t = {.reader = reader, .handles = ruga_result_reader_header(reader)->handle_count};
    RUGA_TRY(ruga_check_output(path));
    RUGA_TRY_DONE(RUGA_NEW(t.position, 3 * (size_t)ruga_result_mesh(reader)->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(t.force, 3 * (size_t)t.handles));
    RUGA_TRY_DONE(ruga_writer_open(path, &w));
    write_head(&w, t.handles);
    for (int frame = 0; status == RUGA_OK && frame < ruga_result_frame_count(reader); frame++) {
        status = write_row(&w, &t, frame);
    }
    status = ruga_writer_close(&w, status);
    if (status == RUGA_OK) {
        ruga_say(arguments, "%s: %d frames\n", path, ruga_result_frame_count(reader));
    }
done:
    ruga_release(t.position);
    ruga_release(t.force);
    return status;
}
