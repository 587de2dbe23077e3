// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/miura.h"
#include "tests/scarce_memory.h"

#include "solver/stitch.h"
#include "tests/creased.h"
#include "tests/small_scene.h"

typedef struct panel {
    crease_case c;
    double *x, *stiffness, *rest;
    bool* fixed;
    ruga_creased_def def;
    ruga_creased* creased;
} panel;

// Turns all nodes of pieces with x > line up by `angle` about the line x = `line`, z = 0.
static void fold(panel* p, double line, double angle) {
    for (int k = 0; k < p->c.cut.piece_count; k++) {
        const ruga_cut_piece* piece = &p->c.cut.piece[k];
        double middle[3];
        middle_of(&p->c, piece, middle);
        for (int i = 0; i < 3; i++) {
            const double* from = p->c.raster.mesh.position + 3 * p->c.cut.source[piece->node[i]];
            double* to = p->x + 3 * piece->node[i];
            double turn = middle[0] > line ? angle : 0, arm = from[0] - line;
            to[0] = line + arm * cos(turn);
            to[1] = from[1];
            to[2] = arm * sin(turn);
        }
    }
}

// Cuts the mesh of p along its curves; all hinges of one stiffness and flat at rest, nothing held. snap:
// vertices near a curve are moved onto it.
static void cut_panel(bool snap, double stiffness, panel* p) {
    ruga_raster_def raster = ruga_default_raster_def();
    raster.snap = snap;
    assert_ok(ruga_raster_create(&p->c.mesh, &p->c.curves, &raster, &p->c.raster));
    assert_ok(ruga_cut_create(&p->c.raster, &p->c.cut));
    int nodes = p->c.cut.node_count, segments = p->c.cut.segment_count;
    p->x = malloc((size_t)nodes * 3 * sizeof *p->x);
    p->fixed = calloc((size_t)nodes, sizeof *p->fixed);
    p->stiffness = malloc((size_t)segments * sizeof *p->stiffness);
    p->rest = calloc((size_t)segments, sizeof *p->rest);
    for (int s = 0; s < segments; s++) {
        p->stiffness[s] = stiffness;
    }
}

// 8 x 4 squares of 1 m, a crease across at x = `line`; all copies left of it held. Gravity -z.
static void make_panel(ruga_crease_freedom freedom, double line, double stiffness, panel* p) {
    *p = (panel){.def = ruga_default_creased_def()};
    make_squares(8, 4, true, &p->c.mesh);
    add_line(&p->c.curves, freedom, line, -1, line, 5);
    cut_panel(true, stiffness, p);
    for (int k = 0; k < p->c.cut.piece_count; k++) {
        double middle[3];
        middle_of(&p->c, &p->c.cut.piece[k], middle);
        for (int i = 0; i < 3 && middle[0] < line; i++) {
            p->fixed[p->c.cut.piece[k].node[i]] = true;
        }
    }
    p->def.raster = &p->c.raster;
    p->def.cut = &p->c.cut;
    p->def.skin = (ruga_skin_def){.thickness = 0.05, .young = 1e9, .poisson = 0.3, .density = 1000};
    p->def.stiffness = p->stiffness;
    p->def.fixed = p->fixed;
    p->def.gravity[2] = -9.81;
}

static void clear_panel(panel* p) {
    ruga_creased_destroy(&p->creased);
    free(p->x);
    free(p->fixed);
    free(p->stiffness);
    free(p->rest);
    clear_case(&p->c);
}

static void a_free_hinge_hangs_straight_down(void** state) {
    (void)state;
    for (int full = 0; full < 2; full++) {
        panel p;
        ruga_creased_report report;
        make_panel(full ? RUGA_FREEDOM_FULL : RUGA_FREEDOM_SINGLE, 3.4, 0, &p);
        assert_ok(ruga_creased_create(&p.def, &p.creased));
        fold(&p, 3.4, -50 * DEGREE);
        assert_ok(ruga_creased_solve(p.creased, p.rest, p.x, &report));
        const double* angle = ruga_creased_angles(p.creased);
        print_message("outcome %d after %d iterations (%d factors), residual %.2g, gap %.2g\n",
                      report.outcome, report.iterations, report.factorizations, report.residual, report.gap);
        assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
        assert_true(report.gap < 1e-12);
        for (int s = 0; s < p.c.cut.segment_count; s++) {
            if (p.c.cut.segment[s].curve >= 0) {
                assert_near(angle[s], -90 * DEGREE, 1e-3 * DEGREE);
            }
        }
        clear_panel(&p);
    }
}

static double mean_angle(const panel* p) {
    const double* angle = ruga_creased_angles(p->creased);
    double sum = 0, length = 0;
    for (int s = 0; s < p->c.cut.segment_count; s++) {
        const ruga_segment* segment = &p->c.cut.segment[s];
        sum += segment->curve >= 0 ? segment->length * angle[s] : 0;
        length += segment->curve >= 0 ? segment->length : 0;
    }
    return sum / length;
}

