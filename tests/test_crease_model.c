// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Creases in a model: cut, sewn and hinged within the skin's one static solve.
#include "tests/check.h"

#include "core/memory.h"
#include "tests/small_scene.h"

#define DEGREE (RUGA_PI / 180)

// A line across the sheet, off the mesh's vertices, and one along it.
static const double across[6] = {0.0131, -1, 0, 0.0131, 1, 0};
static const double along[6] = {-1, 0.0117, 0, 1, 0.0117, 0};

static ruga_crease_def crease_line(const double* points, double stiffness) {
    ruga_crease_def crease = ruga_default_crease_def();
    crease.points = points;
    crease.point_count = 2;
    crease.stiffness = stiffness;
    crease.rest = NAN;
    return crease;
}

// Paper of 20 x 10 cm without an interior.
static void make_paper(small_scene* s, int count, const ruga_crease_def* creases) {
    *s = (small_scene){.length = 0};
    scene_mesh(s, RUGA_SHAPE_SHEET, 0.2, 0.1, 0, 0.012);
    s->def.has_interior = false;
    s->def.skin.thickness = 0.3e-3;
    s->def.skin.young = 1e9;
    s->def.crease_count = count;
    s->def.creases = creases;
}

static void hold_box(ruga_handle_def* handle, double x0, double x1) {
    handle->region.kind = RUGA_REGION_BOX;
    const double min[3] = {x0, -1, -1}, max[3] = {x1, 1, 1};
    memcpy(handle->region.min, min, sizeof min);
    memcpy(handle->region.max, max, sizeof max);
}

// Least and largest angle over the segments.
static void angle_range(const small_scene* s, double range[2]) {
    const double* angle = ruga_state_crease_angles(s->state);
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int h = 0; h < s->model->creases->segment_count; h++) {
        range[0] = fmin(range[0], angle[h]);
        range[1] = fmax(range[1], angle[h]);
    }
}

static double skin_energy(small_scene* s, const double* x, double* gradient) {
    ruga_skin_terms terms;
    assert_ok(ruga_skin_energy(s->state->skin, x, &terms, gradient));
    return terms.total;
}

// ---- derivatives ---------------------------------------------------------------------------------------

// Energy to gradient and gradient to Hessian along a direction, by centred differences of two widths.
static void check_derivatives(small_scene* s, double* x, double size) {
    ruga_skin* skin = s->state->skin;
    int n = skin->n;
    double *d = scene_array(n), *at = scene_array(n), *g = scene_array(n), *image = scene_array(n);
    double *plus = scene_array(n), *minus = scene_array(n), off[2][2];
    scene_disturb(n, size, 11, d);
    ruga_skin_follow(skin, x);
    (void)skin_energy(s, x, g);
    assert_ok(ruga_skin_assemble(skin, x, 0));
    ruga_skin_apply(skin, d, image);
    for (int k = 0; k < 2; k++) {
        double h = k ? 0.05 : 0.1, e[2], worst = 0, largest = 0;
        for (int sign = 0; sign < 2; sign++) {
            for (int i = 0; i < n; i++) {
                at[i] = x[i] + (sign ? -h : h) * d[i];
            }
            e[sign] = skin_energy(s, at, sign ? minus : plus);
        }
        off[k][0] =
            fabs((e[0] - e[1]) / (2 * h) - ruga_dot_product(n, g, d)) / fabs(ruga_dot_product(n, g, d));
        for (int i = 0; i < n; i++) {
            worst = fmax(worst, fabs((plus[i] - minus[i]) / (2 * h) - image[i]));
            largest = fmax(largest, fabs(image[i]));
        }
        off[k][1] = worst / largest;
    }
    print_message("gradient off by %.2g, %.2g, Hessian by %.2g, %.2g\n", off[0][0], off[1][0], off[0][1],
                  off[1][1]);
    for (int what = 0; what < 2; what++) {
        assert_true(off[1][what] < 1e-3);
        assert_true(off[1][what] < 1e-9 ||
                    (off[0][what] / off[1][what] > 3.5 && off[0][what] / off[1][what] < 4.5));
    }
    free(d);
    free(at);
    free(g);
    free(image);
    free(plus);
    free(minus);
}

static void derivatives_are_right_with_creases_pressure_and_gravity(void** state) {
    (void)state;
    small_scene s;
    const ruga_crease_def creases[2] = {crease_line(across, 0.5), crease_line(along, 0.3)};
    make_paper(&s, 2, creases);
    s.def.skin.motion = RUGA_SKIN_DAMPED; // a static one that nothing holds has no equilibrium
    s.def.gravity[2] = -9.81;
    s.handle[0].kind = RUGA_HANDLE_PRESS;
    s.handle[0].pressure = 3000;
    s.handle[1].kind = RUGA_HANDLE_FORCE;
    s.handle[1].force[1] = 2;
    hold_box(&s.handle[1], 0, 1);
    s.def.handle_count = 2;
    scene_build(&s);
    double* x = scene_copy(s.state->skin->n, s.state->x);
    scene_disturb(s.state->skin->n, 1e-3, 5, x);
    check_derivatives(&s, x, 1e-4);
    free(x);
    scene_free(&s);
}

