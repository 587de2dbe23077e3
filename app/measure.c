// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Wavelength and amplitude of wrinkles. w = (x - Bq).n with n the embedded surface's vertex normal, less its
// low-pass part: the averages of w over the calibrated clusters, blended by the clusters' own weights.
// Lengths, areas and gradients are those of the rest shape.
#include "app/measure.h"

#include "core/memory.h"
#include "core/vec3.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { STRIPS = 24, SAMPLES = 1024, BINS = 400 };

// A point of a strip: its triangle and barycentric coordinates.
typedef struct sample {
    int triangle; // -1 = outside
    double weight[3];
} sample;

struct ruga_measure {
    const ruga_mesh* mesh;
    ruga_connectivity connectivity;
    ruga_clusters clusters;
    double* blend;  // [V] sum of the clusters' weights at a vertex
    double* area;   // [V]
    double* normal; // [V][3]
    double* w;      // [V]
    double* low;    // [V]
    bool flat;      // a flat sheet: strips run along its longer side
    int along, across;
    double length;  // of a strip, the middle two thirds
    sample* strips; // [STRIPS][SAMPLES]
};

// ---- strips of a flat sheet ----------------------------------------------------------------------------

static bool find_axes(ruga_measure* m) {
    double min[3], max[3], size[3], largest = 0;
    ruga_mesh_bounds(m->mesh, min, max);
    int thin = 0;
    for (int i = 0; i < 3; i++) {
        size[i] = max[i] - min[i];
        thin = size[i] < size[thin] ? i : thin;
        largest = fmax(largest, size[i]);
    }
    int a = (thin + 1) % 3, b = (thin + 2) % 3;
    m->along = size[a] > size[b] ? a : b;
    m->across = m->along == a ? b : a;
    return size[thin] <= 1e-9 * largest && m->connectivity.edge_count > 0;
}

static void sample_triangle(ruga_measure* m, int f, const double origin[2], double step, double strip_gap) {
    const double* p[3];
    for (int k = 0; k < 3; k++) {
        p[k] = m->mesh->position + 3 * (size_t)m->mesh->triangle[3 * (size_t)f + (size_t)k];
    }
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    int axis[2] = {m->along, m->across};
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], p[k][axis[i]]);
            high[i] = fmax(high[i], p[k][axis[i]]);
        }
    }
    double u[2] = {p[1][axis[0]] - p[0][axis[0]], p[1][axis[1]] - p[0][axis[1]]};
    double v[2] = {p[2][axis[0]] - p[0][axis[0]], p[2][axis[1]] - p[0][axis[1]]};
    double area = u[0] * v[1] - u[1] * v[0];
    int s0 = (int)fmax(ceil((low[1] - origin[1]) / strip_gap), 0);
    int i0 = (int)fmax(ceil((low[0] - origin[0]) / step), 0);
    for (int s = s0; s < STRIPS && origin[1] + s * strip_gap <= high[1]; s++) {
        for (int i = i0; i < SAMPLES && origin[0] + i * step <= high[0]; i++) {
            double d[2] = {origin[0] + i * step - p[0][axis[0]], origin[1] + s * strip_gap - p[0][axis[1]]};
            double b = (d[0] * v[1] - d[1] * v[0]) / area, c = (u[0] * d[1] - u[1] * d[0]) / area;
            if (b >= -1e-9 && c >= -1e-9 && b + c <= 1 + 1e-9) {
                m->strips[s * SAMPLES + i] = (sample){f, {1 - b - c, b, c}};
            }
        }
    }
}

static ruga_status create_strips(ruga_measure* m) {
    double min[3], max[3];
    m->flat = find_axes(m);
    if (!m->flat) {
        return RUGA_OK;
    }
    RUGA_TRY(RUGA_NEW(m->strips, STRIPS * SAMPLES));
    for (int i = 0; i < STRIPS * SAMPLES; i++) {
        m->strips[i].triangle = -1;
    }
    ruga_mesh_bounds(m->mesh, min, max);
    double full = max[m->along] - min[m->along], width = max[m->across] - min[m->across];
    m->length = full * 2 / 3;
    double origin[2] = {min[m->along] + full / 6, min[m->across] + 0.5 * width / STRIPS};
    for (int f = 0; f < m->mesh->triangle_count; f++) {
        sample_triangle(m, f, origin, m->length / SAMPLES, width / STRIPS);
    }
    return RUGA_OK;
}

