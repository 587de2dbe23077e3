// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The lattice against a reference that knows nothing of surfaces: bodies made of boxes, cut into finer boxes
// by all planes and flooded. And the properties of the embedding.
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "ruga/ruga.h"
#include "core/random.h"
#include "core/vec3.h"
#include "lattice/assemble.h"
#include "lattice/union_find.h"
#include "mesh/make.h"

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

static double total_volume(const ruga_lattice* lattice) {
    double sum = 0;
    for (int i = 0; i < 27 * lattice->element_count; i++) {
        assert_true(lattice->volume[i] >= 0);
        sum += lattice->volume[i];
    }
    return sum;
}

static const ruga_lattice_def FOUR_CELLS = {.cells = 4, .degree = 2, .fill = RUGA_FILL_MESH};

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

// ---- smooth bodies ----

static void make(ruga_shape shape, double x, double y, double z, double edge, ruga_mesh* mesh,
                 ruga_connectivity* connectivity) {
    ruga_make_def def = {.shape = shape, .size = {x, y, z}, .edge = edge};
    assert_ok(ruga_mesh_make(&def, mesh));
    assert_ok(ruga_connectivity_create(mesh, connectivity));
}

static void rotate(ruga_mesh* mesh, ruga_random* random) {
    double a[9];
    for (int i = 0; i < 6; i++) {
        a[i] = ruga_random_uniform(random) - 0.5;
    }
    ruga_normalize(a);
    ruga_add_scaled(-ruga_dot(a, a + 3), a, a + 3);
    ruga_normalize(a + 3);
    ruga_cross(a, a + 3, a + 6);
    for (int v = 0; v < mesh->vertex_count; v++) {
        ruga_multiply3(a, mesh->position + 3 * v, mesh->position + 3 * v);
    }
}

static double largest_difference(int count, const double* a, const double* b) {
    double most = 0;
    for (int i = 0; i < count; i++) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most;
}

// Affine maps exactly, rows that sum to one, and the transpose.
static void check_embedding(const ruga_mesh* mesh, const ruga_lattice* lattice) {
    const double map[9] = {1.1, 0.3, -0.2, 0.05, 0.9, 0.4, -0.3, 0.2, 1.2}, shift[3] = {0.3, -0.7, 0.2};
    int nodes = lattice->node_count, vertices = lattice->vertex_count, npe = lattice->nodes_per_element;
    double* q = malloc(sizeof(double) * 3 * (size_t)nodes);
    double* fq = calloc(3 * (size_t)nodes, sizeof(double));
    double* x = malloc(sizeof(double) * 3 * (size_t)vertices);
    double* wanted = malloc(sizeof(double) * 3 * (size_t)vertices);
    assert_int_equal(vertices, mesh->vertex_count);
    for (int n = 0; n < nodes; n++) {
        ruga_multiply3(map, lattice->rest + 3 * n, q + 3 * n);
        ruga_add_scaled(1, shift, q + 3 * n);
    }
    double size = 0;
    for (int v = 0; v < vertices; v++) {
        ruga_multiply3(map, mesh->position + 3 * v, wanted + 3 * v);
        ruga_add_scaled(1, shift, wanted + 3 * v);
        size = fmax(size, ruga_norm(wanted + 3 * v));
        double sum = 0;
        for (int i = 0; i < npe; i++) {
            sum += lattice->vertex_weight[v * npe + i];
        }
        assert_near(sum, 1, 1e-14);
    }
    ruga_lattice_embed(lattice, q, x);
    assert_true(largest_difference(3 * vertices, x, wanted) <= 1e-12 * size);
    ruga_random random = {7};
    double left = 0, right = 0, scale = 0;
    for (int i = 0; i < 3 * vertices; i++) {
        wanted[i] = ruga_random_uniform(&random) - 0.5;
        left += wanted[i] * x[i];
        scale += fabs(wanted[i] * x[i]);
    }
    ruga_lattice_embed_transpose(lattice, wanted, fq);
    for (int i = 0; i < 3 * nodes; i++) {
        right += fq[i] * q[i];
    }
    assert_near(left, right, 1e-13 * scale);
    free(q);
    free(fq);
    free(x);
    free(wanted);
}

static void check_smooth(const ruga_mesh* mesh, const ruga_connectivity* connectivity, int cells) {
    for (int degree = 1; degree <= 2; degree++) {
        ruga_lattice lattice;
        ruga_lattice_def def = {.cells = cells, .degree = degree, .fill = RUGA_FILL_MESH};
        assert_ok(ruga_lattice_create(mesh, connectivity, &def, &lattice));
        double volume = ruga_mesh_volume(mesh);
        assert_near(total_volume(&lattice), volume, 1e-9 * volume);
        check_embedding(mesh, &lattice);
        ruga_lattice_clear(&lattice);
    }
}

