// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "constraints/laplacian.h"

#include "core/vec3.h"

#include <string.h>

ruga_status ruga_laplacian_weights(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                   double* weight) {
    return ruga_laplacian_weights_scaled(mesh, connectivity, NULL, weight);
}

ruga_status ruga_laplacian_weights_scaled(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                          const double* triangle_b, double* weight) {
    memset(weight, 0, (size_t)connectivity->edge_count * sizeof *weight);
    for (int t = 0; t < mesh->triangle_count; t++) {
        const int* corner = mesh->triangle + 3 * (size_t)t;
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double u[3], v[3], n[3];
            ruga_subtract(mesh->position + 3 * (size_t)corner[j], mesh->position + 3 * (size_t)corner[i], u);
            ruga_subtract(mesh->position + 3 * (size_t)corner[k], mesh->position + 3 * (size_t)corner[i], v);
            ruga_cross(u, v, n);
            double sine = ruga_norm(n), cosine = ruga_dot(u, v); // both times |u| |v|
            // Below this a sine is round-off of its operands and the cotangent has no digit left.
            if (!(sine > 1e-14 * (ruga_norm(u) * ruga_norm(v)))) {
                return ruga_fail(RUGA_BAD_MESH,
                                 "face %d has no area: its corners lie on a line; remove it or remesh", t);
            }
            weight[connectivity->triangle_edge[t][j]] +=
                (triangle_b ? triangle_b[t] : 1) * (0.5 * cosine / sine);
        }
    }
    return RUGA_OK;
}
