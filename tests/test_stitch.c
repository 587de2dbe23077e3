// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Sewing in motion, on cloth of springs along the sides of all copies; and what cuts do to stiffness.
#include "tests/check.h"
#include "tests/crease_case.h"
#include "tests/scarce_memory.h"

#include "shell/membrane.h"
#include "solver/stitch.h"

typedef struct cloth {
    crease_case c;
    ruga_stitch* stitch;
    double *x, *v, *mass, *inverse_mass, *force; // [nodes]
    double (*length)[3];                         // [pieces]
    double step;
} cloth;

static const double STIFFNESS = 100; // N/m of a whole triangle's side

// Creases across 8 x 8 squares: one straight, or two that cross; `held` nodes are the left side's.
static void make_cloth(bool cross, bool full, bool hold, cloth* k) {
    *k = (cloth){0};
    const ruga_raster_def def = ruga_default_raster_def();
    ruga_crease_freedom freedom = full ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_SINGLE;
    make_squares(8, 8, true, &k->c.mesh);
    add_line(&k->c.curves, freedom, -1, 3.37, 9, 4.61);
    if (cross) {
        add_line(&k->c.curves, freedom, 3.3, -1, 4.8, 9);
    }
    assert_ok(ruga_raster_create(&k->c.mesh, &k->c.curves, &def, &k->c.raster));
    assert_ok(ruga_cut_create(&k->c.raster, &k->c.cut));
    int nodes = k->c.cut.node_count, triangles = k->c.raster.mesh.triangle_count;
    k->x = calloc((size_t)nodes * 3, sizeof(double));
    k->v = calloc((size_t)nodes * 3, sizeof(double));
    k->force = calloc((size_t)nodes * 3, sizeof(double));
    k->mass = calloc((size_t)nodes, sizeof(double));
    k->inverse_mass = calloc((size_t)nodes, sizeof(double));
    k->length = calloc((size_t)k->c.cut.piece_count, sizeof *k->length);
    double* triangle = malloc((size_t)triangles * sizeof *triangle);
    bool* fixed = calloc((size_t)nodes, sizeof *fixed);
    for (int f = 0; f < triangles; f++) {
        triangle[f] = 0.1;
    }
    ruga_cut_masses(&k->c.cut, triangle, 0.02, false, k->mass);
    ruga_cut_rest(&k->c.raster, &k->c.cut, k->x);
    for (int n = 0; n < nodes; n++) {
        fixed[n] = hold && k->x[3 * n] < 1e-9;
        k->inverse_mass[n] = fixed[n] ? 0 : 1 / k->mass[n];
    }
    for (int p = 0; p < k->c.cut.piece_count; p++) {
        for (int i = 0; i < 3; i++) {
            const int* node = k->c.cut.piece[p].node;
            k->length[p][i] = ruga_distance(k->x + 3 * node[i], k->x + 3 * node[(i + 1) % 3]);
        }
    }
    // A side's spring between two triangles is 2 k against a sixth of their mass and more; a quarter of the
    // limit.
    k->step = 0.25 * 2 / sqrt(12 * STIFFNESS / (0.1 / 3));
    assert_ok(ruga_sewing_create(&k->c.cut, fixed, &k->c.sewing));
    assert_ok(ruga_stitch_create(&k->c.sewing, k->inverse_mass, &k->stitch));
    free(triangle);
    free(fixed);
}

static void clear_cloth(cloth* k) {
    ruga_stitch_destroy(&k->stitch);
    free(k->x);
    free(k->v);
    free(k->force);
    free(k->mass);
    free(k->inverse_mass);
    free(k->length);
    clear_case(&k->c);
}

static void add_forces(cloth* k) {
    memset(k->force, 0, (size_t)k->c.cut.node_count * 3 * sizeof *k->force);
    for (int p = 0; p < k->c.cut.piece_count; p++) {
        const ruga_cut_piece* piece = &k->c.cut.piece[p];
        for (int i = 0; i < 3; i++) {
            int a = piece->node[i], b = piece->node[(i + 1) % 3];
            double d[3];
            ruga_subtract(k->x + 3 * b, k->x + 3 * a, d);
            double now = ruga_normalize(d),
                   pull = fmax(piece->fraction, 0.02) * STIFFNESS * (now - k->length[p][i]);
            ruga_add_scaled(pull, d, k->force + 3 * a);
            ruga_add_scaled(-pull, d, k->force + 3 * b);
        }
    }
}

