// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Motions of handles over time, and external forces on the skin.
//
// Pressure. The potential is p V, V the volume that the region's triangles sweep on straight lines from rest
// X to x (positive outward). With u = mean of x_i - X_i over the corners, rest edges a = X1 - X0, c = X2 - X0
// and edges b = x1 - x0, d = x2 - x0, the area vector runs along the way from (a x c)/2 to (b x d)/2, and
//     V_t = integral_0^1 u . N(s) ds = u . (2 a x c + a x d + b x c + 2 b x d) / 12.
// Its gradient at a vertex inside the region is exactly the follower pressure's p A n / 3 of the deformed
// triangles, since what neighbouring triangles sweep shares its walls; the same holds everywhere for a closed
// region. On the rim of an open region a follower pressure has no potential; here the rim's forces are those
// of the moving wall, so that the net force is p times the region's area vector AVERAGED along the way from
// rest: equal to the follower's at rest and under any motion that does not turn the region.
#include "constraints/attachments.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <string.h>

double ruga_handle_ramp(const ruga_handle_def* handle, double time) {
    if (!handle->ramped || time >= handle->during[1]) {
        return 1;
    }
    double begin = handle->during[0], length = handle->during[1] - begin;
    return time <= begin || length <= 0 ? 0 : (time - begin) / length;
}

void ruga_handle_target(const ruga_handle_def* handle, double time, const double rest[3], double target[3]) {
    memcpy(target, rest, 3 * sizeof *target);
    if (handle->kind != RUGA_HANDLE_MOVE) {
        return;
    }
    double ramp = ruga_handle_ramp(handle, time);
    double axis[3] = {handle->rotate_axis[0], handle->rotate_axis[1], handle->rotate_axis[2]};
    if (ruga_normalize(axis) > 0) {
        // Rodrigues: r + sin(angle) k x r + (1 - cos(angle)) k x (k x r); 1 - cos as 2 sin^2 of the half.
        double angle = ramp * handle->rotate_angle, half = sin(angle / 2);
        double r[3], kr[3], kkr[3];
        ruga_subtract(rest, handle->rotate_center, r);
        ruga_cross(axis, r, kr);
        ruga_cross(axis, kr, kkr);
        ruga_add_scaled(sin(angle), kr, target);
        ruga_add_scaled(2 * half * half, kkr, target);
    }
    ruga_add_scaled(ramp, handle->translate, target);
}

typedef struct load {
    ruga_handle_def handle; // for its kind, pressure and ramp; its pointers are not used
    int triangle_count;
    int (*triangle)[3];           // under pressure
    ruga_load_place (*corner)[3]; // where its corners are; NULL = at vertices
    int vertex_count;
    int* vertex;            // under a dead load
    ruga_load_place* place; // where they are; NULL = at themselves
    double (*force)[3];     // [vertex_count] N at full ramp
} load;

struct ruga_loads {
    int vertex_count;
    double* rest; // [V][3]
    int count;
    load* load;
};

void ruga_loads_destroy(ruga_loads** loads) {
    if (!*loads) {
        return;
    }
    for (int i = 0; i < (*loads)->count; i++) {
        ruga_release((*loads)->load[i].triangle);
        ruga_release((*loads)->load[i].corner);
        ruga_release((*loads)->load[i].place);
        ruga_release((*loads)->load[i].vertex);
        ruga_release((*loads)->load[i].force);
    }
    ruga_release((*loads)->load);
    ruga_release((*loads)->rest);
    ruga_release(*loads);
    *loads = NULL;
}

static bool is_load(const ruga_handle_def* handle) {
    return handle->kind == RUGA_HANDLE_PRESS || handle->kind == RUGA_HANDLE_FORCE ||
           handle->kind == RUGA_HANDLE_LINE_FORCE;
}

