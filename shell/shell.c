// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Rest state and assembly: energy, gradient and Hessian are sums over triangles (membrane.c) and over hinges,
// one for each interior edge (bending.c):
//   E = k s/2 (theta - theta0)^2,  k = D |e|^2 / (A1 + A2),  D = E h^3 / (12 (1 - nu^2)),
// s the mean over its two triangles of what their strain does to their thickness (thickness.c).
// Where its two triangles differ, D is (A1 + A2) / (A1/D1 + A2/D2): both carry the same moment, so that their
// curvatures, and not their stiffnesses, add up.
//
// The Hessian of a hinge is k s grad grad^T + k s (theta - theta0) H, and H splits into one part for each of
// the two triangles; these are added to the matrices of the triangles. So are those of s. So each triangle
// writes a 9 x 9 matrix, and a hinge's own part is made from its gradients when it is gathered: with p = k
// grad s, t = theta - theta0, its force is k s t grad theta + t^2/2 p, and the mixed part of its Hessian
// t (grad theta p^T + p grad theta^T). Everything is computed for each
// element first, and then gathered for each vertex, in an order that the mesh alone decides: the bits are the
// same for any number of threads.
//
// With directors (directors.c) a hinge's moment is not its stiffness times its angle but comes from all of
// them. The part w grad t K (w grad t)^T couples the three hinges of a triangle, and so its corners with
// those of its neighbours: this patch of up to six vertices is one more element.
#include "shell/shell.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"
#include "shell/bending.h"
#include "shell/material.h"
#include "shell/membrane.h"
#include "shell/thickness.h"

#include <limits.h>
#include <string.h>

// Elements or vertices in one piece of parallel work.
enum { CHUNK = 256 };
// Vertices of a triangle and its neighbours.
enum { PATCH = 6 };

typedef struct hinge_rest {
    double stiffness; // k = D |e|^2 / (A1 + A2), J
    double angle;
} hinge_rest;

// For each target the items that add to it, ascending.
typedef struct gather {
    int* start; // [targets + 1]
    int* item;
} gather;

struct ruga_shell {
    ruga_membrane membrane;
    double poisson;
    double thickness_power; // of thickness.c; 0 with directors, whose stiffness is constant
    int vertex_count, triangle_count, hinge_count;
    int (*triangle)[3];
    ruga_membrane_rest* triangle_rest; // [F]
    int (*triangle_hinge)[3];          // [F] hinge at the edge from corner i to corner i + 1, or -1
    int (*hinge)[4];                   // [H] as in ruga_hinge_angle
    hinge_rest* hinge_rest;            // [H]
    int (*hinge_side)[2];              // [H] 3 triangle + its corner at which the edge begins, on either side
    double* rest_area;                 // [F] after growth
    bool has_directors;
    ruga_directors directors;
    int (*patch)[PATCH]; // [F] with directors: corners, then the corner across edge i or -1
    double* vertex_mass; // [V]
    ruga_sparse pattern;
    int* block_start;       // [V + 1] first 3 x 3 block of a vertex's columns
    gather vertex_triangle; // vertex <- 3 triangle + corner
    gather vertex_hinge;    // vertex <- 4 hinge + corner
    gather block_triangle;  // block <- 9 triangle + 3 row corner + column corner
    gather block_hinge;     // block <- 16 hinge + 4 row corner + column corner
    gather block_patch;     // block <- 36 triangle + 6 row + column; in place of block_hinge with directors
    // Scratch of ruga_shell_energy, which writes here although the shell is const.
    double (*triangle_gradient)[3][3];                 // [F]
    double (*triangle_block)[RUGA_TRIANGLE_BLOCKS][9]; // [F]
    double (*hinge_gradient)[4][3];                    // [H] of the angle
    double* hinge_moment;                              // [H] k s (theta - theta0)
    double* hinge_angle;                               // [H] theta - theta0
    double* thickness;                                 // [F] s, where thickness_power is not 0
    double (*thickness_gradient)[3][3];                // [F]
    double (*hinge_pull)[4][3];                        // [H] p = k grad s
    double (*patch_gradient)[3][PATCH][3];             // [F] with directors: of w t
    double (*partial)[2];                              // [chunks] energy, sum of squared forces
};

// ---- Rest state

static void corners(const int triangle[3], const double* x, const double* corner[3]) {
    for (int i = 0; i < 3; i++) {
        corner[i] = x + 3 * (size_t)triangle[i];
    }
}

