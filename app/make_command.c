// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga make: a shape as a mesh file, or a crease pattern as a FOLD file.
#include "app/command.h"
#include "app/console.h"
#include "core/memory.h"
#include "crease/design.h"
#include "io/fold.h"
#include "io/mesh_file.h"
#include "mesh/make.h"

#include <stdio.h>
#include <string.h>

static const char shapes[] = "sheet|slab|bar|pillow|sphere|skirt|miura|waterbomb|pleats|arcs";
static const char patterns[] = "equilateral|diagonal|alternating";

static const ruga_option options[] = {
    {"--size", "-s", "X[,Y[,Z]]",
     "outer size, m [pillow, sphere: 0.5 m]. sheet: X,Y; slab, bar: X,Y,Z;\n"
     "pillow: X,Y,Z (missing Y = X, Z = 0.3 X); sphere: diameter;\n"
     "skirt, arcs: inner radius, outer radius, angle (rad or deg); miura,\n"
     "waterbomb, pleats: X,Y",
     false},
    {"--edge", "-e", "LENGTH", "length of an edge, m; the nearest that fits is taken [10 mm]", false},
    {"--cells", NULL, "N,M",
     "number of quads along X and Y (or around and across), in place of --edge;\n"
     "miura, waterbomb: cells along X and Y [8,8]; pleats: creases, waves [3,2];\n"
     "arcs: creases, 1 [5,1]",
     false},
    {"--pattern", NULL, patterns, "how the triangles lie [equilateral]", false},
    {"--angle", NULL, "ANGLE",
     "miura: between the sides of a panel [60 deg]; pleats: steepest slope [30 deg]", false},
    {"--fold", NULL, "ANGLE",
     "fold angles to write. miura: those at this slope of the panels; otherwise\n"
     "of every crease [none: mountains and valleys all the way]",
     false},
    {"--output", "-o", "FILE", "the file to write: .obj or .ply, of a crease pattern .fold", false},
    {0},
};

// One part of a list "a,b,c" into text; returns what follows, NULL at the end.
static const char* take_part(const char* list, char* text, size_t size) {
    size_t length = strcspn(list, ",");
    (void)snprintf(text, size, "%.*s", (int)(length < size ? length : size - 1), list);
    return list[length] == ',' ? list + length + 1 : NULL;
}

static ruga_status read_size(const char* list, bool turns, double size[3]) {
    char text[64];
    memset(size, 0, 3 * sizeof *size);
    for (int i = 0; list; i++) {
        if (i == 3) {
            return ruga_fail(RUGA_BAD_INPUT, "--size: at most three numbers");
        }
        bool angle = turns && i == 2;
        list = take_part(list, text, sizeof text);
        ruga_status status = ruga_quantity_parse(text, angle ? "rad" : "m", &size[i]);
        if (status != RUGA_OK) {
            return ruga_fail_prefix(status, "--size");
        }
        if (!(size[i] > 0)) {
            return ruga_fail(RUGA_BAD_INPUT, "--size: %s is not above 0", text);
        }
    }
    return RUGA_OK;
}

static ruga_status read_cells(const char* text, int cells[2]) {
    int end = 0;
    if (sscanf(text, "%7d,%7d%n", &cells[0], &cells[1], &end) != 2 || text[end] || cells[0] < 1 ||
        cells[1] < 1) {
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
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s (sheet, slab, bar, pillow, sphere, skirt, miura, waterbomb, pleats, arcs)",
                         sentence);
    }
    def->shape = (ruga_shape)shape;
    RUGA_TRY(ruga_option_choice(arguments, "--pattern", patterns, &pattern));
    def->pattern = (ruga_pattern)pattern;
    const char *size = ruga_value(arguments, "--size"), *cells = ruga_value(arguments, "--cells");
    if (size) {
        RUGA_TRY(read_size(size, def->shape == RUGA_SHAPE_SKIRT, def->size));
    }
    if (cells && ruga_given(arguments, "--edge")) {
        return ruga_fail(RUGA_BAD_INPUT, "--edge and --cells exclude each other");
    }
    if (cells) {
        def->edge = 0;
        return read_cells(cells, def->cells);
    }
    RUGA_TRY(ruga_quantity(arguments, "--edge", "m", &def->edge));
    return def->edge > 0
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT, "--edge: %s is not above 0", ruga_value(arguments, "--edge"));
}

