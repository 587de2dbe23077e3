// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// A sparse map from integer grid coordinates to an index, kept in an OpenVDB tree: the spatial hash behind
// lattice construction. Absent entries read as -1.
#ifndef RUGA_LATTICE_VDB_SHIM_H
#define RUGA_LATTICE_VDB_SHIM_H

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ruga_vdb ruga_vdb;

ruga_status ruga_vdb_create(ruga_vdb** map);
// NULL inside is fine; sets it to NULL.
void ruga_vdb_destroy(ruga_vdb** map);
// One thread at a time.
ruga_status ruga_vdb_set(ruga_vdb* map, const int at[3], int value);
// Any number of threads as long as nobody sets.
int ruga_vdb_get(const ruga_vdb* map, const int at[3]);

#ifdef __cplusplus
}
#endif

#endif