static void hinge_corners(const int hinge[4], const double* x, const double* corner[4]) {
    for (int i = 0; i < 4; i++) {
        corner[i] = x + 3 * (size_t)hinge[i];
    }
}

static ruga_status fail_at_face(ruga_status status, const ruga_mesh* mesh, int f, const char* what) {
    const double* x[3];
    corners(mesh->triangle + 3 * (size_t)f, mesh->position, x);
    return ruga_fail(status, "face %d (counted from 0) at (%.6g, %.6g, %.6g) m %s", f,
                     (x[0][0] + x[1][0] + x[2][0]) / 3, (x[0][1] + x[1][1] + x[2][1]) / 3,
                     (x[0][2] + x[1][2] + x[2][2]) / 3, what);
}

// Triangles and vertex masses; area [F] is after growth.
static ruga_status set_triangles(ruga_shell* shell, const ruga_mesh* mesh,
                                 const ruga_shell_material* material, double* area) {
    for (int f = 0; f < shell->triangle_count; f++) {
        double h = ruga_shell_material_thickness(material, f), young = ruga_shell_material_young(material, f);
        if (!(h > 0) || !isfinite(h)) {
            return fail_at_face(RUGA_BAD_INPUT, mesh, f,
                                "has a thickness that is not above 0: give it one in m");
        }
        if (!(young > 0) || !isfinite(young)) {
            return fail_at_face(RUGA_BAD_INPUT, mesh, f,
                                "has a Young's modulus that is not above 0: give it one in Pa");
        }
        const double *x[3], *growth = ruga_shell_material_growth(material, f);
        if (!(growth[0] > 0 && growth[1] > 0) || !isfinite(growth[0] * growth[1])) {
            return fail_at_face(RUGA_BAD_INPUT, mesh, f,
                                "has a growth that is not above 0: 1 leaves lengths alone");
        }
        memcpy(shell->triangle[f], mesh->triangle + 3 * (size_t)f, sizeof shell->triangle[f]);
        corners(shell->triangle[f], mesh->position, x);
        area[f] =
            ruga_membrane_rest_create(x, material->skin.poisson, growth, h, young, &shell->triangle_rest[f]);
        if (area[f] == 0) {
            return fail_at_face(RUGA_BAD_MESH, mesh, f, "has no area: delete or collapse it, or remesh");
        }
        for (int i = 0; i < 3; i++) {
            shell->vertex_mass[shell->triangle[f][i]] += material->skin.density * h * area[f] / 3;
        }
    }
    return RUGA_OK;
}

static void set_hinge(ruga_shell* shell, const ruga_mesh* mesh, const ruga_shell_material* material, int h,
                      const int side[2], const double* area) {
    const double* x[4];
    double edge[3], length = 0;
    hinge_corners(shell->hinge[h], mesh->position, x);
    ruga_subtract(x[1], x[0], edge);
    for (int i = 0; i < 2; i++) {
        const double* corner[3];
        corners(shell->triangle[side[i]], mesh->position, corner);
        length +=
            0.5 * ruga_membrane_grown_length(corner, edge, ruga_shell_material_growth(material, side[i]));
    }
    double a0 = area[side[0]], a1 = area[side[1]];
    double softness = a0 / ruga_shell_material_bending(material, side[0]) +
                      a1 / ruga_shell_material_bending(material, side[1]);
    shell->hinge_rest[h].stiffness = length * length / softness;
    shell->hinge_rest[h].angle = ruga_hinge_angle(x, NULL);
}

// Tells the triangle on a side of hinge `h` that it is at its edge that begins at `vertex`, and the hinge
// where.
static void note_hinge(ruga_shell* shell, int f, int vertex, int h, int side) {
    for (int i = 0; i < 3; i++) {
        if (shell->triangle[f][i] == vertex) {
            shell->triangle_hinge[f][i] = h;
            shell->hinge_side[h][side] = 3 * f + i;
        }
    }
}

static void set_hinges(ruga_shell* shell, const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                       const ruga_shell_material* material, const double* area) {
    memset(shell->triangle_hinge, -1, (size_t)shell->triangle_count * sizeof *shell->triangle_hinge);
    int h = 0;
    for (int e = 0; e < connectivity->edge_count; e++) {
        const int* side = connectivity->edge_triangle[e];
        if (side[0] < 0 || side[1] < 0) {
            continue;
        }
        const int vertex[4] = {connectivity->edge[e][0], connectivity->edge[e][1],
                               connectivity->edge_opposite[e][0], connectivity->edge_opposite[e][1]};
        memcpy(shell->hinge[h], vertex, sizeof vertex);
        set_hinge(shell, mesh, material, h, side, area);
        note_hinge(shell, side[0], vertex[0], h, 0);
        note_hinge(shell, side[1], vertex[1], h, 1);
        h++;
    }
}

