// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// E(q) = sum over elements e and their 27 points g of k_eg psi(F_eg),   F = sum over nodes a of q_a (grad
// N_a)^T
//
// with psi from corotational.h. Force and stiffness of an element:
//   f_a = sum over g of k P grad N_a,   K_ab^ik = sum over g, j, l of k dN_a/dX_j (dP_ij/dF_kl) dN_b/dX_l.
//
// Weights k. The volume v_eg of material that a point stands for may be anything down to zero. An element
// with a sliver of material would have next to no stiffness: its outer nodes belong to nothing else, and the
// condition number of the system would grow like 1 / sliver. Hence a fictitious soft material fills the cell,
// as in the finite cell method (Parvizian, Duester and Rank 2007): k_eg = max(v_eg, STIFFNESS_FLOOR w_g), w_g
// the point's share of a full cell. The floor of 1e-3 bounds the condition number at about 1e3 times that of
// full cells, while a body's stiffness changes by less than 1e-3 of that of its boundary cells. Mass keeps
// the true volume: the weight of the body is exact, and a light node held by a stiff spring does no harm to
// an implicit step.
#include "lattice/elasticity_internal.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/wide.h"
#include "lattice/corotational.h"

#include <math.h>
#include <string.h>

enum { POINTS = RUGA_LATTICE_POINTS, BATCH = 64, ELEMENT_CHUNK = 2, SCATTER_CHUNKS = 16 };

static const double STIFFNESS_FLOOR = 1e-3;

// A tile of sums stays in registers over all rows. Each sum runs over rows in order. (Static: what picks the
// variant would be exported with an external function.)
RUGA_WIDE static void accumulate(int count, int width, const double* left, const double* right, bool upper,
                                 double* plane) {
    for (int a = 0; a < width; a += 4) {
        for (int b = upper ? a : 0; b < width; b += 4) {
            double sum[4][4] = {{0}};
            for (int r = 0; r < count; r++) {
                const double* x = &left[r * width + a];
                const double* y = &right[r * width + b];
                for (int i = 0; i < 4; i++) {
                    for (int j = 0; j < 4; j++) {
                        sum[i][j] += x[i] * y[j];
                    }
                }
            }
            for (int i = 0; i < 4; i++) {
                for (int j = 0; j < 4; j++) {
                    plane[(a + i) * width + b + j] += sum[i][j];
                }
            }
        }
    }
}

void ruga_plane_accumulate(int count, int width, const double* left, const double* right, bool upper,
                           double* plane) {
    accumulate(count, width, left, right, upper, plane);
}

void ruga_plane_mirror(int width, const double* plane, double* mirrored) {
    for (int a = 0; a < width; a++) {
        for (int b = 0; b < (mirrored == plane ? a : width); b++) {
            mirrored[a * width + b] = plane[b * width + a];
        }
    }
}

int ruga_scatter_chunk(const ruga_elasticity* elasticity) {
    return elasticity->lattice->node_count / SCATTER_CHUNKS + 1;
}

//---- create ----

static void tabulate_shapes(ruga_elasticity* e) {
    const ruga_lattice* lattice = e->lattice;
    int n = lattice->nodes_per_element;
    for (int g = 0; g < POINTS; g++) {
        double xi[3], x[3], weight[RUGA_LATTICE_NODES_MAX], gradient[RUGA_LATTICE_NODES_MAX * 3];
        ruga_lattice_point(lattice, 0, g, xi, x);
        ruga_lattice_shape(lattice, xi, weight, gradient);
        for (int a = 0; a < n; a++) {
            e->weight[g * e->width + a] = weight[a];
            for (int j = 0; j < 3; j++) {
                e->gradient[(3 * g + j) * e->width + a] = gradient[3 * a + j];
            }
        }
    }
}

