// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Reading result files, also while they are written or after their writer was killed. Nothing in the file is
// trusted: shapes are compared with one another and with the space that the file really has, indices with
// their ranges, before memory is taken for them.
#define _POSIX_C_SOURCE 200809L
#include "core/memory.h"
#include "io/result_layout.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct ruga_result_reader {
    char* path;
    hid_t file;
    hid_t set[RUGA_RESULT_SETS];
    int frame_count;
    ruga_mesh mesh;
    bool has_interior;
    int node_count, element_count, nodes_per_element;
    char* scene_text;
    double *thickness, *young, *growth, *wavelength; // or NULL
    ruga_result_header header;
    ruga_result_creases creases;
    int *segment, *segment_crease;
    double *crease_length, *crease_stiffness;
    char *assignment, **crease_name;
};

// --- Opening ---

// A plain file that looks like HDF5, or a sentence that says what it is.
static ruga_status check_file(const char* path) {
    struct stat info;
    if (stat(path, &info) != 0) {
        return ruga_fail(RUGA_IO, "%s: cannot be read: %s", path, strerror(errno));
    }
    if (!S_ISREG(info.st_mode)) {
        return ruga_fail(RUGA_IO, "%s: is not a file", path);
    }
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, path);
    htri_t answer = H5Fis_hdf5(path);
    ruga_status status = ruga_hdf5_check(&hdf5, answer >= 0, RUGA_IO, "cannot be read");
    ruga_hdf5_end(&hdf5);
    if (answer == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: is not an HDF5 file, so no result of Ruga", path);
    }
    return status;
}

// Beside a writer HDF5 reads a table anew while its checksum is wrong, after pauses of 1, 2, 4, ... ns: these
// are 0.07 s in all. Its own 100 attempts would never end where a file is damaged.
enum { READ_ATTEMPTS = 26 };

// As a reader beside a writer; a file that some other program has rewritten may know no such mode.
static bool open_file(ruga_hdf5* hdf5, ruga_result_reader* reader) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (access >= 0 && H5Pset_metadata_read_attempts(access, READ_ATTEMPTS) >= 0) {
        reader->file = H5Fopen(reader->path, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access);
    }
    (void)H5Pclose(access);
    if (reader->file < 0) {
        hdf5->reason[0] = '\0';
        reader->file = H5Fopen(reader->path, H5F_ACC_RDONLY, H5P_DEFAULT);
    }
    return reader->file >= 0;
}

static bool exists(hid_t file, const char* group, const char* path) {
    return H5Lexists(file, group, H5P_DEFAULT) > 0 && H5Lexists(file, path, H5P_DEFAULT) > 0;
}

// --- Arrays ---

// Rows and columns of a dataset of rank 2, or 1 where columns = 1; in range, and really in the file.
static bool get_shape(hid_t set, size_t element, int columns, int* rows, int* found_columns) {
    hsize_t size[2] = {0, 1};
    if (!ruga_hdf5_shape(set, columns == 1 ? 1 : 2, size) || size[0] > INT_MAX / 3 || size[1] > 1000 ||
        (columns > 0 && size[1] != (hsize_t)columns)) {
        return false;
    }
    *rows = (int)size[0];
    *found_columns = (int)size[1];
    return H5Dget_storage_size(set) >= size[0] * size[1] * element;
}

// A whole array in fresh memory. columns = 0: as many as there are, told in *found_columns.
static ruga_status get_array(ruga_hdf5* hdf5, hid_t file, const char* name, hid_t type, size_t element,
                             int columns, int* rows, int* found_columns, void** data) {
    *data = NULL;
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    // Of 4 bytes at least each; what is stored in fewer (and would be valid) Ruga never wrote.
    bool ok = set >= 0 && get_shape(set, element, columns, rows, found_columns);
    ruga_status status = ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, name);
    if (ok) {
        status = ruga_allocate_checked((size_t)*rows * (size_t)*found_columns, element, false, data);
    }
    if (status == RUGA_OK && *rows > 0) {
        ok = H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, *data) >= 0;
        status = ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, name);
    }
    if (set >= 0) {
        (void)H5Dclose(set);
    }
    return status;
}

