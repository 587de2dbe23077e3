// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/miura.h"
#include "tests/random_creases.h"

#include "crease/hinge.h"
#include "crease/pairs.h"
#include "shell/membrane.h"

// A sheet with one straight crease from border to border.
typedef struct strip {
    crease_case c;
    ruga_hinge* hinge;
    double *rest, *x; // [nodes][3]
    double at[3], direction[3];
} strip;

static void make_strip(ruga_crease_freedom freedom, strip* s) {
    *s = (strip){.at = {0, 1.37, 0}, .direction = {1, 0.31, 0}};
    const ruga_raster_def def = ruga_default_raster_def();
    make_squares(6, 5, true, &s->c.mesh);
    add_line(&s->c.curves, freedom, -1, 1.37 - 0.31, 9, 1.37 + 9 * 0.31);
    run_case(&s->c, &def);
    s->hinge = malloc((size_t)s->c.cut.segment_count * sizeof *s->hinge);
    s->rest = malloc((size_t)s->c.cut.node_count * 3 * sizeof *s->rest);
    s->x = malloc((size_t)s->c.cut.node_count * 3 * sizeof *s->x);
    ruga_hinges_make(&s->c.raster, &s->c.cut, s->hinge);
    ruga_cut_rest(&s->c.raster, &s->c.cut, s->rest);
    memcpy(s->x, s->rest, (size_t)s->c.cut.node_count * 3 * sizeof *s->x);
    ruga_normalize(s->direction);
}

static void clear_strip(strip* s) {
    free(s->hinge);
    free(s->rest);
    free(s->x);
    clear_case(&s->c);
}

// Turns x about the line through `at` along the unit vector `axis`.
static void turn(const double at[3], const double axis[3], double angle, const double x[3], double y[3]) {
    double d[3], c[3], along;
    ruga_subtract(x, at, d);
    ruga_cross(axis, d, c);
    along = (1 - cos(angle)) * ruga_dot(axis, d);
    for (int i = 0; i < 3; i++) {
        y[i] = at[i] + cos(angle) * d[i] + sin(angle) * c[i] + along * axis[i];
    }
}

// Folds what lies on the left of the crease up by `angle`.
static void fold_strip(strip* s, double angle) {
    for (int p = 0; p < s->c.cut.piece_count; p++) {
        const ruga_cut_piece* piece = &s->c.cut.piece[p];
        double middle[3], d[3], c[3];
        middle_of(&s->c, piece, middle);
        ruga_subtract(middle, s->at, d);
        ruga_cross(s->direction, d, c);
        for (int i = 0; i < 3; i++) {
            size_t n = (size_t)piece->node[i];
            turn(s->at, s->direction, c[2] > 0 ? angle : 0, s->rest + 3 * n, s->x + 3 * n);
        }
    }
}

// Membrane energy of all pieces at x, for a unit material.
static double membrane_energy(const strip* s) {
    double energy = 0;
    for (int p = 0; p < s->c.cut.piece_count; p++) {
        const double *rest[3], *x[3], growth[2] = {1, 1};
        double gradient[3][3];
        for (int i = 0; i < 3; i++) {
            rest[i] = s->rest + 3 * s->c.cut.piece[p].node[i];
            x[i] = s->x + 3 * s->c.cut.piece[p].node[i];
        }
        ruga_membrane_rest membrane;
        assert_true(ruga_membrane_rest_create(rest, 0.3, growth, 1, 1, &membrane) > 0);
        energy += s->c.cut.piece[p].fraction *
                  ruga_membrane_energy(RUGA_MEMBRANE_BARAFF_WITKIN, 0.3, &membrane, x, gradient);
    }
    return energy;
}

// ------------------------------------------------------------------------------- rigid folds

static void a_straight_cut_folds_rigidly_without_gap_or_energy(void** state) {
    (void)state;
    for (int full = 0; full < 2; full++) {
        strip s;
        make_strip(full ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_SINGLE, &s);
        const double angle[] = {-179, -120, -30, 0, 1e-4, 30, 90, 179};
        for (int k = 0; k < 8; k++) {
            fold_strip(&s, angle[k] * DEGREE);
            assert_true(ruga_cut_gap(&s.c.cut, s.x) < 1e-14);
            assert_true(membrane_energy(&s) < 1e-24);
            for (int h = 0; h < s.c.cut.segment_count; h++) {
                double wanted = s.hinge[h].curve >= 0 ? angle[k] * DEGREE : 0;
                assert_near(ruga_hinge_measure(&s.hinge[h], s.x, NULL, NULL), wanted, 1e-12);
            }
        }
        clear_strip(&s);
    }
}

