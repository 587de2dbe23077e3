// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Semi-nonnegative matrix factorisation (Ding, Li and Jordan 2010): frames D = [d_1 .. d_T], maps F and
// weights G >= 0 with |D - F G^T|^2 least. F = D C, so that all that is needed is A = D^T D:
//   C = G (G^T G)^-1,   each row g of G: min g^T M g - 2 b.g over g >= 0, M = C^T A C, b its row of A C,
// in turn, the second by cyclic descent on the coordinates. It starts from frames: the largest one, then
// always the one that the maps so far do worst.
#include "view/blend.h"

#include "core/memory.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 1000, SWEEPS = 200 };

typedef struct job {
    const double* product; // [T][T]
    ruga_blend* blend;
    int maps;         // so far
    double *ac, *m;   // [T][K], [K][K]
    double *gram, *t; // [K][K], [K]
} job;

static double* row(double* matrix, int i, int columns) {
    return matrix + (size_t)i * (size_t)columns;
}

static void multiply(job* j) {
    const int frames = j->blend->frames, k = j->blend->maps;
    for (int f = 0; f < frames; f++) {
        for (int a = 0; a < j->maps; a++) {
            double sum = 0;
            for (int g = 0; g < frames; g++) {
                sum += j->product[(size_t)f * (size_t)frames + (size_t)g] * row(j->blend->mixture, g, k)[a];
            }
            row(j->ac, f, k)[a] = sum;
        }
    }
    for (int a = 0; a < j->maps; a++) {
        for (int b = 0; b < j->maps; b++) {
            double sum = 0;
            for (int f = 0; f < frames; f++) {
                sum += row(j->blend->mixture, f, k)[a] * row(j->ac, f, k)[b];
            }
            row(j->m, a, k)[b] = sum;
        }
    }
}

static void fit_weights(job* j, int f) {
    const int k = j->blend->maps;
    double *g = row(j->blend->weight, f, k), *b = row(j->ac, f, k);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double change = 0, size = 0;
        for (int a = 0; a < j->maps; a++) {
            double slope = b[a], own = row(j->m, a, k)[a];
            for (int c = 0; c < j->maps; c++) {
                slope -= row(j->m, a, k)[c] * g[c];
            }
            double to = own > 0 ? fmax(0, g[a] + slope / own) : 0;
            change = fmax(change, fabs(to - g[a]));
            size = fmax(size, to);
            g[a] = to;
        }
        if (change <= 1e-14 * size) {
            break;
        }
    }
}

// Squared distance of a frame to its blend.
static double left_of(job* j, int f) {
    const int k = j->blend->maps;
    const double *g = row(j->blend->weight, f, k), *b = row(j->ac, f, k);
    double left = j->product[(size_t)f * (size_t)j->blend->frames + (size_t)f];
    for (int a = 0; a < j->maps; a++) {
        left -= 2 * g[a] * b[a];
        for (int c = 0; c < j->maps; c++) {
            left += g[a] * row(j->m, a, k)[c] * g[c];
        }
    }
    return fmax(0, left);
}

static double fit_all_weights(job* j) {
    double sum = 0;
    multiply(j);
    for (int f = 0; f < j->blend->frames; f++) {
        fit_weights(j, f);
        sum += left_of(j, f);
    }
    return sum;
}

static void choose_frames(job* j) {
    for (j->maps = 0; j->maps < j->blend->maps;) {
        int worst = 0;
        double most = -1;
        for (int f = 0; f < j->blend->frames; f++) {
            double left = left_of(j, f);
            if (left > most) {
                most = left;
                worst = f;
            }
        }
        row(j->blend->mixture, worst, j->blend->maps)[j->maps++] = 1;
        (void)fit_all_weights(j);
    }
}

