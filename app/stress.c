// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// In a triangle, F (3 x 2) is the gradient of the position over the grown rest shape, C = F^T F, and
//     E = (C - 1) / 2,   S = Y / (1 - nu^2) ((1 - nu) E + nu tr(E) 1),   sigma = F S F^T / J,   J = sqrt(det
//     C),
// plane stress of St Venant and Kirchhoff's material, to which Baraff and Witkin's energy agrees at small
// strain. The two principal stresses are the eigenvalues of S C / J, so that von Mises' stress, sqrt(s1^2 -
// s1 s2 + s2^2), is sqrt(tr(S C)^2 - 3 det(S C)) / J.
#include "app/stress.h"

#include "core/vec3.h"
#include "shell/membrane.h"

#include <math.h>
#include <string.h>

static double triangle_stress(const ruga_membrane_rest* rest, double young, double poisson,
                              const double* const x[3]) {
    double f[2][3] = {{0}}, e[2][3];
    ruga_subtract(x[1], x[0], e[0]);
    ruga_subtract(x[2], x[0], e[1]);
    for (int corner = 0; corner < 2; corner++) {
        for (int along = 0; along < 2; along++) {
            ruga_add_scaled(rest->slope[corner][along], e[corner], f[along]);
        }
    }
    double c00 = ruga_dot(f[0], f[0]), c11 = ruga_dot(f[1], f[1]), c01 = ruga_dot(f[0], f[1]);
    double e00 = 0.5 * (c00 - 1), e11 = 0.5 * (c11 - 1), e01 = 0.5 * c01;
    double k = young / (1 - poisson * poisson), trace = poisson * (e00 + e11);
    double s00 = k * ((1 - poisson) * e00 + trace), s11 = k * ((1 - poisson) * e11 + trace);
    double s01 = k * (1 - poisson) * e01, det = c00 * c11 - c01 * c01;
    double sum = s00 * c00 + 2 * s01 * c01 + s11 * c11, product = (s00 * s11 - s01 * s01) * det;
    return det > 0 ? sqrt(fmax(sum * sum - 3 * product, 0) / det) : 0;
}

static double mean(const double* values, int stride, int offset, const int* t) {
    return (values[stride * t[0] + offset] + values[stride * t[1] + offset] +
            values[stride * t[2] + offset]) /
           3;
}

void ruga_stress_compute(const ruga_mesh* mesh, const ruga_stress_skin* skin, const double* position,
                         double* work, double* stress) {
    memset(work, 0, (size_t)mesh->vertex_count * sizeof *work);
    memset(stress, 0, (size_t)mesh->vertex_count * sizeof *stress);
    for (int f = 0; f < mesh->triangle_count; f++) {
        const int* t = mesh->triangle + 3 * (size_t)f;
        const double *rest[3], *x[3];
        double growth[2] = {skin->growth[0], skin->growth[1]}, young = skin->young;
        for (int k = 0; k < 3; k++) {
            rest[k] = mesh->position + 3 * (size_t)t[k];
            x[k] = position + 3 * (size_t)t[k];
        }
        young = skin->vertex_young ? mean(skin->vertex_young, 1, 0, t) : young;
        for (int k = 0; k < 2 && skin->vertex_growth; k++) {
            growth[k] = mean(skin->vertex_growth, 2, k, t);
        }
        ruga_membrane_rest shape;
        double area = ruga_membrane_rest_create(rest, skin->poisson, growth, 1, young, &shape);
        double value = area > 0 ? triangle_stress(&shape, young, skin->poisson, x) : 0;
        for (int k = 0; k < 3; k++) {
            stress[t[k]] += area * value;
            work[t[k]] += area;
        }
    }
    for (int v = 0; v < mesh->vertex_count; v++) {
        stress[v] = work[v] > 0 ? stress[v] / work[v] : 0;
    }
}
