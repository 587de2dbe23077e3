// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L

#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "core/random.h"
#include "io/scene.h"
#include "io/scene_read.h"

#include <dirent.h>
#include <locale.h>
#include <stdlib.h>
#include <string.h>

#define SCENES RUGA_SOURCE_DIR "/tests/scenes"

// A small box, so that what follows is read quickly.
#define MESH "mesh: {make: {shape: slab, size: [0.4, 0.3, 0.2], edge: 10 cm}}\n"

static ruga_status read_string(const char* text, ruga_scene* scene) {
    return ruga_scene_read_text(text, "scene.yaml", SCENES, 0, NULL, scene);
}

static ruga_status read_with(const char* text, const char* set, ruga_scene* scene) {
    return ruga_scene_read_text(text, "scene.yaml", SCENES, 1, &set, scene);
}

static void assert_sentence(const char* fragment) {
    if (!strstr(ruga_last_error(), fragment)) {
        print_error("'%s' is not in: %s\n", fragment, ruga_last_error());
        fail();
    }
}

static void assert_refused(const char* text, const char* fragment) {
    ruga_scene scene;
    assert_status(read_string(text, &scene), RUGA_BAD_INPUT);
    assert_sentence(fragment);
}

static void quantities_become_si(void** state) {
    (void)state;
    static const struct {
        const char *text, *dimension;
        double value;
    } cases[] = {
        {"0.4 mm", "m", 0.0004},
        {"2mm", "m", 0.002},
        {"8 mm", "m", 0.008},
        {"25 um", "m", 25e-6},
        {"25 \xc2\xb5m", "m", 25e-6},
        {"3 cm", "m", 0.03},
        {"1 inch", "m", 0.0254},
        {"2 ft", "m", 0.6096},
        {"40 MPa", "Pa", 40e6},
        {"5 kPa", "Pa", 5000},
        {"1 N/mm^2", "Pa", 1e6},
        {"1 bar", "Pa", 1e5},
        {"60 kg/m^3", "kg/m^3", 60},
        {"60 kg m-3", "kg/m^3", 60},
        {"0.9 g/cm^3", "kg/m^3", 900},
        {"60 kg*m^-3", "kg/m^3", 60},
        {"20 ms", "s", 0.02},
        {"1 min", "s", 60},
        {"180 deg", "rad", 3.14159265358979323846},
        {"1 rad", "rad", 1},
        {"0.5 turn", "rad", 3.14159265358979323846},
        {"5 %", "1", 0.05},
        {"5%", "1", 0.05},
        {"50 percent", "1", 0.5},
        {"1 m/m", "1", 1},
        {"1 1/s", "1/s", 1},
        {"2 Hz", "1/s", 2},
        {"3 N/m", "N/m", 3},
        {"3 kN", "N", 3000},
        {"9.81 m/s^2", "m/s^2", 9.81},
        {"9.81 m s-2", "m/s^2", 9.81},
        {"1e-3", "m", 0.001},
        {"1E3 mm", "m", 1},
        {"-.5", "1", -0.5},
        {"5.", "1", 5},
        {"+2", "1", 2},
        {"  7  mm ", "m", 0.007},
        {"0", "Pa", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double value = NAN;
        assert_ok(ruga_quantity_parse(cases[i].text, cases[i].dimension, &value));
        assert_near(value, cases[i].value, 4e-16 * fabs(cases[i].value));
    }
    // Bare and with a unit: the same bits.
    double with, bare;
    for (int i = 1; i < 1000; i++) {
        char text[2][32];
        (void)snprintf(text[0], sizeof text[0], "%d mm", i);
        (void)snprintf(text[1], sizeof text[1], "%d.%03d", i / 1000, i % 1000);
        assert_ok(ruga_quantity_parse(text[0], "m", &with));
        assert_ok(ruga_quantity_parse(text[1], "m", &bare));
        assert_true(with == bare);
    }
}

static void what_is_no_quantity_is_refused(void** state) {
    (void)state;
    static const struct {
        const char *text, *dimension, *fragment;
    } cases[] = {
        {"2 mm", "Pa", "2 mm is a length, but a pressure (Pa) is needed"},
        {"3 s", "m", "3 s is a time, but a length (m) is needed"},
        {"3 kg", "1", "3 kg is a mass, but a plain number is needed"},
        {"3 deg", "1", "3 deg is an angle, but a plain number"},
        {"3 %", "rad", "3 % is a plain number, but an angle (rad)"},
        {"3 sr", "rad", "but an angle (rad)"},
        {"3 rpm", "1/s", "but a rate (1/s)"},
        {"1 MPa", "nothing", "UDUNITS-2 does not know"},
        {"3 degC", "K", "but a temperature"},
        {"3 m since 1990", "m", "is not a unit"},
        {"3 m @ 2", "m", "is not a unit"},
        {"5 m 2", "m", "is not a unit"},
        {"5 m^1.5", "m", "is not a unit"},
        {"5 m^99", "m", "is not a unit"},
        {"5 10 m", "m", "is not a unit"},
        {"5 (m)", "m", "is not a unit"},
        {"5 m/", "m", "is not a unit"},
        {"5 xyzzy", "m", "'xyzzy' is not a unit"},
        {"5 mM", "m", "did you mean mm?"},
        {"40 mpa", "Pa", "did you mean MPa?"},
        {"m", "m", "'m' is not a number"},
        {"", "m", "there is nothing"},
        {"-", "m", "is not a number"},
        {"e5", "m", "is not a number"},
        {"nan", "m", "is not a finite number"},
        {"-inf", "m", "is not a finite number"},
        {".inf", "m", "is not a finite number"},
        {"1e400", "m", "too large"},
        {"1e308 km", "m", "too large"},
        {"0x10", "m", "not a decimal number"},
        {"1,5 mm", "m", "is not a unit"},
        {"1_000", "m", "is not a unit"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double value;
        ruga_status wanted = strcmp(cases[i].dimension, "nothing") == 0 ? RUGA_LIBRARY : RUGA_BAD_INPUT;
        assert_status(ruga_quantity_parse(cases[i].text, cases[i].dimension, &value), wanted);
        assert_sentence(cases[i].fragment);
    }
}

static int by_name(const void* a, const void* b) {
    return strcmp(*(char* const*)a, *(char* const*)b);
}

// Names that end in .yaml in a folder, in order.
static int list_scenes(const char* folder, char** names, int capacity) {
    DIR* directory = opendir(folder);
    assert_non_null(directory);
    int count = 0;
    for (struct dirent* entry; (entry = readdir(directory)) != NULL && count < capacity;) {
        size_t length = strlen(entry->d_name);
        if (length > 5 && strcmp(entry->d_name + length - 5, ".yaml") == 0) {
            names[count++] = strdup(entry->d_name);
        }
    }
    (void)closedir(directory);
    qsort(names, (size_t)count, sizeof *names, by_name);
    return count;
}

// The first line of a broken scene: "# expect: fragment | fragment", the second may be "# status: mesh".
static bool check_broken(const char* path, const char* name) {
    FILE* file = fopen(path, "r");
    assert_non_null(file);
    char expected[512] = "", second[512] = "";
    assert_non_null(fgets(expected, sizeof expected, file));
    second[0] = fgets(second, sizeof second, file) ? second[0] : '\0';
    (void)fclose(file);
    assert_int_equal(strncmp(expected, "# expect: ", 10), 0);
    expected[strcspn(expected, "\n")] = '\0';

    ruga_scene scene;
    ruga_status wanted = strncmp(second, "# status: mesh", 14) == 0 ? RUGA_BAD_MESH : RUGA_BAD_INPUT;
    ruga_status status = ruga_scene_read(path, 0, NULL, &scene);
    if (status == RUGA_OK) {
        ruga_scene_clear(&scene);
        print_error("%s was read\n", name);
        return false;
    }
    const char* sentence = ruga_last_error();
    if (getenv("RUGA_SHOW")) {
        print_message("%s\n", sentence);
    }
    bool as_expected = status == wanted && strstr(sentence, name);
    for (char* fragment = expected + 10; fragment;) {
        char* bar = strstr(fragment, " | ");
        if (bar) {
            *bar = '\0';
        }
        if (!strstr(sentence, fragment)) {
            print_error("'%s' is not in:\n", fragment);
            as_expected = false;
        }
        fragment = bar ? bar + 3 : NULL;
    }
    if (!as_expected) {
        print_error("%s: %s (%s)\n", name, ruga_status_text(status), sentence);
    }
    return as_expected;
}

static void every_broken_scene_is_refused_with_file_line_and_key(void** state) {
    (void)state;
    char* names[300];
    int wrong = 0, count = list_scenes(SCENES "/bad", names, 300);
    assert_true(count >= 100);
    for (int i = 0; i < count; i++) {
        char path[1024];
        (void)snprintf(path, sizeof path, SCENES "/bad/%s", names[i]);
        wrong += !check_broken(path, names[i]);
        free(names[i]);
    }
    print_message("%d broken scenes refused\n", count - wrong);
    assert_int_equal(wrong, 0);
}

static void every_good_scene_is_read(void** state) {
    (void)state;
    char* names[100];
    int count = list_scenes(SCENES, names, 100);
    assert_true(count >= 6);
    for (int i = 0; i < count; i++) {
        char path[1024];
        (void)snprintf(path, sizeof path, SCENES "/%s", names[i]);
        ruga_scene scene;
        assert_ok(ruga_scene_read(path, 0, NULL, &scene));
        assert_int_equal(scene.warning_count, 0);
        assert_true(scene.def.mesh.triangle_count > 0);

        // The text that the result keeps says the same.
        ruga_scene again;
        assert_ok(ruga_scene_read_text(scene.text, "again.yaml", SCENES, 0, NULL, &again));
        assert_true(again.hash == scene.hash && again.mesh_hash == scene.mesh_hash);
        assert_string_equal(again.text, scene.text);
        ruga_scene_clear(&again);
        ruga_scene_clear(&scene);
        free(names[i]);
    }
}

static void unreadable_text_is_refused(void** state) {
    (void)state;
    assert_refused("", "scene.yaml:1: there is nothing in it");
    assert_refused("# only a comment\n", "scene.yaml:1: there is nothing in it");
    assert_refused("---\n...\n", "scene.yaml:2: a scene is a map");
    assert_refused(MESH "# \xff\xfe\n", "scene.yaml:2: not valid UTF-8");
    assert_refused(MESH "skin: {thickness: \"\\0\"}\n", "scene.yaml:2: a text contains a zero byte");
    assert_refused(MESH "\x01\n", "scene.yaml:2");
    assert_refused("}", "scene.yaml:1: not valid YAML");

    ruga_pool pool = {0};
    ruga_yaml_node* root;
    const char zero[] = "a: 1\0b: 2";
    assert_status(ruga_yaml_read(zero, sizeof zero - 1, "scene.yaml", true, &pool, &root), RUGA_BAD_INPUT);
    assert_status(ruga_yaml_read("", RUGA_YAML_MAX_BYTES + 1, "scene.yaml", true, &pool, &root),
                  RUGA_BAD_INPUT);
    assert_sentence("too many for a scene");
    ruga_pool_clear(&pool);

    ruga_scene scene;
    assert_status(ruga_scene_read(SCENES "/nowhere.yaml", 0, NULL, &scene), RUGA_BAD_INPUT);
    assert_sentence("nowhere.yaml: the scene cannot be opened");
    assert_status(ruga_scene_read(SCENES, 0, NULL, &scene), RUGA_BAD_INPUT);
    assert_sentence("cannot be read");
}

static void exploding_text_is_refused_in_time(void** state) {
    (void)state;
    // Each line ten times the line before: 10^9 values from 400 bytes.
    ruga_string laughs = {0};
    ruga_string_add(&laughs, "a0: &a0 [x]\n");
    for (int i = 1; i < 10; i++) {
        ruga_string_add(&laughs, "a%d: &a%d [", i, i);
        for (int k = 0; k < 10; k++) {
            ruga_string_add(&laughs, "*a%d%s", i - 1, k < 9 ? ", " : "]\n");
        }
    }
    assert_refused(laughs.data, "more than 4000000 values");
    ruga_string_clear(&laughs);

    ruga_string keys = {0};
    for (int i = 0; i < 2000; i++) {
        ruga_string_add(&keys, "k%d: 1\n", i);
    }
    assert_refused(keys.data, "scene.yaml:1001: a map has more than 1000 keys");
    ruga_string_clear(&keys);

    ruga_string brackets = {0};
    for (int i = 0; i < 100000; i++) {
        ruga_string_add(&brackets, "[");
    }
    assert_refused(brackets.data, "scene.yaml:1: lists and maps are nested more than 100 deep");
    ruga_string_clear(&brackets);
}

static void absent_keys_have_the_defaults_of_the_def(void** state) {
    (void)state;
    ruga_scene scene;
    assert_ok(read_string(MESH, &scene));
    ruga_model_def wanted = ruga_default_model_def();
    const ruga_model_def* def = &scene.def;
    assert_memory_equal(&def->skin.growth, &wanted.skin.growth, sizeof def->skin.growth);
    assert_true(def->skin.thickness == wanted.skin.thickness && def->skin.young == wanted.skin.young);
    assert_true(def->skin.poisson == wanted.skin.poisson && def->skin.density == wanted.skin.density);
    assert_true(def->skin.membrane == wanted.skin.membrane && def->skin.motion == wanted.skin.motion);
    assert_true(def->skin.relaxation == wanted.skin.relaxation && def->has_interior == wanted.has_interior);
    assert_true(def->interior.young == wanted.interior.young &&
                def->interior.poisson == wanted.interior.poisson);
    assert_true(def->interior.density == wanted.interior.density &&
                def->interior.damping == wanted.interior.damping);
    assert_true(def->interior.motion == wanted.interior.motion);
    assert_true(def->lattice.cells == wanted.lattice.cells && def->lattice.degree == wanted.lattice.degree);
    assert_true(def->lattice.fill == wanted.lattice.fill && def->lattice.depth == wanted.lattice.depth);
    assert_true(def->coupling.kind == wanted.coupling.kind && def->coupling.rule == wanted.coupling.rule);
    assert_true(def->coupling.foundation == wanted.coupling.foundation && def->coupling.count == 0);
    assert_true(def->coupling.radius == wanted.coupling.radius &&
                def->coupling.sigma == wanted.coupling.sigma);
    assert_true(def->step == wanted.step && def->frames == wanted.frames && def->cookie == wanted.cookie);
    assert_memory_equal(def->gravity, wanted.gravity, sizeof def->gravity);
    assert_true(def->handle_count == 0 && def->keyframe_count == 0);
    assert_true(def->solver.method == wanted.solver.method && def->solver.linear == wanted.solver.linear);
    assert_true(def->solver.tolerance == wanted.solver.tolerance && def->solver.seed == wanted.solver.seed);
    assert_true(def->solver.allow_coarse == wanted.solver.allow_coarse);
    assert_string_equal(scene.mesh_name, "made slab");
    ruga_scene_clear(&scene);
}

static void keys_reach_their_fields(void** state) {
    (void)state;
    ruga_scene scene;
    assert_ok(read_string(
        "mesh: {make: {shape: slab, size: [40 cm, 0.3, 0.2], edge: 100 mm}, scale: 2}\n"
        "skin: {thickness: 1 mm, young: 1 GPa, poisson: -0.5, density: 0, membrane: stvk,\n"
        "  growth: [110 %, 0.9], motion: damped, relaxation: 5 ms}\n"
        "interior: {young: 2 kPa, poisson: 0.4, density: 1 g/cm^3, damping: 3 Hz}\n"
        "lattice: {cells: 9, degree: 1, fill: box, depth: 5 cm}\n"
        "coupling: {kind: spectral, rule: paper, foundation: false, count: 40, radius: 1 cm, sigma: 2 cm}\n"
        "prescribed:\n"
        "  - {time: -1 s, stretch: [50 %, 2, 3], translate: [0, 0, 1 cm]}\n"
        "  - {time: 1 s, matrix: [[1, 2, 3], [4, 5, 6], [7, 8, 9]],\n"
        "     bump: {center: [0, 0, 10 cm], radius: 5 cm, depth: 2 cm}}\n"
        "time: {step: 1 ms, frames: 7}\n"
        "gravity: [0, 0, -9.81]\n"
        "handles:\n"
        "  - {region: {plane: {normal: [0, 0, 1]}}, fix: [y, x]}\n"
        "  - {region: all, move: {translate: [0, 0, 1 mm], rotate: {axis: [0, 2, 0], angle: 90 deg,\n"
        "     center: [1, 0, 0]}, axes: [z]}, during: [1 s, 2 s], hold: skin}\n"
        "  - {region: {vertices: [3, 1]}, force: [1 kN, 0, 0]}\n"
        "solver: {method: quasi-newton, linear: minres, tolerance: 0.1, seed: -12345678901, allow_coarse: "
        "true}\n",
        &scene));
    const ruga_model_def* d = &scene.def;
    assert_near(d->skin.young, 1e9, 0);
    assert_near(d->skin.poisson, -0.5, 0);
    assert_int_equal(d->skin.membrane, RUGA_MEMBRANE_STVK);
    assert_near(d->skin.growth[0], 1.1, 1e-15);
    assert_int_equal(d->skin.motion, RUGA_SKIN_DAMPED);
    assert_near(d->interior.density, 1000, 0);
    assert_int_equal(d->interior.motion, RUGA_INTERIOR_PRESCRIBED); // because keyframes are given
    assert_true(d->lattice.cells == 9 && d->lattice.degree == 1 && d->lattice.fill == RUGA_FILL_BOX);
    assert_true(d->coupling.kind == RUGA_COUPLING_SPECTRAL && d->coupling.rule == RUGA_RULE_PAPER);
    assert_true(!d->coupling.foundation && d->coupling.count == 40 && d->coupling.sigma == 0.02);
    assert_int_equal(d->keyframe_count, 2);
    const double stretch[9] = {0.5, 0, 0, 0, 2, 0, 0, 0, 3};
    assert_memory_equal(d->keyframes[0].matrix, stretch, sizeof stretch);
    assert_true(!d->keyframes[0].has_bump && d->keyframes[0].translate[2] == 0.01);
    for (int i = 0; i < 9; i++) {
        assert_near(d->keyframes[1].matrix[i], i + 1, 0);
    }
    assert_true(d->keyframes[1].has_bump && d->keyframes[1].bump_depth == 0.02);
    assert_near(d->keyframes[1].bump_direction[2], -1, 0);
    assert_true(d->step == 0.001 && d->frames == 7 && d->gravity[2] == -9.81);
    const ruga_handle_def* h = d->handles;
    assert_true(h[0].kind == RUGA_HANDLE_FIX && h[0].axes[0] && h[0].axes[1] && !h[0].axes[2]);
    assert_true(h[0].region.kind == RUGA_REGION_PLANE && h[0].region.normal[2] == 1 && !h[0].ramped);
    assert_true(h[1].kind == RUGA_HANDLE_MOVE && h[1].region.kind == RUGA_REGION_ALL &&
                h[1].hold == RUGA_HOLD_SKIN);
    assert_true(h[1].ramped && h[1].during[0] == 1 && h[1].during[1] == 2 && h[1].axes[2] && !h[1].axes[0]);
    assert_near(h[1].rotate_angle, 1.57079632679489662, 1e-15);
    assert_true(h[2].region.kind == RUGA_REGION_VERTICES && h[2].region.vertex_count == 2);
    assert_true(h[2].region.vertices[0] == 3 && h[2].region.vertices[1] == 1 && h[2].force[0] == 1000);
    assert_true(d->solver.method == RUGA_METHOD_QUASI_NEWTON && d->solver.linear == RUGA_LINEAR_MINRES);
    assert_true(d->solver.seed == -12345678901 && d->solver.allow_coarse);
    double min[3], max[3];
    ruga_mesh_bounds(&scene.mesh, min, max);
    assert_near(max[0] - min[0], 0.8, 1e-12);
    ruga_scene_clear(&scene);
}

static void files_are_scaled_and_odd_sizes_are_told(void** state) {
    (void)state;
    ruga_scene scene;
    assert_ok(read_string("mesh: {file: cube.obj, unit: cm, scale: 3}\n", &scene));
    assert_near(scene.mesh_unit, 0.03, 1e-17);
    double min[3], max[3];
    ruga_mesh_bounds(&scene.mesh, min, max);
    assert_near(max[0] - min[0], 0.03, 1e-15);
    assert_int_equal(scene.warning_count, 0);
    ruga_scene_clear(&scene);

    assert_ok(read_string("mesh: {file: cube.obj, unit: km}\n", &scene));
    assert_int_equal(scene.warning_count, 1);
    assert_non_null(
        strstr(scene.warning[0], "cube.obj: the mesh is 1e+03 m long; is mesh.unit (now 1000 m) right?"));
    ruga_scene_clear(&scene);
    assert_ok(read_string("mesh: {file: cube.obj, unit: um}\n", &scene));
    assert_int_equal(scene.warning_count, 1);
    ruga_scene_clear(&scene);
}

static void vertices_are_those_of_the_file(void** state) {
    (void)state;
    ruga_scene scene;
    // Of the open box's side groups only the top is kept: file vertices 4 to 7 are mesh vertices 0 to 3.
    assert_ok(read_string("mesh: {file: cube.obj, groups: [top]}\ninterior: none\n"
                          "handles: [{region: {vertices: [6, 4]}, fix: true}]\n",
                          &scene));
    assert_int_equal(scene.mesh.vertex_count, 4);
    assert_int_equal(scene.def.handles[0].region.vertices[0], 2);
    assert_int_equal(scene.def.handles[0].region.vertices[1], 0);
    ruga_scene_clear(&scene);
    assert_refused("mesh: {file: cube.obj, groups: [top]}\ninterior: none\n"
                   "handles: [{region: {vertices: [0]}, fix: true}]\n",
                   "scene.yaml:3: handles.0.region: vertex 0 is not in the mesh");
}

static void regions_may_lie_inside_the_material(void** state) {
    (void)state;
    static const char inside[] = "{sphere: {radius: 4 cm}}";
    char text[512];
    ruga_scene scene;
    (void)snprintf(text, sizeof text, "%shandles: [{region: %s, fix: true}]\n", MESH, inside);
    assert_ok(read_string(text, &scene));
    ruga_scene_clear(&scene);
    // The skin is not there.
    (void)snprintf(text, sizeof text, "%shandles: [{region: %s, fix: true, hold: skin}]\n", MESH, inside);
    assert_refused(text, "handles.0.region: the region selects nothing");
    (void)snprintf(text, sizeof text, "%shandles: [{region: %s, force: [1, 0, 0]}]\n", MESH, inside);
    assert_refused(text, "handles.0.region: the region selects nothing");
    (void)snprintf(text, sizeof text, "%sinterior: none\nhandles: [{region: %s, fix: true}]\n", MESH, inside);
    assert_refused(text, "handles.0.region: the region selects nothing");
    // Beside the mesh there is material only where the lattice fills a box.
    static const char beside[] =
        MESH "lattice: {fill: %s}\nhandles: [{region: {plane: {center: [0, 0, -0.5], "
             "normal: [0, 0, -1]}}, fix: true}]\n";
    (void)snprintf(text, sizeof text, beside, "box");
    assert_ok(read_string(text, &scene));
    ruga_scene_clear(&scene);
    (void)snprintf(text, sizeof text, beside, "mesh");
    assert_refused(text, "the region selects nothing; the mesh reaches from (-0.2, -0.15, -0.1)");
}

static void remeshing_comes_before_regions(void** state) {
    (void)state;
    ruga_scene coarse, fine;
    assert_ok(read_string("mesh: {file: cube.obj}\nhandles: [{region: {group: top}, press: 1}]\n", &coarse));
    assert_ok(read_string(
        "mesh: {file: cube.obj, remesh: {edge: 20 cm}}\nhandles: [{region: {group: top}, press: 1}]\n",
        &fine));
    assert_true(fine.mesh.triangle_count > 10 * coarse.mesh.triangle_count);
    assert_near(ruga_mesh_mean_edge(&fine.mesh), 0.2, 0.06);
    assert_near(ruga_mesh_volume(&fine.mesh), 1, 1e-9);
    assert_true(fine.mesh_hash != coarse.mesh_hash && fine.hash != coarse.hash);
    ruga_scene_clear(&coarse);
    ruga_scene_clear(&fine);
}

// Real surfaces as the mesh of an embedded scene: closed ones are read, open ones end with the hole's place.
static void real_surfaces_are_read_or_refused(void** state) {
    (void)state;
    static const struct {
        const char* name;
        ruga_status status;
    } files[] = {
        {"sh3d_blanket.obj", RUGA_BAD_MESH},
        {"ipc_sheet2000.obj", RUGA_BAD_MESH},
        {"makehuman_base.obj", RUGA_BAD_MESH},
        {"makehuman_sportsuit01.obj", RUGA_BAD_MESH},
        {"makehuman_skirt.obj", RUGA_BAD_MESH},
        {"spot_control_mesh.obj", RUGA_BAD_MESH},
        {"market_pillow.gltf", RUGA_BAD_INPUT}, // compressed
        {"market_pillow_watertight.obj", RUGA_OK},
        {"market_sofa_watertight.obj", RUGA_OK},
        {"sh3d_teddyBear_body_watertight.obj", RUGA_OK},
        {"makehuman_head_watertight.obj", RUGA_OK},
    };
    const char* data = getenv("RUGA_DATA");
    char folder[512], text[256];
    (void)snprintf(folder, sizeof folder, "%s/surface", data ? data : RUGA_SOURCE_DIR "/../shared/data");
    DIR* directory = opendir(folder);
    if (!directory) {
        print_message("skipped: no surfaces in %s; set RUGA_DATA\n", folder);
        skip();
    }
    (void)closedir(directory);
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        (void)snprintf(text, sizeof text, "mesh: {file: %s}\n", files[i].name);
        ruga_scene scene;
        assert_status(ruga_scene_read_text(text, "scene.yaml", folder, 0, NULL, &scene), files[i].status);
        if (files[i].status == RUGA_OK) {
            ruga_scene_clear(&scene);
        } else {
            assert_sentence("scene.yaml:1: mesh.file: ");
            assert_sentence(files[i].name);
        }
    }
}

static void sets_are_applied_before_validation(void** state) {
    (void)state;
    static const char* const sets[] = {"skin.thickness=3 mm",   "gravity=[0, 0, -9.81]",
                                       "handles.0.press=5 kPa", "prescribed=[{time: 0}]",
                                       "skin.thickness=4 mm",   "gravity.2=-1"};
    ruga_scene scene;
    assert_ok(ruga_scene_read_text(MESH "skin: {thickness: 2 mm}\nhandles: [{region: all, press: 1}]\n",
                                   "scene.yaml", SCENES, 6, sets, &scene));
    assert_near(scene.def.skin.thickness, 0.004, 0);
    assert_near(scene.def.gravity[2], -1, 0);
    assert_near(scene.def.handles[0].pressure, 5000, 0);
    assert_int_equal(scene.def.interior.motion, RUGA_INTERIOR_PRESCRIBED);
    assert_non_null(strstr(scene.text, "thickness: 4 mm"));
    ruga_scene_clear(&scene);

    static const struct {
        const char *set, *fragment;
    } bad[] = {
        {"skin.thicknes=1 mm",
         "--set skin.thicknes=1 mm: skin.thicknes: unknown key; did you mean skin.thickness?"},
        {"skni.thickness=1 mm", "--set skni.thickness=1 mm: skni: unknown key; did you mean skin?"},
        {"skin.thickness=-1 mm", "--set skin.thickness=-1 mm: skin.thickness: -1 mm is not above 0"},
        {"skin.thickness=1 s", "1 s is a time, but a length (m)"},
        {"skin.thickness", "write --set key.path=value"},
        {"skin.thickness=", "write --set key.path=value"},
        {"=5", "write --set key.path=value"},
        {"skin..young=5", "a part of the key path is empty"},
        {".young=5", "a part of the key path is empty"},
        {"skin.=5", "a part of the key path is empty"},
        {"skin.thickness.x=5", "'x' cannot be set inside of '2 mm', which is no map"},
        {"handles.7.press=5", "'7' is no entry of this list of 1 (counted from 0)"},
        {"handles.press=5", "'press' is no entry of this list"},
        {"gravity=[0, 0", "not valid YAML"},
        {"interior=nothing", "or the word none"},
        {"time.frames=0", "time.frames: 0 is not between"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_status(read_with(MESH "skin: {thickness: 2 mm}\nhandles: [{region: all, press: 1}]\n",
                                bad[i].set, &scene),
                      RUGA_BAD_INPUT);
        assert_sentence(bad[i].fragment);
        assert_sentence("--set ");
    }
}

static uint64_t hash_of(const char* text) {
    ruga_scene scene;
    assert_ok(read_string(text, &scene));
    uint64_t hash = scene.hash;
    ruga_scene_clear(&scene);
    return hash;
}

static void hash_is_of_what_a_scene_says(void** state) {
    (void)state;
    uint64_t hash = hash_of(MESH "skin: {thickness: 1 mm, young: 1 MPa}\ntime: {frames: 9}\n");
    assert_true(
        hash ==
        hash_of("# a comment\ntime: {frames: 9}\nskin:\n  young:   1e6 # Pa\n  thickness: '0.001'\n" MESH));
    assert_true(hash == hash_of(MESH "skin: {thickness: 1 mm, young: 1000 kPa, poisson: 0.3}\nruga: 1\n"));
    assert_true(hash ==
                hash_of(MESH "skin: {thickness: 1 mm, young: 1 MPa}\ntime: {frames: 10}\n")); // may resume
    assert_true(hash != hash_of(MESH "skin: {thickness: 2 mm, young: 1 MPa}\n"));
    assert_true(hash != hash_of(MESH "skin: {thickness: 1 mm, young: 1 MPa}\ngravity: [0, 0, -1]\n"));
    assert_true(hash != hash_of(MESH "skin: {thickness: 1 mm, young: 1 MPa}\ninterior: none\n"));
    assert_true(hash !=
                hash_of(MESH "skin: {thickness: 1 mm, young: 1 MPa}\nhandles: [{region: all, press: 1}]\n"));
    uint64_t fixed = hash_of(MESH "handles: [{region: all, fix: [x]}]\n");
    assert_true(fixed != hash_of(MESH "handles: [{region: all, fix: [y]}]\n"));
    assert_true(hash_of(MESH "handles: [{region: all, fix: true}]\n") ==
                hash_of(MESH "handles: [{region: {all: true}, fix: [z, y, x]}]\n"));
    assert_true(fixed == hash_of(MESH "handles: [{fix: [x], region: all, hold: both}]\n"));
}

typedef struct visits {
    int count, given;
    bool thickness, frames;
} visits;

static void count_visit(const char* key, const char* value, const char* unit, bool given, void* context) {
    visits* v = context;
    v->count++;
    v->given += given;
    assert_true(key[0] != '\0' && value[0] != '\0' && unit);
    if (strcmp(key, "skin.thickness") == 0) {
        assert_true(given && strcmp(value, "0.001") == 0 && strcmp(unit, "m") == 0);
        v->thickness = true;
    }
    if (strcmp(key, "time.frames") == 0) {
        assert_true(!given && strcmp(value, "50") == 0);
        v->frames = true;
    }
    if (strcmp(key, "interior") == 0) {
        assert_true(given && strcmp(value, "none") == 0);
    }
    assert_null(strstr(key, "lattice"));
}

static void each_shows_every_key_with_its_value(void** state) {
    (void)state;
    ruga_scene scene;
    assert_ok(read_string(MESH "skin: {thickness: 1 mm}\ninterior: none\n", &scene));
    visits v = {0};
    ruga_scene_each(&scene, count_visit, &v);
    assert_true(v.thickness && v.frames);
    assert_int_equal(v.given, 5); // shape, size, edge, thickness, interior
    ruga_scene_clear(&scene);
    ruga_scene_each(&scene, count_visit, &v); // a cleared scene has none
}

static void aliases_are_copies(void** state) {
    (void)state;
    ruga_scene scene;
    assert_ok(ruga_scene_read(SCENES "/aliases.yaml", 0, NULL, &scene));
    assert_near(scene.def.interior.poisson, 0.25, 0);
    assert_int_equal(scene.def.handle_count, 3);
    assert_int_equal(scene.def.handles[2].kind, RUGA_HANDLE_FIX);
    ruga_scene_clear(&scene);
}

static void numbers_do_not_depend_on_the_locale(void** state) {
    (void)state;
    const char* names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"};
    uint64_t before = hash_of(MESH "skin: {thickness: 0.4 mm, poisson: 0.25}\n");
    const char* found = NULL;
    for (int i = 0; i < 4 && !found; i++) {
        found = setlocale(LC_ALL, names[i]);
    }
    if (!found) {
        print_message("skipped: no locale with a decimal comma is installed\n");
        skip();
    }
    uint64_t after = hash_of(MESH "skin: {thickness: 0.4 mm, poisson: 0.25}\n");
    (void)setlocale(LC_ALL, "C");
    assert_true(before == after);
}

static const char all_keys[] =
    "ruga: 1\nskin: {thickness: 1 mm, young: 1 GPa, membrane: stvk, growth: [110 %, 0.9]}\n"
    "interior: {young: &y 2 kPa, poisson: 0.4, density: 1 g/cm^3, damping: 3 Hz}\n"
    "lattice: {cells: 9, degree: 1, fill: box, depth: 5 cm}\n"
    "coupling: {kind: spectral, rule: paper, foundation: false, radius: 1 cm, sigma: 2 cm}\n"
    "prescribed:\n  - {time: -1 s, stretch: [50 %, 2, 3], translate: [0, 0, 1 cm]}\n"
    "  - time: 1 s\n    matrix: [[1, 2, 3], [4, 5, 6], [7, 8, 9]]\n"
    "    bump: {center: [0, 0, 10 cm], radius: 5 cm, depth: 2 cm}\n"
    "time: {step: 1 ms, frames: 7}\ngravity: [0, 0, -9.81]\n"
    "handles:\n  - {region: {plane: {normal: [0, 0, 1]}}, fix: [y, x]}\n"
    "  - &h {region: all, move: {translate: [0, 0, 1 mm], rotate: {angle: 90 deg}}, during: [1 s, 2 s]}\n"
    "  - {region: {vertices: [3, 1]}, force: [1 kN, 0, 0]}\n  - *h\n"
    "solver: {method: \"newton\", tolerance: 0.1, seed: 5}\n";

static const char from_file[] = "mesh: {file: cube.obj, unit: m, scale: 1.0, groups: [top, rest]}\n";

// Changes up to three bytes of `text` from `first` on.
static void mutate(char* text, size_t first, ruga_random* random) {
    static const char spice[] = "{}[]:,&*!|>'\"%@`#-? \n\t.0123456789eE+\xc2\xb5\x80\xff=~";
    for (int changes = 1 + (int)(ruga_random_next(random) % 3); changes > 0; changes--) {
        size_t length = strlen(text) - first;
        size_t at = first + ruga_random_next(random) % length;
        switch (ruga_random_next(random) % 4) {
        case 0:
            text[at] = (char)(1 + ruga_random_next(random) % 255);
            break;
        case 1:
            text[at] = text[first + ruga_random_next(random) % length];
            break;
        case 2:
            memmove(text + at, text + at + 1, strlen(text + at));
            break;
        default:
            text[at] = spice[ruga_random_next(random) % (sizeof spice - 1)];
        }
    }
}

static void mutated_scenes_neither_crash_nor_leak(void** state) {
    (void)state;
    ruga_random random = {2024};
    int good = 0;
    size_t before = ruga_byte_count();
    for (int round = 0; round < 2000; round++) {
        // A mutated size of a made shape could ask for any number of triangles: that line stays.
        const char* mesh = round % 2 ? MESH : from_file;
        char text[sizeof all_keys + sizeof MESH + sizeof from_file];
        (void)snprintf(text, sizeof text, "%s%s", mesh, all_keys);
        if (round > 1) {
            mutate(text, round % 2 ? sizeof MESH - 1 : 0, &random);
        }
        ruga_scene scene;
        ruga_status status = read_string(text, &scene);
        if (status == RUGA_OK) {
            good++;
            ruga_scene_clear(&scene);
        } else {
            assert_true(status == RUGA_BAD_INPUT || status == RUGA_BAD_MESH);
            assert_true(round > 1);
            assert_sentence("scene.yaml:");
        }
        assert_int_equal(ruga_byte_count(), before);
    }
    print_message("%d of 2000 mutated scenes are still valid\n", good);
}

static void every_failing_allocation_is_survived(void** state) {
    (void)state;
    ruga_status status = RUGA_NO_MEMORY;
    ruga_set_allocator(allocate_some, free_some, NULL);
    int k = 0;
    size_t before = ruga_byte_count();
    for (; status == RUGA_NO_MEMORY && k < 100000; k++) {
        allocations_left = k;
        ruga_scene scene;
        static const char* const sets[] = {"skin.young=3 MPa"};
        status = ruga_scene_read_text(MESH "handles: [{region: {vertices: [1]}, fix: true}]\n", "scene.yaml",
                                      SCENES, 1, sets, &scene);
        if (status == RUGA_OK) {
            ruga_scene_clear(&scene);
        }
        if (ruga_byte_count() != before) {
            break;
        }
    }
    ruga_set_allocator(NULL, NULL, NULL);
    assert_status(status, RUGA_OK);
    assert_int_equal(ruga_byte_count(), before);
    assert_true(k > 10);
    print_message("%d allocations\n", k - 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantities_become_si),
        cmocka_unit_test(what_is_no_quantity_is_refused),
        cmocka_unit_test(every_broken_scene_is_refused_with_file_line_and_key),
        cmocka_unit_test(every_good_scene_is_read),
        cmocka_unit_test(unreadable_text_is_refused),
        cmocka_unit_test(exploding_text_is_refused_in_time),
        cmocka_unit_test(absent_keys_have_the_defaults_of_the_def),
        cmocka_unit_test(keys_reach_their_fields),
        cmocka_unit_test(files_are_scaled_and_odd_sizes_are_told),
        cmocka_unit_test(vertices_are_those_of_the_file),
        cmocka_unit_test(regions_may_lie_inside_the_material),
        cmocka_unit_test(remeshing_comes_before_regions),
        cmocka_unit_test(real_surfaces_are_read_or_refused),
        cmocka_unit_test(sets_are_applied_before_validation),
        cmocka_unit_test(hash_is_of_what_a_scene_says),
        cmocka_unit_test(each_shows_every_key_with_its_value),
        cmocka_unit_test(aliases_are_copies),
        cmocka_unit_test(numbers_do_not_depend_on_the_locale),
        cmocka_unit_test(mutated_scenes_neither_crash_nor_leak),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests_name("scene", tests, NULL, check_no_leak);
}