static void step_cloth(cloth* k, double part, double gravity, bool before, bool after) {
    double dt = part * k->step;
    add_forces(k);
    for (int n = 0; n < k->c.cut.node_count; n++) {
        ruga_add_scaled(dt * k->inverse_mass[n], k->force + 3 * n, k->v + 3 * n);
        k->v[3 * n + 2] -= k->inverse_mass[n] > 0 ? dt * gravity : 0;
    }
    if (before) {
        assert_ok(ruga_stitch_before(k->stitch, k->x, dt, k->v));
    }
    for (int i = 0; i < 3 * k->c.cut.node_count; i++) {
        k->x[i] += dt * k->v[i];
    }
    if (after) {
        assert_ok(ruga_stitch_after(k->stitch, k->v));
    }
}

static void gaps_stay_at_round_off_with_pre_and_post(void** state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        cloth k;
        double largest = 0;
        make_cloth(kind % 2, kind / 2, true, &k);
        for (int step = 0; step < 4000; step++) {
            step_cloth(&k, 1, 9.81, true, true);
            largest = fmax(largest, ruga_cut_gap(&k.c.cut, k.x));
        }
        print_message("%s, %s: gap %.2g edges over 4000 steps, %d rows\n", kind % 2 ? "cross" : "line",
                      kind / 2 ? "full" : "single", largest, k.c.sewing.row_count);
        assert_true(largest < 1e-12);
        clear_cloth(&k);
    }
}

static void post_stabilisation_alone_drifts_with_the_step(void** state) {
    (void)state;
    double gap[2];
    for (int half = 0; half < 2; half++) {
        cloth k;
        make_cloth(true, false, true, &k);
        gap[half] = 0;
        for (int step = 0; step < (half ? 4000 : 2000); step++) {
            step_cloth(&k, half ? 0.5 : 1, 9.81, false, true);
        }
        gap[half] = ruga_cut_gap(&k.c.cut, k.x);
        clear_cloth(&k);
    }
    print_message("gap by post alone %.3g, at half the step %.3g edges, ratio %.3g\n", gap[0], gap[1],
                  gap[0] / gap[1]);
    assert_true(gap[0] > 1e-2);
    assert_true(gap[0] / gap[1] > 1.6 && gap[0] / gap[1] < 2.2);
}

// Momentum and angular momentum about the origin.
static void momenta(const cloth* k, double p[3], double l[3]) {
    memset(p, 0, 3 * sizeof *p);
    memset(l, 0, 3 * sizeof *l);
    for (int n = 0; n < k->c.cut.node_count; n++) {
        double t[3];
        ruga_cross(k->x + 3 * n, k->v + 3 * n, t);
        ruga_add_scaled(k->mass[n], k->v + 3 * n, p);
        ruga_add_scaled(k->mass[n], t, l);
    }
}

static void momentum_is_conserved_in_free_flight(void** state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        cloth k;
        ruga_random random = {9};
        double p[3], l[3], q[3], m[3];
        make_cloth(kind % 2, kind / 2, false, &k);
        for (int n = 0; n < k.c.cut.node_count; n++) {
            double spin[3] = {0.2, -0.1, 0.7}, out[3];
            ruga_cross(spin, k.x + 3 * n, out);
            for (int i = 0; i < 3; i++) {
                k.v[3 * n + i] = out[i] + 0.3 * i + 0.2 * (2 * ruga_random_uniform(&random) - 1);
            }
        }
        assert_ok(ruga_stitch_after(k.stitch, k.v));
        momenta(&k, p, l);
        for (int step = 0; step < 2000; step++) {
            step_cloth(&k, 1, 0, true, true);
        }
        momenta(&k, q, m);
        print_message("dP %.2g, dL %.2g, relative\n", ruga_distance(p, q) / ruga_norm(p),
                      ruga_distance(l, m) / ruga_norm(l));
        assert_true(ruga_distance(p, q) < 1e-12 * ruga_norm(p));
        assert_true(ruga_distance(l, m) < 1e-12 * ruga_norm(l));
        clear_cloth(&k);
    }
}

