// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// In place of the shell that view/web/build.mjs writes, where there is no npm.
#include "view/page.h"

const size_t ruga_page_shell_size = 0;
const unsigned char ruga_page_shell[] = {0};
