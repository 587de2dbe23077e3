// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// skin.vary: from regions, gradients, attributes and textures to values at the vertices.
// tests/scenes/vary.ply is a sheet of 4 x 2 quads, x in [0, 0.4], y in [0, 0.2], with thickness_mm = 1 + 5 x,
// weight = 1000 y and uv = x / 0.4, y / 0.2; ramp.png has the greys 0, 0.2, .., 0.8 in its lower row and
// white above. Refusals: tests/scenes/bad/vary_*.
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "io/mesh_file.h"
#include "io/scene.h"
#include "io/texture.h"

#include <stdlib.h>
#include <string.h>

#define SCENES RUGA_SOURCE_DIR "/tests/scenes"
#define SHEET  "mesh: {file: vary.ply, unit: m}\ninterior: none\n"

static ruga_scene read_scene(const char* text) {
    ruga_scene scene;
    assert_ok(ruga_scene_read_text(text, "scene.yaml", SCENES, 0, NULL, &scene));
    return scene;
}

static const double* at(const ruga_scene* scene, int v) {
    return scene->mesh.position + 3 * (size_t)v;
}

static void without_entries_there_are_no_arrays(void** state) {
    (void)state;
    ruga_scene scene = read_scene(SHEET);
    assert_null(scene.def.skin.vertex_thickness);
    assert_null(scene.def.skin.vertex_young);
    assert_null(scene.def.skin.vertex_growth);
    ruga_scene_clear(&scene);
}

static void later_entries_override_earlier_ones(void** state) {
    (void)state;
    ruga_scene scene =
        read_scene(SHEET "skin: {thickness: 3 mm, young: 7 MPa, growth: [1.2, 1], vary: [\n"
                         "  {region: {plane: {center: [0.2, 0, 0], normal: [1, 0, 0]}}, thickness: 1 mm,"
                         " growth_v: 1.1},\n"
                         "  {region: {vertices: [4, 0]}, thickness: 2 mm}]}\n");
    const ruga_skin_def* skin = &scene.def.skin;
    assert_int_equal(skin->vertex_count, scene.mesh.vertex_count);
    assert_null(skin->vertex_young);
    for (int v = 0; v < scene.mesh.vertex_count; v++) {
        bool right = at(&scene, v)[0] > 0.199;
        assert_near(skin->vertex_thickness[v], v == 0 || v == 4 ? 2e-3 : right ? 1e-3 : 3e-3, 0);
        assert_near(skin->vertex_growth[2 * v], 1.2, 0);
        assert_near(skin->vertex_growth[2 * v + 1], right ? 1.1 : 1, 0);
    }
    ruga_scene_clear(&scene);
}

static void a_gradient_is_linear_and_held_outside(void** state) {
    (void)state;
    ruga_scene scene = read_scene(SHEET "skin: {vary: [{gradient: {from: [0.1, 5, 0], to: [30 cm, 5, 0]}, "
                                        "young: [10 MPa, 20 MPa]}]}\n");
    for (int v = 0; v < scene.mesh.vertex_count; v++) {
        double t = fmin(fmax((at(&scene, v)[0] - 0.1) / 0.2, 0), 1);
        assert_near(scene.def.skin.vertex_young[v], 1e7 * (1 + t), 1);
    }
    ruga_scene_clear(&scene);
}

static void an_attribute_goes_on_beyond_its_two_values(void** state) {
    (void)state;
    ruga_scene scene =
        read_scene(SHEET "skin: {vary: [{attribute: thickness_mm, thickness: [0, 1 mm]}, "
                         "{attribute: weight, young: [1 MPa, 2 MPa], region: {box: [[0, 0.05, 0], "
                         "[1, 1, 0]]}}]}\n");
    for (int v = 0; v < scene.mesh.vertex_count; v++) {
        double weight = 1000 * at(&scene, v)[1];
        assert_near(scene.def.skin.vertex_thickness[v], 1e-3 * (1 + 5 * at(&scene, v)[0]), 1e-9);
        assert_near(scene.def.skin.vertex_young[v], weight > 0 ? 1e6 * (1 + weight) : 40e6, 1e-3);
    }
    ruga_scene_clear(&scene);
}

