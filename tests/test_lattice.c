// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Volume and embedding of the lattice on smooth bodies, boxes and a head, its shape functions, what it refuses.
// tests/test_blocks.c holds its elements against a reference.
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/vec3.h"
#include "lattice/lattice.h"
#include "mesh/make.h"
#include "ruga/ruga.h"

#include <stdlib.h>
#include <string.h>

static const ruga_lattice_def FOUR_CELLS = {.cells = 4, .degree = 2, .fill = RUGA_FILL_MESH};

static double total_volume(const ruga_lattice* lattice) {
    double sum = 0;
    for (int i = 0; i < 27 * lattice->element_count; i++) {
        assert_true(lattice->volume[i] >= 0);
        sum += lattice->volume[i];
    }
    return sum;
}

// ---- smooth bodies ----

static void make(ruga_shape shape, double x, double y, double z, double edge, ruga_mesh* mesh,
                 ruga_connectivity* connectivity) {
    ruga_make_def def = {.shape = shape, .size = {x, y, z}, .edge = edge};
    assert_ok(ruga_mesh_make(&def, mesh));
    assert_ok(ruga_connectivity_create(mesh, connectivity));
}

static void rotate(ruga_mesh* mesh, ruga_random* random) {
    double a[9];
    for (int i = 0; i < 6; i++) {
        a[i] = ruga_random_uniform(random) - 0.5;
    }
    ruga_normalize(a);
    ruga_add_scaled(-ruga_dot(a, a + 3), a, a + 3);
    ruga_normalize(a + 3);
    ruga_cross(a, a + 3, a + 6);
    for (int v = 0; v < mesh->vertex_count; v++) {
        ruga_multiply3(a, mesh->position + 3 * v, mesh->position + 3 * v);
    }
}

static double largest_difference(int count, const double* a, const double* b) {
    double most = 0;
    for (int i = 0; i < count; i++) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most;
}

// Affine maps exactly, rows that sum to one, and the transpose.
static void check_embedding(const ruga_mesh* mesh, const ruga_lattice* lattice) {
    const double map[9] = {1.1, 0.3, -0.2, 0.05, 0.9, 0.4, -0.3, 0.2, 1.2}, shift[3] = {0.3, -0.7, 0.2};
    int nodes = lattice->node_count, vertices = lattice->vertex_count, npe = lattice->nodes_per_element;
    double* q = malloc(sizeof(double) * 3 * (size_t)nodes);
    double* fq = calloc(3 * (size_t)nodes, sizeof(double));
    double* x = malloc(sizeof(double) * 3 * (size_t)vertices);
    double* wanted = malloc(sizeof(double) * 3 * (size_t)vertices);
    assert_int_equal(vertices, mesh->vertex_count);
    for (int n = 0; n < nodes; n++) {
        ruga_multiply3(map, lattice->rest + 3 * n, q + 3 * n);
        ruga_add_scaled(1, shift, q + 3 * n);
    }
    double size = 0;
    for (int v = 0; v < vertices; v++) {
        ruga_multiply3(map, mesh->position + 3 * v, wanted + 3 * v);
        ruga_add_scaled(1, shift, wanted + 3 * v);
        size = fmax(size, ruga_norm(wanted + 3 * v));
        double sum = 0;
        for (int i = 0; i < npe; i++) {
            sum += lattice->vertex_weight[v * npe + i];
        }
        assert_near(sum, 1, 1e-14);
    }
    ruga_lattice_embed(lattice, q, x);
    assert_true(largest_difference(3 * vertices, x, wanted) <= 1e-12 * size);
    ruga_random random = {7};
    double left = 0, right = 0, scale = 0;
    for (int i = 0; i < 3 * vertices; i++) {
        wanted[i] = ruga_random_uniform(&random) - 0.5;
        left += wanted[i] * x[i];
        scale += fabs(wanted[i] * x[i]);
    }
    ruga_lattice_embed_transpose(lattice, wanted, fq);
    for (int i = 0; i < 3 * nodes; i++) {
        right += fq[i] * q[i];
    }
    assert_near(left, right, 1e-13 * scale);
    free(q);
    free(fq);
    free(x);
    free(wanted);
}

