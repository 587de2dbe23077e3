// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga remesh: near-equilateral triangles of a given size.
#include "mesh/remesh.h"

#include "app/command.h"
#include "app/console.h"
#include "io/mesh_file.h"
#include "io/units.h"

static const ruga_option options[] = {
    {"--edge", "-e", "LENGTH", "length of an edge of the new mesh, m", false},
    {"--unit", "-u", "UNIT", "the unit of the file's coordinates, kept in the new file [m]", false},
    {"--group", "-g", "NAME", "only the faces of this group; may be given several times [all]", true},
    {"--output", "-o", "MESH", "the file to write, .obj or .ply", false},
    {0},
};

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    const char *path, *text;
    int group_count;
    double edge, unit = 1;
    RUGA_TRY(ruga_required(arguments, "--edge", &text));
    RUGA_TRY(ruga_quantity(arguments, "--edge", "m", &edge));
    if (!(edge > 0)) {
        return ruga_fail(RUGA_BAD_INPUT, "--edge: %s is not above 0", text);
    }
    if (ruga_given(arguments, "--unit")) {
        RUGA_TRY(ruga_unit_factor(ruga_value(arguments, "--unit"), "m", &unit));
    }
    RUGA_TRY(ruga_required(arguments, "--output", &path));
    RUGA_TRY(ruga_check_mesh_output(path));
    const char* const* groups = ruga_values(arguments, "--group", &group_count);
    ruga_mesh mesh = {0}, remeshed = {0};
    RUGA_TRY(ruga_read_surface(ruga_operand(arguments), group_count, groups, &mesh));
    ruga_status status = ruga_mesh_remesh(&mesh, edge / unit, &remeshed);
    if (status != RUGA_OK) {
        status = ruga_fail_prefix(status, "%s", ruga_operand(arguments));
        goto done;
    }
    RUGA_TRY_DONE(ruga_mesh_write(path, &remeshed, NULL, "remeshed by Ruga"));
    ruga_say_surface(arguments, path, &remeshed);
done:
    ruga_mesh_clear(&mesh);
    ruga_mesh_clear(&remeshed);
    return status;
}

const ruga_command ruga_remesh_command = {
    .name = "remesh",
    .operand = "MESH",
    .usage = "--edge L [--unit U] [--group NAME] -o MESH",
    .summary = "give a surface near-equilateral triangles of one size",
    .about = "Isotropic remeshing. Boundaries, sharp edges and borders of groups are kept; texture "
             "coordinates and\n"
             "groups are carried over. Eight edges or more per wrinkle wavelength are good: ruga explain "
             "says how\n"
             "long that is.",
    .example = "    ruga remesh sofa.obj --group seat --edge 8mm -o seat.obj",
    .options = options,
    .run = run,
};
