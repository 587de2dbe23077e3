// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A table of numbers from a CSV file: a line of names, then a line for each row.
#ifndef RUGA_IO_CSV_H
#define RUGA_IO_CSV_H

#include "core/status.h"

typedef struct ruga_csv {
    int column_count, row_count;
    char** name;     // [columns]
    double** column; // [columns][rows]; NAN where a field is no number
    int* capacity;   // [columns] private
} ruga_csv;

// RUGA_BAD_INPUT with the line where a row has another number of fields than the first line.
ruga_status ruga_csv_read(const char* path, ruga_csv* csv);
void ruga_csv_clear(ruga_csv* csv);
// Index of a column, -1 = none of this name.
int ruga_csv_find(const ruga_csv* csv, const char* name, size_t length);

#endif