static ruga_status get_integers(ruga_hdf5* hdf5, hid_t file, const char* name, int columns, int wanted_rows,
                                int* rows, int** data) {
    int found;
    RUGA_TRY(get_array(hdf5, file, name, H5T_NATIVE_INT, sizeof **data, columns, rows, &found, (void**)data));
    if (wanted_rows >= 0 && *rows != wanted_rows) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: %s has %d rows, not %d: the file is damaged", hdf5->path, name,
                         *rows, wanted_rows);
    }
    return RUGA_OK;
}

static ruga_status get_reals(ruga_hdf5* hdf5, hid_t file, const char* name, int columns, int* rows,
                             double** data) {
    int found;
    return get_array(hdf5, file, name, H5T_NATIVE_DOUBLE, sizeof **data, columns, rows, &found, (void**)data);
}

// --- The mesh ---

typedef struct mesh_arrays {
    ruga_mesh_def def;
    double *position, *uv;
    int *triangles, *uv_triangles, *face_group, *source_vertex;
    char** names; // strings in HDF5's memory
    hid_t name_space, name_type;
} mesh_arrays;

static ruga_status get_names(ruga_hdf5* hdf5, hid_t file, mesh_arrays* arrays) {
    hsize_t count = 0;
    hid_t set = H5Dopen2(file, "/mesh/group_names", H5P_DEFAULT);
    bool ok = set >= 0 && ruga_hdf5_shape(set, 1, &count) && count <= INT_MAX / 16 &&
              H5Dget_storage_size(set) >= 16 * count;
    ruga_status status = ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, "/mesh/group_names");
    if (ok) {
        status = RUGA_NEW_ZERO(arrays->names, count + 1);
    }
    if (status == RUGA_OK && count > 0) {
        arrays->name_type = ruga_hdf5_text_type();
        arrays->name_space = H5Dget_space(set);
        ok = arrays->name_type >= 0 && arrays->name_space >= 0 &&
             H5Dread(set, arrays->name_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, arrays->names) >= 0;
        for (hsize_t i = 0; ok && i < count; i++) {
            ok = arrays->names[i] != NULL;
        }
        status = ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, "/mesh/group_names");
    }
    if (set >= 0) {
        (void)H5Dclose(set);
    }
    arrays->def.group_count = (int)count;
    arrays->def.group_names = (const char* const*)arrays->names;
    return status;
}

// Nothing that reads a result has to reckon with what is no place. `where`: "frame 3".
static ruga_status check_places(const char* path, const char* where, int vertex_count, const double* x) {
    const double farthest = 1e30; // m; its square is a number, and it fits into a float
    for (int i = 0; x && i < 3 * vertex_count; i++) {
        if (!(fabs(x[i]) <= farthest)) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: %s: coordinate %c of vertex %d is %g, which is no place",
                             path, where, "xyz"[i % 3], i / 3, x[i]);
        }
    }
    return RUGA_OK;
}

static ruga_status get_mesh_arrays(ruga_hdf5* hdf5, hid_t file, mesh_arrays* a) {
    int rows;
    RUGA_TRY(get_reals(hdf5, file, "/mesh/rest", 3, &a->def.vertex_count, &a->position));
    RUGA_TRY(check_places(hdf5->path, "/mesh/rest", a->def.vertex_count, a->position));
    RUGA_TRY(get_integers(hdf5, file, "/mesh/triangles", 3, -1, &a->def.triangle_count, &a->triangles));
    RUGA_TRY(
        get_integers(hdf5, file, "/mesh/source_vertex", 1, a->def.vertex_count, &rows, &a->source_vertex));
    if (exists(file, "/mesh", "/mesh/uv")) {
        RUGA_TRY(get_reals(hdf5, file, "/mesh/uv", 2, &a->def.uv_count, &a->uv));
        RUGA_TRY(get_integers(hdf5, file, "/mesh/uv_triangles", 3, a->def.triangle_count, &rows,
                              &a->uv_triangles));
    }
    if (exists(file, "/mesh", "/mesh/face_group")) {
        RUGA_TRY(
            get_integers(hdf5, file, "/mesh/face_group", 1, a->def.triangle_count, &rows, &a->face_group));
        RUGA_TRY(get_names(hdf5, file, a));
    }
    a->def.positions = a->position;
    a->def.triangles = a->triangles;
    a->def.uv = a->uv;
    a->def.uv_triangles = a->uv_triangles;
    a->def.face_group = a->face_group;
    return RUGA_OK;
}

