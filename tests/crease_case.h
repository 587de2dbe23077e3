// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For tests of creases: a mesh, curves on it, and what becomes of them.
#ifndef RUGA_TESTS_CREASE_CASE_H
#define RUGA_TESTS_CREASE_CASE_H

#include "core/memory.h"
#include "core/random.h"
#include "core/vec3.h"
#include "crease/cut.h"
#include "crease/raster.h"
#include "crease/sewing.h"
#include "mesh/make.h"
#include "tests/check.h"
#include "tests/dense.h"

#include <stdlib.h>
#include <string.h>

typedef struct crease_case {
    ruga_mesh mesh;
    ruga_curves curves;
    ruga_raster raster;
    ruga_cut cut;
    ruga_sewing sewing;
} crease_case;

// A sheet of nx x ny squares of side 1, its lower left corner at the origin. rising: mesh diagonals from
// lower left to upper right.
static inline void make_squares(int nx, int ny, bool rising, ruga_mesh* mesh) {
    ruga_mesh_def def = {.vertex_count = (nx + 1) * (ny + 1), .triangle_count = 2 * nx * ny};
    double* x = malloc((size_t)def.vertex_count * 3 * sizeof *x);
    int *t = malloc((size_t)def.triangle_count * 3 * sizeof *t), out = 0;
    for (int v = 0; v < def.vertex_count; v++) {
        x[3 * v] = v % (nx + 1);
        x[3 * v + 1] = v / (nx + 1);
        x[3 * v + 2] = 0;
    }
    for (int k = 0; k < nx * ny; k++) {
        int a = k % nx + (nx + 1) * (k / nx), b = a + 1, c = a + nx + 2, d = a + nx + 1;
        const int corners[2][6] = {{a, b, d, b, c, d}, {a, b, c, a, c, d}};
        memcpy(t + out, corners[rising], sizeof corners[0]);
        out += 6;
    }
    def.positions = x;
    def.triangles = t;
    assert_ok(ruga_mesh_from_def(&def, mesh));
    free(x);
    free(t);
}

static inline void add_line(ruga_curves* curves, ruga_crease_freedom freedom, double x0, double y0, double x1,
                            double y1) {
    const double point[2][3] = {{x0, y0, 0}, {x1, y1, 0}};
    const ruga_curve style = {.freedom = freedom, .label = curves->count};
    assert_ok(ruga_curves_add_polyline(curves, &style, 2, point));
}

static inline void run_case(crease_case* c, const ruga_raster_def* def) {
    assert_ok(ruga_raster_create(&c->mesh, &c->curves, def, &c->raster));
    assert_ok(ruga_cut_create(&c->raster, &c->cut));
    assert_ok(ruga_sewing_create(&c->cut, NULL, &c->sewing));
}

static inline void clear_case(crease_case* c) {
    ruga_mesh_clear(&c->mesh);
    ruga_curves_clear(&c->curves);
    ruga_raster_clear(&c->raster);
    ruga_cut_clear(&c->cut);
    ruga_sewing_clear(&c->sewing);
}

static inline int new_triangles(const crease_case* c) {
    return c->cut.piece_count - c->raster.mesh.triangle_count;
}

static inline int new_nodes(const crease_case* c) {
    return c->cut.node_count - c->raster.mesh.vertex_count;
}

static inline int all_rows(const crease_case* c) {
    return c->sewing.row_count + c->sewing.redundant_rows + c->sewing.fixed_rows;
}

// Rank of W by Gauss elimination with full pivoting: what is left of the freedom that the cut brought is
// new_nodes - rank.
static inline int rank_of_rows(const crease_case* c) {
    const ruga_sewing* s = &c->sewing;
    int rows = s->row_count, columns = c->cut.node_count, rank = 0;
    double* a = calloc((size_t)(rows * columns + 1), sizeof *a);
    for (int r = 0; r < rows; r++) {
        for (int k = s->start[r]; k < s->start[r + 1]; k++) {
            a[r * columns + s->node[k]] += s->weight[k];
        }
    }
    while (rank < rows && rank < columns) {
        int row = -1, column = -1;
        double most = 1e-9;
        for (int i = rank; i < rows; i++) {
            for (int j = rank; j < columns; j++) {
                if (fabs(a[i * columns + j]) > most) {
                    most = fabs(a[i * columns + j]);
                    row = i;
                    column = j;
                }
            }
        }
        if (row < 0) {
            break;
        }
        for (int j = 0; j < columns; j++) {
            double swap = a[row * columns + j];
            a[row * columns + j] = a[rank * columns + j];
            a[rank * columns + j] = swap;
        }
        for (int i = 0; i < rows; i++) {
            double swap = a[i * columns + column];
            a[i * columns + column] = a[i * columns + rank];
            a[i * columns + rank] = swap;
        }
        for (int i = rank + 1; i < rows; i++) {
            double factor = a[i * columns + rank] / a[rank * columns + rank];
            for (int j = rank; j < columns && factor != 0; j++) {
                a[i * columns + j] -= factor * a[rank * columns + j];
            }
        }
        rank++;
    }
    free(a);
    return rank;
}

static inline int freedom_of(const crease_case* c) {
    return new_nodes(c) - rank_of_rows(c);
}

#endif