static void mass_and_embedding_of_shapes_in_any_position(void** state) {
    (void)state;
    const struct {
        ruga_shape shape;
        double size[3], edge;
    } shapes[] = {{RUGA_SHAPE_SPHERE, {0.4, 0, 0}, 0.03},
                  {RUGA_SHAPE_PILLOW, {0.5, 0.4, 0.15}, 0.03},
                  {RUGA_SHAPE_SLAB, {0.4, 0.2, 0.1}, 0.05},
                  {RUGA_SHAPE_BAR, {0.6, 0.1, 0.1}, 0.2}};
    ruga_random random = {3};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        ruga_mesh mesh;
        ruga_connectivity connectivity;
        make(shapes[i].shape, shapes[i].size[0], shapes[i].size[1], shapes[i].size[2], shapes[i].edge, &mesh,
             &connectivity);
        for (int turn = 0; turn < 3; turn++) {
            check_smooth(&mesh, &connectivity, 1 + 3 * turn);
            rotate(&mesh, &random);
        }
        ruga_connectivity_clear(&connectivity);
        ruga_mesh_clear(&mesh);
    }
}

// Slightly rotated, so that faces lie within rounding of the planes and cross them many times.
static void mass_of_a_slab_that_wobbles_about_the_planes(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_SLAB, 0.8, 0.4, 0.2, 0.03, &mesh, &connectivity);
    ruga_random random = {5};
    for (int turn = 0; turn < 6; turn++) {
        double size = pow(10, -17 + turn);
        for (int i = 0; i < 3 * mesh.vertex_count; i++) {
            mesh.position[i] += size * (ruga_random_uniform(&random) - 0.5);
        }
        check_smooth(&mesh, &connectivity, 4 * (1 + turn % 2));
    }
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// Spheres inside each other, every second one turned inside out: solid, cavity, core.
static void join_spheres(int count, const double* diameter, const double (*center)[3], ruga_mesh* mesh) {
    ruga_mesh ball;
    ruga_connectivity unused;
    make(RUGA_SHAPE_SPHERE, 1, 0, 0, 0.2, &ball, &unused);
    ruga_connectivity_clear(&unused);
    double* position = malloc(sizeof(double) * 3 * (size_t)(count * ball.vertex_count));
    int* triangle = malloc(sizeof(int) * 3 * (size_t)(count * ball.triangle_count));
    for (int s = 0; s < count; s++) {
        for (int i = 0; i < 3 * ball.vertex_count; i++) {
            position[3 * s * ball.vertex_count + i] = diameter[s] * ball.position[i] + center[s][i % 3];
        }
        for (int t = 0; t < ball.triangle_count; t++) {
            for (int i = 0; i < 3; i++) {
                triangle[3 * (s * ball.triangle_count + t) + (s % 2 ? 2 - i : i)] =
                    ball.triangle[3 * t + i] + s * ball.vertex_count;
            }
        }
    }
    ruga_mesh_def def = {.vertex_count = count * ball.vertex_count,
                         .positions = position,
                         .triangle_count = count * ball.triangle_count,
                         .triangles = triangle};
    assert_ok(ruga_mesh_from_def(&def, mesh));
    free(position);
    free(triangle);
    ruga_mesh_clear(&ball);
}

