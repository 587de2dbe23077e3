// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Completion for fish 3.
#include "app/completion.h"

#include "io/scene_schema.h"

static const char begin[] =
    "# fish completion for ruga, made by `ruga manual`\n"
    "\n"
    "# Files of some endings, and folders.\n"
    "function __ruga_files\n"
    "    set -l endings (string join '|' $argv)\n"
    "    __fish_complete_path (commandline -ct) | string match -r \"^.*(?:/|\\.(?:$endings))(?:\\t.*)?\\$\"\n"
    "end\n"
    "\n"
    "# KEY=VALUE; the entries of lists are those that are typed, or the first.\n"
    "function __ruga_key\n"
    "    set -l key (commandline -ct | string replace -r '^--set=' '' | string replace -r '=.*' '')\n"
    "    set -l keys (__ruga_keys)\n"
    "    for number in (string match -rag '\\.([0-9]+)(?=\\.|$)' -- $key)\n"
    "        set keys (string replace '.N.' \".$number.\" -- $keys)\n"
    "    end\n"
    "    string replace -a '.N.' '.0.' -- $keys\n"
    "end\n"
    "\n";

static void add_keys(ruga_string* script) {
    ruga_string_add(script, "function __ruga_keys\n    printf '%%s\\n'");
    for (int i = 0; i < ruga_key_count; i++) {
        char words[256] = "";
        if (!ruga_key_is_settable(i)) {
            continue;
        }
        ruga_string_add(script, " \\\n        %s=", ruga_keys[i].path);
        if (ruga_key_words(i, words)) {
            ruga_string_add(script, "{");
            ruga_add_words(script, words, ",", "");
            ruga_string_add(script, "}");
        }
    }
    ruga_string_add(script, "\nend\n\n");
}

// What may follow, as options of fish's `complete`.
static void add_taken(ruga_string* script, const char* word, bool is_output) {
    ruga_want want;
    ruga_want_of(word, is_output, &want);
    switch (want.kind) {
    case RUGA_WANTED_NOTHING:
        return;
    case RUGA_WANTED_WORDS:
        ruga_string_add(script, " -a '");
        ruga_add_words(script, want.list, "", " ");
        break;
    case RUGA_WANTED_FILE:
        ruga_string_add(script,
                        want.list[0] ? " -a '(__ruga_files" : " -a '(__fish_complete_path (commandline -ct)");
        ruga_add_words(script, want.list, " ", "");
        ruga_string_add(script, ")");
        break;
    case RUGA_WANTED_FOLDER:
        ruga_string_add(script, " -a '(__fish_complete_directories (commandline -ct) \"\")");
        break;
    case RUGA_WANTED_KEY:
        ruga_string_add(script, " -a '(__ruga_key)");
        break;
    }
    ruga_string_add(script, "'");
}

static void add_option(ruga_string* script, const ruga_command* command, const ruga_option* option) {
    ruga_string_add(script, "complete -c ruga -n '__fish_seen_subcommand_from %s' -l %s", command->name,
                    option->name + 2);
    if (option->letter) {
        ruga_string_add(script, " -s %s", option->letter + 1);
    }
    if (option->value) {
        ruga_string_add(script, " -x");
        add_taken(script, option->value, option->letter && option->letter[1] == 'o');
    }
    ruga_string_add(script, " -d '");
    ruga_add_quoted(script, option->help, "\\");
    ruga_string_add(script, "'\n");
}

void ruga_completion_fish(ruga_string* script) {
    ruga_string_add(script, "%s", begin);
    add_keys(script);
    ruga_string_add(script,
                    "complete -c ruga -f\n"
                    "complete -c ruga -n __fish_use_subcommand -l help -s h -d 'print an overview'\n"
                    "complete -c ruga -n __fish_use_subcommand -l version -s V -d 'print the version'\n");
    for (int i = 0; ruga_commands[i]; i++) {
        const ruga_command* command = ruga_commands[i];
        ruga_string_add(script, "complete -c ruga -n __fish_use_subcommand -a %s -d '", command->name);
        ruga_add_quoted(script, command->summary, "\\");
        ruga_string_add(script, "'\n");
        const ruga_option* const tables[] = {command->options, ruga_common_options};
        for (int t = 0; t < 2; t++) {
            for (const ruga_option* o = tables[t]; o->name; o++) {
                add_option(script, command, o);
            }
        }
        if (command->operand) {
            ruga_string_add(script, "complete -c ruga -n '__fish_seen_subcommand_from %s'", command->name);
            add_taken(script, command->operand, false);
            ruga_string_add(script, "\n");
        }
    }
}
