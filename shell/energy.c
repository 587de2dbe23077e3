// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Energy, gradient and Hessian of a shell: sums over triangles (membrane.c) and over hinges (bending.c),
//   E = k s/2 (theta - theta0)^2,
// s the mean over its two triangles of what their strain does to their thickness (thickness.c).
//
// A hinge's forces are its moment times grad theta, of which either triangle brings a part along its normal,
// and (theta - theta0)^2/2 p, p = k grad s. So the hinges' moments come first, and then each triangle adds up
// the forces on its corners; they are gathered for each vertex in an order that the mesh alone decides: the
// bits are the same for any number of threads. Elements are taken RUGA_LANES at a time, side by side.
//
// The Hessian of a hinge is k s grad grad^T + k s (theta - theta0) H, and H splits into one part for each of
// the two triangles; these are added to the matrices of the triangles. So are those of s. So each triangle
// writes a 9 x 9 matrix, and a hinge's own part, with the mixed one, is made when it is gathered:
//   grad q^T + q grad^T,  q = k s/2 grad + (1 - clamp) (theta - theta0) p.
//
// With directors (directors.c) a hinge's moment is not its stiffness times its angle but comes from all of
// them. The part w grad t Q (w grad t)^T couples the three hinges of a triangle with one another and with its
// neighbours', and so the vertices of its patch (its corners and those of its neighbours, up to six) with one
// another and with the neighbours' patches: patches and pairs of them are two more kinds of elements.
#include "shell/shell_internal.h"

#include "core/parallel.h"
#include "core/vec3.h"
#include "core/wide.h"
#include "shell/bending.h"
#include "shell/thickness.h"

#include <string.h>

typedef struct pass {
    const ruga_shell* shell;
    const double* x;
    double clamp;
    double* gradient;
    double* hessian;
} pass;

// Energies and squares of nodal forces, side by side.
typedef struct sums {
    double energy[RUGA_LANES], force_square[RUGA_LANES];
} sums;

static void end_chunk(const ruga_shell* shell, int chunk, const sums* s) {
    double energy = 0, force_square = 0;
    for (int i = 0; i < RUGA_LANES; i++) {
        energy += s->energy[i];
        force_square += s->force_square[i];
    }
    shell->partial[chunk][0] = energy;
    shell->partial[chunk][1] = force_square;
}

static void thicknesses(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    for (int f = begin; f < end; f += RUGA_LANES) {
        ruga_triangle_lanes t;
        int count = ruga_lanes_from(f, end);
        ruga_lanes_load(count, 3, shell->triangle[f], p->x, t.x);
        ruga_thickness_lanes_stiffness(count, shell->thickness_power, shell->rest_area + f, &t,
                                       shell->thickness + f);
    }
}

// ---- hinges --------------------------------------------------------------------------------------------

typedef struct bends {
    double stiffness[RUGA_LANES], rest[RUGA_LANES]; // k, theta0
    double factor[RUGA_LANES];                      // s
    double slope[2][RUGA_LANES];                    // k/2 times either triangle's z
    double angle[RUGA_LANES], moment[RUGA_LANES];   // theta - theta0, k s (theta - theta0)
    double bend[RUGA_LANES];                        // k/4 (theta - theta0)^2
    double q[4][3][RUGA_LANES];
} bends;

RUGA_WIDE static void set_moments(int count, const ruga_hinge_lanes* restrict h, bends* restrict b) {
    for (int i = 0; i < count; i++) {
        double angle = ruga_angle_difference(h->angle[i], b->rest[i]);
        b->angle[i] = angle;
        b->moment[i] = b->stiffness[i] * b->factor[i] * angle;
        b->bend[i] = 0.25 * b->stiffness[i] * angle * angle;
    }
}

static void load_stiffness(const ruga_shell* shell, int h, int count, bends* b) {
    for (int i = 0; i < count; i++) {
        b->stiffness[i] = shell->hinge_rest[h + i].stiffness;
        b->rest[i] = shell->hinge_rest[h + i].angle;
        if (shell->thickness) {
            const double* one = shell->thickness[shell->hinge_side[h + i][0]];
            const double* other = shell->thickness[shell->hinge_side[h + i][1]];
            b->factor[i] = 0.5 * (one[0] + other[0]);
            b->slope[0][i] = 0.5 * b->stiffness[i] * one[1];
            b->slope[1][i] = 0.5 * b->stiffness[i] * other[1];
        } else {
            b->factor[i] = 1;
            b->slope[0][i] = b->slope[1][i] = 0;
        }
    }
}

