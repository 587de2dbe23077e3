// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The time left is that of the last few frames, times the frames that are left.
#define _POSIX_C_SOURCE 200809L
#include "app/meter.h"

#include "app/console.h"
#include "core/progress.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

enum { BAR_WIDTH = 24 };
static const double redraw_interval = 0.1; // s

const char* ruga_outcome_name(ruga_outcome outcome) {
    return outcome == RUGA_OUTCOME_MINIMUM  ? "minimum"
           : outcome == RUGA_OUTCOME_SADDLE ? "saddle"
           : outcome == RUGA_OUTCOME_MOTION ? "in motion"
                                            : "not converged";
}

ruga_meter ruga_meter_start(bool quiet, int frames) {
    return (ruga_meter){.quiet = quiet, .terminal = isatty(STDERR_FILENO) == 1, .frames = frames};
}

// Seconds until the last frame; negative where nothing is known yet.
static double time_left(const ruga_meter* meter, int frames_left) {
    int count = meter->recent_count < RUGA_METER_RECENT ? meter->recent_count : RUGA_METER_RECENT;
    double sum = 0;
    for (int i = 0; i < count; i++) {
        sum += meter->recent[i];
    }
    return count > 0 ? sum / count * frames_left : -1;
}

void ruga_meter_stage(ruga_meter* meter, const char* stage, double done) {
    double now = ruga_clock(), left = time_left(meter, meter->frames - meter->frame + 1);
    if (meter->quiet || !meter->terminal || now - meter->drawn < redraw_interval) {
        return;
    }
    char bar[BAR_WIDTH + 1], duration[32] = "";
    double part = meter->frames > 0 ? (meter->frame > 0 ? meter->frame - 1 + done : 0) / meter->frames : 0;
    for (int i = 0; i < BAR_WIDTH; i++) {
        bar[i] = i < part * BAR_WIDTH ? '#' : '.';
    }
    bar[BAR_WIDTH] = '\0';
    if (left >= 0) {
        ruga_duration(left, duration);
    }
    (void)fprintf(stderr, "\r\033[K[%s] %d/%d  %s%s%s%s", bar, meter->frame, meter->frames, stage,
                  meter->last, left >= 0 ? "  left " : "", duration);
    (void)fflush(stderr);
    meter->drawn = now;
}

void ruga_meter_frame(ruga_meter* meter, double time, const ruga_report* report) {
    char left[32] = "";
    if (meter->frame > 0) {
        meter->recent[meter->recent_count++ % RUGA_METER_RECENT] = report->seconds_total;
    }
    (void)snprintf(meter->last, sizeof meter->last, "  last: %s, %d steps",
                   ruga_outcome_name(report->outcome), report->newton_iterations);
    if (meter->quiet || meter->terminal) {
        return;
    }
    double seconds = time_left(meter, meter->frames - meter->frame);
    ruga_duration(seconds > 0 ? seconds : 0, left);
    (void)fprintf(stderr, "frame %d/%d  t %.4g s  %s  %d iterations  %.2f s", meter->frame, meter->frames,
                  time, ruga_outcome_name(report->outcome), report->newton_iterations, report->seconds_total);
    if (report->substeps > 1) {
        (void)fprintf(stderr, "  %d substeps", report->substeps);
    }
    (void)fprintf(stderr, meter->recent_count > 0 ? "  left %s\n" : "\n", left);
}

void ruga_meter_point(ruga_meter* meter, double seconds, const char* text) {
    char left[32];
    meter->recent[meter->recent_count++ % RUGA_METER_RECENT] = seconds;
    ruga_duration(fmax(time_left(meter, meter->frames - meter->frame), 0), left);
    if (!meter->quiet && !meter->terminal) {
        (void)fprintf(stderr, "%d/%d  %s  left %s\n", meter->frame, meter->frames, text, left);
    }
    meter->frame++;
}

void ruga_meter_erase(ruga_meter* meter) {
    if (!meter->quiet && meter->terminal) {
        (void)fputs("\r\033[K", stderr);
        (void)fflush(stderr);
    }
}
