// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Linear rows that hold a region's material in the lattice. All points p of the region (embedded vertices,
// and quadrature points that stand for material) shall follow the handle's motion T: sum_k N_k(p) q_k = T(p).
// There are many times more points than nodes, and nearly dependent ones, so rows are chosen as follows, for
// one component at a time (components that the same handles hold share the choice).
//
// 1. T is affine, and B reproduces affine maps: q_k = T(rest_k) satisfies every row. Where an element's
// points
//    determine all its nodes (full rank on those not yet held), the rows of its points are therefore
//    equivalent to holding these nodes: perfectly conditioned rows of a single entry. An element that has
//    been held helps its neighbours, which share most of its nodes.
// 2. What is left are elements that the region holds in part (its rim, or a surface alone). There, rows of
//    points are kept: in each element by pivoting, at most as many as it has free nodes; over all elements by
//    a rank-revealing QR.
//
// Independent means: at least 1e-4 of the row (whose entries sum to one) is orthogonal to those kept before.
// A node with less influence than that on the held material is left to the elasticity instead of being flung
// far out to correct the last digits; material that it moves follows the handle all the same to within 1e-4
// times the node's own deviation from T. The last pivot of a whole quadratic element's 27 points is 2e-3, so
// such an element is recognised.
//
// Handles come in order, and the first wins: points that an earlier handle holds are not held again, and rows
// of later ones must be independent of the earlier ones'. Where two handles that move apart meet within a
// cell, both cannot be followed: a point with more than half of its weight on nodes that another motion holds
// is left to it, since to correct it the free nodes would have to overshoot by more than the difference.
#include "constraints/attachments.h"

#include "constraints/independent.h"
#include "core/memory.h"
#include "core/vec3.h"

#include <limits.h>
#include <math.h>
#include <string.h>

static const double INDEPENDENCE = 1e-4;

// Sample points of an element's material: its quadrature points, and where the cell is full also the points
// of {0, 1/2, 1}^3, so that a thin region on the material's outer face holds all of the face.
enum { GRID_POINTS = 27, ELEMENT_POINTS = RUGA_LATTICE_POINTS + GRID_POINTS };

// A row kept for one component.
typedef struct held_row {
    int handle;
    int element;          // -1: a node is held directly
    int node;             // then this one
    const double* weight; // otherwise of the element's nodes
    double point[3];
} held_row;

// Material points carry numbers: vertices of the surface first, then ELEMENT_POINTS for each element.
typedef struct builder {
    const ruga_lattice* lattice;
    const ruga_mesh* mesh;
    const ruga_handle_def* handles;
    int handle_count;
    int point_count;
    double* shape; // [27][nodes per element] at the quadrature points
    int* selected; // [V]
    bool* seen;    // [handles] whether the handle selected any material

    // For the component at hand:
    int* owner;    // [point_count] handle that holds the point, -1 = none
    int* holder;   // [N] handle that holds the node itself, -1 = none
    bool* touched; // [N] a kept row of a point of an earlier handle uses the node
    held_row* row;
    int row_count, row_capacity;

    // For the handle at hand:
    int* element_start; // [E + 1] its points by element
    int* point;         // [point_count]
    int* tried;         // [E] free nodes at the last attempt to hold the element whole
    double* dense;      // [most points of an element][nodes per element]
    int* dense_point;   // [most points of an element]
    int dense_capacity, dense_point_capacity;
} builder;

static const double* point_weight(const builder* b, int point) {
    int n = b->lattice->nodes_per_element;
    int v = b->lattice->vertex_count;
    return point < v ? b->lattice->vertex_weight + (size_t)point * (size_t)n
                     : b->shape + (size_t)((point - v) % ELEMENT_POINTS * n);
}

static int point_element(const builder* b, int point) {
    int v = b->lattice->vertex_count;
    return point < v ? b->lattice->vertex_element[point] : (point - v) / ELEMENT_POINTS;
}

