// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Evaluation, factorisation and projection of the skin's static problem; see skin.h.
//
// Held components keep their rows in the matrix (the pattern never changes): off-diagonals are zero and the
// diagonal is the mean stiffness, so that they take no part and do not disturb scaling or inertia.
#include "solver/skin.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/vec3.h"

#include <string.h>

double ruga_largest_move(int n, const double* d) {
    double largest = 0;
    for (int i = 0; i < n; i += 3) {
        double square = ruga_dot(d + i, d + i);
        largest = square > largest ? square : largest;
    }
    return sqrt(largest);
}

static bool held(const ruga_skin* skin, int i) {
    return skin->model->skin_handle[i] >= 0;
}

// ---- creation ------------------------------------------------------------------------------------------

// Rows of H that a vertex is in: the transpose of the clusters' rows.
typedef struct transpose {
    int* start;
    int* row;
    double* weight;
} transpose;

static void transpose_clear(transpose* t) {
    ruga_release(t->start);
    ruga_release(t->row);
    ruga_release(t->weight);
}

static ruga_status transpose_clusters(const ruga_clusters* clusters, int vertices, transpose* t) {
    RUGA_TRY(RUGA_NEW_ZERO(t->start, vertices + 2));
    int entries = clusters->count ? clusters->start[clusters->count] : 0;
    RUGA_TRY(RUGA_NEW(t->row, entries));
    RUGA_TRY(RUGA_NEW(t->weight, entries));
    for (int k = 0; k < entries; k++) {
        t->start[clusters->vertex[k] + 2]++;
    }
    for (int v = 0; v < vertices; v++) {
        t->start[v + 2] += t->start[v + 1];
    }
    for (int r = 0; r < clusters->count; r++) {
        for (int k = clusters->start[r]; k < clusters->start[r + 1]; k++) {
            int at = t->start[clusters->vertex[k] + 1]++;
            t->row[at] = r;
            t->weight[at] = clusters->weight[k];
        }
    }
    return RUGA_OK;
}

// What is held may leave rows of the sewing that say the same of the free nodes.
static ruga_status find_dependent_seams(ruga_skin* skin, int axis) {
    ruga_status status = RUGA_OK;
    const ruga_sewing* s = &skin->model->creases->sewing;
    bool* dependent = NULL;
    double *free = NULL, *value = NULL;
    ruga_seam_factor factor = {0};
    RUGA_TRY_DONE(RUGA_NEW(dependent, s->row_count));
    RUGA_TRY_DONE(RUGA_NEW(free, s->node_count));
    RUGA_TRY_DONE(RUGA_NEW(value, s->pattern.start[s->row_count]));
    for (int i = 0; i < s->node_count; i++) {
        free[i] = held(skin, 3 * i + axis) ? 0 : 1;
    }
    ruga_sewing_matrix(s, free, value);
    ruga_sparse matrix = s->pattern;
    matrix.value = value;
    RUGA_TRY_DONE(ruga_seam_factor_create(&matrix, 1e-12, dependent, &factor));
    for (int r = 0; r < s->row_count; r++) {
        bool* none = &skin->row_void[3 * (skin->model->seam + r) + axis];
        *none = *none || dependent[r];
    }
done:
    ruga_seam_factor_clear(&factor);
    ruga_release(dependent);
    ruga_release(free);
    ruga_release(value);
    return status;
}

// A row without a free component says nothing. Where the skin alone is held, away from the interior, a row with less
// than a quarter of its weight free (in the root of the sum of squares) would move these few by many times what it
// corrects. Both are left out; the multiplier gets a unit diagonal, negative so that the inertia stays (n, m, 0).
static ruga_status find_void_rows(ruga_skin* skin) {
    const ruga_clusters* c = &skin->model->clusters;
    RUGA_TRY(RUGA_NEW_ZERO(skin->row_void, skin->m));
    for (int r = 0; r < skin->m && skin->model->any_skin_held; r++) {
        double all = 0, free = 0;
        bool torn = false;
        for (int k = c->start[r / 3]; k < c->start[r / 3 + 1]; k++) {
            int i = 3 * c->vertex[k] + r % 3, handle = skin->model->skin_handle[i];
            double weight = c->weight[k] * c->weight[k];
            all += weight;
            free += handle < 0 ? weight : 0;
            torn = torn || (handle >= 0 && skin->model->handles[handle].hold == RUGA_HOLD_SKIN);
        }
        torn = torn && r < 3 * skin->model->seam;
        skin->row_void[r] = free <= (torn ? 0.0625 * all : 0);
    }
    for (int axis = 0; axis < 3 && skin->model->creases && skin->model->any_skin_held; axis++) {
        RUGA_TRY(find_dependent_seams(skin, axis));
    }
    return RUGA_OK;
}

