// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Rest state of a shell, and the pattern of its Hessian. Energy, gradient and Hessian are sums over triangles
// (membrane.c) and over hinges, one for each interior edge (bending.c), or over patches (directors.c);
// energy.c evaluates them. A hinge's stiffness is
//   k = D |e|^2 / (A1 + A2),  D = E h^3 / (12 (1 - nu^2)).
// Where its two triangles differ, D is (A1 + A2) / (A1/D1 + A2/D2): both carry the same moment, so that their
// curvatures, and not their stiffnesses, add up.
#include "shell/shell_internal.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"
#include "shell/bending.h"
#include "shell/thickness.h"

#include <limits.h>
#include <string.h>

// ---- Rest state

static ruga_status fail_at_face(ruga_status status, const ruga_mesh* mesh, int f, const char* what) {
    const double* x[3];
    ruga_triangle_corners(mesh->triangle + 3 * (size_t)f, mesh->position, x);
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
        ruga_triangle_corners(shell->triangle[f], mesh->position, x);
        area[f] =
            ruga_membrane_rest_create(x, material->skin.poisson, growth, h, young, &shell->triangle_rest[f]);
        if (area[f] == 0) {
            return fail_at_face(RUGA_BAD_MESH, mesh, f, "has no area: delete or collapse it, or remesh");
        }
        const ruga_shell_cut* cut = material->cut;
        for (int i = 0; i < 3; i++) {
            double mass = material->skin.density * h * area[f];
            shell->vertex_mass[shell->triangle[f][i]] += cut ? mass * cut->mass[f][i] : mass / 3;
        }
        shell->triangle_rest[f].stretch *= cut ? cut->stiffness[f] : 1;
        shell->triangle_rest[f].shear *= cut ? cut->stiffness[f] : 1;
    }
    return RUGA_OK;
}

static void set_hinge(ruga_shell* shell, const ruga_mesh* mesh, const ruga_shell_material* material, int h,
                      const int side[2], const double* area) {
    const double* x[4];
    double edge[3], length = 0;
    ruga_hinge_corners(shell->hinge[h], mesh->position, x);
    ruga_subtract(x[1], x[0], edge);
    for (int i = 0; i < 2; i++) {
        const double* corner[3];
        ruga_triangle_corners(shell->triangle[side[i]], mesh->position, corner);
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
            if (shell->next_hinge) {
                shell->next_hinge[h][side] = shell->triangle_hinge[f][i];
            }
            shell->triangle_hinge[f][i] = h;
            shell->hinge_side[h][side] = f;
        }
    }
}

