// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// From pieces of material to elements (Remillard and Kry 2013, section 5.1, figure 5): pieces of one cell
// that meet on planes inside the cell are one component; each component becomes an element with its own
// nodes; where components of adjacent cells share a cap, the overlapping nodes of their elements become one.
// A component with less than SLIVER of its cell (what remains where a face of the surface lies exactly on a
// cell plane, for example) gets no element: its vertices and its volume go to the neighbour that shares
// the largest cap with it, whose polynomial is evaluated slightly outside the cell.
#include "lattice/assemble.h"

#include "core/memory.h"

#include <string.h>

#include "lattice/union_find.h"

static const double SLIVER = 1e-9;
// A cap below this part of a cell's face joins nothing; it only tells slivers where to go. A face of the
// surface exactly on a plane leaves a layer without thickness beyond it, and that layer must not be a bridge.
static const double THIN = 1e-9;
static const double GAUSS_WEIGHT[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

enum { EMPTY = -1 }; // entries of a cell's sub-cells: >= 0 crossed, EMPTY, or full(piece)

static int full(int number) {
    return -2 - number;
}

// A cell that the surface passes through.
typedef struct surface_cell {
    int index[3];
    int sub[27]; // number of the crossed sub-cell, EMPTY or full(piece)
} surface_cell;

// Two components (pieces, later elements) meet across a cell face.
typedef struct link {
    int low, high; // on the negative and the positive side of the plane; full(element) for a full cell
    int axis;      // -1: joins nothing
    double area;
} link;

typedef struct assembly {
    const ruga_caps* caps;
    ruga_pieces* pieces;
    ruga_lattice* lattice;
    ruga_vdb* map; // cell -> surface cell, or full(element)
    int cell_count, cell_capacity;
    surface_cell* cell;
    int* parent;  // of pieces
    int* element; // of pieces; -1 before
    int link_count, link_capacity;
    link* link;
    int element_cell_capacity, volume_capacity;
    int* target; // [elements] an element's number after the slivers are gone
} assembly;

static double sub_cell_volume(int sub) {
    return GAUSS_WEIGHT[sub % 3] * GAUSS_WEIGHT[sub / 3 % 3] * GAUSS_WEIGHT[sub / 9];
}

static int sub_number(const int index[3]) {
    return index[0] % 3 + 3 * (index[1] % 3 + 3 * (index[2] % 3));
}

static ruga_status collect_surface_cells(assembly* assembly) {
    const ruga_pieces* pieces = assembly->pieces;
    for (int p = 0; p < pieces->cell_count; p++) {
        const int* index = pieces->cell[p].index;
        int at[3] = {index[0] / 3, index[1] / 3, index[2] / 3};
        int c = ruga_vdb_get(assembly->map, at);
        if (c < 0) {
            c = assembly->cell_count;
            RUGA_TRY(RUGA_RESERVE(assembly->cell, assembly->cell_capacity, c + 1));
            RUGA_TRY(ruga_vdb_set(assembly->map, at, c));
            memcpy(assembly->cell[c].index, at, sizeof at);
            for (int s = 0; s < 27; s++) {
                assembly->cell[c].sub[s] = EMPTY;
            }
            assembly->cell_count++;
        }
        assembly->cell[c].sub[sub_number(index)] = p;
    }
    return RUGA_OK;
}

// Sub-cells that the surface does not cross are full or empty as their corner is.
static ruga_status fill_surface_cells(assembly* assembly) {
    for (int c = 0; c < assembly->cell_count; c++) {
        surface_cell* cell = &assembly->cell[c];
        for (int s = 0; s < 27; s++) {
            int at[3] = {3 * cell->index[0] + s % 3, 3 * cell->index[1] + s / 3 % 3,
                         3 * cell->index[2] + s / 9};
            int winding = cell->sub[s] == EMPTY ? ruga_caps_corner(assembly->caps, at) : 0;
            if (winding != 0) {
                int piece;
                RUGA_TRY(ruga_pieces_add(assembly->pieces, at, winding * sub_cell_volume(s), &piece));
                cell->sub[s] = full(piece);
            }
        }
    }
    return RUGA_OK;
}

// The piece that holds the whole of a sub-cell's face (2 axis + side), or -1.
static int piece_at_face(const assembly* assembly, const surface_cell* cell, int sub, int face) {
    int entry = cell->sub[sub];
    return entry >= 0 ? assembly->pieces->cell[entry].full_face[face] : entry == EMPTY ? -1 : full(entry);
}

// Links in a row between the same two are one.
static ruga_status add_link(assembly* assembly, int low, int high, int axis, double area) {
    link* last = assembly->link_count ? &assembly->link[assembly->link_count - 1] : NULL;
    if (last && last->low == low && last->high == high && last->axis == axis) {
        last->area += area;
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_RESERVE(assembly->link, assembly->link_capacity, assembly->link_count + 1));
    assembly->link[assembly->link_count++] = (link){low, high, axis, area};
    return RUGA_OK;
}

static ruga_status join_crossed_faces(assembly* assembly) {
    const ruga_caps* caps = assembly->caps;
    for (int f = 0; f < caps->face_count; f++) {
        const ruga_cap_face* face = &caps->face[f];
        for (int r = face->region_first; r < face->region_first + face->region_count; r++) {
            int low = assembly->pieces->region_piece[r][0], high = assembly->pieces->region_piece[r][1];
            double area = fabs(caps->region_area[r]);
            bool inside = face->index[face->axis] % 3 != 0;
            if (inside && area >= THIN) {
                ruga_sets_unite(assembly->parent, low, high);
            } else {
                RUGA_TRY(add_link(assembly, low, high, inside ? -1 : face->axis, area));
            }
        }
    }
    return RUGA_OK;
}

static void join_full_faces(assembly* assembly) {
    static const int stride[3] = {1, 3, 9};
    for (int c = 0; c < assembly->cell_count; c++) {
        const surface_cell* cell = &assembly->cell[c];
        for (int s = 0; s < 27; s++) {
            for (int axis = 0; axis < 3; axis++) {
                if (s / stride[axis] % 3 == 2) {
                    continue;
                }
                int low = piece_at_face(assembly, cell, s, 2 * axis + 1);
                int high = piece_at_face(assembly, cell, s + stride[axis], 2 * axis);
                if (low >= 0 && high >= 0) {
                    ruga_sets_unite(assembly->parent, low, high);
                }
            }
        }
    }
}

// Links across one face of a surface cell through sub-faces that lie wholly in the material. Across its high
// faces both kinds of neighbours, across its low faces full ones alone (the others look up themselves).
static ruga_status link_face(assembly* assembly, const surface_cell* cell, int axis, int side) {
    static const int stride[3] = {1, 3, 9};
    int at[3] = {cell->index[0], cell->index[1], cell->index[2]};
    at[axis] += side ? 1 : -1;
    int neighbour = ruga_vdb_get(assembly->map, at);
    if (neighbour == EMPTY || (side == 0 && neighbour >= 0)) {
        return RUGA_OK;
    }
    for (int s = 0; s < 27; s++) {
        if (s / stride[axis] % 3 != 2 * side) {
            continue;
        }
        int own = piece_at_face(assembly, cell, s, 2 * axis + side), other = neighbour;
        if (neighbour >= 0) {
            other = piece_at_face(assembly, &assembly->cell[neighbour], s - 2 * stride[axis], 2 * axis);
        }
        if (own >= 0 && other != EMPTY) {
            double area = sub_cell_volume(s) / GAUSS_WEIGHT[s / stride[axis] % 3];
            RUGA_TRY(add_link(assembly, side ? own : other, side ? other : own, axis, area));
        }
    }
    return RUGA_OK;
}

static ruga_status add_element(assembly* assembly, const int index[3]) {
    ruga_lattice* lattice = assembly->lattice;
    size_t e = (size_t)lattice->element_count;
    RUGA_TRY(RUGA_RESERVE(lattice->element_cell, assembly->element_cell_capacity, 3 * e + 3));
    RUGA_TRY(RUGA_RESERVE(lattice->volume, assembly->volume_capacity, 27 * e + 27));
    memcpy(lattice->element_cell + 3 * e, index, 3 * sizeof *index);
    memset(lattice->volume + 27 * e, 0, 27 * sizeof *lattice->volume);
    lattice->element_count++;
    return RUGA_OK;
}

// Elements of one surface cell: one for each component among the pieces of its sub-cells.
static ruga_status add_component_elements(assembly* assembly, const int* piece, int count) {
    for (int i = 0; i < count; i++) {
        int root = ruga_sets_find(assembly->parent, piece[i]);
        const ruga_piece* part = &assembly->pieces->piece[piece[i]];
        if (assembly->element[root] < 0) {
            assembly->element[root] = assembly->lattice->element_count;
            int at[3] = {part->index[0] / 3, part->index[1] / 3, part->index[2] / 3};
            RUGA_TRY(add_element(assembly, at));
        }
        assembly->element[piece[i]] = assembly->element[root];
        assembly->lattice->volume[27 * (size_t)assembly->element[root] + (size_t)sub_number(part->index)] +=
            part->volume;
    }
    return RUGA_OK;
}

static ruga_status add_full_element(assembly* assembly, const int index[3]) {
    int corner[3] = {3 * index[0], 3 * index[1], 3 * index[2]};
    int winding = ruga_caps_corner(assembly->caps, corner);
    if (winding == 0) {
        return RUGA_OK;
    }
    int e = assembly->lattice->element_count;
    RUGA_TRY(add_element(assembly, index));
    for (int s = 0; s < 27; s++) {
        assembly->lattice->volume[27 * (size_t)e + (size_t)s] = winding * sub_cell_volume(s);
    }
    return ruga_vdb_set(assembly->map, index, full(e));
}

// Elements in the order of their cells, those of one cell in the order of their first pieces.
static ruga_status add_elements(assembly* assembly) {
    const ruga_pieces* pieces = assembly->pieces;
    const int* cells = assembly->lattice->cells;
    int *start = NULL, *order = NULL;
    ruga_status status;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(start, assembly->cell_count + 2));
    RUGA_TRY_DONE(RUGA_NEW(order, pieces->piece_count));
    for (int turn = 0; turn < 2; turn++) { // count two places ahead, then fill
        for (int p = 0; p < pieces->piece_count; p++) {
            const int* index = pieces->piece[p].index;
            int c = ruga_vdb_get(assembly->map, (int[3]){index[0] / 3, index[1] / 3, index[2] / 3});
            if (turn == 0) {
                start[c + 2]++;
            } else {
                order[start[c + 1]++] = p;
            }
        }
        for (int c = 0; turn == 0 && c < assembly->cell_count; c++) {
            start[c + 2] += start[c + 1];
        }
    }
    int at[3];
    for (at[2] = 0; at[2] < cells[2]; at[2]++) {
        for (at[1] = 0; at[1] < cells[1]; at[1]++) {
            for (at[0] = 0; at[0] < cells[0]; at[0]++) {
                int c = ruga_vdb_get(assembly->map, at);
                if (c >= 0) {
                    RUGA_TRY_DONE(
                        add_component_elements(assembly, order + start[c], start[c + 1] - start[c]));
                } else {
                    RUGA_TRY_DONE(add_full_element(assembly, at));
                }
            }
        }
    }
done:
    ruga_release(start);
    ruga_release(order);
    return status;
}