void ruga_skin_clear_void_rows(const ruga_skin* skin, double* y) {
    for (int r = 0; r < skin->m && skin->model->any_skin_held; r++) {
        y[r] = skin->row_void[r] ? 0 : y[r];
    }
}

static int count_coupling(const ruga_skin* skin) {
    const ruga_directors* d = ruga_shell_directors(skin->shell);
    return d ? d->start[skin->n / 3] : 0;
}

// The directors' columns, and what they hold for good; returns where they end.
static int fill_director_columns(ruga_skin* skin, int out) {
    const ruga_directors* d = ruga_shell_directors(skin->shell);
    int first = skin->n + skin->m;
    for (int e = 0; e < skin->size - first; e++) {
        skin->kkt.start[first + e] = out;
        for (int p = d->matrix.start[e]; p < d->matrix.start[e + 1]; p++) {
            skin->kkt.index[out] = first + d->matrix.index[p];
            skin->kkt.value[out++] = d->matrix.value[p];
        }
    }
    return out;
}

static ruga_status create_kkt(ruga_skin* skin, const transpose* t) {
    const ruga_sparse* k = ruga_shell_pattern(skin->shell);
    const ruga_directors* d = ruga_shell_directors(skin->shell);
    int n = skin->n, m = skin->m;
    int64_t entries = (int64_t)k->start[n] + 3 * (int64_t)t->start[n / 3] + m + 3 * (int64_t)count_coupling(skin) +
                      (d ? d->matrix.start[d->hinge_count] : 0);
    if (entries > INT32_MAX) {
        return ruga_fail(RUGA_NO_MEMORY, "the skin's system has %lld entries, more than 2^31: use a coarser mesh",
                         (long long)entries);
    }
    ruga_sparse* kkt = &skin->kkt;
    kkt->rows = kkt->columns = skin->size;
    RUGA_TRY(RUGA_NEW(kkt->start, skin->size + 1));
    RUGA_TRY(RUGA_NEW(kkt->index, entries));
    RUGA_TRY(RUGA_NEW_ZERO(kkt->value, entries));
    RUGA_TRY(RUGA_NEW(skin->column_shift, n));
    int out = 0;
    for (int j = 0; j < n; j++) {
        kkt->start[j] = out;
        skin->column_shift[j] = out - k->start[j];
        for (int p = k->start[j]; p < k->start[j + 1]; p++) {
            kkt->index[out++] = k->index[p];
        }
        int v = j / 3, axis = j % 3;
        for (int p = t->start[v]; p < t->start[v + 1]; p++) {
            kkt->index[out] = n + 3 * t->row[p] + axis;
            bool out_of_play = held(skin, j) || skin->row_void[3 * t->row[p] + axis];
            kkt->value[out++] = out_of_play ? 0 : t->weight[p];
        }
        for (int p = d ? d->start[v] : 0; d && p < d->start[v + 1]; p++) {
            kkt->index[out++] = n + m + d->edge[p];
        }
    }
    for (int r = 0; r < m; r++) {
        kkt->start[n + r] = out;
        kkt->index[out] = n + r;
        kkt->value[out++] = skin->row_void[r] ? -1 : 0;
    }
    kkt->start[skin->size] = fill_director_columns(skin, out);
    return RUGA_OK;
}

ruga_status ruga_skin_create_factor(const ruga_skin* skin, ruga_factor** factor) {
    ruga_status status = RUGA_OK;
    int threes = (skin->n + skin->m) / 3, nodes = threes + skin->size - 3 * threes, *start = NULL;
    bool* last = NULL;
    RUGA_TRY_DONE(RUGA_NEW(start, nodes + 1));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(last, nodes));
    for (int i = 0; i <= nodes; i++) {
        start[i] = i < threes ? 3 * i : i + 2 * threes;
    }
    for (int i = skin->n / 3; i < threes; i++) {
        last[i] = true;
    }
    // Without clusters CHOLMOD would do as well; the LDL^T takes half of its time (solver/README.md).
    RUGA_TRY_DONE(ruga_factor_create(RUGA_FACTOR_LDL_SINGLE, &skin->kkt, nodes, start, skin->m ? last : NULL, factor));
