// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The lattice against a reference that knows nothing of surfaces: bodies made of boxes, cut into finer boxes
// by all planes and flooded.
#include "tests/check.h"

#include "core/memory.h"
#include "core/random.h"
#include "core/vec3.h"
#include "lattice/assemble.h"
#include "lattice/union_find.h"

#include <stdlib.h>
#include <string.h>

// ---- bodies of boxes ----

enum { SIDE_MAX = 12, BREAKS_MAX = 80 };

typedef struct blocks {
    int size[3];
    double coordinate[3][SIDE_MAX + 1];
    bool solid[SIDE_MAX][SIDE_MAX][SIDE_MAX]; // [x][y][z]
} blocks;

static bool solid_at(const blocks* b, int x, int y, int z) {
    bool in = x >= 0 && y >= 0 && z >= 0 && x < b->size[0] && y < b->size[1] && z < b->size[2];
    return in && b->solid[x][y][z];
}

// The boundary of the body, two triangles a face, outward.
static void blocks_mesh(const blocks* b, ruga_mesh* mesh, ruga_connectivity* connectivity) {
    int(*number)[SIDE_MAX + 1][SIDE_MAX + 1] = malloc(sizeof(int[SIDE_MAX + 1][SIDE_MAX + 1][SIDE_MAX + 1]));
    memset(number, -1, sizeof(int[SIDE_MAX + 1][SIDE_MAX + 1][SIDE_MAX + 1]));
    size_t most = (size_t)b->size[0] * (size_t)b->size[1] * (size_t)b->size[2];
    double* position = malloc(sizeof(double) * 3 * 24 * most);
    int* triangle = malloc(sizeof(int) * 3 * 12 * most);
    ruga_mesh_def def = {0};
    for (int x = 0; x < b->size[0]; x++) {
        for (int y = 0; y < b->size[1]; y++) {
            for (int z = 0; z < b->size[2]; z++) {
                for (int f = 0; f < 6 && b->solid[x][y][z]; f++) {
                    int axis = f / 2, step[3] = {0, 0, 0}, corner[4];
                    step[axis] = f % 2 ? 1 : -1;
                    if (solid_at(b, x + step[0], y + step[1], z + step[2])) {
                        continue;
                    }
                    for (int c = 0; c < 4; c++) {
                        int at[3] = {x, y, z};
                        at[axis] += f % 2;
                        at[(axis + 1) % 3] += c == 1 || c == 2;
                        at[(axis + 2) % 3] += c >= 2;
                        int* n = &number[at[0]][at[1]][at[2]];
                        if (*n < 0) {
                            *n = def.vertex_count++;
                            for (int i = 0; i < 3; i++) {
                                position[3 * *n + i] = b->coordinate[i][at[i]];
                            }
                        }
                        corner[c] = *n;
                    }
                    int order[6] = {0, 1, 2, 0, 2, 3};
                    for (int i = 0; i < 6; i++) {
                        triangle[6 * (def.triangle_count / 2) + (f % 2 ? i : 5 - i)] = corner[order[i]];
                    }
                    def.triangle_count += 2;
                }
            }
        }
    }
    def.positions = position;
    def.triangles = triangle;
    assert_ok(ruga_mesh_from_def(&def, mesh));
    assert_ok(ruga_connectivity_create(mesh, connectivity));
    free(number);
    free(position);
    free(triangle);
}

