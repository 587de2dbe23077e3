// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga run: a scene to a result file. Whole frames only reach the file, so that a run that was stopped or
// killed is continued by --resume, with the same bits as one left alone.
#include "app/added_creases.h"
#include "app/command.h"
#include "app/console.h"
#include "app/creases.h"
#include "app/frames.h"
#include "app/interrupt.h"
#include "app/meter.h"
#include "app/preview.h"
#include "core/memory.h"
#include "core/progress.h"
#include "io/result.h"
#include "solver/state.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const ruga_option options[] = {
    {"--output", "-o", "RESULT.h5", "the result file to write", false},
    {"--frames", NULL, "N", "number of frames after the start state, in place of the scene's", false},
    {"--resume", NULL, NULL, "go on after the last whole frame of RESULT; start where there is none", false},
    {"--force", NULL, NULL, "overwrite RESULT", false},
    {"--threads", NULL, "N", "threads; the result does not depend on it [all cores]", false},
    {"--set", NULL, "KEY=VALUE",
     "replace a value of the scene, such as skin.thickness=1mm; may be given\n"
     "several times",
     true},
    {"--preview", NULL, "DIR", "write a small picture of each frame, DIR/frame_%04d.png, as it comes", false},
    {"--json", "-j", NULL, "print the summary as one JSON object", false},
    {0},
};

enum { FRAMES_MAX = 10000000, THREADS_MAX = 1024, OUTCOMES = 4 };

typedef struct job {
    const ruga_arguments* arguments;
    const char *scene_path, *path;
    ruga_scene scene, before; // before: that of RESULT, where creases were added to it
    bool adds;
    ruga_model* model;
    ruga_state* state;
    ruga_result* result;
    double *restart, *force, *gap;
    ruga_mesh shown;                                 // the model's, with `source`
    int* source;                                     // [V]
    double *thickness, *young, *growth, *wavelength; // of the mesh shown, or NULL
    ruga_crease_table creases;
    ruga_meter meter;
    ruga_preview preview;
    bool continues;             // RESULT has frames that stay
    int whole;                  // the last whole frame in RESULT; -1 = none
    int outcomes[OUTCOMES];     // frames of each, those of earlier runs included
    int split_frames, substeps; // frames whose step was split, and all parts of steps, of this run
    double begin;
} job;

// ---- before any work -----------------------------------------------------------------------------------

static bool exists(const char* path) {
    struct stat info;
    return stat(path, &info) == 0;
}

static ruga_status check_paths(const job* j) {
    bool resume = ruga_given(j->arguments, "--resume"), force = ruga_given(j->arguments, "--force");
    RUGA_TRY(ruga_check_input(j->scene_path));
    RUGA_TRY(ruga_check_output(j->path));
    if (resume && force) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "--resume goes on with %s and --force overwrites it: give one of them", j->path);
    }
    if (exists(j->path) && !resume && !force) {
        return ruga_fail(RUGA_BAD_INPUT, "%s exists already: --resume goes on with it, --force overwrites it",
                         j->path);
    }
    return RUGA_OK;
}

// --frames as one more --set, so that the scene's text in the result says it too.
static ruga_status read_scene(job* j) {
    int count, frames = 0;
    char assignment[48];
    const char** sets = NULL;
    RUGA_TRY(ruga_integer(j->arguments, "--frames", 1, FRAMES_MAX, &frames));
    const char* const* given = ruga_values(j->arguments, "--set", &count);
    RUGA_TRY(RUGA_NEW(sets, count + 1));
    memcpy(sets, given, (size_t)count * sizeof *sets);
    if (frames > 0) {
        (void)snprintf(assignment, sizeof assignment, "time.frames=%d", frames);
        sets[count++] = assignment;
    }
    ruga_status status = ruga_scene_read(j->scene_path, count, sets, &j->scene);
    ruga_release(sets);
    return status;
}

static void count_outcome(job* j, ruga_outcome outcome) {
    if ((unsigned)outcome < OUTCOMES) {
        j->outcomes[outcome]++;
    }
}