// Links between pieces become links between elements.
static void rename_links(assembly* assembly) {
    for (int i = 0; i < assembly->link_count; i++) {
        link* link = &assembly->link[i];
        link->low = link->low >= 0 ? assembly->element[link->low] : full(link->low);
        link->high = link->high >= 0 ? assembly->element[link->high] : full(link->high);
    }
}

static double element_volume(const ruga_lattice* lattice, int e) {
    double sum = 0;
    for (int s = 0; s < 27; s++) {
        sum += lattice->volume[27 * (size_t)e + (size_t)s];
    }
    return sum;
}

// One round: each sliver beside a settled element takes, of those, the one with the largest common cap.
// `from` are the targets before the round (-1 = not settled), `best` [elements] is scratch.
static bool settle_slivers(assembly* assembly, int* best) {
    int* target = assembly->target;
    bool settled = false;
    memset(best, -1, (size_t)assembly->lattice->element_count * sizeof *best);
    for (int i = 0; i < assembly->link_count; i++) {
        const link* link = &assembly->link[i];
        for (int k = 0; k < 2; k++) {
            int own = k ? link->high : link->low, other = k ? link->low : link->high;
            bool better = target[own] < 0 && target[other] >= 0 &&
                          (best[own] < 0 || link->area > assembly->link[best[own]].area);
            best[own] = better ? i : best[own];
        }
    }
    for (int e = 0; e < assembly->lattice->element_count; e++) {
        if (best[e] >= 0) {
            const link* link = &assembly->link[best[e]];
            int other = link->low == e ? link->high : link->low;
            best[e] = target[other]; // all from before this round
            settled = true;
        }
    }
    for (int e = 0; e < assembly->lattice->element_count; e++) {
        target[e] = best[e] >= 0 ? best[e] : target[e];
    }
    return settled;
}