static ruga_status get_mesh(ruga_hdf5* hdf5, hid_t file, ruga_mesh* mesh) {
    mesh_arrays arrays = {.name_space = -1, .name_type = -1};
    ruga_status status = get_mesh_arrays(hdf5, file, &arrays);
    if (status == RUGA_OK && (arrays.def.vertex_count == 0 || arrays.def.triangle_count == 0)) {
        status = ruga_fail(RUGA_BAD_INPUT, "%s: /mesh is empty: the file is damaged", hdf5->path);
    }
    if (status == RUGA_OK) {
        status = ruga_mesh_from_def(&arrays.def, mesh);
        if (status != RUGA_OK) {
            status = ruga_fail_prefix(status, "%s", hdf5->path);
        }
    }
    if (status == RUGA_OK) {
        mesh->source_vertex = arrays.source_vertex;
        arrays.source_vertex = NULL;
    }
    if (arrays.name_type >= 0 && arrays.name_space >= 0) {
        (void)H5Dvlen_reclaim(arrays.name_type, arrays.name_space, H5P_DEFAULT, arrays.names);
    }
    if (arrays.name_space >= 0) {
        (void)H5Sclose(arrays.name_space);
    }
    if (arrays.name_type >= 0) {
        (void)H5Tclose(arrays.name_type);
    }
    ruga_release(arrays.names);
    ruga_release(arrays.position);
    ruga_release(arrays.uv);
    ruga_release(arrays.triangles);
    ruga_release(arrays.uv_triangles);
    ruga_release(arrays.face_group);
    ruga_release(arrays.source_vertex);
    return status;
}

// Numbers of the vertices, all above 0; NULL where the file has none.
static ruga_status get_skin_values(ruga_hdf5* hdf5, const ruga_result_reader* reader, const char* name,
                                   int columns, double** values) {
    int rows;
    if (!exists(reader->file, "/mesh", name)) {
        return RUGA_OK;
    }
    RUGA_TRY(get_reals(hdf5, reader->file, name, columns, &rows, values));
    bool ok = rows == reader->mesh.vertex_count;
    for (int i = 0; ok && i < columns * rows; i++) {
        ok = (*values)[i] > 0 && isfinite((*values)[i]);
    }
    return ok ? RUGA_OK
              : ruga_fail(RUGA_BAD_INPUT,
                          "%s: %s has another length than the mesh, or a value that is not above 0: "
                          "the file is damaged",
                          hdf5->path, name);
}

static ruga_status get_skin(ruga_hdf5* hdf5, ruga_result_reader* reader) {
    RUGA_TRY(get_skin_values(hdf5, reader, "/mesh/thickness", 1, &reader->thickness));
    RUGA_TRY(get_skin_values(hdf5, reader, "/mesh/young", 1, &reader->young));
    RUGA_TRY(get_skin_values(hdf5, reader, "/mesh/growth", 2, &reader->growth));
    RUGA_TRY(get_skin_values(hdf5, reader, "/mesh/wavelength", 1, &reader->wavelength));
    reader->header.vertex_thickness = reader->thickness;
    reader->header.vertex_young = reader->young;
    reader->header.vertex_growth = reader->growth;
    reader->header.vertex_wavelength = reader->wavelength;
    return RUGA_OK;
}

// --- Creases ---

// Strings of a dataset, copied.
static ruga_status get_texts(ruga_hdf5* hdf5, hid_t file, const char* name, int* count, char*** texts) {
    ruga_status status = RUGA_OK;
    hsize_t rows = 0;
    char** raw = NULL;
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT), type = ruga_hdf5_text_type(), space = -1;
    bool ok = set >= 0 && type >= 0 && ruga_hdf5_shape(set, 1, &rows) && rows <= INT_MAX / 16 &&
              H5Dget_storage_size(set) >= 16 * rows && (space = H5Dget_space(set)) >= 0;
    RUGA_TRY_DONE(ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, name));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(raw, rows + 1));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(*texts, rows + 1));
    ok = rows == 0 || H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, raw) >= 0;
    RUGA_TRY_DONE(ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, name));
    *count = (int)rows;
    for (hsize_t i = 0; i < rows && status == RUGA_OK; i++) {
        (*texts)[i] = ruga_copy_string(raw[i] ? raw[i] : "");
        status = (*texts)[i] ? RUGA_OK : ruga_fail(RUGA_NO_MEMORY, "out of memory: %s", name);
    }
    (void)H5Dvlen_reclaim(type, space, H5P_DEFAULT, raw);