static void a_spring_hinge_balances_the_weight_of_a_stiff_panel(void** state) {
    (void)state;
    const double stiffness[] = {5000, 20000, 100000};
    for (int k = 0; k < 3; k++) {
        panel p;
        ruga_creased_report report;
        make_panel(RUGA_FREEDOM_SINGLE, 3.4, stiffness[k], &p);
        p.def.skin.young = 1e12;
        p.def.tolerance = 1e-7; // round-off of forces E h (1e10 N/m) against a weight of 1e4 N
        assert_ok(ruga_creased_create(&p.def, &p.creased));
        fold(&p, 3.4, -30 * DEGREE);
        assert_ok(ruga_creased_solve(p.creased, p.rest, p.x, &report));
        assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
        // k L theta = M cos(theta), M = rho h g L arm^2 / 2
        double moment = 1000 * 0.05 * 9.81 * 4 * 4.6 * 4.6 / 2, theta = 0.5;
        for (int i = 0; i < 50; i++) {
            theta -=
                (stiffness[k] * 4 * theta - moment * cos(theta)) / (stiffness[k] * 4 + moment * sin(theta));
        }
        print_message("k = %g: %.4f degrees, rigid %.4f\n", stiffness[k], mean_angle(&p) / DEGREE,
                      -theta / DEGREE);
        assert_near(mean_angle(&p), -theta, 0.1 * DEGREE);
        clear_panel(&p);
    }
}

static void a_solution_is_kept(void** state) {
    (void)state;
    panel p;
    ruga_creased_report report;
    make_panel(RUGA_FREEDOM_FULL, 3.4, 5000, &p);
    assert_ok(ruga_creased_create(&p.def, &p.creased));
    fold(&p, 3.4, -30 * DEGREE);
    assert_ok(ruga_creased_solve(p.creased, p.rest, p.x, &report));
    size_t bytes = (size_t)p.c.cut.node_count * 3 * sizeof *p.x;
    double* before = malloc(bytes);
    memcpy(before, p.x, bytes);
    assert_ok(ruga_creased_solve(p.creased, p.rest, p.x, &report));
    for (int i = 0; i < 3 * p.c.cut.node_count; i++) {
        assert_near(p.x[i], before[i], 1e-8);
    }
    assert_true(report.iterations <= 1);
    free(before);
    clear_panel(&p);
}

// Equations 9 and 10 of the paper, a projection after each unconstrained step, leave the equilibrium for a
// state that is none: the reason why the rows are in the system.
static void projecting_after_the_step_would_leave_the_solution(void** state) {
    (void)state;
    panel p = {.def = ruga_default_creased_def()};
    const ruga_raster_def raster = ruga_default_raster_def();
    make_squares(8, 6, true, &p.c.mesh);
    add_line(&p.c.curves, RUGA_FREEDOM_SINGLE, 1.4, 1.6, 6.6,
             4.3); // within the sheet, so that nothing comes loose
    assert_ok(ruga_raster_create(&p.c.mesh, &p.c.curves, &raster, &p.c.raster));
    assert_ok(ruga_cut_create(&p.c.raster, &p.c.cut));
    int nodes = p.c.cut.node_count, segments = p.c.cut.segment_count;
    p.x = malloc((size_t)nodes * 3 * sizeof *p.x);
    p.fixed = calloc((size_t)nodes, sizeof *p.fixed);
    p.stiffness = calloc((size_t)segments, sizeof *p.stiffness);
    p.rest = calloc((size_t)segments, sizeof *p.rest);
    ruga_cut_rest(&p.c.raster, &p.c.cut, p.x);
    double* inverse = malloc((size_t)nodes * sizeof *inverse);
    for (int n = 0; n < nodes; n++) {
        const double* x = p.x + 3 * n;
        p.fixed[n] = x[0] < 1e-9 || x[0] > 8 - 1e-9 || x[1] < 1e-9 || x[1] > 6 - 1e-9;
        inverse[n] = p.fixed[n] ? 0 : 1;
    }
    p.def.raster = &p.c.raster;
    p.def.cut = &p.c.cut;
    p.def.skin = (ruga_skin_def){.thickness = 0.05, .young = 1e6, .poisson = 0.3, .density = 1000};
    p.def.stiffness = p.stiffness;
    p.def.fixed = p.fixed;
    p.def.gravity[2] = -9.81;
    ruga_creased_report report;
    assert_ok(ruga_creased_create(&p.def, &p.creased));
    assert_ok(ruga_creased_solve(p.creased, p.rest, p.x, &report));
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    // The same energy without rows, one step at a time, with the seams closed in the metric of equal masses.
    ruga_cut torn = p.c.cut;
    torn.bound_count = 0;
    ruga_creased_def def = p.def;
    def.cut = &torn;
    def.iterations = 1;
    ruga_creased* loose;
    ruga_sewing sewing;
    ruga_stitch* stitch;
    assert_ok(ruga_creased_create(&def, &loose));
    assert_ok(ruga_sewing_create(&p.c.cut, p.fixed, &sewing));
    assert_ok(ruga_stitch_create(&sewing, inverse, &stitch));
    double *x = malloc((size_t)nodes * 3 * sizeof *x), *before = malloc((size_t)nodes * 3 * sizeof *before),
           away = 0, last = 0;
    memcpy(x, p.x, (size_t)nodes * 3 * sizeof *x);
    for (int step = 0; step < 60; step++) {
        ruga_creased_report ignored;
        memcpy(before, x, (size_t)nodes * 3 * sizeof *x);
        assert_ok(ruga_creased_solve(loose, p.rest, x, &ignored));
        for (int i = 0; i < 3 * nodes; i++) {
            x[i] = 0.7 * before[i] + 0.3 * x[i]; // damped, as it would not settle otherwise
        }
        assert_ok(ruga_stitch_close(stitch, x));
        last = 0;
        for (int n = 0; n < nodes; n++) {
            away = fmax(away, ruga_distance(x + 3 * n, p.x + 3 * n));
            last = fmax(last, ruga_distance(x + 3 * n, before + 3 * n));
        }
    }
    print_message("away from the solution by %.3g m, last step %.2g m\n", away, last);
    assert_true(away > 1e-3);
    ruga_stitch_destroy(&stitch);
    ruga_sewing_clear(&sewing);
    ruga_creased_destroy(&loose);
    free(x);
    free(before);
    free(inverse);
    clear_panel(&p);
}

