// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "constraints/attachments.h"
#include "core/memory.h"
#include "core/progress.h"
#include "core/random.h"
#include "core/vec3.h"
#include "mesh/make.h"

#include <stdlib.h>
#include <string.h>

typedef struct body {
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    ruga_lattice lattice;
} body;

static void make_surface(ruga_make_def def, body* b) {
    memset(b, 0, sizeof *b);
    assert_ok(ruga_mesh_make(&def, &b->mesh));
    assert_ok(ruga_connectivity_create(&b->mesh, &b->connectivity));
}

static void make_body(ruga_make_def def, int cells, int degree, body* b) {
    make_surface(def, b);
    ruga_lattice_def lattice = {.cells = cells, .degree = degree, .fill = RUGA_FILL_MESH};
    assert_ok(ruga_lattice_create(&b->mesh, &b->connectivity, &lattice, &b->lattice));
}

static void clear_body(body* b) {
    ruga_mesh_clear(&b->mesh);
    ruga_connectivity_clear(&b->connectivity);
    ruga_lattice_clear(&b->lattice);
}

static const ruga_make_def BAR = {.shape = RUGA_SHAPE_BAR, .size = {0.8, 0.2, 0.2}, .edge = 0.03};
static const ruga_make_def SPHERE = {.shape = RUGA_SHAPE_SPHERE, .size = {1, 0, 0}, .edge = 0.1};
static const ruga_make_def SHEET = {.shape = RUGA_SHAPE_SHEET, .size = {1, 0.5, 0}, .edge = 0.1};

static ruga_region box(double x0, double y0, double z0, double x1, double y1, double z1) {
    return (ruga_region){.kind = RUGA_REGION_BOX, .min = {x0, y0, z0}, .max = {x1, y1, z1}};
}

static ruga_handle_def fix(ruga_region region) {
    return (ruga_handle_def){.region = region, .kind = RUGA_HANDLE_FIX, .axes = {true, true, true}};
}

static ruga_handle_def move(ruga_region region) {
    ruga_handle_def handle = {.region = region,
                              .kind = RUGA_HANDLE_MOVE,
                              .axes = {true, true, true},
                              .translate = {0.05, -0.1, 0.02},
                              .rotate_axis = {1, 2, 0.5},
                              .rotate_angle = 0.7,
                              .rotate_center = {0.1, 0, -0.1}};
    return handle;
}

// Regions

static void what_is_drawn_at_a_bound_is_in(void** state) {
    (void)state;
    body b;
    make_surface(SHEET, &b);
    int count, *list = malloc((size_t)b.mesh.vertex_count * sizeof *list);
    // The sheet is 1 x 0.5 m: bounds that miss its rim by round-off only.
    ruga_region region = box(-0.5 + 1e-12, -0.25, 0, 0.5 - 1e-12, 0.25, 0);
    assert_ok(ruga_region_vertices(&region, &b.mesh, &count, list));
    assert_int_equal(count, b.mesh.vertex_count);
    region = box(-0.5 + 1e-6, -1, -1, 1, 1, 1);
    assert_ok(ruga_region_vertices(&region, &b.mesh, &count, list));
    assert_true(count < b.mesh.vertex_count && count > 0);
    region = (ruga_region){.kind = RUGA_REGION_PLANE, .center = {0.5, 0, 0}, .normal = {3, 0, 0}};
    assert_ok(ruga_region_vertices(&region, &b.mesh, &count, list));
    assert_true(count >= 2);
    for (int k = 0; k < count; k++) {
        assert_near(b.mesh.position[3 * list[k]], 0.5, 1e-8);
        assert_true(k == 0 || list[k] > list[k - 1]);
    }
    region = (ruga_region){.kind = RUGA_REGION_SPHERE, .center = {0.5, 0.25, 0}, .radius = 0};
    assert_ok(ruga_region_vertices(&region, &b.mesh, &count, list));
    assert_int_equal(count, 1);
    region = (ruga_region){.kind = RUGA_REGION_ALL};
    assert_ok(ruga_region_vertices(&region, &b.mesh, &count, list));
    assert_int_equal(count, b.mesh.vertex_count);
    free(list);
    clear_body(&b);
}

