// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "mesh/connectivity.h"
#include "mesh/make.h"
#include "mesh/subdivide.h"
#include "mesh/weld.h"

#include <stdlib.h>
#include <string.h>

static void make(ruga_shape shape, double x, double y, double z, double edge, ruga_pattern pattern,
                 ruga_mesh* mesh) {
    const ruga_make_def def = {.shape = shape, .size = {x, y, z}, .edge = edge, .pattern = pattern};
    assert_ok(ruga_mesh_make(&def, mesh));
}

static void assert_box(const ruga_mesh* mesh, double x, double y, double z) {
    double min[3], max[3];
    const double size[3] = {x, y, z};
    ruga_mesh_bounds(mesh, min, max);
    for (int k = 0; k < 3; k++) {
        assert_near(max[k], size[k] / 2, 0);
        assert_near(min[k], -size[k] / 2, 0);
    }
}

static double smallest_angle(const ruga_mesh* mesh) {
    double smallest = RUGA_PI;
    for (int f = 0; f < mesh->triangle_count; f++) {
        for (int i = 0; i < 3; i++) {
            const int* t = mesh->triangle + 3 * f;
            double a[3], b[3];
            ruga_subtract(mesh->position + 3 * t[(i + 1) % 3], mesh->position + 3 * t[i], a);
            ruga_subtract(mesh->position + 3 * t[(i + 2) % 3], mesh->position + 3 * t[i], b);
            smallest = fmin(smallest, acos(ruga_dot(a, b) / ruga_norm(a) / ruga_norm(b)));
        }
    }
    return smallest * 180 / RUGA_PI;
}

static int compare_triples(const void* a, const void* b) {
    return memcmp(a, b, 3 * sizeof(int));
}

// Every edge in two faces that run opposite ways, no two faces with the same vertices, V - E + F = 2 per
// component, and a volume that says that normals point outwards.
static void assert_closed(const ruga_mesh* mesh) {
    ruga_connectivity c;
    assert_ok(ruga_connectivity_create(mesh, &c));
    for (int e = 0; e < c.edge_count; e++) {
        assert_true(c.edge_triangle[e][0] >= 0 && c.edge_triangle[e][1] >= 0);
    }
    assert_int_equal(c.vertex_count - c.edge_count + c.triangle_count, 2 * c.component_count);
    assert_int_equal(c.component_count, 1);
    assert_true(ruga_mesh_volume(mesh) > 0);
    int(*key)[3] = malloc((size_t)mesh->triangle_count * sizeof *key);
    assert_non_null(key);
    for (int f = 0; f < mesh->triangle_count; f++) {
        const int* t = mesh->triangle + 3 * f;
        int low = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
        int a = t[(low + 1) % 3], b = t[(low + 2) % 3];
        key[f][0] = t[low];
        key[f][1] = a < b ? a : b;
        key[f][2] = a < b ? b : a;
    }
    qsort(key, (size_t)mesh->triangle_count, sizeof *key, compare_triples);
    for (int f = 1; f < mesh->triangle_count; f++) {
        assert_int_not_equal(compare_triples(key[f - 1], key[f]), 0);
    }
    free(key);
    ruga_connectivity_clear(&c);
}

static void sheet_has_exact_size_and_upward_normals(void** state) {
    (void)state;
    for (int pattern = 0; pattern <= RUGA_PATTERN_ALTERNATING; pattern++) {
        ruga_mesh mesh;
        make(RUGA_SHAPE_SHEET, 1.1, 0.37, 0, 0.03, (ruga_pattern)pattern, &mesh);
        assert_box(&mesh, 1.1, 0.37, 0);
        assert_near(ruga_mesh_area(&mesh), 1.1 * 0.37, 1e-13);
        for (int f = 0; f < mesh.triangle_count; f++) {
            double n[3];
            ruga_mesh_triangle_normal(&mesh, f, n);
            assert_true(n[2] > 0 && n[0] == 0 && n[1] == 0);
        }
        ruga_connectivity c;
        assert_ok(ruga_connectivity_create(&mesh, &c));
        assert_int_equal(c.vertex_count - c.edge_count + c.triangle_count, 1);
        ruga_connectivity_clear(&c);
        ruga_mesh_clear(&mesh);
    }
}