// The mesh that conforms to the cut of `p`: its material, with the creases along mesh edges, in the same
// state.
static void make_conforming(const panel* p, panel* q) {
    *q = (panel){.def = p->def};
    ruga_connectivity edges;
    const ruga_raster_def raster = ruga_default_raster_def();
    assert_ok(ruga_mesh_copy(&p->c.cut.material, &q->c.mesh));
    assert_ok(ruga_connectivity_create(&q->c.mesh, &edges));
    bool* marked = calloc((size_t)edges.edge_count, sizeof *marked);
    for (int s = 0; s < p->c.cut.segment_count; s++) {
        const ruga_segment* segment = &p->c.cut.segment[s];
        if (segment->curve >= 0) {
            marked[ruga_edge_between(&edges, segment->end[0], segment->end[1])] = true;
        }
    }
    assert_ok(ruga_curves_add_edges(&q->c.curves, &(ruga_curve){0}, &q->c.mesh, &edges, marked));
    assert_ok(ruga_raster_create(&q->c.mesh, &q->c.curves, &raster, &q->c.raster));
    assert_ok(ruga_cut_create(&q->c.raster, &q->c.cut));
    int nodes = q->c.cut.node_count;
    assert_int_equal(nodes, p->c.cut.material.vertex_count);
    q->x = malloc((size_t)nodes * 3 * sizeof *q->x);
    q->fixed = calloc((size_t)nodes, sizeof *q->fixed);
    q->stiffness = calloc((size_t)q->c.cut.segment_count, sizeof *q->stiffness);
    q->rest = calloc((size_t)q->c.cut.segment_count, sizeof *q->rest);
    for (int s = 0; s < q->c.cut.segment_count; s++) {
        q->stiffness[s] = p->stiffness[0];
    }
    ruga_cut_material(&p->c.cut, p->x, q->x);
    for (int n = 0; n < p->c.cut.real_count; n++) {
        q->fixed[n] = p->fixed[n];
    }
    for (int b = 0; b < p->c.cut.bound_count; b++) {
        const ruga_bound* bound = &p->c.cut.bound[b];
        bool held = false;
        for (int k = 0; k < bound->count; k++) {
            const int* parent = p->c.cut.parent[bound->first + k];
            held = held || (p->fixed[parent[0]] && p->fixed[parent[1]]);
        }
        q->fixed[p->c.cut.real_count + b] = held;
    }
    q->def.raster = &q->c.raster;
    q->def.cut = &q->c.cut;
    q->def.stiffness = q->stiffness;
    q->def.fixed = q->fixed;
    free(marked);
    ruga_connectivity_clear(&edges);
}

// A crease whose embedded nodes are off straight by up to `off` of an edge, hanging under gravity from a
// fold.
static void hang_kinked(ruga_crease_freedom freedom, double off, panel* p, ruga_creased_report* report) {
    ruga_random random = {21};
    make_panel(freedom, 3.4, 0, p);
    ruga_cut_clear(&p->c.cut);
    for (int e = 0; e < p->c.raster.edges.edge_count; e++) {
        double by = off * (2 * ruga_random_uniform(&random) - 1);
        p->c.raster.node[e] += p->c.raster.node[e] > 0 ? by : 0;
    }
    assert_ok(ruga_cut_create(&p->c.raster, &p->c.cut));
    assert_ok(ruga_creased_create(&p->def, &p->creased));
    ruga_cut_rest(&p->c.raster, &p->c.cut, p->x);
    assert_ok(ruga_creased_solve(p->creased, p->rest, p->x, report));
}