static void bad_regions_are_refused_with_a_sentence(void** state) {
    (void)state;
    body b;
    make_surface(SHEET, &b);
    int count, *list = malloc((size_t)b.mesh.vertex_count * sizeof *list);
    const int vertices[] = {3, 1, 3, 100000};
    ruga_region region = {.kind = RUGA_REGION_VERTICES, .vertex_count = 4, .vertices = vertices};
    assert_status(ruga_region_vertices(&region, &b.mesh, &count, list), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "vertex 100000"));
    region.vertex_count = 3;
    assert_ok(ruga_region_vertices(&region, &b.mesh, &count, list));
    assert_int_equal(count, 2);
    assert_int_equal(list[0], 1);
    region = (ruga_region){.kind = RUGA_REGION_GROUP, .group = "seat"};
    assert_status(ruga_region_vertices(&region, &b.mesh, &count, list), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "no groups"));
    region = (ruga_region){.kind = RUGA_REGION_PLANE};
    assert_status(ruga_region_vertices(&region, &b.mesh, &count, list), RUGA_BAD_INPUT);
    region = box(1, 0, 0, 0, 1, 1);
    assert_status(ruga_region_vertices(&region, &b.mesh, &count, list), RUGA_BAD_INPUT);
    free(list);
    clear_body(&b);
}

// Two triangles, one of them in group "b".
static void make_grouped(body* b) {
    static const double position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    static const int triangle[] = {0, 1, 2, 2, 1, 3}, group[] = {0, 1};
    static const char* const names[] = {"a", "b"};
    ruga_mesh_def def = {.vertex_count = 4,
                         .positions = position,
                         .triangle_count = 2,
                         .triangles = triangle,
                         .group_count = 2,
                         .group_names = names,
                         .face_group = group};
    memset(b, 0, sizeof *b);
    assert_ok(ruga_mesh_from_def(&def, &b->mesh));
    assert_ok(ruga_connectivity_create(&b->mesh, &b->connectivity));
}

static void a_group_is_the_vertices_of_its_faces(void** state) {
    (void)state;
    body b;
    int count, list[4];
    make_grouped(&b);
    ruga_region region = {.kind = RUGA_REGION_GROUP, .group = "b"};
    assert_ok(ruga_region_vertices(&region, &b.mesh, &count, list));
    assert_int_equal(count, 3);
    assert_int_equal(list[0], 1);
    region.group = "c";
    assert_status(ruga_region_vertices(&region, &b.mesh, &count, list), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "\"a\", \"b\""));
    clear_body(&b);
}

// Motions

static void a_ramp_is_linear_and_then_held(void** state) {
    (void)state;
    ruga_handle_def h = fix((ruga_region){0});
    assert_near(ruga_handle_ramp(&h, 0), 1, 0);
    h.ramped = true;
    h.during[0] = 1;
    h.during[1] = 3;
    assert_near(ruga_handle_ramp(&h, 0), 0, 0);
    assert_near(ruga_handle_ramp(&h, 1), 0, 0);
    assert_near(ruga_handle_ramp(&h, 1.5), 0.25, 0);
    assert_near(ruga_handle_ramp(&h, 3), 1, 0);
    assert_near(ruga_handle_ramp(&h, 9), 1, 0);
    h.during[1] = 1; // a step
    assert_near(ruga_handle_ramp(&h, 0.999), 0, 0);
    assert_near(ruga_handle_ramp(&h, 1), 1, 0);
}

static void a_move_is_rigid_and_a_fix_stays(void** state) {
    (void)state;
    const double p[3] = {0.3, -0.2, 0.9}, q[3] = {-0.5, 0.4, 0.1};
    double a[3], b[3];
    ruga_handle_def h = move((ruga_region){0});
    ruga_handle_target(&h, 0, p, a);
    ruga_handle_target(&h, 0, q, b);
    assert_near(ruga_distance(a, b), ruga_distance(p, q), 1e-15);
    // The centre is only translated; a quarter turn about z takes x to y.
    h = (ruga_handle_def){.kind = RUGA_HANDLE_MOVE,
                          .translate = {0, 0, 1},
                          .rotate_axis = {0, 0, 5},
                          .rotate_angle = RUGA_PI,
                          .rotate_center = {1, 0, 0},
                          .ramped = true,
                          .during = {0, 1}};
    const double x[3] = {2, 0, 0};
    ruga_handle_target(&h, 0.5, x, a);
    assert_near(a[0], 1, 1e-15);
    assert_near(a[1], 1, 1e-15);
    assert_near(a[2], 0.5, 0);
    h.kind = RUGA_HANDLE_FIX;
    ruga_handle_target(&h, 1, x, a);
    assert_memory_equal(a, x, sizeof x);
}

// Rows

