// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Isotropic remeshing after Botsch and Kobbelt, "A remeshing approach to multiresolution modeling" (2004), as
// CGAL has it: split edges above 4/3 L, collapse those below 4/5 L, flip towards valence 6, relax along the
// surface, project back. Lines of mesh/features.c are split and collapsed along themselves only.
//
// Lines that are close to one another at the scale of L leave slivers between them, and a coarse mesh of a
// thin fold may cross itself. So the remeshing is tried with all lines, then with fewer, and judged: the
// first try without new crossings, with all angles above 15 degrees and the volume kept within 1 % is taken;
// or else the one among those without new crossings and with the volume kept whose angles are clearly better.
#include "mesh/remesh.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/cgal_shim.h"
#include "mesh/doctor.h"
#include "mesh/features.h"
#include "mesh/transfer.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { ITERATIONS = 10, RELAXATIONS = 3, MOST_TRIES = 3 };
static const double most_faces = 20e6;
// The lengths that remain between 4/5 L and 4/3 L have a mean of about 0.92 L: the L that gives the mean
// wanted.
static const double length_for_mean = 1.08;
static const double good_spread = 0.2; // rms of log(length / edge); 0.15 where all goes well
static const double good_angle = 15 * RUGA_PI / 180;
static const double clearly_better = 2; // times the angle
static const double volume_cost = 0.03; // of the volume, over twice what the first try changed

typedef struct attempt {
    ruga_mesh mesh;
    bool sound;
    double volume_error; // of the volume
    double angle;
    int crossings;
    double crossing_at[3]; // the first
} attempt;

// What is wrong with the input; `report` describes it.
static ruga_status check_input(const ruga_mesh* mesh, double edge, ruga_check_report* report) {
    if (!(edge > 0) || !isfinite(edge)) {
        return ruga_fail(RUGA_BAD_INPUT, "remesh: the edge length %g m must be a number above zero", edge);
    }
    RUGA_TRY(ruga_mesh_check(mesh, RUGA_CHECK_SHELL, report));
    // Faces that cross do not hinder: they are remeshed where they are.
    if (report->error_count > report->count[RUGA_DEFECT_SELF_INTERSECTION]) {
        return ruga_fail_prefix(ruga_check_status(report, "the mesh"), "remesh");
    }
    double expected = report->area / (sqrt(3) / 4 * edge * edge);
    double size = ruga_distance(report->min, report->max);
    if (edge > 0.5 * size || expected < 4) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "remesh: an edge of %g m is too long for a mesh of %g m: give a shorter edge", edge,
                         size);
    }
    if (expected > most_faces) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "remesh: an edge of %g m would give about %.3g faces, more than %.3g: give a longer edge", edge,
            expected, most_faces);
    }
    return RUGA_OK;
}

// Groups of the new faces: a patch lies within one group.
static ruga_status name_groups(const ruga_mesh* mesh, const ruga_features* features, const int* patch,
                               ruga_mesh* remeshed) {
    if (!mesh->face_group) {
        return RUGA_OK;
    }
    int* group = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(group, features->patch_count));
    RUGA_TRY_DONE(RUGA_NEW(remeshed->face_group, remeshed->triangle_count));
    for (int f = 0; f < mesh->triangle_count; f++) {
        group[features->patch[f]] = mesh->face_group[f];
    }
    for (int f = 0; f < remeshed->triangle_count; f++) {
        remeshed->face_group[f] = group[patch[f]];
    }
    RUGA_TRY_DONE(RUGA_NEW_ZERO(remeshed->group_name, mesh->group_count));
    remeshed->group_count = mesh->group_count;
    for (int g = 0; g < mesh->group_count; g++) {
        remeshed->group_name[g] = ruga_copy_string(mesh->group_name[g]);
        if (!remeshed->group_name[g]) {
            status = ruga_fail(RUGA_NO_MEMORY, "out of memory: name of group %d", g);
            goto done;
        }
    }
done:
    ruga_release(group);
    return status;
}

