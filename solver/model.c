// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// From a def to a model: checks every field, copies what it keeps, builds lattice, constraints and loads.
#include "solver/model.h"

#include "core/memory.h"
#include "core/progress.h"
#include "core/vec3.h"
#include "mesh/doctor.h"
#include "shell/shell.h"
#include "solver/anchor.h"
#include "solver/stages.h"
#include "solver/start.h"

#include <math.h>
#include <string.h>

// ---- checks --------------------------------------------------------------------------------------------

static ruga_status require(bool holds, const char* field, double value, const char* rule) {
    return holds ? RUGA_OK : ruga_fail(RUGA_BAD_INPUT, "%s is %g; it must be %s", field, value, rule);
}

static bool positive(double value) {
    return value > 0 && isfinite(value);
}

// What only a free skin in dynamic motion has, and what that has not.
static ruga_status check_motion(const ruga_model_def* def) {
    const ruga_skin_def* s = &def->skin;
    const char* trouble = NULL;
    if (s->motion != RUGA_SKIN_DYNAMIC) {
        const ruga_start_def* start = &def->start;
        if (def->has_interior && start->fold != 0) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "start.fold: needs interior: none; a skin starts on its interior");
        }
        bool started = start->cone != 0 || ruga_norm(start->velocity) > 0 || ruga_norm(start->spin) > 0;
        if (s->creases != RUGA_CREASE_ANGLE) {
            return ruga_fail(RUGA_BAD_INPUT, "skin.creases: springs in place of angles need motion: dynamic");
        }
        return s->model == RUGA_SKIN_SPRINGS
                   ? ruga_fail(RUGA_BAD_INPUT, "skin.model: springs needs motion: dynamic")
               : started ? ruga_fail(RUGA_BAD_INPUT, "start: cone, velocity and spin need skin.motion: "
                                                     "dynamic; a static skin starts at rest")
                         : RUGA_OK;
    }
    if (def->has_interior) {
        trouble = "needs interior: none";
    } else if (s->model == RUGA_SKIN_VOLUME) {
        trouble = "goes with model: shell or springs";
    } else if (s->bending != RUGA_BENDING_HINGE) {
        trouble = "knows bending: hinge only";
    } else if (s->vertex_thickness || s->vertex_young || s->vertex_growth || s->growth[0] != 1 ||
               s->growth[1] != 1) {
        trouble = "knows one thickness and modulus and no growth yet";
    }
    if (trouble) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.motion: dynamic %s", trouble);
    }
    RUGA_TRY(require(positive(s->density), "skin.density", s->density, "above 0 where the skin moves"));
    RUGA_TRY(require(s->damping >= 0 && isfinite(s->damping), "skin.damping", s->damping, "0 or above"));
    RUGA_TRY(require(s->drag >= 0 && isfinite(s->drag), "skin.drag", s->drag, "0 or above"));
    RUGA_TRY(require(isfinite(ruga_norm(def->start.velocity)), "start.velocity",
                     ruga_norm(def->start.velocity), "finite"));
    RUGA_TRY(
        require(isfinite(ruga_norm(def->start.spin)), "start.spin", ruga_norm(def->start.spin), "finite"));
    return require(def->start.cone >= 0 && def->start.cone < 2 * RUGA_PI, "start.cone", def->start.cone,
                   "between 0 and a whole turn");
}