static void check_smooth(const ruga_mesh* mesh, const ruga_connectivity* connectivity, int cells) {
    for (int degree = 1; degree <= 2; degree++) {
        ruga_lattice lattice;
        ruga_lattice_def def = {.cells = cells, .degree = degree, .fill = RUGA_FILL_MESH};
        assert_ok(ruga_lattice_create(mesh, connectivity, &def, &lattice));
        double volume = ruga_mesh_volume(mesh);
        assert_near(total_volume(&lattice), volume, 1e-9 * volume);
        check_embedding(mesh, &lattice);
        ruga_lattice_clear(&lattice);
    }
}

static void mass_and_embedding_of_shapes_in_any_position(void** state) {
    (void)state;
    const struct {
        ruga_shape shape;
        double size[3], edge;
    } shapes[] = {{RUGA_SHAPE_SPHERE, {0.4, 0, 0}, 0.03},
                  {RUGA_SHAPE_PILLOW, {0.5, 0.4, 0.15}, 0.03},
                  {RUGA_SHAPE_SLAB, {0.4, 0.2, 0.1}, 0.05},
                  {RUGA_SHAPE_BAR, {0.6, 0.1, 0.1}, 0.2}};
    ruga_random random = {3};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        ruga_mesh mesh;
        ruga_connectivity connectivity;
        make(shapes[i].shape, shapes[i].size[0], shapes[i].size[1], shapes[i].size[2], shapes[i].edge, &mesh,
             &connectivity);
        for (int turn = 0; turn < 3; turn++) {
            check_smooth(&mesh, &connectivity, 1 + 3 * turn);
            rotate(&mesh, &random);
        }
        ruga_connectivity_clear(&connectivity);
        ruga_mesh_clear(&mesh);
    }
}

// Slightly rotated, so that faces lie within rounding of the planes and cross them many times.
static void mass_of_a_slab_that_wobbles_about_the_planes(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_SLAB, 0.8, 0.4, 0.2, 0.03, &mesh, &connectivity);
    ruga_random random = {5};
    for (int turn = 0; turn < 6; turn++) {
        double size = pow(10, -17 + turn);
        for (int i = 0; i < 3 * mesh.vertex_count; i++) {
            mesh.position[i] += size * (ruga_random_uniform(&random) - 0.5);
        }
        check_smooth(&mesh, &connectivity, 4 * (1 + turn % 2));
    }
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// Spheres inside each other, every second one turned inside out: solid, cavity, core.
static void join_spheres(int count, const double* diameter, const double (*center)[3], ruga_mesh* mesh) {
    ruga_mesh ball;
    ruga_connectivity unused;
    make(RUGA_SHAPE_SPHERE, 1, 0, 0, 0.2, &ball, &unused);
    ruga_connectivity_clear(&unused);
    double* position = malloc(sizeof(double) * 3 * (size_t)(count * ball.vertex_count));
    int* triangle = malloc(sizeof(int) * 3 * (size_t)(count * ball.triangle_count));
    for (int s = 0; s < count; s++) {
        for (int i = 0; i < 3 * ball.vertex_count; i++) {
            position[3 * s * ball.vertex_count + i] = diameter[s] * ball.position[i] + center[s][i % 3];
        }
        for (int t = 0; t < ball.triangle_count; t++) {
            for (int i = 0; i < 3; i++) {
                triangle[3 * (s * ball.triangle_count + t) + (s % 2 ? 2 - i : i)] =
                    ball.triangle[3 * t + i] + s * ball.vertex_count;
            }
        }
    }
    ruga_mesh_def def = {.vertex_count = count * ball.vertex_count,
                         .positions = position,
                         .triangle_count = count * ball.triangle_count,
                         .triangles = triangle};
    assert_ok(ruga_mesh_from_def(&def, mesh));
    free(position);
    free(triangle);
    ruga_mesh_clear(&ball);
}

