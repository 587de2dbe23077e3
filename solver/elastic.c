// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The energy of a cut shell, or springs (crease/cloth.h) in the place of membrane and bends:
//   E = sum over pieces f E_membrane + sum over bends k/2 (theta - theta_b)^2 + sum over hinges k/2 (theta -
//   theta0)^2,
// hinges being those of creases and, with the shell, of auxiliary chords. Damping is Kelvin and Voigt's: for
// each element with strain e(x), B = de/dx and stiffness k, the force -time B^T k B v.
//
// Elements first, then sums for each node in the order of its lists: the same bits for any number of threads.
#include "solver/elastic.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"
#include "shell/bending.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 256 };

void ruga_elastic_clear(ruga_elastic* e) {
    ruga_cloth_clear(&e->cloth);
    ruga_release(e->triangle);
    ruga_release(e->membrane);
    ruga_release(e->bend);
    ruga_release(e->bend_stiffness);
    ruga_release(e->bend_rest);
    ruga_release(e->hinge);
    ruga_release(e->segment);
    ruga_release(e->stiffness);
    ruga_release(e->rest);
    ruga_release(e->angle);
    ruga_gather_clear(&e->at_triangle);
    ruga_gather_clear(&e->at_bend);
    ruga_gather_clear(&e->at_hinge);
    ruga_release(e->triangle_force);
    ruga_release(e->bend_gradient);
    ruga_release(e->bend_moment);
    ruga_release(e->hinge_gradient);
    ruga_release(e->hinge_moment);
    ruga_release(e->partial);
    *e = (ruga_elastic){0};
}

// ------------------------------------------------------------------------------- set-up

static ruga_status make_triangles(ruga_elastic* e, const double* rest) {
    const ruga_cut* cut = e->def.cut;
    const ruga_skin_def* skin = &e->def.skin;
    const double growth[2] = {1, 1};
    e->triangle_count = cut->piece_count;
    RUGA_TRY(RUGA_NEW(e->triangle, e->triangle_count));
    RUGA_TRY(RUGA_NEW(e->membrane, e->triangle_count));
    RUGA_TRY(RUGA_NEW(e->triangle_force, e->triangle_count));
    for (int p = 0; p < cut->piece_count; p++) {
        const double* x[3];
        memcpy(e->triangle[p], cut->piece[p].node, sizeof e->triangle[p]);
        for (int i = 0; i < 3; i++) {
            x[i] = rest + 3 * (size_t)e->triangle[p][i];
        }
        double area = ruga_membrane_rest_create(x, skin->poisson, growth, skin->thickness, skin->young,
                                                &e->membrane[p]);
        if (!(area > 0)) {
            return ruga_fail(RUGA_BAD_MESH, "face %d near (%.6g, %.6g, %.6g) has no area",
                             cut->piece[p].triangle, x[0][0], x[0][1], x[0][2]);
        }
        e->membrane[p].stretch *= cut->piece[p].fraction;
        e->membrane[p].shear *= cut->piece[p].fraction;
    }
    return RUGA_OK;
}

// The four nodes of a bend, as ruga_hinge_angle wants them: both pieces share those of its edge.
static void set_bend(const ruga_hinge* hinge, int bend[4]) {
    for (int a = 0; a < RUGA_HINGE_NODES; a++) {
        for (int i = 0; i < 4; i++) {
            bend[i] = hinge->weight[i][a] != 0 ? hinge->node[a] : bend[i];
        }
    }
}

static double angle_of_bend(const int bend[4], const double* x) {
    const double* at[4];
    for (int i = 0; i < 4; i++) {
        at[i] = x + 3 * (size_t)bend[i];
    }
    return ruga_hinge_angle(at, NULL);
}

