// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Mass        M_ab = sum over points of density v_eg N_a N_b + sum over vertices of m_v B_va B_vb
// Embedded    B^T K B = sum over elements e of X_ee + sum over linked elements e > f of X_ef + X_ef^T,
//             X_ef = sum over blocks K_ij with vertex i in e and j in f of B_i^T K_ij B_j
//
// All blocks of a link with the same column vertex j are first summed to T_j = sum of B_i^T K_ij (81 x 3), so
// that the costly outer product T_j B_j is made once for each vertex and neighbouring element. X_ee is
// symmetric: six of its nine planes are made, three of them by half.
#include "lattice/elasticity_internal.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/wide.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS = RUGA_LATTICE_POINTS, MASS_BATCH = 64, LINK_BATCH = 32, ROWS = 16, COLUMNS = 32 };

//---- mass ----

typedef struct mass_work {
    const ruga_elasticity* e;
    double density;
    const double* vertex_mass;
    int first, count;
    double* planes; // [MASS_BATCH][width][width]
    double* mass;
} mass_work;

// Copies a vertex's row of B to `width` columns, times a factor.
static void vertex_row(const ruga_elasticity* e, int vertex, double factor, double* row) {
    int n = e->lattice->nodes_per_element;
    const double* weight = &e->lattice->vertex_weight[(size_t)vertex * (size_t)n];
    for (int a = 0; a < n; a++) {
        row[a] = factor * weight[a];
    }
    for (int a = n; a < e->width; a++) {
        row[a] = 0;
    }
}

static void element_masses(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const mass_work* work = context;
    const ruga_elasticity* e = work->e;
    int w = e->width;
    double left[POINTS * RUGA_WIDTH_MAX], right[ROWS * RUGA_WIDTH_MAX];
    for (int k = begin; k < end; k++) {
        int element = work->first + k;
        double* plane = &work->planes[(size_t)k * (size_t)(w * w)];
        memset(plane, 0, (size_t)(w * w) * sizeof *plane);
        for (int g = 0; g < POINTS; g++) {
            double m = work->density * e->lattice->volume[element * POINTS + g];
            for (int a = 0; a < w; a++) {
                left[g * w + a] = m * e->weight[g * w + a];
            }
        }
        ruga_plane_accumulate(POINTS, w, left, e->weight, true, plane);
        int last = work->vertex_mass ? e->vertex_start[element + 1] : 0;
        for (int at = e->vertex_start[element]; at < last; at += ROWS) {
            int rows = last - at < ROWS ? last - at : ROWS;
            for (int r = 0; r < rows; r++) {
                int vertex = e->vertex[at + r];
                vertex_row(e, vertex, work->vertex_mass[vertex], &left[r * w]);
                vertex_row(e, vertex, 1, &right[r * w]);
            }
            ruga_plane_accumulate(rows, w, left, right, true, plane);
        }
        ruga_plane_mirror(w, plane, plane);
    }
}

static void scatter_mass(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const mass_work* work = context;
    const ruga_element_pattern* pattern = &work->e->pattern;
    int n = pattern->nodes_per_element, w = work->e->width;
    for (int k = 0; k < work->count; k++) {
        const int* node = &pattern->element_node[(work->first + k) * n];
        const int* block = &pattern->block[(size_t)pattern->links.start[work->first + k] * (size_t)(n * n)];
        const double* plane = &work->planes[(size_t)k * (size_t)(w * w)];
        for (int b = 0; b < n; b++) {
            if (node[b] < begin || node[b] >= end) {
                continue;
            }
            int offset[3];
            ruga_block_offsets(&pattern->matrix, node[b], offset);
            for (int a = 0; a < n; a++) {
                for (int c = 0; c < 3 && node[a] >= node[b]; c++) {
                    work->mass[block[a * n + b] + offset[c] + c] += plane[a * w + b];
                }
            }
        }
    }
}

ruga_status ruga_elasticity_mass(const ruga_elasticity* elasticity, double density, const double* vertex_mass,
                                 double* mass) {
    const ruga_sparse* matrix = &elasticity->pattern.matrix;
    int elements = elasticity->lattice->element_count;
    mass_work work = {.e = elasticity, .density = density, .vertex_mass = vertex_mass, .mass = mass};
    RUGA_TRY(RUGA_NEW(work.planes, MASS_BATCH * elasticity->width * elasticity->width));
    memset(mass, 0, (size_t)matrix->start[matrix->columns] * sizeof *mass);
    for (work.first = 0; work.first < elements; work.first += MASS_BATCH) {
        work.count = elements - work.first < MASS_BATCH ? elements - work.first : MASS_BATCH;
        ruga_parallel_for(work.count, 2, element_masses, &work);
        ruga_parallel_for(elasticity->lattice->node_count, ruga_scatter_chunk(elasticity), scatter_mass,
                          &work);
    }
    ruga_release(work.planes);
    return RUGA_OK;
}

//---- embedded vertex matrices ----