static ruga_status read_design(const ruga_arguments* arguments, int design, ruga_design_def* def) {
    static const int cells[RUGA_DESIGN_COUNT][2] = {{8, 8}, {8, 8}, {3, 2}, {5, 1}};
    static const char* const others[] = {"--edge", "--pattern"};
    *def = (ruga_design_def){.design = (ruga_design)design,
                             .size = {design == RUGA_DESIGN_ARCS ? 0.1 : 0.5},
                             .cells = {cells[design][0], cells[design][1]}};
    for (int i = 0; i < 2; i++) {
        if (ruga_given(arguments, others[i])) {
            return ruga_fail(RUGA_BAD_INPUT, "make: %s is for meshes, %s is a crease pattern", others[i],
                             ruga_operand(arguments));
        }
    }
    if (ruga_given(arguments, "--size")) {
        RUGA_TRY(read_size(ruga_value(arguments, "--size"), design == RUGA_DESIGN_ARCS, def->size));
    }
    if (ruga_given(arguments, "--cells")) {
        RUGA_TRY(read_cells(ruga_value(arguments, "--cells"), def->cells));
    }
    RUGA_TRY(ruga_quantity(arguments, "--angle", "rad", &def->angle));
    return ruga_quantity(arguments, "--fold", "rad", &def->fold);
}

static ruga_status write_design(const ruga_arguments* arguments, int design) {
    const char *path, *dot;
    ruga_design_def def;
    ruga_crease_pattern pattern = {0};
    double* angle = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY(read_design(arguments, design, &def));
    RUGA_TRY(ruga_required(arguments, "--output", &path));
    dot = strrchr(path, '.');
    if (!dot || strcmp(dot, ".fold") != 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: a crease pattern is written as .fold", path);
    }
    RUGA_TRY(ruga_check_output(path));
    RUGA_TRY_DONE(ruga_crease_pattern_design(&def, &pattern));
    RUGA_TRY_DONE(RUGA_NEW(angle, pattern.edge_count));
    for (int e = 0; e < pattern.edge_count; e++) {
        angle[e] = pattern.edge[e].angle;
    }
    const int faces = pattern.face_count;
    if (design ==
        RUGA_DESIGN_ARCS) { // rings have holes, and faces of FOLD cannot: readers find them from the lines
        pattern.face_count = pattern.corner_count = 0;
    }
    const ruga_fold_frame frame = {(const double*)pattern.position, def.fold > 0 ? angle : NULL, 0};
    RUGA_TRY_DONE(ruga_fold_write(path, &pattern, "m", true, 1, &frame));
    ruga_say(arguments, "%s: %d vertices, %d lines, %d faces\n", path, pattern.vertex_count,
             pattern.edge_count, faces);
done:
    ruga_release(angle);
    ruga_crease_pattern_clear(&pattern);
    return status;
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    const char* path;
    ruga_make_def def;
    ruga_mesh mesh = {0};
    int design = ruga_design_from_name(ruga_operand(arguments));
    if (design >= 0) {
        return write_design(arguments, design);
    }
    for (int i = 0; i < 2; i++) {
        const char* option = i ? "--fold" : "--angle";
        if (ruga_given(arguments, option)) {
            return ruga_fail(RUGA_BAD_INPUT, "make: %s is for crease patterns, %s is a mesh", option,
                             ruga_operand(arguments));
        }
    }
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
    .operand = shapes,
    .usage = "[--size X[,Y[,Z]]] [--edge L | --cells N,M] [--pattern NAME] [--angle A] [--fold A] -o FILE",
    .summary = "make a sheet, slab, bar, pillow, sphere or skirt as a mesh file, or a crease pattern",
    .about =
        "Writes a shape centred at the origin, in metres. Sheet and skirt lie in z = 0 with normals +z, the\n"
        "other meshes are closed. miura, waterbomb, pleats (wavy creases) and arcs (concentric creases) are "
        "crease\n"
        "patterns for `creases:` of a scene. The outer size is exact.",
    .example = "    ruga make pillow --size 50cm --edge 8mm -o pillow.obj",
    .options = options,
    .run = run,
};
