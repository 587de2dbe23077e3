// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga explain: what a scene means, before any solve.
#include "app/command.h"
#include "app/console.h"
#include "app/creases.h"
#include "app/estimate.h"
#include "lattice/motion.h"
#include "shell/shell.h"
#include "solver/model.h"

#include <math.h>
#include <stdio.h>

static const double edges_good = 8, edges_least = 3; // per wavelength

static const ruga_option options[] = {
    {"--strain", NULL, "STRAIN",
     "compressive strain to give the amplitude at, such as 5%\n"
     "[the scene's largest prescribed compression]",
     false},
    {"--set", NULL, "KEY=VALUE", "replace a value of the scene; may be given several times", true},
    {"--json", "-j", NULL, "print one JSON object in SI units", false},
    {0},
};

typedef struct facts {
    const ruga_scene* scene;
    const ruga_model* model;
    ruga_estimate estimate;
    double strain, amplitude; // NaN where there is no interior or no strain is known
    double edges;             // per wavelength; NaN where no wrinkles are solved for
    bool refused;
    char judged[2][512]; // the mesh, the handles: what is to be said of them, or ""
} facts;

static void judge(facts* f) {
    double good = 1e3 * f->model->edges_wavelength / edges_good;
    if (f->refused) {
        (void)snprintf(
            f->judged[0], sizeof f->judged[0],
            "%.3g edges per wavelength are below %g, run will refuse this: remesh with edge %.3g mm, or "
            "set solver.allow_coarse",
            f->edges, edges_least, good);
    } else if (f->edges < edges_good) {
        (void)snprintf(f->judged[0], sizeof f->judged[0],
                       "%.3g edges per wavelength are below %g: remesh with edge %.3g mm", f->edges,
                       edges_good, good);
    }
    ruga_judge_handles(f->model, f->judged[1], sizeof f->judged[1]);
}

static ruga_status derive(const ruga_arguments* arguments, facts* f) {
    const ruga_model_def* def = &f->scene->def;
    RUGA_TRY(ruga_estimate_model(f->model, &f->estimate));
    f->strain = f->amplitude = f->edges = NAN;
    if (!def->has_interior) {
        return RUGA_OK;
    }
    if (def->keyframe_count > 0) {
        f->strain = ruga_motion_largest_compression(def->keyframe_count, def->keyframes);
    } else if (f->model->follow.count > 0) {
        f->strain = f->model->follow.compression;
    }
    RUGA_TRY(ruga_quantity(arguments, "--strain", "1", &f->strain));
    if (ruga_given(arguments, "--strain") && !(f->strain >= 0 && f->strain < 1)) {
        return ruga_fail(RUGA_BAD_INPUT, "--strain: %g is not a compression between 0 and 100 %%", f->strain);
    }
    if (f->strain < 1) { // a matrix may flatten all
        f->amplitude = ruga_wrinkle_amplitude(&f->model->skin, &def->interior, f->strain);
    }
    if (f->model->solves_skin) {
        f->edges = f->model->edges;
        f->refused = f->edges < edges_least && !def->solver.allow_coarse;
    }
    return RUGA_OK;
}

// ---- for people ----------------------------------------------------------------------------------------

static void say_key(const char* key, const char* value, const char* unit, bool given, void* context) {
    char text[512];
    bool plain = !unit || !*unit || (unit[0] == '1' && !unit[1]);
    (void)snprintf(text, sizeof text, "%s%s%s", value, plain ? "" : " ", plain ? "" : unit);
    ruga_say(context, "    %-28s %s%s\n", key, text, given ? "" : "  (default)");
}

static void say_variation(const ruga_arguments* arguments, const ruga_model* m) {
    ruga_say(arguments, "    %-28s %.4g to %.4g mm, the value above is the mean over the area\n",
             "local wavelength", 1e3 * m->wavelength_min, 1e3 * m->wavelength_max);
    ruga_say(arguments, "    %-28s %.3g to %.3g %%\n", "local critical strain", 1e2 * m->critical_strain,
             1e2 * m->critical_strain_max);
}

static void say_wrinkles(const ruga_arguments* arguments, const facts* f) {
    if (!f->scene->def.has_interior) {
        ruga_say(arguments, "wrinkles\n    no interior: nothing sets a wavelength\n");
        return;
    }
    ruga_say(arguments, "wrinkles\n    %-28s %.4g mm\n    %-28s %.3g %%\n", "wavelength",
             1e3 * f->model->wavelength, "critical strain", 1e2 * f->model->critical_strain);
    if (f->model->variation.wavelength) {
        say_variation(arguments, f->model);
    }
    if (isfinite(f->amplitude)) {
        char name[48];
        (void)snprintf(name, sizeof name, "amplitude at %.3g %% strain", 1e2 * f->strain);
        ruga_say(arguments, "    %-28s %.4g mm%s\n", name, 1e3 * f->amplitude,
                 f->model->variation.wavelength ? ", of a skin of mean thickness and modulus" : "");
    } else {
        ruga_say(arguments, "    %-28s give --strain to know it\n", "amplitude");
    }
    if (isfinite(f->edges)) {
        ruga_say(arguments, "    %-28s %.3g (%smean edge %.4g mm)\n", "edges per wavelength", f->edges,
                 f->model->variation.wavelength ? "at the worst place; " : "", 1e3 * f->model->mean_edge);
    }
}

