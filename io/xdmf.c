// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// XDMF 2: a temporal collection of grids that share their triangles. What changes is a hyperslab of its
// dataset: (first, stride, count) along each axis. Fields at vertices: embedded, rest, thickness, young,
// wavelength, growth_u, growth_v; at faces: group; of the whole grid: outcome, residual_shell, energies.
#define _XOPEN_SOURCE 700
#include "io/xdmf.h"

#include "core/memory.h"
#include "io/writer.h"

#include <stdlib.h>
#include <string.h>

typedef struct job {
    FILE* file;
    const char* source; // name of the result file, escaped
    int frames, vertices, faces;
} job;

static const char REAL[] = "NumberType=\"Float\" Precision=\"8\"";

static ruga_status escape(const char* text, char** escaped) {
    RUGA_TRY(RUGA_NEW(*escaped, 6 * strlen(text) + 1));
    char* to = *escaped;
    for (; *text; text++) {
        const char* word = *text == '&' ? "&amp;" : *text == '<' ? "&lt;" : *text == '"' ? "&quot;" : NULL;
        size_t length = word ? strlen(word) : 1;
        memcpy(to, word ? word : text, length);
        to += length;
    }
    *to = '\0';
    return RUGA_OK;
}

// The folder of a path with its last slash; length 0 = here.
static size_t folder_length(const char* path) {
    const char* slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

static ruga_status name_source(const char* path, const char* result_path, char** name) {
    size_t here = folder_length(path), there = folder_length(result_path);
    if (here == there && strncmp(path, result_path, here) == 0) {
        return escape(result_path + there, name);
    }
    char* absolute = realpath(result_path, NULL);
    ruga_status status = absolute ? escape(absolute, name)
                                  : ruga_fail(RUGA_IO, "%s: its place cannot be found out", result_path);
    free(absolute);
    return status;
}

static void put_static(const job* j, const char* type, const char* name, const char* center, const char* set,
                       int rows, int columns) {
    (void)fprintf(
        j->file,
        "        <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"%s\">\n"
        "          <DataItem Dimensions=\"%d%s\" %s Format=\"HDF\">%s:%s</DataItem>\n        </Attribute>\n",
        name, type, center, rows, columns == 3 ? " 3" : "",
        strcmp(center, "Cell") == 0 ? "NumberType=\"Int\" Precision=\"4\"" : REAL, j->source, set);
}

// One column of a dataset [V][2].
static void put_column(const job* j, const char* name, const char* set, int column) {
    (void)fprintf(j->file,
                  "        <Attribute Name=\"%s\" AttributeType=\"Scalar\" Center=\"Node\">\n"
                  "          <DataItem ItemType=\"HyperSlab\" Dimensions=\"%d 1\">\n"
                  "            <DataItem Dimensions=\"3 2\" Format=\"XML\">0 %d 1 1 %d 1</DataItem>\n"
                  "            <DataItem Dimensions=\"%d 2\" %s Format=\"HDF\">%s:%s</DataItem>\n"
                  "          </DataItem>\n        </Attribute>\n",
                  name, j->vertices, column, j->vertices, j->vertices, REAL, j->source, set);
}

// Row `frame` of a dataset [T][V][3].
static void put_vectors(const job* j, const char* set, int frame) {
    (void)fprintf(j->file,
                  "          <DataItem ItemType=\"HyperSlab\" Dimensions=\"%d 3\" NumberType=\"Float\" "
                  "Precision=\"8\">\n"
                  "            <DataItem Dimensions=\"3 3\" Format=\"XML\">%d 0 0 1 1 1 1 %d 3</DataItem>\n"
                  "            <DataItem Dimensions=\"%d %d 3\" %s Format=\"HDF\">%s:%s</DataItem>\n"
                  "          </DataItem>\n",
                  j->vertices, frame, j->vertices, j->frames, j->vertices, REAL, j->source, set);
}

// Element `frame` of a dataset [T].
static void put_number(const job* j, const char* name, const char* type, int frame) {
    (void)fprintf(j->file,
                  "        <Attribute Name=\"%s\" AttributeType=\"Scalar\" Center=\"Grid\">\n"
                  "          <DataItem ItemType=\"HyperSlab\" Dimensions=\"1\">\n"
                  "            <DataItem Dimensions=\"3 1\" Format=\"XML\">%d 1 1</DataItem>\n"
                  "            <DataItem Dimensions=\"%d\" %s Format=\"HDF\">%s:/stats/%s</DataItem>\n"
                  "          </DataItem>\n        </Attribute>\n",
                  name, frame, j->frames, type, j->source, name);
}

static void put_fields(const job* j, const ruga_result_reader* result, int frame) {
    static const char* const numbers[] = {"residual_shell",    "energy_membrane", "energy_bending",
                                          "energy_foundation", "energy_interior", "energy_kinetic",
                                          "energy_external"};
    const ruga_result_header* header = ruga_result_reader_header(result);
    if (ruga_result_has_interior(result)) {
        (void)fputs("        <Attribute Name=\"embedded\" AttributeType=\"Vector\" Center=\"Node\">\n",
                    j->file);
        put_vectors(j, "/shell/embedded", frame);
        (void)fputs("        </Attribute>\n", j->file);
    }
    put_static(j, "Vector", "rest", "Node", "/mesh/rest", j->vertices, 3);
    if (header->vertex_thickness) {
        put_static(j, "Scalar", "thickness", "Node", "/mesh/thickness", j->vertices, 1);
    }
    if (header->vertex_young) {
        put_static(j, "Scalar", "young", "Node", "/mesh/young", j->vertices, 1);
    }
    if (header->vertex_wavelength) {
        put_static(j, "Scalar", "wavelength", "Node", "/mesh/wavelength", j->vertices, 1);
    }
    if (header->vertex_growth) {
        put_column(j, "growth_u", "/mesh/growth", 0);
        put_column(j, "growth_v", "/mesh/growth", 1);
    }
    if (header->mesh->face_group) {
        put_static(j, "Scalar", "group", "Cell", "/mesh/face_group", j->faces, 1);
    }
    put_number(j, "outcome", "NumberType=\"Char\" Precision=\"1\"", frame);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        put_number(j, numbers[i], REAL, frame);
    }
}