// x = argmin |x| with a a^T y = r, x = a^T y, by a dense Cholesky factor; `least` is its smallest pivot.
static void solve_gram(int n, double* gram, double* r, double* least) {
    for (int j = 0; j < n; j++) {
        double pivot = gram[j * n + j];
        for (int k = 0; k < j; k++) {
            pivot -= gram[j * n + k] * gram[j * n + k];
        }
        *least = pivot < *least ? pivot : *least;
        gram[j * n + j] = sqrt(pivot);
        for (int i = j + 1; i < n; i++) {
            double sum = gram[i * n + j];
            for (int k = 0; k < j; k++) {
                sum -= gram[i * n + k] * gram[j * n + k];
            }
            gram[i * n + j] = sum / gram[j * n + j];
        }
        double sum = r[j];
        for (int k = 0; k < j; k++) {
            sum -= gram[j * n + k] * r[k];
        }
        r[j] = sum / gram[j * n + j];
    }
    for (int j = n - 1; j >= 0; j--) {
        double sum = r[j];
        for (int k = j + 1; k < n; k++) {
            sum -= gram[k * n + j] * r[k];
        }
        r[j] = sum / gram[j * n + j];
    }
}

// Moves q as little as possible so that all rows hold; returns the smallest pivot of A A^T.
static double satisfy(const body* b, const ruga_rows* rows, const ruga_handle_def* handles, double* q) {
    double least = INFINITY;
    double* dense = malloc((size_t)b->lattice.node_count * sizeof *dense);
    for (int axis = 0; axis < 3; axis++) {
        int first = 0, n = 0;
        while (first < rows->count && rows->axis[first] < axis) {
            first++;
        }
        while (first + n < rows->count && rows->axis[first + n] == axis) {
            n++;
        }
        double* gram = calloc((size_t)n * (size_t)n + 1, sizeof *gram);
        double* r = malloc((size_t)(n + 1) * sizeof *r);
        for (int i = 0; i < n; i++) {
            double target[3];
            ruga_handle_target(&handles[rows->handle[first + i]], 1, rows->point + 3 * (first + i), target);
            memset(dense, 0, (size_t)b->lattice.node_count * sizeof *dense);
            r[i] = target[axis];
            for (int k = rows->start[first + i]; k < rows->start[first + i + 1]; k++) {
                dense[rows->node[k]] = rows->weight[k];
                r[i] -= rows->weight[k] * q[3 * rows->node[k] + axis];
            }
            for (int j = 0; j < n; j++) {
                for (int k = rows->start[first + j]; k < rows->start[first + j + 1]; k++) {
                    gram[i * n + j] += rows->weight[k] * dense[rows->node[k]];
                }
            }
        }
        solve_gram(n, gram, r, &least);
        for (int i = 0; i < n; i++) {
            for (int k = rows->start[first + i]; k < rows->start[first + i + 1]; k++) {
                q[3 * rows->node[k] + axis] += rows->weight[k] * r[i];
            }
        }
        free(gram);
        free(r);
    }
    free(dense);
    return least;
}

// Largest distance, over the held components, of the region's material points (vertices, and quadrature
// points where the region is one of space) from where the handle takes them.
static double worst_point(const body* b, const ruga_handle_def* handle, const double* q, int* points) {
    const ruga_lattice* l = &b->lattice;
    int n = l->nodes_per_element, count;
    int* list = malloc((size_t)b->mesh.vertex_count * sizeof *list);
    double worst = 0;
    assert_ok(ruga_region_vertices(&handle->region, &b->mesh, &count, list));
    *points = 0;
    for (int i = 0; i < count + 27 * l->element_count; i++) {
        double weight[27], x[3], xi[3], target[3];
        int e = i < count ? l->vertex_element[list[i]] : (i - count) / 27;
        if (i < count) {
            memcpy(weight, l->vertex_weight + list[i] * n, (size_t)n * sizeof *weight);
            memcpy(x, b->mesh.position + 3 * list[i], sizeof x);
        } else {
            ruga_lattice_point(l, e, (i - count) % 27, xi, x);
            ruga_lattice_shape(l, xi, weight, NULL);
            if (l->volume[i - count] <= 0 || !ruga_region_contains_within(&handle->region, x, 0)) {
                continue;
            }
        }
        ++*points;
        ruga_handle_target(handle, 1, x, target);
        for (int c = 0; c < 3; c++) {
            double sum = 0;
            for (int k = 0; k < n; k++) {
                sum += weight[k] * q[3 * l->element_node[e * n + k] + c];
            }
            double error = handle->axes[c] ? fabs(sum - target[c]) : 0;
            worst = error > worst ? error : worst;
        }
    }
    free(list);
    return worst;
}

