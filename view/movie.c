// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L
#include "view/movie.h"

#include "core/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

struct ruga_movie {
    const char* path;
    char temporary[4096];
    pid_t process;
    int pipe;
    void (*old_handler)(int);
};

// An odd number of pixels gets one more row or column, which H.264 wants.
static ruga_status start(ruga_movie* m, int width, int height, double rate, int input) {
    char size[48], frames[32];
    (void)snprintf(size, sizeof size, "%dx%d", width, height);
    (void)snprintf(frames, sizeof frames, "%.6g", rate);
    const char* words[] = {"ffmpeg",
                           "-loglevel",
                           "error",
                           "-y",
                           "-f",
                           "rawvideo",
                           "-pix_fmt",
                           "rgb24",
                           "-s",
                           size,
                           "-r",
                           frames,
                           "-i",
                           "-",
                           "-an",
                           "-vf",
                           "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                           "-c:v",
                           "libx264",
                           "-pix_fmt",
                           "yuv420p",
                           "-crf",
                           "18",
                           "-movflags",
                           "+faststart",
                           "-f",
                           "mp4",
                           m->temporary,
                           NULL};
    posix_spawn_file_actions_t actions;
    if (posix_spawn_file_actions_init(&actions) != 0) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: a process");
    }
    (void)posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    (void)posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    int error = posix_spawnp(&m->process, "ffmpeg", &actions, NULL, (char* const*)words, environ);
    (void)posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
        m->process = 0;
        return ruga_fail(
            RUGA_BAD_INPUT,
            "films need the program ffmpeg, which cannot be started (%s): install it (Debian: apt install "
            "ffmpeg), or write single pictures",
            strerror(error));
    }
    return RUGA_OK;
}

static ruga_status open_pipe(ruga_movie* m, int width, int height, double rate) {
    int ends[2];
    if (pipe(ends) != 0) {
        return ruga_fail(RUGA_IO, "no pipe to ffmpeg: %s", strerror(errno));
    }
    (void)fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    m->pipe = ends[1];
    ruga_status status = start(m, width, height, rate, ends[0]);
    (void)close(ends[0]);
    return status;
}

ruga_status ruga_movie_open(const char* path, int width, int height, double rate, ruga_movie** movie) {
    const char* dot = strrchr(path, '.');
    *movie = NULL;
    if (!dot || strcmp(dot, ".mp4") != 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: films are written as .mp4; end the name in it", path);
    }
    RUGA_TRY(RUGA_NEW_ZERO(*movie, 1));
    ruga_movie* m = *movie;
    m->path = path;
    m->pipe = -1;
    // ffmpeg that ends early shall be an error of the next write, not the end of this program.
    m->old_handler = signal(SIGPIPE, SIG_IGN);
    ruga_status status = RUGA_OK;
    if (snprintf(m->temporary, sizeof m->temporary, "%s.part", path) >= (int)sizeof m->temporary) {
        status = ruga_fail(RUGA_BAD_INPUT, "the path of the film is too long");
    }
    if (status == RUGA_OK) {
        status = open_pipe(m, width, height, rate);
    }
    return status == RUGA_OK ? status : ruga_movie_close(movie, status);
}

ruga_status ruga_movie_add(ruga_movie* movie, const ruga_picture* picture) {
    size_t left = 3 * (size_t)picture->width * (size_t)picture->height;
    for (const unsigned char* at = picture->pixel; left > 0;) {
        ssize_t written = write(movie->pipe, at, left);
        if (written < 0 && errno != EINTR) {
            return ruga_fail(RUGA_IO, "%s: ffmpeg took no more pictures: %s", movie->path, strerror(errno));
        }
        at += written > 0 ? written : 0;
        left -= written > 0 ? (size_t)written : 0;
    }
    return RUGA_OK;
}

ruga_status ruga_movie_close(ruga_movie** movie, ruga_status status) {
    ruga_movie* m = *movie;
    int result = 0;
    if (!m) {
        return status;
    }
    if (m->pipe >= 0) {
        (void)close(m->pipe);
    }
    while (m->process > 0 && waitpid(m->process, &result, 0) < 0 && errno == EINTR) {
    }
    if (status == RUGA_OK && !(WIFEXITED(result) && WEXITSTATUS(result) == 0)) {
        status = ruga_fail(RUGA_LIBRARY, "%s: ffmpeg failed; what it said stands above", m->path);
    }
    if (status == RUGA_OK && rename(m->temporary, m->path) != 0) {
        status = ruga_fail(RUGA_IO, "%s could not be written: %s", m->path, strerror(errno));
    }
    if (status != RUGA_OK) {
        (void)remove(m->temporary);
    }
    (void)signal(SIGPIPE, m->old_handler);
    ruga_release(m);
    *movie = NULL;
    return status;
}
