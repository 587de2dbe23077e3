// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// XDMF: a page of XML beside a result file that tells ParaView and VTK what its datasets are. No number is
// copied.
#ifndef RUGA_IO_XDMF_H
#define RUGA_IO_XDMF_H

#include "io/result.h"

// Frames first to last of the result at `result_path`, named from `path`'s folder: by its name where both lie
// in one folder, otherwise by its absolute path.
ruga_status ruga_xdmf_write(const char* path, const char* result_path, const ruga_result_reader* result,
                            const double* time, int first, int last);

#endif