// Rows of the handles; from rest moved to satisfy them; returns the error left in the first handle's region.
static double hold_and_measure(const body* b, int count, const ruga_handle_def* handles, const char* name) {
    ruga_rows rows;
    assert_ok(ruga_rows_create(&b->lattice, &b->mesh, count, handles, &rows));
    assert_true(rows.count > 0);
    for (int i = 0; i < rows.count; i++) {
        double sum = 0;
        for (int k = rows.start[i]; k < rows.start[i + 1]; k++) {
            sum += rows.weight[k];
        }
        assert_near(sum, 1, 1e-12);
    }
    double* q = malloc((size_t)b->lattice.node_count * 3 * sizeof *q);
    memcpy(q, b->lattice.rest, (size_t)b->lattice.node_count * 3 * sizeof *q);
    double least = satisfy(b, &rows, handles, q);
    int points;
    double worst = worst_point(b, &handles[0], q, &points);
    print_message(
        "  %s: %d rows for %d points on %d nodes, error left %.1e m, smallest pivot of A A^T %.1e\n", name,
        rows.count, points, b->lattice.node_count, worst, least);
    assert_true(least > 1e-8);
    ruga_rows_clear(&rows);
    free(q);
    return worst;
}

// The motions below are of some 0.3 m.
static void a_held_region_follows_its_handle(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        body b;
        make_body(BAR, 8, degree, &b);
        ruga_handle_def handle = move(box(-1, -1, -1, -0.15, 1, 1));
        assert_true(hold_and_measure(&b, 1, &handle, "bar, end") < 1e-6);
        handle.region = box(-1, -1, -1, -0.33, 1, 1); // cuts a cell
        assert_true(hold_and_measure(&b, 1, &handle, "bar, cut cell") < 1e-4);
        handle.region = (ruga_region){.kind = RUGA_REGION_ALL};
        assert_true(hold_and_measure(&b, 1, &handle, "bar, all") < 1e-12);
        clear_body(&b);
        make_body(SPHERE, 6, degree, &b);
        handle.region = (ruga_region){.kind = RUGA_REGION_SPHERE, .center = {0, 0, 0.5}, .radius = 0.41};
        assert_true(hold_and_measure(&b, 1, &handle, "sphere, cap") < 1e-4);
        clear_body(&b);
    }
}

static void surface_points_alone_are_held(void** state) {
    (void)state;
    body b;
    make_body(BAR, 8, 2, &b);
    int count, *list = malloc((size_t)b.mesh.vertex_count * sizeof *list);
    ruga_region top = box(-1, -1, 0.0999, 1, 1, 1);
    assert_ok(ruga_region_vertices(&top, &b.mesh, &count, list));
    ruga_handle_def handle = move((ruga_region){.kind = RUGA_REGION_VERTICES, .vertices = list});
    handle.region.vertex_count = count;
    assert_true(hold_and_measure(&b, 1, &handle, "bar, top vertices") < 1e-3);
    handle.region.vertex_count = 1;
    assert_true(hold_and_measure(&b, 1, &handle, "bar, one vertex") < 1e-12);
    free(list);
    clear_body(&b);
}

static void a_single_point_gets_a_single_row_for_each_axis(void** state) {
    (void)state;
    body b;
    make_body(BAR, 4, 2, &b);
    const int vertex = 17;
    ruga_handle_def handle = fix((ruga_region){.kind = RUGA_REGION_VERTICES});
    handle.region.vertices = &vertex;
    handle.region.vertex_count = 1;
    ruga_rows rows;
    assert_ok(ruga_rows_create(&b.lattice, &b.mesh, 1, &handle, &rows));
    assert_int_equal(rows.count, 3);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(rows.axis[i], i);
        assert_memory_equal(rows.point + 3 * i, b.mesh.position + 3 * vertex, 3 * sizeof(double));
    }
    ruga_rows_clear(&rows);
    handle.axes[0] = handle.axes[2] = false;
    assert_ok(ruga_rows_create(&b.lattice, &b.mesh, 1, &handle, &rows));
    assert_int_equal(rows.count, 1);
    assert_int_equal(rows.axis[0], 1);
    ruga_rows_clear(&rows);
    clear_body(&b);
}