// The triangle's patch, and each hinge's triangles.
static void set_patch(ruga_shell* shell, const ruga_connectivity* connectivity) {
    ruga_directors* d = &shell->directors;
    for (int e = 0, h = 0; e < connectivity->edge_count; e++) {
        const int* side = connectivity->edge_triangle[e];
        if (side[0] >= 0 && side[1] >= 0) {
            memcpy(d->hinge_triangle[h++], side, sizeof d->hinge_triangle[0]);
        }
    }
    for (int f = 0; f < shell->triangle_count; f++) {
        for (int i = 0; i < 3; i++) {
            int h = shell->triangle_hinge[f][i];
            shell->patch[f][i] = shell->triangle[f][i];
            shell->patch[f][3 + i] = h < 0 ? -1 : shell->hinge[h][d->hinge_triangle[h][0] == f ? 3 : 2];
        }
    }
}

// A held triangle does not bend: without this its directors would give way by themselves, as its corners do
// not hold them. Its edges become hinges, and those on its border clamp.
static void hold_directors(ruga_shell* shell, const ruga_shell_material* material, int f) {
    const double clamp = 1e6; // times the triangle's own stiffness
    const ruga_directors* d = &shell->directors;
    for (int i = 0; i < 3; i++) {
        int h = shell->triangle_hinge[f][i];
        bool border =
            h >= 0 && !(material->held[d->hinge_triangle[h][0]] && material->held[d->hinge_triangle[h][1]]);
        for (int j = 0; j < 3; j++) {
            d->stiffness[f][i][j] *= i != j ? 0 : border ? clamp : 1;
        }
    }
}

static ruga_status set_directors(ruga_shell* shell, const ruga_connectivity* connectivity,
                                 const ruga_shell_material* material, const double* area) {
    ruga_directors* d = &shell->directors;
    RUGA_TRY(ruga_directors_create(shell->vertex_count, shell->triangle_count,
                                   (const int(*)[3])shell->triangle_hinge, shell->hinge_count,
                                   (const int(*)[4])shell->hinge, d));
    RUGA_TRY(RUGA_NEW(shell->patch, shell->triangle_count));
    RUGA_TRY(RUGA_NEW(shell->patch_gradient, shell->triangle_count));
    set_patch(shell, connectivity);
    for (int f = 0; f < shell->triangle_count; f++) {
        const int* h = shell->triangle_hinge[f];
        const bool rim[3] = {h[0] < 0, h[1] < 0, h[2] < 0};
        ruga_director_stiffness(&shell->triangle_rest[f], area[f], ruga_shell_material_bending(material, f),
                                material->skin.poisson, rim, d->stiffness[f]);
        if (material->held && material->held[f]) {
            hold_directors(shell, material, f);
        }
    }
    return ruga_directors_link(d);
}

static ruga_status set_rest(ruga_shell* shell, const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                            const ruga_shell_material* material) {
    RUGA_TRY(set_triangles(shell, mesh, material, shell->rest_area));
    set_hinges(shell, mesh, connectivity, material, shell->rest_area);
    return shell->has_directors ? set_directors(shell, connectivity, material, shell->rest_area) : RUGA_OK;
}

// ---- Pattern and gathers

static ruga_status set_pattern(ruga_shell* shell, const ruga_connectivity* connectivity) {
    int(*pairs)[2] = NULL;
    int64_t count = connectivity->edge_count + (int64_t)shell->hinge_count;
    RUGA_TRY(RUGA_NEW(pairs, count + (shell->has_directors ? 3 * (int64_t)shell->triangle_count : 0)));
    for (int e = 0; e < connectivity->edge_count; e++) {
        memcpy(pairs[e], connectivity->edge[e], sizeof pairs[e]);
    }
    for (int h = 0; h < shell->hinge_count; h++) {
        memcpy(pairs[connectivity->edge_count + h], shell->hinge[h] + 2, sizeof pairs[0]);
    }
    // Across a patch.
    for (int k = 0; k < 3 * shell->triangle_count && shell->has_directors; k++) {
        const int* across = shell->patch[k / 3] + 3;
        int a = across[k % 3], b = across[(k + 1) % 3];
        if (a >= 0 && b >= 0) {
            pairs[count][0] = a;
            pairs[count++][1] = b;
        }
    }
    ruga_status status =
        ruga_sparse_from_pairs(shell->vertex_count, 3, count, (const int(*)[2])pairs, &shell->pattern);
    ruga_release(pairs);
    RUGA_TRY(status);
    RUGA_TRY(RUGA_NEW(shell->block_start, shell->vertex_count + 1));
    shell->block_start[0] = 0;
    for (int v = 0; v < shell->vertex_count; v++) {
        const int* start = shell->pattern.start + 3 * (size_t)v;
        shell->block_start[v + 1] = shell->block_start[v] + (start[1] - start[0]) / 3;
    }
    return RUGA_OK;
}

