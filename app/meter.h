// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// How far a run has come: a bar rewritten in place on a terminal, one line per frame otherwise; on stderr.
#ifndef RUGA_APP_METER_H
#define RUGA_APP_METER_H

#include "ruga/types.h"

enum { RUGA_METER_RECENT = 8 };

typedef struct ruga_meter {
    bool quiet, terminal;
    int frame, frames; // being computed, and the last one
    double recent[RUGA_METER_RECENT];
    int recent_count; // of all frames timed so far
    double drawn;     // when the bar was last drawn, s
    char last[48];    // of the last frame: outcome and Newton steps
} ruga_meter;

ruga_meter ruga_meter_start(bool quiet, int frames);
// A stage of the work on meter->frame, done in [0, 1].
void ruga_meter_stage(ruga_meter* meter, const char* stage, double done);
// The frame is written.
void ruga_meter_frame(ruga_meter* meter, double time, const ruga_report* report);
// The same for work that is not a frame: what it was, and the seconds that it took of the whole.
void ruga_meter_point(ruga_meter* meter, double seconds, const char* text);
// Takes the bar away, so that something else can be printed.
void ruga_meter_erase(ruga_meter* meter);

const char* ruga_outcome_name(ruga_outcome outcome);

#endif
