// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What the program says about itself.
#include "app/command.h"

#include "ruga/base.h"

#include <stdio.h>
#include <string.h>

const char ruga_help_about[] =
    "Ruga computes the wrinkles of a thin skin on a soft body: leather on a cushion, skin on flesh,\n"
    "cloth. The body is a coarse lattice, the skin a fine triangle mesh tied to it; each frame is an\n"
    "equilibrium of the skin that is found to a tolerance and certified as stable.\n";

const char ruga_help_session[] = "A first session. Save these lines as sheet.yaml:\n"
                                 "\n"
                                 "    mesh:       {make: {shape: sheet, size: [30 cm, 10 cm], edge: 4 mm}}\n"
                                 "    skin:       {thickness: 2 mm, young: 40 MPa}\n"
                                 "    interior:   {young: 0.5 MPa, motion: prescribed}\n"
                                 "    lattice:    {fill: box}\n"
                                 "    prescribed: [{time: 0 s}, {time: 0.2 s, stretch: [0.94, 1, 1]}]\n"
                                 "    time:       {step: 20 ms, frames: 10}\n"
                                 "\n"
                                 "and look at what it means, simulate it, and measure its wrinkles:\n"
                                 "\n"
                                 "    ruga explain sheet.yaml\n"
                                 "    ruga run sheet.yaml -o sheet.h5\n"
                                 "    ruga measure sheet.h5\n";

static const char conclusion[] =
    "\n"
    "ruga COMMAND --help explains one of them, with an example.\n"
    "Lengths and other quantities may carry a unit (\"8 mm\", 8mm, 40MPa); without one they are SI.\n"
    "Exit status: 0 done; 1 done, but some frame is a saddle or not converged; 2 bad input or a mesh that\n"
    "cannot be simulated; 3 out of memory, disk or a library's failure; 130 after Ctrl-C.\n";

void ruga_print_help(void) {
    (void)printf("%s\nusage: ruga COMMAND ...\n\n%s\ncommands:\n", ruga_help_about, ruga_help_session);
    for (int i = 0; ruga_commands[i]; i++) {
        (void)printf("    %-9s %s\n", ruga_commands[i]->name, ruga_commands[i]->summary);
    }
    (void)fputs(conclusion, stdout);
}

enum { HELP_COLUMN = 29 };

// A help text of several lines, each further one indented to stand below the first; below the option where
// that is long.
static void print_option(const ruga_option* option) {
    int used = printf("    %s%s%s%s%s", option->letter ? option->letter : "", option->letter ? ", " : "",
                      option->name, option->value ? " " : "", option->value ? option->value : "");
    if (used >= HELP_COLUMN) {
        (void)printf("\n");
        used = 0;
    }
    for (const char* line = option->help; *line; used = 0) {
        size_t length = strcspn(line, "\n");
        (void)printf("%*s%.*s\n", HELP_COLUMN - used, "", (int)length, line);
        line += length + (line[length] == '\n');
    }
}

void ruga_print_command_help(const ruga_command* command) {
    (void)printf("usage: ruga %s%s%s %s\n\n%s\n\noptions:\n", command->name, command->operand ? " " : "",
                 command->operand ? command->operand : "", command->usage, command->about);
    const ruga_option* const tables[] = {command->options, ruga_common_options};
    for (int t = 0; t < 2; t++) {
        for (const ruga_option* o = tables[t]; o->name; o++) {
            print_option(o);
        }
    }
    (void)printf("\nexample:\n%s\n", command->example);
}