static void a_gap_is_closed_at_once(void** state) {
    (void)state;
    cloth k;
    ruga_random random = {3};
    make_cloth(true, true, false, &k);
    for (int i = 0; i < 3 * k.c.cut.node_count; i++) {
        k.x[i] += 0.05 * ruga_random_uniform(&random);
    }
    assert_true(ruga_cut_gap(&k.c.cut, k.x) > 1e-3);
    assert_ok(ruga_stitch_close(k.stitch, k.x));
    assert_true(ruga_cut_gap(&k.c.cut, k.x) < 1e-13);
    clear_cloth(&k);
}

static void the_skirts_seams_factorise_sparsely(void** state) {
    (void)state;
    const int shape[2][3] = {{150, 39, 60}, {300, 36, 139}};
    for (int k = 0; k < 2; k++) {
        crease_case c = {0};
        const ruga_raster_def def = ruga_default_raster_def();
        make_squares(shape[k][0], shape[k][1], true, &c.mesh);
        for (int i = 0; i < shape[k][2]; i++) {
            double x = (int)((i + 0.5) * shape[k][0] / shape[k][2]) + 0.45;
            add_line(&c.curves, RUGA_FREEDOM_AUTO, x, -1, x, shape[k][1] + 1);
        }
        run_case(&c, &def);
        double *one = malloc((size_t)c.cut.node_count * sizeof *one),
               *v = calloc((size_t)c.cut.node_count * 3, sizeof *v),
               *gap = malloc((size_t)c.sewing.row_count * 3 * sizeof *gap);
        ruga_random random = {1};
        for (int n = 0; n < c.cut.node_count; n++) {
            one[n] = 1 + ruga_random_uniform(&random);
            v[3 * n] = ruga_random_uniform(&random);
        }
        ruga_stitch* stitch;
        assert_ok(ruga_stitch_create(&c.sewing, one, &stitch));
        assert_ok(ruga_stitch_after(stitch, v));
        ruga_sewing_gaps(&c.sewing, v, gap);
        for (int r = 0; r < 3 * c.sewing.row_count; r++) {
            assert_near(gap[r], 0, 1e-13);
        }
        ruga_stitch_destroy(&stitch);
        free(one);
        free(v);
        free(gap);
        clear_case(&c);
    }
}

