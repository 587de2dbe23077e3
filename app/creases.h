// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The creases of a model as the result file lists them.
#ifndef RUGA_APP_CREASES_H
#define RUGA_APP_CREASES_H

#include "app/command.h"
#include "io/result.h"
#include "solver/model.h"

typedef struct ruga_crease_table {
    ruga_result_creases result; // segment_count 0 = none
    int (*segment)[2];
    int* crease;
    double *length, *stiffness;
    char *assignment, **name; // names are the model's
} ruga_crease_table;

// Says of which creases there is nothing, or not all, in the model.
void ruga_warn_of_creases(const ruga_arguments* arguments, const ruga_model* model);

ruga_status ruga_crease_table_create(const ruga_model* model, ruga_crease_table* table);
void ruga_crease_table_clear(ruga_crease_table* table);

#endif