// u times 5 pixels less half a one; the middle row lies between the ramp and white.
static void a_texture_maps_grey_between_its_two_values(void** state) {
    (void)state;
    ruga_scene scene = read_scene(SHEET "skin: {vary: [{texture: ramp.png, thickness: [1 mm, 2 mm]}]}\n");
    for (int v = 0; v < scene.mesh.vertex_count; v++) {
        double ramp = 0.2 * fmin(fmax(5 * at(&scene, v)[0] / 0.4 - 0.5, 0), 4), up = at(&scene, v)[1] / 0.2;
        double grey = up < 0.25 ? ramp : up > 0.75 ? 1 : 0.5 * (1 + ramp);
        assert_near(scene.def.skin.vertex_thickness[v], 1e-3 * (1 + grey), 1e-9);
    }
    ruga_scene_clear(&scene);
    scene = read_scene(SHEET "skin: {vary: [{texture: ramp16.png, thickness: [1 mm, 2 mm]}]}\n");
    assert_near(scene.def.skin.vertex_thickness[1], 1e-3, 1e-9);
    assert_near(scene.def.skin.vertex_thickness[2], 1.5e-3, 1e-9);
    assert_near(scene.def.skin.vertex_thickness[3], 2e-3, 1e-9);
    ruga_scene_clear(&scene);
}

// quad.gltf is a unit square whose uv are x and 1 - y, as glTF has it.
static void a_texture_stands_upright_on_gltf_too(void** state) {
    (void)state;
    ruga_scene scene = read_scene("mesh: {file: quad.gltf, unit: m}\ninterior: none\n"
                                  "skin: {vary: [{texture: ramp.png, thickness: [1 mm, 2 mm]}]}\n");
    for (int v = 0; v < scene.mesh.vertex_count; v++) {
        double grey = at(&scene, v)[1] > 0.5 ? 1 : at(&scene, v)[0] > 0.5 ? 0.8 : 0;
        assert_near(scene.def.skin.vertex_thickness[v], 1e-3 * (1 + grey), 1e-9);
    }
    ruga_scene_clear(&scene);
}

static void attributes_and_textures_survive_remeshing(void** state) {
    (void)state;
    ruga_scene scene = read_scene("mesh: {file: vary.ply, unit: m, remesh: {edge: 3 cm}}\ninterior: none\n"
                                  "skin: {vary: [{attribute: thickness_mm, thickness: [0, 1 mm]}, "
                                  "{texture: ramp16.png, young: [1 MPa, 2 MPa]}]}\n");
    assert_true(scene.mesh.vertex_count > 60);
    assert_int_equal(scene.mesh.attribute_count, 2);
    for (int v = 0; v < scene.mesh.vertex_count; v++) {
        double x = at(&scene, v)[0], grey = fmin(fmax(2 * x / 0.4 - 0.5, 0), 1);
        assert_near(scene.def.skin.vertex_thickness[v], 1e-3 * (1 + 5 * x), 1e-8);
        assert_near(scene.def.skin.vertex_young[v], 1e6 * (1 + grey), 1);
    }
    ruga_scene_clear(&scene);
}

static void copy_file(const char* from, const char* to) {
    char bytes[4096];
    FILE *in = fopen(from, "rb"), *out = fopen(to, "wb");
    assert_true(in && out);
    size_t size = fread(bytes, 1, sizeof bytes, in);
    assert_int_equal(fwrite(bytes, 1, size, out), size);
    (void)fclose(in);
    (void)fclose(out);
}

// Another value far from any key: the files' content counts.
static void the_hash_sees_what_attributes_and_textures_hold(void** state) {
    (void)state;
    static const char* const pictures[] = {SCENES "/ramp16.png", SCENES "/ramp.png", SCENES "/ramp.png"};
    uint64_t hash[3];
    for (int k = 0; k < 3; k++) {
        ruga_scene scene;
        copy_file(pictures[k], "vary_copy.png");
        assert_ok(ruga_scene_read_text("mesh: {file: " SCENES "/vary.ply, unit: m}\ninterior: none\n"
                                       "skin: {vary: [{texture: vary_copy.png, thickness: [1 mm, 2 mm]}]}\n",
                                       "scene.yaml", ".", 0, NULL, &scene));
        hash[k] = scene.hash;
        ruga_scene_clear(&scene);
    }
    (void)remove("vary_copy.png");
    assert_true(hash[0] != hash[1] && hash[1] == hash[2]);
    // A list without entries is none at all.
    ruga_scene none = read_scene(SHEET), empty = read_scene(SHEET "skin: {vary: []}\n");
    assert_true(none.hash == empty.hash);
    ruga_scene_clear(&none);
    ruga_scene_clear(&empty);
}