done:
    ruga_release(raw);
    if (space >= 0) {
        (void)H5Sclose(space);
    }
    if (type >= 0) {
        (void)H5Tclose(type);
    }
    if (set >= 0) {
        (void)H5Dclose(set);
    }
    return status;
}

static ruga_status get_column(ruga_hdf5* hdf5, hid_t file, const char* name, int wanted, double** data) {
    int rows = 0;
    RUGA_TRY(get_reals(hdf5, file, name, 1, &rows, data));
    return rows == wanted ? RUGA_OK
                          : ruga_fail(RUGA_BAD_INPUT, "%s: %s has %d rows, not %d: the file is damaged", hdf5->path, name,
                                      rows, wanted);
}

static ruga_status get_creases(ruga_hdf5* hdf5, ruga_result_reader* r) {
    ruga_result_creases* c = &r->creases;
    int rows = 0, columns;
    if (H5Lexists(r->file, "/creases", H5P_DEFAULT) <= 0) {
        return RUGA_OK;
    }
    RUGA_TRY(get_integers(hdf5, r->file, "/creases/segments", 2, -1, &c->segment_count, &r->segment));
    RUGA_TRY(get_integers(hdf5, r->file, "/creases/segment_crease", 1, c->segment_count, &rows, &r->segment_crease));
    RUGA_TRY(get_column(hdf5, r->file, "/creases/length", c->segment_count, &r->crease_length));
    RUGA_TRY(get_column(hdf5, r->file, "/creases/stiffness", c->segment_count, &r->crease_stiffness));
    RUGA_TRY(get_array(hdf5, r->file, "/creases/assignment", H5T_NATIVE_CHAR, 1, 1, &rows, &columns,
                       (void**)&r->assignment));
    RUGA_TRY(get_texts(hdf5, r->file, "/creases/names", &c->crease_count, &r->crease_name));
    bool ok = rows == c->segment_count && rows > 0;
    for (int s = 0; ok && s < c->segment_count; s++) {
        const int* end = r->segment + 2 * (size_t)s;
        ok = end[0] >= 0 && end[0] < r->mesh.vertex_count && end[1] >= 0 && end[1] < r->mesh.vertex_count &&
             r->segment_crease[s] >= 0 && r->segment_crease[s] < c->crease_count;
    }
    c->segment = r->segment;
    c->crease = r->segment_crease;
    c->length = r->crease_length;
    c->stiffness = r->crease_stiffness;
    c->assignment = r->assignment;
    c->name = r->crease_name;
    r->header.creases = c;
    return ok ? RUGA_OK : ruga_fail(RUGA_BAD_INPUT, "%s: /creases does not fit the mesh: the file is damaged", hdf5->path);
}

// --- Attributes ---

static bool get_hash(hid_t root, const char* name, uint64_t* hash) {
    char* text;
    char* end = NULL;
    bool ok = ruga_hdf5_get_text(root, name, &text);
    if (ok) {
        *hash = strtoull(text, &end, 16);
        ok = strlen(text) == 16 && *end == '\0';
    }
    (void)H5free_memory(text);
    return ok;
}

static bool get_attributes(hid_t root, ruga_result_header* header) {
    return get_hash(root, "scene_hash", &header->scene_hash) &&
           get_hash(root, "mesh_hash", &header->mesh_hash) &&
           ruga_hdf5_get_integer(root, "seed", &header->seed) &&
           ruga_hdf5_get_double(root, "mesh_unit", &header->mesh_unit) &&
           ruga_hdf5_get_double(root, "wavelength", &header->wavelength) &&
           ruga_hdf5_get_double(root, "critical_strain", &header->critical_strain) &&
           ruga_hdf5_get_double(root, "cluster_sigma", &header->cluster_sigma) &&
           ruga_hdf5_get_double(root, "cluster_radius", &header->cluster_radius);
}

static ruga_status get_format(ruga_hdf5* hdf5, hid_t root) {
    int64_t format = 0;
    bool ok = H5Aexists(root, "format") > 0 && ruga_hdf5_get_integer(root, "format", &format);
    if (!ok) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: is an HDF5 file, but no result of Ruga", hdf5->path);
    }
    if (format != RUGA_RESULT_FORMAT) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: is of format %lld, and this version of Ruga reads format %d",
                         hdf5->path, (long long)format, RUGA_RESULT_FORMAT);
    }
    return RUGA_OK;
}