static void a_kinked_crease_locks_but_for_auxiliary_chords(void** state) {
    (void)state;
    panel single, full, conforming;
    ruga_creased_report report, fine;
    hang_kinked(RUGA_FREEDOM_SINGLE, 1e-2, &single, &report);
    print_message("single: %.3f degrees, outcome %d, residual %.2g, %d iterations\n",
                  mean_angle(&single) / DEGREE, report.outcome, report.residual, report.iterations);
    hang_kinked(RUGA_FREEDOM_FULL, 1e-2, &full, &report);
    print_message("full: %.3f degrees, outcome %d, residual %.2g, %d iterations\n",
                  mean_angle(&full) / DEGREE, report.outcome, report.residual, report.iterations);
    make_conforming(&full, &conforming);
    assert_ok(ruga_creased_create(&conforming.def, &conforming.creased));
    conforming.def.iterations = 0;
    ruga_creased* still = NULL;
    assert_ok(ruga_creased_create(&conforming.def, &still));
    assert_ok(ruga_creased_solve(still, conforming.rest, conforming.x, &fine));
    ruga_creased_destroy(&still);
    print_message("same state: membrane %.6g and conforming %.6g, bending %.6g and %.6g\n", report.membrane,
                  fine.membrane, report.bending, fine.bending);
    assert_near(fine.membrane, report.membrane, 0.01 * fabs(report.membrane));
    assert_ok(ruga_creased_solve(conforming.creased, conforming.rest, conforming.x, &fine));
    print_message("conforming: %.3f degrees, outcome %d, residual %.2g, %d iterations\n",
                  mean_angle(&conforming) / DEGREE, fine.outcome, fine.residual, fine.iterations);
    assert_near(mean_angle(&full), mean_angle(&conforming), 0.5 * DEGREE);
    assert_true(fabs(mean_angle(&single)) < 60 * DEGREE);
    clear_panel(&single);
    clear_panel(&full);
    clear_panel(&conforming);
}

// ------------------------------------------------------------------------------- hanging cloth

// Figure 9: a cloth of 1 m and 1 N, 12 x 12 squares, held by two opposite corners that came 12 % together; a
// crease along the line between them, `off` edges beside it: through the mesh's vertices where that is 0. It
// starts with both sides turned down by `angle`, as a whole by `turn`, and the crease sagging by what keeps
// its length: one that is 12 % too short buckles anyhow. All jumps are along one vector here, so that a cut
// of one freedom can follow. Of a cut beside a corner only the corner itself is held, not its virtual copy:
// that is no material, and would hold the cloth beyond the crease by its extension.
static void make_hanging(ruga_crease_freedom freedom, double off, double stiffness, double angle, double turn,
                         panel* p) {
    const double aside = off / 12, apart = aside * sqrt(0.5);
    *p = (panel){.def = ruga_default_creased_def()};
    make_squares(12, 12, false, &p->c.mesh);
    for (int i = 0; i < 3 * p->c.mesh.vertex_count; i++) {
        p->c.mesh.position[i] /= 12;
    }
    add_line(&p->c.curves, freedom, -apart, apart, 1 - apart, 1 + apart);
    cut_panel(off == 0, stiffness, p);
    for (int k = 0; k < p->c.cut.piece_count; k++) {
        double middle[3];
        middle_of(&p->c, &p->c.cut.piece[k], middle);
        for (int i = 0; i < 3; i++) {
            int node = p->c.cut.piece[k].node[i];
            const double* from = p->c.raster.mesh.position + 3 * p->c.cut.source[node];
            // u along the crease, v across from it; w and z across in space, z up.
            double u = (from[0] + from[1]) / sqrt(2), v = (from[1] - from[0]) / sqrt(2) - aside;
            double side = middle[1] - middle[0] > aside * sqrt(2) ? 1 : -1;
            double w = v * cos(angle) + aside, z = -side * v * sin(angle);
            double along = sqrt(0.5) + 0.88 * (u - sqrt(0.5)), across = w * cos(turn) + z * sin(turn);
            p->x[3 * node] = (along - across) / sqrt(2);
            p->x[3 * node + 1] = (along + across) / sqrt(2);
            p->x[3 * node + 2] = z * cos(turn) - w * sin(turn) - 0.3 * sin(RUGA_PI * u / sqrt(2));
            p->fixed[node] = node < p->c.cut.real_count && (fabs(u) < 1e-9 || fabs(u - sqrt(2)) < 1e-9);
        }
    }
    p->def.raster = &p->c.raster;
    p->def.cut = &p->c.cut;
    p->def.skin =
        (ruga_skin_def){.thickness = 0.01, .young = 12 * 0.91 * 1e-3 / 1e-6, .poisson = 0.3, .density = 10.2};
    p->def.stiffness = p->stiffness;
    p->def.fixed = p->fixed;
    p->def.gravity[2] = -9.81;
    p->def.tolerance = 1e-8;
    p->def.iterations = 1000;
}