static void every_failed_allocation_is_a_status(void** state) {
    (void)state;
    cloth k;
    make_cloth(true, true, false, &k);
    for (int i = 0;; i++) {
        ruga_stitch* stitch;
        let_allocations_fail_after(i);
        ruga_status status = ruga_stitch_create(&k.c.sewing, k.inverse_mass, &stitch);
        ruga_stitch_destroy(&stitch);
        ruga_set_allocator(NULL, NULL, NULL);
        if (status == RUGA_OK) {
            break;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
    }
    clear_cloth(&k);
}

// ------------------------------------------------------------------------------- stiffness

// Solves a x = b, [n][n], with partial pivoting; a and b are destroyed, b becomes x.
static void solve_dense(int n, double* a, double* b) {
    for (int j = 0; j < n; j++) {
        int best = j;
        for (int i = j + 1; i < n; i++) {
            best = fabs(a[i * n + j]) > fabs(a[best * n + j]) ? i : best;
        }
        for (int k = j; k < n; k++) {
            double swap = a[j * n + k];
            a[j * n + k] = a[best * n + k];
            a[best * n + k] = swap;
        }
        double swap = b[j];
        b[j] = b[best];
        b[best] = swap;
        for (int i = j + 1; i < n; i++) {
            double f = a[i * n + j] / a[j * n + j];
            for (int k = j; k < n && f != 0; k++) {
                a[i * n + k] -= f * a[j * n + k];
            }
            b[i] -= f * b[j];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) {
            b[i] -= a[i * n + k] * b[k];
        }
        b[i] /= a[i * n + i];
    }
}

static bool is_end(const double x[3]) {
    return x[0] < 1e-9 || x[0] > 16 - 1e-9;
}

// Energy of the small stretch u_x = x of a 16 x 8 sheet with its ends held along x, the rest free, by the KKT
// system of membrane and rows in the plane. `weight`: 0 = fractions, otherwise the least of them (1 = full
// weights).
static double stretch_energy(const crease_case* c, double least) {
    int nodes = c->cut.node_count, rows = c->sewing.row_count, n = 2 * nodes + 2 * rows;
    double *a = calloc((size_t)n * (size_t)n, sizeof *a), *b = calloc((size_t)n, sizeof *b), energy = 0;
    double *k = calloc((size_t)(4 * nodes * nodes), sizeof *k), *x = malloc((size_t)nodes * 3 * sizeof *x);
    ruga_cut_rest(&c->raster, &c->cut, x);
    for (int p = 0; p < c->cut.piece_count; p++) {
        const ruga_cut_piece* piece = &c->cut.piece[p];
        const double *at[3], growth[2] = {1, 1};
        double block[RUGA_TRIANGLE_BLOCKS][9], weight = fmax(piece->fraction, least);
        for (int i = 0; i < 3; i++) {
            at[i] = x + 3 * piece->node[i];
        }
        ruga_membrane_rest rest;
        assert_true(ruga_membrane_rest_create(at, 0.3, growth, 1, 1, &rest) > 0);
        ruga_membrane_hessian(RUGA_MEMBRANE_STVK, 0.3, &rest, at, 0, block);
        for (int t = 0; t < RUGA_TRIANGLE_BLOCKS; t++) {
            int i = piece->node[ruga_triangle_block_corner[t][0]],
                j = piece->node[ruga_triangle_block_corner[t][1]];
            bool diagonal = ruga_triangle_block_corner[t][0] == ruga_triangle_block_corner[t][1];
            for (int r = 0; r < 4; r++) {
                double value = weight * block[t][3 * (r / 2) + r % 2];
                k[(2 * i + r / 2) * 2 * nodes + 2 * j + r % 2] += value;
                k[(2 * j + r % 2) * 2 * nodes + 2 * i + r / 2] += diagonal ? 0 : value;
            }
        }
    }
    for (int i = 0; i < 2 * nodes; i++) {
        memcpy(a + (size_t)i * (size_t)n, k + (size_t)i * 2 * (size_t)nodes, 2 * (size_t)nodes * sizeof *k);
    }
    for (int r = 0; r < rows; r++) {
        for (int axis = 0; axis < 2; axis++) {
            bool held = axis == 0; // a row between held nodes alone is none
            for (int e = c->sewing.start[r]; e < c->sewing.start[r + 1]; e++) {
                held = held && is_end(x + 3 * c->sewing.node[e]);
            }
            int row = 2 * nodes + 2 * r + axis;
            a[row * n + row] = held;
            for (int e = c->sewing.start[r]; e < c->sewing.start[r + 1] && !held; e++) {
                int column = 2 * c->sewing.node[e] + axis;
                a[row * n + column] = a[column * n + row] = c->sewing.weight[e];
            }
        }
    }
    for (int m = 0; m < nodes; m++) {
        for (int axis = 0; axis < 2; axis++) {
            // Both ends along x, and the lower left corner along y; all copies.
            bool held =
                axis == 0 ? x[3 * m] < 1e-9 || x[3 * m] > 16 - 1e-9 : x[3 * m] < 1e-9 && x[3 * m + 1] < 1e-9;
            if (held) {
                memset(a + (size_t)(2 * m + axis) * (size_t)n, 0, (size_t)n * sizeof *a);
                a[(2 * m + axis) * n + 2 * m + axis] = 1;
                b[2 * m + axis] = axis == 0 ? x[3 * m] : 0;
            }
        }
    }
    solve_dense(n, a, b);
    for (int i = 0; i < 2 * nodes; i++) {
        for (int j = 0; j < 2 * nodes; j++) {
            energy += 0.5 * b[i] * k[i * 2 * nodes + j] * b[j];
        }
    }
    free(a);
    free(b);
    free(k);
    free(x);
    return energy;
}

static void a_crease_changes_no_stiffness_with_fractions_of_area(void** state) {
    (void)state;
    const double exact = 0.5 * 16 * 8; // E h strain^2 / 2 times the area
    const char* const name[] = {"across", "along", "slanted, full"};
    for (int kind = 0; kind < 3; kind++) {
        crease_case c = {0};
        const ruga_raster_def def = ruga_default_raster_def();
        make_squares(16, 8, true, &c.mesh);
        switch (kind) {
        case 0:
            for (int k = 0; k < 3; k++) {
                add_line(&c.curves, RUGA_FREEDOM_SINGLE, 3.4 + 4 * k, -1, 3.4 + 4 * k, 9);
            }
            break;
        case 1:
            add_line(&c.curves, RUGA_FREEDOM_SINGLE, -1, 3.4, 17, 3.4);
            break;
        default:
            add_line(&c.curves, RUGA_FREEDOM_FULL, -1, 2.2, 17, 6.1);
        }
        assert_ok(ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster));
        assert_ok(ruga_cut_create(&c.raster, &c.cut));
        assert_ok(ruga_sewing_create(&c.cut, NULL, &c.sewing));
        double free_of_error = stretch_energy(&c, 0) / exact - 1,
               floored = stretch_energy(&c, 0.01) / exact - 1;
        double full = stretch_energy(&c, 1) / exact - 1;
        print_message("%s: fractions %.2g, at least 0.01 %.2g, full weights %.2g\n", name[kind],
                      free_of_error, floored, full);
        assert_true(fabs(free_of_error) < 1e-5);
        assert_true(fabs(floored) < 5e-4);
        assert_true(full > 0.03);
        clear_case(&c);
    }
}