// What an existing result holds: whether it is of this scene, its frames and their outcomes.
static ruga_status look_at_result(job* j) {
    ruga_status status = RUGA_OK;
    ruga_result_reader* reader = NULL;
    if (!ruga_given(j->arguments, "--resume") || !exists(j->path)) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_result_open(j->path, &reader));
    const ruga_result_header* header = ruga_result_reader_header(reader);
    if (header->scene_hash != j->scene.hash && header->mesh_hash == j->scene.mesh_hash) {
        RUGA_TRY_DONE(ruga_added_creases_find(header, j->scene_path, &j->scene, &j->before, &j->adds));
    }
    if (!j->adds && (header->scene_hash != j->scene.hash || header->mesh_hash != j->scene.mesh_hash)) {
        status = ruga_fail(RUGA_BAD_INPUT, "%s was made from another %s: --force overwrites it", j->path,
                           header->mesh_hash != j->scene.mesh_hash ? "mesh" : "scene");
        goto done;
    }
    int count = ruga_result_frame_count(reader);
    j->whole = count - 1;
    j->continues = count > 0;
    for (int frame = 0; frame < count; frame++) {
        ruga_report report;
        RUGA_TRY_DONE(ruga_result_read_frame(reader, frame, NULL, NULL, NULL, &report));
        count_outcome(j, report.outcome);
    }
done:
    ruga_result_reader_close(&reader);
    return status;
}

// ---- the run -------------------------------------------------------------------------------------------

static bool on_progress(const char* stage, double done, void* context) {
    ruga_meter_stage(context, stage, done);
    return !ruga_interrupted();
}

static void warn_of_coarse_mesh(const job* j) {
    double edges = j->model->edges, wavelength = j->model->edges_wavelength;
    if (j->model->has_interior && j->model->solves_skin && edges < 8) {
        ruga_warn(
            j->arguments,
            "the mesh has %.3g edges per wrinkle wavelength (%.3g mm); below 8 wrinkles come out too long or "
            "not at all: remesh with edge %.3g mm",
            edges, 1e3 * wavelength, 1e3 * wavelength / 8);
    }
}

static void warn_of_handles(const job* j) {
    char sentence[512];
    ruga_judge_handles(j->model, sentence, sizeof sentence);
    if (*sentence) {
        ruga_warn(j->arguments, "%s", sentence);
    }
}

static void warn_of_loose_fit(const job* j) {
    const ruga_follow* follow = &j->model->follow;
    if (follow->count > 0 && follow->error > 0.02 * j->model->extent) {
        ruga_warn(
            j->arguments,
            "the lattice follows the moving surface to within %.3g mm (root mean square); more lattice.cells "
            "follow it closer",
            1e3 * follow->error);
    }
}

// The mesh as it is shown, its vertices named by those of the user's file: the model knows those of the
// scene's mesh only.
static ruga_status name_sources(job* j) {
    const int* of_scene = j->scene.mesh.source_vertex;
    j->shown = *ruga_model_shown(j->model);
    RUGA_TRY(RUGA_NEW(j->source, j->shown.vertex_count));
    for (int v = 0; v < j->shown.vertex_count; v++) {
        int source = j->shown.source_vertex ? j->shown.source_vertex[v] : v;
        j->source[v] = of_scene && source >= 0 ? of_scene[source] : source;
    }
    j->shown.source_vertex = j->source;
    return RUGA_OK;
}

static ruga_status open_result(job* j) {
    const ruga_model* model = j->model;
    char libraries[1024];
    ruga_library_versions(", ", libraries, sizeof libraries);
    RUGA_TRY(name_sources(j));
    const ruga_variation* v = &model->variation;
    RUGA_TRY(ruga_variation_show(model, v->thickness, 1, &j->thickness));
    RUGA_TRY(ruga_variation_show(model, v->young, 1, &j->young));
    RUGA_TRY(ruga_variation_show(model, v->growth, 2, &j->growth));
    RUGA_TRY(ruga_variation_show(model, v->wavelength, 1, &j->wavelength));
    ruga_result_header header = {
        .libraries = libraries,
        .mesh = &j->shown,
        .lattice = model->has_interior ? &model->lattice : NULL,
        .scene_text = j->scene.text,
        .scene_hash = j->scene.hash,
        .mesh_hash = j->scene.mesh_hash,
        .seed = j->scene.def.solver.seed,
        .mesh_unit = j->scene.mesh_unit,
        .wavelength = model->wavelength,
        .critical_strain = model->critical_strain,
        .cluster_sigma = model->coupling.sigma,
        .cluster_radius = model->coupling.radius,
        .restart_doubles = ruga_state_restart_size(model),
        .vertex_thickness = j->thickness,
        .vertex_young = j->young,
        .vertex_growth = j->growth,
        .vertex_wavelength = j->wavelength,
        .handle_count = model->handle_count,
    };
    RUGA_TRY(ruga_crease_table_create(model, &j->creases));
    header.creases = j->creases.result.segment_count > 0 ? &j->creases.result : NULL;
    RUGA_TRY(RUGA_NEW(j->gap, j->creases.result.segment_count));
    RUGA_TRY(RUGA_NEW_ZERO(j->force, 3 * (size_t)model->handle_count));
    RUGA_TRY(RUGA_NEW_ZERO(j->restart, header.restart_doubles));
    if (!j->continues) {
        // A file without a whole frame, left by a killed run, is no one's result.
        bool force = ruga_given(j->arguments, "--force") || ruga_given(j->arguments, "--resume");
        return ruga_result_create(j->path, &header, force, &j->result);
    }
    int frames;
    if (j->adds) {
        RUGA_TRY(ruga_added_creases_write(j->path, &j->before, &j->scene, model, &header));
    }
    RUGA_TRY(ruga_result_resume(j->path, &header, j->restart, &frames, &j->result));
    j->whole = frames - 1;
    return ruga_state_load(j->state, j->restart);
}