done:
    ruga_release(start);
    ruga_release(last);
    return status;
}

static bool axes_are_held_alike(const ruga_model* model) {
    for (int v = 0; v < model->mesh.vertex_count; v++) {
        const int* h = model->skin_handle + 3 * (size_t)v;
        if ((h[0] >= 0) != (h[1] >= 0) || (h[0] >= 0) != (h[2] >= 0)) {
            return false;
        }
    }
    return true;
}

// Overlapping Gaussians make H H^T nearly singular. Where it has an eigenvalue below 1e-7 of its diagonal (clusters
// as many as vertices, or few free vertices between held ones) the rows are called near dependent.
static ruga_status factor_gram(ruga_skin* skin, ruga_sparse* gram, int axis) {
    ruga_factor_info info;
    for (int r = 0; r < gram->rows; r++) {
        gram->value[gram->start[r]] *= 1 - 1e-7;
    }
    RUGA_TRY(ruga_factor_numeric(skin->gram[axis], gram->value, &info));
    skin->near_dependent = skin->near_dependent || info.negative > 0 || info.zero > 0;
    for (int r = 0; r < gram->rows; r++) {
        gram->value[gram->start[r]] *= (1 + (skin->near_dependent ? 1e-9 : 1e-12)) / (1 - 1e-7);
    }
    return ruga_factor_numeric(skin->gram[axis], gram->value, &info);
}

static ruga_status create_gram(ruga_skin* skin, const transpose* t, int axis) {
    ruga_status status = RUGA_OK;
    int vertices = skin->n / 3;
    int64_t pairs = 0, count = 0;
    int(*pair)[2] = NULL;
    ruga_sparse gram = {0};
    for (int v = 0; v < vertices; v++) {
        int64_t rows = t->start[v + 1] - t->start[v];
        pairs += rows * (rows - 1) / 2;
    }
    RUGA_TRY_DONE(RUGA_NEW(pair, pairs));
    for (int v = 0; v < vertices; v++) {
        for (int p = t->start[v]; p < t->start[v + 1]; p++) {
            for (int q = t->start[v]; q < p; q++) {
                pair[count][0] = t->row[p];
                pair[count++][1] = t->row[q];
            }
        }
    }
    RUGA_TRY_DONE(ruga_sparse_from_pairs(skin->m / 3, 1, count, (const int(*)[2])pair, &gram));
    for (int v = 0; v < vertices; v++) {
        for (int p = t->start[v]; p < t->start[v + 1] && !held(skin, 3 * v + axis); p++) {
            for (int q = t->start[v]; q <= p; q++) {
                if (!skin->row_void[3 * t->row[p] + axis] && !skin->row_void[3 * t->row[q] + axis]) {
                    gram.value[ruga_sparse_find(&gram, t->row[p], t->row[q])] += t->weight[p] * t->weight[q];
                }
            }
        }
    }
    for (int r = 0; r < skin->m / 3; r++) {
        double* diagonal = gram.value + gram.start[r];
        *diagonal = *diagonal > 0 ? *diagonal : 1;
    }
    RUGA_TRY_DONE(ruga_factor_create(RUGA_FACTOR_LDL, &gram, gram.rows, NULL, NULL, &skin->gram[axis]));
    RUGA_TRY_DONE(factor_gram(skin, &gram, axis));
done:
    ruga_release(pair);
    ruga_sparse_clear(&gram);
    return status;
}

static ruga_status create_grams(ruga_skin* skin, const transpose* t) {
    int axes = axes_are_held_alike(skin->model) ? 1 : 3;
    for (int axis = 0; axis < axes && skin->m; axis++) {
        RUGA_TRY(create_gram(skin, t, axis));
    }
    return RUGA_OK;
}

