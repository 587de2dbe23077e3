// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Rest state and assembly: energy, gradient and Hessian are sums over triangles (membrane.c) and over hinges,
// one for each interior edge (bending.c):
//   E = D/2 |e|^2 / (A1 + A2) (theta - theta0)^2,  D = E h^3 / (12 (1 - nu^2)).
// Where its two triangles differ, D is (A1 + A2) / (A1/D1 + A2/D2): both carry the same moment, so that their
// curvatures, and not their stiffnesses, add up.
//
// The Hessian of a hinge is k grad grad^T + k (theta - theta0) H, and H splits into one part for each of the
// two triangles; these are added to the matrices of the triangles. So each triangle writes a 9 x 9 matrix,
// and a hinge's own part is made from its gradient when it is gathered. Everything is computed for each
// element first, and then gathered for each vertex, in an order that the mesh alone decides: the bits are the
// same for any number of threads.
//
// With directors (directors.c) a hinge's moment is not its stiffness times its angle but comes from all of
// them. The part w grad t Q (w grad t)^T couples the three hinges of a triangle with one another and with its
// neighbours', and so the vertices of its patch (its corners and those of its neighbours, up to six) with one
// another and with the neighbours' patches: patches and pairs of them are two more kinds of elements.
#include "shell/shell.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"
#include "shell/bending.h"
#include "shell/gather.h"
#include "shell/membrane.h"

#include <limits.h>
#include <string.h>

enum { CHUNK = 256 }; // elements or vertices in one piece of parallel work
enum { PATCH = 6 };   // vertices of a triangle and its neighbours

typedef struct hinge_rest {
    double stiffness; // k = D |e|^2 / (A1 + A2), J
    double angle;
} hinge_rest;

struct ruga_shell {
    ruga_membrane membrane;
    double poisson;
    int vertex_count, triangle_count, hinge_count;
    int (*triangle)[3];
    ruga_membrane_rest* triangle_rest; // [F]
    int (*triangle_hinge)[3];          // [F] hinge at the edge from corner i to corner i + 1, or -1
    int (*hinge)[4];                   // [H] as in ruga_hinge_angle
    hinge_rest* hinge_rest;            // [H]
    bool has_directors;
    ruga_directors directors;
    int (*patch)[PATCH]; // [F] with directors: corners, then the corner across edge i or -1
    double* vertex_mass; // [V]
    ruga_sparse pattern;
    int* block_start;            // [V + 1] first 3 x 3 block of a vertex's columns
    ruga_gather vertex_triangle; // vertex <- 3 triangle + corner
    ruga_gather vertex_hinge;    // vertex <- 4 hinge + corner
    ruga_gather block_triangle;  // block <- 9 triangle + 3 row corner + column corner
    ruga_gather block_hinge;     // block <- 16 hinge + 4 row corner + column corner
    ruga_gather block_patch; // block <- 36 triangle + 6 row + column; in place of block_hinge with directors
    ruga_gather block_pair;  // block <- 36 hinge + 6 vertex of one patch + vertex of the other
    // Scratch of ruga_shell_energy, which writes here although the shell is const.
    double (*triangle_gradient)[3][3];                 // [F]
    double (*triangle_block)[RUGA_TRIANGLE_BLOCKS][9]; // [F]
    double (*hinge_gradient)[4][3];                    // [H] of the angle
    double* hinge_moment;                              // [H] k (theta - theta0)
    double* hinge_angle;                               // [H] with directors: theta - theta0
    double (*patch_gradient)[3][PATCH][3];             // [F] with directors: of w t
    double (*partial)[2];                              // [chunks] energy, sum of squared forces
};

// ---- Rest state

static ruga_status check_positive(double value, const char* name, const char* unit) {
    if (!(value > 0) || !isfinite(value)) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.%s is %g%s: it must be above 0", name, value, unit);
    }
    return RUGA_OK;
}