static ruga_status get_header(ruga_hdf5* hdf5, ruga_result_reader* reader) {
    hid_t root = H5Gopen2(reader->file, "/", H5P_DEFAULT);
    RUGA_TRY(ruga_hdf5_check(hdf5, root >= 0, RUGA_BAD_INPUT, "the file is damaged"));
    ruga_status status = get_format(hdf5, root);
    char* scene = NULL;
    if (status == RUGA_OK) {
        bool ok = ruga_hdf5_get_text(root, "scene", &scene) && get_attributes(root, &reader->header);
        status = ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, "an attribute is missing or damaged");
    }
    if (status == RUGA_OK) {
        reader->scene_text = ruga_copy_string(scene);
        status = reader->scene_text ? RUGA_OK : ruga_fail(RUGA_NO_MEMORY, "out of memory: the scene's text");
    }
    (void)H5free_memory(scene);
    (void)H5Gclose(root);
    reader->header.scene_text = reader->scene_text;
    reader->header.mesh = &reader->mesh;
    return status;
}

// --- Rows of frames ---

// A kill can leave the length of /frames/time on the disk, but not its last value, which is then NaN.
static ruga_status get_frame_count(ruga_hdf5* hdf5, ruga_result_reader* reader) {
    hid_t* set = &reader->set[RUGA_RESULT_TIME];
    hsize_t rows = 0;
    *set = H5Dopen2(reader->file, ruga_result_set_name(RUGA_RESULT_TIME), H5P_DEFAULT);
    bool ok = *set >= 0 && ruga_hdf5_shape(*set, 1, &rows) && rows <= INT_MAX;
    while (ok && rows > 0) {
        double time;
        ok = ruga_hdf5_get_row(*set, H5T_NATIVE_DOUBLE, rows - 1, &time);
        if (ok && !isnan(time)) {
            break;
        }
        rows--;
    }
    reader->frame_count = (int)rows;
    return ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, "/frames/time is missing or damaged");
}

static bool set_fits(const ruga_result_reader* reader, int set) {
    hsize_t size[3] = {0, 1, 3}, frames = (hsize_t)reader->frame_count;
    switch (set) {
    case RUGA_RESULT_POSITION:
    case RUGA_RESULT_EMBEDDED:
        return ruga_hdf5_shape(reader->set[set], 3, size) && size[0] >= frames &&
               size[1] == (hsize_t)reader->mesh.vertex_count && size[2] == 3;
    case RUGA_RESULT_LATTICE:
        return ruga_hdf5_shape(reader->set[set], 3, size) && size[0] >= frames &&
               size[1] == (hsize_t)reader->node_count && size[2] == 3;
    case RUGA_RESULT_RESTART:
        return ruga_hdf5_shape(reader->set[set], 2, size) && size[0] == 2 && size[1] <= INT_MAX;
    case RUGA_RESULT_RESTART_FRAME:
        return ruga_hdf5_shape(reader->set[set], 1, size) && size[0] == 2;
    case RUGA_RESULT_ANGLE:
    case RUGA_RESULT_REST_ANGLE:
    case RUGA_RESULT_SEGMENT_GAP:
        return ruga_hdf5_shape(reader->set[set], 2, size) && size[0] >= frames &&
               size[1] == (hsize_t)reader->creases.segment_count;
    case RUGA_RESULT_HANDLE_FORCE:
        return ruga_hdf5_shape(reader->set[set], 3, size) && size[0] >= frames && size[1] <= INT_MAX / 3 && size[2] == 3;
    default:
        return ruga_hdf5_shape(reader->set[set], 1, size) && size[0] >= frames;
    }
}

// Whether a file may be without it: what depends on the scene, and what older versions did not write.
static bool set_may_lack(const ruga_result_reader* reader, int set) {
    return (ruga_result_set_is_interior(set) && !reader->has_interior) ||
           (ruga_result_set_is_crease(set) && !reader->header.creases) ||
           (set == RUGA_RESULT_SEGMENT_GAP && !exists(reader->file, "/creases", ruga_result_set_name(set))) ||
           ((set == RUGA_RESULT_HANDLE_FORCE || set == RUGA_RESULT_STATS + RUGA_RESULT_COLUMN_energy_hinge) &&
            !exists(reader->file, "/stats", ruga_result_set_name(set)));
}