static void equilateral_sheet_is_equilateral_inside(void** state) {
    (void)state;
    ruga_mesh mesh;
    make(RUGA_SHAPE_SHEET, 1, 10 * sqrt(0.75) / 10, 0, 0.1, RUGA_PATTERN_EQUILATERAL, &mesh);
    ruga_connectivity c;
    assert_ok(ruga_connectivity_create(&mesh, &c));
    for (int e = 0; e < c.edge_count; e++) {
        const double* a = mesh.position + 3 * c.edge[e][0];
        const double* b = mesh.position + 3 * c.edge[e][1];
        bool border = fabs(fabs(a[0]) - 0.5) < 1e-9 || fabs(fabs(b[0]) - 0.5) < 1e-9;
        if (!border) {
            assert_near(ruga_distance(a, b), 0.1, 1e-12);
        }
    }
    assert_near(smallest_angle(&mesh), 30, 1e-9); // the half triangles at the ends of the rows
    ruga_connectivity_clear(&c);
    ruga_mesh_clear(&mesh);
}

static void closed_shapes_are_watertight_and_exact(void** state) {
    (void)state;
    const double edges[] = {0.5, 0.31, 0.11, 0.04};
    for (int pattern = 0; pattern <= RUGA_PATTERN_ALTERNATING; pattern++) {
        for (int i = 0; i < 4; i++) {
            ruga_mesh mesh;
            make(RUGA_SHAPE_SLAB, 1.3, 0.7, 0.05, edges[i], (ruga_pattern)pattern, &mesh);
            assert_closed(&mesh);
            assert_box(&mesh, 1.3, 0.7, 0.05);
            assert_near(ruga_mesh_volume(&mesh), 1.3 * 0.7 * 0.05, 1e-13);
            ruga_mesh_clear(&mesh);
            make(RUGA_SHAPE_BAR, 1, 0.21, 0.3, edges[i], (ruga_pattern)pattern, &mesh);
            assert_closed(&mesh);
            assert_box(&mesh, 1, 0.21, 0.3);
            assert_near(ruga_mesh_volume(&mesh), 0.063, 1e-13);
            ruga_mesh_clear(&mesh);
            make(RUGA_SHAPE_PILLOW, 0.7, 0.5, 0.2, edges[i] / 2, (ruga_pattern)pattern, &mesh);
            assert_closed(&mesh);
            assert_box(&mesh, 0.7, 0.5, 0.2);
            ruga_mesh_clear(&mesh);
        }
    }
}

static void closed_shapes_by_any_cells_are_watertight(void** state) {
    (void)state;
    for (int i = 1; i <= 36; i++) {
        ruga_make_def def = {
            .shape = RUGA_SHAPE_SLAB, .size = {1, 1, 0.3}, .cells = {(i - 1) % 6 + 1, (i - 1) / 6 + 1}};
        for (int pattern = 0; pattern <= RUGA_PATTERN_ALTERNATING; pattern++) {
            ruga_mesh mesh;
            def.pattern = (ruga_pattern)pattern;
            def.shape = RUGA_SHAPE_SLAB;
            assert_ok(ruga_mesh_make(&def, &mesh));
            assert_closed(&mesh);
            ruga_mesh_clear(&mesh);
            def.shape = RUGA_SHAPE_PILLOW;
            if (def.cells[0] < 2 || def.cells[1] < 2) {
                assert_status(ruga_mesh_make(&def, &mesh), RUGA_BAD_INPUT);
            } else {
                assert_ok(ruga_mesh_make(&def, &mesh));
                assert_closed(&mesh);
                ruga_mesh_clear(&mesh);
            }
        }
    }
}

static void pillow_has_defaults_and_good_triangles(void** state) {
    (void)state;
    ruga_mesh mesh;
    make(RUGA_SHAPE_PILLOW, 0.5, 0, 0, 0.01, RUGA_PATTERN_EQUILATERAL, &mesh);
    assert_box(&mesh, 0.5, 0.5, 0.3 * 0.5);
    print_message("pillow: V %d, mean edge %.4f of 0.01, smallest angle %.1f\n", mesh.vertex_count,
                  ruga_mesh_mean_edge(&mesh), smallest_angle(&mesh));
    assert_near(ruga_mesh_mean_edge(&mesh), 0.01, 0.0005);
    assert_true(smallest_angle(&mesh) > 22);
    ruga_mesh_clear(&mesh);
}