static void cavities_belong_to_the_body_around_them(void** state) {
    (void)state;
    const double diameter[4] = {1, 0.8, 0.3, 0.05};
    const double center[4][3] = {{0, 0, 0}, {0.02, 0, 0}, {0.1, 0.05, 0}, {0.13, 0.07, 0.06}};
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    join_spheres(4, diameter, center, &mesh);
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    for (int cells = 1; cells <= 5; cells++) {
        check_smooth(&mesh, &connectivity, cells);
        ruga_lattice lattice;
        ruga_lattice_def def = {.cells = cells, .degree = 2, .fill = RUGA_FILL_MESH};
        assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
        int v = mesh.vertex_count / 4;
        if (cells == 1) {
            assert_int_equal(lattice.element_count, 2);
        }
        // Shell and cavity hang together, the core is free of them.
        int shell = lattice.vertex_element[0], core = lattice.vertex_element[2 * v];
        for (int i = 0; i < v && cells == 1; i++) {
            assert_int_equal(lattice.vertex_element[v + i], shell);
            assert_int_equal(lattice.vertex_element[2 * v + i], core);
            assert_int_equal(lattice.vertex_element[3 * v + i], core);
        }
        ruga_lattice_clear(&lattice);
    }
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// ---- a real head ----

// Vertices and triangulated polygons of an OBJ file, nothing else; false where there is no such file.
static bool read_obj(const char* path, ruga_mesh* mesh) {
    enum { MOST = 40000 };
    FILE* file = fopen(path, "r");
    if (!file) {
        return false;
    }
    double* position = malloc(sizeof(double) * 3 * MOST);
    int* triangle = malloc(sizeof(int) * 3 * MOST);
    ruga_mesh_def def = {.positions = position, .triangles = triangle};
    char line[512];
    while (fgets(line, sizeof line, file)) {
        double* x = position + 3 * def.vertex_count;
        if (strncmp(line, "v ", 2) == 0) {
            assert_int_equal(sscanf(line + 2, "%lf %lf %lf", &x[0], &x[1], &x[2]), 3);
            def.vertex_count++;
        } else if (strncmp(line, "f ", 2) == 0) {
            int corner[3], count = 0;
            for (char* word = strtok(line + 2, " \r\n"); word; word = strtok(NULL, " \r\n")) {
                corner[count < 2 ? count : 2] = atoi(word) - 1;
                if (++count >= 3) {
                    memcpy(triangle + 3 * def.triangle_count++, corner, sizeof corner);
                    corner[1] = corner[2];
                }
            }
        }
        assert_true(def.vertex_count < MOST && def.triangle_count < MOST - 4);
    }
    (void)fclose(file);
    assert_ok(ruga_mesh_from_def(&def, mesh));
    free(position);
    free(triangle);
    return true;
}

static void lips_of_a_head_have_their_own_elements(void** state) {
    (void)state;
    const char* data = getenv("RUGA_DATA");
    char path[1024];
    (void)snprintf(path, sizeof path, "%s/surface/makehuman_head_watertight.obj",
                   data ? data : RUGA_SOURCE_DIR "/../shared/data");
    ruga_mesh mesh;
    if (!read_obj(path, &mesh)) {
        print_message("skipped: no real surfaces (set RUGA_DATA)\n");
        skip();
    }
    ruga_connectivity connectivity;
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    double volume = ruga_mesh_volume(&mesh);
    for (int cells = 8; cells <= 12; cells++) {
        ruga_lattice lattice;
        ruga_lattice_def def = {.cells = cells, .degree = 2, .fill = RUGA_FILL_MESH};
        assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
        assert_near(total_volume(&lattice), volume, 1e-9 * volume);
        check_embedding(&mesh, &lattice);
        // On the mid-line: the red of the upper lip and that of the lower one, 7 mm apart.
        const int upper = lattice.vertex_element[468], lower = lattice.vertex_element[495];
        // With 9 cells a plane runs through the middle of the face, and the cells beside it reach past the
        // corners of the mouth (at 2.4 cm), where the lips are one piece.
        if (cells == 9) {
            assert_int_equal(upper, lower);
            ruga_lattice_clear(&lattice);
            continue;
        }
        assert_int_not_equal(upper, lower);
        assert_true(lattice.superimposed > 0);
        ruga_lattice_clear(&lattice);
    }
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// ---- box ----

static void box_of_a_flat_sheet_lies_under_it(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_SHEET, 0.5, 0.25, 0, 0.05, &mesh, &connectivity);
    ruga_lattice lattice;
    ruga_lattice_def def = {.cells = 10, .degree = 2, .fill = RUGA_FILL_BOX};
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    assert_int_equal(lattice.cells[0], 10);
    assert_int_equal(lattice.cells[1], 5);
    assert_int_equal(lattice.cells[2], 1);
    assert_near(lattice.origin[2], -0.05, 1e-15);
    assert_near(total_volume(&lattice), 0.5 * 0.25 * 0.05, 1e-14);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    for (int t = 0; t < mesh.triangle_count; t++) { // looking down, deeper
        int swap = mesh.triangle[3 * t];
        mesh.triangle[3 * t] = mesh.triangle[3 * t + 1];
        mesh.triangle[3 * t + 1] = swap;
    }
    ruga_connectivity_clear(&connectivity);
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    def.depth = 0.2;
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    assert_int_equal(lattice.cells[2], 4);
    assert_near(lattice.origin[2], 0, 1e-15);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    mesh.position[2] = 1e-4; // not quite flat: the top face is at the highest point (here looking down)
    mesh.position[5] = -2e-4;
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    assert_near(lattice.origin[2], -2e-4, 1e-15);
    assert_near(lattice.origin[2] + 4 * lattice.cell_size[2], 0.2 - 2e-4, 1e-15);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

static void box_of_a_closed_mesh_is_its_own(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_SPHERE, 0.4, 0, 0, 0.05, &mesh, &connectivity);
    ruga_lattice lattice;
    ruga_lattice_def def = {.cells = 3, .degree = 1, .fill = RUGA_FILL_BOX, .depth = 5};
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    double min[3], max[3];
    ruga_mesh_bounds(&mesh, min, max);
    double box = (max[0] - min[0]) * (max[1] - min[1]) * (max[2] - min[2]);
    assert_int_equal(lattice.element_count, 27);
    assert_int_equal(lattice.node_count, 64);
    assert_near(total_volume(&lattice), box, 1e-13 * box);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// ---- shape functions ----

static void shape_functions_have_their_gradients(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        int npe = degree == 2 ? 27 : 8;
        ruga_lattice lattice = {.degree = degree, .nodes_per_element = npe, .cell_size = {0.5, 0.25, 2}};
        const double xi[3] = {0.3, 1.02, 0.6};
        double weight[27], gradient[81], up[27], down[27], sum = 0;
        ruga_lattice_shape(&lattice, xi, weight, gradient);
        for (int axis = 0; axis < 3; axis++) {
            double a[3] = {xi[0], xi[1], xi[2]}, b[3] = {xi[0], xi[1], xi[2]}, h = 1e-5;
            a[axis] += h;
            b[axis] -= h;
            ruga_lattice_shape(&lattice, a, up, NULL);
            ruga_lattice_shape(&lattice, b, down, NULL);
            for (int i = 0; i < npe; i++) {
                double slope = (up[i] - down[i]) / (2 * h * lattice.cell_size[axis]);
                assert_near(gradient[3 * i + axis], slope, 1e-9);
                sum += gradient[3 * i + axis];
            }
        }
        assert_near(sum, 0, 1e-12);
    }
}

static void quadrature_integrates_quintics(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_SHEET, 1, 1, 0, 0.5, &mesh, &connectivity);
    ruga_lattice lattice;
    ruga_lattice_def def = {.cells = 1, .degree = 2, .fill = RUGA_FILL_BOX};
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    double sum = 0;
    for (int g = 0; g < 27; g++) {
        double xi[3], x[3];
        ruga_lattice_point(&lattice, 0, g, xi, x);
        assert_near(x[0], -0.5 + xi[0], 1e-15);
        assert_near(x[2], -1 + xi[2], 1e-15);
        sum += lattice.volume[g] * pow(xi[0], 5) * pow(xi[1], 4) * xi[2];
    }
    assert_near(sum, 1.0 / 6 / 5 / 2, 1e-15);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// ---- threads, refusals, memory ----

static void threads_do_not_change_a_bit(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_PILLOW, 0.5, 0.5, 0.15, 0.012, &mesh, &connectivity);
    ruga_lattice lattice;
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice));
    size_t vertices = 3 * (size_t)lattice.vertex_count, nodes = 3 * (size_t)lattice.node_count;
    double* x[2] = {malloc(vertices * sizeof(double)), malloc(vertices * sizeof(double))};
    double* f[2] = {calloc(nodes, sizeof(double)), calloc(nodes, sizeof(double))};
    for (int i = 0; i < 2; i++) {
        ruga_set_threads(1 + 2 * i);
        ruga_lattice_embed(&lattice, lattice.rest, x[i]);
        ruga_lattice_embed_transpose(&lattice, x[i], f[i]);
    }
    ruga_set_threads(0);
    assert_memory_equal(x[0], x[1], vertices * sizeof(double));
    assert_memory_equal(f[0], f[1], nodes * sizeof(double));
    for (int i = 0; i < 2; i++) {
        free(x[i]);
        free(f[i]);
    }
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

