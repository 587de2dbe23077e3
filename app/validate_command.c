// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga validate: holds what Ruga computes against theory, published figures and other programs.
#include "app/command.h"
#include "app/console.h"
#include "app/interrupt.h"
#include "app/validate/validation.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

static const ruga_option options[] = {
    {"--quick", NULL, NULL, "the small forms of the quick cases: under three minutes", false},
    {"--case", "-c", "NAME", "this case only; may be given several times", true},
    {"--list", "-l", NULL, "list the cases and run none", false},
    {"--output", "-o", "DIR",
     "where the report and its pictures go; made where it is missing [validation-report]", false},
    {"--json", "-j", NULL, "print one JSON object with all lines", false},
    {0},
};

static ruga_status check_names(const ruga_arguments* arguments) {
    int count;
    const char* const* names = ruga_values(arguments, "--case", &count);
    for (int k = 0; k < count; k++) {
        char list[1024] = "", sentence[256];
        bool known = false;
        for (int i = 0; ruga_validation_cases[i]; i++) {
            known = known || strcmp(names[k], ruga_validation_cases[i]->name) == 0;
            (void)strncat(list, i ? "|" : "", sizeof list - strlen(list) - 1);
            (void)strncat(list, ruga_validation_cases[i]->name, sizeof list - strlen(list) - 1);
        }
        if (!known) {
            (void)snprintf(sentence, sizeof sentence, "validate: there is no case %.40s", names[k]);
            ruga_suggest(list, names[k], sentence, sizeof sentence);
            return ruga_fail(RUGA_BAD_INPUT, "%s; ruga validate --list names them", sentence);
        }
    }
    return RUGA_OK;
}

static bool is_chosen(const ruga_arguments* arguments, const ruga_validation_case* c) {
    int count;
    const char* const* names = ruga_values(arguments, "--case", &count);
    for (int k = 0; k < count; k++) {
        if (strcmp(names[k], c->name) == 0) {
            return true;
        }
    }
    return count == 0 && (c->quick || !ruga_given(arguments, "--quick"));
}

static ruga_status make_output(const char* directory) {
    struct stat info;
    if (stat(directory, &info) == 0 && !S_ISDIR(info.st_mode)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: is a file, not a folder", directory);
    }
    if (mkdir(directory, 0777) != 0 && errno != EEXIST) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: cannot be made: %s", directory, strerror(errno));
    }
    return RUGA_OK;
}

static ruga_status run_cases(const ruga_arguments* arguments, const ruga_validation_settings* settings,
                             int* failed) {
    for (int i = 0; ruga_validation_cases[i]; i++) {
        if (is_chosen(arguments, ruga_validation_cases[i])) {
            int here;
            if (ruga_interrupted()) {
                return ruga_fail(RUGA_CANCELLED, "stopped");
            }
            RUGA_TRY(ruga_validation_run(settings, ruga_validation_cases[i], &here));
            *failed += here;
        }
    }
    return RUGA_OK;
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    ruga_validation_settings settings = {.directory = "validation-report",
                                         .quick = ruga_given(arguments, "--quick"),
                                         .quiet = ruga_given(arguments, "--quiet")};
    int failed = 0;
    json_t* all = NULL;
    RUGA_TRY(check_names(arguments));
    if (ruga_given(arguments, "--list")) {
        for (int i = 0; ruga_validation_cases[i]; i++) {
            ruga_say(arguments, "%-16s%s%s\n", ruga_validation_cases[i]->name,
                     ruga_validation_cases[i]->title, ruga_validation_cases[i]->quick ? " (quick)" : "");
        }
        return RUGA_OK;
    }
    if (ruga_given(arguments, "--output")) {
        settings.directory = ruga_value(arguments, "--output");
    }
    RUGA_TRY(make_output(settings.directory));
    RUGA_TRY(run_cases(arguments, &settings, &failed));
    RUGA_TRY(ruga_validation_report(&settings, &all));
    *exit_status = failed ? RUGA_EXIT_NOT_CONVERGED : RUGA_EXIT_DONE;
    if (ruga_given(arguments, "--json")) {
        return ruga_print_json(json_pack("{s:i, s:o}", "failed", failed, "cases", all));
    }
    json_decref(all);
    ruga_say(arguments, "%d lines failed; report in %s/validation.md\n", failed, settings.directory);
    return RUGA_OK;
}

const ruga_command ruga_validate_command = {
    .name = "validate",
    .usage = "[--quick] [--case NAME] [-o DIR] [--json]",
    .summary = "hold Ruga against theory, published figures and other programs",
    .about = "Runs the validation suite and writes DIR/validation.md with tables and pictures. Cases that "
             "were run\n"
             "before into the same folder stay in the report. Exit status 1 where a line fails.",
    .example = "    ruga validate --case sheet -o report",
    .options = options,
    .run = run,
};
