// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Surface files by their ending: reads .obj .ply .stl .off .gltf .glb, writes .obj .ply.
#ifndef RUGA_IO_MESH_FILE_H
#define RUGA_IO_MESH_FILE_H

#include "mesh/mesh.h"

// Vertex order, UVs, groups and polygons (triangulated deterministically) are kept; STL and glTF are welded.
// RUGA_BAD_INPUT with file and line (or byte) where the content is wrong, RUGA_IO where it cannot be read.
// Degenerate or non-finite content is kept for the doctor to report.
ruga_status ruga_mesh_read(const char* path, ruga_mesh* mesh);

// Writes through a temporary file and renames it: nothing half-written is left. `comment` may be NULL.
// Normals are written where `normals` [V][3] is not NULL.
ruga_status ruga_mesh_write(const char* path, const ruga_mesh* mesh, const double* normals,
                            const char* comment);

// One file per format, same shape: io/obj.c, io/ply.c, io/stl.c, io/off.c, io/gltf.c
ruga_status ruga_obj_read(const char* path, ruga_mesh* mesh);
ruga_status ruga_obj_write(const char* path, const ruga_mesh* mesh, const double* normals, const char* comment);
ruga_status ruga_ply_read(const char* path, ruga_mesh* mesh);
ruga_status ruga_ply_write(const char* path, const ruga_mesh* mesh, const double* normals, const char* comment);
ruga_status ruga_stl_read(const char* path, ruga_mesh* mesh);
ruga_status ruga_off_read(const char* path, ruga_mesh* mesh);
ruga_status ruga_gltf_read(const char* path, ruga_mesh* mesh);

#endif