static ruga_status check_skin(const ruga_shell_material* material) {
    const ruga_skin_def* skin = &material->skin;
    if (!material->thickness) {
        RUGA_TRY(check_positive(skin->thickness, "thickness", " m"));
    }
    if (!material->young) {
        RUGA_TRY(check_positive(skin->young, "young", " Pa"));
    }
    if (!material->growth) {
        RUGA_TRY(check_positive(skin->growth[0], "growth[0]", ""));
        RUGA_TRY(check_positive(skin->growth[1], "growth[1]", ""));
    }
    if (!(skin->poisson > -1 && skin->poisson < 0.5)) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.poisson is %g: it must be above -1 and below 0.5",
                         skin->poisson);
    }
    if (!(skin->density >= 0) || !isfinite(skin->density)) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.density is %g kg/m^3: it must not be negative", skin->density);
    }
    return RUGA_OK;
}

static double thickness_of(const ruga_shell_material* material, int f) {
    return material->thickness ? material->thickness[f] : material->skin.thickness;
}

static double young_of(const ruga_shell_material* material, int f) {
    return material->young ? material->young[f] : material->skin.young;
}

static const double* growth_of(const ruga_shell_material* material, int f) {
    return material->growth ? material->growth + 2 * (size_t)f : material->skin.growth;
}

static double bending_stiffness(const ruga_shell_material* material, int f) {
    double h = thickness_of(material, f), nu = material->skin.poisson;
    return young_of(material, f) * h * h * h / (12 * (1 - nu * nu));
}

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
        double h = thickness_of(material, f), young = young_of(material, f);
        if (!(h > 0) || !isfinite(h)) {
            return fail_at_face(RUGA_BAD_INPUT, mesh, f,
                                "has a thickness that is not above 0: give it one in m");
        }
        if (!(young > 0) || !isfinite(young)) {
            return fail_at_face(RUGA_BAD_INPUT, mesh, f,
                                "has a Young's modulus that is not above 0: give it one in Pa");
        }
        const double *x[3], *growth = growth_of(material, f);
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
        length += 0.5 * ruga_membrane_grown_length(corner, edge, growth_of(material, side[i]));
    }
    double a0 = area[side[0]], a1 = area[side[1]];
    double softness = a0 / bending_stiffness(material, side[0]) + a1 / bending_stiffness(material, side[1]);
    shell->hinge_rest[h].stiffness = length * length / softness;
    shell->hinge_rest[h].angle = ruga_hinge_angle(x, NULL);
}