// After /frames/time, so that each has at least as many rows although a writer may be at work.
static ruga_status open_sets(ruga_hdf5* hdf5, ruga_result_reader* reader) {
    RUGA_TRY(get_frame_count(hdf5, reader));
    for (int set = RUGA_RESULT_TIME + 1; set < RUGA_RESULT_SETS; set++) {
        if (set_may_lack(reader, set)) {
            continue;
        }
        const char* name = ruga_result_set_name(set);
        reader->set[set] = H5Dopen2(reader->file, name, H5P_DEFAULT);
        if (reader->set[set] < 0 || !set_fits(reader, set)) {
            RUGA_TRY(ruga_hdf5_check(hdf5, false, RUGA_BAD_INPUT, name));
        }
    }
    hsize_t size[2], forces[3];
    bool ok = ruga_hdf5_shape(reader->set[RUGA_RESULT_RESTART], 2, size);
    if (reader->set[RUGA_RESULT_HANDLE_FORCE] >= 0) {
        ok = ok && ruga_hdf5_shape(reader->set[RUGA_RESULT_HANDLE_FORCE], 3, forces);
        reader->header.handle_count = ok ? (int)forces[1] : 0;
    }
    reader->header.restart_doubles = ok ? (int)size[1] : 0;
    return ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, "/restart/vector");
}

static ruga_status get_lattice_shape(ruga_hdf5* hdf5, ruga_result_reader* reader) {
    reader->has_interior = H5Lexists(reader->file, "/lattice", H5P_DEFAULT) > 0;
    if (!reader->has_interior) {
        return RUGA_OK;
    }
    int columns;
    hid_t nodes = H5Dopen2(reader->file, "/lattice/nodes", H5P_DEFAULT);
    hid_t elements = H5Dopen2(reader->file, "/lattice/elements", H5P_DEFAULT);
    bool ok = nodes >= 0 && elements >= 0 &&
              get_shape(nodes, sizeof(double), 3, &reader->node_count, &columns) && reader->node_count > 0 &&
              get_shape(elements, sizeof(int), 0, &reader->element_count, &reader->nodes_per_element) &&
              (reader->nodes_per_element == 8 || reader->nodes_per_element == 27);
    if (nodes >= 0) {
        (void)H5Dclose(nodes);
    }
    if (elements >= 0) {
        (void)H5Dclose(elements);
    }
    return ruga_hdf5_check(hdf5, ok, RUGA_BAD_INPUT, "/lattice is damaged");
}

static ruga_status read_all(ruga_hdf5* hdf5, ruga_result_reader* reader) {
    RUGA_TRY(ruga_hdf5_check(hdf5, open_file(hdf5, reader), RUGA_BAD_INPUT, "cannot be opened"));
    RUGA_TRY(get_header(hdf5, reader));
    RUGA_TRY(get_mesh(hdf5, reader->file, &reader->mesh));
    RUGA_TRY(get_skin(hdf5, reader));
    RUGA_TRY(get_creases(hdf5, reader));
    RUGA_TRY(get_lattice_shape(hdf5, reader));
    return open_sets(hdf5, reader);
}

ruga_status ruga_result_open(const char* path, ruga_result_reader** reader) {
    *reader = NULL;
    RUGA_TRY(check_file(path));
    ruga_result_reader* made;
    RUGA_TRY(RUGA_NEW_ZERO(made, 1));
    made->file = -1;
    for (int set = 0; set < RUGA_RESULT_SETS; set++) {
        made->set[set] = -1;
    }
    made->path = ruga_copy_string(path);
    ruga_status status = RUGA_NO_MEMORY;
    if (made->path) {
        ruga_hdf5 hdf5;
        ruga_hdf5_begin(&hdf5, path);
        status = read_all(&hdf5, made);
        ruga_hdf5_end(&hdf5);
    } else {
        (void)ruga_fail(status, "out of memory: a file's name");
    }
    *reader = made;
    if (status != RUGA_OK) {
        ruga_result_reader_close(reader);
    }
    return status;
}