static ruga_status check_material(const ruga_model_def* def) {
    const ruga_skin_def* s = &def->skin;
    const ruga_interior_def* q = &def->interior;
    RUGA_TRY(
        require(s->vertex_thickness || positive(s->thickness), "skin.thickness", s->thickness, "above 0"));
    RUGA_TRY(require(s->vertex_young || positive(s->young), "skin.young", s->young, "above 0"));
    RUGA_TRY(require(s->poisson > -1 && s->poisson < 0.5, "skin.poisson", s->poisson, "between -1 and 0.5"));
    RUGA_TRY(require(s->density >= 0 && isfinite(s->density), "skin.density", s->density, "0 or above"));
    for (int i = 0; i < 2 && !s->vertex_growth; i++) {
        RUGA_TRY(require(positive(s->growth[i]), "skin.growth", s->growth[i], "above 0"));
    }
    RUGA_TRY(require(isfinite(def->start.fold), "start.fold", def->start.fold, "finite"));
    if (def->start.fold != 0 && def->crease_count == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "start.fold: there are no creases to fold about");
    }
    RUGA_TRY(check_motion(def));
    RUGA_TRY(require(s->motion != RUGA_SKIN_DAMPED || positive(s->relaxation), "skin.relaxation",
                     s->relaxation, "above 0"));
    if (!def->has_interior) {
        return RUGA_OK;
    }
    RUGA_TRY(require(positive(q->young), "interior.young", q->young, "above 0"));
    RUGA_TRY(
        require(q->poisson > -1 && q->poisson < 0.5, "interior.poisson", q->poisson, "between -1 and 0.5"));
    RUGA_TRY(require(q->damping >= 0 && isfinite(q->damping), "interior.damping", q->damping, "0 or above"));
    bool massive = q->motion != RUGA_INTERIOR_DYNAMIC || q->density > 0;
    return require(massive && q->density >= 0 && isfinite(q->density), "interior.density", q->density,
                   "above 0 (0 is allowed where the motion is not dynamic)");
}

static ruga_status check_numbers(const ruga_model_def* def) {
    const ruga_coupling_def* c = &def->coupling;
    RUGA_TRY(require(positive(def->step), "time.step", def->step, "above 0"));
    RUGA_TRY(require(def->frames >= 1, "time.frames", def->frames, "1 or above"));
    RUGA_TRY(require(positive(def->solver.tolerance) && def->solver.tolerance <= 0.1, "solver.tolerance",
                     def->solver.tolerance, "above 0 and at most 0.1"));
    RUGA_TRY(require(isfinite(ruga_norm(def->gravity)), "gravity", ruga_norm(def->gravity), "finite"));
    if (!def->has_interior) {
        return RUGA_OK;
    }
    RUGA_TRY(require(def->lattice.cells >= 1 && def->lattice.cells <= 1000, "lattice.cells",
                     def->lattice.cells, "between 1 and 1000"));
    RUGA_TRY(require(def->lattice.degree == 1 || def->lattice.degree == 2, "lattice.degree",
                     def->lattice.degree, "1 or 2"));
    RUGA_TRY(require(def->lattice.depth >= 0 && isfinite(def->lattice.depth), "lattice.depth",
                     def->lattice.depth, "0 or above"));
    RUGA_TRY(require(c->count >= 0 && c->count <= def->mesh.vertex_count, "coupling.count", c->count,
                     "between 0 and the number of vertices"));
    RUGA_TRY(require(c->radius >= 0 && isfinite(c->radius), "coupling.radius", c->radius, "0 or above"));
    RUGA_TRY(require(c->sigma >= 0 && isfinite(c->sigma), "coupling.sigma", c->sigma, "0 or above"));
    RUGA_TRY(require(def->interior.motion != RUGA_INTERIOR_PRESCRIBED || def->keyframe_count > 0 ||
                         def->follow.sample_count > 0,
                     "the number of prescribed keyframes", def->keyframe_count, "1 or above"));
    RUGA_TRY(require(def->follow.sample_count == 0 || def->keyframe_count == 0,
                     "the number of prescribed keyframes", def->keyframe_count,
                     "0 where a surface is followed"));
    for (int k = 1; k < def->keyframe_count; k++) {
        RUGA_TRY(require(def->keyframes[k].time > def->keyframes[k - 1].time, "prescribed time",
                         def->keyframes[k].time, "above that of the keyframe before"));
    }
    return RUGA_OK;
}