// Volume of a sliver goes to the nearest sub-cell of its new element, so that no mass is lost.
static void move_volume(ruga_lattice* lattice, int from, int to) {
    const int *a = lattice->element_cell + 3 * (size_t)from, *b = lattice->element_cell + 3 * (size_t)to;
    for (int s = 0; s < 27; s++) {
        int sub[3] = {s % 3, s / 3 % 3, s / 9};
        for (int axis = 0; axis < 3; axis++) {
            sub[axis] = a[axis] < b[axis] ? 0 : a[axis] > b[axis] ? 2 : sub[axis];
        }
        lattice->volume[27 * (size_t)to + (size_t)sub_number(sub)] +=
            lattice->volume[27 * (size_t)from + (size_t)s];
    }
}

// Removes the slivers; afterwards target[] maps old elements to new ones.
static ruga_status drop_slivers(assembly* assembly) {
    ruga_lattice* lattice = assembly->lattice;
    int* best = NULL;
    int* number = NULL;
    ruga_status status;
    RUGA_TRY_DONE(RUGA_NEW(assembly->target, lattice->element_count));
    RUGA_TRY_DONE(RUGA_NEW(best, lattice->element_count));
    RUGA_TRY_DONE(RUGA_NEW(number, lattice->element_count));
    for (int e = 0; e < lattice->element_count; e++) {
        assembly->target[e] = element_volume(lattice, e) < SLIVER ? -1 : e;
    }
    while (settle_slivers(assembly, best)) {
    }
    int count = 0;
    for (int e = 0; e < lattice->element_count; e++) {
        int* target = &assembly->target[e];
        *target = *target < 0 ? e : *target; // a body that is nothing but a sliver
        if (*target != e) {
            move_volume(lattice, e, *target);
        }
    }
    for (int e = 0; e < lattice->element_count; e++) {
        number[e] = assembly->target[e] == e ? count++ : -1;
        if (number[e] >= 0) {
            memmove(lattice->element_cell + 3 * (size_t)number[e], lattice->element_cell + 3 * (size_t)e,
                    3 * sizeof *lattice->element_cell);
            memmove(lattice->volume + 27 * (size_t)number[e], lattice->volume + 27 * (size_t)e,
                    27 * sizeof *lattice->volume);
        }
    }
    for (int e = 0; e < lattice->element_count; e++) {
        assembly->target[e] = number[assembly->target[e]];
    }
    // A link that is thin or ended in a sliver ties nothing.
    int links = 0;
    for (int i = 0; i < assembly->link_count; i++) {
        link link = assembly->link[i];
        if (link.axis >= 0 && link.area >= THIN && number[link.low] >= 0 && number[link.high] >= 0) {
            link.low = number[link.low];
            link.high = number[link.high];
            assembly->link[links++] = link;
        }
    }
    assembly->link_count = links;
    lattice->element_count = count;
done:
    ruga_release(best);
    ruga_release(number);
    return status;
}

