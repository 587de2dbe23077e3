// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What `ruga measure` says of a frame of a result; docs/measure.md defines it.
#ifndef RUGA_APP_MEASUREMENT_H
#define RUGA_APP_MEASUREMENT_H

#include "app/measure.h"
#include "io/result.h"

#include <jansson.h>

typedef struct ruga_measured_crease {
    const char* name; // the result's
    char assignment;
    double length;                           // m, at rest
    double angle_mean, angle_min, angle_max; // rad; the mean by length
    double hinge_energy;                     // J
    double gap;                              // m, the largest between what is sewn together along it
} ruga_measured_crease;

typedef struct ruga_measurement {
    int frame;
    double time, predicted;
    bool tied; // there is an interior, so that a wrinkle is a distance from it
    ruga_measured values;
    ruga_report report;
    int crossings; // pairs of triangles that pass through each other; -1 = not looked for
    double gap;    // m, the largest between what is sewn together
    int crease_count;
    ruga_measured_crease* crease; // [crease_count]
} ruga_measurement;

ruga_status ruga_measurement_take(ruga_result_reader* reader, int frame, ruga_measurement* m);
void ruga_measurement_clear(ruga_measurement* m);
// NULL where memory is out. What has no meaning is null.
json_t* ruga_measurement_json(const ruga_measurement* m);

#endif