static ruga_status make_bends(ruga_elastic* e, double rigidity, const double* rest) {
    ruga_status status = RUGA_OK;
    const ruga_cut* cut = e->def.cut;
    ruga_hinge* hinge = NULL;
    double* chord = NULL;
    e->bend_count = cut->bend_count;
    RUGA_TRY_DONE(RUGA_NEW(hinge, e->bend_count));
    RUGA_TRY_DONE(RUGA_NEW(chord, cut->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(e->bend, e->bend_count));
    RUGA_TRY_DONE(RUGA_NEW(e->bend_stiffness, e->bend_count));
    RUGA_TRY_DONE(RUGA_NEW(e->bend_rest, e->bend_count));
    RUGA_TRY_DONE(RUGA_NEW(e->bend_gradient, e->bend_count));
    RUGA_TRY_DONE(RUGA_NEW(e->bend_moment, e->bend_count));
    ruga_bends_make(e->def.raster, cut, hinge);
    ruga_bend_stiffness(e->def.raster, cut, e->bend_stiffness, chord);
    for (int b = 0; b < e->bend_count; b++) {
        set_bend(&hinge[b], e->bend[b]);
        e->bend_stiffness[b] *= rigidity;
        e->bend_rest[b] = angle_of_bend(e->bend[b], rest);
    }
done:
    ruga_release(hinge);
    ruga_release(chord);
    return status;
}

static ruga_status make_hinges(ruga_elastic* e, double rigidity, bool chords, bool creases) {
    ruga_status status = RUGA_OK;
    const ruga_cut* cut = e->def.cut;
    ruga_hinge* all = NULL;
    double *bend = NULL, *chord = NULL;
    RUGA_TRY_DONE(RUGA_NEW(all, cut->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(bend, cut->bend_count));
    RUGA_TRY_DONE(RUGA_NEW(chord, cut->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(e->hinge, cut->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(e->segment, cut->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(e->stiffness, cut->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(e->hinge_gradient, cut->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(e->hinge_moment, cut->segment_count));
    ruga_hinges_make(e->def.raster, cut, all);
    ruga_bend_stiffness(e->def.raster, cut, bend, chord);
    for (int s = 0; s < cut->segment_count; s++) {
        bool crease = cut->segment[s].curve >= 0;
        double k = crease ? (e->def.stiffness ? e->def.stiffness[s] * cut->segment[s].length : 0)
                          : rigidity * chord[s];
        if (k > 0 && (crease ? creases : chords)) {
            e->hinge[e->hinge_count] = all[s];
            e->segment[e->hinge_count] = s;
            e->stiffness[e->hinge_count++] = k;
        }
    }
done:
    ruga_release(all);
    ruga_release(bend);
    ruga_release(chord);
    return status;
}

static ruga_status make_gathers(ruga_elastic* e) {
    ruga_status status = RUGA_OK;
    int* node = NULL;
    RUGA_TRY_DONE(RUGA_NEW(node, (size_t)e->hinge_count * RUGA_HINGE_NODES));
    for (int h = 0; h < e->hinge_count; h++) {
        memcpy(node + (size_t)h * RUGA_HINGE_NODES, e->hinge[h].node, sizeof e->hinge[h].node);
    }
    RUGA_TRY_DONE(ruga_gather_create(e->node_count, e->hinge_count * RUGA_HINGE_NODES, node, &e->at_hinge));
    RUGA_TRY_DONE(ruga_gather_create(e->node_count, 3 * e->triangle_count,
                                     e->triangle ? e->triangle[0] : NULL, &e->at_triangle));
    RUGA_TRY_DONE(
        ruga_gather_create(e->node_count, 4 * e->bend_count, e->bend ? e->bend[0] : NULL, &e->at_bend));
done:
    ruga_release(node);
    return status;
}

static ruga_status create_parts(ruga_elastic* e, const double* rest) {
    const ruga_elastic_def* def = &e->def;
    double h = def->skin.thickness;
    double rigidity = def->skin.young * h * h * h / (12 * (1 - def->skin.poisson * def->skin.poisson));
    bool springs = def->skin.model == RUGA_SKIN_SPRINGS;
    if (springs) {
        RUGA_TRY(ruga_cloth_add_sheet(&e->cloth, def->raster, def->cut, &def->skin));
    } else {
        RUGA_TRY(make_triangles(e, rest));
        RUGA_TRY(make_bends(e, rigidity, rest));
    }
    if (def->style != RUGA_CREASE_ANGLE && def->stiffness) {
        RUGA_TRY(ruga_cloth_add_creases(&e->cloth, def->raster, def->cut, def->style, def->stiffness));
    }
    RUGA_TRY(ruga_cloth_finish(&e->cloth, def->cut));
    RUGA_TRY(make_hinges(e, rigidity, !springs, def->style == RUGA_CREASE_ANGLE));
    RUGA_TRY(make_gathers(e));
    RUGA_TRY(RUGA_NEW_ZERO(e->rest, def->cut->segment_count));
    RUGA_TRY(RUGA_NEW_ZERO(e->angle, def->cut->segment_count));
    int most = e->triangle_count > e->bend_count ? e->triangle_count : e->bend_count;
    most = most > e->hinge_count ? most : e->hinge_count;
    RUGA_TRY(RUGA_NEW(e->partial, ruga_chunk_count(most, CHUNK)));
    ruga_elastic_start(e, rest);
    memcpy(e->rest, e->angle, (size_t)def->cut->segment_count * sizeof *e->rest);
    ruga_cloth_set_rest(&e->cloth, e->rest);
    return RUGA_OK;
}

ruga_status ruga_elastic_create(const ruga_elastic_def* def, ruga_elastic* e) {
    ruga_status status = RUGA_OK;
    double* rest = NULL;
    *e = (ruga_elastic){.def = *def, .node_count = def->cut->node_count};
    RUGA_TRY_DONE(RUGA_NEW(rest, 3 * (size_t)e->node_count));
    ruga_cut_rest(def->raster, def->cut, rest);
    RUGA_TRY_DONE(create_parts(e, rest));
    e->def.stiffness = NULL; // not kept
done:
    ruga_release(rest);
    if (status != RUGA_OK) {
        ruga_elastic_clear(e);
    }
    return status;
}

void ruga_elastic_set_rest(ruga_elastic* e, const double* rest) {
    for (int s = 0; s < e->def.cut->segment_count; s++) {
        e->rest[s] = e->def.cut->segment[s].curve >= 0 ? rest[s] : e->rest[s];
    }
    ruga_cloth_set_rest(&e->cloth, e->rest);
}

void ruga_elastic_start(ruga_elastic* e, const double* x) {
    for (int h = 0; h < e->hinge_count; h++) {
        e->angle[e->segment[h]] = ruga_hinge_measure(&e->hinge[h], x, NULL, NULL);
    }
}

// ------------------------------------------------------------------------------- forces

typedef struct pass {
    ruga_elastic* e;
    double time;
    const double *x, *v;
    double* out;
} pass;

static void triangle_forces(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    ruga_elastic* e = p->e;
    double energy = 0;
    for (int t = begin; t < end; t += RUGA_LANES) {
        ruga_triangle_lanes lanes;
        double own[RUGA_LANES];
        int count = ruga_lanes_from(t, end);
        ruga_lanes_load(count, 3, e->triangle[t], p->x, lanes.x);
        ruga_membrane_lanes_energy(e->def.skin.membrane, e->def.skin.poisson, count, e->membrane + t, &lanes, own);
        ruga_lanes_store(count, 3, lanes.gradient, e->triangle_force[t][0]);
        for (int i = 0; i < count; i++) {
            energy += own[i];
        }
    }
    e->partial[chunk][0] = energy;
}

static void bend_forces(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    ruga_elastic* e = p->e;
    double energy = 0;
    for (int b = begin; b < end; b += RUGA_LANES) {
        ruga_hinge_lanes lanes;
        int count = ruga_lanes_from(b, end);
        ruga_lanes_load(count, 4, e->bend[b], p->x, lanes.x);
        ruga_hinge_lanes_measure(count, &lanes);
        ruga_lanes_store(count, 4, lanes.gradient, e->bend_gradient[b][0]);
        for (int i = 0; i < count; i++) {
            double off = ruga_angle_difference(lanes.angle[i], e->bend_rest[b + i]);
            e->bend_moment[b + i] = e->bend_stiffness[b + i] * off;
            energy += 0.5 * e->bend_moment[b + i] * off;
        }
    }
    e->partial[chunk][0] = energy;
}

static void hinge_forces(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    ruga_elastic* e = p->e;
    double chords = 0, creases = 0;
    for (int h = begin; h < end; h++) {
        double* angle = &e->angle[e->segment[h]];
        *angle = ruga_hinge_measure(&e->hinge[h], p->x, angle, e->hinge_gradient[h]);
        double off = *angle - e->rest[e->segment[h]];
        e->hinge_moment[h] = e->stiffness[h] * off;
        *(e->hinge[h].curve >= 0 ? &creases : &chords) += 0.5 * e->hinge_moment[h] * off;
    }
    e->partial[chunk][0] = chords;
    e->partial[chunk][1] = creases;
}

static double total(const ruga_elastic* e, int count, int column) {
    double sum = 0;
    for (int k = 0; k < ruga_chunk_count(count, CHUNK); k++) {
        sum += e->partial[k][column];
    }
    return sum;
}

// out += sign times the sum of what the elements bring to each node.
static void gather(const pass* p, int begin, int end, double sign) {
    const ruga_elastic* e = p->e;
    for (int n = begin; n < end; n++) {
        double sum[3] = {0, 0, 0};
        for (int k = e->at_triangle.start[n]; k < e->at_triangle.start[n + 1]; k++) {
            int item = e->at_triangle.item[k];
            ruga_add_scaled(1, e->triangle_force[item / 3][item % 3], sum);
        }
        for (int k = e->at_bend.start[n]; k < e->at_bend.start[n + 1]; k++) {
            int item = e->at_bend.item[k];
            ruga_add_scaled(e->bend_moment[item / 4], e->bend_gradient[item / 4][item % 4], sum);
        }
        for (int k = e->at_hinge.start[n]; k < e->at_hinge.start[n + 1]; k++) {
            int h = e->at_hinge.item[k] / RUGA_HINGE_NODES, corner = e->at_hinge.item[k] % RUGA_HINGE_NODES;
            ruga_add_scaled(e->hinge_moment[h], e->hinge_gradient[h][corner], sum);
        }
        ruga_add_scaled(sign, sum, p->out + 3 * (size_t)n);
    }
}

static void gather_forces(int begin, int end, int chunk, void* context) {
    (void)chunk;
    gather(context, begin, end, -1);
}

static void gather_damping(int begin, int end, int chunk, void* context) {
    (void)chunk;
    gather(context, begin, end, 1);
}

void ruga_elastic_force(ruga_elastic* e, const double* x, double* force, ruga_elastic_energies* energies) {
    pass p = {.e = e, .x = x, .out = force};
    memset(force, 0, 3 * (size_t)e->node_count * sizeof *force);
    energies->membrane = ruga_springs_force(&e->cloth.springs, x, force);
    ruga_parallel_for(e->triangle_count, CHUNK, triangle_forces, &p);
    energies->membrane += total(e, e->triangle_count, 0);
    ruga_parallel_for(e->bend_count, CHUNK, bend_forces, &p);
    energies->bending = total(e, e->bend_count, 0);
    ruga_parallel_for(e->hinge_count, CHUNK, hinge_forces, &p);
    energies->bending += total(e, e->hinge_count, 0);
    energies->hinges = total(e, e->hinge_count, 1);
    if (e->triangle_count + e->hinge_count > 0) {
        ruga_parallel_for(e->node_count, CHUNK, gather_forces, &p);
    }
}

// ------------------------------------------------------------------------------- damping

static void triangle_damping(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    ruga_elastic* e = p->e;
    (void)chunk;
    for (int t = begin; t < end; t++) {
        const double *x[3], *v[3];
        for (int i = 0; i < 3; i++) {
            x[i] = p->x + 3 * (size_t)e->triangle[t][i];
            v[i] = p->v + 3 * (size_t)e->triangle[t][i];
        }
        ruga_membrane_rest rest = e->membrane[t];
        rest.stretch *= p->time;
        rest.shear *= p->time;
        ruga_membrane_damp(e->def.skin.membrane, e->def.skin.poisson, &rest, x, v, e->triangle_force[t]);
    }
}

static void bend_damping(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    ruga_elastic* e = p->e;
    (void)chunk;
    for (int b = begin; b < end; b++) {
        double rate = 0;
        for (int i = 0; i < 4; i++) {
            rate += ruga_dot(e->bend_gradient[b][i], p->v + 3 * (size_t)e->bend[b][i]);
        }
        e->bend_moment[b] = p->time * e->bend_stiffness[b] * rate;
    }
}

static void hinge_damping(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    ruga_elastic* e = p->e;
    (void)chunk;
    for (int h = begin; h < end; h++) {
        double rate = 0;
        for (int a = 0; a < RUGA_HINGE_NODES; a++) {
            rate += ruga_dot(e->hinge_gradient[h][a], p->v + 3 * (size_t)e->hinge[h].node[a]);
        }
        e->hinge_moment[h] = p->time * e->stiffness[h] * rate;
    }
}

void ruga_elastic_damp(ruga_elastic* e, double time, const double* x, const double* v, double* out) {
    pass p = {.e = e, .time = time, .x = x, .v = v, .out = out};
    ruga_springs_damp(&e->cloth.springs, time, v, out);
    ruga_parallel_for(e->triangle_count, CHUNK, triangle_damping, &p);
    ruga_parallel_for(e->bend_count, CHUNK, bend_damping, &p);
    ruga_parallel_for(e->hinge_count, CHUNK, hinge_damping, &p);
    if (e->triangle_count + e->hinge_count > 0) {
        ruga_parallel_for(e->node_count, CHUNK, gather_damping, &p);
    }
}