static void sphere_of_any_frequency_is_round(void** state) {
    (void)state;
    const double edges[] = {1, 0.6, 0.35, 0.2, 0.1, 0.05, 0.03};
    for (int i = 0; i < 7; i++) {
        ruga_mesh mesh;
        make(RUGA_SHAPE_SPHERE, 1, 0, 0, edges[i], RUGA_PATTERN_EQUILATERAL, &mesh);
        assert_closed(&mesh);
        int n = (int)lround(sqrt((mesh.vertex_count - 2) / 10.0));
        assert_int_equal(mesh.vertex_count, 10 * n * n + 2);
        double min[3], max[3];
        ruga_mesh_bounds(&mesh, min, max);
        assert_near(max[0], 0.5, 0);
        assert_near(min[0], -0.5, 0);
        for (int v = 0; v < mesh.vertex_count; v++) {
            assert_near(ruga_norm(mesh.position + 3 * v), 0.5, 1e-15);
        }
        assert_true(smallest_angle(&mesh) > 50);
        if (edges[i] < 0.3) {
            assert_near(ruga_mesh_mean_edge(&mesh), edges[i], 0.12 * edges[i]);
        }
        ruga_mesh_clear(&mesh);
    }
}

static void skirt_is_a_ring_or_a_sector(void** state) {
    (void)state;
    const double angles[] = {0, 2 * RUGA_PI, RUGA_PI / 2, 5};
    for (int i = 0; i < 12; i++) {
        ruga_mesh mesh;
        make(RUGA_SHAPE_SKIRT, 0.1, 0.5, angles[i % 4], 0.02, (ruga_pattern)(i / 4), &mesh);
        ruga_connectivity c;
        assert_ok(ruga_connectivity_create(&mesh, &c));
        bool ring = i % 4 < 2;
        assert_int_equal(c.vertex_count - c.edge_count + c.triangle_count, ring ? 0 : 1);
        double angle = ring ? 2 * RUGA_PI : angles[i % 4];
        assert_near(ruga_mesh_area(&mesh), angle / 2 * (0.25 - 0.01), 0.003 * angle);
        double smallest = 1, largest = 0;
        for (int v = 0; v < mesh.vertex_count; v++) {
            double r = ruga_norm(mesh.position + 3 * v);
            smallest = fmin(smallest, r);
            largest = fmax(largest, r);
        }
        assert_near(smallest, 0.1, 1e-15);
        assert_near(largest, 0.5, 1e-15);
        for (int f = 0; f < mesh.triangle_count; f++) {
            double n[3];
            ruga_mesh_triangle_normal(&mesh, f, n);
            assert_true(n[2] > 0);
        }
        if (i / 4 == 0) {
            assert_true(smallest_angle(&mesh) > 22);
            assert_near(ruga_mesh_mean_edge(&mesh), 0.02, 0.002);
        }
        ruga_connectivity_clear(&c);
        ruga_mesh_clear(&mesh);
    }
}

static void bad_shapes_are_refused(void** state) {
    (void)state;
    const ruga_make_def bad[] = {
        {.shape = RUGA_SHAPE_SHEET, .size = {1, 1}},
        {.shape = RUGA_SHAPE_SHEET, .size = {1}, .edge = 0.1},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, -1}, .edge = 0.1},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, 1, 1}, .edge = 0.1},
        {.shape = RUGA_SHAPE_SPHERE, .size = {1, 2}, .edge = 0.1},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, NAN}, .edge = 0.1},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, INFINITY}, .edge = 0.1},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, 1}, .edge = NAN},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, 1}, .edge = 2},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, 1}, .edge = 1e-6},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, 1}, .edge = 1e-300},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, 1}, .edge = 0.1, .cells = {2, 2}},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, 1}, .cells = {2, 0}},
        {.shape = RUGA_SHAPE_SHEET, .size = {1, 1}, .cells = {100000, 100000}},
        {.shape = RUGA_SHAPE_SLAB, .size = {1, 1}, .edge = 0.1},
        {.shape = RUGA_SHAPE_SLAB, .size = {1, 1, 1e9}, .edge = 0.001},
        {.shape = RUGA_SHAPE_SPHERE, .size = {1}, .edge = 1e-9},
        {.shape = RUGA_SHAPE_SKIRT, .size = {0.5, 0.1, 1}, .edge = 0.01},
        {.shape = RUGA_SHAPE_SKIRT, .size = {0.1, 0.5, 7}, .edge = 0.01},
        {.shape = (ruga_shape)77, .size = {0.1, 0.5, 7}, .edge = 0.01},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ruga_mesh mesh;
        assert_status(ruga_mesh_make(&bad[i], &mesh), RUGA_BAD_INPUT);
        assert_null(mesh.position);
    }
}

