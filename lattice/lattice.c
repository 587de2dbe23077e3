// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The lattice from a mesh (Remillard and Kry 2013, section 5.1): fits the grid of cells, cuts the surface by
// it (slice.c), closes the pieces (caps.c, pieces.c), makes elements and nodes of them (assemble.c) and binds
// the surface to its elements (embedding.c).
#include "lattice/lattice.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "lattice/assemble.h"

#include <string.h>

static const double CELLS_MAX = 5e6;
// fill mesh: the box is this part of a cell larger on each side, so that its faces are not the body's.
static const double MARGIN = 1e-3;

void ruga_lattice_clear(ruga_lattice* lattice) {
    ruga_release(lattice->element_cell);
    ruga_release(lattice->element_node);
    ruga_release(lattice->volume);
    ruga_release(lattice->rest);
    ruga_release(lattice->vertex_element);
    ruga_release(lattice->vertex_weight);
    ruga_release(lattice->gather_start);
    ruga_release(lattice->gather);
    *lattice = (ruga_lattice){0};
}

static ruga_status check_def(const ruga_lattice_def* def) {
    if (def->cells < 1) {
        return ruga_fail(RUGA_BAD_INPUT, "lattice.cells is %d; it must be at least 1", def->cells);
    }
    if (def->degree != 1 && def->degree != 2) {
        return ruga_fail(RUGA_BAD_INPUT, "lattice.degree is %d; it must be 1 or 2", def->degree);
    }
    if (!(def->depth >= 0 && def->depth < INFINITY)) {
        return ruga_fail(RUGA_BAD_INPUT, "lattice.depth is %g m; it must be 0 (one cell) or positive",
                         def->depth);
    }
    return RUGA_OK;
}

// Box of the vertices that triangles use, all finite.
static ruga_status find_bounds(const ruga_mesh* mesh, double min[3], double max[3]) {
    if (mesh->triangle_count == 0) {
        return ruga_fail(RUGA_BAD_MESH, "the mesh has no faces, so there is nothing to build a lattice for");
    }
    for (int axis = 0; axis < 3; axis++) {
        min[axis] = INFINITY;
        max[axis] = -INFINITY;
    }
    for (int i = 0; i < 3 * mesh->triangle_count; i++) {
        int v = mesh->triangle[i];
        const double* x = mesh->position + 3 * (size_t)v;
        for (int axis = 0; axis < 3; axis++) {
            if (!isfinite(x[axis])) {
                return ruga_fail(RUGA_BAD_MESH, "vertex %d has a coordinate that is not a finite number", v);
            }
            min[axis] = fmin(min[axis], x[axis]);
            max[axis] = fmax(max[axis], x[axis]);
        }
    }
    return RUGA_OK;
}

// An edge with a face on one side only, or -1.
static int open_edge(const ruga_connectivity* connectivity) {
    for (int e = 0; e < connectivity->edge_count; e++) {
        if (connectivity->edge_triangle[e][0] < 0 || connectivity->edge_triangle[e][1] < 0) {
            return e;
        }
    }
    return -1;
}

// Volume relative to the box's corner: meaningful for closed meshes far from the origin, too.
static double signed_volume(const ruga_mesh* mesh, const double corner[3]) {
    double sum = 0;
    for (int t = 0; t < mesh->triangle_count; t++) {
        double p[3][3], normal[3];
        for (int i = 0; i < 3; i++) {
            ruga_subtract(mesh->position + 3 * (size_t)mesh->triangle[3 * t + i], corner, p[i]);
        }
        ruga_cross(p[1], p[2], normal);
        sum += ruga_dot(p[0], normal) / 6;
    }
    return sum;
}

