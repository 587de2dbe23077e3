// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Spectral rows, Remillard and Kry 2013, section 3.2: the smallest eigenpairs of L phi = lambda M phi, L the
// cotangent Laplacian and M the lumped areas. With psi = M^(1/2) phi this is the standard problem of
//     A = M^(-1/2) L M^(-1/2),   A psi = lambda psi,
// solved by ARPACK's Lanczos iteration on (A + s I)^-1 (shift-invert, factored by CHOLMOD), s > 0 since A is
// singular. Row i of H is phi_i^T M = psi_i^T M^(1/2), scaled to unit 2-norm.
//
// A Lanczos iteration sees one vector of a multiple eigenvalue; its copies come in by round-off, or not at
// all. So the null space (one constant for each component) is not computed but given, all that is known is
// projected out of the operator, and after a run another one looks for larger eigenvalues that were missed.
#include "constraints/clusters.h"

#include "constraints/laplacian.h"
#include "core/memory.h"
#include "core/random.h"
#include "core/sparse.h"
#include "core/vec3.h"

#include <arpack/arpack.h>
#include <cblas.h>
#include <cholmod.h>

#include <limits.h>
#include <pthread.h>
#include <string.h>

typedef struct eigenpair {
    double theta; // 1 / (lambda + s)
    int column;   // of psi
} eigenpair;

typedef struct spectrum {
    int n;             // vertices that have faces
    int* vertex;       // [n] of the mesh
    double* root_mass; // [n]
    int components;
    int wanted;      // eigenvectors in all
    int found;       // the first `components` are the null space, the others by ascending eigenvalue
    eigenpair* pair; // [wanted]
    double* psi;     // [wanted][n] orthonormal
    cholmod_common common;
    cholmod_factor* factor;
    cholmod_dense* solution;
    cholmod_dense *work_y, *work_e; // of cholmod_solve2
} spectrum;

// ARPACK keeps state in static variables, and the number of BLAS threads belongs to the process.
static pthread_mutex_t arpack_lock = PTHREAD_MUTEX_INITIALIZER;

static ruga_status collect_vertices(const ruga_mesh* mesh, const ruga_connectivity* c, spectrum* s,
                                    int* number) {
    ruga_status status = RUGA_OK;
    double* area = NULL;
    RUGA_TRY(RUGA_NEW(s->vertex, c->vertex_count));
    RUGA_TRY(RUGA_NEW(s->root_mass, c->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(area, c->vertex_count));
    ruga_mesh_vertex_areas(mesh, area);
    for (int v = 0; v < c->vertex_count; v++) {
        number[v] = -1;
        if (c->component[v] >= 0) {
            number[v] = s->n;
            s->root_mass[s->n] = sqrt(area[v]);
            s->vertex[s->n++] = v;
        }
    }
done:
    ruga_release(area);
    return status;
}

static ruga_status factor_status(const cholmod_common* common, const cholmod_factor* factor) {
    if (common->status == CHOLMOD_OUT_OF_MEMORY) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory while factoring the mesh Laplacian");
    }
    if (!factor || common->status != CHOLMOD_OK || factor->minor < factor->n) {
        return ruga_fail(
            RUGA_LIBRARY,
            "CHOLMOD could not factor the mesh Laplacian (status %d): the mesh may hold slivers; "
            "remesh it or use coupling.kind: clusters",
            common->status);
    }
    return RUGA_OK;
}

// Values of A + shift I in the lower triangle whose pattern is the mesh's edges.
static void fill_values(const spectrum* s, const ruga_connectivity* c, const int* number,
                        const double* weight, double shift, ruga_sparse* a) {
    for (int j = 0; j < s->n; j++) {
        a->value[a->start[j]] = shift;
    }
    for (int e = 0; e < c->edge_count; e++) {
        int i = number[c->edge[e][0]], j = number[c->edge[e][1]];
        double mi = s->root_mass[i], mj = s->root_mass[j];
        a->value[a->start[i]] += weight[e] / (mi * mi);
        a->value[a->start[j]] += weight[e] / (mj * mj);
        a->value[ruga_sparse_find(a, i > j ? i : j, i > j ? j : i)] = -weight[e] / (mi * mj);
    }
}