static double corner_distance(const panel* p) {
    const double* corner[2] = {p->x + 3 * 12, p->x + 3 * (13 * 12)};
    return ruga_distance(corner[0], corner[1]);
}

// Least and largest angle along the crease, either way, rad.
static void find_kink(const panel* p, double* least, double* most) {
    *least = INFINITY;
    *most = 0;
    for (int s = 0; s < p->c.cut.segment_count; s++) {
        double angle = fabs(ruga_creased_angles(p->creased)[s]);
        *least = p->c.cut.segment[s].curve >= 0 ? fmin(*least, angle) : *least;
        *most = p->c.cut.segment[s].curve >= 0 ? fmax(*most, angle) : *most;
    }
}

static double energy_of(const ruga_creased_report* r) {
    return r->membrane + r->bending + r->hinge + r->external;
}

typedef struct hanging {
    double corners, energy, least, most; // m, J, rad
} hanging;

static hanging settle(panel* p, const char* name) {
    ruga_creased_report report;
    hanging h;
    assert_ok(ruga_creased_create(&p->def, &p->creased));
    assert_ok(ruga_creased_settle(p->creased, p->rest, p->x, &report));
    find_kink(p, &h.least, &h.most);
    h.corners = corner_distance(p);
    h.energy = energy_of(&report);
    print_message("%s, k = %.3g N: corners %.4f m, energy %.5f J, outcome %d, %d iterations, kink %.1f to "
                  "%.1f degrees\n",
                  name, p->stiffness[0], h.corners, h.energy, report.outcome, report.iterations,
                  h.least / DEGREE, h.most / DEGREE);
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    return h;
}

// D l / (A1 + A2) of the conforming mesh: a crease as stiff as the cloth across it.
static const double LIKE_CLOTH = 1e-3 * 0.70710678118654752 / 12 / (0.5 / 144);
static const double OPEN[2] = {35 * DEGREE, 0}, DRAPED[2] = {85 * DEGREE, 90 * DEGREE}; // angle, turn

// Both from the same start.
static void hanging_cloth_is_that_of_a_conforming_mesh(void** state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        const double *start = k < 2 ? OPEN : DRAPED, stiffness = k % 2 * LIKE_CLOTH;
        panel p, q;
        make_hanging(RUGA_FREEDOM_SINGLE, 0, stiffness, start[0], start[1], &p);
        make_conforming(&p, &q);
        hanging h = settle(&p, "shared"), fine = settle(&q, "conforming");
        // From the open start it is folded in part, and the angle varies along the crease. Folded over
        // without stiffness, corners meet.
        assert_true(k > 1 || h.most > 2 * h.least);
        assert_true(k != 2 || (h.corners < 1e-9 && fine.corners < 1e-9));
        assert_near(h.corners, fine.corners, k == 2 ? 1e-9 : 0.02 * fine.corners);
        assert_near(h.energy, fine.energy, 0.01 * fabs(fine.energy));
        clear_panel(&p);
        clear_panel(&q);
    }
}

// Draped over the line between the corners. A cut of one freedom folds over evenly, free or a tenth as stiff
// as the cloth. (As stiff as the cloth it lies at 110 to 180 degrees, where a jump of 2 d sin(angle / 2)
// hardly tells angles apart: what the cloth stretches makes ratios of 1.2 to 1.6 of them.) With auxiliary
// chords a crease like the cloth is folded in part and must turn as that of the conforming mesh from the same
// start does.
static void a_crease_of_one_freedom_folds_evenly_and_others_as_they_must(void** state) {
    (void)state;
    const double off[] = {0.05, 0.13, 0.25, 0.37, 0.5};
    for (int k = 0; k < 5; k++) {
        panel p, q;
        print_message("%.2f edges off\n", off[k]);
        for (int stiff = 0; stiff < 2; stiff++) {
            make_hanging(RUGA_FREEDOM_SINGLE, off[k], stiff * LIKE_CLOTH / 10, DRAPED[0], DRAPED[1], &p);
            hanging h = settle(&p, "single");
            assert_true(h.most < 1.4 * h.least && h.least > 150 * DEGREE);
            clear_panel(&p);
        }
        make_hanging(RUGA_FREEDOM_FULL, off[k], LIKE_CLOTH, DRAPED[0], DRAPED[1], &p);
        make_conforming(&p, &q);
        hanging h = settle(&p, "full"), fine = settle(&q, "conforming");
        assert_true(h.most > 2 * h.least && h.least < 90 * DEGREE);
        assert_near(h.most / h.least, fine.most / fine.least, 0.1 * fine.most / fine.least);
        assert_near(h.corners, fine.corners, 0.03 * fine.corners);
        assert_near(h.energy, fine.energy, 0.01 * fabs(fine.energy));
        clear_panel(&p);
        clear_panel(&q);
    }
}