// By link, and within a link by column.
static int compare_blocks(const void* left, const void* right) {
    const ruga_embedded_block *a = left, *b = right;
    int by_link = (a->link > b->link) - (a->link < b->link);
    int by_column = (a->column > b->column) - (a->column < b->column);
    return by_link ? by_link : by_column ? by_column : (a->row > b->row) - (a->row < b->row);
}

ruga_status ruga_embedding_create(ruga_elasticity* e, const ruga_sparse* k) {
    const int* element = e->lattice->vertex_element;
    int entries = k->start[k->columns], most = 2 * (entries / 9 + k->columns / 3);
    e->embedding_entries = entries;
    RUGA_TRY(RUGA_NEW(e->embedded_block, most));
    for (int j = 0; j < k->columns / 3; j++) {
        for (int p = k->start[3 * j]; p < k->start[3 * j + 1]; p += 3) {
            int i = k->index[p] / 3, link = ruga_link_find(&e->pattern, element[i], element[j]);
            if (element[i] >= element[j]) {
                e->embedded_block[e->embedded_count++] = (ruga_embedded_block){link, i, j, p};
            }
            if (element[i] <= element[j] && i != j) {
                e->embedded_block[e->embedded_count++] = (ruga_embedded_block){link, j, i, p};
            }
        }
    }
    qsort(e->embedded_block, (size_t)e->embedded_count, sizeof *e->embedded_block, compare_blocks);
    RUGA_TRY(RUGA_NEW(e->embedded_link, e->pattern.links.start[e->pattern.links.columns] + 1));
    for (int b = 0; b < e->embedded_count; b++) {
        if (b == 0 || e->embedded_block[b].link != e->embedded_block[b - 1].link) {
            e->embedded_link[e->embedded_link_count++] = b;
        }
    }
    e->embedded_link[e->embedded_link_count] = e->embedded_count;
    return RUGA_OK;
}

typedef struct embedding {
    const ruga_elasticity* e;
    const ruga_sparse* k;
    double* hessian;
    double* planes; // [LINK_BATCH][9][width][width], component row * 3 + column; of X_ee only row <= column
    int first, count;
} embedding;

// K is read as the caller gives it, so its pattern is compared with the one that the blocks were listed from.
static bool has_known_pattern(const ruga_elasticity* e, const ruga_sparse* k) {
    if (k->start[k->columns] != e->embedding_entries) {
        return false;
    }
    for (int b = 0; b < e->embedded_count; b++) {
        const ruga_embedded_block* block = &e->embedded_block[b];
        int low = block->row < block->column ? block->row : block->column,
            high = block->row + block->column - low;
        if (block->first < k->start[3 * low] || block->first >= k->start[3 * low + 1] ||
            k->index[block->first] != 3 * high) {
            return false;
        }
    }
    return true;
}

static void read_block(const ruga_sparse* k, const ruga_embedded_block* block, double value[9]) {
    int offset[3], low = block->row < block->column ? block->row : block->column;
    ruga_block_offsets(k, low, offset);
    for (int c = 0; c < 3; c++) {
        for (int r = 0; r < 3; r++) {
            bool turned = block->row < block->column || (block->row == block->column && r < c);
            value[3 * r + c] = k->value[block->first + (turned ? offset[r] + c : offset[c] + r)];
        }
    }
}

// One column's T in rows of sum [9][stride] from blocks [count], all of the same column.
RUGA_WIDE static void sum_column(const ruga_elasticity* e, const ruga_sparse* k, int count,
                                 const ruga_embedded_block* block, int stride, double* sum) {
    int w = e->width, n = e->lattice->nodes_per_element;
    double weight[RUGA_WIDTH_MAX] = {0}, value[9];
    for (int m = 0; m < count; m++) {
        memcpy(weight, &e->lattice->vertex_weight[(size_t)block[m].row * (size_t)n],
               (size_t)n * sizeof *weight);
        read_block(k, &block[m], value);
        for (int p = 0; p < 9; p++) {
            double* row = &sum[p * stride];
            for (int a = 0; a < w; a++) {
                row[a] = (m > 0 ? row[a] : 0) + value[p] * weight[a];
            }
        }
    }
}

// X of one link. T_j of COLUMNS column vertices are gathered, then multiplied at once.
static void form_link(const ruga_elasticity* e, const ruga_sparse* k, int begin, int end, double* planes) {
    const ruga_embedded_block* block = e->embedded_block;
    const int* element = e->lattice->vertex_element;
    int w = e->width, rows = 0;
    bool symmetric = element[block[begin].row] == element[block[begin].column];
    double left[9 * COLUMNS * RUGA_WIDTH_MAX], right[COLUMNS * RUGA_WIDTH_MAX];
    memset(planes, 0, 9 * (size_t)(w * w) * sizeof *planes);
    for (int at = begin; at < end;) {
        int first = at, column = block[first].column;
        while (at < end && block[at].column == column) {
            at++;
        }
        sum_column(e, k, at - first, &block[first], COLUMNS * w, &left[rows * w]);
        vertex_row(e, column, 1, &right[rows * w]);
        rows++;
        if (rows == COLUMNS || at == end) {
            for (int p = 0; p < 9; p++) {
                if (!symmetric || p / 3 <= p % 3) {
                    ruga_plane_accumulate(rows, w, &left[p * COLUMNS * w], right, symmetric && p % 4 == 0,
                                          &planes[p * w * w]);
                }
            }
            rows = 0;
        }
    }
    for (int r = 0; r < 3 && symmetric; r++) {
        for (int c = 0; c <= r; c++) {
            ruga_plane_mirror(w, &planes[(3 * c + r) * w * w], &planes[(3 * r + c) * w * w]);
        }
    }
}

