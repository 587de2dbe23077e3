// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a mesh file says, polygon by polygon, until it becomes a triangle mesh.
#ifndef RUGA_IO_POLYGONS_H
#define RUGA_IO_POLYGONS_H

#include "mesh/mesh.h"

// Names with numbers in order of first use.
typedef struct ruga_names {
    int count, capacity;
    char** name;
    int slot_count; // 0 or a power of two, at least twice the count
    int* slot;      // number or -1
} ruga_names;

enum { RUGA_GROUP_KINDS = 3, RUGA_POLYGON_CORNERS = 20000 };

typedef struct ruga_corner {
    int vertex;
    int uv; // -1 = none
} ruga_corner;

typedef struct ruga_polygon {
    int first;                   // of its corners, which end where those of the next polygon begin
    int line;                    // in the file, for errors; 0 where it has none
    int group[RUGA_GROUP_KINDS]; // in names[kind], or -1
} ruga_polygon;

typedef struct ruga_polygons {
    int vertex_count, vertex_capacity;
    double (*position)[3];
    int uv_count, uv_capacity;
    double (*uv)[2];
    int corner_count, corner_capacity;
    ruga_corner* corner;
    int polygon_count, polygon_capacity;
    ruga_polygon* polygon;
    ruga_names names[RUGA_GROUP_KINDS];
    int group[RUGA_GROUP_KINDS]; // of the polygons to come, -1 = none
} ruga_polygons;

void ruga_polygons_begin(ruga_polygons* polygons);
void ruga_polygons_clear(ruga_polygons* polygons);
ruga_status ruga_polygons_add_vertex(ruga_polygons* polygons, const double position[3]);
ruga_status ruga_polygons_add_uv(ruga_polygons* polygons, const double uv[2]);
// Begins a polygon, whose corners follow.
ruga_status ruga_polygons_add(ruga_polygons* polygons, int line);
ruga_status ruga_polygons_add_corner(ruga_polygons* polygons, int vertex, int uv);
// Polygons to come belong to the group `name` of a kind; length 0 = to none.
ruga_status ruga_polygons_set_group(ruga_polygons* polygons, int kind, const char* name, size_t length);

// The triangle mesh. Checks that corners exist and that a polygon has 3 to RUGA_POLYGON_CORNERS of them; the
// sentence names path and line, or the polygon. Of the kinds of groups, the first that has any is kept, and
// of its groups those that have faces. Polygons are cut in the plane of their mean normal: quads along the
// shorter diagonal that lies inside, others by clipping ears.
ruga_status ruga_polygons_finish(const ruga_polygons* polygons, const char* path, ruga_mesh* mesh);

#endif