static ruga_status create_vectors(ruga_skin* skin) {
    int n = skin->n, m = skin->m;
    RUGA_TRY(RUGA_NEW_ZERO(skin->stiffness, ruga_shell_pattern(skin->shell)->start[n]));
    RUGA_TRY(RUGA_NEW_ZERO(skin->target, n));
    RUGA_TRY(RUGA_NEW_ZERO(skin->displacement, n));
    RUGA_TRY(RUGA_NEW_ZERO(skin->right, skin->size));
    RUGA_TRY(RUGA_NEW_ZERO(skin->left, skin->size));
    if (ruga_shell_directors(skin->shell)) {
        RUGA_TRY(RUGA_NEW_ZERO(skin->coupling, count_coupling(skin)));
    }
    RUGA_TRY(RUGA_NEW_ZERO(skin->multiplier, m));
    RUGA_TRY(RUGA_NEW_ZERO(skin->trial, n));
    RUGA_TRY(RUGA_NEW_ZERO(skin->trial_gradient, n));
    RUGA_TRY(RUGA_NEW(skin->memory, (size_t)RUGA_SKIN_WORK_VECTORS * (size_t)skin->size));
    RUGA_TRY(RUGA_NEW_ZERO(skin->mass, n / 3));
    ruga_shell_vertex_mass(skin->shell, skin->mass);
    return RUGA_OK;
}

static ruga_status create_shell(ruga_skin* skin) {
    const ruga_model* model = skin->model;
    bool* held_triangle = NULL;
    RUGA_TRY(RUGA_NEW(held_triangle, model->mesh.triangle_count));
    for (int f = 0; f < model->mesh.triangle_count; f++) {
        held_triangle[f] = true;
        for (int i = 0; i < 9; i++) {
            held_triangle[f] = held_triangle[f] && held(skin, 3 * model->mesh.triangle[3 * f + i / 3] + i % 3);
        }
    }
    ruga_shell_material material = {.skin = model->skin,
                                    .thickness = model->variation.triangle_thickness,
                                    .young = model->variation.triangle_young,
                                    .growth = model->variation.triangle_growth,
                                    .held = held_triangle};
    ruga_shell_cut cut;
    if (model->creases) {
        cut = ruga_creases_shell(model->creases);
        material.cut = &cut;
    }
    ruga_status status = ruga_shell_create(&model->mesh, &model->connectivity, &material, &skin->shell);
    ruga_release(held_triangle);
    return status;
}

ruga_status ruga_skin_create(const ruga_model* model, ruga_skin** out) {
    ruga_status status = RUGA_OK;
    ruga_skin* skin = NULL;
    transpose t = {0};
    *out = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(skin, 1));
    skin->model = model;
    skin->n = 3 * model->mesh.vertex_count;
    skin->m = 3 * model->clusters.count;
    RUGA_TRY_DONE(create_shell(skin));
    if (model->creases) {
        RUGA_TRY_DONE(ruga_hinges_create(model->creases, ruga_shell_pattern(skin->shell), &skin->hinges));
    }
    const ruga_directors* directors = ruga_shell_directors(skin->shell);
    skin->size = skin->n + skin->m + (directors ? directors->hinge_count : 0);
    RUGA_TRY_DONE(transpose_clusters(&model->clusters, skin->n / 3, &t));
    RUGA_TRY_DONE(create_vectors(skin));
    if (model->solves_skin) {
        RUGA_TRY_DONE(find_void_rows(skin));
        RUGA_TRY_DONE(create_kkt(skin, &t));
        RUGA_TRY_DONE(ruga_skin_create_factor(skin, &skin->factor));
        RUGA_TRY_DONE(create_grams(skin, &t));
    }
    if (model->foundation.vertex_count) {
        RUGA_TRY_DONE(ruga_foundation_map(&model->foundation, ruga_shell_pattern(skin->shell),
                                          &skin->foundation_slot));
    }
done:
    transpose_clear(&t);
    if (status != RUGA_OK) {
        ruga_skin_destroy(&skin);
    }
    *out = skin;
    return status;
}

void ruga_skin_destroy(ruga_skin** skin_pointer) {
    ruga_skin* skin = *skin_pointer;
    if (!skin) {
        return;
    }
    ruga_shell_destroy(&skin->shell);
    ruga_hinges_destroy(&skin->hinges);
    ruga_sparse_clear(&skin->kkt);
    ruga_factor_destroy(&skin->factor);
    for (int axis = 0; axis < 3; axis++) {
        ruga_factor_destroy(&skin->gram[axis]);
    }
    void* const owned[] = {skin->row_void,     skin->column_shift, skin->foundation_slot, skin->stiffness,
                           skin->target,       skin->displacement,    skin->right,
                           skin->left,         skin->multiplier,      skin->trial,
                           skin->trial_gradient, skin->memory,        skin->mass,           skin->coupling};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    ruga_release(skin);
    *skin_pointer = NULL;
}

// ---- energy --------------------------------------------------------------------------------------------

