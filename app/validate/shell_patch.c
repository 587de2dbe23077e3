// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/shell_patch.h"

#include "core/memory.h"
#include "core/random.h"

#include <math.h>
#include <string.h>

static const double JITTER = 0.3, CLAMP_ROW = 1e-2; // in cells

// Vertices of row number k of the rows between v = 0 and v = 1, and their u.
static int row_size(const shell_patch_def* def, int k) {
    return def->closed ? def->across : def->across + 1 + k % 2;
}

static double row_u(const shell_patch_def* def, int k, int i) {
    double shift = k % 2 == 0 ? 0 : def->closed ? 0.5 : -0.5;
    double u = (i + shift) / def->across;
    return def->closed ? u : fmin(fmax(u, 0), 1);
}

static bool is_whole(double x) {
    return fabs(x - round(x)) < 1e-9;
}

// The row that a row of the mesh is, or continues where it is the one that is held beyond a clamp.
static int row_number(const shell_patch_def* def, int r) {
    int k = r - (def->clamp[0] ? 1 : 0);
    return k < 0 ? 0 : k > def->along ? def->along : k;
}

static void place_row(const shell_patch_def* def, int r, uint64_t seed, double* x) {
    int k = row_number(def, r), size = row_size(def, k);
    double beyond = r - (def->clamp[0] ? 1 : 0) - k;
    ruga_random random = {.state = seed + 1000 * (uint64_t)k};
    for (int i = 0; i < size; i++) {
        double u = row_u(def, k, i), v = (double)k / def->along;
        double du = 2 * ruga_random_uniform(&random) - 1, dv = 2 * ruga_random_uniform(&random) - 1;
        bool side = !def->closed && (i == 0 || i == size - 1), end = k == 0 || k == def->along;
        if (def->irregular && !(is_whole(4 * u) && is_whole(2 * v))) {
            u += side ? 0 : JITTER * du / def->across;
            v += end ? 0 : JITTER * dv / def->along;
        }
        def->map(u, v + beyond * CLAMP_ROW / def->along, x + 3 * (size_t)i);
    }
}

// Triangles between two rows: of the two next edges, the one whose middle comes first.
static int join_rows(const shell_patch_def* def, int lower, int upper, int first_lower, int first_upper,
                     int* triangle) {
    int nl = row_size(def, lower), nu = row_size(def, upper), count = 0;
    int end_l = def->closed ? nl : nl - 1, end_u = def->closed ? nu : nu - 1;
    for (int i = 0, j = 0; i < end_l || j < end_u; count++) {
        double a = row_u(def, lower, i) + (i < end_l ? row_u(def, lower, i + 1) : 9);
        double b = row_u(def, upper, j) + (j < end_u ? row_u(def, upper, j + 1) : 9);
        int* t = triangle + 3 * (size_t)count;
        t[0] = first_lower + i % nl;
        t[2] = first_upper + j % nu;
        t[1] = a < b ? first_lower + (i + 1) % nl : first_upper + (j + 1) % nu;
        i += a < b;
        j += !(a < b);
    }
    return count;
}

static ruga_status fill(const shell_patch_def* def, shell_patch* patch, double* position, int* triangle) {
    int faces = 0;
    for (int r = 0; r < patch->row_count; r++) {
        place_row(def, r, 7, position + 3 * (size_t)patch->row[r]);
        if (r > 0) {
            faces += join_rows(def, row_number(def, r - 1), row_number(def, r), patch->row[r - 1],
                               patch->row[r], triangle + 3 * (size_t)faces);
        }
    }
    ruga_mesh_def mesh = {.vertex_count = patch->row[patch->row_count],
                          .positions = position,
                          .triangle_count = faces,
                          .triangles = triangle};
    return ruga_mesh_from_def(&mesh, &patch->mesh);
}

ruga_status shell_patch_create(const shell_patch_def* def, shell_patch* patch) {
    ruga_status status = RUGA_OK;
    double* position = NULL;
    int* triangle = NULL;
    *patch = (shell_patch){.row_count = def->along + 1 + def->clamp[0] + def->clamp[1]};
    RUGA_TRY_DONE(RUGA_NEW_ZERO(patch->row, patch->row_count + 1));
    for (int r = 0; r < patch->row_count; r++) {
        patch->row[r + 1] = patch->row[r] + row_size(def, row_number(def, r));
    }
    RUGA_TRY_DONE(RUGA_NEW(position, 3 * (size_t)patch->row[patch->row_count]));
    RUGA_TRY_DONE(RUGA_NEW(triangle, 6 * (size_t)patch->row[patch->row_count]));
    RUGA_TRY_DONE(fill(def, patch, position, triangle));
done:
    ruga_release(position);
    ruga_release(triangle);
    if (status != RUGA_OK) {
        shell_patch_clear(patch);
    }
    return status;
}

void shell_patch_clear(shell_patch* patch) {
    ruga_mesh_clear(&patch->mesh);
    ruga_release(patch->row);
    *patch = (shell_patch){.row_count = 0};
}
