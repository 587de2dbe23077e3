// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The processes of a sweep. Each is this same program's `run --resume --threads 1`, in a process group of its
// own: Ctrl-C on the terminal reaches the sweep alone, which passes it on once, so that each run ends at a
// whole frame (two would end it at once). Where the sweep is killed, the kernel tells its runs the same.
#define _POSIX_C_SOURCE 200809L
#include "app/sweep.h"

#include "app/command.h"
#include "app/interrupt.h"
#include "app/measurement.h"
#include "core/memory.h"
#include "core/progress.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { SENTENCE = 2048, STATUS_EXEC = 127, EXIT_UNKNOWN = -1 };

// ---- results -------------------------------------------------------------------------------------------

// json_object_set_new with a value that may be out of memory: the table then lacks it.
static void set_value(json_t* row, const char* key, json_t* value) {
    (void)json_object_set_new(row, key, value);
}

// The numbers and texts of `ruga measure --json`; those of an object within under object_key.
static void add_scalars(json_t* row, const char* prefix, json_t* object) {
    const char* key;
    json_t* value;
    json_object_foreach(object, key, value) {
        char name[128];
        (void)snprintf(name, sizeof name, "%s%s%s", prefix, *prefix ? "_" : "", key);
        if (json_is_object(value)) {
            add_scalars(row, name, value);
        } else if (!json_is_array(value)) {
            (void)json_object_set(row, name, value);
        }
    }
}

// Where the result is whole and of this scene: its measured quantities, the time that its frames took, and
// the status that its run ended or would have ended with.
static ruga_status read_result(ruga_sweep_point* point, bool* complete) {
    ruga_status status = RUGA_OK;
    ruga_result_reader* reader = NULL;
    ruga_measurement m = {0};
    double seconds = 0;
    int frames, bad = 0;
    *complete = false;
    RUGA_TRY(ruga_result_open(point->result, &reader));
    const ruga_result_header* header = ruga_result_reader_header(reader);
    frames = ruga_result_frame_count(reader);
    if (header->scene_hash != point->scene_hash || header->mesh_hash != point->mesh_hash ||
        frames <= point->frames) {
        goto done;
    }
    for (int k = 0; k < frames; k++) {
        ruga_report report;
        RUGA_TRY_DONE(ruga_result_read_frame(reader, k, NULL, NULL, NULL, &report));
        seconds += report.seconds_total;
        bad += report.outcome == RUGA_OUTCOME_SADDLE || report.outcome == RUGA_OUTCOME_NOT_CONVERGED;
    }
    RUGA_TRY_DONE(ruga_measurement_take(reader, frames - 1, &m));
    json_t* measured = ruga_measurement_json(&m);
    add_scalars(point->row, "", measured);
    json_decref(measured);
    // Below 8 the wrinkles are too long, which `run` would warn of.
    double edge = ruga_mesh_mean_edge(ruga_result_mesh(reader));
    set_value(point->row, "edges_per_wavelength",
              m.predicted > 0 ? json_real(m.predicted / edge) : json_null());
    set_value(point->row, "frames_not_minimum", json_integer(bad));
    set_value(point->row, "seconds", json_real(seconds));
    point->exit_status = bad > 0 ? RUGA_EXIT_NOT_CONVERGED : RUGA_EXIT_DONE;
    *complete = true;
done:
    ruga_measurement_clear(&m);
    ruga_result_reader_close(&reader);
    return status;
}

// The last sentence that the process complained with.
static void read_sentence(const ruga_sweep_point* point, char sentence[SENTENCE]) {
    static const char prefix[] = "ruga: ";
    char line[SENTENCE];
    FILE* file = fopen(point->log, "r");
    (void)snprintf(sentence, SENTENCE, "its process ended without a word");
    while (file && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = '\0';
        if (line[0]) {
            bool own = strncmp(line, prefix, sizeof prefix - 1) == 0;
            (void)snprintf(sentence, SENTENCE, "%s", own ? line + sizeof prefix - 1 : line);
        }
    }
    if (file) {
        (void)fclose(file);
    }
}

static void set_end(ruga_sweep_point* point, const char* error) {
    set_value(point->row, "status", point->exit_status >= 0 ? json_integer(point->exit_status) : json_null());
    set_value(point->row, "error", json_string(error));
    set_value(point->row, "result", json_string(point->file));
}

