// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga make: a shape as a mesh file.
#include "app/command.h"
#include "app/console.h"
#include "io/mesh_file.h"
#include "mesh/make.h"

#include <stdio.h>
#include <string.h>

static const char shapes[] = "sheet|slab|bar|pillow|sphere|skirt";
static const char patterns[] = "equilateral|diagonal|alternating";

static const ruga_option options[] = {
    {"--size", "-s", "X[,Y[,Z]]",
     "outer size, m [pillow, sphere: 0.5 m]. sheet: X,Y; slab, bar: X,Y,Z;\n"
     "pillow: X,Y,Z (missing Y = X, Z = 0.3 X); sphere: diameter;\n"
     "skirt: inner radius, outer radius, angle (rad or deg)",
     false},
    {"--edge", "-e", "LENGTH", "length of an edge, m; the nearest that fits is taken [10 mm]", false},
    {"--cells", NULL, "N,M", "number of quads along X and Y (or around and across), in place of --edge",
     false},
    {"--pattern", NULL, patterns, "how the triangles lie [equilateral]", false},
    {"--output", "-o", "MESH", "the file to write, .obj or .ply", false},
    {0},
};

// One part of a list "a,b,c" into text; returns what follows, NULL at the end.
static const char* take_part(const char* list, char* text, size_t size) {
    size_t length = strcspn(list, ",");
    (void)snprintf(text, size, "%.*s", (int)(length < size ? length : size - 1), list);
    return list[length] == ',' ? list + length + 1 : NULL;
}

static ruga_status read_size(const char* list, ruga_make_def* def) {
    char text[64];
    memset(def->size, 0, sizeof def->size);
    for (int i = 0; list; i++) {
        if (i == 3) {
            return ruga_fail(RUGA_BAD_INPUT, "--size: at most three numbers");
        }
        bool angle = def->shape == RUGA_SHAPE_SKIRT && i == 2;
        list = take_part(list, text, sizeof text);
        ruga_status status = ruga_quantity_parse(text, angle ? "rad" : "m", &def->size[i]);
        if (status != RUGA_OK) {
            return ruga_fail_prefix(status, "--size");
        }
        if (!(def->size[i] > 0)) {
            return ruga_fail(RUGA_BAD_INPUT, "--size: %s is not above 0", text);
        }
    }
    return RUGA_OK;
}

static ruga_status read_cells(const char* text, ruga_make_def* def) {
    int end = 0;
    if (sscanf(text, "%7d,%7d%n", &def->cells[0], &def->cells[1], &end) != 2 || text[end] ||
        def->cells[0] < 1 || def->cells[1] < 1) {
        return ruga_fail(RUGA_BAD_INPUT, "--cells: %s is not two whole numbers such as 20,10", text);
    }
    return RUGA_OK;
}

static ruga_status read_def(const ruga_arguments* arguments, ruga_make_def* def) {
    *def = (ruga_make_def){.size = {0.5}, .edge = 10e-3};
    int shape = ruga_shape_from_name(ruga_operand(arguments)), pattern = RUGA_PATTERN_EQUILATERAL;
    if (shape < 0) {
        char sentence[256];
        (void)snprintf(sentence, sizeof sentence, "make: there is no shape %.40s", ruga_operand(arguments));
        ruga_suggest(shapes, ruga_operand(arguments), sentence, sizeof sentence);
        return ruga_fail(RUGA_BAD_INPUT, "%s (sheet, slab, bar, pillow, sphere, skirt)", sentence);
    }
    def->shape = (ruga_shape)shape;
    RUGA_TRY(ruga_option_choice(arguments, "--pattern", patterns, &pattern));
    def->pattern = (ruga_pattern)pattern;
    const char *size = ruga_value(arguments, "--size"), *cells = ruga_value(arguments, "--cells");
    if (size) {
        RUGA_TRY(read_size(size, def));
    }
    if (cells && ruga_given(arguments, "--edge")) {
        return ruga_fail(RUGA_BAD_INPUT, "--edge and --cells exclude each other");
    }
    if (cells) {
        def->edge = 0;
        return read_cells(cells, def);
    }
    RUGA_TRY(ruga_quantity(arguments, "--edge", "m", &def->edge));
    return def->edge > 0
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT, "--edge: %s is not above 0", ruga_value(arguments, "--edge"));
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    const char* path;
    ruga_make_def def;
    ruga_mesh mesh = {0};
    RUGA_TRY(read_def(arguments, &def));
    RUGA_TRY(ruga_required(arguments, "--output", &path));
    RUGA_TRY(ruga_check_mesh_output(path));
    RUGA_TRY(ruga_mesh_make(&def, &mesh));
    ruga_status status = ruga_mesh_write(path, &mesh, NULL, "made by Ruga, unit m");
    if (status == RUGA_OK) {
        ruga_say_surface(arguments, path, &mesh);
    }
    ruga_mesh_clear(&mesh);
    return status;
}

const ruga_command ruga_make_command = {
    .name = "make",
    .operand = "SHAPE",
    .usage = "[--size X[,Y[,Z]]] [--edge L | --cells N,M] [--pattern NAME] -o MESH",
    .summary = "make a sheet, slab, bar, pillow, sphere or skirt as a mesh file",
    .about =
        "Writes a shape centred at the origin, in metres. Sheet and skirt lie in z = 0 with normals +z, the\n"
        "others are closed. The outer size is exact.",
    .example = "    ruga make pillow --size 50cm --edge 8mm -o pillow.obj",
    .options = options,
    .run = run,
};