static void an_angle_can_be_followed_through_half_a_turn(void** state) {
    (void)state;
    strip s;
    make_strip(RUGA_FREEDOM_SINGLE, &s);
    double near = 0;
    for (int k = 0; k <= 40; k++) {
        fold_strip(&s, 5.5 * k * DEGREE);
        near = ruga_hinge_measure(&s.hinge[0], s.x, &near, NULL);
        assert_near(near, 5.5 * k * DEGREE, 1e-12);
    }
    clear_strip(&s);
}

static void copies_are_twice_the_sine_of_half_the_angle_apart(void** state) {
    (void)state;
    strip s;
    int count;
    ruga_pair* pair;
    make_strip(RUGA_FREEDOM_SINGLE, &s);
    assert_ok(ruga_pairs_create(&s.c.cut, &count, &pair));
    assert_int_equal(count, new_nodes(&s.c));
    for (double angle = 10; angle < 180; angle += 13) {
        fold_strip(&s, angle * DEGREE);
        for (int k = 0; k < count; k++) {
            const double *a = s.x + 3 * pair[k].node[0], *b = s.x + 3 * pair[k].node[1];
            double d[3], c[3];
            ruga_subtract(s.rest + 3 * pair[k].node[0], s.at, d);
            ruga_cross(s.direction, d, c);
            assert_near(ruga_distance(a, b), 2 * ruga_norm(c) * sin(angle * DEGREE / 2), 1e-12);
        }
    }
    ruga_release(pair);
    clear_strip(&s);
}

static double spring_energy(strip* s, int count, const ruga_pair* pair, const double* length, double angle) {
    double energy = 0;
    fold_strip(s, angle);
    for (int k = 0; k < count; k++) {
        double off = ruga_distance(s->x + 3 * pair[k].node[0], s->x + 3 * pair[k].node[1]) - length[k];
        energy += 0.5 * 3 * off * off;
    }
    return energy;
}

static void springs_are_softer_the_more_they_are_folded(void** state) {
    (void)state;
    strip s;
    int count;
    ruga_pair* pair;
    make_strip(RUGA_FREEDOM_SINGLE, &s);
    assert_ok(ruga_pairs_create(&s.c.cut, &count, &pair));
    double *length = malloc((size_t)count * sizeof *length), flat = 0;
    for (int k = 0; k < count; k++) {
        double d[3], c[3];
        ruga_subtract(s.rest + 3 * pair[k].node[0], s.at, d);
        ruga_cross(s.direction, d, c);
        flat += 3 * ruga_dot(c, c);
    }
    for (double angle = 20; angle <= 170; angle += 50) {
        double h = 1e-3, at = angle * DEGREE;
        fold_strip(&s, at);
        for (int k = 0; k < count; k++) {
            length[k] = ruga_distance(s.x + 3 * pair[k].node[0], s.x + 3 * pair[k].node[1]);
        }
        double stiffness = (spring_energy(&s, count, pair, length, at + h) +
                            spring_energy(&s, count, pair, length, at - h)) /
                           (h * h);
        assert_near(stiffness / flat, pow(cos(at / 2), 2), 1e-4);
    }
    free(length);
    ruga_release(pair);
    clear_strip(&s);
}

// ------------------------------------------------------------------------------- derivatives

// Largest differences of the gradient and the Hessian from centred differences with step h.
static void difference(const ruga_hinge* hinge, double* x, const double* near, double h, double error[2]) {
    double gradient[6][3], hessian[18][18], above[6][3], below[6][3];
    ruga_hinge_energy(hinge, 1.7, 0.4, x, near, 0, gradient, hessian);
    error[0] = error[1] = 0;
    for (int a = 0; a < 18; a++) {
        double *at = &x[3 * hinge->node[a / 3] + a % 3], keep = *at, sum = 0, row[18] = {0};
        *at = keep + h;
        double up = ruga_hinge_energy(hinge, 1.7, 0.4, x, near, 0, above, NULL);
        *at = keep - h;
        double down = ruga_hinge_energy(hinge, 1.7, 0.4, x, near, 0, below, NULL);
        *at = keep;
        // A node that both elements share stands twice in the list: its derivatives add up.
        for (int b = 0; b < 18; b++) {
            if (hinge->node[b / 3] == hinge->node[a / 3] && b % 3 == a % 3) {
                sum += gradient[b / 3][b % 3];
                for (int c = 0; c < 18; c++) {
                    row[c] += hessian[b][c];
                }
            }
        }
        error[0] = fmax(error[0], fabs((up - down) / (2 * h) - sum));
        for (int c = 0; c < 18; c++) {
            error[1] = fmax(error[1], fabs((above[c / 3][c % 3] - below[c / 3][c % 3]) / (2 * h) - row[c]));
        }
    }
}

