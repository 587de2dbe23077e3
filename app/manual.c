// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Manual pages, in the macros of man(7). The parts and their order are those of man-pages(7).
#include "app/manual.h"

#include "ruga/base.h"

#include <ctype.h>
#include <string.h>

enum { INDENT = 4 }; // of what is shown as it stands, in the help texts

// Text that groff prints as it stands: no escapes, no requests, and ASCII signs that can be copied.
static void add_text(ruga_string* page, const char* text, size_t length, bool begins_line) {
    for (size_t i = 0; i < length; i++) {
        const char* escape = text[i] == '\\'   ? "\\e"
                             : text[i] == '-'  ? "\\-"
                             : text[i] == '\'' ? "\\(aq"
                             : text[i] == '`'  ? "\\(ga"
                             : text[i] == '^'  ? "\\(ha"
                             : text[i] == '~'  ? "\\(ti"
                                               : NULL;
        if (i == 0 && begins_line && text[i] == '.') {
            ruga_string_add(page, "\\&");
        }
        if (escape) {
            ruga_string_add(page, "%s", escape);
        } else {
            ruga_string_add_bytes(page, text + i, 1);
        }
    }
}

static void add_line(ruga_string* page, const char* text, size_t length) {
    add_text(page, text, length, true);
    ruga_string_add(page, "\n");
}

// Paragraphs of a help text. Lines that begin with blanks are shown as they are.
static void add_paragraphs(ruga_string* page, const char* text) {
    bool shown = false, gap = false;
    for (const char* line = text; *line;) {
        size_t length = strcspn(line, "\n"), blanks = strspn(line, " ");
        if (blanks < length) {
            if (shown != (blanks > 0)) {
                shown = !shown;
                ruga_string_add(page, shown ? "%s.RS 4\n.EX\n" : ".EE\n.RE\n%s", line == text ? "" : ".PP\n");
            } else if (gap) {
                ruga_string_add(page, shown ? "\n" : ".PP\n");
            }
            size_t indent = blanks < INDENT ? blanks : INDENT;
            add_line(page, line + indent, length - indent);
        }
        gap = blanks >= length;
        line += length + (line[length] == '\n');
    }
    ruga_string_add(page, shown ? ".EE\n.RE\n" : "");
}

static void add_title(ruga_string* page, const char* name, const char* summary) {
    ruga_string_add(page, ".\\\" Made by `ruga manual` from the tables of the commands.\n.TH \"");
    for (const char* c = name; *c; c++) {
        char big[2] = {(char)toupper((unsigned char)*c), 0};
        ruga_string_add(page, "%s", *c == '-' ? "\\-" : big);
    }
    ruga_string_add(page, "\" 1 \"\" \"Ruga %s\" \"Ruga\"\n.SH NAME\n", ruga_version());
    add_text(page, name, strlen(name), true);
    ruga_string_add(page, " \\- ");
    add_line(page, summary, strlen(summary));
}

static void add_option(ruga_string* page, const ruga_option* option) {
    const char* const names[] = {option->letter, option->name};
    ruga_string_add(page, ".TP\n");
    for (int i = option->letter ? 0 : 1; i < 2; i++) {
        ruga_string_add(page, "\\fB");
        add_text(page, names[i], strlen(names[i]), false);
        ruga_string_add(page, i ? "\\fR" : "\\fR, ");
    }
    if (option->value) {
        ruga_string_add(page, " \\fI");
        add_text(page, option->value, strlen(option->value), false);
        ruga_string_add(page, "\\fR");
    }
    ruga_string_add(page, "\n");
    add_paragraphs(page, option->help);
}

static void add_exit_statuses(ruga_string* page) {
    static const struct {
        int status;
        const char* meaning;
    } statuses[] = {
        {RUGA_EXIT_DONE, "done"},
        {RUGA_EXIT_NOT_CONVERGED, "done, but some frame is a saddle or not converged, or some case failed"},
        {RUGA_EXIT_BAD_INPUT, "bad input, or a mesh that cannot be simulated"},
        {RUGA_EXIT_FAILURE, "out of memory or disk, or a library failed"},
        {RUGA_EXIT_INTERRUPTED, "stopped by Ctrl\\-C"},
    };
    ruga_string_add(page, ".SH \"EXIT STATUS\"\n");
    for (size_t i = 0; i < sizeof statuses / sizeof statuses[0]; i++) {
        ruga_string_add(page, ".TP\n.B %d\n%s\n", statuses[i].status, statuses[i].meaning);
    }
}

static void add_see_also(ruga_string* page, const ruga_command* except) {
    ruga_string_add(page, ".SH \"SEE ALSO\"\n");
    if (except) {
        ruga_string_add(page, ".BR ruga (1),\n");
    }
    for (int i = 0; ruga_commands[i]; i++) {
        if (ruga_commands[i] != except) {
            bool last = !ruga_commands[i + 1] || (ruga_commands[i + 1] == except && !ruga_commands[i + 2]);
            ruga_string_add(page, ".BR ruga\\-%s (1)%s\n", ruga_commands[i]->name, last ? "" : ",");
        }
    }
}

void ruga_manual_of_command(const ruga_command* command, ruga_string* page) {
    ruga_string name = {0};
    ruga_string_add(&name, "ruga-%s", command->name);
    add_title(page, name.data ? name.data : "", command->summary);
    ruga_string_clear(&name);
    ruga_string_add(page, ".SH SYNOPSIS\n.B ruga %s\n", command->name);
    if (command->operand) {
        ruga_string_add(page, ".I ");
        add_line(page, command->operand, strlen(command->operand));
    }
    add_line(page, command->usage, strlen(command->usage));
    ruga_string_add(page, ".SH DESCRIPTION\n");
    add_paragraphs(page, command->about);
    ruga_string_add(page, ".SH OPTIONS\n");
    const ruga_option* const tables[] = {command->options, ruga_common_options};
    for (int t = 0; t < 2; t++) {
        for (const ruga_option* o = tables[t]; o->name; o++) {
            add_option(page, o);
        }
    }
    ruga_string_add(
        page, ".PP\nLengths and other quantities may carry a unit (\\(dq8 mm\\(dq, 8mm, 40MPa); without "
              "one they are SI.\n");
    add_exit_statuses(page);
    ruga_string_add(page, ".SH EXAMPLES\n");
    add_paragraphs(page, command->example);
    add_see_also(page, command);
}

void ruga_manual_of_program(ruga_string* page) {
    add_title(page, "ruga", "wrinkles and sharp creases of thin skins on soft bodies");
    ruga_string_add(page, ".SH SYNOPSIS\n.B ruga\n.I COMMAND\n.RI [ OPTIONS ]\n"
                          ".SH DESCRIPTION\n");
    add_paragraphs(page, ruga_help_about);
    ruga_string_add(page, ".SH COMMANDS\nEach has a manual page of its own.\n");
    for (int i = 0; ruga_commands[i]; i++) {
        ruga_string_add(page, ".TP\n.BR ruga\\-%s (1)\n", ruga_commands[i]->name);
        add_line(page, ruga_commands[i]->summary, strlen(ruga_commands[i]->summary));
    }
    ruga_string_add(
        page, ".SH OPTIONS\n.TP\n.B \\-\\-help\nprint an overview; after a command, that command\\(aqs\n"
              ".TP\n.B \\-\\-version\nprint the version, and those of the libraries\n");
    add_exit_statuses(page);
    ruga_string_add(page, ".SH EXAMPLES\n");
    add_paragraphs(page, ruga_help_session);
    add_see_also(page, NULL);
}