// What a skin with creases cannot do.
static ruga_status check_creases(const ruga_model_def* def) {
    const ruga_skin_def* skin = &def->skin;
    const char* trouble = NULL;
    if (def->crease_count == 0) {
        return RUGA_OK;
    }
    if (skin->model == RUGA_SKIN_VOLUME) {
        trouble = "skin.model: volume has no shell to crease";
    } else if (skin->bending != RUGA_BENDING_HINGE) {
        trouble = "skin.bending: kirchhoff-love has one rotation for a whole edge, which creases divide; "
                  "write hinge";
    } else if (def->solver.method == RUGA_METHOD_PAPER) {
        trouble = "solver.method: paper is the published method, which knows no creases";
    } else if (def->has_interior && def->coupling.kind == RUGA_COUPLING_NONE && !def->coupling.foundation) {
        trouble = "with coupling.kind: none and no foundation the skin goes where the interior takes it";
    }
    return trouble ? ruga_fail(RUGA_BAD_INPUT, "creases: %s", trouble) : RUGA_OK;
}

static ruga_status check_mesh(const ruga_model* model) {
    ruga_check_report report;
    bool embedded = model->has_interior && model->lattice_def.fill == RUGA_FILL_MESH;
    RUGA_TRY(ruga_mesh_check(&model->mesh, embedded ? RUGA_CHECK_EMBEDDED : RUGA_CHECK_SHELL, &report));
    ruga_status status = ruga_check_status(&report, "the mesh");
    ruga_check_report_clear(&report);
    return status;
}

// ---- copies --------------------------------------------------------------------------------------------

static ruga_status copy_handles(const ruga_model_def* def, ruga_model* model) {
    RUGA_TRY(RUGA_NEW_ZERO(model->handles, def->handle_count + 1));
    model->handles[def->handle_count] = ruga_default_handle_def(); // of solver/anchor.c
    model->handle_count = def->handle_count;
    for (int i = 0; i < def->handle_count; i++) {
        ruga_handle_def* handle = &model->handles[i];
        *handle = def->handles[i];
        ruga_region* region = &handle->region;
        const char* group = region->group;
        const int* vertices = region->vertices;
        region->group = NULL;
        region->vertices = NULL;
        if (group) {
            region->group = ruga_copy_string(group);
            if (!region->group) {
                return ruga_fail(RUGA_NO_MEMORY, "out of memory");
            }
        }
        if (vertices) {
            int* copy;
            RUGA_TRY(RUGA_NEW(copy, region->vertex_count));
            memcpy(copy, vertices, (size_t)region->vertex_count * sizeof *copy);
            region->vertices = copy;
        }
    }
    return RUGA_OK;
}

static ruga_status copy_def(const ruga_model_def* def, ruga_model* model) {
    model->skin = def->skin;
    model->has_interior = def->has_interior;
    model->interior = def->interior;
    model->lattice_def = def->lattice;
    model->coupling = def->coupling;
    model->solver = def->solver;
    model->step = def->step;
    model->frames = def->frames;
    memcpy(model->gravity, def->gravity, sizeof model->gravity);
    model->start = def->start;
    if (model->solver.method == RUGA_METHOD_DEFAULT) {
        model->solver.method = RUGA_METHOD_QUASI_NEWTON;
    }
    RUGA_TRY(ruga_mesh_from_def(&def->mesh, &model->mesh));
    RUGA_TRY(RUGA_NEW(model->keyframes, def->keyframe_count));
    for (int k = 0; k < def->keyframe_count; k++) {
        model->keyframes[k] = def->keyframes[k];
    }
    model->keyframe_count = def->keyframe_count;
    return copy_handles(def, model);
}

// ---- building ------------------------------------------------------------------------------------------