static void names_are_found(void** state) {
    (void)state;
    for (int i = 0; i < RUGA_SHAPE_COUNT; i++) {
        assert_int_equal(ruga_shape_from_name(ruga_shape_name((ruga_shape)i)), i);
    }
    assert_int_equal(ruga_shape_from_name("cube"), -1);
}

static void connectivity_tables_agree(void** state) {
    (void)state;
    ruga_mesh mesh;
    make(RUGA_SHAPE_SHEET, 1, 0.6, 0, 0.1, RUGA_PATTERN_EQUILATERAL, &mesh);
    ruga_connectivity c;
    assert_ok(ruga_connectivity_create(&mesh, &c));
    for (int e = 0; e < c.edge_count; e++) {
        assert_true(c.edge[e][0] < c.edge[e][1]);
        assert_true(e == 0 || c.edge[e - 1][0] < c.edge[e][0] ||
                    (c.edge[e - 1][0] == c.edge[e][0] && c.edge[e - 1][1] < c.edge[e][1]));
        for (int side = 0; side < 2; side++) {
            int f = c.edge_triangle[e][side];
            assert_int_equal(f < 0, c.edge_opposite[e][side] < 0);
            for (int i = 0; f >= 0 && i < 3; i++) {
                const int* t = mesh.triangle + 3 * f;
                if (t[i] == c.edge[e][side] && t[(i + 1) % 3] == c.edge[e][1 - side]) {
                    assert_int_equal(c.triangle_edge[f][i], e);
                    assert_int_equal(t[(i + 2) % 3], c.edge_opposite[e][side]);
                    f = -1;
                } else {
                    assert_true(i < 2); // some side of the face runs this way
                }
            }
        }
    }
    assert_int_equal(c.neighbour_start[c.vertex_count], 2 * c.edge_count);
    assert_int_equal(c.incident_start[c.vertex_count], 3 * c.triangle_count);
    for (int v = 0; v < c.vertex_count; v++) {
        for (int k = c.neighbour_start[v]; k < c.neighbour_start[v + 1]; k++) {
            int w = c.neighbour[k], e = c.neighbour_edge[k];
            assert_true(k == c.neighbour_start[v] || c.neighbour[k - 1] < w);
            assert_int_equal(c.edge[e][0] + c.edge[e][1], v + w);
            assert_true(c.edge[e][0] == v || c.edge[e][1] == v);
        }
        for (int k = c.incident_start[v]; k < c.incident_start[v + 1]; k++) {
            const int* t = mesh.triangle + 3 * c.incident[k];
            assert_true(t[0] == v || t[1] == v || t[2] == v);
            assert_true(k == c.incident_start[v] || c.incident[k - 1] < c.incident[k]);
        }
    }
    ruga_connectivity_clear(&c);
    ruga_mesh_clear(&mesh);
}