ruga_status ruga_sweep_measure(ruga_sweep_point* point) {
    char sentence[SENTENCE] = "";
    bool complete = false;
    int ended_with = point->exit_status;
    if (point->state == RUGA_SWEEP_WAITS) {
        set_end(point, "not run to its end yet");
        return RUGA_OK;
    }
    if (ended_with == RUGA_EXIT_DONE || ended_with == RUGA_EXIT_NOT_CONVERGED) {
        ruga_status status = read_result(point, &complete);
        if (status == RUGA_NO_MEMORY) {
            return status;
        }
        (void)snprintf(sentence, sizeof sentence, "%s",
                       complete            ? ""
                       : status == RUGA_OK ? "its result is not complete"
                                           : ruga_last_error());
        point->exit_status = complete ? point->exit_status : RUGA_EXIT_FAILURE;
    } else {
        read_sentence(point, sentence);
    }
    set_end(point, sentence);
    return RUGA_OK;
}

ruga_status ruga_sweep_find_complete(ruga_sweep* sweep, int* complete) {
    *complete = 0;
    for (int k = 0; k < sweep->point_count; k++) {
        ruga_sweep_point* point = &sweep->points[k];
        bool whole = false;
        if (access(point->result, R_OK) != 0) {
            continue;
        }
        // A file that cannot be read is none: its run says what is wrong with it.
        if (read_result(point, &whole) == RUGA_NO_MEMORY) {
            return ruga_fail(RUGA_NO_MEMORY, "out of memory while reading %s", point->result);
        }
        if (whole) {
            set_end(point, "");
            point->state = RUGA_SWEEP_DONE;
            ++*complete;
        }
    }
    return RUGA_OK;
}

// ---- processes -----------------------------------------------------------------------------------------

// RESULT that is of another scene or mesh, such as an edited OBJ file, is no one's any more.
static bool is_stale(const ruga_sweep_point* point) {
    ruga_result_reader* reader = NULL;
    if (access(point->result, F_OK) != 0) {
        return false;
    }
    bool stale = ruga_result_open(point->result, &reader) != RUGA_OK;
    if (reader) {
        const ruga_result_header* header = ruga_result_reader_header(reader);
        stale = header->scene_hash != point->scene_hash || header->mesh_hash != point->mesh_hash;
        ruga_result_reader_close(&reader);
    }
    return stale;
}

// Between fork and exec: only what is safe there. SIGINT is blocked until nothing of the sweep's own handling
// is left, which would only make a note of it.
static void become_run(char* const* words, int log, const sigset_t* interrupt) {
    int null = open("/dev/null", O_RDWR);
    (void)setpgid(0, 0);
    (void)prctl(PR_SET_PDEATHSIG, SIGINT);
    (void)dup2(null, STDIN_FILENO);
    (void)dup2(null, STDOUT_FILENO);
    (void)dup2(log, STDERR_FILENO);
    (void)signal(SIGINT, SIG_DFL);
    (void)sigprocmask(SIG_UNBLOCK, interrupt, NULL);
    (void)execv("/proc/self/exe", words);
    _exit(STATUS_EXEC);
}

static pid_t fork_run(char* const* words, int log) {
    sigset_t interrupt;
    (void)sigemptyset(&interrupt);
    (void)sigaddset(&interrupt, SIGINT);
    (void)sigprocmask(SIG_BLOCK, &interrupt, NULL);
    pid_t child = fork();
    if (child == 0) {
        become_run(words, log, &interrupt);
    }
    (void)sigprocmask(SIG_UNBLOCK, &interrupt, NULL);
    return child;
}

