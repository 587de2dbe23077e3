// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga render: pictures of frames, turntables and films.
#include "app/camera_options.h"
#include "app/coloring.h"
#include "app/command.h"
#include "app/console.h"
#include "app/frames.h"
#include "core/memory.h"
#include "core/vec3.h"
#include "view/movie.h"
#include "view/render.h"

#include <math.h>
#include <string.h>

enum { PIXELS_MIN = 16, PIXELS_MAX = 16384, PICTURES_MAX = 100000 };

static const ruga_option options[] = {
    {"--frame", "-f", "K", "the frame, counted from 0 [the last]", false},
    {"--frames", NULL, "A:B", "frames, both ends included", false},
    {"--width", NULL, "PIXELS", "width of the picture [1280]", false},
    {"--height", NULL, "PIXELS", "height of the picture [960]", false},
    {"--color", NULL, RUGA_COLORING_NAMES,
     "clay; displacement: how far the skin stands off the interior; stress: von Mises'\n"
     "in the skin; clusters, elements: of the coupling and the lattice; creases: their\n"
     "fold angles; thickness, young or wavelength of a skin that varies [clay]",
     false},
    {"--wireframe", NULL, NULL, "draw the edges of the mesh", false},
    {"--plain", NULL, NULL, "no scale bar and no legend", false},
    RUGA_CAMERA_OPTIONS,
    {"--turntable", NULL, "N", "N pictures with the camera once around; several frames play meanwhile",
     false},
    {"--movie", NULL, "FILE.mp4", "a film, of all frames unless told; needs the program ffmpeg", false},
    {"--fps", NULL, "N", "pictures of the film in a second [those of the scene's time, from 5 to 60]", false},
    {"--threads", NULL, "N", "threads; the picture does not depend on it [all cores]", false},
    {"--output", "-o", "PNG", "the file to write; for several pictures a name with %04d in it", false},
    {0},
};

typedef struct job {
    const ruga_arguments* arguments;
    ruga_result_reader* reader;
    ruga_frame_range range;
    int count; // of pictures
    bool turntable;
    const char *pattern, *film;
    ruga_movie* movie;
    double azimuth; // of the first picture
    ruga_render_def def;
    ruga_extent extent;
    ruga_coloring coloring;
    double *position, *embedded;
} job;

static ruga_status read_size(job* j) {
    j->def.width = 1280;
    j->def.height = 960;
    RUGA_TRY(ruga_integer(j->arguments, "--width", PIXELS_MIN, PIXELS_MAX, &j->def.width));
    return ruga_integer(j->arguments, "--height", PIXELS_MIN, PIXELS_MAX, &j->def.height);
}

static ruga_status check_name(const char* path) {
    const char* dot = strrchr(path, '.');
    return dot && strcmp(dot, ".png") == 0
               ? ruga_check_output(path)
               : ruga_fail(RUGA_BAD_INPUT, "%s: pictures are written as .png; end the name in it", path);
}

// What can be refused before the result is read.
static ruga_status read_options(job* j) {
    const ruga_arguments* a = j->arguments;
    int threads = 0;
    j->film = ruga_value(a, "--movie");
    j->pattern = ruga_value(a, "--output");
    if (!j->film) {
        RUGA_TRY(ruga_required(a, "--output", &j->pattern));
    }
    if (j->pattern) {
        RUGA_TRY(check_name(j->pattern));
    }
    if (j->film) {
        RUGA_TRY(ruga_check_output(j->film));
    }
    RUGA_TRY(ruga_integer(a, "--turntable", 1, PICTURES_MAX, &j->count));
    j->turntable = j->count > 0;
    RUGA_TRY(ruga_integer(a, "--threads", 1, 1024, &threads));
    ruga_set_threads(threads);
    j->def.wireframe = ruga_given(a, "--wireframe");
    j->def.scale_bar = !ruga_given(a, "--plain");
    j->def.turns = j->turntable;
    return read_size(j);
}

static ruga_status choose_pictures(job* j) {
    RUGA_TRY(ruga_open_result(ruga_operand(j->arguments), &j->reader));
    bool all = !j->turntable && (j->film || ruga_has_pattern(j->pattern));
    RUGA_TRY(ruga_choose_frames(j->arguments, ruga_result_frame_count(j->reader), all, &j->range));
    ruga_frame_range numbers = j->turntable ? (ruga_frame_range){0, j->count - 1} : j->range;
    j->count = numbers.last - numbers.first + 1;
    return j->pattern ? ruga_check_pattern(j->pattern, &numbers) : RUGA_OK;
}

static void tell_scale(const job* j) {
    const ruga_scale* s = &j->coloring.scale;
    if (s->name && s->max > s->min) {
        ruga_say(j->arguments, "colours from %.4g to %.4g: %s\n", s->min / s->unit, s->max / s->unit,
                 s->name);
    } else if (j->coloring.note[0]) {
        ruga_say(j->arguments, "%s\n", j->coloring.note);
    }
}