static void measure_hinges(const pass* p, int h, int count, ruga_hinge_lanes* lanes, bends* b) {
    ruga_lanes_load(count, 4, p->shell->hinge[h], p->x, lanes->x);
    load_stiffness(p->shell, h, count, b);
    ruga_hinge_lanes_measure(count, lanes);
    set_moments(count, lanes, b);
}

static void hinge_angles(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    for (int h = begin; h < end; h += RUGA_LANES) {
        ruga_hinge_lanes lanes;
        bends b;
        int count = ruga_lanes_from(h, end);
        measure_hinges(p, h, count, &lanes, &b);
        memcpy(p->shell->hinge_angle + h, b.angle, (size_t)count * sizeof b.angle[0]);
    }
}

static void settle_directors(pass* p) {
    // The directors' work vectors are scratch of the shell, as the rest.
    ruga_directors directors = p->shell->directors;
    ruga_parallel_for(p->shell->hinge_count, RUGA_SHELL_CHUNK, hinge_angles, p);
    ruga_directors_settle(&directors, p->shell->hinge_angle, p->shell->hinge_moment);
}

// p of the hinge: each triangle brings k/2 z n x d to a corner (thickness.c), d the edge across from it as
// the triangle runs, which is d2 - e, -d2 and e for corners 0, 1 and 2, and e - d3, d3 and -e for 0, 1 and 3.
RUGA_WIDE_PART void pull_of(const ruga_hinge_lanes* h, const bends* b, int i, double pull[4][3]) {
    double e[3], d2[3], d3[3], n[3], along_e[3], along_d[3];
    for (int c = 0; c < 3; c++) {
        e[c] = h->x[1][c][i] - h->x[0][c][i];
        d2[c] = h->x[2][c][i] - h->x[0][c][i];
        d3[c] = h->x[3][c][i] - h->x[0][c][i];
    }
    ruga_cross(e, d2, n);
    ruga_cross(n, e, along_e);
    ruga_cross(n, d2, along_d);
    for (int c = 0; c < 3; c++) {
        pull[0][c] = b->slope[0][i] * (along_d[c] - along_e[c]);
        pull[1][c] = -b->slope[0][i] * along_d[c];
        pull[2][c] = b->slope[0][i] * along_e[c];
    }
    ruga_cross(d3, e, n);
    ruga_cross(n, e, along_e);
    ruga_cross(n, d3, along_d);
    for (int c = 0; c < 3; c++) {
        pull[0][c] += b->slope[1][i] * (along_e[c] - along_d[c]);
        pull[1][c] += b->slope[1][i] * along_d[c];
        pull[3][c] = -b->slope[1][i] * along_e[c];
    }
}

RUGA_WIDE static void add_hinges(int count, const ruga_hinge_lanes* restrict h, const bends* restrict b,
                                 sums* restrict sum) {
    for (int i = 0; i < count; i++) {
        double pull[4][3], square = 0, angle = b->angle[i], moment = b->moment[i];
        pull_of(h, b, i, pull);
        for (int k = 0; k < 4; k++) {
            double force[3];
            for (int c = 0; c < 3; c++) {
                force[c] = moment * h->gradient[k][c][i] + 0.5 * angle * angle * pull[k][c];
            }
            square += ruga_dot(force, force);
        }
        sum->energy[i] += 0.5 * moment * angle;
        sum->force_square[i] += square;
    }
}

RUGA_WIDE static void set_q(int count, double clamp, const ruga_hinge_lanes* restrict h, bends* restrict b) {
    for (int i = 0; i < count; i++) {
        double pull[4][3], half = 0.5 * b->stiffness[i] * b->factor[i], mixed = (1 - clamp) * b->angle[i];
        pull_of(h, b, i, pull);
        for (int k = 0; k < 4; k++) {
            for (int c = 0; c < 3; c++) {
                b->q[k][c][i] = half * h->gradient[k][c][i] + mixed * pull[k][c];
            }
        }
    }
}

static void store_products(int count, const ruga_hinge_lanes* h, const bends* b, double (*to)[2][4][3]) {
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 12; k++) {
            to[i][0][k / 3][k % 3] = h->gradient[k / 3][k % 3][i];
            to[i][1][k / 3][k % 3] = b->q[k / 3][k % 3][i];
        }
    }
}