static void derivatives_are_right_on_a_foundation(void** state) {
    (void)state;
    small_scene s;
    const double line[6] = {0.0071, -1, 0, 0.0071, 1, 0};
    const ruga_crease_def crease = crease_line(line, 0.1);
    scene_sheet(&s, 2, 1, 8, 0);
    s.def.crease_count = 1;
    s.def.creases = &crease;
    scene_build(&s);
    double* x = scene_copy(s.state->skin->n, s.state->x);
    scene_disturb(s.state->skin->n, 2e-4, 5, x);
    check_derivatives(&s, x, 2e-5);
    free(x);
    scene_free(&s);
}

// ---- a cut changes nothing -----------------------------------------------------------------------------

// Mass, areas, loads and the energy of stretches are those of the sheet that was not cut. Membrane fractions
// have a least value, hence its tolerance.
static void a_cut_changes_neither_mass_nor_loads_nor_stiffness(void** state) {
    (void)state;
    small_scene s[2];
    const ruga_crease_def creases[2] = {crease_line(across, 0), crease_line(along, 0)};
    double mass[2] = {0}, area[2] = {0}, energy[2], external[2], force[2][3] = {{0}}, lever[2] = {0};
    for (int k = 0; k < 2; k++) {
        make_paper(&s[k], k ? 2 : 0, creases);
        s[k].def.skin.motion = RUGA_SKIN_DAMPED; // a static one that nothing holds has no equilibrium
        s[k].handle[0].kind = RUGA_HANDLE_PRESS;
        s[k].handle[0].pressure = 700;
        s[k].def.handle_count = 1;
        scene_build(&s[k]);
        ruga_skin* skin = s[k].state->skin;
        ruga_skin_terms terms;
        double *x = scene_copy(skin->n, s[k].state->x), *g = scene_array(skin->n);
        for (int i = 0; i < skin->n; i += 3) {
            mass[k] += skin->mass[i / 3];
            area[k] += s[k].model->vertex_area[i / 3];
            x[i] *= 1.02;
            x[i + 1] *= 0.99;
        }
        assert_ok(ruga_skin_energy(skin, x, &terms, NULL));
        energy[k] = terms.membrane;
        external[k] = terms.external;
        assert_ok(ruga_loads_energy(s[k].model->loads, x, 0, &terms.external, g, NULL, NULL, NULL));
        for (int i = 0; i < skin->n; i++) {
            force[k][i % 3] -= g[i];
            lever[k] -= i % 3 == 2 ? x[i - 2] * g[i] : 0;
        }
        assert_near(terms.external, external[k], 1e-15);
        free(x);
        free(g);
    }
    assert_true(s[1].model->mesh.vertex_count > s[0].model->mesh.vertex_count);
    assert_near(mass[1], mass[0], 1e-14 * mass[0]);
    assert_near(area[1], area[0], 1e-13 * area[0]);
    assert_near(energy[1], energy[0], 5e-4 * energy[0]);
    assert_near(external[1], external[0], 1e-15);
    assert_near(force[1][2], force[0][2], 1e-12 * fabs(force[0][2]));
    assert_near(lever[1], lever[0], 1e-12 * fabs(force[0][2]));
    scene_free(&s[0]);
    scene_free(&s[1]);
}