// Items by their target; target[item] is -1 where an item adds to none.
static ruga_status gather_create(int target_count, int item_count, const int* target, gather* result) {
    RUGA_TRY(RUGA_NEW_ZERO(result->start, target_count + 1));
    int used = 0;
    for (int k = 0; k < item_count; k++) {
        if (target[k] >= 0) {
            result->start[target[k] + 1]++;
            used++;
        }
    }
    RUGA_TRY(RUGA_NEW(result->item, used));
    for (int t = 0; t < target_count; t++) {
        result->start[t + 1] += result->start[t];
    }
    // Filling moves each start to its end; shifting by one target afterwards puts them back.
    for (int k = 0; k < item_count; k++) {
        if (target[k] >= 0) {
            result->item[result->start[target[k]]++] = k;
        }
    }
    memmove(result->start + 1, result->start, (size_t)target_count * sizeof *result->start);
    result->start[0] = 0;
    return RUGA_OK;
}

// Gather of the blocks of the lower triangle from all corner pairs of elements with `size` corners.
static ruga_status block_gather_create(const ruga_shell* shell, int element_count, int size,
                                       const int* vertex, gather* result) {
    int* target = NULL;
    int pairs = size * size;
    RUGA_TRY(RUGA_NEW(target, (size_t)element_count * (size_t)pairs));
    for (int k = 0; k < element_count; k++) {
        const int* corner = vertex + (size_t)k * (size_t)size;
        for (int i = 0; i < pairs; i++) {
            int row = corner[i / size], column = corner[i % size];
            int* block = &target[(size_t)k * (size_t)pairs + (size_t)i];
            *block = -1;
            if (row >= column && column >= 0) {
                int position = ruga_sparse_find(&shell->pattern, 3 * row, 3 * column);
                RUGA_ASSERT(position >= 0);
                *block = shell->block_start[column] + (position - shell->pattern.start[3 * column]) / 3;
            }
        }
    }
    ruga_status status =
        gather_create(shell->block_start[shell->vertex_count], element_count * pairs, target, result);
    ruga_release(target);
    return status;
}

static ruga_status set_gathers(ruga_shell* shell) {
    int triangles = shell->triangle_count, hinges = shell->hinge_count;
    RUGA_TRY(gather_create(shell->vertex_count, 3 * triangles, shell->triangle[0], &shell->vertex_triangle));
    RUGA_TRY(gather_create(shell->vertex_count, 4 * hinges, shell->hinge[0], &shell->vertex_hinge));
    RUGA_TRY(block_gather_create(shell, triangles, 3, shell->triangle[0], &shell->block_triangle));
    return shell->has_directors
               ? block_gather_create(shell, triangles, PATCH, shell->patch[0], &shell->block_patch)
               : block_gather_create(shell, hinges, 4, shell->hinge[0], &shell->block_hinge);
}

// ---- Creation

static int count_hinges(const ruga_connectivity* connectivity) {
    int count = 0;
    for (int e = 0; e < connectivity->edge_count; e++) {
        count += connectivity->edge_triangle[e][0] >= 0 && connectivity->edge_triangle[e][1] >= 0;
    }
    return count;
}

