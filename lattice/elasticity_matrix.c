// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Mass        M_ab = sum over points of density v_eg N_a N_b + sum over vertices of m_v B_va B_vb
// Embedded    B^T K B = X + X^T,   X = sum over stored blocks (i, j) of B_i^T K_ij B_j, diagonal blocks
// halved
//
// A block K_ij couples the nodes of the elements of i and of j only. Blocks are grouped by this ordered pair
// of elements; within a group all blocks of the same column vertex j are first summed to T_j = sum of B_i^T
// K_ij (81 x 3), so that the costly outer product T_j B_j is made once for each vertex and neighbouring
// element.
#include "lattice/elasticity_internal.h"

#include "core/memory.h"
#include "core/parallel.h"

#include <string.h>

enum { POINTS = RUGA_LATTICE_POINTS, MASS_BATCH = 64, GROUP_BATCH = 32, ROWS = 16 };

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
        ruga_plane_mirror(w, plane);
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

// A 3 x 3 block of the vertex matrix.
typedef struct vertex_block {
    int row, column; // vertices
    int first;       // position of its first entry
} vertex_block;

// Group 2 link: row in the link's higher element; 2 link + 1: in the lower one.
typedef struct embedding {
    const ruga_elasticity* e;
    const ruga_sparse* k;
    double* hessian;
    vertex_block* block; // [blocks] by group, each in the order of the columns
    int* group_start;    // [2 links + 1]
    int* group;          // groups that have blocks
    int* high;           // [links] higher element of each link
    int* low;            // [links]
    double* planes;      // [GROUP_BATCH][9][width][width], component row * 3 + column
    int group_count, first, count;
} embedding;

static int group_of(const embedding* m, int row, int column) {
    int row_element = m->e->lattice->vertex_element[row];
    int column_element = m->e->lattice->vertex_element[column];
    int link = ruga_link_find(&m->e->pattern, row_element, column_element);
    return link < 0 ? -1 : 2 * link + (row_element < column_element);
}

static ruga_status count_groups(embedding* m) {
    for (int j = 0; j < m->k->columns / 3; j++) {
        for (int p = m->k->start[3 * j]; p < m->k->start[3 * j + 1]; p += 3) {
            int group = group_of(m, m->k->index[p] / 3, j);
            if (group < 0) {
                return ruga_fail(RUGA_BAD_INPUT,
                                 "vertices %d and %d are coupled, but their lattice elements are not: "
                                 "create the elasticity with this matrix's pattern",
                                 m->k->index[p] / 3, j);
            }
            m->group_start[group + 1]++;
        }
    }
    return RUGA_OK;
}

// Counting sort of the vertex blocks by group.
static ruga_status sort_blocks(embedding* m) {
    int groups = 2 * m->e->pattern.links.start[m->e->pattern.links.columns];
    RUGA_TRY(RUGA_NEW_ZERO(m->group_start, groups + 2));
    RUGA_TRY(count_groups(m));
    RUGA_TRY(RUGA_NEW(m->group, groups));
    for (int g = 0; g < groups; g++) {
        if (m->group_start[g + 1] > 0) {
            m->group[m->group_count++] = g;
        }
        m->group_start[g + 1] += m->group_start[g];
    }
    RUGA_TRY(RUGA_NEW(m->block, m->group_start[groups]));
    // Filled shifted by one, so that the fill marks end as the beginnings.
    memmove(m->group_start + 1, m->group_start, (size_t)(groups + 1) * sizeof *m->group_start);
    for (int j = 0; j < m->k->columns / 3; j++) {
        for (int p = m->k->start[3 * j]; p < m->k->start[3 * j + 1]; p += 3) {
            int row = m->k->index[p] / 3;
            m->block[m->group_start[group_of(m, row, j) + 1]++] = (vertex_block){row, j, p};
        }
    }
    return RUGA_OK;
}

static ruga_status name_links(embedding* m) {
    const ruga_sparse* links = &m->e->pattern.links;
    RUGA_TRY(RUGA_NEW(m->high, links->start[links->columns]));
    RUGA_TRY(RUGA_NEW(m->low, links->start[links->columns]));
    for (int low = 0; low < links->columns; low++) {
        for (int k = links->start[low]; k < links->start[low + 1]; k++) {
            m->high[k] = links->index[k];
            m->low[k] = low;
        }
    }
    return RUGA_OK;
}

static void read_block(const ruga_sparse* k, const vertex_block* block, double value[9]) {
    int offset[3];
    ruga_block_offsets(k, block->column, offset);
    for (int c = 0; c < 3; c++) {
        for (int r = 0; r < 3; r++) {
            if (block->row != block->column) {
                value[3 * r + c] = k->value[block->first + offset[c] + r];
            } else {
                int low = r < c ? r : c, high = r + c - low;
                value[3 * r + c] = 0.5 * k->value[block->first + offset[low] + high];
            }
        }
    }
}