// A thickness that varies goes through the cutting: linear fields stay linear, and the mass is what it was.
static void a_skin_that_varies_may_be_creased(void** state) {
    (void)state;
    small_scene s[2];
    const ruga_crease_def creases[2] = {crease_line(across, 0), crease_line(along, 0)};
    double mass[2] = {0}, *thickness = NULL, *growth = NULL, *shown;
    for (int k = 0; k < 2; k++) {
        make_paper(&s[k], k ? 2 : 0, creases);
        int vertices = s[k].mesh.vertex_count;
        thickness = scene_array(vertices);
        growth = scene_array(2 * vertices);
        for (int v = 0; v < vertices; v++) {
            thickness[v] = 1e-3 + 2e-3 * s[k].mesh.position[3 * v];
            growth[2 * v] = 1 + 0.1 * s[k].mesh.position[3 * v + 1];
            growth[2 * v + 1] = 1;
        }
        s[k].def.skin.vertex_count = vertices;
        s[k].def.skin.vertex_thickness = thickness;
        s[k].def.skin.vertex_growth = growth;
        scene_build(&s[k]);
        for (int n = 0; n < s[k].model->mesh.vertex_count; n++) {
            const double* x = s[k].model->mesh.position + 3 * n;
            mass[k] += s[k].state->skin->mass[n];
            assert_near(s[k].model->variation.thickness[n], 1e-3 + 2e-3 * x[0], 1e-15);
            assert_near(s[k].model->variation.growth[2 * n], 1 + 0.1 * x[1], 1e-13);
        }
        free(thickness);
        free(growth);
    }
    assert_near(mass[1], mass[0],
                1e-4 * mass[0]); // triangles have the mean of their corners, and vertices moved
    assert_ok(ruga_variation_show(s[1].model, s[1].model->variation.thickness, 1, &shown));
    const ruga_mesh* mesh = ruga_model_shown(s[1].model);
    for (int v = 0; v < mesh->vertex_count; v++) {
        assert_near(shown[v], 1e-3 + 2e-3 * mesh->position[3 * v], 1e-15);
    }
    ruga_release(shown);
    scene_free(&s[0]);
    scene_free(&s[1]);
}

// ---- folding -------------------------------------------------------------------------------------------

// So do hinges that are far stiffer than the paper: forces end at the round-off of their angles.
static void keyframes_fold_to_their_angle(void** state) {
    (void)state;
    const ruga_crease_key keys[2] = {{.time = 0}, {.time = 0.06, .angle = 120 * DEGREE}};
    const ruga_method methods[2] = {RUGA_METHOD_QUASI_NEWTON, RUGA_METHOD_NEWTON};
    for (int k = 0; k < 4; k++) {
        small_scene s;
        ruga_crease_def crease = crease_line(across, k < 2 ? 0.02 : 1e9);
        double range[2], most = 0;
        crease.key_count = 2;
        crease.keys = keys;
        make_paper(&s, 1, &crease);
        s.def.solver.method = methods[k % 2];
        scene_build(&s);
        for (int frame = 1; frame <= 3; frame++) {
            ruga_report report;
            assert_ok(ruga_state_step(s.model, s.state, &report));
            assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
            assert_int_equal(report.substeps, 4); // 40 degrees by at most 10
            angle_range(&s, range);
            assert_near(range[0], 40 * frame * DEGREE, 1e-6);
            assert_near(range[1], 40 * frame * DEGREE, 1e-6);
            most = fmax(most, ruga_state_gap(s.state));
        }
        print_message("gap of %.2g edges\n", most / s.model->mean_edge);
        assert_true(most < (k < 2 ? 1e-12 : 1e-10) * s.model->mean_edge);
        scene_free(&s);
    }
}

// Past 180 degrees, which only a followed angle can tell from -160.
// As near to the flat sheet as it goes: its middle is there, and the integral of X x^T about it is symmetric.
static void check_laid(const small_scene* s) {
    const ruga_mesh* rest = ruga_model_shown(s->model);
    const double* x = ruga_state_positions(s->state);
    double mean[3] = {0, 0, 0}, moment[9] = {0}, area = 0;
    for (int f = 0; f < rest->triangle_count; f++) { // edges' middles: exact for products of linear functions
        for (int i = 0; i < 3; i++) {
            int a = rest->triangle[3 * f + i], b = rest->triangle[3 * f + (i + 1) % 3];
            double n[3], part;
            ruga_triangle_normal(rest->position + 3 * rest->triangle[3 * f],
                                 rest->position + 3 * rest->triangle[3 * f + 1],
                                 rest->position + 3 * rest->triangle[3 * f + 2], n);
            area += part = ruga_norm(n) / 6;
            for (int k = 0; k < 9; k++) {
                double here = (rest->position[3 * a + k / 3] + rest->position[3 * b + k / 3]) / 2;
                double there = (x[3 * a + k % 3] + x[3 * b + k % 3]) / 2;
                moment[k] += part * here * there;
                mean[k % 3] +=
                    k < 3 ? part * (there - (rest->position[3 * a + k] + rest->position[3 * b + k]) / 2) : 0;
            }
        }
    }
    for (int k = 0; k < 3; k++) {
        assert_near(mean[k] / area, 0, 1e-12);
        assert_near(moment[3 * k + (k + 1) % 3], moment[3 * ((k + 1) % 3) + k], 1e-9 * moment[0]);
    }
    assert_true(moment[0] > 0 && moment[4] > 0);
}

