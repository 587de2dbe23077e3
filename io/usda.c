// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// USD as text: one Mesh with time samples of points, normals and extent at time code k of frame k; uvs as the
// primvar st for each corner, groups as subsets. Unit, up axis and frame rate stand in the head.
#include "core/memory.h"
#include "io/animation.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

enum { NAME_LENGTH = 128 };

typedef struct job {
    const ruga_animation* animation;
    ruga_writer* writer;
    int *order, *start;
    double* scratch;          // [2][V][3]
    float *position, *normal; // [V][3]
    float (*bounds)[6];       // [count] of each frame
    char (*group)[NAME_LENGTH];
} job;

// Letters, digits and _, not beginning with a digit: all that a name may hold.
static void make_identifier(const char* text, char name[NAME_LENGTH]) {
    size_t n = 0;
    if (isdigit((unsigned char)text[0])) {
        name[n++] = '_';
    }
    for (; *text && n < NAME_LENGTH - 16; text++) {
        bool plain = (unsigned char)*text < 128 && isalnum((unsigned char)*text);
        name[n++] = (char)(plain ? *text : '_');
    }
    name[n] = '\0';
}

static void put_text(ruga_writer* writer, const char* text) {
    (void)fputc('"', writer->file);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') {
            (void)fputc('\\', writer->file);
        }
        (void)fputc((unsigned char)*text < 32 ? ' ' : *text, writer->file);
    }
    (void)fputc('"', writer->file);
}

static void put_tuples(const job* j, const float* value, size_t count, int width) {
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < width; k++) {
            (void)fprintf(j->writer->file, "%s%.9g",
                          k > 0   ? ", "
                          : i > 0 ? ", ("
                                  : "[(",
                          (double)value[(size_t)width * i + (size_t)k]);
        }
        (void)fputc(')', j->writer->file);
    }
    (void)fputs(count > 0 ? "]" : "[]", j->writer->file);
}

static void put_head(const job* j) {
    const ruga_animation* a = j->animation;
    FILE* file = j->writer->file;
    char name[NAME_LENGTH];
    make_identifier(a->name, name);
    (void)fprintf(file, "#usda 1.0\n(\n    defaultPrim = \"%s\"\n    doc = ", name);
    put_text(j->writer, a->comment ? a->comment : "");
    (void)fprintf(
        file,
        "\n    metersPerUnit = %.17g\n    upAxis = \"%c\"\n    startTimeCode = %d\n    endTimeCode = %d\n"
        "    timeCodesPerSecond = %.17g\n    framesPerSecond = %.17g\n)\n\n",
        a->unit, a->up == 1 ? 'Y' : 'Z', a->first, a->first + a->count - 1, a->rate, a->rate);
    (void)fprintf(file, "def Mesh \"%s\" (\n    customData = {\n        string name = ", name);
    put_text(j->writer, a->name);
    (void)fputs("\n    }\n)\n{\n    uniform token orientation = \"rightHanded\"\n"
                "    uniform token subdivisionScheme = \"none\"\n    uniform bool doubleSided = 1\n",
                file);
}

static void put_faces(const job* j) {
    const ruga_mesh* mesh = j->animation->mesh;
    FILE* file = j->writer->file;
    (void)fputs("    int[] faceVertexCounts = [", file);
    for (int f = 0; f < mesh->triangle_count; f++) {
        (void)fputs(f > 0 ? ", 3" : "3", file);
    }
    (void)fputs("]\n    int[] faceVertexIndices = [", file);
    for (size_t c = 0; c < 3 * (size_t)mesh->triangle_count; c++) {
        (void)fprintf(file, c > 0 ? ", %d" : "%d", mesh->triangle[c]);
    }
    (void)fputs("]\n", file);
}

// A corner without uv takes one more, (0, 0).
static ruga_status put_uvs(const job* j) {
    const ruga_mesh* mesh = j->animation->mesh;
    FILE* file = j->writer->file;
    if (!mesh->uv || !mesh->uv_triangle) {
        return RUGA_OK;
    }
    (void)fputs("    texCoord2f[] primvars:st = ", file);
    for (size_t u = 0; u < (size_t)mesh->uv_count; u++) {
        const double* st = mesh->uv + 2 * u;
        if (!isfinite((float)st[0]) || !isfinite((float)st[1])) {
            return ruga_fail(RUGA_BAD_INPUT, "texture coordinate %zu is not a number that USD can hold", u);
        }
        (void)fprintf(file, "%s(%.9g, %.9g)", u > 0 ? ", " : "[", st[0], st[1]);
    }
    (void)fputs(mesh->uv_count > 0 ? ", (0, 0)] (\n" : "[(0, 0)] (\n", file);
    (void)fputs("        interpolation = \"faceVarying\"\n    )\n    int[] primvars:st:indices = [", file);
    for (size_t c = 0; c < 3 * (size_t)mesh->triangle_count; c++) {
        int u = mesh->uv_triangle[c];
        (void)fprintf(file, c > 0 ? ", %d" : "%d", u >= 0 ? u : mesh->uv_count);
    }
    (void)fputs("]\n", file);
    return RUGA_OK;
}

