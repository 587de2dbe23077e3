// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/creases.h"

#include "core/memory.h"

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