// ------------------------------------------------------------------------------- Miura-ori

static void miura_folds_from_flat_by_its_rest_angles(void** state) {
    (void)state;
    const double theta = 50 * DEGREE;
    const int held[2] = {1, 1};
    panel p = {.def = ruga_default_creased_def()};
    const ruga_raster_def raster = ruga_default_raster_def();
    miura_make(12, &p.c);
    assert_ok(ruga_raster_create(&p.c.mesh, &p.c.curves, &raster, &p.c.raster));
    assert_ok(ruga_cut_create(&p.c.raster, &p.c.cut));
    int nodes = p.c.cut.node_count, segments = p.c.cut.segment_count;
    p.x = malloc((size_t)nodes * 3 * sizeof *p.x);
    p.fixed = calloc((size_t)nodes, sizeof *p.fixed);
    p.stiffness = malloc((size_t)segments * sizeof *p.stiffness);
    p.rest = calloc((size_t)segments, sizeof *p.rest);
    // What the closed form says, where each node is, and the angles there.
    double *wanted = malloc((size_t)nodes * 3 * sizeof *wanted),
           *target = malloc((size_t)segments * sizeof *target);
    double from[4][3], to[4][3];
    miura_panel_frame(held, theta, from);
    miura_panel_frame(held, 0, to);
    for (int k = 0; k < p.c.cut.piece_count; k++) {
        int own[2];
        double middle[3];
        middle_of(&p.c, &p.c.cut.piece[k], middle);
        miura_find_panel(middle, own);
        for (int i = 0; i < 3; i++) {
            int m = p.c.cut.piece[k].node[i];
            double y[3], d[3];
            miura_fold_point(own, theta, p.c.raster.mesh.position + 3 * p.c.cut.source[m], y);
            ruga_subtract(y, from[0], d);
            memcpy(wanted + 3 * m, to[0], 3 * sizeof *wanted);
            for (int a = 1; a < 4; a++) {
                ruga_add_scaled(ruga_dot(d, from[a]), to[a], wanted + 3 * m);
            }
            p.fixed[m] = p.fixed[m] || (own[0] == held[0] && own[1] == held[1]);
        }
    }
    ruga_hinge* hinge = malloc((size_t)segments * sizeof *hinge);
    ruga_hinges_make(&p.c.raster, &p.c.cut, hinge);
    for (int s = 0; s < segments; s++) {
        p.stiffness[s] = 1;
        target[s] = ruga_hinge_measure(&hinge[s], wanted, NULL, NULL);
    }
    p.def.raster = &p.c.raster;
    p.def.cut = &p.c.cut;
    p.def.stiffness = p.stiffness;
    p.def.fixed = p.fixed;
    p.def.skin = (ruga_skin_def){.thickness = 0.01, .young = 1e9, .poisson = 0.3, .density = 1};
    p.def.tolerance = 5e-6; // of 1e-8 E h: no forces are left in the end
    assert_ok(ruga_creased_create(&p.def, &p.creased));
    ruga_cut_rest(&p.c.raster, &p.c.cut, p.x);
    ruga_creased_report report = {0};
    int iterations = 0;
    for (int step = 1; step <= 10; step++) {
        for (int s = 0; s < segments; s++) {
            p.rest[s] = target[s] * step / 10;
        }
        assert_ok(ruga_creased_solve(p.creased, p.rest, p.x, &report));
        iterations += report.iterations;
    }
    double worst = 0, angle = 0;
    for (int m = 0; m < nodes; m++) {
        worst = fmax(worst, ruga_distance(p.x + 3 * m, wanted + 3 * m));
    }
    for (int s = 0; s < segments; s++) {
        angle = fmax(angle, fabs(ruga_creased_angles(p.creased)[s] - target[s]));
    }
    print_message(
        "outcome %d, residual %.2g, %d iterations in all, gap %.2g, hinge %.2g J, position error %.2g, angle "
        "error %.2g\n",
        report.outcome, report.residual, iterations, report.gap, report.hinge, worst, angle);
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    assert_true(worst < 1e-8);
    assert_true(report.gap < 1e-12);
    free(wanted);
    free(target);
    free(hinge);
    clear_panel(&p);
}

static int vertex_at(const crease_case* c, int i, int j) {
    double x[3], nearest = INFINITY;
    int best = -1;
    miura_vertex(i, j, 0, x);
    for (int v = 0; v < c->raster.mesh.vertex_count; v++) {
        double d = ruga_distance(x, c->raster.mesh.position + 3 * v);
        best = d < nearest ? v : best;
        nearest = fmin(d, nearest);
    }
    assert_near(nearest, 0, 1e-14);
    return best;
}