static void cavities_belong_to_the_body_around_them(void** state) {
    (void)state;
    const double diameter[4] = {1, 0.8, 0.3, 0.05};
    const double center[4][3] = {{0, 0, 0}, {0.02, 0, 0}, {0.1, 0.05, 0}, {0.13, 0.07, 0.06}};
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    join_spheres(4, diameter, center, &mesh);
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    for (int cells = 1; cells <= 5; cells++) {
        check_smooth(&mesh, &connectivity, cells);
        ruga_lattice lattice;
        ruga_lattice_def def = {.cells = cells, .degree = 2, .fill = RUGA_FILL_MESH};
        assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
        int v = mesh.vertex_count / 4;
        if (cells == 1) {
            assert_int_equal(lattice.element_count, 2);
        }
        // Shell and cavity hang together, the core is free of them.
        int shell = lattice.vertex_element[0], core = lattice.vertex_element[2 * v];
        for (int i = 0; i < v && cells == 1; i++) {
            assert_int_equal(lattice.vertex_element[v + i], shell);
            assert_int_equal(lattice.vertex_element[2 * v + i], core);
            assert_int_equal(lattice.vertex_element[3 * v + i], core);
        }
        ruga_lattice_clear(&lattice);
    }
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
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

// ---- a real head ----

// Vertices and triangulated polygons of an OBJ file, nothing else; false where there is no such file.
static bool read_obj(const char* path, ruga_mesh* mesh) {
    enum { MOST = 40000 };
    FILE* file = fopen(path, "r");
    if (!file) {
        return false;
    }
    double* position = malloc(sizeof(double) * 3 * MOST);
    int* triangle = malloc(sizeof(int) * 3 * MOST);
    ruga_mesh_def def = {.positions = position, .triangles = triangle};
    char line[512];
    while (fgets(line, sizeof line, file)) {
        double* x = position + 3 * def.vertex_count;
        if (strncmp(line, "v ", 2) == 0) {
            assert_int_equal(sscanf(line + 2, "%lf %lf %lf", &x[0], &x[1], &x[2]), 3);
            def.vertex_count++;
        } else if (strncmp(line, "f ", 2) == 0) {
            int corner[3], count = 0;
            for (char* word = strtok(line + 2, " \r\n"); word; word = strtok(NULL, " \r\n")) {
                corner[count < 2 ? count : 2] = atoi(word) - 1;
                if (++count >= 3) {
                    memcpy(triangle + 3 * def.triangle_count++, corner, sizeof corner);
                    corner[1] = corner[2];
                }
            }
        }
        assert_true(def.vertex_count < MOST && def.triangle_count < MOST - 4);
    }
    (void)fclose(file);
    assert_ok(ruga_mesh_from_def(&def, mesh));
    free(position);
    free(triangle);
    return true;
}

static void lips_of_a_head_have_their_own_elements(void** state) {
    (void)state;
    const char* data = getenv("RUGA_DATA");
    char path[1024];
    (void)snprintf(path, sizeof path, "%s/surface/makehuman_head_watertight.obj",
                   data ? data : RUGA_SOURCE_DIR "/../shared/data");
    ruga_mesh mesh;
    if (!read_obj(path, &mesh)) {
        print_message("skipped: no real surfaces (set RUGA_DATA)\n");
        skip();
    }
    ruga_connectivity connectivity;
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    double volume = ruga_mesh_volume(&mesh);
    for (int cells = 8; cells <= 12; cells++) {
        ruga_lattice lattice;
        ruga_lattice_def def = {.cells = cells, .degree = 2, .fill = RUGA_FILL_MESH};
        assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
        assert_near(total_volume(&lattice), volume, 1e-9 * volume);
        check_embedding(&mesh, &lattice);
        // On the mid-line: the red of the upper lip and that of the lower one, 7 mm apart.
        const int upper = lattice.vertex_element[468], lower = lattice.vertex_element[495];
        // With 9 cells a plane runs through the middle of the face, and the cells beside it reach past the
        // corners of the mouth (at 2.4 cm), where the lips are one piece.
        if (cells == 9) {
            assert_int_equal(upper, lower);
            ruga_lattice_clear(&lattice);
            continue;
        }
        assert_int_not_equal(upper, lower);
        assert_true(lattice.superimposed > 0);
        ruga_lattice_clear(&lattice);
    }
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// ---- box ----

static void box_of_a_flat_sheet_lies_under_it(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_SHEET, 0.5, 0.25, 0, 0.05, &mesh, &connectivity);
    ruga_lattice lattice;
    ruga_lattice_def def = {.cells = 10, .degree = 2, .fill = RUGA_FILL_BOX};
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    assert_int_equal(lattice.cells[0], 10);
    assert_int_equal(lattice.cells[1], 5);
    assert_int_equal(lattice.cells[2], 1);
    assert_near(lattice.origin[2], -0.05, 1e-15);
    assert_near(total_volume(&lattice), 0.5 * 0.25 * 0.05, 1e-14);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    for (int t = 0; t < mesh.triangle_count; t++) { // looking down, deeper
        int swap = mesh.triangle[3 * t];
        mesh.triangle[3 * t] = mesh.triangle[3 * t + 1];
        mesh.triangle[3 * t + 1] = swap;
    }
    ruga_connectivity_clear(&connectivity);
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    def.depth = 0.2;
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    assert_int_equal(lattice.cells[2], 4);
    assert_near(lattice.origin[2], 0, 1e-15);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    mesh.position[2] = 1e-4; // not quite flat: the top face is at the highest point (here looking down)
    mesh.position[5] = -2e-4;
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    assert_near(lattice.origin[2], -2e-4, 1e-15);
    assert_near(lattice.origin[2] + 4 * lattice.cell_size[2], 0.2 - 2e-4, 1e-15);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

static void box_of_a_closed_mesh_is_its_own(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_SPHERE, 0.4, 0, 0, 0.05, &mesh, &connectivity);
    ruga_lattice lattice;
    ruga_lattice_def def = {.cells = 3, .degree = 1, .fill = RUGA_FILL_BOX, .depth = 5};
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    double min[3], max[3];
    ruga_mesh_bounds(&mesh, min, max);
    double box = (max[0] - min[0]) * (max[1] - min[1]) * (max[2] - min[2]);
    assert_int_equal(lattice.element_count, 27);
    assert_int_equal(lattice.node_count, 64);
    assert_near(total_volume(&lattice), box, 1e-13 * box);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// ---- shape functions ----

static void shape_functions_have_their_gradients(void** state) {
    (void)state;
    for (int degree = 1; degree <= 2; degree++) {
        int npe = degree == 2 ? 27 : 8;
        ruga_lattice lattice = {.degree = degree, .nodes_per_element = npe, .cell_size = {0.5, 0.25, 2}};
        const double xi[3] = {0.3, 1.02, 0.6};
        double weight[27], gradient[81], up[27], down[27], sum = 0;
        ruga_lattice_shape(&lattice, xi, weight, gradient);
        for (int axis = 0; axis < 3; axis++) {
            double a[3] = {xi[0], xi[1], xi[2]}, b[3] = {xi[0], xi[1], xi[2]}, h = 1e-5;
            a[axis] += h;
            b[axis] -= h;
            ruga_lattice_shape(&lattice, a, up, NULL);
            ruga_lattice_shape(&lattice, b, down, NULL);
            for (int i = 0; i < npe; i++) {
                double slope = (up[i] - down[i]) / (2 * h * lattice.cell_size[axis]);
                assert_near(gradient[3 * i + axis], slope, 1e-9);
                sum += gradient[3 * i + axis];
            }
        }
        assert_near(sum, 0, 1e-12);
    }
}

static void quadrature_integrates_quintics(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_SHEET, 1, 1, 0, 0.5, &mesh, &connectivity);
    ruga_lattice lattice;
    ruga_lattice_def def = {.cells = 1, .degree = 2, .fill = RUGA_FILL_BOX};
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &def, &lattice));
    double sum = 0;
    for (int g = 0; g < 27; g++) {
        double xi[3], x[3];
        ruga_lattice_point(&lattice, 0, g, xi, x);
        assert_near(x[0], -0.5 + xi[0], 1e-15);
        assert_near(x[2], -1 + xi[2], 1e-15);
        sum += lattice.volume[g] * pow(xi[0], 5) * pow(xi[1], 4) * xi[2];
    }
    assert_near(sum, 1.0 / 6 / 5 / 2, 1e-15);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