static void what_is_not_manifold_is_named(void** state) {
    (void)state;
    double position[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
    int three[] = {0, 1, 2, 1, 0, 3, 0, 1, 4};
    int same_way[] = {0, 1, 2, 0, 1, 3};
    int repeated[] = {0, 1, 1};
    int outside[] = {0, 1, 7};
    ruga_connectivity c;
    ruga_mesh mesh = {.vertex_count = 5, .position = position[0], .triangle_count = 3, .triangle = three};
    assert_status(ruga_connectivity_create(&mesh, &c), RUGA_BAD_MESH);
    assert_non_null(strstr(ruga_last_error(), "vertices 0 and 1"));
    mesh.triangle_count = 2;
    mesh.triangle = same_way;
    assert_status(ruga_connectivity_create(&mesh, &c), RUGA_BAD_MESH);
    mesh.triangle_count = 1;
    mesh.triangle = repeated;
    assert_status(ruga_connectivity_create(&mesh, &c), RUGA_BAD_MESH);
    mesh.triangle = outside;
    assert_status(ruga_connectivity_create(&mesh, &c), RUGA_BAD_MESH);
}

static void components_are_numbered_by_first_vertex(void** state) {
    (void)state;
    double position[8][3] = {{0}};
    int triangle[] = {6, 5, 4, 1, 2, 7};
    ruga_mesh mesh = {.vertex_count = 8, .position = position[0], .triangle_count = 2, .triangle = triangle};
    ruga_connectivity c;
    assert_ok(ruga_connectivity_create(&mesh, &c));
    const int wanted[] = {-1, 0, 0, -1, 1, 1, 1, 0};
    assert_int_equal(c.component_count, 2);
    assert_memory_equal(c.component, wanted, sizeof wanted);
    ruga_connectivity_clear(&c);
}

// Two triangles with uvs in groups a and b, one vertex shared.
static const double bow_position[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
static const int bow_triangle[2][3] = {{0, 1, 2}, {1, 3, 4}};
static const double bow_uv[4][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0.5}};
static const int bow_uv_triangle[2][3] = {{0, 1, 2}, {1, 3, -1}};
static const char* const bow_names[2] = {"a", "b"};
static const int bow_group[2] = {0, 1};

static ruga_mesh_def bow_def(void) {
    return (ruga_mesh_def){.vertex_count = 5,
                           .positions = bow_position[0],
                           .triangle_count = 2,
                           .triangles = bow_triangle[0],
                           .uv_count = 4,
                           .uv = bow_uv[0],
                           .uv_triangles = bow_uv_triangle[0],
                           .group_count = 2,
                           .group_names = bow_names,
                           .face_group = bow_group};
}

static void extracted_group_keeps_order_uvs_and_sources(void** state) {
    (void)state;
    ruga_mesh mesh, part;
    ruga_mesh_def def = bow_def();
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    const char* name = "b";
    assert_ok(ruga_mesh_extract_groups(&mesh, 1, &name, &part));
    assert_int_equal(part.vertex_count, 3);
    assert_int_equal(part.triangle_count, 1);
    const int sources[] = {1, 3, 4}, triangle[] = {0, 1, 2}, uv_triangle[] = {0, 1, -1};
    assert_memory_equal(part.source_vertex, sources, sizeof sources);
    assert_memory_equal(part.triangle, triangle, sizeof triangle);
    assert_memory_equal(part.uv_triangle, uv_triangle, sizeof uv_triangle);
    assert_int_equal(part.uv_count, 2);
    assert_true(part.uv[2] == 0.5);
    assert_int_equal(part.group_count, 1);
    assert_string_equal(part.group_name[0], "b");
    assert_int_equal(part.face_group[0], 0);
    assert_int_equal(part.polygon[0], 1);
    ruga_mesh_clear(&part);
    name = "c";
    assert_status(ruga_mesh_extract_groups(&mesh, 1, &name, &part), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "a, b"));
    ruga_mesh_clear(&mesh);
}

static void def_with_wrong_indices_is_refused(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_mesh_def def = bow_def();
    def.vertex_count = 4;
    assert_status(ruga_mesh_from_def(&def, &mesh), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "face 1"));
    def = bow_def();
    def.uv_count = 3;
    assert_status(ruga_mesh_from_def(&def, &mesh), RUGA_BAD_INPUT);
    def = bow_def();
    def.group_count = 1;
    assert_status(ruga_mesh_from_def(&def, &mesh), RUGA_BAD_INPUT);
    def = bow_def();
    def.positions = NULL;
    assert_status(ruga_mesh_from_def(&def, &mesh), RUGA_BAD_INPUT);
}

static void hash_sees_positions_and_faces(void** state) {
    (void)state;
    ruga_mesh mesh, copy;
    ruga_mesh_def def = bow_def();
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    assert_ok(ruga_mesh_copy(&mesh, &copy));
    assert_true(ruga_mesh_hash(&mesh) == ruga_mesh_hash(&copy));
    copy.position[3] += 1e-16 + 1;
    assert_true(ruga_mesh_hash(&mesh) != ruga_mesh_hash(&copy));
    copy.position[3] = mesh.position[3];
    copy.triangle[0] = 1;
    assert_true(ruga_mesh_hash(&mesh) != ruga_mesh_hash(&copy));
    ruga_mesh_clear(&mesh);
    ruga_mesh_clear(&copy);
}

