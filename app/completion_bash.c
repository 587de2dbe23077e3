// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Completion for bash 4.3 and later, alone or loaded by bash-completion.
#include "app/completion.h"

#include "io/scene_schema.h"

static const char body[] =
    "# The files of some endings, and folders.\n"
    "_ruga_files() {\n"
    "    local ending\n"
    "    mapfile -t COMPREPLY < <(\n"
    "        compgen -d -- \"$cur\"\n"
    "        if (($# == 0)); then compgen -f -X '!*.*' -- \"$cur\"; fi\n"
    "        for ending; do compgen -f -X \"!*.$ending\" -- \"$cur\"; done)\n"
    "    compopt -o filenames 2>/dev/null\n"
    "}\n"
    "\n"
    "# KEY=VALUE; the entries of lists are those that are typed, or the first.\n"
    "_ruga_key() {\n"
    "    local key=.${cur%%=*} numbers=() words=() number\n"
    "    while [[ $key =~ ^(.*)\\.([0-9]+)((\\..*)?)$ ]]; do\n"
    "        numbers=(\"${BASH_REMATCH[2]}\" \"${numbers[@]}\")\n"
    "        key=${BASH_REMATCH[1]}.N${BASH_REMATCH[3]}\n"
    "    done\n"
    "    if [[ $cur == *=* ]]; then\n"
    "        before+=${cur%%=*}=\n"
    "        cur=${cur#*=}\n"
    "        COMPREPLY=($(compgen -W \"$(_ruga_key_values \"${key#.}\")\" -- \"$cur\"))\n"
    "        return\n"
    "    fi\n"
    "    for key in $(_ruga_keys); do\n"
    "        for number in \"${numbers[@]}\"; do key=${key/.N./.$number.}; done\n"
    "        words+=(\"${key//.N./.0.}\")\n"
    "    done\n"
    "    COMPREPLY=($(compgen -W \"${words[*]}\" -S = -- \"$cur\"))\n"
    "    compopt -o nospace 2>/dev/null\n"
    "}\n"
    "\n"
    "_ruga() {\n"
    "    local words=() word joined= i command cur option= takes= before=\n"
    "    COMPREPLY=()\n"
    "    # bash takes --edge=8mm apart at the =\n"
    "    for ((i = 0; i <= COMP_CWORD; i++)); do\n"
    "        word=${COMP_WORDS[i]}\n"
    "        if ((i > 1)) && [[ $word == = || $joined ]]; then words[-1]+=$word; else words+=(\"$word\"); "
    "fi\n"
    "        if [[ $word == = ]]; then joined=1; else joined=; fi\n"
    "    done\n"
    "    cur=${words[-1]} command=${words[1]}\n"
    "    if ((${#words[@]} < 3)); then\n"
    "        COMPREPLY=($(compgen -W \"$(_ruga_commands) help --help --version\" -- \"$cur\"))\n"
    "        return\n"
    "    elif [[ $command == help ]]; then\n"
    "        COMPREPLY=($(compgen -W \"$(_ruga_commands)\" -- \"$cur\"))\n"
    "        return\n"
    "    elif [[ $cur == --*=* ]]; then\n"
    "        option=${cur%%=*} before=${cur%%=*}=\n"
    "        cur=${cur#*=}\n"
    "        takes=$(_ruga_takes \"$command\" \"$option\")\n"
    "    elif [[ ${words[-2]} == -* ]]; then\n"
    "        takes=$(_ruga_takes \"$command\" \"${words[-2]}\")\n"
    "    fi\n"
    "    if [[ -z $takes && $cur == -* ]]; then\n"
    "        COMPREPLY=($(compgen -W \"$(_ruga_options \"$command\")\" -- \"$cur\"))\n"
    "        return\n"
    "    fi\n"
    "    takes=${takes:-$(_ruga_takes \"$command\" operand)}\n"
    "    case $takes in\n"
    "    words*) COMPREPLY=($(compgen -W \"${takes#words}\" -- \"$cur\")) ;;\n"
    "    files*) _ruga_files ${takes#files} ;;\n"
    "    folder) COMPREPLY=($(compgen -d -- \"$cur\")) && compopt -o filenames 2>/dev/null ;;\n"
    "    key) _ruga_key ;;\n"
    "    esac\n"
    "    # What stands before the = is replaced as well only where bash does not end words there.\n"
    "    if [[ $before && $COMP_WORDBREAKS != *=* ]]; then COMPREPLY=(\"${COMPREPLY[@]/#/$before}\"); fi\n"
    "}\n"
    "\n"
    "complete -F _ruga ruga\n";