static ruga_status check_watertight(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                    const double min[3]) {
    int e = open_edge(connectivity);
    if (e >= 0) {
        const int* ends = connectivity->edge[e];
        const double* x = mesh->position + 3 * (size_t)ends[0];
        return ruga_fail(
            RUGA_BAD_MESH,
            "the mesh is not watertight: the edge between vertices %d and %d at (%g, %g, %g) m has a "
            "face on one side only; close the hole, or use fill: box",
            ends[0], ends[1], x[0], x[1], x[2]);
    }
    double volume = signed_volume(mesh, min);
    if (!(volume > 0)) {
        return ruga_fail(
            RUGA_BAD_MESH,
            "the mesh encloses a volume of %g m^3: its faces point inwards or it is flat; turn the faces "
            "outwards",
            volume);
    }
    return RUGA_OK;
}

static ruga_status check_count(const double cells[3]) {
    double count = cells[0] * cells[1] * cells[2];
    if (!(count <= CELLS_MAX)) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "the lattice would have %.0f x %.0f x %.0f = %.3g cells, more than %.0f: lower lattice.cells",
            cells[0], cells[1], cells[2], count, CELLS_MAX);
    }
    return RUGA_OK;
}

// Cells over a box, as nearly cubes as whole numbers of them allow.
static ruga_status fit_cells(const double extent[3], double size, ruga_lattice* lattice) {
    double cells[3];
    for (int axis = 0; axis < 3; axis++) {
        cells[axis] = fmax(1, floor(extent[axis] / size + 0.5));
    }
    RUGA_TRY(check_count(cells));
    for (int axis = 0; axis < 3; axis++) {
        lattice->cells[axis] = (int)cells[axis];
        lattice->cell_size[axis] = extent[axis] / cells[axis];
        if (!(lattice->cell_size[axis] > 0)) {
            return ruga_fail(RUGA_BAD_MESH, "the mesh has no extent along %c, so no cell fits it",
                             "xyz"[axis]);
        }
    }
    return RUGA_OK;
}

// Average normal of the faces, not normalised: which way an open sheet looks.
static void sum_normals(const ruga_mesh* mesh, double normal[3]) {
    normal[0] = normal[1] = normal[2] = 0;
    for (int t = 0; t < mesh->triangle_count; t++) {
        double n[3];
        ruga_mesh_triangle_normal(mesh, t, n);
        ruga_add_scaled(1, n, normal);
    }
}

// The box under an open sheet: its top face holds the sheet's highest point along the axis nearest the
// average normal, and it reaches `depth` below that, or as deep as the sheet itself.
static void box_under_sheet(const ruga_mesh* mesh, double depth, double cells, double min[3], double max[3]) {
    double normal[3], longest = 0;
    sum_normals(mesh, normal);
    int up = 0;
    for (int axis = 1; axis < 3; axis++) {
        up = fabs(normal[axis]) > fabs(normal[up]) ? axis : up;
    }
    for (int axis = 0; axis < 3; axis++) {
        longest = axis != up ? fmax(longest, max[axis] - min[axis]) : longest;
    }
    double thickness = fmax(depth > 0 ? depth : longest / cells, max[up] - min[up]);
    if (normal[up] < 0) {
        max[up] = min[up] + thickness;
    } else {
        min[up] = max[up] - thickness;
    }
}

static ruga_status fit_grid(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                            const ruga_lattice_def* def, ruga_lattice* lattice) {
    double min[3], max[3], extent[3];
    RUGA_TRY(find_bounds(mesh, min, max));
    ruga_subtract(max, min, extent);
    double longest = fmax(extent[0], fmax(extent[1], extent[2]));
    if (def->fill == RUGA_FILL_MESH) {
        RUGA_TRY(check_watertight(mesh, connectivity, min));
    } else if (open_edge(connectivity) >= 0) {
        box_under_sheet(mesh, def->depth, def->cells, min, max);
        ruga_subtract(max, min, extent);
    }
    RUGA_TRY(fit_cells(extent, longest / def->cells, lattice));
    for (int axis = 0; axis < 3; axis++) {
        double margin = def->fill == RUGA_FILL_MESH ? MARGIN * lattice->cell_size[axis] : 0;
        lattice->origin[axis] = min[axis] - margin;
        lattice->cell_size[axis] += 2 * margin / lattice->cells[axis];
    }
    return RUGA_OK;
}