static void set_hinges(ruga_shell* shell, const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                       const ruga_shell_material* material, const double* area) {
    memset(shell->triangle_hinge, -1, (size_t)shell->triangle_count * sizeof *shell->triangle_hinge);
    const ruga_shell_cut* cut = material->cut;
    for (int b = 0; cut && b < cut->bend_count; b++) {
        const ruga_shell_bend* bend = &cut->bend[b];
        memcpy(shell->hinge[b], bend->vertex, sizeof bend->vertex);
        set_hinge(shell, mesh, material, b, bend->triangle, area);
        shell->hinge_rest[b].stiffness *= bend->fraction;
        note_hinge(shell, bend->triangle[0], bend->vertex[0], b, 0);
        note_hinge(shell, bend->triangle[1], bend->vertex[1], b, 1);
    }
    int h = 0;
    for (int e = 0; !cut && e < connectivity->edge_count; e++) {
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
        softness += 1 / (area[f] * ruga_shell_material_bending(material, f));
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
        ruga_director_stiffness(area[f] * ruga_shell_material_bending(material, f), nu, form[f],
                                d->stiffness[f]);
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
    RUGA_TRY(RUGA_NEW(shell->patch_gradient, shell->triangle_count));
    RUGA_TRY(RUGA_NEW(form, shell->triangle_count));
    set_patch(shell, connectivity);
    set_stiffness(shell, material, area, form);
    ruga_release(form);
    return ruga_directors_link(d);
}

static ruga_status set_rest(ruga_shell* shell, const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                            const ruga_shell_material* material) {
    RUGA_TRY(set_triangles(shell, mesh, material, shell->rest_area));
    set_hinges(shell, mesh, connectivity, material, shell->rest_area);
    return shell->has_directors ? set_directors(shell, connectivity, material, shell->rest_area) : RUGA_OK;
}

// ---- Pattern and gathers

// Triangles, hinges, and what others will add.
static ruga_status set_cut_pattern(ruga_shell* shell, const ruga_shell_cut* cut) {
    int(*pairs)[2] = NULL;
    int64_t count = 0;
    RUGA_TRY(RUGA_NEW(pairs, 3 * (int64_t)shell->triangle_count + shell->hinge_count + cut->pair_count));
    for (int k = 0; k < 3 * shell->triangle_count; k++, count++) {
        pairs[count][0] = shell->triangle[k / 3][k % 3];
        pairs[count][1] = shell->triangle[k / 3][(k + 1) % 3];
    }
    for (int h = 0; h < shell->hinge_count; h++) {
        memcpy(pairs[count++], shell->hinge[h] + 2, sizeof *pairs);
    }
    for (int k = 0; k < cut->pair_count; k++) {
        memcpy(pairs[count++], cut->pair[k], sizeof *pairs);
    }
    ruga_status status =
        ruga_sparse_from_pairs(shell->vertex_count, 3, count, (const int(*)[2])pairs, &shell->pattern);
    ruga_release(pairs);
    return status;
}

static ruga_status set_mesh_pattern(ruga_shell* shell, const ruga_connectivity* connectivity) {
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
    return status;
}

static ruga_status set_pattern(ruga_shell* shell, const ruga_connectivity* connectivity,
                               const ruga_shell_cut* cut) {
    RUGA_TRY(cut ? set_cut_pattern(shell, cut) : set_mesh_pattern(shell, connectivity));
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
    int *target = NULL, count = RUGA_SHELL_PATCH * RUGA_SHELL_PATCH * shell->hinge_count;
    RUGA_TRY(RUGA_NEW(target, count));
    for (int k = 0; k < count; k++) {
        const int* side = shell->directors.hinge_triangle[k / (RUGA_SHELL_PATCH * RUGA_SHELL_PATCH)];
        int a = shell->patch[side[0]][k / RUGA_SHELL_PATCH % RUGA_SHELL_PATCH],
            b = shell->patch[side[1]][k % RUGA_SHELL_PATCH];
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
    RUGA_TRY(block_gather_create(shell, triangles, 3, shell->triangle[0], &shell->block_triangle));
    if (!shell->has_directors) {
        return block_gather_create(shell, hinges, 4, shell->hinge[0], &shell->block_hinge);
    }
    RUGA_TRY(block_gather_create(shell, triangles, RUGA_SHELL_PATCH, shell->patch[0], &shell->block_patch));
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
    RUGA_TRY(RUGA_NEW(shell->hinge_side, hinges));
    RUGA_TRY(RUGA_NEW(shell->rest_area, triangles));
    RUGA_TRY(RUGA_NEW_ZERO(shell->vertex_mass, shell->vertex_count));
    RUGA_TRY(RUGA_NEW(shell->triangle_gradient, triangles));
    RUGA_TRY(RUGA_NEW(shell->triangle_block, triangles));
    RUGA_TRY(RUGA_NEW(shell->hinge_moment, hinges));
    RUGA_TRY(RUGA_NEW(shell->hinge_bend, hinges));
    if (shell->has_directors) {
        RUGA_TRY(RUGA_NEW(shell->hinge_gradient, hinges));
        RUGA_TRY(RUGA_NEW(shell->hinge_angle, hinges));
    } else {
        RUGA_TRY(RUGA_NEW(shell->hinge_product, hinges));
    }
    if (shell->thickness_power != 0) {
        RUGA_TRY(RUGA_NEW(shell->thickness, triangles));
    }
    int most = triangles > hinges ? triangles : hinges;
    return RUGA_NEW(shell->partial, ruga_chunk_count(most, RUGA_SHELL_CHUNK));
}

ruga_status ruga_shell_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                              const ruga_shell_material* material, ruga_shell** shell) {
    ruga_status status = RUGA_OK;
    ruga_shell* made = NULL;
    *shell = NULL;
    RUGA_ASSERT(material->cut || connectivity->vertex_count == mesh->vertex_count);
    RUGA_ASSERT(material->cut || connectivity->triangle_count == mesh->triangle_count);
    RUGA_ASSERT(!material->cut || material->skin.bending == RUGA_BENDING_HINGE);
    RUGA_TRY(ruga_shell_material_check(material));
    int hinges = material->cut ? material->cut->bend_count : count_hinges(connectivity);
    bool made_of_patches = material->skin.bending == RUGA_BENDING_KIRCHHOFF_LOVE;
    if (mesh->triangle_count > INT_MAX / (made_of_patches ? RUGA_SHELL_PATCH * RUGA_SHELL_PATCH : 9) ||
        hinges > INT_MAX / 16) {
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
    if (material->cut) {
        RUGA_TRY_DONE(RUGA_NEW(made->next_hinge, hinges));
    }
    RUGA_TRY_DONE(set_rest(made, mesh, connectivity, material));
    RUGA_TRY_DONE(set_pattern(made, connectivity, material->cut));
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
    ruga_release(s->hinge_side);
    ruga_release(s->next_hinge);
    ruga_release(s->rest_area);
    ruga_release(s->thickness);
    ruga_release(s->hinge_bend);
    ruga_release(s->hinge_product);
    ruga_release(s->vertex_mass);
    ruga_sparse_clear(&s->pattern);
    ruga_release(s->block_start);
    ruga_gather_clear(&s->vertex_triangle);
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
