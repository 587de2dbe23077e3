// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L
#include "app/validate/peer.h"

#include "core/memory.h"
#include "core/progress.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char** environ;

bool peer_find(const char* name, char path[RUGA_VALIDATION_PATH]) {
    const char* folders = getenv("PATH");
    while (folders && *folders) {
        int length = (int)strcspn(folders, ":");
        (void)snprintf(path, RUGA_VALIDATION_PATH, "%.*s/%s", length, folders, name);
        if (length > 0 && access(path, X_OK) == 0) {
            return true;
        }
        folders += length + (folders[length] == ':');
    }
    return false;
}

// The environment with one thread for OpenMP. The strings stay those of the environment.
static ruga_status copy_environment(char*** copy) {
    static char one_thread[] = "OMP_NUM_THREADS=1";
    int count = 0, kept = 0;
    while (environ[count]) {
        count++;
    }
    RUGA_TRY(RUGA_NEW(*copy, count + 2));
    for (int i = 0; i < count; i++) {
        if (strncmp(environ[i], "OMP_NUM_THREADS=", 16) != 0) {
            (*copy)[kept++] = environ[i];
        }
    }
    (*copy)[kept++] = one_thread;
    (*copy)[kept] = NULL;
    return RUGA_OK;
}

// In the child, after fork: only calls that are safe there.
static void become(const char* path, char* const* argument, char* const* environment, const char* directory,
                   const char* log) {
    int output = chdir(directory) == 0 ? open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666) : -1;
    if (output >= 0 && dup2(output, STDOUT_FILENO) >= 0 && dup2(output, STDERR_FILENO) >= 0) {
        (void)execve(path, argument, environment);
    }
    _exit(127);
}

// Waits for the child; past the limit, or when the run is stopped, ends it.
static ruga_status wait_for(pid_t child, double limit, int* result, bool* late) {
    double begin = ruga_clock();
    ruga_status status = RUGA_OK;
    *late = false;
    for (;;) {
        pid_t ended = waitpid(child, result, WNOHANG);
        if (ended == child || (ended < 0 && errno != EINTR)) {
            return status;
        }
        if (status == RUGA_OK && !*late) {
            status = ruga_progress("peer", 0);
            *late = status == RUGA_OK && ruga_clock() - begin > limit;
            if (status != RUGA_OK || *late) {
                (void)kill(child, SIGKILL);
            }
        }
        (void)nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
}

ruga_status peer_run(const char* path, char* const* argument, const char* directory, const char* log,
                     double limit) {
    char** environment = NULL;
    bool late;
    int result = -1;
    RUGA_TRY(copy_environment(&environment));
    pid_t child = fork();
    if (child == 0) {
        become(path, argument, environment, directory, log);
    }
    ruga_release(environment);
    if (child < 0) {
        return ruga_fail(RUGA_LIBRARY, "%s: cannot be started: %s", path, strerror(errno));
    }
    RUGA_TRY(wait_for(child, limit, &result, &late));
    if (late) {
        return ruga_fail(RUGA_LIBRARY, "%s: not done after %g s; what it wrote is in %s", path, limit,
                         directory);
    }
    if (!WIFEXITED(result) || WEXITSTATUS(result) != 0) {
        return ruga_fail(RUGA_LIBRARY, "%s: ended with %s %d; what it said is in %s/%s", path,
                         WIFEXITED(result) ? "status" : "signal",
                         WIFEXITED(result) ? WEXITSTATUS(result) : WTERMSIG(result), directory, log);
    }
    return RUGA_OK;
}