static void say_sizes(const ruga_arguments* arguments, const facts* f) {
    const ruga_model* m = f->model;
    const ruga_estimate* e = &f->estimate;
    char frame[32], run[32];
    ruga_duration(e->seconds_per_frame, frame);
    ruga_duration(e->seconds_per_frame * m->frames, run);
    ruga_say(arguments, "sizes\n    %-28s %d vertices, %d triangles\n", "mesh",
             ruga_model_shown(m)->vertex_count, ruga_model_shown(m)->triangle_count);
    if (m->has_interior) {
        ruga_say(arguments, "    %-28s %d\n    %-28s %d, %d of them superimposed; %d nodes\n", "clusters",
                 m->seam, "elements", m->lattice.element_count, m->lattice.superimposed,
                 m->lattice.node_count);
    }
    ruga_say(arguments, "    %-28s %lld of the skin, %lld of the interior, %lld constraints\n",
             "degrees of freedom", (long long)e->skin_unknowns, (long long)e->interior_unknowns,
             (long long)e->constraints);
    ruga_say(arguments, "    %-28s about %.3g MB\n", "memory", e->bytes / 1e6);
    ruga_say(arguments, "    %-28s roughly %s a frame, %s for %d frames\n", "time", frame, run, m->frames);
}

// Why a curve has the freedom it has.
static const char* freedom_of(const ruga_raster* raster, int c) {
    const ruga_curve_facts* facts = &raster->facts[c];
    if (raster->curve[c].kind == RUGA_CREASE_CUT) {
        return "open, a cut";
    }
    if (raster->curve[c].freedom != RUGA_FREEDOM_AUTO) {
        return facts->full ? "full, as asked" : "single, as asked";
    }
    return !facts->full              ? "single: it is straight and alone"
           : raster->curve[c].varies ? "full: its values vary"
           : raster->curve[c].closed ? "full: it is closed"
           : facts->bent             ? "full: it bends"
                                     : "full: it meets another";
}

static void say_creases(const ruga_arguments* arguments, const facts* f) {
    enum { LISTED = 12 };
    const ruga_creases* c = f->model->creases;
    if (!c) {
        return;
    }
    const ruga_raster* r = &c->raster;
    ruga_say(arguments, "creases\n    %-28s %d, of %d straight pieces\n", "curves", r->curve_count,
             c->segment_count);
    ruga_say(arguments, "    %-28s %d before, %d pieces after; %d vertices, %d nodes\n", "triangles",
             r->mesh.triangle_count, c->cut.piece_count, r->mesh.vertex_count, c->cut.node_count);
    ruga_say(arguments, "    %-28s %d vertices moved, %d edges and %d faces split\n", "mesh mended", r->moved,
             r->split_edges, r->split_faces);
    ruga_say(arguments, "    %-28s %d, %d redundant ones left out\n", "rows of the sewing",
             c->sewing.row_count, c->sewing.redundant_rows);
    for (int i = 0; i < r->curve_count && i < LISTED; i++) {
        char later[40] = "";
        int stage = r->curve[i].stage;
        if (stage > 0) {
            (void)snprintf(later, sizeof later, ", from %.4g s on",
                           f->model->stage[stage - 1].end * f->model->step);
        }
        ruga_say(arguments, "    %-28s %.4g mm, freedom %s%s\n", c->law[r->curve[i].label].name,
                 1e3 * r->facts[i].length, freedom_of(r, i), later);
    }
    if (r->curve_count > LISTED) {
        ruga_say(arguments, "    and %d more\n", r->curve_count - LISTED);
    }
}

static void say_all(const ruga_arguments* arguments, const facts* f) {
    ruga_say(arguments, "scene, mesh %s\n", f->scene->mesh_name);
    ruga_scene_each(f->scene, say_key, (void*)(uintptr_t)arguments);
    say_wrinkles(arguments, f);
    say_creases(arguments, f);
    say_sizes(arguments, f);
}

// ---- for programs --------------------------------------------------------------------------------------

static void add_key(const char* key, const char* value, const char* unit, bool given, void* context) {
    (void)json_array_append_new(context, json_pack("{s:s, s:s, s:s, s:b}", "key", key, "value", value, "unit",
                                                   unit ? unit : "", "default", !given));
}