void ruga_result_reader_close(ruga_result_reader** reader) {
    ruga_result_reader* r = *reader;
    if (!r) {
        return;
    }
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, "");
    for (int set = 0; set < RUGA_RESULT_SETS; set++) {
        if (r->set[set] >= 0) {
            (void)H5Dclose(r->set[set]);
        }
    }
    if (r->file >= 0) {
        (void)H5Fclose(r->file);
    }
    ruga_hdf5_end(&hdf5);
    ruga_mesh_clear(&r->mesh);
    ruga_release(r->thickness);
    ruga_release(r->young);
    ruga_release(r->growth);
    ruga_release(r->wavelength);
    for (int i = 0; r->crease_name && r->crease_name[i]; i++) {
        ruga_release(r->crease_name[i]);
    }
    ruga_release(r->crease_name);
    ruga_release(r->segment);
    ruga_release(r->segment_crease);
    ruga_release(r->crease_length);
    ruga_release(r->crease_stiffness);
    ruga_release(r->assignment);
    ruga_release(r->scene_text);
    ruga_release(r->path);
    ruga_release(r);
    *reader = NULL;
}

// --- What is in it ---

int ruga_result_frame_count(const ruga_result_reader* reader) {
    return reader->frame_count;
}

const ruga_mesh* ruga_result_mesh(const ruga_result_reader* reader) {
    return &reader->mesh;
}

bool ruga_result_has_interior(const ruga_result_reader* reader) {
    return reader->has_interior;
}

const ruga_result_header* ruga_result_reader_header(const ruga_result_reader* reader) {
    return &reader->header;
}

static ruga_status check_frame(const ruga_result_reader* reader, int frame) {
    if (frame < 0 || frame >= reader->frame_count) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: has no frame %d: it has %d, numbered from 0", reader->path,
                         frame, reader->frame_count);
    }
    return RUGA_OK;
}

static bool get_row(const ruga_result_reader* reader, int set, int row, double* data) {
    return ruga_hdf5_get_row(reader->set[set], H5T_NATIVE_DOUBLE, (hsize_t)row, data);
}

ruga_status ruga_result_read_frame(ruga_result_reader* reader, int frame, double* time, double* position,
                                   double* embedded, ruga_report* report) {
    RUGA_TRY(check_frame(reader, frame));
    if (embedded && !reader->has_interior) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: has no interior, so no embedded surface", reader->path);
    }
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, reader->path);
    bool ok = (!time || get_row(reader, RUGA_RESULT_TIME, frame, time)) &&
              (!position || get_row(reader, RUGA_RESULT_POSITION, frame, position)) &&
              (!embedded || get_row(reader, RUGA_RESULT_EMBEDDED, frame, embedded)) &&
              (!report || ruga_result_get_report(reader->set, (hsize_t)frame, report));
    ruga_status status = ruga_hdf5_check(&hdf5, ok, RUGA_IO, "a frame cannot be read");
    ruga_hdf5_end(&hdf5);
    RUGA_TRY(status);
    char where[64];
    (void)snprintf(where, sizeof where, "frame %d", frame);
    if (time && !isfinite(*time)) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: %s: its time is %g: the file is damaged", reader->path, where,
                         *time);
    }
    RUGA_TRY(check_places(reader->path, where, reader->mesh.vertex_count, position));
    (void)snprintf(where, sizeof where, "frame %d, the interior's surface", frame);
    return check_places(reader->path, where, reader->mesh.vertex_count, embedded);
}

ruga_status ruga_result_read_creases(ruga_result_reader* reader, int frame, double* angle, double* rest, double* gap) {
    RUGA_TRY(check_frame(reader, frame));
    if (!reader->header.creases) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: has no creases", reader->path);
    }
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, reader->path);
    bool ok = (!angle || get_row(reader, RUGA_RESULT_ANGLE, frame, angle)) &&
              (!rest || get_row(reader, RUGA_RESULT_REST_ANGLE, frame, rest)) &&
              (!gap || get_row(reader, RUGA_RESULT_GAP, frame, gap));
    ruga_status status = ruga_hdf5_check(&hdf5, ok, RUGA_IO, "the creases of a frame cannot be read");
    ruga_hdf5_end(&hdf5);
    return status;
}

// `cannot` says what does not work.
static ruga_status read_row(const ruga_result_reader* reader, int set, int frame, const char* cannot, double* data) {
    RUGA_TRY(check_frame(reader, frame));
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, reader->path);
    ruga_status status = ruga_hdf5_check(&hdf5, get_row(reader, set, frame, data), RUGA_IO, cannot);
    ruga_hdf5_end(&hdf5);
    return status;
}