static void the_first_of_overlapping_handles_wins(void** state) {
    (void)state;
    body b;
    make_body(BAR, 8, 2, &b);
    ruga_handle_def handles[2] = {move(box(-1, -1, -1, -0.15, 1, 1)), fix(box(-0.25, -1, -1, 1, 1, 1))};
    assert_true(hold_and_measure(&b, 2, handles, "move, then fix") < 1e-6);
    ruga_handle_def swapped[2] = {handles[1], handles[0]};
    assert_true(hold_and_measure(&b, 2, swapped, "fix, then move") < 1e-6);
    // A vertex held first keeps its motion although the region around it is fixed later.
    const int vertex = 0;
    ruga_handle_def pinned[2] = {move((ruga_region){.kind = RUGA_REGION_VERTICES}),
                                 fix(box(-1, -1, -1, 1, 1, 1))};
    pinned[0].region.vertices = &vertex;
    pinned[0].region.vertex_count = 1;
    assert_true(hold_and_measure(&b, 2, pinned, "vertex, then all") < 1e-10);
    // On other components it does not matter.
    ruga_handle_def crossed[2] = {fix(box(-1, -1, -1, 0, 1, 1)), fix(box(-1, -1, -1, 0, 1, 1))};
    crossed[0].axes[1] = crossed[0].axes[2] = crossed[1].axes[0] = false;
    ruga_rows rows;
    assert_ok(ruga_rows_create(&b.lattice, &b.mesh, 2, crossed, &rows));
    for (int i = 0; i < rows.count; i++) {
        assert_int_equal(rows.handle[i], rows.axis[i] == 0 ? 0 : 1);
    }
    ruga_rows_clear(&rows);
    clear_body(&b);
}

static void handles_that_crowd_one_another_are_known(void** state) {
    (void)state;
    body b;
    make_body(BAR, 8, 2, &b);
    ruga_handle_def handles[3] = {fix(box(-1, -1, -1, -0.2, 1, 1)), fix(box(-0.2, -1, -1, -0.1, 1, 1)),
                                  move(box(0.2, -1, -1, 1, 1, 1))};
    for (int shift = 0; shift < 2; shift++) {
        ruga_rows rows;
        int pair[2] = {-1, -1};
        handles[2].region.min[0] = shift ? 0.1 : 0.2;
        assert_ok(ruga_rows_create(&b.lattice, &b.mesh, 3, handles, &rows));
        // Held nodes lie half a cell outside of what they hold.
        assert_near(ruga_rows_nearest(&rows, &b.lattice, handles, pair), shift ? 1 : 2, 1e-9);
        assert_int_equal(pair[0], 1);
        assert_int_equal(pair[1], 2);
        ruga_rows_clear(&rows);
    }
    ruga_rows rows;
    int pair[2];
    assert_ok(ruga_rows_create(&b.lattice, &b.mesh, 2, handles, &rows));
    assert_true(ruga_rows_nearest(&rows, &b.lattice, handles, pair) == INFINITY);
    ruga_rows_clear(&rows);
    clear_body(&b);
}

static void handles_that_do_not_hold_the_interior_give_no_rows(void** state) {
    (void)state;
    body b;
    make_body(BAR, 4, 2, &b);
    ruga_handle_def handles[2] = {fix(box(-1, -1, -1, 1, 1, 1)), fix(box(-1, -1, -1, 1, 1, 1))};
    handles[0].hold = RUGA_HOLD_SKIN;
    handles[1].kind = RUGA_HANDLE_PRESS;
    ruga_rows rows;
    assert_ok(ruga_rows_create(&b.lattice, &b.mesh, 2, handles, &rows));
    assert_int_equal(rows.count, 0);
    ruga_rows_clear(&rows);
    handles[1] = fix(box(5, 5, 5, 6, 6, 6));
    assert_status(ruga_rows_create(&b.lattice, &b.mesh, 2, handles, &rows), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "handles.1: the region (box) selects no material"));
    clear_body(&b);
}

static void a_large_lattice_is_held_quickly(void** state) {
    (void)state;
    body b;
    make_body((ruga_make_def){.shape = RUGA_SHAPE_SPHERE, .size = {1, 0, 0}, .edge = 0.03}, 20, 2, &b);
    ruga_handle_def handle =
        fix((ruga_region){.kind = RUGA_REGION_PLANE, .center = {0, 0, 0.15}, .normal = {0, 0.1, 1}});
    ruga_rows rows;
    double begin = ruga_clock();
    assert_ok(ruga_rows_create(&b.lattice, &b.mesh, 1, &handle, &rows));
    print_message("  %d elements, %d nodes: %d rows in %.2f s\n", b.lattice.element_count,
                  b.lattice.node_count, rows.count, ruga_clock() - begin);
    ruga_rows_clear(&rows);
    clear_body(&b);
}