// Elements of a box's vertices: the cell that they lie in; those on the box's far faces in the last one.
static void locate_in_box(const ruga_lattice* lattice, int count, const double (*u)[3], int* element) {
    for (int v = 0; v < count; v++) {
        int at[3];
        for (int axis = 0; axis < 3; axis++) {
            double last = lattice->cells[axis] - 1;
            at[axis] = (int)fmax(0, fmin(last, floor(u[v][axis])));
        }
        element[v] = at[0] + lattice->cells[0] * (at[1] + lattice->cells[1] * at[2]);
    }
}

// Every vertex lies in one sub-cell piece: that of any triangle around it.
static ruga_status build_from_surface(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                      const double (*u)[3], ruga_lattice* lattice, int* element) {
    ruga_slices slices = {0};
    ruga_caps caps = {0};
    ruga_pieces pieces = {0};
    int* piece_element = NULL;
    int sub_cells[3] = {3 * lattice->cells[0], 3 * lattice->cells[1], 3 * lattice->cells[2]};
    ruga_status status;
    RUGA_TRY_DONE(ruga_slices_create(mesh, connectivity, u, &slices));
    RUGA_TRY_DONE(ruga_caps_create(&slices, sub_cells, &caps));
    RUGA_TRY_DONE(ruga_pieces_create(&caps, &pieces));
    RUGA_TRY_DONE(ruga_lattice_assemble(&caps, &pieces, lattice, &piece_element));
    for (int t = slices.triangle_count - 1; t >= 0; t--) { // the first triangle around a vertex counts
        for (int i = 0; i < 3; i++) {
            int p = slices.triangle[t].point[i];
            if (p < mesh->vertex_count) {
                element[p] = piece_element[pieces.triangle_piece[t]];
            }
        }
    }
done:
    ruga_release(piece_element);
    ruga_pieces_clear(&pieces);
    ruga_caps_clear(&caps);
    ruga_slices_clear(&slices);
    return status;
}

static ruga_status build(const ruga_mesh* mesh, const ruga_connectivity* connectivity, ruga_fill fill,
                         ruga_lattice* lattice) {
    int vertices = mesh->vertex_count;
    double(*u)[3] = NULL;
    int* element = NULL;
    ruga_status status;
    RUGA_TRY_DONE(RUGA_NEW(u, vertices));
    RUGA_TRY_DONE(RUGA_NEW(element, vertices));
    for (int v = 0; v < vertices; v++) {
        element[v] = -1;
        for (int axis = 0; axis < 3; axis++) {
            u[v][axis] = (mesh->position[3 * (size_t)v + (size_t)axis] - lattice->origin[axis]) /
                         lattice->cell_size[axis];
        }
    }
    if (fill == RUGA_FILL_BOX) {
        RUGA_TRY_DONE(ruga_lattice_fill(lattice));
        locate_in_box(lattice, vertices, (const double(*)[3])u, element);
    } else {
        RUGA_TRY_DONE(build_from_surface(mesh, connectivity, (const double(*)[3])u, lattice, element));
    }
    RUGA_TRY_DONE(ruga_lattice_bind(lattice, vertices, (const double(*)[3])u, element));
done:
    ruga_release(u);
    ruga_release(element);
    return status;
}

ruga_status ruga_lattice_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                const ruga_lattice_def* def, ruga_lattice* lattice) {
    *lattice = (ruga_lattice){0};
    RUGA_TRY(check_def(def));
    lattice->degree = def->degree;
    lattice->nodes_per_element = def->degree == 2 ? 27 : 8;
    ruga_status status;
    RUGA_TRY_DONE(fit_grid(mesh, connectivity, def, lattice));
    RUGA_TRY_DONE(build(mesh, connectivity, def->fill, lattice));
done:
    if (status != RUGA_OK) {
        ruga_lattice_clear(lattice);
    }
    return status;
}