static ruga_status read_back(const ruga_cgal_surface* surface, ruga_mesh* remeshed, int** patch) {
    remeshed->vertex_count = ruga_cgal_surface_vertex_count(surface);
    remeshed->triangle_count = ruga_cgal_surface_triangle_count(surface);
    RUGA_TRY(RUGA_NEW(remeshed->position, 3 * (size_t)remeshed->vertex_count));
    RUGA_TRY(RUGA_NEW(remeshed->triangle, 3 * (size_t)remeshed->triangle_count));
    RUGA_TRY(RUGA_NEW(*patch, remeshed->triangle_count));
    return ruga_cgal_surface_get(surface, remeshed->position, remeshed->triangle, *patch);
}

// Remeshes with the length corrected until the edges are close enough to the one wanted; the closest outcome
// is handed back. Lengths within 4/5 and 4/3 of the target are left alone, so that a regular old mesh may end
// with edges 20 % too long or stay too short; half of the correction is made, lest it jump to and fro.
static ruga_status remesh_to_edge(const ruga_cgal_surface_def* def, double edge,
                                  ruga_cgal_surface** closest) {
    double length = length_for_mean * edge;
    double least_spread = DBL_MAX;
    for (int tries = 0; tries < MOST_TRIES && least_spread > good_spread; tries++) {
        ruga_cgal_surface* surface = NULL;
        double mean = edge;
        double spread = DBL_MAX;
        RUGA_TRY(ruga_cgal_surface_create(def, &surface));
        ruga_status status = ruga_cgal_surface_remesh(surface, length, ITERATIONS, RELAXATIONS);
        if (status == RUGA_OK) {
            ruga_cgal_surface_edges(surface, edge, &mean, &spread);
        }
        if (spread < least_spread) {
            ruga_cgal_surface* further = *closest;
            *closest = surface;
            surface = further;
            least_spread = spread;
        }
        ruga_cgal_surface_destroy(&surface);
        RUGA_TRY(status);
        length *= sqrt(edge / mean);
    }
    return RUGA_OK;
}

// One remeshing along the given lines, with all that is carried over.
static ruga_status remesh_once(const ruga_mesh* mesh, const ruga_features* features, double edge,
                               ruga_mesh* remeshed) {
    ruga_cgal_surface* surface = NULL;
    int* patch = NULL;
    ruga_cgal_surface_def def = {
        .vertex_count = mesh->vertex_count,
        .position = mesh->position,
        .fixed = features->corner,
        .triangle_count = mesh->triangle_count,
        .triangle = mesh->triangle,
        .patch = features->patch,
        .feature_count = features->edge_count,
        .feature = (const int(*)[2])features->edge,
    };
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(remesh_to_edge(&def, edge, &surface));
    RUGA_TRY_DONE(read_back(surface, remeshed, &patch));
    RUGA_TRY_DONE(name_groups(mesh, features, patch, remeshed));
    RUGA_TRY_DONE(ruga_mesh_transfer(mesh, edge, remeshed));
done:
    ruga_cgal_surface_destroy(&surface);
    ruga_release(patch);
    return status;
}

static ruga_status judge(const ruga_check_report* before, const attempt* best, attempt* made) {
    ruga_check_report after;
    RUGA_TRY(ruga_mesh_check(&made->mesh, RUGA_CHECK_SHELL, &after));
    int crossings = after.count[RUGA_DEFECT_SELF_INTERSECTION];
    bool crossed_before = before->count[RUGA_DEFECT_SELF_INTERSECTION] > 0;
    made->volume_error = before->watertight ? fabs(after.volume / before->volume - 1) : 0;
    bool first = best->mesh.triangle_count == 0;
    bool volume_kept = first || made->volume_error <= volume_cost + 2 * best->volume_error;
    made->crossings = crossed_before ? 0 : crossings;
    for (int i = after.defect_count - 1; i >= 0; i--) {
        if (after.defect[i].kind == RUGA_DEFECT_SELF_INTERSECTION) {
            memcpy(made->crossing_at, after.defect[i].position, sizeof made->crossing_at);
        }
    }
    made->angle = after.angle_min;
    made->sound = made->crossings == 0 && after.error_count == crossings && volume_kept &&
                  after.watertight == before->watertight;
    ruga_check_report_clear(&after);
    return RUGA_OK;
}

