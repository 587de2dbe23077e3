// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// docs/scene.md: it is what the table of keys says, and its examples can be read.
#include "io/scene.h"
#include "io/scene_schema.h"
#include "tests/check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MESH "mesh: {make: {shape: slab, size: [0.4, 0.3, 0.2], edge: 10 cm}}\n"

// docs/scene.md is made from the table; RUGA_WRITE_DOCS writes it anew.
static void reference_is_up_to_date(void** state) {
    (void)state;
    ruga_string wanted = {0};
    assert_ok(ruga_scene_reference(&wanted));
    if (getenv("RUGA_WRITE_DOCS")) {
        FILE* out = fopen(RUGA_SOURCE_DIR "/docs/scene.md", "w");
        assert_non_null(out);
        (void)fputs(wanted.data, out);
        (void)fclose(out);
    }
    FILE* file = fopen(RUGA_SOURCE_DIR "/docs/scene.md", "r");
    assert_non_null(file);
    char* found = calloc(1, (size_t)wanted.length + 1000);
    size_t length = fread(found, 1, (size_t)wanted.length + 999, file);
    (void)fclose(file);
    bool same = length == (size_t)wanted.length && memcmp(found, wanted.data, length) == 0;
    free(found);
    ruga_string_clear(&wanted);
    if (!same) {
        print_error("docs/scene.md is out of date: run RUGA_WRITE_DOCS=1 test_scene_reference\n");
        fail();
    }
}

// Each part of a scene has an example that is a scene, once it is told the mesh.
static void every_part_has_an_example(void** state) {
    (void)state;
    for (int i = 0; i < ruga_key_count; i++) {
        const ruga_key* key = &ruga_keys[i];
        if (strchr(key->path, '.') || key->kind == RUGA_KEY_LATER) {
            continue;
        }
        const char* example = ruga_key_example(key);
        if (!example) {
            fail_msg("%s has no example in io/scene_keys.c", key->path);
        }
        char text[1024];
        (void)snprintf(text, sizeof text, "%s%s", strstr(example, "mesh:") ? "" : MESH, example);
        ruga_scene scene;
        if (ruga_scene_read_text(text, "example.yaml", RUGA_SOURCE_DIR "/tests/scenes", 0, NULL, &scene) !=
            RUGA_OK) {
            fail_msg("%s: %s", key->path, ruga_last_error());
        }
        ruga_scene_clear(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reference_is_up_to_date),
        cmocka_unit_test(every_part_has_an_example),
    };
    return cmocka_run_group_tests_name("scene_reference", tests, NULL, check_no_leak);
}
