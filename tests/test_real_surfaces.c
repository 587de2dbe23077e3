// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Doctor and remeshing on surfaces that nobody here made; expected figures by independent readers. Theirs cut
// polygons into fans, ours does not, so that numbers of crossing faces differ where polygons cross.
#include "tests/check.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "io/mesh_file.h"
#include "mesh/doctor.h"
#include "mesh/remesh.h"

#include <stdlib.h>

// RUGA_DATA or ../shared/data of the source tree; false, after saying so, where the file is not there.
static bool read_surface(const char* name, ruga_mesh* mesh) {
    const char* data = getenv("RUGA_DATA");
    char path[1024];
    (void)snprintf(path, sizeof path, "%s/surface/%s", data ? data : RUGA_SOURCE_DIR "/../shared/data", name);
    FILE* file = fopen(path, "rb");
    if (!file) {
        print_message("skipped: %s is not there (set RUGA_DATA)\n", path);
        return false;
    }
    (void)fclose(file);
    assert_ok(ruga_mesh_read(path, mesh));
    return true;
}

static void doctor_finds_what_independent_readers_found(void** state) {
    (void)state;
    static const struct expected {
        const char* file;
        int components, genus, open, self_intersections, overlaps;
    } rows[] = {
        {"makehuman_base.obj", 154, -1, 784, 0, 2364},
        {"makehuman_head_watertight.obj", 1, 0, 0, 0, 0},
        {"makehuman_head_mouth-corner-puller_watertight.obj", 1, 0, 0, 0, 0},
        {"market_pillow_watertight.obj", 1, 0, 0, 0, 0},
        {"market_sofa_watertight.obj", 9, 0, 0, 0, 1164},
        {"sh3d_teddyBear_body_watertight.obj", 1, 0, 0, 0, 0},
        {"spot_low_resolution.obj", 1, 0, 0, 0, 0},
        {"spot_control_mesh.obj", 1, 0, 0, 14, 0},
        {"makehuman_skirt.obj", 1, -1, 72, 0, 0},
        {"makehuman_sportsuit01.obj", 2, -1, 164, 0, 0},
        {"sh3d_blanket.obj", 1, -1, 528, 147, 0},
        {"ipc_mat40x40.obj", 1, 0, 0, 0, 0},
        {"ipc_sheet2000.obj", 1, -1, 176, 0, 0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const struct expected* row = &rows[i];
        ruga_mesh mesh;
        if (!read_surface(row->file, &mesh)) {
            skip();
        }
        ruga_check_report report;
        assert_ok(ruga_mesh_check(&mesh, RUGA_CHECK_EMBEDDED, &report));
        assert_int_equal(report.count[RUGA_DEFECT_OPEN_EDGE], row->open);
        int self = report.count[RUGA_DEFECT_SELF_INTERSECTION];
        int overlaps = report.count[RUGA_DEFECT_OVERLAP];
        print_message("%s: %d self-intersections (%d with fans), %d overlaps (%d)\n", row->file, self,
                      row->self_intersections, overlaps, row->overlaps);
        double slack = mesh.polygon ? 0.2 : 0;
        assert_near(self, row->self_intersections, slack * row->self_intersections);
        assert_near(overlaps, row->overlaps, slack * row->overlaps);
        assert_int_equal(report.error_count, row->open + self);
        assert_int_equal(report.component_count, row->components);
        assert_int_equal(report.genus, row->genus);
        assert_int_equal(report.watertight, row->open == 0);
        assert_int_equal(ruga_check_status(&report, row->file) == RUGA_OK, report.error_count == 0);
        ruga_check_report_clear(&report);
        ruga_mesh_clear(&mesh);
    }
}

static void remesh_one(const char* file, const char* group, double edge, double smallest_angle) {
    ruga_mesh mesh, part, remeshed;
    if (!read_surface(file, &mesh)) {
        skip();
    }
    if (group) {
        assert_ok(ruga_mesh_extract_groups(&mesh, 1, &group, &part));
        ruga_mesh_clear(&mesh);
        mesh = part;
    }
    ruga_check_report before, after;
    assert_ok(ruga_mesh_check(&mesh, RUGA_CHECK_EMBEDDED, &before));
    assert_ok(ruga_mesh_remesh(&mesh, edge, &remeshed));
    assert_ok(ruga_mesh_check(&remeshed, RUGA_CHECK_EMBEDDED, &after));
    print_message("%s: %d faces, edges %.4g %.4g %.4g, smallest angle %.3g degrees, volume %+.3g %%\n", file,
                  after.triangle_count, after.edge_min, after.edge_mean, after.edge_max,
                  after.angle_min * 180 / RUGA_PI, 100 * (after.volume / before.volume - 1));
    assert_int_equal(after.error_count + after.warning_count, 0);
    assert_true(after.watertight);
    assert_int_equal(after.genus, before.genus);
    assert_near(after.edge_mean, edge, 0.1 * edge);
    assert_true(after.angle_min > smallest_angle * RUGA_PI / 180);
    assert_near(after.volume, before.volume, 0.02 * before.volume);
    ruga_check_report_clear(&before);
    ruga_check_report_clear(&after);
    ruga_mesh_clear(&remeshed);
    ruga_mesh_clear(&mesh);
}

static void pillow_with_a_narrow_welt_is_remeshed(void** state) {
    (void)state;
    remesh_one("market_pillow_watertight.obj", NULL, 0.03, 20);
}

static void teddy_bear_is_remeshed(void** state) {
    (void)state;
    remesh_one("sh3d_teddyBear_body_watertight.obj", NULL, 0.8, 15);
}

static void lips_of_the_head_stay_apart(void** state) {
    (void)state;
    remesh_one("makehuman_head_watertight.obj", NULL, 0.06, 15);
}

static void sofa_cushion_is_remeshed(void** state) {
    (void)state;
    remesh_one("market_sofa_watertight.obj", "part1", 0.08, 15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(doctor_finds_what_independent_readers_found),
        cmocka_unit_test(pillow_with_a_narrow_welt_is_remeshed),
        cmocka_unit_test(teddy_bear_is_remeshed),
        cmocka_unit_test(lips_of_the_head_stay_apart),
        cmocka_unit_test(sofa_cushion_is_remeshed),
    };
    return cmocka_run_group_tests_name("real_surfaces", tests, NULL, check_no_leak);
}