// Half a fold is at rest, and then goes on to its whole; without stiffness it stays.
// A free crease leaves one mode without stiffness, whose curvature is round-off.
static void a_free_crease_rests_wherever_it_is(void** state) {
    (void)state;
    for (int k = 0; k < 24; k++) {
        small_scene s;
        ruga_report report;
        double range[2], fold = 0.1 + 0.035 * k;
        ruga_crease_def crease = crease_line(across, 0);
        crease.rest = -140 * DEGREE;
        make_paper(&s, 1, &crease);
        s.def.skin.young *= 1 + 0.37 * k;
        s.def.start.fold = fold;
        scene_build(&s);
        assert_ok(ruga_state_step(s.model, s.state, &report));
        assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
        angle_range(&s, range);
        assert_near(range[0], fold * -140 * DEGREE, 1e-6);
        assert_near(range[1], fold * -140 * DEGREE, 1e-6);
        scene_free(&s);
    }
}

static void a_sheet_may_start_folded(void** state) {
    (void)state;
    for (int stiff = 0; stiff < 2; stiff++) {
        small_scene s;
        ruga_report report;
        double range[2];
        ruga_crease_def crease = crease_line(across, stiff * 0.02);
        crease.rest = -140 * DEGREE;
        make_paper(&s, 1, &crease);
        s.def.start.fold = 0.5;
        scene_build(&s);
        assert_ok(ruga_state_measure(s.state, &report));
        assert_near(report.energy_membrane + report.energy_bending + report.energy_hinge, 0, 1e-20);
        angle_range(&s, range);
        assert_near(range[0], -70 * DEGREE, 1e-12);
        assert_near(range[1], -70 * DEGREE, 1e-12);
        check_laid(&s);
        assert_ok(ruga_state_step(s.model, s.state, &report));
        assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
        angle_range(&s, range);
        assert_near(range[0], (stiff ? -140 : -70) * DEGREE, 1e-6);
        assert_near(range[1], (stiff ? -140 : -70) * DEGREE, 1e-6);
        scene_free(&s);
    }
}

static void angles_are_followed_through_180_degrees(void** state) {
    (void)state;
    const ruga_crease_key keys[2] = {{.time = 0}, {.time = 0.02, .angle = 200 * DEGREE}};
    small_scene s;
    ruga_report report;
    ruga_crease_def crease = crease_line(across, 0.02);
    double range[2];
    crease.key_count = 2;
    crease.keys = keys;
    make_paper(&s, 1, &crease);
    scene_build(&s);
    assert_ok(ruga_state_step(s.model, s.state, &report));
    angle_range(&s, range);
    assert_near(range[0], 200 * DEGREE, 1e-6);
    assert_near(range[1], 200 * DEGREE, 1e-6);
    assert_true(report.energy_hinge < 1e-12);
    scene_free(&s);
}

// Rest angles along a crease, linear between its points: the panels bend, and the mean is right.
static void values_vary_along_a_crease(void** state) {
    (void)state;
    small_scene s;
    const double line[6] = {0.0131, -0.05, 0, 0.0131, 0.05, 0}, rest[2] = {10 * DEGREE, 30 * DEGREE};
    const double stiffness[2] = {1, 3};
    ruga_crease_def crease = crease_line(line, 0);
    crease.point_rest = rest;
    crease.point_stiffness = stiffness;
    make_paper(&s, 1, &crease);
    scene_build(&s);
    const ruga_creases* c = s.model->creases;
    assert_true(c->raster.facts[0].full);
    for (int h = 0; h < c->segment_count; h++) {
        const ruga_segment* segment = &c->cut.segment[c->segment[h]];
        const double* x = c->cut.material.position;
        double y = (x[3 * segment->end[0] + 1] + x[3 * segment->end[1] + 1]) / 2;
        assert_near(c->rest[h], (20 + 200 * y) * DEGREE, 1e-12);
        assert_near(c->stiffness[h], 2 + 20 * y, 1e-12);
    }
    ruga_report report;
    assert_ok(ruga_state_step(s.model, s.state, &report));
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    double range[2];
    angle_range(&s, range);
    assert_true(range[0] > 9 * DEGREE && range[1] < 31 * DEGREE && range[1] - range[0] > 5 * DEGREE);
    scene_free(&s);
}

// ---- handles -------------------------------------------------------------------------------------------

