// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Manual pages, in the macros of man(7), made from the tables of the commands.
#ifndef RUGA_APP_MANUAL_H
#define RUGA_APP_MANUAL_H

#include "app/command.h"
#include "io/pool.h"

void ruga_manual_of_program(ruga_string* page);                              // ruga(1)
void ruga_manual_of_command(const ruga_command* command, ruga_string* page); // ruga-NAME(1)

#endif