// Merges the nodes of element `low` with those of `high`, its neighbour one cell up along the axis.
static void merge_nodes(const ruga_lattice* lattice, int* parent, int low, int high, int axis) {
    int n = lattice->degree + 1, stride = axis == 0 ? 1 : axis == 1 ? n : n * n;
    int first = low * lattice->nodes_per_element, second = high * lattice->nodes_per_element;
    for (int local = 0; local < lattice->nodes_per_element; local++) {
        if (local / stride % n > 0) {
            ruga_sets_unite(parent, first + local, second + local - stride);
        }
    }
}

static void merge_all(const assembly* assembly, int* parent) {
    const ruga_lattice* lattice = assembly->lattice;
    for (int i = 0; i < assembly->link_count; i++) {
        const link* link = &assembly->link[i];
        merge_nodes(lattice, parent, link->low, link->high, link->axis);
    }
    // Full cells beside each other.
    for (int e = 0; e < lattice->element_count; e++) {
        const int* cell = lattice->element_cell + 3 * (size_t)e;
        for (int axis = 0; axis < 3 && ruga_vdb_get(assembly->map, cell) < EMPTY; axis++) {
            int at[3] = {cell[0], cell[1], cell[2]};
            at[axis]++;
            int neighbour = ruga_vdb_get(assembly->map, at);
            if (neighbour < EMPTY) {
                merge_nodes(lattice, parent, e, assembly->target[full(neighbour)], axis);
            }
        }
    }
}