static ruga_status factor(spectrum* s, const ruga_connectivity* c, const int* number, const double* weight) {
    ruga_status status = RUGA_OK;
    ruga_sparse a = {0};
    int(*pairs)[2] = NULL;
    RUGA_TRY_DONE(RUGA_NEW(pairs, c->edge_count));
    double area = 0;
    for (int e = 0; e < c->edge_count; e++) {
        pairs[e][0] = number[c->edge[e][0]];
        pairs[e][1] = number[c->edge[e][1]];
    }
    for (int i = 0; i < s->n; i++) {
        area += s->root_mass[i] * s->root_mass[i];
    }
    RUGA_TRY_DONE(ruga_sparse_from_pairs(s->n, 1, c->edge_count, (const int(*)[2])pairs, &a));
    // Weyl: lambda_i is about 4 pi i / area, so this shift is the scale of the first eigenvalue: far above
    // round-off of the largest, and it leaves the wanted end of the spectrum well apart.
    fill_values(s, c, number, weight, 4 * RUGA_PI / area, &a);
    cholmod_sparse view = {.nrow = (size_t)s->n,
                           .ncol = (size_t)s->n,
                           .nzmax = (size_t)a.start[s->n],
                           .p = a.start,
                           .i = a.index,
                           .x = a.value,
                           .stype = -1,
                           .itype = CHOLMOD_INT,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE,
                           .sorted = 1,
                           .packed = 1};
    s->factor = cholmod_analyze(&view, &s->common);
    if (s->factor) {
        cholmod_factorize(&view, s->factor, &s->common);
    }
    RUGA_TRY_DONE(factor_status(&s->common, s->factor));
done:
    ruga_release(pairs);
    ruga_sparse_clear(&a);
    return status;
}

// x -= sum_k psi_k (psi_k . x) over all found, twice: once leaves what round-off of a large part brings back.
static void project(const spectrum* s, double* x) {
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < s->found; k++) {
            const double* psi = s->psi + (size_t)s->n * (size_t)s->pair[k].column;
            cblas_daxpy(s->n, -cblas_ddot(s->n, psi, 1, x, 1), psi, 1, x, 1);
        }
    }
}

// y = P (A + s I)^-1 P x
static ruga_status apply_operator(spectrum* s, const double* x, double* y) {
    memcpy(y, x, (size_t)s->n * sizeof *y);
    project(s, y);
    cholmod_dense right = {.nrow = (size_t)s->n,
                           .ncol = 1,
                           .nzmax = (size_t)s->n,
                           .d = (size_t)s->n,
                           .x = y,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
    if (!cholmod_solve2(CHOLMOD_A, s->factor, &right, NULL, &s->solution, NULL, &s->work_y, &s->work_e,
                        &s->common)) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory while solving for the mesh's eigenvectors");
    }
    memcpy(y, s->solution->x, (size_t)s->n * sizeof *y);
    project(s, y);
    return RUGA_OK;
}

// One ARPACK run: the `count` largest eigenpairs of the projected operator, theta ascending as ARPACK leaves
// them, vectors in basis[0 .. count - 1].
static ruga_status lanczos(spectrum* s, int count, int basis_size, uint64_t seed, double* theta,
                           double* basis) {
    ruga_status status = RUGA_OK;
    double *residual = NULL, *work = NULL, *small = NULL;
    int* select = NULL;
    int small_size = basis_size * (basis_size + 8);
    RUGA_TRY_DONE(RUGA_NEW(residual, s->n));
    RUGA_TRY_DONE(RUGA_NEW(work, 3 * (size_t)s->n));
    RUGA_TRY_DONE(RUGA_NEW(small, small_size));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(select, basis_size));
    ruga_random random = {seed};
    for (int i = 0; i < s->n; i++) {
        residual[i] = ruga_random_uniform(&random) - 0.5;
    }
    project(s, residual);
    // Mode 1: the operator is given as such; exact shifts; up to 1000 restarts.
    int request = 0, info = 1, parameter[11] = {1, 0, 1000, 1, 0, 0, 1}, place[14] = {0};
    do {
        dsaupd_c(&request, "I", s->n, "LA", count, 0, residual, basis_size, basis, s->n, parameter, place,
                 work, small, small_size, &info);
        if (request == 1 || request == -1) {
            RUGA_TRY_DONE(apply_operator(s, work + place[0] - 1, work + place[1] - 1));
        }
    } while (request == 1 || request == -1);
    if (info == 0) {
        dseupd_c(1, "A", select, theta, basis, s->n, 0, "I", s->n, "LA", count, 0, residual, basis_size,
                 basis, s->n, parameter, place, work, small, small_size, &info);
    }
    if (info != 0) {
        status =
            ruga_fail(RUGA_LIBRARY,
                      "ARPACK did not find the mesh's eigenvectors (info %d): lower coupling.count", info);
    }