static void add_taken(ruga_string* script, const ruga_command* command, const ruga_option* option) {
    ruga_want want;
    bool is_output = option && option->letter && option->letter[1] == 'o';
    ruga_want_of(option ? option->value : command->operand, is_output, &want);
    ruga_string_add(script, "    %s,", command->name);
    if (option && option->letter) {
        ruga_string_add(script, "%s | %s,", option->letter, command->name);
    }
    ruga_string_add(script, "%s) echo \"", option ? option->name : "operand");
    static const char* const kinds[] = {"nothing", "words", "files", "folder", "key"};
    ruga_string_add(script, "%s", kinds[want.kind]);
    ruga_add_words(script, want.list, " ", "");
    ruga_string_add(script, "\" ;;\n");
}

static void add_commands(ruga_string* script) {
    ruga_string_add(script, "_ruga_commands() { echo \"");
    for (int i = 0; ruga_commands[i]; i++) {
        ruga_string_add(script, "%s%s", i ? " " : "", ruga_commands[i]->name);
    }
    ruga_string_add(script, "\"; }\n\n_ruga_options() {\n    case $1 in\n");
    for (int i = 0; ruga_commands[i]; i++) {
        ruga_string_add(script, "    %s) echo \"", ruga_commands[i]->name);
        const ruga_option* const tables[] = {ruga_commands[i]->options, ruga_common_options};
        for (int t = 0; t < 2; t++) {
            for (const ruga_option* o = tables[t]; o->name; o++) {
                ruga_string_add(script, "%s%s%s ", o->letter ? o->letter : "", o->letter ? " " : "", o->name);
            }
        }
        ruga_string_add(script, "\" ;;\n");
    }
    ruga_string_add(script,
                    "    esac\n}\n\n# What an option or the operand of a command takes; nothing for a "
                    "flag.\n_ruga_takes() {\n    case $1,$2 in\n");
    for (int i = 0; ruga_commands[i]; i++) {
        if (ruga_commands[i]->operand) {
            add_taken(script, ruga_commands[i], NULL);
        }
        for (const ruga_option* o = ruga_commands[i]->options; o->name; o++) {
            if (o->value) {
                add_taken(script, ruga_commands[i], o);
            }
        }
    }
    ruga_string_add(script, "    esac\n}\n\n");
}

static void add_keys(ruga_string* script) {
    ruga_string_add(script, "_ruga_keys() { echo \"");
    for (int i = 0; i < ruga_key_count; i++) {
        if (ruga_key_is_settable(i)) {
            ruga_string_add(script, "%s ", ruga_keys[i].path);
        }
    }
    ruga_string_add(script, "\"; }\n\n_ruga_key_values() {\n    case $1 in\n");
    for (int i = 0; i < ruga_key_count; i++) {
        char words[256];
        if (ruga_key_words(i, words)) {
            ruga_string_add(script, "    %s) echo \"", ruga_keys[i].path);
            ruga_add_words(script, words, "", " ");
            ruga_string_add(script, "\" ;;\n");
        }
    }
    ruga_string_add(script, "    esac\n}\n\n");
}

void ruga_completion_bash(ruga_string* script) {
    ruga_string_add(script, "# bash completion for ruga, made by `ruga manual`\n\n");
    add_commands(script);
    add_keys(script);
    ruga_string_add(script, "%s", body);
}