// Loads

typedef struct loaded {
    body body;
    ruga_loads* loads;
    int n;
    double *x, *gradient, *other;
} loaded;

static void make_loaded(ruga_make_def def, const ruga_handle_def* handle, double disturbance, loaded* s) {
    make_surface(def, &s->body);
    assert_ok(ruga_loads_create(&s->body.mesh, &s->body.connectivity, 1, handle, &s->loads));
    s->n = 3 * s->body.mesh.vertex_count;
    s->x = malloc((size_t)s->n * sizeof *s->x);
    s->gradient = calloc((size_t)s->n, sizeof *s->gradient);
    s->other = calloc((size_t)s->n, sizeof *s->other);
    ruga_random random = {3};
    for (int i = 0; i < s->n; i++) {
        s->x[i] = s->body.mesh.position[i] + disturbance * (ruga_random_uniform(&random) - 0.5);
    }
}

static void clear_loaded(loaded* s) {
    ruga_loads_destroy(&s->loads);
    clear_body(&s->body);
    free(s->x);
    free(s->gradient);
    free(s->other);
}

static double energy_of(const loaded* s, const double* x, double* gradient) {
    double energy;
    assert_ok(ruga_loads_energy(s->loads, x, 1, &energy, gradient, NULL, NULL, NULL));
    return energy;
}

static ruga_handle_def press(ruga_region region) {
    return (ruga_handle_def){.region = region, .kind = RUGA_HANDLE_PRESS, .pressure = 5};
}

// Error of centred differences along random directions: falls by 4 when the step is halved.
static void pressure_gradient_is_the_difference_of_energies(void** state) {
    (void)state;
    loaded s;
    ruga_handle_def handle = press(box(-1, -1, 0, 1, 1, 1));
    make_loaded(SPHERE, &handle, 0.2, &s);
    (void)energy_of(&s, s.x, s.gradient);
    double error[3];
    for (int k = 0; k < 3; k++) {
        double step = 0.1 / (1 << k), slope = 0;
        double* moved = malloc((size_t)s.n * sizeof *moved);
        double energies[2];
        for (int side = 0; side < 2; side++) {
            ruga_random random = {8};
            for (int i = 0; i < s.n; i++) {
                double direction = ruga_random_uniform(&random) - 0.3;
                slope += side ? 0 : direction * s.gradient[i];
                moved[i] = s.x[i] + (side ? -step : step) * direction;
            }
            energies[side] = energy_of(&s, moved, NULL);
        }
        error[k] = fabs((energies[0] - energies[1]) / (2 * step) - slope);
        free(moved);
    }
    print_message("  errors of centred differences: %.2e %.2e %.2e\n", error[0], error[1], error[2]);
    assert_near(error[0] / error[1], 4, 0.01);
    assert_near(error[1] / error[2], 4, 0.01);
    clear_loaded(&s);
}

// The gradient is quadratic in x, so that its centred differences are exact but for round-off.
static void pressure_hessian_is_the_difference_of_gradients(void** state) {
    (void)state;
    loaded s;
    ruga_handle_def handle = press(box(-1, -1, 0, 1, 1, 1));
    make_loaded(SPHERE, &handle, 0.2, &s);
    ruga_sparse pattern;
    double energy;
    assert_ok(ruga_sparse_from_pairs(s.body.mesh.vertex_count, 3, s.body.connectivity.edge_count,
                                     (const int(*)[2])s.body.connectivity.edge, &pattern));
    assert_ok(ruga_loads_energy(s.loads, s.x, 1, &energy, NULL, &pattern, pattern.value, NULL));
    double* direction = malloc((size_t)s.n * sizeof *direction);
    double* product = malloc((size_t)s.n * sizeof *product);
    double* moved = malloc((size_t)s.n * sizeof *moved);
    const double step = 0.05;
    ruga_random random = {8};
    for (int i = 0; i < s.n; i++) {
        direction[i] = ruga_random_uniform(&random) - 0.5;
    }
    ruga_sparse_multiply_symmetric(&pattern, direction, product);
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i < s.n; i++) {
            moved[i] = s.x[i] + side * step * direction[i];
        }
        (void)energy_of(&s, moved, side < 0 ? s.other : s.gradient);
    }
    for (int i = 0; i < s.n; i++) {
        assert_near((s.gradient[i] - s.other[i]) / (2 * step), product[i], 1e-13);
    }
    free(direction);
    free(product);
    free(moved);
    ruga_sparse_clear(&pattern);
    clear_loaded(&s);
}