// gram <- its Cholesky factor; a map that no frame uses, or that repeats others, is held by a little
// diagonal.
static void factor_gram(job* j) {
    const int k = j->blend->maps;
    double trace = 0;
    for (int a = 0; a < k; a++) {
        for (int b = 0; b < k; b++) {
            double sum = 0;
            for (int f = 0; f < j->blend->frames; f++) {
                sum += row(j->blend->weight, f, k)[a] * row(j->blend->weight, f, k)[b];
            }
            row(j->gram, a, k)[b] = sum;
        }
        trace += row(j->gram, a, k)[a];
    }
    for (int a = 0; a < k; a++) {
        row(j->gram, a, k)[a] += 1e-12 * trace + 1e-300;
        for (int b = 0; b <= a; b++) {
            double sum = row(j->gram, a, k)[b];
            for (int c = 0; c < b; c++) {
                sum -= row(j->gram, a, k)[c] * row(j->gram, b, k)[c];
            }
            row(j->gram, a, k)[b] = a == b ? sqrt(fmax(sum, 1e-300)) : sum / row(j->gram, b, k)[b];
        }
    }
}

static void fit_maps(job* j) {
    const int k = j->blend->maps;
    factor_gram(j);
    for (int f = 0; f < j->blend->frames; f++) {
        const double* g = row(j->blend->weight, f, k);
        double* c = row(j->blend->mixture, f, k);
        for (int a = 0; a < k; a++) {
            j->t[a] = g[a];
            for (int b = 0; b < a; b++) {
                j->t[a] -= row(j->gram, a, k)[b] * j->t[b];
            }
            j->t[a] /= row(j->gram, a, k)[a];
        }
        for (int a = k - 1; a >= 0; a--) {
            for (int b = a + 1; b < k; b++) {
                j->t[a] -= row(j->gram, b, k)[a] * c[b];
            }
            c[a] = j->t[a] / row(j->gram, a, k)[a];
        }
    }
}

static void finish(job* j) {
    ruga_blend* blend = j->blend;
    const int k = blend->maps;
    double largest = 0;
    for (int f = 0; f < blend->frames; f++) {
        largest = fmax(largest, j->product[(size_t)f * (size_t)blend->frames + (size_t)f]);
    }
    for (int f = 0; f < blend->frames; f++) {
        blend->error[f] = largest > 0 ? sqrt(left_of(j, f) / largest) : 0;
    }
    for (int a = 0; a < k; a++) {
        double top = 0;
        for (int f = 0; f < blend->frames; f++) {
            top = fmax(top, row(blend->weight, f, k)[a]);
        }
        for (int f = 0; top > 0 && f < blend->frames; f++) {
            row(blend->weight, f, k)[a] /= top;
            row(blend->mixture, f, k)[a] *= top;
        }
    }
}

static ruga_status factorise(job* j) {
    ruga_blend* blend = j->blend;
    size_t frames = (size_t)blend->frames, k = (size_t)blend->maps;
    RUGA_TRY(RUGA_NEW_ZERO(blend->mixture, frames * k));
    RUGA_TRY(RUGA_NEW_ZERO(blend->weight, frames * k));
    RUGA_TRY(RUGA_NEW_ZERO(blend->error, frames));
    RUGA_TRY(RUGA_NEW_ZERO(j->ac, frames * k));
    RUGA_TRY(RUGA_NEW_ZERO(j->m, k * k));
    RUGA_TRY(RUGA_NEW_ZERO(j->gram, k * k));
    RUGA_TRY(RUGA_NEW_ZERO(j->t, k));
    choose_frames(j);
    double left = fit_all_weights(j);
    for (int round = 0; round < ROUNDS; round++) {
        double before = left;
        fit_maps(j);
        left = fit_all_weights(j);
        if (!(left < (1 - 1e-7) * before)) {
            break;
        }
    }
    finish(j);
    return RUGA_OK;
}

ruga_status ruga_blend_create(int frames, const double* product, int maps, ruga_blend* blend) {
    RUGA_ASSERT(maps >= 1 && maps <= frames);
    *blend = (ruga_blend){.frames = frames, .maps = maps};
    job j = {.product = product, .blend = blend};
    ruga_status status = factorise(&j);
    ruga_release(j.ac);
    ruga_release(j.m);
    ruga_release(j.gram);
    ruga_release(j.t);
    if (status != RUGA_OK) {
        ruga_blend_clear(blend);
    }
    return status;
}

void ruga_blend_clear(ruga_blend* blend) {
    ruga_release(blend->mixture);
    ruga_release(blend->weight);
    ruga_release(blend->error);
    *blend = (ruga_blend){0};
}