ruga_status ruga_result_read_segment_gaps(ruga_result_reader* reader, int frame, double* gap) {
    if (reader->set[RUGA_RESULT_SEGMENT_GAP] < 0) {
        double largest;
        RUGA_TRY(ruga_result_read_creases(reader, frame, NULL, NULL, &largest));
        for (int s = 0; s < reader->header.creases->segment_count; s++) {
            gap[s] = largest;
        }
        return RUGA_OK;
    }
    return read_row(reader, RUGA_RESULT_SEGMENT_GAP, frame, "the gaps of a frame cannot be read", gap);
}

ruga_status ruga_result_read_handle_force(ruga_result_reader* reader, int frame, double* force) {
    if (reader->set[RUGA_RESULT_HANDLE_FORCE] < 0) {
        memset(force, 0, 3 * (size_t)reader->header.handle_count * sizeof *force);
        return check_frame(reader, frame);
    }
    return read_row(reader, RUGA_RESULT_HANDLE_FORCE, frame, "the forces of handles cannot be read", force);
}

ruga_status ruga_result_read_lattice(ruga_result_reader* reader, int frame, int* node_count,
                                     int* element_count, double* position) {
    if (node_count) {
        *node_count = reader->node_count;
    }
    if (element_count) {
        *element_count = reader->element_count;
    }
    if (!position) {
        return RUGA_OK;
    }
    RUGA_TRY(check_frame(reader, frame));
    if (!reader->has_interior) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: has no interior, so no lattice", reader->path);
    }
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, reader->path);
    bool ok = get_row(reader, RUGA_RESULT_LATTICE, frame, position);
    ruga_status status = ruga_hdf5_check(&hdf5, ok, RUGA_IO, "the lattice of a frame cannot be read");
    ruga_hdf5_end(&hdf5);
    return status;
}

static ruga_status check_elements(const ruga_result_reader* reader, const int* elements) {
    int64_t count = (int64_t)reader->element_count * reader->nodes_per_element;
    for (int64_t i = 0; i < count; i++) {
        if (elements[i] < 0 || elements[i] >= reader->node_count) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "%s: element %lld of the lattice names node %d of %d: the file is "
                             "damaged",
                             reader->path, (long long)(i / reader->nodes_per_element), elements[i],
                             reader->node_count);
        }
    }
    return RUGA_OK;
}

static bool get_whole(hid_t file, const char* name, hid_t type, void* data) {
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    bool ok = set >= 0 && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
    if (set >= 0) {
        (void)H5Dclose(set);
    }
    return ok;
}

ruga_status ruga_result_read_lattice_rest(ruga_result_reader* reader, int* nodes_per_element, int* elements,
                                          double* rest) {
    if (!reader->has_interior) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: has no interior, so no lattice", reader->path);
    }
    if (nodes_per_element) {
        *nodes_per_element = reader->nodes_per_element;
    }
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, reader->path);
    bool ok = (!elements || get_whole(reader->file, "/lattice/elements", H5T_NATIVE_INT, elements)) &&
              (!rest || get_whole(reader->file, "/lattice/nodes", H5T_NATIVE_DOUBLE, rest));
    ruga_status status = ruga_hdf5_check(&hdf5, ok, RUGA_IO, "the lattice cannot be read");
    ruga_hdf5_end(&hdf5);
    return status == RUGA_OK && elements ? check_elements(reader, elements) : status;
}

ruga_status ruga_result_read_restart(ruga_result_reader* reader, int frame, double* restart, bool* found) {
    RUGA_TRY(check_frame(reader, frame));
    hsize_t slot = (hsize_t)(frame % 2);
    int64_t number = -1;
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, reader->path);
    bool ok = ruga_hdf5_get_row(reader->set[RUGA_RESULT_RESTART_FRAME], H5T_NATIVE_INT64, slot, &number);
    *found = ok && number == frame;
    if (*found && reader->header.restart_doubles > 0) {
        ok = ruga_hdf5_get_row(reader->set[RUGA_RESULT_RESTART], H5T_NATIVE_DOUBLE, slot, restart);
    }
    ruga_status status = ruga_hdf5_check(&hdf5, ok, RUGA_IO, "the restart data cannot be read");
    ruga_hdf5_end(&hdf5);
    return status;
}
