// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// E(u) = sum over cells and their Gauss points g of w_g psi(F_g),   F = 1 + sum over nodes a of u_a (grad
// N_a)^T
//
// degree + 1 points along each axis: exact for the small-strain energy, so that no cell is under-integrated.
// In plane strain the y axis has the constant function 1 alone: F_iy = [i = y].
#include "lattice/volume.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "lattice/corotational.h"
#include "lattice/kirchhoff.h"

#include <math.h>
#include <string.h>

enum { NODES_MAX = 27, PAIRS_MAX = NODES_MAX * (NODES_MAX + 1) / 2, BATCH = 64, CHUNK = 4 };

//---- create ----

static ruga_status check(const ruga_volume_def* def) {
    for (int i = 0; i < 2; i++) {
        if (!(def->young[i] > 0) || !(def->poisson[i] > -1 && def->poisson[i] < 0.5)) {
            return ruga_fail(
                RUGA_BAD_INPUT,
                "%s of a volume: young %g Pa and poisson %g: give young > 0 and poisson in (-1, 0.5)",
                i ? "skin" : "interior", def->young[i], def->poisson[i]);
        }
        if (!(def->size[i] > 0)) {
            return ruga_fail(RUGA_BAD_INPUT, "volume: its size along %c is %g m: give more than 0", "xy"[i],
                             def -> size[i]);
        }
    }
    RUGA_ASSERT(def->degree == 1 || def->degree == 2);
    RUGA_ASSERT(def->interface > 0 && def->interface < def->layers);
    RUGA_ASSERT(def->cells[0] >= 1 && def->cells[1] >= 0);
    return RUGA_OK;
}

static ruga_status create_uniform(int degree, int cells, double size, ruga_spline* spline) {
    double* grid = NULL;
    RUGA_TRY(RUGA_NEW(grid, cells + 1));
    for (int i = 0; i <= cells; i++) {
        grid[i] = size * i / cells;
    }
    ruga_status status = ruga_spline_create(degree, cells, grid, 0, spline);
    ruga_release(grid);
    return status;
}

static void number_nodes(const ruga_volume* v) {
    const ruga_spline* s = v->axis;
    for (int e = 0; e < v->element_count; e++) {
        int cell[3] = {e % s[0].cells, e / s[0].cells % s[1].cells, e / s[0].cells / s[1].cells}, n = 0;
        for (int k = 0; k <= s[2].degree; k++) {
            for (int j = 0; j <= s[1].degree; j++) {
                for (int i = 0; i <= s[0].degree; i++) {
                    int x = s[0].first[cell[0]] + i, y = s[1].first[cell[1]] + j, z = s[2].first[cell[2]] + k;
                    v->element_node[e * v->nodes_per_element + n++] = x + s[0].count * (y + s[1].count * z);
                }
            }
        }
    }
}

static ruga_status create_pattern(ruga_volume* v) {
    int n = v->nodes_per_element, pairs = n * (n + 1) / 2;
    int(*pair)[2] = NULL;
    RUGA_TRY(RUGA_NEW(pair, (size_t)v->element_count * (size_t)pairs));
    for (int e = 0, p = 0; e < v->element_count; e++) {
        const int* node = &v->element_node[e * n];
        for (int a = 0; a < n; a++) {
            for (int b = 0; b <= a; b++, p++) {
                pair[p][0] = node[a]; // ascending within an element
                pair[p][1] = node[b];
            }
        }
    }
    ruga_status status = ruga_sparse_from_pairs(v->node_count, 3, (int64_t)v->element_count * pairs,
                                                (const int(*)[2])pair, &v->pattern);
    for (int p = 0; status == RUGA_OK && p < v->element_count * pairs; p++) {
        v->block[p] = ruga_sparse_find(&v->pattern, 3 * pair[p][0], 3 * pair[p][1]);
    }
    ruga_release(pair);
    return status;
}