static void derivatives_are_centred_differences_of_second_order(void** state) {
    (void)state;
    for (int full = 0; full < 2; full++) {
        strip s;
        ruga_random random = {5};
        make_strip(full ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_SINGLE, &s);
        fold_strip(&s, 100 * DEGREE);
        for (int i = 0; i < 3 * s.c.cut.node_count; i++) {
            s.x[i] += 0.1 * (2 * ruga_random_uniform(&random) - 1);
        }
        for (int k = 0; k < s.c.cut.segment_count; k += 3) {
            double coarse[2], fine[2];
            difference(&s.hinge[k], s.x, NULL, 2e-3, coarse);
            difference(&s.hinge[k], s.x, NULL, 1e-3, fine);
            for (int i = 0; i < 2; i++) {
                assert_true(fine[i] < 1e-2 && coarse[i] / fine[i] > 3.9 && coarse[i] / fine[i] < 4.1);
            }
        }
        clear_strip(&s);
    }
}

static void gauss_newton_is_semi_definite_and_rigid_motion_changes_nothing(void** state) {
    (void)state;
    strip s;
    make_strip(RUGA_FREEDOM_FULL, &s);
    fold_strip(&s, -70 * DEGREE);
    for (int k = 0; k < s.c.cut.segment_count; k++) {
        double gradient[6][3], hessian[18][18], least, most, force[3] = {0}, torque[3] = {0};
        ruga_hinge_energy(&s.hinge[k], 1, 0.2, s.x, NULL, 1, gradient, hessian);
        for (int a = 0; a < 6; a++) {
            double t[3];
            ruga_cross(s.x + 3 * s.hinge[k].node[a], gradient[a], t);
            ruga_add_scaled(1, gradient[a], force);
            ruga_add_scaled(1, t, torque);
        }
        assert_near(ruga_norm(force), 0, 1e-12);
        assert_near(ruga_norm(torque), 0, 1e-12);
        dense_eigenvalue_range(18, &hessian[0][0], &least, &most);
        assert_true(least > -1e-12 * most);
    }
    clear_strip(&s);
}

// ------------------------------------------------------------------------------- Miura-ori

// Moves every piece with its panel. Returns the largest disagreement of pieces that share a node.
static double fold_miura(const crease_case* c, double theta, double* x) {
    double disagreement = 0;
    bool* set = calloc((size_t)c->cut.node_count, sizeof *set);
    for (int p = 0; p < c->cut.piece_count; p++) {
        double middle[3];
        middle_of(c, &c->cut.piece[p], middle);
        for (int i = 0; i < 3; i++) {
            int n = c->cut.piece[p].node[i];
            double y[3];
            int panel[2];
            miura_find_panel(middle, panel);
            miura_fold_point(panel, theta, c->raster.mesh.position + 3 * c->cut.source[n], y);
            if (set[n]) {
                disagreement = fmax(disagreement, ruga_distance(y, x + 3 * n));
            }
            set[n] = true;
            memcpy(x + 3 * n, y, sizeof y);
        }
    }
    free(set);
    return disagreement;
}