static void floor_stiffness(ruga_elasticity* e) {
    static const double gauss[3] = {5. / 18, 8. / 18, 5. / 18};
    const ruga_lattice* lattice = e->lattice;
    double cell = lattice->cell_size[0] * lattice->cell_size[1] * lattice->cell_size[2];
    for (int i = 0; i < lattice->element_count; i++) {
        for (int g = 0; g < POINTS; g++) {
            double full = cell * gauss[g % 3] * gauss[g / 3 % 3] * gauss[g / 9];
            e->stiffness[i * POINTS + g] = fmax(lattice->volume[i * POINTS + g], STIFFNESS_FLOOR * full);
        }
    }
}

static void sort_vertices(ruga_elasticity* e) {
    const ruga_lattice* lattice = e->lattice;
    for (int v = 0; v < lattice->vertex_count; v++) {
        e->vertex_start[lattice->vertex_element[v] + 1]++;
    }
    for (int i = 0; i < lattice->element_count; i++) {
        e->vertex_start[i + 1] += e->vertex_start[i];
    }
    // Filling from the back leaves vertex_start at the beginnings.
    for (int v = lattice->vertex_count - 1; v >= 0; v--) {
        e->vertex[--e->vertex_start[lattice->vertex_element[v] + 1]] = v;
    }
    memmove(e->vertex_start, e->vertex_start + 1, (size_t)lattice->element_count * sizeof(int));
    e->vertex_start[lattice->element_count] = lattice->vertex_count;
}

ruga_status ruga_elasticity_create(const ruga_lattice* lattice, double young, double poisson,
                                   const ruga_sparse* vertex_pattern, ruga_elasticity** elasticity) {
    RUGA_ASSERT(lattice->element_count > 0);
    *elasticity = NULL;
    if (!(young > 0) || !(poisson > -1 && poisson < 0.5)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "interior: young %g Pa and poisson %g: give young > 0 and poisson in (-1, 0.5)",
                         young, poisson);
    }
    ruga_elasticity* e = NULL;
    ruga_status status = RUGA_OK;
    RUGA_TRY(RUGA_NEW_ZERO(e, 1));
    e->lattice = lattice;
    e->mu = young / (2 * (1 + poisson));
    e->lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    e->width = (lattice->nodes_per_element + 3) / 4 * 4;
    RUGA_TRY_DONE(RUGA_NEW(e->stiffness, lattice->element_count * POINTS));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(e->vertex_start, lattice->element_count + 1));
    RUGA_TRY_DONE(RUGA_NEW(e->vertex, lattice->vertex_count));
    RUGA_TRY_DONE(ruga_element_pattern_create(lattice, vertex_pattern, &e->pattern));
    tabulate_shapes(e);
    floor_stiffness(e);
    sort_vertices(e);
    if (vertex_pattern) {
        RUGA_TRY_DONE(ruga_embedding_create(e, vertex_pattern));
    }
done:
    if (status != RUGA_OK) {
        ruga_elasticity_destroy(&e);
    }
    *elasticity = e;
    return status;
}

void ruga_elasticity_destroy(ruga_elasticity** elasticity) {
    ruga_elasticity* e = *elasticity;
    if (e) {
        ruga_element_pattern_clear(&e->pattern);
        ruga_release(e->stiffness);
        ruga_release(e->vertex_start);
        ruga_release(e->vertex);
        ruga_release(e->embedded_block);
        ruga_release(e->embedded_link);
        ruga_release(e);
    }
    *elasticity = NULL;
}

const ruga_sparse* ruga_elasticity_pattern(const ruga_elasticity* elasticity) {
    return &elasticity->pattern.matrix;
}

//---- energy ----

// One evaluation, for the bodies of its parallel loops, which see elements [first, first + BATCH).
typedef struct evaluation {
    const ruga_elasticity* e;
    const double* q;
    bool project;
    int first, count;
    double* energy; // [E]
    double* force;  // [E][n][3] the gradient of each element's energy
    double* planes; // [BATCH][6][width][width], components 00 01 02 11 12 22; NULL = no Hessian wanted
    double* hessian;
} evaluation;