static void hinge_energies(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    sums sum = {{0}, {0}};
    for (int h = begin; h < end; h += RUGA_LANES) {
        ruga_hinge_lanes lanes;
        bends b;
        int count = ruga_lanes_from(h, end);
        size_t size = (size_t)count * sizeof(double);
        measure_hinges(p, h, count, &lanes, &b);
        if (shell->has_directors) {
            memcpy(b.moment, shell->hinge_moment + h, size); // by settle_directors
        } else {
            memcpy(shell->hinge_moment + h, b.moment, size);
        }
        memcpy(shell->hinge_bend + h, b.bend, size);
        add_hinges(count, &lanes, &b, &sum);
        if (shell->has_directors) {
            ruga_lanes_store(count, 4, lanes.gradient, shell->hinge_gradient[h][0]);
        } else if (p->hessian) {
            set_q(count, p->clamp, &lanes, &b);
            store_products(count, &lanes, &b, shell->hinge_product + h);
        }
    }
    end_chunk(shell, chunk, &sum);
}

// ---- triangles -----------------------------------------------------------------------------------------

RUGA_WIDE static void add_triangles(int count, const ruga_triangle_lanes* restrict t,
                                    const double* restrict energy, sums* restrict sum) {
    for (int i = 0; i < count; i++) {
        double square = 0;
        for (int k = 0; k < 9; k++) {
            square += t->gradient[k / 3][k % 3][i] * t->gradient[k / 3][k % 3][i];
        }
        sum->energy[i] += energy[i];
        sum->force_square[i] += square;
    }
}

// What the hinges at their edges do to triangles: moments, and their part in p as ruga_thickness_lanes_add
// wants it.
static void load_moments(const ruga_shell* shell, int f, int count, double (*moment)[RUGA_LANES],
                         double* pull) {
    const double *moment_of = shell->hinge_moment, *bend_of = shell->hinge_bend;
    for (int i = 0; i < count; i++) {
        double bend = 0;
        for (int k = 0; k < 3; k++) {
            int h = shell->triangle_hinge[f + i][k];
            moment[k][i] = h < 0 ? 0 : moment_of[h];
            bend += h < 0 ? 0 : bend_of[h];
        }
        pull[i] = bend;
    }
    // Further hinges at the same edges.
    for (int k = 0; k < 3 * count && shell->next_hinge; k++) {
        int i = k / 3, h = shell->triangle_hinge[f + i][k % 3];
        while (h >= 0 && (h = shell->next_hinge[h][shell->hinge_side[h][1] == f + i]) >= 0) {
            moment[k % 3][i] += moment_of[h];
            pull[i] += bend_of[h];
        }
    }
    for (int i = 0; i < count && shell->thickness; i++) {
        pull[i] *= shell->thickness[f + i][1];
    }
}

static void triangle_energies(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    sums sum = {{0}, {0}};
    for (int f = begin; f < end; f += RUGA_LANES) {
        ruga_triangle_lanes t;
        double energy[RUGA_LANES], moment[3][RUGA_LANES], pull[RUGA_LANES] = {0};
        int count = ruga_lanes_from(f, end);
        ruga_lanes_load(count, 3, shell->triangle[f], p->x, t.x);
        ruga_membrane_lanes_energy(shell->membrane, shell->poisson, count, shell->triangle_rest + f, &t,
                                   energy);
        add_triangles(count, &t, energy, &sum);
        if (p->gradient) {
            load_moments(shell, f, count, moment, pull);
            ruga_hinge_lanes_add(count, moment, &t);
            if (shell->thickness) {
                ruga_thickness_lanes_add(count, pull, &t);
            }
            ruga_lanes_store(count, 3, t.gradient, shell->triangle_gradient[f][0]);
        }
    }
    end_chunk(shell, chunk, &sum);
}

// Sum of one column of the partial sums, in their order.
static double total(const ruga_shell* shell, int element_count, int column) {
    double sum = 0;
    for (int k = 0; k < ruga_chunk_count(element_count, RUGA_SHELL_CHUNK); k++) {
        sum += shell->partial[k][column];
    }
    return sum;
}

static void gather_gradient(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_gather* from = &p->shell->vertex_triangle;
    const double(*corner)[3] = (const double(*)[3])p->shell->triangle_gradient;
    for (int v = begin; v < end; v++) {
        double sum[3] = {0, 0, 0};
        for (int k = from->start[v]; k < from->start[v + 1]; k++) {
            ruga_add_scaled(1, corner[from->item[k]], sum);
        }
        memcpy(p->gradient + 3 * (size_t)v, sum, sizeof sum);
    }
}

// ---- Hessian -------------------------------------------------------------------------------------------