// Energy p (V - V_rest), force -p A n / 3 at the corners of each deformed triangle.
static void a_closed_region_feels_exact_follower_pressure(void** state) {
    (void)state;
    loaded s;
    ruga_handle_def handle = press((ruga_region){.kind = RUGA_REGION_ALL});
    make_loaded(SPHERE, &handle, 0.3, &s);
    double energy = energy_of(&s, s.x, s.gradient), rest = ruga_mesh_volume(&s.body.mesh);
    for (int t = 0; t < s.body.mesh.triangle_count; t++) {
        const int* c = s.body.mesh.triangle + 3 * t;
        double n[3];
        ruga_triangle_normal(s.x + 3 * c[0], s.x + 3 * c[1], s.x + 3 * c[2], n);
        for (int k = 0; k < 3; k++) {
            ruga_add_scaled(5.0 / 6, n, s.other + 3 * c[k]);
        }
    }
    for (int i = 0; i < s.n; i++) {
        assert_near(s.gradient[i], s.other[i], 1e-14);
    }
    memcpy(s.body.mesh.position, s.x, (size_t)s.n * sizeof *s.x);
    assert_near(energy, 5 * (ruga_mesh_volume(&s.body.mesh) - rest), 1e-13);
    clear_loaded(&s);
}

static void sum_forces(const loaded* s, double sum[3]) {
    sum[0] = sum[1] = sum[2] = 0;
    for (int i = 0; i < s->n; i++) {
        sum[i % 3] -= s->gradient[i];
    }
}

static void a_flat_patch_feels_pressure_times_area_inward(void** state) {
    (void)state;
    loaded s;
    double sum[3];
    ruga_handle_def handle = press((ruga_region){.kind = RUGA_REGION_ALL});
    make_loaded(SHEET, &handle, 0, &s);
    for (int i = 0; i < s.n; i++) {
        s.x[i] += 0.1 * (i % 3 + 1); // also when it was carried along
    }
    (void)energy_of(&s, s.x, s.gradient);
    sum_forces(&s, sum);
    assert_near(sum[0], 0, 1e-14);
    assert_near(sum[1], 0, 1e-14);
    assert_near(sum[2], -5 * 0.5, 1e-13);
    clear_loaded(&s);
}

static void a_total_force_and_a_line_force_add_up(void** state) {
    (void)state;
    loaded s;
    double sum[3], square = 1;
    ruga_handle_def handle = {.region = box(-1, -1, -1, 0, 1, 1),
                              .kind = RUGA_HANDLE_FORCE,
                              .force = {1, -2, 3},
                              .ramped = true,
                              .during = {0, 2}};
    make_loaded(SHEET, &handle, 0.1, &s);
    double energy = energy_of(&s, s.x, s.gradient), work = 0;
    sum_forces(&s, sum);
    for (int c = 0; c < 3; c++) {
        assert_near(sum[c], 0.5 * handle.force[c], 1e-14);
    }
    for (int i = 0; i < s.n; i++) {
        work += s.gradient[i] * (s.x[i] - s.body.mesh.position[i]);
    }
    assert_near(energy, work, 1e-15);
    assert_ok(ruga_loads_energy(s.loads, s.x, 0, &energy, s.gradient, NULL, NULL, &square));
    assert_near(energy, 0, 0);
    assert_near(square, 1, 0);
    clear_loaded(&s);
    // Along the edge x = 0.5 of 0.5 m.
    handle = (ruga_handle_def){
        .region = box(0.5, -1, -1, 1, 1, 1), .kind = RUGA_HANDLE_LINE_FORCE, .force = {1, -2, 3}};
    make_loaded(SHEET, &handle, 0.1, &s);
    (void)energy_of(&s, s.x, s.gradient);
    sum_forces(&s, sum);
    for (int c = 0; c < 3; c++) {
        assert_near(sum[c], 0.5 * handle.force[c], 1e-14);
    }
    clear_loaded(&s);
}