static double add_weight(const ruga_skin* skin, const double* x, double* gradient, double* force_square) {
    const double* g = skin->model->gravity;
    double energy = 0;
    for (int v = 0; v < skin->n / 3; v++) {
        double mass = skin->mass[v];
        energy -= mass * ruga_dot(g, x + 3 * (size_t)v);
        *force_square += mass * mass * ruga_dot(g, g);
        if (gradient) {
            ruga_add_scaled(-mass, g, gradient + 3 * (size_t)v);
        }
    }
    return energy;
}

enum { PROXIMAL_CHUNKS = 16 };
typedef struct proximal {
    const ruga_skin* skin;
    const double* x;
    double *gradient, energy[PROXIMAL_CHUNKS];
} proximal;

static void add_proximal_of(int begin, int end, int chunk, void* context) {
    proximal* p = context;
    const ruga_skin* skin = p->skin;
    double energy = 0;
    for (int i = 3 * begin; i < 3 * end; i++) {
        double s = skin->proximal * skin->model->vertex_area[i / 3], d = p->x[i] - skin->anchor[i];
        energy += 0.5 * s * d * d;
        if (p->gradient) {
            p->gradient[i] += s * d;
        }
    }
    p->energy[chunk] = energy;
}

static double add_proximal(const ruga_skin* skin, const double* x, double* gradient) {
    proximal p = {.skin = skin, .x = x, .gradient = gradient};
    int vertices = skin->n / 3, size = ruga_chunk_count(vertices, PROXIMAL_CHUNKS);
    double energy = 0;
    size = size > 1024 ? size : 1024;
    ruga_parallel_for(vertices, size, add_proximal_of, &p);
    for (int c = 0; c < ruga_chunk_count(vertices, size); c++) {
        energy += p.energy[c];
    }
    return energy;
}

ruga_status ruga_skin_energy(ruga_skin* skin, const double* x, ruga_skin_terms* terms, double* gradient) {
    double begin = ruga_clock();
    const ruga_model* model = skin->model;
    ruga_shell_energies shell;
    RUGA_TRY(ruga_shell_energy(skin->shell, x, 0, &shell, gradient, NULL));
    *terms = (ruga_skin_terms){.membrane = shell.membrane, .bending = shell.bending};
    double force_square = shell.force_square, part = 0;
    if (skin->hinges) {
        ruga_hinges_evaluate(skin->hinges, x, &terms->hinge, &part, gradient, &force_square);
        terms->bending += part;
    }
    if (model->foundation.vertex_count) {
        const double minus_one = -1, *embedded = skin->embedded;
        ruga_add_vectors(skin->n, 1, &embedded, &minus_one, 1, x, skin->displacement);
        terms->foundation = ruga_foundation_energy(&model->foundation, skin->displacement, gradient, &part);
        force_square += part;
    }
    RUGA_TRY(ruga_loads_energy(model->loads, x, skin->time, &terms->external, gradient, NULL, NULL,
                               &force_square));
    if (ruga_dot(model->gravity, model->gravity) > 0) {
        terms->external += add_weight(skin, x, gradient, &force_square);
    }
    double proximal = skin->proximal > 0 ? add_proximal(skin, x, gradient) : 0;
    terms->total = terms->membrane + terms->bending + terms->foundation + terms->external + proximal;
    terms->total += terms->hinge;
    terms->force_reference = fmax(sqrt(force_square), ruga_model_force_floor(model));
    skin->work.energies++;
    skin->work.seconds_energy += ruga_clock() - begin;
    return RUGA_OK;
}

void ruga_skin_follow(ruga_skin* skin, const double* x) {
    if (skin->hinges) {
        ruga_hinges_follow(skin->hinges, x);
    }
}

ruga_status ruga_skin_handle_forces(ruga_skin* skin, const double* x, double* force) {
    const ruga_model* model = skin->model;
    ruga_skin_terms terms;
    double *gradient = skin->trial_gradient, *projected = skin->trial;
    memset(force, 0, 3 * (size_t)model->handle_count * sizeof *force);
    if (!model->any_skin_held || !model->solves_skin) {
        return RUGA_OK;
    }
    RUGA_TRY(ruga_skin_energy(skin, x, &terms, gradient));
    RUGA_TRY(ruga_skin_project(skin, gradient, projected)); // for the multiplier
    if (skin->m > 0) {
        ruga_clusters_apply_transpose(&model->clusters, skin->multiplier, gradient);
    }
    for (int i = 0; i < skin->n; i++) {
        int h = model->skin_handle[i];
        if (h >= 0 && h < model->handle_count) {
            force[3 * h + i % 3] += gradient[i];
        }
    }
    return RUGA_OK;
}