static ruga_status start(const ruga_sweep* sweep, ruga_sweep_point* point) {
    enum { FIXED = 10 };
    static char run[] = "run", out[] = "-o", resume[] = "--resume", force[] = "--force",
                threads[] = "--threads", one[] = "1", quiet[] = "--quiet", set[] = "--set",
                program[] = "ruga", end[] = "--";
    char** words = NULL;
    int count = 0;
    RUGA_TRY(RUGA_NEW_ZERO(words, FIXED + 2 * sweep->axis_count + 2));
    char* const head[] = {program, run, out,  point->result, is_stale(point) ? force : resume,
                          threads, one, quiet};
    for (size_t i = 0; i < sizeof head / sizeof head[0]; i++) {
        words[count++] = head[i];
    }
    for (int i = 0; i < sweep->axis_count; i++) {
        words[count++] = set;
        words[count++] = point->sets[i];
    }
    words[count++] = end;
    words[count++] = (char*)sweep->scene;
    int log = open(point->log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    pid_t child = log >= 0 ? fork_run(words, log) : -1;
    int reason = errno;
    if (log >= 0) {
        (void)close(log);
    }
    ruga_release(words);
    if (child < 0) {
        return ruga_fail(RUGA_IO, "%s: its run cannot be started: %s", point->log, strerror(reason));
    }
    (void)setpgid(child, child);
    point->process = child;
    point->begin = ruga_clock();
    point->state = RUGA_SWEEP_RUNS;
    return RUGA_OK;
}

static void tell_point(const ruga_sweep* sweep, const ruga_sweep_point* point, int jobs, ruga_meter* meter) {
    char name[256], text[1024];
    const char *error = json_string_value(json_object_get(point->row, "error")),
               *outcome = json_string_value(json_object_get(point->row, "outcome"));
    double took = ruga_clock() - point->begin;
    ruga_sweep_point_name(sweep, point, name, sizeof name);
    if (error && *error) {
        (void)snprintf(text, sizeof text, "%s: %s", name, error);
    } else {
        (void)snprintf(text, sizeof text, "%s: %s, %.3g s", name, outcome ? outcome : "?", took);
    }
    ruga_meter_point(meter, took / jobs, text);
}

// Whether the process has ended; then its point has a row.
static ruga_status look_after(ruga_sweep_point* point, bool* ended) {
    int status;
    pid_t got = waitpid((pid_t)point->process, &status, WNOHANG);
    *ended = got == point->process || (got < 0 && errno == ECHILD);
    if (!*ended) {
        return RUGA_OK;
    }
    point->exit_status = got > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : EXIT_UNKNOWN;
    bool killed = got > 0 && WIFSIGNALED(status);
    bool stopped = point->exit_status == RUGA_EXIT_INTERRUPTED || (killed && WTERMSIG(status) == SIGINT);
    point->state = stopped ? RUGA_SWEEP_WAITS : RUGA_SWEEP_DONE;
    point->exit_status = stopped ? EXIT_UNKNOWN : point->exit_status;
    if (killed && !stopped) {
        FILE* log = fopen(point->log, "a");
        if (log) {
            (void)fprintf(log, "ruga: its process was ended by signal %d\n", WTERMSIG(status));
            (void)fclose(log);
        }
    }
    RUGA_TRY(ruga_sweep_measure(point));
    if (stopped || point->exit_status == RUGA_EXIT_DONE || point->exit_status == RUGA_EXIT_NOT_CONVERGED) {
        (void)unlink(point->log);
    }
    return RUGA_OK;
}

static void pass_on_interrupt(const ruga_sweep* sweep) {
    for (int k = 0; k < sweep->point_count; k++) {
        if (sweep->points[k].state == RUGA_SWEEP_RUNS) {
            (void)kill((pid_t)sweep->points[k].process, SIGINT);
        }
    }
}

static void wait_a_little(void) {
    (void)nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
}

ruga_status ruga_sweep_run(ruga_sweep* sweep, int jobs, ruga_meter* meter) {
    ruga_status status = RUGA_OK;
    bool stopping = false;
    int running = 0, next = 0;
    do {
        while (!stopping && status == RUGA_OK && running < jobs && next < sweep->point_count) {
            ruga_sweep_point* point = &sweep->points[next++];
            if (point->state == RUGA_SWEEP_WAITS) {
                status = start(sweep, point);
                running += status == RUGA_OK;
            }
        }
        char stage[48];
        (void)snprintf(stage, sizeof stage, "%d running", running);
        ruga_meter_stage(meter, stage, 0);
        wait_a_little();
        if (!stopping && (ruga_interrupted() || status != RUGA_OK)) {
            pass_on_interrupt(sweep);
            stopping = true;
        }
        for (int k = 0; k < next; k++) {
            bool ended = false;
            if (sweep->points[k].state == RUGA_SWEEP_RUNS) {
                ruga_status looked = look_after(&sweep->points[k], &ended);
                status = status == RUGA_OK ? looked : status;
            }
            if (ended) {
                running--;
                if (sweep->points[k].state == RUGA_SWEEP_DONE) {
                    tell_point(sweep, &sweep->points[k], jobs, meter);
                }
            }
        }
    } while (running > 0 || (!stopping && status == RUGA_OK && next < sweep->point_count));
    RUGA_TRY(status);
    return ruga_interrupted() ? ruga_fail(RUGA_CANCELLED, "stopped") : RUGA_OK;
}