ruga_status ruga_volume_create(const ruga_volume_def* def, ruga_volume* v) {
    ruga_status status = RUGA_OK;
    *v = (ruga_volume){.interface = def->interface, .law = def->law};
    RUGA_TRY(check(def));
    for (int i = 0; i < 2; i++) {
        v->mu[i] = def->young[i] / (2 * (1 + def->poisson[i]));
        v->lambda[i] = def->young[i] * def->poisson[i] / ((1 + def->poisson[i]) * (1 - 2 * def->poisson[i]));
    }
    bool plane = def->cells[1] == 0;
    RUGA_TRY_DONE(create_uniform(def->degree, def->cells[0], def->size[0], &v->axis[0]));
    RUGA_TRY_DONE(
        create_uniform(plane ? 0 : def->degree, plane ? 1 : def->cells[1], def->size[1], &v->axis[1]));
    RUGA_TRY_DONE(ruga_spline_create(def->degree, def->layers, def->depth, def->interface, &v->axis[2]));
    v->node_count = v->axis[0].count * v->axis[1].count * v->axis[2].count;
    v->element_count = v->axis[0].cells * v->axis[1].cells * v->axis[2].cells;
    v->nodes_per_element = (v->axis[0].degree + 1) * (v->axis[1].degree + 1) * (v->axis[2].degree + 1);
    int n = v->nodes_per_element;
    RUGA_TRY_DONE(RUGA_NEW(v->element_node, (size_t)v->element_count * (size_t)n));
    RUGA_TRY_DONE(RUGA_NEW(v->block, (size_t)v->element_count * (size_t)(n * (n + 1) / 2)));
    number_nodes(v);
    RUGA_TRY_DONE(create_pattern(v));
done:
    if (status != RUGA_OK) {
        ruga_volume_clear(v);
    }
    return status;
}

void ruga_volume_clear(ruga_volume* volume) {
    for (int i = 0; i < 3; i++) {
        ruga_spline_clear(&volume->axis[i]);
    }
    ruga_sparse_clear(&volume->pattern);
    ruga_release(volume->element_node);
    ruga_release(volume->block);
    *volume = (ruga_volume){0};
}

//---- energy ----

typedef struct evaluation {
    const ruga_volume* v;
    const double* u;
    int first;      // element of the batch
    double* energy; // [BATCH]
    double* force;  // [BATCH][n][3] gradient of each element's energy
    double* blocks; // [BATCH][n (n + 1) / 2][9], NULL = no Hessian wanted
} evaluation;

static int gauss(int degree, double place[RUGA_SPLINE_ORDER_MAX], double weight[RUGA_SPLINE_ORDER_MAX]) {
    static const double x[3][3] = {{0},
                                   {-0.57735026918962576451, 0.57735026918962576451},
                                   {-0.77459666924148337704, 0, 0.77459666924148337704}};
    static const double w[3][3] = {{1}, {0.5, 0.5}, {5. / 18, 8. / 18, 5. / 18}};
    memcpy(place, x[degree], sizeof x[degree]);
    memcpy(weight, w[degree], sizeof w[degree]);
    return degree + 1;
}

// Values and slopes of a cell's functions at its points along one axis; weights in m.
typedef struct axis_table {
    int points;
    double weight[3], value[3][3], slope[3][3];
} axis_table;

static axis_table tabulate(const ruga_spline* s, int cell) {
    axis_table t = {0};
    double place[3], a = s->grid[cell], b = s->grid[cell + 1];
    t.points = gauss(s->degree, place, t.weight);
    for (int g = 0; g < t.points; g++) {
        t.weight[g] *= b - a;
        ruga_spline_basis(s, cell, 0.5 * (a + b) + 0.5 * (b - a) * place[g], t.value[g], t.slope[g]);
    }
    return t;
}

// grad [n][3] of the element's functions at the point (g0, g1, g2).
static void shape_gradients(const ruga_volume* v, const axis_table table[3], const int g[3],
                            double grad[][3]) {
    int n = 0;
    for (int k = 0; k <= v->axis[2].degree; k++) {
        for (int j = 0; j <= v->axis[1].degree; j++) {
            for (int i = 0; i <= v->axis[0].degree; i++, n++) {
                double x = table[0].value[g[0]][i], y = table[1].value[g[1]][j], z = table[2].value[g[2]][k];
                grad[n][0] = table[0].slope[g[0]][i] * y * z;
                grad[n][1] = x * table[1].slope[g[1]][j] * z;
                grad[n][2] = x * y * table[2].slope[g[2]][k];
            }
        }
    }
}

