// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What the program says, and the files it is given: data to stdout, messages to stderr.
#ifndef RUGA_APP_CONSOLE_H
#define RUGA_APP_CONSOLE_H

#include "app/command.h"
#include "io/scene.h"
#include "mesh/mesh.h"
#include "solver/model.h"

#include <jansson.h>

// Data for people: to stdout, unless --quiet.
void ruga_say(const ruga_arguments* arguments, const char* format, ...) __attribute__((format(printf, 2, 3)));
// "ruga: warning: ..." to stderr, unless --quiet.
void ruga_warn(const ruga_arguments* arguments, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
// What reading the scene had to say.
void ruga_warn_of_scene(const ruga_arguments* arguments, const ruga_scene* scene);
// Where handles that move apart lie so close that the lattice cannot follow both without great effort: a
// sentence. Otherwise "".
void ruga_judge_handles(const ruga_model* model, char* sentence, size_t size);
// Always: "ruga: ..." to stderr.
void ruga_complain(const char* format, ...) __attribute__((format(printf, 1, 2)));

// Prints a JSON object to stdout and releases it; NULL = it could not be made.
ruga_status ruga_print_json(json_t* object);
// null where the value is not finite.
json_t* ruga_json_number(double value);
json_t* ruga_json_vector(const double vector[3]);
json_t* ruga_json_texts(int count, const char* const* texts);

// Whether all that was printed has arrived.
ruga_status ruga_flush_output(void);

// "39 s", "4 min 10 s", "2 h 5 min"
void ruga_duration(double seconds, char text[32]);

// RUGA_BAD_INPUT where a file to read is missing, a folder, or not readable.
ruga_status ruga_check_input(const char* path);
// The same for a place to write to: RUGA_BAD_INPUT where it is a folder or its folder is missing, RUGA_IO
// where that does not let one write. Found out before any work.
ruga_status ruga_check_output(const char* path);
// A folder, where it is missing; that which it is to be in must be there.
ruga_status ruga_make_folder(const char* path);
// RUGA_BAD_INPUT where the ending is none that meshes can be written as.
ruga_status ruga_check_mesh_output(const char* path);

// Reads a surface file, only those groups where group_count > 0.
ruga_status ruga_read_surface(const char* path, int group_count, const char* const* groups, ruga_mesh* mesh);
void ruga_say_surface(const ruga_arguments* arguments, const char* path, const ruga_mesh* mesh);

#endif