// ---- matrix --------------------------------------------------------------------------------------------

static void fill_kkt(ruga_skin* skin, double shift) {
    const ruga_sparse* k = ruga_shell_pattern(skin->shell);
    const ruga_directors* d = ruga_shell_directors(skin->shell);
    const bool any_held = skin->model->any_skin_held;
    double mean = 0;
    for (int j = 0; j < skin->n; j++) {
        mean += fabs(skin->stiffness[k->start[j]]) / skin->n;
    }
    // Dependent rows leave their multipliers open: a compliance of 1e-9 of the skin's own closes them, and
    // ruga_skin_restore takes out what it lets through.
    for (int r = skin->n; r < skin->n + skin->m && skin->near_dependent; r++) {
        double* diagonal = skin->kkt.value + skin->kkt.start[r];
        *diagonal = skin->row_void[r - skin->n] ? -1 : -1e-9 / mean;
    }
    for (int j = 0; j < skin->n; j++) {
        double* column = skin->kkt.value + k->start[j] + skin->column_shift[j];
        int count = k->start[j + 1] - k->start[j];
        const double* source = skin->stiffness + k->start[j];
        memcpy(column, source, (size_t)count * sizeof *column);
        column[0] += shift * skin->model->vertex_area[j / 3];
        int edges = d ? d->start[j / 3 + 1] - d->start[j / 3] : 0;
        double* coupled = skin->kkt.value + skin->kkt.start[j + 1] - edges;
        for (int p = 0; p < edges; p++) {
            coupled[p] = held(skin, j) ? 0 : skin->coupling[d->start[j / 3] + p][j % 3];
        }
        if (!any_held) {
            continue;
        }
        for (int p = 0; p < count; p++) {
            if (held(skin, j) || held(skin, k->index[k->start[j] + p])) {
                column[p] = p == 0 ? mean : 0;
            }
        }
    }
}

static ruga_status factorize(ruga_skin* skin, double shift, bool in_single) {
    double begin = ruga_clock();
    fill_kkt(skin, shift);
    double filled = ruga_clock();
    RUGA_TRY(in_single ? ruga_factor_numeric_single(skin->factor, skin->kkt.value, &skin->info)
                       : ruga_factor_numeric(skin->factor, skin->kkt.value, &skin->info));
    skin->in_single = in_single;
    skin->factor_right = skin->info.negative == skin->m && skin->info.zero == 0;
    skin->work.factorizations++;
    skin->work.failures += !skin->factor_right;
    skin->work.seconds_assembly += filled - begin;
    skin->work.seconds_factor += ruga_clock() - filled;
    return RUGA_OK;
}

static ruga_status assemble_stiffness(ruga_skin* skin, const double* x, double clamp) {
    double begin = ruga_clock();
    const ruga_model* model = skin->model;
    const ruga_sparse* pattern = ruga_shell_pattern(skin->shell);
    double external = 0;
    RUGA_TRY(ruga_shell_energy(skin->shell, x, clamp, NULL, NULL, skin->stiffness));
    if (skin->coupling) {
        ruga_shell_coupling(skin->shell, skin->coupling);
    }
    if (skin->hinges) {
        ruga_hinges_add_hessian(skin->hinges, x, clamp, skin->stiffness);
    }
    if (model->foundation.vertex_count) {
        ruga_foundation_add_hessian(&model->foundation, skin->foundation_slot, skin->stiffness);
    }
    RUGA_TRY(ruga_loads_energy(model->loads, x, skin->time, &external, NULL, pattern, skin->stiffness, NULL));
    for (int j = 0; j < skin->n && skin->proximal > 0; j++) {
        skin->stiffness[pattern->start[j]] += skin->proximal * model->vertex_area[j / 3];
    }
    skin->work.seconds_assembly += ruga_clock() - begin;
    return RUGA_OK;
}

ruga_status ruga_skin_assemble(ruga_skin* skin, const double* x, double clamp) {
    RUGA_TRY(assemble_stiffness(skin, x, clamp));
    if (skin->model->solves_skin) {
        fill_kkt(skin, 0);
    }
    return RUGA_OK;
}