static void unused_vertices_go_to_the_nearest_element(void** state) {
    (void)state;
    const double position[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0.5, 0.5};
    const int triangle[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    ruga_mesh_def def = {
        .vertex_count = 5, .positions = position, .triangle_count = 4, .triangles = triangle};
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    ruga_lattice lattice;
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice));
    assert_true(lattice.cell_size[0] < 0.26);
    assert_near(total_volume(&lattice), 1.0 / 6, 1e-15);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

static void refuses_what_has_no_inside(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    ruga_lattice lattice;
    make(RUGA_SHAPE_SHEET, 1, 1, 0, 0.5, &mesh, &connectivity);
    assert_status(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice), RUGA_BAD_MESH);
    assert_non_null(strstr(ruga_last_error(), "not watertight: the edge between vertices"));
    ruga_lattice_def def = {.cells = 4, .degree = 3, .fill = RUGA_FILL_BOX};
    assert_status(ruga_lattice_create(&mesh, &connectivity, &def, &lattice), RUGA_BAD_INPUT);
    def = (ruga_lattice_def){.cells = 0, .degree = 2, .fill = RUGA_FILL_BOX};
    assert_status(ruga_lattice_create(&mesh, &connectivity, &def, &lattice), RUGA_BAD_INPUT);
    def = (ruga_lattice_def){.cells = 4, .degree = 2, .fill = RUGA_FILL_BOX, .depth = NAN};
    assert_status(ruga_lattice_create(&mesh, &connectivity, &def, &lattice), RUGA_BAD_INPUT);
    def = (ruga_lattice_def){.cells = 100000, .degree = 2, .fill = RUGA_FILL_BOX};
    assert_status(ruga_lattice_create(&mesh, &connectivity, &def, &lattice), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "lower lattice.cells"));
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
    make(RUGA_SHAPE_SPHERE, 1, 0, 0, 0.3, &mesh, &connectivity);
    ruga_connectivity_clear(&connectivity);
    for (int t = 0; t < mesh.triangle_count; t++) {
        int swap = mesh.triangle[3 * t];
        mesh.triangle[3 * t] = mesh.triangle[3 * t + 1];
        mesh.triangle[3 * t + 1] = swap;
    }
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    assert_status(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice), RUGA_BAD_MESH);
    assert_non_null(strstr(ruga_last_error(), "inwards"));
    mesh.position[4] = NAN;
    assert_status(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice), RUGA_BAD_MESH);
    mesh.triangle_count = 0;
    assert_status(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice), RUGA_BAD_MESH);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

