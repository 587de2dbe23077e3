// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What `ruga measure` says of a frame of a result; docs/measure.md defines it.
#ifndef RUGA_APP_MEASUREMENT_H
#define RUGA_APP_MEASUREMENT_H

#include "app/measure.h"
#include "io/result.h"

#include <jansson.h>

typedef struct ruga_measurement {
    int frame;
    double time, predicted;
    bool tied; // there is an interior, so that a wrinkle is a distance from it
    ruga_measured values;
    ruga_report report;
} ruga_measurement;

ruga_status ruga_measurement_take(ruga_result_reader* reader, int frame, ruga_measurement* m);
// NULL where memory is out. What has no meaning is null.
json_t* ruga_measurement_json(const ruga_measurement* m);

#endif