// blocks += w (grad N_a . dP/dF . grad N_b) for each pair a >= b.
static void add_stiffness(int n, double w, const double grad[][3], const double hessian[81], double* blocks) {
    for (int b = 0; b < n; b++) {
        double image[9][3]; // [3 i + j][k] = sum over l of w dP_ij / dF_kl dN_b / dX_l
        for (int m = 0; m < 9; m++) {
            for (int k = 0; k < 3; k++) {
                const double* h = &hessian[9 * m + 3 * k];
                image[m][k] = w * (h[0] * grad[b][0] + h[1] * grad[b][1] + h[2] * grad[b][2]);
            }
        }
        for (int a = b; a < n; a++) {
            double* block = &blocks[9 * (a * (a + 1) / 2 + b)];
            for (int m = 0; m < 9; m++) {
                const double(*row)[3] = (const double(*)[3])image[m / 3 * 3];
                int k = m % 3;
                block[m] += grad[a][0] * row[0][k] + grad[a][1] * row[1][k] + grad[a][2] * row[2][k];
            }
        }
    }
}

static double density(const ruga_volume* v, int material, const double f[9], double* stress,
                      double* hessian) {
    if (v->law == RUGA_VOLUME_KIRCHHOFF) {
        return ruga_kirchhoff(v->mu[material], v->lambda[material], f, stress, hessian);
    }
    return ruga_corotational(v->mu[material], v->lambda[material], f, false, stress, hessian);
}

static void evaluate_point(const evaluation* e, int material, double w, const double u[][3],
                           const double grad[][3], double* energy, double* force, double* blocks) {
    int n = e->v->nodes_per_element;
    double f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, stress[9], hessian[81];
    for (int a = 0; a < n; a++) {
        for (int m = 0; m < 9; m++) {
            f[m] += u[a][m / 3] * grad[a][m % 3];
        }
    }
    *energy += w * density(e->v, material, f, stress, blocks ? hessian : NULL);
    for (int a = 0; a < n; a++) {
        for (int i = 0; i < 3; i++) {
            const double* p = &stress[3 * i];
            force[3 * a + i] += w * (p[0] * grad[a][0] + p[1] * grad[a][1] + p[2] * grad[a][2]);
        }
    }
    if (blocks) {
        add_stiffness(n, w, grad, hessian, blocks);
    }
}

static void evaluate_elements(int begin, int end, int chunk, void* context) {
    const evaluation* e = context;
    const ruga_volume* v = e->v;
    int n = v->nodes_per_element, pairs = n * (n + 1) / 2;
    (void)chunk;
    for (int i = begin; i < end; i++) {
        int element = e->first + i, layer = element / v->axis[0].cells / v->axis[1].cells;
        axis_table table[3] = {tabulate(&v->axis[0], element % v->axis[0].cells),
                               tabulate(&v->axis[1], element / v->axis[0].cells % v->axis[1].cells),
                               tabulate(&v->axis[2], layer)};
        double u[NODES_MAX][3] = {{0}}, grad[NODES_MAX][3] = {{0}};
        double* blocks = e->blocks ? &e->blocks[(size_t)i * (size_t)pairs * 9] : NULL;
        for (int a = 0; a < n; a++) {
            memcpy(u[a], &e->u[3 * v->element_node[element * n + a]], sizeof u[a]);
        }
        e->energy[i] = 0;
        memset(&e->force[3 * i * n], 0, (size_t)(3 * n) * sizeof(double));
        if (blocks) {
            memset(blocks, 0, (size_t)(9 * pairs) * sizeof *blocks);
        }
        for (int p = 0; p < table[0].points * table[1].points * table[2].points; p++) {
            int g[3] = {p % table[0].points, p / table[0].points % table[1].points,
                        p / table[0].points / table[1].points};
            double w = table[0].weight[g[0]] * table[1].weight[g[1]] * table[2].weight[g[2]];
            shape_gradients(v, table, g, grad);
            evaluate_point(e, layer >= v->interface, w, (const double(*)[3])u, (const double(*)[3])grad,
                           &e->energy[i], &e->force[3 * i * n], blocks);
        }
    }
}

// Column 3 b + c of the pattern holds rows c.. of its diagonal block and then all rows of the others: an
// entry that is `place` after the beginning of column 3 b is place - c after the beginning of column 3 b + c.
static void scatter_block(const ruga_sparse* pattern, int position, int column, bool diagonal,
                          const double block[9], double* hessian) {
    int place = position - pattern->start[column];
    for (int c = 0; c < 3; c++) {
        double* entry = &hessian[pattern->start[column + c] + place - c];
        for (int r = diagonal ? c : 0; r < 3; r++) {
            entry[r] += block[3 * r + c];
        }
    }
}

