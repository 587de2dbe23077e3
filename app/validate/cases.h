// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The cases of the validation suite, one file each, in the order of the report.
#ifndef RUGA_APP_VALIDATE_CASES_H
#define RUGA_APP_VALIDATE_CASES_H

#include "app/validate/validation.h"

extern const ruga_validation_case ruga_validate_sheet;
extern const ruga_validation_case ruga_validate_map;
extern const ruga_validation_case ruga_validate_volume;
extern const ruga_validation_case ruga_validate_calculix;
extern const ruga_validation_case ruga_validate_elements;
extern const ruga_validation_case ruga_validate_bar;
extern const ruga_validation_case ruga_validate_zigzag;
extern const ruga_validation_case ruga_validate_flower;
extern const ruga_validation_case ruga_validate_vary;
extern const ruga_validation_case ruga_validate_shell;
extern const ruga_validation_case ruga_validate_interior;

#endif