// Fills in until the boundary is a manifold: no two blocks that meet only along an edge or at a corner.
static void make_manifold(blocks* b) {
    bool changed = true;
    while (changed) {
        changed = false;
        for (int x = 0; x + 1 < b->size[0]; x++) {
            for (int y = 0; y + 1 < b->size[1]; y++) {
                for (int z = 0; z + 1 < b->size[2]; z++) {
                    // All pairs of opposite corners of 1 x 2 x 2 and 2 x 2 x 2 groups, inside and outside
                    // alike.
                    bool* cell[8];
                    int parent[8], inside = -1, outside = -1;
                    ruga_sets_reset(parent, 8);
                    for (int i = 0; i < 8; i++) {
                        cell[i] = &b->solid[x + i % 2][y + i / 2 % 2][z + i / 4];
                    }
                    for (int i = 0; i < 8; i++) {
                        for (int bit = 1; bit < 8; bit *= 2) {
                            if (*cell[i] == *cell[i ^ bit]) {
                                ruga_sets_unite(parent, i, i ^ bit);
                            }
                        }
                    }
                    bool bad = false;
                    for (int i = 0; i < 8; i++) {
                        int* first = *cell[i] ? &inside : &outside;
                        *first = *first < 0 ? ruga_sets_find(parent, i) : *first;
                        bad = bad || *first != ruga_sets_find(parent, i);
                    }
                    for (int i = 0; i < 8; i++) {
                        for (int j = i + 1; j < 8; j++) { // edge diagonals
                            int d = i ^ j;
                            bool diagonal = d == 3 || d == 5 || d == 6;
                            int k = i ^ (d & -d);
                            bad = bad || (diagonal && *cell[i] == *cell[j] && *cell[k] == *cell[i ^ j ^ k] &&
                                          *cell[k] != *cell[i]);
                        }
                    }
                    for (int i = 0; bad && i < 8; i++) {
                        *cell[i] = true;
                        changed = true;
                    }
                }
            }
        }
    }
}

// ---- the reference ----

typedef struct reference {
    int breaks[3]; // boxes along each axis
    double at[3][BREAKS_MAX];
    int cells[3];
    int* label;     // [boxes] component, -1 = empty
    int count;      // components
    int* cell;      // [count][3]
    double* volume; // [count][27]
} reference;