static void form_links(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const embedding* m = context;
    const int* start = m->e->embedded_link;
    size_t size = 9 * (size_t)(m->e->width * m->e->width);
    for (int l = begin; l < end; l++) {
        form_link(m->e, m->k, start[m->first + l], start[m->first + l + 1], m->planes + (size_t)l * size);
    }
}

// Adds block (a, b) of X, x its entry of plane 0, to a block of the lower triangle; turned: its transpose.
static void add_block(const double* x, int plane, bool turned, const int offset[3], double* first) {
    int down = turned ? plane : 3 * plane, across = 4 * plane - down;
    for (int c = 0; c < 3; c++) {
        for (int r = 0; r < 3; r++) {
            first[offset[c] + r] += x[r * down + c * across];
        }
    }
}

// The same to a block on the diagonal, of which the lower half is stored.
static void add_to_diagonal(const double* x, int plane, bool turned, const int offset[3], double* first) {
    for (int c = 0; c < 3; c++) {
        for (int r = c; r < 3; r++) {
            first[offset[c] + r] += x[(turned ? 3 * c + r : 3 * r + c) * plane];
        }
    }
}

static void scatter_link(const embedding* m, const ruga_embedded_block* one, const double* planes, int begin,
                         int end) {
    const ruga_element_pattern* pattern = &m->e->pattern;
    const int* element = m->e->lattice->vertex_element;
    int n = pattern->nodes_per_element, w = m->e->width, high = element[one->row], low = element[one->column];
    const int *row_node = &pattern->element_node[high * n], *column_node = &pattern->element_node[low * n];
    const int* block = &pattern->block[(size_t)one->link * (size_t)(n * n)];
    // Columns of nodes in [begin, end), and then those above: with a row inside, all of them meet the range.
    int column[RUGA_WIDTH_MAX], inside = 0, all;
    for (int b = 0; b < n; b++) {
        column[inside] = b;
        inside += column_node[b] >= begin && column_node[b] < end;
    }
    all = inside;
    for (int b = 0; b < n; b++) {
        column[all] = b;
        all += column_node[b] >= end;
    }
    for (int a = 0; a < n; a++) {
        int count = row_node[a] < begin ? 0 : row_node[a] < end ? all : inside;
        for (int i = 0; i < count; i++) {
            int b = column[i], offset[3];
            ruga_block_offsets(&pattern->matrix, row_node[a] < column_node[b] ? row_node[a] : column_node[b],
                               offset);
            const double* x = &planes[a * w + b];
            double* first = &m->hessian[block[a * n + b]];
            if (row_node[a] != column_node[b]) {
                if (high != low || row_node[a] > column_node[b]) {
                    add_block(x, w * w, row_node[a] < column_node[b], offset, first);
                }
                continue;
            }
            for (int turn = 0; turn <= (high != low); turn++) {
                add_to_diagonal(x, w * w, turn, offset, first);
            }
        }
    }
}

static void scatter_links(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const embedding* m = context;
    const ruga_elasticity* e = m->e;
    size_t size = 9 * (size_t)(e->width * e->width);
    for (int l = 0; l < m->count; l++) {
        scatter_link(m, &e->embedded_block[e->embedded_link[m->first + l]], m->planes + (size_t)l * size,
                     begin, end);
    }
}

ruga_status ruga_elasticity_add_embedded(const ruga_elasticity* e, const ruga_sparse* vertex_matrix,
                                         double* hessian) {
    RUGA_ASSERT(vertex_matrix->columns == 3 * e->lattice->vertex_count);
    if (!has_known_pattern(e, vertex_matrix)) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "the vertex matrix has another pattern than the one that the lattice's "
                         "elasticity was created with: create it with this matrix's pattern");
    }
    embedding m = {.e = e, .k = vertex_matrix, .hessian = hessian};
    RUGA_TRY(RUGA_NEW(m.planes, LINK_BATCH * 9 * e->width * e->width));
    for (m.first = 0; m.first < e->embedded_link_count; m.first += LINK_BATCH) {
        m.count =
            e->embedded_link_count - m.first < LINK_BATCH ? e->embedded_link_count - m.first : LINK_BATCH;
        ruga_parallel_for(m.count, 1, form_links, &m);
        ruga_parallel_for(e->lattice->node_count, ruga_scatter_chunk(e), scatter_links, &m);
    }
    ruga_release(m.planes);
    return RUGA_OK;
}