// X of one group. T_j of ROWS column vertices are gathered, then multiplied at once.
static void form_group(const embedding* m, int group, double* planes) {
    const ruga_elasticity* e = m->e;
    int w = e->width, n = e->lattice->nodes_per_element, rows = 0;
    double left[9 * ROWS * RUGA_WIDTH_MAX], right[ROWS * RUGA_WIDTH_MAX];
    memset(planes, 0, 9 * (size_t)(w * w) * sizeof *planes);
    for (int at = m->group_start[group], end = m->group_start[group + 1]; at < end;) {
        int column = m->block[at].column;
        for (int p = 0; p < 9; p++) {
            memset(&left[(p * ROWS + rows) * w], 0, (size_t)w * sizeof *left);
        }
        for (; at < end && m->block[at].column == column; at++) {
            const double* weight = &e->lattice->vertex_weight[(size_t)m->block[at].row * (size_t)n];
            double value[9];
            read_block(m->k, &m->block[at], value);
            for (int p = 0; p < 9; p++) {
                double* sum = &left[(p * ROWS + rows) * w];
                for (int a = 0; a < n; a++) {
                    sum[a] += value[p] * weight[a];
                }
            }
        }
        vertex_row(e, column, 1, &right[rows * w]);
        rows++;
        if (rows == ROWS || at == end) {
            for (int p = 0; p < 9; p++) {
                ruga_plane_accumulate(rows, w, &left[p * ROWS * w], right, false, &planes[p * w * w]);
            }
            rows = 0;
        }
    }
}

static void form_groups(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const embedding* m = context;
    size_t size = 9 * (size_t)(m->e->width * m->e->width);
    for (int k = begin; k < end; k++) {
        form_group(m, m->group[m->first + k], m->planes + (size_t)k * size);
    }
}

// Adds block (a, b) of X and its transpose, where they are in the lower triangle: x is its entry of plane 0.
static void add_with_transpose(const double* x, int plane, int row_node, int column_node, const int offset[3],
                               double* first) {
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            double value = x[(3 * r + c) * plane];
            if (row_node > column_node) {
                first[offset[c] + r] += value;
            } else if (row_node < column_node) {
                first[offset[r] + c] += value;
            } else if (r >= c) {
                first[offset[c] + r] += value + x[(3 * c + r) * plane];
            }
        }
    }
}

static void scatter_group(const embedding* m, int group, const double* planes, int begin, int end) {
    const ruga_element_pattern* pattern = &m->e->pattern;
    int n = pattern->nodes_per_element, w = m->e->width, link = group / 2;
    bool swapped = group % 2;
    const int* row_node = &pattern->element_node[(swapped ? m->low : m->high)[link] * n];
    const int* column_node = &pattern->element_node[(swapped ? m->high : m->low)[link] * n];
    const int* block = &pattern->block[(size_t)link * (size_t)(n * n)];
    for (int a = 0; a < n; a++) {
        for (int b = 0; b < n; b++) {
            int low = row_node[a] < column_node[b] ? row_node[a] : column_node[b];
            if (low >= begin && low < end) {
                int offset[3];
                ruga_block_offsets(&pattern->matrix, low, offset);
                int first = block[swapped ? b * n + a : a * n + b];
                add_with_transpose(&planes[a * w + b], w * w, row_node[a], column_node[b], offset,
                                   &m->hessian[first]);
            }
        }
    }
}

static void scatter_groups(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const embedding* m = context;
    size_t size = 9 * (size_t)(m->e->width * m->e->width);
    for (int k = 0; k < m->count; k++) {
        scatter_group(m, m->group[m->first + k], m->planes + (size_t)k * size, begin, end);
    }
}

ruga_status ruga_elasticity_add_embedded(const ruga_elasticity* elasticity, const ruga_sparse* vertex_matrix,
                                         double* hessian) {
    RUGA_ASSERT(vertex_matrix->columns == 3 * elasticity->lattice->vertex_count);
    embedding m = {.e = elasticity, .k = vertex_matrix, .hessian = hessian};
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(sort_blocks(&m));
    RUGA_TRY_DONE(name_links(&m));
    RUGA_TRY_DONE(RUGA_NEW(m.planes, GROUP_BATCH * 9 * elasticity->width * elasticity->width));
    for (m.first = 0; m.first < m.group_count; m.first += GROUP_BATCH) {
        m.count = m.group_count - m.first < GROUP_BATCH ? m.group_count - m.first : GROUP_BATCH;
        ruga_parallel_for(m.count, 1, form_groups, &m);
        ruga_parallel_for(elasticity->lattice->node_count, ruga_scatter_chunk(elasticity), scatter_groups,
                          &m);
    }
done:
    ruga_release(m.block);
    ruga_release(m.group_start);
    ruga_release(m.group);
    ruga_release(m.high);
    ruga_release(m.low);
    ruga_release(m.planes);
    return status;
}