// Points and bounds in a first walk over the frames, normals in a second.
static ruga_status put_samples(const job* j, bool normals) {
    const ruga_animation* a = j->animation;
    FILE* file = j->writer->file;
    size_t vertices = (size_t)a->mesh->vertex_count;
    (void)fputs(normals ? "    normal3f[] normals (\n        interpolation = \"vertex\"\n    )\n"
                          "    normal3f[] normals.timeSamples = {\n"
                        : "    point3f[] points.timeSamples = {\n",
                file);
    for (int k = 0; k < a->count; k++) {
        RUGA_TRY(ruga_animation_read(a, a->first + k, j->scratch, j->position, normals ? j->normal : NULL));
        (void)fprintf(file, "        %d: ", a->first + k);
        put_tuples(j, normals ? j->normal : j->position, vertices, 3);
        (void)fputs(",\n", file);
        float* box = j->bounds[k];
        for (size_t i = 0; i < 3 * vertices; i++) {
            box[i % 3] = i < 3 ? j->position[i] : fminf(box[i % 3], j->position[i]);
            box[3 + i % 3] = i < 3 ? j->position[i] : fmaxf(box[3 + i % 3], j->position[i]);
        }
    }
    (void)fputs("    }\n", file);
    return RUGA_OK;
}

static void put_extents(const job* j) {
    (void)fputs("    float3[] extent.timeSamples = {\n", j->writer->file);
    for (int k = 0; k < j->animation->count; k++) {
        (void)fprintf(j->writer->file, "        %d: ", j->animation->first + k);
        put_tuples(j, j->bounds[k], 2, 3);
        (void)fputs(",\n", j->writer->file);
    }
    (void)fputs("    }\n", j->writer->file);
}

static void put_groups(const job* j) {
    const ruga_mesh* mesh = j->animation->mesh;
    FILE* file = j->writer->file;
    int groups = mesh->face_group ? mesh->group_count : 0;
    if (groups > 0) {
        (void)fputs("    uniform token subsetFamily:materialBind:familyType = \"nonOverlapping\"\n", file);
    }
    for (int g = 0; g < groups; g++) {
        (void)fprintf(
            file,
            "\n    def GeomSubset \"%s\" (\n        customData = {\n            string name = ", j->group[g]);
        put_text(j->writer, mesh->group_name[g]);
        (void)fputs("\n        }\n    )\n    {\n        uniform token elementType = \"face\"\n"
                    "        uniform token familyName = \"materialBind\"\n        int[] indices = [",
                    file);
        for (int i = j->start[g]; i < j->start[g + 1]; i++) {
            (void)fprintf(file, i > j->start[g] ? ", %d" : "%d", j->order[i]);
        }
        (void)fputs("]\n    }\n", file);
    }
}

static ruga_status put_content(const job* j) {
    put_head(j);
    put_faces(j);
    RUGA_TRY(put_uvs(j));
    RUGA_TRY(put_samples(j, false));
    RUGA_TRY(put_samples(j, true));
    put_extents(j);
    put_groups(j);
    (void)fputs("}\n", j->writer->file);
    return RUGA_OK;
}

static bool is_taken(const job* j, int count, const char* name) {
    for (int g = 0; g < count; g++) {
        if (strcmp(j->group[g], name) == 0) {
            return true;
        }
    }
    return false;
}

// Names that differ only in what an identifier cannot hold are told apart by a number.
static ruga_status name_groups(job* j) {
    const ruga_mesh* mesh = j->animation->mesh;
    int groups = mesh->face_group ? mesh->group_count : 0;
    RUGA_TRY(RUGA_NEW(j->group, groups));
    for (int g = 0; g < groups; g++) {
        char name[NAME_LENGTH];
        make_identifier(mesh->group_name[g][0] ? mesh->group_name[g] : "group", name);
        (void)snprintf(j->group[g], NAME_LENGTH, "%s", name);
        for (int number = g; is_taken(j, g, j->group[g]); number += groups) {
            (void)snprintf(j->group[g], NAME_LENGTH, "%.112s_%d", name, number);
        }
    }
    return RUGA_OK;
}

static ruga_status prepare(job* j) {
    const ruga_mesh* mesh = j->animation->mesh;
    size_t numbers = 3 * (size_t)mesh->vertex_count;
    RUGA_TRY(RUGA_NEW(j->order, mesh->triangle_count));
    RUGA_TRY(RUGA_NEW(j->start, (mesh->face_group ? mesh->group_count : 0) + 2));
    ruga_animation_sort_faces(mesh, j->order, j->start);
    RUGA_TRY(name_groups(j));
    RUGA_TRY(RUGA_NEW(j->scratch, 2 * numbers));
    RUGA_TRY(RUGA_NEW(j->position, numbers));
    RUGA_TRY(RUGA_NEW(j->normal, numbers));
    return RUGA_NEW_ZERO(j->bounds, j->animation->count);
}

ruga_status ruga_usda_animation_write(const char* path, const ruga_animation* animation) {
    ruga_status status = RUGA_OK;
    ruga_writer writer;
    job j = {.animation = animation, .writer = &writer};
    RUGA_TRY_DONE(prepare(&j));
    RUGA_TRY_DONE(ruga_writer_open(path, &writer));
    status = ruga_writer_close(&writer, put_content(&j));
done:
    ruga_release(j.order);
    ruga_release(j.start);
    ruga_release(j.scratch);
    ruga_release(j.position);
    ruga_release(j.normal);
    ruga_release(j.bounds);
    ruga_release(j.group);
    return status;
}