// ------------------------------------------------------------------------------- steps

// 2 / sqrt(the largest eigenvalue of P M^-1 K P), P the projection of stitch.c: the longest step of explicit
// dynamics, with springs along all sides, as stiff as they are short, by power iteration.
static double longest_step(const crease_case* c) {
    int nodes = c->cut.node_count;
    size_t size = (size_t)nodes * 3;
    double *x = malloc(size * sizeof *x), *v = malloc(size * sizeof *v), *w = malloc(size * sizeof *w);
    double *mass = malloc((size_t)nodes * sizeof *mass), *inverse = malloc((size_t)nodes * sizeof *inverse);
    double(*block)[RUGA_TRIANGLE_BLOCKS][9] = malloc((size_t)c->cut.piece_count * sizeof *block);
    double* triangle = malloc((size_t)c->raster.mesh.triangle_count * sizeof *triangle);
    ruga_random random = {4};
    ruga_stitch* stitch;
    ruga_cut_rest(&c->raster, &c->cut, x);
    for (int f = 0; f < c->raster.mesh.triangle_count; f++) {
        triangle[f] = ruga_mesh_triangle_area(&c->raster.mesh, f);
    }
    ruga_cut_masses(&c->cut, triangle, 0.02, false, mass);
    for (int p = 0; p < c->cut.piece_count; p++) {
        memset(block[p], 0, sizeof block[p]);
        for (int b = 3; b < RUGA_TRIANGLE_BLOCKS; b++) { // one for each side
            int i = ruga_triangle_block_corner[b][0], j = ruga_triangle_block_corner[b][1];
            double d[3];
            ruga_subtract(x + 3 * c->cut.piece[p].node[i], x + 3 * c->cut.piece[p].node[j], d);
            double length = ruga_normalize(d);
            for (int k = 0; k < 9; k++) {
                double stiffness = d[k / 3] * d[k % 3] / length;
                block[p][b][k] -= stiffness;
                block[p][i][k] += stiffness;
                block[p][j][k] += stiffness;
            }
        }
    }
    for (int n = 0; n < nodes; n++) {
        inverse[n] = 1 / mass[n];
    }
    for (size_t i = 0; i < size; i++) {
        v[i] = ruga_random_uniform(&random) - 0.5;
    }
    assert_ok(ruga_stitch_create(&c->sewing, inverse, &stitch));
    double value = 0;
    for (int step = 0; step < 3000; step++) {
        double before = 0, after = 0;
        assert_ok(ruga_stitch_after(stitch, v));
        memset(w, 0, size * sizeof *w);
        for (int p = 0; p < c->cut.piece_count; p++) {
            const int* node = c->cut.piece[p].node;
            for (int b = 0; b < RUGA_TRIANGLE_BLOCKS; b++) {
                int i = node[ruga_triangle_block_corner[b][0]], j = node[ruga_triangle_block_corner[b][1]];
                for (int k = 0; k < 9; k++) {
                    double value_k = fmax(c->cut.piece[p].fraction, 0.02) * block[p][b][k];
                    w[3 * i + k / 3] += value_k * v[3 * j + k % 3];
                    w[3 * j + k % 3] += b >= 3 ? value_k * v[3 * i + k / 3] : 0;
                }
            }
        }
        for (size_t i = 0; i < size; i++) {
            before += mass[i / 3] * v[i] * v[i];
            w[i] *= inverse[i / 3];
        }
        assert_ok(ruga_stitch_after(stitch, w));
        for (size_t i = 0; i < size; i++) {
            after += mass[i / 3] * w[i] * v[i];
        }
        value = after / before;
        for (size_t i = 0; i < size; i++) {
            v[i] = w[i] / value;
        }
    }
    ruga_stitch_destroy(&stitch);
    free(x);
    free(v);
    free(w);
    free(mass);
    free(inverse);
    free(block);
    free(triangle);
    return 2 / sqrt(value);
}