static ruga_status allocate(ruga_shell* shell) {
    int triangles = shell->triangle_count, hinges = shell->hinge_count;
    RUGA_TRY(RUGA_NEW(shell->triangle, triangles));
    RUGA_TRY(RUGA_NEW(shell->triangle_rest, triangles));
    RUGA_TRY(RUGA_NEW(shell->triangle_hinge, triangles));
    RUGA_TRY(RUGA_NEW(shell->hinge, hinges));
    RUGA_TRY(RUGA_NEW(shell->hinge_rest, hinges));
    RUGA_TRY(RUGA_NEW(shell->hinge_side, hinges));
    RUGA_TRY(RUGA_NEW(shell->rest_area, triangles));
    RUGA_TRY(RUGA_NEW_ZERO(shell->vertex_mass, shell->vertex_count));
    RUGA_TRY(RUGA_NEW(shell->triangle_gradient, triangles));
    RUGA_TRY(RUGA_NEW(shell->triangle_block, triangles));
    RUGA_TRY(RUGA_NEW(shell->hinge_gradient, hinges));
    RUGA_TRY(RUGA_NEW(shell->hinge_moment, hinges));
    RUGA_TRY(RUGA_NEW(shell->hinge_angle, hinges));
    if (shell->thickness_power != 0) {
        RUGA_TRY(RUGA_NEW(shell->thickness, triangles));
        RUGA_TRY(RUGA_NEW(shell->thickness_gradient, triangles));
        RUGA_TRY(RUGA_NEW(shell->hinge_pull, hinges));
    }
    int most = triangles > hinges ? triangles : hinges;
    return RUGA_NEW(shell->partial, ruga_chunk_count(most, CHUNK));
}

ruga_status ruga_shell_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                              const ruga_shell_material* material, ruga_shell** shell) {
    ruga_status status = RUGA_OK;
    ruga_shell* made = NULL;
    *shell = NULL;
    RUGA_ASSERT(connectivity->vertex_count == mesh->vertex_count);
    RUGA_ASSERT(connectivity->triangle_count == mesh->triangle_count);
    RUGA_TRY(ruga_shell_material_check(material));
    int hinges = count_hinges(connectivity);
    bool made_of_patches = material->skin.bending == RUGA_BENDING_KIRCHHOFF_LOVE;
    if (mesh->triangle_count > INT_MAX / (made_of_patches ? PATCH * PATCH : 9) || hinges > INT_MAX / 16) {
        return ruga_fail(RUGA_BAD_MESH,
                         "the mesh has %d faces, too many for 32-bit indices: use a coarser mesh",
                         mesh->triangle_count);
    }
    RUGA_TRY(RUGA_NEW_ZERO(made, 1));
    made->membrane = material->skin.membrane;
    made->poisson = material->skin.poisson;
    made->vertex_count = mesh->vertex_count;
    made->triangle_count = mesh->triangle_count;
    made->hinge_count = hinges;
    made->has_directors = made_of_patches;
    made->thickness_power = made_of_patches ? 0 : ruga_thickness_power(material->skin.poisson);
    RUGA_TRY_DONE(allocate(made));
    RUGA_TRY_DONE(set_rest(made, mesh, connectivity, material));
    RUGA_TRY_DONE(set_pattern(made, connectivity));
    RUGA_TRY_DONE(set_gathers(made));
    *shell = made;
    made = NULL;
done:
    ruga_shell_destroy(&made);
    return status;
}

static void gather_clear(gather* g) {
    ruga_release(g->start);
    ruga_release(g->item);
}

void ruga_shell_destroy(ruga_shell** shell) {
    ruga_shell* s = *shell;
    if (!s) {
        return;
    }
    ruga_release(s->triangle);
    ruga_release(s->triangle_rest);
    ruga_release(s->triangle_hinge);
    ruga_release(s->hinge);
    ruga_release(s->hinge_rest);
    ruga_release(s->hinge_side);
    ruga_release(s->rest_area);
    ruga_release(s->thickness);
    ruga_release(s->thickness_gradient);
    ruga_release(s->hinge_pull);
    ruga_release(s->vertex_mass);
    ruga_sparse_clear(&s->pattern);
    ruga_release(s->block_start);
    gather_clear(&s->vertex_triangle);
    gather_clear(&s->vertex_hinge);
    gather_clear(&s->block_triangle);
    gather_clear(&s->block_hinge);
    gather_clear(&s->block_patch);
    ruga_directors_clear(&s->directors);
    ruga_release(s->patch);
    ruga_release(s->hinge_angle);
    ruga_release(s->patch_gradient);
    ruga_release(s->triangle_gradient);
    ruga_release(s->triangle_block);
    ruga_release(s->hinge_gradient);
    ruga_release(s->hinge_moment);
    ruga_release(s->partial);
    ruga_release(s);
    *shell = NULL;
}

const ruga_sparse* ruga_shell_pattern(const ruga_shell* shell) {
    return &shell->pattern;
}

const ruga_directors* ruga_shell_directors(const ruga_shell* shell) {
    return shell->has_directors ? &shell->directors : NULL;
}

void ruga_shell_vertex_mass(const ruga_shell* shell, double* mass) {
    memcpy(mass, shell->vertex_mass, (size_t)shell->vertex_count * sizeof *mass);
}

// ---- Energy and derivatives