// In single precision where that proves the inertia, in half of the time, else in double.
static ruga_status factorize_surely(ruga_skin* skin, double shift) {
    if (skin->single_proves) {
        RUGA_TRY(factorize(skin, shift, true));
        double begin = ruga_clock();
        skin->single_proves = skin->info.zero == 0;
        if (skin->single_proves) {
            RUGA_TRY(ruga_factor_prove_inertia(skin->factor, &skin->single_proves));
        }
        skin->work.seconds_factor += ruga_clock() - begin;
    }
    return skin->single_proves ? RUGA_OK : factorize(skin, shift, false);
}

ruga_status ruga_skin_factor(ruga_skin* skin, const double* x, double clamp, double shift) {
    RUGA_TRY(assemble_stiffness(skin, x, clamp));
    RUGA_TRY(factorize_surely(skin, shift));
    skin->factor_exact = clamp == 0 && shift == 0;
    return RUGA_OK;
}

ruga_status ruga_skin_refactor(ruga_skin* skin, double shift) {
    skin->factor_exact = skin->factor_exact && shift == 0;
    return factorize_surely(skin, shift);
}

// Without a shift and a proof: an initial inverse.
static ruga_status factor_single(ruga_skin* skin, const double* x, double clamp) {
    RUGA_TRY(assemble_stiffness(skin, x, clamp));
    RUGA_TRY(factorize(skin, 0, true));
    skin->single_serves = skin->single_serves && skin->info.zero == 0;
    skin->factor_exact = false;
    return RUGA_OK;
}

double ruga_skin_shift_unit(const ruga_model* model) {
    if (model->foundation_a > 0) {
        return model->foundation_a;
    }
    double h = model->skin.thickness, k = 2 * RUGA_PI / (10 * model->mean_edge);
    return model->skin.young * h * h * h / 12 * k * k * k * k;
}

ruga_status ruga_skin_factor_convex(ruga_skin* skin, const double* x) {
    static const double clamp[2] = {0.5, 1};
    skin->factor_right = false;
    for (int k = 0; k < 2 && skin->single_serves && !skin->factor_right; k++) {
        RUGA_TRY(factor_single(skin, x, clamp[k]));
    }
    skin->single_serves = skin->factor_right;
    for (int k = 0; k < 2 && !skin->factor_right; k++) {
        RUGA_TRY(ruga_skin_factor(skin, x, clamp[k], 0));
    }
    for (double shift = 1e-3 * ruga_skin_shift_unit(skin->model); !skin->factor_right && shift < 1e30; shift *= 10) {
        RUGA_TRY(ruga_skin_refactor(skin, shift));
    }
    return skin->factor_right ? RUGA_OK
                              : ruga_fail(RUGA_LIBRARY, "the skin's matrix could not be made positive definite");
}

ruga_status ruga_skin_shift_until_right(ruga_skin* skin) {
    double shift = skin->shift_memory > 0 ? 0.25 * skin->shift_memory
                                          : 0.02 * ruga_skin_shift_unit(skin->model);
    for (; shift < 1e30; shift *= 4) {
        RUGA_TRY(ruga_skin_refactor(skin, shift));
        if (skin->factor_right) {
            skin->shift_memory = shift;
            return RUGA_OK;
        }
    }
    return ruga_fail(RUGA_LIBRARY, "the skin's matrix could not be made positive definite");
}

ruga_status ruga_skin_solve_system(ruga_skin* skin, const double* right, double* left) {
    double begin = ruga_clock();
    RUGA_TRY(ruga_factor_solve(skin->factor, right, left));
    skin->work.seconds_solve += ruga_clock() - begin;
    skin->work.linear_iterations++;
    return RUGA_OK;
}

ruga_status ruga_skin_solve(ruga_skin* skin, const double* r, double* d) {
    for (int i = 0; i < skin->n; i++) {
        skin->right[i] = held(skin, i) ? 0 : r[i];
    }
    memset(skin->right + skin->n, 0, (size_t)skin->m * sizeof *skin->right);
    RUGA_TRY(ruga_skin_solve_system(skin, skin->right, skin->left));
    memcpy(d, skin->left, (size_t)skin->n * sizeof *d);
    return RUGA_OK;
}

ruga_status ruga_skin_solve_rough(ruga_skin* skin, const double* r, double* d) {
    double begin = ruga_clock();
    memcpy(skin->right, r, (size_t)skin->n * sizeof *r);
    memset(skin->right + skin->n, 0, (size_t)skin->m * sizeof *skin->right);
    RUGA_TRY(ruga_factor_solve_rough(skin->factor, skin->right, skin->left));
    skin->work.seconds_solve += ruga_clock() - begin;
    skin->work.linear_iterations++;
    return ruga_skin_project(skin, skin->left, d);
}

