// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Numbers and quantities as people write them, through UDUNITS-2. ruga_quantity_parse stands in scene.h.
#ifndef RUGA_IO_UNITS_H
#define RUGA_IO_UNITS_H

#include "core/status.h"

// "2", "-0.5", "1e-3": a finite decimal number without a unit, whatever the locale.
ruga_status ruga_number_parse(const char* text, double* value);

// "m" -> "a length (m)", "1" -> "a plain number"
const char* ruga_dimension_name(const char* dimension);

// How many of the dimension's SI unit one `unit` is: "mm" as "m" gives 0.001.
ruga_status ruga_unit_factor(const char* unit, const char* dimension, double* factor);

#endif