static int compare_doubles(const void* a, const void* b) {
    double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

static int interval_of(const double* at, int count, double value) {
    int i = 0;
    while (i + 1 < count && at[i + 1] <= value) {
        i++;
    }
    return i;
}

static size_t box_number(const reference* r, const int at[3]) {
    return (size_t)at[0] + (size_t)r->breaks[0] * ((size_t)at[1] + (size_t)r->breaks[1] * (size_t)at[2]);
}

static double middle(const reference* r, int axis, int i) {
    return (r->at[axis][i] + r->at[axis][i + 1]) / 2;
}

static void reference_boxes(const blocks* b, reference* r, const double (*u)[SIDE_MAX + 1]) {
    for (int axis = 0; axis < 3; axis++) {
        int n = 0;
        for (int k = 0; k <= 3 * r->cells[axis]; k++) {
            r->at[axis][n++] = ruga_slice_plane(k);
        }
        for (int k = 0; k <= b->size[axis]; k++) {
            r->at[axis][n++] = u[axis][k];
        }
        assert_true(n < BREAKS_MAX);
        qsort(r->at[axis], (size_t)n, sizeof(double), compare_doubles);
        int kept = 1;
        for (int i = 1; i < n; i++) {
            if (r->at[axis][i] - r->at[axis][kept - 1] > 1e-12) {
                r->at[axis][kept++] = r->at[axis][i];
            }
        }
        r->breaks[axis] = kept - 1;
    }
    size_t total = (size_t)r->breaks[0] * (size_t)r->breaks[1] * (size_t)r->breaks[2];
    r->label = malloc(total * sizeof(int));
    int at[3];
    for (at[2] = 0; at[2] < r->breaks[2]; at[2]++) {
        for (at[1] = 0; at[1] < r->breaks[1]; at[1]++) {
            for (at[0] = 0; at[0] < r->breaks[0]; at[0]++) {
                int block[3];
                bool in = true;
                for (int axis = 0; axis < 3; axis++) {
                    double m = middle(r, axis, at[axis]);
                    in = in && m > u[axis][0] && m < u[axis][b->size[axis]];
                    block[axis] = interval_of(u[axis], b->size[axis], m);
                }
                size_t n = box_number(r, at);
                r->label[n] = in && b->solid[block[0]][block[1]][block[2]] ? (int)n : -1;
            }
        }
    }
}

// Visits each pair of neighbouring full boxes: joins the labels of those in one cell (visit NULL), or calls
// visit(context, label low, label high, axis) for those in different cells.
static void each_pair(const reference* r, int* parent, void (*visit)(void*, int, int, int), void* context) {
    int at[3];
    for (at[2] = 0; at[2] < r->breaks[2]; at[2]++) {
        for (at[1] = 0; at[1] < r->breaks[1]; at[1]++) {
            for (at[0] = 0; at[0] < r->breaks[0]; at[0]++) {
                for (int axis = 0; axis < 3; axis++) {
                    int next[3] = {at[0], at[1], at[2]};
                    if (++next[axis] == r->breaks[axis]) {
                        continue;
                    }
                    int low = r->label[box_number(r, at)], high = r->label[box_number(r, next)];
                    bool same = floor(middle(r, axis, at[axis])) == floor(middle(r, axis, next[axis]));
                    if (low >= 0 && high >= 0 && same && !visit) {
                        ruga_sets_unite(parent, low, high);
                    } else if (low >= 0 && high >= 0 && !same && visit) {
                        visit(context, low, high, axis);
                    }
                }
            }
        }
    }
}

static void reference_create(const blocks* b, const ruga_lattice* lattice, const double (*u)[SIDE_MAX + 1],
                             reference* r) {
    memset(r, 0, sizeof *r);
    memcpy(r->cells, lattice->cells, sizeof r->cells);
    reference_boxes(b, r, u);
    int total = r->breaks[0] * r->breaks[1] * r->breaks[2];
    int* parent = malloc((size_t)total * sizeof(int));
    int* number = malloc((size_t)total * sizeof(int));
    ruga_sets_reset(parent, total);
    each_pair(r, parent, NULL, NULL);
    for (int i = 0; i < total; i++) {
        int root = ruga_sets_find(parent, i);
        number[i] = r->label[i] < 0 ? -1 : root == i ? r->count++ : number[root];
    }
    memcpy(r->label, number, (size_t)total * sizeof(int));
    r->cell = calloc((size_t)r->count, 3 * sizeof(int));
    r->volume = calloc((size_t)r->count, 27 * sizeof(double));
    for (int i = 0; i < total; i++) {
        int at[3] = {i % r->breaks[0], i / r->breaks[0] % r->breaks[1], i / r->breaks[0] / r->breaks[1]},
            sub[3];
        double volume = 1;
        for (int axis = 0; axis < 3 && r->label[i] >= 0; axis++) {
            sub[axis] = ruga_slice_class(middle(r, axis, at[axis]));
            volume *= (r->at[axis][at[axis] + 1] - r->at[axis][at[axis]]) * lattice->cell_size[axis];
            r->cell[3 * r->label[i] + axis] = sub[axis] / 3;
        }
        if (r->label[i] >= 0) {
            r->volume[27 * r->label[i] + sub[0] % 3 + 3 * (sub[1] % 3) + 9 * (sub[2] % 3)] += volume;
        }
    }
    free(parent);
    free(number);
}

static void reference_clear(reference* r) {
    free(r->label);
    free(r->cell);
    free(r->volume);
}

typedef struct merging {
    const ruga_lattice* lattice;
    const int* element; // of components
    int* parent;        // [E npe]
} merging;

// The pairs of local nodes that coincide between neighbours, by their places in the grid of nodes.
static void merge_pair(void* context, int low, int high, int axis) {
    merging* m = context;
    int n = m->lattice->degree + 1, npe = m->lattice->nodes_per_element;
    for (int i = 0; i < npe; i++) {
        for (int j = 0; j < npe; j++) {
            int a[3] = {i % n, i / n % n, i / n / n}, b[3] = {j % n, j / n % n, j / n / n};
            b[axis]++;
            if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]) {
                ruga_sets_unite(m->parent, m->element[low] * npe + i, m->element[high] * npe + j);
            }
        }
    }
}