// Local coordinates and rest position of a sample point of an element.
static void sample_point(const ruga_lattice* lattice, int element, int sample, double xi[3], double x[3]) {
    if (sample < RUGA_LATTICE_POINTS) {
        ruga_lattice_point(lattice, element, sample, xi, x);
        return;
    }
    int g = sample - RUGA_LATTICE_POINTS, at[3] = {g % 3, g / 3 % 3, g / 9};
    for (int i = 0; i < 3; i++) {
        xi[i] = 0.5 * at[i];
        x[i] = lattice->origin[i] + (lattice->element_cell[3 * element + i] + xi[i]) * lattice->cell_size[i];
    }
}

static bool is_full(const ruga_lattice* lattice, int element) {
    double sum = 0, cell = lattice->cell_size[0] * lattice->cell_size[1] * lattice->cell_size[2];
    for (int g = 0; g < RUGA_LATTICE_POINTS; g++) {
        sum += lattice->volume[RUGA_LATTICE_POINTS * element + g];
    }
    return sum > (1 - 1e-9) * cell;
}

static void point_rest(const builder* b, int point, double x[3]) {
    int v = b->lattice->vertex_count;
    double xi[3];
    if (point < v) {
        memcpy(x, b->mesh->position + 3 * (size_t)point, 3 * sizeof *x);
    } else {
        sample_point(b->lattice, (point - v) / ELEMENT_POINTS, (point - v) % ELEMENT_POINTS, xi, x);
    }
}

static bool holds_interior(const ruga_handle_def* handle) {
    return (handle->kind == RUGA_HANDLE_FIX || handle->kind == RUGA_HANDLE_MOVE) &&
           handle->hold != RUGA_HOLD_SKIN;
}

static bool is_spatial(const ruga_region* region) {
    return region->kind != RUGA_REGION_GROUP && region->kind != RUGA_REGION_VERTICES;
}

static void claim_point(builder* b, int handle, int point) {
    b->seen[handle] = true;
    if (b->owner[point] < 0) {
        b->owner[point] = handle;
    }
}

// Makes a handle the owner of the region's points that have none.
static ruga_status claim_region(builder* b, int handle) {
    const ruga_region* region = &b->handles[handle].region;
    const ruga_lattice* lattice = b->lattice;
    int count;
    ruga_status status = ruga_region_vertices(region, b->mesh, &count, b->selected);
    if (status != RUGA_OK) {
        return ruga_fail_prefix(status, "handles.%d", handle);
    }
    for (int k = 0; k < count; k++) {
        if (lattice->vertex_element[b->selected[k]] >= 0) {
            claim_point(b, handle, b->selected[k]);
        }
    }
    if (is_spatial(region)) {
        double slack = ruga_region_slack(b->mesh);
        for (int e = 0; e < lattice->element_count; e++) {
            bool full = is_full(lattice, e);
            for (int g = 0; g < ELEMENT_POINTS; g++) {
                bool material =
                    g < RUGA_LATTICE_POINTS ? lattice->volume[RUGA_LATTICE_POINTS * e + g] > 0 : full;
                double x[3], xi[3];
                sample_point(lattice, e, g, xi, x);
                if (material && ruga_region_contains_within(region, x, slack)) {
                    claim_point(b, handle, lattice->vertex_count + ELEMENT_POINTS * e + g);
                }
            }
        }
    }
    return b->seen[handle] ? RUGA_OK : ruga_region_empty(region, b->mesh, handle, "material");
}