static void areas_and_normals_of_a_sphere(void** state) {
    (void)state;
    ruga_mesh mesh;
    make(RUGA_SHAPE_SPHERE, 2, 0, 0, 0.1, RUGA_PATTERN_EQUILATERAL, &mesh);
    double *area = NULL, *normal = NULL;
    assert_ok(RUGA_NEW(area, mesh.vertex_count));
    assert_ok(RUGA_NEW(normal, 3 * mesh.vertex_count));
    ruga_mesh_vertex_areas(&mesh, area);
    ruga_mesh_vertex_normals(&mesh, mesh.position, normal);
    double sum = 0;
    for (int v = 0; v < mesh.vertex_count; v++) {
        sum += area[v];
        assert_near(ruga_dot(normal + 3 * v, mesh.position + 3 * v), 1, 1e-4);
    }
    assert_near(sum, ruga_mesh_area(&mesh), 1e-12);
    assert_near(sum, 4 * RUGA_PI, 0.04);
    assert_near(ruga_mesh_volume(&mesh), 4 * RUGA_PI / 3, 0.04);
    ruga_release(area);
    ruga_release(normal);
    ruga_mesh_clear(&mesh);
}

static void weld_merges_within_tolerance_only(void** state) {
    (void)state;
    double position[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 1e-7}, {-0.0, 1, 0}, {NAN, 0, 0}};
    int triangle[2][3] = {{0, 1, 2}, {3, 5, 4}};
    const ruga_mesh_def def = {
        .vertex_count = 6, .positions = position[0], .triangle_count = 2, .triangles = triangle[0]};
    ruga_mesh mesh;
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    assert_ok(ruga_mesh_weld(&mesh, 0));
    assert_int_equal(mesh.vertex_count, 5);
    const int exact[] = {0, 1, 2, 3, 4, 2};
    assert_memory_equal(mesh.triangle, exact, sizeof exact);
    assert_ok(ruga_mesh_weld(&mesh, 1e-6));
    assert_int_equal(mesh.vertex_count, 4);
    const int loose[] = {0, 1, 2, 1, 3, 2};
    assert_memory_equal(mesh.triangle, loose, sizeof loose);
    assert_true(isnan(mesh.position[9]));
    ruga_mesh_clear(&mesh);
}

// ------------------------------------------------------------------------------------- subdivision

static void subdivision_keeps_affine_maps_and_topology(void** state) {
    (void)state;
    ruga_mesh mesh;
    make(RUGA_SHAPE_PILLOW, 0.5, 0, 0, 0.06, RUGA_PATTERN_EQUILATERAL, &mesh);
    for (int steps = 0; steps <= 3; steps++) {
        ruga_subdivision* s;
        assert_ok(ruga_subdivision_create(&mesh, steps, &s));
        const ruga_mesh* fine = ruga_subdivision_mesh(s);
        assert_int_equal(fine->triangle_count, mesh.triangle_count << (2 * steps));
        assert_closed(fine);
        double *moved = NULL, *result = NULL;
        assert_ok(RUGA_NEW(moved, 3 * mesh.vertex_count));
        assert_ok(RUGA_NEW(result, 3 * fine->vertex_count));
        const double a[9] = {1.2, 0.3, -0.4, 0.5, 0.6, 0.7, 0.1, -0.8, 0.9}, offset[3] = {1, 2, 3};
        for (int v = 0; v < mesh.vertex_count; v++) {
            ruga_multiply3(a, mesh.position + 3 * v, moved + 3 * v);
            ruga_add_scaled(1, offset, moved + 3 * v);
        }
        ruga_subdivision_apply(s, moved, result);
        for (int v = 0; v < fine->vertex_count; v++) {
            double wanted[3];
            ruga_multiply3(a, fine->position + 3 * v, wanted);
            ruga_add_scaled(1, offset, wanted);
            assert_near(ruga_distance(wanted, result + 3 * v), 0, 1e-14);
        }
        ruga_release(moved);
        ruga_release(result);
        ruga_subdivision_destroy(&s);
    }
    ruga_mesh_clear(&mesh);
}