// Place of an element's local node: uniform quadratic B-splines have theirs at the Greville points, half a
// cell outside, in the middle of, and half a cell beyond the element; trilinear functions at the corners.
static void rest_position(const ruga_lattice* lattice, int element, int local, double x[3]) {
    int n = lattice->degree + 1;
    int at[3] = {local % n, local / n % n, local / n / n};
    for (int axis = 0; axis < 3; axis++) {
        double u = lattice->element_cell[3 * (size_t)element + (size_t)axis] + at[axis];
        u -= lattice->degree == 2 ? 0.5 : 0;
        x[axis] = lattice->origin[axis] + lattice->cell_size[axis] * u;
    }
}

// parent [E npe]: numbers the sets in the order of the elements.
static ruga_status number_nodes(ruga_lattice* lattice, int* parent) {
    size_t corners = (size_t)lattice->element_count * (size_t)lattice->nodes_per_element;
    RUGA_TRY(RUGA_NEW(lattice->element_node, corners));
    lattice->node_count = 0;
    for (size_t i = 0; i < corners; i++) {
        int root = ruga_sets_find(parent, (int)i);
        lattice->element_node[i] = root == (int)i ? lattice->node_count++ : lattice->element_node[root];
    }
    RUGA_TRY(RUGA_NEW(lattice->rest, 3 * (size_t)lattice->node_count));
    for (size_t i = 0; i < corners; i++) {
        if (parent[i] == (int)i) {
            int e = (int)(i / (size_t)lattice->nodes_per_element);
            rest_position(lattice, e, (int)(i % (size_t)lattice->nodes_per_element),
                          lattice->rest + 3 * (size_t)lattice->element_node[i]);
        }
    }
    return RUGA_OK;
}

// Volumes in cells become cubic metres. What is below zero by rounding, or by a good deal where the surface
// crosses itself and is inside out, is cut off, and the rest scaled so that the total stays the volume
// enclosed.
static void scale_volumes(ruga_lattice* lattice) {
    double total = 0, positive = 0;
    for (size_t i = 0; i < 27 * (size_t)lattice->element_count; i++) {
        total += lattice->volume[i];
        positive += lattice->volume[i] > 0 ? lattice->volume[i] : 0;
    }
    double cell = lattice->cell_size[0] * lattice->cell_size[1] * lattice->cell_size[2];
    double scale = positive > 0 ? cell * (total / positive) : 0;
    for (size_t i = 0; i < 27 * (size_t)lattice->element_count; i++) {
        lattice->volume[i] = lattice->volume[i] > 0 ? scale * lattice->volume[i] : 0;
    }
}

static ruga_status make_nodes(const assembly* assembly) {
    ruga_lattice* lattice = assembly->lattice;
    size_t corners = (size_t)lattice->element_count * (size_t)lattice->nodes_per_element;
    int* parent;
    RUGA_TRY(RUGA_NEW(parent, corners));
    ruga_sets_reset(parent, (int)corners);
    merge_all(assembly, parent);
    ruga_status status = number_nodes(lattice, parent);
    ruga_release(parent);
    return status;
}

