// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Pictures to a film, by the program ffmpeg, which need not be there.
#ifndef RUGA_VIEW_MOVIE_H
#define RUGA_VIEW_MOVIE_H

#include "view/render.h"

typedef struct ruga_movie ruga_movie;

// H.264 in MP4, `rate` pictures a second. RUGA_BAD_INPUT where ffmpeg is not installed or the path does not
// end in .mp4.
ruga_status ruga_movie_open(const char* path, int width, int height, double rate, ruga_movie** movie);
ruga_status ruga_movie_add(ruga_movie* movie, const ruga_picture* picture);
// With RUGA_OK puts the film in its place, whole or not at all; otherwise returns that status. Frees *movie.
ruga_status ruga_movie_close(ruga_movie** movie, ruga_status status);

#endif