// Same components with the same volumes in every sub-cell, and the same nodes shared.
static void compare_with_reference(const ruga_lattice* lattice, const reference* r) {
    assert_int_equal(lattice->element_count, r->count);
    int* element = malloc((size_t)r->count * sizeof(int));
    bool* taken = calloc((size_t)r->count, sizeof(bool));
    double cell = lattice->cell_size[0] * lattice->cell_size[1] * lattice->cell_size[2];
    for (int c = 0; c < r->count; c++) {
        element[c] = -1;
        for (int e = 0; e < lattice->element_count && element[c] < 0; e++) {
            bool same =
                !taken[e] && memcmp(lattice->element_cell + 3 * e, r->cell + 3 * c, 3 * sizeof(int)) == 0;
            for (int s = 0; s < 27 && same; s++) {
                same = fabs(lattice->volume[27 * e + s] - r->volume[27 * c + s]) < 1e-11 * cell;
            }
            element[c] = same ? e : -1;
        }
        assert_true(element[c] >= 0);
        taken[element[c]] = true;
    }
    int corners = lattice->element_count * lattice->nodes_per_element, nodes = 0;
    merging m = {lattice, element, malloc((size_t)corners * sizeof(int))};
    ruga_sets_reset(m.parent, corners);
    each_pair(r, NULL, merge_pair, &m);
    for (int i = 0; i < corners; i++) {
        int root = ruga_sets_find(m.parent, i);
        nodes += root == i;
        assert_int_equal(lattice->element_node[i], lattice->element_node[root]);
    }
    assert_int_equal(nodes, lattice->node_count); // no more is shared than that
    free(m.parent);
    free(element);
    free(taken);
}

// Through the public door: planes wherever the box puts them.
static void check_blocks(const blocks* b, int cells, int degree) {
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    blocks_mesh(b, &mesh, &connectivity);
    ruga_lattice lattice;
    ruga_lattice_def def = {.cells = cells, .degree = degree, .fill = RUGA_FILL_MESH};
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    double u[3][SIDE_MAX + 1];
    for (int axis = 0; axis < 3; axis++) {
        for (int k = 0; k <= b->size[axis]; k++) {
            u[axis][k] = (b->coordinate[axis][k] - lattice.origin[axis]) / lattice.cell_size[axis];
        }
    }
    reference r;
    reference_create(b, &lattice, (const double(*)[SIDE_MAX + 1]) u, &r);
    compare_with_reference(&lattice, &r);
    reference_clear(&r);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// With the blocks' coordinates taken as lattice coordinates: whatever lies on a plane lies exactly on it.
static void check_blocks_on_planes(const blocks* b, int cells) {
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    blocks_mesh(b, &mesh, &connectivity);
    ruga_lattice lattice = {
        .degree = 2, .nodes_per_element = 27, .cell_size = {1, 1, 1}, .cells = {cells, cells, cells}};
    ruga_slices slices;
    ruga_caps caps;
    ruga_pieces pieces;
    int* piece_element;
    const double(*u)[3] = (const double(*)[3])mesh.position;
    assert_ok(ruga_slices_create(&mesh, &connectivity, u, &slices));
    assert_ok(ruga_caps_create(&slices, (int[3]){3 * cells, 3 * cells, 3 * cells}, &caps));
    assert_ok(ruga_pieces_create(&caps, &pieces));
    assert_ok(ruga_lattice_assemble(&caps, &pieces, &lattice, &piece_element));
    reference r;
    reference_create(b, &lattice, (const double(*)[SIDE_MAX + 1]) b->coordinate, &r);
    compare_with_reference(&lattice, &r);
    reference_clear(&r);
    ruga_release(piece_element);
    ruga_pieces_clear(&pieces);
    ruga_caps_clear(&caps);
    ruga_slices_clear(&slices);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

static void random_blocks(blocks* b, uint64_t seed, double density) {
    memset(b, 0, sizeof *b);
    ruga_random random = {seed};
    for (int axis = 0; axis < 3; axis++) {
        b->size[axis] = 4 + (int)(ruga_random_next(&random) % 5);
        for (int k = 0; k <= b->size[axis]; k++) {
            b->coordinate[axis][k] = k + 0.3 * ruga_random_uniform(&random);
        }
    }
    for (int x = 0; x < b->size[0]; x++) {
        for (int y = 0; y < b->size[1]; y++) {
            for (int z = 0; z < b->size[2]; z++) {
                b->solid[x][y][z] = ruga_random_uniform(&random) < density;
            }
        }
    }
    b->solid[1][1][1] = true;
    make_manifold(b);
}

static void random_bodies_match_the_reference(void** state) {
    (void)state;
    blocks* b = malloc(sizeof *b);
    for (uint64_t seed = 0; seed < 24; seed++) {
        random_blocks(b, seed, seed % 2 ? 0.12 : 0.3);
        check_blocks(b, 1 + (int)(seed % 5), 1 + (int)(seed / 5 % 2));
    }
    free(b);
}

static void bodies_exactly_on_planes_match_the_reference(void** state) {
    (void)state;
    blocks* b = malloc(sizeof *b);
    for (uint64_t seed = 0; seed < 24; seed++) {
        random_blocks(b, 100 + seed, seed % 2 ? 0.12 : 0.3);
        for (int axis = 0; axis < 3; axis++) {
            for (int k = 0; k <= b->size[axis]; k++) {
                // Every face on a plane; every second one; cell planes alone.
                b->coordinate[axis][k] = seed % 3 == 0   ? ruga_slice_plane(k + 2)
                                         : seed % 3 == 1 ? ruga_slice_plane(k / 2 + 2) + 0.1 * (k % 2)
                                                         : 1.0 + 0.5 * k;
            }
        }
        check_blocks_on_planes(b, 6);
    }
    free(b);
}

// ---- lips ----

// A clamp as in the paper's figure 5: two prongs with a thin gap, joined at one end.
static void make_clamp(blocks* b) {
    static const double x[3] = {0, 2, 10}, z[4] = {0, 1.45, 1.55, 3};
    memset(b, 0, sizeof *b);
    memcpy(b->size, (int[3]){2, 1, 3}, sizeof b->size);
    memcpy(b->coordinate[0], x, sizeof x);
    memcpy(b->coordinate[1], (double[2]){0, 2}, 2 * sizeof(double));
    memcpy(b->coordinate[2], z, sizeof z);
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 3; k++) {
            b->solid[i][0][k] = i == 0 || k != 1;
        }
    }
}