// Whether `made` is to be kept in place of `best`.
static bool better(const attempt* made, const attempt* best) {
    if (best->mesh.triangle_count == 0 || made->sound != best->sound) {
        return best->mesh.triangle_count == 0 || made->sound;
    }
    return made->sound ? made->angle > clearly_better * best->angle : made->crossings < best->crossings;
}

// Remeshes along the given lines and keeps the outcome where it is the better one.
static ruga_status try_once(const ruga_mesh* mesh, const ruga_features* features, double edge,
                            const ruga_check_report* before, attempt* best) {
    attempt made = {0};
    ruga_status status = remesh_once(mesh, features, edge, &made.mesh);
    if (status == RUGA_OK) {
        status = judge(before, best, &made);
    }
    if (status == RUGA_OK && better(&made, best)) {
        attempt worse = *best;
        *best = made;
        made = worse;
    }
    ruga_mesh_clear(&made.mesh);
    return status;
}

// Tries with all lines, then with fewer. Without any sharp ones only where nothing else is sound.
static ruga_status try_lines(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double edge,
                             const ruga_check_report* before, attempt* best) {
    int lines_before = -1;
    for (int keep = RUGA_KEEP_ALL; keep >= RUGA_KEEP_FIRM; keep--) {
        ruga_features features = {0};
        if (best->sound && (best->angle >= good_angle || keep == RUGA_KEEP_FIRM)) {
            break;
        }
        RUGA_TRY(ruga_features_find(mesh, connectivity, edge, (ruga_keep)keep, &features));
        ruga_status status = RUGA_OK;
        if (features.edge_count != lines_before) { // each set of lines is a part of the one before
            status = try_once(mesh, &features, edge, before, best);
        }
        lines_before = features.edge_count;
        ruga_features_clear(&features);
        RUGA_TRY(status);
    }
    return RUGA_OK;
}

static ruga_status refuse(const attempt* best, double edge) {
    const double* p = best->crossing_at;
    if (best->crossings == 0) {
        return ruga_fail(
            RUGA_BAD_MESH,
            "remesh: an edge of %g m would leave faces without area or holes: give a shorter edge", edge);
    }
    return ruga_fail(
        RUGA_BAD_MESH,
        "remesh: with an edge of %g m, %d pairs of faces would cross, the first at (%.6g, %.6g, %.6g) m: "
        "give a shorter edge",
        edge, best->crossings, p[0], p[1], p[2]);
}

ruga_status ruga_mesh_remesh(const ruga_mesh* mesh, double edge, ruga_mesh* remeshed) {
    ruga_check_report report = {0};
    ruga_connectivity connectivity = {0};
    attempt best = {0};
    ruga_status status = RUGA_OK;
    *remeshed = (ruga_mesh){0};
    RUGA_TRY_DONE(check_input(mesh, edge, &report));
    RUGA_TRY_DONE(ruga_connectivity_create(mesh, &connectivity));
    // Whether chords cross in a narrow gap is a matter of where the vertices happen to fall: other lengths, a
    // little shorter, place them elsewhere.
    for (double shorter = 1; !best.sound && shorter > 0.85; shorter -= 0.04) {
        RUGA_TRY_DONE(try_lines(mesh, &connectivity, shorter * edge, &report, &best));
    }
    if (!best.sound) {
        status = refuse(&best, edge);
        goto done;
    }
    *remeshed = best.mesh;
    best.mesh = (ruga_mesh){0};
done:
    ruga_mesh_clear(&best.mesh);
    ruga_connectivity_clear(&connectivity);
    ruga_check_report_clear(&report);
    return status;
}