// Power at wave number k (1/m), summed over strips: mean taken out, Hann window.
static double strip_power(const ruga_measure* m, const double* values, double k) {
    double power = 0;
    for (int s = 0; s < STRIPS; s++) {
        double re = 0, im = 0;
        for (int i = 0; i < SAMPLES; i++) {
            double t = (i + 0.5) / SAMPLES, angle = 2 * RUGA_PI * k * t * m->length;
            double hann = 0.5 - 0.5 * cos(2 * RUGA_PI * t), v = hann * values[s * SAMPLES + i];
            re += v * cos(angle);
            im += v * sin(angle);
        }
        power += re * re + im * im;
    }
    return power;
}

static ruga_status strip_wavelength(const ruga_measure* m, double* wavelength) {
    ruga_status status = RUGA_OK;
    double *values = NULL, power[BINS], peak = 0, sum = 0, moment = 0;
    *wavelength = 0;
    RUGA_TRY(RUGA_NEW_ZERO(values, STRIPS * SAMPLES));
    for (int s = 0; s < STRIPS; s++) {
        double mean = 0;
        for (int i = 0; i < SAMPLES; i++) {
            const sample* p = &m->strips[s * SAMPLES + i];
            const int* t = m->mesh->triangle + 3 * (size_t)(p->triangle < 0 ? 0 : p->triangle);
            for (int k = 0; k < 3 && p->triangle >= 0; k++) {
                values[s * SAMPLES + i] += p->weight[k] * m->w[t[k]];
            }
            mean += values[s * SAMPLES + i] / SAMPLES;
        }
        for (int i = 0; i < SAMPLES; i++) {
            values[s * SAMPLES + i] -= mean;
        }
    }
    // Bins at half the window's own spacing, from one wave in it up.
    for (int b = 0; b < BINS; b++) {
        power[b] = strip_power(m, values, (2 + b) / (2 * m->length));
        peak = fmax(peak, power[b]);
    }
    for (int b = 0; b < BINS && peak > 0; b++) {
        if (power[b] > 0.05 * peak) {
            sum += power[b];
            moment += power[b] * (2 + b) / (2 * m->length);
        }
    }
    *wavelength = moment > 0 ? sum / moment : 0;
    ruga_release(values);
    return status;
}

// ---- life ----------------------------------------------------------------------------------------------

static ruga_status create_clusters(ruga_measure* m, double wavelength, const double* local, int64_t seed) {
    double radius, sigma, *scale = NULL;
    ruga_clusters_rule(RUGA_RULE_CALIBRATED, wavelength, &radius, &sigma);
    if (local) {
        RUGA_TRY(RUGA_NEW(scale, m->mesh->vertex_count));
        for (int v = 0; v < m->mesh->vertex_count; v++) {
            scale[v] = local[v] / wavelength;
        }
    }
    ruga_status status =
        ruga_clusters_create_local(m->mesh, &m->connectivity, radius, sigma, scale, 0, seed, &m->clusters);
    ruga_release(scale);
    RUGA_TRY(status);
    for (int k = 0; k < m->clusters.start[m->clusters.count]; k++) {
        m->blend[m->clusters.vertex[k]] += m->clusters.weight[k];
    }
    return RUGA_OK;
}

ruga_status ruga_measure_create(const ruga_mesh* mesh, double wavelength, int64_t seed, ruga_measure** out) {
    return ruga_measure_create_local(mesh, wavelength, NULL, seed, out);
}

