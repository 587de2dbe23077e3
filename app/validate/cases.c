// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/cases.h"

#include <stddef.h>

const ruga_validation_case* const ruga_validation_cases[] = {
    &ruga_validate_sheet,
    &ruga_validate_shell,
    NULL,
};