// ---- threads, refusals, memory ----

static void threads_do_not_change_a_bit(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    make(RUGA_SHAPE_PILLOW, 0.5, 0.5, 0.15, 0.012, &mesh, &connectivity);
    ruga_lattice lattice;
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice));
    size_t vertices = 3 * (size_t)lattice.vertex_count, nodes = 3 * (size_t)lattice.node_count;
    double* x[2] = {malloc(vertices * sizeof(double)), malloc(vertices * sizeof(double))};
    double* f[2] = {calloc(nodes, sizeof(double)), calloc(nodes, sizeof(double))};
    for (int i = 0; i < 2; i++) {
        ruga_set_threads(1 + 2 * i);
        ruga_lattice_embed(&lattice, lattice.rest, x[i]);
        ruga_lattice_embed_transpose(&lattice, x[i], f[i]);
    }
    ruga_set_threads(0);
    assert_memory_equal(x[0], x[1], vertices * sizeof(double));
    assert_memory_equal(f[0], f[1], nodes * sizeof(double));
    for (int i = 0; i < 2; i++) {
        free(x[i]);
        free(f[i]);
    }
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

static void unused_vertices_go_to_the_nearest_element(void** state) {
    (void)state;
    const double position[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0.5, 0.5};
    const int triangle[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    ruga_mesh_def def = {
        .vertex_count = 5, .positions = position, .triangle_count = 4, .triangles = triangle};
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    assert_ok(ruga_mesh_from_def(&def, &mesh));
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    ruga_lattice lattice;
    assert_ok(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice));
    assert_true(lattice.cell_size[0] < 0.26);
    assert_near(total_volume(&lattice), 1.0 / 6, 1e-15);
    check_embedding(&mesh, &lattice);
    ruga_lattice_clear(&lattice);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

static void refuses_what_has_no_inside(void** state) {
    (void)state;
    ruga_mesh mesh;
    ruga_connectivity connectivity;
    ruga_lattice lattice;
    make(RUGA_SHAPE_SHEET, 1, 1, 0, 0.5, &mesh, &connectivity);
    assert_status(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice), RUGA_BAD_MESH);
    assert_non_null(strstr(ruga_last_error(), "not watertight: the edge between vertices"));
    ruga_lattice_def def = {.cells = 4, .degree = 3, .fill = RUGA_FILL_BOX};
    assert_status(ruga_lattice_create(&mesh, &connectivity, &def, &lattice), RUGA_BAD_INPUT);
    def = (ruga_lattice_def){.cells = 0, .degree = 2, .fill = RUGA_FILL_BOX};
    assert_status(ruga_lattice_create(&mesh, &connectivity, &def, &lattice), RUGA_BAD_INPUT);
    def = (ruga_lattice_def){.cells = 4, .degree = 2, .fill = RUGA_FILL_BOX, .depth = NAN};
    assert_status(ruga_lattice_create(&mesh, &connectivity, &def, &lattice), RUGA_BAD_INPUT);
    def = (ruga_lattice_def){.cells = 100000, .degree = 2, .fill = RUGA_FILL_BOX};
    assert_status(ruga_lattice_create(&mesh, &connectivity, &def, &lattice), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "lower lattice.cells"));
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
    make(RUGA_SHAPE_SPHERE, 1, 0, 0, 0.3, &mesh, &connectivity);
    ruga_connectivity_clear(&connectivity);
    for (int t = 0; t < mesh.triangle_count; t++) {
        int swap = mesh.triangle[3 * t];
        mesh.triangle[3 * t] = mesh.triangle[3 * t + 1];
        mesh.triangle[3 * t + 1] = swap;
    }
    assert_ok(ruga_connectivity_create(&mesh, &connectivity));
    assert_status(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice), RUGA_BAD_MESH);
    assert_non_null(strstr(ruga_last_error(), "inwards"));
    mesh.position[4] = NAN;
    assert_status(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice), RUGA_BAD_MESH);
    mesh.triangle_count = 0;
    assert_status(ruga_lattice_create(&mesh, &connectivity, &FOUR_CELLS, &lattice), RUGA_BAD_MESH);
    ruga_connectivity_clear(&connectivity);
    ruga_mesh_clear(&mesh);
}

