// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a subcommand is, and what it gets from the command line. Every subcommand has one file
// <name>_command.c; reading arguments, help and refusals follow from its table of options.
#ifndef RUGA_APP_COMMAND_H
#define RUGA_APP_COMMAND_H

#include "core/status.h"

enum {
    RUGA_EXIT_DONE = 0,
    RUGA_EXIT_NOT_CONVERGED = 1, // done, but some frame is a saddle or not converged
    RUGA_EXIT_BAD_INPUT = 2,
    RUGA_EXIT_FAILURE = 3, // memory, disk or a library
    RUGA_EXIT_INTERRUPTED = 130,
};

typedef struct ruga_option {
    const char* name;   // "--edge"; NULL ends a table
    const char* letter; // "-e", or NULL
    const char* value;  // what it takes, "LENGTH"; "a|b|c" = one of these; NULL = nothing
    const char* help;   // meaning, unit and default
    bool repeats;       // may be given several times
} ruga_option;

typedef struct ruga_arguments ruga_arguments;

// Does the work. *exit_status is RUGA_EXIT_DONE and stays so where nothing else is to be said; a failure is
// printed and turned into an exit status by main.
typedef ruga_status ruga_command_function(const ruga_arguments* arguments, int* exit_status);

typedef struct ruga_command {
    const char* name;
    const char* operand; // "SCENE", or one of "a|b|c"; NULL = the command takes none
    const char* usage;   // the options as they are usually written
    const char* summary; // one line
    const char* about;
    const char* example;
    const ruga_option* options;
    ruga_command_function* run;
} ruga_command;

extern const ruga_command ruga_make_command, ruga_check_command, ruga_remesh_command, ruga_explain_command,
    ruga_run_command, ruga_measure_command, ruga_export_command, ruga_bake_command, ruga_render_command,
    ruga_plot_command, ruga_view_command, ruga_creases_command, ruga_validate_command, ruga_sweep_command,
    ruga_manual_command;
extern const ruga_command* const ruga_commands[]; // ended by NULL

// ---- arguments -----------------------------------------------------------------------------------------

// Reads the words after a command's name, which must outlive the arguments. RUGA_BAD_INPUT with the nearest
// option for an unknown one.
ruga_status ruga_arguments_read(const ruga_command* command, int count, char** words,
                                ruga_arguments** arguments);
void ruga_arguments_destroy(ruga_arguments** arguments);

const char* ruga_operand(const ruga_arguments* arguments);
// Whether the option was given; its value (the last one; "" for a flag), NULL where it was not.
bool ruga_given(const ruga_arguments* arguments, const char* option);
const char* ruga_value(const ruga_arguments* arguments, const char* option);
// All values of an option that repeats: a list of the arguments' own.
const char* const* ruga_values(const ruga_arguments* arguments, const char* option, int* count);
// The value of an option that must be there.
ruga_status ruga_required(const ruga_arguments* arguments, const char* option, const char** value);
// These leave *value as it is where the option was not given.
ruga_status ruga_quantity(const ruga_arguments* arguments, const char* option, const char* dimension,
                          double* value);
ruga_status ruga_integer(const ruga_arguments* arguments, const char* option, int low, int high, int* value);
// *index of the value in "a|b|c", which the option's table names as well.
ruga_status ruga_option_choice(const ruga_arguments* arguments, const char* option, const char* choices,
                               int* index);

// ---- help ----------------------------------------------------------------------------------------------

extern const ruga_option ruga_common_options[]; // of every command
extern const char ruga_help_about[], ruga_help_session[];

void ruga_print_help(void);
void ruga_print_command_help(const ruga_command* command);
void ruga_print_version(void);
// Names and versions of all libraries but HDF5, with `between` between them.
void ruga_library_versions(const char* between, char* text, size_t size);

// Appends ", did you mean X?" to a sentence about an unknown word; nothing where no name is near.
// names: "a|b|c".
void ruga_suggest(const char* names, const char* word, char* sentence, size_t size);

#endif