// What creating one load needs: the selection as a list and as marks.
typedef struct selection {
    const ruga_mesh* mesh;
    const ruga_connectivity* connectivity;
    const ruga_load_place (*place)[3]; // [F] or NULL
    int index;                         // of the handle, for sentences
    int count;
    int* list;     // [V]
    bool* in;      // [V]
    double* share; // [V] scratch: area or length that each vertex stands for
} selection;

static ruga_status add_pressure(const selection* s, load* out) {
    const ruga_region* region = &out->handle.region;
    int group = -1;
    if (region->kind == RUGA_REGION_GROUP) {
        RUGA_TRY(ruga_region_group(region, s->mesh, &group));
    }
    RUGA_TRY(RUGA_NEW(out->triangle, s->mesh->triangle_count));
    if (s->place) {
        RUGA_TRY(RUGA_NEW(out->corner, s->mesh->triangle_count));
    }
    for (int t = 0; t < s->mesh->triangle_count; t++) {
        const int* corner = s->mesh->triangle + 3 * (size_t)t;
        bool pressed = group >= 0 ? s->mesh->face_group[t] == group
                                  : s->in[corner[0]] && s->in[corner[1]] && s->in[corner[2]];
        if (pressed && s->place) {
            memcpy(out->corner[out->triangle_count], s->place[t], sizeof *out->corner);
        }
        if (pressed) {
            memcpy(out->triangle[out->triangle_count++], corner, sizeof *out->triangle);
        }
    }
    return out->triangle_count ? RUGA_OK
                               : ruga_region_empty(region, s->mesh, s->index, "whole face to press");
}

// Any corner at a vertex tells where it is.
static ruga_status place_vertices(const selection* s, load* out) {
    int* corner = NULL;
    RUGA_TRY(RUGA_NEW(out->place, out->vertex_count));
    RUGA_TRY(RUGA_NEW(corner, s->mesh->vertex_count));
    for (int k = 3 * s->mesh->triangle_count - 1; k >= 0; k--) {
        corner[s->mesh->triangle[k]] = k;
    }
    for (int k = 0; k < out->vertex_count; k++) {
        int at = corner[out->vertex[k]];
        out->place[k] = s->place[at / 3][at % 3];
    }
    ruga_release(corner);
    return RUGA_OK;
}

// Dead load on the selected vertices: `scale` times share[v] times the handle's force.
static ruga_status add_dead_load(const selection* s, double scale, load* out) {
    RUGA_TRY(RUGA_NEW(out->vertex, s->count));
    RUGA_TRY(RUGA_NEW_ZERO(out->force, s->count));
    for (int k = 0; k < s->count; k++) {
        int v = s->list[k];
        if (s->share[v] > 0) {
            ruga_add_scaled(scale * s->share[v], out->handle.force, out->force[out->vertex_count]);
            out->vertex[out->vertex_count++] = v;
        }
    }
    return s->place ? place_vertices(s, out) : RUGA_OK;
}

static ruga_status add_total_force(const selection* s, load* out) {
    double area = 0;
    ruga_mesh_vertex_areas(s->mesh, s->share);
    for (int k = 0; k < s->count; k++) {
        area += s->share[s->list[k]];
    }
    if (!(area > 0)) {
        return ruga_region_empty(&out->handle.region, s->mesh, s->index, "vertex with area to pull at");
    }
    return add_dead_load(s, 1 / area, out);
}

static ruga_status add_line_force(const selection* s, load* out) {
    const ruga_connectivity* c = s->connectivity;
    double total = 0;
    memset(s->share, 0, (size_t)s->mesh->vertex_count * sizeof *s->share);
    for (int e = 0; e < c->edge_count; e++) {
        int i = c->edge[e][0], j = c->edge[e][1];
        if ((c->edge_triangle[e][0] < 0 || c->edge_triangle[e][1] < 0) && s->in[i] && s->in[j]) {
            double length =
                ruga_distance(s->mesh->position + 3 * (size_t)i, s->mesh->position + 3 * (size_t)j);
            s->share[i] += 0.5 * length;
            s->share[j] += 0.5 * length;
            total += length;
        }
    }
    if (!(total > 0)) {
        return ruga_region_empty(&out->handle.region, s->mesh, s->index, "boundary edge for a line force");
    }
    return add_dead_load(s, 1, out);
}