static void subdivision_of_regular_vertex_and_border_by_hand(void** state) {
    (void)state;
    // Two triangles: edge 0-1 inner, vertices 2 and 3 opposite; everything else is border.
    const double position[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, -1, 8}};
    const int triangle[2][3] = {{0, 1, 2}, {1, 0, 3}};
    const ruga_mesh_def def = {
        .vertex_count = 4, .positions = position[0], .triangle_count = 2, .triangles = triangle[0]};
    ruga_mesh mesh;
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    ruga_subdivision* s;
    assert_ok(ruga_subdivision_create(&mesh, 1, &s));
    const ruga_mesh* fine = ruga_subdivision_mesh(s);
    assert_int_equal(fine->vertex_count, 9);
    assert_near(fine->position[2], 1, 1e-15);         // 3/4 v0 + 1/8 (v2 + v3): z = 8 / 8
    assert_near(fine->position[3 * 4 + 2], 1, 1e-15); // inner edge: 3/8 (v0 + v1) + 1/8 (v2 + v3)
    assert_near(fine->position[3 * 4 + 0], 0.5, 1e-15);
    assert_near(fine->position[3 * 6 + 2], 4, 1e-15); // border edge 0-3
    assert_int_equal(fine->source_vertex[3], 3);
    assert_int_equal(fine->source_vertex[4], -1);
    ruga_subdivision_destroy(&s);
    ruga_mesh_clear(&mesh);
}

static void subdivision_smooths_an_icosahedron_to_its_limit(void** state) {
    (void)state;
    ruga_mesh mesh;
    make(RUGA_SHAPE_SPHERE, 2, 0, 0, 1, RUGA_PATTERN_EQUILATERAL, &mesh);
    assert_int_equal(mesh.vertex_count, 12);
    ruga_subdivision* s;
    assert_ok(ruga_subdivision_create(&mesh, 4, &s));
    const ruga_mesh* fine = ruga_subdivision_mesh(s);
    // Limit of a vertex: (1 - n l) v + l sum v_i, l = 1 / (3 / (8 b) + n); here sum v_i = sqrt(5) v.
    double root = 3.0 / 8 + cos(2 * RUGA_PI / 5) / 4, b = (5.0 / 8 - root * root) / 5;
    double limit = 1 / (3 / (8 * b) + 5);
    assert_near(ruga_norm(fine->position), 1 - 5 * limit + limit * sqrt(5.0), 0.01);
    ruga_subdivision_destroy(&s);
    ruga_mesh_clear(&mesh);
}

static void subdivision_keeps_uv_seams_and_groups(void** state) {
    (void)state;
    ruga_mesh mesh;
    // A quad whose halves share the edge 0-1, the first with uvs of its own, the second with none at one
    // corner.
    const double position[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, -1, 0}};
    const int triangle[2][3] = {{0, 1, 2}, {1, 0, 3}}, uv_triangle[2][3] = {{0, 1, 2}, {3, 4, -1}};
    const double uv[5][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0.5}, {0.25, 0.5}};
    const ruga_mesh_def def = {.vertex_count = 4,
                               .positions = position[0],
                               .triangle_count = 2,
                               .triangles = triangle[0],
                               .uv_count = 5,
                               .uv = uv[0],
                               .uv_triangles = uv_triangle[0],
                               .group_count = 2,
                               .group_names = bow_names,
                               .face_group = bow_group};
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    ruga_subdivision* s;
    assert_ok(ruga_subdivision_create(&mesh, 1, &s));
    const ruga_mesh* fine = ruga_subdivision_mesh(s);
    assert_int_equal(fine->uv_count, 5 + 3 + 1);
    const int* middle = fine->uv_triangle + 3 * 3; // of the first face
    assert_true(fine->uv[2 * middle[0]] == 0.5 && fine->uv[2 * middle[0] + 1] == 0);
    const int* other = fine->uv_triangle + 3 * 7;
    assert_true(fine->uv[2 * other[0]] == 0.375);
    assert_int_equal(other[1], -1);
    assert_int_equal(fine->face_group[3], 0);
    assert_int_equal(fine->face_group[4], 1);
    assert_string_equal(fine->group_name[1], "b");
    ruga_subdivision_destroy(&s);
    assert_status(ruga_subdivision_create(&mesh, -1, &s), RUGA_BAD_INPUT);
    assert_status(ruga_subdivision_create(&mesh, 15, &s), RUGA_BAD_INPUT);
    ruga_mesh_clear(&mesh);
}