static void triangle_hessians(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    for (int f = begin; f < end; f += RUGA_LANES) {
        ruga_triangle_lanes t;
        double moment[3][RUGA_LANES], pull[RUGA_LANES] = {0};
        int count = ruga_lanes_from(f, end);
        ruga_lanes_load(count, 3, shell->triangle[f], p->x, t.x);
        load_moments(shell, f, count, moment, pull);
        for (int i = 0; i < count; i++) {
            for (int k = 0; k < 3; k++) {
                moment[k][i] *= 1 - p->clamp;
            }
            pull[i] *= 1 - p->clamp;
        }
        ruga_membrane_lanes_hessian(shell->membrane, shell->poisson, count, shell->triangle_rest + f,
                                    p->clamp, &t);
        ruga_hinge_lanes_add_hessian(count, moment, &t);
        if (shell->thickness) {
            ruga_thickness_lanes_add_hessian(count, shell->thickness_power, pull, &t);
        }
        ruga_triangle_lanes_blocks(count, &t, shell->triangle_block + f);
    }
}

// Adds the block of one pair of corners (3 row corner + column corner).
static void add_triangle_block(double block[RUGA_TRIANGLE_BLOCKS][9], int pair, double sum[9]) {
    static const int lower[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
    const double* b = block[lower[pair]];
    if (pair / 3 >= pair % 3) {
        for (int k = 0; k < 9; k++) {
            sum[k] += b[k];
        }
        return;
    }
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            sum[3 * r + c] += b[3 * c + r];
        }
    }
}

static void add_product(double scale, const double row[3], const double column[3], double sum[9]) {
    for (int r = 0; r < 3; r++) {
        double s = scale * row[r];
        for (int c = 0; c < 3; c++) {
            sum[3 * r + c] += s * column[c];
        }
    }
}

// Gradients of the angles of a triangle's hinges, times its parts of them, by the vertices of its patch.
static void set_patch_gradient(const ruga_shell* shell, int f) {
    double(*to)[RUGA_SHELL_PATCH][3] = shell->patch_gradient[f];
    memset(to, 0, sizeof shell->patch_gradient[f]);
    for (int i = 0; i < 3; i++) {
        int h = shell->triangle_hinge[f][i];
        bool first = h >= 0 && shell->directors.hinge_triangle[h][0] == f;
        double weight = h >= 0 ? shell->directors.weight[h][!first] : 0;
        for (int c = 0; c < 4 && h >= 0; c++) {
            int k = c < 2 ? (shell->hinge[h][c] == shell->triangle[f][i] ? i : (i + 1) % 3)
                          : ((c == 2) == first ? (i + 2) % 3 : 3 + i);
            ruga_add_scaled(weight, shell->hinge_gradient[h][c], to[i][k]);
        }
    }
}

static void patch_gradients(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    for (int f = begin; f < end; f++) {
        set_patch_gradient(p->shell, f);
    }
}

// q between a vertex of triangle f's patch and one of triangle g's; the first gives the columns if `turned`.
static void add_patch_block(double (*q)[3], const double (*f)[RUGA_SHELL_PATCH][3], int vertex_f,
                            const double (*g)[RUGA_SHELL_PATCH][3], int vertex_g, bool turned,
                            double sum[9]) {
    for (int i = 0; i < 3; i++) {
        double product[3] = {0, 0, 0};
        for (int j = 0; j < 3; j++) {
            ruga_add_scaled(q[i][j], g[j][vertex_g], product);
        }
        add_product(1, turned ? product : f[i][vertex_f], turned ? f[i][vertex_f] : product, sum);
    }
}

// Q of directors.c within triangles and between neighbours.
static void add_patch_blocks(const ruga_shell* shell, int block, double sum[9]) {
    enum { PAIRS = RUGA_SHELL_PATCH * RUGA_SHELL_PATCH };
    typedef const double(*patch)[RUGA_SHELL_PATCH][3];
    const ruga_directors* d = &shell->directors;
    for (int k = shell->block_patch.start[block]; k < shell->block_patch.start[block + 1]; k++) {
        int f = shell->block_patch.item[k] / PAIRS, pair = shell->block_patch.item[k] % PAIRS;
        patch g = (patch)shell->patch_gradient[f];
        add_patch_block(d->stiffness[f], g, pair / RUGA_SHELL_PATCH, g, pair % RUGA_SHELL_PATCH, false, sum);
    }
    for (int k = shell->block_pair.start[block]; k < shell->block_pair.start[block + 1]; k++) {
        int h = shell->block_pair.item[k] / PAIRS, i = shell->block_pair.item[k] % PAIRS / RUGA_SHELL_PATCH;
        int j = shell->block_pair.item[k] % RUGA_SHELL_PATCH, f = d->hinge_triangle[h][0],
            g = d->hinge_triangle[h][1];
        patch one = (patch)shell->patch_gradient[f], other = (patch)shell->patch_gradient[g];
        int a = shell->patch[f][i], b = shell->patch[g][j];
        if (a >= b) {
            add_patch_block(d->cross[h], one, i, other, j, false, sum);
        }
        if (a <= b) {
            add_patch_block(d->cross[h], one, i, other, j, true, sum);
        }
    }
}