void ruga_skin_apply(const ruga_skin* skin, const double* v, double* y) {
    ruga_sparse k = *ruga_shell_pattern(skin->shell);
    k.value = skin->stiffness;
    ruga_sparse_multiply_symmetric(&k, v, y);
    if (skin->coupling) {
        ruga_shell_relax(skin->shell, (const double(*)[3])skin->coupling, v, y);
    }
}

void ruga_skin_multiply(const ruga_skin* skin, const double* v, double* y) {
    ruga_skin_apply(skin, v, y);
    for (int i = 0; i < skin->n && skin->model->any_skin_held; i++) {
        y[i] = held(skin, i) ? 0 : y[i];
    }
}

// ---- constraints ---------------------------------------------------------------------------------------

// multiplier = (H H^T)^-1 y over the free components, y [m] component by component.
static ruga_status solve_gram(ruga_skin* skin, const double* y, double* multiplier) {
    int rows = skin->m / 3;
    for (int axis = 0; axis < 3; axis++) {
        ruga_factor* gram = skin->gram[axis] ? skin->gram[axis] : skin->gram[0];
        double* one = skin->right;
        for (int r = 0; r < rows; r++) {
            one[r] = y[3 * r + axis];
        }
        RUGA_TRY(ruga_factor_solve(gram, one, one));
        for (int r = 0; r < rows; r++) {
            multiplier[3 * r + axis] = one[r];
        }
    }
    return RUGA_OK;
}

static void zero_held(const ruga_skin* skin, double* v) {
    for (int i = 0; i < skin->n && skin->model->any_skin_held; i++) {
        v[i] = held(skin, i) ? 0 : v[i];
    }
}

ruga_status ruga_skin_project(ruga_skin* skin, const double* gradient, double* out) {
    if (out != gradient) {
        memcpy(out, gradient, (size_t)skin->n * sizeof *out);
    }
    zero_held(skin, out);
    if (skin->m == 0) {
        return RUGA_OK;
    }
    double* y = skin->left;
    ruga_clusters_apply(&skin->model->clusters, out, y);
    ruga_skin_clear_void_rows(skin, y);
    RUGA_TRY(solve_gram(skin, y, skin->multiplier));
    for (int r = 0; r < skin->m; r++) {
        skin->multiplier[r] = -skin->multiplier[r];
    }
    ruga_clusters_apply_transpose(&skin->model->clusters, skin->multiplier, out);
    zero_held(skin, out);
    return RUGA_OK;
}

double ruga_skin_constraint_residual(ruga_skin* skin, const double* x) {
    if (skin->m == 0) {
        return 0;
    }
    double *hx = skin->left, *hb = skin->right;
    ruga_clusters_apply(&skin->model->clusters, x, hx);
    ruga_clusters_apply(&skin->model->clusters, skin->embedded, hb);
    double scale = sqrt(ruga_dot_product(skin->m, hb, hb));
    if (skin->model->seam == 0) { // nothing but gaps, which should be nothing: against an edge
        scale = skin->model->mean_edge;
    }
    for (int r = 0; r < skin->m; r++) {
        hx[r] -= hb[r];
    }
    ruga_skin_clear_void_rows(skin, hx);
    return sqrt(ruga_dot_product(skin->m, hx, hx)) / fmax(scale, 1e-300);
}

ruga_status ruga_skin_restore(ruga_skin* skin, double* x) {
    for (int i = 0; i < skin->n && skin->model->any_skin_held; i++) {
        x[i] = held(skin, i) ? skin->target[i] : x[i];
    }
    if (skin->m == 0) {
        return RUGA_OK;
    }
    double *y = skin->left, *move = skin->trial;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < skin->n; i++) {
            skin->displacement[i] = skin->embedded[i] - x[i];
        }
        ruga_clusters_apply(&skin->model->clusters, skin->displacement, y);
        ruga_skin_clear_void_rows(skin, y);
        RUGA_TRY(solve_gram(skin, y, y));
        memset(move, 0, (size_t)skin->n * sizeof *move);
        ruga_clusters_apply_transpose(&skin->model->clusters, y, move);
        zero_held(skin, move);
        for (int i = 0; i < skin->n; i++) {
            x[i] += move[i];
        }
    }
    return RUGA_OK;
}