static void miura_folds_rigidly_on_meshes_that_know_nothing_of_it(void** state) {
    (void)state;
    const ruga_raster_def def = ruga_default_raster_def();
    for (int n = 5; n <= 30; n++) {
        crease_case c;
        miura_make(n, &c);
        run_case(&c, &def);
        double* x = calloc((size_t)c.cut.node_count * 3, sizeof *x);
        ruga_hinge* hinge = malloc((size_t)c.cut.segment_count * sizeof *hinge);
        ruga_hinges_make(&c.raster, &c.cut, hinge);
        assert_true(fold_miura(&c, 50 * DEGREE, x) < 1e-13);
        assert_true(ruga_cut_gap(&c.cut, x) < 1e-13);
        print_message(
            "n = %d: %d triangles become %d, %d rows, %d vertices moved, %d edges split, %d rounds\n", n,
            c.mesh.triangle_count, c.cut.piece_count, c.sewing.row_count, c.raster.moved,
            c.raster.split_edges, c.raster.rounds);
        // Two angles, each with both signs: along the straight lines and along the zigzags.
        double angle[2] = {0, 0};
        for (int k = 0; k < c.cut.segment_count; k++) {
            double at = fabs(ruga_hinge_measure(&hinge[k], x, NULL, NULL)),
                   *known = &angle[hinge[k].curve >= 4];
            *known = *known == 0 ? at : *known;
            assert_near(at, *known, 1e-11);
        }
        assert_true(angle[0] > 0.1 && angle[1] > 0.1);
        free(x);
        free(hinge);
        clear_case(&c);
    }
}

static void miura_on_kinked_creases_does_not_close(void** state) {
    (void)state;
    crease_case c;
    const ruga_raster_def def = ruga_default_raster_def();
    miura_make(10, &c);
    assert_ok(ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster));
    // As if two hits of an edge had been merged.
    for (int e = 0; e < c.raster.edges.edge_count; e++) {
        c.raster.node[e] =
            c.raster.node[e] > 0 ? c.raster.node[e] + (c.raster.node[e] > 0.5 ? -0.2 : 0.2) : 0;
    }
    assert_ok(ruga_cut_create(&c.raster, &c.cut));
    double* x = calloc((size_t)c.cut.node_count * 3, sizeof *x);
    fold_miura(&c, 50 * DEGREE, x);
    assert_true(ruga_cut_gap(&c.cut, x) > 1e-2);
    free(x);
    clear_case(&c);
}

// ------------------------------------------------------------------------------- locks

// Lower triangular factor of S for unit masses, in place.
static double* factor_rows(const crease_case* c) {
    int n = c->sewing.row_count;
    double* one = malloc((size_t)c->cut.node_count * sizeof *one);
    double* value = malloc((size_t)(c->sewing.pattern.start[n] + 1) * sizeof *value);
    double* a = malloc((size_t)(n * n + 1) * sizeof *a);
    for (int k = 0; k < c->cut.node_count; k++) {
        one[k] = 1;
    }
    ruga_sewing_matrix(&c->sewing, one, value);
    dense_from_lower(&c->sewing.pattern, value, a);
    for (int j = 0; j < n; j++) {
        for (int k = 0; k < j; k++) {
            for (int i = j; i < n && a[j * n + k] != 0; i++) {
                a[i * n + j] -= a[i * n + k] * a[j * n + k];
            }
        }
        assert_true(a[j * n + j] > 0);
        double pivot = sqrt(a[j * n + j]);
        for (int i = j; i < n; i++) {
            a[i * n + j] /= pivot;
        }
    }
    free(one);
    free(value);
    return a;
}

static void solve_rows(int n, const double* l, double* b) {
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++) {
            b[i] -= l[i * n + k] * b[k];
        }
        b[i] /= l[i * n + i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) {
            b[i] -= l[k * n + i] * b[k];
        }
        b[i] /= l[i * n + i];
    }
}

// Largest over smallest eigenvalue of S for unit masses, from its factor, by powers of it and of its inverse.
static double condition_of(int n, const double* l) {
    double *a = malloc((size_t)(n + 1) * sizeof *a), *b = malloc((size_t)(n + 1) * sizeof *b),
           value[2] = {1, 1};
    for (int inverse = 0; inverse < 2; inverse++) {
        for (int i = 0; i < n; i++) {
            a[i] = 1 + 0.1 * ((i * 7) % 11);
        }
        for (int step = 0; step < 60; step++) {
            double norm = 0;
            for (int i = 0; i < n; i++) {
                norm += a[i] * a[i];
            }
            for (int i = 0; i < n; i++) {
                a[i] /= sqrt(norm);
            }
            value[inverse] = sqrt(norm);
            if (inverse) {
                solve_rows(n, l, a);
                continue;
            }
            for (int k = 0; k < n; k++) { // l^T a, then l times it
                b[k] = 0;
                for (int i = k; i < n; i++) {
                    b[k] += l[i * n + k] * a[i];
                }
            }
            for (int i = 0; i < n; i++) {
                a[i] = 0;
                for (int k = 0; k <= i; k++) {
                    a[i] += l[i * n + k] * b[k];
                }
            }
        }
    }
    free(a);
    free(b);
    return n > 0 ? value[0] * value[1] : 1;
}