// Cuts the mesh: the sheet is the creases' own from now on, and the mesh that of nodes and pieces.
static ruga_status build_creases(const ruga_model_def* def, const int* stage, int now, ruga_model* model) {
    ruga_mesh nodes = {0};
    RUGA_TRY(ruga_progress("cutting along creases", 0));
    RUGA_TRY(ruga_variation_carry(&def->skin, &model->mesh));
    RUGA_TRY(ruga_creases_create(def->crease_count, def->creases, stage, now, &model->mesh,
                                 &model->connectivity, &model->creases));
    RUGA_TRY(ruga_creases_nodes(model->creases, &nodes));
    ruga_mesh_clear(&model->mesh);
    ruga_connectivity_clear(&model->connectivity);
    model->mesh = nodes;
    model->sheet = &model->creases->raster.mesh;
    RUGA_TRY(ruga_connectivity_create(model->sheet, &model->connectivity));
    ruga_release(model->vertex_area);
    RUGA_TRY(RUGA_NEW(model->vertex_area, nodes.vertex_count));
    memcpy(model->vertex_area, model->creases->area, (size_t)nodes.vertex_count * sizeof *model->vertex_area);
    RUGA_TRY(ruga_variation_create_cut(&def->skin, model));
    const ruga_shell_material material = {.skin = model->skin,
                                          .thickness = model->variation.triangle_thickness,
                                          .young = model->variation.triangle_young};
    ruga_creases_set_bending(model->creases, &material);
    return RUGA_OK;
}

static ruga_status build_mesh(ruga_model* model) {
    double min[3], max[3];
    RUGA_TRY(ruga_progress("checking the mesh", 0));
    RUGA_TRY(check_mesh(model));
    RUGA_TRY(ruga_connectivity_create(&model->mesh, &model->connectivity));
    ruga_mesh_bounds(&model->mesh, min, max);
    for (int i = 0; i < 3; i++) {
        model->center[i] = 0.5 * (min[i] + max[i]);
    }
    model->extent = ruga_distance(min, max);
    model->mean_edge = ruga_mesh_mean_edge(&model->mesh);
    model->sheet = &model->mesh;
    RUGA_TRY(RUGA_NEW(model->vertex_area, model->mesh.vertex_count));
    ruga_mesh_vertex_areas(&model->mesh, model->vertex_area);
    return RUGA_OK;
}

static void hold_node(ruga_model* model, int node, int h) {
    for (int axis = 0; axis < 3; axis++) {
        int* holder = &model->skin_handle[3 * (size_t)node + (size_t)axis];
        if (model->handles[h].axes[axis] && *holder < 0) {
            *holder = h;
            model->any_skin_held = true;
        }
    }
}

// Whether a place of a piece is in the handle's region: a vertex that it selects, or a point between two of
// these, or one that it contains.
static bool place_is_in(const ruga_model* model, const ruga_cut_piece* piece, int place, int h,
                        const bool* in) {
    const ruga_cut* cut = &model->creases->cut;
    int i = place / 2;
    if (place % 2 == 0) {
        return in[cut->source[piece->node[i]]];
    }
    const double* x = cut->material.position + 3 * (size_t)ruga_cut_vertex(cut, piece, place);
    return (in[cut->source[piece->node[i]]] && in[cut->source[piece->node[(i + 1) % 3]]]) ||
           ruga_region_contains_within(&model->handles[h].region, x, ruga_region_slack(model->sheet));
}

// A copy of a selected vertex is held where its piece has a vertex in the region itself; a piece that lies in
// the region as a whole is held as a whole. So a crease across the rim of a region is held from both sides,
// and one that bounds a region can turn.
static void hold_pieces(ruga_model* model, int h, const bool* in) {
    const ruga_cut* cut = &model->creases->cut;
    for (int p = 0; p < cut->piece_count; p++) {
        const ruga_cut_piece* piece = &cut->piece[p];
        bool any = false, all = true;
        for (int k = 0; k < piece->polygon.count; k++) {
            bool inside = place_is_in(model, piece, piece->polygon.place[k], h, in);
            any = any || (inside && piece->polygon.place[k] % 2 == 0);
            all = all && inside;
        }
        for (int i = 0; i < 3; i++) {
            if (all || (any && in[cut->source[piece->node[i]]])) {
                hold_node(model, piece->node[i], h);
            }
        }
    }
}