static void loads_that_act_on_nothing_are_refused(void** state) {
    (void)state;
    body b;
    ruga_loads* loads;
    make_surface(SPHERE, &b);
    ruga_region nowhere = box(5, 5, 5, 6, 6, 6);
    ruga_handle_def handles[] = {
        press(nowhere),
        {.region = nowhere, .kind = RUGA_HANDLE_FORCE, .force = {1, 0, 0}},
        {.region = {.kind = RUGA_REGION_ALL}, .kind = RUGA_HANDLE_LINE_FORCE, .force = {1, 0, 0}},
        press((ruga_region){.kind = RUGA_REGION_GROUP, .group = "seat"}),
    };
    const char* const words[] = {"whole face", "vertex with area", "boundary edge", "handles.0"};
    for (int i = 0; i < 4; i++) {
        assert_status(ruga_loads_create(&b.mesh, &b.connectivity, 1, &handles[i], &loads), RUGA_BAD_INPUT);
        assert_non_null(strstr(ruga_last_error(), words[i]));
        assert_null(loads);
    }
    assert_ok(ruga_loads_create(&b.mesh, &b.connectivity, 0, NULL, &loads));
    double energy = -1;
    assert_ok(ruga_loads_energy(loads, b.mesh.position, 0, &energy, NULL, NULL, NULL, NULL));
    assert_near(energy, 0, 0);
    ruga_loads_destroy(&loads);
    clear_body(&b);
}

static void a_group_is_pressed_on_its_faces(void** state) {
    (void)state;
    body b;
    ruga_loads* loads;
    double energy, gradient[12] = {0};
    make_grouped(&b);
    ruga_handle_def handle = press((ruga_region){.kind = RUGA_REGION_GROUP, .group = "b"});
    assert_ok(ruga_loads_create(&b.mesh, &b.connectivity, 1, &handle, &loads));
    assert_ok(ruga_loads_energy(loads, b.mesh.position, 0, &energy, gradient, NULL, NULL, NULL));
    assert_near(gradient[2], 0, 0);
    assert_near(gradient[5], 5.0 / 6, 1e-15);
    ruga_loads_destroy(&loads);
    clear_body(&b);
}

static void any_allocation_may_fail(void** state) {
    (void)state;
    body b;
    make_body(BAR, 4, 2, &b);
    const ruga_handle_def handles[] = {
        fix(box(-1, -1, -1, -0.23, 1, 1)),
        press(box(-1, -1, 0, 1, 1, 1)),
        {.region = {.kind = RUGA_REGION_ALL}, .kind = RUGA_HANDLE_FORCE, .force = {1, 0, 0}},
    };
    for (int kind = 0; kind < 2; kind++) {
        ruga_status status = RUGA_NO_MEMORY;
        for (int k = 0; status != RUGA_OK; k++) {
            ruga_rows rows = {0};
            ruga_loads* loads = NULL;
            size_t before = ruga_byte_count();
            let_allocations_fail_after(k);
            status = kind == 0 ? ruga_rows_create(&b.lattice, &b.mesh, 3, handles, &rows)
                               : ruga_loads_create(&b.mesh, &b.connectivity, 3, handles, &loads);
            assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
            assert_true(status == RUGA_OK || ruga_byte_count() == before);
            ruga_rows_clear(&rows);
            ruga_loads_destroy(&loads);
            ruga_set_allocator(NULL, NULL, NULL);
            assert_true(k < 1000);
        }
    }
    clear_body(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_drawn_at_a_bound_is_in),
        cmocka_unit_test(bad_regions_are_refused_with_a_sentence),
        cmocka_unit_test(a_group_is_the_vertices_of_its_faces),
        cmocka_unit_test(a_ramp_is_linear_and_then_held),
        cmocka_unit_test(a_move_is_rigid_and_a_fix_stays),
        cmocka_unit_test(a_held_region_follows_its_handle),
        cmocka_unit_test(surface_points_alone_are_held),
        cmocka_unit_test(a_single_point_gets_a_single_row_for_each_axis),
        cmocka_unit_test(the_first_of_overlapping_handles_wins),
        cmocka_unit_test(handles_that_crowd_one_another_are_known),
        cmocka_unit_test(handles_that_do_not_hold_the_interior_give_no_rows),
        cmocka_unit_test(a_large_lattice_is_held_quickly),
        cmocka_unit_test(pressure_gradient_is_the_difference_of_energies),
        cmocka_unit_test(pressure_hessian_is_the_difference_of_gradients),
        cmocka_unit_test(a_closed_region_feels_exact_follower_pressure),
        cmocka_unit_test(a_flat_patch_feels_pressure_times_area_inward),
        cmocka_unit_test(a_total_force_and_a_line_force_add_up),
        cmocka_unit_test(loads_that_act_on_nothing_are_refused),
        cmocka_unit_test(a_group_is_pressed_on_its_faces),
        cmocka_unit_test(any_allocation_may_fail),
    };
    return cmocka_run_group_tests_name("attachments", tests, NULL, check_no_leak);
}