static void every_allocation_may_fail(void** state) {
    (void)state;
    for (int fill = RUGA_FILL_MESH; fill <= RUGA_FILL_BOX; fill++) {
        ruga_mesh mesh;
        ruga_connectivity connectivity;
        ruga_lattice lattice;
        ruga_lattice_def def = {.cells = 3, .degree = 2, .fill = (ruga_fill)fill};
        ruga_status status = RUGA_NO_MEMORY;
        let_allocations_fail_after(1000000);
        make(RUGA_SHAPE_SPHERE, 0.4, 0, 0, 0.1, &mesh, &connectivity);
        size_t before = ruga_byte_count();
        for (int k = 0; status != RUGA_OK; k++) {
            allocations_left = k;
            status = ruga_lattice_create(&mesh, &connectivity, &def, &lattice);
            assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
            if (status != RUGA_OK) {
                assert_int_equal(ruga_byte_count(), before);
            }
        }
        ruga_lattice_clear(&lattice);
        ruga_connectivity_clear(&connectivity);
        ruga_mesh_clear(&mesh);
        ruga_set_allocator(NULL, NULL, NULL);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mass_and_embedding_of_shapes_in_any_position),
        cmocka_unit_test(mass_of_a_slab_that_wobbles_about_the_planes),
        cmocka_unit_test(cavities_belong_to_the_body_around_them),
        cmocka_unit_test(lips_of_a_head_have_their_own_elements),
        cmocka_unit_test(box_of_a_flat_sheet_lies_under_it),
        cmocka_unit_test(box_of_a_closed_mesh_is_its_own),
        cmocka_unit_test(shape_functions_have_their_gradients),
        cmocka_unit_test(quadrature_integrates_quintics),
        cmocka_unit_test(threads_do_not_change_a_bit),
        cmocka_unit_test(unused_vertices_go_to_the_nearest_element),
        cmocka_unit_test(refuses_what_has_no_inside),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests_name("lattice", tests, NULL, check_no_leak);
}
