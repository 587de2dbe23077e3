// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// For tests: a box of full cells as a lattice made by hand, with some surface vertices in it.
#ifndef RUGA_TESTS_BOX_LATTICE_H
#define RUGA_TESTS_BOX_LATTICE_H

#include "core/memory.h"
#include "core/random.h"
#include "lattice/lattice.h"
#include "tests/check.h"

static inline void box_fill_element(ruga_lattice* lattice, int e) {
    static const double gauss[3] = {5. / 18, 8. / 18, 5. / 18};
    int n = lattice->degree + 1, npe = lattice->nodes_per_element;
    const int* cells = lattice->cells;
    int cell[3] = {e % cells[0], e / cells[0] % cells[1], e / cells[0] / cells[1]};
    for (int a = 0; a < npe; a++) {
        int i = cell[0] + a % n, j = cell[1] + a / n % n, k = cell[2] + a / n / n;
        lattice->element_node[e * npe + a] =
            i + (cells[0] + lattice->degree) * (j + (cells[1] + lattice->degree) * k);
    }
    for (int g = 0; g < 27; g++) {
        lattice->volume[e * 27 + g] = lattice->cell_size[0] * lattice->cell_size[1] * lattice->cell_size[2] *
                                      gauss[g % 3] * gauss[g / 3 % 3] * gauss[g / 9];
    }
    for (int i = 0; i < 3; i++) {
        lattice->element_cell[3 * e + i] = cell[i];
    }
}

// nx x ny x nz full cells, `vertices` surface vertices at random places of random elements.
static inline void box_lattice(int degree, int nx, int ny, int nz, int vertices, ruga_lattice* lattice) {
    *lattice = (ruga_lattice){.degree = degree,
                              .nodes_per_element = degree == 2 ? 27 : 8,
                              .origin = {0.3, -0.2, 0.1},
                              .cell_size = {1, 0.8, 1.25},
                              .cells = {nx, ny, nz},
                              .element_count = nx * ny * nz,
                              .node_count = (nx + degree) * (ny + degree) * (nz + degree),
                              .vertex_count = vertices};
    int npe = lattice->nodes_per_element, elements = lattice->element_count;
    assert_ok(RUGA_NEW(lattice->element_cell, elements * 3));
    assert_ok(RUGA_NEW(lattice->element_node, elements * npe));
    assert_ok(RUGA_NEW(lattice->volume, elements * 27));
    assert_ok(RUGA_NEW(lattice->rest, lattice->node_count * 3));
    assert_ok(RUGA_NEW(lattice->vertex_element, vertices));
    assert_ok(RUGA_NEW(lattice->vertex_weight, vertices * npe));
    for (int e = 0; e < elements; e++) {
        box_fill_element(lattice, e);
    }
    for (int a = 0; a < lattice->node_count; a++) {
        int at[3] = {a % (nx + degree), a / (nx + degree) % (ny + degree), a / (nx + degree) / (ny + degree)};
        for (int i = 0; i < 3; i++) {
            lattice->rest[3 * a + i] =
                lattice->origin[i] + (at[i] - (degree == 2 ? 0.5 : 0)) * lattice->cell_size[i];
        }
    }
    ruga_random random = {7};
    for (int v = 0; v < vertices; v++) {
        double xi[3];
        for (int i = 0; i < 3; i++) {
            xi[i] = ruga_random_uniform(&random);
        }
        lattice->vertex_element[v] = (int)(ruga_random_uniform(&random) * elements);
        ruga_lattice_shape(lattice, xi, &lattice->vertex_weight[v * npe], NULL);
    }
}

// q = f (X - origin) + origin, plus noise
static inline void box_deform(const ruga_lattice* lattice, const double f[9], double noise, double* q) {
    ruga_random random = {11};
    for (int a = 0; a < lattice->node_count; a++) {
        for (int i = 0; i < 3; i++) {
            q[3 * a + i] = lattice->origin[i] + noise * (2 * ruga_random_uniform(&random) - 1);
            for (int j = 0; j < 3; j++) {
                q[3 * a + i] += f[3 * i + j] * (lattice->rest[3 * a + j] - lattice->origin[j]);
            }
        }
    }
}

#endif
