// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga check: the mesh doctor's report.
#include "app/command.h"
#include "app/console.h"
#include "core/vec3.h"
#include "mesh/doctor.h"

static const char uses[] = "embedded|shell";

static const ruga_option options[] = {
    {"--group", "-g", "NAME", "only the faces of this group; may be given several times [all]", true},
    {"--as", NULL, uses, "embedded: the surface of a solid; shell: open edges are allowed [embedded]", false},
    {"--json", "-j", NULL, "print one JSON object", false},
    {0},
};

enum { PLACES_SHOWN = 5 };

// ---- for people ----------------------------------------------------------------------------------------

static void say_place(const ruga_arguments* arguments, const ruga_defect* d) {
    ruga_say(arguments, "       ");
    if (d->vertex[0] >= 0 && d->vertex[1] >= 0) {
        ruga_say(arguments, " edge %d-%d", d->vertex[0], d->vertex[1]);
    } else if (d->vertex[0] >= 0) {
        ruga_say(arguments, " vertex %d", d->vertex[0]);
    }
    if (d->face[0] >= 0 && d->face[1] >= 0) {
        ruga_say(arguments, " faces %d and %d", d->face[0], d->face[1]);
    } else if (d->face[0] >= 0) {
        ruga_say(arguments, " face %d", d->face[0]);
    }
    ruga_say(arguments, " at (%.6g, %.6g, %.6g)\n", d->position[0], d->position[1], d->position[2]);
}

static void say_kind(const ruga_arguments* arguments, const ruga_check_report* report, ruga_defect_kind kind,
                     ruga_severity severity) {
    int shown = 0, count = report->count[kind];
    for (int i = 0; i < report->defect_count; i++) {
        const ruga_defect* d = &report->defect[i];
        if (d->kind != kind || d->severity != severity) {
            continue;
        }
        if (shown == 0) {
            ruga_say(arguments, "    %s (%d): %s\n", ruga_defect_name(kind), count,
                     ruga_defect_sentence(kind));
        }
        if (kind != RUGA_DEFECT_NO_FACES && shown < PLACES_SHOWN) {
            say_place(arguments, d);
        }
        shown++;
    }
    if (shown > 0 && count > PLACES_SHOWN) {
        ruga_say(arguments, "        ... and %d more\n", count - PLACES_SHOWN);
    }
}

static void say_defects(const ruga_arguments* arguments, const ruga_check_report* report) {
    const ruga_severity severities[] = {RUGA_SEVERITY_ERROR, RUGA_SEVERITY_WARNING};
    for (int s = 0; s < 2; s++) {
        int count = s == 0 ? report->error_count : report->warning_count;
        ruga_say(arguments, "%s: %d\n", s == 0 ? "errors" : "warnings", count);
        for (int kind = 0; kind < RUGA_DEFECT_KINDS; kind++) {
            say_kind(arguments, report, (ruga_defect_kind)kind, severities[s]);
        }
    }
}

static void say_report(const ruga_arguments* arguments, const ruga_check_report* r) {
    ruga_say(arguments, "%s (lengths in the file's unit)\n", ruga_operand(arguments));
    ruga_say(arguments, "    vertices        %d\n    triangles       %d\n    edges           %d\n",
             r->vertex_count, r->triangle_count, r->edge_count);
    ruga_say(arguments, "    components      %d\n    watertight      %s\n", r->component_count,
             r->watertight ? "yes" : "no");
    if (r->genus >= 0) {
        ruga_say(arguments, "    genus           %d\n", r->genus);
    }
    ruga_say(arguments, "    area            %.6g\n", r->area);
    if (r->watertight) {
        ruga_say(arguments, "    volume          %.6g\n", r->volume);
    }
    ruga_say(arguments, "    size            %.6g x %.6g x %.6g, from (%.6g, %.6g, %.6g)\n",
             r->max[0] - r->min[0], r->max[1] - r->min[1], r->max[2] - r->min[2], r->min[0], r->min[1],
             r->min[2]);
    ruga_say(arguments, "    edge length     %.4g to %.4g, mean %.4g\n", r->edge_min, r->edge_max,
             r->edge_mean);
    ruga_say(arguments, "    smallest angle  %.3g deg\n", r->angle_min * 180 / RUGA_PI);
    say_defects(arguments, r);
}

