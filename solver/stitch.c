// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Patkar, Jin and Fedkiw 2015, section 4, after Weinstein, Teran and Fedkiw 2006. In a step
//   v += dt f / m;  v += M^-1 W S^-1 (-W^T v - W^T x / dt)   (equation 5, before)
//   x += dt v;      v += M^-1 W S^-1 (-W^T v)                (equation 3, after)
// The first alone keeps positions together, since W is constant; the second takes out the velocity with which
// a gap was closed. Impulses act in pairs at one place, so that both conserve momentum, and angular momentum
// where there is no gap: sum_ij (S^-1)_ij r_i x r_j = 0. Rows are the same for x, y and z: three solves with
// one factor.
//
// Not for statics: projecting after an unconstrained Newton step ends in the point that is nearest in the
// metric of masses, which is not an equilibrium (equations 9 and 10 of the paper do that). There the rows
// belong in the system.
#include "solver/stitch.h"

#include "core/memory.h"

#include <string.h>

static const double NOT_DEFINITE = 1e-13; // a pivot below this part of the diagonal

struct ruga_stitch {
    const ruga_sewing* sewing;
    double* inverse_mass; // [nodes]
    ruga_seam_factor factor;
    double (*gap)[3];   // [rows]
    double (*other)[3]; // [rows]
};

void ruga_stitch_destroy(ruga_stitch** stitch) {
    if (!*stitch) {
        return;
    }
    ruga_release((*stitch)->inverse_mass);
    ruga_seam_factor_clear(&(*stitch)->factor);
    ruga_release((*stitch)->gap);
    ruga_release((*stitch)->other);
    ruga_release(*stitch);
    *stitch = NULL;
}

static ruga_status factorise(ruga_stitch* s) {
    const ruga_sparse* pattern = &s->sewing->pattern;
    ruga_sparse matrix = *pattern;
    bool* dependent = NULL;
    ruga_status status = RUGA_OK;
    matrix.value = NULL;
    RUGA_TRY_DONE(RUGA_NEW(matrix.value, pattern->start[pattern->columns]));
    RUGA_TRY_DONE(RUGA_NEW(dependent, s->sewing->row_count));
    ruga_sewing_matrix(s->sewing, s->inverse_mass, matrix.value);
    RUGA_TRY_DONE(ruga_seam_factor_create(&matrix, NOT_DEFINITE, dependent, &s->factor));
    for (int r = 0; r < s->sewing->row_count; r++) {
        if (dependent[r]) {
            status =
                ruga_fail(RUGA_BAD_INPUT,
                          "the seams of the creases hold one another twice: row %d of %d depends on others",
                          r, s->sewing->row_count);
            goto done;
        }
    }
done:
    ruga_release(matrix.value);
    ruga_release(dependent);
    return status;
}

ruga_status ruga_stitch_create(const ruga_sewing* sewing, const double* inverse_mass, ruga_stitch** stitch) {
    ruga_status status = RUGA_OK;
    ruga_stitch* s = NULL;
    *stitch = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(s, 1));
    s->sewing = sewing;
    RUGA_TRY_DONE(RUGA_NEW(s->inverse_mass, sewing->node_count));
    memcpy(s->inverse_mass, inverse_mass, (size_t)sewing->node_count * sizeof *inverse_mass);
    RUGA_TRY_DONE(RUGA_NEW(s->gap, sewing->row_count));
    RUGA_TRY_DONE(RUGA_NEW(s->other, sewing->row_count));
    if (sewing->row_count > 0) {
        RUGA_TRY_DONE(factorise(s));
    }
    *stitch = s;
done:
    if (status != RUGA_OK) {
        ruga_stitch_destroy(&s);
    }
    return status;
}

// y -= M^-1 W S^-1 gap
static ruga_status project(ruga_stitch* s, double* y) {
    ruga_seam_factor_solve(&s->factor, s->gap);
    ruga_sewing_spread(s->sewing, s->inverse_mass, -1, &s->gap[0][0], y);
    return RUGA_OK;
}

ruga_status ruga_stitch_before(ruga_stitch* s, const double* x, double step, double* v) {
    ruga_sewing_gaps(s->sewing, v, &s->gap[0][0]);
    ruga_sewing_gaps(s->sewing, x, &s->other[0][0]);
    for (int k = 0; k < 3 * s->sewing->row_count; k++) {
        s->gap[k / 3][k % 3] += s->other[k / 3][k % 3] / step;
    }
    return project(s, v);
}

ruga_status ruga_stitch_after(ruga_stitch* s, double* v) {
    ruga_sewing_gaps(s->sewing, v, &s->gap[0][0]);
    return project(s, v);
}

ruga_status ruga_stitch_close(ruga_stitch* s, double* x) {
    ruga_sewing_gaps(s->sewing, x, &s->gap[0][0]);
    return project(s, x);
}