// L and S of half a cell in closed form, by the corners that are two cells apart.
static void miura_cell(double theta, double* l, double* s) {
    double a[3], b[3], d[3];
    miura_vertex(0, 0, theta, a);
    miura_vertex(0, 2, theta, b);
    miura_vertex(2, 0, theta, d);
    *l = ruga_distance(a, b) / 2;
    *s = ruga_distance(a, d) / 2;
}

// Two corners are brought together along L; free hinges. S follows, and with it the Poisson ratio.
static void miura_narrows_as_it_is_compressed(void** state) {
    (void)state;
    panel p = {.def = ruga_default_creased_def()};
    const ruga_raster_def raster = ruga_default_raster_def();
    miura_make(10, &p.c);
    assert_ok(ruga_raster_create(&p.c.mesh, &p.c.curves, &raster, &p.c.raster));
    assert_ok(ruga_cut_create(&p.c.raster, &p.c.cut));
    int nodes = p.c.cut.node_count, a = vertex_at(&p.c, 1, 1), b = vertex_at(&p.c, 1, 3),
        d = vertex_at(&p.c, 3, 1);
    p.x = malloc((size_t)nodes * 3 * sizeof *p.x);
    p.fixed = calloc((size_t)nodes, sizeof *p.fixed);
    p.stiffness = calloc((size_t)p.c.cut.segment_count, sizeof *p.stiffness);
    p.rest = calloc((size_t)p.c.cut.segment_count, sizeof *p.rest);
    p.fixed[a] = p.fixed[b] = true;
    double* inverse = malloc((size_t)nodes * sizeof *inverse);
    for (int n = 0; n < nodes; n++) {
        inverse[n] = p.fixed[n] ? 0 : 1;
    }
    for (int k = 0; k < p.c.cut.piece_count; k++) {
        int own[2];
        double middle[3];
        middle_of(&p.c, &p.c.cut.piece[k], middle);
        miura_find_panel(middle, own);
        for (int i = 0; i < 3; i++) {
            int n = p.c.cut.piece[k].node[i];
            miura_fold_point(own, 30 * DEGREE, p.c.raster.mesh.position + 3 * p.c.cut.source[n], p.x + 3 * n);
        }
    }
    p.def.raster = &p.c.raster;
    p.def.cut = &p.c.cut;
    p.def.stiffness = p.stiffness;
    p.def.fixed = p.fixed;
    p.def.skin = (ruga_skin_def){.thickness = 0.02, .young = 1e9, .poisson = 0.3, .density = 1};
    p.def.tolerance = 1e-6; // of 1e-8 E h: it is a mechanism, no forces are left
    ruga_sewing sewing;
    ruga_stitch* stitch;
    assert_ok(ruga_sewing_create(&p.c.cut, p.fixed, &sewing));
    assert_ok(ruga_stitch_create(&sewing, inverse, &stitch));
    assert_ok(ruga_creased_create(&p.def, &p.creased));
    double worst = 0, before[2] = {0, 0}, known[2] = {0, 0}, worst_ratio = 0;
    for (int degrees = 30; degrees <= 45; degrees++) {
        double l, s, along[3];
        ruga_creased_report report;
        miura_cell(degrees * DEGREE, &l, &s);
        ruga_subtract(p.x + 3 * b, p.x + 3 * a, along);
        ruga_normalize(along);
        memcpy(p.x + 3 * b, p.x + 3 * a, 3 * sizeof *p.x);
        ruga_add_scaled(2 * l, along, p.x + 3 * b);
        assert_ok(ruga_stitch_close(stitch, p.x));
        assert_ok(ruga_creased_solve(p.creased, p.rest, p.x, &report));
        double measured = ruga_distance(p.x + 3 * a, p.x + 3 * d) / 2;
        worst = fmax(worst, fabs(measured - s));
        if (degrees > 30) { // (dS/S) / (dL/L), of which the Poisson ratio is minus the inverse
            double ratio = log(measured / before[0]) / log(l / before[1]),
                   exact = log(s / known[0]) / log(l / known[1]);
            worst_ratio = fmax(worst_ratio, fabs(ratio / exact - 1));
        }
        before[0] = measured;
        known[0] = s;
        before[1] = known[1] = l;
    }
    print_message("S(L) from 30 to 45 degrees: error %.2g of a side, slopes %.2g\n", worst, worst_ratio);
    assert_true(worst < 1e-6);
    assert_true(worst_ratio < 1e-4);
    ruga_stitch_destroy(&stitch);
    ruga_sewing_clear(&sewing);
    free(inverse);
    clear_panel(&p);
}

