// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The cases of the validation suite, one file each.
#ifndef RUGA_APP_VALIDATE_CASES_H
#define RUGA_APP_VALIDATE_CASES_H

#include "app/validate/validation.h"

extern const ruga_validation_case ruga_validate_sheet;
extern const ruga_validation_case ruga_validate_shell;

#endif