static void attributes_survive_a_file(void** state) {
    (void)state;
    ruga_mesh mesh, again;
    assert_ok(ruga_mesh_read(SCENES "/vary.ply", &mesh));
    assert_int_equal(mesh.attribute_count, 2); // and not the normals
    assert_string_equal(mesh.attribute_name[0], "thickness_mm");
    assert_string_equal(mesh.attribute_name[1], "weight");
    assert_ok(ruga_mesh_write("vary_test.ply", &mesh, NULL, NULL));
    assert_ok(ruga_mesh_read("vary_test.ply", &again));
    assert_int_equal(again.attribute_count, 2);
    assert_memory_equal(again.attribute, mesh.attribute, 30 * sizeof(double));
    (void)remove("vary_test.ply");
    ruga_mesh_clear(&again);
    assert_ok(ruga_mesh_copy(&mesh, &again));
    assert_memory_equal(again.attribute, mesh.attribute, 30 * sizeof(double));
    ruga_mesh_clear(&again);
    ruga_mesh_clear(&mesh);
}

static void a_texture_of_one_pixel_is_a_number(void** state) {
    (void)state;
    double grey = 0.25;
    ruga_texture texture = {1, 1, &grey};
    const double uv[3][2] = {{0, 0}, {0.3, 0.9}, {-4, 7}};
    for (int k = 0; k < 3; k++) {
        assert_near(ruga_texture_at(&texture, uv[k]), 0.25, 0);
    }
}

static void any_allocation_may_fail(void** state) {
    (void)state;
    ruga_status status = RUGA_NO_MEMORY;
    for (int k = 0; status != RUGA_OK; k++) {
        ruga_scene scene;
        let_allocations_fail_after(k);
        status = ruga_scene_read_text(SHEET "skin: {vary: [{attribute: weight, young: [1 MPa, 2 MPa]}, "
                                            "{texture: ramp.png, thickness: [1 mm, 2 mm]}]}\n",
                                      "scene.yaml", SCENES, 0, NULL, &scene);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
        ruga_scene_clear(&scene);
        ruga_set_allocator(NULL, NULL, NULL);
    }
}

static void settings_are_read_without_the_mesh(void** state) {
    (void)state;
    static const char text[] = "mesh: {file: gone.obj, unit: mm}\nskin: {thickness: 3 mm, young: 7 MPa}\n"
                               "interior: {young: 0.1 MPa}\nlattice: {cells: 9}\ngravity: [0, -9.81, 0]\n";
    ruga_scene scene;
    assert_status(ruga_scene_read_text(text, "scene.yaml", SCENES, 0, NULL, &scene), RUGA_BAD_INPUT);
    assert_ok(ruga_scene_read_settings(text, "scene.yaml", &scene));
    assert_true(scene.def.skin.young == 7e6 && scene.def.lattice.cells == 9 && scene.def.gravity[1] == -9.81);
    assert_int_equal(scene.mesh.vertex_count, 0);
    ruga_scene_clear(&scene);
    assert_status(ruga_scene_read_settings("skin: {thicknes: 1 mm}", "scene.yaml", &scene), RUGA_BAD_INPUT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_entries_there_are_no_arrays),
        cmocka_unit_test(later_entries_override_earlier_ones),
        cmocka_unit_test(a_gradient_is_linear_and_held_outside),
        cmocka_unit_test(an_attribute_goes_on_beyond_its_two_values),
        cmocka_unit_test(a_texture_maps_grey_between_its_two_values),
        cmocka_unit_test(a_texture_stands_upright_on_gltf_too),
        cmocka_unit_test(attributes_and_textures_survive_remeshing),
        cmocka_unit_test(the_hash_sees_what_attributes_and_textures_hold),
        cmocka_unit_test(attributes_survive_a_file),
        cmocka_unit_test(a_texture_of_one_pixel_is_a_number),
        cmocka_unit_test(any_allocation_may_fail),
        cmocka_unit_test(settings_are_read_without_the_mesh),
    };
    return cmocka_run_group_tests_name("scene_vary", tests, NULL, check_no_leak);
}