typedef struct pass {
    const ruga_shell* shell;
    const double* x;
    double clamp;
    double* gradient;
    double* hessian;
} pass;

static void triangle_energies(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    double energy = 0, force_square = 0;
    for (int f = begin; f < end; f++) {
        const double* x[3];
        double(*g)[3] = shell->triangle_gradient[f];
        corners(shell->triangle[f], p->x, x);
        energy += ruga_membrane_energy(shell->membrane, shell->poisson, &shell->triangle_rest[f], x, g);
        if (shell->thickness) {
            shell->thickness[f] = ruga_thickness_stiffness(shell->thickness_power, shell->rest_area[f], x,
                                                           shell->thickness_gradient[f]);
        }
        force_square += ruga_dot(g[0], g[0]) + ruga_dot(g[1], g[1]) + ruga_dot(g[2], g[2]);
    }
    shell->partial[chunk][0] = energy;
    shell->partial[chunk][1] = force_square;
}

static void hinge_angles(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    for (int h = begin; h < end; h++) {
        const double* x[4];
        hinge_corners(shell->hinge[h], p->x, x);
        shell->hinge_angle[h] =
            ruga_angle_difference(ruga_hinge_angle(x, shell->hinge_gradient[h]), shell->hinge_rest[h].angle);
    }
}

static void settle_directors(pass* p) {
    // The directors' work vectors are scratch of the shell, as the rest.
    ruga_directors directors = p->shell->directors;
    ruga_parallel_for(p->shell->hinge_count, CHUNK, hinge_angles, p);
    ruga_directors_settle(&directors, p->shell->hinge_angle, p->shell->hinge_moment);
}

// Sets the hinge's p and returns its s.
static double set_hinge_pull(const ruga_shell* shell, int h) {
    // Corners of the hinge from the corner at which the edge begins onwards, on either side.
    static const int corner[2][3] = {{0, 1, 2}, {1, 0, 3}};
    double(*pull)[3] = shell->hinge_pull[h], factor = 0;
    memset(pull, 0, sizeof shell->hinge_pull[h]);
    for (int side = 0; side < 2; side++) {
        int f = shell->hinge_side[h][side] / 3, first = shell->hinge_side[h][side] % 3;
        factor += 0.5 * shell->thickness[f];
        for (int i = 0; i < 3; i++) {
            ruga_add_scaled(0.5 * shell->hinge_rest[h].stiffness,
                            shell->thickness_gradient[f][(first + i) % 3], pull[corner[side][i]]);
        }
    }
    return factor;
}

static double force_square_of(const ruga_shell* shell, int h) {
    double sum = 0;
    for (int c = 0; c < 4; c++) {
        double force[3] = {0, 0, 0};
        ruga_add_scaled(shell->hinge_moment[h], shell->hinge_gradient[h][c], force);
        if (shell->thickness) {
            ruga_add_scaled(0.5 * shell->hinge_angle[h] * shell->hinge_angle[h], shell->hinge_pull[h][c],
                            force);
        }
        sum += ruga_dot(force, force);
    }
    return sum;
}

static void hinge_energies(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    double energy = 0, force_square = 0;
    for (int h = begin; h < end; h++) {
        const double* x[4];
        double(*g)[3] = shell->hinge_gradient[h];
        const hinge_rest* rest = &shell->hinge_rest[h];
        hinge_corners(shell->hinge[h], p->x, x);
        bool known = shell->has_directors; // angle and moment, by settle_directors
        double angle =
            known ? shell->hinge_angle[h] : ruga_angle_difference(ruga_hinge_angle(x, g), rest->angle);
        double stiffness = rest->stiffness * (shell->thickness ? set_hinge_pull(shell, h) : 1);
        double moment = known ? shell->hinge_moment[h] : stiffness * angle;
        shell->hinge_angle[h] = angle;
        shell->hinge_moment[h] = moment;
        energy += 0.5 * moment * angle;
        force_square += force_square_of(shell, h);
    }
    shell->partial[chunk][0] = energy;
    shell->partial[chunk][1] = force_square;
}

// Sum of one column of the partial sums, in their order.
static double total(const ruga_shell* shell, int element_count, int column) {
    double sum = 0;
    for (int k = 0; k < ruga_chunk_count(element_count, CHUNK); k++) {
        sum += shell->partial[k][column];
    }
    return sum;
}