static json_t* creases_json(const ruga_model* m) {
    const ruga_creases* c = m->creases;
    return c ? json_pack("{s:i, s:i, s:i, s:i, s:i, s:i}", "curves", c->raster.curve_count, "segments",
                         c->segment_count, "triangles", c->raster.mesh.triangle_count, "pieces",
                         c->cut.piece_count, "nodes", c->cut.node_count, "rows", c->sewing.row_count)
             : json_null();
}

static json_t* facts_json(const facts* f) {
    const ruga_model* m = f->model;
    const ruga_estimate* e = &f->estimate;
    json_t* keys = json_array();
    ruga_scene_each(f->scene, add_key, keys);
    json_t* unknowns = json_pack("{s:I, s:I, s:I}", "skin", (json_int_t)e->skin_unknowns, "interior",
                                 (json_int_t)e->interior_unknowns, "constraints", (json_int_t)e->constraints);
    json_t* warnings = ruga_json_texts(f->scene->warning_count, (const char* const*)f->scene->warning);
    for (int i = 0; i < 2; i++) {
        if (*f->judged[i]) {
            (void)json_array_append_new(warnings, json_string(f->judged[i]));
        }
    }
    json_t* wavelength = m->has_interior ? ruga_json_number(m->wavelength) : json_null();
    json_t* critical = m->has_interior ? ruga_json_number(m->critical_strain) : json_null();
    json_t* range =
        m->variation.wavelength ? json_pack("[f, f]", m->wavelength_min, m->wavelength_max) : json_null();
    json_t* strains = m->variation.wavelength
                          ? json_pack("[f, f]", m->critical_strain, m->critical_strain_max)
                          : json_null();
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:i, s:i, s:i, s:i, s:i, s:i, s:o, s:o, s:i, s:o, "
        "s:o, "
        "s:o, s:b, s:o}",
        "keys", keys, "wavelength_range", range, "critical_strain_range", strains, "wavelength", wavelength,
        "critical_strain", critical, "strain", ruga_json_number(f->strain), "amplitude",
        ruga_json_number(f->amplitude), "edges_per_wavelength", ruga_json_number(f->edges), "mean_edge",
        ruga_json_number(m->mean_edge), "vertices", ruga_model_shown(m)->vertex_count, "triangles",
        ruga_model_shown(m)->triangle_count, "clusters", m->seam, "elements", m->lattice.element_count,
        "superimposed", m->lattice.superimposed, "lattice_nodes", m->lattice.node_count, "degrees_of_freedom",
        unknowns, "memory_bytes", ruga_json_number(e->bytes), "frames", m->frames, "seconds_per_frame",
        ruga_json_number(e->seconds_per_frame), "seconds", ruga_json_number(e->seconds_per_frame * m->frames),
        "warnings", warnings, "ok", !f->refused, "creases", creases_json(m));
}

// ---- the command ---------------------------------------------------------------------------------------

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    ruga_scene scene = {0};
    ruga_model* model = NULL;
    int count;
    RUGA_TRY(ruga_check_input(ruga_operand(arguments)));
    const char* const* sets = ruga_values(arguments, "--set", &count);
    RUGA_TRY(ruga_scene_read(ruga_operand(arguments), count, sets, &scene));
    ruga_warn_of_scene(arguments, &scene);
    // A mesh that is too coarse to be run is explained all the same.
    ruga_model_def def = scene.def;
    def.solver.allow_coarse = true;
    RUGA_TRY_DONE(ruga_scene_place_error(&scene, ruga_model_create(&def, &model)));
    facts f = {.scene = &scene, .model = model};
    RUGA_TRY_DONE(derive(arguments, &f));
    judge(&f);
    if (ruga_given(arguments, "--json")) {
        RUGA_TRY_DONE(ruga_print_json(facts_json(&f)));
    } else {
        say_all(arguments, &f);
    }
    ruga_warn_of_creases(arguments, f.model);
    for (int i = 0; i < 2; i++) {
        if (*f.judged[i] && !(f.refused && i == 0)) {
            ruga_warn(arguments, "%s", f.judged[i]);
        }
    }
    if (f.refused) {
        status = ruga_fail(RUGA_BAD_INPUT, "%s: %s", ruga_operand(arguments), f.judged[0]);
    }
done:
    ruga_model_destroy(&model);
    ruga_scene_clear(&scene);
    return status;
}

const ruga_command ruga_explain_command = {
    .name = "explain",
    .operand = "SCENE",
    .usage = "[--strain 5%] [--set key.path=value] [--json]",
    .summary = "show what a scene means: every value, the wrinkles to expect, sizes and cost",
    .about =
        "Prints every key with its value or default, then what follows from them before anything is solved:\n"
        "wavelength, critical strain, amplitude, edges per wavelength (8 are good, below 3 is refused), "
        "sizes,\n"
        "memory and time. Exit status 2 where run would refuse the scene.",
    .example = "    ruga explain pillow.yaml --strain 5%",
    .options = options,
    .run = run,
};