static ruga_status prepare(job* j) {
    int color = RUGA_COLORING_CLAY, vertices = ruga_result_mesh(j->reader)->vertex_count;
    RUGA_TRY(ruga_option_choice(j->arguments, "--color", RUGA_COLORING_NAMES, &color));
    RUGA_TRY(ruga_camera_options(j->arguments, ruga_result_reader_header(j->reader)->scene_text, &j->def));
    j->azimuth = j->def.azimuth;
    RUGA_TRY(RUGA_NEW(j->position, 3 * (size_t)vertices));
    RUGA_TRY(RUGA_NEW(j->embedded, 3 * (size_t)vertices));
    RUGA_TRY(
        ruga_coloring_create(ruga_operand(j->arguments), j->reader, (ruga_coloring_kind)color, &j->coloring));
    RUGA_TRY(ruga_coloring_scan(&j->coloring, &j->range, &j->extent));
    j->def.extent = &j->extent;
    tell_scale(j);
    return RUGA_OK;
}

// Frames of the scene's own time, at most 60 and at least 5 in a second.
static ruga_status open_movie(job* j) {
    double first, last, rate = 25;
    RUGA_TRY(ruga_result_read_frame(j->reader, j->range.first, &first, NULL, NULL, NULL));
    RUGA_TRY(ruga_result_read_frame(j->reader, j->range.last, &last, NULL, NULL, NULL));
    if (!j->turntable && last > first) {
        rate = fmin(fmax((j->range.last - j->range.first) / (last - first), 5), 60);
    }
    int given = 0;
    RUGA_TRY(ruga_integer(j->arguments, "--fps", 1, 1000, &given));
    return ruga_movie_open(j->film, j->def.width, j->def.height, given > 0 ? given : rate, &j->movie);
}

static ruga_status put(job* j, int number, const ruga_picture* picture) {
    char* path = NULL;
    if (j->movie) {
        RUGA_TRY(ruga_movie_add(j->movie, picture));
    }
    if (!j->pattern) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_frame_path(j->pattern, number, &path));
    ruga_status status = ruga_picture_write(picture, path);
    if (status == RUGA_OK) {
        ruga_say(j->arguments, "%s\n", path);
    }
    ruga_release(path);
    return status;
}

// Picture i of all: of the next frame, or of the frame that a turntable has come to.
static ruga_status draw(job* j, int i) {
    int frames = j->range.last - j->range.first + 1;
    int frame = j->range.first + (j->turntable ? (int)((int64_t)i * frames / j->count) : i);
    double* embedded = ruga_coloring_needs_embedded(&j->coloring) ? j->embedded : NULL;
    ruga_picture picture;
    if (j->turntable) {
        j->def.azimuth = j->azimuth + 2 * RUGA_PI * i / j->count;
    }
    RUGA_TRY(ruga_result_read_frame(j->reader, frame, NULL, j->position, embedded, NULL));
    RUGA_TRY(ruga_coloring_set(&j->coloring, frame, j->position, embedded, &j->def));
    if (!j->def.scale_bar) {
        j->def.scalar.name = j->def.lines.name = j->def.note = NULL;
    }
    RUGA_TRY(ruga_render(ruga_result_mesh(j->reader), j->position, &j->def, &picture));
    ruga_status status = put(j, j->turntable ? i : frame, &picture);
    ruga_picture_clear(&picture);
    return status;
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    ruga_status status = RUGA_OK;
    job j = {.arguments = arguments, .def = ruga_default_render_def()};
    RUGA_TRY(read_options(&j));
    RUGA_TRY_DONE(choose_pictures(&j));
    RUGA_TRY_DONE(prepare(&j));
    if (j.film) {
        RUGA_TRY_DONE(open_movie(&j));
    }
    for (int i = 0; i < j.count; i++) {
        RUGA_TRY_DONE(draw(&j, i));
    }
done:
    if (j.movie) {
        status = ruga_movie_close(&j.movie, status);
        if (status == RUGA_OK) {
            ruga_say(arguments, "%s\n", j.film);
        }
    }
    ruga_coloring_clear(&j.coloring);
    ruga_release(j.position);
    ruga_release(j.embedded);
    ruga_result_reader_close(&j.reader);
    return status;
}

const ruga_command ruga_render_command = {
    .name = "render",
    .operand = "RESULT",
    .usage =
        "[--frame K | --frames A:B] [--color NAME] [--camera PLACE] [--width W] [--height H] [--wireframe]\n"
        "                   [--turntable N] [--movie FILE.mp4] [-o PNG_OR_PATTERN]",
    .summary = "draw frames of a result as PNG pictures or as a film",
    .about = "Draws the skin. For several pictures the file's name holds a place for the number, such as "
             "f_%04d.png;\n"
             "a name with such a place and no frames given means all of them. All frames share one camera "
             "and one\n"
             "scale of colours. The scale bar is true in the middle of what is seen.",
    .example = "    ruga render pillow.h5 --frame 50 --color displacement -o pillow.png",
    .options = options,
    .run = run,
};