static ruga_status add_load(selection* s, load* out) {
    ruga_status status = ruga_region_vertices(&out->handle.region, s->mesh, &s->count, s->list);
    if (status != RUGA_OK) {
        return status == RUGA_BAD_INPUT ? ruga_fail_prefix(status, "handles.%d", s->index) : status;
    }
    memset(s->in, 0, (size_t)s->mesh->vertex_count * sizeof *s->in);
    for (int k = 0; k < s->count; k++) {
        s->in[s->list[k]] = true;
    }
    switch (out->handle.kind) {
    case RUGA_HANDLE_PRESS:
        return add_pressure(s, out);
    case RUGA_HANDLE_FORCE:
        return add_total_force(s, out);
    default:
        return add_line_force(s, out);
    }
}

static ruga_status fill(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                        const ruga_load_place (*place)[3], int handle_count, const ruga_handle_def* handles,
                        ruga_loads* loads) {
    ruga_status status = RUGA_OK;
    selection s = {.mesh = mesh, .connectivity = connectivity, .place = place};
    RUGA_TRY_DONE(RUGA_NEW(s.list, mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(s.in, mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(s.share, mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(loads->rest, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(loads->load, handle_count));
    memcpy(loads->rest, mesh->position, 3 * (size_t)mesh->vertex_count * sizeof *loads->rest);
    loads->vertex_count = mesh->vertex_count;
    for (int h = 0; h < handle_count; h++) {
        if (is_load(&handles[h])) {
            load* out = &loads->load[loads->count++];
            out->handle = handles[h];
            s.index = h;
            RUGA_TRY_DONE(add_load(&s, out));
        }
    }
done:
    ruga_release(s.list);
    ruga_release(s.in);
    ruga_release(s.share);
    return status;
}

ruga_status ruga_loads_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity, int handle_count,
                              const ruga_handle_def* handles, ruga_loads** loads) {
    return ruga_loads_create_placed(mesh, connectivity, NULL, handle_count, handles, loads);
}

ruga_status ruga_loads_create_placed(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                     const ruga_load_place (*place)[3], int handle_count,
                                     const ruga_handle_def* handles, ruga_loads** loads) {
    RUGA_TRY(RUGA_NEW_ZERO(*loads, 1));
    ruga_status status = fill(mesh, connectivity, place, handle_count, handles, *loads);
    if (status != RUGA_OK) {
        ruga_loads_destroy(loads);
    }
    return status;
}

static void position_of(const ruga_load_place* place, const double* x, double at[3]) {
    memset(at, 0, 3 * sizeof *at);
    ruga_add_scaled(place->weight[0], x + 3 * (size_t)place->node[0], at);
    ruga_add_scaled(place->weight[1], x + 3 * (size_t)place->node[1], at);
}

static void add_at(const ruga_load_place* place, double scale, const double force[3], double* gradient) {
    ruga_add_scaled(scale * place->weight[0], force, gradient + 3 * (size_t)place->node[0]);
    ruga_add_scaled(scale * place->weight[1], force, gradient + 3 * (size_t)place->node[1]);
}

// Quantities of the formula at the file's head; y = (c + 2 d) / 12, z = (a + 2 b) / 12.
typedef struct sweep {
    double u[3], a[3], b[3], c[3], d[3], y[3], z[3];
} sweep;

static sweep sweep_of(const ruga_loads* loads, const load* l, int t, const double* x) {
    const int* triangle = l->triangle[t];
    double at[3][3];
    for (int i = 0; i < 3 && l->corner; i++) {
        position_of(&l->corner[t][i], x, at[i]);
    }
    const double *x0 = l->corner ? at[0] : x + 3 * (size_t)triangle[0],
                 *x1 = l->corner ? at[1] : x + 3 * (size_t)triangle[1],
                 *x2 = l->corner ? at[2] : x + 3 * (size_t)triangle[2];
    const double *r0 = loads->rest + 3 * (size_t)triangle[0], *r1 = loads->rest + 3 * (size_t)triangle[1],
                 *r2 = loads->rest + 3 * (size_t)triangle[2];
    sweep s;
    for (int i = 0; i < 3; i++) {
        s.u[i] = ((x0[i] - r0[i]) + (x1[i] - r1[i]) + (x2[i] - r2[i])) / 3;
    }
    ruga_subtract(r1, r0, s.a);
    ruga_subtract(x1, x0, s.b);
    ruga_subtract(r2, r0, s.c);
    ruga_subtract(x2, x0, s.d);
    for (int i = 0; i < 3; i++) {
        s.y[i] = (s.c[i] + 2 * s.d[i]) / 12;
        s.z[i] = (s.a[i] + 2 * s.b[i]) / 12;
    }
    return s;
}

// What a corner's position contributes to u, b and d.
static const double OF_U[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3}, OF_B[3] = {-1, 1, 0}, OF_D[3] = {-1, 0, 1};

// V of one triangle and its gradient by corner.
static double swept_volume(const sweep* s, double gradient[3][3]) {
    double ac[3], ad[3], by_u[3], by_b[3], by_d[3];
    // V = u . (a x c / 6 + a x d / 12 + b x y)
    ruga_cross(s->a, s->c, ac);
    ruga_cross(s->a, s->d, ad);
    ruga_cross(s->b, s->y, by_u);
    ruga_add_scaled(1.0 / 6, ac, by_u);
    ruga_add_scaled(1.0 / 12, ad, by_u);
    ruga_cross(s->y, s->u, by_b);
    ruga_cross(s->u, s->z, by_d);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) {
            gradient[k][i] = OF_U[k] * by_u[i] + OF_B[k] * by_b[i] + OF_D[k] * by_d[i];
        }
    }
    return ruga_dot(s->u, by_u);
}

// matrix += scale [v]x, the matrix of w -> v x w
static void add_skew(double scale, const double v[3], double matrix[3][3]) {
    matrix[0][1] -= scale * v[2];
    matrix[0][2] += scale * v[1];
    matrix[1][0] += scale * v[2];
    matrix[1][2] -= scale * v[0];
    matrix[2][0] -= scale * v[1];
    matrix[2][1] += scale * v[0];
}

// d2V / dx_i dx_j, i != j. From the gradient: d2V/db du = [y], d2V/dd du = -[z], d2V/dd db = [u]/6; all skew,
// so that the blocks with i = j vanish.
static void swept_hessian(const sweep* s, int i, int j, double block[3][3]) {
    memset(block, 0, 9 * sizeof(double));
    add_skew(OF_B[i] * OF_U[j] - OF_U[i] * OF_B[j], s->y, block);
    add_skew(OF_U[i] * OF_D[j] - OF_D[i] * OF_U[j], s->z, block);
    add_skew((OF_D[i] * OF_B[j] - OF_B[i] * OF_D[j]) / 6, s->u, block);
}

static void add_hessian(const sweep* s, double pressure, const int triangle[3], const ruga_sparse* pattern,
                        double* hessian) {
    for (int k = 0; k < 3; k++) {
        // Row is the larger vertex: the pattern is a lower triangle.
        int i = k, j = (k + 1) % 3;
        if (triangle[i] < triangle[j]) {
            i = j;
            j = k;
        }
        double block[3][3];
        swept_hessian(s, i, j, block);
        for (int column = 0; column < 3; column++) {
            int place = ruga_sparse_find(pattern, 3 * triangle[i], 3 * triangle[j] + column);
            RUGA_ASSERT(place >= 0);
            for (int row = 0; row < 3; row++) {
                hessian[place + row] += pressure * block[row][column];
            }
        }
    }
}

// One block, between the nodes a and b, of weight w; both orders where they are one node.
static void add_block(int a, int b, double w, double block[3][3], const ruga_sparse* pattern,
                      double* hessian) {
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            int i = 3 * a + row, j = 3 * b + column;
            double value = w * (a == b ? block[row][column] + block[column][row] : block[row][column]);
            if (a == b && i < j) {
                continue;
            }
            int place = ruga_sparse_find(pattern, i > j ? i : j, i > j ? j : i);
            RUGA_ASSERT(place >= 0);
            hessian[place] += value;
        }
    }
}