// ------------------------------------------------------------------------------ failing allocations

static void call_until_success(ruga_status (*call)(void)) {
    for (int k = 0; k < 10000; k++) {
        let_allocations_fail_after(k);
        ruga_status status = call();
        ruga_set_allocator(NULL, NULL, NULL);
        assert_int_equal(ruga_byte_count(), 0);
        if (status == RUGA_OK) {
            assert_true(k > 0);
            return;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
    }
    fail();
}

static ruga_status make_all_shapes(void) {
    const ruga_make_def defs[] = {{.shape = RUGA_SHAPE_SLAB, .size = {1, 1, 0.3}, .edge = 0.3},
                                  {.shape = RUGA_SHAPE_PILLOW, .size = {1}, .edge = 0.3},
                                  {.shape = RUGA_SHAPE_SPHERE, .size = {1}, .edge = 0.3},
                                  {.shape = RUGA_SHAPE_SKIRT, .size = {1, 2, 3}, .edge = 0.3}};
    for (int i = 0; i < 4; i++) {
        ruga_mesh mesh;
        RUGA_TRY(ruga_mesh_make(&defs[i], &mesh));
        ruga_mesh_clear(&mesh);
    }
    return RUGA_OK;
}

static ruga_status connect_and_extract(void) {
    ruga_mesh mesh = {0}, copy = {0}, part = {0};
    ruga_connectivity c = {0};
    const char* name = "a";
    ruga_mesh_def def = bow_def();
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(ruga_mesh_from_def(&def, &mesh));
    RUGA_TRY_DONE(ruga_mesh_copy(&mesh, &copy));
    RUGA_TRY_DONE(ruga_mesh_extract_groups(&mesh, 1, &name, &part));
    RUGA_TRY_DONE(ruga_connectivity_create(&mesh, &c));
done:
    ruga_mesh_clear(&mesh);
    ruga_mesh_clear(&copy);
    ruga_mesh_clear(&part);
    ruga_connectivity_clear(&c);
    return status;
}

static ruga_status subdivide_bow(void) {
    ruga_mesh mesh = {0};
    ruga_subdivision* s = NULL;
    ruga_mesh_def def = bow_def();
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(ruga_mesh_from_def(&def, &mesh));
    RUGA_TRY_DONE(ruga_subdivision_create(&mesh, 2, &s));
done:
    ruga_mesh_clear(&mesh);
    ruga_subdivision_destroy(&s);
    return status;
}

static void every_failed_allocation_is_a_status(void** state) {
    (void)state;
    call_until_success(make_all_shapes);
    call_until_success(connect_and_extract);
    call_until_success(subdivide_bow);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sheet_has_exact_size_and_upward_normals),
        cmocka_unit_test(equilateral_sheet_is_equilateral_inside),
        cmocka_unit_test(closed_shapes_are_watertight_and_exact),
        cmocka_unit_test(closed_shapes_by_any_cells_are_watertight),
        cmocka_unit_test(pillow_has_defaults_and_good_triangles),
        cmocka_unit_test(sphere_of_any_frequency_is_round),
        cmocka_unit_test(skirt_is_a_ring_or_a_sector),
        cmocka_unit_test(bad_shapes_are_refused),
        cmocka_unit_test(names_are_found),
        cmocka_unit_test(connectivity_tables_agree),
        cmocka_unit_test(what_is_not_manifold_is_named),
        cmocka_unit_test(components_are_numbered_by_first_vertex),
        cmocka_unit_test(extracted_group_keeps_order_uvs_and_sources),
        cmocka_unit_test(def_with_wrong_indices_is_refused),
        cmocka_unit_test(hash_sees_positions_and_faces),
        cmocka_unit_test(areas_and_normals_of_a_sphere),
        cmocka_unit_test(weld_merges_within_tolerance_only),
        cmocka_unit_test(subdivision_keeps_affine_maps_and_topology),
        cmocka_unit_test(subdivision_of_regular_vertex_and_border_by_hand),
        cmocka_unit_test(subdivision_smooths_an_icosahedron_to_its_limit),
        cmocka_unit_test(subdivision_keeps_uv_seams_and_groups),
        cmocka_unit_test(every_failed_allocation_is_a_status),
    };
    return cmocka_run_group_tests_name("mesh", tests, NULL, check_no_leak);
}
