// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga COMMAND ...: finds the command, reads its arguments, and turns what happened into an exit status.
#include "app/command.h"
#include "app/console.h"
#include "app/interrupt.h"

#include <stdio.h>
#include <string.h>

const ruga_command* const ruga_commands[] = {
    &ruga_make_command,     &ruga_check_command,   &ruga_remesh_command, &ruga_explain_command,
    &ruga_run_command,      &ruga_measure_command, &ruga_export_command, &ruga_bake_command,
    &ruga_render_command,   &ruga_plot_command,    &ruga_view_command,   &ruga_creases_command,
    &ruga_validate_command, &ruga_sweep_command,   &ruga_manual_command, NULL,
};

static int exit_status_of(ruga_status status) {
    switch (status) {
    case RUGA_OK:
        return RUGA_EXIT_DONE;
    case RUGA_BAD_INPUT:
    case RUGA_BAD_MESH:
        return RUGA_EXIT_BAD_INPUT;
    case RUGA_CANCELLED:
        return RUGA_EXIT_INTERRUPTED;
    default:
        return RUGA_EXIT_FAILURE;
    }
}

static const ruga_command* find_command(const char* name) {
    for (int i = 0; ruga_commands[i]; i++) {
        if (strcmp(ruga_commands[i]->name, name) == 0) {
            return ruga_commands[i];
        }
    }
    return NULL;
}

static ruga_status fail_command(const char* word) {
    char names[256] = "--help|--version", sentence[128];
    for (int i = 0; ruga_commands[i]; i++) {
        size_t used = strlen(names);
        (void)snprintf(names + used, sizeof names - used, "|%s", ruga_commands[i]->name);
    }
    (void)snprintf(sentence, sizeof sentence, "%s is no command", word);
    if (strlen(word) > 40) {
        (void)snprintf(sentence, sizeof sentence, "%.40s... is no command", word);
    }
    size_t before = strlen(sentence);
    ruga_suggest(names, word, sentence, sizeof sentence);
    return strlen(sentence) > before ? ruga_fail(RUGA_BAD_INPUT, "%s", sentence)
                                     : ruga_fail(RUGA_BAD_INPUT, "%s; ruga --help lists them", sentence);
}

static ruga_status run_command(const ruga_command* command, int count, char** words, int* exit_status) {
    ruga_arguments* arguments;
    RUGA_TRY(ruga_arguments_read(command, count, words, &arguments));
    ruga_status status = RUGA_OK;
    if (ruga_given(arguments, "--help")) {
        ruga_print_command_help(command);
    } else {
        status = command->run(arguments, exit_status);
    }
    ruga_arguments_destroy(&arguments);
    return status;
}

static bool is_one_of(const char* word, const char* a, const char* b, const char* c) {
    return strcmp(word, a) == 0 || strcmp(word, b) == 0 || strcmp(word, c) == 0;
}

static ruga_status run_program(int count, char** words, int* exit_status) {
    const char* word = count > 1 ? words[1] : "";
    const ruga_command* command = find_command(word);
    if (command) {
        return run_command(command, count - 2, words + 2, exit_status);
    }
    if (count < 2) {
        return ruga_fail(RUGA_BAD_INPUT, "no command is given; ruga --help shows a first session");
    }
    if (is_one_of(word, "--version", "-V", "version")) {
        ruga_print_version();
        return RUGA_OK;
    }
    if (!is_one_of(word, "--help", "-h", "help")) {
        return fail_command(word);
    }
    command = count > 2 ? find_command(words[2]) : NULL;
    if (count > 2 && !command) {
        return fail_command(words[2]);
    }
    if (command) {
        ruga_print_command_help(command);
    } else {
        ruga_print_help();
    }
    return RUGA_OK;
}

int main(int count, char** words) {
    int exit_status = RUGA_EXIT_DONE;
    ruga_interrupt_install();
    ruga_status status = run_program(count, words, &exit_status);
    // What was printed before a failure comes before its sentence, whether or not that can be written.
    if (status == RUGA_OK) {
        status = ruga_flush_output();
    } else {
        (void)fflush(stdout);
    }
    if (status != RUGA_OK) {
        ruga_complain("%s", ruga_last_error());
        exit_status = exit_status_of(status);
    }
    return exit_status;
}