// The handle's points, sorted by element, and room for the largest element's rows.
static ruga_status sort_points(builder* b, int handle) {
    int elements = b->lattice->element_count;
    memset(b->element_start, 0, (size_t)(elements + 1) * sizeof *b->element_start);
    for (int p = 0; p < b->point_count; p++) {
        if (b->owner[p] == handle) {
            b->element_start[point_element(b, p)]++;
        }
    }
    int most = 0;
    for (int e = 0, sum = 0; e <= elements; e++) {
        int count = b->element_start[e];
        most = count > most ? count : most;
        sum += count;
        b->element_start[e] = sum; // where the element ends, until filled from the back
    }
    for (int p = b->point_count - 1; p >= 0; p--) {
        if (b->owner[p] == handle) {
            b->point[--b->element_start[point_element(b, p)]] = p;
        }
    }
    RUGA_TRY(RUGA_RESERVE(b->dense_point, b->dense_point_capacity, most));
    return RUGA_RESERVE(b->dense, b->dense_capacity, (size_t)most * (size_t)b->lattice->nodes_per_element);
}

static ruga_status keep_row(builder* b, held_row row) {
    RUGA_TRY(RUGA_RESERVE(b->row, b->row_capacity, b->row_count + 1));
    b->row[b->row_count++] = row;
    return RUGA_OK;
}

// Local numbers of an element's nodes that are not held; their number is returned.
static int free_nodes(const builder* b, int element, int local[RUGA_LATTICE_NODES_MAX]) {
    int n = b->lattice->nodes_per_element, count = 0;
    for (int k = 0; k < n; k++) {
        if (b->holder[b->lattice->element_node[element * n + k]] < 0) {
            local[count++] = k;
        }
    }
    return count;
}