// F from differences of q, so that a shift far from the origin costs no digits.
static void deformation_gradient(const ruga_elasticity* e, int g, const double q[][3], double f[9]) {
    const double* gradient = &e->gradient[3 * g * e->width];
    memset(f, 0, 9 * sizeof *f);
    for (int a = 1; a < e->lattice->nodes_per_element; a++) {
        for (int i = 0; i < 3; i++) {
            double d = q[a][i] - q[0][i];
            for (int j = 0; j < 3; j++) {
                f[3 * i + j] += d * gradient[j * e->width + a];
            }
        }
    }
}

// The six planes of an element's stiffness from dP/dF (times weight) at its points.
static void stiffness_planes(const ruga_elasticity* e, const double hessian[][81], double* planes) {
    int w = e->width;
    double right[POINTS * 3 * RUGA_WIDTH_MAX];
    for (int i = 0; i < 3; i++) {
        for (int k = i; k < 3; k++) {
            for (int g = 0; g < POINTS; g++) {
                const double* gradient = &e->gradient[3 * g * w];
                for (int j = 0; j < 3; j++) {
                    const double* h = &hessian[g][9 * (3 * i + j) + 3 * k];
                    double* row = &right[(3 * g + j) * w];
                    for (int b = 0; b < w; b++) {
                        row[b] = h[0] * gradient[b] + h[1] * gradient[w + b] + h[2] * gradient[2 * w + b];
                    }
                }
            }
            memset(planes, 0, (size_t)(w * w) * sizeof *planes);
            ruga_plane_accumulate(3 * POINTS, w, e->gradient, right, i == k, planes);
            if (i == k) {
                ruga_plane_mirror(w, planes, planes);
            }
            planes += w * w;
        }
    }
}

static void evaluate_element(const evaluation* v, int element, double* planes) {
    const ruga_elasticity* e = v->e;
    int n = e->lattice->nodes_per_element;
    double q[RUGA_LATTICE_NODES_MAX][3], hessian[POINTS][81];
    for (int a = 0; a < n; a++) {
        memcpy(q[a], &v->q[3 * e->lattice->element_node[element * n + a]], sizeof q[a]);
    }
    double* force = &v->force[(size_t)element * (size_t)n * 3];
    memset(force, 0, (size_t)n * 3 * sizeof *force);
    double energy = 0;
    for (int g = 0; g < POINTS; g++) {
        double f[9], stress[9], weight = e->stiffness[element * POINTS + g];
        const double* gradient = &e->gradient[3 * g * e->width];
        deformation_gradient(e, g, (const double(*)[3])q, f);
        energy +=
            weight * ruga_corotational(e->mu, e->lambda, f, v->project, stress, planes ? hessian[g] : NULL);
        for (int a = 0; a < n; a++) {
            double x = weight * gradient[a], y = weight * gradient[e->width + a];
            double z = weight * gradient[2 * e->width + a];
            for (int i = 0; i < 3; i++) {
                force[3 * a + i] += stress[3 * i] * x + stress[3 * i + 1] * y + stress[3 * i + 2] * z;
            }
        }
        for (int i = 0; planes && i < 81; i++) {
            hessian[g][i] *= weight;
        }
    }
    v->energy[element] = energy;
    if (planes) {
        stiffness_planes(e, (const double(*)[81])hessian, planes);
    }
}

static void evaluate_elements(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const evaluation* v = context;
    size_t size = 6 * (size_t)(v->e->width * v->e->width);
    for (int k = begin; k < end; k++) {
        evaluate_element(v, v->first + k, v->planes ? v->planes + (size_t)k * size : NULL);
    }
}

