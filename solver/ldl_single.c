// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The fronts in single precision: the same sources with float for double.
#define RUGA_LDL_SINGLE
#include "solver/ldl_assembly.c"
#include "solver/ldl_front.c"