static void a_cut_does_not_shorten_the_step_as_a_conforming_mesh_does(void** state) {
    (void)state;
    const double offset[] = {0.5, 0.13, 0.05};
    crease_case plain = {0};
    ruga_raster_def def = ruga_default_raster_def();
    def.reach = 0; // the cut stays where it is drawn
    make_squares(12, 12, true, &plain.mesh);
    run_case(&plain, &def);
    double limit = longest_step(&plain);
    clear_case(&plain);
    for (int k = 0; k < 3; k++) {
        double step[3];
        for (int kind = 0; kind < 3; kind++) {
            crease_case c = {0};
            make_squares(12, 12, true, &c.mesh);
            add_line(&c.curves, kind == 0 ? RUGA_FREEDOM_SINGLE : RUGA_FREEDOM_FULL, -1, 6 + offset[k], 13,
                     6 + offset[k]);
            run_case(&c, &def);
            if (kind == 2) {
                crease_case conforming = {0};
                assert_ok(ruga_mesh_copy(&c.cut.material, &conforming.mesh));
                run_case(&conforming, &def);
                step[kind] = longest_step(&conforming);
                clear_case(&conforming);
            } else {
                step[kind] = longest_step(&c);
            }
            clear_case(&c);
        }
        print_message(
            "offset %.2f: step over that of the plain mesh: single %.3f, full %.3f, conforming mesh %.3f\n",
            offset[k], step[0] / limit, step[1] / limit, step[2] / limit);
        assert_true(step[0] > 0.95 * limit);
        assert_true(step[1] > 0.8 * limit);
        assert_true(offset[k] > 0.13 || step[2] < 0.2 * limit);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gaps_stay_at_round_off_with_pre_and_post),
        cmocka_unit_test(post_stabilisation_alone_drifts_with_the_step),
        cmocka_unit_test(momentum_is_conserved_in_free_flight),
        cmocka_unit_test(a_gap_is_closed_at_once),
        cmocka_unit_test(the_skirts_seams_factorise_sparsely),
        cmocka_unit_test(every_failed_allocation_is_a_status),
        cmocka_unit_test(a_crease_changes_no_stiffness_with_fractions_of_area),
        cmocka_unit_test(a_cut_does_not_shorten_the_step_as_a_conforming_mesh_does),
    };
    return cmocka_run_group_tests_name("stitch", tests, NULL, check_no_leak);
}