// The rim of a region is held on both sides of a crease that crosses it; a crease beyond a region can turn.
static void a_held_rim_is_held_on_both_sides_of_a_crease(void** state) {
    (void)state;
    small_scene s;
    ruga_report report;
    const ruga_crease_def creases[2] = {crease_line(across, 1e-4), crease_line(along, 1e-4)};
    make_paper(&s, 1, creases + 1);
    s.def.gravity[2] = -9.81;
    s.def.solver.tolerance = 1e-8; // forces balance as well as this says
    hold_box(&s.handle[0], -1, -0.0999);
    hold_box(&s.handle[1], 0.0999, 1);
    s.def.handle_count = 2;
    scene_build(&s);
    assert_ok(ruga_state_step(s.model, s.state, &report));
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    const ruga_mesh* shown = ruga_model_shown(s.model);
    const double* x = ruga_state_positions(s.state);
    int held = 0;
    for (int v = 0; v < shown->vertex_count; v++) {
        if (fabs(shown->position[3 * v]) > 0.0999) {
            held++;
            assert_near(ruga_distance(x + 3 * v, shown->position + 3 * v), 0, 1e-14);
        }
    }
    assert_true(held > 10);
    // Both hold half of the weight each, but for the mesh's asymmetry.
    double force[2][3], weight = 900 * 0.3e-3 * 0.02 * 9.81;
    assert_ok(ruga_state_handle_forces(s.state, force[0]));
    assert_near(force[0][2] + force[1][2], weight, 1e-4 * weight);
    assert_near(force[0][0] + force[1][0], 0, 1e-4 * weight);
    assert_true(force[0][2] > 0.4 * weight && force[1][2] > 0.4 * weight);
    scene_free(&s);

    make_paper(&s, 1, creases);
    s.def.gravity[2] = -9.81;
    s.def.solver.method = RUGA_METHOD_NEWTON;
    hold_box(&s.handle[0], -1, 0.0131); // up to the crease and no further
    s.def.handle_count = 1;
    scene_build(&s);
    for (int frame = 0; frame < 3; frame++) {
        assert_ok(ruga_state_step(s.model, s.state, &report));
    }
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    double range[2];
    angle_range(&s, range);
    print_message("a flap under its weight hangs by %.2f to %.2f degrees\n", range[0] / DEGREE,
                  range[1] / DEGREE);
    assert_true(range[1] < -60 * DEGREE && range[0] > -90.5 * DEGREE);
    scene_free(&s);
}

// A rigid flap: k L theta = M cos(theta). It turns by 40 degrees in one solve, and a straight step that
// stretches it by 1e-9 is too long already.
static void check_flap(ruga_method method, double young) {
    small_scene s;
    ruga_report report;
    double arm = 0.1 - 0.0131, moment = 900 * 0.3e-3 * 9.81 * 0.1 * arm * arm / 2, k = moment / 0.1;
    const ruga_crease_def crease = crease_line(across, k);
    make_paper(&s, 1, &crease);
    s.def.skin.young = young;
    s.def.solver.method = method;
    s.def.gravity[2] = -9.81;
    hold_box(&s.handle[0], -1, 0.0131);
    s.def.handle_count = 1;
    scene_build(&s);
    assert_ok(ruga_state_step(s.model, s.state, &report));
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    double theta = 0.7, range[2], force[3];
    for (int i = 0; i < 50; i++) {
        theta -= (theta - cos(theta)) / (1 + sin(theta));
    }
    angle_range(&s, range);
    print_message("flap of %g Pa: %.4f to %.4f degrees, rigid %.4f; %d iterations\n", young,
                  range[0] / DEGREE, range[1] / DEGREE, -theta / DEGREE, report.newton_iterations);
    // Quasi-newton takes 500 to 1,000, by the kernels of the BLAS.
    assert_true(report.newton_iterations < (method == RUGA_METHOD_NEWTON ? 60 : 1500));
    assert_near(range[0], -theta, 0.2 * DEGREE);
    assert_near(range[1], -theta, 0.2 * DEGREE);
    assert_ok(ruga_state_handle_forces(s.state, force));
    // What is held beyond the crease has weight too, which the handle carries.
    print_message("force off by %.1e of it\n", fabs(force[2] / (900 * 0.3e-3 * 0.02 * 9.81) - 1));
    assert_near(force[2], 900 * 0.3e-3 * 0.02 * 9.81, (young > 1e12 ? 1e-4 : 1e-5) * force[2]);
    scene_free(&s);
}

static void a_hinge_balances_the_weight_of_a_flap(void** state) {
    (void)state;
    const ruga_method methods[2] = {RUGA_METHOD_QUASI_NEWTON, RUGA_METHOD_NEWTON};
    for (int k = 0; k < 4; k++) {
        check_flap(methods[k % 2], k < 2 ? 1e11 : 1e13);
    }
}

// ---- plasticity ----------------------------------------------------------------------------------------

