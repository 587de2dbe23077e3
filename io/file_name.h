// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Names of files: their endings, and the place of a number in those of a sequence.
#ifndef RUGA_IO_FILE_NAME_H
#define RUGA_IO_FILE_NAME_H

#include "core/status.h"

// Whether a name is more than this ending, and has it.
bool ruga_file_name_ends(const char* name, const char* ending);
// The first %d, %4d or %04d, with its length; NULL where there is none.
const char* ruga_file_name_place(const char* name, size_t* length);
// The name with the number in that place, cut at `size`; as it is where there is no place.
void ruga_file_name_number(const char* pattern, int number, char* name, size_t size);

#endif