// Part of an angle's gradient that is left once all motions that tear the seams are taken out: 0 = locked.
static double freedom_to_turn(const crease_case* c, const ruga_hinge* hinge, const double* l,
                              const double* x) {
    int rows = c->sewing.row_count, nodes = c->cut.node_count;
    double* g = calloc((size_t)nodes * 3, sizeof *g);
    double *gap = malloc((size_t)(rows * 3 + 1) * sizeof *gap),
           *one = malloc((size_t)(rows + 1) * sizeof *one);
    double own[6][3], before = 0, after = 0;
    ruga_hinge_measure(hinge, x, NULL, own);
    for (int a = 0; a < 6; a++) {
        ruga_add_scaled(1, own[a], g + 3 * hinge->node[a]);
    }
    ruga_sewing_gaps(&c->sewing, g, gap);
    for (int i = 0; i < 3; i++) {
        for (int r = 0; r < rows; r++) {
            one[r] = gap[3 * r + i];
        }
        solve_rows(rows, l, one);
        for (int r = 0; r < rows; r++) {
            gap[3 * r + i] = one[r];
        }
    }
    for (int k = 0; k < 3 * nodes; k++) {
        before += g[k] * g[k];
    }
    ruga_sewing_spread(&c->sewing, NULL, -1, gap, g);
    for (int k = 0; k < 3 * nodes; k++) {
        after += g[k] * g[k];
    }
    free(g);
    free(gap);
    free(one);
    return sqrt(after / before);
}

static void no_crease_of_random_curves_is_locked(void** state) {
    (void)state;
    double least = 1, worst = 1;
    int segments = 0, refused = 0;
    for (int k = 0; k < 1000; k++) {
        ruga_random random = {1000 + (uint64_t)k};
        crease_case c = {0};
        double size[2];
        random_mesh(&random, size, &c.mesh);
        random_curves(&random, size, &c.curves);
        const ruga_raster_def def = ruga_default_raster_def();
        if (ruga_raster_create(&c.mesh, &c.curves, &def, &c.raster) == RUGA_OK) {
            assert_ok(ruga_cut_create(&c.raster, &c.cut));
            assert_ok(ruga_sewing_create(&c.cut, NULL, &c.sewing));
            double *x = malloc((size_t)c.cut.node_count * 3 * sizeof *x), *l = factor_rows(&c);
            worst = fmax(worst, condition_of(c.sewing.row_count, l));
            ruga_hinge* hinge = malloc((size_t)(c.cut.segment_count + 1) * sizeof *hinge);
            ruga_hinges_make(&c.raster, &c.cut, hinge);
            ruga_cut_rest(&c.raster, &c.cut, x);
            for (int s = 0; s < c.cut.segment_count; s++) {
                if (hinge[s].curve >= 0) {
                    double left = freedom_to_turn(&c, &hinge[s], l, x);
                    if (left < 1e-6) {
                        print_message("set %d, curve %d: %g\n", k, hinge[s].curve, left);
                    }
                    least = fmin(least, left);
                    segments++;
                }
            }
            free(x);
            free(l);
            free(hinge);
        } else {
            refused++;
        }
        clear_case(&c);
    }
    print_message("%d segments, %d sets refused, least freedom %g, worst condition of S %.2g\n", segments,
                  refused, least, worst);
    assert_true(worst < 1e7);
    assert_true(least > 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_straight_cut_folds_rigidly_without_gap_or_energy),
        cmocka_unit_test(an_angle_can_be_followed_through_half_a_turn),
        cmocka_unit_test(copies_are_twice_the_sine_of_half_the_angle_apart),
        cmocka_unit_test(springs_are_softer_the_more_they_are_folded),
        cmocka_unit_test(derivatives_are_centred_differences_of_second_order),
        cmocka_unit_test(gauss_newton_is_semi_definite_and_rigid_motion_changes_nothing),
        cmocka_unit_test(miura_folds_rigidly_on_meshes_that_know_nothing_of_it),
        cmocka_unit_test(miura_on_kinked_creases_does_not_close),
        cmocka_unit_test(no_crease_of_random_curves_is_locked),
    };
    return cmocka_run_group_tests_name("hinge", tests, NULL, check_no_leak);
}