// A crease that is turned by rate-free yielding keeps what is beyond its yield angle, less what hardening
// takes.
static void a_crease_yields(void** state) {
    (void)state;
    small_scene s;
    ruga_report report;
    ruga_crease_def crease = crease_line(across, 0.02);
    make_paper(&s, 1, &crease);
    crease.yield = 20 * DEGREE;
    crease.hardening = 0.25;
    crease.rate = 30;
    // The far end is turned by 90 degrees about the crease, which is flat at rest.
    hold_box(&s.handle[0], -1, 0.0131);
    hold_box(&s.handle[1], 0.0131, 1);
    s.handle[1].kind = RUGA_HANDLE_MOVE;
    const double axis[3] = {0, -1, 0}, center[3] = {0.0131, 0, 0};
    memcpy(s.handle[1].rotate_axis, axis, sizeof axis);
    memcpy(s.handle[1].rotate_center, center, sizeof center);
    s.handle[1].rotate_angle = 90 * DEGREE;
    s.def.handle_count = 2;
    scene_build(&s);
    assert_ok(ruga_state_step(s.model, s.state, &report));
    double range[2];
    angle_range(&s, range);
    assert_near(range[0], 90 * DEGREE, 1e-6);
    assert_ok(ruga_state_step(s.model, s.state, &report));
    // e0 = 90 - 20 degrees over 20 ms
    double first = 70 * DEGREE * (1 - exp(-30 * 1.25 * 0.02)) / 1.25;
    assert_near(ruga_state_crease_rests(s.state)[0], first, 1e-6);
    assert_ok(ruga_state_step(s.model, s.state, &report));
    double excess = 90 * DEGREE - first - (20 * DEGREE + 0.25 * first);
    double second = first + excess * (1 - exp(-30 * 1.25 * 0.02)) / 1.25;
    assert_near(ruga_state_crease_rests(s.state)[0], second, 1e-6);
    for (int frame = 0; frame < 40; frame++) {
        assert_ok(ruga_state_step(s.model, s.state, &report));
    }
    assert_near(ruga_state_crease_rests(s.state)[0], 70 * DEGREE / 1.25, 1e-6);
    scene_free(&s);
}

// ---- restart, memory, refusals -------------------------------------------------------------------------

// Round-off of the positions is what is left of a gap, however many iterations a solve takes.
static void iterations_leave_no_gap(void** state) {
    (void)state;
    small_scene s;
    ruga_report report;
    const ruga_crease_key keys[2] = {{.time = 0}, {.time = 0.02, .angle = 100 * DEGREE}};
    ruga_crease_def creases[2] = {crease_line(across, 0.02), crease_line(along, 0.02)};
    for (int c = 0; c < 2; c++) {
        creases[c].key_count = 2;
        creases[c].keys = keys;
    }
    make_paper(&s, 2, creases);
    scene_build(&s);
    assert_ok(ruga_state_step(s.model, s.state, &report));
    assert_true(report.newton_iterations > 100);
    assert_true(ruga_state_gap(s.state) < 2 * 0x1p-52 * s.model->extent);
    scene_free(&s);
}

static void a_restarted_state_goes_on_with_the_same_bits(void** state) {
    (void)state;
    small_scene s;
    ruga_report report;
    const ruga_crease_key keys[2] = {{.time = 0}, {.time = 0.1, .angle = 100 * DEGREE}};
    ruga_crease_def creases[2] = {crease_line(across, 0.02), crease_line(along, 0.02)};
    creases[0].key_count = 2;
    creases[0].keys = keys;
    creases[0].yield = 1 * DEGREE;
    make_paper(&s, 2, creases);
    scene_build(&s);
    double* restart = scene_array(ruga_state_restart_size(s.model));
    ruga_state* other = NULL;
    assert_ok(ruga_state_create(s.model, &other));
    for (int frame = 0; frame < 2; frame++) {
        assert_ok(ruga_state_step(s.model, s.state, &report));
    }
    ruga_state_save(s.state, restart);
    assert_ok(ruga_state_load(other, restart));
    for (int frame = 0; frame < 2; frame++) {
        assert_ok(ruga_state_step(s.model, s.state, &report));
        assert_ok(ruga_state_step(s.model, other, &report));
    }
    assert_memory_equal(s.state->x, other->x, (size_t)s.state->skin->n * sizeof *other->x);
    assert_memory_equal(ruga_state_positions(s.state), ruga_state_positions(other),
                        3 * (size_t)ruga_model_vertex_count(s.model) * sizeof(double));
    ruga_state_destroy(&other);
    free(restart);
    scene_free(&s);
}