done:
    ruga_release(residual);
    ruga_release(work);
    ruga_release(small);
    ruga_release(select);
    return status;
}

// Puts a new pair in its place behind the null space, the last one falling out when all are there. False
// where it is not among the wanted.
static bool insert(spectrum* s, double theta, const double* vector, int* free_column) {
    bool full = s->found == s->wanted;
    if (full && (s->found == s->components || theta <= s->pair[s->found - 1].theta)) {
        return false;
    }
    int column = full ? s->pair[s->found - 1].column : (*free_column)++;
    int k = full ? s->found - 1 : s->found++;
    memcpy(s->psi + (size_t)s->n * (size_t)column, vector, (size_t)s->n * sizeof *vector);
    for (; k > s->components && s->pair[k - 1].theta < theta; k--) {
        s->pair[k] = s->pair[k - 1];
    }
    s->pair[k] = (eigenpair){theta, column};
    return true;
}

static void add_constants(spectrum* s, const ruga_connectivity* c) {
    for (int k = 0; k < s->components; k++) {
        double* psi = s->psi + (size_t)s->n * (size_t)k;
        double square = 0;
        for (int i = 0; i < s->n; i++) {
            psi[i] = c->component[s->vertex[i]] == k ? s->root_mass[i] : 0;
            square += psi[i] * psi[i];
        }
        cblas_dscal(s->n, 1 / sqrt(square), psi, 1);
        s->pair[k] = (eigenpair){INFINITY, k};
    }
    s->found = s->components;
}

static ruga_status find_all(spectrum* s) {
    ruga_status status = RUGA_OK;
    double *theta = NULL, *basis = NULL;
    enum { CHECKED = 4 }; // eigenpairs that a checking run looks for
    int first = s->wanted - s->components;
    int largest = first > CHECKED ? first : CHECKED;
    int room = s->n - s->components;
    int basis_room = 2 * largest + 20 < room ? 2 * largest + 20 : room;
    int column = s->components;
    RUGA_TRY_DONE(RUGA_NEW(theta, largest));
    RUGA_TRY_DONE(RUGA_NEW(basis, (size_t)basis_room * (size_t)s->n));
    bool more = first > 0;
    for (uint64_t run = 0; more; run++) {
        int left = s->n - s->found;
        int count = run == 0 ? first : CHECKED;
        count = count < left ? count : left - 1;
        if (count < 1) {
            break;
        }
        int size = 2 * count + 20 < left ? 2 * count + 20 : left;
        RUGA_TRY_DONE(lanczos(s, count, size < basis_room ? size : basis_room, run, theta, basis));
        more = run == 0;
        for (int k = 0; k < count; k++) {
            // Equal to round-off does not count as missed: either vector is as good.
            double least = s->found == s->wanted ? s->pair[s->found - 1].theta * (1 + 1e-10) : 0;
            more |= theta[k] > least && insert(s, theta[k], basis + (size_t)s->n * (size_t)k, &column);
        }
    }
done:
    ruga_release(theta);
    ruga_release(basis);
    return status;
}