static ruga_status write_frame(job* j, const ruga_report* report) {
    ruga_state_save(j->state, j->restart);
    ruga_result_frame frame = {
        .time = ruga_state_time(j->state),
        .position = ruga_state_positions(j->state),
        .embedded = j->model->has_interior ? ruga_state_embedded(j->state) : NULL,
        .lattice_position = ruga_state_lattice(j->state),
        .report = *report,
        .restart = j->restart,
        .crease_angle = ruga_state_crease_angles(j->state),
        .crease_rest = ruga_state_crease_rests(j->state),
        .gap = ruga_state_gap(j->state),
        .segment_gap = j->gap,
        .handle_force = j->force,
    };
    ruga_state_segment_gaps(j->state, j->gap);
    RUGA_TRY(ruga_state_handle_forces(j->state, j->force));
    RUGA_TRY(ruga_result_append(j->result, &frame));
    j->whole = ruga_state_frame(j->state);
    count_outcome(j, report->outcome);
    ruga_meter_frame(&j->meter, frame.time, report);
    // A picture that cannot be written is no reason to end a long run.
    if (ruga_preview_frame(&j->preview, &j->shown, j->whole, frame.position) != RUGA_OK) {
        ruga_meter_erase(&j->meter);
        ruga_warn(j->arguments, "no more previews: %s", ruga_last_error());
        ruga_preview_clear(&j->preview);
    }
    return RUGA_OK;
}

static ruga_status simulate(job* j) {
    ruga_report report;
    int frames = j->scene.def.frames;
    RUGA_TRY(ruga_scene_place_error(&j->scene, ruga_model_create(&j->scene.def, &j->model)));
    warn_of_coarse_mesh(j);
    warn_of_loose_fit(j);
    warn_of_handles(j);
    ruga_warn_of_creases(j->arguments, j->model);
    RUGA_TRY(ruga_state_create(j->model, &j->state));
    RUGA_TRY(open_result(j));
    if (!j->continues) {
        RUGA_TRY(ruga_state_measure(j->state, &report));
        RUGA_TRY(write_frame(j, &report));
    }
    while (j->whole < frames) {
        j->meter.frame = j->whole + 1;
        if (ruga_interrupted()) {
            return ruga_fail(RUGA_CANCELLED, "stopped");
        }
        RUGA_TRY(ruga_state_step(j->model, j->state, &report));
        RUGA_TRY(write_frame(j, &report));
        j->split_frames += report.substeps > 1;
        j->substeps += report.substeps;
    }
    return RUGA_OK;
}

// ---- what is said at the end ---------------------------------------------------------------------------

// A word as a shell wants it: in quotes unless it holds nothing special.
static void complain_word(const char* word) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+@%";
    if (*word && word[strspn(word, plain)] == '\0') {
        (void)fprintf(stderr, " %s", word);
        return;
    }
    (void)fputs(" '", stderr);
    for (; *word; word++) {
        (void)fputs(*word == '\'' ? "'\\''" : (char[2]){*word, '\0'}, stderr);
    }
    (void)fputc('\'', stderr);
}

static void tell_how_to_resume(const job* j) {
    if (j->whole >= 0) {
        (void)fprintf(stderr, "ruga: stopped after frame %d of %d; to go on: ruga run", j->whole,
                      j->scene.def.frames);
    } else {
        (void)fputs("ruga: stopped before the first frame; to start again: ruga run", stderr);
    }
    complain_word(j->scene_path);
    (void)fputs(" -o", stderr);
    complain_word(j->path);
    (void)fputs(" --resume", stderr);
    static const char* const kept[] = {"--frames", "--threads", "--preview", "--set"};
    for (int k = 0; k < 4; k++) {
        int count;
        const char* const* values = ruga_values(j->arguments, kept[k], &count);
        for (int i = 0; i < count; i++) {
            complain_word(kept[k]);
            complain_word(values[i]);
        }
    }
    (void)fputc('\n', stderr);
}