static void hold_selected(ruga_model* model, int h, int count, const int* selected, bool* in) {
    if (!model->creases) {
        for (int k = 0; k < count; k++) {
            hold_node(model, selected[k], h);
        }
        return;
    }
    memset(in, 0, (size_t)model->sheet->vertex_count * sizeof *in);
    for (int k = 0; k < count; k++) {
        in[selected[k]] = true;
    }
    hold_pieces(model, h, in);
}

// Which handle holds which component of the skin; the first one wins.
static ruga_status build_skin_holds(ruga_model* model) {
    ruga_status status = RUGA_OK;
    int nodes = model->mesh.vertex_count, *selected = NULL;
    bool* in = NULL;
    RUGA_TRY(RUGA_NEW(model->skin_handle, 3 * (size_t)nodes));
    memset(model->skin_handle, -1, 3 * (size_t)nodes * sizeof *model->skin_handle);
    RUGA_TRY_DONE(RUGA_NEW(selected, model->sheet->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(in, model->sheet->vertex_count));
    for (int h = 0; h < model->handle_count; h++) {
        const ruga_handle_def* handle = &model->handles[h];
        int count;
        bool holds = handle->kind == RUGA_HANDLE_FIX || handle->kind == RUGA_HANDLE_MOVE;
        if (!holds || (handle->hold == RUGA_HOLD_INTERIOR && model->has_interior)) {
            continue;
        }
        RUGA_TRY_DONE(ruga_region_vertices(&handle->region, model->sheet, &count, selected));
        if (count == 0 && (handle->hold == RUGA_HOLD_SKIN || !model->has_interior)) {
            status = ruga_fail(RUGA_BAD_INPUT, "handles.%d: the region selects no vertex of the skin", h);
            goto done;
        }
        hold_selected(model, h, count, selected, in);
    }
done:
    ruga_release(selected);
    ruga_release(in);
    return status;
}

static ruga_status build_loads(ruga_model* model) {
    const ruga_creases* creases = model->creases;
    if (!creases) {
        return ruga_loads_create(&model->mesh, &model->connectivity, model->handle_count, model->handles,
                                 &model->loads);
    }
    ruga_load_place(*place)[3] = NULL;
    RUGA_TRY(ruga_creases_places(creases, &place));
    ruga_status status =
        ruga_loads_create_placed(&creases->cut.material, &creases->shown, (const ruga_load_place(*)[3])place,
                                 model->handle_count, model->handles, &model->loads);
    ruga_release(place);
    return status;
}

static ruga_status build_clusters(ruga_model* model) {
    ruga_coupling_def* c = &model->coupling;
    double radius, sigma;
    ruga_clusters_rule(c->rule, model->wavelength, &radius, &sigma);
    c->radius = c->radius > 0 ? c->radius : radius;
    c->sigma = c->sigma > 0 ? c->sigma : sigma;
    RUGA_TRY(ruga_progress("placing clusters", 0));
    RUGA_TRY(ruga_clusters_create_local(model->sheet, &model->connectivity, c->radius, c->sigma,
                                        model->variation.scale, c->count, model->solver.seed,
                                        &model->clusters));
    c->count = model->clusters.count;
    if (c->kind == RUGA_COUPLING_SPECTRAL) {
        ruga_clusters_clear(&model->clusters);
        RUGA_TRY(ruga_progress("finding Laplacian eigenvectors", 0));
        RUGA_TRY(
            ruga_clusters_create_spectral(model->sheet, &model->connectivity, c->count, &model->clusters));
    }
    return RUGA_OK;
}

// a = E*_q k / 4, b = E*_q / (4 k), k = 2 pi / lambda.
static double foundation_a(double modulus, double wavelength) {
    double k = 2 * RUGA_PI / wavelength;
    return modulus * k / 4;
}

static double foundation_b(double modulus, double wavelength) {
    double k = 2 * RUGA_PI / wavelength;
    return modulus / (4 * k);
}

static ruga_status build_local_foundation(ruga_model* model, double modulus) {
    ruga_status status = RUGA_OK;
    double *a = NULL, *b = NULL;
    int vertices = model->mesh.vertex_count;
    RUGA_TRY_DONE(RUGA_NEW(a, vertices));
    RUGA_TRY_DONE(RUGA_NEW(b, vertices));
    for (int v = 0; v < vertices; v++) {
        a[v] = foundation_a(modulus, model->variation.wavelength[v]);
        b[v] = foundation_b(modulus, model->variation.wavelength[v]);
    }
    RUGA_TRY_DONE(ruga_foundation_create_local(&model->mesh, &model->connectivity, a, b, &model->foundation));
done:
    ruga_release(a);
    ruga_release(b);
    return status;
}

// On the pieces: springs by the area of material at each node, the rest by its part of each triangle.
static ruga_status build_pieces_foundation(ruga_model* model, double modulus) {
    ruga_status status = RUGA_OK;
    const ruga_creases* creases = model->creases;
    const double* local = model->variation.wavelength;
    int nodes = model->mesh.vertex_count, pieces = model->mesh.triangle_count;
    ruga_connectivity edges = {0};
    double *a = NULL, *b = NULL;
    RUGA_TRY_DONE(RUGA_NEW(a, nodes));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(b, pieces));
    for (int n = 0; n < nodes; n++) {
        a[n] = foundation_a(modulus, local ? local[n] : model->wavelength);
    }
    for (int p = 0; p < pieces; p++) {
        for (int i = 0; i < 3; i++) {
            double wavelength = local ? local[model->mesh.triangle[3 * p + i]] : model->wavelength;
            b[p] += creases->cut.piece[p].fraction * foundation_b(modulus, wavelength) / 3;
        }
    }
    RUGA_TRY_DONE(ruga_creases_edges(&model->mesh, &edges));
    RUGA_TRY_DONE(
        ruga_foundation_create_pieces(&model->mesh, &edges, creases->area, a, b, &model->foundation));
done:
    ruga_connectivity_clear(&edges);
    ruga_release(a);
    ruga_release(b);
    return status;
}