ruga_status ruga_measure_create_local(const ruga_mesh* mesh, double wavelength, const double* local,
                                      int64_t seed, ruga_measure** out) {
    ruga_status status = RUGA_OK;
    ruga_measure* m = NULL;
    *out = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(m, 1));
    m->mesh = mesh;
    RUGA_TRY_DONE(ruga_connectivity_create(mesh, &m->connectivity));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(m->blend, mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(m->area, mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(m->normal, 3 * (size_t)mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(m->w, mesh->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(m->low, mesh->vertex_count));
    ruga_mesh_vertex_areas(mesh, m->area);
    if (wavelength > 0) {
        RUGA_TRY_DONE(create_clusters(m, wavelength, local, seed));
    }
    RUGA_TRY_DONE(create_strips(m));
done:
    if (status != RUGA_OK) {
        ruga_measure_destroy(&m);
    }
    *out = m;
    return status;
}

void ruga_measure_destroy(ruga_measure** measure) {
    ruga_measure* m = *measure;
    if (!m) {
        return;
    }
    ruga_connectivity_clear(&m->connectivity);
    ruga_clusters_clear(&m->clusters);
    void* const owned[] = {m->blend, m->area, m->normal, m->w, m->low, m->strips};
    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++) {
        ruga_release(owned[i]);
    }
    ruga_release(m);
    *measure = NULL;
}

// ---- a frame -------------------------------------------------------------------------------------------

static void take_out_low_pass(ruga_measure* m) {
    const ruga_clusters* c = &m->clusters;
    memset(m->low, 0, (size_t)m->mesh->vertex_count * sizeof *m->low);
    for (int r = 0; r < c->count; r++) {
        double average = 0;
        for (int k = c->start[r]; k < c->start[r + 1]; k++) {
            average += c->weight[k] * m->w[c->vertex[k]];
        }
        for (int k = c->start[r]; k < c->start[r + 1]; k++) {
            m->low[c->vertex[k]] += c->weight[k] * average;
        }
    }
    for (int v = 0; v < m->mesh->vertex_count && c->count; v++) {
        m->w[v] -= m->blend[v] > 0 ? m->low[v] / m->blend[v] : 0;
    }
}

// int |grad w|^2 of the linear interpolant on the rest shape.
static double dirichlet_energy(const ruga_measure* m) {
    double sum = 0;
    for (int f = 0; f < m->mesh->triangle_count; f++) {
        const int* t = m->mesh->triangle + 3 * (size_t)f;
        double n[3], g[3] = {0, 0, 0}, edge[3];
        ruga_mesh_triangle_normal(m->mesh, f, n);
        // |grad w| = |sum_i w_i e_i| / (2 A), e_i the edge opposite corner i.
        for (int i = 0; i < 3; i++) {
            ruga_subtract(m->mesh->position + 3 * (size_t)t[(i + 2) % 3],
                          m->mesh->position + 3 * (size_t)t[(i + 1) % 3], edge);
            ruga_add_scaled(m->w[t[i]], edge, g);
        }
        sum += 0.5 * ruga_dot(g, g) / fmax(ruga_norm(n), 1e-300);
    }
    return sum;
}

double ruga_measure_volume(const ruga_mesh* mesh, const ruga_connectivity* connectivity,
                           const double* position) {
    for (int e = 0; e < connectivity->edge_count; e++) {
        if (connectivity->edge_triangle[e][0] < 0 || connectivity->edge_triangle[e][1] < 0) {
            return NAN;
        }
    }
    ruga_mesh deformed = *mesh;
    deformed.position = (double*)(uintptr_t)position;
    return ruga_mesh_volume(&deformed);
}

ruga_status ruga_measure_frame(ruga_measure* m, const double* position, const double* embedded,
                               ruga_measured* measured) {
    double square = 0, area = 0;
    ruga_mesh_vertex_normals(m->mesh, embedded, m->normal);
    for (int v = 0; v < m->mesh->vertex_count; v++) {
        double d[3];
        ruga_subtract(position + 3 * (size_t)v, embedded + 3 * (size_t)v, d);
        m->w[v] = ruga_dot(d, m->normal + 3 * (size_t)v);
    }
    take_out_low_pass(m);
    for (int v = 0; v < m->mesh->vertex_count; v++) {
        square += m->area[v] * m->w[v] * m->w[v];
        area += m->area[v];
    }
    double gradient = dirichlet_energy(m);
    measured->amplitude = sqrt(2 * square / fmax(area, 1e-300));
    measured->wavelength = gradient > 0 ? 2 * RUGA_PI * sqrt(square / gradient) : 0;
    measured->wavelength_fft = 0;
    if (m->flat) {
        RUGA_TRY(strip_wavelength(m, &measured->wavelength_fft));
    }
    measured->volume = ruga_measure_volume(m->mesh, &m->connectivity, position);
    return RUGA_OK;
}

const double* ruga_measure_displacement(const ruga_measure* measure) {
    return measure->w;
}