static void gather_gradient(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    for (int v = begin; v < end; v++) {
        double sum[3] = {0, 0, 0};
        const gather* from = &shell->vertex_triangle;
        for (int k = from->start[v]; k < from->start[v + 1]; k++) {
            int item = from->item[k];
            ruga_add_scaled(1, shell->triangle_gradient[item / 3][item % 3], sum);
        }
        from = &shell->vertex_hinge;
        for (int k = from->start[v]; k < from->start[v + 1]; k++) {
            int h = from->item[k] / 4, corner = from->item[k] % 4;
            ruga_add_scaled(shell->hinge_moment[h], shell->hinge_gradient[h][corner], sum);
            if (shell->thickness) {
                ruga_add_scaled(0.5 * shell->hinge_angle[h] * shell->hinge_angle[h],
                                shell->hinge_pull[h][corner], sum);
            }
        }
        memcpy(p->gradient + 3 * (size_t)v, sum, sizeof sum);
    }
}

static void triangle_hessians(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    for (int f = begin; f < end; f++) {
        const double* x[3];
        double moment[3], bent = 0;
        corners(shell->triangle[f], p->x, x);
        ruga_membrane_hessian(shell->membrane, shell->poisson, &shell->triangle_rest[f], x, p->clamp,
                              shell->triangle_block[f]);
        for (int i = 0; i < 3; i++) {
            int h = shell->triangle_hinge[f][i];
            moment[i] = h < 0 ? 0 : (1 - p->clamp) * shell->hinge_moment[h];
            bent +=
                h < 0 ? 0
                      : 0.25 * shell->hinge_rest[h].stiffness * shell->hinge_angle[h] * shell->hinge_angle[h];
        }
        ruga_hinge_add_hessian(x, moment, shell->triangle_block[f]);
        if (shell->thickness && p->clamp < 1) {
            ruga_thickness_add_hessian(shell->thickness_power, shell->rest_area[f], x, (1 - p->clamp) * bent,
                                       shell->triangle_block[f]);
        }
    }
}

// Adds the block of one pair of corners (3 row corner + column corner).
static void add_triangle_block(double block[RUGA_TRIANGLE_BLOCKS][9], int pair, double sum[9]) {
    static const int lower[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
    const double* b = block[lower[pair]];
    if (pair / 3 >= pair % 3) {
        for (int k = 0; k < 9; k++) {
            sum[k] += b[k];
        }
        return;
    }
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            sum[3 * r + c] += b[3 * c + r];
        }
    }
}

static void add_product(double scale, const double row[3], const double column[3], double sum[9]) {
    for (int r = 0; r < 3; r++) {
        double s = scale * row[r];
        for (int c = 0; c < 3; c++) {
            sum[3 * r + c] += s * column[c];
        }
    }
}

static void add_hinge_block(const ruga_shell* shell, double clamp, int h, int row, int column,
                            double sum[9]) {
    const double(*g)[3] = (const double(*)[3])shell->hinge_gradient[h];
    double stiffness = shell->hinge_rest[h].stiffness;
    if (!shell->thickness) {
        add_product(stiffness, g[row], g[column], sum);
        return;
    }
    const double(*pull)[3] = (const double(*)[3])shell->hinge_pull[h];
    const int* side = shell->hinge_side[h];
    double mixed = (1 - clamp) * shell->hinge_angle[h];
    stiffness *= 0.5 * (shell->thickness[side[0] / 3] + shell->thickness[side[1] / 3]);
    add_product(stiffness, g[row], g[column], sum);
    add_product(mixed, g[row], pull[column], sum);
    add_product(mixed, pull[row], g[column], sum);
}

// Gradients of the angles of a triangle's hinges, times its parts of them, by the vertices of its patch.
static void set_patch_gradient(const ruga_shell* shell, int f) {
    double(*to)[PATCH][3] = shell->patch_gradient[f];
    memset(to, 0, sizeof shell->patch_gradient[f]);
    for (int i = 0; i < 3; i++) {
        int h = shell->triangle_hinge[f][i];
        bool first = h >= 0 && shell->directors.hinge_triangle[h][0] == f;
        double weight = h >= 0 ? shell->directors.weight[h][!first] : 0;
        for (int c = 0; c < 4 && h >= 0; c++) {
            int k = c < 2 ? (shell->hinge[h][c] == shell->triangle[f][i] ? i : (i + 1) % 3)
                          : ((c == 2) == first ? (i + 2) % 3 : 3 + i);
            ruga_add_scaled(weight, shell->hinge_gradient[h][c], to[i][k]);
        }
    }
}

static void patch_gradients(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    for (int f = begin; f < end; f++) {
        set_patch_gradient(p->shell, f);
    }
}

