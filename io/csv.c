// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Fields are separated by commas; one in quotes may hold commas and, doubled, quotes (RFC 4180), but no
// line's end.
#include "io/csv.h"

#include "core/memory.h"
#include "io/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIELD_MAX = 256, COLUMNS_MAX = 1000 };

// The next field of the line, without its quotes and the blanks around it; false where it does not end.
static bool take_field(const char** at, const char* end, char field[FIELD_MAX]) {
    int length = 0;
    bool quoted = false;
    const char* c = *at;
    while (c < end && (*c == ' ' || *c == '\t')) {
        c++;
    }
    if (c < end && *c == '"') {
        quoted = true;
        c++;
    }
    for (; c < end && (quoted || *c != ','); c++) {
        if (quoted && *c == '"') {
            if (c + 1 < end && c[1] == '"') {
                c++;
            } else {
                quoted = false;
                continue;
            }
        }
        if (length + 1 < FIELD_MAX) {
            field[length++] = *c;
        }
    }
    while (length > 0 &&
           (field[length - 1] == ' ' || field[length - 1] == '\t' || field[length - 1] == '\r')) {
        length--;
    }
    field[length] = '\0';
    *at = c;
    return !quoted;
}

static ruga_status add_column(ruga_csv* csv, const char* name) {
    csv->name[csv->column_count] = ruga_copy_string(name);
    return csv->name[csv->column_count++] ? RUGA_OK
                                          : ruga_fail(RUGA_NO_MEMORY, "out of memory: a table's names");
}

static ruga_status add_value(ruga_csv* csv, int column, const char* field) {
    char* end;
    double value = strtod(field, &end);
    RUGA_TRY(RUGA_RESERVE(csv->column[column], csv->capacity[column], csv->row_count + 1));
    csv->column[column][csv->row_count] = end != field && *end == '\0' ? value : NAN;
    return RUGA_OK;
}

static ruga_status read_line(ruga_text* text, bool names, ruga_csv* csv) {
    size_t length;
    char field[FIELD_MAX];
    const char* at = ruga_text_rest(text, &length);
    const char* end = at + length;
    int column = 0;
    for (;; at++, column++) {
        if (!take_field(&at, end, field)) {
            return ruga_text_fail(text, "a quote is not closed");
        }
        if (column >= (names ? COLUMNS_MAX : csv->column_count)) {
            return ruga_text_fail(text, names ? "a table has at most 1000 columns"
                                              : "more fields than the first line has names");
        }
        RUGA_TRY(names ? add_column(csv, field) : add_value(csv, column, field));
        if (at >= end) {
            break;
        }
    }
    if (!names && column + 1 < csv->column_count) {
        return ruga_text_fail(text, "%d fields, and the first line has %d names", column + 1,
                              csv->column_count);
    }
    csv->row_count += !names;
    return RUGA_OK;
}

static ruga_status read_all(ruga_text* text, ruga_csv* csv) {
    RUGA_TRY(RUGA_NEW_ZERO(csv->name, COLUMNS_MAX));
    RUGA_TRY(RUGA_NEW_ZERO(csv->column, COLUMNS_MAX));
    RUGA_TRY(RUGA_NEW_ZERO(csv->capacity, COLUMNS_MAX));
    bool names = true;
    do {
        if (!ruga_text_line_ends(text)) {
            RUGA_TRY(read_line(text, names, csv));
            names = false;
        }
    } while (ruga_text_next_line(text));
    return csv->row_count > 0
               ? RUGA_OK
               : ruga_fail(RUGA_BAD_INPUT, "%s: has no row below the line of names", text->path);
}

ruga_status ruga_csv_read(const char* path, ruga_csv* csv) {
    ruga_text text;
    *csv = (ruga_csv){0};
    RUGA_TRY(ruga_text_open(path, &text));
    ruga_status status = read_all(&text, csv);
    ruga_text_close(&text);
    if (status != RUGA_OK) {
        ruga_csv_clear(csv);
    }
    return status;
}

void ruga_csv_clear(ruga_csv* csv) {
    for (int c = 0; c < csv->column_count; c++) {
        ruga_release(csv->name[c]);
        ruga_release(csv->column[c]);
    }
    ruga_release(csv->name);
    ruga_release(csv->column);
    ruga_release(csv->capacity);
    *csv = (ruga_csv){0};
}

int ruga_csv_find(const ruga_csv* csv, const char* name, size_t length) {
    for (int c = 0; c < csv->column_count; c++) {
        if (strlen(csv->name[c]) == length && strncmp(csv->name[c], name, length) == 0) {
            return c;
        }
    }
    return -1;
}