static void put_grid(const job* j, const ruga_result_reader* result, int frame, double time) {
    (void)fprintf(
        j->file,
        "      <Grid Name=\"skin\" GridType=\"Uniform\">\n        <Time Value=\"%.17g\"/>\n"
        "        <Topology TopologyType=\"Triangle\" NumberOfElements=\"%d\">\n"
        "          <DataItem Dimensions=\"%d 3\" NumberType=\"Int\" Precision=\"4\" Format=\"HDF\">"
        "%s:/mesh/triangles</DataItem>\n        </Topology>\n        <Geometry GeometryType=\"XYZ\">\n",
        time, j->faces, j->faces, j->source);
    put_vectors(j, "/shell/position", frame);
    (void)fputs("        </Geometry>\n", j->file);
    put_fields(j, result, frame);
    (void)fputs("      </Grid>\n", j->file);
}

ruga_status ruga_xdmf_write(const char* path, const char* result_path, const ruga_result_reader* result,
                            const double* time, int first, int last) {
    const ruga_mesh* mesh = ruga_result_mesh(result);
    char* source = NULL;
    ruga_writer writer;
    RUGA_TRY(name_source(path, result_path, &source));
    ruga_status status = ruga_writer_open(path, &writer);
    if (status == RUGA_OK) {
        job j = {writer.file, source, ruga_result_frame_count(result), mesh->vertex_count,
                 mesh->triangle_count};
        (void)fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Xdmf Version=\"2.0\">\n  <Domain>\n"
                    "    <Grid Name=\"frames\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
                    writer.file);
        for (int frame = first; frame <= last; frame++) {
            put_grid(&j, result, frame, time[frame - first]);
        }
        (void)fputs("    </Grid>\n  </Domain>\n</Xdmf>\n", writer.file);
        status = ruga_writer_close(&writer, RUGA_OK);
    }
    ruga_release(source);
    return status;
}
