// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/block_calculix.h"

#include "app/validate/peer.h"
#include "io/writer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// The block's nodes lie on a grid of half elements; those at the middles of faces and of elements do not exist.
typedef struct block {
    const block_def* def;
    int n[3]; // half elements
} block;

static int node_of(const block* b, const int at[3]) {
    return 1 + at[0] + (b->n[0] + 1) * (at[1] + (b->n[1] + 1) * at[2]);
}

static void write_nodes(FILE* file, const block* b, const char* set, bool end_only, int end) {
    int at[3];
    (void)fprintf(file, end_only ? "*NSET, NSET=%s\n" : "*NODE%s\n", set);
    for (at[0] = 0; at[0] <= b->n[0]; at[0]++) {
        for (at[1] = 0; at[1] <= b->n[1]; at[1]++) {
            for (at[2] = 0; at[2] <= b->n[2]; at[2]++) {
                if (at[0] % 2 + at[1] % 2 + at[2] % 2 > 1 || (end_only && at[0] != end)) {
                    continue;
                }
                (void)fprintf(file, "%d,", node_of(b, at));
                if (!end_only) {
                    (void)fprintf(file, "%.12g,%.12g,%.12g", b->def->length * at[0] / b->n[0],
                                  b->def->side * at[1] / b->n[1], b->def->side * at[2] / b->n[2]);
                }
                (void)fputc('\n', file);
            }
        }
    }
}

static void write_elements(FILE* file, const block* b) {
    // Corners of the lower and the upper face, then the middles of the lower, upper and upright edges.
    static const int place[20][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2},
                                     {0, 2, 2}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2},
                                     {1, 2, 2}, {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
    int count = 0;
    (void)fputs("*ELEMENT, TYPE=C3D20, ELSET=ALL\n", file);
    for (int i = 0; i < b->n[0]; i += 2) {
        for (int j = 0; j < b->n[1]; j += 2) {
            for (int k = 0; k < b->n[2]; k += 2) {
                (void)fprintf(file, "%d", ++count);
                for (int a = 0; a < 20; a++) {
                    const int at[3] = {i + place[a][0], j + place[a][1], k + place[a][2]};
                    (void)fprintf(file, a == 14 ? ",\n%d" : ",%d", node_of(b, at)); // at most 16 numbers in a line
                }
                (void)fputc('\n', file);
            }
        }
    }
}

// A uniform traction on the end: of each element's face, -1/12 at its corners and 1/3 at the middles of its edges.
static void write_loads(FILE* file, const block* b) {
    double each = b->def->force / (b->n[1] / 2.0 * (b->n[2] / 2.0));
    (void)fputs("*CLOAD\n", file);
    for (int j = 0; j <= b->n[1]; j++) {
        for (int k = 0; k <= b->n[2]; k++) {
            const int at[3] = {b->n[0], j, k};
            int along = j == 0 || j == b->n[1] ? 1 : 2, up = k == 0 || k == b->n[2] ? 1 : 2;
            if (j % 2 + k % 2 > 1) {
                continue;
            }
            double share = j % 2 ? up / 3.0 : k % 2 ? along / 3.0 : -along * up / 12.0;
            (void)fprintf(file, "%d,3,%.12g\n", node_of(b, at), -share * each);
        }
    }
}

static ruga_status write_input(const block* b, const char* path) {
    ruga_writer writer;
    RUGA_TRY(ruga_writer_open(path, &writer));
    write_nodes(writer.file, b, "", false, 0);
    write_elements(writer.file, b);
    write_nodes(writer.file, b, "HELD", true, 0);
    write_nodes(writer.file, b, "END", true, b->n[0]);
    (void)fprintf(writer.file,
                  "*MATERIAL, NAME=M\n*ELASTIC\n%.12g,%.12g\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
                  "*BOUNDARY\nHELD,1,3\n*STEP\n*STATIC\n",
                  b->def->young, b->def->poisson);
    write_loads(writer.file, b);
    (void)fputs("*NODE PRINT, NSET=END\nU\n*END STEP\n", writer.file);
    return ruga_writer_close(&writer, RUGA_OK);
}

// Mean of -u_z over the lines "node ux uy uz" of the answer.
static ruga_status read_sag(const char* path, double* sag) {
    FILE* file = fopen(path, "r");
    char line[256];
    double sum = 0;
    int count = 0;
    if (!file) {
        return ruga_fail(RUGA_LIBRARY, "%s: ccx did not write it", path);
    }
    while (fgets(line, sizeof line, file)) {
        int node;
        double u[3];
        if (sscanf(line, "%d %lf %lf %lf", &node, &u[0], &u[1], &u[2]) == 4) {
            sum -= u[2];
            count++;
        }
    }
    (void)fclose(file);
    *sag = sum / count;
    return count ? RUGA_OK : ruga_fail(RUGA_LIBRARY, "%s: has no displacements", path);
}

ruga_status block_sag(const char* ccx, const char* directory, const block_def* def, double* sag) {
    enum { LIMIT = 600 };
    char path[RUGA_VALIDATION_PATH + 32], program[] = "ccx", option[] = "-i", job[] = "block";
    char* argument[] = {program, option, job, NULL};
    block b = {def, {2 * def->elements[0], 2 * def->elements[1], 2 * def->elements[1]}};
    (void)snprintf(path, sizeof path, "%s/block.inp", directory);
    RUGA_TRY(write_input(&b, path));
    RUGA_TRY(peer_run(ccx, argument, directory, "block.log", LIMIT));
    (void)snprintf(path, sizeof path, "%s/block.dat", directory);
    return read_sag(path, sag);
}