static void gather(const evaluation* e, int count, double* energy, double* gradient, double* hessian,
                   double* force_square) {
    const ruga_volume* v = e->v;
    int n = v->nodes_per_element, pairs = n * (n + 1) / 2;
    for (int i = 0; i < count; i++) {
        const int* node = &v->element_node[(e->first + i) * n];
        const double* force = &e->force[3 * i * n];
        *energy += e->energy[i];
        for (int m = 0; m < 3 * n; m++) {
            *force_square += force[m] * force[m];
            if (gradient) {
                gradient[3 * node[m / 3] + m % 3] += force[m];
            }
        }
        for (int a = 0, p = 0; hessian && a < n; a++) {
            for (int b = 0; b <= a; b++, p++) {
                scatter_block(&v->pattern, v->block[(e->first + i) * pairs + p], 3 * node[b], a == b,
                              &e->blocks[(size_t)(i * pairs + p) * 9], hessian);
            }
        }
    }
}

ruga_status ruga_volume_energy(const ruga_volume* v, const double* u, double* energy, double* gradient,
                               double* hessian, double* force_square) {
    ruga_status status = RUGA_OK;
    int n = v->nodes_per_element, pairs = n * (n + 1) / 2;
    double square = 0;
    evaluation e = {.v = v, .u = u};
    RUGA_TRY_DONE(RUGA_NEW(e.energy, BATCH));
    RUGA_TRY_DONE(RUGA_NEW(e.force, BATCH * n * 3));
    if (hessian) {
        RUGA_TRY_DONE(RUGA_NEW(e.blocks, BATCH * pairs * 9));
        memset(hessian, 0, (size_t)v->pattern.start[v->pattern.columns] * sizeof *hessian);
    }
    if (gradient) {
        memset(gradient, 0, (size_t)v->node_count * 3 * sizeof *gradient);
    }
    *energy = 0;
    for (; e.first < v->element_count; e.first += BATCH) {
        int count = v->element_count - e.first < BATCH ? v->element_count - e.first : BATCH;
        ruga_parallel_for(count, CHUNK, evaluate_elements, &e);
        gather(&e, count, energy, gradient, hessian, &square);
    }
    if (force_square) {
        *force_square = square;
    }
done:
    ruga_release(e.energy);
    ruga_release(e.force);
    ruga_release(e.blocks);
    return status;
}

//---- places ----

void ruga_volume_node(const ruga_volume* v, int node, double position[3]) {
    const ruga_spline* s = v->axis;
    position[0] = ruga_spline_greville(&s[0], node % s[0].count);
    position[1] = ruga_spline_greville(&s[1], node / s[0].count % s[1].count);
    position[2] = ruga_spline_greville(&s[2], node / s[0].count / s[1].count);
}

void ruga_volume_displacement(const ruga_volume* v, const double* u, const double X[3], double d[3]) {
    double value[3][RUGA_SPLINE_ORDER_MAX], slope[RUGA_SPLINE_ORDER_MAX];
    int cell[3];
    for (int i = 0; i < 3; i++) {
        cell[i] = ruga_spline_cell(&v->axis[i], X[i]);
        ruga_spline_basis(&v->axis[i], cell[i], X[i], value[i], slope);
    }
    int element = cell[0] + v->axis[0].cells * (cell[1] + v->axis[1].cells * cell[2]);
    const int* node = &v->element_node[element * v->nodes_per_element];
    d[0] = d[1] = d[2] = 0;
    for (int a = 0; a < v->nodes_per_element; a++) {
        int nx = v->axis[0].degree + 1, ny = v->axis[1].degree + 1;
        double w = value[0][a % nx] * value[1][a / nx % ny] * value[2][a / nx / ny];
        for (int i = 0; i < 3; i++) {
            d[i] += w * u[3 * node[a] + i];
        }
    }
}

// Heights first * r^k, k = 0 .. below - 1, whose sum is `depth`: r by bisection.
void ruga_volume_grade(double depth, double first, int below, double thickness, int skin, double* grid) {
    RUGA_ASSERT(first > 0 && first * below <= depth * (1 + 1e-12));
    double low = 1, high = 64;
    for (int i = 0; i < 100; i++) {
        double r = 0.5 * (low + high), sum = 0;
        for (int k = below; k-- > 0;) {
            sum = first + r * sum;
        }
        *(sum > depth ? &high : &low) = r;
    }
    double height = first;
    grid[below] = 0;
    for (int k = below - 1; k >= 0; k--) {
        grid[k] = grid[k + 1] - height;
        height *= high;
    }
    grid[0] = -depth;
    for (int k = 1; k <= skin; k++) {
        grid[below + k] = thickness * k / skin;
    }
}