static void every_allocation_may_fail(void** state) {
    (void)state;
    for (int fill = RUGA_FILL_MESH; fill <= RUGA_FILL_BOX; fill++) {
        ruga_mesh mesh;
        ruga_connectivity connectivity;
        ruga_lattice lattice;
        ruga_lattice_def def = {.cells = 3, .degree = 2, .fill = (ruga_fill)fill};
        ruga_status status = RUGA_NO_MEMORY;
        let_allocations_fail_after(1000000);
        make(RUGA_SHAPE_SPHERE, 0.4, 0, 0, 0.1, &mesh, &connectivity);
        size_t before = ruga_byte_count();
        for (int k = 0; status != RUGA_OK; k++) {
            allocations_left = k;
            status = ruga_lattice_create(&mesh, &connectivity, &def, &lattice);
            assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
            if (status != RUGA_OK) {
                assert_int_equal(ruga_byte_count(), before);
            }
        }
        ruga_lattice_clear(&lattice);
        ruga_connectivity_clear(&connectivity);
        ruga_mesh_clear(&mesh);
        ruga_set_allocator(NULL, NULL, NULL);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_bodies_match_the_reference),
        cmocka_unit_test(bodies_exactly_on_planes_match_the_reference),
        cmocka_unit_test(mass_and_embedding_of_shapes_in_any_position),
        cmocka_unit_test(mass_of_a_slab_that_wobbles_about_the_planes),
        cmocka_unit_test(cavities_belong_to_the_body_around_them),
        cmocka_unit_test(lips_move_on_their_own),
        cmocka_unit_test(lips_of_a_head_have_their_own_elements),
        cmocka_unit_test(box_of_a_flat_sheet_lies_under_it),
        cmocka_unit_test(box_of_a_closed_mesh_is_its_own),
        cmocka_unit_test(shape_functions_have_their_gradients),
        cmocka_unit_test(quadrature_integrates_quintics),
        cmocka_unit_test(threads_do_not_change_a_bit),
        cmocka_unit_test(unused_vertices_go_to_the_nearest_element),
        cmocka_unit_test(refuses_what_has_no_inside),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
