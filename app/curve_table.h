// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Frame by frame: size, forces and energies, as a table for force-displacement curves.
#ifndef RUGA_APP_CURVE_TABLE_H
#define RUGA_APP_CURVE_TABLE_H

#include "app/command.h"
#include "io/result.h"

// CSV with a head line: frame, time (s), size_x .. size_z of the surface's box (m), force_N_x .. force_N_z of
// each handle on the skin (N), energy_* (J), outcome.
ruga_status ruga_curve_table_write(const ruga_arguments* arguments, ruga_result_reader* reader,
                                   const char* path);

#endif