static void every_failed_allocation_is_a_status(void** state) {
    (void)state;
    panel p;
    make_panel(RUGA_FREEDOM_FULL, 3.4, 5000, &p);
    for (int k = 0;; k++) {
        let_allocations_fail_after(k);
        ruga_status status = ruga_creased_create(&p.def, &p.creased);
        ruga_creased_destroy(&p.creased);
        ruga_set_allocator(NULL, NULL, NULL);
        if (status == RUGA_OK) {
            break;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
    }
    clear_panel(&p);
}

// The skin's solve (solver/skin.c) on the same cut: a crease whose rest angle varies along it, so that panels
// bend. What differs by itself is that its hinges of whole edges follow the thickness of a strained skin,
// here by strains of 1e-4.
static void the_skin_s_solve_finds_the_same_state(void** state) {
    (void)state;
    panel p = {.def = ruga_default_creased_def()};
    const double line[6] = {3.4, 0, 0, 3.4, 4, 0}, rest[2] = {0.2, 0.6};
    ruga_crease_def crease = ruga_default_crease_def();
    ruga_model_def def = ruga_default_model_def();
    ruga_handle_def handle = ruga_default_handle_def();
    ruga_model* model = NULL;
    ruga_state* one = NULL;
    ruga_report report;
    make_squares(8, 4, true, &p.c.mesh);
    def.mesh = ruga_mesh_as_def(&p.c.mesh);
    def.has_interior = false;
    def.skin.thickness = 0.05;
    def.skin.young = 1e9;
    def.solver.tolerance = 1e-9;
    crease.points = line;
    crease.point_count = 2;
    crease.point_rest = rest;
    crease.stiffness = 20000;
    def.crease_count = def.handle_count = 1;
    def.creases = &crease;
    def.handles = &handle;
    handle.region.kind = RUGA_REGION_BOX;
    handle.region.max[0] = 1;
    handle.region.max[1] = 4;
    assert_ok(ruga_model_create(&def, &model));
    assert_ok(ruga_state_create(model, &one));
    assert_ok(ruga_state_step(model, one, &report));
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    const ruga_creases* c = model->creases;
    int nodes = c->cut.node_count, segments = c->cut.segment_count;
    p.x = scene_copy(3 * nodes, model->mesh.position);
    p.stiffness = scene_array(segments);
    p.rest = scene_array(segments);
    p.fixed = calloc((size_t)nodes, sizeof *p.fixed);
    for (int h = 0; h < c->segment_count; h++) {
        p.stiffness[c->segment[h]] = c->stiffness[h];
    }
    for (int n = 0; n < nodes; n++) {
        p.fixed[n] = model->skin_handle[3 * n] >= 0;
    }
    p.def.raster = &c->raster;
    p.def.cut = &c->cut;
    p.def.skin = def.skin;
    p.def.stiffness = p.stiffness;
    p.def.fixed = p.fixed;
    ruga_creased_report own;
    assert_ok(ruga_creased_create(&p.def, &p.creased));
    for (int part = 1; part <= 4; part++) {
        for (int h = 0; h < c->segment_count; h++) {
            p.rest[c->segment[h]] = c->rest[h] * part / 4;
        }
        assert_ok(ruga_creased_solve(p.creased, p.rest, p.x, &own));
    }
    assert_int_equal(own.outcome, RUGA_OUTCOME_MINIMUM);
    double away = 0, moved = 0;
    for (int n = 0; n < nodes; n++) {
        away = fmax(away, ruga_distance(p.x + 3 * n, one->x + 3 * n));
        moved = fmax(moved, ruga_distance(model->mesh.position + 3 * n, one->x + 3 * n));
    }
    print_message("apart by %.2g of %.2g m; energies %.8g %.8g, %.8g %.8g, %.8g %.8g\n", away, moved,
                  own.membrane, report.energy_membrane, own.bending, report.energy_bending, own.hinge,
                  report.energy_hinge);
    assert_true(moved > 1 && away < 1e-4 * moved);
    assert_near(report.energy_hinge, own.hinge, 1e-4 * own.hinge);
    ruga_state_destroy(&one);
    ruga_model_destroy(&model);
    clear_panel(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_free_hinge_hangs_straight_down),
        cmocka_unit_test(a_spring_hinge_balances_the_weight_of_a_stiff_panel),
        cmocka_unit_test(the_skin_s_solve_finds_the_same_state),
        cmocka_unit_test(a_solution_is_kept),
        cmocka_unit_test(projecting_after_the_step_would_leave_the_solution),
        cmocka_unit_test(a_kinked_crease_locks_but_for_auxiliary_chords),
        cmocka_unit_test(hanging_cloth_is_that_of_a_conforming_mesh),
        cmocka_unit_test(a_crease_of_one_freedom_folds_evenly_and_others_as_they_must),
        cmocka_unit_test(miura_folds_from_flat_by_its_rest_angles),
        cmocka_unit_test(miura_narrows_as_it_is_compressed),
        cmocka_unit_test(every_failed_allocation_is_a_status),
    };
    return cmocka_run_group_tests_name("creased", tests, NULL, check_no_leak);
}
