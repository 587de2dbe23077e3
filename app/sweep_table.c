// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The rows of a sweep as CSV (RFC 4180) and as HDF5: one dataset of one dimension for each column, doubles or
// texts.
#include "app/sweep.h"

#include "core/memory.h"
#include "io/hdf5_util.h"
#include "io/writer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// An object whose keys are the columns; its values say whether the column holds texts.
static json_t* find_columns(const ruga_sweep* sweep) {
    json_t* columns = json_object();
    for (int k = 0; k < sweep->point_count; k++) {
        const char* key;
        json_t* value;
        json_object_foreach(sweep->points[k].row, key, value) {
            bool text = json_is_string(value) || json_is_true(json_object_get(columns, key));
            (void)json_object_set_new(columns, key, json_boolean(text));
        }
    }
    return columns;
}

static void write_text(ruga_writer* writer, const char* text) {
    if (text[strcspn(text, ",\"\r\n")] == '\0') {
        (void)fputs(text, writer->file);
        return;
    }
    (void)fputc('"', writer->file);
    for (; *text; text++) {
        (void)fputs(*text == '"' ? "\"\"" : (char[2]){*text, '\0'}, writer->file);
    }
    (void)fputc('"', writer->file);
}

// The fewest digits that read back as the same number.
static void write_number(ruga_writer* writer, double value) {
    char text[32];
    double back = 0;
    (void)snprintf(text, sizeof text, "%.15g", value);
    if (sscanf(text, "%lf", &back) != 1 || back != value) {
        (void)snprintf(text, sizeof text, "%.17g", value);
    }
    (void)fputs(text, writer->file);
}

static void write_row(ruga_writer* writer, json_t* columns, const json_t* row) {
    const char* key;
    json_t* is_text;
    bool first = true;
    json_object_foreach(columns, key, is_text) {
        const json_t* value = json_object_get(row, key);
        (void)fputs(first ? "" : ",", writer->file);
        first = false;
        if (json_is_string(value)) {
            write_text(writer, json_string_value(value));
        } else if (json_is_number(value)) {
            write_number(writer, json_number_value(value));
        }
    }
    (void)fputc('\n', writer->file);
}

ruga_status ruga_sweep_write_csv(const ruga_sweep* sweep, const char* path) {
    ruga_writer writer;
    RUGA_TRY(ruga_writer_open(path, &writer));
    json_t* columns = find_columns(sweep);
    const char* key;
    json_t* is_text;
    bool first = true;
    json_object_foreach(columns, key, is_text) {
        (void)fputs(first ? "" : ",", writer.file);
        write_text(&writer, key);
        first = false;
    }
    (void)fputc('\n', writer.file);
    for (int k = 0; k < sweep->point_count; k++) {
        write_row(&writer, columns, sweep->points[k].row);
    }
    json_decref(columns);
    return ruga_writer_close(&writer, RUGA_OK);
}

// ---- HDF5 ----------------------------------------------------------------------------------------------

static bool put_numbers(hid_t file, const ruga_sweep* sweep, const char* key, double* numbers) {
    hsize_t size = (hsize_t)sweep->point_count;
    for (int k = 0; k < sweep->point_count; k++) {
        const json_t* value = json_object_get(sweep->points[k].row, key);
        numbers[k] = json_is_number(value) ? json_number_value(value) : NAN;
    }
    return ruga_hdf5_put_array(file, key, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 1, &size, numbers);
}

static bool put_texts(hid_t file, const ruga_sweep* sweep, const char* key, char** texts) {
    static char empty[] = "";
    for (int k = 0; k < sweep->point_count; k++) {
        const json_t* value = json_object_get(sweep->points[k].row, key);
        texts[k] = json_is_string(value) ? (char*)json_string_value(value) : empty;
    }
    return ruga_hdf5_put_texts(file, key, sweep->point_count, texts);
}

static bool put_columns(hid_t file, const ruga_sweep* sweep, double* numbers, char** texts) {
    json_t* columns = find_columns(sweep);
    const char* key;
    json_t* is_text;
    bool good = columns != NULL;
    json_object_foreach(columns, key, is_text) {
        good = good && (json_is_true(is_text) ? put_texts(file, sweep, key, texts)
                                              : put_numbers(file, sweep, key, numbers));
    }
    json_decref(columns);
    return good;
}

ruga_status ruga_sweep_write_hdf5(const ruga_sweep* sweep, const char* path) {
    ruga_status status = RUGA_OK;
    double* numbers = NULL;
    char **texts = NULL, temporary[4096];
    ruga_hdf5 hdf5;
    if (snprintf(temporary, sizeof temporary, "%s.part", path) >= (int)sizeof temporary) {
        return ruga_fail(RUGA_BAD_INPUT, "the path of the table is too long");
    }
    RUGA_TRY_DONE(RUGA_NEW(numbers, sweep->point_count));
    RUGA_TRY_DONE(RUGA_NEW(texts, sweep->point_count));
    ruga_hdf5_begin(&hdf5, path);
    hid_t file = H5Fcreate(temporary, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    bool good = file >= 0 && ruga_hdf5_put_text(file, "scene", sweep->scene) &&
                put_columns(file, sweep, numbers, texts);
    good = (file >= 0 && H5Fclose(file) >= 0) && good && rename(temporary, path) == 0;
    status = ruga_hdf5_check(&hdf5, good, RUGA_IO, "the table could not be written");
    ruga_hdf5_end(&hdf5);
    if (!good) {
        (void)remove(temporary);
    }
done:
    ruga_release(numbers);
    ruga_release(texts);
    return status;
}