static ruga_status tell_summary(const job* j) {
    double seconds = ruga_clock() - j->begin;
    const int* o = j->outcomes;
    if (ruga_given(j->arguments, "--json")) {
        return ruga_print_json(json_pack("{s:s, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:o}", "result", j->path,
                                         "frames", j->whole, "minimum", o[0], "saddle", o[1], "not_converged",
                                         o[2], "in_motion", o[3], "frames_split", j->split_frames, "substeps",
                                         j->substeps, "seconds", ruga_json_number(seconds)));
    }
    char duration[32];
    ruga_duration(seconds, duration);
    ruga_say(j->arguments, "%s: frames 0 to %d in %s\n", j->path, j->whole, duration);
    if (o[3] == 0) {
        ruga_say(j->arguments, "    %d in a minimum, %d on a saddle, %d not converged\n", o[0], o[1], o[2]);
    }
    if (j->split_frames > 0) {
        ruga_say(j->arguments, "    steps split: %d frames, %d substeps in all\n", j->split_frames,
                 j->substeps);
    }
    return RUGA_OK;
}

static ruga_status finish(job* j, ruga_status status, int* exit_status) {
    ruga_set_progress(NULL, NULL);
    ruga_meter_erase(&j->meter);
    if (j->result) {
        ruga_status closed = ruga_result_close(&j->result);
        status =
            status == RUGA_OK || status == RUGA_CANCELLED ? (closed == RUGA_OK ? status : closed) : status;
    }
    if (status == RUGA_CANCELLED) {
        tell_how_to_resume(j);
        *exit_status = RUGA_EXIT_INTERRUPTED;
        return RUGA_OK;
    }
    RUGA_TRY(status);
    *exit_status = j->outcomes[1] + j->outcomes[2] > 0 ? RUGA_EXIT_NOT_CONVERGED : RUGA_EXIT_DONE;
    return tell_summary(j);
}

static void clear(job* j) {
    ruga_preview_clear(&j->preview);
    ruga_release(j->source);
    ruga_release(j->restart);
    ruga_release(j->force);
    ruga_release(j->gap);
    ruga_release(j->thickness);
    ruga_release(j->young);
    ruga_release(j->growth);
    ruga_release(j->wavelength);
    ruga_crease_table_clear(&j->creases);
    ruga_state_destroy(&j->state);
    ruga_model_destroy(&j->model);
    ruga_scene_clear(&j->scene);
    ruga_scene_clear(&j->before);
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    ruga_status status = RUGA_OK;
    int threads = 0;
    job j = {
        .arguments = arguments, .scene_path = ruga_operand(arguments), .whole = -1, .begin = ruga_clock()};
    RUGA_TRY(ruga_required(arguments, "--output", &j.path));
    RUGA_TRY(ruga_integer(arguments, "--threads", 1, THREADS_MAX, &threads));
    RUGA_TRY(check_paths(&j));
    ruga_set_threads(threads);
    RUGA_TRY_DONE(read_scene(&j));
    ruga_warn_of_scene(arguments, &j.scene);
    RUGA_TRY_DONE(ruga_preview_start(ruga_value(arguments, "--preview"), &j.scene, &j.preview));
    RUGA_TRY_DONE(look_at_result(&j));
    if (j.whole >= j.scene.def.frames) {
        ruga_say(arguments, ruga_given(arguments, "--json") ? "" : "%s is complete: nothing is left to do\n",
                 j.path);
    } else {
        j.meter = ruga_meter_start(ruga_given(arguments, "--quiet"), j.scene.def.frames);
        ruga_interrupt_catch();
        ruga_set_progress(on_progress, &j.meter);
        status = simulate(&j);
    }
    status = finish(&j, status, exit_status);
done:
    clear(&j);
    return status;
}

const ruga_command ruga_run_command = {
    .name = "run",
    .operand = "SCENE",
    .usage = "-o RESULT.h5 [--frames N] [--resume | --force] [--threads N] [--set key.path=value]\n"
             "                [--preview DIR] [--quiet]",
    .summary = "simulate a scene",
    .about =
        "Writes frame 0, the start state, and then as many frames as the scene or --frames says. The file "
        "can be\n"
        "read at any moment. Ctrl-C ends at the last whole frame; the same command with --resume goes on\n"
        "from there and gives the same bits. Creases that start at the last frame or later may be added at the\n"
        "end of the scene's list first. Exit status 1 where a frame is a saddle or not converged.",
    .example = "    ruga run pillow.yaml -o pillow.h5 --frames 20 --set \"skin.thickness=1 mm\"",
    .options = options,
    .run = run,
};