static void each_allocation_may_fail(void** state) {
    (void)state;
    const ruga_crease_def creases[2] = {crease_line(across, 0.02), crease_line(along, 0.02)};
    small_scene s = {.length = 0};
    int allowed = 0;
    scene_mesh(&s, RUGA_SHAPE_SHEET, 0.2, 0.1, 0, 0.05);
    s.def.has_interior = false;
    s.def.crease_count = 2;
    s.def.creases = creases;
    s.def.start.fold = 1;
    s.def.handle_count = 1;
    double* thickness = scene_array(s.mesh.vertex_count);
    for (int v = 0; v < s.mesh.vertex_count; v++) {
        thickness[v] = 1e-3 + 1e-5 * v;
    }
    s.def.skin.vertex_count = s.mesh.vertex_count;
    s.def.skin.vertex_thickness = thickness;
    for (int k = 0;; k++) {
        allowed = k;
        ruga_set_allocator(scene_allocate_while_allowed, scene_release_block, &allowed);
        ruga_status status = ruga_model_create(&s.def, &s.model);
        status = status == RUGA_OK ? ruga_state_create(s.model, &s.state) : status;
        scene_free_state(&s);
        ruga_set_allocator(NULL, NULL, NULL);
        if (status == RUGA_OK) {
            print_message("%d allocations\n", k);
            break;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
    }
    free(thickness);
    ruga_mesh_clear(&s.mesh);
}

static void what_creases_cannot_do_is_refused(void** state) {
    (void)state;
    const double beside[6] = {5, 5, 5, 6, 5, 5};
    ruga_model* model = NULL;
    for (int k = 0; k < 8; k++) {
        small_scene s;
        ruga_crease_def crease = crease_line(k == 0 ? beside : across, k == 1 ? -1 : 0);
        const ruga_crease_key keys[2] = {{.time = 1}, {.time = 1}};
        make_paper(&s, 1, &crease);
        crease.rest = k == 2 ? INFINITY : 0;
        crease.keys = keys;
        crease.key_count = k == 3 ? 2 : 0;
        crease.rate = k == 4 ? 0 : 1;
        crease.path = k == 5 ? RUGA_CREASE_GROUP : RUGA_CREASE_POLYLINE;
        s.def.skin.bending = k == 6 ? RUGA_BENDING_KIRCHHOFF_LOVE : RUGA_BENDING_HINGE;
        s.def.solver.method = k == 7 ? RUGA_METHOD_PAPER : RUGA_METHOD_DEFAULT;
        assert_int_equal(ruga_model_create(&s.def, &model), RUGA_BAD_INPUT);
        print_message("%s\n", ruga_last_error());
        assert_int_equal(strncmp(ruga_last_error(), "creases", 7), 0);
        scene_free(&s);
    }
}

// ---- cuts ----------------------------------------------------------------------------------------------

// Both halves of a sheet that is cut through move on their own.
static void a_cut_stays_open(void** state) {
    (void)state;
    small_scene s;
    ruga_report report;
    ruga_crease_def cut = crease_line(across, 0);
    cut.kind = RUGA_CREASE_CUT;
    make_paper(&s, 1, &cut);
    hold_box(&s.handle[0], -1, 0.0131);
    hold_box(&s.handle[1], 0.08, 1); // more than an edge, about which it could turn
    s.handle[1].kind = RUGA_HANDLE_MOVE;
    s.handle[1].translate[0] = 0.05;
    s.def.handle_count = 2;
    scene_build(&s);
    assert_int_equal(s.model->creases->segment_count, 0);
    assert_ok(ruga_state_step(s.model, s.state, &report));
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    assert_true(report.energy_membrane < 1e-12);
    double force[2][3];
    assert_ok(ruga_state_handle_forces(s.state, force[0]));
    assert_near(force[0][0], 0, 1e-6);
    scene_free(&s);
}

// A frame with a piece in it that nothing joins to the rest: both fold, and none drifts.
static void parts_that_are_cut_out_are_held_in_space(void** state) {
    (void)state;
    const double hole[12] = {-0.041, -0.022, 0, 0.043, -0.022, 0, 0.043, 0.023, 0, -0.041, 0.023, 0};
    ruga_crease_def creases[2] = {crease_line(hole, 0), crease_line(along, 0.02)};
    creases[0].kind = RUGA_CREASE_CUT;
    creases[0].point_count = 4;
    creases[0].closed = true;
    creases[1].rest = 30 * DEGREE;
    for (int held = 0; held < 2; held++) {
        small_scene s;
        ruga_report report;
        double range[2];
        make_paper(&s, 2, creases);
        hold_box(&s.handle[0], -1, -0.09);
        s.handle[0].axes[0] = s.handle[0].axes[1] = true;
        s.def.handle_count = 0;
        if (held) { // by one edge along x only, so that it can fold
            s.handle[0].region.min[1] = 0.04;
            s.def.handle_count = 1;
        }
        scene_build(&s);
        int components = 0; // six of each part that no handle holds
        for (int i = 0; i < 3 * s.model->mesh.vertex_count; i++) {
            components += s.model->skin_handle[i] == s.model->handle_count;
        }
        assert_int_equal(components, held ? 6 : 12);
        assert_ok(ruga_state_step(s.model, s.state, &report));
        assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
        angle_range(&s, range);
        assert_near(range[0], 30 * DEGREE, 1e-6);
        assert_near(range[1], 30 * DEGREE, 1e-6);
        scene_free(&s);
    }
}

// ---- with an interior ----------------------------------------------------------------------------------

// A crease that is free to turn on a compressed sheet: averages and seams hold at once, and it wrinkles on
// both sides.
static void clusters_and_seams_hold_at_once(void** state) {
    (void)state;
    small_scene s;
    ruga_report report;
    scene_sheet(&s, 6, 2, 10, 0);
    const double line[6] = {0.3e-3, -1, 0, 0.3e-3, 1, 0};
    const ruga_crease_def crease = crease_line(line, 0);
    s.def.crease_count = 1;
    s.def.creases = &crease;
    s.key[1].matrix[0] = 0.95;
    scene_build(&s);
    for (int frame = 0; frame < 1; frame++) {
        assert_ok(ruga_state_step(s.model, s.state, &report));
        assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    }
    assert_true(report.constraint_residual < 1e-12);
    assert_true(ruga_state_gap(s.state) < 1e-12 * s.model->mean_edge);
    double square[2] = {0}, count[2] = {0};
    const ruga_mesh* shown = ruga_model_shown(s.model);
    for (int v = 0; v < shown->vertex_count; v++) {
        double off = ruga_state_positions(s.state)[3 * v + 2] - ruga_state_embedded(s.state)[3 * v + 2];
        square[shown->position[3 * v] > line[0]] += off * off;
        count[shown->position[3 * v] > line[0]]++;
    }
    for (int side = 0; side < 2; side++) {
        print_message("side %d: rms height %.3g mm\n", side, 1e3 * sqrt(square[side] / count[side]));
        assert_true(sqrt(square[side] / count[side]) > 0.3 * s.model->skin.thickness);
    }
    scene_free(&s);
}

// Copies of a vertex share its weights: averages of any field on the sheet are those without a cut.
static void averages_are_shared_out_without_loss(void** state) {
    (void)state;
    small_scene s[2];
    double mean[2][3] = {{0}};
    scene_sheet(&s[0], 3, 2, 8, 0);
    scene_sheet(&s[1], 3, 2, 8, 0);
    const double line[6] = {0.3e-3, -1, 0, 0.3e-3, 1, 0};
    const ruga_crease_def crease = crease_line(line, 0);
    s[1].def.crease_count = 1;
    s[1].def.creases = &crease;
    for (int k = 0; k < 2; k++) {
        scene_build(&s[k]);
        const ruga_clusters* c = &s[k].model->clusters;
        double* y = scene_array(3 * c->count);
        ruga_clusters_apply(c, s[k].model->mesh.position, y);
        for (int r = 0; r < s[k].model->seam; r++) {
            double sum = 0;
            for (int i = c->start[r]; i < c->start[r + 1]; i++) {
                sum += c->weight[i];
            }
            assert_near(sum, 1, 1e-13);
            mean[k][0] += y[3 * r];
        }
        for (int r = 3 * s[k].model->seam; r < 3 * c->count; r++) {
            assert_near(y[r], 0, 1e-15);
        }
        free(y);
    }
    assert_int_equal(s[0].model->seam, s[1].model->seam);
    scene_free(&s[0]);
    scene_free(&s[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_are_right_with_creases_pressure_and_gravity),
        cmocka_unit_test(derivatives_are_right_on_a_foundation),
        cmocka_unit_test(a_cut_changes_neither_mass_nor_loads_nor_stiffness),
        cmocka_unit_test(a_skin_that_varies_may_be_creased),
        cmocka_unit_test(keyframes_fold_to_their_angle),
        cmocka_unit_test(a_free_crease_rests_wherever_it_is),
        cmocka_unit_test(a_sheet_may_start_folded),
        cmocka_unit_test(angles_are_followed_through_180_degrees),
        cmocka_unit_test(values_vary_along_a_crease),
        cmocka_unit_test(a_held_rim_is_held_on_both_sides_of_a_crease),
        cmocka_unit_test(a_hinge_balances_the_weight_of_a_flap),
        cmocka_unit_test(a_crease_yields),
        cmocka_unit_test(iterations_leave_no_gap),
        cmocka_unit_test(a_restarted_state_goes_on_with_the_same_bits),
        cmocka_unit_test(each_allocation_may_fail),
        cmocka_unit_test(what_creases_cannot_do_is_refused),
        cmocka_unit_test(a_cut_stays_open),
        cmocka_unit_test(parts_that_are_cut_out_are_held_in_space),
        cmocka_unit_test(clusters_and_seams_hold_at_once),
        cmocka_unit_test(averages_are_shared_out_without_loss),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
