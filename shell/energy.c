// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Energy, gradient and Hessian of a shell: sums over triangles (membrane.c) and over hinges (bending.c),
//   E = k s/2 (theta - theta0)^2,
// s the mean over its two triangles of what their strain does to their thickness (thickness.c).
//
// The Hessian of a hinge is k s grad grad^T + k s (theta - theta0) H, and H splits into one part for each of
// the two triangles; these are added to the matrices of the triangles. So are those of s. So each triangle
// writes a 9 x 9 matrix, and a hinge's own part is made from its gradients when it is gathered: with p = k
// grad s, t = theta - theta0, its force is k s t grad theta + t^2/2 p, and the mixed part of its Hessian
// t (grad theta p^T + p grad theta^T). Everything is computed for each
// element first, and then gathered for each vertex, in an order that the mesh alone decides: the bits are the
// same for any number of threads.
//
// With directors (directors.c) a hinge's moment is not its stiffness times its angle but comes from all of
// them. The part w grad t Q (w grad t)^T couples the three hinges of a triangle with one another and with its
// neighbours', and so the vertices of its patch (its corners and those of its neighbours, up to six) with one
// another and with the neighbours' patches: patches and pairs of them are two more kinds of elements.
#include "shell/shell_internal.h"

#include "core/parallel.h"
#include "core/vec3.h"
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

static void triangle_energies(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    double energy = 0, force_square = 0;
    for (int f = begin; f < end; f++) {
        const double* x[3];
        double(*g)[3] = shell->triangle_gradient[f];
        ruga_triangle_corners(shell->triangle[f], p->x, x);
        energy += ruga_membrane_energy(shell->membrane, shell->poisson, &shell->triangle_rest[f], x, g);
        if (shell->thickness) {
            shell->thickness[f] = ruga_thickness_stiffness(shell->thickness_power, shell->rest_area[f], x,
                                                           shell->thickness_gradient[f]);
        }
        force_square += ruga_dot(g[0], g[0]) + ruga_dot(g[1], g[1]) + ruga_dot(g[2], g[2]);
    }
    shell->partial[chunk][0] = energy;
    shell->partial[chunk][1] = force_square;
}

static void hinge_angles(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    for (int h = begin; h < end; h++) {
        const double* x[4];
        ruga_hinge_corners(shell->hinge[h], p->x, x);
        shell->hinge_angle[h] =
            ruga_angle_difference(ruga_hinge_angle(x, shell->hinge_gradient[h]), shell->hinge_rest[h].angle);
    }
}

static void settle_directors(pass* p) {
    // The directors' work vectors are scratch of the shell, as the rest.
    ruga_directors directors = p->shell->directors;
    ruga_parallel_for(p->shell->hinge_count, RUGA_SHELL_CHUNK, hinge_angles, p);
    ruga_directors_settle(&directors, p->shell->hinge_angle, p->shell->hinge_moment);
}

// Sets the hinge's p and returns its s.
static double set_hinge_pull(const ruga_shell* shell, int h) {
    // Corners of the hinge from the corner at which the edge begins onwards, on either side.
    static const int corner[2][3] = {{0, 1, 2}, {1, 0, 3}};
    double(*pull)[3] = shell->hinge_pull[h], factor = 0;
    memset(pull, 0, sizeof shell->hinge_pull[h]);
    for (int side = 0; side < 2; side++) {
        int f = shell->hinge_side[h][side] / 3, first = shell->hinge_side[h][side] % 3;
        factor += 0.5 * shell->thickness[f];
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(0.5 * shell->hinge_rest[h].stiffness,
                            shell->thickness_gradient[f][(first + i) % 3], pull[corner[side][i]]);
        }
    }
    return factor;
}

static double force_square_of(const ruga_shell* shell, int h) {
    double sum = 0;
    for (int c = 0; c < 4; c++) {
        double force[3] = {0, 0, 0};
        ruga_add_scaled(shell->hinge_moment[h], shell->hinge_gradient[h][c], force);
        if (shell->thickness) {
            ruga_add_scaled(0.5 * shell->hinge_angle[h] * shell->hinge_angle[h], shell->hinge_pull[h][c],
                            force);
        }
        sum += ruga_dot(force, force);
    }
    return sum;
}