static void lips_move_on_their_own(void** state) {
    (void)state;
    blocks* b = malloc(sizeof *b);
    make_clamp(b);
    check_blocks(b, 8, 2);
    check_blocks(b, 8, 1);
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    blocks_mesh(b, &mesh, &connectivity);
    ruga_lattice lattice;
    ruga_lattice_def def = {.cells = 10, .degree = 2, .fill = RUGA_FILL_MESH};
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    assert_true(lattice.superimposed > 0);
    double* q = malloc(sizeof(double) * 3 * (size_t)lattice.node_count);
    double* x = malloc(sizeof(double) * 3 * (size_t)lattice.vertex_count);
    memcpy(q, lattice.rest, sizeof(double) * 3 * (size_t)lattice.node_count);
    for (int v = 0; v < mesh.vertex_count; v++) { // pull the upper prong's tip
        const double* rest = mesh.position + 3 * v;
        for (int i = 0; i < 27 && rest[0] > 9 && rest[2] > 1.5; i++) {
            q[3 * lattice.element_node[27 * lattice.vertex_element[v] + i] + 2] += 1;
        }
    }
    ruga_lattice_embed(&lattice, q, x);
    for (int v = 0; v < mesh.vertex_count; v++) {
        double* rest = mesh.position + 3 * v;
        double moved = ruga_distance(x + 3 * v, rest);
        if (rest[0] > 9 && rest[2] > 1.5) {
            assert_true(moved >= 1 - 1e-9);
        } else {
            assert_true(moved <= 1e-12);
        }
    }
    free(q);
    free(x);
    free(b);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_bodies_match_the_reference),
        cmocka_unit_test(bodies_exactly_on_planes_match_the_reference),
        cmocka_unit_test(lips_move_on_their_own),
    };
    return cmocka_run_group_tests_name("blocks", tests, NULL, check_no_leak);
}