static ruga_status join_pieces(assembly* assembly) {
    int pieces = assembly->pieces->piece_count;
    RUGA_TRY(RUGA_NEW(assembly->parent, pieces));
    RUGA_TRY(RUGA_NEW(assembly->element, pieces));
    ruga_sets_reset(assembly->parent, pieces);
    memset(assembly->element, -1, (size_t)pieces * sizeof *assembly->element);
    RUGA_TRY(join_crossed_faces(assembly));
    join_full_faces(assembly);
    return RUGA_OK;
}

static ruga_status link_cells(assembly* assembly) {
    for (int c = 0; c < assembly->cell_count; c++) {
        for (int i = 0; i < 6; i++) {
            RUGA_TRY(link_face(assembly, &assembly->cell[c], i / 2, i % 2));
        }
    }
    rename_links(assembly);
    return RUGA_OK;
}

static void count_superimposed(ruga_lattice* lattice) {
    lattice->superimposed = 0;
    for (int e = 1; e < lattice->element_count; e++) {
        const int* cell = lattice->element_cell + 3 * (size_t)e;
        lattice->superimposed += memcmp(cell, cell - 3, 3 * sizeof *cell) == 0;
    }
}

ruga_status ruga_lattice_assemble(const ruga_caps* caps, ruga_pieces* pieces, ruga_lattice* lattice,
                                  int** piece_element) {
    assembly assembly = {.caps = caps, .pieces = pieces, .lattice = lattice};
    ruga_status status;
    *piece_element = NULL;
    RUGA_TRY_DONE(ruga_vdb_create(&assembly.map));
    RUGA_TRY_DONE(collect_surface_cells(&assembly));
    RUGA_TRY_DONE(fill_surface_cells(&assembly));
    RUGA_TRY_DONE(join_pieces(&assembly));
    RUGA_TRY_DONE(add_elements(&assembly));
    RUGA_TRY_DONE(link_cells(&assembly));
    RUGA_TRY_DONE(drop_slivers(&assembly));
    RUGA_TRY_DONE(make_nodes(&assembly));
    scale_volumes(lattice);
    count_superimposed(lattice);
    for (int p = 0; p < pieces->piece_count; p++) {
        assembly.element[p] = assembly.target[assembly.element[p]];
    }
    *piece_element = assembly.element;
    assembly.element = NULL;
done:
    ruga_vdb_destroy(&assembly.map);
    ruga_release(assembly.cell);
    ruga_release(assembly.parent);
    ruga_release(assembly.element);
    ruga_release(assembly.link);
    ruga_release(assembly.target);
    return status;
}

ruga_status ruga_lattice_fill(ruga_lattice* lattice) {
    const int* cells = lattice->cells;
    int n = lattice->degree + 1, nodes[3];
    lattice->element_count = cells[0] * cells[1] * cells[2];
    lattice->node_count = 1;
    for (int axis = 0; axis < 3; axis++) {
        nodes[axis] = cells[axis] + lattice->degree;
        lattice->node_count *= nodes[axis];
    }
    size_t elements = (size_t)lattice->element_count;
    RUGA_TRY(RUGA_NEW(lattice->element_cell, 3 * elements));
    RUGA_TRY(RUGA_NEW(lattice->element_node, (size_t)lattice->nodes_per_element * elements));
    RUGA_TRY(RUGA_NEW(lattice->volume, 27 * elements));
    RUGA_TRY(RUGA_NEW(lattice->rest, 3 * (size_t)lattice->node_count));
    for (int e = 0; e < lattice->element_count; e++) {
        int cell[3] = {e % cells[0], e / cells[0] % cells[1], e / cells[0] / cells[1]};
        memcpy(lattice->element_cell + 3 * (size_t)e, cell, sizeof cell);
        for (int s = 0; s < 27; s++) {
            lattice->volume[27 * (size_t)e + (size_t)s] = sub_cell_volume(s);
        }
        for (int i = 0; i < lattice->nodes_per_element; i++) {
            int at[3] = {cell[0] + i % n, cell[1] + i / n % n, cell[2] + i / n / n};
            int node = at[0] + nodes[0] * (at[1] + nodes[1] * at[2]);
            lattice->element_node[(size_t)e * (size_t)lattice->nodes_per_element + (size_t)i] = node;
            rest_position(lattice, e, i, lattice->rest + 3 * (size_t)node);
        }
    }
    scale_volumes(lattice);
    return RUGA_OK;
}
