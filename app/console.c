// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L
#include "app/console.h"

#include "core/memory.h"
#include "io/mesh_file.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// ---- saying --------------------------------------------------------------------------------------------

void ruga_say(const ruga_arguments* arguments, const char* format, ...) {
    if (ruga_given(arguments, "--quiet")) {
        return;
    }
    va_list list;
    va_start(list, format);
    (void)vprintf(format, list);
    va_end(list);
}

void ruga_warn(const ruga_arguments* arguments, const char* format, ...) {
    if (ruga_given(arguments, "--quiet")) {
        return;
    }
    va_list list;
    va_start(list, format);
    (void)fputs("ruga: warning: ", stderr);
    (void)vfprintf(stderr, format, list);
    (void)fputc('\n', stderr);
    va_end(list);
}

void ruga_warn_of_scene(const ruga_arguments* arguments, const ruga_scene* scene) {
    for (int i = 0; i < scene->warning_count; i++) {
        ruga_warn(arguments, "%s", scene->warning[i]);
    }
}

void ruga_judge_handles(const ruga_model* model, char* sentence, size_t size) {
    const double few = 3;
    int pair[2];
    double cells = ruga_rows_nearest(&model->rows, &model->lattice, model->handles, pair);
    sentence[0] = '\0';
    if (cells < few) {
        (void)snprintf(
            sentence, size,
            "handles.%d and handles.%d move differently within %.2g cells of one another, where the "
            "lattice has no room to follow both: slow, and stiff; lattice.cells: %d or more would "
            "give it",
            pair[0], pair[1], cells, (int)ceil(model->lattice_def.cells * few / fmax(cells, 1)));
    }
}

void ruga_complain(const char* format, ...) {
    va_list list;
    va_start(list, format);
    (void)fputs("ruga: ", stderr);
    (void)vfprintf(stderr, format, list);
    (void)fputc('\n', stderr);
    va_end(list);
}

void ruga_duration(double seconds, char text[32]) {
    if (seconds < 10) {
        (void)snprintf(text, 32, "%.2g s", seconds);
    } else if (seconds < 60) {
        (void)snprintf(text, 32, "%.0f s", seconds);
    } else if (seconds < 3600) {
        (void)snprintf(text, 32, "%.0f min %.0f s", floor(seconds / 60), floor(fmod(seconds, 60)));
    } else {
        (void)snprintf(text, 32, "%.0f h %.0f min", floor(fmin(seconds / 3600, 1e9)),
                       floor(fmod(seconds / 60, 60)));
    }
}

ruga_status ruga_flush_output(void) {
    errno = 0;
    if (fflush(stdout) != 0 || ferror(stdout)) {
        return ruga_fail(RUGA_IO, "the standard output cannot be written: %s",
                         errno ? strerror(errno) : "an earlier write failed");
    }
    return RUGA_OK;
}

// ---- JSON ----------------------------------------------------------------------------------------------

ruga_status ruga_print_json(json_t* object) {
    char* text = object ? json_dumps(object, JSON_INDENT(2)) : NULL;
    json_decref(object);
    if (!text) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory while making the JSON object");
    }
    (void)puts(text);
    free(text);
    return RUGA_OK;
}

json_t* ruga_json_number(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

json_t* ruga_json_vector(const double vector[3]) {
    return json_pack("[o, o, o]", ruga_json_number(vector[0]), ruga_json_number(vector[1]),
                     ruga_json_number(vector[2]));
}

json_t* ruga_json_texts(int count, const char* const* texts) {
    json_t* list = json_array();
    for (int i = 0; i < count; i++) {
        // A text that is not UTF-8 is left out rather than making the whole object fail.
        (void)json_array_append_new(list, json_string(texts[i]));
    }
    return list;
}

// ---- files ---------------------------------------------------------------------------------------------

ruga_status ruga_check_input(const char* path) {
    struct stat info;
    if (stat(path, &info) != 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s cannot be read: %s", path, strerror(errno));
    }
    if (S_ISDIR(info.st_mode)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s is a folder; a file is needed here", path);
    }
    if (access(path, R_OK) != 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s cannot be read: %s", path, strerror(errno));
    }
    return RUGA_OK;
}

static ruga_status check_folder(const char* path, const char* folder) {
    struct stat info;
    if (stat(folder, &info) != 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s cannot be written, its folder %s is not there: %s", path, folder,
                         strerror(errno));
    }
    if (!S_ISDIR(info.st_mode)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s cannot be written, %s is not a folder", path, folder);
    }
    if (access(folder, W_OK | X_OK) != 0) {
        return ruga_fail(RUGA_IO, "%s cannot be written, its folder %s: %s", path, folder, strerror(errno));
    }
    return RUGA_OK;
}

ruga_status ruga_check_output(const char* path) {
    struct stat info;
    const char* slash = strrchr(path, '/');
    if ((stat(path, &info) == 0 && S_ISDIR(info.st_mode)) || (slash && !slash[1])) {
        return ruga_fail(RUGA_BAD_INPUT, "%s is a folder; give the name of a file in it", path);
    }
    if (!slash) {
        return check_folder(path, ".");
    }
    char* folder = ruga_copy_string(path);
    if (!folder) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory");
    }
    folder[slash == path ? 1 : slash - path] = '\0';
    ruga_status status = check_folder(path, folder);
    ruga_release(folder);
    return status;
}

ruga_status ruga_make_folder(const char* path) {
    struct stat info;
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return ruga_fail(errno == EACCES || errno == ENOSPC || errno == EROFS ? RUGA_IO : RUGA_BAD_INPUT,
                         "%s cannot be made: %s", path, strerror(errno));
    }
    if (stat(path, &info) != 0 || !S_ISDIR(info.st_mode)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s is a file; a folder is needed here", path);
    }
    return RUGA_OK;
}

ruga_status ruga_check_mesh_output(const char* path) {
    const char* dot = strrchr(path, '.');
    if (!dot || (strcmp(dot, ".obj") != 0 && strcmp(dot, ".ply") != 0)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: meshes are written as .obj or .ply; end the name in one of them", path);
    }
    return ruga_check_output(path);
}

ruga_status ruga_read_surface(const char* path, int group_count, const char* const* groups, ruga_mesh* mesh) {
    ruga_mesh whole = {0};
    RUGA_TRY(ruga_check_input(path));
    RUGA_TRY(ruga_mesh_read(path, &whole));
    if (group_count == 0) {
        *mesh = whole;
        return RUGA_OK;
    }
    ruga_status status = ruga_mesh_extract_groups(&whole, group_count, groups, mesh);
    ruga_mesh_clear(&whole);
    return status == RUGA_OK ? status : ruga_fail_prefix(status, "%s", path);
}

void ruga_say_surface(const ruga_arguments* arguments, const char* path, const ruga_mesh* mesh) {
    ruga_say(arguments, "%s: %d vertices, %d triangles, mean edge %.4g\n", path, mesh->vertex_count,
             mesh->triangle_count, ruga_mesh_mean_edge(mesh));
}
