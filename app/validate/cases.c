// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/cases.h"

#include <stddef.h>

const ruga_validation_case* const ruga_validation_cases[] = {
    &ruga_validate_sheet,
    &ruga_validate_map,
    &ruga_validate_volume,
    &ruga_validate_calculix,
    &ruga_validate_elements,
    &ruga_validate_bar,
    &ruga_validate_zigzag,
    &ruga_validate_flower,
    &ruga_validate_vary,
    &ruga_validate_shell,
    &ruga_validate_interior,
    NULL,
};