static void add_placed_hessian(const sweep* s, double pressure, const ruga_load_place corner[3],
                               const ruga_sparse* pattern, double* hessian) {
    for (int i = 0; i < 3; i++) {
        const ruga_load_place *p = &corner[i], *q = &corner[(i + 1) % 3];
        double block[3][3];
        swept_hessian(s, i, (i + 1) % 3, block);
        for (int k = 0; k < 4; k++) {
            double w = pressure * p->weight[k / 2] * q->weight[k % 2];
            if (w != 0) {
                add_block(p->node[k / 2], q->node[k % 2], w, block, pattern, hessian);
            }
        }
    }
}

typedef struct totals {
    double energy, force_square;
} totals;

static totals press(const ruga_loads* loads, const load* l, const double* x, double ramp, double* gradient,
                    const ruga_sparse* pattern, double* hessian) {
    totals sum = {0, 0};
    double pressure = ramp * l->handle.pressure;
    for (int t = 0; t < l->triangle_count; t++) {
        const int* triangle = l->triangle[t];
        sweep s = sweep_of(loads, l, t, x);
        double slope[3][3];
        sum.energy += pressure * swept_volume(&s, slope);
        for (int k = 0; k < 3; k++) {
            sum.force_square += pressure * pressure * ruga_dot(slope[k], slope[k]);
            if (gradient && l->corner) {
                add_at(&l->corner[t][k], pressure, slope[k], gradient);
            } else if (gradient) {
                ruga_add_scaled(pressure, slope[k], gradient + 3 * (size_t)triangle[k]);
            }
        }
        if (hessian && l->corner) {
            add_placed_hessian(&s, pressure, l->corner[t], pattern, hessian);
        } else if (hessian) {
            add_hessian(&s, pressure, triangle, pattern, hessian);
        }
    }
    return sum;
}