// Adds the 3 x 3 block of local nodes a, b. Planes are stored for i <= k; the others are their transposes.
static void add_block(const double* planes, int width, int a, int b, bool diagonal, const int offset[3],
                      double* first) {
    static const int plane[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int c = 0; c < 3; c++) {
        for (int r = diagonal ? c : 0; r < 3; r++) {
            int at = r <= c ? a * width + b : b * width + a;
            first[offset[c] + r] += planes[plane[r][c] * width * width + at];
        }
    }
}

// Each chunk owns the columns of its nodes and goes through the batch in order: one order of sums, whatever
// the number of threads.
static void scatter_stiffness(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const evaluation* v = context;
    const ruga_element_pattern* pattern = &v->e->pattern;
    int n = pattern->nodes_per_element, w = v->e->width;
    for (int k = 0; k < v->count; k++) {
        const int* node = &pattern->element_node[(v->first + k) * n];
        const int* block = &pattern->block[(size_t)pattern->links.start[v->first + k] * (size_t)(n * n)];
        const double* planes = &v->planes[(size_t)k * 6 * (size_t)(w * w)];
        for (int b = 0; b < n; b++) {
            if (node[b] < begin || node[b] >= end) {
                continue;
            }
            int offset[3];
            ruga_block_offsets(&pattern->matrix, node[b], offset);
            for (int a = 0; a < n; a++) {
                if (node[a] >= node[b]) {
                    add_block(planes, w, a, b, a == b, offset, &v->hessian[block[a * n + b]]);
                }
            }
        }
    }
}

static void sum_elements(const evaluation* v, double* energy, double* gradient, double* force_square) {
    const ruga_lattice* lattice = v->e->lattice;
    int n = lattice->nodes_per_element;
    double energy_sum = 0, square_sum = 0;
    if (gradient) {
        memset(gradient, 0, (size_t)lattice->node_count * 3 * sizeof *gradient);
    }
    for (int e = 0; e < lattice->element_count; e++) {
        energy_sum += v->energy[e];
        for (int a = 0; a < n; a++) {
            const double* f = &v->force[((size_t)e * (size_t)n + (size_t)a) * 3];
            double* sum = gradient ? &gradient[3 * lattice->element_node[e * n + a]] : NULL;
            for (int i = 0; i < 3; i++) {
                square_sum += f[i] * f[i];
                if (sum) {
                    sum[i] += f[i];
                }
            }
        }
    }
    if (energy) {
        *energy = energy_sum;
    }
    if (force_square) {
        *force_square = square_sum;
    }
}

ruga_status ruga_elasticity_energy(const ruga_elasticity* elasticity, const double* q, bool project,
                                   double* energy, double* gradient, double* hessian, double* force_square) {
    const ruga_lattice* lattice = elasticity->lattice;
    const ruga_sparse* matrix = &elasticity->pattern.matrix;
    int elements = lattice->element_count, plane = elasticity->width * elasticity->width;
    evaluation v = {.e = elasticity, .q = q, .project = project, .hessian = hessian};
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(RUGA_NEW(v.energy, elements));
    RUGA_TRY_DONE(RUGA_NEW(v.force, (size_t)elements * (size_t)lattice->nodes_per_element * 3));
    if (hessian) {
        RUGA_TRY_DONE(RUGA_NEW(v.planes, (elements < BATCH ? elements : BATCH) * 6 * plane));
        memset(hessian, 0, (size_t)matrix->start[matrix->columns] * sizeof *hessian);
    }
    int batch = hessian ? BATCH : elements;
    for (v.first = 0; v.first < elements; v.first += batch) {
        v.count = elements - v.first < batch ? elements - v.first : batch;
        ruga_parallel_for(v.count, ELEMENT_CHUNK, evaluate_elements, &v);
        if (hessian) {
            ruga_parallel_for(lattice->node_count, ruga_scatter_chunk(elasticity), scatter_stiffness, &v);
        }
    }
    sum_elements(&v, energy, gradient, force_square);
done:
    ruga_release(v.energy);
    ruga_release(v.force);
    ruga_release(v.planes);
    return status;
}
