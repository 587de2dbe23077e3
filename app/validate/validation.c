// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/validation.h"

#include "app/console.h"
#include "core/memory.h"
#include "core/progress.h"
#include "io/writer.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

struct ruga_validation {
    const ruga_validation_settings* settings;
    const ruga_validation_case* running;
    json_t *lines, *notes, *files;
    int failed;
    bool skipped;
    double begin;
};

bool ruga_validation_is_quick(const ruga_validation* v) {
    return v->settings->quick;
}

// ---- lines ---------------------------------------------------------------------------------------------

static void add_line(ruga_validation* v, const char* quantity, const char* kind, double ours, double reference,
                     double tolerance, bool judged, bool good, const char* source) {
    const char* verdict = !judged ? "recorded" : good ? "pass" : "FAIL";
    json_t* line = json_pack("{s:s, s:s, s:o, s:o, s:o, s:s, s:s}", "quantity", quantity, "kind", kind, "ours",
                             ruga_json_number(ours), "reference", ruga_json_number(reference), "tolerance",
                             ruga_json_number(tolerance), "source", source ? source : "", "verdict", verdict);
    (void)json_array_append_new(v->lines, line);
    v->failed += judged && !good;
    if (!v->settings->quiet) {
        char against[32] = "";
        if (isfinite(reference)) {
            (void)snprintf(against, sizeof against, "%.5g", reference);
        }
        (void)fprintf(stderr, "  %-72s %12.5g %12s  %s\n", quantity, ours, against, verdict);
    }
}

void ruga_validation_near(ruga_validation* v, const char* quantity, double ours, double reference,
                          double tolerance, const char* source) {
    add_line(v, quantity, "near", ours, reference, tolerance, true,
             fabs(ours - reference) <= tolerance * fabs(reference), source);
}

void ruga_validation_below(ruga_validation* v, const char* quantity, double ours, double limit,
                           const char* source) {
    add_line(v, quantity, "below", ours, limit, NAN, true, ours <= limit, source);
}

void ruga_validation_above(ruga_validation* v, const char* quantity, double ours, double limit,
                           const char* source) {
    add_line(v, quantity, "above", ours, limit, NAN, true, ours >= limit, source);
}

void ruga_validation_record(ruga_validation* v, const char* quantity, double ours, double reference,
                            const char* source) {
    add_line(v, quantity, "record", ours, reference, NAN, false, true, source);
}

// ---- notes and files -----------------------------------------------------------------------------------

static void add_note(ruga_validation* v, const char* format, va_list arguments) {
    (void)json_array_append_new(v->notes, json_vsprintf(format, arguments));
}

void ruga_validation_note(ruga_validation* v, const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    add_note(v, format, arguments);
    va_end(arguments);
}

void ruga_validation_skip(ruga_validation* v, const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    add_note(v, format, arguments);
    va_end(arguments);
    v->skipped = true;
}

void ruga_validation_file(ruga_validation* v, const char* suffix, const char* caption,
                          char path[RUGA_VALIDATION_PATH]) {
    json_t* name = json_sprintf("validation/%s-%s", v->running->name, suffix);
    (void)snprintf(path, RUGA_VALIDATION_PATH, "%s/%s", v->settings->directory, json_string_value(name));
    (void)json_array_append_new(v->files, json_pack("{s:o, s:s}", "path", name, "caption", caption));
}

static ruga_status make_directory(const char* path) {
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return ruga_fail(RUGA_IO, "%s: cannot be made: %s", path, strerror(errno));
    }
    return RUGA_OK;
}

ruga_status ruga_validation_work(ruga_validation* v, char path[RUGA_VALIDATION_PATH]) {
    (void)snprintf(path, RUGA_VALIDATION_PATH, "%s/validation/work", v->settings->directory);
    RUGA_TRY(make_directory(path));
    (void)snprintf(path, RUGA_VALIDATION_PATH, "%s/validation/work/%s", v->settings->directory, v->running->name);
    return make_directory(path);
}

// ---- a run ---------------------------------------------------------------------------------------------

static ruga_status write_case(const ruga_validation* v, const ruga_validation_case* c) {
    char path[RUGA_VALIDATION_PATH], date[32];
    time_t now = time(NULL);
    struct tm day;
    (void)strftime(date, sizeof date, "%Y-%m-%d", gmtime_r(&now, &day));
    (void)snprintf(path, sizeof path, "%s/validation/%s.json", v->settings->directory, c->name);
    const char* verdict = v->failed ? "FAIL" : v->skipped ? "skipped" : "pass";
    json_t* object = json_pack("{s:s, s:b, s:s, s:s, s:i, s:o, s:O, s:O, s:O}", "case", c->name, "quick",
                               v->settings->quick, "date", date, "verdict", verdict, "failed", v->failed, "seconds",
                               json_real(ruga_clock() - v->begin), "lines", v->lines, "notes", v->notes, "files",
                               v->files);
    ruga_writer writer;
    ruga_status status = object ? ruga_writer_open(path, &writer) : ruga_fail(RUGA_NO_MEMORY, "out of memory");
    if (status == RUGA_OK) {
        (void)json_dumpf(object, writer.file, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
        (void)fputc('\n', writer.file);
        status = ruga_writer_close(&writer, RUGA_OK);
    }
    json_decref(object);
    return status;
}

ruga_status ruga_validation_run(const ruga_validation_settings* settings, const ruga_validation_case* c,
                                int* failed) {
    char path[RUGA_VALIDATION_PATH];
    (void)snprintf(path, sizeof path, "%s/validation", settings->directory);
    RUGA_TRY(make_directory(path));
    ruga_validation v = {.settings = settings,
                         .running = c,
                         .lines = json_array(),
                         .notes = json_array(),
                         .files = json_array(),
                         .begin = ruga_clock()};
    if (!settings->quiet) {
        (void)fprintf(stderr, "%s: %s\n", c->name, c->title);
    }
    ruga_status status = c->run(&v);
    if (status != RUGA_OK && status != RUGA_CANCELLED) {
        ruga_validation_note(&v, "The case ended early: %s", ruga_last_error());
        add_line(&v, "the case runs to its end", "near", 0, 1, 0, true, false, "");
        status = RUGA_OK;
    }
    *failed = v.failed;
    if (status == RUGA_OK) {
        status = write_case(&v, c);
    }
    json_decref(v.lines);
    json_decref(v.notes);
    json_decref(v.files);
    return status;
}