static ruga_status build_foundation(ruga_model* model) {
    double nu = model->interior.poisson, modulus = model->interior.young / (1 - nu * nu);
    model->foundation_a = foundation_a(modulus, model->wavelength);
    model->foundation_b = foundation_b(modulus, model->wavelength);
    if (model->creases) {
        return build_pieces_foundation(model, modulus);
    }
    if (model->variation.wavelength) {
        return build_local_foundation(model, modulus);
    }
    return ruga_foundation_create(&model->mesh, &model->connectivity, model->foundation_a,
                                  model->foundation_b, &model->foundation);
}

static ruga_status build_coupling(ruga_model* model) {
    RUGA_TRY(ruga_variation_wavelengths(model));
    const ruga_coupling_def* c = &model->coupling;
    model->solves_skin =
        model->skin.model != RUGA_SKIN_VOLUME && (c->kind != RUGA_COUPLING_NONE || c->foundation);
    if (!model->solves_skin) {
        return RUGA_OK;
    }
    if (model->edges < 3 && !model->solver.allow_coarse) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "the mesh has %.3g edges per wrinkle wavelength (mean edge %.4g m, wavelength %.4g m), at "
            "least 3 are needed and 8 are good: remesh with edge %.3g m, or set solver.allow_coarse",
            model->edges, model->mean_edge, model->edges_wavelength, model->edges_wavelength / 8);
    }
    if (c->kind != RUGA_COUPLING_NONE) {
        RUGA_TRY(build_clusters(model));
    }
    if (c->foundation) {
        RUGA_TRY(build_foundation(model));
    }
    return RUGA_OK;
}

