// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The cases of the validation suite, one file each.
#ifndef RUGA_APP_VALIDATE_CASES_H
#define RUGA_APP_VALIDATE_CASES_H

#include "app/validate/validation.h"

extern const ruga_validation_case ruga_validate_sheet, ruga_validate_elements, ruga_validate_bar,
    ruga_validate_zigzag, ruga_validate_flower,
    ruga_validate_interior;

#endif