static bool equal3(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool same_motion(const ruga_handle_def* a, const ruga_handle_def* b) {
    if (a->kind != b->kind || a->kind == RUGA_HANDLE_FIX) {
        return a->kind == b->kind;
    }
    bool same_ramp = a->ramped == b->ramped &&
                     (!a->ramped || (a->during[0] == b->during[0] && a->during[1] == b->during[1]));
    return same_ramp && equal3(a->translate, b->translate) && equal3(a->rotate_axis, b->rotate_axis) &&
           a->rotate_angle == b->rotate_angle && equal3(a->rotate_center, b->rotate_center);
}

// Weight of a point on nodes that a handle of another motion holds.
static double foreign_weight(const builder* b, int handle, int element, const double* weight) {
    int n = b->lattice->nodes_per_element;
    double sum = 0;
    for (int k = 0; k < n; k++) {
        int holder = b->holder[b->lattice->element_node[element * n + k]];
        if (holder >= 0 && holder != handle && !same_motion(&b->handles[holder], &b->handles[handle])) {
            sum += weight[k];
        }
    }
    return sum;
}

// Picks independent rows of the element's points on its free nodes; picked [27] receives points.
static int pick_points(builder* b, int handle, int element, int count, const int* local, int* picked) {
    double* out = b->dense;
    int rows = 0;
    for (int i = b->element_start[element]; i < b->element_start[element + 1]; i++) {
        const double* weight = point_weight(b, b->point[i]);
        if (foreign_weight(b, handle, element, weight) > 0.5) {
            continue;
        }
        b->dense_point[rows++] = b->point[i];
        for (int k = 0; k < count; k++) {
            *out++ = weight[local[k]];
        }
    }
    int rank = ruga_independent_pick(rows, count, b->dense, INDEPENDENCE, picked);
    for (int k = 0; k < rank; k++) {
        picked[k] = b->dense_point[picked[k]];
    }
    return rank;
}

// Holds all free nodes of the element where its points determine them and no earlier row has a say in them.
static ruga_status try_element(builder* b, int handle, int element, bool* changed) {
    int local[RUGA_LATTICE_NODES_MAX], picked[RUGA_LATTICE_NODES_MAX];
    int n = b->lattice->nodes_per_element;
    const int* node = b->lattice->element_node + (size_t)element * (size_t)n;
    int count = free_nodes(b, element, local);
    if (count == 0 || count == b->tried[element] ||
        b->element_start[element + 1] - b->element_start[element] < count) {
        return RUGA_OK;
    }
    b->tried[element] = count;
    for (int k = 0; k < count; k++) {
        if (b->touched[node[local[k]]]) {
            return RUGA_OK;
        }
    }
    if (pick_points(b, handle, element, count, local, picked) < count) {
        return RUGA_OK;
    }
    *changed = true;
    for (int k = 0; k < count; k++) {
        held_row row = {.handle = handle, .element = -1, .node = node[local[k]]};
        memcpy(row.point, b->lattice->rest + 3 * (size_t)row.node, sizeof row.point);
        b->holder[row.node] = handle;
        RUGA_TRY(keep_row(b, row));
    }
    return RUGA_OK;
}

static ruga_status hold_whole_elements(builder* b, int handle) {
    memset(b->tried, 0, (size_t)b->lattice->element_count * sizeof *b->tried);
    for (bool changed = true; changed;) {
        changed = false;
        for (int e = 0; e < b->lattice->element_count; e++) {
            RUGA_TRY(try_element(b, handle, e, &changed));
        }
    }
    return RUGA_OK;
}

// Sweeps the elements for candidates: independent rows of each on its free nodes, appended to the kept rows.
static ruga_status add_candidates(builder* b, int handle) {
    for (int e = 0; e < b->lattice->element_count; e++) {
        int local[RUGA_LATTICE_NODES_MAX], picked[RUGA_LATTICE_NODES_MAX];
        int count = b->element_start[e] < b->element_start[e + 1] ? free_nodes(b, e, local) : 0;
        int rank = count ? pick_points(b, handle, e, count, local, picked) : 0;
        for (int k = 0; k < rank; k++) {
            held_row row = {.handle = handle, .element = e, .node = -1, .weight = point_weight(b, picked[k])};
            point_rest(b, picked[k], row.point);
            RUGA_TRY(keep_row(b, row));
        }
    }
    return RUGA_OK;
}

// Entries of the rows of points on free nodes, as ruga_independent_rows takes them.
typedef struct sparse_rows {
    int count;
    int* row;  // [count] of builder.row
    int fixed; // the first ones, of earlier handles
    int* start;
    int* column;
    double* value;
    bool* kept;
} sparse_rows;

static ruga_status gather_rows(const builder* b, int first, sparse_rows* s) {
    size_t n = (size_t)b->lattice->nodes_per_element;
    for (int i = 0; i < b->row_count; i++) {
        s->count += b->row[i].element >= 0;
        s->fixed += b->row[i].element >= 0 && i < first;
    }
    RUGA_TRY(RUGA_NEW(s->row, s->count));
    RUGA_TRY(RUGA_NEW(s->start, s->count + 1));
    RUGA_TRY(RUGA_NEW(s->column, (size_t)s->count * n));
    RUGA_TRY(RUGA_NEW(s->value, (size_t)s->count * n));
    RUGA_TRY(RUGA_NEW_ZERO(s->kept, s->count));
    int out = 0, count = 0;
    for (int i = 0; i < b->row_count; i++) {
        if (b->row[i].element < 0) {
            continue;
        }
        s->row[count] = i;
        s->start[count++] = out;
        const int* node = b->lattice->element_node + (size_t)b->row[i].element * n;
        for (size_t k = 0; k < n; k++) {
            if (b->holder[node[k]] < 0 && b->row[i].weight[k] != 0) {
                s->column[out] = node[k];
                s->value[out++] = b->row[i].weight[k];
            }
        }
    }
    s->start[count] = out;
    return RUGA_OK;
}

// Drops those of the handle's candidates (rows from `first` on) that depend on rows of points before them.
static ruga_status drop_dependent(builder* b, int first) {
    ruga_status status = RUGA_OK;
    sparse_rows s = {0};
    RUGA_TRY_DONE(gather_rows(b, first, &s));
    RUGA_TRY_DONE(ruga_independent_rows(s.count, b->lattice->node_count, s.fixed, s.start, s.column, s.value,
                                        INDEPENDENCE, s.kept));
    int out = first;
    for (int i = 0; i < s.count; i++) {
        if (s.row[i] >= first && s.kept[i]) {
            b->row[out++] = b->row[s.row[i]];
        }
    }
    b->row_count = out;
done:
    ruga_release(s.row);
    ruga_release(s.start);
    ruga_release(s.column);
    ruga_release(s.value);
    ruga_release(s.kept);
    return status;
}

static ruga_status hold_handle(builder* b, int handle) {
    int n = b->lattice->nodes_per_element;
    RUGA_TRY(sort_points(b, handle));
    RUGA_TRY(hold_whole_elements(b, handle));
    int first = b->row_count;
    RUGA_TRY(add_candidates(b, handle));
    if (b->row_count == first) {
        return RUGA_OK;
    }
    RUGA_TRY(drop_dependent(b, first));
    for (int i = first; i < b->row_count; i++) {
        for (int k = 0; k < n; k++) {
            b->touched[b->lattice->element_node[b->row[i].element * n + k]] |= b->row[i].weight[k] != 0;
        }
    }
    return RUGA_OK;
}

// All rows of one component.
static ruga_status hold_component(builder* b, int axis) {
    b->row_count = 0;
    for (int k = 0; k < b->lattice->node_count; k++) {
        b->holder[k] = -1;
    }
    memset(b->touched, 0, (size_t)b->lattice->node_count * sizeof *b->touched);
    for (int p = 0; p < b->point_count; p++) {
        b->owner[p] = -1;
    }
    for (int h = 0; h < b->handle_count; h++) {
        if (holds_interior(&b->handles[h]) && b->handles[h].axes[axis]) {
            RUGA_TRY(claim_region(b, h));
            RUGA_TRY(hold_handle(b, h));
        }
    }
    return RUGA_OK;
}

static ruga_status append_rows(const builder* b, int axis, ruga_rows* rows, int capacity[6]) {
    int n = b->lattice->nodes_per_element;
    int count = rows->count + b->row_count;
    int entries = rows->count ? rows->start[rows->count] : 0;
    RUGA_TRY(RUGA_RESERVE(rows->axis, capacity[0], count));
    RUGA_TRY(RUGA_RESERVE(rows->handle, capacity[1], count));
    RUGA_TRY(RUGA_RESERVE(rows->start, capacity[2], count + 1));
    RUGA_TRY(RUGA_RESERVE(rows->point, capacity[3], 3 * (size_t)count));
    RUGA_TRY(RUGA_RESERVE(rows->node, capacity[4], (size_t)entries + (size_t)b->row_count * (size_t)n));
    RUGA_TRY(RUGA_RESERVE(rows->weight, capacity[5], (size_t)entries + (size_t)b->row_count * (size_t)n));
    rows->start[rows->count] = entries;
    for (int i = 0; i < b->row_count; i++) {
        const held_row* row = &b->row[i];
        rows->axis[rows->count] = axis;
        rows->handle[rows->count] = row->handle;
        memcpy(rows->point + 3 * (size_t)rows->count, row->point, sizeof row->point);
        if (row->element < 0) {
            rows->node[entries] = row->node;
            rows->weight[entries++] = 1;
        }
        for (int k = 0; row->element >= 0 && k < n; k++) {
            if (row->weight[k] != 0) {
                rows->node[entries] = b->lattice->element_node[row->element * n + k];
                rows->weight[entries++] = row->weight[k];
            }
        }
        rows->start[++rows->count] = entries;
    }
    return RUGA_OK;
}

static bool same_handles(const builder* b, int axis, int other) {
    for (int h = 0; h < b->handle_count; h++) {
        if (holds_interior(&b->handles[h]) && b->handles[h].axes[axis] != b->handles[h].axes[other]) {
            return false;
        }
    }
    return true;
}

static ruga_status allocate(builder* b) {
    const ruga_lattice* lattice = b->lattice;
    b->point_count = lattice->vertex_count + ELEMENT_POINTS * lattice->element_count;
    RUGA_TRY(RUGA_NEW(b->shape, ELEMENT_POINTS * (size_t)lattice->nodes_per_element));
    RUGA_TRY(RUGA_NEW(b->selected, b->mesh->vertex_count));
    RUGA_TRY(RUGA_NEW_ZERO(b->seen, b->handle_count));
    RUGA_TRY(RUGA_NEW(b->owner, b->point_count));
    RUGA_TRY(RUGA_NEW(b->holder, lattice->node_count));
    RUGA_TRY(RUGA_NEW(b->touched, lattice->node_count));
    RUGA_TRY(RUGA_NEW(b->element_start, lattice->element_count + 1));
    RUGA_TRY(RUGA_NEW(b->point, b->point_count));
    RUGA_TRY(RUGA_NEW(b->tried, lattice->element_count));
    for (int g = 0; g < ELEMENT_POINTS && lattice->element_count > 0; g++) {
        double xi[3], x[3];
        sample_point(lattice, 0, g, xi, x);
        ruga_lattice_shape(lattice, xi, b->shape + (size_t)(g * lattice->nodes_per_element), NULL);
    }
    return RUGA_OK;
}

static void release(builder* b) {
    ruga_release(b->shape);
    ruga_release(b->selected);
    ruga_release(b->seen);
    ruga_release(b->owner);
    ruga_release(b->holder);
    ruga_release(b->touched);
    ruga_release(b->row);
    ruga_release(b->element_start);
    ruga_release(b->point);
    ruga_release(b->tried);
    ruga_release(b->dense);
    ruga_release(b->dense_point);
}

ruga_status ruga_rows_create(const ruga_lattice* lattice, const ruga_mesh* mesh, int handle_count,
                             const ruga_handle_def* handles, ruga_rows* rows) {
    RUGA_ASSERT(lattice->vertex_count == mesh->vertex_count);
    ruga_status status = RUGA_OK;
    builder b = {.lattice = lattice, .mesh = mesh, .handles = handles, .handle_count = handle_count};
    int capacity[6] = {0};
    *rows = (ruga_rows){0};
    RUGA_TRY_DONE(allocate(&b));
    for (int axis = 0; axis < 3; axis++) {
        if (axis == 0 || !same_handles(&b, axis, axis - 1)) {
            RUGA_TRY_DONE(hold_component(&b, axis));
        }
        RUGA_TRY_DONE(append_rows(&b, axis, rows, capacity));
    }
done:
    release(&b);
    if (status != RUGA_OK) {
        ruga_rows_clear(rows);
    }
    return status;
}

double ruga_rows_nearest(const ruga_rows* rows, const ruga_lattice* lattice, const ruga_handle_def* handles,
                         int pair[2]) {
    double nearest = INFINITY;
    for (int i = 0, first = 0; i < rows->count; i++) {
        first = rows->axis[i] == rows->axis[first] ? first : i;
        for (int j = first; j < i; j++) {
            if (rows->handle[i] == rows->handle[j] ||
                same_motion(&handles[rows->handle[i]], &handles[rows->handle[j]])) {
                continue;
            }
            double far = 0;
            for (int k = 0; k < 3; k++) {
                far =
                    fmax(far, fabs(rows->point[3 * i + k] - rows->point[3 * j + k]) / lattice->cell_size[k]);
            }
            if (far < nearest) {
                nearest = far;
                pair[0] = rows->handle[j];
                pair[1] = rows->handle[i];
            }
        }
    }
    return nearest;
}

void ruga_rows_clear(ruga_rows* rows) {
    ruga_release(rows->axis);
    ruga_release(rows->handle);
    ruga_release(rows->start);
    ruga_release(rows->node);
    ruga_release(rows->weight);
    ruga_release(rows->point);
    *rows = (ruga_rows){0};
}