static ruga_status build_interior(const ruga_model_def* def, ruga_model* model) {
    RUGA_TRY(ruga_progress("building the lattice", 0));
    RUGA_TRY(ruga_lattice_create(model->sheet, &model->connectivity, &model->lattice_def, &model->lattice));
    RUGA_TRY(
        ruga_rows_create(&model->lattice, model->sheet, model->handle_count, model->handles, &model->rows));
    if (ruga_model_is_prescribed(model)) { // only to see that each region is somewhere
        ruga_rows_clear(&model->rows);
    }
    if (model->creases) {
        RUGA_TRY(ruga_lattice_copy_vertices(&model->lattice, model->mesh.vertex_count,
                                            model->creases->cut.source));
    }
    if (ruga_model_is_prescribed(model) && def->follow.sample_count > 0) {
        if (model->creases) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "follow: a mesh that is cut by creases cannot follow a moving surface");
        }
        RUGA_TRY(ruga_follow_create(&model->lattice, &model->mesh, model->vertex_area, &def->follow,
                                    &model->follow));
    }
    return build_coupling(model);
}

static ruga_status build_dense(ruga_model* model, double depth) {
    ruga_dense_def def = {.skin = &model->skin,
                          .interior = &model->interior,
                          .cells = model->lattice_def.cells,
                          .degree = model->lattice_def.degree,
                          .depth = depth > 0 ? depth : 2 * model->wavelength};
    double cells = model->wavelength / (ruga_dense_side(&model->mesh) / def.cells);
    if (cells < 4 && !model->solver.allow_coarse) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "the volume has %.2g cells per wrinkle wavelength (%.4g m), at least 4 are needed and 16 are "
            "good: give more lattice.cells, or set solver.allow_coarse",
            cells, model->wavelength);
    }
    RUGA_TRY(ruga_progress("building the volume", 0));
    return ruga_dense_create(&model->mesh, &def, &model->dense);
}

double ruga_model_force_floor(const ruga_model* model) {
    // A strain's round-off is that of positions over edges, so a nodal force has that of E h times the
    // extent; a stiff hinge's angle has that of positions over the distance to the crease.
    double stiffness = model->skin.young * model->skin.thickness;
    double answer = stiffness * sqrt(3.0 * model->mesh.vertex_count) + (model->creases ? model->creases->answer : 0);
    double round_off = 0.25 * 0x1p-52 * model->extent * answer;
    return fmax(1e-8 * model->mean_edge * stiffness, round_off / model->solver.tolerance);
}

bool ruga_model_is_prescribed(const ruga_model* model) {
    return model->has_interior && model->interior.motion == RUGA_INTERIOR_PRESCRIBED;
}

// With the creases that have come at stage `now`, of [creases]; `before` is the model of the stage before, or
// NULL.
static ruga_status create_stage(const ruga_model_def* def, const int* stage, int now,
                                const ruga_model* before, ruga_model** out) {
    ruga_status status = RUGA_OK;
    ruga_model* model = NULL;
    *out = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(model, 1));
    RUGA_TRY_DONE(copy_def(def, model));
    if (model->skin.model == RUGA_SKIN_VOLUME) {
        model->lattice_def.depth = 0; // the lattice only carries the surface along: one layer will do
    }
    RUGA_TRY_DONE(build_mesh(model));
    RUGA_TRY_DONE(def->crease_count > 0 ? build_creases(def, stage, now, model)
                                        : ruga_variation_create(&def->skin, model));
    RUGA_TRY_DONE(before ? ruga_stage_follow(model, before) : ruga_start_create(model));
    RUGA_TRY_DONE(build_skin_holds(model));
    if (before) {
        ruga_stage_release_holds(model, before);
    }
    RUGA_TRY_DONE(build_loads(model));
    if (model->has_interior) {
        RUGA_TRY_DONE(build_interior(def, model));
        if (model->skin.model == RUGA_SKIN_VOLUME) {
            RUGA_TRY_DONE(build_dense(model, def->lattice.depth));
        }
    } else {
        model->solves_skin = model->skin.motion != RUGA_SKIN_DYNAMIC;
        if (model->skin.motion == RUGA_SKIN_STATIC || (model->solves_skin && model->creases)) {
            RUGA_TRY_DONE(ruga_model_anchor(model));
        }
    }
    model->seam = model->clusters.count;
    if (model->creases) {
        RUGA_TRY_DONE(ruga_creases_tie(model->creases, &model->clusters));
    }
