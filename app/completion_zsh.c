// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Completion for zsh, a function _ruga for $fpath.
#include "app/completion.h"

#include "io/scene_schema.h"

static const char begin[] = "#compdef ruga\n"
                            "# made by `ruga manual`\n"
                            "\n"
                            "# KEY=VALUE; the entries of lists are those that are typed, or the first.\n"
                            "_ruga_key() {\n"
                            "    local key=.${PREFIX%%=*} number\n"
                            "    local -a numbers keys=($_ruga_keys)\n"
                            "    while [[ $key =~ '^(.*)\\.([0-9]+)((\\..*)?)$' ]]; do\n"
                            "        numbers=($match[2] $numbers)\n"
                            "        key=$match[1].N$match[3]\n"
                            "    done\n"
                            "    if compset -P 1 '*='; then\n"
                            "        compadd -- ${=_ruga_values[${key#.}]}\n"
                            "    else\n"
                            "        for number in $numbers; do keys=(${keys/.N./.$number.}); done\n"
                            "        compadd -q -S = -- ${keys//.N./.0.}\n"
                            "    fi\n"
                            "}\n"
                            "\n";

static const char end[] = "    esac\n"
                          "}\n"
                          "\n"
                          "_ruga \"$@\"\n";

static void add_keys(ruga_string* script) {
    char words[256];
    ruga_string_add(script, "typeset -ga _ruga_keys=(");
    for (int i = 0; i < ruga_key_count; i++) {
        if (ruga_key_is_settable(i)) {
            ruga_string_add(script, "\n    %s", ruga_keys[i].path);
        }
    }
    ruga_string_add(script, ")\ntypeset -gA _ruga_values=(");
    for (int i = 0; i < ruga_key_count; i++) {
        if (ruga_key_words(i, words)) {
            ruga_string_add(script, "\n    %s '", ruga_keys[i].path);
            ruga_add_words(script, words, "", " ");
            ruga_string_add(script, "'");
        }
    }
    ruga_string_add(script, ")\n\n");
}

// ":WORD:what it may be", of an option or operand; `word` stands there in the help.
static void add_taken(ruga_string* script, const char* word, bool is_output) {
    ruga_want want;
    ruga_want_of(word, is_output, &want);
    ruga_string_add(script, ":");
    ruga_add_quoted(script, want.kind == RUGA_WANTED_WORDS ? "one of" : word, ":\\[]");
    ruga_string_add(script, ":");
    switch (want.kind) {
    case RUGA_WANTED_NOTHING:
        ruga_string_add(script, " ");
        break;
    case RUGA_WANTED_WORDS:
        ruga_string_add(script, "(");
        ruga_add_words(script, want.list, "", " ");
        ruga_string_add(script, ")");
        break;
    case RUGA_WANTED_FILE:
        ruga_string_add(script, want.list[0] ? "_files -g \"*.(%s)(-.)\"" : "_files", want.list);
        break;
    case RUGA_WANTED_FOLDER:
        ruga_string_add(script, "_files -/");
        break;
    case RUGA_WANTED_KEY:
        ruga_string_add(script, "_ruga_key");
        break;
    }
}

static void add_option(ruga_string* script, const ruga_option* option) {
    ruga_string_add(script, " \\\n            ");
    if (option->repeats) {
        ruga_string_add(script, "'*'");
    } else if (option->letter) {
        ruga_string_add(script, "'(%s %s)'", option->letter, option->name);
    }
    if (option->letter) {
        ruga_string_add(script, "{%s,%s%s}", option->letter, option->name, option->value ? "=" : "");
    } else {
        ruga_string_add(script, "%s%s", option->name, option->value ? "=" : "");
    }
    ruga_string_add(script, "'[");
    ruga_add_quoted(script, option->help, ":\\[]");
    ruga_string_add(script, "]");
    if (option->value) {
        add_taken(script, option->value, option->letter && option->letter[1] == 'o');
    }
    ruga_string_add(script, "'");
}

static void add_command(ruga_string* script, const ruga_command* command) {
    ruga_string_add(script, "    %s)\n        _arguments -S", command->name);
    const ruga_option* const tables[] = {command->options, ruga_common_options};
    for (int t = 0; t < 2; t++) {
        for (const ruga_option* o = tables[t]; o->name; o++) {
            add_option(script, o);
        }
    }
    if (command->operand) {
        ruga_string_add(script, " \\\n            '1");
        add_taken(script, command->operand, false);
        ruga_string_add(script, "'");
    }
    ruga_string_add(script, "\n        ;;\n");
}

void ruga_completion_zsh(ruga_string* script) {
    ruga_string_add(script, "%s", begin);
    add_keys(script);
    ruga_string_add(script, "_ruga() {\n    local line state\n    local -a commands=(");
    for (int i = 0; ruga_commands[i]; i++) {
        ruga_string_add(script, "\n        '%s:", ruga_commands[i]->name);
        ruga_add_quoted(script, ruga_commands[i]->summary, ":");
        ruga_string_add(script, "'");
    }
    ruga_string_add(script,
                    ")\n"
                    "    _arguments -C '(- *)'{-h,--help}'[print an overview]' \\\n"
                    "        '(- *)'{-V,--version}'[print the version]' '1: :->command' '*:: :->rest'\n"
                    "    if [[ $state == command ]]; then\n"
                    "        _describe command commands\n"
                    "        return\n"
                    "    fi\n"
                    "    case $words[1] in\n");
    for (int i = 0; ruga_commands[i]; i++) {
        add_command(script, ruga_commands[i]);
    }
    ruga_string_add(script, "%s", end);
}
