// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Low-pass constraints H x = H B q: Gaussian clusters (Remillard and Kry 2013, section 3.1) or the smallest
// eigenvectors of the mesh Laplacian (3.2). H acts on each component alike, so its scalar form is kept.
#ifndef RUGA_CONSTRAINTS_CLUSTERS_H
#define RUGA_CONSTRAINTS_CLUSTERS_H

#include "mesh/connectivity.h"
#include "mesh/mesh.h"

typedef struct ruga_clusters {
    int count;
    int vertex_count;
    int* center;    // [count] vertex; NULL for spectral
    int* start;     // [count + 1]
    int* vertex;    // [start[count]] ascending in each row
    double* weight; // [start[count]] each row of Gaussian clusters sums to one
    // The same entries by vertex, for H^T: rows ascending in each column.
    int* column_start;     // [vertex_count + 1]
    int* column_row;       // [start[count]]
    double* column_weight; // [start[count]]
} ruga_clusters;

// Farthest-point centres by edge-path distance from a seeded random first vertex (in every connected
// component), until each vertex is within `radius` of one, or `count` centres where count > 0; truncated
// Gaussian weights exp(-d^2 / 2 sigma^2) for d < 2 sigma. Vertices without a face belong to no cluster.
// RUGA_BAD_INPUT where count is below the number of components or above that of the vertices, or where sigma
// (or, without count, radius) is not positive.
ruga_status ruga_clusters_create(const ruga_mesh* mesh, const ruga_connectivity* connectivity, double radius,
                                 double sigma, int count, int64_t seed, ruga_clusters* clusters);

// The same where the wavelength varies: lengths are measured in local ones, `scale` [V] (> 0) being the local
// wavelength over the one that radius and sigma are for. Centres are farthest points in the metric |dx| /
// scale, to within radius; a centre's Gaussian has the width sigma * scale at the centre, in metres. scale
// NULL: 1 everywhere.
ruga_status ruga_clusters_create_local(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                       double radius, double sigma, const double* scale, int count,
                                       int64_t seed, ruga_clusters* clusters);

// Rows = the `count` eigenvectors L phi = lambda M phi of the mesh Laplacian (cotangent L, lumped mass M)
// with smallest eigenvalues, as phi^T M scaled to unit 2-norm: H x is the spectral coefficient. One constant
// vector for each component comes first, then ascending eigenvalues. RUGA_BAD_INPUT where count is below the
// number of components or above half of the vertices.
ruga_status ruga_clusters_create_spectral(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                          int count, ruga_clusters* clusters);
void ruga_clusters_clear(ruga_clusters* clusters);

// Fills the transpose (column_...) from the rows; for those who fill the rows themselves.
ruga_status ruga_clusters_transpose(ruga_clusters* clusters);

// y = H x for 3 components: x [V][3], y [count][3].   x += H^T y.
void ruga_clusters_apply(const ruga_clusters* clusters, const double* x, double* y);
void ruga_clusters_apply_transpose(const ruga_clusters* clusters, const double* y, double* x);

// radius and sigma in m for a wavelength: `paper`: sigma = lambda/pi, radius = sigma (r/2 with r = 2 sigma);
// `calibrated`: both 1.5 times that.
void ruga_clusters_rule(ruga_coupling_rule rule, double wavelength, double* radius, double* sigma);

#endif
