// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Which frames of a result are meant, and the files that they go to.
#ifndef RUGA_APP_FRAMES_H
#define RUGA_APP_FRAMES_H

#include "app/command.h"
#include "io/result.h"

typedef struct ruga_frame_range {
    int first, last; // both included
} ruga_frame_range;

// A result to read; RUGA_BAD_INPUT where it has no frame.
ruga_status ruga_open_result(const char* path, ruga_result_reader** reader);

// --frame K or --frames A:B (one frame: --frames K). Without them: `all` or the last. RUGA_BAD_INPUT with the
// frames that exist.
ruga_status ruga_choose_frames(const ruga_arguments* arguments, int frame_count, bool all,
                               ruga_frame_range* range);

// Whether a file name holds a place for the frame's number: %d, %4d or %04d.
bool ruga_has_pattern(const char* path);
// RUGA_BAD_INPUT where a name has several places, or none for several frames.
ruga_status ruga_check_pattern(const char* path, const ruga_frame_range* range);
// The name of a frame's file, to be released by the caller.
ruga_status ruga_frame_path(const char* pattern, int frame, char** path);

#endif