// ---- for programs --------------------------------------------------------------------------------------

// [a, b] without those that are -1
static json_t* number_pair(const int pair[2]) {
    json_t* list = json_array();
    for (int i = 0; i < 2; i++) {
        if (pair[i] >= 0) {
            (void)json_array_append_new(list, json_integer(pair[i]));
        }
    }
    return list;
}

static json_t* kind_json(const ruga_check_report* report, ruga_defect_kind kind, ruga_severity severity) {
    json_t* places = json_array();
    for (int i = 0; i < report->defect_count; i++) {
        const ruga_defect* d = &report->defect[i];
        if (d->kind == kind && d->severity == severity) {
            (void)json_array_append_new(
                places, json_pack("{s:o, s:o, s:o}", "vertices", number_pair(d->vertex), "faces",
                                  number_pair(d->face), "position", ruga_json_vector(d->position)));
        }
    }
    if (json_array_size(places) == 0) {
        json_decref(places);
        return NULL;
    }
    return json_pack("{s:s, s:s, s:i, s:s, s:o}", "kind", ruga_defect_name(kind), "severity",
                     severity == RUGA_SEVERITY_ERROR ? "error" : "warning", "count", report->count[kind],
                     "meaning", ruga_defect_sentence(kind), "places", places);
}

static json_t* report_json(const ruga_check_report* r) {
    json_t* defects = json_array();
    const ruga_severity severities[] = {RUGA_SEVERITY_ERROR, RUGA_SEVERITY_WARNING};
    for (int s = 0; s < 2; s++) {
        for (int kind = 0; kind < RUGA_DEFECT_KINDS; kind++) {
            json_t* one = kind_json(r, (ruga_defect_kind)kind, severities[s]);
            if (one) {
                (void)json_array_append_new(defects, one);
            }
        }
    }
    json_t* genus = r->genus >= 0 ? json_integer(r->genus) : json_null();
    return json_pack(
        "{s:i, s:i, s:i, s:i, s:b, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:i, s:i, s:b}",
        "vertices", r->vertex_count, "triangles", r->triangle_count, "edges", r->edge_count, "components",
        r->component_count, "watertight", r->watertight, "genus", genus, "area", ruga_json_number(r->area),
        "volume", r->watertight ? ruga_json_number(r->volume) : json_null(), "min", ruga_json_vector(r->min),
        "max", ruga_json_vector(r->max), "edge_min", ruga_json_number(r->edge_min), "edge_mean",
        ruga_json_number(r->edge_mean), "edge_max", ruga_json_number(r->edge_max), "angle_min",
        ruga_json_number(r->angle_min), "defects", defects, "errors", r->error_count, "warnings",
        r->warning_count, "ok", r->error_count == 0);
}

// ---- the command ---------------------------------------------------------------------------------------

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    ruga_mesh mesh = {0};
    ruga_check_report report = {0};
    int use = 0, group_count;
    RUGA_TRY(ruga_option_choice(arguments, "--as", uses, &use));
    const char* const* groups = ruga_values(arguments, "--group", &group_count);
    RUGA_TRY(ruga_read_surface(ruga_operand(arguments), group_count, groups, &mesh));
    RUGA_TRY_DONE(ruga_mesh_check(&mesh, use == 0 ? RUGA_CHECK_EMBEDDED : RUGA_CHECK_SHELL, &report));
    if (ruga_given(arguments, "--json")) {
        RUGA_TRY_DONE(ruga_print_json(report_json(&report)));
    } else {
        say_report(arguments, &report);
    }
    status = ruga_check_status(&report, ruga_operand(arguments));
done:
    ruga_check_report_clear(&report);
    ruga_mesh_clear(&mesh);
    return status;
}

const ruga_command ruga_check_command = {
    .name = "check",
    .operand = "MESH",
    .usage = "[--group NAME] [--as embedded|shell] [--json]",
    .summary = "examine a surface for what would keep it from being simulated",
    .about = "Prints the surface's size and every kind of defect with its places (vertices and faces count "
             "from 0).\n"
             "Exit status 2 where a defect makes it unfit for the use: holes, edges of more than two faces, "
             "flipped,\n"
             "duplicate or flat faces, crossings. Slivers, unused vertices and the like are warnings.",
    .example = "    ruga check sofa.obj --group seat",
    .options = options,
    .run = run,
};
