// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Frames of a result as one FOLD file.
#ifndef RUGA_APP_EXPORT_FOLD_H
#define RUGA_APP_EXPORT_FOLD_H

#include "app/command.h"

// The frames chosen (all unless told), in metres. Creases keep their assignment and carry the angles
// measured; boundary edges are borders, all others flat.
ruga_status ruga_export_fold(const ruga_arguments* arguments, const char* path);

#endif