// K of directors.c between two rows of gradients.
static void add_patch_block(const ruga_shell* shell, int f, int row, int column, double sum[9]) {
    const double(*g)[PATCH][3] = (const double(*)[PATCH][3])shell->patch_gradient[f];
    for (int i = 0; i < 9; i++) {
        double k = shell->directors.stiffness[f][i / 3][i % 3];
        if (k != 0) {
            add_product(k, g[i / 3][row], g[i % 3][column], sum);
        }
    }
}

static void gather_hessian(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    const gather *triangles = &shell->block_triangle, *hinges = &shell->block_hinge;
    for (int v = begin; v < end; v++) {
        for (int b = shell->block_start[v]; b < shell->block_start[v + 1]; b++) {
            double sum[9] = {0};
            for (int k = triangles->start[b]; k < triangles->start[b + 1]; k++) {
                int item = triangles->item[k];
                add_triangle_block(shell->triangle_block[item / 9], item % 9, sum);
            }
            const gather* patches = &shell->block_patch;
            for (int k = shell->has_directors ? patches->start[b] : 0;
                 shell->has_directors && k < patches->start[b + 1]; k++) {
                int f = patches->item[k] / (PATCH * PATCH), pair = patches->item[k] % (PATCH * PATCH);
                add_patch_block(shell, f, pair / PATCH, pair % PATCH, sum);
            }
            for (int k = shell->has_directors ? 0 : hinges->start[b];
                 !shell->has_directors && k < hinges->start[b + 1]; k++) {
                int h = hinges->item[k] / 16, pair = hinges->item[k] % 16;
                add_hinge_block(shell, p->clamp, h, pair / 4, pair % 4, sum);
            }
            // Column c begins at its diagonal: it lacks the first c entries of the first block.
            int number = b - shell->block_start[v];
            for (int c = 0; c < 3; c++) {
                double* column = p->hessian + shell->pattern.start[3 * v + c] - c + 3 * number;
                for (int r = number == 0 ? c : 0; r < 3; r++) {
                    column[r] = sum[3 * r + c];
                }
            }
        }
    }
}

ruga_status ruga_shell_energy(const ruga_shell* shell, const double* x, double clamp,
                              ruga_shell_energies* energies, double* gradient, double* hessian) {
    RUGA_ASSERT(clamp >= 0 && clamp <= 1);
    pass p = {shell, x, clamp, gradient, hessian};
    ruga_shell_energies sum;
    ruga_parallel_for(shell->triangle_count, CHUNK, triangle_energies, &p);
    sum.membrane = total(shell, shell->triangle_count, 0);
    sum.force_square = total(shell, shell->triangle_count, 1);
    if (shell->has_directors) {
        settle_directors(&p);
    }
    ruga_parallel_for(shell->hinge_count, CHUNK, hinge_energies, &p);
    sum.bending = total(shell, shell->hinge_count, 0);
    sum.force_square += total(shell, shell->hinge_count, 1);
    if (energies) {
        *energies = sum;
    }
    if (gradient) {
        ruga_parallel_for(shell->vertex_count, CHUNK, gather_gradient, &p);
    }
    if (hessian) {
        ruga_parallel_for(shell->triangle_count, CHUNK, triangle_hessians, &p);
        if (shell->has_directors) {
            ruga_parallel_for(shell->triangle_count, CHUNK, patch_gradients, &p);
        }
        ruga_parallel_for(shell->vertex_count, CHUNK, gather_hessian, &p);
    }
    return RUGA_OK;
}

void ruga_shell_coupling(const ruga_shell* shell, double (*coupling)[3]) {
    ruga_directors_coupling(&shell->directors, shell->hinge_gradient, coupling);
}

void ruga_shell_relax(const ruga_shell* shell, const double (*coupling)[3], const double* v, double* y) {
    ruga_directors directors = shell->directors;
    double* f = directors.rotation;
    memset(f, 0, (size_t)shell->hinge_count * sizeof *f);
    for (int i = 0; i < shell->vertex_count; i++) {
        for (int k = directors.start[i]; k < directors.start[i + 1]; k++) {
            f[directors.edge[k]] += ruga_dot(coupling[k], v + 3 * (size_t)i);
        }
    }
    ruga_directors_solve(&directors, f, f);
    for (int i = 0; i < shell->vertex_count; i++) {
        for (int k = directors.start[i]; k < directors.start[i + 1]; k++) {
            ruga_add_scaled(-f[directors.edge[k]], coupling[k], y + 3 * (size_t)i);
        }
    }
}
