// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "lattice/vdb_shim.h"

#include "core/shim.hpp"

#include <openvdb/tree/Tree.h>
#include <openvdb/tree/ValueAccessor.h>

#include <memory>

// A bare tree: openvdb::initialize() registers types for files and grids, which are not used here.
using index_tree = openvdb::tree::Tree4<int32_t, 5, 4, 3>::Type;

// The accessor remembers the last path through the tree; only ruga_vdb_set uses it.
struct ruga_vdb {
    index_tree tree{-1};
    openvdb::tree::ValueAccessor<index_tree> accessor{tree};
};

ruga_status ruga_vdb_create(ruga_vdb** map) {
    RUGA_SHIM_BEGIN
    *map = nullptr;
    *map = std::make_unique<ruga_vdb>().release();
    return RUGA_OK;
    RUGA_SHIM_END("OpenVDB")
}

void ruga_vdb_destroy(ruga_vdb** map) {
    delete *map;
    *map = nullptr;
}

ruga_status ruga_vdb_set(ruga_vdb* map, const int at[3], int value) {
    RUGA_SHIM_BEGIN
    map->accessor.setValue(openvdb::Coord(at), value);
    return RUGA_OK;
    RUGA_SHIM_END("OpenVDB")
}

int ruga_vdb_get(const ruga_vdb* map, const int at[3]) {
    return map->tree.getValue(openvdb::Coord(at));
}