// Rows psi^T M^(1/2) of unit norm; of two signs the one with a positive largest entry (the first of equals).
static ruga_status write_rows(const spectrum* s, ruga_clusters* clusters) {
    size_t entries = (size_t)s->found * (size_t)s->n;
    if (entries > INT_MAX) {
        return ruga_fail(RUGA_NO_MEMORY, "%d eigenvectors of %d vertices are too many: lower coupling.count",
                         s->found, s->n);
    }
    RUGA_TRY(RUGA_NEW(clusters->start, s->found + 1));
    RUGA_TRY(RUGA_NEW(clusters->vertex, entries));
    RUGA_TRY(RUGA_NEW(clusters->weight, entries));
    clusters->count = s->found;
    for (int k = 0; k <= s->found; k++) {
        clusters->start[k] = k * s->n;
    }
    for (int k = 0; k < s->found; k++) {
        const double* psi = s->psi + (size_t)s->n * (size_t)s->pair[k].column;
        double* row = clusters->weight + clusters->start[k];
        double square = 0, peak = 0;
        for (int i = 0; i < s->n; i++) {
            clusters->vertex[clusters->start[k] + i] = s->vertex[i];
            row[i] = psi[i] * s->root_mass[i];
            square += row[i] * row[i];
            peak = fabs(row[i]) > fabs(peak) ? row[i] : peak;
        }
        cblas_dscal(s->n, (peak < 0 ? -1 : 1) / sqrt(square), row, 1);
    }
    return ruga_clusters_transpose(clusters);
}

static ruga_status check_count(const ruga_connectivity* c, int used, int count) {
    if (count < c->component_count || count < 1) {
        return ruga_fail(
            RUGA_BAD_INPUT,
            "coupling.count = %d is too small for kind spectral: the mesh has %d separate pieces, "
            "and each needs an eigenvector",
            count, c->component_count);
    }
    if (count > used / 2) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "coupling.count = %d is too large for kind spectral: at most half of the mesh's %d "
                         "vertices; lower it",
                         count, used);
    }
    return RUGA_OK;
}

static ruga_status compute(const ruga_mesh* mesh, const ruga_connectivity* c, spectrum* s) {
    ruga_status status = RUGA_OK;
    int* number = NULL;
    double* weight = NULL;
    RUGA_TRY_DONE(RUGA_NEW(number, c->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(weight, c->edge_count));
    RUGA_TRY_DONE(collect_vertices(mesh, c, s, number));
    RUGA_TRY_DONE(check_count(c, s->n, s->wanted));
    RUGA_TRY_DONE(ruga_laplacian_weights(mesh, c, weight));
    RUGA_TRY_DONE(RUGA_NEW(s->pair, s->wanted));
    RUGA_TRY_DONE(RUGA_NEW(s->psi, (size_t)s->wanted * (size_t)s->n));
    RUGA_TRY_DONE(factor(s, c, number, weight));
    add_constants(s, c);
    RUGA_TRY_DONE(find_all(s));
done:
    ruga_release(number);
    ruga_release(weight);
    return status;
}

ruga_status ruga_clusters_create_spectral(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                                          int count, ruga_clusters* clusters) {
    spectrum s = {.wanted = count, .components = connectivity->component_count};
    *clusters = (ruga_clusters){.vertex_count = mesh->vertex_count};
    pthread_mutex_lock(&arpack_lock);
    // The bits of a BLAS result depend on the number of its threads.
    int threads = openblas_get_num_threads();
    openblas_set_num_threads(1);
    cholmod_start(&s.common);
    s.common.print = 0;
    ruga_status status = compute(mesh, connectivity, &s);
    if (status == RUGA_OK) {
        status = write_rows(&s, clusters);
    }
    cholmod_free_factor(&s.factor, &s.common);
    cholmod_free_dense(&s.solution, &s.common);
    cholmod_free_dense(&s.work_y, &s.common);
    cholmod_free_dense(&s.work_e, &s.common);
    cholmod_finish(&s.common);
    openblas_set_num_threads(threads);
    pthread_mutex_unlock(&arpack_lock);
    ruga_release(s.vertex);
    ruga_release(s.root_mass);
    ruga_release(s.pair);
    ruga_release(s.psi);
    if (status != RUGA_OK) {
        ruga_clusters_clear(clusters);
    }
    return status;
}