// Tells the triangle that hinge `h` is at its edge that begins at `vertex`.
static void note_hinge(ruga_shell* shell, int f, int vertex, int h) {
    for (int i = 0; i < 3; i++) {
        if (shell->triangle[f][i] == vertex) {
            shell->triangle_hinge[f][i] = h;
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
        note_hinge(shell, side[0], vertex[0], h);
        note_hinge(shell, side[1], vertex[1], h);
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

// Both sides' A D in series, so that the term is never large against what either triangle has. Nothing bends
// on a held side, and across a crease nothing makes curvatures agree: hence the square of the rest angle's
// cosine.
static double jump_scale(const ruga_shell* shell, const ruga_shell_material* material, int h,
                         const double* area) {
    double softness = 0, cosine = fmax(cos(shell->hinge_rest[h].angle), 0);
    for (int i = 0; i < 2; i++) {
        int f = shell->directors.hinge_triangle[h][i];
        if (material->held && material->held[f]) {
            return 0;
        }
        softness += 1 / (area[f] * bending_stiffness(material, f));
    }
    return cosine * cosine * 4 / (3 * softness);
}

static void set_stiffness(ruga_shell* shell, const ruga_shell_material* material, const double* area,
                          double (*form)[3][3]) {
    ruga_directors* d = &shell->directors;
    double nu = material->skin.poisson;
    for (int f = 0; f < shell->triangle_count; f++) {
        const int* h = shell->triangle_hinge[f];
        const bool rim[3] = {h[0] < 0, h[1] < 0, h[2] < 0};
        ruga_director_form(&shell->triangle_rest[f], nu, rim, form[f]);
        ruga_director_stiffness(area[f] * bending_stiffness(material, f), nu, form[f], d->stiffness[f]);
        if (material->held && material->held[f]) {
            hold_directors(shell, material, f);
        }
    }
    for (int h = 0; h < shell->hinge_count; h++) {
        ruga_directors_join(d, h, shell->triangle_rest, form, jump_scale(shell, material, h, area), nu);
    }
}

static ruga_status set_directors(ruga_shell* shell, const ruga_connectivity* connectivity,
                                 const ruga_shell_material* material, const double* area) {
    ruga_directors* d = &shell->directors;
    double(*form)[3][3] = NULL;
    RUGA_TRY(ruga_directors_create(shell->vertex_count, shell->triangle_count,
                                   (const int(*)[3])shell->triangle_hinge, shell->hinge_count,
                                   (const int(*)[4])shell->hinge, d));
    RUGA_TRY(RUGA_NEW(shell->patch, shell->triangle_count));
    RUGA_TRY(RUGA_NEW(shell->hinge_angle, shell->hinge_count));
    RUGA_TRY(RUGA_NEW(shell->patch_gradient, shell->triangle_count));
    RUGA_TRY(RUGA_NEW(form, shell->triangle_count));
    set_patch(shell, connectivity);
    set_stiffness(shell, material, area, form);
    ruga_release(form);
    return ruga_directors_link(d);
}

static ruga_status set_rest(ruga_shell* shell, const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                            const ruga_shell_material* material) {
    double* area = NULL;
    RUGA_TRY(RUGA_NEW(area, shell->triangle_count));
    ruga_status status = set_triangles(shell, mesh, material, area);
    if (status == RUGA_OK) {
        set_hinges(shell, mesh, connectivity, material, area);
    }
    if (status == RUGA_OK && shell->has_directors) {
        status = set_directors(shell, connectivity, material, area);
    }
    ruga_release(area);
    return status;
}

// ---- Pattern and gathers

static ruga_status set_pattern(ruga_shell* shell, const ruga_connectivity* connectivity) {
    int(*pairs)[2] = NULL;
    int64_t count = connectivity->edge_count + (int64_t)shell->hinge_count;
    int64_t more = 3 * (int64_t)shell->triangle_count + 9 * (int64_t)shell->hinge_count;
    RUGA_TRY(RUGA_NEW(pairs, count + (shell->has_directors ? more : 0)));
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
    // Across two patches.
    for (int k = 0; k < 9 * shell->hinge_count && shell->has_directors; k++) {
        const int* side = shell->directors.hinge_triangle[k / 9];
        int a = shell->patch[side[0]][3 + k % 9 / 3], b = shell->patch[side[1]][3 + k % 3];
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

// Number of the 3 x 3 block of two vertices, in either order; -1 where one is missing.
static int block_of(const ruga_shell* shell, int a, int b) {
    int row = a > b ? a : b, column = a > b ? b : a;
    if (column < 0) {
        return -1;
    }
    int position = ruga_sparse_find(&shell->pattern, 3 * row, 3 * column);
    RUGA_ASSERT(position >= 0);
    return shell->block_start[column] + (position - shell->pattern.start[3 * column]) / 3;
}

// Gather of the blocks of the lower triangle from all corner pairs of elements with `size` corners.
static ruga_status block_gather_create(const ruga_shell* shell, int element_count, int size,
                                       const int* vertex, ruga_gather* result) {
    int *target = NULL, pairs = size * size;
    RUGA_TRY(RUGA_NEW(target, (size_t)element_count * (size_t)pairs));
    for (int k = 0; k < element_count; k++) {
        const int* corner = vertex + (size_t)k * (size_t)size;
        for (int i = 0; i < pairs; i++) {
            int row = corner[i / size], column = corner[i % size];
            target[(size_t)k * (size_t)pairs + (size_t)i] = row >= column ? block_of(shell, row, column) : -1;
        }
    }
    ruga_status status =
        ruga_gather_create(shell->block_start[shell->vertex_count], element_count * pairs, target, result);
    ruga_release(target);
    return status;
}

// The same from all pairs of a vertex of one triangle's patch and one of its neighbour's, for each hinge.
static ruga_status pair_gather_create(const ruga_shell* shell, ruga_gather* result) {
    int *target = NULL, count = PATCH * PATCH * shell->hinge_count;
    RUGA_TRY(RUGA_NEW(target, count));
    for (int k = 0; k < count; k++) {
        const int* side = shell->directors.hinge_triangle[k / (PATCH * PATCH)];
        int a = shell->patch[side[0]][k / PATCH % PATCH], b = shell->patch[side[1]][k % PATCH];
        target[k] = block_of(shell, a, b);
    }
    ruga_status status = ruga_gather_create(shell->block_start[shell->vertex_count], count, target, result);
    ruga_release(target);
    return status;
}

static ruga_status set_gathers(ruga_shell* shell) {
    int triangles = shell->triangle_count, hinges = shell->hinge_count;
    RUGA_TRY(
        ruga_gather_create(shell->vertex_count, 3 * triangles, shell->triangle[0], &shell->vertex_triangle));
    RUGA_TRY(ruga_gather_create(shell->vertex_count, 4 * hinges, shell->hinge[0], &shell->vertex_hinge));
    RUGA_TRY(block_gather_create(shell, triangles, 3, shell->triangle[0], &shell->block_triangle));
    if (!shell->has_directors) {
        return block_gather_create(shell, hinges, 4, shell->hinge[0], &shell->block_hinge);
    }
    RUGA_TRY(block_gather_create(shell, triangles, PATCH, shell->patch[0], &shell->block_patch));
    return pair_gather_create(shell, &shell->block_pair);
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
    RUGA_TRY(RUGA_NEW_ZERO(shell->vertex_mass, shell->vertex_count));
    RUGA_TRY(RUGA_NEW(shell->triangle_gradient, triangles));
    RUGA_TRY(RUGA_NEW(shell->triangle_block, triangles));
    RUGA_TRY(RUGA_NEW(shell->hinge_gradient, hinges));
    RUGA_TRY(RUGA_NEW(shell->hinge_moment, hinges));
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
    RUGA_TRY(check_skin(material));
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
    ruga_release(s->vertex_mass);
    ruga_sparse_clear(&s->pattern);
    ruga_release(s->block_start);
    ruga_gather_clear(&s->vertex_triangle);
    ruga_gather_clear(&s->vertex_hinge);
    ruga_gather_clear(&s->block_triangle);
    ruga_gather_clear(&s->block_hinge);
    ruga_gather_clear(&s->block_patch);
    ruga_gather_clear(&s->block_pair);
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
        double moment = known ? shell->hinge_moment[h] : rest->stiffness * angle;
        shell->hinge_moment[h] = moment;
        energy += 0.5 * moment * angle;
        force_square +=
            moment * moment *
            (ruga_dot(g[0], g[0]) + ruga_dot(g[1], g[1]) + ruga_dot(g[2], g[2]) + ruga_dot(g[3], g[3]));
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
        const ruga_gather* from = &shell->vertex_triangle;
        for (int k = from->start[v]; k < from->start[v + 1]; k++) {
            int item = from->item[k];
            ruga_add_scaled(1, shell->triangle_gradient[item / 3][item % 3], sum);
        }
        from = &shell->vertex_hinge;
        for (int k = from->start[v]; k < from->start[v + 1]; k++) {
            int item = from->item[k];
            ruga_add_scaled(shell->hinge_moment[item / 4], shell->hinge_gradient[item / 4][item % 4], sum);
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
        double moment[3];
        corners(shell->triangle[f], p->x, x);
        ruga_membrane_hessian(shell->membrane, shell->poisson, &shell->triangle_rest[f], x, p->clamp,
                              shell->triangle_block[f]);
        for (int i = 0; i < 3; i++) {
            int h = shell->triangle_hinge[f][i];
            moment[i] = h < 0 ? 0 : (1 - p->clamp) * shell->hinge_moment[h];
        }
        ruga_hinge_add_hessian(x, moment, shell->triangle_block[f]);
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

static void add_hinge_block(double stiffness, const double row[3], const double column[3], double sum[9]) {
    for (int r = 0; r < 3; r++) {
        double s = stiffness * row[r];
        for (int c = 0; c < 3; c++) {
            sum[3 * r + c] += s * column[c];
        }
    }
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

// q between a vertex of triangle f's patch and one of triangle g's; the first gives the columns if `turned`.
static void add_patch_block(double (*q)[3], const double (*f)[PATCH][3], int vertex_f,
                            const double (*g)[PATCH][3], int vertex_g, bool turned, double sum[9]) {
    for (int i = 0; i < 3; i++) {
        double product[3] = {0, 0, 0};
        for (int j = 0; j < 3; j++) {
            ruga_add_scaled(q[i][j], g[j][vertex_g], product);
        }
        add_hinge_block(1, turned ? product : f[i][vertex_f], turned ? f[i][vertex_f] : product, sum);
    }
}

// Q of directors.c within triangles and between neighbours.
static void add_patch_blocks(const ruga_shell* shell, int block, double sum[9]) {
    enum { PAIRS = PATCH * PATCH };
    typedef const double(*patch)[PATCH][3];
    const ruga_directors* d = &shell->directors;
    for (int k = shell->block_patch.start[block]; k < shell->block_patch.start[block + 1]; k++) {
        int f = shell->block_patch.item[k] / PAIRS, pair = shell->block_patch.item[k] % PAIRS;
        patch g = (patch)shell->patch_gradient[f];
        add_patch_block(d->stiffness[f], g, pair / PATCH, g, pair % PATCH, false, sum);
    }
    for (int k = shell->block_pair.start[block]; k < shell->block_pair.start[block + 1]; k++) {
        int h = shell->block_pair.item[k] / PAIRS, i = shell->block_pair.item[k] % PAIRS / PATCH;
        int j = shell->block_pair.item[k] % PATCH, f = d->hinge_triangle[h][0], g = d->hinge_triangle[h][1];
        patch one = (patch)shell->patch_gradient[f], other = (patch)shell->patch_gradient[g];
        int a = shell->patch[f][i], b = shell->patch[g][j];
        if (a >= b) {
            add_patch_block(d->cross[h], one, i, other, j, false, sum);
        }
        if (a <= b) {
            add_patch_block(d->cross[h], one, i, other, j, true, sum);
        }
    }
}

static void gather_hessian(int begin, int end, int chunk, void* context) {
    (void)chunk;
    const pass* p = context;
    const ruga_shell* shell = p->shell;
    const ruga_gather *triangles = &shell->block_triangle, *hinges = &shell->block_hinge;
    for (int v = begin; v < end; v++) {
        for (int b = shell->block_start[v]; b < shell->block_start[v + 1]; b++) {
            double sum[9] = {0};
            for (int k = triangles->start[b]; k < triangles->start[b + 1]; k++) {
                int item = triangles->item[k];
                add_triangle_block(shell->triangle_block[item / 9], item % 9, sum);
            }
            if (shell->has_directors) {
                add_patch_blocks(shell, b, sum);
            }
            for (int k = shell->has_directors ? 0 : hinges->start[b];
                 !shell->has_directors && k < hinges->start[b + 1]; k++) {
                int h = hinges->item[k] / 16, pair = hinges->item[k] % 16;
                add_hinge_block(shell->hinge_rest[h].stiffness, shell->hinge_gradient[h][pair / 4],
                                shell->hinge_gradient[h][pair % 4], sum);
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