static void gather_hessian(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    const ruga_gather *triangles = &shell->block_triangle, *hinges = &shell->block_hinge;
    for (int v = begin; v < end; v++) {
        for (int b = shell->block_start[v]; b < shell->block_start[v + 1]; b++) {
            double sum[9] = {0};
            for (int k = triangles->start[b]; k < triangles->start[b + 1]; k++) {
                int item = triangles->item[k];
                add_triangle_block(shell->triangle_block[item / 9], item % 9, sum);
            }
            if (shell->has_directors) {
                add_patch_blocks(shell, b, sum);
            }
            for (int k = shell->has_directors ? 0 : hinges->start[b];
                 !shell->has_directors && k < hinges->start[b + 1]; k++) {
                int h = hinges->item[k] / 16, pair = hinges->item[k] % 16;
                double(*g)[3] = shell->hinge_product[h][0], (*q)[3] = shell->hinge_product[h][1];
                add_product(1, g[pair / 4], q[pair % 4], sum);
                add_product(1, q[pair / 4], g[pair % 4], sum);
            }
            // Column c begins at its diagonal: it lacks the first c entries of the first block.
            int number = b - shell->block_start[v];
            for (int c = 0; c < 3; c++) {
                double* column = p->hessian + shell->pattern.start[3 * v + c] - c + 3 * number;
                for (int r = number == 0 ? c : 0; r < 3; r++) {
                    column[r] = sum[3 * r + c];
                }
            }
        }
    }
}

ruga_status ruga_shell_energy(const ruga_shell* shell, const double* x, double clamp,
                              ruga_shell_energies* energies, double* gradient, double* hessian) {
    RUGA_ASSERT(clamp >= 0 && clamp <= 1);
    pass p = {shell, x, clamp, gradient, hessian};
    ruga_shell_energies sum;
    if (shell->thickness) {
        ruga_parallel_for(shell->triangle_count, RUGA_SHELL_CHUNK, thicknesses, &p);
    }
    if (shell->has_directors) {
        settle_directors(&p);
    }
    ruga_parallel_for(shell->hinge_count, RUGA_SHELL_CHUNK, hinge_energies, &p);
    sum.bending = total(shell, shell->hinge_count, 0);
    sum.force_square = total(shell, shell->hinge_count, 1);
    if (energies || gradient) {
        ruga_parallel_for(shell->triangle_count, RUGA_SHELL_CHUNK, triangle_energies, &p);
        sum.membrane = total(shell, shell->triangle_count, 0);
        sum.force_square += total(shell, shell->triangle_count, 1);
    }
    if (energies) {
        *energies = sum;
    }
    if (gradient) {
        ruga_parallel_for(shell->vertex_count, RUGA_SHELL_CHUNK, gather_gradient, &p);
    }
    if (hessian) {
        ruga_parallel_for(shell->triangle_count, RUGA_SHELL_CHUNK, triangle_hessians, &p);
        if (shell->has_directors) {
            ruga_parallel_for(shell->triangle_count, RUGA_SHELL_CHUNK, patch_gradients, &p);
        }
        ruga_parallel_for(shell->vertex_count, RUGA_SHELL_CHUNK, gather_hessian, &p);
    }
    return RUGA_OK;
}

void ruga_shell_coupling(const ruga_shell* shell, double (*coupling)[3]) {
    ruga_directors_coupling(&shell->directors, shell->hinge_gradient, coupling);
}

void ruga_shell_relax(const ruga_shell* shell, const double (*coupling)[3], const double* v, double* y) {
    ruga_directors directors = shell->directors;
    double* f = directors.rotation;
    memset(f, 0, (size_t)shell->hinge_count * sizeof *f);
    for (int i = 0; i < shell->vertex_count; i++) {
        for (int k = directors.start[i]; k < directors.start[i + 1]; k++) {
            f[directors.edge[k]] += ruga_dot(coupling[k], v + 3 * (size_t)i);
        }
    }
    ruga_directors_solve(&directors, f, f);
    for (int i = 0; i < shell->vertex_count; i++) {
        for (int k = directors.start[i]; k < directors.start[i + 1]; k++) {
            ruga_add_scaled(-f[directors.edge[k]], coupling[k], y + 3 * (size_t)i);
        }
    }
}