static totals pull(const ruga_loads* loads, const load* l, const double* x, double ramp, double* gradient) {
    totals sum = {0, 0};
    for (int k = 0; k < l->vertex_count; k++) {
        size_t v = 3 * (size_t)l->vertex[k];
        double moved[3], at[3];
        if (l->place) {
            position_of(&l->place[k], x, at);
        }
        ruga_subtract(l->place ? at : x + v, loads->rest + v, moved);
        sum.energy -= ramp * ruga_dot(l->force[k], moved);
        sum.force_square += ramp * ramp * ruga_dot(l->force[k], l->force[k]);
        if (gradient && l->place) {
            add_at(&l->place[k], -ramp, l->force[k], gradient);
        } else if (gradient) {
            ruga_add_scaled(-ramp, l->force[k], gradient + v);
        }
    }
    return sum;
}

ruga_status ruga_loads_energy(const ruga_loads* loads, const double* x, double time, double* energy,
                              double* gradient, const ruga_sparse* pattern, double* hessian,
                              double* force_square) {
    RUGA_ASSERT(!hessian || pattern);
    *energy = 0;
    for (int i = 0; i < loads->count; i++) {
        const load* l = &loads->load[i];
        double ramp = ruga_handle_ramp(&l->handle, time);
        if (ramp == 0) {
            continue;
        }
        totals sum = l->handle.kind == RUGA_HANDLE_PRESS
                         ? press(loads, l, x, ramp, gradient, pattern, hessian)
                         : pull(loads, l, x, ramp, gradient);
        *energy += sum.energy;
        if (force_square) {
            *force_square += sum.force_square;
        }
    }
    return RUGA_OK;
}