static void hinge_energies(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    double energy = 0, force_square = 0;
    for (int h = begin; h < end; h++) {
        const double* x[4];
        double(*g)[3] = shell->hinge_gradient[h];
        const ruga_hinge_rest* rest = &shell->hinge_rest[h];
        ruga_hinge_corners(shell->hinge[h], p->x, x);
        bool known = shell->has_directors; // angle and moment, by settle_directors
        double angle =
            known ? shell->hinge_angle[h] : ruga_angle_difference(ruga_hinge_angle(x, g), rest->angle);
        double stiffness = rest->stiffness * (shell->thickness ? set_hinge_pull(shell, h) : 1);
        double moment = known ? shell->hinge_moment[h] : stiffness * angle;
        shell->hinge_angle[h] = angle;
        shell->hinge_moment[h] = moment;
        energy += 0.5 * moment * angle;
        force_square += force_square_of(shell, h);
    }
    shell->partial[chunk][0] = energy;
    shell->partial[chunk][1] = force_square;
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
    const ruga_shell* shell = p->shell;
    for (int v = begin; v < end; v++) {
        double sum[3] = {0, 0, 0};
        const ruga_gather* from = &shell->vertex_triangle;
        for (int k = from->start[v]; k < from->start[v + 1]; k++) {
            int item = from->item[k];
            ruga_add_scaled(1, shell->triangle_gradient[item / 3][item % 3], sum);
        }
        from = &shell->vertex_hinge;
        for (int k = from->start[v]; k < from->start[v + 1]; k++) {
            int h = from->item[k] / 4, corner = from->item[k] % 4;
            ruga_add_scaled(shell->hinge_moment[h], shell->hinge_gradient[h][corner], sum);
            if (shell->thickness) {
                ruga_add_scaled(0.5 * shell->hinge_angle[h] * shell->hinge_angle[h],
                                shell->hinge_pull[h][corner], sum);
            }
        }
        memcpy(p->gradient + 3 * (size_t)v, sum, sizeof sum);
    }
}

static int side_of(const ruga_shell* shell, int h, int f) {
    return shell->hinge_side[h][1] / 3 == f;
}

static void triangle_hessians(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    for (int f = begin; f < end; f++) {
        const double* x[3];
        double moment[3], bent = 0;
        ruga_triangle_corners(shell->triangle[f], p->x, x);
        ruga_membrane_hessian(shell->membrane, shell->poisson, &shell->triangle_rest[f], x, p->clamp,
                              shell->triangle_block[f]);
        for (int i = 0; i < 3; i++) {
            int h = shell->triangle_hinge[f][i];
            moment[i] = h < 0 ? 0 : (1 - p->clamp) * shell->hinge_moment[h];
            bent +=
                h < 0 ? 0
                      : 0.25 * shell->hinge_rest[h].stiffness * shell->hinge_angle[h] * shell->hinge_angle[h];
            while (shell->next_hinge && h >= 0 && (h = shell->next_hinge[h][side_of(shell, h, f)]) >= 0) {
                moment[i] += (1 - p->clamp) * shell->hinge_moment[h];
                bent += 0.25 * shell->hinge_rest[h].stiffness * shell->hinge_angle[h] * shell->hinge_angle[h];
            }
        }
        ruga_hinge_add_hessian(x, moment, shell->triangle_block[f]);
        if (shell->thickness && p->clamp < 1) {
            ruga_thickness_add_hessian(shell->thickness_power, shell->rest_area[f], x, (1 - p->clamp) * bent,
                                       shell->triangle_block[f]);
        }
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

static void add_hinge_block(const ruga_shell* shell, double clamp, int h, int row, int column,
                            double sum[9]) {
    const double(*g)[3] = (const double(*)[3])shell->hinge_gradient[h];
    double stiffness = shell->hinge_rest[h].stiffness;
    if (!shell->thickness) {
        add_product(stiffness, g[row], g[column], sum);
        return;
    }
    const double(*pull)[3] = (const double(*)[3])shell->hinge_pull[h];
    const int* side = shell->hinge_side[h];
    double mixed = (1 - clamp) * shell->hinge_angle[h];
    stiffness *= 0.5 * (shell->thickness[side[0] / 3] + shell->thickness[side[1] / 3]);
    add_product(stiffness, g[row], g[column], sum);
    add_product(mixed, g[row], pull[column], sum);
    add_product(mixed, pull[row], g[column], sum);
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
                add_hinge_block(shell, p->clamp, h, pair / 4, pair % 4, sum);
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
    ruga_parallel_for(shell->triangle_count, RUGA_SHELL_CHUNK, triangle_energies, &p);
    sum.membrane = total(shell, shell->triangle_count, 0);
    sum.force_square = total(shell, shell->triangle_count, 1);
    if (shell->has_directors) {
        settle_directors(&p);
    }
    ruga_parallel_for(shell->hinge_count, RUGA_SHELL_CHUNK, hinge_energies, &p);
    sum.bending = total(shell, shell->hinge_count, 0);
    sum.force_square += total(shell, shell->hinge_count, 1);
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