done:
    if (status != RUGA_OK) {
        ruga_model_destroy(&model);
    }
    *out = model;
    return status;
}

ruga_status ruga_model_create(const ruga_model_def* def, ruga_model** out) {
    RUGA_ASSERT(def->cookie == RUGA_MODEL_COOKIE);
    ruga_status status = RUGA_OK;
    ruga_stage* stages = NULL;
    int *stage = NULL, count = 0;
    double* end = NULL;
    *out = NULL;
    RUGA_TRY(check_material(def));
    RUGA_TRY(check_numbers(def));
    RUGA_TRY(ruga_dense_check(def));
    RUGA_TRY(check_creases(def));
    RUGA_TRY_DONE(RUGA_NEW(stage, def->crease_count));
    RUGA_TRY_DONE(RUGA_NEW(end, def->crease_count));
    count = ruga_creases_stages(def->crease_count, def->creases, def->step, stage, end);
    RUGA_TRY_DONE(RUGA_NEW_ZERO(stages, count));
    for (int k = 0; k < count; k++) {
        stages[k].end = end[k];
        RUGA_TRY_DONE(create_stage(def, stage, k, k > 0 ? stages[k - 1].model : NULL, &stages[k].model));
    }
    RUGA_TRY_DONE(create_stage(def, stage, count, count > 0 ? stages[count - 1].model : NULL, out));
    (*out)->stage = stages;
    (*out)->stage_count = count;
    stages = NULL;
    status = ruga_stages_join(*out);
done:
    for (int k = 0; k < count && stages; k++) {
        ruga_model_destroy(&stages[k].model);
    }
    ruga_release(stages);
    ruga_release(stage);
    ruga_release(end);
    if (status != RUGA_OK) {
        ruga_model_destroy(out);
    }
    return status;
}

void ruga_model_destroy(ruga_model** model_pointer) {
    ruga_model* model = *model_pointer;
    if (!model) {
        return;
    }
    for (int i = 0; i < model->handle_count; i++) {
        ruga_release((void*)(uintptr_t)model->handles[i].region.group);
        ruga_release((void*)(uintptr_t)model->handles[i].region.vertices);
    }
    ruga_release(model->handles);
    ruga_release(model->keyframes);
    ruga_variation_clear(&model->variation);
    ruga_release(model->vertex_area);
    ruga_release(model->skin_handle);
    ruga_release(model->started);
    ruga_loads_destroy(&model->loads);
    ruga_foundation_clear(&model->foundation);
    ruga_clusters_clear(&model->clusters);
    ruga_rows_clear(&model->rows);
    ruga_dense_clear(&model->dense);
    ruga_follow_clear(&model->follow);
    ruga_lattice_clear(&model->lattice);
    ruga_connectivity_clear(&model->connectivity);
    ruga_mesh_clear(&model->mesh);
    ruga_creases_destroy(&model->creases);
    for (int k = 0; k < model->stage_count; k++) {
        ruga_release(model->stage[k].node);
        ruga_release(model->stage[k].hinge);
        ruga_model_destroy(&model->stage[k].model);
    }
    ruga_release(model->stage);
    ruga_release(model->parent_node);
    ruga_release(model->parent_hinge);
    ruga_release(model);
    *model_pointer = NULL;
}

int ruga_model_vertex_count(const ruga_model* model) {
    return ruga_model_shown(model)->vertex_count;
}

const ruga_mesh* ruga_model_shown(const ruga_model* model) {
    return model->creases ? &model->creases->cut.material : &model->mesh;
}

double ruga_model_wavelength(const ruga_model* model) {
    return model->wavelength;
}

double ruga_model_critical_strain(const ruga_model* model) {
    return model->critical_strain;
}
