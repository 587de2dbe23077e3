// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/creases.h"

#include "app/console.h"
#include "core/memory.h"
#include "core/vec3.h"

#include <string.h>

void ruga_crease_table_clear(ruga_crease_table* table) {
    ruga_release(table->segment);
    ruga_release(table->crease);
    ruga_release(table->length);
    ruga_release(table->stiffness);
    ruga_release(table->assignment);
    ruga_release(table->name);
    *table = (ruga_crease_table){0};
}

static ruga_status fill(const ruga_creases* creases, ruga_crease_table* t) {
    int count = creases->segment_count, curves = creases->raster.curve_count;
    RUGA_TRY(RUGA_NEW(t->segment, count));
    RUGA_TRY(RUGA_NEW(t->crease, count));
    RUGA_TRY(RUGA_NEW(t->length, count));
    RUGA_TRY(RUGA_NEW(t->stiffness, count));
    RUGA_TRY(RUGA_NEW(t->assignment, count));
    RUGA_TRY(RUGA_NEW(t->name, curves));
    for (int h = 0; h < count; h++) {
        const ruga_segment* segment = &creases->cut.segment[creases->segment[h]];
        memcpy(t->segment[h], segment->end, sizeof t->segment[h]);
        t->crease[h] = segment->curve;
        t->length[h] = segment->length;
        t->stiffness[h] = creases->stiffness[h];
        t->assignment[h] = creases->law[ruga_crease_law_of(creases, h)].assignment;
    }
    for (int c = 0; c < curves; c++) {
        t->name[c] = creases->law[creases->raster.curve[c].label].name;
    }
    t->result = (ruga_result_creases){.segment_count = count,
                                      .segment = t->segment[0],
                                      .crease = t->crease,
                                      .length = t->length,
                                      .stiffness = t->stiffness,
                                      .assignment = t->assignment,
                                      .crease_count = curves,
                                      .name = t->name};
    return RUGA_OK;
}

ruga_status ruga_crease_table_create(const ruga_model* model, ruga_crease_table* table) {
    *table = (ruga_crease_table){0};
    ruga_status status = model->creases ? fill(model->creases, table) : RUGA_OK;
    if (status != RUGA_OK) {
        ruga_crease_table_clear(table);
    }
    return status;
}

// Of all curves that share a trouble, the first is named.
void ruga_warn_of_creases(const ruga_arguments* arguments, const ruga_model* model) {
    const ruga_raster* raster = model->creases ? &model->creases->raster : NULL;
    int none = 0, part = 0, first[2] = {-1, -1};
    for (int c = 0; raster && c < raster->curve_count; c++) {
        const ruga_curve_facts* f = &raster->facts[c];
        if (!(f->placed > 0)) {
            first[0] = none++ == 0 ? c : first[0];
        } else if (f->left > 1e-6 * f->length) {
            first[1] = part++ == 0 ? c : first[1];
        }
    }
    if (none > 0) {
        const ruga_curve_facts* f = &raster->facts[first[0]];
        ruga_warn(arguments, "%s: there is nothing of it in the sheet, as it %s (%d of these)",
                  model->creases->law[raster->curve[first[0]].label].name,
                  !(f->length > 0) ? "has no length"
                  : f->left > 0    ? "lies on other creases"
                                   : "lies on the border",
                  none);
    }
    if (part > 0) {
        ruga_warn(arguments,
                  "%s: %.3g mm of its %.3g mm lie on other creases, of which cuts and then the first count "
                  "(%d of these)",
                  model->creases->law[raster->curve[first[1]].label].name, 1e3 * raster->facts[first[1]].left,
                  1e3 * raster->facts[first[1]].length, part);
    }
}
